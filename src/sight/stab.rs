//! A line that stabs a chain of portals, or the proof that there is none.
//!
//! In: the oriented portals of a chain. Out: a [`Witness`], a line in exact coordinates that passes
//! strictly between the ends of every portal; or a [`Contradiction`], at most four ends between
//! which no line can pass. Both can be checked exactly, whichever solver found them.
//!
//! In the plane a line stabs a chain just when it separates its left ends from its right ends. So
//! there is one just when the convex hulls of the two have no point in common, and if they have,
//! then already those of at most four ends do (Kirchberger 1903). The distance of the hulls is the
//! width of the widest strip that the chain lets through: the chain's slack.

use dashu_int::IBig;
use smallvec::SmallVec;

use crate::geom::{VertexId, Vertices};

/// A portal of a chain, oriented: its ends as seen by somebody who passes through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gate {
    /// The end on the left hand.
    pub left: VertexId,
    /// The end on the right hand.
    pub right: VertexId,
}

/// How a stabbing line is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// By the exact funnel: never wrong.
    #[default]
    Exact,
    /// By a linear programme in floating point: the lecture's method, wrong where it is tight.
    Lp,
}

/// What a solver says of a chain.
#[derive(Clone, Debug, PartialEq)]
pub enum Stabbing {
    /// This line stabs it.
    Line(Witness),
    /// No line does.
    None(Contradiction),
}

/// A directed line `a·x + b·y + c = 0` in grid steps, positive on its left side, with integer
/// coefficients of any size: direction `(b, -a)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Witness {
    /// Coefficient of x.
    pub a: IBig,
    /// Coefficient of y.
    pub b: IBig,
    /// Constant term.
    pub c: IBig,
    /// Width of the widest strip around this line, parallel to it, that no portal's end reaches
    /// into, in grid steps and rounded: the least distance of a left end plus that of a right end.
    pub slack: f64,
}

/// Ends of a chain's portals, at most four, between which no line can pass: the convex hull of the
/// left ones and that of the right ones have a point in common.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contradiction {
    /// Ends that a line must leave on its left.
    pub left: SmallVec<[VertexId; 4]>,
    /// Ends that a line must leave on its right.
    pub right: SmallVec<[VertexId; 4]>,
}

/// A stabbing line of the chain (at least one gate, each in the cell beyond the one before), or why
/// there is none.
pub fn stab(vertices: &Vertices, chain: &[Gate], solver: Solver) -> Stabbing {
    match solver {
        Solver::Exact => super::exact::stab(vertices, chain),
        Solver::Lp => super::lp::stab(vertices, chain),
    }
}

impl Witness {
    /// Whether the line passes strictly between the ends of every portal; exact.
    pub fn stabs(&self, _vertices: &Vertices, _chain: &[Gate]) -> bool {
        unimplemented!()
    }
}

impl Contradiction {
    /// Whether the ends are some of the chain's, at most four, and contradict each other; exact.
    pub fn holds(&self, _vertices: &Vertices, _chain: &[Gate]) -> bool {
        unimplemented!()
    }
}
