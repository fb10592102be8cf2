//! Which cells are painted.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::pvs::eye::Cone;
use crate::trace::beam::{Bundle, Fan};
use crate::trace::camera::Camera;

/// Which cells are painted. The picture is the same: the others cannot be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Culling {
    /// All cells of the level.
    None,
    /// Those that the eye's cell sees from anywhere: its PVS.
    Pvs,
    /// Those that the eye sees, within the angle of the picture.
    #[default]
    Eye,
}

impl Culling {
    /// All of them, the one that paints most first.
    pub const ALL: [Self; 3] = [Self::None, Self::Pvs, Self::Eye];

    /// Its name in commands and tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Pvs => "pvs",
            Self::Eye => "eye",
        }
    }
}

/// The cone on the plan in which everything lies that a camera's picture can show; a little wider, so that
/// rounding leaves nothing out. All around where the picture shows what is straight up or down.
pub fn cone(camera: &Camera) -> Cone {
    // More than rounding does to a direction, by far.
    const WIDER: f64 = 1.0 / (1u64 << 20) as f64;
    const LENGTH: f64 = (1u64 << 40) as f64;
    let fan: Fan = camera.fan();
    let [width, height] = camera.size.map(f64::from);
    let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)];
    let flat = corners.map(|(x, y)| fan.direction(DVec2::new(x, y)));
    if holds_upright(&flat) {
        return Cone::ALL;
    }
    let flat = flat.map(DVec3::truncate);
    // The corner from which all others are to the left, and the one from which they are to the right.
    let extreme = |sign: f64| {
        let all = |p: &&DVec2| flat.iter().all(|q| sign * p.perp_dot(*q) >= 0.0);
        flat.iter().find(all).filter(|p| p.length_squared() > 0.0)
    };
    let (Some(low), Some(high)) = (extreme(1.0), extreme(-1.0)) else {
        return Cone::ALL;
    };
    if low.dot(*high) < 0.0 && low.perp_dot(*high) <= WIDER {
        return Cone::ALL;
    }
    let whole = |v: DVec2| {
        (v.normalize() * LENGTH)
            .to_array()
            .map(|c| c.round() as i64)
    };
    let turned = |v: &DVec2, by: f64| whole(v.normalize() + v.normalize().perp() * by);
    Cone::between(turned(low, -WIDER), turned(high, WIDER)).unwrap_or(Cone::ALL)
}

/// Whether the upright axis runs through the picture, or by its border.
fn holds_upright(corners: &[DVec3; 4]) -> bool {
    [DVec3::Z, DVec3::NEG_Z].into_iter().any(|axis| {
        (0..4).all(|i| {
            // Clockwise as seen from the eye, so this points inwards.
            let inwards = corners[(i + 1) % 4].cross(corners[i]);
            inwards.normalize_or_zero().dot(axis) >= -1e-6
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::sampling::Source;

    #[test]
    fn every_pixel_lies_in_the_cone() {
        let mut random = Source::new(5, 1, 2);
        let mut narrow = 0;
        for _ in 0..2000 {
            let mut next = || random.next() * 2.0 - 1.0;
            let direction = DVec3::new(next(), next(), next() * 2.0);
            let fov = 20.0 + 150.0 * next().abs();
            let camera = Camera::new(DVec3::ZERO, direction, fov, [12, 8]);
            let Some([low, high]) = cone(&camera).edges() else {
                continue;
            };
            narrow += 1;
            let [low, high] = [low, high].map(|[x, y]| DVec2::new(x as f64, y as f64));
            let wide = low.perp_dot(high) < 0.0;
            for x in 0..=12 {
                for y in 0..=8 {
                    let at = DVec2::new(x.into(), y.into());
                    let d = camera.fan().direction(at).truncate();
                    let (after, before) = (low.perp_dot(d) > 0.0, d.perp_dot(high) > 0.0);
                    assert!(if wide {
                        after || before
                    } else {
                        after && before
                    });
                }
            }
        }
        assert!(narrow > 500, "{narrow}");
    }

    #[test]
    fn all_around_where_the_ground_below_the_feet_is_seen() {
        let down = Camera::new(DVec3::ZERO, DVec3::new(0.1, 0.0, -1.0), 90.0, [9, 9]);
        assert_eq!(cone(&down), Cone::ALL);
        let level = Camera::new(DVec3::ZERO, DVec3::X, 90.0, [9, 9]);
        let [low, high] = cone(&level).edges().expect("it is narrow");
        assert_eq!([low[0], -low[1]], high);
        assert!(low[0] <= -low[1]);
    }
}
