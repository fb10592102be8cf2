//! Where methods go wrong: one pair of each, with a picture.

use glam::DVec2;
use maud::{Markup, html};

use super::Study;
use super::accuracy::Error;
use super::record::{Differences, WrongPair};
use super::sketch;
use crate::cells::{CellGraph, CellId};
use crate::level::wording::{coordinate, count, in_sector};
use crate::level::{Level, SectorId};

/// The section; it says so if no method errs.
pub(super) fn section(level: &Level, study: &Study) -> Markup {
    let differences = &study.results.differences;
    let wrong = || differences.iter().filter(|d| !d.pairs.is_empty());
    html! {
        h2 { "Where methods go wrong" }
        @if wrong().next().is_none() {
            p { "On this level every method that ran to its end, and that anything could be expected of, found exactly the right pairs." }
        } @else {
            p {
                "One pair of cells for each method that errs, chosen for being easy to see, not for being the worst: "
                span.swatch.source {} " the one cell, " span.swatch.second {} " the other, "
                span.swatch.sight {} " a line of sight."
            }
            div.pair {
                @for difference in wrong() {
                    @for error in [Error::Missed, Error::Invented] {
                        @if let Some(pair) = difference.pairs.iter().find(|p| p.error == error) {
                            (picture(level, &study.graph, difference, pair))
                        }
                    }
                }
            }
        }
    }
}

fn picture(level: &Level, graph: &CellGraph, of: &Differences, pair: &WrongPair) -> Markup {
    let cells = pair.cells.map(CellId);
    let place = |i: usize| {
        let [x, y] = pair.places[i];
        let sector = in_sector(level, pair.sectors[i].map(SectorId));
        format!(
            "{}{sector} at ({}, {})",
            pair.cells[i],
            coordinate(level, x),
            coordinate(level, y)
        )
    };
    let (first, second) = (place(0), place(1));
    let sight = pair.witness.map(|ends| ends.map(|p| to_steps(level, p)));
    let (heading, n) = match pair.error {
        Error::Missed => ("missed", of.missed),
        Error::Invented => ("invented", of.invented),
    };
    html! {
        figure {
            h4 { (of.label) ": " (count(n as usize, "pair")) " " (heading) }
            (sketch::pair(graph, cells, sight, &format!("Cells {first} and {second}")))
            figcaption {
                "Cells " (first) " and " (second)
                @match pair.error {
                    Error::Missed => " see each other along the line, which the method does not find.",
                    Error::Invented => ": no straight line leads from one to the other, but the method says that one does.",
                }
            }
        }
    }
}

fn to_steps(level: &Level, [x, y]: [f64; 2]) -> DVec2 {
    let step = |units: f64, origin: i64| level.grid.step.to_steps(units) - origin as f64;
    let [ox, oy] = level.grid.origin;
    DVec2::new(step(x, ox), step(y, oy))
}
