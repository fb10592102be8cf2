//! Levels written in the own format and read back: the same places, the same sight; and levels
//! edited at random stay levels.

use std::path::{Path, PathBuf};

use enfilade::cells::locate::Locator;
use enfilade::cells::{CellGraph, Doors, Options, Subdivision, subdivide};
use enfilade::geom::GridPoint;
use enfilade::level::edit::{self, EditError};
use enfilade::level::{Level, OpeningStyle, WallId, toml};
use enfilade::pvs::{Progress, Pvs, sweep};

use crate::cli::{enfilade, level as level_path};
use crate::methods::freedoom;

/// All levels of a folder that can be read.
fn levels(folder: &str) -> Vec<(PathBuf, Level)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    paths.sort();
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        let level = toml::read(&text, &path.file_name().unwrap().to_string_lossy());
        Some((path, level.ok()?))
    };
    paths.into_iter().filter_map(read).collect()
}

fn cells(level: &Level) -> CellGraph {
    let options = Options {
        subdivision: Subdivision::Bsp,
        doors: Doors::Open,
        ..Options::default()
    };
    subdivide(level, &options)
}

fn solve(graph: &CellGraph) -> Pvs {
    sweep::sweep(graph, &Progress::default())
}

/// Fractions that repeat from run to run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = (self.0)
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        ((self.roll() * n as f64) as usize).min(n - 1)
    }
}

/// Compares what two levels answer about `n` pairs of places; how many of them see each other.
fn same_sight(name: &str, first: &Level, second: &Level, n: usize) -> usize {
    let graphs = [first, second].map(cells);
    assert_eq!(graphs[0].cells.len(), graphs[1].cells.len(), "{name}");
    assert_eq!(graphs[0].portals.len(), graphs[1].portals.len(), "{name}");
    let codes = |g: &CellGraph| -> Vec<&str> { g.findings.iter().map(|f| f.code).collect() };
    assert_eq!(codes(&graphs[0]), codes(&graphs[1]), "{name}");
    let sight = graphs.each_ref().map(solve);
    let totals = sight.each_ref().map(|p| p.pairs());
    assert_eq!(totals[0], totals[1], "{name}");
    let locators = graphs.each_ref().map(Locator::new);
    let low = (first.walls.iter()).fold([i64::MAX; 2], |m, w| {
        [
            m[0].min(w.from.x).min(w.to.x),
            m[1].min(w.from.y).min(w.to.y),
        ]
    });
    let high = (first.walls.iter()).fold([i64::MIN; 2], |m, w| {
        [
            m[0].max(w.from.x).max(w.to.x),
            m[1].max(w.from.y).max(w.to.y),
        ]
    });
    let mut dice = Dice(n as u64);
    let mut place = || {
        let [x, y] = [0, 1].map(|i| {
            let size = (high[i] - low[i]) as f64;
            low[i] + (dice.roll() * size) as i64
        });
        let at = GridPoint::new(x, y);
        let there = second.grid.nearest(first.grid.to_level(at)).unwrap();
        let cells = [
            locators[0].cell_at(&graphs[0], at),
            locators[1].cell_at(&graphs[1], there),
        ];
        let sector = |i: usize| cells[i].map(|c| graphs[i].cell(c).sector);
        assert_eq!(sector(0), sector(1), "{name}: {at:?}");
        Some([cells[0]?, cells[1]?])
    };
    let inside: Vec<_> = (0..4 * n).filter_map(|_| place()).take(2 * n).collect();
    let mut seen = 0;
    for pair in inside.chunks_exact(2) {
        let sees = [0, 1].map(|i| sight[i].sees(pair[0][i], pair[1][i]));
        assert_eq!(sees[0], sees[1], "{name}: {pair:?}");
        seen += usize::from(sees[0]);
    }
    seen
}

fn written(name: &str, level: &Level) -> Level {
    let written = toml::write::write(level).unwrap_or_else(|e| panic!("{name}: {e}"));
    toml::read(&written.text, &level.source).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Whether a finding of the second is none of the first.
fn new_findings(first: &Level, second: &Level) -> Vec<&'static str> {
    (second.findings.iter())
        .map(|f| f.code)
        .filter(|code| !first.findings.iter().any(|f| f.code == *code))
        .collect()
}

#[test]
fn sample_levels_come_back() {
    let mut seen = 0;
    let samples: Vec<_> = [levels("levels"), levels("levels/hard")].concat();
    assert!(samples.len() > 60, "{}", samples.len());
    for (path, level) in &samples {
        let name = path.display().to_string();
        let back = written(&name, level);
        assert_eq!(new_findings(level, &back), [""; 0], "{name}");
        assert_eq!(level.walls.len(), back.walls.len(), "{name}");
        assert_eq!(level.n_vertices, back.n_vertices, "{name}");
        assert_eq!(level.scene.objects, back.scene.objects, "{name}");
        assert_eq!(level.scene.materials, back.scene.materials, "{name}");
        assert_eq!(level.scene.paths, back.scene.paths, "{name}");
        assert_eq!(level.scene.budget, back.scene.budget, "{name}");
        let names = |l: &Level| -> Vec<_> {
            let sectors = l.sectors.iter().filter(|_| !l.outlines.is_empty()).skip(1);
            sectors
                .map(|s| {
                    (
                        s.name.clone(),
                        s.floor_material.clone(),
                        s.ceiling_material.clone(),
                    )
                })
                .collect()
        };
        assert_eq!(names(level), names(&back), "{name}");
        // Directions are made unit vectors again.
        assert_eq!(level.scene.lights.len(), back.scene.lights.len(), "{name}");
        for (a, b) in level.scene.cameras.iter().zip(&back.scene.cameras) {
            assert_eq!((&a.name, a.eye, a.fov), (&b.name, b.eye, b.fov), "{name}");
            assert!(a.direction.distance(b.direction) < 1e-12, "{name}");
        }
        // The largest ones are compared elsewhere: by their walls, in the writer itself.
        if level.walls.len() < 5000 {
            seen += same_sight(&name, level, &back, 200);
        }
        // What is written once is written the same again, but for the last digits of unit vectors.
        let plan = |level: &Level| -> Vec<String> {
            let text = toml::write::write(level).unwrap().text;
            let lines = text.lines().filter(|l| !l.starts_with("direction"));
            lines.map(str::to_string).collect()
        };
        assert_eq!(plan(&back), plan(&written(&name, &back)), "{name}");
    }
    println!(
        "{} levels, {seen} pairs of places that see each other",
        samples.len()
    );
    assert!(seen > 1000);
}

