//! The layers of the plan itself: ground, borders of cells, walls, openings, sightlines.

use std::collections::{BTreeMap, BTreeSet};

use svg::node::element::{Circle, Group, Path};

use super::View;
use super::palette;
use super::sheet::{PathData, Sheet, short};
use crate::cells::{CellGraph, CellId, Doors, EdgeId};
use crate::level::{Level, Opening, OpeningStyle, WallKind};

/// What stands on an edge of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Line {
    /// An opaque wall.
    Wall,
    /// A closed door that counts as a wall.
    ClosedDoor,
    /// A door that lets sight through.
    Door,
    /// A window.
    Window,
    /// An archway.
    Archway,
    /// A change of sector without a wall.
    Step,
    /// A border that only the subdivision made.
    Border,
}

/// The level's lines, sorted by what they are, ready to be drawn.
pub struct Layers<'a> {
    graph: &'a CellGraph,
    sheet: &'a Sheet,
    lines: BTreeMap<Line, PathData>,
    /// Width of walls on the page; other lines are in proportion.
    pub wall: f64,
}

impl<'a> Layers<'a> {
    /// Sorts the edges of the cells.
    pub fn new(level: &Level, graph: &'a CellGraph, sheet: &'a Sheet) -> Self {
        let mut lines: BTreeMap<Line, PathData> = BTreeMap::new();
        let mut drawn = BTreeSet::new();
        let mut lengths = Vec::new();
        for id in (0..graph.edges.len() as u32).map(EdgeId) {
            let (from, to) = (graph.edge(id).origin, graph.end(id));
            if !drawn.insert((from.min(to), from.max(to))) {
                continue;
            }
            let line = line_of(level, graph, id);
            let [p, q] = [from, to].map(|v| sheet.vertex(graph, v));
            if line == Line::Wall {
                lengths.push(p.distance(q));
            }
            lines.entry(line).or_default().segment(p, q);
        }
        let wall = (typical(lengths) * 0.04).clamp(0.9, 2.6);
        Layers {
            graph,
            sheet,
            lines,
            wall,
        }
    }

    /// Whether any edge is of this kind.
    pub fn has(&self, line: Line) -> bool {
        self.lines.contains_key(&line)
    }

