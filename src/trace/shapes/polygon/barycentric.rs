//! Snyder's method: barycentric coordinates, in the plan along the dominant axis of the normal.
//!
//! Dropping a coordinate does not change them, and dropping the one along which the normal is longest
//! keeps the triangles as large as possible. In each triangle
//! β_i = [(P_{i+2} - P_{i+1}) × (I - P_{i+1})] / [N], and I is inside if none is negative. (Then none
//! is above 1 either, since their sum is 1.)
//!
//! The product of an edge is always computed from its end of lower number, so that two triangles at an
//! edge see exactly opposite signs, and no point falls between them.

use glam::DVec2;
use smallvec::smallvec;

use super::{Weights, cross};

/// The weights at `point` in the first of the triangles that holds it.
pub fn weights(corners: &[DVec2], triangles: &[[u32; 3]], point: DVec2) -> Option<Weights> {
    let corner = |i: u32| corners[i as usize];
    let side = |from: u32, to: u32| cross(corner(to) - corner(from), point - corner(from));
    let edge = |from: u32, to: u32| {
        if from < to {
            side(from, to)
        } else {
            -side(to, from)
        }
    };
    triangles.iter().find_map(|&[a, b, c]| {
        let area = cross(corner(b) - corner(a), corner(c) - corner(a));
        // Corners in a row.
        if area == 0.0 {
            return None;
        }
        let beta = [edge(b, c) / area, edge(c, a) / area, edge(a, b) / area];
        let inside = beta.iter().all(|&b| b >= 0.0);
        inside.then(|| smallvec![(a, beta[0]), (b, beta[1]), (c, beta[2])])
    })
}
