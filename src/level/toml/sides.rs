//! Sectors and lines: levels whose walls name what lies on their two sides, as those of Doom do.
//!
//! In: the checked tables of a file. Out: sectors and draft walls in the [`Plan`]. Programs write
//! such levels ([`super::write`]); people are better served by rooms.

use std::ops::Range;

use toml::Spanned;

use super::super::draft::DraftWall;
use super::super::model::{Height, Opening, OpeningStyle, Sector, SectorId, WallKind};
use super::error::TomlError;
use super::outline::grid_points;
use super::plan::{Plan, find_material, surface_name, written_points};
use super::record::{DoorState, File, Finite, LineKind, LineTable};

/// Adds the sectors of a level that has some. What goes by outlines cannot stand beside them.
pub(super) fn add_sectors(plan: &mut Plan, file: &File) -> Result<(), TomlError> {
    if file.sector.is_empty() {
        return Ok(());
    }
    refuse_outlines(plan, file)?;
    for (number, table) in file.sector.iter().enumerate() {
        let sector = table.get_ref();
        let what = match &sector.name {
            Some(name) => format!("sector `{name}`"),
            None => format!("sector {number}"),
        };
        let usual = plan.default_heights.map(Height::fixed);
        let record = Sector {
            name: sector.name.clone(),
            floor: height(plan, &what, sector.floor, &sector.floor_range, usual[0])?,
            ceiling: height(plan, &what, sector.ceiling, &sector.ceiling_range, usual[1])?,
            light: sector.light.map(|share| share.0),
            floor_material: surface_name(plan, sector.materials.floor.as_ref())?,
            ceiling_material: surface_name(plan, sector.materials.ceiling.as_ref())?,
            place: plan.place(table.span()),
        };
        plan.sectors.push(record);
    }
    Ok(())
}

fn refuse_outlines(plan: &Plan, file: &File) -> Result<(), TomlError> {
    fn first<T>(tables: &[Spanned<T>]) -> Option<Range<usize>> {
        tables.first().map(Spanned::span)
    }
    let strangers = [
        ("room", first(&file.room)),
        ("zone", first(&file.zone)),
        ("wall", first(&file.wall)),
        ("pillar", first(&file.pillar)),
        ("door", first(&file.door)),
        ("window", first(&file.window)),
        ("archway", first(&file.archway)),
        ("opening", first(&file.opening)),
        ("start", first(&file.start)),
    ];
    for (key, span) in strangers {
        if let Some(span) = span {
            return Err(TomlError::Misplaced {
                place: plan.place(span),
                what: "a level with `[[sector]]`s",
                key,
            });
        }
    }
    Ok(())
}

/// A floor or ceiling, with the range through which it moves.
pub(super) fn height(
    plan: &Plan,
    what: &str,
    given: Option<Finite>,
    range: &Option<Spanned<[Finite; 2]>>,
    usual: Height,
) -> Result<Height, TomlError> {
    let fixed = given.map_or(usual, |z| Height::fixed(z.0));
    let Some(range) = range else {
        return Ok(fixed);
    };
    let [low, high] = range.get_ref().map(|z| z.0);
    let rest = fixed.rest;
    if low <= rest && rest <= high {
        return Ok(Height { rest, low, high });
    }
    Err(TomlError::Degenerate {
        place: plan.place(range.span()),
        what: format!(
            "the range of {what} goes from {low} to {high}, which does not hold the height at \
             which it starts, {rest}; write `[low, high]` around it"
        ),
    })
}

/// Adds the lines of a file, after everything else.
pub(super) fn add_lines(plan: &mut Plan, file: &File) -> Result<(), TomlError> {
    for (number, table) in file.line.iter().enumerate() {
        let line = table.get_ref();
        let what = match &line.name {
            Some(name) => format!("line `{name}`"),
            None => format!("line {number}"),
        };
        let points = written_points(plan.source, &line.points);
        if points.len() < 2 {
            return Err(TomlError::TooFewCorners {
                place: plan.place(table.span()),
                what,
                count: points.len(),
                needed: 2,
            });
        }
        let kind = kind(plan, line)?;
        let left = side(plan, file, &line.left, "left")?;
        let right = side(plan, file, &line.right, "right")?;
        let material = find_material(plan, line.material.as_ref())?;
        for pair in points.windows(2) {
            grid_points(&plan.grid, &what, pair)?;
            plan.walls.push(DraftWall {
                from: pair[0].at,
                to: pair[1].at,
                written: [true, true],
                kind: kind.clone(),
                left,
                right,
                outline: None,
                material,
                place: pair[0].place,
            });
        }
    }
    Ok(())
}

/// The sector that a line names on one of its sides.
fn side(
    plan: &Plan,
    file: &File,
    given: &Option<Spanned<u32>>,
    key: &'static str,
) -> Result<Option<SectorId>, TomlError> {
    let Some(number) = given else {
        return Ok(None);
    };
    let place = plan.place(number.span());
    if file.sector.is_empty() {
        return Err(TomlError::Misplaced {
            place,
            what: "a line in a level without `[[sector]]`s",
            key,
        });
    }
    if *number.get_ref() as usize >= file.sector.len() {
        return Err(TomlError::Degenerate {
            place,
            what: format!(
                "there is no sector {}; the {} of this level are numbered from 0",
                number.get_ref(),
                file.sector.len()
            ),
        });
    }
    Ok(Some(SectorId(*number.get_ref())))
}

fn kind(plan: &Plan, line: &LineTable) -> Result<WallKind, TomlError> {
    let state = line.state.as_ref();
    let closed = |usual| state.map_or(usual, |s| *s.get_ref() == DoorState::Closed);
    let opening = |style| {
        WallKind::Opening(Opening {
            style,
            name: line.name.clone(),
            shut: closed(style == OpeningStyle::Door),
            bottom: line.bottom.as_ref().map(|z| z.get_ref().0),
            top: line.top.as_ref().map(|z| z.get_ref().0),
        })
    };
    let (what, kind) = match line.kind {
        LineKind::Solid => ("a solid line", WallKind::Solid),
        LineKind::Wall => ("a line that is a wall", WallKind::Outline),
        LineKind::Edge => (
            "an edge",
            WallKind::Edge {
                shut: closed(false),
            },
        ),
        LineKind::Door => return checked(plan, line, opening(OpeningStyle::Door)),
        LineKind::Window => return checked(plan, line, opening(OpeningStyle::Window)),
        LineKind::Archway => return checked(plan, line, opening(OpeningStyle::Archway)),
    };
    let state = state.filter(|_| line.kind != LineKind::Edge);
    let needless = [
        ("state", state.map(Spanned::span)),
        ("bottom", line.bottom.as_ref().map(Spanned::span)),
        ("top", line.top.as_ref().map(Spanned::span)),
    ];
    match needless.into_iter().find_map(|(key, at)| Some((key, at?))) {
        Some((key, span)) => Err(TomlError::Misplaced {
            place: plan.place(span),
            what,
            key,
        }),
        None => Ok(kind),
    }
}

/// An opening, if it has any height.
fn checked(plan: &Plan, line: &LineTable, kind: WallKind) -> Result<WallKind, TomlError> {
    if let (Some(bottom), Some(top)) = (&line.bottom, &line.top)
        && top.get_ref().0 <= bottom.get_ref().0
    {
        return Err(TomlError::TopNotAboveBottom {
            place: plan.place(top.span()),
            bottom: bottom.get_ref().0,
            top: top.get_ref().0,
        });
    }
    Ok(kind)
}
