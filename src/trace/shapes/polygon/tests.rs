use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::super::cases::ray;
use super::*;

fn polygon(corners: &[[f64; 3]]) -> Polygon {
    Polygon::new(corners.iter().map(|&p| p.into()).collect()).unwrap()
}

/// When a ray meets it, by both methods, which must agree.
fn hit(p: &Polygon, origin: [f64; 3], direction: [f64; 3]) -> Option<f64> {
    let cast = Cast::new(ray(origin, direction));
    let one = p.pierce(&cast);
    let other = Polygon {
        method: Method::Marchal,
        ..p.clone()
    };
    assert_eq!(one, other.pierce(&cast));
    one
}

/// x + z = 4 over the square 0 ≤ x, y ≤ 2.
fn slanted() -> Polygon {
    polygon(&[
        [0.0, 0.0, 4.0],
        [2.0, 0.0, 2.0],
        [2.0, 2.0, 2.0],
        [0.0, 2.0, 4.0],
    ])
}

/// An L of five unit squares, two arms of length 3, in the plane z = 1.
fn corner() -> Polygon {
    polygon(&[
        [0.0, 0.0, 1.0],
        [3.0, 0.0, 1.0],
        [3.0, 1.0, 1.0],
        [1.0, 1.0, 1.0],
        [1.0, 3.0, 1.0],
        [0.0, 3.0, 1.0],
    ])
}

#[test]
fn through_beside_behind() {
    let p = slanted();
    assert_eq!(hit(&p, [1.0, 0.5, 0.0], [0.0, 0.0, 2.0]), Some(1.5));
    assert_eq!(hit(&p, [1.0, 0.5, 9.0], [0.0, 0.0, -1.0]), Some(6.0));
    assert_eq!(hit(&p, [1.0, 0.5, 9.0], [0.0, 0.0, 1.0]), Some(-6.0));
    assert_eq!(hit(&p, [2.1, 0.5, 0.0], [0.0, 0.0, 1.0]), None);
    assert_eq!(hit(&p, [1.0, -0.1, 0.0], [0.0, 0.0, 1.0]), None);
    // x = t, z = t meets it at 2.
    assert_eq!(hit(&p, [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]), Some(2.0));
    let unit = DVec3::new(1.0, 0.0, 1.0).normalize();
    assert!((p.normal() - unit).length() < 1e-15);
}

#[test]
fn parallel_rays_miss_even_in_the_plane() {
    let p = corner();
    assert_eq!(hit(&p, [-1.0, 0.5, 1.0], [1.0, 0.0, 0.0]), None);
    assert_eq!(hit(&p, [-1.0, 0.5, 1.5], [1.0, 0.0, 0.0]), None);
}

#[test]
fn a_million_away() {
    let far = |v: [f64; 3]| v.map(|x| x + 1e6);
    let p = polygon(&[[0.0, 0.0, 4.0], [2.0, 0.0, 2.0], [2.0, 2.0, 2.0]].map(far));
    let t = hit(&p, far([1.0, 0.5, 0.0]), [0.0, 0.0, 2.0]).unwrap();
    assert!((t - 1.5).abs() < 1e-14, "{t}");
    let t = hit(&slanted(), [1.0, 0.5, -1e6], [0.0, 0.0, 1.0]).unwrap();
    assert!((t - (1e6 + 3.0)).abs() < 3e-10, "{t}");
}

#[test]
fn an_l_has_an_inner_corner() {
    let p = corner();
    let inside = |x, y| hit(&p, [x, y, 0.0], [0.0, 0.0, 1.0]).is_some();
    for (x, y) in [(0.5, 0.5), (2.5, 0.5), (0.5, 2.5), (0.2, 0.9), (0.9, 0.2)] {
        assert!(inside(x, y), "{x} {y}");
    }
    for (x, y) in [
        (1.5, 1.5),
        (2.0, 1.1),
        (1.1, 2.0),
        (2.9, 2.9),
        (-0.1, 0.5),
        (3.1, 0.5),
    ] {
        assert!(!inside(x, y), "{x} {y}");
    }
    assert_eq!(p.triangles.len(), 4);
}

#[test]
fn marchal_s_numbers() {
    // The slide's case, a triangle (0,0), (4,0), (0,4) and I = (1, 2): the axis y = 2x meets the
    // edge from (4, 0) to (0, 4) at M = (4/3, 8/3), two thirds along it, and P0I / P0M = 3/4.
    let flat = [DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(0.0, 4.0)];
    let weights = marchal::weights(&flat, DVec2::new(1.0, 2.0)).unwrap();
    let of = |i: u32| -> f64 { weights.iter().filter(|w| w.0 == i).map(|w| w.1).sum() };
    assert!((of(0) - 0.25).abs() < 1e-15);
    assert!((of(1) - 0.25).abs() < 1e-15);
    assert!((of(2) - 0.5).abs() < 1e-15);
    // Behind P0 the axis would meet the edge at λ < 0; beyond M, λ < 1.
    assert_eq!(marchal::weights(&flat, DVec2::new(-1.0, -2.0)), None);
    assert_eq!(marchal::weights(&flat, DVec2::new(2.0, 4.0)), None);
    assert!(marchal::weights(&flat, DVec2::ZERO).is_some());
}

