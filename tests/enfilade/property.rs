//! Random levels, full of coincidences: everything that must hold of any level holds of them.
//!
//! The seed is fixed, so that a run repeats; `PROPTEST_RNG_SEED` takes another one, and
//! `ENFILADE_CASES=20` makes it twenty times as many cases. A failure prints the smallest level
//! found, ready to be pasted into `regression`.

use std::cell::Cell;

use enfilade::cells::Doors;
use enfilade::level::{Interior, Level, toml};
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseError, TestRunner};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::compare::{Solved, Turn, identical, nothing_new, pools, same_turned, sample, solve_all};
use crate::plan::{Ink, Stroke, level, moved, rectangle, ring};
use crate::reference;

/// Runs `check` on random values; prints how many, and from which seed.
pub fn on_random<S: Strategy>(
    name: &'static str,
    cases: u32,
    strategy: S,
    check: impl Fn(S::Value) -> Result<usize, String>,
) {
    let factor = std::env::var("ENFILADE_CASES")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(1);
    let mut config = ProptestConfig {
        cases: cases * factor,
        failure_persistence: None,
        max_shrink_iters: 20_000,
        ..ProptestConfig::default()
    };
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(20_240_229);
    }
    let (cases, seed) = (config.cases, config.rng_seed);
    let counted = Cell::new(0);
    let result = TestRunner::new(config).run(&strategy, |value| {
        counted.set(counted.get() + check(value).map_err(TestCaseError::fail)?);
        Ok(())
    });
    if let Err(error) = result {
        panic!("{name}, seed {seed}: {error}");
    }
    println!(
        "{name}: {cases} levels, {} comparisons, seed {seed}",
        counted.get()
    );
}

type Points = [i64; 2];

fn point(size: i64) -> impl Strategy<Value = Points> {
    [0..=size, 0..=size]
}

/// Any walls on a small grid: crossings, T-junctions, overlaps and duplicates all over.
fn tangle(size: i64, most: usize) -> impl Strategy<Value = Vec<Stroke>> {
    prop::collection::vec((point(size), point(size)), 1..=most).prop_map(|list| {
        list.into_iter()
            .map(|(a, b)| Stroke(a, b, Ink::Solid))
            .collect()
    })
}

/// Walls that lie on few lines, so that they overlap, repeat, and look along each other.
fn on_few_lines(size: i64) -> impl Strategy<Value = Vec<Stroke>> {
    let on_line = (0..6usize, 0..=size, 0..=size).prop_map(move |(line, a, b)| {
        let at = move |t: i64| match line {
            0 => [t, size / 2],
            1 => [size / 2, t],
            2 => [t, t],
            3 => [t, size - t],
            4 => [t, size / 3],
            _ => [t / 2, t],
        };
        Stroke(at(a), at(b), Ink::Solid)
    });
    prop::collection::vec(on_line, 1..9)
}

/// Squares at any angle, some touching, some within each other.
fn boxes() -> impl Strategy<Value = Vec<Stroke>> {
    let square = (4..16i64, 4..16i64, 0..5i64, -4..5i64);
    prop::collection::vec(square, 1..4).prop_map(|list| {
        list.into_iter()
            .flat_map(|(x, y, a, b)| {
                ring(
                    &[
                        [x, y],
                        [x + a, y + b],
                        [x + a - b, y + b + a],
                        [x - b, y + a],
                    ],
                    Ink::Solid,
                )
            })
            .map(|Stroke(p, q, ink)| {
                let within = |p: Points| p.map(|n| n.clamp(0, 20));
                Stroke(within(p), within(q), ink)
            })
            .collect()
    })
}

/// Walls up and down a corridor whose ends all lie within a step of one line.
fn grazing() -> impl Strategy<Value = Vec<Stroke>> {
    let tip = (1..20i64, -1..=1i64, any::<bool>());
    (-3..=3i64, 3..=8i64, prop::collection::vec(tip, 2..7)).prop_map(|(rise, height, tips)| {
        tips.into_iter()
            .map(|(x, off, up)| {
                let y = (height + (x * rise).div_euclid(4) + off).clamp(0, 20);
                Stroke([x, if up { 20 } else { 0 }], [x, y], Ink::Solid)
            })
            .collect()
    })
}

