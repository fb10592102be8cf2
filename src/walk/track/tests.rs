use super::*;
use crate::cells::{CellGraph, Options, subdivide};
use crate::trace::Space;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const STEPS: &str = "[defaults]\nceiling = 6\n[[room]]\nname = 'R'\nrect = [0, 0, 20, 4]\n\
    [[zone]]\nrect = [8, 0, 9, 4]\nfloor = 0.2\n[[zone]]\nrect = [9, 0, 10, 4]\nfloor = 0.4\n\
    [[zone]]\nrect = [10, 0, 14, 4]\nfloor = 0.6\n";

fn level() -> (CellGraph, Space) {
    let level = crate::level::toml::read(STEPS, "steps.toml").unwrap();
    let graph = subdivide(&level, &Options::default());
    let space = Space::new(&level, &graph);
    (graph, space)
}

fn path(points: Vec<DVec3>) -> CameraPath {
    CameraPath {
        name: "p".into(),
        points,
        eye: None,
        closed: false,
        look: PathLook::Ahead,
        pace: PathPace::Speed(1.4),
        fov: 60.0,
    }
}

/// Length of the way between two moments, of many short steps.
fn length(track: &Track, from: f64, to: f64) -> f64 {
    const PARTS: u32 = 4000;
    let at = |i: u32| {
        track
            .at(from + (to - from) * f64::from(i) / f64::from(PARTS))
            .eye
    };
    (0..PARTS).map(|i| at(i).distance(at(i + 1))).sum()
}

#[test]
fn equal_times_are_equal_lengths_and_no_turn_is_too_fast() {
    let (graph, space) = level();
    let ground = Ground::new(&graph, &space);
    let random = &mut Pcg64::seed_from_u64(11);
    for round in 0..60 {
        let mut at = || random.random_range(-15.0..15.0);
        let mut points: Vec<DVec3> = (0..7).map(|_| DVec3::new(at(), at(), at() / 8.0)).collect();
        points.truncate(2 + round % 6);
        let path = CameraPath {
            closed: round % 3 == 2,
            ..path(points)
        };
        let options = TrackOptions::default();
        let track = Track::new(&path, &ground, &options);
        let n = 6;
        let lengths = (0..n).map(|i| {
            let at = |i: u32| track.seconds() * f64::from(i) / f64::from(n);
            length(&track, at(i), at(i + 1))
        });
        let whole = track.seconds() / f64::from(n) * 1.4;
        for length in lengths {
            assert!((length / whole - 1.0).abs() < 1e-3, "{length} of {whole}");
        }
        // In straight lines from frame to frame, only bends cut something off.
        let frames = (track.seconds() * 30.0) as u32;
        let pose = |i: u32| track.at(f64::from(i) / 30.0);
        for i in 0..frames {
            let (a, b) = (pose(i), pose(i + 1));
            assert!(a.eye.distance(b.eye) < 1.4 / 30.0 * 1.000_001);
            let turn = a.direction.angle_between(b.direction).to_degrees();
            assert!(turn <= options.turn / 30.0 * 1.001, "{turn} in a frame");
            assert!((a.direction.length() - 1.0).abs() < 1e-9);
        }
        if path.closed {
            let (first, last) = (pose(0), track.at(track.seconds()));
            assert!(first.eye.distance(last.eye) < 1e-9);
            assert!(first.direction.angle_between(last.direction) < 1e-6);
            let lap = track.at(track.seconds() * 1.25);
            assert!(lap.eye.distance(track.at(track.seconds() * 0.25).eye) < 1e-9);
        }
    }
}

#[test]
fn a_straight_way_is_walked_at_exactly_its_speed() {
    let (graph, space) = level();
    let ground = Ground::new(&graph, &space);
    let two = path(vec![DVec3::new(1.0, 1.0, 1.6), DVec3::new(8.0, 1.0, 1.6)]);
    let track = Track::new(&two, &ground, &TrackOptions::default());
    assert!((track.seconds() - 5.0).abs() < 1e-9);
    assert!((track.at(2.5).eye.x - 4.5).abs() < 1e-9);
    assert_eq!(track.at(-1.0).eye, two.points[0]);
    assert_eq!(track.at(99.0).eye, two.points[1]);
    assert!(track.at(3.0).direction.distance(DVec3::X) < 1e-12);
    let timed = CameraPath {
        pace: PathPace::Seconds(3.0),
        look: PathLook::At(DVec3::new(4.5, 9.0, 1.6)),
        ..two
    };
    let track = Track::new(&timed, &ground, &TrackOptions::default());
    assert_eq!(track.seconds(), 3.0);
    assert!(track.at(1.5).direction.distance(DVec3::Y) < 1e-9);
}

#[test]
fn who_goes_nowhere_stands_still() {
    let (graph, space) = level();
    let ground = Ground::new(&graph, &space);
    let options = TrackOptions::default();
    for points in [vec![DVec3::ONE], vec![DVec3::ONE; 3], vec![]] {
        for closed in [false, true] {
            let there = CameraPath {
                closed,
                ..path(points.clone())
            };
            let track = Track::new(&there, &ground, &options);
            assert_eq!(track.seconds(), 0.0);
            let pose = track.at(1.0);
            assert_eq!(pose.eye, points.first().copied().unwrap_or_default());
            assert_eq!(pose.direction, DVec3::X);
            let waiting = CameraPath {
                pace: PathPace::Seconds(2.0),
                look: PathLook::At(pose.eye),
                ..there
            };
            let track = Track::new(&waiting, &ground, &options);
            assert_eq!((track.seconds(), track.at(1.0)), (2.0, pose));
        }
    }
}

#[test]
fn the_eye_follows_the_floor_smoothly() {
    let (graph, space) = level();
    let ground = Ground::new(&graph, &space);
    let stairs = CameraPath {
        eye: Some(1.6),
        ..path(vec![DVec3::new(1.0, 2.0, 0.0), DVec3::new(19.0, 2.0, 0.0)])
    };
    let track = Track::new(&stairs, &ground, &TrackOptions::default());
    let z_at = |x: f64| {
        let nearest = track.points().iter();
        let nearest = nearest.min_by(|p, q| (p.x - x).abs().total_cmp(&(q.x - x).abs()));
        nearest.unwrap().z
    };
    assert!((z_at(4.0) - 1.6).abs() < 1e-9 && (z_at(12.0) - 2.2).abs() < 1e-9);
    assert!((z_at(18.0) - 1.6).abs() < 1e-9);
    assert!(z_at(8.9) > 1.7 && z_at(8.9) < 2.0);
    for pair in track.points().windows(2) {
        // A step of 0.2 is spread over 0.9 and more of the way, the drop of 0.6 just so.
        let slope = (pair[1].z - pair[0].z).abs() / (pair[1].x - pair[0].x);
        assert!(slope < 0.75, "{pair:?}");
    }
}
