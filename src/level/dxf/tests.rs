use super::*;
use crate::level::drawing::role::LayerRule;
use crate::level::snap::snap;
use crate::level::{Finding, Level, OpeningStyle, WallKind};

/// A file of some entities, each written as `0 LINE 8 WALL 10 0 …`.
fn file(header: &str, blocks: &str, entities: &str) -> Vec<u8> {
    let words = format!(
        "0 SECTION 2 HEADER {header} 0 ENDSEC 0 SECTION 2 BLOCKS {blocks} 0 ENDSEC \
         0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    );
    words
        .split_whitespace()
        .collect::<Vec<_>>()
        .join("\n")
        .into_bytes()
}

fn line(layer: &str, [x0, y0, x1, y1]: [f64; 4]) -> String {
    format!(" 0 LINE 8 {layer} 10 {x0} 20 {y0} 11 {x1} 21 {y1}")
}

/// The four sides of a rectangle as lines.
fn rectangle(layer: &str, [x0, y0, x1, y1]: [f64; 4]) -> String {
    [
        [x0, y0, x1, y0],
        [x1, y0, x1, y1],
        [x1, y1, x0, y1],
        [x0, y1, x0, y0],
    ]
    .map(|l| line(layer, l))
    .concat()
}

const METRES: &str = "9 $INSUNITS 70 6";

fn level_with(bytes: &[u8], options: &DrawingOptions) -> Level {
    let draft = read(bytes, "plan.dxf", options).unwrap_or_else(|e| panic!("{e}"));
    snap(draft).unwrap()
}

fn level(entities: &str) -> Level {
    level_with(&file(METRES, "", entities), &DrawingOptions::default())
}

fn message(bytes: &[u8]) -> String {
    read(bytes, "plan.dxf", &DrawingOptions::default())
        .unwrap_err()
        .to_string()
}

fn found<'a>(level: &'a Level, code: &str) -> &'a Finding {
    let found = level.findings.iter().find(|f| f.code == code);
    found.unwrap_or_else(|| panic!("no {code} in {:#?}", level.findings))
}

/// What the finding about the inside says of areas: `2 rooms of together 24 m²`.
fn rooms(level: &Level) -> String {
    let message = &found(level, "room").message;
    message["Inside: ".len()..message.find(". Areas").unwrap()].to_string()
}

/// The areas of the rooms, as the finding lists them.
fn areas(level: &Level) -> Vec<f64> {
    let message = &found(level, "room").message;
    let list = message
        .split("places: ")
        .nth(1)
        .unwrap()
        .trim_end_matches('.');
    list.split(", ").map(|a| a.parse().unwrap()).collect()
}

fn openings(level: &Level) -> Vec<(OpeningStyle, [f64; 4])> {
    let opening = |w: &crate::level::Wall| match &w.kind {
        WallKind::Opening(o) => {
            let [a, b] = [w.from, w.to].map(|p| level.grid.to_level(p));
            Some((o.style, [a.x, a.y, b.x, b.y]))
        }
        _ => None,
    };
    level.walls.iter().filter_map(opening).collect()
}

fn near(a: f64, b: f64, off: f64) -> bool {
    (a - b).abs() <= off
}

#[test]
fn lines_make_a_room() {
    let level = level(&rectangle("WALL", [0.0, 0.0, 4.0, 3.0]));
    assert_eq!(rooms(&level), "1 room of together 12 m²");
    assert_eq!(
        (level.unit.as_str(), level.walls.len(), level.snap),
        ("m", 4, 0.0)
    );
}

#[test]
fn walls_of_two_lines_have_a_body() {
    let walls = rectangle("A-WALL", [0.0, 0.0, 8.6, 4.6])
        + &rectangle("A-WALL", [0.3, 0.3, 4.2, 4.3])
        + &rectangle("A-WALL", [4.4, 0.3, 8.3, 4.3]);
    let level = level(&walls);
    assert_eq!(rooms(&level), "2 rooms of together 31.2 m²");
    assert_eq!(found(&level, "wall-body").places.len(), 1);
}

