//! What is read, what is repaired, what is refused.

use glam::DVec2;

use super::build::{
    WEST_DOOR, add_line, binary_wad, read, read_bytes, set_special, text_of, text_wad, three_rooms,
};
use crate::level::doom::raw::{RawMap, RawSector, Specials};
use crate::level::doom::{DoomMap, Problem};
use crate::level::wad::{Wad, tests::wad_bytes};
use crate::level::{Place, SectorId, Severity, WallKind};

/// Codes of the findings, with the numbers of their linedefs or sectors.
fn findings(map: &DoomMap) -> Vec<(&'static str, Severity, Vec<u32>)> {
    let number = |p: &Place| match *p {
        Place::Linedef(n) | Place::Sector(n) => n,
        other => panic!("{other}"),
    };
    let finding =
        |f: &crate::level::Finding| (f.code, f.severity, f.places.iter().map(number).collect());
    map.draft.findings.iter().map(finding).collect()
}

#[test]
fn all_three_layouts_give_the_same_map() {
    let doom = three_rooms();
    let mut hexen = three_rooms();
    hexen.specials = Specials::Action;
    let maps = [
        read(&doom).unwrap(),
        read(&hexen).unwrap(),
        read_bytes(text_wad(&text_of(&doom))).unwrap(),
        read_bytes(text_wad(&text_of(&hexen))).unwrap(),
    ];
    for map in &maps {
        assert_eq!(map.draft.walls, maps[0].draft.walls);
        assert_eq!(map.draft.sectors, maps[0].draft.sectors);
        assert_eq!(map.surfaces, maps[0].surfaces);
        assert_eq!(map.player_start(), Some((DVec2::new(32.0, 32.0), 90.0)));
        assert_eq!(findings(map), []);
    }
    let map = &maps[0];
    assert_eq!(map.draft.name, "MAP01");
    assert_eq!(map.draft.source, "test.wad");
    let side = map.surfaces[WEST_DOOR].back.as_ref().unwrap();
    assert_eq!(side.upper.as_deref(), Some("UPPER"));
    assert_eq!(side.lower, None);
    assert_eq!(side.middle.as_deref(), Some("WALL1"));
    let sector = &map.draft.sectors[0];
    assert_eq!(sector.light, Some(1.0));
    assert_eq!(sector.floor_material.as_deref(), Some("FLAT1"));
}

#[test]
fn the_front_is_on_the_right() {
    let map = read(&three_rooms()).unwrap();
    let wall = &map.draft.walls[WEST_DOOR];
    // From north to south: west is on the right.
    assert_eq!(
        (wall.from, wall.to),
        (DVec2::new(64.0, 64.0), DVec2::new(64.0, 0.0))
    );
    assert_eq!(
        (wall.right, wall.left),
        (Some(SectorId(0)), Some(SectorId(1)))
    );
    assert_eq!(wall.kind, WallKind::Edge { shut: false });
    assert_eq!(map.draft.walls[0].kind, WallKind::Solid);
}

#[test]
fn lines_without_length_or_vertex_are_left_out() {
    let mut map = three_rooms();
    add_line(&mut map, 3, 3, &[2]);
    add_line(&mut map, 3, 99, &[2]);
    let read = read(&map).unwrap();
    assert_eq!(read.draft.walls.len(), 10);
    assert_eq!(read.surfaces.len(), 12);
    assert_eq!(
        findings(&read),
        [
            ("dangling-vertex", Severity::Repaired, vec![11]),
            ("zero-length-wall", Severity::Repaired, vec![10]),
        ]
    );
}

#[test]
fn a_back_that_does_not_exist_leaves_a_solid_wall() {
    let mut map = three_rooms();
    map.lines[WEST_DOOR].back = Some(999);
    let read = read(&map).unwrap();
    assert_eq!(read.draft.walls[WEST_DOOR].kind, WallKind::Solid);
    assert_eq!(read.draft.walls[WEST_DOOR].left, None);
    let found = findings(&read);
    assert_eq!(found[0], ("dangling-sidedef", Severity::Repaired, vec![8]));
    // Room 1 has lost its western side.
    assert_eq!(found[1], ("unclosed-sector", Severity::Warning, vec![1]));
}

#[test]
fn flags_and_sides_that_contradict_are_told() {
    let mut map = three_rooms();
    map.lines[WEST_DOOR].two_sided = false;
    map.lines[0].two_sided = true;
    let read = read(&map).unwrap();
    assert_eq!(read.draft.walls[WEST_DOOR].kind, WallKind::Solid);
    assert_eq!(read.draft.walls[0].kind, WallKind::Solid);
    assert_eq!(
        findings(&read),
        [
            ("two-sided-flag-without-back", Severity::Repaired, vec![0]),
            ("two-sides-without-flag", Severity::Warning, vec![8]),
        ]
    );
}