/// Long thin triangles, up to the limit of the grid.
fn slivers() -> impl Strategy<Value = Vec<Stroke>> {
    let size = FAR;
    let near = (0..4i64, 0..4i64).prop_map(|(x, y)| [x, y]);
    let far = (0..4i64, 0..4i64).prop_map(move |(x, y)| [size - x, y]);
    let high = (0..4i64, 0..4i64).prop_map(move |(x, y)| [size / 2 + x, size - y]);
    let tip = prop_oneof![near, far, high].boxed();
    prop::collection::vec(([tip.clone(), tip.clone(), tip], any::<bool>()), 1..4).prop_map(|list| {
        list.into_iter()
            .flat_map(|(corners, whole)| {
                let mut strokes = ring(&corners, Ink::Solid);
                if !whole {
                    strokes.pop();
                }
                strokes
            })
            .collect()
    })
}

/// The largest coordinate of a level that starts in 0: 2^26 - 2 steps.
const FAR: i64 = (1 << 26) - 2;

/// Few walls anywhere on the whole grid: crossings need all bits.
fn vast() -> impl Strategy<Value = Vec<Stroke>> {
    tangle(FAR, 6)
}

/// In a box, so that all of it is inside.
fn boxed(
    size: i64,
    strokes: impl Strategy<Value = Vec<Stroke>> + 'static,
) -> BoxedStrategy<Vec<Stroke>> {
    strokes
        .prop_map(move |mut strokes| {
            strokes.extend(rectangle([0, 0], [size, size], Ink::Solid));
            strokes
        })
        .boxed()
}

fn any_walls() -> BoxedStrategy<Vec<Stroke>> {
    prop_oneof![
        3 => boxed(4, tangle(4, 8)),
        3 => boxed(8, tangle(8, 10)),
        1 => boxed(24, tangle(24, 14)),
        2 => boxed(6, on_few_lines(6)),
        2 => boxed(20, boxes()),
        2 => boxed(20, grazing()),
        2 => boxed(FAR, slivers()),
        2 => boxed(FAR, vast()),
    ]
    .boxed()
}

/// Walls with openings and see-through lines on and off them.
pub fn any_inks() -> BoxedStrategy<Vec<Stroke>> {
    let inks = [
        Ink::Solid,
        Ink::Wall,
        Ink::Wall,
        Ink::Archway,
        Ink::Door,
        Ink::Line,
        Ink::ShutLine,
    ];
    let ink = || prop::sample::select(inks.to_vec());
    let free = (point(6), point(6), ink()).prop_map(|(a, b, ink)| Stroke(a, b, ink));
    let in_line = (0..4i64, 0..=6i64, 0..=6i64, ink()).prop_map(|(line, a, b, ink)| {
        let at = |t| if line < 2 { [t, 2 + line] } else { [line, t] };
        Stroke(at(a), at(b), ink)
    });
    let strokes = prop::collection::vec(prop_oneof![free, in_line], 1..12);
    boxed(6, strokes)
}

fn random() -> Pcg64 {
    Pcg64::seed_from_u64(1)
}

fn solve_within(threads: usize, level: &Level) -> Result<Vec<Solved>, String> {
    pools()[threads - 1].install(|| solve_all(level, Doors::Open))
}

#[test]
fn walls_anywhere_keep_all_promises() {
    on_random("walls anywhere", 1500, any_walls(), |strokes| {
        let level = level(&strokes);
        let solved = solve_all(&level, Doors::Open)?;
        sample(&level, Doors::Open, &solved, 60, &mut random())
    });
}

#[test]
fn openings_anywhere_keep_all_promises() {
    on_random("openings anywhere", 1000, any_inks(), |strokes| {
        let level = level(&strokes);
        let mut tried = 0;
        for doors in [Doors::Open, Doors::Closed] {
            let solved = solve_all(&level, doors)?;
            tried += sample(&level, doors, &solved, 30, &mut random())?;
        }
        Ok(tried)
    });
}

