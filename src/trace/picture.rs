//! Pictures in linear light, and how they become bytes for a screen.
//!
//! Two steps: the exposure multiplies everything, then sRGB encodes it. Between them a shoulder keeps
//! lamps from burning holes: colours of which the brightest channel is above 0.7 are dimmed, hue
//! kept, so that this channel nears 1 but never reaches it.

use glam::DVec3;

use super::image::to_srgb;

/// A picture: rows from the top, linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Row after row.
    pub pixels: Vec<DVec3>,
}

/// How bright light comes out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// As the picture asks for: see [`Picture::usual_exposure`].
    #[default]
    Auto,
    /// 2 to this power times as bright as it is.
    Stops(f64),
}

/// Where the shoulder begins.
const SHOULDER: f64 = 0.7;

/// A colour as it is to be encoded: up to the shoulder as it is, then ever more slowly brighter.
pub fn tone(colour: DVec3) -> DVec3 {
    let most = colour.max_element();
    if most <= SHOULDER {
        return colour;
    }
    let room = 1.0 - SHOULDER;
    let dimmed = SHOULDER + room * (1.0 - (-(most - SHOULDER) / room).exp());
    colour * (dimmed / most)
}

/// How bright a colour looks (ITU-R BT.709).
pub fn luminance(colour: DVec3) -> f64 {
    colour.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

impl Picture {
    /// What light is multiplied by.
    pub fn factor(&self, exposure: Exposure) -> f64 {
        match exposure {
            Exposure::Auto => self.usual_exposure(),
            Exposure::Stops(stops) => stops.exp2(),
        }
    }

    /// The exposure that brings the (geometric) mean of the brightness to a middle grey of 0.2, but
    /// the brightest twentieth not beyond 1.3; at most 64 times brighter or darker. 1 for a picture
    /// that is black.
    pub fn usual_exposure(&self) -> f64 {
        let mut bright: Vec<f64> = self.pixels.iter().map(|&p| luminance(p)).collect();
        bright.retain(|l| l.is_finite() && *l > 0.0);
        if bright.is_empty() {
            return 1.0;
        }
        bright.sort_unstable_by(f64::total_cmp);
        let high = bright[(bright.len() - 1) * 19 / 20];
        // What is nearly black beside the rest counts as only so dark.
        let logs = bright.iter().map(|l| l.max(high / 256.0).ln());
        let mean = (logs.sum::<f64>() / bright.len() as f64).exp();
        (0.2 / mean).min(1.3 / high).clamp(1.0 / 64.0, 64.0)
    }

    /// sRGB bytes, three to a pixel.
    pub fn srgb(&self, exposure: Exposure) -> Vec<u8> {
        let factor = self.factor(exposure);
        let pixels = self.pixels.iter();
        pixels
            .flat_map(|&p| tone(p * factor).to_array().map(to_srgb))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shoulder_keeps_hue_and_order() {
        assert_eq!(tone(DVec3::splat(0.7)), DVec3::splat(0.7));
        let lamp = tone(DVec3::new(40.0, 20.0, 10.0));
        assert!(lamp.x > 0.99 && lamp.x <= 1.0);
        assert!((lamp.x / lamp.y - 2.0).abs() < 1e-12);
        let steps: Vec<f64> = (0..30)
            .map(|i| tone(DVec3::splat(f64::from(i) * 0.1)).x)
            .collect();
        assert!(steps.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn exposures() {
        let picture = |values: &[f64]| Picture {
            size: [values.len() as u32, 1],
            pixels: values.iter().map(|&v| DVec3::splat(v)).collect(),
        };
        // Everything equal: to middle grey.
        assert!((picture(&[0.4; 10]).usual_exposure() - 0.5).abs() < 1e-12);
        assert_eq!(picture(&[0.0; 3]).usual_exposure(), 1.0);
        assert_eq!(picture(&[0.25]).factor(Exposure::Stops(2.0)), 4.0);
        assert_eq!(
            picture(&[0.05]).srgb(Exposure::Stops(3.321928094887362)),
            [188; 3]
        );
    }
}
