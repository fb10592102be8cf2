//! How many rays a second, on one thread: the walk through cells against every structure.
//!
//! `cargo bench --bench trace` needs the Debian package `freedoom`; `-- --quick` takes 2 eyes a map
//! instead of 16, `--walk` leaves out all structures but obvhs, and names of maps and of kinds of
//! rays choose among them. Eyes are spread evenly over the ground, 41
//! above it, and look level in a random direction, 640 × 400 pixels, 90°, all seeded. Rays:
//!
//! - *primary*: one through the middle of each pixel; its surface and its `t`;
//! - *shadow*: from each point so met to 4 point lights that hang in cells the eye sees, but only to
//!   lights in front of the surface; lit or not;
//! - *incoherent*: one from each such point in a random direction, as many near the normal as a matt
//!   surface reflects there; surface and `t`.
//!
//! The walk takes 32 × 32 pixels at a time by beams, and incoherent rays by streams; `one by one` are
//! its single rays. `in the renderer` are incoherent rays as `render` casts them: in a world with the
//! map's gratings, and with all that a ray of the tree carries along. Structures hold the level's surfaces as triangles, and get the rays of some tiles
//! of each picture, as many as [`PATIENCE`] allows, starting a little off the surface. `obvhs` is the
//! outside crate: an eight-wide tree, built with care, in f32. Times are processor time of the thread,
//! so that what else the machine does counts little; a figure is the median of all eyes of a map.

use std::hint::black_box;
use std::path::Path;

use enfilade::cells::{CellGraph, CellId, Locator, Options, subdivide};
use enfilade::level::{Level, doom, snap, wad::Wad};
use enfilade::pvs::{Progress, sweep};
use enfilade::trace::accel::{Cast, Kind, Want};
use enfilade::trace::beam::{self, Area, Patch, middle};
use enfilade::trace::camera::Camera;
use enfilade::trace::sampling::Source;
use enfilade::trace::shade::{self, Onward};
use enfilade::trace::shadow::{self, Lamp};
use enfilade::trace::shapes::mesh::{Mesh, Points};
use enfilade::trace::stream::Stream;
use enfilade::trace::world::caster::Caster;
use enfilade::trace::world::{Departure, Files};
use enfilade::trace::{Met, Place, Ray, Space, Surface, Tracer, World, walk};
use glam::{DVec2, DVec3};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use rustix::time::{ClockId, clock_gettime};

const MAPS: [(&str, &str); 6] = [
    ("freedoom1.wad", "E1M1"),
    ("freedoom1.wad", "E1M2"),
    ("freedoom1.wad", "E1M3"),
    ("freedoom2.wad", "MAP01"),
    ("freedoom2.wad", "MAP05"),
    ("freedoom2.wad", "MAP15"),
];
const SIZE: [u32; 2] = [640, 400];
const TILE: u32 = 32;
const LAMPS: usize = 4;
/// Runs of the walk, of which the median counts.
const RUNS: usize = 5;
/// Rays that a stream gets at a time, made just before, as a renderer does.
const SOME: usize = 4000;
/// Seconds for each structure, eye and kind of rays.
const PATIENCE: f64 = 0.02;

const CLASSES: [&str; 3] = ["primary", "shadow", "incoherent"];

