//! Where a tour stops, and in which order.
//!
//! In: the net and, for every sector, the place in it that is its middle. Out: stops, such that the
//! shortest ways between them see every sector of a part.

use rayon::prelude::*;

use super::net::Net;
use super::search::ways;

/// Most stops of which the order is improved: it takes a search from each.
const MOST: usize = 300;
/// Most times that all exchanges are tried.
const SWEEPS: u32 = 12;
/// What is not shorter than this share is no improvement: sums in another order round otherwise.
const SAME: f64 = 1.0 - 1e-9;
/// Share of a sector's largest clearance from which on a place is its midst.
const MIDST: f64 = 0.9;
/// Share of the clearance of a sector's middle with which passing by is seeing it.
const SEEN: f64 = 0.5;

/// A part of the net within which one comes back from everywhere.
pub(super) struct Part<'a> {
    pub net: &'a Net,
    pub part: &'a [u32],
    pub number: u32,
}

impl Part<'_> {
    fn holds(&self, place: u32) -> bool {
        self.part[place as usize] == self.number
    }
}

/// For each sector the place to go to, in the first part of the chain that has one: of the places far
/// from walls the one nearest to the middle of them all.
pub(super) fn goals(
    net: &Net,
    part: &[u32],
    chain: &[u32],
    sectors: &[usize],
    n_sectors: usize,
) -> Vec<Option<u32>> {
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); n_sectors];
    let turn = |place: u32| chain.iter().position(|&c| c == part[place as usize]);
    for place in (0..net.places.len() as u32).filter(|&p| turn(p).is_some()) {
        lists[sectors[place as usize]].push(place);
    }
    let goal = |list: Vec<u32>| {
        let first = list.iter().filter_map(|&p| turn(p)).min()?;
        let own = || list.iter().copied().filter(|&p| turn(p) == Some(first));
        let n = own().count() as f64;
        let middle = own().map(|p| net.place(p).at).sum::<glam::DVec2>() / n;
        let clear = own().map(|p| net.place(p).clear).fold(0.0, f64::max);
        let off = |p: &u32| net.place(*p).at.distance_squared(middle);
        own()
            .filter(|&p| net.place(p).clear >= clear * MIDST)
            .min_by(|p, q| off(p).total_cmp(&off(q)))
    };
    lists.into_iter().map(goal).collect()
}

/// Adds stops, from the last one on, that see every sector of the part.
pub(super) fn visit(here: &Part, goals: &[Option<u32>], sectors: &[usize], stops: &mut Vec<u32>) {
    let mut waiting: Vec<bool> = goals
        .iter()
        .map(|g| g.is_some_and(|g| here.holds(g)))
        .collect();
    let mut goal_of = vec![false; here.net.places.len()];
    for goal in goals.iter().flatten().filter(|g| here.holds(**g)) {
        goal_of[*goal as usize] = true;
    }
    let first = stops.len() - 1;
    let mut at = stops[first];
    loop {
        let wanted = |p: u32| goal_of[p as usize] && waiting[sectors[p as usize]];
        let search = ways(here.net, at, |p| here.holds(p), wanted);
        if search.end == super::search::NONE {
            break;
        }
        for place in search.to(search.end) {
            let sector = sectors[place as usize];
            if let Some(goal) = goals[sector] {
                let clear = here.net.place(place).clear;
                if place == goal || clear >= here.net.place(goal).clear * SEEN {
                    waiting[sector] = false;
                }
            }
        }
        at = search.end;
        stops.push(at);
    }
    if stops.len() - first <= MOST {
        improve(here, &mut stops[first..]);
    }
}

