//! Inside and outside, asked of the level's own walls: no ground is lost, and none is covered twice.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use super::walls::{Stretch, Walls};
use super::{Failure, Verified, VerifyOptions};
use crate::cells::{CellId, EdgeId, Locator};
use crate::geom::{GridPoint, Side, Vertex, orient};
use crate::level::{Interior, Level, OutlineId, SectorId};
use crate::pvs::file::PvsFile;

/// Points that one chunk of work tries.
const CHUNK: u64 = 4096;
/// Steps of [`Ground::explore`].
const STEPS: usize = 2000;
/// Points tried beyond each edge that faces the outside without an opaque wall.
const BEYOND: usize = 16;

/// What the walls say about a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    Inside(Option<SectorId>),
    Outside,
    /// They contradict each other, or do not say.
    Contested,
}

/// Tries random points, half of them beside corners of cells, and looks beyond the `outer` edges.
pub(super) fn check(
    file: &PvsFile,
    level: &Level,
    walls: &Walls,
    outer: &[bool],
    options: &VerifyOptions,
    done: &mut Verified,
) -> Result<(), Failure> {
    if file.graph.cells.is_empty() || level.walls.is_empty() {
        return Ok(());
    }
    let ground = Ground {
        file,
        level,
        walls,
        rays: [0, 1, 2, 3].map(|turn| Ray::new(walls, turn)),
    };
    let locator = Locator::new(&file.graph);
    let chunks: Vec<Result<[u64; 3], Failure>> = (0..options.points.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut rng =
                Pcg64Mcg::seed_from_u64(options.seed.wrapping_mul(2).wrapping_add(chunk << 32));
            let n = CHUNK.min(options.points - chunk * CHUNK);
            let mut counts = [0; 3];
            for _ in 0..n {
                let point = ground.random_point(&mut rng);
                if let Some(kind) = ground.check_point(&locator, point, &mut rng)? {
                    counts[kind] += 1;
                }
            }
            Ok(counts)
        })
        .collect();
    for counts in chunks {
        let [inside, outside, contested] = counts?;
        done.inside += inside;
        done.outside += outside;
        done.contested += contested;
    }
    let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
    for edge in (0u32..)
        .map(EdgeId)
        .zip(outer)
        .filter_map(|(e, outer)| outer.then_some(e))
    {
        ground.look_beyond(&locator, edge, &mut rng)?;
    }
    Ok(())
}

struct Ground<'a> {
    file: &'a PvsFile,
    level: &'a Level,
    walls: &'a Walls,
    rays: [Ray; 4],
}

