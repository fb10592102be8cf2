//! Point location: which cell holds a point.

use super::{CellGraph, CellId, EdgeId};
use crate::geom::{GridPoint, Side, Vertex, orient};

/// Whether a convex counterclockwise polygon holds the point, its border included.
pub fn contains(corners: &[&Vertex], point: &Vertex) -> bool {
    (0..corners.len())
        .all(|i| orient(corners[i], corners[(i + 1) % corners.len()], point) != Side::Right)
}

/// Buckets over the cells' extents, for many point locations. A query looks at the few cells whose
/// extent meets the point's bucket, and decides exactly.
pub struct Locator {
    low: [f64; 2],
    /// Buckets per grid step.
    scale: [f64; 2],
    size: [usize; 2],
    buckets: Vec<Vec<CellId>>,
}

impl Locator {
    /// Buckets for all cells of a graph, about one per cell. O(n).
    pub fn new(graph: &CellGraph) -> Self {
        let points = graph.vertices.iter().map(Vertex::approx);
        let (low, high) = points.fold(
            (glam::DVec2::splat(f64::MAX), glam::DVec2::splat(f64::MIN)),
            |(low, high), p| (low.min(p), high.max(p)),
        );
        let side = (graph.cells.len() as f64).sqrt().ceil().max(1.0) as usize;
        let extent = (high - low).max(glam::DVec2::ONE);
        let mut locator = Locator {
            low: low.to_array(),
            scale: [side as f64 / extent.x, side as f64 / extent.y],
            size: [side, side],
            buckets: vec![Vec::new(); side * side],
        };
        // A corner's copy and a point's are each off by less than 2^-51 of the largest coordinate.
        let slack = graph.vertices.reach() * 2f64.powi(-50);
        for cell in graph.cell_ids() {
            let mut low = [usize::MAX; 2];
            let mut high = [0usize; 2];
            for v in graph.corners(cell) {
                let p = graph.vertices.approx(v).to_array();
                for axis in 0..2 {
                    low[axis] = low[axis].min(locator.bucket(axis, p[axis] - slack));
                    high[axis] = high[axis].max(locator.bucket(axis, p[axis] + slack));
                }
            }
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    locator.buckets[y * side + x].push(cell);
                }
            }
        }
        locator
    }

    fn bucket(&self, axis: usize, at: f64) -> usize {
        let i = ((at - self.low[axis]) * self.scale[axis]).floor();
        (i.max(0.0) as usize).min(self.size[axis] - 1)
    }

    /// All cells that may hold a point with these approximate coordinates.
    pub fn near(&self, p: glam::DVec2) -> &[CellId] {
        let bucket = self.bucket(1, p.y) * self.size[0] + self.bucket(0, p.x);
        &self.buckets[bucket]
    }

    /// The cells that hold the point, border included, ascending: one inside a cell, two on a
    /// portal, none outside.
    pub fn cells_at(&self, graph: &CellGraph, point: &Vertex) -> Vec<CellId> {
        self.holding(graph, point).collect()
    }

    /// The first of [`Locator::cells_at`] for a grid point.
    pub fn cell_at(&self, graph: &CellGraph, point: GridPoint) -> Option<CellId> {
        self.first_at(graph, &point.into())
    }

    /// The first of [`Locator::cells_at`], found without allocating.
    pub fn first_at(&self, graph: &CellGraph, point: &Vertex) -> Option<CellId> {
        self.holding(graph, point).next()
    }

    fn holding(&self, graph: &CellGraph, point: &Vertex) -> impl Iterator<Item = CellId> {
        let corner = |e| graph.vertices.exact(graph.edge(EdgeId(e)).origin);
        let holds = move |cell: &CellId| {
            let range = graph.edge_range(*cell);
            let mut from = corner(range.end - 1);
            range.map(corner).all(|to| {
                let side = orient(from, to, point);
                from = to;
                side != Side::Right
            })
        };
        let near = self.near(point.approx()).iter().copied();
        near.filter(holds)
    }
}
