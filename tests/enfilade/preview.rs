//! Painted pictures: the same surface on every pixel as the first that a ray meets, and the same texel;
//! and the same picture whatever is left out because the eye cannot see it, in both orders, on any number
//! of threads.

use enfilade::cells::{Locator, Options as Split, Subdivision};
use enfilade::preview::coat::{Stuff, dim};
use enfilade::preview::fill::faded;
use enfilade::preview::{Canvas, Culling, Easel, Figures, Finish, Options, Order, Painter};
use enfilade::trace::Tracer;
use enfilade::trace::camera::Camera;
use enfilade::trace::dress::Look;
use enfilade::trace::space::Surface;
use enfilade::trace::world::{Departure, Hit, What, World, locate};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::agree::tomls;
use crate::scene::{FREEDOOM, Scene};

const SIZE: [u32; 2] = [96, 64];

/// A camera in a random place with room to stand in, not on a border, where two cells may stand at
/// different heights.
fn random_camera(scene: &Scene, locator: &Locator, random: &mut Pcg64) -> Camera {
    loop {
        let cell = enfilade::cells::CellId(random.random_range(0..scene.graph.cells.len() as u32));
        let corners: Vec<DVec2> = (scene.graph.corners(cell))
            .map(|v| scene.graph.vertices.exact(v).to_level(&scene.graph.grid))
            .collect();
        let weights: Vec<f64> = corners.iter().map(|_| random.random::<f64>()).collect();
        let sum: f64 = weights.iter().sum();
        let mix = corners.iter().zip(&weights).map(|(c, w)| *c * *w);
        let Some(at) = scene.graph.grid.nearest(mix.sum::<DVec2>() / sum) else {
            continue;
        };
        let [own] = locator.cells_at(&scene.graph, &at.into())[..] else {
            continue;
        };
        let chamber = scene.world.space.cell(own.0);
        if chamber.floor >= chamber.ceiling {
            continue;
        }
        let share: f64 = random.random_range(0.02..0.98);
        let z = chamber.floor + (chamber.ceiling - chamber.floor) * share;
        let eye = scene.graph.grid.to_level(at).extend(z);
        let angle = random.random_range(0.0..std::f64::consts::TAU);
        let slope = random.random_range(-0.8..0.8);
        return Camera::new(eye, DVec2::from_angle(angle).extend(slope), 90.0, SIZE);
    }
}

/// What pictures showed.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    pixels: u64,
    /// Another surface than the ray's, in any of the pictures.
    differ: u64,
    /// Pixels with a picture of which a texel was compared, and those of another colour.
    texels: u64,
    wrong_texels: u64,
    /// Pixels of the sky, and those that are clearly of another colour than in the ray's direction.
    sky: u64,
    wrong_sky: u64,
    /// Objects' pixels.
    objects: u64,
    /// Polygons painted, by culling.
    painted: [u64; 3],
}

/// The first thing that a ray meets that is no hole, and how far it is along the ray from the eye.
pub fn first(tracer: &Tracer, camera: &Camera, start: Departure, at: DVec2) -> (Hit, f64) {
    let mut ray = camera.ray(at);
    let (mut from, mut way) = (start, 0.0);
    loop {
        let met = tracer.nearest(&ray, &from, f64::INFINITY);
        let hit = tracer.hit(&ray, &met.expect("the level is closed"));
        way += hit.t;
        let open = hit.material.is_none() && matches!(hit.what, What::Surface(Surface::Pane(_)));
        if tracer.world.look(&hit) != Look::Hole && !open {
            return (hit, way);
        }
        ray.origin = hit.point;
        from = tracer.depart(&hit, ray.direction);
    }
}

/// Whether a pixel shows what a ray has met.
pub fn same(painter: &Painter, shown: u32, what: What) -> bool {
    let polygons = painter.polygons();
    let n = polygons.iter().len() as u32;
    match what {
        What::Surface(surface) => shown < n && polygons.get(shown).surface == surface,
        What::Object(number) => shown == n + number,
    }
}

