//! Pictures in a WAD: wall textures put together from patches, and the flats of floors and ceilings.
//!
//! In: the lumps PLAYPAL, PNAMES, TEXTURE1, TEXTURE2, the patches, and the flats between F_START and
//! F_END. Out: a [`Picture`] for a name, made when it is asked for. What is damaged is left out: a
//! patch that is missing or cut short leaves its place clear, as the game does or would like to.
//! Source: "The Unofficial Doom Specs" 1.666 (Matthew S. Fell), chapters 5 to 8.

use std::collections::HashMap;

use crate::level::dress::{Dress, PictureName};
use crate::level::wad::Wad;

/// A picture: rows from the top, red, green, blue and opacity (0 or 255), sRGB.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width · height` pixels, row after row.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    fn clear(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            pixels: vec![[0; 4]; width as usize * height as usize],
        }
    }
}

/// The pictures that a dress names, in its order; `None` for one that the WAD does not have, and for
/// all of them if it has no palette.
pub fn pictures(wad: &Wad, dress: &Dress) -> Vec<Option<Picture>> {
    let graphics = Graphics::new(wad);
    let picture = |name| graphics.as_ref()?.picture(name);
    dress.pictures.iter().map(picture).collect()
}

/// What a WAD has to say about pictures.
#[derive(Clone, Debug)]
pub struct Graphics<'a> {
    wad: &'a Wad,
    palette: [[u8; 3]; 256],
    textures: HashMap<String, Texture>,
    /// Lump numbers.
    flats: HashMap<String, usize>,
}

/// How a wall texture is put together.
#[derive(Clone, Debug)]
struct Texture {
    size: [u16; 2],
    patches: Vec<Patch>,
}

/// A patch in a texture: its upper left corner, and its lump's name.
#[derive(Clone, Debug)]
struct Patch {
    at: [i16; 2],
    name: String,
}

/// Side of a flat, in pixels.
const FLAT: u32 = 64;
/// No texture of any game is larger; a larger one is damage.
const LARGEST: u16 = 4096;

impl<'a> Graphics<'a> {
    /// Looks through the WAD; `None` if it has no palette (as maps that rely on a game's own WAD).
    pub fn new(wad: &'a Wad) -> Option<Self> {
        let lump = wad.lump_named("PLAYPAL")?.first_chunk::<768>()?;
        let palette = std::array::from_fn(|i| [lump[i * 3], lump[i * 3 + 1], lump[i * 3 + 2]]);
        let names = patch_names(wad.lump_named("PNAMES").unwrap_or_default());
        let mut textures = HashMap::new();
        for lump in ["TEXTURE1", "TEXTURE2"] {
            for (name, texture) in textures_of(wad.lump_named(lump).unwrap_or_default(), &names) {
                // As in the game, the first of a name counts.
                textures.entry(name).or_insert(texture);
            }
        }
        Some(Self {
            wad,
            palette,
            textures,
            flats: flats(wad),
        })
    }

    /// The picture of this name. Later games let flats hang on walls and textures lie on floors, so
    /// what is not there as the one is looked for as the other.
    pub fn picture(&self, name: &PictureName) -> Option<Picture> {
        match name {
            PictureName::Texture(name) => self.texture(name).or_else(|| self.flat(name)),
            PictureName::Flat(name) => self.flat(name).or_else(|| self.texture(name)),
        }
    }

    /// The wall texture of this name (in capitals).
    pub fn texture(&self, name: &str) -> Option<Picture> {
        let texture = self.textures.get(name)?;
        let [width, height] = texture.size.map(u32::from);
        let mut picture = Picture::clear(width, height);
        for patch in &texture.patches {
            if let Some(lump) = self.wad.lump_named(&patch.name) {
                self.draw(&mut picture, lump, patch.at);
            }
        }
        Some(picture)
    }

    /// The flat of this name (in capitals): 64 by 64, its first row in the north.
    pub fn flat(&self, name: &str) -> Option<Picture> {
        let lump = self.wad.lump(*self.flats.get(name)?);
        let pixels = lump.get(..(FLAT * FLAT) as usize)?;
        Some(Picture {
            width: FLAT,
            height: FLAT,
            pixels: pixels.iter().map(|&i| self.colour(i)).collect(),
        })
    }

