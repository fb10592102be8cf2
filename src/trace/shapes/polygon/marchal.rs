//! Marchal's method.
//!
//! In the polygon's plane, coordinates (u, v) with their origin at the corner P0 and the v axis
//! through the point I. (The lecture's slide does not say where the axis points; only so does its
//! formula for M make sense.) An edge whose ends have u of different signs crosses the axis, at
//! M = P0 + λ(I - P0). Lengths along a line keep their ratios when a coordinate is dropped, so all is
//! done in the plan.
//!
//! The slide takes any such edge and asks for P0I < P0M. That is right for convex polygons only, and
//! only for edges in front (λ > 0). In general, walking from I away from P0, one leaves the polygon
//! at each second edge: I is inside if the number of edges with λ ≥ 1 is odd. The least of these is M.
//! The same edges counted in the other direction give the point M' where the axis entered last,
//! between P0 and I: for convex polygons P0 itself. Between M' and M values are interpolated as on the
//! slide, N_I = (M'I / M'M)·N_M + (1 - M'I / M'M)·N_M', with N_M interpolated along its edge.
//!
//! An end with u = 0 counts as u > 0, so that an axis through a corner crosses one edge there or
//! both or none, as parity wants.

use glam::DVec2;
use smallvec::smallvec;

use super::{Weights, cross};

/// Where the axis crosses an edge: λ, the edge's first corner, and how far along the edge.
type Crossing = (f64, usize, f64);

/// The weights at `point`, if it is inside. The first corner is at 0.
pub fn weights(corners: &[DVec2], point: DVec2) -> Option<Weights> {
    let n = corners.len();
    if point == corners[0] {
        return Some(smallvec![(0, 1.0)]);
    }
    let u = |i: usize| cross(point, corners[i]);
    let mut beyond = 0;
    // The first crossing from I on, and the last before it.
    let mut first: Option<Crossing> = None;
    let mut last: Option<Crossing> = None;
    for i in 0..n {
        let (a, b) = (u(i), u((i + 1) % n));
        if (a < 0.0) == (b < 0.0) {
            continue;
        }
        let edge = corners[(i + 1) % n] - corners[i];
        // The divisor is point × edge, and not 0, since the signs differ.
        let lambda = cross(corners[i], edge) / (b - a);
        let crossing = (lambda, i, a / (a - b));
        if lambda >= 1.0 {
            beyond += 1;
            if first.is_none_or(|f| lambda < f.0) {
                first = Some(crossing);
            }
        } else if lambda > 0.0 && last.is_none_or(|l| lambda > l.0) {
            last = Some(crossing);
        }
    }
    let (ahead, edge, along) = first.filter(|_| beyond % 2 == 1)?;
    let (behind, start) = match last {
        Some((lambda, edge, along)) => (lambda, (edge, along)),
        None => (0.0, (0, 0.0)),
    };
    // λ is 1 at I.
    let share = (1.0 - behind) / (ahead - behind);
    let mut weights = Weights::new();
    for ((edge, along), weight) in [((edge, along), share), (start, 1.0 - share)] {
        weights.push((edge as u32, (1.0 - along) * weight));
        weights.push(((edge as u32 + 1) % n as u32, along * weight));
    }
    Some(weights)
}
