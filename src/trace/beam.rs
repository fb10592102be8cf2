//! Many rays from one point at once: what a whole rectangle of a picture meets.
//!
//! In: a [`Space`], a point, and directions that change linearly over a rectangle of pixels. Out:
//! for every pixel the same [`Met`] that [`super::cast::walk`] gives, to the last bit.
//!
//! On which side of a corner a ray passes on the plan, and whether it passes above or below a height
//! on an edge's line, are signs of expressions that are linear in the ray's direction. So if they
//! are the same at the four corners of a rectangle, they are the same in all of it: the corners'
//! rays leave a cell by the same portal, or end on the same surface, and so do all rays between.
//! Where they differ the rectangle is halved, and goes on in the cell where it is. A sign counts
//! only where it is larger than what rounding can have done, in the corners and between; single
//! pixels go on as single rays. So speed never changes a picture.

use glam::{DVec2, DVec3};

use super::cast::{Met, Place, walk_on};
use super::ray::Ray;
use super::space::{Chamber, Space, Surface, WALL};
use crate::cells::{CellId, EdgeId};

/// Rays from one point, one for every pixel of a picture.
pub trait Bundle {
    /// The point.
    fn origin(&self) -> DVec3;
    /// The direction through a place of the picture, in pixels from its upper left corner. Linear in
    /// the place, but for rounding of the last bits.
    fn direction(&self, at: DVec2) -> DVec3;
}

/// A rectangle of pixels: columns `x.0..x.1`, rows `y.0..y.1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Area {
    /// First column, and one past the last.
    pub x: (u32, u32),
    /// First row, and one past the last.
    pub y: (u32, u32),
}

impl Area {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        (self.x.1 - self.x.0) as usize * (self.y.1 - self.y.0) as usize
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The middle of a pixel.
pub fn middle(x: u32, y: u32) -> DVec2 {
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)
}

/// Four numbers, one for each corner of a rectangle.
type Four = [f64; 4];

/// Where a rectangle's rays have come to.
#[derive(Clone, Copy)]
struct At {
    area: Area,
    cell: u32,
    /// The edge through which they came.
    entry: Option<u32>,
}

/// What the rays of a rectangle do at the end of a cell.
enum Fate {
    /// All go on through this edge.
    Through(u32),
    /// All end here.
    Ends(Surface),
    /// They part, or it is not certain that they do not.
    Parts,
}

/// What every pixel's ray meets, of those of `area`; `out` is told the pixels in rectangles: each
/// with one surface, seen from one cell, and the `t` of its rays, row after row; or a single pixel
/// that meets nothing. `start` is the cell of the origin.
pub fn cast(
    space: &Space,
    bundle: &impl Bundle,
    start: CellId,
    area: Area,
    mut out: impl FnMut(Area, Option<(Surface, CellId)>, &[f64]),
) {
    let mut pending = vec![At {
        area,
        cell: start.0,
        entry: None,
    }];
    let mut depths = Vec::new();
    while let Some(mut at) = pending.pop() {
        if at.area.is_empty() {
            continue;
        }
        let corners = corners(bundle, &at.area);
        loop {
            if at.area.len() == 1 {
                single(space, bundle, &at, &mut out);
                break;
            }
            match fate(space, bundle.origin(), &corners, &at) {
                Fate::Through(edge) => {
                    let twin = space.edge(edge).twin;
                    (at.cell, at.entry) = (space.edge(twin).cell, Some(twin));
                }
                Fate::Ends(surface) => {
                    depths.clear();
                    fill(space, bundle, &at.area, surface, &mut depths);
                    out(at.area, Some((surface, CellId(at.cell))), &depths);
                    break;
                }
                Fate::Parts => {
                    pending.extend(halves(&at.area).map(|area| At { area, ..at }));
                    break;
                }
            }
        }
    }
}

