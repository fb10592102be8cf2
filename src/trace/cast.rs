//! Rays that walk from cell to cell: the nearest surface of the level on a ray's way.
//!
//! In: a [`Space`], a [`Ray`] and the place where it starts. Out: the surface met, and where. The
//! ray asks the corners of its cell, one after the other, on which side of it they pass on the plan;
//! between the last one on its right and the first one on its left it leaves the cell. If it leaves
//! below the floor or above the ceiling it has met those; else it meets what stands on that edge, or
//! goes on in the next cell. Source: lecture, "Cells & Portals".
//!
//! A ray never asks the edge through which it came, nor the surface on which it starts. So no ray
//! meets again what it leaves, at any angle and any distance from the origin of coordinates, and
//! nothing is compared with a small number. Both cells at an edge ask the same two corners in the
//! same way, so a ray that one cell lets out the other lets in: there are no leaks at edges.
//!
//! Where an edge was cut, a cell has corners in line with each other. A ray that passes those no farther
//! away than roundings go may find them on any side, and so several exits; the first may lead back to
//! where it came from, round and round. Whoever comes through an edge a second time takes from then on
//! the exit that lies farthest ahead.
//!
//! O(edges of the cells on the way).

use super::ray::Ray;
use super::space::{Border, Chamber, Space, Surface, WALL};
use crate::cells::{CellId, EdgeId};

/// Where a ray starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The cell above which the origin lies.
    pub cell: CellId,
    /// The surface on which it lies, if on any of the level's; the ray leads away from it, or, for a
    /// pane, through it into `cell`.
    pub on: Option<Surface>,
}

/// What a ray has met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// How far along the ray, in multiples of its direction; not negative.
    pub t: f64,
    /// The surface.
    pub surface: Surface,
    /// The cell from which it is seen.
    pub cell: CellId,
}

/// The ray on the plan, with all that is asked of corners.
#[derive(Clone, Copy)]
pub(super) struct Course<'a> {
    space: &'a Space,
    ray: Ray,
}

/// Where the ray crosses an edge.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub edge: u32,
    pub t: f64,
    pub z: f64,
}

impl<'a> Course<'a> {
    pub fn new(space: &'a Space, ray: Ray) -> Self {
        Self { space, ray }
    }

    /// Positive for a corner on the left of the ray, negative on its right; what is on it counts as
    /// left.
    #[inline]
    fn side(&self, v: u32) -> f64 {
        let to = self.space.vertex(v) - self.ray.origin.truncate();
        let d = self.ray.direction;
        d.x * to.y - d.y * to.x
    }

    /// The crossing with an edge whose ends lie on these sides, of different sign.
    #[inline]
    fn crossing(&self, edge: u32, from_side: f64, to_side: f64) -> Crossing {
        let border = self.space.edge(edge);
        let o = self.ray.origin.truncate();
        let (a, b) = (
            self.space.vertex(border.from) - o,
            self.space.vertex(border.to) - o,
        );
        // The same number from both sides of the edge: all signs turn together.
        let t = (a.x * b.y - a.y * b.x) / (to_side - from_side);
        Crossing {
            edge,
            t: t.max(0.0),
            z: self.ray.origin.z + t.max(0.0) * self.ray.direction.z,
        }
    }

    /// Whether the ray's line passes out of the edge's cell here, and where.
    pub fn leaves(&self, edge: u32) -> Option<Crossing> {
        let border = self.space.edge(edge);
        let (from, to) = (self.side(border.from), self.side(border.to));
        (from < 0.0 && to >= 0.0).then(|| self.crossing(edge, from, to))
    }

    /// Whether the ray's line passes into the edge's cell here, and where.
    pub fn enters(&self, edge: u32) -> Option<Crossing> {
        let border = self.space.edge(edge);
        let (from, to) = (self.side(border.from), self.side(border.to));
        (from >= 0.0 && to < 0.0).then(|| self.crossing(edge, from, to))
    }

    /// Where the ray leaves a cell: through another edge than `entry`, if that is given. `None` for
    /// a ray without a course on the plan (straight up or down), or of which rounding lets it miss
    /// the cell.
    #[inline]
    pub fn exit(&self, cell: &Chamber, entry: Option<u32>) -> Option<Crossing> {
        let (mut edge, n) = match entry {
            Some(entry) => (self.space.next(cell, entry), cell.past - cell.first - 1),
            None => (cell.first, cell.past - cell.first),
        };
        let mut from = self.side(self.space.edge(edge).from);
        for _ in 0..n {
            let to = self.side(self.space.edge(edge).to);
            if from < 0.0 && to >= 0.0 {
                return Some(self.crossing(edge, from, to));
            }
            from = to;
            edge = self.space.next(cell, edge);
        }
        None
    }

