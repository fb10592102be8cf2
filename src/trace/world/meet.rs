//! Rays through a [`World`]: the nearest thing on a ray's way, and whether light comes through.
//!
//! There are three ways to the same answer, to the last bit: walking from cell to cell, testing
//! everything in turn, and one of the structures over the whole level. Where a surface of the level and an object are met at the same t, the surface
//! counts; of two objects the one with the lower number.

use glam::{DVec2, DVec3};

use super::furniture::Furniture;
use super::{MaterialIndex, World};
use crate::cells::CellId;
use crate::trace::accel::{Bounds, Cast, Contact, Count, Found, Kind, Primitives, Structure, Want};
use crate::trace::brute;
use crate::trace::cast::{Met, Place, entry_of, walk, walk_from};
use crate::trace::ray::{Ray, Start};
use crate::trace::space::{Surface, WALL};

/// From where a ray starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// The cell, and the surface of the level that it leaves.
    pub place: Place,
    /// The object that it leaves or goes into.
    pub start: Option<Start>,
}

impl Departure {
    /// From somewhere within a cell.
    pub fn within(cell: CellId) -> Self {
        Self {
            place: Place { cell, on: None },
            start: None,
        }
    }
}

/// What a ray has met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// A surface of the level.
    Surface(Surface),
    /// An object, by number.
    Object(u32),
}

/// What a ray has met, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// How far along the ray, in multiples of its direction.
    pub t: f64,
    /// The point, on the surface but for rounding.
    pub point: DVec3,
    /// Geometric unit normal: of surfaces of the level into the cell, of objects pointing out.
    pub normal: DVec3,
    /// Unit normal for shading, on the same side.
    pub shading: DVec3,
    /// The material; of what is empty (open windows), none.
    pub material: Option<MaterialIndex>,
    /// Place on a texture, from 0 to 1, of objects; for surfaces of the level see
    /// [`World::place_on`].
    pub uv: DVec2,
    /// The cell in which it is seen.
    pub cell: CellId,
    /// What it is.
    pub what: What,
    /// The part of the object.
    part: u32,
}

impl Hit {
    /// On a surface of the level, be it of what it may.
    #[inline]
    pub(in crate::trace) fn on_surface(
        surface: Surface,
        cell: CellId,
        t: f64,
        point: DVec3,
        normal: DVec3,
    ) -> Self {
        Self {
            t,
            point,
            normal,
            shading: normal,
            material: None,
            uv: DVec2::ZERO,
            cell,
            what: What::Surface(surface),
            part: 0,
        }
    }
}

/// How the nearest thing is found.
#[derive(Clone, Debug, Default)]
enum Way {
    /// By walking from cell to cell.
    #[default]
    Portal,
    /// By testing everything; the structure holds the objects in a row.
    Brute(Furniture),
    /// By a structure over everything.
    Structure(Structure),
}

/// A world with a way to find things in it.
#[derive(Clone, Debug)]
pub struct Tracer<'a> {
    /// The world.
    pub world: &'a World,
    way: Way,
}

/// What stands in the way of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// Nothing.
    None,
    /// Some object.
    Object,
    /// A surface of the level, before any object.
    Surface(Met),
}

/// As much of a hit as it takes to compare.
#[derive(Clone, Copy, Debug)]
pub enum Meeting {
    /// A surface of the level.
    Surface(Met),
    /// An object, in a cell.
    Object(Found, CellId),
}

impl<'a> Tracer<'a> {
    /// A tracer that walks.
    pub fn new(world: &'a World) -> Self {
        Self {
            world,
            way: Way::Portal,
        }
    }

    /// A tracer that tests everything.
    pub fn brute(world: &'a World) -> Self {
        Self {
            world,
            way: Way::Brute(Furniture::all(&world.objects, Kind::Brute, world.reach)),
        }
    }

    /// A tracer with a structure over everything.
    pub fn with_structure(world: &'a World, kind: Kind) -> Self {
        let everything = Everything { world, start: None };
        Self {
            world,
            way: Way::Structure(Structure::within(kind, &everything, world.reach)),
        }
    }

