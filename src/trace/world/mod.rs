//! Everything that a ray can meet, and the light that falls on it.
//!
//! In: a [`Level`], its [`CellGraph`] and [`Pvs`], and what the level's files hold (meshes,
//! pictures), read by the caller. Out: a [`World`]: the level's [`Space`] with a material on each
//! surface, the objects and in which cells they stand, the lights and which cells they can reach.
//!
//! | file | what |
//! |---|---|
//! | `paint` | which material is on which surface |
//! | `furniture` | objects as shapes, listed in every cell that they reach into |
//! | `lamps` | which lights a cell can see; lights for levels that have none |
//! | [`meet`] | rays: the nearest thing on a ray's way, and how much light passes |
//! | [`caster`] | the same for many rays at once |

pub mod caster;
mod furniture;
mod lamps;
pub mod meet;
mod paint;

use std::fmt;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

pub use furniture::Standing;
pub use meet::{Departure, Hit, Tracer, What};

use super::accel::{Bounds, Primitives};
use super::dress::{Look, Wardrobe, Wear};
use super::image::Image;
use super::shadow::Lamp;
use super::shapes::Objects;
use super::shapes::mesh::{MeshError, Points};
use super::shapes::polygon::PolygonError;
use super::space::{Pane, Space, Surface};
use crate::cells::{CellGraph, CellId, Locator};
use crate::level::Level;
use crate::level::doom::graphics;
use crate::level::scene::{Light, Material};
use crate::pvs::Pvs;

/// What a level's files hold, by the names under which the level has them.
#[derive(Clone, Debug, Default)]
pub struct Files {
    /// Triangles of the meshes.
    pub meshes: FxHashMap<String, Points>,
    /// Pictures of the materials.
    pub pictures: FxHashMap<String, Image>,
    /// The pictures that the level's dress names, in its order; empty if it has none.
    pub dress: Vec<Option<graphics::Picture>>,
}

/// Index into [`World::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialIndex(pub u32);

/// A level with all that a picture of it needs. Nothing in it depends on a camera.
#[derive(Clone, Debug)]
pub struct World {
    /// Cells, walls, floors and ceilings.
    pub space: Space,
    /// The level's materials, and after them those for walls, floors and ceilings without one.
    pub materials: Vec<Material>,
    /// Pictures of materials.
    pub pictures: Vec<Image>,
    /// By material: its picture in `pictures`.
    pub picture_of: Vec<Option<u32>>,
    paint: paint::Paint,
    /// What surfaces wear instead, in a Doom map.
    pub wardrobe: Option<Wardrobe>,
    /// The objects' shapes, numbered as `standing`.
    pub objects: Objects,
    /// What else there is to say of the objects, in the level's order.
    pub standing: Vec<Standing>,
    /// All objects.
    all: furniture::Furniture,
    /// Objects in each cell.
    chambers: Vec<furniture::Furniture>,
    /// The greatest coordinate of anything, for the margins of structures.
    reach: f64,
    surfaces: Vec<Surface>,
    /// Unit normals of what stands on the edges, into their cells.
    normals: Vec<DVec3>,
    /// The lights: the level's, or if it has none the usual ones.
    pub lights: Vec<Light>,
    /// Where each light is that shines from one point within a cell.
    pub lamps: Vec<Option<Lamp>>,
    /// Whether a light shines from outside of the level, by light.
    pub outdoors: Vec<bool>,
    /// Lights that can reach each cell, ascending.
    lights_of: Vec<Vec<u32>>,
    /// Whether the lights are the renderer's own, for want of others.
    pub usual_lights: bool,
    /// The ambient term Ia, by cell.
    pub ambient: Vec<f64>,
    /// Whether no object lets light pass: then shadow rays may stop at any.
    pub opaque: bool,
}

/// Why a level cannot be made into a world.
#[derive(Clone, Debug, PartialEq)]
pub enum WorldError {
    /// An object's mesh is not among the files.
    NoMesh {
        /// The object.
        object: String,
        /// Its file.
        file: String,
    },
    /// An object's mesh is none.
    Mesh {
        /// The object.
        object: String,
        /// What is wrong.
        error: MeshError,
    },
    /// An object's polygon is none.
    Polygon {
        /// The object.
        object: String,
        /// What is wrong.
        error: PolygonError,
    },
    /// An object's scale, rotation or place makes it vanish.
    Placement {
        /// The object.
        object: String,
    },
    /// The level has no heights.
    Flat,
}

