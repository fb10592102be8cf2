//! The window: what is open, where the eye is, and what happens when keys are pressed.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant, SystemTime};

use eframe::egui;
use eframe::egui_wgpu::RenderState;
use egui::{ColorImage, TextureHandle, TextureId, TextureOptions, Ui};
use glam::{DVec2, DVec3};

use super::costs::{Costs, Knobs};
use super::document::{Document, Services};
use super::edit::Editing;
use super::engine::{Card, Engine, Explained, Look, Report, SLOTS, Seen};
use super::methods::Methods;
use super::paths::{Play, Recording, Saving};
use super::plan::PlanView;
pub use super::settings::{Memory, Settings, Tab, View};
use super::settings::{Opened, put_first};
use super::sightlines::Sightlines;
use super::tracing::{Report as TracingReport, Traced, Tracing};
use super::walker::{Mode, Walker};
use crate::cells::CellId;
use crate::level::scene::CameraPath;
use crate::trace::camera::Camera;
use crate::trace::picture::Exposure;

/// How much of the past the statistics show.
pub(super) const HISTORY: usize = 600;
/// Most pixels of the 3D picture along a side.
pub(super) const PIXELS: f32 = 1600.0;
/// How often the file is looked at.
const WATCH: Duration = Duration::from_millis(700);

/// What a frame took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// Polygons painted.
    pub polygons: f64,
    /// Milliseconds to find out and to paint.
    pub milliseconds: f64,
}

/// The window.
pub struct App {
    pub(super) services: Services,
    loading: Option<(String, Receiver<Result<Document, String>>)>,
    /// What is open.
    pub document: Option<Arc<Document>>,
    pub(super) engine: Option<Engine>,
    pub(super) context: egui::Context,
    /// The eye.
    pub eye: Walker,
    /// What is drawn.
    pub settings: Settings,
    /// The plan.
    pub plan: PlanView,
    /// Levels that were opened before.
    pub recent: Vec<Opened>,
    /// What the eye saw last.
    pub seen: Option<Seen>,
    pub(super) picture: Option<TextureHandle>,
    /// The graphics card's textures, as the window knows them, and the one that is shown.
    pub(super) card: Option<RenderState>,
    pub(super) slots: [Option<TextureId>; SLOTS],
    pub(super) shown: Option<TextureId>,
    pub(super) tracing: Option<Tracing>,
    /// The traced picture, and what it is of.
    pub traced: Option<(TextureHandle, Traced)>,
    pub(super) requested: Option<(Camera, Knobs, Exposure)>,
    /// What traced pictures have cost.
    pub costs: Costs,
    /// What other methods say of the level.
    pub methods: Methods,
    /// From the chosen cell, or the eye's.
    pub sightlines: Option<Sightlines>,
    /// What has been asked of the mouse since the last frame.
    pub(super) look: DVec2,
    pub(super) asked: Option<Look>,
    /// The camera whose cells stay drawn.
    pub frozen: Option<Camera>,
    /// The cell that was clicked.
    pub source: Option<CellId>,
    /// And the second one.
    pub second: Option<CellId>,
    /// Why the one sees the other, or not.
    pub explained: Option<Explained>,
    /// A place to point at.
    pub mark: Option<DVec2>,
    /// A path that is walked.
    pub play: Option<Play>,
    /// Walks beside those of the level.
    pub walks: Vec<CameraPath>,
    /// A walk that is recorded.
    pub recording: Option<Recording>,
    /// A walk that is about to be saved.
    pub keeping: Option<Saving>,
    /// Whether the mouse looks around, and belongs to the view.
    pub captured: bool,
    /// Something that went well.
    pub note: Option<String>,
    /// A file that somebody chooses in a dialog of the system.
    pub(super) choosing: Option<(Wanted, Receiver<Option<PathBuf>>)>,
    /// The past.
    pub history: VecDeque<Sample>,
    /// What went wrong.
    pub error: Option<String>,
    /// A path to open, as it is typed.
    pub typed: Option<String>,
    watched: (Instant, Option<SystemTime>),
    /// The longest that the window's thread took for a frame, in milliseconds, and the last.
    pub thread: [f64; 2],
    last: Instant,
    pub(super) size: [u32; 2],
    /// The level's changes, while it is changed.
    pub editing: Option<Editing>,
    /// Where to save, as it is typed.
    pub saving: Option<String>,
    /// Told of every new cell.
    pub log: Option<fn(&str)>,
}

