//! The longest sightlines, one for each lane.

use serde::Serialize;

use super::room_of;
use crate::cells::CellGraph;
use crate::level::Level;
use crate::pvs::longest::{Line, Longest};

/// A long sightline. Lines as near to it as one likes are free; it may touch corners itself.
#[derive(Clone, Debug, Serialize)]
pub struct Lane {
    /// Its ends, in the level's own coordinates.
    pub from: [f64; 2],
    /// The other one.
    pub to: [f64; 2],
    /// Its length in the level's unit.
    pub length: f64,
    /// The cells in which it ends.
    pub cells: [u32; 2],
    /// Their rooms or sectors.
    pub rooms: [Option<String>; 2],
}

/// The longest lanes. A line is another lane unless it runs beside a longer one.
pub fn of(level: &Level, graph: &CellGraph, longest: &Longest, n: usize) -> Vec<Lane> {
    let mut chosen: Vec<&Line> = Vec::new();
    for line in &longest.lines {
        if chosen.len() == n {
            break;
        }
        if !chosen.iter().any(|long| runs_beside(line, long)) {
            chosen.push(line);
        }
    }
    let at = |p: glam::DVec2| graph.grid.offset_to_level(p.x, p.y).to_array();
    let lane = |line: &Line| Lane {
        from: at(line.from),
        to: at(line.to),
        length: graph.grid.step.to_units(line.length()),
        cells: line.cells.map(|c| c.0),
        rooms: line.cells.map(|c| room_of(level, graph, c)),
    };
    chosen.into_iter().map(lane).collect()
}

/// Whether a line stays near a longer one: both its ends are nearer to it than an eighth of its own
/// length.
fn runs_beside(line: &Line, long: &Line) -> bool {
    let near = line.length() / 8.0;
    let along = long.to - long.from;
    let distance = |p: glam::DVec2| {
        let t = (p - long.from).dot(along) / along.length_squared();
        p.distance(long.from + along * t.clamp(0.0, 1.0))
    };
    distance(line.from) < near && distance(line.to) < near
}
