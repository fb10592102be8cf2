//! Why no line stabs a chain: few of its ends that contradict each other.
//!
//! In: ends that a line must leave on its left, and ends that it must leave on its right. Out: at
//! most four of them whose convex hulls have a point in common (Kirchberger 1903); exact. Unlike
//! [`stab`](crate::sight::stab()), this takes any of a chain's ends, so that ends at which no wall
//! stands can be left out: a contradiction among walls says more.

use std::cmp::Ordering;

use smallvec::{SmallVec, smallvec};

use crate::geom::{Side, VertexId, Vertices};
use crate::sight::Contradiction;

/// The first contradiction with the fewest ends; `None` if some line separates the two sets.
pub fn clash(vertices: &Vertices, left: &[VertexId], right: &[VertexId]) -> Option<Contradiction> {
    let (left, right) = (hull(vertices, left), hull(vertices, right));
    let within = |points: &[VertexId], hull: &[VertexId]| {
        let held = |&p: &VertexId| Some((p, holding(vertices, hull, p)?));
        points.iter().filter_map(held).min_by_key(|(_, by)| by.len())
    };
    let crossed = || {
        let mut pairs = edges(&left).flat_map(|l| edges(&right).map(move |r| (l, r)));
        pairs.find(|&(l, r)| cross(vertices, l, r))
    };
    let one_left = within(&left, &right).map(|(l, by)| Contradiction {
        left: smallvec![l],
        right: by,
    });
    let one_right = within(&right, &left).map(|(r, by)| Contradiction {
        left: by,
        right: smallvec![r],
    });
    let found = one_left.into_iter().chain(one_right);
    let fewest = found.min_by_key(|c| c.left.len() + c.right.len());
    fewest.or_else(|| {
        crossed().map(|(l, r)| Contradiction {
            left: l.into_iter().collect(),
            right: r.into_iter().collect(),
        })
    })
}

/// At most three corners of a hull whose own hull holds the point, border included.
fn holding(
    vertices: &Vertices,
    hull: &[VertexId],
    p: VertexId,
) -> Option<SmallVec<[VertexId; 4]>> {
    if hull.contains(&p) {
        return Some(smallvec![p]);
    }
    if let Some(edge) = edges(hull).find(|&[q, r]| is_between(vertices, q, p, r)) {
        return Some(edge.into_iter().collect());
    }
    let (&first, rest) = hull.split_first()?;
    let side = |q, r| vertices.orient(q, r, p);
    let triangle = rest.windows(2).find(|pair| {
        side(first, pair[0]) != Side::Right
            && side(pair[0], pair[1]) != Side::Right
            && side(pair[1], first) != Side::Right
    })?;
    Some(smallvec![first, triangle[0], triangle[1]])
}

/// Whether `p` lies strictly between `q` and `r`, on one line with them.
fn is_between(vertices: &Vertices, q: VertexId, p: VertexId, r: VertexId) -> bool {
    vertices.orient(q, r, p) == Side::On && !vertices.same_direction(p, q, r)
}

/// Whether two segments cross, each strictly inside the other.
fn cross(vertices: &Vertices, [a, b]: [VertexId; 2], [c, d]: [VertexId; 2]) -> bool {
    let parts = |p, q, r, s| {
        let (f, g) = (vertices.orient(p, q, r), vertices.orient(p, q, s));
        f != Side::On && f == g.flip()
    };
    parts(a, b, c, d) && parts(c, d, a, b)
}

/// The edges of a hull; one for two points.
fn edges(hull: &[VertexId]) -> impl Iterator<Item = [VertexId; 2]> + '_ {
    let n = hull.len();
    let count = if n < 3 { n.saturating_sub(1) } else { n };
    (0..count).map(move |i| [hull[i], hull[(i + 1) % n]])
}

/// The corners of the convex hull, counterclockwise; exact.
fn hull(vertices: &Vertices, points: &[VertexId]) -> Vec<VertexId> {
    let mut points = points.to_vec();
    points.sort_by(|&p, &q| by_place(vertices, p, q));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull: Vec<VertexId> = Vec::new();
    let add = |hull: &mut Vec<VertexId>, next: VertexId, base: usize| {
        while let [.., p, q] = hull[base..] {
            if vertices.orient(p, q, next) == Side::Left {
                break;
            }
            hull.pop();
        }
        hull.push(next);
    };
    for &p in &points {
        add(&mut hull, p, 0);
    }
    let base = hull.len() - 1;
    for &p in points.iter().rev().skip(1) {
        add(&mut hull, p, base);
    }
    hull.pop();
    hull
}

fn by_place(vertices: &Vertices, p: VertexId, q: VertexId) -> Ordering {
    let (p, q) = (vertices.exact(p), vertices.exact(q));
    p.cmp_x(q).then(p.cmp_y(q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::GridPoint;

    /// Left points first, then right ones.
    fn clash_of(left: &[[i64; 2]], right: &[[i64; 2]]) -> Option<(Vec<u32>, Vec<u32>)> {
        let at = |p: &[i64; 2]| GridPoint::new(p[0], p[1]).into();
        let vertices = Vertices::new(left.iter().chain(right).map(at).collect());
        let ids = |range: std::ops::Range<usize>| -> Vec<VertexId> {
            range.map(|i| VertexId(i as u32)).collect()
        };
        let all = left.len() + right.len();
        let found = clash(&vertices, &ids(0..left.len()), &ids(left.len()..all))?;
        let numbers = |ids: SmallVec<[VertexId; 4]>| {
            let mut numbers: Vec<u32> = ids.iter().map(|v| v.0).collect();
            numbers.sort();
            numbers
        };
        Some((numbers(found.left), numbers(found.right)))
    }

    #[test]
    fn sets_apart() {
        assert_eq!(clash_of(&[[0, 1], [5, 1]], &[[0, 0], [5, 0]]), None);
        assert_eq!(clash_of(&[[0, 0]], &[[1, 0]]), None);
        assert_eq!(clash_of(&[[0, 0], [1, 0]], &[[2, 0], [3, 0]]), None);
    }

    #[test]
    fn a_point_between_two_in_a_triangle_and_a_cross() {
        assert_eq!(
            clash_of(&[[1, 0]], &[[0, 0], [3, 0]]),
            Some((vec![0], vec![1, 2]))
        );
        assert_eq!(
            clash_of(&[[0, 0], [9, 0], [0, 9], [9, 9]], &[[2, 1]]),
            Some((vec![0, 1, 3], vec![4]))
        );
        assert_eq!(
            clash_of(&[[0, 0], [4, 4]], &[[0, 4], [4, 0]]),
            Some((vec![0, 1], vec![2, 3]))
        );
    }
}