#[test]
fn a_door_in_a_gap_and_one_over_a_wall() {
    let outer = rectangle("WALL", [0.0, 0.0, 8.0, 4.0]);
    let gap = line("WALL", [4.0, 0.0, 4.0, 1.0]) + &line("WALL", [4.0, 1.9, 4.0, 4.0]);
    let whole = line("WALL", [4.0, 0.0, 4.0, 4.0]);
    let plain = line("DOOR", [4.0, 1.0, 4.0, 1.9]);
    // Leaf to the east, arc back to the wall: hinge at (4, 1).
    let swing = line("DOOR", [4.0, 1.0, 4.9, 1.0]) + " 0 ARC 8 DOOR 10 4 20 1 40 0.9 50 0 51 90";
    for walls in [&gap, &whole] {
        for door in [&plain, &swing] {
            let level = level(&(outer.clone() + walls + door));
            assert_eq!(rooms(&level), "2 rooms of together 32 m²", "{walls} {door}");
            let [(style, [x0, y0, x1, y1])] = openings(&level)[..] else {
                panic!("{:?}", openings(&level));
            };
            assert_eq!((style, x0, x1), (OpeningStyle::Door, 4.0, 4.0));
            assert!(
                near(y0.min(y1), 1.0, 1e-6) && near(y0.max(y1), 1.9, 1e-6),
                "{y0} {y1}"
            );
        }
    }
    // Without the door there is one room.
    assert_eq!(
        rooms(&level(&(outer.clone() + &gap))),
        "1 room of together 32 m²"
    );
}

#[test]
fn a_window_over_a_thick_wall_is_cut_through_both_lines() {
    let walls = rectangle("WALL", [0.0, 0.0, 4.6, 4.6]) + &rectangle("WALL", [0.3, 0.3, 4.3, 4.3]);
    let window = rectangle("WINDOW", [1.0, 4.3, 2.5, 4.6]);
    let level = level(&(walls + &window));
    // The reveal of 1.5 by 0.3 belongs to the room.
    assert_eq!(rooms(&level), "1 room of together 16.45 m²");
    // Both lines are cut; the inner cut parts the reveal from its own room, which is nothing.
    let [(style, [_, y0, _, y1])] = openings(&level)[..] else {
        panic!("{:?}", openings(&level));
    };
    assert_eq!((style, y0, y1), (OpeningStyle::Window, 4.6, 4.6));
    assert_eq!(found(&level, "threshold").places.len(), 1);
}

#[test]
fn walls_and_windows_drawn_without_ends() {
    // Two faces of a wall around 4 by 3, with a gap from x = 1 to 2.5; panes in line with the faces and
    // between, nothing across.
    let around = |low: f64, x: f64, y: f64| {
        [
            [1.0, low, low, low],
            [low, low, low, y],
            [low, y, x, y],
            [x, y, x, low],
            [x, low, 2.5, low],
        ]
        .map(|l| line("WALL", l))
        .concat()
    };
    let panes = [0.0, 0.125, 0.25]
        .map(|y| line("WINDOW", [1.0, y, 2.5, y]))
        .concat();
    let level = level(&(around(0.0, 4.5, 3.5) + &around(0.25, 4.25, 3.25) + &panes));
    assert_eq!(rooms(&level), "1 room of together 12.38 m²");
    assert_eq!(found(&level, "open-wall-end").places.len(), 2);
    assert_eq!(found(&level, "wall-body").places.len(), 1);
}

#[test]
fn two_leaves_are_one_opening() {
    let walls = line("WALL", [0.0, 0.0, 1.0, 0.0])
        + &line("WALL", [2.8, 0.0, 4.0, 0.0])
        + &line("WALL", [4.0, 0.0, 4.0, 3.0])
        + &line("WALL", [4.0, 3.0, 0.0, 3.0])
        + &line("WALL", [0.0, 3.0, 0.0, 0.0]);
    let doors =
        " 0 ARC 8 DOOR 10 1 20 0 40 0.9 50 0 51 90 0 ARC 8 DOOR 10 2.8 20 0 40 0.9 50 90 51 180";
    let level = level(&(walls + doors));
    assert_eq!(rooms(&level), "1 room of together 12 m²");
    assert_eq!(openings(&level).len(), 1, "{:?}", openings(&level));
}

