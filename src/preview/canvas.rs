//! What is painted on.

use super::coat::Packed;

/// Stands for the surface of a pixel on which nothing was painted.
pub const NOTHING: u32 = u32::MAX;

/// A picture: rows from the top.
#[derive(Clone, Debug, Default)]
pub struct Canvas {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Colours; zero where nothing was painted.
    pub pixels: Vec<Packed>,
    /// What was painted last on each pixel: the number of a polygon, from their number on that of an object,
    /// or [`NOTHING`]. Empty if it was not asked for.
    pub surfaces: Vec<u32>,
}

impl Canvas {
    /// Makes it empty.
    pub fn clear(&mut self, size: [u32; 2], surfaces: bool) {
        let n = size[0] as usize * size[1] as usize;
        self.size = size;
        self.pixels.clear();
        self.pixels.resize(n, 0);
        self.surfaces.clear();
        if surfaces {
            self.surfaces.resize(n, NOTHING);
        }
    }

    /// Cut into pieces of so many pixels.
    pub(super) fn bands(&mut self, n: usize) -> Vec<(&mut [Packed], &mut [u32])> {
        let mut surfaces = self.surfaces.chunks_mut(n);
        let bands = self.pixels.chunks_mut(n);
        bands
            .map(|band| (band, surfaces.next().unwrap_or_default()))
            .collect()
    }

    /// sRGB bytes, three to a pixel.
    pub fn srgb(&self) -> Vec<u8> {
        let bytes = self.pixels.iter().map(|p| p.to_le_bytes());
        bytes.flat_map(|[r, g, b, _]| [r, g, b]).collect()
    }
}
