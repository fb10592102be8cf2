//! The faces into which a net of pieces parts the plan.
//!
//! In: a [`Net`]. Out: for each side of each piece, the face that it borders. Half-edge `2i` goes
//! along piece `i` and has its left side, `2i + 1` goes back. All signs are exact: products of grid
//! coordinates fit into 64 bits, their comparisons into 128.

use std::cmp::Ordering;

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::noding::{Net, cross};
use crate::geom::GridPoint;

/// A part of the plan that no piece crosses. Face 0 is the unbounded outside.
#[derive(Clone, Debug, Default)]
pub struct Face {
    /// Twice its area, in square steps, holes taken off; 0 for the outside.
    pub doubled_area: i128,
    /// Half-edges on its rim, holes included.
    pub rim: Vec<u32>,
}

/// All faces.
#[derive(Clone, Debug)]
pub struct Faces {
    /// The face on the left of each half-edge.
    pub face_of: Vec<u32>,
    /// The faces.
    pub faces: Vec<Face>,
}

struct Plan<'a> {
    net: &'a Net,
    /// Half-edges out of each point, counterclockwise, and where each point's begin.
    out: Vec<u32>,
    first: Vec<u32>,
    /// Place of each half-edge among those of its start.
    rank: Vec<u32>,
}

impl Plan<'_> {
    fn start(&self, half: u32) -> GridPoint {
        self.net.points[self.start_index(half)]
    }

    fn start_index(&self, half: u32) -> usize {
        self.net.pieces[half as usize / 2].ends[half as usize % 2] as usize
    }

    fn end(&self, half: u32) -> GridPoint {
        self.start(half ^ 1)
    }

    /// The half-edge that goes on around the same face: the next one clockwise from the way back.
    fn next(&self, half: u32) -> u32 {
        let back = half ^ 1;
        let at = self.start_index(back);
        let (from, to) = (self.first[at], self.first[at + 1]);
        let rank = self.rank[back as usize];
        let before = if rank == 0 { to - from - 1 } else { rank - 1 };
        self.out[(from + before) as usize]
    }
}

/// Finds all faces.
pub fn trace(net: &Net) -> Faces {
    let plan = fans(net);
    let n = 2 * net.pieces.len();
    // Around each face once: cycles, each with twice its area.
    let mut cycle_of = vec![u32::MAX; n];
    let mut cycles: Vec<(u32, i128)> = Vec::new();
    for start in 0..n as u32 {
        if cycle_of[start as usize] != u32::MAX {
            continue;
        }
        let mut area = 0i128;
        let mut half = start;
        loop {
            cycle_of[half as usize] = cycles.len() as u32;
            let (p, q) = (plan.start(half), plan.end(half));
            area += i128::from(p.x) * i128::from(q.y) - i128::from(p.y) * i128::from(q.x);
            half = plan.next(half);
            if half == start || cycle_of[half as usize] != u32::MAX {
                break;
            }
        }
        cycles.push((start, area));
    }
    // Cycles that go around ground are faces; the others are rims of holes in a face around them.
    let mut faces = vec![Face::default()];
    let mut face_of_cycle = vec![0u32; cycles.len()];
    for (cycle, (_, area)) in cycles.iter().enumerate().filter(|(_, c)| c.1 > 0) {
        face_of_cycle[cycle] = faces.len() as u32;
        faces.push(Face {
            doubled_area: *area,
            rim: Vec::new(),
        });
    }
    for (cycle, around) in holes(&plan, &cycles, &cycle_of) {
        let face = around.map_or(0, |c| face_of_cycle[c as usize]);
        face_of_cycle[cycle as usize] = face;
        if face > 0 {
            faces[face as usize].doubled_area += cycles[cycle as usize].1;
        }
    }
    let face_of: Vec<u32> = cycle_of
        .iter()
        .map(|&c| face_of_cycle[c as usize])
        .collect();
    for (half, &face) in face_of.iter().enumerate() {
        faces[face as usize].rim.push(half as u32);
    }
    Faces { face_of, faces }
}

/// The half-edges out of each point in counterclockwise order.
fn fans(net: &Net) -> Plan<'_> {
    let n = 2 * net.pieces.len();
    let mut out: Vec<u32> = (0..n as u32).collect();
    let mut plan = Plan {
        net,
        out: Vec::new(),
        first: vec![0; net.points.len() + 1],
        rank: vec![0; n],
    };
    out.sort_by(|&g, &h| {
        let order = plan.start_index(g).cmp(&plan.start_index(h));
        order.then_with(|| by_angle(plan.start(g), plan.end(g), plan.end(h)))
    });
    for &half in &out {
        let at = plan.start_index(half);
        plan.first[at + 1] += 1;
    }
    for i in 1..plan.first.len() {
        plan.first[i] += plan.first[i - 1];
    }
    for (i, &half) in out.iter().enumerate() {
        plan.rank[half as usize] = i as u32 - plan.first[plan.start_index(half)];
    }
    plan.out = out;
    plan
}

