//! The frame in which a level is subdivided: the one of its eight rotations and mirrorings that a
//! fingerprint of the walls picks.
//!
//! Subdividing means choosing: which wall splits first, which diagonal of four points on a circle.
//! Made in the level's own coordinates, such a choice would depend on how the level happens to be
//! turned. Made in this frame, a level and its mirror image get mirrored cells.

use crate::geom::{GridPoint, Line, Vertex};

/// A rotation or mirroring of the grid, followed by a shift that centres the level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    flip_x: bool,
    flip_y: bool,
    swap: bool,
    shift: [i64; 2],
}

impl Frame {
    /// The frame for segments `(from, to, code)`; `code` stands for all else that the subdivision
    /// depends on. O(n). Segments count as undirected, in any order.
    pub fn of(segments: &[(GridPoint, GridPoint, u64)]) -> Self {
        let candidates = (0..8).map(|bits| {
            let mut frame = Frame {
                flip_x: bits & 1 != 0,
                flip_y: bits & 2 != 0,
                swap: bits & 4 != 0,
                shift: [0, 0],
            };
            let turned = || {
                segments
                    .iter()
                    .flat_map(|s| [frame.enter(s.0), frame.enter(s.1)])
            };
            let middle = |of: fn(GridPoint) -> i64| {
                let (min, max) = turned()
                    .map(of)
                    .fold((i64::MAX, i64::MIN), |(lo, hi), n| (lo.min(n), hi.max(n)));
                if min > max {
                    0
                } else {
                    (min + max).div_euclid(2)
                }
            };
            frame.shift = [-middle(|p| p.x), -middle(|p| p.y)];
            // A sum does not depend on the order of the segments.
            let print = segments.iter().fold(0u64, |sum, &(a, b, code)| {
                let (a, b) = (frame.enter(a), frame.enter(b));
                let (a, b) = if a <= b { (a, b) } else { (b, a) };
                // Coordinates have 27 bits.
                let packed = |p: GridPoint| (p.x as u64) << 32 | (p.y as u64 & 0xffff_ffff);
                sum.wrapping_add(mix(mix(code, packed(a)), packed(b)))
            });
            (print, frame)
        });
        // Equal prints: the level is its own mirror image, and so are the cells of the two frames.
        candidates.min_by_key(|c| c.0).map(|c| c.1).unwrap()
    }

    /// From level grid coordinates into the frame.
    pub fn enter(&self, p: GridPoint) -> GridPoint {
        let x = if self.flip_x { -p.x } else { p.x };
        let y = if self.flip_y { -p.y } else { p.y };
        let (x, y) = if self.swap { (y, x) } else { (x, y) };
        GridPoint::new(x + self.shift[0], y + self.shift[1])
    }

    /// From the frame back to level grid coordinates.
    pub fn leave(&self, v: &Vertex) -> Vertex {
        let v = v.shifted(-self.shift[0], -self.shift[1]);
        let v = v.mirrored(false, false, self.swap);
        v.mirrored(self.flip_x, self.flip_y, false)
    }

    /// A line from the frame back to level grid coordinates; and whether its left side in the frame is
    /// its right side there.
    pub fn leave_line(&self, line: &Line) -> (Line, bool) {
        // Its value at a point of the frame, as a function of the level's coordinates.
        let c = line.c + line.a * self.shift[0] + line.b * self.shift[1];
        let [x, y] = if self.swap {
            [line.b, line.a]
        } else {
            [line.a, line.b]
        };
        let a = if self.flip_x { -x } else { x };
        let b = if self.flip_y { -y } else { y };
        // Lines point right, or straight up.
        let turned = b < 0 || b == 0 && a > 0;
        let sign = if turned { -1 } else { 1 };
        let line = Line {
            a: sign * a,
            b: sign * b,
            c: sign * c,
        };
        (line, turned)
    }

    /// Whether left and right are exchanged in the frame.
    pub fn mirrors(&self) -> bool {
        self.flip_x ^ self.flip_y ^ self.swap
    }
}

/// One step of a 64-bit hash (the finaliser of SplitMix64 over a running value).
fn mix(h: u64, n: u64) -> u64 {
    let mut z = (h ^ n).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn p(x: i64, y: i64) -> GridPoint {
        GridPoint::new(x, y)
    }

    #[test]
    fn every_symmetric_copy_looks_the_same_in_its_frame() {
        let level = [
            (p(0, 0), p(10, 0), 1),
            (p(10, 0), p(3, 7), 1),
            (p(3, 7), p(0, 0), 2),
        ];
        let seen = |level: &[(GridPoint, GridPoint, u64)]| {
            let frame = Frame::of(level);
            let mut list: Vec<_> = level
                .iter()
                .map(|&(a, b, c)| {
                    let (a, b) = (frame.enter(a), frame.enter(b));
                    (a.min(b), a.max(b), c)
                })
                .collect();
            list.sort();
            list
        };
        let expected = seen(&level);
        for turn in [
            |q: GridPoint| p(-q.y, q.x),
            |q: GridPoint| p(-q.x + 5, -q.y),
            |q: GridPoint| p(q.y - 1000, q.x + 77),
            |q: GridPoint| p(-q.x, q.y),
        ] {
            let mut copy = level.map(|(a, b, c)| (turn(b), turn(a), c));
            copy.reverse();
            assert_eq!(seen(&copy), expected);
        }
    }

    #[test]
    fn leaving_undoes_entering() {
        for bits in 0..8 {
            let frame = Frame {
                flip_x: bits & 1 != 0,
                flip_y: bits & 2 != 0,
                swap: bits & 4 != 0,
                shift: [5, -9],
            };
            let q = p(123, -45);
            assert_eq!(frame.leave(&frame.enter(q).into()), q.into());
        }
    }
}
