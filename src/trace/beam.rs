//! Many rays from one point at once: what a whole rectangle of a picture meets.
//!
//! In: a [`Space`], a point, and directions that change linearly over a rectangle of pixels. Out:
//! for every pixel the same [`super::Met`] that [`super::cast::walk`] gives, to the last bit.
//!
//! On which side of a corner a ray passes on the plan, and whether it passes above or below a height
//! on an edge's line, are signs of expressions that are linear in the ray's direction. So if they
//! are the same at the four corners of a rectangle, they are the same in all of it: the corners'
//! rays leave a cell by the same portal, or end on the same surface, and so do all rays between.
//! Where they differ the rectangle is halved, down to 8 × 8 pixels, and goes on in the cell where it
//! is. The rays of such a window are asked one by one, four in each vector, and go on as the sets of
//! those that do the same, each of them again as one rectangle as long as that does not part.
//!
//! A sign counts only where it is larger than what rounding can have done, in the corners and
//! between; pixel by pixel it is what a single ray computes. So speed never changes a picture.
//!
//! | file | what |
//! |---|---|
//! | [`area`] | rectangles, and sets of pixels in them |
//! | `engine` | the walk, for rays from a point and rays to a point ([`super::shadow`]) |
//! | `window` | rays that part, pixel by pixel |
//! | `depth` | how far the rays go to a surface that all meet |

pub mod area;
pub(super) mod depth;
pub(super) mod engine;
mod window;

use fearless_simd::{Level, Simd, dispatch};
use glam::{DVec2, DVec3};

pub use area::{Area, Mask, middle};

use super::cast::walk_on;
use super::layout::INSIDE;
use super::ray::Ray;
use super::space::{Space, Surface};
use crate::cells::CellId;
use engine::{At, Beam, End, Rays};

/// Rays from one point whose directions are linear in the place on a picture, in pixels from its
/// upper left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// The point.
    pub origin: DVec3,
    /// The direction through the upper left corner.
    pub corner: DVec3,
    /// What a pixel to the right adds.
    pub across: DVec3,
    /// What a pixel downwards adds.
    pub down: DVec3,
}

impl Fan {
    /// The direction through a place of the picture.
    #[inline]
    pub fn direction(&self, at: DVec2) -> DVec3 {
        (self.corner + self.down * at.y) + self.across * at.x
    }

    /// The ray through the middle of a pixel.
    #[inline]
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        Ray {
            origin: self.origin,
            direction: self.direction(middle(x, y)),
        }
    }

    /// No term of a direction is larger, up to this place of the picture.
    pub(super) fn reach(&self, area: &Area) -> f64 {
        let most = self.corner.abs()
            + self.down.abs() * f64::from(area.y.1)
            + self.across.abs() * f64::from(area.x.1);
        most.max_element()
    }
}

/// Whatever has such rays.
pub trait Bundle {
    /// The rays.
    fn fan(&self) -> Fan;
}

impl Bundle for Fan {
    fn fan(&self) -> Fan {
        *self
    }
}

/// Pixels whose rays meet the same surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The smallest rectangle around them.
    pub area: Area,
    /// Which of its pixels.
    pub mask: Mask,
    /// The surface, and the cell from which it is seen; `None` where rays meet nothing.
    pub met: Option<(Surface, CellId)>,
}

impl Patch {
    /// How far each ray of the area goes to the surface, row after row; beside the mask there are
    /// numbers of no meaning. Nothing if the rays meet nothing.
    pub fn depths(&self, space: &Space, bundle: &impl Bundle, depths: &mut Vec<f64>) {
        depths.clear();
        if let Some((surface, _)) = self.met {
            let (fan, area) = (bundle.fan(), self.area);
            dispatch!(Level::new(), simd => {
                depth::fill(simd, space, &fan, &area, surface, depths);
            });
        }
    }
}

