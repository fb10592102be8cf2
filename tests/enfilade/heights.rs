//! Visibility with heights: cases worked out by hand, sightlines checked exactly, and the section of
//! a corridor as a plan.

use dashu_int::IBig;
use enfilade::cells::{CellGraph, CellId, Doors, EdgeId, Locator, Options, Subdivision, subdivide};
use enfilade::geom::{GridPoint, Side, Vertex, orient};
use enfilade::level::{Height, Level, Sector, WallKind, doom, snap, toml, wad::Wad};
use enfilade::pvs::heights::{
    Bracket, ChainAnswer, HeightsAnswer, HeightsOptions, bracket, through, witness,
};
use enfilade::pvs::{BitMatrix, Class, Progress, Pvs, sweep::sweep};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::compare::{Solved, Turn, pools, same_turned};
use crate::random::on_random;

const OPTIONS: HeightsOptions = HeightsOptions { splits: 64 };

fn read(text: &str) -> Level {
    toml::read(text, "heights.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn cut(level: &Level, subdivision: Subdivision) -> CellGraph {
    let options = Options {
        subdivision,
        ..Options::default()
    };
    subdivide(level, &options)
}

fn in_space(graph: &CellGraph, splits: u32) -> Bracket {
    let found = bracket(graph, &HeightsOptions { splits }, &Progress::default());
    found.upper.validate(graph).expect("a sound relation");
    found
}

/// A fraction with a denominator above zero.
struct Ratio(IBig, IBig);

/// A number as it stands.
fn exact(x: f64) -> Ratio {
    let bits = x.abs().to_bits();
    let (exponent, fraction) = ((bits >> 52) as i64, bits & ((1 << 52) - 1));
    let mantissa = IBig::from(if exponent == 0 {
        fraction
    } else {
        fraction | 1 << 52
    });
    let mantissa = if x < 0.0 { -mantissa } else { mantissa };
    let exponent = exponent.max(1) - 1075;
    if exponent >= 0 {
        Ratio(mantissa << exponent as usize, IBig::ONE)
    } else {
        Ratio(mantissa, IBig::ONE << (-exponent) as usize)
    }
}

impl Ratio {
    fn less(&self, other: &Self) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }

    /// This and as much of the way to another as a third fraction says.
    fn towards(&self, other: &Self, share: &Self) -> Self {
        // a/b + (c/d - a/b)·s/t = (a·d·t + (c·b - a·d)·s) / (b·d·t)
        let (a, b, c, d) = (&self.0, &self.1, &other.0, &other.1);
        Ratio(
            a * d * &share.1 + (c * b - a * d) * &share.0,
            b * d * &share.1,
        )
    }
}

type Homogeneous = [IBig; 3];

fn homogeneous(p: DVec2) -> Homogeneous {
    let (x, y) = (exact(p.x), exact(p.y));
    [&x.0 * &y.1, &y.0 * &x.1, x.1 * y.1]
}

fn of_vertex(v: &Vertex) -> Homogeneous {
    [v.x().into(), v.y().into(), v.w().into()]
}

/// Positive if `r` lies left of the way from `p` to `q`; in proportion to its distance, if multiplied
/// with the other's third coordinate.
fn area(p: &Homogeneous, q: &Homogeneous, r: &Homogeneous) -> IBig {
    &p[0] * (&q[1] * &r[2] - &r[1] * &q[2]) - &p[1] * (&q[0] * &r[2] - &r[0] * &q[2])
        + &p[2] * (&q[0] * &r[1] - &r[0] * &q[1])
}

fn inside(graph: &CellGraph, cell: CellId, p: &Homogeneous) -> bool {
    graph.edge_range(cell).map(EdgeId).all(|e| {
        let (q, r) = (graph.edge(e).origin, graph.end(e));
        let [q, r] = [q, r].map(|v| of_vertex(graph.vertices.exact(v)));
        area(&q, &r, p) > IBig::ZERO
    })
}

