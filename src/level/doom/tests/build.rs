//! Small maps, written out in all three layouts.

use glam::DVec2;

use crate::level::doom::raw::{RawLine, RawMap, RawSector, RawSide, Specials, Thing};
use crate::level::doom::{DoomError, DoomMap, read_doom_map};
use crate::level::wad::{Wad, tests::wad_bytes};

/// Numbers of the two lines between the rooms of [`three_rooms`].
pub const WEST_DOOR: usize = 8;
pub const EAST_DOOR: usize = 9;

/// Three rooms of 64 by 64 units in a row, sectors 0, 1, 2 from west to east, floors 0, ceilings
/// 128. Both lines of the middle room are two-sided, and the middle room is behind them.
pub fn three_rooms() -> RawMap {
    let mut map = RawMap::default();
    for y in [0.0, 64.0] {
        for x in 0..4 {
            map.vertices.push(DVec2::new(64.0 * f64::from(x), y));
        }
    }
    for tag in [10, 11, 12] {
        map.sectors.push(RawSector {
            ceiling: 128.0,
            floor_flat: "FLAT1".to_string(),
            ceiling_flat: "CEIL1".to_string(),
            light: 255,
            tags: vec![tag],
            ..RawSector::default()
        });
    }
    for room in 0..3 {
        add_line(&mut map, room + 1, room, &[room]);
    }
    for room in 0..3 {
        add_line(&mut map, 4 + room, 5 + room, &[room]);
    }
    add_line(&mut map, 0, 4, &[0]);
    add_line(&mut map, 7, 3, &[2]);
    add_line(&mut map, 5, 1, &[0, 1]);
    add_line(&mut map, 2, 6, &[2, 1]);
    map.things.push(Thing {
        at: DVec2::new(32.0, 32.0),
        angle: 90.0,
        kind: 1,
        ..Thing::default()
    });
    map
}

/// Adds a line with these sectors in front and behind.
pub fn add_line(map: &mut RawMap, v1: u32, v2: u32, sectors: &[u32]) {
    let mut side = |i: usize| {
        let sector = *sectors.get(i)?;
        map.sides.push(RawSide {
            sector,
            ..RawSide::default()
        });
        Some(map.sides.len() as u32 - 1)
    };
    let (front, back) = (side(0), side(1));
    map.lines.push(RawLine {
        v1,
        v2,
        front,
        back,
        two_sided: sectors.len() == 2,
        ..RawLine::default()
    });
}

/// Gives a line a Doom special and a tag.
pub fn set_special(map: &mut RawMap, line: usize, special: u32, tag: i32) {
    map.lines[line].special = special;
    map.lines[line].tags = vec![tag];
}

/// Reads a map through a WAD, in Doom's layout or, for action specials, in Hexen's.
pub fn read(map: &RawMap) -> Result<DoomMap, DoomError> {
    read_bytes(binary_wad(map))
}

/// Reads the map MAP01 of a WAD.
pub fn read_bytes(bytes: Vec<u8>) -> Result<DoomMap, DoomError> {
    let wad = Wad::parse(bytes).unwrap();
    read_doom_map(&wad, "MAP01", "test.wad")
}

