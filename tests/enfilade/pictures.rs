//! Pictures of what an eye sees, as the program writes them.

use std::fs;

use crate::cli::{enfilade, level, refused};

/// The SVG of a plan.
fn plan(arguments: &[&str]) -> String {
    let mut all = vec!["plan"];
    all.extend(arguments);
    all.extend(["-o", "-"]);
    let output = enfilade(&all);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {errors}");
    String::from_utf8(output.stdout).expect("SVG is text")
}

/// Two rooms of 6 by 4 and 4 by 4 m with a door from (6, 1.55) to (6, 2.45). From (4, 2) the rays
/// past its jambs meet the far wall at x = 10, 1.35 above and below: (0.9 + 2.7) / 2 · 4 beyond.
#[test]
fn an_eye_s_figures_are_those_worked_out_by_hand() {
    let tiny = level("tiny.toml");
    let svg = plan(&[&tiny, "--eye", "4,2", "--fov", "360"]);
    let title = "Eye at 4.00, 2.00 in 'Hall', looking all around: sees 2 of the 2 cells of its PVS, \
                 31.2 m² (bsp, doors open)";
    assert!(svg.contains(title), "{svg}");
    for part in [
        "id=\"area\"",
        "id=\"eye\"",
        "ground in sight",
        "not in the PVS",
    ] {
        assert!(svg.contains(part), "no {part} in: {svg}");
    }
    // East, a quarter turn: up to the wall at x = 6 a triangle 2 deep, and the same beyond.
    let svg = plan(&[&tiny, "--eye", "4,2", "--direction", "0", "--fov", "90"]);
    let title = "looking 0° with 90° in view: sees 2 of the 2 cells of its PVS, 11.2 m²";
    assert!(svg.contains(title), "{svg}");
    assert!(svg.contains("eye and edges of its view"), "{svg}");
    // West, with nothing but the room itself in view.
    let svg = plan(&[&tiny, "--eye", "4,2", "--direction", "-180", "--fov", "90"]);
    assert!(svg.contains("sees 1 of the 2 cells"), "{svg}");
}

#[test]
fn without_more_an_eye_looks_up_and_a_camera_as_it_stands() {
    let museum = level("museum.toml");
    let svg = plan(&[&museum, "--eye", "48,19.5"]);
    assert!(svg.contains("looking 90° with 60° in view"), "{svg}");
    let svg = plan(&[&museum, "--camera", "rotunda"]);
    assert!(svg.contains("Eye at 48.00, 19.50"), "{svg}");
    assert!(svg.contains("looking 90° with 85° in view"), "{svg}");
    let svg = plan(&[&museum, "--camera", "rotunda", "--fov", "10"]);
    assert!(svg.contains("looking 90° with 10° in view"), "{svg}");
}

#[test]
fn an_eye_s_picture_can_be_a_png() {
    let folder = tempfile::TempDir::new().expect("there is room");
    let path = folder.path().join("eye.png");
    let name = path.to_string_lossy();
    let house = level("house.toml");
    let output = enfilade(&["plan", &house, "--camera", "garden", "-o", &name]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
    assert!(fs::read(&path).expect("written").starts_with(b"\x89PNG"));
}

#[test]
fn mistakes_with_eyes_are_named() {
    let tiny = level("tiny.toml");
    let wrong = |arguments: &[&str], parts: &[&str]| {
        let mut all = vec!["plan", &tiny, "-o", "-"];
        all.extend(arguments);
        refused(&all, parts);
    };
    wrong(&["--eye", "4,20"], &["4,20", "outside", "inside is"]);
    wrong(&["--eye", "4"], &["two numbers"]);
    wrong(&["--eye", "4,2", "--from", "4,2"], &["--from"]);
    wrong(&["--eye", "4,2", "--cell", "1"], &["--cell"]);
    wrong(&["--eye", "4,2", "--fov", "0"], &["field of view", "360"]);
    wrong(&["--eye", "4,2", "--fov", "400"], &["field of view", "360"]);
    wrong(&["--eye", "4,2", "--direction", "inf"], &["direction"]);
    wrong(&["--direction", "90"], &["--eye"]);
    wrong(&["--fov", "90"], &["--eye", "--camera"]);
    wrong(&["--camera", "attic"], &["attic", "there are: hall"]);
}
