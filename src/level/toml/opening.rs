//! Openings: finds the stretch of wall that each is cut into, its ends and its heights.

use glam::DVec2;
use toml::Spanned;

use super::super::draft::DraftWall;
use super::super::finding::Place;
use super::super::model::{Opening, OpeningStyle, WallKind};
use super::super::outline::side as side_of;
use super::super::snap::touch;
use super::error::TomlError;
use super::outline::contains;
use super::plan::{Edge, Plan, find_material, ring, vec2};
use super::record::{Defaults, DoorState, Name, OpeningTable, Point2, Side, Tables};

/// A point given for an opening may be this far, in units, from the wall it is meant to lie on; it
/// is moved onto it. Large enough for a centimetre's rounding on a slanted wall.
const REACH: f64 = 0.01;

/// Cuts all openings of one style into the plan.
pub(super) fn add_openings(
    plan: &mut Plan,
    style: OpeningStyle,
    tables: &Tables<OpeningTable>,
    defaults: &Defaults,
) -> Result<(), TomlError> {
    for table in tables {
        let record = table.get_ref();
        let place = plan.place(table.span());
        let shut = is_shut(plan, style, record)?;
        let material = find_material(plan, record.material.as_ref())?;
        for hole in holes(plan, style, table)? {
            let (bottom, top) = heights(plan, style, table, &hole, defaults)?;
            plan.walls.push(DraftWall {
                from: hole.from,
                to: hole.to,
                written: hole.written,
                kind: WallKind::Opening(Opening {
                    style,
                    name: record.name.clone(),
                    shut,
                    bottom,
                    top,
                }),
                left: None,
                right: None,
                outline: None,
                material,
                place,
            });
        }
    }
    Ok(())
}

/// Where an opening is on the plan.
struct Hole {
    from: DVec2,
    to: DVec2,
    written: [bool; 2],
}

fn is_shut(plan: &Plan, style: OpeningStyle, record: &OpeningTable) -> Result<bool, TomlError> {
    match &record.state {
        Some(state) if style == OpeningStyle::Archway => Err(TomlError::Misplaced {
            place: plan.place(state.span()),
            what: "an archway, having no leaf,",
            key: "state",
        }),
        Some(state) => Ok(*state.get_ref() == DoorState::Closed),
        None => Ok(style == OpeningStyle::Door),
    }
}

fn holes(
    plan: &Plan,
    style: OpeningStyle,
    table: &Spanned<OpeningTable>,
) -> Result<Vec<Hole>, TomlError> {
    let record = table.get_ref();
    let place = plan.place(table.span());
    let stretch = match (&record.points, &record.between, &record.room) {
        (Some(points), None, None) => {
            let needless = [
                ("at", record.at.as_ref().map(Spanned::span)),
                ("width", record.width.as_ref().map(Spanned::span)),
                ("count", record.count.as_ref().map(Spanned::span)),
            ];
            for (key, span) in needless {
                if let Some(span) = span {
                    return Err(TomlError::Misplaced {
                        place: plan.place(span),
                        what: "an opening with `points`",
                        key,
                    });
                }
            }
            return Ok(vec![hole_between_points(plan, points)?]);
        }
        (None, Some(rooms), None) => shared_stretch(plan, rooms, record.at.as_ref())?,
        (None, None, Some(room)) => room_stretch(plan, room, record, place)?,
        _ => {
            return Err(TomlError::Keys {
                place,
                what: "an opening".into(),
                needed: "one of `points = [[x, y], [x, y]]`, `between = [\"Room\", \"Room\"]`, \
                         `room = \"Room\"`"
                    .into(),
            });
        }
    };
    if record.width.is_none() && style != OpeningStyle::Archway {
        return Err(TomlError::Keys {
            place,
            what: "a door or window".into(),
            needed: "its `width` (only an archway may take the whole wall)".into(),
        });
    }
    holes_along(plan, stretch, record, place)
}

