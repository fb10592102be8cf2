//! Which faces of a drawing are rooms, and what they are called.
//!
//! In: faces, solids, texts. Out: sectors, the sector of each face, and findings that tell what is
//! inside and what is outside. The rule stands in [`super`]. Widths are measured in floating point:
//! they decide what is meant.

use glam::DVec2;

use super::super::finding::{Finding, Place, Severity};
use super::super::model::{Height, Opening, OpeningStyle, Sector, SectorId};
use super::super::wording::{count, grouped, length};
use super::faces::{Face, Faces};
use super::noding::Net;
use super::opening::Hole;
use super::unit::Unit;
use super::{Label, Shapes, Sizes};
use crate::geom::Grid;

/// How many areas a message lists.
const SHOWN: usize = 20;

/// Share of a thin face's rim that is openings, from which on it is a threshold.
const THRESHOLD: f64 = 0.35;

/// Faces understood.
pub struct Ground {
    /// Rooms, in the order of their first walls.
    pub sectors: Vec<Sector>,
    /// The room of each face; `None`: outside.
    pub sector_of: Vec<Option<SectorId>>,
    /// Whether each face is a threshold.
    pub thresholds: Vec<bool>,
    /// What is inside and what is outside.
    pub findings: Vec<Finding>,
}

/// What a face is.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Outside,
    Solid,
    Body,
    Threshold,
    Frame,
    Room,
}

/// A face measured.
struct Measured {
    kind: Kind,
    /// Whether an opening leads into it.
    open: bool,
    /// Whether it is the body of a wall but for an opening that reaches a little into it.
    nicked: bool,
    area: f64,
    inside: DVec2,
    low: DVec2,
    high: DVec2,
}

/// The opening of a hole, with the heights usual in buildings; in a drawing without a known unit it
/// reaches from floor to ceiling.
pub(super) fn opening(hole: &Hole, unit: &Unit) -> Opening {
    let (sill, head) = match (hole.style, unit.metres) {
        (OpeningStyle::Door, Some(_)) => (None, Some(2.1)),
        (OpeningStyle::Window, Some(_)) => (Some(0.9), Some(2.1)),
        _ => (None, None),
    };
    Opening {
        style: hole.style,
        name: hole.name.clone(),
        shut: hole.shut,
        bottom: sill.map(|z| unit.of_metres(z)),
        top: head.map(|z| unit.of_metres(z)),
    }
}

