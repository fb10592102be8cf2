//! The lecture's bounding volumes: boxes, spheres, and polyhedra made of slabs.
//!
//! What a primitive reports lies less than 16/15·g beside its box ([`crate::trace::accel::search`]), g
//! being the slack of the ray. So a volume is conservative if its computed interval holds every t
//! whose point lies that near to a box in it.

use glam::DVec3;

use crate::trace::accel::bounds::Bounds;
use crate::trace::accel::cast::{BoxTest, Cast};

/// A bounding volume.
pub trait Volume: Copy + Send + Sync {
    /// The ray as the volume's test wants it.
    type Ray;

    /// Directions along which the widest slab is looked for. Of any length.
    const SLABS: &'static [DVec3];

    /// Around a box.
    fn around(bounds: &Bounds) -> Self;

    /// Around two volumes, whose contents have the bounds `whole`.
    fn join(&self, other: &Self, whole: &Bounds) -> Self;

    /// Prepares a ray, with its slack.
    fn prepare(cast: &Cast, slack: f64) -> Self::Ray;

    /// When the ray is in the volume, t ≥ 0: from the first to the second; never if the first is
    /// greater.
    fn interval(&self, ray: &Self::Ray) -> (f64, f64);

    /// Whether all of a box is inside, up to rounding.
    fn holds(&self, bounds: &Bounds) -> bool;
}

impl Volume for Bounds {
    type Ray = BoxTest;

    const SLABS: &'static [DVec3] = &[DVec3::X, DVec3::Y, DVec3::Z];

    fn around(bounds: &Bounds) -> Self {
        *bounds
    }

    fn join(&self, _: &Self, whole: &Bounds) -> Self {
        *whole
    }

    fn prepare(cast: &Cast, slack: f64) -> BoxTest {
        cast.boxes(slack)
    }

    #[inline]
    fn interval(&self, ray: &BoxTest) -> (f64, f64) {
        ray.interval(self)
    }

    fn holds(&self, bounds: &Bounds) -> bool {
        Bounds::holds(self, bounds)
    }
}

/// A bounding sphere.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    centre: DVec3,
    radius: f64,
}

/// A ray for balls.
pub struct BallRay {
    origin: DVec3,
    direction: DVec3,
    /// 1 / |direction|².
    inverse: f64,
    /// Added to radii.
    slack: f64,
}

impl Ball {
    /// A radius that rounding has not made too small: `radius` and `centre` are off by at most eight
    /// units in the last place of the greatest number that took part.
    fn rounded_up(centre: DVec3, radius: f64) -> Self {
        let largest = radius + centre.abs().max_element();
        Self {
            centre,
            radius: radius + largest * 2f64.powi(-49),
        }
    }
}

impl Volume for Ball {
    type Ray = BallRay;

    const SLABS: &'static [DVec3] = <Bounds as Volume>::SLABS;

    fn around(bounds: &Bounds) -> Self {
        Self::rounded_up(bounds.centre(), bounds.size().length() * 0.5)
    }

    /// The smaller of the least ball around both, and the ball around the box.
    fn join(&self, other: &Self, whole: &Bounds) -> Self {
        let apart = other.centre - self.centre;
        let distance = apart.length();
        let joined = if distance + other.radius <= self.radius {
            *self
        } else if distance + self.radius <= other.radius {
            *other
        } else {
            let radius = (distance + self.radius + other.radius) * 0.5;
            let centre = self.centre + apart * ((radius - self.radius) / distance);
            Self::rounded_up(centre, radius)
        };
        let boxed = Self::around(whole);
        if boxed.radius < joined.radius {
            boxed
        } else {
            joined
        }
    }

    /// The point nearest to the centre is off by less than 0.6·g, as is what stands for t times the
    /// direction's length; a contact lies less than √3·16/15·g beside its box. The sum is below 4·g.
    fn prepare(cast: &Cast, slack: f64) -> BallRay {
        BallRay {
            origin: cast.ray.origin,
            direction: cast.ray.direction,
            inverse: 1.0 / cast.ray.direction.length_squared(),
            slack: 8.0 * slack,
        }
    }

    #[inline]
    fn interval(&self, ray: &BallRay) -> (f64, f64) {
        let to = self.centre - ray.origin;
        let middle = to.dot(ray.direction) * ray.inverse;
        let beside = ray.direction * middle - to;
        let radius = self.radius + ray.slack;
        let square = radius * radius - beside.length_squared();
        if square < 0.0 {
            return (f64::INFINITY, 0.0);
        }
        let half = (square * ray.inverse).sqrt();
        ((middle - half).max(0.0), middle + half)
    }

    fn holds(&self, bounds: &Bounds) -> bool {
        let up = Self::rounded_up(self.centre, self.radius);
        (0..8).all(|i| up.centre.distance(bounds.corner(i)) <= up.radius)
    }
}

/// A polyhedron made of seven slabs: along the axes and the diagonals of the cube.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    /// Least and greatest value of the point's product with each direction.
    ranges: [[f64; 2]; 7],
}

