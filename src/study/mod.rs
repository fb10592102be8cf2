//! What accuracy costs in time, and where it is lost: the methods side by side on one level, and on
//! the hard cases; and what a picture's effects, samples and structures cost.
//!
//! In: a level. Out: results as data and as a page for people. A study neither reads the clock nor
//! writes files: whoever starts one gives it a [`Bench`](visibility::Bench) to run things on.

mod chart;
pub mod drawing;
mod page;
pub mod stability;
pub mod visibility;
