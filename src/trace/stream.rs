//! Rays without order: sorted by the cell in which they are, again and again.
//!
//! In: rays and the places where they start. Out: for each what [`super::walk`] gives, to the last
//! bit. Rays that have nothing in common but the cell, and the edge through which they came, still ask
//! the same corners in the same order. So they wait at that edge until it is their turn, and go on in
//! vectors of eight: each queue has its list of rays, linked by number, and queues take turns in the
//! order in which their first ray came. Nothing in the inner loop branches on what a ray does: where it
//! leaves and whether it goes on are choices between numbers, and a ray that ends joins a last list
//! that is never asked. What stopped it is found out afterwards.
//!
//! Nor does anything in it wait for what the ray before has done. So a list that gets its first ray is
//! not told from one that has some: all eight lists that a vector joins are noted for a turn, and
//! those that are empty when it comes, since others have noted them too, are passed over.
//!
//! Where the caller has more to ask of a ray than these cells know (things may stand in one), rays leave
//! the stream as they come in, and the caller goes on with them.
//!
//! The eight are asked in f32, and those too near a corner or a height to be sure, one of some
//! hundreds, in f64 (`lanes`). Only the last edge of each ray is worked out in f64 (`tell`).
//!
//! O(edges + cells) once, then O(edges of the cells on the way) for each ray. (Measured on six Freedoom
//! maps: a ray crosses 2.8–5.0 cells and asks six corners in each; 83–96% of the lanes are used. Batches
//! of half the size are slower, of twice the size no faster; nor are two vectors at a time, packed
//! columns that move from lot to lot, one ray at a time with all corners of its cell in a vector, or
//! taking the newest queue first.)

use fearless_simd::{Level, Simd, dispatch};

mod lanes;
mod own;
mod shuffle;
mod tell;

use super::cast::{Met, Place};
use super::ray::Ray;
use super::space::Space;
use crate::cells::CellId;
use lanes::{Bound, Exits, Going, exactly, leave};
use own::{Own, cell_and_entry};
use tell::tell;

/// Rays that are under way together: as many as the cache nearest but one holds.
const PLACES: usize = 4096;

/// A batch of them: one place is [`NOBODY`]'s, and fours are filled up.
pub(super) const BATCH: usize = PLACES - 4;

/// As many numbers as a `u16` has, so that it needs no check as an index.
const NUMBERS: usize = 1 << 16;

/// How a ray of a stream ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// It meets something, as [`walk`](super::walk) tells.
    Meets(Met),
    /// It meets nothing.
    Nothing,
    /// It has come, through this edge if it did not start there, into a cell that stops rays.
    Stops(CellId, Option<u32>),
}

/// What is needed to cast rays without order in a space, again and again.
pub struct Stream<'a> {
    space: &'a Space,
    level: Level,
    queues: Queues,
}

impl<'a> Stream<'a> {
    /// For this space: O(edges + cells).
    pub fn new(space: &'a Space) -> Self {
        Self::at(Level::new(), space)
    }

    /// With the vectors of this level.
    pub(super) fn at(level: Level, space: &'a Space) -> Self {
        Self {
            space,
            level,
            queues: Queues::new(space),
        }
    }

    /// From now on rays end where they come into a cell of which `stops` says so, or start in one.
    pub fn stop(&mut self, stops: impl Fn(CellId) -> bool) {
        self.queues.stop(self.space, stops);
    }

    /// How the rays end; `out` is told of each by its number, in order.
    pub fn cast(
        &mut self,
        rays: impl IntoIterator<Item = (Ray, Place)>,
        mut out: impl FnMut(u32, End),
    ) {
        let Self {
            space,
            level,
            queues,
        } = self;
        let mut rays = rays.into_iter().fuse();
        let mut number = 0;
        loop {
            let n = dispatch!(*level, simd => queues.fill(simd, space, &mut rays));
            if n == 0 {
                return;
            }
            dispatch!(*level, simd => queues.run(simd, space));
            let (batch, ends) = (&queues.batch[..n], &queues.before[1..=n]);
            let walk = !queues.stopping;
            dispatch!(*level, simd => tell(simd, space, batch, ends, walk, number, &mut out));
            number += n as u32;
        }
    }
}

