//! From a chain of portals to a view: the widest bundle of parallel sightlines around it, and one
//! sightline in its middle that is checked exactly.
//!
//! A chain's own strip is bounded by portal ends, and many of those exist only because the
//! subdivision cut there. So it is widened: what counts is walls alone. Let s be a sightline from A
//! to B. Every part of a wall in the convex hull of A and B, between the two, lies left of s or
//! right of s, and a segment from A to B belongs to the same bundle if it leaves each on the same
//! side. The widest strip that separates the left ends from the right ones, and lies between two
//! corners of A and two of B, is sought by adding the ends of walls that are found inside it, until
//! there is none.

use std::collections::BTreeSet;

use glam::DVec2;

use super::chain::{self, Best};
use super::corner::{Corner, corner_at, corners_of};
use super::segment::{Point, Segment, on_line};
use super::space::Space;
use super::strip::{self, Strip};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::VertexId;

/// How one cell sees another.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The portals that the sightline crosses, as edges of the cells that it leaves.
    pub portals: Vec<EdgeId>,
    /// A sightline in the view's middle, from strictly inside the first cell to strictly inside the
    /// last; checked exactly.
    pub segment: Segment,
    /// The widest strip of parallel sightlines around it, and the ends that bound it.
    pub strip: Strip,
    /// On the left and on the right: where the ends that bound the strip are only corners of the two
    /// cells, and no corner of walls, the nearest wall beside it.
    pub beside: [Option<Beside>; 2],
    /// Width in grid steps of the widest strip that one chain of portals lets through, whatever
    /// stands at the portals' ends. The strip around the sightline is at least as wide.
    pub slack: f64,
    /// Whether no chain lets a wider strip through; otherwise the search ended before it knew.
    pub complete: bool,
    /// Steps of the search.
    pub steps: u64,
    /// Whether they see each other in space, if that was asked.
    pub space: Option<Space>,
}

/// The nearest wall beside a strip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// An edge of a cell on which the wall stands.
    pub wall: EdgeId,
    /// The place, in grid steps.
    pub at: DVec2,
    /// The vertex there, if the place is an end of the edge.
    pub end: Option<VertexId>,
    /// Distance from the strip's border, in grid steps.
    pub distance: f64,
}

impl View {
    /// The corners of the bundle of sightlines between two cells, counterclockwise from the left one
    /// in `a`, in grid steps: where its borders have their middle in either cell.
    pub fn outline(&self, graph: &CellGraph, a: CellId, b: CellId) -> [DVec2; 4] {
        let Strip {
            width,
            direction,
            middle,
            ..
        } = self.strip;
        let corner = |cell: CellId, share: f64, end: &Point| {
            // A border may do no more than touch a cell's corner: a hair's breadth inside.
            let at = middle + direction.perp() * (width * share);
            let along = Corners::of(graph, cell).along(at, direction);
            at + direction * along.unwrap_or_else(|| direction.dot(end.approx() - at))
        };
        let Segment { from, to } = &self.segment;
        let inside = 0.5 - 2f64.powi(-12);
        [
            corner(a, inside, from),
            corner(a, -inside, from),
            corner(b, -inside, to),
            corner(b, inside, to),
        ]
    }
}

/// How often a strip is narrowed by what stands in it, or widened by better corners of its cells.
const ROUNDS: usize = 64;

/// Bits behind the point with which a sightline's ends are tried, the simplest numbers first.
const BITS: [u32; 5] = [0, 4, 10, 20, 36];

/// The view along the best chain from `a` to `b`.
pub fn view(graph: &CellGraph, a: CellId, b: CellId, best: &Best) -> Option<View> {
    let chained = strip::between(&graph.vertices, &chain::gates(graph, &best.chain)).ok()?;
    let cells = [a, b].map(|cell| Corners::of(graph, cell));
    let widened = widen(graph, &cells, &best.chain, &chained);
    let widened = widened.filter(|strip| strip.width >= chained.width);
    let strips = [widened.as_ref(), Some(&chained)];
    strips.into_iter().flatten().find_map(|strip| {
        let (segment, portals) = sightline(graph, &cells, strip)?;
        Some(View {
            beside: beside(graph, &cells, strip, &portals),
            portals,
            segment,
            strip: strip.clone(),
            slack: chained.width,
            complete: best.complete,
            steps: best.steps,
            space: None,
        })
    })
}

/// The cell in which a chain ends.
pub fn last_cell(graph: &CellGraph, start: CellId, chain: &[EdgeId]) -> CellId {
    let beyond = |&e: &EdgeId| Some(graph.edge(graph.edge(e).twin()?).cell);
    chain.last().and_then(beyond).unwrap_or(start)
}

