//! How a ray starts on a mesh.
//!
//! The triangle A that it starts on is skipped. Its origin P, however, is rounded: a neighbour B of A
//! may have it on the wrong side. Taking that for a hit where the surface bends away makes spots
//! (acne); overlooking a hit where the surface bends towards the ray lets light through a corner. A
//! small offset only exchanges the one for the other. Instead, for a ray going out of A (for one going
//! in, all sides the other way around):
//!
//! 1. The ray stays above A's plane. So a triangle that has no corner above it is not met, whatever
//!    rounding says: it is the one behind an edge that bends away, or in the same plane.
//! 2. For the same reason the ray passes B's plane above those edges of B that lie in A's plane or
//!    below: such an edge is not asked on which side the line passes. (A ray at a grazing angle sees
//!    the edge between A and a wall as part of the outline of both, and rounding may put the line
//!    beside both.)
//! 3. Where P's distance from B's plane is larger than its error, its sign is right, and tells whether
//!    B lies ahead.
//! 4. Otherwise the ray starts, as far as anybody can tell, in B's plane, and meets B at once or never:
//!    at t = 0 if it runs against B's outer side and its line passes B, or so near to it that
//!    rounding decides; never if it runs along B's normal, which leads away.
//!
//! 'Above', 'in the plane' and 'so near' mean: by more than the proven bounds below, or not. Nothing
//! depends on the mesh being closed, only on neighbours being turned the same way (`findings` tells).
//! Where a surface bends both ways at a corner, a ray that starts within rounding of it may meet it at
//! t = 0 where it should not; and edges that bend inwards by less than rounding are taken for flat.
//!
//! # The bounds
//!
//! P must be computed as [`triangle::point`] does: off A's plane by at most two roundings of each
//! coordinate, 2^-52·|P|; here 2^-50·|P| is taken, and as much for corners, which files round too.
//!
//! *Distances.* N·(P - a) with N = e × f: products of differences, each with a relative error of 3u,
//! their difference one of u, and P - a of u; three such products summed: below 9u·|e|×|f|·|P - a|,
//! where |e|×|f| is the cross product with sums of absolute values. 16u is taken.
//!
//! *Sides of edges.* A sheared corner p' is off by at most 4.1u·|p - P| and by what P is off, an edge's
//! p' × q' by the error of each times the size of the other, and by 3u of the products.

use glam::DVec3;

use crate::trace::accel::Cast;
use crate::trace::accel::cast::dominant;
use crate::trace::ray::Start;
#[cfg(doc)]
use crate::trace::shapes::triangle;
use crate::trace::shapes::triangle::{Pierced, pierce};

use super::Points;

/// A plane through a triangle, not scaled, with its error.
struct Plane {
    corner: DVec3,
    sides: [DVec3; 2],
    normal: DVec3,
    /// Absolute values instead of differences.
    largest: DVec3,
}

impl Plane {
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let (e, f) = (b - a, c - a);
        let (p, q) = (e.abs(), f.abs());
        Self {
            corner: a,
            sides: [e, f],
            normal: e.cross(f),
            largest: DVec3::new(
                p.y * q.z + p.z * q.y,
                p.z * q.x + p.x * q.z,
                p.x * q.y + p.y * q.x,
            ),
        }
    }

    /// How high a point lies, and how much that may be wrong; both times the normal's length.
    fn height(&self, p: DVec3) -> (f64, f64) {
        let from = p - self.corner;
        let error = from.abs() * 2f64.powi(-49) + p.abs() * 2f64.powi(-50);
        (self.normal.dot(from), self.largest.dot(error))
    }

    /// Weights of the second and third corner at a point of the plane, kept within the triangle.
    fn weights(&self, p: DVec3) -> [f64; 2] {
        let axis = dominant(self.normal);
        let [e, f] = self.sides;
        let from = p - self.corner;
        let v = (from.cross(f)[axis] / self.normal[axis]).clamp(0.0, 1.0);
        let w = (e.cross(from)[axis] / self.normal[axis]).clamp(0.0, 1.0 - v);
        [v, w]
    }
}

