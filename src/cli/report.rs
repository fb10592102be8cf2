//! `enfilade report`: what each place costs, why, and what could be changed.

mod pictures;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result};
use clap::Args;

use super::compute::{self, timed};
use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use super::output::{self, Output};
use super::render::trace_args::positive;
use super::{Answer, complain, progress};
use crate::cells::subdivide;
use crate::level::scene::Budget;
use crate::pvs::{Progress, sweep};
use crate::report::costs::baseline::{self, Comparison};
use crate::report::costs::budget::{self, Check};
use crate::report::costs::{Costs, json};
use crate::report::json::Seconds;
use crate::report::page::{self, Report};

/// Write a page for level designers: what each place costs, why, and what closing an opening would
/// save. With limits, the exit status is 1 when the level exceeds one.
#[derive(Debug, Args)]
pub struct ReportArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// Page to write: one file that needs nothing else (`-`: standard output)
    #[arg(short, long, value_name = "FILE.html")]
    output: Option<PathBuf>,
    /// Write the figures as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the budget's checks as JUnit XML, for CI (`-`: standard output)
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,
    /// Compare with an earlier report: the JSON that it wrote, or that of `build`
    #[arg(long, value_name = "FILE.json")]
    baseline: Option<PathBuf>,
    /// Also tell what a wall of this length in the middle of each of the first openings would save
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    wall: Option<f64>,
    /// Leave out the pictures of the dearest places
    #[arg(long)]
    no_pictures: bool,
    /// Also show what a tour on foot reveals (the level's own paths are shown in any case)
    #[arg(long)]
    tour: bool,
    /// How the plan is cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: SubdivisionArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    doors: DoorsArg,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Print errors, and what is over budget, only
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    budget: BudgetArgs,
    #[command(flatten)]
    bsp: BspArgs,
}

/// Limits, each before the one in the level's `[budget]`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Budget")]
pub struct BudgetArgs {
    /// Most cells that any cell may see
    #[arg(long, value_name = "N")]
    max_visible_cells: Option<u64>,
    /// Most polygons that any cell may see
    #[arg(long, value_name = "N")]
    max_visible_polygons: Option<u64>,
    /// Most walls that any cell may see
    #[arg(long, value_name = "N")]
    max_visible_walls: Option<u64>,
    /// Most cells that a cell may see in the mean
    #[arg(long, value_name = "X")]
    max_mean_visible_cells: Option<f64>,
    /// Most polygons that a cell may see in the mean
    #[arg(long, value_name = "X")]
    max_mean_visible_polygons: Option<f64>,
    /// Longest sightline (in the level's unit)
    #[arg(long, value_name = "LENGTH")]
    max_sightline: Option<f64>,
    /// Largest share of all pairs of cells that may see each other, 0 to 1
    #[arg(long, value_name = "X")]
    max_density: Option<f64>,
}

impl BudgetArgs {
    fn budget(&self) -> Budget {
        Budget {
            max_visible_cells: self.max_visible_cells,
            max_visible_polygons: self.max_visible_polygons,
            max_visible_walls: self.max_visible_walls,
            max_mean_visible_cells: self.max_mean_visible_cells,
            max_mean_visible_polygons: self.max_mean_visible_polygons,
            max_sightline: self.max_sightline,
            max_density: self.max_density,
        }
    }
}

