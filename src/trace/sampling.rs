//! Random numbers that depend on nothing but what they are for.
//!
//! A [`Source`] is seeded by the picture's seed, the pixel and the sample, so the same command gives
//! the same picture on any number of threads; and every pixel can be repeated by itself.

use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A stream of random numbers.
#[derive(Clone, Debug)]
pub struct Source(Pcg64Mcg);

impl Source {
    /// The stream of one sample of one pixel.
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let mixed = mix(mix(mix(seed) ^ pixel) ^ sample);
        Self(Pcg64Mcg::seed_from_u64(mixed))
    }

    /// The next number, in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0.random()
    }

    /// `n` points of the unit square, one in each of as many equal parts of it as there are whole
    /// rows and columns: n = 16 gives a 4 × 4 pattern. Parts of the last, incomplete row are wider.
    pub fn stratified(&mut self, n: u32) -> impl Iterator<Item = DVec2> + '_ {
        let rows = f64::from(n).sqrt().floor().max(1.0) as u32;
        (0..n).map(move |i| {
            // Row r holds the points from n·r/rows on.
            let first = |r: u32| (n * r).div_ceil(rows);
            let row = (0..rows).rev().find(|&r| first(r) <= i).unwrap_or(0);
            let (from, to) = (first(row), first(row + 1));
            let x = (f64::from(i - from) + self.next()) / f64::from(to - from);
            let y = (f64::from(row) + self.next()) / f64::from(rows);
            DVec2::new(x, y)
        })
    }
}

/// A key for a branch of what another key stands for: of a path of rays, its reflected part.
pub fn branch(key: u64, number: u64) -> u64 {
    mix(key ^ mix(number))
}

/// One step of a 64-bit hash (the finaliser of SplitMix64).
fn mix(n: u64) -> u64 {
    let mut z = n.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ() {
        let first = |seed, pixel, sample| Source::new(seed, pixel, sample).next();
        assert_eq!(first(1, 2, 3), first(1, 2, 3));
        let all = [
            first(1, 2, 3),
            first(2, 2, 3),
            first(1, 3, 3),
            first(1, 2, 4),
        ];
        for i in 0..4 {
            assert!((0..i).all(|j| all[i] != all[j]));
        }
    }

    #[test]
    fn every_part_of_the_square_gets_its_point() {
        let points: Vec<DVec2> = Source::new(1, 0, 0).stratified(16).collect();
        let mut parts: Vec<u32> = points
            .iter()
            .map(|p| (p.y * 4.0) as u32 * 4 + (p.x * 4.0) as u32)
            .collect();
        parts.sort();
        assert_eq!(parts, (0..16).collect::<Vec<u32>>());
        for n in [1, 2, 3, 5, 7, 10] {
            let points: Vec<DVec2> = Source::new(1, 0, 0).stratified(n).collect();
            assert_eq!(points.len(), n as usize);
            assert!(points.iter().all(|p| p.x < 1.0 && p.y < 1.0));
        }
    }
}
