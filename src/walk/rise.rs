//! The eye's height along a way: over the floor, steps taken smoothly.
//!
//! In: a line on the plan. Out: the same points with heights. A walker's eye does not jump with a step;
//! so the floor is averaged along the way. On a drop that would carry the eye through the edge that he
//! jumps from: so it is also kept above the highest floor near, averaged: an average over a window of
//! the highest floor within such a window is never below the floor. In the end the eye is kept a
//! little off the floor and the ceiling that are really there.

use glam::{DVec2, DVec3};

use super::person::heights;
use crate::cells::{CellGraph, CellId, Locator};
use crate::trace::Space;
use crate::trace::space::{Border, Chamber, WALL};

/// Share of the eye's height that is kept free below it.
const BELOW: f64 = 0.25;
/// Share of the eye's height that is kept free above it, where there is room.
const ABOVE: f64 = 0.1;

/// Floors and ceilings by place.
pub struct Ground<'a> {
    graph: &'a CellGraph,
    space: &'a Space,
    locator: Locator,
}

impl<'a> Ground<'a> {
    /// The ground of a level.
    pub fn new(graph: &'a CellGraph, space: &'a Space) -> Self {
        let locator = Locator::new(graph);
        Self {
            graph,
            space,
            locator,
        }
    }

    /// A cell that holds the place.
    pub fn cell_at(&self, at: DVec2) -> Option<CellId> {
        let fine = self.graph.grid.fine(at)?;
        self.locator.cells_at(self.graph, &fine).first().copied()
    }

    pub(super) fn chamber(&self, cell: CellId) -> &Chamber {
        self.space.cell(cell.0)
    }

    fn heights(&self, cell: CellId) -> [f64; 2] {
        heights(self.chamber(cell))
    }
}

/// Crosses the cells on a straight way from a place in `cell`, in order: `visit` is told each portal
/// (its edge, as seen from the side that one comes from) and whether to go on. The cell in which the
/// way ends; `None` where a wall, or `visit`, stops it.
pub fn cross(
    space: &Space,
    mut cell: u32,
    [from, to]: [DVec2; 2],
    mut visit: impl FnMut(u32, &Border) -> bool,
) -> Option<u32> {
    let way = to - from;
    // A way through a corner may go around it through a few cells; a longer one runs in circles.
    for _ in 0..=space.cells.len() {
        let chamber = space.cell(cell);
        // The edge that the way leaves through: it has the way's line between its ends. Edges may
        // lie in line, so which lines the way crosses first does not tell.
        let mut exit = None;
        let (mut nearest, mut spare) = (f64::INFINITY, None);
        let mut outside = false;
        for e in chamber.first..chamber.past {
            let edge = space.edge(e);
            let (a, b) = (space.vertex(edge.from), space.vertex(edge.to));
            if (b - a).perp_dot(to - a) >= 0.0 {
                continue;
            }
            outside = true;
            let side = [a, b].map(|end| way.perp_dot(end - from));
            if side[0] <= 0.0 && side[1] > 0.0 {
                exit = Some(e);
                break;
            }
            // A start that rounding put outside may miss all of them: then the one it misses least.
            let miss = side[0].max(-side[1]);
            if exit.is_none() && miss < nearest {
                (nearest, spare) = (miss, Some(e));
            }
        }
        let Some(e) = exit.or(spare).filter(|_| outside) else {
            return Some(cell);
        };
        let edge = space.edge(e);
        if edge.twin == WALL || !visit(e, edge) {
            return None;
        }
        cell = space.edge(edge.twin).cell;
    }
    None
}

