//! How far floors and ceilings move: from motions to the range of every sector.
//!
//! In: what moves each floor and ceiling, and which sectors are neighbours. Out: bounds that are
//! never left. They are those of interval arithmetic: a door opens to its lowest neighbouring
//! ceiling, so to somewhere between the lowest and the highest that this can be, while the
//! neighbours move themselves. Bounds grow until nothing changes; where they would grow for ever
//! (lifts that push each other up), the format's own limit ends it.

use std::collections::BTreeSet;

use super::raw::{RawMap, RawSector};
use super::specials::Goal;
use crate::level::Height;

/// No height of the game lies beyond: its numbers have 16 bits before the point.
pub const FAR: f64 = 32768.0;

/// Rounds of growing after which what still grows goes to [`FAR`].
const PATIENT_ROUNDS: usize = 200;

/// Where a sector's floor and ceiling can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The floor.
    pub floor: Height,
    /// The ceiling.
    pub ceiling: Height,
}

/// What moves the sectors, by sector number.
#[derive(Clone, Debug, Default)]
pub struct Motions {
    /// Sectors beyond two-sided lines.
    pub neighbours: Vec<BTreeSet<usize>>,
    /// What moves each floor.
    pub floors: Vec<Motion>,
    /// What moves each ceiling.
    pub ceilings: Vec<Motion>,
}

/// What is known to move a floor or ceiling.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// Where it goes, each goal once.
    goals: Vec<Goal>,
    /// Sums of the distances that it can go down and up by itself.
    down: f64,
    up: f64,
    /// It also goes wherever the floor below goes (an elevator's ceiling).
    pub carried: bool,
}

/// Lowest and highest.
type Interval = [f64; 2];

/// Grows all intervals from rest until every goal lies inside.
pub fn grow(raw: &RawMap, motions: &Motions) -> Vec<Range> {
    let at_rest = |z: f64| [z, z];
    let mut floors: Vec<Interval> = raw.sectors.iter().map(|s| at_rest(s.floor)).collect();
    let mut ceilings: Vec<Interval> = raw.sectors.iter().map(|s| at_rest(s.ceiling)).collect();
    let moving: Vec<usize> = (0..floors.len())
        .filter(|&s| motions.floors[s].moves() || motions.ceilings[s].moves())
        .collect();
    for round in 0.. {
        let mut changed = false;
        for &s in &moving {
            let floor = motions.reach(
                s,
                &motions.floors[s],
                &floors,
                &ceilings,
                raw.sectors[s].floor,
            );
            let mut ceiling = motions.reach(
                s,
                &motions.ceilings[s],
                &floors,
                &ceilings,
                raw.sectors[s].ceiling,
            );
            if motions.ceilings[s].carried {
                ceiling = motions.carry(s, ceiling, floors[s], &raw.sectors[s]);
            }
            let impatient = round >= PATIENT_ROUNDS;
            changed |= widen(&mut floors[s], floor, impatient);
            changed |= widen(&mut ceilings[s], ceiling, impatient);
        }
        // After the patient rounds each of the four bounds of a sector changes once at most.
        if !changed {
            break;
        }
    }
    let height = |rest: f64, [low, high]: Interval| Height { rest, low, high };
    let rows = raw.sectors.iter().zip(floors.iter().zip(&ceilings));
    rows.map(|(sector, (&floor, &ceiling))| Range {
        floor: height(sector.floor, floor),
        ceiling: height(sector.ceiling, ceiling),
    })
    .collect()
}

impl Motions {
    /// Where a motion can take the floor or ceiling that rests at `rest`, as far as known by now.
    fn reach(
        &self,
        sector: usize,
        motion: &Motion,
        floors: &[Interval],
        ceilings: &[Interval],
        rest: f64,
    ) -> Interval {
        let mut reach = [rest, rest];
        for &goal in &motion.goals {
            let [low, high] = self.aim(sector, goal, floors, ceilings);
            reach = [reach[0].min(low), reach[1].max(high)];
        }
        [
            (reach[0] - motion.down).max(-FAR).min(rest),
            (reach[1] + motion.up).min(FAR).max(rest),
        ]
    }

