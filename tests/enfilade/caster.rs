//! What one eye sees, by another way: a ray in the middle of every range of directions in which
//! nothing changes.
//!
//! What a ray meets first changes only where the direction passes an end of a wall or a crossing of
//! two, as seen from the eye. So one ray between each two of those directions tells which wall ends
//! the view in all of that range. Shares no code with `pvs`; everything is exact, in big integers,
//! until an area is turned into f64. O(n²) for n walls.

use std::cmp::Ordering;

use dashu_int::IBig;
use enfilade::cells::{CellGraph, CellId, Doors, EdgeId};
use enfilade::geom::Vertex;
use enfilade::level::{Level, WallId};

use crate::sightline::{Act, act};

/// A point in homogeneous coordinates with w > 0; a direction has w = 0.
pub type Point = [IBig; 3];

/// A fraction with a positive denominator.
#[derive(Clone, Debug)]
pub struct Ratio(IBig, IBig);

impl Ratio {
    fn new(n: IBig, d: IBig) -> Self {
        if d < IBig::ZERO {
            Self(-n, -d)
        } else {
            Self(n, d)
        }
    }

    pub fn cmp(&self, other: &Self) -> Ordering {
        (&self.0 * &other.1).cmp(&(&other.0 * &self.1))
    }

    fn is_positive(&self) -> bool {
        self.0 > IBig::ZERO
    }

    fn to_f64(&self) -> f64 {
        self.0.to_f64().value() / self.1.to_f64().value()
    }
}

/// A vertex.
pub fn point(v: &Vertex) -> Point {
    [IBig::from(v.x()), IBig::from(v.y()), IBig::from(v.w())]
}

/// A direction.
pub fn direction([x, y]: [i64; 2]) -> Point {
    [IBig::from(x), IBig::from(y), IBig::ZERO]
}

fn line([px, py, pw]: &Point, [qx, qy, qw]: &Point) -> Point {
    [py * qw - qy * pw, qx * pw - px * qw, px * qy - qx * py]
}

fn apply(line: &Point, p: &Point) -> IBig {
    &line[0] * &p[0] + &line[1] * &p[1] + &line[2] * &p[2]
}

fn sign(n: &IBig) -> i8 {
    match n.cmp(&IBig::ZERO) {
        Ordering::Less => -1,
        Ordering::Equal => 0,
        Ordering::Greater => 1,
    }
}

/// Sign of the turn from one direction to another.
pub fn turn(d: &Point, e: &Point) -> i8 {
    sign(&(&d[0] * &e[1] - &d[1] * &e[0]))
}

fn same(d: &Point, e: &Point) -> bool {
    turn(d, e) == 0 && sign(&(&d[0] * &e[0] + &d[1] * &e[1])) > 0
}

/// Counterclockwise from the x axis.
fn by_angle(d: &Point, e: &Point) -> Ordering {
    let lower = |d: &Point| sign(&d[1]) < 0 || (sign(&d[1]) == 0 && sign(&d[0]) < 0);
    lower(d).cmp(&lower(e)).then_with(|| turn(e, d).cmp(&0))
}

/// A direction strictly between two that are less than a half turn apart.
pub fn between(d: &Point, e: &Point) -> Point {
    weighed(d, e, [1, 1])
}

/// A direction strictly between two that are less than a half turn apart, at about `n` parts from
/// the second and `m` from the first.
pub fn weighed(d: &Point, e: &Point, [n, m]: [u32; 2]) -> Point {
    // Stretched to about equal length first.
    let bits = |p: &Point| p[..2].iter().map(|n| n.abs_bits()).max().unwrap_or(0);
    let (long, other) = (bits(d), bits(e));
    let (up, vp) = (other.saturating_sub(long), long.saturating_sub(other));
    [0, 1, 2].map(|i| (&d[i] << up) * IBig::from(n) + (&e[i] << vp) * IBig::from(m))
}

trait Bits {
    fn abs_bits(&self) -> usize;
}

impl Bits for IBig {
    fn abs_bits(&self) -> usize {
        use dashu_int::ops::{BitTest, UnsignedAbs};
        self.unsigned_abs().bit_len()
    }
}

/// Whether a direction lies strictly between two, counterclockwise.
pub fn within(d: &Point, [low, high]: &[Point; 2]) -> bool {
    match turn(low, high) {
        1 => turn(low, d) > 0 && turn(d, high) > 0,
        0 => turn(low, d) > 0,
        _ => turn(low, d) > 0 || turn(d, high) > 0,
    }
}

struct Wall {
    from: Point,
    to: Point,
    line: Point,
    act: Act,
    cutters: Vec<usize>,
}

