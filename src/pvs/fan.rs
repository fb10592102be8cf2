//! The fan of a vertex: the cells seen from it, by direction.
//!
//! From a point a chain of portals needs no hull: the directions that pass all of them are one
//! interval between two vertices. Walking depth first, counterclockwise, gives every cell's entry
//! and exit in the order of their directions, so nothing is ever sorted.

use glam::DVec2;

use crate::cells::{CellGraph, EdgeId};
use crate::geom::{Side, VertexId, Vertices};

/// A direction from the fan's vertex: towards another vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// The vertex aimed at.
    pub to: VertexId,
    /// From the fan's vertex to it, in f64 (see [`Vertices`] for the error).
    pub d: DVec2,
}

/// A cell comes into view, or goes out of view, as the direction turns counterclockwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    pub ray: Ray,
    pub cell: u32,
    pub enters: bool,
}

/// The graph's edges as the walk needs them: everything about one edge in one place.
pub(super) struct FanMesh<'a> {
    graph: &'a CellGraph,
    edges: Vec<FanEdge>,
}

#[derive(Clone, Copy)]
struct FanEdge {
    /// Where the edge ends, in f64.
    at: DVec2,
    end: VertexId,
    /// The same stretch in the neighbouring cell; `u32::MAX` for a wall.
    twin: u32,
    /// The edge's own cell, and where its edges start and end.
    cell: u32,
    first: u32,
    past: u32,
}

impl<'a> FanMesh<'a> {
    pub fn new(graph: &'a CellGraph) -> Self {
        let edge = |i: u32| {
            let edge = graph.edge(EdgeId(i));
            let range = graph.edge_range(edge.cell);
            let end = graph.end(EdgeId(i));
            FanEdge {
                at: graph.vertices.approx(end),
                end,
                twin: edge.twin().map_or(u32::MAX, |t| t.0),
                cell: edge.cell.0,
                first: range.start,
                past: range.end,
            }
        };
        Self { graph, edges: (0..graph.edges.len() as u32).map(edge).collect() }
    }
}

/// What of a fan is wanted.
#[derive(Clone, Copy)]
pub(super) enum Wanted {
    /// All of it.
    All,
    /// Only the directions whose opposite is within the group too. Those are in a wide group from
    /// its first direction to the opposite of its last, and from the opposite of the first to the
    /// last; what lies wholly between may be left out.
    Opposable {
        /// First direction of the group.
        first: Ray,
        /// Last direction of the group; not the first after a full turn.
        last: Ray,
    },
}

/// A part of the fan that remains to be walked.
enum Step {
    /// Enter the cell through the edge (an edge of the cell entered), between two directions.
    /// `asks` whether parts of it may be unwanted.
    Enter { entry: u32, low: Ray, high: Ray, asks: bool },
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

/// Tests about one vertex.
struct About<'a> {
    vertices: &'a Vertices,
    v: VertexId,
    origin: DVec2,
    wanted: Wanted,
}

impl About<'_> {
    #[inline]
    fn ray(&self, edge: &FanEdge) -> Ray {
        Ray { to: edge.end, d: edge.at - self.origin }
    }

    #[inline]
    fn side(&self, p: &Ray, q: &Ray) -> Side {
        self.vertices.orient_from(self.v, p.to, p.d, q.to, q.d)
    }

    /// Whether `q` is strictly counterclockwise of `p`, for directions less than a half turn apart.
    #[inline]
    fn is_left(&self, p: &Ray, q: &Ray) -> bool {
        self.side(p, q) == Side::Left
    }

    /// How much between two directions is wanted.
    fn want(&self, low: &Ray, high: &Ray) -> Want {
        let Wanted::Opposable { first, last } = &self.wanted else { return Want::All };
        // Less than a half turn from the group's end on; up to a half turn from its start.
        let late = |ray| self.side(ray, last) != Side::Right;
        let early = |ray| self.side(first, ray) != Side::Right;
        if late(low) {
            if early(high) {
                Want::Nothing
            } else if early(low) {
                Want::Some
            } else {
                Want::All
            }
        } else if late(high) {
            Want::Some
        } else {
            Want::All
        }
    }
}

