//! The `.pvs` file: cells, portals and visible sets of a level, for readers in any language.
//!
//! # Layout
//! Everything is little-endian. Whole numbers are unsigned unless said otherwise, `f64` is IEEE 754
//! binary64. A file is a header, sections, and a checksum:
//!
//! | offset | type | what |
//! |---|---|---|
//! | 0 | 8 bytes | `89 50 56 53 0D 0A 1A 0A`: `\x89PVS\r\n\x1a\n` (a transfer as text breaks it) |
//! | 8 | u32 | version of the layout: 1 |
//! | 12 | u32 | number of sections |
//! | 16 | u64 | length of the whole file in bytes |
//! | 24 | … | the sections, one after the other |
//! | length − 4 | u32 | CRC-32 (as in zip and PNG) of all bytes before it |
//!
//! A section:
//!
//! | offset | type | what |
//! |---|---|---|
//! | 0 | 4 bytes | tag, ASCII |
//! | 4 | u64 | length of its content in bytes |
//! | 12 | u64 | length as stored here, in bytes |
//! | 20 | … | the content as a zlib stream (RFC 1950) of the stored length |
//!
//! The sections below are all there, each once, `INFO` first; a reader skips sections of other tags.
//! Elements are numbered from 0, in the order in which they are stored.
//!
//! **`INFO`**, what the file is about:
//!
//! | offset | type | what |
//! |---|---|---|
//! | 0 | 5 × u32 | how many vertices, cells, edges, portals, and entries of `ALSO` follow |
//! | 20 | 3 × u32 | of the level: distinct wall ends, walls, sectors |
//! | 32 | u32 | fingerprint of the level's walls, see [`LevelInfo::fingerprint`] |
//! | 36 | u32 | kind of the grid's step: 0 for 10^−k units, 1 for 2^−k units |
//! | 40 | i32 | that k |
//! | 44 | u32 | flags: bit 0, triangulation fell back on BSP leaves; bit 1, floors and ceilings count for visibility; the others are 0 |
//! | 48 | 2 × i64 | the grid's origin x, y, in steps |
//! | 64 | f64 | largest distance by which a point was moved onto the grid, in units |
//! | 72 | u64 | ordered pairs counted as visible without proof |
//! | 80 | u64 | elementary steps that the method took |
//! | 88 | 3 × u32 | of the subdivision: pieces of wall, cuts through pieces, depth of the tree |
//! | 100 | 7 strings | name, source, unit of length, subdivision (`bsp`, `kd`, `cdt`), method (`sweep`, `search`, `lp`, `flow`, `flood`, `sample`), class (`exact`, `conservative`: misses nothing, `aggressive`: nothing too much, `approximate`), doors (`open`, `closed`), each as u32 number of bytes, then UTF-8 |
//!
//! **`VERT`**, the vertices in the level's own coordinates, as near as f64 gets to them: per vertex
//! f64 x (right), f64 y (up).
//!
//! **`EXAC`**, the same vertices exactly: per vertex i128 x, i128 y, i64 w (two's complement). The
//! vertex lies x/w steps right of the grid's origin and y/w above it; w > 0, no common factor;
//! w = 1 on the grid. Level coordinates are (origin + vertex) · step. Where rounding matters these
//! count, not `VERT`.
//!
//! **`CELL`**, per cell u32 ×4: first edge, number of edges (3 or more), sector (`FFFFFFFF`: none),
//! number of entries in `ALSO`. The edges of one cell follow those of the cell before.
//!
//! **`ALSO`**, cell after cell: u32 further sectors that the level's walls name for the cell's
//! ground (a defect of the level).
//!
//! **`EDGE`**, cell after cell, counterclockwise around it: u32 ×3: vertex in which the edge starts
//! (it ends where the cell's next one starts), twin edge of the neighbouring cell (`FFFFFFFF`: sight
//! ends here), wall of the level that lies here (`FFFFFFFF`: none).
//!
//! **`PORT`**, the portals, ordered by their first edge: u32 ×2 its two edges (twins, the smaller
//! number first), then f64 ×4: bottom and top of the opening as the level starts, bottom and top at
//! its widest, with everything that moves out of the way (NaN: none).
//!
//! **`VISI`**, which cells see each other: the lower triangle of a symmetric bit matrix. Row i has
//! ⌈(i+1)/8⌉ bytes; bit j % 8 of byte j / 8 (least significant first), for j ≤ i, says whether cells
//! i and j see each other. Bit i is 1, bits after it are 0. Rows follow each other without padding.
//!
//! # What a reader checks
//! [`decode`] refuses a file with another beginning, of a newer version, cut off or with something
//! appended, whose checksum does not fit, or whose parts contradict each other, and never takes more
//! memory than the file's size justifies: zlib cannot shrink by more than 1,032 to 1, so a content
//! length beyond that is refused unread.

