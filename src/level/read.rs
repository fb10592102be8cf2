//! From a file's bytes to a [`Level`], whatever its format.
//!
//! In: the bytes and the file's name, which the caller has read (nothing in `level` touches files).
//! Out: a [`Source`], from which its level, or each of its maps, is read. A WAD is known by its first
//! four bytes, every other format by the name's ending, or, where that says nothing, by how it begins.

use std::path::Path;

use thiserror::Error;

use super::Level;
use super::doom::{self, DoomError};
use super::draft::Draft;
use super::drawing::DrawingOptions;
use super::dxf::{self, DxfError};
use super::snap::{SnapError, snap};
use super::svg::{self, SvgError};
use super::toml::{self, TomlError};
use super::uvtt::{self, UvttError};
use super::wad::{Wad, WadError};

/// Why a file gives no level. Every message names the file, the place in it where there is one, and
/// what to do.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReadError {
    /// The ending is none that is known, and the bytes are no WAD's.
    #[error(
        "{file}: unknown kind of file; a level is a .toml file, a Doom .wad, a .dxf or .svg drawing, or \
         a .uvtt (.dd2vtt) map"
    )]
    UnknownFormat {
        /// File name.
        file: String,
    },
    /// A text file that is not UTF-8.
    #[error("{file}, line {line}: the text is not UTF-8 here; save the file as UTF-8")]
    NotUtf8 {
        /// File name.
        file: String,
        /// Line of the first wrong byte, from 1.
        line: usize,
    },
    /// A map was named, but the file is a single level.
    #[error("{file}: there is no map '{map}', the file is one level; leave --map out")]
    OneLevel {
        /// File name.
        file: String,
        /// What was asked for.
        map: String,
    },
    /// A WAD with several maps, and none was named.
    #[error("{file}: there are {} maps, name one with --map: {}", .maps.len(), .maps.join(", "))]
    SeveralMaps {
        /// File name.
        file: String,
        /// Names of the maps, in the file's order.
        maps: Vec<String>,
    },
    /// A WAD without maps.
    #[error("{file}: the WAD has no maps; take one that has, such as a game's IWAD")]
    NoMaps {
        /// File name.
        file: String,
    },
    /// A mistake in a TOML level.
    #[error("{file}, {error}")]
    Toml {
        /// File name.
        file: String,
        /// The mistake, with line and column.
        error: Box<TomlError>,
    },
    /// A mistake in a DXF drawing.
    #[error("{file}, {error}")]
    Dxf {
        /// File name.
        file: String,
        /// The mistake.
        error: DxfError,
    },
    /// A mistake in an SVG drawing.
    #[error("{file}, {error}")]
    Svg {
        /// File name.
        file: String,
        /// The mistake.
        error: SvgError,
    },
    /// A mistake in a Universal VTT map.
    #[error("{file}, {error}")]
    Uvtt {
        /// File name.
        file: String,
        /// The mistake.
        error: UvttError,
    },
    /// Options for drawings, but the file is none.
    #[error(
        "{file}: {option} is for drawings (.dxf, .svg, .uvtt); this file says itself what its lines are, \
         leave it out"
    )]
    NoDrawing {
        /// File name.
        file: String,
        /// The option.
        option: &'static str,
    },
    /// A damaged WAD.
    #[error("{file}: {error}")]
    Wad {
        /// File name.
        file: String,
        /// The damage.
        error: WadError,
    },
    /// A map that is missing or cannot be read.
    #[error(transparent)]
    Doom(#[from] DoomError),
    /// A map that does not fit the grid.
    #[error("{file}, map {map}: {error}")]
    Grid {
        /// File name.
        file: String,
        /// Name of the map.
        map: String,
        /// What does not fit.
        error: SnapError,
    },
    /// A drawing that does not fit the grid.
    #[error("{file}: {error}")]
    Snap {
        /// File name.
        file: String,
        /// What does not fit.
        error: SnapError,
    },
}

/// A file that holds one level or several maps.
#[derive(Clone, Debug)]
pub struct Source {
    file: String,
    contents: Contents,
    options: DrawingOptions,
}

#[derive(Clone, Debug)]
enum Contents {
    Toml(String),
    Wad(Wad),
    Dxf(Vec<u8>),
    Svg(String),
    Uvtt(String),
}

