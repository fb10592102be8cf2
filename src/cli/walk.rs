//! `enfilade walk`: a walk through a level, frame by frame.

use std::fs;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail};

use super::output::{self, Output};
use super::render::trace_args::Asked;
use super::render::{Renderer, files, painter};
use super::stage::{self, Stage};
use super::{Answer, progress};
use crate::level::scene::CameraPath;
use crate::level::toml::walks;
use crate::preview::{self, Easel, Painter};
use crate::pvs::Progress;
use crate::report::walkthrough;
use crate::trace::Tracer;
use crate::trace::camera::Camera;
use crate::trace::effects::Effects;
use crate::trace::picture::Exposure;
use crate::trace::render::render;
use crate::walk::figures::{self, Frame, Summary};
use crate::walk::frame::{Counts, Guide};
use crate::walk::{Ground, Tour, Track, TrackOptions, opened, tour};

mod args;
mod film;
mod frames;
mod words;

pub use args::WalkArgs;

use frames::Folder;
use words::{length, text};

/// The angle of view of a tour.
const FOV: f64 = 75.0;

/// What comes out.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Folder,
    Gif,
    Mp4,
}

impl Kind {
    fn of(output: &Path) -> Result<Self> {
        let ending = output.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            _ if output::is_stdout(output) => {
                bail!("frames do not go to standard output; give a folder, a .gif or an .mp4")
            }
            _ if output.is_dir() => Ok(Kind::Folder),
            _ if output.exists() && ending.is_empty() => {
                bail!("{} is a file; give a folder for frames", output.display())
            }
            Some("gif") => Ok(Kind::Gif),
            Some("mp4") => Ok(Kind::Mp4),
            Some("") => Ok(Kind::Folder),
            _ => bail!(
                "{}: a walk is a folder of frames, a .gif or an .mp4",
                output.display()
            ),
        }
    }
}

/// Where the walk goes.
struct Route {
    track: Track,
    name: String,
    fov: f64,
    tour: Option<Tour>,
}

/// What was done.
struct Done {
    frames: Vec<Frame>,
    kept: usize,
    removed: usize,
}

/// Runs `enfilade walk`.
pub fn run(args: &WalkArgs) -> Result<Answer> {
    let kind = Kind::of(&args.output)?;
    if kind == Kind::Mp4 {
        film::must_have_ffmpeg()?;
    }
    let papers = [&args.figures, &args.chart].map(|p| p.as_deref());
    output::must_differ(papers[0], papers[1])?;
    for path in papers.into_iter().flatten() {
        drop(Output::create(path)?);
    }
    if kind != Kind::Folder {
        drop(Output::create(&args.output)?);
    }
    let open_doors = args.stage.doors == super::level_args::DoorsArg::Open;
    let stage = stage::set(&args.level, &args.stage, args.trace.ambient, |level| {
        let person = args.person.person(&level);
        if open_doors {
            opened(&level, &person)
        } else {
            level
        }
    })?;
    let route = route(args, &stage)?;
    let cameras = cameras(args, &route)?;
    let mut guide = Guide::new(&stage.world, &stage.graph, &stage.pvs, !args.no_reuse);
    for (camera, number) in cameras.iter().zip(0u32..) {
        let at = args.from + f64::from(number) / args.fps;
        let inside = guide.cell(camera);
        inside.with_context(|| format!("{}, after {at:.2} seconds", route.name))?;
    }
    if args.renderer == Renderer::Preview {
        // Before anything is written.
        painter(&stage)?;
    }
    let place = match kind {
        Kind::Folder => args.output.clone(),
        _ => {
            let mut name = args.output.clone().into_os_string();
            name.push(".frames");
            name.into()
        }
    };
    let folder = Folder::open(&place, args.size)?;
    let counter = Progress::default();
    let start = Instant::now();
    let done = progress::show("drawing frames", args.stage.quiet, &counter, || {
        let cameras = (&cameras[..], route.fov);
        draw(args, &stage, cameras, &mut guide, &folder, &counter)
    })?;
    let drawing = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let n = cameras.len() as u32;
    if kind != Kind::Folder {
        let counter = Progress::default();
        progress::show("making one file", args.stage.quiet, &counter, || {
            let film = if kind == Kind::Gif {
                film::gif
            } else {
                film::mp4
            };
            film(&folder, n, args.size, args.fps, &args.output, &counter)
        })?;
        if !args.keep_frames {
            folder.remove()?;
        }
    }
    let summary = Summary::of(&done.frames);
    let seconds = f64::from(n) / args.fps;
    let walk = walkthrough::Walk {
        level: &stage.level.name,
        source: &stage.level.source,
        route: &route.name,
        renderer: match args.renderer {
            Renderer::Trace => "trace",
            Renderer::Preview => "preview",
        },
        size: args.size,
        fps: args.fps,
        seconds,
        length: &length(
            route.track.length() * (seconds / route.track.seconds().max(seconds)),
            &stage.level.unit,
        ),
        frames: &done.frames,
        summary: &summary,
    };
    write_papers(papers, &walk)?;
    let writing = start.elapsed().as_secs_f64();
    if !args.stage.quiet {
        let text = text(args, &stage, &route, &done, &walk, [drawing, writing]);
        if args.figures.as_deref().is_some_and(output::is_stdout) {
            super::complain(text.trim_end());
        } else {
            output::print(&text)?;
        }
    }
    Ok(Answer::Yes)
}

