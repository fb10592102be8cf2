//! Square bit matrices, and small sets that are ORed into their rows.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

/// An n×n matrix of bits, row after row; bit `j` of row `i` is bit `j % 64` of word `j / 64`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BitMatrix {
    n: usize,
    words: Vec<u64>,
}

impl BitMatrix {
    /// All zero.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            words: vec![0; n * n.div_ceil(64)],
        }
    }

    /// Rows (and columns).
    pub fn n(&self) -> usize {
        self.n
    }

    /// Words in a row.
    pub fn stride(&self) -> usize {
        self.n.div_ceil(64)
    }

    /// A row's words; bits past `n` are zero.
    pub fn row(&self, i: usize) -> &[u64] {
        let stride = self.stride();
        &self.words[i * stride..(i + 1) * stride]
    }

    /// A row's words, to be changed. Bits past `n` must stay zero.
    pub fn row_mut(&mut self, i: usize) -> &mut [u64] {
        let stride = self.stride();
        &mut self.words[i * stride..(i + 1) * stride]
    }

    /// All rows, to be changed side by side. Bits past `n` must stay zero.
    pub fn par_rows_mut(&mut self) -> impl IndexedParallelIterator<Item = &mut [u64]> {
        let stride = self.stride().max(1);
        self.words.par_chunks_mut(stride)
    }

    /// Bit `j` of row `i`.
    pub fn get(&self, i: usize, j: usize) -> bool {
        self.row(i)[j / 64] >> (j % 64) & 1 != 0
    }

    /// Sets bit `j` of row `i`.
    pub fn set(&mut self, i: usize, j: usize) {
        self.row_mut(i)[j / 64] |= 1 << (j % 64);
    }

    /// The ones of row `i`, ascending.
    pub fn ones(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        ones(self.row(i))
    }

    /// Number of ones in row `i`.
    pub fn count(&self, i: usize) -> usize {
        self.row(i).iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Number of ones.
    pub fn total(&self) -> u64 {
        self.words
            .par_iter()
            .map(|w| u64::from(w.count_ones()))
            .sum()
    }

    /// The matrix together with its transpose and the diagonal. O(n²/64), in parallel.
    pub fn symmetric(self) -> BitMatrix {
        let words = self.words.into_iter().map(AtomicU64::new).collect();
        SharedBits { n: self.n, words }.symmetric()
    }

    /// Whether the matrix equals its transpose.
    pub fn is_symmetric(&self) -> bool {
        (0..self.n).all(|i| self.ones(i).all(|j| self.get(j, i)))
    }
}

/// The ones of a row of words, ascending.
pub fn ones(words: &[u64]) -> impl Iterator<Item = usize> + Clone + '_ {
    words.iter().enumerate().flat_map(|(i, &word)| {
        std::iter::successors(Some(word), |w| Some(w & w.wrapping_sub(1)))
            .take_while(|w| *w != 0)
            .map(move |w| i * 64 + w.trailing_zeros() as usize)
    })
}

/// A bit matrix into which several threads set bits. Setting is commutative, so the result does not
/// depend on their order.
pub(super) struct SharedBits {
    n: usize,
    words: Vec<AtomicU64>,
}

impl SharedBits {
    /// All zero. The pages are first touched by whoever sets bits in them.
    pub fn new(n: usize) -> Self {
        Self {
            n,
            words: bytemuck::allocation::zeroed_vec(n * n.div_ceil(64)),
        }
    }

    /// Sets all bits of `set` in row `i`. Most are set already: those cost a load.
    #[inline]
    pub fn or_row(&self, i: u32, set: &SmallSet) {
        let stride = self.n.div_ceil(64);
        let row = &self.words[i as usize * stride..(i as usize + 1) * stride];
        set.for_each_word(|k, word| {
            if row[k].load(Relaxed) & word != word {
                row[k].fetch_or(word, Relaxed);
            }
        });
    }

    /// The matrix together with its transpose and the diagonal. O(n²/64), in parallel.
    pub fn symmetric(self) -> BitMatrix {
        let stride = self.n.div_ceil(64);
        // Squares of 64×64 bits across the diagonal from each other are joined by one thread; no
        // other reads or writes them, so that plain loads and stores suffice.
        (0..stride).into_par_iter().for_each(|row| {
            for column in row..stride {
                let mut upper = self.square(row, column);
                if row == column {
                    let mut other = upper;
                    transpose(&mut other);
                    for (k, (word, other)) in upper.iter_mut().zip(other).enumerate() {
                        *word |= other | 1 << k;
                    }
                    self.set_square(row, column, &upper);
                    continue;
                }
                let mut lower = self.square(column, row);
                if upper == [0; 64] && lower == [0; 64] {
                    continue;
                }
                let (mut to_lower, mut to_upper) = (upper, lower);
                transpose(&mut to_lower);
                transpose(&mut to_upper);
                for k in 0..64 {
                    upper[k] |= to_upper[k];
                    lower[k] |= to_lower[k];
                }
                self.set_square(row, column, &upper);
                self.set_square(column, row, &lower);
            }
        });
        let words = self.words.into_iter().map(AtomicU64::into_inner).collect();
        BitMatrix { n: self.n, words }
    }

