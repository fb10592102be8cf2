//! `enfilade study visibility`: all methods on one level, and what accuracy costs.

use std::path::PathBuf;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Result, bail};
use clap::Args;
use rayon::ThreadPool;

use crate::cells::Options;
use crate::cli::level_args::{DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use crate::cli::output::{self, Output};
use crate::cli::{Answer, Memory, complain, compute, progress, summary};
use crate::level::wording::{duration, grouped};
use crate::pvs::Progress;
use crate::study::visibility::{Answer as Figures, Bench, Cost, Results, Run, StudyOptions};
use crate::study::visibility::{advice, page, study};

/// Compare all methods on one level: what each gains, loses and costs.
///
/// Runs sweep, search, linear programme, portal flow, flood and random sightlines, on three
/// subdivisions, and with heights; takes the exact answer as truth; writes a page for people that
/// explains what it shows.
#[derive(Debug, Args)]
pub struct VisibilityArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// Page to write; it needs nothing else (`-`: standard output)
    #[arg(short, long, value_name = "FILE.html")]
    output: PathBuf,
    /// Write all figures as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Seconds for the whole study; what they are too short for is cut short or left out
    #[arg(long, value_name = "SECONDS", default_value_t = 90.0)]
    budget: f64,
    /// The cells on which all methods are compared
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: SubdivisionArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    doors: DoorsArg,
    /// Seed of all that is random
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Runs `enfilade study visibility`.
pub fn run(args: &VisibilityArgs, memory: Option<Memory>) -> Result<Answer> {
    if !(args.budget > 0.0 && args.budget.is_finite()) {
        bail!(
            "--budget {} leaves no time; give a number of seconds",
            args.budget
        );
    }
    let paths = [Some(args.output.as_path()), args.json.as_deref()];
    output::must_differ(paths[0], paths[1])?;
    // Only to find out early whether they can be written: whoever stops the study in the middle
    // shall not find unfinished files.
    paths
        .into_iter()
        .flatten()
        .try_for_each(|path| Output::create(path).map(drop))?;
    let mut desk = Desk {
        start: Instant::now(),
        pool: compute::pool(args.threads)?,
        memory,
        status: Arc::default(),
    };
    let level = args.level.read()?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let options = StudyOptions {
        cells: Options {
            subdivision: args.subdivision.into(),
            doors: args.doors.into(),
            ..Options::default()
        },
        seed: args.seed,
        budget: args.budget,
    };
    let (start, status) = (desk.start, Arc::clone(&desk.status));
    let line = || status.line(args.budget - start.elapsed().as_secs_f64());
    let study = progress::show_parts(args.quiet, line, || study(&level, &options, &mut desk));
    let Some(study) = study else {
        bail!(
            "{} has no inside; there is nothing to see in it",
            level.name
        );
    };
    let mut files = Vec::new();
    let mut html = Output::create(&args.output)?;
    html.write(|out| out.write_all(page(&level, &study).as_bytes()))?;
    files.push(html);
    if let Some(path) = &args.json {
        let mut json = Output::create(path)?;
        json.write(|out| {
            serde_json::to_writer_pretty(&mut *out, &study.results)?;
            writeln!(out)
        })?;
        files.push(json);
    }
    output::commit(files)?;
    if !args.quiet {
        for note in &study.results.notes {
            complain(&format!("note: {note}"));
        }
        let summary = in_words(&study.results);
        if paths.into_iter().flatten().any(output::is_stdout) {
            complain(summary.trim_end());
        } else {
            output::print(&summary)?;
        }
    }
    Ok(Answer::Yes)
}

/// The methods in a table, and which to pick.
fn in_words(results: &Results) -> String {
    let head = [
        "",
        "class",
        "time",
        "relative",
        "pairs",
        "overestimate",
        "underestimate",
        "wrong pairs",
    ];
    let row = |run: &Run| {
        let answer = |text: fn(&Figures) -> String| match &run.answer {
            Some(answer) => text(answer),
            None => "-".to_string(),
        };
        [
            run.label.clone(),
            run.class.to_string(),
            run.seconds.map_or("-".to_string(), |s| duration(s.median)),
            run.relative.map_or("-".to_string(), |r| format!("{r:.2}")),
            answer(|a| grouped(a.pairs)),
            answer(|a| format!("{:.4} %", a.accuracy.overestimate * 100.0)),
            answer(|a| format!("{:.4} %", a.accuracy.underestimate * 100.0)),
            answer(|a| grouped(a.accuracy.invented + a.accuracy.missed)),
        ]
    };
    let rows: Vec<[String; 8]> = results.methods.iter().map(row).collect();
    let rows: Vec<&[String]> = rows.iter().map(|row| &row[..]).collect();
    format!(
        "{} ({}), studied for {}\n\n{}\n{}\n",
        results.level.name,
        results.level.source,
        duration(results.seconds),
        summary::table(&head, &rows),
        advice::exact(results)
    )
}

/// What a study runs on: this computer.
struct Desk {
    start: Instant,
    pool: ThreadPool,
    memory: Option<Memory>,
    status: Arc<Status>,
}

/// What is under way, for those who watch.
#[derive(Default)]
struct Status {
    now: Mutex<(String, Arc<Progress>)>,
}

impl Status {
    fn set(&self, change: impl FnOnce(&mut (String, Arc<Progress>))) {
        change(&mut self.now.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn line(&self, left: f64) -> String {
        let (what, progress) = self
            .now
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let left = left.max(0.0).ceil();
        let total = progress.total.load(Relaxed);
        let part = match (progress.done.load(Relaxed) * 100).checked_div(total) {
            Some(percent) => format!(", {} %", percent.min(100)),
            None => String::new(),
        };
        format!("{what}{part}; {left} s of the budget left")
    }
}

impl Bench for Desk {
    fn next(&mut self, what: &str) {
        self.status
            .set(|now| *now = (what.to_string(), Arc::default()));
    }

    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn run(&mut self, limit: Option<f64>, work: &mut (dyn FnMut(&Progress) + Send)) -> Cost {
        let progress = Arc::new(Progress::default());
        self.status.set(|now| now.1 = Arc::clone(&progress));
        let before = self.memory.map(|memory| {
            (memory.forget_peak)();
            (memory.now)()
        });
        let start = Instant::now();
        compute::within(limit, &progress, || self.pool.install(|| work(&progress)));
        let seconds = start.elapsed().as_secs_f64();
        let peak = self.memory.map(|memory| (memory.peak)());
        let bytes = peak
            .zip(before)
            .map(|(peak, before)| peak.saturating_sub(before) as u64);
        Cost {
            seconds,
            bytes,
            stopped: progress.stopped(),
        }
    }

    fn machine(&self) -> (String, usize) {
        (machine(), self.pool.current_num_threads())
    }
}

/// The processor's name, where the system tells it, and the kind of system.
fn machine() -> String {
    let system = format!("{} on {}", std::env::consts::OS, std::env::consts::ARCH);
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = known.lines().find(|line| line.starts_with("model name"));
    match model.and_then(|line| line.split_once(':')) {
        Some((_, name)) => format!("{}, {system}", name.trim()),
        None => system,
    }
}
