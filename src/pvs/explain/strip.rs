//! The widest strip between ends that it must leave on its left and ends on its right.
//!
//! In: vertices on either side, a chain's or any others. Out: a [`Strip`], which ends bound it and
//! the line in its middle (exact), and its measures in f64 for pictures; or the few ends that
//! contradict each other.

use glam::DVec2;
use smallvec::SmallVec;

use crate::geom::{Placed, VertexId, Vertices};
use crate::sight::{Contradiction, Gate, Stabbing, Witness, exact};

/// A strip with two parallel borders, as somebody sees it who walks along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Distance of the borders in grid steps, positive.
    pub width: f64,
    /// The ends that touch the left border: one, or two where the border runs along both.
    pub left: SmallVec<[VertexId; 2]>,
    /// The ends that touch the right border; two at most if the left border has one.
    pub right: SmallVec<[VertexId; 2]>,
    /// The line in the middle, exactly.
    pub line: Witness,
    /// Unit vector along the strip.
    pub direction: DVec2,
    /// A point in the middle, in grid steps.
    pub middle: DVec2,
}

impl Strip {
    /// How far a point lies to the left of the middle, in parts of the width: from -½ to ½ inside.
    pub fn offset(&self, p: DVec2) -> f64 {
        self.direction.perp_dot(p - self.middle) / self.width
    }
}

/// The widest strip between two sets of vertices, neither of them empty, or some of them that no
/// line separates.
pub fn widest(
    vertices: &Vertices,
    left: &[VertexId],
    right: &[VertexId],
) -> Result<Strip, Contradiction> {
    // For stabbing, only what is left and what is right matters: the shorter list's last end serves
    // for all that are left of the longer.
    let gates: Vec<Gate> = (0..left.len().max(right.len()))
        .map(|i| Gate {
            left: left[i.min(left.len() - 1)],
            right: right[i.min(right.len() - 1)],
        })
        .collect();
    between(vertices, &gates)
}

/// The widest strip that a chain lets through, or why there is none. At least one gate.
pub fn between(vertices: &Vertices, gates: &[Gate]) -> Result<Strip, Contradiction> {
    let line = match exact::stab(vertices, gates) {
        Stabbing::Line(line) => line,
        Stabbing::None(ends) => return Err(ends),
    };
    let slack = exact::slack(vertices, gates).expect("a line stabs the chain");
    let [a, b, c] = line.approx();
    let to_left = DVec2::new(a, b);
    let touched = vertices.approx(slack.left[0]);
    Ok(Strip {
        width: slack.width,
        left: slack.left,
        right: slack.right,
        line,
        direction: -to_left.perp(),
        middle: touched - to_left * (to_left.dot(touched) + c),
    })
}

/// The distance of two chains of points that face each other, such as the ends that bound a
/// [`Funnel`](crate::sight::funnel::Funnel): the width of the widest strip between them, in f64.
pub fn distance(left: &[Placed], right: &[Placed]) -> f64 {
    let mut least = f64::INFINITY;
    for l in left {
        for r in right {
            least = least.min(l.at.distance_squared(r.at));
        }
    }
    for (chain, points) in [(left, right), (right, left)] {
        for pair in chain.windows(2) {
            for p in points {
                if let Some(foot) = foot(pair[0].at, pair[1].at, p.at) {
                    least = least.min(foot.distance_squared(p.at));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::GridPoint;

    /// The vertices, left ones first, and the ids of either side.
    fn sides(left: &[[i64; 2]], right: &[[i64; 2]]) -> (Vertices, Vec<VertexId>, Vec<VertexId>) {
        let at = |p: &[i64; 2]| GridPoint::new(p[0], p[1]).into();
        let vertices = Vertices::new(left.iter().chain(right).map(at).collect());
        let ids = |from: usize, n: usize| (from..from + n).map(|i| VertexId(i as u32)).collect();
        let (l, r) = (ids(0, left.len()), ids(left.len(), right.len()));
        (vertices, l, r)
    }

    #[test]
    fn between_two_points_and_along_an_edge() {
        let (vertices, left, right) = sides(&[[0, 3]], &[[4, 0]]);
        let strip = widest(&vertices, &left, &right).unwrap();
        assert_eq!(strip.width, 5.0);
        // Going up to the right, the first point is on the left.
        assert!(strip.direction.distance(DVec2::new(0.6, 0.8)) < 1e-15);
        assert!((strip.offset(DVec2::new(0.0, 3.0)) - 0.5).abs() < 1e-15);
        assert!((strip.offset(DVec2::new(4.0, 0.0)) + 0.5).abs() < 1e-15);
        let (vertices, left, right) = sides(&[[0, 3], [8, 3], [4, 9]], &[[4, 0]]);
        let strip = widest(&vertices, &left, &right).unwrap();
        assert_eq!((strip.width, strip.left.len()), (3.0, 2));
        assert_eq!(strip.direction, DVec2::X);
        assert_eq!(strip.middle.y, 1.5);
        assert_eq!(strip.right[..], right[..]);
    }

    #[test]
    fn ends_in_any_order_that_no_line_separates() {
        let (vertices, left, right) = sides(&[[0, 0], [4, 4], [0, 9]], &[[0, 4], [4, 0]]);
        let ends = widest(&vertices, &left, &right).unwrap_err();
        assert!(ends.left.len() + ends.right.len() <= 4);
        let (vertices, left, right) = sides(&[[0, 0], [9, 0], [0, 9]], &[[2, 2]]);
        let ends = widest(&vertices, &left, &right).unwrap_err();
        assert_eq!((ends.left.len(), ends.right.len()), (3, 1));
    }

    #[test]
    fn chains_that_face_each_other() {
        let (vertices, left, right) = sides(&[[0, 3], [8, 3]], &[[4, 0]]);
        let [l, r] = [left, right].map(|ids| {
            ids.into_iter()
                .map(|v| vertices.placed(v))
                .collect::<Vec<_>>()
        });
        assert_eq!(distance(&l, &r), 3.0);
        assert_eq!(distance(&r, &l), 3.0);
        assert_eq!(distance(&l[..1], &r), 5.0);
    }
}
