//! Exports of one level, or of a `.pvs` file: plans, tables, portals.

use std::path::Path;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use glam::DVec2;

use super::super::output::{self, Output};
use super::super::{Answer, complain};
use super::subject::{Subject, SubjectArgs};
use crate::cells::CellId;
use crate::level::scene::{Object, Shape};
use crate::level::{Level, toml};
use crate::pvs::eye::{Cone, Lookout, Scratch};
use crate::report::export::dxf::Extra;
use crate::report::export::geojson::{Eye, Layer, Source};
use crate::report::export::uvtt::UvttOptions;
use crate::report::export::{self, csv};
use crate::report::wording::{count, count_of};
use crate::report::{json, prt, sightlines};

/// Sample sightlines from a source.
const SIGHTLINES: usize = 40;

/// Write the level in the own format: of a Doom map, its sectors and lines.
///
/// The new file reads as the same level, with the same cells and visible sets. What the format has
/// no words for (a Doom map's textures) is left out, and named.
#[derive(Debug, Args)]
pub struct TomlArgs {
    #[command(flatten)]
    subject: SubjectArgs,
}

/// Write a DXF drawing: walls, doors, windows, columns, cells and portals on layers of their own.
///
/// Read again, its walls stop sight where those of the level do.
#[derive(Debug, Args)]
pub struct DxfArgs {
    #[command(flatten)]
    subject: SubjectArgs,
    #[command(flatten)]
    extra: ExtraArgs,
}

/// Write an SVG drawing in layers, to work on in Inkscape. (`enfilade plan` draws pictures to look at.)
#[derive(Debug, Args)]
pub struct SvgArgs {
    #[command(flatten)]
    subject: SubjectArgs,
    #[command(flatten)]
    extra: ExtraArgs,
}

#[derive(Debug, Args)]
struct ExtraArgs {
    /// What is drawn beside walls and openings
    #[arg(
        long = "layers",
        value_enum,
        value_delimiter = ',',
        value_name = "LAYERS"
    )]
    #[arg(default_values = ["cells", "portals"])]
    drawn: Vec<ExtraLayer>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ExtraLayer {
    /// The cells
    Cells,
    /// The portals between them
    Portals,
    /// Neither
    None,
}

impl ExtraArgs {
    fn extra(&self) -> Extra {
        Extra {
            cells: self.drawn.contains(&ExtraLayer::Cells),
            portals: self.drawn.contains(&ExtraLayer::Portals),
        }
    }
}

/// Write a map for virtual table tops (Universal VTT): walls, doors and windows as portals, lights, and
/// a picture.
#[derive(Debug, Args)]
pub struct UvttArgs {
    #[command(flatten)]
    subject: SubjectArgs,
    /// Units of the level that one square of the map is long [default: 1, or 64 of a Doom map]
    #[arg(long, value_name = "SIZE", value_parser = positive)]
    square: Option<f64>,
    /// Pixels of the picture that one square is long; fewer where it would get too large
    #[arg(long, value_name = "N", default_value_t = 70)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    pixels: u32,
}

/// Write the plan as GeoJSON: cells, portals, walls; what a cell or an eye sees.
#[derive(Debug, Args)]
pub struct GeojsonArgs {
    #[command(flatten)]
    subject: SubjectArgs,
    /// What to write [default: cells, portals, walls; with --from or --cell also visible and
    /// sightlines, with --eye also area]
    #[arg(
        long = "layers",
        value_enum,
        value_delimiter = ',',
        value_name = "LAYERS"
    )]
    written: Vec<LayerArg>,
    /// Write what the cell around this point sees
    #[arg(long, value_name = "X,Y", value_parser = super::super::level_args::point)]
    #[arg(allow_hyphen_values = true, conflicts_with = "cell")]
    from: Option<DVec2>,
    /// Write what the cell with this number sees
    #[arg(long, value_name = "N")]
    cell: Option<u32>,
    /// Write the ground that an eye at this point sees
    #[arg(long, value_name = "X,Y", value_parser = super::super::level_args::point)]
    #[arg(allow_hyphen_values = true)]
    eye: Option<DVec2>,
    /// Where the eye looks, in degrees counterclockwise from east
    #[arg(
        long,
        value_name = "DEGREES",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    #[arg(default_value_t = 90.0)]
    direction: f64,
    /// Its angle of view in degrees, 360 being all around
    #[arg(
        long,
        value_name = "DEGREES",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    #[arg(default_value_t = 360.0)]
    fov: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum LayerArg {
    /// The cells
    Cells,
    /// The portals between them
    Portals,
    /// Walls, doors, windows, archways
    Walls,
    /// The cells that the source sees
    Visible,
    /// Sample sightlines from the source
    Sightlines,
    /// The ground that the eye sees
    Area,
}

