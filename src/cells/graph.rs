//! The finished product of this stage: cells, their edges, and the portals between them.

mod parts;
mod walled;

use std::ops::Range;

pub use parts::PartsError;

use super::arrangement::Arrangement;
use super::interior::Label;
use super::mesh::Mesh;
use super::tree::Tree;
use super::{Cost, Options};
use crate::geom::{Grid, VertexId, Vertices};
use crate::level::{Finding, Height, Level, SectorId, WallId, WallKind};

/// Index into [`CellGraph::cells`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellId(pub u32);

/// Index into [`CellGraph::edges`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct EdgeId(pub u32);

impl EdgeId {
    /// Stands where an edge has nothing on its other side.
    const NONE: EdgeId = EdgeId(u32::MAX);
}

/// Index into [`CellGraph::portals`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PortalId(pub u32);

/// Convex cells that tile the inside of a level, in the level's grid coordinates.
#[derive(Clone, Debug)]
pub struct CellGraph {
    /// The level's grid.
    pub grid: Grid,
    /// How the cells were made.
    pub options: Options,
    /// Corners of cells and ends of portals, exact.
    pub vertices: Vertices,
    /// The cells.
    pub cells: Vec<Cell>,
    /// The cells' edges: cell after cell, counterclockwise.
    pub edges: Vec<Edge>,
    /// The portals, ordered by their first edge.
    pub portals: Vec<Portal>,
    /// The tree by which the plan was split; triangulations and graphs read from a file have none.
    pub tree: Option<Tree>,
    /// What the subdivision cost.
    pub cost: Cost,
    /// What the arrangement and the labelling found in the level.
    pub findings: Vec<Finding>,
}

/// An open convex part of the plan without a wall inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    first_edge: u32,
    n_edges: u32,
    /// Its sector, if the level has sectors.
    pub sector: Option<SectorId>,
    /// Further sectors that the level's walls name for this ground (a defect), ascending.
    pub also: Vec<SectorId>,
}

/// A straight part of a cell's border: wall or portal from end to end. Neighbouring edges of a cell
/// may lie in line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Where it starts, going counterclockwise around its cell (which lies on its left).
    pub origin: VertexId,
    /// The cell that it bounds.
    pub cell: CellId,
    twin: EdgeId,
    wall: u32,
}

impl Edge {
    /// The same stretch as an edge of the neighbouring cell; `None` for a wall.
    #[inline]
    pub fn twin(&self) -> Option<EdgeId> {
        (self.twin != EdgeId::NONE).then_some(self.twin)
    }

    /// The wall of the level that lies here: the opaque one, or else (on a portal) the opening or
    /// see-through wall. `None` on a portal that only the subdivision made.
    pub fn wall(&self) -> Option<WallId> {
        (self.wall != u32::MAX).then_some(WallId(self.wall))
    }
}

/// A stretch of border through which two cells are open to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portal {
    /// The edges on its two sides; `edges[0] < edges[1]`. Seen from the cell of `edges[i]`, which
    /// lies on its left, the portal's right end is the edge's origin, and its left end the end.
    pub edges: [EdgeId; 2],
    /// Lower end of the opening in z as the level starts; `None` where the level has no heights.
    pub bottom: Option<f64>,
    /// Upper end in z as the level starts. Not above `bottom` where something closes the opening.
    pub top: Option<f64>,
    /// The opening at its widest, with everything that moves moved out of the way.
    pub widest: Option<(f64, f64)>,
}

impl CellGraph {
    /// All cells, ascending.
    pub fn cell_ids(&self) -> impl ExactSizeIterator<Item = CellId> + use<> {
        (0..self.cells.len() as u32).map(CellId)
    }

    /// The cell.
    pub fn cell(&self, id: CellId) -> &Cell {
        &self.cells[id.0 as usize]
    }

    /// The edge.
    #[inline]
    pub fn edge(&self, id: EdgeId) -> &Edge {
        &self.edges[id.0 as usize]
    }