/// Compares two directions from a point, counterclockwise from east.
fn by_angle(from: GridPoint, p: GridPoint, q: GridPoint) -> Ordering {
    let lower = |p: GridPoint| p.y < from.y || (p.y == from.y && p.x < from.x);
    lower(p)
        .cmp(&lower(q))
        .then_with(|| 0.cmp(&cross(from, p, q)))
}

/// For each cycle that goes around nothing, from west to east: the cycle of the face around it.
fn holes(plan: &Plan, cycles: &[(u32, i128)], cycle_of: &[u32]) -> Vec<(u32, Option<u32>)> {
    let mut west: Vec<Option<GridPoint>> = vec![None; cycles.len()];
    for (half, &cycle) in cycle_of.iter().enumerate() {
        let p = plan.start(half as u32);
        let least = &mut west[cycle as usize];
        if least.is_none_or(|w| (p.x, p.y) < (w.x, w.y)) {
            *least = Some(p);
        }
    }
    let mut order: Vec<(GridPoint, u32)> = (0u32..)
        .zip(cycles)
        .filter(|(_, c)| c.1 <= 0)
        .filter_map(|(i, _)| Some((west[i as usize]?, i)))
        .collect();
    order.sort_by_key(|(p, i)| (p.x, p.y, *i));
    let corner = |p: GridPoint| [p.x as f64, p.y as f64];
    let tree = RTree::bulk_load(
        (0..plan.net.pieces.len() as u32)
            .map(|i| {
                let corners =
                    Rectangle::from_corners(corner(plan.start(2 * i)), corner(plan.end(2 * i)));
                GeomWithData::new(corners, 2 * i)
            })
            .collect(),
    );
    let mut around: Vec<Option<u32>> = vec![None; cycles.len()];
    for &(p, cycle) in &order {
        around[cycle as usize] = west_of(plan, &tree, p).and_then(|half| {
            let beside = cycle_of[half as usize];
            // Beside a hole's own rim is what lies around that hole, which stands further west.
            if cycles[beside as usize].1 > 0 {
                Some(beside)
            } else {
                around[beside as usize]
            }
        });
    }
    order
        .into_iter()
        .map(|(_, c)| (c, around[c as usize]))
        .collect()
}

/// The half-edge that a ray from `p` to the west meets first; going down, so that `p` is left of it.
fn west_of(
    plan: &Plan,
    tree: &RTree<GeomWithData<Rectangle<[f64; 2]>, u32>>,
    p: GridPoint,
) -> Option<u32> {
    let mut reach = 1024.0;
    loop {
        let (x, y) = (p.x as f64, p.y as f64);
        let strip = AABB::from_corners([x - reach, y], [x, y]);
        let mut best: Option<(u32, GridPoint, GridPoint)> = None;
        for near in tree.locate_in_envelope_intersecting(strip) {
            let (a, b) = (plan.start(near.data), plan.end(near.data));
            let (low, high, down) = if a.y < b.y {
                (a, b, near.data ^ 1)
            } else {
                (b, a, near.data)
            };
            // Half open, so that a ray through a point meets one of the two edges there.
            if !(low.y <= p.y && p.y < high.y) || cross(low, high, p) >= 0 {
                continue;
            }
            let nearer = best.is_none_or(|(_, l, h)| further_east(low, high, l, h, p.y));
            if nearer {
                best = Some((down, low, high));
            }
        }
        // What lies further west than the strip may still be nearer than what only begins in it.
        if let Some((half, low, high)) = best {
            let there = low.x as f64
                + (p.y - low.y) as f64 * (high.x - low.x) as f64 / (high.y - low.y) as f64;
            if there > x - reach + 2.0 {
                return Some(half);
            }
        }
        if reach > 2.0f64.powi(27) {
            return best.map(|(half, ..)| half);
        }
        reach *= 8.0;
    }
}

/// Whether the edge from `a` up to `b` passes the height `y` further east than that from `c` to `d`;
/// where both pass it in one point, just above.
fn further_east(a: GridPoint, b: GridPoint, c: GridPoint, d: GridPoint, y: i64) -> bool {
    let at = |low: GridPoint, high: GridPoint| {
        let rise = i128::from(high.y - low.y);
        let x = i128::from(low.x) * rise + i128::from(y - low.y) * i128::from(high.x - low.x);
        (x, rise, i128::from(high.x - low.x))
    };
    let ((x1, rise1, run1), (x2, rise2, run2)) = (at(a, b), at(c, d));
    (x1 * rise2)
        .cmp(&(x2 * rise1))
        .then((run1 * rise2).cmp(&(run2 * rise1)))
        .is_gt()
}
