//! Pictures of the plan that follow the page's colours: what one cell sees, and two cells with what
//! is between them.

use std::fmt::Write;

use glam::DVec2;
use maud::{Markup, html};

use super::differ::{area, middle_and_size};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::pvs::Pvs;

/// Width of a picture, in its own units; coordinates are whole ones.
const WIDTH: f64 = 2400.0;

/// A part of the plan, as it lies on the picture.
struct Sheet<'a> {
    graph: &'a CellGraph,
    low: DVec2,
    high: DVec2,
    scale: f64,
}

impl<'a> Sheet<'a> {
    fn new(graph: &'a CellGraph, low: DVec2, high: DVec2) -> Self {
        let size = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let scale = WIDTH / size.max_element();
        Self {
            graph,
            low,
            high,
            scale,
        }
    }

    fn at(&self, p: DVec2) -> DVec2 {
        let d = (p - self.low) * self.scale;
        DVec2::new(d.x, (self.high.y - self.low.y) * self.scale - d.y).round()
    }

    fn view_box(&self) -> String {
        let size = (self.high - self.low) * self.scale;
        format!("0 0 {:.0} {:.0}", size.x, size.y)
    }

    /// Whether any of the points' extent lies on the sheet.
    fn meets(&self, points: &[DVec2]) -> bool {
        let (low, high) = extent(points.iter().copied());
        low.cmple(self.high).all() && high.cmpge(self.low).all()
    }

    fn corners(&self, cell: CellId) -> Vec<DVec2> {
        let corners = self.graph.polygon(cell).into_iter();
        corners.map(|v| self.graph.vertices.approx(v)).collect()
    }

    /// The cells that lie on the sheet, as the data of one path.
    fn cells(&self, cells: impl Iterator<Item = CellId>) -> String {
        let mut data = String::new();
        for cell in cells {
            let corners = self.corners(cell);
            if self.meets(&corners) {
                self.chain(&mut data, &corners);
                data.push('z');
            }
        }
        data
    }

    /// The edges on the sheet that are walls, or those that are not.
    fn edges(&self, walls: bool) -> String {
        let graph = self.graph;
        let mut data = String::new();
        for (edge, id) in graph.edges.iter().zip((0..).map(EdgeId)) {
            let drawn = match edge.twin() {
                None => walls,
                Some(twin) => !walls && id < twin,
            };
            let ends = [edge.origin, graph.end(id)].map(|v| graph.vertices.approx(v));
            if drawn && self.meets(&ends) {
                self.chain(&mut data, &ends);
            }
        }
        data
    }

    fn chain(&self, data: &mut String, points: &[DVec2]) {
        let mut last = None;
        for p in points.iter().map(|p| self.at(*p)) {
            _ = match last {
                None => write!(data, "M{} {}", p.x, p.y),
                Some(last) => {
                    let d: DVec2 = p - last;
                    write!(data, "l{} {}", d.x, d.y)
                }
            };
            last = Some(p);
        }
    }
}

fn extent(points: impl Iterator<Item = DVec2>) -> (DVec2, DVec2) {
    points.fold(
        (DVec2::splat(f64::MAX), DVec2::splat(f64::MIN)),
        |(low, high), p| (low.min(p), high.max(p)),
    )
}

/// A cell whose view makes a good example: large, and seeing about a third of the floor.
pub(super) fn example(graph: &CellGraph, pvs: &Pvs) -> Option<CellId> {
    let areas: Vec<f64> = graph
        .cell_ids()
        .map(|c| {
            let corners = graph.corners(c).map(|v| graph.vertices.approx(v));
            area(&corners.collect::<Vec<_>>())
        })
        .collect();
    let all: f64 = areas.iter().sum();
    let mut by_size: Vec<CellId> = graph.cell_ids().collect();
    by_size.sort_by(|a, b| areas[b.0 as usize].total_cmp(&areas[a.0 as usize]));
    let seen = |cell: CellId| -> f64 {
        let areas = pvs.seen_from(cell).map(|c| areas[c.0 as usize]);
        (areas.sum::<f64>() / all - 0.33).abs()
    };
    let large = by_size.into_iter().take(graph.cells.len().div_ceil(5));
    large.min_by(|a, b| seen(*a).total_cmp(&seen(*b)))
}

