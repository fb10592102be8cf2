//! Moving the ends of walls. Openings stay in the walls that they are cut into.

use std::collections::HashMap;

use glam::DVec2;

use crate::geom::GridPoint;

use super::super::draft::DraftWall;
use super::super::model::{Level, Wall, WallId};
use super::finish::{Parts, draft, finish};
use super::runs::{Run, along, is_opening, runs};
use super::{EditError, wall};

/// Moves a point in which walls end; all of them move along. The openings of those walls keep
/// their width, and their distance from the end that stays.
///
/// # Errors
/// Where no wall ends at `from`, where a wall would lose its length or become too short for its
/// openings, or an outline would cross itself.
pub fn move_point(level: &Level, from: GridPoint, to: DVec2) -> Result<Level, EditError> {
    let ends = level.walls.iter().flat_map(|w| [w.from, w.to]);
    if !ends.into_iter().any(|p| p == from) {
        return Err(EditError::NoPoint);
    }
    let goal = level.grid.nearest(to).ok_or_else(|| too_far(to))?;
    displace(level, &HashMap::from([(from, goal)]))
}

/// Moves a whole wall, from corner to corner, with everything that ends in its two corners.
///
/// # Errors
/// As for [`move_point`]; and for openings, which are not moved by themselves.
pub fn move_wall(level: &Level, id: WallId, by: DVec2) -> Result<Level, EditError> {
    let wall = wall(level, id)?;
    let run = (runs(level).into_iter()).find(|run| run.walls.contains(&(id.0 as usize)));
    let [a, b] = run.map_or([wall.from, wall.to], |run| run.ends());
    let target = level.grid.to_level(a) + by;
    let new = level.grid.nearest(target).ok_or_else(|| too_far(target))?;
    let other = GridPoint::new(b.x + new.x - a.x, b.y + new.y - a.y);
    let place = level.grid.to_level(other);
    if level.grid.nearest(place) != Some(other) {
        return Err(too_far(place));
    }
    displace(level, &HashMap::from([(a, new), (b, other)]))
}

fn too_far(p: DVec2) -> EditError {
    EditError::TooFar { x: p.x, y: p.y }
}

/// Where a point goes: exactly there, or to a place that was computed.
#[derive(Clone, Copy)]
enum Goal {
    Grid(GridPoint),
    Computed(DVec2),
}

type Moves = HashMap<GridPoint, GridPoint>;

fn displace(level: &Level, moves: &Moves) -> Result<Level, EditError> {
    if moves.iter().all(|(from, to)| from == to) {
        return Ok(level.clone());
    }
    let runs = runs(level);
    let mut along_with: HashMap<GridPoint, Goal> = HashMap::new();
    // Openings that a moved wall takes along, and the walls between them.
    let mut follows = vec![false; level.walls.len()];
    for run in (runs.iter()).filter(|r| r.ends().iter().any(|end| moves.contains_key(end))) {
        follows[run.walls.clone()].fill(true);
        let openings: Vec<usize> = (0..level.walls.len())
            .filter(|&i| is_opening(&level.walls[i]) && run.holds(&level.walls[i]))
            .collect();
        carry(level, moves, run, &openings, &mut along_with)?;
        openings.iter().for_each(|&i| follows[i] = true);
    }
    let mut parts = Parts::of(level);
    for ((old, new), follows) in level.walls.iter().zip(&mut parts.walls).zip(follows) {
        *new = moved(level, old, |p| {
            let corner = moves.get(&p).map(|&q| Goal::Grid(q));
            corner.or(along_with.get(&p).filter(|_| follows).copied())
        });
    }
    finish(level, parts)
}

fn moved(level: &Level, wall: &Wall, goal: impl Fn(GridPoint) -> Option<Goal>) -> DraftWall {
    let mut new = draft(level, wall);
    for (end, at, i) in [(&mut new.from, wall.from, 0), (&mut new.to, wall.to, 1)] {
        match goal(at) {
            None => {}
            Some(Goal::Grid(p)) => *end = level.grid.to_level(p),
            Some(Goal::Computed(p)) => {
                *end = p;
                new.written[i] = false;
            }
        }
    }
    new
}

/// Finds new places for the openings of a run one or both of whose ends move.
fn carry(
    level: &Level,
    moves: &Moves,
    run: &Run,
    openings: &[usize],
    goals: &mut HashMap<GridPoint, Goal>,
) -> Result<(), EditError> {
    let new = |p: GridPoint| moves.get(&p).copied().unwrap_or(p);
    let [a, b] = run.ends();
    let shift = |p: GridPoint| (new(p).x - p.x, new(p).y - p.y);
    let ends = openings.iter().map(|&i| &level.walls[i]);
    if shift(a) == shift(b) {
        for p in ends.flat_map(|w| [w.from, w.to]) {
            let goal = GridPoint::new(p.x + shift(a).0, p.y + shift(a).1);
            goals.entry(p).or_insert(Goal::Grid(goal));
        }
        return Ok(());
    }
    // Measured from the end that stays.
    let [still, other] = if moves.contains_key(&a) && !moves.contains_key(&b) {
        [b, a]
    } else {
        [a, b]
    };
    let at = |p: GridPoint| level.grid.to_level(p);
    let (old_still, old_other) = (at(still), at(other));
    let (new_still, new_other) = (at(new(still)), at(new(other)));
    let length = new_still.distance(new_other);
    if length == 0.0 {
        return Err(EditError::NoLength);
    }
    // Less than that is rounding.
    let slack = level.grid.step.length();
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for wall in ends {
        let place = |p: GridPoint| {
            if p == other {
                old_still.distance(old_other)
            } else {
                along(old_still, old_other, at(p))
            }
        };
        let (p, q) = (place(wall.from), place(wall.to));
        let (low, high, width) = (p.min(q), p.max(q), (p - q).abs());
        // An opening from corner to corner is as long as its wall.
        let whole = [wall.from, wall.to]
            .iter()
            .all(|end| run.ends().contains(end));
        if !whole && width > length + slack {
            return Err(EditError::TooWide {
                width,
                available: length,
            });
        }
        let back = (high - length).max(0.0).min(low.max(0.0));
        taken.push([low - back, (high - back).min(length)]);
        for (end, distance) in [(wall.from, p), (wall.to, q)] {
            let distance = distance - back;
            let goal = if run.ends().contains(&end) && whole || distance >= length - slack {
                Goal::Grid(new(if whole { end } else { other }))
            } else if distance <= slack {
                Goal::Grid(new(still))
            } else {
                Goal::Computed(new_still.lerp(new_other, distance / length))
            };
            goals.entry(end).or_insert(goal);
        }
    }
    taken.sort_by(|x, y| x[0].total_cmp(&y[0]));
    match taken
        .windows(2)
        .find(|pair| pair[1][0] < pair[0][1] - slack)
    {
        Some(pair) => Err(EditError::TooWide {
            width: pair[0][1] - pair[0][0] + pair[1][1] - pair[1][0],
            available: length,
        }),
        None => Ok(()),
    }
}
