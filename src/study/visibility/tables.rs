//! The tables of the page.

use maud::{Markup, html};

use super::accuracy::Accuracy;
use super::record::{Answer, Heights, Results, Run, Spread, State};
use crate::level::wording::{duration, grouped};
use crate::study::chart::percent;

/// A median, and beneath it the shortest and longest time.
fn time(spread: Option<Spread>) -> Markup {
    html! {
        @match spread {
            None => "–",
            Some(s) => {
                (duration(s.median))
                small {
                    @if s.runs > 1 { (range(s)) ", " (s.runs) "\u{202f}×" }
                    @else { "once" }
                }
            }
        }
    }
}

/// The shortest and the longest time; the unit once, if it is the same.
fn range(spread: Spread) -> String {
    let (min, max) = (duration(spread.min), duration(spread.max));
    match (min.split_once(' '), max.split_once(' ')) {
        (Some((least, a)), Some((_, b))) if a == b => format!("{least}–{max}"),
        _ => format!("{min}–{max}"),
    }
}

/// The heap that a run needed: `640 B`, `12.3 kB`, `4.56 MB`.
fn size(run: &Run) -> String {
    let Some(bytes) = run.bytes else {
        let text = if run.seconds.is_some() {
            "not measured"
        } else {
            "–"
        };
        return text.to_string();
    };
    let b = bytes as f64;
    match b {
        b if b < 999.5 => format!("{b:.0} B"),
        b if b < 9995.0 => format!("{:.2} kB", b / 1e3),
        b if b < 99_950.0 => format!("{:.1} kB", b / 1e3),
        b if b < 999_500.0 => format!("{:.0} kB", b / 1e3),
        b if b < 9.995e6 => format!("{:.2} MB", b / 1e6),
        b if b < 99.95e6 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.0} MB", b / 1e6),
    }
}

/// The run's name, with how it ended unless it came to its end.
fn name(run: &Run) -> Markup {
    let state = match run.state {
        State::Complete => None,
        State::CutShort => Some("cut short"),
        State::GaveUp => Some("stopped, no answer"),
        State::LeftOut => Some("left out"),
    };
    html! {
        th scope="row" {
            span class=(format!("dot k-{}", run.method)) {} (run.label)
            @if let Some(state) = state { small { (state) } }
        }
    }
}

/// What follows the name in every table of runs: a figure of the answer, or a dash.
fn cell(key: &str, answer: Option<&Answer>, text: impl Fn(&Answer) -> String) -> Markup {
    html! { td data-key=(key) { @match answer { Some(a) => (text(a)), None => "–" } } }
}

/// Says that a figure would have become smaller, had there been more time.
fn at_most(run: &Run) -> &'static str {
    if run.state == State::CutShort {
        "≤\u{202f}"
    } else {
        ""
    }
}

/// How many pairs a run gets wrong in one way.
fn wrong(key: &str, run: Option<&Run>, count: fn(&Accuracy) -> u64) -> Markup {
    let answer = run.and_then(|r| Some((r, r.answer.as_ref()?)));
    html! {
        td data-key=(key) {
            @match answer.map(|(run, a)| (run, count(&a.accuracy))) {
                None => "–",
                Some((_, 0)) => span.good { "0" },
                // What is open still may turn out to be hidden, or visible indeed.
                Some((run, n)) => {
                    @if key != "missed" { (at_most(run)) }
                    (grouped(n))
                }
            }
        }
    }
}

/// All methods.
pub(super) fn of_methods(results: &Results) -> Markup {
    html! {
        div.scroll {
            table #methods {
                thead {
                    tr {
                        th { "Method" } th.left { "Class" } th { "Time" } th { "Relative" }
                        th { "Visible pairs" } th { "Over\u{00ad}estimate" } th { "Under\u{00ad}estimate" }
                        th { "Pairs invented" } th { "Pairs missed" } th { "Un\u{00ad}decided" } th { "Memory" }
                    }
                }
                tbody { @for run in &results.methods { (method(run)) } }
            }
        }
    }
}

