//! A graph with a wall put into a straight run of portals, with the same cells.
//!
//! In: a graph, portals in line, and a length. Out: the graph with a wall of about this length in their
//! middle. The wall's ends are exact points of the portals' line, where it meets a vertical or a
//! horizontal line of the grid, so that all signs stay exact.

use ethnum::I256;
use glam::DVec2;

use super::{CellGraph, Edge, EdgeId, Portal};
use crate::geom::{Vertex, VertexId, Vertices};

/// Widths for which the signs of a vertex on a line are proved.
const SLOPE_BITS: u32 = 27;
const OFFSET_BITS: u32 = 53;

impl CellGraph {
    /// The graph with a wall in the middle of a run of portals: edges that follow each other in line.
    /// `length` is in grid steps, and met to about two steps; a wall that is not shorter than the run
    /// closes it. Also where the wall starts and ends. `None` where the run is too short to tell a
    /// wall from nothing, or lies on no line of the grid.
    pub fn walled(&self, run: &[EdgeId], length: f64) -> Option<(CellGraph, [DVec2; 2])> {
        let (&first, &last) = (run.first()?, run.last()?);
        let ends = [self.edge(first).origin, self.end(last)];
        let [from, to] = ends.map(|v| self.vertices.approx(v));
        if length >= from.distance(to) {
            return Some((self.closed(run), [from, to]));
        }
        let line = through(self.vertices.exact(ends[0]), self.vertices.exact(ends[1]))?;
        let half = (to - from).normalize() * (length / 2.0);
        let middle = from.midpoint(to);
        let cuts = [middle - half, middle + half].map(|p| line.at(p));
        let [Some(start), Some(end)] = cuts else {
            return None;
        };
        let before = |p: &Vertex, q: &Vertex| line.comes_before([from, to], p, q);
        let [low, high] = ends.map(|v| self.vertices.exact(v));
        if !(before(low, &start) && before(&start, &end) && before(&end, high)) {
            return None;
        }
        Some((
            self.cut(run, [start, end], before),
            [start.approx(), end.approx()],
        ))
    }

    /// The graph with the run's edges cut at two points, and a wall between these.
    fn cut(
        &self,
        run: &[EdgeId],
        cuts: [Vertex; 2],
        before: impl Fn(&Vertex, &Vertex) -> bool,
    ) -> CellGraph {
        let mut vertices: Vec<Vertex> = self.vertices.iter().copied().collect();
        // Of each edge, the vertices that cut it, in its direction; and which of its parts are wall.
        let mut inner: Vec<Vec<VertexId>> = vec![Vec::new(); self.edges.len()];
        let mut walled: Vec<Vec<bool>> = vec![Vec::new(); self.edges.len()];
        let new = cuts.map(|cut| {
            vertices.push(cut);
            VertexId(vertices.len() as u32 - 1)
        });
        for &e in run {
            let [p, q] = [self.edge(e).origin, self.end(e)].map(|v| *self.vertices.exact(v));
            for (cut, &v) in cuts.iter().zip(&new) {
                if before(&p, cut) && before(cut, &q) {
                    inner[e.0 as usize].push(v);
                }
            }
            let corners = inner[e.0 as usize].iter().map(|v| vertices[v.0 as usize]);
            let starts: Vec<Vertex> = std::iter::once(p).chain(corners).collect();
            let within = |s: &Vertex| !before(s, &cuts[0]) && before(s, &cuts[1]);
            walled[e.0 as usize] = starts.iter().map(within).collect();
            if let Some(twin) = self.edge(e).twin() {
                let (e, twin) = (e.0 as usize, twin.0 as usize);
                inner[twin] = inner[e].iter().rev().copied().collect();
                walled[twin] = walled[e].iter().rev().copied().collect();
            }
        }
        let mut place = Vec::with_capacity(self.edges.len());
        let mut n = 0u32;
        for cuts in &inner {
            place.push(n);
            n += 1 + cuts.len() as u32;
        }
        let mut graph = self.clone();
        (graph.tree, graph.edges, graph.portals) = (None, Vec::new(), Vec::new());
        graph.vertices = Vertices::new(vertices);
        for cell in &mut graph.cells {
            let past = cell.first_edge + cell.n_edges;
            let past = place.get(past as usize).copied().unwrap_or(n);
            cell.first_edge = place[cell.first_edge as usize];
            cell.n_edges = past - cell.first_edge;
        }
        for (i, old) in self.edges.iter().enumerate() {
            let parts = inner[i].len();
            for k in 0..=parts {
                let is_wall = walled[i].get(k).copied().unwrap_or(false);
                let twin = match old.twin() {
                    Some(twin) if !is_wall => EdgeId(place[twin.0 as usize] + (parts - k) as u32),
                    _ => EdgeId::NONE,
                };
                let origin = if k == 0 { old.origin } else { inner[i][k - 1] };
                graph.edges.push(Edge {
                    origin,
                    twin,
                    ..*old
                });
                let own = EdgeId(place[i] + k as u32);
                if twin != EdgeId::NONE && own < twin {
                    graph.portals.push(Portal {
                        edges: [own, twin],
                        ..self.portal_of(EdgeId(i as u32))
                    });
                }
            }
        }
        graph
    }

