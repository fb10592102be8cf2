//! Lines over the view, whoever made the picture: borders of cells, the line of sight between two of
//! them, the way that is walked, the eye that was left behind when the choice was frozen.
//!
//! In: lines in space and the camera of the picture that is shown. Out: segments in the picture's pixels,
//! cut off at the eye and at the picture's border. Nothing hides them.

use eframe::egui;
use egui::{Color32, Pos2, Rect, Shape, Stroke};
use glam::{DVec2, DVec3};

use super::app::App;
use super::document::Document;
use super::plan::{CONE, SECOND, SIGHT, SOURCE, WALKED};
use crate::cells::CellId;
use crate::trace::camera::Camera;
use crate::walk::person::heights;

/// How far from the eye lines are cut off, as a share of a person's height.
const NEAR: f64 = 0.02;
/// How long the rays of an eye that was left behind are, as a number of a person's heights.
const REACH: f64 = 4.0;
/// More outlines than these would hide the picture.
const OUTLINES: usize = 600;

/// A line in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Ink {
    /// The points, straight from each to the next.
    pub points: Vec<DVec3>,
    /// What it looks like.
    pub stroke: Stroke,
}

impl Ink {
    fn new(points: impl IntoIterator<Item = DVec3>, width: f32, colour: Color32) -> Self {
        Self {
            points: points.into_iter().collect(),
            stroke: Stroke::new(width, colour),
        }
    }
}

/// The straight parts of a line as a camera sees them, in pixels from the picture's upper left corner.
/// What is nearer than `near`, and what lies outside of the picture, is cut off.
pub fn segments(points: &[DVec3], camera: &Camera, near: f64) -> Vec<[DVec2; 2]> {
    let size = DVec2::from_array(camera.size.map(f64::from));
    let part = |part: &[DVec3]| {
        // The place in the picture times the depth, and the depth.
        let [mut a, mut b] = [part[0], part[1]].map(|p| camera.seen(p));
        if a.z < near && b.z < near {
            return None;
        }
        let cut = |p: DVec3, q: DVec3| p.lerp(q, (near - p.z) / (q.z - p.z));
        if a.z < near {
            a = cut(a, b);
        } else if b.z < near {
            b = cut(b, a);
        }
        within([a, b].map(|p| p.truncate() / p.z), size)
    };
    points.windows(2).filter_map(part).collect()
}

/// The part of a line within the picture (Liang and Barsky 1984).
fn within([a, b]: [DVec2; 2], size: DVec2) -> Option<[DVec2; 2]> {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    let way = b - a;
    for k in 0..2 {
        for (slope, room) in [(-way[k], a[k]), (way[k], size[k] - a[k])] {
            if slope == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if slope < 0.0 {
                first = first.max(room / slope);
            } else {
                last = last.min(room / slope);
            }
        }
    }
    (first < last).then(|| [a + way * first, a + way * last])
}

/// A cell's floor, its ceiling and its upright edges.
fn prism(document: &Document, cell: CellId, width: f32, colour: Color32) -> Vec<Ink> {
    let [floor, ceiling] = heights(document.world.space.cell(cell.0));
    let corners = &document.plan.cells[cell.0 as usize];
    let ring = |z: f64| {
        let round = corners.iter().chain(corners.first());
        Ink::new(round.map(|p| p.extend(z)), width, colour)
    };
    let mut lines = vec![ring(floor), ring(ceiling)];
    let upright = |p: &DVec2| Ink::new([p.extend(floor), p.extend(ceiling)], width, colour);
    lines.extend(corners.iter().map(upright));
    lines
}

