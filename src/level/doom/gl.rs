//! GL nodes: the convex parts that a node builder cut a Doom map into, with the tree of its cuts.
//!
//! In: a WAD that holds GL nodes (the map's own, or a `.gwa` file beside it) and the WAD of the map.
//! Out: [`GlNodes`]. Versions 2 and 5 are read; source: Andrew Apted, "Specification for GL Nodes"
//! 2.0 and 5.0. All numbers are little-endian. The lumps follow a marker `GL_<map>` (or `GL_LEVEL`,
//! whose text names the map):
//!
//! | lump | record | version 2 | version 5 |
//! |---|---|---|---|
//! | `GL_VERT` | `gNd2` or `gNd5`, then x, y in 2^-16 units | i32 ×2 | i32 ×2 |
//! | `GL_SEGS` | start, end (highest bit: in `GL_VERT`), linedef, side, partner | u16 ×5 | u32 ×2, u16 ×2, u32 |
//! | `GL_SSECT` | number of segs, first seg | u16 ×2 | u32 ×2 |
//! | `GL_NODES` | x, y, dx, dy; two boxes; right and left child (highest bit: a subsector) | i16 ×4, 16 bytes, u16 ×2 | i16 ×4, 16 bytes, u32 ×2 |
//!
//! A subsector's segs go around it clockwise. What Debian's zdbsp makes of version 5 (`-5`) is not what
//! the specification says, but is read, too.

use thiserror::Error;

use crate::level::wad::{LumpEdit, Wad, WadError, WadMap};

/// The parts of a map, and the tree that leads to them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GlNodes {
    /// 2 or 5.
    pub version: u8,
    /// The segs of each subsector, clockwise around it.
    pub subsectors: Vec<Vec<GlSeg>>,
    /// The tree; its root is the last one.
    pub nodes: Vec<GlNode>,
}

/// An edge of a subsector, which lies on its right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlSeg {
    /// Where it starts and ends, in 2^-16 map units. Corners that the builder made are rounded.
    pub ends: [[i64; 2]; 2],
    /// The linedef that it lies on; `None` for one that only closes the outline.
    pub linedef: Option<u32>,
}

/// A split of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlNode {
    /// A point of the partition line, in map units.
    pub from: [i64; 2],
    /// The line's direction.
    pub by: [i64; 2],
    /// What lies right of it, and left of it.
    pub children: [GlChild; 2],
}

/// What lies on one side of a partition line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GlChild {
    /// Index into [`GlNodes::nodes`].
    Node(u32),
    /// Index into [`GlNodes::subsectors`].
    Subsector(u32),
}

/// Why GL nodes cannot be read. Messages do not name the file: the caller knows it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GlError {
    /// There are none.
    #[error(
        "map {map} has no GL nodes; let a node builder make some (`glbsp -v5 in.wad -o out.gwa`, or \
         `zdbsp -g in.wad -o out.wad`)"
    )]
    None {
        /// The map.
        map: String,
    },
    /// A text map.
    #[error("map {map} is a text map, and their nodes hold no place for a GL_PVS")]
    Text {
        /// The map.
        map: String,
    },
    /// Another version.
    #[error(
        "the GL nodes of map {map} are of version {found}; versions 2 and 5 are read: build them \
         again (`glbsp -v5`, or `zdbsp -g`)"
    )]
    Version {
        /// The map.
        map: String,
        /// The version.
        found: String,
    },
    /// A lump is not there.
    #[error("map {map}: lump {lump} is missing; build the GL nodes again")]
    Missing {
        /// The map.
        map: String,
        /// The lump.
        lump: &'static str,
    },
    /// A lump does not hold a whole number of records.
    #[error(
        "map {map}: lump {lump} has {size} bytes, which is no whole number of records of {record}; \
         it is cut off or of another version, build the GL nodes again"
    )]
    Size {
        /// The map.
        map: String,
        /// The lump.
        lump: &'static str,
        /// Its bytes, without what comes before the records.
        size: usize,
        /// Bytes of a record.
        record: usize,
    },
    /// A number leads nowhere.
    #[error(
        "map {map}: record {index} of lump {lump} {what}; the GL nodes are not of this map or \
         damaged, build them again"
    )]
    Record {
        /// The map.
        map: String,
        /// The lump.
        lump: &'static str,
        /// Number of the record, from 0.
        index: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The WAD has no such map.
    #[error(transparent)]
    Wad(#[from] WadError),
}

/// The lumps, in their order.
const LUMPS: [&str; 5] = ["GL_VERT", "GL_SEGS", "GL_SSECT", "GL_NODES", "GL_PVS"];

/// The lumps of one map among those of a WAD.
struct Lumps<'a> {
    wad: &'a Wad,
    map: &'a str,
    /// Numbers of the lumps after the marker that are some of GL nodes.
    own: std::ops::Range<usize>,
}

