//! A level made ready for the viewer: cells, PVS, what rays meet, and the shapes of the plan.
//!
//! In: a level and the pictures and meshes that it names. Out: a [`Document`] that threads share and nobody
//! changes; an edit makes a new one.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use glam::DVec2;

use super::tracing::Stage;
use super::walker::{Footing, Site};
use crate::cells::{self, CellGraph, CellId, Doors, Locator, subdivide};
use crate::level::{Finding, Level, OpeningStyle, WallKind};
use crate::pvs::{Progress, Pvs, sweep};
use crate::trace::world::{Files, World};
use crate::walk::person::heights;
use crate::walk::{Person, opened};

/// A level file as it was read.
pub struct Loaded {
    /// The level.
    pub level: Level,
    /// The pictures and meshes that it names.
    pub files: Files,
}

/// Reads a level file, and a map of it; the message says what is wrong and what to do.
pub type Loader = Arc<dyn Fn(&Path, Option<&str>) -> Result<Loaded, String> + Send + Sync>;

/// Writes a file, whole or not at all; the message names it.
pub type Saver = fn(&Path, &[u8]) -> Result<(), String>;

/// What the viewer needs of the program around it: files, and words.
#[derive(Clone)]
pub struct Services {
    /// Reads levels.
    pub load: Loader,
    /// Writes files.
    pub save: Saver,
    /// Puts things into words.
    pub voice: Voice,
}

/// Words that others put together: the viewer stands beside them, and does not know them.
#[derive(Clone, Copy)]
pub struct Voice {
    /// What looks wrong in a level with these cells.
    pub findings: fn(&Level, &CellGraph) -> Vec<Finding>,
    /// Why two cells see each other or not, with heights or without, in a few lines.
    pub why: fn(&Level, &CellGraph, &Pvs, [CellId; 2], bool) -> Option<String>,
}

/// How long each stage took, in milliseconds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stages {
    /// Cutting into cells.
    pub subdivide: f64,
    /// Who sees whom.
    pub visibility: f64,
    /// Getting ready to draw.
    pub world: f64,
}

/// A level with all that there is to show of it.
pub struct Document {
    /// Where it was read from.
    pub path: PathBuf,
    /// Which map of that file.
    pub map: Option<String>,
    /// The level, as it was read or edited.
    pub level: Level,
    /// The level as one walks through it: with its doors open, if they count as open.
    pub standing: Level,
    /// The level's pictures and meshes.
    pub files: Arc<Files>,
    /// Its cells.
    pub graph: CellGraph,
    /// Who sees whom.
    pub pvs: Pvs,
    /// What rays meet.
    pub world: World,
    /// Which cell a place is in.
    pub locator: Locator,
    /// What `check` has to say.
    pub findings: Vec<Finding>,
    /// By cell: how many cells it sees.
    pub sees: Vec<u32>,
    /// The cells, those that see most first.
    pub dearest: Vec<CellId>,
    /// What the plan shows.
    pub plan: Shapes,
    /// Who walks.
    pub person: Person,
    /// Where he can stand and go.
    pub footing: Footing,
    /// What it took.
    pub stages: Stages,
    /// Who puts things into words.
    pub voice: Voice,
}

/// Lines and outlines of the plan, in the level's unit.
#[derive(Clone, Debug, Default)]
pub struct Shapes {
    /// By cell, counterclockwise.
    pub cells: Vec<Vec<DVec2>>,
    /// What stands on the cells' edges, each once.
    pub lines: Vec<(Line, [DVec2; 2])>,
    /// Lowest and highest coordinates.
    pub bounds: [DVec2; 2],
}

/// What a line of the plan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// A wall.
    Wall,
    /// A border between cells where nothing stands.
    Portal,
    /// A step: floors or ceilings of different height.
    Step,
    /// A door.
    Door,
    /// A window.
    Window,
}

impl Document {
    /// Makes a level ready.
    pub fn new(
        (path, map): (PathBuf, Option<String>),
        level: Level,
        files: Arc<Files>,
        doors: Doors,
        voice: Voice,
    ) -> Result<Self, String> {
        const AMBIENT: f64 = 0.12;
        let mut stages = Stages::default();
        let mut clock = Instant::now();
        let mut lap = |stage: &mut f64| {
            *stage = clock.elapsed().as_secs_f64() * 1e3;
            clock = Instant::now();
        };
        let options = cells::Options {
            doors,
            ..cells::Options::default()
        };
        let person = Person::of_unit(&level.unit);
        let standing = match doors {
            Doors::Open => opened(&level, &person),
            Doors::Closed => level.clone(),
        };
        let graph = subdivide(&standing, &options);
        lap(&mut stages.subdivide);
        let pvs = sweep::sweep(&graph, &Progress::default());
        lap(&mut stages.visibility);
        let world =
            World::new(&standing, &graph, &pvs, &files, AMBIENT).map_err(|e| e.to_string())?;
        lap(&mut stages.world);
        let mut findings = level.findings.clone();
        findings.extend(graph.findings.iter().cloned());
        findings.extend((voice.findings)(&level, &graph));
        findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
        let sees = graph.cell_ids().map(|c| pvs.seen_from(c).count() as u32);
        let sees: Vec<u32> = sees.collect();
        let mut dearest: Vec<CellId> = graph.cell_ids().collect();
        dearest.sort_by_key(|c| std::cmp::Reverse(sees[c.0 as usize]));
        Ok(Self {
            locator: Locator::new(&graph),
            sees,
            dearest,
            plan: Shapes::of(&level, &graph),
            footing: Footing::new(&standing, &graph, &world.space, &person),
            person,
            path,
            map,
            level,
            standing,
            files,
            graph,
            pvs,
            world,
            findings,
            stages,
            voice,
        })
    }

