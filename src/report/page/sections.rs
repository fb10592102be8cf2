//! The page's sections besides the plan.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, html};

use super::plan::{number, unit_of};
use super::{Moment, Report};
use crate::report::costs::baseline::Change;
use crate::report::costs::json::Totals;
use crate::report::costs::{Costs, Gap, Measure, Worst};
use crate::report::wording::{self, count, duration, grouped};

/// Rows of openings and rooms in the tables.
const ROWS: usize = 40;
/// Rooms of the matrix.
const MATRIX: usize = 24;

/// A share: `23 %`, with a digit more if it is small.
pub fn percent(share: f64) -> String {
    let p = share * 100.0;
    match p.abs() {
        0.0 => "0 %".to_string(),
        a if a < 0.05 => "< 0.1 %".to_string(),
        a if a < 9.95 => format!("{p:.1} %"),
        _ => format!("{p:.0} %"),
    }
}

/// A reduction: `−23 %`.
fn less(share: f64) -> String {
    if share == 0.0 {
        return "0 %".to_string();
    }
    format!("−{}", percent(share))
}

/// A button that shows a cell on the plan.
fn cell(n: u32) -> Markup {
    html! { button.link type="button" data-cell=(n) { "cell " (n) } }
}

/// What it all comes to.
pub fn lede(report: &Report) -> Markup {
    let costs = report.costs;
    let measure = costs.main_measure();
    let spread = costs.spread(measure);
    let what = if measure == Measure::Polygons {
        "polygons"
    } else {
        "cells"
    };
    let all = costs.total().get(measure);
    html! {
        p.lede {
            "A place in this level sees " b { (number(spread.mean.round())) " " (what) } " in the mean, of "
            (number(all)) "; the dearest one " b { (number(spread.most)) } ". "
            @if let Some(gap) = costs.gaps.first().filter(|g| g.pairs > 0) {
                "Closing the " (gap.title) " would save most: the mean visible set would shrink by "
                b { (percent(gap.share)) } "."
            }
        }
    }
}

/// Links to the sections that there are.
pub fn contents(report: &Report) -> Markup {
    let mut links = vec![("overview", "Overview"), ("plan-section", "Plan")];
    if report.comparison.is_some() {
        links.push(("changes", "Changes"));
    }
    links.extend([
        ("worst", "Dearest places"),
        ("openings", "Openings"),
        ("sightlines", "Sightlines"),
    ]);
    if !report.reveals.is_empty() {
        links.push(("reveals", "Walks"));
    }
    links.extend([
        ("rooms", "Rooms"),
        ("findings", "Findings"),
        ("method", "Method"),
    ]);
    html! { nav.contents aria-label="Sections" { @for (id, name) in links { a href=(format!("#{id}")) { (name) } " " } } }
}

/// The limits, if there are any.
pub fn budget(report: &Report) -> Markup {
    if report.budget.is_empty() {
        return html! {};
    }
    let over = report.budget.iter().filter(|c| !c.kept).count();
    html! {
        section id="budget" aria-labelledby="budget-title" {
            h2 id="budget-title" { "Budget: " @if over == 0 { "kept" } @else { (over) " of " (report.budget.len()) " exceeded" } }
            div.scroll tabindex="0" role="region" aria-label="Limits" { table {
                thead { tr { th scope="col" { "limit" } th scope="col" { "allowed" } th scope="col" { "found" } th scope="col" { "kept?" } th.left scope="col" { "where" } } }
                tbody { @for check in report.budget {
                    tr {
                        th scope="row" { code { (check.name) } }
                        td { (number(check.limit)) }
                        td { (number(check.value)) }
                        td { @if check.kept { span.good { "kept" } } @else { span.bad { "over" } } }
                        td.left { @for &c in check.cells.iter().take(6) { (cell(c)) " " }
                            @if check.cells.len() > 6 { "and " (check.cells.len() - 6) " more" } }
                    }
                } }
            } }
        }
    }
}

