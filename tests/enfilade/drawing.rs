//! The command `render` as people and scripts meet it.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::cli::{enfilade, level, refused};
use crate::scene::FREEDOOM;

/// The picture in a PNG file.
fn picture(path: &Path) -> image::RgbImage {
    image::open(path).expect("a PNG").to_rgb8()
}

#[test]
fn draws_a_level_and_says_what_it_did() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = ["one.png", "two.png"].map(|n| folder.path().join(n));
    let museum = level("museum.toml");
    let draw = |to: &Path, more: &[&str]| {
        let to = to.to_string_lossy().into_owned();
        let mut arguments = vec![
            "render",
            &museum,
            "--size",
            "90x60",
            "--samples",
            "2",
            "-o",
            &to,
        ];
        arguments.extend(more);
        enfilade(&arguments)
    };
    let output = draw(&one, &[]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8_lossy(&output.stdout);
    for part in [
        "90 × 60, camera `foyer`",
        "in the level",
        "in the eye's PVS",
        "touched",
        "10800 primary",
        "seconds     read",
        "shadows     on   light `Sun`",
        "refraction  off  material `water` has it",
        "glossy      off  no material mirrors and is rough",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    let first = picture(&one);
    assert_eq!(first.dimensions(), (90, 60));
    // Many different colours: not a blank picture.
    let colours: std::collections::HashSet<_> = first.pixels().collect();
    assert!(colours.len() > 300, "{}", colours.len());
    // The same again on one thread, quietly, with everything simulated, by brute force.
    let more = [
        "--threads",
        "1",
        "--effects",
        "all",
        "--structure",
        "brute",
        "--quiet",
    ];
    let output = draw(&two, &more);
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
    assert_eq!(first, picture(&two));
    // And something else with another seed, without shadows, from elsewhere.
    for more in [
        &["--seed", "2"][..],
        &["--effects", "none"],
        &["--eye", "48,30,2", "--look", "60,30,4"],
        &["--exposure", "1"],
        &["--fov", "40"],
    ] {
        assert_eq!(draw(&two, more).status.code(), Some(0), "{more:?}");
        assert_ne!(first, picture(&two), "{more:?}");
    }
}

#[test]
fn writes_to_standard_output() {
    let tiny = level("tiny.toml");
    let output = enfilade(&["render", &tiny, "--size", "20x10", "-o", "-"]);
    assert_eq!(output.status.code(), Some(0));
    let read = image::load_from_memory(&output.stdout).expect("nothing but a PNG");
    assert_eq!((read.width(), read.height()), (20, 10));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("primary"), "{text}");
}

#[test]
fn says_what_is_wrong_and_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("no.png").to_string_lossy().into_owned();
    let tiny = level("tiny.toml");
    let refuse = |more: &[&str], parts: &[&str]| {
        let mut arguments = vec!["render", &tiny, "-o", &to];
        arguments.extend(more);
        refused(&arguments, parts);
    };
    refuse(&["--camera", "roof"], &["`roof`", "hall"]);
    refuse(&["--look", "1,1,1"], &["--eye"]);
    let at = |eye: &'static str| ["--eye", eye, "--look", "1,1,1"];
    refuse(
        &at("50,50,1"),
        &["50,50", "outside of the level", "enfilade plan"],
    );
    refuse(
        &at("2,2,7"),
        &["2,2", "height 7", "floor is at 0", "ceiling at 2.6"],
    );
    refuse(&at("1,1,1"), &["look at another point"]);
    refuse(&at("1,1"), &["three numbers"]);
    refuse(&["--size", "20"], &["960x600"]);
    refuse(&["--effects", "fog"], &["`fog`", "translucency"]);
    refuse(
        &["--structure", "tree"],
        &["`tree`", "bvh-median-boxes", "portal"],
    );
    refuse(&["--fov", "180"], &["below 180"]);
    refuse(&["--threads", "0"], &["--threads 0"]);
    refused(
        &["render", &tiny, "-o", "picture.jpg"],
        &["picture.jpg", ".png"],
    );
    refused(
        &["render", &tiny, "-o", "/no/such/folder/a.png"],
        &["/no/such/folder/a.png"],
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn names_missing_meshes_and_textures() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    let to = folder.path().join("no.png").to_string_lossy().into_owned();
    let room = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n";
    for (text, parts) in [
        (
            "[[object]]\nname = \"cat\"\nkind = \"mesh\"\nfile = \"cat.obj\"\nposition = [2, 2, 0]\n",
            ["cat.obj", "mesh `cat`"],
        ),
        (
            "[[material]]\nname = \"marble\"\ntexture = \"marble.png\"\n",
            ["marble.png", "material `marble`"],
        ),
    ] {
        std::fs::write(&path, format!("{room}{text}")).unwrap();
        let level = path.to_string_lossy();
        refused(&["render", &level, "-o", &to], &parts);
    }
    // A picture that is none.
    std::fs::write(folder.path().join("marble.png"), "no picture").unwrap();
    let level = path.to_string_lossy();
    refused(
        &["render", &level, "-o", &to],
        &["marble.png is no PNG picture"],
    );
}

#[test]
fn a_doom_map_from_its_players_start() {
    if !Path::new(FREEDOOM).exists() {
        assert!(
            std::env::var_os("CI").is_none(),
            "install the package freedoom"
        );
        eprintln!("skipped: {FREEDOOM} is missing");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("e1m1.png");
    let to = path.to_string_lossy().into_owned();
    let arguments = [
        "render", FREEDOOM, "--map", "E1M1", "--size", "96x60", "-o", &to,
    ];
    let output = enfilade(&arguments);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0));
    assert!(text.contains("camera `player`"), "{text}");
    let colours: std::collections::HashSet<_> = picture(&path).pixels().copied().collect();
    assert!(colours.len() > 500, "{}", colours.len());
}

#[test]
fn what_is_broken_off_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("big.png");
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args([
            "render",
            &level("museum.toml"),
            "--size",
            "4000x4000",
            "--samples",
            "64",
        ])
        .args(["--threads", "1", "-o"])
        .arg(&to)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(2));
    assert!(
        child.try_wait().unwrap().is_none(),
        "it should still be at work"
    );
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