    /// The level with its footing.
    pub fn site(&self) -> Site<'_> {
        Site {
            graph: &self.graph,
            space: &self.world.space,
            footing: &self.footing,
        }
    }

    /// Whether its file is one of the own format, to which walks can be added.
    pub fn is_in_own_format(&self) -> bool {
        self.path.extension().is_some_and(|e| e == "toml")
    }

    /// A cell that holds a place of the plan.
    pub fn cell_at(&self, at: DVec2) -> Option<CellId> {
        let fine = self.graph.grid.fine(at)?;
        self.locator.cells_at(&self.graph, &fine).first().copied()
    }

    /// What people call a cell's sector: its name, or its number.
    pub fn sector(&self, cell: CellId) -> String {
        let sector = self.graph.cell(cell).sector;
        let named = sector.and_then(|s| self.level.sectors.get(s.0 as usize)?.name.clone());
        match (named, sector) {
            (Some(name), _) => name,
            (None, Some(s)) => format!("sector {}", s.0),
            (None, None) => "no sector".to_string(),
        }
    }

    /// How many portals a cell has.
    pub fn portals(&self, cell: CellId) -> usize {
        let edges = self.graph.edge_range(cell);
        edges
            .filter(|e| self.graph.edge(cells::EdgeId(*e)).twin().is_some())
            .count()
    }

    /// The cell whose middle is farthest away of all that a cell sees, and how far.
    pub fn farthest(&self, cell: CellId) -> Option<(CellId, f64)> {
        let middle = |c| self.world.middle(c).0;
        let here = middle(cell);
        let seen = self.pvs.seen_from(cell).filter(|c| *c != cell);
        let far = seen.map(|c| (c, middle(c).distance(here)));
        far.max_by(|p, q| p.1.total_cmp(&q.1))
    }

    /// A point in grid steps in the level's unit.
    pub fn to_level(&self, at: DVec2) -> DVec2 {
        self.graph.grid.offset_to_level(at.x, at.y)
    }

    /// Where a newcomer's eye is: the first camera, or the middle of the largest cell.
    pub fn start(&self) -> (glam::DVec3, glam::DVec3) {
        if let Some(camera) = self.level.scene.cameras.first() {
            return (camera.eye, camera.direction);
        }
        let open = |c: &CellId| {
            let chamber = self.world.space.cell(c.0);
            chamber.ceiling > chamber.floor
        };
        let size = |c: &CellId| self.world.middle(*c).1;
        let cells = self.graph.cell_ids().filter(open);
        let largest = cells.max_by(|a, b| size(a).total_cmp(&size(b)));
        let Some(cell) = largest else {
            return (glam::DVec3::ZERO, glam::DVec3::X);
        };
        let eye = self.eye_level(cell);
        (self.world.middle(cell).0.extend(eye), glam::DVec3::X)
    }

    /// The height of somebody's eyes who stands in a cell.
    pub fn eye_level(&self, cell: CellId) -> f64 {
        let [floor, ceiling] = heights(self.world.space.cell(cell.0));
        floor + self.person.eye.min((ceiling - floor).max(0.0) * 0.9)
    }
}

impl Stage for Document {
    fn world(&self) -> &World {
        &self.world
    }

    fn graph(&self) -> &CellGraph {
        &self.graph
    }
}

impl Shapes {
    fn of(level: &Level, graph: &CellGraph) -> Self {
        let at = |v| graph.vertices.exact(v).to_level(&graph.grid);
        let cells: Vec<Vec<DVec2>> = (graph.cell_ids())
            .map(|c| graph.corners(c).map(at).collect())
            .collect();
        let mut lines = Vec::new();
        for (edge, id) in graph.edges.iter().zip(0u32..) {
            let id = cells::EdgeId(id);
            if edge.twin().is_some_and(|twin| twin.0 < id.0) {
                continue;
            }
            let kind = edge.wall().map(|w| &level.walls[w.0 as usize].kind);
            let line = match (edge.twin().is_some(), kind) {
                (_, Some(WallKind::Opening(opening))) => match opening.style {
                    OpeningStyle::Window => Line::Window,
                    OpeningStyle::Door => Line::Door,
                    _ => Line::Portal,
                },
                (false, _) => Line::Wall,
                (true, Some(WallKind::Edge { .. })) => Line::Step,
                (true, _) => Line::Portal,
            };
            lines.push((line, [at(edge.origin), at(graph.end(id))]));
        }
        // Walls last, over everything else.
        lines.sort_by_key(|(line, _)| match line {
            Line::Portal => 0,
            Line::Step => 1,
            Line::Window => 2,
            Line::Door => 3,
            Line::Wall => 4,
        });
        let all = || cells.iter().flatten().copied();
        let low = all().reduce(DVec2::min).unwrap_or(DVec2::ZERO);
        let high = all().reduce(DVec2::max).unwrap_or(DVec2::ONE);
        Self {
            cells,
            lines,
            bounds: [low, high],
        }
    }
}
