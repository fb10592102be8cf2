//! Maps built by hand, and all maps of Freedoom where that is installed.

mod freedoom;
