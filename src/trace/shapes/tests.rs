//! Random shapes: what is computed for one is checked against its definition.

use std::f64::consts::TAU;

use glam::{DQuat, EulerRot};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::mesh::Points;
use super::*;
use crate::trace::accel::bvh::Build;
use crate::trace::accel::{Kind, VolumeKind};

const KIND: Kind = Kind::Bvh(Build::MedianCut, VolumeKind::Boxes);

fn vector(random: &mut Pcg64, size: f64) -> DVec3 {
    let mut next = || random.random_range(-size..size);
    DVec3::new(next(), next(), next())
}

/// A solid about the size of 1, and what the definition says of a point: negative inside, positive
/// outside, about the distance.
fn solid(random: &mut Pcg64) -> (Solid, Box<dyn Fn(DVec3) -> f64>) {
    let size = || 0.5;
    let a = size() + random.random_range(0.0..1.0);
    let b = size() + random.random_range(0.0..1.0);
    let middle = vector(random, 1.0);
    match random.random_range(0..5) {
        0 => (
            Solid::Sphere(Sphere {
                centre: middle,
                radius: a,
            }),
            Box::new(move |p| (p - middle).length() - a),
        ),
        1 => {
            let cuboid = Cuboid::new(middle, middle + DVec3::new(a, b, 1.0));
            let (centre, half) = (cuboid.bounds.centre(), cuboid.bounds.size() * 0.5);
            (
                Solid::Cuboid(cuboid),
                Box::new(move |p| ((p - centre).abs() - half).max_element()),
            )
        }
        2 => (
            Solid::Cylinder(Cylinder {
                radius: a,
                height: b,
            }),
            Box::new(move |p| (p.truncate().length() - a).max(-p.z).max(p.z - b)),
        ),
        3 => (
            Solid::Cone(Cone {
                radius: a,
                height: b,
            }),
            Box::new(move |p| {
                let side = (p.truncate().length() - p.z * a / b) * b / a.hypot(b);
                side.max(-p.z).max(p.z - b)
            }),
        ),
        _ => {
            let slabs: Vec<Slab> = (0..5)
                .map(|_| Slab {
                    normal: vector(random, 2.0),
                    low: -0.7,
                    high: 0.9,
                })
                .collect();
            let all = slabs.clone();
            (
                Solid::Polyhedron(Polyhedron::new(slabs).unwrap()),
                Box::new(move |p| {
                    all.iter()
                        .map(|s| {
                            let at = s.normal.dot(p);
                            (at - s.high).max(s.low - at) / s.normal.length()
                        })
                        .fold(f64::NEG_INFINITY, f64::max)
                }),
            )
        }
    }
}

fn placement(random: &mut Pcg64, far: f64) -> Placement {
    let angles = vector(random, 3.0);
    let mut scale =
        || random.random_range(0.3..2.0) * if random.random_bool(0.3) { -1.0 } else { 1.0 };
    let scale = DVec3::new(scale(), scale(), scale());
    let turn = DQuat::from_euler(EulerRot::XYZ, angles.x, angles.y, angles.z);
    Placement::new(scale, turn, vector(random, 1.0) + far).unwrap()
}

fn contact(shape: &Shape, ray: &Ray, from: Option<&Start>) -> Option<Contact> {
    let all = f64::INFINITY;
    shape.contact(&Cast::new(*ray), from, Want::Nearest, all, &mut ())
}

