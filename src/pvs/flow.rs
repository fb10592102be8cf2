//! Portal flow with separators in floating point, as the Quake tools do it.
//!
//! Source: the visibility programs of id Software's Quake tools (`vis`, 1996) and of ericw-tools
//! (`vis/flow.cc`), which most Quake levels are made with. Written anew from how they work, and
//! brought from space to the plan: a winding is a segment, a plane a line. It is here as the peer
//! that people know, so its epsilon is part of it: points nearer to a line than [`FlowOptions::on`]
//! count as on it, and what has nothing strictly in front is clipped away.
//!
//! 1. *Might see.* From each portal, in each direction, flood through the portals that lie in front
//!    of it and have it behind them.
//! 2. *Flow.* From each portal again, the source, go depth first from leaf to leaf. Each portal on
//!    the way is clipped by separators: lines through one end of the source and one end of the portal
//!    before, which have the two on different sides. What is left of it is the next one to look
//!    through; and the source loses what cannot see it. A way is given up where the leaves that all
//!    its portals might see have been seen.
//! 3. A leaf sees what its portals see.
//!
//! Where it differs from the exact answer: it misses sights thinner than the epsilon, and may show
//! too much, since separators know of the source and the last two portals only, not of those between.
//!
//! What the tools leave to chance is fixed here. They take the portals that might see least first,
//! and let a portal profit from all that happen to be done: here those of earlier waves of
//! [`WAVE`] are, so that the result does not depend on the number of threads. And since "A sees B"
//! may come out unlike "B sees A", the two are joined: a pair is visible if either is.
//!
//! Asked to stop, it leaves undecided, and visible, the pairs of cells with portals not done that
//! might see each other.

mod clip;

use rayon::prelude::*;
use smallvec::SmallVec;

use clip::{Plane, Winding, clip, separators};

use super::flood::components;
use super::{BitMatrix, Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, EdgeId};
use crate::level::Level;

/// Options of [`flow`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowOptions {
    /// Points nearer to a line than this, in grid steps, count as on it.
    pub on: f64,
    /// Whether the source, too, is clipped by separators (the tools' levels 3 and 4, default of
    /// ericw-tools), or only the portals ahead (their levels 1 and 2, default of id Software's).
    /// Each level tries the same lines from the other end as the one before; in the plane, they are
    /// the same two.
    pub clip_source: bool,
}

impl FlowOptions {
    /// The tools' own: a tenth of a map unit, of which 32 make a metre (a player 56 units high
    /// stands for somebody of 1.75 m). A unit of length that is not known counts as a map unit.
    pub fn of(level: &Level) -> Self {
        let units = 0.1 * metres(&level.unit).map_or(1.0, |metres| 1.0 / (32.0 * metres));
        Self {
            on: units / level.grid.step.length(),
            clip_source: true,
        }
    }
}

/// Metres in a unit of length.
fn metres(unit: &str) -> Option<f64> {
    Some(match unit.to_lowercase().as_str() {
        "mm" => 0.001,
        "cm" => 0.01,
        "dm" => 0.1,
        "m" | "metre" | "metres" | "meter" | "meters" => 1.0,
        "km" => 1000.0,
        "in" | "inch" | "inches" => 0.0254,
        "ft" | "foot" | "feet" => 0.3048,
        _ => return None,
    })
}

/// So many portals flow before others profit from what they found.
pub const WAVE: usize = 16;

/// The PVS by portal flow. Uses the current rayon thread pool; the result does not depend on its
/// size, unless it is asked to stop.
pub fn flow(graph: &CellGraph, options: &FlowOptions, progress: &Progress) -> Pvs {
    let ways = Ways::new(graph);
    progress.begin(ways.list.len());
    let component = components(graph);
    let mut seen: Vec<Vec<u64>> = (0..ways.list.len())
        .into_par_iter()
        .map_init(Vec::new, |open, way| {
            if progress.stopped() {
                ways.are_connected(way, &component)
            } else {
                ways.might_see(way, options.on, open)
            }
        })
        .collect();
    let (steps, undone) = flow_in_waves(&ways, options, &mut seen, progress);
    let mut open = BitMatrix::new(ways.n_cells);
    for (way, found) in undone {
        let might = std::mem::replace(&mut seen[way], found);
        let row = open.row_mut(ways.list[way].from as usize);
        row.iter_mut().zip(might).for_each(|(w, m)| *w |= m);
    }
    let mut visible = ways.union(&seen);
    let mut undecided = 0;
    for a in 0..ways.n_cells {
        for b in open.ones(a).filter(|&b| open.get(b, a)) {
            if !visible.get(a, b) {
                visible.set(a, b);
                undecided += 1;
            }
        }
    }
    Pvs {
        visible,
        method: Method::Flow,
        class: Class::Approximate,
        heights: false,
        undecided,
        steps,
    }
}