/// The holes of a record on its stretch of wall: one, or `count` evenly spread.
fn holes_along(
    plan: &Plan,
    [from, to]: [DVec2; 2],
    record: &OpeningTable,
    place: Place,
) -> Result<Vec<Hole>, TomlError> {
    let length = from.distance(to);
    let count = record.count.as_ref().map_or(1, |c| *c.get_ref());
    if let Some(given) = &record.count
        && (count == 0 || count > 10_000 || record.at.is_some())
    {
        return Err(TomlError::Keys {
            place: plan.place(given.span()),
            what: "`count`".into(),
            needed: "to be 1 to 10000, and to stand without `at`".into(),
        });
    }
    let room_for_one = length / f64::from(count);
    let width = (record.width.as_ref()).map_or(room_for_one, |w| w.get_ref().0);
    // A width that was written as the whole of the wall may differ from it by rounding.
    let slack = touch(&plan.grid);
    let too_wide = |available: f64| TomlError::TooWide {
        place: record
            .width
            .as_ref()
            .map_or(place, |w| plan.place(w.span())),
        width,
        available,
        from: from.into(),
        to: to.into(),
    };
    if width > room_for_one + slack {
        return Err(too_wide(room_for_one));
    }
    let direction = (to - from) / length;
    let hole = |middle: f64| {
        let (start, end) = (middle - width / 2.0, middle + width / 2.0);
        if start < -slack || end > length + slack {
            return Err(too_wide(2.0 * middle.min(length - middle).max(0.0)));
        }
        // The wall's own end where the opening reaches it: no sliver of wall is left over.
        let at = |t: f64, i: usize| match t {
            t if t <= slack => (from, i),
            t if t >= length - slack => (to, i),
            t => (from + direction * t, i),
        };
        Ok(Hole {
            from: at(start, 0).0,
            to: at(end, 1).0,
            written: [false, false],
        })
    };
    match &record.at {
        Some(at) => Ok(vec![hole((vec2(*at.get_ref()) - from).dot(direction))?]),
        None => (0..count)
            .map(|i| hole((f64::from(i) + 0.5) * room_for_one))
            .collect(),
    }
}

/// The stretch of wall that two rooms share: the one at the given point, or the longest.
fn shared_stretch(
    plan: &Plan,
    rooms: &Spanned<[Name; 2]>,
    at: Option<&Spanned<Point2>>,
) -> Result<[DVec2; 2], TomlError> {
    let [a, b] = rooms.get_ref();
    let (room_a, room_b) = (
        plan.room_names.find(plan.source, a)?,
        plan.room_names.find(plan.source, b)?,
    );
    let near = touch(&plan.grid);
    let mut stretches = Vec::new();
    for (p, q) in ring(&plan.rooms[room_a].corners) {
        for (r, s) in ring(&plan.rooms[room_b].corners) {
            stretches.extend(common_stretch([p, q], [r, s], near));
        }
    }
    if room_a == room_b || stretches.is_empty() {
        return Err(TomlError::NoSharedWall {
            place: plan.place(rooms.span()),
            a: a.get_ref().clone(),
            b: b.get_ref().clone(),
        });
    }
    choose_stretch(plan, stretches, at)
}

/// Where two segments lie on one line (up to `touch`), what they have in common.
fn common_stretch([p, q]: [DVec2; 2], [r, s]: [DVec2; 2], touch: f64) -> Option<[DVec2; 2]> {
    let length = p.distance(q);
    let direction = (q - p) / length;
    let off_line = |x: DVec2| direction.perp_dot(x - p).abs() > touch;
    if off_line(r) || off_line(s) {
        return None;
    }
    // The written corners themselves, not points computed along the edge.
    let along = |x: DVec2| direction.dot(x - p);
    let ends = if along(r) < along(s) { [r, s] } else { [s, r] };
    let from = if along(ends[0]) > 0.0 { ends[0] } else { p };
    let to = if along(ends[1]) < length { ends[1] } else { q };
    (along(to) - along(from) > touch).then_some([from, to])
}