/// Directions through the middles of the corner pixels.
fn corners(bundle: &impl Bundle, area: &Area) -> [DVec3; 4] {
    let (x, y) = ([area.x.0, area.x.1 - 1], [area.y.0, area.y.1 - 1]);
    [
        middle(x[0], y[0]),
        middle(x[1], y[0]),
        middle(x[0], y[1]),
        middle(x[1], y[1]),
    ]
    .map(|at| bundle.direction(at))
}

/// The two halves of a rectangle, across its longer side; the first is to be looked at last.
fn halves(area: &Area) -> [Area; 2] {
    let Area { x, y } = *area;
    if x.1 - x.0 >= y.1 - y.0 {
        let middle = x.0.midpoint(x.1);
        [
            Area {
                x: (middle, x.1),
                y,
            },
            Area {
                x: (x.0, middle),
                y,
            },
        ]
    } else {
        let middle = y.0.midpoint(y.1);
        [
            Area {
                x,
                y: (middle, y.1),
            },
            Area {
                x,
                y: (y.0, middle),
            },
        ]
    }
}

/// The one ray of a pixel, from where its rectangle has come to.
fn single(
    space: &Space,
    bundle: &impl Bundle,
    at: &At,
    out: &mut impl FnMut(Area, Option<(Surface, CellId)>, &[f64]),
) {
    let ray = Ray {
        origin: bundle.origin(),
        direction: bundle.direction(middle(at.area.x.0, at.area.y.0)),
    };
    let met = walk_on(space, &ray, CellId(at.cell), at.entry);
    match met {
        Some(Met { t, surface, cell }) => out(at.area, Some((surface, cell)), &[t]),
        None => out(at.area, None, &[]),
    }
}

/// What a sign says of a rectangle.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sign {
    Positive,
    Negative,
    Unsure,
}

/// The sign that all four have for certain. `bound` is more than rounding can make of a zero.
#[inline]
fn sign(values: &Four, bound: f64) -> Sign {
    if values.iter().all(|&v| v > bound) {
        Sign::Positive
    } else if values.iter().all(|&v| v < -bound) {
        Sign::Negative
    } else {
        Sign::Unsure
    }
}

/// Rounding of a sum of two products of a direction and a position, including that of the direction
/// itself (three roundings) and of the differences: less than 16 units in the last place of the
/// largest product.
const ROUNDING: f64 = 1.0 / (1u64 << 48) as f64;

#[inline]
fn fate(space: &Space, origin: DVec3, d: &[DVec3; 4], at: &At) -> Fate {
    let cell = space.cell(at.cell);
    let reach = d
        .iter()
        .fold(0.0f64, |m, d| m.max(d.x.abs()).max(d.y.abs()));
    let o = origin.truncate();
    let side = |v: u32| -> (Four, f64) {
        let to = space.vertex(v) - o;
        let bound = ROUNDING * reach * (to.x.abs() + to.y.abs() + o.x.abs() + o.y.abs());
        (d.map(|d| d.x * to.y - d.y * to.x), bound)
    };
    let (mut edge, n) = match at.entry {
        Some(entry) => (space.next(cell, entry), cell.past - cell.first - 1),
        None => (cell.first, cell.past - cell.first),
    };
    let (mut from, bound) = side(space.edge(edge).from);
    let mut from_sign = sign(&from, bound);
    for _ in 0..n {
        let (to, bound) = side(space.edge(edge).to);
        let to_sign = sign(&to, bound);
        match (from_sign, to_sign) {
            (Sign::Negative, Sign::Positive) => {
                return at_edge(space, origin, d, cell, at.cell, edge, &from, &to);
            }
            (_, Sign::Unsure) if at.entry.is_some() => return Fate::Parts,
            _ => {}
        }
        (from, from_sign) = (to, to_sign);
        edge = space.next(cell, edge);
    }
    Fate::Parts
}