#[test]
fn curves_keep_to_the_tolerance() {
    let circle = " 0 CIRCLE 8 WALL 10 5 20 5 40 3";
    let ellipse = " 0 ELLIPSE 8 WALL 10 5 20 5 11 3 21 0 40 0.5 41 0 42 6.283185307179586";
    let arcs = " 0 ARC 8 WALL 10 5 20 5 40 3 50 0 51 180 0 ARC 8 WALL 10 5 20 5 40 3 50 180 51 360";
    let bulges = " 0 LWPOLYLINE 8 WALL 90 2 70 1 10 2 20 5 42 1 10 8 20 5 42 1";
    let old = " 0 POLYLINE 8 WALL 66 1 70 1 0 VERTEX 8 WALL 10 2 20 5 42 1 0 VERTEX 8 WALL 10 8 20 5 42 1 0 SEQEND";
    let disc = std::f64::consts::PI * 9.0;
    for (shape, area) in [
        (circle, disc),
        (ellipse, disc / 2.0),
        (arcs, disc),
        (bulges, disc),
        (old, disc),
    ] {
        for tolerance in [0.1, 0.01, 0.001] {
            let options = DrawingOptions {
                tolerance: Some(tolerance),
                ..DrawingOptions::default()
            };
            let level = level_with(&file(METRES, "", shape), &options);
            let [inside] = areas(&level)[..] else {
                panic!("{shape}")
            };
            // Inside the curve, and at most the tolerance all around.
            assert!(
                inside <= area * 1.001 && inside >= area - 20.0 * tolerance,
                "{shape}: {inside}"
            );
            assert!(found(&level, "curve").message.contains("straight pieces"));
        }
    }
}

#[test]
fn splines() {
    // A closed curve of degree 1 is the polygon of its control points.
    let square = " 0 SPLINE 8 WALL 70 1 71 1 72 7 73 5 40 0 40 0 40 1 40 2 40 3 40 4 40 4 \
        10 0 20 0 10 4 20 0 10 4 20 4 10 0 20 4 10 0 20 0";
    assert_eq!(rooms(&level(square)), "1 room of together 16 m²");
    let unsound =
        rectangle("WALL", [0.0, 0.0, 4.0, 3.0]) + " 0 SPLINE 8 WALL 71 3 40 0 40 1 10 0 20 0";
    assert!(
        found(&level(&unsound), "ignored")
            .message
            .contains("unsound SPLINE")
    );
}

/// A room of 2 by 1 with its base point in its middle.
const ROOM_BLOCK: &str = "0 BLOCK 2 ROOM 10 1 20 0.5 0 LWPOLYLINE 8 0 90 4 70 1 \
    10 0 20 0 10 2 20 0 10 2 20 1 10 0 20 1 0 ENDBLK";

#[test]
fn blocks_are_scaled_turned_and_mirrored() {
    let blocks = format!(
        "{ROOM_BLOCK} 0 BLOCK 2 PAIR 10 0 20 0 0 INSERT 2 ROOM 8 0 10 0 20 0 \
        0 INSERT 2 ROOM 8 0 10 2 20 0 50 90 0 ENDBLK"
    );
    let place =
        "0 INSERT 2 PAIR 8 WALL 10 10 20 10 41 -2 42 2 50 30 0 INSERT 2 ROOM 8 WALL 10 0 20 0";
    let level = level_with(&file(METRES, &blocks, place), &DrawingOptions::default());
    let mut areas = areas(&level);
    areas.sort_by(f64::total_cmp);
    assert!(
        areas.len() == 3
            && near(areas[0], 2.0, 1e-6)
            && near(areas[1], 8.0, 1e-3)
            && near(areas[2], 8.0, 1e-3),
        "{areas:?}"
    );
    let many = "0 INSERT 2 ROOM 8 WALL 10 0 20 0 70 4 71 3 44 5 45 5";
    let level = level_with(&file(METRES, &blocks, many), &DrawingOptions::default());
    assert_eq!(rooms(&level), "12 rooms of together 24 m²");
}

