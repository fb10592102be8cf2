//! Random free segments: the cells that one passes through see each other.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::walls::Walls;
use super::{Failure, Verified, VerifyOptions};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{GRID_LIMIT, GridPoint, Side, Vertex, VertexId, orient};
use crate::pvs::Progress;
use crate::pvs::file::PvsFile;

/// Segments that one chunk of work tries.
const CHUNK: u64 = 8192;

/// Casts the segments.
pub(super) fn check(
    file: &PvsFile,
    walls: &Walls,
    outer: &[bool],
    options: &VerifyOptions,
    progress: &Progress,
    done: &mut Verified,
) -> Result<(), Failure> {
    if file.graph.cells.is_empty() {
        return Ok(());
    }
    let caster = Caster::new(file, walls, outer);
    let chunks: Vec<Result<[u64; 4], Failure>> = (0..options.segments.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let seed = options.seed.wrapping_mul(2).wrapping_add(1 + (chunk << 32));
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let n = CHUNK.min(options.segments - chunk * CHUNK);
            let mut counts = [0; 4];
            let mut way = Way::default();
            for _ in 0..n {
                match caster.cast(&mut rng, &mut way)? {
                    Some([met, missed]) => {
                        counts[0] += 1;
                        counts[2] += met;
                        counts[3] += missed;
                    }
                    None => counts[1] += 1,
                }
            }
            progress.advance(n as usize);
            Ok(counts)
        })
        .collect();
    for counts in chunks {
        let [free, discarded, met, missed] = counts?;
        done.free += free;
        done.discarded += discarded;
        done.met += met;
        done.missed += missed;
    }
    Ok(())
}

/// A segment's way through the cells.
#[derive(Default)]
pub(super) struct Way {
    /// The cells, in order.
    pub path: Vec<CellId>,
    /// The edges through which it leaves one for the next.
    pub exits: Vec<EdgeId>,
}

/// Finds segments that are free on the plan.
pub(super) struct Caster<'a> {
    file: &'a PvsFile,
    graph: &'a CellGraph,
    walls: &'a Walls,
    /// Edges that face the outside without an opaque wall.
    outer: &'a [bool],
    /// Edges at which sight ends.
    borders: Vec<EdgeId>,
    /// Larger than any distance in the level.
    far: f64,
    /// A cross product of f64 copies larger than this has the true sign; see
    /// [`crate::geom::Vertices`] for the proof, whose coordinates include those of grid points.
    bound: f64,
}

impl<'a> Caster<'a> {
    pub fn new(file: &'a PvsFile, walls: &'a Walls, outer: &'a [bool]) -> Self {
        let graph = &file.graph;
        let (low, high) = walls.all.extent();
        let largest = [low.x, low.y, high.x, high.y]
            .map(|n| n.abs())
            .into_iter()
            .max();
        let largest = largest.unwrap_or(0) as f64 + 16.0;
        let is_border = |e: &EdgeId| graph.edge(*e).twin().is_none();
        Self {
            file,
            graph,
            walls,
            outer,
            borders: (0..graph.edges.len() as u32)
                .map(EdgeId)
                .filter(is_border)
                .collect(),
            far: 2.0 * ((high.x - low.x) as f64).hypot((high.y - low.y) as f64) + 2.0,
            bound: largest * largest * 2f64.powi(-45),
        }
    }

    /// Tries one segment. `None` if it is not free; otherwise the number of pairs of cells met, and of
    /// those that are not listed, where the file does not claim to list all.
    fn cast(&self, rng: &mut Pcg64Mcg, way: &mut Way) -> Result<Option<[u64; 2]>, Failure> {
        let Some((from, to)) = self.segment(rng, way)? else {
            return Ok(None);
        };
        let path = &way.path;
        let pvs = &self.file.pvs;
        let (mut met, mut missed) = (0, 0);
        for (i, &a) in path.iter().enumerate() {
            for &b in &path[i + 1..] {
                if !pvs.sees(a, b) {
                    if pvs.class.is_complete() {
                        return Err(Failure::Missed { a, b, from, to });
                    }
                    missed += 1;
                }
                met += 1;
            }
        }
        Ok(Some([met, missed]))
    }