    /// Whether it walks.
    pub fn walks(&self) -> bool {
        matches!(self.way, Way::Portal)
    }

    /// Memory that its structure takes; none for walking, which needs only the cells.
    pub fn bytes(&self) -> usize {
        match &self.way {
            Way::Portal | Way::Brute(_) => 0,
            Way::Structure(structure) => structure.bytes(),
        }
    }

    /// The first thing that the ray meets, up to `limit`.
    #[inline]
    pub fn nearest(&self, ray: &Ray, from: &Departure, limit: f64) -> Option<Meeting> {
        self.nearest_counting(ray, from, limit, &mut ())
    }

    /// As [`Tracer::nearest`], telling every step: a cell walked through counts as a cell, a surface
    /// of the level as a primitive if it was tested by itself.
    pub fn nearest_counting(
        &self,
        ray: &Ray,
        from: &Departure,
        limit: f64,
        count: &mut impl Count,
    ) -> Option<Meeting> {
        match &self.way {
            Way::Portal => {
                let at = (from.place.cell, entry_of(&self.world.space, from.place));
                self.walk(ray, from, at, limit, count)
            }
            Way::Brute(objects) => self.brute_force(objects, ray, from, limit, count),
            Way::Structure(structure) => self.search(structure, ray, from, limit, count),
        }
    }

    /// By walking, for a ray that has come so far without meeting anything: into a cell, through an edge.
    pub(super) fn walk(
        &self,
        ray: &Ray,
        from: &Departure,
        at: (CellId, Option<u32>),
        limit: f64,
        count: &mut impl Count,
    ) -> Option<Meeting> {
        let world = self.world;
        if world.objects.is_empty() {
            let met = walk_from(&world.space, ray, at, limit, |_, _| {
                count.cell();
                limit
            });
            return match met {
                Some(met) if met.t.is_finite() => Some(Meeting::Surface(met)),
                _ if limit.is_finite() => None,
                _ => self.brute_force(&world.all, ray, from, limit, count),
            };
        }
        let mut cast = None;
        let mut best: Option<Found> = None;
        let mut nearest = limit;
        let mut last = at.0;
        let met = walk_from(&world.space, ray, at, limit, |cell, _| {
            count.cell();
            last = cell;
            let furniture = &world.chambers[cell.0 as usize];
            if !furniture.list.is_empty() {
                let cast = cast.get_or_insert_with(|| Cast::new(*ray));
                let start = from.start.as_ref();
                let found = furniture.nearest(&world.objects, cast, start, nearest, count);
                if let Some(found) = found.filter(|f| better(f, best.as_ref())) {
                    nearest = found.contact.t;
                    best = Some(found);
                }
            }
            nearest
        });
        match (met, best) {
            (Some(met), _) if met.t.is_finite() => Some(Meeting::Surface(met)),
            (None, Some(found)) => Some(Meeting::Object(found, last)),
            _ if limit.is_finite() => None,
            // Rounding has led the ray past the cell in which it starts.
            _ => self.brute_force(&world.all, ray, from, limit, count),
        }
    }

    /// Every surface in turn, and the objects.
    fn brute_force(
        &self,
        objects: &Furniture,
        ray: &Ray,
        from: &Departure,
        limit: f64,
        count: &mut impl Count,
    ) -> Option<Meeting> {
        let world = self.world;
        world.surfaces.iter().for_each(|_| count.test());
        let met = brute::nearest(&world.space, &world.surfaces, ray, from.place, limit);
        let mut best: Option<Found> = None;
        if !world.objects.is_empty() {
            let cast = Cast::new(*ray);
            let limit = met.map_or(limit, |m| m.t);
            best = objects.nearest(&world.objects, &cast, from.start.as_ref(), limit, count);
        }
        self.first(met, best, ray, from)
    }

