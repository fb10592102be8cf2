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

mod about;
mod pairs;
mod sets;

use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use rayon::prelude::*;

use self::about::Sweep;
use self::pairs::Pairs;
use self::sets::{Set, Sets};
use super::flat::FlatMesh;
use super::sweep::{Group, Span, plan};
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
