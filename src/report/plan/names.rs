//! Names of rooms, where they fit between the walls.

use glam::{DVec2, Vec2Swizzles};
use svg::node::element::Group;

use super::sheet::{Sheet, short};
use super::{text, text_width};
use crate::cells::{CellGraph, EdgeId};
use crate::geom::VertexId;
use crate::level::Level;

/// Sizes of letters, from the one that looks best to the smallest that can be read.
const SIZES: [f64; 3] = [14.0, 11.5, 9.5];
/// Free space around a name, in parts of its size.
const AIR: f64 = 0.35;

/// A rectangle on the page.
#[derive(Clone, Copy, Debug)]
struct Frame {
    low: DVec2,
    high: DVec2,
}

/// The names of all rooms and zones that have room for them, rooms in file order first.
pub fn of_rooms(level: &Level, graph: &CellGraph, sheet: &Sheet, colours: &[&str]) -> Group {
    beside(level, graph, sheet, colours, &[])
}

/// As [`of_rooms`], but none on some lines on the page.
pub fn beside(
    level: &Level,
    graph: &CellGraph,
    sheet: &Sheet,
    colours: &[&str],
    off: &[[DVec2; 2]],
) -> Group {
    let mut group = Group::new().set("id", "names").set("text-anchor", "middle");
    let [corner, size] = sheet.frame();
    let shown = [corner, corner + size];
    for (i, label) in labels(level, graph, |v| sheet.vertex(graph, v), shown, off) {
        group = label.draw(group, colours.get(i).copied().unwrap_or("white"));
    }
    group
}

/// The names of rooms and zones for which there is room, each with the index of its sector. `at` tells
/// where a vertex lies on the page, `shown` is its part that is shown, by its least and its greatest
/// corner; `off` are lines on which no name should lie.
pub fn labels(
    level: &Level,
    graph: &CellGraph,
    at: impl Fn(VertexId) -> DVec2,
    [low, high]: [DVec2; 2],
    off: &[[DVec2; 2]],
) -> Vec<(usize, Label)> {
    let mut labels: Vec<(usize, Label)> = Vec::new();
    if level.sectors.iter().all(|s| s.name.is_none()) {
        return labels;
    }
    // Everything that a name should not lie on: all but the borders that the subdivision made.
    let mut lines: Vec<[DVec2; 2]> = off.to_vec();
    for id in (0..graph.edges.len() as u32).map(EdgeId) {
        if graph.edge(id).twin().is_none() || graph.edge(id).wall().is_some() {
            lines.push([graph.edge(id).origin, graph.end(id)].map(&at));
        }
    }
    let mut cells: Vec<Vec<Vec<DVec2>>> = vec![Vec::new(); level.sectors.len()];
    for cell in graph.cell_ids() {
        if let Some(sector) = graph.cell(cell).sector {
            let corners = graph.polygon(cell).into_iter().map(&at);
            cells[sector.0 as usize].push(corners.collect());
        }
    }
    let shown = Frame { low, high };
    let mut taken: Vec<Frame> = Vec::new();
    for (i, sector) in level.sectors.iter().enumerate() {
        let Some(name) = &sector.name else { continue };
        if let Some(label) = place(name, &cells[i], &lines, &taken, &shown) {
            taken.push(label.frame());
            labels.push((i, label));
        }
    }
    labels
}

/// A name in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// In one row or in two.
    pub rows: Vec<String>,
    /// Size of the letters.
    pub size: f64,
    /// Whether it is turned by a quarter, counterclockwise.
    pub upright: bool,
    /// Its middle.
    pub at: DVec2,
}

impl Label {
    fn frame(&self) -> Frame {
        let width = self
            .rows
            .iter()
            .map(|r| text_width(r, self.size))
            .fold(0.0, f64::max);
        let height = self.size * (1.15 * self.rows.len() as f64 - 0.3);
        let half = DVec2::new(width / 2.0, height / 2.0) + self.size * AIR;
        let half = if self.upright { half.yx() } else { half };
        Frame {
            low: self.at - half,
            high: self.at + half,
        }
    }

    /// The rows, and the middle of each one's baseline before the whole is turned.
    pub fn baselines(&self) -> impl Iterator<Item = (&str, DVec2)> {
        let n = self.rows.len() as f64;
        (0..).zip(&self.rows).map(move |(i, row)| {
            // Capitals are about 0.7 of the size high.
            let down = self.size * (0.35 + 1.15 * (f64::from(i) - (n - 1.0) / 2.0));
            (row.as_str(), self.at + DVec2::new(0.0, down))
        })
    }

    fn draw(&self, mut group: Group, ground: &str) -> Group {
        for (row, at) in self.baselines() {
            let mut row = text(row, at.x, at.y, self.size)
                .set("stroke", ground.to_string())
                .set("stroke-width", 3)
                .set("stroke-linejoin", "round")
                .set("paint-order", "stroke");
            if self.upright {
                let about = format!("rotate(-90 {} {})", short(self.at.x), short(self.at.y));
                row = row.set("transform", about);
            }
            group = group.add(row);
        }
        group
    }
}

