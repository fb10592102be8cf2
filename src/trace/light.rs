//! Light sources: from where light comes to a point, and how much.
//!
//! In: a [`Light`] of the level, a point, and for sources with an extent a point of the unit square.
//! Out: an [`Arrival`]: where a shadow ray must go, and the intensity that arrives if nothing is in
//! the way. Source: lecture, "Illumination Model", "Soft Shadows".

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::level::scene::{Light, LightShape};

/// Light on its way to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Unit vector from the point to the source (L).
    pub direction: DVec3,
    /// How far the source is; infinite for light from infinitely far away.
    pub distance: f64,
    /// Intensity per colour channel that arrives on a surface facing the light, attenuated by 1/d².
    pub intensity: DVec3,
}

/// Whether a source has an extent, so that its shadows are soft and one ray does not tell.
pub fn is_area(light: &Light) -> bool {
    match light.shape {
        LightShape::Point { .. } | LightShape::Spot { .. } | LightShape::Directional { .. } => {
            false
        }
        LightShape::Rectangle { .. } | LightShape::Disc { .. } | LightShape::Sphere { .. } => true,
    }
}

/// Into how many columns and rows the unit square is best cut for about `n` samples of a source: a long
/// rectangle into more across its length. Together they are at most `n`.
pub fn parts(light: &Light, n: u32) -> [u32; 2] {
    let n = n.max(1);
    let slender = match light.shape {
        LightShape::Rectangle { edges, .. } => edges[0].length() / edges[1].length(),
        _ => 1.0,
    };
    let columns = (f64::from(n) * slender).sqrt().round();
    let columns = columns.clamp(1.0, f64::from(n)) as u32;
    [columns, n / columns]
}

/// The sample that picks the middle of a source, as seen from anywhere.
pub fn middle(light: &Light) -> DVec2 {
    match light.shape {
        LightShape::Sphere { .. } => DVec2::ZERO,
        _ => DVec2::splat(0.5),
    }
}

/// The light that comes to `point` from the part of the source that `sample` picks (a point of the
/// unit square; sources without extent take no notice). Averaged over the square, the intensities
/// are those of the whole source. `None` where none comes: outside of a spot's cone, behind a
/// one-sided source, or in the source itself.
pub fn arrival(light: &Light, point: DVec3, sample: DVec2) -> Option<Arrival> {
    let intensity = DVec3::from_array(light.intensity);
    match light.shape {
        LightShape::Point { position } => from(position, point, intensity),
        LightShape::Spot {
            position,
            direction,
            angle,
            inner,
        } => {
            let arrival = from(position, point, intensity)?;
            let share = spot(-arrival.direction.dot(direction), angle, inner);
            (share > 0.0).then_some(Arrival {
                intensity: arrival.intensity * share,
                ..arrival
            })
        }
        LightShape::Directional { direction } => Some(Arrival {
            direction: -direction,
            distance: f64::INFINITY,
            intensity,
        }),
        LightShape::Rectangle { center, edges } => {
            let at = center + edges[0] * (sample.x - 0.5) + edges[1] * (sample.y - 0.5);
            one_sided(at, edges[0].cross(edges[1]).normalize(), point, intensity)
        }
        LightShape::Disc {
            center,
            direction,
            radius,
        } => {
            let (u, v) = direction.any_orthonormal_pair();
            let p = on_disc(sample) * radius;
            one_sided(center + u * p.x + v * p.y, direction, point, intensity)
        }
        LightShape::Sphere { center, radius } => ball(center, radius, point, sample, intensity),
    }
}

/// From a point source.
fn from(position: DVec3, point: DVec3, intensity: DVec3) -> Option<Arrival> {
    let to = position - point;
    let distance = to.length();
    let inverse = 1.0 / distance;
    (distance > 0.0).then(|| Arrival {
        direction: to * inverse,
        distance,
        intensity: intensity * (inverse * inverse),
    })
}

/// From a point of a source that shines like a matt surface, on the side of its normal only: seen
/// at an angle, it is smaller.
fn one_sided(at: DVec3, normal: DVec3, point: DVec3, intensity: DVec3) -> Option<Arrival> {
    let arrival = from(at, point, intensity)?;
    let cos = -arrival.direction.dot(normal);
    (cos > 0.0).then_some(Arrival {
        intensity: arrival.intensity * cos,
        ..arrival
    })
}

/// From a ball: every direction in the cone in which it is seen is as bright, and all of them
/// together give what a point source in its middle would.
fn ball(
    center: DVec3,
    radius: f64,
    point: DVec3,
    sample: DVec2,
    intensity: DVec3,
) -> Option<Arrival> {
    let to = center - point;
    let squared = to.length_squared();
    if squared <= radius * radius {
        return None;
    }
    let axis = to / squared.sqrt();
    let (u, v) = axis.any_orthonormal_pair();
    let cos_most = (1.0 - radius * radius / squared).sqrt();
    let cos = 1.0 - sample.x * (1.0 - cos_most);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let angle = TAU * sample.y;
    let direction = axis * cos + (u * angle.cos() + v * angle.sin()) * sin;
    // Nearest point of the ball in that direction.
    let middle = to.dot(direction);
    let half = (radius * radius - (squared - middle * middle))
        .max(0.0)
        .sqrt();
    Some(Arrival {
        direction,
        distance: middle - half,
        intensity: intensity / squared,
    })
}

