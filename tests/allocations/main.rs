//! An engine's frames allocate nothing: counted on the heap itself, for which a test needs a program
//! of its own.

use std::hint::black_box;
use std::path::Path;

use allocation_counter::measure;
use enfilade::cells::{Options, Subdivision, subdivide};
use enfilade::geom::Vertex;
use enfilade::level::{Level, read};
use enfilade::pvs::file::{self, LevelInfo};
use enfilade::pvs::runtime::{Runtime, Workspace};
use enfilade::pvs::{Progress, sweep};
use glam::DVec2;

fn sample(name: &str) -> Level {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(name);
    read::read(std::fs::read(path).unwrap(), name, None).unwrap()
}

/// A map of Freedoom, if that is installed.
fn freedoom(map: &str) -> Option<Level> {
    let path = "/usr/share/games/doom/freedoom1.wad";
    match std::fs::read(path) {
        Ok(bytes) => Some(read::read(bytes, "freedoom1.wad", Some(map)).unwrap()),
        Err(_) => {
            let missing = format!("{path} is not there; install Freedoom");
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            None
        }
    }
}

fn runtime(level: &Level, subdivision: Subdivision) -> Runtime {
    let options = Options {
        subdivision,
        ..Options::default()
    };
    let graph = subdivide(level, &options);
    let pvs = sweep::sweep(&graph, &Progress::default());
    Runtime::from_bytes(&file::encode(&LevelInfo::of(level), &graph, &pvs)).unwrap()
}

#[test]
fn the_counter_counts() {
    let one = measure(|| drop(black_box(Vec::<u8>::with_capacity(100))));
    assert_eq!((one.count_total, one.bytes_total), (1, 100));
}

#[test]
fn no_frame_allocates() {
    let mut levels = vec![sample("museum.toml"), sample("house.toml")];
    levels.extend(freedoom("E1M5"));
    for level in &levels {
        for subdivision in Subdivision::ALL {
            let runtime = runtime(level, subdivision);
            let graph = runtime.graph();
            let mut workspace = Workspace::new(&runtime);
            // Eyes in the middle of every cell, on its corners, and beside the level.
            let middle = |cell| {
                let corners: Vec<DVec2> = (graph.corners(cell))
                    .map(|v| graph.vertices.exact(v).to_level(&graph.grid))
                    .collect();
                corners.iter().sum::<DVec2>() / corners.len() as f64
            };
            let mut eyes: Vec<DVec2> = graph.cell_ids().map(middle).collect();
            let corner = |v: &Vertex| v.to_level(&graph.grid);
            eyes.extend(graph.vertices.iter().map(corner).step_by(7));
            eyes.push(DVec2::splat(1e6));
            let (mut seen, mut ever) = (0, 0);
            for (i, &eye) in eyes.iter().enumerate() {
                let fov = [60.0, 90.0, 360.0][i % 3];
                let frame = measure(|| {
                    let Some(here) = runtime.locate(eye) else {
                        return;
                    };
                    ever += runtime.visible(here).count();
                    if let Ok(view) = runtime.look(eye, i as f64, fov, &mut workspace) {
                        seen += view.cells().len();
                    }
                });
                assert_eq!(
                    frame.count_total, 0,
                    "{}, {subdivision:?}: the eye at {eye}",
                    level.name
                );
            }
            println!(
                "{}, {subdivision:?}: {} frames, {seen} of {ever} cells seen",
                level.name,
                eyes.len()
            );
            assert!(seen > eyes.len() && ever > seen);
        }
    }
}
