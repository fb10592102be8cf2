//! The shortest way from one cell to another.
//!
//! Source: Cui, Harabor, Grastien, "Compromise-free pathfinding on a navigation mesh" (Polyanya),
//! 2017. A node is an interval of a portal that is seen in full from its root, the last bend of the
//! way; behind it, what the root sees of the next portals keeps the root, and what it does not see
//! begins anew at the interval's end, if a wall stands there. The first node taken from the queue
//! that reaches the goal gives the shortest way.
//!
//! Intervals are bounded by lines through exact points, so every side is decided exactly and no way
//! is lost; lengths are f64. Of two ways whose lengths differ by rounding alone, either may come out.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::corner::{Corner, corner_at};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Side, Vertex, VertexId, orient};

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

/// A corner of a cell.
#[derive(Clone, Copy)]
struct Turn {
    id: VertexId,
    exact: Vertex,
    at: DVec2,
    /// Whether a way can bend about it.
    juts: bool,
}

/// One border of what is seen through a portal: a directed line from the root outwards.
#[derive(Clone, Copy)]
struct Border {
    /// `None` where the root is the portal's end on this side: nothing is out of sight there.
    line: Option<(Vertex, Vertex)>,
    /// The portal's end, if the line goes through it and a way can bend about it.
    bend: Option<Turn>,
    /// Where the line meets the portal, for the least length of a way through it.
    at: DVec2,
}

/// The last bend of a way, or its start.
#[derive(Clone, Copy)]
struct Root {
    exact: Vertex,
    at: DVec2,
    id: Option<VertexId>,
    /// The bend before it.
    before: Option<VertexId>,
    /// Length of the way up to here.
    length: f64,
}

/// An interval of a portal, as seen from its root.
#[derive(Clone, Copy)]
struct Node {
    root: Root,
    /// The portal, as an edge of the cell that is left.
    portal: EdgeId,
    right: Border,
    left: Border,
    parent: u32,
}

/// What waits in the queue, by the least length of a way through it.
#[derive(Clone, Copy)]
struct Entry {
    length: f64,
    node: u32,
    what: What,
}

#[derive(Clone, Copy)]
enum What {
    /// A node to be expanded.
    Node,
    /// A whole way that ends behind the node, straight or with a last bend.
    Way(Option<VertexId>),
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
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
    goal: (CellId, Vertex),
    nodes: Vec<Node>,
    queue: BinaryHeap<Entry>,
    /// The length of the shortest way to each bend so far, and the bend before. Of ways of the same
    /// length, as there are along corners in line, one is enough.
    reached: FxHashMap<VertexId, (f64, Option<VertexId>)>,
}

/// The shortest way from a point in a cell to a point in another; `None` where no way leads there.
pub fn shortest(
    graph: &CellGraph,
    (cell, start): (CellId, Vertex),
    goal: (CellId, Vertex),
) -> Option<Way> {
    let mut search = Search {
        graph,
        goal,
        nodes: Vec::new(),
        queue: BinaryHeap::new(),
        reached: FxHashMap::default(),
    };
    let root = Root {
        exact: start,
        at: start.approx(),
        id: None,
        before: None,
        length: 0.0,
    };
    if cell == goal.0 {
        let points = vec![root.at, goal.1.approx()];
        return Some(Way {
            portals: Vec::new(),
            bends: Vec::new(),
            length: points[0].distance(points[1]),
            points,
        });
    }
    for portal in graph.edge_range(cell).map(EdgeId) {
        if graph.edge(portal).twin().is_some() {
            let ends = [search.turn(portal), search.turn(graph.next(portal))];
            // A start on the portal sees all beyond it.
            let inside = orient(&start, &ends[0].exact, &ends[1].exact) == Side::Left;
            let [right, left] = ends.map(|end| Border {
                line: inside.then_some((start, end.exact)),
                ..Border::at_end(&root, end)
            });
            search.push(Node {
                root,
                portal,
                right,
                left,
                parent: NO_PARENT,
            });
        }
    }
    while let Some(entry) = search.queue.pop() {
        match entry.what {
            What::Way(bend) => return Some(search.way(root.at, &entry, bend)),
            What::Node => search.expand(entry.node),
        }
    }
    None
}

impl Border {
    /// Through the end of a portal.
    fn at_end(root: &Root, end: Turn) -> Self {
        let apart = root.id != Some(end.id);
        Border {
            line: apart.then_some((root.exact, end.exact)),
            bend: (apart && end.juts).then_some(end),
            at: end.at,
        }
    }

    /// On which side of the border a point lies; on neither if there is none.
    fn side(&self, p: &Vertex) -> Option<Side> {
        self.line.map(|(from, to)| orient(&from, &to, p))
    }

    /// The same line where it crosses the next portal.
    fn further(&self, right: &Turn, left: &Turn) -> Self {
        let at = self.line.map(|(from, to)| {
            let (from, to) = (from.approx(), to.approx());
            let [f, g] = [right.at, left.at].map(|p| (to - from).perp_dot(p - from));
            let share = if f == g { 0.0 } else { f / (f - g) };
            right.at.lerp(left.at, share.clamp(0.0, 1.0))
        });
        Border {
            line: self.line,
            bend: None,
            at: at.unwrap_or(right.at),
        }
    }
}