/// The wall of one room that faces a side or lies at a point.
fn room_stretch(
    plan: &Plan,
    name: &Name,
    record: &OpeningTable,
    place: Place,
) -> Result<[DVec2; 2], TomlError> {
    let room = &plan.rooms[plan.room_names.find(plan.source, name)?];
    let stretches: Vec<[DVec2; 2]> = match &record.side {
        None if record.at.is_none() => {
            return Err(TomlError::Keys {
                place,
                what: "an opening in the wall of a `room`".into(),
                needed: "`side = \"north\"` (or east, south, west), or `at = [x, y]`".into(),
            });
        }
        None => ring(&room.corners).map(|(p, q)| [p, q]).collect(),
        Some(side) => {
            let (facing, called) = match side.get_ref() {
                Side::North => (DVec2::Y, "north"),
                Side::East => (DVec2::X, "east"),
                Side::South => (DVec2::NEG_Y, "south"),
                Side::West => (DVec2::NEG_X, "west"),
            };
            let facing_walls: Vec<[DVec2; 2]> = ring(&room.corners)
                .filter(|&(p, q)| {
                    let left = (q - p).perp().normalize();
                    let outward = if room.counterclockwise { -left } else { left };
                    // Within 45° of that side (both sides own the diagonal).
                    outward.dot(facing) >= std::f64::consts::FRAC_1_SQRT_2 - 1e-9
                })
                .map(|(p, q)| [p, q])
                .collect();
            if facing_walls.is_empty() {
                return Err(TomlError::NoSuchSide {
                    place: plan.place(side.span()),
                    room: name.get_ref().clone(),
                    side: called,
                });
            }
            facing_walls
        }
    };
    choose_stretch(plan, stretches, record.at.as_ref())
}

/// The stretch at a point, or else the longest (the first of equally long ones).
fn choose_stretch(
    plan: &Plan,
    stretches: Vec<[DVec2; 2]>,
    at: Option<&Spanned<Point2>>,
) -> Result<[DVec2; 2], TomlError> {
    let Some(at) = at else {
        let mut longest = stretches[0];
        for s in &stretches[1..] {
            // Beyond rounding: f64 noise must not choose between equal walls.
            if s[0].distance(s[1]) > longest[0].distance(longest[1]) * (1.0 + 1e-9) {
                longest = *s;
            }
        }
        return Ok(longest);
    };
    let point = vec2(*at.get_ref());
    let distance = |s: &[DVec2; 2]| nearest_on(s[0], s[1], point).distance(point);
    let nearest = stretches
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    match nearest {
        Some(s) if distance(&s) <= REACH => Ok(s),
        Some(s) => Err(not_on_wall(
            plan.place(at.span()),
            point,
            nearest_on(s[0], s[1], point),
        )),
        None => Err(not_on_wall(plan.place(at.span()), point, point)),
    }
}

fn not_on_wall(place: Place, point: DVec2, near: DVec2) -> TomlError {
    TomlError::NotOnWall {
        place,
        x: point.x,
        y: point.y,
        distance: point.distance(near),
        near_x: near.x,
        near_y: near.y,
    }
}

/// The hole between two given points, both on one wall.
fn hole_between_points(
    plan: &Plan,
    points: &Spanned<[Spanned<Point2>; 2]>,
) -> Result<Hole, TomlError> {
    let place = plan.place(points.span());
    let ends = points.get_ref().each_ref().map(|p| vec2(*p.get_ref()));
    if ends[0].distance(ends[1]) < 0.5 * plan.grid.step.length() {
        return Err(TomlError::Degenerate {
            place,
            what: "the two ends of the opening are the same point; move one".into(),
        });
    }
    let off = |e: &Edge, p: DVec2| nearest_on(e.from, e.to, p).distance(p);
    let farther = |e: &Edge| off(e, ends[0]).max(off(e, ends[1]));
    let best = (plan.edges.iter()).min_by(|a, b| farther(a).total_cmp(&farther(b)));
    let Some(host) = best.filter(|e| farther(e) <= REACH) else {
        for (end, record) in ends.iter().zip(points.get_ref()) {
            let near = (plan.edges.iter())
                .map(|e| nearest_on(e.from, e.to, *end))
                .min_by(|a, b| a.distance(*end).total_cmp(&b.distance(*end)))
                .unwrap_or(*end);
            if near.distance(*end) > REACH || plan.edges.is_empty() {
                return Err(not_on_wall(plan.place(record.span()), *end, near));
            }
        }
        return Err(TomlError::NotOnOneWall {
            place,
            ends: ends.map(Into::into),
        });
    };
    let on_host = ends.map(|p| {
        let grid = [host.from, host.to, p].map(|q| plan.grid.nearest(q));
        match grid {
            // Exactly on the wall's line, and not beyond its end: as written.
            [Some(a), Some(b), Some(c)]
                if side_of(a, b, c) == 0 && plan.grid.to_level(c) == p && within(host, p) =>
            {
                (p, true)
            }
            _ => (nearest_on(host.from, host.to, p), false),
        }
    });
    Ok(Hole {
        from: on_host[0].0,
        to: on_host[1].0,
        written: [on_host[0].1, on_host[1].1],
    })
}