impl Source {
    /// Tells the format and reads what comes before any level: a WAD's directory, a text's encoding.
    /// `file_name` is the file's name without its folder. Drawings are understood in the usual way.
    pub fn parse(bytes: Vec<u8>, file_name: &str) -> Result<Source, ReadError> {
        Source::parse_with(bytes, file_name, DrawingOptions::default())
    }

    /// As [`Source::parse`], and says how a drawing is to be understood.
    pub fn parse_with(
        bytes: Vec<u8>,
        file_name: &str,
        options: DrawingOptions,
    ) -> Result<Source, ReadError> {
        let file = file_name.to_string();
        let contents = match format_of(&bytes, file_name) {
            Some(Format::Wad) => wad(bytes, &file)?,
            Some(Format::Toml) => Contents::Toml(text(bytes, &file)?),
            Some(Format::Dxf) => Contents::Dxf(bytes),
            Some(Format::Svg) => Contents::Svg(text(bytes, &file)?),
            Some(Format::Uvtt) => Contents::Uvtt(text(bytes, &file)?),
            None => return Err(ReadError::UnknownFormat { file }),
        };
        if let (Contents::Toml(_) | Contents::Wad(_), Some(option)) = (&contents, options.first()) {
            return Err(ReadError::NoDrawing { file, option });
        }
        Ok(Source {
            file,
            contents,
            options,
        })
    }

    /// Names of the maps, in the file's order; empty for a file that is a single level.
    pub fn maps(&self) -> Vec<String> {
        match &self.contents {
            Contents::Wad(wad) => wad.maps().into_iter().map(|m| m.name).collect(),
            _ => Vec::new(),
        }
    }

    /// The WAD, if the file is one.
    pub fn wad(&self) -> Option<&Wad> {
        match &self.contents {
            Contents::Wad(wad) => Some(wad),
            _ => None,
        }
    }

    /// Reads the level, or the map of that name (in any case). Without a name, a WAD has to have
    /// just one map.
    pub fn level(&self, map: Option<&str>) -> Result<Level, ReadError> {
        let file = || self.file.clone();
        match (&self.contents, map) {
            (Contents::Toml(text), None) => {
                toml::read(text, &self.file).map_err(|error| ReadError::Toml {
                    file: file(),
                    error: error.into(),
                })
            }
            (Contents::Dxf(bytes), None) => {
                let draft = dxf::read(bytes, &self.file, &self.options);
                self.drawing(draft.map_err(|error| ReadError::Dxf {
                    file: file(),
                    error,
                })?)
            }
            (Contents::Svg(text), None) => {
                let draft = svg::read(text, &self.file, &self.options);
                self.drawing(draft.map_err(|error| ReadError::Svg {
                    file: file(),
                    error,
                })?)
            }
            (Contents::Uvtt(text), None) => {
                let draft = uvtt::read(text, &self.file, &self.options);
                self.drawing(draft.map_err(|error| ReadError::Uvtt {
                    file: file(),
                    error,
                })?)
            }
            (Contents::Wad(wad), Some(map)) => self.doom_level(wad, map),
            (Contents::Wad(wad), None) => match self.maps().as_slice() {
                [] => Err(ReadError::NoMaps { file: file() }),
                [map] => self.doom_level(wad, map),
                maps => Err(ReadError::SeveralMaps {
                    file: file(),
                    maps: maps.to_vec(),
                }),
            },
            (_, Some(map)) => Err(ReadError::OneLevel {
                file: file(),
                map: map.to_string(),
            }),
        }
    }

    fn drawing(&self, draft: Draft) -> Result<Level, ReadError> {
        snap(draft).map_err(|error| ReadError::Snap {
            file: self.file.clone(),
            error,
        })
    }

    fn doom_level(&self, wad: &Wad, map: &str) -> Result<Level, ReadError> {
        let draft = doom::read_map(wad, map, &self.file)?;
        let name = draft.name.clone();
        snap(draft).map_err(|error| ReadError::Grid {
            file: self.file.clone(),
            map: name,
            error,
        })
    }
}

