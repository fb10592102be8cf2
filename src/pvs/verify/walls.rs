//! The level's original walls, and exact questions about them.

use crate::cells::Doors;
use crate::geom::{GridPoint, Line, Side};
use crate::level::{Level, Wall, WallId, WallKind};

/// A stretch of a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    pub wall: WallId,
    pub from: GridPoint,
    pub to: GridPoint,
}

/// The walls of a level, found by place.
pub(super) struct Walls {
    /// What stops sight.
    pub opaque: Buckets,
    /// What stops sight or parts two places.
    pub all: Buckets,
    /// Openings that have a bottom or a top of their own, and do not stop sight on the plan.
    pub openings: Buckets,
}

impl Walls {
    pub fn new(level: &Level, doors: Doors) -> Self {
        let closed = doors == Doors::Closed;
        let (mut opaque, mut all, mut openings) = (Vec::new(), Vec::new(), Vec::new());
        for (wall, id) in level.walls.iter().zip((0u32..).map(WallId)) {
            let whole = Stretch {
                wall: id,
                from: wall.from,
                to: wall.to,
            };
            let stops = match &wall.kind {
                WallKind::Solid => true,
                WallKind::Outline => {
                    opaque.extend(without_openings(level, whole));
                    false
                }
                WallKind::Edge { shut } => closed && *shut,
                WallKind::Opening(opening) => closed && opening.shut,
            };
            if stops {
                opaque.push(whole);
            } else if let WallKind::Opening(opening) = &wall.kind
                && (opening.bottom.is_some() || opening.top.is_some())
            {
                openings.push(whole);
            }
            if stops || !is_idle(wall) {
                all.push(whole);
            }
        }
        Self {
            opaque: Buckets::new(opaque),
            all: Buckets::new(all),
            openings: Buckets::new(openings),
        }
    }
}

/// A see-through wall between a place and itself.
fn is_idle(wall: &Wall) -> bool {
    let see_through = matches!(wall.kind, WallKind::Edge { .. });
    see_through && wall.outline.is_none() && wall.left == wall.right
}

/// What openings leave of a wall.
fn without_openings(level: &Level, wall: Stretch) -> Vec<Stretch> {
    let line = Line::through(wall.from, wall.to);
    let mut holes: Vec<(GridPoint, GridPoint)> = level
        .walls
        .iter()
        .filter(|w| matches!(w.kind, WallKind::Opening(_)) && Line::through(w.from, w.to) == line)
        .map(|w| (w.from.min(w.to), w.from.max(w.to)))
        .collect();
    holes.sort();
    // Points of one line are in the order of the line when ordered by x, then y.
    let (mut at, end) = (wall.from.min(wall.to), wall.from.max(wall.to));
    let mut rest = Vec::new();
    for (from, to) in holes {
        if from > at && at < end {
            rest.push(Stretch {
                from: at,
                to: from.min(end),
                ..wall
            });
        }
        at = at.max(to);
    }
    if at < end {
        rest.push(Stretch {
            from: at,
            to: end,
            ..wall
        });
    }
    rest
}

/// Side of `r` seen from `p` towards `q`; all on the grid, so i64 holds it.
pub(super) fn side(p: GridPoint, q: GridPoint, r: GridPoint) -> Side {
    Side::of((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x))
}

/// Whether two closed segments have a point in common.
pub(super) fn touch(a: GridPoint, b: GridPoint, c: GridPoint, d: GridPoint) -> bool {
    let apart =
        |a0: i64, a1: i64, b0: i64, b1: i64| a0.max(a1) < b0.min(b1) || b0.max(b1) < a0.min(a1);
    if apart(a.x, b.x, c.x, d.x) || apart(a.y, b.y, c.y, d.y) {
        return false;
    }
    let strictly = |p: Side, q: Side| p == q && p != Side::On;
    !strictly(side(a, b, c), side(a, b, d)) && !strictly(side(c, d, a), side(c, d, b))
}

/// Square buckets over stretches of wall.
pub(super) struct Buckets {
    pub list: Vec<Stretch>,
    low: GridPoint,
    high: GridPoint,
    /// A bucket is 2^shift steps wide.
    shift: u32,
    columns: usize,
    buckets: Vec<Vec<u32>>,
}

impl Buckets {
    fn new(list: Vec<Stretch>) -> Self {
        let ends = || list.iter().flat_map(|s| [s.from, s.to]);
        let low = GridPoint::new(
            ends().map(|p| p.x).min().unwrap_or(0),
            ends().map(|p| p.y).min().unwrap_or(0),
        );
        let high = GridPoint::new(
            ends().map(|p| p.x).max().unwrap_or(0),
            ends().map(|p| p.y).max().unwrap_or(0),
        );
        let extent = (high.x - low.x).max(high.y - low.y);
        let across = (list.len() as f64 * 4.0).sqrt().ceil() as i64 + 1;
        let mut shift = 0;
        while extent >> shift > across {
            shift += 1;
        }
        let columns = ((high.x - low.x) >> shift) as usize + 1;
        let rows = ((high.y - low.y) >> shift) as usize + 1;
        let mut result = Self {
            list: Vec::new(),
            low,
            high,
            shift,
            columns,
            buckets: Vec::new(),
        };
        let mut buckets = vec![Vec::new(); columns * rows];
        for (i, s) in list.iter().enumerate() {
            result.along(s.from, s.to, |bucket| {
                buckets[bucket].push(i as u32);
                true
            });
        }
        result.list = list;
        result.buckets = buckets;
        result
    }

