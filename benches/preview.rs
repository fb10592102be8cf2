//! How fast a level is painted: with and without culling, in both orders, flat and textured, on one
//! thread and on two.
//!
//! `cargo bench --bench preview` needs the Debian package `freedoom`; `-- --quick` takes 4 eyes instead of
//! 16, and names of maps replace E1M5. Eyes are spread evenly over the ground, 41 above it, and look
//! level in a random direction, 960 × 600 pixels, 90°, all seeded. Of each eye's picture the median of
//! [`RUNS`] counts, of all eyes the median; the ways take turns, so that what else the machine does
//! falls on all of them alike. `polygons / ms` counts those that the eye is before. The culling
//! factor is all polygons of the map to those painted.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use enfilade::cells::{CellGraph, CellId, Locator, Options as Split, subdivide};
use enfilade::level::doom::graphics;
use enfilade::level::{doom, snap, wad::Wad};
use enfilade::preview::{Culling, Easel, Figures, Finish, Options, Order, Painter};
use enfilade::pvs::{Progress, Pvs, sweep};
use enfilade::trace::camera::Camera;
use enfilade::trace::sampling::Source;
use enfilade::trace::space::Space;
use enfilade::trace::world::{Files, World};
use glam::DVec2;
use rayon::ThreadPool;

const WAD: &str = "/usr/share/games/doom/freedoom1.wad";
const SIZE: [u32; 2] = [960, 600];
/// Pictures of each eye, of which the median counts.
const RUNS: usize = 7;

fn main() {
    // cargo passes --bench; other words are maps.
    let (flags, mut maps): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with('-'));
    let eyes = if flags.iter().any(|f| f == "--quick") {
        4
    } else {
        16
    };
    if maps.is_empty() {
        maps.push("E1M5".to_string());
    }
    let Ok(bytes) = std::fs::read(Path::new(WAD)) else {
        eprintln!("left out: {WAD} is not there (apt-get install freedoom)");
        return;
    };
    let wad = Wad::parse(bytes).expect("the WAD is sound");
    for map in &maps {
        measure(&wad, map, eyes);
    }
}

fn measure(wad: &Wad, map: &str, n_eyes: usize) {
    let draft = doom::read_map(wad, map, WAD).expect("the map reads");
    let level = snap::snap(draft).expect("it fits");
    let graph = subdivide(&level, &Split::default());
    let pvs: Pvs = sweep::sweep(&graph, &Progress::default());
    let files = Files {
        dress: graphics::pictures(wad, &level.scene.dress),
        ..Files::default()
    };
    let world = World::new(&level, &graph, &pvs, &files, 0.12).expect("it has heights");
    let cameras = eyes(&graph, &world.space, n_eyes);
    let pools = [1, 2].map(|n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        pool.expect("threads start")
    });
    println!(
        "{map}: {} cells, {n_eyes} eyes, {} × {} pixels",
        graph.cells.len(),
        SIZE[0],
        SIZE[1]
    );
    println!(
        "{:<9} {:<5} {:<14} {:>7} {:>6} {:>6} {:>9} {:>9} {:>9} {:>9} {:>7}",
        "",
        "",
        "",
        "cells",
        "polyg.",
        "shown",
        "overdraw",
        "ms, 1 th.",
        "ms, 2 th.",
        "frames/s",
        "pol./ms"
    );
    for finish in [Finish::Flat, Finish::Textured] {
        let painter = Painter::new(&world, &graph, &pvs, finish).expect("it was split by lines");
        table(&painter, &cameras, &pools, finish);
    }
}

/// One way to draw.
#[derive(Default)]
struct Row {
    figures: Vec<Figures>,
    /// Milliseconds by eye, on one thread and on two.
    times: [Vec<f64>; 2],
}

