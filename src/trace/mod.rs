//! From a level, its cells and its visible sets to pictures, by tracing rays.
//!
//! | file | what |
//! |---|---|
//! | [`space`], [`cast`], [`beam`], [`stream`] | the level's cells in floating point; rays that walk through them: singly, many from one eye, many without order |
//! | [`shapes`], [`accel`] | objects, and structures over many of them |
//! | [`world`] | the space with materials, objects and lights; the nearest thing on a ray's way, by walking, brute force or structures |
//! | [`light`], [`shade`] | light sources; the tree of rays |
//! | [`effects`] | what a picture calls for, and why |
//! | [`camera`], [`sampling`], [`render`], [`picture`] | pixels to rays, chance, tiles, and bytes for a screen |
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
pub mod layout;
pub mod light;
pub mod picture;
pub mod ray;
pub mod render;
pub mod sampling;
pub mod shade;
pub mod shadow;
pub mod shapes;
pub mod space;
pub mod stream;
pub mod world;

pub use cast::{Met, Place, walk};
pub use ray::Ray;
pub use space::{Space, Surface};
pub use world::{Tracer, World};