/// Confirms in fractions that a segment runs from inside one cell through the portals of a chain to
/// inside another, strictly between the ends of each, and bottom and top of its opening.
fn confirm(
    graph: &CellGraph,
    [a, b]: [CellId; 2],
    chain: &[EdgeId],
    [from, to]: [DVec3; 2],
) -> Result<(), String> {
    let (p, q) = (homogeneous(from.truncate()), homogeneous(to.truncate()));
    if !inside(graph, a, &p) || !inside(graph, b, &q) {
        return Err("does not start or end inside its cells".into());
    }
    let (z_from, z_to) = (exact(from.z), exact(to.z));
    let mut cell = a;
    for &edge in chain {
        if graph.edge(edge).cell != cell {
            return Err("the chain is broken".into());
        }
        let twin = graph.edge(edge).twin().ok_or("passes a wall")?;
        let [right, left] =
            [graph.edge(edge).origin, graph.end(edge)].map(|v| of_vertex(graph.vertices.exact(v)));
        if area(&p, &q, &left) <= IBig::ZERO || area(&p, &q, &right) >= IBig::ZERO {
            return Err("misses a portal on the plan".into());
        }
        // How far behind the portal it starts, and how far beyond it ends.
        let behind = area(&right, &left, &p) * &q[2];
        let beyond = area(&left, &right, &q) * &p[2];
        if behind <= IBig::ZERO || beyond <= IBig::ZERO {
            return Err("does not reach a portal".into());
        }
        let share = Ratio(behind.clone(), behind + beyond);
        let z = z_from.towards(&z_to, &share);
        let portal = graph
            .portals
            .iter()
            .find(|portal| portal.edges.contains(&edge))
            .ok_or("passes no portal")?;
        if let Some((bottom, top)) = portal.widest
            && !(exact(bottom).less(&z) && z.less(&exact(top)))
        {
            return Err(format!("misses the opening from {bottom} to {top}"));
        }
        cell = graph.edge(twin).cell;
    }
    if cell != b {
        return Err("ends in another cell".into());
    }
    Ok(())
}

/// Random segments in space, walked through the cells and their openings in fractions: whatever one
/// passes through between two stops must be listed. Returns the pairs of cells met.
fn cast(graph: &CellGraph, found: &Bracket, n: usize, random: &mut Pcg64) -> Result<usize, String> {
    let mut openings = vec![None; graph.edges.len()];
    for portal in &graph.portals {
        for edge in portal.edges {
            openings[edge.0 as usize] = portal.widest;
        }
    }
    let mut met = 0;
    for _ in 0..n {
        let cells = [(); 2].map(|()| CellId(random.random_range(0..graph.cells.len() as u32)));
        // About the middle of both.
        let [p, q] = cells.map(|cell| {
            let corners: Vec<DVec2> = graph
                .corners(cell)
                .map(|v| graph.vertices.approx(v))
                .collect();
            let weights: Vec<f64> = corners
                .iter()
                .map(|_| random.random_range(0.05..1.0))
                .collect();
            let sum = corners
                .iter()
                .zip(&weights)
                .map(|(c, w)| *c * *w)
                .sum::<DVec2>();
            let at = (sum / weights.iter().sum::<f64>()).round();
            GridPoint::new(at.x as i64, at.y as i64)
        });
        let [exact_p, exact_q] = [p, q].map(|p| of_vertex(&p.into()));
        if p == q || !inside(graph, cells[0], &exact_p) {
            continue;
        }
        // The cells on the way, and where it leaves them: how far behind and beyond.
        let mut path = vec![cells[0]];
        let mut crossings: Vec<(EdgeId, Ratio)> = Vec::new();
        loop {
            let cell = path[path.len() - 1];
            let exit = graph.edge_range(cell).map(EdgeId).find(|&e| {
                let ends = [graph.edge(e).origin, graph.end(e)];
                let sides = ends.map(|v| orient(&p.into(), &q.into(), graph.vertices.exact(v)));
                sides == [Side::Right, Side::Left]
            });
            let Some(exit) = exit else { break };
            let [right, left] = [graph.edge(exit).origin, graph.end(exit)]
                .map(|v| of_vertex(graph.vertices.exact(v)));
            let behind = area(&right, &left, &exact_p);
            let beyond = area(&left, &right, &exact_q);
            let Some(twin) = graph.edge(exit).twin().filter(|_| beyond > IBig::ZERO) else {
                break;
            };
            crossings.push((exit, Ratio(behind.clone(), behind + beyond)));
            path.push(graph.edge(twin).cell);
        }
        if crossings.is_empty() {
            continue;
        }
        for _ in 0..6 {
            // Through two of the openings, most often close to a bottom or a top.
            let [i, j] = [(); 2].map(|()| random.random_range(0..crossings.len()));
            let mut place = |i: usize| {
                let (edge, Ratio(n, d)) = &crossings[i];
                let (bottom, top) = openings[edge.0 as usize].unwrap_or((0.0, 1.0));
                let share = match random.random_range(0..3) {
                    0 => 0.001,
                    1 => 0.999,
                    _ => random.random::<f64>(),
                };
                let thousandths: IBig = n * IBig::from(1_000_000) / d;
                let at = i64::try_from(thousandths).expect("at most a million") as f64 / 1e6;
                (at, bottom + (top - bottom) * share)
            };
            let ((s, z), (t, y)) = (place(i), place(j));
            let rise = if s == t { y - z } else { (y - z) / (t - s) };
            let (start, end) = (exact(z - s * rise), exact(z + (1.0 - s) * rise));
            let mut first = 0;
            for (k, (edge, at)) in crossings.iter().enumerate() {
                let z = start.towards(&end, at);
                let passes = openings[edge.0 as usize]
                    .is_none_or(|(bottom, top)| exact(bottom).less(&z) && z.less(&exact(top)));
                if !passes {
                    first = k + 1;
                    continue;
                }
                for &a in &path[first..=k] {
                    let b = path[k + 1];
                    if !found.upper.sees(a, b) {
                        let [a, b] = [a, b].map(|cell| crate::compare::show(graph, cell));
                        return Err(format!("a segment above {p:?} and {q:?} joins {a} and {b}"));
                    }
                    met += 1;
                }
            }
        }
    }
    Ok(met)
}

