//! Numbers: grid points, lines, exact vertices, and predicates that return a named side.
//!
//! Coordinates are x right, y up, in grid steps. Nothing in here, nor in `cells`, `sight` and `pvs`,
//! compares a floating-point number with a tolerance: see [`predicate`] for how signs are decided.
//! (But for the methods in floating point that `pvs` holds to be compared with: `flow` and `lp`.)

mod grid;
mod interval;
mod line;
pub mod pencil;
pub mod predicate;
mod vertex;

pub use grid::{FINE, GRID_LIMIT, Grid, GridPoint, Step};
pub use interval::{Interval, Span};
pub use line::Line;
pub use pencil::{Pencil, Ray};
pub use predicate::{Directed, Placed, Side, VertexId, VertexSet, Vertices, orient};
pub use vertex::Vertex;
