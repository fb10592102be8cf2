use std::path::Path;
use std::sync::LazyLock;

use proptest::prelude::*;

use super::*;
use crate::cells::{CellId, Doors, Options, Subdivision, subdivide};
use crate::level::{Level, doom, snap, toml, wad};
use crate::pvs::{Class, Method, Progress, sweep};

fn sample(name: &str) -> Level {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(name);
    toml::read(&std::fs::read_to_string(path).unwrap(), name).unwrap()
}

fn built(level: &Level, subdivision: Subdivision, doors: Doors) -> PvsFile {
    let graph = subdivide(
        level,
        &Options {
            subdivision,
            doors,
            ..Options::default()
        },
    );
    let pvs = sweep::sweep(&graph, &Progress::default());
    PvsFile {
        info: LevelInfo::of(level),
        graph,
        pvs,
    }
}

fn bytes_of(file: &PvsFile) -> Vec<u8> {
    encode(&file.info, &file.graph, &file.pvs)
}

/// The tiny sample level's file.
static TINY: LazyLock<Vec<u8>> = LazyLock::new(|| {
    bytes_of(&built(
        &sample("tiny.toml"),
        Subdivision::Cdt,
        Doors::Closed,
    ))
});

/// The same bytes with another checksum, so that what lies behind it is reached.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - TRAILER;
    let crc = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc.to_le_bytes());
    bytes
}

/// A whole file of these sections.
fn envelope(sections: &[Section]) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    out.extend(VERSION.to_le_bytes());
    out.extend((sections.len() as u32).to_le_bytes());
    out.extend(0u64.to_le_bytes());
    for (tag, content) in sections {
        out.extend(tag);
        out.extend((content.len() as u64).to_le_bytes());
        let stored = compress(content);
        out.extend((stored.len() as u64).to_le_bytes());
        out.extend(stored);
    }
    out.extend([0; TRAILER]);
    let length = out.len() as u64;
    out[16..HEADER].copy_from_slice(&length.to_le_bytes());
    sealed(out)
}

/// The tiny level's sections, to be spoiled.
fn tiny_sections() -> Vec<Section> {
    let file = decode(&TINY).unwrap();
    content::sections(&file.info, &file.graph, &file.pvs)
}

#[track_caller]
fn assert_comes_back(file: &PvsFile) {
    let bytes = bytes_of(file);
    let back = decode(&bytes).unwrap();
    assert_eq!(back.info, file.info);
    assert_eq!(back.pvs, file.pvs);
    let (graph, back) = (&file.graph, &back.graph);
    assert_eq!(back.grid, graph.grid);
    assert_eq!(back.options, graph.options);
    assert_eq!(back.cost, graph.cost);
    assert!(back.vertices.iter().eq(graph.vertices.iter()));
    assert_eq!(back.cells, graph.cells);
    assert_eq!(back.edges, graph.edges);
    assert_eq!(back.portals, graph.portals);
}

#[test]
fn every_sample_level_comes_back_as_it_was() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !name.ends_with(".toml") {
            continue;
        }
        let level = sample(&name);
        for subdivision in Subdivision::ALL {
            for doors in [Doors::Open, Doors::Closed] {
                assert_comes_back(&built(&level, subdivision, doors));
            }
        }
    }
}

/// Needs the Debian package `freedoom`; does nothing without it.
#[test]
fn doom_maps_come_back_as_they_were() {
    let Ok(bytes) = std::fs::read("/usr/share/games/doom/freedoom1.wad") else {
        return;
    };
    let wad = wad::Wad::parse(bytes).unwrap();
    for map in ["E1M1", "E1M2", "E1M8", "E3M6"] {
        let level = snap::snap(doom::read_map(&wad, map, "freedoom1.wad").unwrap()).unwrap();
        for subdivision in Subdivision::ALL {
            assert_comes_back(&built(&level, subdivision, Doors::Open));
        }
    }
}

#[test]
fn a_file_cut_off_anywhere_is_refused() {
    for n in 0..TINY.len() {
        let error = decode(&TINY[..n]).unwrap_err();
        let expected = if n == 0 {
            matches!(error, FileError::Foreign { .. })
        } else {
            matches!(error, FileError::CutOff { size, .. } if size == n)
        };
        assert!(expected, "{n} bytes: {error}");
    }
    let mut longer = TINY.clone();
    longer.push(0);
    assert!(matches!(decode(&longer), Err(FileError::TooLong { .. })));
}

