//! A ray of a batch, as it came: in rows that four rays turn into columns.

use fearless_simd::{Simd, f64x2, f64x4, prelude::*};
use glam::DVec3;

use super::super::cast::{Place, entry_of};
use super::super::ray::Ray;
use super::super::space::Space;
use crate::cells::CellId;

/// A ray and where it starts: a cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Own {
    /// Origin and direction, and the bits of the list in which it starts: an edge, or the number of
    /// edges and that of a cell.
    rows: [[f64; 2]; 4],
}

impl Own {
    #[inline(always)]
    pub fn new(space: &Space, (ray, place): (Ray, Place)) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        let in_cell = space.edges.len() as u32 + place.cell.0;
        let list = f64::from_bits(u64::from(entry_of(space, place).unwrap_or(in_cell)));
        Self {
            rows: [[o.x, o.y], [o.z, d.x], [d.y, d.z], [list, 0.0]],
        }
    }

    #[inline]
    pub fn ray(&self) -> Ray {
        let [[x, y], [z, dx], [dy, dz], _] = self.rows;
        Ray {
            origin: DVec3::new(x, y, z),
            direction: DVec3::new(dx, dy, dz),
        }
    }

    /// The list in which it starts.
    #[inline(always)]
    pub fn list(&self) -> u32 {
        self.rows[3][0].to_bits() as u32
    }

    /// Components of four origins, then of their directions.
    #[inline(always)]
    pub fn columns<S: Simd>(simd: S, [a, b, c, d]: &[Self; 4]) -> [f64x4<S>; 6] {
        let (ox, oy) = columns(simd, [&a.rows[0], &b.rows[0], &c.rows[0], &d.rows[0]]);
        let (oz, dx) = columns(simd, [&a.rows[1], &b.rows[1], &c.rows[1], &d.rows[1]]);
        let (dy, dz) = columns(simd, [&a.rows[2], &b.rows[2], &c.rows[2], &d.rows[2]]);
        [ox, oy, oz, dx, dy, dz]
    }
}

/// The cell and the edge that a list stands for.
#[inline]
pub(super) fn cell_and_entry(space: &Space, list: u32) -> (CellId, Option<u32>) {
    let n_edges = space.edges.len() as u32;
    if list < n_edges {
        (CellId(space.edge(list).cell), Some(list))
    } else {
        (CellId(list - n_edges), None)
    }
}

/// Four rows of two to two columns.
#[inline(always)]
pub(super) fn columns<S: Simd>(simd: S, [a, b, c, d]: [&[f64; 2]; 4]) -> (f64x4<S>, f64x4<S>) {
    let ab = f64x2::load_array_ref(simd, a).combine(f64x2::load_array_ref(simd, b));
    let cd = f64x2::load_array_ref(simd, c).combine(f64x2::load_array_ref(simd, d));
    ab.deinterleave(cd)
}