impl fmt::Display for WorldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoMesh { object, file } => {
                write!(f, "{object}: the file {file} of its mesh was not read")
            }
            Self::Mesh { object, error } => write!(f, "{object}: {error}"),
            Self::Polygon { object, error } => write!(f, "{object}: {error}"),
            Self::Placement { object } => write!(
                f,
                "{object}: scaled, turned and moved like this it has no size left; give it a larger \
                 scale"
            ),
            Self::Flat => f.write_str(
                "the level has no floors and ceilings, so there is nothing to draw; give its rooms \
                 heights",
            ),
        }
    }
}

impl std::error::Error for WorldError {}

/// Why there is no picture from an eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EyeError {
    /// It stands in a wall, or outside of the level.
    Outside(DVec3),
    /// It is below the floor or above the ceiling there.
    Height {
        /// The eye.
        eye: DVec3,
        /// z of the floor.
        floor: f64,
        /// z of the ceiling.
        ceiling: f64,
    },
}

impl fmt::Display for EyeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside(eye) => write!(
                f,
                "the eye at {},{} lies in a wall or outside of the level; `enfilade plan` shows \
                 where its inside is",
                eye.x, eye.y
            ),
            Self::Height {
                eye,
                floor,
                ceiling,
            } if floor < ceiling => write!(
                f,
                "the eye at {},{} is at height {}, but there the floor is at {floor} and the \
                 ceiling at {ceiling}; choose a height between them",
                eye.x, eye.y, eye.z
            ),
            Self::Height { eye, floor, .. } => write!(
                f,
                "at {},{} the ceiling lies on the floor, at {floor} (a closed door?); move the eye",
                eye.x, eye.y
            ),
        }
    }
}

impl std::error::Error for EyeError {}

impl World {
    /// Puts a world together. `ambient` is the ambient term of places that have no brightness of
    /// their own.
    pub fn new(
        level: &Level,
        graph: &CellGraph,
        pvs: &Pvs,
        files: &Files,
        ambient: f64,
    ) -> Result<Self, WorldError> {
        let space = Space::with_gratings(level, graph);
        let heights = |c: &super::space::Chamber| c.floor.is_finite() && c.ceiling.is_finite();
        if !space.cells.iter().all(heights) {
            return Err(WorldError::Flat);
        }
        let paint::Palette {
            materials,
            picture_of,
            pictures,
        } = paint::palette(level, files);
        let paint = paint::paint(level, graph, &space);
        let (shapes, standing) = furniture::stand(level, files, &space)?;
        let objects = Objects::new(shapes);
        let reach = furniture::reach(&space, &objects);
        let chambers = furniture::furnish(&space, &objects, &standing, reach);
        let all = furniture::Furniture::all(&objects, furniture::kind(objects.len()), reach);
        let wardrobe = Wardrobe::new(level, graph, &space, files.dress.clone());
        let lamps = lamps::lamps(level, graph, &space, pvs);
        let places = lamps
            .lights
            .iter()
            .map(|l| lamps::lamp(&space, l))
            .collect();
        let see_through = |s: &Standing| {
            let m = &materials[s.material.0 as usize];
            m.transmit > 0.0 || m.emission != [0.0; 3]
        };
        Ok(Self {
            ambient: lamps::ambient(level, graph, ambient),
            opaque: !standing.iter().any(see_through),
            normals: normals(&space),
            surfaces: space.surfaces(),
            space,
            materials,
            pictures,
            picture_of,
            paint,
            wardrobe,
            objects,
            standing,
            all,
            chambers,
            reach,
            lamps: places,
            lights: lamps.lights,
            outdoors: lamps.outdoors,
            lights_of: lamps.lights_of,
            usual_lights: lamps.usual,
        })
    }

    /// The material.
    pub fn material(&self, index: MaterialIndex) -> &Material {
        &self.materials[index.0 as usize]
    }

    /// What a surface is made of; of a pane or a window to the outside that is empty, nothing.
    pub fn surface_material(&self, surface: Surface) -> Option<MaterialIndex> {
        match surface {
            Surface::Floor(c) => Some(self.paint.floors[c.0 as usize]),
            Surface::Ceiling(c) => Some(self.paint.ceilings[c.0 as usize]),
            Surface::Wall(e) | Surface::Step(e) | Surface::Lintel(e) => {
                Some(self.paint.walls[e.0 as usize])
            }
            Surface::Pane(e) | Surface::Outside(e) => match self.space.edge(e.0).pane? {
                Pane::Glass(m) => Some(MaterialIndex(m.0)),
                Pane::Grating => Some(self.paint.walls[e.0 as usize]),
            },
        }
    }

