//! The program as people and scripts meet it: exit status, messages, and files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

use crate::readers::{sample, two_squares};

pub fn enfilade(arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("enfilade").expect("the program is built");
    let output = command
        .args(arguments)
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!errors.contains("panicked"), "{arguments:?}: {errors}");
    output
}

pub fn level(path: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("levels")
        .join(path)
        .to_string_lossy()
        .into_owned()
}

/// A folder with a file of that content.
fn file(name: &str, content: &[u8]) -> (TempDir, String) {
    let folder = TempDir::new().expect("there is room");
    let path: PathBuf = folder.path().join(name);
    fs::write(&path, content).expect("there is room");
    let path = path.to_string_lossy().into_owned();
    (folder, path)
}

/// The program must refuse, with status 2, nothing on standard output, and one line on standard
/// error that holds all of `parts`.
pub fn refused(arguments: &[&str], parts: &[&str]) {
    let output = enfilade(arguments);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed results");
    assert!(
        errors.trim_end().lines().count() <= 8,
        "{arguments:?}: a long message:\n{errors}"
    );
    for part in parts {
        assert!(
            errors.contains(part),
            "{arguments:?}: `{part}` is not in: {errors}"
        );
    }
}

/// Refuses a TOML level, by `build` and by `check`.
fn refused_toml(text: &str, parts: &[&str]) {
    let (_folder, path) = file("wrong.toml", text.as_bytes());
    refused(&["build", &path], parts);
    let (_folder, path) = file("wrong.toml", text.as_bytes());
    assert_eq!(
        enfilade(&["check", &path]).status.code(),
        Some(2),
        "check of {text}"
    );
}

#[test]
fn mistakes_in_toml_are_named_with_line_and_column() {
    refused_toml(
        "[[room]]\nname = \"A\"\nrect = [0, 0, 4\n",
        &["wrong.toml", "line "],
    );
    refused_toml(
        "[[room]]\nname = \"A\"\nrct = [0, 0, 4, 4]\n",
        &["line 3, column 1", "rct", "rect"],
    );
    refused_toml(
        "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\nmaterials = { walls = \"gold\" }\n",
        &["line 4, column 23", "gold"],
    );
    refused_toml(
        "[[room]]\nname = \"A\"\noutline = [[0, 0], [4, 4], [4, 0], [0, 4]]\n",
        &["line 3, column", "crosses", "room `A`"],
    );
    refused_toml("", &["wrong.toml"]);
}

#[test]
fn broken_wads_are_named_with_what_is_wrong() {
    let whole = two_squares();
    for cut in [3, 12, 40, whole.len() - 1] {
        let (_folder, path) = file("cut.wad", &whole[..cut]);
        refused(&["build", &path], &["cut.wad"]);
    }
    let mut bytes = whole.clone();
    let directory = u32::from_le_bytes([bytes[8], bytes[9], bytes[10], bytes[11]]) as usize;
    // The second lump's offset.
    bytes[directory + 16..directory + 20].copy_from_slice(&0x7fff_ff00u32.to_le_bytes());
    let (_folder, path) = file("offsets.wad", &bytes);
    refused(&["build", &path], &["offsets.wad", "THINGS"]);
    let (_folder, path) = file("good.wad", &whole);
    refused(&["build", &path, "--map", "E9M9"], &["E9M9", "E1M1"]);
    assert_eq!(
        enfilade(&["build", &path, "--quiet"]).status.code(),
        Some(0)
    );
}

#[test]
fn a_wad_with_several_maps_asks_for_one() {
    let two: Vec<u8> = {
        // The same lumps twice, under two names: the directory is doubled.
        let whole = two_squares();
        let directory = u32::from_le_bytes([whole[8], whole[9], whole[10], whole[11]]) as usize;
        let mut bytes = whole.clone();
        let mut entries = whole[directory..].to_vec();
        let first = entries.len() - entries.len() + 8;
        entries[first..first + 4].copy_from_slice(b"E1M2");
        bytes.extend(&entries);
        let n = ((bytes.len() - directory) / 16) as u32;
        bytes[4..8].copy_from_slice(&n.to_le_bytes());
        bytes
    };
    let (_folder, path) = file("two.wad", &two);
    refused(&["build", &path], &["E1M1", "E1M2", "--map"]);
    assert_eq!(
        enfilade(&["build", &path, "--map", "E1M2", "-q"])
            .status
            .code(),
        Some(0)
    );
    // Names are not case-sensitive to people.
    assert_eq!(
        enfilade(&["build", &path, "--map", "e1m2", "-q"])
            .status
            .code(),
        Some(0)
    );
}

