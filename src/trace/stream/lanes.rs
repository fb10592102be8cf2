//! Eight rays of one queue to the end of their cell, in f32; who is in doubt, in f64.
//!
//! In: rays that came into a cell through one edge. Out: for each the edge through which it leaves,
//! and the list it joins then: the choices of [`super::super::walk`], always.
//!
//! **How far f32 may be off.** u is its rounding, 2⁻²⁴; E the largest coordinate of a corner; H the
//! larger of E and the largest height; s = |d.x| + |d.y| of a direction d. Rays that start outside E
//! and H go singly, as do those that are longer than 2³⁰ or, on the plan, shorter than 2⁻³⁰, and all if
//! E or H is beyond 2^±40; so nothing under- or overflows that matters.
//!
//! *Side of a corner v*: d.x v.y − d.y v.x − c, with c = d × origin from f64. Rounding d, v and c
//! costs up to uEs each, the products uEs, the two sums 2uEs each: together 8uEs; the walk's own
//! rounding in f64 is far less than uEs. So a side larger than [`SIDE`] uEs = 20uEs has the walk's
//! sign. If all corners asked have that, the exit is the walk's: the first edge from right to left.
//!
//! *Height at the exit*: the ray is there at t = q / m, with q = n·(a − origin), m = n·d, the edge's
//! outer unit normal n and its start a; or at t = 0, if rounding has put that behind it. Both ends
//! being 20uEs away, m is at least 24uEs / |b − a| ≥ 8us, and off by at most 4us: positive. So the ray
//! is not below a height h if max(q, 0) d.z − (h − origin.z) m is not negative: no division. q is at
//! most 2.9E and off by at most 11uE, so the first product by 17uE |d.z|; m is at most s, h − origin.z
//! at most 2H and off by 4uH, so the second product by 12uHs; the difference itself is rounded by
//! 3uE |d.z| + 2uHs. [`WAY`] = 32 and [`HEIGHT`] = 24 stand for the sums 20 and 14, which covers
//! vectors that round products by themselves, and the walk's own rounding, which is far less.

use fearless_simd::{Simd, f32x4, f32x8, f64x4, i32x8, prelude::*, u32x8};

use super::super::cast::Course;
use super::super::layout::{Asked, Layout};
use super::super::space::Space;
use super::NONE;
use super::own::{Own, cell_and_entry};
use super::shuffle::{picked, rows, transposed};

/// A rounding.
const U: f64 = f32::EPSILON as f64 / 2.0;
/// See above.
const SIDE: f64 = 20.0;
/// See above.
const WAY: f64 = 32.0;
/// See above.
const HEIGHT: f64 = 24.0;

/// What rounding may have done in a space.
#[derive(Clone, Copy)]
pub(super) struct Bound {
    /// To sides, for each unit of a direction on the plan.
    side: f32,
    /// To heights, for each unit of d.z,
    way: f32,
    /// and for each unit on the plan.
    height: f32,
    /// How far on the plan, and how high, a ray may start.
    most: [f64; 2],
}

/// A direction may be as long as this, on the plan and upright; on the plan, it must not be shorter
/// than its inverse.
const LONG: f64 = (1 << 30) as f64;

impl Bound {
    pub fn new(layout: &Layout) -> Self {
        let (extent, high) = (layout.extent, layout.rise.max(layout.extent));
        let most = 2f64.powi(40);
        let fits = (most.recip()..most).contains(&extent) && high < most;
        Self {
            side: (SIDE * U * extent) as f32,
            way: (WAY * U * extent) as f32,
            height: (HEIGHT * U * high) as f32,
            most: if fits { [extent, high] } else { [-1.0; 2] },
        }
    }
}

/// A ray under way, half a cache line: the direction's x and y, their product with the origin on the
/// plan, and the direction's z; then the origin, and |x| + |y| of the direction.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Going(pub [[f32; 4]; 2]);

impl Going {
    /// One for which all corners are on the left.
    pub const NOBODY: Self = Self([[0.0, 0.0, -f32::MAX, 0.0], [0.0; 4]]);

    /// Four rays, and which of them may go with others (four bits).
    #[inline(always)]
    pub fn four<S: Simd>(simd: S, four: &[Own; 4], bound: &Bound) -> ([Self; 4], u64) {
        let [ox, oy, oz, dx, dy, dz] = Own::columns(simd, four);
        let all = |v: f64| f64x4::splat(simd, v);
        let [far, high] = bound.most;
        let length = dx.abs() + dy.abs();
        let starts = ox.abs().max(oy.abs()).simd_le(all(far)) & oz.abs().simd_le(all(high));
        let short = length.max(dz.abs()).simd_le(all(LONG));
        let fits = starts & short & length.simd_ge(all(LONG.recip()));
        let [a, b, c, d] = rows(simd, [dx, dy, dx * oy - dy * ox, dz]);
        let [e, f, g, h] = rows(simd, [ox, oy, oz, length]);
        let going = [Self([a, e]), Self([b, f]), Self([c, g]), Self([d, h])];
        (going, fits.to_bitmask())
    }
}

