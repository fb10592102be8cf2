//! Objects: their shapes where they stand, and the cells into which they reach.
//!
//! An object is listed in every cell of which the prism (from floor to ceiling) may share a point
//! with the object's box: rather in one too many than in one too few. So wherever a ray meets an
//! object, the object is listed in the cell where the ray is.

use glam::{DMat3, DQuat, DVec2, DVec3, EulerRot};

use super::{Files, MaterialIndex, WorldError, paint};
use crate::cells::CellId;
use crate::level::Level;
use crate::level::scene::{self, Object};
use crate::trace::accel::bvh::Build;
use crate::trace::accel::{
    Bounds, Cast, Contact, Count, Found, Kind, Primitives, Structure, VolumeKind, Want,
};
use crate::trace::ray::Start;
use crate::trace::shapes::mesh::findings::Findings;
use crate::trace::shapes::{
    Cone, Cuboid, Cylinder, Mesh, Objects, Placed, Placement, Polygon, Shape, Solid, Sphere,
};
use crate::trace::space::{Chamber, Space};

/// From this many objects on a cell gets a structure.
const CROWD: usize = 8;

/// An object, apart from its shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// What people call it: its name, or its kind and number.
    pub name: String,
    /// What it is made of.
    pub material: MaterialIndex,
    /// Whether it has an inside, which light that enters it passes through.
    pub solid: bool,
    /// The cells into which it reaches, ascending.
    pub cells: Vec<CellId>,
}

/// Objects in a cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Furniture {
    /// Their numbers, ascending.
    pub list: Vec<u32>,
    structure: Option<Structure>,
}

/// The objects as shapes, and what else there is to say of them.
pub(super) fn stand(
    level: &Level,
    files: &Files,
    space: &Space,
) -> Result<(Vec<Shape>, Vec<Standing>), WorldError> {
    let mut shapes = Vec::new();
    let mut standing = Vec::new();
    for (number, object) in level.scene.objects.iter().enumerate() {
        let name = name(object, number);
        let shape = shape(object, &name, files)?;
        let solid = match &shape {
            Shape::Solid(_) | Shape::Placed(_) => true,
            Shape::Polygon(_) | Shape::Triangle(_) => false,
            Shape::Mesh(mesh) => Findings::of(mesh.points()).is_closed(),
        };
        let bounds = shape.bounds();
        standing.push(Standing {
            name,
            material: paint::object_material(level, object),
            solid,
            cells: cells_of(space, &bounds),
        });
        shapes.push(shape);
    }
    Ok((shapes, standing))
}

/// What to call an object.
fn name(object: &Object, number: usize) -> String {
    let kind = match object.shape {
        scene::Shape::Sphere { .. } => "sphere",
        scene::Shape::Box { .. } => "box",
        scene::Shape::Cylinder { .. } => "cylinder",
        scene::Shape::Cone { .. } => "cone",
        scene::Shape::Polygon { .. } => "polygon",
        scene::Shape::Mesh { .. } => "mesh",
    };
    match &object.name {
        Some(name) => format!("{kind} `{name}`"),
        None => format!("{kind} {}", number + 1),
    }
}

