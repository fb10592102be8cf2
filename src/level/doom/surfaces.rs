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
}
