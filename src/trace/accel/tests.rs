//! Every structure against brute force.

use glam::{DQuat, DVec2, DVec3, EulerRot};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::*;
use crate::trace::ray::{Ray, Start};
use crate::trace::shapes::mesh::Points;
use crate::trace::shapes::*;

fn vector(random: &mut Pcg64, size: f64) -> DVec3 {
    let mut next = || random.random_range(-size..=size);
    DVec3::new(next(), next(), next())
}

/// Coordinates that often coincide: whole numbers.
fn whole(random: &mut Pcg64, size: i32) -> DVec3 {
    let mut next = || f64::from(random.random_range(-size..=size));
    DVec3::new(next(), next(), next())
}

/// What random scenes are like.
#[derive(Clone, Copy)]
struct Style {
    /// Where the scene is.
    middle: DVec3,
    /// How far its objects lie around.
    size: f64,
    /// How large they are.
    object: f64,
    /// Whether coordinates are whole, so that faces, edges and corners fall together.
    whole: bool,
}

impl Style {
    fn random(random: &mut Pcg64) -> Self {
        let far = [0.0, 0.0, 0.0, 1e3, 1e6][random.random_range(0..5)];
        Self {
            middle: DVec3::new(far, -far, far * 0.5),
            size: [1.0, 10.0, 100.0][random.random_range(0..3)],
            object: [0.1, 1.0, 5.0][random.random_range(0..3)],
            whole: random.random_bool(0.4),
        }
    }

    fn point(&self, random: &mut Pcg64) -> DVec3 {
        if self.whole {
            self.middle + whole(random, self.size.min(6.0) as i32)
        } else {
            self.middle + vector(random, self.size)
        }
    }

    fn offset(&self, random: &mut Pcg64) -> DVec3 {
        if self.whole {
            whole(random, 2)
        } else {
            vector(random, self.object)
        }
    }

    fn length(&self, random: &mut Pcg64) -> f64 {
        if self.whole {
            f64::from(random.random_range(1..3))
        } else {
            self.object * random.random_range(0.1..1.0)
        }
    }

    /// A shape of any sort.
    fn shape(&self, random: &mut Pcg64) -> Shape {
        let at = self.point(random);
        let solid = |random: &mut Pcg64| match random.random_range(0..5) {
            0 => Solid::Sphere(Sphere {
                centre: DVec3::ZERO,
                radius: self.length(random),
            }),
            1 => Solid::Cuboid(Cuboid::new(DVec3::ZERO, self.offset(random))),
            2 => Solid::Cylinder(Cylinder {
                radius: self.length(random),
                height: self.length(random),
            }),
            3 => Solid::Cone(Cone {
                radius: self.length(random),
                height: self.length(random),
            }),
            _ => {
                let slab = |normal: [f64; 3]| Slab {
                    normal: normal.into(),
                    low: -self.object,
                    high: self.object,
                };
                let slabs = [
                    slab([1.0, 1.0, 0.0]),
                    slab([0.0, 1.0, 1.0]),
                    slab([1.0, 0.0, 1.0]),
                    slab([1.0, -1.0, 0.5]),
                ];
                Solid::Polyhedron(Polyhedron::new(slabs.to_vec()).unwrap())
            }
        };
        match random.random_range(0..8) {
            0 => Solid::Sphere(Sphere {
                centre: at,
                radius: self.length(random),
            })
            .into(),
            1 => Solid::Cuboid(Cuboid::new(at, at + self.offset(random))).into(),
            2 | 3 => {
                let turn = if self.whole {
                    DQuat::IDENTITY
                } else {
                    let angles = vector(random, 3.0);
                    DQuat::from_euler(EulerRot::XYZ, angles.x, angles.y, angles.z)
                };
                let scale = DVec3::new(1.0, 2.0, -0.5);
                let solid = solid(random);
                let placement = Placement::new(scale, turn, at).unwrap();
                Placed { solid, placement }.into()
            }
            4 => self.polygon(at, random),
            5 => self.mesh(at, random),
            _ => Triangle::new([at, at + self.offset(random), at + self.offset(random)]).into(),
        }
    }

