//! The exact PVS by a sweep of directions about every vertex.
//!
//! In: a [`CellGraph`]. Out: its exact [`Pvs`]. O(Σ over vertices of the cells seen from it), times
//! the words that the cells on one line take in a bit row.
//!
//! Why it is complete. Let A see B, pick any corner v of A, points a in A and b in B whose segment
//! is free, and b on no line through v and another vertex (almost every point of B is such). Move a
//! straight to v. Either the segment stays free all the way: then b is in the fan of v, less than a
//! half turn from A's angle at v and not parted from it by a wall (rule 1). Or a wall's end w stops
//! it first, somewhere between: then the line through w and b is free on both sides of w, with all
//! walls at w on one side of it, and has A behind w (rule 2). So it is enough to apply rule 2 about
//! all vertices where cells between two walls (or around one wall's end) span more than a half turn,
//! and rule 1 about one corner of every cell.
//!
//! Why it is sound. A direction of a fan is an open condition: a little to the side, and from a
//! little beside v, the way is as free.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use rayon::prelude::*;

use super::bits::{SharedBits, SmallSet};
use super::fan::{Event, FanWalk, Ray, Wanted};
use super::flat::FlatMesh;
use super::{Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, EdgeId};
use crate::geom::{Side, VertexId};

/// Consecutive cells around a vertex, not parted by a wall.
pub(super) struct Group {
    pub vertex: VertexId,
    /// Range of [`Plan::bases`].
    pub first: u32,
    pub end: u32,
    pub span: Span,
    /// Whether rule 1 is applied to some of its cells.
    pub covers: bool,
}

/// The angle that a group takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Span {
    /// At most a half turn, or all around without any wall: rule 1 is simple, rule 2 adds nothing.
    Simple,
    /// More than a half turn between two walls: rule 2 applies.
    Wide,
    /// All around a wall's end: rule 2 applies.
    Full,
}

/// What is done about which vertex.
pub(super) struct Plan {
    pub groups: Vec<Group>,
    /// Edges that start in the group's vertex, counterclockwise.
    pub bases: Vec<EdgeId>,
    /// Whether rule 1 is applied here to the base's cell.
    pub covers: Vec<bool>,
}

/// The exact PVS. Uses the current rayon thread pool; the result does not depend on its size.
pub fn sweep(graph: &CellGraph, progress: &Progress) -> Pvs {
    let plan = plan(graph);
    let mesh = FlatMesh::new(graph);
    let needed = |g: &&Group| g.covers || g.span != Span::Simple;
    let groups: Vec<&Group> = plan.groups.iter().filter(needed).collect();
    progress.begin(groups.len());
    let n = graph.cells.len();
    let bits = SharedBits::new(n);
    // Small chunks, so that threads that finish early find work.
    let steps = groups
        .par_chunks(16)
        .map_init(
            || Scratch::new(n),
            |scratch, chunk| {
                let steps: u64 = chunk
                    .iter()
                    .map(|group| about(graph, &mesh, &plan, group, scratch, &bits))
                    .sum();
                progress.advance(chunk.len());
                steps
            },
        )
        .sum();
    Pvs {
        visible: bits.symmetric(),
        method: Method::Sweep,
        class: Class::Exact,
        heights: false,
        undecided: 0,
        steps,
    }
}

/// Groups the cells around every vertex (see [`grouped`]), and picks for every cell a corner for rule 1: where the
/// fan is walked anyway, or else where it serves most cells.
pub(super) fn plan(graph: &CellGraph) -> Plan {
    let mut plan = grouped(graph);
    cover(graph, &mut plan);
    plan
}

/// The cells around every vertex in groups.
pub(super) fn grouped(graph: &CellGraph) -> Plan {
    let n_edges = graph.edges.len() as u32;
    let mut plan = Plan {
        groups: Vec::new(),
        bases: Vec::with_capacity(n_edges as usize),
        covers: vec![false; n_edges as usize],
    };
    let mut grouped = vec![false; n_edges as usize];
    // First from every wall counterclockwise to the next; what is left are rings without walls.
    for walls_first in [true, false] {
        for start in (0..n_edges).map(EdgeId) {
            if grouped[start.0 as usize] || (walls_first && graph.edge(start).twin().is_some()) {
                continue;
            }
            let first = plan.bases.len() as u32;
            let mut base = start;
            loop {
                grouped[base.0 as usize] = true;
                plan.bases.push(base);
                match graph.edge(graph.previous(base)).twin() {
                    Some(next) if next != start => base = next,
                    _ => break,
                }
            }
            let ring = !walls_first;
            let vertex = graph.edge(start).origin;
            let (alpha, beta) = (graph.end(start), graph.edge(graph.previous(base)).origin);
            let span = match graph.vertices.orient(vertex, alpha, beta) {
                _ if ring => Span::Simple,
                Side::Left => Span::Simple,
                Side::Right => Span::Wide,
                Side::On if graph.vertices.same_direction(vertex, alpha, beta) => Span::Full,
                Side::On => Span::Simple,
            };
            let end = plan.bases.len() as u32;
            plan.groups.push(Group {
                vertex,
                first,
                end,
                span,
                covers: false,
            });
        }
    }
    plan
}