    /// A random segment that touches no opaque wall, and its way through the cells; `None` if there was
    /// none at the first try.
    pub fn segment(
        &self,
        rng: &mut Pcg64Mcg,
        way: &mut Way,
    ) -> Result<Option<(GridPoint, GridPoint)>, Failure> {
        let Some((from, cell)) = self.start(rng) else {
            return Ok(None);
        };
        let direction = self.aim(rng, from);
        let Some(to) = self.reach(rng, from, direction) else {
            return Ok(None);
        };
        if self.walls.opaque.touched(from, to) {
            return Ok(None);
        }
        let proper = self.walk(from, to, cell, way)?;
        Ok(proper.then_some((from, to)))
    }

    /// A grid point strictly inside a cell: anywhere in a random cell, or close to a corner where
    /// sight ends.
    fn start(&self, rng: &mut Pcg64Mcg) -> Option<(GridPoint, CellId)> {
        let (point, cell) = if rng.random_bool(0.5) && !self.borders.is_empty() {
            let edge = self.borders[rng.random_range(0..self.borders.len())];
            let corner = self.graph.vertices.approx(self.graph.edge(edge).origin);
            let mut near = |at: f64| at.round() as i64 + rng.random_range(-2..=2);
            (
                GridPoint::new(near(corner.x), near(corner.y)),
                self.graph.edge(edge).cell,
            )
        } else {
            let cell = CellId(rng.random_range(0..self.graph.cells.len() as u32));
            let corners: Vec<VertexId> = self.graph.corners(cell).collect();
            let k = rng.random_range(1..corners.len() - 1);
            let [a, b, c] =
                [corners[0], corners[k], corners[k + 1]].map(|v| self.graph.vertices.approx(v));
            let (mut s, mut t) = (rng.random::<f64>(), rng.random::<f64>());
            if s + t > 1.0 {
                (s, t) = (1.0 - s, 1.0 - t);
            }
            let p = (a + (b - a) * s + (c - a) * t).round();
            (GridPoint::new(p.x as i64, p.y as i64), cell)
        };
        let mut edges = self.graph.edge_range(cell).map(EdgeId);
        let inside = edges.all(|e| {
            let (p, q) = (self.graph.edge(e).origin, self.graph.end(e));
            self.point_side(p, q, point) == Side::Left
        });
        inside.then_some((point, cell))
    }

    /// A direction of some length: any, or past an end of a wall that is in sight.
    fn aim(&self, rng: &mut Pcg64Mcg, from: GridPoint) -> DVec2 {
        let turn = rng.random::<f64>() * std::f64::consts::TAU;
        let any = DVec2::from_angle(turn) * self.far;
        if rng.random_bool(0.5) {
            return any;
        }
        // The cell at which the ray ends has corners near there: aim beside one of them.
        let reach = self.walls.opaque.reach(from, any.x, any.y);
        let hit = DVec2::new(from.x as f64, from.y as f64) + any * reach;
        let at = GridPoint::new(hit.x as i64, hit.y as i64);
        let mut near = Vec::new();
        self.walls.opaque.near(at, at, &mut near);
        if near.is_empty() {
            return any;
        }
        let wall = &self.walls.opaque.list[near[rng.random_range(0..near.len())] as usize];
        let end = if rng.random_bool(0.5) {
            wall.from
        } else {
            wall.to
        };
        let beside = DVec2::new(
            (end.x + rng.random_range(-1..=1) - from.x) as f64,
            (end.y + rng.random_range(-1..=1) - from.y) as f64,
        );
        if beside == DVec2::ZERO {
            any
        } else {
            beside.normalize() * self.far
        }
    }

