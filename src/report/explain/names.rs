//! Names and places of what an explanation speaks of.

use std::collections::BTreeSet;

use glam::DVec2;
use serde::Serialize;
use serde_json::Value;

use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::VertexId;
use crate::level::{Level, OpeningStyle, Place, SectorId, WallId, WallKind};
use crate::pvs::explain::{self, Corner};
use crate::report::json;

/// A portal with its names.
#[derive(Clone, Debug, Serialize)]
pub struct PortalRecord {
    /// `door`, `window`, `archway`, `sector edge` or `border`.
    pub kind: &'static str,
    /// The opening's name.
    pub name: Option<String>,
    /// The opening or see-through wall; none for a border.
    pub wall: Option<WallRecord>,
    /// The cell that is left, and the one that is entered.
    pub cells: [u32; 2],
    /// Their rooms or sectors.
    pub rooms: [Option<String>; 2],
    /// Lower and upper end of the opening in z, with all that moves out of the way.
    pub opening: Option<[f64; 2]>,
    /// Its ends.
    pub segment: [[f64; 2]; 2],
    /// Where it is crossed, or else its middle.
    pub point: [f64; 2],
}

/// A vertex that bounds or blocks sight.
#[derive(Clone, Debug, Serialize)]
pub struct EndRecord {
    /// Where.
    pub point: [f64; 2],
    /// `corner`, `wall` or `cell corner`.
    pub kind: &'static str,
    /// Walls that end there or pass through.
    pub walls: Vec<WallRecord>,
    /// An opening that ends there.
    pub opening: Option<OpeningRecord>,
}

/// An opening.
#[derive(Clone, Debug, Serialize)]
pub struct OpeningRecord {
    /// `door`, `window` or `archway`.
    pub kind: &'static str,
    /// Its name.
    pub name: Option<String>,
    /// Its place in the source.
    #[serde(serialize_with = "place")]
    pub place: Place,
    /// The rooms or sectors on its two sides.
    pub rooms: Vec<String>,
}

/// A wall of the level.
#[derive(Clone, Debug, Serialize)]
pub struct WallRecord {
    /// Its place in the source.
    #[serde(serialize_with = "place")]
    pub place: Place,
    /// Its start.
    pub from: [f64; 2],
    /// Its end.
    pub to: [f64; 2],
    /// The room of whose outline it is a part.
    pub room: Option<String>,
}

fn place<S: serde::Serializer>(place: &Place, serializer: S) -> Result<S::Ok, S::Error> {
    let value: Value = json::place(place);
    value.serialize(serializer)
}

/// Looks up names.
pub struct Names<'a> {
    pub level: &'a Level,
    pub graph: &'a CellGraph,
}

