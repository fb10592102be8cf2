//! Sightlines: which lines stab a chain of portals.
//!
//! [`funnel`] keeps the stabbing lines of a chain exactly while it grows and shrinks, for the search.
//! [`stab()`](stab::stab) answers for one chain, by an exact solver or by the lecture's linear
//! programme, with a witness or a contradiction that can be checked exactly.

pub mod exact;
pub mod funnel;
mod hulls;
pub mod lp;
pub mod stab;
mod strip;

pub use exact::Chain;
pub use stab::{Contradiction, Gate, Solver, Stabbing, Witness, stab};
pub use strip::Slack;

#[cfg(test)]
mod tests;
