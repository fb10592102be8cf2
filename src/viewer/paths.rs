//! Walks: those of the level are played, new ones recorded and saved.
//!
//! A recorded walk is kept until the level is closed; it is saved at the end of the level's own file, if
//! that is of the own format, or in a file that holds walks alone ([`walks`]).

use std::path::{Path, PathBuf};

use eframe::egui;
use glam::{DVec2, DVec3};

use super::app::App;
use super::document::Saver;
use super::walker::Walker;
use super::windows::centred;
use crate::level::scene::{CameraPath, PathLook, PathPace};
use crate::level::toml::{walks, write};
use crate::walk::{Ground, Track, TrackOptions, tour};

/// Places of a recorded walk lie at least so far apart, in heights of a person.
const APART: f64 = 0.35;

/// A path that is played.
pub struct Play {
    /// The way.
    pub track: Track,
    /// What it is called.
    pub name: String,
    /// Seconds since its start.
    pub at: f64,
    /// Whether it goes on.
    pub running: bool,
    /// The way on the plan.
    pub line: Vec<DVec2>,
}

/// A walk in the making.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Where the eye was.
    pub points: Vec<DVec3>,
    seconds: f64,
}

impl Recording {
    /// The eye is at a place, so many seconds after the last one. Standing still takes no time.
    fn go_on(&mut self, eye: DVec3, seconds: f64, apart: f64) {
        match self.points.last() {
            Some(last) if last.distance(eye) < apart => {
                if *last != eye {
                    self.seconds += seconds;
                }
            }
            _ => {
                self.seconds += seconds;
                self.points.push(eye);
            }
        }
    }

    /// How far it has come.
    pub fn length(&self) -> f64 {
        let parts = self.points.windows(2);
        parts.map(|p| p[0].distance(p[1])).sum()
    }

    /// A walk to keep; `None` if it goes nowhere.
    fn finish(self, name: String, fov: f64) -> Option<CameraPath> {
        let speed = self.length() / self.seconds;
        (self.points.len() > 1 && speed.is_finite() && speed > 0.0).then_some(CameraPath {
            name,
            points: self.points,
            eye: None,
            closed: false,
            look: PathLook::Ahead,
            pace: PathPace::Speed(speed),
            fov,
        })
    }
}

/// A walk that is about to be saved.
pub struct Saving {
    /// The walk.
    pub path: CameraPath,
    /// Whether at the end of the level's file.
    pub within: bool,
    /// The other file, as it is typed.
    pub file: String,
}

impl App {
    /// The level's walks, and those that were recorded or read since.
    pub fn paths(&self) -> Vec<CameraPath> {
        let own = self.document.iter().flat_map(|d| &d.level.scene.paths);
        own.chain(&self.walks).cloned().collect()
    }