/// All that must hold of a level; returns the pairs looked at.
fn keeps_all_promises(level: &Level, subdivision: Subdivision) -> Result<usize, String> {
    let graph = cut(level, subdivision);
    let plan = sweep(&graph, &Progress::default());
    let fewer = [1, 2, 8].map(|splits| in_space(&graph, splits));
    let found = in_space(&graph, OPTIONS.splits);
    let budgets = || fewer.iter().zip(fewer[1..].iter().chain([&found]));
    cast(&graph, &found, 40, &mut Pcg64::seed_from_u64(3))?;
    let name = subdivision.as_str();
    let mut looked = 0;
    for a in graph.cell_ids() {
        for b in graph.cell_ids() {
            let sees = |pvs: &Pvs| pvs.sees(a, b);
            let certain = |of: &Bracket| of.lower.get(a.0 as usize, b.0 as usize);
            let wrong = |what: &str| {
                let [p, q] = [a, b].map(|cell| crate::compare::show(&graph, cell));
                Err(format!("{name}: {p} and {q} {what}"))
            };
            if sees(&found.upper) && !sees(&plan) {
                return wrong("do not see each other on the plan");
            }
            if certain(&found) && !sees(&found.upper) {
                return wrong("certainly see each other, and do not");
            }
            let undone = budgets().any(|(few, more)| {
                sees(&more.upper) && !sees(&few.upper) || certain(few) && !certain(more)
            });
            if undone {
                return wrong("are decided only with a smaller budget");
            }
            if !sees(&plan) || a > b {
                continue;
            }
            looked += 1;
            match witness(&graph, a, b, &OPTIONS) {
                HeightsAnswer::Visible(passage) => {
                    if !certain(&found) {
                        return wrong("see each other only as a single pair");
                    }
                    if a != b {
                        let Some(segment) = passage.segment else {
                            return wrong("see each other without a segment");
                        };
                        if let Err(error) = confirm(&graph, [a, b], &passage.chain, segment) {
                            return wrong(&format!("by {segment:?}: {error}"));
                        }
                        let again = through(&graph, &passage.chain, &OPTIONS);
                        if !matches!(again, ChainAnswer::Passes(_)) {
                            return wrong(&format!("through a chain that is {again:?}"));
                        }
                    }
                }
                HeightsAnswer::Hidden if sees(&found.upper) => {
                    return wrong("are hidden only as a single pair");
                }
                HeightsAnswer::Undecided if certain(&found) || !sees(&found.upper) => {
                    return wrong("are undecided only as a single pair");
                }
                HeightsAnswer::Hidden | HeightsAnswer::Undecided => {}
            }
        }
    }
    let undecided = found.upper.pairs() - found.lower.total();
    if undecided != found.upper.undecided || (undecided == 0) != (found.upper.class == Class::Exact)
    {
        return Err(format!("{name}: {undecided} undecided pairs"));
    }
    Ok(looked)
}

