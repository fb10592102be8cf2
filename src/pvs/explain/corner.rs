//! What stands at a vertex, as sight meets it from one side.

use crate::cells::{CellGraph, EdgeId};
use crate::geom::{Side, VertexId};

/// What stands at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Corner {
    /// The end of a wall, or a corner that juts into the room: sight can be blocked by it alone.
    Jutting,
    /// A wall runs straight through, or the corner is one of a room: only what lies at both of its
    /// sides blocks sight.
    Flat,
    /// No wall: a corner of cells that only the subdivision made, or the end of a see-through line.
    Open,
}

/// What stands at the vertex in which `base` starts, seen from the cell of `base`.
pub fn corner_at(graph: &CellGraph, base: EdgeId) -> Corner {
    let vertex = graph.edge(base).origin;
    // Clockwise to the wall, …
    let mut first = base;
    while let Some(twin) = graph.edge(first).twin() {
        first = graph.next(twin);
        if first == base {
            return Corner::Open;
        }
    }
    // … and counterclockwise to the next.
    let mut last = base;
    while let Some(twin) = graph.edge(graph.previous(last)).twin() {
        last = twin;
    }
    let (from, to) = (graph.end(first), graph.edge(graph.previous(last)).origin);
    match graph.vertices.orient(vertex, from, to) {
        Side::Right => Corner::Jutting,
        Side::On if graph.vertices.same_direction(vertex, from, to) => Corner::Jutting,
        Side::On | Side::Left => Corner::Flat,
    }
}

/// What stands at the two ends of a portal: `[left, right]` for somebody who leaves the edge's cell
/// through it.
pub fn corners_of(graph: &CellGraph, edge: EdgeId) -> [Corner; 2] {
    [corner_at(graph, graph.next(edge)), corner_at(graph, edge)]
}

/// The edges that start in a vertex, ascending. O(edges).
pub fn edges_at(graph: &CellGraph, vertex: VertexId) -> Vec<EdgeId> {
    (0..graph.edges.len() as u32)
        .map(EdgeId)
        .filter(|&e| graph.edge(e).origin == vertex)
        .collect()
}
