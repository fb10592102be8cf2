//! What a picture's accuracy costs in time: effects, samples, and structures on one level from one eye.
//!
//! In: a [`Shot`] and a [`Bench`] to run it on. Out: figures ([`effects`], [`antialiasing`],
//! [`structures`]), each with a page for people. With the same seed all but the times is the same on
//! every run.

pub mod antialiasing;
pub mod difference;
pub mod effects;
mod frame;
pub mod structures;

use serde::Serialize;

use super::visibility::{Bench, Spread};
use crate::cells::CellId;
use crate::pvs::Progress;
use crate::trace::camera::Camera;
use crate::trace::effects::Survey;
use crate::trace::picture::Exposure;
use crate::trace::render::{RenderOptions, Rendered, render};
use crate::trace::shade::Rays;
use crate::trace::world::World;
use crate::trace::{Tracer, effects::Effects};

/// What is drawn, and from where.
#[derive(Clone, Debug)]
pub struct Shot<'a> {
    /// The level.
    pub world: &'a World,
    /// The eye.
    pub camera: Camera,
    /// The cell in which it is.
    pub start: CellId,
    /// What a picture from there calls for.
    pub survey: &'a Survey,
    /// How it is drawn when nothing is left out.
    pub options: RenderOptions,
    /// What stands in the figures.
    pub about: About,
}

/// What was studied, on what.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct About {
    /// The level's name.
    pub level: String,
    /// Its file.
    pub source: String,
    /// The eye, in words.
    pub view: String,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Version of enfilade.
    pub enfilade: &'static str,
    /// The machine, in words.
    pub machine: String,
    /// Threads that drew.
    pub threads: usize,
    /// Seed of all that is random.
    pub seed: u64,
    /// Seconds that the study was given.
    pub budget: f64,
}

/// Rays that a picture took, by kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// To lights.
    pub shadow: u64,
    /// Reflected.
    pub reflected: u64,
    /// Passing through.
    pub refracted: u64,
}

impl RayCounts {
    /// All of them.
    pub fn all(&self) -> u64 {
        self.primary + self.shadow + self.reflected + self.refracted
    }
}

impl From<Rays> for RayCounts {
    fn from(rays: Rays) -> Self {
        Self {
            primary: rays.primary,
            shadow: rays.shadow,
            reflected: rays.reflected,
            refracted: rays.refracted,
        }
    }
}

/// One way to draw the shot, drawn as often as there is time.
struct Take {
    label: String,
    options: RenderOptions,
    times: Vec<f64>,
    drawn: Option<Rendered>,
}

/// Runs of one way to draw; more where they take next to no time.
const ENOUGH: usize = 5;

impl Take {
    fn new(label: impl Into<String>, options: RenderOptions) -> Self {
        Self {
            label: label.into(),
            options,
            times: Vec::new(),
            drawn: None,
        }
    }

    /// Draws it once; what is asked to stop within is drawn to the end all the same.
    fn draw(&mut self, shot: &Shot, bench: &mut dyn Bench) {
        bench.next(&self.label);
        let tracer = Tracer::new(shot.world);
        let mut drawn = None;
        let options = self.options;
        let cost = bench.run(None, &mut |progress: &Progress| {
            drawn = Some(render(
                &tracer,
                &shot.camera,
                shot.start,
                &options,
                progress,
            ));
        });
        self.times.push(cost.seconds);
        self.drawn = drawn;
    }

    fn spread(&self) -> Option<Spread> {
        Spread::of(&self.times)
    }

    fn rays(&self) -> Option<RayCounts> {
        self.drawn.as_ref().map(|d| d.work.rays.into())
    }
}

/// Draws all takes once, in this order, those for which there is no time left out; then again and again in turn,
/// so that the machine's moods meet all of them. `until` is the time for the first round, as a part
/// of the budget.
fn draw_all(shot: &Shot, takes: &mut [Take], order: &[usize], bench: &mut dyn Bench, until: f64) {
    let budget = shot.about.budget;
    for &i in order {
        let take = &mut takes[i];
        if bench.now() < until * budget {
            take.draw(shot, bench);
        }
    }
    for _ in 1..ENOUGH {
        for &i in order {
            let take = &mut takes[i];
            let next = take.times.first().copied();
            if next.is_some_and(|next| bench.now() + next < budget) {
                take.draw(shot, bench);
            }
        }
    }
}

/// The exposure of all pictures of a study: that of the whole one, so that they can be compared.
fn exposure_of(whole: &Rendered) -> Exposure {
    Exposure::Stops(whole.picture.factor(Exposure::Auto).log2())
}

/// The shot with these effects.
fn with(shot: &Shot, effects: Effects) -> RenderOptions {
    RenderOptions {
        effects,
        ..shot.options
    }
}
