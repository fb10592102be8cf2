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
            let tile: u32 = std::env::var("TILE").map_or(16, |t| t.parse().unwrap());
            for _ in 0..10 { for y in (0..400).step_by(tile as usize) { for x in (0..640).step_by(tile as usize) {
                beam::cast_patches(&space, &camera, start, beam::Area { x: (x, (x + tile).min(640)), y: (y, (y + tile).min(400)) }, |p, t| { rects += 1; singles += (!p.mask.is_all()) as usize; sum += t[0]; });
            }}}
            px += 256000;
            secs.push(now.elapsed().as_secs_f64() / 10.0);
            // shadow
            let mut patches = vec![];
            for y in (0..400).step_by(tile as usize) { for x in (0..640).step_by(tile as usize) {
                beam::patches(&space, &camera, start, beam::Area { x: (x, (x + tile).min(640)), y: (y, (y + tile).min(400)) }, |p| patches.push(p)); }}
            let mut lamps = vec![];
            while lamps.len() < 4 {
                let p = &patches[(random.next() * patches.len() as f64) as usize];
                let Some((s, c)) = p.met else { continue };
                let cell = space.cell(c.0);
                let plan: DVec2 = (cell.first..cell.past).map(|e| space.vertex(space.edge(e).from)).sum::<DVec2>() / (cell.past - cell.first) as f64;
                let _ = s;
                if cell.ceiling <= cell.floor { continue }
                lamps.push(shadow::Lamp { at: plan.extend(cell.floor + 0.8 * (cell.ceiling - cell.floor)), cell: c });
            }
            let now = Instant::now();
            let mut lit = 0u64; let mut parts = 0;
            let mut front = 0u64;
            for _ in 0..10 { for p in &patches { for lamp in &lamps {
                shadow::patch(&space, &camera, p, lamp, |a, m, b| { if b.is_some() && b == p.met.map(|m| m.0) { return } parts += 1; let n = if m.is_all() { a.len() as u64 } else { m.0.count_ones() as u64 }; front += n; if b.is_none() { lit += if m.is_all() { a.len() as u64 } else { m.0.count_ones() as u64 } } });
            }}}
            let t = now.elapsed().as_secs_f64() / 10.0;
            if eyes == 1 {
                let mut bad = 0; let mut n = 0;
                let mut d = vec![];
                for p in &patches { let Some((surface, cell)) = p.met else { continue };
                    p.depths(&space, &camera, &mut d);
                    for lamp in &lamps {
                        let mut got = vec![None; p.area.len()];
                        shadow::patch(&space, &camera, p, lamp, |a, m, b| { for y in a.y.0..a.y.1 { for x in a.x.0..a.x.1 { if m.has(x - a.x.0, y - a.y.0) { got[((y - p.area.y.0) * p.area.width() + x - p.area.x.0) as usize] = Some(b); }}} });
                        for y in p.area.y.0..p.area.y.1 { for x in p.area.x.0..p.area.x.1 { if p.mask.has(x - p.area.x.0, y - p.area.y.0) {
                            let i = ((y - p.area.y.0) * p.area.width() + x - p.area.x.0) as usize;
                            let ray = camera.ray(beam::middle(x, y));
                            let want = shadow::blocker(&space, ray.at(d[i]), Place { cell, on: Some(surface) }, lamp);
                            n += 1; if got[i] != Some(want) { bad += 1; }
                        }}}
                    }
                }
                println!("{bad} of {n} shadow rays differ");
            }
            println!("   shadow {:.1} front {:.2} lit {:.2} parts {} of {}", front as f64 / 1e7 / t, front as f64 / 10.0 / 4.0 / 256000.0, lit as f64 / 10.0 / 4.0 / 256000.0, parts / 10, patches.len());
            if std::env::var("ONLY").is_ok() { secs1.push(0.0); secs2.push(0.0); continue }
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
        println!("beams {:.1} single {:.1} incoherent {:.1} rects/pic {} singles/pic {} cells/ray {:.2}", 0.256 / secs[4], 0.256 / secs1[4], secs2[4], rects / 80, singles / 80, seg as f64 / px as f64);
    }
}