    /// Indices of a cell's edges, counterclockwise.
    #[inline]
    pub fn edge_range(&self, cell: CellId) -> Range<u32> {
        let cell = &self.cells[cell.0 as usize];
        cell.first_edge..cell.first_edge + cell.n_edges
    }

    /// The edge that follows counterclockwise in the same cell.
    #[inline]
    pub fn next(&self, id: EdgeId) -> EdgeId {
        let cell = &self.cells[self.edge(id).cell.0 as usize];
        if id.0 + 1 == cell.first_edge + cell.n_edges {
            EdgeId(cell.first_edge)
        } else {
            EdgeId(id.0 + 1)
        }
    }

    /// The edge before, counterclockwise, in the same cell.
    #[inline]
    pub fn previous(&self, id: EdgeId) -> EdgeId {
        let cell = &self.cells[self.edge(id).cell.0 as usize];
        if id.0 == cell.first_edge {
            EdgeId(cell.first_edge + cell.n_edges - 1)
        } else {
            EdgeId(id.0 - 1)
        }
    }

    /// Where an edge ends.
    #[inline]
    pub fn end(&self, id: EdgeId) -> VertexId {
        self.edge(self.next(id)).origin
    }

    /// A cell's vertices, counterclockwise; some may lie between two others in line.
    pub fn corners(&self, cell: CellId) -> impl Iterator<Item = VertexId> + '_ {
        self.edge_range(cell).map(|e| self.edges[e as usize].origin)
    }

    /// A cell's true corners, counterclockwise: without the vertices that lie between two others.
    pub fn polygon(&self, cell: CellId) -> Vec<VertexId> {
        let corners: Vec<VertexId> = self.corners(cell).collect();
        let n = corners.len();
        (0..n)
            .filter(|&i| {
                let (p, q, r) = (corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]);
                self.vertices.orient(p, q, r) == crate::geom::Side::Left
            })
            .map(|i| corners[i])
            .collect()
    }

    /// The two cells that a portal joins.
    pub fn joined(&self, portal: &Portal) -> [CellId; 2] {
        portal.edges.map(|e| self.edge(e).cell)
    }

    /// The same cells and edges with some portals walled up: of each, either edge is named. Those edges
    /// have no other side any more, and may have no wall of the level.
    pub fn closed(&self, edges: &[EdgeId]) -> CellGraph {
        let mut graph = self.clone();
        for &e in edges {
            if let Some(twin) = self.edge(e).twin() {
                graph.edges[e.0 as usize].twin = EdgeId::NONE;
                graph.edges[twin.0 as usize].twin = EdgeId::NONE;
            }
        }
        let (portals, edges) = (&mut graph.portals, &graph.edges);
        portals.retain(|p| edges[p.edges[0].0 as usize].twin().is_some());
        graph
    }

    /// Number of edges that are walls.
    pub fn n_walls(&self) -> usize {
        self.edges.len() - 2 * self.portals.len()
    }
}

