//! Which subsectors of GL nodes see which; and the GL_PVS lump of Doom maps.
//!
//! In: a map's [`Level`] and its [`GlNodes`]. Out: cells that each lie in one leaf of the nodes' tree
//! ([`cells::guide`](crate::cells::guide)), the subsectors that each cell counts for, and from the
//! cells' visible sets the relation between subsectors. A subsector sees another if any cell of the
//! one sees any cell of the other.
//!
//! A subsector is the place to which the tree leads, exactly. But node builders round and compare
//! loosely (glbsp: to a 64th of a unit): a wall that all but lies on a partition line may have been given to the
//! subsector beyond that line. So that such a wall is drawn wherever it is seen, the cell in front of
//! it counts for both: for the leaf in which it lies, and for the subsector whose seg the wall is. Where
//! the builder was right, as nearly everywhere, that is the same. The corners that builders round, to
//! 2^-16 units, count for nothing here.

use glam::DVec2;
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use thiserror::Error;

use super::sectors::groups;
use super::{BitMatrix, Pvs};
use crate::cells::guide::{self, Below, Guide, GuideError, Split};
use crate::cells::{CellGraph, CellId, EdgeId, Options};
use crate::geom::{GridPoint, Line, Step};
use crate::level::doom::gl::{GlChild, GlNode, GlNodes, GlSeg};
use crate::level::{Level, Place};

/// A map's cells, none of which is in two leaves of its GL nodes.
pub struct Subsectors {
    /// The cells.
    pub graph: CellGraph,
    /// Number of subsectors.
    pub n: usize,
    /// The subsectors that each cell counts for: first the leaf that it lies in.
    of_cell: Vec<SmallVec<[u32; 1]>>,
}

/// Why nodes do not fit a level.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SubsectorError {
    /// Coordinates of the map that nodes cannot name.
    #[error("the map's coordinates are no whole numbers, but its GL nodes' are")]
    NotWhole,
    /// The nodes lie beside the map.
    #[error("node {0} lies far from all walls, so these GL nodes are not of this map")]
    Far(usize),
    /// The nodes are no tree.
    #[error("{0}; build the GL nodes again")]
    Guide(#[from] GuideError),
}

impl Subsectors {
    /// Cuts a map into cells by its nodes.
    ///
    /// # Errors
    /// Where the nodes are no tree or not of this map.
    pub fn new(level: &Level, nodes: &GlNodes, options: &Options) -> Result<Self, SubsectorError> {
        if level.grid.step != Step::Binary(0) {
            return Err(SubsectorError::NotWhole);
        }
        let [x, y] = level.grid.origin;
        let limit = crate::geom::GRID_LIMIT / 4;
        let point = |p: [i64; 2]| {
            let p = GridPoint::new(p[0] - x, p[1] - y);
            (p.x.abs() < limit && p.y.abs() < limit).then_some(p)
        };
        let below = |child| match child {
            GlChild::Node(n) => Below::Split(n),
            GlChild::Subsector(n) => Below::Leaf(n),
        };
        let split = |(i, node): (usize, &GlNode)| {
            let [from, by] = [node.from, node.by];
            let through = point(from).zip(point([from[0] + by[0], from[1] + by[1]]));
            let (p, q) = through.ok_or(SubsectorError::Far(i))?;
            Ok(Split {
                through: [p, q],
                right: below(node.children[0]),
                left: below(node.children[1]),
            })
        };
        let splits = nodes.nodes.iter().enumerate().map(split);
        let splits = splits.collect::<Result<Vec<_>, SubsectorError>>()?;
        let root = match splits.len() {
            0 => Below::Leaf(0),
            n => Below::Split(n as u32 - 1),
        };
        let n = nodes.subsectors.len();
        let guide = Guide::new(splits, root, n)?;
        let (graph, leaf_of) = guide::subdivide(level, &guide, options);
        let mut of_cell: Vec<SmallVec<[u32; 1]>> =
            leaf_of.into_iter().map(|leaf| smallvec![leaf]).collect();
        let fronts = Fronts::new(level, &graph);
        for (number, segs) in (0u32..).zip(&nodes.subsectors) {
            for seg in segs {
                fronts.for_each(seg, |cell| {
                    let of_cell = &mut of_cell[cell.0 as usize];
                    if !of_cell.contains(&number) {
                        of_cell.push(number);
                    }
                });
            }
        }
        Ok(Self { graph, n, of_cell })
    }

