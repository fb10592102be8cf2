//! The charts of the page: from the figures to points and bars.

use maud::{Markup, html};

use super::advice::samples;
use super::record::{Answer, Heights, Results, Run, State, Subdivided};
use crate::level::wording::{duration, grouped};
use crate::study::chart::{Bar, Chart, Guide, Point, Series, bars, draw, percent};

/// A run as a point: its time and one of its errors.
fn point(run: &Run, label: String, error: f64) -> Option<Point> {
    let seconds = run.seconds?;
    let about = format!(
        "{}: {} in {}",
        run.label,
        percent(error),
        duration(seconds.median)
    );
    Some(Point {
        label,
        about,
        seconds: seconds.median,
        spread: [seconds.min, seconds.max],
        error,
    })
}

/// Points that are joined by a line. Where all lie on one height, their names would cover each other:
/// the first and the last will do.
fn joined(key: &'static str, points: impl Iterator<Item = Point>) -> Series {
    let mut points: Vec<Point> = points.collect();
    let n = points.len();
    if points.iter().all(|p| p.error == points[0].error) {
        let between = points.iter_mut().take(n.saturating_sub(1)).skip(1);
        between.for_each(|p| p.label.clear());
    }
    Series {
        key,
        joined: true,
        points,
    }
}

/// A chart under its heading.
fn figure(heading: &str, chart: &Chart) -> Markup {
    html! {
        figure {
            h4 { (heading) }
            (draw(chart))
        }
    }
}

fn over(answer: &Answer) -> f64 {
    answer.accuracy.overestimate
}

fn under(answer: &Answer) -> f64 {
    answer.accuracy.underestimate
}

/// Both errors of all methods against their times. Of the random sightlines only the most are
/// named.
pub(super) fn of_methods(results: &Results) -> Markup {
    let most = samples(results).last().map(|(run, _)| run.label.clone());
    let chart = |y, error: fn(&Answer) -> f64| {
        let series = results.methods.iter().filter_map(|run| {
            let answer = run.answer.as_ref()?;
            let is_sample = run.method == "sample";
            if is_sample && most.as_ref() != Some(&run.label) {
                return None;
            }
            let label = match run.state {
                State::CutShort => format!("{}, cut short", run.method),
                _ => run.label.clone(),
            };
            Some(Series {
                key: run.method,
                joined: false,
                points: point(run, label, error(answer)).into_iter().collect(),
            })
        });
        Chart {
            about: format!("{y} of each method against its time, both on logarithmic axes"),
            y,
            series: series.collect(),
            guides: Vec::new(),
        }
    };
    html! {
        div.pair {
            (figure("Too much: shown, but hidden in truth", &chart("overestimate", over)))
            (figure("Too little: overlooked", &chart("underestimate", under)))
        }
    }
}

/// What random sightlines miss, against their time.
pub(super) fn of_samples(results: &Results) -> Markup {
    let points = samples(results).into_iter().filter_map(|(run, answer)| {
        let rays = run.parameters.get("rays").copied().unwrap_or_default();
        point(run, grouped(rays as u64), under(answer))
    });
    let exact = results.methods.iter().filter(|r| r.class == "exact");
    let guides = exact.filter_map(|run| {
        Some(Guide {
            key: run.method,
            label: run.label.clone(),
            seconds: run.seconds.filter(|_| run.answer.is_some())?.median,
        })
    });
    let chart = Chart {
        about:
            "What random sightlines miss, against their time, for growing numbers of them, both \
                on logarithmic axes"
                .to_string(),
        y: "underestimate",
        series: vec![joined("sample", points)],
        guides: guides.collect(),
    };
    html! { div.pair { (figure("Random sightlines from every cell, and what they miss", &chart)) } }
}

/// What stays undecided with heights, and what is shown too much, against the time.
pub(super) fn of_heights(results: &Results, heights: &Heights) -> Markup {
    let runs = || {
        let answered = heights.runs.iter();
        answered.filter_map(|r| Some((r, r.answer.as_ref()?)))
    };
    let splits = |run: &Run| {
        let n = run.parameters.get("splits").copied().unwrap_or_default();
        grouped(n as u64)
    };
    let series = |error: fn(&Answer) -> f64| {
        let points = runs().filter_map(move |(run, answer)| point(run, splits(run), error(answer)));
        joined("heights", points)
    };
    let sweep = results.methods.iter().find(|r| r.method == "sweep");
    let planar = sweep.and_then(|run| {
        point(run, "walls only".to_string(), over(&heights.planar)).map(|mut point| {
            point.about = format!("walls only: {} too much", percent(over(&heights.planar)));
            Series {
                key: "sweep",
                joined: false,
                points: vec![point],
            }
        })
    });
    let undecided = Chart {
        about: "The share of pairs that stays undecided, against the time, for growing numbers of \
                splits, both on logarithmic axes"
            .to_string(),
        y: "undecided",
        series: vec![series(|a| a.undecided_share)],
        guides: Vec::new(),
    };
    let too_much = Chart {
        about: "What is shown too much compared with the tightest answer, against the time, both \
                on logarithmic axes"
            .to_string(),
        y: "overestimate",
        series: planar.into_iter().chain([series(over)]).collect(),
        guides: Vec::new(),
    };
    html! {
        div.pair {
            (figure("Neither proved nor ruled out, by number of splits", &undecided))
            (figure("Too much, compared with the tightest answer", &too_much))
        }
    }
}

/// The subdivisions side by side.
pub(super) fn of_subdivisions(results: &Results) -> Markup {
    let bar = |value: fn(&Subdivided) -> f64, text: fn(&Subdivided) -> String| {
        let list = results.subdivisions.iter().map(|s| Bar {
            key: s.subdivision,
            name: s.subdivision.to_string(),
            value: value(s),
            text: text(s),
        });
        list.collect::<Vec<_>>()
    };
    let time = |s: &Subdivided| s.subdivide.median + s.sweep.median;
    html! {
        div.pair {
            figure { (bars("Cells", &bar(|s| s.cells as f64, |s| grouped(s.cells as u64)))) }
            figure { (bars("Visible pairs", &bar(|s| s.pairs as f64, |s| grouped(s.pairs)))) }
            figure { (bars("Floor that a point's cell sees, on average", &bar(|s| s.floor, |s| percent(s.floor)))) }
            figure { (bars("Time for cutting and the exact answer", &bar(time, |s| duration(s.subdivide.median + s.sweep.median)))) }
        }
    }
}
