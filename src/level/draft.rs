//! A draft: what a reader understood, still in the file's own numbers.
//!
//! In: what a format's reader has parsed and checked for sense. Out, through [`super::snap`]: a
//! [`super::Level`] on the integer grid. Every format's reader ends in a draft, so that there is one
//! door through which coordinates become exact.

use std::path::Path;

use glam::DVec2;

use super::finding::{Finding, Place};
use super::model::{Outline, OutlineId, Sector, SectorId, WallKind};
use super::scene::{MaterialId, Scene};

/// A level whose plan coordinates are the numbers of the file.
#[derive(Clone, Debug)]
pub struct Draft {
    /// See [`super::Level::name`].
    pub name: String,
    /// See [`super::Level::source`].
    pub source: String,
    /// See [`super::Level::unit`].
    pub unit: String,
    /// Kind of numbers that the format's coordinates are.
    pub numbers: Numbers,
    /// Walls in file order; zero-length ones are dropped (and reported) at the door.
    pub walls: Vec<DraftWall>,
    /// Sectors.
    pub sectors: Vec<Sector>,
    /// Outlines.
    pub outlines: Vec<Outline>,
    /// How the inside is told from the outside.
    pub interior: DraftInterior,
    /// Materials, lights, objects, cameras, paths.
    pub scene: Scene,
    /// What the reader repaired or wondered about.
    pub findings: Vec<Finding>,
}

/// What kind of numbers a format writes; decides the grid's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// Decimals (TOML, DXF, …): the step is a power of ten, 10^-4 or finer where the extent allows.
    Decimal,
    /// Whole numbers or binary fractions (Doom): the step is a power of two, 1 where that is exact.
    /// Falls back to a power of ten where that holds every coordinate and no power of two does
    /// (UDMF maps with decimals).
    Binary,
}

/// A wall whose ends are not on the grid yet. Fields as in [`super::Wall`].
#[derive(Clone, Debug, PartialEq)]
pub struct DraftWall {
    /// Start point, in the level's own coordinates.
    pub from: DVec2,
    /// End point.
    pub to: DVec2,
    /// Whether each end was written in the file, digit by digit (`true`), or computed from other
    /// numbers (an opening so many metres along a slanted wall, a corner of a round pillar). Only
    /// written ends take part in the choice of the step.
    pub written: [bool; 2],
    /// What it does to sight.
    pub kind: WallKind,
    /// Sector on the left side.
    pub left: Option<SectorId>,
    /// Sector on the right side.
    pub right: Option<SectorId>,
    /// Outline that this is an edge of.
    pub outline: Option<OutlineId>,
    /// Its surface.
    pub material: Option<MaterialId>,
    /// Where it stands in the source.
    pub place: Place,
}

/// As [`super::Interior`], before the grid.
#[derive(Clone, Debug, PartialEq)]
pub enum DraftInterior {
    /// Walls name the sector on each side.
    Sides,
    /// Outlines enclose the rooms.
    Outlines,
    /// What walls enclose; with start points, what can be reached from one.
    Enclosed {
        /// Points in the inside.
        starts: Vec<DVec2>,
    },
}

/// A file's name without its ending: the name of a level that has none.
pub fn stem(source: &str) -> String {
    let stem = Path::new(source).file_stem();
    stem.map_or_else(|| source.to_string(), |s| s.to_string_lossy().into_owned())
}
