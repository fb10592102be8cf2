//! Closed intervals of f64 that are certain to hold a number.
//!
//! Sums and products are rounded outwards, and only where rounding happened at all; so zero times
//! anything, and the difference of equal numbers, stay exactly zero. Where a bound is no number
//! (infinity less infinity), no comparison with it holds, and nothing is ever concluded from it.

use std::ops::{Add, Mul, Neg, Sub};

use glam::DVec2;

use super::predicate::Side;

/// Numbers from `lo` to `hi`, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Not above the number meant.
    pub lo: f64,
    /// Not below it.
    pub hi: f64,
}

impl Interval {
    /// Zero, exactly.
    pub const ZERO: Self = Self::point(0.0);

    /// One number, exactly.
    pub const fn point(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// All that differs from `x` by at most `error`.
    pub fn around(x: f64, error: f64) -> Self {
        Self::point(x)
            + Self {
                lo: -error,
                hi: error,
            }
    }

    /// The number is above zero.
    #[inline]
    pub fn is_positive(self) -> bool {
        self.lo > 0.0
    }

    /// The number is below zero.
    #[inline]
    pub fn is_negative(self) -> bool {
        self.hi < 0.0
    }

    /// The number is not above zero.
    #[inline]
    pub fn is_at_most_zero(self) -> bool {
        self.hi <= 0.0
    }

    /// The part of the interval on a side of zero on which the number is known to lie.
    #[inline]
    pub fn on(self, side: Side) -> Self {
        match side {
            Side::Left => self.not_below_zero(),
            Side::On => Self::ZERO,
            Side::Right => -(-self).not_below_zero(),
        }
    }

    /// The interval without what lies below zero, for a number known not to be there.
    #[inline]
    pub fn not_below_zero(self) -> Self {
        let cut = |x: f64| if x < 0.0 { 0.0 } else { x };
        Self {
            lo: cut(self.lo),
            hi: cut(self.hi),
        }
    }

    /// The quotient by a number above zero.
    #[inline]
    pub fn over_positive(self, divisor: Self) -> Self {
        debug_assert!(divisor.hi > 0.0);
        // Of two numbers above zero, the larger has the smaller inverse.
        let inverse = |x: f64| 1.0 / x;
        self * Self {
            lo: inverse(divisor.hi).next_down().max(0.0),
            hi: if divisor.lo > 0.0 {
                inverse(divisor.lo).next_up()
            } else {
                f64::INFINITY
            },
        }
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

/// The sum rounded down and up: the error of a rounded sum is itself a number (Knuth's TwoSum), and
/// its sign tells which way it was rounded. Where it is no number, both ways count.
#[inline]
fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let of_b = s - a;
    let error = (a - (s - of_b)) + (b - of_b);
    (
        if error >= 0.0 { s } else { s.next_down() },
        if error <= 0.0 { s } else { s.next_up() },
    )
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            lo: sum(self.lo, other.lo).0,
            hi: sum(self.hi, other.hi).1,
        }
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// The product rounded down.
#[inline]
fn product_down(a: f64, b: f64) -> f64 {
    let p = a * b;
    if a == 0.0 || b == 0.0 {
        p
    } else {
        p.next_down()
    }
}

/// The product rounded up.
#[inline]
fn product_up(a: f64, b: f64) -> f64 {
    let p = a * b;
    if a == 0.0 || b == 0.0 { p } else { p.next_up() }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.lo >= 0.0 && other.lo >= 0.0 {
            return Self {
                lo: product_down(self.lo, other.lo),
                hi: product_up(self.hi, other.hi),
            };
        }
        let pairs = [
            (self.lo, other.lo),
            (self.lo, other.hi),
            (self.hi, other.lo),
            (self.hi, other.hi),
        ];
        // Unlike `f64::min`, these keep what is no number.
        let least = |x: f64, y: f64| if x < y || x.is_nan() { x } else { y };
        let most = |x: f64, y: f64| if x > y || x.is_nan() { x } else { y };
        Self {
            lo: pairs
                .map(|(a, b)| product_down(a, b))
                .into_iter()
                .fold(f64::INFINITY, least),
            hi: pairs
                .map(|(a, b)| product_up(a, b))
                .into_iter()
                .fold(f64::NEG_INFINITY, most),
        }
    }
}

/// A vector on the plan whose coordinates are known nearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// To the right.
    pub x: Interval,
    /// Upwards.
    pub y: Interval,
}