/// Turns what each way might see into what it sees, from the least to the most. Returns the cells
/// entered, and the ways for which there was no time left, with what they saw before.
fn flow_in_waves(
    ways: &Ways,
    options: &FlowOptions,
    seen: &mut [Vec<u64>],
    progress: &Progress,
) -> (u64, Vec<(usize, Vec<u64>)>) {
    let count = |row: &Vec<u64>| row.iter().map(|w| w.count_ones()).sum();
    let mut order: Vec<(u32, usize)> = seen.iter().map(count).zip(0..).collect();
    order.sort_unstable();
    let (mut steps, mut undone) = (0, Vec::new());
    for wave in order.chunks(WAVE) {
        let flown: Vec<_> = wave
            .par_iter()
            .map_init(
                || Flow::new(ways, seen, options, progress),
                |flow, &(_, way)| {
                    let done = flow.through(way);
                    progress.advance(1);
                    (way, done, flow.visible.clone(), flow.steps)
                },
            )
            .collect();
        for (way, done, visible, entered) in flown {
            steps += entered;
            if done {
                seen[way] = visible;
            } else {
                undone.push((way, visible));
            }
        }
    }
    (steps, undone)
}

/// A portal in one direction.
struct Way {
    /// The cell that it leads out of.
    from: u32,
    /// The cell that it leads into.
    cell: u32,
    winding: Winding,
    /// Its front is in that cell.
    plane: Plane,
}

/// All portals, in both directions.
struct Ways {
    list: Vec<Way>,
    /// Those out of cell i are `list[out[i]..out[i + 1]]`.
    out: Vec<usize>,
    n_cells: usize,
}

impl Ways {
    fn new(graph: &CellGraph) -> Self {
        let mut list = Vec::with_capacity(2 * graph.portals.len());
        let mut out = vec![0];
        for cell in graph.cell_ids() {
            for e in graph.edge_range(cell).map(EdgeId) {
                let Some(twin) = graph.edge(e).twin() else {
                    continue;
                };
                let ends = [graph.edge(e).origin, graph.end(e)];
                let winding = ends.map(|v| graph.vertices.approx(v));
                // The cell lies on the edge's left, so what is beyond on the right.
                let normal = -(winding[1] - winding[0]).normalize_or_zero().perp();
                list.push(Way {
                    from: cell.0,
                    cell: graph.edge(twin).cell.0,
                    winding,
                    plane: Plane {
                        normal,
                        distance: normal.dot(winding[0]),
                    },
                });
            }
            out.push(list.len());
        }
        Self {
            list,
            out,
            n_cells: graph.cells.len(),
        }
    }

    fn out_of(&self, cell: u32) -> std::ops::Range<usize> {
        self.out[cell as usize]..self.out[cell as usize + 1]
    }

    fn stride(&self) -> usize {
        self.n_cells.div_ceil(64)
    }

    /// The cells that a flood reaches through portals in front of this one that have it behind them.
    fn might_see(&self, way: usize, on: f64, open: &mut Vec<u32>) -> Vec<u64> {
        let base = &self.list[way];
        let faces = |k: usize| {
            let other = &self.list[k];
            let before = |plane: &Plane, w: Winding| w.map(|p| plane.before(p));
            let [a, b] = before(&base.plane, other.winding);
            let [c, d] = before(&other.plane, base.winding);
            (a > -on || b > -on) && (c < on || d < on)
        };
        let mut row = vec![0u64; self.stride()];
        set(&mut row, base.cell);
        open.push(base.cell);
        while let Some(cell) = open.pop() {
            for k in self.out_of(cell).filter(|&k| k != way) {
                let next = self.list[k].cell;
                if !get(&row, next) && faces(k) {
                    set(&mut row, next);
                    open.push(next);
                }
            }
        }
        row
    }

    /// The cells that any way through portals leads to.
    fn are_connected(&self, way: usize, component: &[u32]) -> Vec<u64> {
        let own = component[self.list[way].cell as usize];
        let mut row = vec![0u64; self.stride()];
        let connected = (0u32..).zip(component).filter(|&(_, &c)| c == own);
        connected.for_each(|(cell, _)| set(&mut row, cell));
        row
    }

    /// Every cell sees what the ways out of it see; joined with the transpose.
    fn union(&self, seen: &[Vec<u64>]) -> BitMatrix {
        let mut visible = BitMatrix::new(self.n_cells);
        visible.par_rows_mut().enumerate().for_each(|(cell, row)| {
            for way in self.out_of(cell as u32) {
                row.iter_mut().zip(&seen[way]).for_each(|(w, s)| *w |= s);
            }
        });
        visible.symmetric()
    }
}

#[inline]
fn get(row: &[u64], cell: u32) -> bool {
    row[cell as usize / 64] >> (cell % 64) & 1 != 0
}

#[inline]
fn set(row: &mut [u64], cell: u32) {
    row[cell as usize / 64] |= 1 << (cell % 64);
}

/// A cell on the current chain, with the way out of it to try next.
struct Frame {
    cell: u32,
    next: usize,
    /// The portal through which the chain entered; its front is in this cell.
    entry: Plane,
    /// What of the source sees as far as here.
    source: Winding,
    /// What of the portal of entry is seen from there; `None` in the first cell.
    pass: Option<Winding>,
    /// The separators of the two, once they are needed.
    separators: Option<SmallVec<[Plane; 2]>>,
}

