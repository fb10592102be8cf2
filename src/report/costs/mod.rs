//! What the places of a level cost, why, and what could be changed: figures for its designer.
//!
//! In: a level, its cells and its exact PVS. Out: [`Costs`]: what every cell sees, what closing each
//! opening would save, the dearest places, the longest sightlines, and the same by room. The page
//! ([`super::page`]) and the JSON ([`json`]) are two views of it.
//!
//! A cell *costs* what a program has to draw, send or simulate for somebody who stands in it: all
//! that lies in the cells that it sees.

pub mod baseline;
pub mod budget;
mod gaps;
pub mod json;
mod lanes;
mod measure;
mod rooms;

use rayon::prelude::*;
use serde::Serialize;

pub use gaps::{Gap, Hides, Wall, Worst};
pub use lanes::Lane;
pub use measure::{Measure, Spread, Tally};
pub use rooms::{Room, Rooms};

use crate::cells::{CellGraph, CellId};
use crate::level::{Finding, Level};
use crate::pvs::longest::{Line, Longest, longest};
use crate::pvs::{Progress, Pvs};

/// Figures of a level.
pub struct Costs<'a> {
    /// The level.
    pub level: &'a Level,
    /// Its cells.
    pub graph: &'a CellGraph,
    /// Who sees whom, exactly.
    pub pvs: &'a Pvs,
    /// What is in each cell.
    pub own: Vec<Tally>,
    /// What is in the cells that each cell sees, itself included.
    pub seen: Vec<Tally>,
    /// The longest lines.
    pub longest: Longest,
    /// Straight gaps between walls, those first whose closing saves most.
    pub gaps: Vec<Gap>,
    /// The dearest places, the dearest first.
    pub worst: Vec<Worst>,
    /// The longest sightlines, each another lane, the longest first.
    pub lanes: Vec<Lane>,
    /// The same by room or sector.
    pub rooms: Rooms,
    /// What `check` finds.
    pub findings: Vec<Finding>,
    /// What the figures cost.
    pub seconds: CostSeconds,
}

/// How long each part took, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CostSeconds {
    /// Adding up what every cell sees.
    pub sums: f64,
    /// What closing each opening would save.
    pub closing: f64,
    /// What walls of a given length would save.
    pub walls: f64,
    /// The longest lines.
    pub lines: f64,
    /// Looking for defects.
    pub findings: f64,
    /// Thumbnails.
    pub pictures: f64,
}

/// Places and lanes that are listed.
pub const LISTED: usize = 10;

/// A clock: seconds since some moment.
pub type Clock<'a> = &'a dyn Fn() -> f64;

impl<'a> Costs<'a> {
    /// Computes all figures. `pvs` is the exact one on the plan; `wall` is a length that is tried in the
    /// first gaps. Uses the current rayon thread pool;
    /// only the seconds differ between two runs.
    pub fn of(
        level: &'a Level,
        graph: &'a CellGraph,
        pvs: &'a Pvs,
        wall: Option<f64>,
        clock: Clock,
        progress: &Progress,
    ) -> Self {
        let mut seconds = CostSeconds::default();
        let mut last = clock();
        let mut lap = || {
            let now = clock();
            let took = now - last;
            last = now;
            took
        };
        let own = measure::own(level, graph);
        let seen = measure::seen(level, graph, pvs, &own);
        let rooms = Rooms::of(level, graph, pvs, &own, &seen);
        seconds.sums = lap();
        let (mut gaps, worst) = gaps::of(level, graph, pvs, &own, &seen, progress);
        seconds.closing = lap();
        if let Some(length) = wall {
            gaps::put_walls(graph, pvs, &mut gaps, length);
            seconds.walls = lap();
        }
        let longest = longest(graph);
        let lanes = lanes::of(level, graph, &longest, LISTED);
        seconds.lines = lap();
        let mut findings = level.findings.clone();
        findings.extend(graph.findings.iter().cloned());
        findings.extend(super::check::of_cells(level, graph));
        findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
        seconds.findings = lap();
        Costs {
            level,
            graph,
            pvs,
            own,
            seen,
            longest,
            gaps,
            worst,
            lanes,
            rooms,
            findings,
            seconds,
        }
    }

    /// What all cells hold together.
    pub fn total(&self) -> Tally {
        let mut total = Tally::default();
        self.own.iter().for_each(|t| total.add(t));
        total
    }

    /// A measure of a cell's cost.
    pub fn value(&self, measure: Measure, cell: CellId) -> f64 {
        match measure {
            Measure::Sightline => self.sightline(cell).map_or(0.0, |l| self.length(l)),
            _ => self.seen[cell.0 as usize].get(measure),
        }
    }

    /// The line from a cell to the farthest point that is seen from one of its corners.
    pub fn sightline(&self, cell: CellId) -> Option<&Line> {
        self.longest.from_cell[cell.0 as usize].as_ref()
    }

    /// A line's length in the level's unit.
    pub fn length(&self, line: &Line) -> f64 {
        self.graph.grid.step.to_units(line.length())
    }

    /// How a measure is distributed over the cells.
    pub fn spread(&self, measure: Measure) -> Spread {
        let values = self.graph.cell_ids().map(|c| self.value(measure, c));
        Spread::of(values.collect())
    }

    /// The measures that tell this level's cells apart.
    pub fn measures(&self) -> Vec<Measure> {
        let any = |m: &Measure| self.graph.cell_ids().any(|c| self.value(*m, c) > 0.0);
        Measure::ALL.into_iter().filter(any).collect()
    }

    /// The measure by which places are called dear: polygons where the level has heights.
    pub fn main_measure(&self) -> Measure {
        gaps::main_measure(&self.own)
    }

    /// The cells that dominate most others, with how many: a cell dominates another if it sees it and
    /// everything that the other sees, and more. Of cells that see the same, the first is named.
    pub fn dominant(&self, n: usize) -> Vec<(CellId, u32)> {
        let visible = &self.pvs.visible;
        let within = |a: &[u64], b: &[u64]| a.iter().zip(b).all(|(a, b)| a & !b == 0);
        let count = |cell: usize| {
            let row = visible.row(cell);
            let below = |&b: &usize| visible.row(b) != row && within(visible.row(b), row);
            visible.ones(cell).filter(below).count() as u32
        };
        let counts: Vec<u32> = (0..visible.n()).into_par_iter().map(count).collect();
        let mut order: Vec<usize> = (0..visible.n()).collect();
        order.sort_by_key(|&c| std::cmp::Reverse(counts[c]));
        let mut chosen: Vec<usize> = Vec::new();
        for &c in &order {
            if chosen.len() == n || counts[c] == 0 {
                break;
            }
            if chosen.iter().all(|&d| visible.row(d) != visible.row(c)) {
                chosen.push(c);
            }
        }
        let found = chosen.into_iter();
        found.map(|c| (CellId(c as u32), counts[c])).collect()
    }

    /// The length of the level's longest sightline, in its unit.
    pub fn longest_sightline(&self) -> f64 {
        self.longest.lines.first().map_or(0.0, |l| self.length(l))
    }
}

/// The name of a cell's room, or `sector 12`.
pub fn room_of(level: &Level, graph: &CellGraph, cell: CellId) -> Option<String> {
    let id = graph.cell(cell).sector?;
    let name = level.sectors.get(id.0 as usize)?.name.clone();
    Some(name.unwrap_or_else(|| format!("sector {}", id.0)))
}