/// The share of a spot's light at an angle of which this is the cosine: all within the inner cone,
/// none outside of the outer one, and smoothly less between.
fn spot(cos: f64, angle: f64, inner: f64) -> f64 {
    let [edge, full] = [angle, inner].map(|a| a.to_radians().cos());
    if cos >= full {
        1.0
    } else if cos <= edge {
        0.0
    } else {
        let s = (cos - edge) / (full - edge);
        s * s * (3.0 - 2.0 * s)
    }
}

/// From the unit square to the unit disc, equal areas to equal areas, neighbours to neighbours
/// (Shirley & Chiu, "A low distortion map between disk and square", 1997).
pub fn on_disc(sample: DVec2) -> DVec2 {
    let p = sample * 2.0 - 1.0;
    if p == DVec2::ZERO {
        return p;
    }
    let (r, angle) = if p.x.abs() > p.y.abs() {
        (p.x, TAU / 8.0 * (p.y / p.x))
    } else {
        (p.y, TAU / 4.0 - TAU / 8.0 * (p.x / p.y))
    };
    DVec2::from_angle(angle) * r
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::sampling::Source;

    fn light(shape: LightShape) -> Light {
        Light {
            name: None,
            intensity: [4.0, 2.0, 1.0],
            shape,
        }
    }

    #[test]
    fn a_quarter_at_twice_the_distance() {
        let lamp = light(LightShape::Point {
            position: DVec3::new(0.0, 0.0, 2.0),
        });
        let arrival = arrival(&lamp, DVec3::ZERO, DVec2::ZERO).unwrap();
        assert_eq!(arrival.direction, DVec3::Z);
        assert_eq!(arrival.distance, 2.0);
        assert_eq!(arrival.intensity, DVec3::new(1.0, 0.5, 0.25));
    }

    #[test]
    fn a_spot_fades_between_its_cones() {
        let lamp = |x: f64| {
            let spot = light(LightShape::Spot {
                position: DVec3::Z,
                direction: DVec3::NEG_Z,
                angle: 60.0,
                inner: 0.0,
            });
            arrival(&spot, DVec3::new(x, 0.0, 0.0), DVec2::ZERO).map(|a| a.intensity.x)
        };
        assert_eq!(lamp(0.0), Some(4.0));
        // tan 60° = 1.73.
        assert_eq!(lamp(1.74), None);
        // At 41.41°, cos = 0.75 lies in the middle between cos 0 and cos 60°: half of 4 · 0.75².
        let x = (1.0 / 0.75f64.powi(2) - 1.0).sqrt();
        assert!((lamp(x).unwrap() - 0.5 * 4.0 * 0.75f64.powi(2)).abs() < 1e-12);
    }

    #[test]
    fn sources_with_an_extent_give_together_what_a_point_does_from_afar() {
        let far = DVec3::new(0.0, 0.0, -1000.0);
        for shape in [
            LightShape::Rectangle {
                center: DVec3::ZERO,
                edges: [DVec3::Y, DVec3::X],
            },
            LightShape::Disc {
                center: DVec3::ZERO,
                direction: DVec3::NEG_Z,
                radius: 1.0,
            },
            LightShape::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
            },
        ] {
            let lamp = light(shape);
            let mut random = Source::new(1, 2, 3);
            let samples: Vec<DVec2> = random.stratified(64).collect();
            let sum: DVec3 = samples
                .iter()
                .map(|&s| arrival(&lamp, far, s).unwrap().intensity)
                .sum();
            assert!((sum.x / 64.0 * 1e6 - 4.0).abs() < 1e-4, "{sum}");
            assert!(arrival(&lamp, far, samples[0]).unwrap().distance < 1000.1);
        }
        let disc = light(LightShape::Disc {
            center: DVec3::ZERO,
            direction: DVec3::NEG_Z,
            radius: 1.0,
        });
        assert_eq!(arrival(&disc, DVec3::Z, DVec2::splat(0.3)), None);
    }

    #[test]
    fn a_long_lamp_is_cut_across() {
        let lamp = |a: f64, b: f64| {
            light(LightShape::Rectangle {
                center: DVec3::ZERO,
                edges: [DVec3::X * a, DVec3::Y * b],
            })
        };
        assert_eq!(parts(&lamp(1.0, 1.0), 16), [4, 4]);
        assert_eq!(parts(&lamp(60.0, 0.2), 16), [16, 1]);
        assert_eq!(parts(&lamp(0.2, 60.0), 16), [1, 16]);
        assert_eq!(parts(&lamp(4.0, 1.0), 16), [8, 2]);
        for n in 1..40 {
            let [columns, rows] = parts(&lamp(3.0, 1.0), n);
            assert!(columns * rows <= n && columns * rows > n / 2, "{n}");
        }
    }

    #[test]
    fn the_disc_is_covered_evenly() {
        let points: Vec<DVec2> = Source::new(1, 2, 3)
            .stratified(10_000)
            .map(on_disc)
            .collect();
        assert!(points.iter().all(|p| p.length() <= 1.0));
        // Half of the area lies within radius 1/√2.
        let inner = points.iter().filter(|p| p.length_squared() < 0.5).count();
        assert!((4950..=5050).contains(&inner), "{inner}");
    }
}
