use super::super::finding::Place;
use super::super::model::{Opening, OpeningStyle, WallKind};
use super::super::scene::Scene;
use super::*;

fn wall(from: [f64; 2], to: [f64; 2]) -> DraftWall {
    DraftWall {
        from: from.into(),
        to: to.into(),
        written: [true, true],
        kind: WallKind::Solid,
        left: None,
        right: None,
        outline: None,
        material: None,
        place: Place::Text { line: 1, column: 1 },
    }
}

fn draft(numbers: Numbers, walls: Vec<DraftWall>) -> Draft {
    Draft {
        name: "test".into(),
        source: "test.toml".into(),
        unit: "m".into(),
        numbers,
        walls,
        sectors: Vec::new(),
        outlines: Vec::new(),
        interior: DraftInterior::Enclosed { starts: Vec::new() },
        scene: Scene::default(),
        findings: Vec::new(),
    }
}

fn codes(level: &Level) -> Vec<&'static str> {
    level.findings.iter().map(|f| f.code).collect()
}

#[test]
fn decimals_are_exact_and_unchanged() {
    let walls = vec![
        wall([0.1, 0.2], [500.3, 0.7]),
        wall([500.3, 0.7], [3.24159, -2.81828]),
    ];
    let level = snap(draft(Numbers::Decimal, walls.clone())).unwrap();
    assert_eq!(level.grid.step, Step::Decimal(5));
    assert_eq!(level.snap, 0.0);
    assert_eq!(level.findings, []);
    assert_eq!(level.n_vertices, 3);
    for (wall, draft) in level.walls.iter().zip(&walls) {
        assert_eq!(level.grid.to_level(wall.from), draft.from);
        assert_eq!(level.grid.to_level(wall.to), draft.to);
    }
}

#[test]
fn doom_coordinates_get_step_one_and_fractions_a_finer_one() {
    let level = snap(draft(Numbers::Binary, vec![wall([0., 0.], [4096., -128.])])).unwrap();
    assert_eq!(level.grid.step, Step::Binary(0));
    let level = snap(draft(Numbers::Binary, vec![wall([0.125, 0.], [64., 8.])])).unwrap();
    assert_eq!(level.grid.step, Step::Binary(3));
    let level = snap(draft(Numbers::Binary, vec![wall([0.1, 0.], [64.3, 8.])])).unwrap();
    assert_eq!(level.grid.step, Step::Decimal(4));
    assert_eq!(level.snap, 0.0);
}

#[test]
fn a_level_far_away_has_the_same_grid_points() {
    let shape = [[0.1, 0.2], [7.3, 0.2], [5.25, 4.125], [0.1, 0.2]];
    let at = |d: f64| {
        let text = |v: f64| format!("{}", v + d).parse::<f64>().unwrap();
        // Written the way a file would have it: the decimal sum, not the f64 sum.
        let moved = |p: [f64; 2]| p.map(|v| (text(v) * 1e4).round() / 1e4);
        let walls = shape.windows(2).map(|w| wall(moved(w[0]), moved(w[1])));
        snap(draft(Numbers::Decimal, walls.collect())).unwrap()
    };
    let home = at(0.0);
    for distance in [1e6, 1e9, -1e9] {
        let away = at(distance);
        assert_eq!(away.walls, home.walls, "moved by {distance}");
        assert_eq!(away.snap, 0.0);
        assert_eq!(away.grid.step, home.grid.step);
    }
}

#[test]
fn an_opening_on_a_slanted_wall_stays_on_it() {
    let (a, b) = (DVec2::new(0.0, 0.0), DVec2::new(7.0, 3.0));
    let along = (b - a).normalize();
    let mut opening = wall([0., 0.], [1., 1.]);
    opening.from = a + along * 2.0;
    opening.to = a + along * 3.0;
    opening.written = [false, false];
    opening.kind = WallKind::Opening(Opening {
        style: OpeningStyle::Door,
        name: None,
        shut: true,
        bottom: None,
        top: None,
    });
    let walls = vec![
        wall([0., 0.], [7., 3.]),
        wall([7., 3.], [0., 3.]),
        wall([0., 3.], [0., 0.]),
        opening,
    ];
    let level = snap(draft(Numbers::Decimal, walls)).unwrap();
    assert_eq!(codes(&level), ["snapped", "joined"]);
    assert_eq!(level.findings[1].severity, Severity::Note);
    assert_eq!(level.findings[1].places.len(), 2);
    assert_eq!(level.walls.len(), 6, "the slanted wall became three");
    let door = &level.walls[5];
    assert_eq!(
        (level.walls[1].from, level.walls[1].to),
        (door.from, door.to)
    );
    assert!(level.snap > 0.0 && level.snap < 1e-4);
}

#[test]
fn coordinates_with_too_many_digits_are_snapped_and_joined() {
    let third = 1.0 / 3.0;
    // The end of the second wall lies on the first, up to f64.
    let walls = vec![
        wall([0., 0.], [1000., 1000. * third]),
        wall([100., 100. * third], [100., 500.]),
    ];
    let level = snap(draft(Numbers::Decimal, walls)).unwrap();
    assert_eq!(level.grid.step, Step::Decimal(4));
    assert_eq!(codes(&level), ["snapped", "joined"]);
    assert_eq!(level.findings[1].severity, Severity::Repaired);
    assert_eq!(level.walls.len(), 3);
    assert_eq!(level.walls[0].to, level.walls[2].from);
    assert_eq!(level.walls[1].from, level.walls[2].from);
}