/// An eye among walls.
pub struct Caster<'a> {
    graph: &'a CellGraph,
    eye: Point,
    walls: Vec<Wall>,
    own: Vec<CellId>,
}

/// A range of directions in which one wall ends the view.
pub struct Sector {
    pub low: Point,
    pub high: Point,
    area: Ratio,
}

impl Sector {
    /// Area of the triangle that is seen here, in square grid steps.
    pub fn area(&self) -> f64 {
        self.area.to_f64()
    }
}

impl<'a> Caster<'a> {
    /// The walls of a level. `own` are the cells that touch the eye.
    pub fn new(
        level: &Level,
        graph: &'a CellGraph,
        doors: Doors,
        eye: &Vertex,
        own: Vec<CellId>,
    ) -> Self {
        let wall = |from: &Vertex, to: &Vertex, act| {
            let (from, to) = (point(from), point(to));
            let line = line(&from, &to);
            Wall {
                from,
                to,
                line,
                act,
                cutters: Vec::new(),
            }
        };
        let mut walls: Vec<Wall> = level
            .walls
            .iter()
            .map(|w| wall(&w.from.into(), &w.to.into(), act(w, doors)))
            .filter(|w| w.act != Act::Lets)
            .collect();
        // What opens to the outside (a window, a line with one side) is opaque there.
        for e in (0..graph.edges.len() as u32).map(EdgeId) {
            let edge = graph.edge(e);
            let opens = |id: WallId| {
                matches!(
                    act(&level.walls[id.0 as usize], doors),
                    Act::Cuts | Act::Lets
                )
            };
            if edge.twin().is_none() && edge.wall().is_some_and(opens) {
                let ends = [edge.origin, graph.end(e)].map(|v| graph.vertices.exact(v));
                walls.push(wall(ends[0], ends[1], Act::Stops));
            }
        }
        let cutters: Vec<usize> = (0..walls.len())
            .filter(|&i| walls[i].act == Act::Cuts)
            .collect();
        for wall in 0..walls.len() {
            if walls[wall].act == Act::StopsUnlessCut {
                let on = |p: &Point| apply(&walls[wall].line, p) == IBig::ZERO;
                let in_line = |&&i: &&usize| on(&walls[i].from) && on(&walls[i].to);
                walls[wall].cutters = cutters.iter().filter(in_line).copied().collect();
            }
        }
        Self {
            graph,
            eye: point(eye),
            walls,
            own,
        }
    }

    /// The direction from the eye to a point, zero if it is the eye.
    pub fn to(&self, p: &Point) -> Point {
        let [x, y, w] = &self.eye;
        [&p[0] * w - x * &p[2], &p[1] * w - y * &p[2], IBig::ZERO]
    }

    /// Where the line through the eye in direction `d` meets another line, as a multiple of `d`.
    fn meet(&self, d: &Point, line: &Point) -> Ratio {
        Ratio::new(-apply(line, &self.eye), apply(line, d) * &self.eye[2])
    }

    /// Whether the line through the eye in direction `d` separates two points.
    fn parts(&self, d: &Point, p: &Point, q: &Point) -> bool {
        turn(d, &self.to(p)) * turn(d, &self.to(q)) < 0
    }

    /// How far one sees in a direction that passes no end of a wall, as a multiple of `d`; and the
    /// wall there. `None` where nothing ends the view. A wall on which the eye lies ends nothing.
    fn first_wall(&self, d: &Point) -> Option<(Ratio, usize)> {
        let mut first: Option<(Ratio, usize)> = None;
        for (i, wall) in self.walls.iter().enumerate() {
            if wall.act == Act::Cuts || !self.parts(d, &wall.from, &wall.to) {
                continue;
            }
            let at = self.meet(d, &wall.line);
            if !at.is_positive() || first.as_ref().is_some_and(|f| f.0.cmp(&at).is_le()) {
                continue;
            }
            let open = |&h: &usize| self.parts(d, &self.walls[h].from, &self.walls[h].to);
            if wall.act == Act::StopsUnlessCut && wall.cutters.iter().any(open) {
                continue;
            }
            first = Some((at, i));
        }
        first
    }

    /// Whether a direction leads from the eye into one of its own cells.
    fn leads_inside(&self, d: &Point) -> bool {
        let graph = self.graph;
        self.own.iter().any(|&cell| {
            let corners: Vec<Point> = graph
                .corners(cell)
                .map(|v| point(graph.vertices.exact(v)))
                .collect();
            let n = corners.len();
            (0..n).all(|i| {
                let border = line(&corners[i], &corners[(i + 1) % n]);
                // Strictly inside of the edge at once, or already so.
                apply(&border, &self.eye) > IBig::ZERO || apply(&border, d) > IBig::ZERO
            })
        })
    }

