//! How far one can see: the longest free lines of a level, and the farthest point from each cell.
//!
//! In: a graph. Out: the longest straight line through each group of cells about a vertex, and of each
//! cell the farthest point seen from one of its corners. Both are limits: lines as near to them as one
//! likes are free, they themselves may touch corners.
//!
//! Why vertices are enough. A free line between two walls that touches no vertex can be turned about
//! any of its points, and its length is a convex function of the angle: it does not shrink in one of
//! the two directions, until the line meets a vertex. So one of the longest passes through a wall's
//! end, or starts in a corner; and about that vertex, it is longest at one end of an interval of
//! directions that lead to the same two walls. Which walls those are, and which intervals lie opposite
//! to each other, is decided exactly; only lengths are f64.

use glam::DVec2;
use rayon::prelude::*;

use super::fan::Ray;
use super::flat::{FlatMesh, WALL};
use super::sweep::{Group, Plan, Span, grouped};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Side, VertexId};

/// A straight line that is free but for its ends and the corners that it touches; in grid steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Where it starts.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
    /// The cells in which it starts and ends.
    pub cells: [CellId; 2],
}

impl Line {
    /// Its length in grid steps.
    pub fn length(&self) -> f64 {
        self.from.distance(self.to)
    }
}

/// How far one sees in a level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Longest {
    /// The longest line through every group of cells about a vertex, longest first.
    pub lines: Vec<Line>,
    /// Of each cell, the line from one of its corners to the farthest point seen from there.
    pub from_cell: Vec<Option<Line>>,
}

/// Directions about a vertex that lead to the same wall: an open interval, counterclockwise.
#[derive(Clone, Copy)]
struct Stretch {
    low: Ray,
    high: Ray,
    wall: EdgeId,
    /// Through which cell of the group, counted counterclockwise.
    base: usize,
}

/// The longest lines. Uses the current rayon thread pool; the result does not depend on its size.
pub fn longest(graph: &CellGraph) -> Longest {
    let plan = grouped(graph);
    let mesh = FlatMesh::new(graph);
    let (lines, farthest): (Vec<Option<Line>>, Vec<Vec<Line>>) = plan
        .groups
        .par_iter()
        .with_min_len(16)
        .map_init(Vec::new, |stretches, group| {
            let fan = Fan {
                graph,
                mesh: &mesh,
                vertex: group.vertex,
                bases: bases(&plan, group),
            };
            fan.walls(stretches);
            match group.span {
                Span::Simple => fan.line_from(stretches),
                _ => (fan.longest(stretches), fan.farthest(stretches)),
            }
        })
        .unzip();
    let mut from_cell: Vec<Option<Line>> = vec![None; graph.cells.len()];
    for line in farthest.into_iter().flatten() {
        let best = &mut from_cell[line.cells[0].0 as usize];
        if best.is_none_or(|old| old.length() < line.length()) {
            *best = Some(line);
        }
    }
    let mut lines: Vec<Line> = lines.into_iter().flatten().collect();
    lines.sort_by(|a, b| b.length().total_cmp(&a.length()));
    Longest { lines, from_cell }
}

fn bases<'a>(plan: &'a Plan, group: &Group) -> &'a [EdgeId] {
    &plan.bases[group.first as usize..group.end as usize]
}

/// The cells about a vertex.
struct Fan<'a> {
    graph: &'a CellGraph,
    mesh: &'a FlatMesh<'a>,
    vertex: VertexId,
    bases: &'a [EdgeId],
}

