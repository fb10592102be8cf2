//! Arguments that most commands share: the level, and how it is cut into cells.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};

use super::complain;
use crate::cells::{self, Doors, Subdivision};
use crate::level::drawing::DrawingOptions;
use crate::level::drawing::role::LayerRule;
use crate::level::drawing::unit::Unit;
use crate::level::read::Source;
use crate::level::{Level, Severity};

/// The level to work on.
#[derive(Clone, Debug, Args)]
pub struct LevelArgs {
    /// Level file: .toml, a Doom .wad, a .dxf or .svg drawing, or a .uvtt (.dd2vtt) map
    pub level: PathBuf,
    /// Map of a WAD that has several
    #[arg(long, value_name = "NAME")]
    pub map: Option<String>,
    #[command(flatten)]
    pub drawing: DrawingArgs,
}

/// How a drawing is understood.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Drawings (.dxf, .svg, .uvtt)")]
pub struct DrawingArgs {
    /// What one unit of the drawing is: mm, cm, m, in, ft, or a number of metres [default: what the
    /// file says]
    #[arg(long, value_name = "UNIT")]
    unit: Option<Unit>,
    /// How far straight pieces may lie off the curve that they stand for, in the level's unit
    /// [default: 1 cm, or a 2000th of the plan where its unit is not known]
    #[arg(long, value_name = "SIZE", value_parser = size)]
    tolerance: Option<f64>,
    /// What layers (classes, ids, blocks) are, by their names: wall=A-WALL*, also column, door,
    /// window, archway, furniture, ignored; may be given several times
    #[arg(id = "layer_rules", long = "layer", value_name = "WHAT=PATTERN")]
    layers: Vec<LayerRule>,
    /// Join ends of walls that are up to so far apart, in the level's unit; each is reported
    #[arg(long, value_name = "SIZE", value_parser = size)]
    close_gaps: Option<f64>,
    /// Closed ground up to this wide, without an opening, is the body of a wall [default: 0.6 m, or
    /// 0.7 of a usual door where the unit is not known]
    #[arg(long, value_name = "SIZE", value_parser = size)]
    thickest_wall: Option<f64>,
}

impl LevelArgs {
    /// Reads the file and the level in it.
    pub fn read(&self) -> Result<Level> {
        Ok(self.open()?.level(self.map.as_deref())?)
    }

    /// Reads the file as far as its maps.
    pub fn open(&self) -> Result<Source> {
        let options = DrawingOptions {
            unit: self.drawing.unit.clone(),
            tolerance: self.drawing.tolerance,
            layers: self.drawing.layers.clone(),
            close_gaps: self.drawing.close_gaps,
            thickest_wall: self.drawing.thickest_wall,
        };
        open_with(&self.level, options)
    }
}

/// Reads a level file as far as its maps; one that is no drawing.
pub fn open(path: &Path) -> Result<Source> {
    open_with(path, DrawingOptions::default())
}

fn open_with(path: &Path, options: DrawingOptions) -> Result<Source> {
    let bytes = fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy();
    Ok(Source::parse_with(bytes, &name, options)?)
}

/// Says on standard error what was repaired in a level or looks wrong, a line for each kind.
pub fn warn_of(findings: &[crate::level::Finding]) {
    for finding in findings.iter().filter(|f| f.severity > Severity::Note) {
        complain(&finding.to_string());
    }
}

/// `--subdivision`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SubdivisionArg {
    /// By the lines of the walls
    #[default]
    Bsp,
    /// By axis-aligned lines through wall ends, then by the walls
    Kd,
    /// Constrained Delaunay triangles
    Cdt,
}

impl From<SubdivisionArg> for Subdivision {
    fn from(arg: SubdivisionArg) -> Self {
        match arg {
            SubdivisionArg::Bsp => Subdivision::Bsp,
            SubdivisionArg::Kd => Subdivision::Kd,
            SubdivisionArg::Cdt => Subdivision::Cdt,
        }
    }
}

/// `--doors`
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DoorsArg {
    /// Nothing that moves stops sight
    #[default]
    Open,
    /// A door that stands closed is a wall
    Closed,
}

impl From<DoorsArg> for Doors {
    fn from(arg: DoorsArg) -> Self {
        match arg {
            DoorsArg::Open => Doors::Open,
            DoorsArg::Closed => Doors::Closed,
        }
    }
}

const USUAL: cells::bsp::BspOptions = cells::bsp::BspOptions::USUAL;

/// How the splitting lines of a BSP are chosen (also inside the leaves of a kd-tree).
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Choice of the BSP's splitting lines")]
pub struct BspArgs {
    /// What a cut wall costs, …
    #[arg(long, value_name = "N", default_value_t = USUAL.split_weight)]
    pub split_weight: u32,
    /// … compared with one wall more on the one side than on the other
    #[arg(long, value_name = "N", default_value_t = USUAL.balance_weight)]
    pub balance_weight: u32,
    /// How many walls are tried as the splitting line
    #[arg(long, value_name = "N", default_value_t = USUAL.candidates, value_parser = at_least_one)]
    pub candidates: usize,
}

impl BspArgs {
    /// Options for [`cells::subdivide`].
    pub fn options(&self, subdivision: Subdivision, doors: Doors) -> cells::Options {
        let bsp = cells::bsp::BspOptions {
            candidates: self.candidates,
            split_weight: self.split_weight,
            balance_weight: self.balance_weight,
            ..cells::bsp::BspOptions::default()
        };
        let kd = cells::kd::KdOptions {
            bsp,
            ..cells::kd::KdOptions::default()
        };
        cells::Options {
            subdivision,
            doors,
            bsp,
            kd,
        }
    }
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if n > 0 => Ok(n),
        _ => Err("a whole number from 1 on is needed".to_string()),
    }
}

/// A point on the plan: `X,Y`.
pub fn point(text: &str) -> Result<glam::DVec2, String> {
    let wrong = || "two numbers with a comma between them are needed, such as 12.5,-3".to_string();
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    number(x)
        .zip(number(y))
        .map(|(x, y)| glam::DVec2::new(x, y))
        .ok_or_else(wrong)
}

/// A length above 0.
fn size(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(size) if size > 0.0 && size < 1e12 => Ok(size),
        _ => Err("a length above 0 is needed, such as 0.05".to_string()),
    }
}
