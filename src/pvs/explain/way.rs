//! The shortest way on foot from one cell to another.
//!
//! Source: Cui, Harabor, Grastien, "Compromise-free pathfinding on a navigation mesh" (Polyanya),
//! 2017. A node is an interval of a portal that is seen in full from its root, the last bend of the
//! way; behind it, what the root sees of the next portals keeps the root, and what it does not see
//! begins anew at the interval's end, if a wall stands there. The first node taken from the queue
//! that reaches the goal gives the shortest way. In f64: the way is shown, and nothing about sight
//! follows from it. Two ways whose lengths differ by rounding alone may change places.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::corner::{Corner, corner_at};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::VertexId;

/// A way through portals.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// The portals, as edges of the cells that are left.
    pub portals: Vec<EdgeId>,
    /// The corners about which the shortest way through them bends.
    pub bends: Vec<VertexId>,
    /// Its start, bends and end, in grid steps.
    pub points: Vec<DVec2>,
    /// Its length in grid steps.
    pub length: f64,
}

/// One end of an interval.
#[derive(Clone, Copy)]
struct End {
    at: DVec2,
    /// The vertex there, if it is one about which a way can bend.
    bend: Option<VertexId>,
}

/// An interval of a portal, as seen from its root.
#[derive(Clone, Copy)]
struct Node {
    root: DVec2,
    /// The root, unless it is the start, and the bend before it.
    bend: Option<VertexId>,
    before: Option<VertexId>,
    /// Length of the way to the root.
    length: f64,
    /// The portal, as an edge of the cell that is left.
    portal: EdgeId,
    left: End,
    right: End,
    parent: u32,
}

/// A node, or the goal behind one, by the least length of a way through it.
#[derive(Clone, Copy, PartialEq)]
struct Entry {
    length: f64,
    node: u32,
    /// The bends between the node's root and the goal are known: this is a finished way.
    finished: Option<Option<VertexId>>,
}

impl Eq for Entry {}

impl Ord for Entry {
    // The shortest comes first; of several, the one found first.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_length = other.length.total_cmp(&self.length);
        by_length.then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

const NO_PARENT: u32 = u32::MAX;

struct Search<'a> {
    graph: &'a CellGraph,
    goal: (CellId, DVec2),
    nodes: Vec<Node>,
    queue: BinaryHeap<Entry>,
    /// The length of the shortest way to each bend so far, and the bend before. Of ways of the same
    /// length, as there are along corners in line, one is enough.
    reached: FxHashMap<VertexId, (f64, Option<VertexId>)>,
}

/// The shortest way from a point in a cell to a point in another; `None` where no way leads there.
pub fn shortest(graph: &CellGraph, start: (CellId, DVec2), goal: (CellId, DVec2)) -> Option<Way> {
    let mut search = Search {
        graph,
        goal,
        nodes: Vec::new(),
        queue: BinaryHeap::new(),
        reached: FxHashMap::default(),
    };
    let (cell, root) = start;
    if cell == goal.0 {
        return Some(Way {
            portals: Vec::new(),
            bends: Vec::new(),
            points: vec![root, goal.1],
            length: root.distance(goal.1),
        });
    }
    for portal in graph.edge_range(cell).map(EdgeId) {
        if graph.edge(portal).twin().is_some() {
            search.push(Node {
                root,
                bend: None,
                before: None,
                length: 0.0,
                portal,
                left: search.end_of(portal),
                right: search.origin_of(portal),
                parent: NO_PARENT,
            });
        }
    }
    while let Some(entry) = search.queue.pop() {
        match entry.finished {
            Some(bend) => return Some(search.way(root, entry, bend)),
            None => search.expand(entry.node),
        }
    }
    None
}

