//! Where methods go wrong: one pair of each, with a picture.

use glam::DVec2;
use maud::{Markup, html};

use super::Study;
use super::accuracy::Error;
use super::record::{Differences, WrongPair};
use super::sketch;
use crate::cells::{CellGraph, CellId};
use crate::level::wording::{coordinate, count, in_sector, length, unit};
use crate::level::{Level, SectorId};

/// The section; it says so if no method errs.
pub(super) fn section(level: &Level, study: &Study) -> Markup {
    let differences = &study.results.differences;
    let wrong = || differences.iter().filter(|d| !d.pairs.is_empty());
    html! {
        h2 { "Where methods go wrong" }
        @if wrong().next().is_none() {
            p { "On this level every method that came to its end found exactly the right pairs." }
        } @else {
            p {
                "One pair of cells for each method that errs, chosen for being easy to see and not \
                for being the worst. " span.swatch.source {} " and " span.swatch.second {}
                " are the two cells, " span.swatch.sight {} " is a line of sight, "
                span.swatch.way {} " a way on foot, and " span.swatch.stop {}
                " marks corners that stand in the way of every line along it."
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
    let place = |i: usize| {
        let [x, y] = pair.places[i];
        format!(
            "{}{} at ({}, {})",
            pair.cells[i],
            in_sector(level, pair.sectors[i].map(SectorId)),
            coordinate(level, x),
            coordinate(level, y)
        )
    };
    let (first, second) = (place(0), place(1));
    let steps = |p: &[f64; 2]| to_steps(level, *p);
    let sketch = sketch::Pair {
        cells: pair.cells.map(CellId),
        sight: pair.witness.map(|ends| ends.map(|p| steps(&p))),
        way: pair.way.iter().map(steps).collect(),
        ends: pair.ends.iter().map(steps).collect(),
    };
    let (heading, n) = match pair.error {
        Error::Missed => ("missed", of.missed),
        Error::Invented => ("invented", of.invented),
    };
    let by_walls = if pair.confirmed {
        " The level's own walls confirm it."
    } else {
        ""
    };
    html! {
        figure {
            h4 { span class=(format!("dot k-{}", of.method)) {} (of.label) ": " (count(n as usize, "pair")) " " (heading) }
            (sketch::pair(graph, &sketch, &format!("Cells {first} and {second}")))
            figcaption {
                "Cells " (first) " and " (second)
                @match (pair.error, pair.width) {
                    (Error::Missed, Some(width)) => {
                        " see each other along the line, through a view "
                        (length(width)) " " (unit(level)) " wide, and " (of.method) " does not find it."
                    }
                    (Error::Missed, None) => { " see each other, and " (of.method) " does not find it." }
                    (Error::Invented, _) => {
                        " do not see each other: no straight line leads from the one to the other, \
                        but " (of.method) " says that one does."
                    }
                }
                (by_walls)
            }
        }
    }
}

fn to_steps(level: &Level, [x, y]: [f64; 2]) -> DVec2 {
    let step = |units: f64, origin: i64| level.grid.step.to_steps(units) - origin as f64;
    let [ox, oy] = level.grid.origin;
    DVec2::new(step(x, ox), step(y, oy))
}
