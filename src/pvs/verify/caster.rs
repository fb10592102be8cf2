//! A third opinion on single pairs of cells, from the level's own walls: none of the code that finds
//! visible sets is used, and of the cells only their corners.
//!
//! Two questions are answered, both exactly. Is a given segment free? And does any segment join two
//! cells at all ([`super::pair`])?

use std::cmp::Ordering;

use dashu_int::IBig;

use super::pair;
use super::walls::{Stretch, Walls};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{GridPoint, Vertex};
use crate::level::{Level, WallKind};

/// An exact point of the plan `(x/w, y/w)` in grid steps, `w > 0`, with integers of any size.
pub type Place = [IBig; 3];

/// The walls of a level, and the cells that the questions are about.
pub struct Caster<'a> {
    graph: &'a CellGraph,
    walls: Walls,
    /// Edges of cells behind which the outside lies, without an opaque wall.
    outer: Vec<[Vertex; 2]>,
}

impl<'a> Caster<'a> {
    /// For cells of that level.
    pub fn new(level: &Level, graph: &'a CellGraph) -> Self {
        let is_outer = |e: &EdgeId| {
            let edge = graph.edge(*e);
            let kind = edge.wall().map(|w| &level.walls[w.0 as usize].kind);
            edge.twin().is_none() && !matches!(kind, Some(WallKind::Solid | WallKind::Outline))
        };
        let ends =
            |e: EdgeId| [graph.edge(e).origin, graph.end(e)].map(|v| *graph.vertices.exact(v));
        let edges = (0..graph.edges.len() as u32).map(EdgeId);
        Self {
            graph,
            walls: Walls::new(level, graph.options.doors),
            outer: edges.filter(is_outer).map(ends).collect(),
        }
    }

    /// Whether the segment leads from strictly inside the one cell to strictly inside the other, and
    /// touches nothing opaque between, not even the end of a wall.
    pub fn is_free(&self, [a, b]: [CellId; 2], from: &Place, to: &Place) -> bool {
        if !self.holds(a, from) || !self.holds(b, to) {
            return false;
        }
        let obstacles = self.obstacles(&[from, to].map(about));
        let free = |[p, q]: &[Vertex; 2]| !touch([from, to], [&place(p), &place(q)]);
        obstacles.iter().all(free)
    }

    /// Whether any straight line leads from inside the one cell to inside the other; `None` if there
    /// are too many walls about to find out.
    pub fn joined(&self, [a, b]: [CellId; 2]) -> Option<bool> {
        let [a, b] = [a, b].map(|cell| {
            let corners = self.graph.polygon(cell).into_iter();
            corners
                .map(|v| *self.graph.vertices.exact(v))
                .collect::<Vec<_>>()
        });
        let corners: Vec<_> = a.iter().chain(&b).map(|v| v.approx().to_array()).collect();
        pair::joined(&a, &b, &self.obstacles(&corners))
    }

    /// What is opaque near the box around some points.
    fn obstacles(&self, points: &[[f64; 2]]) -> Vec<[Vertex; 2]> {
        let bound = |axis: usize, choose: fn(f64, f64) -> f64| {
            let all = points.iter().map(|p| p[axis]);
            all.reduce(choose).unwrap_or_default()
        };
        // A step more each way than the rounded points need.
        let low = [0, 1].map(|axis| bound(axis, f64::min).floor() - 1.0);
        let high = [0, 1].map(|axis| bound(axis, f64::max).ceil() + 1.0);
        let grid = |[x, y]: [f64; 2]| GridPoint::new(x as i64, y as i64);
        let mut near = Vec::new();
        self.walls.opaque.near(grid(low), grid(high), &mut near);
        let ends = |s: &Stretch| [s.from.into(), s.to.into()];
        let walls = near
            .iter()
            .map(|&i| ends(&self.walls.opaque.list[i as usize]));
        walls.chain(self.outer.iter().copied()).collect()
    }

    /// Whether a point lies strictly inside a cell.
    fn holds(&self, cell: CellId, point: &Place) -> bool {
        let corners: Vec<Place> = self
            .graph
            .corners(cell)
            .map(|v| place(self.graph.vertices.exact(v)))
            .collect();
        (0..corners.len()).all(|i| {
            side(&corners[i], &corners[(i + 1) % corners.len()], point) == Ordering::Greater
        })
    }
}

/// A vertex as a point.
pub(super) fn place(v: &Vertex) -> Place {
    [v.x().into(), v.y().into(), v.w().into()]
}

fn about([x, y, w]: &Place) -> [f64; 2] {
    let float = |n: &IBig| n.to_f64().value();
    [float(x) / float(w), float(y) / float(w)]
}

/// `Greater` if `r` lies left of the line from `p` to `q`, `Less` if right.
fn side(p: &Place, q: &Place, r: &Place) -> Ordering {
    let minor = |i: usize, j: usize| &q[i] * &r[j] - &q[j] * &r[i];
    let determinant = &p[0] * minor(1, 2) - &p[1] * minor(0, 2) + &p[2] * minor(0, 1);
    determinant.cmp(&IBig::ZERO)
}

/// Whether two closed segments have a point in common.
fn touch([a, b]: [&Place; 2], [c, d]: [&Place; 2]) -> bool {
    let apart = |axis: usize| {
        let before = |p: &Place, q: &Place| &p[axis] * &q[2] < &q[axis] * &p[2];
        let all_before =
            |p: [&Place; 2], q: [&Place; 2]| p.iter().all(|p| q.iter().all(|q| before(p, q)));
        all_before([a, b], [c, d]) || all_before([c, d], [a, b])
    };
    let strictly = |p: Ordering, q: Ordering| p == q && p != Ordering::Equal;
    !apart(0)
        && !apart(1)
        && !strictly(side(a, b, c), side(a, b, d))
        && !strictly(side(c, d, a), side(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Doors, Locator, Options, subdivide};
    use crate::level::read::read;
    use glam::DVec2;

    #[test]
    fn doors_let_through_and_jambs_do_not() {
        let text = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
            [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
            [[door]]\npoints = [[4, 1], [4, 2]]\n";
        let level = read(text.into(), "rooms.toml", None).unwrap();
        let graph_with = |doors| {
            let options = Options {
                doors,
                ..Options::default()
            };
            subdivide(&level, &options)
        };
        let (open, closed) = (graph_with(Doors::Open), graph_with(Doors::Closed));
        let free = |graph: &CellGraph, a: (f64, f64), b: (f64, f64)| {
            let grid = |(x, y)| level.grid.nearest(DVec2::new(x, y)).unwrap();
            let locator = Locator::new(graph);
            let cells = [a, b].map(|p| locator.cell_at(graph, grid(p)).unwrap());
            let [a, b] = [a, b].map(|p| place(&grid(p).into()));
            let caster = Caster::new(&level, graph);
            assert!(caster.is_free(cells, &a, &b) <= caster.joined(cells).unwrap());
            caster.is_free(cells, &a, &b)
        };
        assert!(free(&open, (1.0, 1.5), (7.0, 1.5)));
        assert!(free(&open, (7.0, 1.5), (1.0, 1.5)));
        assert!(!free(&open, (1.0, 1.0), (7.0, 1.0)), "a jamb");
        assert!(free(&open, (1.0, 1.0001), (7.0, 1.0001)), "beside the jamb");
        assert!(!free(&open, (1.0, 3.0), (7.0, 3.0)), "the wall");
        assert!(free(&open, (1.0, 3.0), (3.9, 3.0)), "before the wall");
        assert!(!free(&closed, (1.0, 1.5), (7.0, 1.5)), "a closed door");
    }
}
