//! Levels on which something once went wrong.

use enfilade::cells::Doors;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::compare::{identical, sample, solve_all};
use crate::plan::{Ink::*, Stroke, level};

/// All that can be asked of a level without knowing its answer.
fn keeps_all_promises(strokes: &[Stroke]) {
    let level = level(strokes);
    for doors in [Doors::Open, Doors::Closed] {
        let solved = solve_all(&level, doors).unwrap();
        sample(&level, doors, &solved, 200, &mut Pcg64::seed_from_u64(1)).unwrap();
    }
}

#[test]
fn a_single_triangle() {
    keeps_all_promises(&[
        Stroke([0, 0], [2, 0], Solid),
        Stroke([2, 0], [0, 2], Solid),
        Stroke([0, 2], [0, 0], Solid),
    ]);
}

#[test]
fn a_flat_triangle_on_the_rim_is_not_torn_off_the_plan() {
    keeps_all_promises(&[
        Stroke([0, 0], [1, 0], Solid),
        Stroke([1, 0], [67108862, 2], Solid),
        Stroke([67108862, 2], [0, 0], Solid),
        Stroke([67108862, 1], [67108861, 0], Solid),
        Stroke([67108861, 0], [67108861, 2], Solid),
        Stroke([0, 0], [67108862, 0], Solid),
        Stroke([67108862, 0], [67108862, 67108862], Solid),
        Stroke([67108862, 67108862], [0, 67108862], Solid),
        Stroke([0, 67108862], [0, 0], Solid),
    ]);
}

#[test]
fn flat_triangles_mended_in_any_order_of_walls_are_the_same() {
    let strokes = [
        Stroke([1, 3], [67108861, 0], Solid),
        Stroke([67108861, 0], [33554434, 67108859], Solid),
        Stroke([33554434, 67108859], [1, 3], Solid),
        Stroke([67108860, 0], [2, 0], Solid),
        Stroke([2, 0], [3, 2], Solid),
        Stroke([0, 0], [67108862, 0], Solid),
        Stroke([67108862, 0], [67108862, 67108862], Solid),
        Stroke([67108862, 67108862], [0, 67108862], Solid),
        Stroke([0, 67108862], [0, 0], Solid),
    ];
    let before = solve_all(&level(&strokes), Doors::Open).unwrap();
    for first in 0..strokes.len() {
        let mut shuffled = strokes;
        shuffled.rotate_left(first);
        for (p, q) in before
            .iter()
            .zip(&solve_all(&level(&shuffled), Doors::Open).unwrap())
        {
            identical(p, q).unwrap();
        }
    }
}
