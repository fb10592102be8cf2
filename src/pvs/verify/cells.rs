//! Cells and portals against the walls: convex, paired, free of walls, closed.

use std::cmp::Ordering;

use super::walls::{Stretch, Walls};
use super::{Failure, Verified};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{GridPoint, Side, Vertex, orient};
use crate::pvs::file::PvsFile;

/// Checks all cells. Returns, for every edge, whether it faces the outside without an opaque wall.
pub(super) fn check(
    file: &PvsFile,
    walls: &Walls,
    done: &mut Verified,
) -> Result<Vec<bool>, Failure> {
    let graph = &file.graph;
    let mut near = Vec::new();
    for cell in graph.cell_ids() {
        convex(graph, cell)?;
        let corners: Vec<&Vertex> = graph
            .corners(cell)
            .map(|v| graph.vertices.exact(v))
            .collect();
        let (low, high) = extent(&corners);
        walls.all.near(low, high, &mut near);
        for &i in &near {
            let s = walls.all.list[i as usize];
            if passes_through(&corners, s) {
                return Err(Failure::WallInside(s.wall, cell));
            }
        }
    }
    let mut outer = vec![false; graph.edges.len()];
    for (id, edge) in (0u32..).map(EdgeId).zip(&graph.edges) {
        let ends = [edge.origin, graph.end(id)].map(|v| graph.vertices.exact(v));
        let (low, high) = extent(&ends);
        walls.opaque.near(low, high, &mut near);
        let opaque = collinear(ends, near.iter().map(|&i| walls.opaque.list[i as usize]));
        if let Some(twin) = edge.twin() {
            let other = graph.edge(twin);
            let fits = other.twin() == Some(id)
                && other.origin == graph.end(id)
                && graph.end(twin) == edge.origin;
            if !fits {
                return Err(Failure::Unpaired(id));
            }
            if let Some(s) = opaque.first() {
                return Err(Failure::WallOnPortal(s.2, id));
            }
            done.portals += usize::from(id < twin);
        } else if covers(ends, &opaque) {
            done.walls += 1;
        } else {
            // No wall stops sight here, so at least the level has to end here: at some wall.
            walls.all.near(low, high, &mut near);
            let any = collinear(ends, near.iter().map(|&i| walls.all.list[i as usize]));
            if !covers(ends, &any) {
                return Err(Failure::NoWall(id));
            }
            outer[id.0 as usize] = true;
            done.outer += 1;
        }
    }
    Ok(outer)
}

/// No corner twice, and every corner left of or on every edge, some left of it.
fn convex(graph: &CellGraph, cell: CellId) -> Result<(), Failure> {
    let ids: Vec<_> = graph.corners(cell).collect();
    let n = ids.len();
    for i in 0..n {
        let (p, q) = (
            graph.vertices.exact(ids[i]),
            graph.vertices.exact(ids[(i + 1) % n]),
        );
        let sides = || ids.iter().map(|&v| orient(p, q, graph.vertices.exact(v)));
        let again = ids[i + 1..].contains(&ids[i]);
        if again || sides().any(|s| s == Side::Right) || !sides().any(|s| s == Side::Left) {
            return Err(Failure::NotConvex(cell));
        }
    }
    Ok(())
}

/// A box of whole steps around the vertices.
fn extent(vertices: &[&Vertex]) -> (GridPoint, GridPoint) {
    let floor = |n: i128, v: &Vertex| n.div_euclid(i128::from(v.w())) as i64;
    let xs = || vertices.iter().map(|v| floor(v.x(), v));
    let ys = || vertices.iter().map(|v| floor(v.y(), v));
    let low = |numbers: &mut dyn Iterator<Item = i64>| numbers.min().unwrap_or(0);
    let high = |numbers: &mut dyn Iterator<Item = i64>| numbers.max().unwrap_or(0) + 1;
    (
        GridPoint::new(low(&mut xs()), low(&mut ys())),
        GridPoint::new(high(&mut xs()), high(&mut ys())),
    )
}

/// Whether a segment has a point inside an open convex polygon. They are apart exactly if a line
/// along an edge of the polygon, or along the segment, has them on its two sides.
fn passes_through(corners: &[&Vertex], s: Stretch) -> bool {
    let ends: [Vertex; 2] = [s.from.into(), s.to.into()];
    let n = corners.len();
    let behind_an_edge = (0..n).any(|i| {
        let (p, q) = (corners[i], corners[(i + 1) % n]);
        ends.iter().all(|end| orient(p, q, end) != Side::Left)
    });
    let sides = || corners.iter().map(|v| orient(&ends[0], &ends[1], v));
    !behind_an_edge
        && sides().any(|side| side == Side::Left)
        && sides().any(|side| side == Side::Right)
}

/// Along any one line this orders points from one end to the other.
fn compare(p: &Vertex, q: &Vertex) -> Ordering {
    p.cmp_x(q).then_with(|| p.cmp_y(q))
}

type Interval = (Vertex, Vertex, crate::level::WallId);

/// The walls that share more than a point with an edge, as intervals in order.
fn collinear(ends: [&Vertex; 2], walls: impl Iterator<Item = Stretch>) -> Vec<Interval> {
    let (low, high) = ordered(ends[0], ends[1]);
    let mut found: Vec<Interval> = walls
        .filter_map(|s| {
            let (p, q): (Vertex, Vertex) = (s.from.into(), s.to.into());
            let on = |v| orient(low, high, v) == Side::On;
            let (p, q) = if compare(&p, &q).is_lt() {
                (p, q)
            } else {
                (q, p)
            };
            let overlap = on(&p) && on(&q) && compare(&p, high).is_lt() && compare(low, &q).is_lt();
            overlap.then_some((p, q, s.wall))
        })
        .collect();
    found.sort_by(|a, b| compare(&a.0, &b.0));
    found
}

/// Whether the intervals leave no gap between the ends.
fn covers(ends: [&Vertex; 2], intervals: &[Interval]) -> bool {
    let (low, high) = ordered(ends[0], ends[1]);
    let mut at = *low;
    for (from, to, _) in intervals {
        if compare(from, &at).is_gt() {
            return false;
        }
        if compare(to, &at).is_gt() {
            at = *to;
        }
    }
    compare(&at, high).is_ge()
}

fn ordered<'a>(p: &'a Vertex, q: &'a Vertex) -> (&'a Vertex, &'a Vertex) {
    if compare(p, q).is_lt() {
        (p, q)
    } else {
        (q, p)
    }
}