    /// The subsectors that a cell counts for: first the leaf in which it lies.
    pub fn of(&self, cell: CellId) -> &[u32] {
        &self.of_cell[cell.0 as usize]
    }

    /// Number of cells that count for more than one subsector.
    pub fn n_shared(&self) -> usize {
        self.of_cell.iter().filter(|list| list.len() > 1).count()
    }

    /// Bit j of row i: subsector i sees subsector j. One without ground sees everything.
    pub fn relation(&self, pvs: &Pvs) -> BitMatrix {
        groups(self.n, pvs, |cell| self.of_cell[cell].iter().copied())
    }
}

/// The GL_PVS lump: row i at i·⌈n/8⌉, bit j % 8 of its byte j / 8 is 1 where i sees j.
pub fn gl_pvs(sees: &BitMatrix) -> Vec<u8> {
    let row_bytes = sees.n().div_ceil(8);
    let row = |i| {
        (sees.row(i).iter())
            .flat_map(|w| w.to_le_bytes())
            .take(row_bytes)
    };
    (0..sees.n()).flat_map(row).collect()
}

/// Ends of two segs, rounded each to the nearest 2^-16, may be so far past each other.
const ROUNDED: f64 = 2.0 / 65536.0;

/// Where the cells in front of a map's walls are found.
struct Fronts<'a> {
    graph: &'a CellGraph,
    /// The grid's origin.
    origin: DVec2,
    /// The line of each linedef, in grid coordinates.
    lines: FxHashMap<u32, Line>,
    /// The edges of cells on each line.
    edges: FxHashMap<Line, Vec<EdgeId>>,
}

impl<'a> Fronts<'a> {
    fn new(level: &Level, graph: &'a CellGraph) -> Self {
        let line = |wall: usize| {
            let wall = &level.walls[wall];
            Line::through(wall.from, wall.to).expect("walls have two different ends")
        };
        let mut lines = FxHashMap::default();
        for (i, wall) in level.walls.iter().enumerate() {
            if let Place::Linedef(n) = wall.place {
                lines.entry(n).or_insert_with(|| line(i));
            }
        }
        let mut edges: FxHashMap<Line, Vec<EdgeId>> = FxHashMap::default();
        for (i, edge) in (0u32..).zip(&graph.edges) {
            if let Some(wall) = edge.wall() {
                let on_line = edges.entry(line(wall.0 as usize)).or_default();
                on_line.push(EdgeId(i));
            }
        }
        let [x, y] = graph.grid.origin;
        Self {
            graph,
            origin: DVec2::new(x as f64, y as f64),
            lines,
            edges,
        }
    }

    /// The cells on the right of a seg that share more of it with it than rounding accounts for.
    fn for_each(&self, seg: &GlSeg, mut found: impl FnMut(CellId)) {
        let Some(line) = seg.linedef.and_then(|n| self.lines.get(&n)) else {
            return;
        };
        let direction = DVec2::new(line.b as f64, -line.a as f64).normalize();
        let [start, end] = (seg.ends)
            .map(|[x, y]| DVec2::new(x as f64, y as f64) / 65536.0 - self.origin)
            .map(|p| p.dot(direction));
        for &edge in self.edges.get(line).into_iter().flatten() {
            // A cell lies on the left of its edge, so the edge runs against the seg.
            let [to, from] = [self.graph.edge(edge).origin, self.graph.end(edge)]
                .map(|v| self.graph.vertices.approx(v).dot(direction));
            let shared = if start < end {
                to.min(end) - from.max(start)
            } else {
                from.min(start) - to.max(end)
            };
            let runs_against = (start < end) == (from < to);
            if runs_against && shared > ROUNDED {
                found(self.graph.edge(edge).cell);
            }
        }
    }
}

#[cfg(test)]
mod tests;
