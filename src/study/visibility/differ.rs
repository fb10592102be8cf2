//! The pairs of cells about which a method errs: which to list, and what the walls themselves say.

use dashu_int::IBig;
use glam::DVec2;

use super::accuracy::{Error, wrong};
use super::record::WrongPair;
use crate::cells::{CellGraph, CellId};
use crate::pvs::Pvs;
use crate::pvs::explain::{ExplainOptions, Explanation, explain};
use crate::pvs::verify::Caster;

/// Pairs of each kind that are listed for a method.
pub(super) const LISTED: usize = 16;
/// Steps in which the widest view between two cells is sought; a narrower one will do.
const STEPS: u64 = 20_000;
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

/// A pair with its places, why the exact answer is what it is, and whether the walls confirm it.
pub(super) fn look_up(
    graph: &CellGraph,
    truth: &Pvs,
    caster: &Caster,
    error: Error,
    cells: [CellId; 2],
) -> WrongPair {
    let level = |p: DVec2| graph.grid.offset_to_level(p.x, p.y).to_array();
    let mut pair = WrongPair {
        error,
        cells: cells.map(|c| c.0),
        places: cells.map(|cell| level(middle_and_size(graph, cell).0)),
        sectors: cells.map(|c| graph.cell(c).sector.map(|s| s.0)),
        witness: None,
        width: None,
        way: Vec::new(),
        ends: Vec::new(),
        confirmed: false,
    };
    let options = ExplainOptions {
        heights: None,
        max_steps: STEPS,
        points: None,
    };
    let mut free = None;
    match explain(graph, truth, cells[0], cells[1], &options) {
        Some(Explanation::Visible(view)) => {
            let ends = [&view.segment.from, &view.segment.to];
            let [from, to] = ends.map(|p| p.coordinates().map(IBig::clone));
            free = Some(caster.is_free(cells, &from, &to));
            pair.witness = Some(ends.map(|p| level(p.approx())));
            pair.width = Some(view.strip.width * graph.grid.step.length());
        }
        Some(Explanation::Hidden(hidden)) => {
            let ends = hidden.ends.left.iter().chain(&hidden.ends.right);
            pair.way = hidden.way.points.into_iter().map(level).collect();
            pair.ends = ends.map(|v| level(graph.vertices.approx(*v))).collect();
        }
        Some(Explanation::Same | Explanation::Apart) | None => {}
    }
    pair.confirmed = match error {
        Error::Missed => free == Some(true),
        Error::Invented => caster.joined(cells) == Some(false),
    };
    pair
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
