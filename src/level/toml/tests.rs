use glam::DVec2;

use super::super::finding::Place;
use super::super::model::{Interior, OpeningStyle, OutlineId, SectorId, Wall, WallKind};
use super::super::scene::{LightShape, PathLook, PathPace, Shape};
use super::*;

const TWO_ROOMS: &str = r#"
[[room]]
name = "Hall"
rect = [0, 0, 6, 4]

[[room]]
name = "Kitchen"
rect = [6, 1, 10, 4]
floor = -0.5
ceiling = 2.5
"#;

fn level(text: &str) -> Level {
    read(text, "test.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The level of two rooms, with `more` after them.
fn two_rooms(more: &str) -> Level {
    level(&format!("{TWO_ROOMS}{more}"))
}

/// The error, as people see it.
fn error(text: &str) -> String {
    let error = read(text, "test.toml").unwrap_err();
    assert!(error.place().is_some() || matches!(error, TomlError::Snap(_)));
    error.to_string()
}

fn openings(level: &Level) -> Vec<(&Wall, [DVec2; 2])> {
    (level.walls.iter())
        .filter(|w| matches!(w.kind, WallKind::Opening(_)))
        .map(|w| (w, [level.grid.to_level(w.from), level.grid.to_level(w.to)]))
        .collect()
}

fn opening_ends(more: &str) -> [DVec2; 2] {
    openings(&two_rooms(more))[0].1
}

/// Bottom and top of the only opening.
fn opening_heights(more: &str) -> (Option<f64>, Option<f64>) {
    let level = two_rooms(more);
    match &openings(&level)[0].0.kind {
        WallKind::Opening(o) => (o.bottom, o.top),
        _ => unreachable!(),
    }
}

fn v(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

#[test]
fn rooms_become_outlines_and_sectors() {
    let level = two_rooms("");
    assert_eq!(level.name, "test");
    assert_eq!(
        (level.source.as_str(), level.unit.as_str()),
        ("test.toml", "m")
    );
    assert_eq!(level.interior, Interior::Outlines);
    assert_eq!((level.walls.len(), level.n_vertices), (8, 7));
    assert_eq!(level.sectors[0].name.as_deref(), Some("Hall"));
    assert_eq!(level.sectors[0].ceiling.rest, 3.0);
    assert_eq!(level.sectors[1].floor.rest, -0.5);
    assert_eq!(level.sectors[1].place, Place::Text { line: 6, column: 1 });
    assert_eq!(level.outlines[1].sector, Some(SectorId(1)));
    assert_eq!(level.walls[4].outline, Some(OutlineId(1)));
    assert_eq!(
        (level.walls[4].left, level.walls[4].right),
        (Some(SectorId(1)), None)
    );
    assert_eq!(level.snap, 0.0);
    assert_eq!(level.findings, []);
}

#[test]
fn an_outline_may_run_either_way() {
    for corners in ["[0, 0], [4, 0], [0, 3]", "[0, 0], [0, 3], [4, 0]"] {
        let level = level(&format!("[[room]]\nname = 'R'\noutline = [{corners}]"));
        for wall in &level.walls {
            let inside = wall.left == Some(SectorId(0));
            let (a, b) = (level.grid.to_level(wall.from), level.grid.to_level(wall.to));
            let left_of_wall = (b - a).perp_dot(v(1.0, 1.0) - a) > 0.0;
            assert_eq!(inside, left_of_wall);
        }
    }
}

#[test]
fn openings_are_placed_on_shared_walls() {
    let door = "[[door]]\nbetween = ['Hall', 'Kitchen']\n";
    assert_eq!(
        opening_ends(&format!("{door}width = 1")),
        [v(6., 2.), v(6., 3.)]
    );
    assert_eq!(
        opening_ends(&format!("{door}width = 0.9\nat = [6, 1.5]")),
        [v(6., 1.05), v(6., 1.95)]
    );
    assert_eq!(
        opening_ends("[[archway]]\nbetween = ['Hall', 'Kitchen']"),
        [v(6., 1.), v(6., 4.)]
    );
    assert_eq!(
        opening_ends("[[window]]\nroom = 'Hall'\nside = 'south'\nwidth = 2"),
        [v(2., 0.), v(4., 0.)]
    );
    assert_eq!(
        opening_ends("[[window]]\nroom = 'Hall'\nat = [0, 3]\nwidth = 1"),
        [v(0., 3.5), v(0., 2.5)]
    );
    assert_eq!(
        opening_ends("[[opening]]\npoints = [[6, 1.2], [6, 2.2]]"),
        [v(6., 1.2), v(6., 2.2)]
    );
    let level = two_rooms("[[window]]\nroom = 'Hall'\nside = 'north'\nwidth = 1\ncount = 3");
    let ends: Vec<_> = openings(&level).into_iter().map(|(_, e)| e).collect();
    assert_eq!(ends.len(), 3);
    assert_eq!(ends[1], [v(3.5, 4.), v(2.5, 4.)]);
}

#[test]
fn openings_know_their_heights_and_state() {
    let door = "[[door]]\nbetween = ['Hall', 'Kitchen']\nwidth = 1\n";
    assert_eq!(opening_heights(door), (None, None));
    // The hall's floor (0) is the higher of the two.
    assert_eq!(
        opening_heights(&format!("{door}height = 2.1")),
        (None, Some(2.1))
    );
    assert_eq!(
        opening_heights(&format!("{door}sill = 0.9\nheight = 1.2")),
        (Some(0.9), Some(2.1))
    );
    assert_eq!(
        opening_heights(&format!("{door}bottom = 0.1\ntop = 2")),
        (Some(0.1), Some(2.0))
    );
    let shut = |more: &str| match &openings(&two_rooms(more))[0].0.kind {
        WallKind::Opening(o) => o.shut,
        _ => unreachable!(),
    };
    assert!(shut(door));
    assert!(!shut(&format!("{door}state = 'open'")));
    assert!(!shut("[[window]]\nroom = 'Hall'\nside = 'west'\nwidth = 1"));
}

#[test]
fn usual_heights_end_under_a_low_ceiling() {
    let text = format!(
        "[defaults]\ndoor_height = 2.7\nwindow_sill = 0.9\nwindow_height = 1.4\n{TWO_ROOMS}\
         [[door]]\nbetween = ['Hall', 'Kitchen']\nwidth = 1\n\
         [[window]]\nroom = 'Kitchen'\nside = 'east'\nwidth = 1"
    );
    let level = level(&text);
    let heights: Vec<_> = (openings(&level).iter())
        .map(|(w, _)| match &w.kind {
            WallKind::Opening(o) => (o.style, o.bottom, o.top),
            _ => unreachable!(),
        })
        .collect();
    assert_eq!(heights[0], (OpeningStyle::Door, None, None));
    assert_eq!(heights[1].1, Some(0.4));
    assert!((heights[1].2.unwrap() - 1.8).abs() < 1e-12);
}

#[test]
fn a_door_in_a_slanted_wall_lies_on_both_rooms() {
    // Far away too, where the door's ends are computed with few digits left.
    for d in [0_i64, 100_000_000_000] {
        check_slanted_door(d);
    }
}

fn check_slanted_door(d: i64) {
    let (x0, x1) = (d, d + 7);
    let text = format!(
        "[[room]]\nname = 'A'\noutline = [[{x0}, 0], [{x1}, 3], [{x0}, 3]]\n\
         [[room]]\nname = 'B'\noutline = [[{x0}, 0], [{x1}, 0], [{x1}, 3]]\n\
         [[door]]\nbetween = ['A', 'B']\nwidth = 1\nat = [{}.5, 1.5]",
        d + 3
    );
    let level = level(&text);
    let codes: Vec<_> = level.findings.iter().map(|f| f.code).collect();
    assert_eq!(codes, ["snapped", "joined"]);
    // Both slanted edges became three pieces, one of them the door's.
    assert_eq!(level.walls.len(), 3 + 3 + 2 + 2 + 1);
    let (door, _) = openings(&level)[0];
    let under = (level.walls.iter()).filter(|w| {
        w.kind == WallKind::Outline
            && ([w.from, w.to] == [door.from, door.to] || [w.to, w.from] == [door.from, door.to])
    });
    assert_eq!(under.count(), 2);
}

#[test]
fn a_level_far_away_is_the_same_level() {
    let text = |d: i64| {
        format!(
            "[[room]]\nname = 'A'\noutline = [[{}.1, 0], [{}.1, 3], [{}.1, 3.5]]\n\
             [[pillar]]\ncenter = [{}, 2.5]\nradius = 0.25\nsides = 4",
            d,
            d + 7,
            d,
            d + 1
        )
    };
    let ends = |d| -> Vec<_> {
        let level = level(&text(d));
        level.walls.iter().map(|w| (w.from, w.to)).collect()
    };
    for d in [1_000_000, 1_000_000_000] {
        assert_eq!(ends(d), ends(0), "moved by {d}");
    }
}

#[test]
fn zones_and_pillars() {
    let level = two_rooms(
        "[[zone]]\nname = 'Dais'\nrect = [0, 1, 2, 3]\nfloor = 0.3\n\
         [[pillar]]\ncenters = [[4, 1], [4, 3]]\nradius = 0.25\nsides = 8\n\
         [[pillar]]\nrect = [2, 3.5, 2.5, 4]\n",
    );
    assert_eq!(level.sectors.len(), 3);
    assert_eq!(level.sectors[2].ceiling.rest, 3.0, "the room's");
    let kinds: Vec<_> = level.outlines.iter().map(|o| (o.sector, o.zone)).collect();
    assert_eq!(
        kinds,
        [
            (Some(SectorId(0)), false),
            (Some(SectorId(1)), false),
            (None, false),
            (None, false),
            (None, false),
            (Some(SectorId(2)), true),
        ]
    );
    let of = |outline| (level.walls.iter()).filter(move |w| w.outline == Some(OutlineId(outline)));
    assert_eq!(of(2).count(), 8);
    assert!(of(2).all(|w| w.kind == WallKind::Solid));
    assert!(of(5).all(|w| w.kind == WallKind::Edge { shut: false }));
}

#[test]
fn walls_alone_make_a_level() {
    let level = level(
        "start = [[1, 1]]\n[defaults]\nceiling = 4\n\
         [[wall]]\npoints = [[0, 0], [5, 0], [5, 5], [0, 5]]\nclosed = true\n\
         [[wall]]\npoints = [[2, 0], [2, 5]]\n\
         [[archway]]\npoints = [[2, 1], [2, 2]]",
    );
    assert_eq!(level.walls.len(), 6);
    assert_eq!(level.sectors.len(), 1);
    assert_eq!(level.sectors[0].ceiling.rest, 4.0);
    assert!(matches!(&level.interior, Interior::Enclosed { starts } if starts.len() == 1));
}

#[test]
fn the_scene_is_read() {
    let level = two_rooms(
        "[[material]]\nname = 'glass'\ntransmit = 0.9\nior = 1.52\n\
         [[light]]\nkind = 'spot'\nposition = [1, 1, 3]\ndirection = [0, 0, -2]\nangle = 30\nintensity = 5\n\
         [[object]]\nkind = 'box'\nsize = [1, 1, 0.5]\nposition = [2, 2, 0]\nscale = 2\nmaterial = 'glass'\n\
         [[camera]]\nname = 'c'\neye = [1, 1, 1.6]\nlook = [5, 1, 1.6]\n\
         [[path]]\nname = 'p'\npoints = [[1, 1, 1.6], [5, 1, 1.6]]\nseconds = 4\n\
         [[path]]\nname = 'q'\npoints = [[1, 1], [5, 1], [5, 2]]\neye = 1.5\nspeed = 1.2\nclosed = true\nfov = 75\nlook = [3, 3, 1]\n\
         [budget]\nmax_visible_cells = 12\nmax_sightline = 8.5\nmax_mean_visible_polygons = 30",
    );
    let scene = &level.scene;
    assert_eq!(scene.materials[0].ior, 1.52);
    assert_eq!(scene.lights[0].intensity, [5.0; 3]);
    assert!(
        matches!(scene.lights[0].shape, LightShape::Spot { direction, .. } if direction.z == -1.0)
    );
    assert!(matches!(scene.objects[0].shape, Shape::Box { .. }));
    assert_eq!(scene.objects[0].scale.z, 2.0);
    assert_eq!(
        (scene.cameras[0].direction.x, scene.cameras[0].fov),
        (1.0, 60.0)
    );
    let [p, q] = &scene.paths[..] else {
        panic!("two paths")
    };
    assert_eq!((p.look, p.eye, p.closed), (PathLook::Ahead, None, false));
    assert_eq!((p.pace, p.fov), (PathPace::Seconds(4.0), 60.0));
    assert_eq!((q.eye, q.closed, q.fov), (Some(1.5), true, 75.0));
    assert_eq!(q.pace, PathPace::Speed(1.2));
    assert!(matches!(q.look, PathLook::At(p) if p.z == 1.0));
    assert_eq!(scene.budget.max_visible_cells, Some(12));
    assert_eq!(scene.budget.max_sightline, Some(8.5));
    assert_eq!(scene.budget.max_mean_visible_polygons, Some(30.0));
}

/// Every mistake is reported with its place and with what to do.
#[test]
fn mistakes_are_named_with_their_place() {
    let room = "[[room]]\nname = 'R'\n";
    let cases: &[(&str, &str)] = &[
        ("[[room]\n", "line 1"),
        (
            &format!("{room}rect = [0, 0, 1, 1]\nceling = 3"),
            "line 4, column 1: unknown key `celing` (did you mean `ceiling`?)",
        ),
        (
            "[[rooom]]\nname = 'R'",
            "line 1, column 3: unknown key `rooom` (did you mean `room`?)",
        ),
        (
            "[[room]]\nrect = [0, 0, 1, 1]",
            "line 1, column 1: missing field `name`",
        ),
        (room, "line 1, column 1: room `R` needs either `rect"),
        (
            &format!("{room}outline = [[0, 0], [1, 1]]"),
            "line 1, column 1: room `R` has 2 corners",
        ),
        (
            &format!("{room}outline = [[0, 0], [4, 0], [4, 4], [0, 0]]"),
            "line 3, column 36: room `R` has the corner (0, 0) twice (first at line 3, column 12)",
        ),
        (
            &format!("{room}outline = [[0, 0], [4, 4], [4, 0], [0, 4]]"),
            "edge (4, 0) to (0, 4) meets edge (0, 0) to (4, 4)",
        ),
        (
            &format!("{room}outline = [[0, 0], [4, 0], [2, 0], [2, 4]]"),
            "edge (4, 0) to (2, 0) meets edge (0, 0) to (4, 0)",
        ),
        (
            &format!("{room}outline = [[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]"),
            "crosses or touches itself",
        ),
        (
            &format!("{room}outline = [[0, 0], [2, 2], [3, 3]]"),
            "room `R` encloses no area",
        ),
        (
            &format!("{room}rect = [0, 0, nan, 1]"),
            "line 3, column 8: NaN is not a finite number",
        ),
        (
            &format!("{room}rect = [0, 0, 1, inf]"),
            "line 3, column 8: inf is not a finite number",
        ),
        (
            &format!("{room}rect = [0, 0, 1e300, 1]"),
            "line 3, column 8: the coordinate 1",
        ),
        (
            &format!("{room}rect = [0, 0, 1, 1]\nfloor = 3"),
            "line 1, column 1: the ceiling of room `R` (3) is not above its floor (3)",
        ),
        (
            &format!("{room}rect = [0, 0, 1, 1]\n{room}rect = [1, 0, 2, 1]"),
            "line 5, column 8: another room is already called `R` (line 2, column 8)",
        ),
        (
            &format!("{room}rect = [0, 0, 1, 1]\nmaterials = {{ walls = 'oak' }}"),
            "line 4, column 23: there is no material called `oak`",
        ),
        (
            &format!("{TWO_ROOMS}[[zone]]\nrect = [20, 20, 21, 21]"),
            "line 11, column 1: zone 1 lies in no room",
        ),
        (
            &format!("{TWO_ROOMS}[[door]]\nbetween = ['Hall', 'Kitchn']\nwidth = 1"),
            "line 12, column 20: there is no room called `Kitchn` (did you mean `Kitchen`?)",
        ),
        (
            &format!("{TWO_ROOMS}[[door]]\nbetween = ['Hall', 'Kitchen']\nwidth = 3.5"),
            "line 13, column 9: the opening is 3.5 wide, but its wall has only 3.0000 there",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[door]]\nbetween = ['Hall', 'Kitchen']\nwidth = 1\nat = [6, 1.2]"
            ),
            "line 13, column 9: the opening is 1 wide, but its wall has only 0.4000 there",
        ),
        (
            &format!("{TWO_ROOMS}[[door]]\nbetween = ['Hall', 'Kitchen']"),
            "line 11, column 1: a door or window needs its `width`",
        ),
        (
            &format!("{TWO_ROOMS}[[door]]\npoints = [[6, 2], [6.5, 3]]"),
            "line 12, column 19: the point (6.5, 3) of the opening lies on no wall",
        ),
        (
            &format!("{TWO_ROOMS}[[door]]\npoints = [[5, 0], [6, 3]]"),
            "line 12, column 10: no single wall holds both ends",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[window]]\nroom = 'Hall'\nside = 'north'\nwidth = 1\nbottom = 2\ntop = 1"
            ),
            "line 11, column 1: the opening's top (1) is not above its bottom (2)",
        ),
        (
            &format!("{TWO_ROOMS}[[window]]\nroom = 'Hall'\nside = 'north'\nwidth = 1\nsill = 3"),
            "between floor and ceiling there is only 0 to 3",
        ),
        (
            &format!("{TWO_ROOMS}[[window]]\nroom = 'Hall'\nside = 'up'\nwidth = 1"),
            "line 13, column 8: unknown variant `up`",
        ),
        (
            &format!("{TWO_ROOMS}[[archway]]\nbetween = ['Hall', 'Kitchen']\nstate = 'open'"),
            "line 13, column 9: an archway, having no leaf, has no `state`",
        ),
        (
            &format!("{TWO_ROOMS}[[door]]\nbetween = ['Hall', 'Kitchen']\nwidth = -1"),
            "line 13, column 9: -1 is not above zero",
        ),
        (
            &format!("{TWO_ROOMS}[[pillar]]\ncenter = [1, 1]"),
            "line 11, column 1: a pillar needs either `center`",
        ),
        (
            &format!("{TWO_ROOMS}[[object]]\nkind = 'sphere'\nposition = [1, 1, 1]\nradius = 0"),
            "line 14, column 10: 0 is not above zero",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[object]]\nkind = 'sphere'\nposition = [1, 1, 1]\nsize = [1, 1, 1]"
            ),
            "line 14, column 8: a sphere has no `size`",
        ),
        (
            &format!("{TWO_ROOMS}[[camera]]\nname = 'c'\neye = [1, 1, 1]"),
            "line 11, column 1: a camera needs either `look`",
        ),
        (
            &format!("{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1, 1]]\nseconds = 2"),
            "line 13, column 10: a path needs at least two points",
        ),
        (
            &format!("{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1, 1], [2, 1]]\nseconds = 2"),
            "line 13, column 22: a point of a path is `[x, y, z]`",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [2, 1, 1]]\neye = 1.6\nseconds = 2"
            ),
            "line 13, column 19: a point of a path with `eye`",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [1, 1]]\neye = 1.6\nseconds = 2"
            ),
            "line 13, column 19: a path has the same point twice in a row",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [2, 1], [1, 1]]\neye = 1.6\nseconds = 2\nclosed = true"
            ),
            "line 13, column 27: a closed path ends where it starts",
        ),
        (
            &format!("{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [2, 1]]\neye = 1.6"),
            "line 11, column 1: a path needs either `seconds`",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [2, 1]]\neye = 1.6\nseconds = 1\nspeed = 1"
            ),
            "line 11, column 1: a path needs either `seconds`",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [2, 1]]\neye = 1.6\nspeed = 1\nfov = 180"
            ),
            "line 16, column 7: `fov` must be below 180",
        ),
        (
            &format!(
                "{TWO_ROOMS}[[path]]\nname = 'p'\npoints = [[1, 1], [2, 1]]\neye = 0\nspeed = 1"
            ),
            "line 14, column 7: 0 is not above zero",
        ),
        (
            &format!("{TWO_ROOMS}[[material]]\nname = 'm'\nkd = [1, 2, 0]"),
            "line 13, column 6: 2 is not between 0 and 1",
        ),
        ("name = 'nothing'", "the level has no walls"),
        (
            &format!("start = [[1, 1]]\n{TWO_ROOMS}"),
            "line 1, column 10: a level with rooms has no `start`",
        ),
        (
            "start = [[9, 9]]\n[[wall]]\npoints = [[0, 0], [1, 1]]",
            "(9, 9): the start point lies outside",
        ),
    ];
    for (text, expected) in cases {
        let message = error(text);
        assert!(
            message.contains(expected),
            "{text}\n=> {message}\nnot {expected}"
        );
    }
}

