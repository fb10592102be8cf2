//! How rays end of which the last edge is known, four at a time.
//!
//! In: rays, and the edges to which they came last. Out: the surfaces, and `t` in f64 as
//! [`super::super::walk`] computes it. Nothing branches on where a ray ends.

use std::hint::select_unpredictable;

use fearless_simd::{Simd, f64x4, prelude::*};

use super::super::cast::{Met, walk_on};
use super::super::layout::{Face, Kind};
use super::super::space::{Space, Surface};
use super::own::{Own, cell_and_entry, columns};
use super::{End, NONE, STOPPED};
use crate::cells::{CellId, EdgeId};

/// Tells `out` how each ray of a batch ends; `number` is that of the first. `ends` are edges, [`NONE`],
/// or lists in which a ray was stopped; `walk` tells whether rays without an edge may walk.
#[inline(always)]
pub(super) fn tell<S: Simd>(
    simd: S,
    space: &Space,
    batch: &[Own],
    ends: &[u32],
    walk: bool,
    mut number: u32,
    out: &mut impl FnMut(u32, End),
) {
    let ((fours, rest), (ends, last_ends)) = (batch.as_chunks(), ends.as_chunks());
    for (rays, ends) in fours.iter().zip(ends) {
        tell_some(simd, space, (rays, ends, 4), walk, number, out);
        number += 4;
    }
    if let Some(&last) = rest.last() {
        let (mut rays, mut ends) = ([last; 4], [NONE; 4]);
        rays[..rest.len()].copy_from_slice(rest);
        ends[..rest.len()].copy_from_slice(last_ends);
        tell_some(simd, space, (&rays, &ends, rest.len()), walk, number, out);
    }
}

/// Tells `out` of the first `n` of four rays.
#[inline(always)]
fn tell_some<S: Simd>(
    simd: S,
    space: &Space,
    (rays, ends, n): (&[Own; 4], &[u32; 4], usize),
    walk: bool,
    number: u32,
    out: &mut impl FnMut(u32, End),
) {
    let some = ends.map(|e| select_unpredictable(e >= STOPPED, 0, e) as usize);
    let (faces, kinds) = (&space.layout.faces[..], &space.layout.kinds[..]);
    let (t, places) = four(simd, rays, some.map(|e| &faces[e]));
    for k in 0..n {
        let number = number + k as u32;
        if ends[k] >= STOPPED {
            out(number, alone(space, &rays[k], ends[k], walk));
        } else {
            let met = met(&kinds[some[k]], ends[k], t[k], places >> k);
            out(number, End::Meets(met));
        }
    }
}

/// How a ray ends that has no edge: straight up or down, grazing a cell in a corner, not fit for a
/// queue; or stopped.
#[cold]
fn alone(space: &Space, own: &Own, end: u32, walk: bool) -> End {
    let list = if end == NONE {
        own.list()
    } else {
        end & !STOPPED
    };
    let (cell, entry) = cell_and_entry(space, list);
    // Where rays may be stopped, only the caller can go on.
    if !walk {
        return End::Stops(cell, entry);
    }
    walk_on(space, &own.ray(), cell, entry).map_or(End::Nothing, End::Meets)
}

/// The `t` of four rays, and which of them are under the floor (four bits), over the ceiling, below
/// the opening, above it.
#[inline(always)]
fn four<S: Simd>(simd: S, rays: &[Own; 4], [f, g, h, i]: [&Face; 4]) -> ([f64; 4], u64) {
    let [ox, oy, oz, dx, dy, dz] = Own::columns(simd, rays);
    let flats = [&f.flats, &g.flats, &h.flats, &i.flats];
    let gaps = [&f.gap, &g.gap, &h.gap, &i.gap];
    let ((floor, ceiling), (bottom, top)) = (columns(simd, flats), columns(simd, gaps));
    let (ax, ay) = columns(simd, [&f.from, &g.from, &h.from, &i.from]);
    let (bx, by) = columns(simd, [&f.to, &g.to, &h.to, &i.to]);
    let (ax, ay, bx, by) = (ax - ox, ay - oy, bx - ox, by - oy);
    let zero = f64x4::splat(simd, 0.0);
    let width = (dx * by - dy * bx) - (dx * ay - dy * ax);
    let upright = ((ax * by - ay * bx) / width).max(zero);
    let z = oz + upright * dz;
    let (under, over) = (z.simd_lt(floor), z.simd_gt(ceiling));
    // Both, so that neither division waits for the other's.
    let (down, up) = ((floor - oz) / dz, (ceiling - oz) / dz);
    let flat = under.select(down, up).max(zero);
    let (below, above) = (z.simd_lt(bottom), z.simd_gt(top));
    let places = under.to_bitmask()
        | over.to_bitmask() << 4
        | below.to_bitmask() << 8
        | above.to_bitmask() << 12;
    ((under | over).select(flat, upright).to_array(), places)
}

/// The surface, by the lowest bit in each four of [`four`]'s.
#[inline(always)]
fn met(kind: &Kind, edge: u32, t: f64, places: u64) -> Met {
    let place = places & 1 | places >> 3 & 2 | places >> 6 & 4 | places >> 9 & 8;
    let surface = SURFACES[kind.sort as usize % 4][place as usize];
    let id = select_unpredictable(surface < 2, kind.cell, edge);
    let surface = match surface {
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
        cell: CellId(kind.cell),
    }
}

/// Which surface it is, in the order of [`Surface`], as [`super::super::cast::face`] says: by
/// [`Kind::sort`], then by whether the ray is under the floor (1), over the ceiling (2), below (4) and
/// above the opening (8).
const SURFACES: [[u8; 16]; 4] = {
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