impl Ground<'_> {
    fn random_point(&self, rng: &mut Pcg64Mcg) -> GridPoint {
        let (low, high) = self.walls.all.extent();
        if rng.random_bool(0.5) {
            return GridPoint::new(
                rng.random_range(low.x..=high.x),
                rng.random_range(low.y..=high.y),
            );
        }
        let vertices = &self.file.graph.vertices;
        let v = crate::geom::VertexId(rng.random_range(0..vertices.len() as u32));
        let p = vertices.approx(v);
        let spread = rng.random_range(1..=16);
        let mut near = |at: f64| at as i64 + rng.random_range(-spread..=spread);
        GridPoint::new(near(p.x), near(p.y))
    }

    /// 0 for a point inside, 1 for one outside, 2 for a contested one; `None` on a border.
    fn check_point(
        &self,
        locator: &Locator,
        point: GridPoint,
        rng: &mut Pcg64Mcg,
    ) -> Result<Option<usize>, Failure> {
        let graph = &self.file.graph;
        let exact: Vertex = point.into();
        let cells = locator.cells_at(graph, &exact);
        let within = |&cell: &CellId| {
            let mut edges = graph.edge_range(cell).map(EdgeId);
            edges.all(|e| {
                let (p, q) = (graph.edge(e).origin, graph.end(e));
                orient(graph.vertices.exact(p), graph.vertices.exact(q), &exact) == Side::Left
            })
        };
        let holder = cells.iter().copied().find(|c| within(c));
        if let (Some(a), Some(&b)) = (holder, cells.iter().find(|&&c| Some(c) != holder)) {
            return Err(Failure::Twice(point, a, b));
        }
        if (holder.is_none() && !cells.is_empty()) || self.walls.all.touched(point, point) {
            return Ok(None);
        }
        let mut word = self.ask(point);
        let agrees = |word| match (word, holder) {
            (Word::Inside(_), Some(_)) | (Word::Outside, None) => true,
            (Word::Contested, _) | (Word::Inside(_), None) | (Word::Outside, Some(_)) => false,
        };
        let mut contested = false;
        match &self.level.interior {
            _ if agrees(word) => {}
            Interior::Outlines => {}
            // Cells whose borders all lie on walls are enclosed; and where there are start points,
            // ground without cells need only be out of reach.
            Interior::Enclosed { .. } if word == Word::Contested && holder.is_some() => {
                word = Word::Inside(None);
            }
            Interior::Enclosed { starts } if word == Word::Contested && !starts.is_empty() => {
                return Ok(Some(2));
            }
            // Walls around one place may contradict each other; what can be reached decides.
            _ => {
                contested = true;
                word = self.explore(point, rng);
                if word == Word::Contested {
                    return Ok(Some(2));
                }
            }
        }
        match (word, holder) {
            (Word::Inside(_), None) => Err(Failure::Lost(point)),
            (Word::Outside, Some(cell)) => Err(Failure::Outside(point, cell)),
            (Word::Inside(sector), Some(cell)) => {
                let found = graph.cell(cell);
                let named =
                    sector.is_none_or(|s| found.sector == Some(s) || found.also.contains(&s));
                if named {
                    Ok(Some(if contested { 2 } else { 0 }))
                } else {
                    Err(Failure::Sector(point, cell))
                }
            }
            _ => Ok(Some(if contested { 2 } else { 1 })),
        }
    }

    /// Finds points close behind an edge (on the same ground as the edge's far side, as no wall
    /// but those on the edge's own line lies between), which must not be inside the level.
    fn look_beyond(
        &self,
        locator: &Locator,
        edge: EdgeId,
        rng: &mut Pcg64Mcg,
    ) -> Result<(), Failure> {
        let graph = &self.file.graph;
        let ends = [graph.edge(edge).origin, graph.end(edge)];
        let [p, q] = ends.map(|v| graph.vertices.approx(v));
        let [exact_p, exact_q] = ends.map(|v| graph.vertices.exact(v));
        for _ in 0..BEYOND {
            let at = p.lerp(q, rng.random::<f64>());
            let mut near = |at: f64| at.round() as i64 + rng.random_range(-2..=2);
            let [near_side, far_side] = [(); 2].map(|()| GridPoint::new(near(at.x), near(at.y)));
            let side = |point: GridPoint| orient(exact_p, exact_q, &point.into());
            if side(near_side) != Side::Left || side(far_side) != Side::Right {
                continue;
            }
            // Through the edge itself, and through nothing else.
            let through = [Side::Left, Side::Right].map(|s| {
                let (from, to) = (near_side.into(), far_side.into());
                orient(&from, &to, if s == Side::Left { exact_q } else { exact_p }) == s
            });
            let on_edge = |s: &Stretch| side(s.from) == Side::On && side(s.to) == Side::On;
            if through != [true; 2] || !self.walls.all.touched_only(near_side, far_side, on_edge) {
                continue;
            }
            let word = match self.ask(far_side) {
                Word::Outside => Word::Outside,
                _ => self.explore(far_side, rng),
            };
            let covered = !locator.cells_at(graph, &far_side.into()).is_empty();
            if covered || matches!(word, Word::Inside(_)) {
                return Err(Failure::NoWall(edge));
            }
            return Ok(());
        }
        Ok(())
    }

    /// What the walls that rays from the point meet say about it.
    fn ask(&self, point: GridPoint) -> Word {
        match &self.level.interior {
            Interior::Sides => {
                let answers = self
                    .rays
                    .each_ref()
                    .map(|ray| ray.sector(self.level, self.walls, point));
                if answers.contains(&None) {
                    return Word::Outside;
                }
                let [a, b, c, d] = answers.map(Option::flatten);
                match a {
                    _ if (a, b) != (b, c) || c != d => Word::Contested,
                    Some(_) => Word::Inside(a),
                    None => Word::Outside,
                }
            }
            Interior::Outlines => {
                let around = self.rays[0].outlines(self.level, self.walls, point);
                let outline = |id: &OutlineId| &self.level.outlines[id.0 as usize];
                let decides = around.iter().map(outline).rfind(|o| !o.zone);
                if decides.is_none_or(|o| o.sector.is_none()) {
                    return Word::Outside;
                }
                Word::Inside(around.last().map(outline).and_then(|o| o.sector))
            }
            Interior::Enclosed { .. } => {
                let around = self.rays[0].outlines(self.level, self.walls, point);
                let void = around
                    .iter()
                    .any(|id| self.level.outlines[id.0 as usize].sector.is_none());
                let escapes = |ray: &Ray| ray.sector(self.level, self.walls, point).is_none();
                if void || self.rays.iter().any(escapes) {
                    Word::Outside
                } else {
                    Word::Contested
                }
            }
        }
    }

    /// Walks at random from the point, never touching a wall: whatever walls are seen on the way
    /// border the same ground. Ground from which a ray escapes is outside; other ground is inside if
    /// any wall names a sector for it.
    fn explore(&self, point: GridPoint, rng: &mut Pcg64Mcg) -> Word {
        if matches!(self.level.interior, Interior::Outlines) {
            return self.ask(point);
        }
        let mut reached = vec![point];
        let mut named = None;
        let (low, high) = self.walls.all.extent();
        let size = (high.x - low.x).max(high.y - low.y).max(2) as f64;
        for _ in 0..STEPS {
            let last = reached[rng.random_range(0..reached.len())];
            for ray in &self.rays {
                match ray.sector(self.level, self.walls, last) {
                    None => return Word::Outside,
                    Some(sector) => named = named.or(sector),
                }
            }
            // All lengths, from a step to the level's extent.
            let length = size.powf(rng.random::<f64>());
            let turn = rng.random::<f64>() * std::f64::consts::TAU;
            let step = |along: f64| (length * along).round() as i64;
            let next = GridPoint::new(last.x + step(turn.cos()), last.y + step(turn.sin()));
            let in_sight = next.x.abs() < 1 << 26 && next.y.abs() < 1 << 26;
            if in_sight && next != last && !self.walls.all.touched(last, next) {
                reached.push(next);
            }
        }
        match (&self.level.interior, named) {
            (Interior::Sides, Some(_)) => Word::Inside(named),
            (Interior::Sides, None) => Word::Outside,
            _ => Word::Contested,
        }
    }
}

