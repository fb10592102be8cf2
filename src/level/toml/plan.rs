//! Rooms and zones become outlines and draft walls; with [`super::standing`], the plan without its
//! openings.
//!
//! In: the checked tables of a file. Out: a [`Plan`], into which [`super::opening`] then cuts.

use std::ops::Range;

use glam::DVec2;
use toml::Spanned;

use crate::geom::{Grid, Step};

use super::super::draft::{DraftWall, Numbers};
use super::super::finding::Place;
use super::super::model::{Height, Outline, OutlineId, Sector, SectorId, WallKind};
use super::super::scene::MaterialId;
use super::super::snap::{RawPoint, choose_grid};
use super::error::TomlError;
use super::names::Names;
use super::outline::{check, contains, inner_point};

use super::record::{Corners, File, Finite, Name, NumbersKind, Point2};
use super::sides::{add_sectors, height};
use super::source::SourceText;
use super::standing::{add_free_walls, add_pillars, round_pillars};

/// What the file says once for all.
pub(super) struct Plan<'a> {
    pub source: &'a SourceText<'a>,
    pub grid: Grid,
    pub materials: &'a Names,
    pub walls: Vec<DraftWall>,
    pub sectors: Vec<Sector>,
    pub outlines: Vec<Outline>,
    pub rooms: Vec<RoomShape>,
    pub room_names: Names,
    /// Every straight wall that an opening can be cut into.
    pub edges: Vec<Edge>,
    /// Floor and ceiling where no room says otherwise.
    pub default_heights: [f64; 2],
}

/// A room's outline and heights, for the openings cut into it and the zones laid in it.
pub(super) struct RoomShape {
    pub corners: Vec<DVec2>,
    pub counterclockwise: bool,
    pub floor: f64,
    pub ceiling: f64,
}

/// A straight wall that an opening can be cut into.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub from: DVec2,
    pub to: DVec2,
    /// The room whose edge it is; `None` for a free-standing wall.
    pub room: Option<usize>,
}

/// The plan of a file, without its openings.
pub(super) fn read_plan<'a>(
    source: &'a SourceText<'a>,
    file: &File,
    materials: &'a Names,
) -> Result<Plan<'a>, TomlError> {
    let defaults = &file.defaults;
    let floor = defaults.floor.map_or(0.0, |z| z.0);
    let ceiling = defaults
        .ceiling
        .as_ref()
        .map_or(floor + 3.0, |z| z.get_ref().0);
    if let Some(given) = defaults.ceiling.as_ref()
        && ceiling <= floor
    {
        return Err(TomlError::CeilingNotAboveFloor {
            place: source.place(given.span()),
            what: "the defaults".into(),
            floor,
            ceiling,
        });
    }
    let mut plan = Plan {
        source,
        grid: provisional_grid(source, file)?,
        materials,
        walls: Vec::new(),
        sectors: Vec::new(),
        outlines: Vec::new(),
        rooms: Vec::new(),
        room_names: Names::of(source, "room", file.room.iter().map(|r| &r.get_ref().name))?,
        edges: Vec::new(),
        default_heights: [floor, ceiling],
    };
    add_rooms(&mut plan, file)?;
    add_pillars(&mut plan, file)?;
    // Outlines of zones come last, so that they, not the rooms around them, give the sector; the
    // walls of pillars and the free-standing ones follow those of the rooms.
    add_zones(&mut plan, file)?;
    add_free_walls(&mut plan, file)?;
    add_sectors(&mut plan, file)?;
    if file.room.is_empty() && file.sector.is_empty() {
        plan.sectors.insert(0, whole_level(file, floor, ceiling));
        for outline in &mut plan.outlines {
            outline.sector = outline.sector.map(|s| SectorId(s.0 + 1));
        }
        for side in (plan.walls.iter_mut()).flat_map(|w| [&mut w.left, &mut w.right]) {
            *side = side.map(|s| SectorId(s.0 + 1));
        }
    }
    Ok(plan)
}

/// The sector of a level that has walls but no rooms.
fn whole_level(file: &File, floor: f64, ceiling: f64) -> Sector {
    let surface = |name: &Option<Name>| name.as_ref().map(|n| n.get_ref().clone());
    Sector {
        name: file.name.clone(),
        floor: Height::fixed(floor),
        ceiling: Height::fixed(ceiling),
        light: None,
        floor_material: surface(&file.defaults.materials.floor),
        ceiling_material: surface(&file.defaults.materials.ceiling),
        place: Place::Text { line: 1, column: 1 },
    }
}

