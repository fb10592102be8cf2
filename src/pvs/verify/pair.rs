//! Whether any straight line joins two convex cells past a set of obstacles; exact and slow.
//!
//! Lines that leave every corner of the two cells and every end of an obstacle on the same side meet
//! the same obstacles: they form a class. A class has on its border lines that pass through one of
//! these points alone. So it is enough to turn a line once about each point, stop between every two
//! directions in which it meets another, and look at the lines just left and just right of the
//! point. On which side each other point then lies follows from the order of the directions, which
//! is found with [`orient`].
//!
//! An obstacle blocks a line when its ends lie on different sides and it stands between the cells.
//! Most have the one cell on this side of their own line and the other on that: then they stand
//! between. For the others the line is put up in numbers, and its meetings are compared.
//!
//! O(k² log k) for k points.

use std::cmp::Ordering;
use std::collections::HashMap;

use dashu_int::IBig;

use super::caster::{Place, place};
use crate::geom::{Side, Vertex, orient};

/// More points than this take too long.
const MOST: usize = 3000;

/// How an obstacle stands to the two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stand {
    /// Its line has one cell on either side: whatever crosses it on the way is blocked.
    Between,
    /// Its line runs through a cell: it depends on where it is crossed.
    Depends,
}

struct Plan {
    points: Vec<Vertex>,
    /// The cells' corners, as points.
    cells: [Vec<usize>; 2],
    obstacles: Vec<([usize; 2], Stand)>,
    /// The obstacles that end in each point.
    at: Vec<Vec<usize>>,
}

/// Whether a line joins the inside of `a` with that of `b`, two convex polygons without a point
/// inside both. `None` for too many obstacles.
pub(super) fn joined(a: &[Vertex], b: &[Vertex], obstacles: &[[Vertex; 2]]) -> Option<bool> {
    let plan = Plan::new([a, b], obstacles);
    if plan.points.len() > MOST {
        return None;
    }
    Some((0..plan.points.len()).any(|pivot| plan.turn(pivot)))
}

impl Plan {
    fn new(cells: [&[Vertex]; 2], obstacles: &[[Vertex; 2]]) -> Self {
        let mut points = Vec::new();
        let mut known = HashMap::new();
        let mut index = |v: &Vertex| {
            *known.entry(*v).or_insert_with(|| {
                points.push(*v);
                points.len() - 1
            })
        };
        let corners = cells.map(|cell| cell.iter().map(&mut index).collect());
        let hull = hull(cells);
        let mut kept = Vec::new();
        for [p, q] in obstacles {
            if hull_misses(&hull, p, q) {
                continue;
            }
            let sides = cells.map(|cell| side_of_all(p, q, cell));
            let stand = match sides {
                [Some(a), Some(b)] if a == b => continue,
                [Some(_), Some(_)] => Stand::Between,
                _ => Stand::Depends,
            };
            kept.push(([index(p), index(q)], stand));
        }
        let mut at = vec![Vec::new(); points.len()];
        for (i, (ends, _)) in kept.iter().enumerate() {
            ends.iter().for_each(|&end| at[end].push(i));
        }
        Self {
            points,
            cells: corners,
            obstacles: kept,
            at,
        }
    }

