//! A [`CellGraph`] from its parts, as a file gives them back.

use std::fmt;

use super::{Cell, CellGraph, CellId, Edge, EdgeId, Portal};
use crate::cells::{Cost, Options};
use crate::geom::{Grid, Vertex, VertexId, Vertices};
use crate::level::{SectorId, WallId};

/// Why parts do not make a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartsError {
    /// What sort of part it is: "cell", "edge", "portal".
    pub part: &'static str,
    /// Its number.
    pub index: usize,
    /// What is wrong with it.
    pub what: &'static str,
}

impl fmt::Display for PartsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.part, self.index, self.what)
    }
}

impl std::error::Error for PartsError {}

impl Cell {
    /// A cell whose edges are the `n_edges` from number `first_edge` on.
    pub fn new(
        first_edge: u32,
        n_edges: u32,
        sector: Option<SectorId>,
        also: Vec<SectorId>,
    ) -> Self {
        Self {
            first_edge,
            n_edges,
            sector,
            also,
        }
    }

    /// Number of its edges.
    pub fn n_edges(&self) -> u32 {
        self.n_edges
    }
}

impl Edge {
    /// An edge; `twin` and `wall` as their namesakes return them.
    pub fn new(origin: VertexId, cell: CellId, twin: Option<EdgeId>, wall: Option<WallId>) -> Self {
        Self {
            origin,
            cell,
            twin: twin.unwrap_or(EdgeId::NONE),
            wall: wall.map_or(u32::MAX, |w| w.0),
        }
    }
}

impl CellGraph {
    /// A graph of these parts, without findings, if all their indices are in range and agree with
    /// each other: the cells' edges follow each other without gap, at least three to a cell; every
    /// edge names the cell that holds it; twins are mutual, of different cells, and each pair has
    /// exactly one portal, in the order of the portals' first edges.
    ///
    /// Whether the cells are convex and fit together is not asked: see [`CellGraph::validate`].
    ///
    /// # Errors
    /// The first part that is wrong.
    pub fn from_parts(
        grid: Grid,
        options: Options,
        vertices: Vec<Vertex>,
        cells: Vec<Cell>,
        edges: Vec<Edge>,
        portals: Vec<Portal>,
        cost: Cost,
    ) -> Result<Self, PartsError> {
        check_cells(&cells, &edges)?;
        check_edges(vertices.len(), &edges)?;
        check_portals(&edges, &portals)?;
        let vertices = Vertices::new(vertices);
        Ok(Self {
            grid,
            options,
            vertices,
            cells,
            edges,
            portals,
            tree: None,
            cost,
            findings: Vec::new(),
        })
    }
}

fn check_cells(cells: &[Cell], edges: &[Edge]) -> Result<(), PartsError> {
    let mut next = 0usize;
    for (index, cell) in cells.iter().enumerate() {
        let wrong = |what| {
            Err(PartsError {
                part: "cell",
                index,
                what,
            })
        };
        if cell.n_edges < 3 {
            return wrong("has fewer than three edges");
        }
        if cell.first_edge as usize != next {
            return wrong("does not begin where the one before it ends");
        }
        next += cell.n_edges as usize;
        let Some(own) = edges.get(cell.first_edge as usize..next) else {
            return wrong("has edges that do not exist");
        };
        if own.iter().any(|e| e.cell.0 as usize != index) {
            return wrong("has an edge that names another cell");
        }
    }
    if next != edges.len() {
        let what = "is followed by edges without a cell";
        return Err(PartsError {
            part: "cell",
            index: cells.len().saturating_sub(1),
            what,
        });
    }
    Ok(())
}

fn check_edges(n_vertices: usize, edges: &[Edge]) -> Result<(), PartsError> {
    for (index, edge) in edges.iter().enumerate() {
        let wrong = |what| {
            Err(PartsError {
                part: "edge",
                index,
                what,
            })
        };
        if edge.origin.0 as usize >= n_vertices {
            return wrong("starts at a vertex that does not exist");
        }
        if let Some(twin) = edge.twin() {
            let Some(other) = edges.get(twin.0 as usize) else {
                return wrong("has a twin that does not exist");
            };
            if other.twin().is_none_or(|t| t.0 as usize != index) || other.cell == edge.cell {
                return wrong("is not its twin's twin");
            }
        }
    }
    Ok(())
}

fn check_portals(edges: &[Edge], portals: &[Portal]) -> Result<(), PartsError> {
    // The portals in their order are the pairs of twins in the order of their first edges.
    let mut expected = (0u32..).zip(edges).filter_map(|(i, edge)| {
        let twin = edge.twin()?;
        (i < twin.0).then_some([EdgeId(i), twin])
    });
    for (index, portal) in portals.iter().enumerate() {
        if expected.next() != Some(portal.edges) {
            let what = "does not join the next pair of twin edges";
            return Err(PartsError {
                part: "portal",
                index,
                what,
            });
        }
    }
    if expected.next().is_some() {
        let what = "is missing: a pair of twin edges has none";
        return Err(PartsError {
            part: "portal",
            index: portals.len(),
            what,
        });
    }
    Ok(())
}
