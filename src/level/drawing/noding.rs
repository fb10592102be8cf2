//! Lines split where they meet, on the grid.
//!
//! In: strokes of walls and openings in the drawing's numbers, and the grid. Out: a [`Net`] of pieces
//! that meet in nothing but common ends. Ends nearer to each other, or to a line, than the drawing's
//! own rounding are made one; where two lines cross, the grid point nearest to the crossing becomes an
//! end of both. That may move a line by half a step, so that new meetings come up: the work is
//! repeated until there are none.

use std::collections::BTreeMap;

use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashMap;

use super::super::finding::{Finding, Place, Severity};
use super::super::snap::to_grid;
use super::super::wording::length;
use super::opening::Hole;
use super::{DrawingError, Sizes, Stroke};
use crate::geom::{Grid, GridPoint};

/// Most crossings and touches of one round.
const MOST_MEETINGS: usize = 500_000;

/// Most pairs of lines whose boxes overlap, of one round.
const MOST_PAIRS: usize = 20_000_000;

/// Rounds after which what is left (half a step here or there) is left.
const MOST_ROUNDS: usize = 8;

/// A straight piece between two points of the net.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its ends, as indices of [`Net::points`].
    pub ends: [u32; 2],
    /// The stroke that it is of; of an opening in no wall: 0.
    pub stroke: u32,
    /// The opening that it is of; an opening takes the wall's place.
    pub hole: Option<u32>,
}

/// Pieces that meet in common ends only.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// Points.
    pub points: Vec<GridPoint>,
    /// Pieces, each with two distinct ends, no two with the same.
    pub pieces: Vec<Piece>,
    /// Pairs of strokes that lay on each other, with the place of the common piece.
    doubles: Vec<[u32; 2]>,
}

/// A line on its way into the net.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub ends: [GridPoint; 2],
    pub stroke: u32,
    pub hole: Option<u32>,
}

/// Puts strokes and openings on the grid and splits them; adds the findings `snapped` and
/// `zero-length-wall`.
///
/// # Errors
/// [`DrawingError::Tangle`] where the lines meet too often.
pub fn node(
    grid: &Grid,
    strokes: &[Stroke],
    holes: &[Hole],
    sizes: &Sizes,
    findings: &mut Vec<Finding>,
) -> Result<Net, DrawingError> {
    let step = grid.step.length();
    let mut moved = Vec::new();
    let mut largest = 0.0f64;
    let walls = strokes.iter().map(|s| ([s.from, s.to], s.place));
    let openings = holes.iter().map(|h| (h.ends, h.place));
    let mut ends: Vec<[GridPoint; 2]> = Vec::with_capacity(strokes.len() + holes.len());
    for (points, place) in walls.chain(openings) {
        ends.push(points.map(|p| {
            let to = to_grid(grid, p);
            let off = grid.to_level(to).distance(p);
            if off > 0.01 * step {
                largest = largest.max(off);
                moved.push(place);
            }
            to
        }));
    }
    // On a grid that holds every written number, nothing but what is computed is rounded.
    let inexact = strokes.iter().any(|s| {
        let points = [s.from, s.to].into_iter().zip(s.written);
        points
            .into_iter()
            .any(|(p, written)| !written || grid.to_level(to_grid(grid, p)) != p)
    }) || holes.iter().any(|h| h.written != [true; 2]);
    let weld = if inexact {
        (sizes.weld / step).max(1.5)
    } else {
        0.0
    };
    merge_ends(&mut ends, weld);
    let mut zero = Vec::new();
    let mut lines = Vec::with_capacity(ends.len());
    for (i, ends) in ends.into_iter().enumerate() {
        let hole = i.checked_sub(strokes.len()).map(|h| h as u32);
        if ends[0] == ends[1] {
            if hole.is_none() && strokes[i].written == [true; 2] {
                zero.push(strokes[i].place);
            }
            continue;
        }
        let stroke = if hole.is_some() { 0 } else { i as u32 };
        lines.push(Line { ends, stroke, hole });
    }
    findings.extend(Finding::at(
        "snapped",
        Severity::Note,
        format!(
            "A point is no whole number of grid steps ({step}) and was moved to the nearest, by at \
             most {}.",
            length(largest)
        ),
        distinct(moved),
    ));
    findings.extend(Finding::at(
        "zero-length-wall",
        Severity::Repaired,
        "A wall starts and ends in the same point and was dropped.",
        distinct(zero),
    ));
    split(lines, weld, strokes)
}

