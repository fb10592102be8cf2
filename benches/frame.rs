//! What a whole frame costs: textures, Phong, lights and hard shadows.
//!
//! `cargo bench --bench frame` draws freedoom1's E1M1 at 960 × 600 from 16 eyes (the middles of cells,
//! drawn by a seed), on one thread and on two: the level's own textures without lights; with two point
//! lights in sight, with and without shadows; and with all its lamps. Medians of the eyes, milliseconds
//! and frames per second, and against the first row. It looks for the WAD in /usr/share/games/doom, or
//! in the folder that the variable `FREEDOOM` names.

use std::time::Instant;

use enfilade::cells::{CellId, Options, subdivide};
use enfilade::level::doom::graphics;
use enfilade::level::read::Source;
use enfilade::level::scene::{Light, LightShape};
use enfilade::pvs::{Progress, sweep};
use enfilade::trace::Tracer;
use enfilade::trace::camera::Camera;
use enfilade::trace::effects::{Effect, Effects, survey};
use enfilade::trace::render::{RenderOptions, render};
use enfilade::trace::sampling::Source as Random;
use enfilade::trace::world::{Files, World};
use glam::DVec3;

const EYES: usize = 16;
const ROUNDS: usize = 5;
const SIZE: [u32; 2] = [960, 600];
const THREADS: [usize; 2] = [1, 2];

/// What is drawn.
#[derive(Clone, Copy, PartialEq)]
enum Frame {
    Textures,
    TwoLights,
    TwoLightsShadows,
    Lamps,
}

const FRAMES: [(Frame, &str); 4] = [
    (Frame::Textures, "textures, sector light"),
    (Frame::TwoLights, "two lights, no shadows"),
    (Frame::TwoLightsShadows, "two lights, hard shadows"),
    (Frame::Lamps, "all lamps, hard shadows"),
];

fn main() {
    let folder = std::env::var("FREEDOOM").unwrap_or("/usr/share/games/doom".to_string());
    let path = format!("{folder}/freedoom1.wad");
    let Ok(bytes) = std::fs::read(&path) else {
        println!("left out: {path} is not there (apt-get install freedoom)");
        return;
    };
    let source = Source::parse(bytes, &path).expect("a WAD");
    let level = source.level(Some("E1M1")).expect("a map");
    let graph = subdivide(&level, &Options::default());
    let pvs = sweep::sweep(&graph, &Progress::default());
    let files = Files {
        dress: graphics::pictures(source.wad().expect("a WAD"), &level.scene.dress),
        ..Files::default()
    };
    let pools = THREADS.map(|n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        pool.expect("threads can be had")
    });
    let world_with = |lights: Option<Vec<Light>>| {
        let mut level = level.clone();
        if let Some(lights) = lights {
            level.scene.lights = lights;
        }
        World::new(&level, &graph, &pvs, &files, 0.12).expect("a map without meshes")
    };
    let (dark, lamps) = (world_with(Some(Vec::new())), world_with(None));
    // By frame and by number of threads.
    let mut times = FRAMES.map(|_| THREADS.map(|_| Vec::new()));
    let mut shadow_rays = FRAMES.map(|_| Vec::new());
    for (cell, eye, direction) in eyes(&dark) {
        let two = world_with(Some(two_lights(&dark, pvs.seen_from(cell))));
        let camera = Camera::new(eye, direction, 75.0, SIZE);
        for (k, (frame, _)) in FRAMES.into_iter().enumerate() {
            let world = match frame {
                Frame::Textures => &dark,
                Frame::TwoLights | Frame::TwoLightsShadows => &two,
                Frame::Lamps => &lamps,
            };
            let mut effects = survey(world, &pvs, cell).needed;
            if frame == Frame::TwoLights {
                effects = Effects::NONE.with(Effect::Textures);
            }
            let options = RenderOptions {
                effects,
                ..RenderOptions::default()
            };
            let tracer = Tracer::new(world);
            for (pool, times) in pools.iter().zip(&mut times[k]) {
                let each = (0..ROUNDS).map(|_| {
                    let start = Instant::now();
                    let rendered = pool
                        .install(|| render(&tracer, &camera, cell, &options, &Progress::default()));
                    let time = start.elapsed().as_secs_f64() * 1e3;
                    (time, rendered.work.rays.shadow)
                });
                let (mut each, shadows): (Vec<f64>, Vec<u64>) = each.unzip();
                shadow_rays[k].push(shadows[0] as f64);
                times.push(median(&mut each));
            }
        }
    }
    println!("E1M1, {} × {}, {EYES} eyes", SIZE[0], SIZE[1]);
    println!(
        "{:<26} {:>11} {:>8} {:>8} {:>9} {:>8} {:>7}",
        "", "shadow rays", "1 thread", "a second", "2 threads", "a second", "× first"
    );
    let mut first = None;
    for ((_, name), (mut times, mut rays)) in
        FRAMES.into_iter().zip(times.into_iter().zip(shadow_rays))
    {
        let [one, two] = [0, 1].map(|k| median(&mut times[k]));
        let first = *first.get_or_insert(one);
        println!(
            "{name:<26} {:>11.0} {one:>6.1} ms {:>8.1} {two:>7.1} ms {:>8.1} {:>7.2}",
            median(&mut rays),
            1e3 / one,
            1e3 / two,
            one / first
        );
    }
}

fn median(list: &mut [f64]) -> f64 {
    list.sort_unstable_by(f64::total_cmp);
    list[list.len() / 2]
}

/// Eyes as high as a person's, in cells in which there is room for one.
fn eyes(world: &World) -> Vec<(CellId, DVec3, DVec3)> {
    let mut random = Random::new(1, 2, 3);
    let n = world.space.cells.len();
    let mut list = Vec::new();
    while list.len() < EYES {
        let cell = CellId((random.next() * n as f64) as u32);
        let chamber = world.space.cell(cell.0);
        let angle = random.next() * std::f64::consts::TAU;
        let (middle, area) = world.middle(cell);
        if chamber.ceiling - chamber.floor > 56.0 && area > 32.0 * 32.0 {
            let direction = DVec3::new(angle.cos(), angle.sin(), 0.0);
            list.push((cell, middle.extend(chamber.floor + 41.0), direction));
        }
    }
    list
}

/// In the two largest rooms in sight, at four fifths of their height; so bright that a floor below gets
/// about 1.
fn two_lights(world: &World, seen: impl Iterator<Item = CellId>) -> Vec<Light> {
    let mut cells: Vec<CellId> = seen.collect();
    cells.sort_by(|a, b| world.middle(*b).1.total_cmp(&world.middle(*a).1));
    let lights = cells.into_iter().take(2).map(|cell| {
        let chamber = world.space.cell(cell.0);
        let height = 0.8 * (chamber.ceiling - chamber.floor);
        let position = world.middle(cell).0.extend(chamber.floor + height);
        Light {
            name: None,
            intensity: [height * height; 3],
            shape: LightShape::Point { position },
        }
    });
    lights.collect()
}
