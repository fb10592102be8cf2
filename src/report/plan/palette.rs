//! Colours: those of sectors, chosen so that neighbours differ, and those of lines.

use std::collections::BTreeSet;

use crate::cells::CellGraph;
use crate::geom::VertexId;
use crate::level::SectorId;

/// Pale colours for the ground, far enough apart to tell neighbours, dark lines legible on all.
const GROUND: [&str; 10] = [
    "#cfe2f2", "#f8dfc4", "#d5ebcb", "#f3d3dc", "#e2daf1", "#f8efc2", "#c9e8e3", "#ead9c7",
    "#dfe3e8", "#e9ecc6",
];

/// Ground that belongs to no sector.
pub const NO_SECTOR: &str = "#ededea";
/// Walls.
pub const WALL: &str = "#23272e";
/// Doors that let sight through.
pub const DOOR: &str = "#c8641c";
/// Doors that count as walls.
pub const CLOSED: &str = "#9c2f1c";
/// Windows.
pub const WINDOW: &str = "#2b7fc4";
/// Archways.
pub const ARCHWAY: &str = "#8c8f96";
/// Borders between cells.
pub const PORTAL: &str = "#5b6472";
/// Sightlines.
pub const SIGHT: &str = "#12934a";
/// The source cell, cells that it sees, and all others.
pub const VIEW: [&str; 3] = ["#1f4e9e", "#a9cff3", "#f2f1ed"];

/// The two cells of an explanation.
pub const ENDS: [&str; 2] = ["#1f4e9e", "#7b3fa0"];
/// Cells on the way between them that the first one sees, those that it does not, and all others.
pub const BETWEEN: [&str; 3] = ["#c3ddf6", "#f6d9d0", "#f4f3ef"];
/// Portals on the way.
pub const PASSED: &str = "#0b8f86";
/// The shortest way.
pub const WAY: &str = "#5a4636";
/// What stops or bounds sight on its left, and on its right.
pub const BOUND: [&str; 2] = ["#c4202f", "#e07b00"];
/// For an eye: cells in view, further cells of the PVS, and all others.
pub const EYE_VIEW: [&str; 3] = ["#a9cff3", "#cbe6b4", "#f2f1ed"];
/// The ground that an eye sees.
pub const IN_SIGHT: &str = "#4db5ad";
/// The eye, and the edges of its cone.
pub const EYE: &str = "#0b4f4c";

/// A colour for each sector. Sectors that share a corner differ as far as the colours go; the same
/// level gets the same colours.
pub fn by_sector(graph: &CellGraph, n_sectors: usize) -> Vec<&'static str> {
    let mut around: Vec<(VertexId, SectorId)> = Vec::new();
    for cell in graph.cell_ids() {
        if let Some(sector) = graph.cell(cell).sector {
            around.extend(graph.corners(cell).map(|v| (v, sector)));
        }
    }
    around.sort();
    around.dedup();
    let mut neighbours = vec![BTreeSet::new(); n_sectors];
    for group in around.chunk_by(|a, b| a.0 == b.0) {
        for &(_, a) in group {
            for &(_, b) in group.iter().filter(|g| g.1 != a) {
                neighbours[a.0 as usize].insert(b.0 as usize);
            }
        }
    }
    let mut used = [0usize; GROUND.len()];
    let mut chosen: Vec<Option<usize>> = vec![None; n_sectors];
    for sector in 0..n_sectors {
        let mut beside = [0usize; GROUND.len()];
        neighbours[sector]
            .iter()
            .filter_map(|&n| chosen[n])
            .for_each(|c| beside[c] += 1);
        let best = (0..GROUND.len())
            .min_by_key(|&c| (beside[c], used[c], c))
            .unwrap_or(0);
        // Only sectors with ground count, so that the first colours are not used up on others.
        used[best] += usize::from(!neighbours[sector].is_empty());
        chosen[sector] = Some(best);
    }
    chosen.into_iter().map(|c| GROUND[c.unwrap_or(0)]).collect()
}