/// Checks tiny graphs against one line out of every class; returns the pairs compared.
fn matches_reference(level: &Level, doors: Doors, largest: usize) -> Result<usize, String> {
    let mut pairs = 0;
    for solved in solve_all(level, doors)? {
        if reference::size(level, &solved.graph) > largest {
            continue;
        }
        let expected = reference::visible(level, &solved.graph, doors);
        for a in solved.graph.cell_ids() {
            for b in solved.graph.cell_ids() {
                pairs += 1;
                let truly = expected.get(a.0 as usize, b.0 as usize);
                if solved.pvs.sees(a, b) != truly {
                    return Err(format!(
                        "{}: {} and {}: {}, by all classes of lines {truly}",
                        solved.graph.options.subdivision.as_str(),
                        crate::compare::show(&solved.graph, a),
                        crate::compare::show(&solved.graph, b),
                        solved.pvs.sees(a, b),
                    ));
                }
            }
        }
    }
    Ok(pairs)
}

#[test]
fn tiny_levels_match_every_class_of_lines() {
    on_random("classes of lines, walls", 300, any_walls(), |strokes| {
        matches_reference(&level(&strokes), Doors::Open, 34)
    });
    on_random("classes of lines, openings", 150, any_inks(), |strokes| {
        let level = level(&strokes);
        Ok(matches_reference(&level, Doors::Open, 34)?
            + matches_reference(&level, Doors::Closed, 34)?)
    });
}

#[test]
fn order_direction_threads_and_place_change_nothing() {
    let strategy = (any_walls(), any::<u64>());
    on_random("order, threads, place", 300, strategy, |(strokes, seed)| {
        let before = solve_within(1, &level(&strokes))?;
        let mut shuffled = strokes.clone();
        rand::seq::SliceRandom::shuffle(&mut shuffled[..], &mut Pcg64::seed_from_u64(seed));
        for (i, Stroke(a, b, _)) in shuffled.iter_mut().enumerate() {
            if seed >> (i % 64) & 1 != 0 {
                std::mem::swap(a, b);
            }
        }
        let far = moved(&strokes, [1e6, -1e6]);
        for other in [
            solve_within(2, &level(&strokes))?,
            solve_within(1, &level(&shuffled))?,
            solve_within(2, &far)?,
        ] {
            for (p, q) in before.iter().zip(&other) {
                identical(p, q)?;
            }
        }
        // The place itself is not lost.
        let (near, far) = (before[0].graph.grid, far.grid);
        if [
            far.origin[0] - near.origin[0],
            far.origin[1] - near.origin[1],
        ] != [1_000_000, -1_000_000]
        {
            return Err(format!("moved from {near:?} to {far:?}"));
        }
        Ok(9)
    });
}

/// The strokes turned, without order and direction, moved to the origin.
fn shape(strokes: &[Stroke], turn: Turn) -> Vec<[Points; 2]> {
    let ends = |s: &Stroke| [turn.point(s.0), turn.point(s.1)];
    let mut list: Vec<[Points; 2]> = strokes.iter().map(ends).collect();
    let least = |axis: usize| list.iter().flatten().map(|p| p[axis]).min().unwrap_or(0);
    let low = [least(0), least(1)];
    for ends in &mut list {
        *ends = ends.map(|p| [p[0] - low[0], p[1] - low[1]]);
        ends.sort();
    }
    list.retain(|ends| ends[0] != ends[1]);
    list.sort();
    list
}

/// A level that is its own mirror image may get its cells mirrored: then they must match after
/// another turn that makes the same level of it.
#[test]
fn turned_and_mirrored_levels_have_turned_and_mirrored_cells() {
    on_random("rotations and mirrorings", 200, any_walls(), |strokes| {
        let before = solve_all(&level(&strokes), Doors::Open)?;
        for turn in Turn::all() {
            let turned: Vec<Stroke> = strokes
                .iter()
                .map(|&Stroke(a, b, ink)| Stroke(turn.point(a), turn.point(b), ink))
                .collect();
            let wanted = shape(&strokes, turn);
            let same: Vec<Turn> = Turn::all()
                .filter(|&t| shape(&strokes, t) == wanted)
                .collect();
            for (p, q) in before.iter().zip(&solve_all(&level(&turned), Doors::Open)?) {
                let first = same_turned(p, q, turn);
                if first.is_err() && same.iter().all(|&t| same_turned(p, q, t).is_err()) {
                    return first.map(|()| 0);
                }
            }
        }
        Ok(24)
    });
}