/// A WAD with the map in a binary layout.
pub fn binary_wad(map: &RawMap) -> Vec<u8> {
    let hexen = map.specials == Specials::Action;
    let tag = |tags: &[i32]| tags.first().copied().unwrap_or(0);
    let [mut things, mut lines, mut sides, mut vertices, mut sectors] = [const { Vec::new() }; 5];
    for thing in &map.things {
        let words = if hexen { vec![0] } else { vec![] };
        put(&mut things, &words);
        put(&mut things, &[thing.at.x as i32, thing.at.y as i32]);
        put(&mut things, if hexen { &[0] } else { &[] });
        put(&mut things, &[thing.angle as i32, thing.kind, 0]);
        if hexen {
            things.extend([thing.special as u8, thing.args[0] as u8, 0, 0, 0, 0]);
        }
    }
    for line in &map.lines {
        let flag = |on: bool, bit: i32| if on { bit } else { 0 };
        let flags = flag(line.two_sided, 4) | flag(line.repeats, 0x200);
        put(&mut lines, &[line.v1 as i32, line.v2 as i32, flags]);
        if hexen {
            lines.push(line.special as u8);
            lines.extend(line.args.map(|a| a as u8));
        } else {
            put(&mut lines, &[line.special as i32, tag(&line.tags)]);
        }
        put(
            &mut lines,
            &[line.front, line.back].map(|s| s.map_or(-1, |s| s as i32)),
        );
    }
    for side in &map.sides {
        put(&mut sides, &[0, 0]);
        sides.extend(b"UPPER\0\0\0-\0\0\0\0\0\0\0WALL1\0xx");
        put(&mut sides, &[side.sector as i32]);
    }
    for vertex in &map.vertices {
        put(&mut vertices, &[vertex.x as i32, vertex.y as i32]);
    }
    for sector in &map.sectors {
        put(&mut sectors, &[sector.floor as i32, sector.ceiling as i32]);
        for flat in [&sector.floor_flat, &sector.ceiling_flat] {
            let mut name = [0; 8];
            name[..flat.len()].copy_from_slice(flat.as_bytes());
            sectors.extend(name);
        }
        put(
            &mut sectors,
            &[sector.light, sector.special, tag(&sector.tags)],
        );
    }
    let scripts: &[u8] = if map.scripts {
        b"ACS\0\x08\0\0\0\x01\0\0\0"
    } else {
        b"ACS\0\x08\0\0\0\0\0\0\0"
    };
    let mut lumps: Vec<(&str, &[u8])> = vec![
        ("MAP01", b""),
        ("THINGS", &things),
        ("LINEDEFS", &lines),
        ("SIDEDEFS", &sides),
        ("VERTEXES", &vertices),
        ("SECTORS", &sectors),
    ];
    if hexen {
        lumps.push(("BEHAVIOR", scripts));
    }
    wad_bytes(&lumps)
}

fn put(out: &mut Vec<u8>, words: &[i32]) {
    for &word in words {
        out.extend((word as u16).to_le_bytes());
    }
}

/// A WAD with the map as text.
pub fn text_wad(text: &str) -> Vec<u8> {
    wad_bytes(&[
        ("MAP01", b""),
        ("TEXTMAP", text.as_bytes()),
        ("ENDMAP", b""),
    ])
}

/// The text of a map.
pub fn text_of(map: &RawMap) -> String {
    let doom = map.specials == Specials::Doom;
    let mut text = format!("namespace = \"{}\";\n", if doom { "Doom" } else { "ZDoom" });
    for v in &map.vertices {
        text += &format!("vertex {{ x = {:?}; y = {:?}; }}\n", v.x, v.y);
    }
    for l in &map.lines {
        text += &format!(
            "linedef {{ v1 = {}; v2 = {}; special = {};\n",
            l.v1, l.v2, l.special
        );
        text += &format!(
            "  twosided = {}; repeatspecial = {};\n",
            l.two_sided, l.repeats
        );
        let tag = l.tags.first().copied().unwrap_or(-1);
        text += &format!("  id = {tag}; arg0 = {};\n", l.args[0]);
        let [front, back] = [l.front, l.back].map(|s| s.map_or(-1, i64::from));
        text += &format!("  sidefront = {front}; sideback = {back}; }}\n");
    }
    for s in &map.sides {
        text += &format!(
            "sidedef {{ sector = {}; texturetop = \"UPPER\";\n",
            s.sector
        );
        text += "  texturemiddle = \"WALL1\"; }\n";
    }
    for s in &map.sectors {
        text += &format!(
            "sector {{ heightfloor = {}; heightceiling = {};\n",
            s.floor, s.ceiling
        );
        text += &format!("  texturefloor = \"{}\";\n", s.floor_flat);
        text += &format!("  textureceiling = \"{}\";\n", s.ceiling_flat);
        let tag = s.tags.first().copied().unwrap_or(0);
        text += &format!(
            "  lightlevel = {}; special = {}; id = {tag}; }}\n",
            s.light, s.special
        );
    }
    for t in &map.things {
        text += &format!(
            "thing {{ x = {:?}; y = {:?}; angle = {};",
            t.at.x, t.at.y, t.angle
        );
        text += &format!(" type = {}; }}\n", t.kind);
    }
    text
}
