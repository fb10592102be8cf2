//! The visible area: of each piece, and as a whole. Which edges and rays meet is exact; where they
//! do is in f64.

use glam::DVec2;

use super::walk::{first_met, origin, previous};
use super::{OWN, Piece, Stretch, Vista, Wedge};
use crate::geom::Placed;
use crate::geom::pencil::{Aim, PackedAim};

impl Vista<'_> {
    /// The visible part of a cell in one wedge: a convex polygon, counterclockwise, in grid steps.
    /// Replaces the contents of `corners`.
    ///
    /// A corner is a vertex, the eye, or the meeting of an edge and a ray; such a meeting is off
    /// the truth by a few last bits of the coordinates, and at most by a further 2^-32 of the
    /// edge's length, along the edge.
    pub fn polygon(&self, piece: &Piece, corners: &mut Vec<DVec2>) {
        corners.clear();
        let Wedge { low, high } = piece.wedge;
        if piece.entry == OWN {
            let starts = &self.found.starts;
            // A run of them: from the first of the cell that begins in `low`.
            let begins = |i: &usize| {
                self.mesh.edge(starts[*i].edge).cell == piece.cell.0 && starts[*i].wedge.low == low
            };
            let first = (0..starts.len())
                .find(begins)
                .expect("a piece has its edges");
            if low != high {
                corners.push(self.pencil.at());
            }
            for start in &starts[first..] {
                push(corners, self.meet(start.wedge.low, start.edge));
                push(corners, self.meet(start.wedge.high, start.edge));
                if start.wedge.high == high {
                    break;
                }
            }
        } else {
            let entry = piece.entry;
            let [low_ray, high_ray] = [low, high].map(|aim| self.pencil.unpack(aim));
            let before_high = |p: &Placed| self.pencil.is_left(&self.pencil.ray(p), &high_ray);
            // The far side, from the first ray to the last.
            let mut e = first_met(self.mesh, &self.pencil, entry, &low_ray);
            corners.push(self.meet(low, entry));
            corners.push(self.meet(low, e));
            while before_high(&self.mesh.edge(e).end) {
                corners.push(self.mesh.edge(e).end.at);
                e = self.mesh.edge(e).next(e);
            }
            corners.push(self.meet(high, e));
            // The near side, found from the first ray to the last, and wanted the other way round.
            let near = corners.len();
            let mut e = entry;
            while before_high(&origin(self.mesh, e)) {
                corners.push(origin(self.mesh, e).at);
                e = previous(self.mesh, e);
            }
            corners.push(self.meet(high, e));
            corners[near..].reverse();
            corners.dedup();
        }
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
    }

    /// The outline of all that is seen, counterclockwise, in grid steps: every point of it is seen
    /// from the eye. It passes through the eye unless that looks all around. Replaces the contents
    /// of `corners`. See [`Vista::polygon`] for the rounding.
    pub fn outline(&self, corners: &mut Vec<DVec2>) {
        corners.clear();
        let walls = &self.found.walls;
        for (i, wall) in walls.iter().enumerate() {
            let before = &walls[if i == 0 { walls.len() } else { i } - 1];
            let joined = self.joined(before.wedge.high, wall.wedge.low);
            // Where the wall only goes on, there is no corner.
            if joined && before.edge == wall.edge {
                continue;
            }
            push(corners, self.meet(before.wedge.high, before.edge));
            if !joined {
                push(corners, self.pencil.at());
            }
            push(corners, self.meet(wall.wedge.low, wall.edge));
        }
        if corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
    }

    /// The area of all that is seen, in square grid steps.
    pub fn area(&self) -> f64 {
        let triangle = |wall: &Stretch| {
            let [low, high] =
                [wall.wedge.low, wall.wedge.high].map(|aim| self.meet_from_eye(aim, wall.edge));
            low.perp_dot(high) / 2.0
        };
        self.found.walls.iter().map(triangle).sum()
    }

    /// Whether a wedge starts where another ends.
    fn joined(&self, high: PackedAim, low: PackedAim) -> bool {
        high == low
            || self
                .pencil
                .same(&self.pencil.unpack(high), &self.pencil.unpack(low))
    }

    /// Where a ray meets an edge. The edge's ends lie on different sides of the ray, or one on it.
    fn meet(&self, aim: PackedAim, edge: u32) -> DVec2 {
        let (from, to) = (origin(self.mesh, edge), self.mesh.edge(edge).end);
        match aim.unpack() {
            Aim::Vertex(v) if v == from.id => from.at,
            Aim::Vertex(v) if v == to.id => to.at,
            _ => from.at + (to.at - from.at) * self.share(aim, [from, to]),
        }
    }

    /// As [`Vista::meet`], but from the eye, with less rounding where that is near.
    fn meet_from_eye(&self, aim: PackedAim, edge: u32) -> DVec2 {
        let (from, to) = (origin(self.mesh, edge), self.mesh.edge(edge).end);
        let [a, b] = [from, to].map(|end| self.pencil.ray(&end).d);
        match aim.unpack() {
            Aim::Vertex(v) if v == from.id => a,
            Aim::Vertex(v) if v == to.id => b,
            _ => a + (b - a) * self.share(aim, [from, to]),
        }
    }

    /// How far along an edge a ray meets it, as a share of its length.
    fn share(&self, aim: PackedAim, edge: [Placed; 2]) -> f64 {
        // In proportion to the ends' distances from the ray: nothing cancels.
        let ray = self.pencil.unpack(aim);
        let [a, b] = edge.map(|end| self.pencil.cross(&ray, &self.pencil.ray(&end)).abs());
        a / (a + b)
    }
}

fn push(corners: &mut Vec<DVec2>, p: DVec2) {
    if corners.last() != Some(&p) {
        corners.push(p);
    }
}

/// The area of a polygon, positive if its corners go counterclockwise.
pub fn area(corners: &[DVec2]) -> f64 {
    let Some(&first) = corners.first() else {
        return 0.0;
    };
    let triangles = corners.windows(2).skip(1);
    triangles
        .map(|w| (w[0] - first).perp_dot(w[1] - first))
        .sum::<f64>()
        / 2.0
}
