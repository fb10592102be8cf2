//! The exact solver of [`super::stab()`].

use super::{Gate, Stabbing};
use crate::geom::Vertices;

/// A stabbing line of the chain, or why there is none; exact.
pub fn stab(_vertices: &Vertices, _chain: &[Gate]) -> Stabbing {
    unimplemented!()
}
