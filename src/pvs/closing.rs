//! What closing an opening would hide, for all openings of a level in one sweep.
//!
//! In: a graph, its exact PVS, and openings: straight gaps from wall to wall. Out: for each pair of cells
//! that see each other, the openings that hide them if walled up ([`Common`]), and from that what each
//! opening lets be seen ([`Saving`]).
//!
//! A wall only takes sightlines away. [`sweep`](super::sweep) finds every pair about some vertices; the
//! lines by which it finds the pair cross some openings. With an opening closed it would find the pair by
//! the same lines, but for those that cross the opening: what stands in its way is a wall now, and parts
//! the cells about each vertex in which it ends. It adds no vertex to sweep about, since its ends lie on
//! walls already, and what it leaves open on either side there is less than before; on vertices in its
//! middle it leaves a half turn on either side, about which lines of sight need no turn. So a pair is
//! lost if and only if all lines by which the sweep finds it cross the opening: nothing is computed anew
//! for any opening, and the answer is exact for each.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::DVec2;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::fan::Ray;
use super::flat::{FlatEdge, FlatMesh, WALL};
use super::sweep::{Group, Plan, Span, plan};
use super::{Progress, Pvs};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{Side, VertexId};

/// A straight gap between two walls: what a door, an arch or a partition could fill.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Opening {
    /// Its portals one after the other, as edges of the cells on its left.
    pub edges: Vec<EdgeId>,
    /// Where it starts and ends; walls stand there.
    pub ends: [VertexId; 2],
}

/// The straight gaps of a graph: portals in line, from one vertex with a wall to the next. Portals
/// whose line ends at an open vertex are in none of them. Ordered by their first edge.
pub fn openings(graph: &CellGraph) -> Vec<Opening> {
    let n = graph.edges.len() as u32;
    let mut walled = vec![false; graph.vertices.len()];
    let mut from: Vec<(VertexId, EdgeId)> = Vec::with_capacity(2 * graph.portals.len());
    for e in (0..n).map(EdgeId) {
        let edge = graph.edge(e);
        if edge.twin().is_some() {
            from.push((edge.origin, e));
        } else {
            walled[edge.origin.0 as usize] = true;
            walled[graph.end(e).0 as usize] = true;
        }
    }
    from.sort();
    let is_walled = |v: VertexId| walled[v.0 as usize];
    let onward = |e: EdgeId| {
        let (start, v) = (graph.edge(e).origin, graph.end(e));
        let first = from.partition_point(|&(u, _)| u < v);
        let leaving = from[first..].iter().take_while(|&&(u, _)| u == v);
        leaving.map(|&(_, f)| f).find(|&f| {
            let end = graph.end(f);
            graph.vertices.orient(start, v, end) == Side::On
                && !graph.vertices.same_direction(v, start, end)
        })
    };
    let mut list = Vec::new();
    for &(v, first) in from.iter().filter(|&&(v, _)| is_walled(v)) {
        let mut edges = vec![first];
        let mut last = first;
        while !is_walled(graph.end(last)) {
            let Some(next) = onward(last) else { break };
            edges.push(next);
            last = next;
        }
        let end = graph.end(last);
        // Each is found from both ends.
        let other = graph.edge(last).twin();
        if is_walled(end) && other.is_some_and(|twin| first < twin) {
            let ends = [v, end];
            list.push(Opening { edges, ends });
        }
    }
    list.sort_by_key(|o| o.edges[0]);
    list
}

/// What closing an opening would hide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Saving {
    /// Ordered pairs of cells that would no longer see each other; or, of one source, cells that it
    /// would no longer see.
    pub pairs: u64,
    /// Sums over these, as the caller weighs them.
    pub weights: [f64; 2],
}

impl Saving {
    fn add(&mut self, pairs: u64, weights: [f64; 2]) {
        self.pairs += pairs;
        self.weights[0] += weights[0];
        self.weights[1] += weights[1];
    }
}

/// Of every pair of cells that see each other, the openings through which all their sightlines lead.
pub struct Common<'a> {
    pairs: Pairs<'a>,
    sets: Vec<Set>,
    n_openings: usize,
}

