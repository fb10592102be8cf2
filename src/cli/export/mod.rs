//! `enfilade export`: a level, its cells and its visibility in the formats of other programs.
//!
//! `doom` does the tables of Doom maps, `plan` what is made of one level or `.pvs` file ([`subject`]).

mod doom;
mod plan;
mod subject;

use anyhow::Result;
use clap::{Args, Subcommand};

use super::Answer;

/// Write a level, its cells, portals or visible sets in another program's format.
#[derive(Debug, Args)]
pub struct ExportArgs {
    #[command(subcommand)]
    format: Format,
}

#[derive(Debug, Subcommand)]
enum Format {
    Toml(plan::TomlArgs),
    Dxf(plan::DxfArgs),
    Svg(plan::SvgArgs),
    Uvtt(plan::UvttArgs),
    Geojson(plan::GeojsonArgs),
    Csv(plan::CsvArgs),
    Json(plan::JsonArgs),
    Prt(plan::PrtArgs),
    Reject(doom::RejectArgs),
    GlPvs(doom::GlPvsArgs),
}

/// Runs `enfilade export`.
pub fn run(args: &ExportArgs) -> Result<Answer> {
    match &args.format {
        Format::Toml(args) => plan::toml(args),
        Format::Dxf(args) => plan::dxf(args),
        Format::Svg(args) => plan::svg(args),
        Format::Uvtt(args) => plan::uvtt(args),
        Format::Geojson(args) => plan::geojson(args),
        Format::Csv(args) => plan::csv(args),
        Format::Json(args) => plan::json(args),
        Format::Prt(args) => plan::portals(args),
        Format::Reject(args) => doom::reject(args),
        Format::GlPvs(args) => doom::gl_pvs(args),
    }
}
