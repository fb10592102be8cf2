//! Curves as straight pieces that lie at most a tolerance off.
//!
//! In: arcs, ellipses, B-splines; a tolerance. Out: points on the curve, the ends included. Bézier
//! curves are cut by kurbo, where paths are read.

use std::f64::consts::TAU;

use glam::DVec2;

/// Most pieces of one curve.
pub const MOST_PIECES: usize = 4096;

/// An arc of an ellipse: `center + major · cos t + minor · sin t`, `t` from `start` on through
/// `sweep` (negative: clockwise).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Middle.
    pub center: DVec2,
    /// Half of the one axis.
    pub major: DVec2,
    /// Half of the other.
    pub minor: DVec2,
    /// Where it starts, in radians.
    pub start: f64,
    /// How far it goes, in radians; at most a full turn either way.
    pub sweep: f64,
}

impl Arc {
    /// An arc of a circle, counterclockwise between two angles in radians; a full turn where they
    /// are the same.
    pub fn of_circle(center: DVec2, radius: f64, start: f64, end: f64) -> Arc {
        let sweep = (end - start).rem_euclid(TAU);
        Arc {
            center,
            major: DVec2::X * radius,
            minor: DVec2::Y * radius,
            start,
            sweep: if sweep == 0.0 { TAU } else { sweep },
        }
    }

    /// The arc between two points with a bulge: the tangent of a quarter of its angle, above 0 where
    /// it goes counterclockwise. `None` where the two are one or the bulge is none.
    pub fn of_bulge(from: DVec2, to: DVec2, bulge: f64) -> Option<Arc> {
        let chord = to - from;
        if bulge == 0.0 || chord == DVec2::ZERO || !bulge.is_finite() {
            return None;
        }
        let center = from.midpoint(to) + chord.perp() * ((1.0 / bulge - bulge) / 4.0);
        let out = from - center;
        Some(Arc {
            center,
            major: out,
            minor: out.perp(),
            start: 0.0,
            sweep: 4.0 * bulge.atan(),
        })
    }

    /// The point at a share of the way.
    pub fn at(&self, share: f64) -> DVec2 {
        let (sin, cos) = (self.start + self.sweep * share).sin_cos();
        self.center + self.major * cos + self.minor * sin
    }

    /// Points on the arc, from its start to its end; a piece's middle is at most `tolerance` off.
    pub fn points(&self, tolerance: f64) -> Vec<DVec2> {
        let radius = self.major.length().max(self.minor.length());
        let n = pieces(radius, self.sweep.abs(), tolerance);
        (0..=n).map(|i| self.at(i as f64 / n as f64)).collect()
    }
}

/// How many pieces an arc takes: a chord of angle φ lies r (1 - cos φ/2) off.
fn pieces(radius: f64, sweep: f64, tolerance: f64) -> usize {
    let off = (tolerance / radius).min(1.0);
    let angle = 2.0 * (1.0 - off).acos();
    let n = (sweep / angle).ceil();
    let least = (sweep / (TAU / 8.0)).ceil().max(1.0);
    if n.is_finite() {
        (n.max(least) as usize).min(MOST_PIECES)
    } else {
        MOST_PIECES
    }
}

/// A (rational) B-spline.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spline {
    /// Degree, from 1.
    pub degree: usize,
    /// Knots: as many as control points, and the degree and one more.
    pub knots: Vec<f64>,
    /// Control points.
    pub control: Vec<DVec2>,
    /// Their weights; empty: all 1.
    pub weights: Vec<f64>,
}

impl Spline {
    /// Whether the numbers fit together, so that it is a curve.
    pub fn is_sound(&self) -> bool {
        let n = self.control.len();
        (1..=25).contains(&self.degree)
            && n > self.degree
            && self.knots.len() == n + self.degree + 1
            && self.knots.windows(2).all(|k| k[0] <= k[1])
            && self.knots.iter().all(|k| k.is_finite())
            && self.knots[self.degree] < self.knots[n]
            && (self.weights.is_empty()
                || (self.weights.len() == n
                    && self.weights.iter().all(|w| *w > 0.0 && w.is_finite())))
    }