/// Figures of the whole level.
pub fn overview(report: &Report) -> Markup {
    let costs = report.costs;
    let (graph, pvs, level) = (costs.graph, costs.pvs, costs.level);
    let total = costs.total();
    let facts = [
        ("cells", grouped(graph.cells.len() as u64)),
        ("portals", grouped(graph.portals.len() as u64)),
        ("gaps between walls", grouped(costs.gaps.len() as u64)),
        ("polygons", number(total.polygons)),
        ("ground", wording::area(level, total.area)),
        (
            "walls",
            format!("{} {}", number(total.wall_length), wording::unit(level)),
        ),
        ("visible pairs", grouped(pvs.pairs())),
        ("density", percent(pvs.density())),
        (
            "longest sightline",
            format!(
                "{} {}",
                number(costs.longest_sightline()),
                wording::unit(level)
            ),
        ),
    ];
    html! {
        section id="overview" aria-labelledby="overview-title" {
            h2 id="overview-title" { "Overview" }
            dl.facts { @for (name, value) in &facts { div { dt { (name) } dd { (value) } } } }
            h3 { "What a place sees" }
            p { "Over all cells. A cell sees what lies in the cells of its visible set, itself included." }
            div.scroll tabindex="0" role="region" aria-label="Distribution" { table {
                thead { tr { th scope="col" { "measure" } th scope="col" { "least" } th scope="col" { "median" } th scope="col" { "mean" }
                    th scope="col" { "nine in ten ≤" } th scope="col" { "most" } th.left scope="col" { "cells by class" } } }
                tbody { @for m in costs.measures() { (distribution(costs, m)) } }
            } }
        }
    }
}

fn distribution(costs: &Costs, measure: Measure) -> Markup {
    let spread = costs.spread(measure);
    let steps = super::plan::steps(costs, measure);
    let mut counts = [0usize; super::plan::CLASSES];
    for c in costs.graph.cell_ids() {
        counts[super::plan::class(&steps, costs.value(measure, c))] += 1;
    }
    let most = counts.iter().copied().max().unwrap_or(1).max(1);
    let unit = unit_of(costs, measure);
    let words: Vec<String> = counts
        .iter()
        .zip(&steps)
        .map(|(n, s)| format!("{n} up to {}", number(*s)))
        .collect();
    html! {
        tr {
            th scope="row" { (measure.title()) @if !unit.is_empty() { small { (unit) } } }
            td { (number(spread.least)) } td { (number(spread.median)) } td { (number(rounded(spread.mean))) }
            td { (number(spread.ninth)) } td { (number(spread.most)) }
            td.left { svg.histogram viewBox="0 0 160 34" role="img" aria-label=(words.join(", ")) {
                @for (k, n) in counts.iter().enumerate() {
                    @let h = (*n as f64 / most as f64 * 32.0).max(if *n > 0 { 1.0 } else { 0.0 });
                    rect class=(format!("h{k}")) x=(k * 20) y=(format!("{:.1}", 33.0 - h)) width="18" height=(format!("{h:.1}")) {
                        title { (words[k]) }
                    }
                }
            } }
        }
    }
}

/// To three digits that count.
fn rounded(x: f64) -> f64 {
    if x.abs() >= 100.0 {
        x.round()
    } else {
        (x * 10.0).round() / 10.0
    }
}

