//! From changed walls back to a level, and whether that is still one that can be written.

use glam::DVec2;

use crate::geom::{GridPoint, Step};

use super::super::draft::{Draft, DraftInterior, DraftWall, Numbers};
use super::super::model::{Interior, Level, Outline, Sector, Wall};
use super::super::outline;
use super::super::snap::snap;
use super::super::toml::{contains, inner_point};
use super::EditError;

/// A level taken apart.
pub(super) struct Parts {
    pub walls: Vec<DraftWall>,
    pub sectors: Vec<Sector>,
    pub outlines: Vec<Outline>,
}

impl Parts {
    pub(super) fn of(level: &Level) -> Parts {
        Parts {
            walls: level.walls.iter().map(|w| draft(level, w)).collect(),
            sectors: level.sectors.clone(),
            outlines: level.outlines.clone(),
        }
    }
}

/// A wall in the numbers of the file.
pub(super) fn draft(level: &Level, wall: &Wall) -> DraftWall {
    DraftWall {
        from: level.grid.to_level(wall.from),
        to: level.grid.to_level(wall.to),
        written: [true, true],
        kind: wall.kind.clone(),
        left: wall.left,
        right: wall.right,
        outline: wall.outline,
        material: wall.material,
        place: wall.place,
    }
}

/// Findings that the door to the grid makes; those about the level as it was are dropped.
const MADE_ANEW: [&str; 2] = ["snapped", "joined"];

/// The level of changed parts; everything else is as in `level`.
pub(super) fn finish(level: &Level, parts: Parts) -> Result<Level, EditError> {
    if parts.walls.iter().any(|w| w.from == w.to) {
        return Err(EditError::NoLength);
    }
    let without_length = |l: &Level| -> usize {
        let zero = l.findings.iter().filter(|f| f.code == "zero-length-wall");
        zero.count()
    };
    let draft = Draft {
        name: level.name.clone(),
        source: level.source.clone(),
        unit: level.unit.clone(),
        numbers: match level.grid.step {
            Step::Decimal(_) => Numbers::Decimal,
            Step::Binary(_) => Numbers::Binary,
        },
        walls: parts.walls,
        sectors: parts.sectors,
        outlines: parts.outlines,
        interior: match &level.interior {
            Interior::Sides => DraftInterior::Sides,
            Interior::Outlines => DraftInterior::Outlines,
            Interior::Enclosed { starts } => DraftInterior::Enclosed {
                starts: starts.iter().map(|&p| level.grid.to_level(p)).collect(),
            },
        },
        scene: level.scene.clone(),
        findings: (level.findings.iter())
            .filter(|f| !MADE_ANEW.contains(&f.code))
            .cloned()
            .collect(),
    };
    let mut new = snap(draft)?;
    name_sides(&mut new);
    if without_length(&new) > without_length(level) {
        return Err(EditError::NoLength);
    }
    check(level, &new)?;
    Ok(new)
}

/// An area may run the other way around than before; the sides that its walls name follow.
fn name_sides(level: &mut Level) {
    if level.interior == Interior::Sides {
        return;
    }
    let corners = outline::corners(level);
    let counterclockwise = |c: &Option<Vec<GridPoint>>| {
        c.as_ref()
            .is_some_and(|points| outline::doubled_area(points) > 0)
    };
    let turns: Vec<bool> = corners.iter().map(counterclockwise).collect();
    for wall in &mut level.walls {
        let Some(id) = wall.outline else { continue };
        let sector = level.outlines[id.0 as usize].sector;
        (wall.left, wall.right) = if turns[id.0 as usize] {
            (sector, None)
        } else {
            (None, sector)
        };
    }
}

/// Whether areas that were sound still are.
fn check(old: &Level, new: &Level) -> Result<(), EditError> {
    let (before, after) = (outline::corners(old), outline::corners(new));
    // What was wrong before may stay so; only the areas of an unchanged list can be compared.
    let known = before.len() == after.len();
    let (in_old, in_new) = (in_units(old, &before), in_units(new, &after));
    for (i, area) in new.outlines.iter().enumerate() {
        let unchanged = known && in_old[i] == in_new[i];
        if unchanged || is_simple(&after[i]) || known && !is_simple(&before[i]) {
            continue;
        }
        return Err(EditError::Crosses {
            what: outline::called(new, area),
        });
    }
    match stray_zone(new, &in_new) {
        Some(zone) if stray_zone(old, &in_old).is_none() => Err(EditError::ZoneOutside {
            what: outline::called(new, zone),
        }),
        _ => Ok(()),
    }
}

fn is_simple(corners: &Option<Vec<GridPoint>>) -> bool {
    corners.as_ref().is_some_and(|points| {
        outline::self_meeting(points).is_none() && outline::doubled_area(points) != 0
    })
}

/// The corners of areas in the level's own coordinates; none where walls do not close.
fn in_units(level: &Level, corners: &[Option<Vec<GridPoint>>]) -> Vec<Vec<DVec2>> {
    let polygon = |c: &Option<Vec<GridPoint>>| -> Vec<DVec2> {
        let points = c.iter().flatten();
        points.map(|&p| level.grid.to_level(p)).collect()
    };
    corners.iter().map(polygon).collect()
}

/// A zone that lies in no room, by the very test of the reader.
fn stray_zone<'l>(level: &'l Level, polygons: &[Vec<DVec2>]) -> Option<&'l Outline> {
    if level.interior != Interior::Outlines {
        return None;
    }
    let areas = || {
        level
            .outlines
            .iter()
            .zip(polygons)
            .filter(|(_, p)| !p.is_empty())
    };
    let in_room = |zone: &[DVec2]| {
        let inside = inner_point(zone);
        let mut rooms = areas().filter(|(o, _)| !o.zone && o.sector.is_some());
        rooms.any(|(_, room)| contains(room, inside))
    };
    let mut zones = areas().filter(|(o, _)| o.zone);
    zones.find(|(_, zone)| !in_room(zone)).map(|(o, _)| o)
}
