//! Strips without an end in them between a chain's left and right ends.
//!
//! In: the ends that bound a strip. Out: its width, and the line in its middle, exactly.

use std::cmp::Ordering;

use dashu_int::IBig;
use ethnum::{AsI256, I256};
use glam::DVec2;
use smallvec::{SmallVec, smallvec};

use super::{Gate, Witness};
use crate::geom::{Placed, Side, Vertex, VertexId, Vertices};

/// How wide the widest strip is that a chain lets through, and which ends bound it.
#[derive(Clone, Debug, PartialEq)]
pub struct Slack {
    /// The width in grid steps, correct but for the last places: the distance between the convex
    /// hulls of the left and of the right ends.
    pub width: f64,
    /// The left end that bounds it; both ends where it lies along an edge of the left hull.
    pub left: SmallVec<[VertexId; 2]>,
    /// The right end that bounds it; both ends where it lies along an edge of the right hull. One of
    /// the two sides has one end.
    pub right: SmallVec<[VertexId; 2]>,
}

/// A strip that two hulls leave between them, in the direction of the sightlines: it lies along an
/// edge of one of them, or else across the way from a right end to a left end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// The left ends on its border: an edge in the strip's direction, or the same end twice.
    pub left: [Placed; 2],
    /// The right ends on its border, likewise.
    pub right: [Placed; 2],
}

impl Strip {
    /// Across the way from `right` to `left`.
    pub fn across(left: Placed, right: Placed) -> Self {
        Self {
            left: [left; 2],
            right: [right; 2],
        }
    }

    /// The edge along which it lies, if it does.
    fn edge(&self) -> Option<[&Placed; 2]> {
        [&self.left, &self.right]
            .into_iter()
            .find(|[a, b]| a.id != b.id)
            .map(|[a, b]| [a, b])
    }

    /// Towards its left, by the f64 copies.
    fn normal(&self) -> DVec2 {
        match self.edge() {
            None => self.left[0].at - self.right[0].at,
            Some([a, b]) => (b.at - a.at).perp(),
        }
    }

    /// Whether all ends that bound it are grid points.
    fn is_grid(&self, vertices: &Vertices) -> bool {
        let ends = self.left.iter().chain(&self.right);
        vertices.is_grid()
            || ends
                .into_iter()
                .all(|p| vertices.exact(p.id).grid().is_some())
    }

    /// How far to the left `p` lies compared with `q`, measured across the strip.
    fn compare(&self, vertices: &Vertices, p: &Placed, q: &Placed) -> Ordering {
        if p.id == q.id {
            return Ordering::Equal;
        }
        match self.edge() {
            None => vertices.facing([q, p], [&self.right[0], &self.left[0]]),
            // Spared the slow way, which would only find that the edge lies along itself.
            Some([a, b]) if (p.id, q.id) == (b.id, a.id) => Ordering::Equal,
            Some(edge) => match vertices.turn(edge, [q, p]) {
                Side::Left => Ordering::Greater,
                Side::On => Ordering::Equal,
                Side::Right => Ordering::Less,
            },
        }
    }

    /// Whether the chain lets the strip through, and it is as wide as the hulls are apart; exact.
    pub fn is_widest(&self, vertices: &Vertices, chain: &[Gate]) -> bool {
        let (l, r) = (&self.left[0], &self.right[0]);
        // Else the hulls are nearer to each other elsewhere.
        let over = |[a, b]: [&Placed; 2], p: &Placed| {
            let acute = |q, r| vertices.facing([q, r], [q, p]) == Ordering::Greater;
            acute(a, b) && acute(b, a)
        };
        // Most ends are as far from the border as f64 can tell; the others are looked at closely.
        let (normal, bound) = (self.normal(), vertices.bound());
        let far = |p: &Placed, from: &Placed| normal.dot(p.at - from.at);
        let has_width = self.compare(vertices, l, r) == Ordering::Greater;
        has_width
            && self.edge().is_none_or(|[a, b]| {
                let other = if a.id == l.id { r } else { l };
                over([a, b], other)
            })
            && chain.iter().all(|gate| {
                let [left, right] = [gate.left, gate.right].map(|v| vertices.placed(v));
                (far(&left, l) > bound || self.compare(vertices, &left, l) != Ordering::Less)
                    && (far(&right, r) < -bound
                        || self.compare(vertices, &right, r) != Ordering::Greater)
            })
    }

