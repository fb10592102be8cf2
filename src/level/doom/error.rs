//! Why a map is refused.

use thiserror::Error;

use super::text::TextError;
use crate::level::wad::WadError;

/// A map that cannot be read, with its file and name.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{file}, map {map}: {problem}")]
pub struct DoomError {
    /// File name, as the caller gave it.
    pub file: String,
    /// Name of the map.
    pub map: String,
    /// What is wrong.
    pub problem: Problem,
}

/// What is wrong with a map.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Problem {
    /// The WAD has no such map.
    #[error(transparent)]
    Wad(#[from] WadError),
    /// A lump is missing.
    #[error("lump {lump} is missing; the map is incomplete, save it again in a map editor")]
    MissingLump {
        /// Its name.
        lump: &'static str,
    },
    /// A lump does not hold a whole number of records.
    #[error(
        "lump {lump} has {size} bytes, which is no multiple of the {record} of a record; it is cut \
         off or of another layout, save the map again in a map editor"
    )]
    LumpSize {
        /// Its name.
        lump: &'static str,
        /// Its bytes.
        size: usize,
        /// Bytes of one record.
        record: usize,
    },
    /// The text of a UDMF map is wrong.
    #[error("TEXTMAP, {0}")]
    Text(#[from] TextError),
    /// Nothing to see.
    #[error("there are no {what}; draw some in a map editor")]
    Empty {
        /// Which list is empty.
        what: &'static str,
    },
    /// A wall borders a sector that does not exist.
    #[error(
        "linedef {line}, sidedef {side} names sector {sector}, but there are only {n_sectors}; \
         give it a sector in a map editor"
    )]
    NoSector {
        /// Number of the linedef.
        line: u32,
        /// Number of its sidedef.
        side: u32,
        /// The sector that it names.
        sector: u32,
        /// How many sectors there are.
        n_sectors: usize,
    },
}