impl<'a> Lumps<'a> {
    fn find(wad: &'a Wad, map: &'a str) -> Result<Self, GlError> {
        let marker = format!("GL_{map}").to_uppercase();
        let named = |i: usize| {
            let text = String::from_utf8_lossy(wad.lump(i)).to_uppercase();
            let names = text.lines().filter_map(|line| line.strip_prefix("LEVEL="));
            names.map(str::trim).any(|name| name == map.to_uppercase())
        };
        let all = wad.lumps();
        // Later ones override earlier ones.
        let at = (0..all.len())
            .rev()
            .find(|&i| all[i].name == marker || (all[i].name == "GL_LEVEL" && named(i)));
        let Some(at) = at else {
            return Err(GlError::None { map: map.into() });
        };
        let first = at + 1;
        let n = (all[first..].iter()).take_while(|l| LUMPS.contains(&l.name.as_str()));
        let own = first..first + n.count();
        Ok(Self { wad, map, own })
    }

    fn number(&self, name: &str) -> Option<usize> {
        self.own.clone().find(|&i| self.wad.lumps()[i].name == name)
    }

    fn bytes(&self, lump: &'static str) -> Result<&'a [u8], GlError> {
        let number = self.number(lump).ok_or(GlError::Missing {
            map: self.map.into(),
            lump,
        })?;
        Ok(self.wad.lump(number))
    }
}

/// Reads a map's GL nodes. `gl` is the WAD that holds them, `wad` that of the map; often the same.
///
/// # Errors
/// Where there are none, or not of version 2 or 5, or damaged ones.
pub fn read(wad: &Wad, gl: &Wad, map: &WadMap) -> Result<GlNodes, GlError> {
    let name = map.name.as_str();
    if map.text {
        return Err(GlError::Text { map: name.into() });
    }
    let lumps = Lumps::find(gl, name)?;
    let vertices = lumps.bytes("GL_VERT")?;
    let segs = lumps.bytes("GL_SEGS")?;
    let version = match (vertices.get(..4), segs.get(..4)) {
        (Some(b"gNd2"), Some(b"gNd3")) => Err("3"),
        (Some(b"gNd2"), _) => Ok(2),
        (Some(b"gNd4"), _) => Err("4"),
        (Some(b"gNd5"), _) => Ok(5),
        _ => Err("1"),
    };
    let version = version.map_err(|found| GlError::Version {
        map: name.into(),
        found: found.into(),
    })?;
    let own = wad.lump_in_map(map, "VERTEXES").ok_or(GlError::Missing {
        map: name.into(),
        lump: "VERTEXES",
    })?;
    let wide = version == 5;
    let subsectors = lumps.bytes("GL_SSECT")?;
    let file = Table::of(name, wide, subsectors, segs.len());
    let vertices = Vertices {
        own: file.records("VERTEXES", own, 4)?,
        new: file.records("GL_VERT", &vertices[4..], 8)?,
        wide,
    };
    let segs = file.records("GL_SEGS", segs, file.seg)?;
    let subsectors = file.records("GL_SSECT", subsectors, if wide { 8 } else { 4 })?;
    let subsectors = (subsectors.iter().enumerate())
        .map(|(i, record)| file.subsector(i, record, &segs, &vertices))
        .collect::<Result<Vec<_>, _>>()?;
    let nodes = lumps.bytes("GL_NODES")?;
    let record = if wide { 32 } else { 28 };
    let nodes = match subsectors.len().saturating_sub(1) * record {
        all if wide && file.seg == ZDBSP_SEG => nodes.get(..all).unwrap_or(nodes),
        _ => nodes,
    };
    let nodes = file.records("GL_NODES", nodes, record)?;
    if subsectors.is_empty() {
        return Err(GlError::Missing {
            map: name.into(),
            lump: "GL_SSECT",
        });
    }
    Ok(GlNodes {
        version,
        subsectors,
        nodes: nodes.iter().map(|record| file.node(record)).collect(),
    })
}

/// What puts a `GL_PVS` of these bytes behind a map's GL nodes, in the place of one that is there.
///
/// # Errors
/// Where the WAD has no GL nodes of that map.
pub fn pvs_edit(gl: &Wad, map: &str, bytes: Vec<u8>) -> Result<LumpEdit, GlError> {
    let lumps = Lumps::find(gl, map)?;
    Ok(match lumps.number("GL_PVS") {
        Some(lump) => LumpEdit::Replace { lump, bytes },
        None => LumpEdit::Insert {
            before: lumps.own.end,
            name: "GL_PVS",
            bytes,
        },
    })
}

/// The records of a lump.
type Records<'a> = Vec<&'a [u8]>;

/// Vertices of the map, and those that the node builder made.
struct Vertices<'a> {
    own: Records<'a>,
    new: Records<'a>,
    wide: bool,
}