impl App {
    /// A window without a level.
    pub fn new(context: &egui::Context, card: Option<RenderState>, services: Services) -> Self {
        context.set_theme(egui::Theme::Dark);
        Self {
            services,
            loading: None,
            document: None,
            engine: None,
            context: context.clone(),
            eye: Walker::new(DVec3::ZERO, DVec3::X, Mode::Walk),
            settings: Settings::default(),
            plan: PlanView::default(),
            recent: Vec::new(),
            seen: None,
            picture: None,
            card,
            slots: [None; SLOTS],
            shown: None,
            tracing: None,
            traced: None,
            requested: None,
            costs: Costs::default(),
            methods: Methods::default(),
            sightlines: None,
            look: DVec2::ZERO,
            asked: None,
            frozen: None,
            source: None,
            second: None,
            explained: None,
            mark: None,
            play: None,
            walks: Vec::new(),
            recording: None,
            keeping: None,
            captured: false,
            note: None,
            choosing: None,
            history: VecDeque::new(),
            error: None,
            typed: None,
            watched: (Instant::now(), None),
            thread: [0.0; 2],
            last: Instant::now(),
            size: [0; 2],
            editing: None,
            saving: None,
            log: None,
        }
    }

    /// Reads a level beside the window's thread, and shows it when it is ready.
    pub fn open(&mut self, path: PathBuf, map: Option<String>) {
        let (services, context) = (self.services.clone(), self.context.clone());
        let doors = self.settings.doors();
        let (answer, result) = channel();
        let name = path.display().to_string();
        self.watched.1 = modified(&path);
        std::thread::spawn(move || {
            let document = (services.load)(&path, map.as_deref()).and_then(|loaded| {
                Document::new(
                    (path, map),
                    loaded.level,
                    Arc::new(loaded.files),
                    doors,
                    services.voice,
                )
            });
            _ = answer.send(document);
            context.request_repaint();
        });
        self.loading = Some((name, result));
    }

    /// Reads what is open once more.
    pub fn reload(&mut self) {
        if let Some(document) = &self.document {
            self.open(document.path.clone(), document.map.clone());
        }
    }

    /// Shows a level.
    pub fn show(&mut self, document: Document) {
        let same = self
            .document
            .as_ref()
            .is_some_and(|old| (&old.path, &old.map) == (&document.path, &document.map));
        let document = Arc::new(document);
        let context = self.context.clone();
        let card = self.card.as_ref().map(|card| Card {
            device: card.device.clone(),
            queue: card.queue.clone(),
        });
        if !same {
            self.walks.clear();
            let level = (document.path.clone(), document.map.clone());
            put_first(&mut self.recent, level);
        }
        self.methods = Methods::default();
        self.sightlines = None;
        (self.recording, self.keeping) = (None, None);
        self.engine = Some(Engine::start(document.clone(), card, move || {
            context.request_repaint();
        }));
        let inside = document.cell_at(self.eye.eye.truncate()).is_some();
        if !same || !inside {
            let (at, direction) = document.start();
            self.eye = Walker::new(at, direction, self.eye.mode);
            if let Some(camera) = document.level.scene.cameras.first() {
                self.settings.fov = camera.fov;
            }
        }
        if !same {
            self.plan = PlanView::default();
            self.history.clear();
            self.editing = None;
        }
        (self.source, self.second, self.explained) = (None, None, None);
        (self.frozen, self.play, self.mark) = (None, None, None);
        self.costs = Costs::default();
        (self.asked, self.seen) = (None, None);
        (self.requested, self.traced) = (None, None);
        let name = format!("{} – enfilade", document.level.name);
        self.context
            .send_viewport_cmd(egui::ViewportCommand::Title(name));
        self.document = Some(document);
    }

