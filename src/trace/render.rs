//! From a world and a camera to a picture.
//!
//! The picture is cut into tiles, which threads take one after the other; every pixel's draws are
//! seeded by the pixel and the number of the sample, so it does not matter who draws it when. One
//! sample goes through the middle of the pixel: then the surfaces of the level are found for whole
//! rectangles at once ([`super::beam`]). Several are spread evenly over the pixel's square, one in
//! each part of it. Where neighbouring pixels still differ, more can be added (adaptive antialiasing).
//!
//! The effects decide which version of the [`Shader`] is taken, once per picture.

use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::beam::{self, Area, Bundle, Patch, middle};
use super::camera::Camera;
use super::cast::Met;
use super::effects::{Effect, Effects};
use super::picture::{Exposure, Picture, tone};
use super::sampling::{Source, branch};
use super::shade::{Finish, Limits, Lit, Onward, Path, Shader, Waves, Work, finishes};
use super::shadow;
use super::space::Surface;
use super::world::meet::Meeting;
use super::world::{Departure, Tracer};
use crate::cells::CellId;
use crate::pvs::Progress;

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Samples in every pixel, at least 1.
    pub samples: u32,
    /// More samples where neighbours differ.
    pub adaptive: Option<Adaptive>,
    /// How far the tree of rays goes.
    pub limits: Limits,
    /// Seed of all that is random.
    pub seed: u64,
    /// What is simulated.
    pub effects: Effects,
}

/// Where more samples are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    /// Samples in all in such a pixel.
    pub samples: u32,
    /// Difference to a neighbour, on the screen, from 0 (black) to 1 (white), from which on.
    pub contrast: f64,
    /// How the picture will be exposed.
    pub exposure: Exposure,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            samples: 1,
            adaptive: None,
            limits: Limits {
                depth: 5,
                threshold: 1.0 / 256.0,
                light_samples: 16,
                scatter_samples: 16,
            },
            seed: 1,
            effects: Effects::ALL,
        }
    }
}

/// A picture, and what it cost.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture.
    pub picture: Picture,
    /// Rays and cells.
    pub work: Work,
    /// Pixels that got more samples.
    pub refined: u64,
}

/// Side of a tile in pixels.
const TILE: u32 = 32;

/// As many samples are followed together, or a few more.
const ENOUGH: usize = 4000;

/// Renders a picture from an eye in `start`, on the current rayon thread pool. `progress` counts
/// pixels; once it is asked to stop, what is left of the picture stays black.
pub fn render(
    tracer: &Tracer,
    camera: &Camera,
    start: CellId,
    options: &RenderOptions,
    progress: &Progress,
) -> Rendered {
    let job = Job {
        tracer,
        camera,
        start,
        options,
        progress,
        finishes: &finishes(tracer.world, options.effects),
    };
    let has = |effect| options.effects.has(effect);
    let secondary = [
        Effect::Mirror,
        Effect::Glossy,
        Effect::Refraction,
        Effect::Translucency,
    ];
    let shadows = (has(Effect::Shadows), has(Effect::Soft));
    let follows = (
        secondary.into_iter().any(has),
        has(Effect::Glossy) || has(Effect::Translucency),
    );
    match (shadows, follows) {
        ((false, false), (false, _)) => job.run::<false, false, false, false>(),
        ((false, false), (true, false)) => job.run::<false, false, true, false>(),
        ((false, false), (true, true)) => job.run::<false, false, true, true>(),
        ((true, false), (false, _)) => job.run::<true, false, false, false>(),
        ((true, false), (true, false)) => job.run::<true, false, true, false>(),
        ((true, false), (true, true)) => job.run::<true, false, true, true>(),
        // Lights with an extent and no shadows: rare enough to share the version with everything.
        ((false, true), _) => job.run::<false, true, true, true>(),
        ((true, true), (false, _)) => job.run::<true, true, false, false>(),
        ((true, true), (true, false)) => job.run::<true, true, true, false>(),
        ((true, true), (true, true)) => job.run::<true, true, true, true>(),
    }
}

