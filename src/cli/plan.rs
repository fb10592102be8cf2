//! `enfilade plan`: a picture of the plan, or of what one cell sees.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use glam::DVec2;

use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg};
use super::output::{self, Output};
use super::{Answer, picture, progress};
use crate::cells::{CellGraph, CellId, Locator, subdivide};
use crate::level::Level;
use crate::pvs::{Progress, sweep};
use crate::report::plan::{View, draw};
use crate::report::sightlines;

/// Sample sightlines in a picture with a source.
const SIGHTLINES: usize = 40;

/// Draw the plan of a level: its cells by sector, or what is visible from a point.
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
    let options = args.bsp.options(args.subdivision.into(), args.doors.into());
    let graph = subdivide(&level, &options);
    let source = source(args, &level, &graph)?;
    let mut output = Output::create(&args.output)?;
    let svg = match source {
        None => draw(&level, &graph, None, args.width),
        Some(source) => {
            let counter = Progress::default();
            let pvs = progress::show("finding what is visible", false, &counter, || {
                sweep::sweep(&graph, &counter)
            });
            let lines = sightlines::sample(&graph, &pvs, source, SIGHTLINES);
            let view = View {
                source,
                pvs: &pvs,
                lines,
            };
            draw(&level, &graph, Some(&view), args.width)
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
