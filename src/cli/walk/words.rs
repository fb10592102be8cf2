//! What `walk` says when it is done.

use std::fmt::Write as _;
use std::mem::discriminant;

use super::{Done, Route, WalkArgs};
use crate::cli::stage::Stage;
use crate::level::Level;
use crate::report::walkthrough;
use crate::walk::figures::{self, Spread};
use crate::walk::{Barrier, Tour};

/// What there is to say.
pub fn text(
    args: &WalkArgs,
    stage: &Stage,
    route: &Route,
    done: &Done,
    walk: &walkthrough::Walk,
    [drawing, writing]: [f64; 2],
) -> String {
    const COLUMNS: usize = 60;
    let mut text = String::new();
    let [width, height] = args.size;
    _ = writeln!(
        text,
        "walk        {}, {} in {:.1} s: {} frames of {width} × {height}, {} a second",
        route.name,
        walk.length,
        walk.seconds,
        walk.frames.len(),
        args.fps
    );
    if let Some(tour) = &route.tour {
        let all = tour.visits.len() + tour.missed.len();
        _ = writeln!(text, "visits      {} of {all} sectors", tour.visits.len());
        for (barrier, names) in missed(tour, &stage.level) {
            _ = writeln!(text, "            not {names}: {barrier}");
        }
    }
    _ = write!(
        text,
        "frames      {} drawn, {} kept",
        walk.frames.len() - done.kept,
        done.kept
    );
    match done.removed {
        0 => text.push('\n'),
        n => _ = writeln!(text, ", {n} of a longer walk taken away"),
    }
    let summary = walk.summary;
    let most = (walk.frames.iter()).flat_map(|f| f.polygons.factors());
    let most = most.fold(1.0, f64::max);
    let rows = [
        ("backs", summary.factor_facing, 0),
        ("PVS", summary.factor_pvs, 1),
        ("eye", summary.factor_eye, 2),
    ];
    if walk.frames.iter().any(|f| f.polygons.all > 0) {
        _ = writeln!(
            text,
            "culling     all polygons to those painted: median, least to most, along the walk"
        );
        for (name, spread, k) in rows {
            let along: Vec<f64> = (walk.frames.iter())
                .map(|f| f.polygons.factors()[k])
                .collect();
            _ = writeln!(
                text,
                "  {name:<9} {:>6.1}  {:>5.1} to {:>6.1}  {}",
                spread.median,
                spread.least,
                spread.most,
                figures::sparkline(&along, most, COLUMNS)
            );
        }
    }
    let reuse = &summary.reuse;
    _ = writeln!(
        text,
        "reuse       {} of {} frames in the cell of the one before: {:.1} ms to find out what is \
         there, {:.1} without",
        reuse.frames, summary.frames, reuse.milliseconds, reuse.milliseconds_without
    );
    let (seconds, draw) = (&stage.seconds, summary.milliseconds_draw);
    _ = writeln!(
        text,
        "a frame     {:.1} ms to draw (median; {:.1} to {:.1})",
        draw.median, draw.least, draw.most
    );
    _ = writeln!(
        text,
        "seconds     read {:.3}, subdivide {:.3}, visibility {:.3}, frames {drawing:.1}, write {writing:.1}",
        seconds.read, seconds.subdivide, seconds.visibility
    );
    text
}

/// Sectors that a tour does not visit, by reason: the reason, and their names.
fn missed(tour: &Tour, level: &Level) -> Vec<(String, String)> {
    const NAMED: usize = 6;
    let mut list: Vec<(Vec<Barrier>, Vec<String>)> = Vec::new();
    for &(sector, barrier) in &tour.missed {
        let own = level.sectors.get(sector.0 as usize);
        let name = own
            .and_then(|s| s.name.clone())
            .unwrap_or(sector.0.to_string());
        let alike = |(b, _): &&mut (Vec<Barrier>, _)| discriminant(&b[0]) == discriminant(&barrier);
        match list.iter_mut().find(alike) {
            Some((barriers, names)) => {
                barriers.push(barrier);
                names.push(name);
            }
            None => list.push((vec![barrier], vec![name])),
        }
    }
    let told = |(barriers, names): (Vec<Barrier>, Vec<String>)| {
        let more = names.len().saturating_sub(NAMED);
        let mut text = names[..names.len() - more].join(", ");
        if more > 0 {
            _ = write!(text, " and {more} more");
        }
        (reason(&barriers), text)
    };
    list.into_iter().map(told).collect()
}

/// What several barriers of one kind have in common.
fn reason(barriers: &[Barrier]) -> String {
    let size = |b: &Barrier| match *b {
        Barrier::Low(size) | Barrier::Step(size) | Barrier::Drop(size) => size,
        _ => 0.0,
    };
    let spread = Spread::of(barriers.iter().map(size));
    let short = |x: f64| (x * 1000.0).round() / 1000.0;
    let (least, most) = (short(spread.least), short(spread.most));
    match barriers[0] {
        barrier if least == most => barrier.to_string(),
        Barrier::Low(_) => format!("openings are only {least} to {most} high"),
        Barrier::Step(_) => format!("steps are {least} to {most} high"),
        Barrier::Drop(_) => format!("drops are {least} to {most} deep"),
        barrier => barrier.to_string(),
    }
}

/// A length with its unit, in the plural.
pub fn length(of: f64, unit: &str) -> String {
    match unit {
        "map unit" => format!("{of:.0} map units"),
        unit => format!("{of:.1} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn barriers_of_one_kind_are_told_together() {
        let steps = [
            Barrier::Step(64.0),
            Barrier::Step(32.0),
            Barrier::Step(48.0),
        ];
        assert_eq!(reason(&steps), "steps are 32 to 64 high");
        assert_eq!(reason(&steps[..1]), "a step is 64 high");
        assert_eq!(
            reason(&[Barrier::Narrow, Barrier::Narrow]),
            "the way is too narrow"
        );
    }
}
