//! What colour a ray sees: the lecture's tree of rays.
//!
//! In: a ray and where it starts. Out: the light that comes back along it, linear RGB:
//!
//! ```text
//! I = emission + kd·Ia + Σ vis/d²·Ii·(kd·(N·L) + ks·(R·V)^n) + km·I(reflected) + kt·I(refracted)
//! ```
//!
//! with kd, ks, n of the material, km its `mirror` and kt its `transmit`. Reflected light takes the
//! hue of ks (gold reflects golden), passing light that of kd (red glass); without colour both are
//! white. Source: lecture, "Illumination Model" to "Soft Shadows".
//!
//! # What is decided here
//!
//! - *Shadows.* A light in a wall or ceiling must not be shadowed by it, so a shadow ray stops short
//!   of the light by 2^-32 of the way. It goes straight: glass takes its `transmit` of the light at
//!   each of its surfaces, and casts no caustics. Things that give off light cast no shadow: they are
//!   lamps, with a light inside. The sky lets light from outside pass, and only that.
//! - *Media.* A ray in a solid thing keeps the list of things that it is in. The one that it entered
//!   last rules: its index holds until the ray leaves *it*, then that of the one before. So glass in
//!   water works, and a drop half in glass. An eye starts in none. Sheets (panes, polygons, meshes
//!   that are not closed) let light pass straight.
//! - *Inside.* Local light is for surfaces seen from outside; in a glass ball only the tree goes on.
//! - *Scattering.* With a `roughness` r the reflected or passing light is averaged over a cone of
//!   r·45° about its direction, weighted by cos^n of the angle to it; directions beyond the surface
//!   do not count. Several rays at the first surface, one each at further ones.
//! - *The end.* At the depth limit, and where the product of km and kt so far falls under a threshold.
//! - *Chance.* Every draw is seeded by pixel, sample and its place in the tree, so that leaving out
//!   what is not seen changes no other draw.
//! - *Order.* The trees of many points are followed together, level by level (`tree`): rays that mirrors
//!   and rough surfaces send on have no order, and are the faster the more of them go at once.
//!
//! What is compiled is decided by four flags, so that an effect which is absent costs nothing:
//! `SHADOWS`, `SOFT` (lights with an extent), `SECONDARY` (anything that reflects or lets pass), and
//! `SCATTER` (any of it rough).

mod medium;
mod sheet;
mod surface;
mod tree;

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

pub use medium::{Media, refract};
pub use sheet::Sheet;
pub use surface::{Finish, finishes, phong};
pub use tree::{Onward, Wavefront, Waves};

use super::dress::Look;
use super::light::{arrival, is_area, middle, parts};
use super::ray::Ray;
use super::sampling::{Source, branch};
use super::shadow;
use super::space::Surface;
use super::world::meet::{Meeting, Obstacle};
use super::world::{Hit, Tracer, What};

/// How far the tree of rays goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Most reflections and refractions in a row.
    pub depth: u32,
    /// Smallest product of km and kt that is followed.
    pub threshold: f64,
    /// Shadow rays to a light with an extent.
    pub light_samples: u32,
    /// Rays into the cone of a rough surface.
    pub scatter_samples: u32,
}

/// Rays cast, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rays {
    /// From the eye.
    pub primary: u64,
    /// To lights.
    pub shadow: u64,
    /// Reflected.
    pub reflected: u64,
    /// Passing through.
    pub refracted: u64,
}

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.reflected += other.reflected;
        self.refracted += other.refracted;
    }
}

/// What the work on a part of a picture amounted to.
#[derive(Clone, Debug)]
pub struct Work {
    /// Rays cast.
    pub rays: Rays,
    /// Cells in which rays ended, one bit each.
    pub touched: Vec<u64>,
    /// What is known of the lights that reach the next ray's first surface.
    pub lit: Lit,
}

/// Which of a cell's lights reach a point, as far as that is known already: bit i stands for the
/// i-th of [`super::world::World::lights_of`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lit {
    /// Of which it is known.
    pub known: u64,
    /// Which of those reach it.
    pub reach: u64,
}

impl Lit {
    #[inline]
    fn of(self, i: usize) -> Option<bool> {
        (i < 64 && self.known >> i & 1 == 1).then_some(self.reach >> i & 1 == 1)
    }
}

impl Work {
    /// None yet, in a level of so many cells.
    pub fn new(n_cells: usize) -> Self {
        Self {
            rays: Rays::default(),
            touched: vec![0; n_cells.div_ceil(64)],
            lit: Lit::default(),
        }
    }

    #[inline]
    fn touch(&mut self, cell: u32) {
        self.touched[cell as usize / 64] |= 1 << (cell % 64);
    }