    /// Its width in grid steps.
    fn width(&self, vertices: &Vertices) -> f64 {
        let (l, r) = (&self.left[0], &self.right[0]);
        if self.is_grid(vertices) {
            // Without error but for the root's and the quotient's.
            let normal = self.normal();
            return normal.dot(l.at - r.at) / normal.length();
        }
        match self.edge() {
            None => {
                let (way, scale) = difference(vertices.exact(r.id), vertices.exact(l.id));
                length(way) / scale.as_f64()
            }
            Some([a, b]) => {
                // Twice the triangle's area by its base.
                let other = if a.id == l.id { r } else { l };
                let [a, b, p] = [a, b, other].map(|p| vertices.exact(p.id));
                let base = length(difference(a, b).0);
                area(a, b, p).as_f64().abs() / base / p.w() as f64
            }
        }
    }

    /// The strip's width and what bounds it.
    pub fn slack(&self, vertices: &Vertices) -> Slack {
        let ends = |[a, b]: [Placed; 2]| {
            if a.id == b.id {
                smallvec![a.id]
            } else {
                smallvec![a.id, b.id]
            }
        };
        Slack {
            width: self.width(vertices),
            left: ends(self.left),
            right: ends(self.right),
        }
    }

    /// The line in its middle, up to a rounding that cannot take it out of the strip.
    pub fn middle(&self, vertices: &Vertices) -> Witness {
        let slack = self.width(vertices);
        let (l, r) = (self.left[0].at, self.right[0].at);
        let normal = self.normal();
        if self.is_grid(vertices) {
            // Twice n·p - n·(l + r)/2, of 55 bits at most.
            let [a, b] = [normal.x as i64, normal.y as i64];
            let c = a * (l.x + r.x) as i64 + b * (l.y + r.y) as i64;
            return Witness {
                a: (2 * a).into(),
                b: (2 * b).into(),
                c: (-c).into(),
                slack,
            };
        }
        let across = normal.dot(l - r);
        // Rounded. With M the largest coordinate and u = 2^-53, the copies' errors (see `Vertices::bound`)
        // put the normal off by 8.02·u·M in each coordinate and the midpoint by 4.01·u·M, so the
        // value at any of the vertices by less than 4M·8.02·u·M + 4M·4.01·u·M < 2^-47·M², a quarter
        // of the bound. At the strip's borders the value is half of `across`, which is off by at
        // most the bound.
        if across > 4.0 * vertices.bound() {
            let line = Witness::through(normal, (l + r) / 2.0, 0.0, slack);
            return line.expect("a strip of some width has a direction");
        }
        self.exact_middle(vertices, slack)
    }

    /// The line in its very middle.
    #[cold]
    fn exact_middle(&self, vertices: &Vertices, slack: f64) -> Witness {
        let [l, r] = [&self.left[0], &self.right[0]].map(|p| vertices.exact(p.id));
        let normal = match self.edge() {
            None => difference(r, l).0,
            Some([a, b]) => {
                let ([x, y], _) = difference(vertices.exact(a.id), vertices.exact(b.id));
                [-y, x]
            }
        };
        let [nx, ny] = normal.map(big);
        // 2·w(l)·w(r) times n·p - n·(l + r)/2.
        let at = |v: &Vertex| &nx * v.x() + &ny * v.y();
        let c = -(at(l) * r.w() + at(r) * l.w());
        let scale = IBig::from(2) * l.w() * r.w();
        Witness {
            a: &nx * &scale,
            b: &ny * scale,
            c,
            slack,
        }
    }
}

/// The way from `p` to `q`, of 135 bits, in parts of the positive number that comes with it.
fn difference(p: &Vertex, q: &Vertex) -> ([I256; 2], I256) {
    let [pw, qw] = [p, q].map(|v| I256::from(v.w()));
    let less = |m: i128, n: i128| m.as_i256() * pw - n.as_i256() * qw;
    ([less(q.x(), p.x()), less(q.y(), p.y())], pw * qw)
}

/// Twice the area of a triangle, times the product of its corners' w: 217 bits.
fn area(p: &Vertex, q: &Vertex, r: &Vertex) -> I256 {
    let wide = |v: &Vertex| (v.x().as_i256(), v.y().as_i256(), I256::from(v.w()));
    let ((px, py, pw), (qx, qy, qw), (rx, ry, rw)) = (wide(p), wide(q), wide(r));
    px * (qy * rw - ry * qw) - py * (qx * rw - rx * qw) + pw * (qx * ry - rx * qy)
}

fn length([x, y]: [I256; 2]) -> f64 {
    DVec2::new(x.as_f64(), y.as_f64()).length()
}

fn big(n: I256) -> IBig {
    let (high, low) = n.into_words();
    (IBig::from(high) << 128) + IBig::from(low as u128)
}
