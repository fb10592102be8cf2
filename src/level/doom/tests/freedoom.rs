//! Every map of both Freedoom WADs. Where they are not installed the test says so and passes,
//! except under `CI=true`. `FREEDOOM_FINDINGS=1` prints what the maps' findings are.

use std::path::Path;

use crate::level::doom::{DoomMap, read_doom_map};
use crate::level::wad::Wad;

const FOLDER: &str = "/usr/share/games/doom";

/// Every map of a Freedoom WAD, or `None` where it is not installed.
pub fn maps(file: &str) -> Option<Vec<DoomMap>> {
    let path = Path::new(FOLDER).join(file);
    let Ok(bytes) = std::fs::read(&path) else {
        let missing = format!("{} is not there; install Freedoom", path.display());
        assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
        eprintln!("skipped: {missing}");
        return None;
    };
    let wad = Wad::parse(bytes).unwrap();
    let read = |m: &crate::level::wad::WadMap| read_doom_map(&wad, &m.name, file).unwrap();
    Some(wad.maps().iter().map(read).collect())
}

#[test]
fn every_map_of_freedoom_is_read() {
    for (file, n_maps) in [("freedoom1.wad", 36), ("freedoom2.wad", 32)] {
        let Some(maps) = maps(file) else { continue };
        assert_eq!(maps.len(), n_maps, "{file}");
        for map in &maps {
            let draft = &map.draft;
            let name = &draft.name;
            assert!(draft.walls.len() > 100, "{name}");
            assert!(map.surfaces.len() >= draft.walls.len(), "{name}");
            assert!(map.player_start().is_some(), "{name}");
            for sector in &draft.sectors {
                for height in [sector.floor, sector.ceiling] {
                    assert!(height.low <= height.rest && height.rest <= height.high);
                }
            }
            if std::env::var_os("FREEDOOM_FINDINGS").is_some() {
                for finding in &draft.findings {
                    println!("{file} {name}: {finding}");
                }
            }
        }
    }
}
