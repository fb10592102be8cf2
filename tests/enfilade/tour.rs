//! Tours: no wall crossed, nothing left out that can be reached, away from walls. What the tours are
//! checked with shares no code with them but the cells: exact crossings, a flood of a body that is a
//! little larger over a lattice, and one of a point over the cells.

use std::path::Path;

use enfilade::cells::{CellGraph, CellId, EdgeId, Locator, Options, Subdivision, subdivide};
use enfilade::geom::{Side, Vertex, orient};
use enfilade::level::read::Source;
use enfilade::level::{Level, OpeningStyle, WallKind, doom, snap, wad::Wad};
use enfilade::trace::Space;
use enfilade::walk::{
    Barrier, Ground, Person, Tour, Track, TrackOptions, obstacle::footprint, opened, tour,
};
use glam::DVec2;

use crate::agree::tomls;

/// A level with its cells, as a person walks it.
struct Scene {
    level: Level,
    graph: CellGraph,
    space: Space,
    person: Person,
}

impl Scene {
    fn of(level: &Level, subdivision: Subdivision) -> Self {
        let person = Person::of_unit(&level.unit);
        let level = opened(level, &person);
        let options = Options {
            subdivision,
            ..Options::default()
        };
        let graph = subdivide(&level, &options);
        let space = Space::new(&level, &graph);
        Scene {
            level,
            graph,
            space,
            person,
        }
    }

    fn tour(&self) -> Tour {
        tour(&self.level, &self.graph, &self.space, &self.person).expect("there is room to stand")
    }

    /// Floor and ceiling of a cell, from the level.
    fn heights(&self, cell: CellId) -> (f64, f64) {
        match self.graph.cell(cell).sector {
            Some(s) => {
                let sector = &self.level.sectors[s.0 as usize];
                (sector.floor.rest, sector.ceiling.rest)
            }
            None => (0.0, f64::INFINITY),
        }
    }

    /// Height of the opening on an edge, if it is one that people walk through.
    fn opening(&self, edge: EdgeId) -> Option<(f64, f64)> {
        let twin = self.graph.edge(edge).twin()?;
        let (mut bottom, mut top) = (f64::NEG_INFINITY, f64::INFINITY);
        for side in [edge, twin] {
            let (floor, ceiling) = self.heights(self.graph.edge(side).cell);
            bottom = bottom.max(floor);
            top = top.min(ceiling);
            let wall = self.graph.edge(side).wall();
            let kind = wall.map(|w| &self.level.walls[w.0 as usize].kind);
            if let Some(WallKind::Opening(opening)) = kind {
                if opening.style == OpeningStyle::Window {
                    return None;
                }
                bottom = bottom.max(opening.bottom.unwrap_or(bottom));
                top = top.min(opening.top.unwrap_or(top));
            }
        }
        Some((bottom, top))
    }

    fn passes(&self, edge: EdgeId) -> bool {
        let Some((bottom, top)) = self.opening(edge) else {
            return false;
        };
        let twin = self.graph.edge(edge).twin().expect("it is an opening");
        let here = self.heights(self.graph.edge(edge).cell).0;
        let there = self.heights(self.graph.edge(twin).cell).0;
        let hair = 1e-6 * self.person.height;
        top - bottom >= self.person.height - hair
            && bottom - here <= self.person.step + hair
            && bottom - there <= self.person.drop + hair
    }

    fn line(&self, edge: EdgeId) -> [DVec2; 2] {
        [self.graph.edge(edge).origin, self.graph.end(edge)]
            .map(|v| self.graph.vertices.exact(v).to_level(&self.graph.grid))
    }

    fn sector(&self, cell: CellId) -> Option<u32> {
        self.graph.cell(cell).sector.map(|s| s.0)
    }
}

fn distance(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    p.distance(a + along * share)
}

