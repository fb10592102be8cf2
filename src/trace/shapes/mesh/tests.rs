use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::super::cases::ray;
use super::findings::Findings;
use super::*;
use crate::trace::accel::bvh::Build;
use crate::trace::accel::{Counters, VolumeKind};
use crate::trace::ray::Ray;

const KIND: Kind = Kind::Bvh(Build::MedianCut, VolumeKind::Boxes);

/// A cube of side 2 about the origin: six squares, split by the reader.
const CUBE: &str = "
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
f 4 3 2 1
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
";

fn cube() -> Mesh {
    Mesh::new(obj::read(CUBE.as_bytes()).unwrap(), KIND).unwrap()
}

/// The mesh with its points moved by a function.
fn moved(mesh: &Mesh, by: impl Fn(DVec3) -> DVec3) -> Mesh {
    let mut points = mesh.points().clone();
    points.places.iter_mut().for_each(|p| *p = by(*p));
    Mesh::new(points, KIND).unwrap()
}

fn first(mesh: &Mesh, ray: &Ray, from: Option<&Start>) -> Option<Contact> {
    let cast = Cast::new(*ray);
    mesh.contact(&cast, from, Want::Nearest, f64::INFINITY, &mut ())
}

/// A torus of n × n quads, normals included: closed, with edges that bend both ways.
fn torus(n: u32, origin: DVec3) -> Mesh {
    let mut points = Points {
        places: Vec::new(),
        triangles: Vec::new(),
        normals: Vec::new(),
        uv: Vec::new(),
    };
    for i in 0..n {
        for j in 0..n {
            let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
            let ((sa, ca), (sb, cb)) = (angle(i).sin_cos(), angle(j).sin_cos());
            let out = DVec3::new(ca * cb, sa * cb, sb);
            points.normals.push(out);
            points
                .places
                .push(DVec3::new(ca, sa, 0.0) * 3.0 + out + origin);
            let at = |i: u32, j: u32| i % n * n + j % n;
            let (a, b) = (at(i, j), at(i + 1, j));
            let (c, d) = (at(i + 1, j + 1), at(i, j + 1));
            points.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::new(points, KIND).unwrap()
}

#[test]
fn a_cube_from_obj() {
    let mesh = cube();
    assert_eq!(mesh.points().triangles.len(), 12);
    assert_eq!(Findings::of(mesh.points()), Findings::default());
    mesh.validate().unwrap();
    let r = ray([-3.0, 0.25, 0.5], [2.0, 0.0, 0.0]);
    let contact = first(&mesh, &r, None).unwrap();
    assert_eq!(contact.t, 1.0);
    let hit = mesh.hit(&contact);
    assert_eq!(
        (hit.point, hit.normal),
        (DVec3::new(-1.0, 0.25, 0.5), DVec3::NEG_X)
    );
    // From inside; behind; beside; along an edge and through a corner.
    let t = |origin, direction| first(&mesh, &ray(origin, direction), None).map(|c| c.t);
    assert_eq!(t([0.0; 3], [0.0, 0.0, -1.0]), Some(1.0));
    assert_eq!(t([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(t([-3.0, 1.1, 0.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(t([-3.0, 1.0, 0.5], [1.0, 0.0, 0.0]), Some(2.0));
    assert_eq!(t([-3.0, -3.0, -3.0], [1.0, 1.0, 1.0]), Some(2.0));
    assert_eq!(t([-1e6, 0.25, 0.5], [1.0, 0.0, 0.0]), Some(1e6 - 1.0));
    let mut counters = Counters::default();
    let torus = torus(24, DVec3::ZERO);
    let cast = Cast::new(ray([3.1, 0.2, 9.0], [0.0, 0.0, -1.0]));
    torus.contact(&cast, None, Want::Nearest, 99.0, &mut counters);
    assert!(counters.tests > 0 && counters.tests < 60, "{counters:?}");
}

#[test]
fn normals_and_texture_of_obj_are_interpolated() {
    let text = "v 0 0 0\nv 4 0 0\nv 0 4 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nvn 1 0 0\n\
                f 1/1/1 2/2/2 3/3/1\n";
    let mesh = Mesh::new(obj::read(text.as_bytes()).unwrap(), KIND).unwrap();
    let r = ray([1.0, 2.0, 3.0], [0.0, 0.0, -1.0]);
    let contact = first(&mesh, &r, None).unwrap();
    assert_eq!((contact.t, contact.weights), (3.0, [0.25, 0.5]));
    let hit = mesh.hit(&contact);
    assert_eq!(hit.uv, DVec2::new(0.25, 0.5));
    let mixed = DVec3::new(0.25, 0.0, 0.75).normalize();
    assert!((hit.shading - mixed).length() < 1e-15);
    assert_eq!(hit.normal, DVec3::Z);
}

#[test]
fn oddities_and_errors() {
    let read = |text: &str| obj::read(text.as_bytes()).and_then(|p| Mesh::new(p, KIND));
    assert_eq!(read("v 0 0 0\n").unwrap_err(), MeshError::Empty);
    assert!(matches!(read("f 1 2 3\n"), Err(MeshError::Obj(_))));
    assert!(matches!(read("v 0 nonsense 0\n"), Err(MeshError::Obj(_))));
    let nan = "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(read(nan).unwrap_err(), MeshError::NotFinite(0));
    let mut points = cube().points().clone();
    points.triangles[3] = [0, 1, 99];
    assert_eq!(
        Mesh::new(points.clone(), KIND).unwrap_err(),
        MeshError::NoSuchPoint(3)
    );
    points.triangles[3] = [0, 0, 1];
    let findings = Findings::of(&points);
    assert!(findings.open > 0 && findings.flat == 1 && !findings.is_closed());
    let mut points = cube().points().clone();
    points.triangles[0].swap(0, 1);
    assert_eq!(Findings::of(&points).turned, 3);
    points.uv = vec![DVec2::ZERO];
    assert_eq!(Mesh::new(points, KIND).unwrap_err(), MeshError::Count(1, 8));
}

#[test]
fn a_mirrored_mesh_still_has_its_normals_outside() {
    let flip = Placement::new(DVec3::new(-2.0, 1.0, 1.0), glam::DQuat::IDENTITY, DVec3::X);
    let mesh = cube().placed(&flip.unwrap(), KIND).unwrap();
    assert!(Findings::of(mesh.points()).is_closed());
    let r = ray([9.0, 0.1, 0.2], [-1.0, 0.0, 0.0]);
    let contact = first(&mesh, &r, None).unwrap();
    assert_eq!(contact.t, 6.0);
    assert_eq!(mesh.hit(&contact).normal, DVec3::X);
}

/// Random text made of OBJ's words: read or refused, never a panic.
#[test]
fn any_text_is_read_or_refused() {
    let mut random = Pcg64::seed_from_u64(3);
    let words = [
        "v", "vn", "vt", "f", "l", "p", "o", "g", "usemtl", "1", "-1", "2", "0", "9/9", "1//1",
        "1/1/1", "f 1 2 3", "-7", "1e9", "x", "\n", "\n", "\n", "#", "s", "mtllib",
    ];
    let mut read = 0;
    for _ in 0..20_000 {
        let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
        for _ in 0..random.random_range(0..20) {
            text += words[random.random_range(0..words.len())];
            text += " ";
        }
        if let Ok(points) = obj::read(text.as_bytes()) {
            read += usize::from(Mesh::new(points, KIND).is_ok());
        }
    }
    assert!(read > 10, "{read} meshes");
}

/// A random point of a random triangle, often at an edge or a corner, as a renderer gets it.
fn somewhere(mesh: &Mesh, random: &mut Pcg64) -> (u32, DVec3, DVec3) {
    let part = random.random_range(0..mesh.points().triangles.len() as u32);
    let corners = mesh.points().corners(part);
    let edge: f64 = [1.0, 1e-3, 1e-9, 1e-16, 0.0][random.random_range(0..5)];
    let v = random.random_range(0.0..1.0) * edge;
    let w = random.random_range(0.0..1.0) * (1.0 - v);
    let mut corners = corners;
    corners.rotate_left(random.random_range(0..3));
    let point = triangle::point(corners, [v, w]);
    (part, point, triangle::normal(corners))
}

/// Boxes near and far, upright and turned, cubes and sticks; and the flattest angle at which the
/// rounded corners still make a convex solid.
fn boxes() -> Vec<(Mesh, f64)> {
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7);
    let stick = DVec3::new(1.0, 1e-3, 50.0);
    let mut list = Vec::new();
    for far in [0.0, 1.0, 1e6] {
        let flattest = if far > 1.0 { 1e-5 } else { 1e-9 };
        list.push((moved(&cube(), |p| p + far), 1e-9));
        list.push((moved(&cube(), |p| p * stick + far), 1e-9));
        list.push((moved(&cube(), |p| turn * p + far), flattest));
        list.push((moved(&cube(), |p| turn * (p * stick) + far), flattest));
    }
    list
}

/// A direction on the side of the normal (or the other), at angles down to the flattest.
fn leaving(normal: DVec3, flattest: f64, random: &mut Pcg64) -> DVec3 {
    let (u, v) = normal.any_orthonormal_pair();
    let (y, x) = random.random_range(0.0..6.3f64).sin_cos();
    let height = flattest.max([1.0, 1e-2, 1e-5, 1e-9][random.random_range(0..4)]);
    u * x + v * y + normal * height
}

/// Nothing of a convex mesh may be met by a ray that leaves it, at any angle, anywhere.
#[test]
fn no_spots_on_convex_meshes() {
    let mut random = Pcg64::seed_from_u64(17);
    for (mesh, flattest) in boxes() {
        let mut exact = 0;
        for _ in 0..20_000 {
            let (part, origin, normal) = somewhere(&mesh, &mut random);
            let direction = leaving(normal, flattest, &mut random);
            if !strictly_out(&mesh, part, direction) {
                continue;
            }
            exact += 1;
            let start = Start {
                primitive: 0,
                part,
                inwards: false,
            };
            let found = first(&mesh, &Ray { origin, direction }, Some(&start));
            assert_eq!(found, None, "from {origin} on {part} along {direction}");
        }
        assert!(exact > 15_000, "{exact}");
    }
}

/// Whether the direction leaves the triangle's plane by more than what rounding does to its normal.
fn strictly_out(mesh: &Mesh, part: u32, direction: DVec3) -> bool {
    let [a, b, c] = mesh.points().corners(part);
    let (e, f) = (b - a, c - a);
    let size = e.abs().max_element() * f.abs().max_element() * direction.abs().max_element();
    e.cross(f).dot(direction) > size * 2f64.powi(-48)
}

/// From the inner side of a closed mesh every ray meets it: none escapes, not through an edge on
/// which it starts, and not at grazing angles.
#[test]
fn no_leaks_in_corners() {
    let mut random = Pcg64::seed_from_u64(19);
    for (mesh, flattest) in boxes() {
        let mut at_once = 0;
        for _ in 0..20_000 {
            let (part, origin, normal) = somewhere(&mesh, &mut random);
            let direction = leaving(-normal, flattest, &mut random);
            if !strictly_out(&mesh, part, -direction) {
                continue;
            }
            let start = Start {
                primitive: 0,
                part,
                inwards: true,
            };
            let found = first(&mesh, &Ray { origin, direction }, Some(&start));
            let Some(contact) = found else {
                panic!("a ray from {origin} on {part} along {direction} escapes");
            };
            assert!(contact.t >= 0.0);
            at_once += usize::from(contact.t == 0.0);
        }
        assert!(at_once > 0, "no ray began in a corner");
    }
}

/// A long path inside a torus, where the surface bends both ways: it is met again and again, always
/// from inside; and every path outside alternates properly too.
#[test]
fn paths_stay_on_their_side() {
    let mut random = Pcg64::seed_from_u64(23);
    for far in [0.0, 1e6] {
        let mesh = torus(24, DVec3::splat(far));
        assert!(Findings::of(mesh.points()).is_closed());
        let (mut bounces, mut away) = (0, 0);
        for round in 0..3000 {
            let inwards = round % 2 == 0;
            let (mut part, mut origin, normal) = somewhere(&mesh, &mut random);
            let mut out = if inwards { -normal } else { normal };
            for _ in 0..10 {
                let direction = leaving(out, 1e-9, &mut random);
                if !strictly_out(&mesh, part, if inwards { -direction } else { direction }) {
                    break;
                }
                let start = Start {
                    primitive: 0,
                    part,
                    inwards,
                };
                let r = Ray { origin, direction };
                let Some(contact) = first(&mesh, &r, Some(&start)) else {
                    assert!(
                        !inwards,
                        "a ray from {origin} on {part} along {direction} escapes"
                    );
                    away += 1;
                    break;
                };
                let hit = mesh.hit(&contact);
                let against = hit.normal.dot(direction);
                assert!(
                    if inwards {
                        against >= -1e-9
                    } else {
                        against <= 1e-9
                    },
                    "round {round}: met the wrong side, {against}, at t {}",
                    contact.t
                );
                bounces += 1;
                (part, origin) = (hit.part, hit.point);
                out = if inwards { -hit.normal } else { hit.normal };
            }
        }
        assert!(bounces > 10_000 && away > 500, "{bounces} {away}");
    }
}
