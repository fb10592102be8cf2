//! What one look costs: microseconds per query, within 60°, 90° and all around, against the usual
//! ways.
//!
//! `cargo bench --bench eye` needs the Debian package `freedoom`. Eyes are spread evenly over the
//! ground, directions at random, both seeded. The time of an eye is the least of three looks, so
//! that what else the machine does counts little; the figures are the median and the 99th percentile
//! over all eyes. `areas` adds the polygons of all pieces and the outline. Naive ways:
//!
//! - `row`: every cell in the PVS of the eye's cell is tested against the cone by its corners, as an
//!   engine culls by a view frustum. It keeps what is hidden from this eye.
//! - `sort`: an angular sweep in f64 over all walls of the level, which knows no cells. All around.

use std::cmp::Ordering;
use std::f64::consts::PI;
use std::path::Path;
use std::time::Instant;

use enfilade::cells::{CellGraph, CellId, EdgeId, Locator, Options, Subdivision, subdivide};
use enfilade::geom::{FINE, Vertex};
use enfilade::level::{Level, doom, snap, wad::Wad};
use enfilade::pvs::eye::{Cone, Lookout, Scratch};
use enfilade::pvs::{Progress, Pvs, sweep};
use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const MAPS: [(&str, &str); 2] = [("freedoom1.wad", "E1M5"), ("freedoom2.wad", "MAP12")];
const EYES: usize = 2000;
/// Of which the slow naive way gets so many.
const FEW: usize = 100;

fn main() {
    // cargo passes --bench; a filter names maps.
    let wanted: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    println!(
        "{:<6} {:<4} {:>4} | {:>6} {:>6} {:>6} | {:>8} {:>8} | {:>8} {:>8} | {:>8} {:>6} {:>6} | {:>8} {:>6}",
        "map",
        "cut",
        "view",
        "in pvs",
        "seen",
        "pieces",
        "look µs",
        "99 %",
        "areas µs",
        "99 %",
        "row µs",
        "kept",
        "×look",
        "sort µs",
        "×look"
    );
    for (file, map) in MAPS {
        if !wanted.is_empty() && !wanted.iter().any(|w| w == map) {
            continue;
        }
        let Some(level) = load(file, map) else {
            continue;
        };
        for subdivision in Subdivision::ALL {
            measure(map, &level, subdivision);
        }
    }
}

fn load(file: &str, map: &str) -> Option<Level> {
    let path = Path::new("/usr/share/games/doom").join(file);
    let Ok(bytes) = std::fs::read(&path) else {
        eprintln!(
            "left out {map}: {} is not there (apt-get install freedoom)",
            path.display()
        );
        return None;
    };
    let wad = Wad::parse(bytes).expect("the WAD is sound");
    Some(snap::snap(doom::read_map(&wad, map, file).expect("the map reads")).expect("it fits"))
}

