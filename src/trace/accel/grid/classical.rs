//! The classical walk through a grid.
//!
//! In each cell: the times at which the ray crosses the three faces in front of it; the least is when
//! it leaves, through a face across axis w; the next cell has index i + 1 or i - 1 along w by the sign
//! of the direction, and the others unchanged. Where two times are equal the ray passes an edge, and
//! goes on through the cell beside it, in no time.

use glam::{DVec3, USizeVec3};

use super::Grid;
use crate::trace::accel::cast::Cast;
use crate::trace::accel::count::Count;
use crate::trace::accel::mailbox::Mailbox;
use crate::trace::accel::search::Search;

pub(super) fn walk<S: Search, C: Count>(grid: &Grid, cast: &Cast, search: &mut S, count: &mut C) {
    let Some((mut cell, _)) = grid.enter(cast, search) else {
        return;
    };
    let mut mailbox = Mailbox::new();
    loop {
        if grid.visit(cell, &mut mailbox, search, count) {
            return;
        }
        let (axis, leaves) = outgoing(grid, cast, cell);
        if search.limit() < leaves {
            return;
        }
        let Some(next) = grid.step(cell, axis, cast.inverse[axis] > 0.0) else {
            return;
        };
        cell = next;
    }
}

/// The axis across which the ray leaves the cell, and when.
fn outgoing(grid: &Grid, cast: &Cast, cell: USizeVec3) -> (usize, f64) {
    let crosses = |axis: usize| {
        let ahead = usize::from(cast.inverse[axis] > 0.0);
        (grid.plane(axis, cell[axis] + ahead) - cast.ray.origin[axis]) * cast.inverse[axis]
    };
    let times = DVec3::new(crosses(0), crosses(1), crosses(2));
    let axis = times.min_position();
    (axis, times[axis])
}