fn distinct(mut places: Vec<Place>) -> Vec<Place> {
    places.dedup();
    places
}

/// Makes ends one that are nearer than `weld` steps; the first stays.
fn merge_ends(ends: &mut [[GridPoint; 2]], weld: f64) {
    if weld <= 0.0 {
        return;
    }
    let mut kept: RTree<[f64; 2]> = RTree::new();
    let mut to: FxHashMap<GridPoint, GridPoint> = FxHashMap::default();
    for p in ends.iter_mut().flatten() {
        let at = [p.x as f64, p.y as f64];
        *p = *to
            .entry(*p)
            .or_insert_with(|| match kept.nearest_neighbor(at) {
                Some(near) if distance(*near, at) <= weld => {
                    GridPoint::new(near[0] as i64, near[1] as i64)
                }
                _ => {
                    kept.insert(at);
                    *p
                }
            });
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Twice the area of the triangle `a`, `b`, `p`: above 0 where `p` is left of the way from `a` to `b`.
/// Below 2^54 on the grid.
pub(super) fn cross(a: GridPoint, b: GridPoint, p: GridPoint) -> i64 {
    (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
}

/// Splits lines until they meet in ends only.
pub(super) fn split(
    mut lines: Vec<Line>,
    weld: f64,
    strokes: &[Stroke],
) -> Result<Net, DrawingError> {
    let mut doubles: BTreeMap<[u32; 2], ()> = BTreeMap::new();
    for _ in 0..MOST_ROUNDS {
        lines = distinct_lines(lines, &mut doubles);
        let stops = meetings(&lines, weld, strokes)?;
        if stops.iter().all(Vec::is_empty) {
            break;
        }
        let mut pieces = Vec::with_capacity(lines.len() * 2);
        for (line, mut stops) in lines.iter().zip(stops) {
            let [a, b] = line.ends;
            let along = |p: &GridPoint| (p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y);
            stops.sort_by_key(|p| (along(p), *p));
            let mut last = a;
            for next in stops.into_iter().chain([b]) {
                if next != last {
                    pieces.push(Line {
                        ends: [last, next],
                        ..*line
                    });
                    last = next;
                }
            }
        }
        lines = pieces;
    }
    lines = distinct_lines(lines, &mut doubles);
    let mut net = Net {
        doubles: doubles.into_keys().collect(),
        ..Net::default()
    };
    let mut numbers: FxHashMap<GridPoint, u32> = FxHashMap::default();
    for line in lines {
        let ends = line.ends.map(|p| {
            *numbers.entry(p).or_insert_with(|| {
                net.points.push(p);
                net.points.len() as u32 - 1
            })
        });
        net.pieces.push(Piece {
            ends,
            stroke: line.stroke,
            hole: line.hole,
        });
    }
    Ok(net)
}

/// Lines with the same ends made one: an opening takes the place of a wall, the first of its like.
fn distinct_lines(lines: Vec<Line>, doubles: &mut BTreeMap<[u32; 2], ()>) -> Vec<Line> {
    let mut seen: FxHashMap<[GridPoint; 2], usize> = FxHashMap::default();
    let mut out: Vec<Line> = Vec::with_capacity(lines.len());
    for line in lines {
        let mut key = line.ends;
        key.sort();
        let at = *seen.entry(key).or_insert(out.len());
        match out.get_mut(at) {
            None => out.push(line),
            Some(first) if first.hole.is_none() && line.hole.is_some() => *first = line,
            Some(first) if first.hole.is_none() && first.stroke != line.stroke => {
                doubles.insert(
                    [first.stroke.min(line.stroke), first.stroke.max(line.stroke)],
                    (),
                );
            }
            Some(_) => {}
        }
    }
    out
}

/// For each line the points where others meet it, between its ends.
fn meetings(
    lines: &[Line],
    weld: f64,
    strokes: &[Stroke],
) -> Result<Vec<Vec<GridPoint>>, DrawingError> {
    let corner = |p: GridPoint| [p.x as f64, p.y as f64];
    let tree = RTree::bulk_load(
        (lines.iter().enumerate())
            .map(|(i, l)| {
                let corners = Rectangle::from_corners(corner(l.ends[0]), corner(l.ends[1]));
                GeomWithData::new(corners, i)
            })
            .collect(),
    );
    let mut stops: Vec<Vec<GridPoint>> = vec![Vec::new(); lines.len()];
    let (mut count, mut pairs) = (0, 0);
    for (i, line) in lines.iter().enumerate() {
        let [a, b] = line.ends;
        let reach = AABB::from_corners(
            [a.x.min(b.x) as f64 - weld, a.y.min(b.y) as f64 - weld],
            [a.x.max(b.x) as f64 + weld, a.y.max(b.y) as f64 + weld],
        );
        for near in tree.locate_in_envelope_intersecting(reach) {
            let j = near.data;
            if j <= i {
                continue;
            }
            pairs += 1;
            let other = &lines[j];
            let before = stops[i].len() + stops[j].len();
            meet(line, other, weld, |first, p| {
                stops[if first { i } else { j }].push(p)
            });
            count += stops[i].len() + stops[j].len() - before;
            if count > MOST_MEETINGS || pairs > MOST_PAIRS {
                return Err(DrawingError::Tangle {
                    place: strokes[line.stroke as usize].place,
                    limit: MOST_MEETINGS,
                });
            }
        }
    }
    Ok(stops)
}

/// Where two lines meet: tells the points that have to become ends of the first, and of the second.
fn meet(one: &Line, two: &Line, weld: f64, mut stop: impl FnMut(bool, GridPoint)) {
    let mut touched = false;
    for (first, line, other) in [(true, one, two), (false, two, one)] {
        for p in other.ends {
            if line.ends.contains(&p) {
                touched = true;
            } else if lies_on(line.ends, p, weld) {
                stop(first, p);
                touched = true;
            }
        }
    }
    if touched {
        return;
    }
    let ([a, b], [c, d]) = (one.ends, two.ends);
    let (from, to) = (cross(a, b, c), cross(a, b, d));
    let apart = |x: i64, y: i64| (x < 0) != (y < 0) && x != 0 && y != 0;
    if apart(from, to) && apart(cross(c, d, a), cross(c, d, b)) {
        let share = from as f64 / (from as f64 - to as f64);
        let p = GridPoint::new(
            c.x + ((d.x - c.x) as f64 * share).round() as i64,
            c.y + ((d.y - c.y) as f64 * share).round() as i64,
        );
        for (first, ends) in [(true, [a, b]), (false, [c, d])] {
            if !ends.contains(&p) {
                stop(first, p);
            }
        }
    }
}

/// Whether a point lies between the ends of a line, exactly or nearer than `weld` steps.
fn lies_on([a, b]: [GridPoint; 2], p: GridPoint, weld: f64) -> bool {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let along = (p.x - a.x) * dx + (p.y - a.y) * dy;
    let square = dx * dx + dy * dy;
    if along <= 0 || along >= square {
        return false;
    }
    let off = cross(a, b, p);
    off == 0 || (off.abs() as f64) <= weld * (square as f64).sqrt()
}

impl Net {
    /// The lines of the net, to be split anew with others.
    pub(super) fn lines(&self) -> Vec<Line> {
        let line = |p: &Piece| Line {
            ends: p.ends.map(|v| self.points[v as usize]),
            stroke: p.stroke,
            hole: p.hole,
        };
        self.pieces.iter().map(line).collect()
    }

    /// Keeps what was found out about an earlier form of the net.
    pub(super) fn remember(&mut self, earlier: Net) {
        self.doubles.extend(earlier.doubles);
        self.doubles.sort_unstable();
        self.doubles.dedup();
    }

    /// Walls that lay on each other.
    pub fn tell_doubles(&self, strokes: &[Stroke], findings: &mut Vec<Finding>) {
        let (mut same, mut partly) = (Vec::new(), Vec::new());
        for &[a, b] in &self.doubles {
            let [first, second] = [a, b].map(|i| &strokes[i as usize]);
            let key = |s: &Stroke| {
                let mut ends = [s.from.to_array(), s.to.to_array()];
                ends.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
                ends
            };
            let list = if key(first) == key(second) {
                &mut same
            } else {
                &mut partly
            };
            let middle = second.from.midpoint(second.to);
            list.push(Place::Point {
                x: middle.x,
                y: middle.y,
            });
        }
        findings.extend(Finding::at(
            "duplicate-wall",
            Severity::Repaired,
            "A wall is drawn twice from end to end; the two were made one.",
            same,
        ));
        findings.extend(Finding::at(
            "overlapping-walls",
            Severity::Repaired,
            "Walls lie partly on each other; the common part was made one.",
            partly,
        ));
    }
}