/// What changed since the baseline.
pub fn changes(report: &Report) -> Markup {
    let Some(c) = report.comparison else {
        return html! {};
    };
    let level = report.costs.level;
    let row = |name: &str, of: &dyn Fn(&Totals) -> f64| {
        let before = c.before.as_ref().map(of);
        let after = of(&c.after);
        html! { tr {
            th scope="row" { (name) }
            td { (before.map_or("–".to_string(), |b| number(rounded(b)))) }
            td { (number(rounded(after))) }
            td { (before.map_or("–".to_string(), |b| change(b, after))) }
        } }
    };
    html! {
        section id="changes" aria-labelledby="changes-title" {
            h2 id="changes-title" { "Since the baseline" }
            p {
                "Compared with " (c.baseline[0]) " (" (c.baseline[1]) "), place by place: "
                (count(c.changed as usize, "cell")) " of " (grouped(report.costs.graph.cells.len() as u64)) " see more or less than before"
                @if c.new_cells > 0 { ", " (count(c.new_cells as usize, "cell")) " stand on new ground" }
                @if c.gone_cells > 0 { ", the ground of " (count(c.gone_cells as usize, "cell")) " is gone" }
                ". Somebody who stands anywhere on the ground that is in both saw "
                (wording::area(level, c.mean_ground_before)) " in the mean, and sees " b { (wording::area(level, c.mean_ground_after)) }
                " now: " b { (change(c.mean_ground_before, c.mean_ground_after)) } "."
            }
            div.scroll tabindex="0" role="region" aria-label="Totals before and after" { table {
                thead { tr { th scope="col" { "figure" } th scope="col" { "before" } th scope="col" { "now" } th scope="col" { "change" } } }
                tbody {
                    (row("cells", &|t| t.own.cells))
                    (row("mean visible cells", &|t| t.mean_cells))
                    (row("mean visible polygons", &|t| t.mean_polygons))
                    (row("mean visible area, by ground", &|t| t.mean_ground))
                    (row("density, %", &|t| t.density * 100.0))
                    (row("longest sightline", &|t| t.longest_sightline))
                }
            } }
            div.pair {
                (changed(report, "Places that see less", &c.shrunk))
                (changed(report, "Places that see more", &c.grown))
            }
        }
    }
}

fn change(before: f64, after: f64) -> String {
    if before == after {
        return "no change".to_string();
    }
    if before == 0.0 {
        return format!("+{}", number(rounded(after)));
    }
    let share = after / before - 1.0;
    if share < 0.0 {
        less(-share)
    } else {
        format!("+{}", percent(share))
    }
}

fn changed(report: &Report, title: &str, list: &[Change]) -> Markup {
    let level = report.costs.level;
    html! { div {
        h3 { (title) }
        @if list.is_empty() { p.none { "None." } } @else { ol {
            @for c in list { li { (cell(c.cell)) @if let Some(room) = &c.room { " in " (room) }
                @if c.lost > 0.0 { ", lost " (wording::area(level, c.lost)) }
                @if c.gained > 0.0 { ", gained " (wording::area(level, c.gained)) }
            } }
        } }
    } }
}

/// The dearest places.
pub fn worst(report: &Report) -> Markup {
    let costs = report.costs;
    let unit = costs.main_measure().title().to_lowercase();
    html! {
        section id="worst" aria-labelledby="worst-title" {
            h2 id="worst-title" { "The dearest places" }
            p { "By " (unit) ". Of places that see nearly the same, only the dearest is listed, and none where nobody "
                "can stand. Under each: the openings "
                "through which alone it sees most, and what would disappear from its view if that opening were walled up." }
            ol.places { @for (i, place) in costs.worst.iter().enumerate() {
                (dear(report, place, report.thumbnails.get(i).and_then(|t| t.as_deref())))
            } }
        }
    }
}

fn picture(png: Option<&[u8]>, what: &str) -> Markup {
    html! { @if let Some(png) = png {
        img loading="lazy" width="320" height="200" alt=(what) src=(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png)));
    } }
}

fn dear(report: &Report, place: &Worst, png: Option<&[u8]>) -> Markup {
    let costs = report.costs;
    let seen = &place.seen;
    let at = place.point.map(|x| wording::coordinate(costs.level, x));
    let title = place
        .room
        .clone()
        .unwrap_or_else(|| format!("cell {}", place.cell));
    html! { li {
        (picture(png, &format!("What one sees in {title}")))
        div {
            h3 { (title) " " (cell(place.cell)) }
            p.figures { "at " (at[0]) ", " (at[1]) ": "
                @if seen.polygons > 0.0 { b { (number(seen.polygons)) " polygons" } " in " }
                b { (number(seen.cells)) " cells" } ", " (wording::area(costs.level, seen.area)) }
            @if place.openings.is_empty() { p.none { "No single opening would hide anything from here." } } @else {
                ul.hides { @for h in place.openings.iter().take(4) {
                    @let gap = &costs.gaps[h.gap as usize];
                    li { button.link type="button" data-gap=(h.gap) { (gap.title) } ": "
                        "−" (number(h.cells)) " cells (" (less(h.cells / seen.cells)) ")"
                        @if seen.polygons > 0.0 { ", −" (number(h.polygons)) " polygons (" (less(h.polygons / seen.polygons)) ")" } }
                } }
            }
        }
    } }
}