/// Reads a level, and then gives its sectors their heights by name: the reader would refuse openings
/// that these leave no room.
fn with_heights(text: &str, heights: &[(String, [f64; 2])]) -> Level {
    let mut level = read(&format!("[defaults]\nfloor = -100\nceiling = 100\n{text}"));
    for (name, [floor, ceiling]) in heights {
        let named = |sector: &&mut Sector| sector.name.as_ref() == Some(name);
        let sector = level.sectors.iter_mut().find(named).expect(name);
        sector.floor = Height::fixed(*floor);
        sector.ceiling = Height::fixed(*ceiling);
    }
    level
}

/// Rooms one unit deep and two wide in a row, each from a floor to a ceiling, with openings as wide as
/// the rooms between them: bottom and top.
fn corridor(rooms: &[[f64; 2]], openings: &[[f64; 2]]) -> Level {
    let mut text = String::new();
    for i in 0..rooms.len() {
        text += &format!("[[room]]\nname = \"{i}\"\nrect = [{i}, 0, {}, 2]\n", i + 1);
    }
    for (i, [bottom, top]) in openings.iter().enumerate() {
        text += &format!(
            "[[door]]\npoints = [[{0}, 0], [{0}, 2]]\nbottom = {bottom:?}\ntop = {top:?}\n",
            i + 1
        );
    }
    let names = (0..rooms.len()).map(|i| i.to_string());
    let heights: Vec<(String, [f64; 2])> = names.zip(rooms.iter().copied()).collect();
    with_heights(&text, &heights)
}

/// The cells around the middle of the corridor's room.
fn room(graph: &CellGraph, i: usize) -> Vec<CellId> {
    let locator = Locator::new(graph);
    let point = graph.grid.nearest(DVec2::new(i as f64 + 0.5, 1.0));
    locator.cells_at(graph, &point.expect("inside the level").into())
}

/// Which rooms of a corridor see each other, for all subdivisions; all pairs must be decided.
fn rooms_that_see(level: &Level, n: usize) -> Vec<Vec<usize>> {
    let mut answers = Subdivision::ALL.map(|subdivision| {
        let graph = cut(level, subdivision);
        let found = in_space(&graph, OPTIONS.splits);
        assert_eq!(found.upper.undecided, 0);
        assert_eq!(found.lower, found.upper.visible);
        let rooms: Vec<Vec<CellId>> = (0..n).map(|i| room(&graph, i)).collect();
        let sees = |a: usize, b: usize| {
            let mut pairs = rooms[a]
                .iter()
                .flat_map(|p| rooms[b].iter().map(move |q| (p, q)));
            pairs.any(|(p, q)| found.upper.sees(*p, *q))
        };
        (0..n)
            .map(|a| (0..n).filter(|&b| sees(a, b)).collect())
            .collect::<Vec<Vec<usize>>>()
    });
    assert_eq!(answers[0], answers[1]);
    assert_eq!(answers[0], answers[2]);
    std::mem::take(&mut answers[0])
}

const TALL: [f64; 2] = [0.0, 4.0];

fn corridor_sees(rooms: &[[f64; 2]], openings: &[[f64; 2]]) -> Vec<Vec<usize>> {
    let level = corridor(rooms, openings);
    for subdivision in Subdivision::ALL {
        keeps_all_promises(&level, subdivision).unwrap();
    }
    rooms_that_see(&level, rooms.len())
}

#[test]
fn windows_in_a_row_are_seen_through_where_a_line_fits() {
    // High, low, high: up and down again takes a bend; two of them take none.
    let seen = corridor_sees(&[TALL; 4], &[[2.0, 3.0], [0.5, 1.0], [2.0, 3.0]]);
    assert_eq!(seen[0], [0, 1, 2]);
    assert_eq!(seen[1], [0, 1, 2, 3]);
    // A rising row.
    let seen = corridor_sees(&[TALL; 4], &[[0.5, 1.0], [1.5, 2.0], [2.5, 3.0]]);
    assert_eq!(seen[0], [0, 1, 2, 3]);
    // A low wall hides nothing in high rooms.
    let seen = corridor_sees(&[TALL; 4], &[[1.0, 4.0], [0.0, 4.0], [1.0, 4.0]]);
    assert_eq!(seen[0], [0, 1, 2, 3]);
}