    /// A regular polygon, or a rectangle along axes.
    fn polygon(&self, at: DVec3, random: &mut Pcg64) -> Shape {
        let (u, v) = if self.whole {
            let axis = random.random_range(0..3);
            (DVec3::AXES[axis], DVec3::AXES[(axis + 1) % 3])
        } else {
            vector(random, 1.0)
                .normalize_or(DVec3::X)
                .any_orthonormal_pair()
        };
        let r = self.length(random);
        let n = random.random_range(3..8);
        let corners = (0..n).map(|i| {
            let (y, x) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
            at + u * (x * r) + v * (y * r)
        });
        let rectangle = vec![at, at + u * r, at + u * r + v * r, at + v * r];
        let corners = if self.whole {
            rectangle
        } else {
            corners.collect()
        };
        let mut polygon = Polygon::new(corners).unwrap();
        if random.random_bool(0.5) {
            polygon.method = polygon::Method::Marchal;
        }
        polygon.into()
    }

    /// A strip of triangles.
    fn mesh(&self, at: DVec3, random: &mut Pcg64) -> Shape {
        let n = random.random_range(3..12);
        let places: Vec<DVec3> = (0..n).map(|_| at + self.offset(random)).collect();
        let points = Points {
            triangles: (2..n).map(|i| [i - 2, i - 1, i]).collect(),
            normals: Vec::new(),
            uv: vec![DVec2::ZERO; places.len()],
            places,
        };
        let kind = Kind::ALL[random.random_range(0..Kind::ALL.len())];
        Mesh::new(points, kind).unwrap().into()
    }

    /// A ray: from inside or outside, sometimes along axes or from face to face, at a point of the
    /// scene or past it.
    fn ray(&self, random: &mut Pcg64) -> Ray {
        let origin = match random.random_range(0..6) {
            0 => self.middle + vector(random, self.size * 1e3),
            1 => self.middle + vector(random, 1e6),
            2 => self.middle + vector(random, self.size * 3.0),
            _ => self.point(random),
        };
        let direction = match random.random_range(0..4) {
            0 => whole(random, 1),
            1 => vector(random, 1.0),
            _ => self.point(random) - origin,
        };
        let direction = if direction == DVec3::ZERO {
            DVec3::NEG_Y
        } else {
            direction
        };
        Ray { origin, direction }
    }
}

/// All structures over a scene, brute force first.
fn build(objects: &Objects) -> Vec<(Kind, Structure)> {
    let build = |kind| (kind, Structure::new(kind, objects));
    Kind::ALL.into_iter().map(build).collect()
}

/// Compares the answers to a ray; returns what it found.
fn compare(
    objects: &Objects,
    structures: &[(Kind, Structure)],
    ray: Ray,
    start: Option<&Start>,
) -> Result<Option<Found>, String> {
    let cast = Cast::new(ray);
    let all = f64::INFINITY;
    let expected = structures[0].1.nearest(objects, &cast, start, all, &mut ());
    let t = expected.map(|e| e.contact.t);
    for (kind, structure) in structures {
        let mut counters = Counters::default();
        let found = structure.nearest(objects, &cast, start, all, &mut counters);
        if found != expected {
            return Err(format!(
                "{kind}: {ray:?} from {start:?}: {found:?}, not {expected:?}"
            ));
        }
        let any = |before: f64| structure.any(objects, &cast, start, before, &mut ());
        let (free, blocked) = match t {
            Some(t) => (any(t).is_none(), any(t.next_up()).is_some()),
            None => (any(all).is_none(), true),
        };
        if !free || !blocked {
            return Err(format!(
                "{kind}: {ray:?} from {start:?}: any contact before {t:?}"
            ));
        }
        if let Some(t) = t {
            let same = structure.nearest(objects, &cast, start, t, &mut ());
            let none = structure.nearest(objects, &cast, start, t.next_down(), &mut ());
            if same != expected || none.is_some() {
                return Err(format!("{kind}: {ray:?} limited to {t}"));
            }
        }
    }
    Ok(expected)
}

/// What a scene's test saw.
#[derive(Default)]
struct Seen {
    rays: usize,
    hits: usize,
    ties: usize,
}

