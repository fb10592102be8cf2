//! Checks of outlines, exact on the grid, and what can be asked of a simple polygon.
//!
//! In: corners with their places. Out: which side is inside, or what is wrong with the outline.

use glam::DVec2;

use crate::geom::{Grid, GridPoint};

use super::super::finding::Place;
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
    for i in 0..n {
        for j in i + 1..n {
            if edges_meet(&points, i, j) {
                return Err(TomlError::SelfCrossing {
                    place: corners[j].place,
                    what: what.into(),
                    edge: edge_name(corners, j),
                    other: edge_name(corners, i),
                    other_place: corners[i].place,
                });
            }
        }
    }
    let doubled_area: i128 = (0..n)
        .map(|i| cross(points[0], points[i], points[(i + 1) % n]))
        .sum();
    Ok(doubled_area > 0)
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

/// Whether edges `i < j` share more than the corner that neighbours share.
fn edges_meet(points: &[GridPoint], i: usize, j: usize) -> bool {
    let n = points.len();
    let (a, b) = (points[i], points[(i + 1) % n]);
    let (c, d) = (points[j], points[(j + 1) % n]);
    if j == i + 1 {
        return folds_back(a, b, d);
    }
    if (j + 1) % n == i {
        return folds_back(c, a, b);
    }
    let crosses = side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
    let touches = |p, q, r| side(p, q, r) == 0 && dot(p, r, q) >= 0 && dot(q, r, p) >= 0;
    crosses || touches(a, b, c) || touches(a, b, d) || touches(c, d, a) || touches(c, d, b)
}

/// Whether the edge from `b` to `c` runs back along the edge from `a` to `b`.
fn folds_back(a: GridPoint, b: GridPoint, c: GridPoint) -> bool {
    side(a, b, c) == 0 && dot(b, a, c) > 0
}

/// 1 where `p` is left of the line from `a` to `b`, -1 where right, 0 on it.
pub(super) fn side(a: GridPoint, b: GridPoint, p: GridPoint) -> i128 {
    cross(a, b, p).signum()
}

fn cross(a: GridPoint, b: GridPoint, p: GridPoint) -> i128 {
    let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    dx * i128::from(p.y - a.y) - dy * i128::from(p.x - a.x)
}

/// Dot product of `b - a` and `c - a`.
fn dot(a: GridPoint, b: GridPoint, c: GridPoint) -> i128 {
    let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    dx * i128::from(c.x - a.x) + dy * i128::from(c.y - a.y)
}

/// Whether `p` lies inside the polygon (f64: for points that are well away from its edges).
pub(super) fn contains(polygon: &[DVec2], p: DVec2) -> bool {
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
pub(super) fn inner_point(polygon: &[DVec2]) -> DVec2 {
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
