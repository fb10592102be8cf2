//! Lines through two grid points, with integer coefficients.

use super::grid::GridPoint;
use super::predicate::Side;
use super::vertex::Vertex;

/// The line `a·x + b·y + c = 0`, positive on its left side. Its direction is `(b, -a)`.
///
/// Canonical: `gcd(a, b) = 1` and the direction points right, or straight up; so two lines are equal
/// exactly when they hold the same points. Widths: |a|, |b| < 2^26 and |c| < 2^52.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Line {
    /// Coefficient of x.
    pub a: i64,
    /// Coefficient of y.
    pub b: i64,
    /// Constant term.
    pub c: i64,
}

impl Line {
    /// The line through two different points. `None` where they are the same point.
    pub fn through(p: GridPoint, q: GridPoint) -> Option<Self> {
        let (mut dx, mut dy) = (q.x - p.x, q.y - p.y);
        let g = gcd(dx.unsigned_abs(), dy.unsigned_abs()) as i64;
        if g == 0 {
            return None;
        }
        if dx < 0 || (dx == 0 && dy < 0) {
            (dx, dy) = (-dx, -dy);
        }
        (dx, dy) = (dx / g, dy / g);
        Some(Self {
            a: -dy,
            b: dx,
            c: dy * p.x - dx * p.y,
        })
    }

    /// The vertical line at `x`, pointing up: its left side is where x is smaller.
    pub const fn vertical(x: i64) -> Self {
        Self { a: -1, b: 0, c: x }
    }

    /// The horizontal line at `y`, pointing right: its left side is above.
    pub const fn horizontal(y: i64) -> Self {
        Self { a: 0, b: 1, c: -y }
    }

    /// On which side of the line the vertex lies. Exact; i64 for grid points, else i128 (107 bits).
    #[inline]
    pub fn side(&self, v: &Vertex) -> Side {
        match v.grid() {
            Some(p) => Side::of(self.a * p.x + self.b * p.y + self.c),
            None => Side::of(
                i128::from(self.a) * v.x()
                    + i128::from(self.b) * v.y()
                    + i128::from(self.c) * i128::from(v.w()),
            ),
        }
    }

    /// Where two lines meet; `None` where they are parallel or the same.
    pub fn meet(&self, other: &Line) -> Option<Vertex> {
        let w = self.a * other.b - other.a * self.b;
        let x = i128::from(self.b) * i128::from(other.c) - i128::from(other.b) * i128::from(self.c);
        let y = i128::from(self.c) * i128::from(other.a) - i128::from(other.c) * i128::from(self.a);
        Vertex::homogeneous(x, y, w)
    }

    /// Compares two vertices of this line in the line's direction.
    pub fn cmp_along(&self, p: &Vertex, q: &Vertex) -> std::cmp::Ordering {
        // The direction is (b, -a) with b > 0, or straight up.
        if self.b > 0 { p.cmp_x(q) } else { p.cmp_y(q) }
    }
}

/// Greatest common divisor; `gcd(0, n) = n`.
pub(super) fn gcd(mut m: u64, mut n: u64) -> u64 {
    if m == 0 || n == 0 {
        return m | n;
    }
    let shift = (m | n).trailing_zeros();
    m >>= m.trailing_zeros();
    loop {
        n >>= n.trailing_zeros();
        if m > n {
            std::mem::swap(&mut m, &mut n);
        }
        n -= m;
        if n == 0 {
            return m << shift;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_line_from_any_two_of_its_points() {
        let line = Line::through(GridPoint::new(0, 1), GridPoint::new(3, 3)).unwrap();
        assert_eq!(
            Line::through(GridPoint::new(9, 7), GridPoint::new(-3, -1)),
            Some(line)
        );
        assert_eq!(
            Line::through(GridPoint::new(5, 5), GridPoint::new(5, 5)),
            None
        );
    }

    #[test]
    fn left_is_left_of_the_direction() {
        let up = Line::through(GridPoint::new(2, 5), GridPoint::new(2, -5)).unwrap();
        assert_eq!(up, Line::vertical(2));
        assert_eq!(up.side(&GridPoint::new(1, 0).into()), Side::Left);
        let right = Line::horizontal(-4);
        assert_eq!(right.side(&GridPoint::new(0, 0).into()), Side::Left);
        assert_eq!(right.side(&GridPoint::new(7, -4).into()), Side::On);
    }

    #[test]
    fn meets_are_exact_and_reduced() {
        let p = Line::horizontal(1).meet(&Line::vertical(7)).unwrap();
        assert_eq!(p, GridPoint::new(7, 1).into());
        let l = Line::through(GridPoint::new(0, 0), GridPoint::new(3, 1)).unwrap();
        let m = Line::through(GridPoint::new(0, 1), GridPoint::new(1, 0)).unwrap();
        let p = l.meet(&m).unwrap(); // (3/4, 1/4)
        assert_eq!((p.x(), p.y(), p.w()), (3, 1, 4));
        assert_eq!(l.side(&p), Side::On);
        assert_eq!(m.side(&p), Side::On);
        assert_eq!(l.meet(&l), None);
    }

    #[test]
    fn gcd_by_hand() {
        assert_eq!(gcd(0, 0), 0);
        assert_eq!(gcd(0, 12), 12);
        assert_eq!(gcd(18, 12), 6);
        assert_eq!(gcd(17, 5), 1);
    }
}