fn check(seed: u64, objects: &Objects, style: &Style, rays: usize) -> Result<Seen, String> {
    let mut random = Pcg64::seed_from_u64(seed);
    let structures = build(objects);
    for (kind, structure) in &structures {
        structure
            .validate(objects)
            .map_err(|why| format!("seed {seed}, {kind}: {why}"))?;
        assert!(structure.bytes() > 0);
    }
    let mut seen = Seen::default();
    for _ in 0..rays {
        let mut ray = style.ray(&mut random);
        let mut start = None;
        // A path of up to three rays, each from where the one before ended.
        for _ in 0..3 {
            let found = compare(objects, &structures, ray, start.as_ref())
                .map_err(|why| format!("seed {seed}: {why}"))?;
            seen.rays += 1;
            let Some(found) = found else {
                break;
            };
            seen.hits += 1;
            // Others at the same time, computed without any structure.
            let bare = |i: u32| {
                let (cast, all) = (Cast::new(ray), f64::INFINITY);
                objects.contact(i, &cast, None, Want::Nearest, all, &mut ())
            };
            let same = |&i: &u32| {
                objects.bounds(i) == objects.bounds(found.primitive)
                    && bare(i).is_some_and(|c| Some(c.t) == bare(found.primitive).map(|c| c.t))
            };
            let mut equals = (0..objects.len() as u32).filter(same);
            if start.is_none() {
                if equals.next().is_some_and(|i| i != found.primitive) {
                    return Err(format!("seed {seed}: {ray:?}: not the lowest of equals"));
                }
                seen.ties += usize::from(equals.next().is_some());
            }
            let hit = objects.hit(&ray, &found);
            let direction = vector(&mut random, 1.0);
            start = Some(hit.start(found.primitive, direction));
            ray = Ray {
                origin: hit.point,
                direction,
            };
        }
    }
    Ok(seen)
}

fn sum(seen: impl ParallelIterator<Item = Result<Seen, String>>) -> Seen {
    let add = |a: Seen, b: Seen| Seen {
        rays: a.rays + b.rays,
        hits: a.hits + b.hits,
        ties: a.ties + b.ties,
    };
    match seen.try_reduce(Seen::default, |a, b| Ok(add(a, b))) {
        Ok(seen) => seen,
        Err(why) => panic!("{why}"),
    }
}

/// 10,000 random scenes of random shapes: every structure gives brute force's nearest contact and the
/// same answer about any contact.
#[test]
fn ten_thousand_scenes() {
    let scene = |seed: u64| {
        let mut random = Pcg64::seed_from_u64(seed);
        let style = Style::random(&mut random);
        let n = match seed % 100 {
            0 => 300,
            1..20 => random.random_range(20..60),
            _ => random.random_range(1..20),
        };
        let mut shapes: Vec<Shape> = (0..n).map(|_| style.shape(&mut random)).collect();
        // The same shape twice: the lower number wins.
        if seed % 3 == 0 {
            shapes.push(shapes[0].clone());
        }
        check(seed, &Objects::new(shapes), &style, 4)
    };
    let seen = sum((0..10_000).into_par_iter().map(scene));
    println!(
        "{} rays, {} contacts, {} of several at once",
        seen.rays, seen.hits, seen.ties
    );
    assert!(seen.rays > 50_000 && seen.hits > 20_000 && seen.ties > 500);
}