/// A cell with its corners.
struct Corners {
    cell: CellId,
    ids: Vec<VertexId>,
    at: Vec<DVec2>,
}

impl Corners {
    fn of(graph: &CellGraph, cell: CellId) -> Self {
        let ids = graph.polygon(cell);
        let at = ids.iter().map(|&v| graph.vertices.approx(v)).collect();
        Self { cell, ids, at }
    }

    /// The corners farthest left and farthest right, looking in a direction.
    fn outermost(&self, direction: DVec2) -> [VertexId; 2] {
        let offset = |i: &usize| direction.perp_dot(self.at[*i] - self.at[0]);
        let by = |i: &usize, j: &usize| offset(i).total_cmp(&offset(j));
        let all = || 0..self.at.len();
        let [left, right] = [all().max_by(by), all().min_by(by)];
        [left, right].map(|i| self.ids[i.unwrap_or_default()])
    }

    /// The middle of what a line through a point has in the cell, as a distance from the point.
    fn along(&self, point: DVec2, direction: DVec2) -> Option<f64> {
        let [enter, leave] = self.chord(point, direction)?;
        Some((enter + leave) / 2.0)
    }

    /// Where a line through a point enters and leaves the cell, as distances from the point.
    fn chord(&self, point: DVec2, direction: DVec2) -> Option<[f64; 2]> {
        let n = self.at.len();
        let mut met = [f64::INFINITY, f64::NEG_INFINITY];
        for i in 0..n {
            let (p, q) = (self.at[i] - point, self.at[(i + 1) % n] - point);
            let (f, g) = (direction.perp_dot(p), direction.perp_dot(q));
            if (f > 0.0) != (g > 0.0) {
                let t = direction.dot(p.lerp(q, f / (f - g)));
                met = [met[0].min(t), met[1].max(t)];
            }
        }
        (met[0] < met[1]).then_some(met)
    }
}

/// The widest strip between two cells that leaves every wall on the same side as the middle of
/// `start` does.
fn widen(
    graph: &CellGraph,
    cells: &[Corners; 2],
    chain: &[EdgeId],
    start: &Strip,
) -> Option<Strip> {
    let walls = walls_around(graph, cells);
    let [mut left, mut right] = [Vec::new(), Vec::new()];
    for &edge in chain {
        let [l, r] = corners_of(graph, edge).map(|corner| corner == Corner::Jutting);
        left.extend(l.then(|| graph.end(edge)));
        right.extend(r.then(|| graph.edge(edge).origin));
    }
    let mut best: Option<Strip> = None;
    let mut direction = start.direction;
    for _ in 0..ROUNDS {
        let [a, b] = cells.each_ref().map(|cell| cell.outermost(direction));
        let strip = strip::widest(
            &graph.vertices,
            &[&left[..], &[a[0], b[0]]].concat(),
            &[&right[..], &[a[1], b[1]]].concat(),
        )
        .ok()?;
        let n = left.len() + right.len();
        for wall in &walls {
            match wall.standing_in(&strip, cells, start) {
                Some((true, end)) if !left.contains(&end) => left.push(end),
                Some((false, end)) if !right.contains(&end) => right.push(end),
                _ => {}
            }
        }
        direction = strip.direction;
        if n == left.len() + right.len() {
            // Nothing stands in it. In its own direction the cells may have better corners.
            if best.as_ref().is_some_and(|best| strip.width <= best.width) {
                break;
            }
            best = Some(strip);
        }
    }
    best
}

/// A wall, as the edge of a cell: from right to left for whoever meets it there.
struct WallEdge {
    ids: [VertexId; 2],
    at: [DVec2; 2],
}

/// The walls near the convex hull of two cells.
fn walls_around(graph: &CellGraph, cells: &[Corners; 2]) -> Vec<WallEdge> {
    let points = || cells.iter().flat_map(|c| &c.at).copied();
    let low = points().reduce(DVec2::min).unwrap_or_default();
    let high = points().reduce(DVec2::max).unwrap_or_default();
    (0..graph.edges.len() as u32)
        .map(EdgeId)
        .filter(|&e| graph.edge(e).twin().is_none())
        .filter_map(|e| {
            let ids = [graph.edge(e).origin, graph.end(e)];
            let at = ids.map(|v| graph.vertices.approx(v));
            let [p, q] = at;
            let near = p.max(q).cmpge(low).all() && p.min(q).cmple(high).all();
            near.then_some(WallEdge { ids, at })
        })
        .collect()
}

