//! What studies run on: this computer, with its clock, its threads and its memory.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use rayon::ThreadPool;

use crate::cli::{Memory, compute};
use crate::pvs::Progress;
use crate::study::visibility::{Bench, Cost};

/// What a study runs on: this computer.
pub struct Desk {
    start: Instant,
    pool: ThreadPool,
    memory: Option<Memory>,
    status: Arc<Status>,
}

/// What is under way, for those who watch.
#[derive(Default)]
struct Status {
    now: Mutex<(String, Arc<Progress>)>,
}

impl Status {
    fn set(&self, change: impl FnOnce(&mut (String, Arc<Progress>))) {
        change(&mut self.now.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn line(&self, left: f64) -> String {
        let (what, progress) = self
            .now
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone();
        let left = left.max(0.0).ceil();
        let total = progress.total.load(Relaxed);
        let part = match (progress.done.load(Relaxed) * 100).checked_div(total) {
            Some(percent) => format!(", {} %", percent.min(100)),
            None => String::new(),
        };
        format!("{what}{part}; {left} s of the budget left")
    }
}

impl Desk {
    /// One with these threads; the clock starts now.
    pub fn new(pool: ThreadPool, memory: Option<Memory>) -> Self {
        Self {
            start: Instant::now(),
            pool,
            memory,
            status: Arc::default(),
        }
    }

    /// What is under way, and how much of the budget is left: a line, whenever it is asked.
    pub fn line(&self, budget: f64) -> impl Fn() -> String + Sync + use<> {
        let (start, status) = (self.start, Arc::clone(&self.status));
        move || status.line(budget - start.elapsed().as_secs_f64())
    }
}

impl Bench for Desk {
    fn next(&mut self, what: &str) {
        self.status
            .set(|now| *now = (what.to_string(), Arc::default()));
    }

    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn run(&mut self, limit: Option<f64>, work: &mut (dyn FnMut(&Progress) + Send)) -> Cost {
        let progress = Arc::new(Progress::default());
        self.status.set(|now| now.1 = Arc::clone(&progress));
        let before = self.memory.map(|memory| {
            (memory.forget_peak)();
            (memory.now)()
        });
        let start = Instant::now();
        compute::within(limit, &progress, || self.pool.install(|| work(&progress)));
        let seconds = start.elapsed().as_secs_f64();
        let peak = self.memory.map(|memory| (memory.peak)());
        let bytes = peak
            .zip(before)
            .map(|(peak, before)| peak.saturating_sub(before) as u64);
        Cost {
            seconds,
            bytes,
            stopped: progress.stopped(),
        }
    }

    fn machine(&self) -> (String, usize) {
        (machine(), self.pool.current_num_threads())
    }
}

/// The processor's name, where the system tells it, and the kind of system.
fn machine() -> String {
    let system = format!("{} on {}", std::env::consts::OS, std::env::consts::ARCH);
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = known.lines().find(|line| line.starts_with("model name"));
    match model.and_then(|line| line.split_once(':')) {
        Some((_, name)) => format!("{}, {system}", name.trim()),
        None => system,
    }
}
