//! From the lists of a map to a draft: checks the lists against each other, makes walls of the
//! linedefs, and tells what was wrong.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::DVec2;

use super::defect::{Defect, Tally};
use super::error::Problem;
use super::raw::{RawLine, RawMap, Specials};
use super::reach::Range;
use super::surfaces::LineSurfaces;
use super::{DoomMap, dressing, movers, things};
use crate::level::draft::{Draft, DraftInterior, DraftWall, Numbers};
use crate::level::scene::Scene;
use crate::level::{Place, Sector, SectorId, WallKind};

/// Makes a draft of a map. `name` is the map's, `source` the file's; `tally` holds what the reader
/// has found already.
pub fn assemble(
    raw: RawMap,
    name: String,
    source: &str,
    mut tally: Tally,
) -> Result<DoomMap, Problem> {
    for (what, n) in [
        ("vertices", raw.vertices.len()),
        ("linedefs", raw.lines.len()),
        ("sectors", raw.sectors.len()),
    ] {
        if n == 0 {
            return Err(Problem::Empty { what });
        }
    }
    let ranges = movers::ranges(&raw, &mut tally);
    let polyobjects = polyobject_lines(&raw);

    let mut walls = Vec::with_capacity(raw.lines.len());
    let mut seen: HashMap<[u64; 4], usize> = HashMap::new();
    for (number, line) in (0u32..).zip(&raw.lines) {
        let Some(mut wall) = wall(&raw, number, line, &mut tally)? else {
            continue;
        };
        if polyobjects.contains(&number) {
            tally.add(Defect::Polyobject, wall.place);
            make_see_through(&mut wall);
        }
        close_door(&mut wall, &ranges);
        let key = corners(&wall);
        match seen.get(&key).map(|&earlier| &walls[earlier]) {
            Some(earlier) if same_wall(earlier, &wall) => {
                tally.add(Defect::Duplicate, wall.place);
                continue;
            }
            Some(_) => tally.add(Defect::Conflict, wall.place),
            None => {
                seen.insert(key, walls.len());
            }
        }
        walls.push(wall);
    }
    check_sectors(&walls, raw.sectors.len(), &mut tally);

    let surfaces = raw.lines.iter().map(|l| surfaces(&raw, l)).collect();
    let scene = Scene {
        lights: things::lights(&raw),
        cameras: things::cameras(&raw),
        dress: dressing::dress(&raw, &name),
        ..Scene::default()
    };
    let draft = Draft {
        name,
        source: source.to_string(),
        unit: "map unit".to_string(),
        numbers: Numbers::Binary,
        walls,
        sectors: sectors(&raw, &ranges),
        outlines: Vec::new(),
        interior: DraftInterior::Sides,
        scene,
        findings: tally.into_findings(),
    };
    Ok(DoomMap {
        draft,
        surfaces,
        things: raw.things,
    })
}

/// The wall that a linedef makes, if it makes one.
fn wall(
    raw: &RawMap,
    number: u32,
    line: &RawLine,
    tally: &mut Tally,
) -> Result<Option<DraftWall>, Problem> {
    let place = Place::Linedef(number);
    let vertex = |n: u32| raw.vertices.get(n as usize).copied();
    let (Some(from), Some(to)) = (vertex(line.v1), vertex(line.v2)) else {
        tally.add(Defect::DanglingVertex, place);
        return Ok(None);
    };
    if from == to {
        tally.add(Defect::ZeroLength, place);
        return Ok(None);
    }

    let exists = |side: &u32| (*side as usize) < raw.sides.len();
    let dangling = [line.front, line.back].iter().flatten().any(|s| !exists(s));
    if dangling {
        tally.add(Defect::DanglingSide, place);
    }
    let sector = |side: Option<u32>| match side.filter(exists) {
        None => Ok(None),
        Some(side) => match raw.sides[side as usize].sector {
            sector if (sector as usize) < raw.sectors.len() => Ok(Some(SectorId(sector))),
            sector => Err(Problem::NoSector {
                line: number,
                side,
                sector,
                n_sectors: raw.sectors.len(),
            }),
        },
    };
    // A linedef's front is its right side.
    let (right, left) = (sector(line.front)?, sector(line.back)?);
    let kind = match (right, left) {
        (None, None) if !dangling => {
            tally.add(Defect::NoSides, place);
            return Ok(None);
        }
        (None, Some(_)) => {
            if !dangling {
                tally.add(Defect::NoFront, place);
            }
            WallKind::Solid
        }
        (Some(_), None) | (None, None) => {
            if line.two_sided && !dangling {
                tally.add(Defect::FlagWithoutBack, place);
            }
            WallKind::Solid
        }
        (Some(_), Some(_)) if !line.two_sided => {
            tally.add(Defect::SidesWithoutFlag, place);
            WallKind::Solid
        }
        (Some(right), Some(left)) => {
            if right == left {
                tally.add(Defect::SameSector, place);
            }
            WallKind::Edge { shut: false }
        }
    };
    Ok(Some(DraftWall {
        from,
        to,
        written: [true, true],
        kind,
        left,
        right,
        outline: None,
        material: None,
        place,
    }))
}