    /// As [`Course::exit`]; of several exits, which rounding makes, the one farthest ahead.
    #[cold]
    fn farthest_exit(&self, cell: &Chamber, entry: Option<u32>) -> Option<Crossing> {
        let ahead = |v: u32| {
            let direction = self.ray.direction.truncate();
            direction.dot(self.space.vertex(v) - self.ray.origin.truncate())
        };
        let edges = (cell.first..cell.past).filter(|&e| Some(e) != entry);
        let exits = edges.filter_map(|e| {
            let border = self.space.edge(e);
            let far = ahead(border.from).max(ahead(border.to));
            Some((far, self.leaves(e)?))
        });
        let farthest = exits.max_by(|a, b| a.0.total_cmp(&b.0));
        farthest.map(|(_, exit)| exit)
    }

    /// Where a ray ends that never leaves its cell sideways.
    #[inline]
    pub fn z_at_infinity(&self) -> f64 {
        f64::INFINITY.copysign(self.ray.direction.z)
    }

    /// The floor or ceiling, if the ray meets it before it is at height `z`.
    #[inline]
    pub fn flat(&self, cell: &Chamber, id: CellId, z: f64) -> Option<Met> {
        let (level, surface) = if z < cell.floor {
            (cell.floor, Surface::Floor(id))
        } else if z > cell.ceiling {
            (cell.ceiling, Surface::Ceiling(id))
        } else {
            return None;
        };
        let t = (level - self.ray.origin.z) / self.ray.direction.z;
        Some(Met {
            t: t.max(0.0),
            surface,
            cell: id,
        })
    }
}

/// The face of an edge that stands at height `z`; `None` where the way is open.
#[inline]
pub(super) fn face(border: &Border, edge: u32, z: f64) -> Option<Surface> {
    let id = EdgeId(edge);
    if border.twin == WALL {
        if border.outside && (border.bottom..=border.top).contains(&z) {
            Some(Surface::Outside(id))
        } else {
            Some(Surface::Wall(id))
        }
    } else if z < border.bottom {
        Some(Surface::Step(id))
    } else if z > border.top {
        Some(Surface::Lintel(id))
    } else if border.pane.is_some() {
        Some(Surface::Pane(id))
    } else {
        None
    }
}

/// The edge on which a surface stands.
pub(super) fn edge_of(surface: Surface) -> Option<u32> {
    match surface {
        Surface::Floor(_) | Surface::Ceiling(_) => None,
        Surface::Wall(e)
        | Surface::Step(e)
        | Surface::Lintel(e)
        | Surface::Pane(e)
        | Surface::Outside(e) => Some(e.0),
    }
}

/// The edge of its cell on which a ray starts: it counts as come through that. A pane's ray may start
/// on either side of the pane.
#[inline]
pub(super) fn entry_of(space: &Space, start: Place) -> Option<u32> {
    let e = start.on.and_then(edge_of)?;
    let edge = space.edge(e);
    Some(if edge.cell == start.cell.0 {
        e
    } else {
        edge.twin
    })
}

/// The edges through which a ray has come: whether one comes again. Of them one is kept, ever more
/// rarely another (Brent's cycle detection), so a circle is noticed after at most three times as many
/// steps as lead into it and around it.
pub(super) struct Trail {
    kept: u32,
    n: u32,
}

impl Trail {
    pub const NEW: Self = Self { kept: WALL, n: 0 };

    /// The ray comes through an edge; true if it did so before.
    #[inline]
    pub fn again(&mut self, edge: u32) -> bool {
        let again = edge == self.kept;
        self.n += 1;
        if self.n.is_power_of_two() {
            self.kept = edge;
        }
        again
    }
}

/// What the ray meets first, walking from cell to cell; `None` if it is still under way at `limit`
/// (in multiples of its direction), or leaves a level without heights upwards or downwards.
/// `visit` is told every cell on the way, with the stretch of the ray in it (up to the exit), and
/// gives a new limit: that of an object met there, or the old one.
pub fn walk(
    space: &Space,
    ray: &Ray,
    start: Place,
    limit: f64,
    visit: impl FnMut(CellId, f64) -> f64,
) -> Option<Met> {
    let at = (start.cell, entry_of(space, start));
    walk_from(space, ray, at, limit, visit)
}

/// As [`walk`] without a limit, for a ray that has come into a cell through one of its edges.
pub(super) fn walk_on(space: &Space, ray: &Ray, cell: CellId, entry: Option<u32>) -> Option<Met> {
    walk_from(space, ray, (cell, entry), f64::INFINITY, |_, _| {
        f64::INFINITY
    })
}

