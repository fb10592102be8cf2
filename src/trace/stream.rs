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
//! The eight are asked in f32, and those too near a corner or a height to be sure, one of some
//! hundreds, in f64 (`lanes`). Only the last edge of each ray is worked out in f64 (`tell`).
//!
//! O(edges + cells) once, then O(edges of the cells on the way) for each ray. (Measured on six Freedoom
//! maps: a ray crosses 1.8–4.3 cells and asks five corners in each; 87–97% of the lanes are used.
//! Batches of half and of twice the size, and storing one vector's exits during the next one's, change
//! less than the noise; to take the newest queue first is slower. So is one ray at a time with all
//! corners of its cell in a vector, four to sixteen such in turn, with and without branches. Rays that
//! move from lot to lot in columns, packed as they leave, are no faster, nor are vectors of sixteen, on
//! AVX-512 either.)

use fearless_simd::{Level, Simd, dispatch};

mod lanes;
mod own;
mod tell;

use super::cast::{Met, Place};
use super::ray::Ray;
use super::space::Space;
use lanes::{Bound, Exits, Going, exactly, leave};
use own::Own;
use tell::tell;

/// Places for rays: as many as the cache nearest but one holds.
const PLACES: usize = 4096;

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

    /// What the rays meet; `out` is told of each by its number, in order.
    pub fn cast(
        &mut self,
        rays: impl IntoIterator<Item = (Ray, Place)>,
        mut out: impl FnMut(u32, Option<Met>),
    ) {
        let Self {
            space,
            level,
            queues,
        } = self;
        let mut rays = rays.into_iter();
        let mut number = 0;
        loop {
            queues.batch.clear();
            let some = rays.by_ref().take(PLACES - 1);
            queues.batch.extend(some.map(|ray| Own::new(space, ray)));
            let n = queues.batch.len();
            if n == 0 {
                return;
            }
            let given = dispatch!(*level, simd => queues.fill(simd));
            dispatch!(*level, simd => queues.run(simd, space, given));
            let (batch, edges) = (&queues.batch, &queues.edges[1..=n]);
            dispatch!(*level, simd => tell(simd, space, batch, edges, number, &mut out));
            number += n as u32;
        }
    }
}

/// Stands for no ray, and is one that goes nowhere: so that lists and vectors may be filled with it.
const NOBODY: u16 = 0;

/// Rays in lists, one for each edge through which they came into a cell, then one for each cell in
/// which they start, and that of those that have ended.
struct Queues {
    bound: Bound,
    /// The rays as they came; the others have numbers greater by 1.
    batch: Vec<Own>,
    rays: Box<[Going; PLACES]>,
    /// The last edge to which each came; [`u32::MAX`] for none, or where it is not known.
    edges: Box<[u32; PLACES]>,
    /// Whoever came last to each list.
    heads: Vec<u16>,
    /// Who came before each ray, to the same list.
    before: Box<[u16; PLACES]>,
    /// Lists with rays, in a ring: never more of them than rays.
    turns: Box<[u32; PLACES]>,
}

impl Queues {
    fn new(space: &Space) -> Self {
        let lists = space.edges.len() + space.cells.len() + 1;
        Self {
            bound: Bound::new(&space.layout),
            batch: Vec::with_capacity(PLACES),
            rays: Box::new([Going::NOBODY; PLACES]),
            edges: Box::new([u32::MAX; PLACES]),
            heads: vec![NOBODY; lists],
            before: Box::new([NOBODY; PLACES]),
            turns: Box::new([0; PLACES]),
        }
    }

    /// Puts the rays of the batch where they start. Out: the number of turns given out.
    #[inline(always)]
    fn fill<S: Simd>(&mut self, simd: S) -> usize {
        let (rays, before) = (&mut *self.rays, &mut *self.before);
        let (heads, turns) = (&mut self.heads[..], &mut *self.turns);
        let mut given = 0;
        for (own, number) in self.batch.iter().zip(1..) {
            let number: usize = number % PLACES;
            let (going, fits) = Going::new(simd, own, &self.bound);
            rays[number] = going;
            self.edges[number] = u32::MAX;
            if !fits {
                continue;
            }
            let list = own.list();
            let head = &mut heads[list as usize];
            turns[given % PLACES] = list;
            given += usize::from(*head == NOBODY);
            before[number] = *head;
            *head = number as u16;
        }
        given
    }

    /// Takes all rays to their ends; so many turns are given out.
    #[inline(always)]
    fn run<S: Simd>(&mut self, simd: S, space: &Space, mut given: usize) {
        let (rays, before) = (&*self.rays, &mut *self.before);
        let (heads, turns) = (&mut self.heads[..], &mut *self.turns);
        let edges = &mut *self.edges;
        let (layout, bound) = (&space.layout, &self.bound);
        let ended = heads.len() as u32 - 1;
        // Never empty, so that it is never its turn.
        heads[ended as usize] = 1;
        let mut taken = 0;
        // All rays go on by a cell in each round, and no cell is crossed twice.
        let (mut rounds, mut round) = (0, given);
        while taken < given {
            if taken == round {
                (rounds, round) = (rounds + 1, given);
                if rounds > space.cells.len() {
                    lose(
                        edges,
                        before,
                        heads,
                        (taken..given).map(|k| turns[k % PLACES]),
                    );
                    break;
                }
            }
            let list = turns[taken % PLACES];
            taken += 1;
            let [first, past] = layout.asked[list as usize];
            let sides = &layout.sides[first as usize..past as usize];
            let head = std::mem::replace(&mut heads[list as usize], NOBODY);
            let mut next = eight(before, head);
            while next[0] != NOBODY {
                let these = next;
                next = eight(before, before[these[7] as usize % PLACES]);
                let eight = these.map(|i| &rays[i as usize % PLACES]);
                let mut exits = leave(simd, bound, sides, ended, eight);
                while exits.doubt != 0 {
                    let k = exits.doubt.trailing_zeros() as usize;
                    exits.doubt &= exits.doubt - 1;
                    if these[k] != NOBODY {
                        let own = &self.batch[these[k] as usize - 1];
                        (exits.to[k], exits.edge[k]) = exactly(space, list, ended, own);
                    }
                }
                let Exits { to, edge, .. } = exits;
                for k in 0..8 {
                    let ray = these[k] as usize % PLACES;
                    edges[ray] = edge[k];
                    let head = &mut heads[to[k] as usize];
                    turns[given % PLACES] = to[k];
                    given += usize::from(*head == NOBODY);
                    before[ray] = *head;
                    *head = these[k] | u16::from(to[k] == ended);
                }
                before[NOBODY as usize] = NOBODY;
            }
        }
        heads[ended as usize] = NOBODY;
    }
}

/// Rays that are still under way, in these lists, are left to [`walk`](super::cast::walk), which gets them
/// out of their circles.
#[cold]
fn lose(
    edges: &mut [u32; PLACES],
    before: &[u16; PLACES],
    heads: &mut [u16],
    lists: impl Iterator<Item = u32>,
) {
    for list in lists {
        let mut ray = std::mem::replace(&mut heads[list as usize], NOBODY);
        while ray != NOBODY {
            edges[ray as usize] = u32::MAX;
            ray = before[ray as usize];
        }
    }
}

/// The first of a list, and who came before.
#[inline(always)]
fn eight(before: &[u16; PLACES], first: u16) -> [u16; 8] {
    let mut eight = [first; 8];
    for k in 1..8 {
        eight[k] = before[eight[k - 1] as usize % PLACES];
    }
    eight
}