    /// Turns a line about a point; whether it, moved a little aside, is free anywhere.
    fn turn(&self, pivot: usize) -> bool {
        let v = &self.points[pivot];
        // The others as directions in the upper half plane; true: they lie in the opposite one.
        let mut around: Vec<(usize, bool)> = (0..self.points.len())
            .filter(|&i| i != pivot)
            .map(|i| {
                let p = &self.points[i];
                let below = p.cmp_y(v).then(p.cmp_x(v)) == Ordering::Less;
                (i, below)
            })
            .collect();
        let turn = |a: &(usize, bool), b: &(usize, bool)| {
            let side = orient(v, &self.points[a.0], &self.points[b.0]);
            if a.1 == b.1 { side } else { side.flip() }
        };
        around.sort_by(|a, b| match turn(a, b) {
            Side::Left => Ordering::Less,
            Side::On => Ordering::Equal,
            Side::Right => Ordering::Greater,
        });
        // Before it turns, all directions lie left of the line, and the opposite ones right.
        let mut left = vec![false; self.points.len()];
        around.iter().for_each(|&(i, below)| left[i] = !below);
        let mut state = State::new(self, left);
        let groups: Vec<&[(usize, bool)]> =
            around.chunk_by(|a, b| turn(a, b) == Side::On).collect();
        for (k, group) in groups.iter().enumerate() {
            group.iter().for_each(|&(i, _)| state.flip(self, i));
            let next = groups[(k + 1) % groups.len()];
            for _ in 0..2 {
                state.flip(self, pivot);
                if !state.crosses_cells(self) || state.blocked[0] > 0 {
                    continue;
                }
                let open = state.blocked[1] == 0 || {
                    let wraps = k + 1 == groups.len();
                    let line = self.line(pivot, [group[0], next[0]], wraps, &state.left);
                    !self.is_blocked(&line, &state.left)
                };
                if open {
                    return true;
                }
            }
        }
        false
    }

    /// A line between two directions, just beside the pivot on the side that `left` tells: its
    /// coefficients, positive for points on its left.
    fn line(&self, pivot: usize, between: [(usize, bool); 2], wraps: bool, left: &[bool]) -> Place {
        let v = place(&self.points[pivot]);
        let way = |(i, below): (usize, bool)| -> [IBig; 2] {
            let p = place(&self.points[i]);
            let d = [0, 1].map(|axis| &p[axis] * &v[2] - &v[axis] * &p[2]);
            if below { d.map(|n| -n) } else { d }
        };
        let [first, mut second] = between.map(way);
        if wraps {
            // Past the last direction comes the first one's opposite.
            second = second.map(|n| -n);
        }
        // Of similar lengths, so that the numbers stay small; any sum of the two lies between.
        let bits = |d: &[IBig; 2]| {
            use dashu_int::ops::BitTest;
            d.iter().map(|n| n.bit_len()).max().unwrap_or(0)
        };
        let shift = bits(&second) as isize - bits(&first) as isize;
        let scaled = |d: [IBig; 2], by: isize| d.map(|n| n << by.max(0) as usize);
        let (first, second) = (scaled(first, shift), scaled(second, -shift));
        // A lone other point, or all in one line with the pivot: any direction across it.
        let [dx, dy] = if first == second.clone().map(|n| -n) {
            let [x, y] = first;
            [-y, x]
        } else {
            let [a, b] = first;
            let [c, d] = second;
            [a + c, b + d]
        };
        let (a, b) = (-dy, dx);
        let offset = |p: &Place| &a * &p[0] + &b * &p[1];
        let own = offset(&v);
        // The nearest point on the pivot's other side; the line goes through the middle between.
        let nearest = self
            .points
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != pivot && left[*i] != left[pivot])
            .map(|(_, p)| place(p))
            .min_by(|p, q| {
                let far = |p: &Place| {
                    let d = &own * &p[2] - offset(p) * &v[2];
                    if d < IBig::ZERO { -d } else { d }
                };
                (far(p) * &q[2]).cmp(&(far(q) * &p[2]))
            });
        match nearest {
            // Twice the sum's half: c = -(own/v.w + other/p.w)/2.
            Some(p) => {
                let scale = IBig::from(2) * &v[2] * &p[2];
                let c = -(&own * &p[2] + offset(&p) * &v[2]);
                [&a * &scale, &b * &scale, c]
            }
            // Nothing there: it does not matter how far.
            None => {
                let by = if left[pivot] { IBig::ONE } else { -IBig::ONE };
                [&a * &v[2], &b * &v[2], by - own]
            }
        }
    }

    /// Whether one of the obstacles that the line crosses stands between the cells.
    fn is_blocked(&self, line: &Place, left: &[bool]) -> bool {
        let [a, b] = self.cells.each_ref().map(|cell| {
            let n = cell.len();
            let edges = (0..n).map(|i| [cell[i], cell[(i + 1) % n]]);
            let crossed = edges.filter(|[p, q]| left[*p] != left[*q]);
            crossed
                .map(|ends| self.meeting(line, ends))
                .collect::<Vec<_>>()
        });
        let mut obstacles = self.obstacles.iter().map(|(ends, _)| *ends);
        obstacles.any(|[p, q]| {
            if left[p] == left[q] {
                return false;
            }
            // The cells have nothing in common and the obstacle is in neither: all of the one lies
            // before it and all of the other behind, or else it is not between them.
            let at = self.meeting(line, [p, q]);
            let before = |m: &[IBig; 2]| compare(m, &at) != Ordering::Greater;
            let behind = |m: &[IBig; 2]| compare(m, &at) != Ordering::Less;
            a.iter().all(before) && b.iter().all(behind)
                || a.iter().all(behind) && b.iter().all(before)
        })
    }

    /// Where the line meets a segment that it crosses: how far along the line, as a fraction with a
    /// positive denominator.
    fn meeting(&self, [a, b, c]: &Place, ends: [usize; 2]) -> [IBig; 2] {
        let [p, q] = ends.map(|i| place(&self.points[i]));
        let value = |p: &Place| a * &p[0] + b * &p[1] + c * &p[2];
        let along = |p: &Place| b * &p[0] - a * &p[1];
        // The point f·q − g·p, of weight f·wq − g·wp, where f and g are the ends' values.
        let (f, g) = (value(&p), value(&q));
        let n = &f * along(&q) - &g * along(&p);
        let d = &f * &q[2] - &g * &p[2];
        if d < IBig::ZERO { [-n, -d] } else { [n, d] }
    }
}

