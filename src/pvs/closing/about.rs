//! The sweep about one vertex after the other, with the openings that its lines pass.
//!
//! As [`sweep`](crate::pvs::sweep), which says why this finds every pair; but what it finds is not a row of
//! bits but one pair after the other, each with the openings between the two.

use std::sync::Mutex;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec2;
use smallvec::SmallVec;

use super::NONE;
use super::pairs::Pairs;
use super::sets::{Algebra, EMPTY, Sets};
use crate::cells::{CellGraph, EdgeId};
use crate::geom::{Side, VertexId};
use crate::pvs::fan::Ray;
use crate::pvs::flat::{FlatEdge, FlatMesh, WALL};
use crate::pvs::sweep::{Group, Plan, Span};

/// A cell in the fan of a vertex, as it is reached through one chain of portals.
#[derive(Clone, Copy)]
struct Sector {
    cell: u32,
    /// The openings on the chain.
    passed: u32,
    /// Through which cell of the group it is seen.
    base: u32,
}

/// A sector of the fan begins or ends. In the order of directions, those that are open at a time are
/// a stack: a chain of portals.
#[derive(Clone, Copy)]
struct Event {
    ray: Ray,
    sector: u32,
    enters: bool,
}

/// A part of the fan that remains to be walked.
enum Step {
    Enter {
        entry: u32,
        low: Ray,
        high: Ray,
        passed: u32,
    },
    Exit(u32, Ray),
}

/// The sweep about one vertex after the other.
pub(super) struct Sweep<'a> {
    graph: &'a CellGraph,
    mesh: &'a FlatMesh<'a>,
    marks: &'a [u32],
    pairs: &'a Pairs<'a>,
    algebra: Algebra<'a>,
    vertex: VertexId,
    origin: DVec2,
    steps: Vec<Step>,
    sectors: Vec<Sector>,
    events: Vec<Event>,
    /// The opening, if any, between each cell of the group and the next.
    between: Vec<u32>,
    /// Whether the cells go all around, without a wall.
    ring: bool,
    ahead: Vec<u32>,
    behind: Vec<u32>,
}

impl<'a> Sweep<'a> {
    pub(super) fn new(
        graph: &'a CellGraph,
        mesh: &'a FlatMesh<'a>,
        marks: &'a [u32],
        pairs: &'a Pairs<'a>,
        sets: &'a Mutex<Sets>,
    ) -> Self {
        Self {
            graph,
            mesh,
            marks,
            pairs,
            algebra: Algebra::new(sets),
            vertex: VertexId(0),
            origin: DVec2::ZERO,
            steps: Vec::new(),
            sectors: Vec::new(),
            events: Vec::new(),
            between: Vec::new(),
            ring: false,
            ahead: Vec::new(),
            behind: Vec::new(),
        }
    }

    pub(super) fn about(&mut self, plan: &Plan, group: &Group) {
        let range = group.first as usize..group.end as usize;
        let bases = &plan.bases[range.clone()];
        self.vertex = group.vertex;
        self.origin = self.graph.vertices.approx(group.vertex);
        let graph = self.graph;
        let mark = |&base: &EdgeId| self.marks[graph.previous(base).0 as usize];
        self.between.clear();
        self.between.extend(bases.iter().map(mark));
        self.ring = graph.edge(bases[0]).twin().is_some();
        self.fan(bases);
        for (i, _) in plan.covers[range].iter().enumerate().filter(|c| *c.1) {
            if group.span == Span::Simple {
                let cell = graph.edge(bases[i]).cell.0;
                for k in 0..self.sectors.len() {
                    self.prove_from(cell, i as u32, k as u32);
                }
            } else {
                self.see_ahead(bases[i], i as u32);
            }
        }
        if group.span != Span::Simple {
            self.pair_opposites();
        }
    }

    fn ray(&self, to: VertexId) -> Ray {
        let d = self.graph.vertices.approx(to) - self.origin;
        Ray { to, d }
    }

    #[inline]
    fn side(&self, p: &Ray, q: &Ray) -> Side {
        let vertices = &self.graph.vertices;
        vertices.orient_from(self.vertex, p.to, p.d, q.to, q.d)
    }

    #[inline]
    fn is_left(&self, p: &Ray, q: &Ray) -> bool {
        self.side(p, q) == Side::Left
    }

    fn begin(&mut self, cell: u32, passed: u32, base: u32, ray: Ray) -> u32 {
        let sector = self.sectors.len() as u32;
        self.sectors.push(Sector { cell, passed, base });
        self.events.push(Event {
            ray,
            sector,
            enters: true,
        });
        sector
    }

