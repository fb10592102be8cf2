//! The shortest way from one cell to another.
//!
//! In: a [`CellGraph`], and a point in each of two cells. Out: the [`Way`], or `None` where no way
//! leads. A shortest way is straight but for corners that jut into the room, so it is sought by A*
//! over those (Hart, Nilsson, Raphael 1968): from the start, and from each corner that is taken from
//! the queue, the cells are searched through portals for the corners in sight, as the funnel of
//! Guibas and Hershberger does along one chain. Touching a wall is allowed.
//!
//! Sight is bounded by lines through exact points, so every side is decided exactly and no way is
//! lost; lengths are f64. Of two ways whose lengths differ by rounding alone, either may come out.
//! A vertex where walls meet may jut into several rooms. Each side of it is a corner of its own, or
//! a way would slip through between two walls that touch.
//!
//! O(c · p) for c corners nearer than the goal, p portals in sight of one.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::corner::{Corner, corner_at};
use super::last_cell;
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

/// A place where a way can bend or end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Stop {
    /// The start of the way.
    Start,
    /// A corner: the first of the edges that start there, counterclockwise from the wall on its
    /// right.
    Corner(EdgeId),
    /// The end of the way.
    Goal,
}

/// The shortest way to a stop so far.
#[derive(Clone, Debug)]
struct Reached {
    length: f64,
    /// The stop before it.
    before: Stop,
    /// The cell of the stop before in which the last leg starts.
    from: CellId,
    /// Portals of the last leg.
    portals: Vec<EdgeId>,
    /// Whether it is final.
    done: bool,
}

/// What waits in the queue, by the least length of a way through it.
#[derive(Clone, Copy, PartialEq)]
struct Waiting {
    least: f64,
    /// For the order of equals.
    number: usize,
    stop: Stop,
}

impl Eq for Waiting {}

impl Ord for Waiting {
    // The shortest comes first; of several, the one found first.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_length = other.least.total_cmp(&self.least);
        by_length.then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// What is seen through a portal from the root of a leg.
#[derive(Clone, Copy)]
struct View {
    /// The portal, as an edge of the cell that is left.
    portal: EdgeId,
    /// Vertices on the borders of what is seen, outwards.
    right: VertexId,
    left: VertexId,
    /// The view before it.
    parent: Option<usize>,
}

struct Search<'a> {
    graph: &'a CellGraph,
    start: Vertex,
    goal: Vertex,
    /// The cells that the goal touches, each with the portals from there to the goal's own cell.
    goals: FxHashMap<CellId, Vec<EdgeId>>,
    reached: FxHashMap<Stop, Reached>,
    /// What is known of corners, by edge: whether one juts where the edge starts, and which.
    corners: Vec<Option<Option<Stop>>>,
    queue: BinaryHeap<Waiting>,
    pushed: usize,
}

/// The shortest way from a point in a cell to a point in another; `None` where no way leads there.
pub fn shortest(
    graph: &CellGraph,
    (cell, start): (CellId, Vertex),
    (goal_cell, goal): (CellId, Vertex),
) -> Option<Way> {
    let back = |(cell, mut portals): (CellId, Vec<EdgeId>)| {
        // From the goal outwards; the way runs the other way.
        portals.reverse();
        let turned = portals.iter().filter_map(|&p| graph.edge(p).twin());
        (cell, turned.collect())
    };
    let mut search = Search {
        graph,
        start,
        goal,
        goals: touched(graph, goal_cell, &goal)
            .into_iter()
            .map(back)
            .collect(),
        reached: FxHashMap::default(),
        corners: vec![None; graph.edges.len()],
        queue: BinaryHeap::new(),
        pushed: 0,
    };
    let starts = touched(graph, cell, &start);
    for (cell, portals) in &starts {
        search.leg(Stop::Start, *cell, portals);
    }
    while let Some(Waiting { stop, .. }) = search.queue.pop() {
        let edge = match stop {
            Stop::Goal => return Some(search.way(cell)),
            Stop::Start => continue,
            Stop::Corner(edge) => edge,
        };
        let known = search.reached.get_mut(&stop);
        if known.is_some_and(|known| !std::mem::replace(&mut known.done, true)) {
            for edge in around(graph, edge) {
                search.leg(stop, graph.edge(edge).cell, &[]);
            }
        }
    }
    None
}