fn main() {
    // cargo passes --bench; a filter names maps and kinds of rays.
    let (flags, wanted): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with('-'));
    let quick = flags.iter().any(|f| f == "--quick");
    let eyes = if quick { 2 } else { 16 };
    let kinds = if flags.iter().any(|f| f == "--walk") {
        Vec::new()
    } else {
        Kind::ALL.to_vec()
    };
    let classes: Vec<&str> = CLASSES
        .into_iter()
        .filter(|c| wanted.iter().any(|w| w == c))
        .collect();
    let classes = if classes.is_empty() {
        CLASSES.to_vec()
    } else {
        classes
    };
    let wanted: Vec<&String> = wanted
        .iter()
        .filter(|w| !CLASSES.contains(&w.as_str()))
        .collect();
    let mut names = Vec::new();
    let mut tables: [Vec<Vec<f64>>; 3] = Default::default();
    for (file, map) in MAPS {
        if !wanted.is_empty() && !wanted.iter().any(|w| *w == map) {
            continue;
        }
        let Some(level) = load(file, map) else {
            continue;
        };
        let (columns, off) = measure(&level, eyes, &kinds, &classes);
        if let Some([outside, ours]) = off {
            eprint!("{map}: of a million primary rays, {outside:.0} meet something else in obvhs");
            match kinds.get(1) {
                Some(kind) => eprintln!(", {ours:.0} in {kind}"),
                None => eprintln!(),
            }
        }
        names.push(map);
        for (table, column) in tables.iter_mut().zip(columns) {
            table.push(column);
        }
    }
    println!(
        "Million rays a second on one thread; {:?}",
        fearless_simd::Level::new()
    );
    for (class, table) in CLASSES.iter().zip(&tables) {
        if table.iter().all(|column| column.is_empty()) {
            continue;
        }
        print!("\n{class:<22}");
        for name in &names {
            print!(" {name:>7}");
        }
        println!("  median  × obvhs");
        let row = |k: usize| -> Vec<f64> { table.iter().map(|column| column[k]).collect() };
        let outside = median(row(3));
        for (k, name) in contestants(&kinds).into_iter().enumerate() {
            if row(k).iter().any(|rate| rate.is_nan()) {
                continue;
            }
            print!("{name:<22}");
            for rate in row(k) {
                print!(" {}", figure(rate));
            }
            let rate = median(row(k));
            println!(" {} {:>8.2}", figure(rate), rate / outside);
        }
    }
}

fn load(file: &str, map: &str) -> Option<Level> {
    let path = Path::new("/usr/share/games/doom").join(file);
    let Ok(bytes) = std::fs::read(&path) else {
        eprintln!(
            "left out {map}: {} is not there (apt-get install freedoom)",
            path.display()
        );
        return None;
    };
    let wad = Wad::parse(bytes).expect("the WAD is sound");
    Some(snap::snap(doom::read_map(&wad, map, file).expect("the map reads")).expect("it fits"))
}

/// The rows of the tables.
fn contestants(kinds: &[Kind]) -> Vec<String> {
    let first = ["walk", "walk, one by one", "in the renderer", "obvhs"];
    let rest = kinds.iter().map(|kind| kind.to_string());
    first.into_iter().map(str::to_string).chain(rest).collect()
}

/// Seconds of this thread.
fn now() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

fn seconds(run: impl FnOnce()) -> f64 {
    let start = now();
    run();
    now() - start
}

/// With as many decimals as say something.
fn figure(rate: f64) -> String {
    let decimals = [0, 1, 2, 3];
    let digits = decimals[(2 - rate.log10().floor() as i32).clamp(0, 3) as usize];
    format!("{rate:>7.digits$}")
}

fn median(mut list: Vec<f64>) -> f64 {
    list.sort_by(f64::total_cmp);
    // The mean of the two in the middle, of an even number.
    let n = list.len();
    (list[(n - 1) / 2] + list[n / 2]) / 2.0
}

/// Million rays a second of every contestant, for each class; and how many primary rays of a million
/// meet something else in obvhs and in a tree of ours.
fn measure(
    level: &Level,
    n_eyes: usize,
    kinds: &[Kind],
    classes: &[&str],
) -> ([Vec<f64>; 3], Option<[f64; 2]>) {
    let graph = subdivide(level, &Options::default());
    let space = Space::new(level, &graph);
    let pvs = sweep::sweep(&graph, &Progress::default());
    let world = World::new(level, &graph, &pvs, &Files::default(), 0.0).expect("it has heights");
    let tracer = Tracer::new(&world);
    let triangles = triangles(&space);
    let meshes: Vec<Mesh> = kinds
        .iter()
        .map(|&kind| Mesh::new(triangles.clone(), kind).expect("it has triangles"))
        .collect();
    let outside = Outside::new(&triangles);
    let mut rates: [Vec<Vec<f64>>; 3] = Default::default();
    let (mut differ, mut compared) = ([0.0; 2], 0.0);
    for eye in eyes(&graph, &space, n_eyes) {
        let view = View::new(&space, eye);
        for (class, all) in rates.iter_mut().enumerate() {
            if !classes.contains(&CLASSES[class]) {
                continue;
            }
            let [fast, single] = view.by_cells(&space, class);
            let rendered = if class == 2 {
                view.in_the_renderer(&tracer)
            } else {
                f64::NAN
            };
            let mut list = vec![fast, single, rendered];
            let tiles = view.tiles_of_rays(&space, class);
            list.push(rate(&tiles, |shot| outside.shoot(shot, class)));
            for mesh in &meshes {
                list.push(rate(&tiles, |shot| in_mesh(mesh, shot, class)));
            }
            all.push(list);
            for shot in tiles.iter().take(4).flatten().filter(|_| class == 0) {
                let same = |t: f64| (t - shot.t).abs() <= 1e-3 * shot.t.max(1.0);
                differ[0] += f64::from(!same(outside.shoot(shot, 0)));
                if let Some(mesh) = meshes.get(1) {
                    differ[1] += f64::from(!same(in_mesh(mesh, shot, 0)));
                }
                compared += 1.0;
            }
        }
    }
    let columns = rates.map(|eyes| {
        let n = eyes.first().map_or(0, Vec::len);
        (0..n)
            .map(|k| median(eyes.iter().map(|list| list[k]).collect()))
            .collect()
    });
    let off = (compared > 0.0).then(|| differ.map(|n| n / compared * 1e6));
    (columns, off)
}

