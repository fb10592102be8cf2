//! The window: what is open, where the eye is, and what happens when keys are pressed.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant, SystemTime};

use eframe::egui;
use egui::{Color32, ColorImage, Key, Sense, TextureHandle, TextureOptions, Ui};
use glam::{DVec2, DVec3};

use super::document::{Document, Loader};
use super::engine::{Engine, Explained, Look, Report, Seen};
use super::plan::{PlanEvent, PlanScene, PlanView};
use crate::cells::{CellId, Doors};
use crate::preview::Culling;
use crate::trace::camera::Camera;
use crate::walk::{Ground, Track, TrackOptions, tour};

/// How much of the past the statistics show.
const HISTORY: usize = 600;
/// Most pixels of the 3D picture along a side.
const PIXELS: f32 = 1600.0;
/// How often the file is looked at.
const WATCH: Duration = Duration::from_millis(700);

/// A tab of the side panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tab {
    /// Cells, polygons, milliseconds.
    Statistics,
    /// What a picture calls for.
    Effects,
    /// Why two cells see each other.
    Why,
    /// What `check` says.
    Findings,
}

/// What is drawn, and how.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Horizontal angle of view in degrees.
    pub fov: f64,
    /// Which cells are drawn.
    pub culling: Culling,
    /// With pictures.
    pub textured: bool,
    /// The plan beside the 3D view.
    pub plan: bool,
    /// The plan coloured by what cells see.
    pub heat: bool,
    /// Doors that stand closed count as walls.
    pub closed: bool,
    /// Heights count for "why".
    pub heights: bool,
    /// Times of the window's own thread.
    pub debug: bool,
    /// The keys.
    pub help: bool,
    /// Through walls.
    pub fly: bool,
}

/// The eye.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    /// Where.
    pub at: DVec3,
    /// Where it looks: radians counterclockwise from east, and up.
    pub yaw: f64,
    /// See `yaw`.
    pub pitch: f64,
}

impl Eye {
    fn looking(at: DVec3, direction: DVec3) -> Self {
        let direction = direction.normalize_or(DVec3::X);
        Self {
            at,
            yaw: direction.y.atan2(direction.x),
            pitch: direction.z.asin(),
        }
    }

    /// Unit vector of where it looks.
    pub fn direction(&self) -> DVec3 {
        let (sin, cos) = self.pitch.sin_cos();
        DVec2::from_angle(self.yaw).extend(0.0) * cos + DVec3::Z * sin
    }
}

/// What a frame took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// Polygons painted.
    pub polygons: f64,
    /// Milliseconds to find out and to paint.
    pub milliseconds: f64,
}

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

/// The window.
pub struct App {
    loader: Loader,
    loading: Option<(String, Receiver<Result<Document, String>>)>,
    /// What is open.
    pub document: Option<Arc<Document>>,
    engine: Option<Engine>,
    context: egui::Context,
    /// The eye.
    pub eye: Eye,
    /// What is drawn.
    pub settings: Settings,
    /// The plan.
    pub plan: PlanView,
    /// The side panel.
    pub tab: Tab,
    /// What the eye saw last.
    pub seen: Option<Seen>,
    picture: Option<TextureHandle>,
    asked: Option<Look>,
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
    size: [u32; 2],
    /// Told of every new cell.
    pub log: Option<fn(&str)>,
}

impl App {
    /// A window without a level.
    pub fn new(context: &egui::Context, loader: Loader) -> Self {
        context.set_theme(egui::Theme::Dark);
        Self {
            loader,
            loading: None,
            document: None,
            engine: None,
            context: context.clone(),
            eye: Eye {
                at: DVec3::ZERO,
                yaw: 0.0,
                pitch: 0.0,
            },
            settings: Settings {
                fov: 75.0,
                culling: Culling::Eye,
                textured: true,
                plan: true,
                heat: false,
                closed: false,
                heights: false,
                debug: false,
                help: false,
                fly: false,
            },
            plan: PlanView::default(),
            tab: Tab::Statistics,
            seen: None,
            picture: None,
            asked: None,
            frozen: None,
            source: None,
            second: None,
            explained: None,
            mark: None,
            play: None,
            history: VecDeque::new(),
            error: None,
            typed: None,
            watched: (Instant::now(), None),
            thread: [0.0; 2],
            last: Instant::now(),
            size: [0; 2],
            log: None,
        }
    }

