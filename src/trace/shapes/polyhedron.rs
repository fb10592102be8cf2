//! The lecture's polyhedron: what several slabs have in common, a slab being the space between two
//! parallel faces.
//!
//! As for the box, but with any normals: the ray crosses the face N·P + d = 0 at
//! t = -(d + N·P0) / N·D. For each slab the interval between its faces; then the latest entry and the
//! earliest exit.

use std::fmt;

use glam::{DMat3, DVec2, DVec3};

use super::solid::Surface;
use super::span::Span;
use crate::trace::ray::Ray;

/// The points whose product with `normal` lies between `low` and `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Across the faces; of any length.
    pub normal: DVec3,
    /// At the face that looks against the normal.
    pub low: f64,
    /// At the face that looks along it.
    pub high: f64,
}

/// A convex polyhedron. Slab i has the faces 2i (low) and 2i + 1 (high).
#[derive(Clone, Debug, PartialEq)]
pub struct Polyhedron {
    slabs: Vec<Slab>,
    /// Its corners, or points beside them, and how far beside at most.
    corners: Vec<(DVec3, f64)>,
}

/// Why slabs make no polyhedron.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolyhedronError {
    /// A slab has a normal of no length, a number that is not finite, or its low face above its high.
    Slab(usize),
    /// The normals all lie in one plane: there is no end in some direction.
    Endless,
    /// The slabs have nothing in common.
    Empty,
}

impl fmt::Display for PolyhedronError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Slab(i) => write!(
                f,
                "slab {i} needs a normal that is not zero, and low ≤ high"
            ),
            Self::Endless => f.write_str("three slabs must have normals that are not in one plane"),
            Self::Empty => f.write_str("the slabs have no point in common"),
        }
    }
}

impl std::error::Error for PolyhedronError {}

impl Polyhedron {
    /// From its slabs.
    pub fn new(slabs: Vec<Slab>) -> Result<Self, PolyhedronError> {
        let bad = |s: &Slab| {
            let finite = s.normal.is_finite() && s.low.is_finite() && s.high.is_finite();
            !finite || s.normal == DVec3::ZERO || s.low > s.high
        };
        if let Some(i) = slabs.iter().position(bad) {
            return Err(PolyhedronError::Slab(i));
        }
        let corners = corners(&slabs).ok_or(PolyhedronError::Endless)?;
        if corners.is_empty() {
            return Err(PolyhedronError::Empty);
        }
        Ok(Self { slabs, corners })
    }

    /// When the line is inside.
    pub fn span(&self, ray: &Ray) -> Span {
        let mut span = Span::ALWAYS;
        for (slab, part) in self.slabs.iter().zip((0..).step_by(2)) {
            let (at, speed) = (slab.normal.dot(ray.origin), slab.normal.dot(ray.direction));
            let own = Span::slab((slab.low, slab.high), at, speed, [part, part + 1]);
            span = span.common(own);
        }
        span
    }

    /// The largest product of a point with `n`, or slightly more.
    pub fn support(&self, n: DVec3) -> f64 {
        let length = n.length();
        let at = |(p, beside): &(DVec3, f64)| n.dot(*p) + beside * length;
        self.corners
            .iter()
            .map(at)
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The face near `p`. u and v are lengths along the face.
    pub fn surface(&self, p: DVec3, part: u32) -> Surface {
        let slab = &self.slabs[(part / 2) as usize];
        let length = slab.normal.length();
        let unit = slab.normal / length;
        let (place, sign) = if part % 2 == 1 {
            (slab.high, 1.0)
        } else {
            (slab.low, -1.0)
        };
        let point = p - unit * (unit.dot(p) - place / length);
        let (u, v) = (unit * sign).any_orthonormal_pair();
        Surface {
            point,
            normal: unit * sign,
            uv: DVec2::new(u.dot(point), v.dot(point)),
        }
    }
}

/// Where three faces meet inside all slabs, with the error of each; none if no three normals are
/// independent. Rounding may add corners that are none; it leaves out none.
fn corners(slabs: &[Slab]) -> Option<Vec<(DVec3, f64)>> {
    let scaled: Vec<Slab> = slabs
        .iter()
        .map(|s| {
            let length = s.normal.length();
            Slab {
                normal: s.normal / length,
                low: s.low / length,
                high: s.high / length,
            }
        })
        .collect();
    let scale = scaled
        .iter()
        .map(|s| s.low.abs().max(s.high.abs()))
        .fold(0.0, f64::max);
    let mut found = Vec::new();
    let mut bounded = false;
    for i in 0..scaled.len() {
        for j in 0..i {
            for k in 0..j {
                let three = [&scaled[i], &scaled[j], &scaled[k]];
                let rows = DMat3::from_cols(three[0].normal, three[1].normal, three[2].normal);
                let volume = rows.determinant().abs();
                // Normals that are dependent but for rounding fix no corner.
                if volume < 2f64.powi(-40) {
                    continue;
                }
                bounded = true;
                let inverse = rows.transpose().inverse();
                let beside = 2f64.powi(-44) * scale / volume;
                for pick in 0..8 {
                    let face = |a: usize| {
                        if pick >> a & 1 == 1 {
                            three[a].high
                        } else {
                            three[a].low
                        }
                    };
                    let p = inverse * DVec3::new(face(0), face(1), face(2));
                    let inside = |s: &Slab| {
                        let at = s.normal.dot(p);
                        s.low - 2.0 * beside <= at && at <= s.high + 2.0 * beside
                    };
                    if scaled.iter().all(inside) {
                        found.push((p, beside));
                    }
                }
            }
        }
    }
    bounded.then_some(found)
}

#[cfg(test)]
mod tests {
    use super::super::cases::{ray, span, within};
    use super::*;

