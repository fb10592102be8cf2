//! What stands on the straight line between two points.

use glam::DVec2;

use crate::cells::{CellGraph, EdgeId};
use crate::geom::{GridPoint, Side, Vertex, orient};

/// What a segment meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Straight {
    /// No wall.
    Free,
    /// Walls, but it crosses none: it touches an end, or runs along.
    Touches {
        /// The first such wall, as an edge of a cell.
        wall: EdgeId,
        /// Where, in grid steps.
        at: DVec2,
    },
    /// It crosses a wall.
    Blocked {
        /// The first wall, as an edge of a cell.
        wall: EdgeId,
        /// Where, in grid steps.
        at: DVec2,
    },
}

/// What the closed segment between two points meets; exact but for the place. O(edges).
pub fn straight(graph: &CellGraph, from: GridPoint, to: GridPoint) -> Straight {
    let (p, q): (Vertex, Vertex) = (from.into(), to.into());
    let start = p.approx();
    let course = q.approx() - start;
    let mut first: [Option<(f64, EdgeId)>; 2] = [None; 2];
    for edge in (0..graph.edges.len() as u32).map(EdgeId) {
        if graph.edge(edge).twin().is_some() {
            continue;
        }
        let [u, v] = [graph.edge(edge).origin, graph.end(edge)];
        let ends = [u, v].map(|v| graph.vertices.exact(v));
        let (f, g) = (orient(&p, &q, ends[0]), orient(&p, &q, ends[1]));
        if f == g && f != Side::On {
            continue;
        }
        let (h, k) = (orient(ends[0], ends[1], &p), orient(ends[0], ends[1], &q));
        if h == k && h != Side::On {
            continue;
        }
        let offsets = [u, v].map(|v| graph.vertices.approx(v) - start);
        let share = if f == g {
            // All on one line: only what overlaps is met.
            let along = offsets.map(|d| d.dot(course) / course.length_squared());
            let (low, high) = (along[0].min(along[1]), along[0].max(along[1]));
            if !(low <= 1.0 && high >= 0.0) {
                continue;
            }
            low.max(0.0)
        } else {
            let [f, g] = offsets.map(|d| course.perp_dot(d));
            let on_wall = offsets[0].lerp(offsets[1], f / (f - g));
            on_wall.dot(course) / course.length_squared()
        };
        let strictly = [f, g, h, k].iter().all(|&side| side != Side::On);
        let nearest = &mut first[usize::from(strictly)];
        if nearest.is_none_or(|(best, _)| share < best) {
            *nearest = Some((share, edge));
        }
    }
    let place = |share: f64| start + course * share;
    match first {
        [_, Some((share, wall))] => Straight::Blocked {
            wall,
            at: place(share),
        },
        [Some((share, wall)), None] => Straight::Touches {
            wall,
            at: place(share),
        },
        [None, None] => Straight::Free,
    }
}
