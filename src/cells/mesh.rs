//! Half-edges: convex outlines joined edge to edge, with the walls on them.
//!
//! In: the leaves of a partition (whose neighbours may meet in the middle of an edge), or triangles.
//! Out: a [`Mesh`] in which every edge has at most one neighbour on its other side, the same stretch
//! of line. Covers inside and outside of the level alike; `interior` tells them apart.

use std::ops::Range;

use rustc_hash::FxHashMap;

use super::arrangement::{Arrangement, LineId, PieceId};
use super::partition::Partition;
use crate::geom::VertexId;

/// An edge of a cell, seen from inside it.
#[derive(Clone, Copy, Debug)]
pub struct HalfEdge {
    /// Where it starts, going counterclockwise; it ends where the next one starts.
    pub origin: VertexId,
    /// The cell that it bounds.
    pub cell: u32,
    /// Index of the same stretch seen from the other side; none on the rim of the mesh.
    pub twin: Option<u32>,
    /// The piece of wall that it lies on.
    pub piece: Option<PieceId>,
    /// Whether the cell is on the left of the piece's line.
    pub left_of_piece: bool,
}

/// Convex cells as counterclockwise half-edges.
pub struct Mesh {
    /// The half-edges, cell after cell.
    pub edges: Vec<HalfEdge>,
    /// Where each cell's half-edges start, and, last, their number.
    pub first: Vec<u32>,
}

impl Mesh {
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.first.len() - 1
    }

    /// The indices of a cell's half-edges.
    pub fn range(&self, cell: usize) -> Range<usize> {
        self.first[cell] as usize..self.first[cell + 1] as usize
    }

    /// Where a half-edge ends.
    pub fn end(&self, edge: usize) -> VertexId {
        let range = self.range(self.edges[edge].cell as usize);
        let next = if edge + 1 == range.end {
            range.start
        } else {
            edge + 1
        };
        self.edges[next].origin
    }
}

/// An edge of a leaf, in the direction of its line.
struct LeafEdge {
    /// Number among the edges of all leaves.
    edge: u32,
    cell: u32,
    from: VertexId,
    to: VertexId,
    /// Whether the leaf is left of the line.
    left: bool,
}

/// A part of a leaf's edge between two stops.
struct Stretch {
    half_edge: HalfEdge,
    /// The leaf's edge, and the position in it in the direction of the line.
    edge: u32,
    number: u32,
}

/// Joins the leaves of a partition. Every edge is cut where a neighbour or a piece of wall starts or
/// ends on it. O(n log n).
pub fn join_leaves(arrangement: &Arrangement, partition: &Partition) -> Mesh {
    let mut by_line = leaf_edges(arrangement, partition);
    let n_edges = by_line.len();
    by_line.sort_unstable_by_key(|(line, e)| (*line, e.edge));
    let mut pieces: Vec<(LineId, PieceId)> = arrangement
        .pieces
        .iter()
        .zip(0u32..)
        .map(|(p, i)| (p.line, PieceId(i)))
        .collect();
    pieces.sort_unstable();

    let mut stretches: Vec<Stretch> = Vec::with_capacity(2 * n_edges);
    let mut counts = vec![0u32; n_edges];
    let mut twins: Vec<(usize, usize)> = Vec::with_capacity(n_edges);
    // Position among the stops of the line at hand; what other lines left there is not looked at.
    let mut rank = vec![0usize; arrangement.vertices.len()];
    let (mut stops, mut sides, mut on) = (Vec::new(), Vec::new(), Vec::new());
    for edges in by_line.chunk_by(|a, b| a.0 == b.0) {
        let line = edges[0].0;
        let start = pieces.partition_point(|p| p.0 < line);
        let pieces = pieces[start..]
            .iter()
            .take_while(|p| p.0 == line)
            .map(|p| p.1);

        stops.clear();
        stops.extend(edges.iter().flat_map(|(_, e)| [e.from, e.to]));
        stops.extend(pieces.clone().flat_map(|p| {
            let piece = arrangement.piece(p);
            [piece.from, piece.to]
        }));
        stops.sort_unstable();
        stops.dedup();
        let line = arrangement.lines.get(line);
        stops.sort_unstable_by(|&p, &q| arrangement.vertices.cmp_along(line, p, q));
        for (i, v) in stops.iter().enumerate() {
            rank[v.0 as usize] = i;
        }
        let rank = |v: VertexId| rank[v.0 as usize];

        // Per stretch between two stops, the leaf's edge on its left and on its right.
        sides.clear();
        sides.resize(stops.len(), [None::<&LeafEdge>; 2]);
        for (_, e) in edges {
            for stretch in &mut sides[rank(e.from)..rank(e.to)] {
                stretch[usize::from(!e.left)] = Some(e);
            }
        }
        on.clear();
        on.resize(stops.len(), None);
        for p in pieces {
            let piece = arrangement.piece(p);
            on[rank(piece.from)..rank(piece.to)].fill(Some(p));
        }
        for (i, sides) in sides.iter().enumerate() {
            let mut place = |e: &LeafEdge| {
                let count = &mut counts[e.edge as usize];
                stretches.push(Stretch {
                    half_edge: HalfEdge {
                        origin: stops[if e.left { i } else { i + 1 }],
                        cell: e.cell,
                        twin: None,
                        piece: on[i],
                        left_of_piece: e.left,
                    },
                    edge: e.edge,
                    number: *count,
                });
                *count += 1;
                stretches.len() - 1
            };
            if let (Some(l), Some(r)) = (sides[0].map(&mut place), sides[1].map(&mut place)) {
                twins.push((l, r));
            }
        }
    }
    assemble(partition, &stretches, &counts, &twins)
}

