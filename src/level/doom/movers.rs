//! Sectors that move: which specials, tags, timers and scripts move which floors and ceilings.
//!
//! In: a map's lists. Out: the range of every sector, bounds that neither floor nor ceiling ever
//! leaves, whatever is set off in whatever order. This file collects the motions; `stairs` follows
//! flights of stairs; `reach` turns the motions into ranges.

use std::collections::{BTreeMap, BTreeSet};

use super::defect::{Defect, Tally};
use super::raw::{RawLine, RawMap, Specials};
use super::reach::{self, Motion, Motions, Range};
use super::specials::{self, Act, Goal, Meaning, Target};
use super::stairs::{self, Flight};
use crate::level::Place;

/// Tags that a boss's death sets off.
const BOSS_TAGS: [i32; 2] = [666, 667];

/// A map and what is known so far of its motions.
struct Movers<'a> {
    raw: &'a RawMap,
    /// Sectors by tag.
    tagged: BTreeMap<i32, Vec<usize>>,
    motions: Motions,
    stairs: Vec<Flight>,
    /// Sectors with a slope.
    sloped: BTreeSet<usize>,
}

/// The range of every sector, by number.
pub fn ranges(raw: &RawMap, tally: &mut Tally) -> Vec<Range> {
    let mut movers = Movers::new(raw);
    movers.read_lines(tally);
    movers.read_things();
    movers.read_sectors(tally);
    stairs::build(raw, &movers.stairs, &mut movers.motions.floors);
    reach::grow(raw, &movers.motions)
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
            tagged,
            motions: Motions {
                neighbours,
                floors: vec![Motion::default(); n],
                ceilings: vec![Motion::default(); n],
            },
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
            if sector.sloped {
                self.apply(number, specials::ANYWHERE, false, None);
            }
            if sector.sloped || self.sloped.contains(&number) {
                tally.add(Defect::Sloped, place);
            }
        }
    }

    /// Lines that slope the sectors beside them: `Plane_Align` (in Doom's numbers 340 to 347 too),
    /// whose plane runs from the neighbour's height at the line to the sector's own at its far end,
    /// and `Plane_Copy`, whose plane may be any.
    fn slope(&mut self, line: &RawLine) {
        const ALIGNED: &[Act] = &[Act::Floor(Goal::AnyFloor), Act::Ceiling(Goal::Nearby)];
        let acts = match (self.raw.specials, line.special) {
            (Specials::Doom, 340..=347) | (Specials::Action, 181) => ALIGNED,
            (Specials::Action, 118) => specials::ANYWHERE,
            _ => return,
        };
        for side in [line.front, line.back] {
            if let Some(sector) = self.raw.sector_at(side) {
                self.sloped.insert(sector);
                self.apply(sector, acts, false, None);
            }
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
                Act::Floor(goal) => self.motions.floors[sector].go_to(resolve(goal)),
                Act::Ceiling(goal) => self.motions.ceilings[sector].go_to(resolve(goal)),
                Act::FloorBy(by) => self.motions.floors[sector].go_by(by, repeats),
                Act::CeilingBy(by) => self.motions.ceilings[sector].go_by(by, repeats),
                Act::Elevator(goal) => {
                    self.motions.floors[sector].go_to(resolve(goal));
                    self.motions.ceilings[sector].carried = true;
                }
                Act::Stairs { step, follow } => self.stairs.push(Flight {
                    first: sector,
                    step,
                    follow,
                    repeats,
                }),
                Act::Donut => {
                    // The ring is a neighbour of the middle, and what is around it of the ring.
                    self.motions.floors[sector].go_to(Goal::AnyFloor);
                    for &ring in &self.motions.neighbours[sector] {
                        self.motions.floors[ring].go_to(Goal::AnyFloor);
                    }
                }
            }
        }
    }
}