/// The best place for a name: the largest letters that fit, level if they can be, as near to the
/// middle as they do.
fn place(
    name: &str,
    cells: &[Vec<DVec2>],
    lines: &[[DVec2; 2]],
    taken: &[Frame],
    shown: &Frame,
) -> Option<Label> {
    let area: f64 = cells.iter().map(|c| polygon_area(c)).sum();
    let middle = cells
        .iter()
        .map(|c| centroid(c) * polygon_area(c))
        .sum::<DVec2>()
        / area;
    if !middle.is_finite() {
        return None;
    }
    let points = || cells.iter().flatten().copied();
    let (low, high) = points().fold((middle, middle), |(l, h), p| (l.min(p), h.max(p)));
    // Of a room that is shown in part, that part.
    let (low, high) = (low.max(shown.low), high.min(shown.high));
    let middle = middle.clamp(shown.low, shown.high);
    let mut spots: Vec<DVec2> = cells.iter().map(|c| centroid(c)).collect();
    const STEPS: usize = 24;
    for i in 1..STEPS {
        for j in 1..STEPS {
            let part = DVec2::new(i as f64, j as f64) / STEPS as f64;
            spots.push(low + (high - low) * part);
        }
    }
    spots.push(middle);
    spots.retain(|&p| cells.iter().any(|c| holds(c, p)));
    spots.sort_by(|a, b| {
        a.distance_squared(middle)
            .total_cmp(&b.distance_squared(middle))
    });
    // Only lines near the room matter.
    let around = Frame { low, high };
    let lines: Vec<_> = lines.iter().filter(|l| meets(l, &around)).collect();
    for upright in [false, true] {
        for (size, rows) in SIZES.iter().flat_map(|&s| rows(name).map(move |r| (s, r))) {
            for &at in &spots {
                let label = Label {
                    rows: rows.clone(),
                    size,
                    upright,
                    at,
                };
                let frame = label.frame();
                let free = frame.low.cmpge(shown.low).all()
                    && frame.high.cmple(shown.high).all()
                    && !lines.iter().any(|l| meets(l, &frame))
                    && !taken.iter().any(|t| overlap(t, &frame));
                if free {
                    return Some(label);
                }
            }
        }
    }
    None
}

/// A name in one row, and in two.
fn rows(name: &str) -> impl Iterator<Item = Vec<String>> {
    let middle = name.len() as f64 / 2.0;
    let spaces = name.match_indices(' ').map(|(i, _)| i);
    let space = spaces.min_by(|&i, &j| {
        (i as f64 - middle)
            .abs()
            .total_cmp(&(j as f64 - middle).abs())
    });
    let two = space.map(|i| vec![name[..i].to_string(), name[i + 1..].to_string()]);
    [Some(vec![name.to_string()]), two].into_iter().flatten()
}

fn polygon_area(points: &[DVec2]) -> f64 {
    let n = points.len();
    let cross = (0..n)
        .map(|i| points[i].perp_dot(points[(i + 1) % n]))
        .sum::<f64>();
    cross.abs() / 2.0
}

fn centroid(points: &[DVec2]) -> DVec2 {
    let mean = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for i in 0..points.len() {
        let (p, q) = (points[i] - mean, points[(i + 1) % points.len()] - mean);
        sum += (p + q) * p.perp_dot(q) / 3.0;
        area += p.perp_dot(q);
    }
    if area == 0.0 { mean } else { mean + sum / area }
}

/// Whether a convex polygon, either way round, holds a point.
fn holds(points: &[DVec2], p: DVec2) -> bool {
    let n = points.len();
    let turn = |i: usize| (points[(i + 1) % n] - points[i]).perp_dot(p - points[i]);
    (0..n).all(|i| turn(i) >= 0.0) || (0..n).all(|i| turn(i) <= 0.0)
}

fn overlap(a: &Frame, b: &Frame) -> bool {
    a.low.cmplt(b.high).all() && b.low.cmplt(a.high).all()
}

/// Whether a segment meets a rectangle.
fn meets([p, q]: &[DVec2; 2], frame: &Frame) -> bool {
    if p.max(*q).cmplt(frame.low).any() || p.min(*q).cmpgt(frame.high).any() {
        return false;
    }
    // The extents overlap; apart only if all corners lie on one side of the segment's line.
    let Frame { low, high } = *frame;
    let corners = [
        low,
        DVec2::new(high.x, low.y),
        high,
        DVec2::new(low.x, high.y),
    ];
    let sides = corners.map(|c| (*q - *p).perp_dot(c - *p));
    !(sides.iter().all(|&s| s > 0.0) || sides.iter().all(|&s| s < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_and_rectangles() {
        let frame = Frame {
            low: DVec2::ZERO,
            high: DVec2::new(4.0, 2.0),
        };
        let meets =
            |a: [f64; 4]| super::meets(&[DVec2::new(a[0], a[1]), DVec2::new(a[2], a[3])], &frame);
        assert!(meets([-1.0, 1.0, 5.0, 1.0]));
        assert!(meets([1.0, 1.0, 2.0, 1.0]));
        assert!(!meets([-1.0, 0.5, 0.5, 3.0]));
        assert!(!meets([5.0, 0.0, 5.0, 2.0]));
    }

    #[test]
    fn long_names_go_into_two_rows() {
        let all: Vec<_> = rows("Old North Wing").collect();
        assert_eq!(all[1], ["Old North", "Wing"]);
        assert_eq!(rows("Hall").count(), 1);
    }
}
