//! What can be wrong with a TOML level: each with its place and what to do about it.

use super::super::finding::Place;
use super::super::snap::SnapError;

/// A mistake in a TOML level. Every message starts with line and column.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TomlError {
    /// No TOML, a value of the wrong type or out of its range, or a missing key.
    #[error("{place}: {message}")]
    Parse {
        /// Where.
        place: Place,
        /// What the parser says.
        message: String,
    },
    /// A key that does not exist here.
    #[error("{place}: unknown key `{key}`{}; {allowed} may stand here", did_you_mean(.suggestion))]
    UnknownKey {
        /// Where.
        place: Place,
        /// The key.
        key: String,
        /// The key that was probably meant.
        suggestion: Option<String>,
        /// All keys that exist here, for people.
        allowed: String,
    },
    /// A name that nothing of that kind has.
    #[error("{place}: there is no {what} called `{name}`{}", did_you_mean(.suggestion))]
    UnknownName {
        /// Where the name is used.
        place: Place,
        /// "room", "material".
        what: &'static str,
        /// The name.
        name: String,
        /// The name that was probably meant.
        suggestion: Option<String>,
    },
    /// Two things of one kind have the same name.
    #[error("{place}: another {what} is already called `{name}` ({first}); rename one")]
    DuplicateName {
        /// Where the name is given a second time.
        place: Place,
        /// "room", "material".
        what: &'static str,
        /// The name.
        name: String,
        /// Where it is given first.
        first: Place,
    },
    /// Not exactly one of several alternative keys is given, or keys do not go together.
    #[error("{place}: {what} needs {needed}")]
    Keys {
        /// Where.
        place: Place,
        /// What kind of table it is, with its article.
        what: String,
        /// Which keys it needs.
        needed: String,
    },
    /// A key that has no meaning for this kind of light, object or opening.
    #[error("{place}: {what} has no `{key}`; remove it")]
    Misplaced {
        /// Where.
        place: Place,
        /// The kind, with its article.
        what: &'static str,
        /// The key.
        key: &'static str,
    },
    /// An outline with fewer than three corners, or a wall with fewer than two points.
    #[error("{place}: {what} has {count} corners; it needs at least {needed}")]
    TooFewCorners {
        /// Where.
        place: Place,
        /// Which outline or wall.
        what: String,
        /// Its number of corners.
        count: usize,
        /// The least number.
        needed: usize,
    },
    /// A corner that occurs twice in an outline.
    #[error(
        "{place}: {what} has the corner ({x}, {y}) twice (first at {first}); leave one out (the \
         last corner is joined to the first without being repeated)"
    )]
    RepeatedCorner {
        /// Where it occurs the second time.
        place: Place,
        /// Which outline or wall.
        what: String,
        /// The corner.
        x: f64,
        /// The corner.
        y: f64,
        /// Where it occurs first.
        first: Place,
    },
    /// Two edges of one outline meet where they should not.
    #[error(
        "{place}: the outline of {what} crosses or touches itself: edge {edge} meets edge {other} \
         ({other_place}); put the corners in the order in which they are passed"
    )]
    SelfCrossing {
        /// Start of one edge.
        place: Place,
        /// Which outline.
        what: String,
        /// One edge: "(0, 0) to (4, 4)".
        edge: String,
        /// The other edge.
        other: String,
        /// Start of the other edge.
        other_place: Place,
    },
    /// All corners lie on one line.
    #[error("{place}: {what} encloses no area: all of its corners lie on one line")]
    ZeroArea {
        /// Where.
        place: Place,
        /// Which outline.
        what: String,
    },
    /// No room to stand in.
    #[error("{place}: the ceiling of {what} ({ceiling}) is not above its floor ({floor})")]
    CeilingNotAboveFloor {
        /// Where.
        place: Place,
        /// Which room or zone.
        what: String,
        /// Its floor.
        floor: f64,
        /// Its ceiling.
        ceiling: f64,
    },
    /// A zone that changes nothing.
    #[error("{place}: {what} lies in no room; move it into one")]
    ZoneOutsideRooms {
        /// Where.
        place: Place,
        /// Which zone.
        what: String,
    },
    /// An opening in the air.
    #[error(
        "{place}: the point ({x}, {y}) of the opening lies on no wall that the opening can be cut \
         into; the nearest is {distance:.4} away, near ({near_x:.4}, {near_y:.4})"
    )]
    NotOnWall {
        /// Where.
        place: Place,
        /// The point.
        x: f64,
        /// The point.
        y: f64,
        /// How far the nearest wall is.
        distance: f64,
        /// The nearest point on a wall.
        near_x: f64,
        /// The nearest point on a wall.
        near_y: f64,
    },
    /// The two ends of an opening lie on different walls.
    #[error(
        "{place}: no single wall holds both ends of the opening, ({}, {}) and ({}, {}); put both \
         on the same straight wall", .ends[0][0], .ends[0][1], .ends[1][0], .ends[1][1]
    )]
    NotOnOneWall {
        /// Where.
        place: Place,
        /// Both ends.
        ends: [[f64; 2]; 2],
    },
    /// Two rooms that an opening should join have no wall in common.
    #[error(
        "{place}: the rooms `{a}` and `{b}` share no wall; their outlines must have a stretch in \
         common for an opening between them"
    )]
    NoSharedWall {
        /// Where.
        place: Place,
        /// One room.
        a: String,
        /// The other room.
        b: String,
    },
    /// A room has no wall on the side that an opening names.
    #[error("{place}: the room `{room}` has no wall facing {side}")]
    NoSuchSide {
        /// Where.
        place: Place,
        /// The room.
        room: String,
        /// The side.
        side: &'static str,
    },
    /// An opening that does not fit into its wall.
    #[error(
        "{place}: the opening is {width} wide, but its wall has only {available:.4} there (from \
         ({}, {}) to ({}, {})); make it narrower or move it", .from[0], .from[1], .to[0], .to[1]
    )]
    TooWide {
        /// Where.
        place: Place,
        /// The opening's width.
        width: f64,
        /// The width that would fit.
        available: f64,
        /// Start of the stretch of wall.
        from: [f64; 2],
        /// End of the stretch of wall.
        to: [f64; 2],
    },
    /// An opening whose top is not above its bottom.
    #[error("{place}: the opening's top ({top}) is not above its bottom ({bottom})")]
    TopNotAboveBottom {
        /// Where.
        place: Place,
        /// Its lower end.
        bottom: f64,
        /// Its upper end.
        top: f64,
    },
    /// An opening wholly in the floor or above the ceiling.
    #[error(
        "{place}: the opening reaches from {bottom} to {top}, but between floor and ceiling there \
         is only {floor} to {ceiling}"
    )]
    OutsideHeights {
        /// Where.
        place: Place,
        /// Its lower end.
        bottom: f64,
        /// Its upper end.
        top: f64,
        /// The higher floor beside it.
        floor: f64,
        /// The lower ceiling beside it.
        ceiling: f64,
    },
    /// Two points, or a point and what it looks at, that must differ.
    #[error("{place}: {what}")]
    Degenerate {
        /// Where.
        place: Place,
        /// What is the matter and what to do.
        what: String,
    },
    /// The coordinates fit on no grid.
    #[error(transparent)]
    Snap(#[from] SnapError),
}

