use std::path::Path;

use super::*;
use crate::cells::{Doors, Options, Subdivision, subdivide};
use crate::level::{doom, snap, toml, wad};
use crate::pvs::file::{decode, encode};
use crate::pvs::sample::SampleOptions;
use crate::pvs::{BitMatrix, Method, Progress, Pvs, flood, heights, sample, sweep};

const FEW: VerifyOptions = VerifyOptions {
    segments: 20_000,
    points: 5_000,
    seed: 3,
};

const TWO_ROOMS: &str = r#"
    [[room]]
    name = "A"
    rect = [0, 0, 4, 4]
    [[room]]
    name = "B"
    rect = [4, 0, 8, 4]
    [[door]]
    between = ["A", "B"]
    width = 0.5
"#;

fn read(text: &str) -> Level {
    toml::read(text, "rooms.toml").unwrap()
}

fn built(level: &Level, options: Options) -> PvsFile {
    let graph = subdivide(level, &options);
    let pvs = sweep::sweep(&graph, &Progress::default());
    decode(&encode(&LevelInfo::of(level), &graph, &pvs)).unwrap()
}

/// As [`built`], with heights.
fn built_in_space(level: &Level, options: Options) -> PvsFile {
    let graph = subdivide(level, &options);
    let pvs = heights::heights(&graph, &Default::default(), &Progress::default());
    decode(&encode(&LevelInfo::of(level), &graph, &pvs)).unwrap()
}

/// What `verify` says about cells made from one level that claim to be another's.
fn claim(cells_of: &str, claimed: &str) -> Result<Verified, Failure> {
    let (made, claimed) = (read(cells_of), read(claimed));
    let mut file = built(&made, Options::default());
    file.info = LevelInfo::of(&claimed);
    file.graph.grid = claimed.grid;
    verify(&file, &claimed, &FEW, &Progress::default())
}

#[test]
fn every_sample_level_is_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !name.ends_with(".toml") {
            continue;
        }
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("levels")
            .join(&name);
        let level = toml::read(&std::fs::read_to_string(path).unwrap(), &name).unwrap();
        for subdivision in Subdivision::ALL {
            for doors in [Doors::Open, Doors::Closed] {
                let options = Options {
                    subdivision,
                    doors,
                    ..Options::default()
                };
                for file in [built(&level, options), built_in_space(&level, options)] {
                    match verify(&file, &level, &FEW, &Progress::default()) {
                        Ok(done) => {
                            let free = done.free > 1000 || (done.heights && done.portals < 10);
                            assert!(free && done.inside > 500, "{name}: {done}");
                        }
                        Err(failure) => panic!("{name}: {}", failure.describe(&file, &level)),
                    }
                }
            }
        }
    }
}

/// Needs the Debian package `freedoom`; does nothing without it.
#[test]
fn doom_maps_are_right() {
    let Ok(bytes) = std::fs::read("/usr/share/games/doom/freedoom1.wad") else {
        return;
    };
    let wad = wad::Wad::parse(bytes).unwrap();
    for map in ["E1M1", "E2M3", "E4M6"] {
        let level = snap::snap(doom::read_map(&wad, map, "freedoom1.wad").unwrap()).unwrap();
        for subdivision in Subdivision::ALL {
            let options = Options {
                subdivision,
                ..Options::default()
            };
            for file in [built(&level, options), built_in_space(&level, options)] {
                if let Err(failure) = verify(&file, &level, &FEW, &Progress::default()) {
                    panic!("{map}: {}", failure.describe(&file, &level));
                }
            }
        }
    }
}

/// The file without one pair.
fn without(right: &PvsFile, a: CellId, b: CellId) -> PvsFile {
    let mut file = right.clone();
    file.pvs.visible = BitMatrix::new(right.graph.cells.len());
    for c in right.graph.cell_ids() {
        let kept = |&d: &CellId| (c, d) != (a, b) && (d, c) != (a, b);
        for d in right.pvs.seen_from(c).filter(kept) {
            file.pvs.visible.set(c.0 as usize, d.0 as usize);
        }
    }
    file
}

fn every_missing_pair_is_found(
    level: &Level,
    subdivisions: &[Subdivision],
    built: impl Fn(&Level, Options) -> PvsFile,
) {
    for &subdivision in subdivisions {
        let options = Options {
            subdivision,
            ..Options::default()
        };
        let right = built(level, options);
        for a in right.graph.cell_ids() {
            for b in right.pvs.seen_from(a).filter(|&b| a < b) {
                let file = without(&right, a, b);
                let found = verify(&file, level, &FEW, &Progress::default());
                let missed = match found {
                    Err(Failure::Missed { a, b, .. }) if !right.pvs.heights => Some((a, b)),
                    Err(Failure::MissedInSpace { a, b, .. }) if right.pvs.heights => Some((a, b)),
                    _ => None,
                };
                assert!(
                    missed == Some((a, b)) || missed == Some((b, a)),
                    "{subdivision:?} {a:?} {b:?}: {found:?}"
                );
            }
        }
    }
}

#[test]
fn a_missing_pair_is_found() {
    every_missing_pair_is_found(&read(TWO_ROOMS), &Subdivision::ALL, built);
}

