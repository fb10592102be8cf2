//! Beams, shadows and streams against single rays, bit for bit, from random eyes.

use std::path::Path;

use fearless_simd::{Level as Simds, dispatch};
use glam::{DVec2, DVec3};

use super::*;
use crate::cells::{CellGraph, EdgeId, Locator, Options, Subdivision, subdivide};
use crate::level::{Level, doom, read, snap, wad};
use crate::trace::camera::Camera;
use crate::trace::cast::{Met, Place, entry_of, walk};
use crate::trace::sampling::Source;
use crate::trace::shadow::{self, Lamp};
use crate::trace::stream::{End, Stream};

/// What was compared: pixels, shadow rays of which so many are lit, rays of streams.
#[derive(Debug, Default)]
struct Compared {
    pixels: usize,
    masked: usize,
    shadow_rays: usize,
    lit: usize,
    streamed: usize,
    stopped: usize,
    /// Of the rays of streams, those that were given back where they started, for no reason of ours.
    given_back: usize,
}

/// One of the levels, and its usual cells.
fn sample(name: &str) -> (Level, CellGraph) {
    let levels = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    let file = format!("{name}.toml");
    let bytes = std::fs::read(levels.join(&file)).unwrap();
    let level = read::read(bytes, &file, None).unwrap();
    let graph = subdivide(&level, &Options::default());
    (level, graph)
}

/// A point inside a cell, with a height between its floor and ceiling.
fn inside(space: &Space, graph: &CellGraph, random: &mut Source) -> Option<(DVec3, CellId)> {
    let id = (random.next() * space.cells.len() as f64) as u32;
    let cell = space.cell(id);
    let (low, high) = (cell.floor.max(-50.0), cell.ceiling.min(50.0));
    let (low, high) = match cell.floor.is_finite() {
        true => (cell.floor, cell.ceiling),
        false => (low, high),
    };
    let corners = (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from));
    let plan = corners.sum::<DVec2>() / f64::from(cell.past - cell.first);
    let at = graph.grid.nearest(plan)?;
    let [start] = Locator::new(graph).cells_at(graph, &at.into())[..] else {
        return None;
    };
    let z = low + (high - low) * random.next();
    (low < high && start.0 == id).then(|| (graph.grid.to_level(at).extend(z), start))
}

/// Pictures from random eyes, with lamps and reflected rays.
fn same_as_single_rays(level: &Level, graph: &CellGraph, eyes: u32, size: [u32; 2]) -> Compared {
    let space = Space::new(level, graph);
    let mut random = Source::new(5, 0, 0);
    let mut sum = Compared::default();
    let mut done = 0;
    for _ in 0..50 * eyes {
        let Some((eye, start)) = inside(&space, graph, &mut random) else {
            continue;
        };
        if done == eyes {
            break;
        }
        done += 1;
        let angle = random.next() * 7.0;
        let towards = DVec2::from_angle(angle).extend(random.next() * 2.0 - 1.0);
        let camera = Camera::new(eye, towards, 90.0, size);
        // One at the eye, which lights all that it sees.
        let own = Lamp {
            at: eye,
            cell: start,
        };
        let others = (0..20).filter_map(|_| inside(&space, graph, &mut random));
        let others = others.map(|(at, cell)| Lamp { at, cell });
        let lamps: Vec<Lamp> = std::iter::once(own).chain(others).take(3).collect();
        let tile = 1 + (random.next() * 60.0) as u32;
        let bounced = picture(&space, &camera, start, tile, &lamps, &mut sum);
        streams(&space, &bounced, &mut sum);
    }
    println!("{}: {sum:?}", level.name);
    sum
}