/// Points are on the surface, normals point out and across it, the ray is outside before and inside
/// behind, and bounds hold it all: for solids of all kinds, plain and placed, near and far.
#[test]
fn contacts_fit_the_definition() {
    let mut random = Pcg64::seed_from_u64(31);
    let (mut hits, mut inside_starts) = (0, 0);
    for round in 0..30_000 {
        let far = if round % 4 == 0 { 1e6 } else { 0.0 };
        let (solid, outside) = solid(&mut random);
        let place = placement(&mut random, far);
        let placed = round % 2 == 0;
        let shape = if placed {
            Shape::from(Placed {
                solid,
                placement: place,
            })
        } else {
            Shape::from(solid)
        };
        // The definition, in the solid's coordinates.
        let local = |p: DVec3| {
            let ray = Ray {
                origin: p,
                direction: DVec3::X,
            };
            if placed { place.inward(&ray).origin } else { p }
        };
        let middle = if placed {
            DVec3::splat(far)
        } else {
            DVec3::ZERO
        };
        let distance = [1.0, 5.0, 1e3][round % 3];
        let origin = middle + vector(&mut random, distance);
        let direction =
            (middle + vector(&mut random, 1.0) - origin) * random.random_range(0.1..3.0);
        let ray = Ray { origin, direction };
        let Some(contact) = contact(&shape, &ray, None) else {
            continue;
        };
        hits += 1;
        let hit = shape.hit(&ray, &contact);
        let error = 1e-13 * (far * 10.0 + distance + 10.0);
        let name = || format!("round {round}: {shape:?}, {ray:?}, {hit:?}");
        assert!(
            contact.t > 0.0 && (hit.normal.length() - 1.0).abs() < 1e-12,
            "{}",
            name()
        );
        assert!(hit.point.distance(ray.at(contact.t)) < error, "{}", name());
        // Scales are at least 0.3.
        assert!(outside(local(hit.point)).abs() < error * 4.0, "{}", name());
        let starts_inside = outside(local(origin)) < 0.0;
        inside_starts += usize::from(starts_inside);
        let against = hit.normal.dot(direction.normalize());
        assert!(
            if starts_inside {
                against > -1e-6
            } else {
                against < 1e-6
            },
            "{}",
            name()
        );
        // On both sides of the surface, unless the ray is all but tangent to it.
        let step = 1e-4;
        if against.abs() > 0.1 && far == 0.0 {
            assert!(
                outside(local(hit.point + hit.normal * step)) > 0.0,
                "{}",
                name()
            );
            // Not next to an edge, where the surface bends away.
            let deep = hit.point - hit.normal * step * 0.01;
            assert!(outside(local(deep)) < 1e-9, "{}", name());
        }
        // Before the contact always on the same side.
        for part in [0.1, 0.3, 0.5, 0.9, 0.99] {
            let value = outside(local(ray.at(contact.t * part)));
            let wrong = if starts_inside {
                value > error * 4.0
            } else {
                value < -error * 4.0
            };
            assert!(!wrong, "at {part}: {}", name());
        }
        assert!(
            shape
                .bounds()
                .grown(error)
                .holds(&Bounds::around([hit.point])),
            "{}",
            name()
        );
        assert!(hit.shading.distance(hit.normal) < 1e-15 && hit.uv.is_finite());
    }
    assert!(hits > 8000 && inside_starts > 500, "{hits} {inside_starts}");
}

/// Bounds are not only large enough but as small as can be: points of the surface come near to all
/// six sides.
#[test]
fn bounds_are_tight() {
    let mut random = Pcg64::seed_from_u64(37);
    for _ in 0..30 {
        let (solid, _) = solid(&mut random);
        let shape = Shape::from(Placed {
            solid,
            placement: placement(&mut random, 0.0),
        });
        let b = shape.bounds();
        let mut seen = Bounds::EMPTY;
        for _ in 0..4000 {
            let direction = vector(&mut random, 1.0);
            let target = b.min + b.size() * (vector(&mut random, 0.5) + 0.5);
            let ray = Ray {
                origin: target - direction * 20.0,
                direction,
            };
            if let Some(contact) = contact(&shape, &ray, None) {
                seen = seen.union(&Bounds::around([ray.at(contact.t)]));
            }
        }
        let short = (b.size() - seen.size()) / b.size();
        assert!(
            short.max_element() < 0.25 && short.min_element() >= -1e-12,
            "{short} {shape:?}"
        );
    }
}