impl Search<'_> {
    /// The corner in which an edge starts.
    fn turn(&self, edge: EdgeId) -> Turn {
        let id = self.graph.edge(edge).origin;
        Turn {
            id,
            exact: *self.graph.vertices.exact(id),
            at: self.graph.vertices.approx(id),
            juts: corner_at(self.graph, edge) == Corner::Jutting,
        }
    }

    fn push(&mut self, node: Node) {
        let root = &node.root;
        if let Some(id) = root.id {
            let this = (root.length, root.before);
            let known = self.reached.entry(id).or_insert(this);
            if root.length < known.0 {
                *known = this;
            } else if *known != this {
                return;
            }
        }
        let ends = [node.left.at, node.right.at];
        self.queue.push(Entry {
            length: root.length + through(root.at, ends, self.goal.1.approx()),
            node: self.nodes.len() as u32,
            what: What::Node,
        });
        self.nodes.push(node);
    }

    /// What lies behind a node.
    fn expand(&mut self, index: u32) {
        let node = self.nodes[index as usize];
        if let Some(id) = node.root.id
            && self.reached.get(&id) != Some(&(node.root.length, node.root.before))
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
        let mut right = self.turn(edge);
        while edge != entry {
            let left = self.turn(graph.next(edge));
            if graph.edge(edge).twin().is_some() {
                self.pass(index, &node, edge, right, left);
            }
            right = left;
            edge = graph.next(edge);
        }
    }

    /// The parts of a portal that are seen from the node's root through its interval, and those that
    /// are not: there the way bends at the interval's end.
    fn pass(&mut self, index: u32, node: &Node, portal: EdgeId, right: Turn, left: Turn) {
        let child = |root: Root, right: Border, left: Border| Node {
            root,
            portal,
            right,
            left,
            parent: index,
        };
        let bent = |at: &Turn| Root {
            exact: at.exact,
            at: at.at,
            id: Some(at.id),
            before: node.root.id,
            length: node.root.length + node.root.at.distance(at.at),
        };
        let cut_right = node.right.side(&right.exact) == Some(Side::Right);
        let cut_left = node.left.side(&left.exact) == Some(Side::Left);
        let beyond_right = node
            .right
            .side(&left.exact)
            .is_some_and(|s| s != Side::Left);
        let beyond_left = node
            .left
            .side(&right.exact)
            .is_some_and(|s| s != Side::Right);
        if (cut_right || beyond_right)
            && let Some(bend) = &node.right.bend
        {
            let root = bent(bend);
            let border = if beyond_right {
                Border::at_end(&root, left)
            } else {
                node.right.further(&right, &left)
            };
            self.push(child(root, Border::at_end(&root, right), border));
        }
        if (cut_left || beyond_left)
            && let Some(bend) = &node.left.bend
        {
            let root = bent(bend);
            let border = if beyond_left {
                Border::at_end(&root, right)
            } else {
                node.left.further(&right, &left)
            };
            self.push(child(root, border, Border::at_end(&root, left)));
        }
        if !beyond_right && !beyond_left {
            let border = |border: &Border, cut: bool, end: Turn| {
                if cut {
                    border.further(&right, &left)
                } else {
                    Border::at_end(&node.root, end)
                }
            };
            self.push(child(
                node.root,
                border(&node.right, cut_right, right),
                border(&node.left, cut_left, left),
            ));
        }
    }

    /// The goal lies in the cell behind the node.
    fn finish(&mut self, index: u32, node: &Node) {
        let (goal, at) = (self.goal.1, self.goal.1.approx());
        let bend = if node.right.side(&goal) == Some(Side::Right) {
            Some(node.right.bend)
        } else if node.left.side(&goal) == Some(Side::Left) {
            Some(node.left.bend)
        } else {
            None
        };
        let root = &node.root;
        let (length, last) = match bend {
            None => (root.at.distance(at), None),
            // Not to be seen, and no corner to go around.
            Some(None) => return,
            Some(Some(bend)) => (
                root.at.distance(bend.at) + bend.at.distance(at),
                Some(bend.id),
            ),
        };
        self.queue.push(Entry {
            length: root.length + length,
            node: index,
            what: What::Way(last),
        });
    }

    fn way(&self, start: DVec2, entry: &Entry, last_bend: Option<VertexId>) -> Way {
        let mut portals = Vec::new();
        let mut bends: Vec<VertexId> = last_bend.into_iter().collect();
        let mut index = entry.node;
        while index != NO_PARENT {
            let node = &self.nodes[index as usize];
            portals.push(node.portal);
            if let Some(id) = node.root.id.filter(|id| bends.last() != Some(id)) {
                bends.push(id);
            }
            index = node.parent;
        }
        portals.reverse();
        bends.reverse();
        let between = bends.iter().map(|&v| self.graph.vertices.approx(v));
        Way {
            points: [start]
                .into_iter()
                .chain(between)
                .chain([self.goal.1.approx()])
                .collect(),
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
