//! The comparison as a Markdown table, and as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use super::statement::Wrong;
use super::{Answer, Answered, Given, METHODS, Outcome, Row, StabilityOptions};
use crate::level::wording::grouped;
use crate::pvs::{Class, Method};

/// How to read the table.
const LEGEND: &str = "\
Each case is a level whose comment derives the answer by hand. *exact* are `sweep` and `search`, \
which must agree; *lp* is the linear programme and *flow* the Quake tools' portal flow with their \
customary epsilon of a tenth of a map unit (3 mm), both in floating point. `ok`: right on all \
statements and on all pairs of cells. Otherwise a cell tells how many of the statements about sight are answered \
wrongly, with the first of them, and how many ordered pairs of cells are missed (they see each other, but the \
method says no) or invented (the other way round), where so many see each other as *visible pairs* says. \
The linear programme is not asked where it would take long";

/// The table, a sentence above it that says how to read it, and the totals as its last line.
pub fn markdown(rows: &[Row], options: &StabilityOptions) -> String {
    let limit = grouped(options.lp_steps);
    let mut out = format!("{LEGEND}: over more than {limit} chains of portals.\n\n");
    out += "| case | what it shows | statements | visible pairs | exact | lp | flow |\n";
    out += "|---|---|---:|---:|---|---|---|\n";
    for row in rows {
        let (name, shows) = (&row.name, row.shows.trim_end_matches('.'));
        let statements = row.about_sight + row.others;
        let cells = match &row.outcome {
            Outcome::Refused { wrong, .. } if wrong.is_empty() => {
                "– | refused, as it should be | – | –".to_string()
            }
            Outcome::Refused { wrong, .. } => {
                format!("– | {} | – | –", of_wrong(wrong, statements))
            }
            Outcome::Answered(answered) => {
                let [lp, flow] =
                    [Method::Lp, Method::Flow].map(|m| of_answer(answered, m, row.about_sight));
                let pairs = grouped(answered.pairs);
                let exact = exact(answered, row);
                format!("{pairs} | {exact} | {lp} | {flow}")
            }
        };
        _ = writeln!(out, "| `{name}` | {shows} | {statements} | {cells} |");
    }
    out += &totals(rows);
    out
}

/// The last line.
fn totals(rows: &[Row]) -> String {
    let answered = || {
        rows.iter().filter_map(|row| match &row.outcome {
            Outcome::Answered(answered) => Some((row, answered)),
            Outcome::Refused { .. } => None,
        })
    };
    let statements: usize = rows.iter().map(|row| row.about_sight + row.others).sum();
    let refused = rows.len() - answered().count();
    let pairs: u64 = answered().map(|(_, a)| a.pairs).sum();
    let right = answered().filter(|(_, a)| a.exact_is_right()).count();
    let exact = match answered().count() - right {
        0 => "all right".to_string(),
        n => format!("**{n} wrong**"),
    };
    let of = |method: Method| {
        let answers = answered().map(|(_, a)| &a.methods[index(method)]);
        let mut sum = Given::default();
        let (mut wrong, mut statements, mut open) = (0, 0, 0);
        for answer in answers {
            match answer {
                Answer::GaveUp | Answer::NotAsked => open += 1,
                Answer::Given(given) => {
                    wrong += usize::from(!given.is_right());
                    statements += given.wrong.len();
                    sum.missed += given.missed;
                    sum.invented += given.invented;
                    sum.undecided += given.undecided;
                }
            }
        }
        let mut parts = vec![format!("**{wrong} wrong**: {statements} statements")];
        parts.extend(of_pairs(&sum));
        if open > 0 {
            parts.push(format!("{open} not asked"));
        }
        parts.join(", ")
    };
    format!(
        "| **{} cases** | {refused} refused, {} answered | {statements} | {} | {exact} | {} | {} |\n",
        rows.len(),
        answered().count(),
        grouped(pairs),
        of(Method::Lp),
        of(Method::Flow),
    )
}

/// Both exact methods in one cell, with what is wrong about the level.
fn exact(answered: &Answered, row: &Row) -> String {
    if answered.exact_is_right() {
        return "ok".to_string();
    }
    let mut parts = Vec::new();
    if !answered.wrong.is_empty() {
        parts.push(of_wrong(&answered.wrong, row.others));
    }
    for method in METHODS.into_iter().filter(|m| m.class() == Class::Exact) {
        match of_answer(answered, method, row.about_sight).as_str() {
            "ok" => {}
            other => parts.push(format!("{}: {other}", method.as_str())),
        }
    }
    parts.join("; ")
}

fn index(method: Method) -> usize {
    let found = METHODS.iter().position(|m| *m == method);
    found.expect("the method is one of those compared")
}

fn of_answer(answered: &Answered, method: Method, statements: usize) -> String {
    match &answered.methods[index(method)] {
        Answer::GaveUp => "gave up".to_string(),
        Answer::NotAsked => "not asked".to_string(),
        Answer::Given(given) if given.is_right() => "ok".to_string(),
        Answer::Given(given) => {
            let mut parts = Vec::new();
            if !given.wrong.is_empty() {
                parts.push(of_wrong(&given.wrong, statements));
            }
            parts.extend(of_pairs(given));
            parts.join("; ")
        }
    }
}

/// `2 of 5 wrong: hides 1,2 -> 3,4, …`
fn of_wrong(wrong: &[Wrong], statements: usize) -> String {
    let more = if wrong.len() > 1 { ", …" } else { "" };
    format!(
        "**{} of {statements} wrong**: {}{more}",
        wrong.len(),
        wrong[0].instead
    )
}

/// `misses 12`, `invents 3, 2 of them left open`
fn of_pairs(given: &Given) -> Vec<String> {
    let mut parts = Vec::new();
    if given.missed > 0 {
        parts.push(format!("misses {}", grouped(given.missed)));
    }
    if given.invented > 0 {
        let open = match given.undecided {
            0 => String::new(),
            n => format!(", {} left open", grouped(n)),
        };
        parts.push(format!("invents {}{open}", grouped(given.invented)));
    }
    parts
}

/// Everything that the table says, for programs.
pub fn json(rows: &[Row], options: &StabilityOptions) -> Value {
    let cases = rows.iter().map(|row| {
        let mut case = json!({
            "name": row.name,
            "shows": row.shows,
            "statements": row.about_sight + row.others,
        });
        let more = match &row.outcome {
            Outcome::Refused { message, wrong } => {
                json!({ "refused": message, "wrong": list(wrong) })
            }
            Outcome::Answered(answered) => {
                let mut more = json!({
                    "cells": answered.cells,
                    "pairs": answered.pairs,
                    "wrong": list(&answered.wrong),
                });
                for (method, answer) in METHODS.iter().zip(&answered.methods) {
                    more[method.as_str()] = match answer {
                        Answer::GaveUp | Answer::NotAsked => Value::Null,
                        Answer::Given(given) => json!({
                            "wrong": list(&given.wrong),
                            "missed": given.missed,
                            "invented": given.invented,
                            "undecided": given.undecided,
                        }),
                    };
                }
                more
            }
        };
        if let (Value::Object(case), Value::Object(more)) = (&mut case, more) {
            case.extend(more);
        }
        case
    });
    json!({
        "format": "enfilade.stability",
        "version": 1,
        "subdivision": options.subdivision.as_str(),
        "max_steps": options.max_steps,
        "lp_steps": options.lp_steps,
        "cases": cases.collect::<Vec<_>>(),
    })
}

fn list(wrong: &[Wrong]) -> Vec<&str> {
    wrong.iter().map(|w| w.instead.as_str()).collect()
}
