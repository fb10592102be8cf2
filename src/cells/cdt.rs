//! Cells by constrained Delaunay triangulation (spade) of the arrangement.
//!
//! spade works on f64 points, which hold grid points exactly; only where walls cross between grid
//! points is a corner rounded for it. So its triangles are a proposal: each is checked by the exact
//! predicate, flat or inverted ones are mended by flipping, and if any is left, the triangles are
//! those of the leaves of a BSP instead. What comes out tiles the plan exactly.

use rustc_hash::{FxHashMap, FxHashSet};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation as _};

use super::arrangement::{Arrangement, PieceId};
use super::mesh::{HalfEdge, Mesh, PieceBetween, join_polygons};
use crate::geom::{Side, VertexId, orient};

/// A vertex as spade sees it: rounded.
struct Site {
    at: Point2<f64>,
    vertex: VertexId,
}

impl HasPosition for Site {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

/// Triangles between the arrangement's vertices in which every piece of wall is an edge, as a mesh;
/// `None` where rounding gave spade a plan that cannot be mended (see the module).
pub fn triangulate(arrangement: &Arrangement) -> Option<Mesh> {
    let n = arrangement.vertices.len();
    let sites = (0..n as u32)
        .map(|i| {
            let p = arrangement.vertices.get(VertexId(i)).approx();
            Site {
                at: Point2::new(p.x, p.y),
                vertex: VertexId(i),
            }
        })
        .collect();
    // First all points, then the walls, in this order: loading both at once would let spade walk
    // through hash sets with a random seed, and give other triangles in another run.
    let mut triangulation = ConstrainedDelaunayTriangulation::<Site>::bulk_load(sites).ok()?;
    // Rounding may make two vertices one.
    if triangulation.num_vertices() != n {
        return None;
    }
    let mut handles = vec![None; n];
    for site in triangulation.vertices() {
        handles[site.data().vertex.0 as usize] = Some(site.fix());
    }
    for piece in &arrangement.pieces {
        let (from, to) = (
            handles[piece.from.0 as usize]?,
            handles[piece.to.0 as usize]?,
        );
        if triangulation.try_add_constraint(from, to).is_empty() {
            return None;
        }
    }
    let mut triangles: Vec<[VertexId; 3]> = triangulation
        .inner_faces()
        .map(|face| face.vertices().map(|v| v.data().vertex))
        .collect();
    mend(arrangement, &mut triangles).then(|| {
        let pieces: PieceBetween = (0u32..)
            .zip(&arrangement.pieces)
            .map(|(i, p)| ((p.from, p.to), PieceId(i)))
            .collect();
        order_by_place(arrangement, &mut triangles);
        let polygons: Vec<_> = triangles.iter().map(|t| t.to_vec()).collect();
        join_polygons(&pieces, &polygons)
    })
}

/// Sorts triangles along a Hilbert curve, so that cells near each other have numbers near each other:
/// later stages then find them in the cache, and in the same words of a bit row.
fn order_by_place(arrangement: &Arrangement, triangles: &mut [[VertexId; 3]]) {
    let point = |v: VertexId| arrangement.vertices.get(v).approx();
    triangles.sort_by_cached_key(|t| {
        let middle = t.iter().map(|&v| point(v)).sum::<glam::DVec2>() / 3.0;
        // The frame centres the level, so coordinates are within ±2^25: 26 bits when positive.
        let bit = |n: f64| (n + (1u32 << 25) as f64).max(0.0) as u32;
        (hilbert_index(bit(middle.x), bit(middle.y)), *t)
    });
}

/// Position of a point with coordinates below 2^26 along the Hilbert curve.
fn hilbert_index(mut x: u32, mut y: u32) -> u64 {
    let mut index = 0;
    for level in (0..26).rev() {
        let (right, upper) = (x >> level & 1, y >> level & 1);
        index = index << 2 | u64::from((3 * right) ^ upper);
        if upper == 0 {
            let mask = (1 << level) - 1;
            if right == 1 {
                (x, y) = (!x & mask, !y & mask);
            }
            (x, y) = (y & mask, x & mask);
        }
    }
    index
}

/// Flips the long edge of each flat or inverted triangle away; false if some remain. Flat triangles
/// on the rim are dropped.
fn mend(arrangement: &Arrangement, triangles: &mut Vec<[VertexId; 3]>) -> bool {
    let side = |t: &[VertexId; 3]| {
        let [p, q, r] = t.map(|v| arrangement.vertices.get(v));
        orient(p, q, r)
    };
    let mut bad: Vec<usize> = (0..triangles.len())
        .filter(|&i| side(&triangles[i]) != Side::Left)
        .collect();
    if bad.is_empty() {
        return true;
    }
    let walls: FxHashSet<(VertexId, VertexId)> = arrangement
        .pieces
        .iter()
        .map(|p| (p.from.min(p.to), p.from.max(p.to)))
        .collect();
    let mut edge_of: FxHashMap<(VertexId, VertexId), usize> = FxHashMap::default();
    for (i, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            edge_of.insert((t[k], t[(k + 1) % 3]), i);
        }
    }
    let mut dropped = vec![false; triangles.len()];
    // Each flip takes a vertex off an edge it lies on; a plan that needs more is not worth mending.
    for _ in 0..bad.len() * 8 {
        let Some(i) = bad.pop() else { break };
        if dropped[i] || side(&triangles[i]) == Side::Left {
            continue;
        }
        let t = triangles[i];
        let Some(k) =
            (0..3).find(|&k| is_between(arrangement, t[k], t[(k + 1) % 3], t[(k + 2) % 3]))
        else {
            return false;
        };
        // t[k] lies between the ends of the edge p → q.
        let (middle, p, q) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
        let Some(&j) = edge_of.get(&(q, p)) else {
            dropped[i] = true;
            for k in 0..3 {
                edge_of.remove(&(t[k], t[(k + 1) % 3]));
            }
            continue;
        };
        if walls.contains(&(p.min(q), p.max(q))) {
            return false;
        }
        let apex = *triangles[j].iter().find(|&&v| v != p && v != q).unwrap();
        triangles[i] = [middle, p, apex];
        triangles[j] = [middle, apex, q];
        edge_of.remove(&(p, q));
        edge_of.remove(&(q, p));
        for n in [i, j] {
            let t = triangles[n];
            for k in 0..3 {
                edge_of.insert((t[k], t[(k + 1) % 3]), n);
            }
        }
        bad.extend([i, j]);
    }
    let mut dropped = dropped.iter();
    triangles.retain(|_| !dropped.next().unwrap());
    triangles.iter().all(|t| side(t) == Side::Left)
}

