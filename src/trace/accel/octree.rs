//! The octree, walked by pushing a point.
//!
//! In: boxes of primitives. Out: a tree whose nodes have eight children, halves along all three axes;
//! a leaf lists the primitives whose enlarged boxes ([`super::margin`]) touch it.
//!
//! # The walk
//!
//! The lecture: find the leaf that holds the point F at which the ray enters; test it; compute the
//! point P at which the ray leaves it; push P along the normal of that face (on an edge or a corner:
//! of all faces there at once) by half the side of the smallest cell; find the leaf that holds the
//! pushed point; and so on.
//!
//! Taken literally a rounded point may lie on the wrong side of the face, or of an edge, so that a
//! leaf comes twice (without end) or is skipped. Here points are pushed in the lattice of the smallest
//! cells, that is by whole numbers. Along the axis of the face the new index is that of the first
//! smallest cell behind the face: exactly where half of such a cell beyond it lies. Along the other
//! axes it is that of P, kept within the leaf that P is on. So each step moves an index strictly on
//! and none back: no leaf comes twice, and the walk ends. And each leaf found touches the one before
//! in P itself: none is skipped, at most one that the ray only touches in an edge, which the margin
//! makes up for.

use std::collections::VecDeque;

use glam::{DVec3, UVec3};
use smallvec::SmallVec;

use super::Walk;
use super::bounds::Bounds;
use super::brute::all;
use super::cast::Cast;
use super::count::Count;
use super::mailbox::Mailbox;
use super::margin::Margin;
use super::primitives::Primitives;
use super::search::Search;

/// Halvings at most.
const DEPTH: u32 = 12;

/// Primitives in a leaf, unless it is one of the smallest or room runs out.
const LEAF: usize = 4;

#[derive(Clone, Copy, Debug)]
enum Node {
    /// Eight children from there on; bit k of a child's number is set in the upper half of axis k.
    Branch(u32),
    /// A range of the list.
    Leaf { first: u32, count: u32 },
}

/// An octree.
#[derive(Clone, Debug)]
pub struct Octree {
    margin: Margin,
    /// Halvings that happened anywhere: the lattice has 2^depth cells along each axis.
    depth: u32,
    nodes: Vec<Node>,
    list: Vec<u32>,
    len: u32,
}

/// A node of the lattice: its first cell, and how many it is wide.
#[derive(Clone, Copy)]
struct Block {
    first: UVec3,
    width: u32,
}

impl Block {
    fn child(&self, i: u32) -> Self {
        let half = self.width / 2;
        let bit = |k: u32| (i >> k & 1) * half;
        Self {
            first: self.first + UVec3::new(bit(0), bit(1), bit(2)),
            width: half,
        }
    }
}

impl Octree {
    /// Builds it, level by level, as long as there is room for its lists: a few times as many entries
    /// as there are primitives.
    pub fn new<P: Primitives>(primitives: &P) -> Self {
        let margin = Margin::new(primitives);
        let boxes = margin.boxes(primitives);
        let mut room = super::room(boxes.len());
        let mut tree = Self {
            margin,
            depth: DEPTH,
            nodes: vec![Node::Leaf { first: 0, count: 0 }],
            list: Vec::new(),
            len: boxes.len() as u32,
        };
        let root = Block {
            first: UVec3::ZERO,
            width: 1 << DEPTH,
        };
        let mut open = VecDeque::from([(0, root, (0..tree.len).collect::<Vec<u32>>())]);
        let mut smallest = root.width;
        while let Some((node, block, list)) = open.pop_front() {
            let parts = tree.split(&block, &list, &boxes, &mut room);
            let Some(parts) = parts else {
                smallest = smallest.min(block.width);
                tree.nodes[node] = Node::Leaf {
                    first: tree.list.len() as u32,
                    count: list.len() as u32,
                };
                tree.list.extend(list);
                continue;
            };
            let first = tree.nodes.len();
            tree.nodes[node] = Node::Branch(first as u32);
            tree.nodes.extend([Node::Leaf { first: 0, count: 0 }; 8]);
            for (i, part) in (0..).zip(parts) {
                open.push_back((first + i as usize, block.child(i), part));
            }
        }
        tree.depth = DEPTH - smallest.ilog2();
        tree
    }

    /// The primitives of the eight children; none where the node stays a leaf.
    fn split(
        &self,
        block: &Block,
        list: &[u32],
        boxes: &[Bounds],
        room: &mut usize,
    ) -> Option<[Vec<u32>; 8]> {
        if list.len() <= LEAF || block.width == 1 {
            return None;
        }
        let mut parts: [Vec<u32>; 8] = Default::default();
        for (i, part) in (0..).zip(&mut parts) {
            let space = self.space(&block.child(i), DEPTH);
            let inside = |&&p: &&u32| space.touches(&boxes[p as usize]);
            part.extend(list.iter().filter(inside));
        }
        let entries: usize = parts.iter().map(Vec::len).sum();
        if entries > list.len() + *room || parts.iter().all(|p| p.len() == list.len()) {
            return None;
        }
        *room -= entries.saturating_sub(list.len());
        Some(parts)
    }