#[test]
fn every_flipped_bit_is_noticed() {
    for i in 0..TINY.len() * 8 {
        let mut bytes = TINY.clone();
        bytes[i / 8] ^= 1 << (i % 8);
        let error = decode(&bytes).unwrap_err();
        let expected = match i / 8 {
            0..8 => matches!(error, FileError::Foreign { .. }),
            8..12 => matches!(error, FileError::Version { .. }),
            16..24 => matches!(error, FileError::CutOff { .. } | FileError::TooLong { .. }),
            _ => matches!(error, FileError::Checksum { .. }),
        };
        assert!(expected, "bit {i}: {error}");
    }
}

#[test]
fn foreign_files_are_named_as_such() {
    for bytes in [
        &b"PWAD\0\0\0\0"[..],
        b"\x89PNG\r\n\x1a\n",
        b"{\"format\":",
        b"",
        b"\x89PVS\n\x1a\n",
    ] {
        let error = decode(bytes).unwrap_err();
        assert!(matches!(error, FileError::Foreign { .. }), "{error}");
    }
    let mut newer = TINY.clone();
    newer[8] = 2;
    assert_eq!(
        decode(&sealed(newer)).unwrap_err(),
        FileError::Version { found: 2, known: 1 }
    );
}

#[test]
fn sections_of_unknown_tags_are_skipped_and_missing_ones_missed() {
    let mut sections = tiny_sections();
    sections.push((*b"XTRA", b"what a later version adds".to_vec()));
    assert_eq!(
        decode(&envelope(&sections)).unwrap().pvs,
        decode(&TINY).unwrap().pvs
    );
    for i in 0..sections.len() - 1 {
        let mut without = sections.clone();
        let (tag, content) = without.remove(i);
        let tag = String::from_utf8(tag.to_vec()).unwrap();
        let missing = FileError::Section {
            tag: tag.clone(),
            what: "is missing",
        };
        assert_eq!(decode(&envelope(&without)).unwrap_err(), missing);
        let mut twice = sections.clone();
        twice.push((sections[i].0, content));
        let double = FileError::Section {
            tag,
            what: "is there more than once",
        };
        assert_eq!(decode(&envelope(&twice)).unwrap_err(), double);
    }
}

#[test]
fn a_length_that_zlib_cannot_reach_is_refused_unread() {
    // VISI's content length and, so that they agree, the number of cells in INFO.
    let mut sections = tiny_sections();
    sections[0].1[4..8].copy_from_slice(&4_000_000_000u32.to_le_bytes());
    let error = decode(&envelope(&sections)).unwrap_err();
    assert!(
        matches!(&error, FileError::Section { tag, .. } if tag == "CELL"),
        "{error}"
    );
    let mut bytes = envelope(&sections);
    let cell = bytes.windows(4).position(|w| w == b"CELL").unwrap();
    bytes[cell + 4..cell + 12].copy_from_slice(&64_000_000_000u64.to_le_bytes());
    let error = decode(&sealed(bytes)).unwrap_err();
    let what = "claims a length that its data cannot have";
    assert_eq!(
        error,
        FileError::Section {
            tag: "CELL".into(),
            what
        }
    );
}

#[test]
fn a_pair_that_cannot_be_is_refused() {
    let mut file = decode(&TINY).unwrap();
    let portal = file.graph.portals[0];
    let [a, b] = file.graph.joined(&portal);
    let mut visible = crate::pvs::BitMatrix::new(file.graph.cells.len());
    for cell in file.graph.cell_ids() {
        for seen in file
            .pvs
            .seen_from(cell)
            .filter(|&s| (cell, s) != (a, b) && (s, cell) != (a, b))
        {
            visible.set(cell.0 as usize, seen.0 as usize);
        }
    }
    file.pvs.visible = visible;
    // Neighbours see each other, but a class may promise less.
    for class in Class::ALL {
        file.pvs.class = class;
        let result = decode(&bytes_of(&file));
        assert_eq!(result.is_err(), class.is_complete(), "{class:?}");
    }
    file.pvs.class = Class::Exact;
    let error = decode(&bytes_of(&file)).unwrap_err();
    assert!(matches!(error, FileError::Visible(_)), "{error}");
    file.pvs.heights = true;
    assert!(
        decode(&bytes_of(&file)).is_ok(),
        "an opening without height"
    );
}

