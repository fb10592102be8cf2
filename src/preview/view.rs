//! A camera made ready, and polygons as it sees them: rows, columns, borders and depth, all linear over
//! the picture.

use glam::DVec3;
use smallvec::SmallVec;

use super::border::{Border, Line};
use super::coat::{Coat, Coats, Map, Stuff};
use super::polygon::Polygon;
use crate::trace::beam::{Bundle, Fan, middle};
use crate::trace::camera::Camera;
use crate::trace::space::{Space, Surface};

/// A camera made ready.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// The eye.
    pub eye: DVec3,
    /// Directions through the picture.
    pub fan: Fan,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Products with a point's way from the eye give column and row, times the depth, and the depth.
    seen: [DVec3; 3],
}

/// A number that is linear over the picture: at the middle of pixel (x, y) it is
/// `slope[0]·x + (slope[1]·y + at)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Linear {
    /// What a pixel to the right adds, and one downwards.
    pub slope: [f64; 2],
    /// In the first pixel.
    pub at: f64,
}

impl Linear {
    /// A product with the direction.
    #[inline]
    fn of(normal: DVec3, fan: &Fan) -> Self {
        Self {
            slope: [normal.dot(fan.across), normal.dot(fan.down)],
            at: normal.dot(fan.direction(middle(0, 0))),
        }
    }

    /// In the first pixel of a row.
    #[inline(always)]
    pub fn row(&self, y: u32) -> f64 {
        self.slope[1] * f64::from(y) + self.at
    }
}

/// Where pixels lie on a picture: `start + way / q`, q being one over the depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lay {
    /// Across and down, in repetitions.
    pub way: [Linear; 2],
    /// Of the eye.
    pub start: [f64; 2],
}

/// A polygon as a camera sees it.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Its number.
    pub polygon: u32,
    /// What it is painted with.
    pub coat: &'a Coat,
    /// Rows in which it may show.
    pub rows: (u32, u32),
    /// Columns in which it may show.
    columns: (u32, u32),
    /// Its borders: a stretch of a list of lines.
    lines: (u32, u32),
    /// One over the depth.
    pub nearness: Linear,
    /// Where its picture lies, if it has one.
    pub lay: Lay,
    /// Its light: see [`Coats::fade`].
    pub fade: [f64; 3],
}

impl View {
    /// Makes a camera ready.
    pub fn new(camera: &Camera) -> Self {
        let fan = camera.fan();
        let [width, height] = camera.size.map(f64::from);
        let (right, up) = (fan.across * (width / 2.0), fan.down * (height / -2.0));
        let towards = fan.corner + right - up;
        let half = |axis: DVec3| axis / axis.length_squared();
        Self {
            eye: camera.eye,
            fan,
            size: camera.size,
            seen: [
                (towards + half(right)) * (width / 2.0),
                (towards - half(up)) * (height / 2.0),
                towards,
            ],
        }
    }

    /// The rows and columns in which a convex set of points may show, one or two too many at either end;
    /// `None` if there are none. What lies behind the eye is clipped off at a plane near it: the sides of
    /// a `closed` outline, or else whatever joins two of the points.
    pub fn window(&self, corners: &[DVec3], closed: bool) -> Option<((u32, u32), (u32, u32))> {
        let seen: SmallVec<[DVec3; 12]> = (corners.iter())
            .map(|&c| {
                let to = c - self.eye;
                DVec3::from_array(self.seen.map(|axis| axis.dot(to)))
            })
            .collect();
        // So near, a corner's place is anywhere. How near does not matter: it only costs rows.
        let farthest = seen.iter().fold(0.0f64, |m, p| m.max(p.z));
        let near = farthest * 1e-6;
        if farthest <= 0.0 {
            return None;
        }
        let mut least = [f64::INFINITY; 2];
        let mut most = [f64::NEG_INFINITY; 2];
        let mut reach = |p: DVec3| {
            let over = p.z.recip();
            for (k, at) in [p.x * over, p.y * over].into_iter().enumerate() {
                least[k] = least[k].min(at);
                most[k] = most[k].max(at);
            }
        };
        let n = seen.len();
        for (i, &p) in seen.iter().enumerate() {
            if p.z >= near {
                reach(p);
            }
            // Of points in no order, every pair may be joined.
            let others = if closed { i + 1..i + 2 } else { i + 1..n };
            for q in others.map(|k| seen[k % n]) {
                if (p.z < near) != (q.z < near) {
                    reach(p.lerp(q, (near - p.z) / (q.z - p.z)));
                }
            }
        }
        // The rounding of a corner's place is far less than a pixel.
        let range = |k: usize| {
            let size = f64::from(self.size[k]);
            let first = (least[k] - 1.5).clamp(0.0, size) as u32;
            let past = (most[k] + 1.5).clamp(0.0, size) as u32;
            (first < past).then_some((first, past))
        };
        Some((range(1)?, range(0)?))
    }

