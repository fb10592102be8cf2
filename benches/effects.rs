//! What effects cost that a picture has nothing of: the renderer with them compiled in against the one
//! specialised for the picture.
//!
//! `cargo bench --bench effects` prints, for some levels, the median time of a picture with the
//! effects that it calls for (`auto`), with all effects compiled in and none of the extra ones to be
//! seen (`all`), and without any (`none`, another picture); and the ratio of the first two. One
//! thread; the versions take turns, so that noise meets all of them.

use std::time::Instant;

use enfilade::cells::{Locator, Options, subdivide};
use enfilade::level::read;
use enfilade::pvs::{Progress, sweep};
use enfilade::trace::Tracer;
use enfilade::trace::camera::Camera;
use enfilade::trace::effects::{Effects, survey};
use enfilade::trace::render::{RenderOptions, render};
use enfilade::trace::world::{Files, World, locate};

const ROUNDS: usize = 9;
const SIZE: [u32; 2] = [320, 200];

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("one thread can be had");
    println!(
        "{:<10} {:>9} {:>9} {:>9} {:>9}  effects called for",
        "level", "auto ms", "all ms", "none ms", "all/auto"
    );
    for name in ["tiny", "museum", "office", "theatre"] {
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
        let tracer = Tracer::new(&world);
        let mut times = [const { Vec::new() }; 3];
        for _ in 0..ROUNDS {
            for (times, effects) in times.iter_mut().zip([needed, Effects::ALL, Effects::NONE]) {
                let options = RenderOptions {
                    effects,
                    ..RenderOptions::default()
                };
                let start = Instant::now();
                let rendered =
                    pool.install(|| render(&tracer, &camera, cell, &options, &Progress::default()));
                times.push(start.elapsed().as_secs_f64() * 1e3);
                assert_eq!(rendered.work.rays.primary, 64_000);
            }
        }
        let [auto, all, none] = times.map(|mut times: Vec<f64>| {
            times.sort_unstable_by(f64::total_cmp);
            times[ROUNDS / 2]
        });
        println!(
            "{name:<10} {auto:>9.1} {all:>9.1} {none:>9.1} {:>9.3}  {needed}",
            all / auto
        );
    }
}
