//! What is seen, found out beside the window's thread.
//!
//! In: where the eye is, from the window, as often as it likes; only the newest place counts. Out:
//! [`Seen`]: the painted picture, the cells in view, the exact visible area, figures. So the window never
//! waits for a picture. The thread keeps what a level needs once (painter, lookout) for all frames.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

use glam::{DVec2, DVec3};

use super::document::Document;
use super::scene::{self, Pipelines, Scene, Target};
use crate::cells::CellId;
use crate::preview::{Culling, Easel, Figures, Finish, Options, Painter, culling::cone};
use crate::pvs::explain::{ExplainOptions, Explanation, Space, explain};
use crate::pvs::eye::{Lookout, Scratch};
use crate::pvs::heights::HeightsOptions;
use crate::trace::camera::Camera;
use crate::trace::effects::{Survey, survey};
use crate::trace::world::locate;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// From where.
    pub camera: Camera,
    /// What is drawn: by this camera's cells, which is another one than `camera` when they are frozen.
    pub chosen_by: Option<Camera>,
    /// Which cells are drawn.
    pub culling: Culling,
    /// With pictures or in plain colours.
    pub textured: bool,
}

/// What an eye sees.
pub struct Seen {
    /// What was asked.
    pub look: Look,
    /// The picture, of the camera's size.
    pub picture: Picture,
    /// The eye's cell; none outside of the level.
    pub cell: Option<CellId>,
    /// The cells within the cone.
    pub cells: Vec<CellId>,
    /// The visible area, in convex pieces, in the level's unit.
    pub area: Vec<Vec<DVec2>>,
    /// What drawing took.
    pub figures: Figures,
    /// Polygons that would be painted: all that face the eye, those of the PVS, those in view.
    pub polygons: [u64; 3],
    /// What pictures from the cell call for.
    pub survey: Option<Arc<Survey>>,
    /// Milliseconds to find out what is there, and to paint it.
    pub milliseconds: [f64; 2],
}

/// What was painted.
pub enum Picture {
    /// By the processor: three bytes a pixel.
    Bytes(Vec<u8>),
    /// By the graphics card: one of [`SLOTS`] textures in turn, so that none is painted on that is shown.
    Card(usize, wgpu::TextureView),
}

/// Textures that the graphics card paints on in turn.
pub const SLOTS: usize = 3;

/// A graphics card, or what stands for it.
#[derive(Clone)]
pub struct Card {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

/// Why two cells see each other, or why not.
pub struct Explained {
    /// The cells.
    pub cells: [CellId; 2],
    /// Whether they do.
    pub sees: bool,
    /// In words.
    pub text: String,
    /// A sightline, in the level's unit.
    pub line: Option<[DVec2; 2]>,
    /// And in space: through the openings, if heights count and it is known; else at the height of eyes.
    pub rise: Option<[DVec3; 2]>,
    /// The shortest way, of cells that do not.
    pub way: Vec<DVec2>,
    /// Milliseconds.
    pub milliseconds: f64,
}

/// What the thread has to say.
pub enum Report {
    /// Of an eye.
    Seen(Box<Seen>),
    /// Of two cells.
    Explained(Box<Explained>),
}

#[allow(clippy::large_enum_variant)] // one at a time is sent
enum Question {
    Look(Look),
    Explain([CellId; 2], bool),
}

/// A thread that answers for one level. It ends when this is dropped.
pub struct Engine {
    questions: Option<Sender<Question>>,
    reports: Receiver<Report>,
    thread: Option<JoinHandle<()>>,
}

impl Engine {
    /// Starts; pictures are painted by the card, if there is one. `wake` is called whenever there is
    /// something to fetch.
    pub fn start(
        document: Arc<Document>,
        card: Option<Card>,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (questions, asked) = channel();
        let (answer, reports) = channel();
        let thread = std::thread::spawn(move || {
            run(&document, card, &asked, |report| {
                _ = answer.send(report);
                wake();
            });
        });
        Self {
            questions: Some(questions),
            reports,
            thread: Some(thread),
        }
    }