/// What a checked tour showed.
#[derive(Debug, Default)]
struct Seen {
    #[expect(dead_code, reason = "printed")]
    crossings: usize,
    /// Least distance from a wall, in radii.
    #[expect(dead_code, reason = "printed")]
    nearest: f64,
    #[expect(dead_code, reason = "printed")]
    flooded: usize,
    visited: usize,
}

/// Crosses the cells exactly along the tour; the eye stays within every opening.
fn crossings(scene: &Scene, tour: &Tour, locator: &Locator) -> usize {
    let graph = &scene.graph;
    let vertex = |p: DVec2| graph.grid.fine(p).expect("it is on the grid");
    let mut at = vertex(tour.points[0].truncate());
    let mut cell = *locator
        .cells_at(graph, &at)
        .first()
        .expect("it starts inside");
    let mut seen = vec![scene.sector(cell)];
    let mut count = 0;
    for pair in tour.points.windows(2) {
        let to: Vertex = vertex(pair[1].truncate());
        let mut came = None;
        loop {
            let outside = |e: &EdgeId| {
                let [a, b] =
                    [graph.edge(*e).origin, graph.end(*e)].map(|v| graph.vertices.exact(v));
                orient(a, b, &to) == Side::Right
                    && orient(&at, &to, a) != Side::Left
                    && orient(&at, &to, b) != Side::Right
            };
            let mut exits = graph.edge_range(cell).map(EdgeId).filter(outside);
            let Some(exit) = exits.find(|e| Some(*e) != came) else {
                break;
            };
            assert!(
                scene.passes(exit),
                "{}: from {} to {}",
                scene.level.name,
                pair[0],
                pair[1]
            );
            let (bottom, top) = scene.opening(exit).expect("it passes");
            for p in pair {
                let place = (&scene.level.name, p, bottom, top);
                assert!(bottom < p.z && p.z < top, "{place:?}");
            }
            came = graph.edge(exit).twin();
            cell = graph.edge(came.expect("it is open")).cell;
            seen.push(scene.sector(cell));
            count += 1;
        }
        let holds = locator.cells_at(graph, &to).contains(&cell);
        assert!(
            holds,
            "{}: {} is not in its cell",
            scene.level.name, pair[1]
        );
        let (floor, ceiling) = scene.heights(cell);
        assert!(floor < pair[1].z && pair[1].z < ceiling, "{}", pair[1]);
        at = to;
    }
    let mut seen: Vec<u32> = seen.into_iter().flatten().collect();
    seen.sort_unstable();
    seen.dedup();
    let mut visits: Vec<u32> = tour.visits.iter().map(|s| s.0).collect();
    visits.sort_unstable();
    assert_eq!(seen, visits, "{}", scene.level.name);
    count
}

