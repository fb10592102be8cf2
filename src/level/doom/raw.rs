//! A Doom map as its lumps say it, before anything is checked: the common form of the binary
//! layouts and of the text maps.

use glam::DVec2;

use crate::level::dress::Lie;

/// The lists of a map, each in the source's order, so that numbers are those of an editor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMap {
    /// Corner points, x right, y up, in map units.
    pub vertices: Vec<DVec2>,
    /// Linedefs.
    pub lines: Vec<RawLine>,
    /// Sidedefs.
    pub sides: Vec<RawSide>,
    /// Sectors.
    pub sectors: Vec<RawSector>,
    /// Things.
    pub things: Vec<Thing>,
    /// Which numbers the specials are.
    pub specials: Specials,
    /// Whether scripts come with the map, which may move any tagged sector.
    pub scripts: bool,
    /// Whether the numbers of things are another game's than Doom's.
    pub foreign_things: bool,
}

/// Meaning of the numbers of line, sector and thing specials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Specials {
    /// Doom's own, with Boom's extended and generalized ones; one tag, no arguments.
    #[default]
    Doom,
    /// Hexen's action specials and their successors in ZDoom; five arguments.
    Action,
}

/// A linedef. Its front is its right side, walking from `v1` to `v2`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawLine {
    /// Number of the start vertex; may be dangling.
    pub v1: u32,
    /// Number of the end vertex; may be dangling.
    pub v2: u32,
    /// Flag "two-sided" (0x0004): only with it can one see through.
    pub two_sided: bool,
    /// Flag "upper texture unpegged" (0x0008).
    pub unpegged_top: bool,
    /// Flag "lower texture unpegged" (0x0010).
    pub unpegged_bottom: bool,
    /// Whether the special can be set off again and again (for action specials; Doom's numbers say
    /// so themselves).
    pub repeats: bool,
    /// Number of the special, 0 for none.
    pub special: u32,
    /// Arguments of an action special.
    pub args: [i32; 5],
    /// Tags of the sectors that a Doom special moves; 0 is none.
    pub tags: Vec<i32>,
    /// Number of the sidedef on the right; may be dangling.
    pub front: Option<u32>,
    /// Number of the sidedef on the left; may be dangling.
    pub back: Option<u32>,
}

/// A sidedef.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawSide {
    /// Number of the sector on this side; may be dangling.
    pub sector: u32,
    /// What hangs on it.
    pub surface: super::surfaces::SideSurface,
}

/// A sector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawSector {
    /// Floor height at rest, in map units.
    pub floor: f64,
    /// Ceiling height at rest, in map units.
    pub ceiling: f64,
    /// Flat on the floor.
    pub floor_flat: String,
    /// Flat on the ceiling.
    pub ceiling_flat: String,
    /// How the flats lie, on the floor and on the ceiling.
    pub lies: [Lie; 2],
    /// Light level, 0 to 255 (sometimes beyond).
    pub light: i32,
    /// Number of the special, 0 for none.
    pub special: i32,
    /// Tags by which lines find it; never 0.
    pub tags: Vec<i32>,
    /// Whether its floor or ceiling slopes, so that one height does not say where it lies.
    pub sloped: bool,
}

/// A thing: a player's start, a monster, a lamp.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Thing {
    /// Where it stands on the plan, in map units.
    pub at: DVec2,
    /// Height above the sector's floor (where the format has one).
    pub z: f64,
    /// Where it looks, in degrees, counterclockwise from east.
    pub angle: f64,
    /// Number of its type; 1 to 4 are the players' starts.
    pub kind: i32,
    /// Number of its action special, 0 for none.
    pub special: u32,
    /// Arguments of the special.
    pub args: [i32; 5],
}

impl RawMap {
    /// Number of the sector that a linedef's side belongs to; `None` where either does not exist.
    pub fn sector_at(&self, side: Option<u32>) -> Option<usize> {
        let sector = self.sides.get(side? as usize)?.sector as usize;
        (sector < self.sectors.len()).then_some(sector)
    }
}
