//! `levels/hard`: small levels that are hard to get right, each with the answer worked out by hand.
//!
//! What the lines of their comments mean is told in [`enfilade::study::stability::statement`].

use std::fs;
use std::path::Path;

use enfilade::cells::{Doors, Subdivision};
use enfilade::level::Level;
use enfilade::study::stability::statement::{Case, Reading, Wrong};

use crate::compare::{Solved, same_area, solve};
use crate::plan::{Ink, Stroke, level, rectangle};

/// Where search gives up: no hard level may need more.
const MOST_STEPS: u64 = 20_000_000;

fn hard_levels() -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/hard");
    let mut list: Vec<Case> = fs::read_dir(folder)
        .expect("levels/hard is there")
        .map(|entry| entry.expect("levels/hard is readable").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .map(|path| {
            let text = fs::read_to_string(&path).expect("a level is text");
            let name = path.file_stem().expect("it has one").to_string_lossy();
            Case::parse(&name, &text).unwrap_or_else(|error| panic!("{name}: {error}"))
        })
        .collect();
    list.sort_by(|a, b| a.name.cmp(&b.name));
    list
}

/// A level in all three subdivisions, by both exact methods.
fn solve_all(level: &Level) -> Result<Vec<Solved>, String> {
    let mut all = Vec::new();
    for subdivision in Subdivision::ALL {
        let (solved, searched) = solve(level, subdivision, Doors::Open, Some(MOST_STEPS))?;
        if !searched {
            let name = subdivision.as_str();
            return Err(format!("{name}: search needs more than {MOST_STEPS} steps"));
        }
        all.push(solved);
    }
    same_area(&all.iter().map(|s| &s.graph).collect::<Vec<_>>())?;
    Ok(all)
}

fn check(case: &Case) -> Result<(), String> {
    let right = |wrong: Vec<Wrong>| match wrong.first() {
        None => Ok(()),
        Some(wrong) => Err(format!(
            "{}: {}",
            case.statements[wrong.statement].text, wrong.instead
        )),
    };
    let level = match case.read().map_err(|error| error.to_string())? {
        Reading::Refused { wrong, .. } => return right(wrong),
        Reading::Level(level) => level,
    };
    right(case.wrong_of_level(&level))?;
    for Solved { graph, pvs } in solve_all(&level)? {
        let in_it = |error| format!("{}: {error}", graph.options.subdivision.as_str());
        right(case.wrong_of_cells(&graph)).map_err(in_it)?;
        let places = case.places(&level, &graph);
        let places = places.map_err(|error| in_it(error.to_string()))?;
        right(places.wrong(&pvs)).map_err(in_it)?;
    }
    Ok(())
}

#[test]
fn hard_levels_have_the_answers_worked_out_by_hand() {
    let list = hard_levels();
    assert!(list.len() >= 45, "only {} levels", list.len());
    let mut wrong = Vec::new();
    for case in &list {
        let (name, shows) = (&case.name, &case.shows);
        // What single eyes see is checked in `eye`.
        let of_eyes = name.starts_with("eye-");
        assert!(
            of_eyes || !case.statements.is_empty(),
            "{name} states no answer"
        );
        assert!(shows.ends_with('.'), "{name}: what does it show? `{shows}`");
        if let Err(error) = check(case) {
            wrong.push(format!("{name}: {error}"));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    let n: usize = list.iter().map(|case| case.statements.len()).sum();
    println!(
        "{} hard levels, {n} statements, three subdivisions, two methods",
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
