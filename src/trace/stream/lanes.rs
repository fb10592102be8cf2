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

use fearless_simd::{Simd, f32x4, f32x8, i32x8, prelude::*, u32x8};

use super::super::cast::Course;
use super::super::layout::{Layout, Side};
use super::super::ray::Ray;
use super::super::space::Space;
use super::own::{Own, cell_and_entry};

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
    /// How large the numbers of a [`Going`] may be.
    most: [f32; 8],
}

/// A direction may have components as large as this; on the plan, they must not be smaller than its
/// inverse.
const LONG: f32 = (1 << 30) as f32;

impl Bound {
    pub fn new(layout: &Layout) -> Self {
        let (extent, high) = (layout.extent, layout.rise.max(layout.extent));
        let most = 2f64.powi(40);
        let fits = (most.recip()..most).contains(&extent) && high < most;
        let [e, h] = if fits { [extent, high] } else { [-1.0; 2] }.map(|v| v as f32);
        Self {
            side: (SIDE * U * extent) as f32,
            way: (WAY * U * extent) as f32,
            height: (HEIGHT * U * high) as f32,
            most: [e, e, h, LONG, LONG, LONG, f32::INFINITY, 0.0],
        }
    }
}

/// A ray under way, half a cache line: its origin, its direction, and their product on the plan.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Going([f32; 8]);

impl Going {
    /// One for which all corners are on the left.
    pub const NOBODY: Self = Self([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -f32::MAX, 0.0]);

    /// And whether it may go with others.
    #[inline(always)]
    pub fn new<S: Simd>(simd: S, own: &Own, bound: &Bound) -> (Self, bool) {
        let Ray {
            origin: o,
            direction: d,
        } = own.ray();
        let across = d.x * o.y - d.y * o.x;
        let going = [
            o.x as f32,
            o.y as f32,
            o.z as f32,
            d.x as f32,
            d.y as f32,
            d.z as f32,
            across as f32,
            0.0,
        ];
        let size = f32x8::load_array_ref(simd, &going).abs();
        let fits = size.simd_le(f32x8::load_array_ref(simd, &bound.most));
        let fits = fits.all_true() & (going[3].abs() + going[4].abs() >= LONG.recip());
        (Self(going), fits)
    }
}

/// Where eight rays leave their cell.
pub(super) struct Exits {
    /// The lists that they join.
    pub to: [u32; 8],
    pub edge: [u32; 8],
    /// Those of which neither is known.
    pub doubt: u64,
}

/// Takes eight rays that ask the same sides to the end of their cell.
#[inline(always)]
pub(super) fn leave<S: Simd>(
    simd: S,
    bound: &Bound,
    sides: &[Side],
    ended: u32,
    r: [&Going; 8],
) -> Exits {
    let [ox, oy, oz, dx] = transposed([
        pair(simd, r[0], r[4], 0),
        pair(simd, r[1], r[5], 0),
        pair(simd, r[2], r[6], 0),
        pair(simd, r[3], r[7], 0),
    ]);
    let [dy, dz, c, _] = transposed([
        pair(simd, r[0], r[4], 4),
        pair(simd, r[1], r[5], 4),
        pair(simd, r[2], r[6], 4),
        pair(simd, r[3], r[7], 4),
    ]);
    let all = |v: f32| f32x8::splat(simd, v);
    let number = |v: u32| u32x8::splat(simd, v);
    let (zero, back) = (all(0.0), -dy);
    let side = |s: &Side| dx.mul_add(all(s.at[1]), back.mul_add(all(s.at[0]), -c));
    let (last, rest) = sides.split_last().expect("a cell has corners");
    let mut to = side(last);
    let mut least = to.abs();
    let (mut nx, mut ny, mut offset) = (zero, zero, zero);
    let (mut low, mut high) = (all(f32::NEG_INFINITY), all(f32::INFINITY));
    let (mut twin, mut edge) = (number(ended), number(u32::MAX));
    // From the last to the first, so that the first exit is the one that stays.
    for s in rest.iter().rev() {
        let from = side(s);
        least = least.min(from.abs());
        let (right, left) = (from.bitcast::<i32x8<S>>(), !to.bitcast::<i32x8<S>>());
        let exits = (right & left).simd_lt(0);
        nx = exits.select(all(s.normal[0]), nx);
        ny = exits.select(all(s.normal[1]), ny);
        offset = exits.select(all(s.offset), offset);
        low = exits.select(all(s.low), low);
        high = exits.select(all(s.high), high);
        twin = exits.select(number(s.twin), twin);
        edge = exits.select(number(s.edge), edge);
        to = from;
    }
    let m = nx.mul_add(dx, ny * dy);
    let q = (-nx).mul_add(ox, (-ny).mul_add(oy, offset));
    let up = q.max(zero) * dz;
    let over = (oz - low).mul_add(m, up);
    let under = (high - oz).mul_add(m, -up);
    let between = over.min(under);
    let size = dx.abs() + dy.abs();
    let error = dz.abs().mul_add(all(bound.way), size * all(bound.height));
    let doubt = least.simd_le(size * all(bound.side)) | between.abs().simd_le(error);
    let passes = between.simd_gt(zero);
    Exits {
        to: passes.select(twin, number(ended)).to_array(),
        edge: edge.to_array(),
        doubt: doubt.to_bitmask(),
    }
}

/// As the walk does it: the list that the ray joins, and the edge to which it comes.
#[cold]
#[inline(never)]
pub(super) fn exactly(space: &Space, list: u32, ended: u32, own: &Own) -> (u32, u32) {
    let (cell, entry) = cell_and_entry(space, list);
    let Some(exit) = Course::new(space, own.ray()).exit(space.cell(cell.0), entry) else {
        return (ended, u32::MAX);
    };
    let gate = &space.layout.gates[exit.edge as usize];
    let passes = exit.z >= gate.low && exit.z <= gate.high;
    (if passes { gate.twin } else { ended }, exit.edge)
}

/// Four numbers of two rays.
#[inline(always)]
fn pair<S: Simd>(simd: S, a: &Going, b: &Going, at: usize) -> f32x8<S> {
    let four = |ray: &Going| f32x4::from_slice(simd, &ray.0[at..at + 4]);
    four(a).combine(four(b))
}

/// Four rows to four columns, in both halves.
#[inline(always)]
fn transposed<S: Simd>(r: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let ([a, c], [b, d]) = (zip(r[0], r[2]), zip(r[1], r[3]));
    let ([p, q], [r, s]) = (zip(a, b), zip(c, d));
    [p, q, r, s]
}

/// Takes numbers of both in turn, in both halves.
#[inline(always)]
fn zip<S: Simd>(a: f32x8<S>, b: f32x8<S>) -> [f32x8<S>; 2] {
    let (low, high) = (a.zip_low(b).split(), a.zip_high(b).split());
    [low.0.combine(high.0), low.1.combine(high.1)]
}