    fn colour(&self, index: u8) -> [u8; 4] {
        let [r, g, b] = self.palette[usize::from(index)];
        [r, g, b, 255]
    }

    /// Draws a patch: columns of posts, each with the row it starts in, its length, and its pixels
    /// between two bytes that mean nothing.
    fn draw(&self, picture: &mut Picture, lump: &[u8], at: [i16; 2]) {
        let word = |i: usize| Some(u16::from_le_bytes(*lump.get(i..)?.first_chunk()?));
        let long = |i: usize| Some(u32::from_le_bytes(*lump.get(i..)?.first_chunk()?));
        let Some(width) = word(0) else { return };
        for column in 0..i32::from(width) {
            let x = i32::from(at[0]) + column;
            if x < 0 || x >= picture.width as i32 {
                continue;
            }
            let Some(start) = long(8 + 4 * column as usize) else {
                return;
            };
            let mut post = start as usize;
            // A tall patch goes on where a row does not rise: then it counts from the one before.
            let mut row = -1;
            while let Some(&[top, length]) = lump.get(post..).and_then(|l| l.first_chunk()) {
                if top == 255 {
                    break;
                }
                let top = i32::from(top);
                row = if top <= row { row + top } else { top };
                let from = post + 3;
                let Some(pixels) = lump.get(from..from + usize::from(length)) else {
                    break;
                };
                for (y, &index) in (i32::from(at[1]) + row..).zip(pixels) {
                    if (0..picture.height as i32).contains(&y) {
                        let place = y as usize * picture.width as usize + x as usize;
                        picture.pixels[place] = self.colour(index);
                    }
                }
                post = from + usize::from(length) + 1;
            }
        }
    }
}

/// A name of at most eight bytes, in capitals.
fn name(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&b| b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).to_uppercase()
}

fn patch_names(lump: &[u8]) -> Vec<String> {
    let entries = lump.get(4..).unwrap_or_default();
    entries.chunks_exact(8).map(name).collect()
}

/// The textures of a lump, in its order; those that lie outside of it are left out.
fn textures_of(lump: &[u8], names: &[String]) -> Vec<(String, Texture)> {
    let long = |i: usize| Some(u32::from_le_bytes(*lump.get(i..)?.first_chunk()?));
    let n = long(0).unwrap_or(0).min(lump.len() as u32 / 4);
    let texture = |i: u32| {
        let at = long(4 + 4 * i as usize)? as usize;
        let head: &[u8; 22] = lump.get(at..)?.first_chunk()?;
        let word = |i: usize| u16::from_le_bytes([head[i], head[i + 1]]);
        let size = [word(12), word(14)];
        if size.iter().any(|&n| n == 0 || n > LARGEST) {
            return None;
        }
        let list = lump.get(at + 22..)?;
        let patches = list
            .chunks_exact(10)
            .take(usize::from(word(20)))
            .filter_map(|p| {
                let short = |i: usize| i16::from_le_bytes([p[i], p[i + 1]]);
                let number = u16::from_le_bytes([p[4], p[5]]);
                Some(Patch {
                    at: [short(0), short(2)],
                    name: names.get(usize::from(number))?.clone(),
                })
            })
            .collect();
        Some((name(&head[..8]), Texture { size, patches }))
    };
    (0..n).filter_map(texture).collect()
}

