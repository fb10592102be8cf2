//! From a level, its cells and its visible sets to pictures, by tracing rays.
//!
//! Floating point starts here. Coordinates are f64 in the level's own unit: x right, y up on the
//! plan, z up; right-handed. Rays need not have unit direction: `t` counts in multiples of it.

pub mod accel;
pub mod beam;
mod brute;
pub mod camera;
pub mod cast;
pub mod dress;
pub mod effects;
pub mod image;
pub mod light;
pub mod picture;
pub mod ray;
pub mod render;
pub mod sampling;
pub mod shade;
pub mod shapes;
pub mod space;
pub mod world;

pub use cast::{Met, Place, walk};
pub use ray::Ray;
pub use space::{Space, Surface};
pub use world::{Tracer, World};
