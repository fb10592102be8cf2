//! From a [`CellGraph`] to its [`Pvs`]: which cells can see which.
//!
//! A sees B when some segment from inside A to inside B crosses no wall; cells are open sets, so a
//! line that only grazes a corner, or squeezes through two walls that touch, is not sight. The
//! relation is symmetric, and every cell sees itself. [`search`] and [`sweep`] both decide this
//! exactly, in entirely different ways; the others trade accuracy for time, or stand here to be
//! compared with. What each promises is its [`Class`].

mod bits;
pub mod closing;
pub mod explain;
pub mod eye;
mod fan;
pub mod file;
mod flat;
pub mod flood;
pub mod flow;
pub mod heights;
pub mod longest;
pub mod lp;
pub mod runtime;
pub mod sample;
pub mod search;
pub mod sectors;
pub mod subsectors;
pub mod sweep;
pub mod verify;

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

pub use bits::{BitMatrix, ones};

use crate::cells::{CellGraph, CellId};

/// How a potentially visible set was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// About every vertex in turn; exact.
    #[default]
    Sweep,
    /// Depth first through chains of portals; exact.
    Search,
    /// Depth first, with a floating-point linear programme as the stabbing test.
    Lp,
    /// Portal flow with separators in floating point, as the Quake tools do it.
    Flow,
    /// Connected through open portals.
    Flood,
    /// Random sightlines.
    Sample,
}

impl Method {
    /// All of them: the exact ones first.
    pub const ALL: [Method; 6] = [
        Method::Sweep,
        Method::Search,
        Method::Lp,
        Method::Flow,
        Method::Flood,
        Method::Sample,
    ];

    /// The name on the command line and in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Method::Sweep => "sweep",
            Method::Search => "search",
            Method::Lp => "lp",
            Method::Flow => "flow",
            Method::Flood => "flood",
            Method::Sample => "sample",
        }
    }

    /// What the method promises.
    pub fn class(self) -> Class {
        match self {
            Method::Sweep | Method::Search => Class::Exact,
            Method::Lp | Method::Flow => Class::Approximate,
            Method::Flood => Class::Conservative,
            Method::Sample => Class::Aggressive,
        }
    }
}

/// What a visible set is, compared with the exact one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Class {
    /// The exact one.
    #[default]
    Exact,
    /// Misses nothing; may hold too much.
    Conservative,
    /// Holds nothing too much; may miss something.
    Aggressive,
    /// May do both.
    Approximate,
}

impl Class {
    /// All of them.
    pub const ALL: [Class; 4] = [
        Class::Exact,
        Class::Conservative,
        Class::Aggressive,
        Class::Approximate,
    ];

    /// Whether it misses nothing.
    pub fn is_complete(self) -> bool {
        matches!(self, Class::Exact | Class::Conservative)
    }

    /// Whether it holds nothing too much.
    pub fn is_sound(self) -> bool {
        matches!(self, Class::Exact | Class::Aggressive)
    }

    /// The name in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Class::Exact => "exact",
            Class::Conservative => "conservative",
            Class::Aggressive => "aggressive",
            Class::Approximate => "approximate",
        }
    }
}

/// What is to be computed, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PvsOptions {
    /// By which method; with heights, it must be [`Method::Search`].
    pub method: Method,
    /// Whether floors and ceilings count, and how hard to try.
    pub heights: Option<heights::HeightsOptions>,
    /// Where the search gives up, in steps.
    pub max_steps: Option<u64>,
    /// For [`Method::Sample`].
    pub sample: sample::SampleOptions,
    /// For [`Method::Flow`].
    pub flow: flow::FlowOptions,
}

/// Computes a PVS; `None` if the search gave up. Uses the current rayon thread pool.
pub fn compute(graph: &CellGraph, options: &PvsOptions, progress: &Progress) -> Option<Pvs> {
    if let Some(heights) = &options.heights {
        return Some(heights::heights(graph, heights, progress));
    }
    Some(match options.method {
        Method::Sweep => sweep::sweep(graph, progress),
        Method::Search => return search::search(graph, options.max_steps, progress),
        Method::Lp => lp::lp(graph, progress),
        Method::Flow => flow::flow(graph, &options.flow, progress),
        Method::Flood => flood::flood(graph, progress),
        Method::Sample => sample::sample(graph, &options.sample, progress),
    })
}

