//! Maps of virtual table tops: Universal VTT (`.uvtt`, `.dd2vtt`, `.df2vtt`), which is JSON.
//!
//! In: the text of a file. Out: a [`Drawing`], or a [`UvttError`] with line and column.
//!
//! | key | becomes |
//! |---|---|
//! | `resolution` | `map_size` turns y around, so that it goes up; the picture's `pixels_per_grid` does not matter |
//! | `line_of_sight` | walls, without thickness |
//! | `objects_line_of_sight` | walls; a closed one is solid inside |
//! | `portals` | doors between the two `bounds`; `closed` as it says. Where a wall runs on behind one, it is cut |
//! | `lights` | point lights, two thirds up to the ceiling; half as bright as at unit distance at half their `range` |
//! | `image`, `environment`, `software` … | nothing |
//!
//! Some programs write numbers and truth as text (`"7.5"`, `"true"`); both are read.
//!
//! One square of the map's grid is the unit of length, taken for 5 feet where heights are needed.

mod loose;

use glam::{DVec2, DVec3};
use serde::Deserialize;
use thiserror::Error;

use super::draft::{Draft, stem};
use super::drawing::unit::Unit;
use super::drawing::{Drawing, DrawingError, DrawingOptions, Stroke, Symbol, left_out, understand};
use super::finding::{Finding, Place, Severity};
use super::model::OpeningStyle;
use super::scene::{Light, LightShape, Scene};

/// Why a file gives no level.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum UvttError {
    /// No JSON, or other values than the format has.
    #[error("line {line}, column {column}: {message}")]
    Json {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// It is JSON, but no map.
    #[error(
        "the file has neither `line_of_sight` nor `portals`, so it is no Universal VTT map; export the \
         map with its walls"
    )]
    NoMap,
    /// More points than any map has.
    #[error("the file has {count} points of walls; the limit is {limit}")]
    TooMany {
        /// How many it has.
        count: usize,
        /// How many are allowed.
        limit: usize,
    },
    /// It is no level.
    #[error(transparent)]
    Drawing(#[from] DrawingError),
}

/// Most points of all walls together.
const MOST_POINTS: usize = 2_000_000;

#[derive(Deserialize)]
struct File {
    #[serde(default)]
    resolution: Option<Resolution>,
    line_of_sight: Option<Vec<Vec<Point>>>,
    #[serde(default)]
    objects_line_of_sight: Option<Vec<Vec<Point>>>,
    portals: Option<Vec<Portal>>,
    #[serde(default)]
    lights: Option<Vec<Lamp>>,
}

#[derive(Deserialize)]
struct Resolution {
    #[serde(default)]
    map_origin: Option<Point>,
    #[serde(default)]
    map_size: Option<Point>,
}

#[derive(Clone, Copy, Deserialize)]
struct Point {
    #[serde(deserialize_with = "loose::number")]
    x: f64,
    #[serde(deserialize_with = "loose::number")]
    y: f64,
}

#[derive(Deserialize)]
struct Portal {
    #[serde(default)]
    position: Option<Point>,
    #[serde(default)]
    bounds: Vec<Point>,
    #[serde(default, deserialize_with = "loose::maybe_flag")]
    closed: Option<bool>,
}

#[derive(Deserialize)]
struct Lamp {
    position: Point,
    #[serde(default, deserialize_with = "loose::maybe_number")]
    range: Option<f64>,
    #[serde(default, deserialize_with = "loose::maybe_number")]
    intensity: Option<f64>,
    #[serde(default)]
    color: Option<String>,
}

/// Reads a map. `source` is the file's name, without its folder.
///
/// # Errors
/// See [`UvttError`].
pub fn read(text: &str, source: &str, options: &DrawingOptions) -> Result<Draft, UvttError> {
    Ok(understand(drawing(text, source, options)?, options)?)
}

