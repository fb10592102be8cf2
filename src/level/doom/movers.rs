//! Sectors that move.
use super::defect::Tally;
use super::raw::RawMap;
use crate::level::Height;
/// Range of a sector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Floor.
    pub floor: Height,
    /// Ceiling.
    pub ceiling: Height,
}
/// Ranges of all sectors.
pub fn ranges(raw: &RawMap, _tally: &mut Tally) -> Vec<Range> {
    raw.sectors
        .iter()
        .map(|s| Range {
            floor: Height::fixed(s.floor),
            ceiling: Height::fixed(s.ceiling),
        })
        .collect()
}
