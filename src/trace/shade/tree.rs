//! The lecture's trees of rays, of many points together, level by level.
//!
//! In: rays that go on from points ([`Wavefront`]), and the points' own light. Out: their light with that
//! of everything behind. All rays of a level are cast together; what they meet gives light, and the rays
//! of the next level. Each sum is formed in the order of the lecture's recursion, so every colour is that
//! of a tree that was followed branch by branch, to the last bit.

use glam::DVec3;

use super::{Lit, Path, Shader, Work};
use crate::trace::ray::Ray;
use crate::trace::stream::BATCH;
use crate::trace::world::caster::Caster;
use crate::trace::world::{Departure, Tracer};

/// Rays that are cast together. Those of deeper levels are held beside them: for each level at most as
/// many, times those that go on from one point.
const TOGETHER: usize = 4 * BATCH;

/// What it takes to follow wavefronts, again and again.
pub struct Waves<'a> {
    caster: Caster<'a>,
    /// Room for more, from earlier ones.
    spare: Vec<Wavefront>,
}

impl<'a> Waves<'a> {
    /// For rays of this tracer.
    pub fn new(tracer: &'a Tracer<'a>) -> Self {
        Self {
            caster: Caster::new(tracer),
            spare: Vec::new(),
        }
    }

    /// One without rays.
    pub fn wavefront(&mut self) -> Wavefront {
        self.spare.pop().unwrap_or_default()
    }

    /// Takes one back that is no longer needed.
    pub fn done(&mut self, mut wavefront: Wavefront) {
        wavefront.clear();
        self.spare.push(wavefront);
    }
}

/// A ray that goes on from a point.
#[derive(Clone, Debug)]
pub struct Onward {
    /// The ray.
    pub ray: Ray,
    /// From where it starts.
    pub from: Departure,
    /// Where in the tree it is.
    pub path: Path,
    /// Its share in the mean of its branch.
    pub weight: f64,
}

/// Rays that go on from points, in branches: of each the mean of the light is added to its point's.
#[derive(Clone, Debug, Default)]
pub struct Wavefront {
    /// The number of the point whose branches come next.
    pub parent: u32,
    branches: Vec<Branch>,
    rays: Vec<Onward>,
}

/// Rays up to a number, from those of the branch before.
#[derive(Clone, Copy, Debug)]
struct Branch {
    parent: u32,
    past: usize,
    /// What the mean is multiplied by.
    factor: DVec3,
    /// What the sum is divided by.
    weights: f64,
}

impl Wavefront {
    /// One more ray of the branch that will be closed next.
    #[inline]
    pub fn add(&mut self, ray: Onward) {
        self.rays.push(ray);
    }

    /// The rays that were added since the last are a branch: `factor` times the sum of their weighted
    /// light, divided by `weights`.
    #[inline]
    pub fn close(&mut self, factor: DVec3, weights: f64) {
        self.branches.push(Branch {
            parent: self.parent,
            past: self.rays.len(),
            factor,
            weights,
        });
    }

    /// As [`Wavefront::close`], divided by the sum of their weights.
    pub fn close_all(&mut self, factor: DVec3) {
        let first = self.branches.last().map_or(0, |branch| branch.past);
        let weights = self.rays[first..].iter().map(|ray| ray.weight);
        self.close(factor, weights.fold(0.0, |sum, weight| sum + weight));
    }

    /// How many rays there are.
    pub fn len(&self) -> usize {
        self.rays.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rays.is_empty()
    }

    /// Forgets all rays.
    pub fn clear(&mut self) {
        self.branches.clear();
        self.rays.clear();
    }
}

impl<const SHADOWS: bool, const SOFT: bool, const SECONDARY: bool, const SCATTER: bool>
    Shader<'_, SHADOWS, SOFT, SECONDARY, SCATTER>
{
    /// Adds to the light of points that of all rays that go on from them.
    pub fn follow(
        &self,
        waves: &mut Waves,
        wavefront: &Wavefront,
        light: &mut [DVec3],
        work: &mut Work,
    ) {
        // Of the points that these rays meet nothing is known yet.
        work.lit = Lit::default();
        let mut back = Vec::with_capacity(wavefront.rays.len());
        let mut next = waves.wavefront();
        for together in wavefront.rays.chunks(TOGETHER) {
            let first = back.len();
            let way = |ray: &Onward| (ray.ray, ray.from);
            waves.caster.nearest(together, way, |ray, meeting| {
                next.parent = (back.len() - first) as u32;
                let Onward { ray, path, .. } = ray;
                back.push(self.shade(ray, meeting.as_ref(), path, work, &mut next));
            });
            if !next.is_empty() {
                self.follow(waves, &next, &mut back[first..], work);
                next.clear();
            }
        }
        waves.done(next);
        let mut first = 0;
        for branch in &wavefront.branches {
            let rays = first..branch.past;
            first = branch.past;
            let mut sum = DVec3::ZERO;
            for (light, ray) in back[rays.clone()].iter().zip(&wavefront.rays[rays]) {
                sum += *light * ray.weight;
            }
            light[branch.parent as usize] += branch.factor * (sum / branch.weights);
        }
    }
}
