//! From a level file to a [`Level`]: the model, one file per format, and the findings of `check`.
//!
//! A reader turns a file into a [`draft::Draft`] in the file's own numbers; [`snap::snap`] puts that
//! on the integer grid and makes it a [`Level`]. After that nothing is repaired any more.

pub mod doom;
pub mod draft;
pub mod drawing;
pub mod dress;
pub mod dxf;
pub mod edit;
pub mod finding;
mod model;
pub mod outline;
pub mod read;
pub mod scene;
pub mod snap;
pub mod svg;
pub mod toml;
pub mod uvtt;
pub mod wad;
pub mod wording;

pub use finding::{Finding, Place, Severity};
pub use model::*;
