//! Openings with their names, what closing them would save, and the dearest places with the openings
//! that make them dear.

use serde::Serialize;

use super::{LISTED, Measure, Tally, room_of};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::level::{Level, OpeningStyle, WallKind};
use crate::pvs::closing::{self, Common, Opening, Saving};
use crate::pvs::{Progress, Pvs, sweep};

/// A straight gap between two walls, and what closing it would save.
#[derive(Clone, Debug, Serialize)]
pub struct Gap {
    /// `door`, `window`, `archway`, `sector edge` or `gap` (within one place).
    pub kind: &'static str,
    /// Its name in the level, if it has one.
    pub name: Option<String>,
    /// What people may call it: `door between Hall and Atrium`.
    pub title: String,
    /// Its ends, in the level's own coordinates.
    pub segment: [[f64; 2]; 2],
    /// Its length, in the level's unit.
    pub length: f64,
    /// Its portals, as indices into `portals`.
    pub portals: Vec<u32>,
    /// The cells on its left and on its right, seen from its first end to its second.
    pub cells: [Vec<u32>; 2],
    /// Ordered pairs of cells that see each other only through it.
    pub pairs: u64,
    /// That as a share of all visible pairs: by so much the mean visible set would shrink.
    pub share: f64,
    /// By so much the mean number of visible polygons would shrink, as a share of it.
    pub polygons_share: f64,
    /// By so much the area would shrink that somebody sees who stands anywhere: the mean over the ground,
    /// which does not depend on how the ground is cut into cells.
    pub ground_share: f64,
    /// What a shorter wall in its middle would save, where that was asked for.
    pub wall: Option<Wall>,
    /// Its edges.
    #[serde(skip)]
    pub opening: Opening,
}

/// A wall in the middle of a gap, and what it would save.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Wall {
    /// Its ends, in the level's own coordinates.
    pub segment: [[f64; 2]; 2],
    /// Its length, in the level's unit: what was asked for, or the whole gap.
    pub length: f64,
    /// Ordered pairs of cells that would no longer see each other.
    pub pairs: u64,
    /// That as a share of all visible pairs.
    pub share: f64,
}

/// What an opening lets one cell see.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Hides {
    /// The opening, as an index into the list of gaps.
    pub gap: u32,
    /// Cells that would be hidden if it were closed.
    pub cells: f64,
    /// Polygons in them.
    pub polygons: f64,
    /// Their area.
    pub area: f64,
}

/// A dear place.
#[derive(Clone, Debug, Serialize)]
pub struct Worst {
    /// The cell.
    pub cell: u32,
    /// Its room or sector.
    pub room: Option<String>,
    /// A point inside.
    pub point: [f64; 2],
    /// What it sees.
    pub seen: Tally,
    /// The openings that let it see most, the first the worst.
    pub openings: Vec<Hides>,
}

/// Polygons where there are any, otherwise cells.
pub fn main_measure(own: &[Tally]) -> Measure {
    if own.iter().any(|t| t.polygons > 0.0) {
        Measure::Polygons
    } else {
        Measure::Cells
    }
}

