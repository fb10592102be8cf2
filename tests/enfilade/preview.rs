//! Painted pictures: the same surface on every pixel as the first that a ray meets, whatever is left
//! out because the eye cannot see it.

use std::path::Path;

use enfilade::cells::{CellGraph, CellId, Locator, Options, Subdivision, subdivide};
use enfilade::geom::{GridPoint, Vertex};
use enfilade::level::read::Source;
use enfilade::level::{Level, doom, snap, wad::Wad};
use enfilade::preview::{Canvas, Coat, Figures, Polygons, paint};
use enfilade::pvs::Progress;
use enfilade::pvs::eye::{Cone, Lookout, Scratch};
use enfilade::pvs::sweep::sweep;
use enfilade::trace::camera::Camera;
use enfilade::trace::{Place, Ray, Space, Surface, walk};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::agree::tomls;

const SIZE: [u32; 2] = [96, 64];

/// A random place in a random cell that has room to stand in.
fn random_eye(
    graph: &CellGraph,
    space: &Space,
    locator: &Locator,
    random: &mut Pcg64,
) -> (Vertex, DVec3, CellId) {
    loop {
        let cell = CellId(random.random_range(0..graph.cells.len() as u32));
        let chamber = space.cell(cell.0);
        if chamber.floor >= chamber.ceiling {
            continue;
        }
        let corners: Vec<DVec2> = graph
            .corners(cell)
            .map(|v| graph.vertices.exact(v).to_level(&graph.grid))
            .collect();
        let weights: Vec<f64> = corners.iter().map(|_| random.random::<f64>()).collect();
        let sum: f64 = weights.iter().sum();
        let mix = corners.iter().zip(&weights).map(|(c, w)| *c * *w);
        let plan = mix.sum::<DVec2>() / sum;
        let Some(at) = graph.grid.nearest(plan) else {
            continue;
        };
        let at: GridPoint = at;
        // Not on a border, where two cells may stand at different heights.
        let [own] = locator.cells_at(graph, &at.into())[..] else {
            continue;
        };
        let chamber = space.cell(own.0);
        if chamber.floor >= chamber.ceiling {
            continue;
        }
        let share: f64 = random.random_range(0.02..0.98);
        let z = chamber.floor + (chamber.ceiling - chamber.floor) * share;
        let eye = graph.grid.to_level(at).extend(z);
        return (at.into(), eye, own);
    }
}

/// A canvas painted with the cells that are wanted.
fn painted(
    graph: &CellGraph,
    (space, polygons): (&Space, &Polygons),
    (camera, eye): (&Camera, &Vertex),
    wanted: impl Fn(CellId) -> bool,
) -> (Canvas, Figures) {
    let tree = graph.tree.as_ref().expect("it was split");
    let mut canvas = Canvas::new(camera.size);
    let coat = |_: Surface, _: DVec3, point: DVec3| Coat::Opaque(point);
    let figures = paint(
        (space, polygons, tree),
        (camera, eye),
        wanted,
        coat,
        &mut canvas,
    );
    (canvas, figures)
}

/// What a level's pictures showed.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    pixels: u64,
    differ: u64,
    all: u64,
    in_pvs: u64,
    in_view: u64,
}