/// One picture, in tiles; the rays that are reflected somehow from what is met.
fn picture(
    space: &Space,
    camera: &Camera,
    start: CellId,
    tile: u32,
    lamps: &[Lamp],
    sum: &mut Compared,
) -> Vec<(Ray, Place)> {
    let (size, fan) = (camera.size, camera.fan());
    let mut times_met = vec![0; (size[0] * size[1]) as usize];
    let mut random = Source::new(6, 0, 0);
    let mut bounced = Vec::new();
    for y in (0..size[1]).step_by(tile as usize) {
        for x in (0..size[0]).step_by(tile as usize) {
            let area = Area {
                x: (x, (x + tile).min(size[0])),
                y: (y, (y + tile).min(size[1])),
            };
            let mut patches = Vec::new();
            cast_patches(space, camera, start, area, |patch, t| {
                patches.push((patch, t.to_vec()));
            });
            let mut portable = Vec::new();
            dispatch!(Simds::baseline(), simd => from_a_point(
                simd, space, &fan, start, area,
                |patch, t| portable.push((patch, t.to_vec())), true,
            ));
            assert!(patches == portable);
            for (patch, t) in &patches {
                sum.masked += usize::from(!patch.mask.is_all());
                let mut again = Vec::new();
                patch.depths(space, camera, &mut again);
                assert!(again[..t.len()] == t[..]);
                let mut t = t.iter();
                each(&patch.area, patch.mask, |x, y, inside| {
                    let t = t.next();
                    if !inside {
                        return;
                    }
                    times_met[(y * size[0] + x) as usize] += 1;
                    let ray = camera.ray(middle(x, y));
                    let place = Place {
                        cell: start,
                        on: None,
                    };
                    let single = walk(space, &ray, place, f64::INFINITY, |_, _| f64::INFINITY);
                    let beam = patch.met.map(|(surface, cell)| Met {
                        t: *t.expect("a t for each pixel"),
                        surface,
                        cell,
                    });
                    assert_eq!(beam, single, "pixel {x} {y} of {camera:?}");
                    sum.pixels += 1;
                    let Some(met) = beam.filter(|met| met.t.is_finite()) else {
                        return;
                    };
                    let aside = DVec3::new(random.next(), random.next(), random.next()) - 0.5;
                    let away = Ray {
                        origin: ray.at(met.t),
                        direction: space.normal(met.surface) + aside * 1.9,
                    };
                    let (cell, on) = (met.cell, Some(met.surface));
                    bounced.push((away, Place { cell, on }));
                });
                for lamp in lamps {
                    shadows(space, camera, patch, lamp, sum);
                }
            }
        }
    }
    assert!(times_met.iter().all(|&n| n == 1), "every pixel once");
    bounced
}

fn shadows(space: &Space, camera: &Camera, patch: &Patch, lamp: &Lamp, sum: &mut Compared) {
    let Some((surface, cell)) = patch.met else {
        return;
    };
    let mut depths = Vec::new();
    patch.depths(space, camera, &mut depths);
    let (mut asked, mut told) = (0, 0);
    each(&patch.area, patch.mask, |_, _, inside| {
        asked += usize::from(inside)
    });
    shadow::patch(space, camera, patch, lamp, |area, mask, blocker| {
        each(&area, mask, |x, y, inside| {
            if !inside {
                return;
            }
            told += 1;
            assert!(patch.mask.has(x - patch.area.x.0, y - patch.area.y.0));
            let row = (y - patch.area.y.0) * patch.area.width();
            let t = depths[(row + x - patch.area.x.0) as usize];
            let point = camera.ray(middle(x, y)).at(t);
            let place = Place {
                cell,
                on: Some(surface),
            };
            let single = shadow::blocker(space, point, place, lamp);
            assert_eq!(
                blocker, single,
                "{x} {y} of {camera:?}, {lamp:?}, on {surface:?}"
            );
            sum.lit += usize::from(single.is_none());
        });
    });
    assert_eq!(asked, told);
    sum.shadow_rays += asked;
}

fn streams(space: &Space, rays: &[(Ray, Place)], sum: &mut Compared) {
    let single: Vec<Option<Met>> = rays
        .iter()
        .map(|(ray, place)| walk(space, ray, *place, f64::INFINITY, |_, _| f64::INFINITY))
        .collect();
    for level in [Simds::new(), Simds::baseline()] {
        let mut stream = Stream::at(level, space);
        // Once all together, then some at a time: what was there before leaves nothing behind.
        for some in [rays.len().max(1), 1000] {
            let mut met = Vec::new();
            for rays in rays.chunks(some) {
                let so_far = met.len();
                stream.cast(rays.iter().copied(), |i, end| {
                    assert_eq!(so_far + i as usize, met.len(), "in order");
                    met.push(match end {
                        End::Meets(met) => Some(met),
                        End::Nothing => None,
                        End::Stops(..) => panic!("stopped, but nothing stops"),
                    });
                });
            }
            assert_eq!(met.len(), rays.len());
            for (i, (met, single)) in met.iter().zip(&single).enumerate() {
                assert_eq!(met, single, "{:?}", rays[i]);
                let bits = |met: &Option<Met>| met.map(|met| met.t.to_bits());
                assert_eq!(bits(met), bits(single), "{:?}", rays[i]);
            }
        }
    }
    sum.streamed += rays.len();
    stops(space, rays, &single, sum);
}

