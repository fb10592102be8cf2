//! How far sectors move.

use super::build::{EAST_DOOR, WEST_DOOR, add_line, read, set_special, three_rooms};
use crate::level::doom::raw::{RawMap, RawSector, Specials, Thing};
use crate::level::doom::reach::FAR;
use crate::level::doom::specials::{Act, Follow, Goal, Meaning, Target, doom};
use crate::level::{Height, Sector, WallKind};

fn sectors(map: &RawMap) -> Vec<Sector> {
    read(map).unwrap().draft.sectors
}

fn range(low: f64, rest: f64, high: f64) -> Height {
    Height { rest, low, high }
}

/// Three rooms whose middle one is closed, its neighbours' ceilings at 128 and 96.
fn closed_door() -> RawMap {
    let mut map = three_rooms();
    map.sectors[1].ceiling = 0.0;
    map.sectors[2].ceiling = 96.0;
    map
}

fn shut_lines(map: &RawMap) -> Vec<usize> {
    let walls = read(map).unwrap().draft.walls;
    let is_shut = |&i: &usize| walls[i].kind == WallKind::Edge { shut: true };
    (0..walls.len()).filter(is_shut).collect()
}

#[test]
fn a_door_opens_to_the_lowest_neighbouring_ceiling() {
    for (special, tag) in [
        (1, 0),
        (31, 0),
        (117, 0),
        (63, 11),
        (103, 11),
        (0x3C00, 11),
        (0x3C07, 0),
    ] {
        let mut map = closed_door();
        set_special(&mut map, WEST_DOOR, special, tag);
        let sectors = sectors(&map);
        let what = format!("special {special}");
        assert_eq!(sectors[1].floor, Height::fixed(0.0), "{what}");
        assert_eq!(
            (sectors[1].ceiling.rest, sectors[1].ceiling.high),
            (0.0, 96.0),
            "{what}"
        );
        assert!(
            !sectors[0].ceiling.moves() && !sectors[2].ceiling.moves(),
            "{what}"
        );
        assert_eq!(shut_lines(&map), [WEST_DOOR, EAST_DOOR], "{what}");
    }
}

#[test]
fn a_closed_sector_that_never_moves_is_no_door() {
    assert_eq!(shut_lines(&closed_door()), [0usize; 0]);
}

#[test]
fn a_door_beside_a_rising_ceiling_opens_further() {
    let mut map = closed_door();
    set_special(&mut map, WEST_DOOR, 1, 0);
    // Room 2's ceiling goes up by 24 units, again and again, so room 0's is what stops the door.
    set_special(&mut map, EAST_DOOR, 0x4000 | (6 << 7) | 0x40 | 1, 12);
    let sectors = sectors(&map);
    assert_eq!(sectors[2].ceiling.high, FAR);
    assert_eq!(sectors[1].ceiling.high, 128.0);
}

#[test]
fn a_lift_goes_down_to_the_lowest_neighbouring_floor() {
    for special in [10, 21, 62, 88, 121, 0x3400] {
        let mut map = three_rooms();
        map.sectors[1].floor = 64.0;
        map.sectors[2].floor = -16.0;
        set_special(&mut map, WEST_DOOR, special, 11);
        assert_eq!(
            sectors(&map)[1].floor,
            range(-16.0, 64.0, 64.0),
            "special {special}"
        );
        assert_eq!(shut_lines(&map), [0usize; 0]);
    }
}

#[test]
fn a_floor_that_rises_once_for_each_line_or_without_end() {
    let mut map = three_rooms();
    set_special(&mut map, WEST_DOOR, 58, 11);
    set_special(&mut map, EAST_DOOR, 59, 11);
    assert_eq!(sectors(&map)[1].floor, range(0.0, 0.0, 48.0));
    set_special(&mut map, EAST_DOOR, 92, 11);
    assert_eq!(sectors(&map)[1].floor, range(0.0, 0.0, FAR));
}

#[test]
fn floors_that_push_each_other_up_come_to_an_end() {
    let mut map = three_rooms();
    // Each goes 8 units above the other: turbo floors of two neighbours.
    set_special(&mut map, WEST_DOOR, 36, 11);
    set_special(&mut map, EAST_DOOR, 36, 12);
    let sectors = sectors(&map);
    assert_eq!((sectors[1].floor.high, sectors[2].floor.high), (FAR, FAR));
}

