//! Visibility with heights: sight in space, not only on the plan.
//!
//! In: a [`CellGraph`]. Out: a [`Bracket`] of the exact relation: what is certainly not hidden from
//! each other (`upper`, the PVS) and what certainly sees each other (`lower`). Cell A sees cell B
//! when a segment in space, from inside the prism over A to inside the prism over B, crosses no wall
//! on the plan, and every portal strictly between the bottom and the top of its opening.
//!
//! Floors and ceilings are flat within a cell, and a portal's opening lies within those of both its
//! cells. So a segment that clears the portals on its way clears all floors and ceilings; and as its
//! ends may lie as near to the first and the last portal as one likes, nothing else is asked of
//! them. Without a portal a cell sees itself; through one, its neighbour, if the opening has any
//! height.
//!
//! What moves counts with its whole range: every opening is the [`crate::cells::Portal::widest`] one,
//! with lifts, floors and ceilings moved out of the way. With doors closed, a closed door is a wall
//! on the plan, and does not get here; everything else that moves still counts with its whole range.
//! A portal without heights is open without end.
//!
//! The search is that of [`super::search`], with the same exact answers on the plan. Whether a line
//! in space passes a chain of portals is not a question of convex sets; `chain` answers it by
//! splitting the lines of the plan into parts, each with a proof (`clash`: three openings that
//! contradict each other along all its lines; `sightline`: a line that clears all openings), and
//! leaves it open where `splits` parts are not enough. What is left open is explored as if visible,
//! and counts as [`Pvs::undecided`]. Both answers are proved: in integers, or in intervals.
//!
//! Source: lecture, "Cell to Cell Visibility"; that three openings suffice for a contradiction is
//! Helly's theorem (1923) for half planes, in the plane of the lines above one line of the plan.

mod chain;
mod clash;
mod corners;
mod sightline;
mod upright;
mod walk;
mod witness;

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

use self::walk::{Found, OpenMesh, Visitor, Walk};
pub use self::witness::{ChainAnswer, HeightsAnswer, Passage, through, witness};
use super::{BitMatrix, Class, Method, Progress, Pvs, sweep};
use crate::cells::{CellGraph, CellId};

/// Options of [`heights`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeightsOptions {
    /// How many parts the lines through one chain of portals may be split into before the chain is
    /// left undecided.
    pub splits: u32,
}

impl Default for HeightsOptions {
    fn default() -> Self {
        Self { splits: 64 }
    }
}

/// The exact relation from both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    /// Misses nothing; whatever is not in `lower` counts as undecided.
    pub upper: Pvs,
    /// What certainly sees each other. Symmetric, with ones on the diagonal; a part of `upper`.
    pub lower: BitMatrix,
}

/// The PVS with heights: [`Bracket::upper`].
pub fn heights(graph: &CellGraph, options: &HeightsOptions, progress: &Progress) -> Pvs {
    bracket(graph, options, progress).upper
}

/// The PVS with heights from both sides. Uses the current rayon thread pool; the result does not
/// depend on its size. When `progress` is stopped, the cells that are not finished keep what they
/// see on the plan, as undecided.
pub fn bracket(graph: &CellGraph, options: &HeightsOptions, progress: &Progress) -> Bracket {
    let n = graph.cells.len();
    progress.begin(n);
    let mesh = OpenMesh::new(graph);
    let (mut lower, mut upper) = (BitMatrix::new(n), BitMatrix::new(n));
    let steps = AtomicU64::new(0);
    let unfinished: Vec<AtomicBool> = (0..n).map(|_| AtomicBool::new(false)).collect();
    lower
        .par_rows_mut()
        .zip(upper.par_rows_mut())
        .enumerate()
        .for_each_init(
            || Walk::new(&mesh, options.splits),
            |walk, (source, (proved, open))| {
                set(proved, source as u32);
                let mut row = Row {
                    proved,
                    open,
                    progress,
                };
                match row
                    .goes_on()
                    .map_continue(|()| walk.from(CellId(source as u32), &mut row))
                {
                    ControlFlow::Continue(ControlFlow::Continue(taken)) => {
                        _ = steps.fetch_add(taken, Relaxed);
                    }
                    _ => unfinished[source].store(true, Relaxed),
                }
                for (open, proved) in row.open.iter_mut().zip(&*row.proved) {
                    *open |= proved;
                }
                progress.advance(1);
            },
        );
    let unfinished: Vec<usize> = (0..n)
        .filter(|&source| unfinished[source].load(Relaxed))
        .collect();
    if !unfinished.is_empty() {
        let plan = sweep::sweep(graph, &Progress::default()).visible;
        for source in unfinished {
            for (word, more) in upper.row_mut(source).iter_mut().zip(plan.row(source)) {
                *word |= more;
            }
        }
    }
    let (lower, visible) = (lower.symmetric(), upper.symmetric());
    let undecided = visible.total() - lower.total();
    Bracket {
        upper: Pvs {
            visible,
            method: Method::Search,
            class: match undecided {
                0 => Class::Exact,
                _ => Class::Conservative,
            },
            heights: true,
            undecided,
            steps: steps.into_inner(),
        },
        lower,
    }
}

/// What one cell is found to see.
struct Row<'a> {
    proved: &'a mut [u64],
    /// What it may see.
    open: &'a mut [u64],
    progress: &'a Progress,
}

fn set(row: &mut [u64], cell: u32) {
    row[cell as usize / 64] |= 1 << (cell % 64);
}

impl Visitor for Row<'_> {
    fn knows(&self, cell: u32) -> bool {
        self.proved[cell as usize / 64] >> (cell % 64) & 1 != 0
    }

    fn sees(&mut self, cell: u32, _: &Found) -> ControlFlow<()> {
        set(self.proved, cell);
        ControlFlow::Continue(())
    }

    fn may_see(&mut self, cell: u32) {
        set(self.open, cell);
    }

    fn goes_on(&self) -> ControlFlow<()> {
        if self.progress.stopped() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
