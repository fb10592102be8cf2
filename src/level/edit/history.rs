//! Undo and redo.

use std::collections::VecDeque;
use std::mem::{size_of, size_of_val};
use std::sync::Arc;

use super::super::model::{Level, Sector, Wall};

/// A level with its past and, after undoing, its future. Old levels are forgotten where all of them
/// would take more than a given number of bytes; the present one never is.
#[derive(Clone, Debug)]
pub struct History {
    past: VecDeque<Arc<Level>>,
    present: Arc<Level>,
    future: Vec<Arc<Level>>,
    most_bytes: usize,
}

impl History {
    /// Starts with a level that has no past.
    pub fn new(level: Arc<Level>, most_bytes: usize) -> History {
        History {
            past: VecDeque::new(),
            present: level,
            future: Vec::new(),
            most_bytes,
        }
    }

    /// The level as it is now.
    pub fn present(&self) -> &Arc<Level> {
        &self.present
    }

    /// Goes on to a changed level; what was undone before can no longer be done again.
    pub fn change(&mut self, level: Arc<Level>) {
        self.future.clear();
        let old = std::mem::replace(&mut self.present, level);
        self.past.push_back(old);
        self.forget();
    }

    /// As [`History::change`], but as one step with the change before: while a corner is dragged,
    /// only its last place counts.
    pub fn amend(&mut self, level: Arc<Level>) {
        self.future.clear();
        self.present = level;
        self.forget();
    }

    /// Takes the last change back; whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some(old) = self.past.pop_back() else {
            return false;
        };
        self.future.push(std::mem::replace(&mut self.present, old));
        true
    }

    /// Does again what was undone last; whether there was anything.
    pub fn redo(&mut self) -> bool {
        let Some(new) = self.future.pop() else {
            return false;
        };
        self.past
            .push_back(std::mem::replace(&mut self.present, new));
        true
    }

    /// How many changes can be taken back.
    pub fn n_past(&self) -> usize {
        self.past.len()
    }

    /// How many can be done again.
    pub fn n_future(&self) -> usize {
        self.future.len()
    }

    fn forget(&mut self) {
        let mut all: usize = self
            .past
            .iter()
            .chain([&self.present])
            .map(|l| bytes(l))
            .sum();
        while all > self.most_bytes
            && let Some(oldest) = self.past.pop_front()
        {
            all -= bytes(&oldest);
        }
    }
}

/// About how much memory a level takes.
fn bytes(level: &Level) -> usize {
    let scene = &level.scene;
    // Names and meshes' corners are little beside the rest.
    size_of::<Level>()
        + level.walls.len() * size_of::<Wall>()
        + level.sectors.len() * size_of::<Sector>()
        + size_of_val(&*level.outlines)
        + size_of_val(&*scene.materials)
        + size_of_val(&*scene.lights)
        + size_of_val(&*scene.objects)
        + size_of_val(&*scene.dress.lines)
        + size_of_val(&*scene.dress.flats)
        + level
            .findings
            .iter()
            .map(|f| size_of_val(&*f.places))
            .sum::<usize>()
}
