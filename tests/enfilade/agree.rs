//! Both exact methods, all three subdivisions and a caster of sightlines agree on whole levels.

use std::fs;
use std::path::{Path, PathBuf};

use enfilade::cells::{Doors, Subdivision};
use enfilade::level::{Interior, Level, doom, snap, toml, wad::Wad};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::compare::{nothing_new, same_area, sample, solve, solve_all};

pub fn tomls(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(&folder).expect("the levels are there");
    let mut list: Vec<PathBuf> = entries
        .map(|entry| entry.expect("the folder is readable").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    list.sort();
    list
}

fn read(path: &Path) -> Result<Level, toml::TomlError> {
    let text = fs::read_to_string(path).expect("a level is text");
    toml::read(
        &text,
        &path.file_name().expect("it has one").to_string_lossy(),
    )
}

fn holds<T>(level: &str, result: Result<T, String>) -> T {
    result.unwrap_or_else(|error| panic!("{level}: {error}"))
}

#[test]
fn sample_levels_agree_with_open_and_closed_doors() {
    let paths = tomls("levels");
    assert!(paths.len() >= 7, "only {} sample levels", paths.len());
    for path in paths {
        let level = read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let name = path.display().to_string();
        let [open, closed] = [Doors::Open, Doors::Closed].map(|doors| {
            let solved = holds(&name, solve_all(&level, doors));
            let random = &mut Pcg64::seed_from_u64(7);
            let tried = holds(&name, sample(&level, doors, &solved, 3000, random));
            assert!(tried > 1000, "{}: only {tried} segments", path.display());
            solved
        });
        // Closed doors only hide; on the smaller levels, pair by pair.
        for (p, q) in open
            .iter()
            .zip(&closed)
            .filter(|(_, q)| q.graph.cells.len() < 400)
        {
            holds(&name, nothing_new(p, q));
        }
        let cells: Vec<usize> = open.iter().map(|s| s.graph.cells.len()).collect();
        println!("{}: {cells:?} cells, all agree", level.name);
    }
}

#[test]
fn hard_levels_agree() {
    let mut sampled = 0;
    for path in tomls("levels/hard") {
        let Ok(level) = read(&path) else { continue };
        let name = path.display().to_string();
        let solved = holds(&name, solve_all(&level, Doors::Open));
        let random = &mut Pcg64::seed_from_u64(7);
        sampled += holds(&name, sample(&level, Doors::Open, &solved, 300, random));
    }
    assert!(sampled > 3000, "only {sampled} segments");
}

/// Search is left out of a map and subdivision where it needs more steps than this.
const MOST_STEPS: u64 = 100_000_000;

#[test]
fn every_map_of_freedoom_agrees() {
    for (file, n_maps) in [("freedoom1.wad", 36), ("freedoom2.wad", 32)] {
        let path = Path::new("/usr/share/games/doom").join(file);
        let Ok(bytes) = fs::read(&path) else {
            let missing = format!("{} is not there; install Freedoom", path.display());
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            continue;
        };
        let wad = Wad::parse(bytes).expect("Freedoom is a WAD");
        let maps = wad.maps();
        assert_eq!(maps.len(), n_maps, "{file}");
        let mut unsearched = Vec::new();
        for map in &maps {
            let name = &map.name;
            let draft = doom::read_map(&wad, &map.name, file).expect("the map is sound");
            let level = snap::snap(draft).expect("the map is sound");
            assert_eq!(level.interior, Interior::Sides);
            let mut all = Vec::new();
            for subdivision in Subdivision::ALL {
                let result = solve(&level, subdivision, Doors::Open, Some(MOST_STEPS));
                let (solved, searched) = holds(name, result);
                if !searched {
                    unsearched.push(format!("{} {}", map.name, subdivision.as_str()));
                }
                all.push(solved);
            }
            let graphs: Vec<_> = all.iter().map(|s| &s.graph).collect();
            holds(name, same_area(&graphs));
            let random = &mut Pcg64::seed_from_u64(11);
            let tried = holds(name, sample(&level, Doors::Open, &all, 150, random));
            assert!(tried > 50, "{}: only {tried} segments", map.name);
        }
        println!("{file}: {n_maps} maps agree; search needs more than {MOST_STEPS} steps on");
        println!("  {}", unsearched.join(", "));
        assert!(unsearched.len() < 3 * n_maps, "search was compared nowhere");
    }
}