/// The way that was asked for.
fn route(args: &WalkArgs, stage: &Stage) -> Result<Route> {
    let level = &stage.level;
    let options = TrackOptions::default();
    if args.tour {
        let person = args.person.person(level);
        let Some(tour) = tour(level, &stage.graph, &stage.world.space, &person) else {
            bail!(
                "nowhere in {} is there room to stand for someone {} wide and {} high; see --radius \
                 and --stature",
                level.name,
                2.0 * person.radius,
                person.height
            );
        };
        return Ok(Route {
            track: tour.track(&options),
            name: "tour".to_string(),
            fov: args.fov.unwrap_or(FOV),
            tour: Some(tour),
        });
    }
    let mut paths = level.scene.paths.clone();
    if let Some(file) = &args.walks {
        paths.extend(walks_of(file)?);
    }
    let names = || {
        let names: Vec<&str> = paths.iter().map(|p| p.name.as_str()).collect();
        names.join(", ")
    };
    let path = match (&args.path, &paths[..]) {
        (_, []) => bail!("{} has no paths; --tour finds a way by itself", level.name),
        (None, [path]) => path,
        (None, _) => bail!(
            "choose one with --path, or take --tour; there are: {}",
            names()
        ),
        (Some(name), _) => match paths.iter().find(|p| p.name == *name) {
            Some(path) => path,
            None => bail!("there is no path `{name}`; there are: {}", names()),
        },
    };
    let ground = Ground::new(&stage.graph, &stage.world.space);
    Ok(Route {
        track: Track::new(path, &ground, &options),
        name: format!("path `{}`", path.name),
        fov: args.fov.unwrap_or(path.fov),
        tour: None,
    })
}

/// The paths of a file that holds nothing else.
fn walks_of(file: &Path) -> Result<Vec<CameraPath>> {
    let name = file.display();
    let text = std::fs::read_to_string(file).with_context(|| format!("cannot read {name}"))?;
    walks::read(&text).with_context(|| format!("{name} is no file of walks"))
}

/// The camera of each frame.
fn cameras(args: &WalkArgs, route: &Route) -> Result<Vec<Camera>> {
    const MOST: f64 = 99_999.0;
    let end = route.track.seconds();
    let to = args.to.unwrap_or(end).min(end);
    if args.from > to {
        bail!(
            "--from {} is after the end; the walk takes {end:.2} seconds",
            args.from
        );
    }
    let n = ((to - args.from) * args.fps).round().max(1.0);
    if n > MOST {
        bail!("{n} frames are too many; take fewer --fps, or a part with --from and --to");
    }
    let pose = |k: u32| route.track.at(args.from + f64::from(k) / args.fps);
    let poses = (0..n as u32).map(pose);
    Ok(poses
        .map(|p| Camera::new(p.eye, p.direction, route.fov, args.size))
        .collect())
}