/// The points with the eye's heights. `reach` is the length over which a step is spread, on each side.
pub fn over(ground: &Ground, plan: &[DVec2], closed: bool, eye: f64, reach: f64) -> Vec<DVec3> {
    let n = plan.len();
    if n == 0 {
        return Vec::new();
    }
    let mut floors = vec![f64::NAN; n];
    let (mut low, mut high) = (vec![f64::NEG_INFINITY; n], vec![f64::INFINITY; n]);
    let mut cell: Option<u32> = None;
    for i in 0..n {
        cell = cell.or_else(|| ground.cell_at(plan[i]).map(|c| c.0));
        let Some(here) = cell else {
            continue;
        };
        let [floor, ceiling] = ground.heights(CellId(here));
        floors[i] = floor;
        low[i] = low[i].max(floor);
        high[i] = high[i].min(ceiling);
        let Some(&next) = plan.get(i + 1) else {
            continue;
        };
        // What is passed on the way to the next point counts for both.
        let mut pass = |bottom: f64, top: f64| {
            for k in [i, i + 1] {
                low[k] = low[k].max(bottom);
                high[k] = high[k].min(top);
            }
        };
        let space = ground.space;
        cell = cross(space, here, [plan[i], next], |_, edge| {
            let beyond = CellId(space.edge(edge.twin).cell);
            let [floor, ceiling] = ground.heights(beyond);
            pass(edge.bottom.max(floor), edge.top.min(ceiling));
            true
        });
    }
    // Outside of the level the walk goes on at the height that it had.
    let mut last = floors.iter().copied().find(|z| !z.is_nan()).unwrap_or(0.0);
    for (floor, low) in floors.iter_mut().zip(&mut low) {
        if floor.is_nan() {
            *floor = last;
        }
        last = *floor;
        *low = low.max(*floor);
    }
    let lengths = lengths(plan);
    let line = Line {
        lengths: &lengths,
        closed,
        reach: reach.min(lengths[n - 1]),
    };
    let usual = line.mean(&floors);
    let above = line.mean(&line.highest(&low));
    (0..n)
        .map(|i| {
            let z = (usual[i] + eye).max(above[i] + eye * 0.5);
            let (least, most) = (low[i] + eye * BELOW, high[i] - eye * ABOVE);
            plan[i].extend(if least < most {
                z.clamp(least, most)
            } else {
                (low[i] + high[i]) / 2.0
            })
        })
        .collect()
}

fn lengths(plan: &[DVec2]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for pair in plan.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
    }
    lengths
}

/// A line, for windows of `reach` to both sides along it.
struct Line<'a> {
    lengths: &'a [f64],
    closed: bool,
    reach: f64,
}

impl Line<'_> {
    /// Mean of the values (linear between points) within reach of each point.
    fn mean(&self, values: &[f64]) -> Vec<f64> {
        let n = values.len();
        let whole = self.lengths[n - 1];
        if self.reach == 0.0 {
            return values.to_vec();
        }
        let mut areas = vec![0.0];
        for i in 1..n {
            let part = self.lengths[i] - self.lengths[i - 1];
            areas.push(areas[i - 1] + (values[i] + values[i - 1]) / 2.0 * part);
        }
        let all = areas[n - 1];
        let area = |at: f64| -> f64 {
            if at < 0.0 || at > whole {
                let (beyond, shift) = if at < 0.0 {
                    (at, 0.0)
                } else {
                    (at - whole, all)
                };
                if !self.closed {
                    let end = if at < 0.0 { values[0] } else { values[n - 1] };
                    return shift + end * beyond;
                }
                let inside = if at < 0.0 { at + whole } else { at - whole };
                let lap = if at < 0.0 { -all } else { all };
                return lap + self.area(values, &areas, inside);
            }
            self.area(values, &areas, at)
        };
        let window =
            |&at: &f64| (area(at + self.reach) - area(at - self.reach)) / (2.0 * self.reach);
        self.lengths.iter().map(window).collect()
    }

    /// Area under the values from the start to a length within the line.
    fn area(&self, values: &[f64], areas: &[f64], at: f64) -> f64 {
        let i = self.lengths.partition_point(|l| *l <= at);
        let i = i.clamp(1, self.lengths.len().max(2) - 1) - 1;
        if i + 1 >= values.len() {
            return areas[i];
        }
        let (past, part) = (at - self.lengths[i], self.lengths[i + 1] - self.lengths[i]);
        let value = values[i] + (values[i + 1] - values[i]) * (past / part / 2.0);
        areas[i] + value * past
    }

    /// Largest value within reach of each point, both ends of a part that the reach ends in included.
    fn highest(&self, values: &[f64]) -> Vec<f64> {
        let n = values.len();
        let whole = self.lengths[n - 1];
        (0..n)
            .map(|i| {
                let at = self.lengths[i];
                let range = |from: f64, to: f64| {
                    let first = self.lengths.partition_point(|l| *l <= from).max(1) - 1;
                    let past = self.lengths.partition_point(|l| *l < to).min(n - 1) + 1;
                    let part = values[first..past].iter().copied();
                    part.fold(f64::NEG_INFINITY, f64::max)
                };
                let mut top = range(at - self.reach, at + self.reach);
                if self.closed && at < self.reach {
                    top = top.max(range(whole + at - self.reach, whole));
                }
                if self.closed && at + self.reach > whole {
                    top = top.max(range(0.0, at + self.reach - whole));
                }
                top
            })
            .collect()
    }
}