/// Million rays a second, tile after tile until patience ends.
fn rate(tiles: &[Vec<Shot>], shoot: impl Fn(&Shot) -> f64) -> f64 {
    let (mut rays, mut time) = (0, 0.0);
    for tile in tiles {
        time += seconds(|| {
            for shot in tile {
                black_box(shoot(shot));
            }
        });
        rays += tile.len();
        if time > PATIENCE {
            break;
        }
    }
    rays as f64 / time / 1e6
}

/// A ray for a structure.
struct Shot {
    cast: Cast,
    /// What the walk met.
    t: f64,
}

/// The t of what is met; for shadow rays, whether anything is.
fn in_mesh(mesh: &Mesh, shot: &Shot, class: usize) -> f64 {
    let (want, limit) = if class == 1 {
        (Want::Any, 1.0)
    } else {
        (Want::Nearest, f64::INFINITY)
    };
    let contact = mesh.contact(&shot.cast, None, want, limit, &mut ());
    contact.map_or(f64::INFINITY, |c| c.t)
}

/// An outside crate's tree.
struct Outside {
    tree: CwBvh,
    triangles: Vec<RtTriangle>,
}

impl Outside {
    fn new(points: &Points) -> Self {
        let corner = |i: u32| points.places[i as usize].as_vec3a();
        let list: Vec<obvhs::triangle::Triangle> = points
            .triangles
            .iter()
            .map(|&[a, b, c]| obvhs::triangle::Triangle {
                v0: corner(a),
                v1: corner(b),
                v2: corner(c),
            })
            .collect();
        let tree = build_cwbvh_from_tris(
            &list,
            obvhs::BvhBuildParams::very_slow_build(),
            &mut std::time::Duration::default(),
        );
        // In the tree's order, so that a leaf's triangles lie together.
        let triangles = tree.primitive_indices.iter();
        let triangles = triangles.map(|&i| (&list[i as usize]).into()).collect();
        Self { tree, triangles }
    }

    fn shoot(&self, shot: &Shot, class: usize) -> f64 {
        let Ray { origin, direction } = shot.cast.ray;
        let (origin, direction) = (origin.as_vec3a(), direction.as_vec3a());
        if class == 1 {
            let ray = obvhs::ray::Ray::new(origin, direction, 0.0, 1.0);
            let free = self
                .tree
                .ray_traverse_miss(ray, |ray, i| self.triangles[i].intersect(ray));
            return if free { f64::INFINITY } else { 0.5 };
        }
        let ray = obvhs::ray::Ray::new_inf(origin, direction);
        let mut hit = RayHit::none();
        self.tree
            .ray_traverse(ray, &mut hit, |ray, i| self.triangles[i].intersect(ray));
        f64::from(hit.t)
    }
}

