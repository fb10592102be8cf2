//! Three openings that contradict each other: along which lines of the plan they do.
//!
//! Let a line of the plan meet the portals i, j, k of a chain, in this order, and let the opening of
//! j be the one that is too low: its top `t` against the bottoms `u` and `v` of the other two. A
//! straight line passes below t and above u and v exactly if
//!
//! (t − u)·|jk| + (t − v)·|ij| > 0,
//!
//! with the distances along the line of the plan. Multiplied by how steeply the line crosses the
//! three portals, this is a quadratic form in the line's vector (a, b, c). Where its polar form is
//! not above zero for any two corners of a polygon of lines (equal ones included), it is not above
//! zero for any sum of them: then no line of the polygon passes the three openings in any way.

use dashu_int::IBig;
use smallvec::SmallVec;

use super::chain::Gate;
use super::corners::{Corner, Corners, Meeting};
use super::upright::Clash;
use crate::geom::{Interval, Placed, Vertex, Vertices};

/// The polar form of a clash on the corners of a polygon: symmetric, row after row.
pub(super) struct Form {
    pub clash: Clash,
    n: usize,
    values: SmallVec<[Interval; 36]>,
    /// The largest value, of either sign.
    largest: f64,
}

/// By how much the middle opening's decisive end lies on the passable side of those of the outer two.
struct Gaps {
    first: Interval,
    last: Interval,
}

impl Gaps {
    fn new(clash: Clash, gates: [&Gate; 3]) -> Self {
        let [(first, middle), (last, _)] = decisive(clash, gates);
        let gap = |end: f64, of_middle: f64| {
            let gap = Interval::point(of_middle) - Interval::point(end);
            if clash.dips { gap } else { -gap }
        };
        Self {
            first: gap(first, middle),
            last: gap(last, middle),
        }
    }
}

/// The decisive ends of the first and of the last opening, each with that of the middle one.
fn decisive(clash: Clash, [i, j, k]: [&Gate; 3]) -> [(f64, f64); 2] {
    if clash.dips {
        [(i.bottom, j.top), (k.bottom, j.top)]
    } else {
        [(i.top, j.bottom), (k.top, j.bottom)]
    }
}

impl Form {
    /// The form of a clash of the chain's gates. Signs that intervals leave open are decided in big
    /// integers, as some are exactly zero: at a corner's line, the three openings may just touch.
    pub fn new(vertices: &Vertices, corners: &Corners, chain: &[Gate], clash: Clash) -> Self {
        let gates = clash.gates.map(|g| &chain[g as usize]);
        let gaps = Gaps::new(clash, gates);
        let n = corners.list.len();
        /// What the form needs to know of a corner.
        struct At {
            first: Interval,
            last: Interval,
            before: Interval,
            after: Interval,
        }
        let at: SmallVec<[At; 8]> = corners
            .list
            .iter()
            .map(|corner| {
                let [i, j, k]: [Meeting; 3] = gates.map(|gate| corner.meet(vertices, gate));
                At {
                    first: i.ahead,
                    last: k.ahead,
                    before: i.until(&j),
                    after: j.until(&k),
                }
            })
            .collect();
        let mut values: SmallVec<[Interval; 36]> = SmallVec::from_elem(Interval::ZERO, n * n);
        for (r, p) in at.iter().enumerate() {
            for (c, q) in at[..=r].iter().enumerate() {
                let after = p.after * q.first + q.after * p.first;
                let before = p.before * q.last + q.before * p.last;
                let mut value = gaps.first * after + gaps.last * before;
                if !(value.is_positive() || value.is_at_most_zero()) {
                    let lines = [&corners.list[r], &corners.list[c]];
                    value = value.on(exact::side(vertices, lines, clash, gates));
                }
                values[r * n + c] = value;
                values[c * n + r] = value;
            }
        }
        let sizes = values.iter().map(|v| v.hi.abs().max(v.lo.abs()));
        let largest = sizes.fold(f64::MIN_POSITIVE, f64::max);
        Self {
            clash,
            n,
            values,
            largest,
        }
    }

    /// The polar form of two corners.
    pub fn polar(&self, p: usize, q: usize) -> Interval {
        self.values[p * self.n + q]
    }

