//! Whether a segment between two grid points is free, decided from the walls alone in integers.

use std::collections::HashSet;

use enfilade::cells::Doors;
use enfilade::geom::GridPoint;
use enfilade::level::{Level, Wall, WallId, WallKind};
use rand::{Rng, RngExt};

/// Whether an opening, or a see-through wall, is shut.
fn shut(wall: &Wall, doors: Doors) -> bool {
    doors == Doors::Closed
        && match &wall.kind {
            WallKind::Edge { shut } => *shut,
            WallKind::Opening(opening) => opening.shut,
            WallKind::Solid | WallKind::Outline => true,
        }
}

/// What a wall does to a segment that crosses it.
#[derive(Clone, Copy, PartialEq)]
pub enum Act {
    /// Stops it.
    Stops,
    /// Stops it unless an open [`Act::Cuts`] lies there.
    StopsUnlessCut,
    /// Makes a hole.
    Cuts,
    /// Nothing.
    Lets,
}

/// What a wall does.
pub fn act(wall: &Wall, doors: Doors) -> Act {
    match wall.kind {
        WallKind::Solid => Act::Stops,
        WallKind::Outline => Act::StopsUnlessCut,
        _ if shut(wall, doors) => Act::Stops,
        WallKind::Opening(_) => Act::Cuts,
        WallKind::Edge { .. } => Act::Lets,
    }
}

/// Twice the signed area of the triangle.
pub fn cross(a: GridPoint, b: GridPoint, c: GridPoint) -> i128 {
    let wide = |n: i64| i128::from(n);
    wide(b.x - a.x) * wide(c.y - a.y) - wide(b.y - a.y) * wide(c.x - a.x)
}

/// Whether the closed segments have a point in common.
fn touch(p: GridPoint, q: GridPoint, a: GridPoint, b: GridPoint) -> bool {
    if p.x.max(q.x) < a.x.min(b.x)
        || p.x.min(q.x) > a.x.max(b.x)
        || p.y.max(q.y) < a.y.min(b.y)
        || p.y.min(q.y) > a.y.max(b.y)
    {
        return false;
    }
    let apart = |p, q, a, b| {
        let (s, t) = (cross(p, q, a).signum(), cross(p, q, b).signum());
        s == t && s != 0
    };
    !apart(p, q, a, b) && !apart(a, b, p, q)
}

/// The walls of a level as they stop sight.
pub struct Sight<'a> {
    walls: Vec<(&'a Wall, Act)>,
}

impl<'a> Sight<'a> {
    /// The walls of a level; those of `borders`, behind which the outside of the level lies, count
    /// as opaque.
    pub fn new(level: &'a Level, doors: Doors, borders: &HashSet<WallId>) -> Self {
        let acts = (0u32..).zip(&level.walls).map(|(i, wall)| {
            let border = borders.contains(&WallId(i));
            (wall, if border { Act::Stops } else { act(wall, doors) })
        });
        Self {
            walls: acts.collect(),
        }
    }

    /// Whether the closed segment touches no opaque wall. Ends of walls and of openings count as
    /// opaque, so a segment that only just passes is not free; what is free is so with some margin.
    pub fn is_free(&self, p: GridPoint, q: GridPoint) -> bool {
        self.walls.iter().all(|(wall, act)| match act {
            Act::Cuts | Act::Lets => true,
            Act::Stops => !touch(p, q, wall.from, wall.to),
            Act::StopsUnlessCut => {
                !touch(p, q, wall.from, wall.to) || self.passes_opening(p, q, wall)
            }
        })
    }

    /// Whether the segment crosses the wall strictly inside an opening that lies in line with it.
    fn passes_opening(&self, p: GridPoint, q: GridPoint, wall: &Wall) -> bool {
        let (a, b) = (wall.from, wall.to);
        let strictly = |p, q, a, b| {
            let (s, t) = (cross(p, q, a).signum(), cross(p, q, b).signum());
            s * t < 0
        };
        self.walls
            .iter()
            .filter(|(_, act)| *act == Act::Cuts)
            .any(|(hole, _)| {
                cross(a, b, hole.from) == 0
                    && cross(a, b, hole.to) == 0
                    && strictly(p, q, hole.from, hole.to)
                    && strictly(hole.from, hole.to, p, q)
            })
    }

    /// A free segment that starts in `p` (which must be on no wall), found by shooting in a random
    /// direction and stopping short of the first wall. `None` where none was found in a few tries.
    pub fn shoot(&self, p: GridPoint, reach: i64, random: &mut impl Rng) -> Option<GridPoint> {
        for _ in 0..4 {
            let far = GridPoint::new(
                p.x + random.random_range(-reach..=reach),
                p.y + random.random_range(-reach..=reach),
            );
            let mut share = 1.0f64;
            for (wall, _) in self.walls.iter().filter(|(_, a)| *a == Act::Stops) {
                share = share.min(hit(p, far, wall));
            }
            for (wall, _) in self.walls.iter().filter(|(_, a)| *a == Act::StopsUnlessCut) {
                let at = hit(p, far, wall);
                if at < share && !self.passes_opening(p, far, wall) {
                    share = at;
                }
            }
            // Far or near, but most often close to the wall, where sightlines are rare.
            let part = if random.random_bool(0.7) {
                0.999
            } else {
                random.random_range(0.1..1.0)
            };
            let along = |a: i64, b: i64| a + ((b - a) as f64 * share * part) as i64;
            let q = GridPoint::new(along(p.x, far.x), along(p.y, far.y));
            if q != p && self.is_free(p, q) {
                return Some(q);
            }
        }
        None
    }
}

/// Where the segment meets the wall, as a share of its length; more than 1 where it does not. Only
/// a guess: what comes of it is checked exactly.
fn hit(p: GridPoint, q: GridPoint, wall: &Wall) -> f64 {
    let (a, b) = (wall.from, wall.to);
    let (s, t) = (cross(p, q, a), cross(p, q, b));
    if s.signum() == t.signum() && s != 0 {
        return 2.0;
    }
    let (u, v) = (cross(a, b, p), cross(a, b, q));
    if u == v {
        return 2.0;
    }
    let share = u as f64 / (u - v) as f64;
    if share < 0.0 { 2.0 } else { share }
}
