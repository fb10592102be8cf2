//! The source keeps the order that `lib.rs` describes.

use std::fs;
use std::path::{Path, PathBuf};

/// The modules, lowest first: each may import those before it.
const ORDER: [&str; 12] = [
    "geom", "level", "cells", "sight", "pvs", "trace", "preview", "walk", "report", "study",
    "viewer", "cli",
];

/// Where results go to people: side by side, none imports another.
const SIDE_BY_SIDE: [&str; 3] = ["report", "study", "viewer"];

/// The exact part: no sign there depends on a tolerance.
const EXACT: [&str; 4] = ["geom", "cells", "sight", "pvs"];

/// Lines of the exact part that name a tolerance after all: part of the file's path, part of the
/// line, and why.
const ALLOWED: [(&str, &str, &str); 7] = [
    (
        "geom/mod.rs",
        "compares a floating-point number with a tolerance",
        "says that there is none",
    ),
    (
        "cells/mod.rs",
        "no step compares with a tolerance",
        "says that there is none",
    ),
    (
        "cells/validate.rs",
        "to a relative 1e-9",
        "an area in f64, a check of the result",
    ),
    (
        "cells/validate.rs",
        "1e-9 * scale",
        "an area in f64, a check of the result",
    ),
    (
        "pvs/flow.rs",
        "so its epsilon is part of it",
        "the peer's behaviour, epsilon included",
    ),
    (
        "pvs/flow.rs",
        "sights thinner than the epsilon",
        "what it costs",
    ),
    (
        "pvs/flow/clip.rs",
        "the tools' epsilon",
        "the peer's behaviour, epsilon included",
    ),
];

struct Source {
    /// Path from `src/`, with forward slashes.
    path: String,
    text: String,
}

impl Source {
    /// The top module that the file belongs to.
    fn module(&self) -> &str {
        let first = self.path.split('/').next().unwrap_or_default();
        first.strip_suffix(".rs").unwrap_or(first)
    }

    /// The lines before the in-file tests.
    fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        (1..)
            .zip(self.text.lines())
            .take_while(|(_, line)| line.trim() != "#[cfg(test)]")
    }

    fn is_test(&self) -> bool {
        self.path.contains("/tests/") || self.path.ends_with("/tests.rs")
    }
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut list = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("src is readable") {
            let path: PathBuf = entry.expect("src is readable").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).expect("source is text");
                let path = path.strip_prefix(&root).expect("below src");
                list.push(Source {
                    path: path.to_string_lossy().replace('\\', "/"),
                    text,
                });
            }
        }
    }
    list.sort_by(|a, b| a.path.cmp(&b.path));
    assert!(list.len() > 30, "only {} files found", list.len());
    list
}

/// The top modules that a line of code names after `crate::`.
fn imported(line: &str) -> Vec<&str> {
    let code = line.split("//").next().unwrap_or_default();
    code.match_indices("crate::")
        .map(|(at, name)| {
            let rest = &code[at + name.len()..];
            rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
                .next()
                .unwrap_or_default()
        })
        .collect()
}

#[test]
fn a_module_imports_only_modules_before_it() {
    let rank = |module: &str| ORDER.iter().position(|m| *m == module);
    let mut wrong = Vec::new();
    let mut checked = 0;
    for source in sources() {
        let Some(own) = rank(source.module()) else {
            let free = source.path == "lib.rs"
                || source.path == "main.rs"
                || source.path.starts_with("bin/");
            assert!(
                free,
                "{} belongs to no known module; add it to ORDER",
                source.path
            );
            continue;
        };
        for (number, line) in (1..).zip(source.text.lines()) {
            for module in imported(line) {
                let place = format!("{}:{number}: {}", source.path, line.trim());
                let Some(other) = rank(module) else {
                    wrong.push(format!("{place} (which module is that?)"));
                    continue;
                };
                checked += 1;
                let beside = own != other
                    && SIDE_BY_SIDE.contains(&ORDER[own])
                    && SIDE_BY_SIDE.contains(&module);
                if other > own || beside {
                    wrong.push(place);
                }
            }
        }
    }
    assert!(checked > 30, "only {checked} imports found");
    assert!(
        wrong.is_empty(),
        "imports against the order {ORDER:?}:\n{}",
        wrong.join("\n")
    );
}

/// Whether a line names a tolerance: by a word, or as a small number like 1e-9.
fn names_tolerance(line: &str) -> bool {
    let line = line.to_lowercase();
    let small = line.match_indices("e-").any(|(at, _)| {
        line[..at].ends_with(|c: char| c.is_ascii_digit())
            && line[at + 2..].starts_with(|c: char| c.is_ascii_digit())
    });
    small
        || ["epsilon", "tolerance"]
            .iter()
            .any(|word| line.contains(word))
}

#[test]
fn the_exact_part_knows_no_tolerance() {
    assert!(names_tolerance("if x < 1e-9 {") && names_tolerance("f64::EPSILON"));
    assert!(!names_tolerance("one-sided e-mail 10^-4"));
    let mut wrong = Vec::new();
    for source in sources() {
        if !EXACT.contains(&source.module()) || source.is_test() {
            continue;
        }
        for (number, line) in source.lines().filter(|(_, line)| names_tolerance(line)) {
            let allowed = |(path, part, _): &(&str, &str, &str)| {
                source.path.contains(path) && line.contains(part)
            };
            if !ALLOWED.iter().any(allowed) {
                wrong.push(format!("{}:{number}: {}", source.path, line.trim()));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "tolerances in the exact part:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn files_are_named_for_what_they_hold_and_stay_short() {
    const LONGEST: usize = 600;
    let mut wrong = Vec::new();
    for source in sources() {
        for name in source.path.trim_end_matches(".rs").split('/') {
            let vague = [
                "util", "utils", "common", "helper", "helpers", "manager", "misc",
            ];
            if vague.contains(&name) {
                wrong.push(format!("{}: `{name}` says nothing", source.path));
            }
        }
        let lines = source.lines().count();
        if lines > LONGEST && !source.is_test() {
            wrong.push(format!("{}: {lines} lines without tests", source.path));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