/// The lumps between the markers; of several of one name the last counts.
fn flats(wad: &Wad) -> HashMap<String, usize> {
    let mut inside = false;
    let mut flats = HashMap::new();
    for (i, lump) in wad.lumps().iter().enumerate() {
        match lump.name.as_str() {
            "F_START" | "FF_START" => inside = true,
            "F_END" | "FF_END" => inside = false,
            _ if inside && !wad.lump(i).is_empty() => {
                flats.insert(lump.name.clone(), i);
            }
            _ => {}
        }
    }
    flats
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::level::wad::tests::wad_bytes;

    /// A palette in which colour i is (i, 255 - i, 7).
    fn palette() -> Vec<u8> {
        (0..=255u8).flat_map(|i| [i, 255 - i, 7]).collect()
    }

    /// Two columns: one of three pixels from row 1 on, one with a pixel in row 0 and one in row 3.
    fn patch() -> Vec<u8> {
        let mut lump = Vec::new();
        for n in [2u16, 4, 0, 0] {
            lump.extend(n.to_le_bytes());
        }
        lump.extend(16u32.to_le_bytes());
        lump.extend(24u32.to_le_bytes());
        lump.extend([1, 3, 0, 10, 11, 12, 0, 255]);
        lump.extend([0, 1, 0, 20, 0, 3, 1, 0, 21, 0, 255]);
        lump
    }

    fn texture_lump() -> Vec<u8> {
        let mut lump = Vec::new();
        lump.extend(1u32.to_le_bytes());
        lump.extend(8u32.to_le_bytes());
        lump.extend(b"BRICK\0\0\0");
        lump.extend(0u32.to_le_bytes());
        for n in [3u16, 4, 0, 0, 2] {
            lump.extend(n.to_le_bytes());
        }
        // Patch 0 at (1, 0), and one that does not exist.
        for n in [1i16, 0, 0, 0, 0, 0, 0, 9, 0, 0] {
            lump.extend(n.to_le_bytes());
        }
        lump
    }

    fn wad() -> Wad {
        let flat: Vec<u8> = (0..4096u32).map(|i| (i % 64) as u8).collect();
        let mut names = 1u32.to_le_bytes().to_vec();
        names.extend(b"wall\0\0\0\0");
        Wad::parse(wad_bytes(&[
            ("PLAYPAL", &palette()),
            ("PNAMES", &names),
            ("TEXTURE1", &texture_lump()),
            ("WALL", &patch()),
            ("F_START", b""),
            ("FLOOR", &flat),
            ("SHORT", b"123"),
            ("F_END", b""),
        ]))
        .unwrap()
    }

    #[test]
    fn a_texture_by_hand() {
        let wad = wad();
        let picture = Graphics::new(&wad).unwrap().texture("BRICK").unwrap();
        assert_eq!((picture.width, picture.height), (3, 4));
        let clear = [0; 4];
        let c = |i: u8| [i, 255 - i, 7, 255];
        #[rustfmt::skip]
        assert_eq!(picture.pixels, [
            clear, clear, c(20),
            clear, c(10), clear,
            clear, c(11), clear,
            clear, c(12), c(21),
        ]);
    }

    #[test]
    fn flats_lie_between_their_markers() {
        let wad = wad();
        let graphics = Graphics::new(&wad).unwrap();
        let flat = graphics.flat("FLOOR").unwrap();
        assert_eq!(flat.pixels[65], [1, 254, 7, 255]);
        assert_eq!(graphics.flat("SHORT"), None);
        assert_eq!(graphics.flat("WALL"), None);
    }

    #[test]
    fn cut_off_lumps_leave_pixels_clear() {
        for n in 0..patch().len() {
            let cut = &patch()[..n];
            let wad = Wad::parse(wad_bytes(&[
                ("PLAYPAL", &palette()),
                ("PNAMES", b"\x01\0\0\0WALL\0\0\0\0"),
                ("TEXTURE1", &texture_lump()[..texture_lump().len() - n % 12]),
                ("WALL", cut),
            ]))
            .unwrap();
            let graphics = Graphics::new(&wad).unwrap();
            let picture = graphics.texture("BRICK");
            assert!(picture.is_none_or(|p| p.pixels.len() == 12));
        }
        let bare = Wad::parse(wad_bytes(&[("E1M1", b"")])).unwrap();
        assert!(Graphics::new(&bare).is_none());
    }

    /// Needs the Debian package `freedoom`; does nothing without it.
    #[test]
    fn every_texture_of_freedoom() {
        for file in ["freedoom1.wad", "freedoom2.wad"] {
            let Ok(bytes) = std::fs::read(format!("/usr/share/games/doom/{file}")) else {
                return;
            };
            let wad = Wad::parse(bytes).unwrap();
            let graphics = Graphics::new(&wad).unwrap();
            assert!(graphics.textures.len() > 200 && graphics.flats.len() > 100);
            let mut solid = 0;
            for name in graphics.textures.keys() {
                let picture = graphics.texture(name).unwrap();
                solid += usize::from(picture.pixels.iter().all(|p| p[3] == 255));
            }
            // All but gratings, fences, banners and the like.
            assert!(solid * 10 > graphics.textures.len() * 7, "{solid}");
            for name in graphics.flats.keys() {
                assert!(graphics.flat(name).is_some(), "{name}");
            }
        }
    }
}
