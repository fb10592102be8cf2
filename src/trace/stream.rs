//! Rays without order: sorted by the cell in which they are, again and again.
//!
//! In: rays and the places where they start. Out: for each what [`super::walk`] gives, to the last
//! bit. Rays that have nothing in common but the cell, and the edge through which they came, still ask
//! the same corners in the same order. So they wait at that edge until it is their turn, and go on in
//! vectors of four: each queue has its list of rays, linked by number, and queues take turns in the
//! order in which their first ray came. Nothing in the inner loop branches on what a ray does: where it
//! leaves and whether it goes on are choices between numbers, and a ray that ends joins a last list
//! that is never asked. What stopped it is found out afterwards.
//!
//! O(edges + cells) once, then O(edges of the cells on the way) for each ray. (Measured and dropped:
//! eight rays in turn, each with a vector of eight corners, is slower by a third.)

use std::hint::select_unpredictable;

use fearless_simd::{Level, Simd, dispatch, f64x4, prelude::*};
use glam::DVec3;

use super::cast::{Met, Place, edge_of, face, walk};
use super::layout::{INSIDE, Layout, Room};
use super::ray::Ray;
use super::space::{Space, Surface};
use crate::cells::{CellId, EdgeId};

/// How many rays are sorted at a time: as many as the cache nearest but one holds.
const BATCH: usize = 4096;

/// What the rays meet; `out` is told of each by its number, in order.
pub fn cast(
    space: &Space,
    rays: impl IntoIterator<Item = (Ray, Place)>,
    out: impl FnMut(u32, Option<Met>),
) {
    cast_at(Level::new(), space, rays, out);
}

/// As [`cast`], with the vectors of this level.
pub(super) fn cast_at(
    level: Level,
    space: &Space,
    rays: impl IntoIterator<Item = (Ray, Place)>,
    mut out: impl FnMut(u32, Option<Met>),
) {
    let mut rays = rays.into_iter();
    let mut batch: Vec<(Ray, Place)> = Vec::new();
    let mut queues = Queues::new(space);
    let mut number = 0;
    loop {
        batch.clear();
        batch.extend(rays.by_ref().take(BATCH));
        if batch.is_empty() {
            return;
        }
        queues.fill(space, &batch);
        dispatch!(level, simd => queues.run(simd, space));
        for ((ray, place), stop) in batch.iter().zip(&queues.stops[1..]) {
            out(number, met(space, ray, *place, stop));
            number += 1;
        }
    }
}

/// A ray under way; what is asked on the plan comes first.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Going {
    origin: [f64; 2],
    direction: [f64; 2],
    z: [f64; 2],
}

/// Where a ray crosses the last edge it came to.
#[derive(Clone, Copy, Default)]
struct Stop {
    t: f64,
    z: f64,
    /// [`u32::MAX`] if it leaves its cell through none.
    edge: u32,
    cell: u32,
}

/// Stands for no ray, and is one that goes nowhere: so that lists and vectors may be filled with it.
const NOBODY: u32 = 0;

/// Rays in lists, one for each edge through which they came into a cell, then one for each cell in
/// which they start, and that of those that have ended.
struct Queues {
    /// Whoever came last to each list.
    heads: Vec<u32>,
    /// Who came before each ray, to the same list.
    before: Vec<u32>,
    /// Lists with rays, in a ring.
    turns: Vec<u32>,
    /// Number of turns so far given out.
    given: usize,
    rays: Vec<Going>,
    stops: Vec<Stop>,
}

impl Queues {
    fn new(space: &Space) -> Self {
        let lists = space.edges.len() + space.cells.len() + 1;
        Self {
            heads: vec![NOBODY; lists],
            before: Vec::new(),
            turns: vec![0; (lists + 1).next_power_of_two()],
            given: 0,
            rays: Vec::new(),
            stops: Vec::new(),
        }
    }

    /// Puts the rays where they start.
    fn fill(&mut self, space: &Space, batch: &[(Ray, Place)]) {
        self.rays.clear();
        self.before.clear();
        self.given = 0;
        self.stops.resize(batch.len() + 1, Stop::default());
        let nobody = Going::new(&Ray {
            origin: DVec3::ZERO,
            direction: DVec3::ZERO,
        });
        self.rays.push(nobody);
        self.before.push(NOBODY);
        let turn = self.turns.len() - 1;
        for ((ray, place), number) in batch.iter().zip(1..) {
            let list = match place.on.and_then(edge_of) {
                Some(e) if space.edge(e).cell == place.cell.0 => e,
                Some(e) => space.edge(e).twin,
                None => space.edges.len() as u32 + place.cell.0,
            };
            let head = &mut self.heads[list as usize];
            self.turns[self.given & turn] = list;
            self.given += usize::from(*head == NOBODY);
            self.rays.push(Going::new(ray));
            self.before.push(*head);
            *head = number;
        }
    }