/// The grid that holds every written corner, on which outlines are checked exactly.
fn provisional_grid(source: &SourceText, file: &File) -> Result<Grid, TomlError> {
    let mut points = Vec::new();
    let mut add_shape = |rect: &Option<Spanned<[Finite; 4]>>, corners: &Option<Corners>| {
        points.extend(rect.iter().flat_map(|r| rect_corners(source, r)));
        points.extend(corners.iter().flat_map(|c| written_points(source, c)));
    };
    for room in file.room.iter().map(Spanned::get_ref) {
        add_shape(&room.rect, &room.outline);
    }
    for zone in file.zone.iter().map(Spanned::get_ref) {
        add_shape(&zone.rect, &zone.outline);
    }
    for pillar in file.pillar.iter().map(Spanned::get_ref) {
        add_shape(&pillar.rect, &pillar.outline);
    }
    for table in &file.pillar {
        let rings = round_pillars(source, table)?;
        points.extend(rings.into_iter().flatten());
    }
    let walls = file.wall.iter().map(|wall| &wall.get_ref().points);
    let lines = file.line.iter().map(|line| &line.get_ref().points);
    for corners in walls.chain(lines) {
        points.extend(written_points(source, corners));
    }
    // The ends of openings may have more decimals; a stray one must not stretch the grid.
    let low = points.iter().map(|p| p.at).reduce(DVec2::min);
    let high = points.iter().map(|p| p.at).reduce(DVec2::max);
    let openings = [&file.opening, &file.door, &file.window, &file.archway];
    let ends = (openings.into_iter().flatten())
        .filter_map(|table| table.get_ref().points.as_ref())
        .flat_map(|ends| written(source, ends.get_ref()))
        .filter(|p| low.is_some_and(|low| low.cmple(p.at).all()))
        .filter(|p| high.is_some_and(|high| high.cmpge(p.at).all()));
    points.extend(ends.collect::<Vec<_>>());
    if points.is_empty() {
        // Nothing to check; whatever is missing is reported where it is missed.
        return Ok(Grid {
            step: Step::Decimal(4),
            origin: [0, 0],
        });
    }
    Ok(choose_grid(numbers(file), &points)?)
}

/// What kind of numbers a file says that its coordinates are.
pub(super) fn numbers(file: &File) -> Numbers {
    match file.numbers {
        NumbersKind::Decimal => Numbers::Decimal,
        NumbersKind::Binary => Numbers::Binary,
    }
}

fn add_rooms(plan: &mut Plan, file: &File) -> Result<(), TomlError> {
    for table in &file.room {
        let room = table.get_ref();
        let place = plan.source.place(table.span());
        let what = format!("room `{}`", room.name.get_ref());
        let corners = shape(plan, &what, place, &room.rect, &room.outline)?;
        let counterclockwise = check(&plan.grid, &what, place, &corners)?;
        let defaults = plan.default_heights.map(Height::fixed);
        let floor = height(plan, &what, room.floor, &room.floor_range, defaults[0])?;
        let ceiling = height(plan, &what, room.ceiling, &room.ceiling_range, defaults[1])?;
        check_heights(&what, place, [floor, ceiling])?;
        let defaults = &file.defaults.materials;
        let walls = room.materials.walls.as_ref().or(defaults.walls.as_ref());
        let material = find_material(plan, walls)?;
        let sector = SectorId(plan.sectors.len() as u32);
        let on_floor = room.materials.floor.as_ref().or(defaults.floor.as_ref());
        let on_ceiling = (room.materials.ceiling.as_ref()).or(defaults.ceiling.as_ref());
        let record = Sector {
            name: Some(room.name.get_ref().clone()),
            floor,
            ceiling,
            light: room.light.map(|share| share.0),
            floor_material: surface_name(plan, on_floor)?,
            ceiling_material: surface_name(plan, on_ceiling)?,
            place,
        };
        plan.sectors.push(record);
        let points: Vec<DVec2> = corners.iter().map(|c| c.at).collect();
        let room_index = plan.rooms.len();
        plan.edges.extend(ring(&points).map(|(from, to)| Edge {
            from,
            to,
            room: Some(room_index),
        }));
        plan.rooms.push(RoomShape {
            corners: points,
            counterclockwise,
            floor: floor.rest,
            ceiling: ceiling.rest,
        });
        let area = Area {
            sector: Some(sector),
            zone: false,
            kind: WallKind::Outline,
            material,
            counterclockwise,
        };
        add_area(plan, &corners, area);
    }
    Ok(())
}

