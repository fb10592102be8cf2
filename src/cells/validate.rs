//! What must hold for every cell graph; used by tests and by `verify`.

use std::fmt;

use super::{CellGraph, CellId, EdgeId};
use crate::geom::{Side, VertexId};

/// A broken invariant.
#[derive(Clone, Debug, PartialEq)]
pub enum Flaw {
    /// A cell does not turn left at a vertex, or has no area.
    NotConvex(CellId),
    /// A portal's two edges do not run between the same two vertices in opposite directions.
    Unpaired(EdgeId),
    /// Around a vertex, two cells cover the same ground.
    Overlap(VertexId),
    /// The cells' total area differs from that inside their common border, in square grid steps.
    Area {
        /// Sum over the cells.
        cells: f64,
        /// Enclosed by the edges that are walls.
        border: f64,
    },
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Flaw::NotConvex(cell) => write!(f, "cell {} is not convex", cell.0),
            Flaw::Unpaired(edge) => write!(f, "edge {} does not match its twin", edge.0),
            Flaw::Overlap(v) => write!(f, "cells overlap around vertex {}", v.0),
            Flaw::Area { cells, border } => {
                write!(
                    f,
                    "the cells cover {cells} square steps, their border encloses {border}"
                )
            }
        }
    }
}

impl CellGraph {
    /// Checks, exactly, that cells are convex and counterclockwise, that portals pair up, and that
    /// around every vertex the cells' angles follow each other without overlap. Together these mean
    /// that cells do not overlap where they meet; that no cell lies over a distant one follows from
    /// the border not crossing itself, which the arrangement guarantees. The area is compared in
    /// f64, to a relative 1e-9.
    pub fn validate(&self) -> Result<(), Flaw> {
        for cell in self.cell_ids() {
            self.validate_cell(cell)?;
        }
        for (i, edge) in self.edges.iter().enumerate() {
            let id = EdgeId(i as u32);
            if let Some(twin) = edge.twin() {
                let paired = self.edge(twin).twin() == Some(id)
                    && self.edge(twin).origin == self.end(id)
                    && self.end(twin) == edge.origin;
                if !paired {
                    return Err(Flaw::Unpaired(id));
                }
            }
        }
        self.validate_vertices()?;
        self.validate_area()
    }

    fn validate_cell(&self, cell: CellId) -> Result<(), Flaw> {
        let corners: Vec<VertexId> = self.corners(cell).collect();
        let n = corners.len();
        let turn = |i: usize| {
            self.vertices
                .orient(corners[i], corners[(i + 1) % n], corners[(i + 2) % n])
        };
        let lefts = (0..n).filter(|&i| turn(i) == Side::Left).count();
        let rights = (0..n).filter(|&i| turn(i) == Side::Right).count();
        // Turning left everywhere, once around: every corner is left of (or on) the first edges.
        let once =
            (1..n).all(|i| self.vertices.orient(corners[0], corners[1], corners[i]) != Side::Right);
        if lefts < 3 || rights > 0 || !once {
            return Err(Flaw::NotConvex(cell));
        }
        Ok(())
    }

    /// Around each vertex: no edge of one cell points into the inside of another cell's angle.
    fn validate_vertices(&self) -> Result<(), Flaw> {
        let mut at: Vec<Vec<EdgeId>> = vec![Vec::new(); self.vertices.len()];
        for (i, edge) in self.edges.iter().enumerate() {
            at[edge.origin.0 as usize].push(EdgeId(i as u32));
        }
        for (v, edges) in at.iter().enumerate() {
            let v = VertexId(v as u32);
            for &e in edges {
                let (first, last) = (self.end(e), self.edge(self.previous(e)).origin);
                for &other in edges.iter().filter(|&&other| other != e) {
                    for p in [self.end(other), self.edge(self.previous(other)).origin] {
                        let inside = self.vertices.orient(v, first, p) == Side::Left
                            && self.vertices.orient(v, p, last) == Side::Left;
                        if inside {
                            return Err(Flaw::Overlap(v));
                        }
                    }
                    let same = self.vertices.orient(v, first, self.end(other)) == Side::On
                        && self.vertices.same_direction(v, first, self.end(other));
                    if same {
                        return Err(Flaw::Overlap(v));
                    }
                }
            }
        }
        Ok(())
    }

    fn validate_area(&self) -> Result<(), Flaw> {
        let twice = |e: EdgeId| {
            let (p, q) = (
                self.vertices.approx(self.edge(e).origin),
                self.vertices.approx(self.end(e)),
            );
            p.perp_dot(q)
        };
        let ids = || (0..self.edges.len() as u32).map(EdgeId);
        let cells = self.cell_ids().map(|c| self.area(c)).sum::<f64>();
        let border = ids()
            .filter(|&e| self.edge(e).twin().is_none())
            .map(twice)
            .sum::<f64>()
            / 2.0;
        let scale = ids().map(|e| twice(e).abs()).sum::<f64>();
        if (cells - border).abs() > 1e-9 * scale {
            return Err(Flaw::Area { cells, border });
        }
        Ok(())
    }

    /// A cell's area in square grid steps, in f64.
    pub fn area(&self, cell: CellId) -> f64 {
        let corners: Vec<_> = self
            .corners(cell)
            .map(|v| self.vertices.approx(v))
            .collect();
        let origin = corners[0];
        let fan = corners.windows(2).skip(1);
        fan.map(|w| (w[0] - origin).perp_dot(w[1] - origin))
            .sum::<f64>()
            / 2.0
    }
}