/// A picture in the making.
#[derive(Clone, Copy)]
struct Job<'a> {
    tracer: &'a Tracer<'a>,
    camera: &'a Camera,
    start: CellId,
    options: &'a RenderOptions,
    progress: &'a Progress,
    finishes: &'a [Finish],
}

impl Job<'_> {
    fn run<const SHADOWS: bool, const SOFT: bool, const SECONDARY: bool, const SCATTER: bool>(
        &self,
    ) -> Rendered {
        let [width, height] = self.camera.size;
        let samples = self.options.samples.max(1);
        let shader = |per_pixel: u32| {
            // Samples of a pixel share its rays to lights and into cones.
            let limits = Limits {
                light_samples: self.options.limits.light_samples.div_ceil(per_pixel),
                scatter_samples: self.options.limits.scatter_samples.div_ceil(per_pixel),
                ..self.options.limits
            };
            Shader::<SHADOWS, SOFT, SECONDARY, SCATTER> {
                tracer: self.tracer,
                finishes: self.finishes,
                limits,
                textures: self.options.effects.has(Effect::Textures),
            }
        };
        self.progress.begin(width as usize * height as usize);
        let n_cells = self.tracer.world.space.cells.len();
        let first = shader(samples);
        let tiles: Vec<(Area, Vec<DVec3>, Work)> = tiles(width, height)
            .into_par_iter()
            .map_init(
                || Waves::new(self.tracer),
                |waves, area| {
                    let mut work = Work::new(n_cells);
                    let pixels = if self.progress.stopped() {
                        Vec::new()
                    } else if samples == 1 && self.tracer.walks() {
                        self.by_beams(&first, waves, area, &mut work)
                    } else {
                        let all = pixels(area).collect::<Vec<_>>();
                        let mean = f64::from(samples);
                        self.by_samples(&first, waves, &all, (0..samples, mean), &mut work)
                    };
                    self.progress.advance(area.len());
                    (area, pixels, work)
                },
            )
            .collect();
        let mut picture = Picture {
            size: self.camera.size,
            pixels: vec![DVec3::ZERO; width as usize * height as usize],
        };
        let mut work = Work::new(n_cells);
        for (area, colours, own) in tiles {
            for ([x, y], colour) in pixels(area).zip(colours) {
                picture.pixels[(y * width + x) as usize] = colour;
            }
            work.add(&own);
        }
        let refined = match self.options.adaptive {
            Some(adaptive) if adaptive.samples > samples => {
                let more = shader(adaptive.samples);
                self.refine(&more, &adaptive, &mut picture, &mut work)
            }
            _ => 0,
        };
        Rendered {
            picture,
            work,
            refined,
        }
    }

    /// A tile with one sample in the middle of each pixel.
    fn by_beams<const A: bool, const B: bool, const C: bool, const D: bool>(
        &self,
        shader: &Shader<A, B, C, D>,
        waves: &mut Waves,
        area: Area,
        work: &mut Work,
    ) -> Vec<DVec3> {
        let world = self.tracer.world;
        let across = area.x.1 - area.x.0;
        let mut colours = vec![DVec3::ZERO; area.len()];
        let from = Departure::within(self.start);
        let crowded = !world.standing.is_empty();
        let fan = self.camera.fan();
        let mut lit = Vec::new();
        let mut wavefront = waves.wavefront();
        beam::cast_patches(
            &world.space,
            self.camera,
            self.start,
            area,
            |patch, depths| {
                if A {
                    self.light_up(&patch, &mut lit);
                }
                let at = |x: u32, y: u32| (y - area.y.0) * across + (x - area.x.0);
                if !crowded
                    && depths.iter().all(|t| t.is_finite())
                    && let Some((surface, cell)) = patch.met
                    && let Some(sheet) = shader.sheet(surface, cell)
                {
                    let known = (depths, &lit[..]);
                    return shader.spread(&sheet, &fan, &patch, known, work, &mut |x, y, list| {
                        colours[at(x, y) as usize..][..list.len()].copy_from_slice(list);
                    });
                }
                let across_patch = patch.area.width();
                patch.mask.rectangles(&patch.area, |part| {
                    for [x, y] in pixels(part) {
                        let i = ((y - patch.area.y.0) * across_patch + x - patch.area.x.0) as usize;
                        let met = patch.met.map(|(surface, cell)| Met {
                            t: depths[i],
                            surface,
                            cell,
                        });
                        let ray = self.camera.ray(middle(x, y));
                        let met = met.filter(|m| m.t.is_finite());
                        let meeting = if crowded || met.is_none() {
                            self.tracer.before(&ray, &from, met)
                        } else {
                            met.map(Meeting::Surface)
                        };
                        work.rays.primary += 1;
                        work.lit = lit.get(i).copied().unwrap_or_default();
                        let path = Path::new(self.key(x, y, 0));
                        wavefront.parent = at(x, y);
                        colours[at(x, y) as usize] =
                            shader.shade(&ray, meeting.as_ref(), &path, work, &mut wavefront);
                    }
                });
            },
        );
        shader.follow(waves, &wavefront, &mut colours, work);
        waves.done(wavefront);
        colours
    }

    /// Which lights reach the points of a patch, by pixel of its rectangle; nothing where each point
    /// has to ask for itself: where objects may stand in the way, or the surface is clear.
    fn light_up(&self, patch: &Patch, lit: &mut Vec<Lit>) {
        lit.clear();
        let world = self.tracer.world;
        let Some((surface, cell)) = patch.met else {
            return;
        };
        if !world.standing.is_empty() || !world.stops_light(surface) {
            return;
        }
        lit.resize(patch.area.len(), Lit::default());
        let across = patch.area.width();
        for (i, &number) in world.lights_of(cell).iter().enumerate().take(64) {
            let Some(lamp) = &world.lamps[number as usize] else {
                continue;
            };
            shadow::patch(
                &world.space,
                self.camera,
                patch,
                lamp,
                |area, mask, blocker| {
                    let reach = match blocker {
                        None => true,
                        // Glass or a grating: each point has to look more closely.
                        Some(Surface::Pane(_)) => return,
                        Some(_) => false,
                    };
                    mask.rectangles(&area, |part| {
                        for [x, y] in pixels(part) {
                            let at = (y - patch.area.y.0) * across + x - patch.area.x.0;
                            let lit = &mut lit[at as usize];
                            lit.known |= 1 << i;
                            lit.reach |= u64::from(reach) << i;
                        }
                    });
                },
            );
        }
    }

    /// The sums of such samples of pixels, of as many as the last is in all, divided by a number.
    fn by_samples<const A: bool, const B: bool, const C: bool, const D: bool>(
        &self,
        shader: &Shader<A, B, C, D>,
        waves: &mut Waves,
        pixels: &[[u32; 2]],
        (samples, by): (Range<u32>, f64),
        work: &mut Work,
    ) -> Vec<DVec3> {
        let mut colours = vec![DVec3::ZERO; pixels.len()];
        let mut wavefront = waves.wavefront();
        for (&[x, y], i) in pixels.iter().zip(0..) {
            if self.progress.stopped() {
                return colours;
            }
            let n = samples.end - samples.start;
            let corner = DVec2::new(f64::from(x), f64::from(y));
            let places: Vec<DVec2> = if samples.end == 1 {
                vec![DVec2::splat(0.5)]
            } else {
                let key = branch(self.key(x, y, samples.start), 7);
                Source::new(key, 0, 0).stratified(n).collect()
            };
            for (place, number) in places.into_iter().zip(samples.clone()) {
                wavefront.add(Onward {
                    ray: self.camera.ray(corner + place),
                    from: Departure::within(self.start),
                    path: Path::new(self.key(x, y, number)),
                    weight: 1.0,
                });
            }
            work.rays.primary += u64::from(n);
            wavefront.parent = i;
            wavefront.close(DVec3::ONE, by);
            if wavefront.len() >= ENOUGH {
                shader.follow(waves, &wavefront, &mut colours, work);
                wavefront.clear();
            }
        }
        shader.follow(waves, &wavefront, &mut colours, work);
        waves.done(wavefront);
        colours
    }

    /// What a sample's chance is seeded with.
    fn key(&self, x: u32, y: u32, sample: u32) -> u64 {
        let pixel = u64::from(y) << 32 | u64::from(x);
        branch(branch(self.options.seed, pixel), u64::from(sample))
    }

    /// More samples where neighbours differ. Number of such pixels.
    fn refine<const A: bool, const B: bool, const C: bool, const D: bool>(
        &self,
        shader: &Shader<A, B, C, D>,
        adaptive: &Adaptive,
        picture: &mut Picture,
        work: &mut Work,
    ) -> u64 {
        let [width, height] = picture.size;
        let rough = differing(picture, adaptive);
        self.progress.begin(rough.len());
        let samples = self.options.samples.max(1);
        let n_cells = self.tracer.world.space.cells.len();
        let chunks: Vec<(Vec<DVec3>, Work)> = rough
            .par_chunks(64)
            .map_init(
                || Waves::new(self.tracer),
                |waves, chunk| {
                    let mut work = Work::new(n_cells);
                    let pixels = chunk.iter().map(|&at| [at % width, at / width]);
                    let more = (samples..adaptive.samples, 1.0);
                    let pixels = pixels.collect::<Vec<_>>();
                    let colours = self.by_samples(shader, waves, &pixels, more, &mut work);
                    self.progress.advance(chunk.len());
                    (colours, work)
                },
            )
            .collect();
        debug_assert!(rough.iter().all(|&at| at < width * height));
        for (chunk, (sums, own)) in rough.chunks(64).zip(&chunks) {
            for (&at, &sum) in chunk.iter().zip(sums) {
                let pixel = &mut picture.pixels[at as usize];
                *pixel = (*pixel * f64::from(samples) + sum) / f64::from(adaptive.samples);
            }
            work.add(own);
        }
        rough.len() as u64
    }
}

