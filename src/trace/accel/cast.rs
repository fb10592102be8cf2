//! A ray made ready for boxes and triangles.
//!
//! # Why no box is missed
//!
//! A box is tested as if it were larger by `slack` on every side: g = 2^-47·(|o| + reach), where |o|
//! is the greatest coordinate of the origin and reach that of everything in the structure. With
//! u = 2^-53 = g/64 at coordinate 1, the time at which the ray crosses the plane at p is computed as
//! t = fl(fl(p - o')·fl(1/d)) with o' = fl(o ± g); so t·d = (p - o ∓ g)(1 + θ) + ε with
//! |θ| ≤ 3.01u and |ε| ≤ u(|o| + g), together an error below 4.1u·(|o| + reach) < g/15. Hence:
//!
//! 1. Every point of the ray that lies in the box, or less than 14/15·g beside it, has its t in the
//!    computed interval, whatever else rounding does. (Ize, "Robust BVH Ray Traversal", 2013, lengthens
//!    the interval by a factor instead. A length also covers the error of what is *in* the box: see
//!    `triangle` and `mesh`.)
//! 2. Every t in the computed interval gives a point less than 16/15·g beside the box.
//! 3. Subtraction, multiplication by a fixed number, min and max are monotone when rounded: of two
//!    boxes, one in the other, the outer has the wider computed interval.
//!
//! A component of the direction below 2^-1000 counts as that small: its products with any distance
//! are far below g.

use glam::DVec3;

use super::bounds::Bounds;
use crate::trace::ray::Ray;

/// The largest reciprocal used: a direction's component of 0 counts as 2^-1000, so that no product
/// is 0·∞.
const LARGEST: f64 = f64::from_bits((1023 + 1000) << 52);

/// A ray with what every test against it needs.
#[derive(Clone, Copy, Debug)]
pub struct Cast {
    /// The ray.
    pub ray: Ray,
    /// Reciprocals of the direction's components, at most 2^1000.
    pub inverse: DVec3,
    /// The map that makes the ray the third axis.
    pub shear: Shear,
}

/// Turns and shears space so that the ray becomes the third axis (Woop, Benthin and Wald,
/// "Watertight Ray/Triangle Intersection", 2013).
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    axes: [usize; 3],
    by: DVec3,
}

impl Cast {
    /// Prepares a ray.
    pub fn new(ray: Ray) -> Self {
        let reciprocal = |d: f64| (1.0 / d).clamp(-LARGEST, LARGEST);
        let d = ray.direction;
        let axis = dominant(d);
        let axes = [(axis + 1) % 3, (axis + 2) % 3, axis];
        Self {
            ray,
            inverse: DVec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z)),
            shear: Shear {
                axes,
                by: DVec3::new(d[axes[0]] / d[axis], d[axes[1]] / d[axis], 1.0 / d[axis]),
            },
        }
    }

    /// How much larger boxes are taken, for things within `reach` of the origin of coordinates.
    #[inline]
    pub fn slack(&self, reach: f64) -> f64 {
        let o = self.ray.origin.abs().max_element();
        // Not 0 even if everything lies in one point.
        ((o + reach) * 2f64.powi(-47)).max(1e-290)
    }

    /// The test for boxes that are larger by `slack`.
    #[inline]
    pub fn boxes(&self, slack: f64) -> BoxTest {
        BoxTest {
            low: self.ray.origin + slack,
            high: self.ray.origin - slack,
            inverse: self.inverse,
        }
    }
}

impl Shear {
    /// Whether the ray points against its main axis: then what goes around counterclockwise, seen
    /// against the ray, goes clockwise in the sheared plan.
    #[inline]
    pub fn is_turned(&self) -> bool {
        self.by.z < 0.0
    }

    /// The point in the sheared space, `p` being relative to the origin of the ray: the ray passes at
    /// (x, y) = (0, 0), and z is the t of the plane across the ray's main axis.
    #[inline]
    pub fn apply(&self, p: DVec3) -> DVec3 {
        let z = p[self.axes[2]];
        DVec3::new(
            p[self.axes[0]] - self.by.x * z,
            p[self.axes[1]] - self.by.y * z,
            self.by.z * z,
        )
    }
}

/// Tests a ray against boxes.
#[derive(Clone, Copy, Debug)]
pub struct BoxTest {
    low: DVec3,
    high: DVec3,
    inverse: DVec3,
}

