//! The chain of portals with the widest view from one cell to another.
//!
//! Depth first, as [`search`](crate::pvs::search), but only through cells that see both, towards
//! the widest first, and no further where not even the lines that pass so far leave a strip wider
//! than the best found: a strip only gets narrower as its chain grows. Whether lines pass is decided
//! exactly; widths are f64.

use smallvec::SmallVec;

use super::strip;
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Placed, Side};
use crate::pvs::Pvs;
use crate::sight::Gate;
use crate::sight::funnel::{Funnel, Seen, Undo};

/// What the search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    /// The portals, as edges of the cells that are left.
    pub chain: Vec<EdgeId>,
    /// Width of the widest strip through it, in grid steps.
    pub width: f64,
    /// Whether no chain lets a wider strip through; otherwise the search ended before it knew.
    pub complete: bool,
    /// Portals tried.
    pub steps: u64,
}

/// A portal that some line passes.
#[derive(Clone, Copy)]
struct Way {
    edge: EdgeId,
    left: (Placed, Seen),
    right: (Placed, Seen),
    width: f64,
}

/// A cell on the current chain.
struct Frame {
    /// Ways on that are still to be tried, the widest last.
    open: SmallVec<[Way; 4]>,
    /// Takes the portal into this cell off the chain.
    undo: Option<Undo>,
}

struct Search<'a> {
    graph: &'a CellGraph,
    pvs: &'a Pvs,
    ends: [CellId; 2],
    funnel: Funnel,
    best: Option<(Vec<EdgeId>, f64)>,
    steps: u64,
}

/// The widest chain from `a` to `b`, two cells that see each other, in at most `max_steps` steps
/// after the first chain is found. `None` if there is no chain at all.
pub fn widest(graph: &CellGraph, pvs: &Pvs, a: CellId, b: CellId, max_steps: u64) -> Option<Best> {
    let mut search = Search {
        graph,
        pvs,
        ends: [a, b],
        funnel: Funnel::default(),
        best: None,
        steps: 0,
    };
    let mut complete = true;
    let mut chain: Vec<EdgeId> = Vec::new();
    let mut frames: Vec<Frame> = Vec::new();
    for first in search.first_ways() {
        if !search.is_open(&first, max_steps, &mut complete) {
            continue;
        }
        search.funnel.begin(first.left.0, first.right.0);
        chain.push(first.edge);
        frames.push(search.enter(&chain, None));
        while let Some(frame) = frames.last_mut() {
            let next = frame.open.pop();
            let Some(way) = next.filter(|way| search.is_open(way, max_steps, &mut complete)) else {
                // The others in this cell are narrower still.
                if let Some(undo) = &frame.undo {
                    search.funnel.undo(undo);
                }
                frames.pop();
                chain.pop();
                continue;
            };
            let extended = search.funnel.extend(&graph.vertices, way.left, way.right);
            let undo = extended.expect("it was extended by this portal before");
            chain.push(way.edge);
            frames.push(search.enter(&chain, Some(undo)));
        }
    }
    let (chain, width) = search.best?;
    Some(Best {
        chain,
        width,
        complete,
        steps: search.steps,
    })
}

