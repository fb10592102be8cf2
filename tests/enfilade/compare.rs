//! What must hold of every level, and how the results for two related levels compare.

use std::collections::HashMap;
use std::sync::OnceLock;

use enfilade::cells::{CellGraph, CellId, Doors, Locator, Options, Subdivision, subdivide};
use enfilade::geom::{GridPoint, Side, Vertex, orient};
use enfilade::level::Level;
use enfilade::pvs::search::search;
use enfilade::pvs::sweep::sweep;
use enfilade::pvs::{Progress, Pvs};
use rand::{Rng, RngExt};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::sightline::Sight;

/// A subdivision with its PVS.
pub struct Solved {
    pub graph: CellGraph,
    pub pvs: Pvs,
}

/// The cells of a level, checked.
pub fn cells(level: &Level, subdivision: Subdivision, doors: Doors) -> Result<CellGraph, String> {
    let graph = subdivide(
        level,
        &Options {
            subdivision,
            doors,
            ..Options::default()
        },
    );
    graph
        .validate()
        .map_err(|flaw| format!("{}: {flaw}", subdivision.as_str()))?;
    Ok(graph)
}

/// Cells and PVS by both exact methods, which must agree (search only where it needs at most
/// `max_steps`; whether it did is returned).
pub fn solve(
    level: &Level,
    subdivision: Subdivision,
    doors: Doors,
    max_steps: Option<u64>,
) -> Result<(Solved, bool), String> {
    let graph = cells(level, subdivision, doors)?;
    let name = subdivision.as_str();
    let pvs = sweep(&graph, &Progress::default());
    pvs.validate(&graph)
        .map_err(|flaw| format!("{name}, sweep: {flaw}"))?;
    let found = match max_steps {
        Some(0) => None,
        limit => search(&graph, limit, &Progress::default()),
    };
    if let Some(found) = &found {
        found
            .validate(&graph)
            .map_err(|flaw| format!("{name}, search: {flaw}"))?;
        if let Some((a, b)) = first_difference(&pvs, found, &graph) {
            let (p, q) = (show(&graph, a), show(&graph, b));
            return Err(format!(
                "{name}: sweep says {} and search says {} for cells {} {p} and {} {q}",
                pvs.sees(a, b),
                found.sees(a, b),
                a.0,
                b.0,
            ));
        }
    }
    Ok((Solved { graph, pvs }, found.is_some()))
}

fn first_difference(p: &Pvs, q: &Pvs, graph: &CellGraph) -> Option<(CellId, CellId)> {
    if p.visible == q.visible {
        return None;
    }
    let pairs = || {
        graph
            .cell_ids()
            .flat_map(|a| graph.cell_ids().map(move |b| (a, b)))
    };
    pairs().find(|&(a, b)| p.sees(a, b) != q.sees(a, b))
}

/// All three subdivisions, with both methods; all must cover the same area.
pub fn solve_all(level: &Level, doors: Doors) -> Result<Vec<Solved>, String> {
    let solved = Subdivision::ALL
        .iter()
        .map(|&s| solve(level, s, doors, None).map(|(solved, _)| solved))
        .collect::<Result<Vec<_>, _>>()?;
    let graphs: Vec<&CellGraph> = solved.iter().map(|s| &s.graph).collect();
    same_area(&graphs)?;
    Ok(solved)
}

/// Whether subdivisions of one level cover the same area (in f64, to a relative 1e-9).
pub fn same_area(graphs: &[&CellGraph]) -> Result<(), String> {
    let areas: Vec<f64> = graphs
        .iter()
        .map(|g| g.cell_ids().map(|c| g.area(c)).sum::<f64>())
        .collect();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    if areas.iter().any(|a| largest - a > 1e-9 * largest) {
        return Err(format!("the subdivisions cover different areas: {areas:?}"));
    }
    Ok(())
}

/// A cell's corners, for messages.
pub fn show(graph: &CellGraph, cell: CellId) -> String {
    let corners = graph.polygon(cell).into_iter().map(|v| {
        let p = graph.vertices.approx(v);
        format!("({}, {})", p.x, p.y)
    });
    corners.collect::<Vec<_>>().join(" ")
}

