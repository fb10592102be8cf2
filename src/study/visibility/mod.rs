//! What accuracy costs in time: all methods on one level, against the exact answer.
//!
//! In: a level, a seed, a budget of seconds, and a [`Bench`] to run things on. Out: a [`Study`],
//! whose [`Results`] are the JSON of `enfilade study visibility` and which [`page()`] turns into a
//! page for people. With the same seed everything but times, memory, and what the budget cut short
//! is the same on every run.
//!
//! Truth is the sweep's answer, which is exact, on the same subdivision. With heights there is no
//! exact answer: truth is then the tightest upper one that any of the runs gave.

mod accuracy;
pub mod advice;
mod collect;
mod differ;
mod figures;
mod page;
mod record;
mod sketch;
mod steps;
mod tables;
mod wrong;

pub use accuracy::{Accuracy, Error, accuracy};
pub use collect::study;
pub use page::page;
pub use record::*;

use crate::cells::{CellGraph, Options};
use crate::pvs::{Progress, Pvs};

/// What is studied, and how hard.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyOptions {
    /// The subdivision on which the methods are compared.
    pub cells: Options,
    /// Seed of all that is random.
    pub seed: u64,
    /// Seconds for the whole study.
    pub budget: f64,
}

/// The clock, the threads and the screen: what a study runs on.
pub trait Bench {
    /// Says what comes next.
    fn next(&mut self, what: &str);
    /// Seconds since the study began.
    fn now(&self) -> f64;
    /// Does the work once, and asks it to stop when `limit` seconds are over.
    fn run(&mut self, limit: Option<f64>, work: &mut (dyn FnMut(&Progress) + Send)) -> Cost;
    /// The machine in words, and the number of threads.
    fn machine(&self) -> (String, usize);
}

/// What one run took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Seconds on the clock.
    pub seconds: f64,
    /// The most bytes on the heap beyond those before; `None` where not measured.
    pub bytes: Option<u64>,
    /// Whether it was asked to stop.
    pub stopped: bool,
}

/// A finished study.
#[derive(Clone, Debug)]
pub struct Study {
    /// All figures.
    pub results: Results,
    /// The cells on which the methods are compared.
    pub graph: CellGraph,
    /// Who really sees whom.
    pub truth: Pvs,
}

#[cfg(test)]
mod tests;
