//! The lecture's search with a floating-point linear programme as its stabbing test.

use super::{Progress, Pvs};
use crate::cells::CellGraph;

/// The PVS by the lecture's search, each chain asked anew by [`crate::sight::lp`].
pub fn lp(_graph: &CellGraph, _progress: &Progress) -> Pvs {
    unimplemented!()
}
