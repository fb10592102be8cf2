//! Everything that is connected through portals.

use super::{Progress, Pvs};
use crate::cells::CellGraph;

/// The PVS in which a cell sees every cell that a walk through portals reaches.
pub fn flood(_graph: &CellGraph, _progress: &Progress) -> Pvs {
    unimplemented!()
}