/// Reads a map as far as its lines.
fn drawing(text: &str, source: &str, options: &DrawingOptions) -> Result<Drawing, UvttError> {
    let text = text.trim_start_matches('\u{feff}');
    let file: File = serde_json::from_str(text).map_err(|e| UvttError::Json {
        line: e.line(),
        column: e.column(),
        message: without_place(&e.to_string()),
    })?;
    if file.line_of_sight.is_none() && file.portals.is_none() {
        return Err(UvttError::NoMap);
    }
    let walls = file.line_of_sight.unwrap_or_default();
    let objects = file.objects_line_of_sight.unwrap_or_default();
    let portals = file.portals.unwrap_or_default();
    let count = walls.iter().chain(&objects).map(Vec::len).sum::<usize>() + portals.len();
    if count > MOST_POINTS {
        return Err(UvttError::TooMany {
            count,
            limit: MOST_POINTS,
        });
    }
    let unit = options.unit.clone().unwrap_or(Unit {
        name: "square".to_string(),
        metres: Some(1.524),
        factor: 1.0,
        said_by: "5 feet, as usual",
    });
    let map = Map::new(file.resolution.as_ref(), unit.factor);
    let mut strokes = Vec::new();
    let mut solids = Vec::new();
    for line in walls.iter().chain(&objects) {
        for pair in line.windows(2) {
            strokes.push(map.stroke(pair[0], pair[1]));
        }
    }
    for line in objects.iter().filter(|l| l.len() > 3) {
        let ring: Vec<DVec2> = line.iter().map(|p| map.at(*p)).collect();
        if ring.first() == ring.last() {
            solids.push(vec![ring]);
        }
    }
    let (mut symbols, mut odd) = (Vec::new(), Vec::new());
    for portal in &portals {
        match portal.bounds[..] {
            [a, b] if map.at(a) != map.at(b) => {
                let line = map.stroke(a, b);
                symbols.push(Symbol {
                    style: OpeningStyle::Door,
                    name: None,
                    shut: portal.closed.unwrap_or(true),
                    lines: vec![line],
                    arcs: Vec::new(),
                    place: line.place,
                });
            }
            _ => odd.push(
                portal
                    .bounds
                    .first()
                    .or(portal.position.as_ref())
                    .map_or(Place::Point { x: 0.0, y: 0.0 }, |p| map.place(*p)),
            ),
        }
    }
    let mut findings: Vec<Finding> = Vec::new();
    findings.extend(left_out(
        "ignored",
        Severity::Warning,
        "Left out, as they have no two ends",
        &[("portal".to_string(), odd)],
    ));
    let ceiling = unit.of_metres(3.0);
    let lights = file.lights.unwrap_or_default();
    let lights = lights
        .iter()
        .filter_map(|l| light(&map, l, ceiling))
        .collect();
    Ok(Drawing {
        name: stem(source),
        source: source.to_string(),
        unit,
        strokes,
        symbols,
        solids,
        labels: Vec::new(),
        rounding: 1e-7,
        bodies: false,
        unnamed: false,
        frame: map.frame,
        scene: Scene {
            lights,
            ..Scene::default()
        },
        findings,
    })
}

/// serde_json ends its messages with the place, which we say ourselves.
fn without_place(message: &str) -> String {
    let end = message.rfind(" at line ").unwrap_or(message.len());
    message[..end].to_string()
}

/// From the map's squares, y down, to the level's coordinates, y up.
struct Map {
    bottom: f64,
    factor: f64,
    frame: Option<[DVec2; 2]>,
}

impl Map {
    fn new(resolution: Option<&Resolution>, factor: f64) -> Map {
        let origin = resolution
            .and_then(|r| r.map_origin)
            .unwrap_or(Point { x: 0.0, y: 0.0 });
        let size = resolution.and_then(|r| r.map_size);
        let size = size.filter(|s| s.x > 0.0 && s.y > 0.0 && s.x < 1e9 && s.y < 1e9);
        let mut map = Map {
            bottom: origin.y + size.map_or(0.0, |s| s.y),
            factor,
            frame: None,
        };
        map.frame = size.map(|s| {
            let far = Point {
                x: origin.x + s.x,
                y: origin.y + s.y,
            };
            [origin, far].map(|p| map.at(p))
        });
        map
    }

    fn at(&self, p: Point) -> DVec2 {
        DVec2::new(
            decimal(p.x * self.factor),
            decimal((self.bottom - p.y) * self.factor),
        )
    }

    fn place(&self, p: Point) -> Place {
        let p = self.at(p);
        Place::Point { x: p.x, y: p.y }
    }

    fn stroke(&self, a: Point, b: Point) -> Stroke {
        Stroke {
            from: self.at(a),
            to: self.at(b),
            written: [true; 2],
            place: self.place(a),
        }
    }
}

/// A difference of decimals as the decimal that it is: `8 - 7.7` is 0.3. Numbers beyond a million or
/// with more than nine digits after the point stay as they are.
fn decimal(x: f64) -> f64 {
    let rounded = (x * 1e9).round() / 1e9;
    if x.abs() < 1e6 && (rounded - x).abs() < 1e-10 {
        rounded
    } else {
        x
    }
}

fn light(map: &Map, lamp: &Lamp, ceiling: f64) -> Option<Light> {
    let at = map.at(lamp.position);
    let range = lamp.range.unwrap_or(4.0) * map.factor;
    let strength = lamp.intensity.unwrap_or(1.0) * range * range / 8.0;
    let color = lamp.color.as_deref().and_then(color).unwrap_or([1.0; 3]);
    let intensity = color.map(|c| c * strength);
    let sound = at.is_finite() && intensity.iter().all(|c| (0.0..1e12).contains(c));
    (sound && intensity.iter().any(|c| *c > 0.0)).then_some(Light {
        name: None,
        intensity,
        shape: LightShape::Point {
            position: DVec3::new(at.x, at.y, ceiling * 2.0 / 3.0),
        },
    })
}

/// `ffeccd8b` (opacity first) or `eccd8b`, in linear light.
fn color(text: &str) -> Option<[f64; 3]> {
    let digits = text.trim_start_matches('#');
    let digits = digits.get(digits.len().checked_sub(6)?..)?;
    let value = u32::from_str_radix(digits, 16).ok()?;
    Some([16, 8, 0].map(|shift| {
        let c = f64::from((value >> shift) & 255) / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    }))
}

#[cfg(test)]
mod tests;
