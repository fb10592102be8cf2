//! Visibility with heights.

use super::{Progress, Pvs};
use crate::cells::CellGraph;

/// Options of [`heights`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightsOptions {
    /// How many parts the lines through one chain of portals may be split into before the chain is
    /// left undecided.
    pub splits: u32,
}

impl Default for HeightsOptions {
    fn default() -> Self {
        Self { splits: 64 }
    }
}

/// The PVS with heights.
pub fn heights(_graph: &CellGraph, _options: &HeightsOptions, _progress: &Progress) -> Pvs {
    unimplemented!()
}
