//! The walk of rectangles of rays from cell to cell.
//!
//! In: [`Rays`] whose lines all pass through one point, and the cell where they start. Out: for each
//! set of pixels how their rays end. Rays may come from the point (`t` counts from it, upwards from
//! 0), or go to it: then they start at t = -1 and arrive at 0. All signs are about the point.
//!
//! # Bounds
//!
//! With u = 2^-53 and S no less than any term of a direction: a component of a direction is off by
//! at most 4u·S from what is linear in the place, and a side d × (v - o) by 8u·S·|v - o|₁. A corner's
//! value is taken for certain beyond 32u·S·|v - o|₁, so an inner pixel's true value is beyond 24 and
//! the one computed beyond 16 of these. Whether a ray passes above a height h on the edge from a to b
//! is the sign of across·dz - (h - oz)·(to - from), across = a × b: its error, and that of the height
//! that a single ray computes by way of `t`, is below 40u·S·s·(s + |h| + |oz|) with s = |a| + |b| + |o|,
//! and 256u is asked for. For rays to a point, [`Beam::error`] also holds how far the computed points
//! are from the hull of the corners.

use fearless_simd::{Simd, f64x4, prelude::*};
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::area::{Area, Mask};
use super::window::window;
use crate::cells::{CellId, EdgeId};
use crate::trace::layout::{Gate, INSIDE, MOST, Room, Turn};
use crate::trace::space::{Space, Surface, WALL};

/// 32u, see above.
pub const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

/// A rectangle's corner rays.
#[derive(Clone, Copy)]
pub struct Beam {
    /// Their directions.
    pub x: [f64; 4],
    pub y: [f64; 4],
    pub z: [f64; 4],
    /// More than any component of a direction in the rectangle is off, 8 times over.
    pub error: f64,
}

/// How a ray ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// On a surface, seen from this cell.
    Meets(Surface, u32),
    /// At the point to which it goes.
    Arrives,
    /// Nowhere.
    Nothing,
}

/// The rays of a picture whose lines pass through one point.
pub trait Rays {
    /// Whether they go to the point (or else come from it).
    const ARRIVE: bool;
    /// The point.
    fn point(&self) -> DVec3;
    /// The corner rays of a rectangle; `None` if they say nothing of those between.
    fn beam(&self, area: &Area) -> Option<Beam>;
    /// The directions of four pixels side by side.
    fn four<S: Simd>(&self, simd: S, x: u32, y: u32) -> [f64x4<S>; 3];
    /// How one pixel's ray ends that comes into a cell through an edge.
    fn single(&self, x: u32, y: u32, cell: u32, entry: u32) -> End;
    /// The cell in which a ray has arrived.
    fn destination(&self) -> u32 {
        u32::MAX
    }
}

/// Where some pixels' rays have come to.
#[derive(Clone, Copy)]
pub struct At {
    pub area: Area,
    pub mask: Mask,
    pub cell: u32,
    /// The edge's place in the cell through which they came, or [`INSIDE`].
    pub entry: u32,
    /// How many cells they have left ray by ray: if more than there are, they go in circles.
    pub parted: u32,
}

/// What the rays of a rectangle do at the end of a cell.
enum Fate {
    /// All go on through a gate.
    Through(u32, u32),
    /// All end.
    Ends(End),
    /// They part, or it is not certain that they do not.
    Parts,
}