/// No free segment found at random may be missing. Returns how many were tried.
pub fn sample(
    level: &Level,
    doors: Doors,
    solved: &[Solved],
    n: usize,
    random: &mut impl Rng,
) -> Result<usize, String> {
    // A window to the outside, or a see-through line without a second side, is an edge of the cells.
    let edges = solved[0].graph.edges.iter();
    let borders = edges
        .filter(|e| e.twin().is_none())
        .filter_map(|e| e.wall())
        .collect();
    let sight = Sight::new(level, doors, &borders);
    let locators: Vec<Locator> = solved.iter().map(|s| Locator::new(&s.graph)).collect();
    let points = level.walls.iter().flat_map(|w| [w.from, w.to]);
    let reach = points.map(|p| p.x.abs().max(p.y.abs())).max().unwrap_or(1) + 1;
    let mut tried = 0;
    let graph = &solved[0].graph;
    for _ in 0..n {
        if graph.cells.is_empty() {
            break;
        }
        let cell = CellId(random.random_range(0..graph.cells.len() as u32));
        let Some(p) = point_in(graph, cell, random) else {
            continue;
        };
        if !sight.is_free(p, p) {
            continue;
        }
        let Some(q) = sight.shoot(p, reach, random) else {
            continue;
        };
        tried += 1;
        for (solved, locator) in solved.iter().zip(&locators) {
            let name = solved.graph.options.subdivision.as_str();
            let ends = [p, q].map(|p| locator.cells_at(&solved.graph, &p.into()));
            if ends[1].is_empty() {
                return Err(format!("{name}: {q:?} is outside, but seen from {p:?}"));
            }
            for &a in &ends[0] {
                if let Some(b) = ends[1].iter().find(|b| !solved.pvs.sees(a, **b)) {
                    return Err(format!(
                        "{name}: the segment from {p:?} to {q:?} is free, but cell {} {} does not \
                         see cell {} {}",
                        a.0,
                        show(&solved.graph, a),
                        b.0,
                        show(&solved.graph, *b)
                    ));
                }
            }
        }
    }
    Ok(tried)
}

/// A grid point in or on the border of a cell: near a random mean of its corners.
fn point_in(graph: &CellGraph, cell: CellId, random: &mut impl Rng) -> Option<GridPoint> {
    let corners: Vec<_> = graph
        .corners(cell)
        .map(|v| graph.vertices.approx(v))
        .collect();
    let weights: Vec<f64> = corners
        .iter()
        .map(|_| random.random_range(0.0f64..1.0).powi(3) + 1e-9)
        .collect();
    let sum: f64 = weights.iter().sum();
    let p = corners
        .iter()
        .zip(&weights)
        .map(|(c, w)| *c * (w / sum))
        .sum::<glam::DVec2>();
    let p = GridPoint::new(p.x.round() as i64, p.y.round() as i64);
    let exact: Vec<&Vertex> = graph
        .corners(cell)
        .map(|v| graph.vertices.exact(v))
        .collect();
    enfilade::cells::locate::contains(&exact, &p.into()).then_some(p)
}

/// Pools of one and of two threads.
pub fn pools() -> &'static [ThreadPool; 2] {
    static POOLS: OnceLock<[ThreadPool; 2]> = OnceLock::new();
    POOLS.get_or_init(|| {
        [1, 2].map(|n| {
            ThreadPoolBuilder::new()
                .num_threads(n)
                .build()
                .expect("threads start")
        })
    })
}

/// One of the eight rotations and mirrorings of the grid.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    pub flip_x: bool,
    pub flip_y: bool,
    pub swap: bool,
}

impl Turn {
    pub fn all() -> impl Iterator<Item = Turn> {
        (0..8).map(|i| Turn {
            flip_x: i & 1 != 0,
            flip_y: i & 2 != 0,
            swap: i & 4 != 0,
        })
    }

    /// Where a point goes.
    pub fn point(self, [x, y]: [i64; 2]) -> [i64; 2] {
        let x = if self.flip_x { -x } else { x };
        let y = if self.flip_y { -y } else { y };
        if self.swap { [y, x] } else { [x, y] }
    }
}

/// Numbers that name an exact point: x, y, w.
type Point = (i128, i128, i64);

/// The cells' exact corners, turned, from the lower left corner of all of them, each cell's in an
/// order that depends on nothing. The lower left corner must be a grid point.
fn corners(graph: &CellGraph, turn: Option<Turn>) -> Vec<Vec<Point>> {
    let turned = |v| {
        let v = graph.vertices.exact(v);
        turn.map_or(*v, |t| v.mirrored(t.flip_x, t.flip_y, t.swap))
    };
    let cells: Vec<Vec<Vertex>> = graph
        .cell_ids()
        .map(|c| graph.polygon(c).into_iter().map(turned).collect())
        .collect();
    let all = || cells.iter().flatten().filter_map(Vertex::grid);
    let low = [all().map(|p| p.x).min(), all().map(|p| p.y).min()].map(Option::unwrap_or_default);
    let from_low = |v: &Vertex| {
        let v = v.shifted(-low[0], -low[1]);
        (v.x(), v.y(), v.w())
    };
    cells
        .iter()
        .map(|corners| {
            let mut list: Vec<Point> = corners.iter().map(from_low).collect();
            list.sort();
            list
        })
        .collect()
}

