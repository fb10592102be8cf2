//! Doors, windows and archways: opened and closed, cut into walls, and walled up.

use glam::DVec2;

use super::super::model::{
    Interior, Level, Opening, OpeningStyle, Sector, SectorId, Wall, WallId, WallKind,
};
use super::super::outline::is_on;
use super::finish::{Parts, finish};
use super::runs::{along, is_in_line, is_opening};
use super::{EditError, wall};

/// An opening of a kind as the level format has it when nothing else is said: doors stand closed,
/// all reach from floor to ceiling.
pub fn plain(style: OpeningStyle) -> Opening {
    Opening {
        style,
        name: None,
        shut: style == OpeningStyle::Door,
        bottom: None,
        top: None,
    }
}

/// Opens what is closed and closes what is open: the leaf of a door or window, or a Doom door with
/// the sector that moves.
///
/// # Errors
/// Where nothing can be opened or closed.
pub fn toggle(level: &Level, id: WallId) -> Result<Level, EditError> {
    let wall = wall(level, id)?;
    match &wall.kind {
        WallKind::Opening(opening) if opening.style != OpeningStyle::Archway => {
            let mut new = level.clone();
            for piece in leaf(level, id) {
                if let WallKind::Opening(opening) = &mut new.walls[piece].kind {
                    opening.shut = !opening.shut;
                }
            }
            Ok(new)
        }
        WallKind::Edge { .. } => toggle_sector(level, wall),
        _ => Err(EditError::NoLeaf),
    }
}

/// The indices of the pieces that an opening was split into; mostly one.
fn leaf(level: &Level, id: WallId) -> std::ops::Range<usize> {
    let at = id.0 as usize;
    let (mut first, mut end) = (at, at + 1);
    let one = |a: &Wall, b: &Wall| (&a.kind, a.place, a.to) == (&b.kind, b.place, b.from);
    while first > 0 && one(&level.walls[first - 1], &level.walls[first]) {
        first -= 1;
    }
    while end < level.walls.len() && one(&level.walls[end - 1], &level.walls[end]) {
        end += 1;
    }
    first..end
}

/// Whether a sector stands closed.
fn is_closed(sector: &Sector) -> bool {
    sector.ceiling.rest <= sector.floor.rest
}

/// Whether a sector can stand closed as well as open.
fn is_door(sector: &Sector) -> bool {
    let (floor, ceiling) = (sector.floor, sector.ceiling);
    ceiling.high > floor.low && ceiling.low <= floor.high && (floor.moves() || ceiling.moves())
}

fn toggle_sector(level: &Level, wall: &Wall) -> Result<Level, EditError> {
    let beside = |id: Option<SectorId>| {
        id.map(|s| s.0 as usize)
            .filter(|&s| s < level.sectors.len())
    };
    let doors: Vec<usize> = [beside(wall.left), beside(wall.right)]
        .into_iter()
        .flatten()
        .filter(|&s| is_door(&level.sectors[s]))
        .collect();
    if doors.is_empty() {
        return Err(EditError::NoLeaf);
    }
    let open = doors.iter().any(|&s| is_closed(&level.sectors[s]));
    let mut new = level.clone();
    for &s in &doors {
        let Sector { floor, ceiling, .. } = &mut new.sectors[s];
        if open {
            ceiling.rest = ceiling.high;
            if ceiling.rest <= floor.rest {
                floor.rest = floor.low;
            }
        } else {
            ceiling.rest = ceiling.low;
            if ceiling.rest > floor.rest {
                floor.rest = floor.high;
            }
        }
    }
    let closed = |id: Option<SectorId>| {
        let sector = id.and_then(|s| new.sectors.get(s.0 as usize));
        sector.is_some_and(|s| is_closed(s) && s.ceiling.high > s.floor.low)
    };
    for wall in &mut new.walls {
        let sides = [wall.left, wall.right];
        let touched = sides
            .iter()
            .flatten()
            .any(|s| doors.contains(&(s.0 as usize)));
        if let WallKind::Edge { shut } = &mut wall.kind
            && touched
        {
            *shut = sides.into_iter().any(closed);
        }
    }
    Ok(new)
}

