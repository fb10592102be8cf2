//! A level made ready for pictures: what `render` and `walk` have in common.

use anyhow::{Context, Result};
use clap::Args;
use rayon::ThreadPool;

use super::compute::{self, timed};
use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use super::progress;
use super::render::files;
use crate::cells::{CellGraph, subdivide};
use crate::level::Level;
use crate::pvs::{Progress, Pvs, sweep};
use crate::trace::world::World;

/// How a level is made ready.
#[derive(Debug, Args)]
pub struct StageArgs {
    /// How the plan is cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    pub subdivision: SubdivisionArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    pub doors: DoorsArg,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Print errors only
    #[arg(long, short)]
    pub quiet: bool,
    #[command(flatten)]
    pub bsp: BspArgs,
}

/// How long each stage took, in seconds.
#[derive(Clone, Copy, Default)]
pub struct Seconds {
    /// Reading all files.
    pub read: f64,
    /// Cutting into cells.
    pub subdivide: f64,
    /// Who sees whom.
    pub visibility: f64,
}

/// A level with all that pictures of it need.
pub struct Stage {
    /// The level.
    pub level: Level,
    /// Its cells.
    pub graph: CellGraph,
    /// Who sees whom.
    pub pvs: Pvs,
    /// What rays meet.
    pub world: World,
    /// Threads to compute with.
    pub pool: ThreadPool,
    /// How long that took.
    pub seconds: Seconds,
}

/// Makes a level ready, changed as `change` says. `ambient` is the ambient term of places without a
/// brightness of their own.
pub fn set(
    level: &LevelArgs,
    args: &StageArgs,
    ambient: f64,
    change: impl FnOnce(Level) -> Level,
) -> Result<Stage> {
    let pool = compute::pool(args.threads)?;
    let mut seconds = Seconds::default();
    let mut reading = 0.0;
    let (source, read) = timed(&mut seconds.read, || -> Result<_> {
        let source = level.open()?;
        let read = source.level(level.map.as_deref())?;
        Ok((source, read))
    })?;
    if !args.quiet {
        warn_of(&read.findings);
    }
    let own = change(read);
    let options = args.bsp.options(args.subdivision.into(), args.doors.into());
    let graph = timed(&mut seconds.subdivide, || subdivide(&own, &options));
    let pvs = timed(&mut seconds.visibility, || {
        let counter = Progress::default();
        progress::show("finding what is visible", args.quiet, &counter, || {
            pool.install(|| sweep::sweep(&graph, &counter))
        })
    });
    let files = timed(&mut reading, || files::read(&level.level, &source, &own))?;
    seconds.read += reading;
    if !args.quiet {
        files::warn_of_missing(&source, &own, &files);
    }
    let world = World::new(&own, &graph, &pvs, &files, ambient);
    let world = world.with_context(|| own.source.clone())?;
    Ok(Stage {
        level: own,
        graph,
        pvs,
        world,
        pool,
        seconds,
    })
}
