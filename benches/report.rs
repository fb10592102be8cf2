//! What a report costs, compared with the PVS that it is about.
//!
//! `cargo bench --bench report` needs the Debian package `freedoom`. All figures are medians of the
//! same run on all processors; a filter names maps.

use std::path::Path;
use std::time::Instant;

use enfilade::cells::{Options, subdivide};
use enfilade::level::{Level, doom, snap, wad::Wad};
use enfilade::pvs::closing::{self, Common};
use enfilade::pvs::{Progress, longest, sweep};

const MAPS: [(&str, &str); 3] = [
    ("freedoom1.wad", "E1M1"),
    ("freedoom1.wad", "E1M5"),
    ("freedoom2.wad", "MAP12"),
];

fn main() {
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    for (file, map) in MAPS {
        if !wanted.is_empty() && !wanted.iter().any(|w| w == map) {
            continue;
        }
        if let Some(level) = load(file, map) {
            measure(map, &level);
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

fn measure(map: &str, level: &Level) {
    let graph = subdivide(level, &Options::default());
    let runs = if graph.cells.len() > 2000 { 3 } else { 9 };
    let (sweep, pvs) = median(runs, || sweep::sweep(&graph, &Progress::default()));
    let openings = closing::openings(&graph);
    let (savings, _) = median(runs, || {
        Common::of(&graph, &pvs, &openings, &Progress::default()).savings(|_, _| [1.0; 2])
    });
    let (longest, _) = median(runs, || longest::longest(&graph));
    println!(
        "{map}: {} openings; PVS {:.1} ms, savings {:.1} ms (×{:.1}), longest lines {:.1} ms (×{:.1})",
        openings.len(),
        sweep * 1e3,
        savings * 1e3,
        savings / sweep,
        longest * 1e3,
        longest / sweep
    );
}

/// Median seconds of `runs` runs after one that is not counted, and the last result.
fn median<T>(runs: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut result = run();
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            result = run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (times[runs / 2], result)
}