#[test]
fn sill_and_lintel_at_one_height_let_nothing_through() {
    // A line below 1, above 1, below 1 would have to bend.
    let seen = corridor_sees(&[TALL; 4], &[[0.0, 1.0], [1.0, 2.0], [0.0, 1.0]]);
    assert_eq!(seen[0], [0, 1, 2]);
    // Tops at 1 and 2, the bottom between them at 1.5: the line through them touches all three.
    let seen = corridor_sees(&[TALL; 4], &[[0.0, 1.0], [1.5, 3.0], [0.0, 2.0]]);
    assert_eq!(seen[0], [0, 1, 2]);
    // A hair lower, and there is a line.
    let hair = 1.5 - 1e-9;
    let seen = corridor_sees(&[TALL; 4], &[[0.0, 1.0], [hair, 3.0], [0.0, 2.0]]);
    assert_eq!(seen[0], [0, 1, 2, 3]);
}

#[test]
fn floors_and_ceilings_open_as_far_as_both_rooms_do() {
    // A step hides the floor behind it, but not the room.
    let seen = corridor_sees(&[TALL, [1.0, 4.0], TALL], &[[0.0, 4.0]; 2]);
    assert_eq!(seen[0], [0, 1, 2]);
    // Down a well and up again: the bottom of the well is seen from beside it only.
    let low = [-4.0, -2.0];
    let seen = corridor_sees(&[[-4.0, 2.0], low, low, [-4.0, 2.0]], &[[-9.0, 9.0]; 3]);
    assert_eq!(seen[0], [0, 1, 2, 3]);
    // A room too low for the next one's floor: no opening.
    let seen = corridor_sees(&[[0.0, 1.0], [1.0, 2.0], [1.5, 3.0]], &[[-9.0, 9.0]; 2]);
    assert_eq!(seen, [vec![0], vec![1, 2], vec![1, 2]]);
    // A room without height sees only itself.
    let seen = corridor_sees(&[TALL, [2.0, 2.0], TALL], &[[0.0, 4.0]; 2]);
    assert_eq!(seen, [[0], [1], [2]]);
}

#[test]
fn what_moves_counts_with_its_whole_range() {
    let mut level = corridor(&[TALL; 3], &[[0.0, 4.0]; 2]);
    // Up to the ceiling at rest.
    level.sectors[1].floor = Height {
        rest: 4.0,
        low: 1.0,
        high: 4.0,
    };
    let seen = rooms_that_see(&level, 3);
    assert_eq!(seen[0], [0, 1, 2]);
    level.sectors[1].floor = Height::fixed(4.0);
    assert_eq!(rooms_that_see(&level, 3)[0], [0]);
}

#[test]
fn a_closed_door_is_a_wall_whatever_its_heights() {
    let level = corridor(&[TALL; 2], &[[0.0, 4.0]]);
    for (doors, pairs) in [(Doors::Open, 4), (Doors::Closed, 2)] {
        let options = Options {
            doors,
            ..Options::default()
        };
        let graph = subdivide(&level, &options);
        assert_eq!(in_space(&graph, 1).upper.pairs(), pairs);
    }
}

#[test]
fn levels_without_heights_are_open_without_end() {
    let level = crate::plan::level(&crate::plan::rectangle(
        [0, 0],
        [8, 4],
        crate::plan::Ink::Solid,
    ));
    let graph = cut(&level, Subdivision::Cdt);
    let found = in_space(&graph, 1);
    assert_eq!(found.upper.pairs(), 4);
    assert_eq!(found.upper.class, Class::Exact);
    keeps_all_promises(&level, Subdivision::Cdt).unwrap();
}

#[test]
fn a_chain_says_which_openings_contradict_each_other() {
    let level = corridor(
        &[TALL; 5],
        &[[0.0, 4.0], [2.0, 3.0], [0.5, 1.0], [2.0, 3.0]],
    );
    let graph = cut(&level, Subdivision::Bsp);
    // Through all rooms, from edge to edge.
    let mut chain = Vec::new();
    for i in 0..4 {
        let (cell, next) = (room(&graph, i)[0], room(&graph, i + 1)[0]);
        let edges = graph.edge_range(cell).map(EdgeId);
        let mut out = edges.filter(|&e| {
            graph
                .edge(e)
                .twin()
                .is_some_and(|t| graph.edge(t).cell == next)
        });
        chain.push(out.next().expect("rooms in a row"));
    }
    let through = |chain: &[EdgeId]| through(&graph, chain, &OPTIONS);
    assert_eq!(through(&chain), ChainAnswer::Blocked(chain[1..].to_vec()));
    assert!(matches!(through(&chain[..3]), ChainAnswer::Passes(Some(_))));
    assert!(matches!(through(&chain[..1]), ChainAnswer::Passes(Some(_))));
    assert_eq!(
        through(&[chain[0], chain[2]]),
        ChainAnswer::BlockedOnPlan,
        "the chain is broken"
    );
}