/// Draws the frames that are not there yet.
fn draw(
    args: &WalkArgs,
    stage: &Stage,
    (cameras, fov): (&[Camera], f64),
    guide: &mut Guide,
    folder: &Folder,
    counter: &Progress,
) -> Result<Done> {
    let tracer = Tracer::new(&stage.world);
    // Counts need an order of the cells; only the preview cannot do without.
    let painter = match args.renderer {
        Renderer::Preview => Some(painter(stage)?),
        Renderer::Trace => painter(stage).ok(),
    };
    let exposure = match args.renderer {
        Renderer::Trace => steady(args, stage, (cameras, fov), guide, &tracer)?,
        Renderer::Preview => Exposure::Stops(0.0),
    };
    let base = key(args, stage, fov, exposure)?;
    let mut easel = Easel::default();
    counter.begin(cameras.len());
    let (mut list, mut kept) = (Vec::with_capacity(cameras.len()), 0);
    for (camera, number) in cameras.iter().zip(0u32..) {
        let seconds = args.from + f64::from(number) / args.fps;
        let mut own = base.clone();
        let direction = camera.direction();
        for x in [camera.eye, direction].iter().flat_map(|v| v.to_array()) {
            own.update(&x.to_le_bytes());
        }
        let key = own.finalize().to_hex();
        if let Some(old) = folder.kept(number, &key) {
            list.push(Frame {
                frame: number,
                seconds,
                ..old.figures
            });
            kept += 1;
        } else {
            let (figures, pixels) = frame(
                (args, stage),
                (camera, number, seconds),
                guide,
                (&tracer, painter.as_ref(), exposure),
                &mut easel,
            )?;
            folder.write(&key, &figures, &pixels)?;
            list.push(figures);
        }
        counter.advance(1);
    }
    Ok(Done {
        removed: folder.shorten(cameras.len() as u32)?,
        frames: list,
        kept,
    })
}

/// Draws one frame.
fn frame(
    (args, stage): (&WalkArgs, &Stage),
    (camera, number, seconds): (&Camera, u32, f64),
    guide: &mut Guide,
    (tracer, painter, exposure): (&Tracer, Option<&Painter>, Exposure),
    easel: &mut Easel,
) -> Result<(Frame, Vec<u8>)> {
    let start = Instant::now();
    let step = guide.step(camera)?.clone();
    let visibility = start.elapsed().as_secs_f64() * 1e3;
    let polygons = match painter {
        Some(painter) => Counts::of(painter, camera, easel)?,
        None => Counts::default(),
    };
    let start = Instant::now();
    let (pixels, rays, painted, effects) = match (args.renderer, painter) {
        (Renderer::Preview, Some(painter)) => {
            let options = preview::Options {
                objects: true,
                ..preview::Options::default()
            };
            let drawn = stage
                .pool
                .install(|| painter.draw(camera, &options, easel))?;
            (easel.canvas.srgb(), 0, drawn.pixels, Effects::NONE)
        }
        _ => {
            let options = args.trace.options(&step.survey, exposure);
            let drawn = stage
                .pool
                .install(|| render(tracer, camera, step.cell, &options, &Progress::default()));
            let rays = &drawn.work.rays;
            let rays = rays.primary + rays.shadow + rays.reflected + rays.refracted;
            (drawn.picture.srgb(exposure), rays, 0, options.effects)
        }
    };
    let drawing = start.elapsed().as_secs_f64() * 1e3;
    let figures = Frame {
        frame: number,
        seconds,
        eye: camera.eye.to_array(),
        direction: camera.direction().to_array(),
        cell: step.cell.0,
        sector: stage.graph.cell(step.cell).sector.map(|s| s.0),
        cells_pvs: step.seen as u64,
        polygons,
        rays,
        pixels: painted,
        effects: effects.to_string(),
        same_cell: step.same,
        milliseconds_visibility: visibility,
        milliseconds_draw: drawing,
    };
    Ok((figures, pixels))
}

