//! Sets of openings, each kept once, and their unions and intersections by number.

use std::sync::Mutex;

use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// Openings, ascending.
pub(super) type Set = SmallVec<[u32; 6]>;

/// Index into [`Sets::list`]: of the empty set, and of none yet, which is as good as all openings.
pub(super) const EMPTY: u32 = 0;
pub(super) const ALL: u32 = u32::MAX;

/// Sets of openings, each once. (Their numbers depend on the threads' turns, what they hold does not.)
pub(super) struct Sets {
    pub(super) list: Vec<Set>,
    number: FxHashMap<Set, u32>,
}

impl Default for Sets {
    fn default() -> Self {
        Self {
            list: vec![Set::new()],
            number: [(Set::new(), EMPTY)].into_iter().collect(),
        }
    }
}

impl Sets {
    fn intern(&mut self, set: Set) -> u32 {
        let next = self.list.len() as u32;
        let list = &mut self.list;
        *self.number.entry(set).or_insert_with_key(|set| {
            list.push(set.clone());
            next
        })
    }
}

/// What a thread knows of sums and products of sets.
pub(super) struct Algebra<'a> {
    pub(super) sets: &'a Mutex<Sets>,
    unions: FxHashMap<(u32, u32), u32>,
    meets: FxHashMap<(u32, u32), u32>,
    singles: FxHashMap<u32, u32>,
}

impl<'a> Algebra<'a> {
    /// Of sets that other threads work with, too.
    pub(super) fn new(sets: &'a Mutex<Sets>) -> Self {
        Self {
            sets,
            unions: FxHashMap::default(),
            meets: FxHashMap::default(),
            singles: FxHashMap::default(),
        }
    }

    pub(super) fn single(&mut self, mark: u32) -> u32 {
        let sets = self.sets;
        *self
            .singles
            .entry(mark)
            .or_insert_with(|| locked(sets, |sets| sets.intern(SmallVec::from_slice(&[mark]))))
    }

    #[inline]
    pub(super) fn union(&mut self, a: u32, b: u32) -> u32 {
        if a == EMPTY || a == b {
            return b;
        }
        if b == EMPTY {
            return a;
        }
        let sets = self.sets;
        *self.unions.entry((a.min(b), a.max(b))).or_insert_with(|| {
            locked(sets, |sets| {
                let mut both: Set = sets.list[a as usize].clone();
                both.extend_from_slice(&sets.list[b as usize]);
                both.sort_unstable();
                both.dedup();
                sets.intern(both)
            })
        })
    }

    #[inline]
    pub(super) fn meet(&mut self, a: u32, b: u32) -> u32 {
        if a == ALL || a == b {
            return b;
        }
        if a == EMPTY || b == EMPTY {
            return EMPTY;
        }
        let sets = self.sets;
        *self.meets.entry((a.min(b), a.max(b))).or_insert_with(|| {
            locked(sets, |sets| {
                let [p, q] = [a, b].map(|s| &sets.list[s as usize]);
                let both: Set = p.iter().copied().filter(|o| q.contains(o)).collect();
                sets.intern(both)
            })
        })
    }
}

fn locked<T>(sets: &Mutex<Sets>, work: impl FnOnce(&mut Sets) -> T) -> T {
    work(&mut sets.lock().unwrap_or_else(|e| e.into_inner()))
}