    /// The eye's camera.
    pub fn camera(&self) -> Camera {
        let size = self.size.map(|n| n.max(1));
        self.eye.camera(self.settings.fov, size)
    }

    /// Sends the eye to a place of the plan, as high as a person's.
    pub fn jump(&mut self, at: DVec2) {
        let Some(document) = &self.document else {
            return;
        };
        self.eye.stand(at, &document.site());
        self.play = None;
    }

    /// Looks from a camera of the level.
    pub fn look_from(&mut self, camera: &crate::level::scene::Camera) {
        self.eye = Walker::new(camera.eye, camera.direction, self.eye.mode);
        self.settings.fov = camera.fov;
        self.play = None;
    }

    /// Asks why two cells see each other.
    pub fn ask_why(&mut self) {
        if let (Some(engine), Some(a), Some(b)) = (&self.engine, self.source, self.second) {
            engine.explain([a, b], self.settings.heights);
            self.settings.tab = Tab::Why;
        }
    }

    /// Whether something is being read or computed.
    pub fn busy(&self) -> Option<&str> {
        self.loading.as_ref().map(|(name, _)| &name[..])
    }

    /// Takes in what other threads have found out.
    fn fetch(&mut self) {
        let loaded = self.loading.as_ref().map(|(_, result)| result.try_recv());
        match loaded {
            Some(Ok(Ok(document))) => {
                self.loading = None;
                self.show(document);
            }
            Some(Ok(Err(error))) => {
                self.loading = None;
                self.error = Some(error);
            }
            Some(Err(TryRecvError::Disconnected)) => {
                self.loading = None;
                self.error = Some("the level could not be made ready".to_string());
            }
            Some(Err(TryRecvError::Empty)) | None => {}
        }
        let traced: Vec<_> = self.tracing.iter().flat_map(Tracing::reports).collect();
        for report in traced {
            if let TracingReport::Picture(traced) = report {
                if let (true, Some((camera, knobs, _))) = (traced.done, self.requested) {
                    self.costs.note(camera, knobs, traced.milliseconds);
                }
                let size = traced.size.map(|n| n as usize);
                let image = ColorImage::from_rgb(size, &traced.bytes);
                let options = TextureOptions::NEAREST;
                let texture = match self.traced.take() {
                    Some((mut texture, _)) => {
                        texture.set(image, options);
                        texture
                    }
                    None => self.context.load_texture("traced", image, options),
                };
                self.traced = Some((texture, traced));
            }
        }
        let Some(engine) = &self.engine else { return };
        let reports: Vec<Report> = engine.reports().collect();
        for report in reports {
            match report {
                Report::Seen(seen) => self.take(*seen),
                Report::Explained(explained) => self.explained = Some(*explained),
            }
        }
    }

    /// Looks whether the file has changed.
    fn watch(&mut self) {
        if self.watched.0.elapsed() < WATCH {
            return;
        }
        self.watched.0 = Instant::now();
        let Some(document) = &self.document else {
            return;
        };
        let now = modified(&document.path);
        let idle = self.loading.is_none() && self.changes() == 0;
        if now.is_some() && now != self.watched.1 && idle {
            self.reload();
        }
        self.context.request_repaint_after(WATCH);
    }

    /// Keeps drawing what the eye sees now, wherever it flies; or lets it go.
    pub fn freeze(&mut self) {
        self.frozen = match self.frozen {
            None => Some(self.camera()),
            Some(_) => None,
        };
    }

    /// Files that were dropped on the window.
    fn dropped(&mut self, ui: &Ui) {
        let files = ui.input(|i| i.raw.dropped_files.clone());
        if let Some(path) = files.into_iter().map(|f| f.path().to_path_buf()).next() {
            self.open(path, None);
        }
    }

