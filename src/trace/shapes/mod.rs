//! The shapes of the lecture, and how a ray meets them.
//!
//! In: a ray. Out: a [`Contact`], as little as it takes to find the nearest of many; from it later a
//! [`Hit`], with point, normals and texture coordinates.
//!
//! | file | shape | method |
//! |---|---|---|
//! | [`sphere`] | sphere | nearest point to the centre, half a chord before and after |
//! | [`cuboid`] | box along the axes | slabs |
//! | [`polyhedron`] | convex polyhedron | slabs with any normals |
//! | [`cylinder`], [`cone`] | about the z axis | infinite solid and two planes |
//! | [`placement`] | any of these, scaled, turned, moved | the ray is mapped instead |
//! | [`polygon`] | plane polygon | Snyder's or Marchal's |
//! | [`triangle`] | triangle | sheared plan (Woop), watertight |
//! | [`mesh`] | triangle mesh | a structure of its own |
//!
//! # Rays that start on a surface
//!
//! No offset is used. A ray that comes from a hit starts at [`Hit::point`], which lies on the surface to
//! within a few roundings however far the ray before had come, and says by [`Hit::start`] what it
//! starts on. A convex solid is then skipped or left by its far side ([`span`]); a triangle or polygon is
//! skipped; for meshes see [`mesh::start`].

pub mod cone;
pub mod cuboid;
pub mod cylinder;
pub mod mesh;
pub mod objects;
pub mod placement;
pub mod polygon;
pub mod polyhedron;
pub mod solid;
pub mod span;
pub mod sphere;
pub mod triangle;

#[cfg(test)]
mod cases;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::{DVec2, DVec3};

pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use mesh::Mesh;
pub use objects::Objects;
pub use placement::{Placed, Placement};
pub use polygon::Polygon;
pub use polyhedron::{Polyhedron, Slab};
pub use solid::Solid;
pub use sphere::Sphere;
pub use triangle::Triangle;

use super::accel::{Bounds, Cast, Contact, Count, Want};
use super::ray::{Ray, Start};

/// Any shape.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A convex solid where it stands.
    Solid(Solid),
    /// A convex solid placed somewhere.
    Placed(Box<Placed>),
    /// A plane polygon.
    Polygon(Box<Polygon>),
    /// A triangle.
    Triangle(Box<Triangle>),
    /// A triangle mesh; several objects may share it.
    Mesh(Arc<Mesh>),
}

/// What a shape is like where a ray met it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// When.
    pub t: f64,
    /// The point, on the surface to within rounding. The next ray starts here.
    pub point: DVec3,
    /// Geometric unit normal, pointing out; of plane shapes to where the corners go around
    /// counterclockwise.
    pub normal: DVec3,
    /// Unit normal for shading: interpolated where the shape has normals, and on the same side.
    pub shading: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
    /// The face of a solid, the triangle of a mesh.
    pub part: u32,
}

impl Hit {
    /// `normals`: the geometric one, and the interpolated one, of any length.
    fn new(contact: &Contact, point: DVec3, (normal, mixed): (DVec3, DVec3), uv: DVec2) -> Self {
        let mixed = mixed.normalize_or(normal);
        Self {
            t: contact.t,
            point,
            normal,
            shading: if mixed.dot(normal) < 0.0 {
                -mixed
            } else {
                mixed
            },
            uv,
            part: contact.part,
        }
    }

    /// How a ray starts here into `direction`; `primitive` is the number of the shape.
    pub fn start(&self, primitive: u32, direction: DVec3) -> Start {
        Start {
            primitive,
            part: self.part,
            inwards: self.normal.dot(direction) < 0.0,
        }
    }
}

impl Shape {
    /// A finite box around the shape.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Solid(s) => s.bounds(),
            Self::Placed(s) => s.bounds(),
            Self::Polygon(s) => s.bounds(),
            Self::Triangle(s) => s.bounds(),
            Self::Mesh(s) => s.bounds(),
        }
    }

    /// Where the ray meets the shape first, at t > 0 (or at 0, for a ray that starts on it in a
    /// corner). Contacts later than `limit` may be left out.
    pub fn contact<C: Count>(
        &self,
        cast: &Cast,
        from: Option<&Start>,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact> {
        let plane = |t: f64, weights: [f64; 2]| {
            (t > 0.0).then_some(Contact {
                t,
                part: 0,
                weights,
            })
        };
        match self {
            Self::Solid(s) => s.span(&cast.ray).contact(from),
            Self::Placed(s) => s.span(&cast.ray).contact(from),
            Self::Polygon(_) | Self::Triangle(_) if from.is_some() => None,
            Self::Polygon(s) => s.pierce(cast).and_then(|t| plane(t, [0.0; 2])),
            Self::Triangle(s) => s.pierce(cast).and_then(|p| plane(p.t, p.weights)),
            Self::Mesh(s) => s.contact(cast, from, want, limit, count),
        }
    }

    /// What the shape is like where the ray met it.
    pub fn hit(&self, ray: &Ray, contact: &Contact) -> Hit {
        let solid = |s: solid::Surface| Hit::new(contact, s.point, (s.normal, s.normal), s.uv);
        match self {
            Self::Solid(s) => solid(s.surface(ray.at(contact.t), contact.part)),
            Self::Placed(s) => solid(s.surface(ray, contact.t, contact.part)),
            Self::Polygon(s) => {
                let (surface, mixed) = s.surface(ray.at(contact.t));
                Hit::new(contact, surface.point, (surface.normal, mixed), surface.uv)
            }
            Self::Triangle(s) => s.hit(contact),
            Self::Mesh(s) => s.hit(contact),
        }
    }
}

impl From<Solid> for Shape {
    fn from(solid: Solid) -> Self {
        Self::Solid(solid)
    }
}

impl From<Placed> for Shape {
    fn from(placed: Placed) -> Self {
        Self::Placed(Box::new(placed))
    }
}

impl From<Polygon> for Shape {
    fn from(polygon: Polygon) -> Self {
        Self::Polygon(Box::new(polygon))
    }
}

impl From<Triangle> for Shape {
    fn from(triangle: Triangle) -> Self {
        Self::Triangle(Box::new(triangle))
    }
}

impl From<Mesh> for Shape {
    fn from(mesh: Mesh) -> Self {
        Self::Mesh(Arc::new(mesh))
    }
}