    /// A polygon that the eye is before, if it may show. Its borders are added to `lines`.
    pub fn show<'a>(
        &self,
        space: &Space,
        (number, polygon): (u32, &Polygon),
        (coats, coat): (&Coats, &'a Coat),
        lines: &mut Vec<Line>,
    ) -> Option<Shown<'a>> {
        let mut corners: SmallVec<[DVec3; 12]> = SmallVec::new();
        polygon.corners(space, &mut corners);
        let (rows, columns) = self.window(&corners, true)?;
        let first = lines.len() as u32;
        let mut borders: SmallVec<[Border; 12]> = SmallVec::new();
        polygon.borders(space, self.eye, &mut borders);
        lines.extend(borders.iter().map(|b| Line::of(b, &self.fan)));
        let (distance, normal) = plane(space, self.eye, polygon);
        let lay = match &coat.stuff {
            Stuff::Picture(map) | Stuff::Grating(map) | Stuff::Stained(map) => self.lay(map),
            _ => Lay::default(),
        };
        Some(Shown {
            polygon: number,
            coat,
            rows,
            columns,
            lines: (first, lines.len() as u32),
            nearness: Linear::of(normal / distance, &self.fan),
            lay,
            fade: coats.fade(coat.light),
        })
    }

    fn lay(&self, map: &Map) -> Lay {
        let start = |axis: DVec3, at: f64| {
            let whole = axis.dot(self.eye) + at;
            // Near zero there are more digits behind the point.
            whole - whole.floor()
        };
        let way = [map.across, map.down].map(|axis| Linear::of(axis, &self.fan));
        // What is not repeated downwards needs its own number.
        let down = map.down.dot(self.eye) + map.at.y;
        Lay {
            way,
            start: [start(map.across, map.at.x), down],
        }
    }
}

impl Shown<'_> {
    /// The columns that belong to the polygon in a row.
    #[inline(always)]
    pub fn columns(&self, lines: &[Line], y: u32) -> (u32, u32) {
        let mut columns = self.columns;
        for line in &lines[self.lines.0 as usize..self.lines.1 as usize] {
            columns = line.cut(y, columns);
            if columns.0 >= columns.1 {
                break;
            }
        }
        columns
    }
}

/// The plane of a polygon: points eye + d·t with `t · (normal · d) = distance`, the distance positive for
/// an eye before it.
fn plane(space: &Space, eye: DVec3, polygon: &Polygon) -> (f64, DVec3) {
    match polygon.surface {
        Surface::Floor(_) | Surface::Ceiling(_) => (polygon.bottom - eye.z, DVec3::Z),
        Surface::Wall(e)
        | Surface::Step(e)
        | Surface::Lintel(e)
        | Surface::Pane(e)
        | Surface::Outside(e) => {
            let edge = space.edge(e.0);
            let o = eye.truncate();
            let (a, b) = (space.vertex(edge.from) - o, space.vertex(edge.to) - o);
            let along = b - a;
            (a.perp_dot(b), DVec3::new(along.y, -along.x, 0.0))
        }
    }
}
