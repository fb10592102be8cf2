//! The lines that stab a chain of portals, kept exactly while the chain grows and shrinks.
//!
//! A line stabs the chain when it passes strictly between the two ends of every portal. In the
//! plane, those lines are bounded by two extreme ones: the counterclockwise-most, which touches a
//! right end first and a left end later, and the clockwise-most, which touches a left end first and
//! a right end later. What a new portal can still change is held by two hulls, of left and of right
//! ends, so that adding one takes amortised constant time, and undoing it constant time.

use super::Gate;
use crate::geom::{Placed, Side, Vertices};

/// A directed line through two vertices.
#[derive(Clone, Copy, Debug)]
struct Through {
    from: Placed,
    to: Placed,
}

impl Through {
    /// Whether all stabbing lines near this extreme one leave `p` on the wanted side: it is strictly
    /// on that side, or on the line but before its second end. (Up to there the lines have not
    /// crossed the extreme one for good; the right end of a portal in line with it lies there.)
    #[inline]
    fn passes(&self, vertices: &Vertices, p: &Placed, wanted: Side) -> bool {
        match vertices.side(&self.from, &self.to, p) {
            Side::On => {
                p.id != self.to.id && vertices.same_direction(self.to.id, self.from.id, p.id)
            }
            side => side == wanted,
        }
    }
}

/// One side's ends that still matter, in the order of the chain. Bulges towards the lines; `start`
/// is the point that an extreme line touches.
#[derive(Clone, Debug, Default)]
struct Hull {
    points: Vec<Placed>,
    start: u32,
    end: u32,
}

/// How to restore a hull after one push.
#[derive(Clone, Copy, Debug)]
struct HullUndo {
    start: u32,
    end: u32,
    /// Where the point was put, and what stood there; `u32::MAX` if nothing did.
    position: u32,
    overwritten: Placed,
}

impl Hull {
    fn reset(&mut self, p: Placed) {
        self.points.clear();
        self.points.push(p);
        (self.start, self.end) = (0, 1);
    }

    fn state(&self) -> HullUndo {
        HullUndo {
            start: self.start,
            end: self.end,
            position: u32::MAX,
            overwritten: self.points[0],
        }
    }

    fn bounds(&self) -> &[Placed] {
        &self.points[self.start as usize..self.end as usize]
    }

    fn first(&self) -> Placed {
        self.points[self.start as usize]
    }

    /// Adds a point, dropping those before it that no longer bulge: a chain of left ends turns left
    /// at each of its points, one of right ends right.
    fn push(&mut self, vertices: &Vertices, p: Placed, turn: Side, undo: &mut HullUndo) {
        let mut end = self.end as usize;
        if self.points[end - 1].id == p.id {
            return;
        }
        while end - self.start as usize >= 2
            && vertices.side(&self.points[end - 2], &self.points[end - 1], &p) != turn
        {
            end -= 1;
        }
        if end == self.points.len() {
            self.points.push(p);
        } else {
            (undo.position, undo.overwritten) = (end as u32, self.points[end]);
            self.points[end] = p;
        }
        self.end = end as u32 + 1;
    }

    /// As [`Hull::push`], but what it drops is gone.
    #[inline]
    fn push_for_good(&mut self, vertices: &Vertices, p: Placed, turn: Side) {
        if self.points[self.end as usize - 1].id == p.id {
            return;
        }
        while let [.., a, b] = self.bounds()
            && vertices.side(a, b, &p) != turn
        {
            self.end -= 1;
        }
        self.points.truncate(self.end as usize);
        self.points.push(p);
        self.end += 1;
    }

    /// Moves `start` to the point in which the line from the hull to `p` touches it; `beyond` is the
    /// side of that line on which no point of the hull may lie.
    fn touch(&mut self, vertices: &Vertices, p: Placed, beyond: Side) {
        while self.start + 1 < self.end {
            let start = self.start as usize;
            let (a, b) = (&self.points[start], &self.points[start + 1]);
            let side = vertices.side(a, &p, b);
            if side != beyond && side != Side::On {
                break;
            }
            self.start += 1;
        }
    }

    /// The lines along the hull, the last one first.
    fn edges(&self) -> impl Iterator<Item = [Placed; 2]> + '_ {
        let points = &self.points[self.start as usize..self.end as usize];
        points.windows(2).rev().map(|w| [w[0], w[1]])
    }

    fn restore(&mut self, undo: &HullUndo) {
        (self.start, self.end) = (undo.start, undo.end);
        if undo.position != u32::MAX {
            self.points[undo.position as usize] = undo.overwritten;
        }
    }
}

/// How to take the last portal off a [`Funnel`].
#[derive(Clone, Copy, Debug)]
pub struct Undo {
    left: HullUndo,
    right: HullUndo,
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
    /// The counterclockwise-most and the clockwise-most stabbing line of the chain's first two
    /// portals, of its first three, and so on.
    lines: Vec<(Through, Through)>,
}