impl<'a> Common<'a> {
    /// Of a graph with its exact PVS on the plan; `openings` are some of [`openings`]. Uses the current
    /// rayon thread pool; the result does not depend on its size.
    pub fn of(graph: &CellGraph, pvs: &'a Pvs, openings: &[Opening], progress: &Progress) -> Self {
        let plan = plan(graph);
        let mesh = FlatMesh::new(graph);
        let marks = marks(graph, openings);
        let pairs = Pairs::of(pvs);
        let sets = Mutex::new(Sets::default());
        let needed = |g: &&Group| g.covers || g.span != Span::Simple;
        let groups: Vec<&Group> = plan.groups.iter().filter(needed).collect();
        progress.begin(groups.len());
        groups.par_chunks(16).for_each_init(
            || Sweep::new(graph, &mesh, &marks, &pairs, &sets),
            |sweep, chunk| {
                chunk.iter().for_each(|group| sweep.about(&plan, group));
                progress.advance(chunk.len());
            },
        );
        let sets = sets
            .into_inner()
            .map_or_else(|e| e.into_inner().list, |s| s.list);
        Common {
            pairs,
            sets,
            n_openings: openings.len(),
        }
    }

    /// The openings any of which would hide two cells from each other if it were closed; none for
    /// cells that do not see each other.
    pub fn openings(&self, a: CellId, b: CellId) -> &[u32] {
        let (a, b) = (a.0.min(b.0), a.0.max(b.0));
        if a == b || !self.pairs.pvs.sees(CellId(a), CellId(b)) {
            return &[];
        }
        self.set(&self.pairs.slots[self.pairs.rank(a, b)])
    }

    fn set(&self, slot: &AtomicU32) -> &[u32] {
        self.sets
            .get(slot.load(Relaxed) as usize)
            .map_or(&[], |s| s)
    }

    /// What closing each opening would hide over the whole level. `weigh` says what it counts that two
    /// cells, the first of lower number, no longer see each other.
    pub fn savings(&self, weigh: impl Fn(usize, usize) -> [f64; 2] + Sync) -> Vec<Saving> {
        let visible = &self.pairs.pvs.visible;
        let row = |sums: &mut Vec<Saving>, a: usize| {
            let mut hiding: Vec<u32> = Vec::new();
            let later = visible.ones(a).skip_while(|&b| b <= a);
            let slots = self.pairs.slots[self.pairs.first_of(a)..].iter();
            for (b, slot) in later.zip(slots) {
                for &opening in self.set(slot) {
                    let sum = &mut sums[opening as usize];
                    if sum.pairs == 0 {
                        hiding.push(opening);
                    }
                    sum.add(2, weigh(a, b));
                }
            }
            let take = |o: u32| (o, std::mem::take(&mut sums[o as usize]));
            hiding.into_iter().map(take).collect::<Vec<_>>()
        };
        let none = || vec![Saving::default(); self.n_openings];
        let rows: Vec<Vec<(u32, Saving)>> = (0..visible.n())
            .into_par_iter()
            .with_min_len(16)
            .map_init(none, row)
            .collect();
        let mut savings = none();
        for (opening, part) in rows.into_iter().flatten() {
            savings[opening as usize].add(part.pairs, part.weights);
        }
        savings
    }

    /// What closing each opening would hide from one cell: pairs of an opening's index and its saving,
    /// those that hide nothing left out. `weigh` says what a hidden cell counts.
    pub fn savings_of(
        &self,
        source: CellId,
        weigh: impl Fn(usize) -> [f64; 2],
    ) -> Vec<(u32, Saving)> {
        let mut sums = vec![Saving::default(); self.n_openings];
        for b in self.pairs.pvs.seen_from(source) {
            for &opening in self.openings(source, b) {
                sums[opening as usize].add(1, weigh(b.0 as usize));
            }
        }
        let all = (0..).zip(sums);
        all.filter(|(_, saving)| saving.pairs > 0).collect()
    }
}

/// A place for every pair of cells that see each other, the first of lower number.
struct Pairs<'a> {
    pvs: &'a Pvs,
    /// For each word of the visible sets, how many pairs come before it.
    before: Vec<u32>,
    slots: Vec<AtomicU32>,
}

impl<'a> Pairs<'a> {
    fn of(pvs: &'a Pvs) -> Self {
        let (n, stride) = (pvs.visible.n(), pvs.visible.stride());
        let mut before = Vec::with_capacity(n * stride);
        let mut count = 0;
        for a in 0..n {
            for (k, word) in pvs.visible.row(a).iter().enumerate() {
                before.push(count);
                count += (word & after(a, k)).count_ones();
            }
        }
        let slots = (0..count).map(|_| AtomicU32::new(ALL)).collect();
        Self { pvs, before, slots }
    }

    fn first_of(&self, a: usize) -> usize {
        self.before[a * self.pvs.visible.stride()] as usize
    }