/// Flows through one way after the other.
struct Flow<'a> {
    ways: &'a Ways,
    seen: &'a [Vec<u64>],
    options: &'a FlowOptions,
    progress: &'a Progress,
    frames: Vec<Frame>,
    on_chain: Vec<bool>,
    /// What the chain might see beyond each frame: a row for each, and one for the frame to come.
    might: Vec<u64>,
    /// What has been seen.
    visible: Vec<u64>,
    /// Cells entered.
    steps: u64,
}

impl<'a> Flow<'a> {
    fn new(
        ways: &'a Ways,
        seen: &'a [Vec<u64>],
        options: &'a FlowOptions,
        progress: &'a Progress,
    ) -> Self {
        Self {
            ways,
            seen,
            options,
            progress,
            frames: Vec::new(),
            on_chain: vec![false; ways.n_cells],
            might: Vec::new(),
            visible: vec![0; ways.stride()],
            steps: 0,
        }
    }

    /// Finds what a way sees. False if there was no time left to finish.
    fn through(&mut self, way: usize) -> bool {
        let base = &self.ways.list[way];
        self.visible.fill(0);
        self.steps = 0;
        self.might.clear();
        self.might.extend(&self.seen[way]);
        self.enter(Frame {
            cell: base.cell,
            next: self.ways.out_of(base.cell).start,
            entry: base.plane,
            source: base.winding,
            pass: None,
            separators: None,
        });
        let mut done = true;
        while let Some(frame) = self.frames.last_mut() {
            done &= !self.progress.stopped();
            let k = frame.next;
            if k == self.ways.out_of(frame.cell).end || !done {
                self.on_chain[frame.cell as usize] = false;
                self.frames.pop();
                continue;
            }
            frame.next += 1;
            if !self.may_show(k) {
                continue;
            }
            // The tools ask whether there is more to see before they clip anything. That does not
            // change the answer; on the plan, clipping is the cheaper question.
            let frame = self.frames.last_mut().expect("it was there above");
            let next = frame.step(&base.plane, self.ways, k, self.options);
            if let Some(next) = next.filter(|_| self.may_show_more(k)) {
                self.enter(next);
            }
        }
        done
    }

    fn enter(&mut self, frame: Frame) {
        set(&mut self.visible, frame.cell);
        self.on_chain[frame.cell as usize] = true;
        self.frames.push(frame);
        self.steps += 1;
    }

    /// Whether the chain might go on through a way out.
    fn may_show(&self, k: usize) -> bool {
        let cell = self.ways.list[k].cell;
        let depth = self.frames.len() - 1;
        let might = &self.might[depth * self.visible.len()..];
        get(might, cell) && !self.on_chain[cell as usize]
    }

    /// Whether the way out might show anything that has not been seen yet; leaves what it might show
    /// where the next frame finds it.
    fn may_show_more(&mut self, k: usize) -> bool {
        let stride = self.visible.len();
        let depth = self.frames.len() - 1;
        self.might.resize((depth + 2) * stride, 0);
        let (before, after) = self.might.split_at_mut((depth + 1) * stride);
        let before = &before[depth * stride..];
        let mut more = 0;
        let rows = before.iter().zip(&self.seen[k]).zip(&self.visible);
        for (after, ((before, test), visible)) in after.iter_mut().zip(rows) {
            *after = before & test;
            more |= *after & !visible;
        }
        more != 0
    }
}

impl Frame {
    /// The frame beyond a way out of this one's cell, if anything of that way is seen from the
    /// source, whose plane is `base`.
    fn step(
        &mut self,
        base: &Plane,
        ways: &Ways,
        k: usize,
        options: &FlowOptions,
    ) -> Option<Frame> {
        /// Normals that differ by less in each coordinate are the same, as in the tools.
        const SAME_NORMAL: f64 = 0.001;
        let (on, way) = (options.on, &ways.list[k]);
        let turn = (self.entry.normal + way.plane.normal).abs();
        if turn.max_element() < SAME_NORMAL {
            // In line with the portal of entry.
            return None;
        }
        let beyond = |source, pass| Frame {
            cell: way.cell,
            next: ways.out_of(way.cell).start,
            entry: way.plane,
            source,
            pass: Some(pass),
            separators: None,
        };
        let target = clip(way.winding, base, on)?;
        let Some(pass) = self.pass else {
            return Some(beyond(self.source, target));
        };
        let mut target = clip(target, &self.entry, on)?;
        let mut source = clip(self.source, &way.plane.flipped(), on)?;
        let ahead = self
            .separators
            .get_or_insert_with(|| separators(self.source, pass, on));
        for plane in ahead {
            target = clip(target, plane, on)?;
        }
        if options.clip_source {
            for plane in separators(target, pass, on) {
                source = clip(source, &plane, on)?;
            }
        }
        Some(beyond(source, target))
    }
}
