//! The widest strip between points that it must leave on its left and points on its right.
//!
//! A line separates two sets of points just when their convex hulls have none in common; the widest
//! strip between them is as wide as the hulls are apart, and lies square to the shortest way from
//! the one to the other. All in f64: the strip is a measure, and what follows from it about sight is
//! checked exactly elsewhere.

use glam::DVec2;

use crate::geom::VertexId;

/// A point that a strip must leave on one side, and the vertex that it is.
pub type End = (DVec2, VertexId);

/// A strip with two parallel borders, seen in its direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Distance of the borders, positive.
    pub width: f64,
    /// Unit vector along the strip.
    pub direction: DVec2,
    /// A point of the left border, and one of the right border, square across from it.
    pub across: [DVec2; 2],
    /// The ends that touch the left border: one, or two where the border runs along both.
    pub left: Vec<VertexId>,
    /// The ends that touch the right border. One side has two ends at most, or both one.
    pub right: Vec<VertexId>,
}

impl Strip {
    /// How far a point lies to the left of the middle, in parts of the width: from -½ to ½ inside.
    pub fn offset(&self, p: DVec2) -> f64 {
        self.direction.perp_dot(p - self.middle()) / self.width
    }

    /// A point in the middle.
    pub fn middle(&self) -> DVec2 {
        (self.across[0] + self.across[1]) / 2.0
    }
}

/// The widest strip; `None` if the hulls are not apart as far as f64 can tell.
pub fn widest(left: &[End], right: &[End]) -> Option<Strip> {
    let (left, right) = (hull(left), hull(right));
    let mut best: Option<Strip> = None;
    let mut consider = |l: DVec2, r: DVec2, left: Vec<VertexId>, right: Vec<VertexId>| {
        let width = l.distance(r);
        if width > 0.0 && best.as_ref().is_none_or(|b| width < b.width) {
            best = Some(Strip {
                width,
                direction: (r - l).perp() / width,
                across: [l, r],
                left,
                right,
            });
        }
    };
    for &(l, l_id) in &left {
        for &(r, r_id) in &right {
            consider(l, r, vec![l_id], vec![r_id]);
        }
    }
    // Only what is nearer than all corners counts: the foot on the inside of an edge.
    for (p, q) in edges(&left) {
        for &(r, r_id) in &right {
            if let Some(foot) = foot(p.0, q.0, r) {
                consider(foot, r, vec![p.1, q.1], vec![r_id]);
            }
        }
    }
    for (p, q) in edges(&right) {
        for &(l, l_id) in &left {
            if let Some(foot) = foot(p.0, q.0, l) {
                consider(l, foot, vec![l_id], vec![p.1, q.1]);
            }
        }
    }
    // Hulls that meet have no strip between them: some point is then on the wrong side.
    let strip = best?;
    let half = 0.5 - 2f64.powi(-10);
    let apart = left.iter().all(|l| strip.offset(l.0) > half)
        && right.iter().all(|r| strip.offset(r.0) < -half);
    apart.then_some(strip)
}

/// The distance of two chains of points that face each other, such as the ends that bound a
/// [`Funnel`](crate::sight::funnel::Funnel).
pub fn distance(left: &[DVec2], right: &[DVec2]) -> f64 {
    let mut least = f64::INFINITY;
    for l in left {
        for r in right {
            least = least.min(l.distance_squared(*r));
        }
    }
    for (chain, points) in [(left, right), (right, left)] {
        for pair in chain.windows(2) {
            for &p in points {
                if let Some(foot) = foot(pair[0], pair[1], p) {
                    least = least.min(foot.distance_squared(p));
                }
            }
        }
    }
    least.sqrt()
}

/// The foot of the perpendicular from `r`, if it lies strictly between `p` and `q`.
fn foot(p: DVec2, q: DVec2, r: DVec2) -> Option<DVec2> {
    let d = q - p;
    let t = (r - p).dot(d) / d.length_squared();
    (t > 0.0 && t < 1.0).then(|| p + d * t)
}

/// The corners of the convex hull, counterclockwise.
fn hull(points: &[End]) -> Vec<End> {
    let mut points = points.to_vec();
    points.sort_by(|a, b| {
        let by_place = a.0.x.total_cmp(&b.0.x).then(a.0.y.total_cmp(&b.0.y));
        by_place.then(a.1.cmp(&b.1))
    });
    points.dedup_by(|a, b| a.0 == b.0);
    if points.len() < 3 {
        return points;
    }
    let mut hull: Vec<End> = Vec::new();
    let half = |hull: &mut Vec<End>, next: End, base: usize| {
        while let [.., p, q] = hull[base..] {
            if (q.0 - p.0).perp_dot(next.0 - p.0) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(next);
    };
    for &p in &points {
        half(&mut hull, p, 0);
    }
    let base = hull.len() - 1;
    for &p in points.iter().rev().skip(1) {
        half(&mut hull, p, base);
    }
    hull.pop();
    hull
}

/// The edges of a hull.
fn edges(hull: &[End]) -> impl Iterator<Item = (End, End)> + '_ {
    let n = hull.len();
    let count = if n < 3 { n.saturating_sub(1) } else { n };
    (0..count).map(move |i| (hull[i], hull[(i + 1) % n]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(points: &[[f64; 2]], first: u32) -> Vec<End> {
        let ids = (first..).map(VertexId);
        points.iter().map(|&p| DVec2::from(p)).zip(ids).collect()
    }

    #[test]
    fn between_two_points_and_along_an_edge() {
        let left = ends(&[[0.0, 3.0]], 0);
        let right = ends(&[[4.0, 0.0]], 10);
        let strip = widest(&left, &right).unwrap();
        assert_eq!(strip.width, 5.0);
        // Going up to the right, the first point is on the left.
        assert_eq!(strip.direction, DVec2::new(0.6, 0.8));
        assert_eq!(strip.offset(left[0].0), 0.5);
        assert_eq!(strip.offset(right[0].0), -0.5);
        let left = ends(&[[0.0, 3.0], [8.0, 3.0], [4.0, 9.0]], 0);
        let strip = widest(&left, &right).unwrap();
        assert_eq!((strip.width, strip.left.len()), (3.0, 2));
        assert_eq!(strip.direction, DVec2::X);
        assert_eq!(strip.right, [VertexId(10)]);
    }

    #[test]
    fn hulls_that_meet() {
        let cross = [
            ends(&[[0.0, 0.0], [4.0, 4.0]], 0),
            ends(&[[0.0, 4.0], [4.0, 0.0]], 10),
        ];
        assert_eq!(widest(&cross[0], &cross[1]), None);
        let within = ends(&[[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]], 0);
        assert_eq!(widest(&within, &ends(&[[2.0, 2.0]], 10)), None);
        assert_eq!(widest(&within, &ends(&[[0.0, 0.0]], 10)), None);
    }

    #[test]
    fn chains_that_face_each_other() {
        let [a, b, c] = [[0.0, 3.0], [8.0, 3.0], [4.0, 0.0]].map(DVec2::from);
        assert_eq!(distance(&[a, b], &[c]), 3.0);
        assert_eq!(distance(&[c], &[a, b]), 3.0);
        assert_eq!(distance(&[a], &[c]), 5.0);
    }
}
