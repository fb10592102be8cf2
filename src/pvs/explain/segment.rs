//! Segments with exact ends, and the walk along one from cell to cell.
//!
//! A [`Point`] is a fraction of big integers, so that it can lie where no grid point does: inside a
//! sliver, or on a line of which only a millionth of a step is free.

use dashu_int::IBig;
use glam::DVec2;

use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Grid, GridPoint, Side, Step, Vertex, VertexId};

/// An exact point of the plan `(x/w, y/w)` in grid steps; `w > 0`.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    x: IBig,
    y: IBig,
    w: IBig,
    at: DVec2,
}

impl From<GridPoint> for Point {
    fn from(p: GridPoint) -> Self {
        Self::from(&Vertex::from(p))
    }
}

impl From<&Vertex> for Point {
    fn from(v: &Vertex) -> Self {
        Self {
            x: v.x().into(),
            y: v.y().into(),
            w: v.w().into(),
            at: v.approx(),
        }
    }
}

impl Point {
    /// The nearest point whose coordinates are whole multiples of 2^-`bits` steps. At most 60 bits;
    /// coordinates below 2^26.
    pub fn rounded(p: DVec2, bits: u32) -> Self {
        let scale = 2f64.powi(bits as i32);
        let [x, y] = (p * scale).round().to_array();
        Self {
            x: IBig::from(x as i128),
            y: IBig::from(y as i128),
            w: IBig::from(1u64 << bits),
            at: DVec2::new(x, y) / scale,
        }
    }

    /// The point `(x/w, y/w)`; `None` for w = 0.
    pub fn homogeneous(x: IBig, y: IBig, w: IBig) -> Option<Self> {
        if w == IBig::ZERO {
            return None;
        }
        let (x, y, w) = if w < IBig::ZERO {
            (-x, -y, -w)
        } else {
            (x, y, w)
        };
        let at = DVec2::new(ratio(&x, &w), ratio(&y, &w));
        Some(Self { x, y, w, at })
    }

    /// The point in the middle between two others.
    pub fn middle(p: &Point, q: &Point) -> Self {
        let x = &p.x * &q.w + &q.x * &p.w;
        let y = &p.y * &q.w + &q.y * &p.w;
        let w = IBig::from(2) * &p.w * &q.w;
        let at = DVec2::new(ratio(&x, &w), ratio(&y, &w));
        Self { x, y, w, at }
    }

    /// x, y and w.
    pub fn coordinates(&self) -> [&IBig; 3] {
        [&self.x, &self.y, &self.w]
    }

    /// The point in f64, in grid steps, as near as rounding allows.
    pub fn approx(&self) -> DVec2 {
        self.at
    }

    /// The point as a vertex, where it is small enough for one.
    pub fn vertex(&self) -> Option<Vertex> {
        let [x, y] = [&self.x, &self.y].map(|n| i128::try_from(n).ok());
        Vertex::homogeneous(x?, y?, i64::try_from(&self.w).ok()?)
    }

    /// Whether the point's coordinates in the level's own unit are f64 numbers without rounding.
    pub fn survives(&self, grid: &Grid) -> bool {
        let Step::Binary(_) = grid.step else {
            return false;
        };
        let origin = grid.origin.map(|o| o as f64);
        let scale = 2f64.powi(60);
        let exactly = |n: &IBig, at: f64, origin: f64| {
            let shifted = (at + origin) - origin == at;
            shifted && IBig::from((at * scale) as i128) * &self.w == n * IBig::from(1u64 << 60)
        };
        exactly(&self.x, self.at.x, origin[0]) && exactly(&self.y, self.at.y, origin[1])
    }

    /// The grid point, if it is one.
    pub fn grid(&self) -> Option<GridPoint> {
        let whole = |n: &IBig| -> Option<i64> {
            (n % &self.w == IBig::ZERO)
                .then(|| i64::try_from(n / &self.w).ok())
                .flatten()
        };
        Some(GridPoint::new(whole(&self.x)?, whole(&self.y)?))
    }

    /// `a·x + b·y + c·w`: its sign tells the side of a line with these coefficients.
    fn along(&self, a: &IBig, b: &IBig, c: &IBig) -> IBig {
        a * &self.x + b * &self.y + c * &self.w
    }
}

/// The quotient, nearly correctly rounded: both numbers are cut to 100 bits first.
fn ratio(n: &IBig, d: &IBig) -> f64 {
    let bits = |m: &IBig| m.to_f64().value().abs().log2();
    let (bn, bd) = (bits(n), bits(d));
    if bn.is_finite() && bd.is_finite() {
        return n.to_f64().value() / d.to_f64().value();
    }
    if *n == IBig::ZERO {
        return 0.0;
    }
    // Beyond f64: shift both down until they are not.
    let half = IBig::from(1) << 512;
    ratio(&(n / &half), &(d / &half))
}

/// A directed line through two different points, with exact coefficients.
#[derive(Clone, Debug)]
pub struct Course {
    from: DVec2,
    to: DVec2,
    a: IBig,
    b: IBig,
    c: IBig,
}

