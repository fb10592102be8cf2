//! The pictures of a level, one after the other in one texture.
//!
//! In: [`Coats`]. Out: [`Texels`]: all texels in a row, and where each picture begins. After a picture come
//! its smaller copies, each half as wide and high, for where it is seen from afar. One texture for all
//! means one draw call for all polygons between two panes of glass, and no limit on a picture's form.

use crate::preview::Coats;
use crate::preview::coat::{Packed, Texture};
use crate::trace::world::World;
use glam::DVec3;

/// Shades of a sky without a picture.
const SHADES: u32 = 256;

/// Texels in a row.
pub struct Texels {
    /// One after the other; rows of the texture.
    pub list: Vec<Packed>,
    /// By picture: where it begins, its columns and rows.
    places: Vec<[u32; 3]>,
    /// Of the sky: where it begins, columns, rows; whether it is a picture.
    pub sky: [u32; 4],
}

impl Texels {
    /// Those of a level, at most so many: if they are more, all pictures are halved until they fit.
    pub fn new(world: &World, coats: &Coats, most: usize) -> Self {
        let mut halved = 0;
        loop {
            let texels = Self::halved(world, coats, halved);
            // Each time a quarter is left; single texels are not halved any more.
            if texels.list.len() <= most || halved == 16 {
                return texels;
            }
            halved += 1;
        }
    }

    fn halved(world: &World, coats: &Coats, halved: u32) -> Self {
        let mut list = Vec::new();
        let mut add = |texture: &Texture| {
            let mut copy = Copy {
                size: [texture.width, texture.height],
                texels: texture.texels.clone(),
            };
            for _ in 0..if texture.texels.is_empty() { 0 } else { halved } {
                copy = copy.half();
            }
            let place = [list.len() as u32, copy.size[0], copy.size[1]];
            // A picture that is missing is worn nowhere.
            if copy.texels.is_empty() {
                return place;
            }
            loop {
                list.extend_from_slice(&copy.texels);
                if copy.size.iter().all(|n| *n <= 1) {
                    return place;
                }
                copy = copy.half();
            }
        };
        let places = coats.textures.iter().map(&mut add).collect();
        let sky = match &coats.sky {
            Some(picture) => {
                let first = list.len() as u32;
                list.extend_from_slice(&picture.texels);
                [first, picture.width, picture.height, 1]
            }
            None => {
                let first = list.len() as u32;
                list.extend((0..SHADES).map(|k| {
                    // Its colour goes with the root of the upward part.
                    let up = (f64::from(k) / f64::from(SHADES - 1)).powi(2);
                    coats.sky(world, DVec3::new((1.0 - up * up).sqrt(), 0.0, up))
                }));
                [first, SHADES, 1, 0]
            }
        };
        Self { list, places, sky }
    }

    /// Where a picture begins, its columns and rows.
    pub fn of(&self, texture: u32) -> [u32; 3] {
        self.places[texture as usize]
    }
}

/// A picture, or a smaller copy of it.
struct Copy {
    size: [u32; 2],
    texels: Vec<Packed>,
}

impl Copy {
    /// Half as wide and high, at least one texel: each of four, or in a last odd column or row of fewer,
    /// the mean of what is no hole; a hole where more than half is.
    fn half(&self) -> Self {
        let [width, height] = self.size;
        let size = self.size.map(|n| (n / 2).max(1));
        let mut texels = Vec::with_capacity((size[0] * size[1]) as usize);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let mut sum = [0u32; 4];
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let (x, y) = ((2 * x + dx).min(width - 1), (2 * y + dy).min(height - 1));
                    let texel = self.texels[(y * width + x) as usize].to_le_bytes();
                    let solid = u32::from(texel[3] != 0);
                    for k in 0..3 {
                        sum[k] += u32::from(texel[k]) * solid;
                    }
                    sum[3] += solid;
                }
                let n = sum[3].max(1);
                let [r, g, b] = [0, 1, 2].map(|k| ((sum[k] + n / 2) / n) as u8);
                let opacity = if sum[3] >= 2 { 0xff } else { 0 };
                texels.push(Packed::from_le_bytes([r, g, b, opacity]));
            }
        }
        Self { size, texels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_means_of_what_is_no_hole() {
        let solid = |n: u32| n | 0xff00_0000;
        let copy = Copy {
            size: [3, 2],
            texels: vec![solid(10), solid(20), solid(9), solid(30), 0, 0],
        };
        let half = copy.half();
        assert_eq!(half.size, [1, 1]);
        assert_eq!(half.texels, [solid(20)]);
        assert_eq!(half.half().size, [1, 1]);
        let holes = Copy {
            size: [2, 2],
            texels: vec![0, 0, 0, solid(8)],
        };
        assert_eq!(holes.half().texels[0] >> 24, 0);
    }
}
