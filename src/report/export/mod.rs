//! Results in the formats of other programs.
//!
//! In: a level, its cells and visible sets, or those of a `.pvs` file alone ([`Known`]). Out: text that
//! other programs read. The formats that the crate reads as well (DXF, SVG, UVTT) are written so that
//! what comes back has the same planar PVS; [`lines`] says how walls and openings are told apart.
//!
//! | format | what it holds | for |
//! |---|---|---|
//! | [`dxf`] | walls, doors, windows, columns, portals, cells | CAD programs |
//! | [`svg`] | the same in layers | Inkscape, browsers |
//! | [`uvtt`] | walls, portals, lights and a picture | virtual table tops |
//! | [`geojson`] | cells, walls, portals, what is seen | GIS, scripts |
//! | [`csv`] | tables of cells, visible sets, portals | spreadsheets |
//!
//! JSON is [`super::json`], the Quake tools' portals are [`super::prt`]; a Doom map's tables are
//! [`pvs::sectors`](crate::pvs::sectors) and [`pvs::subsectors`](crate::pvs::subsectors), the own format
//! is [`level::toml::write`](crate::level::toml::write).

pub mod csv;
pub mod dxf;
pub mod geojson;
pub mod lines;
pub mod svg;
pub mod uvtt;

use glam::DVec2;

use crate::cells::{CellGraph, CellId, Portal};
use crate::level::{Level, Sector};
use crate::pvs::Pvs;
use crate::pvs::file::LevelInfo;

/// What there is to write.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// What the level is called, and its unit.
    pub info: &'a LevelInfo,
    /// The level; a `.pvs` file does not hold it.
    pub level: Option<&'a Level>,
    /// Its cells.
    pub graph: &'a CellGraph,
    /// Who sees whom; only where the format asks for it.
    pub pvs: Option<&'a Pvs>,
}

impl Known<'_> {
    /// The sector of a cell, where the level is known.
    pub fn sector(&self, cell: CellId) -> Option<&Sector> {
        let sector = self.graph.cell(cell).sector?;
        self.level?.sectors.get(sector.0 as usize)
    }

    /// The name of the room that a cell is in, if it has one.
    pub fn room(&self, cell: CellId) -> Option<&str> {
        self.sector(cell)?.name.as_deref()
    }

    /// A cell's area in square units.
    pub fn area(&self, cell: CellId) -> f64 {
        let step = self.graph.grid.step.length();
        self.graph.area(cell) * step * step
    }
}

/// The ends of a portal in the level's own coordinates; the first of its cells lies left of the way from
/// the one to the other.
fn segment(graph: &CellGraph, portal: &Portal) -> [DVec2; 2] {
    let edge = portal.edges[0];
    [graph.edge(edge).origin, graph.end(edge)]
        .map(|v| graph.vertices.exact(v).to_level(&graph.grid))
}

/// The rooms' names: each in the middle of the largest cell of its sector, in letters that fit there.
fn labels<'a>(known: &Known<'a>) -> Vec<(&'a str, DVec2, f64)> {
    let Some(level) = known.level else {
        return Vec::new();
    };
    let mut largest: Vec<Option<(f64, CellId)>> = vec![None; level.sectors.len()];
    for cell in known.graph.cell_ids() {
        let sector = known.graph.cell(cell).sector.map(|s| s.0 as usize);
        if let Some(place) = sector.and_then(|s| largest.get_mut(s)) {
            let area = known.area(cell);
            if place.is_none_or(|(most, _)| area > most) {
                *place = Some((area, cell));
            }
        }
    }
    let label = |(sector, cell): (&'a Sector, Option<(f64, CellId)>)| {
        let (name, (area, cell)) = (sector.name.as_deref()?, cell?);
        let corners = super::json::polygon(known.graph, cell);
        let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
        let letters = name.chars().count().max(4) as f64;
        Some((name, middle, (area.sqrt() / letters).min(area.sqrt() / 6.0)))
    };
    level
        .sectors
        .iter()
        .zip(largest)
        .filter_map(label)
        .collect()
}

/// A difference of decimals as the decimal that it is: `8 - 7.7` is 0.3. Not beyond nine digits after the
/// point.
fn decimal(x: f64) -> f64 {
    let rounded = (x * 1e9).round() / 1e9;
    if (rounded - x).abs() < 1e-10 {
        rounded
    } else {
        x
    }
}
