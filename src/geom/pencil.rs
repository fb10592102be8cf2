//! The rays of one point: which of two directions comes first counterclockwise.
//!
//! In: a point (any [`Vertex`], not necessarily one of the set), a set of vertices, and up to two
//! free directions given in integers. Out: exact signs, and cross products that are exact but for
//! their last bits.

use std::cmp::Ordering;

use ethnum::I256;
use glam::DVec2;

use super::grid::FINE;
use super::predicate::{Placed, Side, VertexId, Vertices};
use super::vertex::Vertex;

/// A ray from the point of a [`Pencil`].
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// The direction in f64: exact for free directions, else the difference of two f64 copies.
    pub d: DVec2,
    to: u32,
}

/// What a ray aims at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// A vertex.
    Vertex(VertexId),
    /// The pencil's free direction with that number.
    Free(usize),
}

/// A name for [`Aim`] in four bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedAim(u32);

/// Numbers from here on are free directions.
const FREE: u32 = u32::MAX - 1;

/// Coordinates of free directions are below this (2^41).
pub const DIRECTION_LIMIT: i64 = 1 << 41;

impl Aim {
    fn of(to: u32) -> Self {
        if to >= FREE {
            Aim::Free((to - FREE) as usize)
        } else {
            Aim::Vertex(VertexId(to))
        }
    }
}

impl PackedAim {
    /// What it stands for.
    pub fn unpack(self) -> Aim {
        Aim::of(self.0)
    }
}

impl Ray {
    /// What it aims at.
    pub fn aim(&self) -> Aim {
        Aim::of(self.to)
    }

    /// The same in four bytes; see [`Pencil::unpack`].
    #[inline]
    pub fn pack(&self) -> PackedAim {
        PackedAim(self.to)
    }
}

/// All rays of one point.
#[derive(Clone, Copy, Debug)]
pub struct Pencil<'a> {
    vertices: &'a Vertices,
    point: Vertex,
    at: DVec2,
    free: [[i64; 2]; 2],
    /// Powers of two by which free directions are multiplied for their f64 copies.
    scales: [f64; 2],
    /// A cross product of two rays' `d` that is larger has the true sign.
    bound: f64,
    /// How far off each coordinate of a ray's `d` may be.
    off: f64,
}

impl<'a> Pencil<'a> {
    /// The rays of `point`. Free directions are not zero and below [`DIRECTION_LIMIT`]; those that
    /// are never asked for may be anything.
    pub fn new(vertices: &'a Vertices, point: Vertex, free: [[i64; 2]; 2]) -> Self {
        let at = point.approx();
        let reach = vertices.reach().max(at.x.abs()).max(at.y.abs()).max(1.0);
        // A free direction's copy is exact, and made about as long as the reach: its larger
        // coordinate between the largest power of two in the reach and twice that.
        let power = f64::from_bits(reach.to_bits() & !((1 << 52) - 1));
        let scale = |[x, y]: [i64; 2]| {
            let largest = x.unsigned_abs().max(y.unsigned_abs()).max(1);
            power / (1u64 << largest.ilog2()) as f64
        };
        // With M the reach and u = 2^-53: the copies of point and vertex are each off by at most
        // 3.01·u·M (the point's usually not at all), and their difference, at most 2M, is rounded
        // by 2·u·M: together e < 8.03·u·M. The cross product of two such is off by 4·2M·e + 2e²,
        // and rounding adds at most 2·u·8M²: together below 81·u·M² < 2^-46·M².
        // Copies of grid points are exact, as is that of a point in 2^-20 of a step, and such
        // differences have at most 46 bits.
        let fine = FINE % point.w() == 0;
        let off = if fine && vertices.are_grid() {
            0.0
        } else {
            reach * 2f64.powi(-49)
        };
        Self {
            vertices,
            point,
            at,
            free,
            scales: free.map(scale),
            bound: reach * reach * 2f64.powi(-46),
            off,
        }
    }

    /// The point.
    pub fn point(&self) -> &Vertex {
        &self.point
    }

    /// The point in f64.
    #[inline]
    pub fn at(&self) -> DVec2 {
        self.at
    }