impl WallEdge {
    /// Whether the wall stands in a strip between two cells: then on which side it has to be left
    /// (true: left), and which of its ends must be.
    fn standing_in(
        &self,
        strip: &Strip,
        cells: &[Corners; 2],
        start: &Strip,
    ) -> Option<(bool, VertexId)> {
        let [low, high] = self.at.map(|p| strip.offset(p));
        // Whoever meets a wall comes from its cell: it then runs from right to left.
        let (from, to) = (low.max(-0.5), high.min(0.5));
        if low >= high || from >= to {
            return None;
        }
        let middle = self.at[0].lerp(self.at[1], ((from + to) / 2.0 - low) / (high - low));
        let [a, b] = cells
            .each_ref()
            .map(|cell| cell.along(middle, strip.direction));
        // No wall stands inside a cell, so it is enough to ask on which side of the cell's middle.
        if a.is_some_and(|a| a >= 0.0) || b.is_some_and(|b| b <= 0.0) {
            return None;
        }
        Some(if start.offset(middle) > 0.0 {
            (true, self.ids[0])
        } else {
            (false, self.ids[1])
        })
    }
}

/// A sightline along the middle of a strip, or near it, with simple numbers if possible; and the
/// portals that it crosses. Exact.
fn sightline(
    graph: &CellGraph,
    cells: &[Corners; 2],
    strip: &Strip,
) -> Option<(Segment, Vec<EdgeId>)> {
    let [a, b] = cells.each_ref().map(|c| c.cell);
    let crossed = |segment: Segment| {
        let portals = segment.portals(graph, a)?;
        (last_cell(graph, a, &portals) == b).then_some((segment, portals))
    };
    for shift in [0.0, 0.125, -0.125] {
        let middle = strip.middle + strip.direction.perp() * strip.width * shift;
        let [from, to] = cells.each_ref().map(|cell| {
            let along = cell.along(middle, strip.direction)?;
            Some(middle + strip.direction * along)
        });
        let Some((from, to)) = from.zip(to) else {
            continue;
        };
        let simplest = BITS.iter().find_map(|&bits| {
            let [from, to] = [from, to].map(|p| Point::rounded(p, bits));
            crossed(Segment { from, to })
        });
        if simplest.is_some() {
            return simplest;
        }
    }
    let line = &strip.line;
    on_line(graph, [&line.a, &line.b, &line.c], a, b).and_then(crossed)
}

/// On either side of a strip, the nearest wall between the two cells or at the end of a portal on
/// the way; none where a corner of walls bounds the strip.
fn beside(
    graph: &CellGraph,
    cells: &[Corners; 2],
    strip: &Strip,
    portals: &[EdgeId],
) -> [Option<Beside>; 2] {
    let chords = cells
        .each_ref()
        .map(|c| c.chord(strip.middle, strip.direction));
    let [Some([_, from]), Some([to, _])] = chords else {
        return [None; 2];
    };
    let crossed: BTreeSet<VertexId> = portals
        .iter()
        .flat_map(|&e| [graph.edge(e).origin, graph.end(e)])
        .collect();
    let mut nearest: [Option<Beside>; 2] = [None; 2];
    let mut bounded = [false; 2];
    for wall in (0..graph.edges.len() as u32).map(EdgeId) {
        if graph.edge(wall).twin().is_some() {
            continue;
        }
        let ends = [graph.edge(wall).origin, graph.end(wall)];
        for (bounded, side) in bounded.iter_mut().zip([&strip.left, &strip.right]) {
            let juts = |v: &VertexId| {
                let starts = [wall, graph.next(wall)].into_iter();
                let mut here = starts.filter(|&e| graph.edge(e).origin == *v);
                here.any(|e| corner_at(graph, e) == Corner::Jutting)
            };
            *bounded |= side.iter().any(|v| ends.contains(v) && juts(v));
        }
        let at = ends.map(|v| graph.vertices.approx(v));
        let along = at.map(|p| strip.direction.dot(p - strip.middle));
        let mut consider = |at: DVec2, end: Option<VertexId>| {
            let offset = strip.offset(at) * strip.width;
            let nearest = &mut nearest[usize::from(offset < 0.0)];
            let distance = (offset.abs() - strip.width / 2.0).max(0.0);
            if nearest.is_none_or(|n| distance < n.distance) {
                *nearest = Some(Beside {
                    wall,
                    at,
                    end,
                    distance,
                });
            }
        };
        for i in [0, 1] {
            if (from <= along[i] && along[i] <= to) || crossed.contains(&ends[i]) {
                consider(at[i], Some(ends[i]));
            }
        }
        // Where the wall comes in from before the one cell or beyond the other.
        for limit in [from, to] {
            let share = (limit - along[0]) / (along[1] - along[0]);
            if share > 0.0 && share < 1.0 {
                consider(at[0].lerp(at[1], share), None);
            }
        }
    }
    [0, 1].map(|i| nearest[i].filter(|_| !bounded[i]))
}
