//! A slot for every pair of cells that see each other.

use std::sync::atomic::AtomicU32;

use super::sets::ALL;
use crate::pvs::Pvs;

/// A place for every pair of cells that see each other, the first of lower number.
pub(super) struct Pairs<'a> {
    pub(super) pvs: &'a Pvs,
    /// For each word of the visible sets, how many pairs come before it.
    before: Vec<u32>,
    pub(super) slots: Vec<AtomicU32>,
}

impl<'a> Pairs<'a> {
    pub(super) fn of(pvs: &'a Pvs) -> Self {
        let (n, stride) = (pvs.visible.n(), pvs.visible.stride());
        let mut before = Vec::with_capacity(n * stride);
        let mut count = 0;
        for a in 0..n {
            for (k, word) in pvs.visible.row(a).iter().enumerate() {
                before.push(count);
                count += (word & after(a, k)).count_ones();
            }
        }
        let slots = (0..count).map(|_| AtomicU32::new(ALL)).collect();
        Self { pvs, before, slots }
    }

    pub(super) fn first_of(&self, a: usize) -> usize {
        self.before[a * self.pvs.visible.stride()] as usize
    }

    /// The place of a pair that see each other, `a < b`.
    #[inline]
    pub(super) fn rank(&self, a: u32, b: u32) -> usize {
        let (a, b) = (a as usize, b as usize);
        let (k, stride) = (b / 64, self.pvs.visible.stride());
        let word = self.pvs.visible.row(a)[k] & after(a, k);
        let lower = word & ((1 << (b % 64)) - 1);
        (self.before[a * stride + k] + lower.count_ones()) as usize
    }
}

/// The bits of word `k` that are of numbers above `a`.
#[inline]
fn after(a: usize, k: usize) -> u64 {
    match k.cmp(&(a / 64)) {
        std::cmp::Ordering::Less => 0,
        std::cmp::Ordering::Greater => !0,
        std::cmp::Ordering::Equal => (!0 << (a % 64)) & !(1 << (a % 64)),
    }
}
