//! Bad input is refused or repaired; it never ends the program.

use proptest::prelude::*;

use super::build::{binary_wad, set_special, text_of, text_wad, three_rooms};
use crate::level::doom::raw::{RawMap, Specials};
use crate::level::doom::{read_doom_map, text};
use crate::level::wad::Wad;

/// Reads whatever maps there are; what comes out must be sound.
fn read_all(bytes: Vec<u8>) {
    let Ok(wad) = Wad::parse(bytes) else { return };
    for map in wad.maps() {
        let Ok(read) = read_doom_map(&wad, &map.name, "test.wad") else {
            continue;
        };
        let draft = &read.draft;
        for wall in &draft.walls {
            assert_ne!(wall.from, wall.to);
            for sector in [wall.left, wall.right].into_iter().flatten() {
                assert!((sector.0 as usize) < draft.sectors.len());
            }
        }
        for sector in &draft.sectors {
            for height in [sector.floor, sector.ceiling] {
                assert!(height.low <= height.rest && height.rest <= height.high);
            }
        }
        for finding in &draft.findings {
            assert!(!finding.places.is_empty());
        }
    }
}

fn samples() -> [RawMap; 2] {
    let mut doom = three_rooms();
    set_special(&mut doom, 8, 1, 0);
    set_special(&mut doom, 9, 62, 11);
    let mut hexen = three_rooms();
    hexen.specials = Specials::Action;
    hexen.scripts = true;
    hexen.lines[8].special = 12;
    [doom, hexen]
}

#[test]
fn maps_cut_off_anywhere() {
    for map in samples() {
        let whole = binary_wad(&map);
        for n in 0..whole.len() {
            assert!(Wad::parse(whole[..n].to_vec()).is_err());
        }
        let text = text_of(&map);
        for n in 0..text.len() {
            read_all(text_wad(&text[..n]));
        }
    }
}

proptest! {
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let mut wad = b"PWAD".to_vec();
        wad.extend(&bytes);
        read_all(wad);
        let _ = text::parse(&bytes);
        read_all(bytes);
    }

    #[test]
    fn any_text(text in "[a-z0-9 ={};\"\\\\/*.+\n-]{0,80}") {
        read_all(text_wad(&text));
        read_all(text_wad(&format!("namespace = \"Doom\"; {text}")));
    }

    #[test]
    fn maps_with_bytes_changed(
        which in 0..2usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
    ) {
        let map = &samples()[which];
        let mut bytes = binary_wad(map);
        // Beyond the header, or hardly anything would be read.
        for (index, byte) in &changes {
            let at = 12 + index.index(bytes.len() - 12);
            bytes[at] = *byte;
        }
        read_all(bytes);
    }

    #[test]
    fn any_numbers_in_any_lists(
        lines in prop::collection::vec((0u32..9, 0u32..9, 0u32..0x8000, -1i32..14, -1i32..13, any::<bool>()), 1..20),
        action in any::<bool>(),
        heights in prop::collection::vec((-200i32..200, -200i32..200), 3),
    ) {
        let mut map = three_rooms();
        map.specials = if action { Specials::Action } else { Specials::Doom };
        for (sector, (floor, ceiling)) in map.sectors.iter_mut().zip(heights) {
            (sector.floor, sector.ceiling) = (floor.into(), ceiling.into());
        }
        for (v1, v2, special, side, tag, two_sided) in lines {
            let mut line = map.lines[8].clone();
            (line.v1, line.v2, line.two_sided) = (v1, v2, two_sided);
            line.special = if action { special % 300 } else { special };
            line.front = u32::try_from(side).ok();
            line.args = [tag.max(0), 1, 8, 1, 2];
            line.tags = vec![tag];
            map.lines.push(line);
        }
        read_all(binary_wad(&map));
    }
}