/// The openings, ranked.
pub fn openings(report: &Report) -> Markup {
    let costs = report.costs;
    let saving = costs.gaps.iter().filter(|g| g.pairs > 0).count();
    let polygons = costs.main_measure() == Measure::Polygons;
    let walls = costs.gaps.iter().any(|g| g.wall.is_some());
    html! {
        section id="openings" aria-labelledby="openings-title" {
            h2 id="openings-title" { "Openings: what closing one would save" }
            p { "Every straight gap between two walls, whether a door stands there or not. Each figure is exact: so many "
                "pairs of cells see each other only through this gap, and would no longer if it were walled up. A choke point "
                "is an opening with many of them. " (count(saving, "gap")) " of " (grouped(costs.gaps.len() as u64))
                " would save something; it took " (duration(costs.seconds.closing)) " to find out for all of them." }
            div.scroll tabindex="0" role="region" aria-label="Ranking of openings" { table.sortable {
                thead { tr { th scope="col" { "#" } th.left scope="col" { "opening" } th scope="col" { "width" } th scope="col" { "pairs lost" }
                    th scope="col" { "mean visible cells" } @if polygons { th scope="col" { "mean visible polygons" } } th scope="col" { "mean visible area, by ground" }
                    @if walls { th scope="col" { "with a shorter wall in it" } } } }
                tbody { @for (i, gap) in costs.gaps.iter().enumerate().take(ROWS).filter(|(_, g)| g.pairs > 0) { (opening(i, gap, polygons, walls)) } }
            } }
            @if saving > ROWS { p.aside { "The first " (ROWS) "; all are in the JSON (" code { "openings" } ")." } }
        }
    }
}

fn opening(i: usize, gap: &Gap, polygons: bool, walls: bool) -> Markup {
    html! { tr data-opening=(i) {
        td { (i + 1) }
        th.left scope="row" { button.link type="button" data-gap=(i) { (gap.title) } }
        td data-sort=(gap.length) { (number(rounded(gap.length))) }
        td data-sort=(gap.pairs) { (grouped(gap.pairs)) }
        td data-sort=(gap.share) { (bar(gap.share)) (less(gap.share)) }
        @if polygons { td data-sort=(gap.polygons_share) { (less(gap.polygons_share)) } }
        td data-sort=(gap.ground_share) { (less(gap.ground_share)) }
        @if walls { td data-sort=(gap.wall.map_or(0.0, |w| w.share)) {
            @if let Some(w) = &gap.wall { (less(w.share)) " (" (number(rounded(w.length))) ")" } @else { "–" }
        } }
    } }
}

fn bar(share: f64) -> Markup {
    html! { span.bar aria-hidden="true" { span style=(format!("width:{:.1}%", (share * 100.0).clamp(0.0, 100.0))) {} } }
}

