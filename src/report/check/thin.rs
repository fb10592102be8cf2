//! Slivers: ground so thin that it was hardly meant.

use std::collections::BTreeMap;

use super::extent;
use super::reach::middle;
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::level::{Finding, Interior, Level, Place, SectorId, Severity};

/// A stretch of one sector is a sliver if its mean width (twice its area through its perimeter) is
/// below this part of the level's larger side, 1 cm in a building of 100 m, …
const SECTOR: f64 = 1e-4;
/// … and it is at least this many times as long as wide.
const LONG: f64 = 25.0;
/// A cell is one below this part: then even f64 hardly tells its sides apart.
const CELL: f64 = 1e-7;

/// Stretches of sectors, and cells, that are thinner than the limits above.
pub fn find(level: &Level, graph: &CellGraph) -> Vec<Finding> {
    let extent = extent(level);
    let region = regions(graph);
    let mut measures: BTreeMap<u32, (f64, f64, CellId)> = BTreeMap::new();
    let mut thin_cells = Vec::new();
    for cell in graph.cell_ids() {
        let area = graph.area(cell);
        let measure = measures
            .entry(region[cell.0 as usize])
            .or_insert((0.0, 0.0, cell));
        measure.0 += area;
        let mut around = 0.0;
        for edge in graph.edge_range(cell).map(EdgeId) {
            let [p, q] = [graph.edge(edge).origin, graph.end(edge)];
            let length = graph.vertices.approx(p).distance(graph.vertices.approx(q));
            around += length;
            let beyond = graph.edge(edge).twin().map(|t| graph.edge(t).cell);
            if beyond.is_none_or(|c| region[c.0 as usize] != region[cell.0 as usize]) {
                measure.1 += length;
            }
        }
        if 2.0 * area < around * extent * CELL {
            thin_cells.push(middle(graph, cell));
        }
    }
    let thin: Vec<CellId> = measures
        .values()
        .filter(|(area, around, _)| {
            2.0 * area < around * extent * SECTOR && around * around > 4.0 * LONG * area
        })
        .map(|m| m.2)
        .collect();
    let mut findings = Vec::new();
    let mut add = |code, severity, message: &str, places: Vec<Place>| {
        findings.extend(Finding::at(code, severity, message, places));
    };
    // Doom maps have strips of a unit's width on purpose.
    let by_sides = level.interior == Interior::Sides;
    add(
        "sliver",
        if by_sides {
            Severity::Note
        } else {
            Severity::Warning
        },
        "This ground is thinner than a ten-thousandth of the level; two walls or edges that were \
         meant to coincide may lie side by side.",
        thin.iter().map(|&cell| middle(graph, cell)).collect(),
    );
    add(
        "sliver-cell",
        Severity::Note,
        "Lines of the subdivision left cells thinner than a ten-millionth of the level.",
        thin_cells,
    );
    findings
}

/// For each cell the smallest cell of the connected stretch of its sector.
fn regions(graph: &CellGraph) -> Vec<u32> {
    let sector = |cell: CellId| -> Option<SectorId> { graph.cell(cell).sector };
    let mut region = vec![u32::MAX; graph.cells.len()];
    for first in graph.cell_ids() {
        let mut queue = vec![first];
        while let Some(cell) = queue.pop() {
            if region[cell.0 as usize] != u32::MAX {
                continue;
            }
            region[cell.0 as usize] = first.0;
            let twins = graph
                .edge_range(cell)
                .filter_map(|e| graph.edge(EdgeId(e)).twin());
            let beyond = twins.map(|t| graph.edge(t).cell);
            queue.extend(beyond.filter(|&c| sector(c) == sector(first)));
        }
    }
    region
}
