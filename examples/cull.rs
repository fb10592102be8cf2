//! Walks along a path in a level and culls a scene each frame, as an engine would.
//!
//!     cargo run --release --example cull -- levels/museum.toml
//!
//! A second argument names a path of the level (otherwise the first one). The scene is every floor and
//! every wall of the level, and the things that stand in it, each kept with the cell that it is in.
//! Printed for each frame: where the eye is, how many cells, walls and things are drawn of all, and the
//! rooms that are in view; at the end, the mean culling factors.

use std::collections::BTreeSet;
use std::error::Error;

use enfilade::cells::{CellGraph, CellId, EdgeId, Options, subdivide};
use enfilade::level::{Level, read};
use enfilade::pvs::file::{self, LevelInfo};
use enfilade::pvs::runtime::{Runtime, Workspace};
use enfilade::pvs::{Progress, sweep};
use enfilade::walk::{Track, TrackOptions};
use glam::DVec2;

/// Frames of the walk.
const FRAMES: u32 = 60;

/// What there is to draw, cell by cell.
struct Scene {
    walls: Vec<u32>,
    things: Vec<u32>,
}

impl Scene {
    fn new(level: &Level, runtime: &Runtime) -> Self {
        let graph = runtime.graph();
        let walls = |cell| {
            let edges = graph.edge_range(cell).map(EdgeId);
            edges.filter(|&e| graph.edge(e).twin().is_none()).count() as u32
        };
        let mut things = vec![0; graph.cells.len()];
        for object in &level.scene.objects {
            if let Some(cell) = runtime.locate(object.position.truncate()) {
                things[cell.0 as usize] += 1;
            }
        }
        Self {
            walls: graph.cell_ids().map(walls).collect(),
            things,
        }
    }

    /// Cells, walls and things in some cells.
    fn count(&self, cells: impl Iterator<Item = CellId>) -> [u32; 3] {
        cells.fold([0; 3], |[n, walls, things], cell| {
            let i = cell.0 as usize;
            [n + 1, walls + self.walls[i], things + self.things[i]]
        })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or("levels/museum.toml".into());
    let level = read::read(std::fs::read(&name)?, &name, None)?;
    let paths = &level.scene.paths;
    let path = match arguments.next() {
        Some(wanted) => paths.iter().find(|path| path.name == wanted),
        None => paths.first(),
    };
    let path = path.ok_or("the level has no such [[path]] to walk along")?;

    // Beforehand, in a build step: `enfilade build levels/museum.toml -o museum.pvs`.
    let bytes = precompute(&level);

    // When the engine starts.
    let runtime = Runtime::from_bytes(&bytes)?;
    let scene = Scene::new(&level, &runtime);
    let all = scene.count(runtime.graph().cell_ids());
    let mut workspace = Workspace::new(&runtime);
    println!(
        "{}: {} cells, {} walls, {} things; {} bytes of PVS",
        runtime.info().name,
        all[0],
        all[1],
        all[2],
        bytes.len()
    );

    // Each frame.
    let track = Track::along(path.points.clone(), 1.0, &TrackOptions::default());
    let (mut by_view, mut by_pvs, mut drawn) = (0.0, 0.0, 0);
    for frame in 0..FRAMES {
        let pose = track.at(track.seconds() * f64::from(frame) / f64::from(FRAMES));
        let eye = pose.eye.truncate();
        let direction = pose.direction.truncate().to_angle().to_degrees();
        let Some(here) = runtime.locate(eye) else {
            println!(
                "{frame:3}  {}: inside of a wall, nothing is culled",
                at(eye)
            );
            continue;
        };
        let view = runtime.look(eye, direction, path.fov, &mut workspace)?;
        let [cells, walls, things] = scene.count(view.cells().iter().copied());
        let seen: BTreeSet<&str> = (view.cells().iter())
            .filter_map(|&cell| room(&level, runtime.graph(), cell))
            .collect();
        println!(
            "{frame:3}  {} in {:20} {cells:3} cells {walls:4} walls {things:3} things: {}",
            at(eye),
            room(&level, runtime.graph(), here).unwrap_or("no room"),
            seen.into_iter().collect::<Vec<_>>().join(", ")
        );
        by_view += f64::from(all[0]) / f64::from(cells);
        by_pvs += f64::from(all[0]) / runtime.visible(here).count() as f64;
        drawn += 1;
    }
    let mean = |sum: f64| sum / f64::from(drawn.max(1));
    println!(
        "mean culling factor over {drawn} frames: {:.1} by what the eye sees, {:.1} by its cell's \
         visible set alone",
        mean(by_view),
        mean(by_pvs)
    );
    Ok(())
}

/// The bytes of the level's `.pvs` file.
fn precompute(level: &Level) -> Vec<u8> {
    let graph = subdivide(level, &Options::default());
    let pvs = sweep::sweep(&graph, &Progress::default());
    file::encode(&LevelInfo::of(level), &graph, &pvs)
}

fn at(eye: DVec2) -> String {
    format!("({:6.2}, {:6.2})", eye.x, eye.y)
}

/// The name of the room that a cell is in.
fn room<'a>(level: &'a Level, graph: &CellGraph, cell: CellId) -> Option<&'a str> {
    let sector = graph.cell(cell).sector?;
    level.sectors.get(sector.0 as usize)?.name.as_deref()
}