#[test]
fn when_stopped_what_the_plan_shows_stays_undecided() {
    let level = corridor(&[TALL; 4], &[[2.0, 3.0], [0.5, 1.0], [2.0, 3.0]]);
    let graph = cut(&level, Subdivision::Bsp);
    let progress = Progress::default();
    progress.stop();
    let found = bracket(&graph, &OPTIONS, &progress);
    let plan = sweep(&graph, &Progress::default());
    assert_eq!(found.upper.visible, plan.visible);
    assert_eq!(found.upper.class, Class::Conservative);
    assert_eq!(found.upper.undecided, plan.pairs() - found.lower.total());
    assert!(found.upper.undecided > 0);
}

/// Random corridors: rooms and openings from few heights, so that many coincide.
fn corridors() -> impl Strategy<Value = (Vec<[f64; 2]>, Vec<[f64; 2]>)> {
    let span = |most: i32| {
        (0..most, 1..=most)
            .prop_map(|(low, size)| [f64::from(low) / 2.0, f64::from(low + size) / 2.0])
    };
    prop::collection::vec((span(4), span(5)), 3..8).prop_map(move |list| list.into_iter().unzip())
}

/// A corridor's section as a plan: x along it, y up. Rooms see each other in space just when they do
/// there, as all its openings are as wide as the rooms.
fn section(rooms: &[[f64; 2]], openings: &[[f64; 2]]) -> Level {
    let mut text = String::new();
    for (i, [floor, ceiling]) in rooms.iter().enumerate() {
        text += &format!(
            "[[room]]\nname = \"{i}\"\nrect = [{i}, {floor:?}, {}, {ceiling:?}]\n",
            i + 1
        );
    }
    for (i, [bottom, top]) in openings.iter().enumerate().take(rooms.len() - 1) {
        let low = bottom.max(rooms[i][0]).max(rooms[i + 1][0]);
        let high = top.min(rooms[i][1]).min(rooms[i + 1][1]);
        if low < high {
            text += &format!(
                "[[archway]]\npoints = [[{0}, {low:?}], [{0}, {high:?}]]\n",
                i + 1
            );
        }
    }
    read(&text)
}

#[test]
fn a_corridor_and_its_section_agree() {
    on_random(
        "sections of corridors",
        150,
        corridors(),
        |(rooms, mut openings)| {
            openings.truncate(rooms.len() - 1);
            let n = rooms.len();
            let level = corridor(&rooms, &openings);
            let seen = rooms_that_see(&level, n);
            let section = section(&rooms, &openings);
            let graph = cut(&section, Subdivision::Cdt);
            let plan = sweep(&graph, &Progress::default());
            // Cells of a section lie in one room each.
            let of_room = |i: usize| -> Vec<CellId> {
                let within = |&cell: &CellId| {
                    let corners = graph.corners(cell).map(|v| graph.vertices.exact(v));
                    let xs: Vec<f64> = corners.map(|v| v.to_level(&graph.grid).x).collect();
                    (xs.iter().sum::<f64>() / xs.len() as f64).floor() == i as f64
                };
                graph.cell_ids().filter(within).collect()
            };
            let rooms: Vec<Vec<CellId>> = (0..n).map(of_room).collect();
            let sees = |a: usize, b: usize| {
                let mut pairs = rooms[a]
                    .iter()
                    .flat_map(|&p| rooms[b].iter().map(move |&q| (p, q)));
                pairs.any(|(p, q)| plan.sees(p, q))
            };
            let expected: Vec<Vec<usize>> = (0..n)
                .map(|a| (0..n).filter(|&b| sees(a, b)).collect())
                .collect();
            if seen != expected {
                return Err(format!("in space {seen:?}, in the section {expected:?}"));
            }
            Ok(n * n)
        },
    );
}

/// A block of rooms of different heights with windows between them, steps and pillars.
#[derive(Clone, Debug)]
struct Block {
    text: String,
    heights: Vec<(String, [f64; 2])>,
}

