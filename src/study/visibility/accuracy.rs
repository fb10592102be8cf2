//! How far a visible set is from the exact one.
//!
//! Source: Bittner, "Hierarchical techniques for visibility computations", 2002. With the method's
//! set S and the exact set E of a source cell, the overestimate is |S∖E|/|E| and the underestimate
//! |E∖S|/|E|. E is never empty, for every cell sees itself. Both are averaged over the cells.

use rayon::prelude::*;
use serde::Serialize;

use crate::cells::CellId;
use crate::pvs::{BitMatrix, ones};

/// How far a relation is from the exact one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Accuracy {
    /// Mean over the cells of |S∖E|/|E|.
    pub overestimate: f64,
    /// Mean over the cells of |E∖S|/|E|.
    pub underestimate: f64,
    /// Pairs of cells that only the method takes for visible; (a, b) and (b, a) are one pair.
    pub invented: u64,
    /// Pairs of cells that see each other without the method's knowing; counted likewise.
    pub missed: u64,
}

/// Compares a method's relation with the exact one. Both must be symmetric.
pub fn accuracy(exact: &BitMatrix, method: &BitMatrix) -> Accuracy {
    let rows: Vec<[u64; 3]> = (0..exact.n())
        .into_par_iter()
        .map(|i| {
            let mut counts = [0; 3];
            for (e, s) in exact.row(i).iter().zip(method.row(i)) {
                counts[0] += u64::from(e.count_ones());
                counts[1] += u64::from((s & !e).count_ones());
                counts[2] += u64::from((e & !s).count_ones());
            }
            counts
        })
        .collect();
    let n = rows.len().max(1) as f64;
    // In the order of the cells, so that every number of threads gives the same sum.
    let mean = |k: usize| {
        let shares = rows.iter().map(|r| r[k] as f64 / r[0].max(1) as f64);
        shares.sum::<f64>() / n
    };
    let half = |k: usize| rows.iter().map(|r| r[k]).sum::<u64>() / 2;
    Accuracy {
        overestimate: mean(1),
        underestimate: mean(2),
        invented: half(1),
        missed: half(2),
    }
}

/// Which way a method errs about a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Error {
    /// It takes two cells for visible that are not.
    Invented,
    /// It overlooks that two cells see each other.
    Missed,
}

/// The pairs, ascending and each once, about which the method errs in this way.
pub fn wrong<'a>(
    exact: &'a BitMatrix,
    method: &'a BitMatrix,
    error: Error,
) -> impl Iterator<Item = [CellId; 2]> + 'a {
    (0..exact.n()).flat_map(move |i| {
        let words = exact.row(i).iter().zip(method.row(i));
        let words: Vec<u64> = match error {
            Error::Invented => words.map(|(e, s)| s & !e).collect(),
            Error::Missed => words.map(|(e, s)| e & !s).collect(),
        };
        let above: Vec<usize> = ones(&words).filter(|&j| j > i).collect();
        above
            .into_iter()
            .map(move |j| [CellId(i as u32), CellId(j as u32)])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relation(n: usize, pairs: &[[usize; 2]]) -> BitMatrix {
        let mut bits = BitMatrix::new(n);
        for i in 0..n {
            bits.set(i, i);
        }
        for &[i, j] in pairs {
            bits.set(i, j);
            bits.set(j, i);
        }
        bits
    }

    #[test]
    fn worked_out_by_hand() {
        // Exact sets: {0, 1, 2, 3}, {0, 1}, {0, 2}, {0, 3}. The method misses (0, 1) and invents
        // (2, 3): over 0, 0, 1/2, 1/2; under 1/4, 1/2, 0, 0.
        let exact = relation(4, &[[0, 1], [0, 2], [0, 3]]);
        let method = relation(4, &[[0, 2], [0, 3], [2, 3]]);
        let result = accuracy(&exact, &method);
        assert_eq!(result.overestimate, 0.25);
        assert_eq!(result.underestimate, 0.1875);
        assert_eq!((result.invented, result.missed), (1, 1));
        let list = |error| wrong(&exact, &method, error).collect::<Vec<_>>();
        assert_eq!(list(Error::Invented), [[CellId(2), CellId(3)]]);
        assert_eq!(list(Error::Missed), [[CellId(0), CellId(1)]]);
        assert_eq!(accuracy(&exact, &exact), Accuracy::default());
    }

    #[test]
    fn no_cells() {
        let none = BitMatrix::new(0);
        assert_eq!(accuracy(&none, &none), Accuracy::default());
    }
}
