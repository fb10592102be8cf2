//! The triangle, watertight.
//!
//! Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", 2013: space is sheared so that the
//! ray is an axis ([`Cast`]); in the plan along it the corners a, b, c become points about the ray at
//! (0, 0), and the ray passes inside if it lies on the same side of the three edges. The lecture's
//! barycentric coordinates are the three areas, each divided by their sum.
//!
//! No ray slips through an edge or a corner that triangles share. An edge's sign is that of the
//! difference of two rounded products: since rounding is monotone, it is right for the rounded
//! corners or 0, never wrong; two triangles at an edge compute the same corners and so opposite signs;
//! and 0 counts as inside for both. The rounded corners still make a connected surface, which has a
//! triangle at the ray wherever it passes.
//!
//! How far beside the exact triangle such a ray may pass: a sheared corner is off by at most
//! 4.1u·|corner - origin|, an edge's sign by twice that, together below 15u·(|o| + reach): a fourth of
//! the slack by which boxes are enlarged, so that no box cuts it off.

use glam::{DVec2, DVec3};

use super::Hit;
use crate::trace::accel::{Bounds, Cast, Contact};

/// A triangle, seen from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its corners. The geometric normal is on the side from which they go around counterclockwise.
    pub corners: [DVec3; 3],
    /// Normals at the corners, to be interpolated.
    pub normals: Option<[DVec3; 3]>,
    /// Texture coordinates at the corners; by default (0, 0), (1, 0), (0, 1).
    pub uv: [DVec2; 3],
}

/// Where a line pierces a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pierced {
    /// When; may be negative.
    pub t: f64,
    /// Weights of the second and third corner.
    pub weights: [f64; 2],
}

impl Triangle {
    /// Without normals.
    pub fn new(corners: [DVec3; 3]) -> Self {
        Self {
            corners,
            normals: None,
            uv: [DVec2::ZERO, DVec2::X, DVec2::Y],
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        Bounds::around(self.corners)
    }

    /// Where the line of the ray pierces it.
    #[inline]
    pub fn pierce(&self, cast: &Cast) -> Option<Pierced> {
        pierce(cast, self.corners)
    }

    /// What the triangle is like at a contact.
    pub fn hit(&self, contact: &Contact) -> Hit {
        let [v, w] = contact.weights;
        let u = 1.0 - v - w;
        let normal = normal(self.corners);
        let mixed = self
            .normals
            .map_or(normal, |n| n[0] * u + n[1] * v + n[2] * w);
        let uv = self.uv[0] * u + self.uv[1] * v + self.uv[2] * w;
        let point = point(self.corners, contact.weights);
        Hit::new(contact, point, (normal, mixed), uv)
    }
}

/// Where the line of the ray pierces the triangle. Seen edge on, a triangle is not pierced.
#[inline]
pub fn pierce(cast: &Cast, corners: [DVec3; 3]) -> Option<Pierced> {
    let [a, b, c] = corners.map(|p| cast.shear.apply(p - cast.ray.origin));
    let u = c.x * b.y - c.y * b.x;
    let v = a.x * c.y - a.y * c.x;
    let w = b.x * a.y - b.y * a.x;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let sum = u + v + w;
    if sum == 0.0 {
        return None;
    }
    Some(Pierced {
        t: (u * a.z + v * b.z + w * c.z) / sum,
        weights: [v / sum, w / sum],
    })
}

/// The unit normal; for a triangle without area some unit vector.
pub(super) fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let n = (b - a).cross(c - a);
    // Tiny triangles: the squares of the length must not vanish.
    (n / n.abs().max_element()).normalize_or(DVec3::Z)
}