impl TomlError {
    /// Where the mistake is; `None` only for a level without any wall.
    pub fn place(&self) -> Option<Place> {
        use TomlError::*;
        match self {
            Parse { place, .. }
            | UnknownKey { place, .. }
            | UnknownName { place, .. }
            | DuplicateName { place, .. }
            | Keys { place, .. }
            | Misplaced { place, .. }
            | TooFewCorners { place, .. }
            | RepeatedCorner { place, .. }
            | SelfCrossing { place, .. }
            | ZeroArea { place, .. }
            | CeilingNotAboveFloor { place, .. }
            | ZoneOutsideRooms { place, .. }
            | NotOnWall { place, .. }
            | NotOnOneWall { place, .. }
            | NoSharedWall { place, .. }
            | NoSuchSide { place, .. }
            | TooWide { place, .. }
            | TopNotAboveBottom { place, .. }
            | OutsideHeights { place, .. }
            | Degenerate { place, .. } => Some(*place),
            Snap(error) => error.place(),
        }
    }
}

fn did_you_mean(suggestion: &Option<String>) -> String {
    suggestion
        .as_ref()
        .map_or(String::new(), |s| format!(" (did you mean `{s}`?)"))
}

/// The candidate that `name` is probably a misspelling of: at most one edit per three letters.
pub(super) fn probably_meant<'a>(
    name: &str,
    candidates: impl Iterator<Item = &'a str>,
) -> Option<String> {
    let lower = name.to_lowercase();
    candidates
        .map(|c| (edits(&lower, &c.to_lowercase()), c))
        .filter(|(n, c)| 3 * n <= c.chars().count().max(3))
        .min_by_key(|(n, _)| *n)
        .map(|(_, c)| c.to_string())
}

/// Number of letters to insert, delete or replace to get from `a` to `b` (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
