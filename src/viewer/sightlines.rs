//! A sightline from one cell to every cell that it sees, found beside the window's thread.
//!
//! In: a document and a cell. Out: one segment for each pair, as they are found; each is checked exactly
//! ([`explain`]). O(cells seen) searches, each bounded in steps.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, channel};

use glam::DVec2;

use super::document::Document;
use crate::cells::CellId;
use crate::pvs::explain::{ExplainOptions, Explanation, explain};

/// Steps to look for a wide view; any view will do here.
const STEPS: u64 = 500;

/// The sightlines of a cell.
pub struct Sightlines {
    /// Whose.
    pub cell: CellId,
    /// In the level's unit.
    pub lines: Vec<[DVec2; 2]>,
    /// Whether all are there.
    pub complete: bool,
    found: Receiver<[DVec2; 2]>,
    stop: Arc<AtomicBool>,
    document: Arc<Document>,
}

impl Sightlines {
    /// Begins to find them; `wake` is called when there is something new.
    pub fn start(document: &Arc<Document>, cell: CellId, wake: impl Fn() + Send + 'static) -> Self {
        let (send, found) = channel();
        let stop = Arc::new(AtomicBool::new(false));
        let (own, halt) = (document.clone(), stop.clone());
        std::thread::spawn(move || {
            let Document { graph, pvs, .. } = &*own;
            let options = ExplainOptions {
                max_steps: STEPS,
                ..ExplainOptions::default()
            };
            for other in pvs.seen_from(cell).filter(|c| *c != cell) {
                if halt.load(Relaxed) {
                    return;
                }
                if let Some(Explanation::Visible(view)) = explain(graph, pvs, cell, other, &options)
                {
                    let ends = [&view.segment.from, &view.segment.to];
                    if send.send(ends.map(|p| own.to_level(p.approx()))).is_err() {
                        return;
                    }
                    wake();
                }
            }
            drop(send);
            wake();
        });
        Self {
            cell,
            lines: Vec::new(),
            complete: false,
            found,
            stop,
            document: document.clone(),
        }
    }

    /// Whether they are those of a cell of a document.
    pub fn are_of(&self, document: &Arc<Document>, cell: CellId) -> bool {
        self.cell == cell && Arc::ptr_eq(&self.document, document)
    }

    /// Takes in what has been found.
    pub fn fetch(&mut self) {
        use std::sync::mpsc::TryRecvError;
        loop {
            match self.found.try_recv() {
                Ok(line) => self.lines.push(line),
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    self.complete = true;
                    return;
                }
            }
        }
    }

    /// The longest, with its length.
    pub fn longest(&self) -> Option<([DVec2; 2], f64)> {
        let long = |[a, b]: &[DVec2; 2]| a.distance(*b);
        let longest = self
            .lines
            .iter()
            .max_by(|p, q| long(p).total_cmp(&long(q)))?;
        Some((*longest, long(longest)))
    }
}

impl Drop for Sightlines {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
    }
}
