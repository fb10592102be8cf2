//! What the figures say, in sentences: which method to pick for what.
//!
//! In: [`Results`]. Out: plain sentences. Each is put together from what was measured, so that it is
//! true of this level on this machine; nothing is taken for granted but what a class promises.

use super::record::{Answer, Heights, Results, Run, State, Subdivided};
use crate::level::wording::{count, duration, grouped};
use crate::pvs::Method;
use crate::study::chart::percent;

/// A ratio of times: `12 times as long`, `about as long`, `a fifth of the time`.
pub(super) fn compared(ratio: f64) -> String {
    match ratio {
        r if r >= 99.5 => {
            let unit = 10f64.powf(r.log10().floor() - 1.0);
            format!(
                "{} times as long",
                grouped(((r / unit).round() * unit) as u64)
            )
        }
        r if r >= 9.95 => format!("{r:.0} times as long"),
        r if r >= 1.25 => format!("{r:.1} times as long"),
        r if r > 0.8 => "about as long".to_string(),
        r if r >= 0.55 => format!("{:.0}\u{202f}% of the time", r * 100.0),
        r if r >= 0.095 => format!("one {} of the time", part(1.0 / r)),
        r => format!("{} of the time", percent(r)),
    }
}

fn part(whole: f64) -> &'static str {
    match whole.round() as u32 {
        0..=2 => "half",
        3 => "third",
        4 => "quarter",
        5 => "fifth",
        6 => "sixth",
        7 => "seventh",
        8 => "eighth",
        9 => "ninth",
        _ => "tenth",
    }
}

/// A method as the subject of a sentence.
fn subject(run: &Run) -> &'static str {
    match run.method {
        "sweep" => "The sweep",
        "search" => "The search",
        "lp" => "The linear programme (lp)",
        "flow" => "Portal flow",
        "flood" => "Flooding",
        _ => "Random sightlines",
    }
}

fn median(run: &Run) -> f64 {
    run.seconds.map_or(f64::INFINITY, |s| s.median)
}

fn find(results: &Results, method: Method) -> Option<(&Run, &Answer)> {
    let run = results
        .methods
        .iter()
        .find(|r| r.method == method.as_str())?;
    Some((run, run.answer.as_ref()?))
}

fn pairs(n: u64) -> String {
    count(n as usize, "pair")
}

/// Which exact method to pick.
pub fn exact(results: &Results) -> String {
    let exact = [Method::Sweep, Method::Search].into_iter();
    let runs = exact.filter_map(|m| find(results, m));
    let mut complete: Vec<&Run> = runs
        .map(|(run, _)| run)
        .filter(|r| r.state == State::Complete)
        .collect();
    complete.sort_by(|a, b| median(a).total_cmp(&median(b)));
    let Some(best) = complete.first() else {
        return "No exact method came to its end.".to_string();
    };
    let mut text = format!(
        "Pick {} for the right answer: it is exact, and takes {}.",
        best.label,
        duration(median(best))
    );
    match (complete.get(1), results.truth.agreed) {
        (Some(other), Some(true)) => {
            text += &format!(
                " {}, which shares no code with it, finds the same {} pairs and takes {}.",
                subject(other),
                grouped(results.truth.pairs),
                compared(median(other) / median(best))
            );
        }
        (Some(other), Some(false)) => {
            text += &format!(
                " {}, the other exact method, disagrees with it: one of the two is broken; please \
                 report this level.",
                subject(other)
            );
        }
        _ => text += " The other exact method did not finish within its share of the budget.",
    }
    text
}

/// Which method to pick for what, in two sentences or three.
pub fn methods(results: &Results) -> String {
    let mut text = exact(results);
    for method in [Method::Lp, Method::Flow] {
        if let Some((run, answer)) = find(results, method) {
            text.push(' ');
            text += &floating(run, answer);
        }
    }
    if let Some((_, answer)) = find(results, Method::Flood)
        && answer.accuracy.overestimate > 0.0
    {
        text += " Pick flood only where connected is as good as visible.";
    }
    text
}

/// What each of the other methods gives for its time, one sentence for each.
pub fn others(results: &Results) -> Vec<String> {
    let mut list = Vec::new();
    for method in [Method::Lp, Method::Flow] {
        if let Some((run, answer)) = find(results, method) {
            list.push(floating(run, answer));
        }
    }
    if let Some((run, answer)) = find(results, Method::Flood) {
        let over = answer.accuracy.overestimate;
        let text = if over == 0.0 {
            "gives the exact answer here, for every cell that can be reached is also seen"
                .to_string()
        } else if over >= 1.0 {
            format!(
                "misses nothing, but calls {:.1} times as many cells visible as are: a first filter, \
                 no more",
                1.0 + over
            )
        } else {
            format!(
                "misses nothing, but calls {} more cells visible than are",
                percent(over)
            )
        };
        list.push(format!(
            "{} takes {} and {text}.",
            subject(run),
            duration(median(run))
        ));
    }
    list.extend(sampling(results));
    list
}

fn floating(run: &Run, answer: &Answer) -> String {
    let name = subject(run);
    let (invented, missed) = (answer.accuracy.invented, answer.accuracy.missed);
    let time = run.relative.map_or(String::new(), compared);
    let wrong = match (missed, invented) {
        (0, 0) => "gets every pair right here, though nothing promises that".to_string(),
        (m, 0) => format!("misses {}", pairs(m)),
        (0, i) => format!("invents {}", pairs(i)),
        (m, i) => format!(
            "gets {} wrong ({} missed, {} invented)",
            pairs(m + i),
            grouped(m),
            grouped(i)
        ),
    };
    match run.state {
        State::CutShort => format!(
            "{name} was stopped after {}; by then {} of its pairs were still undecided.",
            duration(median(run)),
            percent(answer.undecided_share)
        ),
        _ => format!("{name} takes {time} and {wrong}."),
    }
}

