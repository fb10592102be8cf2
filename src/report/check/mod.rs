//! What `check` looks for in a level beyond what its reading and its cells have already found:
//! openings to the outside, rooms that cannot be reached, slivers, ends that nearly meet.
//!
//! Whether something thin or near looks like a mistake is a matter of size: that is measured in f64,
//! with the limit stated in the finding. Nothing else depends on it.

mod near;
mod outside;
mod reach;
mod thin;

use crate::cells::CellGraph;
use crate::cells::findings::order;
use crate::level::{Finding, Level};

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
