//! The fan of a vertex: the cells seen from it, by direction.
//!
//! From a point a chain of portals needs no hull: the directions that pass all of them are one
//! interval between two vertices. Walking depth first, counterclockwise, gives every cell's entry
//! and exit in the order of their directions, so nothing is ever sorted.

use glam::DVec2;

use crate::cells::{CellGraph, EdgeId};
use crate::geom::{Side, VertexId};

/// A direction from the fan's vertex: towards another vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// The vertex aimed at.
    pub to: VertexId,
    /// From the fan's vertex to it, in f64 (see [`crate::geom::Vertices`] for the error).
    pub d: DVec2,
}

/// A cell comes into view, or goes out of view, as the direction turns counterclockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    pub ray: Ray,
    pub cell: u32,
    pub enters: bool,
}

/// What remains to be walked.
enum Step {
    /// Enter the cell through the edge (an edge of the cell entered), between two directions.
    Enter(EdgeId, Ray, Ray),
    /// The cell's interval ends here.
    Exit(u32, Ray),
}

/// Room for walking one fan after the other without allocating.
#[derive(Default)]
pub(super) struct FanWalk {
    steps: Vec<Step>,
}

/// Cells with more edges than this are searched by halving instead of one edge after the other.
const MANY_EDGES: u32 = 16;

impl FanWalk {
    /// The fan of vertex `v` within consecutive cells around it. `bases` are edges that start in
    /// `v`, counterclockwise, each in the cell that follows the one before. Calls `event` in the
    /// order of directions. All intervals are open and not empty. Returns the number of cells
    /// entered.
    pub fn walk(
        &mut self,
        graph: &CellGraph,
        v: VertexId,
        bases: &[EdgeId],
        mut event: impl FnMut(Event),
    ) -> u64 {
        let origin = graph.vertices.approx(v);
        let ray = |to: VertexId| Ray { to, d: graph.vertices.approx(to) - origin };
        let mut entered = 0;
        for &base in bases {
            let cell = graph.edge(base).cell.0;
            let last_edge = graph.previous(base);
            let last = ray(graph.edge(last_edge).origin);
            let mut from = ray(graph.end(base));
            event(Event { ray: from, cell, enters: true });
            entered += 1;
            let mut e = graph.next(base);
            while e != last_edge {
                let to = ray(graph.end(e));
                if let Some(twin) = graph.edge(e).twin() {
                    let side = graph.vertices.orient_from(v, from.to, from.d, to.to, to.d);
                    // An edge in line with v (after a vertex in the middle of a side) is not seen.
                    if side == Side::Left {
                        self.steps.push(Step::Enter(twin, from, to));
                        entered += self.run(graph, v, &ray, &mut event);
                    }
                }
                from = to;
                e = graph.next(e);
            }
            event(Event { ray: last, cell, enters: false });
        }
        entered
    }

    fn run(
        &mut self,
        graph: &CellGraph,
        v: VertexId,
        ray: &impl Fn(VertexId) -> Ray,
        event: &mut impl FnMut(Event),
    ) -> u64 {
        let left_of =
            |p: &Ray, q: &Ray| graph.vertices.orient_from(v, p.to, p.d, q.to, q.d) == Side::Left;
        let mut entered = 0;
        while let Some(step) = self.steps.pop() {
            let (entry, low, high) = match step {
                Step::Exit(cell, ray) => {
                    event(Event { ray, cell, enters: false });
                    continue;
                }
                Step::Enter(entry, low, high) => (entry, low, high),
            };
            let cell = graph.edge(entry).cell;
            event(Event { ray: low, cell: cell.0, enters: true });
            entered += 1;
            self.steps.push(Step::Exit(cell.0, high));
            // Seen from v, the ends of the edges that follow the entry counterclockwise turn from
            // its right end to its left end: first come those not left of `low`.
            let range = graph.edge_range(cell);
            let n = range.end - range.start;
            let after = |k: u32| {
                let i = entry.0 + k;
                EdgeId(if i < range.end { i } else { i - n })
            };
            let mut k = 1;
            if n > MANY_EDGES {
                let (mut below, mut above) = (0, n - 1);
                while above - below > 1 {
                    let middle = (below + above) / 2;
                    if left_of(&low, &ray(graph.end(after(middle)))) {
                        above = middle;
                    } else {
                        below = middle;
                    }
                }
                k = above;
            } else {
                while !left_of(&low, &ray(graph.end(after(k)))) {
                    k += 1;
                }
            }
            let children = self.steps.len();
            let mut from = low;
            loop {
                let e = after(k);
                let end = ray(graph.end(e));
                let inside = left_of(&end, &high);
                let to = if inside { end } else { high };
                if let Some(twin) = graph.edge(e).twin() {
                    self.steps.push(Step::Enter(twin, from, to));
                }
                if !inside {
                    break;
                }
                from = to;
                k += 1;
            }
            // The first child is walked first.
            self.steps[children..].reverse();
        }
        entered
    }
}
