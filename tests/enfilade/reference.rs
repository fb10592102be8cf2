//! The exact PVS of a tiny level by another way: one line out of every class of lines.
//!
//! A line y = m·x + c that is not vertical meets the same walls and cells in the same order as long
//! as it passes no vertex. So there are finitely many classes: turn m from one direction between
//! two vertices to the next, and for each m put c between each two vertices that have just changed
//! places. One line of each class tells which cells lie between the same two walls on it. Visible
//! is an open condition, so vertical lines and lines through vertices add nothing.
//!
//! Shares no code with `sight` and `pvs`; of `cells` it takes the cells' corners. All fractions are
//! exact. O(n²) lines for n vertices, each against all walls and cells.

use std::cmp::Ordering;

use dashu_int::IBig;
use enfilade::cells::{CellGraph, Doors};
use enfilade::geom::Vertex;
use enfilade::level::Level;
use enfilade::pvs::BitMatrix;

use crate::sightline::{Act, act};

/// A fraction with a positive denominator, not reduced.
#[derive(Clone)]
struct Ratio(IBig, IBig);

impl Ratio {
    fn new(n: IBig, d: IBig) -> Self {
        if d < IBig::ZERO {
            Self(-n, -d)
        } else {
            Self(n, d)
        }
    }

    fn cmp(&self, other: &Self) -> Ordering {
        (&self.0 * &other.1).cmp(&(&other.0 * &self.1))
    }

    fn minus(&self, other: &Self) -> Self {
        Self(&self.0 * &other.1 - &other.0 * &self.1, &self.1 * &other.1)
    }

    fn middle(&self, other: &Self) -> Self {
        Self(
            &self.0 * &other.1 + &other.0 * &self.1,
            &self.1 * &other.1 * IBig::from(2),
        )
    }

    /// A fraction between two others with a small denominator (down the Stern–Brocot tree).
    fn between(low: &Self, high: &Self) -> Self {
        let floor = |r: &Self| {
            let (n, d) = (&r.0, &r.1);
            let q: IBig = n / d;
            if &q * d > *n { q - IBig::ONE } else { q }
        };
        let whole = floor(low);
        let next = Ratio(&whole + IBig::ONE, IBig::ONE);
        if next.cmp(high) == Ordering::Less {
            return next;
        }
        let base = Ratio(whole.clone(), IBig::ONE);
        let (a, b) = (low.minus(&base), high.minus(&base)); // 0 <= a < b <= 1
        if a.0 == IBig::ZERO {
            // Between 0 and b: 1/k with k above 1/b.
            let k = floor(&Ratio(b.1, b.0)) + IBig::ONE;
            return Ratio(&whole * &k + IBig::ONE, k);
        }
        // Between the reciprocals, turned over.
        let r = Ratio::between(&Ratio(b.1, b.0), &Ratio(a.1, a.0));
        Ratio(&whole * &r.0 + &r.1, r.0)
    }
}

struct Plan {
    /// Corners of cells and ends of walls: x, y, w.
    points: Vec<[IBig; 3]>,
    /// Opaque and cutting walls, by their ends.
    walls: Vec<(usize, usize, Act)>,
    /// For each wall that may be cut, the cutting ones in line with it.
    cutters: Vec<Vec<usize>>,
    cells: Vec<Vec<usize>>,
}

impl Plan {
    fn new(level: &Level, graph: &CellGraph, doors: Doors) -> Self {
        let mut vertices: Vec<Vertex> = Vec::new();
        let mut id = |v: Vertex| {
            vertices.iter().position(|&w| w == v).unwrap_or_else(|| {
                vertices.push(v);
                vertices.len() - 1
            })
        };
        let cells = graph
            .cell_ids()
            .map(|c| {
                graph
                    .polygon(c)
                    .into_iter()
                    .map(|v| id(*graph.vertices.exact(v)))
                    .collect()
            })
            .collect();
        let walls: Vec<(usize, usize, Act)> = level
            .walls
            .iter()
            .map(|w| (id(w.from.into()), id(w.to.into()), act(w, doors)))
            .filter(|w| w.2 != Act::Lets)
            .collect();
        let points: Vec<[IBig; 3]> = vertices
            .iter()
            .map(|v| [IBig::from(v.x()), IBig::from(v.y()), IBig::from(v.w())])
            .collect();
        let in_line = |a: usize, b: usize, c: usize| {
            let [p, q, r] = [a, b, c].map(|i| &points[i]);
            &p[0] * (&q[1] * &r[2] - &r[1] * &q[2]) - &p[1] * (&q[0] * &r[2] - &r[0] * &q[2])
                + &p[2] * (&q[0] * &r[1] - &r[0] * &q[1])
                == IBig::ZERO
        };
        let cutters = walls
            .iter()
            .map(|w| {
                let cuts = |h: &(usize, usize, Act)| {
                    h.2 == Act::Cuts && in_line(w.0, w.1, h.0) && in_line(w.0, w.1, h.1)
                };
                (0..walls.len()).filter(|&i| cuts(&walls[i])).collect()
            })
            .collect();
        Plan {
            points,
            walls,
            cutters,
            cells,
        }
    }
}

