//! From arguments to a finished PVS: what `build` and the exports have in common.

use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use rayon::ThreadPool;

use super::level_args::{LevelArgs, warn_of};
use super::progress;
use crate::cells::{CellGraph, Options, subdivide};
use crate::level::Level;
use crate::pvs::flow::FlowOptions;
use crate::pvs::heights::HeightsOptions;
use crate::pvs::sample::SampleOptions;
use crate::pvs::{self, Method, Progress, Pvs, PvsOptions};
use crate::report::json::Seconds;

/// What is to be computed, and how.
pub struct Job<'a> {
    /// The level.
    pub level: &'a LevelArgs,
    /// How it is cut into cells.
    pub cells: Options,
    /// How visibility is found.
    pub method: Method,
    /// Whether floors and ceilings count.
    pub heights: Option<HeightsOptions>,
    /// For [`Method::Sample`].
    pub sample: SampleOptions,
    /// Where the search gives up.
    pub max_steps: Option<u64>,
    /// Seconds after which methods that can leave pairs undecided do so.
    pub time_limit: Option<f64>,
    /// Threads; `None`: as many as there are processors.
    pub threads: Option<usize>,
    /// Neither warnings nor a progress bar.
    pub quiet: bool,
}

/// A level with its cells and visible sets.
pub struct Built {
    /// The level.
    pub level: Level,
    /// Its cells.
    pub graph: CellGraph,
    /// Who sees whom.
    pub pvs: Pvs,
    /// How long it took; nothing is written yet.
    pub seconds: Seconds,
}

/// Does the job, with warnings and progress on standard error. `None`: the search gave up.
pub fn build(job: &Job) -> Result<Option<Built>> {
    let pool = pool(job.threads)?;
    let mut seconds = Seconds::default();
    let level = timed(&mut seconds.read, || job.level.read())?;
    if !job.quiet {
        warn_of(&level.findings);
    }
    let graph = timed(&mut seconds.subdivide, || cells(job, &level));
    if !job.quiet {
        warn_of(&graph.findings);
    }
    let pvs = timed(&mut seconds.visibility, || {
        visibility(job, &level, &graph, &pool)
    });
    Ok(pvs.map(|pvs| Built {
        level,
        graph,
        pvs,
        seconds,
    }))
}

/// The threads to compute with.
pub fn pool(threads: Option<usize>) -> Result<ThreadPool> {
    if threads == Some(0) {
        bail!("--threads 0 cannot compute anything; leave it out to use all processors");
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    pool.build().context("cannot start the threads")
}

/// Cuts a level into cells.
pub fn cells(job: &Job, level: &Level) -> CellGraph {
    progress::show(
        "cutting into cells",
        job.quiet,
        &Progress::default(),
        || subdivide(level, &job.cells),
    )
}

/// The PVS, or `None` if the search gave up.
pub fn visibility(job: &Job, level: &Level, graph: &CellGraph, pool: &ThreadPool) -> Option<Pvs> {
    let options = PvsOptions {
        method: job.method,
        heights: job.heights,
        max_steps: job.max_steps,
        sample: job.sample,
        flow: FlowOptions::of(level),
    };
    let counter = Progress::default();
    progress::show("finding what is visible", job.quiet, &counter, || {
        within(job.time_limit, &counter, || {
            pool.install(|| pvs::compute(graph, &options, &counter))
        })
    })
}

/// Does the work, and asks it to stop when so many seconds are over.
pub fn within<T>(limit: Option<f64>, counter: &Progress, work: impl FnOnce() -> T) -> T {
    let Some(limit) = limit else { return work() };
    thread::scope(|scope| {
        let (finished, wait) = mpsc::channel::<()>();
        scope.spawn(move || {
            let limit = Duration::try_from_secs_f64(limit).unwrap_or(Duration::MAX);
            if wait.recv_timeout(limit) == Err(RecvTimeoutError::Timeout) {
                counter.stop();
            }
        });
        let result = work();
        drop(finished);
        result
    })
}

/// Does the work, and sets how many seconds it took.
pub fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}
