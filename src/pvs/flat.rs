//! A graph's edges as walks through cells need them: everything about one edge in one place.

use std::borrow::Cow;

use crate::cells::{CellGraph, EdgeId};
use crate::geom::Placed;

/// The edges of a [`CellGraph`], with the same indices.
pub(super) struct FlatMesh<'a> {
    pub graph: Cow<'a, CellGraph>,
    pub edges: Vec<FlatEdge>,
}

/// An edge; it starts where the one before it in the cell ends.
#[derive(Clone, Copy)]
pub(super) struct FlatEdge {
    /// Where it ends, going counterclockwise.
    pub end: Placed,
    /// The same stretch in the neighbouring cell; [`WALL`] if there is none.
    pub twin: u32,
    /// The edge's own cell, and where its edges start and end.
    pub cell: u32,
    pub first: u32,
    pub past: u32,
}

/// Stands for the twin of an edge that is a wall.
pub(super) const WALL: u32 = u32::MAX;

impl FlatEdge {
    /// The edge that follows edge `e` of this edge's cell.
    #[inline]
    pub fn next(&self, e: u32) -> u32 {
        if e + 1 == self.past {
            self.first
        } else {
            e + 1
        }
    }
}

impl<'a> FlatMesh<'a> {
    pub fn new(graph: &'a CellGraph) -> Self {
        let edges = flat(graph);
        let graph = Cow::Borrowed(graph);
        Self { graph, edges }
    }

    /// Of a graph that is kept inside.
    pub fn owning(graph: CellGraph) -> FlatMesh<'static> {
        let edges = flat(&graph);
        let graph = Cow::Owned(graph);
        FlatMesh { graph, edges }
    }

    #[inline]
    pub fn edge(&self, e: u32) -> &FlatEdge {
        &self.edges[e as usize]
    }
}

fn flat(graph: &CellGraph) -> Vec<FlatEdge> {
    let edge = |i: u32| {
        let edge = graph.edge(EdgeId(i));
        let range = graph.edge_range(edge.cell);
        FlatEdge {
            end: graph.vertices.placed(graph.end(EdgeId(i))),
            twin: edge.twin().map_or(WALL, |t| t.0),
            cell: edge.cell.0,
            first: range.start,
            past: range.end,
        }
    };
    (0..graph.edges.len() as u32).map(edge).collect()
}
