//! Random free segments in space: the cells that one passes through see each other.
//!
//! A segment that is free on the plan crosses from cell to cell. There it has to keep between the
//! higher floor and the lower ceiling of the two sectors, moved out of the way as far as they go, and
//! within the heights of the openings that stand there: all taken from the level, not from the
//! portals of the graph. A segment that may touch any of them, within rounding, counts as stopped.
//! What lies between two such stops is free.

use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::sight::{Caster, Way};
use super::walls::Walls;
use super::{Failure, Verified, VerifyOptions};
use crate::cells::EdgeId;
use crate::geom::{GridPoint, Interval, Span};
use crate::level::{Level, WallKind};
use crate::pvs::Progress;
use crate::pvs::file::PvsFile;

/// Segments on the plan that one chunk of work tries.
const CHUNK: u64 = 4096;
/// Lines in space tried above one segment on the plan.
const LINES: usize = 6;

/// Casts the segments.
pub(super) fn check(
    file: &PvsFile,
    level: &Level,
    walls: &Walls,
    outer: &[bool],
    options: &VerifyOptions,
    progress: &Progress,
    done: &mut Verified,
) -> Result<(), Failure> {
    if file.graph.cells.is_empty() {
        return Ok(());
    }
    let space = Space {
        file,
        level,
        walls,
        caster: Caster::new(file, walls, outer),
    };
    let chunks: Vec<Result<[u64; 3], Failure>> = (0..options.segments.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let seed = options.seed.wrapping_mul(2).wrapping_add(1 + (chunk << 32));
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let n = CHUNK.min(options.segments - chunk * CHUNK);
            let mut counts = [0; 3];
            let mut room = Room::default();
            for _ in 0..n {
                space.cast(&mut rng, &mut room, &mut counts)?;
            }
            progress.advance(n as usize);
            Ok(counts)
        })
        .collect();
    for counts in chunks {
        let [free, discarded, met] = counts?;
        done.free += free;
        done.discarded += discarded;
        done.met += met;
    }
    Ok(())
}

/// A crossing from one cell to the next.
struct Border {
    /// Where it is, as a share of the segment.
    at: Interval,
    /// Above what the segment must be, and below what.
    bottom: f64,
    top: f64,
}

/// What one segment needs; kept to be used again.
#[derive(Default)]
struct Room {
    way: Way,
    borders: Vec<Border>,
    openings: Vec<u32>,
}

struct Space<'a> {
    file: &'a PvsFile,
    level: &'a Level,
    walls: &'a Walls,
    caster: Caster<'a>,
}

