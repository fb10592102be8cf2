//! The arrangement of a level's walls: pieces that meet only at exact vertices.
//!
//! In: walls that may cross, touch, overlap and repeat. Out: [`Arrangement`], whose pieces have no
//! point in common but their ends, each knowing the walls that lie on it. Everything is in the
//! [`Frame`] of the level, and ordered by geometry alone.

use std::cmp::Ordering;

use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};

use super::Doors;
use super::frame::Frame;
use crate::geom::{GridPoint, Line, Side, Vertex, VertexId, VertexSet, orient};
use crate::level::{Level, SectorId, Wall, WallId, WallKind};

/// Index into [`Arrangement::lines`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LineId(pub u32);

/// Index into [`Arrangement::pieces`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PieceId(pub u32);

/// Walls cut at every point where they meet.
pub struct Arrangement {
    /// The frame in which all coordinates here are.
    pub frame: Frame,
    /// Lines, each once.
    pub lines: LineSet,
    /// Ends of pieces.
    pub vertices: VertexSet,
    /// The pieces; ordered by geometry.
    pub pieces: Vec<Piece>,
    /// The walls that lie on the pieces; a piece holds a range of these.
    pub covers: Vec<Cover>,
    /// Pairs of walls that meet in another way than end to end.
    pub meetings: Vec<(WallId, WallId, Meeting)>,
}

/// A stretch of wall without a meeting point inside.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Its line.
    pub line: LineId,
    /// Its start, in the direction of the line.
    pub from: VertexId,
    /// Its end, in the direction of the line.
    pub to: VertexId,
    /// Whether it stops sight.
    pub opaque: bool,
    /// Whether an opening lies on it (open or shut).
    pub opening: bool,
    /// First of its covers.
    covers: u32,
    n_covers: u32,
}

/// A wall that lies on a piece.
#[derive(Clone, Copy, Debug)]
pub struct Cover {
    /// The wall.
    pub wall: WallId,
    /// Whether the wall's left side is the left side of the piece's line, in the frame.
    pub forward: bool,
}

/// How two walls meet that do not just share an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// They cross between their ends.
    Cross,
    /// An end of the first lies inside the second.
    Touch,
    /// They lie on one line and share more than a point, but not all.
    Overlap,
    /// They have the same two ends.
    Duplicate,
}

/// Lines, each once.
#[derive(Default)]
pub struct LineSet {
    list: Vec<Line>,
    ids: FxHashMap<Line, LineId>,
}

impl LineSet {
    /// The id of `line`, new if the line is new.
    pub fn insert(&mut self, line: Line) -> LineId {
        *self.ids.entry(line).or_insert_with(|| {
            self.list.push(line);
            LineId(self.list.len() as u32 - 1)
        })
    }

    /// The line with that id.
    #[inline]
    pub fn get(&self, id: LineId) -> &Line {
        &self.list[id.0 as usize]
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Number of lines.
    pub fn len(&self) -> usize {
        self.list.len()
    }
}

impl Arrangement {
    /// The walls that lie on a piece.
    pub fn covers(&self, piece: &Piece) -> &[Cover] {
        &self.covers[piece.covers as usize..(piece.covers + piece.n_covers) as usize]
    }

