//! `enfilade plan`: a picture of the plan, or of what one cell or one eye sees.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use glam::DVec2;

use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg};
use super::output::{self, Output};
use super::{Answer, picture, progress};
use crate::cells::{CellGraph, CellId, Locator, subdivide};
use crate::level::Level;
use crate::pvs::eye::{Cone, Lookout, Scratch};
use crate::pvs::{Progress, Pvs, sweep};
use crate::report::check;
use crate::report::plan::{EyeView, View, draw, draw_eye, draw_findings};
use crate::report::sightlines;

/// Sample sightlines in a picture with a source.
const SIGHTLINES: usize = 40;

/// Where an eye looks unless something else is asked for: up on the plan.
const DIRECTION: f64 = 90.0;
/// Its angle of view.
const FOV: f64 = 60.0;

/// Draw the plan of a level: its cells by sector, what the cell around a point sees, or what an eye
/// sees.
#[derive(Debug, Args)]
pub struct PlanArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// Picture to write: .svg or .png (`-`: SVG to standard output)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Show what the cell around this point sees (in the level's unit)
    #[arg(long, value_name = "X,Y", value_parser = super::level_args::point)]
    #[arg(allow_hyphen_values = true, conflicts_with = "cell")]
    from: Option<DVec2>,
    /// Show what the cell with this number sees
    #[arg(long, value_name = "N")]
    cell: Option<u32>,
    /// Show what an eye at this point sees: exactly, and clipped to its angle of view
    #[arg(long, value_name = "X,Y", value_parser = super::level_args::point)]
    #[arg(allow_hyphen_values = true, conflicts_with_all = ["from", "cell"])]
    eye: Option<DVec2>,
    /// Show what this camera of the level sees
    #[arg(long, value_name = "NAME", conflicts_with_all = ["from", "cell", "eye"])]
    camera: Option<String>,
    /// Where the eye looks, in degrees counterclockwise from east [default: 90]
    #[arg(
        long,
        value_name = "DEGREES",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    direction: Option<f64>,
    /// Mark what was repaired or looks wrong, as `check` lists it
    #[arg(long, conflicts_with_all = ["from", "cell", "eye", "camera"])]
    findings: bool,
    /// Angle of view in degrees, up to 360 [default: 60, or the camera's]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    #[arg(conflicts_with_all = ["from", "cell"])]
    fov: Option<f64>,
    /// Width of the picture in pixels
    #[arg(long, value_name = "PX", default_value_t = 1200)]
    #[arg(value_parser = clap::value_parser!(u32).range(100..=12_000))]
    width: u32,
    /// How the plan is cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: SubdivisionArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    doors: DoorsArg,
    #[command(flatten)]
    bsp: BspArgs,
}