/// The level's surfaces as triangles.
fn triangles(space: &Space) -> Points {
    let (mut places, mut triangles) = (Vec::new(), Vec::new());
    let mut polygon = |corners: Vec<DVec3>| {
        let first = places.len() as u32;
        for k in 1..corners.len() as u32 - 1 {
            triangles.push([first, first + k, first + k + 1]);
        }
        places.extend(corners);
    };
    for surface in space.surfaces() {
        match surface {
            Surface::Floor(id) | Surface::Ceiling(id) => {
                let cell = space.cell(id.0);
                let z = if matches!(surface, Surface::Floor(_)) {
                    cell.floor
                } else {
                    cell.ceiling
                };
                let corners =
                    (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from).extend(z));
                polygon(corners.collect());
            }
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                let cell = space.cell(edge.cell);
                let (low, high) = match surface {
                    Surface::Step(_) => (cell.floor, edge.bottom.min(cell.ceiling)),
                    Surface::Lintel(_) => (edge.top.max(cell.floor), cell.ceiling),
                    Surface::Pane(_) => (edge.bottom, edge.top),
                    _ => (cell.floor, cell.ceiling),
                };
                let (a, b) = (space.vertex(edge.from), space.vertex(edge.to));
                polygon(vec![
                    a.extend(low),
                    b.extend(low),
                    b.extend(high),
                    a.extend(high),
                ]);
            }
        }
    }
    Points {
        places,
        triangles,
        normals: Vec::new(),
        uv: Vec::new(),
    }
}

/// Where somebody stands and looks, and random numbers for what else is drawn.
struct Eye {
    camera: Camera,
    start: CellId,
    random: Source,
}

/// Eyes evenly over the ground of cells that are high enough to stand in.
fn eyes(graph: &CellGraph, space: &Space, n: usize) -> Vec<Eye> {
    let mut random = Source::new(3, 0, 0);
    let mut sum = 0.0;
    let stands = |c: CellId| space.cell(c.0).ceiling - space.cell(c.0).floor >= 56.0;
    let sums: Vec<f64> = graph
        .cell_ids()
        .map(|c| {
            sum += if stands(c) { graph.area(c) } else { 0.0 };
            sum
        })
        .collect();
    let locator = Locator::new(graph);
    let mut list = Vec::new();
    while list.len() < n {
        let at = random.next() * sum;
        let cell = CellId(sums.partition_point(|&s| s <= at) as u32);
        let chamber = space.cell(cell.0);
        let corners = (chamber.first..chamber.past).map(|e| space.vertex(space.edge(e).from));
        let weights: Vec<f64> = corners.clone().map(|_| random.next()).collect();
        let total: f64 = weights.iter().sum();
        let plan: DVec2 = corners.zip(&weights).map(|(p, w)| p * (w / total)).sum();
        let Some(near) = graph.grid.nearest(plan) else {
            continue;
        };
        if locator.cells_at(graph, &near.into()) != [cell] {
            continue;
        }
        let eye = graph.grid.to_level(near).extend(chamber.floor + 41.0);
        let direction = DVec2::from_angle(random.next() * std::f64::consts::TAU);
        list.push(Eye {
            camera: Camera::new(eye, direction.extend(0.0), 90.0, SIZE),
            start: cell,
            random: Source::new(4, list.len() as u64, 0),
        });
    }
    list
}

/// All that an eye sees, and the lamps.
struct View {
    camera: Camera,
    start: CellId,
    /// Tile after tile.
    patches: Vec<Vec<Patch>>,
    /// What each pixel's ray meets, tile after tile.
    met: Vec<Vec<(Ray, Met)>>,
    lamps: Vec<Lamp>,
}

