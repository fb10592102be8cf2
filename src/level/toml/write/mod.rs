//! Any level in the own format: the way back from [`read`](super::read).
//!
//! In: a [`Level`], read from whatever format, or edited. Out: the text of a file that reads as the
//! same level (the same grid points, heights with their ranges, openings, lights, …), and a list of
//! what the format has no words for. Rooms, zones and pillars are written as such; levels whose
//! walls name their sectors (Doom) as `[[sector]]`s and `[[line]]`s. What is written is read back and
//! compared before it is handed out.
//!
//! ```
//! use enfilade::level::toml;
//! let level = toml::read("[[room]]\nname = 'Hall'\nrect = [0, 0, 6, 4]", "hall.toml").unwrap();
//! let written = toml::write::write(&level).unwrap();
//! assert_eq!(toml::read(&written.text, "hall.toml").unwrap().walls.len(), 4);
//! assert!(written.left_out.is_empty());
//! ```

mod furnish;
mod plan;
mod text;

use self::text::Text;
use super::super::model::{Height, Interior, Level, OpeningStyle, Sector, Wall, WallKind};
use super::super::scene::CameraPath;
use super::error::TomlError;

/// A level as a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// What the level has and the file has not, each with its article: "the textures of walls, …".
    pub left_out: Vec<String>,
}

/// Why a level cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WriteError {
    /// An area whose walls are no closed line.
    #[error("the walls of {what} are no closed line, so it cannot be written as an outline")]
    NotClosed {
        /// Which room, zone or pillar.
        what: String,
    },
    /// The file would be refused.
    #[error("the level cannot be written so that it can be read again: {0}")]
    Refused(Box<TomlError>),
    /// The file would read as another level.
    #[error("the level cannot be written so that it reads the same: {what} would differ")]
    Differs {
        /// What would.
        what: &'static str,
    },
}

/// Writes a walk: a `[[path]]` table, which may be put at the end of any level file.
pub fn path(path: &CameraPath) -> String {
    let mut text = Text::default();
    furnish::path(&mut text, path);
    text.text
}

/// Writes a level in the own format.
///
/// # Errors
/// Where a level holds what no file can: areas that no closed line bounds, or that cross themselves.
/// No level that was read from a file of the own format, or from a Doom map, is like that.
pub fn write(level: &Level) -> Result<Written, WriteError> {
    let written = compose(level, false)?;
    match compare(level, &written) {
        Ok(()) => Ok(written),
        // Openings whose wall is elsewhere by now, or too low for them: as plain lines.
        Err(_) => {
            let plain = compose(level, true)?;
            compare(level, &plain)?;
            Ok(plain)
        }
    }
}

fn compose(level: &Level, plain_openings: bool) -> Result<Written, WriteError> {
    let mut left_out = Vec::new();
    let mut body = Text::default();
    plan::plan(&mut body, level, plain_openings, &mut left_out)?;
    furnish::scene(&mut body, level, &mut left_out);

    let mut text = Text::default();
    text.comment(&format!("Written by enfilade from {}.", level.source));
    for what in &left_out {
        text.comment(&format!("Left out: {what}."));
    }
    text.line("");
    text.string("name", Some(&level.name));
    text.text.push_str(&body.text);
    Ok(Written {
        text: text.text,
        left_out,
    })
}

/// Whether the text reads as the level.
fn compare(level: &Level, written: &Written) -> Result<(), WriteError> {
    let back = super::read(&written.text, &level.source)
        .map_err(|error| WriteError::Refused(Box::new(error)))?;
    let differs = |what| Err(WriteError::Differs { what });
    if keys(level) != keys(&back) {
        return differs("a wall");
    }
    let areas = |l: &Level| -> Vec<_> { l.outlines.iter().map(|o| (o.sector, o.zone)).collect() };
    if areas(level) != areas(&back) {
        return differs("an outline");
    }
    // The level as a whole has neither light nor movement in a file.
    let whole = matches!(level.interior, Interior::Enclosed { .. });
    let heights = |l: &Level| -> Vec<_> {
        let all = |(i, s): (usize, &Sector)| match i {
            0 if whole => (
                Height::fixed(s.floor.rest),
                Height::fixed(s.ceiling.rest),
                None,
            ),
            _ => (s.floor, s.ceiling, s.light),
        };
        l.sectors.iter().enumerate().map(all).collect()
    };
    // A level of mere walls has no sectors, and is given the usual one.
    if !level.sectors.is_empty() && heights(level) != heights(&back) {
        return differs("a height or a light");
    }
    let starts = |l: &Level| match &l.interior {
        Interior::Sides => Err(true),
        Interior::Outlines => Err(false),
        Interior::Enclosed { starts } => Ok((starts.iter())
            .map(|&p| l.grid.to_level(p))
            .collect::<Vec<_>>()),
    };
    if starts(level) != starts(&back) {
        return differs("the inside");
    }
    Ok(())
}

/// The walls of a level in an order of their own, with all that counts for sight. Openings may be
/// read in another order than the one in which they are in the level.
fn keys(level: &Level) -> Vec<([u64; 4], String)> {
    let bits = |x: f64| (x + 0.0).to_bits();
    let key = |w: &Wall| {
        let (a, b) = (level.grid.to_level(w.from), level.grid.to_level(w.to));
        let rest = (&w.kind, w.left, w.right, w.outline, w.material);
        (
            [bits(a.x), bits(a.y), bits(b.x), bits(b.y)],
            format!("{rest:?}"),
        )
    };
    let mut keys: Vec<_> = level.walls.iter().map(key).collect();
    keys.sort();
    keys
}

/// Words of the format for kinds of openings.
fn style(style: OpeningStyle) -> &'static str {
    match style {
        OpeningStyle::Door => "door",
        OpeningStyle::Window => "window",
        OpeningStyle::Archway => "archway",
    }
}

/// `state`, where it is not the usual one.
fn state(kind: &WallKind) -> Option<&'static str> {
    let (shut, usual) = match kind {
        WallKind::Opening(opening) => (opening.shut, opening.style == OpeningStyle::Door),
        WallKind::Edge { shut } => (*shut, false),
        WallKind::Solid | WallKind::Outline => return None,
    };
    (shut != usual).then_some(if shut { "closed" } else { "open" })
}

#[cfg(test)]
mod tests;