/// The same rays, where every third cell stops them.
fn stops(space: &Space, rays: &[(Ray, Place)], single: &[Option<Met>], sum: &mut Compared) {
    let stops = |cell: CellId| cell.0.is_multiple_of(3);
    let mut stream = Stream::new(space);
    stream.stop(stops);
    stream.cast(rays.iter().copied(), |i, end| {
        let (ray, place) = &rays[i as usize];
        let mut way = Vec::new();
        walk(space, ray, *place, f64::INFINITY, |cell, _| {
            way.push(cell);
            f64::INFINITY
        });
        let first = way.iter().position(|&cell| stops(cell));
        match end {
            End::Stops(cell, entry) if (cell, entry) == (place.cell, entry_of(space, *place)) => {
                sum.given_back += usize::from(!stops(cell));
            }
            End::Stops(cell, entry) => {
                let first = first.unwrap_or_else(|| panic!("{ray:?} comes to no such cell"));
                assert_eq!(way[first], cell, "{ray:?}");
                let entry = space.edge(entry.expect("it has come from elsewhere"));
                assert_eq!(entry.cell, cell.0, "{ray:?}");
                assert_eq!(space.edge(entry.twin).cell, way[first - 1].0, "{ray:?}");
                sum.stopped += 1;
            }
            End::Meets(met) => {
                assert_eq!((first, Some(met)), (None, single[i as usize]), "{ray:?}");
            }
            End::Nothing => panic!("only the caller knows, for {ray:?}"),
        }
    });
}

/// Every pixel of an area, and whether it is in the mask.
fn each(area: &Area, mask: Mask, mut of: impl FnMut(u32, u32, bool)) {
    for y in area.y.0..area.y.1 {
        for x in area.x.0..area.x.1 {
            of(x, y, mask.has(x - area.x.0, y - area.y.0));
        }
    }
}

#[test]
fn all_rays_meet_what_single_rays_do() {
    let levels = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
    for name in ["tiny.toml", "museum.toml", "cathedral.toml", "maze.toml"] {
        let bytes = std::fs::read(levels.join(name)).unwrap();
        let level = read::read(bytes, name, None).unwrap();
        for subdivision in Subdivision::ALL {
            let options = Options {
                subdivision,
                ..Options::default()
            };
            let graph = subdivide(&level, &options);
            let sum = same_as_single_rays(&level, &graph, 6, [120, 75]);
            assert!(sum.pixels > 50_000 && sum.streamed > 50_000, "{sum:?}");
            assert!(sum.stopped > 100, "{sum:?}");
            assert!(sum.given_back * 100 < sum.streamed, "{sum:?}");
            assert!(sum.masked > 100, "{sum:?}");
            assert!(
                sum.lit > 10_000 && sum.lit < sum.shadow_rays * 9 / 10,
                "{sum:?}"
            );
        }
    }
}

/// Rooms of very many corners, and numbers that f64 hardly holds.
#[test]
fn and_so_in_hard_levels() {
    for name in [
        "hard/room-of-10000-edges",
        "hard/far-from-zero",
        "hard/hair-thin-zones",
        "hard/scale-1024",
    ] {
        let (level, graph) = sample(name);
        let sum = same_as_single_rays(&level, &graph, 2, [48, 30]);
        assert!(sum.pixels > 1000, "{name}: {sum:?}");
    }
}

/// Rays past corners at any distance from nothing to a few units, at heights as near to those of
/// floors and ceilings; along walls; straight up; from outside; of any length. In f32 they cannot be
/// told from those on the other side.
#[test]
fn streams_past_corners_and_along_walls() {
    for name in [
        "museum",
        "cathedral",
        "hard/far-from-zero",
        "hard/hair-thin-zones",
        "hard/scale-1024",
    ] {
        let (level, graph) = sample(name);
        let space = Space::new(&level, &graph);
        let mut random = Source::new(6, 0, 0);
        let mut pick = |n: usize| (random.next() * n as f64) as u32;
        let mut rays = Vec::new();
        for _ in 0..20_000 {
            let edge = pick(space.edges.len());
            let border = space.edge(edge);
            let cell = CellId(border.cell);
            let chamber = space.cell(border.cell);
            let finite = |z: f64| if z.is_finite() { z } else { 1.0 };
            let heights = [finite(chamber.floor), finite(chamber.ceiling)];
            let mut near = || f64::from(pick(2001) as i32 - 1000) * 2f64.powi(-(pick(50) as i32));
            let middle = heights[0] + (heights[1] - heights[0]) * near().abs().min(1.0);
            let near = [near(), near(), near()].map(|v| v * 0.002);
            let (a, b) = (space.vertex(border.from), space.vertex(border.to));
            let corners = chamber.past - chamber.first;
            let corner = |k: u32| space.vertex(space.edge(chamber.first + k).from);
            let centre = (0..corners).map(corner).sum::<DVec2>() / f64::from(corners);
            let from = (a + b) / 2.0;
            let far = space.vertex(pick(space.vertices.len()));
            let (target, height) = (
                far.extend(heights[pick(2) as usize]) + DVec3::from_array(near),
                2f64.powi(pick(400) as i32 - 200),
            );
            let (origin, direction, on) = match pick(6) {
                0 | 1 => (centre.extend(middle), target - centre.extend(middle), None),
                2 => {
                    let origin = from.extend(middle);
                    (origin, target - origin, Some(Surface::Wall(EdgeId(edge))))
                }
                3 => {
                    let along = (b - a).extend(near[2]);
                    (a.extend(middle), along, Some(Surface::Wall(EdgeId(edge))))
                }
                4 => (
                    centre.extend(middle),
                    DVec3::new(0.0, 0.0, near[0].signum()),
                    None,
                ),
                _ => {
                    let origin = (centre * 3.0).extend(middle);
                    (origin, target - origin, None)
                }
            };
            let direction = direction * height;
            rays.push((Ray { origin, direction }, Place { cell, on }));
        }
        let mut sum = Compared::default();
        streams(&space, &rays, &mut sum);
        assert_eq!(sum.streamed, rays.len());
    }
}

