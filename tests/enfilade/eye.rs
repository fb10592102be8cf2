//! What an eye sees: against answers worked out by hand, against rays cast among the walls alone, and
//! against the PVS.
//!
//! Levels of `levels/hard` state in their comments what eyes see in them:
//!
//! | line | meaning |
//! |---|---|
//! | `# eye sees: 1,2 @ 90 / 60 -> 3,4` | an eye at the one point, looking 90° with a view of 60°, sees every cell at the other |
//! | `# eye hidden: 1,2 @ 90 / 60 -> 3,4` | it sees none of them |
//! | `# eye area: 1,2 @ 90 / 60 = 12.5` | it sees that much ground |
//! | `# eye outside: 1,2` | an eye there is outside of the level |

use std::fs;
use std::path::Path;

use enfilade::cells::{CellGraph, CellId, Doors, Locator, Subdivision};
use enfilade::geom::pencil::Aim;
use enfilade::geom::{FINE, GridPoint, Vertex};
use enfilade::level::{Level, doom, read::read, snap, wad::Wad};
use enfilade::pvs::Progress;
use enfilade::pvs::eye::{Cone, Lookout, Scratch, Vista, area};
use enfilade::pvs::sweep::sweep;
use glam::DVec2;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::agree::tomls;
use crate::caster::{Caster, Point, between, direction, point, turn, weighed, within};
use crate::compare::{Solved, cells, show};
use crate::plan::level;
use crate::random::{any_inks, on_random};

/// Checks a statement in one subdivision.
fn check_statement(
    level: &Level,
    lookout: &Lookout,
    scratch: &mut Scratch,
    key: &str,
    value: &str,
) -> Result<(), String> {
    let graph = lookout.graph();
    let number = |text: &str| {
        let number = text.trim().parse::<f64>();
        number.map_err(|_| format!("`{text}` is no number"))
    };
    let place = |text: &str| {
        let (x, y) = text
            .split_once(',')
            .ok_or(format!("`{text}` is no point"))?;
        let eye = level.grid.fine(DVec2::new(number(x)?, number(y)?));
        eye.filter(|eye| eye.w() == 1)
            .ok_or(format!("`{text}` is not on the grid"))
    };
    if key == "eye outside" {
        return match lookout.look(&place(value)?, &Cone::ALL, scratch) {
            Ok(vista) => Err(format!("touches {:?}", vista.own_cells())),
            Err(_) => Ok(()),
        };
    }
    let parts = || {
        let (eye, rest) = value.split_once(" @ ")?;
        let (direction, rest) = rest.split_once(" / ")?;
        let (fov, rest) = rest.split_once(' ')?;
        Some((eye, direction, fov, rest))
    };
    let (eye, direction, fov, rest) = parts().ok_or("has no eye, direction and view")?;
    let cone = Cone::new(number(direction)?, number(fov)?).map_err(|error| error.to_string())?;
    let vista = lookout
        .look(&place(eye)?, &cone, scratch)
        .map_err(|error| error.to_string())?;
    if key == "eye area" {
        let wanted = number(rest.trim_start_matches('='))?;
        let found = vista.area() * level.grid.step.length().powi(2);
        return if (found - wanted).abs() > 1e-12 * wanted {
            Err(format!("sees an area of {found}"))
        } else {
            Ok(())
        };
    }
    let target = place(rest.trim_start_matches("->"))?;
    let cells = Locator::new(graph).cells_at(graph, &target);
    if cells.is_empty() {
        return Err("the target is outside".into());
    }
    let wanted = key == "eye sees";
    match cells.iter().find(|c| vista.cells().contains(c) != wanted) {
        Some(&c) => Err(format!("sees = {} for cell {}", !wanted, show(graph, c))),
        None => Ok(()),
    }
}

