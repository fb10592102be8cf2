//! What is run, in which order, and how the budget is shared out.
//!
//! Every trial runs once first. Those that may take long come late and have a limit: their share of
//! what the others have left. Then all that came to an end run again, in turn, so that the machine's
//! moods meet all of them, for as long as that needs little of the budget.

use super::record::{Spread, State};
use super::{Bench, Cost, StudyOptions};
use crate::cells::{CellGraph, Options, Subdivision, subdivide};
use crate::level::Level;
use crate::level::wording::{count, duration, grouped};
use crate::pvs::flow::FlowOptions;
use crate::pvs::heights::HeightsOptions;
use crate::pvs::sample::SampleOptions;
use crate::pvs::{self, Method, Progress, Pvs, PvsOptions};

/// Random sightlines from every cell.
const RAYS: [u32; 5] = [10, 100, 1000, 10_000, 100_000];
/// Parts into which the lines through one chain may be split, with heights.
const SPLITS: [u32; 6] = [1, 4, 16, 64, 256, 1024];
/// The part of the budget that is over when no further subdivision is begun; when everything has run
/// once; when it has run again; and when the pairs in which methods differ are looked up.
const PREPARED: f64 = 0.3;
const ONCE: f64 = 0.7;
const AGAIN: f64 = 0.85;
pub(super) const PAIRS: f64 = 0.95;
/// Runs of one trial: enough for a median; and more, as long as they take next to no time.
const ENOUGH: usize = 5;
const MANY: usize = 15;
const NO_TIME: f64 = 0.3;
/// The part of the budget that one trial's further runs may take.
const EACH: f64 = 0.05;

/// A subdivision of the level, and its exact answer.
pub(super) struct Ground {
    pub graph: CellGraph,
    pub truth: Pvs,
}

/// Something that is run and timed.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub work: Work,
    /// Index of its ground, and how that is cut.
    pub ground: usize,
    pub subdivision: Subdivision,
    /// How much of the time it may have, compared with others.
    share: f64,
    pub state: State,
    pub limit: Option<f64>,
    pub times: Vec<f64>,
    pub bytes: Option<u64>,
    /// The answer of the first run.
    pub pvs: Option<Pvs>,
    /// Why it was left out.
    pub reason: String,
}

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Work {
    Cut(Options),
    See(PvsOptions),
}

impl Trial {
    fn new(work: Work, (ground, subdivision): (usize, Subdivision), share: f64) -> Self {
        Self {
            work,
            ground,
            subdivision,
            share,
            state: State::LeftOut,
            limit: None,
            times: Vec::new(),
            bytes: None,
            pvs: None,
            reason: String::new(),
        }
    }

    /// Notes its first run.
    fn note(&mut self, cost: Cost, state: State) {
        self.times.push(cost.seconds);
        self.bytes = cost.bytes;
        self.state = state;
    }

    pub fn spread(&self) -> Option<Spread> {
        Spread::of(&self.times)
    }

    /// What people call it.
    pub fn label(&self) -> String {
        match &self.work {
            Work::Cut(options) => format!("cutting by {}", options.subdivision.as_str()),
            Work::See(options) => match (&options.heights, options.method) {
                (Some(heights), _) => {
                    format!("heights, {}", count(heights.splits as usize, "split"))
                }
                (None, Method::Sample) => {
                    format!("sample, {} rays", grouped(options.sample.rays.into()))
                }
                (None, method) => method.as_str().to_string(),
            },
        }
    }
}

/// Runs trials one after the other.
pub(super) struct Schedule<'a> {
    level: &'a Level,
    budget: f64,
    bench: &'a mut dyn Bench,
    pub grounds: Vec<Ground>,
    pub trials: Vec<Trial>,
}

/// Runs everything that the budget has room for.
pub(super) fn run_all<'a>(
    level: &'a Level,
    options: &StudyOptions,
    bench: &'a mut dyn Bench,
) -> Schedule<'a> {
    let mut schedule = Schedule {
        level,
        budget: options.budget,
        bench,
        grounds: Vec::new(),
        trials: Vec::new(),
    };
    let own = options.cells.subdivision;
    let others = Subdivision::ALL.into_iter().filter(|s| *s != own);
    for subdivision in std::iter::once(own).chain(others) {
        // Without the first there is no study.
        if schedule.grounds.is_empty() || schedule.bench.now() < PREPARED * options.budget {
            schedule.prepare(Options {
                subdivision,
                ..options.cells
            });
        }
    }
    let prepared = schedule.trials.len();
    let further = trials(level, options, &schedule.grounds);
    schedule.trials.extend(further);
    for i in prepared..schedule.trials.len() {
        schedule.first(i, prepared);
    }
    schedule.again();
    schedule
}

/// All trials but the cutting and the sweeps, those that take longest last.
fn trials(level: &Level, options: &StudyOptions, grounds: &[Ground]) -> Vec<Trial> {
    let with = |method| method_of(level, method, options.seed);
    let mut list = Vec::new();
    let mut add = |options, ground: usize, share| {
        let subdivision = grounds[ground].graph.options.subdivision;
        list.push(Trial::new(Work::See(options), (ground, subdivision), share));
    };
    add(with(Method::Flood), 0, 0.2);
    let on_others = [
        (Method::Flood, 0.2),
        (Method::Flow, 1.0),
        (Method::Search, 1.0),
    ];
    for ground in 1..grounds.len() {
        for (method, share) in on_others {
            add(with(method), ground, share);
        }
    }
    add(with(Method::Flow), 0, 3.0);
    add(with(Method::Search), 0, 3.0);
    if grounds.first().is_some_and(|g| has_heights(&g.graph)) {
        for splits in SPLITS {
            let mut options = with(Method::Search);
            options.heights = Some(HeightsOptions { splits });
            add(options, 0, 1.0);
        }
    }
    for rays in RAYS {
        let mut options = with(Method::Sample);
        options.sample.rays = rays;
        add(options, 0, if rays < 10_000 { 1.0 } else { 4.0 });
    }
    add(with(Method::Lp), 0, 6.0);
    list
}

