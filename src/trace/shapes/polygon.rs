//! The plane polygon, convex or not.
//!
//! In two steps, as in the lecture: the ray meets the plane N·P + d = 0 at t = -(d + N·O) / N·D (the
//! slide on Snyder's method has d - N·O, which is wrong by the sign that it gives d); then one of two
//! methods says whether that point is inside, and how the corners' normals and texture coordinates are
//! mixed there: [`barycentric`] or [`marchal`]. Both count the border as inside, but rounding may let
//! them differ there.
//!
//! A simple polygon is enough: barycentric coordinates work on triangles, the fan about the first
//! corner where the polygon is convex, otherwise ears cut off one by one, with exact orientations.

pub mod barycentric;
pub mod marchal;
mod outline;

use std::fmt;

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::solid::Surface;
use crate::trace::accel::{Bounds, Cast, cast::dominant};

/// How it is decided whether a point is inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Snyder's: barycentric coordinates in triangles.
    #[default]
    Barycentric,
    /// Marchal's: the edge that the line from the first corner through the point meets.
    Marchal,
}

/// Corners of a polygon with their weights, which add up to 1.
pub type Weights = SmallVec<[(u32, f64); 4]>;

/// A plane polygon, seen from both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    corners: Vec<DVec3>,
    /// Unit normal, on the side from which the corners go around counterclockwise.
    normal: DVec3,
    /// A point of the plane.
    origin: DVec3,
    /// The farthest that a corner lies beside the plane.
    beside: f64,
    /// The axis that is dropped, the normal's dominant one, and the others.
    axes: [usize; 3],
    /// The corners without that axis, relative to the first.
    flat: Vec<DVec2>,
    triangles: Vec<[u32; 3]>,
    /// How it is decided whether a point is inside.
    pub method: Method,
    normals: Option<Vec<DVec3>>,
    uv: Option<Vec<DVec2>>,
}

/// Why corners make no polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PolygonError {
    /// Fewer than three corners.
    TooFew,
    /// The coordinates of this corner are not finite.
    NotFinite(usize),
    /// This corner and the next are the same point.
    Repeated(usize),
    /// The corners lie on one line.
    NoArea,
    /// A corner lies that far beside the plane of the others.
    NotPlane(f64),
    /// The edges that begin at these two corners meet.
    Crossing(usize, usize),
    /// So many normals or texture coordinates for that many corners.
    Count(usize, usize),
}

impl fmt::Display for PolygonError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooFew => f.write_str("a polygon needs three corners"),
            Self::NotFinite(i) => write!(f, "corner {i} is not finite"),
            Self::Repeated(i) => write!(f, "corner {i} and the next are the same point"),
            Self::NoArea => f.write_str("the corners lie on one line"),
            Self::NotPlane(by) => write!(f, "a corner lies {by} beside the plane of the others"),
            Self::Crossing(i, j) => write!(f, "the edges from corners {i} and {j} meet"),
            Self::Count(given, corners) => {
                write!(
                    f,
                    "{given} normals or texture coordinates, {corners} corners"
                )
            }
        }
    }
}

impl std::error::Error for PolygonError {}

/// How far beside the plane a corner may lie, as a part of the polygon's size: what single precision
/// loses.
const FLATNESS: f64 = 1.0 / (1 << 20) as f64;

impl Polygon {
    /// From its corners, in order.
    pub fn new(corners: Vec<DVec3>) -> Result<Self, PolygonError> {
        let n = corners.len();
        if n < 3 {
            return Err(PolygonError::TooFew);
        }
        if let Some(i) = corners.iter().position(|p| !p.is_finite()) {
            return Err(PolygonError::NotFinite(i));
        }
        if let Some(i) = (0..n).find(|&i| corners[i] == corners[(i + 1) % n]) {
            return Err(PolygonError::Repeated(i));
        }
        let normal = newell(&corners).ok_or(PolygonError::NoArea)?;
        let origin = corners[0];
        let size = Bounds::around(corners.iter().copied()).size().length();
        let beside = corners
            .iter()
            .map(|&p| normal.dot(p - origin).abs())
            .fold(0.0, f64::max);
        if beside > size * FLATNESS {
            return Err(PolygonError::NotPlane(beside));
        }
        let axis = dominant(normal);
        let axes = [axis, (axis + 1) % 3, (axis + 2) % 3];
        let flat: Vec<DVec2> = corners.iter().map(|p| flatten(p - origin, axes)).collect();
        if let Some((i, j)) = outline::crossing(&flat) {
            return Err(PolygonError::Crossing(i, j));
        }
        let triangles =
            outline::triangles(&flat, normal[axis] > 0.0).ok_or(PolygonError::NoArea)?;
        Ok(Self {
            corners,
            normal,
            origin,
            beside,
            axes,
            flat,
            triangles,
            method: Method::default(),
            normals: None,
            uv: None,
        })
    }

