//! Ends of walls that nearly meet another wall: listed, and closed if asked to.
//!
//! In: the net. Out: findings, and a net with a short piece of wall across each gap.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use rustc_hash::FxHashSet;

use super::super::finding::{Finding, Place, Severity};
use super::super::wording::{count, length};
use super::noding::{Line, Net, split};
use super::{DrawingError, Sizes, Stroke};
use crate::geom::{Grid, GridPoint};

/// How many sizes a message lists.
const SHOWN: usize = 20;

/// A gap between a wall's end and the nearest other wall.
struct Gap {
    from: GridPoint,
    to: GridPoint,
    /// The stroke whose end this is.
    stroke: u32,
    /// Its width in the level's unit.
    size: f64,
}

/// Lists gaps, closes those up to [`Sizes::close`], and lists ends that lead nowhere.
pub(super) fn mend(
    grid: &Grid,
    net: &mut Net,
    strokes: &[Stroke],
    sizes: &Sizes,
    findings: &mut Vec<Finding>,
) -> Result<(), DrawingError> {
    let ends = open_ends(grid, net, sizes);
    findings.extend(Finding::at(
        "open-wall-end",
        Severity::Repaired,
        "A wall of two lines was not closed at its end; it was closed straight across.",
        ends.iter().map(|line| place(grid, line.ends[0])).collect(),
    ));
    if !ends.is_empty() {
        let mut lines = net.lines();
        lines.extend(ends);
        let capped = split(lines, 0.0, strokes)?;
        let earlier = std::mem::replace(net, capped);
        net.remember(earlier);
    }
    let (gaps, stray) = find(grid, net, sizes);
    let limit = sizes.close.unwrap_or(0.0);
    let (closed, open): (Vec<Gap>, Vec<Gap>) = gaps.into_iter().partition(|g| g.size <= limit);
    if !closed.is_empty() {
        let mut lines = net.lines();
        lines.extend(closed.iter().map(|gap| Line {
            ends: [gap.from, gap.to],
            stroke: gap.stroke,
            hole: None,
        }));
        // The end of a piece that was put in lies on a slanted wall only to the nearest step.
        let mended = split(lines, 1.5, strokes)?;
        let earlier = std::mem::replace(net, mended);
        net.remember(earlier);
    }
    let tell = |code, severity, what: &str, gaps: &[Gap]| {
        let places = gaps.iter().map(|g| place(grid, g.from)).collect();
        let sizes = in_words(gaps);
        Finding::at(code, severity, format!("{what}{sizes}"), places)
    };
    findings.extend(tell(
        "closed-gap",
        Severity::Repaired,
        "A wall ended short of another one; a piece of wall was put between. ",
        &closed,
    ));
    findings.extend(tell(
        "gap",
        Severity::Warning,
        "A wall ends short of another one, so sight passes; --close-gaps SIZE joins ends up to that \
         far apart. ",
        &open,
    ));
    findings.extend(Finding::at(
        "stray-line",
        Severity::Note,
        "A wall ends freely in a room or outside and parts nothing there.",
        stray.into_iter().map(|p| place(grid, p)).collect(),
    ));
    Ok(())
}

fn in_words(gaps: &[Gap]) -> String {
    let sizes: Vec<String> = gaps.iter().take(SHOWN).map(|g| length(g.size)).collect();
    let more = match gaps.len().saturating_sub(SHOWN) {
        0 => String::new(),
        n => format!(", and {} more", count(n, "gap")),
    };
    format!(
        "Widths, in the order of places: {}{more}.",
        sizes.join(", ")
    )
}

fn place(grid: &Grid, p: GridPoint) -> Place {
    let p = grid.to_level(p);
    Place::Point { x: p.x, y: p.y }
}