#[test]
fn what_is_seen_from_below_is_turned_around() {
    // The left half of a circle, seen from below, is its right half.
    let half = line("WALL", [0.0, -3.0, 0.0, 3.0])
        + " 0 ARC 8 WALL 10 0 20 0 40 3 50 90 51 270 210 0 220 0 230 -1";
    let level = level(&half);
    let right = level
        .walls
        .iter()
        .flat_map(|w| [w.from, w.to])
        .map(|p| level.grid.to_level(p).x);
    assert!(near(right.fold(0.0, f64::max), 3.0, 0.02));
}

#[test]
fn units() {
    let walls = rectangle("WALL", [0.0, 0.0, 400.0, 300.0]);
    let unit = |header: &str, option: Option<&str>| {
        let options = DrawingOptions {
            unit: option.map(|u| u.parse().unwrap()),
            ..DrawingOptions::default()
        };
        level_with(&file(header, "", &walls), &options)
    };
    assert_eq!(
        unit("9 $INSUNITS 70 5 9 $MEASUREMENT 70 0", None).unit,
        "cm"
    );
    assert_eq!(
        unit("9 $INSUNITS 70 0 9 $MEASUREMENT 70 0", None).unit,
        "in"
    );
    // 400 mm are no building.
    assert_eq!(unit("9 $MEASUREMENT 70 1", None).unit, "cm");
    assert_eq!(unit("9 $INSUNITS 70 5", Some("ft")).unit, "ft");
    let scaled = unit("9 $INSUNITS 70 5", Some("0.02"));
    assert_eq!(
        (scaled.unit.as_str(), rooms(&scaled).as_str()),
        ("m", "1 room of together 48 m²")
    );
    let doubtful = unit("9 $INSUNITS 70 4", None);
    assert!(
        found(&doubtful, "doubtful-unit")
            .message
            .contains("--unit cm")
    );
}

#[test]
fn layers_tell_what_is_drawn() {
    let drawn = rectangle("OUTLINE", [0.0, 0.0, 4.0, 3.0])
        + &line("I-FURN", [1.0, 1.0, 2.0, 1.0])
        + " 0 HATCH 8 A-WALL-PATT 10 0 20 0 0 DIMENSION 8 DIMS 0 TEXT 8 TEXT 10 1 20 1 40 0.2 1 Hall";
    let unnamed = level(&drawn);
    assert_eq!(unnamed.sectors[0].name.as_deref(), Some("Hall"));
    assert!(
        found(&unnamed, "unnamed-walls")
            .message
            .contains("4 × layer OUTLINE")
    );
    let ignored = &found(&unnamed, "ignored").message;
    assert!(
        ignored.contains("1 × HATCH") && ignored.contains("1 × DIMENSION"),
        "{ignored}"
    );
    found(&unnamed, "furniture");
    let rules: Vec<LayerRule> = vec![
        "wall=I-F*".parse().unwrap(),
        "ignored=OUT*".parse().unwrap(),
    ];
    let options = DrawingOptions {
        layers: rules,
        ..DrawingOptions::default()
    };
    let level = level_with(&file(METRES, "", &drawn), &options);
    assert_eq!(level.walls.len(), 1);
    found(&level, "no-room");
    let none = file(METRES, "", &line("I-FURN", [1.0, 1.0, 2.0, 1.0]));
    assert!(
        message(&none).contains("--layer wall=NAME"),
        "{}",
        message(&none)
    );
}

#[test]
fn gaps_are_listed_and_closed_when_asked() {
    let open = line("WALL", [0.0, 0.0, 4.0, 0.0])
        + &line("WALL", [4.0, 0.0, 4.0, 3.0])
        + &line("WALL", [4.0, 3.0, 0.0, 3.0])
        + &line("WALL", [0.0, 2.98, 0.0, 0.0]);
    let bytes = file(METRES, "", &open);
    let level = level_with(&bytes, &DrawingOptions::default());
    found(&level, "no-room");
    assert!(
        found(&level, "gap").message.contains("0.02"),
        "{:?}",
        found(&level, "gap")
    );
    let closing = |size| DrawingOptions {
        close_gaps: Some(size),
        ..DrawingOptions::default()
    };
    let mended = level_with(&bytes, &closing(0.05));
    assert_eq!(rooms(&mended), "1 room of together 12 m²");
    assert_eq!(found(&mended, "closed-gap").places.len(), 1);
    found(&level_with(&bytes, &closing(0.01)), "no-room");
}