    /// The place of a pair that see each other, `a < b`.
    #[inline]
    fn rank(&self, a: u32, b: u32) -> usize {
        let (a, b) = (a as usize, b as usize);
        let (k, stride) = (b / 64, self.pvs.visible.stride());
        let word = self.pvs.visible.row(a)[k] & after(a, k);
        let lower = word & ((1 << (b % 64)) - 1);
        (self.before[a * stride + k] + lower.count_ones()) as usize
    }
}

/// The bits of word `k` that are of numbers above `a`.
#[inline]
fn after(a: usize, k: usize) -> u64 {
    match k.cmp(&(a / 64)) {
        std::cmp::Ordering::Less => 0,
        std::cmp::Ordering::Greater => !0,
        std::cmp::Ordering::Equal => (!0 << (a % 64)) & !(1 << (a % 64)),
    }
}

/// Openings, ascending.
type Set = SmallVec<[u32; 6]>;

/// Index into [`Sets::list`]: of the empty set, and of none yet, which is as good as all openings.
const EMPTY: u32 = 0;
const ALL: u32 = u32::MAX;

/// Sets of openings, each once. (Their numbers depend on the threads' turns, what they hold does not.)
struct Sets {
    list: Vec<Set>,
    number: FxHashMap<Set, u32>,
}

impl Default for Sets {
    fn default() -> Self {
        Self {
            list: vec![Set::new()],
            number: [(Set::new(), EMPTY)].into_iter().collect(),
        }
    }
}

impl Sets {
    fn intern(&mut self, set: Set) -> u32 {
        let next = self.list.len() as u32;
        let list = &mut self.list;
        *self.number.entry(set).or_insert_with_key(|set| {
            list.push(set.clone());
            next
        })
    }
}

/// What a thread knows of sums and products of sets.
struct Algebra<'a> {
    sets: &'a Mutex<Sets>,
    unions: FxHashMap<(u32, u32), u32>,
    meets: FxHashMap<(u32, u32), u32>,
    singles: FxHashMap<u32, u32>,
}

impl Algebra<'_> {
    fn single(&mut self, mark: u32) -> u32 {
        let sets = self.sets;
        *self
            .singles
            .entry(mark)
            .or_insert_with(|| locked(sets, |sets| sets.intern(SmallVec::from_slice(&[mark]))))
    }

    #[inline]
    fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == EMPTY || a == b {
            return b;
        }
        if b == EMPTY {
            return a;
        }
        let sets = self.sets;
        *self.unions.entry((a.min(b), a.max(b))).or_insert_with(|| {
            locked(sets, |sets| {
                let mut both: Set = sets.list[a as usize].clone();
                both.extend_from_slice(&sets.list[b as usize]);
                both.sort_unstable();
                both.dedup();
                sets.intern(both)
            })
        })
    }

    #[inline]
    fn meet(&mut self, a: u32, b: u32) -> u32 {
        if a == ALL || a == b {
            return b;
        }
        if a == EMPTY || b == EMPTY {
            return EMPTY;
        }
        let sets = self.sets;
        *self.meets.entry((a.min(b), a.max(b))).or_insert_with(|| {
            locked(sets, |sets| {
                let [p, q] = [a, b].map(|s| &sets.list[s as usize]);
                let both: Set = p.iter().copied().filter(|o| q.contains(o)).collect();
                sets.intern(both)
            })
        })
    }
}

fn locked<T>(sets: &Mutex<Sets>, work: impl FnOnce(&mut Sets) -> T) -> T {
    work(&mut sets.lock().unwrap_or_else(|e| e.into_inner()))
}

/// Stands for no opening.
const NONE: u32 = u32::MAX;