#[test]
fn files_that_are_not_there_or_cannot_be_read() {
    refused(&["build", "/no/such/level.toml"], &["/no/such/level.toml"]);
    let folder = TempDir::new().expect("there is room");
    let path = folder.path().to_string_lossy().into_owned();
    refused(&["build", &path], &[&path]);
    let (_folder, path) = file("picture.png", b"\x89PNG\r\n\x1a\n\0\0\0\0");
    refused(&["build", &path], &["picture.png"]);
    refused(&["build"], &["LEVEL"]);
    refused(
        &["build", &level("tiny.toml"), "--method", "guess"],
        &["guess", "sweep", "search"],
    );
    refused(
        &["build", &level("tiny.toml"), "--threads", "0"],
        &["--threads"],
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_said_and_old_outputs_stay() {
    let tiny = level("tiny.toml");
    refused(
        &["build", &tiny, "--quiet", "--json", "/dev/full"],
        &["/dev/full", "space"],
    );
    refused(
        &["build", &tiny, "--json", "/no/such/folder/a.json"],
        &["/no/such/folder/a.json"],
    );
    // A level that is refused leaves an old output as it was.
    let (folder, output) = file("old.json", b"old");
    let wrong = folder.path().join("wrong.toml");
    fs::write(&wrong, "[[room]]\nname = 3\n").expect("there is room");
    refused(
        &["build", &wrong.to_string_lossy(), "--json", &output],
        &["line 2, column 8"],
    );
    assert_eq!(fs::read(&output).expect("it is still there"), b"old");
    // So does a search that gives up: the answer is no.
    let gave_up = [
        "build",
        &tiny,
        "--method",
        "search",
        "--max-steps",
        "1",
        "--json",
        &output,
    ];
    assert_eq!(enfilade(&gave_up).status.code(), Some(1));
    assert_eq!(fs::read(&output).expect("it is still there"), b"old");
    // And nothing lies about beside it.
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 2);
}

#[test]
fn quiet_says_nothing_and_a_dash_is_standard_output() {
    let tiny = level("tiny.toml");
    let output = enfilade(&["build", &tiny, "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
    let output = enfilade(&["build", &tiny]);
    let table = String::from_utf8(output.stdout).expect("text");
    assert!(table.contains("2 cells, 1 portal"), "{table}");
    let output = enfilade(&["build", &tiny, "--json", "-"]);
    let value: Value = serde_json::from_slice(&output.stdout).expect("nothing but JSON");
    assert_eq!(value["format"], "enfilade.pvs");
}

/// Keys of an object, sorted.
fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value
        .as_object()
        .expect("an object")
        .keys()
        .map(|k| &k[..])
        .collect();
    keys.sort();
    keys
}

fn holds(value: &Value, expected: &[&str]) {
    let keys = keys(value);
    for key in expected {
        assert!(keys.contains(key), "no `{key}` among {keys:?}");
    }
}

fn json(arguments: &[&str]) -> Value {
    let mut all = vec!["build"];
    all.extend(arguments);
    all.extend(["--json", "-", "--quiet"]);
    let output = enfilade(&all);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).expect("nothing but JSON")
}

#[test]
fn the_json_of_two_rooms_key_by_key() {
    let value = json(&[&level("tiny.toml")]);
    let top = [
        "format",
        "version",
        "level",
        "subdivision",
        "visibility",
        "seconds",
        "cells",
        "portals",
        "visible",
    ];
    holds(&value, &top);
    assert_eq!(
        (&value["format"], &value["version"]),
        (&"enfilade.pvs".into(), &1.into())
    );
    holds(
        &value["level"],
        &[
            "name", "source", "unit", "vertices", "walls", "sectors", "snap",
        ],
    );
    assert_eq!(value["level"]["name"], "Two rooms");
    assert_eq!(value["level"]["source"], "tiny.toml");
    assert_eq!(value["level"]["unit"], "m");
    assert_eq!(value["level"]["sectors"], 2);
    assert_eq!(value["level"]["snap"], 0.0);
    assert_eq!(value["subdivision"], "bsp");
    let visibility = &value["visibility"];
    holds(
        visibility,
        &[
            "method",
            "class",
            "heights",
            "doors",
            "pairs",
            "density",
            "undecided",
        ],
    );
    assert_eq!(
        (&visibility["method"], &visibility["class"]),
        (&"sweep".into(), &"exact".into())
    );
    assert_eq!(
        (&visibility["heights"], &visibility["doors"]),
        (&false.into(), &"open".into())
    );
    assert_eq!(
        (&visibility["pairs"], &visibility["undecided"]),
        (&4.into(), &0.into())
    );
    assert_eq!(visibility["density"], 1.0);
    holds(
        &value["seconds"],
        &["read", "subdivide", "visibility", "write"],
    );
    // Two rooms, one cell each: 6 × 4 and 4 × 4, joined by a door 0.9 wide and 2.1 high.
    let cells = value["cells"].as_array().expect("a list");
    assert_eq!(cells.len(), 2);
    let mut areas: Vec<f64> = cells.iter().map(area).collect();
    areas.sort_by(f64::total_cmp);
    assert_eq!(areas, [16.0, 24.0]);
    for cell in cells {
        holds(cell, &["sector", "floor", "ceiling", "polygon"]);
        assert_eq!(
            (&cell["floor"], &cell["ceiling"]),
            (&0.0.into(), &2.6.into())
        );
    }
    let portals = value["portals"].as_array().expect("a list");
    assert_eq!(portals.len(), 1);
    holds(&portals[0], &["cells", "segment", "bottom", "top"]);
    assert_eq!(portals[0]["cells"], Value::from(vec![0, 1]));
    assert_eq!(
        (&portals[0]["bottom"], &portals[0]["top"]),
        (&0.0.into(), &2.1.into())
    );
    let mut ends: Vec<(f64, f64)> = portals[0]["segment"]
        .as_array()
        .expect("a list")
        .iter()
        .map(xy)
        .collect();
    ends.sort_by(|a, b| a.1.total_cmp(&b.1));
    assert_eq!(ends, [(6.0, 1.55), (6.0, 2.45)]);
    assert_eq!(value["visible"], serde_json::json!([[0, 1], [0, 1]]));
}

#[test]
fn a_closed_door_is_a_wall_in_the_json() {
    let value = json(&[&level("tiny.toml"), "--doors", "closed"]);
    assert_eq!(value["visibility"]["doors"], "closed");
    assert_eq!(value["portals"], serde_json::json!([]));
    assert_eq!(value["visible"], serde_json::json!([[0], [1]]));
    assert_eq!(value["visibility"]["density"], 0.5);
}

fn xy(point: &Value) -> (f64, f64) {
    (
        point[0].as_f64().expect("a number"),
        point[1].as_f64().expect("a number"),
    )
}

/// Area of a cell's polygon; positive when counterclockwise.
fn area(cell: &Value) -> f64 {
    let points: Vec<(f64, f64)> = cell["polygon"]
        .as_array()
        .expect("a list")
        .iter()
        .map(xy)
        .collect();
    let n = points.len();
    let twice = |i: usize| {
        let (p, q) = (points[i], points[(i + 1) % n]);
        p.0 * q.1 - p.1 * q.0
    };
    (0..n).map(twice).sum::<f64>() / 2.0
}

/// What contract and JSON promise of any level.
#[test]
fn the_json_of_larger_levels_holds_together() {
    for name in [
        "house.toml",
        "museum.toml",
        "hard/crossing-in-three-points.toml",
    ] {
        for subdivision in ["bsp", "kd", "cdt"] {
            let value = json(&[&level(name), "--subdivision", subdivision, "--threads", "2"]);
            assert_eq!(value["subdivision"], subdivision);
            let cells = value["cells"].as_array().expect("a list");
            let visible: Vec<Vec<usize>> =
                serde_json::from_value(value["visible"].clone()).expect("lists of numbers");
            assert_eq!(visible.len(), cells.len());
            for cell in cells {
                assert!(area(cell) > 0.0, "{name}: not counterclockwise: {cell}");
            }
            for (i, row) in visible.iter().enumerate() {
                assert!(
                    row.is_sorted_by(|a, b| a < b),
                    "{name}: row {i} does not ascend"
                );
                assert!(row.contains(&i), "{name}: cell {i} does not see itself");
                assert!(
                    row.iter().all(|&j| visible[j].contains(&i)),
                    "{name}: not symmetric"
                );
            }
            let pairs: usize = visible.iter().map(Vec::len).sum();
            assert_eq!(value["visibility"]["pairs"], pairs);
            let density = pairs as f64 / (cells.len() as f64).powi(2);
            assert_eq!(value["visibility"]["density"], density);
            for portal in value["portals"].as_array().expect("a list") {
                let [a, b]: [usize; 2] =
                    serde_json::from_value(portal["cells"].clone()).expect("two cells");
                assert!(
                    visible[a].contains(&b),
                    "{name}: {a} and {b} share a portal"
                );
            }
        }
    }
}

#[test]
fn threads_and_method_change_nothing_in_the_json() {
    let path = level("cathedral.toml");
    let [first, second] = [
        ["--threads", "1", "--method", "sweep"],
        ["--threads", "2", "--method", "search"],
    ]
    .map(|options| {
        let mut arguments = vec![&path[..]];
        arguments.extend(options);
        json(&arguments)
    });
    for key in ["level", "cells", "portals", "visible"] {
        assert_eq!(first[key], second[key], "{key}");
    }
}

#[test]
fn each_method_declares_its_class() {
    let house = level("house.toml");
    let exact = json(&[&house])["visibility"]["pairs"]
        .as_u64()
        .expect("a number");
    for (method, class, further) in [
        ("search", "exact", &[][..]),
        ("lp", "approximate", &["--time-limit", "600"]),
        ("flow", "approximate", &["--time-limit", "600"]),
        ("flood", "conservative", &[]),
        ("sample", "aggressive", &["--rays", "20", "--seed", "3"]),
    ] {
        let mut arguments = vec![&house[..], "--method", method];
        arguments.extend(further);
        let visibility = json(&arguments)["visibility"].clone();
        assert_eq!(
            (&visibility["method"], &visibility["class"]),
            (&method.into(), &class.into())
        );
        assert_eq!(visibility["undecided"], 0);
        let pairs = visibility["pairs"].as_u64().expect("a number");
        match class {
            "exact" => assert_eq!(pairs, exact),
            "conservative" => assert!(pairs > exact),
            "aggressive" => assert!(pairs < exact),
            _ => assert!(pairs > exact / 2),
        }
        // The summary says so, and so does the file, to `verify` too.
        let (_folder, path) = file("house.pvs", b"");
        let mut arguments = vec!["build", &house, "--method", method, "-o", &path];
        arguments.extend(further);
        let summary = String::from_utf8(enfilade(&arguments).stdout).expect("text");
        assert!(
            summary.contains(&format!("{method} ({class})")),
            "{summary}"
        );
        assert!(!summary.contains("undecided"), "{summary}");
        let back = enfilade::pvs::file::decode(&fs::read(&path).expect("written"));
        assert_eq!(back.expect("a PVS file").pvs.class.as_str(), class);
        let checked = enfilade(&["verify", &path, &house, "--segments", "5000"]);
        assert_eq!(checked.status.code(), Some(0), "{method}");
        let told = String::from_utf8(checked.stdout).expect("text");
        let missed = format!("not listed, as its class, {class}, allows");
        assert_eq!(told.contains(&missed), class == "aggressive", "{told}");
    }
}

#[test]
fn the_seed_and_the_number_of_rays_count() {
    let museum = level("museum.toml");
    let with = |rays: &str, seed: &str| {
        json(&[
            &museum, "--method", "sample", "--rays", rays, "--seed", seed,
        ])["visible"]
            .clone()
    };
    assert_eq!(with("5", "1"), with("5", "1"));
    assert_ne!(with("5", "1"), with("5", "2"));
    assert_ne!(with("5", "1"), with("9", "1"));
}

#[test]
fn what_is_left_undecided_is_said() {
    let maze = level("maze.toml");
    let (_folder, path) = file("maze.pvs", b"");
    let hurried = ["--method", "lp", "--time-limit", "1e-9"];
    let mut arguments = vec!["build", &maze, "-o", &path];
    arguments.extend(hurried);
    let output = enfilade(&arguments);
    assert_eq!(output.status.code(), Some(0));
    let summary = String::from_utf8(output.stdout).expect("text");
    assert!(summary.contains("undecided"), "{summary}");
    assert!(summary.contains("without proof"), "{summary}");
    let undecided = enfilade::pvs::file::decode(&fs::read(&path).expect("written"))
        .expect("a PVS file")
        .pvs
        .undecided;
    assert!(undecided > 0);
    let mut arguments = vec![&maze[..]];
    arguments.extend(hurried);
    assert!(json(&arguments)["visibility"]["undecided"].as_u64() > Some(0));
    let mut arguments = vec!["build", &maze, "--subdivision", "compare"];
    arguments.extend(hurried);
    let table = String::from_utf8(enfilade(&arguments).stdout).expect("text");
    assert!(
        table.contains("lp (approximate)") && table.contains("undecided"),
        "{table}"
    );
}

#[test]
fn options_of_other_methods_are_refused() {
    let tiny = level("tiny.toml");
    let refused = |further: &[&str], parts: &[&str]| {
        let mut arguments = vec!["build", &tiny];
        arguments.extend(further);
        refused(&arguments, parts);
    };
    refused(&["--rays", "5"], &["--rays", "--method sample"]);
    refused(
        &["--method", "flow", "--seed", "5"],
        &["--seed", "--method sample"],
    );
    refused(&["--method", "sample", "--rays", "0"], &["--rays", "0"]);
    refused(
        &["--method", "flood", "--max-steps", "5"],
        &["--max-steps", "--method search"],
    );
    for method in ["sweep", "search", "flood", "sample"] {
        refused(
            &["--method", method, "--time-limit", "5"],
            &["--time-limit", "lp", "flow", "--heights"],
        );
    }
    for limit in ["0", "-1", "soon", "nan"] {
        let given = format!("--time-limit={limit}");
        refused(&["--method", "flow", &given], &["--time-limit", "above 0"]);
    }
    refused(
        &["--heights", "--method", "flow"],
        &["--heights", "leave --method out"],
    );
    refused(&["--splits", "5"], &["--heights"]);
}

#[test]
fn what_samples_say_is_utf8_text() {
    let text = sample("tiny.toml");
    let (_folder, path) = file("with mark.toml", format!("\u{feff}{text}").as_bytes());
    assert_eq!(enfilade(&["build", &path, "-q"]).status.code(), Some(0));
    let (_folder, path) = file("latin1.toml", b"name = \"Caf\xe9\"\n");
    refused(&["build", &path], &["latin1.toml"]);
}

#[test]
fn the_pvs_file_says_what_the_json_says() {
    let (_folder, pvs) = file("house.pvs", b"old");
    let value = {
        let output = enfilade(&[
            "build",
            &level("house.toml"),
            "-q",
            "-o",
            &pvs,
            "--json",
            "-",
        ]);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        serde_json::from_slice::<Value>(&output.stdout).expect("nothing but JSON")
    };
    let bytes = fs::read(&pvs).expect("it was written");
    let back = enfilade::pvs::file::decode(&bytes).expect("what was written is read");
    let rows: Vec<Vec<u32>> = back
        .graph
        .cell_ids()
        .map(|c| back.pvs.seen_from(c).map(|d| d.0).collect())
        .collect();
    assert_eq!(
        value["visible"],
        serde_json::to_value(rows).expect("numbers")
    );
    // The same command gives the same bytes, on any number of threads.
    let (_other_folder, other) = file("other.pvs", b"");
    let again = enfilade(&[
        "build",
        &level("house.toml"),
        "-q",
        "-o",
        &other,
        "--threads",
        "1",
    ]);
    assert_eq!(again.status.code(), Some(0));
    assert_eq!(fs::read(&other).expect("it was written"), bytes);
}

#[test]
fn a_reject_table_for_two_squares_that_see_each_other() {
    let whole = two_squares();
    let (folder, path) = file("two.wad", &whole);
    let out = folder.path().join("out.wad").to_string_lossy().into_owned();
    let output = enfilade(&["export", "reject", &path, "-o", &out, "-q"]);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let wad = enfilade::level::wad::Wad::parse(fs::read(&out).expect("written")).expect("a WAD");
    // Two sectors, two by two bits, none of them set.
    assert_eq!(wad.lump_named("REJECT"), Some(&[0u8][..]));
    assert_eq!(fs::read(&path).expect("the source stays"), whole);
    refused(
        &["export", "reject", &level("tiny.toml"), "-o", &out],
        &["tiny.toml"],
    );
}

/// A room, a corridor that turns twice, and a room at its end.
const CORNER: &str = "[[room]]
name = \"A\"
rect = [0, 0, 4, 4]
\
    [[room]]
name = \"Corridor\"
outline = [[4, 0], [10, 0], [10, 10], [8, 10], [8, 2], [4, 2]]
\
    [[room]]
name = \"B\"
rect = [4, 8, 8, 12]
\
    [[door]]
points = [[4, 0.5], [4, 1.5]]
\
    [[door]]
name = \"Back door\"
points = [[8, 8.5], [8, 9.5]]
";

#[test]
fn explain_answers_in_words_in_json_and_by_its_status() {
    let (folder, path) = file("corner.toml", CORNER.as_bytes());
    let explain = |more: &[&str]| enfilade(&[&["explain", &path][..], more].concat());
    let seen = ["--from", "1,1", "--to", "6,1"];
    let hidden = ["--from", "1,1", "--to", "6,11"];
    let words = |output: &Output| String::from_utf8_lossy(&output.stdout).into_owned();

    let output = explain(&seen);
    assert_eq!(output.status.code(), Some(0));
    assert!(words(&output).contains("Visible"), "{}", words(&output));
    let output = explain(&[&hidden[..], &["--subdivision", "cdt"]].concat());
    assert_eq!(output.status.code(), Some(0));
    assert!(words(&output).contains("Not visible"), "{}", words(&output));
    assert!(words(&output).contains("Back door"), "{}", words(&output));

    let output = explain(&[&seen[..], &["--quiet"]].concat());
    assert_eq!((output.status.code(), words(&output).len()), (Some(0), 0));
    let quiet = ["--quiet", "--subdivision", "cdt"];
    let output = explain(&[&hidden[..], &quiet].concat());
    assert_eq!((output.status.code(), words(&output).len()), (Some(1), 0));

    // JSON on standard output sends the words to standard error.
    let output = explain(&[&seen[..], &["--json", "-"]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).expect("it is JSON");
    assert_eq!(json["format"], "enfilade.explanation");
    assert_eq!(json["visible"], true);
    assert!(String::from_utf8_lossy(&output.stderr).contains("Visible"));

    // Closed doors: no way, but there would be one.
    let output = explain(&[&seen[..], &["--doors", "closed", "--json", "-"]].concat());
    let json: Value = serde_json::from_slice(&output.stdout).expect("it is JSON");
    assert_eq!(
        (&json["visible"], &json["connected"]),
        (&false.into(), &false.into())
    );
    assert_eq!(json["doors_open"]["visible"], true);
    assert_eq!(
        json["doors_open"]["doors"][0]["rooms"],
        serde_json::json!(["A", "Corridor"])
    );

    for (name, start) in [("a.svg", &b"<svg"[..]), ("a.png", b"\x89PNG")] {
        let picture = folder.path().join(name);
        for places in [&seen, &hidden] {
            let output = explain(&[&places[..], &["-o", &picture.to_string_lossy()]].concat());
            assert_eq!(output.status.code(), Some(0));
            let bytes = fs::read(&picture).expect("it is written");
            assert!(bytes.starts_with(start), "{name}");
        }
    }
}

#[test]
fn explain_takes_points_on_borders_and_cells_by_number() {
    let (_folder, path) = file("corner.toml", CORNER.as_bytes());
    let explain = |more: &[&str]| {
        let output = enfilade(&[&["explain", &path][..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{more:?}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    // In the middle of the door.
    let words = explain(&["--from", "4,1", "--to", "1,3"]);
    assert!(words.contains("one cell"), "{words}");
    let words = explain(&["--from", "4,1", "--to", "6,11"]);
    assert!(words.contains("on its border with cell"), "{words}");
    let words = explain(&["--from-cell", "0", "--to-cell", "0"]);
    assert!(words.contains("one cell"), "{words}");
}

#[test]
fn explain_refuses_places_that_are_none() {
    let (_folder, path) = file("corner.toml", CORNER.as_bytes());
    let refuse = |more: &[&str], parts: &[&str]| {
        refused(&[&["explain", &path][..], more].concat(), parts);
    };
    refuse(&["--from", "1,1"], &["--to"]);
    refuse(&["--to", "1,1"], &["--from"]);
    refuse(
        &["--from", "1,1", "--from-cell", "1", "--to", "2,2"],
        &["--from-cell"],
    );
    refuse(&["--from", "1,1", "--to", "6,6"], &["6,6", "outside"]);
    refuse(&["--from", "1,1", "--to", "1e300,6"], &["outside"]);
    refuse(&["--from", "1,1", "--to", "x,6"], &["two numbers"]);
    refuse(
        &["--from", "1,4", "--to", "6,1"],
        &["1,4", "on a wall", "line"],
    );
    // The end of the door is on a wall too.
    refuse(&["--from", "4,1.5", "--to", "6,1"], &["on a wall"]);
    refuse(&["--from", "1,1", "--to-cell", "99"], &["no cell 99"]);
    refuse(
        &["--from", "1,1", "--to", "6,1", "-o", "a.jpg"],
        &["a.jpg", ".svg", ".png"],
    );
    refuse(
        &["--from", "1,1", "--to", "6,1", "-o", "-", "--json", "-"],
        &["standard output"],
    );
}

/// With the feature the viewer's own tests open windows.
#[cfg(not(feature = "viewer"))]
#[test]
fn view_says_in_one_line_how_to_get_the_viewer() {
    let output = enfilade(&["view", &level("tiny.toml")]);
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(said.trim_end().lines().count(), 1, "{said}");
    assert!(said.contains("--features viewer"), "{said}");
}

/// A walk from a file of its own.
#[test]
fn a_walk_may_stand_in_a_file_of_its_own() {
    let text = "[[path]]\nname = \"in\"\npoints = [[1, 1, 1.6], [3, 1, 1.6]]\nspeed = 1\n";
    let (folder, walks) = file("tiny.walks.toml", text.as_bytes());
    let out = folder.path().join("frames").display().to_string();
    let tiny = level("tiny.toml");
    let run = |path: &str, walks: &str| {
        enfilade(&[
            "walk",
            &tiny,
            "--walks",
            walks,
            "--path",
            path,
            "--size",
            "16x10",
            "--fps",
            "1",
            "--renderer",
            "preview",
            "-o",
            &out,
        ])
    };
    let good = run("in", &walks);
    assert!(
        good.status.success(),
        "{}",
        String::from_utf8_lossy(&good.stderr)
    );
    assert!(folder.path().join("frames/frame-00000.png").exists());
    for (path, walks, said) in [
        ("out", &walks[..], "`out`"),
        ("in", &tiny[..], "no file of walks"),
        ("in", "nowhere.toml", "nowhere.toml"),
    ] {
        let bad = run(path, walks);
        assert_eq!(bad.status.code(), Some(2));
        let text = String::from_utf8_lossy(&bad.stderr).into_owned();
        assert!(text.contains(said), "{text}");
    }
}