impl View {
    fn new(space: &Space, eye: Eye) -> Self {
        let Eye {
            camera,
            start,
            mut random,
        } = eye;
        let (mut patches, mut met) = (Vec::new(), Vec::new());
        for area in tiles() {
            let (mut list, mut each) = (Vec::new(), Vec::new());
            beam::cast_patches(space, &camera, start, area, |patch, t| {
                list.push(patch);
                let Some((surface, cell)) = patch.met else {
                    return;
                };
                let mut t = t.iter();
                for [x, y] in pixels(&patch.area) {
                    let &t = t.next().expect("a t for each pixel");
                    if patch.mask.has(x - patch.area.x.0, y - patch.area.y.0) {
                        each.push((camera.ray(middle(x, y)), Met { t, surface, cell }));
                    }
                }
            });
            patches.push(list);
            met.push(each);
        }
        let mut lamps = Vec::new();
        while lamps.len() < LAMPS {
            let tile = &met[(random.next() * met.len() as f64) as usize];
            let Some((_, met)) = tile.get((random.next() * tile.len() as f64) as usize) else {
                continue;
            };
            let cell = space.cell(met.cell.0);
            if cell.ceiling <= cell.floor {
                continue;
            }
            let corners = (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from));
            let plan = corners.sum::<DVec2>() / f64::from(cell.past - cell.first);
            lamps.push(Lamp {
                at: plan.extend(cell.floor + 0.8 * (cell.ceiling - cell.floor)),
                cell: met.cell,
            });
        }
        Self {
            camera,
            start,
            patches,
            met,
            lamps,
        }
    }

    /// Million rays a second by beams or streams, and one by one.
    fn by_cells(&self, space: &Space, class: usize) -> [f64; 2] {
        let all: Vec<(Ray, Place)> = self
            .met
            .iter()
            .flatten()
            .map(|(ray, met)| (*ray, place(met)))
            .collect();
        let mut rays = 0;
        let mut fast = Vec::new();
        match class {
            0 => {
                rays = (SIZE[0] * SIZE[1]) as usize;
                let mut depths = [0.0; (TILE * TILE) as usize];
                // Each pixel's surface, by its place in a list.
                let mut surfaces = [0u32; (TILE * TILE) as usize];
                let mut list = Vec::new();
                for _ in 0..RUNS {
                    fast.push(seconds(|| {
                        for tile in tiles() {
                            beam::cast_patches(
                                space,
                                &self.camera,
                                self.start,
                                tile,
                                |patch, t| {
                                    let Patch { area, mask, met } = patch;
                                    put_depths(&mut depths, &tile, &area, mask, t);
                                    put(&mut surfaces, &tile, &area, mask, list.len() as u32);
                                    list.push(met);
                                },
                            );
                            black_box((&depths, &surfaces, &list));
                            list.clear();
                        }
                    }));
                }
            }
            1 => {
                let mut lit = [0u8; (TILE * TILE) as usize];
                for _ in 0..RUNS {
                    rays = 0;
                    fast.push(seconds(|| {
                        for (tile, patches) in tiles().zip(&self.patches) {
                            for lamp in &self.lamps {
                                for patch in patches {
                                    let own = patch.met.map(|(surface, _)| surface);
                                    shadow::patch(
                                        space,
                                        &self.camera,
                                        patch,
                                        lamp,
                                        |area, mask, blocker| {
                                            if blocker.is_some() && blocker == own {
                                                return;
                                            }
                                            rays += if mask.is_all() {
                                                area.len()
                                            } else {
                                                mask.0.count_ones() as usize
                                            };
                                            put(
                                                &mut lit,
                                                &tile,
                                                &area,
                                                mask,
                                                u8::from(blocker.is_none()),
                                            );
                                        },
                                    );
                                }
                                black_box(&lit);
                            }
                        }
                    }));
                }
            }
            _ => {
                let bounced = self.bounced(space);
                rays = bounced.len();
                let mut stream = Stream::new(space);
                let mut some = Vec::with_capacity(SOME);
                for _ in 0..RUNS {
                    let times = bounced.chunks(SOME).map(|chunk| {
                        some.clear();
                        some.extend_from_slice(chunk);
                        seconds(|| {
                            stream.cast(some.iter().copied(), |_, met| {
                                black_box(met);
                            });
                        })
                    });
                    fast.push(times.sum());
                }
            }
        }
        let bounced = if class == 2 {
            self.bounced(space)
        } else {
            Vec::new()
        };
        let single = seconds(|| match class {
            0 => {
                let place = Place {
                    cell: self.start,
                    on: None,
                };
                for (ray, _) in &all {
                    black_box(walk(space, ray, place, f64::INFINITY, |_, _| f64::INFINITY));
                }
            }
            1 => {
                for (ray, met) in self.met.iter().flatten() {
                    let (point, place) = (ray.at(met.t), place(met));
                    for lamp in &self.lamps {
                        black_box(shadow::blocker(space, point, place, lamp));
                    }
                }
            }
            _ => {
                for (ray, place) in &bounced {
                    black_box(walk(space, ray, *place, f64::INFINITY, |_, _| {
                        f64::INFINITY
                    }));
                }
            }
        });
        let n = if class == 1 { rays } else { all.len() };
        [rays as f64 / median(fast) / 1e6, n as f64 / single / 1e6]
    }

    /// Million incoherent rays a second, as a picture in the making casts them.
    fn in_the_renderer(&self, tracer: &Tracer) -> f64 {
        let bounced = self.bounced(&tracer.world.space);
        let mut caster = Caster::new(tracer);
        let mut some = Vec::with_capacity(SOME);
        let runs = (0..RUNS).map(|_| {
            let times = bounced.chunks(SOME).map(|chunk| {
                some.clear();
                some.extend(chunk.iter().map(|&(ray, place)| Onward {
                    ray,
                    from: Departure { place, start: None },
                    path: shade::Path::new(0),
                    weight: 1.0,
                }));
                seconds(|| {
                    let way = |ray: &Onward| (ray.ray, ray.from);
                    caster.nearest(&some, way, |_, meeting| {
                        black_box(meeting);
                    });
                })
            });
            times.sum()
        });
        bounced.len() as f64 / median(runs.collect()) / 1e6
    }

    /// A ray from each point in a random direction, tile after tile.
    fn bounced(&self, space: &Space) -> Vec<(Ray, Place)> {
        let mut random = Source::new(5, 0, 0);
        let each = self.met.iter().flatten().map(|(ray, met)| {
            let ray = Ray {
                origin: ray.at(met.t),
                direction: space.normal(met.surface) + on_the_ball(&mut random),
            };
            (ray, place(met))
        });
        each.collect()
    }

    /// The rays of a class for structures: every eleventh tile, then those behind them, and so on.
    fn tiles_of_rays(&self, space: &Space, class: usize) -> Vec<Vec<Shot>> {
        let mut random = Source::new(6, 0, 0);
        let n = self.met.len();
        let order = (0..n).map(|i| i * 11 % n);
        order
            .take(40)
            .map(|tile| {
                let mut shots = Vec::new();
                for (ray, met) in &self.met[tile] {
                    let normal = space.normal(met.surface);
                    let origin = ray.at(met.t) + normal * 0.01;
                    let mut shoot = |origin, direction, t| {
                        let cast = Cast::new(Ray { origin, direction });
                        shots.push(Shot { cast, t });
                    };
                    match class {
                        0 => shoot(ray.origin, ray.direction, met.t),
                        1 => {
                            for lamp in &self.lamps {
                                let direction = lamp.at - origin;
                                if direction.dot(normal) > 0.0 {
                                    shoot(origin, direction, 0.0);
                                }
                            }
                        }
                        _ => shoot(origin, normal + on_the_ball(&mut random), 0.0),
                    }
                }
                shots
            })
            .collect()
    }
}