/// Drops the outside, leaves the frame, and finds the portals' openings.
pub(super) fn build(
    level: &Level,
    options: &Options,
    arrangement: &Arrangement,
    mesh: &Mesh,
    labels: Vec<Label>,
    cost: Cost,
    findings: Vec<Finding>,
) -> CellGraph {
    let mirrored = arrangement.frame.mirrors();
    let mut graph = CellGraph {
        grid: level.grid,
        options: *options,
        vertices: Vertices::default(),
        cells: Vec::new(),
        edges: Vec::new(),
        portals: Vec::new(),
        tree: None,
        cost,
        findings,
    };
    // Old edge indices of the kept cells, counterclockwise as seen in the level's coordinates: in a
    // mirrored frame, the other way around.
    let mut kept: Vec<usize> = Vec::new();
    let mut new_index = vec![EdgeId::NONE; mesh.edges.len()];
    for (cell, label) in labels
        .into_iter()
        .enumerate()
        .filter(|(_, label)| label.inside)
    {
        let range = mesh.range(cell);
        graph.cells.push(Cell {
            first_edge: kept.len() as u32,
            n_edges: range.len() as u32,
            sector: label.sector,
            also: label.also,
        });
        let place = |e: usize| {
            new_index[e] = EdgeId(kept.len() as u32);
            kept.push(e);
        };
        if mirrored {
            range.rev().for_each(place)
        } else {
            range.for_each(place)
        }
    }
    let mut renumbered = vec![VertexId(u32::MAX); arrangement.vertices.len()];
    let mut vertices = Vec::new();
    for (cell, id) in graph.cells.iter().zip(0u32..) {
        for i in cell.first_edge..cell.first_edge + cell.n_edges {
            let old = kept[i as usize];
            let edge = &mesh.edges[old];
            let origin = if mirrored { mesh.end(old) } else { edge.origin };
            let number = &mut renumbered[origin.0 as usize];
            if number.0 == u32::MAX {
                *number = VertexId(vertices.len() as u32);
                vertices.push(arrangement.frame.leave(arrangement.vertices.get(origin)));
            }
            let opaque = edge.piece.is_some_and(|p| arrangement.piece(p).opaque);
            let twin = edge.twin.filter(|_| !opaque);
            graph.edges.push(Edge {
                origin: *number,
                cell: CellId(id),
                twin: twin.map_or(EdgeId::NONE, |t| new_index[t as usize]),
                wall: edge
                    .piece
                    .map_or(u32::MAX, |p| wall_on(level, arrangement, p).0),
            });
        }
    }
    graph.vertices = Vertices::new(vertices);
    for i in 0..graph.edges.len() as u32 {
        let (edge, id) = (graph.edges[i as usize], EdgeId(i));
        if let Some(twin) = edge.twin().filter(|&twin| id < twin) {
            let piece = mesh.edges[kept[i as usize]].piece;
            let portal = portal(level, arrangement, &graph, [id, twin], piece);
            graph.portals.push(portal);
        }
    }
    graph
}

/// The wall that stands for a piece: one that stops sight, if any does.
fn wall_on(level: &Level, arrangement: &Arrangement, piece: super::arrangement::PieceId) -> WallId {
    let covers = arrangement.covers(arrangement.piece(piece));
    let rank = |kind: &WallKind| match kind {
        WallKind::Solid => 0,
        WallKind::Opening(_) => 1,
        WallKind::Edge { .. } => 2,
        WallKind::Outline => 3,
    };
    let walls = covers.iter().map(|c| c.wall);
    walls
        .min_by_key(|w| (rank(&level.walls[w.0 as usize].kind), *w))
        .expect("every piece lies on a wall")
}

/// A portal's vertical opening: from the higher floor to the lower ceiling, or the opening's own
/// ends where it has some.
fn portal(
    level: &Level,
    arrangement: &Arrangement,
    graph: &CellGraph,
    edges: [EdgeId; 2],
    piece: Option<super::arrangement::PieceId>,
) -> Portal {
    let sectors = edges.map(|e| {
        let id = graph.cell(graph.edge(e).cell).sector?;
        level.sectors.get(id.0 as usize)
    });
    let [Some(a), Some(b)] = sectors else {
        return Portal {
            edges,
            bottom: None,
            top: None,
            widest: None,
        };
    };
    let mut bottom = a.floor.rest.max(b.floor.rest);
    let mut top = a.ceiling.rest.min(b.ceiling.rest);
    let low = |floor: Height| floor.low;
    let high = |ceiling: Height| ceiling.high;
    let mut widest = (
        low(a.floor).max(low(b.floor)),
        high(a.ceiling).min(high(b.ceiling)),
    );
    let covers = piece.map_or(&[][..], |p| arrangement.covers(arrangement.piece(p)));
    for cover in covers {
        if let WallKind::Opening(opening) = &level.walls[cover.wall.0 as usize].kind {
            if let Some(z) = opening.bottom {
                bottom = bottom.max(z);
                widest.0 = widest.0.max(z);
            }
            if let Some(z) = opening.top {
                top = top.min(z);
                widest.1 = widest.1.min(z);
            }
        }
    }
    Portal {
        edges,
        bottom: Some(bottom),
        top: Some(top),
        widest: Some(widest),
    }
}