#[test]
fn eyes_in_hard_levels_see_what_was_worked_out_by_hand() {
    let (mut wrong, mut n, mut levels) = (Vec::new(), 0, 0);
    for path in tomls("levels/hard") {
        let text = fs::read_to_string(&path).expect("a level is text");
        let statements: Vec<(&str, &str)> = text
            .lines()
            .map_while(|line| line.strip_prefix('#'))
            .filter_map(|line| line.trim().split_once(": "))
            .filter(|(key, _)| key.starts_with("eye "))
            .collect();
        if statements.is_empty() {
            continue;
        }
        levels += 1;
        let known = ["eye sees", "eye hidden", "eye area", "eye outside"];
        let level = read(text.as_bytes().to_vec(), "level.toml", None)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for subdivision in Subdivision::ALL {
            let graph = cells(&level, subdivision, Doors::Open).expect("cells are sound");
            let lookout = Lookout::new(&graph);
            let scratch = &mut Scratch::default();
            for &(key, value) in &statements {
                assert!(known.contains(&key), "{}: `{key}`", path.display());
                n += 1;
                if let Err(error) = check_statement(&level, &lookout, scratch, key, value) {
                    let (path, how) = (path.display(), subdivision.as_str());
                    wrong.push(format!("{path}, {how}: {key}: {value}: {error}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    assert!(
        levels >= 7 && n >= 150,
        "only {n} statements in {levels} levels"
    );
    println!("{levels} levels, {n} statements");
}

/// How much was compared.
#[derive(Default, Debug)]
struct Compared {
    looks: usize,
    areas: usize,
    pieces: usize,
    segments: usize,
    /// Largest relative error of an area.
    error: f64,
}

impl Compared {
    fn add(&mut self, other: Compared) {
        self.looks += other.looks;
        self.areas += other.areas;
        self.pieces += other.pieces;
        self.segments += other.segments;
        self.error = self.error.max(other.error);
    }
}

/// What is compared for one eye.
struct Effort {
    /// Whether the visible area is worked out from the walls, which takes long in large levels.
    areas: bool,
    /// At most so many pieces of a look.
    pieces: usize,
    /// Random segments of an eye.
    segments: usize,
}

/// Everything that must hold for an eye, in all directions and in some cones.
fn check(
    level: &Level,
    solved: &Solved,
    lookout: &Lookout,
    eye: &Vertex,
    effort: &Effort,
    scratch: &mut Scratch,
    random: &mut impl Rng,
) -> Result<Compared, String> {
    let graph = &solved.graph;
    let own = Locator::new(graph).cells_at(graph, eye);
    if own.is_empty() {
        return match lookout.look(eye, &Cone::ALL, scratch) {
            Err(_) => Ok(Compared::default()),
            Ok(vista) => Err(format!("outside, but in {:?}", vista.own_cells())),
        };
    }
    let caster = Caster::new(level, graph, Doors::Open, eye, own.clone());
    let cones = some_cones(graph, &caster, random);
    let edges: Vec<Point> = cones
        .iter()
        .filter_map(Cone::edges)
        .flat_map(|edges| edges.map(direction))
        .collect();
    let sectors = if effort.areas {
        caster.sectors(&edges)
    } else {
        Vec::new()
    };
    let targets: Vec<GridPoint> = (0..effort.segments)
        .map(|_| {
            let cell = CellId(random.random_range(0..graph.cells.len() as u32));
            let p = place_in(graph, cell, random).approx();
            GridPoint::new(p.x.round() as i64, p.y.round() as i64)
        })
        .filter(|&p| caster.is_free(&p.into()) && Vertex::from(p) != *eye)
        .collect();
    let mut compared = Compared::default();
    for cone in &cones {
        let vista = lookout
            .look(eye, cone, scratch)
            .map_err(|_| "no cell touches the eye".to_string())?;
        let at = |error: String| format!("{eye:?}, {cone:?}: {error}");
        let edges = cone.edges().map(|edges| edges.map(direction));
        compared.looks += 1;
        lists_agree(solved, &vista, &own).map_err(at)?;
        compared.pieces +=
            pieces_are_seen(&caster, eye, &vista, &edges, effort, graph).map_err(at)?;
        compared.segments +=
            nothing_is_missed(&caster, &vista, &edges, &targets, graph).map_err(at)?;
        let seen = areas_agree(&vista).map_err(at)?;
        if effort.areas {
            let inside = |low: &Point, high: &Point| {
                edges
                    .as_ref()
                    .is_none_or(|edges| within(&between(low, high), edges))
            };
            let expected: f64 = sectors
                .iter()
                .filter(|s| inside(&s.low, &s.high))
                .map(|s| s.area())
                .sum();
            // The corners are rounded by a few last bits of the largest coordinate.
            let rounding = graph.vertices.reach() * 2f64.powi(-50) * outline_length(&vista);
            let error = (seen - expected).abs();
            if error > 1e-12 * expected + rounding {
                return Err(at(format!("{seen} square steps, not {expected}")));
            }
            compared.error = compared.error.max(error / expected.max(1.0));
            compared.areas += 1;
        }
    }
    Ok(compared)
}

/// All around; narrow and wide ones at random; and one between two vertices.
fn some_cones(graph: &CellGraph, caster: &Caster, random: &mut impl Rng) -> Vec<Cone> {
    let mut cones = vec![Cone::ALL];
    for fov in [60.0, 8.0, 180.0, 90.0, 250.0, 359.5] {
        let to = random.random_range(-180.0..180.0);
        let to = if fov == 90.0 { 90.0 } else { to };
        cones.push(Cone::new(to, fov).expect("it is one"));
    }
    let mut ends = || {
        let v = random.random_range(0..graph.vertices.len());
        let [x, y, _] = caster.to(&point(graph.vertices.iter().nth(v)?));
        let narrow = |n| i64::try_from(n).ok();
        // A fine eye's directions are up to 2^46 long; only those that fit are taken.
        Some([narrow(x)?, narrow(y)?])
    };
    for _ in 0..4 {
        if let (Some(low), Some(high)) = (ends(), ends()) {
            cones.extend(Cone::between(low, high));
        }
    }
    cones
}

/// Own cells come first; every cell once, each with a piece (own ones perhaps without); all are in
/// what the own cells see together.
fn lists_agree(solved: &Solved, vista: &Vista, own: &[CellId]) -> Result<(), String> {
    let mut touched = vista.own_cells().to_vec();
    touched.sort();
    if touched != own {
        return Err(format!("touches {own:?}, not {touched:?}"));
    }
    let mut cells = vista.cells().to_vec();
    cells.sort();
    let n = cells.len();
    cells.dedup();
    if n != cells.len() {
        return Err("a cell is listed twice".into());
    }
    let mut of_pieces: Vec<CellId> = vista.pieces().iter().map(|p| p.cell).collect();
    of_pieces.extend(own);
    of_pieces.sort();
    of_pieces.dedup();
    if of_pieces != cells {
        return Err("cells and pieces differ".into());
    }
    let hidden = |c: &&CellId| !own.iter().any(|&o| solved.pvs.sees(o, **c));
    match cells.iter().find(hidden) {
        Some(c) => Err(format!(
            "cell {} is not in the PVS",
            show(&solved.graph, *c)
        )),
        None => Ok(()),
    }
}

/// A ray in the middle of every piece's wedge reaches the cell before any wall, within the cone.
fn pieces_are_seen(
    caster: &Caster,
    eye: &Vertex,
    vista: &Vista,
    cone: &Option<[Point; 2]>,
    effort: &Effort,
    graph: &CellGraph,
) -> Result<usize, String> {
    let towards = |aim: Aim| match (aim, cone) {
        (Aim::Vertex(v), _) => caster.to(&point(graph.vertices.exact(v))),
        (Aim::Free(n), Some(edges)) => edges[n].clone(),
        (Aim::Free(_), None) => panic!("no cone has no edges"),
    };
    let step = vista.pieces().len().div_ceil(effort.pieces).max(1);
    let mut n = 0;
    for piece in vista.pieces().iter().step_by(step) {
        let Some(wedge) = vista.wedge(piece) else {
            assert_eq!(vista.own_cells(), [piece.cell]);
            continue;
        };
        let [low, high] = wedge.map(towards);
        let own = vista.own_cells().contains(&piece.cell);
        if own && turn(&low, &high) <= 0 {
            continue;
        }
        if turn(&low, &high) <= 0 {
            return Err(format!("an empty wedge in cell {}", piece.cell.0));
        }
        let middle = between(&low, &high);
        if cone.as_ref().is_some_and(|edges| !within(&middle, edges)) {
            return Err(format!(
                "a piece of cell {} is outside of the cone",
                piece.cell.0
            ));
        }
        // A ray may pass an end of a wall or a corner of the cell, and does not count then; these
        // weights are no fractions that turn up in plans.
        let rays = [[1, 1], [31, 17], [13, 29], [97, 11]].map(|w| weighed(&low, &high, w));
        let is_seen = |ray: &Point| caster.reaches(ray, piece.cell);
        if !own && !rays.iter().any(is_seen) {
            return Err(format!(
                "cell {} {} is hidden from {:?}",
                piece.cell.0,
                show(graph, piece.cell),
                eye.approx(),
            ));
        }
        n += 1;
    }
    Ok(n)
}

/// The cells at the end of a free segment within the cone are listed.
fn nothing_is_missed(
    caster: &Caster,
    vista: &Vista,
    cone: &Option<[Point; 2]>,
    targets: &[GridPoint],
    graph: &CellGraph,
) -> Result<usize, String> {
    let locator = Locator::new(graph);
    let mut n = 0;
    for &target in targets {
        let to = caster.to(&point(&target.into()));
        if cone.as_ref().is_some_and(|edges| !within(&to, edges)) {
            continue;
        }
        n += 1;
        for cell in locator.cells_at(graph, &target.into()) {
            if !vista.cells().contains(&cell) {
                let cell = show(graph, cell);
                return Err(format!(
                    "the way to {target:?} is free, but not cell {cell}"
                ));
            }
        }
    }
    Ok(n)
}

/// Outline, pieces and the whole have one area; returned in square grid steps.
fn areas_agree(vista: &Vista) -> Result<f64, String> {
    let mut corners = Vec::new();
    let mut pieces = 0.0;
    for piece in vista.pieces() {
        vista.polygon(piece, &mut corners);
        if corners.len() < 3 {
            // So thin that its corners round to the same numbers: it adds nothing.
            continue;
        }
        pieces += area(&corners);
    }
    vista.outline(&mut corners);
    let all = vista.area();
    // Coordinates of up to 2^25 steps are rounded to some 2^-28 of one.
    let rounding = (outline_length(vista) + 1.0) * 1e-8;
    for (what, other) in [("pieces", pieces), ("outline", area(&corners))] {
        if (other - all).abs() > 1e-9 * all + rounding {
            return Err(format!("{what}: {other} square steps, not {all}"));
        }
    }
    Ok(all)
}

fn outline_length(vista: &Vista) -> f64 {
    let mut corners = Vec::new();
    vista.outline(&mut corners);
    let n = corners.len();
    (0..n)
        .map(|i| corners[i].distance(corners[(i + 1) % n]))
        .sum()
}

/// A fine point in or on the border of a cell.
fn place_in(graph: &CellGraph, cell: CellId, random: &mut impl Rng) -> Vertex {
    let corners = graph.corners(cell).map(|v| graph.vertices.approx(v));
    let weighted = corners.map(|p| (p, random.random_range(0.0f64..1.0).powi(3)));
    let (sum, weight) = weighted.fold((DVec2::ZERO, 0.0), |(sum, weight), (p, w)| {
        (sum + p * w, weight + w)
    });
    fine(sum / weight)
}

fn fine(p: DVec2) -> Vertex {
    let [x, y] = (p * FINE as f64).round().to_array();
    Vertex::homogeneous(x as i128, y as i128, FINE).expect("w is not zero")
}

/// An eye of one kind or another: inside a cell, on a vertex, in the middle of an edge.
fn some_eye(graph: &CellGraph, random: &mut impl Rng) -> Vertex {
    let edge = random.random_range(0..graph.edges.len() as u32);
    let edge = enfilade::cells::EdgeId(edge);
    let [a, b] = [graph.edge(edge).origin, graph.end(edge)].map(|v| graph.vertices.exact(v));
    match random.random_range(0..10) {
        0 => *a,
        1 => match (a.grid(), b.grid()) {
            (Some(a), Some(b)) => {
                let (x, y) = (a.x + b.x, a.y + b.y);
                Vertex::homogeneous(x.into(), y.into(), 2).expect("2 is not zero")
            }
            _ => *a,
        },
        2 => fine(a.approx() + DVec2::splat(1.0 / 1024.0)),
        _ => place_in(graph, graph.edge(edge).cell, random),
    }
}

/// Some eyes in each subdivision of a level.
fn check_level(level: &Level, eyes: usize, effort: &Effort) -> Result<Compared, String> {
    let mut compared = Compared::default();
    let random = &mut Pcg64::seed_from_u64(11);
    for subdivision in Subdivision::ALL {
        let graph = cells(level, subdivision, Doors::Open)?;
        if graph.cells.is_empty() {
            continue;
        }
        let pvs = sweep(&graph, &Progress::default());
        let solved = Solved { graph, pvs };
        let lookout = Lookout::new(&solved.graph);
        let scratch = &mut Scratch::default();
        for _ in 0..eyes {
            let eye = some_eye(&solved.graph, random);
            let found = check(level, &solved, &lookout, &eye, effort, scratch, random);
            compared.add(found.map_err(|error| format!("{}: {error}", subdivision.as_str()))?);
        }
    }
    Ok(compared)
}

#[test]
fn sample_and_hard_levels_agree_with_rays_cast_among_their_walls() {
    let mut all = Compared::default();
    for path in tomls("levels").into_iter().chain(tomls("levels/hard")) {
        let text = fs::read(&path).expect("a level is readable");
        let Ok(level) = read(text, "level.toml", None) else {
            continue; // a hard level that is to be refused
        };
        // Casting costs the square of the walls.
        let (eyes, areas) = match level.walls.len() {
            0..150 => (12, true),
            150..1000 => (2, true),
            _ => (2, false),
        };
        let effort = Effort {
            areas,
            pieces: 20,
            segments: 60,
        };
        let compared = check_level(&level, eyes, &effort)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        all.add(compared);
    }
    assert!(
        all.areas > 2000 && all.pieces > 10_000 && all.segments > 10_000,
        "{all:?}"
    );
    println!("{all:?}");
}

/// Small levels full of coincidences, with eyes in line with many vertices and walls.
#[test]
fn random_levels_agree_with_rays_cast_among_their_walls() {
    let effort = Effort {
        areas: true,
        pieces: 10,
        segments: 10,
    };
    on_random("eyes in levels with openings", 250, any_inks(), |strokes| {
        let compared = check_level(&level(&strokes), 4, &effort)?;
        Ok(compared.areas + compared.pieces + compared.segments)
    });
}

#[test]
fn maps_of_freedoom_agree_with_rays_and_with_the_pvs() {
    let mut all = Compared::default();
    for (file, map, eyes, areas) in [
        ("freedoom1.wad", "E1M1", 2, true),
        ("freedoom1.wad", "E1M1", 20, false),
        ("freedoom1.wad", "E1M5", 5, false),
        ("freedoom2.wad", "MAP07", 10, false),
    ] {
        let path = Path::new("/usr/share/games/doom").join(file);
        let Ok(bytes) = fs::read(&path) else {
            let missing = format!("{} is not there; install Freedoom", path.display());
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            continue;
        };
        let wad = Wad::parse(bytes).expect("Freedoom is a WAD");
        let draft = doom::read_map(&wad, map, file).expect("it is there");
        let level = snap::snap(draft).expect("it fits");
        let effort = Effort {
            areas,
            pieces: 6,
            segments: 100,
        };
        let compared =
            check_level(&level, eyes, &effort).unwrap_or_else(|error| panic!("{map}: {error}"));
        all.add(compared);
    }
    println!("{all:?}");
}