/// The bytes that a pixel must have for what the ray tracer finds there: the picture's texel, where it
/// knows one. `None` where there is no picture.
fn texel(painter: &Painter, world: &World, shown: u32, hit: &Hit, way: f64) -> Option<u32> {
    let coats = painter.coats();
    let coat = coats.list.get(shown as usize)?;
    let (Stuff::Picture(map) | Stuff::Grating(map)) = &coat.stuff else {
        return None;
    };
    let own = match world.look(hit) {
        Look::Texel(colour) => coats.exposed(colour),
        _ => coats.texel(map, hit.point),
    };
    Some(dim(own, faded(coats.fade(coat.light), way.recip())))
}

/// Whether two colours differ by more than so much in any channel.
fn far(a: u32, b: u32, most: u8) -> bool {
    let channels = a.to_le_bytes().into_iter().zip(b.to_le_bytes());
    channels.into_iter().any(|(a, b)| a.abs_diff(b) > most)
}

/// Pictures from random eyes, in every way there is, against rays.
fn check(scene: &Scene, eyes: u32, seed: u64) -> Seen {
    let (world, locator) = (&scene.world, Locator::new(&scene.graph));
    let tracer = Tracer::new(world);
    let painters = [Finish::Flat, Finish::Textured].map(|finish| {
        Painter::new(world, &scene.graph, &scene.pvs, finish).expect("it was split by lines")
    });
    let mut random = Pcg64::seed_from_u64(seed);
    let mut seen = Seen::default();
    let mut easel = Easel::default();
    for _ in 0..eyes {
        let camera = random_camera(scene, &locator, &mut random);
        let cell = locate(world, &scene.graph, &locator, camera.eye).expect("it is inside");
        let mut canvases: Vec<Canvas> = Vec::new();
        for painter in &painters {
            for (culling, painted) in Culling::ALL.into_iter().zip(&mut seen.painted) {
                let mut draw = |order| {
                    let options = Options {
                        culling,
                        order,
                        objects: true,
                        surfaces: true,
                    };
                    let figures = painter.draw(&camera, &options, &mut easel);
                    (easel.canvas.clone(), figures.expect("the eye is inside"))
                };
                let (canvas, far) = draw(Order::BackToFront);
                let (other, near) = draw(Order::FrontToBack);
                assert_eq!(canvas.pixels, other.pixels);
                assert_eq!(canvas.surfaces, other.surfaces);
                assert!(near.pixels <= far.pixels && far.shown <= far.painted);
                let n = u64::from(SIZE[0] * SIZE[1]);
                assert_eq!([far.covered, near.covered], [n; 2], "no holes");
                *painted += far.painted;
                canvases.push(canvas);
            }
        }
        let start = Departure::within(cell);
        for i in 0..(SIZE[0] * SIZE[1]) as usize {
            let [x, y] = [i as u32 % SIZE[0], i as u32 / SIZE[0]].map(f64::from);
            let (hit, way) = first(&tracer, &camera, start, DVec2::new(x + 0.5, y + 0.5));
            seen.pixels += 1;
            seen.objects += u64::from(matches!(hit.what, What::Object(_)));
            let right = canvases
                .iter()
                .all(|c| same(&painters[0], c.surfaces[i], hit.what))
                && canvases[..3]
                    .iter()
                    .all(|c| c.pixels[i] == canvases[0].pixels[i])
                && canvases[3..]
                    .iter()
                    .all(|c| c.pixels[i] == canvases[3].pixels[i]);
            seen.differ += u64::from(!right);
            let canvas = &canvases[3];
            if !right {
                continue;
            }
            if let What::Surface(surface) = hit.what
                && world.is_sky(surface)
                && hit
                    .material
                    .is_none_or(|_| !matches!(surface, Surface::Outside(_)))
            {
                let direction = camera.ray(DVec2::new(x + 0.5, y + 0.5)).direction;
                let expected = painters[1].coats().sky(world, direction);
                seen.sky += 1;
                seen.wrong_sky += u64::from(far(canvas.pixels[i], expected, 16));
            }
            if let Some(expected) = texel(&painters[1], world, canvas.surfaces[i], &hit, way) {
                seen.texels += 1;
                seen.wrong_texels += u64::from(far(canvas.pixels[i], expected, 2));
            }
        }
    }
    seen
}