    /// The coordinate of the plane before cell i of the lattice with 2^depth cells in a row.
    fn plane(&self, axis: usize, i: u32, depth: u32) -> f64 {
        // The same for every depth that has this plane: the fraction is exact.
        let root = &self.margin.root;
        root.min[axis] + root.size()[axis] * (f64::from(i) / f64::from(1u32 << depth))
    }

    fn space(&self, block: &Block, depth: u32) -> Bounds {
        let corner = |i: UVec3| {
            let plane = |axis: usize| self.plane(axis, i[axis], depth);
            DVec3::new(plane(0), plane(1), plane(2))
        };
        Bounds {
            min: corner(block.first),
            max: corner(block.first + block.width),
        }
    }

    /// The leaf that holds a cell of the lattice.
    fn locate<C: Count>(&self, cell: UVec3, count: &mut C) -> (Block, &[u32]) {
        let mut width = 1 << self.depth;
        let mut node = 0;
        loop {
            count.node();
            match self.nodes[node] {
                Node::Branch(first) => {
                    width /= 2;
                    let bit = |k: usize| usize::from(cell[k] & width != 0) << k;
                    node = first as usize + (bit(0) | bit(1) | bit(2));
                }
                Node::Leaf { first, count } => {
                    let first = first as usize;
                    let block = Block {
                        first: cell & !(UVec3::splat(width - 1)),
                        width,
                    };
                    return (block, &self.list[first..first + count as usize]);
                }
            }
        }
    }

    /// The lattice cell of a point, before it is kept within bounds.
    fn index(&self, p: DVec3, per_length: DVec3) -> UVec3 {
        // From f64 to u32: below 0 gives 0.
        ((p - self.margin.root.min) * per_length).as_uvec3()
    }
}

impl Walk for Octree {
    fn walk<S: Search, C: Count>(&self, cast: &Cast, _: f64, search: &mut S, count: &mut C) {
        if !self.margin.covers(cast) {
            all(self.len, search, count);
            return;
        }
        let (mut t, far) = self.margin.interval(cast);
        if t > far || t > search.limit() {
            return;
        }
        let row = 1u32 << self.depth;
        let per_length = f64::from(row) / self.margin.root.size();
        let forward = cast.inverse.cmpgt(DVec3::ZERO);
        let mut cell = self
            .index(cast.ray.at(t), per_length)
            .min(UVec3::splat(row - 1));
        let mut mailbox = Mailbox::new();
        loop {
            let (leaf, list) = self.locate(cell, count);
            count.cell();
            for &primitive in list {
                if mailbox.is_new(primitive) && search.test(primitive, count) {
                    return;
                }
            }
            // Faces ahead, and when the ray crosses their planes.
            let crosses = |axis: usize| {
                let ahead = leaf.first[axis] + if forward.test(axis) { leaf.width } else { 0 };
                (self.plane(axis, ahead, self.depth) - cast.ray.origin[axis]) * cast.inverse[axis]
            };
            let times = DVec3::new(crosses(0), crosses(1), crosses(2));
            let leaves = times.min_element();
            if search.limit() < leaves {
                return;
            }
            t = t.max(leaves);
            let last = leaf.first + (leaf.width - 1);
            let at = self
                .index(cast.ray.at(t), per_length)
                .clamp(leaf.first, last);
            for axis in 0..3 {
                if times[axis] > leaves {
                    // Not back either: the point may have been rounded.
                    cell[axis] = if forward.test(axis) {
                        at[axis].max(cell[axis])
                    } else {
                        at[axis].min(cell[axis])
                    };
                } else if forward.test(axis) {
                    cell[axis] = leaf.first[axis] + leaf.width;
                    if cell[axis] == row {
                        return;
                    }
                } else {
                    let Some(before) = leaf.first[axis].checked_sub(1) else {
                        return;
                    };
                    cell[axis] = before;
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.list.capacity() * size_of::<u32>()
    }

    /// Every primitive is listed once in every leaf that its box touches.
    fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String> {
        let boxes: Vec<Bounds> = (0..primitives.len() as u32)
            .map(|i| primitives.bounds(i))
            .collect();
        let root = Block {
            first: UVec3::ZERO,
            width: 1 << DEPTH,
        };
        let mut open: SmallVec<[(usize, Block); 64]> = SmallVec::from_slice(&[(0, root)]);
        while let Some((node, block)) = open.pop() {
            match self.nodes[node] {
                Node::Branch(first) => {
                    open.extend((0..8).map(|i| (first as usize + i as usize, block.child(i))));
                }
                Node::Leaf { first, count } => {
                    let listed = &self.list[first as usize..(first + count) as usize];
                    super::check_leaf(&self.space(&block, DEPTH), listed, &boxes)?;
                }
            }
        }
        super::check_root(&self.margin.root, &boxes)
    }
}