    fn slab(normal: [f64; 3], low: f64, high: f64) -> Slab {
        Slab {
            normal: normal.into(),
            low,
            high,
        }
    }

    /// |x| + |y| + |z| ≤ 2, moved by `by`.
    fn octahedron(by: DVec3) -> Polyhedron {
        let normals = [
            [1.0, 1.0, 1.0],
            [-1.0, 1.0, 1.0],
            [1.0, -1.0, 1.0],
            [1.0, 1.0, -1.0],
        ];
        let slabs = normals.map(|n| {
            let at = DVec3::from(n).dot(by);
            slab(n, at - 2.0, at + 2.0)
        });
        Polyhedron::new(slabs.to_vec()).unwrap()
    }

    fn of(p: &Polyhedron, origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        span(|ray| p.span(ray), origin, direction)
    }

    #[test]
    fn through_beside_inside_behind() {
        let p = octahedron(DVec3::ZERO);
        // At y = 0.5, z = 0.25: |x| ≤ 1.25.
        assert_eq!(
            of(&p, [-3.0, 0.5, 0.25], [1.0, 0.0, 0.0]),
            Some([1.75, 4.25])
        );
        assert_eq!(of(&p, [-3.0, 1.5, 1.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(of(&p, [0.0; 3], [0.0, 4.0, 0.0]), Some([-0.5, 0.5]));
        assert_eq!(
            of(&p, [9.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
            Some([-11.0, -7.0])
        );
        // In by -x + y + z = 2, the high face of slab 1; out by x + y + z = 2, the high face of slab 0.
        let s = p.span(&ray([-3.0, 0.5, 0.25], [1.0, 0.0, 0.0]));
        assert_eq!((s.enter.part, s.exit.part), (3, 1));
    }

    #[test]
    fn tangent_and_parallel() {
        let p = octahedron(DVec3::ZERO);
        assert_eq!(
            of(&p, [-3.0, 0.0, 2.0], [1.0, 0.0, 0.0]),
            Some([3.0, 3.0]),
            "a corner"
        );
        // In the face x + y + z = 2, from edge to edge at z = 0.5.
        assert_eq!(of(&p, [3.0, -1.5, 0.5], [-1.0, 1.0, 0.0]), Some([1.5, 3.0]));
        let beyond = 0.5 + 4.0 * f64::EPSILON;
        assert_eq!(of(&p, [3.0, -1.5, beyond], [-1.0, 1.0, 0.0]), None);
    }

    #[test]
    fn far_away() {
        let p = octahedron(DVec3::splat(1e6));
        within(
            of(&p, [1e6 - 3.0, 1e6 + 0.5, 1e6 + 0.25], [1.0, 0.0, 0.0]),
            [1.75, 4.25],
            1e-9,
        );
        let p = octahedron(DVec3::ZERO);
        within(
            of(&p, [-1e6, 0.5, 0.25], [1.0, 0.0, 0.0]),
            [1e6 - 1.25, 1e6 + 1.25],
            3e-10,
        );
    }

    #[test]
    fn its_corners_and_faces() {
        let p = octahedron(DVec3::X);
        assert!((p.support(DVec3::X) - 3.0).abs() < 1e-11);
        assert!((p.support(DVec3::NEG_Z) - 2.0).abs() < 1e-11);
        let s = p.surface(DVec3::new(1.7, 0.7, 0.7), 1);
        assert!((s.normal - DVec3::ONE.normalize()).length() < 1e-15);
        assert!((s.point.element_sum() - 3.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_polyhedron() {
        let error = |slabs: &[Slab]| Polyhedron::new(slabs.to_vec()).unwrap_err();
        let x = slab([1.0, 0.0, 0.0], 0.0, 1.0);
        let y = slab([0.0, 1.0, 0.0], 0.0, 1.0);
        let z = slab([0.0, 0.0, 2.0], 0.0, 1.0);
        assert_eq!(error(&[x, y]), PolyhedronError::Endless);
        assert_eq!(
            error(&[x, y, slab([3.0, 4.0, 0.0], 0.0, 9.0)]),
            PolyhedronError::Endless
        );
        assert_eq!(
            error(&[x, slab([0.0; 3], 0.0, 1.0)]),
            PolyhedronError::Slab(1)
        );
        assert_eq!(
            error(&[slab([1.0, 0.0, 0.0], 1.0, 0.0)]),
            PolyhedronError::Slab(0)
        );
        let apart = slab([1.0, 1.0, 0.0], 3.0, 4.0);
        assert_eq!(error(&[x, y, z, apart]), PolyhedronError::Empty);
        assert!(Polyhedron::new(vec![x, y, z]).is_ok());
    }
}
