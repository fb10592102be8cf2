//! Objects as triangles, cut at the borders of the cells that they reach into.
//!
//! In: the objects of a [`World`]. Out: [`Things`]: for each cell the triangles of its objects, opaque ones
//! together, those of glass one by one. What is cut at the cells' borders can be painted in the cells' turn,
//! as the software painter does it. Round things become many-sided: their outline is off by less than a
//! hundredth of the radius.

use std::f64::consts::{PI, TAU};
use std::ops::Range;

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::corners::{Corner, Paint};
use super::texels::Texels;
use crate::cells::CellId;
use crate::preview::Finish;
use crate::preview::coat::{self, Coats};
use crate::trace::accel::{Bounds, Primitives};
use crate::trace::shapes::{Cone, Cylinder, Mesh, Polygon, Shape, Solid, Sphere};
use crate::trace::space::Space;
use crate::trace::world::World;

/// Sides of what is round.
const SIDES: u32 = 40;

/// A corner of a triangle of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    at: DVec3,
    /// Unit normal, on the side from which the triangle goes around counterclockwise.
    normal: DVec3,
    uv: DVec2,
}

type Triangle = [Point; 3];

/// Of a cell.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Corners of opaque objects, three to a triangle.
    pub opaque: Range<u32>,
    /// Objects of glass: their middle, and their corners.
    pub glass: Vec<(DVec3, Range<u32>)>,
}

/// The objects of a level.
#[derive(Clone, Debug, Default)]
pub struct Things {
    /// Three to a triangle, each seen from one side only.
    pub corners: Vec<Corner>,
    groups: Vec<Group>,
}

impl Things {
    /// Those of a level. Places are counted from `origin`.
    pub fn new(
        world: &World,
        (coats, finish): (&Coats, Finish),
        texels: &Texels,
        origin: DVec3,
    ) -> Self {
        let shapes: Vec<Vec<Triangle>> = (world.objects.shapes().iter().zip(&world.standing))
            .map(|(shape, standing)| triangles(shape, standing.solid))
            .collect();
        let mut things = Self::default();
        for cell in (0..world.space.cells.len() as u32).map(CellId) {
            let mut group = Group::default();
            let clear = |object: &u32| {
                let material = world.standing[*object as usize].material;
                world.material(material).transmit > 0.0
            };
            let (glass, opaque): (Vec<u32>, Vec<u32>) =
                world.objects_in(cell).iter().copied().partition(clear);
            let mut add = |object: u32| {
                let paint = paint(world, (coats, finish), texels, object);
                let light = coat::light_in(world, cell) as f32;
                let first = things.corners.len() as u32;
                for triangle in &shapes[object as usize] {
                    let cut = cut(&world.space, cell, triangle);
                    let fan = (2..cut.len()).flat_map(|i| [cut[0], cut[i - 1], cut[i]]);
                    things
                        .corners
                        .extend(fan.map(|p| corner(&p, origin, paint, light)));
                }
                first..things.corners.len() as u32
            };
            let ranges: Vec<Range<u32>> = opaque.into_iter().map(&mut add).collect();
            if let [first, .., last] | [first @ last] = &ranges[..] {
                group.opaque = first.start..last.end;
            }
            for object in glass {
                let bounds = world.objects.bounds(object);
                group
                    .glass
                    .push(((bounds.min + bounds.max) / 2.0, add(object)));
            }
            things.groups.push(group);
        }
        things
    }

    /// What stands in a cell.
    #[inline]
    pub fn in_cell(&self, cell: CellId) -> &Group {
        &self.groups[cell.0 as usize]
    }

    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }
}

fn corner(point: &Point, origin: DVec3, paint: [u32; 4], light: f32) -> Corner {
    let whole = |x: f64| (x * f64::from(i16::MAX)).round() as i16;
    let [x, y, z] = point.normal.to_array().map(whole);
    Corner {
        place: (point.at - origin).as_vec3().to_array(),
        uv: point.uv.as_vec2().to_array(),
        normal: [x, y, z, 0],
        paint,
        light,
    }
}

/// What the shader is told of an object.
fn paint(
    world: &World,
    (coats, finish): (&Coats, Finish),
    texels: &Texels,
    object: u32,
) -> [u32; 4] {
    let index = world.standing[object as usize].material;
    let material = world.material(index);
    let picture = world.picture_of[index.0 as usize];
    let own = picture.map_or_else(|| coat::colour(material), |n| coats.mean(n));
    if material.transmit > 0.0 {
        let [tint, own] = coat::glass(own, None, material.transmit);
        return [Paint::ThingGlass as u32, tint, own, 1];
    }
    match picture {
        Some(number) if finish == Finish::Textured => {
            let [first, width, height] = texels.of(coats.texture_of(number));
            [Paint::ThingPicture as u32, first, width, height]
        }
        _ => [Paint::Thing as u32, coats.exposed(own), 1, 1],
    }
}