impl App {
    /// What lies over a picture of the document.
    pub(super) fn ink(&self, document: &Document) -> Vec<Ink> {
        let mut lines = Vec::new();
        let faint = CONE.gamma_multiply(0.8);
        if let Some(seen) = &self.seen
            && (self.settings.outlines || self.frozen.is_some())
        {
            for cell in seen.cells.iter().take(OUTLINES) {
                lines.extend(prism(document, *cell, 1.0, faint));
            }
        }
        for (cell, colour) in [(self.source, SOURCE), (self.second, SECOND)] {
            if let Some(cell) = cell {
                lines.extend(prism(document, cell, 2.0, colour));
            }
        }
        if let Some(explained) = self.explanation()
            && let Some(line) = explained.rise
        {
            lines.push(Ink::new(line, 3.0, SIGHT));
        }
        if let Some(play) = &self.play {
            let points = play.track.points().iter();
            // On the ground, where it hides less.
            let low = DVec3::Z * document.person.eye * 0.9;
            lines.push(Ink::new(points.map(|p| *p - low), 1.5, WALKED));
        }
        if let Some(camera) = &self.frozen {
            let reach = document.person.height * REACH;
            let [width, height] = camera.size.map(f64::from);
            let corner = |x: f64, y: f64| {
                let direction = camera.ray(DVec2::new(x, y)).direction;
                camera.eye + direction * reach
            };
            let corners = [
                corner(0.0, 0.0),
                corner(width, 0.0),
                corner(width, height),
                corner(0.0, height),
            ];
            let yellow = Color32::YELLOW;
            let rays = corners
                .iter()
                .map(|c| Ink::new([camera.eye, *c], 1.5, yellow));
            lines.extend(rays);
            let ring = corners.iter().chain(corners.first());
            lines.push(Ink::new(ring.copied(), 1.5, yellow));
        }
        if let Some(mark) = self.mark
            && let Some(cell) = document.cell_at(mark)
        {
            let [floor, ceiling] = heights(document.world.space.cell(cell.0));
            let pole = [mark.extend(floor), mark.extend(ceiling)];
            lines.push(Ink::new(pole, 3.0, Color32::RED));
        }
        lines
    }

    /// Draws it over the picture, which fills `rect`.
    pub(super) fn overlay(&self, painter: &egui::Painter, rect: Rect) {
        let (Some(document), Some(seen)) = (&self.document, &self.seen) else {
            return;
        };
        let camera = &seen.look.camera;
        let near = document.person.height * NEAR;
        let scale = rect.size() / egui::vec2(camera.size[0] as f32, camera.size[1] as f32);
        let place = |p: DVec2| -> Pos2 { rect.min + egui::vec2(p.x as f32, p.y as f32) * scale };
        for line in self.ink(document) {
            for ends in segments(&line.points, camera, near) {
                painter.add(Shape::line_segment(ends.map(place), line.stroke));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_at_the_eye_and_at_the_border() {
        let camera = Camera::new(DVec3::ZERO, DVec3::Y, 90.0, [200, 100]);
        let seen =
            |from: [f64; 3], to: [f64; 3]| segments(&[from.into(), to.into()], &camera, 0.01);
        // Across the middle of the picture, from a quarter of its width to three.
        let across = seen([-1.0, 2.0, 0.0], [1.0, 2.0, 0.0]);
        let ends = across[0];
        assert!(ends[0].distance(DVec2::new(50.0, 50.0)) < 1e-9, "{ends:?}");
        assert!(ends[1].distance(DVec2::new(150.0, 50.0)) < 1e-9, "{ends:?}");
        // From behind the eye to before it: it comes from the border.
        let through = seen([0.1, -5.0, -0.1], [0.1, 5.0, -0.1]);
        let size = DVec2::new(200.0, 100.0);
        assert_eq!(through.len(), 1);
        for p in through[0] {
            assert!(
                p.cmpge(DVec2::splat(-1e-9)).all() && p.cmple(size + 1e-9).all(),
                "{p}"
            );
        }
        assert!((through[0][0].y - 100.0).abs() < 1e-9);
        // All behind, and all beside.
        assert!(seen([0.1, -5.0, 0.0], [0.1, -1.0, 0.0]).is_empty());
        assert!(seen([9.0, 2.0, 0.0], [9.0, 3.0, 0.0]).is_empty());
        // Three points are two parts.
        let corner = [
            DVec3::new(-1.0, 2.0, 0.0),
            DVec3::new(0.0, 2.0, 0.0),
            DVec3::new(0.0, 2.0, 0.5),
        ];
        assert_eq!(segments(&corner, &camera, 0.01).len(), 2);
    }
}