/// Tells rooms from wall bodies and from the outside.
pub(super) fn classify(
    grid: &Grid,
    net: &Net,
    faces: &Faces,
    shapes: &Shapes,
    sizes: &Sizes,
) -> Ground {
    let Shapes {
        solids,
        labels,
        unit,
        ..
    } = *shapes;
    let ends = |half: u32| {
        let [a, b] = net.pieces[half as usize / 2].ends;
        [a, b].map(|v| grid.to_level(net.points[v as usize]))
    };
    let mut measured: Vec<Measured> = faces
        .faces
        .iter()
        .enumerate()
        .map(|(i, face)| measure(i, face, net, faces, &ends, grid, sizes))
        .collect();
    let boxes: Vec<(DVec2, DVec2)> = solids.iter().map(|rings| bounds(rings)).collect();
    for face in measured.iter_mut().filter(|f| f.kind != Kind::Outside) {
        let p = face.inside;
        let mut around = solids.iter().zip(&boxes).filter(|(rings, (low, high))| {
            let n = || rings.iter().filter(|ring| ring_contains(ring, p)).count();
            p.cmpge(*low).all() && p.cmple(*high).all() && n() % 2 == 1
        });
        // Where an opening was cut into a filled wall, its reveal is filled, too.
        if (!face.open || face.nicked) && around.next().is_some() {
            face.kind = Kind::Solid;
        }
    }
    if shapes.unnamed {
        mark_frames(&mut measured, faces, &ends);
    }
    // Faces beside each threshold through its openings.
    let through = |i: usize| {
        let rim = faces.faces[i].rim.iter();
        rim.filter(|&&half| net.pieces[half as usize / 2].hole.is_some())
            .map(|&half| faces.face_of[half as usize ^ 1] as usize)
    };
    let mut sector_of: Vec<Option<SectorId>> = vec![None; measured.len()];
    let mut rooms: Vec<usize> = Vec::new();
    for i in 0..measured.len() {
        if measured[i].kind == Kind::Room {
            sector_of[i] = Some(SectorId(rooms.len() as u32));
            rooms.push(i);
        }
    }
    // A threshold goes to the largest room beside it; one among thresholds, to that of its neighbour.
    let mut waiting: Vec<usize> = (0..measured.len())
        .filter(|&i| measured[i].kind == Kind::Threshold)
        .collect();
    for _ in 0..8 {
        let found: Vec<(usize, SectorId)> = waiting
            .iter()
            .filter_map(|&i| {
                let beside = through(i).filter_map(|n| Some((measured[n].area, sector_of[n]?)));
                let largest = beside.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
                largest.map(|(_, sector)| (i, sector))
            })
            .collect();
        if found.is_empty() {
            break;
        }
        for (i, sector) in found {
            sector_of[i] = Some(sector);
        }
        waiting.retain(|&i| sector_of[i].is_none());
    }
    let mut areas: Vec<f64> = vec![0.0; rooms.len()];
    for (face, sector) in measured.iter().zip(&sector_of) {
        if let Some(sector) = sector {
            areas[sector.0 as usize] += face.area;
        }
    }
    let names = names(&rooms, &measured, faces, labels, &ends);
    let (floor, ceiling) = (
        0.0,
        unit.of_metres(if unit.metres.is_some() {
            3.0
        } else {
            sizes.door.map_or(3.0, |d| 3.0 * d)
        }),
    );
    let sectors = rooms.iter().zip(names).map(|(&i, name)| Sector {
        name,
        floor: Height::fixed(floor),
        ceiling: Height::fixed(ceiling),
        light: None,
        floor_material: None,
        ceiling_material: None,
        place: point(measured[i].inside),
    });
    Ground {
        sectors: sectors.collect(),
        sector_of,
        thresholds: (measured.iter())
            .map(|f| f.kind == Kind::Threshold)
            .collect(),
        findings: tell(&measured, &areas, unit, sizes),
    }
}

fn point(p: DVec2) -> Place {
    Place::Point { x: p.x, y: p.y }
}

fn bounds(rings: &[Vec<DVec2>]) -> (DVec2, DVec2) {
    let start = (DVec2::splat(f64::MAX), DVec2::splat(f64::MIN));
    rings
        .iter()
        .flatten()
        .fold(start, |(low, high), p| (low.min(*p), high.max(*p)))
}

fn measure(
    index: usize,
    face: &Face,
    net: &Net,
    faces: &Faces,
    ends: &impl Fn(u32) -> [DVec2; 2],
    grid: &Grid,
    sizes: &Sizes,
) -> Measured {
    let step = grid.step.length();
    let area = face.doubled_area as f64 / 2.0 * step * step;
    let (mut rim, mut open) = (0.0, 0.0);
    let mut low = DVec2::splat(f64::MAX);
    let mut high = DVec2::splat(f64::MIN);
    for &half in &face.rim {
        let [a, b] = ends(half);
        (low, high) = (low.min(a).min(b), high.max(a).max(b));
        // A wall that ends freely inside has the face on both sides, and is no rim.
        if faces.face_of[half as usize ^ 1] as usize == index {
            continue;
        }
        let long = a.distance(b);
        rim += long;
        if net.pieces[half as usize / 2].hole.is_some() {
            open += long;
        }
    }
    let thin = 2.0 * area / rim <= sizes.wall;
    let kind = match () {
        () if index == 0 => Kind::Outside,
        () if thin && open == 0.0 => Kind::Body,
        () if thin && open >= THRESHOLD * rim => Kind::Threshold,
        () => Kind::Room,
    };
    let inside = if index == 0 {
        DVec2::ZERO
    } else {
        inner_point(&face.rim, ends, low, high)
    };
    Measured {
        kind,
        open: open > 0.0,
        nicked: thin && open < THRESHOLD * rim,
        area,
        inside,
        low,
        high,
    }
}