    /// Word `column` of the 64 rows of block `row`; zero past the last row.
    fn square(&self, row: usize, column: usize) -> [u64; 64] {
        let stride = self.n.div_ceil(64);
        std::array::from_fn(|k| {
            let i = row * 64 + k;
            if i < self.n {
                self.words[i * stride + column].load(Relaxed)
            } else {
                0
            }
        })
    }

    fn set_square(&self, row: usize, column: usize, square: &[u64; 64]) {
        let stride = self.n.div_ceil(64);
        for (i, word) in (row * 64..self.n).zip(square) {
            self.words[i * stride + column].store(*word, Relaxed);
        }
    }
}

/// Transposes a 64×64 bit matrix (Warren, "Hacker's Delight", 7-3, with the least bit first).
fn transpose(a: &mut [u64; 64]) {
    let mut width = 32;
    let mut mask = 0x0000_0000_ffff_ffffu64;
    while width != 0 {
        let mut k = 0;
        while k < 64 {
            let swap = ((a[k] >> width) ^ a[k + width]) & mask;
            a[k] ^= swap << width;
            a[k + width] ^= swap;
            k = (k + width + 1) & !width;
        }
        width >>= 1;
        mask ^= mask << width;
    }
}

/// A changing set of few cells, with its non-empty words found through a summary.
pub(super) struct SmallSet {
    words: Vec<u64>,
    /// Bit k is set if word k is not zero.
    summary: Vec<u64>,
}

impl SmallSet {
    pub fn new(n: usize) -> Self {
        let words = n.div_ceil(64);
        Self {
            words: vec![0; words],
            summary: vec![0; words.div_ceil(64)],
        }
    }

    #[inline]
    pub fn insert(&mut self, i: u32) {
        let k = (i / 64) as usize;
        self.words[k] |= 1 << (i % 64);
        self.summary[k / 64] |= 1 << (k % 64);
    }

    #[inline]
    pub fn remove(&mut self, i: u32) {
        let k = (i / 64) as usize;
        self.words[k] &= !(1 << (i % 64));
        if self.words[k] == 0 {
            self.summary[k / 64] &= !(1 << (k % 64));
        }
    }

    pub fn clear(&mut self) {
        for (block, summary) in self.summary.iter_mut().enumerate() {
            while *summary != 0 {
                self.words[block * 64 + summary.trailing_zeros() as usize] = 0;
                *summary &= *summary - 1;
            }
        }
    }

    #[inline]
    fn for_each_word(&self, mut f: impl FnMut(usize, u64)) {
        for (block, &summary) in self.summary.iter().enumerate() {
            let mut rest = summary;
            while rest != 0 {
                let k = block * 64 + rest.trailing_zeros() as usize;
                f(k, self.words[k]);
                rest &= rest - 1;
            }
        }
    }

    pub fn for_each(&self, mut f: impl FnMut(u32)) {
        self.for_each_word(|k, mut word| {
            while word != 0 {
                f(k as u32 * 64 + word.trailing_zeros());
                word &= word - 1;
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetric_adds_the_transpose_and_the_diagonal() {
        for n in [1, 5, 64, 65, 130, 200] {
            let shared = SharedBits::new(n);
            let mut expected = BitMatrix::new(n);
            let mut set = SmallSet::new(n);
            for i in 0..n {
                let j = (i * 37 + 11) % n;
                set.clear();
                set.insert(j as u32);
                shared.or_row(i as u32, &set);
                expected.set(i, i);
                expected.set(i, j);
                expected.set(j, i);
            }
            let result = shared.symmetric();
            assert_eq!(result, expected, "n = {n}");
            assert!(result.is_symmetric());
            assert_eq!(
                result.total() as usize,
                (0..n).map(|i| result.ones(i).count()).sum::<usize>()
            );
        }
    }

    #[test]
    fn a_small_set_forgets_what_is_removed() {
        let mut set = SmallSet::new(5000);
        for i in [3, 64, 70, 4999] {
            set.insert(i);
        }
        set.remove(64);
        set.remove(3);
        let mut seen = Vec::new();
        set.for_each(|i| seen.push(i));
        assert_eq!(seen, [70, 4999]);
        set.clear();
        set.for_each(|_| panic!("empty"));
    }
}
