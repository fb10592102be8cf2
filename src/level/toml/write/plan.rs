//! The plan: rooms, zones, pillars, walls, openings; or sectors and lines.

use std::collections::HashSet;

use crate::geom::{GridPoint, Step};

use super::super::super::model::{
    Height, Interior, Level, OpeningStyle, OutlineId, Sector, Wall, WallKind,
};
use super::super::super::outline;
use super::text::{Text, names, numbers, point};
use super::{WriteError, state, style};

/// Writes the head of the file and everything that is plan.
pub(super) fn plan(
    text: &mut Text,
    level: &Level,
    plain_openings: bool,
    left_out: &mut Vec<String>,
) -> Result<(), WriteError> {
    if level.unit != "m" {
        text.string("unit", Some(&level.unit));
    }
    if let Step::Binary(_) = level.grid.step {
        text.string("numbers", Some("binary"));
    }
    if level.interior == Interior::Sides {
        for (number, sector) in level.sectors.iter().enumerate() {
            text.head(&format!("[[sector]]  # {number}"));
            text.string("name", sector.name.as_deref());
            place(text, sector, None);
            materials(text, sector, None);
        }
        lines(text, level, |_| true);
        return Ok(());
    }
    if let Interior::Enclosed { starts } = &level.interior
        && !starts.is_empty()
    {
        let starts: Vec<String> = (starts.iter())
            .map(|&p| point(level.grid.to_level(p)))
            .collect();
        text.list("start", &starts);
    }
    let usual = defaults(text, level, left_out);
    outlines(text, level, usual, left_out)?;
    free_walls(text, level);
    let host = |w: &Wall| !plain_openings && has_host(level, w);
    for wanted in [
        OpeningStyle::Door,
        OpeningStyle::Window,
        OpeningStyle::Archway,
    ] {
        for wall in &level.walls {
            match &wall.kind {
                WallKind::Opening(o) if o.style == wanted && host(wall) => {
                    opening(text, level, wall)
                }
                _ => {}
            }
        }
    }
    lines(text, level, |wall| match &wall.kind {
        _ if wall.outline.is_some() => false,
        WallKind::Outline => false,
        WallKind::Opening(_) => !host(wall),
        WallKind::Solid | WallKind::Edge { .. } => true,
    });
    Ok(())
}

/// Floor and ceiling that are not written where they are as in most rooms.
type Usual = Option<(f64, f64)>;

/// Writes what holds for the whole level; the heights that need not be written again.
fn defaults(text: &mut Text, level: &Level, left_out: &mut Vec<String>) -> Usual {
    let surfaces = |s: &Sector| {
        names(&[
            ("floor", s.floor_material.as_deref()),
            ("ceiling", s.ceiling_material.as_deref()),
        ])
    };
    let (heights, materials) = if level.interior == Interior::Outlines {
        (most_rooms(level)?, None)
    } else {
        let Some(whole) = level.sectors.first() else {
            left_out.push("that there are no heights: the floor is written as 0".into());
            return None;
        };
        if whole.floor.moves() || whole.ceiling.moves() || whole.light.is_some() {
            left_out.push("the light and the movements of the level as a whole".into());
        }
        ((whole.floor.rest, whole.ceiling.rest), surfaces(whole))
    };
    if heights == (0.0, 3.0) && materials.is_none() {
        return Some(heights);
    }
    text.head("[defaults]");
    text.unusual("floor", heights.0, 0.0);
    text.unusual("ceiling", heights.1, heights.0 + 3.0);
    if let Some(materials) = materials {
        text.key("materials", &materials);
    }
    Some(heights)
}