    /// Takes other work in.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        for (mine, other) in self.touched.iter_mut().zip(&other.touched) {
            *mine |= other;
        }
    }

    /// Number of cells in which rays ended.
    pub fn n_touched(&self) -> u64 {
        self.touched.iter().map(|w| u64::from(w.count_ones())).sum()
    }
}

/// Where in the tree a ray is.
#[derive(Clone, Debug)]
pub struct Path {
    /// Reflections and refractions so far.
    pub depth: u32,
    /// Product of km and kt so far.
    pub weight: f64,
    /// What chance is seeded with.
    pub key: u64,
    /// What the ray is in.
    pub media: Media,
}

impl Path {
    /// From the eye.
    pub fn new(key: u64) -> Self {
        Self {
            depth: 0,
            weight: 1.0,
            key,
            media: Media::default(),
        }
    }
}

/// A shadow ray stops this much short of the light.
const SHORT: f64 = 1.0 - 1.0 / (1u64 << 32) as f64;

/// Something follows from rays through so many surfaces at most, in one line to a light.
const MOST_PANES: usize = 64;

/// Gives colours to rays; compiled for the effects that a picture calls for.
#[derive(Clone, Copy)]
pub struct Shader<
    'a,
    const SHADOWS: bool,
    const SOFT: bool,
    const SECONDARY: bool,
    const SCATTER: bool,
> {
    /// What there is to see.
    pub tracer: &'a Tracer<'a>,
    /// By material.
    pub finishes: &'a [Finish],
    /// How far to go.
    pub limits: Limits,
    /// Whether a Doom map's surfaces show their textures.
    pub textures: bool,
}

/// A point of a surface, turned towards the one who looks.
struct Spot<'h> {
    hit: &'h Hit,
    /// Unit vector to the eye.
    view: DVec3,
    /// Geometric and shading normal, on the side of the eye.
    outer: DVec3,
    normal: DVec3,
    colour: DVec3,
}