#[test]
fn a_wall_more_never_shows_more() {
    let wall = prop_oneof![
        (Just(4), point(4), point(4), boxed(4, tangle(4, 8))),
        (Just(8), point(8), point(8), boxed(8, tangle(8, 8))),
        (Just(20), point(20), point(20), boxed(20, grazing())),
        (Just(FAR), point(FAR), point(FAR), boxed(FAR, vast())),
    ];
    on_random("a wall more", 500, wall, |(_, a, b, mut strokes)| {
        let before = solve_all(&level(&strokes), Doors::Open)?;
        strokes.push(Stroke(a, b, Ink::Solid));
        let after = solve_all(&level(&strokes), Doors::Open)?;
        before
            .iter()
            .zip(&after)
            .map(|(p, q)| nothing_new(p, q))
            .sum()
    });
}

#[test]
fn closed_doors_only_hide() {
    on_random("closed doors", 500, any_inks(), |strokes| {
        let level = level(&strokes);
        let (open, closed) = (
            solve_all(&level, Doors::Open)?,
            solve_all(&level, Doors::Closed)?,
        );
        open.iter()
            .zip(&closed)
            .map(|(p, q)| nothing_new(p, q))
            .sum()
    });
}

/// A TOML level: a row of rooms of different heights on the plan, doors between neighbours, and
/// what stands in them.
fn rooms() -> impl Strategy<Value = String> {
    let room = (
        1..6i64,
        0..4i64,
        5..9i64,
        0..8u8,
        (1..4i64, 1..4i64),
        0..3u8,
    );
    (prop::collection::vec(room, 2..6), any::<bool>()).prop_map(|(list, slanted)| {
        let mut text = String::new();
        let mut x = 0;
        for (i, &(width, low, high, extra, (u, v), door)) in list.iter().enumerate() {
            let right = x + 2 * width + 1;
            let lift = if slanted { 1 } else { 0 };
            text += &format!(
                "[[room]]\nname = \"{i}\"\noutline = [[{x}, {low}], [{right}, {low}], \
                 [{right}, {high}], [{x}, {}]]\n",
                high + lift
            );
            let (cx, cy) = (x as f64 + width as f64, (low + high) as f64 / 2.0);
            if extra & 1 != 0 {
                text += &format!("[[pillar]]\ncenter = [{cx}, {cy}]\nradius = 0.3\nsides = 5\n");
            }
            if extra & 2 != 0 {
                let (x1, y1) = (x as f64 + 0.25 * u as f64, low as f64 + 0.3 * v as f64);
                text += &format!("[[zone]]\nrect = [{x}, {low}, {x1}, {y1}]\nfloor = 0.2\n");
            }
            if extra & 4 != 0 {
                text += &format!("[[wall]]\npoints = [[{x}, {cy}], [{}, {cy}]]\n", cx - 0.4);
            }
            if i > 0 {
                let (kind, state) = [
                    ("door", ""),
                    ("archway", ""),
                    ("door", "state = \"open\"\n"),
                ][door as usize];
                text += &format!(
                    "[[{kind}]]\nbetween = [\"{}\", \"{i}\"]\nwidth = 0.7\n{state}",
                    i - 1
                );
            }
            x = right;
        }
        text
    })
}

#[test]
fn rooms_with_doors_keep_all_promises() {
    on_random("rooms", 250, rooms(), |text| {
        let level = toml::read(&text, "rooms.toml").map_err(|e| format!("{e}\n{text}"))?;
        assert_eq!(level.interior, Interior::Outlines);
        let (open, closed) = (
            solve_all(&level, Doors::Open)?,
            solve_all(&level, Doors::Closed)?,
        );
        let mut n = sample(&level, Doors::Open, &open, 60, &mut random())?;
        n += sample(&level, Doors::Closed, &closed, 60, &mut random())?;
        for (p, q) in open.iter().zip(&closed) {
            n += nothing_new(p, q)?;
        }
        Ok(n)
    });
}
