//! What the exact PVS costs: nanoseconds per visible pair, sweep against search, one thread against
//! two, and the subdivision against the PVS.
//!
//! `cargo bench --bench pvs` needs the Debian package `freedoom`. Every figure is the median of
//! several runs on one thread unless it says otherwise; ratios are of medians of the same run, so
//! they mean something on a noisy machine too. The search of a large map takes half a minute: it is
//! run once there.

use std::path::Path;
use std::time::Instant;

use enfilade::cells::{Options, Subdivision, subdivide};
use enfilade::level::{Level, doom, snap, wad::Wad};
use enfilade::pvs::{Progress, Pvs, search, sweep};

const MAPS: [(&str, &str); 4] = [
    ("freedoom1.wad", "E1M1"),
    ("freedoom1.wad", "E1M5"),
    ("freedoom2.wad", "MAP12"),
    ("freedoom2.wad", "MAP28"),
];

fn main() {
    // cargo passes --bench; a filter names maps.
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    println!(
        "{:<6} {:<4} {:>6} {:>9} {:>9} | {:>9} {:>7} {:>7} | {:>9} {:>8} {:>7} | {:>6} {:>6}",
        "map",
        "cut",
        "cells",
        "pairs",
        "cut ms",
        "sweep ms",
        "ns/pair",
        "×2 thr",
        "search ms",
        "ns/pair",
        "×sweep",
        "cut/pvs",
        "agree"
    );
    for (file, map) in MAPS {
        if !wanted.is_empty() && !wanted.iter().any(|w| w == map) {
            continue;
        }
        let Some(level) = load(file, map) else {
            continue;
        };
        for subdivision in Subdivision::ALL {
            measure(map, &level, subdivision);
        }
    }
}

fn load(file: &str, map: &str) -> Option<Level> {
    let path = Path::new("/usr/share/games/doom").join(file);
    let Ok(bytes) = std::fs::read(&path) else {
        eprintln!(
            "left out {map}: {} is not there (apt-get install freedoom)",
            path.display()
        );
        return None;
    };
    let wad = Wad::parse(bytes).expect("the WAD is sound");
    Some(snap::snap(doom::read_map(&wad, map, file).expect("the map reads")).expect("it fits"))
}

fn measure(map: &str, level: &Level, subdivision: Subdivision) {
    let options = Options {
        subdivision,
        ..Options::default()
    };
    let (cut, graph) = median(5, || subdivide(level, &options));
    let (one, two) = (pool(1), pool(2));
    let sweep = || sweep::sweep(&graph, &Progress::default());
    let runs = if graph.cells.len() > 4000 { 3 } else { 9 };
    let (sweep_one, pvs): (f64, Pvs) = one.install(|| median(runs, sweep));
    // In turn, so that both see the same drift of the machine; each with a run that wakes its
    // threads first.
    let mut gains: Vec<f64> = (0..3)
        .map(|_| one.install(|| median(runs, sweep)).0 / two.install(|| median(runs, sweep)).0)
        .collect();
    gains.sort_by(f64::total_cmp);
    let gain = gains[1];
    let runs = if graph.cells.len() > 4000 { 1 } else { 3 };
    let (search_one, found) = one.install(|| {
        median(runs, || {
            search::search(&graph, None, &Progress::default()).unwrap()
        })
    });
    let pairs = pvs.pairs() as f64;
    println!(
        "{map:<6} {:<4} {:>6} {:>9} {:>9.1} | {:>9.1} {:>7.1} {:>7.2} | {:>9.1} {:>8.1} {:>7.1} | {:>6.2} {:>6}",
        subdivision.as_str(),
        graph.cells.len(),
        pvs.pairs(),
        cut * 1e3,
        sweep_one * 1e3,
        sweep_one * 1e9 / pairs,
        gain,
        search_one * 1e3,
        search_one * 1e9 / pairs,
        search_one / sweep_one,
        cut / sweep_one,
        if found.visible == pvs.visible {
            "yes"
        } else {
            "NO"
        },
    );
    assert_eq!(found.visible, pvs.visible, "sweep and search must agree");
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads start")
}

/// Median seconds of `runs` runs after one that is not counted (unless there is only one), and the
/// last result.
fn median<T>(runs: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut result = None;
    if runs > 1 {
        result = Some(run());
    }
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            result = Some(run());
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (times[runs / 2], result.expect("at least one run"))
}
