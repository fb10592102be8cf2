//! What changed since an earlier report, place by place.
//!
//! In: the JSON of an earlier report (or of `build`), and today's figures. Cells are matched by place,
//! not by number: a cell stands for its middle, and is compared with the cell that held this point
//! before. What it sees is compared by place, too: a cell that is seen now is new in sight when the
//! point in its middle was not seen before, and one that was seen is lost when its middle no longer is.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::json::Totals;
use super::{Costs, LISTED, room_of};
use crate::cells::{CellGraph, CellId};
use crate::pvs::BitMatrix;
use crate::report::json;

/// What an earlier report says.
#[derive(Debug, Deserialize)]
pub struct Baseline {
    format: String,
    level: OldLevel,
    cells: Vec<OldCell>,
    visible: Vec<Vec<u32>>,
    totals: Option<Totals>,
}

#[derive(Debug, Deserialize)]
struct OldLevel {
    name: String,
    source: String,
    unit: String,
}

#[derive(Debug, Deserialize)]
struct OldCell {
    polygon: Vec<[f64; 2]>,
}

/// Why a text is no baseline.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    /// It is no JSON, or has not the keys that it needs.
    #[error("it is not the JSON of `report` or `build`: {0}")]
    Json(#[from] serde_json::Error),
    /// It is something else.
    #[error("it is a document of format `{0}`; give the JSON of `report` or `build`")]
    Format(String),
    /// Its visible sets do not fit its cells.
    #[error("its visible sets do not fit its cells; write it anew")]
    Sets,
    /// It measures in something else.
    #[error("it is in the unit `{0}`, the level in `{1}`: they cannot be compared")]
    Unit(String, String),
}

/// Reads an earlier report.
///
/// # Errors
/// If it is none, or contradicts itself.
pub fn read(text: &[u8]) -> Result<Baseline, BaselineError> {
    let baseline: Baseline = serde_json::from_slice(text)?;
    if !["enfilade.report", "enfilade.pvs"].contains(&&*baseline.format) {
        return Err(BaselineError::Format(baseline.format));
    }
    let n = baseline.cells.len();
    let fits = |row: &Vec<u32>| row.iter().all(|&c| (c as usize) < n);
    if baseline.visible.len() != n || !baseline.visible.iter().all(fits) {
        return Err(BaselineError::Sets);
    }
    Ok(baseline)
}

/// What changed.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// The earlier level's name and file.
    pub baseline: [String; 2],
    /// Its figures, where it has them.
    pub before: Option<Totals>,
    /// Today's.
    pub after: Totals,
    /// Cells now whose place lay in no cell before.
    pub new_cells: u32,
    /// Cells before whose place lies in none now.
    pub gone_cells: u32,
    /// Cells that see more or less than before.
    pub changed: u32,
    /// Mean visible area by ground before, on the ground that is there now and was before.
    pub mean_ground_before: f64,
    /// The same now.
    pub mean_ground_after: f64,
    /// The places that gained most, the first most.
    pub grown: Vec<Change>,
    /// The places that lost most.
    pub shrunk: Vec<Change>,
    /// Of each cell, by how much the area that it sees has grown; none for new ground.
    pub growth: Vec<Option<f64>>,
}

/// How what one cell sees has changed.
#[derive(Clone, Debug, Serialize)]
pub struct Change {
    /// The cell now.
    pub cell: u32,
    /// Its room or sector.
    pub room: Option<String>,
    /// A point inside.
    pub point: [f64; 2],
    /// Area that came into sight.
    pub gained: f64,
    /// Area that went out of sight.
    pub lost: f64,
}

