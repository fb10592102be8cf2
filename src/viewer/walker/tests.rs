use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;
use crate::cells::{Doors, Options, subdivide};
use crate::viewer::sample::Sample;
use crate::walk::opened;

const FRAME: f64 = 1.0 / 60.0;

struct Course {
    sample: Sample,
    footing: Footing,
}

impl Course {
    fn new(sample: Sample) -> Self {
        let person = Person::of_unit(&sample.level.unit);
        let footing = Footing::new(&sample.level, &sample.graph, &sample.world.space, &person);
        Self { sample, footing }
    }

    fn of(text: &str, doors: Doors) -> Self {
        Self::new(Sample::of(text, doors))
    }

    fn site(&self) -> Site<'_> {
        Site {
            graph: &self.sample.graph,
            space: &self.sample.world.space,
            footing: &self.footing,
        }
    }

    fn at(&self, at: [f64; 2], yaw: f64) -> Walker {
        let mut walker = Walker::new(DVec3::ZERO, DVec2::from_angle(yaw).extend(0.0), Mode::Walk);
        assert!(walker.stand(at.into(), &self.site()));
        walker
    }

    /// Walks ahead for some seconds.
    fn ahead(&self, walker: &mut Walker, seconds: f64) {
        let input = Input {
            forward: 1.0,
            ..Input::default()
        };
        for _ in 0..(seconds / FRAME) as u32 {
            walker.step(&input, FRAME, &self.site());
        }
    }

    /// Distance of the nearest wall from floor to ceiling, by asking all.
    fn clearance(&self, at: DVec2) -> f64 {
        let space = &self.sample.world.space;
        let walls = space.edges.iter().filter(|e| e.twin == WALL);
        let lines = walls.map(|e| [space.vertex(e.from), space.vertex(e.to)]);
        lines
            .map(|line| nearest(at, line).distance(at))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Wanders about, running, and bumping into everything. How many cells he has been in.
fn wander(name: &str, course: &Course, start: DVec3, seed: u64) -> usize {
    let (site, random) = (course.site(), &mut Pcg64::seed_from_u64(seed));
    let mut walker = Walker::new(start, DVec3::X, Mode::Walk);
    let radius = course.footing.person.radius;
    let mut clear = course.clearance(start.truncate());
    let mut been = vec![false; course.sample.graph.cells.len()];
    let mut way = 0.0;
    let mut input = Input::default();
    for step in 0..10_000 {
        if step % 40 == 0 {
            input = Input {
                forward: random.random_range(0.2..1.0),
                right: random.random_range(-0.6..0.6),
                run: random.random::<f64>() < 0.7,
                turn: random.random_range(-0.4..0.4),
                ..Input::default()
            };
            // Off whatever he runs against, or along.
            if !walker.moves() || random.random::<f64>() < 0.3 {
                input.look.x = random.random_range(-3.0..3.0);
            }
        } else {
            input.look = DVec2::ZERO;
        }
        let before = walker.eye;
        walker.step(&input, random.random_range(0.002..0.1), &site);
        let at = walker.eye.truncate();
        let cell = site.cell_at(at).expect("he is in the level");
        been[cell.0 as usize] = true;
        let fits = site.cells_at(at).iter().any(|c| {
            let [floor, ceiling] = heights(site.space.cell(c.0));
            floor < walker.eye.z && walker.eye.z < ceiling
        });
        assert!(
            fits,
            "{name}: {:?} is in the floor or the ceiling",
            walker.eye
        );
        let now = course.clearance(at);
        let least = radius.min(clear) - radius * 1e-6;
        assert!(
            now >= least,
            "{name}: {before} to {at}: {now} from a wall, it was {clear}"
        );
        clear = now;
        way += before.truncate().distance(at);
    }
    let n = been.iter().filter(|b| **b).count();
    println!(
        "{name}: {way:.0} walked through {n} of {} cells",
        been.len()
    );
    n
}

#[test]
fn nobody_leaves_the_museum() {
    let course = Course::new(Sample::named("museum"));
    let camera = &course.sample.level.scene.cameras[0];
    let n = wander("museum", &course, camera.eye, 1);
    assert!(n > 20, "{n} cells");
}

#[test]
fn nobody_leaves_a_doom_map() {
    let Some(mut sample) = Sample::freedoom("E1M1") else {
        return;
    };
    // With its doors open, or he stays in the first room.
    let person = Person::of_unit(&sample.level.unit);
    sample.level = opened(&sample.level, &person);
    sample.graph = subdivide(&sample.level, &Options::default());
    sample.world.space = Space::new(&sample.level, &sample.graph);
    let course = Course::new(sample);
    let camera = &course.sample.level.scene.cameras[0];
    let n = wander("E1M1", &course, camera.eye, 1);
    assert!(n > 20, "{n} cells");
}

const ROOM: &str = r#"
name = "Room"
unit = "m"
[[room]]
name = "Room"
rect = [0, 0, 20, 4]
ceiling = 3
"#;

#[test]
fn he_slides_along_a_wall() {
    let course = Course::of(ROOM, Doors::Open);
    let radius = course.footing.person.radius;
    let mut walker = course.at([2.0, 2.0], 0.8);
    course.ahead(&mut walker, 3.0);
    let here = walker.eye;
    // At the wall, as near as a body goes.
    assert!((here.y - (4.0 - radius)).abs() < 1e-6, "{here}");
    course.ahead(&mut walker, 1.0);
    let way = walker.eye - here;
    let pace = course.footing.person.speed * PACE;
    assert!(way.y.abs() < 1e-6);
    assert!((way.x / (pace * 0.8f64.cos()) - 1.0).abs() < 0.05, "{way}");
    // Into the corner, and no farther; then away again.
    course.ahead(&mut walker, 15.0);
    let corner = DVec2::new(20.0 - radius, 4.0 - radius);
    assert!(
        walker.eye.truncate().distance(corner) < 1e-6,
        "{}",
        walker.eye
    );
    walker.yaw += PI;
    course.ahead(&mut walker, 1.0);
    assert!(walker.eye.truncate().distance(corner) > 1.0);
}

#[test]
fn a_start_at_a_wall_is_a_start() {
    let course = Course::of(ROOM, Doors::Open);
    let mut walker = course.at([0.05, 2.0], PI);
    course.ahead(&mut walker, 0.5);
    assert!((walker.eye.x - 0.05).abs() < 1e-9, "{}", walker.eye);
    walker.yaw = 0.0;
    course.ahead(&mut walker, 1.0);
    assert!(walker.eye.x > 1.5, "{}", walker.eye);
}

/// A corridor with a step of some height in its middle.
fn stairs(height: f64) -> Course {
    let text =
        format!("{ROOM}\n[[zone]]\nname = \"Step\"\nrect = [10, 0, 20, 4]\nfloor = {height}\n");
    Course::of(&text, Doors::Open)
}

#[test]
fn he_climbs_a_step_as_high_as_a_step_and_no_higher() {
    for (height, climbs) in [(0.2, true), (0.4, true), (0.41, false), (1.0, false)] {
        let course = stairs(height);
        let mut walker = course.at([7.0, 2.0], 0.0);
        course.ahead(&mut walker, 3.0);
        assert_eq!(walker.eye.x > 11.0, climbs, "{height}: {}", walker.eye);
        let floor = if climbs { height } else { 0.0 };
        let eye = floor + course.footing.person.eye;
        assert!(
            (walker.eye.z - eye).abs() < 1e-3,
            "{height}: {}",
            walker.eye
        );
        if !climbs {
            let radius = course.footing.person.radius;
            assert!((walker.eye.x - (10.0 - radius)).abs() < 1e-6);
        }
        // From above: no drop that he could not climb back.
        let mut walker = course.at([13.0, 2.0], PI);
        course.ahead(&mut walker, 3.0);
        assert_eq!(walker.eye.x < 9.0, climbs, "{height}: {}", walker.eye);
    }
}

#[test]
fn the_eye_rises_smoothly() {
    let course = stairs(0.4);
    let mut walker = course.at([9.0, 2.0], 0.0);
    let input = Input {
        forward: 1.0,
        ..Input::default()
    };
    let mut most: f64 = 0.0;
    for _ in 0..120 {
        let z = walker.eye.z;
        walker.step(&input, FRAME, &course.site());
        most = most.max(walker.eye.z - z);
    }
    assert!(walker.eye.z > 1.99 && most < 0.1, "{} {most}", walker.eye);
}

const ROOMS: &str = r#"
name = "Rooms"
unit = "m"
[[room]]
name = "West"
rect = [0, 0, 6, 4]
ceiling = 3
[[room]]
name = "East"
rect = [6, 0, 12, 4]
ceiling = 3
[[door]]
between = ["West", "East"]
"#;

#[test]
fn he_passes_doors_that_are_open_wide_and_high() {
    let walk = |door: &str, doors| {
        let course = Course::of(&format!("{ROOMS}{door}\n"), doors);
        let mut walker = course.at([3.0, 2.1], 0.0);
        course.ahead(&mut walker, 3.0);
        walker.eye.x
    };
    let open = "width = 1\nheight = 2.1\nstate = \"open\"";
    assert!(walk(open, Doors::Closed) > 9.0);
    let shut = "width = 1\nheight = 2.1\nstate = \"closed\"";
    assert!(walk(shut, Doors::Closed) < 5.8);
    assert!(walk(shut, Doors::Open) > 9.0, "as the cells have it");
    assert!(
        walk("width = 1\nheight = 1.7", Doors::Open) < 5.8,
        "too low"
    );
    assert!(
        walk("width = 0.5\nheight = 2.1", Doors::Open) < 6.0,
        "too narrow"
    );
}

#[test]
fn he_goes_around_things() {
    let text = format!(
        "{ROOM}\n[[object]]\nname = \"Crate\"\nkind = \"box\"\nsize = [1, 1, 1]\nposition = [8, 2, 0]\n"
    );
    let course = Course::of(&text, Doors::Open);
    let radius = course.footing.person.radius;
    let mut walker = course.at([4.0, 2.0], 0.0);
    course.ahead(&mut walker, 4.0);
    assert!(
        (walker.eye.x - (7.5 - radius)).abs() < 1e-6,
        "{}",
        walker.eye
    );
    // A little aside, he slides past.
    walker.yaw = 0.5;
    course.ahead(&mut walker, 4.0);
    assert!(walker.eye.x > 9.0, "{}", walker.eye);
}

#[test]
fn who_flies_goes_through_walls_and_comes_back() {
    let course = Course::of(ROOM, Doors::Open);
    let mut walker = course.at([2.0, 2.0], PI / 2.0);
    walker.mode = Mode::Fly;
    course.ahead(&mut walker, 3.0);
    assert!(course.site().cell_at(walker.eye.truncate()).is_none());
    let up = Input {
        up: 1.0,
        ..Input::default()
    };
    (0..60).for_each(|_| walker.step(&up, FRAME, &course.site()));
    assert!(walker.eye.z > 3.0, "{}", walker.eye);
    // On foot again: nothing holds him outside, and the floor has him inside.
    walker.mode = Mode::Walk;
    walker.yaw = -PI / 2.0;
    course.ahead(&mut walker, 5.0);
    assert!(course.site().cell_at(walker.eye.truncate()).is_some());
    assert!((walker.eye.z - 1.6).abs() < 1e-3, "{}", walker.eye);
}

#[test]
fn a_long_wait_is_no_long_jump() {
    let course = Course::of(ROOM, Doors::Open);
    let mut walker = course.at([2.0, 2.0], 0.0);
    let input = Input {
        forward: 1.0,
        run: true,
        ..Input::default()
    };
    walker.step(&input, 1000.0, &course.site());
    assert!(walker.eye.x < 5.0);
    assert!(Input::default().is_idle() && !input.is_idle());
}