/// All gaps, ranked, and the dearest places.
pub fn of(
    level: &Level,
    graph: &CellGraph,
    pvs: &Pvs,
    own: &[Tally],
    seen: &[Tally],
    progress: &Progress,
) -> (Vec<Gap>, Vec<Worst>) {
    let openings = closing::openings(graph);
    let both = |a: usize, b: usize| {
        let (a, b) = (&own[a], &own[b]);
        [a.polygons + b.polygons, 2.0 * a.area * b.area]
    };
    let common = Common::of(graph, pvs, &openings, progress);
    let savings = common.savings(both);
    let mut all = Tally::default();
    seen.iter().for_each(|t| all.add(t));
    let ground: f64 = own.iter().zip(seen).map(|(o, s)| o.area * s.area).sum();
    let gap = |(opening, saving): (&Opening, &Saving)| {
        let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
        Gap {
            pairs: saving.pairs,
            share: share(saving.pairs as f64, all.cells),
            polygons_share: share(saving.weights[0], all.polygons),
            ground_share: share(saving.weights[1], ground),
            ..named(level, graph, opening)
        }
    };
    let gaps: Vec<Gap> = openings.iter().zip(&savings).map(gap).collect();
    let mut order: Vec<usize> = (0..gaps.len()).collect();
    // The first of equal ones stays the first.
    order.sort_by_key(|&i| std::cmp::Reverse(gaps[i].pairs));
    let mut place = vec![0u32; gaps.len()];
    for (rank, &i) in (0..).zip(&order) {
        place[i] = rank;
    }
    let places = graph.cell_ids().filter(|&c| has_height(level, graph, c));
    let chosen = dearest(pvs, seen, places, main_measure(own), LISTED);
    let one = |b: usize| [own[b].polygons, own[b].area];
    let worst = chosen.iter().map(|&cell| {
        let mut openings: Vec<Hides> = common
            .savings_of(cell, one)
            .into_iter()
            .map(|(opening, saving)| Hides {
                gap: place[opening as usize],
                cells: saving.pairs as f64,
                polygons: saving.weights[0],
                area: saving.weights[1],
            })
            .collect();
        openings.sort_by(|a, b| {
            let key = |h: &Hides| (h.polygons, h.cells);
            key(b)
                .partial_cmp(&key(a))
                .unwrap_or(std::cmp::Ordering::Equal)
        });
        openings.truncate(LISTED);
        let middle = crate::pvs::explain::middle(graph, cell);
        Worst {
            cell: cell.0,
            room: room_of(level, graph, cell),
            point: graph.grid.offset_to_level(middle.x, middle.y).to_array(),
            seen: seen[cell.0 as usize],
            openings,
        }
    });
    let worst = worst.collect();
    let mut gaps: Vec<Option<Gap>> = gaps.into_iter().map(Some).collect();
    let gaps = order.into_iter().filter_map(|i| gaps[i].take()).collect();
    (gaps, worst)
}

/// What a wall of some length in the middle of each of the first gaps would save. The PVS is computed
/// anew for each.
pub fn put_walls(graph: &CellGraph, pvs: &Pvs, gaps: &mut [Gap], length: f64) {
    let steps = graph.grid.step.to_steps(length);
    let all = pvs.pairs();
    for gap in gaps.iter_mut().take(LISTED).filter(|g| g.pairs > 0) {
        let Some((walled, ends)) = graph.walled(&gap.opening.edges, steps) else {
            continue;
        };
        let pairs = all - sweep::sweep(&walled, &Progress::default()).pairs();
        gap.wall = Some(Wall {
            segment: ends.map(|p| graph.grid.offset_to_level(p.x, p.y).to_array()),
            length: graph.grid.step.to_units(ends[0].distance(ends[1])),
            pairs,
            share: pairs as f64 / all as f64,
        });
    }
}

/// Whether somebody may ever stand in a cell: where a ceiling lies on the floor and never moves (in Doom
/// maps often the rim of the sky), nobody does.
fn has_height(level: &Level, graph: &CellGraph, cell: CellId) -> bool {
    let sector = graph.cell(cell).sector;
    sector.is_none_or(|s| {
        let sector = &level.sectors[s.0 as usize];
        sector.ceiling.high > sector.floor.low
    })
}

