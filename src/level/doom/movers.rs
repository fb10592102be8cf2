//! Sectors that move, and how far: the range of every floor and ceiling.
//!
//! In: a map's lists. Out: for each sector where its floor and ceiling stand at rest, and bounds
//! that neither ever leaves, whatever is set off in whatever order. The bounds are those of
//! interval arithmetic: a door opens to its lowest neighbouring ceiling, so to somewhere between
//! the lowest and the highest that this can be, while the neighbours move themselves. Bounds grow
//! until nothing changes; where they would grow for ever (lifts that push each other up), the
//! format's own limit ends it.

use std::collections::{BTreeMap, BTreeSet};

use super::defect::{Defect, Tally};
use super::raw::{RawLine, RawMap, Specials};
use super::specials::{self, Act, Follow, Goal, Meaning, Target};
use crate::level::{Height, Place};

/// No height of the game lies beyond: its numbers have 16 bits before the point.
pub const FAR: f64 = 32768.0;

/// Rounds of growing after which what still grows goes to [`FAR`].
const PATIENT_ROUNDS: usize = 200;

/// Tags that a boss's death sets off.
const BOSS_TAGS: [i32; 2] = [666, 667];

/// Where a sector's floor and ceiling can be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The floor.
    pub floor: Height,
    /// The ceiling.
    pub ceiling: Height,
}

/// What is known to move a floor or ceiling.
#[derive(Clone, Debug, Default)]
struct Motion {
    goals: Vec<Goal>,
    /// Sums of the distances that it can go down and up by itself.
    down: f64,
    up: f64,
    /// It also goes wherever the floor below goes (an elevator's ceiling).
    carried: bool,
}

/// Lowest and highest.
type Interval = [f64; 2];

/// The neighbourhood of the sectors, and what moves them.
struct Movers<'a> {
    raw: &'a RawMap,
    /// Sectors beyond two-sided lines, by sector.
    neighbours: Vec<BTreeSet<usize>>,
    /// Sectors by tag.
    tagged: BTreeMap<i32, Vec<usize>>,
    floors: Vec<Motion>,
    ceilings: Vec<Motion>,
    stairs: Vec<Flight>,
    /// Sectors with a slope.
    sloped: BTreeSet<usize>,
}

/// Stairs that begin in a sector.
struct Flight {
    first: usize,
    step: f64,
    follow: Follow,
    repeats: bool,
}

/// The range of every sector, by number.
pub fn ranges(raw: &RawMap, tally: &mut Tally) -> Vec<Range> {
    let mut movers = Movers::new(raw);
    movers.read_lines(tally);
    movers.read_things();
    movers.read_sectors(tally);
    movers.build_stairs();
    movers.grow()
}

impl<'a> Movers<'a> {
    fn new(raw: &'a RawMap) -> Self {
        let n = raw.sectors.len();
        let mut neighbours = vec![BTreeSet::new(); n];
        for line in raw.lines.iter().filter(|l| l.two_sided) {
            if let (Some(front), Some(back)) = (raw.sector_at(line.front), raw.sector_at(line.back))
                && front != back
            {
                neighbours[front].insert(back);
                neighbours[back].insert(front);
            }
        }
        let mut tagged: BTreeMap<i32, Vec<usize>> = BTreeMap::new();
        for (number, sector) in raw.sectors.iter().enumerate() {
            for &tag in &sector.tags {
                tagged.entry(tag).or_default().push(number);
            }
        }
        Movers {
            raw,
            neighbours,
            tagged,
            floors: vec![Motion::default(); n],
            ceilings: vec![Motion::default(); n],
            stairs: Vec::new(),
            sloped: BTreeSet::new(),
        }
    }

    fn read_lines(&mut self, tally: &mut Tally) {
        for (number, line) in (0u32..).zip(&self.raw.lines) {
            let place = Place::Linedef(number);
            let meaning = match self.raw.specials {
                Specials::Doom => specials::doom(line.special),
                Specials::Action => specials::action(line.special, line.args, line.repeats),
            };
            let mover = match meaning {
                Meaning::Nothing => {
                    self.slope(line);
                    continue;
                }
                Meaning::Unknown => {
                    tally.add(Defect::UnknownSpecial, place);
                    continue;
                }
                Meaning::Moves(mover) => mover,
            };
            let tags = match mover.target {
                Target::Behind => {
                    if let Some(sector) = self.raw.sector_at(line.back) {
                        self.apply(sector, &mover.acts, mover.repeats, Some(line));
                    }
                    continue;
                }
                Target::Tag(tag) => vec![tag],
                Target::Tagged => line.tags.clone(),
            };
            if tags.is_empty() {
                tally.add(Defect::TagZero, place);
                continue;
            }
            let sectors = self.with_tags(&tags);
            if sectors.is_empty() {
                tally.add(Defect::TagUnused, place);
            }
            for sector in sectors {
                self.apply(sector, &mover.acts, mover.repeats, Some(line));
            }
        }
    }

