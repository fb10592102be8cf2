//! Random levels: everything that must hold of any level holds of them. See `random` for how they are
//! made, and `bulk` for the agreement of all methods on ten thousand of them.

use enfilade::cells::Doors;
use enfilade::level::Level;
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::compare::{Solved, Turn, identical, nothing_new, pools, same_turned, solve_all};
use crate::plan::{Ink, Stroke, level, moved};
use crate::random::{
    FAR, Points, any_inks, any_walls, boxed, grazing, on_random, point, tangle, vast,
};
use crate::reference;

fn solve_within(threads: usize, level: &Level) -> Result<Vec<Solved>, String> {
    pools()[threads - 1].install(|| solve_all(level, Doors::Open))
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