/// A ray that leaves a convex solid never meets it, one that goes in comes out: at any angle, near
/// and far, from the rounded point that a renderer has.
#[test]
fn convex_solids_make_no_spots() {
    let mut random = Pcg64::seed_from_u64(41);
    let (mut starts, mut at_once) = (0, 0);
    for round in 0..20_000 {
        let far = if round % 2 == 0 { 1e6 } else { 0.0 };
        let (solid, outside) = solid(&mut random);
        let place = placement(&mut random, far);
        let shape = Shape::from(Placed {
            solid,
            placement: place,
        });
        let origin = DVec3::splat(far) + vector(&mut random, 4.0);
        let ray = Ray {
            origin,
            direction: DVec3::splat(far) + vector(&mut random, 1.0) - origin,
        };
        let Some(first) = contact(&shape, &ray, None) else {
            continue;
        };
        let hit = shape.hit(&ray, &first);
        let (u, v) = hit.normal.any_orthonormal_pair();
        let (y, x) = random.random_range(0.0..TAU).sin_cos();
        let height = [1.0, 1e-3, 1e-9, 1e-15][round / 2 % 4];
        let out = Ray {
            origin: hit.point,
            direction: u * x + v * y + hit.normal * height,
        };
        let start = hit.start(0, out.direction);
        assert!(!start.inwards);
        assert_eq!(contact(&shape, &out, Some(&start)), None);
        let inwards = Ray {
            direction: u * x + v * y - hit.normal * height,
            ..out
        };
        let start = hit.start(0, inwards.direction);
        assert!(start.inwards);
        let exit = contact(&shape, &inwards, Some(&start)).expect("what goes in comes out");
        starts += 1;
        at_once += usize::from(exit.t == 0.0);
        let end = shape.hit(&inwards, &exit);
        let local = Ray {
            origin: end.point,
            direction: DVec3::X,
        };
        let value = outside(place.inward(&local).origin);
        assert!(
            value.abs() < 1e-12 * (10.0 + 10.0 * far),
            "{value}: {shape:?} {inwards:?}"
        );
        // Half way it is inside, if it went anywhere.
        let half = Ray {
            origin: inwards.at(exit.t * 0.5),
            direction: DVec3::X,
        };
        let value = outside(place.inward(&half).origin);
        assert!(
            value < 1e-12 * (10.0 + 10.0 * far),
            "{value}: {shape:?} {inwards:?}"
        );
    }
    assert!(starts > 5000 && at_once > 0, "{starts} {at_once}");
}

