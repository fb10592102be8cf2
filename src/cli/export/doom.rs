//! The tables of Doom maps: REJECT, and GL_PVS for WADs that hold GL nodes.

use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, bail};
use clap::Args;

use super::super::level_args::open;
use super::super::output::{self, Output};
use super::super::{Answer, complain, progress};
use crate::cells::{CellGraph, Options, Subdivision, subdivide};
use crate::level::doom::gl;
use crate::level::read::Source;
use crate::level::wad::Wad;
use crate::pvs::subsectors::{Subsectors, gl_pvs as lump_of};
use crate::pvs::{BitMatrix, Progress, Pvs, sectors, sweep};
use crate::report::wording::count;

/// Copy a WAD, with exact REJECT lumps: which sectors never see each other.
///
/// Sight is decided in the plan with all doors open, so moving sectors and heights never make the
/// table too strict.
#[derive(Debug, Args)]
pub struct RejectArgs {
    #[command(flatten)]
    maps: MapsArgs,
    /// The new WAD (`-`: standard output); or, ending in .rej or .lmp, the lump of one map alone
    #[arg(long, short, value_name = "OUT.wad|OUT.rej")]
    output: PathBuf,
    /// Write a PWAD of these maps alone, to be played with the game: `-file OUT.wad`
    #[arg(long)]
    alone: bool,
}

/// Copy a WAD that holds GL nodes, with exact GL_PVS lumps: which subsectors see each other.
///
/// GL nodes of version 2 and 5 are read, as glbsp and zdbsp make them. Sight is decided in the plan
/// with all doors open, between the very subsectors of these nodes.
#[derive(Debug, Args)]
pub struct GlPvsArgs {
    #[command(flatten)]
    maps: MapsArgs,
    /// The file that holds the GL nodes, if the WAD does not: the .gwa beside it. That is then copied
    #[arg(long, value_name = "FILE.gwa")]
    gl: Option<PathBuf>,
    /// The new WAD (`-`: standard output); or, ending in .lmp, the lump of one map alone
    #[arg(long, short, value_name = "OUT.wad|OUT.lmp")]
    output: PathBuf,
}

#[derive(Debug, Args)]
struct MapsArgs {
    /// The WAD
    wad: PathBuf,
    /// A map to do; may be given several times
    #[arg(long, value_name = "NAME")]
    map: Vec<String>,
    /// Do every map of the WAD
    #[arg(long, conflicts_with = "map")]
    all: bool,
    /// Print errors only
    #[arg(long, short)]
    quiet: bool,
}

impl MapsArgs {
    /// The maps to do, each once, in capitals as in the WAD.
    fn names(&self, source: &Source, what: &str) -> Result<Vec<String>> {
        let name = self.wad.display();
        let Some(wad) = source.wad() else {
            bail!("{name}: {what} lumps belong to Doom maps, and this is no WAD");
        };
        let there = source.maps();
        let mut maps: Vec<String> = Vec::new();
        match there.as_slice() {
            [] => bail!("{name}: the WAD has no maps; take one that has, such as a game's IWAD"),
            [_] if self.map.is_empty() => return Ok(there),
            _ if self.all => return Ok(there),
            _ if self.map.is_empty() => {
                bail!(
                    "{name}: name a map with --map, or take --all; the maps are: {}",
                    there.join(", ")
                )
            }
            _ => {}
        }
        for map in &self.map {
            let map = wad.map(map).map_err(|error| anyhow!("{name}: {error}"))?;
            if !maps.contains(&map.name) {
                maps.push(map.name);
            }
        }
        Ok(maps)
    }
}

/// Whether a lump alone is asked for; of one map only.
fn is_lump(output: &Path, endings: &[&str], maps: &[String]) -> Result<bool> {
    let ending = output.extension().unwrap_or_default();
    let lump = endings.iter().any(|e| ending.eq_ignore_ascii_case(e));
    if lump && maps.len() != 1 {
        bail!(
            "{}: a lump alone is that of one map; name one with --map, or write a .wad",
            output.display()
        );
    }
    Ok(lump)
}