#[test]
fn a_line_with_only_a_back_is_a_wall_and_one_without_sides_is_none() {
    let mut map = three_rooms();
    let line = &mut map.lines[0];
    (line.v1, line.v2, line.front, line.back) = (line.v2, line.v1, None, line.front);
    add_line(&mut map, 0, 5, &[]);
    let read = read(&map).unwrap();
    assert_eq!(read.draft.walls.len(), 10);
    assert_eq!(read.draft.walls[0].left, Some(SectorId(0)));
    assert_eq!(
        findings(&read),
        [
            ("no-sidedef", Severity::Repaired, vec![10]),
            ("missing-front-sidedef", Severity::Repaired, vec![0]),
        ]
    );
}

#[test]
fn repeated_lines_are_left_out_and_contradicting_ones_kept() {
    let mut map = three_rooms();
    // The same line from the other end, and one that says something else.
    add_line(&mut map, 1, 5, &[1, 0]);
    add_line(&mut map, 1, 5, &[1]);
    let read = read(&map).unwrap();
    assert_eq!(read.draft.walls.len(), 11);
    let found = findings(&read);
    assert_eq!(
        found[0],
        ("duplicate-linedef", Severity::Repaired, vec![10])
    );
    assert_eq!(
        found[1],
        ("conflicting-linedefs", Severity::Warning, vec![11])
    );
}

#[test]
fn odd_sectors_and_lines_are_noted() {
    let mut map = three_rooms();
    add_line(&mut map, 1, 6, &[1, 1]);
    map.sectors.push(RawSector::default());
    set_special(&mut map, 0, 62, 77);
    set_special(&mut map, 1, 300, 0);
    set_special(&mut map, 2, 62, 0);
    assert_eq!(
        findings(&read(&map).unwrap()),
        [
            ("special-without-tag", Severity::Warning, vec![2]),
            ("tag-without-sector", Severity::Note, vec![0]),
            ("unknown-special", Severity::Warning, vec![1]),
            ("same-sector-both-sides", Severity::Note, vec![10]),
            ("unused-sector", Severity::Note, vec![3]),
        ]
    );
}

#[test]
fn an_open_outline_is_told_by_its_sector() {
    let mut map = three_rooms();
    map.lines.remove(7);
    let found = findings(&read(&map).unwrap());
    assert_eq!(found, [("unclosed-sector", Severity::Warning, vec![2])]);
}

#[test]
fn polyobjects_block_nothing() {
    let mut map = three_rooms();
    map.specials = Specials::Action;
    // A pillar in room 0, its sides facing outwards, and an explicit line.
    let n = map.vertices.len() as u32;
    for (x, y) in [(16.0, 16.0), (16.0, 32.0), (32.0, 32.0)] {
        map.vertices.push(DVec2::new(x, y));
    }
    add_line(&mut map, n, n + 2, &[0]);
    add_line(&mut map, n + 2, n + 1, &[0]);
    add_line(&mut map, n + 1, n, &[0]);
    map.lines[11].special = 1;
    map.lines[7].special = 5;
    let read = read(&map).unwrap();
    for line in [7, 10, 11, 12] {
        let wall = &read.draft.walls[line];
        assert_eq!(wall.kind, WallKind::Edge { shut: false }, "{line}");
        assert_eq!(wall.left, wall.right);
    }
    let found = findings(&read);
    assert!(found.contains(&("polyobject-line", Severity::Note, vec![7, 10, 11, 12])));
}

#[test]
fn a_sector_that_does_not_exist_is_refused_with_its_line() {
    let mut map = three_rooms();
    map.sides[2].sector = 40;
    let error = read(&map).unwrap_err();
    assert_eq!(
        error.problem,
        Problem::NoSector {
            line: 2,
            side: 2,
            sector: 40,
            n_sectors: 3
        }
    );
    let message = error.to_string();
    assert!(
        message.starts_with("test.wad, map MAP01: linedef 2, sidedef 2 names sector 40"),
        "{message}"
    );
}

#[test]
fn missing_broken_and_empty_lumps_are_refused() {
    let wad = wad_bytes(&[("MAP01", b""), ("THINGS", b""), ("LINEDEFS", b"")]);
    let message = read_bytes(wad).unwrap_err().to_string();
    assert!(message.contains("lump VERTEXES is missing"), "{message}");

    let wad = wad_bytes(&[("MAP01", b""), ("VERTEXES", b"12345")]);
    let message = read_bytes(wad).unwrap_err().to_string();
    assert!(message.contains("lump VERTEXES has 5 bytes"), "{message}");

    let mut map = three_rooms();
    map.sectors.clear();
    let message = read(&map).unwrap_err().to_string();
    assert!(message.contains("there are no sectors"), "{message}");

    let wad = Wad::parse(binary_wad(&RawMap::default())).unwrap();
    let message = crate::level::doom::read_map(&wad, "E1M1", "a.wad")
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("a.wad, map E1M1: there is no map 'E1M1'; the maps are: MAP01"),
        "{message}"
    );
}