/// Picks one corner for rule 1 of every cell: greedily, the group that covers most cells for what
/// its fan costs beyond what is walked anyway.
fn cover(graph: &CellGraph, plan: &mut Plan) {
    let mut covered = vec![false; graph.cells.len()];
    let cell_of = |base: EdgeId| graph.edge(base).cell.0 as usize;
    // Only the choice depends on these numbers, not the result.
    let value = |group: &Group, bases: &[EdgeId], covered: &[bool]| {
        let new = bases.iter().filter(|&&b| !covered[cell_of(b)]).count();
        let direction = |to| graph.vertices.approx(to) - graph.vertices.approx(group.vertex);
        let first = direction(graph.end(bases[0]));
        let last = direction(graph.edge(graph.previous(*bases.last().unwrap())).origin);
        let between = first.angle_to(last).rem_euclid(TAU);
        let extra = match group.span {
            Span::Full => 0.0,
            Span::Wide => TAU - between,
            Span::Simple if between > 0.0 => between,
            Span::Simple => TAU,
        };
        new as f64 / (extra + 0.1)
    };
    let bases_of = |group: &Group| group.first as usize..group.end as usize;
    let mut queue: BinaryHeap<(Value, Reverse<usize>)> = (0..plan.groups.len())
        .map(|g| {
            let group = &plan.groups[g];
            (
                Value(value(group, &plan.bases[bases_of(group)], &covered)),
                Reverse(g),
            )
        })
        .collect();
    // Values only fall as cells get covered, so the first whose value still holds is the best.
    while let Some((Value(old), Reverse(g))) = queue.pop() {
        let group = &mut plan.groups[g];
        let range = bases_of(group);
        let now = value(group, &plan.bases[range.clone()], &covered);
        if now < old {
            if now > 0.0 {
                queue.push((Value(now), Reverse(g)));
            }
            continue;
        }
        for i in range {
            let cell = cell_of(plan.bases[i]);
            if !covered[cell] {
                covered[cell] = true;
                plan.covers[i] = true;
                group.covers = true;
            }
        }
    }
}

/// A number ordered by size.
#[derive(PartialEq)]
struct Value(f64);

impl Eq for Value {}

