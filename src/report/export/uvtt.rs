//! Maps for virtual table tops: Universal VTT (`.uvtt`, `.dd2vtt`), which is JSON.
//!
//! | key | what |
//! |---|---|
//! | `resolution` | the size of the map in squares, and pixels a square |
//! | `line_of_sight` | walls, as chains of points |
//! | `objects_line_of_sight` | solids in rooms, closed |
//! | `portals` | doors and windows; `closed` where a leaf stands closed |
//! | `lights` | lights that stand somewhere, without heights |
//! | `image` | a PNG of the plan |
//!
//! Points are in squares from the upper left corner of the map, y down; around the level there is one
//! square of margin. Where a square is one unit of the level, or a power of two or ten of it, the walls
//! come back exactly. Archways and changes of height have no word in the format: the one is a gap, the
//! other nothing.

use std::io::{self, Write};

use base64::Engine;
use glam::DVec2;
use serde_json::{Value, json};

use super::lines::{Drawn, Kind, Lines};
use super::{Known, decimal};
use crate::geom::GridPoint;
use crate::level::Level;
use crate::level::scene::{Light, LightShape};
use crate::report::json::polygon;
use crate::report::picture::{self, PictureError};

/// How a map is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvttOptions {
    /// Units of the level that one square is long, positive.
    pub square: f64,
    /// Pixels of the picture that one square is long.
    pub pixels: u32,
}

/// Most pixels of the picture each way.
const MOST_PIXELS: f64 = 8192.0;

/// Part of its strength which a light still has where its range ends.
const FAINT: f64 = 0.05;

/// Writes a map.
///
/// # Errors
/// Where the picture cannot be drawn, and those of `out`.
pub fn write(
    mut out: impl Write,
    level: &Level,
    known: &Known,
    options: &UvttOptions,
) -> Result<(), UvttError> {
    let lines = Lines::of_level(level, known.graph);
    let map = Map::new(level, &lines, options);
    let chain = |points: Vec<DVec2>| -> Value { points.iter().map(|&p| map.point(p)).collect() };
    let units = |points: Vec<_>| points.into_iter().map(|p| level.grid.to_level(p)).collect();
    let walls: Vec<Value> = (lines.chains(Kind::Wall).into_iter())
        .map(|points| chain(units(points)))
        .collect();
    let solids = lines.solids.iter().map(|corners| {
        let closed = corners.iter().chain(corners.first()).copied().collect();
        chain(units(closed))
    });
    let openings = lines.of(Kind::Door).chain(lines.of(Kind::Window));
    let portals: Vec<Value> = openings.map(|drawn| map.portal(level, drawn)).collect();
    let lights = level
        .scene
        .lights
        .iter()
        .filter_map(|light| map.light(light));
    let document = json!({
        "format": 0.3,
        "software": "enfilade",
        "resolution": {
            "map_origin": { "x": 0.0, "y": 0.0 },
            "map_size": { "x": map.size.x, "y": map.size.y },
            "pixels_per_grid": map.pixels,
        },
        "line_of_sight": walls,
        "objects_line_of_sight": solids.collect::<Vec<Value>>(),
        "portals": portals,
        "environment": { "baked_lighting": false, "ambient_light": "ffffffff" },
        "lights": lights.collect::<Vec<Value>>(),
        "image": base64::engine::general_purpose::STANDARD.encode(picture(&map, known, level, &lines)?),
    });
    serde_json::to_writer(&mut out, &document).map_err(io::Error::from)?;
    Ok(out.write_all(b"\n")?)
}

