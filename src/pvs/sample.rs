//! Random sightlines.
//!
//! In: cells. Out: the pairs of cells that some of many random lines joins. A ray is a line through
//! two grid points that properly crosses the cell it is cast from, followed both ways from there to
//! the first wall, or to a vertex that lies exactly on it. Every sign on its way is exact, so all
//! cells that it enters see each other in pairs along parts of one free segment: there are never too
//! many pairs, but thin sights are missed. (Cells too small to hold a grid point are crossed by
//! lines through grid points like any other.)
//!
//! What is random is only where to look, half of the time each:
//! - from: anywhere in the cell, or near one of its corners, since thin sights start there;
//! - to: any point of one of the cell's portals, or just past the end of a wall that the ray before
//!   this one passed or hit, since thin sights graze the ends of walls.
//!
//! On Freedoom's maps this finds as much as twice as many rays do in directions all alike. Every
//! cell has its own random numbers, used up ray by ray: so the result does not depend on the number
//! of threads, and the rays of a smaller number are the first of a larger one.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::bits::{SharedBits, SmallSet};
use super::flat::{FlatMesh, WALL};
use super::{Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, CellId};
use crate::geom::{Directed, GRID_LIMIT, GridPoint, Side};

/// Options of [`sample`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleOptions {
    /// Random sightlines from every cell.
    pub rays: u32,
    /// Seed of all that is random.
    pub seed: u64,
}

impl Default for SampleOptions {
    fn default() -> Self {
        Self {
            rays: 1000,
            seed: 1,
        }
    }
}

/// The PVS of the pairs that random sightlines join. Uses the current rayon thread pool; the result
/// does not depend on its size.
pub fn sample(graph: &CellGraph, options: &SampleOptions, progress: &Progress) -> Pvs {
    let n = graph.cells.len();
    progress.begin(n);
    let mesh = FlatMesh::new(graph);
    let wall_ends = wall_ends(graph);
    let bits = SharedBits::new(n);
    let steps = (0..n as u32)
        .into_par_iter()
        .map_init(
            || Caster::new(&mesh, &wall_ends, &bits),
            |caster, cell| {
                let steps = caster.look_from(CellId(cell), options);
                progress.advance(1);
                steps
            },
        )
        .sum();
    Pvs {
        visible: bits.symmetric(),
        method: Method::Sample,
        class: Class::Aggressive,
        heights: false,
        undecided: 0,
        steps,
    }
}

/// For every vertex, whether a wall starts or ends there.
fn wall_ends(graph: &CellGraph) -> Vec<bool> {
    let mut ends = vec![false; graph.vertices.len()];
    for cell in graph.cell_ids() {
        let corners: Vec<_> = graph.corners(cell).collect();
        for (i, e) in graph.edge_range(cell).enumerate() {
            if graph.edges[e as usize].twin().is_none() {
                ends[corners[i].0 as usize] = true;
                ends[corners[(i + 1) % corners.len()].0 as usize] = true;
            }
        }
    }
    ends
}

/// Casts rays from one cell after the other.
struct Caster<'a> {
    mesh: &'a FlatMesh<'a>,
    wall_ends: &'a [bool],
    bits: &'a SharedBits,
    /// The cell's corners, and the areas of the triangles that they make with the first one, summed.
    corners: Vec<DVec2>,
    areas: Vec<f64>,
    /// The ends of the cell's portals.
    portals: Vec<[DVec2; 2]>,
    /// The cells that the last ray entered, as a list and as a set.
    path: Vec<u32>,
    entered: SmallSet,
    /// The ends of walls that it passed or hit.
    passed: Vec<DVec2>,
}

impl<'a> Caster<'a> {
    fn new(mesh: &'a FlatMesh<'a>, wall_ends: &'a [bool], bits: &'a SharedBits) -> Self {
        Self {
            mesh,
            wall_ends,
            bits,
            corners: Vec::new(),
            areas: Vec::new(),
            portals: Vec::new(),
            path: Vec::new(),
            entered: SmallSet::new(mesh.graph.cells.len()),
            passed: Vec::new(),
        }
    }