mod content;
mod error;
mod sections;

#[cfg(test)]
mod tests;

use std::io::Write;

pub use error::FileError;

use super::Pvs;
use crate::cells::CellGraph;
use crate::level::{Level, WallKind};
use sections::{Section, Sections};

const MAGIC: [u8; 8] = *b"\x89PVS\r\n\x1a\n";
const VERSION: u32 = 1;
/// Bytes before the first section.
const HEADER: usize = 24;
/// Bytes of the checksum.
const TRAILER: usize = 4;

/// What a `.pvs` file says about its level.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelInfo {
    /// Name for people, see [`Level::name`].
    pub name: String,
    /// File that the level came from, without its folder.
    pub source: String,
    /// Unit of length.
    pub unit: String,
    /// Largest distance by which a point was moved onto the grid, in units.
    pub snap: f64,
    /// Number of distinct points that walls start or end in.
    pub vertices: u32,
    /// Number of walls.
    pub walls: u32,
    /// Number of sectors.
    pub sectors: u32,
    /// A number that tells levels apart: CRC-32 over the walls in their order, each as its four
    /// coordinates in grid steps (from x, from y, to x, to y: i64), what it does to sight (u8: 0
    /// solid, 1 outline, 2 edge, 3 shut edge, 4 opening, 5 shut opening), and its left sector, right
    /// sector and outline (u32 each, `FFFFFFFF` for none), all little-endian.
    pub fingerprint: u32,
}

impl LevelInfo {
    /// What a file says about this level.
    pub fn of(level: &Level) -> Self {
        Self {
            name: level.name.clone(),
            source: level.source.clone(),
            unit: level.unit.clone(),
            snap: level.snap,
            vertices: level.n_vertices as u32,
            walls: level.walls.len() as u32,
            sectors: level.sectors.len() as u32,
            fingerprint: fingerprint(level),
        }
    }
}

fn fingerprint(level: &Level) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    for wall in &level.walls {
        for n in [wall.from.x, wall.from.y, wall.to.x, wall.to.y] {
            hasher.update(&n.to_le_bytes());
        }
        hasher.update(&[match &wall.kind {
            WallKind::Solid => 0,
            WallKind::Outline => 1,
            WallKind::Edge { shut } => 2 + u8::from(*shut),
            WallKind::Opening(opening) => 4 + u8::from(opening.shut),
        }]);
        let ids = [
            wall.left.map(|s| s.0),
            wall.right.map(|s| s.0),
            wall.outline.map(|o| o.0),
        ];
        for id in ids {
            hasher.update(&id.unwrap_or(u32::MAX).to_le_bytes());
        }
    }
    hasher.finalize()
}

/// What a `.pvs` file holds.
#[derive(Clone, Debug)]
pub struct PvsFile {
    /// The level that it is of.
    pub info: LevelInfo,
    /// The cells. Their findings are not in the file, nor are the options of the splitting rules
    /// (which are the defaults here); all else is as it was encoded.
    pub graph: CellGraph,
    /// Which cells see which.
    pub pvs: Pvs,
}

/// The bytes of a `.pvs` file. The same input always gives the same bytes.
pub fn encode(info: &LevelInfo, graph: &CellGraph, pvs: &Pvs) -> Vec<u8> {
    let sections = content::sections(info, graph, pvs);
    let mut out = Vec::new();
    out.extend(MAGIC);
    out.extend(VERSION.to_le_bytes());
    out.extend((sections.len() as u32).to_le_bytes());
    out.extend(0u64.to_le_bytes());
    for (tag, content) in sections {
        out.extend(tag);
        out.extend((content.len() as u64).to_le_bytes());
        let stored = compress(&content);
        out.extend((stored.len() as u64).to_le_bytes());
        out.extend(stored);
    }
    let length = (out.len() + TRAILER) as u64;
    out[16..HEADER].copy_from_slice(&length.to_le_bytes());
    let crc = crc32fast::hash(&out);
    out.extend(crc.to_le_bytes());
    out
}

fn compress(content: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder
        .write_all(content)
        .expect("writing to memory does not fail");
    encoder.finish().expect("writing to memory does not fail")
}

/// Reads the bytes of a `.pvs` file. What comes back is what was encoded, and holds together:
/// [`CellGraph::validate`] and [`Pvs::validate`] have been asked.
///
/// # Errors
/// [`FileError`] says why the bytes are not accepted. No bytes make this panic.
pub fn decode(bytes: &[u8]) -> Result<PvsFile, FileError> {
    let sections = Sections::split(bytes)?;
    content::read(&sections)
}
