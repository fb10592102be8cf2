//! From pixels to rays: a pinhole camera.
//!
//! Source: lecture, "2D Example" and "Ray Generation": with the eye P0, the unit vector `towards` and
//! d = 1, the left end of a row is P1 = P0 + towards − tan(Θ)·right, and pixel column i of `width`
//! lies at P1 + (i / width)·2·tan(Θ)·right. (The lecture's +0.5 would start the row in its middle.)

use glam::{DVec2, DVec3};

use super::beam::{Bundle, Fan};
use super::ray::Ray;

/// A camera with its picture's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The eye.
    pub eye: DVec3,
    /// Pixels across and down.
    pub size: [u32; 2],
    fan: Fan,
}

impl Camera {
    /// A camera that looks along `direction` (not zero), upright as far as that goes: looking
    /// straight up or down, the top of the picture is north or south. `fov` is the horizontal angle
    /// of view in degrees, above 0 and below 180. Pixels are square.
    pub fn new(eye: DVec3, direction: DVec3, fov: f64, size: [u32; 2]) -> Self {
        let towards = direction.normalize();
        let side = towards.cross(DVec3::Z).try_normalize();
        let right = side.unwrap_or(DVec3::X);
        let up = right.cross(towards);
        let half = (fov.to_radians() / 2.0).tan();
        let aspect = f64::from(size[1]) / f64::from(size[0]);
        // From the middle of the picture to the middles of its right and upper border.
        let (right, up) = (right * half, up * half * aspect);
        Self {
            eye,
            size,
            fan: Fan {
                origin: eye,
                corner: towards - right + up,
                across: right * (2.0 / f64::from(size[0])),
                down: up * (-2.0 / f64::from(size[1])),
            },
        }
    }

    /// The ray through a point of the picture, in pixels from its upper left corner. Its direction
    /// has length 1 along the line of view: `t` is the depth.
    #[inline]
    pub fn ray(&self, at: DVec2) -> Ray {
        Ray {
            origin: self.eye,
            direction: self.fan.direction(at),
        }
    }

    /// The same camera with pixels that are `n` times as wide and high: each in the place of n × n. Those at
    /// the right and lower border may reach over it.
    pub fn coarser(&self, n: u32) -> Self {
        let n = n.max(1);
        Self {
            eye: self.eye,
            size: self.size.map(|pixels| pixels.div_ceil(n)),
            fan: Fan {
                across: self.fan.across * f64::from(n),
                down: self.fan.down * f64::from(n),
                ..self.fan
            },
        }
    }

    /// Where it looks: unit vector.
    pub fn direction(&self) -> DVec3 {
        let [width, height] = self.size.map(f64::from);
        self.fan
            .direction(DVec2::new(width, height) / 2.0)
            .normalize()
    }

    /// A point as the camera sees it: its depth in z, and in x and y, divided by the depth, the place
    /// in the picture in pixels from the upper left corner.
    #[inline]
    pub fn seen(&self, point: DVec3) -> DVec3 {
        let to = point - self.eye;
        let [width, height] = self.size.map(f64::from);
        let (right, up) = (
            self.fan.across * (width / 2.0),
            self.fan.down * (height / -2.0),
        );
        let depth = to.dot(self.fan.corner + right - up);
        let half = |axis: DVec3| to.dot(axis) / axis.length_squared();
        DVec3::new(
            (depth + half(right)) * width / 2.0,
            (depth - half(up)) * height / 2.0,
            depth,
        )
    }
}

impl Bundle for Camera {
    #[inline]
    fn fan(&self) -> Fan {
        self.fan
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_of_the_picture() {
        // 90 degrees: as far to the side as ahead; half as high as wide.
        let camera = Camera::new(DVec3::ZERO, DVec3::Y * 3.0, 90.0, [200, 100]);
        let close = |at: [f64; 2], direction: [f64; 3]| {
            let ray = camera.ray(at.into());
            assert!((ray.direction - DVec3::from_array(direction)).length() < 1e-12);
        };
        close([100.0, 50.0], [0.0, 1.0, 0.0]);
        close([0.0, 0.0], [-1.0, 1.0, 0.5]);
        close([200.0, 100.0], [1.0, 1.0, -0.5]);
    }

    #[test]
    fn coarse_pixels_lie_over_fine_ones() {
        let camera = Camera::new(DVec3::ONE, DVec3::new(2.0, 1.0, 0.3), 70.0, [203, 98]);
        let coarse = camera.coarser(8);
        assert_eq!(coarse.size, [26, 13]);
        let [a, b] = [(&coarse, 1.0), (&camera, 8.0)]
            .map(|(c, n)| c.ray(DVec2::new(3.5, 7.25) * n).direction);
        assert!((a - b).length() < 1e-14);
    }

    #[test]
    fn straight_down_keeps_a_frame() {
        let camera = Camera::new(DVec3::ZERO, DVec3::NEG_Z, 90.0, [10, 10]);
        let top = camera.ray(DVec2::new(5.0, 0.0)).direction;
        assert!((top - DVec3::new(0.0, 1.0, -1.0)).length() < 1e-12, "{top}");
    }
}
