//! A sightline in space, and the proof that it passes through an opening.

use glam::DVec3;

use super::chain::Gate;
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Interval, Span, Vertices};

/// A straight line through two points in space: on the plan in grid steps, in height in the level's
/// unit. Both are exact as they stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sightline {
    pub from: DVec3,
    pub to: DVec3,
}

impl Sightline {
    /// Whether the line certainly passes between the ends of the portal on the plan, forwards, and
    /// strictly between bottom and top of its opening.
    pub fn clears(&self, vertices: &Vertices, gate: &Gate) -> bool {
        let error = vertices.error();
        let (p, q) = ((self.from.truncate(), 0.0), (self.to.truncate(), 0.0));
        let (left, right) = ((gate.left.at, error), (gate.right.at, error));
        let way = Span::new(p, q);
        if !way.cross(Span::new(p, left)).is_positive()
            || !way.cross(Span::new(p, right)).is_negative()
        {
            return false;
        }
        // How far the two points lie beyond the portal's line.
        let across = Span::new(left, right);
        let beyond = |point| across.cross(Span::new(left, point));
        let (at_from, at_to) = (beyond(p), beyond(q));
        let ahead = at_to - at_from;
        if !ahead.is_positive() {
            return false;
        }
        let (z, rise) = (
            Interval::point(self.from.z),
            Interval::point(self.to.z) - Interval::point(self.from.z),
        );
        let z = z + (-at_from).over_positive(ahead) * rise;
        gate.bottom < z.lo && z.hi < gate.top
    }

    /// The line from its other end.
    pub fn reversed(&self) -> Self {
        Self {
            from: self.to,
            to: self.from,
        }
    }

    /// Whether the line certainly starts inside the cell, on the plan.
    pub fn starts_inside(&self, graph: &CellGraph, cell: CellId) -> bool {
        let error = graph.vertices.error();
        let point = (self.from.truncate(), 0.0);
        let vertex = |v| (graph.vertices.approx(v), error);
        graph.edge_range(cell).map(EdgeId).all(|e| {
            let (p, q) = (vertex(graph.edge(e).origin), vertex(graph.end(e)));
            Span::new(p, q).cross(Span::new(p, point)).is_positive()
        })
    }
}
