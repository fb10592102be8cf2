//! GeoJSON (RFC 7946) of the plan: features with geometry and properties, for GIS programs and scripts.
//!
//! Coordinates are those of the level, x right and y up, in its own unit: not longitudes and latitudes.
//! The collection says so in its member `enfilade`, with the level's name and unit. Each feature has a
//! property `layer`:
//!
//! | layer | geometry | properties |
//! |---|---|---|
//! | `cells` | polygon | `cell`, `sector`, `room`, `floor`, `ceiling`, `area`, `sees` |
//! | `portals` | line | `portal`, `cells`, `bottom`, `top` |
//! | `walls` | line | `kind`: wall, door, window, archway, step; `name`, `closed` |
//! | `visible` | polygon | as `cells`, of those that the source sees; `source` is true for itself |
//! | `sightlines` | line | `from`, `to`: cells that a free line joins |
//! | `area` | polygon | `eye`, `direction`, `fov`, `area`: the ground that an eye sees, exactly |
//!
//! Polygons are counterclockwise and closed. Each feature stands on a line of its own.

use std::io::{self, Write};

use geojson::{Feature, GeometryValue, JsonObject, Position};
use glam::DVec2;
use serde_json::{Value, json};

use super::Known;
use super::lines::{Kind, Lines};
use crate::cells::CellId;
use crate::pvs::eye::Vista;
use crate::report::json::polygon;
use crate::report::sightlines::Sightline;

/// What is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The cells.
    Cells,
    /// The portals.
    Portals,
    /// Walls and openings.
    Walls,
    /// The cells that the source sees.
    Visible,
    /// Sample sightlines from the source.
    Sightlines,
    /// The ground that an eye sees.
    Area,
}

/// A cell from which something is seen.
pub struct Source {
    /// The cell.
    pub cell: CellId,
    /// Sample sightlines from there.
    pub lines: Vec<Sightline>,
}

/// An eye and what it sees.
pub struct Eye<'a> {
    /// What it sees.
    pub vista: &'a Vista<'a>,
    /// Where it looks, and its angle of view, in degrees.
    pub direction: f64,
    /// As above.
    pub fov: f64,
}

/// Writes a feature collection of these layers, in their order.
///
/// # Errors
/// Those of `out`.
pub fn write(
    mut out: impl Write,
    known: &Known,
    layers: &[Layer],
    source: Option<&Source>,
    eye: Option<&Eye>,
) -> io::Result<()> {
    let about = json!({
        "name": known.info.name,
        "source": known.info.source,
        "unit": known.info.unit,
        "subdivision": known.graph.options.subdivision.as_str(),
        "doors": known.graph.options.doors.as_str(),
    });
    let head = r#"{"type":"FeatureCollection","#;
    writeln!(out, "{head}\"enfilade\":{about},\"features\":[")?;
    let mut first = true;
    let mut add = |feature: Feature| {
        let comma = if std::mem::take(&mut first) {
            ""
        } else {
            ",\n"
        };
        write!(out, "{comma}{feature}")
    };
    for layer in layers {
        match layer {
            Layer::Cells => {
                for cell in known.graph.cell_ids() {
                    add(cell_feature(known, cell, "cells", json!({})))?;
                }
            }
            Layer::Portals => portals(known).try_for_each(&mut add)?,
            Layer::Walls => walls(known).into_iter().try_for_each(&mut add)?,
            Layer::Visible => {
                if let Some((source, pvs)) = source.zip(known.pvs) {
                    for cell in pvs.seen_from(source.cell) {
                        let more = json!({ "source": cell == source.cell });
                        add(cell_feature(known, cell, "visible", more))?;
                    }
                }
            }
            Layer::Sightlines => {
                for line in source.iter().flat_map(|source| &source.lines) {
                    let ends = [line.from, line.to].map(|p| known.graph.grid.to_level(p));
                    let from = source.map(|source| source.cell.0);
                    let more = json!({ "from": from, "to": line.cell.0 });
                    add(line_feature(ends, "sightlines", more))?;
                }
            }
            Layer::Area => {
                if let Some(eye) = eye {
                    add(area(known, eye))?;
                }
            }
        }
    }
    writeln!(out, "\n]}}")
}

