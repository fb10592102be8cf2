//! The predicates by which the exact part of the program decides every geometric sign.
//!
//! [`orient`] is exact on any three [`Vertex`] values (256-bit integers). [`Vertices`] holds many of
//! them with f64 copies, and answers by the copies where a proven error bound allows it, which is
//! nearly always; for grid points the f64 answer is itself exact.

use std::cmp::Ordering;

use dashu_int::{IBig, Sign};
use ethnum::I256;
use glam::DVec2;
use rustc_hash::{FxBuildHasher, FxHashMap};

use super::grid::{GRID_LIMIT, GridPoint};
use super::interval::Interval;
use super::line::Line;
use super::vertex::Vertex;

/// A side of a directed line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// On the left hand of somebody walking along the line.
    Left,
    /// Exactly on the line.
    On,
    /// On the right hand.
    Right,
}

impl Side {
    /// Left for positive, right for negative numbers.
    #[inline]
    pub fn of<N: PartialOrd + Default>(n: N) -> Self {
        if n > N::default() {
            Side::Left
        } else if n < N::default() {
            Side::Right
        } else {
            Side::On
        }
    }

    /// Left for positive, right for negative numbers of any size.
    pub fn of_big(n: &IBig) -> Self {
        if n.is_zero() {
            Side::On
        } else if n.sign() == Sign::Positive {
            Side::Left
        } else {
            Side::Right
        }
    }

    /// The other side; `On` stays.
    #[inline]
    pub fn flip(self) -> Self {
        match self {
            Side::Left => Side::Right,
            Side::On => Side::On,
            Side::Right => Side::Left,
        }
    }
}

/// Side of `r` as seen from `p` walking to `q`: the sign of the determinant of the three homogeneous
/// points. `On` where two of them coincide.
///
/// Widths: each product of two coordinates 160 bits, times a w 214, summed 217: fits 256.
pub fn orient(p: &Vertex, q: &Vertex, r: &Vertex) -> Side {
    if let (Some(p), Some(q), Some(r)) = (p.grid(), q.grid(), r.grid()) {
        return Side::of((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x));
    }
    orient_wide(p, q, r)
}

/// [`orient`] where the vertices' [`width`] is at most 126 bits.
fn orient_narrow(p: &Vertex, q: &Vertex, r: &Vertex) -> Side {
    let [(px, py, pw), (qx, qy, qw), (rx, ry, rw)] =
        [p, q, r].map(|v| (v.x(), v.y(), i128::from(v.w())));
    Side::of(px * (qy * rw - ry * qw) - py * (qx * rw - rx * qw) + pw * (qx * ry - rx * qy))
}

/// Bits that the determinant of any three of the vertices can take, sign included.
fn width(vertices: &[Vertex]) -> u32 {
    let bits = |n: u128| u128::BITS - n.leading_zeros();
    let of = |f: fn(&Vertex) -> u128| bits(vertices.iter().map(f).max().unwrap_or(0));
    // Six products of an x, a y and a w.
    of(|v| v.x().unsigned_abs()) + of(|v| v.y().unsigned_abs()) + of(|v| v.w() as u128) + 4
}

fn orient_wide(p: &Vertex, q: &Vertex, r: &Vertex) -> Side {
    let wide = |v: &Vertex| (I256::from(v.x()), I256::from(v.y()), I256::from(v.w()));
    let ((px, py, pw), (qx, qy, qw), (rx, ry, rw)) = (wide(p), wide(q), wide(r));
    Side::of(px * (qy * rw - ry * qw) - py * (qx * rw - rx * qw) + pw * (qx * ry - rx * qy))
}

/// Index into [`Vertices`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VertexId(pub u32);

/// A vertex with its f64 copy at hand.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// Which vertex.
    pub id: VertexId,
    /// Its f64 copy, as of [`Vertices::approx`].
    pub at: DVec2,
}

/// A directed line through two different grid points, with f64 copies at hand.
#[derive(Clone, Copy, Debug)]
pub struct Directed {
    from: GridPoint,
    to: GridPoint,
    at: DVec2,
    d: DVec2,
}

impl Directed {
    /// The line from one grid point to another; `None` where they are the same, or off the grid.
    pub fn through(from: GridPoint, to: GridPoint) -> Option<Self> {
        let on_grid = |p: GridPoint| p.x.abs() < GRID_LIMIT && p.y.abs() < GRID_LIMIT;
        (from != to && on_grid(from) && on_grid(to)).then(|| {
            let at = DVec2::new(from.x as f64, from.y as f64);
            let d = DVec2::new((to.x - from.x) as f64, (to.y - from.y) as f64);
            Self { from, to, at, d }
        })
    }
}