/// Three rooms; through the windows between them one sees only steeply, from the first up to the last.
const STEEP: &str = r#"
    [defaults]
    ceiling = 9
    [[room]]
    name = "A"
    rect = [0, 0, 4, 4]
    [[room]]
    name = "B"
    rect = [4, 0, 5, 4]
    [[room]]
    name = "C"
    rect = [5, 0, 9, 4]
    floor = 4
    [[window]]
    between = ["A", "B"]
    width = 1
    bottom = 0.5
    top = 0.75
    [[window]]
    between = ["B", "C"]
    width = 2
    bottom = 4.25
    top = 4.5
"#;

#[test]
fn a_missing_pair_in_space_is_found() {
    every_missing_pair_is_found(&read(STEEP), &[Subdivision::Bsp], built_in_space);
    let level = read(STEEP);
    let mut file = built_in_space(&level, Options::default());
    // The planar caster would find much of what heights hide; it must not be asked.
    let done = verify(&file, &level, &FEW, &Progress::default()).unwrap();
    assert!(done.heights && done.free > 1000, "{done}");
    // Openings other than the level's are found out, wherever they come from.
    for portal in &mut file.graph.portals {
        portal.widest = portal.widest.map(|(_, top)| (top, top));
    }
    let pvs = heights::heights(&file.graph, &Default::default(), &Progress::default());
    assert!(pvs.pairs() < file.pvs.pairs());
    file.pvs = pvs;
    let found = verify(&file, &level, &FEW, &Progress::default()).unwrap_err();
    let words = found.describe(&file, &level);
    assert!(
        matches!(found, Failure::MissedInSpace { .. }) && words.contains("the straight line"),
        "{words}"
    );
}

/// The file with another PVS.
fn with(file: &PvsFile, pvs: Pvs) -> PvsFile {
    PvsFile {
        pvs,
        ..file.clone()
    }
}

#[test]
fn a_file_is_held_to_what_its_class_promises() {
    let museum = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/museum.toml");
    let level = read(&std::fs::read_to_string(museum).unwrap());
    let exact = built(&level, Options::default());
    let few = SampleOptions { rays: 2, seed: 1 };
    let few = sample::sample(&exact.graph, &few, &Progress::default());
    assert!(few.pairs() < exact.pvs.pairs());
    for class in Class::ALL {
        let claimed = Pvs {
            class,
            ..few.clone()
        };
        let file = with(&exact, claimed);
        let found = verify(&file, &level, &FEW, &Progress::default());
        match found {
            Ok(done) => {
                assert!(!class.is_complete() && done.missed > 0 && done.missed < done.met);
                let said = format!(
                    "{} not listed, as its class, {}",
                    done.missed,
                    class.as_str()
                );
                assert!(done.to_string().contains(&said), "{done}");
            }
            Err(failure) => {
                assert!(class.is_complete() && matches!(failure, Failure::Missed { .. }));
                let said = failure.describe(&file, &level);
                assert!(said.contains(class.as_str()), "{said}");
            }
        }
    }
    let flooded = with(&exact, flood::flood(&exact.graph, &Progress::default()));
    let done = verify(&flooded, &level, &FEW, &Progress::default()).unwrap();
    assert_eq!((done.missed, done.class), (0, Class::Conservative));
    assert!(done.to_string().contains("every one listed"), "{done}");
}

#[test]
fn a_pair_that_no_portals_join_is_found() {
    let level = read(
        &TWO_ROOMS
            .replace("[[door]]", "[[window]]")
            .replace("width", "state = \"closed\"\nwidth"),
    );
    let options = Options {
        doors: Doors::Closed,
        ..Options::default()
    };
    let file = built(&level, options);
    assert!(file.graph.portals.is_empty());
    for class in Class::ALL {
        let mut visible = BitMatrix::new(2);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            visible.set(i, j);
        }
        let all = Pvs {
            visible,
            class,
            method: Method::Flood,
            ..file.pvs.clone()
        };
        let file = with(&file, all);
        let found = verify(&file, &level, &FEW, &Progress::default());
        let parted = Failure::Parted(CellId(0), CellId(1));
        assert_eq!(found.err(), class.is_sound().then_some(parted));
        assert!(parted.describe(&file, &level).contains("portals"));
    }
}

#[test]
fn a_lopsided_relation_is_found() {
    let level = read(TWO_ROOMS);
    let mut file = built(&level, Options::default());
    let whole = file.pvs.visible.clone();
    file.pvs.visible = BitMatrix::new(whole.n());
    assert_eq!(
        verify(&file, &level, &FEW, &Progress::default()),
        Err(Failure::NotReflexive(CellId(0)))
    );
    (0..whole.n()).for_each(|i| file.pvs.visible.set(i, i));
    file.pvs.visible.set(0, 1);
    assert_eq!(
        verify(&file, &level, &FEW, &Progress::default()),
        Err(Failure::NotSymmetric(CellId(0), CellId(1)))
    );
}

