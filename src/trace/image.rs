//! Pictures in linear light: textures to look up, and the way from linear light to sRGB and back.

use glam::{DVec2, DVec3};

/// A picture: rows from the top, linear red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

impl Image {
    /// From sRGB bytes, three to a pixel, rows from the top. `None` if there are not as many as the
    /// size says, or none.
    pub fn from_srgb(width: u32, height: u32, bytes: &[u8]) -> Option<Self> {
        let n = width as usize * height as usize;
        if n == 0 || bytes.len() != 3 * n {
            return None;
        }
        let linear: Vec<f32> = (0..=255u8).map(|b| to_linear(b) as f32).collect();
        let pixels = bytes.chunks_exact(3);
        let pixels = pixels.map(|p| [0, 1, 2].map(|k| linear[usize::from(p[k])]));
        Some(Self {
            width,
            height,
            pixels: pixels.collect(),
        })
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The pixels, row after row.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = DVec3> + '_ {
        self.pixels
            .iter()
            .map(|p| DVec3::from_array(p.map(f64::from)))
    }

    /// Height by width.
    pub fn aspect(&self) -> f64 {
        f64::from(self.height) / f64::from(self.width)
    }

    /// The colour at a place, mixed from the four pixels around it: x from 0 to 1 across, y from 0
    /// at the bottom to 1 at the top; beyond, the picture is repeated.
    pub fn at(&self, place: DVec2) -> DVec3 {
        let x = place.x * f64::from(self.width) - 0.5;
        let y = (1.0 - place.y) * f64::from(self.height) - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let column = |dx: f64| (left + dx).rem_euclid(f64::from(self.width)) as usize;
        let row = |dy: f64| (top + dy).rem_euclid(f64::from(self.height)) as usize;
        let pixel = |dx: f64, dy: f64| {
            let (x, y) = (column(dx), row(dy));
            let at = y.min(self.height as usize - 1) * self.width as usize
                + x.min(self.width as usize - 1);
            DVec3::from_array(self.pixels[at].map(f64::from))
        };
        let upper = pixel(0.0, 0.0) * (1.0 - fx) + pixel(1.0, 0.0) * fx;
        let lower = pixel(0.0, 1.0) * (1.0 - fx) + pixel(1.0, 1.0) * fx;
        upper * (1.0 - fy) + lower * fy
    }
}

/// From an sRGB byte to linear light, 0 to 1 (IEC 61966-2-1).
pub fn to_linear(byte: u8) -> f64 {
    decode(f64::from(byte) / 255.0)
}

/// From an sRGB value, 0 to 1, to linear light.
pub fn decode(x: f64) -> f64 {
    if x <= 0.04045 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

/// From linear light to an sRGB byte; what is below 0 or above 1 becomes 0 or 255.
pub fn to_srgb(x: f64) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 {
        x * 12.92
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        for byte in 0..=255 {
            assert_eq!(to_srgb(to_linear(byte)), byte);
        }
        assert_eq!(to_srgb(-1.0), 0);
        assert_eq!(to_srgb(7.0), 255);
        // Middle grey of light is 188 on the screen.
        assert_eq!(to_srgb(0.5), 188);
    }

    #[test]
    fn between_pixels_and_beyond() {
        // Black on the left, white on the right, one row.
        let image = Image::from_srgb(2, 1, &[0, 0, 0, 255, 255, 255]).unwrap();
        let at = |x: f64| image.at(DVec2::new(x, 0.5)).x;
        assert_eq!([at(0.25), at(0.5), at(0.75)], [0.0, 0.5, 1.0]);
        assert_eq!(at(1.25), 0.0);
        assert_eq!(at(-0.25), 1.0);
        assert_eq!(at(1.0), 0.5, "between the last and the next first");
        assert!(Image::from_srgb(2, 1, &[0; 5]).is_none());
    }
}
