//! Taking walls away.

use glam::DVec2;

use crate::geom::GridPoint;

use super::super::model::{
    Interior, Level, OpeningStyle, OutlineId, SectorId, Wall, WallId, WallKind,
};
use super::super::outline::{corners, is_on, side};
use super::super::toml::contains;
use super::finish::{Parts, draft, finish};
use super::openings::{has_wall_beneath, plain, remove_opening};
use super::runs::{is_opening, runs};
use super::{EditError, wall};

/// Takes a wall away, in the way that its kind allows: an opening is walled up; a free-standing wall
/// goes, with its openings; a pillar or zone goes as a whole; a wall between two rooms becomes an
/// archway as long as they share it (rooms are bounded by outlines, which stay); a wall between two
/// sectors becomes see-through.
///
/// # Errors
/// Where nothing lies beyond the wall, or it is the border between two sectors.
pub fn delete_wall(level: &Level, id: WallId) -> Result<Level, EditError> {
    let wall = wall(level, id)?;
    let index = id.0 as usize;
    match (&wall.kind, wall.outline) {
        (WallKind::Opening(_), _) => remove_opening(level, id),
        (WallKind::Outline, Some(_)) => open_wall(level, index),
        (WallKind::Solid | WallKind::Edge { .. }, Some(outline)) => remove_area(level, outline),
        (WallKind::Outline, None) => remove_free(level, index),
        (WallKind::Solid, None) if level.interior != Interior::Sides => {
            let mut parts = Parts::of(level);
            parts.walls.remove(index);
            finish(level, parts)
        }
        (WallKind::Solid, None) => match (wall.left, wall.right) {
            (Some(_), Some(_)) => {
                let mut parts = Parts::of(level);
                parts.walls[index].kind = WallKind::Edge { shut: false };
                finish(level, parts)
            }
            _ => Err(EditError::OuterWall),
        },
        (WallKind::Edge { .. }, None) if wall.left != wall.right => Err(EditError::Border),
        (WallKind::Edge { .. }, None) => {
            let mut parts = Parts::of(level);
            parts.walls.remove(index);
            finish(level, parts)
        }
    }
}

/// A pillar, or a zone with its sector.
fn remove_area(level: &Level, id: OutlineId) -> Result<Level, EditError> {
    let mut parts = Parts::of(level);
    parts.walls.retain(|w| w.outline != Some(id));
    let area = parts.outlines.remove(id.0 as usize);
    for wall in &mut parts.walls {
        wall.outline = wall.outline.map(|o| OutlineId(o.0 - u32::from(o > id)));
    }
    if let Some(gone) = area.sector {
        parts.sectors.remove(gone.0 as usize);
        let less = |s: SectorId| SectorId(s.0 - u32::from(s > gone));
        for outline in &mut parts.outlines {
            outline.sector = outline.sector.map(less);
        }
        for wall in &mut parts.walls {
            (wall.left, wall.right) = (wall.left.map(less), wall.right.map(less));
        }
    }
    finish(level, parts)
}

/// A free-standing wall from corner to corner, with the openings that nothing else holds.
fn remove_free(level: &Level, index: usize) -> Result<Level, EditError> {
    let run = runs(level).into_iter().find(|r| r.walls.contains(&index));
    let gone = run.as_ref().map_or(index..index + 1, |r| r.walls.clone());
    let mut rest = level.clone();
    rest.walls.drain(gone.clone());
    let stray = |w: &Wall| {
        is_opening(w) && run.as_ref().is_some_and(|r| r.holds(w)) && !has_wall_beneath(&rest, w)
    };
    let mut parts = Parts::of(level);
    let keep = (0..level.walls.len()).filter(|i| !gone.contains(i) && !stray(&level.walls[*i]));
    parts.walls = keep.map(|i| draft(level, &level.walls[i])).collect();
    finish(level, parts)
}

/// A stretch of a room's wall beyond which there is another room becomes an archway.
fn open_wall(level: &Level, index: usize) -> Result<Level, EditError> {
    let wall = &level.walls[index];
    let others = level.walls.iter().filter(|w| w.kind == WallKind::Outline);
    let shared = others
        .filter(|w| w.outline.is_some() && w.outline != wall.outline)
        .filter_map(|w| common([wall.from, wall.to], [w.from, w.to]))
        .max_by_key(|[p, q]| (q.x - p.x).abs().max((q.y - p.y).abs()));
    let within = || another_room(level, wall).then_some([wall.from, wall.to]);
    let Some([p, q]) = shared.or_else(within) else {
        return Err(EditError::OuterWall);
    };
    let mut parts = Parts::of(level);
    let lies_within = |w: &Wall| is_opening(w) && is_on(p, q, w.from) && is_on(p, q, w.to);
    let keep = level.walls.iter().filter(|w| !lies_within(w));
    parts.walls = keep.map(|w| draft(level, w)).collect();
    let mut archway = draft(level, wall);
    (archway.from, archway.to) = (level.grid.to_level(p), level.grid.to_level(q));
    archway.kind = WallKind::Opening(plain(OpeningStyle::Archway));
    (
        archway.left,
        archway.right,
        archway.outline,
        archway.material,
    ) = (None, None, None, None);
    parts.walls.push(archway);
    finish(level, parts)
}

/// What two segments on one line have in common, if that has a length.
fn common([a, b]: [GridPoint; 2], [c, d]: [GridPoint; 2]) -> Option<[GridPoint; 2]> {
    if side(a, b, c) != 0 || side(a, b, d) != 0 {
        return None;
    }
    // On one line, the order of points by x and then y is that along it.
    let (low, high) = (a.min(b).max(c.min(d)), a.max(b).min(c.max(d)));
    let (first, last) = if a < b { (low, high) } else { (high, low) };
    (low < high).then_some([first, last])
}

/// Whether the middle of a room's wall lies within another room: one stands inside the other.
fn another_room(level: &Level, wall: &Wall) -> bool {
    let [a, b] = [wall.from, wall.to].map(|p| level.grid.to_level(p));
    let middle = (a + b) / 2.0;
    (level.outlines.iter().zip(corners(level)).enumerate())
        .filter(|(i, (o, _))| {
            !o.zone && o.sector.is_some() && wall.outline != Some(OutlineId(*i as u32))
        })
        .filter_map(|(_, (_, corners))| corners)
        .any(|corners| {
            let polygon: Vec<DVec2> = (corners.iter().map(|&p| level.grid.to_level(p))).collect();
            contains(&polygon, middle)
        })
}
