//! Changing the level on the plan, and seeing at once what becomes of cells and PVS.
//!
//! In: what is grabbed and dragged on the plan. Out: a new level, made ready beside the window's thread;
//! when it is there it takes the old one's place, and the change in what is seen is told. While a corner
//! is dragged only its newest place counts. Everything can be undone.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use eframe::egui;
use glam::DVec2;

use super::app::App;
use super::document::{Document, Saver};
use crate::geom::GridPoint;
use crate::level::edit::{History, move_point, near, toggle};
use crate::level::toml::write;
use crate::level::{Level, WallKind};

/// Memory for levels that were changed.
const MEMORY: usize = 256 << 20;

/// A level that is being changed.
pub struct Editing {
    history: History,
    /// The corner that is dragged, and whether it has moved yet.
    grabbed: Option<(GridPoint, bool)>,
    /// Whether the present level is not shown yet, and not in the making.
    stale: bool,
    making: Option<Receiver<Result<Document, String>>>,
    /// What the last change has done, or why it was refused.
    pub note: String,
    saving: Option<Receiver<Result<String, String>>>,
}

impl App {
    /// Begins to change the level, or ends it. What was changed stays.
    pub fn edit(&mut self) {
        self.editing = match (&self.document, self.editing.take()) {
            (Some(document), None) => Some(Editing {
                history: History::new(Arc::new(document.level.clone()), MEMORY),
                grabbed: None,
                stale: false,
                making: None,
                note: "drag a corner of a wall, or click a door".to_string(),
                saving: None,
            }),
            _ => None,
        };
    }

    /// Somebody presses on the plan: takes hold of a corner, if there is one.
    pub(super) fn grab(&mut self, at: DVec2, within: f64) -> bool {
        let Some(editing) = &mut self.editing else {
            return false;
        };
        let found = near::point(editing.history.present(), at, within);
        editing.grabbed = found.map(|p| (p, false));
        found.is_some()
    }

    /// The corner is dragged to a place.
    pub(super) fn drag(&mut self, to: DVec2) {
        let Some(editing) = &mut self.editing else {
            return;
        };
        let Some((from, moved)) = editing.grabbed else {
            return;
        };
        let level = editing.history.present().clone();
        match move_point(&level, from, to) {
            Ok(new) => {
                // Where the corner is now on the new level's grid.
                let Some(now) = new.grid.nearest(to) else {
                    return;
                };
                if moved {
                    editing.history.amend(Arc::new(new));
                } else {
                    editing.history.change(Arc::new(new));
                }
                editing.grabbed = Some((now, true));
                editing.stale = true;
            }
            Err(error) => editing.note = error.to_string(),
        }
    }

    /// The corner is let go.
    pub(super) fn drop_corner(&mut self) {
        if let Some(editing) = &mut self.editing {
            editing.grabbed = None;
        }
    }

    /// Opens or closes the door next to a place. The first time, all other doors are opened: until then
    /// all counted as open.
    pub fn toggle_door(&mut self, at: DVec2, within: f64) -> bool {
        let Some(editing) = &mut self.editing else {
            return false;
        };
        let mut level = Level::clone(editing.history.present());
        if !self.settings.closed {
            for wall in &mut level.walls {
                if let WallKind::Opening(opening) = &mut wall.kind {
                    opening.shut = false;
                }
            }
        }
        let Some(door) = near::opening(&level, at, within) else {
            return false;
        };
        match toggle(&level, door) {
            Ok(new) => {
                self.settings.closed = true;
                editing.history.change(Arc::new(new));
                editing.stale = true;
            }
            Err(error) => editing.note = error.to_string(),
        }
        true
    }

    /// Takes the last change back, or does it again.
    pub fn undo(&mut self, again: bool) {
        if let Some(editing) = &mut self.editing {
            let history = &mut editing.history;
            let done = if again {
                history.redo()
            } else {
                history.undo()
            };
            editing.stale |= done;
            if !done {
                editing.note = "there is nothing left to take back".to_string();
            }
        }
    }

