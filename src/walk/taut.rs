//! From places on the way to a line that a person would walk: taut, with rounded corners.
//!
//! In: places of a net, each a move from the one before. Out: a line on the plan. Shortcuts are taken
//! where they keep as clear of obstacles as the places that they leave out, but no clearer than two
//! radii. A corner is replaced by a parabola that touches both of its sides, as wide as keeps [`ROUND`]
//! of the radius clear; the last one tried cuts so little off the corner that it always does.

use glam::DVec2;

use super::net::{Clearance, Net};

/// Share of the clearance of the places left out that a shortcut keeps.
const SHORTCUT: f64 = 0.97;
/// Shortcuts keep no clearer than so many radii.
const ROOMY: f64 = 2.0;
/// Share of the radius that a rounded corner keeps clear.
const ROUND: f64 = 0.7;
/// How far a parabola may pass by its corner, in radii; tried in this order.
const CUTS: [f64; 5] = [3.0, 1.5, 0.8, 0.4, 0.15];
/// How far it may pass by a stop.
const STOP: f64 = 0.8;
/// Length of the parts of a line, in radii.
const PART: f64 = 0.25;

/// A corner of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub at: DVec2,
    /// How far the rounded line may pass by it, in radii.
    pub cut: f64,
}

impl Corner {
    /// A place at which to stop; `exact`: the line passes through it.
    pub fn stop(at: DVec2, exact: bool) -> Self {
        let cut = if exact { 0.0 } else { STOP };
        Corner { at, cut }
    }
}

/// The corners of the taut line between the first and the last place, without these two.
pub(super) fn pull(net: &Net, clearance: &Clearance, way: &[u32], radius: f64) -> Vec<Corner> {
    let mut line = Vec::new();
    let mut at = 0;
    while at + 1 < way.len() {
        let next = if net.jumps(way[at], way[at + 1]) {
            at + 1
        } else {
            farthest(net, clearance, way, at, radius)
        };
        line.push(Corner {
            at: net.place(way[next]).at,
            cut: CUTS[0],
        });
        at = next;
    }
    line.pop();
    line
}

/// The last place that can be walked to straight from the one at `at`: doubling, then halving.
fn farthest(net: &Net, clearance: &Clearance, way: &[u32], at: usize, radius: f64) -> usize {
    let last = (at + 1..way.len())
        .find(|&i| net.jumps(way[i - 1], way[i]))
        .unwrap_or(way.len())
        - 1;
    let straight = |to: usize| {
        if to == at + 1 {
            return true;
        }
        let places = way[at..=to].iter().map(|&p| net.place(p));
        let least = places.map(|p| p.clear).fold(ROOMY * radius, f64::min);
        let ends = [way[at], way[to]].map(|p| net.place(p).at);
        clearance.all.clear(ends, least * SHORTCUT)
    };
    let (mut good, mut step) = (at + 1, 2);
    while good < last && straight((at + step).min(last)) {
        good = (at + step).min(last);
        step *= 2;
    }
    let mut bad = (at + step).min(last + 1);
    while bad - good > 1 {
        let middle = (good + bad) / 2;
        if straight(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    good
}

/// The line with rounded corners, in short parts.
pub(super) fn round(clearance: &Clearance, corners: &[Corner], radius: f64) -> Vec<DVec2> {
    let mut corners = corners.to_vec();
    corners.dedup_by_key(|c| c.at);
    let mut line: Vec<DVec2> = corners.first().map(|c| c.at).into_iter().collect();
    for i in 1..corners.len() {
        let Corner { at: b, cut } = corners[i];
        let Some(&Corner { at: c, .. }) = corners.get(i + 1) else {
            advance(&mut line, b, radius);
            break;
        };
        let a = corners[i - 1].at;
        let (into, out) = ((b - a).normalize(), (c - b).normalize());
        let half = (out - into).length() / 2.0;
        if half == 0.0 || cut == 0.0 {
            advance(&mut line, b, radius);
            continue;
        }
        // Half of each side, so that neighbouring corners do not meet; less at half a turn, which
        // nobody sees.
        let most = a.distance(b).min(b.distance(c)) / 2.0;
        let arc = |cut: f64| {
            let trim = most.min(2.0 * cut * radius / half);
            let parts = (2.0 * trim / (PART * radius)).ceil().max(4.0) as u32;
            let (from, to) = (b - into * trim, b + out * trim);
            let on = move |k: u32| {
                let u = f64::from(k) / f64::from(parts);
                from.lerp(b, u).lerp(b.lerp(to, u), u)
            };
            (0..=parts).map(on).collect::<Vec<_>>()
        };
        let clear = |arc: &Vec<DVec2>| {
            let mut parts = arc.windows(2);
            parts.all(|p| clearance.all.clear([p[0], p[1]], ROUND * radius))
        };
        let (smallest, larger) = (CUTS[CUTS.len() - 1], &CUTS[..CUTS.len() - 1]);
        let allowed = larger.iter().filter(|c| **c <= cut);
        let found = allowed.map(|&cut| arc(cut)).find(clear);
        let arc = found.unwrap_or_else(|| arc(smallest));
        advance(&mut line, arc[0], radius);
        line.extend(&arc[1..]);
    }
    line.dedup();
    line
}

/// Goes on straight to a point.
fn advance(line: &mut Vec<DVec2>, to: DVec2, radius: f64) {
    let from = line[line.len() - 1];
    let parts = (from.distance(to) / (PART * radius)).ceil().max(1.0) as u32;
    line.extend((1..parts).map(|k| from.lerp(to, f64::from(k) / f64::from(parts))));
    line.push(to);
}