    /// The polar form of two corners, about, as a share of its largest value.
    pub fn about(&self, p: usize, q: usize) -> f64 {
        let value = self.polar(p, q);
        (value.lo + value.hi) / 2.0 / self.largest
    }

    /// Whether no line of the whole polygon passes.
    pub fn stops_all(&self) -> bool {
        self.values.iter().all(|v| v.is_at_most_zero())
    }
}

/// The sign of the polar form in big integers.
mod exact {
    use super::{Clash, Corner, Gate, IBig, Placed, Vertex, Vertices, decisive};
    use crate::geom::Side;

    type Vector = [IBig; 3];

    fn cross(p: &Vector, q: &Vector) -> Vector {
        [
            &p[1] * &q[2] - &p[2] * &q[1],
            &p[2] * &q[0] - &p[0] * &q[2],
            &p[0] * &q[1] - &p[1] * &q[0],
        ]
    }

    fn dot(p: &Vector, q: &Vector) -> IBig {
        &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
    }

    fn point(v: &Vertex) -> Vector {
        [IBig::from(v.x()), IBig::from(v.y()), IBig::from(v.w())]
    }

    /// Heights as whole numbers of one small unit; `None` where one is not finite.
    fn whole<const N: usize>(heights: [f64; N]) -> Option<[IBig; N]> {
        if heights.iter().any(|z| !z.is_finite()) {
            return None;
        }
        let parts = heights.map(|z| {
            let bits = z.to_bits();
            let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
            let mantissa = if exponent == 0 {
                fraction
            } else {
                fraction | 1 << 52
            };
            let mantissa = IBig::from(mantissa);
            (if z < 0.0 { -mantissa } else { mantissa }, exponent.max(1))
        });
        let least = parts.iter().map(|p| p.1).min().unwrap_or(0);
        Some(parts.map(|(mantissa, exponent)| mantissa << (exponent - least) as usize))
    }