/// Where eight rays leave their cell.
#[derive(Clone, Copy)]
pub(super) struct Exits {
    /// The lists that they join.
    pub to: [u32; 8],
    /// Through which edges, or [`NONE`].
    pub edge: [u32; 8],
    /// Those of which neither is known.
    pub doubt: u64,
}

/// Takes eight rays that ask the same to the end of their cell. The k-th of them ends in the list
/// `ended` + k.
#[inline(always)]
pub(super) fn leave<S: Simd>(
    simd: S,
    layout: &Layout,
    bound: &Bound,
    asked: &Asked,
    ended: u32,
    r: [&Going; 8],
) -> Exits {
    let all = |v: f32| f32x8::splat(simd, v);
    let number = |v: u32| u32x8::splat(simd, v);
    let [dx, dy, across, dz] = columns(simd, r, 0);
    let back = -dy;
    let [first, past] = asked.corners;
    let corners = &layout.corners[first as usize..past as usize];
    let (last, rest) = corners.split_last().expect("a cell has corners");
    let mut to = dx.mul_add(all(last.at[1]), back.mul_add(all(last.at[0]), -across));
    let mut least = to.abs();
    // So far that the edge is none.
    let none = number(NONE.wrapping_sub(asked.edge));
    let mut place = none;
    // From the last to the first, so that the first exit is the one that stays.
    for corner in rest.iter().rev() {
        let [x, y] = corner.at;
        let from = dx.mul_add(all(y), back.mul_add(all(x), -across));
        least = least.min(from.abs());
        let (right, left) = (from.bitcast::<i32x8<S>>(), !to.bitcast::<i32x8<S>>());
        let exits = (right & left).simd_lt(0);
        place = exits.select(number(corner.place), place);
        to = from;
    }
    let [first, past] = asked.plates;
    let plates = &layout.plates[first as usize..past as usize];
    let (plate, further) = plates.split_first().expect("a cell has edges");
    let mut nx = picked(simd, &plate.nx, place);
    let mut ny = picked(simd, &plate.ny, place);
    let mut offset = picked(simd, &plate.offset, place);
    let mut low = picked(simd, &plate.low, place);
    let mut high = picked(simd, &plate.high, place);
    let mut twin = picked(simd, bytemuck::cast_ref(&plate.twin), place);
    for (plate, k) in further.iter().zip(1..) {
        let here = (place >> 3).simd_eq(number(k));
        nx = here.select(picked(simd, &plate.nx, place), nx);
        ny = here.select(picked(simd, &plate.ny, place), ny);
        offset = here.select(picked(simd, &plate.offset, place), offset);
        low = here.select(picked(simd, &plate.low, place), low);
        high = here.select(picked(simd, &plate.high, place), high);
        let further = picked(simd, bytemuck::cast_ref(&plate.twin), place);
        twin = here.select(further, twin);
    }
    let [ox, oy, oz, size] = columns(simd, r, 1);
    let m = nx.mul_add(dx, ny * dy);
    let q = (-nx).mul_add(ox, (-ny).mul_add(oy, offset));
    let up = q.max(all(0.0)) * dz;
    let over = (oz - low).mul_add(m, up);
    let under = (high - oz).mul_add(m, -up);
    let between = over.min(under);
    let error = dz.abs().mul_add(all(bound.way), size * all(bound.height));
    let exits = !place.simd_eq(none);
    let doubt = least.simd_le(size * all(bound.side)) | (exits & between.abs().simd_le(error));
    let passes = exits & between.simd_gt(all(0.0));
    let end = u32x8::load_array(simd, [0, 1, 2, 3, 4, 5, 6, 7]) + number(ended);
    let edge = number(asked.edge) + place;
    Exits {
        to: passes.select(twin.bitcast::<u32x8<S>>(), end).to_array(),
        edge: edge.to_array(),
        doubt: doubt.to_bitmask(),
    }
}

/// Four numbers of eight rays, in columns.
#[inline(always)]
fn columns<S: Simd>(simd: S, r: [&Going; 8], half: usize) -> [f32x8<S>; 4] {
    transposed(
        simd,
        [
            pair(simd, r[0], r[4], half),
            pair(simd, r[1], r[5], half),
            pair(simd, r[2], r[6], half),
            pair(simd, r[3], r[7], half),
        ],
    )
}

/// Four numbers of two rays.
#[inline(always)]
fn pair<S: Simd>(simd: S, a: &Going, b: &Going, half: usize) -> f32x8<S> {
    let a = f32x4::load_array_ref(simd, &a.0[half]);
    a.combine(f32x4::load_array_ref(simd, &b.0[half]))
}

/// As the walk does it: the list that a ray joins, if it goes on, and the edge to which it comes.
pub(super) fn exactly(space: &Space, list: u32, own: &Own) -> (Option<u32>, u32) {
    let (cell, entry) = cell_and_entry(space, list);
    let Some(exit) = Course::new(space, own.ray()).exit(space.cell(cell.0), entry) else {
        return (None, NONE);
    };
    let gate = &space.layout.gates[exit.edge as usize];
    let passes = exit.z >= gate.low && exit.z <= gate.high;
    (passes.then_some(gate.twin), exit.edge)
}
