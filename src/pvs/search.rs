//! The exact PVS by the lecture's depth-first search through chains of portals.
//!
//! Source: lecture, "Computing the PVS of a cell" (Find_Visible_Cells), after Teller & Séquin,
//! "Visibility preprocessing for interactive walkthroughs", 1991. Whether a stabbing line exists is
//! not asked anew for every chain: [`crate::sight::funnel`] keeps the lines that stab the chain so
//! far, and a further portal costs one or two orientation tests.
//!
//! A sightline is the same in both directions, so each is sought only from its left end: a chain all
//! of whose stabbing lines lead left is given up, for its reverse is found from the other end.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use super::flat::{FlatEdge, FlatMesh, WALL};
use super::{BitMatrix, Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, CellId};
use crate::geom::Placed;
use crate::sight::funnel::{Funnel, Seen, Undo};

/// The exact PVS, in at most `max_steps` steps (cells entered) over all sources; `None` if that is
/// not enough, or if `progress` is asked to stop before. Uses the current rayon thread pool; the result does not depend on its size.
pub fn search(graph: &CellGraph, max_steps: Option<u64>, progress: &Progress) -> Option<Pvs> {
    let n = graph.cells.len();
    progress.begin(n);
    let mesh = FlatMesh::new(graph);
    let mut visible = BitMatrix::new(n);
    let steps = AtomicU64::new(0);
    let given_up = AtomicBool::new(false);
    let limit = max_steps.unwrap_or(u64::MAX);
    visible.par_rows_mut().enumerate().for_each_init(
        || Walk::new(&mesh),
        |walk, (source, row)| {
            if given_up.load(Relaxed) || progress.stopped() {
                given_up.store(true, Relaxed);
                return;
            }
            let budget = limit.saturating_sub(steps.load(Relaxed));
            let taken = walk.see_from(CellId(source as u32), row, budget);
            if steps.fetch_add(taken, Relaxed) + taken > limit {
                given_up.store(true, Relaxed);
            }
            progress.advance(1);
        },
    );
    (!given_up.into_inner()).then(|| Pvs {
        visible: visible.symmetric(),
        method: Method::Search,
        class: Class::Exact,
        heights: false,
        undecided: 0,
        steps: steps.into_inner(),
    })
}

/// A cell on the current chain, with the edge through which to leave it next.
struct Frame {
    entry: u32,
    next: u32,
    /// The start of `next`, and how the extreme lines see it.
    from: Placed,
    seen: Seen,
    undo: Option<Undo>,
}

/// A depth-first walk from one source after the other.
struct Walk<'a> {
    mesh: &'a FlatMesh<'a>,
    funnel: Funnel,
    frames: Vec<Frame>,
}

impl<'a> Walk<'a> {
    fn new(mesh: &'a FlatMesh<'a>) -> Self {
        Self {
            mesh,
            funnel: Funnel::default(),
            frames: Vec::new(),
        }
    }

    /// Sets the bits of the cells seen from `source`; returns the cells entered, more than `budget`
    /// if that ran out.
    fn see_from(&mut self, source: CellId, row: &mut [u64], budget: u64) -> u64 {
        let mesh = self.mesh;
        let vertices = &mesh.graph.vertices;
        let mut mark = |cell: u32| row[cell as usize / 64] |= 1 << (cell % 64);
        mark(source.0);
        let mut steps = 1;
        for first in mesh.graph.edge_range(source) {
            let entry = mesh.edge(first).twin;
            if entry == WALL {
                continue;
            }
            mark(mesh.edge(entry).cell);
            steps += 1;
            self.funnel
                .begin(mesh.edge(first).end, mesh.edge(entry).end);
            self.frames.push(self.enter(entry, None));
            while let Some(frame) = self.frames.last_mut() {
                if frame.next == frame.entry || steps > budget {
                    if let Some(undo) = &frame.undo {
                        self.funnel.undo(undo);
                    }
                    self.frames.pop();
                    continue;
                }
                let FlatEdge { end, twin, .. } = *mesh.edge(frame.next);
                let seen = self.funnel.next_seen(vertices, frame.seen, &end);
                let (right, right_seen) = (frame.from, frame.seen);
                (frame.from, frame.seen) = (end, seen);
                frame.next = mesh.edge(frame.entry).next(frame.next);
                if !right_seen.inside_left {
                    // All further edges lie left of the counterclockwise-most line.
                    frame.next = frame.entry;
                } else if twin == WALL {
                } else if self.funnel.passes_all(seen, right_seen) {
                    // The only way on, and the lines stay what they are: no need to come back.
                    mark(mesh.edge(twin).cell);
                    steps += 1;
                    let undo = frame.undo;
                    let next = self.enter(twin, undo);
                    *self.frames.last_mut().unwrap() = next;
                } else if let Some(undo) =
                    self.funnel
                        .extend(vertices, (end, seen), (right, right_seen))
                {
                    if self.funnel.leads_left() {
                        self.funnel.undo(&undo);
                        continue;
                    }
                    mark(mesh.edge(twin).cell);
                    steps += 1;
                    self.frames.push(self.enter(twin, Some(undo)));
                }
            }
        }
        steps
    }

    /// A cell entered through one of its edges, whose end is the portal's right end.
    fn enter(&self, entry: u32, undo: Option<Undo>) -> Frame {
        let edge = self.mesh.edge(entry);
        Frame {
            entry,
            next: edge.next(entry),
            from: edge.end,
            seen: self.funnel.right_end_seen(),
            undo,
        }
    }
}