impl Space<'_> {
    /// Tries one segment on the plan and some lines above it; counts free ones, others, and pairs of
    /// cells met.
    fn cast(
        &self,
        rng: &mut Pcg64Mcg,
        room: &mut Room,
        counts: &mut [u64; 3],
    ) -> Result<(), Failure> {
        let plan = self.caster.segment(rng, &mut room.way)?;
        let Some((from, to)) = plan.filter(|&(from, to)| self.find_borders(from, to, room)) else {
            counts[1] += 1;
            return Ok(());
        };
        for _ in 0..LINES {
            let z = aim(rng, &room.borders);
            let met = self.meet([from, to], z, room)?;
            counts[usize::from(met == 0)] += 1;
            counts[2] += met;
        }
        Ok(())
    }

    /// The borders that the segment crosses. False if there are none, or something is unclear.
    fn find_borders(&self, from: GridPoint, to: GridPoint, room: &mut Room) -> bool {
        let Room {
            way,
            borders,
            openings,
        } = room;
        borders.clear();
        for (cells, &exit) in way.path.windows(2).zip(&way.exits) {
            let mut border = Border {
                at: self.crossing(from, to, exit),
                bottom: f64::NEG_INFINITY,
                top: f64::INFINITY,
            };
            for &cell in cells {
                let sector = self.file.graph.cell(cell).sector;
                if let Some(sector) = sector.and_then(|s| self.level.sectors.get(s.0 as usize)) {
                    border.bottom = border.bottom.max(sector.floor.low);
                    border.top = border.top.min(sector.ceiling.high);
                }
            }
            borders.push(border);
        }
        self.walls.openings.touching(from, to, openings);
        for &i in &*openings {
            let stretch = &self.walls.openings.list[i as usize];
            let WallKind::Opening(opening) = &self.level.walls[stretch.wall.0 as usize].kind else {
                continue;
            };
            let at = share(&[stretch.from, stretch.to].map(known), from, to);
            let here = |border: &&mut Border| border.at.lo <= at.hi && at.lo <= border.at.hi;
            let mut anywhere = false;
            for border in borders.iter_mut().filter(here) {
                border.bottom = border
                    .bottom
                    .max(opening.bottom.unwrap_or(f64::NEG_INFINITY));
                border.top = border.top.min(opening.top.unwrap_or(f64::INFINITY));
                anywhere = true;
            }
            if !anywhere {
                return false;
            }
        }
        !borders.is_empty()
    }

    /// Where a segment crosses an edge.
    fn crossing(&self, from: GridPoint, to: GridPoint, edge: EdgeId) -> Interval {
        let graph = &self.file.graph;
        let ends = [graph.edge(edge).origin, graph.end(edge)];
        let error = graph.vertices.error();
        share(&ends.map(|v| (graph.vertices.approx(v), error)), from, to)
    }

    /// The pairs of cells between which a segment is free; `z` is its height at both ends.
    fn meet(
        &self,
        ends: [GridPoint; 2],
        z: [f64; 2],
        Room { way, borders, .. }: &Room,
    ) -> Result<u64, Failure> {
        let rise = Interval::point(z[1]) - Interval::point(z[0]);
        let passes = |border: &Border| {
            let z = Interval::point(z[0]) + border.at * rise;
            border.bottom < z.lo && z.hi < border.top
        };
        let mut met = 0;
        let mut first = 0;
        for (k, border) in borders.iter().enumerate() {
            if !passes(border) {
                first = k + 1;
                continue;
            }
            // The cell behind this border, with all from which the segment comes without a stop.
            let b = way.path[k + 1];
            for (i, &a) in way.path.iter().enumerate().take(k + 1).skip(first) {
                if !self.file.pvs.sees(a, b) {
                    let [from, to] = [i, k].map(|border| self.place(ends, z, &borders[border]));
                    return Err(Failure::MissedInSpace { a, b, from, to });
                }
                met += 1;
            }
        }
        Ok(met)
    }

    /// Where a segment crosses a border, about, in the level's own coordinates.
    fn place(&self, [from, to]: [GridPoint; 2], z: [f64; 2], border: &Border) -> DVec3 {
        let at = (border.at.lo + border.at.hi) / 2.0;
        let on_plan = known(from).0.lerp(known(to).0, at);
        let grid = &self.file.graph.grid;
        grid.offset_to_level(on_plan.x, on_plan.y)
            .extend(z[0] + at * (z[1] - z[0]))
    }
}

/// A grid point, which is known without error.
fn known(p: GridPoint) -> (DVec2, f64) {
    (DVec2::new(p.x as f64, p.y as f64), 0.0)
}

/// Where a segment crosses a line, as a share of the segment: between 0 and 1, or anything if that is
/// unclear.
fn share(line: &[(DVec2, f64); 2], from: GridPoint, to: GridPoint) -> Interval {
    let along = Span::new(line[0], line[1]);
    let beyond = |p: GridPoint| along.cross(Span::new(line[0], known(p)));
    let (mut behind, mut beyond) = (beyond(from), -beyond(to));
    if behind.is_negative() {
        (behind, beyond) = (-behind, -beyond);
    }
    let whole = behind + beyond;
    if behind.lo >= 0.0 && beyond.lo >= 0.0 && whole.is_positive() {
        behind.over_positive(whole)
    } else {
        Interval { lo: 0.0, hi: 1.0 }
    }
}

/// Heights at both ends of a segment: of a line through two places on its borders, most often close to
/// a bottom or a top.
fn aim(rng: &mut Pcg64Mcg, borders: &[Border]) -> [f64; 2] {
    let i = rng.random_range(0..borders.len());
    // Near or far from the first.
    let reach = (borders.len() as f64).powf(rng.random::<f64>()) as usize;
    let j = (i + rng.random_range(0..=reach)).min(borders.len() - 1);
    let place = |rng: &mut Pcg64Mcg, border: &Border| {
        let (bottom, top) = match (border.bottom.is_finite(), border.top.is_finite()) {
            (true, true) => (border.bottom, border.top),
            (true, false) => (border.bottom, border.bottom + 1.0),
            (false, true) => (border.top - 1.0, border.top),
            (false, false) => (-1.0, 1.0),
        };
        let share = match rng.random_range(0..3) {
            0 => rng.random::<f64>(),
            1 => 0.5f64.powi(rng.random_range(1..24)),
            _ => 1.0 - 0.5f64.powi(rng.random_range(1..24)),
        };
        let at = (border.at.lo + border.at.hi) / 2.0;
        (at, bottom + (top - bottom) * share)
    };
    let (s, z) = place(rng, &borders[i]);
    let (t, y) = place(rng, &borders[j]);
    let rise = if t > s { (y - z) / (t - s) } else { y - z };
    [z - s * rise, z + (1.0 - s) * rise]
}