fn table(painter: &Painter, cameras: &[Camera], pools: &[ThreadPool; 2], finish: Finish) {
    let ways: Vec<(Culling, Order)> = Culling::ALL
        .into_iter()
        .flat_map(|c| [(c, Order::BackToFront), (c, Order::FrontToBack)])
        .collect();
    let mut rows: Vec<Row> = ways.iter().map(|_| Row::default()).collect();
    let mut easel = Easel::default();
    for camera in cameras {
        let mut runs = vec![[const { Vec::new() }; 2]; ways.len()];
        for run in 0..RUNS {
            for (k, &(culling, order)) in ways.iter().enumerate() {
                let options = Options {
                    culling,
                    order,
                    ..Options::default()
                };
                let mut figures = Figures::default();
                for (pool, times) in pools.iter().zip(&mut runs[k]) {
                    let start = Instant::now();
                    let drawn = pool.install(|| painter.draw(camera, &options, &mut easel));
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                    figures = black_box(drawn.expect("the eye is inside"));
                }
                if run == 0 {
                    rows[k].figures.push(figures);
                }
            }
        }
        for (row, runs) in rows.iter_mut().zip(runs) {
            for (all, times) in row.times.iter_mut().zip(runs) {
                all.push(median(times));
            }
        }
    }
    let name = match finish {
        Finish::Flat => "flat",
        Finish::Textured => "textured",
    };
    for (&(culling, order), row) in ways.iter().zip(&rows) {
        let of =
            |what: fn(&Figures) -> f64| -> f64 { median(row.figures.iter().map(what).collect()) };
        let [one, two] = [0, 1].map(|n| median(row.times[n].clone()));
        let rates = (row.figures.iter().zip(&row.times[0])).map(|(f, ms)| f.painted as f64 / ms);
        println!(
            "{name:<9} {:<5} {:<14} {:>7.0} {:>6.0} {:>6.0} {:>9.2} {one:>9.2} {two:>9.2} {:>9.0} {:>7.0}",
            culling.as_str(),
            match order {
                Order::BackToFront => "back to front",
                Order::FrontToBack => "front to back",
            },
            of(|f| f.cells as f64),
            of(|f| f.painted as f64),
            of(|f| f.shown as f64),
            of(Figures::overdraw),
            1e3 / one,
            median(rates.collect()),
        );
    }
    let time = |k: usize| median(rows[k].times[0].clone());
    println!(
        "{name}: the painter's order with the PVS takes {:.2} of the time without culling, with the eye's \
         view {:.2}; front to back {:.2} of the painter's",
        time(2) / time(0),
        time(4) / time(0),
        time(5) / time(4)
    );
    let factor = |k: usize| median(rows[k].figures.iter().map(Figures::factor).collect());
    println!(
        "{name}: culling factor, median: {:.1} by back faces alone, {:.1} with the PVS, {:.1} with the \
         eye's view",
        factor(0),
        factor(2),
        factor(4)
    );
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    // The mean of the two in the middle, of an even number.
    let n = list.len();
    (list[(n - 1) / 2] + list[n / 2]) / 2.0
}

fn eyes(graph: &CellGraph, space: &Space, n: usize) -> Vec<Camera> {
    let mut random = Source::new(3, 0, 0);
    let mut sum = 0.0;
    let stands = |c: CellId| space.cell(c.0).ceiling - space.cell(c.0).floor >= 56.0;
    let sums: Vec<f64> = (graph.cell_ids())
        .map(|c| {
            sum += if stands(c) { graph.area(c) } else { 0.0 };
            sum
        })
        .collect();
    let locator = Locator::new(graph);
    let mut list = Vec::new();
    while list.len() < n {
        let at = random.next() * sum;
        let cell = CellId(sums.partition_point(|&s| s <= at) as u32);
        let chamber = space.cell(cell.0);
        let corners = (chamber.first..chamber.past).map(|e| space.vertex(space.edge(e).from));
        let weights: Vec<f64> = corners.clone().map(|_| random.next()).collect();
        let total: f64 = weights.iter().sum();
        let plan: DVec2 = corners.zip(&weights).map(|(p, w)| p * (w / total)).sum();
        let Some(near) = graph.grid.nearest(plan) else {
            continue;
        };
        if locator.cells_at(graph, &near.into()) != [cell] {
            continue;
        }
        let eye = graph.grid.to_level(near).extend(chamber.floor + 41.0);
        let direction = DVec2::from_angle(random.next() * std::f64::consts::TAU);
        list.push(Camera::new(eye, direction.extend(0.0), 90.0, SIZE));
    }
    list
}