impl<const SHADOWS: bool, const SOFT: bool, const SECONDARY: bool, const SCATTER: bool>
    Shader<'_, SHADOWS, SOFT, SECONDARY, SCATTER>
{
    /// The light that comes back from what a ray has met, but for that of rays that go on from there:
    /// those are added to `wavefront`, for [`Shader::follow`].
    #[inline]
    pub fn shade(
        &self,
        ray: &Ray,
        meeting: Option<&Meeting>,
        path: &Path,
        work: &mut Work,
        wavefront: &mut Wavefront,
    ) -> DVec3 {
        let world = self.tracer.world;
        let Some(meeting) = meeting else {
            return world.sky(ray.direction);
        };
        let hit = self.tracer.hit(ray, meeting);
        work.touch(hit.cell.0);
        if let What::Surface(surface) = hit.what
            && world.is_sky(surface)
        {
            let glass = match surface {
                Surface::Outside(_) => hit.material.map(|m| self.pass(m.0, &hit)),
                _ => None,
            };
            return world.sky(ray.direction) * glass.unwrap_or(DVec3::ONE);
        }
        let Some(material) = hit.material else {
            return DVec3::ZERO;
        };
        let look = world.look(&hit);
        if look == Look::Hole {
            wavefront.add(self.onward(&hit, ray.direction, path.clone()));
            wavefront.close(DVec3::ONE, 1.0);
            return DVec3::ZERO;
        }
        let finish = &self.finishes[material.0 as usize];
        let view = -ray.direction.normalize();
        // Surfaces of the level are seen from their cell, whatever rounding says; panes from both sides.
        let turned = match hit.what {
            What::Surface(surface) if !matches!(surface, Surface::Pane(_)) => false,
            _ => hit.normal.dot(view) < 0.0,
        };
        let sign = if turned { -1.0 } else { 1.0 };
        let spot = Spot {
            hit: &hit,
            view,
            outer: hit.normal * sign,
            normal: hit.shading * sign,
            colour: match look {
                Look::Texel(colour) if self.textures => colour,
                _ => finish.colour(world, &hit),
            },
        };
        let solid = matches!(hit.what, What::Object(n) if world.standing[n as usize].solid);
        let within = SECONDARY && turned && solid && finish.kt > 0.0;
        let mut light = finish.emission;
        if !within {
            light += spot.colour * world.ambient_at(&hit);
            light += self.direct(&spot, finish, path, work);
        }
        if SECONDARY && path.depth < self.limits.depth {
            self.mirror(&spot, finish, path, work, wavefront);
            self.pass_on(
                &spot,
                finish,
                solid.then_some(turned),
                path,
                work,
                wavefront,
            );
        }
        light
    }

    /// Light from the sources.
    fn direct(&self, spot: &Spot, finish: &Finish, path: &Path, work: &mut Work) -> DVec3 {
        let world = self.tracer.world;
        let mut sum = DVec3::ZERO;
        // Of what is reflected nothing is known yet.
        let lit = if path.depth == 0 {
            work.lit
        } else {
            Lit::default()
        };
        for (i, &number) in world.lights_of(spot.hit.cell).iter().enumerate() {
            let light = &world.lights[number as usize];
            if SOFT && is_area(light) {
                let n = if path.depth == 0 {
                    self.limits.light_samples
                } else {
                    self.limits.light_samples.div_ceil(4)
                };
                let mut source = Source::new(path.key, u64::from(number), 1);
                let [columns, rows] = parts(light, n);
                let mut all = DVec3::ZERO;
                for sample in source.grid(columns, rows) {
                    all += self.light_from(spot, finish, number, (sample, None), work);
                }
                sum += all / f64::from(columns * rows);
            } else {
                let sample = (middle(light), lit.of(i));
                sum += self.light_from(spot, finish, number, sample, work);
            }
        }
        sum
    }

    /// Light from the part of a source that a sample picks; `seen` tells whether it is in sight, if
    /// that is known.
    #[inline]
    fn light_from(
        &self,
        spot: &Spot,
        finish: &Finish,
        number: u32,
        (sample, seen): (DVec2, Option<bool>),
        work: &mut Work,
    ) -> DVec3 {
        let world = self.tracer.world;
        let light = &world.lights[number as usize];
        let Some(arrival) = arrival(light, spot.hit.point, sample) else {
            return DVec3::ZERO;
        };
        let l = arrival.direction;
        if spot.normal.dot(l) <= 0.0 || spot.outer.dot(l) <= 0.0 {
            return DVec3::ZERO;
        }
        let reflected = phong(
            (spot.colour, finish.ks, finish.shininess),
            spot.normal,
            l,
            spot.view,
        );
        if reflected == DVec3::ZERO {
            return DVec3::ZERO;
        }
        if SHADOWS && seen == Some(false) {
            work.rays.shadow += 1;
            return DVec3::ZERO;
        }
        let mut light = arrival.intensity * reflected;
        if SHADOWS {
            work.rays.shadow += 1;
            if seen.is_none() {
                light *= self.visible(spot.hit, number, l, arrival.distance);
            }
        }
        light
    }

    /// How much light comes through from a source: vis(i) of the lecture.
    fn visible(&self, hit: &Hit, number: u32, direction: DVec3, distance: f64) -> DVec3 {
        let world = self.tracer.world;
        let outdoors = world.outdoors[number as usize];
        if let Some(lamp) = &world.lamps[number as usize]
            && self.tracer.walks()
            && world.standing.is_empty()
        {
            let place = self.tracer.depart(hit, direction).place;
            match shadow::blocker(&world.space, hit.point, place, lamp) {
                None => return DVec3::ONE,
                // Glass or a grating: worth a closer look.
                Some(Surface::Pane(_)) => {}
                // The sky too: light from outside only passes there, and a lamp is inside.
                Some(_) => return DVec3::ZERO,
            }
        }
        let mut left = distance * SHORT;
        let mut ray = Ray {
            origin: hit.point,
            direction,
        };
        let mut from = self.tracer.depart(hit, direction);
        let mut share = DVec3::ONE;
        for _ in 0..MOST_PANES {
            let meeting = if world.opaque {
                match self.tracer.obstacle(&ray, &from, left) {
                    Obstacle::None => None,
                    Obstacle::Object => return DVec3::ZERO,
                    Obstacle::Surface(met) => Some(Meeting::Surface(met)),
                }
            } else {
                self.tracer.nearest(&ray, &from, left)
            };
            let Some(meeting) = meeting else {
                return share;
            };
            if let Meeting::Surface(met) = meeting
                && met.t < left
                && !matches!(met.surface, Surface::Pane(_))
                && !world.is_sky(met.surface)
            {
                return DVec3::ZERO;
            }
            let met = self.tracer.hit(&ray, &meeting);
            if met.t >= left {
                return share;
            }
            if let What::Surface(surface) = met.what
                && world.is_sky(surface)
            {
                let glass = match surface {
                    Surface::Outside(_) => met.material.map(|m| self.pass(m.0, &met)),
                    _ => None,
                };
                let open = if outdoors { DVec3::ONE } else { DVec3::ZERO };
                return share * open * glass.unwrap_or(DVec3::ONE);
            }
            share *= match (met.what, met.material) {
                (What::Object(_), Some(m)) if self.finishes[m.0 as usize].glows() => DVec3::ONE,
                _ if world.look(&met) == Look::Hole => DVec3::ONE,
                (What::Object(_) | What::Surface(Surface::Pane(_)), Some(m)) => {
                    self.pass(m.0, &met)
                }
                _ => DVec3::ZERO,
            };
            if share == DVec3::ZERO {
                return share;
            }
            left -= met.t;
            ray.origin = met.point;
            from = self.tracer.depart(&met, direction);
        }
        DVec3::ZERO
    }

    /// The share of light that a thing lets pass, by colour.
    fn pass(&self, material: u32, hit: &Hit) -> DVec3 {
        self.finishes[material as usize].pass(self.tracer.world, hit)
    }

    /// A ray that goes on from a hit.
    fn onward(&self, hit: &Hit, direction: DVec3, path: Path) -> Onward {
        Onward {
            ray: Ray {
                origin: hit.point,
                direction,
            },
            from: self.tracer.depart(hit, direction),
            path,
            weight: 1.0,
        }
    }

    /// Rays that are reflected as by a mirror.
    fn mirror(
        &self,
        spot: &Spot,
        finish: &Finish,
        path: &Path,
        work: &mut Work,
        wavefront: &mut Wavefront,
    ) {
        let weight = path.weight * finish.km.max_element();
        if weight == 0.0 || weight < self.limits.threshold {
            return;
        }
        let next = Path {
            depth: path.depth + 1,
            weight,
            key: branch(path.key, 1),
            media: path.media.clone(),
        };
        work.rays.reflected += self.scatter(spot, finish, (reflect(spot), 1.0), &next, wavefront);
        wavefront.close_all(finish.km);
    }

    /// Rays that pass, bent where they go into or out of a solid thing; `leaves` says which, for those.
    fn pass_on(
        &self,
        spot: &Spot,
        finish: &Finish,
        leaves: Option<bool>,
        path: &Path,
        work: &mut Work,
        wavefront: &mut Wavefront,
    ) {
        let weight = path.weight * finish.kt;
        if weight == 0.0 || weight < self.limits.threshold {
            return;
        }
        let towards = -spot.view;
        let mut next = Path {
            depth: path.depth + 1,
            weight,
            key: branch(path.key, 2),
            media: path.media.clone(),
        };
        let mut direction = Some(towards);
        match (leaves, spot.hit.what) {
            (Some(leaves), What::Object(number)) => {
                let ratio = if leaves {
                    next.media.leave(number, finish.ior)
                } else {
                    next.media.enter(number, finish.ior)
                };
                direction = refract(towards, spot.normal, ratio);
            }
            // Behind a floor there is nothing.
            (_, What::Surface(surface)) if !matches!(surface, Surface::Pane(_)) => return,
            _ => {}
        }
        match direction {
            Some(d) => {
                work.rays.refracted += self.scatter(spot, finish, (d, -1.0), &next, wavefront);
            }
            None => {
                // Total internal reflection.
                next.media = path.media.clone();
                let axis = (reflect(spot), 1.0);
                work.rays.reflected += self.scatter(spot, finish, axis, &next, wavefront);
            }
        }
        wavefront.close_all(finish.pass(self.tracer.world, spot.hit));
    }

    /// A ray into a direction, or rays into the cone about it; `side` is 1 for directions on the side of
    /// the eye, -1 beyond the surface. Out: how many.
    fn scatter(
        &self,
        spot: &Spot,
        finish: &Finish,
        (axis, side): (DVec3, f64),
        path: &Path,
        wavefront: &mut Wavefront,
    ) -> u64 {
        let mut cast = 0;
        if SCATTER && finish.cone != 0.0 {
            let n = if path.depth == 1 {
                self.limits.scatter_samples
            } else {
                1
            };
            let mut source = Source::new(path.key, 0, 2);
            let (u, v) = axis.any_orthonormal_pair();
            for (sample, number) in source.stratified(n).zip(0..) {
                let cos = 1.0 - sample.x * (1.0 - finish.cone.cos());
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let (s, c) = (TAU * sample.y).sin_cos();
                let direction = axis * cos + (u * c + v * s) * sin;
                if side * spot.outer.dot(direction) <= 0.0 {
                    continue;
                }
                let weight = cos.powf(finish.shininess);
                if weight == 0.0 {
                    continue;
                }
                let each = Path {
                    key: branch(path.key, number),
                    ..path.clone()
                };
                wavefront.add(Onward {
                    weight,
                    ..self.onward(spot.hit, direction, each)
                });
                cast += 1;
            }
        }
        if cast == 0 {
            // As a mirror does; or a grazing ray of which every sample went astray.
            wavefront.add(self.onward(spot.hit, axis, path.clone()));
            cast = 1;
        }
        cast
    }
}

/// R = V - 2(N·V)N, V being the way of the ray; about the geometric normal where the shading one would
/// send it into the surface.
fn reflect(spot: &Spot) -> DVec3 {
    let d = -spot.view;
    let about = |n: DVec3| d - n * (2.0 * d.dot(n));
    let r = about(spot.normal);
    if r.dot(spot.outer) > 0.0 {
        r
    } else {
        about(spot.outer)
    }
}