impl Span {
    /// From one point to another, the coordinates of each off by at most its error.
    #[inline]
    pub fn new((p, p_error): (DVec2, f64), (q, q_error): (DVec2, f64)) -> Self {
        let known = |x, error| match error {
            0.0 => Interval::point(x),
            _ => Interval::around(x, error),
        };
        Self {
            x: known(q.x, q_error) - known(p.x, p_error),
            y: known(q.y, q_error) - known(p.y, p_error),
        }
    }

    /// Twice the area between this vector and another one, positive where that points further left.
    #[inline]
    pub fn cross(self, other: Self) -> Interval {
        self.x * other.y - self.y * other.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THIRD: Interval = Interval {
        lo: 1.0 / 3.0,
        hi: 0.333_333_333_333_333_4,
    };

    #[test]
    fn what_is_exact_stays_exact() {
        let seven = Interval::point(7.0);
        assert_eq!(seven - seven, Interval::ZERO);
        assert_eq!(seven + Interval::point(0.5), Interval::point(7.5));
        assert_eq!(THIRD * Interval::ZERO, Interval::ZERO);
        assert_eq!(-THIRD * Interval::ZERO, Interval::ZERO);
    }

    #[test]
    fn what_is_rounded_is_enclosed() {
        // 0.1 + 0.2 rounds up, past the number meant; 2^53 + 1 rounds down.
        let sum = Interval::point(0.1) + Interval::point(0.2);
        assert_eq!((sum.lo, sum.hi), (0.3, 0.1 + 0.2));
        let big = Interval::point(2f64.powi(53));
        let more = big + Interval::point(1.0);
        assert_eq!((more.lo, more.hi), (big.lo, big.lo + 2.0));
        let one = THIRD * Interval::point(3.0);
        assert!(
            one.lo < 1.0 && one.hi > 1.0 && one.hi - one.lo < 1e-15,
            "{one:?}"
        );
        let also = Interval::point(1.0).over_positive(Interval::point(3.0));
        assert!(also.lo <= THIRD.lo && also.hi >= THIRD.hi, "{also:?}");
    }

    #[test]
    fn signs_multiply() {
        let (minus, plus) = (
            Interval { lo: -2.0, hi: -1.0 },
            Interval { lo: 3.0, hi: 4.0 },
        );
        let within = |i: Interval, lo: f64, hi: f64| {
            assert!(i.lo <= lo && i.hi >= hi, "{i:?}");
            assert!(i.lo > lo - 1e-12 && i.hi < hi + 1e-12, "{i:?}");
        };
        within(minus * plus, -8.0, -3.0);
        within(minus * minus, 1.0, 4.0);
        let mixed = Interval { lo: -1.0, hi: 2.0 };
        within(mixed * plus, -4.0, 8.0);
        within(mixed * minus, -4.0, 2.0);
        within(minus.over_positive(plus), -2.0 / 3.0, -0.25);
    }

    #[test]
    fn nothing_follows_from_what_is_no_number() {
        let infinite = Interval::point(f64::INFINITY);
        for odd in [
            infinite - infinite,
            infinite * Interval::ZERO,
            infinite * Interval { lo: -1.0, hi: 1.0 } * Interval::ZERO,
        ] {
            assert!(
                !odd.is_positive() && !odd.is_negative() && !odd.is_at_most_zero(),
                "{odd:?}"
            );
        }
        // Too large for f64, but certainly not negative.
        let large = Interval::point(f64::MAX) * Interval::point(2.0);
        assert_eq!((large.lo, large.hi), (f64::MAX, f64::INFINITY));
    }
}
