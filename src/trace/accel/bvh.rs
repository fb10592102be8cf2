//! Hierarchies of bounding volumes.
//!
//! In: boxes of primitives. Out: a binary tree in which every node has a volume around all that is
//! beneath. Two ways to build it ([`median`], [`insertion`]) and three kinds of volume ([`volume`])
//! are combined freely. A ray looks at both children of a node, goes on with the nearer, and comes
//! back for the other unless something nearer was found.

mod insertion;
mod median;
pub mod volume;

use smallvec::SmallVec;

use super::Walk;
use super::bounds::Bounds;
use super::cast::Cast;
use super::count::Count;
use super::primitives::Primitives;
use super::search::Search;
use volume::Volume;

/// Primitives in a leaf of the median cut at most.
const LEAF: usize = 4;

/// How a tree is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Build {
    /// Top down, by halving the list along its widest slab.
    MedianCut,
    /// Bottom up, object by object, where the area increases least.
    Insertion,
}

/// Children and leaves, without volumes. Children stand side by side, after their parent.
struct Topology {
    /// For each node, where its children or its primitives begin, and how many primitives it has;
    /// none: it is a branch.
    nodes: Vec<(u32, u32)>,
    /// Primitives, leaf by leaf.
    order: Vec<u32>,
}

impl Topology {
    /// A root that is still nothing.
    fn new(order: Vec<u32>) -> Self {
        Self {
            nodes: vec![(0, 0)],
            order,
        }
    }

    fn set_leaf(&mut self, node: usize, first: usize, end: usize) {
        self.nodes[node] = (first as u32, (end - first) as u32);
    }

    /// Makes the node a branch; returns the first of its two new children.
    fn split(&mut self, node: usize) -> usize {
        let child = self.nodes.len();
        self.nodes[node] = (child as u32, 0);
        self.nodes.extend([(0, 0); 2]);
        child
    }

    #[cfg(test)]
    fn depth(&self) -> usize {
        let mut depth = vec![1; self.nodes.len()];
        for (i, &(first, count)) in self.nodes.iter().enumerate() {
            if count == 0 && first as usize > i {
                depth[first as usize] = depth[i] + 1;
                depth[first as usize + 1] = depth[i] + 1;
            }
        }
        depth.into_iter().max().unwrap_or(0)
    }
}

#[derive(Clone, Copy, Debug)]
struct Node<V> {
    volume: V,
    /// The first child, or the first primitive in the order.
    first: u32,
    /// Primitives; none in a branch.
    count: u32,
}

/// A hierarchy of volumes `V`. Without nodes if there is no primitive.
#[derive(Clone, Debug)]
pub struct Bvh<V> {
    nodes: Vec<Node<V>>,
    order: Vec<u32>,
}

impl<V: Volume> Bvh<V> {
    /// Builds it.
    pub fn new<P: Primitives>(primitives: &P, build: Build) -> Self {
        let boxes: Vec<Bounds> = (0..primitives.len() as u32)
            .map(|i| primitives.bounds(i))
            .collect();
        if boxes.is_empty() {
            return Self {
                nodes: Vec::new(),
                order: Vec::new(),
            };
        }
        let tree = match build {
            Build::MedianCut => median::median_cut(&boxes, V::SLABS),
            Build::Insertion => insertion::insert_all(&boxes),
        };
        Self {
            nodes: fit(&tree, &boxes),
            order: tree.order,
        }
    }

    fn children(&self, node: &Node<V>) -> [&Node<V>; 2] {
        let first = node.first as usize;
        [&self.nodes[first], &self.nodes[first + 1]]
    }

    fn leaf(&self, node: &Node<V>) -> &[u32] {
        let first = node.first as usize;
        &self.order[first..first + node.count as usize]
    }
}

/// Finds the volumes, from the leaves upwards.
fn fit<V: Volume>(tree: &Topology, boxes: &[Bounds]) -> Vec<Node<V>> {
    let mut fitted: Vec<Option<(Bounds, V)>> = vec![None; tree.nodes.len()];
    for (i, &(first, count)) in tree.nodes.iter().enumerate().rev() {
        let join = |a: (Bounds, V), b: (Bounds, V)| {
            let whole = a.0.union(&b.0);
            (whole, a.1.join(&b.1, &whole))
        };
        let first = first as usize;
        fitted[i] = if count == 0 {
            fitted[first]
                .zip(fitted[first + 1])
                .map(|(a, b)| join(a, b))
        } else {
            tree.order[first..first + count as usize]
                .iter()
                .map(|&p| (boxes[p as usize], V::around(&boxes[p as usize])))
                .reduce(join)
        };
    }
    tree.nodes
        .iter()
        .zip(fitted)
        .filter_map(|(&(first, count), fitted)| {
            fitted.map(|(_, volume)| Node {
                volume,
                first,
                count,
            })
        })
        .collect()
}

impl<V: Volume> Walk for Bvh<V> {
    fn walk<S: Search, C: Count>(&self, cast: &Cast, slack: f64, search: &mut S, count: &mut C) {
        let Some(mut node) = self.nodes.first() else {
            return;
        };
        let ray = V::prepare(cast, slack);
        count.node();
        let (near, far) = node.volume.interval(&ray);
        if near > far || near > search.limit() {
            return;
        }
        // Nodes to come back to, and when the ray enters them.
        let mut open: SmallVec<[(f64, &Node<V>); 32]> = SmallVec::new();
        loop {
            if node.count > 0 {
                count.cell();
                for &primitive in self.leaf(node) {
                    if search.test(primitive, count) {
                        return;
                    }
                }
            } else {
                let [a, b] = self.children(node);
                count.node();
                count.node();
                let (a_near, a_far) = a.volume.interval(&ray);
                let (b_near, b_far) = b.volume.interval(&ray);
                let limit = search.limit();
                let enters_a = a_near <= a_far && a_near <= limit;
                let enters_b = b_near <= b_far && b_near <= limit;
                if enters_a && enters_b {
                    node = if a_near <= b_near {
                        open.push((b_near, b));
                        a
                    } else {
                        open.push((a_near, a));
                        b
                    };
                    continue;
                } else if enters_a {
                    node = a;
                    continue;
                } else if enters_b {
                    node = b;
                    continue;
                }
            }
            loop {
                let Some((near, next)) = open.pop() else {
                    return;
                };
                if near <= search.limit() {
                    node = next;
                    break;
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.nodes.capacity() * size_of::<Node<V>>()
            + self.order.capacity() * size_of::<u32>()
    }

    /// Every primitive is in one leaf, and in the volume of every node above it.
    fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String> {
        let mut seen = vec![false; primitives.len()];
        let mut parents = vec![None; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            if node.count == 0 {
                for child in [node.first as usize, node.first as usize + 1] {
                    if child <= i || child >= self.nodes.len() || parents[child].is_some() {
                        return Err(format!("node {i} cannot have node {child} as child"));
                    }
                    parents[child] = Some(i);
                }
                continue;
            }
            for &primitive in self.leaf(node) {
                if std::mem::replace(&mut seen[primitive as usize], true) {
                    return Err(format!("primitive {primitive} is in two leaves"));
                }
                let bounds = primitives.bounds(primitive);
                let mut above = Some(i);
                while let Some(j) = above {
                    if !self.nodes[j].volume.holds(&bounds) {
                        return Err(format!("primitive {primitive} sticks out of node {j}"));
                    }
                    above = parents[j];
                }
            }
        }
        match seen.iter().position(|s| !s) {
            Some(primitive) => Err(format!("primitive {primitive} is in no leaf")),
            None => Ok(()),
        }
    }
}