    pub fn side(vertices: &Vertices, lines: [&Corner; 2], clash: Clash, gates: [&Gate; 3]) -> Side {
        let through = |p: &Placed, q: &Placed| {
            cross(&point(vertices.exact(p.id)), &point(vertices.exact(q.id)))
        };
        let [p, q] = lines.map(|line| through(&line.from, &line.to));
        let [i, j, k] = gates.map(|gate| through(&gate.left, &gate.right));
        let ahead = |gate: &Vector, line: &Vector| &gate[0] * &line[1] - &gate[1] * &line[0];
        let (before, after) = (cross(&i, &j), cross(&j, &k));
        let after = dot(&after, &p) * ahead(&i, &q) + dot(&after, &q) * ahead(&i, &p);
        let before = dot(&before, &p) * ahead(&k, &q) + dot(&before, &q) * ahead(&k, &p);
        let [(first, middle), (last, _)] = decisive(clash, gates);
        // Openings without end contradict nothing; they are no part of any clash.
        let Some([first, middle, last]) = whole([first, middle, last]) else {
            return Side::Left;
        };
        let value = (&middle - first) * after + (middle - last) * before;
        Side::of(if clash.dips { value } else { -value })
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::geom::{GridPoint, Line, Side, VertexId};

    /// Portals in a row and lines that cross them in order, from few numbers, so that much coincides;
    /// some vertices lie off the grid.
    fn scene(random: &mut Pcg64Mcg) -> (Vertices, Vec<Gate>, Vec<[VertexId; 2]>) {
        loop {
            let (vertices, gates, lines) = any_scene(random);
            let in_order = |line: &[VertexId; 2]| {
                let [s, t, u] = [0, 1, 2].map(|g| share(&vertices, &gates[g], *line));
                s < t && t < u
            };
            if lines.iter().all(in_order) {
                return (vertices, gates, lines);
            }
        }
    }

    fn any_scene(random: &mut Pcg64Mcg) -> (Vertices, Vec<Gate>, Vec<[VertexId; 2]>) {
        let mut exact: Vec<Vertex> = Vec::new();
        let mut add = |random: &mut Pcg64Mcg, x: i64, y: i64| {
            let p = GridPoint::new(6 * x, 6 * y);
            let slanted = Line::through(GridPoint::new(6 * x + 5, 6 * y + 3), p);
            let off_grid = slanted.and_then(|l| l.meet(&Line::vertical(6 * x - 1)));
            exact.push(match off_grid {
                Some(v) if random.random_bool(0.3) => v,
                _ => p.into(),
            });
            VertexId(exact.len() as u32 - 1)
        };
        let gates: Vec<[VertexId; 2]> = (1..4)
            .map(|i| {
                let low = random.random_range(0..3);
                let slant = random.random_range(0..2);
                let high = low + random.random_range(1..3);
                [add(random, 3 * i + slant, high), add(random, 3 * i, low)]
            })
            .collect();
        let lines: Vec<[VertexId; 2]> = (0..3)
            .map(|_| {
                let [y, z] = [(); 2].map(|()| random.random_range(0..4));
                [add(random, 0, y), add(random, 15, z)]
            })
            .collect();
        let vertices = Vertices::new(exact);
        let gates = gates
            .into_iter()
            .map(|[left, right]| {
                let bottom = f64::from(random.random_range(0..4));
                Gate {
                    left: vertices.placed(left),
                    right: vertices.placed(right),
                    bottom,
                    top: bottom + f64::from(random.random_range(1..4)),
                }
            })
            .collect();
        (vertices, gates, lines)
    }

    /// Where a line crosses a portal's line, as a share of the way between its two vertices.
    fn share(vertices: &Vertices, gate: &Gate, line: [VertexId; 2]) -> f64 {
        let [p, q] = line.map(|v| vertices.approx(v));
        let along = gate.right.at - gate.left.at;
        let (behind, beyond) = (
            along.perp_dot(p - gate.left.at),
            along.perp_dot(q - gate.left.at),
        );
        -behind / (beyond - behind)
    }

    #[test]
    fn forms_say_of_one_line_what_its_crossings_say() {
        let mut random = Pcg64Mcg::seed_from_u64(2);
        let mut signs = [0; 3];
        for _ in 0..5000 {
            let (vertices, chain, lines) = scene(&mut random);
            let corners = Corners::of_lines(&vertices, &lines);
            for dips in [true, false] {
                let clash = Clash {
                    gates: [0, 1, 2],
                    dips,
                };
                let form = Form::new(&vertices, &corners, &chain, clash);
                for (i, &line) in lines.iter().enumerate() {
                    let [s, t, u] = [0, 1, 2].map(|g| share(&vertices, &chain[g], line));
                    let [a, b, c] = [&chain[0], &chain[1], &chain[2]];
                    let room = if dips {
                        (b.top - a.bottom) * (u - t) + (b.top - c.bottom) * (t - s)
                    } else {
                        (a.top - b.bottom) * (u - t) + (c.top - b.bottom) * (t - s)
                    };
                    let value = form.polar(i, i);
                    if room.abs() > 1e-9 {
                        assert_eq!(value.is_positive(), room > 0.0, "{room} {value:?}");
                        signs[if room > 0.0 { 0 } else { 1 }] += 1;
                    } else {
                        assert_eq!(value, Interval::ZERO, "{room}");
                        signs[2] += 1;
                    }
                }
            }
        }
        assert!(signs.into_iter().all(|n| n > 100), "{signs:?}");
    }

    #[test]
    fn intervals_and_integers_agree_on_every_sign() {
        let mut random = Pcg64Mcg::seed_from_u64(3);
        for _ in 0..3000 {
            let (vertices, chain, lines) = scene(&mut random);
            let corners = Corners::of_lines(&vertices, &lines);
            for dips in [true, false] {
                let clash = Clash {
                    gates: [0, 1, 2],
                    dips,
                };
                let form = Form::new(&vertices, &corners, &chain, clash);
                for (i, p) in corners.list.iter().enumerate() {
                    for (j, q) in corners.list.iter().enumerate() {
                        let gates = [&chain[0], &chain[1], &chain[2]];
                        let side = exact::side(&vertices, [p, q], clash, gates);
                        let value = form.polar(i, j);
                        let found = if value.is_positive() {
                            Side::Left
                        } else if value.is_negative() {
                            Side::Right
                        } else {
                            // Zero, or only known not to be above it.
                            assert!(value.is_at_most_zero());
                            assert_ne!(side, Side::Left);
                            continue;
                        };
                        assert_eq!(found, side, "{value:?}");
                    }
                }
            }
        }
    }
}