/// As [`walk`], for a ray that has come into a cell through one of its edges.
#[inline]
pub(super) fn walk_from(
    space: &Space,
    ray: &Ray,
    (start, mut entry): (CellId, Option<u32>),
    mut limit: f64,
    mut visit: impl FnMut(CellId, f64) -> f64,
) -> Option<Met> {
    let course = Course::new(space, *ray);
    let mut id = start;
    let (mut trail, mut circles) = (Trail::NEW, false);
    loop {
        let cell = space.cell(id.0);
        let exit = if circles {
            course.farthest_exit(cell, entry)
        } else {
            course.exit(cell, entry)
        };
        let z = match exit {
            Some(exit) => exit.z,
            // Straight up or down; or grazing the cell in a corner, where it ends.
            None => course.z_at_infinity(),
        };
        let flat = course.flat(cell, id, z);
        let until = match (flat, exit) {
            (Some(flat), _) => flat.t,
            (None, Some(exit)) => exit.t,
            (None, None) => f64::INFINITY,
        };
        limit = limit.min(visit(id, until));
        if until > limit {
            return None;
        }
        if flat.is_some() {
            return flat;
        }
        let exit = exit?;
        let border = space.edge(exit.edge);
        if let Some(surface) = face(border, exit.edge, exit.z) {
            return Some(Met {
                t: exit.t,
                surface,
                cell: id,
            });
        }
        id = CellId(space.edge(border.twin).cell);
        entry = Some(border.twin);
        if trail.again(border.twin) {
            if circles {
                // Lost among corners all of which lie within roundings of each other.
                return None;
            }
            (trail, circles) = (Trail::NEW, true);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::cells::{Locator, Options, subdivide};
    use crate::level::read::read;

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\nfloor = 0.5\nceiling = 2.5\n\
        [[archway]]\nbetween = [\"A\", \"B\"]\nwidth = 2\ntop = 2\n";

    fn met(origin: [f64; 3], direction: [f64; 3]) -> Option<(f64, Surface)> {
        let level = read(ROOMS.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let space = Space::new(&level, &graph);
        let origin = DVec3::from_array(origin);
        let at = level.grid.nearest(origin.truncate()).unwrap();
        let cell = Locator::new(&graph).cell_at(&graph, at).unwrap();
        let ray = Ray {
            origin,
            direction: DVec3::from_array(direction),
        };
        let found = walk(
            &space,
            &ray,
            Place { cell, on: None },
            f64::INFINITY,
            |_, _| f64::INFINITY,
        );
        found.map(|met| (met.t, met.surface))
    }

    #[test]
    fn through_the_archway_to_the_far_wall() {
        // From (1, 2, 1) east, the wall x = 8 is 7 away.
        let (t, surface) = met([1.0, 2.0, 1.0], [1.0, 0.0, 0.0]).unwrap();
        assert_eq!(t, 7.0);
        assert!(matches!(surface, Surface::Wall(_)));
        // Twice the direction, half the t.
        assert_eq!(met([1.0, 2.0, 1.0], [2.0, 0.0, 0.0]).unwrap().0, 3.5);
    }

    #[test]
    fn steps_and_lintels_stand_around_the_opening() {
        // B's floor is at 0.5, the archway's top at 2.
        let (t, surface) = met([1.0, 2.0, 0.25], [1.0, 0.0, 0.0]).unwrap();
        assert_eq!(t, 3.0);
        assert!(matches!(surface, Surface::Step(_)));
        let (t, surface) = met([1.0, 2.0, 2.25], [1.0, 0.0, 0.0]).unwrap();
        assert_eq!(t, 3.0);
        assert!(matches!(surface, Surface::Lintel(_)));
        // Beside the archway.
        let (t, surface) = met([1.0, 0.5, 1.0], [1.0, 0.0, 0.0]).unwrap();
        assert_eq!(t, 3.0);
        assert!(matches!(surface, Surface::Wall(_)));
    }

    #[test]
    fn floors_and_ceilings() {
        // Down by 1 in 4: from z = 1, B's floor at 0.5 is met at t = 2 (x = 3)? No: A's floor is 0,
        // reached at t = 4, but the opening at x = 4 (t = 3) is passed at z = 0.25, below B's floor.
        let (t, surface) = met([1.0, 2.0, 1.0], [1.0, 0.0, -0.25]).unwrap();
        assert_eq!(t, 3.0);
        assert!(matches!(surface, Surface::Step(_)));
        // Down by 1 in 8: at x = 4 z = 0.625; B's floor at t = 4.
        let (t, surface) = met([1.0, 2.0, 1.0], [1.0, 0.0, -0.125]).unwrap();
        assert_eq!(t, 4.0);
        assert!(matches!(surface, Surface::Floor(_)));
        // Straight up and down.
        let (t, surface) = met([1.0, 2.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        assert_eq!(t, 2.0);
        assert!(matches!(surface, Surface::Ceiling(_)));
        assert_eq!(met([1.0, 2.0, 1.0], [0.0, 0.0, -4.0]).unwrap().0, 0.25);
    }
}
