//! Objects, which are no polygons of the level: in their cells' turn, by rays.
//!
//! A cell is convex, so what stands in it is before everything that was painted up to its walls, and behind
//! everything that comes after it. Among themselves the objects of a cell have no order; for each pixel
//! of the window in which they may show, a ray picks the nearest. An object that reaches into several
//! cells is cut at their borders: a ray counts between where it enters the cell and where it leaves
//! it. Both cells at a border compute that number from the same ends, so that nothing is lost between
//! them.

use glam::DVec3;
use smallvec::SmallVec;

use super::coat::{self, Coats, Finish, Packed, dim};
use super::fill::{faded, through};
use super::view::View;
use crate::cells::CellId;
use crate::trace::accel::{Cast, Found, Primitives, Want};
use crate::trace::ray::Ray;
use crate::trace::space::Space;
use crate::trace::world::World;

/// The objects of a cell, as a camera sees them.
#[derive(Clone, Copy, Debug)]
pub struct Standing {
    /// The cell.
    pub cell: CellId,
    /// Rows in which they may show.
    pub rows: (u32, u32),
    /// Columns in which they may show.
    pub columns: (u32, u32),
    /// A stretch of a list of windows.
    windows: (u32, u32),
    /// Light in the cell.
    light: f64,
}

/// Where an object may show.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    object: u32,
    rows: (u32, u32),
    columns: (u32, u32),
}

/// What a pixel shows of an object.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The object.
    pub object: u32,
    paint: Paint,
}

#[derive(Clone, Copy, Debug)]
enum Paint {
    Opaque(Packed),
    Glass(Packed, Packed),
}

impl Spot {
    /// Whether what is behind shows through.
    pub fn is_clear(&self) -> bool {
        matches!(self.paint, Paint::Glass(..))
    }

    /// On what was painted before.
    pub fn over(&self, behind: Packed) -> Packed {
        match self.paint {
            Paint::Opaque(colour) => colour,
            Paint::Glass(tint, own) => through(behind, tint, own),
        }
    }
}

/// The objects of a cell, if there are any that may show. Their windows are added to `windows`.
pub fn show(
    world: &World,
    view: &View,
    cell: CellId,
    windows: &mut Vec<Window>,
) -> Option<Standing> {
    let chamber = world.space.cell(cell.0);
    let first = windows.len();
    for &object in world.objects_in(cell) {
        let bounds = world.objects.bounds(object);
        let (low, high) = (bounds.min, bounds.max);
        let z = [low.z.max(chamber.floor), high.z.min(chamber.ceiling)];
        let corners: SmallVec<[DVec3; 8]> = (0..8usize)
            .map(|k| {
                let pick = |bit: u32, a: f64, b: f64| if k >> bit & 1 == 0 { a } else { b };
                DVec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), z[k >> 2])
            })
            .collect();
        let window = view.window(&corners, false);
        windows.extend(window.map(|(rows, columns)| Window {
            object,
            rows,
            columns,
        }));
    }
    let join = |a: (u32, u32), b: (u32, u32)| (a.0.min(b.0), a.1.max(b.1));
    let all = windows[first..].iter().copied().reduce(|a, b| Window {
        object: a.object,
        rows: join(a.rows, b.rows),
        columns: join(a.columns, b.columns),
    })?;
    Some(Standing {
        cell,
        rows: all.rows,
        columns: all.columns,
        windows: (first as u32, windows.len() as u32),
        light: coat::light_in(world, cell),
    })
}

/// What a pixel shows of a cell's objects: the nearest that is not of glass, and of what is of glass
/// and before it, the nearest.
pub fn spot(
    (world, coats, view): (&World, &Coats, &View),
    (standing, windows): (&Standing, &[Window]),
    (x, y): (u32, u32),
    finish: Finish,
) -> Option<Spot> {
    let within = |at: u32, (first, past): (u32, u32)| first <= at && at < past;
    let mut near = windows[standing.windows.0 as usize..standing.windows.1 as usize]
        .iter()
        .filter(|w| within(x, w.columns) && within(y, w.rows))
        .map(|w| w.object)
        .peekable();
    near.peek()?;
    let ray = view.fan.ray(x, y);
    let (enters, leaves) = stay(&world.space, standing.cell, view.eye, ray.direction)?;
    let cast = Cast::new(ray);
    let [opaque, clear] = nearest(world, &cast, near, leaves);
    // What is met earlier is another cell's.
    if opaque.is_some_and(|found| found.contact.t < enters) {
        return None;
    }
    let clear = clear.filter(|found| found.contact.t >= enters);
    let paint = |found: Found| paint((world, coats), &ray, &found, standing.light, finish);
    let object = clear.or(opaque)?.primitive;
    let paint = match (clear.map(paint), opaque.map(paint)) {
        (Some(Paint::Glass(tint, own)), Some(Paint::Opaque(behind))) => {
            Paint::Opaque(through(behind, tint, own))
        }
        (paint, None) | (None, paint) | (paint, Some(_)) => paint?,
    };
    Some(Spot { object, paint })
}

