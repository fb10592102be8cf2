//! Lines in space over the picture: borders of cells, a cone of view, a line of sight.
//!
//! In: [`Line`]s and a camera. Out: two triangles for each of their parts, as wide as was asked in pixels,
//! in the picture's own coordinates. Nothing hides them.

use glam::{DVec2, DVec3};

use crate::trace::camera::Camera;

/// Straight parts from point to point.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The points.
    pub points: Vec<DVec3>,
    /// sRGB and opacity.
    pub colour: [u8; 4],
    /// Width in pixels.
    pub width: f64,
}

/// A corner of a triangle, as the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Inked {
    /// From -1 to 1, to the right and up.
    pub at: [f32; 2],
    /// sRGB and opacity.
    pub colour: [u8; 4],
}

/// The lines as a camera sees them, three corners to each triangle. What is nearer than `near` is cut off.
pub fn ink(lines: &[Line], camera: &Camera, near: f64, out: &mut Vec<Inked>) {
    out.clear();
    let size = DVec2::from_array(camera.size.map(f64::from));
    // In pixels, and the depth.
    let place = |p: DVec3| p.truncate() / p.z;
    for line in lines {
        for part in line.points.windows(2) {
            let [mut a, mut b] = [part[0], part[1]].map(|p| camera.seen(p));
            if a.z < near && b.z < near {
                continue;
            }
            let cut = |p: DVec3, q: DVec3| p.lerp(q, (near - p.z) / (q.z - p.z));
            if a.z < near {
                a = cut(a, b);
            } else if b.z < near {
                b = cut(b, a);
            }
            let Some([a, b]) = within([place(a), place(b)], size, line.width) else {
                continue;
            };
            let along = (b - a).normalize_or(DVec2::X) * (line.width / 2.0);
            let (side, end) = (along.perp(), along);
            let corner = |p: DVec2| Inked {
                at: [
                    (p.x / size.x * 2.0 - 1.0) as f32,
                    (1.0 - p.y / size.y * 2.0) as f32,
                ],
                colour: line.colour,
            };
            let corners = [
                a - end + side,
                a - end - side,
                b + end - side,
                b + end + side,
            ];
            let corners = corners.map(corner);
            out.extend([0, 1, 2, 0, 2, 3].map(|k| corners[k]));
        }
    }
}

/// The part of a line within the picture and a little around it, so that numbers stay small (Cyrus and Beck
/// 1978, Liang and Barsky 1984).
fn within([a, b]: [DVec2; 2], size: DVec2, around: f64) -> Option<[DVec2; 2]> {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    let way = b - a;
    for k in 0..2 {
        for (slope, room) in [(-way[k], a[k] + around), (way[k], size[k] + around - a[k])] {
            if slope == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if slope < 0.0 {
                first = first.max(room / slope);
            } else {
                last = last.min(room / slope);
            }
        }
    }
    (first < last || a == b).then(|| [a + way * first, a + way * last])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_as_wide_as_asked_and_cut_at_the_eye() {
        let camera = Camera::new(DVec3::ZERO, DVec3::Y, 90.0, [200, 100]);
        let line = |from: [f64; 3], to: [f64; 3]| Line {
            points: vec![from.into(), to.into()],
            colour: [255; 4],
            width: 4.0,
        };
        let mut out = Vec::new();
        // Across the middle of the picture, from a quarter of its width to three.
        ink(
            &[line([-1.0, 2.0, 0.0], [1.0, 2.0, 0.0])],
            &camera,
            0.01,
            &mut out,
        );
        assert_eq!(out.len(), 6);
        let extent = |k: usize| {
            let all = out.iter().map(|c| c.at[k]);
            let low = all.clone().fold(f32::MAX, f32::min);
            (low, all.fold(f32::MIN, f32::max))
        };
        assert_eq!(extent(0), (-0.52, 0.52));
        assert_eq!(extent(1), (-0.04, 0.04));
        // From behind the eye to before it; and all behind.
        ink(
            &[line([0.1, -5.0, -0.1], [0.1, 5.0, -0.1])],
            &camera,
            0.01,
            &mut out,
        );
        assert_eq!(out.len(), 6);
        assert!(out.iter().all(|c| c.at.iter().all(|x| x.abs() < 1.2)));
        ink(
            &[line([0.1, -5.0, 0.0], [0.1, -1.0, 0.0])],
            &camera,
            0.01,
            &mut out,
        );
        assert!(out.is_empty());
    }
}