/// Why no map was written.
#[derive(Debug, thiserror::Error)]
pub enum UvttError {
    /// The picture.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The output.
    #[error(transparent)]
    Write(#[from] io::Error),
}

/// From the level's units to squares of the map.
struct Map {
    /// The upper left corner, in the level's units.
    left: f64,
    top: f64,
    /// The size in squares, whole numbers.
    size: DVec2,
    square: f64,
    pixels: u32,
}

impl Map {
    fn new(level: &Level, lines: &Lines, options: &UvttOptions) -> Self {
        let ends = lines.extent().unwrap_or([GridPoint::new(0, 0); 2]);
        let [low, high] = ends.map(|p| level.grid.to_level(p));
        let square = options.square;
        let size = ((high - low) / square).map(decimal).ceil() + 2.0;
        let most = (MOST_PIXELS / size.max_element()).floor().max(1.0);
        Self {
            left: low.x - square,
            top: low.y + (size.y - 1.0) * square,
            size,
            square,
            pixels: options.pixels.min(most as u32),
        }
    }

    /// In squares from the upper left corner.
    fn at(&self, p: DVec2) -> DVec2 {
        DVec2::new(
            decimal((p.x - self.left) / self.square),
            decimal((self.top - p.y) / self.square),
        )
    }

    fn point(&self, p: DVec2) -> Value {
        let p = self.at(p);
        json!({ "x": p.x, "y": p.y })
    }

    fn portal(&self, level: &Level, drawn: &Drawn) -> Value {
        let [from, to] = drawn.ends.map(|p| level.grid.to_level(p));
        let across = self.at(to) - self.at(from);
        json!({
            "position": self.point(from.midpoint(to)),
            "bounds": [self.point(from), self.point(to)],
            "rotation": across.to_angle(),
            "closed": drawn.shut,
            "freestanding": false,
        })
    }

