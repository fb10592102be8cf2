//! How different two pictures are, and pictures as files within a page.
//!
//! Two measures, both of the pictures as they appear on a screen: the root of the mean squared error
//! (0 for the same, 1 for white instead of black), and the structural similarity as an eye judges it
//! (1 for the same), by the crate `image-compare`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::{ExtendedColorType, ImageEncoder, RgbImage};
use serde::Serialize;

use crate::trace::picture::{Exposure, Picture};

/// How far a picture is from another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Root of the mean squared error over all pixels and channels; 1 is white against black.
    pub rmse: f64,
    /// How alike they look, 0 to 1: structural similarity of the brightness, with colour.
    pub likeness: f64,
}

/// A picture as it appears on a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Screen(RgbImage);

impl Screen {
    /// The picture, exposed.
    pub fn of(picture: &Picture, exposure: Exposure) -> Self {
        let [width, height] = picture.size;
        let bytes = picture.srgb(exposure);
        Self(RgbImage::from_raw(width, height, bytes).unwrap_or_default())
    }

    /// How far it is from another of the same size.
    pub fn difference(&self, other: &Self) -> Difference {
        let pairs = self.0.as_raw().iter().zip(other.0.as_raw());
        let squares = pairs.map(|(a, b)| {
            let off = (f64::from(*a) - f64::from(*b)) / 255.0;
            off * off
        });
        let mean = squares.sum::<f64>() / self.0.as_raw().len().max(1) as f64;
        let same = self.0 == other.0;
        let compared = image_compare::rgb_hybrid_compare(&self.0, &other.0);
        Difference {
            rmse: mean.sqrt(),
            // Pictures smaller than the windows of the comparison have no structure.
            likeness: compared.map_or(f64::from(u8::from(same)), |c| c.score),
        }
    }

    /// Where the two differ: black where they are the same, brighter the more they differ, four times
    /// as much as they do.
    pub fn apart(&self, other: &Self) -> Self {
        let mut image = self.0.clone();
        for (pixel, theirs) in image.iter_mut().zip(other.0.as_raw()) {
            *pixel = pixel.abs_diff(*theirs).saturating_mul(4);
        }
        Self(image)
    }

    /// A `data:` address with the picture as PNG.
    pub fn address(&self) -> String {
        let mut png = Vec::new();
        let (width, height) = self.0.dimensions();
        let encoder = image::codecs::png::PngEncoder::new(&mut png);
        // Into memory there is nothing that can fail.
        _ = encoder.write_image(self.0.as_raw(), width, height, ExtendedColorType::Rgb8);
        format!("data:image/png;base64,{}", STANDARD.encode(&png))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn screen(of: impl Fn(u32, u32) -> f64) -> Screen {
        let places = (0..64 * 48).map(|i| (i % 64, i / 64));
        let picture = Picture {
            size: [64, 48],
            pixels: places.map(|(x, y)| DVec3::splat(of(x, y))).collect(),
        };
        Screen::of(&picture, Exposure::Stops(0.0))
    }

    #[test]
    fn the_same_is_the_same_and_black_is_not_grey() {
        let stripes = screen(|x, _| if x % 8 < 4 { 0.6 } else { 0.1 });
        let same = stripes.difference(&stripes);
        assert_eq!((same.rmse, same.likeness), (0.0, 1.0));
        // 0.5 in linear light is 188 of 255.
        let [black, grey] = [0.0, 0.5].map(|v| screen(|_, _| v));
        let off = black.difference(&grey);
        assert!((off.rmse - 188.0 / 255.0).abs() < 1e-12);
        assert!(off.likeness < 0.5, "{off:?}");
    }

    #[test]
    fn a_shift_looks_less_alike_than_a_shade() {
        let stripes = |dx: u32, dim: f64| {
            screen(move |x, y| {
                dim * if (x + dx) % 8 < 4 && y % 16 < 12 {
                    0.6
                } else {
                    0.1
                }
            })
        };
        let shade = stripes(0, 1.0).difference(&stripes(0, 0.9));
        let shift = stripes(0, 1.0).difference(&stripes(2, 1.0));
        assert!(shade.likeness > shift.likeness, "{shade:?} {shift:?}");
        assert!(shade.rmse < shift.rmse);
    }

    #[test]
    fn pictures_are_whole_files() {
        let address = screen(|x, _| f64::from(x) / 64.0).address();
        let png = STANDARD
            .decode(address.strip_prefix("data:image/png;base64,").unwrap())
            .unwrap();
        let image = image::load_from_memory(&png).unwrap().to_rgb8();
        assert_eq!(image.dimensions(), (64, 48));
        assert!(image.get_pixel(60, 3).0[0] > image.get_pixel(10, 3).0[0]);
    }
}