/// Whether a point of the edge's line is between its ends.
fn within(edge: &Edge, p: DVec2) -> bool {
    (p - edge.from).dot(edge.to - edge.from) >= 0.0 && (p - edge.to).dot(edge.from - edge.to) >= 0.0
}

/// The point of a segment nearest to `p`.
fn nearest_on(from: DVec2, to: DVec2, p: DVec2) -> DVec2 {
    let direction = to - from;
    let t = (p - from).dot(direction) / direction.length_squared();
    if t <= 0.0 {
        from
    } else if t >= 1.0 {
        to
    } else {
        from + direction * t
    }
}

/// Bottom and top of an opening in z, as far as the file says.
fn heights(
    plan: &Plan,
    style: OpeningStyle,
    table: &Spanned<OpeningTable>,
    hole: &Hole,
    defaults: &Defaults,
) -> Result<(Option<f64>, Option<f64>), TomlError> {
    let record = table.get_ref();
    let place = plan.place(table.span());
    let [floor, ceiling] = heights_beside(plan, hole);
    if let (Some(_), Some(sill)) = (&record.bottom, &record.sill) {
        return Err(TomlError::Keys {
            place: plan.place(sill.span()),
            what: "an opening".into(),
            needed: "either `bottom` (in z) or `sill` (above the floor), not both".into(),
        });
    }
    if let (Some(_), Some(height)) = (&record.top, &record.height) {
        return Err(TomlError::Keys {
            place: plan.place(height.span()),
            what: "an opening".into(),
            needed: "either `top` (in z) or `height` (above its bottom), not both".into(),
        });
    }
    let usual_sill = match style {
        OpeningStyle::Window => defaults.window_sill.map(|s| s.0),
        OpeningStyle::Door | OpeningStyle::Archway => None,
    };
    let usual_height = match style {
        OpeningStyle::Door => defaults.door_height,
        OpeningStyle::Window => defaults.window_height,
        OpeningStyle::Archway => defaults.archway_height,
    };
    let sill = record.sill.as_ref().map(|s| s.get_ref().0).or(usual_sill);
    let bottom = (record.bottom.map(|z| z.0)).or(sill.map(|s| floor + s));
    let above = |height: f64| bottom.unwrap_or(floor) + height;
    let own_top = record
        .top
        .map(|z| z.0)
        .or(record.height.as_ref().map(|h| above(h.get_ref().0)));
    // A usual height that does not fit under a low ceiling ends there.
    let usual_top = usual_height.map(|h| above(h.0)).filter(|z| *z < ceiling);
    let top = own_top.or(usual_top);
    let (low, high) = (bottom.unwrap_or(floor), top.unwrap_or(ceiling));
    if let (Some(bottom), Some(top)) = (bottom, top)
        && top <= bottom
    {
        return Err(TomlError::TopNotAboveBottom { place, bottom, top });
    }
    if high.min(ceiling) <= low.max(floor) {
        return Err(TomlError::OutsideHeights {
            place,
            bottom: low,
            top: high,
            floor,
            ceiling,
        });
    }
    Ok((bottom, top))
}

/// The higher floor and the lower ceiling of the rooms on both sides of an opening; zones are not
/// looked at.
fn heights_beside(plan: &Plan, hole: &Hole) -> [f64; 2] {
    let middle = (hole.from + hole.to) / 2.0;
    let touches = |e: &&Edge| nearest_on(e.from, e.to, middle).distance(middle) <= REACH;
    let beside = (plan.edges.iter())
        .filter(touches)
        .filter_map(|e| e.room)
        .map(|r| [plan.rooms[r].floor, plan.rooms[r].ceiling])
        .reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])]);
    let around = || {
        let room = plan.rooms.iter().rfind(|r| contains(&r.corners, middle));
        room.map_or(plan.default_heights, |r| [r.floor, r.ceiling])
    };
    beside.unwrap_or_else(around)
}
