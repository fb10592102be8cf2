//! What a body must keep clear of: lines on the plan, found by place.
//!
//! In: lines (walls, ledges, the feet of objects). Out: distances from points and from straight ways,
//! up to a reach. Buckets as wide as the reach, each with the lines whose box meets it.

use glam::{DMat3, DQuat, DVec2, DVec3, EulerRot};

use super::person::heights;
use super::rise::Ground;
use crate::level::scene::{Object, Shape};

/// Corners of the polygon that stands for a circle.
const ROUND: u32 = 12;

/// Lines in buckets.
pub(super) struct Obstacles {
    lines: Vec<[DVec2; 2]>,
    /// Distances above this are not told apart.
    pub reach: f64,
    low: DVec2,
    size: [usize; 2],
    buckets: Vec<Vec<u32>>,
}

impl Obstacles {
    /// Buckets for the lines; `reach` is positive.
    pub fn new(lines: Vec<[DVec2; 2]>, reach: f64) -> Self {
        let ends = lines.iter().flatten().copied();
        let (low, high) = ends.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        });
        let extent = if lines.is_empty() {
            DVec2::ZERO
        } else {
            high - low
        };
        let size = (extent / reach).to_array().map(|x| x as usize + 1);
        let mut obstacles = Obstacles {
            lines: Vec::new(),
            reach,
            low: if lines.is_empty() { DVec2::ZERO } else { low },
            size,
            buckets: vec![Vec::new(); size[0] * size[1]],
        };
        for (line, number) in lines.iter().zip(0..) {
            let [a, b] = *line;
            for bucket in obstacles.range(a.min(b), a.max(b)) {
                obstacles.buckets[bucket].push(number);
            }
        }
        obstacles.lines = lines;
        obstacles
    }

    /// The buckets that a box meets.
    fn range(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = usize> + use<> {
        let clamp = |p: DVec2| {
            let at = ((p - self.low) / self.reach).to_array();
            [0, 1].map(|axis| (at[axis].floor().max(0.0) as usize).min(self.size[axis] - 1))
        };
        let (from, to, width) = (clamp(low), clamp(high), self.size[0]);
        (from[1]..=to[1]).flat_map(move |y| (from[0]..=to[0]).map(move |x| y * width + x))
    }

    /// Distance of the nearest line, at most the reach.
    pub fn distance(&self, p: DVec2) -> f64 {
        let reach = DVec2::splat(self.reach);
        let mut least = self.reach * self.reach;
        for bucket in self.range(p - reach, p + reach) {
            for &number in &self.buckets[bucket] {
                least = least.min(to_line(p, self.lines[number as usize]));
            }
        }
        least.sqrt()
    }

    /// Whether a straight way keeps farther than `distance`, at most the reach, from every line.
    pub fn clear(&self, [from, to]: [DVec2; 2], distance: f64) -> bool {
        let parts = (from.distance(to) / self.reach).ceil().max(1.0);
        let margin = DVec2::splat(distance);
        let squared = distance * distance;
        (0..parts as u32).all(|k| {
            let a = from.lerp(to, f64::from(k) / parts);
            let b = from.lerp(to, f64::from(k + 1) / parts);
            self.range(a.min(b) - margin, a.max(b) + margin)
                .flat_map(|bucket| &self.buckets[bucket])
                .all(|&number| between([a, b], self.lines[number as usize]) > squared)
        })
    }
}

/// Square of the distance of a point from a line.
fn to_line(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    p.distance_squared(a + along * share.clamp(0.0, 1.0))
}