/// Of each edge, the opening in which it lies.
fn marks(graph: &CellGraph, openings: &[Opening]) -> Vec<u32> {
    let mut marks = vec![NONE; graph.edges.len()];
    for (opening, number) in openings.iter().zip(0..) {
        for &e in &opening.edges {
            marks[e.0 as usize] = number;
            if let Some(twin) = graph.edge(e).twin() {
                marks[twin.0 as usize] = number;
            }
        }
    }
    marks
}

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
struct Sweep<'a> {
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
    fn new(
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
            algebra: Algebra {
                sets,
                unions: FxHashMap::default(),
                meets: FxHashMap::default(),
                singles: FxHashMap::default(),
            },
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

    fn about(&mut self, plan: &Plan, group: &Group) {
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

    /// The fan of the vertex, as [`FanWalk`](super::fan::FanWalk) walks it, with the openings passed.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, Subdivision, subdivide};
    use crate::level::toml;
    use crate::pvs::search::search;
    use crate::pvs::sweep::sweep;

    /// Every opening of a level, closed for real.
    fn savings_are_what_closing_saves(text: &str, subdivision: Subdivision) {
        let options = Options {
            subdivision,
            ..Options::default()
        };
        let graph = subdivide(&toml::read(text, "test.toml").unwrap(), &options);
        let pvs = sweep(&graph, &Progress::default());
        let openings = openings(&graph);
        // Weights that tell the cells apart.
        let weights: Vec<[f64; 2]> = (0..graph.cells.len())
            .map(|i| [i as f64, (i * i % 97) as f64])
            .collect();
        let both = |a: usize, b: usize| {
            assert!(a < b);
            [0, 1].map(|k| weights[a][k] + weights[b][k])
        };
        let common = Common::of(&graph, &pvs, &openings, &Progress::default());
        let found = common.savings(both);
        let by_source: Vec<_> = graph
            .cell_ids()
            .map(|c| common.savings_of(c, |b| weights[b]))
            .collect();
        assert!(!openings.is_empty());
        for (i, opening) in openings.iter().enumerate() {
            let less = sweep(&graph.closed(&opening.edges), &Progress::default());
            let mut wanted = Saving::default();
            for a in graph.cell_ids() {
                let mut own = Saving::default();
                for b in pvs.seen_from(a).filter(|&b| !less.sees(a, b)) {
                    own.add(1, weights[b.0 as usize]);
                }
                let of_source = by_source[a.0 as usize].iter().find(|s| s.0 == i as u32);
                assert_eq!(of_source.map_or(Saving::default(), |s| s.1), own);
                wanted.add(own.pairs, own.weights);
            }
            assert_eq!(found[i], wanted, "{opening:?}");
        }
    }

    #[test]
    fn savings_of_sample_levels() {
        for subdivision in Subdivision::ALL {
            savings_are_what_closing_saves(include_str!("../../levels/tiny.toml"), subdivision);
            savings_are_what_closing_saves(include_str!("../../levels/house.toml"), subdivision);
        }
        savings_are_what_closing_saves(include_str!("../../levels/office.toml"), Subdivision::Bsp);
        savings_are_what_closing_saves(include_str!("../../levels/maze.toml"), Subdivision::Kd);
    }

    #[test]
    fn gaps_go_from_wall_to_wall() {
        let rooms = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
            [[room]]\nname = \"B\"\nrect = [4, 0, 10, 4]\n\
            [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";
        let level = toml::read(rooms, "rooms.toml").unwrap();
        let graph = subdivide(&level, &Options::default());
        let openings = openings(&graph);
        assert_eq!(openings.len(), 1);
        let ends = openings[0]
            .ends
            .map(|v| graph.vertices.exact(v).to_level(&graph.grid));
        assert!(ends.iter().all(|p| p.x == 4.0) && (ends[0].y - ends[1].y).abs() == 1.0);
    }

    #[test]
    fn a_wall_in_a_wide_arch() {
        let rooms = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 9]\n\
            [[room]]\nname = \"B\"\nrect = [4, 0, 10, 9]\n\
            [[archway]]\nbetween = [\"A\", \"B\"]\nwidth = 6\n\
            [[pillar]]\nrect = [6, 2, 7, 3]\n";
        let level = toml::read(rooms, "rooms.toml").unwrap();
        let graph = subdivide(&level, &Options::default());
        let before = sweep(&graph, &Progress::default());
        let mut less = 0;
        for opening in openings(&graph) {
            for length in [0.5, 3.0, 100.0] {
                let steps = graph.grid.step.to_steps(length);
                let Some((walled, ends)) = graph.walled(&opening.edges, steps) else {
                    continue;
                };
                walled.validate().unwrap();
                assert_eq!(walled.cells.len(), graph.cells.len());
                let found = graph.grid.step.to_units(ends[0].distance(ends[1]));
                assert!(found <= length + 0.01, "{found}");
                let after = sweep(&walled, &Progress::default());
                let other = search(&walled, None, &Progress::default()).unwrap();
                assert_eq!(after.visible, other.visible);
                let closed = sweep(&graph.closed(&opening.edges), &Progress::default());
                for a in graph.cell_ids() {
                    for b in graph.cell_ids() {
                        assert!(!after.sees(a, b) || before.sees(a, b));
                        assert!(after.sees(a, b) || !closed.sees(a, b));
                    }
                }
                less += usize::from(after.pairs() < before.pairs());
            }
        }
        assert!(less > 1);
    }
}
