//! Recursive partition of the plan by lines, until no wall is left inside any part.
//!
//! In: an [`Arrangement`] and a rule that chooses the next splitting line. Out: the tree and its
//! convex leaves, whose corners are exact meetings of two lines. `bsp` and `kd` differ in the rule
//! alone. Source: lecture, "Building a BSP tree", "BSP tree: Partitioning".

use smallvec::SmallVec;

use super::arrangement::{Arrangement, LineId, PieceId};
use crate::geom::{Line, Side, VertexId};

/// A part of a piece that lies in one region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fragment {
    /// The piece it is part of.
    pub piece: PieceId,
    /// The piece's line.
    pub line: LineId,
    /// Its start, in the direction of the piece's line.
    pub from: VertexId,
    /// Its end.
    pub to: VertexId,
}

/// A convex region: corner `i` and the line of the edge that leaves it, counterclockwise.
pub type Region = SmallVec<[(VertexId, LineId); 8]>;

/// A node of the tree, or one of its leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Child {
    /// Index into [`Partition::nodes`].
    Node(u32),
    /// Index into [`Partition::leaves`].
    Leaf(u32),
}

/// A split of a region by a line.
#[derive(Clone, Debug)]
pub struct Node {
    /// The splitting line.
    pub line: LineId,
    /// What lies left of the line.
    pub left: Child,
    /// What lies right of the line.
    pub right: Child,
    /// The fragments that lie on the line inside the region.
    pub on: Vec<Fragment>,
}

/// A partition of a box around the level into convex leaves.
pub struct Partition {
    /// The tree; the root is [`Partition::root`].
    pub nodes: Vec<Node>,
    /// The leaves' outlines.
    pub leaves: Vec<Region>,
    /// In which leaf of the guide each of them lies; 0 without one.
    pub parts: Vec<u32>,
    /// Top of the tree.
    pub root: Child,
    /// How often a fragment was cut in two.
    pub splits: usize,
    /// Splits on the longest way from the root to a leaf.
    pub depth: usize,
}

/// Chooses the line that splits a region next. The fragments are never empty; the line must separate
/// two of them or hold one.
pub type Choose<'a> = dyn FnMut(&mut Arrangement, &[Fragment]) -> LineId + 'a;

/// A region still to be split, and where its place in the tree is.
struct Task {
    region: Region,
    fragments: Vec<Fragment>,
    parent: Option<(u32, Side)>,
    depth: usize,
    /// What the guide says about it.
    guided: Guided,
}

/// Part of the plan, as a guide has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guided {
    /// Is split by this one of the guide's lines.
    Split(u32),
    /// Is left to the rule. The number is handed down to all leaves in it.
    Part(u32),
}

/// A split that is to be made before the rule is asked for any.
#[derive(Clone, Copy, Debug)]
pub struct GuideSplit {
    /// The line.
    pub line: LineId,
    /// What lies left of it, and right of it.
    pub sides: [Guided; 2],
}

/// Partitions the box around all pieces by the lines that `choose` names.
pub fn partition(arrangement: &mut Arrangement, choose: &mut Choose) -> Partition {
    guided(arrangement, &[], Guided::Part(0), choose)
}

/// As [`partition`], but first by the lines of a tree, which is given from `root` on. Splits lead to
/// later ones only, or the partition would not end; see [`super::guide`].
pub fn guided(
    arrangement: &mut Arrangement,
    guide: &[GuideSplit],
    root: Guided,
    choose: &mut Choose,
) -> Partition {
    let fragments = (0u32..)
        .zip(&arrangement.pieces)
        .map(|(i, p)| Fragment {
            piece: PieceId(i),
            line: p.line,
            from: p.from,
            to: p.to,
        })
        .collect();
    let mut tree = Partition {
        nodes: Vec::new(),
        leaves: Vec::new(),
        parts: Vec::new(),
        root: Child::Leaf(0),
        splits: 0,
        depth: 0,
    };
    let region = bounding_box(arrangement);
    let mut sides = Vec::new();
    // An own stack: a room of 10,000 walls makes a tree 10,000 deep.
    let mut tasks = vec![Task {
        region,
        fragments,
        parent: None,
        depth: 0,
        guided: root,
    }];
    while let Some(mut task) = tasks.pop() {
        tree.depth = tree.depth.max(task.depth);
        let (split, [to_left, to_right]) =
            follow(arrangement, guide, &task.region, &mut task.guided);
        let split = split.or_else(|| {
            let any = !task.fragments.is_empty();
            any.then(|| choose(arrangement, &task.fragments))
        });
        let child = if let Some(line) = split {
            let parts = split_fragments(arrangement, &task.fragments, line);
            let (left, right) = split_region(arrangement, &task.region, line, &mut sides);
            tree.splits += parts.splits;
            let id = tree.nodes.len() as u32;
            let unset = Child::Leaf(u32::MAX);
            tree.nodes.push(Node {
                line,
                left: unset,
                right: unset,
                on: parts.on,
            });
            let depth = task.depth + 1;
            let parent = |side| Some((id, side));
            tasks.push(Task {
                region: right,
                fragments: parts.right,
                parent: parent(Side::Right),
                depth,
                guided: to_right,
            });
            tasks.push(Task {
                region: left,
                fragments: parts.left,
                parent: parent(Side::Left),
                depth,
                guided: to_left,
            });
            Child::Node(id)
        } else {
            tree.leaves.push(task.region);
            tree.parts.push(match task.guided {
                Guided::Part(part) => part,
                Guided::Split(_) => unreachable!("the guide was followed to its end"),
            });
            Child::Leaf(tree.leaves.len() as u32 - 1)
        };
        match task.parent {
            Some((node, Side::Left)) => tree.nodes[node as usize].left = child,
            Some((node, _)) => tree.nodes[node as usize].right = child,
            None => tree.root = child,
        }
    }
    tree
}

