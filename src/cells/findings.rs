//! Findings that only the exact arrangement can tell: walls that cross, touch or overlap.

use std::collections::BTreeMap;

use super::arrangement::{Arrangement, Meeting};
use crate::level::{Finding, Interior, Level, Place, Severity, Wall, WallKind};

/// Walls that cross, touch or overlap where that looks like a mistake. Rooms may share walls, and an
/// opening lies on one: that is no finding.
pub fn of_meetings(level: &Level, arrangement: &Arrangement) -> Vec<Finding> {
    let mut places: BTreeMap<(&str, Severity, &str), Vec<Place>> = BTreeMap::new();
    for &(a, b, meeting) in &arrangement.meetings {
        let (first, second) = (&level.walls[a.0 as usize], &level.walls[b.0 as usize]);
        let Some(kind) = kind_of(level, first, second, meeting) else {
            continue;
        };
        // The later wall is the one that was put onto the other.
        let later = if a > b { first } else { second };
        places.entry(kind).or_default().push(later.place);
    }
    places
        .into_iter()
        .map(|((code, severity, message), mut places)| {
            places.sort_by_key(order);
            places.dedup();
            Finding {
                code,
                severity,
                message: message.into(),
                places,
            }
        })
        .collect()
}

fn kind_of(
    level: &Level,
    first: &Wall,
    second: &Wall,
    meeting: Meeting,
) -> Option<(&'static str, Severity, &'static str)> {
    let by_sides = level.interior == Interior::Sides;
    let room = |w: &Wall| {
        let outline = w.outline.map(|id| &level.outlines[id.0 as usize]);
        outline.is_some_and(|o| o.sector.is_some() && !o.zone)
    };
    // Walls that stand free may cross on purpose, and pillars may lean on a wall; but what lies
    // twice on the same stretch was drawn once too often.
    let free =
        |w: &Wall| w.outline.is_none() && matches!(w.kind, WallKind::Solid | WallKind::Outline);
    let twice = by_sides
        || (free(first) && (free(second) || room(second)))
        || (room(first) && free(second));
    match meeting {
        Meeting::Cross if room(first) && room(second) => Some((
            "overlapping-rooms",
            Severity::Warning,
            "The outlines of two rooms cross here, so their ground overlaps; the later room has it.",
        )),
        Meeting::Cross if by_sides => Some((
            "crossing-walls",
            Severity::Repaired,
            "Walls cross each other; both were split exactly where they meet.",
        )),
        Meeting::Touch if by_sides => Some((
            "unsplit-wall",
            Severity::Repaired,
            "A wall ends in the middle of another one; that one was split there.",
        )),
        Meeting::Duplicate if twice => Some((
            "duplicate-wall",
            Severity::Repaired,
            "Two walls have the same ends; they were made one.",
        )),
        Meeting::Overlap if twice => Some((
            "overlapping-walls",
            Severity::Repaired,
            "Walls lie partly on each other; the common part was made one.",
        )),
        _ => None,
    }
}

/// Sorts places in the order of the source.
pub fn order(place: &Place) -> (u32, u32, i64, i64) {
    match *place {
        Place::Text { line, column } => (line, column, 0, 0),
        Place::Linedef(n)
        | Place::Sidedef(n)
        | Place::Sector(n)
        | Place::Vertex(n)
        | Place::Thing(n) => (n, 0, 0, 0),
        Place::Point { x, y } => (0, 0, (x * 1024.0) as i64, (y * 1024.0) as i64),
    }
}
