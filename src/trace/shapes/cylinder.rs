//! The cylinder x² + y² ≤ r², 0 ≤ z ≤ h, by the lecture's method: the interval in the cylinder of
//! infinite height, together with the interval between the planes z = 0 and z = h.
//!
//! In the plan the infinite cylinder is a circle, met by the geometric method as the sphere is. The
//! ray's origin is first moved to the point nearest to the solid's middle, so that an origin far away
//! costs its own rounding and no more.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::solid::Surface;
use super::span::Span;
use crate::trace::ray::Ray;

/// A cylinder about the z axis, from z = 0 up. Faces: 0 the side, 1 the bottom, 2 the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Above 0.
    pub radius: f64,
    /// Above 0.
    pub height: f64,
}

impl Cylinder {
    /// When the line is inside.
    pub fn span(&self, ray: &Ray) -> Span {
        let (ray, moved) = nearest(ray, self.height * 0.5);
        let (o, d) = (ray.origin.truncate(), ray.direction.truncate());
        let side = round(o, d, self.radius);
        let z = (ray.origin.z, ray.direction.z);
        let caps = Span::slab((0.0, self.height), z.0, z.1, [1, 2]);
        side.common(caps).later(moved)
    }

    /// The largest product of a point with `n`.
    pub fn support(&self, n: DVec3) -> f64 {
        self.radius * n.truncate().length() + (self.height * n.z).max(0.0)
    }

    /// The face near `p`. On the side u runs once around and v from bottom to top; on a disc both
    /// run across the square around it.
    pub fn surface(&self, p: DVec3, part: u32) -> Surface {
        if part != 0 {
            return disc(
                p,
                self.radius,
                if part == 1 { None } else { Some(self.height) },
            );
        }
        let out = p.truncate().normalize_or(DVec2::X);
        let z = p.z.clamp(0.0, self.height);
        Surface {
            point: (out * self.radius).extend(z),
            normal: out.extend(0.0),
            uv: DVec2::new(around(out), z / self.height),
        }
    }
}

/// The ray from its point nearest to (0, 0, z), and by how much t that is later.
pub(super) fn nearest(ray: &Ray, z: f64) -> (Ray, f64) {
    let to = DVec3::new(0.0, 0.0, z) - ray.origin;
    let moved = to.dot(ray.direction) / ray.direction.length_squared();
    let origin = ray.at(moved);
    (Ray { origin, ..*ray }, moved)
}

/// When a line in the plan is in the circle about 0.
fn round(o: DVec2, d: DVec2, radius: f64) -> Span {
    let square = d.length_squared();
    if square == 0.0 {
        return if o.length() <= radius {
            Span::ALWAYS
        } else {
            Span::NEVER
        };
    }
    let middle = -o.dot(d) / square;
    let rest = radius * radius - (o + d * middle).length_squared();
    if rest < 0.0 {
        return Span::NEVER;
    }
    let half = (rest / square).sqrt();
    Span::new(middle - half, middle + half, 0)
}

/// The part of a turn at which a direction of the plan lies.
pub(super) fn around(out: DVec2) -> f64 {
    (out.y.atan2(out.x) / TAU).rem_euclid(1.0)
}

/// A disc about the z axis: at the bottom, or at the top z.
pub(super) fn disc(p: DVec3, radius: f64, top: Option<f64>) -> Surface {
    Surface {
        point: p.truncate().extend(top.unwrap_or(0.0)),
        normal: if top.is_some() {
            DVec3::Z
        } else {
            DVec3::NEG_Z
        },
        uv: p.truncate() / (2.0 * radius) + 0.5,
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{ray, span, within};
    use super::*;

    const CYLINDER: Cylinder = Cylinder {
        radius: 2.0,
        height: 3.0,
    };

    fn of(origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        span(|ray| CYLINDER.span(ray), origin, direction)
    }

    #[test]
    fn by_the_side_and_by_the_caps() {
        assert_eq!(of([-5.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some([3.0, 7.0]));
        // At y = 1.2 the half chord is 1.6.
        within(of([-5.0, 1.2, 1.0], [1.0, 0.0, 0.0]), [3.4, 6.6], 1e-14);
        assert_eq!(of([1.0, 1.0, 5.0], [0.0, 0.0, -2.0]), Some([1.0, 2.5]));
        // In by the top at (1, 0, 3), out by the side at (2, 0, 2).
        let s = CYLINDER.span(&ray([0.0, 0.0, 4.0], [1.0, 0.0, -1.0]));
        assert_eq!((s.enter.part, s.exit.part), (2, 0));
        within(Some([s.enter.t, s.exit.t]), [1.0, 2.0], 1e-14);
        assert_eq!(of([-5.0, 0.0, 3.5], [1.0, 0.0, 0.0]), None);
        assert_eq!(of([0.0, 5.0, 1.0], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn inside_behind_tangent_parallel() {
        within(of([0.0, 0.0, 1.0], [0.0, 4.0, 0.0]), [-0.5, 0.5], 1e-15);
        assert_eq!(of([9.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some([-11.0, -7.0]));
        assert_eq!(of([-5.0, 2.0, 1.0], [1.0, 0.0, 0.0]), Some([5.0, 5.0]));
        // Along the side, in it and beside it; in the plane of the top.
        assert_eq!(of([2.0, 0.0, -1.0], [0.0, 0.0, 1.0]), Some([1.0, 4.0]));
        assert_eq!(of([2.0 + 1e-15, 0.0, -1.0], [0.0, 0.0, 1.0]), None);
        assert_eq!(of([-5.0, 0.0, 3.0], [1.0, 0.0, 0.0]), Some([3.0, 7.0]));
    }

    #[test]
    fn from_a_million_away() {
        within(
            of([-1e6, 1.2, 1.0], [1.0, 0.0, 0.0]),
            [1e6 - 1.6, 1e6 + 1.6],
            3e-10,
        );
        // Nearly along the axis, out by the top: at z = 3 after a million and three.
        let t = of([0.0, 0.0, -1e6], [1e-6, 0.0, 1.0]).unwrap();
        within(Some(t), [1e6, 1e6 + 3.0], 1e-9);
    }

    #[test]
    fn its_surface() {
        let s = CYLINDER.surface(DVec3::new(0.0, -2.1, 1.5), 0);
        assert_eq!(s.point, DVec3::new(0.0, -2.0, 1.5));
        assert_eq!((s.normal, s.uv), (DVec3::NEG_Y, DVec2::new(0.75, 0.5)));
        let s = CYLINDER.surface(DVec3::new(1.0, 0.0, 3.01), 2);
        assert_eq!((s.normal, s.uv), (DVec3::Z, DVec2::new(0.75, 0.5)));
        assert_eq!(s.point.z, 3.0);
        assert_eq!(CYLINDER.support(DVec3::new(3.0, 4.0, -1.0)), 10.0);
        assert_eq!(CYLINDER.support(DVec3::new(0.0, 0.0, 2.0)), 6.0);
    }
}