    /// Starts a path, or, without a name, a tour.
    pub fn play(&mut self, name: Option<&str>) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let options = TrackOptions::default();
        let (graph, space) = (&document.graph, &document.world.space);
        let track = match name {
            Some(name) => {
                let paths = self.paths();
                let path = paths.iter().find(|p| p.name == name);
                path.map(|path| Track::new(path, &Ground::new(graph, space), &options))
            }
            None => {
                tour(&document.standing, graph, space, &document.person).map(|t| t.track(&options))
            }
        };
        self.play = track.map(|track| Play {
            line: track.points().iter().map(|p| p.truncate()).collect(),
            track,
            name: name.unwrap_or("tour").to_string(),
            at: 0.0,
            running: true,
        });
        match &self.play {
            // Whoever still moves by hand would end it.
            Some(_) => self.eye = Walker::new(self.eye.eye, self.eye.direction(), self.eye.mode),
            None => self.error = Some("there is no way to walk here".to_string()),
        }
    }

    /// Goes on along a path, and along what is recorded.
    pub(super) fn walk_on(&mut self, seconds: f64) {
        if let Some(play) = &mut self.play {
            if play.running {
                play.at += seconds;
                if play.at > play.track.seconds() {
                    play.at = 0.0;
                }
                self.context.request_repaint();
            }
            let pose = play.track.at(play.at);
            self.eye = Walker::new(pose.eye, pose.direction, self.eye.mode);
        }
        if let (Some(recording), Some(document)) = (&mut self.recording, &self.document) {
            let apart = APART * document.person.height;
            recording.go_on(self.eye.eye, seconds, apart);
        }
    }

    /// Begins to record a walk, or ends it and asks where to save it.
    pub fn record(&mut self) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let Some(recording) = self.recording.take() else {
            self.play = None;
            let mut recording = Recording::default();
            recording.go_on(self.eye.eye, 0.0, 0.0);
            self.recording = Some(recording);
            return;
        };
        let paths = self.paths();
        let taken = |name: &String| paths.iter().any(|p| p.name == *name);
        let mut names = (1..).map(|k| format!("walk {k}"));
        let Some(name) = names.find(|name| !taken(name)) else {
            return;
        };
        let Some(path) = recording.finish(name, self.settings.fov) else {
            self.error = Some("the eye has not moved, so there is no walk to keep".to_string());
            return;
        };
        self.walks.push(path.clone());
        let stem = document.path.file_stem().map(|s| s.to_string_lossy());
        self.keeping = Some(Saving {
            within: document.is_in_own_format(),
            file: format!("{}.walks.toml", stem.unwrap_or_default()),
            path,
        });
    }

    /// Saves a walk.
    pub fn keep(&mut self, saving: &Saving) {
        let Some(document) = &self.document else {
            return;
        };
        let file = if saving.within {
            document.path.clone()
        } else {
            PathBuf::from(&saving.file)
        };
        match append(&file, &saving.path, saving.within, self.services.save) {
            Ok(()) => {
                self.note = Some(format!(
                    "walk `{}` saved in {}",
                    saving.path.name,
                    file.display()
                ));
                if saving.within {
                    // The level is read again, and has it then.
                    self.walks.retain(|w| w.name != saving.path.name);
                    self.reload();
                }
            }
            Err(error) => self.error = Some(error),
        }
    }

    /// Reads a file of walks.
    pub fn open_walks(&mut self, file: &Path) {
        let text = std::fs::read_to_string(file).map_err(|e| e.to_string());
        let read = text.and_then(|text| walks::read(&text).map_err(|e| e.to_string()));
        match read {
            Ok(read) => {
                let names: Vec<String> = read.iter().map(|w| w.name.clone()).collect();
                self.walks.retain(|w| !names.contains(&w.name));
                self.walks.extend(read);
                if let Some(first) = names.first() {
                    self.play(Some(first));
                }
            }
            Err(error) => self.error = Some(format!("{}: {error}", file.display())),
        }
    }

    /// Asks where to save a walk.
    pub(super) fn keep_window(&mut self, context: &egui::Context) {
        let Some(mut saving) = self.keeping.take() else {
            return;
        };
        let document = self.document.clone();
        let own = document.as_ref().filter(|d| d.is_in_own_format());
        let (mut open, mut go, mut leave) = (true, false, false);
        centred("Save the walk", context)
            .open(&mut open)
            .resizable(false)
            .show(context, |ui| {
                ui.horizontal(|ui| {
                    ui.label("name");
                    ui.text_edit_singleline(&mut saving.path.name);
                });
                if let Some(document) = own {
                    let name = document
                        .path
                        .file_name()
                        .unwrap_or_default()
                        .to_string_lossy();
                    let text = format!("at the end of {name}");
                    ui.radio_value(&mut saving.within, true, text);
                }
                ui.horizontal(|ui| {
                    ui.radio_value(&mut saving.within, false, "in a file of its own");
                    ui.add_enabled(!saving.within, egui::TextEdit::singleline(&mut saving.file));
                });
                ui.horizontal(|ui| {
                    go = ui.button("Save").clicked();
                    leave = ui.button("Not now").clicked();
                });
            });
        if go {
            // What was recorded has the name that was typed.
            if let Some(last) = self.walks.last_mut() {
                last.name.clone_from(&saving.path.name);
            }
            self.keep(&saving);
        } else if open && !leave {
            self.keeping = Some(saving);
        }
    }
}