/// Pixels that differ from one of their eight neighbours as they will appear on the screen.
fn differing(picture: &Picture, adaptive: &Adaptive) -> Vec<u32> {
    let [width, height] = picture.size;
    let factor = picture.factor(adaptive.exposure);
    // About as the eye sees steps of brightness.
    let seen: Vec<DVec3> = (picture.pixels.iter())
        .map(|&p| tone(p * factor).max(DVec3::ZERO).powf(1.0 / 2.2))
        .collect();
    let differs = |&at: &u32| {
        let (x, y) = (at % width, at / width);
        let own = seen[at as usize];
        let rows = y.saturating_sub(1)..(y + 2).min(height);
        rows.into_iter().any(|j| {
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            columns.into_iter().any(|i| {
                let other = seen[(j * width + i) as usize];
                (own - other).abs().max_element() > adaptive.contrast
            })
        })
    };
    (0..width * height).filter(differs).collect()
}

/// The tiles of a picture.
fn tiles(width: u32, height: u32) -> Vec<Area> {
    let rows = (0..height).step_by(TILE as usize);
    rows.flat_map(|y| {
        let columns = (0..width).step_by(TILE as usize);
        columns.map(move |x| Area {
            x: (x, (x + TILE).min(width)),
            y: (y, (y + TILE).min(height)),
        })
    })
    .collect()
}

/// The pixels of an area, row after row.
fn pixels(area: Area) -> impl Iterator<Item = [u32; 2]> {
    (area.y.0..area.y.1).flat_map(move |y| (area.x.0..area.x.1).map(move |x| [x, y]))
}