/// Everything about a tour.
fn check(scene: &Scene, tour: &Tour) -> Seen {
    let (graph, person) = (&scene.graph, &scene.person);
    let name = &scene.level.name;
    let locator = Locator::new(graph);
    let crossings = crossings(scene, tour, &locator);
    // Walls on both sides, and everything that cannot be passed both ways.
    let (mut walls, mut obstacles) = (Vec::new(), Vec::new());
    for e in (0..graph.edges.len() as u32).map(EdgeId) {
        let twin = graph.edge(e).twin();
        let ways = [Some(e), twin].map(|e| e.is_some_and(|e| scene.passes(e)));
        if ways == [false, false] {
            walls.push(scene.line(e));
        }
        if ways != [true, true] {
            obstacles.push(scene.line(e));
        }
    }
    let ground = Ground::new(graph, &scene.space);
    for object in &scene.level.scene.objects {
        if let Some(foot) = footprint(object, &ground, person.height, person.step / 2.0) {
            let n = foot.len();
            let sides = (0..n).map(|i| [foot[i], foot[(i + 1) % n]]);
            walls.extend(sides.clone());
            obstacles.extend(sides);
        }
    }
    let near = |p: DVec2, lines: &[[DVec2; 2]]| {
        let all = lines.iter().map(|line| distance(p, *line));
        all.fold(f64::INFINITY, f64::min)
    };
    let points: Vec<DVec2> = tour.points.iter().map(|p| p.truncate()).collect();
    let sampled = points.iter().step_by(1 + points.len() / 4000);
    let nearest = sampled
        .map(|p| near(*p, &walls))
        .fold(f64::INFINITY, f64::min)
        / person.radius;
    assert!(nearest > 0.5, "{name}: {nearest} radii from a wall");
    // A body a fifth larger, from wherever the tour is: the lattice is so fine that no obstacle lies
    // between two neighbours that are clear.
    let step = person.radius * 0.8;
    let tile = |p: DVec2| (p / step).round().as_ivec2();
    let mut known = rustc_hash::FxHashSet::default();
    let mut queue: Vec<glam::IVec2> = points.iter().map(|p| tile(*p)).collect();
    let mut wide = Vec::new();
    while let Some(at) = queue.pop() {
        if !known.insert(at) {
            continue;
        }
        let p = at.as_dvec2() * step;
        let Some(fine) = graph.grid.fine(p) else {
            continue;
        };
        let cells = locator.cells_at(graph, &fine);
        if cells.is_empty() || near(p, &obstacles) < person.radius * 1.2 {
            continue;
        }
        wide.extend(cells.iter().filter_map(|c| scene.sector(*c)));
        queue.extend([(1, 0), (-1, 0), (0, 1), (0, -1)].map(|d| at + glam::IVec2::from(d)));
    }
    wide.sort_unstable();
    wide.dedup();
    for s in &wide {
        let visited = tour.visits.iter().any(|v| v.0 == *s);
        assert!(visited, "{name}: sector {s} is left out: {:?}", tour.missed);
    }
    // A body without width, over the cells.
    let at = graph.grid.fine(points[0]).expect("it is on the grid");
    let mut reached = vec![false; graph.cells.len()];
    let mut queue = locator.cells_at(graph, &at);
    while let Some(cell) = queue.pop() {
        if !std::mem::replace(&mut reached[cell.0 as usize], true) {
            let open = graph
                .edge_range(cell)
                .map(EdgeId)
                .filter(|e| scene.passes(*e));
            let twins = open.filter_map(|e| graph.edge(e).twin());
            queue.extend(twins.map(|t| graph.edge(t).cell));
        }
    }
    let reachable = |s: u32| {
        let mut own = graph.cell_ids().filter(|c| scene.sector(*c) == Some(s));
        own.any(|c| reached[c.0 as usize])
    };
    assert!(tour.visits.iter().all(|s| reachable(s.0)), "{name}");
    for (s, barrier) in &tour.missed {
        assert!(!tour.visits.contains(s));
        if reachable(s.0) {
            let narrow = matches!(barrier, Barrier::Narrow | Barrier::NoWayBack);
            assert!(
                narrow || tour.missed.iter().any(|(_, b)| *b == Barrier::Narrow),
                "{s:?}"
            );
        }
    }
    Seen {
        crossings,
        nearest,
        flooded: wide.len(),
        visited: tour.visits.len(),
    }
}

fn read(path: &Path) -> Level {
    let name = path.file_name().expect("it is a file").to_string_lossy();
    let bytes = std::fs::read(path).expect("it is there");
    let source = Source::parse(bytes, &name).expect("it is sound");
    source.level(None).expect("it is sound")
}

#[test]
fn tours_of_sample_levels_see_what_can_be_reached() {
    let (mut visited, mut n) = (0, 0);
    for path in tomls("levels") {
        let level = read(&path);
        let scene = Scene::of(&level, Subdivision::Bsp);
        let made = scene.tour();
        let seen = check(&scene, &made);
        println!("{}: {seen:?}, missed {:?}", level.name, made.missed);
        // From other cells, the same sectors.
        let other = Scene::of(&level, Subdivision::Kd);
        let again = other.tour();
        let sorted = |tour: &Tour| {
            let mut list = tour.visits.clone();
            list.sort_unstable();
            list
        };
        assert_eq!(sorted(&made), sorted(&again), "{}", level.name);
        check(&other, &again);
        visited += seen.visited;
        n += 1;
    }
    assert!(n >= 13 && visited > 250, "{visited} in {n}");
}

