//! Pillars and free-standing walls: what stands within rooms and is no edge of them.

use glam::DVec2;
use toml::Spanned;

use super::super::draft::DraftWall;
use super::super::model::WallKind;
use super::super::snap::RawPoint;
use super::error::TomlError;
use super::outline::{check, grid_points};
use super::plan::{Area, Edge, Plan, add_area, find_material, shape, vec2, written_points};
use super::record::{File, Pillar};
use super::source::SourceText;

pub(super) fn add_pillars(plan: &mut Plan, file: &File) -> Result<(), TomlError> {
    for (i, table) in file.pillar.iter().enumerate() {
        let pillar = table.get_ref();
        let place = plan.source.place(table.span());
        let what = match &pillar.name {
            Some(name) => format!("pillar `{name}`"),
            None => format!("pillar {}", i + 1),
        };
        let material = (pillar.material.as_ref()).or(file.defaults.materials.walls.as_ref());
        let material = find_material(plan, material)?;
        let round = round_pillars(plan.source, table)?;
        let rings = if round.is_empty() {
            vec![shape(plan, &what, place, &pillar.rect, &pillar.outline)?]
        } else {
            round
        };
        for corners in rings {
            let counterclockwise = check(&plan.grid, &what, place, &corners)?;
            let area = Area {
                sector: None,
                zone: false,
                kind: WallKind::Solid,
                material,
                counterclockwise,
            };
            add_area(plan, &corners, area);
        }
    }
    Ok(())
}

/// The corners of the round pillars of a table; none where its pillar is not round.
pub(super) fn round_pillars(
    source: &SourceText,
    table: &Spanned<Pillar>,
) -> Result<Vec<Vec<RawPoint>>, TomlError> {
    const USUAL_SIDES: u32 = 16;
    const MOST_SIDES: u32 = 1000;
    let pillar = table.get_ref();
    let place = source.place(table.span());
    let given = [
        pillar.center.is_some(),
        pillar.centers.is_some(),
        pillar.rect.is_some(),
        pillar.outline.is_some(),
    ];
    let round = pillar.center.is_some() || pillar.centers.is_some();
    if given.iter().filter(|g| **g).count() != 1 || round != pillar.radius.is_some() {
        return Err(TomlError::Keys {
            place,
            what: "a pillar".into(),
            needed: "either `center` (or `centers`) and `radius`, or `rect`, or `outline`".into(),
        });
    }
    if !round && let Some(sides) = &pillar.sides {
        return Err(TomlError::Misplaced {
            place: source.place(sides.span()),
            what: "a pillar with corners of its own",
            key: "sides",
        });
    }
    let Some(radius) = pillar.radius else {
        return Ok(Vec::new());
    };
    let sides = pillar.sides.as_ref().map_or(USUAL_SIDES, |s| *s.get_ref());
    if let Some(given) = &pillar.sides
        && !(3..=MOST_SIDES).contains(&sides)
    {
        return Err(TomlError::Parse {
            place: source.place(given.span()),
            message: format!("a pillar has 3 to {MOST_SIDES} sides, not {sides}"),
        });
    }
    let single = pillar.center.iter();
    let several = pillar.centers.iter().flat_map(|c| c.get_ref());
    let turn = pillar.rotation.map_or(0.0, |a| a.0.to_radians());
    Ok(single
        .chain(several)
        .map(|center| {
            let place = source.place(center.span());
            let middle = vec2(*center.get_ref());
            let corner = |i| {
                let angle = turn + std::f64::consts::TAU * f64::from(i) / f64::from(sides);
                RawPoint {
                    at: middle + DVec2::from_angle(angle) * radius.0,
                    written: false,
                    place,
                }
            };
            (0..sides).map(corner).collect()
        })
        .collect())
}

pub(super) fn add_free_walls(plan: &mut Plan, file: &File) -> Result<(), TomlError> {
    for (i, table) in file.wall.iter().enumerate() {
        let wall = table.get_ref();
        let place = plan.source.place(table.span());
        let what = match &wall.name {
            Some(name) => format!("wall `{name}`"),
            None => format!("wall {}", i + 1),
        };
        let points = written_points(plan.source, &wall.points);
        let needed = if wall.closed { 3 } else { 2 };
        if points.len() < needed {
            return Err(TomlError::TooFewCorners {
                place,
                what,
                count: points.len(),
                needed,
            });
        }
        for pair in points.windows(2) {
            grid_points(&plan.grid, &what, pair)?;
        }
        if wall.closed {
            let last = points[points.len() - 1];
            grid_points(&plan.grid, &what, &[points[0], last])?;
        }
        let material = wall
            .material
            .as_ref()
            .or(file.defaults.materials.walls.as_ref());
        let material = find_material(plan, material)?;
        let n = points.len();
        for i in 0..if wall.closed { n } else { n - 1 } {
            let (from, to) = (points[i], points[(i + 1) % n]);
            plan.edges.push(Edge {
                from: from.at,
                to: to.at,
                room: None,
            });
            plan.walls.push(DraftWall {
                from: from.at,
                to: to.at,
                written: [true, true],
                kind: WallKind::Outline,
                left: None,
                right: None,
                outline: None,
                material,
                place: from.place,
            });
        }
    }
    Ok(())
}
