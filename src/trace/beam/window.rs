//! At most 8 × 8 rays that part: each of them by itself to the end of the cell, four in a vector.
//!
//! In: a set of pixels whose rays have come to a cell. Out: which of them end, and sets of those that
//! go on. Every number is computed as for a single ray, so it is the same number.

use fearless_simd::{Simd, f64x4, prelude::*};
use glam::DVec2;
use smallvec::SmallVec;

use super::area::{Area, Mask};
use super::engine::{At, End, Rays, side};
use crate::cells::{CellId, EdgeId};
use crate::trace::layout::INSIDE;
use crate::trace::space::{Space, Surface, WALL};

/// A number for every pixel of a window: row by row, each as two halves of four.
type Eight<S> = [[f64x4<S>; 2]; 8];

/// Numbers of a window's pixels.
struct Window<S: Simd> {
    /// Rows, and half rows of four.
    height: usize,
    halves: usize,
    x: Eight<S>,
    y: Eight<S>,
    z: Eight<S>,
    /// Heights at an edge.
    at: Eight<S>,
}

impl<S: Simd> Window<S> {
    /// The directions.
    #[inline(always)]
    fn aim<R: Rays>(&mut self, simd: S, rays: &R, area: &Area) {
        for row in 0..self.height {
            for half in 0..self.halves {
                let (x, y) = (area.x.0 + 4 * half as u32, area.y.0 + row as u32);
                let d = rays.four(simd, x, y);
                (self.x[row][half], self.y[row][half], self.z[row][half]) = (d[0], d[1], d[2]);
            }
        }
    }

    /// Which rays pass a corner on its left.
    #[inline(always)]
    fn right(&self, v: DVec2) -> u64 {
        let mut bits = 0;
        for row in 0..self.height {
            for half in 0..self.halves {
                let side = side(self.x[row][half], self.y[row][half], v);
                bits |= side.simd_lt(0.0).to_bitmask() << (8 * row + 4 * half);
            }
        }
        bits
    }

    /// Puts the heights at the edge from a to b into `at`.
    #[inline(always)]
    fn cross(&mut self, simd: S, a: DVec2, b: DVec2, least: f64, from: f64) {
        let across = f64x4::splat(simd, a.x * b.y - a.y * b.x);
        let least = f64x4::splat(simd, least);
        for row in 0..self.height {
            for half in 0..self.halves {
                let (x, y) = (self.x[row][half], self.y[row][half]);
                let t = (across / (side(x, y, b) - side(x, y, a))).max(least);
                self.at[row][half] = t * self.z[row][half] + from;
            }
        }
    }

    /// Which rays are below a height there.
    #[inline(always)]
    fn below(&self, height: f64) -> u64 {
        let mut bits = 0;
        for row in 0..self.height {
            for half in 0..self.halves {
                let below = self.at[row][half].simd_lt(height);
                bits |= below.to_bitmask() << (8 * row + 4 * half);
            }
        }
        bits
    }

    /// Which rays are above.
    #[inline(always)]
    fn above(&self, height: f64) -> u64 {
        let mut bits = 0;
        for row in 0..self.height {
            for half in 0..self.halves {
                let above = self.at[row][half].simd_gt(height);
                bits |= above.to_bitmask() << (8 * row + 4 * half);
            }
        }
        bits
    }
}

