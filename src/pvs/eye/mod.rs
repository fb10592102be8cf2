//! What one eye sees: the cells, and the exact visible area in each.
//!
//! In: a [`CellGraph`], made ready once as a [`Lookout`]; an eye (an exact point, see
//! [`Grid::fine`](crate::geom::Grid::fine) for the door from f64) and a [`Cone`] of directions. Out:
//! a [`Vista`]. Source: lecture, "Eye-to-Cell Visibility", after Teller & Séquin 1991, without the
//! cull boxes: the portals themselves narrow the cone.
//!
//! A cell is seen when some open range of directions within the cone reaches its inside through
//! portals alone, past no opaque wall. From one point a chain of portals needs no hull: the
//! directions that pass all of them are one wedge between two rays, and a further portal narrows it
//! by one or two orientation tests (as in the PVS's sweep about vertices). Every sign is exact, so
//! the answer does not depend on the subdivision, nor on how far away the level lies.
//!
//! **Where the eye is.** The eye belongs to every cell that touches it: to one inside a cell, to two
//! on a portal, to all around a vertex. It sees what it would see from a little inside each of them;
//! directions along a border are in no open range, so nothing is counted twice. The same holds on
//! an opaque wall: an eye on it sees both sides, in the middle of a wall as at its end. No other
//! rule treats the wall's two sides alike, and none that is stricter would agree with what is seen
//! from ever nearer points. Own cells count as seen even where the cone leads away from them. Hence
//! what is seen is always part of what the eye's cells see together in the exact PVS. An eye that
//! touches no cell is [`Outside`].
//!
//! Memory is kept in a [`Scratch`], so that after the first few looks nothing is allocated.

mod area;
mod cone;
mod walk;

use thiserror::Error;

pub use area::area;
pub use cone::{Cone, ConeError};
pub use walk::Scratch;

use super::flat::FlatMesh;
use crate::cells::{CellGraph, CellId, Locator};
use crate::geom::pencil::{Aim, PackedAim};
use crate::geom::{Pencil, Vertex};

/// The eye touches no cell: it is outside of the level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the eye lies outside of all cells")]
pub struct Outside;

/// A graph made ready for eyes. O(n) to make.
pub struct Lookout<'a> {
    mesh: FlatMesh<'a>,
    locator: Locator,
}

/// Part of a cell: all of it that lies in one wedge of directions. Those of a cell do not overlap. Only
/// its own vista can tell more about it, so it is not to be copied.
#[derive(Debug)]
pub struct Piece {
    /// The cell.
    pub cell: CellId,
    /// The edge through which the wedge's first rays enter the cell; the others do through those
    /// clockwise from it. [`OWN`] in a cell that touches the eye.
    entry: u32,
    wedge: Wedge,
}

/// Stands for the entry of a cell that touches the eye.
const OWN: u32 = u32::MAX;

/// The open range of directions from `low` counterclockwise to `high`.
#[derive(Clone, Copy, Debug)]
struct Wedge {
    low: PackedAim,
    high: PackedAim,
}

/// An edge, as far as a wedge meets it.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    edge: u32,
    wedge: Wedge,
}

/// What an eye sees. Places are in grid steps; [`Grid::offset_to_level`] turns them into the level's
/// own coordinates.
///
/// [`Grid::offset_to_level`]: crate::geom::Grid::offset_to_level
pub struct Vista<'a> {
    mesh: &'a FlatMesh<'a>,
    pencil: Pencil<'a>,
    found: &'a Scratch,
}

impl<'a> Lookout<'a> {
    /// Makes a graph ready.
    pub fn new(graph: &'a CellGraph) -> Self {
        Self {
            mesh: FlatMesh::new(graph),
            locator: Locator::new(graph),
        }
    }

    /// Makes a graph ready, and keeps it.
    pub fn owning(graph: CellGraph) -> Lookout<'static> {
        let locator = Locator::new(&graph);
        let mesh = FlatMesh::owning(graph);
        Lookout { mesh, locator }
    }

    /// The graph.
    pub fn graph(&self) -> &CellGraph {
        &self.mesh.graph
    }

    /// Where its cells are found.
    pub fn locator(&self) -> &Locator {
        &self.locator
    }

    /// What an eye sees within a cone. O(what it sees).
    pub fn look<'s>(
        &'s self,
        eye: &Vertex,
        cone: &Cone,
        scratch: &'s mut Scratch,
    ) -> Result<Vista<'s>, Outside> {
        // Without edges no free direction is asked for.
        let free = cone.edges().unwrap_or([[1, 0]; 2]);
        let pencil = Pencil::new(&self.mesh.graph.vertices, *eye, free);
        let near = self.locator.near(pencil.at());
        scratch.look(&self.mesh, &pencil, near, cone)?;
        Ok(Vista {
            mesh: &self.mesh,
            pencil,
            found: scratch,
        })
    }
}

impl Vista<'_> {
    /// The eye.
    pub fn eye(&self) -> &Vertex {
        self.pencil.point()
    }

    /// The cells that are seen, each once: the eye's own first, then the others as they were met.
    pub fn cells(&self) -> &[CellId] {
        &self.found.seen
    }

    /// Whether a cell is among them. O(1).
    pub fn sees(&self, cell: CellId) -> bool {
        self.found.is_seen(cell)
    }

    /// The cells that touch the eye.
    pub fn own_cells(&self) -> &[CellId] {
        &self.found.seen[..self.found.n_own]
    }

    /// The visible parts of the cells: several of one cell where something stands before it, none
    /// of an own cell from which the cone leads away.
    pub fn pieces(&self) -> &[Piece] {
        &self.found.pieces
    }

    /// The rays between which a piece lies, counterclockwise, less than a half turn from each other
    /// unless the eye touches the piece. `None`: all around the eye.
    pub fn wedge(&self, piece: &Piece) -> Option<[Aim; 2]> {
        let Wedge { low, high } = piece.wedge;
        (low != high).then_some([low.unpack(), high.unpack()])
    }
}
