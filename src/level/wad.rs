//! WAD files: the archive that Doom and its relatives keep their maps in.
//!
//! In: the bytes of a file. Out: [`Wad`], its lumps by number and the maps among them; and back
//! again, a copy of the bytes with some lumps replaced or inserted. Format: 12 bytes of header
//! (`IWAD` or `PWAD`, number of lumps, offset of the directory), then lumps anywhere, and a
//! directory of 16 bytes a lump (offset, size, name of 8 bytes), all little-endian. See
//! "The Unofficial Doom Specs" 1.666, chapter 2.

use std::ops::Range;

use thiserror::Error;

const HEADER: usize = 12;
const ENTRY: usize = 16;

/// Lumps that make up a binary map, in the order in which they follow the map's marker.
const MAP_LUMPS: [&str; 12] = [
    "THINGS", "LINEDEFS", "SIDEDEFS", "VERTEXES", "SEGS", "SSECTORS", "NODES", "SECTORS", "REJECT",
    "BLOCKMAP", "BEHAVIOR", "SCRIPTS",
];

/// What makes a file unreadable as a WAD. Messages do not name the file: the caller knows it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WadError {
    /// Shorter than the header.
    #[error("the file has {size} bytes, but a WAD's header alone has 12; it is cut off or no WAD")]
    TooShort {
        /// Bytes in the file.
        size: usize,
    },
    /// Does not begin with `IWAD` or `PWAD`.
    #[error("the file begins with '{found}' instead of 'IWAD' or 'PWAD', so it is no Doom WAD")]
    Signature {
        /// The first four bytes, escaped.
        found: String,
    },
    /// The directory does not lie inside the file.
    #[error(
        "the header announces a directory of {count} lumps at byte {offset}, which does not fit \
         the file's {size} bytes; the file is damaged or cut off, fetch it again"
    )]
    Directory {
        /// Number of lumps, as written.
        count: i32,
        /// Offset of the directory, as written.
        offset: i32,
        /// Bytes in the file.
        size: usize,
    },
    /// A lump does not lie inside the file.
    #[error(
        "lump {index} '{name}' claims {length} bytes at offset {offset}, which does not fit the \
         file's {size} bytes; the file is damaged or cut off, fetch it again"
    )]
    Lump {
        /// Number of the lump, from 0.
        index: usize,
        /// Its name.
        name: String,
        /// Its offset, as written.
        offset: i32,
        /// Its size, as written.
        length: i32,
        /// Bytes in the file.
        size: usize,
    },
    /// A map that was asked for is not there.
    #[error("there is no map '{map}'; the maps are: {known}")]
    NoMap {
        /// What was asked for.
        map: String,
        /// Names of the maps that are there, or "none".
        known: String,
    },
    /// A map has no lump that says where to insert another.
    #[error("map {map} has no lump '{lump}', so its lumps cannot be completed; rebuild the map")]
    NoLump {
        /// The map.
        map: String,
        /// The lump that is missing.
        lump: &'static str,
    },
    /// The result would not fit the format.
    #[error("the new WAD would have {size} bytes, but the format ends at 2147483647")]
    TooLarge {
        /// Bytes that it would have.
        size: usize,
    },
}

/// What the first four bytes say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WadKind {
    /// `IWAD`: a whole game.
    Iwad,
    /// `PWAD`: maps and replacements to play with a game.
    Pwad,
}

/// One entry of the directory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lump {
    /// Name in capitals, without the padding; bytes outside ASCII are read as Latin-1.
    pub name: String,
    /// Where its bytes lie in the file; inside the file, empty for markers.
    pub bytes: Range<usize>,
}

/// A map among the lumps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WadMap {
    /// Name of its marker: `E1M1`, `MAP01`, or anything else.
    pub name: String,
    /// Number of the marker lump.
    pub marker: usize,
    /// Numbers of the lumps that belong to it, after the marker (`ENDMAP` not counted).
    pub lumps: Range<usize>,
    /// Whether it is a text map (UDMF: `TEXTMAP` … `ENDMAP`).
    pub text: bool,
}

