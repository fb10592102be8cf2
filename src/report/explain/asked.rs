//! From a point that somebody gave to the cell that it lies in.

use thiserror::Error;

use super::Asked;
use super::text;
use crate::cells::{CellGraph, CellId, EdgeId, Locator};
use crate::geom::{GridPoint, Side, Vertex, orient};
use crate::level::{Level, Place};
use crate::pvs::Pvs;

/// Why a point has no cell.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AskError {
    /// It lies outside.
    #[error(
        "the point {0},{1} lies outside {2}; `enfilade plan` shows where its inside is",
        point[0], point[1], level
    )]
    Outside {
        /// The point.
        point: [f64; 2],
        /// The level's name.
        level: String,
    },
    /// It lies on a wall.
    #[error(
        "the point {0},{1} lies on a wall ({2}); move it to the side that is meant",
        point[0], point[1], text::place(wall)
    )]
    OnWall {
        /// The point.
        point: [f64; 2],
        /// The wall's place in the source.
        wall: Place,
    },
}

/// The cells that a point may stand for: one, or the several on whose common border it lies.
pub fn cells_at(
    level: &Level,
    graph: &CellGraph,
    locator: &Locator,
    point: GridPoint,
) -> Result<Vec<CellId>, AskError> {
    let at = graph.grid.to_level(point).to_array();
    let vertex = Vertex::from(point);
    let cells = locator.cells_at(graph, &vertex);
    let lies_on = |e: &EdgeId| {
        let [p, q] = [graph.edge(*e).origin, graph.end(*e)].map(|v| graph.vertices.exact(v));
        let beyond = p.cmp_x(&vertex) == q.cmp_x(&vertex) && p.cmp_y(&vertex) == q.cmp_y(&vertex);
        orient(p, q, &vertex) == Side::On && !beyond
    };
    let edges = cells
        .iter()
        .flat_map(|&cell| graph.edge_range(cell).map(EdgeId));
    let mut walls = edges.filter(|&e| graph.edge(e).twin().is_none());
    if let Some(edge) = walls.find(lies_on)
        && let Some(wall) = graph.edge(edge).wall()
    {
        return Err(AskError::OnWall {
            point: at,
            wall: level.walls[wall.0 as usize].place,
        });
    }
    if cells.is_empty() {
        return Err(AskError::Outside {
            point: at,
            level: level.name.clone(),
        });
    }
    Ok(cells)
}

/// Of the cells that two places may stand for, two that see each other, if any do.
pub fn choose(pvs: &Pvs, from: &[CellId], to: &[CellId]) -> Option<[CellId; 2]> {
    let pairs = || from.iter().flat_map(|&a| to.iter().map(move |&b| [a, b]));
    let seeing = pairs().find(|&[a, b]| pvs.sees(a, b));
    seeing.or_else(|| pairs().next())
}

impl Asked {
    /// A place in a cell, with the point that it was given by.
    pub fn new(cell: CellId, point: Option<GridPoint>, candidates: &[CellId]) -> Self {
        let other = |c: &&CellId| **c != cell;
        Self {
            cell,
            point,
            beside: candidates.iter().find(other).copied(),
        }
    }
}