    /// Lets somebody choose a file in the system's own dialog, beside the window's thread.
    pub(super) fn choose(&mut self, wanted: Wanted) {
        let (answer, choice) = channel();
        let context = self.context.clone();
        std::thread::spawn(move || {
            let dialog = rfd::FileDialog::new();
            _ = answer.send(match wanted {
                Wanted::Level => dialog
                    .add_filter("levels", &["toml", "wad", "dxf", "svg", "dd2vtt", "uvtt"])
                    .add_filter("all files", &["*"])
                    .pick_file(),
                Wanted::Walks => dialog.add_filter("walks", &["toml"]).pick_file(),
                Wanted::Save => dialog.add_filter("levels", &["toml"]).save_file(),
            });
            context.request_repaint();
        });
        self.choosing = Some((wanted, choice));
    }

    /// Takes in what was chosen.
    fn chosen(&mut self) {
        let Some((wanted, choice)) = self.choosing.take() else {
            return;
        };
        match (choice.try_recv(), wanted) {
            (Err(TryRecvError::Empty), _) => self.choosing = Some((wanted, choice)),
            (Ok(Some(path)), Wanted::Level) => {
                self.typed = None;
                self.open(path, None);
            }
            (Ok(Some(path)), Wanted::Walks) => self.open_walks(&path),
            (Ok(Some(path)), Wanted::Save) => {
                self.saving = None;
                self.save(path);
            }
            (Ok(None) | Err(TryRecvError::Disconnected), _) => {}
        }
    }

    /// What is to be remembered.
    pub fn memory(&self) -> Memory {
        Memory {
            settings: self.settings,
            recent: self.recent.clone(),
        }
    }

    /// Goes on as it was the last time.
    pub fn remember(&mut self, memory: Memory) {
        (self.settings, self.recent) = (memory.settings, memory.recent);
    }

    /// The explanation of the two cells that are chosen.
    pub fn explanation(&self) -> Option<&Explained> {
        let explained = self.explained.as_ref()?;
        let cells = explained.cells.map(Some);
        (cells == [self.source, self.second]).then_some(explained)
    }

    /// The chosen cell, or else the eye's.
    pub fn subject(&self) -> Option<CellId> {
        self.source.or(self.seen.as_ref().and_then(|s| s.cell))
    }

    /// Asks why a cell sees another.
    pub fn ask_why_of(&mut self, source: CellId, second: CellId) {
        (self.source, self.second) = (Some(source), Some(second));
        self.ask_why();
    }

    /// Has the sightlines found that are to be shown.
    fn follow_sightlines(&mut self) {
        let (true, Some(document), Some(cell)) = (
            self.settings.sightlines,
            self.document.clone(),
            self.subject(),
        ) else {
            self.sightlines = None;
            return;
        };
        match &mut self.sightlines {
            Some(lines) if lines.are_of(&document, cell) => lines.fetch(),
            _ => {
                let context = self.context.clone();
                let wake = move || context.request_repaint();
                self.sightlines = Some(Sightlines::start(&document, cell, wake));
            }
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let start = Instant::now();
        let seconds = self.last.elapsed().as_secs_f64().min(0.1);
        self.last = start;
        self.fetch();
        self.chosen();
        self.methods.fetch();
        self.follow_edits();
        self.watch();
        self.dropped(ui);
        self.keys(ui);
        self.steer(ui, seconds);
        self.walk_on(seconds);
        egui::Panel::top("menu").show(ui, |ui| self.menu(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        if self.editing.is_some() {
            egui::Panel::bottom("edit").show(ui, |ui| self.edit_bar(ui));
        }
        egui::Panel::left("panels")
            .default_size(300.0)
            .show(ui, |ui| self.side(ui));
        if self.settings.plan {
            egui::Panel::right("plan")
                .default_size(460.0)
                .frame(egui::Frame::NONE)
                .show(ui, |ui| self.plan(ui));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.view(ui));
        self.windows(ui);
        self.follow_sightlines();
        self.ask();
        self.trace();
        let took = start.elapsed().as_secs_f64() * 1e3;
        self.thread = [self.thread[0].max(took), took];
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, eframe::APP_KEY, &self.memory());
    }
}

/// What a file is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    /// To be opened.
    Level,
    /// Walks beside the level.
    Walks,
    /// To save the level in.
    Save,
}

fn modified(path: &std::path::Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}
