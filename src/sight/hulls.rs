//! The convex hulls of a chain's left and right ends: where they meet, or how far they lie apart.
//!
//! In: two lists of vertices in any order. Out: at most four of them whose hulls meet, or the strip
//! between the hulls. Complete and slow (O(n log n), and every edge of one hull with every edge of
//! the other): what [`super::exact`] falls back on where its shorter way finds nothing, and what its
//! answers are compared with in tests.

use std::cmp::Ordering;

use smallvec::SmallVec;

use super::Contradiction;
use super::stab::meet;
use super::strip::Strip;
use crate::geom::{Placed, Side, VertexId, Vertices};

/// What two hulls have to do with each other.
#[derive(Clone, Debug)]
pub(super) enum Hulls {
    /// They have a point in common.
    Meet(Contradiction),
    /// They lie apart.
    Apart(Strip),
}

/// Compares the hulls of two sets of vertices, none of them empty.
pub(super) fn compare(vertices: &Vertices, left: &[VertexId], right: &[VertexId]) -> Hulls {
    let (left, right) = (hull(vertices, left), hull(vertices, right));
    if let Some(contradiction) = meeting(vertices, &left, &right) {
        return Hulls::Meet(contradiction);
    }
    // Counterclockwise edges have their own hull on the left, as the sightlines have the left ends.
    let strip = if let Some((left, right)) = closest_corners(vertices, &left, &right) {
        Strip::across(left, right)
    } else if let Some((left, right)) = closest_edge(vertices, &left, &right) {
        Strip {
            left,
            right: [right; 2],
        }
    } else {
        let found = closest_edge(vertices, &right, &left);
        let ([a, b], left) = found.expect("hulls that lie apart have a least distance");
        Strip {
            left: [left; 2],
            right: [b, a],
        }
    };
    Hulls::Apart(strip)
}

/// The corners of the convex hull, counterclockwise, each point once, none between two others in
/// line (Andrew 1979).
fn hull(vertices: &Vertices, ends: &[VertexId]) -> Vec<Placed> {
    let mut sorted: Vec<VertexId> = ends.to_vec();
    let cmp = |p: &VertexId, q: &VertexId| {
        let (p, q) = (vertices.exact(*p), vertices.exact(*q));
        p.cmp_x(q).then(p.cmp_y(q))
    };
    sorted.sort_unstable_by(|p, q| cmp(p, q).then(p.cmp(q)));
    sorted.dedup_by(|p, q| cmp(p, q) == Ordering::Equal);
    let half = |ends: &mut dyn Iterator<Item = &VertexId>| {
        let mut half: Vec<Placed> = Vec::new();
        for p in ends.map(|p| vertices.placed(*p)) {
            while let [.., a, b] = &half[..] {
                if vertices.side(a, b, &p) == Side::Left {
                    break;
                }
                half.pop();
            }
            half.push(p);
        }
        half
    };
    let mut corners = half(&mut sorted.iter());
    let upper = half(&mut sorted.iter().rev());
    if sorted.len() > 1 {
        corners.pop();
        corners.extend_from_slice(&upper[..upper.len() - 1]);
    }
    corners
}

/// A hull's edges, counterclockwise; one from the point to itself where it is a point.
fn edges(hull: &[Placed]) -> impl Iterator<Item = [Placed; 2]> + '_ {
    (0..hull.len()).map(|i| [hull[i], hull[(i + 1) % hull.len()]])
}

/// The corners before and after corner `i`.
fn neighbours(hull: &[Placed], i: usize) -> [&Placed; 2] {
    let n = hull.len();
    [&hull[(i + n - 1) % n], &hull[(i + 1) % n]]
}

/// At most four corners whose hulls meet; `None` if the hulls lie apart.
fn meeting(vertices: &Vertices, left: &[Placed], right: &[Placed]) -> Option<Contradiction> {
    let found = |left: &[Placed], right: &[Placed]| {
        let ids = |ends: &[Placed]| ends.iter().map(|p| p.id).collect::<SmallVec<[_; 4]>>();
        shrink(vertices, ids(left), ids(right))
    };
    // If one holds the other, then a triangle fanned out from one of its corners holds a corner.
    let fans = |hull: &'_ [Placed]| -> Vec<[Placed; 3]> {
        let pairs = hull.windows(2).skip(1);
        pairs.map(|pair| [hull[0], pair[0], pair[1]]).collect()
    };
    let crossing = || edges(left).find_map(|l| edges(right).find_map(|r| found(&l, &r)));
    crossing()
        .or_else(|| fans(left).iter().find_map(|l| found(l, &right[..1])))
        .or_else(|| fans(right).iter().find_map(|r| found(&left[..1], r)))
}

/// The contradiction of these ends without those that it does not need; `None` if they do not
/// contradict each other.
pub(super) fn shrink(
    vertices: &Vertices,
    mut left: SmallVec<[VertexId; 4]>,
    mut right: SmallVec<[VertexId; 4]>,
) -> Option<Contradiction> {
    if !meet(vertices, &left, &right) {
        return None;
    }
    let without = |ends: &SmallVec<[VertexId; 4]>, i: usize| {
        let mut fewer = ends.clone();
        fewer.remove(i);
        fewer
    };
    for i in (0..left.len()).rev() {
        let fewer = without(&left, i);
        if meet(vertices, &fewer, &right) {
            left = fewer;
        }
    }
    for i in (0..right.len()).rev() {
        let fewer = without(&right, i);
        if meet(vertices, &left, &fewer) {
            right = fewer;
        }
    }
    Some(Contradiction { left, right })
}

/// The two corners that are each other's closest points, if the hulls' distance is theirs.
fn closest_corners(
    vertices: &Vertices,
    left: &[Placed],
    right: &[Placed],
) -> Option<(Placed, Placed)> {
    // No neighbour lies nearer to the other corner, as seen along the way between the two. What
    // holds for the neighbours holds for the hull.
    let rests = |hull: &[Placed], i: usize, other: &Placed| {
        let p = &hull[i];
        let back = |q| vertices.facing([p, q], [other, p]) != Ordering::Less;
        neighbours(hull, i).into_iter().all(back)
    };
    (0..left.len()).find_map(|i| {
        let facing = |&j: &usize| rests(left, i, &right[j]) && rests(right, j, &left[i]);
        let j = (0..right.len()).find(facing)?;
        Some((left[i], right[j]))
    })
}

/// An edge of one hull, counterclockwise, and the corner of the other that is nearest to its inside,
/// if the hulls' distance is theirs.
fn closest_edge(
    vertices: &Vertices,
    hull: &[Placed],
    other: &[Placed],
) -> Option<([Placed; 2], Placed)> {
    edges(hull).find_map(|[a, b]| {
        let nearest = |&j: &usize| {
            let p = &other[j];
            let away = |q| vertices.turn([&a, &b], [p, q]) != Side::Left;
            vertices.side(&a, &b, p) == Side::Right
                && vertices.facing([&a, &b], [&a, p]) == Ordering::Greater
                && vertices.facing([&b, &a], [&b, p]) == Ordering::Greater
                && neighbours(other, j).into_iter().all(away)
        };
        let j = (0..other.len()).find(nearest)?;
        Some(([a, b], other[j]))
    })
}