    /// The sector that a cover's wall names on the left (or right) side of the piece's line.
    pub fn named_sector(&self, level: &Level, cover: &Cover, left: bool) -> Option<SectorId> {
        let wall = &level.walls[cover.wall.0 as usize];
        if left == cover.forward {
            wall.left
        } else {
            wall.right
        }
    }
}

/// A wall in the frame, on its line.
struct Segment {
    wall: WallId,
    line: LineId,
    /// Ends in the direction of the line.
    from: GridPoint,
    to: GridPoint,
    forward: bool,
}

impl Segment {
    fn y_range(&self) -> (i64, i64) {
        (self.from.y.min(self.to.y), self.from.y.max(self.to.y))
    }
}

/// Cuts the walls of a level at every point where they meet. O(n log n + pairs whose extents
/// overlap in x). See-through walls with the same sector on both sides are left out: they change
/// nothing, neither sight nor sectors.
pub fn arrange(level: &Level, doors: Doors) -> Arrangement {
    let coded: Vec<_> = level
        .walls
        .iter()
        .map(|w| (w.from, w.to, code(w, doors)))
        .collect();
    let frame = Frame::of(&coded);
    let mut lines = LineSet::default();
    // Subdividing adds about as many again.
    let mut vertices = VertexSet::with_capacity(2 * level.walls.len());
    let segments = segments(level, doors, &frame, &mut lines);
    let mut meetings = Vec::new();
    let mut cuts = cut_points(&segments, &lines, &mut vertices, &mut meetings);

    // Each stretch between neighbouring cuts of a segment, keyed by its ends.
    let mut stretches: Vec<(VertexId, VertexId, u32)> = Vec::with_capacity(segments.len() * 2);
    for (i, s) in segments.iter().enumerate() {
        let line = lines.get(s.line);
        let cuts = &mut cuts[i];
        cuts.sort_unstable_by(|&p, &q| vertices.cmp_along(line, p, q));
        cuts.dedup();
        stretches.extend(cuts.windows(2).map(|w| (w[0], w[1], i as u32)));
    }
    stretches.sort();

    let mut arrangement = Arrangement {
        frame,
        lines,
        vertices,
        pieces: Vec::with_capacity(stretches.len()),
        covers: Vec::with_capacity(stretches.len()),
        meetings,
    };
    for group in stretches.chunk_by(|p, q| (p.0, p.1) == (q.0, q.1)) {
        let first = arrangement.covers.len() as u32;
        arrangement.covers.extend(group.iter().map(|&(_, _, i)| {
            let s = &segments[i as usize];
            Cover {
                wall: s.wall,
                forward: s.forward,
            }
        }));
        let kinds = || {
            group
                .iter()
                .map(|g| &wall_of(level, &segments[g.2 as usize]).kind)
        };
        let mut piece = Piece {
            line: segments[group[0].2 as usize].line,
            from: group[0].0,
            to: group[0].1,
            opaque: false,
            opening: kinds().any(|k| matches!(k, WallKind::Opening(_))),
            covers: first,
            n_covers: group.len() as u32,
        };
        piece.opaque = kinds().any(|kind| match kind {
            WallKind::Solid => true,
            WallKind::Outline => !piece.opening,
            WallKind::Edge { shut } => *shut && doors == Doors::Closed,
            WallKind::Opening(opening) => opening.shut && doors == Doors::Closed,
        });
        arrangement.pieces.push(piece);
    }
    arrangement
}

fn wall_of<'a>(level: &'a Level, segment: &Segment) -> &'a Wall {
    &level.walls[segment.wall.0 as usize]
}

/// Whether a wall neither stops sight nor parts two places.
fn is_idle(wall: &Wall, doors: Doors) -> bool {
    let see_through = match wall.kind {
        WallKind::Edge { shut } => !(shut && doors == Doors::Closed),
        _ => false,
    };
    see_through && wall.outline.is_none() && wall.left == wall.right
}

/// What the subdivision depends on besides the ends of a wall.
fn code(wall: &Wall, doors: Doors) -> u64 {
    match &wall.kind {
        _ if is_idle(wall, doors) => 0,
        WallKind::Solid => 1,
        WallKind::Outline => 2,
        WallKind::Edge { shut } => 3 + u64::from(*shut),
        WallKind::Opening(o) => 5 + u64::from(o.shut),
    }
}