    /// Whether what looks like a surface is the sky.
    pub fn is_sky(&self, surface: Surface) -> bool {
        if let Some(wardrobe) = &self.wardrobe {
            return *wardrobe.wear(surface) == Wear::Sky;
        }
        let sky = |c: CellId| self.space.cell(c.0).sky;
        match surface {
            Surface::Outside(_) => true,
            Surface::Ceiling(c) => sky(c),
            // Between two open courts the sky goes on behind the edge.
            Surface::Lintel(e) => {
                let edge = self.space.edge(e.0);
                sky(CellId(edge.cell)) && sky(CellId(self.space.edge(edge.twin).cell))
            }
            _ => false,
        }
    }

    /// Whether a surface stops all light, whoever asks.
    pub fn stops_light(&self, surface: Surface) -> bool {
        !matches!(surface, Surface::Pane(_)) && !self.is_sky(surface)
    }

    /// The sky's colour in a direction.
    pub fn sky(&self, direction: DVec3) -> DVec3 {
        let own = self.wardrobe.as_ref().and_then(|w| w.sky(direction));
        own.unwrap_or_else(|| lamps::sky(direction))
    }

    /// What a Doom map shows in a point of a surface.
    #[inline]
    pub fn look(&self, hit: &Hit) -> Look {
        match (&self.wardrobe, hit.what) {
            (Some(wardrobe), What::Surface(surface)) => wardrobe.look(surface, hit.point),
            _ => Look::Bare,
        }
    }

    /// The ambient term Ia at a hit.
    #[inline]
    pub fn ambient_at(&self, hit: &Hit) -> f64 {
        match hit.what {
            What::Surface(surface) => self.ambient_on(surface, hit.cell),
            What::Object(_) => self.ambient[hit.cell.0 as usize],
        }
    }

    /// The ambient term Ia on a surface seen from a cell.
    #[inline]
    pub fn ambient_on(&self, surface: Surface, cell: CellId) -> f64 {
        match &self.wardrobe {
            Some(wardrobe) => wardrobe.light(surface),
            None => self.ambient[cell.0 as usize],
        }
    }

    /// Middle (of mass) and area of a cell on the plan.
    pub fn middle(&self, cell: CellId) -> (DVec2, f64) {
        lamps::middle(&self.space, cell)
    }

    /// Every surface of the level.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The unit normal of a surface, into the cell from which it is seen.
    #[inline]
    pub fn normal(&self, surface: Surface) -> DVec3 {
        match surface {
            Surface::Floor(_) => DVec3::Z,
            Surface::Ceiling(_) => DVec3::NEG_Z,
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => self.normals[e.0 as usize],
        }
    }

    /// Lights that can reach a cell.
    pub fn lights_of(&self, cell: CellId) -> &[u32] {
        &self.lights_of[cell.0 as usize]
    }

    /// Objects that reach into a cell, ascending.
    pub fn objects_in(&self, cell: CellId) -> &[u32] {
        &self.chambers[cell.0 as usize].list
    }

    /// Where on a texture a point of a surface lies, in units of the level.
    pub fn place_on(&self, surface: Surface, point: DVec3) -> DVec2 {
        paint::place_on(&self.space, surface, point)
    }

    /// The box around everything.
    pub fn bounds(&self) -> Bounds {
        furniture::bounds(&self.space, &self.objects)
    }
}

/// By edge.
fn normals(space: &Space) -> Vec<DVec3> {
    let edges = (0..space.edges.len() as u32).map(crate::cells::EdgeId);
    edges.map(|e| space.normal(Surface::Wall(e))).collect()
}

/// The cell of an eye, exactly.
pub fn locate(
    world: &World,
    graph: &CellGraph,
    locator: &Locator,
    eye: DVec3,
) -> Result<CellId, EyeError> {
    let outside = EyeError::Outside(eye);
    let point = graph.grid.fine(eye.truncate()).ok_or(outside)?;
    let cells = locator.cells_at(graph, &point);
    let fits = |id: &CellId| {
        let cell = world.space.cell(id.0);
        cell.floor < eye.z && eye.z < cell.ceiling
    };
    // On a portal, a cell that fits.
    if let Some(cell) = cells.iter().copied().find(fits) {
        return Ok(cell);
    }
    let id = cells.first().ok_or(outside)?;
    let cell = world.space.cell(id.0);
    Err(EyeError::Height {
        eye,
        floor: cell.floor,
        ceiling: cell.ceiling,
    })
}