/// All edges of all leaves with their lines.
fn leaf_edges(arrangement: &Arrangement, partition: &Partition) -> Vec<(LineId, LeafEdge)> {
    let mut list = Vec::with_capacity(partition.leaves.iter().map(|r| r.len()).sum());
    for (cell, region) in (0u32..).zip(&partition.leaves) {
        for (i, &(from, line)) in region.iter().enumerate() {
            let to = region[(i + 1) % region.len()].0;
            // Counterclockwise, so the leaf is left of the line if the edge goes the line's way.
            let left = arrangement
                .vertices
                .cmp_along(arrangement.lines.get(line), from, to)
                .is_lt();
            let (from, to) = if left { (from, to) } else { (to, from) };
            let edge = list.len() as u32;
            list.push((
                line,
                LeafEdge {
                    edge,
                    cell,
                    from,
                    to,
                    left,
                },
            ));
        }
    }
    list
}

/// Puts the stretches in counterclockwise order, cell after cell, and links the twins.
fn assemble(
    partition: &Partition,
    stretches: &[Stretch],
    counts: &[u32],
    twins: &[(usize, usize)],
) -> Mesh {
    let mut starts = Vec::with_capacity(counts.len() + 1);
    starts.push(0u32);
    for count in counts {
        starts.push(starts.last().unwrap() + count);
    }
    let mut first = vec![0u32];
    let mut edge = 0;
    for region in &partition.leaves {
        edge += region.len();
        first.push(starts[edge]);
    }
    let position = |s: &Stretch| {
        // The edge of a leaf on the right of its line runs against the line.
        let i = s.edge as usize;
        let number = if s.half_edge.left_of_piece {
            s.number
        } else {
            counts[i] - 1 - s.number
        };
        starts[i] + number
    };
    let mut edges: Vec<Option<HalfEdge>> = vec![None; stretches.len()];
    for s in stretches {
        edges[position(s) as usize] = Some(s.half_edge);
    }
    let mut edges: Vec<HalfEdge> = edges
        .into_iter()
        .map(|e| e.expect("every position is taken once"))
        .collect();
    for &(l, r) in twins {
        let (l, r) = (position(&stretches[l]), position(&stretches[r]));
        edges[l as usize].twin = Some(r);
        edges[r as usize].twin = Some(l);
    }
    Mesh { edges, first }
}

/// Which piece of wall lies between two vertices, in the direction of the piece's line.
pub type PieceBetween = FxHashMap<(VertexId, VertexId), PieceId>;

/// Joins polygons that already meet corner to corner (a triangulation's). Counterclockwise.
pub fn join_polygons(pieces: &PieceBetween, polygons: &[Vec<VertexId>]) -> Mesh {
    let mut mesh = Mesh {
        edges: Vec::new(),
        first: vec![0],
    };
    let mut open: FxHashMap<(VertexId, VertexId), u32> = FxHashMap::default();
    for (cell, polygon) in (0u32..).zip(polygons) {
        for (i, &from) in polygon.iter().enumerate() {
            let to = polygon[(i + 1) % polygon.len()];
            let forward = pieces.get(&(from, to));
            let index = mesh.edges.len() as u32;
            let twin = open.remove(&(to, from));
            if let Some(twin) = twin {
                mesh.edges[twin as usize].twin = Some(index);
            } else {
                open.insert((from, to), index);
            }
            mesh.edges.push(HalfEdge {
                origin: from,
                cell,
                twin,
                piece: forward.or_else(|| pieces.get(&(to, from))).copied(),
                left_of_piece: forward.is_some(),
            });
        }
        mesh.first.push(mesh.edges.len() as u32);
    }
    mesh
}
