//! The search by linear programming against the exact one.

use enfilade::cells::{CellGraph, CellId, Doors, Subdivision};
use enfilade::level::toml;
use enfilade::pvs::lp::{lp, lp_bounded};
use enfilade::pvs::search::search;
use enfilade::pvs::sweep::sweep;
use enfilade::pvs::{Progress, Pvs};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::compare::cells;
use crate::plan::{Ink, Stroke, level, rectangle};

/// Levels on which the exact search needs more steps are left out.
const MOST_STEPS: u64 = 3000;

fn by_lp(graph: &CellGraph) -> Pvs {
    let pvs = lp(graph, &Progress::default());
    pvs.validate(graph).expect("what every PVS must be");
    assert_eq!(pvs.undecided, 0);
    pvs
}

/// Ordered pairs that the first has and the second has not.
fn beyond(p: &Pvs, q: &Pvs) -> usize {
    let n = p.visible.n() as u32;
    let more = |a: u32| {
        p.seen_from(CellId(a))
            .filter(move |b| !q.sees(CellId(a), *b))
    };
    (0..n).map(|a| more(a).count()).sum()
}

/// A box with random walls in it; walls on a fine grid hardly ever graze.
fn random_walls(size: i64, n: usize, random: &mut Pcg64) -> Vec<Stroke> {
    let mut end = || std::array::from_fn(|_| random.random_range(0..=size));
    let mut strokes: Vec<Stroke> = (0..n).map(|_| Stroke(end(), end(), Ink::Solid)).collect();
    strokes.extend(rectangle([0, 0], [size, size], Ink::Solid));
    strokes
}

/// Ordered pairs that both see, and those that only the programme sees: it must miss none.
fn compared(graph: &CellGraph, exact: &Pvs) -> [usize; 2] {
    let found = by_lp(graph);
    assert_eq!(beyond(exact, &found), 0, "sight of some width is missed");
    [exact.pairs() as usize, beyond(&found, exact)]
}

#[test]
fn by_programme_no_sight_of_some_width_is_missed() {
    // Where a line only grazes, the margin is zero, and rounding may make it positive. On a coarse
    // grid much grazes; on a fine one, only portals that lie in line.
    let mut random = Pcg64::seed_from_u64(12);
    for (size, rounds) in [(8, 300), (10_000_000, 100)] {
        let [mut same, mut more] = [0, 0];
        for _ in 0..rounds {
            let n = random.random_range(3..9);
            let level = level(&random_walls(size, n, &mut random));
            for subdivision in Subdivision::ALL {
                let graph = cells(&level, subdivision, Doors::Open).expect("sound");
                let exact = search(&graph, None, &Progress::default()).expect("no limit");
                let [both, only] = compared(&graph, &exact);
                (same, more) = (same + both, more + only);
            }
        }
        println!("grid of {size}: {same} pairs, and {more} that graze");
        assert!(same > 20_000 && more > 0 && more < same / 50);
    }
}

#[test]
fn by_programme_the_sample_levels_lose_nothing() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    let mut n_compared = 0;
    for entry in std::fs::read_dir(folder).expect("the levels are there") {
        let path = entry.expect("the folder is readable").path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("a level is text");
        let level = toml::read(&text, "level").expect("the samples are sound");
        for (subdivision, doors) in [
            (Subdivision::Bsp, Doors::Closed),
            (Subdivision::Cdt, Doors::Closed),
            (Subdivision::Bsp, Doors::Open),
        ] {
            let graph = cells(&level, subdivision, doors).expect("sound");
            let exact = search(&graph, Some(MOST_STEPS), &Progress::default());
            let Some(exact) = exact else { continue };
            let [both, more] = compared(&graph, &exact);
            println!(
                "{} {subdivision:?} {doors:?}: {both} pairs, and {more} that graze",
                path.display()
            );
            // Rows of rooms of one width: their doorways lie in line.
            assert!(more <= both / 10);
            n_compared += 1;
        }
    }
    assert!(n_compared >= 4, "only {n_compared} compared");
}

#[test]
fn by_programme_in_a_museum_nothing_is_lost_though_little_is_finished() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/museum.toml");
    let text = std::fs::read_to_string(path).expect("a level is text");
    let level = toml::read(&text, "museum").expect("the samples are sound");
    let graph = cells(&level, Subdivision::Bsp, Doors::Closed).expect("sound");
    let exact = sweep(&graph, &Progress::default());
    let found = lp_bounded(&graph, 60, &Progress::default());
    found.validate(&graph).expect("what every PVS must be");
    assert_eq!(beyond(&exact, &found), 0);
    // Apart from what is undecided, it shows hardly anything too much.
    let more = beyond(&found, &exact) as u64;
    println!("{} undecided, {more} too many", found.undecided);
    assert!(found.undecided > 0 && more < found.undecided + exact.pairs() / 20);
}

#[test]
fn what_is_not_finished_is_kept() {
    let mut random = Pcg64::seed_from_u64(13);
    let mut strokes = random_walls(1000, 12, &mut random);
    // A second room, which the first has no way to.
    let far = |[x, y]: [i64; 2]| [x + 2000, y];
    let second = random_walls(1000, 6, &mut random);
    strokes.extend(second.iter().map(|s| Stroke(far(s.0), far(s.1), s.2)));
    let graph = cells(&level(&strokes), Subdivision::Bsp, Doors::Open).expect("sound");
    let all = by_lp(&graph);
    let room = |cell: CellId| {
        let corner = graph.corners(cell).next().expect("cells have corners");
        graph.vertices.approx(corner).x > 1500.0
    };
    let mut last = u64::MAX;
    for most in [0, 1, 10, 100, 1000, 1_000_000] {
        let pvs = lp_bounded(&graph, most, &Progress::default());
        pvs.validate(&graph).expect("what every PVS must be");
        assert_eq!(beyond(&all, &pvs), 0);
        assert!(pvs.undecided <= last, "more time leaves no more open");
        assert!(beyond(&pvs, &all) as u64 <= pvs.undecided);
        for a in graph.cell_ids() {
            assert!(pvs.seen_from(a).all(|b| room(a) == room(b)));
        }
        assert_eq!(most == 0, last == u64::MAX);
        last = pvs.undecided;
    }
    assert_eq!(last, 0);
    let stopped = Progress::default();
    stopped.stop();
    let pvs = lp(&graph, &stopped);
    // Every pair that is connected at all, but for cells and themselves, which need no search.
    let n = graph.cells.len();
    let mut group: Vec<usize> = (0..n).collect();
    for _ in 0..n {
        for portal in &graph.portals {
            let [a, b] = graph.joined(portal).map(|c| c.0 as usize);
            let least = group[a].min(group[b]);
            (group[a], group[b]) = (least, least);
        }
    }
    let connected = group
        .iter()
        .map(|a| group.iter().filter(|b| *b == a).count());
    let connected = connected.sum::<usize>() as u64;
    assert_eq!((pvs.pairs(), pvs.steps), (connected, 0));
    assert_eq!(pvs.undecided, connected - n as u64);
}
