//! Changes of a level, one at a time: walls are moved and taken away, doors opened, openings cut.
//!
//! In: a [`Level`] and what is to change. Out: a new level, through the same door to the grid
//! ([`super::snap`]) as every level that is read, or an [`EditError`] that says why not. What comes out
//! can be written ([`super::toml::write`]). [`near`] finds what a pointer is at, [`History`] undoes.

mod finish;
mod history;
mod moving;
pub mod near;
mod openings;
mod removal;
mod runs;

pub use history::History;
pub use moving::{move_point, move_wall};
pub use openings::{add_opening, plain, remove_opening, toggle};
pub use removal::delete_wall;

use super::model::{Level, Wall, WallId};
use super::snap::SnapError;

/// Why a change is not possible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EditError {
    /// A wall of that number does not exist.
    #[error("there is no wall {}", .0.0)]
    NoWall(WallId),
    /// No wall starts or ends there.
    #[error("no wall ends at this point")]
    NoPoint,
    /// Beyond what the level's grid can hold.
    #[error("({x}, {y}) is too far away for the grid of this level")]
    TooFar {
        /// The point.
        x: f64,
        /// The point.
        y: f64,
    },
    /// The two ends of a wall would fall together.
    #[error("a wall would start and end in the same point")]
    NoLength,
    /// An outline would cross or touch itself, or enclose nothing.
    #[error("the outline of {what} would cross or touch itself")]
    Crosses {
        /// Which room, zone or pillar.
        what: String,
    },
    /// A zone would change the heights of nothing.
    #[error("{what} would lie in no room")]
    ZoneOutside {
        /// Which zone.
        what: String,
    },
    /// An opening does not fit.
    #[error("an opening is {width:.2} wide, and its wall has only {available:.2}")]
    TooWide {
        /// The opening's width.
        width: f64,
        /// The length that it may take.
        available: f64,
    },
    /// A width that is none.
    #[error("an opening cannot be {0} wide")]
    Width(f64),
    /// Two openings would lie over each other.
    #[error("there is an opening already")]
    Overlaps,
    /// The wall is no opening.
    #[error("this is no opening")]
    NotAnOpening,
    /// What has no leaf cannot be opened or closed.
    #[error("there is no door here that could be opened or closed")]
    NoLeaf,
    /// No opening can be cut into a pillar.
    #[error("no opening can be cut into a pillar")]
    Pillar,
    /// One can see through already.
    #[error("there is no wall here, only a change of height or of light")]
    SeeThrough,
    /// A wall with nothing behind it.
    #[error("nothing lies beyond this wall")]
    OuterWall,
    /// A line that parts two sectors cannot be taken away without joining them.
    #[error("this line is the border between two sectors")]
    Border,
    /// The change does not fit on a grid.
    #[error(transparent)]
    Snap(#[from] SnapError),
}

/// The wall of a number.
fn wall(level: &Level, id: WallId) -> Result<&Wall, EditError> {
    (level.walls.get(id.0 as usize)).ok_or(EditError::NoWall(id))
}

#[cfg(test)]
mod tests;