impl Seen {
    const WITHIN: Seen = Seen {
        inside_left: true,
        inside_right: true,
    };
}

impl Funnel {
    /// Starts a chain with the portal from `right` to `left`, as seen along the chain.
    pub fn begin(&mut self, left: Placed, right: Placed) {
        self.left.reset(left);
        self.right.reset(right);
        self.lines.clear();
    }

    /// The next vertex counterclockwise of the cell beyond the last portal, as the extreme lines see
    /// it. Starting in the portal's right end, the vertices come first right of both lines, then
    /// between them, then left of both; so the one before tells which line to ask. With one portal
    /// in the chain, there are no lines yet, and all is within.
    #[inline]
    pub fn next_seen(&self, vertices: &Vertices, before: Seen, p: &Placed) -> Seen {
        let Some((ccw, cw)) = self.lines.last() else {
            return Seen::WITHIN;
        };
        if !before.inside_right && !cw.passes(vertices, p, Side::Left) {
            return before;
        }
        Seen {
            inside_left: ccw.passes(vertices, p, Side::Right),
            inside_right: true,
        }
    }

    /// The right end of the last portal, as the extreme lines see it.
    pub fn right_end_seen(&self) -> Seen {
        // The clockwise-most line touches it, or passes left of it.
        Seen {
            inside_left: true,
            inside_right: self.lines.is_empty(),
        }
    }

    /// Whether a portal in the cell beyond the last one lets all stabbing lines through and touches
    /// none: then adding it changes nothing, and no further edge of the cell meets any.
    #[inline]
    pub fn passes_all(&self, left: Seen, right: Seen) -> bool {
        right.inside_left && !right.inside_right && left.inside_right && !left.inside_left
    }

    /// Adds a portal in the same cell as the last one, its ends with how they are seen; `None` if no
    /// line stabs the longer chain, which then stays as it was.
    #[inline]
    pub fn extend(
        &mut self,
        vertices: &Vertices,
        left: (Placed, Seen),
        right: (Placed, Seen),
    ) -> Option<Undo> {
        let ((left, left_seen), (right, right_seen)) = (left, right);
        if !left_seen.inside_right || !right_seen.inside_left {
            return None;
        }
        let mut undo = Undo {
            left: self.left.state(),
            right: self.right.state(),
        };
        let Some(&(ccw, cw)) = self.lines.last() else {
            // Two portals of one convex cell: unless they lie in line, every pair of inner points
            // is a stabbing line.
            let (first_right, first_left) = (self.right.first(), self.left.first());
            let beyond = |p| vertices.side(&first_right, &first_left, p) != Side::On;
            if !beyond(&left) && !beyond(&right) {
                return None;
            }
            self.lines.push((
                Through {
                    from: first_right,
                    to: left,
                },
                Through {
                    from: first_left,
                    to: right,
                },
            ));
            self.left.push(vertices, left, Side::Left, &mut undo.left);
            self.right
                .push(vertices, right, Side::Right, &mut undo.right);
            return Some(undo);
        };
        self.lines.push((ccw, cw));
        let left = left_seen.inside_left.then_some(left);
        let right = right_seen.inside_right.then_some(right);
        self.tighten(vertices, left, right, &mut undo);
        Some(undo)
    }

    /// Lets a portal's ends that lie within the stabbing lines bound them.
    #[inline]
    fn tighten(
        &mut self,
        vertices: &Vertices,
        left: Option<Placed>,
        right: Option<Placed>,
        undo: &mut Undo,
    ) {
        let Some((ccw, cw)) = self.lines.last_mut() else {
            return;
        };
        if let Some(left) = left {
            self.right.touch(vertices, left, Side::Left);
            let from = self.right.first();
            *ccw = Through { from, to: left };
        }
        if let Some(right) = right {
            self.left.touch(vertices, right, Side::Right);
            let from = self.left.first();
            *cw = Through { from, to: right };
        }
        if let Some(left) = left {
            self.left.push(vertices, left, Side::Left, &mut undo.left);
        }
        if let Some(right) = right {
            self.right
                .push(vertices, right, Side::Right, &mut undo.right);
        }
    }

    /// As [`Funnel::extend`], for who does not walk around the cell between the last portal, `last`,
    /// and the new one, of which the left and the right end are given.
    pub fn extend_past(
        &mut self,
        vertices: &Vertices,
        last: Gate,
        ends: [Placed; 2],
    ) -> Option<Undo> {
        let [left, right] = ends;
        let start = self.right_end_seen();
        let right_seen = if right.id == last.right {
            start
        } else {
            self.next_seen(vertices, start, &right)
        };
        let left_seen = if left.id == last.left {
            // It bounds the lines already.
            Seen {
                inside_left: self.lines.is_empty(),
                inside_right: true,
            }
        } else {
            self.next_seen(vertices, right_seen, &left)
        };
        self.extend(vertices, (left, left_seen), (right, right_seen))
    }

