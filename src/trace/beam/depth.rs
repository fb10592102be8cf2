//! How far the rays of a fan go to a surface that all of a rectangle meet.

use fearless_simd::{Simd, f64x4, prelude::*};
use glam::DVec2;

use super::{Area, Fan};
use crate::trace::space::{Space, Surface};

/// The directions through four pixels side by side.
#[inline(always)]
pub fn directions<S: Simd>(simd: S, fan: &Fan, x: u32, y: u32) -> [f64x4<S>; 3] {
    let x = f64x4::simd_from(simd, [0.5, 1.5, 2.5, 3.5]) + f64::from(x);
    let row = fan.corner + fan.down * (f64::from(y) + 0.5);
    [
        x * fan.across.x + row.x,
        x * fan.across.y + row.y,
        x * fan.across.z + row.z,
    ]
}

/// A surface as seen from a fan's point.
#[derive(Clone, Copy)]
pub enum Plane {
    /// So much higher than the point.
    Level(f64),
    /// Upright between these ends on the plan, relative to the point.
    Upright(DVec2, DVec2),
}

impl Plane {
    /// That of a surface.
    #[inline]
    pub fn of(space: &Space, fan: &Fan, surface: Surface) -> Self {
        match surface {
            Surface::Floor(id) => Self::Level(space.cell(id.0).floor - fan.origin.z),
            Surface::Ceiling(id) => Self::Level(space.cell(id.0).ceiling - fan.origin.z),
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let (edge, o) = (space.edge(e.0), fan.origin.truncate());
                Self::Upright(space.vertex(edge.from) - o, space.vertex(edge.to) - o)
            }
        }
    }

    /// The `t` of rays in these directions, as [`crate::trace::cast`] computes it.
    #[inline(always)]
    pub fn depths<S: Simd>(&self, simd: S, d: [f64x4<S>; 3]) -> f64x4<S> {
        let (above, below) = match *self {
            Self::Level(rise) => (rise, d[2]),
            Self::Upright(a, b) => {
                let to = d[0] * b.y - d[1] * b.x;
                let from = d[0] * a.y - d[1] * a.x;
                (a.x * b.y - a.y * b.x, to - from)
            }
        };
        let zero = f64x4::splat(simd, 0.0);
        (f64x4::splat(simd, above) / below).max(zero)
    }
}

/// How far each ray of a rectangle goes, row after row; `depths` is room for it.
#[inline(always)]
pub fn fill<'a, S: Simd>(
    simd: S,
    space: &Space,
    fan: &Fan,
    area: &Area,
    surface: Surface,
    depths: &'a mut Vec<f64>,
) -> &'a [f64] {
    let plane = Plane::of(space, fan, surface);
    let n = area.len();
    if depths.len() < n {
        depths.resize(n, 0.0);
    }
    simd.vectorize(
        #[inline(always)]
        || rows(simd, fan, &plane, area, &mut depths[..n]),
    );
    &depths[..n]
}

#[inline(always)]
fn rows<S: Simd>(simd: S, fan: &Fan, plane: &Plane, area: &Area, depths: &mut [f64]) {
    let width = area.width() as usize;
    for (row, y) in depths.chunks_exact_mut(width).zip(area.y.0..) {
        let mut x = area.x.0;
        let (fours, rest) = row.as_chunks_mut::<4>();
        for four in fours {
            *four = *plane.depths(simd, directions(simd, fan, x, y));
            x += 4;
        }
        if !rest.is_empty() {
            let t: [f64; 4] = *plane.depths(simd, directions(simd, fan, x, y));
            for (one, t) in rest.iter_mut().zip(t) {
                *one = t;
            }
        }
    }
}