/// Rays along edges that were cut: their corners lie within roundings of the ray, on any side of it. One
/// in some hundreds of these went from cell to cell about such a corner, and never came to an end.
#[test]
fn no_ray_goes_in_circles() {
    for name in ["museum", "hard/circle-pillar", "hard/pinwheel-apart"] {
        let (level, graph) = sample(name);
        let space = Space::new(&level, &graph);
        let locator = Locator::new(&graph);
        let mut random = Source::new(8, 0, 0);
        let (mut rays, mut shadows) = (Vec::new(), 0);
        for _ in 0..40_000 {
            let edge = (random.next() * space.edges.len() as f64) as u32;
            let border = space.edge(edge);
            let (a, b) = (space.vertex(border.from), space.vertex(border.to));
            let chamber = space.cell(border.cell);
            let z = (chamber.floor + chamber.ceiling) / 2.0;
            // From one end or from a point between, exactly along the edge or as nearly as can be.
            let from = a + (b - a) * (random.next() - 0.5).max(0.0);
            let off =
                (random.next() - 0.5).max(0.0) * 2f64.powi(-(40.0 + random.next() * 20.0) as i32);
            let ray = Ray {
                origin: from.extend(z),
                direction: (b - a + off).extend(0.0),
            };
            let start = Place {
                cell: CellId(border.cell),
                on: Some(Surface::Wall(EdgeId(edge))),
            };
            rays.push((ray, start));
            // A lamp on the same line, beyond the edge.
            let lamp = ray.origin + ray.direction * (1.0 + 3.0 * random.next());
            let cells = graph
                .grid
                .fine(lamp.truncate())
                .map(|p| locator.cells_at(&graph, &p));
            for cell in cells.into_iter().flatten() {
                _ = shadow::blocker(&space, ray.origin, start, &Lamp { at: lamp, cell });
                shadows += 1;
            }
        }
        // All rays of these pictures differ by roundings only.
        for (ray, start) in &rays[..400] {
            let camera = Camera::new(ray.origin, ray.direction, 1e-12, [16, 16]);
            picture(
                &space,
                &camera,
                start.cell,
                16,
                &[],
                &mut Compared::default(),
            );
        }
        let met = |(ray, start): &(Ray, Place)| {
            walk(&space, ray, *start, f64::INFINITY, |_, _| f64::INFINITY)
        };
        let lost = rays.iter().filter(|ray| met(ray).is_none()).count();
        assert_eq!(lost, 0, "{name}");
        assert!(shadows > 10_000, "{name}: {shadows}");
        streams(&space, &rays, &mut Compared::default());
    }
}

/// Needs the Debian package `freedoom`; does nothing without it.
#[test]
fn and_so_in_freedoom() {
    let Ok(bytes) = std::fs::read("/usr/share/games/doom/freedoom1.wad") else {
        return;
    };
    let wad = wad::Wad::parse(bytes).unwrap();
    for map in ["E1M1", "E1M2", "E1M3"] {
        let level = snap::snap(doom::read_map(&wad, map, "freedoom1.wad").unwrap()).unwrap();
        let graph = subdivide(&level, &Options::default());
        let sum = same_as_single_rays(&level, &graph, 8, [240, 150]);
        assert!(sum.pixels > 200_000 && sum.lit > 200_000, "{sum:?}");
    }
}
