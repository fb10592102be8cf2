//! Random levels, full of coincidences, and how tests run over many of them.
//!
//! The seed is fixed, so that a run repeats; `PROPTEST_RNG_SEED` takes another one, and
//! `ENFILADE_CASES=20` makes it twenty times as many levels. A failure prints the smallest level
//! found, ready to be pasted into `regression`.

use std::cell::Cell;

use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseError, TestRunner};

use crate::plan::{Ink, Stroke, rectangle, ring};

/// Runs `check` on random values; prints how many, and from which seed, and returns how many.
pub fn on_random<S: Strategy>(
    name: &'static str,
    cases: u32,
    strategy: S,
    check: impl Fn(S::Value) -> Result<usize, String>,
) -> u32 {
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
    cases
}

pub type Points = [i64; 2];

pub fn point(size: i64) -> impl Strategy<Value = Points> {
    [0..=size, 0..=size]
}

/// Any walls on a small grid: crossings, T-junctions, overlaps and duplicates all over.
pub fn tangle(size: i64, most: usize) -> impl Strategy<Value = Vec<Stroke>> {
    prop::collection::vec((point(size), point(size)), 1..=most).prop_map(|list| {
        list.into_iter()
            .map(|(a, b)| Stroke(a, b, Ink::Solid))
            .collect()
    })
}

/// Walls that lie on few lines, so that they overlap, repeat, and look along each other.
pub fn on_few_lines(size: i64) -> impl Strategy<Value = Vec<Stroke>> {
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
pub fn boxes() -> impl Strategy<Value = Vec<Stroke>> {
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
pub fn grazing() -> impl Strategy<Value = Vec<Stroke>> {
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
pub fn slivers() -> impl Strategy<Value = Vec<Stroke>> {
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
pub const FAR: i64 = (1 << 26) - 2;

/// Few walls anywhere on the whole grid: crossings need all bits.
pub fn vast() -> impl Strategy<Value = Vec<Stroke>> {
    tangle(FAR, 6)
}

/// In a box, so that all of it is inside.
pub fn boxed(
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

pub fn any_walls() -> BoxedStrategy<Vec<Stroke>> {
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

/// Walls along the lines of a grid whose crossings are a little off, so that what would lie in line
/// nearly does; openings in those that stayed in line.
pub fn grids() -> BoxedStrategy<Vec<Stroke>> {
    const PITCH: i64 = 4;
    const SIDE: i64 = 5;
    let off = prop_oneof![3 => Just([0, 0]), 1 => [-1..=1i64, -1..=1i64]];
    let edge = prop::sample::select(vec![
        None,
        None,
        Some(Ink::Solid),
        Some(Ink::Solid),
        Some(Ink::Archway),
        Some(Ink::Door),
        Some(Ink::Line),
    ]);
    let n = SIDE as usize;
    let corners = prop::collection::vec(off, n * n);
    let edges = prop::collection::vec(edge, 2 * n * n);
    let strokes = (2..=n, 2..=n, corners, edges).prop_map(move |(width, height, off, edges)| {
        let at = |i: usize, j: usize| {
            let [dx, dy] = off[j * n + i];
            [2 + PITCH * i as i64 + dx, 2 + PITCH * j as i64 + dy]
        };
        let mut strokes = Vec::new();
        for (k, ink) in edges.iter().enumerate() {
            let (i, j) = (k / 2 % n, k / 2 / n);
            let (to_i, to_j) = if k % 2 == 0 { (i + 1, j) } else { (i, j + 1) };
            let Some(ink) = ink.filter(|_| to_i < width && to_j < height) else {
                continue;
            };
            let (from, to) = (at(i, j), at(to_i, to_j));
            if matches!(ink, Ink::Archway | Ink::Door) {
                strokes.push(Stroke(from, to, Ink::Wall));
                // The middle of it, where that has whole coordinates.
                let inner = |a: i64, b: i64| (a == b).then_some([a, a]).or(Some([a + 1, b - 1]));
                let middle = inner(from[0], to[0]).zip(inner(from[1], to[1]));
                match middle {
                    Some(([x0, x1], [y0, y1])) if from[0] == to[0] || from[1] == to[1] => {
                        strokes.push(Stroke([x0, y0], [x1, y1], ink));
                    }
                    _ => strokes.push(Stroke(from, to, ink)),
                }
            } else {
                strokes.push(Stroke(from, to, ink));
            }
        }
        strokes
    });
    boxed(PITCH * SIDE + 4, strokes)
}

/// Oblong boxes at any angle, long ones among them, some open on one side.
pub fn rotated_boxes() -> BoxedStrategy<Vec<Stroke>> {
    let one = (
        [10..=30i64, 10..=30i64],
        (1..=3i64, -3..=3i64),
        1..=3i64,
        1..=3i64,
        0..5u8,
    );
    let strokes = prop::collection::vec(one, 1..6).prop_map(|list| {
        let of = |&([x, y], (a, b), long, wide, open): &(Points, (i64, i64), i64, i64, u8)| {
            let (u, v) = ([a * long, b * long], [-b * wide, a * wide]);
            let corners = [
                [x, y],
                [x + u[0], y + u[1]],
                [x + u[0] + v[0], y + u[1] + v[1]],
                [x + v[0], y + v[1]],
            ];
            let mut sides = ring(&corners, Ink::Solid);
            if open < 4 {
                sides.remove(open as usize);
            }
            sides
        };
        list.iter().flat_map(of).collect()
    });
    boxed(40, strokes)
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

/// A TOML level: a row of rooms of different heights on the plan, doors between neighbours, and
/// what stands in them.
pub fn rooms() -> impl Strategy<Value = String> {
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