/// Whether `after` is `before` turned: the same cells and the same pairs, under other numbers.
pub fn same_turned(before: &Solved, after: &Solved, turn: Turn) -> Result<(), String> {
    let name = before.graph.options.subdivision.as_str();
    if before.graph.cells.len() != after.graph.cells.len() {
        return Err(format!(
            "{name}: {} cells, but {} after {turn:?}",
            before.graph.cells.len(),
            after.graph.cells.len()
        ));
    }
    let number: HashMap<Vec<Point>, CellId> = corners(&after.graph, None)
        .into_iter()
        .zip(after.graph.cell_ids())
        .collect();
    let twins = corners(&before.graph, Some(turn))
        .iter()
        .zip(before.graph.cell_ids())
        .map(|(corners, c)| {
            let twin = number.get(corners);
            let cell = show(&before.graph, c);
            twin.copied()
                .ok_or_else(|| format!("{name}: no cell {cell} after {turn:?}"))
        })
        .collect::<Result<Vec<_>, _>>()?;
    for a in before.graph.cell_ids() {
        for b in before.graph.cell_ids() {
            let (c, d) = (twins[a.0 as usize], twins[b.0 as usize]);
            if before.pvs.sees(a, b) != after.pvs.sees(c, d) {
                return Err(format!(
                    "{name}: {} and {}: {} before, {} after {turn:?}",
                    show(&before.graph, a),
                    show(&before.graph, b),
                    before.pvs.sees(a, b),
                    after.pvs.sees(c, d)
                ));
            }
        }
    }
    Ok(())
}

/// Whether both have the very same cells under the same numbers, and the same PVS.
pub fn identical(p: &Solved, q: &Solved) -> Result<(), String> {
    let name = p.graph.options.subdivision.as_str();
    let list = |s: &Solved| -> Vec<Vec<Vertex>> {
        let cell = |c| {
            s.graph
                .corners(c)
                .map(|v| *s.graph.vertices.exact(v))
                .collect()
        };
        s.graph.cell_ids().map(cell).collect()
    };
    if list(p) != list(q) {
        return Err(format!("{name}: other cells"));
    }
    if p.pvs.visible != q.pvs.visible {
        return Err(format!("{name}: another PVS"));
    }
    Ok(())
}

/// Whether two open convex cells of different subdivisions of one grid have a point in common.
fn overlap(a: &[Vertex], b: &[Vertex]) -> bool {
    let apart = |p: &[Vertex], q: &[Vertex]| {
        (0..p.len()).any(|i| {
            let (from, to) = (&p[i], &p[(i + 1) % p.len()]);
            q.iter().all(|v| orient(from, to, v) != Side::Left)
        })
    };
    !apart(a, b) && !apart(b, a)
}

/// Whatever sees each other in `after` already did in `before`: for every visible pair of cells,
/// some cells of `before` that overlap them see each other. Both must be on one grid. Returns how
/// many pairs were compared.
pub fn nothing_new(before: &Solved, after: &Solved) -> Result<usize, String> {
    let polygons = |s: &Solved| -> Vec<Vec<Vertex>> {
        let cell = |c| {
            s.graph
                .polygon(c)
                .into_iter()
                .map(|v| *s.graph.vertices.exact(v))
                .collect()
        };
        s.graph.cell_ids().map(cell).collect()
    };
    assert_eq!(before.graph.grid, after.graph.grid);
    let (old, new) = (polygons(before), polygons(after));
    let under: Vec<Vec<CellId>> = new
        .iter()
        .map(|p| {
            before
                .graph
                .cell_ids()
                .filter(|c| overlap(p, &old[c.0 as usize]))
                .collect()
        })
        .collect();
    let mut pairs = 0;
    for a in after.graph.cell_ids() {
        for b in after.pvs.seen_from(a) {
            pairs += 1;
            let known = under[a.0 as usize]
                .iter()
                .any(|&c| under[b.0 as usize].iter().any(|&d| before.pvs.sees(c, d)));
            if !known {
                return Err(format!(
                    "{}: {} and {} see each other only now",
                    after.graph.options.subdivision.as_str(),
                    show(&after.graph, a),
                    show(&after.graph, b)
                ));
            }
        }
    }
    Ok(pairs)
}
