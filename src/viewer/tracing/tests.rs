use std::time::Duration;

use glam::DVec3;

use super::*;
use crate::trace::render::Adaptive;
use crate::viewer::sample::Sample;

impl Stage for Sample {
    fn world(&self) -> &World {
        &self.world
    }

    fn graph(&self) -> &CellGraph {
        &self.graph
    }
}

/// No computer is so slow.
const LONG: Duration = Duration::from_secs(120);

struct Studio {
    tracing: Tracing,
    woken: Receiver<()>,
    stage: Arc<Sample>,
}

impl Studio {
    fn new(level: &str) -> Self {
        let (wake, woken) = channel();
        let tracing = Tracing::start(1, move || {
            // The test may have come to its end.
            let _ = wake.send(());
        });
        Self {
            tracing: tracing.expect("threads start"),
            woken,
            stage: Arc::new(Sample::named(level)),
        }
    }

    fn request(&self, size: [u32; 2], options: RenderOptions) -> Request {
        let camera = &self.stage.level.scene.cameras[0];
        Request {
            stage: self.stage.clone(),
            camera: Camera::new(camera.eye, camera.direction, camera.fov, size),
            options,
            exposure: Exposure::Auto,
        }
    }

    /// All reports up to the last.
    fn wait(&self) -> Vec<Report> {
        let mut all = Vec::new();
        loop {
            self.woken.recv_timeout(LONG).expect("it goes on");
            all.extend(self.tracing.reports());
            match all.last() {
                Some(Report::Picture(traced)) if !traced.done => {}
                Some(_) => return all,
                None => {}
            }
        }
    }
}

fn pictures(reports: Vec<Report>) -> Vec<Traced> {
    let picture = |report| match report {
        Report::Picture(traced) => traced,
        Report::Refused { .. } => panic!("{report:?}"),
    };
    reports.into_iter().map(picture).collect()
}

fn samples(samples: u32) -> RenderOptions {
    RenderOptions {
        samples,
        ..RenderOptions::default()
    }
}

#[test]
fn the_last_picture_is_what_render_makes() {
    let studio = Studio::new("tiny");
    let adaptive = Adaptive {
        samples: 6,
        contrast: 0.1,
        exposure: Exposure::Auto,
    };
    let refining = RenderOptions {
        adaptive: Some(adaptive),
        ..samples(1)
    };
    for options in [samples(1), samples(6), refining] {
        let request = studio.request([75, 50], options);
        studio.tracing.request(request.clone());
        let all = pictures(studio.wait());
        let world = studio.stage.world();
        let graph = studio.stage.graph();
        let eye = request.camera.eye;
        let cell = locate(world, graph, &Locator::new(graph), eye).expect("it is inside");
        let progress = Progress::default();
        let rendered = render(
            &Tracer::new(world),
            &request.camera,
            cell,
            &options,
            &progress,
        );
        let last = &all[all.len() - 1];
        assert_eq!(last.bytes, rendered.picture.srgb(Exposure::Auto));
        assert_eq!(
            (last.samples, last.refined),
            (options.samples, rendered.refined)
        );
        // From coarse to fine, from few samples to many.
        assert_eq!(
            (all[0].coarse, all[0].samples, all[0].done),
            (COARSEST, 1, false)
        );
        for pair in all.windows(2) {
            assert!(pair[0].coarse > pair[1].coarse || pair[0].samples <= pair[1].samples);
            assert!(pair[0].rays < pair[1].rays && pair[0].since <= pair[1].since);
        }
        assert!(
            all.iter()
                .all(|t| t.bytes.len() == 75 * 50 * 3 && t.size == [75, 50])
        );
        assert!(all.iter().any(|t| t.coarse == 1 && t.samples == 1));
    }
}

#[test]
fn the_newest_request_wins() {
    let studio = Studio::new("gallery");
    // Would take minutes.
    studio
        .tracing
        .request(studio.request([800, 600], samples(400)));
    studio.woken.recv_timeout(LONG).expect("the coarsest comes");
    let clock = Instant::now();
    let mut last = 0;
    for _ in 0..20 {
        last = studio.tracing.request(studio.request([40, 30], samples(1)));
    }
    let asked = clock.elapsed();
    let all = studio.wait();
    let served = clock.elapsed();
    println!("20 requests took {asked:?}, the last was served after {served:?}");
    assert!(all.iter().all(|r| r.request() == last));
    assert_eq!(pictures(all).last().map(|t| t.size), Some([40, 30]));
    // Whoever asks does not wait.
    assert!(asked < Duration::from_millis(500), "{asked:?}");
}

#[test]
fn a_stop_takes_no_time_worth_mentioning() {
    let studio = Studio::new("gallery");
    studio
        .tracing
        .request(studio.request([800, 600], samples(400)));
    studio.woken.recv_timeout(LONG).expect("the coarsest comes");
    let clock = Instant::now();
    studio.tracing.stop();
    let asked = clock.elapsed();
    assert_eq!(
        studio.tracing.reports().count(),
        0,
        "what it made is worthless"
    );
    assert!(studio.tracing.lives());
    // The end waits for the thread.
    drop(studio);
    let ended = clock.elapsed();
    println!("a stop took {asked:?}, the end {ended:?}");
    assert!(asked < Duration::from_millis(500), "{asked:?}");
    assert!(ended < Duration::from_secs(20), "{ended:?}");
}

#[test]
fn an_eye_in_a_wall_is_refused_and_the_thread_lives_on() {
    let studio = Studio::new("tiny");
    let mut request = studio.request([8, 8], samples(1));
    request.camera = Camera::new(DVec3::splat(-50.0), DVec3::X, 90.0, [8, 8]);
    studio.tracing.request(request);
    let reports = studio.wait();
    assert!(
        matches!(reports[..], [Report::Refused { .. }]),
        "{reports:?}"
    );
    studio.tracing.request(studio.request([8, 8], samples(1)));
    assert!(pictures(studio.wait()).last().is_some_and(|t| t.done));
}

#[test]
fn coarse_pixels_are_spread_evenly() {
    let picture = Picture {
        size: [2, 1],
        pixels: vec![DVec3::ZERO, DVec3::splat(8.0)],
    };
    let wide = enlarged(picture, 4, [7, 2]);
    let row: Vec<f64> = wide.pixels[..7].iter().map(|p| p.x).collect();
    assert_eq!(row, [0.0, 0.0, 1.0, 3.0, 5.0, 7.0, 8.0]);
    assert_eq!(wide.pixels[7..], wide.pixels[..7]);
}