fn method_of(level: &Level, method: Method, seed: u64) -> PvsOptions {
    PvsOptions {
        method,
        heights: None,
        max_steps: None,
        sample: SampleOptions {
            seed,
            ..SampleOptions::default()
        },
        flow: FlowOptions::of(level),
    }
}

/// Whether there are floors and ceilings to count.
fn has_heights(graph: &CellGraph) -> bool {
    graph.portals.iter().any(|p| p.bottom.is_some())
}

impl Schedule<'_> {
    /// Cuts the level and finds the exact answer: that has no limit, for nothing goes without it.
    fn prepare(&mut self, options: Options) {
        let ground = (self.grounds.len(), options.subdivision);
        let level = self.level;
        let mut cut = Trial::new(Work::Cut(options), ground, 0.0);
        self.bench.next(&cut.label());
        let mut graph = None;
        let work = &mut |_: &Progress| graph = Some(subdivide(level, &options));
        let cost = self.bench.run(None, work);
        cut.note(cost, State::Complete);
        let Some(graph) = graph else { return };
        let see = method_of(level, Method::Sweep, 0);
        let mut sweep = Trial::new(Work::See(see), ground, 0.0);
        self.bench.next(&format!(
            "the exact answer on {}",
            options.subdivision.as_str()
        ));
        let mut truth = None;
        let work = &mut |progress: &Progress| truth = pvs::compute(&graph, &see, progress);
        let cost = self.bench.run(None, work);
        sweep.note(cost, State::Complete);
        let Some(truth) = truth else { return };
        self.grounds.push(Ground { graph, truth });
        self.trials.extend([cut, sweep]);
    }

    /// Runs a trial for the first time, within its share of what is left.
    fn first(&mut self, i: usize, prepared: usize) {
        let n = self.trials.len();
        let open: f64 = self.trials[i..].iter().map(|t| t.share).sum();
        let left = ONCE * self.budget - self.bench.now();
        let expected = self.expected(i);
        let trial = &mut self.trials[i];
        let limit = left * trial.share / open;
        if limit <= 0.0 {
            trial.reason = "no time was left".to_string();
            return;
        }
        if let Some(expected) = expected.filter(|e| *e > limit) {
            trial.reason = match expected {
                e if e.is_finite() => format!("it would have taken about {}", duration(e)),
                _ => "fewer took too long already".to_string(),
            };
            return;
        }
        let Work::See(options) = trial.work else {
            return;
        };
        let graph = &self.grounds[trial.ground].graph;
        let label = trial.label();
        let (number, of) = (i + 1 - prepared, n - prepared);
        self.bench.next(&format!("{number} of {of}: {label}"));
        let mut answer = None;
        let work = &mut |progress: &Progress| answer = pvs::compute(graph, &options, progress);
        let cost = self.bench.run(Some(limit), work);
        let state = match &answer {
            None => State::GaveUp,
            // Some take no notice, and some were done all the same.
            Some(pvs) if cost.stopped && pvs.undecided > 0 => State::CutShort,
            Some(_) => State::Complete,
        };
        trial.note(cost, state);
        trial.limit = Some(limit);
        trial.pvs = answer;
    }

    /// What a trial with more random sightlines will take, judging by the one before it.
    fn expected(&self, i: usize) -> Option<f64> {
        let rays = |trial: &Trial| match &trial.work {
            Work::See(o) if o.method == Method::Sample => Some(f64::from(o.sample.rays)),
            _ => None,
        };
        let own = rays(&self.trials[i])?;
        let before = &self.trials[i.checked_sub(1)?];
        let ratio = own / rays(before)?;
        Some(before.times.first().map_or(f64::INFINITY, |s| s * ratio))
    }

    /// Runs what came to an end again and again, in turn, the shortest first.
    fn again(&mut self) {
        let complete = |&i: &usize| self.trials[i].state == State::Complete;
        let mut open: Vec<usize> = (0..self.trials.len()).filter(complete).collect();
        open.sort_by(|&i, &j| self.trials[i].times[0].total_cmp(&self.trials[j].times[0]));
        while !open.is_empty() {
            open.retain(|&i| {
                let times = &self.trials[i].times;
                let (runs, next) = (times.len(), times[0]);
                let spent = times[1..].iter().sum::<f64>() + next;
                let wanted = runs < ENOUGH || runs < MANY && spent < NO_TIME;
                let room =
                    spent <= EACH * self.budget && self.bench.now() + next <= AGAIN * self.budget;
                if wanted && room {
                    self.repeat(i);
                }
                wanted && room
            });
        }
    }

    fn repeat(&mut self, i: usize) {
        let (level, trial) = (self.level, &mut self.trials[i]);
        let graph = &self.grounds[trial.ground].graph;
        self.bench.next(&format!("once more: {}", trial.label()));
        let cost = match trial.work {
            Work::Cut(options) => self
                .bench
                .run(None, &mut |_| drop(subdivide(level, &options))),
            Work::See(options) => self.bench.run(None, &mut |progress| {
                drop(pvs::compute(graph, &options, progress));
            }),
        };
        trial.times.push(cost.seconds);
    }
}