impl Search<'_> {
    /// An edge's end, seen from its cell: on the left hand.
    fn end_of(&self, edge: EdgeId) -> End {
        self.origin_of(self.graph.next(edge))
    }

    fn origin_of(&self, edge: EdgeId) -> End {
        let vertex = self.graph.edge(edge).origin;
        let jutting = corner_at(self.graph, edge) == Corner::Jutting;
        End {
            at: self.graph.vertices.approx(vertex),
            bend: jutting.then_some(vertex),
        }
    }

    fn push(&mut self, node: Node) {
        if node.left.at == node.right.at {
            return;
        }
        if let Some(bend) = node.bend {
            let this = (node.length, node.before);
            let known = self.reached.entry(bend).or_insert(this);
            if node.length < known.0 {
                *known = this;
            } else if *known != this {
                return;
            }
        }
        self.queue.push(Entry {
            length: node.length + through(node.root, [node.left.at, node.right.at], self.goal.1),
            node: self.nodes.len() as u32,
            finished: None,
        });
        self.nodes.push(node);
    }

    /// What lies behind a node.
    fn expand(&mut self, index: u32) {
        let node = self.nodes[index as usize];
        if let Some(bend) = node.bend
            && self.reached.get(&bend) != Some(&(node.length, node.before))
        {
            return;
        }
        let graph = self.graph;
        let Some(entry) = graph.edge(node.portal).twin() else {
            return;
        };
        if graph.edge(entry).cell == self.goal.0 {
            self.finish(index, &node);
            return;
        }
        // Counterclockwise from the portal's right end to its left end.
        let mut edge = graph.next(entry);
        let mut from = self.origin_of(edge);
        while edge != entry {
            let to = self.end_of(edge);
            if graph.edge(edge).twin().is_some() {
                self.pass(index, &node, edge, from, to);
            }
            from = to;
            edge = graph.next(edge);
        }
    }

    /// The parts of a portal that are seen from the node's root through its interval, and those that
    /// are not: there the way bends at the interval's end.
    fn pass(&mut self, index: u32, node: &Node, portal: EdgeId, right: End, left: End) {
        let next = |root: DVec2, [bend, before]: [_; 2], length, [right, left]: [End; 2]| Node {
            root,
            bend,
            before,
            length,
            portal,
            left,
            right,
            parent: index,
        };
        // How far along the edge the two lines of sight cut it; both 0 or both 1 if beside it.
        let cut = |end: End| {
            let ray = end.at - node.root;
            let (f, g) = (
                ray.perp_dot(right.at - node.root),
                ray.perp_dot(left.at - node.root),
            );
            if f >= 0.0 && g >= 0.0 {
                0.0
            } else if f <= 0.0 && g <= 0.0 {
                1.0
            } else {
                f / (f - g)
            }
        };
        // A root in the interval's end sees all on its own side.
        let low = if node.root == node.right.at {
            0.0
        } else {
            cut(node.right)
        };
        let high = if node.root == node.left.at {
            1.0
        } else {
            cut(node.left)
        };
        let at = |t: f64| match t {
            0.0 => right,
            1.0 => left,
            t => End {
                at: right.at.lerp(left.at, t),
                bend: None,
            },
        };
        let mut bent = |end: End, part: [End; 2]| {
            if let Some(bend) = end.bend
                && end.at != node.root
            {
                let length = node.length + node.root.distance(end.at);
                self.push(next(end.at, [Some(bend), node.bend], length, part));
            }
        };
        if low > 0.0 {
            bent(node.right, [right, at(low)]);
        }
        if high < 1.0 {
            bent(node.left, [at(high), left]);
        }
        if low < high {
            let bends = [node.bend, node.before];
            self.push(next(node.root, bends, node.length, [at(low), at(high)]));
        }
    }

    /// The goal lies in the cell behind the node.
    fn finish(&mut self, index: u32, node: &Node) {
        let goal = self.goal.1;
        let beyond = |end: End| (end.at - node.root).perp_dot(goal - node.root);
        let bend = if node.root != node.right.at && beyond(node.right) < 0.0 {
            node.right
        } else if node.root != node.left.at && beyond(node.left) > 0.0 {
            node.left
        } else {
            let length = node.length + node.root.distance(goal);
            self.queue.push(Entry {
                length,
                node: index,
                finished: Some(None),
            });
            return;
        };
        if let Some(vertex) = bend.bend {
            let length = node.length + node.root.distance(bend.at) + bend.at.distance(goal);
            self.queue.push(Entry {
                length,
                node: index,
                finished: Some(Some(vertex)),
            });
        }
    }

    fn way(&self, start: DVec2, entry: Entry, last_bend: Option<VertexId>) -> Way {
        let mut portals = Vec::new();
        let mut bends: Vec<VertexId> = last_bend.into_iter().collect();
        let mut index = entry.node;
        while index != NO_PARENT {
            let node = &self.nodes[index as usize];
            portals.push(node.portal);
            if let Some(bend) = node.bend.filter(|b| bends.last() != Some(b)) {
                bends.push(bend);
            }
            index = node.parent;
        }
        portals.reverse();
        bends.reverse();
        let at = bends.iter().map(|&v| self.graph.vertices.approx(v));
        Way {
            points: [start].into_iter().chain(at).chain([self.goal.1]).collect(),
            portals,
            bends,
            length: entry.length,
        }
    }
}

/// The least length of a way from `root` through the interval to `goal`, whatever else stands there.
fn through(root: DVec2, [left, right]: [DVec2; 2], goal: DVec2) -> f64 {
    let along = left - right;
    let side = |p: DVec2| along.perp_dot(p - right);
    let (f, mut g) = (side(root), side(goal));
    let mut goal = goal;
    if (f > 0.0) == (g > 0.0) {
        // On the same side: as far as to its mirror image.
        goal -= along.perp() * (2.0 * g / along.length_squared());
        g = -g;
    }
    let t = if f == g { 0.0 } else { f / (f - g) };
    let crossing = root.lerp(goal, t);
    let part = (crossing - right).dot(along) / along.length_squared();
    if part <= 0.0 {
        root.distance(right) + right.distance(goal)
    } else if part >= 1.0 {
        root.distance(left) + left.distance(goal)
    } else {
        root.distance(goal)
    }
}