/// A fixed set of exact vertices with f64 copies for the filter.
#[derive(Clone, Debug, Default)]
pub struct Vertices {
    exact: Vec<Vertex>,
    approx: Vec<DVec2>,
    /// Whether every vertex is a grid point: then the f64 answer is exact.
    all_grid: bool,
    /// Whether i128 holds every determinant of three of the vertices.
    narrow: bool,
    /// The largest coordinate of the f64 copies, without its sign.
    reach: f64,
    /// See [`Vertices::bound`]: a cross product of the f64 copies larger than this has the true sign;
    /// it is off by less.
    bound: f64,
    /// How far a coordinate of an f64 copy is off at most.
    error: f64,
}

impl Vertices {
    /// Takes the vertices over; ids are positions.
    pub fn new(exact: Vec<Vertex>) -> Self {
        let approx: Vec<DVec2> = exact.iter().map(Vertex::approx).collect();
        let all_grid = exact.iter().all(|v| v.grid().is_some());
        let reach = approx
            .iter()
            .fold(0.0f64, |m, p| m.max(p.x.abs()).max(p.y.abs()));
        let (bound, error) = if all_grid {
            // Differences have at most 27 bits, products 53, and so has their difference.
            (0.0, 0.0)
        } else {
            // With M the largest coordinate and u = 2^-53: a copy is off by at most 3.01·u·M, a
            // difference of two by e = (6.02 + 2)·u·M < 2^-49·M, and is itself at most 2M. The
            // cross product of two differences is off by 4·2M·e + 2e², and rounding adds at most
            // 3·u·8M²: together below 2^-45·M².
            (reach * reach * 2f64.powi(-45), reach * 2f64.powi(-51))
        };
        let narrow = width(&exact) <= 127;
        Self {
            exact,
            approx,
            all_grid,
            narrow,
            reach,
            bound,
            error,
        }
    }

    /// The largest coordinate of the vertices' f64 copies, without its sign.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Whether all of them are grid points.
    pub fn are_grid(&self) -> bool {
        self.all_grid
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.exact.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.exact.is_empty()
    }

    /// Whether every vertex is a grid point: then the copies are exact.
    #[inline]
    pub fn is_grid(&self) -> bool {
        self.all_grid
    }

    /// By how much the cross product, or the scalar product, of two differences of f64 copies can be
    /// off, computed in f64: a larger one has the true sign.
    #[inline]
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// The exact vertex.
    #[inline]
    pub fn exact(&self, v: VertexId) -> &Vertex {
        &self.exact[v.0 as usize]
    }

    /// The vertex in f64, in grid steps; see [`Vertex::approx`] for the error.
    #[inline]
    pub fn approx(&self, v: VertexId) -> DVec2 {
        self.approx[v.0 as usize]
    }