    /// The ray to a vertex that is not the point.
    #[inline]
    pub fn ray(&self, vertex: &Placed) -> Ray {
        Ray {
            d: vertex.at - self.at,
            to: vertex.id.0,
        }
    }

    /// The ray in a free direction.
    pub fn free(&self, number: usize) -> Ray {
        let [x, y] = self.free[number];
        Ray {
            d: DVec2::new(x as f64, y as f64) * self.scales[number],
            to: FREE + number as u32,
        }
    }

    /// The ray again.
    pub fn unpack(&self, aim: PackedAim) -> Ray {
        match aim.unpack() {
            Aim::Vertex(v) => self.ray(&self.vertices.placed(v)),
            Aim::Free(number) => self.free(number),
        }
    }

    /// Whether `q` lies strictly less than a half turn counterclockwise of `p`.
    #[inline]
    pub fn is_left(&self, p: &Ray, q: &Ray) -> bool {
        let cross = p.d.x * q.d.y - p.d.y * q.d.x;
        if cross.abs() > self.bound {
            cross > 0.0
        } else {
            self.side_exact(p.to, q.to) == Side::Left
        }
    }

    /// The side of ray `p` on which `q` points; `On` for the same and for opposite directions.
    #[inline]
    pub fn side(&self, p: &Ray, q: &Ray) -> Side {
        let cross = p.d.x * q.d.y - p.d.y * q.d.x;
        if cross.abs() > self.bound {
            Side::of(cross)
        } else {
            self.side_exact(p.to, q.to)
        }
    }

    /// Whether two rays have the very same direction.
    pub fn same(&self, p: &Ray, q: &Ray) -> bool {
        p.to == q.to
            || (self.side(p, q) == Side::On && self.heading(p.aim()) == self.heading(q.aim()))
    }

    /// Whether `q` comes first as the direction turns counterclockwise, starting along the x axis.
    pub fn turn_order(&self, p: &Ray, q: &Ray) -> Ordering {
        let lower = |ray: &Ray| {
            let (x, y) = self.heading(ray.aim());
            y.is_lt() || (y.is_eq() && x.is_lt())
        };
        lower(p).cmp(&lower(q)).then_with(|| match self.side(p, q) {
            Side::Left => Ordering::Less,
            Side::On => Ordering::Equal,
            Side::Right => Ordering::Greater,
        })
    }

    /// The cross product of the rays' directions, with a relative error below 2^-32: by f64 where
    /// that is good enough, else from integers. Zero exactly where the rays are in line.
    pub fn cross(&self, p: &Ray, q: &Ray) -> f64 {
        let (a, b) = (p.d.x * q.d.y, p.d.y * q.d.x);
        let cross = a - b;
        // The copies' errors, and three roundings of at most half a last bit each.
        let doubt =
            self.off * (p.d.abs() + q.d.abs()).element_sum() + (a.abs() + b.abs()) * 2f64.powi(-51);
        if doubt < cross.abs() * 2f64.powi(-33) {
            return cross;
        }
        let unit = |aim: Aim| match aim {
            Aim::Vertex(v) => 1.0 / self.vertices.exact(v).w() as f64,
            Aim::Free(number) => self.scales[number],
        };
        let determinant = self.determinant(p.to, q.to).as_f64();
        determinant / self.point.w() as f64 * unit(p.aim()) * unit(q.aim())
    }

    #[cold]
    #[inline(never)]
    fn side_exact(&self, p: u32, q: u32) -> Side {
        if p == q {
            return Side::On;
        }
        if let (Aim::Vertex(p), Aim::Vertex(q)) = (Aim::of(p), Aim::of(q)) {
            return super::orient(&self.point, self.vertices.exact(p), self.vertices.exact(q));
        }
        Side::of(self.determinant(p, q))
    }