/// The dearest of some cells. Of those that see nearly the same as one before, none, as long as there are
/// others: ten cells of one hall are one answer.
fn dearest(
    pvs: &Pvs,
    seen: &[Tally],
    places: impl Iterator<Item = CellId>,
    measure: Measure,
    n: usize,
) -> Vec<CellId> {
    /// Two sets are nearly the same if more than four fifths of both together are in both.
    const SAME: f64 = 0.8;
    let mut order: Vec<usize> = places.map(|c| c.0 as usize).collect();
    order.sort_by(|&a, &b| seen[b].get(measure).total_cmp(&seen[a].get(measure)));
    let mut chosen: Vec<usize> = Vec::new();
    for &cell in &order {
        if chosen.len() == n {
            break;
        }
        let row = pvs.visible.row(cell);
        let like = |&other: &usize| {
            let (mut both, mut either) = (0, 0);
            for (a, b) in row.iter().zip(pvs.visible.row(other)) {
                both += (a & b).count_ones();
                either += (a | b).count_ones();
            }
            f64::from(both) > SAME * f64::from(either)
        };
        if !chosen.iter().any(like) {
            chosen.push(cell);
        }
    }
    chosen.into_iter().map(|c| CellId(c as u32)).collect()
}

/// A gap with its names; nothing about savings yet.
fn named(level: &Level, graph: &CellGraph, opening: &Opening) -> Gap {
    let edges = &opening.edges;
    let cells_on = |of: &dyn Fn(EdgeId) -> Option<EdgeId>| -> Vec<u32> {
        let cells = edges.iter().filter_map(|&e| of(e));
        cells.map(|e| graph.edge(e).cell.0).collect()
    };
    let twin = |e: EdgeId| graph.edge(e).twin();
    let cells = [cells_on(&Some), cells_on(&twin)];
    let portals = edges.iter().filter_map(|&e| {
        let first = e.min(twin(e)?);
        let at = graph.portals.binary_search_by_key(&first, |p| p.edges[0]);
        at.ok().map(|i| i as u32)
    });
    let portals = portals.collect();
    let [from, to] = opening.ends.map(|v| graph.vertices.approx(v));
    let (kind, name) = kind(level, graph, edges);
    // The room in the middle of either side.
    let middle = edges[edges.len() / 2];
    let rooms = [Some(middle), twin(middle)]
        .map(|e| e.and_then(|e| room_of(level, graph, graph.edge(e).cell)));
    Gap {
        kind,
        title: title(kind, name.as_deref(), &rooms),
        name,
        segment: [from, to].map(|p| graph.grid.offset_to_level(p.x, p.y).to_array()),
        length: graph.grid.step.to_units(from.distance(to)),
        portals,
        cells,
        pairs: 0,
        share: 0.0,
        polygons_share: 0.0,
        ground_share: 0.0,
        wall: None,
        opening: opening.clone(),
    }
}

fn kind(level: &Level, graph: &CellGraph, edges: &[EdgeId]) -> (&'static str, Option<String>) {
    let kinds = edges.iter().map(|&e| {
        let wall = graph.edge(e).wall();
        match wall.map(|w| &level.walls[w.0 as usize].kind) {
            Some(WallKind::Opening(opening)) => {
                let style = match opening.style {
                    OpeningStyle::Door => "door",
                    OpeningStyle::Window => "window",
                    OpeningStyle::Archway => "archway",
                };
                (0, style, opening.name.clone())
            }
            Some(WallKind::Edge { shut: true }) => (1, "door", None),
            Some(WallKind::Edge { shut: false }) => (2, "sector edge", None),
            _ => (3, "gap", None),
        }
    });
    let best = kinds.min_by_key(|k| k.0);
    best.map_or(("gap", None), |(_, kind, name)| (kind, name))
}

fn title(kind: &str, name: Option<&str>, rooms: &[Option<String>; 2]) -> String {
    let what = match name {
        Some(name) => format!("{kind} ‘{name}’"),
        None => kind.to_string(),
    };
    match rooms {
        [Some(a), Some(b)] if a == b => format!("{what} across {a}"),
        [Some(a), Some(b)] => format!("{what} between {a} and {b}"),
        [Some(a), None] | [None, Some(a)] => format!("{what} of {a}"),
        [None, None] => what,
    }
}