/// Stands for no edge, or one that is not known.
const NONE: u32 = u32::MAX;

/// Added to a list's number, if that is where a ray has been stopped.
const STOPPED: u32 = 1 << 31;

/// Stands for no ray, and is one that goes nowhere: so that lists and vectors may be filled with it.
const NOBODY: u32 = 0;

/// Rays in lists, one for each edge through which they came into a cell, then one for each cell in
/// which they start, and eight of those that have ended: the k-th of a vector joins the k-th.
struct Queues {
    bound: Bound,
    /// The rays as they came, in fours, the last repeated; the others have numbers greater by 1.
    batch: Vec<Own>,
    rays: Box<[Going; PLACES]>,
    /// Whoever came last to each list.
    heads: Vec<u32>,
    /// By list, whether rays are stopped there; whether any are anywhere.
    stops: Vec<bool>,
    stopping: bool,
    /// Who came before each ray, to the same list; of one that has ended, the last edge to which it
    /// came, or [`NONE`], or [`STOPPED`] and a list.
    before: Box<[u32; NUMBERS]>,
    /// Lists that may have rays, in a ring; eight for each vector. Rays make as many vectors in a round
    /// at most, and the notes of two rounds are kept at most.
    turns: Box<[[u32; 8]; NUMBERS / 8]>,
}

const _: () = assert!(2 * PLACES <= NUMBERS / 8);

impl Queues {
    fn new(space: &Space) -> Self {
        let lists = space.edges.len() + space.cells.len();
        let mut rays = Box::new([Going([[0.0; 4]; 2]); PLACES]);
        rays[NOBODY as usize] = Going::NOBODY;
        Self {
            bound: Bound::new(&space.layout),
            batch: Vec::with_capacity(PLACES),
            rays,
            heads: vec![NOBODY; lists + 8],
            stops: vec![false; lists],
            stopping: false,
            before: bytemuck::zeroed_box(),
            turns: bytemuck::zeroed_box(),
        }
    }

    fn stop(&mut self, space: &Space, stops: impl Fn(CellId) -> bool) {
        for (list, stop) in (0..).zip(&mut self.stops) {
            *stop = stops(cell_and_entry(space, list).0);
        }
        self.stopping = self.stops.contains(&true);
    }