/// What every pixel's ray meets, of those of `area`; `out` is told the pixels in patches, in no
/// order. `start` is the cell of the origin.
pub fn patches(
    space: &Space,
    bundle: &impl Bundle,
    start: CellId,
    area: Area,
    mut out: impl FnMut(Patch),
) {
    let fan = bundle.fan();
    dispatch!(Level::new(), simd => from_a_point(simd, space, &fan, start, area, |patch, _| out(patch), false));
}

/// As [`patches`], and with the `t` of the rays: those of [`Patch::depths`].
pub fn cast_patches(
    space: &Space,
    bundle: &impl Bundle,
    start: CellId,
    area: Area,
    mut out: impl FnMut(Patch, &[f64]),
) {
    let fan = bundle.fan();
    dispatch!(Level::new(), simd => from_a_point(simd, space, &fan, start, area, &mut out, true));
}

/// As [`cast_patches`], but `out` is told the pixels in rectangles: each with one surface, seen from
/// one cell, and the `t` of its rays, row after row; or pixels that meet nothing.
pub fn cast(
    space: &Space,
    bundle: &impl Bundle,
    start: CellId,
    area: Area,
    mut out: impl FnMut(Area, Option<(Surface, CellId)>, &[f64]),
) {
    cast_patches(space, bundle, start, area, |patch, depths| {
        let width = patch.area.width() as usize;
        patch.mask.rectangles(&patch.area, |area| {
            if patch.met.is_none() {
                return out(area, None, &[]);
            }
            let first = (area.y.0 - patch.area.y.0) as usize * width;
            let first = first + (area.x.0 - patch.area.x.0) as usize;
            out(area, patch.met, &depths[first..first + area.len()]);
        });
    });
}

#[inline(always)]
fn from_a_point<S: Simd>(
    simd: S,
    space: &Space,
    fan: &Fan,
    start: CellId,
    area: Area,
    mut out: impl FnMut(Patch, &[f64]),
    with_depths: bool,
) {
    let rays = FromAPoint {
        space,
        fan,
        error: fan.reach(&area) * engine::ROUNDING,
    };
    let mut depths = Vec::new();
    let start = At {
        area,
        mask: Mask::ALL,
        cell: start.0,
        entry: INSIDE,
        parted: 0,
    };
    engine::run(simd, space, &rays, start, &mut |area, mask, end| {
        let met = match end {
            End::Meets(surface, cell) => Some((surface, CellId(cell))),
            End::Nothing | End::Arrives => None,
        };
        let t = match met {
            Some((surface, _)) if with_depths => {
                depth::fill(simd, space, fan, &area, surface, &mut depths)
            }
            _ => &[],
        };
        out(Patch { area, mask, met }, t);
    });
}

/// The rays of a fan.
struct FromAPoint<'a> {
    space: &'a Space,
    fan: &'a Fan,
    /// More than rounding can do to a direction, many times over.
    error: f64,
}

impl Rays for FromAPoint<'_> {
    const ARRIVE: bool = false;

    #[inline(always)]
    fn point(&self) -> DVec3 {
        self.fan.origin
    }

    #[inline(always)]
    fn beam(&self, area: &Area) -> Option<Beam> {
        let d = area.corners().map(|at| self.fan.direction(at));
        Some(Beam {
            x: d.map(|d| d.x),
            y: d.map(|d| d.y),
            z: d.map(|d| d.z),
            error: self.error,
        })
    }

    #[inline(always)]
    fn four<S: Simd>(&self, simd: S, x: u32, y: u32) -> [fearless_simd::f64x4<S>; 3] {
        depth::directions(simd, self.fan, x, y)
    }

    fn single(&self, x: u32, y: u32, cell: u32, entry: u32) -> End {
        let first = self.space.cell(cell).first;
        let entry = (entry != INSIDE).then(|| first + entry);
        match walk_on(self.space, &self.fan.ray(x, y), CellId(cell), entry) {
            Some(met) => End::Meets(met.surface, met.cell.0),
            None => End::Nothing,
        }
    }
}

#[cfg(test)]
mod tests;
