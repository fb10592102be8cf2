//! DXF drawings (AutoCAD 2000, text) of the plan, for CAD programs.
//!
//! | layer | entities | what |
//! |---|---|---|
//! | `WALLS` | lines | walls, with gaps where openings are |
//! | `DOORS`, `WINDOWS`, `ARCHWAYS` | lines | openings, from jamb to jamb |
//! | `COLUMNS` | closed polylines | solids in rooms |
//! | `STEPS` | lines | changes of floor or sector without a wall |
//! | `ROOMS` | texts | the rooms' names |
//! | `PORTALS` | lines | portals between cells |
//! | `CELLS` | closed polylines | the cells |
//!
//! Coordinates are the level's own, each written with as many digits as it takes to read the same number
//! back; `$INSUNITS` and `$MEASUREMENT` tell the unit where DXF has a word for it. The same level gives
//! the same bytes.

use std::io::Write;

use dxf::entities::{Entity, EntityType, Line, LwPolyline, Text};
use dxf::enums::{AcadVersion, DrawingUnits, Units};
use dxf::tables::Layer;
use dxf::{Color, Drawing, DxfResult, LwPolylineVertex, Point};
use glam::DVec2;

use super::Known;
use super::lines::{Kind, Lines};
use crate::report::json::polygon;

/// Layers with their colours in AutoCAD's index.
const LAYERS: [(&str, u8); 9] = [
    ("CELLS", 8),
    ("PORTALS", 9),
    ("STEPS", 30),
    ("WALLS", 7),
    ("DOORS", 32),
    ("WINDOWS", 4),
    ("ARCHWAYS", 3),
    ("COLUMNS", 7),
    ("ROOMS", 251),
];

/// Which layers are written beside walls, openings and columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extra {
    /// `CELLS`.
    pub cells: bool,
    /// `PORTALS`.
    pub portals: bool,
}

/// Writes a drawing. Of a `.pvs` file alone the openings are not known: they are gaps in the walls.
///
/// # Errors
/// Those of `out`.
pub fn write(mut out: impl Write, known: &Known, extra: Extra) -> DxfResult<()> {
    let mut drawing = Drawing::new();
    header(&mut drawing, &known.info.unit);
    for (name, color) in LAYERS {
        drawing.add_layer(Layer {
            name: name.into(),
            color: Color::from_index(color),
            ..Layer::default()
        });
    }
    if extra.cells {
        for cell in known.graph.cell_ids() {
            add(&mut drawing, "CELLS", outline(&polygon(known.graph, cell)));
        }
    }
    if extra.portals {
        for portal in &known.graph.portals {
            add(
                &mut drawing,
                "PORTALS",
                line(super::segment(known.graph, portal)),
            );
        }
    }
    match known.level {
        None => {
            for ends in Lines::of_cells(known.graph) {
                add(&mut drawing, "WALLS", line(ends));
            }
        }
        Some(level) => {
            let lines = Lines::of_level(level, known.graph);
            for drawn in &lines.drawn {
                let layer = match drawn.kind {
                    Kind::Wall => "WALLS",
                    Kind::Door => "DOORS",
                    Kind::Window => "WINDOWS",
                    Kind::Archway => "ARCHWAYS",
                    Kind::Step => "STEPS",
                };
                let ends = drawn.ends.map(|p| level.grid.to_level(p));
                add(&mut drawing, layer, line(ends));
            }
            for corners in &lines.solids {
                let corners: Vec<DVec2> = corners.iter().map(|&p| level.grid.to_level(p)).collect();
                add(&mut drawing, "COLUMNS", outline(&corners));
            }
            for (name, at, height) in super::labels(known) {
                add(&mut drawing, "ROOMS", text(name, at, height));
            }
        }
    }
    drawing.save(&mut out)
}

