//! Levels of `levels/hard` that are too long to be written by hand: what made them.
//!
//! `ENFILADE_WRITE=1 cargo test --release generated` writes them anew; the difference is to be
//! reviewed.

use std::fmt::Write;
use std::fs;
use std::path::Path;

/// Whole steps as a decimal number with at most so many digits after the point.
fn decimal(steps: i64, digits: u32) -> String {
    let unit = 10i64.pow(digits);
    let (sign, steps) = (if steps < 0 { "-" } else { "" }, steps.abs());
    let fraction = format!("{:0width$}", steps % unit, width = digits as usize);
    let text = format!("{sign}{}.{fraction}", steps / unit);
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

/// A list of points, several on a line.
fn points(list: &[[i64; 2]], digits: u32, per_line: usize) -> String {
    let point = |p: &[i64; 2]| format!("[{}, {}]", decimal(p[0], digits), decimal(p[1], digits));
    let lines = list.chunks(per_line).map(|line| {
        let line: Vec<String> = line.iter().map(point).collect();
        format!("    {},\n", line.join(", "))
    });
    lines.collect()
}

/// A corridor between two zigzag walls, whose teeth overlap.
fn room_of_10000_edges() -> String {
    const TEETH: i64 = 5000;
    // In tenths: the lower wall from 0 to 1, the upper one from 0.9 to 1.9.
    let corner = |x: i64, low: i64| [10 * x, low + 10 * (x % 2)];
    let mut outline: Vec<[i64; 2]> = (0..TEETH).map(|x| corner(x, 0)).collect();
    outline.extend((0..TEETH).rev().map(|x| corner(x, 9)));
    assert_eq!(outline.len(), 10_000);
    let mut out = "\
# A room of 10,000 edges: a corridor 5 km long between two zigzag walls, whose teeth overlap.
#
# Made by tests/enfilade/generated.rs. The lower wall passes (0, 0), (1, 1), (2, 0), (3, 1) and so on, the
# upper one runs 0.9 above it. So at odd x a line is above 1, at even x below 0.9, and it cannot be above,
# below and above again: one sees past two teeth, but not past three. (A cell at x = 0.5 may reach past the
# tooth at 1, but from y = 0.9 not past that at 2.) The line from (0.5, 1.15) to (2.5, 0.75) is at 1.05 at
# x = 1 and at 0.85 at x = 2.
# hidden: 0.5,0.9 -> 5.5,0.9
# hidden: 2499.5,0.9 -> 2504.5,1
# hidden: 0.5,1 -> 4998.5,1
# sees: 0.5,1.15 -> 2.5,0.75
# sees: 4000.5,1.15 -> 4002.5,0.75
# sees: 4997,1.8 -> 4998,0.1

[[room]]
name = \"Corridor\"
outline = [
"
    .to_string();
    out += &points(&outline, 1, 10);
    out + "]\n"
}

/// A round hall with a flat closet at each of its edges.
fn cell_with_500_portals() -> String {
    const EDGES: i64 = 500;
    const RADIUS: f64 = 80.0;
    let at = |share: f64, radius: f64| {
        let angle = std::f64::consts::TAU * share / EDGES as f64;
        [angle.cos(), angle.sin()].map(|x| (x * radius * 1e4).round() as i64)
    };
    let hall: Vec<[i64; 2]> = (0..EDGES).map(|i| at(i as f64, RADIUS)).collect();
    let mut out = "\
# A cell with 500 portals: a round hall, and behind each of its 500 edges a closet 30 steps deep.
#
# Made by tests/enfilade/generated.rs. The hall's outline, a circle of radius 80 rounded to the grid, turns
# left at each corner (an edge is 1.005 long, and a corner lies 63 steps off the line through its
# neighbours), so the hall is convex. A closet is a triangle on an edge; its sides are flatter than the
# neighbouring edges, so that no wall's line cuts the hall. A line from the middle of an edge to that of
# another one goes on into both closets: everything sees everything.
# sees: everything
# cells bsp: 501

room = [
    { name = \"Hall\", outline = [
"
    .to_string();
    out += &points(&hall, 4, 8);
    out += "    ] },\n";
    let mut doors = String::new();
    for i in 0..EDGES {
        let [a, b] = [hall[i as usize], hall[((i + 1) % EDGES) as usize]];
        // Outside the middle of the edge, which lies 16 steps within the circle.
        let tip = at(i as f64 + 0.5, RADIUS + 0.0014);
        let list = |p: &[[i64; 2]]| points(p, 4, 3).trim().trim_end_matches(',').to_string();
        let closet = list(&[a, tip, b]);
        _ = writeln!(out, "    {{ name = \"{i}\", outline = [{closet}] }},");
        _ = writeln!(doors, "    {{ points = [{}] }},", list(&[a, b]));
    }
    out + "]\narchway = [\n" + &doors + "]\n"
}

/// Twelve octagons in a row, joined by halves of their sides; the line through the middles of those
/// sides has `room` steps.
fn octagon_chain(room: i64) -> String {
    // In steps of 0.00001: half the width, half a side, and half of their sum.
    const W: i64 = 120_710;
    const S: i64 = 50_000;
    const M: i64 = (W + S) / 2;
    let mut out = match room {
        0 => "\
# Twelve octagons joined by halves of their sides, which one line grazes, in an irrational direction.
#
# Made by tests/enfilade/generated.rs. A side is 1 long, so half the width is 0.5 + 1 / sqrt 2 = 1.2071,
# rounded. The octagons follow each other to the east and to the northeast in turn. The middles of the
# sides between them lie on one line: from one to the next it is (2.06065, 0.85355), by symmetry also after
# rounding. In the east the lower half of the side is open, in the northeast the upper half: a line would
# pass below, above, below the middles, and cannot. Two of them it can: the line from (0.5, -0.518) to
# (3.5, 1.256) passes x = 1.2071 at -0.0999, and the next side at (3.101, 1.020).
# hidden: 0,0 -> 6.5,1.7
# hidden: 0.38284,-0.34142 -> 22.63786,8.87692
# sees: 0.5,-0.518 -> 3.5,1.256
",
        _ => "\
# Twelve octagons joined by halves of their sides, which leave a line in an irrational direction one step.
#
# Made by tests/enfilade/generated.rs. As octagon-chain.toml, but in the east the open half of a side
# reaches one step, 0.00001, higher. (0.41213, 0.17071) is the direction of the line through all middles;
# (0.38284, -0.34142) lies on it, twice that before the first, and (22.63786, 8.87692), twice that after
# the last. The line between them that ends one step higher is above all middles, by less than a step.
# sees: 0.38284,-0.34142 -> 22.63786,8.87693
",
    }
    .to_string();
    out += "\nroom = [\n";
    let mut doors = String::new();
    let [mut x, mut y] = [0, 0];
    for i in 0..12 {
        let at = |dx: i64, dy: i64| [x + dx, y + dy];
        let corners = [
            at(W, -S),
            at(W, S),
            at(S, W),
            at(-S, W),
            at(-W, S),
            at(-W, -S),
            at(-S, -W),
            at(S, -W),
        ];
        let list = |p: &[[i64; 2]]| points(p, 5, 8).trim().trim_end_matches(',').to_string();
        _ = writeln!(
            out,
            "    {{ name = \"{i}\", outline = [{}] }},",
            list(&corners)
        );
        let (door, step) = match i % 2 {
            0 => ([at(W, -S), at(W, room)], [2 * W, 0]),
            _ => ([at(M, M), at(S, W)], [W + S, W + S]),
        };
        if i < 11 {
            _ = writeln!(doors, "    {{ points = [{}] }},", list(&door));
        }
        [x, y] = [x + step[0], y + step[1]];
    }
    out + "]\narchway = [\n" + &doors + "]\n"
}

/// One level at a scale of 2^`exponent`.
fn at_scale(exponent: i32) -> String {
    let numbers = |list: &[[i64; 2]]| -> Vec<[f64; 2]> {
        let scaled = |x: i64| x as f64 * 2f64.powi(exponent);
        list.iter().map(|p| p.map(scaled)).collect()
    };
    let arrow = |from: [i64; 2], to: [i64; 2]| {
        let [[a, b], [c, d]] = numbers(&[from, to])[..] else {
            unreachable!("two points make two")
        };
        format!("{a},{b} -> {c},{d}")
    };
    let (words, other) = match exponent {
        -10 => ("1 in 1024, 6 cm long", "the level of scale-1.toml at 2^-10"),
        0 => (
            "64 long",
            "the level of scale-1-1024.toml and scale-1024.toml",
        ),
        _ => ("1024 to 1, 65 km long", "the level of scale-1.toml at 2^10"),
    };
    let mut out = format!(
        "\
# One level at three scales, with one truth: {words}.
#
# Made by tests/enfilade/generated.rs; {other}. In the sizes of scale-1: north
# of the wall y = 8 stand walls at x = 16, 32 and 48 with openings from y = 10 to 14, 12 to 16 and 22 to 26.
# The ends (16, 10), (32, 16) and (48, 22) lie on one line, and a line would pass above, below and above
# it. The first two it passes: from (8, 12) to (40, 16) at 13 and at 15. South of the wall stand
# walls at x = 20, 40 and 50 with openings from y = 2 to 4: the line from (10, 2) to (60, 4) passes at 2.4,
# 3.2 and 3.6.
# hidden: {}
# sees: {}
# sees: {}
# hidden: {}
",
        arrow([8, 12], [56, 24]),
        arrow([8, 12], [40, 16]),
        arrow([10, 2], [60, 4]),
        arrow([10, 2], [56, 24]),
    );
    let mut put = |what: &str, list: &[[i64; 2]], closed: bool| {
        let list: Vec<String> = (numbers(list).iter())
            .map(|p| format!("[{}, {}]", p[0], p[1]))
            .collect();
        _ = write!(out, "\n[[{what}]]\npoints = [{}]\n", list.join(", "));
        if closed {
            out += "closed = true\n";
        }
    };
    put("wall", &[[0, 0], [64, 0], [64, 32], [0, 32]], true);
    put("wall", &[[0, 8], [64, 8]], false);
    let gaps = [(16, 10, 14), (32, 12, 16), (48, 22, 26)];
    let gaps = gaps.into_iter().chain([20, 40, 50].map(|x| (x, 2, 4)));
    for (x, low, high) in gaps {
        let [from, to] = if high > 8 { [8, 32] } else { [0, 8] };
        put("wall", &[[x, from], [x, to]], false);
        put("archway", &[[x, low], [x, high]], false);
    }
    out
}

#[test]
fn generated_levels_are_what_their_generator_makes() {
    let all = [
        ("room-of-10000-edges", room_of_10000_edges()),
        ("cell-with-500-portals", cell_with_500_portals()),
        ("octagon-chain", octagon_chain(0)),
        ("octagon-chain-apart", octagon_chain(1)),
        ("scale-1-1024", at_scale(-10)),
        ("scale-1", at_scale(0)),
        ("scale-1024", at_scale(10)),
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/hard");
    for (name, text) in all {
        let path = folder.join(format!("{name}.toml"));
        if std::env::var_os("ENFILADE_WRITE").is_some() {
            fs::write(&path, &text).expect("levels/hard can be written");
        }
        let found = fs::read_to_string(&path).unwrap_or_default();
        assert!(
            found == text,
            "{name}.toml is not what its generator makes; ENFILADE_WRITE=1 writes it anew"
        );
    }
}
