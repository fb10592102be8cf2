//! `levels/hard`: small levels that are hard to get right, each with the answer worked out by hand.
//!
//! The first comment says what a level shows, the next ones why the answer is what it is, and lines
//! like these state it:
//!
//! | line | meaning |
//! |---|---|
//! | `# sees: 1,2 -> 3,4` | every cell at the one point sees every cell at the other |
//! | `# sees: everything` | every cell sees every cell |
//! | `# hidden: 1,2 -> 3,4` | no cell at the one point sees any cell at the other |
//! | `# cells bsp: 4` | the BSP has that many cells |
//! | `# snap: 0.0003` | the farthest that a point was moved onto the grid |
//! | `# finding: snapped` | the reader reports that |
//! | `# refused: too large` | the reader refuses the level, in these words |

use std::fs;
use std::path::Path;

use enfilade::cells::{Doors, Locator, Subdivision};
use enfilade::level::{Level, toml};
use glam::DVec2;

use crate::compare::{Solved, same_area, solve};
use crate::plan::{Ink, Stroke, level, rectangle};

struct Hard {
    name: String,
    text: String,
    /// Keys and values of the lines that state the answer.
    answers: Vec<(String, String)>,
}

fn hard_levels() -> Vec<Hard> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/hard");
    let mut list: Vec<Hard> = fs::read_dir(folder)
        .expect("levels/hard is there")
        .map(|entry| {
            let path = entry.expect("levels/hard is readable").path();
            let text = fs::read_to_string(&path).expect("a level is text");
            let comments = text.lines().map_while(|line| line.strip_prefix('#'));
            let known = [
                "sees",
                "hidden",
                "cells bsp",
                "cells kd",
                "cells cdt",
                "snap",
                "finding",
                "refused",
            ];
            let answers = comments
                .filter_map(|line| line.trim().split_once(": "))
                .filter(|(key, _)| known.contains(key))
                .map(|(key, value)| (key.to_string(), value.to_string()))
                .collect();
            let name = path
                .file_name()
                .expect("it has one")
                .to_string_lossy()
                .into_owned();
            Hard {
                name,
                text,
                answers,
            }
        })
        .collect();
    list.sort_by(|a, b| a.name.cmp(&b.name));
    list
}

/// A point of the level, which must lie on its grid.
fn point(level: &Level, text: &str) -> Result<enfilade::geom::GridPoint, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .filter_map(|n| n.trim().parse().ok())
        .collect();
    let &[x, y] = &numbers[..] else {
        return Err(format!("`{text}` is no point"));
    };
    let p = DVec2::new(x, y);
    let on_grid = level
        .grid
        .nearest(p)
        .filter(|&q| level.grid.to_level(q) == p);
    on_grid.ok_or(format!("({text}) is not on the grid"))
}

fn check_pair(level: &Level, solved: &Solved, line: &str, wanted: bool) -> Result<(), String> {
    let locator = Locator::new(&solved.graph);
    let ends = line
        .split_once(" -> ")
        .ok_or(format!("`{line}` has no arrow"))?;
    let at = |text| {
        let cells = locator.cells_at(&solved.graph, &point(level, text)?.into());
        if cells.is_empty() {
            Err(format!("({text}) is outside"))
        } else {
            Ok(cells)
        }
    };
    let (from, to) = (at(ends.0)?, at(ends.1)?);
    for &a in &from {
        if let Some(b) = to.iter().find(|b| solved.pvs.sees(a, **b) != wanted) {
            let (a, b) = (
                crate::compare::show(&solved.graph, a),
                crate::compare::show(&solved.graph, *b),
            );
            return Err(format!("{line}: sees = {} for cells {a} and {b}", !wanted));
        }
    }
    Ok(())
}

fn check(hard: &Hard) -> Result<(), String> {
    let of = |key: &str| -> Vec<&str> {
        let answers = hard.answers.iter().filter(|(k, _)| k == key);
        answers.map(|(_, value)| value.as_str()).collect()
    };
    let level = match (toml::read(&hard.text, &hard.name), of("refused")) {
        (Err(error), parts) => {
            let message = error.to_string();
            let missing = parts.iter().find(|part| !message.contains(**part));
            return match missing {
                _ if parts.is_empty() => Err(format!("refused: {message}")),
                Some(part) => Err(format!("`{part}` is not in: {message}")),
                None => Ok(()),
            };
        }
        (Ok(_), parts) if !parts.is_empty() => return Err("was not refused".into()),
        (Ok(level), _) => level,
    };
    for snap in of("snap") {
        let wanted: f64 = snap.parse().map_err(|_| format!("`{snap}` is no number"))?;
        if (level.snap - wanted).abs() > 1e-6 * wanted {
            return Err(format!("snapped by {}, not {wanted}", level.snap));
        }
    }
    for code in of("finding") {
        if !level.findings.iter().any(|f| f.code == code) {
            return Err(format!("no finding `{code}` among {:?}", level.findings));
        }
    }
    let mut graphs = Vec::new();
    for subdivision in Subdivision::ALL {
        let name = subdivision.as_str();
        let in_it = |error: String| format!("{name}: {error}");
        let (solved, searched) = solve(&level, subdivision, Doors::Open, Some(20_000_000))?;
        if !searched {
            return Err(in_it("search needs too many steps".into()));
        }
        for count in of(&format!("cells {name}")) {
            if count != solved.graph.cells.len().to_string() {
                return Err(in_it(format!(
                    "{} cells, not {count}",
                    solved.graph.cells.len()
                )));
            }
        }
        for line in of("sees") {
            if line == "everything" {
                let n = solved.graph.cells.len() as u64;
                if solved.pvs.pairs() != n * n {
                    return Err(in_it(format!("{} pairs of {n} cells", solved.pvs.pairs())));
                }
            } else {
                check_pair(&level, &solved, line, true).map_err(in_it)?;
            }
        }
        for line in of("hidden") {
            check_pair(&level, &solved, line, false).map_err(in_it)?;
        }
        graphs.push(solved.graph);
    }
    same_area(&graphs.iter().collect::<Vec<_>>())
}

#[test]
fn hard_levels_have_the_answers_worked_out_by_hand() {
    let list = hard_levels();
    assert!(list.len() >= 20, "only {} levels", list.len());
    let mut wrong = Vec::new();
    for hard in &list {
        assert!(!hard.answers.is_empty(), "{} states no answer", hard.name);
        if let Err(error) = check(hard) {
            wrong.push(format!("{}: {error}", hard.name));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    let n: usize = list.iter().map(|hard| hard.answers.len()).sum();
    println!(
        "{} hard levels, {n} answers, three subdivisions, two methods",
        list.len()
    );
}

/// TOML refuses walls without length; where a format allows them (Doom), they are dropped.
#[test]
fn zero_length_walls_are_dropped_and_reported() {
    let mut strokes = rectangle([0, 0], [8, 4], Ink::Solid);
    let n = strokes.len();
    strokes.insert(2, Stroke([3, 3], [3, 3], Ink::Solid));
    strokes.push(Stroke([8, 4], [8, 4], Ink::Solid));
    let level = level(&strokes);
    assert_eq!(level.walls.len(), n);
    let finding = level
        .findings
        .iter()
        .find(|f| f.code == "zero-length-wall")
        .expect("reported");
    assert_eq!(finding.places.len(), 2);
    let (solved, _) = solve(&level, Subdivision::Bsp, Doors::Open, None).unwrap();
    assert_eq!(solved.graph.cells.len(), 1);
}
