//! The fan of a vertex: the cells seen from it, by direction.
//!
//! From a point a chain of portals needs no hull: the directions that pass all of them are one
//! interval between two vertices. Walking depth first, counterclockwise, gives every cell's entry
//! and exit in the order of their directions, so nothing is ever sorted.

use glam::DVec2;

use super::flat::{FlatEdge, FlatMesh, WALL};
use crate::cells::EdgeId;
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
    Enter {
        entry: u32,
        low: Ray,
        high: Ray,
        asks: bool,
    },
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
    fn ray(&self, edge: &FlatEdge) -> Ray {
        Ray {
            to: edge.end.id,
            d: edge.end.at - self.origin,
        }
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
        let Wanted::Opposable { first, last } = &self.wanted else {
            return Want::All;
        };
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
        mesh: &FlatMesh,
        v: VertexId,
        bases: &[EdgeId],
        wanted: Wanted,
        mut event: impl FnMut(Event),
    ) -> u64 {
        let graph = &*mesh.graph;
        let vertices = &graph.vertices;
        let about = About {
            vertices,
            v,
            origin: vertices.approx(v),
            wanted,
        };
        let asks = matches!(wanted, Wanted::Opposable { .. });
        let mut entered = 0;
        for &base in bases {
            let cell = graph.edge(base).cell.0;
            let last_edge = graph.previous(base);
            let mut from = about.ray(mesh.edge(base.0));
            event(Event {
                ray: from,
                cell,
                enters: true,
            });
            entered += 1;
            let mut e = graph.next(base);
            while e != last_edge {
                let edge = mesh.edge(e.0);
                let to = about.ray(edge);
                // An edge in line with v (after a vertex in the middle of a side) is not seen.
                if edge.twin != WALL && about.is_left(&from, &to) {
                    self.steps.push(Step::Enter {
                        entry: edge.twin,
                        low: from,
                        high: to,
                        asks,
                    });
                    entered += self.run(mesh, &about, &mut event);
                }
                from = to;
                e = graph.next(e);
            }
            event(Event {
                ray: from,
                cell,
                enters: false,
            });
        }
        entered
    }

    fn run(&mut self, mesh: &FlatMesh, about: &About, event: &mut impl FnMut(Event)) -> u64 {
        let mut entered = 0;
        while let Some(step) = self.steps.pop() {
            let (entry, low, high, mut asks) = match step {
                Step::Exit(cell, ray) => {
                    event(Event {
                        ray,
                        cell,
                        enters: false,
                    });
                    continue;
                }
                Step::Enter {
                    entry,
                    low,
                    high,
                    asks,
                } => (entry, low, high, asks),
            };
            if asks {
                match about.want(&low, &high) {
                    Want::Nothing => continue,
                    Want::All => asks = false,
                    Want::Some => {}
                }
            }
            let entered_by = mesh.edge(entry);
            let FlatEdge {
                cell, first, past, ..
            } = *entered_by;
            event(Event {
                ray: low,
                cell,
                enters: true,
            });
            entered += 1;
            self.steps.push(Step::Exit(cell, high));
            // Seen from v, the ends of the edges that follow the entry counterclockwise turn from
            // its right end to its left end: first come those not left of `low`.
            let next = |e| entered_by.next(e);
            let mut e = next(entry);
            let n = past - first;
            let mut end = about.ray(mesh.edge(e));
            if n > MANY_EDGES {
                let after = |k: u32| {
                    if entry + k < past {
                        entry + k
                    } else {
                        entry + k - n
                    }
                };
                let (mut below, mut above) = (0, n - 1);
                while above - below > 1 {
                    let middle = (below + above) / 2;
                    if about.is_left(&low, &about.ray(mesh.edge(after(middle)))) {
                        above = middle;
                    } else {
                        below = middle;
                    }
                }
                e = after(above);
                end = about.ray(mesh.edge(e));
            } else {
                while !about.is_left(&low, &end) {
                    e = next(e);
                    end = about.ray(mesh.edge(e));
                }
            }
            let children = self.steps.len();
            let mut from = low;
            loop {
                let inside = about.is_left(&end, &high);
                let to = if inside { end } else { high };
                let twin = mesh.edge(e).twin;
                if twin != WALL {
                    self.steps.push(Step::Enter {
                        entry: twin,
                        low: from,
                        high: to,
                        asks,
                    });
                }
                if !inside {
                    break;
                }
                from = to;
                e = next(e);
                end = about.ray(mesh.edge(e));
            }
            // The first child is walked first.
            self.steps[children..].reverse();
        }
        entered
    }
}
