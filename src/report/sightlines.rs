//! Sample sightlines: free segments from a cell to cells that it sees, each checked exactly.
//!
//! In: cells, PVS and a source. Out: segments between grid points strictly inside cells that cross
//! nothing but portals, and those not in their ends. They are found by trying, so narrow sights may
//! have none here; what is here is true.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Directed, GRID_LIMIT, GridPoint, Side, Vertex, orient};
use crate::pvs::Pvs;

/// How many segments are tried for a pair of cells.
const TRIES: usize = 150;

/// A free segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sightline {
    /// Its start, strictly inside the source cell.
    pub from: GridPoint,
    /// Its end, strictly inside `cell`.
    pub to: GridPoint,
    /// The cell that is seen.
    pub cell: CellId,
}

/// At most `n` sightlines from `source`, to cells spread widely over what it sees. The same
/// arguments give the same lines.
pub fn sample(graph: &CellGraph, pvs: &Pvs, source: CellId, n: usize) -> Vec<Sightline> {
    let mut random = Pcg64Mcg::seed_from_u64(u64::from(source.0));
    let mut open: Vec<(CellId, DVec2, f64)> = pvs
        .seen_from(source)
        .filter(|&cell| cell != source)
        .map(|cell| (cell, middle(graph, cell), f64::INFINITY))
        .collect();
    let start = middle(graph, source);
    open.iter_mut()
        .for_each(|o| o.2 = o.1.distance_squared(start));
    let mut lines = Vec::new();
    let mut failures = 0;
    while lines.len() < n && failures < 4 * n {
        // The cell farthest from all that have a line already, so that the lines spread.
        let farthest = (0..open.len()).max_by(|&i, &j| open[i].2.total_cmp(&open[j].2));
        let Some(i) = farthest else { break };
        let (cell, at, _) = open.swap_remove(i);
        match find(graph, source, cell, &mut random) {
            Some(line) => {
                lines.push(line);
                open.iter_mut()
                    .for_each(|o| o.2 = o.2.min(o.1.distance_squared(at)));
            }
            None => failures += 1,
        }
    }
    lines
}

fn find(
    graph: &CellGraph,
    source: CellId,
    target: CellId,
    random: &mut Pcg64Mcg,
) -> Option<Sightline> {
    (0..TRIES).find_map(|i| {
        let (from, to) = if i % 2 == 0 {
            (
                point_inside(graph, source, random)?,
                point_inside(graph, target, random)?,
            )
        } else {
            through_portals(graph, source, target, random)?
        };
        let free = is_inside(graph, source, from) && walk(graph, source, from, to) == Some(target);
        free.then_some(Sightline {
            from,
            to,
            cell: target,
        })
    })
}

/// A segment that leaves the source through one of its portals, enters the target through another,
/// and goes a little farther at both ends: it may end outside of the two.
fn through_portals(
    graph: &CellGraph,
    source: CellId,
    target: CellId,
    random: &mut Pcg64Mcg,
) -> Option<(GridPoint, GridPoint)> {
    let [out, into] = [source, target].map(|cell| {
        let portals = graph
            .edge_range(cell)
            .map(EdgeId)
            .filter(|&e| graph.edge(e).twin().is_some());
        let portals: Vec<EdgeId> = portals.collect();
        let edge = *portals.get(random.random_range(0..portals.len().max(1)))?;
        let [p, q] = [graph.edge(edge).origin, graph.end(edge)].map(|v| graph.vertices.approx(v));
        Some((p.lerp(q, random.random()), size(graph, cell)))
    });
    let ((a, before), (b, after)) = (out?, into?);
    let direction = (b - a).try_normalize()?;
    let from = a - direction * before * random.random::<f64>();
    let to = b + direction * after * random.random::<f64>();
    Some((rounded(from), rounded(to)))
}

/// The longer side of a cell's extent, in grid steps.
fn size(graph: &CellGraph, cell: CellId) -> f64 {
    let middle = middle(graph, cell);
    let reach = |v| (graph.vertices.approx(v) - middle).abs().max_element();
    2.0 * graph
        .polygon(cell)
        .into_iter()
        .map(reach)
        .fold(0.0, f64::max)
}

