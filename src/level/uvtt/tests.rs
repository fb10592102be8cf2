use super::*;
use crate::level::snap::snap;
use crate::level::{Level, WallKind};

/// Two rooms of 3 × 4 and 5 × 4 squares with a gap for a door between them, and a column.
const TWO_ROOMS: &str = r#"{
 "format": 0.3,
 "resolution": {"map_origin": {"x": 0, "y": 0}, "map_size": {"x": 10, "y": 6}, "pixels_per_grid": 70},
 "line_of_sight": [
  [{"x": 1, "y": 1}, {"x": 9, "y": 1}, {"x": 9, "y": 5}, {"x": 1, "y": 5}, {"x": 1, "y": 1}],
  [{"x": 4, "y": 1}, {"x": 4, "y": 2.3}],
  [{"x": 4, "y": 3.3}, {"x": 4, "y": 5}]
 ],
 "objects_line_of_sight": [
  [{"x": 6, "y": 3}, {"x": 7, "y": 3}, {"x": 7, "y": 4}, {"x": 6, "y": 4}, {"x": 6, "y": 3}]
 ],
 "portals": [{"position": {"x": 4, "y": 2.8}, "bounds": [{"x": 4, "y": 2.3}, {"x": 4, "y": 3.3}],
   "rotation": 1.570796, "closed": true, "freestanding": false}],
 "environment": {"baked_lighting": true, "ambient_light": "ffffffff"},
 "lights": [{"position": {"x": 2, "y": 2}, "range": 4, "intensity": 1, "color": "ffeccd8b", "shadows": true}],
 "image": "iVBORw0KGgo="
}"#;

fn level(text: &str) -> Level {
    let draft =
        read(text, "map.uvtt", &DrawingOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    snap(draft).unwrap()
}

fn message(text: &str) -> String {
    read(text, "map.uvtt", &DrawingOptions::default())
        .unwrap_err()
        .to_string()
}

fn said(level: &Level, code: &str) -> String {
    let found = level.findings.iter().find(|f| f.code == code);
    found.map_or_else(
        || panic!("no {code} in {:?}", level.findings),
        |f| f.message.clone(),
    )
}

#[test]
fn rooms_doors_columns_and_lights() {
    let level = level(TWO_ROOMS);
    assert_eq!(level.sectors.len(), 2);
    assert!(
        said(&level, "room").contains("2 rooms of together 31 square²"),
        "{}",
        said(&level, "room")
    );
    said(&level, "solid");
    let openings: Vec<_> = (level.walls.iter())
        .filter(|w| matches!(w.kind, WallKind::Opening(_)))
        .collect();
    let [door] = openings[..] else {
        panic!("{openings:?}");
    };
    assert!(door.left.is_some() && door.right.is_some() && door.left != door.right);
    // y goes up: 6 - 2.3, exactly.
    let ends = [door.from, door.to].map(|p| level.grid.to_level(p).y);
    assert_eq!(ends, [3.7, 2.7]);
    assert!(level.grid.to_level(door.from).x == 4.0 && level.snap == 0.0);
    assert_eq!(level.scene.lights.len(), 1);
}

#[test]
fn a_wall_behind_a_portal_is_cut() {
    let uncut = TWO_ROOMS.replace(
        r#"[{"x": 4, "y": 1}, {"x": 4, "y": 2.3}],
  [{"x": 4, "y": 3.3}, {"x": 4, "y": 5}]"#,
        r#"[{"x": 4, "y": 1}, {"x": 4, "y": 5}]"#,
    );
    assert_ne!(uncut, TWO_ROOMS);
    let [cut, gap] = [level(&uncut), level(TWO_ROOMS)];
    assert_eq!(cut.walls.len(), gap.walls.len());
    assert_eq!(cut.sectors.len(), 2);
    let open = TWO_ROOMS.replace("\"closed\": true", "\"closed\": false");
    let shut = |level: &Level| {
        (level.walls.iter()).any(|w| matches!(&w.kind, WallKind::Opening(o) if o.shut))
    };
    assert!(shut(&gap) && !shut(&self::level(&open)));
}

#[test]
fn out_of_doors_the_rim_of_the_map_is_a_wall() {
    let outside = TWO_ROOMS.replace(
        r#""position": {"x": 2, "y": 2}"#,
        r#""position": {"x": 0.5, "y": 0.5}"#,
    );
    let level = level(&outside);
    assert_eq!(level.sectors.len(), 3);
    said(&level, "map-rim");
}

#[test]
fn mistakes_have_a_place() {
    assert!(message("{\n \"line_of_sight\": [[{\"x\": 1}]]}").contains("line 2, column "));
    assert!(message("{\n \"line_of_sight\": [[{\"x\": 1").contains("line 2, column "));
    assert!(message("{}").contains("line_of_sight"));
    assert!(message("{\"line_of_sight\": []}").contains("no walls"));
    let far = TWO_ROOMS.replace("\"x\": 9", "\"x\": 1e300");
    assert!(
        message(&far).contains("1e300") || message(&far).contains("too large"),
        "{}",
        message(&far)
    );
    let deep = format!("{{\"line_of_sight\": {}", "[".repeat(100_000));
    assert!(
        message(&deep).contains("line 1, column "),
        "{}",
        message(&deep)
    );
}

#[test]
fn numbers_and_truth_may_be_text() {
    let quoted = TWO_ROOMS
        .replace("\"x\": 4,", "\"x\": \"4\",")
        .replace("\"closed\": true", "\"closed\": \"true\"")
        .replace("\"range\": 4", "\"range\": \"4.0\"");
    assert_ne!(quoted, TWO_ROOMS);
    let [as_text, as_numbers] = [level(&quoted), level(TWO_ROOMS)];
    assert_eq!(as_text.walls, as_numbers.walls);
    assert_eq!(as_text.scene.lights, as_numbers.scene.lights);
    let wrong = TWO_ROOMS.replacen("\"x\": 4,", "\"x\": \"four\",", 1);
    let wrong = message(&wrong);
    assert!(
        wrong.contains("four") && wrong.contains("a number"),
        "{wrong}"
    );
    assert!(wrong.contains("line 6, column "), "{wrong}");
}

#[test]
fn a_portal_without_ends_is_left_out_where_it_stands() {
    let without = TWO_ROOMS.replace(r#""bounds": [{"x": 4, "y": 2.3}, {"x": 4, "y": 3.3}],"#, "");
    assert_ne!(without, TWO_ROOMS);
    let level = level(&without);
    assert_eq!(level.sectors.len(), 1);
    let ignored = level.findings.iter().find(|f| f.code == "ignored").unwrap();
    assert!(matches!(
        ignored.places[..],
        [crate::level::Place::Point { x: 4.0, .. }]
    ));
}
