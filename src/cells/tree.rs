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

/// What is met on a way through the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// A cell.
    Cell(CellId),
    /// What lies on the line of a split: index into [`Tree::splits`].
    Line(u32),
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
        self.paint(eye, |met| {
            if let Met::Cell(cell) = met {
                paint(cell);
            }
        });
    }

    /// All cells, the nearest first, as seen from `eye`. O(cells).
    pub fn front_to_back(&self, eye: &Vertex, mut visit: impl FnMut(CellId)) {
        self.walk(eye, Side::Right, &mut |met| {
            if let Met::Cell(cell) = met {
                visit(cell);
            }
        });
    }

    /// All cells and lines, the farthest first, as seen from `eye`: of each split the part away from the
    /// eye, then what lies on its line, then the part on the eye's side. O(cells).
    pub fn paint(&self, eye: &Vertex, mut paint: impl FnMut(Met)) {
        self.walk(eye, Side::Left, &mut paint);
    }

    /// Of the two parts of a split, that away from the eye comes first if `far` is `Left`.
    fn walk(&self, eye: &Vertex, far: Side, visit: &mut impl FnMut(Met)) {
        // An own stack: a room of 10,000 walls makes a tree 10,000 deep.
        let mut open = vec![(self.root, None)];
        while let Some((branch, line)) = open.pop() {
            // The line after which the branch comes.
            if let Some(line) = line {
                visit(Met::Line(line));
            }
            match branch {
                Branch::Solid => {}
                Branch::Cell(cell) => visit(Met::Cell(cell)),
                Branch::Split(i) => {
                    let split = &self.splits[i as usize];
                    let (mut first, mut last) = (split.right, split.left);
                    if (split.line.side(eye) == Side::Left) != (far == Side::Left) {
                        (first, last) = (last, first);
                    }
                    // The one pushed last comes first.
                    open.extend([(last, Some(i)), (first, None)]);
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
    use crate::geom::{GridPoint, orient};
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

    /// A wall of the lecture's example: its name and ends.
    #[derive(Clone, Debug)]
    struct Wall {
        name: String,
        ends: [GridPoint; 2],
    }

    /// A tree in which the walls are in the splits: the first of a list splits the rest, as in the
    /// lecture. A wall that is split becomes two, `a` on the line's left and `b` on its right.
    fn by_walls(list: &[Wall], tree: &mut Tree, names: &mut Vec<Wall>) -> Branch {
        let Some((first, rest)) = list.split_first() else {
            return Branch::Solid;
        };
        let line = Line::through(first.ends[0], first.ends[1]).expect("it has a length");
        let number = tree.splits.len() as u32;
        names.push(first.clone());
        tree.splits.push(Split {
            line,
            left: Branch::Solid,
            right: Branch::Solid,
        });
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for wall in rest {
            match wall.ends.map(|p| line.side(&p.into())) {
                [Side::Left, Side::Left] => left.push(wall.clone()),
                [Side::Right, Side::Right] => right.push(wall.clone()),
                [_, last] => {
                    let at = GridPoint::new(6, 4);
                    assert_eq!(line.side(&at.into()), Side::On);
                    let part = |letter: &str, end| Wall {
                        name: format!("{}{letter}", wall.name),
                        ends: [at, end],
                    };
                    let [p, q] = wall.ends;
                    let (l, r) = if last == Side::Left { (q, p) } else { (p, q) };
                    left.push(part("a", l));
                    right.push(part("b", r));
                }
            }
        }
        let left = by_walls(&left, tree, names);
        let right = by_walls(&right, tree, names);
        let split = &mut tree.splits[number as usize];
        (split.left, split.right) = (left, right);
        Branch::Split(number)
    }

    /// The lecture, "BSP tree: example" and "Hidden Surface Removal": six walls, split in the order of
    /// their numbers, and two viewpoints. Its picture is lost; this plan has the tree that its orders
    /// tell of: 1 parts 3 and 5 from the rest, 2 cuts 4 in two, and only the line of 4a parts the viewpoints.
    ///
    /// ```text
    ///   9      V1              .         V2
    ///   8                      |
    ///   7                      |        /
    ///   6                      4a      6
    ///   5                      |      /
    ///   4      ────2────  . . .|. . . . . .
    ///   3                      4b
    ///   2                      |
    ///   1
    ///   0      ──────────────1─────────────
    ///  -2               5────
    ///  -3           ────
    ///  -6      ──────────────3─────────────          1
    ///          0       4       6     8   10         / \
    ///                                              3   2
    ///                                               \ / \
    ///                                              5 4b  4a
    ///                                                      \
    ///                                                       6
    /// ```
    #[test]
    fn the_lectures_painting_orders() {
        let wall = |name: &str, [x1, y1, x2, y2]: [i64; 4]| Wall {
            name: name.to_string(),
            ends: [GridPoint::new(x1, y1), GridPoint::new(x2, y2)],
        };
        let walls = [
            wall("1", [0, 0, 10, 0]),
            wall("2", [4, 4, 0, 4]),
            wall("3", [0, -6, 10, -6]),
            wall("4", [6, 2, 6, 8]),
            wall("5", [2, -3, 7, -2]),
            wall("6", [8, 5, 9, 7]),
        ];
        let mut tree = Tree {
            splits: Vec::new(),
            root: Branch::Solid,
        };
        let mut pieces = Vec::new();
        tree.root = by_walls(&walls, &mut tree, &mut pieces);
        let eyes = [GridPoint::new(1, 9), GridPoint::new(10, 9)];
        let orders = [
            ["3", "5", "1", "4b", "2", "6", "4a"],
            ["3", "5", "1", "4b", "2", "4a", "6"],
        ];
        for (eye, expected) in eyes.into_iter().zip(orders) {
            let eye = Vertex::from(eye);
            let mut order = Vec::new();
            tree.paint(&eye, |met| match met {
                Met::Line(split) => order.push(&pieces[split as usize]),
                Met::Cell(_) => unreachable!("there are only walls"),
            });
            let names: Vec<&str> = order.iter().map(|wall| wall.name.as_str()).collect();
            assert_eq!(names, expected);
            // And so it must be: what is painted later is nowhere behind what was painted before.
            let mut hidden = 0;
            for (i, before) in order.iter().enumerate() {
                for after in &order[i + 1..] {
                    assert!(
                        !hides(&eye, before, after),
                        "{} {}",
                        before.name,
                        after.name
                    );
                    hidden += u32::from(hides(&eye, after, before));
                }
            }
            assert!(hidden >= 5, "{hidden}");
        }
    }

    /// Whether from the eye some of `far` is behind `near`: by the sight to 1000 places of it.
    fn hides(eye: &Vertex, near: &Wall, far: &Wall) -> bool {
        // In thousandths of a step, so that the places are grid points.
        let scaled = |p: GridPoint| Vertex::from(GridPoint::new(p.x * 1000, p.y * 1000));
        let o = scaled(eye.grid().expect("it is one"));
        let [a, b] = near.ends.map(scaled);
        (0..=1000).any(|k| {
            let [p, q] = far.ends;
            let at = GridPoint::new(p.x * (1000 - k) + q.x * k, p.y * (1000 - k) + q.y * k);
            let at = Vertex::from(at);
            let apart = |s: Side, t: Side| s != t && s != Side::On && t != Side::On;
            apart(orient(&a, &b, &o), orient(&a, &b, &at))
                && apart(orient(&o, &at, &a), orient(&o, &at, &b))
        })
    }
}
