//! The plan of the page: cells coloured by what they cost, walls and openings, and the controls.

use std::fmt::Write;

use glam::DVec2;
use maud::{Markup, PreEscaped, html};

use super::Report;
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::Vertex;
use crate::report::costs::baseline::Comparison;
use crate::report::costs::{Costs, Measure};
use crate::report::plan::names::labels;
use crate::report::plan::{Line, line_of};
use crate::report::wording;

/// How many colours the heat map has.
pub const CLASSES: usize = 8;

/// Width of the plan; its height is at most as much.
const SIZE: f64 = 1000.0;
const MARGIN: f64 = 8.0;

/// Where things lie on the plan.
pub struct Sheet {
    /// Units of the plan for one of the level.
    pub scale: f64,
    /// The level's point that is the plan's upper left corner.
    pub corner: DVec2,
    /// Width and height.
    pub size: DVec2,
}

impl Sheet {
    /// A plan that holds all cells.
    pub fn of(graph: &CellGraph) -> Self {
        let points = graph
            .vertices
            .iter()
            .map(|v: &Vertex| v.to_level(&graph.grid));
        let (low, high) = points.fold((DVec2::MAX, DVec2::MIN), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let (low, high) = if low.x > high.x {
            (DVec2::ZERO, DVec2::ONE)
        } else {
            (low, high)
        };
        let extent = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let scale = (SIZE - 2.0 * MARGIN) / extent.max_element();
        Sheet {
            scale,
            corner: DVec2::new(low.x, high.y) + DVec2::new(-MARGIN, MARGIN) / scale,
            size: (extent * scale + 2.0 * MARGIN).ceil(),
        }
    }

    /// A point of the level on the plan.
    pub fn at(&self, p: DVec2) -> DVec2 {
        let d = (p - self.corner) * self.scale;
        DVec2::new(d.x, -d.y)
    }
}

/// Appends straight lines to the data of a path.
fn chain(data: &mut String, points: impl IntoIterator<Item = DVec2>) {
    for (i, p) in points.into_iter().enumerate() {
        let letter = if i == 0 { 'M' } else { 'L' };
        let [x, y] = [p.x, p.y].map(|x| (x * 10.0).round() / 10.0);
        _ = write!(data, "{letter}{x} {y}");
    }
}

/// The upper bounds of a measure's classes, round numbers; the last is not below the most.
pub fn steps(costs: &Costs, measure: Measure) -> Vec<f64> {
    round_steps(costs.spread(measure).most, measure.is_count())
}

/// The bounds of classes of growth: as many for what grew as for what shrank.
pub fn growth_steps(comparison: &Comparison) -> Vec<f64> {
    let growth = comparison.growth.iter().flatten();
    round_steps(growth.fold(0.0, |most, g| g.abs().max(most)), false)
}

fn round_steps(most: f64, whole: bool) -> Vec<f64> {
    let raw = (most / CLASSES as f64).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(raw.log10().floor());
    let nice = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    let step = nice.into_iter().map(|m| m * power).find(|s| *s >= raw);
    let mut step = step.unwrap_or(raw);
    if whole {
        step = step.ceil().max(1.0);
    }
    (1..=CLASSES).map(|k| step * k as f64).collect()
}

/// The class of a value.
pub fn class(steps: &[f64], value: f64) -> usize {
    steps
        .iter()
        .position(|s| value <= *s)
        .unwrap_or(CLASSES - 1)
}

/// The unit after a measure's numbers, if it has one.
pub fn unit_of(costs: &Costs, measure: Measure) -> String {
    let unit = wording::unit(costs.level);
    match measure {
        Measure::Area if unit.len() > 2 => format!("square {unit}"),
        Measure::Area => format!("{unit}²"),
        Measure::WallLength | Measure::Sightline => unit,
        _ => String::new(),
    }
}

/// The section with the plan and what one does with it.
pub fn section(report: &Report, sheet: &Sheet) -> Markup {
    let costs = report.costs;
    let measure = costs.main_measure();
    let bounds = steps(costs, measure);
    let (width, height) = (sheet.size.x, sheet.size.y);
    let rooms: Vec<&str> = costs.rooms.list.iter().map(|r| r.name.as_str()).collect();
    html! {
        section id="plan-section" aria-labelledby="plan-title" {
            h2 id="plan-title" { "The plan" }
            p.screen {
                "Each cell has the colour of what somebody sees who stands there. Point at a cell for its figures; "
                "click it to see its visible set and its longest sightline; click a second one for the sightline "
                "between the two, or what blocks it. Keys: arrows move, Enter chooses, Shift+Enter chooses the second, "
                "+ and − zoom, 0 shows all, Escape clears."
            }
            div.tools.screen {
                label { "Colour by "
                    select id="measure" {
                        @for m in costs.measures() {
                            option value=(m.key()) selected[m == measure] { (m.title()) }
                        }
                        @if report.comparison.is_some() {
                            option value="growth" { "Change since the baseline" }
                        }
                    }
                }
                form id="find" {
                    label { "Find " input id="search" list="places" placeholder="cell 12, or a room" autocomplete="off"; }
                    datalist id="places" { @for name in rooms.iter().take(2000) { option value=(name) {} } }
                    button { "Show" }
                }
                span.buttons {
                    button type="button" id="zoom-in" aria-label="Zoom in" { "+" }
                    button type="button" id="zoom-out" aria-label="Zoom out" { "−" }
                    button type="button" id="zoom-all" { "Whole plan" }
                    button type="button" id="clear" { "Clear" }
                }
            }
            div.stage {
                figure.plan {
                    svg id="plan" viewBox=(format!("0 0 {width} {height}")) tabindex="0" role="application"
                        aria-label=(format!("Plan of {}, interactive", costs.level.name)) aria-describedby="told" {
                        g id="heat" { (heat(costs, sheet, measure, &bounds)) }
                        path id="seen" {}
                        path id="cursor" {}
                        path id="source" {}
                        path id="second" {}
                        (lines(costs, sheet))
                        (names(costs, sheet))
                        path id="gap" {}
                        path id="walk" {}
                        path id="blocked" {}
                        path id="sight" {}
                        g id="dots" {}
                    }
                    figcaption {
                        div id="legend" { (legend(costs, measure, &bounds)) }
                        div.key {
                            span { i.source {} "chosen" } span { i.seen {} "visible from it" }
                            span { i.second {} "second" } span { i.sight {} "sightline" }
                            span { i.door {} "door" } span { i.window {} "window" }
                        }
                    }
                }
                div.panel {
                    h3 id="told-title" { "Nothing chosen" }
                    div id="told" role="status" aria-live="polite" {
                        p { "Choose a cell on the plan, or one of the places below." }
                    }
                }
            }
            div id="tip" hidden {}
        }
    }
}

/// The cells, a path for each class: no seams, and few elements however many cells there are.
fn heat(costs: &Costs, sheet: &Sheet, measure: Measure, bounds: &[f64]) -> Markup {
    let graph = costs.graph;
    let mut paths = vec![String::new(); CLASSES];
    for cell in graph.cell_ids() {
        let path = &mut paths[class(bounds, costs.value(measure, cell))];
        chain(path, corners(graph, sheet, cell));
        path.push('Z');
    }
    html! {
        @for (k, path) in paths.iter().enumerate() {
            path class=(format!("h h{k}")) d=(PreEscaped(path)) {}
        }
    }
}

fn corners(graph: &CellGraph, sheet: &Sheet, cell: CellId) -> Vec<DVec2> {
    let polygon = graph.polygon(cell).into_iter();
    polygon
        .map(|v| sheet.at(graph.vertices.exact(v).to_level(&graph.grid)))
        .collect()
}

/// Walls, doors, windows and steps.
fn lines(costs: &Costs, sheet: &Sheet) -> Markup {
    let (level, graph) = (costs.level, costs.graph);
    let mut paths: [(&str, String); 4] =
        ["step", "door", "window", "wall"].map(|class| (class, String::new()));
    for e in (0..graph.edges.len() as u32).map(EdgeId) {
        if graph.edge(e).twin().is_some_and(|twin| twin < e) {
            continue;
        }
        let k = match line_of(level, graph, e) {
            Line::Border => continue,
            Line::Step | Line::Archway => 0,
            Line::Door => 1,
            Line::Window => 2,
            Line::Wall | Line::ClosedDoor => 3,
        };
        let ends = [graph.edge(e).origin, graph.end(e)];
        let at = |v| sheet.at(graph.vertices.exact(v).to_level(&graph.grid));
        chain(&mut paths[k].1, ends.map(at));
    }
    html! {
        @for (class, path) in &paths { path class=(class) d=(PreEscaped(path)) {} }
    }
}

/// Names of rooms, where they fit.
fn names(costs: &Costs, sheet: &Sheet) -> Markup {
    let graph = costs.graph;
    let at = |v| sheet.at(graph.vertices.exact(v).to_level(&graph.grid));
    let labels = labels(costs.level, graph, at, [DVec2::ZERO, sheet.size], &[]);
    let tenth = |x: f64| (x * 10.0).round() / 10.0;
    html! {
        g id="names" aria-hidden="true" {
            @for (_, label) in &labels {
                @let [x, y] = label.at.to_array().map(tenth);
                @let turn = label.upright.then(|| format!("rotate(-90 {x} {y})"));
                @for (row, at) in label.baselines() {
                    text x=(tenth(at.x)) y=(tenth(at.y)) font-size=(label.size) transform=[&turn] { (row) }
                }
            }
        }
    }
}

fn legend(costs: &Costs, measure: Measure, bounds: &[f64]) -> Markup {
    let unit = unit_of(costs, measure);
    html! {
        span.title { (measure.title()) @if !unit.is_empty() { " (" (unit) ")" } ": " }
        @for (k, bound) in bounds.iter().enumerate() {
            span.swatch { i class=(format!("h{k}")) {} "≤ " (number(*bound)) }
        }
    }
}

/// With four digits, grouped.
pub fn number(x: f64) -> String {
    if x.abs() >= 1000.0 {
        let sign = if x < 0.0 { "−" } else { "" };
        format!("{sign}{}", wording::grouped(x.abs().round() as u64))
    } else if x.fract() == 0.0 {
        format!("{x}")
    } else {
        wording::length(x)
    }
}
