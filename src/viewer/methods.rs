//! What each way to a PVS costs in this very level, and what it gets wrong: measured when one asks.
//!
//! In: a document, whose PVS is exact, and a [`Contender`]. Out: a [`Rival`] with its own visible sets, its
//! time, and how it differs. One at a time is computed, beside the window's thread.

use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Instant;

use super::document::Document;
use crate::cells::CellGraph;
use crate::pvs::flow::FlowOptions;
use crate::pvs::heights::HeightsOptions;
use crate::pvs::sample::SampleOptions;
use crate::pvs::{self, Method, Progress, Pvs, PvsOptions};

/// A way to visible sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contender {
    /// On the plan.
    Method(Method),
    /// With floors and ceilings.
    Heights,
}

impl Contender {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Method(Method::Sweep),
        Self::Method(Method::Search),
        Self::Heights,
        Self::Method(Method::Lp),
        Self::Method(Method::Flow),
        Self::Method(Method::Flood),
        Self::Method(Method::Sample),
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Method(method) => method.as_str(),
            Self::Heights => "heights",
        }
    }

    /// What it is, for somebody who points at it.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Method(Method::Sweep) => {
                "exact: about every vertex in turn; what the window shows"
            }
            Self::Method(Method::Search) => "exact: depth first through chains of portals",
            Self::Method(Method::Lp) => {
                "depth first, with a linear programme in floating point for every chain"
            }
            Self::Method(Method::Flow) => {
                "portal flow with separators in floating point, as the Quake tools do it"
            }
            Self::Method(Method::Flood) => "everything that open portals lead to",
            Self::Method(Method::Sample) => "random sightlines: it misses some",
            Self::Heights => "floors and ceilings count too: what is fewer is hidden by them",
        }
    }
}

/// What a contender came to.
pub struct Rival {
    /// Which.
    pub contender: Contender,
    /// Who sees whom, as it says.
    pub pvs: Pvs,
    /// How long it took.
    pub milliseconds: f64,
    /// Ordered pairs that it has and the exact PVS has not.
    pub extra: u64,
    /// Ordered pairs that it has not.
    pub missed: u64,
}

/// What has been measured in a document.
#[derive(Default)]
pub struct Methods {
    /// What is known.
    pub rivals: Vec<Rival>,
    /// Whose visible sets the plan compares.
    pub shown: Option<Contender>,
    running: Option<Running>,
}

struct Running {
    contender: Contender,
    progress: Arc<Progress>,
    result: Receiver<Option<Rival>>,
}

impl Methods {
    /// Measures one, unless another is being measured.
    pub fn measure(
        &mut self,
        document: &Arc<Document>,
        contender: Contender,
        wake: impl Fn() + Send + 'static,
    ) {
        if self.running.is_some() {
            return;
        }
        let (send, result) = channel();
        let progress = Arc::new(Progress::default());
        let (own, counter) = (document.clone(), progress.clone());
        std::thread::spawn(move || {
            _ = send.send(measure(&own, contender, &counter));
            wake();
        });
        self.running = Some(Running {
            contender,
            progress,
            result,
        });
    }

    /// Takes in what is ready.
    pub fn fetch(&mut self) {
        let Some(running) = &self.running else { return };
        match running.result.try_recv() {
            Err(TryRecvError::Empty) => return,
            Ok(Some(rival)) => {
                self.rivals.retain(|r| r.contender != rival.contender);
                self.rivals.push(rival);
            }
            Ok(None) | Err(TryRecvError::Disconnected) => {}
        }
        self.running = None;
    }

    /// What is being measured, and how far it has come, from 0 to 1.
    pub fn running(&self) -> Option<(Contender, f32)> {
        let running = self.running.as_ref()?;
        let [done, total] =
            [&running.progress.done, &running.progress.total].map(|n| n.load(Relaxed) as f32);
        Some((running.contender, done / total.max(1.0)))
    }

    /// Asks it to end.
    pub fn stop(&self) {
        if let Some(running) = &self.running {
            running.progress.stop();
        }
    }

    /// What is known of one.
    pub fn of(&self, contender: Contender) -> Option<&Rival> {
        self.rivals.iter().find(|r| r.contender == contender)
    }

    /// Whose sets the plan compares.
    pub fn compared(&self) -> Option<&Rival> {
        self.shown.and_then(|shown| self.of(shown))
    }
}

impl Drop for Methods {
    fn drop(&mut self) {
        self.stop();
    }
}

/// `None` if it was asked to end and has no answer then.
fn measure(document: &Document, contender: Contender, progress: &Progress) -> Option<Rival> {
    let options = PvsOptions {
        method: match contender {
            Contender::Method(method) => method,
            Contender::Heights => Method::Search,
        },
        heights: (contender == Contender::Heights).then(HeightsOptions::default),
        max_steps: None,
        sample: SampleOptions::default(),
        flow: FlowOptions::of(&document.level),
    };
    let start = Instant::now();
    let pvs = pvs::compute(&document.graph, &options, progress)?;
    let milliseconds = start.elapsed().as_secs_f64() * 1e3;
    if progress.stopped() {
        return None;
    }
    let [extra, missed] = differences(&document.graph, &document.pvs, &pvs);
    Some(Rival {
        contender,
        pvs,
        milliseconds,
        extra,
        missed,
    })
}

/// Ordered pairs that only the second has, and those that only the first has.
fn differences(graph: &CellGraph, exact: &Pvs, other: &Pvs) -> [u64; 2] {
    let only = |a: &Pvs, b: &Pvs| -> u64 {
        let cells = graph.cell_ids();
        let of = |c| a.seen_from(c).filter(|d| !b.sees(c, *d)).count() as u64;
        cells.map(of).sum()
    };
    [only(other, exact), only(exact, other)]
}
