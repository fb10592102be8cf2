//! Numbers: grid points, lines, exact vertices, and predicates that return a named side.
//!
//! Coordinates are x right, y up, in grid steps. Nothing in here, nor in `cells`, `sight` and `pvs`,
//! compares a floating-point number with a tolerance: see [`predicate`] for how signs are decided.

mod grid;
pub mod interval;
mod line;
pub mod predicate;
mod vertex;

pub use grid::{GRID_LIMIT, Grid, GridPoint, Step};
pub use interval::Interval;
pub use line::Line;
pub use predicate::{Placed, Side, VertexId, VertexSet, Vertices, orient};
pub use vertex::Vertex;
