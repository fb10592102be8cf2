//! The sphere, by the geometric method.
//!
//! The lecture: the ray comes nearest to the centre C at t = -(P0 - C)·D / |D|² (its slide lacks the
//! first minus sign); with d0 the distance there, it meets the sphere if d0² ≤ r², half a chord
//! √(r² - d0²) before and after.
//!
//! Two things keep that accurate for an origin far away (Haines, Günther and Akenine-Möller,
//! "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems, 2019). d0 is the length of
//! a vector, not |P0 - C|² less a square nearly as large. And of the ends of the chord the one farther
//! from the origin is a sum; the nearer one is a difference, and where that would cancel,
//! (|P0 - C|² - r²) / (|D|² times the farther). (Where the ray passes beside the middle the difference
//! is the better one: for a tangent the quotient would be 0/0.)

use std::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::solid::Surface;
use super::span::Span;
use crate::trace::ray::Ray;

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub centre: DVec3,
    /// Its radius, above 0.
    pub radius: f64,
}

impl Sphere {
    /// When the line is inside. A tangent touches.
    pub fn span(&self, ray: &Ray) -> Span {
        let to = self.centre - ray.origin;
        let square = ray.direction.length_squared();
        let ahead = to.dot(ray.direction);
        let beside = ray.direction * (ahead / square) - to;
        let rest = self.radius * self.radius - beside.length_squared();
        if rest < 0.0 {
            return Span::NEVER;
        }
        let half = (rest * square).sqrt().copysign(ahead);
        let farther = ahead + half;
        let distance = to.length();
        let one = farther / square;
        let two = if farther * farther > distance * distance * square {
            (distance - self.radius) * (distance + self.radius) / farther
        } else {
            (ahead - half) / square
        };
        Span::new(one.min(two), one.max(two), 0)
    }

    /// The largest product of a point with `n`.
    pub fn support(&self, n: DVec3) -> f64 {
        n.dot(self.centre) + self.radius * n.length()
    }

    /// The surface near `p`. u runs once around z, v from the lower pole to the upper.
    pub fn surface(&self, p: DVec3) -> Surface {
        let normal = (p - self.centre).normalize_or(DVec3::Z);
        let around = normal.y.atan2(normal.x) / TAU;
        Surface {
            point: self.centre + normal * self.radius,
            normal,
            uv: DVec2::new(around.rem_euclid(1.0), normal.z.asin() / PI + 0.5),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{span, within};
    use super::*;

    const UNIT: Sphere = Sphere {
        centre: DVec3::ZERO,
        radius: 1.0,
    };

    fn of(sphere: Sphere, origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        span(|ray| sphere.span(ray), origin, direction)
    }

    #[test]
    fn through_the_middle_and_beside() {
        assert_eq!(
            of(UNIT, [-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            Some([2.0, 4.0])
        );
        // A direction of length 2 halves t.
        assert_eq!(
            of(UNIT, [-3.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
            Some([1.0, 2.0])
        );
        // At height 0.6 the half chord is 0.8.
        within(
            of(UNIT, [-2.0, 0.0, 0.6], [1.0, 0.0, 0.0]),
            [1.2, 2.8],
            1e-15,
        );
        assert_eq!(of(UNIT, [-2.0, 0.0, 1.1], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn inside_behind_and_on_it() {
        assert_eq!(of(UNIT, [0.0; 3], [0.0, 0.0, 4.0]), Some([-0.25, 0.25]));
        within(
            of(UNIT, [0.5, 0.0, 0.0], [1.0, 0.0, 0.0]),
            [-1.5, 0.5],
            1e-15,
        );
        assert_eq!(
            of(UNIT, [3.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            Some([-4.0, -2.0])
        );
        // From the surface inwards: exactly 0 and the diameter.
        assert_eq!(
            of(UNIT, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            Some([0.0, 2.0])
        );
    }

    #[test]
    fn a_tangent_touches_once() {
        within(
            of(UNIT, [-2.0, 1.0, 0.0], [1.0, 0.0, 0.0]),
            [2.0, 2.0],
            1e-15,
        );
        assert_eq!(of(UNIT, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]), Some([0.0, 0.0]));
        let above = 1.0 + f64::EPSILON;
        assert_eq!(of(UNIT, [-2.0, above, 0.0], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn from_a_million_away() {
        // The textbook discriminant, about 10^24 - 10^24, would be noise.
        let far = [-1e6, 0.0, 0.6];
        within(
            of(UNIT, far, [1.0, 0.0, 0.0]),
            [1e6 - 0.8, 1e6 + 0.8],
            3e-10,
        );
        // Aimed at the point (0.6, 0, 0.8) of the sphere from there.
        let hit = of(UNIT, [-1e6, 0.0, 0.8], [1e6 + 0.6, 0.0, 0.0]).unwrap();
        assert!((hit[1] - 1.0).abs() < 1e-15, "{hit:?}");
        // Both far away: as exact as beside the origin.
        let sphere = Sphere {
            centre: DVec3::splat(1e6),
            radius: 1.0,
        };
        let origin = [1e6 - 3.0, 1e6, 1e6];
        assert_eq!(of(sphere, origin, [1.0, 0.0, 0.0]), Some([2.0, 4.0]));
        // A large one seen from its surface: not a difference of large numbers.
        let earth = Sphere {
            centre: DVec3::new(0.0, 0.0, -6e6),
            radius: 6e6,
        };
        let t = of(earth, [0.0, 0.0, 2.0], [0.0, 0.0, -1.0]).unwrap()[0];
        assert!((t - 2.0).abs() < 1e-15, "{t}");
    }

    #[test]
    fn its_surface() {
        let sphere = Sphere {
            centre: DVec3::new(1.0, 2.0, 3.0),
            radius: 2.0,
        };
        let s = sphere.surface(DVec3::new(1.0, 4.1, 3.0));
        assert_eq!(s.normal, DVec3::Y);
        assert_eq!(s.point, DVec3::new(1.0, 4.0, 3.0), "moved onto the sphere");
        assert_eq!(s.uv, DVec2::new(0.25, 0.5));
        assert_eq!(sphere.surface(DVec3::new(1.0, 2.0, 9.0)).uv.y, 1.0);
        assert_eq!(sphere.support(DVec3::X * 2.0), 6.0);
    }
}
