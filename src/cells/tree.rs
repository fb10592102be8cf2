//! The tree by which a plan was split, with the cells as its leaves.
//!
//! In: an eye. Out: the cells in back-to-front or front-to-back order: each is painted after
//! everything that it may hide, and before everything that may hide it. On which side of a splitting
//! line the eye lies is decided exactly. Sources: Fuchs, Kedem, Naylor, "On visible surface
//! generation by a priori tree structures", 1980; lecture, "BSP tree: Hidden Surface Removal", "BSP
//! tree: Painting".

use super::frame::Frame;
use super::graph::CellId;
use super::partition::{Child, Partition};
use crate::geom::{Line, Side, Vertex};

/// Part of the plan: split further, or a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Index into [`Tree::splits`].
    Split(u32),
    /// A cell.
    Cell(CellId),
    /// Outside the level, or inside of something solid.
    Solid,
}

/// A split of a part of the plan by a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// The line, in the level's grid coordinates.
    pub line: Line,
    /// What lies left of it.
    pub left: Branch,
    /// What lies right of it.
    pub right: Branch,
}

/// A binary space partition of the plan. A split comes before those of its parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tree {
    /// The splits.
    pub splits: Vec<Split>,
    /// The whole plan.
    pub root: Branch,
}

impl Tree {
    /// The tree of a partition made in `frame`; `cell` says which cell a leaf became, if any.
    pub(super) fn of(
        partition: &Partition,
        line: impl Fn(super::arrangement::LineId) -> Line,
        frame: &Frame,
        cell: impl Fn(u32) -> Option<CellId>,
    ) -> Self {
        let branch = |child: Child| match child {
            Child::Node(node) => Branch::Split(node),
            Child::Leaf(leaf) => cell(leaf).map_or(Branch::Solid, Branch::Cell),
        };
        let splits = partition.nodes.iter().map(|node| {
            let (line, turned) = frame.leave_line(&line(node.line));
            let [left, right] = [node.left, node.right].map(branch);
            let [left, right] = if turned { [right, left] } else { [left, right] };
            Split { line, left, right }
        });
        Self {
            splits: splits.collect(),
            root: branch(partition.root),
        }
    }

    /// All cells, the farthest first, as seen from `eye`. An eye on a splitting line sees neither
    /// side of it before the other. O(cells).
    pub fn back_to_front(&self, eye: &Vertex, mut paint: impl FnMut(CellId)) {
        self.walk(eye, Side::Left, &mut paint);
    }

    /// All cells, the nearest first, as seen from `eye`. O(cells).
    pub fn front_to_back(&self, eye: &Vertex, mut visit: impl FnMut(CellId)) {
        self.walk(eye, Side::Right, &mut visit);
    }

    /// Of the two parts of a split, that away from the eye comes first if `far` is `Left`.
    fn walk(&self, eye: &Vertex, far: Side, visit: &mut impl FnMut(CellId)) {
        // An own stack: a room of 10,000 walls makes a tree 10,000 deep.
        let mut open = vec![self.root];
        while let Some(branch) = open.pop() {
            match branch {
                Branch::Solid => {}
                Branch::Cell(cell) => visit(cell),
                Branch::Split(i) => {
                    let split = &self.splits[i as usize];
                    // The one pushed last comes first.
                    if (split.line.side(eye) == Side::Left) == (far == Side::Left) {
                        open.extend([split.left, split.right]);
                    } else {
                        open.extend([split.right, split.left]);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::cells::{CellGraph, Options, Subdivision, subdivide};
    use crate::geom::GridPoint;
    use crate::level::{Level, read};

    fn level(name: &str) -> Level {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("levels")
            .join(name);
        let bytes = std::fs::read(&path).expect("the level is there");
        let source = read::Source::parse(bytes, name).expect("it is sound");
        source.level(None).expect("it is sound")
    }

    fn by(level: &Level, subdivision: Subdivision) -> CellGraph {
        let options = Options {
            subdivision,
            ..Options::default()
        };
        subdivide(level, &options)
    }

    /// Each cell lies on the side of every split that the tree says.
    fn check_sides(
        graph: &CellGraph,
        branch: Branch,
        above: &mut Vec<(Line, Side)>,
        met: &mut u32,
    ) {
        match branch {
            Branch::Solid => {}
            Branch::Cell(cell) => {
                *met += 1;
                for (line, side) in &*above {
                    let corners = graph
                        .corners(cell)
                        .map(|v| line.side(graph.vertices.exact(v)));
                    assert!(corners.into_iter().all(|s| s == *side || s == Side::On));
                }
            }
            Branch::Split(i) => {
                let tree = graph.tree.as_ref().expect("it was split");
                let split = tree.splits[i as usize];
                for (side, part) in [(Side::Left, split.left), (Side::Right, split.right)] {
                    above.push((split.line, side));
                    check_sides(graph, part, above, met);
                    above.pop();
                }
            }
        }
    }

    #[test]
    fn every_cell_lies_where_the_tree_says() {
        for name in ["tiny.toml", "house.toml", "museum.toml", "maze.toml"] {
            let level = level(name);
            for subdivision in [Subdivision::Bsp, Subdivision::Kd] {
                let graph = by(&level, subdivision);
                let root = graph.tree.as_ref().expect("it was split").root;
                let mut met = 0;
                check_sides(&graph, root, &mut Vec::new(), &mut met);
                assert_eq!(met as usize, graph.cells.len());
            }
            assert!(by(&level, Subdivision::Cdt).tree.is_none());
        }
    }

    #[test]
    fn what_is_behind_a_portal_is_painted_before() {
        let level = level("museum.toml");
        for subdivision in [Subdivision::Bsp, Subdivision::Kd] {
            let graph = by(&level, subdivision);
            let tree = graph.tree.as_ref().expect("it was split");
            let mut place = vec![0; graph.cells.len()];
            for (x, y) in [(480_000, 200_000), (10_000, 10_000), (123_457, 318_211)] {
                let eye = Vertex::from(GridPoint::new(x, y));
                let mut order = Vec::new();
                tree.back_to_front(&eye, |cell| order.push(cell));
                let mut forth = Vec::new();
                tree.front_to_back(&eye, |cell| forth.push(cell));
                assert_eq!(order.len(), graph.cells.len());
                for (n, cell) in order.iter().enumerate() {
                    place[cell.0 as usize] = n;
                }
                let mut compared = 0;
                for portal in &graph.portals {
                    let [edge, twin] = portal.edges;
                    let ends = [graph.edge(edge).origin, graph.end(edge)];
                    let [from, to] = ends.map(|v| graph.vertices.exact(v));
                    let [near, far] = [edge, twin].map(|e| graph.edge(e).cell);
                    let (near, far) = match crate::geom::orient(from, to, &eye) {
                        Side::Left => (near, far),
                        Side::Right => (far, near),
                        Side::On => continue,
                    };
                    compared += 1;
                    assert!(place[far.0 as usize] < place[near.0 as usize]);
                }
                assert!(compared > 100);
                forth.reverse();
                let strict = |list: &[CellId]| list.to_vec();
                // No line of the museum runs through these eyes: the one order is the other backwards.
                if (x, y) == (123_457, 318_211) {
                    assert_eq!(strict(&order), strict(&forth));
                }
            }
        }
    }
}
