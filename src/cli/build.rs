//! `enfilade build`: from a level to its cells, portals and visible sets.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use super::output::{self, Output};
use super::summary::{self, Compared};
use super::{Answer, complain, progress};
use crate::cells::{CellGraph, Options, Subdivision, subdivide};
use crate::level::Level;
use crate::pvs::{Method, Progress, Pvs, search, sweep};
use crate::report::json::{self, Seconds};

/// Compute cells, portals and the potentially visible set of a level.
#[derive(Debug, Args)]
pub struct BuildArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// How the plan is cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: BuildSubdivision,
    /// How visibility is computed
    #[arg(long, value_enum, value_name = "METHOD", default_value = "sweep")]
    method: MethodArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    doors: DoorsArg,
    /// Give up the search after this many steps (cells entered)
    #[arg(long, value_name = "N")]
    max_steps: Option<u64>,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Write cells, portals and visible sets as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    bsp: BspArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum BuildSubdivision {
    /// By the lines of the walls
    Bsp,
    /// By axis-aligned lines through wall ends, then by the walls
    Kd,
    /// Constrained Delaunay triangles
    Cdt,
    /// All three, side by side in a table; writes nothing
    Compare,
}

impl BuildSubdivision {
    /// The one subdivision, or `None` for all.
    fn single(self) -> Option<Subdivision> {
        let arg = match self {
            BuildSubdivision::Bsp => SubdivisionArg::Bsp,
            BuildSubdivision::Kd => SubdivisionArg::Kd,
            BuildSubdivision::Cdt => SubdivisionArg::Cdt,
            BuildSubdivision::Compare => return None,
        };
        Some(arg.into())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MethodArg {
    /// About every vertex in turn; exact, the faster one
    Sweep,
    /// Depth first through chains of portals; exact
    Search,
}

impl From<MethodArg> for Method {
    fn from(arg: MethodArg) -> Self {
        match arg {
            MethodArg::Sweep => Method::Sweep,
            MethodArg::Search => Method::Search,
        }
    }
}

/// Runs `enfilade build`.
pub fn run(args: &BuildArgs) -> Result<Answer> {
    if args.max_steps.is_some() && args.method != MethodArg::Search {
        bail!("--max-steps limits the search; give --method search with it");
    }
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(n) = args.threads {
        if n == 0 {
            bail!("--threads 0 cannot compute anything; leave it out to use all processors");
        }
        pool = pool.num_threads(n);
    }
    let pool = pool.build().context("cannot start the threads")?;
    match args.subdivision.single() {
        Some(subdivision) => one(args, subdivision, &pool),
        None => compare(args, &pool),
    }
}

fn one(args: &BuildArgs, subdivision: Subdivision, pool: &rayon::ThreadPool) -> Result<Answer> {
    let mut seconds = Seconds::default();
    let level = timed(&mut seconds.read, || args.level.read())?;
    let mut json = args.json.as_deref().map(Output::create).transpose()?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let options = args.bsp.options(subdivision, args.doors.into());
    let graph = timed(&mut seconds.subdivide, || cells(args, &level, &options));
    if !args.quiet {
        warn_of(&graph.findings);
    }
    let pvs = timed(&mut seconds.visibility, || visibility(args, &graph, pool));
    let Some(pvs) = pvs else {
        complain(&gave_up(args));
        return Ok(Answer::No);
    };
    let mut write = 0.0;
    if let Some(json) = &mut json {
        timed(&mut write, || {
            json.write(|out| json::write(out, &level, &graph, &pvs, &seconds))
        })?;
    }
    output::commit(json)?;
    seconds.write += write;
    if !args.quiet {
        let table = summary::of_build(&level, &graph, &pvs, &seconds);
        if args.json.as_deref().is_some_and(output::is_stdout) {
            complain(table.trim_end());
        } else {
            output::print(&table)?;
        }
    }
    Ok(Answer::Yes)
}

/// All three subdivisions in a table; nothing is written.
fn compare(args: &BuildArgs, pool: &rayon::ThreadPool) -> Result<Answer> {
    if args.json.is_some() {
        bail!("--subdivision compare prints a table and writes no files; name one subdivision");
    }
    let level = args.level.read()?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let mut rows = Vec::new();
    for subdivision in Subdivision::ALL {
        let options = args.bsp.options(subdivision, args.doors.into());
        let (mut subdivide, mut visible) = (0.0, 0.0);
        let graph = timed(&mut subdivide, || cells(args, &level, &options));
        let Some(pvs) = timed(&mut visible, || visibility(args, &graph, pool)) else {
            complain(&gave_up(args));
            return Ok(Answer::No);
        };
        rows.push(Compared::new(&graph, &pvs, subdivide, visible));
    }
    output::print(&summary::of_comparison(&level, &rows))?;
    Ok(Answer::Yes)
}

fn cells(args: &BuildArgs, level: &Level, options: &Options) -> CellGraph {
    progress::show("cutting into cells", args.quiet, &Progress::default(), || {
        subdivide(level, options)
    })
}

/// The PVS, or `None` if the search gave up.
fn visibility(args: &BuildArgs, graph: &CellGraph, pool: &rayon::ThreadPool) -> Option<Pvs> {
    let counter = Progress::default();
    progress::show("finding what is visible", args.quiet, &counter, || {
        pool.install(|| match args.method.into() {
            Method::Sweep => Some(sweep::sweep(graph, &counter)),
            Method::Search => search::search(graph, args.max_steps, &counter),
        })
    })
}

fn gave_up(args: &BuildArgs) -> String {
    format!(
        "the search gave up after {} steps, and nothing was written; allow more with --max-steps, \
         or take --method sweep",
        args.max_steps.unwrap_or_default()
    )
}

/// Does the work and says how many seconds it took.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}