/// The floor and ceiling that most rooms have; the first of those that equally many have.
fn most_rooms(level: &Level) -> Usual {
    let rooms = (level.outlines.iter()).filter(|o| !o.zone);
    let heights: Vec<(f64, f64)> = rooms
        .filter_map(|o| level.sectors.get(o.sector?.0 as usize))
        .map(|s| (s.floor.rest, s.ceiling.rest))
        .filter(|(floor, ceiling)| floor < ceiling)
        .collect();
    let votes = |pair: &(f64, f64)| heights.iter().filter(|h| *h == pair).count();
    // `max_by_key` takes the last of equals, so backwards.
    heights.iter().rev().max_by_key(|pair| votes(pair)).copied()
}

/// Heights, light and materials of a room, zone or sector.
fn place(text: &mut Text, sector: &Sector, usual: Usual) {
    let usual = usual.unzip();
    for (height, usual, key) in [
        (sector.floor, usual.0, "floor"),
        (sector.ceiling, usual.1, "ceiling"),
    ] {
        text.number(key, Some(height.rest).filter(|z| Some(*z) != usual));
        let Height { low, high, .. } = height;
        if height.moves() {
            text.key(&format!("{key}_range"), &numbers(&[low, high]));
        }
    }
    text.number("light", sector.light);
}

/// What is on the walls, the floor and the ceiling.
fn materials(text: &mut Text, sector: &Sector, walls: Option<&str>) {
    let surfaces = names(&[
        ("walls", walls),
        ("floor", sector.floor_material.as_deref()),
        ("ceiling", sector.ceiling_material.as_deref()),
    ]);
    if let Some(names) = surfaces {
        text.key("materials", &names);
    }
}

/// The areas, in their order: each gives way to those after it.
fn outlines(
    text: &mut Text,
    level: &Level,
    usual: Usual,
    left_out: &mut Vec<String>,
) -> Result<(), WriteError> {
    let mut taken = HashSet::new();
    let corners = outline::corners(level);
    for ((id, area), corners) in (0u32..).map(OutlineId).zip(&level.outlines).zip(corners) {
        let sector = area.sector.and_then(|s| level.sectors.get(s.0 as usize));
        let name = sector.and_then(|s| s.name.as_deref());
        let what = outline::called(level, area);
        let Some(corners) = corners else {
            return Err(WriteError::NotClosed { what });
        };
        text.head(&format!("[[{}]]", outline::kind(area)));
        match name {
            Some(name) if area.zone || taken.insert(name.to_string()) => {
                text.string("name", Some(name));
            }
            None if area.zone || area.sector.is_none() => {}
            _ => {
                let stem = name.unwrap_or("Room");
                let free = (1..).map(|n| format!("{stem} {n}"));
                let new = free.into_iter().find(|n| !taken.contains(n));
                let new = new.unwrap_or_default();
                text.string("name", Some(&new));
                taken.insert(new);
            }
        }
        shape(text, level, &corners);
        let mut walls = level.walls.iter().filter(|w| w.outline == Some(id));
        let material = walls.next().and_then(|w| w.material);
        if walls.any(|w| w.material != material) {
            left_out.push(format!(
                "that the walls of {what} are of different materials"
            ));
        }
        let material = material.and_then(|m| level.scene.materials.get(m.0 as usize));
        let material = material.map(|m| &*m.name);
        let Some(sector) = sector else {
            text.string("material", material);
            continue;
        };
        place(text, sector, usual.filter(|_| !area.zone));
        materials(text, sector, material.filter(|_| !area.zone));
    }
    Ok(())
}

/// `rect`, where the corners are in the order in which the reader makes them of one.
fn shape(text: &mut Text, level: &Level, corners: &[GridPoint]) {
    let points: Vec<_> = corners.iter().map(|&p| level.grid.to_level(p)).collect();
    if let [a, b, c, d] = corners
        && a.y == b.y
        && b.x == c.x
        && c.y == d.y
        && d.x == a.x
    {
        let (low, high) = (points[0], points[2]);
        return text.key("rect", &numbers(&[low.x, low.y, high.x, high.y]));
    }
    let points: Vec<String> = points.into_iter().map(point).collect();
    text.list("outline", &points);
}

