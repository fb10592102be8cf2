//! Binary maps, in Doom's layout and in Hexen's (which a `BEHAVIOR` lump announces).
//!
//! In: a map's lumps. Out: a [`RawMap`]. All numbers are little-endian; see "The Unofficial Doom
//! Specs" 1.666, chapter 4, and "The Unofficial Hexen Specs".

use glam::DVec2;

use super::error::Problem;
use super::raw::{RawLine, RawMap, RawSector, RawSide, Specials, Thing};
use super::surfaces::SideSurface;
use crate::level::wad::{Wad, WadMap, name_from};

/// No sidedef here, in binary maps.
const NO_SIDE: u16 = 0xFFFF;

/// Reads a binary map. Numbers that point to nothing are kept as they are; only lumps that are
/// missing or hold a broken record are refused. `THINGS` may be missing.
pub fn read(wad: &Wad, map: &WadMap) -> Result<RawMap, Problem> {
    let behavior = wad.lump_in_map(map, "BEHAVIOR");
    let hexen = behavior.is_some();
    let records = |lump: &'static str, record: usize| -> Result<Vec<Record<'_>>, Problem> {
        let bytes = wad
            .lump_in_map(map, lump)
            .ok_or(Problem::MissingLump { lump })?;
        let size = bytes.len();
        if size % record != 0 {
            return Err(Problem::LumpSize { lump, size, record });
        }
        Ok(bytes.chunks_exact(record).map(Record).collect())
    };
    let vertices = records("VERTEXES", 4)?;
    let lines = records("LINEDEFS", if hexen { 16 } else { 14 })?;
    let sides = records("SIDEDEFS", 30)?;
    let sectors = records("SECTORS", 26)?;
    let things = match wad.find_in_map(map, "THINGS") {
        Some(_) => records("THINGS", if hexen { 20 } else { 10 })?,
        None => Vec::new(),
    };
    Ok(RawMap {
        vertices: vertices.iter().map(|r| r.point(0)).collect(),
        lines: lines
            .iter()
            .map(|r| if hexen { hexen_line(r) } else { doom_line(r) })
            .collect(),
        sides: sides.iter().map(side).collect(),
        sectors: sectors.iter().map(sector).collect(),
        things: things
            .iter()
            .map(|r| if hexen { hexen_thing(r) } else { doom_thing(r) })
            .collect(),
        specials: if hexen {
            Specials::Action
        } else {
            Specials::Doom
        },
        scripts: behavior.is_some_and(has_scripts),
        // Hexen's own maps cannot be told from Doom's in its layout.
        foreign_things: false,
    })
}

/// Whether a compiled `BEHAVIOR` lump holds a script. Its plain form ("ACS" and a NUL) has an offset
/// to a table that begins with the number of scripts. Other forms are taken to hold one.
pub(super) fn has_scripts(behavior: &[u8]) -> bool {
    if !behavior.starts_with(b"ACS\0") {
        return behavior.starts_with(b"ACS");
    }
    let number = |at: usize| {
        let bytes = behavior.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    };
    let count = number(4).and_then(|table| number(table as usize));
    // The extended forms hide behind an empty table: then the marker stands just before it.
    let extended = number(4).is_some_and(|table| {
        let table = table as usize;
        table >= 4
            && behavior
                .get(table - 4..table)
                .is_some_and(|mark| mark.starts_with(b"ACS"))
    });
    extended || count != Some(0)
}

/// One record of a lump; offsets are those of the layout and lie inside it.
struct Record<'a>(&'a [u8]);

impl Record<'_> {
    fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.0[at], self.0[at + 1]])
    }

    fn i16(&self, at: usize) -> i16 {
        i16::from_le_bytes([self.0[at], self.0[at + 1]])
    }

    fn point(&self, at: usize) -> DVec2 {
        DVec2::new(self.i16(at).into(), self.i16(at + 2).into())
    }

    fn args(&self, at: usize) -> [i32; 5] {
        std::array::from_fn(|i| self.0[at + i].into())
    }

    fn side(&self, at: usize) -> Option<u32> {
        let n = self.u16(at);
        (n != NO_SIDE).then_some(n.into())
    }

    fn texture(&self, at: usize) -> Option<String> {
        texture_name(&name_from(&self.0[at..at + 8]))
    }
}

/// A texture's name, or `None` for the two ways of saying that there is none.
pub(super) fn texture_name(name: &str) -> Option<String> {
    (!name.is_empty() && name != "-").then(|| name.to_ascii_uppercase())
}

fn line_ends_and_flags(r: &Record<'_>) -> RawLine {
    let flags = r.u16(4);
    RawLine {
        v1: r.u16(0).into(),
        v2: r.u16(2).into(),
        two_sided: flags & 0x0004 != 0,
        unpegged_top: flags & 0x0008 != 0,
        unpegged_bottom: flags & 0x0010 != 0,
        ..RawLine::default()
    }
}

fn doom_line(r: &Record<'_>) -> RawLine {
    let tag = r.i16(8);
    RawLine {
        special: r.u16(6).into(),
        tags: if tag == 0 { vec![] } else { vec![tag.into()] },
        front: r.side(10),
        back: r.side(12),
        ..line_ends_and_flags(r)
    }
}

fn hexen_line(r: &Record<'_>) -> RawLine {
    RawLine {
        repeats: r.u16(4) & 0x0200 != 0,
        special: r.0[6].into(),
        args: r.args(7),
        front: r.side(12),
        back: r.side(14),
        ..line_ends_and_flags(r)
    }
}

fn side(r: &Record<'_>) -> RawSide {
    RawSide {
        sector: r.u16(28).into(),
        surface: SideSurface {
            upper: r.texture(4),
            lower: r.texture(12),
            middle: r.texture(20),
            offset: r.point(0),
            ..SideSurface::default()
        },
    }
}

fn sector(r: &Record<'_>) -> RawSector {
    let tag = r.i16(24);
    RawSector {
        floor: r.i16(0).into(),
        ceiling: r.i16(2).into(),
        floor_flat: name_from(&r.0[4..12]),
        ceiling_flat: name_from(&r.0[12..20]),
        lies: Default::default(),
        light: r.i16(20).into(),
        special: r.u16(22).into(),
        tags: if tag == 0 { vec![] } else { vec![tag.into()] },
        sloped: false,
    }
}

fn doom_thing(r: &Record<'_>) -> Thing {
    Thing {
        at: r.point(0),
        angle: r.i16(4).into(),
        kind: r.i16(6).into(),
        ..Thing::default()
    }
}

fn hexen_thing(r: &Record<'_>) -> Thing {
    Thing {
        at: r.point(2),
        z: r.i16(6).into(),
        angle: r.i16(8).into(),
        kind: r.i16(10).into(),
        special: r.0[14].into(),
        args: r.args(15),
    }
}
