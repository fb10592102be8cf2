//! How a ray starts on a mesh.
//!
//! The triangle A that it starts on is skipped. Its origin, however, is rounded: a neighbour B of A
//! may have it on the wrong side. Taking that for a hit where the surface bends away makes spots
//! (acne); overlooking a hit where the surface bends towards the ray lets light through a corner. A
//! small offset only exchanges the one for the other. Instead:
//!
//! 1. Where the origin's distance from B's plane is larger than a proven bound on its error, its sign
//!    is right, and so is that of t. Nothing special is done.
//! 2. Otherwise the ray starts, as far as anybody can tell, in B's plane, and meets it at once or
//!    never. Going out of A it stays strictly above A's plane: if no corner of B lies above A's plane
//!    (an exact predicate), B is not met. This is the edge that bends away, and the edge between
//!    triangles in one plane.
//! 3. Else B rises above A, and is met, at t = 0 if t came out negative, if the ray runs against B's
//!    outer side; running along its normal it moves away. (For a ray going in, all sides the other
//!    way around.)
//!
//! That needs the orientation of neighbours to agree (`findings` tells), but no closed mesh. Rule 3 is
//! exact for triangles that share an edge. What remains: a ray in a sharp inner corner, with its
//! origin within rounding of the edge, and at a grazing angle to B so small that the rounded origin
//! lies beside B altogether.
//!
//! # The bound
//!
//! The origin must be a point computed as [`super::super::triangle::point`] does: off A's plane by at
//! most two roundings of each coordinate, 2^-52·|P|; here it is taken as 2^-50·|P|. The distance itself
//! is N·(P - a) with N = e × f: products of differences, each with a relative error of 3u, their
//! difference one of u, and P - a of u; three such products summed: below 9u·|e|×|f|·|P - a|, where
//! |e|×|f| is the cross product with sums of absolute values. 16u is taken.

use glam::DVec3;
use robust::{Coord3D, orient3d};

use crate::trace::ray::Ray;

/// When a ray that starts on triangle `own` meets another of the same mesh, which its line pierces at
/// `t`; none if it does not.
pub(super) fn time(
    ray: &Ray,
    inwards: bool,
    own: [DVec3; 3],
    other: [DVec3; 3],
    t: f64,
) -> Option<f64> {
    let [a, b, c] = other;
    let (e, f) = (b - a, c - a);
    let normal = e.cross(f);
    let from = ray.origin - a;
    if normal.dot(from).abs() > bound(e, f, from, ray.origin) {
        return (t > 0.0).then_some(t);
    }
    let against = normal.dot(ray.direction) < 0.0;
    let along = normal.dot(ray.direction) > 0.0;
    let faces = if inwards { along } else { against };
    (faces && rises(own, other, inwards)).then_some(t.max(0.0))
}

/// Largest error of the other normal's product with the origin.
fn bound(e: DVec3, f: DVec3, from: DVec3, origin: DVec3) -> f64 {
    let (e, f) = (e.abs(), f.abs());
    let normal = DVec3::new(
        e.y * f.z + e.z * f.y,
        e.z * f.x + e.x * f.z,
        e.x * f.y + e.y * f.x,
    );
    normal.dot(from.abs() * 2f64.powi(-49) + origin.abs() * 2f64.powi(-50))
}

/// Whether a corner of `other` lies strictly above the plane of `own`; below it, for `inwards`.
fn rises(own: [DVec3; 3], other: [DVec3; 3], inwards: bool) -> bool {
    let coord = |p: DVec3| Coord3D {
        x: p.x,
        y: p.y,
        z: p.z,
    };
    let [a, b, c] = own.map(coord);
    other.into_iter().any(|p| {
        // Positive below.
        let below = orient3d(a, b, c, coord(p));
        if inwards { below > 0.0 } else { below < 0.0 }
    })
}
