use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;
use crate::cells::{CellId, Doors};
use crate::preview::{Finish, Options, Order};
use crate::trace::accel::Primitives;
use crate::viewer::gpu::Gpu;
use crate::viewer::sample::Sample;

const SIZE: [u32; 2] = [320, 200];

/// A device. `None` where there is none, which in CI is a failure.
fn gpu() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => {
            println!("on {}", gpu.name);
            Some(gpu)
        }
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            println!("skipped: {error}");
            None
        }
    }
}

/// A level on a device.
struct Stage<'a> {
    gpu: &'a Gpu,
    pipelines: Pipelines,
    scene: Scene,
    target: Target,
    painter: Painter<'a>,
    easel: Easel,
}

impl<'a> Stage<'a> {
    fn new(gpu: &'a Gpu, sample: &'a Sample, samples: u32, size: [u32; 2]) -> Self {
        let painter = Painter::new(&sample.world, &sample.graph, &sample.pvs, Finish::Textured);
        let painter = painter.expect("it was split by lines");
        let pipelines = Pipelines::new(&gpu.device, samples);
        Self {
            scene: Scene::new(&gpu.device, &gpu.queue, &pipelines, &painter),
            target: Target::new(&gpu.device, &pipelines, size),
            gpu,
            pipelines,
            painter,
            easel: Easel::default(),
        }
    }

    fn draw(&mut self, look: &Look) -> (Frame, Vec<u8>) {
        let gpu = self.gpu;
        let device = (&gpu.device, &gpu.queue);
        let frame = self
            .scene
            .prepare(device, &self.painter, look, &mut self.easel);
        let frame = frame.expect("it is on the grid");
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.scene.draw(&mut encoder, &self.pipelines, &self.target);
        gpu.queue.submit([encoder.finish()]);
        let bytes = gpu.read(&self.target.texture).expect("it is read");
        (frame, bytes)
    }

    /// The same by the software painter.
    fn paint(&mut self, look: &Look) -> (Figures, Vec<u8>) {
        let options = Options {
            culling: look.culling,
            order: Order::BackToFront,
            objects: look.objects,
            surfaces: false,
        };
        let figures = self.painter.draw(look.camera, &options, &mut self.easel);
        let pixels = self.easel.canvas.pixels.iter();
        let bytes = pixels.flat_map(|p| p.to_le_bytes()).collect();
        (figures.expect("the eye is inside"), bytes)
    }
}

fn look(camera: &Camera) -> Look<'_> {
    Look {
        camera,
        culling: Culling::Eye,
        chosen_for: None,
        smooth: false,
        objects: true,
    }
}

/// The level's cameras, and some in random places.
fn cameras(sample: &Sample, n: usize) -> Vec<Camera> {
    let own = sample.level.scene.cameras.iter().take(n);
    let mut cameras: Vec<Camera> = own
        .map(|c| Camera::new(c.eye, c.direction, c.fov, SIZE))
        .collect();
    let random = &mut Pcg64::seed_from_u64(4);
    let space = &sample.world.space;
    while cameras.len() < 2 * n {
        let cell = CellId(random.random_range(0..space.cells.len() as u32));
        let chamber = space.cell(cell.0);
        if chamber.floor >= chamber.ceiling {
            continue;
        }
        let share: f64 = random.random_range(0.1..0.9);
        let z = chamber.floor + (chamber.ceiling - chamber.floor) * share;
        let (at, _) = sample.world.middle(cell);
        // In a thing the software painter shows its inside.
        let inside = |object: &u32| {
            let bounds = sample.world.objects.bounds(*object);
            let eye = at.extend(z);
            bounds.min.cmple(eye).all() && eye.cmple(bounds.max).all()
        };
        if sample.world.objects_in(cell).iter().any(inside) {
            continue;
        }
        let ahead = DVec2::from_angle(random.random_range(0.0..std::f64::consts::TAU));
        let ahead = ahead.extend(random.random_range(-0.6..0.6));
        cameras.push(Camera::new(at.extend(z), ahead, 90.0, SIZE));
    }
    cameras
}

/// Number of pixels of which a channel differs by more than `most`.
fn differing(a: &[u8], b: &[u8], most: u8) -> usize {
    assert_eq!(a.len(), b.len());
    let pixels = a.chunks_exact(4).zip(b.chunks_exact(4));
    pixels
        .filter(|(p, q)| (0..3).any(|k| p[k].abs_diff(q[k]) > most))
        .count()
}

/// Pictures for people, where the environment names a folder for them.
fn keep(name: &str, size: [u32; 2], bytes: &[u8]) {
    if let Some(folder) = std::env::var_os("ENFILADE_PICTURES") {
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        let picture = image::RgbaImage::from_raw(size[0], size[1], bytes.to_vec());
        picture
            .expect("it is whole")
            .save(path)
            .expect("it is written");
    }
}