/// A WAD whose directory and lumps are known to lie inside its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wad {
    /// Whole game or add-on.
    pub kind: WadKind,
    bytes: Vec<u8>,
    directory: usize,
    lumps: Vec<Lump>,
}

/// A change to a WAD's lumps, for [`Wad::with_edits`]. Numbers are those before any edit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LumpEdit {
    /// Gives the lump with this number new bytes.
    Replace {
        /// Number of the lump.
        lump: usize,
        /// Its new bytes.
        bytes: Vec<u8>,
    },
    /// Puts a new lump before the one with this number (or at the end, if it is their count).
    Insert {
        /// Number of the lump that will follow it.
        before: usize,
        /// Name, at most 8 ASCII characters (longer ones are cut).
        name: &'static str,
        /// Its bytes.
        bytes: Vec<u8>,
    },
}

impl Wad {
    /// Reads header and directory. An empty lump may point anywhere, as markers do; every other
    /// lump must lie inside the file.
    pub fn parse(bytes: Vec<u8>) -> Result<Wad, WadError> {
        let size = bytes.len();
        if size < HEADER {
            return Err(WadError::TooShort { size });
        }
        let kind = match &bytes[..4] {
            b"IWAD" => WadKind::Iwad,
            b"PWAD" => WadKind::Pwad,
            other => {
                return Err(WadError::Signature {
                    found: other.escape_ascii().to_string(),
                });
            }
        };
        let count = int_at(&bytes, 4);
        let offset = int_at(&bytes, 8);
        let extent = usize::try_from(count)
            .ok()
            .and_then(|n| inside(offset, n.checked_mul(ENTRY)?, size));
        // A directory over the header would read the header as a lump: no writer means that, but
        // an empty WAD may say offset 0.
        let directory = match extent {
            Some(at) if at.is_empty() || at.start >= HEADER => at,
            _ => {
                return Err(WadError::Directory {
                    count,
                    offset,
                    size,
                });
            }
        };
        let mut lumps = Vec::with_capacity(directory.len() / ENTRY);
        for (index, entry) in bytes[directory.clone()].chunks_exact(ENTRY).enumerate() {
            let (offset, length) = (int_at(entry, 0), int_at(entry, 4));
            let name = name_from(&entry[8..]);
            let extent = match usize::try_from(length) {
                Ok(0) => Some(0..0),
                Ok(n) => inside(offset, n, size),
                Err(_) => None,
            };
            match extent {
                Some(bytes) => lumps.push(Lump { name, bytes }),
                None => {
                    return Err(WadError::Lump {
                        index,
                        name,
                        offset,
                        length,
                        size,
                    });
                }
            }
        }
        Ok(Wad {
            kind,
            directory: directory.start,
            lumps,
            bytes,
        })
    }

    /// The directory, in the file's order.
    pub fn lumps(&self) -> &[Lump] {
        &self.lumps
    }

    /// Bytes of the lump with this number; empty where there is no such lump.
    pub fn lump(&self, index: usize) -> &[u8] {
        self.lumps
            .get(index)
            .map_or(&[], |l| &self.bytes[l.bytes.clone()])
    }

    /// Bytes of the last lump of this name (later lumps override earlier ones), in any case.
    pub fn lump_named(&self, name: &str) -> Option<&[u8]> {
        let index = self
            .lumps
            .iter()
            .rposition(|l| l.name.eq_ignore_ascii_case(name))?;
        Some(self.lump(index))
    }

    /// The maps, in the file's order. Of several with one name only the last is there, as it
    /// overrides the others.
    pub fn maps(&self) -> Vec<WadMap> {
        let mut maps: Vec<WadMap> = Vec::new();
        for marker in 0..self.lumps.len() {
            if let Some(map) = self.map_at(marker) {
                maps.retain(|m| m.name != map.name);
                maps.push(map);
            }
        }
        maps
    }

    /// The map of this name, in any case; the error lists the maps that are there.
    pub fn map(&self, name: &str) -> Result<WadMap, WadError> {
        let maps = self.maps();
        let known = || match maps.len() {
            0 => "none".to_string(),
            _ => {
                let names: Vec<&str> = maps.iter().map(|m| m.name.as_str()).collect();
                names.join(", ")
            }
        };
        maps.iter()
            .find(|m| m.name.eq_ignore_ascii_case(name))
            .cloned()
            .ok_or_else(|| WadError::NoMap {
                map: name.to_string(),
                known: known(),
            })
    }