#[test]
fn doom_maps_come_back() {
    let mut maps = 0;
    for (wad, names) in [
        (
            "freedoom1.wad",
            ["E1M1", "E1M5", "E2M3", "E3M7", "E4M6", "E4M9"],
        ),
        (
            "freedoom2.wad",
            ["MAP01", "MAP05", "MAP12", "MAP15", "MAP28", "MAP32"],
        ),
    ] {
        for (name, level) in &freedoom(wad, &names) {
            let back = written(name, level);
            assert_eq!(back.grid, level.grid, "{name}");
            assert_eq!(back.scene.lights, level.scene.lights, "{name}");
            assert_eq!(back.sectors.len(), level.sectors.len());
            for (a, b) in back.sectors.iter().zip(&level.sectors) {
                let key = |s: &enfilade::level::Sector| {
                    (s.floor, s.ceiling, s.light, s.floor_material.clone())
                };
                assert_eq!(key(a), key(b), "{name}");
            }
            assert_eq!(new_findings(level, &back), [""; 0], "{name}");
            let seen = same_sight(name, level, &back, 2000);
            println!(
                "{name}: {} walls, {seen} pairs see each other",
                level.walls.len()
            );
            maps += 1;
        }
    }
    println!("{maps} maps");
}

#[test]
fn the_command_writes_a_file_that_check_accepts() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["tiny", "museum", "house", "maze"] {
        let from = level_path(&format!("{name}.toml"));
        let to = folder.path().join(format!("{name}.toml"));
        let to = to.to_str().unwrap();
        let done = enfilade(&["export", "toml", &from, "-o", to]);
        assert!(done.status.success(), "{done:?}");
        let [before, after] = [&*from, to].map(|l| enfilade(&["check", l]));
        assert_eq!(before.status, after.status, "{name}");
        let lines = |out: &[u8]| String::from_utf8_lossy(out).lines().count();
        assert!(
            lines(&after.stdout) <= lines(&before.stdout),
            "{name}: {after:?}"
        );
    }
    let done = enfilade(&["export", "toml", &level_path("tiny.toml"), "-o", "-"]);
    assert!(
        String::from_utf8_lossy(&done.stdout).contains("[[room]]"),
        "{done:?}"
    );
}

/// One change of a level, picked at random.
fn change(level: &Level, dice: &mut Dice) -> Result<Level, EditError> {
    let id = WallId(dice.below(level.walls.len()) as u32);
    let wall = &level.walls[id.0 as usize];
    let [a, b] = [wall.from, wall.to].map(|p| level.grid.to_level(p));
    let reach = a.distance(b);
    let mut by = || glam::DVec2::new(dice.roll() - 0.5, dice.roll() - 0.5) * reach;
    let (far, near) = (by(), by() * 0.1);
    match dice.below(7) {
        0 => edit::move_point(level, wall.from, a + far),
        1 => edit::move_point(level, wall.to, b + near),
        2 => edit::move_wall(level, id, near),
        3 => {
            let opening = edit::near::opening(level, a, f64::MAX).unwrap_or(id);
            edit::toggle(level, opening)
        }
        4 => {
            let style = [
                OpeningStyle::Door,
                OpeningStyle::Window,
                OpeningStyle::Archway,
            ];
            let width = reach * dice.roll();
            let opening = edit::plain(style[dice.below(3)]);
            edit::add_opening(level, id, a.lerp(b, dice.roll()), width, opening)
        }
        5 => {
            let opening = edit::near::opening(level, a, f64::MAX).unwrap_or(id);
            edit::remove_opening(level, opening)
        }
        _ => edit::delete_wall(level, id),
    }
}

#[test]
fn random_changes_give_levels_that_can_be_written() {
    let (mut done, mut refused) = (0, 0);
    let mut samples: Vec<_> = [levels("levels"), levels("levels/hard")].concat();
    samples.retain(|(_, level)| level.walls.len() < 600);
    let samples = samples
        .into_iter()
        .map(|(path, level)| (path.display().to_string(), level));
    let maps = freedoom("freedoom1.wad", &["E1M1"]);
    for (name, first) in samples.chain(maps) {
        let mut dice = Dice(first.walls.len() as u64);
        for _ in 0..4 {
            let mut level = first.clone();
            let mut before = Vec::new();
            for _ in 0..12 {
                match change(&level, &mut dice) {
                    Ok(new) => {
                        before.push(std::mem::replace(&mut level, new));
                        done += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
            cells(&level)
                .validate()
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            let back = written(&name, &level);
            assert_eq!(back.walls.len(), level.walls.len(), "{name}");
        }
    }
    println!("{done} changes, {refused} refused");
    assert!(done > 1000 && refused > 100, "{done}, {refused}");
}
