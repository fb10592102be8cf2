//! Flights of stairs: which sectors a special that builds stairs raises, and how far.
//!
//! In: where flights begin. Out: goals for the floors of their steps.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::raw::RawMap;
use super::reach::Motion;
use super::specials::{Follow, Goal};

/// Stairs that begin in a sector.
#[derive(Clone, Debug)]
pub struct Flight {
    /// Sector of the first step.
    pub first: usize,
    /// Height of a step; negative for stairs that go down.
    pub step: f64,
    /// How to find the next one.
    pub follow: Follow,
    /// Whether it can be set off again and again.
    pub repeats: bool,
}

/// Lets every flight of stairs rise: the n-th step goes n steps above the first one's floor.
pub fn build(raw: &RawMap, flights: &[Flight], floors: &mut [Motion]) {
    if flights.is_empty() {
        return;
    }
    let ways = Ways::new(raw);
    let steps: Vec<_> = flights.iter().map(|f| steps(raw, &ways, f)).collect();
    // What moves each first step besides flights that begin there: with nothing, all heights are
    // known; otherwise they hang on where the first step stands by then.
    let still = |flight: &Flight| {
        let others = flights.iter().zip(&steps);
        !floors[flight.first].moves()
            && others
                .filter(|(other, _)| other.first != flight.first)
                .all(|(_, steps)| !steps.contains_key(&flight.first))
    };
    let still: Vec<bool> = flights.iter().map(still).collect();
    for ((flight, steps), still) in flights.iter().zip(&steps).zip(still) {
        // Flights that begin in one place, each set off once, rise from where the last one ended.
        let rises = flights.iter().filter(|f| f.first == flight.first);
        let (ups, downs): (Vec<f64>, Vec<f64>) = rises.map(|f| f.step).partition(|&s| s > 0.0);
        let before = [
            downs.iter().sum::<f64>() - flight.step.min(0.0),
            ups.iter().sum::<f64>() - flight.step.max(0.0),
        ];
        let start = raw.sectors[flight.first].floor;
        for (&sector, &[least, most]) in steps {
            let goals = match (flight.repeats, flight.step > 0.0) {
                (true, true) => vec![Goal::FarUp],
                (true, false) => vec![Goal::FarDown],
                (false, _) => [(least, 0), (most, 0), (least, 1), (most, 1)]
                    .map(|(n, way)| {
                        let rise = f64::from(n) * flight.step + before[way];
                        if still {
                            Goal::At(start + rise)
                        } else {
                            Goal::Above(flight.first, rise)
                        }
                    })
                    .to_vec(),
            };
            for goal in goals {
                floors[sector].go_to(goal);
            }
        }
    }
}

/// The sectors of a flight of stairs, each with the least and the greatest number of steps that
/// it can rise by. Along a chain without branches these are the same. Where the chain branches,
/// the way taken depends on what moves already, so a step may come as late as any; and the
/// original game counts a step for each line it looks through in vain.
fn steps(raw: &RawMap, ways: &Ways, flight: &Flight) -> BTreeMap<usize, [u32; 2]> {
    let first = &raw.sectors[flight.first];
    let belongs = |sector: usize| {
        let sector = &raw.sectors[sector];
        match flight.follow {
            Follow::SameFlat => sector.floor_flat == first.floor_flat,
            Follow::AnyFlat => true,
            Follow::Marked => matches!(sector.special & 0xFF, 26 | 27),
        }
    };
    let mut steps = BTreeMap::from([(flight.first, [1, 1])]);
    let mut layer = vec![flight.first];
    let mut n_lines = 0u32;
    let mut branches = false;
    let mut n = 1;
    while !layer.is_empty() {
        n += 1;
        let mut next_layer = Vec::new();
        for sector in layer {
            let mut onward: Vec<usize> = ways.onward[sector].clone();
            if flight.follow == Follow::Marked {
                onward.extend(&ways.back[sector]);
            }
            onward.retain(|&s| belongs(s));
            if flight.follow == Follow::Marked {
                // These stairs do not count the way they came, nor a step twice.
                onward.retain(|s| !steps.contains_key(s));
                onward.sort_unstable();
                onward.dedup();
            }
            n_lines += onward.len() as u32;
            branches |= onward.len() > 1;
            for sector in onward {
                if let Entry::Vacant(entry) = steps.entry(sector) {
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

/// Ways between sectors, by sector, one for each two-sided line.
struct Ways {
    /// From a line's front to its back.
    onward: Vec<Vec<usize>>,
    /// From a line's back to its front.
    back: Vec<Vec<usize>>,
}

impl Ways {
    fn new(raw: &RawMap) -> Self {
        let none = vec![Vec::new(); raw.sectors.len()];
        let mut ways = Ways {
            onward: none.clone(),
            back: none,
        };
        for line in raw.lines.iter().filter(|l| l.two_sided) {
            let sides = (raw.sector_at(line.front), raw.sector_at(line.back));
            if let (Some(front), Some(back)) = sides
                && front != back
            {
                ways.onward[front].push(back);
                ways.back[back].push(front);
            }
        }
        ways
    }
}