/// How the rays end, told in sets of pixels.
#[inline(always)]
pub fn run<S: Simd, R: Rays>(
    simd: S,
    space: &Space,
    rays: &R,
    start: At,
    out: &mut impl FnMut(Area, Mask, End),
) {
    if start.area.is_empty() {
        return;
    }
    let extent = space.layout.extent.max(rays.point().abs().max_element());
    let mut pending: SmallVec<[At; 32]> = SmallVec::new();
    pending.push(start);
    while let Some(mut at) = pending.pop() {
        let fate = match rays.beam(&at.area) {
            None => Fate::Parts,
            Some(beam) => loop {
                if R::ARRIVE && at.cell == rays.destination() {
                    break Fate::Ends(End::Arrives);
                }
                match fate(simd, space, rays, &beam, extent, &at) {
                    Fate::Through(cell, entry) => (at.cell, at.entry) = (cell, entry),
                    fate => break fate,
                }
            },
        };
        match fate {
            Fate::Ends(end) => out(at.area, at.mask, end),
            _ if at.area.is_window() => simd.vectorize(
                #[inline(always)]
                || window(simd, space, rays, &start, &at, &mut pending, out),
            ),
            _ => {
                let [one, two] = at.area.halves();
                pending.push(At { area: two, ..at });
                pending.push(At { area: one, ..at });
            }
        }
    }
}

/// What all rays of the rectangle do, if it is certain.
#[inline(always)]
fn fate<S: Simd, R: Rays>(
    simd: S,
    space: &Space,
    rays: &R,
    beam: &Beam,
    extent: f64,
    at: &At,
) -> Fate {
    let layout = &space.layout;
    let room = layout.room(at.cell);
    if room.n > MOST {
        return Fate::Parts;
    }
    let o = rays.point();
    // |v - o|₁ is at most 4 extents.
    let bound = f64x4::splat(simd, 4.0 * extent * beam.error);
    let (mut left, mut right) = (0u64, 0u64);
    for (block, k) in layout.blocks(room).iter().zip(0..) {
        let (x, y) = (block.x.as_chunks().0, block.y.as_chunks().0);
        for half in 0..2 {
            let at = 8 * k + 4 * half as u32;
            if at >= room.n {
                break;
            }
            let x = f64x4::simd_from(simd, x[half]) - o.x;
            let y = f64x4::simd_from(simd, y[half]) - o.y;
            let a = y * beam.x[0] - x * beam.y[0];
            let b = y * beam.x[1] - x * beam.y[1];
            let c = y * beam.x[2] - x * beam.y[2];
            let d = y * beam.x[3] - x * beam.y[3];
            let least = a.min(b).min(c.min(d));
            let most = a.max(b).max(c.max(d));
            left |= least.simd_gt(bound).to_bitmask() << at;
            right |= most.simd_lt(-bound).to_bitmask() << at;
        }
    }
    let turn = Turn::new(room.n, at.entry);
    let (left, right) = (turn.of(left), turn.of(right));
    let (exit, found) = turn.exit(right, left);
    if !found {
        return Fate::Parts;
    }
    // Whoever came through an edge asks the corners in turn: none may be in doubt up to the exit.
    // Whoever starts in the cell may be wrong where two neighbours are.
    let doubt = !(left | right);
    let doubt = if at.entry == INSIDE {
        doubt & (doubt >> 1) & ((1 << room.n) - 1)
    } else {
        doubt & ((2 << exit) - 2)
    };
    if doubt != 0 {
        return Fate::Parts;
    }
    at_edge(
        simd,
        space,
        R::ARRIVE,
        o,
        beam,
        room,
        at.cell,
        turn.back(exit),
    )
}

/// What the rays do that leave the cell through this edge on the plan.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn at_edge<S: Simd>(
    simd: S,
    space: &Space,
    arrive: bool,
    o: DVec3,
    beam: &Beam,
    room: Room,
    cell: u32,
    edge: u32,
) -> Fate {
    let layout = &space.layout;
    let gate = layout.gate(room, edge);
    let next = room.next(edge);
    let plan = o.truncate();
    let (a, b) = (
        layout.corner(room, edge) - plan,
        layout.corner(room, next) - plan,
    );
    let across = a.x * b.y - a.y * b.x;
    if arrive && across >= 0.0 {
        return Fate::Ends(End::Arrives);
    }
    let x = f64x4::simd_from(simd, beam.x);
    let y = f64x4::simd_from(simd, beam.y);
    let z = f64x4::simd_from(simd, beam.z);
    let size = a.abs().max_element() + b.abs().max_element() + plan.abs().max_element();
    let rise = Rise {
        up: z * across,
        width: side(x, y, b) - side(x, y, a),
        error: 8.0 * size * beam.error,
        size: size + o.z.abs(),
        from: o.z,
    };
    if rise.is_above(gate.low) & rise.is_below(gate.high) {
        return Fate::Through(gate.cell, gate.entry);
    }
    ends(space, cell, room.first + edge, gate, &rise)
}

