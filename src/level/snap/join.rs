//! Keeps together what rounding to the grid would tear apart.
//!
//! In: draft walls and the grid. Out: walls on the grid such that points which were one before are
//! one after, and a wall's end which lay on another wall before lies exactly on it after. "Were one"
//! and "lay on" mean: nearer than [`touch`] in the original numbers. The only means is
//! to split a wall at such an end; no point is ever moved to another grid point than its nearest,
//! except for a point that all but coincides with another one and would be rounded the other way.
//!
//! One pass is enough: splitting uses only grid points that are ends of walls already, and a wall
//! that is split at all is split at *every* end that lay on it. So the pieces of two walls that
//! overlapped coincide.

use std::collections::{HashMap, HashSet};

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::geom::{Grid, GridPoint};

use super::super::draft::DraftWall;
use super::super::finding::{Finding, Place, Severity};
use super::super::model::Wall;
use super::{RawPoint, distinct_places, finished, to_grid, touch};

/// A distinct point of the draft and where it went.
#[derive(Clone, Copy, Debug)]
struct SnappedPoint {
    at: DVec2,
    grid: GridPoint,
    /// Whether the grid point is this very point.
    exact: bool,
    /// Whether the file gives it digit by digit.
    written: bool,
}

/// Every distinct point of the draft with its grid point.
pub(super) struct SnappedPoints {
    points: Vec<SnappedPoint>,
    index: HashMap<[u64; 2], usize>,
}

impl SnappedPoints {
    /// Rounds all points, near coincident ones together.
    pub(super) fn new(grid: &Grid, raw: &[RawPoint]) -> SnappedPoints {
        let mut points: Vec<SnappedPoint> = Vec::new();
        let mut index = HashMap::new();
        for point in raw {
            let i = *index.entry(key(point.at)).or_insert_with(|| {
                let nearest = to_grid(grid, point.at);
                points.push(SnappedPoint {
                    at: point.at,
                    grid: nearest,
                    exact: grid.to_level(nearest) == point.at,
                    written: false,
                });
                points.len() - 1
            });
            points[i].written |= point.written;
        }
        let merged = merged_grid_points(&points, touch(grid));
        for (point, grid_point) in points.iter_mut().zip(merged) {
            point.grid = grid_point;
        }
        SnappedPoints { points, index }
    }

    /// The grid point of a point that was given to `new`.
    pub(super) fn grid_point(&self, at: DVec2) -> GridPoint {
        self.get(at).grid
    }

    fn get(&self, at: DVec2) -> &SnappedPoint {
        &self.points[self.index[&key(at)]]
    }
}