#[test]
fn another_level_is_told_apart() {
    let file = built(&read(TWO_ROOMS), Options::default());
    let other = read(&TWO_ROOMS.replace("0.5", "0.6"));
    let failure = verify(&file, &other, &FEW, &Progress::default()).unwrap_err();
    assert_eq!(failure, Failure::OtherLevel);
    assert!(
        failure
            .describe(&file, &other)
            .contains("not of this level")
    );
}

#[test]
fn cells_of_another_level_are_found_out() {
    let corners = "[[room]]\nname = \"C\"\nrect = [0, 4, 8, 8]\n";
    // Outer extents equal, so that the grids are.
    let with_room = format!("{TWO_ROOMS}{corners}");
    let with_void = format!("{with_room}[[pillar]]\nrect = [1, 5, 2, 6]\n");
    assert!(claim(&with_room, &with_room).is_ok());
    // A pillar stands in the cells.
    let found = claim(&with_room, &with_void);
    assert!(
        matches!(found, Err(Failure::WallInside(..) | Failure::Outside(..))),
        "{found:?}"
    );
    // Ground is left out where no pillar is.
    let found = claim(&with_void, &with_room);
    assert!(matches!(found, Err(Failure::NoWall(_))), "{found:?}");
    // Open where the wall has no door.
    let shut = with_room.replace("width = 0.5", "width = 0.25");
    let found = claim(&with_room, &shut);
    assert!(matches!(found, Err(Failure::WallOnPortal(..))), "{found:?}");
    // A wall where the door is wider.
    let found = claim(&shut, &with_room);
    assert!(
        matches!(
            found,
            Err(Failure::WallInside(..)
                | Failure::Escape { .. }
                | Failure::NoWall(_)
                | Failure::Missed { .. })
        ),
        "{found:?}"
    );
    // A room that the level does not have.
    let found = claim(
        &with_room,
        &format!("{TWO_ROOMS}[[pillar]]\nrect = [0, 7, 8, 8]\n"),
    );
    assert!(found.is_err(), "{found:?}");
}

#[test]
fn the_same_seed_says_the_same() {
    let level = read(TWO_ROOMS);
    let file = built(&level, Options::default());
    let once = verify(&file, &level, &FEW, &Progress::default()).unwrap();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .unwrap();
    assert_eq!(
        pool.install(|| verify(&file, &level, &FEW, &Progress::default())),
        Ok(once)
    );
    let other = verify(
        &file,
        &level,
        &VerifyOptions { seed: 4, ..FEW },
        &Progress::default(),
    )
    .unwrap();
    assert_ne!(other.met, once.met);
}

mod geometry {
    use super::super::walls::touch;
    use crate::geom::GridPoint;

    #[test]
    fn touching_in_a_point_counts() {
        let p = GridPoint::new;
        assert!(touch(p(0, 0), p(4, 4), p(4, 0), p(0, 4)));
        assert!(touch(p(0, 0), p(4, 4), p(4, 4), p(9, 4)), "end to end");
        assert!(
            touch(p(0, 0), p(4, 4), p(2, 2), p(9, 2)),
            "end in the middle"
        );
        assert!(
            touch(p(0, 0), p(4, 4), p(2, 2), p(9, 9)),
            "along each other"
        );
        assert!(
            !touch(p(0, 0), p(4, 4), p(5, 5), p(9, 9)),
            "on one line, apart"
        );
        assert!(!touch(p(0, 0), p(4, 4), p(1, 0), p(9, 7)));
        assert!(
            touch(p(1, 1), p(1, 1), p(0, 0), p(2, 2)),
            "a point on a segment"
        );
        assert!(!touch(p(1, 2), p(1, 2), p(0, 0), p(2, 2)));
    }
}

/// Pairs spread over all of a level, asked one by one.
#[test]
fn single_pairs_agree_with_the_sweep() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    let mut levels = vec![root.join("tiny.toml"), root.join("museum.toml")];
    for entry in std::fs::read_dir(root.join("hard")).unwrap() {
        levels.push(entry.unwrap().path());
    }
    let mut seen = [0, 0];
    for path in levels {
        let Ok(level) = toml::read(&std::fs::read_to_string(&path).unwrap(), "level.toml") else {
            continue;
        };
        for subdivision in Subdivision::ALL {
            let options = Options {
                subdivision,
                ..Options::default()
            };
            let graph = subdivide(&level, &options);
            let pvs = sweep::sweep(&graph, &Progress::default());
            let caster = Caster::new(&level, &graph);
            let n = graph.cells.len() as u32;
            let pairs = (0..n * n).step_by((n * n / 40).max(1) as usize | 1);
            for [a, b] in pairs.map(|i| [CellId(i / n), CellId(i % n)]) {
                if a < b {
                    let wanted = pvs.sees(a, b);
                    let joined = caster.joined([a, b]);
                    seen[usize::from(wanted)] += u32::from(joined.is_some());
                    // Too many points are no answer.
                    let agrees = joined.is_none_or(|joined| joined == wanted);
                    assert!(agrees, "{path:?}, {subdivision:?}: {a:?} {b:?}");
                }
            }
        }
    }
    assert!(seen[0] > 200 && seen[1] > 200, "{seen:?}");
}