/// Reads a level, see [`Source`]. `file_name` is the file's name without its folder; it is kept as
/// [`Level::source`].
pub fn read(bytes: Vec<u8>, file_name: &str, map: Option<&str>) -> Result<Level, ReadError> {
    Source::parse(bytes, file_name)?.level(map)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Format {
    Wad,
    Toml,
    Dxf,
    Svg,
    Uvtt,
}

fn format_of(bytes: &[u8], file_name: &str) -> Option<Format> {
    if matches!(bytes.get(..4), Some(b"IWAD" | b"PWAD")) {
        return Some(Format::Wad);
    }
    let ending = Path::new(file_name)
        .extension()
        .unwrap_or_default()
        .to_string_lossy();
    match ending.to_lowercase().as_str() {
        "wad" => Some(Format::Wad),
        "toml" => Some(Format::Toml),
        "dxf" => Some(Format::Dxf),
        "svg" => Some(Format::Svg),
        "uvtt" | "dd2vtt" | "df2vtt" => Some(Format::Uvtt),
        _ => {
            let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
            let start = start.trim_start_matches('\u{feff}').trim_start();
            if start.starts_with('{') && start.contains("\"resolution\"") {
                Some(Format::Uvtt)
            } else if start.starts_with('<') && start.contains("<svg") {
                Some(Format::Svg)
            } else if start.starts_with("AutoCAD Binary DXF") || start.contains("SECTION") {
                Some(Format::Dxf)
            } else {
                None
            }
        }
    }
}

fn wad(bytes: Vec<u8>, file: &str) -> Result<Contents, ReadError> {
    let wad = Wad::parse(bytes).map_err(|error| ReadError::Wad {
        file: file.to_string(),
        error,
    })?;
    Ok(Contents::Wad(wad))
}

fn text(bytes: Vec<u8>, file: &str) -> Result<String, ReadError> {
    String::from_utf8(bytes).map_err(|error| {
        let read = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + read.iter().filter(|&&b| b == b'\n').count();
        ReadError::NotUtf8 {
            file: file.to_string(),
            line,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: &[u8] = b"[[room]]\nname = \"Hall\"\nrect = [0, 0, 4, 4]\n";

    /// A WAD of empty binary maps.
    fn wad_with(maps: &[&str]) -> Vec<u8> {
        let mut names = Vec::new();
        for map in maps {
            names.extend([
                *map, "THINGS", "LINEDEFS", "SIDEDEFS", "VERTEXES", "SECTORS",
            ]);
        }
        let mut bytes = b"PWAD".to_vec();
        bytes.extend((names.len() as u32).to_le_bytes());
        bytes.extend(12u32.to_le_bytes());
        for name in names {
            bytes.extend([0; 8]);
            let mut padded = name.as_bytes().to_vec();
            padded.resize(8, 0);
            bytes.extend(padded);
        }
        bytes
    }

    fn message(bytes: &[u8], file: &str, map: Option<&str>) -> String {
        read(bytes.to_vec(), file, map).unwrap_err().to_string()
    }

    #[test]
    fn toml_by_its_ending() {
        let level = read(ROOM.to_vec(), "hall.TOML", None).unwrap();
        assert_eq!(
            (level.name.as_str(), level.source.as_str()),
            ("hall", "hall.TOML")
        );
    }

    #[test]
    fn a_wad_by_its_first_bytes() {
        let bytes = wad_with(&["E1M1", "E1M2"]);
        let source = Source::parse(bytes, "freedoom.bin").unwrap();
        assert_eq!(source.maps(), ["E1M1", "E1M2"]);
    }

    #[test]
    fn messages_name_the_file_and_what_to_do() {
        let two = wad_with(&["E1M1", "E1M2"]);
        assert_eq!(
            message(&two, "two.wad", None),
            "two.wad: there are 2 maps, name one with --map: E1M1, E1M2"
        );
        let missing = message(&two, "two.wad", Some("E9M9"));
        assert!(
            missing.contains("two.wad") && missing.contains("E1M1, E1M2"),
            "{missing}"
        );
        assert!(message(&wad_with(&[]), "none.wad", None).contains("no maps"));
        assert!(message(b"0\nSECTION\n", "plan.dxf", None).contains("plan.dxf"));
        assert!(message(b"hello", "plan.txt", None).contains("plan.txt: unknown kind"));
        assert!(message(b"hello", "plan.wad", None).starts_with("plan.wad: "));
        assert!(message(ROOM, "hall.toml", Some("E1M1")).contains("leave --map out"));
        assert!(message(b"a = 1\n\xff", "hall.toml", None).contains("hall.toml, line 2"));
        assert!(message(b"[[rom]]", "hall.toml", None).starts_with("hall.toml, line 1"));
    }
}