#[test]
fn degenerate_scenes() {
    let plain = Style {
        middle: DVec3::ZERO,
        size: 4.0,
        object: 1.0,
        whole: true,
    };
    let point = |p: DVec3| Shape::from(Solid::Cuboid(Cuboid::new(p, p)));
    let sheet = |z: f64, size: f64| {
        let low = DVec3::new(-size, -size, z);
        Shape::from(Solid::Cuboid(Cuboid::new(low, DVec3::new(size, size, z))))
    };
    let mut random = Pcg64::seed_from_u64(1);
    let triangle = |random: &mut Pcg64| {
        let flat = |p: DVec3| DVec3::new(p.x, p.y, 1.0);
        let corners = [whole(random, 4), whole(random, 4), whole(random, 4)];
        Shape::from(Triangle::new(corners.map(flat)))
    };
    let scenes: Vec<(&str, Vec<Shape>)> = vec![
        ("nothing", vec![]),
        (
            "one sphere",
            vec![
                Solid::Sphere(Sphere {
                    centre: DVec3::ONE,
                    radius: 1.0,
                })
                .into(),
            ],
        ),
        ("one point at the origin", vec![point(DVec3::ZERO)]),
        (
            "all in one point",
            (0..50).map(|_| point(DVec3::ONE)).collect(),
        ),
        ("a point far away", vec![point(DVec3::splat(1e6))]),
        ("equal sheets", (0..50).map(|_| sheet(1.0, 3.0)).collect()),
        (
            "a pile of sheets",
            (0..50)
                .map(|i| sheet(f64::from(i % 7) * 0.5, 3.0))
                .collect(),
        ),
        (
            "coplanar triangles",
            (0..80).map(|_| triangle(&mut random)).collect(),
        ),
        (
            "a row along x",
            (0..60).map(|i| point(DVec3::X * f64::from(i))).collect(),
        ),
        (
            "large and small",
            (0..40)
                .map(|i| {
                    let r = 2f64.powi(i - 30);
                    Solid::Sphere(Sphere {
                        centre: DVec3::X * r,
                        radius: r * 0.5,
                    })
                    .into()
                })
                .collect(),
        ),
        (
            "walls of a lattice",
            (0..27)
                .map(|i| {
                    let p = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
                    Solid::Cuboid(Cuboid::new(p * 2.0 - 3.0, p * 2.0 - 1.0)).into()
                })
                .collect(),
        ),
    ];
    for (seed, (name, shapes)) in (0..).zip(scenes) {
        let objects = Objects::new(shapes);
        if let Err(why) = check(seed, &objects, &plain, 400) {
            panic!("{name}: {why}");
        }
        // Along axes, in faces and edges, with zeros of both signs.
        let structures = build(&objects);
        for x in -4..=4 {
            for y in -4..=4 {
                for axis in 0..3 {
                    for sign in [1.0, -1.0] {
                        let direction = DVec3::AXES[axis] * sign;
                        let beside = DVec3::AXES[(axis + 1) % 3] * f64::from(x)
                            + DVec3::AXES[(axis + 2) % 3] * f64::from(y);
                        let ray = Ray {
                            origin: beside - direction * 9.0,
                            direction,
                        };
                        // From so far away that no margin makes up for rounding.
                        let far = Ray {
                            origin: beside * 1e9 + 1.0,
                            direction: beside - (beside * 1e9 + 1.0),
                        };
                        for ray in [ray, far] {
                            if let Err(why) = compare(&objects, &structures, ray, None) {
                                panic!("{name}: {why}");
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The answers do not depend on boxes and structures at all, but for the last places of t: against
/// the bare shapes.
#[test]
fn boxes_cut_nothing_off() {
    let mut random = Pcg64::seed_from_u64(5);
    let mut hits = 0;
    for _ in 0..2000 {
        let style = Style::random(&mut random);
        let shapes: Vec<Shape> = (0..5).map(|_| style.shape(&mut random)).collect();
        let objects = Objects::new(shapes);
        let brute = Structure::new(Kind::Brute, &objects);
        for _ in 0..10 {
            let cast = Cast::new(style.ray(&mut random));
            let bare = (0..5)
                .filter_map(|i| {
                    let all = f64::INFINITY;
                    objects.contact(i, &cast, None, Want::Nearest, all, &mut ())
                })
                .map(|contact| contact.t)
                .reduce(f64::min);
            let found = brute.nearest(&objects, &cast, None, f64::INFINITY, &mut ());
            let t = found.map(|f| f.contact.t);
            assert_eq!(bare.is_some(), t.is_some(), "{:?}", cast.ray);
            if let (Some(bare), Some(t)) = (bare, t) {
                let apart = (bare - t).abs() * cast.ray.direction.length();
                let scale = cast.ray.origin.length() + objects.bounds(0).reach();
                assert!(apart <= scale * 1e-13, "{bare} {t}: {:?}", cast.ray);
                hits += 1;
            }
        }
    }
    assert!(hits > 3000, "{hits}");
}

#[test]
fn structures_save_work() {
    let mut random = Pcg64::seed_from_u64(9);
    let style = Style {
        middle: DVec3::ZERO,
        size: 100.0,
        object: 1.0,
        whole: false,
    };
    let objects = Objects::new((0..2000).map(|_| style.shape(&mut random)).collect());
    let rays: Vec<Ray> = (0..200).map(|_| style.ray(&mut random)).collect();
    for (kind, structure) in build(&objects) {
        let mut counters = Counters::default();
        for &ray in &rays {
            structure.nearest(
                &objects,
                &Cast::new(ray),
                None,
                f64::INFINITY,
                &mut counters,
            );
        }
        println!("{kind}: {counters:?}, {} bytes", structure.bytes());
        let tests = counters.tests as usize;
        if kind == Kind::Brute {
            assert!(tests >= 2000 * 200);
        } else {
            assert!(tests < 2000 * 200 / 10, "{kind}: {tests}");
            assert!(counters.cells > 0);
        }
    }
}

#[test]
fn names_are_read_back() {
    for kind in Kind::ALL {
        assert_eq!(kind.to_string().parse(), Ok(kind));
    }
    let error = "sphere-tree".parse::<Kind>().unwrap_err();
    assert!(error.contains("octree"), "{error}");
}
