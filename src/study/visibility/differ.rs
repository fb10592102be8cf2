//! The pairs of cells about which a method errs: which to list, and what the walls themselves say.

use glam::DVec2;

use super::accuracy::{Error, wrong};
use super::record::WrongPair;
use crate::cells::{CellGraph, CellId};
use crate::pvs::Pvs;
use crate::pvs::verify::{Caster, Place};

/// Pairs of each kind that are listed for a method.
pub(super) const LISTED: usize = 16;
/// Pairs that are looked at to find the most telling ones.
const LOOKED_AT: usize = 20_000;

/// The pairs of one kind that tell most: cells that are large for their distance, so that a picture
/// shows both. The most telling first.
pub(super) fn telling(
    graph: &CellGraph,
    truth: &Pvs,
    method: &Pvs,
    error: Error,
) -> Vec<[CellId; 2]> {
    let shown = |[a, b]: &[CellId; 2]| {
        let [(p, r), (q, s)] = [*a, *b].map(|cell| middle_and_size(graph, cell));
        r.min(s) / (p.distance(q) + r + s)
    };
    let mut pairs: Vec<_> = wrong(&truth.visible, &method.visible, error)
        .take(LOOKED_AT)
        .map(|pair| (shown(&pair), pair))
        .collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    pairs
        .into_iter()
        .take(LISTED)
        .map(|(_, pair)| pair)
        .collect()
}

/// A pair with its places, and whether the walls confirm the exact answer.
pub(super) fn look_up(
    graph: &CellGraph,
    caster: &Caster,
    error: Error,
    cells: [CellId; 2],
) -> WrongPair {
    let place = |cell| {
        let p = middle_and_size(graph, cell).0;
        graph.grid.offset_to_level(p.x, p.y).to_array()
    };
    let witness = match error {
        Error::Missed => witness(graph, cells),
        Error::Invented => None,
    };
    let confirmed = match &witness {
        Some([from, to]) => caster.is_free(cells, &from.0, &to.0),
        None => caster.joined(cells) == Some(error == Error::Missed),
    };
    WrongPair {
        error,
        cells: cells.map(|c| c.0),
        places: cells.map(place),
        sectors: cells.map(|c| graph.cell(c).sector.map(|s| s.0)),
        witness: witness
            .map(|ends| ends.map(|(_, p)| graph.grid.offset_to_level(p.x, p.y).to_array())),
        confirmed,
    }
}

fn witness(graph: &CellGraph, cells: [CellId; 2]) -> Option<[(Place, DVec2); 2]> {
    Some(cells.map(|c| {
        let p = middle_and_size(graph, c).0;
        let part = |x: f64| ((x * (1 << 20) as f64).round() as i128).into();
        ([part(p.x), part(p.y), (1 << 20).into()], p)
    }))
}

/// The mean of a cell's corners, and half the square root of its area, in grid steps.
pub(super) fn middle_and_size(graph: &CellGraph, cell: CellId) -> (DVec2, f64) {
    let corners: Vec<DVec2> = graph
        .polygon(cell)
        .into_iter()
        .map(|v| graph.vertices.approx(v))
        .collect();
    let n = corners.len().max(1);
    let middle = corners.iter().sum::<DVec2>() / n as f64;
    (middle, area(&corners).sqrt() / 2.0)
}

/// The area of a polygon.
pub(super) fn area(corners: &[DVec2]) -> f64 {
    let Some(&first) = corners.first() else {
        return 0.0;
    };
    let twice = corners
        .windows(2)
        .map(|w| (w[0] - first).perp_dot(w[1] - first));
    twice.sum::<f64>().abs() / 2.0
}
