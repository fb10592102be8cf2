//! The kd-tree.
//!
//! In: boxes of primitives. Out: a binary tree of planes across the axes; a leaf lists the primitives
//! whose enlarged boxes ([`super::margin`]) touch it. Where the planes are put: [`split`]. How a ray
//! finds the next leaf: [`walk`].

mod split;
mod walk;

use std::collections::VecDeque;

use super::Walk;
use super::bounds::Bounds;
use super::brute::all;
use super::cast::Cast;
use super::count::Count;
use super::margin::Margin;
use super::primitives::Primitives;
use super::search::Search;

/// Where planes are put.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Split {
    /// The lecture's heuristic: through the middle object, along the axis of the best balance.
    Balance,
    /// Where the expected cost by surface areas is least (MacDonald and Booth, 1990).
    Area,
}

/// How the next leaf is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KdWalk {
    /// Far children wait on a stack.
    Stack,
    /// Back to the root, the interval beginning where the leaf ended (Foley and Sugerman, 2005).
    Restart,
    /// Up by parent links, to the nearest ancestor that the rest of the interval meets.
    Backtrack,
}

/// A node of 16 bytes.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Where the plane is; of no meaning in a leaf.
    at: f64,
    /// Children stand side by side, or primitives in the list.
    first: u32,
    /// 0, 1, 2: the axis that the plane is across. From 3 on a leaf, of so many primitives more.
    tag: u32,
}

impl Node {
    const LEAF: u32 = 3;

    fn leaf(first: usize, count: usize) -> Self {
        Self {
            at: 0.0,
            first: first as u32,
            tag: Self::LEAF + count as u32,
        }
    }
}

/// A kd-tree.
#[derive(Clone, Debug)]
pub struct Kd {
    margin: Margin,
    walk: KdWalk,
    nodes: Vec<Node>,
    list: Vec<u32>,
    /// For backtracking only: the space and the parent of each node.
    upward: Vec<(Bounds, u32)>,
    len: u32,
}

impl Kd {
    /// Builds it, level by level, as long as there is room for its lists.
    pub fn new<P: Primitives>(primitives: &P, split: Split, walk: KdWalk) -> Self {
        let margin = Margin::new(primitives);
        let boxes = margin.boxes(primitives);
        let len = boxes.len();
        let mut tree = Self {
            margin,
            walk,
            nodes: vec![Node::leaf(0, 0)],
            list: Vec::new(),
            upward: Vec::new(),
            len: len as u32,
        };
        if walk == KdWalk::Backtrack {
            tree.upward.push((margin.root, 0));
        }
        let deepest = 8 + (1.3 * (len.max(1) as f64).log2()) as u32;
        let mut room = super::room(len);
        let everything: Vec<u32> = (0..len as u32).collect();
        let mut open = VecDeque::from([(0, margin.root, everything, 0)]);
        while let Some((node, space, list, depth)) = open.pop_front() {
            let cut = (depth < deepest)
                .then(|| split.choose(&space, &list, &boxes))
                .flatten()
                .map(|(axis, at)| (axis, at, super::share(&list, &boxes, axis, at)))
                .filter(|(_, _, [low, high])| low.len() + high.len() <= list.len() + room);
            let Some((axis, at, lists)) = cut else {
                tree.nodes[node] = Node::leaf(tree.list.len(), list.len());
                tree.list.extend(list);
                continue;
            };
            room -= lists[0].len() + lists[1].len() - list.len();
            let child = tree.nodes.len();
            tree.nodes[node] = Node {
                at,
                first: child as u32,
                tag: axis as u32,
            };
            tree.nodes.extend([Node::leaf(0, 0); 2]);
            let spaces = super::halves(&space, axis, at);
            if walk == KdWalk::Backtrack {
                tree.upward.extend(spaces.map(|s| (s, node as u32)));
            }
            for (i, (space, list)) in spaces.into_iter().zip(lists).enumerate() {
                open.push_back((child + i, space, list, depth + 1));
            }
        }
        tree
    }

    fn leaf(&self, node: &Node) -> &[u32] {
        let first = node.first as usize;
        &self.list[first..first + (node.tag - Node::LEAF) as usize]
    }
}

impl Walk for Kd {
    fn walk<S: Search, C: Count>(&self, cast: &Cast, _: f64, search: &mut S, count: &mut C) {
        if !self.margin.covers(cast) {
            all(self.len, search, count);
            return;
        }
        let (near, far) = self.margin.interval(cast);
        if near > far || near > search.limit() {
            return;
        }
        match self.walk {
            KdWalk::Stack => walk::stack(self, cast, (near, far), search, count),
            KdWalk::Restart => walk::restart(self, cast, (near, far), search, count),
            KdWalk::Backtrack => walk::backtrack(self, cast, (near, far), search, count),
        }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.nodes.capacity() * size_of::<Node>()
            + self.list.capacity() * size_of::<u32>()
            + self.upward.capacity() * size_of::<(Bounds, u32)>()
    }

    /// Every primitive is listed once in every leaf that its box touches; planes lie in the space
    /// that they cut; upward links lead to the parent.
    fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String> {
        let boxes: Vec<Bounds> = (0..primitives.len() as u32)
            .map(|i| primitives.bounds(i))
            .collect();
        let mut open = vec![(0, self.margin.root, 0)];
        while let Some((i, space, parent)) = open.pop() {
            let node = &self.nodes[i];
            if self.walk == KdWalk::Backtrack && self.upward[i] != (space, parent) {
                return Err(format!("node {i} has a wrong space or parent"));
            }
            if node.tag >= Node::LEAF {
                super::check_leaf(&space, self.leaf(node), &boxes)?;
                continue;
            }
            let axis = node.tag as usize;
            if !(space.min[axis]..=space.max[axis]).contains(&node.at) {
                return Err(format!("the plane of node {i} misses it"));
            }
            let [low, high] = super::halves(&space, axis, node.at);
            open.push((node.first as usize, low, i as u32));
            open.push((node.first as usize + 1, high, i as u32));
        }
        super::check_root(&self.margin.root, &boxes)
    }
}