/// The next of the guide's lines that passes through a region, and what its two sides are; `None`
/// where the guide ends, which both sides of any further split then inherit. Lines that miss the
/// region are passed over.
fn follow(
    arrangement: &Arrangement,
    guide: &[GuideSplit],
    region: &Region,
    at: &mut Guided,
) -> (Option<LineId>, [Guided; 2]) {
    while let Guided::Split(split) = *at {
        let split = &guide[split as usize];
        let [left, right] = [Side::Left, Side::Right].map(|wanted| {
            let on_that_side = |c: &(VertexId, LineId)| arrangement.side(c.0, split.line) == wanted;
            region.iter().any(on_that_side)
        });
        match (left, right) {
            (true, true) => return (Some(split.line), split.sides),
            (true, false) => *at = split.sides[0],
            _ => *at = split.sides[1],
        }
    }
    (None, [*at; 2])
}

/// A box two steps wider than the level on every side.
fn bounding_box(arrangement: &mut Arrangement) -> Region {
    let mut low = [0i64; 2];
    let mut high = [0i64; 2];
    for piece in &arrangement.pieces {
        for v in [piece.from, piece.to] {
            // Crossings lie between ends, so the grid points alone bound the level.
            if let Some(p) = arrangement.vertices.get(v).grid() {
                low = [low[0].min(p.x), low[1].min(p.y)];
                high = [high[0].max(p.x), high[1].max(p.y)];
            }
        }
    }
    let lines = [
        Line::horizontal(low[1] - 2),
        Line::vertical(high[0] + 2),
        Line::horizontal(high[1] + 2),
        Line::vertical(low[0] - 2),
    ]
    .map(|line| arrangement.lines.insert(line));
    (0..4)
        .map(|i| (arrangement.meet(lines[(i + 3) % 4], lines[i]), lines[i]))
        .collect()
}

struct Parts {
    left: Vec<Fragment>,
    right: Vec<Fragment>,
    on: Vec<Fragment>,
    splits: usize,
}

fn split_fragments(arrangement: &mut Arrangement, fragments: &[Fragment], line: LineId) -> Parts {
    let half = fragments.len() / 2 + 1;
    let mut parts = Parts {
        left: Vec::with_capacity(half),
        right: Vec::with_capacity(half),
        on: Vec::new(),
        splits: 0,
    };
    for &f in fragments {
        match arrangement.sides(&f, line) {
            (Side::On, Side::On) => parts.on.push(f),
            (Side::Left, Side::Right) | (Side::Right, Side::Left) => {
                let middle = arrangement.meet(f.line, line);
                let (before, after) =
                    (Fragment { to: middle, ..f }, Fragment { from: middle, ..f });
                let left_first = arrangement.side(f.from, line) == Side::Left;
                let (left, right) = if left_first {
                    (before, after)
                } else {
                    (after, before)
                };
                parts.left.push(left);
                parts.right.push(right);
                parts.splits += 1;
            }
            (Side::Left, _) | (_, Side::Left) => parts.left.push(f),
            _ => parts.right.push(f),
        }
    }
    parts
}

/// Cuts a convex region that the line passes through into its left and its right part. `sides` is
/// room to work in.
fn split_region(
    arrangement: &mut Arrangement,
    region: &Region,
    line: LineId,
    sides: &mut Vec<Side>,
) -> (Region, Region) {
    sides.clear();
    sides.extend(region.iter().map(|c| arrangement.side(c.0, line)));
    let mut left = Region::with_capacity(region.len() + 2);
    let mut right = Region::with_capacity(region.len() + 2);
    for (i, &(corner, edge)) in region.iter().enumerate() {
        let next = sides[(i + 1) % sides.len()];
        match (sides[i], next) {
            // A corner on the line: the edge that leaves it belongs to the side it leads to; the
            // other part goes on along the splitting line.
            (Side::On, Side::Left) => {
                left.push((corner, edge));
                right.push((corner, line));
            }
            (Side::On, _) => {
                left.push((corner, line));
                right.push((corner, edge));
            }
            (Side::Left, Side::Right) => {
                left.push((corner, edge));
                let cut = arrangement.meet(edge, line);
                left.push((cut, line));
                right.push((cut, edge));
            }
            (Side::Right, Side::Left) => {
                right.push((corner, edge));
                let cut = arrangement.meet(edge, line);
                right.push((cut, line));
                left.push((cut, edge));
            }
            (Side::Left, _) => left.push((corner, edge)),
            (Side::Right, _) => right.push((corner, edge)),
        }
    }
    (left, right)
}

impl Arrangement {
    /// The piece with that id.
    pub fn piece(&self, id: PieceId) -> &super::arrangement::Piece {
        &self.pieces[id.0 as usize]
    }

    /// Side of a line on which a vertex lies.
    #[inline]
    pub fn side(&self, v: VertexId, line: LineId) -> Side {
        self.vertices.side(v, self.lines.get(line))
    }

    /// Sides of a line on which a fragment's two ends lie.
    #[inline]
    pub fn sides(&self, f: &Fragment, line: LineId) -> (Side, Side) {
        if f.line == line {
            return (Side::On, Side::On);
        }
        let line = self.lines.get(line);
        (
            self.vertices.side(f.from, line),
            self.vertices.side(f.to, line),
        )
    }

    /// The vertex in which two lines meet that are known to.
    fn meet(&mut self, l: LineId, m: LineId) -> VertexId {
        let vertex = self.lines.get(l).meet(self.lines.get(m));
        self.vertices
            .insert(vertex.expect("lines that part an edge's ends are not parallel to it"))
    }
}
