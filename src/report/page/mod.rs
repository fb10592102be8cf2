//! A report as one page that needs nothing else: HTML with its style, its script and its data inside.
//!
//! In: [`Costs`], with what else the command found out. Out: the page. Its tables and its plan are there
//! without the script, for print; the script ([`page.js`](https://developer.mozilla.org/docs/Web/SVG))
//! lets one choose places on the plan, and computes nothing but what it draws: who sees whom stands in
//! the page's data (`data.rs`).

mod data;
mod plan;
mod sections;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::costs::Costs;
use super::costs::baseline::Comparison;
use super::costs::budget::Check;
use super::json::Seconds;

const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("page.js");

/// What a page shows.
pub struct Report<'a> {
    /// The figures.
    pub costs: &'a Costs<'a>,
    /// What `build` took.
    pub seconds: &'a Seconds,
    /// Limits and whether they are kept.
    pub budget: &'a [Check],
    /// What changed.
    pub comparison: Option<&'a Comparison>,
    /// Pictures from the dearest places, PNG; fewer where there are none.
    pub thumbnails: Vec<Option<Vec<u8>>>,
    /// Walks, and what they reveal.
    pub reveals: Vec<Reveal>,
}

/// What is seen for the first time along a walk.
pub struct Reveal {
    /// The walk's name.
    pub name: String,
    /// Its line on the plan, in the level's own coordinates.
    pub line: Vec<[f64; 2]>,
    /// The moments at which much comes into sight, in order.
    pub moments: Vec<Moment>,
}

/// A moment of a walk.
pub struct Moment {
    /// Seconds from the start.
    pub seconds: f64,
    /// Length of the way up to here.
    pub distance: f64,
    /// The eye on the plan.
    pub point: [f64; 2],
    /// The eye's cell.
    pub cell: u32,
    /// Rooms of which something is seen for the first time.
    pub rooms: Vec<String>,
    /// Area that is seen for the first time, and the whole that has been seen by now.
    pub area: [f64; 2],
    /// What the eye sees, as PNG.
    pub picture: Option<Vec<u8>>,
}

/// The whole HTML document.
pub fn page(report: &Report) -> String {
    let costs = report.costs;
    let title = format!("{}: what places cost", costs.level.name);
    let sheet = plan::Sheet::of(costs.graph);
    let body: Markup = html! {
        header {
            p.kicker { "enfilade report · " (costs.level.source) }
            h1 { (costs.level.name) ": what each place costs, and why" }
            (sections::lede(report))
            (sections::contents(report))
        }
        (sections::budget(report))
        (sections::overview(report))
        (plan::section(report, &sheet))
        (sections::changes(report))
        (sections::worst(report))
        (sections::openings(report))
        (sections::sightlines(report))
        (sections::reveals(report))
        (sections::rooms(report))
        (sections::findings(report))
        (sections::method(report))
    };
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                // An empty picture, so that no browser asks for one.
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                main { (body) }
                script type="application/json" id="facts" { (PreEscaped(data::facts(report, &sheet))) }
                script type="text/plain" id="data" { (PreEscaped(data::packed(report))) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    }
    .into_string()
}
