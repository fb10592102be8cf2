//! What a ray is in, and how it is bent where that changes.

use glam::DVec3;
use smallvec::SmallVec;

/// The solid things that a ray is in, in the order in which it entered them. The last one's index of
/// refraction counts; outside of all it is 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Media {
    /// Object and index of refraction.
    held: SmallVec<[(u32, f64); 1]>,
}

impl Media {
    /// The index of refraction where the ray is.
    pub fn index(&self) -> f64 {
        self.held.last().map_or(1.0, |held| held.1)
    }

    /// Goes into a thing. Returns n1/n2: the index before, by that after.
    pub fn enter(&mut self, object: u32, ior: f64) -> f64 {
        let before = self.index();
        self.held.push((object, ior));
        before / ior
    }

    /// Comes out of a thing of that index. A ray that started in it (an eye in a glass) did not enter
    /// it: then its index holds before, if nothing else does.
    pub fn leave(&mut self, object: u32, ior: f64) -> f64 {
        let Some(at) = self.held.iter().rposition(|held| held.0 == object) else {
            return if self.held.is_empty() { ior } else { 1.0 };
        };
        let before = self.index();
        self.held.remove(at);
        before / self.index()
    }
}

/// Snell's law: a ray along the unit vector `d` meets a surface with unit normal `n` against it; `ratio`
/// is n1/n2. `None` is total internal reflection.
///
/// The lecture: T = -ηE + N(η cos α - √(1 + η²(cos² α - 1))), with E = -d.
pub fn refract(d: DVec3, n: DVec3, ratio: f64) -> Option<DVec3> {
    let cos = -d.dot(n);
    let square = 1.0 + ratio * ratio * (cos * cos - 1.0);
    (square >= 0.0).then(|| d * ratio + n * (ratio * cos - square.sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snell_at_three_angles() {
        // Into glass: sin β = sin α / 1.5.
        for degrees in [0.0f64, 30.0, 60.0] {
            let a = degrees.to_radians();
            let d = DVec3::new(a.sin(), 0.0, -a.cos());
            let t = refract(d, DVec3::Z, 1.0 / 1.5).unwrap();
            assert!((t.length() - 1.0).abs() < 1e-15);
            assert!((t.x - a.sin() / 1.5).abs() < 1e-15, "{degrees}");
            assert!(t.z < 0.0 && t.y == 0.0);
            // And out again, the same way.
            let back = refract(t, DVec3::Z, 1.5).unwrap();
            assert!((back - d).length() < 1e-14);
        }
    }

    #[test]
    fn total_reflection_begins_at_the_critical_angle() {
        // arcsin(1/1.5) = 41.81°.
        let at = |degrees: f64| {
            let a = degrees.to_radians();
            refract(DVec3::new(a.sin(), 0.0, -a.cos()), DVec3::Z, 1.5)
        };
        assert!(at(41.81).is_some());
        assert!(at(41.82).is_none());
    }

    #[test]
    fn the_last_entered_rules() {
        let mut media = Media::default();
        assert_eq!(media.enter(7, 1.5), 1.0 / 1.5);
        assert_eq!(media.enter(8, 1.2), 1.5 / 1.2);
        // Out of the first while still in the second: nothing changes.
        assert_eq!(media.leave(7, 1.5), 1.0);
        assert_eq!(media.index(), 1.2);
        assert_eq!(media.leave(8, 1.2), 1.2);
        assert_eq!(media.index(), 1.0);
        // From within, having entered nothing.
        assert_eq!(media.leave(9, 1.4), 1.4);
    }
}