impl Search<'_> {
    fn exact(&self, stop: Stop) -> &Vertex {
        match stop {
            Stop::Start => &self.start,
            Stop::Goal => &self.goal,
            Stop::Corner(edge) => self.graph.vertices.exact(self.graph.edge(edge).origin),
        }
    }

    fn at(&self, stop: Stop) -> DVec2 {
        match stop {
            Stop::Corner(edge) => self.graph.vertices.approx(self.graph.edge(edge).origin),
            _ => self.exact(stop).approx(),
        }
    }

    /// Everything that is seen from a stop through one of the cells that it touches: corners, and
    /// perhaps the goal. `before` are portals from the start's own cell.
    fn leg(&mut self, root: Stop, first: CellId, before: &[EdgeId]) {
        let graph = self.graph;
        let (from, goal) = (*self.exact(root), self.goal);
        let side_of = |p: VertexId, q: &Vertex| orient(&from, graph.vertices.exact(p), q);
        let side = |p: VertexId, q: VertexId| match root {
            Stop::Corner(edge) => graph.vertices.orient(graph.edge(edge).origin, p, q),
            _ => side_of(p, graph.vertices.exact(q)),
        };
        let mut views: Vec<View> = Vec::new();
        let edges = || graph.edge_range(first).map(EdgeId);
        for edge in edges() {
            self.reach(root, first, edge, before, &[], None);
        }
        if self.goals.contains_key(&first) {
            self.reach_goal(root, first, first, before, &[], None);
        }
        // A portal in line with the root shows nothing.
        let open = |edge: EdgeId| {
            let [right, left] = [graph.edge(edge).origin, graph.end(edge)];
            let opens = side(right, left) == Side::Left;
            (graph.edge(edge).twin().is_some() && opens).then_some([right, left])
        };
        let view = |edge: EdgeId| {
            open(edge).map(|[right, left]| View {
                portal: edge,
                right,
                left,
                parent: None,
            })
        };
        views.extend(edges().filter_map(view));
        let mut next = 0;
        while next < views.len() {
            let view = views[next];
            next += 1;
            let Some(entry) = graph.edge(view.portal).twin() else {
                continue;
            };
            let cell = graph.edge(entry).cell;
            let [right, left] = [view.right, view.left];
            if self.goals.contains_key(&cell)
                && side_of(right, &goal) != Side::Right
                && side_of(left, &goal) != Side::Left
            {
                self.reach_goal(root, first, cell, before, &views, Some(next - 1));
            }
            // On which sides of the two borders the edge's origin lies, and then its end.
            let sides = |p: VertexId| [side(right, p), side(left, p)];
            let mut edge = graph.next(entry);
            let mut origin = sides(graph.edge(edge).origin);
            while edge != entry {
                let end = sides(graph.end(edge));
                // The corners of the portal belong to the cell before.
                let seen = origin[0] != Side::Right && origin[1] != Side::Left;
                if seen && graph.edge(edge).origin != graph.end(entry) {
                    self.reach(root, first, edge, before, &views, Some(next - 1));
                }
                if graph.edge(edge).twin().is_some()
                    && origin[1] != Side::Left
                    && end[0] != Side::Right
                {
                    let narrowed = [
                        match origin[0] {
                            Side::Right => right,
                            _ => graph.edge(edge).origin,
                        },
                        match end[1] {
                            Side::Left => left,
                            _ => graph.end(edge),
                        },
                    ];
                    if side(narrowed[0], narrowed[1]) == Side::Left {
                        views.push(View {
                            portal: edge,
                            right: narrowed[0],
                            left: narrowed[1],
                            parent: Some(next - 1),
                        });
                    }
                }
                (edge, origin) = (graph.next(edge), end);
            }
        }
    }

    /// The corner in which an edge starts, if it juts into the room.
    fn corner(&mut self, edge: EdgeId) -> Option<Stop> {
        let graph = self.graph;
        *self.corners[edge.0 as usize].get_or_insert_with(|| {
            let juts = corner_at(graph, edge) == Corner::Jutting;
            juts.then(|| Stop::Corner(around(graph, edge)[0]))
        })
    }

    /// The corner in which an edge starts is seen from a root.
    fn reach(
        &mut self,
        root: Stop,
        from: CellId,
        edge: EdgeId,
        before: &[EdgeId],
        views: &[View],
        last: Option<usize>,
    ) {
        let Some(stop) = self.corner(edge) else {
            return;
        };
        let portals = || before.iter().copied().chain(chain(views, last)).collect();
        self.shorten(root, from, stop, portals);
    }

    /// The goal, which touches this cell, is seen from a root.
    fn reach_goal(
        &mut self,
        root: Stop,
        from: CellId,
        cell: CellId,
        before: &[EdgeId],
        views: &[View],
        last: Option<usize>,
    ) {
        let rest = self.goals[&cell].clone();
        let portals = || {
            let seen = before.iter().copied().chain(chain(views, last));
            seen.chain(rest).collect()
        };
        self.shorten(root, from, Stop::Goal, portals);
    }

    /// Keeps a leg from `root` to `stop` if no way as short is known.
    fn shorten(
        &mut self,
        root: Stop,
        from: CellId,
        stop: Stop,
        portals: impl FnOnce() -> Vec<EdgeId>,
    ) {
        let so_far = self.reached.get(&root).map_or(0.0, |known| known.length);
        let at = self.at(stop);
        let length = so_far + self.at(root).distance(at);
        let known = self.reached.get(&stop);
        if stop == root || known.is_some_and(|known| known.done || known.length <= length) {
            return;
        }
        let reached = Reached {
            length,
            before: root,
            from,
            portals: portals(),
            done: false,
        };
        self.reached.insert(stop, reached);
        self.pushed += 1;
        self.queue.push(Waiting {
            least: length + at.distance(self.goal.approx()),
            number: self.pushed,
            stop,
        });
    }

    /// The way from a cell to the goal, which has been reached.
    fn way(&self, start: CellId) -> Way {
        let graph = self.graph;
        let mut legs = Vec::new();
        let mut stop = Stop::Goal;
        while let Some(leg) = self.reached.get(&stop) {
            legs.push((stop, leg));
            stop = leg.before;
        }
        legs.reverse();
        let mut way = Way {
            portals: Vec::new(),
            bends: Vec::new(),
            points: vec![self.at(Stop::Start)],
            length: legs.last().map_or(0.0, |(_, leg)| leg.length),
        };
        for (stop, leg) in legs {
            if let Stop::Corner(first) = leg.before {
                let arrived = last_cell(graph, start, &way.portals);
                way.portals.extend(turn(graph, first, arrived, leg.from));
            }
            way.portals.extend(&leg.portals);
            way.points.push(self.at(stop));
            if let Stop::Corner(edge) = stop {
                way.bends.push(graph.edge(edge).origin);
            }
        }
        way
    }
}

