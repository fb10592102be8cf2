use super::*;
use crate::level::toml::read;

fn level(text: &str) -> Level {
    read(text, "test.toml").unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The text that a level is written as, without its first lines.
fn text(level: &Level) -> String {
    let written = write(level).unwrap();
    let (_, rest) = written.text.split_once("name = ").unwrap();
    rest.to_string()
}

#[test]
fn rooms_are_written_as_people_write_them() {
    let given = r#""Flat"

[defaults]
ceiling = 2.5

[[room]]
name = "Hall"
rect = [0, 0, 6, 4]

[[room]]
name = "Kitchen"
outline = [[6, 0], [10, 0], [10, 4], [8, 5], [6, 4]]
floor = -0.5
floor_range = [-2, 0]
light = 0.25
materials = { walls = "tiles" }

[[pillar]]
rect = [2, 2, 2.5, 2.5]

[[zone]]
rect = [4, 1, 5, 2]
floor = 0.25
ceiling = 2.5

[[wall]]
points = [[1, 1], [2, 1], [2, 1.5]]

[[door]]
points = [[6, 1], [6, 2]]
state = "open"

[[window]]
name = "View"
points = [[1, 0], [2, 0]]
bottom = 1
top = 2

[[material]]
name = "tiles"
ks = [0.5, 0.5, 0.5]
"#;
    let level = level(&format!("name = {given}"));
    assert_eq!(level.sectors[1].floor.low, -2.0);
    assert_eq!(text(&level), given);
}

#[test]
fn sectors_and_lines_come_back_as_they_are() {
    let given = r#""Map"
unit = "map unit"
numbers = "binary"

[[sector]]  # 0
floor = 0
ceiling = 128
light = 0.5

[[sector]]  # 1
floor = 8
ceiling = 8
ceiling_range = [8, 72]

[[line]]
right = 0
points = [[0, 64], [64, 64]]

[[line]]
kind = "edge"
state = "closed"
left = 1
right = 0
points = [[64, 64], [64, 0]]

[[line]]
right = 0
points = [[64, 0], [0, 0], [0, 64]]

[[line]]
right = 1
points = [[64, 64], [128, 64], [128, 0], [64, 0]]
"#;
    let level = level(&format!("name = {given}"));
    assert_eq!(level.interior, Interior::Sides);
    assert_eq!(level.grid.step, crate::geom::Step::Binary(0));
    assert_eq!(level.walls[1].kind, WallKind::Edge { shut: true });
    assert_eq!(text(&level), given);
}

#[test]
fn slanted_openings_stay_on_the_grid_points_that_they_have() {
    let level = level(
        "[[room]]\nname = 'A'\noutline = [[0, 0], [7, 3], [2, 9]]\n\
         [[room]]\nname = 'B'\noutline = [[7, 3], [0, 0], [5, -6]]\n\
         [[door]]\nbetween = ['A', 'B']\nwidth = 0.9\n",
    );
    // Both rooms' walls and the door's ends, which lie off the straight line by less than a step.
    assert_eq!(level.walls.len(), 3 + 3 + 2 * 2 + 1);
    let back = read(&write(&level).unwrap().text, "test.toml").unwrap();
    assert_eq!(level.n_vertices, back.n_vertices);
    let door = |l: &Level| l.walls.last().map(|w| (w.from, w.to));
    assert_eq!(door(&level), door(&back));
}

#[test]
fn an_opening_over_two_walls_becomes_a_line() {
    let mut level = level(
        "[[room]]\nname = 'A'\nrect = [0, 0, 4, 3]\n\
         [[room]]\nname = 'B'\nrect = [0, 3, 4, 6]\n\
         [[archway]]\npoints = [[1, 3], [3, 3]]\n",
    );
    // Each of the two walls in two parts, as if a wall of a third room ended there.
    let n = level.walls.len();
    for i in (0..n).rev() {
        let wall = level.walls[i].clone();
        if wall.from.y == wall.to.y && wall.outline.is_some() && wall.from.x != wall.to.x {
            let middle = crate::geom::GridPoint::new((wall.from.x + wall.to.x) / 2, wall.from.y);
            let mut rest = wall.clone();
            rest.from = middle;
            level.walls[i].to = middle;
            level.walls.insert(i + 1, rest);
        }
    }
    let text = text(&level);
    assert!(text.contains("[[line]]\nkind = \"archway\""), "{text}");
}

#[test]
fn what_cannot_be_written_is_refused() {
    let mut level = level("[[room]]\nname = 'A'\nrect = [0, 0, 4, 3]\n");
    level.walls.pop();
    let error = write(&level).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the walls of the room `A` are no closed line, so it cannot be written as an outline"
    );
}

#[test]
fn names_that_occur_twice_are_told_apart() {
    let mut level = level(
        "[[room]]\nname = 'A'\nrect = [0, 0, 4, 3]\n[[room]]\nname = 'B'\nrect = [4, 0, 8, 3]\n",
    );
    level.sectors[0].name = None;
    level.sectors[1].name = Some("Room 1".into());
    let text = text(&level);
    assert!(text.contains("\"Room 1\"\nrect = [0, 0, 4, 3]"), "{text}");
    assert!(text.contains("\"Room 1 1\"\nrect = [4, 0, 8, 3]"), "{text}");
}