/// A cell-to-cell visibility relation.
#[derive(Clone, Debug, PartialEq)]
pub struct Pvs {
    /// Bit j of row i: cell i sees cell j. Symmetric, with ones on the diagonal.
    pub visible: BitMatrix,
    /// How it was computed.
    pub method: Method,
    /// What it promises.
    pub class: Class,
    /// Whether floors and ceilings count: then a sightline is a segment in space that passes through
    /// the openings of all portals on its way.
    pub heights: bool,
    /// Ordered pairs that count as visible without proof, for methods with a budget.
    pub undecided: u64,
    /// Elementary steps that the method took: cells entered.
    pub steps: u64,
}

impl Pvs {
    /// Whether one cell sees another.
    pub fn sees(&self, a: CellId, b: CellId) -> bool {
        self.visible.get(a.0 as usize, b.0 as usize)
    }

    /// The cells that a cell sees, itself included, ascending.
    pub fn seen_from(&self, cell: CellId) -> impl Iterator<Item = CellId> + '_ {
        self.visible.ones(cell.0 as usize).map(|i| CellId(i as u32))
    }

    /// Ordered visible pairs, (i, i) included.
    pub fn pairs(&self) -> u64 {
        self.visible.total()
    }

    /// Visible pairs as a share of all pairs; 0 without cells.
    pub fn density(&self) -> f64 {
        let n = self.visible.n() as f64;
        if n == 0.0 {
            0.0
        } else {
            self.pairs() as f64 / (n * n)
        }
    }

    /// Checks that the relation is symmetric and reflexive, and, where it claims to miss nothing, that
    /// cells that share a portal see each other.
    pub fn validate(&self, graph: &CellGraph) -> Result<(), Flaw> {
        if self.visible.n() != graph.cells.len() {
            return Err(Flaw::Size {
                cells: graph.cells.len(),
                rows: self.visible.n(),
            });
        }
        for a in graph.cell_ids() {
            if !self.sees(a, a) {
                return Err(Flaw::NotReflexive(a));
            }
            if let Some(b) = self.seen_from(a).find(|&b| !self.sees(b, a)) {
                return Err(Flaw::NotSymmetric(a, b));
            }
        }
        for portal in &graph.portals {
            let [a, b] = graph.joined(portal);
            // With heights on, an opening may have no height.
            if !self.heights && self.class.is_complete() && !self.sees(a, b) {
                return Err(Flaw::Neighbours(a, b));
            }
        }
        Ok(())
    }
}

/// A broken invariant of a [`Pvs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// It is for another number of cells.
    Size {
        /// Cells of the graph.
        cells: usize,
        /// Rows of the relation.
        rows: usize,
    },
    /// A cell does not see itself.
    NotReflexive(CellId),
    /// The first sees the second, but not the other way round.
    NotSymmetric(CellId, CellId),
    /// Two cells share a portal but do not see each other.
    Neighbours(CellId, CellId),
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::Size { cells, rows } => write!(f, "{cells} cells, but {rows} rows"),
            Flaw::NotReflexive(a) => write!(f, "cell {} does not see itself", a.0),
            Flaw::NotSymmetric(a, b) => {
                write!(
                    f,
                    "cell {} sees cell {}, but not the other way round",
                    a.0, b.0
                )
            }
            Flaw::Neighbours(a, b) => {
                write!(
                    f,
                    "cells {} and {} share a portal but do not see each other",
                    a.0, b.0
                )
            }
        }
    }
}

/// How far a computation has come, read by others while it runs; and their wish that it stop.
#[derive(Debug, Default)]
pub struct Progress {
    /// Units of work done.
    pub done: AtomicU64,
    /// Units of work in all; 0 before it is known.
    pub total: AtomicU64,
    stop: AtomicBool,
}

impl Progress {
    /// Starts counting to `total`.
    pub fn begin(&self, total: usize) {
        self.done.store(0, Relaxed);
        self.total.store(total as u64, Relaxed);
    }

    /// Counts `by` more as done.
    pub fn advance(&self, by: usize) {
        self.done.fetch_add(by as u64, Relaxed);
    }

    /// Asks the computation to come to an end soon. Methods with undecided pairs then leave what is
    /// open undecided, the search gives up; others take no notice.
    pub fn stop(&self) {
        self.stop.store(true, Relaxed);
    }

    /// Whether somebody asked for the end.
    pub fn stopped(&self) -> bool {
        self.stop.load(Relaxed)
    }
}