/// Runs `export reject`.
pub fn reject(args: &RejectArgs) -> Result<Answer> {
    let source = open(&args.maps.wad)?;
    let maps = args.maps.names(&source, "REJECT")?;
    let lump_alone = is_lump(&args.output, &["rej", "lmp"], &maps)?;
    let mut output = Output::create(&args.output)?;
    let mut lumps: Vec<(String, Vec<u8>)> = Vec::new();
    for map in maps {
        let level = source.level(Some(&map))?;
        let n = level.sectors.len();
        // Triangles cost least: fewer corners in all than the other subdivisions have.
        let options = Options {
            subdivision: Subdivision::Cdt,
            ..Options::default()
        };
        let graph = subdivide(&level, &options);
        let pvs = visibility(&graph, &map, args.maps.quiet);
        let sees = sectors::sectors(n, &graph, &pvs);
        if !args.maps.quiet {
            let sectors = count(n, "sector");
            let hidden = 100.0 - share(&sees);
            complain(&format!(
                "{map}: {sectors}, {hidden:.1} % of all pairs rejected"
            ));
        }
        lumps.push((map, sectors::reject(&sees)));
    }
    let bytes = match (lump_alone, source.wad()) {
        (false, Some(wad)) => with_rejects(wad, &lumps, args)?,
        _ => lumps.pop().map(|(_, bytes)| bytes).unwrap_or_default(),
    };
    output.write(|out| out.write_all(&bytes))?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

fn with_rejects(wad: &Wad, lumps: &[(String, Vec<u8>)], args: &RejectArgs) -> Result<Vec<u8>> {
    let names: Vec<String> = lumps.iter().map(|(map, _)| map.clone()).collect();
    let copy = if args.alone {
        wad.with_maps_only(&names)
            .and_then(Wad::parse)
            .and_then(|alone| alone.with_rejects(lumps))
    } else {
        wad.with_rejects(lumps)
    };
    copy.map_err(|error| anyhow!("{}: {error}", args.maps.wad.display()))
}

/// Runs `export gl-pvs`.
pub fn gl_pvs(args: &GlPvsArgs) -> Result<Answer> {
    let source = open(&args.maps.wad)?;
    let maps = args.maps.names(&source, "GL_PVS")?;
    let lump_alone = is_lump(&args.output, &["lmp"], &maps)?;
    let beside = match &args.gl {
        Some(path) => Some(open_wad(path)?),
        None => None,
    };
    let holder = args.gl.as_deref().unwrap_or(&args.maps.wad).display();
    let wad = source.wad().expect("a file with maps is a WAD");
    let with_nodes = beside.as_ref().unwrap_or(wad);
    let mut output = Output::create(&args.output)?;
    let (mut edits, mut lump) = (Vec::new(), Vec::new());
    for map in maps {
        let wrong = |error: &dyn std::fmt::Display| anyhow!("{holder}: {error}");
        let lumps = wad.map(&map).map_err(|error| wrong(&error))?;
        let nodes = gl::read(wad, with_nodes, &lumps).map_err(|error| wrong(&error))?;
        let level = source.level(Some(&map))?;
        let subsectors = Subsectors::new(&level, &nodes, &Options::default())
            .map_err(|error| anyhow!("{holder}: map {map}: {error}"))?;
        let pvs = visibility(&subsectors.graph, &map, args.maps.quiet);
        let sees = subsectors.relation(&pvs);
        if !args.maps.quiet {
            let n = count(subsectors.n, "subsector");
            let seen = share(&sees);
            complain(&format!(
                "{map}: {n} of GL nodes of version {}, {seen:.1} % of all pairs see each other",
                nodes.version
            ));
            if subsectors.n_shared() > 0 {
                let shared = count(subsectors.n_shared(), "part");
                complain(&format!(
                    "{map}: {shared} of subsectors, cut off by the node builder's rounding, count \
                     for their neighbours, too"
                ));
            }
        }
        lump = lump_of(&sees);
        let edit = gl::pvs_edit(with_nodes, &map, lump.clone()).map_err(|error| wrong(&error))?;
        edits.push(edit);
    }
    let bytes = if lump_alone {
        lump
    } else {
        let copy = with_nodes.with_edits(&edits);
        copy.map_err(|error| anyhow!("{holder}: {error}"))?
    };
    output.write(|out| out.write_all(&bytes))?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

fn open_wad(path: &Path) -> Result<Wad> {
    // A .gwa is a WAD, which the ending does not tell but its first bytes do.
    let source = open(path)?;
    match source.wad() {
        Some(wad) => Ok(wad.clone()),
        None => bail!("{}: GL nodes are in WADs, and this is none", path.display()),
    }
}

/// Per cent of all pairs that see each other.
fn share(sees: &BitMatrix) -> f64 {
    100.0 * sees.total() as f64 / (sees.n() * sees.n()).max(1) as f64
}

fn visibility(graph: &CellGraph, label: &str, quiet: bool) -> Pvs {
    let counter = Progress::default();
    progress::show(label, quiet, &counter, || sweep::sweep(graph, &counter))
}