impl Vertices<'_> {
    /// By the number that a seg holds, in 2^-16 units.
    fn get(&self, number: u32) -> Option<[i64; 2]> {
        let new = if self.wide { 1 << 31 } else { 1 << 15 };
        if number & new != 0 {
            let record = self.new.get((number & !new) as usize)?;
            Some([0, 4].map(|at| i64::from(u32_at(record, at) as i32)))
        } else {
            let record = self.own.get(number as usize)?;
            Some([0, 2].map(|at| i64::from(u16_at(record, at) as i16) << 16))
        }
    }
}

/// How a version lays out its records.
struct Table<'a> {
    map: &'a str,
    /// Whether numbers have 32 bits.
    wide: bool,
    /// Bytes of a seg.
    seg: usize,
}

/// Bytes of a seg as zdbsp 1.19 writes version 5: the linedef has four bytes, and the side is followed
/// by two of nothing. Its `GL_NODES` is too long by as many bytes as nodes would have with 40 each.
const ZDBSP_SEG: usize = 20;

impl<'a> Table<'a> {
    fn of(map: &'a str, wide: bool, subsectors: &[u8], segs: usize) -> Self {
        if !wide {
            let seg = 10;
            return Self { map, wide, seg };
        }
        // Every seg belongs to a subsector, so these tell how many there are.
        let counts = subsectors
            .chunks_exact(8)
            .map(|record| u32_at(record, 0) as usize);
        let n: usize = counts.fold(0, usize::saturating_add);
        let seg = if n > 0 && n.checked_mul(ZDBSP_SEG) == Some(segs) {
            ZDBSP_SEG
        } else {
            16
        };
        Self { map, wide, seg }
    }

    fn records<'b>(
        &self,
        lump: &'static str,
        bytes: &'b [u8],
        record: usize,
    ) -> Result<Records<'b>, GlError> {
        let size = bytes.len();
        if !size.is_multiple_of(record) {
            return Err(GlError::Size {
                map: self.map.into(),
                lump,
                size,
                record,
            });
        }
        Ok(bytes.chunks_exact(record).collect())
    }

    /// The number of so many in a record.
    fn number(&self, record: &[u8], i: usize) -> u32 {
        if self.wide {
            u32_at(record, 4 * i)
        } else {
            u16_at(record, 2 * i).into()
        }
    }

    fn subsector(
        &self,
        index: usize,
        record: &[u8],
        segs: &Records,
        vertices: &Vertices,
    ) -> Result<Vec<GlSeg>, GlError> {
        let wrong = |lump, index, what| GlError::Record {
            map: self.map.into(),
            lump,
            index,
            what,
        };
        let [n, first] = [0, 1].map(|i| self.number(record, i) as usize);
        let own = first.checked_add(n).and_then(|past| segs.get(first..past));
        let own = own.ok_or_else(|| wrong("GL_SSECT", index, "names segs that do not exist"))?;
        let seg = |(i, seg): (usize, &&[u8])| {
            let end = |k| {
                let what = "names a vertex that does not exist";
                let end = vertices.get(self.number(seg, k));
                end.ok_or_else(|| wrong("GL_SEGS", first + i, what))
            };
            // Of the four bytes that zdbsp gives a linedef, the upper two are of no use: all ones or 0.
            let linedef = u16_at(seg, if self.wide { 8 } else { 4 });
            Ok(GlSeg {
                ends: [end(0)?, end(1)?],
                linedef: (linedef != u16::MAX).then_some(linedef.into()),
            })
        };
        own.iter().enumerate().map(seg).collect()
    }

    fn node(&self, record: &[u8]) -> GlNode {
        let short = |i: usize| i64::from(u16_at(record, 2 * i) as i16);
        let children = [0, 1].map(|i| {
            let (n, leaf) = if self.wide {
                (u32_at(record, 24 + 4 * i), 1 << 31)
            } else {
                (u32::from(u16_at(record, 24 + 2 * i)), 1 << 15)
            };
            match n & leaf {
                0 => GlChild::Node(n),
                _ => GlChild::Subsector(n & !leaf),
            }
        });
        GlNode {
            from: [short(0), short(1)],
            by: [short(2), short(3)],
            children,
        }
    }
}

/// The number at `at`, which lies inside the record.
fn u16_at(record: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([record[at], record[at + 1]])
}

/// The number at `at`, which lies inside the record.
fn u32_at(record: &[u8], at: usize) -> u32 {
    u32::from(u16_at(record, at)) | u32::from(u16_at(record, at + 2)) << 16
}