    /// By a structure over everything.
    fn search(
        &self,
        structure: &Structure,
        ray: &Ray,
        from: &Departure,
        limit: f64,
        count: &mut impl Count,
    ) -> Option<Meeting> {
        let world = self.world;
        let n = world.surfaces.len() as u32;
        let everything = Everything {
            world,
            start: Some(from.place),
        };
        let start = from.start.map(|start| Start {
            primitive: start.primitive + n,
            ..start
        });
        let cast = Cast::new(*ray);
        let found = structure.nearest(&everything, &cast, start.as_ref(), limit, count)?;
        if found.primitive >= n {
            let found = Found {
                primitive: found.primitive - n,
                ..found
            };
            return self.first(None, Some(found), ray, from);
        }
        // As exactly as if it had been met alone.
        let surface = [world.surfaces[found.primitive as usize]];
        let met = brute::nearest(&world.space, &surface, ray, from.place, f64::INFINITY)?;
        Some(Meeting::Surface(met))
    }

    /// Of a surface and an object the nearer.
    fn first(
        &self,
        met: Option<Met>,
        object: Option<Found>,
        ray: &Ray,
        from: &Departure,
    ) -> Option<Meeting> {
        match (met, object) {
            (Some(met), Some(object)) if met.t <= object.contact.t => Some(Meeting::Surface(met)),
            (_, Some(object)) => Some(Meeting::Object(object, self.cell_at(ray, from, &object))),
            (met, None) => met.map(Meeting::Surface),
        }
    }

    /// The cell in which a ray has come to an object.
    fn cell_at(&self, ray: &Ray, from: &Departure, object: &Found) -> CellId {
        let mut last = from.place.cell;
        let limit = object.contact.t;
        walk(&self.world.space, ray, from.place, limit, |cell, _| {
            last = cell;
            limit
        });
        last
    }

    /// What the rays of one eye meet before a surface that is known already.
    pub fn before(&self, ray: &Ray, from: &Departure, met: Option<Met>) -> Option<Meeting> {
        let world = self.world;
        let limit = met.map_or(f64::INFINITY, |m| m.t);
        let cast = Cast::new(*ray);
        let start = from.start.as_ref();
        let object = (world.all).nearest(&world.objects, &cast, start, limit, &mut ());
        self.first(met, object, ray, from)
    }

    /// What stands in the way of light, in worlds of which all objects stop it: as
    /// [`Tracer::nearest`], but of several objects any will do.
    pub fn obstacle(&self, ray: &Ray, from: &Departure, limit: f64) -> Obstacle {
        if !self.walks() {
            return match self.nearest(ray, from, limit) {
                Some(Meeting::Surface(met)) => Obstacle::Surface(met),
                Some(Meeting::Object(..)) => Obstacle::Object,
                None => Obstacle::None,
            };
        }
        let world = self.world;
        let mut cast = None;
        let mut stopped = false;
        let met = walk(&world.space, ray, from.place, limit, |cell, until| {
            let furniture = &world.chambers[cell.0 as usize];
            if !furniture.list.is_empty() {
                let cast = cast.get_or_insert_with(|| Cast::new(*ray));
                // What lies beyond this cell may be behind its wall.
                let before = until.min(limit);
                let start = from.start.as_ref();
                stopped = furniture.any(&world.objects, cast, start, before).is_some();
            }
            if stopped { f64::NEG_INFINITY } else { limit }
        });
        match met {
            _ if stopped => Obstacle::Object,
            Some(met) => Obstacle::Surface(met),
            None => Obstacle::None,
        }
    }

    /// All there is to know of what the ray met.
    pub fn hit(&self, ray: &Ray, meeting: &Meeting) -> Hit {
        let world = self.world;
        match meeting {
            Meeting::Surface(met) => {
                let mut point = ray.at(met.t);
                match met.surface {
                    Surface::Floor(c) => point.z = world.space.cell(c.0).floor,
                    Surface::Ceiling(c) => point.z = world.space.cell(c.0).ceiling,
                    _ => {}
                }
                let normal = world.normal(met.surface);
                Hit {
                    material: world.surface_material(met.surface),
                    ..Hit::on_surface(met.surface, met.cell, met.t, point, normal)
                }
            }
            Meeting::Object(found, cell) => {
                let hit = world.objects.hit(ray, found);
                Hit {
                    t: hit.t,
                    point: hit.point,
                    normal: hit.normal,
                    shading: hit.shading,
                    material: Some(world.standing[found.primitive as usize].material),
                    uv: hit.uv,
                    cell: *cell,
                    what: What::Object(found.primitive),
                    part: hit.part,
                }
            }
        }
    }