fn portals<'a>(known: &'a Known) -> impl Iterator<Item = Feature> + 'a {
    known.graph.portals.iter().enumerate().map(|(i, portal)| {
        let cells = known.graph.joined(portal).map(|c| c.0);
        let more = json!({
            "portal": i, "cells": cells, "bottom": portal.bottom, "top": portal.top,
        });
        line_feature(super::segment(known.graph, portal), "portals", more)
    })
}

fn walls(known: &Known) -> Vec<Feature> {
    let wall = |ends| line_feature(ends, "walls", json!({ "kind": "wall" }));
    let Some(level) = known.level else {
        return Lines::of_cells(known.graph).into_iter().map(wall).collect();
    };
    let lines = Lines::of_level(level, known.graph);
    let drawn = lines.drawn.iter().map(|line| {
        let kind = match line.kind {
            Kind::Wall => "wall",
            Kind::Door => "door",
            Kind::Window => "window",
            Kind::Archway => "archway",
            Kind::Step => "step",
        };
        let ends = line.ends.map(|p| level.grid.to_level(p));
        match line.kind {
            Kind::Wall => wall(ends),
            _ => {
                let more = json!({ "kind": kind, "name": line.name, "closed": line.shut });
                line_feature(ends, "walls", more)
            }
        }
    });
    let solids = lines.solids.iter().flat_map(|corners| {
        let next = corners.iter().cycle().skip(1);
        let sides = corners.iter().zip(next);
        sides.map(|(&p, &q)| wall([p, q].map(|p| level.grid.to_level(p))))
    });
    drawn.chain(solids).collect()
}

fn area(known: &Known, eye: &Eye) -> Feature {
    let grid = &known.graph.grid;
    let mut outline = Vec::new();
    eye.vista.outline(&mut outline);
    let units = |p: DVec2| grid.offset_to_level(p.x, p.y);
    let at = units(eye.vista.eye().approx());
    let step = grid.step.length();
    let more = json!({
        "eye": at.to_array(),
        "direction": eye.direction,
        "fov": eye.fov,
        "area": eye.vista.area() * step * step,
    });
    let corners: Vec<DVec2> = outline.into_iter().map(units).collect();
    feature(ring(&corners), "area", more)
}

fn cell_feature(known: &Known, cell: CellId, layer: &str, more: Value) -> Feature {
    let sector = known.sector(cell);
    let mut about = json!({
        "cell": cell.0,
        "sector": known.graph.cell(cell).sector.map(|s| s.0),
        "room": known.room(cell),
        "floor": sector.map(|s| s.floor.rest),
        "ceiling": sector.map(|s| s.ceiling.rest),
        "area": known.area(cell),
    });
    if let Some(about) = about.as_object_mut() {
        if let Some(pvs) = known.pvs {
            about.insert("sees".into(), pvs.seen_from(cell).count().into());
        }
        about.extend(more.as_object().cloned().into_iter().flatten());
    }
    feature(ring(&polygon(known.graph, cell)), layer, about)
}

fn line_feature(ends: [DVec2; 2], layer: &str, about: Value) -> Feature {
    let line = GeometryValue::LineString {
        coordinates: ends.map(position).into(),
    };
    feature(line, layer, about)
}

/// A polygon without holes, closed by its first corner.
fn ring(corners: &[DVec2]) -> GeometryValue {
    let closed = corners.iter().chain(corners.first());
    GeometryValue::Polygon {
        coordinates: vec![closed.map(|&p| position(p)).collect()],
    }
}

fn position(p: DVec2) -> Position {
    Position::from([p.x + 0.0, p.y + 0.0])
}

fn feature(geometry: GeometryValue, layer: &str, about: Value) -> Feature {
    let mut properties = JsonObject::new();
    properties.insert("layer".into(), layer.into());
    properties.extend(about.as_object().cloned().into_iter().flatten());
    Feature {
        bbox: None,
        geometry: Some(geometry.into()),
        id: None,
        properties: Some(properties),
        foreign_members: None,
    }
}