    /// Puts the next rays where they start, and notes that. Out: how many.
    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        simd: S,
        space: &Space,
        next: &mut impl Iterator<Item = (Ray, Place)>,
    ) -> usize {
        let (rays, before) = (&mut *self.rays, &mut *self.before);
        let (heads, turns) = (&mut self.heads[..], &mut *self.turns);
        let notes = turns.as_flattened_mut().as_chunks_mut::<4>().0;
        self.batch.clear();
        let (mut n, mut number) = (0, 1u16);
        for note in &mut notes[..BATCH / 4] {
            let Some(first) = next.next() else {
                break;
            };
            let mut four = [Own::new(space, first); 4];
            n += 1;
            for k in 1..4 {
                four[k] = four[k - 1];
                if let Some(ray) = next.next() {
                    four[k] = Own::new(space, ray);
                    n += 1;
                }
            }
            self.batch.extend_from_slice(&four);
            let (going, fits) = Going::four(simd, &four, &self.bound);
            *note = four.each_ref().map(Own::list);
            for k in 0..4 {
                rays[number as usize % PLACES] = going[k];
                let before = &mut before[number as usize];
                if fits >> k & 1 != 0 {
                    let head = &mut heads[note[k] as usize];
                    *before = std::mem::replace(head, u32::from(number));
                } else {
                    *before = NONE;
                }
                number += 1;
            }
        }
        n
    }

    /// Takes all rays to their ends.
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, space: &Space) {
        let (layout, bound, batch) = (&space.layout, &self.bound, &self.batch);
        let (rays, before) = (&*self.rays, &mut *self.before);
        let (heads, turns) = (&mut self.heads[..], &mut *self.turns);
        let ended = heads.len() as u32 - 8;
        // The last note of an odd number of fours is of a batch before, and harmless: its lists are
        // empty, or have their turn early.
        let (mut taken, mut noted) = (0, batch.len().div_ceil(8));
        // All rays go on by a cell in each round, and no cell is crossed twice.
        let (mut rounds, mut round) = (0, noted);
        while taken < noted {
            if taken == round {
                (rounds, round) = (rounds + 1, noted);
                if rounds > space.cells.len() {
                    let left = (taken..noted).flat_map(|k| turns[k % turns.len()]);
                    lose(before, heads, left);
                    return;
                }
            }
            let note = taken % turns.len();
            taken += 1;
            if turns[note]
                .iter()
                .fold(0, |any, &list| any | heads[list as usize])
                == NOBODY
            {
                continue;
            }
            for k in 0..8 {
                let list = turns[note][k];
                let head = std::mem::replace(&mut heads[list as usize], NOBODY);
                if head == NOBODY {
                    continue;
                }
                if self.stops[list as usize] {
                    end(before, head, STOPPED | list);
                    continue;
                }
                let asked = &layout.asked[list as usize];
                let mut next = eight(before, head);
                while u32::from(next[0]) != NOBODY {
                    let these = next;
                    next = eight(before, before[these[7] as usize]);
                    let eight = these.map(|i| &rays[i as usize % PLACES]);
                    let mut exits = leave(simd, layout, bound, asked, ended, eight);
                    if exits.doubt != 0 {
                        exits = settle(space, batch, list, ended, these, exits);
                    }
                    let Exits { to, edge, .. } = exits;
                    // Whoever ends finds there what is to be kept of it.
                    heads[ended as usize..][..8].copy_from_slice(&edge);
                    for k in 0..8 {
                        let head = &mut heads[to[k] as usize];
                        before[these[k] as usize] = std::mem::replace(head, u32::from(these[k]));
                    }
                    // Never for a turn.
                    heads[ended as usize..][..8].copy_from_slice(&[NOBODY; 8]);
                    before[NOBODY as usize] = NOBODY;
                    turns[noted % turns.len()] = to;
                    noted += 1;
                }
            }
        }
    }
}

/// Finds out in f64 what is in doubt of eight rays.
#[cold]
#[inline(never)]
fn settle(
    space: &Space,
    batch: &[Own],
    list: u32,
    ended: u32,
    these: [u16; 8],
    mut exits: Exits,
) -> Exits {
    while exits.doubt != 0 {
        let k = exits.doubt.trailing_zeros() as usize;
        exits.doubt &= exits.doubt - 1;
        if u32::from(these[k]) != NOBODY {
            let own = &batch[these[k] as usize - 1];
            let (twin, edge) = exactly(space, list, own);
            exits.to[k] = twin.unwrap_or(ended + k as u32);
            exits.edge[k] = edge;
        }
    }
    exits
}

/// Rays that are still under way, in these lists, are left to [`walk`](super::cast::walk), which gets them
/// out of their circles.
#[cold]
fn lose(before: &mut [u32; NUMBERS], heads: &mut [u32], lists: impl Iterator<Item = u32>) {
    for list in lists {
        let head = std::mem::replace(&mut heads[list as usize], NOBODY);
        end(before, head, NONE);
    }
}

/// The rays of a list end so.
fn end(before: &mut [u32; NUMBERS], mut ray: u32, so: u32) {
    while ray != NOBODY {
        ray = std::mem::replace(&mut before[ray as usize], so);
    }
}

/// The first of a list, and who came before.
#[inline(always)]
fn eight(before: &[u32; NUMBERS], first: u32) -> [u16; 8] {
    let mut eight = [first as u16; 8];
    for k in 1..8 {
        eight[k] = before[eight[k - 1] as usize] as u16;
    }
    eight
}