/// The shape in the world.
fn shape(object: &Object, name: &str, files: &Files) -> Result<Shape, WorldError> {
    let [x, y, z] = object.rotation.to_array().map(f64::to_radians);
    // About x first, then y, then z.
    let turn = DQuat::from_euler(EulerRot::ZYX, z, y, x);
    let own = || {
        let placement = Placement::new(object.scale, turn, object.position);
        placement.ok_or_else(|| WorldError::Placement {
            object: name.to_string(),
        })
    };
    let placed = |solid: Solid, placement: Placement| Placed { solid, placement }.into();
    let even = object.scale == DVec3::splat(object.scale.x);
    Ok(match &object.shape {
        scene::Shape::Sphere { radius } if even => Shape::Solid(Solid::Sphere(Sphere {
            centre: object.position,
            radius: radius * object.scale.x,
        })),
        scene::Shape::Sphere { radius } => {
            let solid = Sphere {
                centre: DVec3::ZERO,
                radius: *radius,
            };
            placed(Solid::Sphere(solid), own()?)
        }
        scene::Shape::Box { size } => {
            let half = DVec3::new(size.x / 2.0, size.y / 2.0, 0.0);
            let (low, high) = (-half, half + DVec3::Z * size.z);
            if object.rotation == DVec3::ZERO {
                let at = |p: DVec3| object.position + p * object.scale;
                Shape::Solid(Solid::Cuboid(Cuboid::new(at(low), at(high))))
            } else {
                placed(Solid::Cuboid(Cuboid::new(low, high)), own()?)
            }
        }
        scene::Shape::Cylinder { radius, height } => {
            let solid = Cylinder {
                radius: *radius,
                height: *height,
            };
            placed(Solid::Cylinder(solid), own()?)
        }
        scene::Shape::Cone { radius, height } => {
            // The lecture's cone stands on its tip: turned upside down about the x axis.
            let linear = DMat3::from_quat(turn) * DMat3::from_diagonal(object.scale);
            let upside_down = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
            let tip = object.position + linear * (DVec3::Z * *height);
            let placement = Placement::linear(linear * upside_down, tip);
            let placement = placement.ok_or_else(|| WorldError::Placement {
                object: name.to_string(),
            })?;
            let solid = Cone {
                radius: *radius,
                height: *height,
            };
            placed(Solid::Cone(solid), placement)
        }
        scene::Shape::Polygon { points } => {
            let placement = own()?;
            let corners = points.iter().map(|&p| placement.point(p)).collect();
            let polygon = Polygon::new(corners).map_err(|error| WorldError::Polygon {
                object: name.to_string(),
                error,
            })?;
            polygon.into()
        }
        scene::Shape::Mesh { file } => {
            let points = files.meshes.get(file).ok_or_else(|| WorldError::NoMesh {
                object: name.to_string(),
                file: file.clone(),
            })?;
            let wrong = |error| WorldError::Mesh {
                object: name.to_string(),
                error,
            };
            let kind = kind(points.triangles.len());
            let mesh = Mesh::new(points.clone(), Kind::Brute).map_err(wrong)?;
            mesh.placed(&own()?, kind).map_err(wrong)?.into()
        }
    })
}

/// The structure for so many primitives.
pub(super) fn kind(len: usize) -> Kind {
    if len < CROWD {
        Kind::Brute
    } else {
        Kind::Bvh(Build::MedianCut, VolumeKind::Boxes)
    }
}

/// The greatest coordinate of anything.
pub(super) fn reach(space: &Space, objects: &Objects) -> f64 {
    bounds(space, objects).reach()
}

/// The box around everything.
pub(super) fn bounds(space: &Space, objects: &Objects) -> Bounds {
    let cells = space.cells.iter().map(|cell| around(space, cell));
    let things = (0..objects.len() as u32).map(|i| objects.bounds(i));
    cells
        .chain(things)
        .fold(Bounds::EMPTY, |all, b| all.union(&b))
}

/// The box around a cell's prism.
pub(super) fn around(space: &Space, cell: &Chamber) -> Bounds {
    let corners = (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from));
    let low = cell.floor.min(cell.ceiling);
    let high = cell.ceiling.max(cell.floor);
    Bounds::around(corners.flat_map(|p| [p.extend(low), p.extend(high)]))
}

/// The cells into which a box may reach, ascending.
pub(super) fn cells_of(space: &Space, bounds: &Bounds) -> Vec<CellId> {
    let touches = |cell: &&(u32, &Chamber)| may_touch(space, cell.1, bounds);
    let cells: Vec<(u32, &Chamber)> = (0..).zip(&space.cells).collect();
    cells
        .iter()
        .filter(touches)
        .map(|&(id, _)| CellId(id))
        .collect()
}

