//! The cone h²(x² + y²) ≤ r²z², 0 ≤ z ≤ h: its tip at the origin, its base a disc of radius r at
//! z = h. As in the lecture: the interval in the infinite cone, together with that between z = 0 and
//! z = h.
//!
//! The lecture's equation has a second nappe, below the tip, and so its roots bound no interval of
//! the solid where the ray is steeper than the side: there the ray is *outside* between them, and what
//! counts is the half-line in the upper nappe. With k = r/h and f(t) = At² + 2Bt + C the value of
//! x² + y² - k²z²:
//!
//! - A > 0: inside between the roots, all in one nappe.
//! - A < 0: inside from the last root on if the ray goes up, until the first if it goes down.
//! - A = 0, parallel to the side: inside on one side of the only root.
//!
//! The plane z = 0 then leaves of the lower nappe nothing. B² - AC is not computed as that
//! difference, but as k²((xdz - zdx)² + (ydz - zdy)²) - (xdy - ydx)², whose terms vanish with the
//! distance from the tip.

use glam::{DVec2, DVec3};

use super::cylinder::{around, disc, nearest};
use super::solid::Surface;
use super::span::Span;
use crate::trace::ray::Ray;

/// A cone about the z axis, its tip at the origin, opening upwards. Faces: 0 the side, 1 the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Of the base; above 0.
    pub radius: f64,
    /// Above 0.
    pub height: f64,
}

impl Cone {
    /// When the line is inside.
    pub fn span(&self, ray: &Ray) -> Span {
        let (ray, moved) = nearest(ray, self.height * 0.5);
        let z = (ray.origin.z, ray.direction.z);
        let caps = Span::slab((0.0, self.height), z.0, z.1, [0, 1]);
        self.infinite(&ray).common(caps).later(moved)
    }

    /// When the line is in the infinite cone; in the upper nappe, where it meets both.
    fn infinite(&self, ray: &Ray) -> Span {
        let k = self.radius / self.height;
        let (o, d) = (ray.origin, ray.direction);
        let a = d.x * d.x + d.y * d.y - k * k * d.z * d.z;
        let b = o.x * d.x + o.y * d.y - k * k * o.z * d.z;
        let (out, side) = (o.truncate().length(), k * o.z.abs());
        let c = (out - side) * (out + side);
        let m = o.cross(d);
        let square = k * k * (m.x * m.x + m.y * m.y) - m.z * m.z;
        if square < 0.0 && a >= 0.0 {
            return Span::NEVER;
        }
        let half = square.max(0.0).sqrt().copysign(b);
        let q = -(b + half);
        if q == 0.0 {
            // Through the tip; or along the side's direction in a plane that touches the cone.
            return match a {
                _ if a > 0.0 => Span::new(0.0, 0.0, 0),
                _ if a < 0.0 => half_line(0.0, d.z > 0.0),
                _ if c <= 0.0 => Span::ALWAYS,
                _ => Span::NEVER,
            };
        }
        if a == 0.0 {
            return half_line(c / q, b < 0.0);
        }
        // As for the sphere: the better of two formulas for the root that is a difference.
        let other = q / a;
        let root = if q * q > (out * out + side * side) * a.abs() {
            c / q
        } else {
            (half - b) / a
        };
        let (first, last) = (root.min(other), root.max(other));
        match a {
            _ if a > 0.0 => Span::new(first, last, 0),
            _ if d.z > 0.0 => half_line(last, true),
            _ => half_line(first, false),
        }
    }

    /// The largest product of a point with `n`.
    pub fn support(&self, n: DVec3) -> f64 {
        (self.radius * n.truncate().length() + self.height * n.z).max(0.0)
    }

    /// The face near `p`. On the side u runs once around and v from the tip to the base; on the base
    /// both run across the square around it.
    pub fn surface(&self, p: DVec3, part: u32) -> Surface {
        if part == 1 {
            return disc(p, self.radius, Some(self.height));
        }
        let k = self.radius / self.height;
        let z = p.z.clamp(0.0, self.height);
        let normal = |out: DVec2| out.extend(-k).normalize();
        match p.truncate().try_normalize() {
            Some(out) => Surface {
                point: (out * (k * z)).extend(z),
                normal: normal(out),
                uv: DVec2::new(around(out), z / self.height),
            },
            None => Surface {
                point: DVec3::new(0.0, 0.0, z),
                normal: DVec3::NEG_Z,
                uv: DVec2::ZERO,
            },
        }
    }
}

