//! `enfilade check`: what looks wrong in a level, each with its places.

use std::fmt::Write;
use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use serde_json::{Value, json};

use super::level_args::LevelArgs;
use super::output::{self, Output};
use super::{Answer, complain};
use crate::cells::{Options, subdivide};
use crate::level::read::Source;
use crate::level::{Finding, Level, Place};
use crate::report::check;
use crate::report::json::place;
use crate::report::wording::{count, grouped};

/// How many places of a finding the text shows; the JSON has all.
const SHOWN: usize = 8;

/// List what was repaired in a level or looks wrong: gaps, overlaps, leaks, unreachable rooms,
/// slivers, points that nearly coincide, snapping.
///
/// Findings are no failure: the exit status is 0 for every level that can be read, and 2 for one
/// that cannot.
#[derive(Debug, Args)]
pub struct CheckArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// Check every map of a WAD
    #[arg(long, conflicts_with = "map")]
    all: bool,
    /// Write the findings as JSON, with all places (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Runs `enfilade check`.
pub fn run(args: &CheckArgs) -> Result<Answer> {
    let source = args.level.open()?;
    let maps: Vec<Option<String>> = match source.maps() {
        maps if args.all && !maps.is_empty() => maps.into_iter().map(Some).collect(),
        _ => vec![args.level.map.clone()],
    };
    let mut json = args.json.as_deref().map(Output::create).transpose()?;
    let to_stdout = args.json.as_deref().is_some_and(output::is_stdout);
    let mut levels = Vec::new();
    let mut unreadable = 0;
    for map in &maps {
        match check(&source, map.as_deref()) {
            Ok((level, findings)) => {
                if !args.quiet && !to_stdout {
                    output::print(&in_words(&level, &findings))?;
                }
                levels.push(as_json(&level, &findings));
            }
            Err(error) if args.all => {
                complain(&format!("error: {error}"));
                levels.push(json!({ "name": map, "error": error.to_string() }));
                unreadable += 1;
            }
            Err(error) => return Err(error),
        }
    }
    if let Some(json) = &mut json {
        let document = json!({ "format": "enfilade.findings", "version": 1, "levels": levels });
        json.write(|out| {
            serde_json::to_writer_pretty(&mut *out, &document)?;
            writeln!(out)
        })?;
    }
    output::commit(json)?;
    if unreadable > 0 {
        bail!(
            "{} of {} cannot be read",
            unreadable,
            count(maps.len(), "map")
        );
    }
    Ok(Answer::Yes)
}

/// A level with all that is to be said about it, the gravest first.
fn check(source: &Source, map: Option<&str>) -> Result<(Level, Vec<Finding>)> {
    let level = source.level(map)?;
    let graph = subdivide(&level, &Options::default());
    let mut all = level.findings.clone();
    all.extend(graph.findings.iter().cloned());
    all.extend(check::of_cells(&level, &graph));
    all.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Ok((level, all))
}

fn in_words(level: &Level, findings: &[Finding]) -> String {
    let mut out = format!("{} ({}): ", level.name, level.source);
    out += &match findings.len() {
        0 => "nothing found\n".to_string(),
        n => format!("{}\n", count(n, "finding")),
    };
    for finding in findings {
        let Finding {
            code,
            severity,
            message,
            places,
        } = finding;
        let n = grouped(places.len() as u64);
        _ = writeln!(out, "  {}: {n} × {code}. {message}", severity.as_str());
        let shown: Vec<String> = places.iter().take(SHOWN).map(in_short).collect();
        _ = write!(out, "      at {}", shown.join("; "));
        match places.len().saturating_sub(SHOWN) {
            0 => out.push('\n'),
            more => _ = writeln!(out, "; and {} more", grouped(more as u64)),
        }
    }
    out
}

/// A place with as many digits as it takes to find it.
fn in_short(place: &Place) -> String {
    let short = |x: f64| (x * 1e4).round() / 1e4;
    match *place {
        Place::Point { x, y } => Place::Point {
            x: short(x),
            y: short(y),
        }
        .to_string(),
        _ => place.to_string(),
    }
}

fn as_json(level: &Level, findings: &[Finding]) -> Value {
    let finding = |f: &Finding| {
        json!({
            "code": f.code,
            "severity": f.severity.as_str(),
            "message": f.message,
            "count": f.places.len(),
            "places": f.places.iter().map(place).collect::<Vec<_>>(),
        })
    };
    json!({
        "name": level.name,
        "source": level.source,
        "unit": level.unit,
        "snap": level.snap,
        "findings": findings.iter().map(finding).collect::<Vec<_>>(),
    })
}
