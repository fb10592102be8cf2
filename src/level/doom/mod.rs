//! Doom maps, binary and text, as a [`Draft`].
//!
//! In: a [`Wad`] and the name of a map in it. Out: [`DoomMap`], that is, a draft and what else a
//! later stage wants to know (textures, things). One file a step:
//!
//! - `raw` is the map as its lumps say it; `binary` and `udmf` (with `text`, its grammar) read it.
//! - `specials` knows what the numbers of line specials move, `movers` finds the sectors they
//!   move (`stairs` those of stairs), `reach` how far these go.
//! - [`graphics`] puts textures together; [`gl`] reads the nodes that other programs made.
//! - `dressing` tells what hangs on the walls and lies on floors and ceilings; `things` makes lights
//!   of lamps and cameras of starts.
//! - `assemble` checks the lists against each other and makes walls of the linedefs.
//!
//! # What blocks sight
//! In the game's own test a line lets sight pass when it is flagged two-sided, and so it is here:
//! a linedef with two sidedefs but without the flag is a wall. Floors and ceilings are left to the
//! stages that know heights; but a line at a sector that is closed at rest and can open is marked
//! as shut.
//!
//! # What is not read
//! Compiled scripts (any tagged sector may move, then), slopes made by things, floors inside
//! sectors ("3D floors"), portals between lines, and the few specials in which Heretic and Strife
//! differ from Doom.

mod assemble;
mod binary;
mod defect;
mod dressing;
mod error;
pub mod gl;
pub mod graphics;
mod movers;
mod raw;
mod reach;
mod specials;
mod stairs;
mod surfaces;
mod text;
mod things;
mod udmf;

#[cfg(test)]
mod tests;

use glam::DVec2;

use super::draft::Draft;
use super::wad::Wad;

pub use error::{DoomError, Problem};
pub use raw::Thing;
pub use surfaces::{LineSurfaces, Shift, SideSurface};
pub use text::{Spot, TextError, TextProblem};

/// A map, with what a draft has no place for.
#[derive(Clone, Debug)]
pub struct DoomMap {
    /// Walls, sectors, findings.
    pub draft: Draft,
    /// Textures of each linedef, by linedef number (which walls carry as their place).
    pub surfaces: Vec<LineSurfaces>,
    /// Things, in the source's order.
    pub things: Vec<Thing>,
}

impl DoomMap {
    /// Where the first player starts, and where they look (degrees, counterclockwise from east).
    /// Of several starts the last counts, as in the game.
    pub fn player_start(&self) -> Option<(DVec2, f64)> {
        let start = self.things.iter().rev().find(|t| t.kind == 1)?;
        Some((start.at, start.angle))
    }
}

/// Reads a map of a WAD as a draft. `map` is the map's name in any case; `source` is the file's name,
/// used in messages and kept as the draft's source.
///
/// A sector's number is its [`SectorId`](super::SectorId), used or not. Coordinates and heights
/// are in map units. Defects with one possible meaning are repaired and listed in the draft's
/// findings; the rest is refused.
pub fn read_map(wad: &Wad, map: &str, source: &str) -> Result<Draft, DoomError> {
    Ok(read_doom_map(wad, map, source)?.draft)
}

/// As [`read_map`], with textures and things.
pub fn read_doom_map(wad: &Wad, map: &str, source: &str) -> Result<DoomMap, DoomError> {
    let read = || {
        let lumps = wad.map(map)?;
        let mut tally = defect::Tally::default();
        let raw = if lumps.text {
            udmf::read(wad, &lumps, &mut tally)?
        } else {
            binary::read(wad, &lumps)?
        };
        assemble::assemble(raw, lumps.name, source, tally)
    };
    read().map_err(|problem| DoomError {
        file: source.to_string(),
        map: map.to_string(),
        problem,
    })
}