#[cfg(test)]
mod tests {
    use geojson::{FeatureCollection, GeoJson};

    use super::*;
    use crate::cells::{Locator, Options, subdivide};
    use crate::level::Level;
    use crate::level::read::read;
    use crate::pvs::eye::{Cone, Lookout, Scratch};
    use crate::pvs::file::LevelInfo;
    use crate::pvs::{Progress, sweep::sweep};
    use crate::report::sightlines::sample;

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";

    fn parsed(bytes: &[u8]) -> FeatureCollection {
        match std::str::from_utf8(bytes).unwrap().parse().unwrap() {
            GeoJson::FeatureCollection(all) => all,
            other => panic!("{other}"),
        }
    }

    #[test]
    fn everything_at_once() {
        let level: Level = read(ROOMS.into(), "a.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let pvs = sweep(&graph, &Progress::default());
        let at = level.grid.nearest(DVec2::new(1.0, 2.0)).unwrap();
        let cell = Locator::new(&graph).cell_at(&graph, at).unwrap();
        let source = Source {
            cell,
            lines: sample(&graph, &pvs, cell, 5),
        };
        let (lookout, mut scratch) = (Lookout::new(&graph), Scratch::default());
        let vista = lookout.look(&at.into(), &Cone::ALL, &mut scratch).unwrap();
        let eye = Eye {
            vista: &vista,
            direction: 0.0,
            fov: 360.0,
        };
        let known = Known {
            info: &LevelInfo::of(&level),
            level: Some(&level),
            graph: &graph,
            pvs: Some(&pvs),
        };
        let layers = [
            Layer::Cells,
            Layer::Portals,
            Layer::Walls,
            Layer::Visible,
            Layer::Sightlines,
            Layer::Area,
        ];
        let mut bytes = Vec::new();
        write(&mut bytes, &known, &layers, Some(&source), Some(&eye)).unwrap();
        let all = parsed(&bytes);
        let of = |layer: &str| -> Vec<&Feature> {
            let features = all.features.iter();
            features
                .filter(|f| f.property("layer").unwrap() == layer)
                .collect()
        };
        assert_eq!((of("cells").len(), of("portals").len()), (2, 1));
        assert_eq!((of("visible").len(), of("sightlines").len()), (2, 1));
        assert_eq!(of("walls").len(), 7);
        assert_eq!(of("cells")[0].property("area").unwrap(), 16.0);
        // All of the one room, and what is seen through the door: a strip that widens from 1 to 7/3.
        let area = of("area")[0].property("area").unwrap().as_f64().unwrap();
        assert!(
            (area - (16.0 + 4.0 * (1.0 + 7.0 / 3.0) / 2.0)).abs() < 1e-9,
            "{area}"
        );
        let unit = &all.foreign_members.as_ref().unwrap()["enfilade"]["unit"];
        assert_eq!(unit, "m");
        // Rings are closed and counterclockwise.
        for feature in of("cells") {
            let GeometryValue::Polygon { coordinates } = &feature.geometry.as_ref().unwrap().value
            else {
                panic!("a cell is a polygon");
            };
            let ring: Vec<DVec2> = (coordinates[0].iter())
                .map(|p| DVec2::from_slice(p.as_slice()))
                .collect();
            assert_eq!(ring.first(), ring.last());
            assert!(crate::pvs::eye::area(&ring) > 0.0);
        }
    }

    #[test]
    fn nothing_is_a_collection_too() {
        let level = read("[[wall]]\npoints = [[0, 0], [1, 0]]".into(), "w.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let known = Known {
            info: &LevelInfo::of(&level),
            level: None,
            graph: &graph,
            pvs: None,
        };
        let mut bytes = Vec::new();
        write(
            &mut bytes,
            &known,
            &[Layer::Cells, Layer::Walls],
            None,
            None,
        )
        .unwrap();
        assert!(parsed(&bytes).features.is_empty());
    }
}