    fn end(&mut self, sector: u32, ray: Ray) {
        self.events.push(Event {
            ray,
            sector,
            enters: false,
        });
    }

    /// The fan of the vertex, as `FanWalk` walks it, with the openings passed.
    fn fan(&mut self, bases: &[EdgeId]) {
        self.sectors.clear();
        self.events.clear();
        let (graph, mesh) = (self.graph, self.mesh);
        for (base, number) in bases.iter().zip(0..) {
            let last = graph.previous(*base);
            let mut from = self.ray(graph.end(*base));
            let own = self.begin(graph.edge(*base).cell.0, EMPTY, number, from);
            let mut e = graph.next(*base);
            while e != last {
                let to = self.ray(graph.end(e));
                let twin = mesh.edge(e.0).twin;
                if twin != WALL && self.is_left(&from, &to) {
                    self.steps.push(Step::Enter {
                        entry: twin,
                        low: from,
                        high: to,
                        passed: EMPTY,
                    });
                    self.run(number);
                }
                from = to;
                e = graph.next(e);
            }
            self.end(own, from);
        }
    }

    fn run(&mut self, base: u32) {
        let mesh = self.mesh;
        while let Some(step) = self.steps.pop() {
            let (entry, low, high, mut passed) = match step {
                Step::Exit(sector, ray) => {
                    self.end(sector, ray);
                    continue;
                }
                Step::Enter {
                    entry,
                    low,
                    high,
                    passed,
                } => (entry, low, high, passed),
            };
            let mark = self.marks[entry as usize];
            if mark != NONE {
                let single = self.algebra.single(mark);
                passed = self.algebra.union(passed, single);
            }
            let FlatEdge { cell, .. } = *mesh.edge(entry);
            let own = self.begin(cell, passed, base, low);
            self.steps.push(Step::Exit(own, high));
            let next = |e| mesh.edge(entry).next(e);
            let mut e = next(entry);
            let ray = |e: u32| Ray {
                to: mesh.edge(e).end.id,
                d: mesh.edge(e).end.at - self.origin,
            };
            let mut end = ray(e);
            // First come edges wholly right of the interval.
            while !self.is_left(&low, &end) {
                e = next(e);
                end = ray(e);
            }
            let children = self.steps.len();
            let mut from = low;
            loop {
                let inside = self.is_left(&end, &high);
                let to = if inside { end } else { high };
                let twin = mesh.edge(e).twin;
                if twin != WALL {
                    self.steps.push(Step::Enter {
                        entry: twin,
                        low: from,
                        high: to,
                        passed,
                    });
                }
                if !inside {
                    break;
                }
                from = to;
                e = next(e);
                end = ray(e);
            }
            self.steps[children..].reverse();
        }
    }

    /// The openings that part two cells of the group near the vertex.
    fn around(&mut self, i: u32, j: u32) -> u32 {
        if self.between.iter().all(|&m| m == NONE) {
            return EMPTY;
        }
        let (i, j) = (i.min(j) as usize, i.max(j) as usize);
        let mut inner = EMPTY;
        let mut outer = EMPTY;
        for k in 0..self.between.len() {
            let mark = self.between[k];
            if mark == NONE {
                continue;
            }
            let single = self.algebra.single(mark);
            let way = if (i..j).contains(&k) {
                &mut inner
            } else {
                &mut outer
            };
            *way = self.algebra.union(*way, single);
        }
        if self.ring {
            // An opening through the vertex parts them if it is crossed on either way around.
            inner = self.algebra.meet(inner, outer);
        }
        inner
    }

    /// A cell of the group sees a sector's.
    fn prove_from(&mut self, cell: u32, base: u32, sector: u32) {
        let Sector {
            cell: other,
            passed,
            base: through,
        } = self.sectors[sector as usize];
        self.prove(cell, other, passed, EMPTY, base, through);
    }

    /// Two cells see each other by lines through these openings and past these cells of the group.
    #[inline]
    fn prove(&mut self, a: u32, b: u32, p: u32, q: u32, i: u32, j: u32) {
        if a == b {
            return;
        }
        let slot = &self.pairs.slots[self.pairs.rank(a.min(b), a.max(b))];
        let mut old = slot.load(Relaxed);
        if old == EMPTY {
            return;
        }
        let both = self.algebra.union(p, q);
        let around = self.around(i, j);
        let passed = self.algebra.union(both, around);
        loop {
            let new = self.algebra.meet(old, passed);
            if new == old {
                return;
            }
            match slot.compare_exchange_weak(old, new, Relaxed, Relaxed) {
                Ok(_) => return,
                Err(now) => old = now,
            }
        }
    }