/// Improves the order of the stops; the first one stays.
fn improve(here: &Part, stops: &mut [u32]) {
    let n = stops.len();
    if n < 3 {
        return;
    }
    let rows: Vec<Vec<f64>> = stops
        .par_iter()
        .map(|&from| {
            let search = ways(here.net, from, |p| here.holds(p), |_| false);
            stops.iter().map(|&to| search.cost[to as usize]).collect()
        })
        .collect();
    let row = |i: usize, j: usize| rows[i][j];
    let mut order: Vec<usize> = (0..n).collect();
    for _ in 0..SWEEPS {
        let mut better = false;
        // Length of the way up to each stop, and of the same way walked back.
        let (mut there, mut back) = lengths(&order, &row);
        for i in 1..n {
            for j in i + 1..n {
                // Turn round what lies between.
                let (a, b, c) = (order[i - 1], order[i], order[j]);
                let after = |from: usize| order.get(j + 1).map_or(0.0, |&d| row(from, d));
                let old = row(a, b) + (there[j] - there[i]) + after(c);
                let new = row(a, c) + (back[j] - back[i]) + after(b);
                if new < old * SAME {
                    order[i..=j].reverse();
                    (there, back) = lengths(&order, &row);
                    better = true;
                }
            }
        }
        for i in 1..n {
            // Move one stop to where it costs least.
            let stop = order.remove(i);
            let into = |j: usize| {
                let before = row(order[j - 1], stop);
                match order.get(j) {
                    Some(&next) => before + row(stop, next) - row(order[j - 1], next),
                    None => before,
                }
            };
            let best = (1..n).min_by(|&j, &k| into(j).total_cmp(&into(k)));
            let best = best.filter(|&j| into(j) < into(i) * SAME).unwrap_or(i);
            better |= best != i;
            order.insert(best, stop);
        }
        if !better {
            break;
        }
    }
    let old = stops.to_vec();
    for (stop, &i) in stops.iter_mut().zip(&order) {
        *stop = old[i];
    }
}

/// Length of a way up to each of its stops, and of the way back from there.
fn lengths(order: &[usize], row: &impl Fn(usize, usize) -> f64) -> (Vec<f64>, Vec<f64>) {
    let (mut there, mut back) = (vec![0.0], vec![0.0]);
    for (i, pair) in order.windows(2).enumerate() {
        there.push(there[i] + row(pair[0], pair[1]));
        back.push(back[i] + row(pair[1], pair[0]));
    }
    (there, back)
}

/// Puts in stops for goals that the finished way misses: on the leg that passes through the sector, at
/// the place there that is farthest from walls; else after the stop from which it is nearest. The
/// stops that the way must pass through exactly.
pub(super) fn insert(
    net: &Net,
    allowed: impl Fn(u32) -> bool,
    stops: &mut Vec<u32>,
    legs: &[Vec<u32>],
    sectors: &[usize],
    missing: Vec<u32>,
) -> Vec<u32> {
    // By leg, the stops to add and how far along it they come.
    let mut new = Vec::new();
    let mut added: Vec<Vec<(usize, u32)>> = vec![Vec::new(); legs.len().max(1)];
    for goal in missing {
        let sector = sectors[goal as usize];
        // A stop that was cut off by rounding needs no second one, but to be passed exactly.
        if stops.contains(&goal) {
            new.push(goal);
            continue;
        }
        let passes = legs.iter().enumerate().find_map(|(leg, places)| {
            let own = places.iter().enumerate();
            let own = own.filter(|(_, p)| sectors[**p as usize] == sector);
            own.max_by(|(_, p), (_, q)| net.place(**p).clear.total_cmp(&net.place(**q).clear))
                .map(|(i, &p)| (leg, i, p))
        });
        let known = passes.filter(|(_, _, p)| !stops.contains(p));
        let (leg, along, place) = known.unwrap_or_else(|| {
            let search = ways(net, goal, &allowed, |_| false);
            let cost = |i: &usize| search.cost[stops[*i] as usize];
            let legs = 0..legs.len().max(1);
            let near = legs.min_by(|i, j| cost(i).total_cmp(&cost(j)));
            (near.unwrap_or(0), 0, goal)
        });
        added[leg].push((along, place));
        new.push(place);
    }
    let mut result = vec![stops[0]];
    for (leg, mut list) in added.into_iter().enumerate() {
        list.sort_unstable();
        result.extend(list.into_iter().map(|(_, p)| p));
        result.extend(stops.get(leg + 1));
    }
    *stops = result;
    new
}
