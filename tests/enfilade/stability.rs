//! `enfilade study stability`: the table of hard cases, which is also in the README.

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

fn stability(arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("enfilade").expect("the program is built");
    command
        .args(["study", "stability"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

/// A folder with levels of these names and texts.
fn folder(levels: &[(&str, &str)]) -> TempDir {
    let folder = TempDir::new().expect("there is room");
    for (name, text) in levels {
        fs::write(folder.path().join(name), text).expect("there is room");
    }
    folder
}

const TWO_ROOMS: &str = "\
# Two rooms with a doorway.
#
# CLAIM: 1,1 -> 3,1

[[room]]
name = \"west\"
rect = [0, 0, 2, 2]

[[room]]
name = \"east\"
rect = [2, 0, 4, 2]

[[archway]]
points = [[2, 0.5], [2, 1.5]]
";

#[test]
fn the_table_in_the_readme_is_what_the_command_prints() {
    const START: &str = "<!-- enfilade study stability levels/hard -->\n";
    const END: &str = "<!-- end of the table -->\n";
    let output = stability(&["levels/hard"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = fs::read_to_string(&path).expect("there is a README");
    let (before, rest) = readme.split_once(START).expect("the table starts there");
    let (table, after) = rest.split_once(END).expect("the table ends there");
    if std::env::var_os("ENFILADE_WRITE").is_some() {
        let new = format!("{before}{START}{printed}{END}{after}");
        fs::write(&path, new).expect("the README can be written");
        return;
    }
    for (printed, stands) in printed.lines().zip(table.lines()) {
        assert_eq!(printed, stands, "ENFILADE_WRITE=1 writes the table anew");
    }
    assert_eq!(printed, table, "ENFILADE_WRITE=1 writes the table anew");
}

#[test]
fn threads_change_nothing() {
    let [one, two] = ["1", "2"].map(|n| {
        let levels = folder(&[("a.toml", &TWO_ROOMS.replace("CLAIM", "sees"))]);
        let path = levels.path().to_string_lossy().into_owned();
        stability(&[&path, "--threads", n, "--subdivision", "cdt"]).stdout
    });
    assert_eq!(text(&one), text(&two));
    assert!(text(&one).contains("| `a` | Two rooms with a doorway | 1 |"));
}

#[test]
fn a_wrong_statement_is_an_answer_of_no_and_named() {
    let levels = folder(&[
        ("right.toml", &TWO_ROOMS.replace("CLAIM", "sees")),
        ("wrong.toml", &TWO_ROOMS.replace("CLAIM", "hidden")),
    ]);
    let path = levels.path().to_string_lossy().into_owned();
    let json = levels
        .path()
        .join("out.json")
        .to_string_lossy()
        .into_owned();
    let output = stability(&[&path, "--json", &json]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("on: wrong"),
        "{}",
        text(&output.stderr)
    );
    let table = text(&output.stdout);
    assert!(
        table.contains("**1 of 1 wrong**: shows 1,1 -> 3,1"),
        "{table}"
    );
    let json = fs::read_to_string(json).expect("it was written");
    let json: Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!(json["format"], "enfilade.stability");
    let cases = json["cases"].as_array().expect("there are cases");
    let names: Vec<_> = cases.iter().map(|case| &case["name"]).collect();
    assert_eq!(names, ["right", "wrong"]);
    assert_eq!(cases[0]["sweep"]["wrong"], Value::Array(Vec::new()));
    for method in ["sweep", "search", "lp", "flow"] {
        let wrong = &cases[1][method]["wrong"];
        assert_eq!(wrong, &serde_json::json!(["shows 1,1 -> 3,1"]), "{method}");
        assert_eq!(cases[1][method]["missed"], 0, "{method}");
        assert_eq!(cases[1][method]["invented"], 0, "{method}");
    }
}

#[test]
fn mistakes_are_named() {
    let refused = |arguments: &[&str], parts: &[&str]| {
        let output = stability(arguments);
        let errors = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert!(output.stdout.is_empty(), "{arguments:?} printed a table");
        for part in parts {
            assert!(errors.contains(part), "{part:?} is not in {errors:?}");
        }
    };
    let empty = folder(&[]);
    let path = empty.path().to_string_lossy().into_owned();
    refused(&[&path], &[&path, "no .toml levels"]);
    refused(&["no/such/folder"], &["no/such/folder", "cannot read"]);
    refused(&["levels/hard", "--json", "-"], &["only one output"]);
    let wrong = |claim: &str, parts: &[&str]| {
        let levels = folder(&[("a.toml", &TWO_ROOMS.replace("# CLAIM: 1,1 -> 3,1", claim))]);
        let path = levels.path().to_string_lossy().into_owned();
        refused(&[&path], &[&["a.toml"], parts].concat());
    };
    wrong("# sees: 1,1 -> 3", &["line 3", "two points"]);
    wrong("# sees: 1,1 -> 9,1", &["(9, 1)", "not inside"]);
    wrong("# sees: 1,1.00001 -> 3,1", &["(1, 1.00001)", "not on"]);
    wrong("# cells dcel: 4", &["line 3", "bsp, kd or cdt"]);
    wrong("[[room]]", &["missing field"]);
}
