//! Findings that only the exact arrangement and the finished cells can tell.
//!
//! [`of_meetings`] is part of every subdivision; [`of_cells`] is what `check` looks for besides:
//! openings to the outside, rooms that cannot be reached, slivers, ends that nearly meet. Where a
//! finding is about a measure (thin, near), that is taken in f64 and its limit stated in the
//! finding; nothing else depends on it.

mod near;
mod outside;
mod reach;
mod thin;

use std::collections::BTreeMap;

use super::CellGraph;
use super::arrangement::{Arrangement, Meeting};
use crate::level::{Finding, Interior, Level, Place, Severity, Wall, WallKind};

/// What looks wrong in a level as it has been cut into cells (with doors open): leaks, unreachable
/// rooms, slivers, ends that nearly meet.
pub fn of_cells(level: &Level, graph: &CellGraph) -> Vec<Finding> {
    let found = [
        outside::find(level, graph),
        reach::find(level, graph),
        thin::find(level, graph),
        near::find(level),
    ];
    let mut findings: Vec<Finding> = found.into_iter().flatten().collect();
    for finding in &mut findings {
        finding.places.sort_by_key(order);
        finding.places.dedup();
    }
    findings
}

/// The larger side of the level, in grid steps.
fn extent(level: &Level) -> f64 {
    let ends = || level.walls.iter().flat_map(|w| [w.from, w.to]);
    let side = |of: fn(crate::geom::GridPoint) -> i64| {
        let (low, high) = ends().map(of).fold((i64::MAX, i64::MIN), |(l, h), n| (l.min(n), h.max(n)));
        if low > high { 0 } else { high - low }
    };
    side(|p| p.x).max(side(|p| p.y)) as f64
}

/// Walls that cross, touch or overlap. Rooms may share walls, and an opening lies on one: that is no
/// finding.
pub fn of_meetings(level: &Level, arrangement: &Arrangement) -> Vec<Finding> {
    let mut places: BTreeMap<(&str, Severity, &str), Vec<Place>> = BTreeMap::new();
    let by_sides = level.interior == Interior::Sides;
    for &(a, b, meeting) in &arrangement.meetings {
        let (first, second) = (&level.walls[a.0 as usize], &level.walls[b.0 as usize]);
        let Some(kind) = kind_of(by_sides, first, second, meeting) else { continue };
        // The later wall is the one that was put onto the other.
        let later = if a > b { first } else { second };
        places.entry(kind).or_default().push(later.place);
    }
    places
        .into_iter()
        .map(|((code, severity, message), mut places)| {
            places.sort_by_key(order);
            places.dedup();
            Finding { code, severity, message: message.into(), places }
        })
        .collect()
}

fn kind_of(
    by_sides: bool,
    first: &Wall,
    second: &Wall,
    meeting: Meeting,
) -> Option<(&'static str, Severity, &'static str)> {
    let outline = |w: &Wall| matches!(w.kind, WallKind::Outline);
    let solid = |w: &Wall| matches!(w.kind, WallKind::Solid);
    let any_solid = solid(first) || solid(second);
    match meeting {
        Meeting::Cross if outline(first) && outline(second) => Some((
            "overlapping-rooms",
            Severity::Warning,
            "The outlines of two rooms cross here, so their ground overlaps; the later room has it.",
        )),
        Meeting::Cross if by_sides || (solid(first) && solid(second)) => Some((
            "crossing-walls",
            Severity::Repaired,
            "Walls cross each other; both were split exactly where they meet.",
        )),
        Meeting::Touch if by_sides => Some((
            "unsplit-wall",
            Severity::Repaired,
            "A wall ends in the middle of another one; that one was split there.",
        )),
        Meeting::Duplicate if by_sides || (solid(first) && solid(second)) => Some((
            "duplicate-wall",
            Severity::Repaired,
            "Two walls have the same ends; they were made one.",
        )),
        Meeting::Overlap if by_sides || any_solid => Some((
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