#[test]
fn tours_of_freedoom_see_what_can_be_reached() {
    let maps: [(&str, &[&str]); 2] = [
        ("freedoom1.wad", &["E1M1", "E1M5"]),
        ("freedoom2.wad", &["MAP12"]),
    ];
    for (file, names) in maps {
        let path = Path::new("/usr/share/games/doom").join(file);
        let Ok(bytes) = std::fs::read(&path) else {
            let missing = format!("{} is not there; install Freedoom", path.display());
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            continue;
        };
        let wad = Wad::parse(bytes).expect("Freedoom is a WAD");
        for name in names {
            let draft = doom::read_map(&wad, name, file).expect("the map is sound");
            let level = snap::snap(draft).expect("the map is sound");
            let scene = Scene::of(&level, Subdivision::Bsp);
            let made = scene.tour();
            let seen = check(&scene, &made);
            println!("{name}: {seen:?}, missed {}", made.missed.len());
            assert!(seen.visited > 40);
            let player = level.scene.cameras[0].eye.truncate();
            assert!(made.points[0].truncate().distance(player) < 2.0 * scene.person.radius);
        }
    }
}

#[test]
fn a_tour_is_walked_at_one_pace_and_never_turns_too_fast() {
    let level = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/museum.toml"));
    let scene = Scene::of(&level, Subdivision::Bsp);
    let made = scene.tour();
    assert_eq!(made.points, scene.tour().points, "the same every time");
    let options = TrackOptions::default();
    let track = made.track(&options);
    let frames = (track.seconds() * 30.0) as u32;
    assert!(frames > 3000);
    for i in 0..frames {
        let [a, b] = [i, i + 1].map(|i| track.at(f64::from(i) / 30.0));
        assert!(a.eye.distance(b.eye) <= scene.person.speed / 30.0 * 1.000_001);
        let turn = a.direction.angle_between(b.direction).to_degrees();
        assert!(turn <= options.turn / 30.0 * 1.001, "{turn} at {i}");
    }
}

#[test]
fn named_paths_cross_no_wall_and_no_object() {
    let mut n = 0;
    for path in tomls("levels") {
        let level = read(&path);
        let scene = Scene::of(&level, Subdivision::Bsp);
        let ground = Ground::new(&scene.graph, &scene.space);
        for path in &level.scene.paths {
            let track = Track::new(path, &ground, &TrackOptions::default());
            let mut near = f64::INFINITY;
            let mut walls = Vec::new();
            for e in (0..scene.graph.edges.len() as u32).map(EdgeId) {
                if scene.opening(e).is_none() {
                    walls.push(scene.line(e));
                }
            }
            for object in &level.scene.objects {
                let foot = footprint(object, &ground, scene.person.height, 0.3);
                let foot = foot.unwrap_or_default();
                let n = foot.len();
                walls.extend((0..n).map(|i| [foot[i], foot[(i + 1) % n]]));
            }
            for pose in track.points().windows(2) {
                let [a, b] = [pose[0], pose[1]].map(|p| p.truncate());
                let place = format!("{}, {}: at {}", level.name, path.name, pose[0]);
                let cell = ground
                    .cell_at(a)
                    .unwrap_or_else(|| panic!("{place}: outside"));
                let (floor, ceiling) = scene.heights(cell);
                assert!(floor < pose[0].z && pose[0].z < ceiling, "{place}");
                for [c, d] in &walls {
                    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
                    let crosses = side(a, b, *c) * side(a, b, *d) < 0.0
                        && side(*c, *d, a) * side(*c, *d, b) < 0.0;
                    assert!(!crosses, "{place}");
                    near = near.min(distance(a, [*c, *d]));
                }
            }
            assert!(near > 0.1, "{}, {}: {near}", level.name, path.name);
            println!(
                "{}, {}: {:.0} s, {near:.2} from walls",
                level.name,
                path.name,
                track.seconds()
            );
            n += 1;
        }
    }
    assert!(n >= 12, "{n} paths");
}