impl From<LayerArg> for Layer {
    fn from(arg: LayerArg) -> Self {
        match arg {
            LayerArg::Cells => Layer::Cells,
            LayerArg::Portals => Layer::Portals,
            LayerArg::Walls => Layer::Walls,
            LayerArg::Visible => Layer::Visible,
            LayerArg::Sightlines => Layer::Sightlines,
            LayerArg::Area => Layer::Area,
        }
    }
}

/// Write a table for spreadsheets: cells, visible sets, pairs or portals.
#[derive(Debug, Args)]
pub struct CsvArgs {
    #[command(flatten)]
    subject: SubjectArgs,
    /// Which table
    #[arg(long, value_enum, value_name = "TABLE", default_value = "cells")]
    table: TableArg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TableArg {
    /// A row for each cell: room, heights, area, how many cells it sees
    Cells,
    /// A row for each cell: the numbers of the cells that it sees
    Visible,
    /// A row for each pair of cells that see each other
    Pairs,
    /// A row for each portal: its cells and ends
    Portals,
}

impl From<TableArg> for csv::Table {
    fn from(arg: TableArg) -> Self {
        match arg {
            TableArg::Cells => csv::Table::Cells,
            TableArg::Visible => csv::Table::Visible,
            TableArg::Pairs => csv::Table::Pairs,
            TableArg::Portals => csv::Table::Portals,
        }
    }
}

/// Write cells, portals and visible sets as JSON, as `build --json` does.
#[derive(Debug, Args)]
pub struct JsonArgs {
    #[command(flatten)]
    subject: SubjectArgs,
}

/// Write the portals as a PRT1 file of the Quake tools; leaves are the cells.
#[derive(Debug, Args)]
pub struct PrtArgs {
    #[command(flatten)]
    subject: SubjectArgs,
}

/// A length.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(size) if (1e-6..1e6).contains(&size) => Ok(size),
        _ => Err("a length above 0 is needed, such as 1.5".to_string()),
    }
}