    /// Casts all rays of a cell; returns the cells that they entered, with repetition.
    fn look_from(&mut self, cell: CellId, options: &SampleOptions) -> u64 {
        self.stand_in(cell);
        if self.portals.is_empty() {
            return 0;
        }
        // Far apart for neighbouring cells and for neighbouring seeds.
        let stream = u64::from(cell.0 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut random = Pcg64Mcg::seed_from_u64(options.seed ^ stream);
        let mut steps = 0;
        for _ in 0..options.rays {
            let from = self.start(&mut random);
            let to = if !self.passed.is_empty() && random.random_bool(0.5) {
                self.past_a_wall(from, &mut random)
            } else {
                let [p, q] = self.portals[random.random_range(0..self.portals.len())];
                p.lerp(q, random.random())
            };
            let line = line(from, to).and_then(|[p, q]| Directed::through(p, q));
            steps += line.map_or(0, |line| self.cast(cell, &line));
        }
        steps
    }

    fn stand_in(&mut self, cell: CellId) {
        let graph = &*self.mesh.graph;
        self.corners.clear();
        self.areas.clear();
        self.portals.clear();
        self.passed.clear();
        let corners = graph.corners(cell).map(|v| graph.vertices.approx(v));
        self.corners.extend(corners);
        let first = self.corners[0];
        let mut sum = 0.0;
        for pair in self.corners[1..].windows(2) {
            sum += (pair[0] - first).perp_dot(pair[1] - first);
            self.areas.push(sum);
        }
        let n = self.corners.len();
        for (i, e) in graph.edge_range(cell).enumerate() {
            if self.mesh.edge(e).twin != WALL {
                let ends = [self.corners[i], self.corners[(i + 1) % n]];
                self.portals.push(ends);
            }
        }
    }

    /// A point of the cell, or just beside a very small one: as likely to be near a corner as
    /// anywhere.
    fn start(&self, random: &mut Pcg64Mcg) -> DVec2 {
        let at = random.random::<f64>() * self.areas[self.areas.len() - 1];
        let k = self.areas.partition_point(|&area| area < at);
        let [a, b, c] = [0, k + 1, k + 2].map(|i| self.corners[i]);
        let (mut s, mut t) = (random.random::<f64>(), random.random::<f64>());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        let anywhere = a + (b - a) * s + (c - a) * t;
        if random.random_bool(0.5) {
            return anywhere;
        }
        let corner = self.corners[random.random_range(0..self.corners.len())];
        let share = random.random::<f64>();
        corner.lerp(anywhere, share * share * share)
    }

    /// A point beside the end of a wall of the last ray, 1/64 to 2 steps off it.
    fn past_a_wall(&self, from: DVec2, random: &mut Pcg64Mcg) -> DVec2 {
        let end = self.passed[random.random_range(0..self.passed.len())];
        let octave = f64::from(1 << random.random_range(0..7)) / 64.0;
        let offset = octave * (1.0 + random.random::<f64>());
        let side = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        end + (end - from).normalize_or_zero().perp() * offset * side
    }

    /// Follows a line from the cell to the first wall, both ways, and marks what it enters as seeing
    /// each other; returns how many cells that are. Nothing, if it does not properly cross the cell.
    fn cast(&mut self, cell: CellId, line: &Directed) -> u64 {
        let mesh = self.mesh;
        let vertices = &mesh.graph.vertices;
        let range = mesh.graph.edge_range(cell);
        let (mut left, mut right) = (false, false);
        let (mut ahead, mut behind) = (None, None);
        let mut before = vertices.side_along(line, &mesh.edge(range.end - 1).end);
        for e in range {
            let after = vertices.side_along(line, &mesh.edge(e).end);
            left |= after == Side::Left;
            right |= after == Side::Right;
            // Walking along the line, the way out of a convex cell is the edge from right to left.
            match (before, after) {
                (Side::Right, Side::Left) => ahead = Some(e),
                (Side::Left, Side::Right) => behind = Some(e),
                _ => {}
            }
            before = after;
        }
        if !left || !right {
            return 0;
        }
        self.path.clear();
        self.passed.clear();
        self.path.push(cell.0);
        for (exit, beyond) in [(ahead, Side::Left), (behind, Side::Right)] {
            if let Some(exit) = exit {
                self.follow(line, exit, beyond);
            }
        }
        self.path.iter().for_each(|&c| self.entered.insert(c));
        let pairs = self.path.iter();
        pairs.for_each(|&c| self.bits.or_row(c, &self.entered));
        self.entered.clear();
        self.path.len() as u64
    }

    /// Follows the line out through `exit`, whose end lies on the side `beyond` of it, to the first
    /// wall or to a vertex on the line.
    fn follow(&mut self, line: &Directed, mut exit: u32, beyond: Side) {
        let mesh = self.mesh;
        let vertices = &mesh.graph.vertices;
        loop {
            let edge = mesh.edge(exit);
            let ends = [edge.end.id, mesh.graph.edges[exit as usize].origin];
            let of_walls = ends.iter().filter(|v| self.wall_ends[v.0 as usize]);
            let passed = of_walls.map(|&v| vertices.approx(v));
            self.passed.extend(passed);
            let entry = edge.twin;
            if entry == WALL {
                return;
            }
            self.path.push(mesh.edge(entry).cell);
            // The entry starts beyond; so does the way out end, the first edge after it that does.
            exit = mesh.edge(entry).next(entry);
            loop {
                let edge = mesh.edge(exit);
                match vertices.side_along(line, &edge.end) {
                    Side::On => return,
                    side if side == beyond => break,
                    _ => exit = edge.next(exit),
                }
            }
        }
    }
}

/// Two grid points whose line passes as close as that allows by two points on the plan, from the one
/// towards the other.
fn line(from: DVec2, to: DVec2) -> Option<[GridPoint; 2]> {
    const FAR: f64 = (GRID_LIMIT - 1) as f64;
    let on_grid = |p: DVec2| p.round().clamp(DVec2::splat(-FAR), DVec2::splat(FAR));
    let distance = from.distance(to);
    if distance == 0.0 {
        return None;
    }
    // A first grid point far back makes little of its rounding at `from`; a second one much farther
    // out makes little of its own at `to`. At best both are off by about the same.
    let back = (distance * FAR).sqrt();
    let first = on_grid(from - (to - from) / distance * back);
    let way = to - first;
    let out = |at: f64, d: f64| ((FAR * d.signum() - at) / d).abs();
    let share = out(first.x, way.x).min(out(first.y, way.y));
    let second = on_grid(first + way * share);
    let whole = |p: DVec2| GridPoint::new(p.x as i64, p.y as i64);
    (first.is_finite() && second.is_finite()).then(|| [whole(first), whole(second)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;

    fn cells(text: &str) -> CellGraph {
        let level = read(text.into(), "test.toml", None).unwrap();
        subdivide(&level, &Options::default())
    }

    fn cast(graph: &CellGraph, rays: u32) -> Pvs {
        let pvs = sample(
            graph,
            &SampleOptions { rays, seed: 1 },
            &Progress::default(),
        );
        pvs.validate(graph).unwrap();
        pvs
    }

    #[test]
    fn a_few_rays_find_all_of_two_rooms() {
        let graph = cells(
            "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
             [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
             [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n",
        );
        assert_eq!(cast(&graph, 1).pairs(), 4);
        let shut = cells("[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n");
        assert_eq!((cast(&shut, 9).pairs(), cast(&shut, 9).steps), (1, 0));
    }

    #[test]
    fn more_rays_lose_nothing() {
        let graph = cells(&std::fs::read_to_string("levels/office.toml").unwrap());
        let list = [10, 20, 40, 80].map(|rays| cast(&graph, rays).visible);
        for pair in list.windows(2) {
            for cell in 0..graph.cells.len() {
                let (few, many) = (pair[0].row(cell), pair[1].row(cell));
                assert!(few.iter().zip(many).all(|(f, m)| f & !m == 0));
            }
            assert!(pair[0].total() < pair[1].total());
        }
    }

    #[test]
    fn a_line_passes_close_by_both_points() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut number = |size: f64| (random.random::<f64>() * 2.0 - 1.0) * size;
        for size in [0.01, 1.0, 1e4] {
            for _ in 0..1000 {
                let [p, q] = [(); 2].map(|()| DVec2::new(number(size), number(size)));
                let [a, b] = line(p, q)
                    .unwrap()
                    .map(|p| DVec2::new(p.x as f64, p.y as f64));
                for c in [p, q] {
                    let off = (b - a).normalize().perp_dot(c - a).abs();
                    assert!(
                        off <= (3.0 * size / GRID_LIMIT as f64).sqrt(),
                        "{p} {q}: {off}"
                    );
                }
                assert!((q - p).dot(b - a) > 0.0, "{p} {q}");
            }
        }
        assert!(line(DVec2::ONE, DVec2::ONE).is_none());
    }
}