    /// Number of the first lump of this name among a map's lumps.
    pub fn find_in_map(&self, map: &WadMap, name: &str) -> Option<usize> {
        map.lumps.clone().find(|&i| self.lumps[i].name == name)
    }

    /// Bytes of the first lump of this name among a map's lumps.
    pub fn lump_in_map(&self, map: &WadMap, name: &str) -> Option<&[u8]> {
        self.find_in_map(map, name).map(|i| self.lump(i))
    }

    /// A copy of the file in which each named map has this `REJECT` lump: the one it has gets the
    /// new bytes, a missing one is put where the format wants it (after `SECTORS`; in a text map
    /// before `ENDMAP`). Everything else stays, see [`Wad::with_edits`].
    pub fn with_rejects(&self, rejects: &[(String, Vec<u8>)]) -> Result<Vec<u8>, WadError> {
        let mut edits = Vec::new();
        for (name, bytes) in rejects {
            let map = self.map(name)?;
            let bytes = bytes.clone();
            edits.push(match self.find_in_map(&map, "REJECT") {
                Some(lump) => LumpEdit::Replace { lump, bytes },
                None => {
                    let before = if map.text {
                        map.lumps.end
                    } else {
                        1 + self.find_in_map(&map, "SECTORS").ok_or(WadError::NoLump {
                            map: map.name.clone(),
                            lump: "SECTORS",
                        })?
                    };
                    let name = "REJECT";
                    LumpEdit::Insert {
                        before,
                        name,
                        bytes,
                    }
                }
            });
        }
        self.with_edits(&edits)
    }

    /// A new WAD (a PWAD) of these maps alone, in the order of their names here.
    ///
    /// # Errors
    /// Where there is no such map, or the result would be too large.
    pub fn with_maps_only(&self, names: &[String]) -> Result<Vec<u8>, WadError> {
        let mut lumps = Vec::new();
        for name in names {
            let map = self.map(name)?;
            let end = map.lumps.end + usize::from(map.text);
            lumps.extend(map.marker..end.min(self.lumps.len()));
        }
        let mut out = b"PWAD".to_vec();
        out.extend([0; HEADER - 4]);
        let mut directory = Vec::new();
        for lump in lumps {
            directory.extend(extent_bytes(out.len(), self.lump(lump).len())?);
            let mut name = [0; 8];
            for (to, from) in name.iter_mut().zip(self.lumps[lump].name.chars()) {
                *to = from as u8;
            }
            directory.extend(name);
            out.extend(self.lump(lump));
            // Four-byte alignment, which some engines want of lumps.
            out.resize(out.len().next_multiple_of(4), 0);
        }
        let head = extent_bytes(directory.len() / ENTRY, out.len())?;
        out[4..HEADER].copy_from_slice(&head);
        out.extend(directory);
        extent_bytes(0, out.len())?;
        Ok(out)
    }