fn blocks() -> impl Strategy<Value = Block> {
    let height = (0..5i64, 1..6i64);
    let window = (0..6i64, 1..4i64, 0..3u8, 1..8i64);
    let room = (height, window.clone(), window, 0..8u8, (0..4i64, 2..5i64));
    let rooms = prop::collection::vec(room, 9);
    (2..4usize, 2..4usize, rooms, any::<bool>()).prop_map(|(columns, rows, list, slanted)| {
        let (mut text, mut more) = (String::new(), String::new());
        let mut heights = Vec::new();
        let x_at = |c: usize, r: usize| 4 * c as i64 + if slanted { r as i64 } else { 0 };
        for (r, c) in (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c))) {
            let ((floor, height), east, north, extra, (step, size)) = list[r * columns + c];
            let (y0, y1) = (4 * r as i64, 4 * r as i64 + 4);
            let (x0, x1) = (x_at(c, r), x_at(c, r + 1));
            let name = format!("{c}-{r}");
            text += &format!(
                "[[room]]\nname = \"{name}\"\noutline = [[{x0}, {y0}], [{}, {y0}], [{}, {y1}], \
                 [{x1}, {y1}]]\n",
                x0 + 4,
                x1 + 4
            );
            let span = |low: i64, high: i64| [low as f64, high as f64];
            heights.push((name.clone(), span(floor, floor + height)));
            if extra & 1 != 0 {
                let x = x0.max(x1);
                more += &format!(
                    "[[zone]]\nname = \"step {name}\"\nrect = [{x}, {y0}, {}, {}]\n",
                    x + size - 1,
                    y0 + size - 1
                );
                heights.push((format!("step {name}"), span(floor + step, floor + height)));
            }
            if extra & 2 != 0 {
                more += &format!(
                    "[[pillar]]\ncenter = [{}, {}]\nradius = 0.6\nsides = 4\n",
                    (x0 + x1) as f64 / 2.0 + 2.5,
                    y0 + 2
                );
            }
            let neighbours = [
                (c + 1 < columns, format!("{}-{r}", c + 1), east),
                (r + 1 < rows, format!("{c}-{}", r + 1), north),
            ];
            for (there, other, (bottom, size, kind, width)) in neighbours {
                // Two neighbours share at least three units of wall.
                if there && kind > 0 {
                    more += &format!(
                        "[[window]]\nbetween = [\"{name}\", \"{other}\"]\nwidth = {}\nbottom = \
                         {bottom}\ntop = {}\n",
                        width.min(6) as f64 / 2.0,
                        bottom + size
                    );
                }
            }
        }
        text += &more;
        Block { text, heights }
    })
}

#[test]
fn blocks_of_rooms_keep_all_promises() {
    on_random("blocks of rooms", 60, blocks(), |block| {
        let level = with_heights(&block.text, &block.heights);
        let mut n = 0;
        for subdivision in Subdivision::ALL {
            n += keeps_all_promises(&level, subdivision)?;
        }
        Ok(n)
    });
}

#[test]
fn threads_change_nothing_and_neither_do_turning_and_mirroring() {
    on_random("blocks turned", 20, blocks(), |block| {
        let level = with_heights(&block.text, &block.heights);
        let mut n = 0;
        for subdivision in Subdivision::ALL {
            let [one, two] = [0, 1].map(|pool| {
                pools()[pool].install(|| in_space(&cut(&level, subdivision), OPTIONS.splits))
            });
            if one != two {
                return Err(format!("{}: threads matter", subdivision.as_str()));
            }
            if one.upper.undecided > 0 {
                continue;
            }
            let before = Solved {
                graph: cut(&level, subdivision),
                pvs: one.upper,
            };
            for turn in Turn::all() {
                let graph = cut(&turned(&level, turn), subdivision);
                let pvs = in_space(&graph, OPTIONS.splits).upper;
                if pvs.undecided == 0 {
                    n += 1;
                    same_turned(&before, &Solved { graph, pvs }, turn)?;
                }
            }
        }
        Ok(n)
    });
}

/// The level with its plan turned.
fn turned(level: &Level, turn: Turn) -> Level {
    let mut level = level.clone();
    let mirrors = (turn.flip_x != turn.flip_y) != turn.swap;
    for wall in &mut level.walls {
        for p in [&mut wall.from, &mut wall.to] {
            let [x, y] = turn.point([p.x, p.y]);
            *p = GridPoint::new(x, y);
        }
        if mirrors {
            std::mem::swap(&mut wall.left, &mut wall.right);
        }
    }
    level
}