/// The order of two fractions.
fn compare(p: &[IBig; 2], q: &[IBig; 2]) -> Ordering {
    (&p[0] * &q[1]).cmp(&(&q[0] * &p[1]))
}

/// What a line leaves on which side.
struct State {
    left: Vec<bool>,
    /// Crossed obstacles: those between the cells, and those that depend.
    blocked: [usize; 2],
}

impl State {
    fn new(plan: &Plan, left: Vec<bool>) -> Self {
        let mut blocked = [0, 0];
        for ([p, q], stand) in &plan.obstacles {
            blocked[*stand as usize] += usize::from(left[*p] != left[*q]);
        }
        Self { left, blocked }
    }

    /// A point changes sides.
    fn flip(&mut self, plan: &Plan, point: usize) {
        self.left[point] = !self.left[point];
        for &i in &plan.at[point] {
            let ([p, q], stand) = plan.obstacles[i];
            let count = &mut self.blocked[stand as usize];
            if self.left[p] != self.left[q] {
                *count += 1;
            } else {
                *count -= 1;
            }
        }
    }

    /// Whether the line runs through the insides of both cells.
    fn crosses_cells(&self, plan: &Plan) -> bool {
        plan.cells.iter().all(|cell| {
            let n = cell.iter().filter(|&&i| self.left[i]).count();
            n > 0 && n < cell.len()
        })
    }
}

/// The side of the line from `p` to `q` on which all points lie, or on it; `None` if they lie on
/// both.
fn side_of_all(p: &Vertex, q: &Vertex, points: &[Vertex]) -> Option<Side> {
    let mut sides = points
        .iter()
        .map(|r| orient(p, q, r))
        .filter(|s| *s != Side::On);
    let first = sides.next()?;
    sides.all(|s| s == first).then_some(first)
}

/// The lines that bound the convex hull of two cells: all of both on the left.
fn hull(cells: [&[Vertex]; 2]) -> Vec<[Vertex; 2]> {
    let points = || cells.into_iter().flatten();
    let mut lines = Vec::new();
    for p in points() {
        for q in points().filter(|q| *q != p) {
            if points().all(|r| orient(p, q, r) != Side::Right) {
                lines.push([*p, *q]);
            }
        }
    }
    lines
}

/// Whether an obstacle certainly does not reach into a hull.
fn hull_misses(hull: &[[Vertex; 2]], p: &Vertex, q: &Vertex) -> bool {
    hull.iter()
        .any(|[a, b]| orient(a, b, p) == Side::Right && orient(a, b, q) == Side::Right)
}
