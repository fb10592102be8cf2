//! Maps built by hand, and all maps of Freedoom where that is installed.

pub(super) mod build;
mod defects;
mod freedoom;
mod never_panics;
mod ranges;
mod text_maps;