#[test]
fn stairs_rise_step_by_step() {
    let mut map = three_rooms();
    // Turned so that each step lies behind the line of the one before it.
    map.lines[EAST_DOOR] = {
        let line = map.lines[EAST_DOOR].clone();
        crate::level::doom::raw::RawLine {
            v1: line.v2,
            v2: line.v1,
            front: line.back,
            back: line.front,
            ..line
        }
    };
    set_special(&mut map, WEST_DOOR, 8, 10);
    let sectors = sectors(&map);
    let highs: Vec<f64> = sectors.iter().map(|s| s.floor.high).collect();
    assert_eq!(highs, [8.0, 16.0, 24.0]);

    // A second switch can raise the same stairs once more.
    set_special(&mut map, 0, 7, 10);
    let highs: Vec<f64> = self::sectors(&map).iter().map(|s| s.floor.high).collect();
    assert_eq!(highs, [16.0, 24.0, 32.0]);
    map.lines[0].special = 0;

    map.sectors[2].floor_flat = "OTHER".to_string();
    let highs: Vec<f64> = self::sectors(&map).iter().map(|s| s.floor.high).collect();
    assert_eq!(highs, [8.0, 16.0, 0.0]);
}

#[test]
fn a_donut_moves_its_middle_and_its_ring() {
    // Rooms 0 and 1 stand for middle and ring, room 2 for the place around.
    let mut map = three_rooms();
    map.sectors[0].floor = 32.0;
    map.sectors[1].floor = -8.0;
    set_special(&mut map, WEST_DOOR, 9, 10);
    let sectors = sectors(&map);
    assert_eq!((sectors[0].floor.low, sectors[0].floor.high), (-8.0, 32.0));
    assert!(sectors[1].floor.high >= 0.0);
    assert!(!sectors[2].floor.moves());
}

#[test]
fn an_elevator_takes_its_ceiling_along() {
    let mut map = three_rooms();
    map.sectors[1].ceiling = 72.0;
    map.sectors[2].floor = 40.0;
    set_special(&mut map, EAST_DOOR, 230, 11);
    let sectors = sectors(&map);
    assert_eq!(sectors[1].floor, range(0.0, 0.0, 40.0));
    assert_eq!(sectors[1].ceiling, range(72.0, 72.0, 112.0));
}

#[test]
fn sector_specials_and_boss_tags_move_doors() {
    let mut map = three_rooms();
    map.sectors[1].special = 10;
    assert_eq!(sectors(&map)[1].ceiling, range(0.0, 128.0, 128.0));
    map.sectors[1].special = 14;
    map.sectors[1].ceiling = 0.0;
    assert_eq!(sectors(&map)[1].ceiling.high, 128.0);

    let mut map = three_rooms();
    map.sectors[1].tags = vec![666];
    map.sectors[1].floor = 100.0;
    assert_eq!(sectors(&map)[1].floor.low, 0.0);
}

#[test]
fn generalized_specials_are_decoded() {
    let acts = |number| match doom(number) {
        Meaning::Moves(mover) => (mover.target, mover.repeats, mover.acts),
        other => panic!("{number:#x}: {other:?}"),
    };
    let tagged = |repeats, act| (Target::Tagged, repeats, vec![act]);
    // Floor, W1: highest neighbouring floor, downwards.
    assert_eq!(acts(0x6000), tagged(false, Act::Floor(Goal::HighestFloor)));
    // Floor, SR: next neighbouring floor, upwards.
    assert_eq!(
        acts(0x6000 | (2 << 7) | 0x40 | 3),
        tagged(true, Act::Floor(Goal::HigherFloor))
    );
    // Floor, WR: down 32.
    assert_eq!(
        acts(0x6000 | (7 << 7) | 1),
        tagged(true, Act::FloorBy(-32.0))
    );
    // Ceiling, S1: to the floor.
    assert_eq!(
        acts(0x4000 | (4 << 7) | 2),
        tagged(false, Act::Ceiling(Goal::OwnFloor))
    );
    // Locked door, DR: opens and stays open.
    let (target, repeats, locked) = acts(0x3800 | 0x20 | 7);
    assert_eq!((target, repeats), (Target::Behind, true));
    assert_eq!(locked, [Act::Ceiling(Goal::LowestCeiling)]);
    // Lift, W1: to the next lower floor.
    assert_eq!(
        acts(0x3400 | (1 << 8)),
        tagged(false, Act::Floor(Goal::LowerFloor))
    );
    // Stairs, S1: 24 a step, upwards, whatever the flat.
    let stairs = Act::Stairs {
        step: 24.0,
        follow: Follow::AnyFlat,
    };
    assert_eq!(
        acts(0x3000 | (3 << 6) | 0x100 | 0x200 | 2),
        tagged(false, stairs)
    );
    // Crusher, WR.
    assert_eq!(
        acts(0x2F80 | 1),
        tagged(true, Act::Ceiling(Goal::AboveOwnFloor))
    );
}

