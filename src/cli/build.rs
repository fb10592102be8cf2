//! `enfilade build`: from a level to its cells, portals and visible sets.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};

use super::compute::{self, Built, Job, timed};
use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use super::output::{self, Output};
use super::summary::{self, Compared};
use super::{Answer, complain};
use crate::cells::Subdivision;
use crate::pvs::Method;
use crate::pvs::file::{self, LevelInfo};
use crate::pvs::heights::HeightsOptions;
use crate::pvs::sample::SampleOptions;
use crate::report::json;

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
    /// Count floors and ceilings: sight in space, not only on the plan
    #[arg(long)]
    heights: bool,
    /// With --heights: into how many parts the lines through one chain of portals may be split
    /// before it is left undecided
    #[arg(long, value_name = "N", requires = "heights")]
    splits: Option<u32>,
    /// With --method sample: random sightlines from every cell [default: 1000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    rays: Option<u32>,
    /// With --method sample: seed of all that is random [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// With --method lp or flow, or --heights: after this many seconds, leave what is open undecided,
    /// and visible
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<f64>,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Write the PVS file, for `enfilade verify` and other programs
    #[arg(short, long, value_name = "FILE.pvs")]
    output: Option<PathBuf>,
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
    /// Depth first, each chain asked of a floating-point linear programme; approximate, slow
    Lp,
    /// Portal flow with separators in floating point, as the Quake tools do it; approximate
    Flow,
    /// Connected through open portals; conservative: misses nothing
    Flood,
    /// Random sightlines (see --rays); aggressive: shows nothing too much
    Sample,
}

impl From<MethodArg> for Method {
    fn from(arg: MethodArg) -> Self {
        match arg {
            MethodArg::Sweep => Method::Sweep,
            MethodArg::Search => Method::Search,
            MethodArg::Lp => Method::Lp,
            MethodArg::Flow => Method::Flow,
            MethodArg::Flood => Method::Flood,
            MethodArg::Sample => Method::Sample,
        }
    }
}

/// A time in seconds.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 => Ok(seconds),
        _ => Err("a number of seconds above 0 is needed, such as 2.5".to_string()),
    }
}

/// Runs `enfilade build`.
pub fn run(args: &BuildArgs) -> Result<Answer> {
    if args.max_steps.is_some() && args.heights {
        bail!("--max-steps limits the search on the plan; with --heights, give --time-limit");
    }
    if args.max_steps.is_some() && args.method != MethodArg::Search {
        bail!("--max-steps limits the search; give --method search with it");
    }
    if args.splits == Some(0) {
        bail!("--splits 0 would look at nothing; give at least 1");
    }
    let samples = args.method == MethodArg::Sample;
    if (args.rays.is_some() || args.seed.is_some()) && !samples {
        bail!("--rays and --seed are for random sightlines; give --method sample with them");
    }
    let patient = matches!(args.method, MethodArg::Lp | MethodArg::Flow) || args.heights;
    if args.time_limit.is_some() && !patient {
        bail!(
            "--time-limit is for --method lp, --method flow and --heights; the others leave nothing \
             open"
        );
    }
    if args.heights && !matches!(args.method, MethodArg::Sweep | MethodArg::Search) {
        bail!("--heights has its own method (a search); leave --method out");
    }
    let job = |subdivision| Job {
        level: &args.level,
        cells: args.bsp.options(subdivision, args.doors.into()),
        method: if args.heights {
            Method::Search
        } else {
            args.method.into()
        },
        heights: args.heights.then(|| HeightsOptions {
            splits: args.splits.unwrap_or(HeightsOptions::default().splits),
        }),
        sample: SampleOptions {
            rays: args.rays.unwrap_or(SampleOptions::default().rays),
            seed: args.seed.unwrap_or(SampleOptions::default().seed),
        },
        max_steps: args.max_steps,
        time_limit: args.time_limit,
        threads: args.threads,
        quiet: args.quiet,
    };
    let done = match args.subdivision.single() {
        Some(subdivision) => one(args, &job(subdivision))?,
        None => compare(args, job)?,
    };
    if !done {
        complain(&format!(
            "the search gave up after {} steps, and nothing was written; allow more with \
             --max-steps, or take --method sweep",
            args.max_steps.unwrap_or_default()
        ));
        return Ok(Answer::No);
    }
    Ok(Answer::Yes)
}

/// One subdivision, its files and its table. Whether the method came to an end.
fn one(args: &BuildArgs, job: &Job) -> Result<bool> {
    let (pvs_path, json_path) = (args.output.as_deref(), args.json.as_deref());
    output::must_differ(pvs_path, json_path)?;
    let mut pvs_file = pvs_path.map(Output::create).transpose()?;
    let mut json_file = json_path.map(Output::create).transpose()?;
    let Some(Built {
        level,
        graph,
        pvs,
        mut seconds,
    }) = compute::build(job)?
    else {
        return Ok(false);
    };
    let mut write = 0.0;
    if let Some(file) = &mut pvs_file {
        timed(&mut seconds.write, || {
            let bytes = file::encode(&LevelInfo::of(&level), &graph, &pvs);
            file.write(|out| out.write_all(&bytes))
        })?;
    }
    if let Some(file) = &mut json_file {
        timed(&mut write, || {
            file.write(|out| json::write(out, &level, &graph, &pvs, &seconds))
        })?;
    }
    output::commit(pvs_file.into_iter().chain(json_file))?;
    seconds.write += write;
    if !args.quiet {
        let table = summary::of_build(&level, &graph, &pvs, &seconds);
        let paths = [pvs_path, json_path];
        if paths.into_iter().flatten().any(output::is_stdout) {
            complain(table.trim_end());
        } else {
            output::print(&table)?;
        }
    }
    Ok(true)
}

/// All three subdivisions in a table; nothing is written. Whether the method came to an end.
fn compare<'a>(args: &'a BuildArgs, job: impl Fn(Subdivision) -> Job<'a>) -> Result<bool> {
    if args.json.is_some() || args.output.is_some() {
        bail!("--subdivision compare prints a table and writes no files; name one subdivision");
    }
    let pool = compute::pool(args.threads)?;
    let level = args.level.read()?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let mut rows = Vec::new();
    for job in Subdivision::ALL.map(job) {
        let (mut subdivide, mut visible) = (0.0, 0.0);
        let graph = timed(&mut subdivide, || compute::cells(&job, &level));
        let pvs = timed(&mut visible, || {
            compute::visibility(&job, &level, &graph, &pool)
        });
        let Some(pvs) = pvs else { return Ok(false) };
        let size = file::encode(&LevelInfo::of(&level), &graph, &pvs).len();
        rows.push(Compared::new(&graph, &pvs, subdivide, visible, size));
    }
    output::print(&summary::of_comparison(&level, &rows))?;
    Ok(true)
}
