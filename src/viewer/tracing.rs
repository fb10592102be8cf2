//! Ray traced pictures beside the window's thread: coarse at once, then finer and finer.
//!
//! In: [`Request`]s; each makes what is under way worthless, and the newest wins. Out: [`Report`]s, each
//! with a whole picture: first with large pixels, then with those of the screen, then with more and more
//! samples in each; the last one is the very picture that [`render`] makes. A thread of its own takes the
//! requests, and a pool of its own renders, so that whoever asks never waits: pixels ask whether their
//! picture is still wanted before they begin.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

use glam::DVec3;

use crate::cells::{CellGraph, Locator};
use crate::pvs::Progress;
use crate::trace::camera::Camera;
use crate::trace::picture::{Exposure, Picture};
use crate::trace::render::{RenderOptions, Rendered, render};
use crate::trace::world::{EyeError, Tracer, World, locate};

/// Side of the first picture's pixels, in pixels of the screen.
const COARSEST: u32 = 8;
/// A finer picture that would take longer than this, in milliseconds, has another before it.
const PATIENCE: f64 = 150.0;
/// How many times as many samples each picture has as the one before.
const MORE: u32 = 4;

/// What there is to render.
pub trait Stage: Send + Sync {
    /// What rays meet.
    fn world(&self) -> &World;
    /// Its cells.
    fn graph(&self) -> &CellGraph;
}

/// A picture that is wanted.
#[derive(Clone)]
pub struct Request {
    /// Of what.
    pub stage: Arc<dyn Stage>,
    /// From where.
    pub camera: Camera,
    /// The last picture's.
    pub options: RenderOptions,
    /// How bright it comes out.
    pub exposure: Exposure,
}

/// A picture that is ready.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// Number of the request.
    pub request: u64,
    /// Pixels across and down: those of the screen.
    pub size: [u32; 2],
    /// sRGB, three bytes to a pixel, rows from the top.
    pub bytes: Vec<u8>,
    /// Side of its own pixels, in pixels of the screen.
    pub coarse: u32,
    /// Samples in each of its pixels.
    pub samples: u32,
    /// Pixels that got more samples.
    pub refined: u64,
    /// Milliseconds that this picture took.
    pub milliseconds: f64,
    /// Milliseconds since the request was taken up.
    pub since: f64,
    /// Rays that this picture took, of all kinds.
    pub rays: u64,
    /// Whether it is the last.
    pub done: bool,
}

/// What the thread has to say.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// A picture.
    Picture(Traced),
    /// There is none from there.
    Refused {
        /// Number of the request.
        request: u64,
        /// Why.
        error: EyeError,
    },
}

impl Report {
    /// Number of the request.
    pub fn request(&self) -> u64 {
        match self {
            Self::Picture(traced) => traced.request,
            Self::Refused { request, .. } => *request,
        }
    }
}

/// A thread that renders.
pub struct Tracing {
    requests: Option<Sender<(u64, Request)>>,
    reports: Receiver<Report>,
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

/// What both threads look at.
#[derive(Default)]
struct Desk {
    /// Number of the newest request; of a stop, too.
    newest: AtomicU64,
    /// Of what is under way.
    progress: Mutex<Arc<Progress>>,
}

impl Desk {
    /// Makes everything before worthless. Number of what comes now.
    fn turn(&self) -> u64 {
        // Under the lock, so that nothing begins between the two.
        let progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.stop();
        self.newest.fetch_add(1, Relaxed) + 1
    }

    /// Begins something for a request, unless it is worthless.
    fn begin(&self, request: u64) -> Option<Arc<Progress>> {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        (self.newest.load(Relaxed) == request).then(|| {
            *progress = Arc::default();
            progress.clone()
        })
    }
}

impl Tracing {
    /// Starts the thread, with so many to render (at least one); best one fewer than there are processors.
    /// `wake` is called whenever there is something new.
    pub fn start(threads: usize, wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (requests, wanted) = channel();
        let (send, reports) = channel();
        let desk = Arc::new(Desk::default());
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .thread_name(|i| format!("tracing {i}"))
            .build()
            .map_err(std::io::Error::other)?;
        let worker = Worker {
            desk: desk.clone(),
            pool,
            tell: Box::new(move |report| {
                // Whoever does not listen any more has closed the window.
                let heard = send.send(report).is_ok();
                wake();
                heard
            }),
        };
        let thread = std::thread::Builder::new()
            .name("tracing".to_string())
            .spawn(move || worker.run(&wanted))?;
        Ok(Self {
            requests: Some(requests),
            reports,
            desk,
            thread: Some(thread),
        })
    }

    /// Asks for a picture; what is under way ends soon. Its number.
    pub fn request(&self, request: Request) -> u64 {
        let number = self.desk.turn();
        if let Some(requests) = &self.requests {
            // It only fails where the thread is gone, and then there are no reports either.
            let _ = requests.send((number, request));
        }
        number
    }

    /// Ends what is under way.
    pub fn stop(&self) {
        self.desk.turn();
    }

    /// What is new of the newest request, in order.
    pub fn reports(&self) -> impl Iterator<Item = Report> + '_ {
        let newest = self.desk.newest.load(Relaxed);
        self.reports
            .try_iter()
            .filter(move |r| r.request() == newest)
    }

    /// Which share of the picture under way is done, 0 to 1.
    pub fn share(&self) -> f64 {
        let progress = self.desk.progress.lock();
        let progress = progress.unwrap_or_else(PoisonError::into_inner);
        let [done, total] = [&progress.done, &progress.total].map(|n| n.load(Relaxed));
        (done as f64 / total.max(1) as f64).min(1.0)
    }

