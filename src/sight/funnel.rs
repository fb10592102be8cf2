//! The lines that stab a chain of portals, kept exactly while the chain grows and shrinks.
//!
//! A line stabs the chain when it passes strictly between the two ends of every portal. In the
//! plane, those lines are bounded by two extreme ones: the counterclockwise-most, which touches a
//! right end first and a left end later, and the clockwise-most, which touches a left end first and
//! a right end later. What a new portal can still change is held by two hulls, of left and of right
//! ends, so that adding one takes amortised constant time, and undoing it constant time.

use glam::DVec2;

use crate::geom::{Side, VertexId, Vertices};

/// A directed line through two vertices.
#[derive(Clone, Copy, Debug)]
struct Through {
    from: VertexId,
    to: VertexId,
    origin: DVec2,
    d: DVec2,
}

impl Through {
    fn new(vertices: &Vertices, from: VertexId, to: VertexId) -> Self {
        let origin = vertices.approx(from);
        Self { from, to, origin, d: vertices.approx(to) - origin }
    }

    #[inline]
    fn side(&self, vertices: &Vertices, p: VertexId) -> Side {
        if p == self.from || p == self.to {
            return Side::On;
        }
        vertices.orient_from(self.from, self.to, self.d, p, vertices.approx(p) - self.origin)
    }
}

impl Through {
    /// Whether all stabbing lines near this extreme one leave `p` on the wanted side: it is strictly
    /// on that side, or on the line but before its second end. (Up to there the lines have not
    /// crossed the extreme one for good; the right end of a portal in line with it lies there.)
    #[inline]
    fn passes(&self, vertices: &Vertices, p: VertexId, wanted: Side) -> bool {
        match self.side(vertices, p) {
            Side::On => p != self.to && vertices.same_direction(self.to, self.from, p),
            side => side == wanted,
        }
    }
}

/// One side's ends that still matter, in the order of the chain. Bulges towards the lines; `start`
/// is the point that an extreme line touches.
#[derive(Clone, Debug, Default)]
struct Hull {
    points: Vec<VertexId>,
    start: usize,
    end: usize,
}

/// How to restore a hull after one push.
#[derive(Clone, Copy, Debug)]
struct HullUndo {
    start: usize,
    end: usize,
    overwritten: Option<(usize, VertexId)>,
}

impl Hull {
    fn reset(&mut self, p: VertexId) {
        self.points.clear();
        self.points.push(p);
        (self.start, self.end) = (0, 1);
    }

    fn state(&self) -> HullUndo {
        HullUndo { start: self.start, end: self.end, overwritten: None }
    }

    fn first(&self) -> VertexId {
        self.points[self.start]
    }

    /// Adds a point, dropping those before it that no longer bulge: a chain of left ends turns left
    /// at each of its points, one of right ends right.
    fn push(&mut self, vertices: &Vertices, p: VertexId, turn: Side, undo: &mut HullUndo) {
        if self.points[self.end - 1] == p {
            return;
        }
        while self.end - self.start >= 2
            && vertices.orient(self.points[self.end - 2], self.points[self.end - 1], p) != turn
        {
            self.end -= 1;
        }
        if self.end == self.points.len() {
            self.points.push(p);
        } else {
            undo.overwritten = Some((self.end, self.points[self.end]));
            self.points[self.end] = p;
        }
        self.end += 1;
    }

    /// Moves `start` to the point in which the line from the hull to `p` touches it; `beyond` is the
    /// side of that line on which no point of the hull may lie.
    fn touch(&mut self, vertices: &Vertices, p: VertexId, beyond: Side) {
        while self.start + 1 < self.end {
            let (a, b) = (self.points[self.start], self.points[self.start + 1]);
            let side = vertices.orient(a, p, b);
            if side != beyond && side != Side::On {
                break;
            }
            self.start += 1;
        }
    }