/// How much of an interval of directions is wanted.
enum Want {
    All,
    Some,
    Nothing,
}

impl FanWalk {
    /// The fan of vertex `v` within consecutive cells around it. `bases` are edges that start in
    /// `v`, counterclockwise, each in the cell that follows the one before. Calls `event` in the
    /// order of directions; the cells around `v` come in any case. All intervals are open and not
    /// empty. Returns the number of cells entered.
    pub fn walk(
        &mut self,
        mesh: &FanMesh,
        v: VertexId,
        bases: &[EdgeId],
        wanted: Wanted,
        mut event: impl FnMut(Event),
    ) -> u64 {
        let graph = mesh.graph;
        let vertices = &graph.vertices;
        let about = About { vertices, v, origin: vertices.approx(v), wanted };
        let asks = matches!(wanted, Wanted::Opposable { .. });
        let mut entered = 0;
        for &base in bases {
            let cell = graph.edge(base).cell.0;
            let last_edge = graph.previous(base);
            let mut from = about.ray(&mesh.edges[base.0 as usize]);
            event(Event { ray: from, cell, enters: true });
            entered += 1;
            let mut e = graph.next(base);
            while e != last_edge {
                let edge = &mesh.edges[e.0 as usize];
                let to = about.ray(edge);
                // An edge in line with v (after a vertex in the middle of a side) is not seen.
                if edge.twin != u32::MAX && about.is_left(&from, &to) {
                    self.steps.push(Step::Enter { entry: edge.twin, low: from, high: to, asks });
                    entered += self.run(mesh, &about, &mut event);
                }
                from = to;
                e = graph.next(e);
            }
            event(Event { ray: from, cell, enters: false });
        }
        entered
    }

    fn run(&mut self, mesh: &FanMesh, about: &About, event: &mut impl FnMut(Event)) -> u64 {
        let mut entered = 0;
        while let Some(step) = self.steps.pop() {
            let (entry, low, high, mut asks) = match step {
                Step::Exit(cell, ray) => {
                    event(Event { ray, cell, enters: false });
                    continue;
                }
                Step::Enter { entry, low, high, asks } => (entry, low, high, asks),
            };
            if asks {
                match about.want(&low, &high) {
                    Want::Nothing => continue,
                    Want::All => asks = false,
                    Want::Some => {}
                }
            }
            let FanEdge { cell, first, past, .. } = mesh.edges[entry as usize];
            event(Event { ray: low, cell, enters: true });
            entered += 1;
            self.steps.push(Step::Exit(cell, high));
            // Seen from v, the ends of the edges that follow the entry counterclockwise turn from
            // its right end to its left end: first come those not left of `low`.
            let next = |e: u32| if e + 1 == past { first } else { e + 1 };
            let mut e = next(entry);
            let n = past - first;
            let mut end = about.ray(&mesh.edges[e as usize]);
            if n > MANY_EDGES {
                let after = |k: u32| if entry + k < past { entry + k } else { entry + k - n };
                let (mut below, mut above) = (0, n - 1);
                while above - below > 1 {
                    let middle = (below + above) / 2;
                    if about.is_left(&low, &about.ray(&mesh.edges[after(middle) as usize])) {
                        above = middle;
                    } else {
                        below = middle;
                    }
                }
                e = after(above);
                end = about.ray(&mesh.edges[e as usize]);
            } else {
                while !about.is_left(&low, &end) {
                    e = next(e);
                    end = about.ray(&mesh.edges[e as usize]);
                }
            }
            let children = self.steps.len();
            let mut from = low;
            loop {
                let inside = about.is_left(&end, &high);
                let to = if inside { end } else { high };
                let twin = mesh.edges[e as usize].twin;
                if twin != u32::MAX {
                    self.steps.push(Step::Enter { entry: twin, low: from, high: to, asks });
                }
                if !inside {
                    break;
                }
                from = to;
                e = next(e);
                end = about.ray(&mesh.edges[e as usize]);
            }
            // The first child is walked first.
            self.steps[children..].reverse();
        }
        entered
    }
}
