//! The JSON of `build`: level, cells, portals and visible sets, for programs in any language.
//!
//! In: a level, its cells and its PVS. Out: one JSON object, written as it is made, since a large
//! map has millions of numbers. One cell, portal or visible set stands on a line. Numbers are
//! written with as many digits as it takes to read the same f64 back; coordinates are the level's
//! own.

use std::io::{self, Write};

use glam::DVec2;
use serde::ser::{SerializeMap, SerializeStruct};
use serde::{Serialize, Serializer};
use serde_json::ser::Formatter;
use serde_json::{Value, json};

use crate::cells::{CellGraph, CellId, Portal};
use crate::geom::VertexId;
use crate::level::{Level, Place, Sector};
use crate::pvs::Pvs;
use crate::pvs::file::LevelInfo;

/// How long each stage took, in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Reading the level.
    pub read: f64,
    /// Cutting it into cells.
    pub subdivide: f64,
    /// Finding who sees whom.
    pub visibility: f64,
    /// Writing the files that were complete before the JSON.
    pub write: f64,
}

/// Writes the JSON object, and a line feed after it.
///
/// # Errors
/// Those of `out`.
pub fn write(
    out: impl Write,
    level: &Level,
    graph: &CellGraph,
    pvs: &Pvs,
    seconds: &Seconds,
) -> io::Result<()> {
    let info = LevelInfo::of(level);
    write_known(out, &info, &level.sectors, graph, pvs, seconds)
}

/// As [`write()`], of what a `.pvs` file says of its level; without the sectors, cells have no heights.
///
/// # Errors
/// Those of `out`.
pub fn write_known(
    out: impl Write,
    info: &LevelInfo,
    sectors: &[Sector],
    graph: &CellGraph,
    pvs: &Pvs,
    seconds: &Seconds,
) -> io::Result<()> {
    let document = Document {
        info,
        sectors,
        graph,
        pvs,
        seconds,
    };
    write_lines(out, &document)
}

/// Writes an object with a line for each of its keys, and for each element of an array there.
pub(super) fn write_lines(out: impl Write, document: &impl Serialize) -> io::Result<()> {
    let mut serializer = serde_json::Serializer::with_formatter(out, Lines::default());
    document.serialize(&mut serializer)?;
    serializer.into_inner().write_all(b"\n")
}

/// A cell's corners in the level's own coordinates: convex, counterclockwise, without repeated
/// points and without corners that rounding to f64 has put in line with their neighbours.
pub fn polygon(graph: &CellGraph, cell: CellId) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = graph
        .polygon(cell)
        .into_iter()
        .map(|v| position(graph, v))
        .collect();
    points.dedup();
    while points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let mut i = 0;
    while points.len() > 3 && i < points.len() {
        let n = points.len();
        let (p, q, r) = (points[(i + n - 1) % n], points[i], points[(i + 1) % n]);
        if (q - p).perp_dot(r - q) > 0.0 {
            i += 1;
        } else {
            points.remove(i);
        }
    }
    points
}

/// A place in the source: an object with the keys of its kind.
pub fn place(place: &Place) -> Value {
    match *place {
        Place::Text { line, column } => json!({ "line": line, "column": column }),
        Place::Linedef(n) => json!({ "linedef": n }),
        Place::Sidedef(n) => json!({ "sidedef": n }),
        Place::Sector(n) => json!({ "sector": n }),
        Place::Vertex(n) => json!({ "vertex": n }),
        Place::Thing(n) => json!({ "thing": n }),
        Place::Point { x, y } => json!({ "x": x, "y": y }),
    }
}

/// A vertex in the level's own coordinates.
fn position(graph: &CellGraph, v: VertexId) -> DVec2 {
    graph.vertices.exact(v).to_level(&graph.grid)
}

struct Document<'a> {
    info: &'a LevelInfo,
    sectors: &'a [Sector],
    graph: &'a CellGraph,
    pvs: &'a Pvs,
    seconds: &'a Seconds,
}

impl Serialize for Document<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Document {
            info,
            sectors,
            graph,
            pvs,
            seconds,
        } = self;
        let mut map = serializer.serialize_map(None)?;
        head(&mut map, "enfilade.pvs", info, graph, pvs)?;
        map.serialize_entry("seconds", seconds)?;
        map.serialize_entry(
            "cells",
            &each(graph.cell_ids().map(|id| cell(sectors, graph, id))),
        )?;
        map.serialize_entry(
            "portals",
            &each(graph.portals.iter().map(|p| portal(graph, p))),
        )?;
        let row = |id| each(pvs.seen_from(id).map(|c| c.0));
        map.serialize_entry("visible", &each(graph.cell_ids().map(row)))?;
        map.end()
    }
}

/// The keys with which all documents about a PVS begin.
pub(super) fn head<M: SerializeMap>(
    map: &mut M,
    format: &str,
    info: &LevelInfo,
    graph: &CellGraph,
    pvs: &Pvs,
) -> Result<(), M::Error> {
    map.serialize_entry("format", format)?;
    map.serialize_entry("version", &1)?;
    map.serialize_entry("level", &LevelHead(info))?;
    map.serialize_entry("subdivision", graph.options.subdivision.as_str())?;
    map.serialize_entry("visibility", &Visibility { graph, pvs })
}

struct LevelHead<'a>(&'a LevelInfo);

impl Serialize for LevelHead<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let level = self.0;
        let mut head = serializer.serialize_struct("level", 7)?;
        head.serialize_field("name", &level.name)?;
        head.serialize_field("source", &level.source)?;
        head.serialize_field("unit", &level.unit)?;
        head.serialize_field("vertices", &level.vertices)?;
        head.serialize_field("walls", &level.walls)?;
        head.serialize_field("sectors", &level.sectors)?;
        head.serialize_field("snap", &level.snap)?;
        head.end()
    }
}