    /// A copy of the file with these changes, all other lumps keeping name, order and bytes. A lump
    /// whose size stays and whose bytes no other lump shares is overwritten in place, so that
    /// nothing else in the file changes; any other new bytes go to the end, followed by the new
    /// directory, and the bytes they replace remain in the file unused. Edits that name a lump
    /// which is not there do nothing.
    pub fn with_edits(&self, edits: &[LumpEdit]) -> Result<Vec<u8>, WadError> {
        let directory_end = self.directory + self.lumps.len() * ENTRY;
        let mut out = self.bytes.clone();
        let (entries, _) = self.bytes[self.directory..directory_end].as_chunks::<ENTRY>();
        let mut entries = entries.to_vec();

        let (in_place, moved): (Vec<&LumpEdit>, Vec<&LumpEdit>) = edits.iter().partition(
            |e| matches!(e, LumpEdit::Replace { lump, bytes } if self.fits(*lump, bytes)),
        );
        for edit in in_place {
            if let LumpEdit::Replace { lump, bytes } = edit {
                out[self.lumps[*lump].bytes.clone()].copy_from_slice(bytes);
            }
        }
        if moved.is_empty() {
            return Ok(out);
        }

        let directory_is_last =
            directory_end == out.len() && self.lumps.iter().all(|l| l.bytes.end <= self.directory);
        if directory_is_last {
            out.truncate(self.directory);
        }
        let mut inserted: Vec<(usize, [u8; ENTRY])> = Vec::new();
        for edit in moved {
            // Four-byte alignment, which some engines want of lumps.
            out.resize(out.len().next_multiple_of(4), 0);
            match edit {
                LumpEdit::Replace { lump, bytes } => {
                    if let Some(entry) = entries.get_mut(*lump) {
                        entry[..8].copy_from_slice(&extent_bytes(out.len(), bytes.len())?);
                        out.extend_from_slice(bytes);
                    }
                }
                LumpEdit::Insert {
                    before,
                    name,
                    bytes,
                } => {
                    let mut entry = [0; ENTRY];
                    entry[..8].copy_from_slice(&extent_bytes(out.len(), bytes.len())?);
                    for (to, from) in entry[8..].iter_mut().zip(name.bytes()) {
                        *to = from;
                    }
                    inserted.push((*before, entry));
                    out.extend_from_slice(bytes);
                }
            }
        }
        // From the back, so that earlier numbers stay true; several at one place keep their order.
        inserted.sort_by_key(|&(before, _)| before);
        for (before, entry) in inserted.into_iter().rev() {
            entries.insert(before.min(entries.len()), entry);
        }
        out.resize(out.len().next_multiple_of(4), 0);
        let directory = extent_bytes(entries.len(), out.len())?;
        out.extend(entries.iter().flatten());
        extent_bytes(0, out.len())?;
        out[4..12].copy_from_slice(&directory);
        Ok(out)
    }

    /// Whether new bytes can take a lump's place without touching anything else.
    fn fits(&self, lump: usize, bytes: &[u8]) -> bool {
        let Some(own) = self.lumps.get(lump).map(|l| &l.bytes) else {
            return false;
        };
        let apart = |other: Range<usize>| other.end <= own.start || own.end <= other.start;
        let others = self.lumps.iter().enumerate().filter(|&(i, _)| i != lump);
        own.len() == bytes.len()
            && (own.is_empty()
                || apart(0..HEADER)
                    && apart(self.directory..self.directory + self.lumps.len() * ENTRY)
                    && others
                        .filter(|(_, l)| !l.bytes.is_empty())
                        .all(|(_, l)| apart(l.bytes.clone())))
    }

    fn map_at(&self, marker: usize) -> Option<WadMap> {
        let name = &self.lumps[marker].name;
        let follows = |i: usize| self.lumps.get(i).map(|l| l.name.as_str());
        let first = marker + 1;
        if follows(first) == Some("TEXTMAP") {
            let end = (first..self.lumps.len())
                .find(|&i| self.lumps[i].name == "ENDMAP")
                .unwrap_or(first + 1);
            return Some(WadMap {
                name: name.clone(),
                marker,
                lumps: first..end,
                text: true,
            });
        }
        let is_marker = !MAP_LUMPS.contains(&name.as_str());
        let begins_map = matches!(
            follows(first),
            Some("THINGS" | "LINEDEFS" | "SIDEDEFS" | "VERTEXES" | "SECTORS")
        );
        if !is_marker || !begins_map {
            return None;
        }
        let end = (first..self.lumps.len())
            .find(|&i| !MAP_LUMPS.contains(&self.lumps[i].name.as_str()))
            .unwrap_or(self.lumps.len());
        Some(WadMap {
            name: name.clone(),
            marker,
            lumps: first..end,
            text: false,
        })
    }
}

/// A name of up to 8 bytes, ended by a NUL, in capitals. What follows the NUL is rubbish that some
/// writers leave there.
pub(super) fn name_from(bytes: &[u8]) -> String {
    bytes
        .iter()
        .take(8)
        .take_while(|&&b| b != 0)
        .map(|&b| char::from(b.to_ascii_uppercase()))
        .collect()
}

