//! `enfilade export`: a level's cells and visibility in the formats of other programs.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::{Args, Subcommand};

use super::compute::{self, Built, Job};
use super::level_args::{DoorsArg, LevelArgs, SubdivisionArg, open, warn_of};
use super::output::{self, Output};
use super::{Answer, complain, progress};
use crate::cells::{CellGraph, Options, Subdivision, subdivide};
use crate::level::scene::{Object, Shape};
use crate::level::{Level, toml};
use crate::pvs::sample::SampleOptions;
use crate::pvs::{Method, Progress, Pvs, sectors, sweep};
use crate::report::json;
use crate::report::prt;
use crate::report::wording::{count, count_of};

/// Write cells, portals or visible sets in another program's format.
#[derive(Debug, Args)]
pub struct ExportArgs {
    #[command(subcommand)]
    format: Format,
}

#[derive(Debug, Subcommand)]
enum Format {
    Reject(RejectArgs),
    Prt(PrtArgs),
    Json(JsonArgs),
    Toml(TomlArgs),
}

/// Copy a WAD, with exact REJECT lumps: which sectors never see each other.
///
/// Sight is decided in the plan with all doors open, so moving sectors and heights never make the
/// table too strict.
#[derive(Debug, Args)]
struct RejectArgs {
    /// The WAD
    wad: PathBuf,
    /// A map to do; may be given several times
    #[arg(long, value_name = "NAME")]
    map: Vec<String>,
    /// Do every map of the WAD
    #[arg(long, conflicts_with = "map")]
    all: bool,
    /// The new WAD (`-`: standard output)
    #[arg(long, short, value_name = "OUT.wad")]
    output: PathBuf,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Write the portals as a PRT1 file of the Quake tools; leaves are the cells.
#[derive(Debug, Args)]
struct PrtArgs {
    #[command(flatten)]
    level: LevelArgs,
    #[command(flatten)]
    cells: CellArgs,
    /// The new file (`-`: standard output)
    #[arg(long, short, value_name = "FILE.prt")]
    output: PathBuf,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Write cells, portals and visible sets as JSON, as `build --json` does.
#[derive(Debug, Args)]
struct JsonArgs {
    #[command(flatten)]
    level: LevelArgs,
    #[command(flatten)]
    cells: CellArgs,
    /// The new file (`-`: standard output)
    #[arg(long, short, value_name = "FILE.json")]
    output: PathBuf,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

/// Write the level in the own format: of a Doom map, its sectors and lines.
///
/// The new file reads as the same level, with the same cells and visible sets. What the format has
/// no words for (a Doom map's textures) is left out, and named.
#[derive(Debug, Args)]
struct TomlArgs {
    #[command(flatten)]
    level: LevelArgs,
    /// The new file (`-`: standard output)
    #[arg(long, short, value_name = "FILE.toml")]
    output: PathBuf,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Debug, Args)]
struct CellArgs {
    /// How the plan is cut into cells
    #[arg(long, value_enum, value_name = "HOW", default_value = "bsp")]
    subdivision: SubdivisionArg,
    /// Whether doors that stand closed count as walls
    #[arg(long, value_enum, value_name = "STATE", default_value = "open")]
    doors: DoorsArg,
}

impl CellArgs {
    fn options(&self) -> Options {
        let (subdivision, doors) = (self.subdivision.into(), self.doors.into());
        Options {
            subdivision,
            doors,
            ..Options::default()
        }
    }
}

/// Runs `enfilade export`.
pub fn run(args: &ExportArgs) -> Result<Answer> {
    match &args.format {
        Format::Reject(args) => reject(args),
        Format::Prt(args) => portals(args),
        Format::Json(args) => as_json(args),
        Format::Toml(args) => as_toml(args),
    }
}

fn reject(args: &RejectArgs) -> Result<Answer> {
    let source = open(&args.wad)?;
    let name = args.wad.display();
    let Some(wad) = source.wad() else {
        bail!("{name}: REJECT lumps belong to Doom maps, and this is no WAD");
    };
    let there = source.maps();
    let maps: Vec<String> = match there.as_slice() {
        [] => bail!("{name}: the WAD has no maps; take one that has, such as a game's IWAD"),
        [_] if args.map.is_empty() => there,
        _ if args.all => there,
        _ if args.map.is_empty() => {
            bail!(
                "{name}: name a map with --map, or take --all; the maps are: {}",
                there.join(", ")
            )
        }
        _ => args.map.clone(),
    };
    let mut output = Output::create(&args.output)?;
    let mut lumps: Vec<(String, Vec<u8>)> = Vec::new();
    for map in maps {
        if lumps
            .iter()
            .any(|(done, _)| done.eq_ignore_ascii_case(&map))
        {
            continue;
        }
        let level = source.level(Some(&map))?;
        let n = level.sectors.len();
        // Triangles cost least: fewer corners in all than the other subdivisions have.
        let options = Options {
            subdivision: Subdivision::Cdt,
            ..Options::default()
        };
        let graph = subdivide(&level, &options);
        let pvs = visibility(&graph, &map, args.quiet);
        let sees = sectors::sectors(n, &graph, &pvs);
        let hidden = (n * n) as u64 - sees.total();
        if !args.quiet {
            let share = 100.0 * hidden as f64 / ((n * n).max(1)) as f64;
            let sectors = count(n, "sector");
            complain(&format!(
                "{map}: {sectors}, {share:.1} % of all pairs rejected"
            ));
        }
        lumps.push((map, sectors::reject(&sees)));
    }
    let copy = wad
        .with_rejects(&lumps)
        .map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    output.write(|out| out.write_all(&copy))?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

fn portals(args: &PrtArgs) -> Result<Answer> {
    let (level, graph) = cells(&args.level, &args.cells, args.quiet)?;
    let mut output = Output::create(&args.output)?;
    let mut written = 0;
    output.write(|out| {
        written = prt::write(out, &graph)?;
        Ok(())
    })?;
    output::commit([output])?;
    if !args.quiet {
        let (leaves, portals) = (
            count_of(graph.cells.len(), "leaf", "leaves"),
            count(written, "portal"),
        );
        let closed = graph.portals.len() - written;
        complain(&format!(
            "{}: {leaves}, {portals}, {closed} more that never open",
            level.name
        ));
    }
    Ok(Answer::Yes)
}

fn as_json(args: &JsonArgs) -> Result<Answer> {
    let job = Job {
        level: &args.level,
        cells: args.cells.options(),
        method: Method::Sweep,
        heights: None,
        sample: SampleOptions::default(),
        max_steps: None,
        time_limit: None,
        threads: None,
        quiet: args.quiet,
    };
    let mut output = Output::create(&args.output)?;
    let Some(built) = compute::build(&job)? else {
        bail!("the sweep has no limit to give up at");
    };
    let Built {
        level,
        graph,
        pvs,
        seconds,
    } = &built;
    output.write(|out| json::write(out, level, graph, pvs, seconds))?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

fn as_toml(args: &TomlArgs) -> Result<Answer> {
    let level = args.level.read()?;
    let written = toml::write::write(&level)
        .map_err(|error| anyhow::anyhow!("{}: {error}", args.level.level.display()))?;
    let mut output = Output::create(&args.output)?;
    output.write(|out| out.write_all(written.text.as_bytes()))?;
    output::commit([output])?;
    if !args.quiet {
        warn_of(&level.findings);
        let (walls, sectors) = (
            count(level.walls.len(), "wall"),
            count(level.sectors.len(), "sector"),
        );
        complain(&format!("{}: {walls}, {sectors}", level.name));
        for what in &written.left_out {
            complain(&format!("{}: left out: {what}", level.name));
        }
        if names_files(&level) && !output::is_stdout(&args.output) {
            let folder = |path: &Path| path.parent().unwrap_or(Path::new("")).to_path_buf();
            if folder(&args.output) != folder(&args.level.level) {
                complain(&format!(
                    "{}: its pictures and meshes are looked for beside the new file; copy them there",
                    level.name
                ));
            }
        }
    }
    Ok(Answer::Yes)
}

/// Whether a level needs files beside its own.
fn names_files(level: &Level) -> bool {
    let scene = &level.scene;
    let mesh = |o: &Object| matches!(o.shape, Shape::Mesh { .. });
    scene.objects.iter().any(mesh) || scene.materials.iter().any(|m| m.texture.is_some())
}

fn cells(level: &LevelArgs, cells: &CellArgs, quiet: bool) -> Result<(Level, CellGraph)> {
    let level = level.read()?;
    let graph = subdivide(&level, &cells.options());
    if !quiet {
        warn_of(&level.findings);
        warn_of(&graph.findings);
    }
    Ok((level, graph))
}

fn visibility(graph: &CellGraph, label: &str, quiet: bool) -> Pvs {
    let counter = Progress::default();
    progress::show(label, quiet, &counter, || sweep::sweep(graph, &counter))
}