    /// With normals at the corners, to be interpolated.
    pub fn with_normals(mut self, normals: Vec<DVec3>) -> Result<Self, PolygonError> {
        self.count(normals.len())?;
        self.normals = Some(normals);
        Ok(self)
    }

    /// With texture coordinates at the corners. Without, they are lengths along the first edge and
    /// across it.
    pub fn with_uv(mut self, uv: Vec<DVec2>) -> Result<Self, PolygonError> {
        self.count(uv.len())?;
        self.uv = Some(uv);
        Ok(self)
    }

    fn count(&self, given: usize) -> Result<(), PolygonError> {
        if given == self.corners.len() {
            Ok(())
        } else {
            Err(PolygonError::Count(given, self.corners.len()))
        }
    }

    /// Its corners.
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// Triangles that make it up: three corners each, going around as it does.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Its unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The box around it, and around the part of its plane that stands for it.
    pub fn bounds(&self) -> Bounds {
        let around = Bounds::around(self.corners.iter().copied());
        around.grown(self.beside).rounded_out()
    }

    /// When the line of the ray is in the polygon; maybe before its origin.
    pub fn pierce(&self, cast: &Cast) -> Option<f64> {
        let speed = self.normal.dot(cast.ray.direction);
        if speed == 0.0 {
            return None;
        }
        let t = self.normal.dot(self.origin - cast.ray.origin) / speed;
        self.weights(cast.ray.at(t)).map(|_| t)
    }

    /// The weights of the corners at a point of the plane; none outside.
    pub fn weights(&self, p: DVec3) -> Option<Weights> {
        let flat = flatten(p - self.origin, self.axes);
        match self.method {
            Method::Barycentric => barycentric::weights(&self.flat, &self.triangles, flat),
            Method::Marchal => marchal::weights(&self.flat, flat),
        }
    }

    fn nearest_corner(&self, p: DVec3) -> Weights {
        let square = |&i: &usize| self.corners[i].distance_squared(p);
        let nearest = (0..self.corners.len()).min_by(|a, b| square(a).total_cmp(&square(b)));
        nearest.map(|i| (i as u32, 1.0)).into_iter().collect()
    }

    /// The surface near `p`, and the interpolated normal.
    pub fn surface(&self, p: DVec3) -> (Surface, DVec3) {
        let point = p - self.normal * self.normal.dot(p - self.origin);
        // Rounding may have moved a point of the border out.
        let weights = self
            .weights(p)
            .or_else(|| self.weights(point))
            .unwrap_or_else(|| self.nearest_corner(point));
        let uv = match &self.uv {
            Some(uv) => weights.iter().map(|&(i, w)| uv[i as usize] * w).sum(),
            None => {
                let along = (self.corners[1] - self.origin).normalize_or(DVec3::X);
                let across = self.normal.cross(along);
                DVec2::new(
                    along.dot(point - self.origin),
                    across.dot(point - self.origin),
                )
            }
        };
        let mixed = self.normals.as_ref().map_or(self.normal, |normals| {
            weights.iter().map(|&(i, w)| normals[i as usize] * w).sum()
        });
        let surface = Surface {
            point,
            normal: self.normal,
            uv,
        };
        (surface, mixed)
    }
}

/// A point without the dropped axis.
fn flatten(p: DVec3, axes: [usize; 3]) -> DVec2 {
    DVec2::new(p[axes[1]], p[axes[2]])
}

/// The unit normal by Newell's method: each component is the area of a projection.
fn newell(corners: &[DVec3]) -> Option<DVec3> {
    let origin = corners[0];
    let sum: DVec3 = corners
        .windows(2)
        .map(|w| (w[0] - origin).cross(w[1] - origin))
        .sum();
    (sum / sum.abs().max_element()).try_normalize()
}

/// The cross product of the plan.
#[inline]
fn cross(a: DVec2, b: DVec2) -> f64 {
    a.x * b.y - a.y * b.x
}

#[cfg(test)]
mod tests;