impl BoxTest {
    /// When the ray is in the box, t ≥ 0: from the first to the second; never if the first is
    /// greater.
    #[inline]
    pub fn interval(&self, b: &Bounds) -> (f64, f64) {
        let one = (b.min - self.low) * self.inverse;
        let two = (b.max - self.high) * self.inverse;
        let near = more(
            more(less(one.x, two.x), less(one.y, two.y)),
            more(less(one.z, two.z), 0.0),
        );
        let far = less(
            less(more(one.x, two.x), more(one.y, two.y)),
            more(one.z, two.z),
        );
        (near, far)
    }
}

// One machine instruction each; `f64::min` must look for NaN, and there is none here.
#[inline]
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline]
fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The axis of the largest component.
#[inline]
pub fn dominant(v: DVec3) -> usize {
    let a = v.abs();
    if a.x >= a.y && a.x >= a.z {
        0
    } else if a.y >= a.z {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interval(origin: [f64; 3], direction: [f64; 3], b: &Bounds) -> (f64, f64) {
        let cast = Cast::new(Ray {
            origin: origin.into(),
            direction: direction.into(),
        });
        cast.boxes(cast.slack(b.reach())).interval(b)
    }

    #[test]
    fn a_box_is_entered_and_left() {
        let b = Bounds::around([DVec3::new(1.0, 0.0, 0.0), DVec3::new(3.0, 2.0, 2.0)]);
        let (near, far) = interval([0.0, 1.0, 1.0], [2.0, 0.0, 0.0], &b);
        assert!(near < 0.5 && 0.5 - near < 1e-12 && far > 1.5 && far - 1.5 < 1e-12);
        let (near, far) = interval([5.0, 1.0, 1.0], [-1.0, 0.0, -0.0], &b);
        assert!((near - 2.0).abs() < 1e-12 && (far - 4.0).abs() < 1e-12);
        // From inside; behind; beside.
        assert_eq!(interval([2.0, 1.0, 1.0], [0.0, 1.0, 0.0], &b).0, 0.0);
        let (near, far) = interval([4.0, 1.0, 1.0], [1.0, 0.0, 0.0], &b);
        assert!(near > far);
        let (near, far) = interval([0.0, 2.1, 1.0], [1.0, 0.0, 0.0], &b);
        assert!(near > far);
    }

    #[test]
    fn a_ray_in_a_face_or_an_edge_is_in_the_box() {
        let b = Bounds::around([DVec3::ZERO, DVec3::ONE]);
        for (origin, direction) in [
            ([-1.0, 0.0, 0.5], [1.0, 0.0, 0.0]),
            ([-1.0, 1.0, 0.5], [1.0, 0.0, 0.0]),
            ([-1.0, 1.0, 1.0], [1.0, -0.0, 0.0]),
            ([2.0, 0.0, 1.0], [-1.0, 0.0, 0.0]),
            ([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
            ([1.0, 0.0, -1.0], [0.0, 0.0, 1.0]),
            ([2.0, 0.0, 0.5], [-1.0, 1.0, 0.0]),
        ] {
            let (near, far) = interval(origin, direction, &b);
            assert!(near <= far, "{origin:?} {direction:?}: {near} {far}");
        }
        // A corner is passed at one instant, here widened by the slack.
        let (near, far) = interval([2.0, 0.0, 1.0], [-1.0, 1.0, 0.0], &b);
        assert!(near <= 1.0 && far >= 1.0 && far - near < 1e-12);
        // The origin of everything.
        let point = Bounds::around([DVec3::ZERO]);
        let (near, far) = interval([0.0; 3], [0.0, 0.0, 1.0], &point);
        assert!(near == 0.0 && near <= far);
    }

    #[test]
    fn the_shear_makes_the_ray_an_axis() {
        for direction in [
            DVec3::new(1.0, 2.0, 3.0),
            DVec3::new(-4.0, 1.0, 0.0),
            DVec3::new(0.5, -2.0, 1.0),
        ] {
            let cast = Cast::new(Ray {
                origin: DVec3::ZERO,
                direction,
            });
            let p = cast.shear.apply(direction * 4.0);
            assert!(
                (p - DVec3::new(0.0, 0.0, 4.0)).length() < 1e-14,
                "{direction}"
            );
        }
    }
}