    /// How many changes can be taken back.
    pub fn changes(&self) -> usize {
        self.editing.as_ref().map_or(0, |e| e.history.n_past())
    }

    /// Has the newest level made ready, and shows it when it is.
    pub(super) fn follow_edits(&mut self) {
        let Some(mut editing) = self.editing.take() else {
            return;
        };
        if let Some(making) = editing.making.take() {
            match making.try_recv() {
                Ok(Ok(document)) => {
                    let pairs = |d: &Document| d.sees.iter().map(|n| u64::from(*n)).sum::<u64>();
                    let new = pairs(&document);
                    let old = self.document.as_ref().map_or(new, |d| pairs(d));
                    let stages = document.stages;
                    editing.note = format!(
                        "{:.1} ms to cut, {:.1} ms to see; visible pairs {old}, now {new} ({:+.1} %)",
                        stages.subdivide,
                        stages.visibility,
                        (new as f64 / old.max(1) as f64 - 1.0) * 100.0
                    );
                    self.show(document);
                }
                Ok(Err(error)) => editing.note = error,
                Err(TryRecvError::Empty) => editing.making = Some(making),
                Err(TryRecvError::Disconnected) => {
                    editing.note = "the level could not be made ready".to_string();
                }
            }
        }
        if let Some(saving) = editing.saving.take() {
            match saving.try_recv() {
                Ok(Ok(said)) => editing.note = said,
                Ok(Err(error)) => self.error = Some(error),
                Err(TryRecvError::Empty) => editing.saving = Some(saving),
                Err(TryRecvError::Disconnected) => {}
            }
        }
        if editing.stale
            && editing.making.is_none()
            && let Some(old) = &self.document
        {
            let (send, making) = channel();
            let level = editing.history.present().clone();
            let (place, files) = ((old.path.clone(), old.map.clone()), old.files.clone());
            let doors = self.settings.doors();
            let (context, voice) = (self.context.clone(), old.voice);
            std::thread::spawn(move || {
                _ = send.send(Document::new(
                    place,
                    Level::clone(&level),
                    files,
                    doors,
                    voice,
                ));
                context.request_repaint();
            });
            editing.stale = false;
            editing.making = Some(making);
        }
        self.editing = Some(editing);
    }

    /// Saves the level as it is now, in the own format.
    pub fn save(&mut self, path: PathBuf) {
        let Some(document) = self.document.clone() else {
            return;
        };
        if self.editing.is_none() {
            self.edit();
        }
        let (send, saving) = channel();
        let (context, saver) = (self.context.clone(), self.services.save);
        std::thread::spawn(move || {
            _ = send.send(save(&document.level, &path, saver));
            context.request_repaint();
        });
        if let Some(editing) = &mut self.editing {
            editing.saving = Some(saving);
        }
    }

    /// Tells what changes do, and takes them back.
    pub(super) fn edit_bar(&mut self, ui: &mut egui::Ui) {
        let Some(editing) = &self.editing else { return };
        let (past, future) = (editing.history.n_past(), editing.history.n_future());
        let note = editing.note.clone();
        ui.horizontal(|ui| {
            ui.strong("editing");
            let undo = egui::Button::new("Undo");
            if ui.add_enabled(past > 0, undo).clicked() {
                self.undo(false);
            }
            let redo = egui::Button::new("Redo");
            if ui.add_enabled(future > 0, redo).clicked() {
                self.undo(true);
            }
            ui.label(note);
        });
    }
}

/// Writes a level.
fn save(level: &Level, path: &Path, saver: Saver) -> Result<String, String> {
    let name = path.display();
    let written = write::write(level).map_err(|e| format!("{name}: {e}"))?;
    saver(path, written.text.as_bytes())?;
    Ok(match written.left_out.len() {
        0 => format!("saved as {name}"),
        _ => format!("saved as {name}, without {}", written.left_out.join(", ")),
    })
}