/// Numbers of the linedefs that polyobjects are made of. An explicit line says so itself; a start
/// line begins a loop that goes on, end to start, until it comes back.
fn polyobject_lines(raw: &RawMap) -> BTreeSet<u32> {
    const START_LINE: u32 = 1;
    const EXPLICIT_LINE: u32 = 5;
    let mut found = BTreeSet::new();
    if raw.specials != Specials::Action {
        return found;
    }
    let mut starting_at: HashMap<u32, Vec<u32>> = HashMap::new();
    for (number, line) in (0u32..).zip(&raw.lines) {
        starting_at.entry(line.v1).or_default().push(number);
    }
    for (number, line) in (0u32..).zip(&raw.lines) {
        if line.special == EXPLICIT_LINE {
            found.insert(number);
        }
        if line.special == START_LINE {
            // A polyobject stands free, so at each of its corners one line goes on; where a map
            // has more, all of them are taken: rather too few walls than sight that is missed.
            let mut open = vec![number];
            while let Some(n) = open.pop() {
                if found.insert(n) {
                    let next = starting_at.get(&raw.lines[n as usize].v2);
                    open.extend(next.into_iter().flatten());
                }
            }
        }
    }
    found
}

/// Takes a polyobject's wall away. Where it had one side, the place behind it is given the same
/// sector: once the polyobject has moved off, that is what one sees there.
fn make_see_through(wall: &mut DraftWall) {
    wall.left = wall.left.or(wall.right);
    wall.right = wall.right.or(wall.left);
    wall.kind = WallKind::Edge { shut: false };
}

/// Marks an edge as shut when a sector beside it is closed at rest and can open.
fn close_door(wall: &mut DraftWall, ranges: &[Range]) {
    let door = |sector: &SectorId| {
        let range = &ranges[sector.0 as usize];
        range.ceiling.rest <= range.floor.rest && range.ceiling.high > range.floor.low
    };
    if let WallKind::Edge { shut } = &mut wall.kind {
        *shut = [wall.left, wall.right].iter().flatten().any(door);
    }
}

/// The wall's two corners, the same for both directions.
fn corners(wall: &DraftWall) -> [u64; 4] {
    let [a, b] = [corner(wall.from), corner(wall.to)];
    let [first, second] = if a <= b { [a, b] } else { [b, a] };
    [first[0], first[1], second[0], second[1]]
}

/// A point as a key; the two zeros are one.
fn corner(p: DVec2) -> [u64; 2] {
    [(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits()]
}

/// Whether two walls between the same corners are the same in all that counts.
fn same_wall(a: &DraftWall, b: &DraftWall) -> bool {
    let sides = if a.from == b.from {
        [b.left, b.right]
    } else {
        [b.right, b.left]
    };
    a.kind == b.kind && [a.left, a.right] == sides
}

/// Looks for sectors that no wall names and for sectors whose boundary does not close.
fn check_sectors(walls: &[DraftWall], n_sectors: usize, tally: &mut Tally) {
    let mut used = vec![false; n_sectors];
    let mut degree: BTreeMap<(u32, [u64; 2]), u32> = BTreeMap::new();
    for wall in walls {
        for sector in [wall.left, wall.right].into_iter().flatten() {
            used[sector.0 as usize] = true;
        }
        // A wall with the same sector on both sides bounds nothing.
        if wall.left == wall.right {
            continue;
        }
        for sector in [wall.left, wall.right].into_iter().flatten() {
            for end in [wall.from, wall.to] {
                *degree.entry((sector.0, corner(end))).or_default() += 1;
            }
        }
    }
    let unclosed: BTreeSet<u32> = degree
        .into_iter()
        .filter(|&(_, n)| n % 2 == 1)
        .map(|((sector, _), _)| sector)
        .collect();
    for (number, used) in (0u32..).zip(used) {
        if !used {
            tally.add(Defect::UnusedSector, Place::Sector(number));
        }
        if unclosed.contains(&number) {
            tally.add(Defect::Unclosed, Place::Sector(number));
        }
    }
}

fn sectors(raw: &RawMap, ranges: &[Range]) -> Vec<Sector> {
    let flat = |name: &str| super::binary::texture_name(name);
    (0u32..)
        .zip(raw.sectors.iter().zip(ranges))
        .map(|(number, (sector, range))| Sector {
            name: None,
            floor: range.floor,
            ceiling: range.ceiling,
            light: Some((f64::from(sector.light) / 255.0).clamp(0.0, 1.0)),
            floor_material: flat(&sector.floor_flat),
            ceiling_material: flat(&sector.ceiling_flat),
            place: Place::Sector(number),
        })
        .collect()
}

fn surfaces(raw: &RawMap, line: &RawLine) -> LineSurfaces {
    let side = |n: Option<u32>| raw.sides.get(n? as usize).map(|s| s.surface.clone());
    LineSurfaces {
        front: side(line.front),
        back: side(line.back),
        unpegged_top: line.unpegged_top,
        unpegged_bottom: line.unpegged_bottom,
    }
}
