//! Numbers and names as people like to read them.

use crate::cells::{CellGraph, CellId};
use crate::level::{Level, wording};
pub use wording::{coordinate, count, count_of, duration, grouped, length, unit};

/// The room or sector in which a cell lies: ` in 'Hall'`, ` in sector 12`, or nothing.
pub fn in_sector(level: &Level, graph: &CellGraph, cell: CellId) -> String {
    wording::in_sector(level, graph.cell(cell).sector)
}
