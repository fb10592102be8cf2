//! How pictures are traced: arguments of `render` and `walk`.

use clap::Args;

use crate::cli::render::AMBIENT;
use crate::trace::effects::{Effects, Survey};
use crate::trace::picture::Exposure;
use crate::trace::render::{Adaptive, RenderOptions};
use crate::trace::shade::Limits;
use crate::trace::world::World;

/// How many rays, and what they simulate.
#[derive(Clone, Debug, Args)]
pub struct TraceArgs {
    /// Samples in each pixel; 1: through its middle
    #[arg(long, value_name = "N", default_value_t = 4)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub samples: u32,
    /// So many samples in pixels that differ from their neighbours
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65_536))]
    pub adaptive: Option<u32>,
    /// With --adaptive: the difference, from 0 to 1 (black to white)
    #[arg(long, value_name = "D", default_value_t = 0.05, value_parser = positive)]
    contrast: f64,
    /// Most reflections and refractions in a row
    #[arg(long, value_name = "N", default_value_t = 5)]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=1000))]
    depth: u32,
    /// Rays whose share of the pixel is smaller are not cast
    #[arg(long, value_name = "SHARE", default_value_t = 1.0 / 256.0, value_parser = not_negative)]
    threshold: f64,
    /// Shadow rays to each light with an extent, per pixel
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    light_samples: u32,
    /// Rays into the cone of a rough surface, per pixel
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=65_536))]
    scatter_samples: u32,
    /// What is simulated: auto (what can matter), all, none, or some of shadows, soft, mirror, glossy,
    /// refraction, translucency, textures, with commas between them
    #[arg(long, value_name = "LIST", default_value = "auto", value_parser = effects)]
    pub effects: Asked,
    /// Stops by which light is brightened (or darkened, below 0) [default: as the picture asks for;
    /// 1.5 for Doom maps]
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true, value_parser = finite)]
    exposure: Option<f64>,
    /// Light that is everywhere, where the level does not say how bright its places are
    #[arg(long, value_name = "IA", default_value_t = AMBIENT, value_parser = not_negative)]
    pub ambient: f64,
    /// Seed of all that is random
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// What `--effects` asks for.
#[derive(Clone, Copy, Debug)]
pub enum Asked {
    /// What can matter.
    Auto,
    /// These.
    Set(Effects),
}

impl TraceArgs {
    /// As asked for. A Doom map says itself how bright its places are; its textures are dark, though,
    /// and the game brightens what is near.
    pub fn exposure(&self, world: &World) -> Exposure {
        const DOOM: Exposure = Exposure::Stops(1.5);
        let usual = if world.wardrobe.is_some() {
            DOOM
        } else {
            Exposure::Auto
        };
        self.exposure.map_or(usual, Exposure::Stops)
    }

    /// For a picture that calls for these effects.
    pub fn options(&self, survey: &Survey, exposure: Exposure) -> RenderOptions {
        RenderOptions {
            effects: match self.effects {
                Asked::Auto => survey.needed,
                Asked::Set(effects) => effects,
            },
            ..self.fixed(exposure)
        }
    }

    /// What does not depend on the picture; all effects.
    pub fn fixed(&self, exposure: Exposure) -> RenderOptions {
        RenderOptions {
            samples: self.samples,
            adaptive: self.adaptive.map(|samples| Adaptive {
                samples,
                contrast: self.contrast,
                exposure,
            }),
            limits: Limits {
                depth: self.depth,
                threshold: self.threshold,
                light_samples: self.light_samples,
                scatter_samples: self.scatter_samples,
            },
            seed: self.seed,
            effects: Effects::ALL,
        }
    }
}

fn effects(text: &str) -> Result<Asked, String> {
    Ok(match text {
        "auto" => Asked::Auto,
        "all" => Asked::Set(Effects::ALL),
        "none" => Asked::Set(Effects::NONE),
        list => Asked::Set(list.parse()?),
    })
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|x: &f64| x.is_finite());
    number.ok_or_else(|| "a number is needed".to_string())
}

/// A number from 0 on.
pub fn not_negative(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|&x| x >= 0.0)
        .ok_or_else(|| "a number from 0 on is needed".to_string())
}

/// A number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|&x| x > 0.0)
        .ok_or_else(|| "a number above 0 is needed".to_string())
}