/// How many vertices cells and walls have; the cost goes with the square of it, and more.
pub fn size(level: &Level, graph: &CellGraph) -> usize {
    graph.vertices.len() + level.n_vertices
}

/// The exact PVS of a graph.
pub fn visible(level: &Level, graph: &CellGraph, doors: Doors) -> BitMatrix {
    let plan = Plan::new(level, graph, doors);
    let mut bits = BitMatrix::new(graph.cells.len());
    for cell in 0..plan.cells.len() {
        bits.set(cell, cell);
    }
    let n = plan.points.len();
    let mut order: Vec<usize> = Vec::new();
    for m in slopes(&plan) {
        // c·q = (y·q - x·p) / w for the slope m = p/q.
        let heights: Vec<Ratio> = plan
            .points
            .iter()
            .map(|[x, y, w]| Ratio(y * &m.1 - x * &m.0, w.clone()))
            .collect();
        let mut sorted: Vec<usize> = (0..n).collect();
        sorted.sort_by(|&a, &b| heights[a].cmp(&heights[b]));
        // A class of lines is new if other vertices lie below it than did for the last slope.
        let mut gained = 0usize;
        let mut below = vec![0i8; n];
        for k in 0..n - 1 {
            let new = order.is_empty() || {
                for (v, by) in [(sorted[k], 1), (order[k], -1)] {
                    gained -= usize::from(below[v] != 0);
                    below[v] += by;
                    gained += usize::from(below[v] != 0);
                }
                gained != 0
            };
            if new {
                let c = heights[sorted[k]].middle(&heights[sorted[k + 1]]);
                look_along(&plan, &heights, &c, &mut bits);
            }
        }
        order = sorted;
    }
    bits
}

/// One slope between each two neighbouring directions of two vertices, and beyond the last.
fn slopes(plan: &Plan) -> Vec<Ratio> {
    let mut critical = Vec::new();
    for (i, [x, y, w]) in plan.points.iter().enumerate() {
        for [u, v, t] in &plan.points[..i] {
            let dx = x * t - u * w;
            if dx != IBig::ZERO {
                critical.push(Ratio::new(y * t - v * w, dx));
            }
        }
    }
    critical.sort_by(Ratio::cmp);
    critical.dedup_by(|a, b| Ratio::cmp(a, b) == Ordering::Equal);
    let beyond = |r: &Ratio, by: i32| Ratio(&r.0 + &r.1 * IBig::from(by), r.1.clone());
    let (Some(first), Some(last)) = (critical.first(), critical.last()) else {
        return Vec::new();
    };
    let mut list = vec![beyond(first, -1)];
    list.extend(critical.windows(2).map(|w| Ratio::between(&w[0], &w[1])));
    list.push(beyond(last, 1));
    list
}

/// All cells that lie between the same two walls on the line see each other.
fn look_along(plan: &Plan, heights: &[Ratio], c: &Ratio, bits: &mut BitMatrix) {
    let over: Vec<Ratio> = heights.iter().map(|h| h.minus(c)).collect();
    let above = |v: usize| over[v].0 > IBig::ZERO;
    // x of the line's meeting with the segment from a to b.
    let meet = |a: usize, b: usize| {
        let (f, g) = (&over[a], &over[b]);
        // t = f / (f - g); x = xa + t (xb - xa)
        let (tn, td) = (&f.0 * &g.1, &f.0 * &g.1 - &g.0 * &f.1);
        let [xa, _, wa] = &plan.points[a];
        let [xb, _, wb] = &plan.points[b];
        Ratio::new(xa * wb * &td + &tn * (xb * wa - xa * wb), wa * wb * td)
    };
    let crossed = |w: usize| above(plan.walls[w].0) != above(plan.walls[w].1);
    let mut stops = Vec::new();
    for (i, &(a, b, act)) in plan.walls.iter().enumerate() {
        let stopped = match act {
            Act::Stops => true,
            Act::StopsUnlessCut => !plan.cutters[i].iter().any(|&h| crossed(h)),
            Act::Cuts | Act::Lets => false,
        };
        if stopped && crossed(i) {
            stops.push(meet(a, b));
        }
    }
    stops.sort_by(Ratio::cmp);
    let mut between: Vec<(usize, usize)> = Vec::new();
    for (cell, corners) in plan.cells.iter().enumerate() {
        let n = corners.len();
        let mut ends = (0..n)
            .map(|i| (corners[i], corners[(i + 1) % n]))
            .filter(|&(a, b)| above(a) != above(b))
            .map(|(a, b)| meet(a, b));
        let (Some(p), Some(q)) = (ends.next(), ends.next()) else {
            continue;
        };
        let middle = p.middle(&q);
        let gap = stops.partition_point(|s| s.cmp(&middle) == Ordering::Less);
        between.push((gap, cell));
    }
    for &(gap, cell) in &between {
        for &(other_gap, other) in &between {
            if gap == other_gap {
                bits.set(cell, other);
            }
        }
    }
}