/// What the head of the file says. Nothing in it depends on when or where it is written.
fn header(drawing: &mut Drawing, unit: &str) {
    let (units, metric) = match unit {
        "mm" => (Units::Millimeters, true),
        "cm" => (Units::Centimeters, true),
        "dm" => (Units::Decimeters, true),
        "m" => (Units::Meters, true),
        "km" => (Units::Kilometers, true),
        "in" => (Units::Inches, false),
        "ft" => (Units::Feet, false),
        "yd" => (Units::Yards, false),
        "mi" => (Units::Miles, false),
        _ => (Units::Unitless, true),
    };
    let header = &mut drawing.header;
    header.version = AcadVersion::R2000;
    header.default_drawing_units = units;
    header.drawing_units = match metric {
        true => DrawingUnits::Metric,
        false => DrawingUnits::English,
    };
    (header.creation_date, header.creation_date_universal) = Default::default();
    (header.update_date, header.update_date_universal) = Default::default();
    (header.fingerprint_guid, header.version_guid) = Default::default();
}

fn add(drawing: &mut Drawing, layer: &str, specific: EntityType) {
    let mut entity = Entity::new(specific);
    entity.common.layer = layer.into();
    drawing.add_entity(entity);
}

fn point(p: DVec2) -> Point {
    Point::new(p.x + 0.0, p.y + 0.0, 0.0)
}

fn line([from, to]: [DVec2; 2]) -> EntityType {
    EntityType::Line(Line::new(point(from), point(to)))
}

/// A closed polyline.
fn outline(corners: &[DVec2]) -> EntityType {
    let vertex = |p: &DVec2| LwPolylineVertex {
        x: p.x + 0.0,
        y: p.y + 0.0,
        ..LwPolylineVertex::default()
    };
    EntityType::LwPolyline(LwPolyline {
        flags: 1,
        vertices: corners.iter().map(vertex).collect(),
        ..LwPolyline::default()
    })
}

fn text(value: &str, at: DVec2, height: f64) -> EntityType {
    EntityType::Text(Text {
        location: point(at),
        text_height: height,
        value: value.into(),
        ..Text::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::file::LevelInfo;

    const ROOMS: &str = "name = \"Two\"\n[[room]]\nname = \"Küche\"\nrect = [0.1, 0, 4.3, 4]\n\
        [[room]]\nname = \"B\"\noutline = [[4.3, 0], [8, 0.7], [8, 4], [4.3, 4]]\n\
        [[pillar]]\nrect = [1, 1, 2, 2]\n\
        [[door]]\nbetween = [\"Küche\", \"B\"]\nwidth = 1\n";

    #[test]
    fn a_drawing_of_two_rooms() {
        let level = read(ROOMS.into(), "a.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let known = Known {
            info: &LevelInfo::of(&level),
            level: Some(&level),
            graph: &graph,
            pvs: None,
        };
        let all = Extra {
            cells: true,
            portals: true,
        };
        let written = |known: &Known| {
            let mut bytes = Vec::new();
            write(&mut bytes, known, all).unwrap();
            bytes
        };
        let bytes = written(&known);
        assert_eq!(bytes, written(&known), "the same level, the same bytes");
        let drawing = Drawing::load(&mut &bytes[..]).unwrap();
        assert_eq!(drawing.header.default_drawing_units, Units::Meters);
        let count = |layer: &str| {
            drawing
                .entities()
                .filter(|e| e.common.layer == layer)
                .count()
        };
        // The wall between the rooms in two parts, and the other three sides of each, those of the
        // second one a part of them along the first one's.
        assert_eq!(
            (count("WALLS"), count("DOORS"), count("COLUMNS")),
            (7, 1, 1)
        );
        assert_eq!((count("CELLS"), count("ROOMS")), (graph.cells.len(), 2));
        assert_eq!(count("PORTALS"), graph.portals.len());
        // Coordinates are read as the very numbers.
        let corner = level.grid.to_level(level.walls[0].from);
        let there = drawing.entities().any(|e| match &e.specific {
            EntityType::Line(line) => [&line.p1, &line.p2]
                .iter()
                .any(|p| DVec2::new(p.x, p.y) == corner),
            _ => false,
        });
        assert!(there, "{corner}");

        let bare = Known {
            level: None,
            ..known
        };
        let drawing = Drawing::load(&mut &written(&bare)[..]).unwrap();
        let walls = drawing.entities().filter(|e| e.common.layer == "WALLS");
        assert_eq!(walls.count(), graph.n_walls());
    }
}