/// The directions of the slabs, the same for all of them.
const DIRECTIONS: [DVec3; 7] = [
    DVec3::X,
    DVec3::Y,
    DVec3::Z,
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(-1.0, 1.0, 1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(1.0, 1.0, -1.0),
];

/// The lecture's α and β of each direction: the ray crosses the face N·P = e at t = α·e + β, here as
/// (e - at)·inverse so that it is monotone when rounded.
pub struct SlabsRay {
    at: [f64; 7],
    inverse: [f64; 7],
    slack: f64,
}

impl Volume for Slabs {
    type Ray = SlabsRay;

    const SLABS: &'static [DVec3] = &DIRECTIONS;

    fn around(bounds: &Bounds) -> Self {
        let ranges = DIRECTIONS.map(|n| {
            let low = DVec3::select(n.cmpge(DVec3::ZERO), bounds.min, bounds.max);
            let high = DVec3::select(n.cmpge(DVec3::ZERO), bounds.max, bounds.min);
            [n.dot(low), n.dot(high)]
        });
        Self { ranges }
    }

    fn join(&self, other: &Self, _: &Bounds) -> Self {
        let mut ranges = self.ranges;
        for (range, [low, high]) in ranges.iter_mut().zip(other.ranges) {
            *range = [range[0].min(low), range[1].max(high)];
        }
        Self { ranges }
    }

    /// N·P of a contact leaves the range of its box by less than 3·16/15·g. N·O and N·D are sums of
    /// three numbers: off by 3.01u times the largest, and what that costs at t is, by t·|D| <
    /// 2(|O| + reach), below g/4 each. Dividing costs g/15 more.
    fn prepare(cast: &Cast, slack: f64) -> SlabsRay {
        let inverse = |n: DVec3| {
            let largest = 2f64.powi(1000);
            (1.0 / n.dot(cast.ray.direction)).clamp(-largest, largest)
        };
        SlabsRay {
            at: DIRECTIONS.map(|n| n.dot(cast.ray.origin)),
            inverse: DIRECTIONS.map(inverse),
            slack: 8.0 * slack,
        }
    }

    #[inline]
    fn interval(&self, ray: &SlabsRay) -> (f64, f64) {
        let (mut near, mut far) = (0.0f64, f64::INFINITY);
        for (i, [low, high]) in self.ranges.iter().enumerate() {
            let one = (low - ray.slack - ray.at[i]) * ray.inverse[i];
            let two = (high + ray.slack - ray.at[i]) * ray.inverse[i];
            near = near.max(one.min(two));
            far = far.min(one.max(two));
        }
        (near, far)
    }

    fn holds(&self, bounds: &Bounds) -> bool {
        let other = Self::around(bounds);
        let slack = bounds.reach() * 2f64.powi(-49);
        let inside = |(a, b): (&[f64; 2], &[f64; 2])| a[0] <= b[0] + slack && a[1] >= b[1] - slack;
        self.ranges.iter().zip(&other.ranges).all(inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::ray::Ray;

    fn interval<V: Volume>(v: &V, origin: [f64; 3], direction: [f64; 3]) -> (f64, f64) {
        let cast = Cast::new(Ray {
            origin: origin.into(),
            direction: direction.into(),
        });
        v.interval(&V::prepare(&cast, cast.slack(10.0)))
    }

    fn near((near, far): (f64, f64), expected: [f64; 2]) {
        let apart = (near - expected[0]).abs() + (far - expected[1]).abs();
        assert!(apart < 1e-6, "{near} {far}, not {expected:?}");
        assert!(near <= expected[0] && far >= expected[1]);
    }

    #[test]
    fn balls() {
        // Around the cube of side 2: radius √3.
        let cube = Bounds::around([DVec3::ZERO, DVec3::splat(2.0)]);
        let ball = Ball::around(&cube);
        let half = 3f64.sqrt();
        near(
            interval(&ball, [-9.0, 1.0, 1.0], [2.0, 0.0, 0.0]),
            [5.0 - half / 2.0, 5.0 + half / 2.0],
        );
        near(
            interval(&ball, [1.0, 1.0, 1.0], [0.0, 1.0, 0.0]),
            [0.0, half],
        );
        let (from, to) = interval(&ball, [9.0, 1.0, 1.0], [1.0, 0.0, 0.0]);
        assert!(from > to);
        // Two balls of radius 1, 4 apart: radius 3.
        let one = Ball {
            centre: DVec3::ZERO,
            radius: 1.0,
        };
        let two = Ball {
            centre: DVec3::X * 4.0,
            radius: 1.0,
        };
        let wide = Bounds::around([DVec3::splat(-9.0), DVec3::splat(9.0)]);
        let joined = one.join(&two, &wide);
        assert!((joined.radius - 3.0).abs() < 1e-12);
        assert!((joined.centre - DVec3::X * 2.0).length() < 1e-12);
        assert_eq!(joined.join(&one, &wide).radius, joined.radius);
        // The box may give the smaller ball.
        let narrow = Bounds::around([DVec3::ZERO, DVec3::ONE]);
        assert!(joined.join(&one, &narrow).radius < 1.0);
    }

    #[test]
    fn slabs_cut_the_corners_that_boxes_have() {
        let a = Bounds::around([DVec3::ZERO, DVec3::ONE]);
        let b = Bounds::around([DVec3::splat(4.0), DVec3::splat(5.0)]);
        let whole = a.union(&b);
        let slabs = Slabs::around(&a).join(&Slabs::around(&b), &whole);
        assert!(slabs.holds(&a) && slabs.holds(&b) && !slabs.holds(&whole));
        // -x + y + z lies within -1 … 6.
        assert_eq!(slabs.ranges[4], [-1.0 + 0.0, 6.0]);
        near(
            interval(&slabs, [-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]),
            [1.0, 6.0],
        );
        // Through the empty corner (5, 0, 0).
        let (origin, direction) = ([5.0, -1.0, 0.0], [0.0, 1.0, 0.0]);
        let (from, to) = interval(&whole, origin, direction);
        assert!(from <= to);
        let (from, to) = interval(&slabs, origin, direction);
        assert!(from > to, "{from} {to}");
    }
}