    /// Where a goal can lie, as far as known by now. A goal that lies only above (below) leaves the
    /// other bound at infinity, where it widens nothing.
    fn aim(
        &self,
        sector: usize,
        goal: Goal,
        floors: &[Interval],
        ceilings: &[Interval],
    ) -> Interval {
        const NOWHERE: Interval = [f64::INFINITY, f64::NEG_INFINITY];
        let around = || self.neighbours[sector].iter().copied();
        let least = |heights: &[Interval]| {
            let lower = |a: Interval, s: usize| [a[0].min(heights[s][0]), a[1].min(heights[s][1])];
            around().fold([f64::INFINITY; 2], lower)
        };
        let greatest = |heights: &[Interval]| {
            let upper = |a: Interval, s: usize| [a[0].max(heights[s][0]), a[1].max(heights[s][1])];
            around().fold([f64::NEG_INFINITY; 2], upper)
        };
        let hull = |a: Interval, b: Interval| [a[0].min(b[0]), a[1].max(b[1])];
        let any = |heights: &[Interval]| around().fold(NOWHERE, |a, s| hull(a, heights[s]));
        let alone = self.neighbours[sector].is_empty();
        match goal {
            // A sector without neighbours: the games differ in what they take for the answer.
            Goal::LowestFloor if alone => NOWHERE,
            Goal::HighestFloor | Goal::AboveHighestFloor if alone => [-FAR, f64::NEG_INFINITY],
            Goal::LowestCeiling | Goal::HighestCeiling if alone => [-FAR, FAR],
            Goal::LowestFloor => least(floors),
            Goal::HighestFloor | Goal::AboveHighestFloor => {
                let [low, high] = greatest(floors);
                let above = if goal == Goal::HighestFloor { 0.0 } else { 8.0 };
                // The original game never looks below -500.
                [low, high.max(-500.0) + above]
            }
            Goal::HigherFloor => [f64::INFINITY, greatest(floors)[1]],
            Goal::LowerFloor => [least(floors)[0], f64::NEG_INFINITY],
            Goal::AnyFloor => any(floors),
            Goal::LowestCeiling => {
                let [low, high] = least(ceilings);
                [low - 8.0, high]
            }
            // The original game never looks below 0.
            Goal::HighestCeiling => {
                let [low, high] = greatest(ceilings);
                [low, high.max(0.0)]
            }
            Goal::HigherCeiling => [f64::INFINITY, greatest(ceilings)[1]],
            Goal::LowerCeiling => [least(ceilings)[0], f64::NEG_INFINITY],
            Goal::OwnFloor => floors[sector],
            Goal::AboveOwnFloor => [floors[sector][0], floors[sector][1] + 8.0],
            Goal::OwnCeiling => [ceilings[sector][0] - 8.0, ceilings[sector][1]],
            Goal::Nearby | Goal::FrontFloor => {
                let own = hull(floors[sector], ceilings[sector]);
                hull(own, hull(any(floors), any(ceilings)))
            }
            Goal::Above(other, rise) => [floors[other][0] + rise, floors[other][1] + rise],
            Goal::At(z) => [z, z],
            Goal::FarUp => [f64::INFINITY, FAR],
            Goal::FarDown => [-FAR, f64::NEG_INFINITY],
        }
    }

    /// An elevator's ceiling keeps its distance from the floor, unless something else moves it:
    /// then it may be anywhere.
    fn carry(
        &self,
        sector: usize,
        ceiling: Interval,
        floor: Interval,
        rest: &RawSector,
    ) -> Interval {
        let motion = &self.ceilings[sector];
        if !motion.goals.is_empty() || motion.down > 0.0 || motion.up > 0.0 {
            return [-FAR, FAR];
        }
        let gap = rest.ceiling - rest.floor;
        [
            ceiling[0].min((floor[0] + gap).max(-FAR)),
            ceiling[1].max((floor[1] + gap).min(FAR)),
        ]
    }
}

impl Motion {
    /// Goes to a goal.
    pub fn go_to(&mut self, goal: Goal) {
        if !self.goals.contains(&goal) {
            self.goals.push(goal);
        }
    }

    /// Whether anything moves it.
    pub fn moves(&self) -> bool {
        !self.goals.is_empty() || self.down > 0.0 || self.up > 0.0 || self.carried
    }

    /// Goes up (down if negative) by a distance; if again and again, without end.
    pub fn go_by(&mut self, by: f64, repeats: bool) {
        let way = if repeats { 2.0 * FAR } else { by.abs() };
        if by > 0.0 {
            self.up += way;
        } else if by < 0.0 {
            self.down += way;
        }
    }
}

/// Widens an interval to hold another; impatiently, a bound that moves goes to the limit at once.
fn widen(interval: &mut Interval, other: Interval, impatient: bool) -> bool {
    let before = *interval;
    if other[0] < interval[0] {
        interval[0] = if impatient {
            other[0].min(-FAR)
        } else {
            other[0]
        };
    }
    if other[1] > interval[1] {
        interval[1] = if impatient {
            other[1].max(FAR)
        } else {
            other[1]
        };
    }
    *interval != before
}