    /// All that is seen, in ranges of directions; none of the directions `also` is inside of one.
    pub fn sectors(&self, also: &[Point]) -> Vec<Sector> {
        let ends = self
            .walls
            .iter()
            .flat_map(|w| [self.to(&w.from), self.to(&w.to)]);
        let mut changes: Vec<Point> = ends.chain(also.iter().cloned()).collect();
        changes.extend(self.crossings());
        // Enough that no range is a half turn or more.
        changes.extend([[1, 0], [0, 1], [-1, 0], [0, -1]].map(direction));
        changes.retain(|d| d[0] != IBig::ZERO || d[1] != IBig::ZERO);
        changes.sort_by(by_angle);
        changes.dedup_by(|d, e| same(d, e));
        let n = changes.len();
        let mut sectors = Vec::new();
        for i in 0..n {
            let (low, high) = (&changes[i], &changes[(i + 1) % n]);
            let middle = between(low, high);
            // Borders between the eye's own cells may lead the same way.
            let ways = [[1, 1], [31, 17], [97, 11]].map(|w| weighed(low, high, w));
            if !ways.iter().any(|d| self.leads_inside(d)) {
                continue;
            }
            let (_, wall) = self.first_wall(&middle).expect("walls enclose the inside");
            let [a, b] = [low, high].map(|d| self.meet(d, &self.walls[wall].line));
            let cross = &low[0] * &high[1] - &low[1] * &high[0];
            let area = Ratio::new(a.0 * b.0 * cross, a.1 * b.1 * IBig::from(2));
            sectors.push(Sector {
                low: low.clone(),
                high: high.clone(),
                area,
            });
        }
        sectors
    }

    /// Directions in which two walls cross.
    fn crossings(&self) -> Vec<Point> {
        let side = |w: &Wall, p: &Point| sign(&apply(&w.line, p));
        let crosses = |v: &Wall, w: &Wall| side(v, &w.from) * side(v, &w.to) < 0;
        let mut list = Vec::new();
        for (i, v) in self.walls.iter().enumerate() {
            for w in &self.walls[..i] {
                if crosses(v, w) && crosses(w, v) {
                    let mut p = line(&v.line, &w.line);
                    if p[2] < IBig::ZERO {
                        p = p.map(|n| -n);
                    }
                    list.push(self.to(&p));
                }
            }
        }
        list
    }

    /// Whether a ray that passes no end of a wall reaches the inside of a cell before any wall.
    pub fn reaches(&self, d: &Point, cell: CellId) -> bool {
        let graph = self.graph;
        let corners: Vec<Point> = graph
            .corners(cell)
            .map(|v| point(graph.vertices.exact(v)))
            .collect();
        let n = corners.len();
        let edges = (0..n).map(|i| (&corners[i], &corners[(i + 1) % n]));
        let mut meets: Vec<Ratio> = edges
            .filter(|(p, q)| self.parts(d, p, q))
            .map(|(p, q)| self.meet(d, &line(p, q)))
            .collect();
        meets.sort_by(Ratio::cmp);
        let [enters, leaves] = &meets[..] else {
            return false;
        };
        let stop = self.first_wall(d).map(|f| f.0);
        leaves.is_positive() && stop.is_none_or(|stop| enters.cmp(&stop).is_lt())
    }

    /// Whether the segment from the eye to a point touches no opaque wall, but perhaps in the eye.
    /// Ends of walls and of openings count as opaque.
    pub fn is_free(&self, q: &Vertex) -> bool {
        let q = point(q);
        let d = self.to(&q);
        // `d` is longer than the way to `q` by the product of both w.
        let end = Ratio(IBig::ONE, &self.eye[2] * &q[2]);
        let beyond = |w: &Wall| {
            let at = self.meet(&d, &w.line);
            !at.is_positive() || at.cmp(&end).is_gt()
        };
        let touches = |p: &Point, q: &Point| turn(&d, &self.to(p)) * turn(&d, &self.to(q)) <= 0;
        self.walls.iter().all(|wall| {
            if wall.act == Act::Cuts || !touches(&wall.from, &wall.to) {
                return true;
            }
            if apply(&wall.line, &d) == IBig::ZERO {
                // In line with the eye: out of the way only if wholly behind it.
                return [&wall.from, &wall.to]
                    .iter()
                    .all(|p| !same(&d, &self.to(p)));
            }
            let open = |&h: &usize| self.parts(&d, &self.walls[h].from, &self.walls[h].to);
            beyond(wall) || (wall.act == Act::StopsUnlessCut && wall.cutters.iter().any(open))
        })
    }
}
