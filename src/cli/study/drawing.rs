//! `enfilade study effects`, `antialiasing` and `structures`: what a picture's accuracy costs.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

use super::desk::Desk;
use super::papers::{Papers, check_budget};
use crate::cells::{Locator, Options, subdivide};
use crate::cli::level_args::{DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use crate::cli::render::viewpoint::{self, ViewArgs, Viewpoint};
use crate::cli::render::{AMBIENT, files};
use crate::cli::{Answer, Memory, compute, progress, summary};
use crate::pvs::{Progress, sweep};
use crate::study::drawing::{About, Shot, antialiasing, effects, structures};
use crate::study::visibility::Bench;
use crate::trace::camera::Camera;
use crate::trace::effects::survey;
use crate::trace::render::RenderOptions;
use crate::trace::world::{World, locate};

/// What all three need.
#[derive(Debug, Args)]
struct ShotArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// Page to write; it needs nothing else (`-`: standard output)
    #[arg(short, long, value_name = "FILE.html")]
    output: PathBuf,
    /// Write all figures as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Seconds for the whole study; what they are too short for is left out
    #[arg(long, value_name = "SECONDS", default_value_t = 90.0)]
    budget: f64,
    #[command(flatten)]
    view: ViewArgs,
    /// How the plan is cut into cells
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

/// What each effect of a picture costs, and what is missing without it.
///
/// Draws the picture with all that it calls for, and without one effect after the other; compares
/// times, rays, and what is seen.
#[derive(Debug, Args)]
pub struct EffectsArgs {
    #[command(flatten)]
    shot: ShotArgs,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "480x300", value_parser = viewpoint::size)]
    size: [u32; 2],
    /// Samples in each pixel
    #[arg(long, value_name = "N", default_value_t = 4)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1024))]
    samples: u32,
}

/// How many samples, reflections and shadow rays are enough: error against time.
///
/// Compares pictures with few of them with one that has many.
#[derive(Debug, Args)]
pub struct AntialiasingArgs {
    #[command(flatten)]
    shot: ShotArgs,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "192x120", value_parser = viewpoint::size)]
    size: [u32; 2],
    /// Samples in each pixel of the picture that counts as true
    #[arg(long, value_name = "N", default_value_t = 1024)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    reference: u32,
}

/// Which structure finds what rays meet fastest, the portal walk among them.
///
/// Casts the same primary, shadow and reflected rays with all of them, on one thread.
#[derive(Debug, Args)]
pub struct StructuresArgs {
    #[command(flatten)]
    shot: ShotArgs,
    /// Width and height in pixels: primary rays
    #[arg(long, value_name = "WxH", default_value = "320x200", value_parser = viewpoint::size)]
    size: [u32; 2],
}

/// Runs `enfilade study effects`.
pub fn effects(args: &EffectsArgs, memory: Option<Memory>) -> Result<Answer> {
    let change = |options: &mut RenderOptions| options.samples = args.samples;
    run(&args.shot, args.size, change, memory, |shot, desk| {
        let study = effects::study(shot, desk);
        let rows = effects::rows(&study);
        let rows: Vec<&[String]> = rows.iter().map(|row| &row[..]).collect();
        let head = ["", "time", "rays", "error", "alike"];
        Finished {
            page: effects::page(&study),
            table: summary::table(&head, &rows),
            advice: study.advice(),
            figures: study,
        }
    })
}

/// Runs `enfilade study antialiasing`.
pub fn antialiasing(args: &AntialiasingArgs, memory: Option<Memory>) -> Result<Answer> {
    run(
        &args.shot,
        args.size,
        |_| (),
        memory,
        |shot, desk| {
            let study = antialiasing::study(shot, args.reference, desk);
            let rows = antialiasing::rows(&study);
            let rows: Vec<&[String]> = rows.iter().map(|row| &row[..]).collect();
            let head = ["", "time", "rays", "error", "alike"];
            Finished {
                page: antialiasing::page(&study),
                table: summary::table(&head, &rows),
                advice: study.advice().into_iter().map(|(_, text)| text).collect(),
                figures: study,
            }
        },
    )
}

/// Runs `enfilade study structures`.
pub fn structures(args: &StructuresArgs, memory: Option<Memory>) -> Result<Answer> {
    run(
        &args.shot,
        args.size,
        |_| (),
        memory,
        |shot, desk| {
            let study = structures::study(shot, desk);
            let rows = structures::rows(&study);
            let rows: Vec<&[String]> = rows.iter().map(|row| &row[..]).collect();
            let head = [
                "",
                "build",
                "memory",
                "primary M/s",
                "shadow M/s",
                "incoherent M/s",
            ];
            Finished {
                page: structures::page(&study),
                table: summary::table(&head, &rows),
                advice: study.advice(),
                figures: study,
            }
        },
    )
}

/// A finished study.
struct Finished<T> {
    page: String,
    table: String,
    advice: Vec<String>,
    figures: T,
}

/// Reads the level, sets the scene, has it studied, and writes what came out.
fn run<T: Serialize + Send>(
    args: &ShotArgs,
    size: [u32; 2],
    change: impl FnOnce(&mut RenderOptions),
    memory: Option<Memory>,
    study: impl FnOnce(&Shot, &mut Desk) -> Finished<T> + Send,
) -> Result<Answer> {
    check_budget(args.budget)?;
    args.view.check()?;
    let papers = Papers::new(&args.output, args.json.as_deref())?;
    let source = args.level.open()?;
    let level = source.level(args.level.map.as_deref())?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let options = Options {
        subdivision: args.subdivision.into(),
        doors: args.doors.into(),
        ..Options::default()
    };
    let graph = subdivide(&level, &options);
    let pvs = sweep::sweep(&graph, &Progress::default());
    let read = files::read(&args.level.level, &source, &level)?;
    let world =
        World::new(&level, &graph, &pvs, &read, AMBIENT).with_context(|| level.source.clone())?;
    let view = Viewpoint::choose(&args.view, &level, &graph, &world)?;
    let start = locate(&world, &graph, &Locator::new(&graph), view.eye)?;
    let survey = survey(&world, &pvs, start);
    let mut options = RenderOptions {
        seed: args.seed,
        effects: survey.needed,
        ..RenderOptions::default()
    };
    change(&mut options);
    let mut desk = Desk::new(compute::pool(args.threads)?, memory);
    let (machine, threads) = desk.machine();
    let shot = Shot {
        world: &world,
        camera: Camera::new(view.eye, view.direction, view.fov, size),
        start,
        survey: &survey,
        options,
        about: About {
            level: level.name.clone(),
            source: level.source.clone(),
            view: view.name.clone(),
            size,
            enfilade: env!("CARGO_PKG_VERSION"),
            machine,
            threads,
            seed: args.seed,
            budget: args.budget,
        },
    };
    let line = desk.line(args.budget);
    let finished = progress::show_parts(args.quiet, line, || study(&shot, &mut desk));
    papers.write(&finished.page, &finished.figures)?;
    if !args.quiet {
        let text = format!(
            "{} ({}), {}\n\n{}\n{}\n",
            level.name,
            level.source,
            view.name,
            finished.table,
            finished.advice.join("\n")
        );
        papers.say(&text)?;
    }
    Ok(Answer::Yes)
}