/// What keeps a person from a room is said.
#[test]
fn barriers_are_named() {
    let text = "[defaults]\nceiling = 3\n\
        [[room]]\nname = 'Hall'\nrect = [0, 0, 10, 10]\n\
        [[room]]\nname = 'Shut'\nrect = [10, 0, 14, 3]\n\
        [[room]]\nname = 'Behind'\nrect = [14, 0, 18, 3]\n\
        [[room]]\nname = 'View'\nrect = [10, 3, 14, 6]\n\
        [[room]]\nname = 'High'\nrect = [10, 6, 14, 10]\nfloor = 0.9\nceiling = 4\n\
        [[room]]\nname = 'Slit'\nrect = [0, 10, 4, 14]\n\
        [[room]]\nname = 'Crawl'\nrect = [4, 10, 8, 14]\n\
        [[room]]\nname = 'Alone'\nrect = [8, 10, 12, 14]\n\
        [[zone]]\nname = 'Pit'\nrect = [4, 4, 6, 6]\nfloor = -2\n\
        [[door]]\nbetween = ['Hall', 'Shut']\nwidth = 1\n\
        [[archway]]\nbetween = ['Shut', 'Behind']\nwidth = 1\n\
        [[window]]\nbetween = ['Hall', 'View']\nwidth = 1\n\
        [[archway]]\nbetween = ['Hall', 'High']\nwidth = 1\n\
        [[archway]]\nbetween = ['Hall', 'Slit']\nwidth = 0.5\n\
        [[archway]]\nbetween = ['Hall', 'Crawl']\nwidth = 1\nheight = 1\n\
        [[camera]]\nname = 'c'\neye = [1, 1, 1.6]\nlook = [5, 1, 1.6]\n";
    let level = enfilade::level::toml::read(text, "barriers.toml").expect("it is sound");
    let options = Options {
        doors: enfilade::cells::Doors::Closed,
        ..Options::default()
    };
    let reasons = |options: &Options, person: &Person| {
        let graph = subdivide(&level, options);
        let space = Space::new(&level, &graph);
        let made = tour(&level, &graph, &space, person).expect("there is room to stand");
        let name = |s: usize| level.sectors[s].name.clone().expect("it has one");
        let list = made
            .missed
            .iter()
            .map(|(s, b)| (name(s.0 as usize), b.to_string()));
        list.collect::<Vec<_>>()
    };
    let expected = [
        ("Shut", "the door is shut"),
        ("Behind", "the door is shut"),
        ("View", "only a window leads there"),
        ("High", "a step is 0.9 high"),
        ("Slit", "the way is too narrow"),
        ("Crawl", "an opening is only 1 high"),
        ("Alone", "no opening leads there"),
        ("Pit", "a drop is 2 deep"),
    ];
    let expected = expected.map(|(name, why)| (name.to_string(), why.to_string()));
    assert_eq!(reasons(&options, &Person::METRES), expected);
    // Doors open, a bold climber, thin and low: everything but what has no opening.
    let bold = Person {
        radius: 0.2,
        height: 0.9,
        eye: 0.8,
        step: 2.0,
        drop: 2.0,
        ..Person::METRES
    };
    let left = [
        ("View", "only a window leads there"),
        ("Alone", "no opening leads there"),
    ];
    let left = left.map(|(name, why)| (name.to_string(), why.to_string()));
    assert_eq!(reasons(&Options::default(), &bold), left);
}