/// Lines across the ends of walls that are drawn as two lines: from the end of a wall to that of a
/// parallel one beside it, no farther than the thickest wall, that comes from the same side.
fn open_ends(grid: &Grid, net: &Net, sizes: &Sizes) -> Vec<Line> {
    let reach = sizes.wall / grid.step.length();
    if reach <= 0.0 {
        return Vec::new();
    }
    // The wall that ends at each point, if it is the only one: its piece.
    let mut only: Vec<Option<usize>> = vec![None; net.points.len()];
    let mut walls = vec![0u32; net.points.len()];
    for (i, piece) in net
        .pieces
        .iter()
        .enumerate()
        .filter(|(_, p)| p.hole.is_none())
    {
        for v in piece.ends.map(|v| v as usize) {
            walls[v] += 1;
            only[v] = (walls[v] == 1).then_some(i);
        }
    }
    let corner = |v: usize| DVec2::new(net.points[v].x as f64, net.points[v].y as f64);
    // The direction in which a wall arrives at its end.
    let way = |v: usize, piece: usize| {
        let [a, b] = net.pieces[piece].ends.map(|v| v as usize);
        (corner(v) - corner(if a == v { b } else { a })).normalize_or_zero()
    };
    let free: Vec<(usize, usize)> = (only.iter().enumerate())
        .filter_map(|(v, piece)| Some((v, (*piece)?)))
        .collect();
    let tree = RTree::bulk_load(
        (free.iter().enumerate())
            .map(|(i, (v, _))| GeomWithData::new(corner(*v).to_array(), i))
            .collect(),
    );
    let mut lines = Vec::new();
    let mut taken: FxHashSet<usize> = FxHashSet::default();
    for &(v, piece) in &free {
        if taken.contains(&v) {
            continue;
        }
        let (p, d) = (corner(v), way(v, piece));
        let near = tree.locate_within_distance(p.to_array(), reach * reach);
        let partner = near
            .map(|n| free[n.data])
            .filter(|&(w, other)| {
                let across = corner(w) - p;
                let e = way(w, other);
                w != v
                    && other != piece
                    && !taken.contains(&w)
                    && d.dot(e) > 0.99
                    && across.dot(d).abs() <= 0.2 * across.length()
            })
            .min_by(|a, b| {
                let off = |w: usize| corner(w).distance_squared(p);
                off(a.0).total_cmp(&off(b.0)).then(a.0.cmp(&b.0))
            });
        if let Some((w, _)) = partner {
            taken.extend([v, w]);
            lines.push(Line {
                ends: [net.points[v], net.points[w]],
                stroke: net.pieces[piece].stroke,
                hole: None,
            });
        }
    }
    lines
}

/// Ends at which only one piece ends: with the nearest other wall, or without.
fn find(grid: &Grid, net: &Net, sizes: &Sizes) -> (Vec<Gap>, Vec<GridPoint>) {
    let mut degree = vec![0u32; net.points.len()];
    for v in net.pieces.iter().flat_map(|p| p.ends) {
        degree[v as usize] += 1;
    }
    let step = grid.step.length();
    let reach = sizes.gap / step;
    let at = |v: u32| net.points[v as usize];
    let corner = |p: GridPoint| [p.x as f64, p.y as f64];
    let tree = RTree::bulk_load(
        (net.pieces.iter().enumerate())
            .map(|(i, p)| {
                let corners = Rectangle::from_corners(corner(at(p.ends[0])), corner(at(p.ends[1])));
                GeomWithData::new(corners, i)
            })
            .collect(),
    );
    let (mut gaps, mut stray): (Vec<Gap>, Vec<GridPoint>) = (Vec::new(), Vec::new());
    let mut known: FxHashSet<(GridPoint, GridPoint)> = FxHashSet::default();
    for (i, piece) in net.pieces.iter().enumerate() {
        for (v, other) in [
            (piece.ends[0], piece.ends[1]),
            (piece.ends[1], piece.ends[0]),
        ] {
            if degree[v as usize] != 1 || piece.hole.is_some() {
                continue;
            }
            let p = at(v);
            let [x, y] = corner(p);
            let window = AABB::from_corners([x - reach, y - reach], [x + reach, y + reach]);
            let near = tree.locate_in_envelope_intersecting(window);
            let nearest = near
                .filter(|n| n.data != i && !net.pieces[n.data].ends.contains(&other))
                .map(|n| nearest_point(net.pieces[n.data].ends.map(at), p))
                .map(|q| (q, (corner(q)[0] - x).hypot(corner(q)[1] - y)))
                .filter(|(q, off)| *off <= reach && *q != p)
                .min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
            match nearest {
                Some((q, off)) => {
                    if !known.contains(&(q, p)) {
                        known.insert((p, q));
                        gaps.push(Gap {
                            from: p,
                            to: q,
                            stroke: piece.stroke,
                            size: off * step,
                        });
                    }
                }
                None => stray.push(p),
            }
        }
    }
    (gaps, stray)
}

/// The grid point of a piece that is nearest to `p`; an end, where that is as near as a step.
fn nearest_point([a, b]: [GridPoint; 2], p: GridPoint) -> GridPoint {
    let (dx, dy) = ((b.x - a.x) as f64, (b.y - a.y) as f64);
    let along = (p.x - a.x) as f64 * dx + (p.y - a.y) as f64 * dy;
    let share = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    GridPoint::new(
        a.x + (dx * share).round() as i64,
        a.y + (dy * share).round() as i64,
    )
}
