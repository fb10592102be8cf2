//! Which material is on which surface, and where a point lies on it.
//!
//! A wall between two rooms has two sides, each with its own room's material: of the walls that lie
//! on an edge, the one counts whose side towards the edge's cell belongs to the cell's sector; then
//! one that stands free; then any.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::{Files, MaterialIndex};
use crate::cells::{CellGraph, EdgeId};
use crate::geom::Line;
use crate::level::scene::{Material, Object};
use crate::level::{Level, SectorId, Wall, WallKind};
use crate::trace::image::Image;
use crate::trace::space::{Space, Surface};

/// Materials by surface.
#[derive(Clone, Debug)]
pub(super) struct Paint {
    /// By cell.
    pub floors: Vec<MaterialIndex>,
    /// By cell.
    pub ceilings: Vec<MaterialIndex>,
    /// By edge.
    pub walls: Vec<MaterialIndex>,
}

/// What the renderer gives surfaces and objects without a material: name and diffuse colour. They
/// follow the level's own in this order.
const USUAL: [(&str, [f64; 3]); 4] = [
    ("usual wall", [0.78, 0.75, 0.69]),
    ("usual floor", [0.52, 0.46, 0.39]),
    ("usual ceiling", [0.86, 0.86, 0.84]),
    ("usual object", [0.7, 0.7, 0.72]),
];
const WALL: u32 = 0;
const FLOOR: u32 = 1;
const CEILING: u32 = 2;
const OBJECT: u32 = 3;

fn usual(level: &Level, which: u32) -> MaterialIndex {
    MaterialIndex(level.scene.materials.len() as u32 + which)
}

/// All materials, with their pictures.
pub(super) struct Palette {
    pub materials: Vec<Material>,
    pub picture_of: Vec<Option<u32>>,
    pub pictures: Vec<Image>,
}

/// The level's materials and the usual ones.
pub(super) fn palette(level: &Level, files: &Files) -> Palette {
    let mut materials = level.scene.materials.clone();
    materials.extend(USUAL.map(|(name, diffuse)| Material {
        name: name.to_string(),
        diffuse,
        specular: [0.0; 3],
        shininess: 1.0,
        mirror: 0.0,
        transmit: 0.0,
        ior: 1.5,
        roughness: 0.0,
        emission: [0.0; 3],
        texture: None,
    }));
    let mut pictures = Vec::new();
    let mut numbers: FxHashMap<&str, u32> = FxHashMap::default();
    let mut number = |file| -> Option<u32> {
        let image = files.pictures.get(file)?;
        Some(*numbers.entry(file).or_insert_with(|| {
            pictures.push(image.clone());
            pictures.len() as u32 - 1
        }))
    };
    let mut picture_of = Vec::with_capacity(materials.len());
    for material in &level.scene.materials {
        picture_of.push(material.texture.as_ref().and_then(|t| number(&t.file)));
    }
    picture_of.resize(materials.len(), None);
    Palette {
        materials,
        picture_of,
        pictures,
    }
}

/// What an object is made of.
pub(super) fn object_material(level: &Level, object: &Object) -> MaterialIndex {
    let own = object.material.map(|m| MaterialIndex(m.0));
    own.unwrap_or(usual(level, OBJECT))
}

