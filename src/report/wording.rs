//! Numbers and names as people like to read them.

use crate::cells::{CellGraph, CellId};
use crate::level::{Level, wording};
pub use wording::{coordinate, count, count_of, duration, grouped, length, unit};

/// An area in square units: `96.3 m²`, `1,234,567 square map units`.
pub fn area(level: &Level, square_units: f64) -> String {
    let number = if square_units >= 999.5 {
        grouped(square_units.round() as u64)
    } else {
        let digits = match square_units {
            a if a >= 99.95 => 0,
            a if a >= 9.995 => 1,
            _ => 2,
        };
        format!("{square_units:.digits$}")
    };
    if level.unit.len() > 2 {
        format!("{number} square {}", unit(level))
    } else {
        format!("{number} {}²", level.unit)
    }
}

/// The room or sector in which a cell lies: ` in 'Hall'`, ` in sector 12`, or nothing.
pub fn in_sector(level: &Level, graph: &CellGraph, cell: CellId) -> String {
    wording::in_sector(level, graph.cell(cell).sector)
}