    /// A grid point in that direction, most often the last one before a wall.
    fn reach(&self, rng: &mut Pcg64Mcg, from: GridPoint, direction: DVec2) -> Option<GridPoint> {
        let reach = self.walls.opaque.reach(from, direction.x, direction.y);
        let length = direction.length() * reach;
        // A step or so before the wall; sometimes anywhere on the way.
        let length = if rng.random_bool(0.8) {
            length - 1.5
        } else {
            length * rng.random::<f64>()
        };
        let way = (direction.normalize() * length.max(0.0)).round();
        let to = GridPoint::new(from.x + way.x as i64, from.y + way.y as i64);
        let (low, high) = self.walls.all.extent();
        let within = (low.x..=high.x).contains(&to.x) && (low.y..=high.y).contains(&to.y);
        debug_assert!(high.x < GRID_LIMIT);
        (to != from && within).then_some(to)
    }

    /// The cells that the segment properly passes through, from the one that holds its start.
    /// False if it meets a corner exactly: then it has no proper way through the cells.
    fn walk(
        &self,
        from: GridPoint,
        to: GridPoint,
        start: CellId,
        Way { path, exits }: &mut Way,
    ) -> Result<bool, Failure> {
        path.clear();
        exits.clear();
        path.push(start);
        let mut cell = start;
        loop {
            // Ahead, the segment's line leaves a convex cell between a corner on its right and the
            // next one, on its left.
            let exit = {
                let range = self.graph.edge_range(cell);
                let n = range.len() as u32;
                let mut before = self.line_side(from, to, EdgeId(range.start));
                let first = before;
                let mut exit = None;
                for k in 0..n {
                    let after = if k + 1 == n {
                        first
                    } else {
                        self.line_side(from, to, EdgeId(range.start + k + 1))
                    };
                    if before == Side::Right && after == Side::Left {
                        exit = Some(EdgeId(range.start + k));
                    }
                    before = after;
                }
                exit
            };
            let Some(exit) = exit else { return Ok(false) };
            let (p, q) = (self.graph.edge(exit).origin, self.graph.end(exit));
            match self.point_side(p, q, to) {
                Side::Left | Side::On => return Ok(true),
                Side::Right => {}
            }
            match self.graph.edge(exit).twin() {
                Some(twin) => cell = self.graph.edge(twin).cell,
                None if self.outer[exit.0 as usize] => return Ok(true),
                None => {
                    return Err(Failure::Escape {
                        edge: exit,
                        from,
                        to,
                    });
                }
            }
            if path.len() > self.graph.cells.len() {
                // Cannot happen where cells are convex and fit; but a file is not to be trusted.
                return Ok(false);
            }
            exits.push(exit);
            path.push(cell);
        }
    }

    /// Side of the edge's origin as seen from `p` towards `q`.
    fn line_side(&self, p: GridPoint, q: GridPoint, edge: EdgeId) -> Side {
        let v = self.graph.edge(edge).origin;
        let at = self.graph.vertices.approx(v);
        let (px, py) = (p.x as f64, p.y as f64);
        let (dx, dy) = (q.x as f64 - px, q.y as f64 - py);
        let cross = dx * (at.y - py) - dy * (at.x - px);
        if cross.abs() > self.bound {
            Side::of(cross)
        } else {
            orient(
                &Vertex::from(p),
                &Vertex::from(q),
                self.graph.vertices.exact(v),
            )
        }
    }

    /// Side of a grid point as seen from one vertex towards another.
    fn point_side(&self, p: VertexId, q: VertexId, point: GridPoint) -> Side {
        let (a, b) = (self.graph.vertices.approx(p), self.graph.vertices.approx(q));
        let at = DVec2::new(point.x as f64, point.y as f64);
        let cross = (b - a).perp_dot(at - a);
        if cross.abs() > self.bound {
            Side::of(cross)
        } else {
            let [p, q] = [p, q].map(|v| self.graph.vertices.exact(v));
            orient(p, q, &Vertex::from(point))
        }
    }
}
