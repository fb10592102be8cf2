//! From SVG text to PNG bytes, with a font that is part of the program.

use resvg::{tiny_skia, usvg};
use thiserror::Error;

/// The font of all texts in pictures; see [`png()`].
pub const FONT: &str = "Ubuntu Light, Ubuntu, sans-serif";

/// Why an SVG gives no PNG.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The SVG cannot be read.
    #[error("the picture is no valid SVG: {0}")]
    Svg(#[from] usvg::Error),
    /// There is not enough memory, or the picture has no area.
    #[error("a picture of {width} × {height} pixels is too large; ask for a smaller --width")]
    Size {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
    },
    /// The PNG cannot be packed.
    #[error("the PNG cannot be packed: {0}")]
    Pack(String),
}

/// Draws an SVG, `width` pixels across and as high as its shape asks for, on white. Texts are set
/// in Ubuntu Light, whatever fonts the computer has.
pub fn png(svg: &str, width: u32) -> Result<Vec<u8>, PictureError> {
    let mut options = usvg::Options {
        font_family: "Ubuntu".into(),
        ..usvg::Options::default()
    };
    options
        .fontdb_mut()
        .load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let tree = usvg::Tree::from_str(svg, &options)?;
    let scale = width as f32 / tree.size().width();
    let height = (tree.size().height() * scale).ceil() as u32;
    let mut pixels =
        tiny_skia::Pixmap::new(width, height).ok_or(PictureError::Size { width, height })?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(
        &tree,
        tiny_skia::Transform::from_scale(scale, scale),
        &mut pixels.as_mut(),
    );
    pixels
        .encode_png()
        .map_err(|e| PictureError::Pack(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dark_pixels(svg: &str) -> usize {
        let bytes = png(svg, 200).unwrap();
        let pixels = tiny_skia::Pixmap::decode_png(&bytes).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (200, 80));
        pixels.pixels().iter().filter(|p| p.red() < 100).count()
    }

    #[test]
    fn texts_have_a_font() {
        let svg = |text| {
            format!(
                "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 100 40' width='100' \
                 height='40'><text x='5' y='30' font-size='30' font-family='{FONT}'>{text}</text>\
                 </svg>"
            )
        };
        assert!(dark_pixels(&svg("Hall")) > 100);
        assert_eq!(dark_pixels(&svg("")), 0);
    }

    #[test]
    fn nonsense_is_an_error() {
        assert!(png("<svg", 100).is_err());
    }
}
