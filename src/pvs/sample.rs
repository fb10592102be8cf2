//! Random sightlines.

use super::{Progress, Pvs};
use crate::cells::CellGraph;

/// Options of [`sample`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleOptions {
    /// Random sightlines from every cell.
    pub rays: u32,
    /// Seed of all that is random.
    pub seed: u64,
}

impl Default for SampleOptions {
    fn default() -> Self {
        Self {
            rays: 1000,
            seed: 1,
        }
    }
}

/// The PVS of the pairs that random sightlines join.
pub fn sample(_graph: &CellGraph, _options: &SampleOptions, _progress: &Progress) -> Pvs {
    unimplemented!()
}