/// Cuts an opening into a wall, with its middle as near to `at` as the wall allows.
///
/// # Errors
/// Where the wall is too short, has an opening there already, is a pillar's, has nothing behind
/// it (in a level whose walls name their sides), or is see-through.
pub fn add_opening(
    level: &Level,
    id: WallId,
    at: DVec2,
    width: f64,
    opening: Opening,
) -> Result<Level, EditError> {
    let wall = wall(level, id)?;
    match &wall.kind {
        WallKind::Opening(_) => return Err(EditError::Overlaps),
        WallKind::Edge { .. } => return Err(EditError::SeeThrough),
        WallKind::Solid if wall.outline.is_some() => return Err(EditError::Pillar),
        WallKind::Solid if level.interior == Interior::Sides => {
            if wall.left.is_none() || wall.right.is_none() {
                return Err(EditError::OuterWall);
            }
        }
        WallKind::Solid | WallKind::Outline => {}
    }
    if !(width.is_finite() && width > 0.0 && at.is_finite()) {
        return Err(EditError::Width(width));
    }
    let (from, to) = (level.grid.to_level(wall.from), level.grid.to_level(wall.to));
    let length = from.distance(to);
    // Less than that is rounding, and no stretch of wall.
    let slack = level.grid.step.length();
    if width > length + slack {
        return Err(EditError::TooWide {
            width,
            available: length,
        });
    }
    let width = width.min(length);
    let start = (along(from, to, at) - width / 2.0).clamp(0.0, length - width);
    let end = start + width;
    let in_line = |w: &&Wall| {
        [w.from, w.to]
            .iter()
            .all(|&p| is_in_line([wall.from, wall.to], p))
    };
    let taken = (level.walls.iter().filter(|w| is_opening(w)))
        .filter(in_line)
        .map(|w| [w.from, w.to].map(|p| along(from, to, level.grid.to_level(p))))
        .any(|[p, q]| p.min(q) < end - slack && start + slack < p.max(q));
    if taken {
        return Err(EditError::Overlaps);
    }
    let spot = |t: f64| match t {
        t if t <= slack => (from, true),
        t if t >= length - slack => (to, true),
        t => (from.lerp(to, t / length), false),
    };
    let ((p, p_written), (q, q_written)) = (spot(start), spot(end));
    let mut parts = Parts::of(level);
    let index = id.0 as usize;
    let mut hole = parts.walls[index].clone();
    hole.kind = WallKind::Opening(opening);
    hole.material = None;
    (hole.from, hole.to, hole.written) = (p, q, [p_written, q_written]);
    if wall.kind == WallKind::Outline {
        hole.outline = None;
        (hole.left, hole.right) = (None, None);
        parts.walls.push(hole);
        return finish(level, parts);
    }
    // A solid wall stays so beneath an opening: it has to be parted. Its parts end in grid points.
    let on_grid = |p: DVec2| {
        let point = level.grid.nearest(p);
        point.map_or(p, |g| level.grid.to_level(g))
    };
    (hole.from, hole.to, hole.written) = (on_grid(p), on_grid(q), [true, true]);
    let solid = parts.walls[index].clone();
    let mut pieces = Vec::new();
    for (a, b) in [(solid.from, hole.from), (hole.to, solid.to)] {
        if a != b {
            let mut piece = solid.clone();
            (piece.from, piece.to) = (a, b);
            pieces.push(piece);
        }
    }
    pieces.insert(pieces.len().min(usize::from(solid.from != hole.from)), hole);
    parts.walls.splice(index..=index, pieces);
    finish(level, parts)
}

/// Walls an opening up.
///
/// # Errors
/// Where the wall is no opening.
pub fn remove_opening(level: &Level, id: WallId) -> Result<Level, EditError> {
    if !is_opening(wall(level, id)?) {
        return Err(EditError::NotAnOpening);
    }
    let mut parts = Parts::of(level);
    for piece in leaf(level, id).rev() {
        if has_wall_beneath(level, &level.walls[piece]) {
            parts.walls.remove(piece);
        } else {
            parts.walls[piece].kind = WallKind::Solid;
        }
    }
    finish(level, parts)
}

/// Whether there is a wall where an opening is, which needs only to be left.
pub(super) fn has_wall_beneath(level: &Level, opening: &Wall) -> bool {
    let lies_on =
        |w: &Wall, on: &Wall| is_on(on.from, on.to, w.from) && is_on(on.from, on.to, w.to);
    (level.walls.iter())
        .filter(|w| w.kind == WallKind::Outline)
        .any(|w| lies_on(opening, w) || lies_on(w, opening))
}
