//! Portal flow with separators in floating point, as the Quake tools do it.

use super::{Progress, Pvs};
use crate::cells::CellGraph;
use crate::level::Level;

/// Options of [`flow`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowOptions {
    /// Points nearer to a separator than this, in grid steps, count as on it.
    pub on: f64,
}

impl FlowOptions {
    /// The Quake tools' customary tenth of a map unit, of which a metre has 32.
    pub fn of(level: &Level) -> Self {
        let units = match level.unit.as_str() {
            "m" => 0.1 / 32.0,
            "cm" => 10.0 / 32.0,
            "mm" => 100.0 / 32.0,
            _ => 0.1,
        };
        Self {
            on: units / level.grid.step.length(),
        }
    }
}

/// The PVS by portal flow.
pub fn flow(_graph: &CellGraph, _options: &FlowOptions, _progress: &Progress) -> Pvs {
    unimplemented!()
}
