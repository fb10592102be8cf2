//! The lecture's search with a floating-point linear programme as its stabbing test.
//!
//! Source: lecture, "Computing the PVS of a cell" (Find_Visible_Cells) and "Finding Sightlines". Depth
//! first from each cell through chains of portals; each chain is asked anew, by
//! [`crate::sight::lp`]. So it may be wrong where a chain is tight, and it is slow: it can be asked
//! to stop, and says what it then left undecided.
//!
//! Each cell searches in all directions, though a sightline is the same from both ends: one programme
//! does not tell which way all stabbing lines of its chain lead, so that [`super::search`]'s halving
//! is not to be had; and so a pair is decided as soon as one of its two cells is done.

use rayon::prelude::*;

use super::flat::{FlatMesh, WALL};
use super::{BitMatrix, Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, CellId};
use crate::sight::{Gate, lp as programme};

/// The PVS by the lecture's search, each chain asked anew by [`crate::sight::lp`]. Asked to stop, it
/// leaves as visible but undecided what neither of two unfinished cells has found of the other, if
/// they are connected at all. Uses the current rayon thread pool; unless stopped, the result does not
/// depend on its size.
pub fn lp(graph: &CellGraph, progress: &Progress) -> Pvs {
    lp_bounded(graph, u64::MAX, progress)
}

/// As [`lp`]; a source that enters more than `most` cells is left unfinished.
pub fn lp_bounded(graph: &CellGraph, most: u64, progress: &Progress) -> Pvs {
    let n = graph.cells.len();
    progress.begin(n);
    let mesh = FlatMesh::new(graph);
    let mut found = BitMatrix::new(n);
    // Cells entered from each source, and whether it was finished.
    let walks: Vec<(u64, bool)> = found
        .par_rows_mut()
        .enumerate()
        .map(|(source, row)| {
            let mut walk = Walk {
                mesh: &mesh,
                progress,
                chain: Vec::new(),
                inside: vec![false; n],
                left: most,
                row,
            };
            let finished = walk.see_from(CellId(source as u32));
            progress.advance(1);
            (most - walk.left, finished)
        })
        .collect();
    let mut visible = found.symmetric();
    let open: Vec<bool> = walks.iter().map(|(_, finished)| !finished).collect();
    let undecided = keep_undecided(graph, &open, &mut visible);
    Pvs {
        visible,
        method: Method::Lp,
        class: Class::Approximate,
        heights: false,
        undecided,
        steps: walks.iter().map(|(steps, _)| steps).sum(),
    }
}

/// Makes the pairs of open cells visible that are connected; returns how many were not before.
fn keep_undecided(graph: &CellGraph, open: &[bool], visible: &mut BitMatrix) -> u64 {
    let n = graph.cells.len();
    let mut seen = vec![false; n];
    let mut undecided = 0;
    for start in 0..n {
        if seen[start] {
            continue;
        }
        // The cells connected to this one.
        let mut connected = vec![start];
        seen[start] = true;
        let mut done = 0;
        while let Some(&cell) = connected.get(done) {
            done += 1;
            for e in graph.edge_range(CellId(cell as u32)) {
                let twin = graph.edges[e as usize].twin();
                if let Some(next) = twin.map(|t| graph.edge(t).cell.0 as usize)
                    && !std::mem::replace(&mut seen[next], true)
                {
                    connected.push(next);
                }
            }
        }
        connected.retain(|&cell| open[cell]);
        for &a in &connected {
            for &b in &connected {
                if !visible.get(a, b) {
                    visible.set(a, b);
                    undecided += 1;
                }
            }
        }
    }
    undecided
}

/// A search from one source.
struct Walk<'a> {
    mesh: &'a FlatMesh<'a>,
    progress: &'a Progress,
    chain: Vec<Gate>,
    /// The cells that the chain passes through. A line enters a convex cell only once; that the
    /// programme knows this, too, cannot be relied on.
    inside: Vec<bool>,
    /// How many cells may still be entered.
    left: u64,
    row: &'a mut [u64],
}

impl Walk<'_> {
    /// Finds the cells seen from `source`; whether it came to the end.
    fn see_from(&mut self, source: CellId) -> bool {
        let range = self.mesh.graph.edge_range(source);
        self.enter(source.0, range.start, range.end)
    }

    /// Enters a cell, and all cells behind it that the chain's lines lead to.
    fn enter(&mut self, cell: u32, first: u32, past: u32) -> bool {
        if self.left == 0 || self.progress.stopped() {
            return false;
        }
        self.left -= 1;
        self.row[cell as usize / 64] |= 1 << (cell % 64);
        self.inside[cell as usize] = true;
        let mut finished = true;
        let mut right = self.mesh.edge(past - 1).end.id;
        for e in first..past {
            let edge = self.mesh.edge(e);
            let left = edge.end.id;
            let gate = Gate { left, right };
            right = left;
            if edge.twin == WALL {
                continue;
            }
            let next = *self.mesh.edge(edge.twin);
            if self.inside[next.cell as usize] {
                continue;
            }
            self.chain.push(gate);
            if self.is_stabbed() && !self.enter(next.cell, next.first, next.past) {
                finished = false;
            }
            self.chain.pop();
            if !finished {
                break;
            }
        }
        self.inside[cell as usize] = false;
        finished
    }

    fn is_stabbed(&self) -> bool {
        let margin = || programme::margin(&self.mesh.graph.vertices, &self.chain);
        // A portal has some width.
        self.chain.len() == 1 || margin().is_some_and(|m| m > 0.0)
    }
}