/// From t on, or until t.
fn half_line(t: f64, on: bool) -> Span {
    if on {
        Span::new(t, f64::INFINITY, 0)
    } else {
        Span::new(f64::NEG_INFINITY, t, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{ray, span, within};
    use super::*;

    /// At height z its radius is z/2.
    const CONE: Cone = Cone {
        radius: 2.0,
        height: 4.0,
    };

    fn of(origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        span(|ray| CONE.span(ray), origin, direction)
    }

    #[test]
    fn level_rays() {
        // At z = 2 the radius is 1; at y = 0.6 the half chord is 0.8.
        within(of([-3.0, 0.0, 2.0], [1.0, 0.0, 0.0]), [2.0, 4.0], 1e-14);
        within(of([-3.0, 0.6, 2.0], [1.0, 0.0, 0.0]), [2.2, 3.8], 1e-14);
        within(of([-3.0, 1.0, 2.0], [1.0, 0.0, 0.0]), [3.0, 3.0], 1e-7);
        assert_eq!(of([-3.0, 1.1, 2.0], [1.0, 0.0, 0.0]), None);
        // The mirror image below the tip is no part of it.
        assert_eq!(of([-3.0, 0.0, -2.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(of([-3.0, 0.0, 4.5], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn steep_rays_meet_both_nappes() {
        // Straight down at x = 1: in by the base, out by the side at z = 2.
        let s = CONE.span(&ray([1.0, 0.0, 9.0], [0.0, 0.0, -1.0]));
        within(Some([s.enter.t, s.exit.t]), [5.0, 7.0], 1e-14);
        assert_eq!((s.enter.part, s.exit.part), (1, 0));
        within(of([1.0, 0.0, -9.0], [0.0, 0.0, 2.0]), [5.5, 6.5], 1e-14);
        // Slanted: x = z/4 + 1 meets x = z/2 at z = 4, on the rim, from outside.
        within(of([1.0, 0.0, 0.0], [0.25, 0.0, 1.0]), [4.0, 4.0], 1e-12);
        // x = z/4 - 1/4: in by -x = z/2 at z = 1/3, still inside at the base.
        within(
            of([-0.25, 0.0, 0.0], [0.25, 0.0, 1.0]),
            [1.0 / 3.0, 4.0],
            1e-14,
        );
    }

    #[test]
    fn the_tip_the_axis_and_the_side_s_own_direction() {
        assert_eq!(of([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]), Some([1.0, 5.0]));
        assert_eq!(
            of([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            Some([1.0, 1.0]),
            "the tip"
        );
        // Parallel to the side: x = z/2 + 1 is outside, x = z/2 - 1 inside from z = 1 on.
        assert_eq!(of([1.0, 0.0, 0.0], [0.5, 0.0, 1.0]), None);
        within(of([-1.0, 0.0, 0.0], [0.5, 0.0, 1.0]), [1.0, 4.0], 1e-14);
        within(of([1.0, 0.0, 4.0], [-0.5, 0.0, -1.0]), [0.0, 3.0], 1e-14);
        // In the side itself, from the tip to the rim.
        within(of([0.0, 0.0, 0.0], [0.5, 0.0, 1.0]), [0.0, 4.0], 1e-14);
        within(of([3.0, 0.0, 6.0], [-0.5, 0.0, -1.0]), [2.0, 6.0], 1e-14);
    }

    #[test]
    fn inside_behind_and_far_away() {
        within(of([0.0, 0.0, 2.0], [0.0, 2.0, 0.0]), [-0.5, 0.5], 1e-15);
        within(of([5.0, 0.0, 2.0], [1.0, 0.0, 0.0]), [-6.0, -4.0], 1e-14);
        within(
            of([-1e6, 0.6, 2.0], [1.0, 0.0, 0.0]),
            [1e6 - 0.8, 1e6 + 0.8],
            3e-10,
        );
        within(
            of([1.0, 0.0, 1e6], [0.0, 0.0, -1.0]),
            [1e6 - 4.0, 1e6 - 2.0],
            3e-10,
        );
    }

    #[test]
    fn its_surface() {
        let s = CONE.surface(DVec3::new(0.0, 1.001, 2.0), 0);
        assert_eq!(s.point, DVec3::new(0.0, 1.0, 2.0));
        assert!((s.normal - DVec3::new(0.0, 2.0, -1.0).normalize()).length() < 1e-15);
        assert_eq!(s.uv, DVec2::new(0.25, 0.5));
        assert_eq!(CONE.surface(DVec3::ZERO, 0).normal, DVec3::NEG_Z);
        assert_eq!(CONE.surface(DVec3::new(1.0, 0.0, 4.0), 1).normal, DVec3::Z);
        assert_eq!(CONE.support(DVec3::NEG_Z), 0.0);
        assert_eq!(CONE.support(DVec3::new(1.0, 0.0, 1.0)), 6.0);
    }
}