/// Runs `enfilade report`.
pub fn run(args: &ReportArgs) -> Result<Answer> {
    let (page_path, json_path) = (args.output.as_deref(), args.json.as_deref());
    let junit_path = args.junit.as_deref();
    for [first, second] in [
        [page_path, json_path],
        [page_path, junit_path],
        [json_path, junit_path],
    ] {
        output::must_differ(first, second)?;
    }
    let old = args.baseline.as_deref().map(read_baseline).transpose()?;
    let mut page_file = page_path.map(Output::create).transpose()?;
    let mut json_file = json_path.map(Output::create).transpose()?;
    let mut junit_file = junit_path.map(Output::create).transpose()?;
    let pool = compute::pool(args.threads)?;
    let mut seconds = Seconds::default();
    let (source, level) = timed(&mut seconds.read, || -> Result<_> {
        let source = args.level.open()?;
        let level = source.level(args.level.map.as_deref())?;
        Ok((source, level))
    })?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let options = args.bsp.options(args.subdivision.into(), args.doors.into());
    let graph = timed(&mut seconds.subdivide, || subdivide(&level, &options));
    let counter = Progress::default();
    let pvs = timed(&mut seconds.visibility, || {
        progress::show("finding what is visible", args.quiet, &counter, || {
            pool.install(|| sweep::sweep(&graph, &counter))
        })
    });
    let start = Instant::now();
    let clock = || start.elapsed().as_secs_f64();
    let counter = Progress::default();
    let mut costs = progress::show("closing every gap", args.quiet, &counter, || {
        pool.install(|| Costs::of(&level, &graph, &pvs, args.wall, &clock, &counter))
    });
    let (mut thumbnails, mut reveals) = (Vec::new(), Vec::new());
    if page_path.is_some() {
        let began = clock();
        let world = match args.no_pictures {
            true => None,
            false => pictures::world(&args.level.level, &source, &level, &graph, &pvs)?,
        };
        pool.install(|| {
            if let Some(world) = &world {
                thumbnails = pictures::of_worst(&costs, world);
            }
            reveals = pictures::reveals(&costs, world.as_ref(), args.tour);
        });
        costs.seconds.pictures = clock() - began;
    }
    let limits = budget::joined(&args.budget.budget(), &level.scene.budget);
    let checks = budget::check(&costs, &limits);
    let comparison = compared(args.baseline.as_deref(), old.as_ref(), &costs)?;
    if let Some(file) = &mut json_file {
        let document = json::Document {
            costs: &costs,
            seconds: &seconds,
            budget: &checks,
            comparison: comparison.as_ref(),
        };
        file.write(|out| json::write(out, &document))?;
    }
    if let Some(file) = &mut page_file {
        let report = Report {
            costs: &costs,
            seconds: &seconds,
            budget: &checks,
            comparison: comparison.as_ref(),
            thumbnails,
            reveals,
        };
        let page = pool.install(|| page::page(&report));
        file.write(|out| out.write_all(page.as_bytes()))?;
    }
    if let Some(file) = &mut junit_file {
        let report = junit(&costs, &checks);
        file.write(|out| report.serialize(out).map_err(std::io::Error::other))?;
    }
    output::commit(page_file.into_iter().chain(json_file).chain(junit_file))?;
    say(args, &costs, &checks)?;
    Ok(match checks.iter().all(|c| c.kept) {
        true => Answer::Yes,
        false => Answer::No,
    })
}

/// The checks as tests.
fn junit(costs: &Costs, checks: &[Check]) -> quick_junit::Report {
    use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
    let mut suite = TestSuite::new(format!("budget of {}", costs.level.name));
    for check in checks {
        let status = if check.kept {
            TestCaseStatus::success()
        } else {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(check.line(costs));
            status
        };
        suite.add_test_case(TestCase::new(check.name, status));
    }
    let mut report = Report::new("enfilade report");
    report.add_test_suite(suite);
    report
}

fn read_baseline(path: &Path) -> Result<baseline::Baseline> {
    let text = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let name = || format!("{} is no baseline", path.display());
    baseline::read(&text).with_context(name)
}

fn compared(
    path: Option<&Path>,
    old: Option<&baseline::Baseline>,
    costs: &Costs,
) -> Result<Option<Comparison>> {
    let (Some(path), Some(old)) = (path, old) else {
        return Ok(None);
    };
    let comparison = baseline::compare(costs, old);
    let comparison = comparison.with_context(|| format!("{} is no baseline", path.display()))?;
    Ok(Some(comparison))
}

/// A few lines for logs: limits, and what would save most.
fn say(args: &ReportArgs, costs: &Costs, checks: &[Check]) -> Result<()> {
    let mut text = String::new();
    for check in checks.iter().filter(|c| !args.quiet || !c.kept) {
        text += &check.line(costs);
        text.push('\n');
    }
    if !args.quiet {
        for gap in costs.gaps.iter().take(3).filter(|g| g.pairs > 0) {
            let share = gap.share * 100.0;
            text += &format!(
                "closing the {}: mean visible set -{share:.1} %\n",
                gap.title
            );
        }
    }
    let outputs = [&args.output, &args.json, &args.junit].map(|p| p.as_deref());
    if outputs.into_iter().flatten().any(output::is_stdout) {
        if !text.is_empty() {
            complain(text.trim_end());
        }
        Ok(())
    } else {
        output::print(&text)
    }
}