impl Fan<'_> {
    fn origin(&self) -> DVec2 {
        self.graph.vertices.approx(self.vertex)
    }

    fn ray(&self, to: VertexId) -> Ray {
        let d = self.graph.vertices.approx(to) - self.origin();
        Ray { to, d }
    }

    fn side(&self, p: &Ray, q: &Ray) -> Side {
        let vertices = &self.graph.vertices;
        vertices.orient_from(self.vertex, p.to, p.d, q.to, q.d)
    }

    fn is_left(&self, p: &Ray, q: &Ray) -> bool {
        self.side(p, q) == Side::Left
    }

    /// The walls seen from the vertex, counterclockwise.
    fn walls(&self, stretches: &mut Vec<Stretch>) {
        stretches.clear();
        let mut open: Vec<(u32, Ray, Ray)> = Vec::new();
        for (base, &first) in self.bases.iter().enumerate() {
            let last = self.graph.previous(first);
            let mut from = self.ray(self.graph.end(first));
            let mut e = self.graph.next(first);
            while e != last {
                let to = self.ray(self.graph.end(e));
                if self.is_left(&from, &to) {
                    match self.mesh.edge(e.0).twin {
                        WALL => stretches.push(Stretch {
                            low: from,
                            high: to,
                            wall: e,
                            base,
                        }),
                        twin => {
                            open.push((twin, from, to));
                            self.beyond(&mut open, base, stretches);
                        }
                    }
                }
                from = to;
                e = self.graph.next(e);
            }
        }
    }

    /// The walls seen through portals, each given by the edge of the cell beyond and the directions
    /// that lead through it. (A wall that was met is put off as its own edge, to keep the order.)
    fn beyond(&self, open: &mut Vec<(u32, Ray, Ray)>, base: usize, stretches: &mut Vec<Stretch>) {
        const MET: u32 = 1 << 31;
        while let Some((entry, low, high)) = open.pop() {
            if entry & MET != 0 {
                let wall = EdgeId(entry & !MET);
                stretches.push(Stretch {
                    low,
                    high,
                    wall,
                    base,
                });
                continue;
            }
            let children = open.len();
            let mut e = self.mesh.edge(entry).next(entry);
            let mut end = self.ray(self.mesh.edge(e).end.id);
            // First come edges wholly right of the interval.
            while !self.is_left(&low, &end) {
                e = self.mesh.edge(entry).next(e);
                end = self.ray(self.mesh.edge(e).end.id);
            }
            let mut from = low;
            loop {
                let inside = self.is_left(&end, &high);
                let to = if inside { end } else { high };
                match self.mesh.edge(e).twin {
                    WALL => open.push((e | MET, from, to)),
                    twin => open.push((twin, from, to)),
                }
                if !inside {
                    break;
                }
                from = to;
                e = self.mesh.edge(entry).next(e);
                end = self.ray(self.mesh.edge(e).end.id);
            }
            open[children..].reverse();
        }
    }

    /// Where a ray, turned about by a half turn if `back`, meets the line of a stretch's wall.
    fn hit(&self, stretch: &Stretch, ray: &Ray, back: bool) -> DVec2 {
        let [p, q] = [
            self.graph.edge(stretch.wall).origin,
            self.graph.end(stretch.wall),
        ];
        if !back && (ray.to == p || ray.to == q) {
            return self.graph.vertices.approx(ray.to);
        }
        let origin = self.origin();
        let [p, q] = [p, q].map(|v| self.graph.vertices.approx(v) - origin);
        let along = q - p;
        // The wall is met strictly inside of an interval, so it does not lie along the ray.
        let t = p.perp_dot(along) / ray.d.perp_dot(along);
        // Rounding may take the point past the wall's ends; between them it is.
        let s = (ray.d * t - p).dot(along) / along.length_squared();
        origin + p + along * s.clamp(0.0, 1.0)
    }

    fn cell_of(&self, e: EdgeId) -> CellId {
        self.graph.edge(e).cell
    }

    /// In a group of at most a half turn: the longest line from the vertex, which all its cells see.
    fn line_from(&self, stretches: &[Stretch]) -> (Option<Line>, Vec<Line>) {
        let origin = self.origin();
        let ends = stretches.iter().flat_map(|s| {
            let hit = |ray| (self.hit(s, ray, false), s);
            [hit(&s.low), hit(&s.high)]
        });
        let far = |p: &DVec2| p.distance_squared(origin);
        let Some((to, s)) = ends.max_by(|a, b| far(&a.0).total_cmp(&far(&b.0))) else {
            return (None, Vec::new());
        };
        let line = |&base: &EdgeId| Line {
            from: origin,
            to,
            cells: [self.cell_of(base), self.cell_of(s.wall)],
        };
        let lines = self.bases.iter().map(line).collect();
        (Some(line(&self.bases[s.base])), lines)
    }

    /// The longest line through the vertex.
    fn longest(&self, stretches: &[Stretch]) -> Option<Line> {
        let mut best: Option<Line> = None;
        let mut offer = |from: (DVec2, CellId), to: (DVec2, CellId)| {
            let line = Line {
                from: from.0,
                to: to.0,
                cells: [from.1, to.1],
            };
            if best.is_none_or(|old| old.length() < line.length()) {
                best = Some(line);
            }
        };
        let mut first = 0;
        for (i, s) in stretches.iter().enumerate() {
            first = first.max(i);
            // The opposite of t begins and ends inside of s, or around it.
            let later = |t: &Stretch| self.side(&s.low, &t.high) == Side::Right;
            while first < stretches.len() && !later(&stretches[first]) {
                first += 1;
            }
            let overlapping = |t: &&Stretch| self.side(&t.low, &s.high) == Side::Right;
            for t in stretches[first..].iter().take_while(overlapping) {
                let low_is_own = self.side(&s.low, &t.low) != Side::Right;
                let high_is_own = self.side(&s.high, &t.high) != Side::Left;
                for (own, [mine, others]) in [
                    (low_is_own, [&s.low, &t.low]),
                    (high_is_own, [&s.high, &t.high]),
                ] {
                    let ray = if own { mine } else { others };
                    let here = (self.hit(s, ray, !own), self.cell_of(s.wall));
                    let there = (self.hit(t, ray, own), self.cell_of(t.wall));
                    offer(here, there);
                }
            }
        }
        best
    }

    /// For every cell of a wide group, the farthest point that it sees from near the vertex.
    fn farthest(&self, stretches: &[Stretch]) -> Vec<Line> {
        let mut far: Vec<(f64, &Stretch, &Ray, DVec2)> = Vec::with_capacity(2 * stretches.len());
        for s in stretches {
            for ray in [&s.low, &s.high] {
                let to = self.hit(s, ray, false);
                far.push((to.distance_squared(self.origin()), s, ray, to));
            }
        }
        let mut lines = Vec::with_capacity(self.bases.len());
        let mut line = |base: EdgeId, (_, s, _, to): &(f64, &Stretch, &Ray, DVec2)| {
            lines.push(Line {
                from: self.origin(),
                to: *to,
                cells: [self.cell_of(base), self.cell_of(s.wall)],
            });
        };
        far.sort_by(|a, b| b.0.total_cmp(&a.0));
        let vertices = &self.graph.vertices;
        let within = |p: &Ray, q: &Ray| match self.side(p, q) {
            Side::Left => true,
            Side::On => vertices.same_direction(self.vertex, p.to, q.to),
            Side::Right => false,
        };
        for (i, &base) in self.bases.iter().enumerate() {
            let first = self.ray(self.graph.end(base));
            let last = self.ray(self.graph.edge(self.graph.previous(base)).origin);
            // Less than a half turn from the cell's own angle.
            let seen = far.iter().find(|(_, s, ray, _)| match s.base.cmp(&i) {
                std::cmp::Ordering::Less => within(ray, &first),
                std::cmp::Ordering::Equal => true,
                std::cmp::Ordering::Greater => within(&last, ray),
            });
            if let Some(seen) = seen {
                line(base, seen);
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::cells::{Locator, Options, Subdivision, subdivide};
    use crate::geom::GridPoint;
    use crate::level::toml;
    use crate::pvs::explain::{Straight, straight};
    use crate::pvs::{Progress, sweep::sweep};

    fn graph(text: &str, subdivision: Subdivision) -> CellGraph {
        let options = Options {
            subdivision,
            ..Options::default()
        };
        subdivide(&toml::read(text, "test.toml").unwrap(), &options)
    }

    fn longest_in(text: &str) -> f64 {
        let lengths = Subdivision::ALL.map(|subdivision| {
            let graph = graph(text, subdivision);
            let best = longest(&graph).lines[0];
            graph.grid.step.to_units(best.length())
        });
        assert!(
            lengths.iter().all(|l| (l - lengths[0]).abs() < 1e-9 * l),
            "{lengths:?}"
        );
        lengths[0]
    }

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 10, 4]\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";

    #[test]
    fn known_lengths() {
        let room = "[[room]]\nname = \"A\"\nrect = [0, 0, 3, 4]\n";
        assert_eq!(longest_in(room), 5.0);
        // The diagonal from (0, 0) to (10, 4) is at height 1.6 where it passes the door from (4, 1.5) to
        // (4, 2.5): nothing in the outline is longer.
        let found = longest_in(ROOMS);
        let diagonal = (100.0f64 + 16.0).sqrt();
        assert!(
            (found - diagonal).abs() < 1e-9,
            "{found} against {diagonal}"
        );
    }

    #[test]
    fn no_free_segment_is_longer() {
        let text = include_str!("../../levels/office.toml");
        let graph = graph(text, Subdivision::Bsp);
        let pvs = sweep(&graph, &Progress::default());
        let found = longest(&graph);
        let locator = Locator::new(&graph);
        let best = found.lines[0];
        for line in &found.lines {
            assert!(pvs.sees(line.cells[0], line.cells[1]), "{line:?}");
        }
        let (mut low, mut high) = (DVec2::MAX, DVec2::MIN);
        for v in graph.vertices.iter() {
            (low, high) = (low.min(v.approx()), high.max(v.approx()));
        }
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let (mut free, mut longest_free) = (0, 0.0f64);
        for _ in 0..60_000 {
            let mut point = || {
                let p = DVec2::new(
                    rng.random_range(low.x..high.x),
                    rng.random_range(low.y..high.y),
                );
                GridPoint::new(p.x as i64, p.y as i64)
            };
            let (p, q) = (point(), point());
            let Some(cell) = locator.cell_at(&graph, p) else {
                continue;
            };
            if locator.cell_at(&graph, q).is_none() || straight(&graph, p, q) != Straight::Free {
                continue;
            }
            free += 1;
            let length = DVec2::new((p.x - q.x) as f64, (p.y - q.y) as f64).length();
            longest_free = longest_free.max(length);
            assert!(length <= best.length());
            // What is seen from the corners is no bound for what is seen from inside, but nearly: the
            // corners lie around.
            assert!(found.from_cell[cell.0 as usize].is_some());
        }
        assert!(
            free > 1000 && longest_free > 0.6 * best.length(),
            "{free} {longest_free}"
        );
    }
}
