//! `enfilade study stability`: levels that state their own answer, and what each method says.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;

use crate::cli::level_args::SubdivisionArg;
use crate::cli::output::{self, Output};
use crate::cli::{Answer, complain, compute, progress};
use crate::pvs::Progress;
use crate::study::stability::statement::Case;
use crate::study::stability::{Row, StabilityOptions, judge, table};

/// Compare what the methods answer on levels that state the answer, worked out by hand, in comments.
///
/// Makes one Markdown table: where the linear programme and the portal flow, both in floating point,
/// go wrong, and whether the exact methods are right. If they are not, the exit status is 1.
#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// Folder of .toml levels, such as levels/hard
    folder: PathBuf,
    /// How the plans are cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: SubdivisionArg,
    /// Give up the search after this many steps (cells entered) [default: 20000000]
    #[arg(long, value_name = "N")]
    max_steps: Option<u64>,
    /// Ask the linear programme only where the search needs at most this many steps
    /// [default: 40000]
    #[arg(long, value_name = "N")]
    lp_steps: Option<u64>,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Where the table goes (`-`: standard output)
    #[arg(short, long, value_name = "FILE.md", default_value = "-")]
    output: PathBuf,
    /// Write all comparisons as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Runs `enfilade study stability`.
pub fn run(args: &StabilityArgs) -> Result<Answer> {
    output::must_differ(Some(&args.output), args.json.as_deref())?;
    let mut markdown = Output::create(&args.output)?;
    let mut json = args.json.as_deref().map(Output::create).transpose()?;
    let usual = StabilityOptions::default();
    let options = StabilityOptions {
        subdivision: args.subdivision.into(),
        max_steps: args.max_steps.unwrap_or(usual.max_steps),
        lp_steps: args.lp_steps.unwrap_or(usual.lp_steps),
    };
    let levels = levels(&args.folder)?;
    let pool = compute::pool(args.threads)?;
    let counter = Progress::default();
    counter.begin(levels.len());
    let rows = progress::show("asking all methods", args.quiet, &counter, || {
        let row = |path: &PathBuf| {
            let row = pool.install(|| of_level(path, &options));
            counter.advance(1);
            row.with_context(|| path.display().to_string())
        };
        levels.iter().map(row).collect::<Result<Vec<Row>>>()
    })?;
    // A level that states nothing of what cells see is about something else: about a single eye.
    let rows: Vec<Row> = (rows.into_iter())
        .filter(|row| row.about_sight + row.others > 0)
        .collect();
    markdown.write(|out| out.write_all(table::markdown(&rows, &options).as_bytes()))?;
    if let Some(json) = &mut json {
        json.write(|out| {
            serde_json::to_writer_pretty(&mut *out, &table::json(&rows, &options))?;
            writeln!(out)
        })?;
    }
    output::commit([markdown].into_iter().chain(json))?;
    let wrong: Vec<&str> = (rows.iter())
        .filter(|row| !row.exact_is_right())
        .map(|row| row.name.as_str())
        .collect();
    if wrong.is_empty() {
        return Ok(Answer::Yes);
    }
    complain(&format!(
        "the exact methods contradict what is stated, or give up, on: {}",
        wrong.join(", ")
    ));
    Ok(Answer::No)
}

/// The levels of a folder, by name.
fn levels(folder: &Path) -> Result<Vec<PathBuf>> {
    let cannot = || format!("cannot read the folder {}", folder.display());
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).with_context(cannot)? {
        let path = entry.with_context(cannot)?.path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            paths.push(path);
        }
    }
    if paths.is_empty() {
        bail!(
            "{} holds no .toml levels; name a folder that does, such as levels/hard",
            folder.display()
        );
    }
    paths.sort();
    Ok(paths)
}

fn of_level(path: &Path, options: &StabilityOptions) -> Result<Row> {
    let text = fs::read_to_string(path).context("cannot be read")?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Ok(judge(&Case::parse(&name, &text)?, options)?)
}