/// The part of a triangle within a cell: a convex polygon, or nothing.
fn cut(space: &Space, cell: CellId, triangle: &Triangle) -> SmallVec<[Point; 8]> {
    let chamber = space.cell(cell.0);
    let mut part: SmallVec<[Point; 8]> = SmallVec::from_slice(triangle);
    let mut keep = |height: &dyn Fn(DVec3) -> f64| {
        if part.iter().all(|p| height(p.at) >= 0.0) {
            return;
        }
        let whole = std::mem::take(&mut part);
        for (i, p) in whole.iter().enumerate() {
            let q = &whole[(i + 1) % whole.len()];
            let (a, b) = (height(p.at), height(q.at));
            if a >= 0.0 {
                part.push(*p);
            }
            if (a >= 0.0) != (b >= 0.0) {
                let share = a / (a - b);
                part.push(Point {
                    at: p.at.lerp(q.at, share),
                    normal: p.normal.lerp(q.normal, share),
                    uv: p.uv.lerp(q.uv, share),
                });
            }
        }
    };
    keep(&|p| p.z - chamber.floor);
    keep(&|p| chamber.ceiling - p.z);
    for e in chamber.first..chamber.past {
        let edge = space.edge(e);
        let (from, to) = (space.vertex(edge.from), space.vertex(edge.to));
        keep(&|p| (to - from).perp_dot(p.truncate() - from));
    }
    if part.len() < 3 {
        part.clear();
    }
    part
}

/// A shape's triangles, each seen from the side from which it goes around counterclockwise. What has no
/// inside is seen from both sides.
fn triangles(shape: &Shape, solid: bool) -> Vec<Triangle> {
    match shape {
        Shape::Solid(own) => of_solid(own),
        Shape::Placed(placed) => {
            let placement = &placed.placement;
            let mut list = of_solid(&placed.solid);
            for triangle in &mut list {
                for point in triangle.iter_mut() {
                    point.at = placement.point(point.at);
                    point.normal = placement.normal(point.normal);
                }
                if placement.mirrors() {
                    triangle.swap(1, 2);
                }
            }
            list
        }
        Shape::Polygon(polygon) => both(of_polygon(polygon)),
        Shape::Triangle(triangle) => {
            let [a, b, c] = triangle.corners;
            let normal = (b - a).cross(c - a).normalize_or(DVec3::Z);
            let normals = triangle.normals.unwrap_or([normal; 3]);
            let at = |k: usize| Point {
                at: triangle.corners[k],
                normal: normals[k],
                uv: triangle.uv[k],
            };
            both(vec![[at(0), at(1), at(2)]])
        }
        Shape::Mesh(mesh) if solid => of_mesh(mesh),
        Shape::Mesh(mesh) => both(of_mesh(mesh)),
    }
}

/// With their backs.
fn both(mut list: Vec<Triangle>) -> Vec<Triangle> {
    let backs: Vec<Triangle> = list
        .iter()
        .map(|[a, b, c]| {
            [a, c, b].map(|p| Point {
                normal: -p.normal,
                ..*p
            })
        })
        .collect();
    list.extend(backs);
    list
}

fn of_solid(solid: &Solid) -> Vec<Triangle> {
    match solid {
        Solid::Sphere(sphere) => of_sphere(sphere),
        Solid::Cuboid(cuboid) => of_box(&cuboid.bounds),
        // None comes from a file; its box will do.
        Solid::Polyhedron(_) => of_box(&solid.bounds()),
        Solid::Cylinder(cylinder) => of_cylinder(cylinder),
        Solid::Cone(cone) => of_cone(cone),
    }
}

/// Two triangles, or one where two neighbouring corners coincide.
fn quad(list: &mut Vec<Triangle>, [a, b, c, d]: [Point; 4]) {
    if a.at != b.at && b.at != c.at {
        list.push([a, b, c]);
    }
    if c.at != d.at && d.at != a.at {
        list.push([a, c, d]);
    }
}

fn of_sphere(sphere: &Sphere) -> Vec<Triangle> {
    let rows = SIDES / 2;
    let point = |i: u32, k: u32| {
        let (u, v) = (
            f64::from(i) / f64::from(SIDES),
            f64::from(k) / f64::from(rows),
        );
        let slope = (v - 0.5) * PI;
        let flat = match k {
            0 => 0.0,
            _ if k == rows => 0.0,
            _ => slope.cos(),
        };
        let normal = (DVec2::from_angle(u * TAU) * flat).extend(slope.sin());
        Point {
            at: sphere.centre + normal * sphere.radius,
            normal,
            uv: place(u, v),
        }
    };
    let mut list = Vec::new();
    for k in 0..rows {
        for i in 0..SIDES {
            let corners = [(i, k), (i + 1, k), (i + 1, k + 1), (i, k + 1)];
            quad(&mut list, corners.map(|(i, k)| point(i, k)));
        }
    }
    list
}

