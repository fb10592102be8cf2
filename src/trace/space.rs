//! The level as rays meet it: the cells with their walls, floors, ceilings and steps in floating
//! point.
//!
//! In: a [`Level`] and its [`CellGraph`]. Out: a [`Space`] with the same numbers of cells and edges.
//! Every vertex is rounded once, here; both cells at an edge use the same rounded ends, so that no
//! ray slips through between them.

use glam::{DVec2, DVec3};

use rustc_hash::FxHashMap;

use super::dress::side_at;
use crate::cells::{CellGraph, CellId, Doors, EdgeId};
use crate::geom::Line;
use crate::level::scene::MaterialId;
use crate::level::{Height, Level, Opening, OpeningStyle, WallKind};

/// Cells with flat floors and ceilings, in the level's own unit.
#[derive(Clone, Debug)]
pub struct Space {
    /// Corners of cells on the plan.
    pub vertices: Vec<DVec2>,
    /// By [`CellId`].
    pub cells: Vec<Chamber>,
    /// By [`EdgeId`]: cell after cell, counterclockwise.
    pub edges: Vec<Border>,
}

/// What lies above a cell: a prism from floor to ceiling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chamber {
    /// Its edges are `first..past` of [`Space::edges`].
    pub first: u32,
    /// One past its last edge.
    pub past: u32,
    /// z of the floor; `-∞` in a level without heights.
    pub floor: f64,
    /// z of the ceiling; `∞` in a level without heights.
    pub ceiling: f64,
    /// Whether it is open to the sky: then its ceiling only says where the sky begins.
    pub sky: bool,
}

/// What stands on an edge of a cell: a wall from floor to ceiling, or an opening with what is
/// walled up below and above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Border {
    /// Vertex in which it starts; it ends where the cell's next edge starts.
    pub from: u32,
    /// Vertex in which it ends.
    pub to: u32,
    /// The cell that it bounds, on its left.
    pub cell: u32,
    /// The same edge of the cell beyond; [`WALL`] where there is none.
    pub twin: u32,
    /// Lower end of the opening in z; below it stands the face of a step.
    pub bottom: f64,
    /// Upper end of the opening in z; above it hangs the face of a lintel. Not above `bottom` where
    /// the opening is shut.
    pub top: f64,
    /// What fills the opening, as seen from the edge's cell.
    pub pane: Option<Pane>,
    /// Whether the opening looks out of the level: there is no twin, and light comes in.
    pub outside: bool,
    /// The line that it lies on: edges whose walls lie on one line have the same number.
    pub line: u32,
}

/// What fills an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    /// The glass of a window.
    Glass(MaterialId),
    /// A picture with holes; which it is and where its holes are the level's dress says. Only in a
    /// space made [with gratings](Space::with_gratings).
    Grating,
}

/// Stands for the twin of an edge with nothing beyond.
pub const WALL: u32 = u32::MAX;

/// A surface of a [`Space`]. Ordered; the order decides between surfaces at the same distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Surface {
    /// The floor of a cell.
    Floor(CellId),
    /// The ceiling of a cell.
    Ceiling(CellId),
    /// A wall from floor to ceiling, on the side of the edge's cell.
    Wall(EdgeId),
    /// The wall below an opening.
    Step(EdgeId),
    /// The wall above an opening.
    Lintel(EdgeId),
    /// What fills an opening.
    Pane(EdgeId),
    /// An opening that looks out of the level.
    Outside(EdgeId),
}

/// What a ceiling's material is called where there is no ceiling: `sky` in any case, and Doom's sky.
fn is_sky(name: &str) -> bool {
    name.eq_ignore_ascii_case("sky") || name == "F_SKY1"
}

impl Space {
    /// The space of a level as it starts: everything that moves is where it is at rest, and doors
    /// stand as the graph has them.
    pub fn new(level: &Level, graph: &CellGraph) -> Self {
        let vertices = graph.vertices.iter().map(|v| v.to_level(&graph.grid));
        let cells = graph.cell_ids().map(|id| {
            let edges = graph.edge_range(id);
            let sector = graph.cell(id).sector;
            let sector = sector.and_then(|s| level.sectors.get(s.0 as usize));
            let rest = |height: Height| height.rest;
            Chamber {
                first: edges.start,
                past: edges.end,
                floor: sector.map_or(f64::NEG_INFINITY, |s| rest(s.floor)),
                ceiling: sector.map_or(f64::INFINITY, |s| rest(s.ceiling)),
                sky: sector.is_some_and(|s| s.ceiling_material.as_deref().is_some_and(is_sky)),
            }
        });
        let mut lines: FxHashMap<Line, u32> = FxHashMap::default();
        let mut edges: Vec<Border> = (0..graph.edges.len() as u32)
            .map(|i| {
                let edge = graph.edge(EdgeId(i));
                let wall = edge.wall().map(|w| &level.walls[w.0 as usize]);
                let new = lines.len() as u32;
                let line = wall.and_then(|w| Line::through(w.from, w.to));
                let line = line.map(|line| *lines.entry(line).or_insert(new));
                let out = outside(level, graph, EdgeId(i));
                Border {
                    from: edge.origin.0,
                    to: graph.end(EdgeId(i)).0,
                    cell: edge.cell.0,
                    twin: edge.twin().map_or(WALL, |t| t.0),
                    bottom: out.and_then(|o| o.bottom).unwrap_or(f64::NEG_INFINITY),
                    top: out.and_then(|o| o.top).unwrap_or(f64::INFINITY),
                    pane: pane(level, graph, EdgeId(i)),
                    outside: out.is_some(),
                    line: line.unwrap_or(u32::MAX - i),
                }
            })
            .collect();
        for portal in &graph.portals {
            for edge in portal.edges {
                let border = &mut edges[edge.0 as usize];
                border.bottom = portal.bottom.unwrap_or(f64::NEG_INFINITY);
                border.top = portal.top.unwrap_or(f64::INFINITY);
            }
        }
        Self {
            vertices: vertices.collect(),
            cells: cells.collect(),
            edges,
        }
    }