#[test]
fn exact_near_misses_are_left_alone() {
    // A hundred-thousandth off a wall, but written so: the step is that hundred-thousandth.
    let walls = vec![wall([0., 0.], [10., 0.]), wall([5., 0.00001], [5., 4.])];
    let level = snap(draft(Numbers::Decimal, walls)).unwrap();
    assert_eq!(codes(&level), [""; 0]);
    assert_eq!(level.walls.len(), 2);
}

#[test]
fn points_that_coincided_round_the_same_way() {
    let mut second = wall([1., 1.], [2., 2.]);
    second.from = DVec2::new(0.333_350_000_000_01, 0.0);
    let mut first = wall([0., 0.], [1., 1.]);
    first.to = DVec2::new(0.333_349_999_999_99, 0.0);
    first.written = [true, false];
    second.written = [false, true];
    let level = snap(draft(Numbers::Decimal, vec![first, second])).unwrap();
    assert_eq!(level.walls[0].to, level.walls[1].from);
}

#[test]
fn walls_without_length_are_dropped_and_no_walls_are_an_error() {
    let walls = vec![wall([1., 1.], [1., 1.]), wall([0., 0.], [1., 0.])];
    let level = snap(draft(Numbers::Decimal, walls)).unwrap();
    assert_eq!(codes(&level), ["zero-length-wall"]);
    assert_eq!(level.walls.len(), 1);
    assert_eq!(
        snap(draft(Numbers::Decimal, vec![])).unwrap_err(),
        SnapError::Empty
    );
    let collapsed = vec![wall([0.0, 0.0], [0.0, 0.0])];
    assert_eq!(
        snap(draft(Numbers::Decimal, collapsed)).unwrap_err(),
        SnapError::Empty
    );
}

#[test]
fn a_wide_extent_gets_the_finest_step_that_fits() {
    // 10 km with millimetres fits 10^-3 only.
    let level = snap(draft(
        Numbers::Decimal,
        vec![wall([0., 0.], [10_000.123, 5.])],
    ))
    .unwrap();
    assert_eq!(level.grid.step, Step::Decimal(3));
    assert_eq!(level.snap, 0.0);
    // With five decimals it does not fit: snapped and said so.
    let level = snap(draft(
        Numbers::Decimal,
        vec![wall([0., 0.], [10_000.123_45, 5.])],
    ))
    .unwrap();
    assert_eq!(level.grid.step, Step::Decimal(3));
    assert!((level.snap - 0.00045).abs() < 1e-9);
    assert_eq!(codes(&level), ["snapped"]);
}

#[test]
fn the_limit_of_the_grid() {
    let widest = 2.0 * (GRID_LIMIT - 1) as f64;
    for (width, step) in [
        (widest, Step::Binary(0)),
        (widest + 1.0, Step::Binary(-1)),
        (widest + 2.0, Step::Binary(-1)),
    ] {
        let level = snap(draft(
            Numbers::Binary,
            vec![wall([7., 0.], [7. + width, 1.])],
        ))
        .unwrap();
        assert_eq!(level.grid.step, step, "{width}");
        for p in level.walls.iter().flat_map(|w| [w.from, w.to]) {
            assert!(p.x.abs() < GRID_LIMIT && p.y.abs() < GRID_LIMIT);
        }
    }
}

#[test]
fn impossible_coordinates_are_errors_with_their_place() {
    let place = Place::Text { line: 1, column: 1 };
    for value in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let walls = vec![wall([0., 0.], [value, 1.])];
        let error = snap(draft(Numbers::Decimal, walls)).unwrap_err();
        assert!(matches!(error, SnapError::NotFinite { .. }), "{value}");
        assert_eq!(error.place(), Some(place));
    }
    for value in [UNIT_LIMIT, 1e300] {
        let error = snap(draft(Numbers::Decimal, vec![wall([0., 0.], [value, 1.])])).unwrap_err();
        assert_eq!(error, SnapError::TooLarge { place, value });
    }
    // 10^13 m away, f64 can still hold millimetres, but not exactly on any decimal step.
    let far = vec![wall([1e13, 0.], [1e13 + 3.123, 1.])];
    let error = snap(draft(Numbers::Decimal, far)).unwrap_err();
    assert!(matches!(error, SnapError::TooFar { .. }));
    let far_but_whole = vec![wall([1e13, 0.], [1e13 + 3.0, 1.])];
    assert_eq!(
        snap(draft(Numbers::Decimal, far_but_whole)).unwrap().snap,
        0.0
    );
}

#[test]
fn start_points_must_be_between_the_walls() {
    let mut level = draft(Numbers::Decimal, vec![wall([0., 0.], [4., 4.])]);
    level.interior = DraftInterior::Enclosed {
        starts: vec![DVec2::new(1.0, 2.0)],
    };
    let finished = snap(level.clone()).unwrap();
    let Interior::Enclosed { starts } = &finished.interior else {
        panic!()
    };
    assert_eq!(finished.grid.to_level(starts[0]), DVec2::new(1.0, 2.0));
    level.interior = DraftInterior::Enclosed {
        starts: vec![DVec2::new(9.0, 2.0)],
    };
    assert!(matches!(snap(level), Err(SnapError::StartOutside { .. })));
}

#[test]
fn ten_thousand_slanted_walls_are_fast() {
    let n = 10_000;
    let walls = (0..n).map(|i| {
        let (x, y) = ((i % 100) as f64 / 3.0, (i / 100) as f64 / 7.0);
        wall([x, y], [x + 0.31, y + 0.17])
    });
    let start = std::time::Instant::now();
    let level = snap(draft(Numbers::Decimal, walls.collect())).unwrap();
    assert_eq!(level.walls.len(), n);
    assert!(start.elapsed().as_secs() < 5);
}
