//! Why one cell sees another, or why not.
//!
//! In: a graph, its exact PVS, and two cells. Out: an [`Explanation`]. For cells that see each other
//! that is a sightline with the portals it crosses, the width of the view, and the wall ends that
//! bound it ([`View`]). For cells that do not, the shortest way from the one to the other, how far
//! along it sight gets, and the few wall ends that no line passes as it would have to ([`Hidden`]).

mod chain;
mod corner;
mod segment;
mod space;
mod straight;
mod strip;
mod view;
mod way;

pub use chain::gates;
pub use corner::{Corner, corner_at, corners_of, edges_at};
pub use segment::{Point, Segment};
pub use space::Space;
pub use straight::{Straight, straight};
pub use strip::Strip;
pub use view::{Beside, View, last_cell};
pub use way::Way;

use glam::DVec2;

use super::Pvs;
use super::heights::HeightsOptions;
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::{GridPoint, VertexId};
use crate::sight::Contradiction;

/// Options of [`explain`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExplainOptions {
    /// Steps after which the search for a wider view ends.
    pub max_steps: u64,
    /// Where the way on foot starts and ends, in grid steps, inside of the two cells; `None`: in the
    /// cells' middles.
    pub points: Option<[DVec2; 2]>,
    /// Whether floors and ceilings count, and how hard to try.
    pub heights: Option<HeightsOptions>,
}

impl Default for ExplainOptions {
    fn default() -> Self {
        Self {
            max_steps: 100_000,
            points: None,
            heights: None,
        }
    }
}

/// Why one cell sees another, or why not.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant)] // one at a time is made
pub enum Explanation {
    /// Both are one cell: nothing stands in it.
    Same,
    /// They see each other on the plan; [`View::space`] tells whether they do with heights.
    Visible(View),
    /// They do not.
    Hidden(Hidden),
    /// They do not, and no way leads from the one to the other.
    Apart,
}

impl Explanation {
    /// Whether the two cells see each other, as far as is known: with heights, if those were asked
    /// for.
    pub fn sees(&self) -> bool {
        match self {
            Explanation::Same => true,
            Explanation::Visible(view) => !matches!(view.space, Some(Space::Blocked(_))),
            Explanation::Hidden(_) | Explanation::Apart => false,
        }
    }
}

/// Why one cell does not see another.
#[derive(Clone, Debug, PartialEq)]
pub struct Hidden {
    /// The shortest way.
    pub way: Way,
    /// Position in the way's portals of the first one behind which the first cell sees nothing,
    /// neither along this way nor along another.
    pub stop: usize,
    /// Ends of the way's portals (those up to that one, if they will do) between which a line along
    /// the way would have to pass, and cannot: walls, if walls alone prove it. That all other ways
    /// fail too, the PVS says.
    pub ends: Contradiction,
}

/// Explains what `pvs` says of two cells. It must be the graph's exact PVS on the plan.
pub fn explain(
    graph: &CellGraph,
    pvs: &Pvs,
    a: CellId,
    b: CellId,
    options: &ExplainOptions,
) -> Option<Explanation> {
    if a == b {
        return Some(Explanation::Same);
    }
    if pvs.sees(a, b) {
        let best = chain::widest(graph, pvs, a, b, options.max_steps)?;
        let mut view = view::view(graph, a, b, &best)?;
        view.space = options
            .heights
            .map(|heights| space::space(graph, a, b, &view.portals, &heights));
        return Some(Explanation::Visible(view));
    }
    let [from, to] = options
        .points
        .unwrap_or_else(|| [a, b].map(|cell| middle(graph, cell)));
    let exact = |p: DVec2| Point::rounded(p, 20).vertex();
    let Some(way) = way::shortest(graph, (a, exact(from)?), (b, exact(to)?)) else {
        return Some(Explanation::Apart);
    };
    hidden(graph, pvs, a, way).map(Explanation::Hidden)
}

/// The mean of a cell's corners, in grid steps.
pub fn middle(graph: &CellGraph, cell: CellId) -> DVec2 {
    let corners = graph.polygon(cell);
    let sum: DVec2 = corners.iter().map(|&v| graph.vertices.approx(v)).sum();
    sum / corners.len().max(1) as f64
}

/// The grid point nearest to a cell's middle, if it lies inside.
pub fn point_inside(graph: &CellGraph, cell: CellId) -> Option<GridPoint> {
    let at = Point::rounded(middle(graph, cell), 0);
    at.grid().filter(|_| segment::is_inside(graph, cell, &at))
}

/// What stops sight along a way to a cell that is not seen.
fn hidden(graph: &CellGraph, pvs: &Pvs, a: CellId, way: Way) -> Option<Hidden> {
    let beyond = |e: EdgeId| graph.edge(e).twin().map(|twin| graph.edge(twin).cell);
    let is_seen = |&e: &EdgeId| beyond(e).is_some_and(|cell| pvs.sees(a, cell));
    let stop = way.portals.iter().position(|e| !is_seen(e))?;
    // Walls say more than corners of cells at which none stands, even if it takes more of the way.
    let walls = [Corner::Jutting, Corner::Flat];
    let (seen, all) = (&way.portals[..=stop], &way.portals[..]);
    let ends = first_clash(graph, seen, &walls[..1])
        .or_else(|| first_clash(graph, seen, &walls))
        .or_else(|| first_clash(graph, all, &walls))
        .or_else(|| first_clash(graph, seen, &[walls[0], walls[1], Corner::Open]))?;
    Some(Hidden { way, stop, ends })
}

/// The contradiction among ends of some kinds that the fewest of the first portals have.
fn first_clash(graph: &CellGraph, portals: &[EdgeId], kinds: &[Corner]) -> Option<Contradiction> {
    let ends: Vec<[Option<VertexId>; 2]> = portals
        .iter()
        .map(|&e| {
            let [left, right] = corners_of(graph, e).map(|corner| kinds.contains(&corner));
            [
                left.then(|| graph.end(e)),
                right.then(|| graph.edge(e).origin),
            ]
        })
        .collect();
    let of_first = |n: usize| {
        let side = |i: usize| -> Vec<VertexId> { ends[..n].iter().filter_map(|e| e[i]).collect() };
        let (left, right) = (side(0), side(1));
        if left.is_empty() || right.is_empty() {
            return None;
        }
        strip::widest(&graph.vertices, &left, &right).err()
    };
    of_first(portals.len())?;
    // More portals only add to a contradiction.
    let (mut without, mut with) = (0, portals.len());
    while with - without > 1 {
        let middle = (without + with) / 2;
        match of_first(middle) {
            Some(_) => with = middle,
            None => without = middle,
        }
    }
    of_first(with)
}
