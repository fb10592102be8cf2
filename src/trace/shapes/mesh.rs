//! The triangle mesh.
//!
//! In: corners and triangles, or the text of an OBJ file ([`obj`]). Out: one primitive, with a
//! structure of its own over the triangles ([`crate::trace::accel`]), so that a mesh may stand among
//! other objects. Rays pass no shared edge ([`super::triangle`]); how a ray starts on a mesh:
//! [`start`].

pub mod findings;
pub mod obj;
pub mod start;

use std::fmt;

use glam::{DVec2, DVec3};

use start::Leaving;

use super::Hit;
use super::placement::Placement;
use super::triangle::{self, pierce};
use crate::trace::accel::{Bounds, Cast, Contact, Count, Found, Kind, Primitives, Structure, Want};
use crate::trace::ray::Start;

/// Points with triangles between them, seen from both sides. Which side is out is told by the order
/// of the corners: counterclockwise, seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Where they are.
    pub places: Vec<DVec3>,
    /// Three points each.
    pub triangles: Vec<[u32; 3]>,
    /// A normal for each point, to be interpolated; or none at all.
    pub normals: Vec<DVec3>,
    /// Texture coordinates of each point; or none at all.
    pub uv: Vec<DVec2>,
}

/// A mesh with its structure.
#[derive(Clone, Debug)]
pub struct Mesh {
    points: Points,
    structure: Structure,
}

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MeshError {
    /// The OBJ text cannot be read.
    Obj(String),
    /// There is no triangle.
    Empty,
    /// The coordinates of this point are not finite.
    NotFinite(usize),
    /// This triangle names a point that there is not.
    NoSuchPoint(usize),
    /// So many normals or texture coordinates for that many points.
    Count(usize, usize),
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Obj(why) => write!(f, "the OBJ text cannot be read: {why}"),
            Self::Empty => f.write_str("there is no triangle in the mesh"),
            Self::NotFinite(i) => write!(f, "point {i} is not finite"),
            Self::NoSuchPoint(i) => write!(f, "triangle {i} names a point that does not exist"),
            Self::Count(given, points) => {
                write!(f, "{given} normals or texture coordinates, {points} points")
            }
        }
    }
}

impl std::error::Error for MeshError {}

impl Mesh {
    /// From points, with a structure of that kind.
    pub fn new(points: Points, kind: Kind) -> Result<Self, MeshError> {
        let n = points.places.len();
        if points.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        let finite = |p: &DVec3| p.is_finite();
        if let Some(i) = points.places.iter().position(|p| !finite(p)) {
            return Err(MeshError::NotFinite(i));
        }
        let outside = |t: &[u32; 3]| t.iter().any(|&i| i as usize >= n);
        if let Some(i) = points.triangles.iter().position(outside) {
            return Err(MeshError::NoSuchPoint(i));
        }
        for given in [points.normals.len(), points.uv.len()] {
            if given != 0 && given != n {
                return Err(MeshError::Count(given, n));
            }
        }
        let all = Triangles {
            points: &points,
            from: None,
        };
        let structure = Structure::new(kind, &all);
        Ok(Self { points, structure })
    }

    /// The same mesh elsewhere.
    pub fn placed(&self, placement: &Placement, kind: Kind) -> Result<Self, MeshError> {
        let mut points = self.points.clone();
        for place in &mut points.places {
            *place = placement.point(*place);
        }
        for normal in &mut points.normals {
            *normal = placement.normal(*normal);
        }
        if placement.mirrors() {
            for triangle in &mut points.triangles {
                triangle.swap(1, 2);
            }
        }
        Self::new(points, kind)
    }

    /// What it is made of.
    pub fn points(&self) -> &Points {
        &self.points
    }

    /// The structure over its triangles.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// Checks the structure.
    pub fn validate(&self) -> Result<(), String> {
        self.structure.validate(&self.triangles(None))
    }

    /// The box around it.
    pub fn bounds(&self) -> Bounds {
        *self.structure.bounds()
    }

    fn triangles(&self, from: Option<&Start>) -> Triangles<'_> {
        Triangles {
            points: &self.points,
            from: from.map(|start| Leaving::new(&self.points, start)),
        }
    }

    /// The first contact, or any before the limit.
    pub fn contact<C: Count>(
        &self,
        cast: &Cast,
        from: Option<&Start>,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact> {
        let all = self.triangles(from);
        let found = match want {
            Want::Nearest => self.structure.nearest(&all, cast, None, limit, count),
            Want::Any => self.structure.any(&all, cast, None, limit, count),
        };
        let Found { primitive, contact } = found?;
        Some(Contact {
            part: primitive,
            ..contact
        })
    }

    /// What the mesh is like where the ray met it.
    pub fn hit(&self, contact: &Contact) -> Hit {
        let triangle = self.points.triangles[contact.part as usize];
        let corners = self.points.corners(contact.part);
        let [v, w] = contact.weights;
        let weights = [1.0 - v - w, v, w];
        let normal = triangle::normal(corners);
        let mixed = if self.points.normals.is_empty() {
            normal
        } else {
            let at = |k: usize| self.points.normals[triangle[k] as usize] * weights[k];
            at(0) + at(1) + at(2)
        };
        let uv = if self.points.uv.is_empty() {
            DVec2::new(v, w)
        } else {
            let at = |k: usize| self.points.uv[triangle[k] as usize] * weights[k];
            at(0) + at(1) + at(2)
        };
        Hit::new(
            contact,
            triangle::point(corners, [v, w]),
            (normal, mixed),
            uv,
        )
    }
}

impl Points {
    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|i| self.places[i as usize])
    }
}

/// The triangles as primitives, for a ray that starts on one of them or elsewhere.
struct Triangles<'a> {
    points: &'a Points,
    from: Option<Leaving>,
}

impl Primitives for Triangles<'_> {
    fn len(&self) -> usize {
        self.points.triangles.len()
    }

    #[inline]
    fn bounds(&self, triangle: u32) -> Bounds {
        let [a, b, c] = self.points.corners(triangle);
        Bounds {
            min: a.min(b).min(c),
            max: a.max(b).max(c),
        }
    }

    #[inline]
    fn contact<C: Count>(
        &self,
        triangle: u32,
        cast: &Cast,
        _: Option<&Start>,
        _: Want,
        _: f64,
        _: &mut C,
    ) -> Option<Contact> {
        let corners = self.points.corners(triangle);
        let met = match &self.from {
            None => pierce(cast, corners).filter(|p| p.t > 0.0)?,
            Some(leaving) if leaving.part == triangle => return None,
            Some(leaving) => leaving.meet(cast, corners)?,
        };
        Some(Contact {
            t: met.t,
            part: triangle,
            weights: met.weights,
        })
    }
}

#[cfg(test)]
mod tests;