    /// The portal of an edge that has a twin.
    fn portal_of(&self, e: EdgeId) -> Portal {
        let first = self.edge(e).twin().map_or(e, |twin| e.min(twin));
        let at = self.portals.partition_point(|p| p.edges[0] < first);
        self.portals[at]
    }
}

/// `a·x + b·y + c = 0` with integers, not both a and b 0.
struct Through {
    a: i64,
    b: i64,
    c: i64,
}

/// The line through two vertices, if it is one through grid points.
fn through(p: &Vertex, q: &Vertex) -> Option<Through> {
    let wide = |v: &Vertex| [I256::from(v.x()), I256::from(v.y()), I256::from(v.w())];
    let ([px, py, pw], [qx, qy, qw]) = (wide(p), wide(q));
    let [a, b, c] = [py * qw - qy * pw, qx * pw - px * qw, px * qy - qx * py];
    let divisor = gcd(gcd(a.abs(), b.abs()), c.abs());
    if divisor == I256::ZERO {
        return None;
    }
    let fit = |n: I256, bits: u32| {
        let n = n / divisor;
        (n.abs() < I256::from(1i64 << bits)).then(|| n.as_i64())
    };
    Some(Through {
        a: fit(a, SLOPE_BITS)?,
        b: fit(b, SLOPE_BITS)?,
        c: fit(c, OFFSET_BITS)?,
    })
}

fn gcd(mut a: I256, mut b: I256) -> I256 {
    while b != I256::ZERO {
        (a, b) = (b, a % b);
    }
    a
}

impl Through {
    /// The line's point near `p`: on a vertical line of the grid, or on a horizontal one if it is steep.
    fn at(&self, p: DVec2) -> Option<Vertex> {
        let [a, b, c] = [self.a, self.b, self.c].map(i128::from);
        if self.b.abs() >= self.a.abs() {
            let k = p.x.round() as i128;
            Vertex::homogeneous(k * b, -(a * k + c), self.b)
        } else {
            let k = p.y.round() as i128;
            Vertex::homogeneous(-(b * k + c), k * a, self.a)
        }
    }

    /// Whether `p` comes before `q` on the way between two points.
    fn comes_before(&self, way: [DVec2; 2], p: &Vertex, q: &Vertex) -> bool {
        let course = way[1] - way[0];
        let (order, forth) = if self.b.abs() >= self.a.abs() {
            (p.cmp_x(q), course.x > 0.0)
        } else {
            (p.cmp_y(q), course.y > 0.0)
        };
        order
            == if forth {
                std::cmp::Ordering::Less
            } else {
                std::cmp::Ordering::Greater
            }
    }
}