/// All sample levels can be read, and say what they show.
#[test]
fn sample_levels_are_read() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    let mut n_levels = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        n_levels += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(text.starts_with("# "), "{name} starts with what it shows");
        let level = read(&text, &name).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(
            level.findings.iter().all(|f| f.code != "zero-length-wall"),
            "{name}"
        );
        let scene = &level.scene;
        assert!(
            !scene.cameras.is_empty() && !scene.lights.is_empty(),
            "{name}"
        );
        for p in scene.cameras.iter().map(|c| c.eye) {
            assert!(is_inside(&level, p.truncate()), "{name}: camera at {p}");
        }
        for p in scene.paths.iter().flat_map(|p| &p.points) {
            assert!(is_inside(&level, p.truncate()), "{name}: path at {p}");
        }
    }
    assert!(n_levels >= 1);
}

/// Whether a point is in the level, by the rule of [`Interior::Outlines`].
fn is_inside(level: &Level, p: DVec2) -> bool {
    if level.interior != Interior::Outlines {
        return true;
    }
    let mut within = vec![false; level.outlines.len()];
    for wall in &level.walls {
        let Some(OutlineId(i)) = wall.outline else {
            continue;
        };
        let (a, b) = (level.grid.to_level(wall.from), level.grid.to_level(wall.to));
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            within[i as usize] ^= true;
        }
    }
    (level.outlines.iter().zip(within))
        .rfind(|(outline, within)| *within && !outline.zone)
        .is_some_and(|(outline, _)| outline.sector.is_some())
}

