//! The figures as JSON, for scripts and for the next report's `--baseline`.
//!
//! The keys of `build`'s JSON (`level`, `subdivision`, `visibility`, `cells`, `portals`, `visible`) are
//! there with the same meaning; cells have further keys.

use std::io::{self, Write};

use serde::ser::SerializeMap;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::{Value, json};

use super::baseline::Comparison;
use super::budget::Check;
use super::{Costs, Measure, Spread, Tally};
use crate::cells::CellId;
use crate::pvs::file::LevelInfo;
use crate::report::json::{self, Seconds, each, head, write_lines};

/// The whole level in a few numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Totals {
    /// What there is.
    pub own: Tally,
    /// Mean number of cells that a cell sees.
    pub mean_cells: f64,
    /// Mean number of polygons that a cell sees.
    pub mean_polygons: f64,
    /// Mean area that somebody sees who stands anywhere, by ground.
    pub mean_ground: f64,
    /// Visible pairs as a share of all.
    pub density: f64,
    /// Length of the longest sightline.
    pub longest_sightline: f64,
}

impl Totals {
    /// Of a level.
    pub fn of(costs: &Costs) -> Self {
        let own = costs.total();
        let ground = costs.own.iter().zip(&costs.seen);
        let ground: f64 = ground.map(|(o, s)| o.area * s.area).sum();
        Totals {
            own,
            mean_cells: costs.spread(Measure::Cells).mean,
            mean_polygons: costs.spread(Measure::Polygons).mean,
            mean_ground: if own.area > 0.0 {
                ground / own.area
            } else {
                0.0
            },
            density: costs.pvs.density(),
            longest_sightline: costs.longest_sightline(),
        }
    }
}

/// What a document holds.
pub struct Document<'a> {
    /// The figures.
    pub costs: &'a Costs<'a>,
    /// What `build` took.
    pub seconds: &'a Seconds,
    /// Limits and whether they are kept.
    pub budget: &'a [Check],
    /// What changed.
    pub comparison: Option<&'a Comparison>,
}

/// Writes the JSON object, and a line feed after it.
///
/// # Errors
/// Those of `out`.
pub fn write(out: impl Write, document: &Document) -> io::Result<()> {
    write_lines(out, document)
}

#[derive(Serialize)]
struct CellRecord<'a> {
    sector: Option<u32>,
    room: u32,
    floor: Option<f64>,
    ceiling: Option<f64>,
    polygon: Vec<[f64; 2]>,
    own: &'a Tally,
    seen: &'a Tally,
    sightline: Option<LineRecord>,
}

#[derive(Serialize)]
struct LineRecord {
    length: f64,
    from: [f64; 2],
    to: [f64; 2],
}

#[derive(Serialize)]
struct SpreadRecord {
    measure: &'static str,
    title: &'static str,
    #[serde(flatten)]
    spread: Spread,
}

impl Serialize for Document<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Costs {
            level,
            graph,
            pvs,
            gaps,
            worst,
            lanes,
            rooms,
            findings,
            seconds,
            ..
        } = self.costs;
        let mut map = serializer.serialize_map(None)?;
        head(
            &mut map,
            "enfilade.report",
            &LevelInfo::of(level),
            graph,
            pvs,
        )?;
        map.serialize_entry("seconds", self.seconds)?;
        map.serialize_entry("report_seconds", seconds)?;
        map.serialize_entry("totals", &Totals::of(self.costs))?;
        let spreads = self.costs.measures().into_iter().map(|m| SpreadRecord {
            measure: m.key(),
            title: m.title(),
            spread: self.costs.spread(m),
        });
        map.serialize_entry("distribution", &each(spreads))?;
        map.serialize_entry("budget", &self.budget)?;
        map.serialize_entry("findings", &each(findings.iter().map(finding)))?;
        map.serialize_entry("worst", worst)?;
        map.serialize_entry("openings", gaps)?;
        map.serialize_entry("sightlines", lanes)?;
        map.serialize_entry("rooms", &rooms.list)?;
        if let Some(comparison) = self.comparison {
            map.serialize_entry("comparison", comparison)?;
        }
        map.serialize_entry(
            "cells",
            &each(graph.cell_ids().map(|c| cell(self.costs, c))),
        )?;
        let portals = graph.portals.iter().map(|p| json::portal(graph, p));
        map.serialize_entry("portals", &each(portals))?;
        let row = |id| each(pvs.seen_from(id).map(|c| c.0));
        map.serialize_entry("visible", &each(graph.cell_ids().map(row)))?;
        map.end()
    }
}

fn cell<'a>(costs: &'a Costs, id: CellId) -> CellRecord<'a> {
    let Costs { level, graph, .. } = costs;
    let sector = graph.cell(id).sector;
    let of_level = sector.and_then(|s| level.sectors.get(s.0 as usize));
    let at = |p: glam::DVec2| graph.grid.offset_to_level(p.x, p.y).to_array();
    let polygon = json::polygon(graph, id);
    CellRecord {
        sector: sector.map(|s| s.0),
        room: costs.rooms.of_cell[id.0 as usize],
        floor: of_level.map(|s| s.floor.rest),
        ceiling: of_level.map(|s| s.ceiling.rest),
        polygon: polygon.into_iter().map(|p| p.to_array()).collect(),
        own: &costs.own[id.0 as usize],
        seen: &costs.seen[id.0 as usize],
        sightline: costs.sightline(id).map(|line| LineRecord {
            length: costs.length(line),
            from: at(line.from),
            to: at(line.to),
        }),
    }
}

fn finding(f: &crate::level::Finding) -> Value {
    json!({
        "code": f.code,
        "severity": f.severity.as_str(),
        "message": f.message,
        "count": f.places.len(),
        "places": f.places.iter().map(json::place).collect::<Vec<_>>(),
    })
}
