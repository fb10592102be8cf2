//! Lights: which cells they can reach, and what shines where the level says nothing.
//!
//! A light reaches a cell if a cell in which it stands sees that cell. The sun, and any other light
//! that stands in no cell, shines from outside: it reaches the cells that see a window to the outside
//! or a court without a ceiling.
//!
//! # Levels without lights
//!
//! Doom sectors have a brightness: it scales the ambient term. Where a level has neither lights nor
//! brightness, a point light hangs in every room that has a name or number of its own: above the
//! middle of the room's largest cell, at four fifths of its height, as bright as it takes to give the
//! floor below it an intensity of about 1.

use glam::{DVec2, DVec3};

use super::furniture::cells_of;
use crate::cells::{CellGraph, CellId};
use crate::level::Level;
use crate::level::scene::{Light, LightShape};
use crate::pvs::Pvs;
use crate::trace::accel::Bounds;
use crate::trace::shadow::Lamp;
use crate::trace::space::Space;

/// Lights and where they reach.
pub(super) struct Lamps {
    pub lights: Vec<Light>,
    /// Which of them shine from outside.
    pub outdoors: Vec<bool>,
    /// By cell, ascending.
    pub lights_of: Vec<Vec<u32>>,
    /// Whether they are the renderer's own.
    pub usual: bool,
}

/// The ambient term of each cell: the brightness of its sector where it has one.
pub(super) fn ambient(level: &Level, graph: &CellGraph, usual: f64) -> Vec<f64> {
    let cells = graph.cells.iter();
    let light = |cell: &crate::cells::Cell| {
        let sector = level.sectors.get(cell.sector?.0 as usize)?;
        sector.light
    };
    // What a sector calls its brightness is meant for a screen: 128 of 255 looks half as bright.
    cells
        .map(|cell| light(cell).map_or(usual, |l| l.powf(2.2)))
        .collect()
}

/// The level's lights, or the usual ones, and which cells they can reach.
pub(super) fn lamps(level: &Level, graph: &CellGraph, space: &Space, pvs: &Pvs) -> Lamps {
    let bright = level.sectors.iter().any(|s| s.light.is_some());
    let usual = level.scene.lights.is_empty() && !bright;
    let lights = if usual {
        room_lights(graph, space)
    } else {
        level.scene.lights.clone()
    };
    let open: Vec<CellId> = (graph.cell_ids())
        .filter(|&id| is_open(space, id))
        .collect();
    let mut outdoors = Vec::new();
    let mut lights_of = vec![Vec::new(); space.cells.len()];
    for (number, light) in (0..).zip(&lights) {
        let own = standing_in(space, &light.shape);
        outdoors.push(own.is_empty());
        let sources = if own.is_empty() { &open } else { &own };
        let mut reached = vec![false; space.cells.len()];
        for &source in sources {
            for cell in pvs.seen_from(source) {
                reached[cell.0 as usize] = true;
            }
        }
        for (list, _) in lights_of.iter_mut().zip(&reached).filter(|(_, r)| **r) {
            list.push(number);
        }
    }
    Lamps {
        lights,
        outdoors,
        lights_of,
        usual,
    }
}

/// Where a light is that shines from one point: in the prism of a cell, and on none of its borders.
pub(super) fn lamp(space: &Space, light: &Light) -> Option<Lamp> {
    let (LightShape::Point { position: at } | LightShape::Spot { position: at, .. }) = light.shape
    else {
        return None;
    };
    let plan = at.truncate();
    let holds = |id: &CellId| {
        let cell = space.cell(id.0);
        let inside = |e: u32| {
            let edge = space.edge(e);
            let (a, b) = (space.vertex(edge.from), space.vertex(edge.to));
            (b - a).perp_dot(plan - a) > 0.0
        };
        cell.floor < at.z && at.z < cell.ceiling && (cell.first..cell.past).all(inside)
    };
    let mut cells = standing_in(space, &light.shape).into_iter();
    cells.find(holds).map(|cell| Lamp { at, cell })
}

/// Whether light from outside comes into a cell at once.
fn is_open(space: &Space, id: CellId) -> bool {
    let cell = space.cell(id.0);
    cell.sky || (cell.first..cell.past).any(|e| space.edge(e).outside)
}

/// The cells in which a light stands; none for one from outside.
fn standing_in(space: &Space, shape: &LightShape) -> Vec<CellId> {
    let bounds = match *shape {
        LightShape::Directional { .. } => return Vec::new(),
        LightShape::Point { position } | LightShape::Spot { position, .. } => {
            Bounds::around([position])
        }
        LightShape::Rectangle { center, edges } => {
            let half = (edges[0].abs() + edges[1].abs()) / 2.0;
            Bounds::around([center - half, center + half])
        }
        LightShape::Disc { center, radius, .. } | LightShape::Sphere { center, radius } => {
            Bounds::around([center - radius, center + radius])
        }
    };
    cells_of(space, &bounds)
}

/// A light for every room.
fn room_lights(graph: &CellGraph, space: &Space) -> Vec<Light> {
    // By sector: its largest cell with the area, and the area of all.
    let mut rooms: Vec<(Option<u32>, CellId, f64, f64)> = Vec::new();
    for id in graph.cell_ids() {
        let sector = graph.cell(id).sector.map(|s| s.0);
        let (_, area) = middle(space, id);
        match rooms.iter_mut().find(|r| r.0 == sector) {
            Some(room) => {
                room.3 += area;
                if area > room.2 {
                    (room.1, room.2) = (id, area);
                }
            }
            None => rooms.push((sector, id, area, area)),
        }
    }
    let high = |(_, id, _, all): (Option<u32>, CellId, f64, f64)| {
        let cell = space.cell(id.0);
        let height = cell.ceiling - cell.floor;
        let above = 0.8 * height;
        let (at, _) = middle(space, id);
        let strength = (above * above).max(all / 8.0);
        (height > 0.0).then(|| Light {
            name: None,
            intensity: [strength, strength * 0.95, strength * 0.86],
            shape: LightShape::Point {
                position: at.extend(cell.floor + above),
            },
        })
    };
    rooms.into_iter().filter_map(high).collect()
}

/// Middle (of mass) and area of a cell on the plan.
pub fn middle(space: &Space, id: CellId) -> (DVec2, f64) {
    let cell = space.cell(id.0);
    let first = space.vertex(space.edge(cell.first).from);
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for e in cell.first..cell.past {
        let edge = space.edge(e);
        let (a, b) = (
            space.vertex(edge.from) - first,
            space.vertex(edge.to) - first,
        );
        let twice = a.perp_dot(b);
        area += twice / 2.0;
        sum += (a + b) * (twice / 6.0);
    }
    (first + sum / area, area)
}

/// Where light seems to come from, for the eye: a blue sky, paler towards the horizon.
pub fn sky(direction: DVec3) -> DVec3 {
    let up = direction.normalize_or(DVec3::Z).z.max(0.0).sqrt();
    let (low, high) = (DVec3::new(0.80, 0.88, 1.0), DVec3::new(0.30, 0.50, 0.92));
    low.lerp(high, up)
}