    fn light(&self, light: &Light) -> Option<Value> {
        let at = match light.shape {
            LightShape::Point { position } | LightShape::Spot { position, .. } => position,
            LightShape::Rectangle { center, .. }
            | LightShape::Disc { center, .. }
            | LightShape::Sphere { center, .. } => center,
            LightShape::Directional { .. } => return None,
        };
        let most = light.intensity.into_iter().fold(0.0, f64::max);
        let byte = |c: f64| (srgb(c / most) * 255.0).round() as u8;
        let [r, g, b] = light.intensity.map(byte);
        Some(json!({
            "position": self.point(at.truncate()),
            "range": (most / FAINT).sqrt() / self.square,
            "intensity": 1.0,
            "color": format!("ff{r:02x}{g:02x}{b:02x}"),
            "shadows": true,
        }))
    }
}

/// Linear light as a screen wants it.
fn srgb(c: f64) -> f64 {
    if c <= 0.003_130_8 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}

/// A PNG of the plan that fits the map's squares exactly.
fn picture(
    map: &Map,
    known: &Known,
    level: &Level,
    lines: &Lines,
) -> Result<Vec<u8>, PictureError> {
    use svg::node::element::{Group, Line, Polygon, Rectangle};
    let shape = |corners: &[DVec2]| {
        let point = |&p: &DVec2| {
            let p = map.at(p);
            format!("{},{}", p.x, p.y)
        };
        let points: Vec<String> = corners.iter().map(point).collect();
        Polygon::new().set("points", points.join(" "))
    };
    let floor = Group::new()
        .set("fill", "#f3efe6")
        .set("stroke", "#f3efe6")
        .set("stroke-width", 0.01);
    let cells = known.graph.cell_ids();
    let floor = cells.fold(floor, |group, cell| {
        group.add(shape(&polygon(known.graph, cell)))
    });
    let solid = lines.solids.iter().fold(Group::new(), |group, corners| {
        let corners: Vec<DVec2> = corners.iter().map(|&p| level.grid.to_level(p)).collect();
        group.add(shape(&corners).set("fill", "#3b3a38"))
    });
    let drawn = |group: Group, kind: Kind, colour: &str| {
        let lines = lines.of(kind).map(|drawn| {
            let [p, q] = drawn.ends.map(|p| map.at(level.grid.to_level(p)));
            let line = Line::new().set("x1", p.x).set("y1", p.y);
            line.set("x2", q.x).set("y2", q.y).set("stroke", colour)
        });
        lines.fold(group, Group::add)
    };
    let walls = Group::new()
        .set("stroke-width", 0.1)
        .set("stroke-linecap", "round");
    let walls = drawn(walls, Kind::Wall, "#3b3a38");
    let walls = drawn(walls, Kind::Door, "#a0622d");
    let walls = drawn(walls, Kind::Window, "#4d9fc4");
    let document = svg::Document::new()
        .set("viewBox", (0, 0, map.size.x, map.size.y))
        .set("width", map.size.x)
        .set("height", map.size.y)
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "#8a8780"),
        )
        .add(floor)
        .add(solid)
        .add(walls);
    picture::png(&document.to_string(), map.size.x as u32 * map.pixels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::file::LevelInfo;

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [10.1, 20, 14.1, 24.3]\n\
        [[room]]\nname = \"B\"\nrect = [14.1, 20, 18.1, 24.3]\n\
        [[pillar]]\nrect = [11, 21, 12, 22]\n\
        [[door]]\npoints = [[14.1, 21], [14.1, 22]]\n\
        [[window]]\npoints = [[12, 20], [13, 20]]\n\
        [[light]]\nkind = \"point\"\nposition = [12.1, 23, 2]\nintensity = 5\ncolor = [1, 0.5, 0]\n";

    fn map(options: UvttOptions) -> Value {
        let level = read(ROOMS.into(), "a.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let known = Known {
            info: &LevelInfo::of(&level),
            level: Some(&level),
            graph: &graph,
            pvs: None,
        };
        let mut bytes = Vec::new();
        write(&mut bytes, &level, &known, &options).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    }

    #[test]
    fn a_map_of_two_rooms() {
        let map = map(UvttOptions {
            square: 1.0,
            pixels: 20,
        });
        // 8 by 4.3 units and a square all around, in whole squares.
        let size = json!({ "x": 10.0, "y": 7.0 });
        assert_eq!(map["resolution"]["map_size"], size);
        // The lower left corner of room A: y goes down from 6 squares above it.
        let text = map["line_of_sight"].to_string();
        assert!(text.contains(r#"{"x":1.0,"y":6.0}"#), "{text}");
        assert!(text.contains(r#"{"x":1.0,"y":1.7}"#), "{text}");
        let portals = map["portals"].as_array().unwrap();
        assert_eq!(portals.len(), 2);
        assert_eq!(
            portals[0]["bounds"],
            json!([{ "x": 5.0, "y": 5.0 }, { "x": 5.0, "y": 4.0 }])
        );
        assert_eq!(
            (&portals[0]["closed"], &portals[1]["closed"]),
            (&true.into(), &false.into())
        );
        assert_eq!(map["objects_line_of_sight"][0].as_array().unwrap().len(), 5);
        let light = &map["lights"][0];
        assert_eq!(light["position"], json!({ "x": 3.0, "y": 3.0 }));
        assert_eq!(
            (&light["range"], &light["color"]),
            (&10.0.into(), &"ffffbc00".into())
        );
        let image = base64::engine::general_purpose::STANDARD
            .decode(map["image"].as_str().unwrap())
            .unwrap();
        let picture = image::load_from_memory(&image).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (200, 140));
        // Floor in room A, the pillar, the outside.
        let at = |x: f64, y: f64| picture.get_pixel((x * 20.0) as u32, (y * 20.0) as u32).0;
        assert_eq!(at(4.0, 3.0), [0xf3, 0xef, 0xe6]);
        assert_eq!(at(2.4, 4.5), [0x3b, 0x3a, 0x38]);
        assert_eq!(at(0.5, 0.5), [0x8a, 0x87, 0x80]);
    }

    #[test]
    fn pictures_stay_small() {
        let map = map(UvttOptions {
            square: 0.01,
            pixels: 70,
        });
        assert_eq!(map["resolution"]["pixels_per_grid"], 10);
        assert_eq!(map["resolution"]["map_size"]["x"], 802.0);
    }
}