/// Looks for the material of every surface.
pub(super) fn paint(level: &Level, graph: &CellGraph, space: &Space) -> Paint {
    let named = |name: Option<&String>, which| {
        let index = name.and_then(|name| {
            let materials = &level.scene.materials;
            materials.iter().position(|m| m.name == *name)
        });
        index.map_or(usual(level, which), |i| MaterialIndex(i as u32))
    };
    let by_sector: Vec<[MaterialIndex; 2]> = (level.sectors.iter())
        .map(|s| {
            [
                named(s.floor_material.as_ref(), FLOOR),
                named(s.ceiling_material.as_ref(), CEILING),
            ]
        })
        .collect();
    let of_cell = |which: usize| -> Vec<MaterialIndex> {
        let usual = [usual(level, FLOOR), usual(level, CEILING)][which];
        let cells = graph.cells.iter();
        cells
            .map(|c| {
                let sector = c.sector.and_then(|s| by_sector.get(s.0 as usize));
                sector.map_or(usual, |m| m[which])
            })
            .collect()
    };
    let mut on_line: FxHashMap<Line, Vec<&Wall>> = FxHashMap::default();
    for wall in &level.walls {
        let opening = matches!(wall.kind, WallKind::Opening(_));
        if let (Some(line), false, true) = (
            Line::through(wall.from, wall.to),
            opening,
            wall.material.is_some(),
        ) {
            on_line.entry(line).or_default().push(wall);
        }
    }
    let walls = (0..space.edges.len() as u32).map(|e| {
        let found = wall_at(level, graph, &on_line, EdgeId(e));
        let material = found.and_then(|w| w.material);
        material.map_or(usual(level, WALL), |m| MaterialIndex(m.0))
    });
    Paint {
        floors: of_cell(0),
        ceilings: of_cell(1),
        walls: walls.collect(),
    }
}

/// The wall of which one sees the surface on an edge.
fn wall_at<'a>(
    level: &Level,
    graph: &CellGraph,
    on_line: &FxHashMap<Line, Vec<&'a Wall>>,
    id: EdgeId,
) -> Option<&'a Wall> {
    let edge = graph.edge(id);
    let own = &level.walls[edge.wall()?.0 as usize];
    let walls = on_line.get(&Line::through(own.from, own.to)?)?;
    let ends = [edge.origin, graph.end(id)].map(|v| graph.vertices.approx(v));
    let middle = (ends[0] + ends[1]) / 2.0;
    let sector = graph.cell(edge.cell).sector;
    let covers = |wall: &&&Wall| {
        let [from, to] = [wall.from, wall.to].map(|p| DVec2::new(p.x as f64, p.y as f64));
        (middle - from).dot(to - from) >= 0.0 && (middle - to).dot(from - to) >= 0.0
    };
    let rank = |wall: &&&Wall| {
        let along = |w: &Wall| DVec2::new((w.to.x - w.from.x) as f64, (w.to.y - w.from.y) as f64);
        let same_way = along(wall).dot(ends[1] - ends[0]) > 0.0;
        let (near, far) = if same_way {
            (wall.left, wall.right)
        } else {
            (wall.right, wall.left)
        };
        side_rank(sector, near, far)
    };
    walls.iter().filter(covers).min_by_key(rank).copied()
}

/// How much a wall is the one that a cell of this sector sees, least first.
fn side_rank(own: Option<SectorId>, near: Option<SectorId>, far: Option<SectorId>) -> u32 {
    match (near, far) {
        (Some(near), _) if Some(near) == own => 0,
        (None, None) => 1,
        (Some(_), _) => 2,
        (None, Some(_)) => 3,
    }
}

/// Where on a texture a point of a surface lies, in units of the level: on floors and ceilings the
/// place on the plan, on walls the way along the wall, to the right, and the height.
pub(super) fn place_on(space: &Space, surface: Surface, point: DVec3) -> DVec2 {
    match surface {
        Surface::Floor(_) => point.truncate(),
        Surface::Ceiling(_) => DVec2::new(point.x, -point.y),
        Surface::Wall(e)
        | Surface::Step(e)
        | Surface::Lintel(e)
        | Surface::Pane(e)
        | Surface::Outside(e) => {
            let edge = space.edge(e.0);
            // Seen from the cell, on the left of the edge, its start lies on the right. The way is
            // counted from the foot of the perpendicular from the origin, so that pieces of one wall
            // go on where the last one ends.
            let along = (space.vertex(edge.from) - space.vertex(edge.to)).normalize();
            DVec2::new(along.dot(point.truncate()), point.z)
        }
    }
}