#[test]
fn doubled_and_stray_walls_are_told() {
    let walls = rectangle("WALL", [0.0, 0.0, 4.0, 3.0])
        + &line("WALL", [0.0, 0.0, 4.0, 0.0])
        + &line("WALL", [4.0, 1.0, 4.0, 2.0])
        + &line("WALL", [1.0, 1.0, 2.0, 1.0]);
    let level = level(&walls);
    assert_eq!(found(&level, "duplicate-wall").places.len(), 1);
    assert_eq!(found(&level, "overlapping-walls").places.len(), 1);
    assert_eq!(found(&level, "stray-line").places.len(), 2);
    assert_eq!(rooms(&level), "1 room of together 12 m²");
}

#[test]
fn crossing_walls_part_four_rooms() {
    let walls = rectangle("WALL", [0.0, 0.0, 4.0, 4.0])
        + &line("WALL", [0.0, 0.0, 4.0, 4.0])
        + &line("WALL", [0.0, 4.0, 4.0, 0.0]);
    assert_eq!(rooms(&level(&walls)), "4 rooms of together 16 m²");
    // An island: a ring of walls in a room, and a room in the ring.
    let island = rectangle("WALL", [0.0, 0.0, 9.0, 9.0])
        + &rectangle("WALL", [2.0, 2.0, 7.0, 7.0])
        + &rectangle("WALL", [3.0, 3.0, 6.0, 6.0]);
    let level = level(&island);
    assert_eq!(areas(&level), [56.0, 16.0, 9.0]);
}

#[test]
fn mistakes_have_a_line() {
    let whole = file(METRES, ROOM_BLOCK, &rectangle("WALL", [0.0, 0.0, 4.0, 3.0]));
    let mut refused = 0;
    for n in 0..whole.len() {
        if let Err(error) = read(&whole[..n], "plan.dxf", &DrawingOptions::default()) {
            refused += 1;
            assert!(error.to_string().starts_with("line "), "{n}: {error}");
        }
    }
    assert!(refused + 16 > whole.len(), "{refused} of {}", whole.len());
    let text = String::from_utf8(whole.clone()).unwrap();
    let wrong = text.replacen("11\n4", "11\nfour", 1);
    assert!(message(wrong.as_bytes()).contains("group 11 has to be a number, not `four`"));
    for number in ["1e999", "nan", "inf"] {
        assert!(
            message(
                text.replacen("11\n4", &format!("11\n{number}"), 1)
                    .as_bytes()
            )
            .starts_with("line ")
        );
    }
    let far = text.replacen("11\n4", "11\n1e200", 1);
    assert!(
        message(far.as_bytes()).contains("too large"),
        "{}",
        message(far.as_bytes())
    );
    assert!(message(b"hello\nworld\n").starts_with("line 1: a group code"));
    assert!(message(&[0xff, 0xfe, b'0', 0]).contains("UTF-16"));
    assert!(message(b"AC1027\0\0").contains("DWG"));
    assert!(message(b"").contains("ENTITIES"));
    assert!(message(&file("", "", "0 INSERT 2 NO 10 0 20 0")).contains("'NO'"));
}

#[test]
fn blocks_in_a_circle_are_named() {
    let block = |name: &str, inner: &str| {
        format!("0 BLOCK 2 {name} 10 0 20 0 0 INSERT 2 {inner} 8 0 10 1 20 1 0 ENDBLK ")
    };
    let circle = block("A", "B") + &block("B", "C") + &block("C", "A");
    let message = message(&file("", &circle, "0 INSERT 2 B 8 WALL 10 0 20 0"));
    assert!(message.contains("B → C → A → B"), "{message}");
}