/// Rays in one of the four directions of the axes: walls in columns across it.
struct Ray {
    turn: usize,
    low: i64,
    shift: u32,
    /// Walls (of `Walls::all`) whose extent meets the column.
    columns: Vec<Vec<u32>>,
}

impl Ray {
    fn new(walls: &Walls, turn: usize) -> Self {
        let spans = walls
            .all
            .list
            .iter()
            .map(|s| (turned(s.from, turn).x, turned(s.to, turn).x));
        let spans: Vec<(i64, i64)> = spans.map(|(a, b)| (a.min(b), a.max(b))).collect();
        let low = spans.iter().map(|s| s.0).min().unwrap_or(0);
        let high = spans.iter().map(|s| s.1).max().unwrap_or(0);
        let mut shift = 0;
        while (high - low) >> shift > spans.len() as i64 {
            shift += 1;
        }
        let mut columns = vec![Vec::new(); ((high - low) >> shift) as usize + 1];
        for (i, &(a, b)) in spans.iter().enumerate() {
            for column in (a - low) >> shift..=(b - low) >> shift {
                columns[column as usize].push(i as u32);
            }
        }
        Self {
            turn,
            low,
            shift,
            columns,
        }
    }

    /// The walls above the point (in the turned frame), a hair to the right of it, with its height
    /// there as a fraction (numerator, positive denominator) and its slope.
    fn above<'a>(
        &'a self,
        walls: &'a Walls,
        point: GridPoint,
    ) -> impl Iterator<Item = (u32, Height, bool)> + 'a {
        let p = turned(point, self.turn);
        let column = usize::try_from((p.x - self.low) >> self.shift).ok();
        let list = column
            .and_then(|c| self.columns.get(c))
            .map_or(&[][..], |c| c);
        list.iter().filter_map(move |&i| {
            let s = &walls.all.list[i as usize];
            let (from, to) = (turned(s.from, self.turn), turned(s.to, self.turn));
            let rightward = from.x < to.x;
            let (a, b) = if rightward { (from, to) } else { (to, from) };
            // Half open, so that of two walls that meet above the point one counts.
            if !(a.x <= p.x && p.x < b.x) || super::walls::side(a, b, p) != Side::Right {
                return None;
            }
            let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
            let height = i128::from(a.y) * dx + dy * i128::from(p.x - a.x);
            Some((i, Height { height, dy, dx }, rightward))
        })
    }

    /// The sector that the nearest wall names on the point's side; `None` if there is no wall.
    fn sector(&self, level: &Level, walls: &Walls, point: GridPoint) -> Option<Option<SectorId>> {
        let mut nearest: Option<(Height, Option<SectorId>)> = None;
        for (i, height, rightward) in self.above(walls, point) {
            let wall = &level.walls[walls.all.list[i as usize].wall.0 as usize];
            // Below a wall that points right is its right side, in a frame that is not mirrored.
            let right = rightward != mirrors(self.turn);
            let named = if right { wall.right } else { wall.left };
            match &mut nearest {
                Some((least, sector)) => match height.compare(least) {
                    std::cmp::Ordering::Less => nearest = Some((height, named)),
                    // Walls on one line: whichever names a sector.
                    std::cmp::Ordering::Equal => *sector = sector.or(named),
                    std::cmp::Ordering::Greater => {}
                },
                None => nearest = Some((height, named)),
            }
        }
        nearest.map(|n| n.1)
    }

    /// The outlines around the point, ascending: those whose edges lie above it in odd number.
    fn outlines(&self, level: &Level, walls: &Walls, point: GridPoint) -> Vec<OutlineId> {
        let mut crossed: Vec<OutlineId> = self
            .above(walls, point)
            .filter_map(|(i, ..)| level.walls[walls.all.list[i as usize].wall.0 as usize].outline)
            .collect();
        crossed.sort();
        let odd = crossed
            .chunk_by(|a, b| a == b)
            .filter(|group| group.len() % 2 == 1);
        odd.map(|group| group[0]).collect()
    }
}

/// Where a wall passes above a point: height/dx, rising by dy/dx.
#[derive(Clone, Copy)]
struct Height {
    height: i128,
    dy: i128,
    dx: i128,
}

impl Height {
    /// Lower first; of two at one height, the one that rises less. 53 and 27 bits, so 80.
    fn compare(&self, other: &Self) -> std::cmp::Ordering {
        let height = (self.height * other.dx).cmp(&(other.height * self.dx));
        height.then_with(|| (self.dy * other.dx).cmp(&(other.dy * self.dx)))
    }
}

/// The point in a frame in which the ray points up.
fn turned(p: GridPoint, turn: usize) -> GridPoint {
    match turn {
        0 => p,
        1 => GridPoint::new(p.x, -p.y),
        2 => GridPoint::new(p.y, p.x),
        _ => GridPoint::new(p.y, -p.x),
    }
}

/// Whether that frame swaps left and right.
fn mirrors(turn: usize) -> bool {
    matches!(turn, 1 | 2)
}
