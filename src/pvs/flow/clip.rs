//! Windings, planes and separators of [`super::flow()`]: segments and lines on the plan, in f64, with
//! the tools' epsilon (`on`, in grid steps).

use glam::DVec2;
use smallvec::SmallVec;

/// What is left of a portal.
pub(super) type Winding = [DVec2; 2];

/// A line with a front side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Of length 1, towards the front.
    pub normal: DVec2,
    /// Of the line from the grid's origin, along the normal.
    pub distance: f64,
}

impl Plane {
    /// How far in front of it the point lies.
    #[inline]
    pub fn before(&self, p: DVec2) -> f64 {
        self.normal.dot(p) - self.distance
    }

    /// The same line with its front behind.
    pub fn flipped(&self) -> Self {
        Self {
            normal: -self.normal,
            distance: -self.distance,
        }
    }
}

/// The part of a winding in front of a plane. One that lies on it stays, as in ericw-tools (id
/// Software's program drops it).
#[inline]
pub(super) fn clip(winding: Winding, plane: &Plane, on: f64) -> Option<Winding> {
    let [p, q] = winding;
    let (a, b) = (plane.before(p), plane.before(q));
    if a.abs() <= on && b.abs() <= on {
        return Some(winding);
    }
    if a <= on && b <= on {
        return None;
    }
    if a >= -on && b >= -on {
        return Some(winding);
    }
    let middle = p + (q - p) * (a / (a - b));
    Some(if a > 0.0 { [p, middle] } else { [middle, q] })
}

/// The planes through one end of each of two windings that have the first strictly behind and the
/// second strictly in front, but for those ends.
pub(super) fn separators(source: Winding, pass: Winding, on: f64) -> SmallVec<[Plane; 2]> {
    let mut planes = SmallVec::new();
    for (p, other_p) in [(source[0], source[1]), (source[1], source[0])] {
        for (q, other_q) in [(pass[0], pass[1]), (pass[1], pass[0])] {
            let length = p.distance(q);
            if length < on {
                continue;
            }
            let normal = (q - p).perp() / length;
            let mut plane = Plane {
                normal,
                distance: normal.dot(q),
            };
            let source_before = plane.before(other_p);
            if source_before.abs() <= on {
                continue;
            }
            if source_before > 0.0 {
                plane = plane.flipped();
            }
            if plane.before(other_q) > on {
                planes.push(plane);
                break;
            }
        }
    }
    planes
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: f64 = 0.1;

    fn winding(a: (f64, f64), b: (f64, f64)) -> Winding {
        [DVec2::from(a), DVec2::from(b)]
    }

    /// The front is where y is larger than `y`.
    fn above(y: f64) -> Plane {
        Plane {
            normal: DVec2::Y,
            distance: y,
        }
    }

    #[test]
    fn what_lies_in_front_stays() {
        let upright = winding((3.0, -1.0), (3.0, 7.0));
        assert_eq!(
            clip(upright, &above(1.0), ON),
            Some(winding((3.0, 1.0), (3.0, 7.0)))
        );
        assert_eq!(
            clip(upright, &above(1.0).flipped(), ON),
            Some(winding((3.0, -1.0), (3.0, 1.0)))
        );
        assert_eq!(clip(upright, &above(-3.0), ON), Some(upright));
        assert_eq!(clip(upright, &above(7.5), ON), None);
    }

    #[test]
    fn what_is_nearer_than_the_epsilon_lies_on_the_line() {
        let upright = winding((3.0, -1.0), (3.0, 7.0));
        // Too little in front to count …
        assert_eq!(clip(upright, &above(6.95), ON), None);
        assert!(clip(upright, &above(6.85), ON).is_some());
        // … or behind.
        assert_eq!(clip(upright, &above(-0.95), ON), Some(upright));
        // All of it on the line.
        let flat = winding((0.0, 5.05), (4.0, 4.95));
        assert_eq!(clip(flat, &above(5.0), ON), Some(flat));
    }

    #[test]
    fn separators_are_the_two_diagonals() {
        let (source, pass) = (
            winding((0.0, 0.0), (0.0, 2.0)),
            winding((2.0, 0.0), (2.0, 2.0)),
        );
        let planes = separators(source, pass, ON);
        assert_eq!(planes.len(), 2);
        for plane in &planes {
            // Source behind, pass in front, one end of each on the line.
            let before = |w: Winding| w.map(|p| plane.before(p));
            let ([a, b], [c, d]) = (before(source), before(pass));
            assert!(a.max(b).abs() < 1e-12 && a.min(b) < -1.0, "{a} {b}");
            assert!(c.min(d).abs() < 1e-12 && c.max(d) > 1.0, "{c} {d}");
        }
        // What is seen at x = 4 lies between y = -2 and y = 4.
        let far = winding((4.0, -9.0), (4.0, 9.0));
        let seen = planes
            .iter()
            .try_fold(far, |seen, plane| clip(seen, plane, ON))
            .unwrap();
        assert!(seen[0].distance(DVec2::new(4.0, -2.0)) < 1e-12, "{seen:?}");
        assert!(seen[1].distance(DVec2::new(4.0, 4.0)) < 1e-12, "{seen:?}");
    }

    #[test]
    fn windings_with_a_common_end_have_no_separators() {
        let (source, pass) = (
            winding((0.0, 0.0), (0.0, 2.0)),
            winding((0.0, 2.0), (2.0, 2.0)),
        );
        assert!(separators(source, pass, ON).is_empty());
        // Nor have those in line.
        let beyond = winding((0.0, 4.0), (0.0, 6.0));
        assert!(separators(source, beyond, ON).is_empty());
    }
}
