//! Shortest ways over the net, and which parts of it one comes back from.
//!
//! E. W. Dijkstra, "A note on two problems in connexion with graphs", 1959; S. R. Kosaraju's two
//! passes (M. Sharir 1981) for the strongly connected parts.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::net::Net;

/// Stands for no place.
pub(super) const NONE: u32 = u32::MAX;

/// Shortest ways from one place.
pub(super) struct Ways {
    /// By place; infinite where it was not reached.
    pub cost: Vec<f64>,
    before: Vec<u32>,
    /// The place at which the search stopped, or [`NONE`].
    pub end: u32,
}

struct Open {
    cost: f64,
    place: u32,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        (other.cost.total_cmp(&self.cost)).then(other.place.cmp(&self.place))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

/// Ways from a place over places that are allowed, until `stop` holds of the nearest one left.
pub(super) fn ways(
    net: &Net,
    from: u32,
    allowed: impl Fn(u32) -> bool,
    stop: impl Fn(u32) -> bool,
) -> Ways {
    let n = net.places.len();
    let mut ways = Ways {
        cost: vec![f64::INFINITY; n],
        before: vec![NONE; n],
        end: NONE,
    };
    let mut open = BinaryHeap::new();
    ways.cost[from as usize] = 0.0;
    open.push(Open {
        cost: 0.0,
        place: from,
    });
    while let Some(Open { cost, place }) = open.pop() {
        if cost > ways.cost[place as usize] {
            continue;
        }
        if stop(place) {
            ways.end = place;
            break;
        }
        for step in net.moves(place) {
            let total = cost + step.cost;
            if total < ways.cost[step.to as usize] && allowed(step.to) {
                ways.cost[step.to as usize] = total;
                ways.before[step.to as usize] = place;
                open.push(Open {
                    cost: total,
                    place: step.to,
                });
            }
        }
    }
    ways
}

impl Ways {
    /// The places on the way to one that was reached, both ends included.
    pub fn to(&self, end: u32) -> Vec<u32> {
        let mut list = vec![end];
        let mut at = end;
        while self.before[at as usize] != NONE {
            at = self.before[at as usize];
            list.push(at);
        }
        list.reverse();
        list
    }
}

/// The parts within which every place can be reached from every other, among the places that can be
/// reached from `start`: by place the part's number, [`NONE`] for what cannot be reached. A move never
/// leads to a part of smaller number; the first is that of `start`.
pub(super) fn parts(net: &Net, start: u32) -> (Vec<u32>, u32) {
    let n = net.places.len();
    // First pass: places in the order in which they are done with, depth first.
    let mut seen = vec![false; n];
    let mut done = Vec::new();
    let mut stack = vec![(start, 0)];
    seen[start as usize] = true;
    while let Some((place, next)) = stack.last_mut() {
        match net.moves(*place).get(*next) {
            Some(step) => {
                *next += 1;
                let to = step.to;
                if !seen[to as usize] {
                    seen[to as usize] = true;
                    stack.push((to, 0));
                }
            }
            None => {
                done.push(*place);
                stack.pop();
            }
        }
    }
    let mut back: Vec<Vec<u32>> = vec![Vec::new(); n];
    for &from in &done {
        for step in net.moves(from) {
            back[step.to as usize].push(from);
        }
    }
    let mut part = vec![NONE; n];
    let mut count = 0;
    for &first in done.iter().rev() {
        if part[first as usize] != NONE {
            continue;
        }
        let mut stack = vec![first];
        part[first as usize] = count;
        while let Some(place) = stack.pop() {
            for &from in &back[place as usize] {
                if part[from as usize] == NONE {
                    part[from as usize] = count;
                    stack.push(from);
                }
            }
        }
        count += 1;
    }
    (part, count)
}
