//! Solids anywhere: scaled, turned and moved.
//!
//! A ray is mapped into the solid's own coordinates, origin and direction alike, and its direction is
//! not made a unit vector: so t stays the same. Normals are mapped back by the inverse transpose. The
//! origin is mapped as a difference from the placement's own, which is exact where both are far from
//! the origin of coordinates and near to each other.

use glam::{DMat3, DQuat, DVec3};

use super::solid::{Solid, Surface, supported};
use super::span::Span;
use crate::trace::accel::Bounds;
use crate::trace::ray::Ray;

/// An invertible linear map, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    linear: DMat3,
    inverse: DMat3,
    origin: DVec3,
}

impl Placement {
    /// Scales along the axes, turns, then moves. None if a scale is 0 or not finite.
    pub fn new(scale: DVec3, turn: DQuat, origin: DVec3) -> Option<Self> {
        Self::linear(DMat3::from_quat(turn) * DMat3::from_diagonal(scale), origin)
    }

    /// Any linear map, then a translation. None if it has no inverse.
    pub fn linear(linear: DMat3, origin: DVec3) -> Option<Self> {
        let inverse = linear.inverse();
        let good = linear.is_finite() && inverse.is_finite() && origin.is_finite();
        (good && linear.determinant() != 0.0).then_some(Self {
            linear,
            inverse,
            origin,
        })
    }

    /// The ray in the solid's coordinates, with the same t.
    #[inline]
    pub fn inward(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.inverse * (ray.origin - self.origin),
            direction: self.inverse * ray.direction,
        }
    }

    /// A point of the solid's coordinates in the world.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.origin
    }

    /// A normal of the solid's coordinates in the world, of unit length.
    pub fn normal(&self, n: DVec3) -> DVec3 {
        (self.inverse.transpose() * n).normalize_or(DVec3::Z)
    }

    /// Whether it mirrors: what went around counterclockwise then goes clockwise.
    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

/// A solid somewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The solid, in its own coordinates.
    pub solid: Solid,
    /// Where it is.
    pub placement: Placement,
}

impl Placed {
    /// When the line is inside.
    pub fn span(&self, ray: &Ray) -> Span {
        self.solid.span(&self.placement.inward(ray))
    }

    /// The surface of a face near the ray's point at `t`.
    pub fn surface(&self, ray: &Ray, t: f64, part: u32) -> Surface {
        let own = self.solid.surface(self.placement.inward(ray).at(t), part);
        Surface {
            point: self.placement.point(own.point),
            normal: self.placement.normal(own.normal),
            uv: own.uv,
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        let p = &self.placement;
        supported(|n| self.solid.support(p.linear.transpose() * n) + n.dot(p.origin))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::super::cases::{ray, within};
    use super::super::cone::Cone;
    use super::super::cylinder::Cylinder;
    use super::super::sphere::Sphere;
    use super::*;

    fn place(scale: [f64; 3], turn: DQuat, origin: [f64; 3]) -> Placement {
        Placement::new(scale.into(), turn, origin.into()).unwrap()
    }

    fn ends(placed: &Placed, origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        let s = placed.span(&ray(origin, direction));
        (!s.is_empty()).then_some([s.enter.t, s.exit.t])
    }

    #[test]
    fn an_ellipsoid() {
        let placed = Placed {
            solid: Solid::Sphere(Sphere {
                centre: DVec3::ZERO,
                radius: 1.0,
            }),
            placement: place([2.0, 1.0, 4.0], DQuat::IDENTITY, [10.0, 0.0, 0.0]),
        };
        within(ends(&placed, [0.0; 3], [1.0, 0.0, 0.0]), [8.0, 12.0], 1e-14);
        within(
            ends(&placed, [10.0, 0.0, 9.0], [0.0, 0.0, -5.0]),
            [1.0, 2.6],
            1e-14,
        );
        // x²/4 + y² = 1 at (√2, √½): the gradient is (√2/2, 2√½), that is (1, 2).
        let hit = ray([10.0 + 2f64.sqrt(), 5.0, 0.0], [0.0, -1.0, 0.0]);
        let s = placed.surface(&hit, 5.0 - 0.5f64.sqrt(), 0);
        assert!((s.normal - DVec3::new(1.0, 2.0, 0.0).normalize()).length() < 1e-14);
        let b = placed.bounds();
        assert!(
            (b.min - DVec3::new(8.0, -1.0, -4.0)).length() < 1e-13,
            "{b:?}"
        );
        assert!((b.max - DVec3::new(12.0, 1.0, 4.0)).length() < 1e-13);
    }

    #[test]
    fn a_lying_cylinder_and_a_turned_cone() {
        // The z axis turned onto x.
        let lying = place([1.0; 3], DQuat::from_rotation_y(FRAC_PI_2), [0.0, 0.0, 5.0]);
        let placed = Placed {
            solid: Solid::Cylinder(Cylinder {
                radius: 1.0,
                height: 8.0,
            }),
            placement: lying,
        };
        within(
            ends(&placed, [4.0, 0.0, 0.0], [0.0, 0.0, 2.0]),
            [2.0, 3.0],
            1e-14,
        );
        within(
            ends(&placed, [-2.0, 0.0, 5.0], [1.0, 0.0, 0.0]),
            [2.0, 10.0],
            1e-14,
        );
        let s = placed.surface(&ray([4.0, 0.0, 0.0], [0.0, 0.0, 2.0]), 2.0, 0);
        assert!((s.normal - DVec3::NEG_Z).length() < 1e-15);
        // Half a right angle: of the cone of 45° one line of the side stands upright.
        let placed = Placed {
            solid: Solid::Cone(Cone {
                radius: 2.0,
                height: 2.0,
            }),
            placement: place([1.0; 3], DQuat::from_rotation_y(FRAC_PI_4), [0.0; 3]),
        };
        // At z = 1 it reaches from the upright line at x = 0 to the base x + z = 2√2.
        within(
            ends(&placed, [-3.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            [3.0, 2.0 + 2.0 * 2f64.sqrt()],
            1e-14,
        );
    }

    #[test]
    fn far_from_the_origin_as_exact_as_near() {
        let turn = DQuat::from_rotation_z(0.3);
        let solid = Solid::Cylinder(Cylinder {
            radius: 1.0,
            height: 1.0,
        });
        let at = |origin: [f64; 3]| Placed {
            solid: solid.clone(),
            placement: place([1.0, 2.0, 1.0], turn, origin),
        };
        let (near, far) = (at([0.0; 3]), at([1e6, -1e6, 1e6]));
        let direction = [1.0, 0.25, 0.125];
        let one = ends(&near, [-4.0, -1.0, 0.0], direction).unwrap();
        let two = ends(&far, [1e6 - 4.0, -1e6 - 1.0, 1e6], direction).unwrap();
        assert_eq!(one, two);
    }

    #[test]
    fn what_is_no_placement() {
        let new = |x| Placement::new(DVec3::new(x, 1.0, 1.0), DQuat::IDENTITY, DVec3::ZERO);
        assert!(new(0.0).is_none() && new(f64::NAN).is_none() && new(f64::INFINITY).is_none());
        assert!(new(-1.0).unwrap().mirrors() && !new(1.0).unwrap().mirrors());
        // A mirrored normal still points out.
        assert_eq!(new(-2.0).unwrap().normal(DVec3::X), DVec3::NEG_X);
    }
}
