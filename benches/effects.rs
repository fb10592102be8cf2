//! What effects cost that a picture has nothing of: the renderer with them compiled in against the one
//! specialised for the picture.
//!
//! `cargo bench --bench effects` prints, for some levels without mirrors, the median time of a picture
//! with the effects that it calls for (`auto`: reflection is compiled out), of the same once more
//! (`again`, which tells how far noise goes), with reflection compiled in that finds nothing to reflect
//! (`mirror`), with all effects compiled in (`all`), and without any (`none`, another picture). The
//! ratios are the medians over the rounds, each against `auto` in the same round. Processor time of
//! one thread; the versions take turns, so that noise meets all of them.

use enfilade::cells::{Locator, Options, subdivide};
use enfilade::level::read;
use enfilade::pvs::{Progress, sweep};
use enfilade::trace::Tracer;
use enfilade::trace::camera::Camera;
use enfilade::trace::effects::{Effect, Effects, survey};
use enfilade::trace::render::{RenderOptions, render};
use enfilade::trace::world::{Files, World, locate};

use rustix::time::{ClockId, clock_gettime};

const ROUNDS: usize = 15;
const SIZE: [u32; 2] = [320, 200];
const VERSIONS: [&str; 5] = ["auto", "again", "mirror", "all", "none"];

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("one thread can be had");
    print!("{:<10} {:>9}", "level", "auto ms");
    for version in &VERSIONS[1..] {
        print!(" {:>11}", format!("{version}/auto"));
    }
    println!("  effects called for");
    for name in ["tiny", "office", "house", "theatre", "cathedral"] {
        let path = format!("{}/levels/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let bytes = std::fs::read(&path).expect("a sample level");
        let level = read::read(bytes, &path, None).expect("a sample level");
        let graph = subdivide(&level, &Options::default());
        let pvs = sweep::sweep(&graph, &Progress::default());
        let world = World::new(&level, &graph, &pvs, &Files::default(), 0.12);
        let world = world.expect("a sample level without meshes");
        let view = &level.scene.cameras[0];
        let camera = Camera::new(view.eye, view.direction, view.fov, SIZE);
        let cell = locate(&world, &graph, &Locator::new(&graph), view.eye).expect("an eye inside");
        let needed = survey(&world, &pvs, cell).needed;
        if needed.has(Effect::Mirror) {
            println!("{name:<10} has a mirror in sight: left out");
            continue;
        }
        let tracer = Tracer::new(&world);
        let versions = [
            needed,
            needed,
            needed.with(Effect::Mirror),
            Effects::ALL,
            Effects::NONE,
        ];
        let mut times: [Vec<f64>; VERSIONS.len()] = Default::default();
        for round in 0..ROUNDS {
            for k in 0..versions.len() {
                // Nobody is always first.
                let k = (k + round) % versions.len();
                let options = RenderOptions {
                    effects: versions[k],
                    ..RenderOptions::default()
                };
                let (time, rays) = pool.install(|| {
                    let start = now();
                    let rendered = render(&tracer, &camera, cell, &options, &Progress::default());
                    (now() - start, rendered.work.rays)
                });
                assert_eq!(rays.primary, u64::from(SIZE[0] * SIZE[1]));
                times[k].push(time * 1e3);
            }
        }
        print!("{name:<10} {:>9.1}", median(times[0].clone()));
        for other in &times[1..] {
            let ratios = other.iter().zip(&times[0]).map(|(a, b)| a / b);
            print!(" {:>11.3}", median(ratios.collect()));
        }
        println!("  {needed}");
    }
}

fn now() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_unstable_by(f64::total_cmp);
    list[list.len() / 2]
}
