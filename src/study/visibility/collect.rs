//! From trials to figures.

use std::collections::BTreeMap;

use super::accuracy::{Accuracy, Error, accuracy};
use super::differ::{LISTED, area, look_up, telling};
use super::record::*;
use super::steps::{Ground, PAIRS, Schedule, Trial, Work, run_all};
use super::{Bench, Study, StudyOptions};
use crate::cells::CellGraph;
use crate::level::Level;
use crate::level::wording::{duration, grouped};
use crate::pvs::verify::Caster;
use crate::pvs::{BitMatrix, Method, Pvs, PvsOptions};

/// Studies a level; `None` if it has no inside.
pub fn study(level: &Level, options: &StudyOptions, bench: &mut dyn Bench) -> Option<Study> {
    let Schedule {
        mut grounds,
        trials,
        ..
    } = run_all(level, options, bench);
    let ground = grounds.first().filter(|g| !g.graph.cells.is_empty())?;
    let fastest = fastest(&trials);
    let mut methods = methods(&grounds, 0, &trials, fastest);
    methods.sort_by_key(|r| Method::ALL.iter().position(|m| m.as_str() == r.method));
    let search = methods.iter().find(|r| r.method == Method::Search.as_str());
    let agreed = search
        .and_then(|r| r.answer)
        .map(|a| a.accuracy == Accuracy::default());
    bench.next("looking up the pairs in which methods differ");
    let differences = differences(level, ground, &trials, bench, PAIRS * options.budget);
    let (machine, threads) = bench.machine();
    let subdivisions = (0..grounds.len()).filter_map(|i| subdivided(&grounds, i, &trials, fastest));
    let results = Results {
        format: "enfilade.study",
        version: 1,
        kind: "visibility",
        level: LevelFacts::of(level),
        setting: Setting {
            enfilade: env!("CARGO_PKG_VERSION"),
            machine,
            threads,
            seed: options.seed,
            budget: options.budget,
            subdivision: options.cells.subdivision.as_str(),
            doors: options.cells.doors.as_str(),
        },
        cells: ground.graph.cells.len(),
        portals: ground.graph.portals.len(),
        truth: Truth {
            method: ground.truth.method.as_str(),
            pairs: ground.truth.pairs(),
            density: ground.truth.density(),
            agreed,
        },
        methods,
        differences,
        subdivisions: subdivisions.collect(),
        heights: heights(ground, &trials, fastest),
        notes: notes(&trials),
        seconds: bench.now(),
    };
    let Ground { graph, truth } = grounds.swap_remove(0);
    Some(Study {
        results,
        graph,
        truth,
    })
}

/// The options of trials that find visible sets on one subdivision.
fn seeing(trials: &[Trial], ground: usize) -> impl Iterator<Item = (&Trial, &PvsOptions)> {
    let on_it = trials.iter().filter(move |t| t.ground == ground);
    on_it.filter_map(|t| match &t.work {
        Work::See(options) => Some((t, options)),
        Work::Cut(_) => None,
    })
}

/// The median of the fastest exact method on the first subdivision.
fn fastest(trials: &[Trial]) -> f64 {
    let exact = seeing(trials, 0).filter(|(t, o)| {
        let method = matches!(o.method, Method::Sweep | Method::Search);
        method && o.heights.is_none() && t.state == State::Complete
    });
    let medians = exact.filter_map(|(t, _)| t.spread()).map(|s| s.median);
    medians.fold(f64::INFINITY, f64::min)
}

/// The methods without heights on one subdivision, compared with the exact answer.
fn methods(grounds: &[Ground], i: usize, trials: &[Trial], fastest: f64) -> Vec<Run> {
    let truth = &grounds[i].truth;
    let planar = seeing(trials, i).filter(|(_, o)| o.heights.is_none());
    let runs = planar.map(|(trial, options)| {
        let pvs = match options.method {
            Method::Sweep => Some(truth),
            _ => trial.pvs.as_ref(),
        };
        run(trial, options, pvs, &truth.visible, fastest)
    });
    runs.collect()
}

fn run(
    trial: &Trial,
    options: &PvsOptions,
    pvs: Option<&Pvs>,
    truth: &BitMatrix,
    fastest: f64,
) -> Run {
    let parameters = match (&options.heights, options.method) {
        (Some(heights), _) => vec![("splits", heights.splits.into())],
        (None, Method::Sample) => vec![
            ("rays", options.sample.rays.into()),
            ("seed", options.sample.seed as f64),
        ],
        (None, Method::Flow) => vec![("on", options.flow.on)],
        _ => Vec::new(),
    };
    let class = pvs.map_or(options.method.class(), |pvs| pvs.class);
    let seconds = trial.spread();
    Run {
        method: match options.heights {
            Some(_) => "heights",
            None => options.method.as_str(),
        },
        label: trial.label(),
        parameters: BTreeMap::from_iter(parameters),
        class: class.as_str(),
        state: trial.state,
        limit: trial.limit,
        seconds,
        relative: seconds.map(|s| s.median / fastest),
        bytes: trial.bytes,
        answer: pvs.map(|pvs| answer(pvs, truth)),
    }
}