fn add_zones(plan: &mut Plan, file: &File) -> Result<(), TomlError> {
    for (i, table) in file.zone.iter().enumerate() {
        let zone = table.get_ref();
        let place = plan.source.place(table.span());
        let what = match &zone.name {
            Some(name) => format!("zone `{name}`"),
            None => format!("zone {}", i + 1),
        };
        let corners = shape(plan, &what, place, &zone.rect, &zone.outline)?;
        let counterclockwise = check(&plan.grid, &what, place, &corners)?;
        let points: Vec<DVec2> = corners.iter().map(|c| c.at).collect();
        let inside = inner_point(&points);
        let room = plan
            .rooms
            .iter()
            .rposition(|r| contains(&r.corners, inside));
        if room.is_none() && !plan.rooms.is_empty() {
            return Err(TomlError::ZoneOutsideRooms { place, what });
        }
        let around = room.map_or(plan.default_heights.map(Height::fixed), |r| {
            [plan.sectors[r].floor, plan.sectors[r].ceiling]
        });
        let floor = height(plan, &what, zone.floor, &zone.floor_range, around[0])?;
        let ceiling = height(plan, &what, zone.ceiling, &zone.ceiling_range, around[1])?;
        check_heights(&what, place, [floor, ceiling])?;
        let surface = |own: &Option<Name>, pick: fn(&Sector) -> &Option<String>| match own {
            Some(_) => surface_name(plan, own.as_ref()),
            None => Ok(room.and_then(|r| pick(&plan.sectors[r]).clone())),
        };
        let record = Sector {
            name: zone.name.clone(),
            floor,
            ceiling,
            light: (zone.light.map(|share| share.0))
                .or_else(|| room.and_then(|r| plan.sectors[r].light)),
            floor_material: surface(&zone.materials.floor, |s| &s.floor_material)?,
            ceiling_material: surface(&zone.materials.ceiling, |s| &s.ceiling_material)?,
            place,
        };
        let area = Area {
            sector: Some(SectorId(plan.sectors.len() as u32)),
            zone: true,
            kind: WallKind::Edge { shut: false },
            material: None,
            counterclockwise,
        };
        plan.sectors.push(record);
        add_area(plan, &corners, area);
    }
    Ok(())
}

/// What the edges of one outline have in common.
pub(super) struct Area {
    pub sector: Option<SectorId>,
    pub zone: bool,
    pub kind: WallKind,
    pub material: Option<MaterialId>,
    pub counterclockwise: bool,
}

pub(super) fn add_area(plan: &mut Plan, corners: &[RawPoint], area: Area) {
    let outline = OutlineId(plan.outlines.len() as u32);
    plan.outlines.push(Outline {
        sector: area.sector,
        zone: area.zone,
    });
    let (left, right) = if area.counterclockwise {
        (area.sector, None)
    } else {
        (None, area.sector)
    };
    for (i, from) in corners.iter().enumerate() {
        let to = &corners[(i + 1) % corners.len()];
        plan.walls.push(DraftWall {
            from: from.at,
            to: to.at,
            written: [from.written, to.written],
            kind: area.kind.clone(),
            left,
            right,
            outline: Some(outline),
            material: area.material,
            place: from.place,
        });
    }
}

/// The corners of an area that is given as either `rect` or `outline`.
pub(super) fn shape(
    plan: &Plan,
    what: &str,
    place: Place,
    rect: &Option<Spanned<[Finite; 4]>>,
    outline: &Option<Corners>,
) -> Result<Vec<RawPoint>, TomlError> {
    match (rect, outline) {
        (Some(rect), None) => Ok(rect_corners(plan.source, rect)),
        (None, Some(outline)) => Ok(written_points(plan.source, outline)),
        _ => Err(TomlError::Keys {
            place,
            what: what.into(),
            needed: "either `rect = [x0, y0, x1, y1]` or `outline = [[x, y], …]`".into(),
        }),
    }
}

fn rect_corners(source: &SourceText, rect: &Spanned<[Finite; 4]>) -> Vec<RawPoint> {
    let [x0, y0, x1, y1] = rect.get_ref().map(|x| x.0);
    let place = source.place(rect.span());
    [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
        .map(|p| RawPoint {
            at: p.into(),
            written: true,
            place,
        })
        .to_vec()
}

pub(super) fn written_points(source: &SourceText, points: &Corners) -> Vec<RawPoint> {
    written(source, points.get_ref())
}

fn written(source: &SourceText, points: &[Spanned<Point2>]) -> Vec<RawPoint> {
    let point = |p: &Spanned<Point2>| RawPoint {
        at: vec2(*p.get_ref()),
        written: true,
        place: source.place(p.span()),
    };
    points.iter().map(point).collect()
}

/// The point's two numbers.
pub(super) fn vec2([x, y]: Point2) -> DVec2 {
    DVec2::new(x.0, y.0)
}

/// The edges of a polygon, from each corner to the next.
pub(super) fn ring(corners: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().copied().zip(next.copied())
}

/// A place must be one that a person can be in, if only while it stands open.
fn check_heights(what: &str, place: Place, heights: [Height; 2]) -> Result<(), TomlError> {
    let [floor, ceiling] = [heights[0].low, heights[1].high];
    if ceiling > floor {
        return Ok(());
    }
    Err(TomlError::CeilingNotAboveFloor {
        place,
        what: what.into(),
        floor,
        ceiling,
    })
}

/// The material of a name, where one is given.
pub(super) fn find_material(
    plan: &Plan,
    name: Option<&Name>,
) -> Result<Option<MaterialId>, TomlError> {
    let index = name.map(|n| plan.materials.find(plan.source, n));
    Ok(index.transpose()?.map(|i| MaterialId(i as u32)))
}

/// The name itself, once it is known that such a material exists.
pub(super) fn surface_name(plan: &Plan, name: Option<&Name>) -> Result<Option<String>, TomlError> {
    find_material(plan, name)?;
    Ok(name.map(|n| n.get_ref().clone()))
}

impl Plan<'_> {
    /// Line and column of a span.
    pub(super) fn place(&self, span: Range<usize>) -> Place {
        self.source.place(span)
    }
}
