//! The box along the axes, by the lecture's method for parallelepipeds.
//!
//! For each axis the interval between the two faces across it; then the latest entry and the earliest
//! exit. A ray that runs parallel to faces (a component of the direction is 0) is between them all the
//! time or never; one that runs in a face is inside.

use glam::{DVec2, DVec3};

use super::solid::Surface;
use super::span::Span;
use crate::trace::accel::Bounds;
use crate::trace::ray::Ray;

/// A box along the axes. Faces are numbered 0 (x least), 1 (x greatest), 2, 3 (y), 4, 5 (z).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Its extent. May be flat.
    pub bounds: Bounds,
}

impl Cuboid {
    /// Between two opposite corners.
    pub fn new(one: DVec3, other: DVec3) -> Self {
        Self {
            bounds: Bounds::around([one, other]),
        }
    }

    /// When the line is inside.
    pub fn span(&self, ray: &Ray) -> Span {
        let slab = |k: usize| {
            let part = 2 * k as u32;
            let faces = (self.bounds.min[k], self.bounds.max[k]);
            Span::slab(faces, ray.origin[k], ray.direction[k], [part, part + 1])
        };
        slab(0).common(slab(1)).common(slab(2))
    }

    /// The largest product of a point with `n`.
    pub fn support(&self, n: DVec3) -> f64 {
        let positive = n.cmpge(DVec3::ZERO);
        n.dot(DVec3::select(positive, self.bounds.max, self.bounds.min))
    }

    /// The face near `p`. u and v run from 0 to 1 along the two other axes.
    pub fn surface(&self, p: DVec3, part: u32) -> Surface {
        let axis = (part / 2) as usize;
        let high = part % 2 == 1;
        let b = &self.bounds;
        let mut point = p.clamp(b.min, b.max);
        point[axis] = if high { b.max[axis] } else { b.min[axis] };
        let mut normal = DVec3::ZERO;
        normal[axis] = if high { 1.0 } else { -1.0 };
        let along = |k: usize| {
            let length = b.max[k] - b.min[k];
            if length > 0.0 {
                (point[k] - b.min[k]) / length
            } else {
                0.0
            }
        };
        Surface {
            point,
            normal,
            uv: match axis {
                0 => DVec2::new(along(1), along(2)),
                1 => DVec2::new(along(0), along(2)),
                _ => DVec2::new(along(0), along(1)),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::cases::{ray, span, within};
    use super::*;

    fn cuboid() -> Cuboid {
        Cuboid::new(DVec3::new(3.0, 0.0, 0.0), DVec3::new(1.0, 2.0, 4.0))
    }

    fn of(c: Cuboid, origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        span(|ray| c.span(ray), origin, direction)
    }

    #[test]
    fn through_beside_inside_behind() {
        let c = cuboid();
        assert_eq!(of(c, [0.0, 1.0, 1.0], [1.0, 0.0, 0.0]), Some([1.0, 3.0]));
        // In by x = 1 at (1, 1, 1), out by y = 2 at (2, 2, 1).
        let slanted = c.span(&ray([0.0, 0.0, 1.0], [1.0, 1.0, 0.0]));
        assert_eq!((slanted.enter.t, slanted.enter.part), (1.0, 0));
        assert_eq!((slanted.exit.t, slanted.exit.part), (2.0, 3));
        assert_eq!(of(c, [0.0, 2.5, 1.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(of(c, [2.0, 1.0, 1.0], [0.0, 0.0, -2.0]), Some([-1.5, 0.5]));
        assert_eq!(of(c, [5.0, 1.0, 1.0], [1.0, 0.0, 0.0]), Some([-4.0, -2.0]));
    }

    #[test]
    fn in_a_face_along_an_edge_through_a_corner() {
        let c = cuboid();
        assert_eq!(of(c, [0.0, 2.0, 1.0], [1.0, 0.0, 0.0]), Some([1.0, 3.0]));
        assert_eq!(of(c, [0.0, 2.0, 4.0], [1.0, -0.0, 0.0]), Some([1.0, 3.0]));
        // The corner (1, 2, 4) alone.
        assert_eq!(of(c, [0.0, 1.0, 5.0], [1.0, 1.0, -1.0]), Some([1.0, 1.0]));
        let beyond = 2.0 + 2.0 * f64::EPSILON;
        assert_eq!(of(c, [0.0, beyond, 1.0], [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn flat_and_far_away() {
        let sheet = Cuboid::new(DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(
            of(sheet, [0.5, 0.5, 1.0], [0.0, 0.0, -2.0]),
            Some([0.5, 0.5])
        );
        let far = Cuboid::new(DVec3::splat(1e6), DVec3::splat(1e6 + 2.0));
        let origin = [1e6 - 1.0, 1e6 + 1.0, 1e6 + 1.0];
        assert_eq!(of(far, origin, [1.0, 0.0, 0.0]), Some([1.0, 3.0]));
        within(
            of(cuboid(), [-1e6, 1.0, 1.0], [1.0, 0.0, 0.0]),
            [1e6 + 1.0, 1e6 + 3.0],
            0.0,
        );
    }

    #[test]
    fn its_faces() {
        let c = cuboid();
        let s = c.surface(DVec3::new(3.001, 0.5, 1.0), 1);
        assert_eq!(s.point, DVec3::new(3.0, 0.5, 1.0));
        assert_eq!(s.normal, DVec3::X);
        assert_eq!(s.uv, DVec2::new(0.25, 0.25));
        assert_eq!(c.surface(DVec3::new(2.0, 1.0, 0.0), 4).normal, DVec3::NEG_Z);
        assert_eq!(c.support(DVec3::new(-1.0, 1.0, 1.0)), -1.0 + 2.0 + 4.0);
    }
}