fn measure(map: &str, level: &Level, subdivision: Subdivision) {
    let options = Options {
        subdivision,
        ..Options::default()
    };
    let graph = subdivide(level, &options);
    let pvs = sweep::sweep(&graph, &Progress::default());
    let eyes = eyes(&graph);
    let lookout = Lookout::new(&graph);
    let locator = Locator::new(&graph);
    let walls = walls(&graph);
    let mut scratch = Scratch::default();
    let mut corners = Vec::new();
    for fov in [60.0, 90.0, 360.0] {
        let (mut seen, mut pieces) = (Vec::new(), Vec::new());
        let look = times(&eyes, |eye| {
            let cone = Cone::new(eye.direction, fov).expect("it is a cone");
            let vista = lookout.look(&eye.at, &cone, &mut scratch);
            vista.expect("inside").cells().len()
        });
        let areas = times(&eyes, |eye| {
            let cone = Cone::new(eye.direction, fov).expect("it is a cone");
            let vista = lookout.look(&eye.at, &cone, &mut scratch);
            let vista = vista.expect("inside");
            let mut n = 0;
            for piece in vista.pieces() {
                vista.polygon(piece, &mut corners);
                n += corners.len();
            }
            vista.outline(&mut corners);
            n + corners.len()
        });
        let mut kept = Vec::new();
        let row = times(&eyes, |eye| {
            let cell = locator.cells_at(&graph, &eye.at)[0];
            in_cone(&graph, &pvs, cell, eye, fov).count()
        });
        for eye in &eyes {
            let cone = Cone::new(eye.direction, fov).expect("it is a cone");
            let vista = lookout.look(&eye.at, &cone, &mut scratch).expect("inside");
            seen.push(vista.cells().len());
            pieces.push(vista.pieces().len());
            kept.push(in_cone(&graph, &pvs, vista.own_cells()[0], eye, fov).count());
        }
        let in_pvs: Vec<usize> = eyes
            .iter()
            .map(|eye| {
                pvs.visible
                    .count(locator.cells_at(&graph, &eye.at)[0].0 as usize)
            })
            .collect();
        let mut line = format!(
            "{map:<6} {:<4} {fov:>4} | {:>6} {:>6} {:>6} | {:>8.2} {:>8.2} | {:>8.2} {:>8.2} | {:>8.2} {:>6} {:>6.1}",
            subdivision.as_str(),
            middle(in_pvs),
            middle(seen),
            middle(pieces),
            percentile(&look, 50),
            percentile(&look, 99),
            percentile(&areas, 50),
            percentile(&areas, 99),
            percentile(&row, 50),
            middle(kept),
            percentile(&row, 50) / percentile(&look, 50),
        );
        if fov == 360.0 {
            let sort = times(&eyes[..FEW], |eye| visible_area(&walls, eye.near) as usize);
            line += &format!(
                " | {:>8.1} {:>6.1}",
                percentile(&sort, 50),
                percentile(&sort, 50) / percentile(&look, 50)
            );
            let all = |eye: &Eye| {
                let vista = lookout.look(&eye.at, &Cone::ALL, &mut scratch);
                vista.expect("inside").area()
            };
            let exact: Vec<f64> = eyes[..FEW].iter().map(all).collect();
            let close = |(eye, exact): (&Eye, f64)| {
                (visible_area(&walls, eye.near) / exact - 1.0).abs() < 1e-6
            };
            let agree = eyes[..FEW].iter().zip(exact).filter(|&p| close(p)).count();
            line += &format!("  ({agree} of {FEW} areas agree)");
        }
        println!("{line}");
    }
}

struct Eye {
    at: Vertex,
    near: DVec2,
    direction: f64,
}

/// Eyes evenly over the ground.
fn eyes(graph: &CellGraph) -> Vec<Eye> {
    let random = &mut Pcg64::seed_from_u64(3);
    let mut sum = 0.0;
    let sums: Vec<f64> = graph
        .cell_ids()
        .map(|c| {
            sum += graph.area(c);
            sum
        })
        .collect();
    let locator = Locator::new(graph);
    let mut list = Vec::new();
    while list.len() < EYES {
        let at = random.random_range(0.0..sum);
        let cell = CellId(sums.partition_point(|&s| s <= at) as u32);
        let corners: Vec<DVec2> = graph
            .corners(cell)
            .map(|v| graph.vertices.approx(v))
            .collect();
        // A point of the extent of the cell, tried until it is in the cell.
        let low = corners.iter().fold(DVec2::MAX, |low, &p| low.min(p));
        let high = corners.iter().fold(DVec2::MIN, |high, &p| high.max(p));
        for _ in 0..1000 {
            let part = DVec2::new(random.random(), random.random());
            let [x, y] = ((low + (high - low) * part) * FINE as f64)
                .round()
                .to_array();
            let at = Vertex::homogeneous(x as i128, y as i128, FINE).expect("w is not zero");
            if locator.cells_at(graph, &at) == [cell] {
                let direction = random.random_range(-180.0..180.0);
                let near = at.approx();
                list.push(Eye {
                    at,
                    near,
                    direction,
                });
                break;
            }
        }
    }
    list
}

