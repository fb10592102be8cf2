//! Runs: the walls that lie between two corners, with the openings cut into them.
//!
//! The door to the grid splits a slanted wall at the ends of its openings, since these lie off the
//! straight line by less than a step. To people it is one wall all the same.

use std::collections::HashSet;
use std::ops::Range;

use glam::DVec2;

use crate::geom::GridPoint;

use super::super::model::{Level, Wall, WallKind};

/// Consecutive walls of one outline, or of one free-standing wall, that are as good as straight and
/// are parted by the ends of openings only.
pub(super) struct Run {
    /// Indices of the walls.
    pub walls: Range<usize>,
    pub from: GridPoint,
    pub to: GridPoint,
}

/// The runs of all walls that openings can be cut into.
pub(super) fn runs(level: &Level) -> Vec<Run> {
    let opening_ends: HashSet<GridPoint> = (level.walls.iter())
        .filter(|w| is_opening(w))
        .flat_map(|w| [w.from, w.to])
        .collect();
    let mut runs: Vec<Run> = Vec::new();
    for (i, wall) in level.walls.iter().enumerate() {
        if wall.kind != WallKind::Outline {
            continue;
        }
        if let Some(run) = runs.last_mut()
            && run.walls.end == i
            && opening_ends.contains(&wall.from)
            && goes_on(level, run, wall)
        {
            run.walls.end = i + 1;
            run.to = wall.to;
            continue;
        }
        runs.push(Run {
            walls: i..i + 1,
            from: wall.from,
            to: wall.to,
        });
    }
    runs
}

pub(super) fn is_opening(wall: &Wall) -> bool {
    matches!(wall.kind, WallKind::Opening(_))
}

/// Whether a wall continues a run: every point between its new ends stays within a step of it.
fn goes_on(level: &Level, run: &Run, next: &Wall) -> bool {
    let last = &level.walls[run.walls.end - 1];
    let alike = (last.outline, last.material, last.to) == (next.outline, next.material, next.from);
    alike && (level.walls[run.walls.clone()].iter()).all(|w| is_near([run.from, next.to], w.to))
}

/// Whether a point lies between the ends of a segment, within a step of it.
fn is_near([a, b]: [GridPoint; 2], p: GridPoint) -> bool {
    let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let (px, py) = (i128::from(p.x - a.x), i128::from(p.y - a.y));
    let dot = dx * px + dy * py;
    0 <= dot && dot <= dx * dx + dy * dy && is_in_line([a, b], p)
}

/// Whether a point lies within a step of the line through two others.
pub(super) fn is_in_line([a, b]: [GridPoint; 2], p: GridPoint) -> bool {
    let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let (px, py) = (i128::from(p.x - a.x), i128::from(p.y - a.y));
    let cross = dx * py - dy * px;
    cross * cross <= dx * dx + dy * dy
}

impl Run {
    pub(super) fn ends(&self) -> [GridPoint; 2] {
        [self.from, self.to]
    }

    /// Whether a wall lies along this run.
    pub(super) fn holds(&self, wall: &Wall) -> bool {
        is_near(self.ends(), wall.from) && is_near(self.ends(), wall.to)
    }
}

/// How far along the line from `a` to `b` the point `p` is.
pub(super) fn along(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    (p - a).dot(b - a) / a.distance(b)
}