    /// Asks what an eye sees.
    pub fn look(&self, look: Look) {
        self.ask(Question::Look(look));
    }

    /// Asks why two cells see each other.
    pub fn explain(&self, cells: [CellId; 2], heights: bool) {
        self.ask(Question::Explain(cells, heights));
    }

    fn ask(&self, question: Question) {
        if let Some(questions) = &self.questions {
            _ = questions.send(question);
        }
    }

    /// What has been found out since the last time.
    pub fn reports(&self) -> impl Iterator<Item = Report> {
        self.reports.try_iter()
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.questions = None;
        if let Some(thread) = self.thread.take() {
            _ = thread.join();
        }
    }
}

fn run(
    document: &Document,
    card: Option<Card>,
    asked: &Receiver<Question>,
    mut answer: impl FnMut(Report),
) {
    let Document {
        graph, pvs, world, ..
    } = document;
    let painters = [Finish::Flat, Finish::Textured].map(|f| Painter::new(world, graph, pvs, f));
    let lookout = Lookout::new(graph);
    let mut desk = Desk {
        document,
        easel: Easel::default(),
        scratch: Scratch::default(),
        last: None,
        studio: card.map(Studio::new),
    };
    while let Ok(first) = asked.recv() {
        // Of all places that were asked about meanwhile, the last.
        let mut look = None;
        for question in std::iter::once(first).chain(asked.try_iter()) {
            match question {
                Question::Look(newer) => look = Some(newer),
                Question::Explain(cells, heights) => {
                    if let Some(explained) = why(document, cells, heights) {
                        answer(Report::Explained(Box::new(explained)));
                    }
                }
            }
        }
        if let Some(look) = look
            && let Some(painter) = &painters[usize::from(look.textured)]
        {
            let seen = desk.see(painter, &lookout, look);
            answer(Report::Seen(Box::new(seen)));
        }
    }
}

/// What is kept from frame to frame.
struct Desk<'a> {
    document: &'a Document,
    easel: Easel,
    scratch: Scratch,
    last: Option<(CellId, Arc<Survey>)>,
    studio: Option<Studio>,
}

/// What the graphics card paints with.
struct Studio {
    card: Card,
    pipelines: Pipelines,
    /// Plain and with pictures.
    scenes: [Option<Scene>; 2],
    targets: [Option<Target>; SLOTS],
    next: usize,
}

impl Studio {
    fn new(card: Card) -> Self {
        const SAMPLES: u32 = 4;
        Self {
            pipelines: Pipelines::new(&card.device, SAMPLES),
            card,
            scenes: [None, None],
            targets: [const { None }; SLOTS],
            next: 0,
        }
    }

    fn paint(
        &mut self,
        painter: &Painter,
        look: &Look,
        easel: &mut Easel,
    ) -> Option<(Figures, Picture)> {
        let Self {
            card: Card { device, queue },
            pipelines,
            ..
        } = self;
        let scene = self.scenes[usize::from(look.textured)]
            .get_or_insert_with(|| Scene::new(device, queue, pipelines, painter));
        let wanted = scene::Look {
            camera: &look.camera,
            culling: look.culling,
            chosen_for: look.chosen_by.as_ref(),
            smooth: true,
            objects: true,
        };
        let frame = scene
            .prepare((device, queue), painter, &wanted, easel)
            .ok()?;
        let slot = self.next;
        self.next = (slot + 1) % SLOTS;
        let target = &mut self.targets[slot];
        if target.as_ref().is_none_or(|t| t.size != look.camera.size) {
            *target = Some(Target::new(device, pipelines, look.camera.size));
        }
        let target = target.as_ref()?;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        scene.draw(&mut encoder, pipelines, target);
        queue.submit([encoder.finish()]);
        Some((frame.figures, Picture::Card(slot, target.view.clone())))
    }
}