impl Ord for Value {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Value {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Room for the sweep about one vertex after the other.
struct Scratch {
    walk: FanWalk,
    events: Vec<Event>,
    ahead: SmallSet,
    behind: SmallSet,
}

impl Scratch {
    fn new(n: usize) -> Self {
        Self {
            walk: FanWalk::default(),
            events: Vec::new(),
            ahead: SmallSet::new(n),
            behind: SmallSet::new(n),
        }
    }
}

fn about(
    graph: &CellGraph,
    mesh: &FlatMesh,
    plan: &Plan,
    group: &Group,
    scratch: &mut Scratch,
    bits: &SharedBits,
) -> u64 {
    let range = group.first as usize..group.end as usize;
    let bases = &plan.bases[range.clone()];
    let covers = &plan.covers[range];
    let cell_of = |base: EdgeId| graph.edge(base).cell.0;
    let chosen = bases
        .iter()
        .zip(covers)
        .filter(|(_, chosen)| **chosen)
        .map(|(&base, _)| base);
    if group.span == Span::Simple {
        // Rule 1: every cell of the group sees all of the fan.
        let Scratch {
            walk, ahead: seen, ..
        } = scratch;
        let steps = walk.walk(mesh, group.vertex, bases, Wanted::All, |event| {
            if event.enters {
                seen.insert(event.cell);
            }
        });
        chosen.for_each(|base| bits.or_row(cell_of(base), seen));
        seen.clear();
        return steps;
    }
    // Rule 2 needs only directions with an opposite one; rule 1 may need all.
    let wanted = if group.covers || group.span == Span::Full {
        Wanted::All
    } else {
        let origin = graph.vertices.approx(group.vertex);
        let ray = |to| Ray {
            to,
            d: graph.vertices.approx(to) - origin,
        };
        let last = graph.previous(bases[bases.len() - 1]);
        Wanted::Opposable {
            first: ray(graph.end(bases[0])),
            last: ray(graph.edge(last).origin),
        }
    };
    scratch.events.clear();
    let Scratch { walk, events, .. } = scratch;
    let steps = walk.walk(mesh, group.vertex, bases, wanted, |event| {
        events.push(event)
    });
    for base in chosen {
        see_ahead(graph, group.vertex, base, scratch, bits);
    }
    pair_opposites(graph, group.vertex, scratch, bits);
    steps
}

/// Rule 1 in a wide group: the cell of `base` sees what lies less than a half turn from its own
/// angle `[first, last]`, on either side.
fn see_ahead(
    graph: &CellGraph,
    v: VertexId,
    base: EdgeId,
    scratch: &mut Scratch,
    bits: &SharedBits,
) {
    let cell = graph.edge(base).cell.0;
    let first = graph.end(base);
    let last = graph.edge(graph.previous(base)).origin;
    let origin = graph.vertices.approx(v);
    let (first_d, last_d) = (
        graph.vertices.approx(first) - origin,
        graph.vertices.approx(last) - origin,
    );
    let seen = &mut scratch.ahead;
    let events = &scratch.events;
    // All of a cell lies within its angle at v, so it comes and goes once.
    let begin = events
        .iter()
        .position(|e| e.cell == cell)
        .expect("the fan holds its bases");
    let end = events
        .iter()
        .rposition(|e| e.cell == cell)
        .expect("the fan holds its bases");
    // `On` means the same direction, which is near enough, or the opposite one, which is not.
    let within = |side: Side, p: VertexId, q: VertexId| {
        side == Side::Left || (side == Side::On && graph.vertices.same_direction(v, p, q))
    };
    for event in &events[begin..end] {
        seen.insert(event.cell);
    }
    // Clockwise from there: what ends less than a half turn before `first`.
    for Event { ray, cell, .. } in events[..begin].iter().rev().filter(|e| !e.enters) {
        let side = graph.vertices.orient_from(v, ray.to, ray.d, first, first_d);
        if !within(side, ray.to, first) {
            break;
        }
        seen.insert(*cell);
    }
    // Counterclockwise: what starts less than a half turn after `last`.
    for Event { ray, cell, .. } in events[end..].iter().filter(|e| e.enters) {
        let side = graph.vertices.orient_from(v, last, last_d, ray.to, ray.d);
        if !within(side, last, ray.to) {
            break;
        }
        seen.insert(*cell);
    }
    bits.or_row(cell, seen);
    seen.clear();
}

/// Rule 2: cells met on opposite sides of v by one free line through it. Two pointers go through the
/// fan's events, the second a half turn ahead of the first.
fn pair_opposites(graph: &CellGraph, v: VertexId, scratch: &mut Scratch, bits: &SharedBits) {
    let Scratch {
        events,
        ahead,
        behind,
        ..
    } = scratch;
    let vertices = &graph.vertices;
    let side = |p: &Event, q: &Event| vertices.orient_from(v, p.ray.to, p.ray.d, q.ray.to, q.ray.d);
    let apply = |set: &mut SmallSet, event: &Event| {
        if event.enters {
            set.insert(event.cell)
        } else {
            set.remove(event.cell)
        }
    };
    let start = events[0];
    // What is seen in the first direction, …
    let mut i = 0;
    while side(&start, &events[i]) == Side::On
        && vertices.same_direction(v, start.ray.to, events[i].ray.to)
    {
        apply(ahead, &events[i]);
        i += 1;
    }
    // … and what is seen opposite to it: all that happens up to a half turn.
    let mut j = 0;
    let mut turned = false;
    while let Some(event) = events.get(j) {
        match side(&start, event) {
            Side::Left => turned = true,
            Side::Right => break,
            Side::On => {
                let same = vertices.same_direction(v, start.ray.to, event.ray.to);
                if same && turned {
                    break; // a full turn
                }
                turned |= !same;
            }
        }
        apply(behind, event);
        j += 1;
    }
    ahead.for_each(|cell| bits.or_row(cell, behind));
    // Both pointers' next directions are less than a half turn from the current one (no cell's
    // angle is wider), so that the sign of one cross product tells which comes first.
    while j < events.len() {
        let (take_i, take_j) = match side(&events[i], &events[j]) {
            Side::Left => (false, true),
            Side::Right => (true, false),
            Side::On => (true, true),
        };
        let (at_i, at_j) = (events[i], events[j]);
        let here =
            |at: &Event, event: &Event| at.ray.to == event.ray.to || side(at, event) == Side::On;
        // Intervals that only touch in one direction do not pair: all exits come first.
        if take_i {
            while !events[i].enters && here(&at_i, &events[i]) {
                ahead.remove(events[i].cell);
                i += 1;
            }
        }
        if take_j {
            while j < events.len() && !events[j].enters && here(&at_j, &events[j]) {
                behind.remove(events[j].cell);
                j += 1;
            }
        }
        if take_i {
            while events[i].enters && here(&at_i, &events[i]) {
                ahead.insert(events[i].cell);
                bits.or_row(events[i].cell, behind);
                i += 1;
            }
        }
        if take_j {
            while j < events.len() && events[j].enters && here(&at_j, &events[j]) {
                behind.insert(events[j].cell);
                bits.or_row(events[j].cell, ahead);
                j += 1;
            }
        }
    }
    ahead.clear();
    behind.clear();
}