/// The portals through which a view is seen, outwards.
fn chain(views: &[View], last: Option<usize>) -> impl Iterator<Item = EdgeId> {
    let mut portals = Vec::new();
    let mut view = last;
    while let Some(i) = view {
        portals.push(views[i].portal);
        view = views[i].parent;
    }
    portals.into_iter().rev()
}

/// The edges that start in the same vertex, between the same walls, counterclockwise from the wall
/// on the right; there must be one.
fn around(graph: &CellGraph, edge: EdgeId) -> Vec<EdgeId> {
    let mut first = edge;
    while let Some(twin) = graph.edge(first).twin() {
        first = graph.next(twin);
    }
    let mut edges = vec![first];
    while let Some(twin) = graph.edge(graph.previous(edges[edges.len() - 1])).twin() {
        edges.push(twin);
    }
    edges
}

/// The portals about a corner from one of its cells to another.
fn turn(graph: &CellGraph, corner: EdgeId, from: CellId, to: CellId) -> Vec<EdgeId> {
    let edges = around(graph, corner);
    let of = |cell| edges.iter().position(|&e| graph.edge(e).cell == cell);
    let (Some(from), Some(to)) = (of(from), of(to)) else {
        return Vec::new();
    };
    if from <= to {
        let left = edges[from..to].iter().map(|&e| graph.previous(e));
        left.collect()
    } else {
        edges[to + 1..=from].iter().rev().copied().collect()
    }
}

/// The cells that touch a point of `cell` and are open to it there, each with the portals on which
/// the point lies, from `cell` on.
fn touched(graph: &CellGraph, cell: CellId, p: &Vertex) -> Vec<(CellId, Vec<EdgeId>)> {
    let mut found = vec![(cell, Vec::new())];
    let mut next = 0;
    while next < found.len() {
        let (cell, portals) = found[next].clone();
        next += 1;
        for edge in graph.edge_range(cell).map(EdgeId) {
            let Some(twin) = graph.edge(edge).twin() else {
                continue;
            };
            let beyond = graph.edge(twin).cell;
            if lies_on(graph, edge, p) && found.iter().all(|(known, _)| *known != beyond) {
                let on = portals.iter().copied().chain([edge]);
                found.push((beyond, on.collect()));
            }
        }
    }
    found
}

/// Whether a point lies on an edge, ends included.
fn lies_on(graph: &CellGraph, edge: EdgeId, p: &Vertex) -> bool {
    let ends = [graph.edge(edge).origin, graph.end(edge)];
    let [a, b] = ends.map(|v| graph.vertices.exact(v));
    let between = |to: Ordering, on: Ordering| to == on || to.is_eq() || on.is_eq();
    orient(a, b, p) == Side::On
        && between(a.cmp_x(p), p.cmp_x(b))
        && between(a.cmp_y(p), p.cmp_y(b))
}