/// Whether a box may share a point with a cell's prism. Never denies it where it does: on each axis
/// that might part the two, the gap must be larger than what rounding can make of none.
fn may_touch(space: &Space, cell: &Chamber, bounds: &Bounds) -> bool {
    let prism = around(space, cell);
    // Objects and cells are both known to a few units in the last place; far more is granted.
    let slack = (prism.reach() + bounds.reach()) * 2f64.powi(-40);
    let bounds = bounds.grown(slack);
    if !bounds.touches(&prism) {
        return false;
    }
    let (low, high) = (bounds.min.truncate(), bounds.max.truncate());
    (cell.first..cell.past).all(|e| {
        let edge = space.edge(e);
        let (from, to) = (space.vertex(edge.from), space.vertex(edge.to));
        let along = to - from;
        let inwards = along.perp();
        // The corner of the box that lies farthest inwards.
        let corner = DVec2::new(
            if inwards.x > 0.0 { high.x } else { low.x },
            if inwards.y > 0.0 { high.y } else { low.y },
        );
        inwards.dot(corner - from) >= -slack * along.length()
    })
}

/// Lists the objects in their cells.
pub(super) fn furnish(
    space: &Space,
    objects: &Objects,
    standing: &[Standing],
    reach: f64,
) -> Vec<Furniture> {
    let mut lists = vec![Vec::new(); space.cells.len()];
    for (number, object) in (0u32..).zip(standing) {
        for cell in &object.cells {
            lists[cell.0 as usize].push(number);
        }
    }
    let furniture = |list: Vec<u32>| {
        let some = Listed {
            objects,
            list: &list,
        };
        let structure =
            (!list.is_empty()).then(|| Structure::within(kind(list.len()), &some, reach));
        Furniture { list, structure }
    };
    lists.into_iter().map(furniture).collect()
}

impl Furniture {
    /// The first object that the ray meets, not later than `limit`.
    pub fn nearest(
        &self,
        objects: &Objects,
        cast: &Cast,
        start: Option<&Start>,
        limit: f64,
    ) -> Option<Found> {
        let structure = self.structure.as_ref()?;
        let (some, start) = (self.listed(objects), self.renumber(start));
        let found = structure.nearest(&some, cast, start.as_ref(), limit, &mut ())?;
        Some(self.number(found))
    }

    /// Some object that the ray meets before `before`.
    pub fn any(
        &self,
        objects: &Objects,
        cast: &Cast,
        start: Option<&Start>,
        before: f64,
    ) -> Option<Found> {
        let structure = self.structure.as_ref()?;
        let (some, start) = (self.listed(objects), self.renumber(start));
        let found = structure.any(&some, cast, start.as_ref(), before, &mut ())?;
        Some(self.number(found))
    }

    fn listed<'a>(&'a self, objects: &'a Objects) -> Listed<'a> {
        Listed {
            objects,
            list: &self.list,
        }
    }

    /// From the object's number to its place in the list.
    fn renumber(&self, start: Option<&Start>) -> Option<Start> {
        let start = start?;
        let place = self.list.binary_search(&start.primitive).ok()?;
        Some(Start {
            primitive: place as u32,
            ..*start
        })
    }

    fn number(&self, found: Found) -> Found {
        Found {
            primitive: self.list[found.primitive as usize],
            ..found
        }
    }
}

/// Some of the objects.
struct Listed<'a> {
    objects: &'a Objects,
    list: &'a [u32],
}

impl Primitives for Listed<'_> {
    fn len(&self) -> usize {
        self.list.len()
    }

    #[inline]
    fn bounds(&self, primitive: u32) -> Bounds {
        self.objects.bounds(self.list[primitive as usize])
    }

    #[inline]
    fn contact<C: Count>(
        &self,
        primitive: u32,
        cast: &Cast,
        from: Option<&Start>,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact> {
        let number = self.list[primitive as usize];
        self.objects.contact(number, cast, from, want, limit, count)
    }
}