fn answer(pvs: &Pvs, truth: &BitMatrix) -> Answer {
    let pairs = pvs.pairs();
    Answer {
        pairs,
        undecided: pvs.undecided,
        undecided_share: pvs.undecided as f64 / pairs.max(1) as f64,
        steps: pvs.steps,
        accuracy: accuracy(truth, &pvs.visible),
    }
}

/// Where the methods err on the first subdivision. Looks pairs up until `end`.
fn differences(
    level: &Level,
    ground: &Ground,
    trials: &[Trial],
    bench: &dyn Bench,
    end: f64,
) -> Vec<Differences> {
    let caster = Caster::new(level, &ground.graph);
    // Of the random sightlines only the most.
    let planar = || seeing(trials, 0).filter(|(t, o)| o.heights.is_none() && t.pvs.is_some());
    let samples = planar().filter(|(_, o)| o.method == Method::Sample);
    let most = samples.map(|(_, o)| o.sample.rays).max();
    let mut list = Vec::new();
    for (trial, options) in planar() {
        let Some(pvs) = &trial.pvs else { continue };
        let listed = match options.method {
            Method::Lp | Method::Flow => LISTED,
            Method::Sample if Some(options.sample.rays) != most => continue,
            _ => 1,
        };
        let Accuracy {
            invented, missed, ..
        } = accuracy(&ground.truth.visible, &pvs.visible);
        let mut pairs = Vec::new();
        for error in [Error::Missed, Error::Invented] {
            // What is open still is no mistake yet.
            if error == Error::Invented && trial.state == State::CutShort {
                continue;
            }
            let telling = telling(&ground.graph, &ground.truth, pvs, error);
            for cells in telling.into_iter().take(listed) {
                if bench.now() < end {
                    pairs.push(look_up(&ground.graph, &ground.truth, &caster, error, cells));
                }
            }
        }
        if invented + missed > 0 {
            list.push(Differences {
                method: options.method.as_str(),
                label: trial.label(),
                invented,
                missed,
                pairs,
            });
        }
    }
    list
}

fn subdivided(grounds: &[Ground], i: usize, trials: &[Trial], fastest: f64) -> Option<Subdivided> {
    let Ground { graph, truth } = &grounds[i];
    let mut on_it = trials.iter().filter(|t| t.ground == i);
    let cut = on_it.find(|t| matches!(t.work, Work::Cut(_)))?;
    let (sweep, _) = seeing(trials, i).find(|(_, o)| o.method == Method::Sweep)?;
    Some(Subdivided {
        subdivision: graph.options.subdivision.as_str(),
        cells: graph.cells.len(),
        portals: graph.portals.len(),
        pairs: truth.pairs(),
        density: truth.density(),
        floor: floor_seen(graph, truth),
        subdivide: cut.spread()?,
        sweep: sweep.spread()?,
        methods: methods(grounds, i, trials, fastest),
    })
}

/// The share of the floor that a point's cell sees, on average over all points.
fn floor_seen(graph: &CellGraph, pvs: &Pvs) -> f64 {
    let areas: Vec<f64> = graph
        .cell_ids()
        .map(|c| {
            let corners = graph.corners(c).map(|v| graph.vertices.approx(v));
            area(&corners.collect::<Vec<_>>())
        })
        .collect();
    let all: f64 = areas.iter().sum();
    let seen = graph.cell_ids().map(|c| {
        let seen: f64 = pvs.seen_from(c).map(|d| areas[d.0 as usize]).sum();
        areas[c.0 as usize] * seen
    });
    seen.sum::<f64>() / (all * all)
}

/// With floors and ceilings; `None` if that was not tried, or gave nothing.
fn heights(ground: &Ground, trials: &[Trial], fastest: f64) -> Option<Heights> {
    let with = || seeing(trials, 0).filter(|(_, o)| o.heights.is_some());
    // None of them misses anything, so what all of them call visible is the tightest answer.
    let mut all = with().filter_map(|(t, _)| t.pvs.as_ref());
    let mut tight = all.next()?.clone();
    for other in all {
        for i in 0..tight.visible.n() {
            let words = tight.visible.row_mut(i).iter_mut();
            words
                .zip(other.visible.row(i))
                .for_each(|(word, other)| *word &= other);
        }
    }
    let runs = with().map(|(t, o)| run(t, o, t.pvs.as_ref(), &tight.visible, fastest));
    Some(Heights {
        pairs: tight.pairs(),
        density: tight.density(),
        planar: answer(&ground.truth, &tight.visible),
        runs: runs.collect(),
    })
}

/// What did not come to its end, in words.
fn notes(trials: &[Trial]) -> Vec<String> {
    let note = |trial: &Trial| {
        let Work::See(_) = trial.work else {
            return None;
        };
        let mut label = trial.label();
        if trial.ground > 0 {
            label = format!("{label} on {}", trial.subdivision.as_str());
        }
        let after = trial.times.first().map_or(String::new(), |s| duration(*s));
        Some(match trial.state {
            State::Complete => return None,
            State::LeftOut => format!("{label} was left out: {}.", trial.reason),
            State::GaveUp => format!("{label} was stopped after {after}, without an answer."),
            State::CutShort => {
                let undecided = trial.pvs.as_ref().map_or(0, |pvs| pvs.undecided);
                format!(
                    "{label} was stopped after {after}; {} pairs stayed undecided and count as \
                     visible.",
                    grouped(undecided)
                )
            }
        })
    };
    trials.iter().filter_map(note).collect()
}
