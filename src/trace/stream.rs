//! Rays without order: many at a time, each with its own way.
//!
//! In: rays and the places where they start. Out: for each what [`super::walk`] gives, to the last
//! bit. Rays that have nothing in common cannot share signs, but they can share waiting: a ray must
//! know through which edge it leaves before it can ask for the next cell, and meanwhile the others
//! go on. So [`LANES`] rays take one step each in turn, and one that has ended makes place for the
//! next. A step has no branch that depends on the ray: the vector is the cell, whose corners are all
//! asked at once; whether the ray goes on or the next one starts is a choice between numbers; and
//! what stopped a ray is found out afterwards. (Measured: with branches, no faster than ray by ray.)

use std::hint::select_unpredictable;

use fearless_simd::{Level, Simd, dispatch, f64x4, prelude::*};

use super::cast::{Met, Place, edge_of, walk_on};
use super::layout::{Block, INSIDE, MOST, Turn};
use super::ray::Ray;
use super::space::{Space, Surface, WALL};
use crate::cells::{CellId, EdgeId};

/// How many rays are under way at a time.
const LANES: usize = 8;

/// How many rays are made ready at a time.
const READY: usize = 512;

/// A ray with the place where it starts.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Start {
    ray: Ray,
    cell: u32,
    /// The place of the edge on which it starts, or [`INSIDE`].
    entry: u32,
}

/// A ray under way.
#[derive(Clone, Copy, Default)]
struct Lane {
    /// Which of those made ready.
    ray: u32,
    cell: u32,
    entry: u32,
}

/// Where a ray has ended: at or before an edge, where it would cross it.
#[derive(Clone, Copy, Default)]
struct Stop {
    lane: Lane,
    /// [`u32::MAX`] if no edge was found.
    edge: u32,
    t: f64,
    z: f64,
}

/// What the rays meet; `out` is told of each by its number, in no order.
pub fn cast(
    space: &Space,
    rays: impl IntoIterator<Item = (Ray, Place)>,
    mut out: impl FnMut(u32, Option<Met>),
) {
    let mut rays = rays.into_iter().map(|(ray, place)| {
        let entry = place.on.and_then(edge_of).map(|e| {
            let edge = space.edge(e);
            let own = edge.cell == place.cell.0;
            let e = if own { e } else { edge.twin };
            e - space.layout.room(place.cell.0).first
        });
        Start {
            ray,
            cell: place.cell.0,
            entry: entry.unwrap_or(INSIDE),
        }
    });
    let (mut starts, mut stops) = (Vec::with_capacity(READY), [Stop::default(); READY]);
    let mut number = 0;
    loop {
        starts.clear();
        starts.extend(rays.by_ref().take(READY));
        if starts.is_empty() {
            return;
        }
        dispatch!(Level::new(), simd => run(simd, space, &starts, &mut stops));
        for stop in &stops[..starts.len()] {
            let ray = &starts[stop.lane.ray as usize].ray;
            out(number + stop.lane.ray, met(space, ray, stop));
        }
        number += starts.len() as u32;
    }
}

/// Takes all rays to their ends.
#[inline(always)]
fn run<S: Simd>(simd: S, space: &Space, starts: &[Start], stops: &mut [Stop; READY]) {
    let begin = |ray: usize| Lane {
        ray: ray as u32,
        cell: starts[ray].cell,
        entry: starts[ray].entry,
    };
    let (mut started, mut ended) = (starts.len().min(LANES), 0);
    let mut lanes = [Lane::default(); LANES];
    for (k, lane) in lanes[..started].iter_mut().enumerate() {
        *lane = begin(k);
    }
    let n = started;
    while started < starts.len() && starts.len() - started >= LANES {
        for lane in &mut lanes {
            let (stop, next, ends) = step(simd, space, &starts[lane.ray as usize].ray, *lane);
            stops[ended & (READY - 1)] = stop;
            let other = begin(started);
            *lane = Lane {
                ray: select_unpredictable(ends, other.ray, lane.ray),
                cell: select_unpredictable(ends, other.cell, next.cell),
                entry: select_unpredictable(ends, other.entry, next.entry),
            };
            started += usize::from(ends);
            ended += usize::from(ends);
        }
    }
    // The last ones, ray by ray.
    let rest = (started..starts.len()).map(begin);
    for mut lane in lanes[..n].iter().copied().chain(rest) {
        loop {
            let (stop, next, ends) = step(simd, space, &starts[lane.ray as usize].ray, lane);
            if ends {
                stops[ended] = stop;
                ended += 1;
                break;
            }
            lane = next;
        }
    }
}