/// For each eye the least microseconds of three runs.
fn times(eyes: &[Eye], mut run: impl FnMut(&Eye) -> usize) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; eyes.len()];
    let mut sum = 0;
    for _ in 0..3 {
        for (eye, least) in eyes.iter().zip(&mut least) {
            let start = Instant::now();
            sum += run(eye);
            *least = least.min(start.elapsed().as_secs_f64() * 1e6);
        }
    }
    assert!(sum > 0, "something is seen");
    least.sort_by(f64::total_cmp);
    least
}

fn percentile(sorted: &[f64], percent: usize) -> f64 {
    sorted[(sorted.len() * percent / 100).min(sorted.len() - 1)]
}

fn middle(mut list: Vec<usize>) -> usize {
    list.sort();
    list[list.len() / 2]
}

/// The cells of a PVS row that are not wholly outside of one of the cone's edges.
fn in_cone<'a>(
    graph: &'a CellGraph,
    pvs: &'a Pvs,
    cell: CellId,
    eye: &'a Eye,
    fov: f64,
) -> impl Iterator<Item = CellId> + 'a {
    let edge = |by: f64| DVec2::from_angle((eye.direction + by).to_radians());
    let (low, high) = (edge(-fov / 2.0), edge(fov / 2.0));
    let all = fov == 360.0;
    pvs.seen_from(cell).filter(move |&c| {
        let to = |v| graph.vertices.approx(v) - eye.near;
        all || c == cell
            || (graph.corners(c).any(|v| low.perp_dot(to(v)) > 0.0)
                && graph.corners(c).any(|v| to(v).perp_dot(high) > 0.0))
    })
}

/// The walls of a level that face inwards, each with the inside on its left.
fn walls(graph: &CellGraph) -> Vec<[DVec2; 2]> {
    (0..graph.edges.len() as u32)
        .map(EdgeId)
        .filter(|&e| graph.edge(e).twin().is_none())
        .map(|e| [graph.edge(e).origin, graph.end(e)].map(|v| graph.vertices.approx(v)))
        .collect()
}

/// The area seen all around, by a sweep over all walls that face the eye, sorted by angle.
fn visible_area(walls: &[[DVec2; 2]], eye: DVec2) -> f64 {
    // Angle, whether a wall begins there, and which.
    let mut events: Vec<(f64, bool, usize)> = Vec::new();
    let facing: Vec<[DVec2; 2]> = walls
        .iter()
        .map(|w| w.map(|p| p - eye))
        .filter(|[a, b]| a.perp_dot(*b) > 0.0)
        .collect();
    let mut active: Vec<usize> = Vec::new();
    for (i, [a, b]) in facing.iter().enumerate() {
        let (from, to) = (a.to_angle(), b.to_angle());
        events.push((from, true, i));
        events.push((to, false, i));
        if from > to {
            active.push(i); // across the start
        }
    }
    // What ends goes before what begins in the same direction.
    events.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
    let distance = |i: usize, angle: f64| {
        let ([a, b], d) = (facing[i], DVec2::from_angle(angle));
        a.perp_dot(b - a) / d.perp_dot(b - a)
    };
    let by_distance = |i: usize, j: usize, angle: f64| -> Ordering {
        distance(i, angle).total_cmp(&distance(j, angle))
    };
    active.sort_by(|&i, &j| by_distance(i, j, -PI));
    let mut area = 0.0;
    let mut before = -PI;
    for k in 0..=events.len() {
        let angle = events.get(k).map_or(PI, |e| e.0);
        if angle > before {
            if let Some(&first) = active.first() {
                let (r, s) = (distance(first, before), distance(first, angle));
                area += r * s * (angle - before).sin() / 2.0;
            }
            before = angle;
        }
        match events.get(k) {
            Some(&(_, true, i)) => {
                // Between this event and the next, so that walls with one end in common are told
                // apart.
                let next = events[k..].iter().map(|e| e.0).find(|&a| a > angle);
                let here = (angle + next.unwrap_or(PI)) / 2.0;
                let at = active.partition_point(|&j| by_distance(j, i, here).is_lt());
                active.insert(at, i);
            }
            Some(&(_, false, i)) => active.retain(|&j| j != i),
            None => {}
        }
    }
    area
}
