//! What the surfaces of a level wear, where its source says so surface by surface: a Doom map.
//!
//! Made with the level and used by `trace::dress`. Empty for levels that name materials instead.
//! Pictures are known by name only; whoever has the WAD puts them together
//! ([`super::doom::graphics`]). A sector's light is with the sector ([`super::Sector::light`]).
//!
//! Walls are split and merged on their way to the grid, but textures run along whole linedefs. So
//! they are kept by linedef, with its ends as the file gives them, and a wall finds its line by its
//! [`Place`].

use glam::DVec2;

use super::finding::Place;
use super::model::{SectorId, Wall};

/// Everything that hangs on walls and lies on floors and ceilings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dress {
    /// The pictures used, each once, in the order in which they are first named.
    pub pictures: Vec<PictureName>,
    /// By linedef number.
    pub lines: Vec<LineDress>,
    /// By [`SectorId`]: on the floor, and on the ceiling.
    pub flats: Vec<[Cover; 2]>,
    /// What is behind surfaces that are [`Cover::Sky`].
    pub sky: Option<PictureId>,
}

/// Index into [`Dress::pictures`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PictureId(pub u32);

/// A picture by its name, in capitals.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum PictureName {
    /// Put together from patches.
    Texture(String),
    /// 64 by 64, from between the markers of flats.
    Flat(String),
}

impl PictureName {
    /// The name alone.
    pub fn as_str(&self) -> &str {
        match self {
            Self::Texture(name) | Self::Flat(name) => name,
        }
    }
}

/// What lies on a floor or ceiling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Cover {
    /// A picture, and how it lies.
    Picture(PictureId, Lie),
    /// The sky is seen instead.
    Sky,
    /// Nothing is named.
    #[default]
    Bare,
}

/// How a picture lies on a floor or ceiling. As it is, its texels are those of the map's grid, north
/// up: the point (x, y) is in column x, row -y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lie {
    /// Added to column and row, before they are scaled.
    pub offset: DVec2,
    /// Texels to a unit: at 2 the picture is half as large; a negative one mirrors it. Not 0.
    pub scale: DVec2,
    /// Degrees by which the picture is turned, clockwise as seen from above.
    pub turn: f64,
}

impl Default for Lie {
    fn default() -> Self {
        Self {
            offset: DVec2::ZERO,
            scale: DVec2::ONE,
            turn: 0.0,
        }
    }
}

/// What hangs on a linedef.
#[derive(Clone, Debug, PartialEq)]
pub struct LineDress {
    /// Where the linedef starts, in the level's own coordinates.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
    /// On its left (the back in Doom) and on its right (the front).
    pub sides: [Option<SideDress>; 2],
    /// The upper texture hangs from the higher ceiling instead of standing on the lower one.
    pub upper_unpegged: bool,
    /// The lower texture counts from the ceiling instead of from the step's edge, and the middle one
    /// stands on the floor instead of hanging from the ceiling.
    pub lower_unpegged: bool,
}

/// What hangs on one side of a linedef.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideDress {
    /// Above the ceiling beyond.
    pub upper: Option<Hanging>,
    /// On the wall, or a grating in the opening.
    pub middle: Option<Hanging>,
    /// Below the floor beyond.
    pub lower: Option<Hanging>,
}

/// A picture on a part of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hanging {
    /// Which.
    pub picture: PictureId,
    /// By how many texels it is moved: left, up.
    pub offset: DVec2,
    /// Texels to a unit, positive.
    pub scale: DVec2,
}

impl Dress {
    /// Whether nothing is known: the level names materials, or nothing at all.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.flats.is_empty()
    }

    /// What hangs on the linedef that a wall is a part of.
    pub fn line_of(&self, wall: &Wall) -> Option<&LineDress> {
        match wall.place {
            Place::Linedef(n) => self.lines.get(n as usize),
            _ => None,
        }
    }

    /// What lies on a sector's floor.
    pub fn floor(&self, sector: SectorId) -> Cover {
        self.flats
            .get(sector.0 as usize)
            .map_or(Cover::Bare, |f| f[0])
    }

    /// What is on a sector's ceiling.
    pub fn ceiling(&self, sector: SectorId) -> Cover {
        self.flats
            .get(sector.0 as usize)
            .map_or(Cover::Bare, |f| f[1])
    }
}