#[test]
fn every_number_has_a_meaning_and_gaps_are_told() {
    for number in 0..=0xFFFF {
        let unknown = matches!(doom(number), Meaning::Unknown);
        let expected = !matches!(number, 0..=272 | 0x2F80..=0x7FFF | 340..=347 | 1024..=1026);
        assert_eq!(unknown, expected, "{number}");
    }
}

#[test]
fn action_specials_move_tagged_sectors_or_the_one_behind() {
    let mut map = closed_door();
    map.specials = Specials::Action;
    map.lines[WEST_DOOR].special = 12;
    assert_eq!(sectors(&map)[1].ceiling.high, 96.0);
    assert_eq!(shut_lines(&map), [WEST_DOOR, EAST_DOOR]);

    // Floor_LowerByValue(tag 12, speed, 40), once and again and again.
    let mut map = three_rooms();
    map.specials = Specials::Action;
    map.lines[WEST_DOOR].special = 20;
    map.lines[WEST_DOOR].args = [12, 8, 40, 0, 0];
    assert_eq!(sectors(&map)[2].floor.low, -40.0);
    map.lines[WEST_DOOR].repeats = true;
    assert_eq!(sectors(&map)[2].floor.low, -FAR);
}

#[test]
fn things_and_scripts_move_sectors_too() {
    let mut map = closed_door();
    map.specials = Specials::Action;
    map.things.push(Thing {
        special: 11,
        args: [11, 0, 0, 0, 0],
        ..Thing::default()
    });
    assert_eq!(sectors(&map)[1].ceiling.high, 96.0);

    map.things.clear();
    assert!(!sectors(&map)[1].ceiling.moves());
    map.scripts = true;
    let read = read(&map).unwrap();
    assert_eq!(read.draft.sectors[1].ceiling, range(-FAR, 0.0, FAR));
    let codes: Vec<&str> = read.draft.findings.iter().map(|f| f.code).collect();
    assert_eq!(codes, ["scripted-sector"]);
}

#[test]
fn a_slope_reaches_to_the_neighbours_height() {
    let mut map = three_rooms();
    map.sectors[1].floor = 24.0;
    set_special(&mut map, WEST_DOOR, 340, 0);
    let read = read(&map).unwrap();
    assert_eq!(read.draft.sectors[0].floor, range(0.0, 0.0, 24.0));
    assert_eq!(read.draft.findings[0].code, "sloped-sector");
}

#[test]
fn a_long_row_of_doors_is_followed_to_its_end() {
    // Doors side by side: each opens to the next one's ceiling, and only the last has an open room.
    let mut map = RawMap::default();
    let n = 60;
    for x in 0..=n {
        for y in 0..2 {
            let corner = glam::DVec2::new(f64::from(x) * 16.0, f64::from(y) * 16.0);
            map.vertices.push(corner);
        }
    }
    for x in 0..n {
        map.sectors.push(RawSector {
            ceiling: if x + 1 == n { 72.0 } else { 0.0 },
            tags: vec![1],
            ..RawSector::default()
        });
        add_line(&mut map, 2 * x + 2, 2 * x, &[x]);
        add_line(&mut map, 2 * x + 1, 2 * x + 3, &[x]);
        if x + 1 < n {
            add_line(&mut map, 2 * x + 3, 2 * x + 2, &[x, x + 1]);
        }
    }
    let last = map.lines.len() - 1;
    // Raise the ceiling to the highest neighbouring one.
    set_special(&mut map, last, 0x4000 | 0x40, 1);
    let sectors = sectors(&map);
    assert!(sectors[..59].iter().all(|s| s.ceiling.high == 72.0));
}