/// What the rays do that leave the cell through this edge on the plan.
#[inline]
#[allow(clippy::too_many_arguments)]
fn at_edge(
    space: &Space,
    origin: DVec3,
    d: &[DVec3; 4],
    cell: &Chamber,
    id: u32,
    edge: u32,
    from: &Four,
    to: &Four,
) -> Fate {
    let border = space.edge(edge);
    let o = origin.truncate();
    let (a, b) = (space.vertex(border.from) - o, space.vertex(border.to) - o);
    let across = a.x * b.y - a.y * b.x;
    // Whether the ray passes above a height on the edge: z - height has the sign of
    // across·dz - (height - oz)·(to - from), as `to - from` is positive.
    let size = a.abs().max_element().max(b.abs().max_element()) + o.abs().max_element();
    let above = |height: f64| -> Sign {
        let rise = height - origin.z;
        let values: Four = std::array::from_fn(|k| across * d[k].z - rise * (to[k] - from[k]));
        let reach = d.iter().fold(0.0f64, |m, d| m.max(d.abs().max_element()));
        let scale = size * reach * (size + height.abs() + origin.z.abs());
        sign(&values, ROUNDING * 8.0 * scale)
    };
    let unbounded = |height: f64| height.is_infinite();
    // Infinite heights have no sign to ask.
    let above = |height: f64| {
        if !unbounded(height) {
            above(height)
        } else if height < 0.0 {
            Sign::Positive
        } else {
            Sign::Negative
        }
    };
    let id = CellId(id);
    let end = |surface| Fate::Ends(surface);
    match above(cell.floor) {
        Sign::Negative => return end(Surface::Floor(id)),
        Sign::Unsure => return Fate::Parts,
        Sign::Positive => {}
    }
    match above(cell.ceiling) {
        Sign::Positive => return end(Surface::Ceiling(id)),
        Sign::Unsure => return Fate::Parts,
        Sign::Negative => {}
    }
    if border.twin == WALL {
        let wall = end(Surface::Wall(EdgeId(edge)));
        if !border.outside {
            return wall;
        }
        return match (above(border.bottom), above(border.top)) {
            (Sign::Negative, _) | (_, Sign::Positive) => wall,
            (Sign::Positive, Sign::Negative) => end(Surface::Outside(EdgeId(edge))),
            _ => Fate::Parts,
        };
    }
    if border.bottom > cell.floor {
        match above(border.bottom) {
            Sign::Negative => return end(Surface::Step(EdgeId(edge))),
            Sign::Unsure => return Fate::Parts,
            Sign::Positive => {}
        }
    }
    if border.top < cell.ceiling {
        match above(border.top) {
            Sign::Positive => return end(Surface::Lintel(EdgeId(edge))),
            Sign::Unsure => return Fate::Parts,
            Sign::Negative => {}
        }
    }
    if border.pane.is_some() {
        return end(Surface::Pane(EdgeId(edge)));
    }
    Fate::Through(edge)
}