/// The nearest object that is not of glass, and the nearest of glass before it.
fn nearest(
    world: &World,
    cast: &Cast,
    list: impl Iterator<Item = u32>,
    limit: f64,
) -> [Option<Found>; 2] {
    let mut best: [Option<Found>; 2] = [None; 2];
    let t = |found: &Option<Found>| found.map_or(limit, |f| f.contact.t);
    for primitive in list {
        let material = world.standing[primitive as usize].material;
        let kind = usize::from(world.material(material).transmit > 0.0);
        let limit = t(&best[0]).min(t(&best[kind]));
        let contact = (world.objects).contact(primitive, cast, None, Want::Nearest, limit, &mut ());
        // Of two at the same t the one with the lower number counts, which comes first.
        let Some(contact) = contact else { continue };
        if contact.t < limit || contact.t == limit && best == [None; 2] {
            best[kind] = Some(Found { primitive, contact });
        }
    }
    if t(&best[1]) > t(&best[0]) {
        best[1] = None;
    }
    best
}

fn paint(
    (world, coats): (&World, &Coats),
    ray: &Ray,
    found: &Found,
    light: f64,
    finish: Finish,
) -> Paint {
    let hit = world.objects.hit(ray, found);
    let index = world.standing[found.primitive as usize].material;
    let material = world.material(index);
    let own = match world.picture_of[index.0 as usize] {
        Some(number) => match finish {
            Finish::Textured => world.pictures[number as usize].at(hit.uv),
            Finish::Flat => coats.mean(number),
        },
        None => coat::colour(material),
    };
    let turned = hit.normal.dot(ray.direction) > 0.0;
    let normal = if turned { -hit.shading } else { hit.shading };
    // Round things look round: what faces the eye is brighter.
    let facing = normal.dot(-ray.direction.normalize()).max(0.0);
    let light = coat::slope(normal) * (0.6 + 0.4 * facing) * light;
    let share = faded(coats.fade(light.min(1.0)), hit.t.recip());
    if material.transmit == 0.0 {
        return Paint::Opaque(dim(coats.exposed(own), share));
    }
    let [tint, own] = coat::glass(own, None, material.transmit);
    // At its rim one sees more of the glass itself.
    let rim = ((1.0 - facing).powi(3) * 120.0) as u32;
    let rim = rim | rim << 8 | rim << 16;
    Paint::Glass(tint, dim(own | rim, share))
}

/// From where to where a ray from the eye is in a cell.
fn stay(space: &Space, cell: CellId, eye: DVec3, direction: DVec3) -> Option<(f64, f64)> {
    let chamber = space.cell(cell.0);
    let (mut enters, mut leaves) = (0.0f64, f64::INFINITY);
    // Inside where level + slope · t is not negative.
    let mut cut = |level: f64, slope: f64| {
        let at = -level / slope;
        if slope > 0.0 {
            enters = enters.max(at);
        } else if slope < 0.0 {
            leaves = leaves.min(at);
        } else if level < 0.0 {
            leaves = f64::NEG_INFINITY;
        }
    };
    cut(eye.z - chamber.floor, direction.z);
    cut(chamber.ceiling - eye.z, -direction.z);
    let (o, d) = (eye.truncate(), direction.truncate());
    for e in chamber.first..chamber.past {
        let edge = space.edge(e);
        let turned = edge.to < edge.from;
        let [p, q] = if turned {
            [edge.to, edge.from]
        } else {
            [edge.from, edge.to]
        };
        let (p, q) = (space.vertex(p), space.vertex(q));
        let sign = if turned { -1.0 } else { 1.0 };
        let along = q - p;
        cut(sign * along.perp_dot(o - p), sign * along.perp_dot(d));
    }
    (enters <= leaves).then_some((enters, leaves))
}
