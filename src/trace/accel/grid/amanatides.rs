//! The walk of Amanatides and Woo: "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987.
//!
//! The times at which the ray crosses the next plane of each axis are kept, and each grows by the same
//! step: one comparison chain and one addition per cell. The k-th time so carries k rounding errors,
//! each below u times the largest time: with at most 128 steps the point is off by less than
//! (128 + 8)·u·(|o| + reach) < 2.2·g, which the margin covers.

use glam::DVec3;

use super::Grid;
use crate::trace::accel::cast::Cast;
use crate::trace::accel::count::Count;
use crate::trace::accel::mailbox::Mailbox;
use crate::trace::accel::search::Search;

pub(super) fn walk<S: Search, C: Count>(grid: &Grid, cast: &Cast, search: &mut S, count: &mut C) {
    let Some((mut cell, _)) = grid.enter(cast, search) else {
        return;
    };
    let forward = cast.inverse.cmpgt(DVec3::ZERO);
    let first = |axis: usize| {
        let ahead = usize::from(forward.test(axis));
        (grid.plane(axis, cell[axis] + ahead) - cast.ray.origin[axis]) * cast.inverse[axis]
    };
    let mut next = DVec3::new(first(0), first(1), first(2));
    let step = grid.cell * cast.inverse.abs();
    let mut mailbox = Mailbox::new();
    loop {
        if grid.visit(cell, &mut mailbox, search, count) {
            return;
        }
        let axis = next.min_position();
        if search.limit() < next[axis] {
            return;
        }
        let Some(after) = grid.step(cell, axis, forward.test(axis)) else {
            return;
        };
        cell = after;
        next[axis] += step[axis];
    }
}
