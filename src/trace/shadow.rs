//! Shadow rays: what stands between a surface and a point light.
//!
//! In: a point on a surface and a point light with its cell, or a whole [`Patch`] of a picture. Out:
//! the surface in the way that is next to the point, if any. Source: lecture, "Shadows".
//!
//! A ray goes from the point to the light, walking from cell to cell as in [`super::cast`]; it never
//! asks the surface on which it starts. It has arrived in the light's cell, or where the light lies
//! before the edge at which it would leave a cell. Since all rays to one light pass through it, sides
//! are asked about the light: so the rays of a patch make a beam, as those of an eye do
//! ([`super::beam`]), and get the very answers of single rays.
//!
//! The corners of a patch's rectangle give the corners of a beam where the surface's plane is in front
//! of all of them. Points between lie in the hull of the corners' points, up to rounding: that of `t`
//! is the denominator's error over its least value, and is part of the beam's bound. Where that is too
//! large the beam parts, and in the end each point speaks for itself.

use fearless_simd::{Level, Simd, dispatch, f64x4, prelude::*};
use glam::DVec3;

use super::beam::area::{Area, Mask};
use super::beam::depth::{self, Plane};
use super::beam::engine::{self, At, Beam, End, Rays};
use super::beam::{Bundle, Fan, Patch};
use super::cast::{Place, Trail, edge_of, entry_of, face};
use super::layout::INSIDE;
use super::space::{Space, Surface};
use crate::cells::CellId;

/// Where a point light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// The light.
    pub at: DVec3,
    /// The cell in whose prism it is.
    pub cell: CellId,
}

/// What stands between a point and a light; `None` if the one sees the other. `start` is where the
/// point is, as for [`super::walk`].
pub fn blocker(space: &Space, point: DVec3, start: Place, lamp: &Lamp) -> Option<Surface> {
    let entry = entry_of(space, start).map(|e| e - space.cell(start.cell.0).first);
    let (mut cell, mut entry) = (start.cell.0, entry.unwrap_or(INSIDE));
    if let Some(on) = start
        .on
        .filter(|&on| is_behind(space, on, cell, entry, lamp))
    {
        return Some(on);
    }
    let (layout, d, o) = (&space.layout, lamp.at - point, lamp.at.truncate());
    let mut trail = Trail::NEW;
    while cell != lamp.cell.0 {
        let room = layout.room(cell);
        let (first, n) = match entry {
            INSIDE => (0, room.n),
            entry => (room.next(entry), room.n - 1),
        };
        let mut edge = first;
        let mut a = layout.corner(room, edge) - o;
        let mut from = d.x * a.y - d.y * a.x;
        let mut exit = None;
        for _ in 0..n {
            let b = layout.corner(room, room.next(edge)) - o;
            let to = d.x * b.y - d.y * b.x;
            if from < 0.0 && to >= 0.0 {
                exit = Some((a.x * b.y - a.y * b.x, to - from));
                break;
            }
            (a, from, edge) = (b, to, room.next(edge));
        }
        // Without an exit the ray goes straight up or down, or grazes its cell in a corner.
        let (across, width) = exit?;
        if across >= 0.0 {
            return None;
        }
        let z = (across / width).max(-1.0) * d.z + lamp.at.z;
        let gate = layout.gate(room, edge);
        if z < gate.low || z > gate.high {
            let (chamber, edge) = (space.cell(cell), room.first + edge);
            return if z < chamber.floor {
                Some(Surface::Floor(CellId(cell)))
            } else if z > chamber.ceiling {
                Some(Surface::Ceiling(CellId(cell)))
            } else {
                face(space.edge(edge), edge, z)
            };
        }
        (cell, entry) = (gate.cell, gate.entry);
        // In circles about a corner that it grazes (see [`super::cast`]).
        if trail.again(gate.twin) {
            return None;
        }
    }
    None
}

/// Whether a light lies behind a surface, which then is in its own light.
fn is_behind(space: &Space, on: Surface, cell: u32, entry: u32, lamp: &Lamp) -> bool {
    match on {
        Surface::Floor(id) => lamp.at.z < space.cell(id.0).floor,
        Surface::Ceiling(id) => lamp.at.z > space.cell(id.0).ceiling,
        Surface::Wall(_)
        | Surface::Step(_)
        | Surface::Lintel(_)
        | Surface::Pane(_)
        | Surface::Outside(_) => {
            let edge = space.edge(space.cell(cell).first + entry);
            let o = lamp.at.truncate();
            let (a, b) = (space.vertex(edge.from) - o, space.vertex(edge.to) - o);
            a.x * b.y - a.y * b.x < 0.0
        }
    }
}

