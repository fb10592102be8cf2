//! The outline of a polygon in the plan: whether it crosses itself, and its triangles. Orientations
//! are exact (Shewchuk's predicates).

use glam::DVec2;
use robust::{Coord, orient2d};

/// Positive if a, b, c turn left.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| Coord { x: p.x, y: p.y });
    orient2d(a, b, c)
}

/// Two edges, by their first corners, that have a point in common which they should not have.
pub(super) fn crossing(corners: &[DVec2]) -> Option<(usize, usize)> {
    let n = corners.len();
    let at = |i: usize| corners[i % n];
    for i in 0..n {
        // The neighbour: it may not turn back along the edge.
        let (a, b, c) = (at(i), at(i + 1), at(i + 2));
        if turn(a, b, c) == 0.0 && (b - a).dot(c - b) < 0.0 {
            return Some((i, (i + 1) % n));
        }
        for j in i + 2..n {
            if (j + 1) % n != i && meet([at(i), at(i + 1)], [at(j), at(j + 1)]) {
                return Some((i, j));
            }
        }
    }
    None
}

/// Whether two segments have a point in common.
fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let sides = [turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)];
    let parted = |x: f64, y: f64| x > 0.0 && y > 0.0 || x < 0.0 && y < 0.0;
    if parted(sides[0], sides[1]) || parted(sides[2], sides[3]) {
        return false;
    }
    if sides.iter().any(|&s| s != 0.0) {
        return true;
    }
    // All on one line.
    let (low, high) = (a.min(b), a.max(b));
    low.cmple(c.max(d)).all() && c.min(d).cmple(high).all()
}

/// Triangles that fill the polygon: the fan about the first corner if it is convex, else ears.
/// `left` tells whether the corners go around counterclockwise. None if no ear is left.
pub(super) fn triangles(corners: &[DVec2], left: bool) -> Option<Vec<[u32; 3]>> {
    let n = corners.len();
    let sign = if left { 1.0 } else { -1.0 };
    let turns = |i: usize, j: usize, k: usize| sign * turn(corners[i], corners[j], corners[k]);
    if (0..n).all(|i| turns(i, (i + 1) % n, (i + 2) % n) >= 0.0) {
        return Some((1..n as u32 - 1).map(|i| [0, i, i + 1]).collect());
    }
    let mut rest: Vec<usize> = (0..n).collect();
    let mut found = Vec::with_capacity(n - 2);
    while rest.len() > 3 {
        let m = rest.len();
        let is_ear = |&i: &usize| {
            let [a, b, c] = [rest[(i + m - 1) % m], rest[i], rest[(i + 1) % m]];
            let inside = |&p: &usize| {
                turns(a, b, p) >= 0.0 && turns(b, c, p) >= 0.0 && turns(c, a, p) >= 0.0
            };
            // In a row: cut off, a triangle without area.
            turns(a, b, c) == 0.0
                || turns(a, b, c) > 0.0
                    && !rest
                        .iter()
                        .filter(|&&p| p != a && p != b && p != c)
                        .any(inside)
        };
        let i = (0..m).find(is_ear)?;
        let [a, b, c] = [rest[(i + m - 1) % m], rest[i], rest[(i + 1) % m]];
        if turns(a, b, c) > 0.0 {
            found.push([a as u32, b as u32, c as u32]);
        }
        rest.remove(i);
    }
    found.push([rest[0] as u32, rest[1] as u32, rest[2] as u32]);
    Some(found)
}
