//! `enfilade render`: a picture of a level from an eye.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::Args;
use image::ImageEncoder;

use super::compute::{self, timed};
use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg, open, warn_of};
use super::output::{self, Output};
use super::{Answer, complain, progress};
use crate::cells::{CellGraph, Locator, subdivide};
use crate::pvs::{Progress, sweep};
use crate::trace::Tracer;
use crate::trace::accel::Kind;
use crate::trace::camera::Camera;
use crate::trace::effects::{Effect, Effects, Survey, survey};
use crate::trace::picture::Exposure;
use crate::trace::render::{Adaptive, RenderOptions, Rendered, render};
use crate::trace::shade::Limits;
use crate::trace::world::{World, locate};

pub mod files;
pub mod viewpoint;

use viewpoint::{ViewArgs, Viewpoint};

/// The ambient term of places that have no brightness of their own.
pub const AMBIENT: f64 = 0.12;

/// Draw what an eye in a level sees, by ray tracing.
#[derive(Debug, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// Picture to write: a .png (`-`: standard output)
    #[arg(short, long, value_name = "FILE.png")]
    output: PathBuf,
    #[command(flatten)]
    view: ViewArgs,
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "960x600", value_parser = viewpoint::size)]
    size: [u32; 2],
    /// Samples in each pixel; 1: through its middle
    #[arg(long, value_name = "N", default_value_t = 4)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    samples: u32,
    /// So many samples in pixels that differ from their neighbours
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65_536))]
    adaptive: Option<u32>,
    /// With --adaptive: the difference, from 0 to 1 (black to white)
    #[arg(long, value_name = "D", default_value_t = 0.05, value_parser = positive)]
    contrast: f64,
    /// Most reflections and refractions in a row
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=1000))]
    depth: u32,
    /// Rays whose share of the pixel is smaller are not cast
    #[arg(long, value_name = "SHARE", default_value_t = 1.0 / 256.0, value_parser = not_negative)]
    threshold: f64,
    /// Shadow rays to each light with an extent, per pixel
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    light_samples: u32,
    /// Rays into the cone of a rough surface, per pixel
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    scatter_samples: u32,
    /// What is simulated: auto (what can matter), all, none, or some of shadows, soft, mirror, glossy,
    /// refraction, translucency, textures, with commas between them
    #[arg(long, value_name = "LIST", default_value = "auto", value_parser = effects)]
    effects: Asked,
    /// Stops by which light is brightened (or darkened, below 0) [default: as the picture asks for;
    /// 1.5 for Doom maps]
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true, value_parser = finite)]
    exposure: Option<f64>,
    /// Light that is everywhere, where the level does not say how bright its places are
    #[arg(long, value_name = "IA", default_value_t = AMBIENT, value_parser = not_negative)]
    ambient: f64,
    /// Seed of all that is random
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How rays find what they meet: portal (from cell to cell), or brute, bvh-median-boxes … for
    /// comparison; the picture is the same
    #[arg(long, value_name = "NAME", default_value = "portal", value_parser = structure)]
    structure: Found,
    /// How the plan is cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: SubdivisionArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    doors: DoorsArg,
    /// Threads to compute with [default: all processors]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    bsp: BspArgs,
}

/// What `--effects` asks for.
#[derive(Clone, Copy, Debug)]
enum Asked {
    Auto,
    Set(Effects),
}

/// What `--structure` asks for.
#[derive(Clone, Copy, Debug)]
enum Found {
    Portal,
    By(Kind),
}

fn effects(text: &str) -> Result<Asked, String> {
    Ok(match text {
        "auto" => Asked::Auto,
        "all" => Asked::Set(Effects::ALL),
        "none" => Asked::Set(Effects::NONE),
        list => Asked::Set(list.parse()?),
    })
}

fn structure(text: &str) -> Result<Found, String> {
    match text {
        "portal" => Ok(Found::Portal),
        name => name
            .parse()
            .map(Found::By)
            .map_err(|e: String| format!("{e}, and portal")),
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| "a number is needed".to_string())
}

fn not_negative(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|&x| x >= 0.0)
        .ok_or_else(|| "a number from 0 on is needed".to_string())
}

fn positive(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|&x| x > 0.0)
        .ok_or_else(|| "a number above 0 is needed".to_string())
}

/// How long each stage took, in seconds.
#[derive(Default)]
struct Seconds {
    read: f64,
    subdivide: f64,
    visibility: f64,
    render: f64,
    write: f64,
}