struct Visibility<'a> {
    graph: &'a CellGraph,
    pvs: &'a Pvs,
}

impl Serialize for Visibility<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Visibility { graph, pvs } = self;
        let mut head = serializer.serialize_struct("visibility", 8)?;
        head.serialize_field("method", pvs.method.as_str())?;
        head.serialize_field("class", pvs.class.as_str())?;
        head.serialize_field("heights", &pvs.heights)?;
        head.serialize_field("doors", graph.options.doors.as_str())?;
        head.serialize_field("pairs", &pvs.pairs())?;
        head.serialize_field("density", &pvs.density())?;
        head.serialize_field("undecided", &pvs.undecided)?;
        head.serialize_field("steps", &pvs.steps)?;
        head.end()
    }
}

#[derive(Serialize)]
struct CellRecord {
    sector: Option<u32>,
    floor: Option<f64>,
    ceiling: Option<f64>,
    polygon: Vec<[f64; 2]>,
}

fn cell(sectors: &[Sector], graph: &CellGraph, id: CellId) -> CellRecord {
    let sector_id = graph.cell(id).sector;
    let sector: Option<&Sector> = sector_id.and_then(|s| sectors.get(s.0 as usize));
    CellRecord {
        sector: sector_id.map(|s| s.0),
        floor: sector.map(|s| s.floor.rest),
        ceiling: sector.map(|s| s.ceiling.rest),
        polygon: polygon(graph, id)
            .into_iter()
            .map(|p| p.to_array())
            .collect(),
    }
}

/// A portal as other programs are told of it.
#[derive(Serialize)]
pub(super) struct PortalRecord {
    cells: [u32; 2],
    segment: [[f64; 2]; 2],
    bottom: Option<f64>,
    top: Option<f64>,
}

pub(super) fn portal(graph: &CellGraph, portal: &Portal) -> PortalRecord {
    let [first, _] = portal.edges;
    let ends = [graph.edge(first).origin, graph.end(first)];
    PortalRecord {
        cells: graph.joined(portal).map(|c| c.0),
        segment: ends.map(|v| position(graph, v).to_array()),
        bottom: portal.bottom,
        top: portal.top,
    }
}

/// An iterator as a JSON array. It is used up when serialised.
pub(super) struct Each<I>(std::cell::RefCell<I>);

/// The items as an array.
pub(super) fn each<I: Iterator>(items: I) -> Each<I> {
    Each(items.into())
}

impl<I: Iterator<Item: Serialize>> Serialize for Each<I> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&mut *self.0.borrow_mut())
    }
}

/// Puts every key of the outer object, and every element of an array there, on a line of its own.
#[derive(Default)]
struct Lines {
    /// How many objects and arrays are open.
    depth: usize,
}

impl Lines {
    fn separate<W: ?Sized + Write>(
        &self,
        out: &mut W,
        first: bool,
        depth: usize,
    ) -> io::Result<()> {
        if !first {
            out.write_all(b",")?;
        }
        if self.depth <= depth {
            out.write_all(b"\n")
        } else {
            Ok(())
        }
    }
}

impl Formatter for Lines {
    fn begin_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth += 1;
        out.write_all(b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth -= 1;
        out.write_all(b"]")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.separate(out, first, 2)
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth += 1;
        out.write_all(b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth -= 1;
        out.write_all(if self.depth == 0 { b"\n}" } else { b"}" })
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.separate(out, first, 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::{Progress, sweep::sweep};

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 0.1, 4]\n\
        [[room]]\nname = \"B\"\nrect = [0.1, 0, 8, 4]\nceiling = 2.5\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\nheight = 2\n";

    #[test]
    fn two_rooms_in_full() {
        let level = read(ROOMS.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let pvs = sweep(&graph, &Progress::default());
        let mut text = Vec::new();
        write(&mut text, &level, &graph, &pvs, &Seconds::default()).unwrap();
        let json: Value = serde_json::from_slice(&text).unwrap();
        assert_eq!(json["format"], "enfilade.pvs");
        assert_eq!(json["level"]["name"], "rooms");
        assert_eq!(json["level"]["snap"], 0.0);
        assert_eq!(json["visibility"]["class"], "exact");
        assert_eq!(json["visibility"]["pairs"], 4);
        assert_eq!(json["visible"], serde_json::json!([[0, 1], [0, 1]]));
        let cells = json["cells"].as_array().unwrap();
        let b = cells.iter().find(|c| c["sector"] == 1).unwrap();
        assert_eq!(b["ceiling"], 2.5);
        let corner = serde_json::json!([0.1, 4.0]);
        assert!(b["polygon"].as_array().unwrap().contains(&corner), "{b}");
        let portal = &json["portals"][0];
        assert_eq!(
            (&portal["bottom"], &portal["top"]),
            (&0.0.into(), &2.0.into())
        );
        // A line for each key, cell, portal and visible set.
        assert_eq!(text.iter().filter(|&&b| b == b'\n').count(), 1 + 9 + 5 + 1);
    }

    #[test]
    fn polygons_are_convex_after_rounding() {
        let round = "[[room]]\nname = \"A\"\nrect = [0, 0, 20, 20]\n\
            [[pillar]]\ncenter = [7.1, 8.3]\nradius = 3\nsides = 31\n";
        let level = read(round.into(), "round.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        for cell in graph.cell_ids() {
            let corners = polygon(&graph, cell);
            let n = corners.len();
            assert!(n >= 3);
            for i in 0..n {
                let (p, q, r) = (corners[i], corners[(i + 1) % n], corners[(i + 2) % n]);
                assert!((q - p).perp_dot(r - q) > 0.0);
            }
        }
    }
}
