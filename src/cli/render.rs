//! `enfilade render`: a picture of a level from an eye.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use image::ImageEncoder;

use super::compute::timed;
use super::level_args::LevelArgs;
use super::output::{self, Output};
use super::stage::{self, Stage, StageArgs};
use super::{Answer, complain, progress};
use crate::cells::Locator;
use crate::preview::{self, Culling, Easel, Painter};
use crate::pvs::Progress;
use crate::trace::Tracer;
use crate::trace::accel::Kind;
use crate::trace::camera::Camera;
use crate::trace::effects::{Effect, survey};
use crate::trace::render::{Rendered, render};
use crate::trace::world::locate;

pub mod files;
pub mod trace_args;
pub mod viewpoint;

use trace_args::{Asked, TraceArgs};
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
    #[command(flatten)]
    trace: TraceArgs,
    /// How rays find what they meet: portal (from cell to cell), or brute, bvh-median-boxes … for
    /// comparison; the picture is the same
    #[arg(long, value_name = "NAME", default_value = "portal", value_parser = structure)]
    structure: Found,
    /// Ray tracing, or the polygons painted from back to front
    #[arg(long, value_enum, value_name = "HOW", default_value = "trace")]
    renderer: Renderer,
    #[command(flatten)]
    stage: StageArgs,
}

/// How pictures are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Renderer {
    /// By ray tracing
    Trace,
    /// By painting polygons from back to front
    Preview,
}