/// The point with these weights. It lies in the triangle's plane to within two roundings of each
/// coordinate, wherever the ray came from.
pub(super) fn point([a, b, c]: [DVec3; 3], [v, w]: [f64; 2]) -> DVec3 {
    a + ((b - a) * v + (c - a) * w)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::super::cases::ray;
    use super::*;

    fn of(corners: [[f64; 3]; 3], origin: [f64; 3], direction: [f64; 3]) -> Option<Pierced> {
        pierce(&Cast::new(ray(origin, direction)), corners.map(DVec3::from))
    }

    /// In the plane z = 2.
    const FLAT: [[f64; 3]; 3] = [[0.0, 0.0, 2.0], [4.0, 0.0, 2.0], [0.0, 4.0, 2.0]];

    #[test]
    fn through_from_both_sides_beside_behind() {
        let hit = of(FLAT, [1.0, 2.0, 0.0], [0.0, 0.0, 4.0]).unwrap();
        assert_eq!((hit.t, hit.weights), (0.5, [0.25, 0.5]));
        let hit = of(FLAT, [1.0, 2.0, 5.0], [0.0, 0.0, -1.0]).unwrap();
        assert_eq!((hit.t, hit.weights), (3.0, [0.25, 0.5]));
        // Slanted: at z = 2 it is at (1, 1).
        let hit = of(FLAT, [-1.0, 1.0, 0.0], [1.0, 0.0, 1.0]).unwrap();
        assert_eq!((hit.t, hit.weights), (2.0, [0.25, 0.25]));
        assert_eq!(of(FLAT, [3.0, 2.0, 0.0], [0.0, 0.0, 1.0]), None);
        assert_eq!(of(FLAT, [1.0, 1.0, 3.0], [0.0, 0.0, 1.0]).unwrap().t, -1.0);
    }

    #[test]
    fn edges_and_corners_belong_to_it() {
        for (x, y) in [
            (0.0, 0.0),
            (4.0, 0.0),
            (0.0, 4.0),
            (2.0, 0.0),
            (0.0, 1.0),
            (3.0, 1.0),
        ] {
            assert!(of(FLAT, [x, y, 0.0], [0.0, 0.0, 1.0]).is_some(), "{x} {y}");
        }
        assert_eq!(of(FLAT, [-1e-300, 1.0, 0.0], [0.0, 0.0, 1.0]), None);
    }

    #[test]
    fn parallel_and_degenerate() {
        assert_eq!(
            of(FLAT, [-1.0, 1.0, 2.0], [1.0, 0.0, 0.0]),
            None,
            "in its plane"
        );
        assert_eq!(of(FLAT, [-1.0, 1.0, 1.0], [1.0, 0.0, 0.0]), None);
        let line = [[0.0, 0.0, 2.0], [1.0, 1.0, 2.0], [3.0, 3.0, 2.0]];
        assert_eq!(of(line, [2.0, 2.0, 0.0], [0.0, 0.0, 1.0]), None);
        let dot = [[1.0, 1.0, 1.0]; 3];
        assert_eq!(of(dot, [0.0; 3], [1.0, 1.0, 1.0]), None);
        assert_eq!(normal(dot.map(DVec3::from)), DVec3::Z);
        let tiny = [[0.0, 0.0, 0.0], [1e-160, 0.0, 0.0], [0.0, 1e-160, 0.0]];
        assert_eq!(normal(tiny.map(DVec3::from)), DVec3::Z);
    }

    #[test]
    fn far_away() {
        let far = FLAT.map(|p| p.map(|x| x + 1e6));
        let hit = of(far, [1e6 + 1.0, 1e6 + 2.0, 1e6], [0.0, 0.0, 4.0]).unwrap();
        assert_eq!((hit.t, hit.weights), (0.5, [0.25, 0.5]));
        let hit = of(FLAT, [1.0, 2.0, -1e6], [0.0, 0.0, 1.0]).unwrap();
        assert_eq!((hit.t, hit.weights), (1e6 + 2.0, [0.25, 0.5]));
        let point = point(FLAT.map(DVec3::from), hit.weights);
        assert_eq!(point, DVec3::new(1.0, 2.0, 2.0));
    }

    /// A fan of triangles about a point: rays aimed at its spokes and its middle, as exactly as f64
    /// can say it, always pierce one of them, and one at least on each side of a spoke's sign.
    #[test]
    fn no_ray_slips_through_a_shared_edge() {
        let mut random = Pcg64::seed_from_u64(7);
        let mut both = 0;
        for round in 0..20_000 {
            let far = if round % 2 == 0 { 0.0 } else { 1e6 };
            let mut any = |size: f64| {
                let mut next = || random.random_range(-size..size);
                DVec3::new(next(), next(), next())
            };
            let middle = any(1.0) + far;
            let n = 3 + round % 5;
            let rim: Vec<DVec3> = (0..n)
                .map(|i| {
                    let turn = std::f64::consts::TAU * (i as f64 + 0.3) / n as f64;
                    middle + DVec3::new(turn.cos(), turn.sin(), 0.0) + any(0.1)
                })
                .collect();
            let origin = middle + DVec3::Z * 5.0 + any(0.5);
            let spoke = round / 2 % n;
            let target = middle.lerp(rim[spoke], any(1.0).x.abs() * f64::from(round % 3 != 0));
            let cast = Cast::new(crate::trace::ray::Ray {
                origin,
                direction: target - origin,
            });
            let pierced = (0..n)
                .filter(|&i| pierce(&cast, [middle, rim[i], rim[(i + 1) % n]]).is_some())
                .count();
            assert!(pierced > 0, "round {round}");
            both += usize::from(pierced > 1);
        }
        assert!(
            both > 0,
            "none was so near an edge that both sides claimed it"
        );
    }
}
