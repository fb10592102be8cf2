use std::path::Path;
#[derive(Clone, Copy)]
struct Instant(f64);
fn cpu() -> f64 { let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime); t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9 }
impl Instant { fn now() -> Self { Self(cpu()) } fn elapsed(&self) -> std::time::Duration { std::time::Duration::from_secs_f64(cpu() - self.0) } }

use enfilade::cells::*;
use enfilade::level::{Level, doom, snap, wad::Wad};
use enfilade::trace::{*, beam, camera::Camera, sampling::Source};
use glam::*;

const MAPS: [(&str, &str); 6] = [
    ("freedoom1.wad", "E1M1"),
    ("freedoom1.wad", "E1M2"),
    ("freedoom1.wad", "E1M3"),
    ("freedoom2.wad", "MAP01"),
    ("freedoom2.wad", "MAP05"),
    ("freedoom2.wad", "MAP15"),
];
fn load(file: &str, map: &str) -> Option<Level> {
    let path = Path::new("/usr/share/games/doom").join(file);
    let bytes = std::fs::read(&path).ok()?;
    let wad = Wad::parse(bytes).expect("the WAD is sound");
    Some(snap::snap(doom::read_map(&wad, map, file).expect("the map reads")).expect("it fits"))
}
fn main() {
    for (file, map) in MAPS {
        let level = load(file, map).unwrap();
        let graph = subdivide(&level, &Options::default());
        let space = Space::new(&level, &graph);
        let mut hist = [0usize; 40];
        for c in &space.cells { hist[((c.past - c.first) as usize).min(39)] += 1; }
        println!("{map}: cells {} edges {} hist {:?}", space.cells.len(), space.edges.len(), &hist);
        let mut random = Source::new(5, 0, 0);
        let locator = Locator::new(&graph);
        let (mut secs, mut secs1, mut rects, mut singles, mut px, mut seg, mut secs2) = (vec![], vec![], 0usize, 0usize, 0usize, 0usize, vec![]);
        let mut eyes = 0;
        while eyes < 8 {
            let id = (random.next() * space.cells.len() as f64) as u32;
            let cell = space.cell(id);
            if cell.ceiling - cell.floor < 56.0 { continue; }
            let n = (cell.past - cell.first) as f64;
            let plan: DVec2 = (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from)).sum::<DVec2>() / n;
            let Some(at) = graph.grid.nearest(plan) else { continue };
            let plan = graph.grid.to_level(at);
            let [start] = locator.cells_at(&graph, &at.into())[..] else { continue };
            eyes += 1;
            let camera = Camera::new(plan.extend(cell.floor + 41.0), DVec2::from_angle(random.next() * 7.0).extend(0.0), 90.0, [640, 400]);
            let now = Instant::now();
            let mut sum = 0.0;
            for y in (0..400).step_by(16) { for x in (0..640).step_by(16) {
                beam::cast_patches(&space, &camera, start, beam::Area { x: (x, x + 16), y: (y, y + 16) }, |p, t| { rects += 1; singles += (!p.mask.is_all()) as usize; sum += t[0]; });
            }}
            px += 256000;
            secs.push(now.elapsed().as_secs_f64());
            let now = Instant::now();
            let mut hits = vec![];
            for y in 0..400 { for x in 0..640 {
                let ray = camera.ray(beam::middle(x, y));
                let m = walk(&space, &ray, Place { cell: start, on: None }, f64::INFINITY, |_, _| { seg += 1; f64::INFINITY });
                hits.push((ray, m));
            }}
            secs1.push(now.elapsed().as_secs_f64());
            let mut both = vec![None; 256000];
            for y in (0..400).step_by(100) { for x in (0..640).step_by(40) {
                beam::cast(&space, &camera, start, beam::Area { x: (x, x + 40), y: (y, y + 100) }, |a, m, t| {
                    let mut t = t.iter();
                    for y in a.y.0..a.y.1 { for x in a.x.0..a.x.1 { let t = t.next().copied(); both[(y * 640 + x) as usize] = m.map(|m| Met { t: t.unwrap(), surface: m.0, cell: m.1 }); }}
                });
            }}
            let bad = both.iter().zip(&hits).filter(|(a, b)| **a != b.1).count();
            if bad > 0 { println!("{bad} differ"); }
            let mut rays = vec![];
            for (i, (ray, m)) in hits.iter().enumerate() { if let Some(m) = m {
                let n = space.normal(m.surface);
                let mut s = Source::new(1, i as u64, 0);
                let d = loop { let v = DVec3::new(s.next(), s.next(), s.next()) * 2.0 - 1.0; if v.length_squared() < 1.0 { break v.normalize(); } } + n;
                rays.push((Ray { origin: ray.at(m.t), direction: d }, Place { cell: m.cell, on: Some(m.surface) }));
            }}
            let now = Instant::now();
            for (r, p) in &rays { sum += walk(&space, r, *p, f64::INFINITY, |_, _| f64::INFINITY).map_or(0.0, |m| m.t); }
            secs2.push(rays.len() as f64 / now.elapsed().as_secs_f64() / 1e6);
            std::hint::black_box(sum);
        }
        secs.sort_by(f64::total_cmp); secs1.sort_by(f64::total_cmp);secs2.sort_by(f64::total_cmp);
        println!("beams {:.1} single {:.1} incoherent {:.1} rects/pic {} singles/pic {} cells/ray {:.2}", 0.256 / secs[4], 0.256 / secs1[4], secs2[4], rects / 8, singles / 8, seg as f64 / px as f64);
    }
}