fn sample(name: &str) -> Level {
    let path = format!("{}/levels/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    read(&std::fs::read_to_string(path).expect("the level is there"))
}

#[test]
fn where_all_heights_are_equal_space_is_as_the_plan() {
    for name in ["house", "office", "theatre"] {
        let mut level = sample(name);
        for sector in &mut level.sectors {
            (sector.floor, sector.ceiling) = (Height::fixed(0.0), Height::fixed(3.0));
        }
        for wall in &mut level.walls {
            if let WallKind::Opening(opening) = &mut wall.kind {
                (opening.bottom, opening.top) = (None, None);
            }
        }
        for subdivision in Subdivision::ALL {
            let graph = cut(&level, subdivision);
            let found = in_space(&graph, 1);
            assert_eq!(
                found.upper.visible,
                sweep(&graph, &Progress::default()).visible
            );
            assert_eq!(found.lower, found.upper.visible);
        }
    }
}

#[test]
fn sample_levels_keep_all_promises() {
    for (name, hides) in [("house", true), ("theatre", true), ("tiny", false)] {
        let level = sample(name);
        let graph = cut(&level, Subdivision::Bsp);
        let plan = sweep(&graph, &Progress::default());
        let found = in_space(&graph, OPTIONS.splits);
        assert_eq!(found.upper.undecided, 0, "{name}");
        assert_eq!(found.upper.pairs() < plan.pairs(), hides, "{name}");
        keeps_all_promises(&level, Subdivision::Bsp).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

#[test]
fn doom_maps_are_decided_and_their_sightlines_confirmed() {
    let path = "/usr/share/games/doom/freedoom1.wad";
    let Ok(bytes) = std::fs::read(path) else {
        let missing = format!("{path} is not there; install Freedoom");
        assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
        eprintln!("skipped: {missing}");
        return;
    };
    let wad = Wad::parse(bytes).expect("Freedoom is a WAD");
    for map in ["E1M1", "E1M9", "E4M3"] {
        let draft = doom::read_map(&wad, map, "freedoom1.wad").expect("the map is sound");
        let level = snap::snap(draft).expect("the map is sound");
        for subdivision in [Subdivision::Bsp, Subdivision::Cdt] {
            let name = format!("{map} {}", subdivision.as_str());
            let graph = cut(&level, subdivision);
            let plan = sweep(&graph, &Progress::default());
            let [few, found] = [1, 16].map(|splits| in_space(&graph, splits));
            let pairs = found.upper.pairs();
            assert!(pairs < plan.pairs(), "{name}: heights hide nothing");
            assert!(
                found.upper.undecided * 1000 <= pairs,
                "{name}: hardly decided"
            );
            assert!(found.upper.undecided <= few.upper.undecided, "{name}");
            let within = |p: &BitMatrix, q: &BitMatrix| {
                (0..p.n()).all(|i| p.row(i).iter().zip(q.row(i)).all(|(p, q)| p & !q == 0))
            };
            assert!(within(&found.upper.visible, &plan.visible), "{name}");
            assert!(within(&found.upper.visible, &few.upper.visible), "{name}");
            assert!(within(&few.lower, &found.lower), "{name}");
            let random = &mut Pcg64::seed_from_u64(5);
            let met = cast(&graph, &found, 4000, random).unwrap_or_else(|e| panic!("{name}: {e}"));
            let (mut confirmed, mut narrow) = (0, 0);
            for _ in 0..60 {
                let a = random.random_range(0..graph.cells.len());
                let seen: Vec<usize> = found.lower.ones(a).filter(|&b| b != a).collect();
                if seen.is_empty() {
                    continue;
                }
                let b = seen[random.random_range(0..seen.len())];
                let ends = [CellId(a as u32), CellId(b as u32)];
                let options = HeightsOptions { splits: 16 };
                let HeightsAnswer::Visible(passage) = witness(&graph, ends[0], ends[1], &options)
                else {
                    panic!("{name}: cells {a} and {b} do not see each other as a single pair");
                };
                let Some(segment) = passage.segment else {
                    narrow += 1;
                    continue;
                };
                confirm(&graph, ends, &passage.chain, segment)
                    .unwrap_or_else(|error| panic!("{name}: cells {a} and {b}: {error}"));
                confirmed += 1;
            }
            println!("{name}: {met} pairs met, {confirmed} confirmed, {narrow} too narrow");
            assert!(
                met > 1000 && confirmed > 40,
                "{name}: {met} met, {confirmed} confirmed"
            );
        }
    }
}
