//! Eight rays of one queue to the end of their cell, in f32; who is in doubt, in f64.
//!
//! In: rays that came into a cell through one edge. Out: for each the edge through which it leaves,
//! and the list it joins then: the choices of [`super::super::walk`], always.
//!
//! **How far f32 may be off.** u is its rounding, 2⁻²⁴; E the largest coordinate of a corner; H the
//! larger of E and the largest height. A direction d is taken times a power of two such that
//! 1 ≤ |x| + |y| < 2, which changes no sign. Rays that start outside E and H go singly, as do all if
//! E or H is beyond 2^±80; so nothing under- or overflows that matters.
//!
//! *Side of a corner v*: d.x v.y − d.y v.x − c, with c = d × origin from f64. Rounding d, v and c
//! costs up to 2uE each, the products 2uE, the two sums 4uE each: together 16uE; the walk's own
//! rounding in f64 is far less than uE. So a side larger than [`SIDE`] uE = 40uE has the walk's sign.
//! If all corners asked have that, the exit is the walk's: the first edge from right to left.
//!
//! *Height at the exit*: q = n·(a − origin) / n·d, with the edge's normal n and start a. Both ends
//! being 40uE away, n·d is at least 48uE / |b − a| ≥ 16u, and its own error at most 8u: it is right
//! within a factor 1.5. The numerator's error is at most 11uE. Hence q is off by at most
//! u (17E + 17|q|) / n·d, and z = origin.z + q d.z, with its own rounding, by at most
//! |d.z| u (18E + 24|q|) / n·d + 2uH, the walk's rounding included, which is less than uE / 32 / n·d
//! since the exit is 48uE wide. [`HEIGHT`] = 32 stands for both 18 and 24, 4uH for 2uH and the rounding
//! of the heights with which z is compared. A z farther than that from both has the walk's answer.

use fearless_simd::{Simd, f32x4, f32x8, i32x8, prelude::*, u32x8};

use super::super::cast::Course;
use super::super::layout::{Layout, Side};
use super::super::ray::Ray;
use super::super::space::Space;

/// A rounding.
const U: f64 = f32::EPSILON as f64 / 2.0;
/// See above.
const SIDE: f64 = 40.0;
/// See above.
const HEIGHT: f64 = 32.0;

/// What rounding may have done in a space.
#[derive(Clone, Copy)]
pub(super) struct Bound {
    /// To sides.
    side: f32,
    /// To heights: where the exit is right before the ray,
    near: f32,
    /// for each unit of the way,
    way: f32,
    /// and in any case.
    height: f32,
    /// Where rays may start, on the plan and in height.
    reach: [f64; 2],
}

impl Bound {
    pub fn new(layout: &Layout) -> Self {
        let (extent, high) = (layout.extent, layout.rise.max(layout.extent));
        let most = 2f64.powi(80);
        let fits = (most.recip()..most).contains(&extent) && high < most;
        Self {
            side: (SIDE * U * extent) as f32,
            near: (HEIGHT * U * extent) as f32,
            way: (HEIGHT * U) as f32,
            height: (4.0 * U * high) as f32,
            reach: if fits { [extent, high] } else { [-1.0; 2] },
        }
    }
}

/// A ray under way: half a cache line.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(super) struct Going {
    /// Direction on the plan, its product with the origin, x of the origin.
    plan: [f32; 4],
    /// y and z of the origin, z of the direction; the bits of the last edge to which it came,
    /// [`u32::MAX`] for none.
    rest: [f32; 4],
}

impl Going {
    /// One for which all corners are on the left.
    pub const NOBODY: Self = Self {
        plan: [0.0, 0.0, -f32::MAX, 0.0],
        rest: [0.0; 4],
    };

    /// And whether it may go with others.
    #[inline(always)]
    pub fn new(ray: &Ray, bound: &Bound) -> (Self, bool) {
        let (o, d) = (ray.origin, ray.direction);
        let size = d.x.abs() + d.y.abs();
        // With the same exponent below 0 that the size has above.
        let exponent = size.to_bits() & 0x7ff0_0000_0000_0000;
        let d = d * f64::from_bits(0x7fe0_0000_0000_0000_u64.wrapping_sub(exponent));
        let [reach, high] = bound.reach;
        let fits = (o.x.abs() <= reach)
            & (o.y.abs() <= reach)
            & (o.z.abs() <= high)
            & (d.z.abs() <= 1e6)
            & (1e-150..1e150).contains(&size);
        let across = d.x * o.y - d.y * o.x;
        let going = Self {
            plan: [d.x as f32, d.y as f32, across as f32, o.x as f32],
            rest: [o.y as f32, o.z as f32, d.z as f32, f32::from_bits(u32::MAX)],
        };
        (going, fits)
    }

    /// The last edge to which it came.
    #[inline(always)]
    pub fn edge(&self) -> u32 {
        self.rest[3].to_bits()
    }

    #[inline(always)]
    pub fn come_to(&mut self, edge: u32) {
        self.rest[3] = f32::from_bits(edge);
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
    let [dx, dy, c, ox] = transposed([
        pair(simd, &r[0].plan, &r[4].plan),
        pair(simd, &r[1].plan, &r[5].plan),
        pair(simd, &r[2].plan, &r[6].plan),
        pair(simd, &r[3].plan, &r[7].plan),
    ]);
    let [oy, oz, dz, _] = transposed([
        pair(simd, &r[0].rest, &r[4].rest),
        pair(simd, &r[1].rest, &r[5].rest),
        pair(simd, &r[2].rest, &r[6].rest),
        pair(simd, &r[3].rest, &r[7].rest),
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
    let per = all(1.0) / (nx * dx + ny * dy);
    let way = (offset - nx * ox - ny * oy) * per;
    let z = way.max(zero).mul_add(dz, oz);
    let error = way.abs().mul_add(all(bound.way), all(bound.near));
    let error = (dz * per).abs().mul_add(error, all(bound.height));
    let clear = (z - low).abs().min((z - high).abs());
    let doubt = least.simd_le(bound.side) | clear.simd_le(error);
    let passes = z.simd_ge(low) & z.simd_le(high);
    Exits {
        to: passes.select(twin, number(ended)).to_array(),
        edge: edge.to_array(),
        doubt: doubt.to_bitmask(),
    }
}

/// As the walk does it: the list that the ray joins, and the edge to which it comes.
#[cold]
#[inline(never)]
pub(super) fn exactly(space: &Space, list: u32, ended: u32, ray: &Ray) -> (u32, u32) {
    let n_edges = space.edges.len() as u32;
    let (cell, entry) = if list < n_edges {
        (space.edge(list).cell, Some(list))
    } else {
        (list - n_edges, None)
    };
    let Some(exit) = Course::new(space, *ray).exit(space.cell(cell), entry) else {
        return (ended, u32::MAX);
    };
    let gate = &space.layout.gates[exit.edge as usize];
    let passes = exit.z >= gate.low && exit.z <= gate.high;
    (if passes { gate.twin } else { ended }, exit.edge)
}

#[inline(always)]
fn pair<S: Simd>(simd: S, a: &[f32; 4], b: &[f32; 4]) -> f32x8<S> {
    f32x4::load_array_ref(simd, a).combine(f32x4::load_array_ref(simd, b))
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