/// The little-endian number at `at`, which lies inside `bytes`.
fn int_at(bytes: &[u8], at: usize) -> i32 {
    i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// `length` bytes at `offset`, if these lie in a file of `size` bytes.
fn inside(offset: i32, length: usize, size: usize) -> Option<Range<usize>> {
    let start = usize::try_from(offset).ok()?;
    let end = start.checked_add(length)?;
    (end <= size).then_some(start..end)
}

/// Two numbers as the format stores them: little-endian, 31 bits.
fn extent_bytes(first: usize, second: usize) -> Result<[u8; 8], WadError> {
    let int = |n: usize| i32::try_from(n).map_err(|_| WadError::TooLarge { size: n });
    let mut bytes = [0; 8];
    bytes[..4].copy_from_slice(&int(first)?.to_le_bytes());
    bytes[4..].copy_from_slice(&int(second)?.to_le_bytes());
    Ok(bytes)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A WAD of these lumps, its directory last.
    pub fn wad_bytes(lumps: &[(&str, &[u8])]) -> Vec<u8> {
        let mut out = b"PWAD".to_vec();
        let total: usize = lumps.iter().map(|(_, b)| b.len()).sum();
        out.extend((lumps.len() as i32).to_le_bytes());
        out.extend(((HEADER + total) as i32).to_le_bytes());
        for (_, bytes) in lumps {
            out.extend(*bytes);
        }
        let mut offset = HEADER;
        for (name, bytes) in lumps {
            out.extend(extent_bytes(offset, bytes.len()).unwrap());
            let mut padded = [0; 8];
            padded[..name.len()].copy_from_slice(name.as_bytes());
            out.extend(padded);
            offset += bytes.len();
        }
        out
    }

    fn two_maps() -> Vec<u8> {
        wad_bytes(&[
            ("PLAYPAL", b"colours"),
            ("MAP01", b""),
            ("THINGS", b"t"),
            ("SECTORS", b"s"),
            ("REJECT", b"ab"),
            ("BLOCKMAP", b"b"),
            ("MAP02", b""),
            ("TEXTMAP", b"x"),
            ("ZNODES", b"z"),
            ("ENDMAP", b""),
            ("MAP03", b""),
            ("THINGS", b"t"),
            ("SECTORS", b"ss"),
            ("BLOCKMAP", b"b"),
            ("OTHER", b"o"),
        ])
    }

    fn listing(bytes: Vec<u8>) -> Vec<(String, Vec<u8>)> {
        let wad = Wad::parse(bytes).unwrap();
        let lump = |(i, l): (usize, &Lump)| (l.name.clone(), wad.lump(i).to_vec());
        wad.lumps().iter().enumerate().map(lump).collect()
    }

    #[test]
    fn maps_are_found_and_later_ones_override() {
        let wad = Wad::parse(two_maps()).unwrap();
        let maps = wad.maps();
        let names: Vec<&str> = maps.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["MAP01", "MAP02", "MAP03"]);
        assert_eq!(maps[0].lumps, 2..6);
        assert_eq!(maps[1].lumps, 7..9);
        assert!(maps[1].text);
        assert_eq!(wad.lump_in_map(&maps[0], "REJECT"), Some(&b"ab"[..]));

        let twice = [
            ("MAP01", &b""[..]),
            ("THINGS", b"1"),
            ("MAP01", b""),
            ("THINGS", b"2"),
        ];
        let wad = Wad::parse(wad_bytes(&twice)).unwrap();
        assert_eq!(wad.maps().len(), 1);
        let map = wad.map("map01").unwrap();
        assert_eq!(wad.lump_in_map(&map, "THINGS"), Some(&b"2"[..]));
    }

    #[test]
    fn an_unknown_map_lists_the_known_ones() {
        let wad = Wad::parse(two_maps()).unwrap();
        let message = wad.map("E1M1").unwrap_err().to_string();
        assert!(message.contains("'E1M1'"), "{message}");
        assert!(message.contains("MAP01, MAP02, MAP03"), "{message}");
    }

    #[test]
    fn cut_off_anywhere_is_refused() {
        let whole = two_maps();
        for n in 0..whole.len() {
            assert!(Wad::parse(whole[..n].to_vec()).is_err(), "{n} bytes");
        }
    }

    #[test]
    fn impossible_lumps_are_refused_by_name_and_offset() {
        for (offset, length) in [(-1, 4), (12, -1), (1 << 30, 4), (12, i32::MAX)] {
            let mut bytes = wad_bytes(&[("MAP01", b""), ("THINGS", b"1234")]);
            let entry = bytes.len() - ENTRY;
            bytes[entry..entry + 4].copy_from_slice(&i32::to_le_bytes(offset));
            bytes[entry + 4..entry + 8].copy_from_slice(&i32::to_le_bytes(length));
            let message = Wad::parse(bytes).unwrap_err().to_string();
            assert!(message.contains("lump 1 'THINGS'"), "{message}");
            assert!(message.contains(&format!("offset {offset}")), "{message}");
        }
    }

    #[test]
    fn impossible_directories_are_refused() {
        for (count, offset) in [(-1, 12), (1, -4), (i32::MAX, 12), (1, 8), (2, 13)] {
            let mut bytes = wad_bytes(&[("LUMP", b"1234")]);
            bytes[4..8].copy_from_slice(&i32::to_le_bytes(count));
            bytes[8..12].copy_from_slice(&i32::to_le_bytes(offset));
            let error = Wad::parse(bytes).unwrap_err();
            assert!(matches!(error, WadError::Directory { .. }), "{error}");
        }
    }

    #[test]
    fn a_reject_of_the_same_size_changes_only_its_own_bytes() {
        let before = two_maps();
        let wad = Wad::parse(before.clone()).unwrap();
        let after = wad
            .with_rejects(&[("MAP01".to_string(), b"cd".to_vec())])
            .unwrap();
        let changed: Vec<usize> = (0..before.len())
            .filter(|&i| before[i] != after[i])
            .collect();
        assert_eq!(before.len(), after.len());
        assert_eq!(changed.len(), 2);
        assert_eq!(listing(after)[4], ("REJECT".to_string(), b"cd".to_vec()));
    }

    #[test]
    fn rejects_are_replaced_and_inserted_in_their_order() {
        let before = two_maps();
        let wad = Wad::parse(before.clone()).unwrap();
        let after = wad
            .with_rejects(&[
                ("MAP03".to_string(), b"333".to_vec()),
                ("MAP01".to_string(), b"11111".to_vec()),
                ("MAP02".to_string(), b"2".to_vec()),
            ])
            .unwrap();
        let mut expected = listing(before);
        expected[4].1 = b"11111".to_vec();
        expected.insert(13, ("REJECT".to_string(), b"333".to_vec()));
        expected.insert(9, ("REJECT".to_string(), b"2".to_vec()));
        assert_eq!(listing(after), expected);
    }

    #[test]
    fn maps_alone_make_a_new_wad() {
        let wad = Wad::parse(two_maps()).unwrap();
        let names = ["map03", "MAP02"].map(String::from);
        let alone = listing(wad.with_maps_only(&names).unwrap());
        let all = listing(two_maps());
        assert_eq!(alone, [&all[10..14], &all[6..10]].concat());
        let nobody = wad.with_maps_only(&["MAP09".to_string()]);
        assert!(matches!(nobody, Err(WadError::NoMap { .. })));
    }

    #[test]
    fn shared_bytes_are_not_overwritten() {
        let mut bytes = wad_bytes(&[
            ("MAP01", b""),
            ("THINGS", b"12"),
            ("SECTORS", b"s"),
            ("REJECT", b"xy"),
        ]);
        // REJECT now shares the bytes of THINGS.
        let entry = bytes.len() - ENTRY;
        bytes[entry..entry + 4].copy_from_slice(&12i32.to_le_bytes());
        let wad = Wad::parse(bytes).unwrap();
        let after = listing(
            wad.with_rejects(&[("MAP01".to_string(), b"ab".to_vec())])
                .unwrap(),
        );
        assert_eq!(after[1].1, b"12");
        assert_eq!(after[3].1, b"ab");
    }
}