/// What stands between each point of a patch and a light: `out` is told sets of pixels and their
/// [`blocker`]. The points are those of the rays at the `t` of [`Patch::depths`].
pub fn patch(
    space: &Space,
    bundle: &impl Bundle,
    patch: &Patch,
    lamp: &Lamp,
    mut out: impl FnMut(Area, Mask, Option<Surface>),
) {
    let Some((surface, cell)) = patch.met else {
        return;
    };
    let fan = bundle.fan();
    let first = space.cell(cell.0).first;
    let start = At {
        area: patch.area,
        mask: patch.mask,
        cell: cell.0,
        entry: edge_of(surface).map_or(INSIDE, |e| e - first),
        parted: 0,
    };
    if is_behind(space, surface, cell.0, start.entry, lamp) {
        return out(start.area, start.mask, Some(surface));
    }
    let rays = ToAPoint {
        fan: &fan,
        plane: Plane::of(space, &fan, surface),
        lamp,
        reach: fan.reach(&patch.area),
    };
    let mut tell = |area: Area, mask: Mask, end| match end {
        End::Meets(surface, _) => out(area, mask, Some(surface)),
        End::Arrives | End::Nothing => out(area, mask, None),
    };
    dispatch!(Level::new(), simd => engine::run(simd, space, &rays, start, &mut tell));
}

/// Rays from the points where a fan meets a plane.
struct ToAPoint<'a> {
    fan: &'a Fan,
    plane: Plane,
    lamp: &'a Lamp,
    /// No term of the fan's directions is larger.
    reach: f64,
}

/// A rounding.
const U: f64 = f64::EPSILON / 2.0;

impl Rays for ToAPoint<'_> {
    const ARRIVE: bool = true;

    #[inline(always)]
    fn point(&self) -> DVec3 {
        self.lamp.at
    }

    #[inline(always)]
    fn destination(&self) -> u32 {
        self.lamp.cell.0
    }

    #[inline(always)]
    fn beam(&self, area: &Area) -> Option<Beam> {
        let d = area.corners().map(|at| self.fan.direction(at));
        // t is above / below; below is linear in the place, up to an error.
        let (above, below, error) = match self.plane {
            Plane::Level(rise) => {
                let sign = 1f64.copysign(rise);
                (rise.abs(), d.map(|d| d.z * sign), 4.0 * U * self.reach)
            }
            Plane::Upright(a, b) => {
                let below = d.map(|d| (d.x * b.y - d.y * b.x) - (d.x * a.y - d.y * a.x));
                let size = a.abs().element_sum() + b.abs().element_sum();
                (a.x * b.y - a.y * b.x, below, 16.0 * U * self.reach * size)
            }
        };
        let least = below[0].min(below[1]).min(below[2].min(below[3]));
        if least <= 16.0 * error {
            return None;
        }
        let o = self.fan.origin;
        let [p, q, r, s] = std::array::from_fn(|k| d[k] * (above / below[k]));
        let far = p.abs().max(q.abs()).max(r.abs().max(s.abs())).max_element();
        let latest = above / least;
        let (here, lamp) = (o.abs().max_element(), self.lamp.at.abs().max_element());
        // How far a computed point may be from the hull of those of the corners.
        let off = 2.0
            * (far * (error / least + 4.0 * U)
                + 4.0 * U * self.reach * latest
                + 4.0 * U * (here + far));
        let rays = [p, q, r, s].map(|p| self.lamp.at - (o + p));
        Some(Beam {
            x: rays.map(|d| d.x),
            y: rays.map(|d| d.y),
            z: rays.map(|d| d.z),
            error: 8.0 * off + 32.0 * U * (here + far + lamp),
        })
    }

    #[inline(always)]
    fn four<S: Simd>(&self, simd: S, x: u32, y: u32) -> [f64x4<S>; 3] {
        let d = depth::directions(simd, self.fan, x, y);
        let t = self.plane.depths(simd, d);
        let (o, at) = (self.fan.origin, self.lamp.at);
        [
            f64x4::splat(simd, at.x) - (d[0] * t + o.x),
            f64x4::splat(simd, at.y) - (d[1] * t + o.y),
            f64x4::splat(simd, at.z) - (d[2] * t + o.z),
        ]
    }

    fn single(&self, _: u32, _: u32, _: u32, _: u32) -> End {
        End::Arrives
    }
}