impl Desk<'_> {
    fn see(&mut self, painter: &Painter, lookout: &Lookout, look: Look) -> Seen {
        let Document {
            graph,
            world,
            pvs,
            locator,
            ..
        } = self.document;
        let start = Instant::now();
        let chooser = look.chosen_by.unwrap_or(look.camera);
        let cell = locate(world, graph, locator, chooser.eye).ok();
        if let Some(cell) = cell
            && self.last.as_ref().is_none_or(|(last, _)| *last != cell)
        {
            self.last = Some((cell, Arc::new(survey(world, pvs, cell))));
        }
        let (mut cells, mut area) = (Vec::new(), Vec::new());
        if let Some(eye) = graph.grid.fine(chooser.eye.truncate())
            && let Ok(vista) = lookout.look(&eye, &cone(&chooser), &mut self.scratch)
        {
            cells.extend_from_slice(vista.cells());
            let mut corners = Vec::new();
            for piece in vista.pieces() {
                vista.polygon(piece, &mut corners);
                let place = |p: &DVec2| self.document.to_level(*p);
                area.push(corners.iter().map(place).collect());
            }
        }
        let count = |easel: &mut Easel| {
            Culling::ALL.map(|culling| {
                let figures = painter.count(&chooser, culling, easel);
                figures.map_or(0, |f| f.painted)
            })
        };
        let polygons = count(&mut self.easel);
        let found = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        let by_card = self
            .studio
            .as_mut()
            .and_then(|studio| studio.paint(painter, &look, &mut self.easel));
        let (figures, picture) = by_card.unwrap_or_else(|| {
            let options = Options {
                culling: look.culling,
                objects: true,
                ..Options::default()
            };
            let cameras = (&look.camera, &chooser);
            let drawn = painter.draw_chosen(cameras, &options, &mut self.easel);
            let bytes = self.easel.canvas.srgb();
            (drawn.unwrap_or_default(), Picture::Bytes(bytes))
        });
        Seen {
            look,
            picture,
            cell,
            cells,
            area,
            figures,
            polygons,
            survey: self
                .last
                .as_ref()
                .filter(|l| Some(l.0) == cell)
                .map(|l| l.1.clone()),
            milliseconds: [found, start.elapsed().as_secs_f64() * 1e3],
        }
    }
}

fn why(document: &Document, cells: [CellId; 2], heights: bool) -> Option<Explained> {
    let start = Instant::now();
    let Document {
        level, graph, pvs, ..
    } = document;
    let options = ExplainOptions {
        heights: heights.then(HeightsOptions::default),
        ..ExplainOptions::default()
    };
    let explanation = explain(graph, pvs, cells[0], cells[1], &options)?;
    let text = (document.voice.why)(level, graph, pvs, cells, heights)?;
    let (mut line, mut rise, mut way) = (None, None, Vec::new());
    match &explanation {
        Explanation::Visible(view) => {
            let segment = [&view.segment.from, &view.segment.to];
            let plan = segment.map(|p| document.to_level(p.approx()));
            line = Some(plan);
            let space = match &view.space {
                Some(Space::Seen(passage)) => passage.segment,
                _ => None,
            };
            rise = Some(match space {
                Some(ends) => ends.map(|p| document.to_level(p.truncate()).extend(p.z)),
                None => [0, 1].map(|k| plan[k].extend(document.eye_level(cells[k]))),
            });
        }
        Explanation::Hidden(hidden) => {
            way = hidden
                .way
                .points
                .iter()
                .map(|p| document.to_level(*p))
                .collect();
        }
        _ => {}
    }
    Some(Explained {
        cells,
        sees: explanation.sees(),
        text,
        line,
        rise,
        way,
        milliseconds: start.elapsed().as_secs_f64() * 1e3,
    })
}
