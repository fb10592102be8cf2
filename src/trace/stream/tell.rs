//! What has stopped rays of which the last edge is known, four at a time.
//!
//! In: rays, and the edges to which they came last. Out: the surfaces, and `t` in f64 as
//! [`super::super::walk`] computes it. Nothing branches on where a ray ends.

use std::hint::select_unpredictable;

use fearless_simd::{Simd, f64x4, prelude::*};

use super::super::cast::{Met, Place, walk};
use super::super::ray::Ray;
use super::super::space::{Space, Surface, WALL};
use super::lanes::Going;
use crate::cells::{CellId, EdgeId};

/// Tells `out` what each ray of a batch meets; `number` is that of the first.
#[inline(always)]
pub(super) fn tell<S: Simd>(
    simd: S,
    space: &Space,
    batch: &[(Ray, Place)],
    ends: &[Going],
    mut number: u32,
    out: &mut impl FnMut(u32, Option<Met>),
) {
    for (rays, ends) in batch.chunks(4).zip(ends.chunks(4)) {
        // The last vector has the last ray more than once.
        let last = rays.len() - 1;
        let [a, b, c] = [1.min(last), 2.min(last), 3.min(last)];
        let r = [&rays[0].0, &rays[a].0, &rays[b].0, &rays[c].0];
        let edge = [
            ends[0].edge(),
            ends[a].edge(),
            ends[b].edge(),
            ends[c].edge(),
        ];
        let (t, sorts) = four(simd, space, r, edge);
        for (k, (ray, place)) in rays.iter().enumerate() {
            if edge[k] == u32::MAX {
                // Straight up or down, grazing a cell in a corner, or not fit for a queue.
                let met = walk(space, ray, *place, f64::INFINITY, |_, _| f64::INFINITY);
                out(number, met);
            } else {
                out(number, Some(met(space, edge[k], t[k], sorts >> k)));
            }
            number += 1;
        }
    }
}

/// The `t` of four rays, and which of them are under the floor (four bits), over the ceiling, below
/// the opening, above it.
#[inline(always)]
fn four<S: Simd>(simd: S, space: &Space, r: [&Ray; 4], edge: [u32; 4]) -> ([f64; 4], u64) {
    macro_rules! each {
        ($list:ident, $($field:ident).+) => {
            f64x4::simd_from(simd, [
                $list[0].$($field).+, $list[1].$($field).+, $list[2].$($field).+, $list[3].$($field).+,
            ])
        };
    }
    let of = |e: u32| space.edge(select_unpredictable(e == u32::MAX, 0, e));
    let border = [of(edge[0]), of(edge[1]), of(edge[2]), of(edge[3])];
    let cell = border.map(|b| space.cell(b.cell));
    let (a, b) = (border.map(|b| b.from), border.map(|b| b.to));
    let v = |v: u32| space.vertex(v);
    let (a0, a1, a2, a3) = (v(a[0]), v(a[1]), v(a[2]), v(a[3]));
    let (b0, b1, b2, b3) = (v(b[0]), v(b[1]), v(b[2]), v(b[3]));
    let (ox, oy, oz) = (each!(r, origin.x), each!(r, origin.y), each!(r, origin.z));
    let dx = each!(r, direction.x);
    let dy = each!(r, direction.y);
    let dz = each!(r, direction.z);
    let ax = f64x4::simd_from(simd, [a0.x, a1.x, a2.x, a3.x]) - ox;
    let ay = f64x4::simd_from(simd, [a0.y, a1.y, a2.y, a3.y]) - oy;
    let bx = f64x4::simd_from(simd, [b0.x, b1.x, b2.x, b3.x]) - ox;
    let by = f64x4::simd_from(simd, [b0.y, b1.y, b2.y, b3.y]) - oy;
    let zero = f64x4::splat(simd, 0.0);
    let width = (dx * by - dy * bx) - (dx * ay - dy * ax);
    let upright = ((ax * by - ay * bx) / width).max(zero);
    let z = oz + upright * dz;
    let (floor, ceiling) = (each!(cell, floor), each!(cell, ceiling));
    let (under, over) = (z.simd_lt(floor), z.simd_gt(ceiling));
    let flat = ((under.select(floor, ceiling) - oz) / dz).max(zero);
    let below = z.simd_lt(each!(border, bottom));
    let above = z.simd_gt(each!(border, top));
    let places = under.to_bitmask()
        | over.to_bitmask() << 4
        | below.to_bitmask() << 8
        | above.to_bitmask() << 12;
    ((under | over).select(flat, upright).to_array(), places)
}

/// The surface, by the lowest bit in each four of [`four`]'s.
#[inline(always)]
fn met(space: &Space, edge: u32, t: f64, places: u64) -> Met {
    let border = space.edge(edge);
    let place = places & 1 | places >> 3 & 2 | places >> 6 & 4 | places >> 9 & 8;
    let sort = usize::from(border.twin == WALL) | usize::from(border.outside) << 1;
    let kind = KINDS[sort][place as usize];
    let id = select_unpredictable(kind < 2, border.cell, edge);
    let surface = match kind {
        0 => Surface::Floor(CellId(id)),
        1 => Surface::Ceiling(CellId(id)),
        2 => Surface::Wall(EdgeId(id)),
        3 => Surface::Step(EdgeId(id)),
        4 => Surface::Lintel(EdgeId(id)),
        5 => Surface::Pane(EdgeId(id)),
        _ => Surface::Outside(EdgeId(id)),
    };
    Met {
        t,
        surface,
        cell: CellId(border.cell),
    }
}

/// Which surface it is, in the order of [`Surface`], as [`super::super::cast::face`] says: by whether
/// the edge is a wall (1) and looks outside (2), then by whether the ray is under the floor (1), over
/// the ceiling (2), below (4) and above the opening (8).
const KINDS: [[u8; 16]; 4] = {
    let mut kinds = [[0; 16]; 4];
    let mut i = 0;
    while i < 64 {
        let (sort, place) = (i / 16, i % 16);
        kinds[sort][place] = if place & 1 != 0 {
            0
        } else if place & 2 != 0 {
            1
        } else if sort & 1 != 0 {
            if sort & 2 != 0 && place & 12 == 0 {
                6
            } else {
                2
            }
        } else if place & 4 != 0 {
            3
        } else if place & 8 != 0 {
            4
        } else {
            5
        };
        i += 1;
    }
    kinds
};