/// The longest sightlines, and what is exposed.
pub fn sightlines(report: &Report) -> Markup {
    let costs = report.costs;
    let unit = wording::unit(costs.level);
    let ends = |rooms: &[Option<String>; 2]| match rooms {
        [Some(a), Some(b)] if a == b => format!("within {a}"),
        [Some(a), Some(b)] => format!("from {a} to {b}"),
        _ => String::new(),
    };
    let dominant = costs.dominant(8);
    html! {
        section id="sightlines" aria-labelledby="sightlines-title" {
            h2 id="sightlines-title" { "Sightlines" }
            div.pair {
                div {
                    h3 { "The longest lanes" }
                    p { "The longest straight lines that no wall crosses, one for each lane. They may touch corners; lines "
                        "beside them are free." }
                    ol.lanes { @for (i, lane) in costs.lanes.iter().enumerate() {
                        li { button.link type="button" data-lane=(i) { (number(rounded(lane.length))) " " (unit) } " " (ends(&lane.rooms)) }
                    } }
                }
                div {
                    h3 { "Exposure and dominance" }
                    p { "Sight goes both ways: a place is exposed to as many places as it sees. One place dominates another if it "
                        "sees the other and everything that the other sees." }
                    ol { @for (c, n) in &dominant {
                        li { (cell(c.0)) @if let Some(room) = crate::report::costs::room_of(costs.level, costs.graph, *c) { " in " (room) }
                            ": dominates " (count(*n as usize, "cell")) ", exposed to " (percent(costs.seen[c.0 as usize].area / costs.total().area)) " of the ground" }
                    } }
                }
            }
        }
    }
}

/// What walks reveal.
pub fn reveals(report: &Report) -> Markup {
    if report.reveals.is_empty() {
        return html! {};
    }
    let level = report.costs.level;
    let ground = report.costs.total().area;
    html! {
        section id="reveals" aria-labelledby="reveals-title" {
            h2 id="reveals-title" { "What is revealed where" }
            p { "Along a walk: the moments at which most ground comes into sight for the first time." }
            @for (i, walk) in report.reveals.iter().enumerate() {
                h3 { button.link type="button" data-walk=(i) { (walk.name) } }
                ol.places { @for moment in &walk.moments { (revealed(moment, level, ground)) } }
            }
        }
    }
}

fn revealed(moment: &Moment, level: &crate::level::Level, ground: f64) -> Markup {
    let [new, all] = moment.area;
    html! { li {
        (picture(moment.picture.as_deref(), "What the walker sees"))
        div {
            h3 { "After " (format!("{:.1}", moment.seconds)) " s " (cell(moment.cell)) }
            p.figures { (number(rounded(moment.distance))) " " (wording::unit(level)) " along the way; " b { (wording::area(level, new)) }
                " come into sight, " (percent(all / ground)) " of the ground seen by now" }
            @if !moment.rooms.is_empty() { p { "First seen: " (listed(&moment.rooms)) } }
        }
    } }
}

fn listed(names: &[String]) -> String {
    const SHOWN: usize = 8;
    let mut text = names
        .iter()
        .take(SHOWN)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    if names.len() > SHOWN {
        text += &format!(" and {} more", names.len() - SHOWN);
    }
    text
}

/// The figures by room.
pub fn rooms(report: &Report) -> Markup {
    let costs = report.costs;
    let list = &costs.rooms.list;
    let measure = costs.main_measure();
    let mut order: Vec<usize> = (0..list.len()).collect();
    order.sort_by(|&a, &b| {
        list[b]
            .mean
            .get(measure)
            .total_cmp(&list[a].mean.get(measure))
    });
    let few = list.len() <= MATRIX;
    let mut in_matrix: Vec<usize> = order.iter().copied().take(MATRIX).collect();
    if few {
        in_matrix.sort_unstable();
    }
    html! {
        section id="rooms" aria-labelledby="rooms-title" {
            h2 id="rooms-title" { "Rooms" }
            p { "What somebody sees who stands anywhere in a room (the mean over its ground), and the most from one of its cells." }
            div.scroll tabindex="0" role="region" aria-label="Figures by room" { table.sortable {
                thead { tr { th.left scope="col" { "room" } th scope="col" { "cells" } th scope="col" { "ground" }
                    th scope="col" { "sees rooms" } th scope="col" { "mean cells" } th scope="col" { "most cells" }
                    @if measure == Measure::Polygons { th scope="col" { "mean polygons" } th scope="col" { "most polygons" } }
                    th scope="col" { "mean area" } } }
                tbody { @for &i in order.iter().take(ROWS) {
                    @let room = &list[i];
                    tr data-room-row=(i) {
                        th.left scope="row" { button.link type="button" data-room=(i) { (room.name) } }
                        td { (number(room.own.cells)) } td data-sort=(room.own.area) { (number(rounded(room.own.area))) }
                        td { (room.sees.len()) }
                        td data-sort=(room.mean.cells) { (number(rounded(room.mean.cells))) } td { (number(room.most.cells)) }
                        @if measure == Measure::Polygons { td data-sort=(room.mean.polygons) { (number(rounded(room.mean.polygons))) } td { (number(room.most.polygons)) } }
                        td data-sort=(room.mean.area) { (number(rounded(room.mean.area))) }
                    }
                } }
            } }
            @if list.len() > ROWS { p.aside { "The " (ROWS) " dearest of " (list.len()) "; all are in the JSON (" code { "rooms" } ")." } }
            h3 { "Which room sees which" }
            p { "Pairs of cells, one in the room of the row, one in that of the column, that see each other. "
                @if !few { "The " (MATRIX) " dearest rooms. " } span.screen { "A click on a room's name sorts by it." } }
            div.scroll tabindex="0" role="region" aria-label="Which room sees which" { table.matrix id="matrix" {
                thead { tr { th scope="col" { button.sort type="button" data-sort-by="-1" { "room" } }
                    @for &j in &in_matrix { th scope="col" data-col=(j) { button.sort type="button" data-sort-by=(j) title=(list[j].name) { (list[j].name) } } } } }
                tbody { @for &i in &in_matrix { tr data-row=(i) {
                    th scope="row" { (list[i].name) }
                    @for &j in &in_matrix { @let n = costs.rooms.pairs(i, j); (entry(n, list[i].own.cells * list[j].own.cells, j)) }
                } } }
            } }
        }
    }
}

