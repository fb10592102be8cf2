//! Single segments against the level's own walls, for those who want a third opinion on a pair.

use super::walls::Walls;
use crate::cells::Doors;
use crate::geom::{GridPoint, Side, Vertex, orient};
use crate::level::Level;

/// Casts segments through the walls of a level, with none of the code that finds visible sets.
pub struct Caster {
    walls: Walls,
}

impl Caster {
    /// The level's walls, found by place.
    pub fn new(level: &Level, doors: Doors) -> Self {
        Self {
            walls: Walls::new(level, doors),
        }
    }

    /// Whether the closed segment touches no opaque wall. Ends of walls count as opaque, so that
    /// what is free is so with some margin. Exact.
    pub fn is_free(&self, from: &Vertex, to: &Vertex) -> bool {
        let (p, q) = (from.approx(), to.approx());
        // A step more each way than the rounded ends need.
        let low = p.min(q).floor() - 1.0;
        let high = p.max(q).ceil() + 1.0;
        let [low, high] = [low, high].map(|p| GridPoint::new(p.x as i64, p.y as i64));
        let mut near = Vec::new();
        self.walls.opaque.near(low, high, &mut near);
        near.iter().all(|&i| {
            let wall = &self.walls.opaque.list[i as usize];
            !touch(from, to, &wall.from.into(), &wall.to.into())
        })
    }
}

/// Whether two closed segments have a point in common.
fn touch(a: &Vertex, b: &Vertex, c: &Vertex, d: &Vertex) -> bool {
    let apart = |cmp: fn(&Vertex, &Vertex) -> std::cmp::Ordering| {
        let before = |p: [&Vertex; 2], q: [&Vertex; 2]| {
            p.iter().all(|p| q.iter().all(|q| cmp(p, q).is_lt()))
        };
        before([a, b], [c, d]) || before([c, d], [a, b])
    };
    if apart(Vertex::cmp_x) || apart(Vertex::cmp_y) {
        return false;
    }
    let strictly = |p: Side, q: Side| p == q && p != Side::On;
    !strictly(orient(a, b, c), orient(a, b, d)) && !strictly(orient(c, d, a), orient(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level::read::read;
    use glam::DVec2;

    #[test]
    fn doors_let_through_and_jambs_do_not() {
        let text = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
            [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
            [[door]]\npoints = [[4, 1], [4, 2]]\n";
        let level = read(text.into(), "rooms.toml", None).unwrap();
        let at = |x, y| Vertex::from(level.grid.nearest(DVec2::new(x, y)).unwrap());
        let open = Caster::new(&level, Doors::Open);
        assert!(open.is_free(&at(1.0, 1.5), &at(7.0, 1.5)));
        assert!(open.is_free(&at(7.0, 1.5), &at(1.0, 1.5)));
        assert!(!open.is_free(&at(1.0, 1.0), &at(7.0, 1.0)), "a jamb");
        assert!(!open.is_free(&at(1.0, 3.0), &at(7.0, 3.0)), "the wall");
        assert!(!open.is_free(&at(1.0, 3.0), &at(4.0, 3.0)), "up to the wall");
        assert!(open.is_free(&at(1.0, 3.0), &at(3.9, 3.0)));
        let closed = Caster::new(&level, Doors::Closed);
        assert!(!closed.is_free(&at(1.0, 1.5), &at(7.0, 1.5)));
        // A hair's breadth off the jamb, between grid points.
        let jamb = at(4.0, 1.0);
        let beside = |x: Vertex, by: i128| {
            Vertex::homogeneous(x.x() << 20, (jamb.y() << 20) + by, 1 << 20).unwrap()
        };
        assert!(open.is_free(&beside(at(1.0, 0.0), 1), &beside(at(7.0, 0.0), 1)));
        assert!(!open.is_free(&beside(at(1.0, 0.0), -1), &beside(at(7.0, 0.0), -1)));
    }
}