/// Takes rectangles around rooms, into which no opening leads, for frames of the sheet.
fn mark_frames(measured: &mut [Measured], faces: &Faces, ends: &impl Fn(u32) -> [DVec2; 2]) {
    /// Rooms inside a frame fill at least this part of it.
    const FILLED: f64 = 0.1;
    for i in 0..measured.len() {
        let Measured {
            kind: Kind::Room,
            open: false,
            low,
            high,
            ..
        } = measured[i]
        else {
            continue;
        };
        let size = high - low;
        let along_side = |[a, b]: &[DVec2; 2]| {
            let on = |a: f64, b: f64, low: f64, high: f64| a == b && (a == low || a == high);
            on(a.x, b.x, low.x, high.x) || on(a.y, b.y, low.y, high.y)
        };
        let rim = faces.faces[i].rim.iter().map(|half| ends(*half));
        let sides: f64 = rim.filter(along_side).map(|[a, b]| a.distance(b)).sum();
        let inside = measured
            .iter()
            .filter(|f| f.kind == Kind::Room && f.low.cmpgt(low).all() && f.high.cmplt(high).all());
        let rooms: f64 = inside.map(|f| f.area).sum();
        // The sides are sums of lengths between grid points, so a little may be lost in adding.
        let whole = sides > 0.999 * 2.0 * (size.x + size.y);
        if whole && rooms >= FILLED * size.x * size.y {
            measured[i].kind = Kind::Frame;
        }
    }
}

/// A point inside a face: in the middle of the longest stretch of one of a few level lines.
fn inner_point(rim: &[u32], ends: &impl Fn(u32) -> [DVec2; 2], low: DVec2, high: DVec2) -> DVec2 {
    let mut best = (0.0, low.midpoint(high));
    for share in [0.5, 0.37, 0.61, 0.21, 0.83, 0.07, 0.94] {
        let y = low.y + (high.y - low.y) * share;
        let mut xs: Vec<f64> = rim
            .iter()
            .filter_map(|&half| crossing(ends(half), y))
            .collect();
        xs.sort_by(f64::total_cmp);
        for pair in xs.chunks_exact(2) {
            if pair[1] - pair[0] > best.0 {
                best = (pair[1] - pair[0], DVec2::new(pair[0].midpoint(pair[1]), y));
            }
        }
    }
    best.1
}

/// Where an edge crosses the height `y`, its lower end counted in and its upper one not.
fn crossing([a, b]: [DVec2; 2], y: f64) -> Option<f64> {
    ((a.y <= y) != (b.y <= y)).then(|| a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x))
}

/// The face around a point.
pub(super) fn room_at(net: &Net, faces: &Faces, grid: &Grid, p: DVec2) -> usize {
    let ends = |half: u32| {
        let [a, b] = net.pieces[half as usize / 2].ends;
        [a, b].map(|v| grid.to_level(net.points[v as usize]))
    };
    let around = |face: &Face| {
        let edges = (face.rim.iter()).filter_map(|&half| crossing(ends(half), p.y));
        edges.filter(|x| *x > p.x).count() % 2 == 1
    };
    let faces = faces.faces.iter().enumerate().skip(1);
    faces
        .into_iter()
        .find(|(_, f)| around(f))
        .map_or(0, |(i, _)| i)
}

fn ring_contains(ring: &[DVec2], p: DVec2) -> bool {
    let n = ring.len();
    let edges = (0..n).filter_map(|i| crossing([ring[i], ring[(i + 1) % n]], p.y));
    edges.filter(|x| *x > p.x).count() % 2 == 1
}

