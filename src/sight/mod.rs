//! Sightlines: which lines stab a chain of portals.

pub mod funnel;