const SECTORS: &str = "numbers = 'binary'\n[[sector]]\nceiling = 128\n\
                       [[line]]\nright = 0\npoints = [[0, 0], [0, 64], [64, 64], [64, 0], [0, 0]]\n";

#[test]
fn lines_name_the_sectors_on_their_sides() {
    let level = level(SECTORS);
    assert_eq!(level.interior, Interior::Sides);
    assert_eq!((level.walls.len(), level.n_vertices), (4, 4));
    assert!(level.walls.iter().all(|w| {
        (w.kind == WallKind::Solid) && (w.left, w.right) == (None, Some(SectorId(0)))
    }));
    assert_eq!(level.sectors[0].ceiling.rest, 128.0);
    assert_eq!(level.grid.step, crate::geom::Step::Binary(0));
}

#[test]
fn lines_stand_in_levels_with_rooms_too() {
    let level = two_rooms(
        "[[line]]\nkind = 'door'\nstate = 'open'\npoints = [[6, 1], [6, 2]]\ntop = 2\n\
         [[line]]\npoints = [[1, 1], [2, 2], [3, 1]]\n",
    );
    let kinds: Vec<&WallKind> = level.walls[8..].iter().map(|w| &w.kind).collect();
    let [WallKind::Opening(door), WallKind::Solid, WallKind::Solid] = kinds[..] else {
        panic!("{kinds:?}");
    };
    assert_eq!((door.shut, door.bottom, door.top), (false, None, Some(2.0)));
}