/// Rows of pictures are counted from the top.
fn place(u: f64, v: f64) -> DVec2 {
    DVec2::new(u, 1.0 - v)
}

fn of_box(bounds: &Bounds) -> Vec<Triangle> {
    let mut list = Vec::new();
    for axis in 0..3 {
        let (first, second) = match axis {
            0 => (1, 2),
            1 => (0, 2),
            _ => (0, 1),
        };
        for high in [false, true] {
            let mut normal = DVec3::ZERO;
            normal[axis] = if high { 1.0 } else { -1.0 };
            let point = |u: f64, v: f64| {
                let mut at = if high { bounds.max } else { bounds.min };
                for (k, share) in [(first, u), (second, v)] {
                    at[k] = bounds.min[k] + (bounds.max[k] - bounds.min[k]) * share;
                }
                Point {
                    at,
                    normal,
                    uv: place(u, v),
                }
            };
            let mut corners = [
                point(0.0, 0.0),
                point(1.0, 0.0),
                point(1.0, 1.0),
                point(0.0, 1.0),
            ];
            let [a, b, c, _] = corners.map(|p| p.at);
            if (b - a).cross(c - a).dot(normal) < 0.0 {
                corners.swap(1, 3);
            }
            quad(&mut list, corners);
        }
    }
    list
}

/// A disc across the z axis, seen from above or from below.
fn disc(list: &mut Vec<Triangle>, radius: f64, z: f64, up: bool) {
    let normal = if up { DVec3::Z } else { DVec3::NEG_Z };
    let point = |out: DVec2| Point {
        at: (out * radius).extend(z),
        normal,
        uv: place(0.5 + out.x / 2.0, 0.5 + out.y / 2.0),
    };
    let rim = |i: u32| point(DVec2::from_angle(f64::from(i) / f64::from(SIDES) * TAU));
    for i in 0..SIDES {
        let (a, b) = if up { (i, i + 1) } else { (i + 1, i) };
        list.push([point(DVec2::ZERO), rim(a), rim(b)]);
    }
}

fn of_cylinder(cylinder: &Cylinder) -> Vec<Triangle> {
    let mut list = Vec::new();
    let point = |i: u32, v: f64| {
        let u = f64::from(i) / f64::from(SIDES);
        let out = DVec2::from_angle(u * TAU);
        Point {
            at: (out * cylinder.radius).extend(cylinder.height * v),
            normal: out.extend(0.0),
            uv: place(u, v),
        }
    };
    for i in 0..SIDES {
        let corners = [(i, 0.0), (i + 1, 0.0), (i + 1, 1.0), (i, 1.0)];
        quad(&mut list, corners.map(|(i, v)| point(i, v)));
    }
    disc(&mut list, cylinder.radius, 0.0, false);
    disc(&mut list, cylinder.radius, cylinder.height, true);
    list
}

/// It stands on its tip.
fn of_cone(cone: &Cone) -> Vec<Triangle> {
    let mut list = Vec::new();
    let slope = cone.radius / cone.height;
    let point = |i: u32, v: f64, turn: f64| {
        let u = (f64::from(i) + turn) / f64::from(SIDES);
        let out = DVec2::from_angle(u * TAU);
        Point {
            at: (out * (cone.radius * v)).extend(cone.height * v),
            normal: out.extend(-slope).normalize(),
            uv: place(u, v),
        }
    };
    for i in 0..SIDES {
        list.push([
            point(i, 0.0, 0.5),
            point(i + 1, 1.0, 0.0),
            point(i, 1.0, 0.0),
        ]);
    }
    disc(&mut list, cone.radius, cone.height, true);
    list
}

fn of_polygon(polygon: &Polygon) -> Vec<Triangle> {
    let corners = polygon.corners();
    let point = |k: u32| {
        let (surface, mixed) = polygon.surface(corners[k as usize]);
        Point {
            at: corners[k as usize],
            normal: mixed.normalize_or(surface.normal),
            uv: place(surface.uv.x, surface.uv.y),
        }
    };
    let triangles = polygon.triangles().iter();
    triangles.map(|t| t.map(point)).collect()
}

fn of_mesh(mesh: &Mesh) -> Vec<Triangle> {
    let points = mesh.points();
    let triangles = points.triangles.iter().zip(0..);
    triangles
        .map(|(triangle, number)| {
            let [a, b, c] = points.corners(number);
            let normal = (b - a).cross(c - a).normalize_or(DVec3::Z);
            std::array::from_fn(|k| {
                let i = triangle[k] as usize;
                let given = points.normals.get(i).copied().unwrap_or(normal);
                let given = given.normalize_or(normal);
                let uv = [DVec2::ZERO, DVec2::X, DVec2::Y][k];
                let uv = points.uv.get(i).copied().unwrap_or(uv);
                let inwards = given.dot(normal) < 0.0;
                Point {
                    at: points.places[i],
                    normal: if inwards { -given } else { given },
                    uv: place(uv.x, uv.y),
                }
            })
        })
        .collect()
}
