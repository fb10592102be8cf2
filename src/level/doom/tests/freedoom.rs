//! Every map of both Freedoom WADs. Where they are not installed the test says so and passes,
//! except under `CI=true`. With `FREEDOOM_PRINT=1` it prints findings and moving sectors, for a
//! look by eye (`cargo test every_map_of_freedoom -- --nocapture`).

use std::path::Path;

use crate::level::Severity;
use crate::level::doom::{DoomMap, read_doom_map};
use crate::level::wad::{Wad, WadMap};

const FOLDER: &str = "/usr/share/games/doom";

#[test]
fn every_map_of_freedoom_is_read() {
    for (file, n_maps) in [("freedoom1.wad", 36), ("freedoom2.wad", 32)] {
        let path = Path::new(FOLDER).join(file);
        let Ok(bytes) = std::fs::read(&path) else {
            let missing = format!("{} is not there; install Freedoom", path.display());
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            continue;
        };
        let wad = Wad::parse(bytes).unwrap();
        let maps = wad.maps();
        assert_eq!(maps.len(), n_maps, "{file}");
        for lumps in &maps {
            let map = read_doom_map(&wad, &lumps.name, file).unwrap();
            check(&wad, lumps, &map);
            if std::env::var_os("FREEDOOM_PRINT").is_some() {
                print(&map);
            }
        }
        check_export(&wad, &maps);
    }
}

fn check(wad: &Wad, lumps: &WadMap, map: &DoomMap) {
    let draft = &map.draft;
    let name = &draft.name;
    let n_records = |lump, record| wad.lump_in_map(lumps, lump).unwrap().len() / record;
    let left_out = |code| {
        let found = draft.findings.iter().find(|f| f.code == code);
        found.map_or(0, |f| f.places.len())
    };
    let n_left_out: usize = [
        "dangling-vertex",
        "zero-length-wall",
        "no-sidedef",
        "duplicate-linedef",
    ]
    .map(left_out)
    .iter()
    .sum();
    assert_eq!(
        draft.walls.len() + n_left_out,
        n_records("LINEDEFS", 14),
        "{name}"
    );
    assert_eq!(map.surfaces.len(), n_records("LINEDEFS", 14), "{name}");
    assert_eq!(draft.sectors.len(), n_records("SECTORS", 26), "{name}");
    assert_eq!(map.things.len(), n_records("THINGS", 10), "{name}");
    assert!(map.player_start().is_some(), "{name}");
    for sector in &draft.sectors {
        for height in [sector.floor, sector.ceiling] {
            assert!(
                height.low <= height.rest && height.rest <= height.high,
                "{name}"
            );
        }
    }
    // Published maps: little is to be repaired.
    let repaired = draft
        .findings
        .iter()
        .filter(|f| f.severity == Severity::Repaired);
    assert!(
        repaired.map(|f| f.places.len()).sum::<usize>() < 10,
        "{name}"
    );
}

/// New REJECT lumps, of the old size for one map and of another for the next, leave all else alone.
fn check_export(wad: &Wad, maps: &[WadMap]) {
    let size = wad.lump_in_map(&maps[0], "REJECT").unwrap().len();
    let rejects = [
        (maps[0].name.clone(), vec![0x55; size]),
        (maps[1].name.clone(), vec![0xAA; 7]),
    ];
    let copy = Wad::parse(wad.with_rejects(&rejects).unwrap()).unwrap();
    assert_eq!(copy.lumps().len(), wad.lumps().len());
    let replaced = [0, 1].map(|i| wad.find_in_map(&maps[i], "REJECT").unwrap());
    for (i, (old, new)) in wad.lumps().iter().zip(copy.lumps()).enumerate() {
        assert_eq!(old.name, new.name);
        match replaced.iter().position(|&r| r == i) {
            Some(which) => assert_eq!(copy.lump(i), rejects[which].1),
            None => assert_eq!(copy.lump(i), wad.lump(i)),
        }
    }
}

fn print(map: &DoomMap) {
    let name = &map.draft.name;
    for finding in &map.draft.findings {
        println!("{name}: {finding}");
    }
    for (number, sector) in map.draft.sectors.iter().enumerate() {
        for (what, height) in [("floor", sector.floor), ("ceiling", sector.ceiling)] {
            if height.moves() {
                println!("{name}: sector {number}, {what}: {height:?}");
            }
        }
    }
}