/// The runs with random sightlines that gave an answer, by their number of rays.
pub(super) fn samples(results: &Results) -> Vec<(&Run, &Answer)> {
    let runs = results.methods.iter();
    let of_sample = runs.filter(|r| r.method == Method::Sample.as_str());
    of_sample
        .filter(|r| r.state == State::Complete)
        .filter_map(|r| Some((r, r.answer.as_ref()?)))
        .collect()
}

fn rays(run: &Run) -> String {
    let rays = run.parameters.get("rays").copied().unwrap_or_default();
    grouped(rays as u64)
}

/// What random sightlines are good for.
pub fn sampling(results: &Results) -> Option<String> {
    let samples = samples(results);
    let (last, answer) = *samples.last()?;
    let under = |a: &Answer| a.accuracy.underestimate;
    if let Some((run, _)) = samples.iter().find(|(_, a)| under(a) == 0.0) {
        return Some(format!(
            "Random sightlines, {} from every cell, find every pair here and take {}; but nothing \
             tells when they have found all.",
            rays(run),
            compared(run.relative.unwrap_or(f64::INFINITY))
        ));
    }
    let mut text = format!(
        "Random sightlines invent nothing, but {} from every cell still miss {} of what is \
         visible, and take {}.",
        rays(last),
        percent(under(answer)),
        compared(last.relative.unwrap_or(f64::INFINITY))
    );
    let fast = samples
        .iter()
        .rev()
        .find(|(r, _)| r.relative.is_some_and(|x| x <= 1.0));
    if let Some((run, answer)) = fast {
        text += &format!(
            " In the time of the exact answer there is room for {} from every cell, which miss {}.",
            rays(run),
            percent(under(answer))
        );
    }
    Some(text)
}

/// What the different cells are good for.
pub fn subdivisions(results: &Results) -> Option<String> {
    let list = &results.subdivisions;
    let least = |key: fn(&Subdivided) -> f64| {
        let by_key = |a: &&Subdivided, b: &&Subdivided| key(a).total_cmp(&key(b));
        list.iter().min_by(by_key)
    };
    let time = |s: &Subdivided| s.subdivide.median + s.sweep.median;
    let (small, tight) = (least(|s| s.pairs as f64)?, least(|s| s.floor)?);
    let quick = least(time)?;
    if list.len() < 2 {
        return None;
    }
    let mut text = format!(
        "Pick {} for the smallest result ({} cells, {} pairs)",
        small.subdivision,
        grouped(small.cells as u64),
        grouped(small.pairs)
    );
    let share = |s: &Subdivided| percent(s.floor);
    if tight.subdivision == small.subdivision || share(tight) == share(small) {
        text += &format!(
            "; its sets are also the tightest, {} of the floor on average",
            share(tight)
        );
    } else {
        text += &format!(
            ", {} for the tightest sets: what may be visible from a point is {} of the floor on \
             average, against {} with {}",
            tight.subdivision,
            share(tight),
            share(small),
            small.subdivision
        );
    }
    text += &format!(
        ". {} is done first, cutting included: after {}.",
        capital(quick.subdivision),
        duration(time(quick))
    );
    Some(text)
}

/// What counting floors and ceilings gains, and which budget to give it.
pub fn heights(heights: &Heights) -> String {
    let over = heights.planar.accuracy.overestimate;
    let mut text = if over == 0.0 {
        "On this level floors and ceilings hide nothing that walls do not hide already.".to_string()
    } else {
        format!(
            "Floors and ceilings hide more than walls alone: without them the sets are {} larger \
             than they need be, on average over the cells.",
            percent(over)
        )
    };
    let runs: Vec<(&Run, &Answer)> = heights
        .runs
        .iter()
        .filter_map(|r| Some((r, r.answer.as_ref()?)))
        .collect();
    let least = runs
        .iter()
        .map(|(_, a)| a.undecided_share)
        .fold(1.0, f64::min);
    // The smallest budget that leaves hardly more undecided than the best one.
    let enough = |(_, a): &&(&Run, &Answer)| a.undecided_share <= least * 1.1;
    let (Some((run, answer)), Some((last, best))) = (runs.iter().find(enough), runs.last()) else {
        return text;
    };
    let splits = |run: &Run| {
        let n = run.parameters.get("splits").copied().unwrap_or_default();
        count(n as usize, "split")
    };
    if least == 0.0 {
        let enough = duration(median(run));
        text += &format!(
            " {} decide every pair, in {enough}: pick no more.",
            capital(&splits(run))
        );
        return text;
    }
    text += &format!(
        " Pick {}: {} of the pairs stay undecided after {}",
        splits(run),
        percent(answer.undecided_share),
        duration(median(run))
    );
    let more = median(last) / median(run);
    text += &if run.label == last.label {
        "; no smaller budget comes near it.".to_string()
    } else {
        format!(
            "; {} leave {} and take {}.",
            splits(last),
            percent(best.undecided_share),
            compared(more)
        )
    };
    text
}

/// With a capital letter, as a sentence begins.
pub(super) fn capital(text: &str) -> String {
    let mut rest = text.chars();
    match rest.next() {
        Some(first) => first.to_uppercase().chain(rest).collect(),
        None => String::new(),
    }
}
