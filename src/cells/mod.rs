//! From a [`Level`] to a [`CellGraph`]: convex cells that tile the inside, and the portals between.
//!
//! [`arrangement`] cuts the walls where they meet; [`bsp`], [`kd`] or [`cdt`] subdivides the plan;
//! [`mesh`] joins the parts edge to edge; [`interior`] drops the outside; the result goes back into
//! the level's own coordinates. Every vertex is exact, and no step compares with a tolerance.

pub mod arrangement;
pub mod bsp;
pub mod cdt;
pub mod findings;
pub mod frame;
mod graph;
pub mod guide;
pub mod interior;
pub mod kd;
pub mod locate;
pub mod mesh;
pub mod partition;
pub mod tree;
mod validate;

pub use graph::{Cell, CellGraph, CellId, Edge, EdgeId, PartsError, Portal, PortalId};
pub use locate::Locator;
pub use tree::Tree;
pub use validate::Flaw;

use self::arrangement::Arrangement;
use self::mesh::Mesh;
use self::partition::{Choose, Partition};
use crate::level::Level;

/// How the plan is cut into cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Subdivision {
    /// By the lines of the walls.
    #[default]
    Bsp,
    /// By axis-aligned lines through wall ends, then by the walls.
    Kd,
    /// Into the triangles of a constrained Delaunay triangulation.
    Cdt,
}

impl Subdivision {
    /// All of them, in the order in which they are compared.
    pub const ALL: [Subdivision; 3] = [Subdivision::Bsp, Subdivision::Kd, Subdivision::Cdt];

    /// The name on the command line and in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Subdivision::Bsp => "bsp",
            Subdivision::Kd => "kd",
            Subdivision::Cdt => "cdt",
        }
    }
}

/// Whether doors that stand closed count as walls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Doors {
    /// Every door may be open: nothing that moves stops sight.
    #[default]
    Open,
    /// A door that stands closed is a wall.
    Closed,
}

impl Doors {
    /// The name on the command line and in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Doors::Open => "open",
            Doors::Closed => "closed",
        }
    }
}

/// Options of [`subdivide`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Which subdivision.
    pub subdivision: Subdivision,
    /// What closed doors are.
    pub doors: Doors,
    /// Options of the BSP's rule.
    pub bsp: bsp::BspOptions,
    /// Options of the kd-tree's rule.
    pub kd: kd::KdOptions,
}

/// What a subdivision cost, for comparing them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Pieces that the walls were cut into where they meet.
    pub pieces: usize,
    /// How often a splitting line cut a piece in two.
    pub wall_splits: usize,
    /// Depth of the tree; 0 for triangles.
    pub depth: usize,
    /// Whether rounding forced the triangulation to fall back on the leaves of a BSP.
    pub fallback: bool,
}

/// Subdivides a level. Never fails: whatever is wrong with the level is in the graph's findings.
pub fn subdivide(level: &Level, options: &Options) -> CellGraph {
    let mut arrangement = arrangement::arrange(level, options.doors);
    let mut cost = Cost {
        pieces: arrangement.pieces.len(),
        ..Cost::default()
    };
    let by_walls: &mut Choose = &mut |a, fragments| bsp::choose(a, fragments, &options.bsp);
    let by_axes: &mut Choose = &mut |a, fragments| kd::choose(a, fragments, &options.kd);
    let (mesh, partition) = match options.subdivision {
        Subdivision::Bsp => split(&mut arrangement, by_walls, &mut cost),
        Subdivision::Kd => split(&mut arrangement, by_axes, &mut cost),
        Subdivision::Cdt => match cdt::triangulate(&arrangement) {
            Some(mesh) => (mesh, None),
            None => {
                cost.fallback = true;
                let (mesh, _) = split(&mut arrangement, by_walls, &mut cost);
                (cdt::triangulate_cells(&arrangement, &mesh), None)
            }
        },
    };
    let (mut graph, inside) = finish(level, options, &arrangement, &mesh, cost);
    graph.tree = partition.map(|partition| {
        let (mut cells, mut n) = (Vec::new(), 0);
        for inside in inside {
            cells.push(inside.then_some(CellId(n)));
            n += u32::from(inside);
        }
        let line = |id| *arrangement.lines.get(id);
        tree::Tree::of(&partition, line, &arrangement.frame, |leaf| {
            cells[leaf as usize]
        })
    });
    graph
}

/// The graph of a mesh, still without a tree; and which of the mesh's cells are in it.
fn finish(
    level: &Level,
    options: &Options,
    arrangement: &Arrangement,
    mesh: &Mesh,
    cost: Cost,
) -> (CellGraph, Vec<bool>) {
    let (labels, mut findings) = interior::label(level, arrangement, mesh);
    findings.splice(0..0, findings::of_meetings(level, arrangement));
    let inside = labels.iter().map(|label| label.inside).collect();
    let graph = graph::build(level, options, arrangement, mesh, labels, cost, findings);
    (graph, inside)
}

/// Subdivides by the lines that `choose` names.
fn split(
    arrangement: &mut Arrangement,
    choose: &mut Choose,
    cost: &mut Cost,
) -> (Mesh, Option<Partition>) {
    let partition = partition::partition(arrangement, choose);
    cost.wall_splits = partition.splits;
    cost.depth = partition.depth;
    let mesh = mesh::join_leaves(arrangement, &partition);
    (mesh, Some(partition))
}
