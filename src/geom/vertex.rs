//! Exact points of the plan: grid points, and the meetings of two lines through grid points.

use std::cmp::Ordering;

use ethnum::I256;
use glam::DVec2;

use super::grid::{Grid, GridPoint};
use super::line::gcd;

/// The point `(x/w, y/w)` in grid steps, kept in lowest terms with `w > 0`, so that equal points are
/// equal values. Widths, for a meeting of two [`super::Line`]s: x and y 80 bits, w 54 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Vertex {
    x: i128,
    y: i128,
    w: i64,
}

impl From<GridPoint> for Vertex {
    fn from(p: GridPoint) -> Self {
        Self {
            x: p.x.into(),
            y: p.y.into(),
            w: 1,
        }
    }
}

impl Vertex {
    /// The point `(x/w, y/w)`; `None` for w = 0 (a point at infinity). Any sign, any common factor.
    pub fn homogeneous(x: i128, y: i128, w: i64) -> Option<Self> {
        if w == 0 {
            return None;
        }
        let sign = i128::from(w.signum());
        let m = w.unsigned_abs();
        if m == 1 {
            return Some(Self {
                x: sign * x,
                y: sign * y,
                w: 1,
            });
        }
        // gcd(x, y, w) = gcd(gcd(w, x mod w), y mod w): only two divisions of wide numbers.
        let remainder = |n: i128| match u64::try_from(n.unsigned_abs()) {
            Ok(n) => n % m,
            Err(_) => (n.unsigned_abs() % u128::from(m)) as u64,
        };
        let g = gcd(gcd(m, remainder(x)), remainder(y)) as i64;
        let divided = |n: i128| match i64::try_from(n) {
            Ok(n) => i128::from(n / g),
            Err(_) => n / i128::from(g),
        };
        let (x, y) = if g == 1 {
            (x, y)
        } else {
            (divided(x), divided(y))
        };
        Some(Self {
            x: sign * x,
            y: sign * y,
            w: w.abs() / g,
        })
    }

    /// Homogeneous x.
    pub fn x(&self) -> i128 {
        self.x
    }

    /// Homogeneous y.
    pub fn y(&self) -> i128 {
        self.y
    }

    /// Homogeneous w, positive; 1 for grid points.
    pub fn w(&self) -> i64 {
        self.w
    }

    /// This vertex as a grid point, if it is one.
    #[inline]
    pub fn grid(&self) -> Option<GridPoint> {
        (self.w == 1).then(|| GridPoint::new(self.x as i64, self.y as i64))
    }

    /// Nearest f64 coordinates in grid steps; exact for grid points, else within 3·2^-53 of the
    /// coordinate (two conversions and a division, each correctly rounded).
    pub fn approx(&self) -> DVec2 {
        if let Some(p) = self.grid() {
            return DVec2::new(p.x as f64, p.y as f64);
        }
        let w = self.w as f64;
        DVec2::new(self.x as f64 / w, self.y as f64 / w)
    }

    /// The point in the level's own coordinates, as near as f64 gets to it.
    pub fn to_level(&self, grid: &Grid) -> DVec2 {
        let p = self.approx();
        grid.offset_to_level(p.x, p.y)
    }

    /// The point moved by whole steps.
    pub fn shifted(&self, dx: i64, dy: i64) -> Self {
        let w = i128::from(self.w);
        Self {
            x: self.x + i128::from(dx) * w,
            y: self.y + i128::from(dy) * w,
            w: self.w,
        }
    }

    /// The point mirrored: x negated, then y negated, then both exchanged, each if asked for.
    pub fn mirrored(&self, flip_x: bool, flip_y: bool, swap: bool) -> Self {
        let x = if flip_x { -self.x } else { self.x };
        let y = if flip_y { -self.y } else { self.y };
        let (x, y) = if swap { (y, x) } else { (x, y) };
        Self { x, y, w: self.w }
    }

    /// Compares x coordinates.
    pub fn cmp_x(&self, other: &Self) -> Ordering {
        cmp_fractions(self.x, self.w, other.x, other.w)
    }

    /// Compares y coordinates.
    pub fn cmp_y(&self, other: &Self) -> Ordering {
        cmp_fractions(self.y, self.w, other.y, other.w)
    }
}

/// Compares m/u with n/v for positive u and v; 134 bits at most.
fn cmp_fractions(m: i128, u: i64, n: i128, v: i64) -> Ordering {
    if u == v {
        return m.cmp(&n);
    }
    match (m.checked_mul(v.into()), n.checked_mul(u.into())) {
        (Some(mv), Some(nu)) => mv.cmp(&nu),
        _ => (I256::from(m) * I256::from(v)).cmp(&(I256::from(n) * I256::from(u))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lowest_terms_with_positive_w() {
        let v = Vertex::homogeneous(6, -4, -8).unwrap();
        assert_eq!((v.x(), v.y(), v.w()), (-3, 2, 4));
        assert_eq!(Vertex::homogeneous(-3, 2, 4), Some(v));
        assert_eq!(Vertex::homogeneous(1, 1, 0), None);
        assert_eq!(
            Vertex::homogeneous(0, 0, -5),
            Some(GridPoint::new(0, 0).into())
        );
    }

    #[test]
    fn comparing_wide_fractions() {
        let big = 1i128 << 79;
        let p = Vertex::homogeneous(big + 1, 0, (1 << 53) - 1).unwrap();
        let q = Vertex::homogeneous(big + 2, 0, (1 << 53) - 3).unwrap();
        assert_eq!(p.cmp_x(&q), Ordering::Less);
        assert_eq!(q.cmp_x(&p), Ordering::Greater);
        assert_eq!(p.cmp_x(&p), Ordering::Equal);
    }
}
