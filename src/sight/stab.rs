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

use std::cmp::Ordering;

use dashu_int::IBig;
use dashu_int::ops::{BitTest, UnsignedAbs};
use glam::DVec2;
use smallvec::SmallVec;

use crate::geom::{Side, Vertex, VertexId, Vertices};

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
    /// The line `n·(p - at) + value = 0`, exactly; `None` where a number is not finite, or `n` zero.
    pub(super) fn through(n: DVec2, at: DVec2, value: f64, slack: f64) -> Option<Self> {
        if !n.is_finite() || !at.is_finite() || !value.is_finite() || n == DVec2::ZERO {
            return None;
        }
        // Each is integers times a power of two.
        let ([a, b], n_power) = dyadic([n.x, n.y]);
        let ([x, y], at_power) = dyadic([at.x, at.y]);
        let ([value], value_power) = dyadic([value]);
        let moved_power = n_power + at_power;
        let least = n_power.min(moved_power).min(value_power);
        let to_least = |number: IBig, power: i32| number << (power - least) as usize;
        let moved = &a * x + &b * y;
        Some(Self {
            a: to_least(a, n_power),
            b: to_least(b, n_power),
            c: to_least(value, value_power) - to_least(moved, moved_power),
            slack,
        })
    }

    /// On which side of the line a vertex lies; exact.
    pub fn side(&self, vertex: &Vertex) -> Side {
        Side::of_big(&(&self.a * vertex.x() + &self.b * vertex.y() + &self.c * vertex.w()))
    }

    /// Whether the line passes strictly between the ends of every portal; exact.
    pub fn stabs(&self, vertices: &Vertices, chain: &[Gate]) -> bool {
        chain.iter().all(|gate| {
            self.side(vertices.exact(gate.left)) == Side::Left
                && self.side(vertices.exact(gate.right)) == Side::Right
        })
    }

    /// The coefficients in f64, with `a² + b² = 1`: the value at a point is its distance to the line
    /// in grid steps.
    pub fn approx(&self) -> [f64; 3] {
        // Shifted so that squares are finite; what is lost lies far below f64's last place.
        let bits = |n: &IBig| n.unsigned_abs().bit_len();
        let excess = bits(&self.a).max(bits(&self.b)).saturating_sub(500);
        let float = |n: &IBig| (n >> excess).to_f64().value();
        let [a, b, c] = [&self.a, &self.b, &self.c].map(float);
        let length = a.hypot(b);
        [a / length, b / length, c / length]
    }
}

/// Integers and an exponent k such that the numbers are the integers times 2^k. For zeros, k is 0.
fn dyadic<const N: usize>(numbers: [f64; N]) -> ([IBig; N], i32) {
    let parts = numbers.map(|x| {
        let bits = x.abs().to_bits();
        let (exponent, fraction) = ((bits >> 52) as i32, (bits & ((1 << 52) - 1)) as i64);
        let (mantissa, exponent) = match exponent {
            0 => (fraction, -1074),
            e => (fraction | 1 << 52, e - 1075),
        };
        let zeros = mantissa.trailing_zeros().min(52);
        let signed = if x < 0.0 { -mantissa } else { mantissa };
        (signed >> zeros, exponent + zeros as i32)
    });
    let of_nonzero = parts.iter().filter(|(m, _)| *m != 0).map(|(_, e)| *e);
    let least = of_nonzero.min().unwrap_or(0);
    let integers = parts.map(|(m, e)| match m {
        0 => IBig::ZERO,
        m => IBig::from(m) << (e - least) as usize,
    });
    (integers, least)
}

impl Contradiction {
    /// Whether the ends are some of the chain's, at most four, and contradict each other; exact.
    pub fn holds(&self, vertices: &Vertices, chain: &[Gate]) -> bool {
        let few = self.left.len() + self.right.len() <= 4;
        let own = |ends: &[VertexId], side: fn(&Gate) -> VertexId| {
            ends.iter()
                .all(|end| chain.iter().any(|gate| side(gate) == *end))
        };
        few && own(&self.left, |gate| gate.left)
            && own(&self.right, |gate| gate.right)
            && meet(vertices, &self.left, &self.right)
    }
}

/// Whether the closed convex hulls of two sets of at most four vertices in all, none of them empty,
/// have a point in common; exact.
pub(super) fn meet(vertices: &Vertices, left: &[VertexId], right: &[VertexId]) -> bool {
    match (left, right) {
        ([p], others) | (others, [p]) => is_among(vertices, *p, others),
        ([a, b], [c, d]) => segments_meet(vertices, [*a, *b], [*c, *d]),
        _ => false,
    }
}

/// Whether a vertex lies in the closed convex hull of at most three others.
fn is_among(vertices: &Vertices, p: VertexId, others: &[VertexId]) -> bool {
    match *others {
        [a] => is_between(vertices, p, [a, a]),
        [a, b] => is_between(vertices, p, [a, b]),
        [a, b, c] => {
            let [u, v, w] = [(a, b), (b, c), (c, a)].map(|(q, r)| vertices.orient(q, r, p));
            let inside = u == v && v == w && u != Side::On;
            inside
                || is_between(vertices, p, [a, b])
                || is_between(vertices, p, [b, c])
                || is_between(vertices, p, [c, a])
        }
        _ => false,
    }
}

/// Whether a vertex lies on the closed segment.
fn is_between(vertices: &Vertices, p: VertexId, [a, b]: [VertexId; 2]) -> bool {
    let within = |cmp: fn(&Vertex, &Vertex) -> Ordering| {
        let [p, a, b] = [p, a, b].map(|v| vertices.exact(v));
        let (before, after) = (cmp(a, p), cmp(p, b));
        before == after || before == Ordering::Equal || after == Ordering::Equal
    };
    vertices.orient(a, b, p) == Side::On && within(Vertex::cmp_x) && within(Vertex::cmp_y)
}

/// Whether two closed segments have a point in common.
fn segments_meet(vertices: &Vertices, [a, b]: [VertexId; 2], [c, d]: [VertexId; 2]) -> bool {
    let sides = |p, q, r, s| (vertices.orient(p, q, r), vertices.orient(p, q, s));
    let cross = |(r, s): (Side, Side)| r != Side::On && r == s.flip();
    cross(sides(a, b, c, d)) && cross(sides(c, d, a, b))
        || is_between(vertices, a, [c, d])
        || is_between(vertices, b, [c, d])
        || is_between(vertices, c, [a, b])
        || is_between(vertices, d, [a, b])
}