/// Pictures of both painters. The mean share of pixels that differ, and the largest.
fn compare(name: &str, sample: &Sample, gpu: &Gpu) -> [f64; 2] {
    let mut stage = Stage::new(gpu, sample, 1, SIZE);
    let (mut sum, mut worst) = (0.0, 0.0f64);
    let cameras = cameras(sample, 4);
    for (number, camera) in cameras.iter().enumerate() {
        let look = look(camera);
        let (frame, bytes) = stage.draw(&look);
        let (figures, expected) = stage.paint(&look);
        keep(&format!("{name}-{number}"), SIZE, &bytes);
        keep(&format!("{name}-{number}-expected"), SIZE, &expected);
        let n = f64::from(SIZE[0] * SIZE[1]);
        let [any, few, many] = [0, 8, 40].map(|most| differing(&bytes, &expected, most) as f64 / n);
        println!(
            "{name} {number}: {:.3} % of pixels differ, {:.3} % by more than 8 levels, {:.3} % by more than 40; \
             {} polygons in {} calls",
            any * 100.0,
            few * 100.0,
            many * 100.0,
            frame.figures.painted,
            frame.calls,
        );
        assert_eq!(frame.unculled, None);
        assert_eq!(
            (
                frame.figures.painted,
                frame.figures.cells,
                frame.figures.triangles
            ),
            (figures.painted, figures.cells, figures.triangles)
        );
        sum += few;
        worst = worst.max(few);
    }
    [sum / cameras.len() as f64, worst]
}

#[test]
fn the_picture_is_that_of_the_software_painter() {
    let Some(gpu) = gpu() else { return };
    let mut all = Vec::new();
    for name in ["museum", "gallery", "office", "cathedral"] {
        all.push((name, compare(name, &Sample::named(name), &gpu)));
    }
    if let Some(sample) = Sample::freedoom("E1M1") {
        all.push(("E1M1", compare("E1M1", &sample, &gpu)));
    }
    for (name, [mean, worst]) in all {
        println!(
            "{name}: {:.3} % on average, {:.3} % at most",
            mean * 100.0,
            worst * 100.0
        );
        // Panes of glass behind each other, and texels of the same width as pixels.
        assert!(mean < 0.01 && worst < 0.04, "{name}: {mean} {worst}");
    }
}

#[test]
fn culling_and_samples_change_nothing_but_edges() {
    let Some(gpu) = gpu() else { return };
    let sample = Sample::named("museum");
    let (mut one, mut four) = (
        Stage::new(&gpu, &sample, 1, SIZE),
        Stage::new(&gpu, &sample, 4, SIZE),
    );
    let mut smoothed = 0;
    for camera in &cameras(&sample, 4) {
        let eye = look(camera);
        let (frame, bytes) = one.draw(&eye);
        let all = Look {
            culling: Culling::None,
            ..eye.clone()
        };
        let (whole, same) = one.draw(&all);
        assert!(whole.figures.painted > frame.figures.painted);
        let n = (SIZE[0] * SIZE[1]) as usize;
        assert!(
            differing(&bytes, &same, 0) * 1000 < n,
            "{}",
            differing(&bytes, &same, 0)
        );
        let (_, smooth) = four.draw(&eye);
        let edges = differing(&bytes, &smooth, 8);
        println!("{edges} of {n} pixels lie on edges");
        assert!(edges * 5 < n);
        smoothed += usize::from(edges > 0);
    }
    // Whoever stands before a bare wall sees no edge.
    assert!(smoothed >= 4, "{smoothed}");
}

#[test]
fn no_pixel_stays_open() {
    let Some(gpu) = gpu() else { return };
    let mut samples = vec![Sample::named("museum"), Sample::named("cathedral")];
    samples.extend(Sample::freedoom("E1M1"));
    // The background; nothing is painted in this colour.
    let background = BACKGROUND.map(|c| (c * 255.0f64).round() as u8);
    for sample in &samples {
        let mut stage = Stage::new(&gpu, sample, 1, SIZE);
        for camera in &cameras(sample, 6) {
            let (_, bytes) = stage.draw(&look(camera));
            let open = bytes.chunks_exact(4).filter(|p| p[..3] == background);
            assert_eq!(open.count(), 0, "{}", sample.level.name);
        }
    }
}