/// Whether `v` lies between `p` and `q`, judged by the dot product's sign on rounded coordinates:
/// only a guess which edge to flip; the result is checked exactly.
fn is_between(arrangement: &Arrangement, v: VertexId, p: VertexId, q: VertexId) -> bool {
    let [v, p, q] = [v, p, q].map(|v| arrangement.vertices.get(v).approx());
    (p - v).dot(q - v) < 0.0
}

/// The triangles of already convex cells: a fan from the first corner of each at which no other
/// corner is in line, and around an inner fan where neighbours meet in the middle of edges.
pub fn triangulate_cells(arrangement: &Arrangement, mesh: &Mesh) -> Mesh {
    let mut triangles = Vec::new();
    for cell in 0..mesh.n_cells() {
        let mut rest: Vec<VertexId> = mesh.edges[mesh.range(cell)]
            .iter()
            .map(|e| e.origin)
            .collect();
        // Cut off one true corner after the other; what is left stays convex, with all its points.
        while rest.len() > 3 {
            let n = rest.len();
            let turn = |i: usize| {
                let [p, q, r] =
                    [(i + n - 1) % n, i, (i + 1) % n].map(|i| arrangement.vertices.get(rest[i]));
                orient(p, q, r) == Side::Left
            };
            // Cutting off corner i is allowed if that does not leave the rest on one line, which
            // happens only if all others are: then a corner next to the flat run is cut instead.
            let i = (0..n)
                .find(|&i| turn(i) && spans_area(arrangement, &rest, i))
                .expect("a convex polygon has a corner to cut");
            triangles.push(vec![rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]]);
            rest.remove(i);
        }
        triangles.push(rest);
    }
    // The BSP has split pieces of wall further: take the stretches as they are in the mesh.
    let stretch = |(e, edge): (usize, &HalfEdge)| {
        let (from, to) = (edge.origin, mesh.end(e));
        Some((
            if edge.left_of_piece {
                (from, to)
            } else {
                (to, from)
            },
            edge.piece?,
        ))
    };
    let pieces: PieceBetween = mesh.edges.iter().enumerate().filter_map(stretch).collect();
    join_polygons(&pieces, &triangles)
}

/// Whether the polygon without corner `i` has area.
fn spans_area(arrangement: &Arrangement, polygon: &[VertexId], i: usize) -> bool {
    let others: Vec<_> = (0..polygon.len())
        .filter(|&k| k != i)
        .map(|k| arrangement.vertices.get(polygon[k]))
        .collect();
    others
        .windows(3)
        .any(|w| orient(w[0], w[1], w[2]) != Side::On)
}
