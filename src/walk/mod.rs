//! From a level to a walk through it: where the eye is, and where it looks, at each moment.
//!
//! In: a path of a level file, or a level with its cells and a person who is to see all of it. Out: a
//! [`Track`] with a [`Pose`] for every second; of a [`tour`](mod@tour) also what it visits and what it
//! cannot reach, and why.
//!
//! | file | what |
//! |---|---|
//! | [`track`] | constant speed along a line, and the view ahead |
//! | `curve`, `heading` | a smooth curve through points; a view that never turns too fast |
//! | [`rise`] | the eye's height over floors and steps |
//!
//! Floating point is fine here: a walk is not exact, but what it crosses is looked up in the exact
//! cells.

mod curve;
mod heading;
pub mod rise;
pub mod track;

pub use rise::Ground;
pub use track::{Pose, Track, TrackOptions};
