use std::sync::Arc;

use glam::DVec2;

use super::super::model::{Interior, OpeningStyle, SectorId, WallKind};
use super::*;
use crate::geom::GridPoint;
use crate::level::toml::read;
use crate::level::toml::write::write;

const TWO_ROOMS: &str = "[[room]]\nname = 'Hall'\nrect = [0, 0, 6, 4]\n\
                         [[room]]\nname = 'Kitchen'\nrect = [6, 0, 10, 4]\n\
                         [[door]]\npoints = [[6, 1], [6, 2]]\n";

fn level(text: &str) -> Level {
    read(text, "test.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn at(level: &Level, x: f64, y: f64) -> GridPoint {
    level.grid.nearest(v(x, y)).unwrap()
}

/// The ends of all openings.
fn openings(level: &Level) -> Vec<[DVec2; 2]> {
    let openings = level.walls.iter().filter(|w| runs::is_opening(w));
    openings
        .map(|w| [w.from, w.to].map(|p| level.grid.to_level(p)))
        .collect()
}

fn door(level: &Level) -> WallId {
    near::opening(level, v(6.0, 1.5), 0.1).unwrap()
}

#[test]
fn all_walls_of_a_corner_move_along_and_the_door_stays_in_its_wall() {
    let level = level(TWO_ROOMS);
    let moved = move_point(&level, at(&level, 6.0, 4.0), v(6.0, 5.5)).unwrap();
    assert_eq!(openings(&moved), [[v(6.0, 1.0), v(6.0, 2.0)]]);
    assert!(
        moved
            .walls
            .iter()
            .all(|w| { ![w.from, w.to].contains(&at(&moved, 6.0, 4.0)) })
    );
    let ends = moved.walls.iter().flat_map(|w| [w.from, w.to]);
    assert_eq!(ends.filter(|p| *p == at(&moved, 6.0, 5.5)).count(), 4);

    // Slanted: the walls are parted at the door's ends, exactly, and both rooms stay open to it.
    let slanted = move_point(&level, at(&level, 6.0, 4.0), v(7.0, 4.3)).unwrap();
    let [[p, q]] = openings(&slanted)[..] else {
        panic!("one door");
    };
    assert!((p.distance(q) - 1.0).abs() < 2e-4 && (p.distance(v(6.0, 0.0)) - 1.0).abs() < 2e-4);
    let door = slanted.walls[door_of(&slanted)].clone();
    let beneath = slanted.walls.iter().filter(|w| {
        w.outline.is_some()
            && ([w.from, w.to] == [door.from, door.to] || [w.to, w.from] == [door.from, door.to])
    });
    assert_eq!(beneath.count(), 2);
    // And back: the door is where it was.
    let back = move_point(&slanted, at(&slanted, 7.0, 4.3), v(6.0, 4.0)).unwrap();
    let [p, q] = openings(&back)[0];
    assert!(p.distance(v(6.0, 1.0)) < 2e-4 && q.distance(v(6.0, 2.0)) < 2e-4);
    write(&slanted).unwrap();
    // An outline that runs the other way around by now still has its room on the right side.
    let turned = move_point(&level, at(&level, 6.0, 4.0), v(-1.0, -1.0)).unwrap();
    assert_eq!(turned.walls[0].right, Some(SectorId(0)));
    write(&turned).unwrap();
}

fn door_of(level: &Level) -> usize {
    level.walls.iter().position(runs::is_opening).unwrap()
}

#[test]
fn a_shorter_wall_pushes_its_door_or_is_refused() {
    let level = level(TWO_ROOMS);
    let corner = at(&level, 6.0, 4.0);
    let pushed = move_point(&level, corner, v(6.0, 1.5)).unwrap();
    assert_eq!(openings(&pushed), [[v(6.0, 0.5), v(6.0, 1.5)]]);
    let error = move_point(&level, corner, v(6.0, 0.75)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "an opening is 1.00 wide, and its wall has only 0.75"
    );
}

#[test]
fn what_would_be_no_level_is_refused() {
    let level = level(TWO_ROOMS);
    let corner = at(&level, 6.0, 4.0);
    let error = |to| move_point(&level, corner, to).unwrap_err().to_string();
    assert_eq!(
        error(v(3.0, -1.0)),
        "the outline of the room `Hall` would cross or touch itself"
    );
    assert_eq!(
        error(v(0.0, 4.0)),
        "a wall would start and end in the same point"
    );
    assert!(error(v(1e6, 0.0)).starts_with("(1000000, 0) is too far away"));
    assert_eq!(
        move_point(&level, at(&level, 3.0, 3.0), v(0.0, 0.0)).unwrap_err(),
        EditError::NoPoint
    );
    assert_eq!(
        toggle(&level, WallId(99)).unwrap_err(),
        EditError::NoWall(WallId(99))
    );
    assert_eq!(toggle(&level, WallId(0)).unwrap_err(), EditError::NoLeaf);
    assert_eq!(
        delete_wall(&level, WallId(0)).unwrap_err(),
        EditError::OuterWall
    );
    assert_eq!(
        remove_opening(&level, WallId(0)).unwrap_err(),
        EditError::NotAnOpening
    );
}

#[test]
fn a_wall_moves_with_both_ends_and_its_door() {
    let level = level(TWO_ROOMS);
    let shared = near::wall(&level, v(6.0, 3.0), 0.1).unwrap();
    let moved = move_wall(&level, shared, v(1.5, 0.0)).unwrap();
    assert_eq!(openings(&moved), [[v(7.5, 1.0), v(7.5, 2.0)]]);
    assert_eq!(
        near::point(&moved, v(7.5, 4.1), 0.2),
        Some(at(&moved, 7.5, 4.0))
    );
    assert_eq!(near::point(&moved, v(7.5, 4.3), 0.2), None);
}

#[test]
fn doors_are_toggled_walled_up_and_cut() {
    let level = level(TWO_ROOMS);
    let shut = |l: &Level| match &l.walls[door(l).0 as usize].kind {
        WallKind::Opening(o) => o.shut,
        _ => unreachable!(),
    };
    assert!(shut(&level));
    let open = toggle(&level, door(&level)).unwrap();
    assert!(!shut(&open));
    assert!(shut(&toggle(&open, door(&open)).unwrap()));

    let without = remove_opening(&level, door(&level)).unwrap();
    assert!(openings(&without).is_empty());
    let wall = near::wall(&without, v(6.0, 3.0), 0.1).unwrap();
    let cut =
        |l: &Level, at: DVec2, width| add_opening(l, wall, at, width, plain(OpeningStyle::Window));
    let window = cut(&without, v(6.2, 3.9), 1.0).unwrap();
    let [[p, q]] = openings(&window)[..] else {
        panic!("one window");
    };
    assert_eq!([p.min(q), p.max(q)], [v(6.0, 3.0), v(6.0, 4.0)]);
    assert_eq!(
        cut(&window, v(6.0, 3.0), 1.0).unwrap_err(),
        EditError::Overlaps
    );
    assert!(cut(&window, v(6.0, 2.5), 1.0).is_ok());
    assert!(matches!(
        cut(&level, v(6.0, 2.0), 5.0),
        Err(EditError::TooWide { .. })
    ));
    assert_eq!(
        cut(&level, v(6.0, 2.0), -1.0).unwrap_err(),
        EditError::Width(-1.0)
    );
}

#[test]
fn a_deleted_wall_joins_two_rooms() {
    let level = level(TWO_ROOMS);
    let shared = near::wall(&level, v(6.0, 3.0), 0.1).unwrap();
    let joined = delete_wall(&level, shared).unwrap();
    let [[p, q]] = openings(&joined)[..] else {
        panic!("one archway");
    };
    assert_eq!([p.min(q), p.max(q)], [v(6.0, 0.0), v(6.0, 4.0)]);
}

#[test]
fn pillars_zones_and_free_walls_go_as_a_whole() {
    let level = level(&format!(
        "{TWO_ROOMS}[[zone]]\nrect = [1, 1, 2, 2]\nfloor = 0.2\n\
         [[zone]]\nrect = [3, 1, 4, 2]\nfloor = 0.4\n\
         [[pillar]]\ncenter = [8, 2]\nradius = 0.5\n\
         [[wall]]\npoints = [[5, 0], [5, 3]]\n[[archway]]\npoints = [[5, 1], [5, 2]]\n"
    ));
    let pillar = near::wall(&level, v(8.5, 2.0), 0.1).unwrap();
    let less = delete_wall(&level, pillar).unwrap();
    assert_eq!(less.walls.len(), level.walls.len() - 16);
    assert_eq!(less.outlines.len(), 4);
    write(&less).unwrap();
    let zone = near::wall(&level, v(1.5, 1.0), 0.1).unwrap();
    let less = delete_wall(&level, zone).unwrap();
    assert_eq!((less.sectors.len(), less.sectors[2].floor.rest), (3, 0.4));
    assert_eq!(less.outlines[3].sector, Some(SectorId(2)));
    write(&less).unwrap();
    let free = near::wall(&level, v(5.0, 2.5), 0.1).unwrap();
    let less = delete_wall(&level, free).unwrap();
    assert_eq!(openings(&less).len(), 1);
    assert_eq!(
        add_opening(&level, pillar, v(8.5, 2.0), 0.1, plain(OpeningStyle::Door)).unwrap_err(),
        EditError::Pillar
    );
    // A room cannot leave its zone behind.
    let error = move_point(&level, at(&level, 0.0, 0.0), v(2.5, 2.5)).unwrap_err();
    assert_eq!(error.to_string(), "a zone would lie in no room");
}

const DOOM: &str = "unit = 'map unit'\nnumbers = 'binary'\n\
    [[sector]]\nceiling = 128\n[[sector]]\nceiling = 0\nceiling_range = [0, 72]\n\
    [[sector]]\nceiling = 128\n\
    [[line]]\nright = 0\npoints = [[64, 0], [0, 0], [0, 64], [64, 64]]\n\
    [[line]]\nright = 1\npoints = [[64, 64], [80, 64]]\n\
    [[line]]\nright = 2\npoints = [[80, 64], [144, 64], [144, 0], [80, 0]]\n\
    [[line]]\nright = 1\npoints = [[80, 0], [64, 0]]\n\
    [[line]]\nkind = 'edge'\nstate = 'closed'\nright = 0\nleft = 1\npoints = [[64, 64], [64, 0]]\n\
    [[line]]\nkind = 'edge'\nstate = 'closed'\nright = 1\nleft = 2\npoints = [[80, 64], [80, 0]]\n\
    [[line]]\nleft = 2\nright = 2\npoints = [[112, 0], [112, 32]]\n";

#[test]
fn doors_of_doom_open_with_their_sectors() {
    let level = level(DOOM);
    assert_eq!(level.interior, Interior::Sides);
    let edge = near::wall(&level, v(64.0, 20.0), 1.0).unwrap();
    let open = toggle(&level, edge).unwrap();
    let shut = |l: &Level| -> Vec<bool> {
        let kinds = l.walls.iter().map(|w| &w.kind);
        kinds
            .filter_map(|k| match k {
                WallKind::Edge { shut } => Some(*shut),
                _ => None,
            })
            .collect()
    };
    assert_eq!((shut(&level), shut(&open)), (vec![true; 2], vec![false; 2]));
    assert_eq!(open.sectors[1].ceiling.rest, 72.0);
    let again = toggle(&open, edge).unwrap();
    assert_eq!(
        (shut(&again), again.sectors.clone()),
        (vec![true; 2], level.sectors.clone())
    );
    write(&open).unwrap();

    let inner = near::wall(&level, v(112.0, 16.0), 1.0).unwrap();
    let cut = add_opening(
        &level,
        inner,
        v(112.0, 10.0),
        8.0,
        plain(OpeningStyle::Door),
    )
    .unwrap();
    assert_eq!(openings(&cut), [[v(112.0, 6.0), v(112.0, 14.0)]]);
    assert_eq!(cut.walls.len(), level.walls.len() + 2);
    let hole = near::opening(&cut, v(112.0, 10.0), 1.0).unwrap();
    write(&toggle(&cut, hole).unwrap()).unwrap();
    let filled = remove_opening(&cut, hole).unwrap();
    assert!(filled.walls.iter().all(|w| !runs::is_opening(w)));
    let outer = near::wall(&level, v(0.0, 16.0), 1.0).unwrap();
    for error in [
        add_opening(&level, outer, v(0.0, 10.0), 8.0, plain(OpeningStyle::Door)),
        delete_wall(&level, outer),
    ] {
        assert_eq!(error.unwrap_err(), EditError::OuterWall);
    }
    assert_eq!(delete_wall(&level, edge).unwrap_err(), EditError::Border);
    let open = delete_wall(&level, inner).unwrap();
    let gone = near::wall(&open, v(112.0, 16.0), 1.0).unwrap();
    assert_eq!(
        open.walls[gone.0 as usize].kind,
        WallKind::Edge { shut: false }
    );
    assert_eq!(
        delete_wall(&open, gone).unwrap().walls.len(),
        level.walls.len() - 1
    );
}

#[test]
fn history_goes_back_and_forth_within_its_memory() {
    let first = Arc::new(level(TWO_ROOMS));
    let step = |l: &Level, x: f64| {
        let corner = near::point(l, v(10.0, 4.0), 3.0).unwrap();
        Arc::new(move_point(l, corner, v(x, 4.0)).unwrap())
    };
    let mut history = History::new(first.clone(), usize::MAX);
    assert!(!history.undo() && !history.redo());
    for x in [10.5, 11.0, 11.5] {
        let next = step(history.present(), x);
        history.change(next);
    }
    assert_eq!((history.n_past(), history.n_future()), (3, 0));
    assert!(history.undo() && history.undo());
    assert_eq!(
        near::point(history.present(), v(10.5, 4.0), 0.1),
        Some(at(history.present(), 10.5, 4.0))
    );
    assert!(history.redo());
    assert_eq!((history.n_past(), history.n_future()), (2, 1));
    let other = step(history.present(), 12.0);
    history.amend(other);
    assert_eq!((history.n_past(), history.n_future()), (2, 0));

    let mut small = History::new(first.clone(), 1);
    small.change(step(&first, 11.0));
    assert!(!small.undo());
    let mut some = History::new(first.clone(), 20_000);
    for i in 0..100 {
        let next = step(some.present(), 10.0 + f64::from(i % 7 + 1) / 4.0);
        some.change(next);
    }
    assert!((2..50).contains(&some.n_past()), "{}", some.n_past());
}
