//! Borders of polygons, as planes through the eye.
//!
//! Every polygon of a level is bounded by upright lines over the plan's vertices, and by level lines
//! over the cells' edges. With the eye, each such line spans a plane, and on which side of it a ray
//! passes is the sign of a product of the plane's normal with the ray's direction: linear over the
//! picture. Polygons that share a border ask for the sign of the same number, so every pixel belongs to
//! just one of them: there are neither gaps nor seams, whatever the rounding. Nothing is divided by a
//! depth, so a polygon needs no clipping before its borders are known, be the eye ever so near; and
//! the signs are those by which rays of [`trace::cast`](crate::trace::cast) walk.

use glam::DVec3;

use crate::trace::beam::{Fan, middle};
use crate::trace::space::Space;

/// A border: rays with a positive product with the normal, or those without.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// Normal of the plane.
    pub normal: DVec3,
    /// Whether the polygon lies where the product is not negative; otherwise where it is.
    pub positive: bool,
}

/// The upright line over a vertex: positive for rays that pass it on their left, or through it.
#[inline]
pub fn upright(space: &Space, eye: DVec3, vertex: u32) -> DVec3 {
    let to = space.vertex(vertex) - eye.truncate();
    DVec3::new(to.y, -to.x, 0.0)
}

/// The level line at height `z` over the edge between two vertices. From whichever end it is asked,
/// the number is the same. Over an edge that has the eye on its left, as seen from the end with the lower
/// number, it is positive for rays that pass above.
#[inline]
pub fn level(space: &Space, eye: DVec3, [from, to]: [u32; 2], z: f64) -> (DVec3, bool) {
    let turned = to < from;
    let [p, q] = if turned { [to, from] } else { [from, to] };
    let o = eye.truncate();
    let (a, b) = (space.vertex(p) - o, space.vertex(q) - o);
    let along = space.vertex(q) - space.vertex(p);
    let rise = z - eye.z;
    let normal = DVec3::new(-rise * along.y, rise * along.x, a.perp_dot(b));
    (normal, turned)
}

/// A border over the picture: the product at the middle of pixel (x, y) is `a·x + (b·y + c)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    a: f64,
    b: f64,
    c: f64,
    /// -1 / a
    turn: f64,
    positive: bool,
}

impl Line {
    /// A border over the picture that these rays draw.
    #[inline]
    pub fn of(border: &Border, fan: &Fan) -> Self {
        let a = border.normal.dot(fan.across);
        Self {
            a,
            turn: -a.recip(),
            b: border.normal.dot(fan.down),
            c: border.normal.dot(fan.direction(middle(0, 0))),
            positive: border.positive,
        }
    }

    /// Cuts the columns `first..past` of a row down to those on the polygon's side.
    #[inline(always)]
    pub fn cut(&self, row: u32, (first, past): (u32, u32)) -> (u32, u32) {
        let rest = self.b * f64::from(row) + self.c;
        let inside = |x: u32| (self.a * f64::from(x) + rest >= 0.0) == self.positive;
        if self.a == 0.0 {
            return if inside(first) {
                (first, past)
            } else {
                (first, first)
            };
        }
        // Where the sign changes: first to the nearest column, then to the very one.
        let guess = rest * self.turn + 0.5;
        let mut change = (guess as u32).clamp(first, past);
        let opens = (self.a > 0.0) == self.positive;
        while change > first && inside(change - 1) == opens {
            change -= 1;
        }
        while change < past && inside(change) != opens {
            change += 1;
        }
        if opens {
            (change, past)
        } else {
            (first, change)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::sampling::Source;

    #[test]
    fn a_line_and_its_other_side_share_a_row_without_gap_or_overlap() {
        let mut random = Source::new(3, 1, 4);
        let mut next = || random.next() * 2.0 - 1.0;
        for _ in 0..20_000 {
            let a = next() * if next() > 0.9 { 1e-9 } else { 1.0 };
            let line = Line {
                a,
                turn: -a.recip(),
                b: next(),
                c: next() * 100.0,
                positive: next() > 0.0,
            };
            let other = Line {
                positive: !line.positive,
                ..line
            };
            let row = (next().abs() * 200.0) as u32;
            let [mine, theirs] = [line, other].map(|l| l.cut(row, (3, 300)));
            let n = |(first, past): (u32, u32)| past - first;
            assert_eq!(n(mine) + n(theirs), 297, "{line:?}");
            for x in mine.0..mine.1 {
                let value = line.a * f64::from(x) + (line.b * f64::from(row) + line.c);
                assert_eq!(value >= 0.0, line.positive);
            }
        }
    }
}