    /// Rule 1 of the sweep in a wide group: the cell of `base`, the group's `i`-th, sees what lies less
    /// than a half turn from its own angle, on either side.
    fn see_ahead(&mut self, base: EdgeId, i: u32) {
        let graph = self.graph;
        let cell = graph.edge(base).cell.0;
        let first = self.ray(graph.end(base));
        let last = self.ray(graph.edge(graph.previous(base)).origin);
        let own = |e: &Event| {
            let sector = &self.sectors[e.sector as usize];
            sector.base == i && sector.cell == cell
        };
        let begin = self.events.iter().position(own).unwrap_or(0);
        let end = self.events.iter().rposition(own).unwrap_or(0);
        let vertices = &graph.vertices;
        let within = |side: Side, p: VertexId, q: VertexId| {
            side == Side::Left || (side == Side::On && vertices.same_direction(self.vertex, p, q))
        };
        let mut seen: SmallVec<[u32; 64]> = SmallVec::new();
        let enters = |e: &&Event| e.enters;
        seen.extend(
            self.events[begin..end]
                .iter()
                .filter(enters)
                .map(|e| e.sector),
        );
        for e in self.events[..begin].iter().rev().filter(|e| !e.enters) {
            if !within(self.side(&e.ray, &first), e.ray.to, first.to) {
                break;
            }
            seen.push(e.sector);
        }
        for e in self.events[end..].iter().filter(enters) {
            if !within(self.side(&last, &e.ray), last.to, e.ray.to) {
                break;
            }
            seen.push(e.sector);
        }
        for sector in seen {
            self.prove_from(cell, i, sector);
        }
    }

    /// Rule 2 of the sweep: cells met on opposite sides of the vertex by one free line through it.
    fn pair_opposites(&mut self) {
        let events = std::mem::take(&mut self.events);
        let (mut ahead, mut behind) = (
            std::mem::take(&mut self.ahead),
            std::mem::take(&mut self.behind),
        );
        let apply = |stack: &mut Vec<u32>, event: &Event| match event.enters {
            true => stack.push(event.sector),
            false => _ = stack.pop(),
        };
        let v = self.vertex;
        let same = |p: &Event, q: &Event| self.graph.vertices.same_direction(v, p.ray.to, q.ray.to);
        let start = events[0];
        let mut i = 0;
        while self.side(&start.ray, &events[i].ray) == Side::On && same(&start, &events[i]) {
            apply(&mut ahead, &events[i]);
            i += 1;
        }
        let mut j = 0;
        let mut turned = false;
        while let Some(event) = events.get(j) {
            match self.side(&start.ray, &event.ray) {
                Side::Left => turned = true,
                Side::Right => break,
                Side::On => {
                    let same = same(&start, event);
                    if same && turned {
                        break; // a full turn
                    }
                    turned |= !same;
                }
            }
            apply(&mut behind, event);
            j += 1;
        }
        for &sector in &ahead {
            self.meet_all(sector, &behind);
        }
        while j < events.len() {
            let (take_i, take_j) = match self.side(&events[i].ray, &events[j].ray) {
                Side::Left => (false, true),
                Side::Right => (true, false),
                Side::On => (true, true),
            };
            let (at_i, at_j) = (events[i], events[j]);
            let here = |sweep: &Self, at: &Event, event: &Event| {
                at.ray.to == event.ray.to || sweep.side(&at.ray, &event.ray) == Side::On
            };
            if take_i {
                while !events[i].enters && here(self, &at_i, &events[i]) {
                    ahead.pop();
                    i += 1;
                }
            }
            if take_j {
                while j < events.len() && !events[j].enters && here(self, &at_j, &events[j]) {
                    behind.pop();
                    j += 1;
                }
            }
            if take_i {
                while events[i].enters && here(self, &at_i, &events[i]) {
                    ahead.push(events[i].sector);
                    self.meet_all(events[i].sector, &behind);
                    i += 1;
                }
            }
            if take_j {
                while j < events.len() && events[j].enters && here(self, &at_j, &events[j]) {
                    behind.push(events[j].sector);
                    self.meet_all(events[j].sector, &ahead);
                    j += 1;
                }
            }
        }
        ahead.clear();
        behind.clear();
        (self.events, self.ahead, self.behind) = (events, ahead, behind);
    }

    fn meet_all(&mut self, sector: u32, others: &[u32]) {
        let one = self.sectors[sector as usize];
        for &other in others {
            let other = self.sectors[other as usize];
            self.prove(
                one.cell,
                other.cell,
                one.passed,
                other.passed,
                one.base,
                other.base,
            );
        }
    }
}