/// Square of the distance between two lines.
fn between(p: [DVec2; 2], q: [DVec2; 2]) -> f64 {
    let side = |[a, b]: [DVec2; 2], c: DVec2| (b - a).perp_dot(c - a);
    if side(p, q[0]) * side(p, q[1]) < 0.0 && side(q, p[0]) * side(q, p[1]) < 0.0 {
        return 0.0;
    }
    let ends = [
        to_line(p[0], q),
        to_line(p[1], q),
        to_line(q[0], p),
        to_line(q[1], p),
    ];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

/// The ground that an object takes up: a convex polygon, counterclockwise. `None` where it hangs
/// above a head of this height, or lies so flat (`flat`) that one walks over it. The form of a mesh is
/// in its own file; it counts as a block as high as its scale, and a quarter as wide.
pub fn footprint(object: &Object, ground: &Ground, height: f64, flat: f64) -> Option<Vec<DVec2>> {
    let own: Vec<DVec3> = match &object.shape {
        Shape::Sphere { radius } => cylinder(*radius, -radius, *radius),
        Shape::Box { size } => block(*size),
        Shape::Cylinder { radius, height } | Shape::Cone { radius, height } => {
            cylinder(*radius, 0.0, *height)
        }
        Shape::Polygon { points } => points.clone(),
        Shape::Mesh { .. } => block(DVec3::new(0.25, 0.25, 1.0)),
    };
    let [x, y, z] = object.rotation.to_array().map(f64::to_radians);
    let turn = DMat3::from_quat(DQuat::from_euler(EulerRot::ZYX, z, y, x));
    let placed = own.into_iter();
    let placed: Vec<DVec3> = placed
        .map(|p| turn * (p * object.scale) + object.position)
        .collect();
    let low = placed.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let top = placed.iter().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let cell = ground.cell_at(object.position.truncate())?;
    let [floor, _] = heights(ground.chamber(cell));
    (low < floor + height && top > floor + flat).then(|| hull(&placed))
}

fn block(size: DVec3) -> Vec<DVec3> {
    let corner = |k: u32| {
        let at = |bit: u32| if k & bit == 0 { -0.5 } else { 0.5 };
        DVec3::new(at(1), at(2), at(4) + 0.5) * size
    };
    (0..8).map(corner).collect()
}

fn cylinder(radius: f64, low: f64, top: f64) -> Vec<DVec3> {
    let outer = radius / (std::f64::consts::PI / f64::from(ROUND)).cos();
    let corner =
        |k: u32| DVec2::from_angle(f64::from(k) / f64::from(ROUND) * std::f64::consts::TAU);
    (0..ROUND)
        .flat_map(|k| [low, top].map(|z| (corner(k) * outer).extend(z)))
        .collect()
}

/// Convex hull on the plan (A. M. Andrew's monotone chain).
fn hull(points: &[DVec3]) -> Vec<DVec2> {
    let mut sorted: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
    sorted.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    sorted.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - a) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    if hull.is_empty() { sorted } else { hull }
}

/// Whether a convex counterclockwise polygon holds a point.
pub fn within(polygon: &[DVec2], p: DVec2) -> bool {
    polygon.len() > 2
        && (0..polygon.len()).all(|i| {
            let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            (b - a).perp_dot(p - a) >= 0.0
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn buckets_find_what_all_lines_say() {
        let random = &mut Pcg64::seed_from_u64(3);
        let mut at = || {
            DVec2::new(
                random.random_range(-9.0..9.0),
                random.random_range(-9.0..9.0),
            )
        };
        for _ in 0..40 {
            let lines: Vec<[DVec2; 2]> = (0..12).map(|_| [at(), at()]).collect();
            let obstacles = Obstacles::new(lines.clone(), 1.5);
            for _ in 0..50 {
                let way = [at() * 1.2, at() * 1.2];
                let point = lines.iter().map(|l| to_line(way[0], *l).sqrt());
                let point = point.fold(1.5, f64::min);
                assert!((obstacles.distance(way[0]) - point).abs() < 1e-12);
                let least = lines.iter().map(|l| between(way, *l).sqrt());
                let least = least.fold(f64::INFINITY, f64::min);
                assert_eq!(obstacles.clear(way, 0.7), least > 0.7);
            }
        }
        let none = Obstacles::new(Vec::new(), 2.0);
        assert_eq!(none.distance(DVec2::X), 2.0);
        assert!(none.clear([DVec2::ZERO, DVec2::X], 1.0));
    }

    #[test]
    fn hulls_are_convex_and_hold_their_points() {
        let flat = |p: [f64; 2]| DVec2::from(p).extend(1.0);
        let points = [
            [0.0, 0.0],
            [2.0, 0.0],
            [1.0, 0.5],
            [2.0, 2.0],
            [0.0, 2.0],
            [1.0, 0.0],
        ];
        let points = points.map(flat);
        let hull = hull(&points);
        assert_eq!(hull.len(), 4);
        assert!(points.iter().all(|p| within(&hull, p.truncate())));
        assert!(!within(&hull, DVec2::new(2.1, 1.0)));
        // A flat thing is a line, and has no inside.
        let pane = super::hull(&[flat([0.0, 0.0]), flat([1.0, 1.0]), flat([0.5, 0.5])]);
        assert_eq!(pane, [DVec2::ZERO, DVec2::ONE]);
        assert!(!within(&pane, DVec2::ZERO));
    }
}