    /// As [`Space::new`], with the gratings of a Doom map: an opening whose line has a middle texture
    /// on the side of the edge's cell gets a [`Pane::Grating`], over the whole opening.
    pub fn with_gratings(level: &Level, graph: &CellGraph) -> Self {
        let mut space = Self::new(level, graph);
        for (i, border) in (0..).zip(&mut space.edges) {
            let middle = side_at(level, graph, EdgeId(i)).and_then(|(_, side)| side.middle);
            if border.twin != WALL && border.pane.is_none() && middle.is_some() {
                border.pane = Some(Pane::Grating);
            }
        }
        space
    }

    /// The cell's prism.
    #[inline]
    pub fn cell(&self, id: u32) -> &Chamber {
        &self.cells[id as usize]
    }

    /// The edge.
    #[inline]
    pub fn edge(&self, id: u32) -> &Border {
        &self.edges[id as usize]
    }

    /// The edge that follows counterclockwise in the same cell.
    #[inline]
    pub fn next(&self, cell: &Chamber, edge: u32) -> u32 {
        if edge + 1 == cell.past {
            cell.first
        } else {
            edge + 1
        }
    }

    /// The vertex on the plan.
    #[inline]
    pub fn vertex(&self, v: u32) -> DVec2 {
        self.vertices[v as usize]
    }

    /// The unit normal of a surface, towards the side from which it is seen (the edge's cell).
    pub fn normal(&self, surface: Surface) -> DVec3 {
        match surface {
            Surface::Floor(_) => DVec3::Z,
            Surface::Ceiling(_) => DVec3::NEG_Z,
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = self.edge(e.0);
                let along = self.vertex(edge.to) - self.vertex(edge.from);
                along.perp().normalize().extend(0.0)
            }
        }
    }

    /// Whether two surfaces lie in one plane: then no ray that leaves one meets the other.
    pub fn in_one_plane(&self, p: Surface, q: Surface) -> bool {
        match (self.plane(p), self.plane(q)) {
            (Plane::Upright(a), Plane::Upright(b)) => a == b,
            (Plane::Level(a), Plane::Level(b)) => a == b,
            _ => false,
        }
    }

    fn plane(&self, surface: Surface) -> Plane {
        match surface {
            Surface::Floor(c) => Plane::Level(self.cell(c.0).floor),
            Surface::Ceiling(c) => Plane::Level(self.cell(c.0).ceiling),
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => Plane::Upright(self.edge(e.0).line),
        }
    }

    /// Every surface that can be seen, in their order. A wall stands where nothing lies beyond; a
    /// step and a lintel where the opening leaves something of the cell's height.
    pub fn surfaces(&self) -> Vec<Surface> {
        let mut list = Vec::new();
        for (cell, id) in self.cells.iter().zip(0..) {
            if cell.floor.is_finite() {
                list.push(Surface::Floor(CellId(id)));
            }
            if cell.ceiling.is_finite() {
                list.push(Surface::Ceiling(CellId(id)));
            }
        }
        for (edge, id) in self.edges.iter().zip(0..) {
            let (id, cell) = (EdgeId(id), self.cell(edge.cell));
            if edge.twin == WALL {
                list.push(Surface::Wall(id));
                if edge.outside {
                    list.push(Surface::Outside(id));
                }
                continue;
            }
            if edge.bottom > cell.floor {
                list.push(Surface::Step(id));
            }
            if edge.top < cell.ceiling {
                list.push(Surface::Lintel(id));
            }
            if edge.pane.is_some() {
                list.push(Surface::Pane(id));
            }
        }
        list.sort();
        list
    }
}

/// What a surface lies in.
enum Plane {
    /// The line on the plan, by number.
    Upright(u32),
    /// The height.
    Level(f64),
}

/// The opening on an edge, if it leads out of the level and is open.
fn outside<'a>(level: &'a Level, graph: &CellGraph, edge: EdgeId) -> Option<&'a Opening> {
    let edge = graph.edge(edge);
    if edge.twin().is_some() {
        return None;
    }
    let closed = graph.options.doors == Doors::Closed;
    match &level.walls[edge.wall()?.0 as usize].kind {
        WallKind::Opening(opening) => (!(opening.shut && closed)).then_some(opening),
        _ => None,
    }
}

/// The glass in a window, if its opening names a material.
fn pane(level: &Level, graph: &CellGraph, edge: EdgeId) -> Option<Pane> {
    let wall = &level.walls[graph.edge(edge).wall()?.0 as usize];
    match &wall.kind {
        WallKind::Opening(opening) if opening.style == OpeningStyle::Window => {
            wall.material.map(Pane::Glass)
        }
        _ => None,
    }
}
