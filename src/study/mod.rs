//! What accuracy costs in time, and where it is lost.

pub mod stability;
