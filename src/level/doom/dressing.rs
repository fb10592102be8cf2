//! From the names on sidedefs and sectors to a [`Dress`].
//!
//! Source: "The Unofficial Doom Specs" 1.666, chapters 4-4 to 4-6, and the game's `r_sky.c` and
//! `g_game.c` for which sky a map is under. MAPINFO lumps are not read.

use std::collections::HashMap;

use super::raw::{RawLine, RawMap};
use super::surfaces::{Shift, SideSurface};
use crate::level::dress::{
    Cover, Dress, Hanging, Lie, LineDress, PictureId, PictureName, SideDress,
};

/// The flat that stands for the sky.
const SKY_FLAT: &str = "F_SKY1";

/// The pictures seen so far.
#[derive(Default)]
struct Pictures {
    names: Vec<PictureName>,
    ids: HashMap<PictureName, PictureId>,
}

impl Pictures {
    fn id(&mut self, name: PictureName) -> PictureId {
        let new = PictureId(self.names.len() as u32);
        *self.ids.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            new
        })
    }
}

/// The dress of a map of this name.
pub fn dress(raw: &RawMap, map: &str) -> Dress {
    let mut pictures = Pictures::default();
    let lines = raw.lines.iter().map(|l| line(raw, l, &mut pictures));
    let lines: Vec<LineDress> = lines.collect();
    let mut flat = |name: &String, lie: Lie| match super::binary::texture_name(name) {
        Some(name) if name == SKY_FLAT => Cover::Sky,
        Some(name) => Cover::Picture(pictures.id(PictureName::Flat(name)), lie),
        None => Cover::Bare,
    };
    let flats: Vec<[Cover; 2]> = raw
        .sectors
        .iter()
        .map(|s| {
            let [floor, ceiling] = s.lies;
            [flat(&s.floor_flat, floor), flat(&s.ceiling_flat, ceiling)]
        })
        .collect();
    let open = flats.iter().flatten().any(|&c| c == Cover::Sky);
    let sky = open.then(|| pictures.id(PictureName::Texture(sky_of(map).to_string())));
    Dress {
        pictures: pictures.names,
        lines,
        flats,
        sky,
    }
}

/// Lines whose vertices do not exist make no wall; theirs are points at zero.
fn line(raw: &RawMap, line: &RawLine, pictures: &mut Pictures) -> LineDress {
    let vertex = |n: u32| raw.vertices.get(n as usize).copied().unwrap_or_default();
    let mut side = |n: Option<u32>| {
        let side = raw.sides.get(n? as usize)?;
        Some(hang(&side.surface, pictures))
    };
    LineDress {
        from: vertex(line.v1),
        to: vertex(line.v2),
        // A linedef's front is its right side.
        sides: [side(line.back), side(line.front)],
        upper_unpegged: line.unpegged_top,
        lower_unpegged: line.unpegged_bottom,
    }
}

fn hang(surface: &SideSurface, pictures: &mut Pictures) -> SideDress {
    let mut part = |name: &Option<String>, shift: Shift| {
        Some(Hanging {
            picture: pictures.id(PictureName::Texture(name.clone()?)),
            offset: surface.offset + shift.offset,
            scale: shift.scale,
        })
    };
    SideDress {
        upper: part(&surface.upper, surface.upper_shift),
        middle: part(&surface.middle, surface.middle_shift),
        lower: part(&surface.lower, surface.lower_shift),
    }
}

/// Doom has a sky for each episode, Doom II one for the base, the city and hell.
fn sky_of(map: &str) -> &'static str {
    let number = |s: &str| s.parse::<u32>().unwrap_or(1);
    let map = map.to_ascii_uppercase();
    if let Some((episode, _)) = map.strip_prefix('E').and_then(|m| m.split_once('M')) {
        return ["SKY1", "SKY2", "SKY3", "SKY4"][(number(episode).clamp(1, 4) - 1) as usize];
    }
    match map.strip_prefix("MAP").map(number) {
        Some(12..=20) => "SKY2",
        Some(21..) => "SKY3",
        _ => "SKY1",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skies_by_episode_and_by_range() {
        for (map, sky) in [
            ("E1M1", "SKY1"),
            ("e2m9", "SKY2"),
            ("E4M1", "SKY4"),
            ("E9M1", "SKY4"),
            ("MAP01", "SKY1"),
            ("MAP11", "SKY1"),
            ("MAP12", "SKY2"),
            ("MAP20", "SKY2"),
            ("MAP21", "SKY3"),
            ("START", "SKY1"),
        ] {
            assert_eq!(sky_of(map), sky, "{map}");
        }
    }
}