    /// The extent of all walls.
    pub fn extent(&self) -> (GridPoint, GridPoint) {
        (self.low, self.high)
    }

    /// The width of a bucket, in steps.
    pub fn width(&self) -> i64 {
        1 << self.shift
    }

    /// Calls `f` with every bucket that the closed segment meets (and perhaps a few beside it),
    /// row by row, until it returns false.
    fn along(&self, p: GridPoint, q: GridPoint, mut f: impl FnMut(usize) -> bool) {
        let (p, q) = if p.y <= q.y { (p, q) } else { (q, p) };
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let row_of = |y: i64| (y - self.low.y) >> self.shift;
        let rows = (self.high.y - self.low.y) >> self.shift;
        for row in row_of(p.y).max(0)..=row_of(q.y).min(rows) {
            let bottom = (self.low.y + (row << self.shift)).max(p.y);
            let top = (self.low.y + ((row + 1) << self.shift)).min(q.y);
            // Whole steps on the outer side of the two ends in this row.
            let x_at = |y: i64| match dy {
                0 => (p.x.min(q.x), p.x.max(q.x)),
                _ => {
                    let x = p.x + (dx * (y - p.y)).div_euclid(dy);
                    (x, x + 1)
                }
            };
            let (a, b) = (x_at(bottom), x_at(top));
            let first = (a.0.min(b.0) - self.low.x) >> self.shift;
            let last = (a.1.max(b.1) - self.low.x) >> self.shift;
            for column in first.max(0)..=last.min(self.columns as i64 - 1) {
                if !f(row as usize * self.columns + column as usize) {
                    return;
                }
            }
        }
    }

    /// Whether the closed segment touches any of the walls.
    pub fn touched(&self, p: GridPoint, q: GridPoint) -> bool {
        let mut hit = false;
        self.along(p, q, |bucket| {
            hit = self.buckets[bucket].iter().any(|&i| {
                let s = &self.list[i as usize];
                touch(p, q, s.from, s.to)
            });
            !hit
        });
        hit
    }

    /// The walls that the closed segment touches, each once.
    pub fn touching(&self, p: GridPoint, q: GridPoint, found: &mut Vec<u32>) {
        found.clear();
        self.along(p, q, |bucket| {
            found.extend(self.buckets[bucket].iter().filter(|&&i| {
                let s = &self.list[i as usize];
                touch(p, q, s.from, s.to)
            }));
            true
        });
        found.sort_unstable();
        found.dedup();
    }

    /// Whether all walls that the closed segment touches are of one sort.
    pub fn touched_only(
        &self,
        p: GridPoint,
        q: GridPoint,
        sort: impl Fn(&Stretch) -> bool,
    ) -> bool {
        let mut only = true;
        self.along(p, q, |bucket| {
            only = self.buckets[bucket].iter().all(|&i| {
                let s = &self.list[i as usize];
                !touch(p, q, s.from, s.to) || sort(s)
            });
            only
        });
        only
    }

    /// The walls near the box from `low` to `high`: all that meet it, and others; each once.
    pub fn near(&self, low: GridPoint, high: GridPoint, found: &mut Vec<u32>) {
        found.clear();
        let column =
            |x: i64| (((x - self.low.x) >> self.shift).max(0)).min(self.columns as i64 - 1);
        let rows = (self.high.y - self.low.y) >> self.shift;
        let row = |y: i64| ((y - self.low.y) >> self.shift).clamp(0, rows);
        for r in row(low.y)..=row(high.y) {
            for c in column(low.x)..=column(high.x) {
                found.extend(&self.buckets[r as usize * self.columns + c as usize]);
            }
        }
        found.sort_unstable();
        found.dedup();
    }

    /// How far, in multiples of `(dx, dy)` up to 1, one comes from `p` before a wall, about: the
    /// answer is rounded, and only used to aim.
    pub fn reach(&self, p: GridPoint, dx: f64, dy: f64) -> f64 {
        let width = self.width() as f64;
        let length = dx.hypot(dy);
        let steps = (length / width).ceil().max(1.0);
        let mut nearest = 1.0f64;
        // Bucket after bucket, sampled along the way; a corner cut is made up for by exact tests.
        for k in 0..steps as i64 * 2 {
            let t = (k as f64 + 0.5) / (steps * 2.0);
            let at = GridPoint::new(p.x + (dx * t) as i64, p.y + (dy * t) as i64);
            let (x, y) = (at.x - self.low.x, at.y - self.low.y);
            if x < 0 || y < 0 || at.x > self.high.x || at.y > self.high.y {
                break;
            }
            let bucket = (y >> self.shift) as usize * self.columns + (x >> self.shift) as usize;
            for &i in &self.buckets[bucket] {
                let s = &self.list[i as usize];
                let (ex, ey) = ((s.to.x - s.from.x) as f64, (s.to.y - s.from.y) as f64);
                let (fx, fy) = ((s.from.x - p.x) as f64, (s.from.y - p.y) as f64);
                let det = dx * ey - dy * ex;
                if det != 0.0 {
                    let along = (fx * ey - fy * ex) / det;
                    let across = (fx * dy - fy * dx) / det;
                    if along > 0.0 && (0.0..=1.0).contains(&across) {
                        nearest = nearest.min(along);
                    }
                }
            }
            if nearest <= t {
                break;
            }
        }
        nearest
    }
}