/// How far each ray of a rectangle goes to a surface that all meet.
fn fill(space: &Space, bundle: &impl Bundle, area: &Area, surface: Surface, depths: &mut Vec<f64>) {
    let origin = bundle.origin();
    let o = origin.truncate();
    let each = |depths: &mut Vec<f64>, depth: &dyn Fn(DVec3) -> f64| {
        for y in area.y.0..area.y.1 {
            depths.extend((area.x.0..area.x.1).map(|x| depth(bundle.direction(middle(x, y)))));
        }
    };
    match surface {
        Surface::Floor(id) => {
            let rise = space.cell(id.0).floor - origin.z;
            each(depths, &|d| (rise / d.z).max(0.0));
        }
        Surface::Ceiling(id) => {
            let rise = space.cell(id.0).ceiling - origin.z;
            each(depths, &|d| (rise / d.z).max(0.0));
        }
        Surface::Wall(e)
        | Surface::Step(e)
        | Surface::Lintel(e)
        | Surface::Pane(e)
        | Surface::Outside(e) => {
            let edge = space.edge(e.0);
            let (a, b) = (space.vertex(edge.from) - o, space.vertex(edge.to) - o);
            let across = a.x * b.y - a.y * b.x;
            each(depths, &|d| {
                let to = d.x * b.y - d.y * b.x;
                let from = d.x * a.y - d.y * a.x;
                (across / (to - from)).max(0.0)
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::time::Instant;

    use super::*;
    use crate::cells::{CellGraph, Locator, Options, subdivide};
    use crate::level::{Level, doom, read, snap, wad};
    use crate::trace::camera::Camera;
    use crate::trace::cast::walk;
    use crate::trace::sampling::Source;

    /// Pictures from random eyes, by beams and ray by ray; the pixels compared.
    fn same_as_single_rays(level: &Level, graph: &CellGraph, eyes: u32, size: [u32; 2]) -> usize {
        let space = Space::new(level, graph);
        let locator = Locator::new(graph);
        let mut random = Source::new(5, 0, 0);
        let (mut pixels, mut times) = (0, [0.0; 2]);
        for _ in 0..eyes {
            let id = (random.next() * space.cells.len() as f64) as u32;
            let cell = space.cell(id);
            if cell.floor >= cell.ceiling {
                continue;
            }
            let first = space.vertex(space.edge(cell.first).from);
            let sum: DVec2 = (cell.first..cell.past)
                .map(|e| space.vertex(space.edge(e).from) - first)
                .sum();
            let plan = first + sum / f64::from(cell.past - cell.first);
            let z = cell.floor + (cell.ceiling - cell.floor) * random.next();
            let angle = random.next() * 7.0;
            let Some(at) = graph.grid.nearest(plan) else {
                continue;
            };
            let plan = graph.grid.to_level(at);
            let [start] = locator.cells_at(graph, &at.into())[..] else {
                continue;
            };
            let towards = DVec2::from_angle(angle).extend(random.next() - 0.5);
            let camera = Camera::new(plan.extend(z), towards, 90.0, size);
            let area = Area {
                x: (0, size[0]),
                y: (0, size[1]),
            };
            let mut hits = vec![None; area.len()];
            let now = Instant::now();
            let tile = 16;
            for y in (0..size[1]).step_by(tile) {
                for x in (0..size[0]).step_by(tile) {
                    let area = Area {
                        x: (x, (x + tile as u32).min(size[0])),
                        y: (y, (y + tile as u32).min(size[1])),
                    };
                    cast(&space, &camera, start, area, |area, met, depths| {
                        let Some((surface, cell)) = met else { return };
                        let mut depths = depths.iter();
                        for y in area.y.0..area.y.1 {
                            for x in area.x.0..area.x.1 {
                                let t = *depths.next().unwrap();
                                hits[(y * size[0] + x) as usize] = Some(Met { t, surface, cell });
                            }
                        }
                    });
                }
            }
            times[0] += now.elapsed().as_secs_f64();
            let now = Instant::now();
            let place = Place {
                cell: start,
                on: None,
            };
            let single: Vec<Option<Met>> = (0..area.len() as u32)
                .map(|i| {
                    let ray = camera.ray(middle(i % size[0], i / size[0]));
                    walk(&space, &ray, place, f64::INFINITY, |_, _| f64::INFINITY)
                })
                .collect();
            times[1] += now.elapsed().as_secs_f64();
            for (i, (beam, single)) in hits.iter().zip(&single).enumerate() {
                assert_eq!(beam, single, "{}: pixel {i} of {camera:?}", level.name);
            }
            pixels += area.len();
        }
        let rate = times.map(|t| pixels as f64 / t / 1e6);
        println!(
            "{}: {:.0} million rays a second by beams, {:.0} ray by ray",
            level.name, rate[0], rate[1]
        );
        pixels
    }

    #[test]
    fn beams_meet_what_single_rays_do() {
        let levels = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels");
        for name in ["tiny.toml", "museum.toml", "cathedral.toml", "maze.toml"] {
            let bytes = std::fs::read(levels.join(name)).unwrap();
            let level = read::read(bytes, name, None).unwrap();
            let graph = subdivide(&level, &Options::default());
            assert!(same_as_single_rays(&level, &graph, 12, [160, 100]) > 100_000);
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
            assert!(same_as_single_rays(&level, &graph, 16, [320, 200]) > 500_000);
        }
    }
}