/// Takes a ray to the end of its cell: where that is, the ray in the next cell, and whether it ends
/// here instead.
#[inline(always)]
fn step<S: Simd>(simd: S, space: &Space, ray: &Ray, lane: Lane) -> (Stop, Lane, bool) {
    let layout = &space.layout;
    let room = layout.room(lane.cell);
    let (o, d) = (ray.origin, ray.direction);
    let mut right = 0u64;
    let blocks = &layout.blocks[room.block as usize..];
    right |= sides(simd, &blocks[0], ray);
    if room.n > 8 {
        for (block, k) in blocks[1..].iter().zip(1..room.n.min(MOST).div_ceil(8)) {
            right |= sides(simd, block, ray) << (8 * k);
        }
    }
    let turn = Turn::new(room.n.min(MOST), lane.entry);
    let turned = turn.of(right);
    let (exit, found) = turn.exit(turned, !turned);
    let found = found & (room.n <= MOST);
    let edge = turn.back(exit);
    let end = room.next(edge);
    let a = layout.corner(room, edge) - o.truncate();
    let b = layout.corner(room, end) - o.truncate();
    let width = (d.x * b.y - d.y * b.x) - (d.x * a.y - d.y * a.x);
    let t = (a.x * b.y - a.y * b.x) / width;
    let t = t.max(0.0);
    let z = o.z + t * d.z;
    let gate = layout.gate(room, edge);
    let passes = found & (z >= gate.low) & (z <= gate.high);
    let stop = Stop {
        lane,
        edge: select_unpredictable(found, room.first + edge, u32::MAX),
        t,
        z,
    };
    let next = Lane {
        ray: lane.ray,
        cell: gate.cell,
        entry: gate.entry,
    };
    (stop, next, !passes)
}

/// Which of eight corners the ray passes on its right.
#[inline(always)]
fn sides<S: Simd>(simd: S, block: &Block, ray: &Ray) -> u64 {
    let (o, d) = (ray.origin, ray.direction);
    let (x, y) = (block.x.as_chunks().0, block.y.as_chunks().0);
    let (x0, x1) = (f64x4::simd_from(simd, x[0]) - o.x, f64x4::simd_from(simd, x[1]) - o.x);
    let (y0, y1) = (f64x4::simd_from(simd, y[0]) - o.y, f64x4::simd_from(simd, y[1]) - o.y);
    let low = (y0 * d.x - x0 * d.y).simd_lt(0.0).to_bitmask();
    let high = (y1 * d.x - x1 * d.y).simd_lt(0.0).to_bitmask();
    low | high << 4
}

/// What has stopped a ray.
#[inline(always)]
fn met(space: &Space, ray: &Ray, stop: &Stop) -> Option<Met> {
    let Stop { lane, edge, t, z } = *stop;
    if edge == u32::MAX {
        return rest(space, ray, &lane);
    }
    let (chamber, border) = (space.cell(lane.cell), space.edge(edge));
    let (cell, edge) = (CellId(lane.cell), EdgeId(edge));
    let (below, above) = (z < chamber.floor, z > chamber.ceiling);
    let level = if below { chamber.floor } else { chamber.ceiling };
    let flat = ((level - ray.origin.z) / ray.direction.z).max(0.0);
    let surface = if below {
        Surface::Floor(cell)
    } else if above {
        Surface::Ceiling(cell)
    } else if border.twin == WALL {
        Surface::Wall(edge)
    } else if z < border.bottom {
        Surface::Step(edge)
    } else if z > border.top {
        Surface::Lintel(edge)
    } else {
        Surface::Pane(edge)
    };
    let t = if below | above { flat } else { t };
    Some(Met { t, surface, cell })
}

/// The way of a ray alone: straight up or down, or through a cell of very many corners.
#[cold]
fn rest(space: &Space, ray: &Ray, lane: &Lane) -> Option<Met> {
    let entry = (lane.entry != INSIDE).then(|| space.layout.room(lane.cell).first + lane.entry);
    walk_on(space, ray, CellId(lane.cell), entry)
}