/// What `--structure` asks for.
#[derive(Clone, Copy, Debug)]
enum Found {
    Portal,
    By(Kind),
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

/// A picture and what there is to say of it.
struct Drawn {
    /// sRGB, three bytes to a pixel.
    bytes: Vec<u8>,
    /// Which picture it is.
    name: String,
    seconds: f64,
    /// Lines about cells, rays or polygons.
    work: String,
    /// Lines about effects.
    effects: String,
}

/// Runs `enfilade render`.
pub fn run(args: &RenderArgs) -> Result<Answer> {
    must_be_png(args)?;
    args.view.check()?;
    // Found out now; written only at the end, so that nothing stays behind when it is broken off.
    drop(Output::create(&args.output)?);
    let stage = stage::set(&args.level, &args.stage, args.trace.ambient, |level| level)?;
    let drawn = match args.renderer {
        Renderer::Trace => traced(args, &stage)?,
        Renderer::Preview => painted(args, &stage)?,
    };
    let mut writing = 0.0;
    timed(&mut writing, || {
        write(&args.output, args.size, &drawn.bytes)
    })?;
    if args.stage.quiet {
        return Ok(Answer::Yes);
    }
    let [width, height] = args.size;
    let seconds = &stage.seconds;
    let text = format!(
        "picture     {width} × {height}, {}\n{}seconds     read {:.3}, subdivide {:.3}, visibility {:.3}, \
         render {:.3}, write {writing:.3}\n{}",
        drawn.name,
        drawn.work,
        seconds.read,
        seconds.subdivide,
        seconds.visibility,
        drawn.seconds,
        drawn.effects,
    );
    if output::is_stdout(&args.output) {
        complain(text.trim_end());
    } else {
        output::print(&text)?;
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

/// Draws by rays.
fn traced(args: &RenderArgs, stage: &Stage) -> Result<Drawn> {
    let (world, graph) = (&stage.world, &stage.graph);
    let view = Viewpoint::choose(&args.view, &stage.level, graph, world)?;
    let start = locate(world, graph, &Locator::new(graph), view.eye)?;
    let survey = survey(world, &stage.pvs, start);
    let exposure = args.trace.exposure(world);
    let options = args.trace.options(&survey, exposure);
    let camera = Camera::new(view.eye, view.direction, view.fov, args.size);
    let tracer = match args.structure {
        Found::Portal => Tracer::new(world),
        Found::By(Kind::Brute) => Tracer::brute(world),
        Found::By(kind) => Tracer::with_structure(world, kind),
    };
    let mut seconds = 0.0;
    let rendered: Rendered = timed(&mut seconds, || {
        let counter = Progress::default();
        progress::show("drawing pixels", args.stage.quiet, &counter, || {
            let draw = || render(&tracer, &camera, start, &options, &counter);
            stage.pool.install(draw)
        })
    });
    let mut work = String::new();
    let rays = &rendered.work.rays;
    _ = writeln!(
        work,
        "cells       {} in the level, {} in the eye's PVS, {} touched",
        graph.cells.len(),
        stage.pvs.seen_from(start).count(),
        rendered.work.n_touched()
    );
    _ = writeln!(
        work,
        "rays        {} primary, {} shadow, {} reflected, {} passing through",
        rays.primary, rays.shadow, rays.reflected, rays.refracted
    );
    if args.trace.adaptive.is_some() {
        _ = writeln!(work, "refined     {} pixels", rendered.refined);
    }
    let factor = rendered.picture.factor(exposure);
    _ = writeln!(work, "exposure    {:+.2} stops", factor.log2());
    let mut effects = String::new();
    let asked = matches!(args.trace.effects, Asked::Set(_));
    for verdict in &survey.verdicts {
        let on = options.effects.has(verdict.effect);
        let note = match (asked, on == verdict.needed) {
            (true, false) if on => " (asked for, though)",
            (true, false) => " (left out as asked)",
            _ => "",
        };
        _ = writeln!(
            effects,
            "{:<11} {:<3}  {}{note}",
            Effect::as_str(verdict.effect),
            if on { "on" } else { "off" },
            verdict.reason
        );
    }
    Ok(Drawn {
        bytes: rendered.picture.srgb(exposure),
        name: view.name,
        seconds,
        work,
        effects,
    })
}

/// Paints polygons, and says what each way to choose them costs.
fn painted(args: &RenderArgs, stage: &Stage) -> Result<Drawn> {
    let view = Viewpoint::choose(&args.view, &stage.level, &stage.graph, &stage.world)?;
    let camera = Camera::new(view.eye, view.direction, view.fov, args.size);
    let painter = painter(stage)?;
    let mut easel = Easel::default();
    let mut work = String::new();
    let mut seconds = 0.0;
    for culling in Culling::ALL {
        let options = preview::Options {
            culling,
            order: preview::Order::BackToFront,
            objects: true,
            surfaces: false,
        };
        let draw = || painter.draw(&camera, &options, &mut easel);
        let figures = timed(&mut seconds, || stage.pool.install(draw))?;
        _ = writeln!(
            work,
            "{:<11} {} cells, {} polygons, {} painted, overdraw {:.2}, {:.1} ms",
            match culling {
                Culling::None => "all",
                Culling::Pvs => "PVS",
                Culling::Eye => "seen",
            },
            figures.cells,
            figures.polygons,
            figures.painted,
            figures.overdraw(),
            seconds * 1e3,
        );
    }
    Ok(Drawn {
        bytes: easel.canvas.srgb(),
        name: view.name,
        seconds,
        work,
        effects: String::new(),
    })
}

/// A painter for a level; cells cut by no lines cannot be put in order.
pub fn painter(stage: &Stage) -> Result<Painter<'_>> {
    let painter = Painter::new(
        &stage.world,
        &stage.graph,
        &stage.pvs,
        preview::Finish::Textured,
    );
    painter.context(
        "the preview needs cells that were cut by lines; leave --subdivision cdt out, or use kd",
    )
}

/// Writes the picture, whole or not at all.
fn write(path: &Path, [width, height]: [u32; 2], bytes: &[u8]) -> Result<()> {
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(bytes, width, height, image::ExtendedColorType::Rgb8)
        .context("the picture cannot be encoded")?;
    let mut file = Output::create(path)?;
    file.write(|out| out.write_all(&png))?;
    output::commit([file])
}
