//! The lecture's linear programme as a solver of [`super::stab()`].

use super::{Gate, Stabbing};
use crate::geom::Vertices;

/// A stabbing line of the chain, or why there is none, by linear programming in floating point.
pub fn stab(_vertices: &Vertices, _chain: &[Gate]) -> Stabbing {
    unimplemented!()
}
