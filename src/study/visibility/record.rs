//! The figures of a study, as they stand in its JSON. Every field is a key there; keys stay what
//! they are, others may be added.

use std::collections::BTreeMap;

use serde::Serialize;

use super::accuracy::{Accuracy, Error};
use crate::level::Level;

/// The whole JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct Results {
    /// `"enfilade.study"`
    pub format: &'static str,
    /// 1
    pub version: u32,
    /// `"visibility"`
    pub kind: &'static str,
    /// The level.
    pub level: LevelFacts,
    /// What was asked for, and where it ran.
    pub setting: Setting,
    /// Seconds that the whole study took.
    pub seconds: f64,
    /// Cells of the subdivision on which the methods are compared.
    pub cells: usize,
    /// Portals of that subdivision.
    pub portals: usize,
    /// What the methods are compared with.
    pub truth: Truth,
    /// The methods, with the different numbers of random sightlines.
    pub methods: Vec<Run>,
    /// The pairs of cells about which a method errs, for each that does.
    pub differences: Vec<Differences>,
    /// The subdivisions, the one above among them.
    pub subdivisions: Vec<Subdivided>,
    /// With floors and ceilings; null where the level has none.
    pub heights: Option<Heights>,
    /// What was cut short or left out, in words.
    pub notes: Vec<String>,
}

/// The level, as in the JSON of `build`.
#[derive(Clone, Debug, Serialize)]
pub struct LevelFacts {
    /// Its name.
    pub name: String,
    /// Its file, without the folder.
    pub source: String,
    /// Its unit of length.
    pub unit: String,
    /// Points in which walls end.
    pub vertices: usize,
    /// Walls.
    pub walls: usize,
    /// Sectors.
    pub sectors: usize,
    /// The farthest that a point was moved onto the grid.
    pub snap: f64,
}

impl LevelFacts {
    pub(super) fn of(level: &Level) -> Self {
        Self {
            name: level.name.clone(),
            source: level.source.clone(),
            unit: level.unit.clone(),
            vertices: level.n_vertices,
            walls: level.walls.len(),
            sectors: level.sectors.len(),
            snap: level.snap,
        }
    }
}

/// What was asked for, and where it ran.
#[derive(Clone, Debug, Serialize)]
pub struct Setting {
    /// Version of enfilade.
    pub enfilade: &'static str,
    /// The machine, in words.
    pub machine: String,
    /// Threads that the methods had.
    pub threads: usize,
    /// Seed of all that is random.
    pub seed: u64,
    /// Seconds that the study was given.
    pub budget: f64,
    /// The subdivision on which the methods are compared.
    pub subdivision: &'static str,
    /// Whether closed doors count as open.
    pub doors: &'static str,
}

/// The exact answer.
#[derive(Clone, Debug, Serialize)]
pub struct Truth {
    /// Who gave it.
    pub method: &'static str,
    /// Ordered pairs of cells that see each other, (i, i) included, as `build` counts.
    pub pairs: u64,
    /// Those as a share of all pairs.
    pub density: f64,
    /// Whether the other exact method found the same; null if it did not finish.
    pub agreed: Option<bool>,
}

/// A method with its parameters, its times and its answer.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// The method's name.
    pub method: &'static str,
    /// The method and what tells it from others of its kind, for people.
    pub label: String,
    /// `rays` and `seed` of random sightlines, `on` (a distance in grid steps) of the portal flow,
    /// `splits` with heights.
    pub parameters: BTreeMap<&'static str, f64>,
    /// What the method promises.
    pub class: &'static str,
    /// How it ended.
    pub state: State,
    /// Seconds that it was given, for those that can be stopped.
    pub limit: Option<f64>,
    /// What it took; null if it was left out.
    pub seconds: Option<Spread>,
    /// The median, in medians of the fastest exact method.
    pub relative: Option<f64>,
    /// The most bytes that it held on the heap beyond those there before; null where not measured.
    pub bytes: Option<u64>,
    /// Its answer; null if it gave none.
    pub answer: Option<Answer>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum State {
    /// It came to its own end.
    #[serde(rename = "complete")]
    Complete,
    /// Its time was over; what was open counts as visible.
    #[serde(rename = "cut short")]
    CutShort,
    /// Its time was over, and there is no answer.
    #[serde(rename = "gave up")]
    GaveUp,
    /// It was not tried.
    #[serde(rename = "left out")]
    LeftOut,
}