    /// Adds the second portal, not to be undone; two portals of one convex cell.
    #[inline]
    fn second(&mut self, vertices: &Vertices, [left, right]: [Placed; 2]) -> bool {
        let (first_left, first_right) = (self.left.first(), self.right.first());
        let in_line = |p| vertices.side(&first_right, &first_left, p) == Side::On;
        if in_line(&left) && in_line(&right) {
            return false;
        }
        let through = |from, to| Through { from, to };
        self.lines
            .push((through(first_right, left), through(first_left, right)));
        self.left.push_for_good(vertices, left, Side::Left);
        self.right.push_for_good(vertices, right, Side::Right);
        true
    }

    /// As [`Funnel::extend_past`], but not to be undone, nor may what was added before be undone any
    /// more. Whether the portal fits.
    #[inline]
    pub fn narrow(&mut self, vertices: &Vertices, last: Gate, [left, right]: [Placed; 2]) -> bool {
        let Some((ccw, cw)) = self.lines.last_mut() else {
            return self.second(vertices, [left, right]);
        };
        // As in `next_seen`: the right end comes first, and ends of the last portal bound the lines
        // already.
        let tighter_right = right.id != last.right && cw.passes(vertices, &right, Side::Left);
        if tighter_right && !ccw.passes(vertices, &right, Side::Right) {
            return false;
        }
        let mut tighter_left = false;
        if left.id != last.left {
            if !tighter_right && !cw.passes(vertices, &left, Side::Left) {
                return false;
            }
            tighter_left = ccw.passes(vertices, &left, Side::Right);
        }
        if tighter_left {
            self.right.touch(vertices, left, Side::Left);
            let from = self.right.first();
            *ccw = Through { from, to: left };
        }
        if tighter_right {
            self.left.touch(vertices, right, Side::Right);
            let from = self.left.first();
            *cw = Through { from, to: right };
            self.right.push_for_good(vertices, right, Side::Right);
        }
        if tighter_left {
            self.left.push_for_good(vertices, left, Side::Left);
        }
        true
    }

    /// The left ends that bound the stabbing lines, in the order of the chain: from the one that the
    /// clockwise-most line touches to the one that the counterclockwise-most touches. The line
    /// through them turns left in each.
    pub fn left_bounds(&self) -> &[Placed] {
        self.left.bounds()
    }

    /// The right ends that bound the stabbing lines, in the order of the chain: from the one that the
    /// counterclockwise-most line touches to the one that the clockwise-most touches. The line
    /// through them turns right in each.
    pub fn right_bounds(&self) -> &[Placed] {
        self.right.bounds()
    }

    /// Adds any portal that follows in the chain, wherever it was met; `None` as for
    /// [`Funnel::extend`].
    pub fn push(&mut self, vertices: &Vertices, left: Placed, right: Placed) -> Option<Undo> {
        let lines = self.lines.last().copied();
        let seen = |p: &Placed| match &lines {
            None => Seen::WITHIN,
            Some((ccw, cw)) => Seen {
                inside_left: ccw.passes(vertices, p, Side::Right),
                inside_right: cw.passes(vertices, p, Side::Left),
            },
        };
        self.extend(vertices, (left, seen(&left)), (right, seen(&right)))
    }

    /// Whether all stabbing lines lead left (towards smaller x) by at least a grid step between the
    /// vertices that bound them; never true without being certain, as copies are off by far less.
    #[inline]
    pub fn leads_left(&self) -> bool {
        let left = |line: &Through| line.to.at.x - line.from.at.x <= -1.0;
        self.lines
            .last()
            .is_some_and(|(ccw, cw)| left(ccw) && left(cw))
    }

    /// The lines that bound the stabbing lines of a chain of at least two portals: each touches a left
    /// or right end and, later on its way, another one. In the space of lines they are the corners
    /// of a convex polygon, at least three; every stabbing line is a sum of them with positive
    /// weights. In order around it.
    pub fn corners(&self) -> impl Iterator<Item = [Placed; 2]> + '_ {
        let extreme = |line: &Through| [line.from, line.to];
        let (ccw, cw) = self.lines.last().map_or((None, None), |(ccw, cw)| {
            (Some(extreme(ccw)), Some(extreme(cw)))
        });
        let left = ccw.into_iter().chain(self.left.edges());
        left.chain(cw).chain(self.right.edges())
    }

    /// Takes the last portal off the chain. Undo in the reverse order of extending.
    pub fn undo(&mut self, undo: &Undo) {
        self.left.restore(&undo.left);
        self.right.restore(&undo.right);
        self.lines.pop();
    }
}