    /// The ground, each sector in its colour.
    pub fn sectors(&self, colours: &[&'static str]) -> Group {
        let of_cell = |cell: CellId| match self.graph.cell(cell).sector {
            Some(s) => colours
                .get(s.0 as usize)
                .copied()
                .unwrap_or(palette::NO_SECTOR),
            None => palette::NO_SECTOR,
        };
        self.ground(of_cell)
    }

    /// The ground, coloured by what the source sees.
    pub fn visible(&self, view: &View) -> Group {
        let [source, seen, other] = palette::VIEW;
        let ground = self.ground(|cell| {
            if view.pvs.sees(view.source, cell) {
                seen
            } else {
                other
            }
        });
        ground.add(self.cell(view.source, source))
    }

    /// One cell with a border, so that the smallest is found.
    pub fn cell(&self, cell: CellId, colour: &'static str) -> Path {
        let corners = self.corners(cell);
        let (low, high) = corners
            .iter()
            .fold((corners[0], corners[0]), |(low, high), p| {
                (low.min(*p), high.max(*p))
            });
        let border = if (high - low).min_element() < 6.0 {
            9.0
        } else {
            2.5
        };
        let mut data = PathData::default();
        data.polygon(&corners);
        let path = Path::new().set("d", data.0).set("fill", colour);
        path.set("stroke", colour)
            .set("stroke-width", border)
            .set("stroke-linejoin", "round")
    }

    fn corners(&self, cell: CellId) -> Vec<glam::DVec2> {
        let corners = self.graph.corners(cell);
        corners.map(|v| self.sheet.vertex(self.graph, v)).collect()
    }

    /// One path for each colour, so that no seams show between cells of the same colour.
    pub fn ground(&self, colour: impl Fn(CellId) -> &'static str) -> Group {
        let mut areas: BTreeMap<&str, PathData> = BTreeMap::new();
        for cell in self.graph.cell_ids() {
            areas
                .entry(colour(cell))
                .or_default()
                .polygon(&self.corners(cell));
        }
        areas
            .into_iter()
            .fold(Group::new().set("id", "cells"), |group, (colour, data)| {
                // The thin outline closes the seams between different colours.
                group.add(
                    Path::new()
                        .set("d", data.0)
                        .set("fill", colour)
                        .set("stroke", colour)
                        .set("stroke-width", 0.5),
                )
            })
    }

    /// Borders between cells that only the subdivision made.
    pub fn portals(&self) -> Group {
        let width = (self.wall * 0.3).max(0.35);
        let dashes = format!("{} {}", short(width * 5.0), short(width * 4.0));
        let path = self.path(Line::Border, palette::PORTAL, width);
        let path = path
            .set("stroke-dasharray", dashes)
            .set("stroke-opacity", 0.6);
        Group::new().set("id", "portals").add(path)
    }

    /// Changes of sector without a wall.
    pub fn steps(&self) -> Group {
        let path = self.path(Line::Step, palette::PORTAL, (self.wall * 0.35).max(0.4));
        Group::new()
            .set("id", "steps")
            .add(path.set("stroke-opacity", 0.9))
    }

    /// Walls, and doors that count as such.
    pub fn walls(&self) -> Group {
        let round = |path: Path| path.set("stroke-linecap", "round");
        Group::new()
            .set("id", "walls")
            .add(round(self.path(Line::Wall, palette::WALL, self.wall)))
            .add(round(self.path(
                Line::ClosedDoor,
                palette::CLOSED,
                self.wall * 1.3,
            )))
    }

    /// Doors, windows and archways.
    pub fn openings(&self) -> Group {
        let dots = format!("{} {}", short(self.wall), short(self.wall * 1.2));
        Group::new()
            .set("id", "openings")
            .add(
                self.path(Line::Archway, palette::ARCHWAY, self.wall)
                    .set("stroke-dasharray", dots),
            )
            .add(self.path(Line::Door, palette::DOOR, self.wall * 1.15))
            .add(self.path(Line::Window, palette::WINDOW, self.wall * 1.5))
            .add(self.path(Line::Window, "white", self.wall * 0.6))
    }

    /// Sample sightlines, with a dot where each ends.
    pub fn sightlines(&self, view: &View) -> Group {
        let mut data = PathData::default();
        let mut dots = Group::new().set("fill", palette::SIGHT);
        for line in &view.lines {
            let [from, to] = [line.from, line.to]
                .map(|p| self.sheet.at(glam::DVec2::new(p.x as f64, p.y as f64)));
            data.segment(from, to);
            let dot = Circle::new().set("cx", short(to.x)).set("cy", short(to.y));
            dots = dots.add(dot.set("r", 1.8));
        }
        let path = Path::new()
            .set("d", data.0)
            .set("stroke", palette::SIGHT)
            .set("stroke-width", 0.9)
            .set("stroke-opacity", 0.85)
            .set("fill", "none");
        Group::new().set("id", "sightlines").add(path).add(dots)
    }

    fn path(&self, line: Line, colour: &str, width: f64) -> Path {
        let data = self.lines.get(&line).map_or("", |d| d.0.as_str());
        Path::new()
            .set("d", data)
            .set("stroke", colour)
            .set("stroke-width", short(width))
            .set("fill", "none")
    }
}

/// What stands on an edge.
pub fn line_of(level: &Level, graph: &CellGraph, id: EdgeId) -> Line {
    let edge = graph.edge(id);
    let Some(wall) = edge.wall() else {
        return Line::Border;
    };
    let closed = graph.options.doors == Doors::Closed;
    let sealed = edge.twin().is_none();
    // Openings to the outside have nothing on their other side, but are drawn as what they are.
    match &level.walls[wall.0 as usize].kind {
        WallKind::Opening(Opening { shut: true, .. }) if closed => Line::ClosedDoor,
        WallKind::Opening(opening) => match opening.style {
            OpeningStyle::Door => Line::Door,
            OpeningStyle::Window => Line::Window,
            OpeningStyle::Archway => Line::Archway,
        },
        WallKind::Edge { shut: true } if closed && sealed => Line::ClosedDoor,
        // The edge of a zone that runs along a wall.
        WallKind::Edge { .. } if sealed => Line::Wall,
        WallKind::Edge { shut: true } => Line::Door,
        WallKind::Edge { shut: false } => Line::Step,
        WallKind::Solid | WallKind::Outline => Line::Wall,
    }
}

/// The length for which three quarters of the walls' run is in shorter ones, so that the many short edges of
/// round pillars count little.
fn typical(mut lengths: Vec<f64>) -> f64 {
    lengths.sort_by(f64::total_cmp);
    let most = lengths.iter().sum::<f64>() * 0.75;
    let mut run = 0.0;
    let reached = |&length: &f64| {
        run += length;
        run >= most
    };
    lengths.iter().copied().find(reached).unwrap_or(40.0)
}