    /// All exact vertices, in the order of their ids.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Vertex> {
        self.exact.iter()
    }

    /// The vertex with its f64 copy.
    #[inline]
    pub fn placed(&self, id: VertexId) -> Placed {
        Placed {
            id,
            at: self.approx(id),
        }
    }

    /// As [`orient`], for vertices at hand.
    #[inline]
    pub fn side(&self, p: &Placed, q: &Placed, r: &Placed) -> Side {
        self.orient_from(p.id, q.id, q.at - p.at, r.id, r.at - p.at)
    }

    /// As [`orient`], by id.
    #[inline]
    pub fn orient(&self, p: VertexId, q: VertexId, r: VertexId) -> Side {
        let o = self.approx(p);
        self.orient_from(p, q, self.approx(q) - o, r, self.approx(r) - o)
    }

    /// As [`Vertices::orient`], with the f64 differences `q - p` and `r - p` at hand.
    #[inline]
    pub fn orient_from(
        &self,
        p: VertexId,
        q: VertexId,
        to_q: DVec2,
        r: VertexId,
        to_r: DVec2,
    ) -> Side {
        let cross = to_q.x * to_r.y - to_q.y * to_r.x;
        if cross > self.bound {
            Side::Left
        } else if cross < -self.bound {
            Side::Right
        } else if self.all_grid || q == r {
            Side::On
        } else {
            self.orient_exact(p, q, r)
        }
    }

    /// Twice the area of the triangle, positive where `r` lies left of the way from `p` to `q`: an
    /// interval on the true side of zero, and exactly zero where the three lie on one line.
    #[inline]
    pub fn area(&self, p: &Placed, q: &Placed, r: &Placed) -> Interval {
        let (to_q, to_r) = (q.at - p.at, r.at - p.at);
        let cross = to_q.x * to_r.y - to_q.y * to_r.x;
        if self.all_grid {
            return Interval::point(cross);
        }
        if p.id == r.id || q.id == r.id || p.id == q.id {
            return Interval::ZERO;
        }
        let area = Interval::around(cross, self.bound);
        if cross.abs() > self.bound {
            area
        } else {
            area.on(self.orient_exact(p.id, q.id, r.id))
        }
    }

    /// How far a coordinate of an f64 copy may be off; zero where all vertices are grid points.
    pub fn error(&self) -> f64 {
        self.error
    }

    #[cold]
    #[inline(never)]
    fn orient_exact(&self, p: VertexId, q: VertexId, r: VertexId) -> Side {
        let [p, q, r] = [p, q, r].map(|v| self.exact(v));
        if self.narrow {
            orient_narrow(p, q, r)
        } else {
            orient(p, q, r)
        }
    }

    /// Side of the vertex as seen by somebody who walks along the line.
    #[inline]
    pub fn side_along(&self, line: &Directed, r: &Placed) -> Side {
        let cross = line.d.x * (r.at.y - line.at.y) - line.d.y * (r.at.x - line.at.x);
        // Between grid points, all differences have at most 27 bits: the cross product is exact.
        // Otherwise, with L = 2^25 and u = 2^-53: the copy is off by at most 3·u·L and the
        // difference by 3·u·L + u·2L, in each coordinate; each product by 2L times as much and by
        // u·4L², and their difference by u·8L² more. Together below 36·u·L² = 4.5.
        let bound = if self.all_grid { 0.0 } else { 4.5 };
        if cross > bound {
            Side::Left
        } else if cross < -bound {
            Side::Right
        } else if self.all_grid {
            Side::On
        } else {
            self.side_along_exactly(line, r.id)
        }
    }

    #[cold]
    #[inline(never)]
    fn side_along_exactly(&self, line: &Directed, r: VertexId) -> Side {
        orient(&line.from.into(), &line.to.into(), self.exact(r))
    }

    /// To which side somebody turns who walked from `p` to `q` and goes on as from `r` to `s`: the
    /// sign of the cross product of the two ways.
    #[inline]
    pub fn turn(&self, [p, q]: [&Placed; 2], [r, s]: [&Placed; 2]) -> Side {
        // The bound of `orient_from` is for any cross product of two differences.
        let (to_q, to_s) = (q.at - p.at, s.at - r.at);
        let cross = to_q.x * to_s.y - to_q.y * to_s.x;
        if cross.abs() > self.bound || self.all_grid {
            return Side::of(cross);
        }
        let [(ax, ay), (bx, by)] = self.ways([p, q], [r, s]);
        Side::of_big(&(ax * by - ay * bx))
    }

    /// Whether the ways from `p` to `q` and from `r` to `s` lead in the same direction (`Greater`:
    /// they make an acute angle), in opposite ones (`Less`), or at right angles: the sign of their
    /// scalar product.
    #[inline]
    pub fn facing(&self, [p, q]: [&Placed; 2], [r, s]: [&Placed; 2]) -> Ordering {
        // Two products of differences are added, as they are subtracted in a cross product: the
        // same bound holds.
        let (to_q, to_s) = (q.at - p.at, s.at - r.at);
        let dot = to_q.x * to_s.x + to_q.y * to_s.y;
        if dot.abs() > self.bound || self.all_grid {
            return dot.partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        }
        let [(ax, ay), (bx, by)] = self.ways([p, q], [r, s]);
        (ax * bx + ay * by).cmp(&IBig::ZERO)
    }

    /// The differences `q - p` and `s - r`, each times a positive number. Of 135 bits, so that their
    /// products do not fit 256.
    #[cold]
    fn ways(&self, first: [&Placed; 2], second: [&Placed; 2]) -> [(IBig, IBig); 2] {
        [first, second].map(|[p, q]| {
            let (p, q) = (self.exact(p.id), self.exact(q.id));
            let less = |m: i128, n: i128| {
                IBig::from(m) * IBig::from(p.w()) - IBig::from(n) * IBig::from(q.w())
            };
            (less(q.x(), p.x()), less(q.y(), p.y()))
        })
    }

    /// For `q` and `r` on one line with `p`, both different from it: whether they lie in the same
    /// direction from `p` (and not on opposite sides of it).
    pub fn same_direction(&self, p: VertexId, q: VertexId, r: VertexId) -> bool {
        let (p, q, r) = (self.exact(p), self.exact(q), self.exact(r));
        p.cmp_x(q) == p.cmp_x(r) && p.cmp_y(q) == p.cmp_y(r)
    }
}

