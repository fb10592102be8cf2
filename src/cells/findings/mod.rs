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
        let (low, high) = ends()
            .map(of)
            .fold((i64::MAX, i64::MIN), |(l, h), n| (l.min(n), h.max(n)));
        if low > high { 0 } else { high - low }
    };
    side(|p| p.x).max(side(|p| p.y)) as f64
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;

    /// Codes and counts of all findings of the cells.
    fn codes(text: &str) -> Vec<(&'static str, usize)> {
        let level = read(text.into(), "level.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        graph.validate().unwrap();
        let all = graph
            .findings
            .iter()
            .cloned()
            .chain(of_cells(&level, &graph));
        all.map(|f| (f.code, f.places.len())).collect()
    }

    fn room(name: &str, rect: &str) -> String {
        format!("[[room]]\nname = \"{name}\"\nrect = [{rect}]\n")
    }

    #[test]
    fn two_rooms_with_a_door_are_in_order() {
        let rooms = room("A", "0, 0, 4, 4") + &room("B", "4, 0, 8, 4");
        let door = "[[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";
        assert_eq!(codes(&(rooms.clone() + door)), []);
        // Without the door, or with a window in its place, the smaller room is cut off.
        assert_eq!(codes(&rooms), [("unreachable", 1)]);
        assert_eq!(
            codes(&(rooms + &door.replace("door", "window"))),
            [("unreachable", 1)]
        );
    }

    #[test]
    fn openings_to_the_outside() {
        let hole = |kind| format!("[[{kind}]]\nroom = \"A\"\nside = \"east\"\nwidth = 1\n");
        let level = |kind| room("A", "0, 0, 4, 4") + &hole(kind);
        assert_eq!(codes(&level("archway")), [("leak", 1)]);
        assert_eq!(codes(&level("window")), [("opening-to-outside", 1)]);
    }

    #[test]
    fn walls_that_enclose_nothing() {
        let gap = "start = [[2, 1]]\n[[wall]]\npoints = [[0, 0], [4, 0], [4, 4], [1, 2]]\n";
        assert_eq!(codes(gap), [("open-start", 1), ("no-inside", 1)]);
        let closed = gap.replace("[1, 2]]", "[0, 0]]");
        assert_eq!(codes(&closed), []);
    }

    #[test]
    fn walls_that_nearly_meet() {
        let wall = |x: &str| format!("[[wall]]\npoints = [[2, 0], [2, {x}]]\n");
        let level = |x| room("A", "0, 0, 100, 100") + &wall(x);
        assert_eq!(codes(&level("100")), [("unreachable", 1)]);
        assert_eq!(codes(&level("99.9995")), [("near-miss", 1)]);
        assert_eq!(codes(&level("99.9")), []);
    }

    #[test]
    fn ends_that_nearly_meet_and_the_gap_between() {
        let rooms = room("A", "0, 0, 100, 50") + &room("B", "0, 50.0005, 100, 100");
        let found = codes(&rooms);
        assert_eq!(found[0], ("unreachable", 1));
        assert_eq!(found[1].0, "near-coincident-ends");
        let strip = room("A", "0, 0, 100, 50") + &room("B", "0, 50, 100, 50.005");
        assert!(
            codes(&strip).contains(&("sliver", 1)),
            "{:?}",
            codes(&strip)
        );
    }

    #[test]
    fn free_walls_may_cross_but_not_lie_twice() {
        let cross = "[[wall]]\npoints = [[1, 2], [3, 2]]\n[[wall]]\npoints = [[2, 1], [2, 3]]\n";
        let twice = "[[wall]]\npoints = [[1, 2], [3, 2]]\n[[wall]]\npoints = [[2, 2], [3.5, 2]]\n";
        assert_eq!(codes(&(room("A", "0, 0, 4, 4") + cross)), []);
        assert_eq!(
            codes(&(room("A", "0, 0, 4, 4") + twice)),
            [("overlapping-walls", 1)]
        );
        let rooms = room("A", "0, 0, 4, 4") + &room("B", "2, 2, 6, 6");
        assert_eq!(codes(&rooms)[0].0, "overlapping-rooms");
    }
}