    /// Takes all rays to their ends.
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, space: &Space) {
        let layout = &space.layout;
        let (n_edges, ended) = (space.edges.len() as u32, self.heads.len() as u32 - 1);
        let turn = self.turns.len() - 1;
        // Never empty, so that it is never its turn.
        self.heads[ended as usize] = 1;
        let mut taken = 0;
        while taken < self.given {
            let list = self.turns[taken & turn];
            taken += 1;
            let (cell, entry) = if list < n_edges {
                let cell = space.edge(list).cell;
                (cell, list - layout.room(cell).first)
            } else {
                (list - n_edges, INSIDE)
            };
            let room = layout.room(cell);
            let mut first = std::mem::replace(&mut self.heads[list as usize], NOBODY);
            while first != NOBODY {
                let second = self.before[first as usize];
                let third = self.before[second as usize];
                let fourth = self.before[third as usize];
                let four = [first, second, third, fourth];
                first = self.before[fourth as usize];
                let rays = four.map(|i| &self.rays[i as usize]);
                let (exits, passes) = leave(simd, layout, room, entry, rays);
                for (k, &number) in four.iter().enumerate() {
                    let (ray, edge) = (number as usize, exits.edge[k].to_bits() as u32);
                    let found = ((exits.found >> k) & 1) as u32;
                    self.stops[ray] = Stop {
                        t: exits.t[k],
                        z: exits.z[k],
                        edge: edge | found.wrapping_sub(1),
                        cell,
                    };
                    let twin = layout.gates[edge as usize].twin;
                    let to = select_unpredictable((passes >> k) & 1 != 0, twin, ended);
                    let head = &mut self.heads[to as usize];
                    self.turns[self.given & turn] = to;
                    self.given += usize::from(*head == NOBODY);
                    self.before[ray] = *head;
                    *head = number | u32::from(to == ended);
                }
                self.before[NOBODY as usize] = NOBODY;
            }
        }
        self.heads[ended as usize] = NOBODY;
    }
}

impl Going {
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.truncate().to_array(),
            direction: ray.direction.truncate().to_array(),
            z: [ray.origin.z, ray.direction.z],
        }
    }
}

/// Where four rays leave their cell.
struct Exits {
    t: [f64; 4],
    z: [f64; 4],
    /// Numbers of edges, as bits.
    edge: [f64; 4],
    /// Which of them leave at all.
    found: u64,
}

/// Takes four rays that came through one edge to the end of their cell; and which of them go on.
#[inline(always)]
fn leave<S: Simd>(
    simd: S,
    layout: &Layout,
    room: Room,
    entry: u32,
    rays: [&Going; 4],
) -> (Exits, u64) {
    let ox = f64x4::simd_from(simd, rays.map(|r| r.origin[0]));
    let oy = f64x4::simd_from(simd, rays.map(|r| r.origin[1]));
    let dx = f64x4::simd_from(simd, rays.map(|r| r.direction[0]));
    let dy = f64x4::simd_from(simd, rays.map(|r| r.direction[1]));
    let zero = f64x4::splat(simd, 0.0);
    let (mut edge, n) = match entry {
        INSIDE => (0, room.n),
        entry => (room.next(entry), room.n - 1),
    };
    let corner = layout.corner(room, edge);
    let mut ax = f64x4::splat(simd, corner.x) - ox;
    let mut ay = f64x4::splat(simd, corner.y) - oy;
    let mut from = dx * ay - dy * ax;
    let mut inside = zero.simd_eq(zero);
    let (mut across, mut width, mut which) = (zero, zero, zero);
    let (mut low, mut high) = (zero, zero);
    for _ in 0..n {
        let end = room.next(edge);
        let corner = layout.corner(room, end);
        let bx = f64x4::splat(simd, corner.x) - ox;
        let by = f64x4::splat(simd, corner.y) - oy;
        let to = dx * by - dy * bx;
        let exits = from.simd_lt(zero) & to.simd_ge(zero) & inside;
        let gate = layout.gate(room, edge);
        let number = f64::from_bits(u64::from(room.first + edge));
        across = exits.select(ax * by - ay * bx, across);
        width = exits.select(to - from, width);
        low = exits.select(f64x4::splat(simd, gate.low), low);
        high = exits.select(f64x4::splat(simd, gate.high), high);
        which = exits.select(f64x4::splat(simd, number), which);
        inside &= !exits;
        (ax, ay, from, edge) = (bx, by, to, end);
    }
    let oz = f64x4::simd_from(simd, rays.map(|r| r.z[0]));
    let dz = f64x4::simd_from(simd, rays.map(|r| r.z[1]));
    let t = (across / width).max(zero);
    let z = t * dz + oz;
    let found = !inside.to_bitmask() & 15;
    let passes = (z.simd_ge(low) & z.simd_le(high)).to_bitmask() & found;
    let exits = Exits {
        t: *t,
        z: *z,
        edge: *which,
        found,
    };
    (exits, passes)
}

/// What has stopped a ray.
#[inline]
fn met(space: &Space, ray: &Ray, start: Place, stop: &Stop) -> Option<Met> {
    let Stop { t, z, edge, cell } = *stop;
    if edge == u32::MAX {
        // Straight up or down, or grazing a cell in a corner.
        return walk(space, ray, start, f64::INFINITY, |_, _| f64::INFINITY);
    }
    let (chamber, border) = (space.cell(cell), space.edge(edge));
    let (cell, edge) = (CellId(cell), EdgeId(edge));
    let flat = |level: f64, surface| Met {
        t: ((level - ray.origin.z) / ray.direction.z).max(0.0),
        surface,
        cell,
    };
    let upright = |surface| Met { t, surface, cell };
    Some(if z < chamber.floor {
        flat(chamber.floor, Surface::Floor(cell))
    } else if z > chamber.ceiling {
        flat(chamber.ceiling, Surface::Ceiling(cell))
    } else {
        upright(face(border, edge.0, z)?)
    })
}
