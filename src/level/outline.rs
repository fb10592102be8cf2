//! Closed outlines on the grid: their corners, and whether they are those of simple polygons.
//!
//! In: grid points. Out: exact answers. Used by the reader of the own format (which refuses outlines
//! that cross themselves), by its writer, and by [`super::edit`].

use crate::geom::GridPoint;

use super::model::{Level, Outline, Wall};

/// The corners of each outline, in the order of its walls; `None` where these do not go once around.
pub fn corners(level: &Level) -> Vec<Option<Vec<GridPoint>>> {
    let mut walls: Vec<Vec<&Wall>> = vec![Vec::new(); level.outlines.len()];
    for wall in &level.walls {
        if let Some(list) = wall.outline.and_then(|id| walls.get_mut(id.0 as usize)) {
            list.push(wall);
        }
    }
    walls.iter().map(|walls| around(walls)).collect()
}

fn around(walls: &[&Wall]) -> Option<Vec<GridPoint>> {
    let closes = |i: usize| walls[i].to == walls[(i + 1) % walls.len()].from;
    let closed = walls.len() >= 3 && (0..walls.len()).all(closes);
    closed.then(|| walls.iter().map(|w| w.from).collect())
}

/// What kind of area an outline bounds: the word of the own format.
pub fn kind(area: &Outline) -> &'static str {
    match (area.sector, area.zone) {
        (None, _) => "pillar",
        (Some(_), true) => "zone",
        (Some(_), false) => "room",
    }
}

/// What messages call an area.
pub fn called(level: &Level, area: &Outline) -> String {
    let sector = area.sector.and_then(|s| level.sectors.get(s.0 as usize));
    match sector.and_then(|s| s.name.as_deref()) {
        Some(name) => format!("the {} `{name}`", kind(area)),
        None => format!("a {}", kind(area)),
    }
}

/// Two edges of a polygon that meet elsewhere than in the corner that neighbours share: the later
/// one and the earlier one, by their first corners.
pub fn self_meeting(points: &[GridPoint]) -> Option<(usize, usize)> {
    let n = points.len();
    (0..n)
        .flat_map(|i| (i + 1..n).map(move |j| (j, i)))
        .find(|&(j, i)| edges_meet(points, i, j))
}

/// Twice the area of a polygon; above 0 where its corners run counterclockwise.
pub fn doubled_area(points: &[GridPoint]) -> i128 {
    let n = points.len();
    (0..n)
        .map(|i| cross(points[0], points[i], points[(i + 1) % n]))
        .sum()
}

/// Whether edges `i < j` share more than the corner that neighbours share.
fn edges_meet(points: &[GridPoint], i: usize, j: usize) -> bool {
    let n = points.len();
    let (a, b) = (points[i], points[(i + 1) % n]);
    let (c, d) = (points[j], points[(j + 1) % n]);
    if j == i + 1 {
        return folds_back(a, b, d);
    }
    if (j + 1) % n == i {
        return folds_back(c, a, b);
    }
    let crosses = side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
    crosses || is_on(a, b, c) || is_on(a, b, d) || is_on(c, d, a) || is_on(c, d, b)
}

/// Whether the edge from `b` to `c` runs back along the edge from `a` to `b`.
fn folds_back(a: GridPoint, b: GridPoint, c: GridPoint) -> bool {
    side(a, b, c) == 0 && dot(b, a, c) > 0
}

/// Whether `r` lies on the closed segment from `p` to `q`.
pub fn is_on(p: GridPoint, q: GridPoint, r: GridPoint) -> bool {
    side(p, q, r) == 0 && dot(p, r, q) >= 0 && dot(q, r, p) >= 0
}

/// 1 where `p` is left of the line from `a` to `b`, -1 where right, 0 on it.
pub fn side(a: GridPoint, b: GridPoint, p: GridPoint) -> i128 {
    cross(a, b, p).signum()
}

fn cross(a: GridPoint, b: GridPoint, p: GridPoint) -> i128 {
    let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    dx * i128::from(p.y - a.y) - dy * i128::from(p.x - a.x)
}

/// Dot product of `b - a` and `c - a`.
fn dot(a: GridPoint, b: GridPoint, c: GridPoint) -> i128 {
    let (dx, dy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    dx * i128::from(c.x - a.x) + dy * i128::from(c.y - a.y)
}