/// Walls that are no area's edge, joined end to end where they follow each other.
fn free_walls(text: &mut Text, level: &Level) {
    let free = |w: &Wall| w.outline.is_none() && w.kind == WallKind::Outline;
    for chain in chains(level, free) {
        text.head("[[wall]]");
        let mut corners = corners(level, &chain);
        if chain.len() > 2 && chain[0].from == chain[chain.len() - 1].to {
            corners.pop();
            text.list("points", &corners);
            text.key("closed", "true");
        } else {
            text.list("points", &corners);
        }
        material_of(text, level, chain[0]);
    }
}

/// Walls that follow each other in the file and on the plan, and are alike.
fn chains(level: &Level, wanted: impl Fn(&Wall) -> bool) -> Vec<Vec<&Wall>> {
    let mut chains: Vec<Vec<&Wall>> = Vec::new();
    for wall in level.walls.iter().filter(|w| wanted(w)) {
        let alike = |a: &Wall, b: &Wall| {
            (&a.kind, a.left, a.right, a.material) == (&b.kind, b.left, b.right, b.material)
        };
        match chains.last_mut() {
            Some(chain) if (chain.last()).is_some_and(|w| w.to == wall.from && alike(w, wall)) => {
                chain.push(wall);
            }
            _ => chains.push(vec![wall]),
        }
    }
    chains
}

fn corners(level: &Level, chain: &[&Wall]) -> Vec<String> {
    let first = chain.first().map(|w| w.from);
    (first.into_iter())
        .chain(chain.iter().map(|w| w.to))
        .map(|p| point(level.grid.to_level(p)))
        .collect()
}

fn material_of(text: &mut Text, level: &Level, wall: &Wall) {
    let material = wall.material;
    let material = material.and_then(|m| level.scene.materials.get(m.0 as usize));
    text.string("material", material.map(|m| &*m.name));
}

/// Writes walls in the plainest form.
fn lines(text: &mut Text, level: &Level, wanted: impl Fn(&Wall) -> bool) {
    for chain in chains(level, wanted) {
        let wall = chain[0];
        text.head("[[line]]");
        let kind = match &wall.kind {
            WallKind::Solid => None,
            WallKind::Outline => Some("wall"),
            WallKind::Edge { .. } => Some("edge"),
            WallKind::Opening(opening) => Some(style(opening.style)),
        };
        text.string("kind", kind);
        if let WallKind::Opening(opening) = &wall.kind {
            text.string("name", opening.name.as_deref());
            text.number("bottom", opening.bottom);
            text.number("top", opening.top);
        }
        text.string("state", state(&wall.kind));
        for (key, side) in [("left", wall.left), ("right", wall.right)] {
            if let Some(sector) = side {
                text.key(key, &sector.0.to_string());
            }
        }
        text.list("points", &corners(level, &chain));
        material_of(text, level, wall);
    }
}

fn opening(text: &mut Text, level: &Level, wall: &Wall) {
    let WallKind::Opening(opening) = &wall.kind else {
        return;
    };
    text.head(&format!("[[{}]]", style(opening.style)));
    text.string("name", opening.name.as_deref());
    text.list("points", &corners(level, &[wall]));
    text.number("bottom", opening.bottom);
    text.number("top", opening.top);
    text.string("state", state(&wall.kind));
    material_of(text, level, wall);
}

/// Whether an opening lies on a single wall that openings can be cut into.
fn has_host(level: &Level, opening: &Wall) -> bool {
    let usual = match &opening.kind {
        WallKind::Opening(o) => o.style != OpeningStyle::Archway || !o.shut,
        _ => false,
    };
    usual
        && (level.walls.iter())
            .filter(|w| w.kind == WallKind::Outline)
            .any(|w| {
                outline::is_on(w.from, w.to, opening.from)
                    && outline::is_on(w.from, w.to, opening.to)
            })
}
