//! A smooth curve through points, as a fine polygon line.
//!
//! In: points, and how far the curve may stray from the straight way between two of them. Out: points
//! close together on the curve, the given ones among them. A centripetal Catmull-Rom spline
//! (C. Yuksel, S. Schaefer, J. Keyser, "Parameterization and applications of Catmull-Rom curves",
//! 2011: no cusp, no loop within a span), evaluated by the pyramid of P. Barry and R. Goldman (1988).
//!
//! A spline swings out where a long way ends at a sharp bend, and a designer who drew the way through
//! a door did not mean the wall beside it. So where a span strays farther than allowed, points of the
//! straight way are put in next to its ends, nearer and nearer to them, until it does not: the middle
//! of the way is straight then, and the bend a tight one.

use glam::DVec3;

/// Smallest and largest number of parts that a span is cut into.
const PARTS: [f64; 2] = [8.0, 256.0];
/// How often the supports of a way move towards its ends, half the distance each time.
const ROUNDS: u32 = 24;

/// The curve. `closed` joins the last point to the first (then the result ends in its first point);
/// `stray` and `fine`, the length that its parts should have, are positive.
pub(super) fn through(points: &[DVec3], closed: bool, stray: f64, fine: f64) -> Vec<DVec3> {
    let mut given: Vec<DVec3> = points.to_vec();
    given.dedup();
    while closed && given.len() > 1 && given.first() == given.last() {
        given.pop();
    }
    if given.len() < 2 {
        return given;
    }
    let n = given.len();
    let ways = if closed && n > 2 { n } else { n - 1 };
    // A closed path of two points goes there and back: a bend of half a turn at both.
    if closed && n == 2 {
        given.push(given[0]);
        return through(&given, false, stray, fine);
    }
    // Distance of the supports from the ends of each way; none while the curve keeps near it.
    let mut supports: Vec<Option<f64>> = vec![None; ways];
    for _ in 0..ROUNDS {
        let (spans, ring) = spans(&given, closed, ways, &supports);
        let mut again = false;
        for (way, support) in supports.iter_mut().enumerate() {
            let (a, b) = (given[way], given[(way + 1) % n]);
            let strays = spans
                .iter()
                .filter(|s| s.way == way)
                .flat_map(|s| (1..16).map(|k| point(&ring, s.at, f64::from(k) / 16.0)))
                .any(|p| distance(p, a, b) > stray);
            if strays {
                *support = Some(support.unwrap_or(a.distance(b) * 0.9) / 2.0);
                again = true;
            }
        }
        if !again {
            break;
        }
    }
    let (spans, ring) = spans(&given, closed, ways, &supports);
    let mut line = vec![given[0]];
    for span in spans {
        let length = ring[span.at + 1].distance(ring[span.at + 2]);
        let parts = (length / fine).ceil().clamp(PARTS[0], PARTS[1]);
        line.extend((1..parts as u32).map(|k| point(&ring, span.at, f64::from(k) / parts)));
        line.push(ring[span.at + 2]);
    }
    line.dedup();
    line
}

/// A stretch of the spline between two of its control points.
struct Span {
    /// The way between two given points that it is part of.
    way: usize,
    /// Index of the control point before its start.
    at: usize,
}

/// The spans with the control points: one before the first and one after the last included.
fn spans(
    given: &[DVec3],
    closed: bool,
    ways: usize,
    supports: &[Option<f64>],
) -> (Vec<Span>, Vec<DVec3>) {
    let n = given.len();
    let mut controls = Vec::new();
    let mut spans = Vec::new();
    for way in 0..ways {
        let (a, b) = (given[way], given[(way + 1) % n]);
        let mut own = vec![a];
        if let Some(distance) = supports[way] {
            let along = (b - a).normalize() * distance;
            own.extend([a + along, b - along]);
        }
        spans.extend((0..own.len()).map(|k| Span {
            way,
            at: controls.len() + k,
        }));
        controls.extend(own);
    }
    controls.push(given[ways % n]);
    let last = controls.len() - 1;
    // Beyond the ends of an open path, the first and last way go on straight.
    let (before, after) = if closed {
        (controls[last - 1], controls[1])
    } else {
        (
            controls[0] * 2.0 - controls[1],
            controls[last] * 2.0 - controls[last - 1],
        )
    };
    controls.insert(0, before);
    controls.push(after);
    (spans, controls)
}

/// The point at share `u` of the span between controls `at + 1` and `at + 2`.
fn point(controls: &[DVec3], at: usize, u: f64) -> DVec3 {
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| controls[at + k]);
    let knot = |p: DVec3, q: DVec3| p.distance(q).sqrt().max(f64::MIN_POSITIVE);
    let t1 = knot(a, b);
    let t2 = t1 + knot(b, c);
    let t3 = t2 + knot(c, d);
    let t = t1 + (t2 - t1) * u;
    let mix = |p: DVec3, q: DVec3, from: f64, to: f64| p.lerp(q, (t - from) / (to - from));
    let (ab, bc, cd) = (mix(a, b, 0.0, t1), mix(b, c, t1, t2), mix(c, d, t2, t3));
    let (abc, bcd) = (mix(ab, bc, 0.0, t2), mix(bc, cd, t1, t3));
    mix(abc, bcd, t1, t2)
}

/// Distance of a point from a straight way.
fn distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let share = (p - a).dot(along) / along.length_squared();
    p.distance(a + along * share.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn keeps_near_the_straight_ways_and_passes_through_the_points() {
        let random = &mut Pcg64::seed_from_u64(5);
        for round in 0..200 {
            let n = random.random_range(2..9);
            let mut at = || random.random_range(-20.0..20.0);
            let points: Vec<DVec3> = (0..n)
                .map(|_| DVec3::new(at(), at(), at() / 10.0))
                .collect();
            let closed = round % 2 == 1;
            let line = through(&points, closed, 0.2, 0.05);
            for p in &points {
                assert!(line.contains(p), "{p} of {points:?}");
            }
            let ways = if closed { n } else { n - 1 };
            for p in &line {
                let ways = (0..ways).map(|i| distance(*p, points[i], points[(i + 1) % n]));
                let stray = ways.fold(f64::INFINITY, f64::min);
                assert!(stray < 0.22, "{stray} at {p}, {points:?}");
            }
            assert!(!closed || line.first() == line.last());
        }
    }

    #[test]
    fn a_gentle_bend_is_no_corner() {
        // Sixteen points on a circle: the curve is nearer to the circle than to the polygon.
        let on = |i: f64| DVec3::new(10.0 * i.cos(), 10.0 * i.sin(), 0.0);
        let points: Vec<DVec3> = (0..16)
            .map(|i| on(f64::from(i) * std::f64::consts::TAU / 16.0))
            .collect();
        let line = through(&points, true, 0.3, 0.05);
        for p in line {
            assert!((p.length() - 10.0).abs() < 0.02, "{p}");
        }
    }

    #[test]
    fn too_few_points() {
        assert_eq!(through(&[], false, 1.0, 0.1), []);
        assert_eq!(through(&[DVec3::X; 3], true, 1.0, 0.1), [DVec3::X]);
        let back = through(&[DVec3::ZERO, DVec3::X], true, 0.1, 0.1);
        assert_eq!(back.first(), back.last());
        assert!(back.contains(&DVec3::X));
    }
}