#[test]
fn blocks_that_multiply_are_refused() {
    // Each block draws the next one ten times: 10^9 lines.
    let mut blocks = String::from("0 BLOCK 2 B0 0 LINE 8 0 10 0 20 0 11 1 21 0 0 ENDBLK ");
    for i in 1..10 {
        blocks += &format!(
            "0 BLOCK 2 B{i} 0 INSERT 2 B{} 8 0 70 10 44 2 0 ENDBLK ",
            i - 1
        );
    }
    let refusal = message(&file("", &blocks, "0 INSERT 2 B9 8 WALL 10 0 20 0"));
    assert!(refusal.contains("more than 1000000"), "{refusal}");
    let empty = "0 BLOCK 2 E 0 ENDBLK";
    let columns = "0 INSERT 2 E 8 WALL 10 0 20 0 70 32767 71 32767";
    assert!(message(&file("", empty, columns)).contains("'E' is drawn more than"));
    let mut deep = String::from("0 BLOCK 2 B0 0 LINE 8 0 10 0 20 0 11 1 21 0 0 ENDBLK ");
    for i in 1..200 {
        deep += &format!("0 BLOCK 2 B{i} 0 INSERT 2 B{} 8 0 0 ENDBLK ", i - 1);
    }
    assert!(message(&file("", &deep, "0 INSERT 2 B199 8 WALL")).contains("nested more than"));
}

/// Two rooms, 4 by 3 m each in the unit of `scale` per metre, walls 0.24 thick, a door between.
fn two_rooms(wall: &str, door: &str, scale: f64) -> String {
    let at = |values: [f64; 4]| values.map(|v| v * scale);
    let rooms = [
        [0.0, 0.0, 8.72, 3.48],
        [0.24, 0.24, 4.24, 3.24],
        [4.48, 0.24, 8.48, 3.24],
    ];
    rooms.map(|r| rectangle(wall, at(r))).concat() + &line(door, at([4.36, 1.0, 4.36, 1.9]))
}

#[test]
fn without_a_unit_the_plan_tells_which_fits() {
    for (header, scale, unit) in [
        ("", 100.0, "cm"),
        ("", 1.0, "m"),
        ("", 1000.0, "mm"),
        ("9 $MEASUREMENT 70 0", 1.0 / 0.0254, "in"),
        ("9 $INSUNITS 70 0 9 $MEASUREMENT 70 1", 1.0 / 0.0254, "in"),
        ("9 $MEASUREMENT 70 0", 1.0 / 0.3048, "ft"),
    ] {
        let bytes = file(header, "", &two_rooms("WALL", "DOOR", scale));
        let level = level_with(&bytes, &DrawingOptions::default());
        assert_eq!(level.unit, unit, "{header} {scale}");
        assert_eq!(
            rooms(&level),
            "2 rooms of together 24.22 m²",
            "{header} {scale}"
        );
        let guessed = level.findings.iter().any(|f| f.code == "guessed-unit");
        let said = unit
            == if header.ends_with('0') && !header.contains("INS") {
                "in"
            } else {
                "mm"
            };
        assert_eq!(guessed, !said, "{header} {scale}");
        assert!(level.findings.iter().all(|f| f.code != "doubtful-unit"));
    }
    // What the file says is kept, though doubted, and so is what was asked for.
    let bytes = file("9 $INSUNITS 70 4", "", &two_rooms("WALL", "DOOR", 1.0));
    let level = level_with(&bytes, &DrawingOptions::default());
    assert_eq!(level.unit, "mm");
    found(&level, "doubtful-unit");
}

#[test]
fn walls_of_a_plan_to_a_scale_are_no_thicker_than_its_doors() {
    // At 1:50 in mm: half a metre of wall would be as thick as the plan is deep.
    let bytes = file("9 $INSUNITS 70 4", "", &two_rooms("WALL", "DOOR", 20.0));
    let level = level_with(&bytes, &DrawingOptions::default());
    assert_eq!(level.sectors.len(), 2);
    assert_eq!(openings(&level).len(), 1, "{:?}", openings(&level));
}

