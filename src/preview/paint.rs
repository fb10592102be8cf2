//! Everything in order, and what it costs.

use glam::DVec3;

use super::canvas::{Canvas, Coat};
use super::polygon::Polygons;
use crate::cells::{CellId, Tree};
use crate::geom::Vertex;
use crate::trace::beam::Bundle;
use crate::trace::camera::Camera;
use crate::trace::space::{Space, Surface};

/// What a painted picture cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Cells that were painted.
    pub cells: u64,
    /// Polygons of these cells.
    pub polygons: u64,
    /// Those that the eye is before, which were painted; the others show their backs.
    pub painted: u64,
    /// Triangles of the cells' polygons, as a graphics card would count.
    pub triangles: u64,
    /// Pixels that were painted, each as often as that was done.
    pub pixels: u64,
    /// Pixels on which something was painted.
    pub covered: u64,
}

impl Figures {
    /// How often a pixel was painted on average; 1 is the least.
    pub fn overdraw(&self) -> f64 {
        self.pixels as f64 / self.covered.max(1) as f64
    }
}

/// Paints the cells for which `wanted` holds, the farthest first. `eye` is the place of the camera on
/// the plan, exactly; the camera stands there to within rounding. `coat` says what a surface puts on
/// a pixel: it is given the surface, the ray's direction, and the point.
///
/// O(cells + pixels painted).
pub fn paint(
    (space, polygons, tree): (&Space, &Polygons, &Tree),
    (camera, eye): (&Camera, &Vertex),
    wanted: impl Fn(CellId) -> bool,
    mut coat: impl FnMut(Surface, DVec3, DVec3) -> Coat,
    canvas: &mut Canvas,
) -> Figures {
    let mut figures = Figures::default();
    let fan = camera.fan();
    tree.back_to_front(eye, |cell| {
        if !wanted(cell) {
            return;
        }
        figures.cells += 1;
        figures.triangles += u64::from(polygons.triangles_in(cell));
        let list = polygons.in_cell(cell);
        figures.polygons += list.len() as u64;
        for polygon in list {
            if polygon.before(space, camera.eye) <= 0.0 {
                continue;
            }
            figures.painted += 1;
            let coat = |direction, point| coat(polygon.surface, direction, point);
            figures.pixels += canvas.fill(space, camera, &fan, polygon, coat);
        }
    });
    figures.covered = canvas.covered();
    figures
}