/// Pictures from random eyes, three times each, against rays.
fn check(level: &Level, subdivision: Subdivision, eyes: u32, seed: u64) -> Seen {
    let options = Options {
        subdivision,
        ..Options::default()
    };
    let graph = subdivide(level, &options);
    let space = Space::new(level, &graph);
    let flat =
        |c: &enfilade::trace::space::Chamber| !(c.floor.is_finite() && c.ceiling.is_finite());
    if space.cells.iter().any(flat) {
        return Seen::default();
    }
    let polygons = Polygons::of(&space);
    let locator = Locator::new(&graph);
    let pvs = sweep(&graph, &Progress::default());
    let lookout = Lookout::new(&graph);
    let mut scratch = Scratch::default();
    let mut random = Pcg64::seed_from_u64(seed);
    let mut seen = Seen::default();
    for _ in 0..eyes {
        let (at, eye, own) = random_eye(&graph, &space, &locator, &mut random);
        let angle = random.random_range(0.0..std::f64::consts::TAU);
        let slope = random.random_range(-0.8..0.8);
        let camera = Camera::new(eye, DVec2::from_angle(angle).extend(slope), 90.0, SIZE);
        let scene = (&space, &polygons);
        let (canvas, all) = painted(&graph, scene, (&camera, &at), |_| true);
        let (same, in_pvs) = painted(&graph, scene, (&camera, &at), |c| pvs.sees(own, c));
        let vista = lookout
            .look(&at, &Cone::ALL, &mut scratch)
            .expect("it is inside");
        let mut in_view = vec![false; graph.cells.len()];
        for cell in vista.cells() {
            in_view[cell.0 as usize] = true;
        }
        let (narrow, viewed) = painted(&graph, scene, (&camera, &at), |c| in_view[c.0 as usize]);
        assert!(viewed.painted <= in_pvs.painted && in_pvs.painted <= all.painted);
        seen.all += all.painted;
        seen.in_pvs += in_pvs.painted;
        seen.in_view += viewed.painted;
        let place = Place {
            cell: own,
            on: None,
        };
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let i = (y * SIZE[0] + x) as usize;
                let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let ray: Ray = camera.ray(at);
                let met = walk(&space, &ray, place, f64::INFINITY, |_, _| f64::INFINITY);
                let met = met.expect("the level is closed");
                let hits = [&canvas, &same, &narrow].map(|c| c.surfaces[i] == Some(met.surface));
                seen.pixels += 1;
                seen.differ += u64::from(hits.contains(&false));
                if hits[0] {
                    // What was painted is the point, in perspective.
                    let off = canvas.colours[i].distance(ray.at(met.t));
                    let reach = met.t * ray.direction.length() + eye.length();
                    assert!(off <= 1e-9 * reach, "{off} of {reach}");
                }
            }
        }
    }
    seen
}

#[test]
fn sample_levels_are_painted_as_rays_see_them() {
    let mut pixels = 0;
    for path in tomls("levels") {
        let name = path.file_name().expect("it is a file").to_string_lossy();
        let bytes = std::fs::read(&path).expect("it is there");
        let source = Source::parse(bytes, &name).expect("it is sound");
        let level = source.level(None).expect("it is sound");
        for subdivision in [Subdivision::Bsp, Subdivision::Kd] {
            let seen = check(&level, subdivision, 12, 7);
            println!("{name} {}: {seen:?}", subdivision.as_str());
            assert!(seen.differ * 10_000 <= seen.pixels, "{name}: {seen:?}");
            pixels += seen.pixels;
        }
    }
    assert!(pixels > 500_000);
}

#[test]
fn maps_of_freedoom_are_painted_as_rays_see_them() {
    let maps: [(&str, &[&str]); 2] = [
        ("freedoom1.wad", &["E1M1", "E1M2", "E1M5", "E2M3", "E3M7"]),
        (
            "freedoom2.wad",
            &["MAP01", "MAP05", "MAP12", "MAP15", "MAP28"],
        ),
    ];
    for (file, names) in maps {
        let path = Path::new("/usr/share/games/doom").join(file);
        let Ok(bytes) = std::fs::read(&path) else {
            let missing = format!("{} is not there; install Freedoom", path.display());
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            continue;
        };
        let wad = Wad::parse(bytes).expect("Freedoom is a WAD");
        for name in names {
            let draft = doom::read_map(&wad, name, file).expect("the map is sound");
            let level = snap::snap(draft).expect("the map is sound");
            let seen = check(&level, Subdivision::Bsp, 8, 3);
            println!(
                "{name}: {} of {} pixels differ; polygons painted: {} of all, {} with the PVS, {} \
                 with the eye's view",
                seen.differ, seen.pixels, seen.all, seen.in_pvs, seen.in_view
            );
            assert!(seen.differ * 10_000 <= seen.pixels, "{name}: {seen:?}");
            assert!(seen.in_view < seen.in_pvs && seen.in_pvs < seen.all);
        }
    }
}