fn rounded(p: DVec2) -> GridPoint {
    let limit = (GRID_LIMIT - 1) as f64;
    let p = p.round().clamp(DVec2::splat(-limit), DVec2::splat(limit));
    GridPoint::new(p.x as i64, p.y as i64)
}

/// The mean of a cell's corners, in grid steps.
pub(super) fn middle(graph: &CellGraph, cell: CellId) -> DVec2 {
    let corners = graph.polygon(cell);
    let sum: DVec2 = corners.iter().map(|&v| graph.vertices.approx(v)).sum();
    sum / corners.len().max(1) as f64
}

/// A random grid point strictly inside a cell; `None` after a few misses (a sliver may hold none).
fn point_inside(graph: &CellGraph, cell: CellId, random: &mut Pcg64Mcg) -> Option<GridPoint> {
    let corners: Vec<DVec2> = graph
        .polygon(cell)
        .iter()
        .map(|&v| graph.vertices.approx(v))
        .collect();
    (0..4).find_map(|_| {
        let weights: Vec<f64> = corners
            .iter()
            .map(|_| -random.random::<f64>().ln_1p())
            .collect();
        let total: f64 = weights.iter().sum();
        let sum: DVec2 = corners.iter().zip(&weights).map(|(&p, &w)| p * w).sum();
        let p = sum / total;
        if !p.is_finite() {
            return None;
        }
        let point = rounded(p);
        is_inside(graph, cell, point).then_some(point)
    })
}

/// Whether a point lies strictly inside a cell.
pub fn is_inside(graph: &CellGraph, cell: CellId, point: GridPoint) -> bool {
    let point: Vertex = point.into();
    graph.edge_range(cell).map(EdgeId).all(|e| {
        let ends = [graph.edge(e).origin, graph.end(e)].map(|v| graph.vertices.exact(v));
        orient(ends[0], ends[1], &point) == Side::Left
    })
}

/// Follows the segment from a point strictly inside `cell`: the cell in which it ends strictly
/// inside, or `None` if it meets a wall, a vertex, or ends on a portal.
pub fn walk(graph: &CellGraph, mut cell: CellId, from: GridPoint, to: GridPoint) -> Option<CellId> {
    if from == to {
        return Some(cell);
    }
    let (line, q): (_, Vertex) = (Directed::through(from, to)?, to.into());
    let vertices = &graph.vertices;
    let side = |e: EdgeId| vertices.side_along(&line, &vertices.placed(graph.edge(e).origin));
    loop {
        // A ray leaves a convex cell through the edge that goes from its right to its left.
        let exit = graph
            .edge_range(cell)
            .map(EdgeId)
            .find(|&e| side(e) == Side::Right && side(graph.next(e)) == Side::Left)?;
        let ends = [graph.edge(exit).origin, graph.end(exit)].map(|v| graph.vertices.exact(v));
        match orient(ends[0], ends[1], &q) {
            Side::Left => return Some(cell),
            Side::On => return None,
            Side::Right => cell = graph.edge(graph.edge(exit).twin()?).cell,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Locator, Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::{Progress, sweep::sweep};

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";

    #[test]
    fn lines_are_free_and_end_where_they_say() {
        let level = read(ROOMS.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let pvs = sweep(&graph, &Progress::default());
        for source in graph.cell_ids() {
            let lines = sample(&graph, &pvs, source, 10);
            assert_eq!(lines.len(), pvs.seen_from(source).count() - 1);
            for line in lines {
                assert!(is_inside(&graph, line.cell, line.to));
                assert_eq!(walk(&graph, line.cell, line.to, line.from), Some(source));
            }
        }
    }

    #[test]
    fn a_wall_stops_a_line() {
        let level = read(ROOMS.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let at = |x, y| level.grid.nearest(DVec2::new(x, y)).unwrap();
        let start = Locator::new(&graph).cell_at(&graph, at(1.0, 1.0)).unwrap();
        let end = Locator::new(&graph).cell_at(&graph, at(7.0, 3.0)).unwrap();
        assert_eq!(walk(&graph, start, at(1.0, 1.0), at(7.0, 1.0)), None);
        assert_eq!(walk(&graph, start, at(1.0, 1.0), at(7.0, 3.0)), Some(end));
    }
}
