//! What is painted on.

use glam::DVec3;
use smallvec::SmallVec;

use super::border::{Border, Line};
use super::polygon::Polygon;
use crate::trace::beam::{Fan, middle};
use crate::trace::camera::Camera;
use crate::trace::space::{Space, Surface};

/// A picture in the making: rows from the top.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Linear RGB of each pixel; black where nothing was painted.
    pub colours: Vec<DVec3>,
    /// What was painted last on each pixel.
    pub surfaces: Vec<Option<Surface>>,
}

/// What a polygon puts on a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coat {
    /// A colour, whatever was there.
    Opaque(DVec3),
    /// A pane: this colour, and this share of what was there.
    Clear(DVec3, f64),
    /// Nothing: a hole.
    Hole,
}

impl Canvas {
    /// An empty canvas.
    pub fn new(size: [u32; 2]) -> Self {
        let n = size[0] as usize * size[1] as usize;
        Self {
            size,
            colours: vec![DVec3::ZERO; n],
            surfaces: vec![None; n],
        }
    }

    /// Paints a polygon that the camera sees from before. `coat` is asked for each pixel, with the
    /// ray's direction and the point that it meets. Returns how many pixels were painted, holes
    /// included.
    pub fn fill(
        &mut self,
        space: &Space,
        camera: &Camera,
        fan: &Fan,
        polygon: &Polygon,
        mut coat: impl FnMut(DVec3, DVec3) -> Coat,
    ) -> u64 {
        let Some(rows) = rows(space, camera, polygon) else {
            return 0;
        };
        let mut borders: SmallVec<[Border; 12]> = SmallVec::new();
        polygon.borders(space, camera.eye, &mut borders);
        let lines: SmallVec<[Line; 12]> = borders.iter().map(|b| Line::of(b, fan)).collect();
        let depth = Depth::of(space, camera.eye, polygon);
        let mut painted = 0;
        for y in rows.0..rows.1 {
            let mut columns = (0, self.size[0]);
            for line in &lines {
                columns = line.cut(y, columns);
                if columns.0 >= columns.1 {
                    break;
                }
            }
            let start = y as usize * self.size[0] as usize;
            for x in columns.0..columns.1 {
                let direction = fan.direction(middle(x, y));
                let point = camera.eye + direction * depth.at(direction);
                let i = start + x as usize;
                match coat(direction, point) {
                    Coat::Hole => continue,
                    Coat::Opaque(colour) => self.colours[i] = colour,
                    Coat::Clear(colour, share) => {
                        self.colours[i] = colour + self.colours[i] * share;
                    }
                }
                self.surfaces[i] = Some(polygon.surface);
            }
            painted += u64::from(columns.1.saturating_sub(columns.0));
        }
        painted
    }

    /// Pixels on which anything was painted.
    pub fn covered(&self) -> u64 {
        self.surfaces.iter().flatten().count() as u64
    }
}

/// How far along a ray a polygon's plane is.
#[derive(Clone, Copy, Debug)]
struct Depth {
    distance: f64,
    normal: DVec3,
}

impl Depth {
    fn of(space: &Space, eye: DVec3, polygon: &Polygon) -> Self {
        match polygon.surface {
            Surface::Floor(_) | Surface::Ceiling(_) => Self {
                distance: polygon.bottom - eye.z,
                normal: DVec3::Z,
            },
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                let o = eye.truncate();
                let (a, b) = (space.vertex(edge.from) - o, space.vertex(edge.to) - o);
                let along = b - a;
                Self {
                    distance: a.perp_dot(b),
                    normal: DVec3::new(along.y, -along.x, 0.0),
                }
            }
        }
    }

    #[inline]
    fn at(&self, direction: DVec3) -> f64 {
        self.distance / self.normal.dot(direction)
    }
}

/// The rows in which a polygon may show, at most one too many at either end; `None` if none does.
/// What lies behind the eye is clipped off first, at a plane near it: it has no row.
fn rows(space: &Space, camera: &Camera, polygon: &Polygon) -> Option<(u32, u32)> {
    let height = camera.size[1];
    if !(polygon.bottom.is_finite() && polygon.top.is_finite()) {
        return Some((0, height));
    }
    let mut corners: SmallVec<[DVec3; 12]> = SmallVec::new();
    polygon.corners(space, &mut corners);
    let seen: SmallVec<[DVec3; 12]> = corners.iter().map(|&c| camera.seen(c)).collect();
    // So near, a corner's row is anywhere. How near does not matter: it only costs rows.
    let farthest = seen.iter().fold(0.0f64, |m, p| m.max(p.z));
    let near = farthest * 1e-6;
    if farthest <= 0.0 {
        return None;
    }
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut reach = |p: DVec3| {
        let row = p.y / p.z;
        (least, most) = (least.min(row), most.max(row));
    };
    for (i, &p) in seen.iter().enumerate() {
        let q = seen[(i + 1) % seen.len()];
        if p.z >= near {
            reach(p);
        }
        if (p.z < near) != (q.z < near) {
            reach(p.lerp(q, (near - p.z) / (q.z - p.z)));
        }
    }
    // The rounding of a corner's row is far less than a row.
    let first = (least - 1.5).clamp(0.0, f64::from(height)) as u32;
    let past = (most + 1.5).clamp(0.0, f64::from(height)) as u32;
    (first < past).then_some((first, past))
}