fn assert_right(name: &str, seen: &Seen) {
    println!(
        "{name}: {} of {} pixels differ, {} of {} texels, {} of {} pixels of the sky; {} pixels of objects; \
         polygons painted: {} of all cells, {} with the PVS, {} with the eye's view",
        seen.differ,
        seen.pixels,
        seen.wrong_texels,
        seen.texels,
        seen.wrong_sky,
        seen.sky,
        seen.objects,
        seen.painted[0],
        seen.painted[1],
        seen.painted[2]
    );
    assert!(seen.differ * 10_000 <= seen.pixels, "{name}: {seen:?}");
    assert!(seen.wrong_texels * 1000 <= seen.texels, "{name}: {seen:?}");
    // Between some columns the place of its texels is interpolated.
    assert!(seen.wrong_sky * 20 <= seen.sky, "{name}: {seen:?}");
    let [all, pvs, eye] = seen.painted;
    assert!(eye <= pvs && pvs <= all, "{name}: {seen:?}");
}

#[test]
fn sample_levels_are_painted_as_rays_see_them() {
    let mut sum = Seen::default();
    for path in tomls("levels") {
        let name = path.file_stem().expect("it is a file").to_string_lossy();
        for subdivision in [Subdivision::Bsp, Subdivision::Kd] {
            let options = Split {
                subdivision,
                ..Split::default()
            };
            let seen = check(&Scene::sample_split(&name, &options), 8, 7);
            assert_right(&format!("{name} {}", subdivision.as_str()), &seen);
            sum.pixels += seen.pixels;
            sum.objects += seen.objects;
            sum.texels += seen.texels;
        }
    }
    assert!(
        sum.pixels > 500_000 && sum.objects > 50_000 && sum.texels > 50_000,
        "{sum:?}"
    );
}

#[test]
fn maps_of_freedoom_are_painted_as_rays_see_them() {
    let second = FREEDOOM.replace("freedoom1", "freedoom2");
    let maps = [
        (FREEDOOM, ["E1M1", "E1M2", "E1M5", "E2M3", "E3M7"]),
        (&second, ["MAP01", "MAP05", "MAP12", "MAP15", "MAP28"]),
    ];
    for (file, names) in maps {
        for name in names {
            let Some(scene) = Scene::of_wad(file, name) else {
                continue;
            };
            let seen = check(&scene, 8, 3);
            assert_right(name, &seen);
            assert!(seen.painted[2] < seen.painted[1] && seen.painted[1] < seen.painted[0]);
            assert!(seen.texels > 10_000, "{seen:?}");
        }
    }
}

#[test]
fn threads_and_what_was_painted_before_change_nothing() {
    let scene = Scene::sample("cathedral");
    let painter = Painter::new(&scene.world, &scene.graph, &scene.pvs, Finish::Textured);
    let painter = painter.expect("it was split by lines");
    let mut random = Pcg64::seed_from_u64(9);
    let locator = Locator::new(&scene.graph);
    let options = Options {
        objects: true,
        surfaces: true,
        ..Options::default()
    };
    let pool = |n| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(n)
            .build()
            .unwrap()
    };
    let (one, three) = (pool(1), pool(3));
    let mut easel = Easel::default();
    for _ in 0..6 {
        let camera = random_camera(&scene, &locator, &mut random);
        let draw = |easel: &mut Easel| -> Figures {
            painter
                .draw(&camera, &options, easel)
                .expect("it is inside")
        };
        let figures = one.install(|| draw(&mut easel));
        let mut fresh = Easel::default();
        assert_eq!(figures, three.install(|| draw(&mut fresh)));
        assert_eq!(easel.canvas.pixels, fresh.canvas.pixels);
        assert_eq!(easel.canvas.surfaces, fresh.canvas.surfaces);
    }
}

#[test]
fn an_eye_in_a_wall_is_refused() {
    let scene = Scene::sample("tiny");
    let painter = Painter::new(&scene.world, &scene.graph, &scene.pvs, Finish::Flat);
    let camera = Camera::new(DVec3::splat(-1e4), DVec3::X, 90.0, SIZE);
    let drawn = painter
        .unwrap()
        .draw(&camera, &Options::default(), &mut Easel::default());
    assert!(drawn.is_err());
}