#[test]
fn lines_of_an_mline_lie_beside_its_corners() {
    // Around 8 by 6, half of 0.2 on either side, the miters at its corners outwards; then a partition
    // with a gap cut into it.
    let corner = |[x, y]: [f64; 2], [dx, dy]: [f64; 2], [mx, my]: [f64; 2]| {
        let line = |aside: f64| format!(" 74 2 41 {aside} 41 0 75 0");
        format!(" 11 {x} 21 {y} 12 {dx} 22 {dy} 13 {mx} 23 {my}")
            + &line(0.1 * 2f64.sqrt())
            + &line(-0.1 * 2f64.sqrt())
    };
    let h = 0.5f64.sqrt();
    let around = " 0 MLINE 8 WALL 70 1 71 3 72 4 73 2 10 0 20 0".to_string()
        + &corner([0.0, 0.0], [1.0, 0.0], [-h, -h])
        + &corner([8.0, 0.0], [0.0, 1.0], [h, -h])
        + &corner([8.0, 6.0], [-1.0, 0.0], [h, h])
        + &corner([0.0, 6.0], [0.0, -1.0], [-h, h]);
    let cut = " 0 MLINE 8 WALL 71 1 72 2 73 1 10 4 20 0.1 \
               11 4 21 0.1 12 0 22 1 13 -1 23 0 74 4 41 0 41 0 41 2 41 2.9 75 0 \
               11 4 21 5.9 12 0 22 1 13 -1 23 0 74 2 41 0 41 0 75 0";
    let level = self::level(&(around.clone() + cut + &line("DOOR", [4.0, 2.1, 4.0, 3.0])));
    assert_eq!(rooms(&level), "2 rooms of together 45.24 m²");
    assert_eq!(openings(&level).len(), 1);
    assert_eq!(rooms(&self::level(&around)), "1 room of together 45.24 m²");
}

#[test]
fn a_block_that_is_not_there_is_left_out_and_named() {
    let insert = " 0 INSERT 2 SITE 8 XREF 10 3 20 4";
    let level = level(&(rectangle("WALL", [0.0, 0.0, 4.0, 3.0]) + insert));
    assert_eq!(rooms(&level), "1 room of together 12 m²");
    let missing = found(&level, "missing-block");
    assert!(missing.message.contains("1 × SITE"), "{missing:?}");
    assert_eq!(
        missing.places,
        [crate::level::Place::Point { x: 3.0, y: 4.0 }]
    );
}

#[test]
fn without_walls_the_message_names_what_is_there() {
    let message = message(&file(METRES, "", " 0 3DSOLID 8 A-WALL 0 3DSOLID 8 A-WALL"));
    assert!(message.contains("2 × 3DSOLID"), "{message}");
}

#[test]
fn the_frame_of_the_sheet_is_outside_where_no_name_tells() {
    let frame = |layer| rectangle(layer, [-2.0, -2.0, 10.72, 5.48]);
    let plan = two_rooms("0", "0", 1.0);
    let level = level(&(plan.clone() + &frame("0")));
    assert_eq!(rooms(&level), "2 rooms of together 24 m²");
    assert_eq!(found(&level, "sheet-frame").places.len(), 1);
    // A wall by its name is a wall, and a room with a column in it is a room.
    let level = self::level(&(two_rooms("WALL", "0", 1.0) + &frame("WALL")));
    assert_eq!(level.sectors.len(), 3);
    let column = rectangle("0", [4.0, 3.0, 4.4, 3.4]);
    let level = self::level(&(rectangle("0", [0.0, 0.0, 8.0, 6.0]) + &column));
    assert_eq!(level.sectors.len(), 1);
}

#[test]
fn one_polyline_of_too_many_pieces_is_refused_in_bounded_memory() {
    let corners: String = (0..20_000)
        .map(|i| format!(" 10 {}e12 20 0 42 1", i % 2))
        .collect();
    let message = message(&file(
        METRES,
        "",
        &format!(" 0 LWPOLYLINE 8 WALL 70 0{corners}"),
    ));
    assert!(
        message.contains("line ") && message.contains("points"),
        "{message}"
    );
}