/// Compares today's figures with an earlier report.
///
/// # Errors
/// If they are of different kinds.
pub fn compare(costs: &Costs, old: &Baseline) -> Result<Comparison, BaselineError> {
    let graph = costs.graph;
    if old.level.unit != costs.level.unit {
        let units = [&old.level.unit, &costs.level.unit].map(String::clone);
        let [old, new] = units;
        return Err(BaselineError::Unit(old, new));
    }
    let polygon = |c: &OldCell| c.polygon.iter().map(|&p| DVec2::from(p)).collect();
    let old_places = Places::of(old.cells.iter().map(polygon).collect());
    let new_places = Places::of(polygons(graph));
    let to_old: Vec<Option<usize>> = new_places.map_to(&old_places);
    let to_new: Vec<Option<usize>> = old_places.map_to(&new_places);
    let mut visible = BitMatrix::new(old.cells.len());
    for (i, row) in old.visible.iter().enumerate() {
        row.iter().for_each(|&j| visible.set(i, j as usize));
    }
    let mut changes = Vec::new();
    let mut growth = vec![None; graph.cells.len()];
    for (i, j) in to_old.iter().enumerate() {
        let Some(j) = *j else { continue };
        let gained: f64 = costs
            .pvs
            .visible
            .ones(i)
            .filter(|&k| to_old[k].is_none_or(|k| !visible.get(j, k)))
            .map(|k| new_places.areas[k])
            .sum();
        let lost: f64 = visible
            .ones(j)
            .filter(|&m| to_new[m].is_none_or(|m| !costs.pvs.visible.get(i, m)))
            .map(|m| old_places.areas[m])
            .sum();
        growth[i] = Some(gained - lost);
        if gained > 0.0 || lost > 0.0 {
            changes.push((i, gained, lost));
        }
    }
    let list = |sign: f64| {
        let mut some: Vec<&(usize, f64, f64)> = changes
            .iter()
            .filter(|(_, gained, lost)| sign * (gained - lost) > 0.0)
            .collect();
        some.sort_by(|a, b| (sign * (b.1 - b.2)).total_cmp(&(sign * (a.1 - a.2))));
        let change = |&&(i, gained, lost): &&(usize, f64, f64)| Change {
            cell: i as u32,
            room: room_of(costs.level, graph, CellId(i as u32)),
            point: new_places.middles[i].to_array(),
            gained,
            lost,
        };
        some.iter().take(LISTED).map(change).collect()
    };
    let seen_before = |j: usize| -> f64 { visible.ones(j).map(|m| old_places.areas[m]).sum() };
    let seen_after = |i: usize| costs.seen[i].area;
    let none = |map: &[Option<usize>]| map.iter().filter(|m| m.is_none()).count() as u32;
    Ok(Comparison {
        baseline: [old.level.name.clone(), old.level.source.clone()],
        before: old.totals,
        after: Totals::of(costs),
        new_cells: none(&to_old),
        gone_cells: none(&to_new),
        changed: changes.len() as u32,
        mean_ground_before: mean_by_ground(&old_places.areas, &to_new, seen_before),
        mean_ground_after: mean_by_ground(&new_places.areas, &to_old, seen_after),
        grown: list(1.0),
        shrunk: list(-1.0),
        growth,
    })
}

/// The mean of a figure by ground, over the places that are in both levels.
fn mean_by_ground(areas: &[f64], map: &[Option<usize>], of: impl Fn(usize) -> f64) -> f64 {
    let (mut ground, mut sum) = (0.0, 0.0);
    for (i, area) in areas.iter().enumerate().filter(|(i, _)| map[*i].is_some()) {
        ground += area;
        sum += area * of(i);
    }
    if ground > 0.0 { sum / ground } else { 0.0 }
}

fn polygons(graph: &CellGraph) -> Vec<Vec<DVec2>> {
    graph.cell_ids().map(|c| json::polygon(graph, c)).collect()
}

/// Convex places with a way to find which one holds a point.
struct Places {
    polygons: Vec<Vec<DVec2>>,
    areas: Vec<f64>,
    middles: Vec<DVec2>,
    low: DVec2,
    /// Buckets per unit of length, and in a row.
    scale: DVec2,
    side: usize,
    buckets: Vec<Vec<u32>>,
}

impl Places {
    fn of(polygons: Vec<Vec<DVec2>>) -> Self {
        let points = || polygons.iter().flatten();
        let low = points().fold(DVec2::MAX, |low, p| low.min(*p));
        let high = points().fold(DVec2::MIN, |high, p| high.max(*p));
        let side = (polygons.len() as f64).sqrt().ceil().max(1.0) as usize;
        let mut places = Places {
            areas: polygons.iter().map(|p| area(p)).collect(),
            middles: polygons
                .iter()
                .map(|p| p.iter().sum::<DVec2>() / p.len().max(1) as f64)
                .collect(),
            low,
            scale: side as f64 / (high - low).max(DVec2::splat(f64::MIN_POSITIVE)),
            side,
            buckets: vec![Vec::new(); side * side],
            polygons,
        };
        for i in 0..places.polygons.len() {
            let polygon = &places.polygons[i];
            let from = polygon.iter().fold(DVec2::MAX, |low, p| low.min(*p));
            let to = polygon.iter().fold(DVec2::MIN, |high, p| high.max(*p));
            let [from, to] = [from, to].map(|p| places.bucket(p));
            for y in from[1]..=to[1] {
                for x in from[0]..=to[0] {
                    places.buckets[y * side + x].push(i as u32);
                }
            }
        }
        places
    }

    fn bucket(&self, p: DVec2) -> [usize; 2] {
        let at = ((p - self.low) * self.scale).to_array();
        at.map(|x| (x.max(0.0) as usize).min(self.side - 1))
    }

    /// The first place that holds a point.
    fn at(&self, p: DVec2) -> Option<usize> {
        let [x, y] = self.bucket(p);
        let near = self.buckets.get(y * self.side + x)?;
        let holds = |i: &&u32| {
            let polygon = &self.polygons[**i as usize];
            (0..polygon.len()).all(|k| {
                let (a, b) = (polygon[k], polygon[(k + 1) % polygon.len()]);
                (b - a).perp_dot(p - a) >= 0.0
            })
        };
        near.iter().find(holds).map(|&i| i as usize)
    }

    /// Of each place, the other's that holds its middle.
    fn map_to(&self, other: &Places) -> Vec<Option<usize>> {
        self.middles.iter().map(|&p| other.at(p)).collect()
    }
}

fn area(polygon: &[DVec2]) -> f64 {
    let Some(&first) = polygon.first() else {
        return 0.0;
    };
    let triangle = |w: &[DVec2]| (w[0] - first).perp_dot(w[1] - first) / 2.0;
    polygon.windows(2).map(triangle).sum()
}