    /// How a ray starts that goes on from a hit into `direction`.
    pub fn depart(&self, hit: &Hit, direction: DVec3) -> Departure {
        match hit.what {
            What::Surface(surface) => {
                let mut cell = hit.cell;
                // Through a pane it goes on in the cell beyond.
                if let Surface::Pane(e) = surface
                    && hit.normal.dot(direction) < 0.0
                {
                    let twin = self.world.space.edge(e.0).twin;
                    if twin != WALL {
                        cell = CellId(self.world.space.edge(twin).cell);
                    }
                }
                Departure {
                    place: Place {
                        cell,
                        on: Some(surface),
                    },
                    start: None,
                }
            }
            What::Object(number) => Departure {
                place: Place {
                    cell: hit.cell,
                    on: None,
                },
                start: Some(Start {
                    primitive: number,
                    part: hit.part,
                    inwards: hit.normal.dot(direction) < 0.0,
                }),
            },
        }
    }
}

/// Whether an object is met before another.
fn better(found: &Found, best: Option<&Found>) -> bool {
    best.is_none_or(|best| {
        let (a, b) = (found.contact.t, best.contact.t);
        a < b || a == b && found.primitive < best.primitive
    })
}

/// All surfaces of the level, then all objects, for a ray that starts in some place.
struct Everything<'a> {
    world: &'a World,
    start: Option<Place>,
}

impl Primitives for Everything<'_> {
    fn len(&self) -> usize {
        self.world.surfaces.len() + self.world.objects.len()
    }

    fn bounds(&self, primitive: u32) -> Bounds {
        let n = self.world.surfaces.len() as u32;
        if primitive >= n {
            return self.world.objects.bounds(primitive - n);
        }
        surface_bounds(self.world, self.world.surfaces[primitive as usize])
    }

    fn contact<C: Count>(
        &self,
        primitive: u32,
        cast: &Cast,
        from: Option<&Start>,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact> {
        let n = self.world.surfaces.len() as u32;
        if primitive >= n {
            let from = from.map(|start| Start {
                primitive: start.primitive - n,
                ..*start
            });
            let objects = &self.world.objects;
            return objects.contact(primitive - n, cast, from.as_ref(), want, limit, count);
        }
        let surface = [self.world.surfaces[primitive as usize]];
        let start = self.start?;
        let met = brute::nearest(&self.world.space, &surface, &cast.ray, start, limit)?;
        Some(Contact {
            t: met.t,
            part: 0,
            weights: [0.0; 2],
        })
    }
}

/// The box around a surface of the level.
fn surface_bounds(world: &World, surface: Surface) -> Bounds {
    let space = &world.space;
    match surface {
        Surface::Floor(c) | Surface::Ceiling(c) => {
            let cell = space.cell(c.0);
            let z = match surface {
                Surface::Floor(_) => cell.floor,
                _ => cell.ceiling,
            };
            let corners = cell.first..cell.past;
            Bounds::around(corners.map(|e| space.vertex(space.edge(e).from).extend(z)))
        }
        Surface::Wall(e)
        | Surface::Step(e)
        | Surface::Lintel(e)
        | Surface::Pane(e)
        | Surface::Outside(e) => {
            let edge = space.edge(e.0);
            let cell = space.cell(edge.cell);
            let (low, high) = (cell.floor.min(cell.ceiling), cell.ceiling.max(cell.floor));
            Bounds::around([
                space.vertex(edge.from).extend(low),
                space.vertex(edge.to).extend(high),
            ])
        }
    }
}