impl Course {
    /// The line from `p` to `q`.
    pub fn through(p: &Point, q: &Point) -> Self {
        // The sides of (x, y, w) are the determinant's: left is positive.
        Self {
            from: p.at,
            to: q.at,
            a: &p.y * &q.w - &q.y * &p.w,
            b: &q.x * &p.w - &p.x * &q.w,
            c: &p.x * &q.y - &q.x * &p.y,
        }
    }

    /// On which side of the line the vertex lies; exact.
    pub fn side(&self, graph: &CellGraph, v: VertexId) -> Side {
        let at = graph.vertices.approx(v);
        let cross = (self.to - self.from).perp_dot(at - self.from);
        // As for [`Vertices`](crate::geom::Vertices): the copies of all three points are off by at
        // most 3.01·2^-53 of the largest coordinate m, and the cross product by less than 2^-45·m².
        let m = self
            .from
            .abs()
            .max(self.to.abs())
            .max(at.abs())
            .max_element();
        if cross.abs() > m * m * 2f64.powi(-45) {
            return Side::of(cross);
        }
        let point = Point::from(graph.vertices.exact(v));
        Side::of(point.along(&self.a, &self.b, &self.c))
    }
}

/// On which side of the line from vertex `p` to vertex `q` the point lies; exact.
fn side_of_edge(graph: &CellGraph, p: VertexId, q: VertexId, point: &Point) -> Side {
    let [p, q] = [p, q].map(|v| graph.vertices.exact(v));
    if let Some(at) = point.grid() {
        return crate::geom::orient(p, q, &at.into());
    }
    let course = Course::through(&Point::from(p), &Point::from(q));
    Side::of(point.along(&course.a, &course.b, &course.c))
}

/// Whether a point lies strictly inside a cell; exact.
pub fn is_inside(graph: &CellGraph, cell: CellId, point: &Point) -> bool {
    graph
        .edge_range(cell)
        .map(EdgeId)
        .all(|e| side_of_edge(graph, graph.edge(e).origin, graph.end(e), point) == Side::Left)
}

/// A segment between two points strictly inside cells, which crosses nothing but portals, and those
/// strictly between their ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Its start.
    pub from: Point,
    /// Its end.
    pub to: Point,
}

impl Segment {
    /// The portals that the segment crosses, from `start` on, as edges of the cells that it leaves;
    /// exact. `None` unless it begins strictly inside `start`, ends strictly inside some cell, and
    /// meets neither a wall nor a vertex.
    pub fn portals(&self, graph: &CellGraph, start: CellId) -> Option<Vec<EdgeId>> {
        if !is_inside(graph, start, &self.from) {
            return None;
        }
        let mut chain = Vec::new();
        if self.from == self.to {
            return Some(chain);
        }
        let course = Course::through(&self.from, &self.to);
        let mut cell = start;
        loop {
            // A ray leaves a convex cell through the edge that goes from its right to its left.
            let mut edges = graph.edge_range(cell).map(EdgeId);
            let exit = edges.find(|&e| {
                course.side(graph, graph.edge(e).origin) == Side::Right
                    && course.side(graph, graph.end(e)) == Side::Left
            })?;
            match side_of_edge(graph, graph.edge(exit).origin, graph.end(exit), &self.to) {
                Side::Left => return Some(chain),
                Side::On => return None,
                Side::Right => {
                    chain.push(exit);
                    cell = graph.edge(graph.edge(exit).twin()?).cell;
                }
            }
        }
    }

    /// Length in grid steps.
    pub fn length(&self) -> f64 {
        self.from.at.distance(self.to.at)
    }
}

/// A segment on the line `a·x + b·y + c = 0`, positive on its left, from the middle of what it has
/// in `start` to the middle of what it has in `end`. `None` where it misses one of them.
pub fn on_line(
    graph: &CellGraph,
    [a, b, c]: [&IBig; 3],
    start: CellId,
    end: CellId,
) -> Option<Segment> {
    let middle = |cell: CellId| {
        let mut met: Vec<Point> = Vec::new();
        for e in graph.edge_range(cell).map(EdgeId) {
            let [p, q] =
                [graph.edge(e).origin, graph.end(e)].map(|v| Point::from(graph.vertices.exact(v)));
            let (f, g) = (p.along(a, b, c), q.along(a, b, c));
            // Each corner counts for the edge that starts in it.
            if f == IBig::ZERO {
                met.push(p);
            } else if (f > IBig::ZERO) != (g > IBig::ZERO) && g != IBig::ZERO {
                // p/pw + t (q/qw - p/pw) with t = f·qw / (f·qw - g·pw)
                let x = &p.x * &g - &q.x * &f;
                let y = &p.y * &g - &q.y * &f;
                let w = &p.w * &g - &q.w * &f;
                met.extend(Point::homogeneous(x, y, w));
            }
        }
        let [p, q] = &met[..] else { return None };
        Some(Point::middle(p, q))
    };
    Some(Segment {
        from: middle(start)?,
        to: middle(end)?,
    })
}
