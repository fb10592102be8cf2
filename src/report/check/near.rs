//! Ends of walls that nearly meet another end, or another wall.

use std::collections::BTreeMap;

use glam::DVec2;
use rstar::primitives::{GeomWithData, Line as TreeLine};
use rstar::{AABB, RTree};

use super::extent;
use crate::geom::{GridPoint, Line, Side};
use crate::level::{Finding, Level, Place, Severity};

/// Near is what is closer than this part of the level's larger side: 1 mm in a building of 100 m.
const NEAR: f64 = 1e-5;

/// Distinct ends closer to each other, and ends closer to a wall that they do not lie on, than the
/// limit above.
pub fn find(level: &Level) -> Vec<Finding> {
    let limit = extent(level) * NEAR;
    let point = |p: GridPoint| [p.x as f64, p.y as f64];
    let segments = level.walls.iter().enumerate();
    let tree = RTree::bulk_load(
        segments
            .map(|(i, w)| GeomWithData::new(TreeLine::new(point(w.from), point(w.to)), i))
            .collect(),
    );
    // Every end once, with the first wall that has it.
    let mut ends: BTreeMap<GridPoint, Place> = BTreeMap::new();
    for wall in &level.walls {
        for end in [wall.from, wall.to] {
            ends.entry(end).or_insert(wall.place);
        }
    }
    let (mut near_ends, mut near_walls) = (Vec::new(), Vec::new());
    for (&end, &place) in &ends {
        let [x, y] = point(end);
        let around = AABB::from_corners([x - limit, y - limit], [x + limit, y + limit]);
        let (mut by_end, mut by_wall) = (false, false);
        for other in tree.locate_in_envelope_intersecting(around) {
            let wall = &level.walls[other.data];
            let close = |p: GridPoint| p != end && distance(p, end) < limit;
            if wall.from == end || wall.to == end {
                continue;
            }
            if close(wall.from) || close(wall.to) {
                by_end = true;
            } else if !touches(wall.from, wall.to, end) {
                by_wall |= to_segment(wall.from, wall.to, end) < limit;
            }
        }
        if by_end {
            near_ends.push(place);
        } else if by_wall {
            near_walls.push(place);
        }
    }
    let near = |code, what: &str, places| Finding {
        code,
        severity: Severity::Warning,
        message: format!(
            "{what} by less than a hundred-thousandth of the level; sight passes through such a \
             gap, so join them if they were meant to meet."
        ),
        places,
    };
    let found = [
        near(
            "near-coincident-ends",
            "Ends of these walls miss another end",
            near_ends,
        ),
        near(
            "near-miss",
            "Ends of these walls miss another wall",
            near_walls,
        ),
    ];
    found.into_iter().filter(|f| !f.places.is_empty()).collect()
}

fn distance(p: GridPoint, q: GridPoint) -> f64 {
    ((p.x - q.x) as f64).hypot((p.y - q.y) as f64)
}

/// Whether a point lies exactly on a segment.
fn touches(from: GridPoint, to: GridPoint, p: GridPoint) -> bool {
    let within = |a: i64, b: i64, x: i64| a.min(b) <= x && x <= a.max(b);
    let on_line = Line::through(from, to).is_some_and(|l| l.side(&p.into()) == Side::On);
    on_line && within(from.x, to.x, p.x) && within(from.y, to.y, p.y)
}

fn to_segment(from: GridPoint, to: GridPoint, p: GridPoint) -> f64 {
    let vector = |q: GridPoint| DVec2::new((q.x - from.x) as f64, (q.y - from.y) as f64);
    let (along, at) = (vector(to), vector(p));
    let part = (at.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (at - along * part).length()
}