    /// A special of a thing happens when it dies or is taken: once for each such thing.
    fn read_things(&mut self) {
        if self.raw.specials != Specials::Action {
            return;
        }
        for thing in &self.raw.things {
            if let Meaning::Moves(mover) = specials::action(thing.special, thing.args, false)
                && let Target::Tag(tag) = mover.target
            {
                for sector in self.with_tags(&[tag]) {
                    self.apply(sector, &mover.acts, mover.repeats, None);
                }
            }
        }
    }

    /// What sectors do of themselves: doors that close after 30 seconds or open after 5 minutes,
    /// tags that wait for a boss's death, scripts, slopes.
    fn read_sectors(&mut self, tally: &mut Tally) {
        for (number, sector) in self.raw.sectors.iter().enumerate() {
            let place = Place::Sector(number as u32);
            let timer = match self.raw.specials {
                // Boom keeps its own flags above bit 4, ZDoom above bit 7.
                Specials::Doom => sector.special & 0x1F,
                Specials::Action => match sector.special & 0xFF {
                    74 => 10,
                    78 => 14,
                    _ => 0,
                },
            };
            match timer {
                10 => self.apply(number, &[Act::Ceiling(Goal::OwnFloor)], false, None),
                14 => {
                    let door = [Goal::LowestCeiling, Goal::OwnFloor].map(Act::Ceiling);
                    self.apply(number, &door, false, None);
                }
                _ => {}
            }
            if self.raw.specials == Specials::Doom {
                // Which of these a boss does depends on the map's name or on what a MAPINFO says,
                // so that all of them may happen.
                if sector.tags.contains(&BOSS_TAGS[0]) {
                    let acts = [
                        Act::Floor(Goal::LowestFloor),
                        Act::Ceiling(Goal::LowestCeiling),
                    ];
                    self.apply(number, &acts, false, None);
                }
                if sector.tags.contains(&BOSS_TAGS[1]) {
                    self.apply(number, &[Act::Floor(Goal::FarUp)], false, None);
                }
            }
            if self.raw.scripts && !sector.tags.is_empty() {
                tally.add(Defect::Scripted, place);
                self.apply(number, specials::ANYWHERE, false, None);
            }
            if sector.sloped || self.sloped.contains(&number) {
                tally.add(Defect::Sloped, place);
                self.apply(number, specials::ANYWHERE, false, None);
            }
        }
    }

    /// Lines that slope the sectors beside them: `Plane_Copy` and `Plane_Align`, the latter in
    /// Doom's numbers 340 to 347 as well.
    fn slope(&mut self, line: &RawLine) {
        let slopes = match self.raw.specials {
            Specials::Doom => matches!(line.special, 340..=347),
            Specials::Action => matches!(line.special, 118 | 181),
        };
        if slopes {
            let sides = [line.front, line.back];
            let sectors = sides.into_iter().filter_map(|s| self.raw.sector_at(s));
            self.sloped.extend(sectors);
        }
    }

    fn with_tags(&self, tags: &[i32]) -> BTreeSet<usize> {
        let sectors = tags.iter().filter_map(|tag| self.tagged.get(tag));
        sectors.flatten().copied().collect()
    }

    fn apply(&mut self, sector: usize, acts: &[Act], repeats: bool, line: Option<&RawLine>) {
        let front = line.and_then(|l| self.raw.sector_at(l.front));
        let resolve = |goal| match goal {
            // A floor to go to that is not there: nobody knows.
            Goal::FrontFloor => front.map_or(Goal::Nearby, |f| Goal::Above(f, 0.0)),
            goal => goal,
        };
        for &act in acts {
            match act {
                Act::Floor(goal) => self.floors[sector].goals.push(resolve(goal)),
                Act::Ceiling(goal) => self.ceilings[sector].goals.push(resolve(goal)),
                Act::FloorBy(by) => self.floors[sector].go_by(by, repeats),
                Act::CeilingBy(by) => self.ceilings[sector].go_by(by, repeats),
                Act::Elevator(goal) => {
                    self.floors[sector].goals.push(resolve(goal));
                    self.ceilings[sector].carried = true;
                }
                Act::Stairs { step, follow } => self.stairs.push(Flight {
                    first: sector,
                    step,
                    follow,
                    repeats,
                }),
                Act::Donut => {
                    // The ring is a neighbour of the middle, and what is around it of the ring.
                    self.floors[sector].goals.push(Goal::AnyFloor);
                    for &ring in &self.neighbours[sector] {
                        self.floors[ring].goals.push(Goal::AnyFloor);
                    }
                }
            }
        }
    }

    /// Lets every flight of stairs rise: the n-th step goes n steps above the first one's floor.
    fn build_stairs(&mut self) {
        for flight in std::mem::take(&mut self.stairs) {
            let steps = self.steps(&flight);
            let first = &self.floors[flight.first];
            let still = first.goals.is_empty() && first.down == 0.0 && first.up == 0.0;
            let start = self.raw.sectors[flight.first].floor;
            for (&sector, &[least, most]) in &steps {
                let goals = match (flight.repeats, flight.step > 0.0) {
                    (true, true) => [Goal::FarUp; 2],
                    (true, false) => [Goal::FarDown; 2],
                    (false, _) => [least, most].map(|n| {
                        let rise = f64::from(n) * flight.step;
                        if still {
                            Goal::At(start + rise)
                        } else {
                            Goal::Above(flight.first, rise)
                        }
                    }),
                };
                self.floors[sector].goals.extend(goals);
            }
        }
    }