/// The name of each room: the largest text in it that has a letter, and no area or length.
fn names(
    rooms: &[usize],
    measured: &[Measured],
    faces: &Faces,
    labels: &[Label],
    ends: &impl Fn(u32) -> [DVec2; 2],
) -> Vec<Option<String>> {
    let mut names: Vec<Option<(f64, String)>> = vec![None; rooms.len()];
    for label in labels {
        let Some(text) = label.text.lines().find(|line| is_name(line)) else {
            continue;
        };
        let p = label.at;
        let around = |face: &usize| {
            let (m, rim) = (&measured[*face], &faces.faces[*face].rim);
            let in_box = p.cmpge(m.low).all() && p.cmple(m.high).all();
            let east = || {
                let edges = rim.iter().filter_map(|&half| crossing(ends(half), p.y));
                edges.filter(|x| *x > p.x).count()
            };
            in_box && east() % 2 == 1
        };
        let Some(room) = rooms.iter().position(around) else {
            continue;
        };
        let name = &mut names[room];
        if name
            .as_ref()
            .is_none_or(|(height, _)| label.height > *height)
        {
            *name = Some((label.height, text.trim().to_string()));
        }
    }
    names.into_iter().map(|n| n.map(|(_, text)| text)).collect()
}

/// Whether a text may be a room's name: no `12.40 m²`, `NRF: 15,3`, or door number alone.
fn is_name(text: &str) -> bool {
    let letters = text.chars().filter(|c| c.is_alphabetic()).count();
    let area = ["m²", "m2", "sq", "qm", "SF"].iter().any(|unit| {
        let rest = text.trim().strip_suffix(unit).unwrap_or("x");
        rest.trim_end_matches([' ', '.', ','])
            .ends_with(|c: char| c.is_ascii_digit())
    });
    letters >= 2 && !area && text.chars().count() <= 60
}

/// What is inside, and what is outside though it is enclosed.
fn tell(measured: &[Measured], areas: &[f64], unit: &Unit, sizes: &Sizes) -> Vec<Finding> {
    let of = |kind: Kind| measured.iter().filter(move |f| f.kind == kind);
    let places = |kind: Kind| -> Vec<Place> { of(kind).map(|f| point(f.inside)).collect() };
    // People know areas by the square metre.
    let (factor, square) = match unit.metres {
        Some(metres) if unit.name != "square" => (metres * metres, "m²".to_string()),
        _ => (1.0, format!("{}²", unit.name)),
    };
    let areas: Vec<f64> = areas.iter().map(|area| area * factor).collect();
    let listed: Vec<String> = areas.iter().take(SHOWN).map(|a| length(*a)).collect();
    let more = match areas.len().saturating_sub(SHOWN) {
        0 => String::new(),
        n => format!(", and {} more", grouped(n as u64)),
    };
    let rooms = format!(
        "Inside: {} of together {} {square}. Areas, in the order of places: {}{more}.",
        count(areas.len(), "room"),
        length(areas.iter().sum()),
        listed.join(", "),
    );
    let none = Finding {
        code: "no-room",
        severity: Severity::Warning,
        message:
            "The walls enclose nothing, so there is no inside; look for gaps and close them with \
                  --close-gaps SIZE."
                .to_string(),
        places: vec![point(DVec2::ZERO)],
    };
    let bodies = format!(
        "Outside: enclosed ground without openings, no wider than the thickest wall ({} {}, \
         --thickest-wall): the bodies of walls.",
        length(sizes.wall),
        unit.name
    );
    [
        Some(none).filter(|_| areas.is_empty()),
        Finding::at("room", Severity::Note, rooms, places(Kind::Room)),
        Finding::at("wall-body", Severity::Note, bodies, places(Kind::Body)),
        Finding::at(
            "solid",
            Severity::Note,
            "Outside: the inside of a column or of another solid shape.",
            places(Kind::Solid),
        ),
        Finding::at(
            "sheet-frame",
            Severity::Warning,
            "Outside: ground in a rectangle around all rooms, into which nothing leads. It was taken for \
             the frame of the sheet; if it is a wall, name its layer with --layer wall=NAME.",
            places(Kind::Frame),
        ),
        Finding::at(
            "threshold",
            Severity::Note,
            "Ground between two openings of one wall; it belongs to the largest room beside it.",
            places(Kind::Threshold),
        ),
    ]
    .into_iter()
    .flatten()
    .collect()
}