#[test]
fn mistakes_in_sectors_and_lines() {
    let line = |more: &str| format!("[[line]]\npoints = [[0, 0], [1, 1]]\n{more}");
    for (text, expected) in [
        (
            format!("{SECTORS}[[room]]\nname = 'R'\nrect = [0, 0, 1, 1]"),
            "line 7, column 1: a level with `[[sector]]`s has no `room`; remove it",
        ),
        (
            format!("{SECTORS}{}", line("left = 1")),
            "line 9, column 8: there is no sector 1; the 1 of this level are numbered from 0",
        ),
        (
            format!("{TWO_ROOMS}{}", line("left = 0")),
            "a line in a level without `[[sector]]`s has no `left`; remove it",
        ),
        (
            line("state = 'open'"),
            "line 3, column 9: a solid line has no `state`; remove it",
        ),
        (
            line("kind = 'edge'\nbottom = 1"),
            "line 4, column 10: an edge has no `bottom`; remove it",
        ),
        (
            line("kind = 'window'\nbottom = 2\ntop = 1"),
            "line 5, column 7: the opening's top (1) is not above its bottom (2)",
        ),
        (
            "[[line]]\npoints = [[0, 0]]".to_string(),
            "line 1, column 1: line 0 has 1 corners; it needs at least 2",
        ),
        (
            "[[room]]\nname = 'R'\nrect = [0, 0, 1, 1]\nfloor_range = [1, 2]".to_string(),
            "line 4, column 15: the range of room `R` goes from 1 to 2, which does not hold the \
             height at which it starts, 0; write `[low, high]` around it",
        ),
    ] {
        let error = error(&text);
        assert!(error.contains(expected), "{error}\n{text}");
    }
}
