//! What traced pictures have cost from this place, by what was asked of them.
//!
//! In: each picture that was finished, with its [`Knobs`]. Out: for one knob the costs at all its
//! settings that were tried, all others as they are now. They hold for one camera.

use crate::trace::camera::Camera;
use crate::trace::effects::Effects;

/// What a picture was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knobs {
    /// Samples in a pixel.
    pub samples: u32,
    /// More where neighbours differ.
    pub adaptive: bool,
    /// Reflections in a row.
    pub depth: u32,
    /// Smallest share of light that is followed.
    pub threshold: f64,
    /// Rays to lights and into cones.
    pub rays: u32,
    /// Effects left out.
    pub without: Effects,
}

/// What has been measured.
#[derive(Clone, Debug, Default)]
pub struct Costs {
    camera: Option<Camera>,
    tried: Vec<(Knobs, f64)>,
}

impl Costs {
    /// A picture is finished; it took so many milliseconds.
    pub fn note(&mut self, camera: Camera, knobs: Knobs, milliseconds: f64) {
        if self.camera != Some(camera) {
            self.tried.clear();
            self.camera = Some(camera);
        }
        self.tried.retain(|(k, _)| *k != knobs);
        self.tried.push((knobs, milliseconds));
    }

    /// All that is known of pictures that differ from `now` in nothing but what `turn` sets to that of
    /// another.
    pub fn along(&self, now: &Knobs, turn: fn(&mut Knobs, &Knobs)) -> Vec<(Knobs, f64)> {
        let like = |other: &Knobs| {
            let mut turned = *now;
            turn(&mut turned, other);
            turned == *other
        };
        let tried = self.tried.iter();
        tried.filter(|(other, _)| like(other)).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn costs_are_those_of_one_knob_and_one_place() {
        let camera = |x: f64| Camera::new(DVec3::X * x, DVec3::Y, 90.0, [20, 10]);
        let knobs = |samples, depth| Knobs {
            samples,
            adaptive: false,
            depth,
            threshold: 0.0,
            rays: 16,
            without: Effects::NONE,
        };
        let mut costs = Costs::default();
        costs.note(camera(1.0), knobs(1, 5), 10.0);
        costs.note(camera(1.0), knobs(4, 5), 41.0);
        costs.note(camera(1.0), knobs(4, 5), 40.0);
        costs.note(camera(1.0), knobs(4, 1), 30.0);
        let samples = |costs: &Costs| costs.along(&knobs(9, 5), |k, o| k.samples = o.samples);
        assert_eq!(samples(&costs), [(knobs(1, 5), 10.0), (knobs(4, 5), 40.0)]);
        let depths = costs.along(&knobs(4, 9), |k, o| k.depth = o.depth);
        assert_eq!(depths, [(knobs(4, 5), 40.0), (knobs(4, 1), 30.0)]);
        costs.note(camera(2.0), knobs(1, 1), 5.0);
        assert!(samples(&costs).is_empty());
    }
}
