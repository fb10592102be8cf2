//! From a level to a walk through it: where the eye is, and where it looks, at each moment.
//!
//! In: a path of a level file, or a level with its cells and a [`Person`] who is to see all of it. Out:
//! a [`Track`] with a [`Pose`] for every second; of a [`Tour`] also what it visits and what it cannot
//! reach, and why. Frame by frame, [`frame::Guide`] finds out what there is to draw, and [`figures`] keep
//! what it cost.
//!
//! | file | what |
//! |---|---|
//! | [`track`] | constant speed along a line, and the view ahead |
//! | `curve`, `heading` | a smooth curve through points; a view that never turns too fast |
//! | [`rise`] | the eye's height over floors and steps |
//! | [`person`] | who walks, and what stops him |
//! | [`obstacle`] | what a body keeps clear of |
//! | `net`, `search` | places to stand and moves between them; shortest ways |
//! | `stops`, `taut` | in which order to see everything; a line that a person would walk |
//! | [`tour`](mod@tour) | all of that together |
//! | [`frame`] | each frame's cell, PVS and effects, and what it shares with the one before |
//! | [`figures`] | a row for each frame, and what they come to |
//!
//! Floating point is fine here: a walk is not exact, but it is one through the exact cells.

mod curve;
pub mod figures;
pub mod frame;
mod heading;
mod net;
pub mod obstacle;
pub mod person;
pub mod rise;
mod search;
mod stops;
mod taut;
pub mod tour;
pub mod track;

pub use person::{Barrier, Person};
pub use rise::Ground;
pub use tour::{Tour, opened, tour};
pub use track::{Pose, Track, TrackOptions};
