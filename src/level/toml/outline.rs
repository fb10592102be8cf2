//! Checks of outlines, exact on the grid, and what can be asked of a simple polygon.
//!
//! In: corners with their places. Out: which side is inside, or what is wrong with the outline.

use glam::DVec2;

use crate::geom::{Grid, GridPoint};

use super::super::finding::Place;
use super::super::outline::{doubled_area, self_meeting, side};
use super::super::snap::RawPoint;
use super::error::TomlError;

/// Checks that `corners` enclose an area without meeting themselves; whether they run
/// counterclockwise. `what` names the outline in errors, `place` is where it starts.
pub(super) fn check(
    grid: &Grid,
    what: &str,
    place: Place,
    corners: &[RawPoint],
) -> Result<bool, TomlError> {
    let n = corners.len();
    if n < 3 {
        return Err(TomlError::TooFewCorners {
            place,
            what: what.into(),
            count: n,
            needed: 3,
        });
    }
    let points = grid_points(grid, what, corners)?;
    let (a, b) = (points[0], points[1]);
    if points.iter().all(|&p| side(a, b, p) == 0) {
        return Err(TomlError::ZeroArea {
            place,
            what: what.into(),
        });
    }
    if let Some((j, i)) = self_meeting(&points) {
        return Err(TomlError::SelfCrossing {
            place: corners[j].place,
            what: what.into(),
            edge: edge_name(corners, j),
            other: edge_name(corners, i),
            other_place: corners[i].place,
        });
    }
    Ok(doubled_area(&points) > 0)
}

/// The corners on the grid; an error where one occurs twice.
pub(super) fn grid_points(
    grid: &Grid,
    what: &str,
    corners: &[RawPoint],
) -> Result<Vec<GridPoint>, TomlError> {
    let points: Vec<GridPoint> = (corners.iter())
        .filter_map(|c| grid.nearest(c.at))
        .collect();
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|&i| (points[i], i));
    for pair in order.windows(2) {
        if points[pair[0]] == points[pair[1]] {
            let again = &corners[pair[1]];
            return Err(TomlError::RepeatedCorner {
                place: again.place,
                what: what.into(),
                x: again.at.x,
                y: again.at.y,
                first: corners[pair[0]].place,
            });
        }
    }
    Ok(points)
}

fn edge_name(corners: &[RawPoint], i: usize) -> String {
    let (a, b) = (corners[i].at, corners[(i + 1) % corners.len()].at);
    format!("({}, {}) to ({}, {})", a.x, a.y, b.x, b.y)
}

/// Whether `p` lies inside the polygon (f64: for points that are well away from its edges).
pub(in crate::level) fn contains(polygon: &[DVec2], p: DVec2) -> bool {
    let mut inside = false;
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    inside
}

/// A point inside a simple polygon: in the triangle at its lowest corner, or half-way from there
/// to the corner that reaches into that triangle farthest (O'Rourke, Computational Geometry in C).
pub(in crate::level) fn inner_point(polygon: &[DVec2]) -> DVec2 {
    let n = polygon.len();
    let lowest = (0..n)
        .min_by(|&i, &j| {
            let (a, b) = (polygon[i], polygon[j]);
            a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
        })
        .unwrap_or(0);
    let (before, v, after) = (
        polygon[(lowest + n - 1) % n],
        polygon[lowest],
        polygon[(lowest + 1) % n],
    );
    let across = after - before;
    let depth = |p: DVec2| across.perp_dot(p - before).abs();
    let in_triangle = |p: DVec2| {
        let sides =
            [(before, v), (v, after), (after, before)].map(|(a, b)| (b - a).perp_dot(p - a));
        sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
    };
    polygon
        .iter()
        .copied()
        .filter(|&p| in_triangle(p))
        .max_by(|&p, &q| depth(p).total_cmp(&depth(q)))
        .map_or((before + v + after) / 3.0, |p| (v + p) / 2.0)
}
