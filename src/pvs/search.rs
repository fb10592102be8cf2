//! The exact PVS by the lecture's depth-first search through chains of portals.
//!
//! Source: lecture, "Computing the PVS of a cell" (Find_Visible_Cells), after Teller & Séquin,
//! "Visibility preprocessing for interactive walkthroughs", 1991. Whether a stabbing line exists is
//! not asked anew for every chain: [`crate::sight::funnel`] keeps the lines that stab the chain so
//! far, and a further portal costs one or two orientation tests.

use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use super::{BitMatrix, Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::sight::funnel::{Funnel, Seen, Undo};

/// The exact PVS, in at most `max_steps` steps (cells entered) over all sources; `None` if that is
/// not enough. Uses the current rayon thread pool; the result does not depend on its size.
pub fn search(graph: &CellGraph, max_steps: Option<u64>, progress: &Progress) -> Option<Pvs> {
    let n = graph.cells.len();
    progress.begin(n);
    let mut visible = BitMatrix::new(n);
    let steps = AtomicU64::new(0);
    let given_up = AtomicBool::new(false);
    let limit = max_steps.unwrap_or(u64::MAX);
    visible.par_rows_mut().enumerate().for_each_init(
        || Walk::new(graph),
        |walk, (source, row)| {
            if given_up.load(Relaxed) {
                return;
            }
            let budget = limit.saturating_sub(steps.load(Relaxed));
            let taken = walk.from_cell(CellId(source as u32), row, budget);
            if steps.fetch_add(taken, Relaxed) + taken > limit {
                given_up.store(true, Relaxed);
            }
            progress.advance(1);
        },
    );
    (!given_up.into_inner()).then(|| Pvs {
        visible,
        method: Method::Search,
        class: Class::Exact,
        undecided: 0,
        steps: steps.into_inner(),
    })
}

/// A cell on the current chain, with the edge through which to leave it next.
struct Frame {
    entry: EdgeId,
    next: EdgeId,
    /// The start of `next`, as the extreme lines see it.
    from: Seen,
    undo: Option<Undo>,
}

/// A depth-first walk from one source after the other.
struct Walk<'a> {
    graph: &'a CellGraph,
    funnel: Funnel,
    frames: Vec<Frame>,
}

impl<'a> Walk<'a> {
    fn new(graph: &'a CellGraph) -> Self {
        Self { graph, funnel: Funnel::default(), frames: Vec::new() }
    }

    /// Sets the bits of the cells seen from `source`; returns the cells entered, more than `budget`
    /// if that ran out.
    fn from_cell(&mut self, source: CellId, row: &mut [u64], budget: u64) -> u64 {
        let graph = self.graph;
        let mut mark = |cell: CellId| row[cell.0 as usize / 64] |= 1 << (cell.0 % 64);
        mark(source);
        let mut steps = 1;
        for first in graph.edge_range(source).map(EdgeId) {
            let Some(entry) = graph.edge(first).twin() else { continue };
            mark(graph.edge(entry).cell);
            steps += 1;
            self.funnel.begin(graph.end(first), graph.edge(first).origin);
            self.enter(entry, None);
            while let Some(frame) = self.frames.last_mut() {
                let edge = frame.next;
                if edge == frame.entry || steps > budget {
                    if let Some(undo) = &frame.undo {
                        self.funnel.undo(undo);
                    }
                    self.frames.pop();
                    continue;
                }
                let (origin, end) = (graph.edge(edge).origin, graph.end(edge));
                let to = self.funnel.next_seen(&graph.vertices, frame.from, end);
                let from = std::mem::replace(&mut frame.from, to);
                frame.next = graph.next(edge);
                if !from.inside_left {
                    // All further edges lie left of the counterclockwise-most line.
                    frame.next = frame.entry;
                    continue;
                }
                let Some(twin) = graph.edge(edge).twin() else { continue };
                if let Some(undo) = self.funnel.extend(&graph.vertices, (end, to), (origin, from)) {
                    mark(graph.edge(twin).cell);
                    steps += 1;
                    self.enter(twin, Some(undo));
                }
            }
        }
        steps
    }

    fn enter(&mut self, entry: EdgeId, undo: Option<Undo>) {
        let next = self.graph.next(entry);
        let from = self.funnel.right_end_seen();
        self.frames.push(Frame { entry, next, from, undo });
    }
}