/// Runs `enfilade plan`.
pub fn run(args: &PlanArgs) -> Result<Answer> {
    let as_png = picture::is_png(&args.output)?;
    let level = args.level.read()?;
    let looking = looking(args, &level)?;
    let options = args.bsp.options(args.subdivision.into(), args.doors.into());
    let graph = subdivide(&level, &options);
    let mut output = Output::create(&args.output)?;
    let svg = if let Some(looking) = looking {
        draw_looking(args, &level, &graph, &looking)?
    } else {
        match source(args, &level, &graph)? {
            None if args.findings => {
                let mut found = level.findings.clone();
                found.extend(graph.findings.iter().cloned());
                found.extend(check::of_cells(&level, &graph));
                draw_findings(&level, &graph, &found, args.width)
            }
            None => draw(&level, &graph, None, args.width),
            Some(source) => {
                let pvs = visible(&graph);
                let lines = sightlines::sample(&graph, &pvs, source, SIGHTLINES);
                let view = View {
                    source,
                    pvs: &pvs,
                    lines,
                };
                draw(&level, &graph, Some(&view), args.width)
            }
        }
    };
    let png = as_png.then_some(args.width);
    picture::write(&mut output, &svg.to_string(), png, false)?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

/// Refuses the number of a cell that there is not.
pub fn must_exist(graph: &CellGraph, cell: u32) -> Result<()> {
    let n = graph.cells.len();
    if cell as usize >= n {
        bail!("there is no cell {cell}; this subdivision has {n} cells, numbered from 0");
    }
    Ok(())
}

fn visible(graph: &CellGraph) -> Pvs {
    let counter = Progress::default();
    progress::show("finding what is visible", false, &counter, || {
        sweep::sweep(graph, &counter)
    })
}

/// An eye and where it looks.
struct Looking {
    at: DVec2,
    /// In degrees.
    direction: f64,
    fov: f64,
    cone: Cone,
}

/// The eye that was asked for, if any.
fn looking(args: &PlanArgs, level: &Level) -> Result<Option<Looking>> {
    let (at, direction, fov) = match (args.eye, &args.camera) {
        (Some(eye), _) => (eye, args.direction.unwrap_or(DIRECTION), FOV),
        (None, Some(name)) => camera(level, name)?,
        (None, None) if args.fov.is_some() => {
            bail!("--fov is an eye's angle of view; give --eye X,Y or --camera NAME with it")
        }
        (None, None) => return Ok(None),
    };
    let fov = args.fov.unwrap_or(fov);
    Ok(Some(Looking {
        at,
        direction,
        fov,
        cone: Cone::new(direction, fov)?,
    }))
}

/// Place, direction and angle of view of one of the level's cameras, on the plan.
fn camera(level: &Level, name: &str) -> Result<(DVec2, f64, f64)> {
    let cameras = &level.scene.cameras;
    let Some(camera) = cameras.iter().find(|c| c.name == name) else {
        let names: Vec<&str> = cameras.iter().map(|c| c.name.as_str()).collect();
        match names.is_empty() {
            true => bail!("{} has no cameras; give --eye X,Y instead", level.name),
            false => bail!(
                "there is no camera `{name}`; there are: {}",
                names.join(", ")
            ),
        }
    };
    let ahead = camera.direction.truncate();
    if ahead == DVec2::ZERO {
        bail!("the camera `{name}` looks straight up or down, which the plan does not show");
    }
    let direction = ahead.to_angle().to_degrees();
    Ok((camera.eye.truncate(), direction, camera.fov))
}

fn draw_looking(
    args: &PlanArgs,
    level: &Level,
    graph: &CellGraph,
    looking: &Looking,
) -> Result<svg::Document> {
    let Looking {
        at,
        direction,
        fov,
        cone,
    } = looking;
    let lookout = Lookout::new(graph);
    let mut scratch = Scratch::default();
    let eye = graph.grid.fine(*at);
    let Some(vista) = eye.and_then(|eye| lookout.look(&eye, cone, &mut scratch).ok()) else {
        bail!(
            "the eye at {},{} lies outside {}; `enfilade plan` without an eye shows where its \
             inside is",
            at.x,
            at.y,
            level.name
        );
    };
    let view = EyeView {
        vista: &vista,
        pvs: &visible(graph),
        direction: *direction,
        fov: *fov,
    };
    Ok(draw_eye(level, graph, &view, args.width))
}

/// The cell that was asked for, if any.
fn source(args: &PlanArgs, level: &Level, graph: &CellGraph) -> Result<Option<CellId>> {
    if let Some(cell) = args.cell {
        must_exist(graph, cell)?;
        return Ok(Some(CellId(cell)));
    }
    let Some(point) = args.from else {
        return Ok(None);
    };
    let on_grid = graph.grid.nearest(point);
    let cell = on_grid.and_then(|p| Locator::new(graph).cell_at(graph, p));
    if cell.is_none() {
        bail!(
            "the point {},{} lies outside {}; `enfilade plan` without --from shows where its \
             inside is",
            point.x,
            point.y,
            level.name
        );
    }
    Ok(cell)
}