impl Names<'_> {
    /// A place in grid steps, in the level's own coordinates.
    pub fn at(&self, p: DVec2) -> [f64; 2] {
        self.graph.grid.offset_to_level(p.x, p.y).to_array()
    }

    /// A length in grid steps, in the level's unit.
    pub fn length(&self, steps: f64) -> f64 {
        self.graph.grid.step.to_units(steps)
    }

    /// The name of a cell's room, or `sector 12`.
    pub fn room(&self, cell: CellId) -> Option<String> {
        self.sector(self.graph.cell(cell).sector?)
    }

    fn sector(&self, id: SectorId) -> Option<String> {
        let name = self.level.sectors.get(id.0 as usize)?.name.clone();
        Some(name.unwrap_or_else(|| format!("sector {}", id.0)))
    }

    /// The wall that stands on an edge.
    pub fn wall(&self, edge: EdgeId) -> Option<WallRecord> {
        self.graph.edge(edge).wall().map(|w| self.wall_record(w))
    }

    fn wall_record(&self, id: WallId) -> WallRecord {
        let wall = &self.level.walls[id.0 as usize];
        let [from, to] = [wall.from, wall.to].map(|p| self.graph.grid.to_level(p).to_array());
        let outline = wall
            .outline
            .and_then(|o| self.level.outlines[o.0 as usize].sector);
        WallRecord {
            place: wall.place,
            from,
            to,
            room: outline.and_then(|s| self.sector(s)),
        }
    }

    /// Whether a door stands on the portal, shut at rest.
    pub fn is_shut(&self, edge: EdgeId) -> bool {
        let wall = self.graph.edge(edge).wall();
        match wall.map(|w| &self.level.walls[w.0 as usize].kind) {
            Some(WallKind::Opening(opening)) => opening.shut,
            Some(WallKind::Edge { shut }) => *shut,
            _ => false,
        }
    }

    /// Portals with the points where a broken line crosses them.
    pub fn portals(&self, portals: &[EdgeId], line: &[DVec2]) -> Vec<PortalRecord> {
        let crossing = |&e: &EdgeId| self.portal(e, crossing(self.ends_of(e), line));
        portals.iter().map(crossing).collect()
    }

    fn ends_of(&self, edge: EdgeId) -> [DVec2; 2] {
        let graph = self.graph;
        [graph.edge(edge).origin, graph.end(edge)].map(|v| graph.vertices.approx(v))
    }

    /// A portal, and the point where it is crossed, if that is known.
    pub fn portal(&self, edge: EdgeId, crossed: Option<DVec2>) -> PortalRecord {
        let graph = self.graph;
        let wall = graph.edge(edge).wall();
        let (kind, name) = match wall.map(|w| &self.level.walls[w.0 as usize].kind) {
            None => ("border", None),
            Some(WallKind::Opening(opening)) => (style(opening.style), opening.name.clone()),
            Some(WallKind::Edge { shut: true }) => ("door", None),
            Some(_) => ("sector edge", None),
        };
        let beyond = explain::last_cell(graph, graph.edge(edge).cell, &[edge]);
        let cells = [graph.edge(edge).cell, beyond];
        let [p, q] = self.ends_of(edge);
        PortalRecord {
            kind,
            name,
            wall: wall.map(|w| self.wall_record(w)),
            cells: cells.map(|c| c.0),
            rooms: cells.map(|c| self.room(c)),
            opening: self.opening(edge),
            segment: [p, q].map(|p| self.at(p)),
            point: self.at(crossed.unwrap_or_else(|| p.midpoint(q))),
        }
    }

    fn opening(&self, edge: EdgeId) -> Option<[f64; 2]> {
        let first = edge.min(self.graph.edge(edge).twin()?);
        let portals = &self.graph.portals;
        let at = portals.binary_search_by_key(&first, |p| p.edges[0]).ok()?;
        let (bottom, top) = portals[at].widest?;
        Some([bottom, top])
    }

    /// Several ends.
    pub fn ends(&self, vertices: &[VertexId]) -> Vec<EndRecord> {
        vertices.iter().map(|&v| self.end(v)).collect()
    }

    /// A place on a wall between its ends.
    pub fn part_of(&self, wall: EdgeId, at: DVec2) -> EndRecord {
        EndRecord {
            point: self.at(at),
            kind: "wall",
            walls: self.wall(wall).into_iter().collect(),
            opening: None,
        }
    }

    /// A vertex with what stands there.
    pub fn end(&self, vertex: VertexId) -> EndRecord {
        let graph = self.graph;
        let around = explain::edges_at(graph, vertex);
        let corner = around.iter().map(|&e| explain::corner_at(graph, e)).min();
        let at_vertex = |e: &EdgeId| [*e, graph.previous(*e)];
        let touching: Vec<EdgeId> = around.iter().flat_map(at_vertex).collect();
        let wall_of = |e: &EdgeId| graph.edge(*e).wall();
        let solid = touching.iter().filter(|&&e| graph.edge(e).twin().is_none());
        let walls: BTreeSet<WallId> = solid.filter_map(wall_of).collect();
        let place = *graph.vertices.exact(vertex);
        let opening = touching.iter().find_map(|&e| {
            let wall = &self.level.walls[graph.edge(e).wall()?.0 as usize];
            let WallKind::Opening(opening) = &wall.kind else {
                return None;
            };
            let ends_here = [wall.from, wall.to].iter().any(|&p| place == p.into());
            let sides = [Some(e), graph.edge(e).twin()];
            let rooms: BTreeSet<String> = sides
                .iter()
                .flatten()
                .filter_map(|&e| self.room(graph.edge(e).cell))
                .collect();
            ends_here.then(|| OpeningRecord {
                kind: style(opening.style),
                name: opening.name.clone(),
                place: wall.place,
                rooms: rooms.into_iter().collect(),
            })
        });
        EndRecord {
            point: self.at(graph.vertices.approx(vertex)),
            kind: match corner {
                Some(Corner::Jutting) => "corner",
                Some(Corner::Flat) => "wall",
                Some(Corner::Open) | None => "cell corner",
            },
            walls: walls.into_iter().map(|w| self.wall_record(w)).collect(),
            opening,
        }
    }
}

fn style(style: OpeningStyle) -> &'static str {
    match style {
        OpeningStyle::Door => "door",
        OpeningStyle::Window => "window",
        OpeningStyle::Archway => "archway",
    }
}

/// Where a broken line first crosses a segment, its ends included.
fn crossing([p, q]: [DVec2; 2], line: &[DVec2]) -> Option<DVec2> {
    line.windows(2).find_map(|part| {
        let (f, g) = ((q - p).perp_dot(part[0] - p), (q - p).perp_dot(part[1] - p));
        let (h, k) = (
            (part[1] - part[0]).perp_dot(p - part[0]),
            (part[1] - part[0]).perp_dot(q - part[0]),
        );
        let meets = f * g <= 0.0 && h * k <= 0.0 && f != g;
        meets.then(|| part[0].lerp(part[1], f / (f - g)))
    })
}