/// Puts a walk at the end of a level's file, or of a file of walks, which is made if there is none. The file
/// is read first, and is as it was if the walk does not fit into it.
fn append(file: &Path, path: &CameraPath, level: bool, save: Saver) -> Result<(), String> {
    let name = file.display();
    let text = match std::fs::read_to_string(file) {
        Ok(text) => text,
        Err(error) if !level && error.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(format!("cannot read {name}: {error}")),
    };
    let newline = if text.is_empty() || text.ends_with('\n') {
        ""
    } else {
        "\n"
    };
    let text = format!("{text}{newline}{}", write::path(path));
    let text = text.trim_start_matches('\n');
    let checked = if level {
        crate::level::toml::read(text, "level.toml").map(|_| ())
    } else {
        walks::read(text).map(|_| ())
    };
    checked.map_err(|e| format!("{name} would not be read any more: {e}"))?;
    save(file, text.as_bytes())
}

impl App {
    /// Pause, place and recording, at the left of the line at the bottom.
    pub(super) fn walk_bar(&mut self, ui: &mut egui::Ui) {
        if let Some(recording) = &self.recording {
            let length = recording.length();
            if ui.button("Stop").clicked() {
                self.record();
                return;
            }
            let text = format!("recording: {length:.1} long");
            ui.colored_label(egui::Color32::from_rgb(236, 110, 110), text);
            ui.separator();
        }
        let mut ended = false;
        if let Some(play) = &mut self.play {
            let name = if play.running { "Pause" } else { "Go on" };
            if ui.button(name).clicked() {
                play.running = !play.running;
            }
            ended = ui.button("End").clicked();
            let seconds = play.track.seconds();
            let slider = egui::Slider::new(&mut play.at, 0.0..=seconds);
            ui.add(slider.suffix(" s").text(&play.name));
            ui.separator();
        }
        if ended {
            self.play = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recorded_walk_has_the_pace_that_it_was_walked_at() {
        let mut recording = Recording::default();
        for k in 0..=100 {
            // Two units a second, and a rest of five seconds in the middle.
            let x = f64::from(k) * 0.1;
            recording.go_on(DVec3::new(x, 0.0, 1.6), 0.05, 0.6);
            for _ in 0..if k == 60 { 100 } else { 0 } {
                recording.go_on(recording.points[recording.points.len() - 1], 0.05, 0.6);
            }
        }
        let path = recording
            .finish("a".into(), 75.0)
            .expect("it leads somewhere");
        let PathPace::Speed(speed) = path.pace else {
            panic!("{path:?}")
        };
        assert!((1.6..2.2).contains(&speed), "{speed}");
        assert!(
            (14..=18).contains(&path.points.len()),
            "{}",
            path.points.len()
        );
        assert!(Recording::default().finish("b".into(), 75.0).is_none());
    }

    #[test]
    fn a_walk_is_put_at_the_end_of_a_file_or_not_at_all() {
        const SAVE: Saver = |path, bytes| std::fs::write(path, bytes).map_err(|e| e.to_string());
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| CameraPath {
            name: name.into(),
            points: vec![DVec3::ZERO, DVec3::X],
            eye: None,
            closed: false,
            look: PathLook::Ahead,
            pace: PathPace::Speed(1.0),
            fov: 75.0,
        };
        let level = folder.path().join("level.toml");
        let text = "# mine\n[[room]]\nname = \"A\"\nrect = [0, 0, 9, 9]";
        std::fs::write(&level, text).expect("written");
        append(&level, &path("in"), true, SAVE).expect("it fits");
        let now = std::fs::read_to_string(&level).expect("it is there");
        assert!(now.starts_with(text), "{now}");
        assert!(
            append(&level, &path("in"), true, SAVE)
                .expect_err("twice")
                .contains("`in`")
        );
        assert_eq!(std::fs::read_to_string(&level).expect("it is there"), now);
        let own = folder.path().join("own.toml");
        for name in ["a", "b"] {
            append(&own, &path(name), false, SAVE).expect("it fits");
        }
        let text = std::fs::read_to_string(&own).expect("it is there");
        assert_eq!(walks::read(&text).expect("it reads").len(), 2);
        // A level is no file of walks.
        assert!(append(&level, &path("c"), false, SAVE).is_err());
        assert_eq!(std::fs::read_to_string(&level).expect("it is there"), now);
    }
}