    /// The determinant of three homogeneous points, one of them the pencil's; a direction is a point
    /// at infinity. Widths: as for [`super::orient`], a direction being narrower than a vertex.
    fn determinant(&self, p: u32, q: u32) -> I256 {
        let vertex = |v: &Vertex| (I256::from(v.x()), I256::from(v.y()), I256::from(v.w()));
        let wide = |to| match Aim::of(to) {
            Aim::Vertex(v) => vertex(self.vertices.exact(v)),
            Aim::Free(number) => {
                let [x, y] = self.free[number].map(I256::from);
                (x, y, I256::ZERO)
            }
        };
        let ((ox, oy, ow), (px, py, pw), (qx, qy, qw)) = (vertex(&self.point), wide(p), wide(q));
        ox * (py * qw - qy * pw) - oy * (px * qw - qx * pw) + ow * (px * qy - qx * py)
    }

    /// The signs of a direction's coordinates.
    fn heading(&self, aim: Aim) -> (Ordering, Ordering) {
        match aim {
            Aim::Vertex(v) => {
                let v = self.vertices.exact(v);
                (v.cmp_x(&self.point), v.cmp_y(&self.point))
            }
            Aim::Free(number) => {
                let [x, y] = self.free[number];
                (x.cmp(&0), y.cmp(&0))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::GridPoint;
    use super::*;

    /// Rays of a point between two grid points, to vertices on and off the grid.
    #[test]
    fn signs_and_values_are_those_of_the_integers() {
        let third = |x, y| Vertex::homogeneous(x, y, 3).unwrap();
        let list = vec![
            GridPoint::new(4, 0).into(),
            GridPoint::new(-8, 0).into(),
            third(1, 1),
            third(-2, -2),
            third(1, 2),
            GridPoint::new((1 << 25) - 1, (1 << 25) - 1).into(),
            GridPoint::new((1 << 25) - 1, (1 << 25) - 2).into(),
        ];
        let vertices = Vertices::new(list);
        let origin = GridPoint::new(0, 0).into();
        let near = Vertex::homogeneous(1, 1, 1 << 20).unwrap();
        let free = [[1 << 40, 0], [(1 << 40) - 1, 1 << 40]];
        for point in [origin, near] {
            let pencil = Pencil::new(&vertices, point, free);
            let rays: Vec<Ray> = (0..vertices.len() as u32)
                .map(|v| pencil.ray(&vertices.placed(VertexId(v))))
                .chain([0, 1].map(|n| pencil.free(n)))
                .collect();
            for p in &rays {
                for q in &rays {
                    let exact = pencil.determinant(p.to, q.to);
                    assert_eq!(pencil.side(p, q), Side::of(exact));
                    assert_eq!(pencil.is_left(p, q), exact > 0);
                    assert_eq!(Side::of(pencil.cross(p, q)), Side::of(exact));
                    assert_eq!(pencil.unpack(p.pack()).d, p.d);
                    if pencil.same(p, q) {
                        assert!(p.d.dot(q.d) > 0.0);
                    }
                }
            }
            if point == origin {
                assert!(pencil.same(&rays[0], &rays[7]));
                assert!(pencil.same(&rays[2], &rays[5]));
                assert!(!pencil.same(&rays[2], &rays[3]) && !pencil.same(&rays[0], &rays[1]));
                let mut sorted: Vec<usize> = (0..7).collect();
                sorted.sort_by(|&i, &j| pencil.turn_order(&rays[i], &rays[j]));
                assert_eq!(sorted, [0, 6, 2, 5, 4, 1, 3]);
            }
        }
    }

    /// A cross product that f64 cannot tell from zero.
    #[test]
    fn small_cross_products_keep_their_digits() {
        let far = (1 << 25) - 1;
        let list = vec![
            GridPoint::new(far, far).into(),
            Vertex::homogeneous(3 * (far as i128) - 1, 3 * (far as i128) - 2, 3).unwrap(),
        ];
        let vertices = Vertices::new(list);
        let pencil = Pencil::new(&vertices, GridPoint::new(0, 0).into(), [[1, 0]; 2]);
        let [p, q] = [0, 1].map(|v| pencil.ray(&vertices.placed(VertexId(v))));
        // far·(far - 2/3) - far·(far - 1/3)
        let truth = -(far as f64) / 3.0;
        assert!((pencil.cross(&p, &q) / truth - 1.0).abs() < 1e-12);
    }
}