/// Runs `enfilade render`.
pub fn run(args: &RenderArgs) -> Result<Answer> {
    must_be_png(args)?;
    args.view.check()?;
    // Found out now; written only at the end, so that nothing stays behind when it is broken off.
    drop(Output::create(&args.output)?);
    let pool = compute::pool(args.threads)?;
    let mut seconds = Seconds::default();
    let mut reading = 0.0;
    let (source, level) = timed(&mut seconds.read, || -> Result<_> {
        let source = open(&args.level.level)?;
        let level = source.level(args.level.map.as_deref())?;
        Ok((source, level))
    })?;
    if !args.quiet {
        warn_of(&level.findings);
    }
    let options = args.bsp.options(args.subdivision.into(), args.doors.into());
    let graph = timed(&mut seconds.subdivide, || subdivide(&level, &options));
    let pvs = timed(&mut seconds.visibility, || {
        let counter = Progress::default();
        progress::show("finding what is visible", args.quiet, &counter, || {
            pool.install(|| sweep::sweep(&graph, &counter))
        })
    });
    let read = timed(&mut reading, || {
        files::read(&args.level.level, &source, &level)
    })?;
    seconds.read += reading;
    let world = World::new(&level, &graph, &pvs, &read, args.ambient)
        .with_context(|| level.source.clone())?;
    let locator = Locator::new(&graph);
    let view = Viewpoint::choose(&args.view, &level, &graph, &world)?;
    let start = locate(&world, &graph, &locator, view.eye)?;
    let survey = survey(&world, &pvs, start);
    let exposure = exposure(args, &world);
    let options = render_options(args, &survey, exposure);
    let camera = Camera::new(view.eye, view.direction, view.fov, args.size);
    let tracer = match args.structure {
        Found::Portal => Tracer::new(&world),
        Found::By(Kind::Brute) => Tracer::brute(&world),
        Found::By(kind) => Tracer::with_structure(&world, kind),
    };
    let rendered = timed(&mut seconds.render, || {
        let counter = Progress::default();
        progress::show("drawing pixels", args.quiet, &counter, || {
            pool.install(|| render(&tracer, &camera, start, &options, &counter))
        })
    });
    timed(&mut seconds.write, || write(args, &rendered, exposure))?;
    if !args.quiet {
        let seen = pvs.seen_from(start).count();
        let text = summary(
            args, &view, &graph, seen, &survey, &options, &rendered, exposure, &seconds,
        );
        if output::is_stdout(&args.output) {
            complain(text.trim_end());
        } else {
            output::print(&text)?;
        }
    }
    Ok(Answer::Yes)
}

/// Refuses other endings: what stands in a .jpg should be one.
fn must_be_png(args: &RenderArgs) -> Result<()> {
    let ending = args.output.extension().unwrap_or_default();
    if !output::is_stdout(&args.output) && !ending.eq_ignore_ascii_case("png") {
        bail!(
            "{}: a rendered picture is a .png file; give it that ending",
            args.output.display()
        );
    }
    Ok(())
}

/// As asked for. A Doom map says itself how bright its places are; its textures are dark, though, and
/// the game brightens what is near.
fn exposure(args: &RenderArgs, world: &World) -> Exposure {
    const DOOM: Exposure = Exposure::Stops(1.5);
    let usual = if world.wardrobe.is_some() {
        DOOM
    } else {
        Exposure::Auto
    };
    args.exposure.map_or(usual, Exposure::Stops)
}

fn render_options(args: &RenderArgs, survey: &Survey, exposure: Exposure) -> RenderOptions {
    RenderOptions {
        samples: args.samples,
        adaptive: args.adaptive.map(|samples| Adaptive {
            samples,
            contrast: args.contrast,
            exposure,
        }),
        limits: Limits {
            depth: args.depth,
            threshold: args.threshold,
            light_samples: args.light_samples,
            scatter_samples: args.scatter_samples,
        },
        seed: args.seed,
        effects: match args.effects {
            Asked::Auto => survey.needed,
            Asked::Set(effects) => effects,
        },
    }
}

/// Writes the picture, whole or not at all.
fn write(args: &RenderArgs, rendered: &Rendered, exposure: Exposure) -> Result<()> {
    let [width, height] = rendered.picture.size;
    let bytes = rendered.picture.srgb(exposure);
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&bytes, width, height, image::ExtendedColorType::Rgb8)
        .context("the picture cannot be encoded")?;
    let mut file = Output::create(&args.output)?;
    file.write(|out| out.write_all(&png))?;
    output::commit([file])
}

/// What there is to say of a finished picture.
#[allow(clippy::too_many_arguments)]
fn summary(
    args: &RenderArgs,
    view: &Viewpoint,
    graph: &CellGraph,
    seen: usize,
    survey: &Survey,
    options: &RenderOptions,
    rendered: &Rendered,
    exposure: Exposure,
    seconds: &Seconds,
) -> String {
    let mut text = String::new();
    let [width, height] = args.size;
    let rays = &rendered.work.rays;
    let factor = rendered.picture.factor(exposure);
    _ = writeln!(text, "picture     {width} × {height}, {}", view.name);
    _ = writeln!(
        text,
        "cells       {} in the level, {seen} in the eye's PVS, {} touched",
        graph.cells.len(),
        rendered.work.n_touched()
    );
    _ = writeln!(
        text,
        "rays        {} primary, {} shadow, {} reflected, {} passing through",
        rays.primary, rays.shadow, rays.reflected, rays.refracted
    );
    if args.adaptive.is_some() {
        _ = writeln!(text, "refined     {} pixels", rendered.refined);
    }
    _ = writeln!(text, "exposure    {:+.2} stops", factor.log2());
    _ = writeln!(
        text,
        "seconds     read {:.3}, subdivide {:.3}, visibility {:.3}, render {:.3}, write {:.3}",
        seconds.read, seconds.subdivide, seconds.visibility, seconds.render, seconds.write
    );
    let asked = matches!(args.effects, Asked::Set(_));
    for verdict in &survey.verdicts {
        let on = options.effects.has(verdict.effect);
        let note = match (asked, on == verdict.needed) {
            (true, false) if on => " (asked for, though)",
            (true, false) => " (left out as asked)",
            _ => "",
        };
        _ = writeln!(
            text,
            "{:<11} {:<3}  {}{note}",
            Effect::as_str(verdict.effect),
            if on { "on" } else { "off" },
            verdict.reason
        );
    }
    text
}
