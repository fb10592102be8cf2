//! From a chain of portals to a view: the widest bundle of parallel sightlines around it, and one
//! sightline in its middle that is checked exactly.
//!
//! A chain's own strip is bounded by portal ends, and many of those exist only because the
//! subdivision cut there. So it is widened: what counts is walls alone. Let s be a sightline from A
//! to B. Every part of a wall in the convex hull of A and B, between the two, lies left of s or
//! right of s, and a segment from A to B belongs to the same bundle if it leaves each on the same
//! side. The widest strip that separates the left ends from the right ones, and lies between two
//! corners of A and two of B, is sought by adding the ends that are found inside it, until there is
//! none.

use glam::DVec2;

use super::chain::{self, Best};
use super::corner::{Corner, corners_of};
use super::segment::{Point, Segment, on_line};
use super::strip::{End, Strip, widest};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::sight::{Stabbing, exact};

/// How one cell sees another.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The portals that the sightline crosses, as edges of the cells that it leaves.
    pub portals: Vec<EdgeId>,
    /// A sightline in the view's middle, from strictly inside the first cell to strictly inside the
    /// last; checked exactly.
    pub segment: Segment,
    /// The widest strip of parallel sightlines around it, and the wall ends that bound it.
    pub strip: Strip,
    /// Whether the search came to its end; otherwise there may be a wider view.
    pub complete: bool,
    /// Steps of the search.
    pub steps: u64,
}

/// How often a strip is narrowed by what stands in it, or widened by better corners of its cells.
const ROUNDS: usize = 64;

/// Bits behind the point with which a sightline's ends are tried, the simplest numbers first.
const BITS: [u32; 5] = [0, 4, 10, 20, 36];

/// The view along the best chain from `a` to `b`.
pub fn view(graph: &CellGraph, a: CellId, b: CellId, best: &Best) -> Option<View> {
    let chained = strip_of(graph, &best.chain);
    let widened = chained.as_ref().and_then(|s| widen(graph, a, b, &best.chain, s));
    let strips = widened.into_iter().chain(chained);
    let found = strips.into_iter().find_map(|strip| {
        let (segment, portals) = sightline(graph, a, b, &strip)?;
        Some((segment, portals, strip))
    });
    let (segment, portals, strip) = match found {
        Some(found) => found,
        // Too narrow for f64.
        None => narrow(graph, a, b, best)?,
    };
    Some(View {
        portals,
        segment,
        strip,
        complete: best.complete,
        steps: best.steps,
    })
}

fn strip_of(graph: &CellGraph, chain: &[EdgeId]) -> Option<Strip> {
    let at = |v| (graph.vertices.approx(v), v);
    let gates = chain::gates(graph, chain);
    let left: Vec<End> = gates.iter().map(|g| at(g.left)).collect();
    let right: Vec<End> = gates.iter().map(|g| at(g.right)).collect();
    widest(&left, &right)
}

/// The widest strip of sightlines from `a` to `b` that leave every wall on the same side as the
/// middle of `start` does.
fn widen(
    graph: &CellGraph,
    a: CellId,
    b: CellId,
    chain: &[EdgeId],
    start: &Strip,
) -> Option<Strip> {
    let at = |v| (graph.vertices.approx(v), v);
    let cells = [a, b].map(|cell| graph.corners(cell).map(at).collect::<Vec<End>>());
    let walls = walls_around(graph, &cells);
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for &edge in chain {
        let [l, r] = corners_of(graph, edge).map(|corner| corner == Corner::Jutting);
        left.extend(l.then(|| at(graph.end(edge))));
        right.extend(r.then(|| at(graph.edge(edge).origin)));
    }
    let mut best = None;
    let mut direction = start.direction;
    let mut between = [[usize::MAX; 2]; 2];
    for _ in 0..ROUNDS {
        let outermost = cells.each_ref().map(|corners| extremes(corners, direction));
        let cut = outermost == between;
        between = outermost;
        let ends = |side: usize, walls: &[End]| {
            let corners = [0, 1].map(|i| cells[i][between[i][side]]);
            [walls, &corners].concat()
        };
        let strip = widest(&ends(0, &left), &ends(1, &right))?;
        let n = left.len() + right.len();
        for wall in &walls {
            match standing_in(&strip, &cells, wall, start) {
                Some((true, end)) if !left.contains(&end) => left.push(end),
                Some((false, end)) if !right.contains(&end) => right.push(end),
                _ => {}
            }
        }
        direction = strip.direction;
        if n == left.len() + right.len() {
            // Nothing stands in it.
            best = Some(strip);
            if cut {
                break;
            }
        }
    }
    best
}

/// A wall, from right to left as seen from its cell.
type WallEdge = [End; 2];