/// Seconds over several runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// The one in the middle.
    pub median: f64,
    /// The least.
    pub min: f64,
    /// The greatest.
    pub max: f64,
    /// How many runs.
    pub runs: usize,
}

impl Spread {
    /// Of at least one time.
    pub(crate) fn of(times: &[f64]) -> Option<Self> {
        let mut sorted = times.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (min, max) = (*sorted.first()?, *sorted.last()?);
        let n = sorted.len();
        Some(Self {
            median: (sorted[(n - 1) / 2] + sorted[n / 2]) / 2.0,
            min,
            max,
            runs: n,
        })
    }
}

/// A visible set, compared with the exact one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Answer {
    /// Ordered pairs of cells that it calls visible, (i, i) included.
    pub pairs: u64,
    /// Those of them for which there is no proof.
    pub undecided: u64,
    /// Those as a share of the pairs.
    pub undecided_share: f64,
    /// Elementary steps that the method took.
    pub steps: u64,
    /// How far it is from the truth.
    #[serde(flatten)]
    pub accuracy: Accuracy,
}

/// About which pairs a method errs.
#[derive(Clone, Debug, Serialize)]
pub struct Differences {
    /// The method.
    pub method: &'static str,
    /// The run's label.
    pub label: String,
    /// Pairs that it invents; (a, b) and (b, a) are one.
    pub invented: u64,
    /// Pairs that it misses, counted likewise.
    pub missed: u64,
    /// Some of them, those that a picture shows best: for `lp` and `flow` at most 16 of each kind.
    pub pairs: Vec<WrongPair>,
}

/// A pair of cells about which a method errs.
#[derive(Clone, Debug, Serialize)]
pub struct WrongPair {
    /// Which way.
    pub error: Error,
    /// The cells, numbered as in the JSON of `build`.
    pub cells: [u32; 2],
    /// A point inside each.
    pub places: [[f64; 2]; 2],
    /// Each one's sector.
    pub sectors: [Option<u32>; 2],
    /// For a missed pair: a free segment between the two, checked exactly before it was rounded.
    pub witness: Option<[[f64; 2]; 2]>,
    /// For a missed pair: how wide the view is, in the level's unit.
    pub width: Option<f64>,
    /// For an invented pair: the shortest way on foot from the one to the other.
    pub way: Vec<[f64; 2]>,
    /// For an invented pair: the corners, at most four, between which no straight line passes along
    /// this way.
    pub ends: Vec<[f64; 2]>,
    /// Whether the level's own walls, asked without any of the methods, say the same as the exact
    /// answer: that the segment is free, or that none is.
    pub confirmed: bool,
}

/// A way to cut the level into cells.
#[derive(Clone, Debug, Serialize)]
pub struct Subdivided {
    /// Its name.
    pub subdivision: &'static str,
    /// Its cells.
    pub cells: usize,
    /// Its portals.
    pub portals: usize,
    /// Ordered pairs of its cells that see each other.
    pub pairs: u64,
    /// Those as a share of all pairs.
    pub density: f64,
    /// The share of the floor that lies in cells seen from a point's cell, on average over all
    /// points of the floor.
    pub floor: f64,
    /// Seconds for cutting.
    pub subdivide: Spread,
    /// Seconds for the exact answer.
    pub sweep: Spread,
    /// Other methods on these cells, compared with their exact answer.
    pub methods: Vec<Run>,
}

/// Visibility with floors and ceilings.
#[derive(Clone, Debug, Serialize)]
pub struct Heights {
    /// Ordered pairs of the tightest upper answer: visible by all runs.
    pub pairs: u64,
    /// Those as a share of all pairs.
    pub density: f64,
    /// The exact answer without heights, compared with the tightest one.
    pub planar: Answer,
    /// With growing budgets of splits, each compared with the tightest one.
    pub runs: Vec<Run>,
}
