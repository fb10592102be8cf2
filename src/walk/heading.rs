//! Where a walker looks who looks the way that he goes: ahead, and never turning too fast.
//!
//! In: directions at equal steps of time. Out: as many unit vectors, whose angle to the one before is
//! bounded. A direction is an angle about the vertical, unwound, and a slope. Each is averaged over a
//! window that reaches ahead, so that a bend is looked into before it comes. Then the bound: of all
//! functions that change no faster, the largest below and the smallest above are taken (E. J.
//! McShane, "Extension of range of functions", 1934), and the middle of the two. That turns as fast as
//! allowed, and begins as much before a corner as it ends after it.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// Shares of the bound that turning and nodding may use up: together, as the sides of a right
/// angle, not more than the whole.
const SHARES: [f64; 2] = [0.9, 0.43];

/// How to look.
pub(super) struct Manner {
    /// Largest angle between neighbours, in radians.
    pub turn: f64,
    /// Number of steps to average over.
    pub window: usize,
    /// Share of a slope that the eye follows: 0 looks level, 1 along the way.
    pub nod: f64,
}

/// The directions looked at. `closed`: the last one is the first again.
pub(super) fn ahead(ways: &[DVec3], closed: bool, manner: &Manner) -> Vec<DVec3> {
    let n = ways.len();
    let (mut angles, mut slopes) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let level = ways
        .iter()
        .find(|w| w.truncate().length_squared() > 0.0)
        .map_or(0.0, |w| w.y.atan2(w.x));
    let mut angle: f64 = level;
    for way in ways {
        let flat = way.truncate().length();
        if flat > 0.0 {
            angle += (way.y.atan2(way.x) - angle + PI).rem_euclid(TAU) - PI;
        }
        angles.push(angle);
        slopes.push(manner.nod * way.z.atan2(flat));
    }
    // Whoever comes back to the start of a closed path has turned a whole number of times.
    let winding = match (closed, angles.first(), angles.last()) {
        (true, Some(first), Some(last)) => {
            let left = (first - last + PI).rem_euclid(TAU) - PI;
            last + left - first
        }
        _ => 0.0,
    };
    let [turn, nod] = SHARES.map(|share| manner.turn * share);
    let angles = calm(&angles, closed.then_some(winding), turn, manner.window);
    let slopes = calm(&slopes, closed.then_some(0.0), nod, manner.window);
    let direction = |(angle, slope): (&f64, &f64)| {
        let (sin, cos) = angle.sin_cos();
        DVec3::new(cos * slope.cos(), sin * slope.cos(), slope.sin())
    };
    angles.iter().zip(&slopes).map(direction).collect()
}

/// Averaged and bounded. `period`: what a closed path adds from its first value to its last, which
/// stand for the same place.
fn calm(values: &[f64], period: Option<f64>, bound: f64, window: usize) -> Vec<f64> {
    let n = values.len();
    if n < 2 {
        return values.to_vec();
    }
    // Both ends go on: as they are, or a closed path with its other end.
    let round = n - 1;
    let long: Vec<f64> = match period {
        None => values.to_vec(),
        Some(period) => (0..3)
            .flat_map(|lap| {
                let shift = f64::from(lap) * period;
                values[..round].iter().map(move |v| v + shift)
            })
            .chain([values[round] + 2.0 * period])
            .collect(),
    };
    let m = long.len();
    let (behind, before) = (window / 4, window - window / 4);
    let mut sums = vec![0.0];
    for value in &long {
        sums.push(sums[sums.len() - 1] + value);
    }
    let mut mean: Vec<f64> = (0..m)
        .map(|i| {
            let (from, to) = (i.saturating_sub(behind), (i + before + 1).min(m));
            let missing = [behind - (i - from), i + before + 1 - to].map(|k| k as f64);
            let sum = sums[to] - sums[from] + missing[0] * long[0] + missing[1] * long[m - 1];
            sum / (window + 1) as f64
        })
        .collect();
    let (mut below, mut above) = (mean.clone(), mean.clone());
    for i in 1..m {
        below[i] = below[i].min(below[i - 1] + bound);
        above[i] = above[i].max(above[i - 1] - bound);
    }
    for i in (0..m - 1).rev() {
        below[i] = below[i].min(below[i + 1] + bound);
        above[i] = above[i].max(above[i + 1] - bound);
    }
    for (i, value) in mean.iter_mut().enumerate() {
        *value = (below[i] + above[i]) / 2.0;
    }
    match period {
        None => mean,
        Some(period) => {
            let lap = mean[round..round + n].iter();
            lap.map(|v| v - period).collect()
        }
    }
}
