//! What hangs on the sides of a Doom map's lines: texture names, offsets, pegging. No later stage
//! of visibility needs it; pictures do.

use glam::DVec2;

/// Textures of one linedef. In [`super::DoomMap::surfaces`], indexed by linedef number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineSurfaces {
    /// Right side.
    pub front: Option<SideSurface>,
    /// Left side.
    pub back: Option<SideSurface>,
    /// The upper texture hangs from the higher ceiling instead of from the lower one.
    pub unpegged_top: bool,
    /// The lower texture starts at the higher ceiling; the middle one stands on the floor.
    pub unpegged_bottom: bool,
}

/// Textures of one sidedef, names in capitals as in the file; `None` where it says "-" or nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SideSurface {
    /// Above the neighbour's ceiling.
    pub upper: Option<String>,
    /// Below the neighbour's floor.
    pub lower: Option<String>,
    /// The wall itself, or a grating in an opening.
    pub middle: Option<String>,
    /// Offset of the textures in texels: to the left, up.
    pub offset: DVec2,
    /// What text maps may say of the upper texture alone.
    pub upper_shift: Shift,
    /// Of the middle one.
    pub middle_shift: Shift,
    /// Of the lower one.
    pub lower_shift: Shift,
}

/// How one texture hangs, beyond what is said for its whole side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Added to the side's offset.
    pub offset: DVec2,
    /// Texels to a unit: at 2 the texture is half as large. Positive.
    pub scale: DVec2,
}

impl Default for Shift {
    fn default() -> Self {
        Self {
            offset: DVec2::ZERO,
            scale: DVec2::ONE,
        }
    }
}
