//! `enfilade study visibility`: all methods on one level, and what accuracy costs.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;

use super::desk::Desk;
use super::papers::{Papers, check_budget};
use crate::cells::Options;
use crate::cli::level_args::{DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use crate::cli::{Answer, Memory, complain, compute, progress, summary};
use crate::level::wording::{duration, grouped};
use crate::study::visibility::{Answer as Figures, Results, Run, StudyOptions};
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
    check_budget(args.budget)?;
    let papers = Papers::new(&args.output, args.json.as_deref())?;
    let mut desk = Desk::new(compute::pool(args.threads)?, memory);
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
    let line = desk.line(args.budget);
    let study = progress::show_parts(args.quiet, line, || study(&level, &options, &mut desk));
    let Some(study) = study else {
        bail!(
            "{} has no inside; there is nothing to see in it",
            level.name
        );
    };
    papers.write(&page(&level, &study), &study.results)?;
    if !args.quiet {
        for note in &study.results.notes {
            complain(&format!("note: {note}"));
        }
        papers.say(&in_words(&study.results))?;
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