/// Takes every ray of a window to the end of its cell, as a single ray would go.
#[inline(always)]
pub(super) fn window<S: Simd, R: Rays>(
    simd: S,
    space: &Space,
    rays: &R,
    start: &At,
    at: &At,
    pending: &mut SmallVec<[At; 32]>,
    out: &mut impl FnMut(Area, Mask, End),
) {
    let layout = &space.layout;
    let (area, room, o) = (at.area, layout.room(at.cell), rays.point());
    let whole = Mask::whole(&area);
    let mut under_way = at.mask.0 & whole;
    let mut tell = |bits: u64, end: End| {
        if bits != 0 {
            let (area, mask) = Mask::trim(bits, &area);
            out(area, mask, end);
        }
    };
    if R::ARRIVE && at.cell == rays.destination() {
        return tell(under_way, End::Arrives);
    }
    if at.parted as usize > space.cells.len() {
        // Single rays get out of their circles: from where they started, so that they go the same way.
        return singly(rays, &area, start, under_way, &mut tell);
    }
    let zero = f64x4::splat(simd, 0.0);
    let mut window = Window {
        height: area.height() as usize,
        halves: area.width().div_ceil(4) as usize,
        x: [[zero; 2]; 8],
        y: [[zero; 2]; 8],
        z: [[zero; 2]; 8],
        at: [[zero; 2]; 8],
    };
    window.aim(simd, rays, &area);
    let (mut edge, n) = match at.entry {
        INSIDE => (0, room.n),
        entry => (room.next(entry), room.n - 1),
    };
    let mut a = layout.corner(room, edge) - o.truncate();
    let mut right = window.right(a);
    for _ in 0..n {
        let next = room.next(edge);
        let b = layout.corner(room, next) - o.truncate();
        let to_the_right = window.right(b);
        let exits = right & !to_the_right & under_way;
        if exits != 0 {
            under_way &= !exits;
            let across = a.x * b.y - a.y * b.x;
            if R::ARRIVE && across >= 0.0 {
                tell(exits, End::Arrives);
            } else {
                window.cross(simd, a, b, if R::ARRIVE { -1.0 } else { 0.0 }, o.z);
                let gate = layout.gate(room, edge);
                let stopped = exits & (window.below(gate.low) | window.above(gate.high));
                let through = exits & !stopped;
                if through != 0 {
                    let (area, mask) = Mask::trim(through, &area);
                    let (cell, entry) = (gate.cell, gate.entry);
                    pending.push(At {
                        area,
                        mask,
                        cell,
                        entry,
                        parted: at.parted + 1,
                    });
                }
                if stopped != 0 {
                    let id = room.first + edge;
                    sort(space, at.cell, id, stopped, &window, &mut tell);
                }
            }
        }
        if under_way == 0 {
            return;
        }
        (edge, a, right) = (next, b, to_the_right);
    }
    // Straight up or down, or grazing the cell in a corner.
    singly(rays, &area, at, under_way, &mut tell);
}

/// Tells how some rays of a window end, each asked by itself from some place on.
fn singly<R: Rays>(
    rays: &R,
    window: &Area,
    from: &At,
    mut rest: u64,
    tell: &mut impl FnMut(u64, End),
) {
    while rest != 0 {
        let bit = rest.trailing_zeros();
        let (x, y) = (window.x.0 + bit % 8, window.y.0 + bit / 8);
        tell(1 << bit, rays.single(x, y, from.cell, from.entry));
        rest &= rest - 1;
    }
}

/// What stops rays at an edge of a cell.
#[inline(always)]
fn sort<S: Simd>(
    space: &Space,
    cell: u32,
    edge: u32,
    stopped: u64,
    window: &Window<S>,
    tell: &mut impl FnMut(u64, End),
) {
    let (chamber, border) = (space.cell(cell), space.edge(edge));
    let mut rest = stopped;
    let mut tell = |bits: u64, surface: Surface| {
        tell(rest & bits, End::Meets(surface, cell));
        rest &= !bits;
    };
    tell(window.below(chamber.floor), Surface::Floor(CellId(cell)));
    tell(
        window.above(chamber.ceiling),
        Surface::Ceiling(CellId(cell)),
    );
    let id = EdgeId(edge);
    if border.twin == WALL {
        if border.outside {
            tell(window.below(border.bottom), Surface::Wall(id));
            tell(window.above(border.top), Surface::Wall(id));
            // An opening that is shut lets nothing out.
            if border.bottom <= border.top {
                tell(u64::MAX, Surface::Outside(id));
            }
        }
        return tell(u64::MAX, Surface::Wall(id));
    }
    tell(window.below(border.bottom), Surface::Step(id));
    tell(window.above(border.top), Surface::Lintel(id));
    tell(u64::MAX, Surface::Pane(id));
}
