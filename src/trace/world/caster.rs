//! Many rays at once through a [`World`](super::World).
//!
//! In: rays and from where they start. Out: what [`Tracer::nearest`] gives for each, to the last bit.
//! A tracer that walks lets them go as a [`Stream`]: what one ray asks of a cell, others that come into
//! it through the same edge ask too. In a cell with furniture there is more to ask; whoever comes into
//! one walks on alone.

use super::meet::{Departure, Meeting, Tracer};
use crate::trace::ray::Ray;
use crate::trace::stream::{End, Stream};

/// Fewer rays than this go singly: there would hardly ever be two at the same edge. (Measured on Freedoom
/// maps: from 8 to 40 rays on, streams are the faster.)
const FEW: usize = 32;

/// What it takes to cast rays together, again and again.
pub struct Caster<'a> {
    tracer: &'a Tracer<'a>,
    /// Once it is needed.
    stream: Option<Stream<'a>>,
}

impl<'a> Caster<'a> {
    /// For rays of this tracer.
    pub fn new(tracer: &'a Tracer<'a>) -> Self {
        Self {
            tracer,
            stream: None,
        }
    }

    /// The first thing that each ray meets; `out` is told in order. `ray` tells a ray and from where it
    /// starts.
    pub fn nearest<R>(
        &mut self,
        rays: &[R],
        ray: impl Fn(&R) -> (Ray, Departure),
        mut out: impl FnMut(&R, Option<Meeting>),
    ) {
        let tracer = self.tracer;
        let single = |r: &R| {
            let (ray, from) = ray(r);
            tracer.nearest(&ray, &from, f64::INFINITY)
        };
        if !tracer.walks() || rays.len() < FEW {
            for r in rays {
                out(r, single(r));
            }
            return;
        }
        let world = tracer.world;
        let stream = self.stream.get_or_insert_with(|| {
            let mut stream = Stream::new(&world.space);
            stream.stop(|cell| !world.chambers[cell.0 as usize].list.is_empty());
            stream
        });
        let starts = rays.iter().map(|r| {
            let (ray, from) = ray(r);
            (ray, from.place)
        });
        stream.cast(starts, |i, end| {
            let r = &rays[i as usize];
            let meeting = match end {
                End::Meets(met) if met.t.is_finite() => Some(Meeting::Surface(met)),
                End::Stops(cell, entry) => {
                    let (ray, from) = ray(r);
                    tracer.walk(&ray, &from, (cell, entry), f64::INFINITY, &mut ())
                }
                _ => single(r),
            };
            out(r, meeting);
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::cells::{CellId, Options, subdivide};
    use crate::level::read;
    use crate::pvs::{Progress, sweep};
    use crate::trace::sampling::Source;
    use crate::trace::world::{Files, World};

    /// From places in every cell into all directions, and on from what is met there: objects too.
    #[test]
    fn together_as_singly() {
        for name in ["house", "office", "museum", "cathedral"] {
            let path = format!("{}/levels/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let level = read::read(std::fs::read(&path).unwrap(), &path, None).unwrap();
            let graph = subdivide(&level, &Options::default());
            let pvs = sweep::sweep(&graph, &Progress::default());
            let world = World::new(&level, &graph, &pvs, &Files::default(), 0.1).unwrap();
            let tracer = Tracer::new(&world);
            let mut random = Source::new(8, 0, 0);
            let mut direction = || DVec3::from_array([(); 3].map(|()| random.next() - 0.5));
            let space = &world.space;
            let mut rays: Vec<(Ray, Departure)> = Vec::new();
            for (cell, id) in space.cells.iter().zip(0..) {
                let corners = (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from));
                let middle = corners.sum::<glam::DVec2>() / f64::from(cell.past - cell.first);
                let z = (cell.floor + cell.ceiling) / 2.0;
                for _ in 0..200 {
                    let ray = Ray {
                        origin: middle.extend(z),
                        direction: direction(),
                    };
                    rays.push((ray, Departure::within(CellId(id))));
                }
            }
            let mut caster = Caster::new(&tracer);
            let (mut objects, mut surfaces) = (0, 0);
            for _ in 0..2 {
                let mut next = Vec::new();
                let mut at = rays.iter();
                caster.nearest(
                    &rays,
                    |r| *r,
                    |r, meeting| {
                        assert_eq!(at.next(), Some(r), "in order");
                        let single = tracer.nearest(&r.0, &r.1, f64::INFINITY);
                        let hit = |m: Option<Meeting>| m.map(|m| tracer.hit(&r.0, &m));
                        assert_eq!(hit(meeting), hit(single), "{name}: {r:?}");
                        match meeting {
                            Some(Meeting::Surface(_)) => surfaces += 1,
                            Some(Meeting::Object(..)) => objects += 1,
                            None => return,
                        }
                        let hit = hit(meeting).unwrap();
                        let mut direction = direction();
                        direction *= direction.dot(hit.normal).signum();
                        let ray = Ray {
                            origin: hit.point,
                            direction,
                        };
                        next.push((ray, tracer.depart(&hit, direction)));
                    },
                );
                assert!(at.next().is_none());
                rays = next;
            }
            assert!(
                surfaces > 1000 && objects > 100,
                "{name}: {surfaces}, {objects}"
            );
        }
    }
}
