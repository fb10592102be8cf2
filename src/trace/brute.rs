//! Every surface of the level in turn: what the walk through cells must agree with.
//!
//! Each surface is tested by itself, without knowing its neighbours; O(surfaces) per ray.

use super::cast::{Course, Met, Place, face};
use super::ray::Ray;
use super::space::{Space, Surface};
use crate::cells::{CellId, EdgeId};

/// What the ray meets first among `surfaces` (as of [`Space::surfaces`]); `None` if nothing before
/// `limit`. The starting cell serves rays straight up or down only.
pub fn nearest(
    space: &Space,
    surfaces: &[Surface],
    ray: &Ray,
    start: Place,
    limit: f64,
) -> Option<Met> {
    let course = Course::new(space, *ray);
    let met = surfaces.iter().filter_map(|&surface| {
        if start.on.is_some_and(|on| space.in_one_plane(on, surface)) {
            return None;
        }
        let met = match surface {
            Surface::Floor(id) | Surface::Ceiling(id) => flat(space, &course, surface, id, start),
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => upright(space, &course, surface, e),
        };
        met.filter(|met| met.t <= limit)
    });
    met.min_by(|a, b| a.t.total_cmp(&b.t).then(a.surface.cmp(&b.surface)))
}

/// A face on an edge: met from the side of the edge's cell, at heights where it stands.
fn upright(space: &Space, course: &Course, surface: Surface, edge: EdgeId) -> Option<Met> {
    let border = space.edge(edge.0);
    let crossing = course.leaves(edge.0)?;
    let cell = space.cell(border.cell);
    let stands = face(border, edge.0, crossing.z) == Some(surface)
        && (cell.floor..=cell.ceiling).contains(&crossing.z);
    (stands && crossing.t > 0.0).then_some(Met {
        t: crossing.t,
        surface,
        cell: CellId(border.cell),
    })
}

/// A floor or ceiling: the ray comes over the cell above it (below it) and leaves the cell beyond.
fn flat(space: &Space, course: &Course, surface: Surface, id: CellId, start: Place) -> Option<Met> {
    let cell = space.cell(id.0);
    let edges = cell.first..cell.past;
    let exit = edges.clone().find_map(|e| course.leaves(e));
    let entry = edges.clone().find_map(|e| course.enters(e));
    let z = match exit {
        Some(exit) => exit.z,
        None if id == start.cell => course.z_at_infinity(),
        None => return None,
    };
    let met = course
        .flat(cell, id, z)
        .filter(|met| met.surface == surface)?;
    if id == start.cell {
        return Some(met);
    }
    // It must have been between floor and ceiling when it came in.
    let entry = entry.filter(|entry| entry.t > 0.0)?;
    (cell.floor..=cell.ceiling)
        .contains(&entry.z)
        .then_some(met)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::{DVec2, DVec3};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::cells::{CellGraph, Options, Subdivision, subdivide};
    use crate::level::{Level, doom, read, snap, wad};
    use crate::trace::cast::walk;

    fn random_direction(random: &mut Pcg64Mcg) -> DVec3 {
        loop {
            let v = DVec3::from_array([(); 3].map(|()| random.random_range(-1.0..1.0)));
            if v.length_squared() < 1.0 {
                return v;
            }
        }
    }

    /// Rays from random places, and on from where they end; how many met something.
    fn same_as_walk(level: &Level, graph: &CellGraph, rays: usize) -> usize {
        let space = Space::new(level, graph);
        let surfaces = space.surfaces();
        let mut random = Pcg64Mcg::seed_from_u64(3);
        let mut n_met = 0;
        for _ in 0..rays {
            let id = random.random_range(0..space.cells.len() as u32);
            let cell = space.cell(id);
            let [low, high] = [cell.floor.max(-50.0), cell.ceiling.min(50.0)];
            if low >= high {
                continue;
            }
            let corners: Vec<DVec2> = (cell.first..cell.past)
                .map(|e| space.vertex(space.edge(e).from))
                .collect();
            let weights: Vec<f64> = corners
                .iter()
                .map(|_| random.random_range(0.01..1.0))
                .collect();
            let total: f64 = weights.iter().sum();
            let at: DVec2 = corners
                .iter()
                .zip(&weights)
                .map(|(&p, w)| p * (w / total))
                .sum();
            let mut start = Place {
                cell: CellId(id),
                on: None,
            };
            let mut ray = Ray {
                origin: at.extend(low + (high - low) * random.random_range(0.01..0.99)),
                direction: random_direction(&mut random),
            };
            // The ray and what becomes of it, reflected five times.
            for _ in 0..5 {
                let walked = walk(&space, &ray, start, f64::INFINITY, |_, _| f64::INFINITY);
                let tested = nearest(&space, &surfaces, &ray, start, f64::INFINITY);
                assert_eq!(walked, tested, "{} {start:?} {ray:?}", level.name);
                let Some(met) = walked else { break };
                n_met += 1;
                let normal = space.normal(met.surface);
                ray = Ray {
                    origin: ray.at(met.t),
                    direction: ray.direction - normal * (2.0 * ray.direction.dot(normal)),
                };
                start = Place {
                    cell: met.cell,
                    on: Some(met.surface),
                };
            }
        }
        n_met
    }

    #[test]
    fn the_walk_meets_what_every_surface_in_turn_does() {
        let levels = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
        for name in ["tiny", "museum", "cathedral", "office"] {
            let name = format!("{name}.toml");
            let bytes = std::fs::read(levels.join(&name)).unwrap();
            let level = read::read(bytes, &name, None).unwrap();
            for subdivision in Subdivision::ALL {
                let graph = subdivide(
                    &level,
                    &Options {
                        subdivision,
                        ..Options::default()
                    },
                );
                let met = same_as_walk(&level, &graph, 300);
                assert!(met > 1200, "{name}: {met}");
            }
        }
    }

    /// Needs the Debian package `freedoom`; does nothing without it.
    #[test]
    fn and_so_in_freedoom() {
        let Ok(bytes) = std::fs::read("/usr/share/games/doom/freedoom1.wad") else {
            return;
        };
        let wad = wad::Wad::parse(bytes).unwrap();
        for map in ["E1M1", "E1M5"] {
            let level = snap::snap(doom::read_map(&wad, map, "freedoom1.wad").unwrap()).unwrap();
            for subdivision in Subdivision::ALL {
                let graph = subdivide(
                    &level,
                    &Options {
                        subdivision,
                        ..Options::default()
                    },
                );
                assert!(same_as_walk(&level, &graph, 100) > 140, "{map}");
            }
        }
    }
}
