//! Numbers: grid points, lines, exact vertices, and predicates that return a named side.

mod grid;

pub use grid::{GRID_LIMIT, Grid, GridPoint, Step};