/// A ray that starts on a triangle of a mesh.
pub(super) struct Leaving {
    /// The triangle.
    pub part: u32,
    /// Its plane.
    own: Plane,
    /// 1 for a ray going out, -1 for one going in.
    sign: f64,
}

impl Leaving {
    pub fn new(points: &Points, start: &Start) -> Self {
        Self {
            part: start.part,
            own: Plane::new(points.corners(start.part)),
            sign: if start.inwards { -1.0 } else { 1.0 },
        }
    }

    /// How the ray meets another triangle of the mesh.
    pub fn meet(&self, cast: &Cast, corners: [DVec3; 3]) -> Option<Pierced> {
        let pierced = pierce(cast, corners);
        let outline = Outline::new(cast, corners);
        if pierced.is_none() && outline.is_beside() {
            return None;
        }
        let above = corners.map(|p| {
            let (height, error) = self.own.height(p);
            height * self.sign > error
        });
        if above == [false; 3] {
            return None;
        }
        let other = Plane::new(corners);
        let (height, error) = other.height(cast.ray.origin);
        let speed = other.normal.dot(cast.ray.direction);
        let faces = speed * self.sign < 0.0;
        let here = height.abs() <= error;
        let ahead = if here {
            faces
        } else {
            (height > 0.0) == (speed < 0.0)
        };
        if !ahead || speed == 0.0 {
            return None;
        }
        // Where the t of piercing is small, rounding may have made it negative.
        let t = if here { 0.0 } else { -height / speed };
        if let Some(pierced) = pierced {
            return Some(Pierced {
                t: if pierced.t > 0.0 { pierced.t } else { t },
                ..pierced
            });
        }
        // Edge i is opposite to corner i.
        let in_plane = |i: usize| !above[(i + 1) % 3] && !above[(i + 2) % 3];
        let passes = (0..3).all(|i| {
            let inside = outline.products[i] * self.sign * outline.turn;
            inside >= 0.0 || -inside <= outline.errors[i] && (here || in_plane(i))
        });
        (faces && passes).then(|| Pierced {
            t,
            weights: other.weights(cast.ray.at(t)),
        })
    }
}

/// The edges of a triangle as the ray sees them, edge i being opposite to corner i.
struct Outline {
    /// Their signs tell on which sides the line passes: none negative, or none positive, inside.
    products: [f64; 3],
    errors: [f64; 3],
    /// Times this, positive is inside where the ray runs against the outer side.
    turn: f64,
}

impl Outline {
    fn new(cast: &Cast, corners: [DVec3; 3]) -> Self {
        let origin = cast.ray.origin;
        let rounded = origin.abs().max_element();
        // In the plan: the corner, its error, and its size.
        let seen = corners.map(|p| {
            let from = p - origin;
            let flat = cast.shear.apply(from);
            let off = (from.abs().max_element() * 2.0 + rounded) * 2f64.powi(-50);
            (flat, off, flat.x.abs() + flat.y.abs())
        });
        let edge = |i: usize| (&seen[(i + 1) % 3], &seen[(i + 2) % 3]);
        let product = |i: usize| {
            let ((p, ..), (q, ..)) = edge(i);
            p.x * q.y - p.y * q.x
        };
        let error = |i: usize| {
            let ((_, off_p, size_p), (_, off_q, size_q)) = edge(i);
            off_p * size_q + off_q * size_p
        };
        Self {
            products: [product(0), product(1), product(2)],
            errors: [error(0), error(1), error(2)],
            turn: if cast.shear.is_turned() { 1.0 } else { -1.0 },
        }
    }

    /// Whether the line passes beside the triangle, however it is rounded.
    fn is_beside(&self) -> bool {
        let any = |sign: f64| (0..3).any(|i| self.products[i] * sign > self.errors[i]);
        any(1.0) && any(-1.0)
    }
}