/// Runs `export toml`.
pub fn toml(args: &TomlArgs) -> Result<Answer> {
    let args = &args.subject;
    let level = args.level("a .pvs file holds cells, but no rooms and openings")?;
    let written = toml::write::write(&level)
        .map_err(|error| anyhow::anyhow!("{}: {error}", args.path().display()))?;
    let mut output = Output::create(&args.output)?;
    output.write(|out| out.write_all(written.text.as_bytes()))?;
    output::commit([output])?;
    if !args.quiet {
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
            if folder(&args.output) != folder(args.path()) {
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

/// Runs `export dxf`.
pub fn dxf(args: &DxfArgs) -> Result<Answer> {
    let subject = args.subject.read(false)?;
    let mut output = Output::create(&args.subject.output)?;
    // As a whole in memory: the writer of DXF has errors of its own.
    let mut bytes = Vec::new();
    export::dxf::write(&mut bytes, &subject.known(), args.extra.extra())
        .context("the drawing cannot be written")?;
    output.write(|out| out.write_all(&bytes))?;
    output::commit([output])?;
    tell(&args.subject, &subject);
    Ok(Answer::Yes)
}

/// Runs `export svg`.
pub fn svg(args: &SvgArgs) -> Result<Answer> {
    let subject = args.subject.read(args.extra.extra().cells)?;
    let mut output = Output::create(&args.subject.output)?;
    let document = export::svg::draw(&subject.known(), args.extra.extra());
    output.write(|out| writeln!(out, "{document}"))?;
    output::commit([output])?;
    tell(&args.subject, &subject);
    Ok(Answer::Yes)
}

/// Runs `export uvtt`.
pub fn uvtt(args: &UvttArgs) -> Result<Answer> {
    // The level is what is written; cells are only needed for the picture.
    let level = args
        .subject
        .level("a .pvs file holds cells, but no doors and lights")?;
    let graph = args.subject.cells(&level);
    let info = crate::pvs::file::LevelInfo::of(&level);
    let usual = if level.unit == "map unit" { 64.0 } else { 1.0 };
    let options = UvttOptions {
        square: args.square.unwrap_or(usual),
        pixels: args.pixels,
    };
    let known = export::Known {
        info: &info,
        level: Some(&level),
        graph: &graph,
        pvs: None,
    };
    let mut output = Output::create(&args.subject.output)?;
    let mut bytes = Vec::new();
    export::uvtt::write(&mut bytes, &level, &known, &options)
        .context("the map cannot be written")?;
    output.write(|out| out.write_all(&bytes))?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

/// Runs `export geojson`.
pub fn geojson(args: &GeojsonArgs) -> Result<Answer> {
    let sourced = args.from.is_some() || args.cell.is_some();
    let mut layers: Vec<LayerArg> = args.written.clone();
    if layers.is_empty() {
        layers = vec![LayerArg::Cells, LayerArg::Portals, LayerArg::Walls];
        if sourced {
            layers.extend([LayerArg::Visible, LayerArg::Sightlines]);
        }
        if args.eye.is_some() {
            layers.push(LayerArg::Area);
        }
    }
    let asks = |layer| layers.contains(&layer);
    if (asks(LayerArg::Visible) || asks(LayerArg::Sightlines)) && !sourced {
        bail!(
            "the layers visible and sightlines are those of a cell; name it with --from or --cell"
        );
    }
    if asks(LayerArg::Area) && args.eye.is_none() {
        bail!("the layer area is what an eye sees; place it with --eye X,Y");
    }
    let subject = args.subject.read(asks(LayerArg::Cells) || sourced)?;
    let source = source(args, &subject)?;
    let lookout = Lookout::new(&subject.graph);
    let mut scratch = Scratch::default();
    let vista = match args.eye {
        None => None,
        Some(at) => {
            let cone = Cone::new(args.direction, args.fov)?;
            let eye = subject.graph.grid.fine(at);
            let seen = eye.and_then(|eye| lookout.look(&eye, &cone, &mut scratch).ok());
            let Some(vista) = seen else {
                bail!(
                    "the eye at {},{} lies outside {}",
                    at.x,
                    at.y,
                    subject.info.name
                );
            };
            Some(vista)
        }
    };
    let eye = vista.as_ref().map(|vista| Eye {
        vista,
        direction: args.direction,
        fov: args.fov,
    });
    let layers: Vec<Layer> = layers.into_iter().map(Layer::from).collect();
    let mut output = Output::create(&args.subject.output)?;
    let (source, eye) = (source.as_ref(), eye.as_ref());
    output.write(|out| export::geojson::write(out, &subject.known(), &layers, source, eye))?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

/// The cell that was asked for, if any.
fn source(args: &GeojsonArgs, subject: &Subject) -> Result<Option<Source>> {
    let graph = &subject.graph;
    let cell = match (args.cell, args.from) {
        (Some(cell), _) => {
            super::super::plan::must_exist(graph, cell)?;
            CellId(cell)
        }
        (None, Some(at)) => {
            let on_grid = graph.grid.nearest(at);
            let locator = crate::cells::Locator::new(graph);
            let cell = on_grid.and_then(|p| locator.cell_at(graph, p));
            let Some(cell) = cell else {
                bail!(
                    "the point {},{} lies outside {}",
                    at.x,
                    at.y,
                    subject.info.name
                );
            };
            cell
        }
        (None, None) => return Ok(None),
    };
    let pvs = subject.pvs.as_ref();
    let lines = pvs.map(|pvs| sightlines::sample(graph, pvs, cell, SIGHTLINES));
    Ok(Some(Source {
        cell,
        lines: lines.unwrap_or_default(),
    }))
}

/// Runs `export csv`.
pub fn csv(args: &CsvArgs) -> Result<Answer> {
    let table = csv::Table::from(args.table);
    let subject = args.subject.read(table.needs_pvs())?;
    let mut output = Output::create(&args.subject.output)?;
    output.write(|out| {
        csv::write(out, &subject.known(), table).map_err(|error| match error.into_kind() {
            ::csv::ErrorKind::Io(error) => error,
            other => std::io::Error::other(format!("{other:?}")),
        })
    })?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

/// Runs `export json`.
pub fn json(args: &JsonArgs) -> Result<Answer> {
    let subject = args.subject.read(true)?;
    let Some(pvs) = &subject.pvs else {
        bail!("it was not found out who sees whom");
    };
    let mut output = Output::create(&args.subject.output)?;
    let sectors = subject
        .level
        .as_ref()
        .map_or(&[][..], |level| &level.sectors);
    output.write(|out| {
        json::write_known(
            out,
            &subject.info,
            sectors,
            &subject.graph,
            pvs,
            &subject.seconds,
        )
    })?;
    output::commit([output])?;
    Ok(Answer::Yes)
}

/// Runs `export prt`.
pub fn portals(args: &PrtArgs) -> Result<Answer> {
    let subject = args.subject.read(false)?;
    let graph = &subject.graph;
    let mut output = Output::create(&args.subject.output)?;
    let mut written = 0;
    output.write(|out| {
        written = prt::write(out, graph)?;
        Ok(())
    })?;
    output::commit([output])?;
    if !args.subject.quiet {
        let (leaves, portals) = (
            count_of(graph.cells.len(), "leaf", "leaves"),
            count(written, "portal"),
        );
        let closed = graph.portals.len() - written;
        complain(&format!(
            "{}: {leaves}, {portals}, {closed} more that never open",
            subject.info.name
        ));
    }
    Ok(Answer::Yes)
}

/// Says what a `.pvs` file does not hold.
fn tell(args: &SubjectArgs, subject: &Subject) {
    if !args.quiet && subject.level.is_none() {
        complain(&format!(
            "{}: a .pvs file knows no doors and windows: they are gaps in the walls",
            args.path().display()
        ));
    }
}