/// The whole plan, and what one cell of it sees.
pub(super) fn view(graph: &CellGraph, pvs: &Pvs, source: CellId, about: &str) -> Markup {
    let (low, high) = extent(graph.vertices.iter().map(crate::geom::Vertex::approx));
    let margin = (high - low).max_element() * 0.01;
    let sheet = Sheet::new(graph, low - margin, high + margin);
    let (seen, other): (Vec<CellId>, Vec<CellId>) =
        graph.cell_ids().partition(|c| pvs.sees(source, *c));
    html! {
        svg.plan viewBox=(sheet.view_box()) role="img" aria-label=(about) {
            path.floor d=(sheet.cells(other.into_iter())) {}
            path.seen d=(sheet.cells(seen.into_iter())) {}
            path.source d=(sheet.cells(std::iter::once(source))) {}
            path.border d=(sheet.edges(false)) {}
            path."edge source" d=(sheet.cells(std::iter::once(source))) {}
            path.wall d=(sheet.edges(true)) {}
        }
    }
}

/// Two cells and what lies between them; places are in grid steps.
pub(super) struct Pair {
    pub cells: [CellId; 2],
    /// A free segment between the two.
    pub sight: Option<[DVec2; 2]>,
    /// The shortest way, where there is none.
    pub way: Vec<DVec2>,
    /// The corners that block it.
    pub ends: Vec<DVec2>,
}

/// Draws the part of the plan around two cells.
pub(super) fn pair(graph: &CellGraph, pair: &Pair, about: &str) -> Markup {
    let corners = pair.cells.into_iter().flat_map(|c| graph.polygon(c));
    let points = corners.map(|v| graph.vertices.approx(v));
    let further = pair
        .sight
        .iter()
        .flatten()
        .chain(&pair.way)
        .chain(&pair.ends);
    let (low, high) = extent(points.chain(further.copied()));
    // All such pictures have the same shape, so that they stand well side by side.
    let size = (high - low) * 1.2;
    let width = size.x.max(size.y * 4.0 / 3.0);
    let margin = (DVec2::new(width, width * 0.75) - (high - low)) / 2.0;
    let sheet = Sheet::new(graph, low - margin, high + margin);
    let one = |cell| sheet.cells(std::iter::once(cell));
    let chain = |points: &[DVec2]| {
        let mut data = String::new();
        sheet.chain(&mut data, points);
        data
    };
    let ring = WIDTH / 50.0;
    let cells = || pair.cells.into_iter().zip(["source", "second"]);
    html! {
        svg.plan viewBox=(sheet.view_box()) role="img" aria-label=(about) {
            path.floor d=(sheet.cells(graph.cell_ids())) {}
            path.border d=(sheet.edges(false)) {}
            @for (cell, class) in cells() {
                path class=(class) d=(one(cell)) {}
                path class=(format!("edge {class}")) d=(one(cell)) {}
            }
            path.wall d=(sheet.edges(true)) {}
            @if !pair.way.is_empty() { path.way d=(chain(&pair.way)) {} }
            @if let Some(ends) = &pair.sight { path.sight d=(chain(ends)) {} }
            @for end in pair.ends.iter().map(|p| sheet.at(*p)) {
                circle.stop cx=(end.x) cy=(end.y) r=(ring * 0.4) {}
            }
            // A ring around a cell that is too small to be seen.
            @for (cell, class) in cells() {
                @let (middle, half) = middle_and_size(graph, cell);
                @if half * sheet.scale < ring * 0.7 {
                    @let p = sheet.at(middle);
                    circle class=(format!("edge {class}")) cx=(p.x) cy=(p.y) r=(ring) {}
                }
            }
        }
    }
}