fn method(run: &Run) -> Markup {
    let answer = run.answer.as_ref();
    html! {
        tr data-run=(run.label) {
            (name(run))
            td.left { (run.class) }
            td data-key="median" { (time(run.seconds)) }
            td data-key="relative" {
                @match run.relative {
                    Some(r) if run.state == State::Complete => { "×\u{202f}" (factor(r)) }
                    Some(r) if answer.is_some() => { ">\u{202f}×\u{202f}" (factor(r)) }
                    _ => "–",
                }
            }
            (cell("pairs", answer, |a| grouped(a.pairs)))
            (cell("overestimate", answer, |a| format!("{}{}", at_most(run), percent(a.accuracy.overestimate))))
            (cell("underestimate", answer, |a| percent(a.accuracy.underestimate)))
            (wrong("invented", Some(run), |a| a.invented))
            (wrong("missed", Some(run), |a| a.missed))
            (cell("undecided", answer, |a| percent(a.undecided_share)))
            td data-key="bytes" { (size(run)) }
        }
    }
}

/// A ratio with about two digits.
fn factor(ratio: f64) -> String {
    match ratio {
        r if r >= 99.5 => grouped(r.round() as u64),
        r if r >= 9.95 => format!("{r:.0}"),
        r if r >= 0.995 => format!("{r:.1}"),
        r if r >= 0.0995 => format!("{r:.2}"),
        r => format!("{r:.1e}").replace("e-", "·10⁻").replace("⁻1", "⁻¹"),
    }
}

/// The subdivisions, with the other methods on each.
pub(super) fn of_subdivisions(results: &Results) -> Markup {
    html! {
        div.scroll {
            table #subdivisions {
                thead {
                    tr {
                        th { "Cells by" } th { "Cells" } th { "Portals" } th { "Visible pairs" } th { "Density" }
                        th { "Floor seen" } th { "Cutting" } th { "Sweep" } th { "Search" }
                        th { "Flow: wrong pairs" } th { "Flood: over\u{00ad}estimate" }
                    }
                }
                tbody {
                    @for s in &results.subdivisions {
                        @let run = |name: &str| s.methods.iter().find(|r| r.method == name);
                        @let answer = |name: &str| run(name).and_then(|r| r.answer.as_ref());
                        tr data-run=(s.subdivision) {
                            th scope="row" { span class=(format!("dot k-{}", s.subdivision)) {} (s.subdivision) }
                            td data-key="cells" { (grouped(s.cells as u64)) }
                            td data-key="portals" { (grouped(s.portals as u64)) }
                            td data-key="pairs" { (grouped(s.pairs)) }
                            td { (percent(s.density)) }
                            td data-key="floor" { (percent(s.floor)) }
                            td { (time(Some(s.subdivide))) }
                            td { (time(Some(s.sweep))) }
                            td {
                                @match run("search") {
                                    Some(r) if r.state == State::Complete => (time(r.seconds)),
                                    Some(r) if r.state == State::GaveUp => "too long",
                                    _ => "–",
                                }
                            }
                            (wrong("flow", run("flow"), |a| a.invented + a.missed))
                            (cell("flood", answer("flood"), |a| percent(a.accuracy.overestimate)))
                        }
                    }
                }
            }
        }
    }
}

/// The answers with heights.
pub(super) fn of_heights(heights: &Heights) -> Markup {
    html! {
        div.scroll {
            table #heights {
                thead {
                    tr {
                        th { "Splits allowed" } th { "Time" } th { "Visible pairs" } th { "Undecided" }
                        th { "Too much, of the tightest" } th { "Memory" }
                    }
                }
                tbody {
                    tr data-run="walls only" {
                        th scope="row" { span.dot.k-sweep {} "walls only" }
                        td { "–" }
                        td data-key="pairs" { (grouped(heights.planar.pairs)) }
                        td { "–" }
                        td data-key="overestimate" { (percent(heights.planar.accuracy.overestimate)) }
                        td { "–" }
                    }
                    @for run in &heights.runs {
                        @let answer = run.answer.as_ref();
                        tr data-run=(run.label) {
                            (name(run))
                            td data-key="median" { (time(run.seconds)) }
                            (cell("pairs", answer, |a| grouped(a.pairs)))
                            (cell("undecided", answer, |a| percent(a.undecided_share)))
                            (cell("overestimate", answer, |a| percent(a.accuracy.overestimate)))
                            td data-key="bytes" { (size(run)) }
                        }
                    }
                }
            }
        }
    }
}