    /// The point at a parameter, by de Boor's algorithm.
    fn at(&self, t: f64) -> DVec2 {
        let (p, n) = (self.degree, self.control.len());
        let span = self.knots[p + 1..n].partition_point(|&k| k <= t) + p;
        let weight = |i: usize| self.weights.get(i).copied().unwrap_or(1.0);
        let mut d: Vec<(DVec2, f64)> = (0..=p)
            .map(|j| {
                let i = j + span - p;
                (self.control[i] * weight(i), weight(i))
            })
            .collect();
        for r in 1..=p {
            for j in (r..=p).rev() {
                let (low, high) = (self.knots[j + span - p], self.knots[j + 1 + span - r]);
                let a = if high > low {
                    (t - low) / (high - low)
                } else {
                    0.0
                };
                d[j] = (
                    d[j - 1].0.lerp(d[j].0, a),
                    d[j - 1].1 * (1.0 - a) + d[j].1 * a,
                );
            }
        }
        d[p].0 / d[p].1
    }

    /// Points on the curve, from its start to its end. Each stretch between knots is halved until
    /// the quarters of its pieces lie within the tolerance of their chords.
    pub fn points(&self, tolerance: f64) -> Vec<DVec2> {
        let (p, n) = (self.degree, self.control.len());
        let mut stops: Vec<f64> = self.knots[p..=n].to_vec();
        stops.dedup();
        let most = (MOST_PIECES / stops.len().max(1)).max(2);
        let mut points = vec![self.at(stops[0])];
        for pair in stops.windows(2) {
            let mut pieces = 2;
            loop {
                let at = |i: f64| self.at(pair[0] + (pair[1] - pair[0]) * i / pieces as f64);
                let off = |i: usize| {
                    let (a, b) = (at(i as f64), at(i as f64 + 1.0));
                    [0.25, 0.5, 0.75]
                        .map(|q| distance_to_chord(a, b, at(i as f64 + q)))
                        .into_iter()
                        .fold(0.0, f64::max)
                };
                if pieces * 2 > most || (0..pieces).all(|i| off(i) <= tolerance) {
                    points.extend((1..=pieces).map(|i| at(i as f64)));
                    break;
                }
                pieces *= 2;
            }
        }
        points
    }
}

fn distance_to_chord(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let d = b - a;
    let share = ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0);
    if share.is_nan() {
        p.distance(a)
    } else {
        p.distance(a + d * share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_keep_to_the_tolerance() {
        for (radius, tolerance) in [(1.0, 0.01), (250.0, 1.0), (1e6, 0.5), (0.001, 1.0)] {
            let arc = Arc::of_circle(DVec2::new(3.0, -2.0), radius, 0.3, 0.3);
            let points = arc.points(tolerance);
            assert!(points.len() >= 9);
            for pair in points.windows(2) {
                let off = radius - pair[0].midpoint(pair[1]).distance(arc.center);
                assert!(
                    off <= tolerance.max(radius * 0.08),
                    "{radius} {tolerance}: {off}"
                );
            }
        }
        assert!(Arc::of_circle(DVec2::ZERO, 1.0, 0.0, 1.0).points(0.0).len() <= MOST_PIECES + 1);
    }

    #[test]
    fn bulges() {
        // A half circle to the right of the way up: counterclockwise from south to north.
        let arc = Arc::of_bulge(DVec2::ZERO, DVec2::new(0.0, 2.0), 1.0).unwrap();
        assert!(arc.at(0.5).distance(DVec2::new(1.0, 1.0)) < 1e-12);
        assert!(arc.at(1.0).distance(DVec2::new(0.0, 2.0)) < 1e-12);
        let quarter = (std::f64::consts::FRAC_PI_8).tan();
        let arc = Arc::of_bulge(DVec2::X, DVec2::Y, quarter).unwrap();
        assert!(arc.center.length() < 1e-12);
        assert!(Arc::of_bulge(DVec2::X, DVec2::X, 1.0).is_none());
    }

    #[test]
    fn a_rational_spline_is_a_circle() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let spline = Spline {
            degree: 2,
            knots: vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0],
            control: vec![
                DVec2::X,
                DVec2::ONE,
                DVec2::Y,
                DVec2::new(-1.0, 1.0),
                -DVec2::X,
            ],
            weights: vec![1.0, half, 1.0, half, 1.0],
        };
        assert!(spline.is_sound());
        let points = spline.points(1e-3);
        assert!(points.iter().all(|p| (p.length() - 1.0).abs() < 1e-12));
        assert!(points.last().unwrap().distance(-DVec2::X) < 1e-12);
        for pair in points.windows(2) {
            assert!(1.0 - pair[0].midpoint(pair[1]).length() <= 1e-3);
        }
        assert!(!Spline::default().is_sound());
    }
}