/// The bits of a point, with -0 as 0.
fn key(p: DVec2) -> [u64; 2] {
    [(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits()]
}

/// The grid point for each point: its own if it is exact; otherwise, among the points that touch
/// it, that of an exact one, or else the least.
fn merged_grid_points(points: &[SnappedPoint], touch: f64) -> Vec<GridPoint> {
    if points.iter().all(|p| p.exact) {
        return points.iter().map(|p| p.grid).collect();
    }
    let tree = RTree::bulk_load(
        (points.iter().enumerate())
            .map(|(i, p)| GeomWithData::new(p.at.to_array(), i))
            .collect(),
    );
    let merged = |p: &SnappedPoint| {
        if p.exact {
            return p.grid;
        }
        tree.locate_within_distance(p.at.to_array(), touch * touch)
            .map(|near| &points[near.data])
            .min_by_key(|near| (!near.exact, near.grid))
            .map_or(p.grid, |near| near.grid)
    };
    points.iter().map(merged).collect()
}

/// An end that lay on a wall.
struct Touching {
    /// Where along the wall, in units from its start.
    along: f64,
    grid: GridPoint,
    at: DVec2,
    written: bool,
    /// Whether snapping moved it, or the wall, and took it off.
    torn: bool,
}

/// Finished walls, split where needed, in the order of `walls`; adds the finding `joined`.
pub(super) fn join(
    grid: &Grid,
    snapped: &SnappedPoints,
    walls: Vec<DraftWall>,
    findings: &mut Vec<Finding>,
) -> Vec<Wall> {
    let touch = touch(grid);
    let touching = touching_ends(snapped, &walls, touch);
    let mut finished_walls = Vec::with_capacity(walls.len());
    let mut places = Vec::new();
    let mut joined: HashSet<GridPoint> = HashSet::new();
    let mut written = false;
    for (wall, mut ends) in walls.iter().zip(touching) {
        let (from, to) = (snapped.grid_point(wall.from), snapped.grid_point(wall.to));
        if !ends.iter().any(|end| end.torn) {
            finished_walls.push(finished(wall, from, to));
            continue;
        }
        ends.sort_by(|a, b| a.along.total_cmp(&b.along).then(a.grid.cmp(&b.grid)));
        for end in ends.iter().filter(|end| end.torn) {
            if joined.insert(end.grid) {
                places.push(Place::Point {
                    x: end.at.x,
                    y: end.at.y,
                });
                written |= end.written;
            }
        }
        let mut start = from;
        for next in ends.iter().map(|end| end.grid).chain([to]) {
            if next != start {
                finished_walls.push(finished(wall, start, next));
                start = next;
            }
        }
    }
    if !places.is_empty() {
        findings.push(Finding {
            code: "joined",
            severity: if written {
                Severity::Repaired
            } else {
                Severity::Note
            },
            message: "The end of a wall lay on another wall and would have come off it on the \
                      grid; that wall was split there."
                .into(),
            places: distinct_places(places.into_iter()),
        });
    }
    finished_walls
}

/// For each wall the ends of others that lie on it between its own ends.
fn touching_ends(snapped: &SnappedPoints, walls: &[DraftWall], touch: f64) -> Vec<Vec<Touching>> {
    let mut touching: Vec<Vec<Touching>> = walls.iter().map(|_| Vec::new()).collect();
    if snapped.points.iter().all(|p| p.exact) {
        return touching;
    }
    let tree = RTree::bulk_load(
        (walls.iter().enumerate())
            .map(|(i, w)| {
                let corners = Rectangle::from_corners(w.from.to_array(), w.to.to_array());
                GeomWithData::new(corners, i)
            })
            .collect(),
    );
    // In the order of the points, so that nothing depends on the tree's own order.
    for point in &snapped.points {
        let reach =
            AABB::from_corners((point.at - touch).to_array(), (point.at + touch).to_array());
        for near in tree.locate_in_envelope_intersecting(reach) {
            let wall = &walls[near.data];
            let (from, to) = (snapped.get(wall.from), snapped.get(wall.to));
            if point.grid == from.grid || point.grid == to.grid {
                continue;
            }
            // Differences first: they are (nearly) exact, however far away the level lies.
            let direction = to.at - from.at;
            let offset = point.at - from.at;
            let length = direction.length();
            let along = direction.dot(offset) / length;
            let distance = direction.perp_dot(offset).abs() / length;
            if !(0.0..=length).contains(&along) || distance > touch {
                continue;
            }
            let exact = point.exact && from.exact && to.exact;
            let on_grid_wall = is_between(from.grid, to.grid, point.grid);
            if exact && !on_grid_wall {
                continue; // drawn that near, on purpose or not: the numbers are as written
            }
            touching[near.data].push(Touching {
                along,
                grid: point.grid,
                at: point.at,
                written: point.written,
                torn: !on_grid_wall,
            });
        }
    }
    touching
}

/// Whether `p` lies exactly on the segment from `a` to `b`.
fn is_between(a: GridPoint, b: GridPoint, p: GridPoint) -> bool {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let (px, py) = (p.x - a.x, p.y - a.y);
    let along = dx * px + dy * py;
    dx * py - dy * px == 0 && 0 <= along && along <= dx * dx + dy * dy
}