    /// Reads a level beside the window's thread, and shows it when it is ready.
    pub fn open(&mut self, path: PathBuf, map: Option<String>) {
        let (loader, context) = (self.loader.clone(), self.context.clone());
        let doors = if self.settings.closed {
            Doors::Closed
        } else {
            Doors::Open
        };
        let (answer, result) = channel();
        let name = path.display().to_string();
        self.watched.1 = modified(&path);
        std::thread::spawn(move || {
            let document = loader(&path, map.as_deref()).and_then(|loaded| {
                Document::new((path, map), loaded.level, Arc::new(loaded.files), doors)
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
        self.engine = Some(Engine::start(document.clone(), move || {
            context.request_repaint();
        }));
        let inside = document.cell_at(self.eye.at.truncate()).is_some();
        if !same || !inside {
            let (at, direction) = document.start();
            self.eye = Eye::looking(at, direction);
            if let Some(camera) = document.level.scene.cameras.first() {
                self.settings.fov = camera.fov;
            }
        }
        if !same {
            self.plan = PlanView::default();
            self.history.clear();
        }
        (self.source, self.second, self.explained) = (None, None, None);
        (self.frozen, self.play, self.mark) = (None, None, None);
        (self.asked, self.seen) = (None, None);
        let name = format!("{} – enfilade", document.level.name);
        self.context
            .send_viewport_cmd(egui::ViewportCommand::Title(name));
        self.document = Some(document);
    }

    /// The eye's camera.
    pub fn camera(&self) -> Camera {
        let size = self.size.map(|n| n.max(1));
        Camera::new(self.eye.at, self.eye.direction(), self.settings.fov, size)
    }

    /// Sends the eye to a place of the plan, as high as a person's.
    pub fn jump(&mut self, at: DVec2) {
        let Some(document) = &self.document else {
            return;
        };
        let Some(cell) = document.cell_at(at) else {
            return;
        };
        let chamber = document.world.space.cell(cell.0);
        let room = chamber.ceiling - chamber.floor;
        let height = document.person.eye.min(room * 0.9);
        self.eye.at = at.extend(chamber.floor + height);
        self.play = None;
    }

    /// Looks from a camera of the level.
    pub fn look_from(&mut self, camera: &crate::level::scene::Camera) {
        self.eye = Eye::looking(camera.eye, camera.direction);
        self.settings.fov = camera.fov;
        self.play = None;
    }

    /// Starts a path of the level, or, without a name, a tour.
    pub fn play(&mut self, name: Option<&str>) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let options = TrackOptions::default();
        let (graph, space) = (&document.graph, &document.world.space);
        let track = match name {
            Some(name) => {
                let paths = &document.level.scene.paths;
                let path = paths.iter().find(|p| p.name == name);
                path.map(|path| Track::new(path, &Ground::new(graph, space), &options))
            }
            None => {
                tour(&document.level, graph, space, &document.person).map(|t| t.track(&options))
            }
        };
        self.play = track.map(|track| Play {
            line: track.points().iter().map(|p| p.truncate()).collect(),
            track,
            name: name.unwrap_or("tour").to_string(),
            at: 0.0,
            running: true,
        });
        if self.play.is_none() {
            self.error = Some("there is no way to walk here".to_string());
        }
    }

    /// Asks why two cells see each other.
    pub fn ask_why(&mut self) {
        if let (Some(engine), Some(a), Some(b)) = (&self.engine, self.source, self.second) {
            engine.explain([a, b], self.settings.heights);
            self.tab = Tab::Why;
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
        let Some(engine) = &self.engine else { return };
        let reports: Vec<Report> = engine.reports().collect();
        for report in reports {
            match report {
                Report::Seen(seen) => self.take(*seen),
                Report::Explained(explained) => self.explained = Some(*explained),
            }
        }
    }

    fn take(&mut self, seen: Seen) {
        let size = seen.look.camera.size.map(|n| n as usize);
        let image = ColorImage::from_rgb(size, &seen.picture);
        match &mut self.picture {
            Some(texture) => texture.set(image, TextureOptions::NEAREST),
            None => {
                let options = TextureOptions::NEAREST;
                self.picture = Some(self.context.load_texture("view", image, options));
            }
        }
        let before = self.seen.as_ref().and_then(|s| s.cell);
        if let (Some(log), Some(cell), Some(document)) = (self.log, seen.cell, &self.document)
            && before != Some(cell)
        {
            let [x, y, z] = seen.look.camera.eye.to_array();
            let pvs = document.sees[cell.0 as usize];
            log(&format!(
                "eye {x:.4} {y:.4} {z:.4} cell {} pvs {pvs}",
                cell.0
            ));
        }
        self.history.push_back(Sample {
            polygons: seen.figures.painted as f64,
            milliseconds: seen.milliseconds.iter().sum(),
        });
        while self.history.len() > HISTORY {
            self.history.pop_front();
        }
        self.seen = Some(seen);
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
        if now.is_some() && now != self.watched.1 && self.loading.is_none() {
            self.reload();
        }
        self.context.request_repaint_after(WATCH);
    }

    /// Moves the eye as the keys say.
    fn steer(&mut self, ui: &Ui, seconds: f64) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let Some(document) = self.document.clone() else {
            return;
        };
        let down = |keys: &[Key]| ui.input(|i| keys.iter().any(|k| i.key_down(*k)));
        let axis = |plus: &[Key], minus: &[Key]| f64::from(down(plus)) - f64::from(down(minus));
        let forward = axis(&[Key::W, Key::ArrowUp], &[Key::S, Key::ArrowDown]);
        let right = axis(&[Key::D], &[Key::A]);
        let turn = axis(&[Key::ArrowLeft], &[Key::ArrowRight]);
        let up = axis(&[Key::E, Key::Space], &[Key::Q]);
        if forward == 0.0 && right == 0.0 && turn == 0.0 && up == 0.0 {
            return;
        }
        self.play = None;
        self.eye.yaw += turn * seconds * 1.9;
        let run = ui.input(|i| i.modifiers.shift);
        let speed = document.person.speed * if run { 4.5 } else { 1.8 };
        let ahead = if self.settings.fly {
            self.eye.direction()
        } else {
            DVec2::from_angle(self.eye.yaw).extend(0.0)
        };
        let side = DVec2::from_angle(self.eye.yaw).perp().extend(0.0) * -1.0;
        let wish =
            ahead * forward + side * right + DVec3::Z * if self.settings.fly { up } else { 0.0 };
        let step = wish.normalize_or_zero() * speed * seconds;
        self.go(&document, step);
        self.context.request_repaint();
    }

    fn go(&mut self, document: &Document, step: DVec3) {
        let to = self.eye.at + step;
        if self.settings.fly {
            self.eye.at = to;
        } else if document.cell_at(to.truncate()).is_some() {
            self.jump(to.truncate());
        }
    }

    /// Keys that do something once.
    fn keys(&mut self, ui: &Ui) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed = |key| ui.input(|i| i.key_pressed(key) && !i.modifiers.any());
        if pressed(Key::M) {
            self.settings.plan = !self.settings.plan;
        }
        if pressed(Key::F) {
            self.settings.fly = !self.settings.fly;
        }
        if pressed(Key::P) {
            self.freeze();
        }
        if pressed(Key::H) {
            self.settings.heat = !self.settings.heat;
        }
        if pressed(Key::T) {
            self.settings.textured = !self.settings.textured;
        }
        if pressed(Key::F1) {
            self.settings.help = !self.settings.help;
        }
        if pressed(Key::F3) {
            self.settings.debug = !self.settings.debug;
        }
        if pressed(Key::F5) {
            self.reload();
        }
        if pressed(Key::Escape) {
            (self.source, self.second, self.explained) = (None, None, None);
            (self.mark, self.error) = (None, None);
            self.settings.help = false;
        }
    }

    /// Keeps drawing what the eye sees now, wherever it flies; or lets it go.
    pub fn freeze(&mut self) {
        self.frozen = match self.frozen {
            None => Some(self.camera()),
            Some(_) => None,
        };
    }

    /// The 3D view, in all the room there is.
    fn view(&mut self, ui: &mut Ui) {
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, "View into the level")
        });
        let rect = response.rect;
        let scale = ui.ctx().pixels_per_point();
        let pixels = rect.size() * scale;
        let shrink = (PIXELS / pixels.max_elem()).min(1.0);
        self.size = [pixels.x, pixels.y].map(|n| ((n * shrink) as u32).max(1));
        if response.dragged() {
            let d = response.drag_delta() * (0.004 * self.settings.fov / 75.0) as f32;
            self.eye.yaw += f64::from(d.x);
            self.eye.pitch = (self.eye.pitch + f64::from(d.y)).clamp(-1.5, 1.5);
            self.play = None;
        }
        painter.rect_filled(rect, 0.0, Color32::BLACK);
        if let Some(texture) = &self.picture {
            let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
            painter.image(texture.id(), rect, whole, Color32::WHITE);
        }
        if self.frozen.is_some() {
            let font = egui::FontId::proportional(14.0);
            let at = rect.center_top() + egui::vec2(0.0, 10.0);
            let text = "frozen: what is drawn was chosen where you pressed P";
            painter.text(at, egui::Align2::CENTER_TOP, text, font, Color32::YELLOW);
        }
    }

    /// Asks what the eye sees, if that has changed.
    fn ask(&mut self) {
        let Some(engine) = &self.engine else { return };
        let look = Look {
            camera: self.camera(),
            chosen_by: self.frozen,
            culling: self.settings.culling,
            textured: self.settings.textured,
        };
        if self.size[0] > 0 && self.asked != Some(look) {
            engine.look(look);
            self.asked = Some(look);
        }
    }

    /// The plan, in all the room there is.
    fn plan(&mut self, ui: &mut Ui) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let seen = self.seen.as_ref();
        let explained = self
            .explained
            .as_ref()
            .filter(|e| Some(e.cells[0]) == self.source && Some(e.cells[1]) == self.second);
        let half = (self.settings.fov / 2.0).to_radians();
        let scene = PlanScene {
            document: &document,
            eye: (
                self.eye.at.truncate(),
                DVec2::from_angle(self.eye.yaw),
                half,
            ),
            cell: seen.and_then(|s| s.cell),
            cells: seen.map_or(&[], |s| &s.cells),
            area: seen.map_or(&[], |s| &s.area),
            source: self.source,
            second: self.second,
            sightline: explained.and_then(|e| e.line),
            way: explained.map_or(&[], |e| &e.way),
            path: self.play.as_ref().map_or(&[], |p| &p.line),
            heat: self.settings.heat,
            mark: self.mark,
        };
        match self.plan.show(ui, &scene) {
            Some(PlanEvent::Jump(at)) => {
                self.source = None;
                self.jump(at);
            }
            Some(PlanEvent::Source(cell)) => {
                (self.source, self.second, self.explained) = (Some(cell), None, None);
            }
            Some(PlanEvent::Second(cell)) => {
                self.source = self.source.or(self.seen.as_ref().and_then(|s| s.cell));
                self.second = Some(cell);
                self.ask_why();
            }
            Some(PlanEvent::Clear) => {
                (self.source, self.second, self.explained) = (None, None, None);
            }
            None => {}
        }
    }

    /// Files that were dropped on the window.
    fn dropped(&mut self, ui: &Ui) {
        let files = ui.input(|i| i.raw.dropped_files.clone());
        if let Some(path) = files.into_iter().map(|f| f.path().to_path_buf()).next() {
            self.open(path, None);
        }
    }

    /// Goes on along a path.
    fn walk_on(&mut self, seconds: f64) {
        let Some(play) = &mut self.play else { return };
        if play.running {
            play.at += seconds;
            if play.at > play.track.seconds() {
                play.at = 0.0;
            }
            self.context.request_repaint();
        }
        let pose = play.track.at(play.at);
        self.eye = Eye::looking(pose.eye, pose.direction);
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let start = Instant::now();
        let seconds = self.last.elapsed().as_secs_f64().min(0.1);
        self.last = start;
        self.fetch();
        self.watch();
        self.dropped(ui);
        self.keys(ui);
        self.steer(ui, seconds);
        self.walk_on(seconds);
        egui::Panel::top("menu").show(ui, |ui| self.menu(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        egui::Panel::left("panels")
            .default_size(300.0)
            .show(ui, |ui| self.side(ui));
        if self.settings.plan {
            let half = ui.available_width() * 0.45;
            egui::Panel::right("plan")
                .default_size(half)
                .frame(egui::Frame::NONE)
                .show(ui, |ui| self.plan(ui));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.view(ui));
        self.windows(ui);
        self.ask();
        let took = start.elapsed().as_secs_f64() * 1e3;
        self.thread = [self.thread[0].max(took), took];
    }
}

fn modified(path: &std::path::Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}