impl Search<'_> {
    fn best_width(&self) -> f64 {
        self.best.as_ref().map_or(0.0, |b| b.1)
    }

    fn beyond(&self, edge: EdgeId) -> Option<CellId> {
        let twin = self.graph.edge(edge).twin()?;
        Some(self.graph.edge(twin).cell)
    }

    /// Whether a cell lies on any sightline between the two.
    fn serves(&self, cell: CellId) -> bool {
        self.ends.iter().all(|&end| self.pvs.sees(end, cell))
    }

    /// The portals of the first cell, the widest first.
    fn first_ways(&self) -> Vec<Way> {
        let seen = Seen {
            inside_left: true,
            inside_right: true,
        };
        let edges = self.graph.edge_range(self.ends[0]).map(EdgeId);
        let mut ways: Vec<Way> = edges
            .filter(|&e| self.beyond(e).is_some_and(|c| self.serves(c)))
            .map(|edge| {
                let vertices = &self.graph.vertices;
                let left = vertices.placed(self.graph.end(edge));
                let right = vertices.placed(self.graph.edge(edge).origin);
                Way {
                    edge,
                    left: (left, seen),
                    right: (right, seen),
                    width: left.at.distance(right.at),
                }
            })
            .collect();
        ways.sort_by(|a, b| b.width.total_cmp(&a.width));
        ways
    }

    /// Whether a way is worth going: it is wider than the best chain, and there is time.
    fn is_open(&self, way: &Way, max_steps: u64, complete: &mut bool) -> bool {
        let wider = way.width > self.best_width();
        let in_time = self.steps <= max_steps || self.best.is_none();
        *complete &= in_time || !wider;
        wider && in_time
    }

    /// The ways on from the cell beyond the chain's last portal, which is the funnel's last too: none
    /// from the last cell, but then the chain is the best so far (or it would not have been gone).
    fn enter(&mut self, chain: &[EdgeId], undo: Option<Undo>) -> Frame {
        let graph = self.graph;
        let vertices = &graph.vertices;
        let mut open: SmallVec<[Way; 4]> = SmallVec::new();
        let [.., portal] = chain else {
            return Frame { open, undo };
        };
        let entry = graph.edge(*portal).twin().expect("it is a portal");
        if graph.edge(entry).cell == self.ends[1] {
            self.best = Some((chain.to_vec(), self.width()));
            return Frame { open, undo };
        }
        let mut from = vertices.placed(graph.end(entry));
        let mut seen = self.funnel.right_end_seen();
        let mut edge = graph.next(entry);
        while edge != entry && seen.inside_left {
            let end = vertices.placed(graph.end(edge));
            let end_seen = self.funnel.next_seen(vertices, seen, &end);
            if self.beyond(edge).is_some_and(|cell| self.serves(cell)) {
                self.steps += 1;
                let (left, right) = ((end, end_seen), (from, seen));
                if let Some(undo) = self.funnel.extend(vertices, left, right) {
                    let width = self.width();
                    if width > self.best_width() && self.reaches() {
                        open.push(Way {
                            edge,
                            left,
                            right,
                            width,
                        });
                    }
                    self.funnel.undo(&undo);
                }
            }
            (from, seen) = (end, end_seen);
            edge = graph.next(edge);
        }
        open.sort_by(|a, b| a.width.total_cmp(&b.width));
        Frame { open, undo }
    }

    /// Width of the widest strip through the funnel.
    fn width(&self) -> f64 {
        let [left, right] = [self.funnel.left_bounds(), self.funnel.right_bounds()];
        strip::distance(left, right)
    }

    /// Whether the lines that pass all portals come near the last cell: it does not lie wholly left
    /// of the counterclockwise-most or right of the clockwise-most.
    fn reaches(&self) -> bool {
        let [left, right] = [self.funnel.left_bounds(), self.funnel.right_bounds()];
        let (Some(l), Some(r)) = (
            left.first().zip(left.last()),
            right.first().zip(right.last()),
        ) else {
            return true;
        };
        let vertices = &self.graph.vertices;
        let any = |p: &Placed, q: &Placed, wanted: Side| {
            let mut corners = self.graph.corners(self.ends[1]);
            corners.any(|v| vertices.side(p, q, &vertices.placed(v)) == wanted)
        };
        any(r.0, l.1, Side::Right) && any(l.0, r.1, Side::Left)
    }
}

/// A chain's portals as whoever passes through them sees them.
pub fn gates(graph: &CellGraph, chain: &[EdgeId]) -> Vec<Gate> {
    let gate = |&e: &EdgeId| Gate {
        left: graph.end(e),
        right: graph.edge(e).origin,
    };
    chain.iter().map(gate).collect()
}
