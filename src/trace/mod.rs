//! From a level, its cells and its visible sets to pictures, by tracing rays.
//!
//! Floating point starts here. Coordinates are f64 in the level's own unit: x right, y up on the
//! plan, z up; right-handed. Rays need not have unit direction: `t` counts in multiples of it.

pub mod accel;
pub mod ray;
pub mod shapes;