/// The walls near the convex hull of two cells.
fn walls_around(graph: &CellGraph, cells: &[Vec<End>; 2]) -> Vec<WallEdge> {
    let points = || cells.iter().flatten().map(|c| c.0);
    let low = points().reduce(DVec2::min).unwrap_or_default();
    let high = points().reduce(DVec2::max).unwrap_or_default();
    let near = |[p, q]: &WallEdge| {
        p.0.max(q.0).cmpge(low).all() && p.0.min(q.0).cmple(high).all()
    };
    (0..graph.edges.len() as u32)
        .map(EdgeId)
        .filter(|&e| graph.edge(e).twin().is_none())
        .map(|e| [graph.edge(e).origin, graph.end(e)].map(|v| (graph.vertices.approx(v), v)))
        .filter(near)
        .collect()
}

/// Positions of the corners farthest left and farthest right, looking in a direction.
fn extremes(corners: &[End], direction: DVec2) -> [usize; 2] {
    let offset = |i: &usize| direction.perp_dot(corners[*i].0 - corners[0].0);
    let by = |i: &usize, j: &usize| offset(i).total_cmp(&offset(j));
    let all = || 0..corners.len();
    [
        all().max_by(by).unwrap_or_default(),
        all().min_by(by).unwrap_or_default(),
    ]
}

/// Whether a wall stands in a strip between the two cells: then on which side it has to be left
/// (true: left), and which of its ends has to be.
fn standing_in(
    strip: &Strip,
    cells: &[Vec<End>; 2],
    [p, q]: &WallEdge,
    start: &Strip,
) -> Option<(bool, End)> {
    let (low, high) = (strip.offset(p.0), strip.offset(q.0));
    // Sightlines meet it from its cell's side, if they do: it then runs from right to left.
    let (from, to) = (low.max(-0.5), high.min(0.5));
    if low >= high || from >= to {
        return None;
    }
    let middle = p.0.lerp(q.0, ((from + to) / 2.0 - low) / (high - low));
    let along = |corners: &[End]| {
        let [enter, leave] = chord(corners, middle, strip.direction)?;
        Some((enter + leave) / 2.0)
    };
    let (a, b) = (along(&cells[0]), along(&cells[1]));
    // No wall stands inside a cell, so it is enough to know on which side of the cell's middle.
    if a.is_some_and(|a| a >= 0.0) || b.is_some_and(|b| b <= 0.0) {
        return None;
    }
    Some(if start.offset(middle) > 0.0 {
        (true, *p)
    } else {
        (false, *q)
    })
}

/// Where the line through a point enters and leaves a convex polygon, as distances from the point.
fn chord(corners: &[End], point: DVec2, direction: DVec2) -> Option<[f64; 2]> {
    let n = corners.len();
    let mut met = [f64::INFINITY, f64::NEG_INFINITY];
    for i in 0..n {
        let (p, q) = (corners[i].0 - point, corners[(i + 1) % n].0 - point);
        let (f, g) = (direction.perp_dot(p), direction.perp_dot(q));
        if (f > 0.0) != (g > 0.0) {
            let t = direction.dot(p.lerp(q, f / (f - g)));
            met = [met[0].min(t), met[1].max(t)];
        }
    }
    (met[0] < met[1]).then_some(met)
}

/// A sightline along the middle of a strip, or near it, with simple numbers if possible; and the
/// portals that it crosses. Exact.
fn sightline(
    graph: &CellGraph,
    a: CellId,
    b: CellId,
    strip: &Strip,
) -> Option<(Segment, Vec<EdgeId>)> {
    let corners = |cell| {
        let at = |v| (graph.vertices.approx(v), v);
        graph.corners(cell).map(at).collect::<Vec<End>>()
    };
    let ends = [a, b].map(corners);
    for shift in [0.0, 0.125, -0.125] {
        let middle = strip.middle() + strip.direction.perp() * strip.width * shift;
        let inside = |corners: &Vec<End>| {
            let [enter, leave] = chord(corners, middle, strip.direction)?;
            Some(middle + strip.direction * (enter + leave) / 2.0)
        };
        let (Some(from), Some(to)) = (inside(&ends[0]), inside(&ends[1])) else {
            continue;
        };
        for bits in BITS {
            let [from, to] = [from, to].map(|p| Point::rounded(p, bits));
            let segment = Segment { from, to };
            if let Some(portals) = segment.portals(graph, a)
                && last_cell(graph, a, &portals) == b
            {
                return Some((segment, portals));
            }
        }
    }
    None
}

/// The cell in which a chain ends.
pub fn last_cell(graph: &CellGraph, start: CellId, chain: &[EdgeId]) -> CellId {
    let beyond = |&e: &EdgeId| Some(graph.edge(graph.edge(e).twin()?).cell);
    chain.last().and_then(beyond).unwrap_or(start)
}

/// A sightline through a chain so narrow that f64 finds none, in exact numbers.
fn narrow(
    graph: &CellGraph,
    a: CellId,
    b: CellId,
    best: &Best,
) -> Option<(Segment, Vec<EdgeId>, Strip)> {
    let gates = chain::gates(graph, &best.chain);
    let Stabbing::Line(line) = exact::stab(&graph.vertices, &gates) else {
        return None;
    };
    let segment = on_line(graph, [&line.a, &line.b, &line.c], a, b)?;
    let portals = segment.portals(graph, a)?;
    todo!()
}
