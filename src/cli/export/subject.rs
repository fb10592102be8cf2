//! What is exported: a level that is cut and solved now, or a `.pvs` file.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;

use super::super::compute::{self, timed};
use super::super::level_args::{DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use super::super::progress;
use crate::cells::{CellGraph, Options, subdivide};
use crate::level::Level;
use crate::pvs::file::{self, LevelInfo};
use crate::pvs::{Progress, Pvs, sweep};
use crate::report::export::Known;
use crate::report::json::Seconds;

/// A level or a `.pvs` file, and where the export goes.
#[derive(Debug, Args)]
#[command(mut_arg("level", |arg| arg.value_name("LEVEL|FILE.pvs").help(
    "Level file (.toml, .wad, .dxf, .svg, .uvtt), or a .pvs file of `enfilade build`"
)))]
pub struct SubjectArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// How the plan is cut into cells [default: bsp]
    #[arg(long, value_enum, value_name = "HOW")]
    subdivision: Option<SubdivisionArg>,
    /// Whether doors that stand closed count as walls [default: open]
    #[arg(long, value_enum, value_name = "STATE")]
    doors: Option<DoorsArg>,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// The new file (`-`: standard output)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Print errors only
    #[arg(long, short)]
    pub quiet: bool,
}

/// What there is to export.
pub struct Subject {
    pub info: LevelInfo,
    /// Not of a `.pvs` file.
    pub level: Option<Level>,
    pub graph: CellGraph,
    /// Where it was asked for.
    pub pvs: Option<Pvs>,
    pub seconds: Seconds,
}

impl Subject {
    /// What is to be written.
    pub fn known(&self) -> Known<'_> {
        Known {
            info: &self.info,
            level: self.level.as_ref(),
            graph: &self.graph,
            pvs: self.pvs.as_ref(),
        }
    }
}

/// How a `.pvs` file begins.
const PVS: &[u8] = b"\x89PVS";

fn is_pvs(path: &Path) -> bool {
    use std::io::Read;
    let mut begin = [0; PVS.len()];
    let read = fs::File::open(path).and_then(|mut file| file.read_exact(&mut begin));
    let named = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("pvs"));
    named || (read.is_ok() && begin == PVS)
}

impl SubjectArgs {
    /// The file that is exported.
    pub fn path(&self) -> &Path {
        &self.level.level
    }

    /// Reads the level; `why` says what a `.pvs` file lacks.
    pub fn level(&self, why: &str) -> Result<Level> {
        if is_pvs(&self.level.level) {
            bail!("{}: {why}; give the level", self.level.level.display());
        }
        let level = self.level.read()?;
        if !self.quiet {
            warn_of(&level.findings);
        }
        Ok(level)
    }

    /// The cells of a level.
    pub fn cells(&self, level: &Level) -> CellGraph {
        let options = Options {
            subdivision: self.subdivision.unwrap_or_default().into(),
            doors: self.doors.unwrap_or_default().into(),
            ..Options::default()
        };
        let graph = subdivide(level, &options);
        if !self.quiet {
            warn_of(&graph.findings);
        }
        graph
    }

    /// Reads a level or a `.pvs` file; with `solved`, finds out who sees whom.
    pub fn read(&self, solved: bool) -> Result<Subject> {
        let mut seconds = Seconds::default();
        if is_pvs(&self.level.level) {
            return self.read_pvs();
        }
        let pool = compute::pool(self.threads)?;
        let level = timed(&mut seconds.read, || self.level(""))?;
        let graph = timed(&mut seconds.subdivide, || self.cells(&level));
        let pvs = solved.then(|| {
            let counter = Progress::default();
            let sweep = || pool.install(|| sweep::sweep(&graph, &counter));
            timed(&mut seconds.visibility, || {
                progress::show("finding what is visible", self.quiet, &counter, sweep)
            })
        });
        Ok(Subject {
            info: LevelInfo::of(&level),
            level: Some(level),
            graph,
            pvs,
            seconds,
        })
    }

    fn read_pvs(&self) -> Result<Subject> {
        let name = self.level.level.display();
        for (given, option) in [
            (self.level.map.is_some(), "--map"),
            (self.subdivision.is_some(), "--subdivision"),
            (self.doors.is_some(), "--doors"),
        ] {
            if given {
                bail!(
                    "{name}: the file holds one level, cut and solved already; leave {option} out"
                );
            }
        }
        let bytes = fs::read(&self.level.level).with_context(|| format!("cannot read {name}"))?;
        let file = file::decode(&bytes).with_context(|| name.to_string())?;
        Ok(Subject {
            info: file.info,
            level: None,
            graph: file.graph,
            pvs: Some(file.pvs),
            seconds: Seconds::default(),
        })
    }
}