/// One exposure for all frames, so that they do not flicker: the middle one of what some frames along
/// the walk ask for.
fn steady(
    args: &WalkArgs,
    stage: &Stage,
    (cameras, fov): (&[Camera], f64),
    guide: &Guide,
    tracer: &Tracer,
) -> Result<Exposure> {
    const PLACES: usize = 9;
    const SMALL: [u32; 2] = [48, 30];
    let asked = args.trace.exposure(&stage.world);
    if asked != Exposure::Auto {
        return Ok(asked);
    }
    let n = PLACES.min(cameras.len());
    let mut stops = Vec::new();
    for k in 0..n {
        let camera = &cameras[(2 * k + 1) * cameras.len() / (2 * n)];
        let small = Camera::new(camera.eye, camera.direction(), fov, SMALL);
        let cell = guide.cell(&small)?;
        let survey = crate::trace::effects::survey(&stage.world, &stage.pvs, cell);
        let mut options = args.trace.options(&survey, asked);
        (options.samples, options.adaptive) = (1, None);
        let drawn = stage
            .pool
            .install(|| render(tracer, &small, cell, &options, &Progress::default()));
        stops.push(drawn.picture.factor(asked).log2());
    }
    stops.sort_by(f64::total_cmp);
    Ok(Exposure::Stops(stops[stops.len() / 2]))
}

/// A checksum of all that frames depend on, but for the pose.
fn key(args: &WalkArgs, stage: &Stage, fov: f64, exposure: Exposure) -> Result<blake3::Hasher> {
    let mut key = blake3::Hasher::new();
    let mut add = |bytes: &[u8]| {
        key.update(&(bytes.len() as u64).to_le_bytes());
        key.update(bytes);
    };
    add(env!("CARGO_PKG_VERSION").as_bytes());
    let mut named = vec![args.level.level.clone()];
    named.extend(files::named(&args.level.level, &stage.level));
    for file in named {
        add(&fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?);
    }
    // Whether frames are equal does not depend on which effects a cell's survey names: what it leaves
    // out cannot be seen.
    let effects = match args.trace.effects {
        Asked::Auto => "auto".to_string(),
        Asked::Set(effects) => effects.to_string(),
    };
    let level: Option<&str> = args.level.map.as_deref();
    let stage = &args.stage;
    let cells = stage
        .bsp
        .options(stage.subdivision.into(), stage.doors.into());
    let rest = match args.renderer {
        Renderer::Preview => format!("{level:?} {cells:?} {:?} {fov} preview", args.size),
        Renderer::Trace => {
            let options = args.trace.fixed(exposure);
            let ambient = args.trace.ambient;
            format!(
                "{level:?} {cells:?} {:?} {fov} {options:?} {exposure:?} {ambient} {effects}",
                args.size
            )
        }
    };
    add(rest.as_bytes());
    Ok(key)
}

/// Writes the figures and the page.
fn write_papers(papers: [Option<&Path>; 2], walk: &walkthrough::Walk) -> Result<()> {
    let mut files = Vec::new();
    if let Some(path) = papers[0] {
        let mut file = Output::create(path)?;
        let csv = path
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
        file.write(|out| {
            if csv {
                return out.write_all(figures::csv(walk.frames).as_bytes());
            }
            serde_json::to_writer_pretty(&mut *out, &walkthrough::json(walk))?;
            writeln!(out)
        })?;
        files.push(file);
    }
    if let Some(path) = papers[1] {
        let mut file = Output::create(path)?;
        file.write(|out| out.write_all(walkthrough::page(walk).as_bytes()))?;
        files.push(file);
    }
    output::commit(files)
}
