//! `enfilade explain`: why two places see each other, or why not.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use glam::DVec2;

use super::level_args::{BspArgs, DoorsArg, LevelArgs, SubdivisionArg, warn_of};
use super::output::{self, Output};
use super::{Answer, complain, picture, plan, progress};
use crate::cells::{CellGraph, CellId, Doors, Locator, subdivide};
use crate::geom::GridPoint;
use crate::level::Level;
use crate::pvs::explain::ExplainOptions;
use crate::pvs::heights::HeightsOptions;
use crate::pvs::{Progress, sweep};
use crate::report::explain::{self, Account, Asked, asked, text};
use crate::report::plan::draw_explained;

/// Tell why two places see each other, or why not.
///
/// Each place is a point or a cell. Prints whether any straight line from inside the one's cell to
/// inside the other's is free, with a sightline, the portals that it passes and the wall ends that
/// bound the view; or the shortest way, where sight ends on it, and what blocks it. With --quiet it
/// prints nothing, and the exit status is 1 if they do not see each other.
#[derive(Debug, Args)]
pub struct ExplainArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// The first place: a point (in the level's unit)
    #[arg(long, value_name = "X,Y", value_parser = super::level_args::point)]
    #[arg(allow_hyphen_values = true, required_unless_present = "from_cell")]
    #[arg(conflicts_with = "from_cell")]
    from: Option<DVec2>,
    /// The first place: the cell with this number
    #[arg(long, value_name = "N")]
    from_cell: Option<u32>,
    /// The second place: a point
    #[arg(long, value_name = "X,Y", value_parser = super::level_args::point)]
    #[arg(allow_hyphen_values = true, required_unless_present = "to_cell")]
    #[arg(conflicts_with = "to_cell")]
    to: Option<DVec2>,
    /// The second place: the cell with this number
    #[arg(long, value_name = "N")]
    to_cell: Option<u32>,
    /// Picture to write: .svg or .png
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the explanation as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
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
    /// Count floors and ceilings: sight in space, not only on the plan
    #[arg(long)]
    heights: bool,
    /// With --heights: into how many parts the lines through one chain of portals may be split
    /// before it is left undecided
    #[arg(long, value_name = "N", requires = "heights")]
    splits: Option<u32>,
    /// End the search for the widest view after this many steps (portals tried)
    #[arg(long, value_name = "N", default_value_t = ExplainOptions::default().max_steps)]
    max_steps: u64,
    /// Print errors only; the exit status is the answer
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    bsp: BspArgs,
}

/// Runs `enfilade explain`.
pub fn run(args: &ExplainArgs) -> Result<Answer> {
    let as_png = args.output.as_deref().map(picture::is_png).transpose()?;
    output::must_differ(args.output.as_deref(), args.json.as_deref())?;
    let level = args.level.read()?;
    let options = args.bsp.options(args.subdivision.into(), args.doors.into());
    let graph = subdivide(&level, &options);
    if !args.quiet {
        warn_of(&level.findings);
        warn_of(&graph.findings);
    }
    let locator = Locator::new(&graph);
    let from = place(&level, &graph, &locator, args.from, args.from_cell)?;
    let to = place(&level, &graph, &locator, args.to, args.to_cell)?;
    let mut drawing = args.output.as_deref().map(Output::create).transpose()?;
    let mut json = args.json.as_deref().map(Output::create).transpose()?;

    let counter = Progress::default();
    let pvs = progress::show("finding what is visible", args.quiet, &counter, || {
        sweep::sweep(&graph, &counter)
    });
    let depth = ExplainOptions {
        max_steps: args.max_steps,
        points: None,
        heights: args.heights.then(|| HeightsOptions {
            splits: args.splits.unwrap_or(HeightsOptions::default().splits),
        }),
    };
    let places = asked::choose(&pvs, &from.cells, &to.cells).map(|[a, b]| {
        [
            Asked::new(a, from.point, &from.cells),
            Asked::new(b, to.point, &to.cells),
        ]
    });
    let explained = places.and_then(|p| explain::explain(&graph, &pvs, p, &depth));
    let Some(explained) = explained else {
        bail!("no explanation was found; please report this level");
    };
    let mut account = Account::of(&level, &graph, &explained);
    if !account.visible && graph.options.doors == Doors::Closed {
        account.doors_open = explain::with_open_doors(&level, &graph, explained.asked, &depth);
    }

    if let (Some(drawing), Some(as_png)) = (&mut drawing, as_png) {
        let svg = draw_explained(&level, &graph, &explained, args.width).to_string();
        picture::write(drawing, &svg, as_png.then_some(args.width), args.quiet)?;
    }
    if let Some(json) = &mut json {
        json.write(|out| {
            serde_json::to_writer_pretty(&mut *out, &account)?;
            writeln!(out)
        })?;
    }
    output::commit(drawing.into_iter().chain(json))?;
    if args.quiet {
        return Ok(if account.visible {
            Answer::Yes
        } else {
            Answer::No
        });
    }
    let words = text::of(&level, &account);
    let paths = [args.output.as_deref(), args.json.as_deref()];
    if paths.into_iter().flatten().any(output::is_stdout) {
        complain(words.trim_end());
    } else {
        output::print(&words)?;
    }
    Ok(Answer::Yes)
}

/// A place as it was given: a cell, or a point with the cells that it may stand for.
struct Given {
    point: Option<GridPoint>,
    cells: Vec<CellId>,
}

fn place(
    level: &Level,
    graph: &CellGraph,
    locator: &Locator,
    point: Option<DVec2>,
    cell: Option<u32>,
) -> Result<Given> {
    if let Some(cell) = cell {
        plan::must_exist(graph, cell)?;
        return Ok(Given {
            point: None,
            cells: vec![CellId(cell)],
        });
    }
    let Some(given) = point else {
        bail!("a point or a cell is needed");
    };
    let Some(point) = graph.grid.nearest(given) else {
        bail!(
            "the point {},{} lies outside {}",
            given.x,
            given.y,
            level.name
        );
    };
    let cells = asked::cells_at(level, graph, locator, point)?;
    Ok(Given {
        point: Some(point),
        cells,
    })
}
