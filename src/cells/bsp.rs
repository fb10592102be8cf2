//! The rule of the BSP: split by the line of one of the walls.
//!
//! A few candidates are tried on a few of the walls, and the one that cuts the fewest and balances
//! best is taken. Source: lecture, "BSP tree: Partitioning" ("testing the plane against a small
//! random number of polygons"); evenly spread ones here, so that every run gives the same tree.

use super::arrangement::{Arrangement, LineId};
use super::partition::Fragment;
use crate::geom::Side;

/// Options of [`choose`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BspOptions {
    /// How many walls are tried as the splitting line; at least 1.
    pub candidates: usize,
    /// On how many walls each candidate is tried, at most; at least 2.
    pub sample: usize,
    /// What a cut wall costs, …
    pub split_weight: u32,
    /// … compared with one wall more on the one side than on the other.
    pub balance_weight: u32,
}

impl BspOptions {
    /// What is taken unless somebody asks for something else.
    pub const USUAL: Self = Self {
        candidates: 8,
        sample: 64,
        split_weight: 8,
        balance_weight: 1,
    };
}

impl Default for BspOptions {
    fn default() -> Self {
        Self::USUAL
    }
}

/// So few walls that any line that cuts none of them will do.
const FEW: usize = 24;

/// The best line among a few of the fragments' own.
pub fn choose(arrangement: &Arrangement, fragments: &[Fragment], options: &BspOptions) -> LineId {
    if let [only] = fragments {
        return only.line;
    }
    let candidates = spread(fragments, options.candidates.max(1));
    let mut best: Option<(u64, LineId)> = None;
    let mut tried = Vec::with_capacity(options.candidates);
    for candidate in candidates {
        let line = candidate.line;
        if tried.contains(&line) {
            continue;
        }
        tried.push(line);
        let limit = best.map_or(u64::MAX, |b| b.0);
        if let Some(cost) = cost(arrangement, fragments, line, options, limit) {
            best = Some((cost, line));
            // Among few walls, balance is not worth trying more.
            let cuts_none = cost < u64::from(options.split_weight);
            if fragments.len() <= FEW && cuts_none {
                break;
            }
        }
    }
    best.expect("there is a first candidate, and no limit for it")
        .1
}

/// The cost of splitting by `line`, if below `limit`.
fn cost(
    arrangement: &Arrangement,
    fragments: &[Fragment],
    line: LineId,
    options: &BspOptions,
    limit: u64,
) -> Option<u64> {
    let (mut left, mut right, mut cut) = (0u64, 0u64, 0u64);
    for f in spread(fragments, options.sample.max(2)) {
        match arrangement.sides(f, line) {
            (Side::On, Side::On) => {}
            (Side::Left, Side::Right) | (Side::Right, Side::Left) => {
                cut += 1;
                if cut * u64::from(options.split_weight) >= limit {
                    return None;
                }
            }
            (Side::Left, _) | (_, Side::Left) => left += 1,
            _ => right += 1,
        }
    }
    let cost = cut * u64::from(options.split_weight)
        + left.abs_diff(right) * u64::from(options.balance_weight);
    (cost < limit).then_some(cost)
}

/// At most `n` elements, evenly spread.
fn spread<T>(list: &[T], n: usize) -> impl Iterator<Item = &T> {
    let n = n.min(list.len());
    (0..n).map(move |i| &list[i * list.len() / n])
}
