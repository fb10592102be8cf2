//! Where things lie on the picture: margins, scale, and the way from grid steps to the page.

use std::fmt::Write;

use glam::DVec2;

use crate::cells::CellGraph;
use crate::geom::{Vertex, VertexId};

const WIDTH: f64 = 1200.0;
/// Tall plans are made smaller rather than higher than this.
const MAX_PLAN_HEIGHT: f64 = 1400.0;
const SIDE: f64 = 40.0;
const TOP: f64 = 84.0;
const BOTTOM: f64 = 44.0;
/// What is shown around a part of a plan, in parts of its longer side.
const MARGIN: f64 = 0.15;
/// A part at least this long, compared with the whole, is not shown alone.
const ENOUGH: f64 = 0.6;
/// Height of a row of the legend.
pub const ROW: f64 = 24.0;

/// The page.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Width of the page.
    pub width: f64,
    /// Height of the page, with one row for the legend.
    pub height: f64,
    /// The middle of the legend's first row.
    pub foot: f64,
    /// Units of the page for a grid step.
    pub scale: f64,
    /// Left margin of everything outside the plan.
    pub side: f64,
    /// The page's point for the plan's upper left corner, and that corner in grid steps.
    origin: DVec2,
    corner: DVec2,
    /// The plan's size on the page.
    plan: DVec2,
}

/// The least box around some points.
fn extent(points: impl Iterator<Item = DVec2>) -> Option<(DVec2, DVec2)> {
    points.fold(None, |extent, p| {
        let (low, high) = extent.unwrap_or((p, p));
        Some((low.min(p), high.max(p)))
    })
}

impl Sheet {
    /// A page that holds all cells.
    pub fn of(graph: &CellGraph) -> Sheet {
        let extent = extent(graph.vertices.iter().map(Vertex::approx));
        let (low, high) = extent.unwrap_or((DVec2::ZERO, DVec2::new(4.0, 1.0)));
        Sheet::between(low, high)
    }

    /// A page that holds some points with what is around them; all cells, if that is not much more.
    pub fn around(graph: &CellGraph, points: impl Iterator<Item = DVec2>) -> Sheet {
        let whole = extent(graph.vertices.iter().map(Vertex::approx));
        let (Some((low, high)), Some((from, to))) = (whole, extent(points)) else {
            return Sheet::of(graph);
        };
        let margin = DVec2::splat((to - from).max_element() * MARGIN);
        let (from, to) = ((from - margin).max(low), (to + margin).min(high));
        let part = (to - from).max_element() / (high - low).max_element();
        if part > ENOUGH {
            return Sheet::between(low, high);
        }
        // Not flatter than half a square, so that there is something to see.
        let side = (to - from).max_element();
        let lacking = (DVec2::splat(side / 2.0) - (to - from)).max(DVec2::ZERO) / 2.0;
        Sheet::between((from - lacking).max(low), (to + lacking).min(high))
    }

    fn between(low: DVec2, high: DVec2) -> Sheet {
        let size = (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let scale = ((WIDTH - 2.0 * SIDE) / size.x).min(MAX_PLAN_HEIGHT / size.y);
        let left = (WIDTH - size.x * scale) / 2.0;
        Sheet {
            width: WIDTH,
            height: (TOP + size.y * scale + BOTTOM + ROW).ceil(),
            foot: TOP + size.y * scale + BOTTOM,
            scale,
            side: SIDE,
            origin: DVec2::new(left, TOP),
            corner: DVec2::new(low.x, high.y),
            plan: size * scale,
        }
    }

    /// Whether only a part of the plan is shown.
    pub fn is_part(&self, graph: &CellGraph) -> bool {
        let whole = Sheet::of(graph);
        (whole.scale, whole.corner) != (self.scale, self.corner)
    }

    /// The plan's upper left corner and its size, on the page.
    pub fn frame(&self) -> [DVec2; 2] {
        [self.origin, self.plan]
    }

    /// A place in grid steps on the page.
    pub fn at(&self, p: DVec2) -> DVec2 {
        let d = (p - self.corner) * self.scale;
        self.origin + DVec2::new(d.x, -d.y)
    }

    /// A vertex on the page.
    pub fn vertex(&self, graph: &CellGraph, v: VertexId) -> DVec2 {
        self.at(graph.vertices.approx(v))
    }
}

/// A coordinate on the page, to a hundredth.
pub fn short(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}

/// The data of an SVG path, from polygons and segments on the page.
#[derive(Clone, Debug, Default)]
pub struct PathData(pub String);

impl PathData {
    /// Adds a straight line.
    pub fn segment(&mut self, from: DVec2, to: DVec2) {
        self.chain(&[from, to]);
    }

    /// Adds a closed polygon.
    pub fn polygon(&mut self, points: &[DVec2]) {
        self.chain(points);
        self.0.push('Z');
    }

    fn chain(&mut self, points: &[DVec2]) {
        for (i, p) in points.iter().enumerate() {
            let letter = if i == 0 { 'M' } else { 'L' };
            _ = write!(self.0, "{letter}{} {}", short(p.x), short(p.y));
        }
    }
}
