//! enfilade: exact cells-and-portals visibility and walkthroughs of architectural levels.

pub mod geom;
pub mod level;
pub mod cells;
pub mod sight;
pub mod pvs;
pub mod report;
pub mod cli;