    /// Whether the thread still lives. It ends early only by a mistake in the program.
    pub fn lives(&self) -> bool {
        self.thread.as_ref().is_some_and(|t| !t.is_finished())
    }
}

impl Drop for Tracing {
    fn drop(&mut self) {
        self.stop();
        self.requests = None;
        if let Some(thread) = self.thread.take() {
            // If it failed, it has said so itself.
            let _ = thread.join();
        }
    }
}

struct Worker {
    desk: Arc<Desk>,
    pool: rayon::ThreadPool,
    /// Whether somebody heard it.
    tell: Box<dyn Fn(Report) -> bool + Send>,
}

impl Worker {
    fn run(&self, wanted: &Receiver<(u64, Request)>) {
        while let Ok(mut next) = wanted.recv() {
            // Of several, only the newest counts.
            if let Some(newer) = wanted.try_iter().last() {
                next = newer;
            }
            self.serve(next.0, &next.1);
        }
    }

    /// Renders one picture after the other, until the request is served or worthless.
    fn serve(&self, number: u64, request: &Request) {
        let start = Instant::now();
        let stage = &*request.stage;
        let locator = Locator::new(stage.graph());
        let cell = locate(stage.world(), stage.graph(), &locator, request.camera.eye);
        let cell = match cell {
            Ok(cell) => cell,
            Err(error) => {
                let request = number;
                (self.tell)(Report::Refused { request, error });
                return;
            }
        };
        let tracer = Tracer::new(stage.world());
        let mut step = Step::first();
        loop {
            let Some(progress) = self.desk.begin(number) else {
                return;
            };
            let clock = Instant::now();
            let camera = request.camera.coarser(step.coarse);
            let options = step.options(&request.options);
            let rendered =
                (self.pool).install(|| render(&tracer, &camera, cell, &options, &progress));
            if progress.stopped() {
                return;
            }
            let milliseconds = clock.elapsed().as_secs_f64() * 1e3;
            let next = step.next(&request.options, milliseconds);
            let Rendered {
                picture,
                work,
                refined,
            } = rendered;
            let rays = work.rays;
            let picture = enlarged(picture, step.coarse, request.camera.size);
            let heard = (self.tell)(Report::Picture(Traced {
                request: number,
                size: picture.size,
                bytes: picture.srgb(request.exposure),
                coarse: step.coarse,
                samples: step.samples,
                refined,
                milliseconds,
                since: start.elapsed().as_secs_f64() * 1e3,
                rays: rays.primary + rays.shadow + rays.reflected + rays.refracted,
                done: next.is_none(),
            }));
            match next {
                Some(next) if heard => step = next,
                _ => return,
            }
        }
    }
}

/// One of the pictures on the way to the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Step {
    /// Side of its pixels in pixels of the screen.
    coarse: u32,
    samples: u32,
    /// Whether it is the one that was asked for.
    last: bool,
}

impl Step {
    fn first() -> Self {
        Self {
            coarse: COARSEST,
            samples: 1,
            last: false,
        }
    }

    /// What comes after a picture that took so long.
    fn next(self, options: &RenderOptions, milliseconds: f64) -> Option<Self> {
        if self.last {
            return None;
        }
        let samples = options.samples.max(1);
        // One sample in each of the screen's pixels.
        let whole = milliseconds * f64::from(self.coarse * self.coarse);
        if self.coarse > 2 && whole > PATIENCE {
            return Some(Self {
                coarse: self.coarse / 2,
                ..self
            });
        }
        let samples_now = match self.coarse {
            1 => self.samples.saturating_mul(MORE),
            _ => 1,
        };
        // Where neighbours differ is looked for in the last one only.
        let last = samples_now >= samples && (self.coarse == 1 || options.adaptive.is_none());
        Some(Self {
            coarse: 1,
            samples: samples_now.min(samples),
            last,
        })
    }

    fn options(self, options: &RenderOptions) -> RenderOptions {
        RenderOptions {
            samples: self.samples,
            adaptive: options.adaptive.filter(|_| self.last),
            ..*options
        }
    }
}

/// A picture with pixels `n` times as wide and high as those of a screen of this size, on that screen: between
/// the middles of its pixels colours change evenly.
fn enlarged(picture: Picture, n: u32, size: [u32; 2]) -> Picture {
    if n == 1 {
        return picture;
    }
    let [width, height] = picture.size.map(|k| k as usize);
    // The two pixels between whose middles it lies, and how far towards the second.
    let between = |at: u32, most: usize| {
        let at = ((f64::from(at) + 0.5) / f64::from(n) - 0.5).clamp(0.0, (most - 1) as f64);
        let low = at as usize;
        (low, (low + 1).min(most - 1), at - low as f64)
    };
    let mut pixels: Vec<DVec3> = Vec::with_capacity(size[0] as usize * size[1] as usize);
    for y in 0..size[1] {
        let (top, bottom, down) = between(y, height);
        for x in 0..size[0] {
            let (left, right, across) = between(x, width);
            let row = |y: usize| {
                let [p, q] = [left, right].map(|x| picture.pixels[y * width + x]);
                p.lerp(q, across)
            };
            pixels.push(row(top).lerp(row(bottom), down));
        }
    }
    Picture { size, pixels }
}

#[cfg(test)]
mod tests;