/// A field of the matrix, its ground by the share of all pairs.
fn entry(n: u64, all: f64, column: usize) -> Markup {
    let class = match n as f64 / all {
        s if s <= 0.0 => "m0",
        s if s < 0.25 => "m1",
        s if s < 0.75 => "m2",
        _ => "m3",
    };
    html! { td class=(class) data-n=(n) data-col=(column) { @if n > 0 { (grouped(n)) } @else { "·" } } }
}

/// What `check` finds.
pub fn findings(report: &Report) -> Markup {
    let list = &report.costs.findings;
    html! {
        section id="findings" aria-labelledby="findings-title" {
            h2 id="findings-title" { "Findings" }
            @if list.is_empty() { p.none { "Nothing looks wrong." } } @else { ul {
                @for f in list { li { b { (f.severity.as_str()) } ": " (f.places.len()) " × " code { (f.code) } ". " (f.message)
                    " At " (f.places.iter().take(4).map(|p| p.to_string()).collect::<Vec<_>>().join("; "))
                    @if f.places.len() > 4 { "; and " (f.places.len() - 4) " more" } "." } }
            } }
        }
    }
}

/// How it was found, and what that took.
pub fn method(report: &Report) -> Markup {
    let costs = report.costs;
    let s = &costs.seconds;
    let times = [
        ("reading", report.seconds.read),
        ("cutting into cells", report.seconds.subdivide),
        ("the PVS", report.seconds.visibility),
        ("sums", s.sums),
        ("closing every gap", s.closing),
        ("shorter walls", s.walls),
        ("longest lines", s.lines),
        ("findings", s.findings),
        ("pictures", s.pictures),
    ];
    html! {
        section id="method" aria-labelledby="method-title" {
            h2 id="method-title" { "Method" }
            p { "Visibility is " b { (costs.pvs.class.as_str()) } ", by " (costs.pvs.method.as_str()) " on the plan, the cells by "
                (costs.graph.options.subdivision.as_str()) ", doors " (costs.graph.options.doors.as_str())
                ". One cell sees another if any straight line leads from inside the one to inside the other without crossing a wall. "
                "What closing a gap hides comes from a search through all chains of portals that sightlines take: a pair is lost when "
                "all of them lead through the gap. Lengths and areas are sums of exact places in floating point." }
            dl.facts { @for (name, seconds) in times.iter().filter(|t| t.1 > 0.0) { div { dt { (name) } dd { (duration(*seconds)) } } } }
        }
    }
}