    fn restore(&mut self, undo: &HullUndo) {
        (self.start, self.end) = (undo.start, undo.end);
        if let Some((i, p)) = undo.overwritten {
            self.points[i] = p;
        }
    }
}

/// How to take the last portal off a [`Funnel`].
#[derive(Clone, Copy, Debug)]
pub struct Undo {
    left: HullUndo,
    right: HullUndo,
    lines: Option<(Through, Through)>,
}

/// A vertex as the two extreme lines see it.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Strictly right of the counterclockwise-most line: some stabbing line passes left of it.
    pub inside_left: bool,
    /// Strictly left of the clockwise-most line: some stabbing line passes right of it.
    pub inside_right: bool,
}

/// The stabbing lines of a chain of at least one portal.
#[derive(Clone, Debug, Default)]
pub struct Funnel {
    left: Hull,
    right: Hull,
    /// The counterclockwise-most and the clockwise-most stabbing line, from two portals on.
    lines: Option<(Through, Through)>,
}

impl Funnel {
    /// Starts a chain with the portal from `right` to `left`, as seen along the chain.
    pub fn begin(&mut self, left: VertexId, right: VertexId) {
        self.left.reset(left);
        self.right.reset(right);
        self.lines = None;
    }

    /// A vertex beyond the last portal, as the extreme lines see it. With one portal in the chain,
    /// what counts is whether it lies strictly beyond the portal's line.
    #[inline]
    pub fn seen(&self, vertices: &Vertices, p: VertexId) -> Seen {
        match &self.lines {
            Some((ccw, cw)) => Seen {
                inside_left: ccw.passes(vertices, p, Side::Right),
                inside_right: cw.passes(vertices, p, Side::Left),
            },
            None => Seen { inside_left: true, inside_right: true },
        }
    }

    /// Adds a portal in the same cell as the last one, its ends with how they are seen; `None` if no
    /// line stabs the longer chain, which then stays as it was.
    #[inline]
    pub fn extend(
        &mut self,
        vertices: &Vertices,
        left: (VertexId, Seen),
        right: (VertexId, Seen),
    ) -> Option<Undo> {
        let ((left, left_seen), (right, right_seen)) = (left, right);
        if !left_seen.inside_right || !right_seen.inside_left {
            return None;
        }
        let mut undo =
            Undo { left: self.left.state(), right: self.right.state(), lines: self.lines };
        let Some((ccw, cw)) = self.lines else {
            // Two portals of one convex cell: unless they lie in line, every pair of inner points
            // is a stabbing line.
            let (first_right, first_left) = (self.right.first(), self.left.first());
            let beyond = |p| vertices.orient(first_right, first_left, p) != Side::On;
            if !beyond(left) && !beyond(right) {
                return None;
            }
            self.lines = Some((
                Through::new(vertices, first_right, left),
                Through::new(vertices, first_left, right),
            ));
            self.left.push(vertices, left, Side::Left, &mut undo.left);
            self.right.push(vertices, right, Side::Right, &mut undo.right);
            return Some(undo);
        };
        let (mut new_ccw, mut new_cw) = (ccw, cw);
        if left_seen.inside_left {
            self.right.touch(vertices, left, Side::Left);
            new_ccw = Through::new(vertices, self.right.first(), left);
        }
        if right_seen.inside_right {
            self.left.touch(vertices, right, Side::Right);
            new_cw = Through::new(vertices, self.left.first(), right);
        }
        if left_seen.inside_left {
            self.left.push(vertices, left, Side::Left, &mut undo.left);
        }
        if right_seen.inside_right {
            self.right.push(vertices, right, Side::Right, &mut undo.right);
        }
        self.lines = Some((new_ccw, new_cw));
        Some(undo)
    }

    /// Takes the last portal off the chain. Undo in the reverse order of extending.
    pub fn undo(&mut self, undo: &Undo) {
        self.left.restore(&undo.left);
        self.right.restore(&undo.right);
        self.lines = undo.lines;
    }
}
