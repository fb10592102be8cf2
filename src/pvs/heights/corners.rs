//! The lines that stab a chain on the plan, as sums of the few that bound them.
//!
//! A directed line is a vector (a, b, c), and the lines that stab a chain are the sums, with weights
//! above zero, of the lines in the corners of a polygon, each of which touches two ends of portals.
//! What is linear in the vector (how steeply a line crosses a portal; on which side of a place it
//! passes, and how far) need only be known in the corners.

use glam::DVec2;
use smallvec::SmallVec;

use super::chain::Gate;
use crate::geom::{Interval, Placed, Vertices};
use crate::sight::funnel::Funnel;

/// A line in a corner of the polygon, through two vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub from: Placed,
    pub to: Placed,
    /// A power of two that brings the line's direction to about unit length.
    pub scale: f64,
    /// The line as a vector with a direction of about unit length, in f64, about [`Corners::origin`].
    pub line: [f64; 3],
}

/// The corners of the polygon, in order around it.
#[derive(Default)]
pub(super) struct Corners {
    pub origin: DVec2,
    pub list: SmallVec<[Corner; 8]>,
    /// Distance of the farthest two vertices on one line.
    size: f64,
}

/// How a corner's line meets one portal of the chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meeting {
    /// How far beyond the portal's line the corner line's first vertex lies, and its second one; the
    /// latter times the line's scale.
    from: Interval,
    to: Interval,
    /// By how much the second lies further beyond: at least zero, as all lines cross forwards.
    pub ahead: Interval,
}

impl Meeting {
    /// How much further along the line another portal, later in the chain, is met, times both
    /// portals' [`Meeting::ahead`]; at least zero, as all lines cross portals in order.
    pub fn until(&self, later: &Meeting) -> Interval {
        (self.from * later.to - later.from * self.to).not_below_zero()
    }
}

impl Corners {
    /// The corners for the funnel's chain, of at least two portals.
    pub fn set(&mut self, vertices: &Vertices, funnel: &Funnel, origin: DVec2) {
        self.origin = origin;
        self.list.clear();
        // Where three vertices lie in line, neighbouring corners are one.
        let same = |[p, q]: &[Placed; 2], [r, s]: &[Placed; 2]| {
            let on = |r| vertices.area(p, q, r) == Interval::ZERO;
            on(r) && on(s)
        };
        let mut lines: SmallVec<[[Placed; 2]; 8]> = SmallVec::new();
        for line in bounding_lines(funnel) {
            if lines.last().is_none_or(|before| !same(before, &line)) {
                lines.push(line);
            }
        }
        if lines.len() > 3 && same(&lines[0], &lines[lines.len() - 1]) {
            lines.pop();
        }
        self.list
            .extend(lines.into_iter().map(|line| Corner::new(line, origin)));
        let length = |corner: &Corner| corner.from.at.distance(corner.to.at);
        self.size = self.list.iter().map(length).fold(0.0, f64::max);
    }

    /// The corners of any polygon, given by lines through two vertices each.
    #[cfg(test)]
    pub fn of_lines(vertices: &Vertices, lines: &[[crate::geom::VertexId; 2]]) -> Self {
        let corner = |line: &[crate::geom::VertexId; 2]| {
            Corner::new(line.map(|v| vertices.placed(v)), DVec2::ZERO)
        };
        Self {
            list: lines.iter().map(corner).collect(),
            ..Self::default()
        }
    }

    /// The sum of the corners' lines with these weights.
    pub fn sum(&self, weights: &[f64]) -> [f64; 3] {
        let mut line = [0.0; 3];
        for (corner, weight) in self.list.iter().zip(weights) {
            for (sum, part) in line.iter_mut().zip(corner.line) {
                *sum += weight * part;
            }
        }
        line
    }

    /// How far two lines are from each other somewhere along the chain, about.
    pub fn distance(&self, p: [f64; 3], q: [f64; 3]) -> f64 {
        let turn = DVec2::new(q[0] - p[0], q[1] - p[1]).length();
        (turn * self.size).max((q[2] - p[2]).abs())
    }
}

/// The lines that touch two ends of portals and bound the stabbing lines, in order around the polygon:
/// the counterclockwise-most, those along the left ends, the clockwise-most, those along the right
/// ends. Each leads from an earlier end in the chain to a later one.
fn bounding_lines(funnel: &Funnel) -> impl Iterator<Item = [Placed; 2]> {
    let (left, right) = (funnel.left_bounds(), funnel.right_bounds());
    let along = |ends: &'_ [Placed]| -> SmallVec<[[Placed; 2]; 4]> {
        ends.windows(2).rev().map(|w| [w[0], w[1]]).collect()
    };
    let (ccw, cw) = (
        [right[0], left[left.len() - 1]],
        [left[0], right[right.len() - 1]],
    );
    [ccw]
        .into_iter()
        .chain(along(left))
        .chain([cw])
        .chain(along(right))
}

/// The largest power of two not above a number of any size that lengths on the grid have.
fn power_below(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52 & 0x7ff) as i32 - 1023;
    2f64.powi(exponent.clamp(-100, 100))
}

impl Corner {
    fn new([from, to]: [Placed; 2], origin: DVec2) -> Self {
        let d = to.at - from.at;
        let scale = 1.0 / power_below(d.x.abs().max(d.y.abs()));
        let (a, b) = (-d.y * scale, d.x * scale);
        let at = from.at - origin;
        Self {
            from,
            to,
            scale,
            line: [a, b, -(a * at.x + b * at.y)],
        }
    }

    /// How the line meets a portal of the chain.
    pub fn meet(&self, vertices: &Vertices, gate: &Gate) -> Meeting {
        let beyond = |p| vertices.area(&gate.left, &gate.right, p);
        let (from, to) = (beyond(&self.from), beyond(&self.to));
        let scale = Interval::point(self.scale);
        Meeting {
            from,
            to: to * scale,
            ahead: (to - from).not_below_zero() * scale,
        }
    }
}