#[test]
fn normals_and_texture_are_interpolated() {
    let p = slanted()
        .with_normals(vec![DVec3::X, DVec3::X, DVec3::Z, DVec3::Z])
        .unwrap()
        .with_uv(vec![DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y])
        .unwrap();
    for method in [Method::Barycentric, Method::Marchal] {
        let p = Polygon {
            method,
            ..p.clone()
        };
        let (surface, mixed) = p.surface(DVec3::new(0.5, 1.5, 3.5));
        assert!((surface.uv - DVec2::new(0.25, 0.75)).length() < 1e-15);
        assert!(
            (mixed - DVec3::new(0.25, 0.0, 0.75)).length() < 1e-15,
            "{method:?}"
        );
        assert!((surface.point - DVec3::new(0.5, 1.5, 3.5)).length() < 1e-15);
    }
    // By default lengths: along the first edge, whose length is 2√2, and across.
    let (surface, _) = slanted().surface(DVec3::new(1.0, 0.5, 3.0));
    assert!((surface.uv - DVec2::new(2f64.sqrt(), 0.5)).length() < 1e-15);
}

#[test]
fn what_is_no_polygon() {
    let error = |corners: &[[f64; 3]]| {
        Polygon::new(corners.iter().map(|&p| p.into()).collect()).unwrap_err()
    };
    let (o, x, y) = ([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    assert_eq!(error(&[o, x]), PolygonError::TooFew);
    assert_eq!(error(&[o, x, x]), PolygonError::Repeated(1));
    assert_eq!(error(&[o, x, [2.0, 0.0, 0.0]]), PolygonError::NoArea);
    assert_eq!(error(&[o, x, [f64::NAN; 3]]), PolygonError::NotFinite(2));
    let PolygonError::NotPlane(_) = error(&[o, x, [1.0, 1.0, 0.5], y]) else {
        panic!("a twisted square");
    };
    // A bow, and an edge that turns back.
    let bow = [o, [3.0, 3.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    assert_eq!(error(&bow), PolygonError::Crossing(0, 2));
    let back = [o, [3.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]];
    assert_eq!(error(&back), PolygonError::Crossing(0, 1));
    let touching = [
        o,
        [4.0, 0.0, 0.0],
        [4.0, 2.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
    ];
    assert_eq!(error(&touching), PolygonError::Crossing(0, 2));
    assert_eq!(
        slanted().with_uv(vec![]).unwrap_err(),
        PolygonError::Count(0, 4)
    );
}

/// Star-shaped polygons, seldom convex, somewhere in space: the methods agree on every point except
/// next to an edge, and give the same values on triangles.
#[test]
fn both_methods_agree_on_random_polygons() {
    let mut random = Pcg64::seed_from_u64(11);
    let (mut inside, mut outside, mut concave) = (0, 0, 0);
    for round in 0..2000 {
        let n = random.random_range(3..9);
        let turn = glam::DQuat::from_euler(
            glam::EulerRot::ZYX,
            random.random_range(0.0..6.0),
            random.random_range(0.0..6.0),
            random.random_range(0.0..6.0),
        );
        let far = DVec3::splat(if round % 3 == 0 { 1e6 } else { 0.0 });
        let corners: Vec<DVec3> = (0..n)
            .map(|i| {
                let (y, x) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
                turn * (DVec3::new(x, y, 0.0) * random.random_range(0.3..2.0)) + far
            })
            .collect();
        let Ok(p) = Polygon::new(corners.clone()) else {
            panic!("round {round}: {corners:?}");
        };
        concave += usize::from(p.triangles.iter().any(|t| t[0] != 0));
        let other = Polygon {
            method: Method::Marchal,
            ..p.clone()
        };
        for _ in 0..50 {
            let at = DVec3::new(
                random.random_range(-2.0..2.0),
                random.random_range(-2.0..2.0),
                0.0,
            );
            let at = turn * at + far;
            let edge = (0..n)
                .map(|i| distance(at, corners[i], corners[(i + 1) % n]))
                .fold(f64::INFINITY, f64::min);
            if edge < 1e-9 {
                continue;
            }
            let (one, two) = (p.weights(at), other.weights(at));
            assert_eq!(
                one.is_some(),
                two.is_some(),
                "round {round}, {edge} from the edge"
            );
            let (Some(one), Some(two)) = (one, two) else {
                outside += 1;
                continue;
            };
            inside += 1;
            for weights in [&one, &two] {
                // Both are affine: they give the point itself back.
                let back: DVec3 = weights
                    .iter()
                    .map(|&(i, w)| (corners[i as usize] - far) * w)
                    .sum();
                assert!((back + far - at).length() < 1e-8, "round {round}");
            }
        }
    }
    assert!(inside > 10_000 && outside > 10_000 && concave > 500);
}

/// From a point to a segment.
fn distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a.lerp(b, along))
}