#[test]
fn what_is_frozen_can_be_looked_at_from_elsewhere() {
    let Some(gpu) = gpu() else { return };
    let sample = Sample::named("museum");
    let mut stage = Stage::new(&gpu, &sample, 1, SIZE);
    let inside = cameras(&sample, 1)[0];
    let (own, _) = stage.draw(&look(&inside));
    let above = inside.eye + DVec3::new(-30.0, -30.0, 60.0);
    let camera = Camera::new(above, inside.eye - above, 75.0, SIZE);
    let frozen = Look {
        chosen_for: Some(&inside),
        ..look(&camera)
    };
    let (frame, bytes) = stage.draw(&frozen);
    keep("frozen", SIZE, &bytes);
    assert_eq!(frame.figures.cells, own.figures.cells);
    let background = BACKGROUND.map(|c| (c * 255.0f64).round() as u8);
    let drawn = bytes.chunks_exact(4).filter(|p| p[..3] != background);
    assert!(drawn.count() > 1000);
    // Of an eye that is in no cell all cells are drawn, and it is said why.
    let (frame, bytes) = stage.draw(&look(&camera));
    keep("above", SIZE, &bytes);
    assert!(matches!(frame.unculled, Some(EyeError::Outside(_))));
    assert_eq!(frame.figures.cells as usize, sample.graph.cells.len());
}

#[test]
fn a_small_level_without_pictures_or_things() {
    let Some(gpu) = gpu() else { return };
    let text = "name = \"Room\"\n[[room]]\nname = \"Room\"\nrect = [0, 0, 20, 4]\nceiling = 3\n";
    let sample = Sample::of(text, Doors::Open);
    let size = [33, 7];
    let mut stage = Stage::new(&gpu, &sample, 1, size);
    let camera = Camera::new(DVec3::new(2.0, 2.0, 1.1), DVec3::X, 90.0, size);
    let (frame, bytes) = stage.draw(&look(&camera));
    assert_eq!((bytes.len(), frame.calls), (33 * 7 * 4, 1));
    let (_, expected) = stage.paint(&look(&camera));
    assert_eq!(differing(&bytes, &expected, 1), 0, "{bytes:?} {expected:?}");
}

/// How much neighbours in a row differ, on average.
fn roughness(bytes: &[u8]) -> f64 {
    let pairs = bytes.chunks_exact(4).zip(bytes[4..].chunks_exact(4));
    let sum: f64 = pairs.map(|(p, q)| f64::from(p[1].abs_diff(q[1]))).sum();
    sum / (bytes.len() / 4) as f64
}

#[test]
fn pictures_far_away_are_smooth() {
    let Some(gpu) = gpu() else { return };
    let mut samples = vec![("gallery", Sample::named("gallery"))];
    samples.extend(Sample::freedoom("E1M1").map(|s| ("E1M1", s)));
    let size = [960, 600];
    for (name, sample) in &samples {
        let camera = &sample.level.scene.cameras[0];
        let camera = Camera::new(camera.eye, camera.direction, camera.fov, size);
        let plain = look(&camera);
        let smooth = Look {
            smooth: true,
            ..plain.clone()
        };
        let (_, plain) = Stage::new(&gpu, sample, 1, size).draw(&plain);
        let (_, smooth) = Stage::new(&gpu, sample, 4, size).draw(&smooth);
        keep(&format!("{name}-smooth"), size, &smooth);
        let [plain, smooth] = [plain, smooth].map(|bytes| roughness(&bytes));
        println!("{name}: neighbours differ by {plain:.2} levels, smoothed by {smooth:.2}");
        assert!(smooth < 0.8 * plain);
    }
}

#[test]
fn a_frame_of_a_large_map_is_a_tenth_of_it() {
    let Some(gpu) = gpu() else { return };
    let Some(sample) = Sample::freedoom("E1M5") else {
        return;
    };
    let mut stage = Stage::new(&gpu, &sample, 4, SIZE);
    let (mut shares, mut prepared, mut drawn) = (Vec::new(), Vec::new(), Vec::new());
    for camera in &cameras(&sample, 20) {
        let smooth = Look {
            smooth: true,
            ..look(camera)
        };
        let unculled = Look {
            culling: Culling::None,
            ..look(camera)
        };
        let (all, _) = stage.draw(&unculled);
        let device = (&gpu.device, &gpu.queue);
        let clock = std::time::Instant::now();
        let frame = (stage.scene).prepare(device, &stage.painter, &smooth, &mut stage.easel);
        prepared.push(clock.elapsed().as_secs_f64() * 1e3);
        let frame = frame.expect("it is on the grid");
        let clock = std::time::Instant::now();
        stage.draw(&smooth);
        drawn.push(clock.elapsed().as_secs_f64() * 1e3);
        shares.push(frame.figures.painted as f64 / all.figures.polygons as f64);
    }
    let median = |list: &mut Vec<f64>| {
        list.sort_by(f64::total_cmp);
        list[list.len() / 2]
    };
    let [share, prepared, drawn] = [&mut shares, &mut prepared, &mut drawn].map(median);
    println!(
        "E1M5: {:.2} % of its polygons in a frame; made ready in {prepared:.2} ms, drawn and read in {drawn:.1} ms",
        share * 100.0
    );
    assert!(share < 0.1, "{share}");
}