#[test]
fn methods_and_classes_come_back() {
    let mut file = built(&sample("house.toml"), Subdivision::Bsp, Doors::Open);
    for method in Method::ALL {
        file.pvs.method = method;
        file.pvs.class = method.class();
        file.pvs.undecided = 7;
        assert_comes_back(&file);
    }
}

#[test]
fn numbers_with_no_meaning_are_named_with_their_place() {
    let spoil = |tag: &[u8; 4], at: usize, bytes: &[u8]| {
        let mut sections = tiny_sections();
        let section = sections.iter_mut().find(|s| &s.0 == tag).unwrap();
        section.1[at..at + bytes.len()].copy_from_slice(bytes);
        decode(&envelope(&sections)).unwrap_err().to_string()
    };
    let far = 1_000_000u32.to_le_bytes();
    for (tag, at, bytes, message) in [
        (b"INFO", 36, &[7, 0, 0, 0][..], "kind"),
        (b"INFO", 40, &far, "exponent"),
        (b"INFO", 44, &[4], "flag"),
        (
            b"EXAC",
            32,
            &[0; 8],
            "vertex 0 of section 'EXAC' has an impossible w",
        ),
        (
            b"EXAC",
            40 + 12,
            &[1],
            "vertex 1 of section 'EXAC' lies off the grid",
        ),
        (
            b"EXAC",
            80 + 32,
            &[0, 0, 0, 0, 0, 0, 0xff, 0xff],
            "vertex 2",
        ),
        (
            b"CELL",
            0,
            &[1],
            "cell 0 does not begin where the one before it ends",
        ),
        (b"CELL", 4, &[2], "belongs to no cell"),
        (
            b"CELL",
            8,
            &far,
            "cell 0 of section 'CELL' lies in a sector",
        ),
        (b"CELL", 12, &[9], "'ALSO' ends too early"),
        (
            b"EDGE",
            0,
            &far,
            "edge 0 starts at a vertex that does not exist",
        ),
        (
            b"EDGE",
            12 + 4,
            &far,
            "edge 1 has a twin that does not exist",
        ),
        (
            b"EDGE",
            24 + 8,
            &far,
            "edge 2 of section 'EDGE' lies on a wall",
        ),
        (b"PORT", 0, &far, "portal 0"),
        (
            b"VISI",
            0,
            &[0],
            "row 0 of section 'VISI' says that a cell does not see itself",
        ),
        (
            b"VISI",
            0,
            &[3],
            "row 0 of section 'VISI' names cells past its end",
        ),
    ] {
        let error = spoil(tag, at, bytes);
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn the_layout_is_the_documented_one() {
    let file = decode(&TINY).unwrap();
    let at = |i: usize| u32::from_le_bytes(TINY[i..i + 4].try_into().unwrap());
    assert_eq!(
        (at(8), at(12), at(16) as usize, at(20)),
        (1, 8, TINY.len(), 0)
    );
    let sections = tiny_sections();
    let info = &sections[0].1;
    assert_eq!(info[4..8], (file.graph.cells.len() as u32).to_le_bytes());
    assert_eq!(info[100..104], (file.info.name.len() as u32).to_le_bytes());
    let visible = &sections[7].1;
    // Row 2 begins after those of 0 and 1, a byte each.
    assert_eq!(visible[2] & 1 != 0, file.pvs.sees(CellId(2), CellId(0)));
    assert_eq!(
        crc32fast::hash(b"123456789"),
        0xCBF4_3926,
        "as in zip and PNG"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(decode(&bytes).is_err());
        let mut with_magic = MAGIC.to_vec();
        with_magic.extend(bytes);
        prop_assert!(decode(&with_magic).is_err());
    }

    /// Contents changed behind a right checksum: refused, or at least sound.
    #[test]
    fn spoiled_contents_never_panic(
        edits in prop::collection::vec((0usize..8, any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut sections = tiny_sections();
        for (section, at, value) in edits {
            let content = &mut sections[section].1;
            if !content.is_empty() {
                let at = at.index(content.len());
                content[at] = value;
            }
        }
        if let Ok(file) = decode(&envelope(&sections)) {
            prop_assert_eq!(file.graph.validate(), Ok(()));
            prop_assert_eq!(file.pvs.validate(&file.graph), Ok(()));
        }
    }

    /// Stored bytes changed behind a right checksum: broken zlib streams, wrong lengths and tags.
    #[test]
    fn spoiled_streams_never_panic(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = TINY.clone();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let _ = decode(&sealed(bytes));
    }
}