/// Three ways to ask about one triangle.
#[test]
fn a_triangle_is_a_polygon_is_a_mesh() {
    let mut random = Pcg64::seed_from_u64(43);
    let mut hits = 0;
    for round in 0..5000 {
        let far = if round % 2 == 0 { 1e4 } else { 0.0 };
        let corners = [0; 3].map(|_| vector(&mut random, 1.0) + far);
        let normals = [0; 3].map(|_| vector(&mut random, 1.0));
        let uv = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let triangle = Triangle {
            corners,
            normals: Some(normals),
            uv,
        };
        let polygon = Polygon::new(corners.to_vec())
            .and_then(|p| p.with_normals(normals.to_vec()))
            .and_then(|p| p.with_uv(uv.to_vec()))
            .unwrap();
        let mut marchal = polygon.clone();
        marchal.method = polygon::Method::Marchal;
        let points = Points {
            places: corners.to_vec(),
            triangles: vec![[0, 1, 2]],
            normals: normals.to_vec(),
            uv: uv.to_vec(),
        };
        let shapes: [Shape; 4] = [
            triangle.into(),
            polygon.into(),
            marchal.into(),
            Mesh::new(points, KIND).unwrap().into(),
        ];
        let origin = vector(&mut random, 3.0) + far;
        let ray = Ray {
            origin,
            direction: corners[0].lerp(corners[1], 0.3).lerp(corners[2], 0.4) - origin
                + vector(&mut random, 0.3),
        };
        let found = shapes.each_ref().map(|s| contact(s, &ray, None));
        let n = found.iter().filter(|f| f.is_some()).count();
        // All or none, but for rays within rounding of an edge, which do not come up.
        assert!(n == 0 || n == 4, "{found:?}");
        let slanted = shapes[0].bounds().size().min_element() > 0.1;
        if n == 0 || !slanted {
            continue;
        }
        let hit = [0, 1, 2, 3].map(|i| shapes[i].hit(&ray, &found[i].unwrap()));
        for other in &hit[1..] {
            let error = 1e-10 * (1.0 + far);
            let steep = hit[0].normal.dot(ray.direction.normalize()).abs();
            if steep < 0.05 {
                continue;
            }
            assert!((hit[0].t - other.t).abs() < error);
            assert!(hit[0].point.distance(other.point) < error);
            assert!(hit[0].normal.distance(other.normal) < error);
            assert!(hit[0].uv.distance(other.uv) < error * 100.0);
            let flipped = hit[0].shading.distance(other.shading);
            assert!(flipped < error * 1e4 || mixed_is_flat(&hit[0]), "{flipped}");
            hits += 1;
        }
        assert!(hit.iter().all(|h| h.shading.dot(h.normal) >= 0.0));
    }
    assert!(hits > 3000, "{hits}");
}

/// Whether the interpolated normal lies so nearly in the surface that its side is rounding's choice.
fn mixed_is_flat(hit: &Hit) -> bool {
    hit.shading.dot(hit.normal) < 1e-3
}

/// From inside a closed mesh no ray gets out, be it aimed at an edge or a corner.
#[test]
fn closed_meshes_are_watertight() {
    let mut random = Pcg64::seed_from_u64(47);
    let n = 12;
    for far in [0.0, 1e6] {
        // A bumpy ball about the middle.
        let mut places = vec![DVec3::Z, DVec3::NEG_Z];
        let mut triangles = Vec::new();
        for i in 0..n {
            for j in 0..n {
                let (sa, ca) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
                let (sb, cb) = (TAU / 2.0 * f64::from(j + 1) / f64::from(n + 1)).sin_cos();
                let bump = random.random_range(0.7..1.3);
                places.push(DVec3::new(ca * sb, sa * sb, cb) * bump);
                let at = |i: u32, j: u32| 2 + (i as u32 % n as u32) * n as u32 + j;
                let (i, j) = (i as u32, j as u32);
                let next = i + 1;
                if j == 0 {
                    triangles.push([0, at(i, j), at(next, j)]);
                } else {
                    triangles.push([at(i, j - 1), at(i, j), at(next, j)]);
                    triangles.push([at(i, j - 1), at(next, j), at(next, j - 1)]);
                }
                if j + 1 == n as u32 {
                    triangles.push([1, at(next, j), at(i, j)]);
                }
            }
        }
        places.iter_mut().for_each(|p| *p += far);
        let points = Points {
            places,
            triangles,
            normals: Vec::new(),
            uv: Vec::new(),
        };
        assert!(mesh::findings::Findings::of(&points).is_closed());
        let mesh = Mesh::new(points, KIND).unwrap();
        let points = mesh.points().clone();
        let shape = Shape::from(mesh);
        for _ in 0..50_000 {
            let origin = DVec3::splat(far) + vector(&mut random, 0.2);
            let triangle = random.random_range(0..points.triangles.len() as u32);
            let [a, b, _] = points.corners(triangle);
            let along = [0.0, random.random_range(0.0..1.0)][random.random_range(0..2)];
            let ray = Ray {
                origin,
                direction: a.lerp(b, along) - origin,
            };
            assert!(contact(&shape, &ray, None).is_some(), "{ray:?} gets out");
        }
    }
}
