//! Any of the convex solids.

use glam::{DVec2, DVec3};

use super::cone::Cone;
use super::cuboid::Cuboid;
use super::cylinder::Cylinder;
use super::polyhedron::Polyhedron;
use super::span::Span;
use super::sphere::Sphere;
use crate::trace::accel::Bounds;
use crate::trace::ray::Ray;

/// A convex solid.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid {
    /// See [`Sphere`].
    Sphere(Sphere),
    /// See [`Cuboid`].
    Cuboid(Cuboid),
    /// See [`Polyhedron`].
    Polyhedron(Polyhedron),
    /// See [`Cylinder`].
    Cylinder(Cylinder),
    /// See [`Cone`].
    Cone(Cone),
}

/// What a surface is like at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, moved onto the surface.
    pub point: DVec3,
    /// Of unit length, pointing out.
    pub normal: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
}

impl Solid {
    /// When the line is inside.
    #[inline]
    pub fn span(&self, ray: &Ray) -> Span {
        match self {
            Self::Sphere(s) => s.span(ray),
            Self::Cuboid(s) => s.span(ray),
            Self::Polyhedron(s) => s.span(ray),
            Self::Cylinder(s) => s.span(ray),
            Self::Cone(s) => s.span(ray),
        }
    }

    /// The surface of a face near `p`.
    pub fn surface(&self, p: DVec3, part: u32) -> Surface {
        match self {
            Self::Sphere(s) => s.surface(p),
            Self::Cuboid(s) => s.surface(p, part),
            Self::Polyhedron(s) => s.surface(p, part),
            Self::Cylinder(s) => s.surface(p, part),
            Self::Cone(s) => s.surface(p, part),
        }
    }

    /// The largest product of one of its points with `n`: how far it reaches in that direction.
    pub fn support(&self, n: DVec3) -> f64 {
        match self {
            Self::Sphere(s) => s.support(n),
            Self::Cuboid(s) => s.support(n),
            Self::Polyhedron(s) => s.support(n),
            Self::Cylinder(s) => s.support(n),
            Self::Cone(s) => s.support(n),
        }
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Cuboid(cuboid) => cuboid.bounds,
            _ => supported(|n| self.support(n)),
        }
    }
}

/// The box around something convex whose support is known.
pub(super) fn supported(support: impl Fn(DVec3) -> f64) -> Bounds {
    let along = |sign: f64| {
        let reach = |axis: DVec3| sign * support(axis * sign);
        DVec3::new(reach(DVec3::X), reach(DVec3::Y), reach(DVec3::Z))
    };
    Bounds {
        min: along(-1.0),
        max: along(1.0),
    }
    .rounded_out()
}