fn place(met: &Met) -> Place {
    Place {
        cell: met.cell,
        on: Some(met.surface),
    }
}

/// A unit vector in a random direction.
fn on_the_ball(random: &mut Source) -> DVec3 {
    loop {
        let v = DVec3::new(random.next(), random.next(), random.next()) * 2.0 - 1.0;
        if (0.001..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// The picture in tiles, row after row.
fn tiles() -> impl Iterator<Item = Area> {
    let row = |y: u32| {
        (0..SIZE[0]).step_by(TILE as usize).map(move |x| Area {
            x: (x, (x + TILE).min(SIZE[0])),
            y: (y, (y + TILE).min(SIZE[1])),
        })
    };
    (0..SIZE[1]).step_by(TILE as usize).flat_map(row)
}

fn pixels(area: &Area) -> impl Iterator<Item = [u32; 2]> + use<> {
    let Area { x, y } = *area;
    (y.0..y.1).flat_map(move |y| (x.0..x.1).map(move |x| [x, y]))
}

/// Puts a value at the mask's pixels of an area into a tile's list.
fn put<T: Copy>(list: &mut [T], tile: &Area, area: &Area, mask: beam::Mask, value: T) {
    for y in area.y.0..area.y.1 {
        let first = ((y - tile.y.0) * TILE + area.x.0 - tile.x.0) as usize;
        let row = &mut list[first..first + area.width() as usize];
        if mask.is_all() {
            row.fill(value);
        } else {
            for (one, x) in row.iter_mut().zip(0..) {
                if mask.has(x, y - area.y.0) {
                    *one = value;
                }
            }
        }
    }
}

/// Puts the t of an area's mask into a tile's list.
fn put_depths(list: &mut [f64], tile: &Area, area: &Area, mask: beam::Mask, t: &[f64]) {
    let width = area.width() as usize;
    for (t, y) in t.chunks_exact(width).zip(area.y.0..) {
        let first = ((y - tile.y.0) * TILE + area.x.0 - tile.x.0) as usize;
        let row = &mut list[first..first + width];
        if mask.is_all() {
            row.copy_from_slice(t);
        } else {
            for ((one, &t), x) in row.iter_mut().zip(t).zip(0..) {
                if mask.has(x, y - area.y.0) {
                    *one = t;
                }
            }
        }
    }
}
