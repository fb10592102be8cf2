//! What a pointer on the plan is at: the nearest wall end, opening or wall.
//!
//! Distances are in the level's unit; of several things equally near the first is taken.

use glam::DVec2;

use crate::geom::GridPoint;

use super::super::model::{Level, Wall, WallId};
use super::runs::is_opening;

/// The end of a wall nearest to `p`, at most `within` away.
pub fn point(level: &Level, p: DVec2, within: f64) -> Option<GridPoint> {
    let ends = level.walls.iter().flat_map(|w| [w.from, w.to]);
    nearest(
        ends.map(|q| (q, level.grid.to_level(q).distance(p))),
        within,
    )
}

/// The opening nearest to `p`.
pub fn opening(level: &Level, p: DVec2, within: f64) -> Option<WallId> {
    of_kind(level, p, within, is_opening)
}

/// The wall nearest to `p`; openings are none.
pub fn wall(level: &Level, p: DVec2, within: f64) -> Option<WallId> {
    of_kind(level, p, within, |w| !is_opening(w))
}

fn of_kind(level: &Level, p: DVec2, within: f64, wanted: fn(&Wall) -> bool) -> Option<WallId> {
    let walls = (0u32..).map(WallId).zip(&level.walls);
    let there = walls.filter(|(_, w)| wanted(w));
    nearest(there.map(|(id, w)| (id, distance(level, w, p))), within)
}

fn nearest<T>(list: impl Iterator<Item = (T, f64)>, within: f64) -> Option<T> {
    list.filter(|(_, distance)| *distance <= within)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(thing, _)| thing)
}

/// How far a point is from a wall.
pub fn distance(level: &Level, wall: &Wall, p: DVec2) -> f64 {
    let [a, b] = [wall.from, wall.to].map(|q| level.grid.to_level(q));
    let direction = b - a;
    let t = ((p - a).dot(direction) / direction.length_squared()).clamp(0.0, 1.0);
    (a + direction * t).distance(p)
}
