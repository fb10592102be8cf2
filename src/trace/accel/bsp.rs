//! The lecture's BSP for ray tracing: the box of the scene is cut into two equal halves, again and
//! again, across x, y and z in turn.
//!
//! In: boxes of primitives. Out: a binary tree whose planes need not be stored, since they follow from
//! the way down; a leaf lists the primitives whose enlarged boxes ([`super::margin`]) touch it. The
//! walk keeps far halves on a stack, as in a kd-tree, together with their boxes.

use std::collections::VecDeque;

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

/// Halvings at most: twelve along each axis.
const DEPTH: u32 = 36;

/// Primitives in a leaf, unless room or depth runs out.
const LEAF: usize = 4;

/// Halvings in a row that leave every primitive on both sides, before one gives up.
const PATIENCE: u32 = 3;

#[derive(Clone, Copy, Debug)]
enum Node {
    /// The lower half's number; the upper half's is one more.
    Branch(u32),
    /// A range of the list.
    Leaf { first: u32, count: u32 },
}

/// A tree of halves.
#[derive(Clone, Debug)]
pub struct Bsp {
    margin: Margin,
    nodes: Vec<Node>,
    list: Vec<u32>,
    len: u32,
}

/// A space, and the axis across which it is cut next.
#[derive(Clone, Copy)]
struct Part {
    space: Bounds,
    axis: usize,
}

impl Part {
    /// The place of the plane.
    fn at(&self) -> f64 {
        let (low, high) = (self.space.min[self.axis], self.space.max[self.axis]);
        low + (high - low) * 0.5
    }

    fn halves(&self) -> [Self; 2] {
        super::halves(&self.space, self.axis, self.at()).map(|space| Self {
            space,
            axis: (self.axis + 1) % 3,
        })
    }
}

impl Bsp {
    /// Builds it, level by level, as long as there is room for its lists.
    pub fn new<P: Primitives>(primitives: &P) -> Self {
        let margin = Margin::new(primitives);
        let boxes = margin.boxes(primitives);
        let mut room = super::room(boxes.len());
        let mut tree = Self {
            margin,
            nodes: vec![Node::Leaf { first: 0, count: 0 }],
            list: Vec::new(),
            len: boxes.len() as u32,
        };
        let whole = Part {
            space: margin.root,
            axis: 0,
        };
        let everything: Vec<u32> = (0..tree.len).collect();
        let mut open = VecDeque::from([(0, whole, everything, 0, 0)]);
        while let Some((node, part, list, depth, vain)) = open.pop_front() {
            let lists = (list.len() > LEAF && depth < DEPTH && vain < PATIENCE)
                .then(|| super::share(&list, &boxes, part.axis, part.at()))
                .filter(|[low, high]| low.len() + high.len() <= list.len() + room);
            let Some(lists) = lists else {
                tree.nodes[node] = Node::Leaf {
                    first: tree.list.len() as u32,
                    count: list.len() as u32,
                };
                tree.list.extend(list);
                continue;
            };
            let entries = lists[0].len() + lists[1].len();
            room -= entries - list.len();
            let vain = if entries == 2 * list.len() {
                vain + 1
            } else {
                0
            };
            let child = tree.nodes.len();
            tree.nodes[node] = Node::Branch(child as u32);
            tree.nodes.extend([Node::Leaf { first: 0, count: 0 }; 2]);
            for (i, (part, list)) in part.halves().into_iter().zip(lists).enumerate() {
                open.push_back((child + i, part, list, depth + 1, vain));
            }
        }
        tree
    }
}

impl Walk for Bsp {
    fn walk<S: Search, C: Count>(&self, cast: &Cast, _: f64, search: &mut S, count: &mut C) {
        if !self.margin.covers(cast) {
            all(self.len, search, count);
            return;
        }
        let (mut near, mut far) = self.margin.interval(cast);
        if near > far || near > search.limit() {
            return;
        }
        let mut mailbox = Mailbox::new();
        let mut open: SmallVec<[(u32, Part, f64, f64); 16]> = SmallVec::new();
        let mut at = 0;
        let mut part = Part {
            space: self.margin.root,
            axis: 0,
        };
        loop {
            match self.nodes[at as usize] {
                Node::Branch(low) => {
                    count.node();
                    let axis = part.axis;
                    let t = (part.at() - cast.ray.origin[axis]) * cast.inverse[axis];
                    let forward = cast.inverse[axis] > 0.0;
                    // The half on the side from which the ray comes is met first.
                    let [first, second] = if forward { [0, 1] } else { [1, 0] };
                    let halves = part.halves();
                    if t <= near {
                        (at, part) = (low + second, halves[second as usize]);
                    } else if t >= far {
                        (at, part) = (low + first, halves[first as usize]);
                    } else {
                        open.push((low + second, halves[second as usize], t, far));
                        (at, part, far) = (low + first, halves[first as usize], t);
                    }
                    continue;
                }
                Node::Leaf { first, count: n } => {
                    count.cell();
                    for &primitive in &self.list[first as usize..(first + n) as usize] {
                        if mailbox.is_new(primitive) && search.test(primitive, count) {
                            return;
                        }
                    }
                }
            }
            let Some(next) = open.pop() else {
                return;
            };
            (at, part, near, far) = next;
            if search.limit() < near {
                return;
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
        let whole = Part {
            space: self.margin.root,
            axis: 0,
        };
        let mut open = vec![(0, whole)];
        while let Some((node, part)) = open.pop() {
            match self.nodes[node] {
                Node::Branch(low) => {
                    let [lower, upper] = part.halves();
                    open.extend([(low as usize, lower), (low as usize + 1, upper)]);
                }
                Node::Leaf { first, count } => {
                    let listed = &self.list[first as usize..(first + count) as usize];
                    super::check_leaf(&part.space, listed, &boxes)?;
                }
            }
        }
        super::check_root(&self.margin.root, &boxes)
    }
}