/// Collects vertices, each point once.
#[derive(Clone, Debug, Default)]
pub struct VertexSet {
    list: Vec<Vertex>,
    /// Grid points in little room; [`OFF_GRID`] for the others.
    grid: Vec<[i32; 2]>,
    ids: FxHashMap<Vertex, VertexId>,
}

/// Stands for a vertex that is not on the grid.
const OFF_GRID: [i32; 2] = [i32::MIN; 2];

impl VertexSet {
    /// Empty, with room for `n` points.
    pub fn with_capacity(n: usize) -> Self {
        Self {
            list: Vec::with_capacity(n),
            grid: Vec::with_capacity(n),
            ids: FxHashMap::with_capacity_and_hasher(n, FxBuildHasher),
        }
    }

    /// The id of `v`, new if the point is new.
    pub fn insert(&mut self, v: Vertex) -> VertexId {
        *self.ids.entry(v).or_insert_with(|| {
            self.list.push(v);
            let narrow = |p: GridPoint| Some([p.x.try_into().ok()?, p.y.try_into().ok()?]);
            self.grid
                .push(v.grid().and_then(narrow).unwrap_or(OFF_GRID));
            VertexId(self.list.len() as u32 - 1)
        })
    }

    /// The vertex with that id.
    #[inline]
    pub fn get(&self, id: VertexId) -> &Vertex {
        &self.list[id.0 as usize]
    }

    /// Side of the line on which the vertex lies; as [`Line::side`], but faster for grid points.
    #[inline]
    pub fn side(&self, id: VertexId, line: &Line) -> Side {
        match self.grid[id.0 as usize] {
            OFF_GRID => line.side(self.get(id)),
            [x, y] => Side::of(line.a * i64::from(x) + line.b * i64::from(y) + line.c),
        }
    }

    /// Compares two vertices of the line in its direction; as [`Line::cmp_along`], but faster for
    /// grid points.
    #[inline]
    pub fn cmp_along(&self, line: &Line, p: VertexId, q: VertexId) -> Ordering {
        match (self.grid[p.0 as usize], self.grid[q.0 as usize]) {
            (OFF_GRID, _) | (_, OFF_GRID) => line.cmp_along(self.get(p), self.get(q)),
            // Lines point right, or straight up.
            (p, q) => p.cmp(&q),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_and_facing_where_copies_do_not_tell() {
        // Off the grid, and in f64 all three in the same place.
        let at = |x: i128, y: i128| Vertex::homogeneous(x, y, (1 << 50) - 1).unwrap();
        let far = 1 << 73;
        let vertices = Vertices::new(vec![
            at(0, 0),
            at(far, far),
            at(far + 1, far),
            at(far, far + 1),
            at(far + 1, far + 1),
        ]);
        let [o, p, right, up, q] = [0, 1, 2, 3, 4].map(|i| vertices.placed(VertexId(i)));
        assert_eq!(p.at, q.at);
        assert_eq!(vertices.turn([&o, &p], [&p, &right]), Side::Right);
        assert_eq!(vertices.turn([&o, &p], [&p, &up]), Side::Left);
        assert_eq!(vertices.turn([&o, &p], [&p, &q]), Side::On);
        assert_eq!(vertices.facing([&p, &right], [&p, &up]), Ordering::Equal);
        assert_eq!(vertices.facing([&p, &q], [&p, &up]), Ordering::Greater);
        assert_eq!(vertices.facing([&p, &q], [&up, &p]), Ordering::Less);
        assert_eq!(vertices.facing([&o, &p], [&up, &right]), Ordering::Equal);
        assert_eq!(vertices.facing([&o, &q], [&p, &p]), Ordering::Equal);
    }
}