/// The walls in the frame, ordered by geometry.
fn segments(level: &Level, doors: Doors, frame: &Frame, lines: &mut LineSet) -> Vec<Segment> {
    let mut sorted: Vec<_> = (0u32..)
        .zip(&level.walls)
        .filter(|(_, wall)| !is_idle(wall, doors))
        .map(|(i, wall)| {
            let (a, b) = (frame.enter(wall.from), frame.enter(wall.to));
            (a.min(b), a.max(b), code(wall, doors), a > b, i)
        })
        .collect();
    sorted.sort_unstable();
    sorted
        .into_iter()
        .map(|(from, to, _, turned, i)| Segment {
            wall: WallId(i),
            // Points are ordered by x, then y, and lines point right or straight up.
            line: lines.insert(Line::through(from, to).expect("walls have two different ends")),
            from,
            to,
            forward: turned == frame.mirrors(),
        })
        .collect()
}

/// The points in which a segment is cut, its ends among them.
type Cuts = SmallVec<[VertexId; 4]>;

/// For every segment, its ends and all points where another one meets it, unordered.
fn cut_points(
    segments: &[Segment],
    lines: &LineSet,
    vertices: &mut VertexSet,
    meetings: &mut Vec<(WallId, WallId, Meeting)>,
) -> Vec<Cuts> {
    let mut cuts: Vec<Cuts> = segments
        .iter()
        .map(|s| smallvec![vertices.insert(s.from.into()), vertices.insert(s.to.into())])
        .collect();
    // Segments are ordered by their smallest x: those that overlap segment i in x and come after it
    // follow it immediately.
    for (i, s) in segments.iter().enumerate() {
        let (low, high) = s.y_range();
        for (j, t) in segments.iter().enumerate().skip(i + 1) {
            if t.from.x > s.to.x {
                break;
            }
            let (t_low, t_high) = t.y_range();
            if t_low > high || t_high < low {
                continue;
            }
            if s.line == t.line {
                let line = lines.get(s.line);
                let inside = |p: GridPoint, s: &Segment| {
                    let (p, from, to): (Vertex, Vertex, Vertex) =
                        (p.into(), s.from.into(), s.to.into());
                    line.cmp_along(&from, &p) == Ordering::Less
                        && line.cmp_along(&p, &to) == Ordering::Less
                };
                let mut overlap = false;
                for (p, k, other) in [(t.from, i, s), (t.to, i, s), (s.from, j, t), (s.to, j, t)] {
                    if inside(p, other) {
                        overlap = true;
                        cuts[k].push(vertices.insert(p.into()));
                    }
                }
                if (s.from, s.to) == (t.from, t.to) {
                    meetings.push((s.wall, t.wall, Meeting::Duplicate));
                } else if overlap {
                    meetings.push((s.wall, t.wall, Meeting::Overlap));
                }
                continue;
            }
            if s.from == t.from || s.from == t.to || s.to == t.from || s.to == t.to {
                continue; // lines that differ meet once
            }
            let side =
                |a: GridPoint, b: GridPoint, p: GridPoint| orient(&a.into(), &b.into(), &p.into());
            let t_from = side(s.from, s.to, t.from);
            let t_to = side(s.from, s.to, t.to);
            if t_from == t_to {
                continue;
            }
            let s_from = side(t.from, t.to, s.from);
            let s_to = side(t.from, t.to, s.to);
            if s_from == s_to {
                continue;
            }
            // The point of s's line that t meets is s's end, t's end, or inside both.
            let on = |side| side == Side::On;
            let (point, meeting) = match () {
                () if on(t_from) => (t.from.into(), (t.wall, s.wall, Meeting::Touch)),
                () if on(t_to) => (t.to.into(), (t.wall, s.wall, Meeting::Touch)),
                () if on(s_from) => (s.from.into(), (s.wall, t.wall, Meeting::Touch)),
                () if on(s_to) => (s.to.into(), (s.wall, t.wall, Meeting::Touch)),
                () => {
                    let point = lines.get(s.line).meet(lines.get(t.line));
                    let point = point.expect("segments that cross are not parallel");
                    (point, (s.wall, t.wall, Meeting::Cross))
                }
            };
            let point = vertices.insert(point);
            cuts[i].push(point);
            cuts[j].push(point);
            meetings.push(meeting);
        }
    }
    cuts
}