    /// The sectors of a flight of stairs, each with the least and the greatest number of steps that
    /// it can rise by. Along a chain without branches these are the same. Where the chain branches,
    /// the way taken depends on what moves already, so a step may come as late as any; and the
    /// original game counts a step for each line it looks through in vain.
    fn steps(&self, flight: &Flight) -> BTreeMap<usize, [u32; 2]> {
        let mut steps = BTreeMap::from([(flight.first, [1, 1])]);
        let mut layer = vec![flight.first];
        let mut n_lines = 0u32;
        let mut branches = false;
        let next = self.next_steps(flight);
        let mut n = 1;
        while !layer.is_empty() {
            n += 1;
            let mut next_layer = Vec::new();
            for sector in layer {
                let onward = next.get(&sector).map_or(&[][..], Vec::as_slice);
                n_lines += onward.len() as u32;
                branches |= onward.len() > 1;
                for &sector in onward {
                    if let std::collections::btree_map::Entry::Vacant(entry) = steps.entry(sector) {
                        entry.insert([n, n]);
                        next_layer.push(sector);
                    }
                }
            }
            layer = next_layer;
        }
        if branches {
            for [_, most] in steps.values_mut() {
                *most = n_lines + 1;
            }
        }
        steps
    }

    /// For each sector the sectors that may be the step after it, once for each line between them.
    fn next_steps(&self, flight: &Flight) -> BTreeMap<usize, Vec<usize>> {
        let flat = &self.raw.sectors[flight.first].floor_flat;
        let mut next: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for line in self.raw.lines.iter().filter(|l| l.two_sided) {
            let (Some(front), Some(back)) = (
                self.raw.sector_at(line.front),
                self.raw.sector_at(line.back),
            ) else {
                continue;
            };
            let is_marked = |s: usize| matches!(self.raw.sectors[s].special & 0xFF, 26 | 27);
            let mut link = |from: usize, to: usize| next.entry(from).or_default().push(to);
            match flight.follow {
                _ if front == back => {}
                Follow::SameFlat if self.raw.sectors[back].floor_flat != *flat => {}
                Follow::SameFlat | Follow::AnyFlat => link(front, back),
                Follow::Marked => {
                    for (from, to) in [(front, back), (back, front)] {
                        if is_marked(to) {
                            link(from, to);
                        }
                    }
                }
            }
        }
        next
    }

    /// Grows all intervals from rest until every goal lies inside.
    fn grow(&self) -> Vec<Range> {
        let at_rest = |z: f64| [z, z];
        let mut floors: Vec<Interval> = self.raw.sectors.iter().map(|s| at_rest(s.floor)).collect();
        let mut ceilings: Vec<Interval> = self
            .raw
            .sectors
            .iter()
            .map(|s| at_rest(s.ceiling))
            .collect();
        let moving: Vec<usize> = (0..floors.len())
            .filter(|&s| self.floors[s].moves() || self.ceilings[s].moves())
            .collect();
        for round in 0.. {
            let mut changed = false;
            for &s in &moving {
                let floor = self.reach(
                    s,
                    &self.floors[s],
                    &floors,
                    &ceilings,
                    self.raw.sectors[s].floor,
                );
                let mut ceiling = self.reach(
                    s,
                    &self.ceilings[s],
                    &floors,
                    &ceilings,
                    self.raw.sectors[s].ceiling,
                );
                if self.ceilings[s].carried {
                    ceiling = self.carry(s, ceiling, floors[s]);
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
        let rows = self.raw.sectors.iter().zip(floors.iter().zip(&ceilings));
        rows.map(|(sector, (&floor, &ceiling))| Range {
            floor: height(sector.floor, floor),
            ceiling: height(sector.ceiling, ceiling),
        })
        .collect()
    }

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
    fn carry(&self, sector: usize, ceiling: Interval, floor: Interval) -> Interval {
        let motion = &self.ceilings[sector];
        if !motion.goals.is_empty() || motion.down > 0.0 || motion.up > 0.0 {
            return [-FAR, FAR];
        }
        let rest = &self.raw.sectors[sector];
        let gap = rest.ceiling - rest.floor;
        [
            ceiling[0].min((floor[0] + gap).max(-FAR)),
            ceiling[1].max((floor[1] + gap).min(FAR)),
        ]
    }
}

impl Motion {
    fn moves(&self) -> bool {
        !self.goals.is_empty() || self.down > 0.0 || self.up > 0.0 || self.carried
    }

    /// Goes up (down if negative) by a distance; if again and again, without end.
    fn go_by(&mut self, by: f64, repeats: bool) {
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