/// Where four rays cross an edge's line.
struct Rise<S: Simd> {
    up: f64x4<S>,
    width: f64x4<S>,
    error: f64,
    size: f64,
    from: f64,
}

impl<S: Simd> Rise<S> {
    /// How far above a height, times something positive.
    #[inline(always)]
    fn above(&self, height: f64) -> f64x4<S> {
        self.up - self.width * (height - self.from)
    }

    #[inline(always)]
    fn bound(&self, height: f64) -> f64 {
        self.error * (self.size + height.abs())
    }

    /// Whether all rays certainly pass above. Infinite heights come out as not certain.
    #[inline(always)]
    fn is_above(&self, height: f64) -> bool {
        self.above(height).simd_gt(self.bound(height)).all_true()
    }

    /// Whether all rays certainly pass below.
    #[inline(always)]
    fn is_below(&self, height: f64) -> bool {
        self.above(height).simd_lt(-self.bound(height)).all_true()
    }

    #[inline(always)]
    fn sign(&self, height: f64) -> Sign {
        if height.is_infinite() {
            // No sign to ask.
            if height < 0.0 {
                Sign::Positive
            } else {
                Sign::Negative
            }
        } else if self.is_above(height) {
            Sign::Positive
        } else if self.is_below(height) {
            Sign::Negative
        } else {
            Sign::Unsure
        }
    }
}

/// Whether rays pass above a height.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Positive,
    Negative,
    Unsure,
}

/// What rays meet at the end of a cell, or not.
#[inline(always)]
fn ends<S: Simd>(space: &Space, cell: u32, edge: u32, gate: &Gate, rise: &Rise<S>) -> Fate {
    let (id, border, chamber) = (CellId(cell), space.edge(edge), space.cell(cell));
    let end = |surface| Fate::Ends(End::Meets(surface, cell));
    match rise.sign(chamber.floor) {
        Sign::Negative => return end(Surface::Floor(id)),
        Sign::Unsure => return Fate::Parts,
        Sign::Positive => {}
    }
    match rise.sign(chamber.ceiling) {
        Sign::Positive => return end(Surface::Ceiling(id)),
        Sign::Unsure => return Fate::Parts,
        Sign::Negative => {}
    }
    let edge = EdgeId(edge);
    if border.twin == WALL {
        if !border.outside {
            return end(Surface::Wall(edge));
        }
        return match (rise.sign(border.bottom), rise.sign(border.top)) {
            (Sign::Positive, Sign::Negative) => end(Surface::Outside(edge)),
            (Sign::Negative, _) | (_, Sign::Positive) => end(Surface::Wall(edge)),
            _ => Fate::Parts,
        };
    }
    if border.bottom > chamber.floor {
        match rise.sign(border.bottom) {
            Sign::Negative => return end(Surface::Step(edge)),
            Sign::Unsure => return Fate::Parts,
            Sign::Positive => {}
        }
    }
    if border.top < chamber.ceiling {
        match rise.sign(border.top) {
            Sign::Positive => return end(Surface::Lintel(edge)),
            Sign::Unsure => return Fate::Parts,
            Sign::Negative => {}
        }
    }
    if border.pane.is_some() {
        return end(Surface::Pane(edge));
    }
    Fate::Through(gate.cell, gate.entry)
}

/// On which side of a corner rays pass: positive for one on the left.
#[inline(always)]
pub(super) fn side<S: Simd>(x: f64x4<S>, y: f64x4<S>, v: DVec2) -> f64x4<S> {
    x * v.y - y * v.x
}
