//! Findings: what was repaired in a level, or looks wrong, each with its places.

use std::fmt;

/// How grave a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Good to know; nothing is wrong.
    Note,
    /// Looks like a mistake of the level; nothing was changed.
    Warning,
    /// Was wrong and has been repaired in the one way there is.
    Repaired,
}

impl Severity {
    /// Lower-case name, as in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Repaired => "repaired",
        }
    }
}

/// A place in the source, so that a person finds it again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Line and column of a text file, both from 1.
    Text {
        /// Line, from 1.
        line: u32,
        /// Column in characters, from 1.
        column: u32,
    },
    /// Number of a linedef of a Doom map.
    Linedef(u32),
    /// Number of a sidedef of a Doom map.
    Sidedef(u32),
    /// Number of a sector of a Doom map.
    Sector(u32),
    /// Number of a vertex of a Doom map.
    Vertex(u32),
    /// Number of a thing of a Doom map.
    Thing(u32),
    /// A point on the plan, in the level's own coordinates.
    Point {
        /// To the right.
        x: f64,
        /// Up.
        y: f64,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Text { line, column } => write!(f, "line {line}, column {column}"),
            Place::Linedef(n) => write!(f, "linedef {n}"),
            Place::Sidedef(n) => write!(f, "sidedef {n}"),
            Place::Sector(n) => write!(f, "sector {n}"),
            Place::Vertex(n) => write!(f, "vertex {n}"),
            Place::Thing(n) => write!(f, "thing {n}"),
            Place::Point { x, y } => write!(f, "({x}, {y})"),
        }
    }
}

/// One kind of defect in a level, with every place where it occurs (never empty).
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Stable name for scripts, in kebab case: `zero-length-wall`.
    pub code: &'static str,
    /// How grave it is.
    pub severity: Severity,
    /// One sentence for people: what it is and what was or should be done about it.
    pub message: String,
    /// All places, in the source's order. `places.len()` is the count.
    pub places: Vec<Place>,
}

impl Finding {
    /// The finding, if it occurs anywhere.
    pub fn at(
        code: &'static str,
        severity: Severity,
        message: impl Into<String>,
        places: Vec<Place>,
    ) -> Option<Self> {
        (!places.is_empty()).then(|| Self {
            code,
            severity,
            message: message.into(),
            places,
        })
    }
}

impl fmt::Display for Finding {
    /// `12 × zero-length-wall (repaired): … at linedef 3, linedef 9, linedef 12 and 9 more`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 3;
        write!(
            f,
            "{} × {} ({}): {} At ",
            self.places.len(),
            self.code,
            self.severity.as_str(),
            self.message
        )?;
        for (i, place) in self.places.iter().take(SHOWN).enumerate() {
            write!(f, "{}{place}", if i > 0 { ", " } else { "" })?;
        }
        match self.places.len().saturating_sub(SHOWN) {
            0 => write!(f, "."),
            more => write!(f, " and {more} more."),
        }
    }
}
