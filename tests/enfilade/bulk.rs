//! Ten thousand random levels on which everything must agree: both exact methods bit for bit, the three
//! subdivisions point by point, and no free segment found at random may be missing.

use enfilade::cells::Doors;
use enfilade::level::{Interior, Wall, WallKind, toml};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::compare::{Solved, nothing_new, sample, solve_all};
use crate::plan::{self, Ink, Stroke, rectangle};
use crate::random::{
    FAR, any_inks, any_walls, boxed, grids, on_random, rooms, rotated_boxes, slivers,
};

/// A level as it was drawn at random.
#[derive(Clone, Debug)]
enum Drawn {
    Strokes(Vec<Stroke>),
    Toml(String),
}

/// A kind of level, how many of it, and how they are drawn.
type Family = (&'static str, u32, fn() -> BoxedStrategy<Drawn>);

const FAMILIES: [Family; 6] = [
    ("walls anywhere", 3000, || strokes(any_walls())),
    ("grids of walls", 2500, || strokes(grids())),
    ("rotated boxes", 2000, || strokes(rotated_boxes())),
    ("slivers", 1000, || strokes(boxed(FAR, slivers()))),
    ("openings anywhere", 1500, || strokes(any_inks())),
    ("rooms", 500, || rooms().prop_map(Drawn::Toml).boxed()),
];

fn strokes(drawn: BoxedStrategy<Vec<Stroke>>) -> BoxedStrategy<Drawn> {
    drawn.prop_map(Drawn::Strokes).boxed()
}

/// Random segments tried on each level.
const SEGMENTS: usize = 150;

/// Whatever sees each other in one subdivision does in all: the cells of the others that overlap it
/// hold a pair that does. Returns the pairs compared.
fn same_sight(solved: &[Solved]) -> Result<usize, String> {
    let mut pairs = 0;
    for p in solved {
        for q in solved {
            let names = [p, q].map(|s| s.graph.options.subdivision.as_str());
            if names[0] != names[1] {
                let result = nothing_new(p, q);
                pairs += result.map_err(|e| format!("{} to {}: {e}", names[0], names[1]))?;
            }
        }
    }
    Ok(pairs)
}

/// Everything that can be asked of a level without knowing its answer. Returns the comparisons.
fn agrees(drawn: &Drawn) -> Result<usize, String> {
    let level = match drawn {
        Drawn::Strokes(strokes) => plan::level(strokes),
        Drawn::Toml(text) => {
            let level = toml::read(text, "rooms.toml").map_err(|e| format!("{e}\n{text}"))?;
            assert_eq!(level.interior, Interior::Outlines);
            level
        }
    };
    let mut compared = 0;
    let mut all = Vec::new();
    for doors in [Doors::Open, Doors::Closed] {
        let solved = solve_all(&level, doors)?;
        compared += same_sight(&solved)?;
        let random = &mut Pcg64::seed_from_u64(1);
        compared += sample(&level, doors, &solved, SEGMENTS, random)?;
        all.push(solved);
        // Without anything to shut there is no second case.
        let shut = |wall: &Wall| match &wall.kind {
            WallKind::Edge { shut } => *shut,
            WallKind::Opening(opening) => opening.shut,
            WallKind::Solid | WallKind::Outline => false,
        };
        if !level.walls.iter().any(shut) {
            break;
        }
    }
    if let [open, closed] = &all[..] {
        for (p, q) in open.iter().zip(closed) {
            compared += nothing_new(p, q)?;
        }
    }
    Ok(compared)
}

#[test]
fn ten_thousand_random_levels_agree() {
    let counts = FAMILIES
        .par_iter()
        .map(|&(name, cases, strategy)| on_random(name, cases, strategy(), |drawn| agrees(&drawn)));
    let n: u32 = counts.sum();
    println!("{n} random levels agree: two methods, three subdivisions, random segments");
    assert!(n >= 10_000, "only {n} levels");
}

/// The comparison of subdivisions can fail: it notices a pair that one of them lacks.
#[test]
fn a_pair_missing_in_one_subdivision_is_noticed() {
    let strokes = rectangle([0, 0], [8, 4], Ink::Solid);
    let wall = Stroke([4, 0], [4, 2], Ink::Solid);
    let level = plan::level(&[strokes, vec![wall]].concat());
    let mut solved = solve_all(&level, Doors::Open).unwrap();
    same_sight(&solved).unwrap();
    // The coarsest one: of finer cells, others in the same place may make up for the pair.
    let visible = &mut solved[0].pvs.visible;
    let last = visible.n() - 1;
    assert!(last > 0 && visible.get(0, last));
    for (i, j) in [(0, last), (last, 0)] {
        visible.row_mut(i)[j / 64] &= !(1 << (j % 64));
    }
    same_sight(&solved).unwrap_err();
}
