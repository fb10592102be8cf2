//! Whole pictures: which polygons, in which order, and what that costs.

use std::sync::Arc;

use fearless_simd::{Level as Simds, dispatch};
use glam::DVec3;
use rayon::prelude::*;

use super::band::{Band, Job, Scene};
use super::border::Line;
use super::canvas::Canvas;
use super::coat::{Coats, Finish, Packed};
use super::culling::{Culling, cone};
use super::objects::{self, Window};
use super::polygon::Polygons;
use super::view::View;
use crate::cells::{CellGraph, CellId, Locator, Tree};
use crate::pvs::Pvs;
use crate::pvs::eye::{Lookout, Scratch};
use crate::trace::camera::Camera;
use crate::trace::world::{EyeError, World, locate};

/// In which order polygons are painted. The picture is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Order {
    /// The painter's: the farthest first; what is nearer covers it.
    BackToFront,
    /// The nearest first, each only on pixels that are still free, until none is.
    #[default]
    FrontToBack,
}

/// How a picture is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Which cells.
    pub culling: Culling,
    /// In which order.
    pub order: Order,
    /// Whether objects are drawn.
    pub objects: bool,
    /// Whether the canvas keeps what each pixel shows.
    pub surfaces: bool,
}

/// What a painted picture cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Figures {
    /// Cells that were to be painted.
    pub cells: u64,
    /// Polygons of the whole level.
    pub all: u64,
    /// Polygons of the cells.
    pub polygons: u64,
    /// Those that the eye is before, which were painted; the others show their backs.
    pub painted: u64,
    /// Of those, the ones that may lie within the picture.
    pub shown: u64,
    /// Triangles of the cells' polygons, as a graphics card would count.
    pub triangles: u64,
    /// Objects in the cells; one that reaches into several counts in each.
    pub objects: u64,
    /// Pixels that polygons were painted on, holes included, each as often as that was done.
    pub pixels: u64,
    /// Pixels of the picture that are covered.
    pub covered: u64,
}

impl Figures {
    /// How often a pixel was painted on average; 1 is the least.
    pub fn overdraw(&self) -> f64 {
        self.pixels as f64 / self.covered.max(1) as f64
    }

    /// The culling factor: all polygons of the level to those painted.
    pub fn factor(&self) -> f64 {
        self.all as f64 / self.painted.max(1) as f64
    }
}

/// What painting a level needs beside the level: made once, and borrowing nothing, so that whoever keeps
/// a level can keep it too.
pub struct Brushes {
    /// The polygons.
    pub polygons: Polygons,
    /// What they are painted with.
    pub coats: Coats,
    /// How pictures look.
    pub finish: Finish,
    locator: Locator,
}

/// A level made ready to be painted, once for all pictures.
pub struct Painter<'a> {
    world: &'a World,
    graph: &'a CellGraph,
    tree: &'a Tree,
    pvs: &'a Pvs,
    brushes: Arc<Brushes>,
    lookout: Lookout<'a>,
}

/// What is painted in one go, as [`Painter::order`] tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// The polygon of that number, with its second coat if it has one. The eye is before it.
    Polygon(u32),
    /// What stands in a cell; nothing may.
    Objects(CellId),
}

/// What is needed to paint, kept from one picture to the next; afterwards it holds the picture.
#[derive(Default)]
pub struct Easel {
    /// The picture.
    pub canvas: Canvas,
    scratch: Scratch,
    wanted: Vec<bool>,
    lines: Vec<Line>,
    windows: Vec<Window>,
}

impl<'a> Painter<'a> {
    /// Makes a level ready. `None` for a graph without a tree: one that was not split by lines.
    pub fn new(
        world: &'a World,
        graph: &'a CellGraph,
        pvs: &'a Pvs,
        finish: Finish,
    ) -> Option<Self> {
        // Whether there is a tree is asked first: the rest takes longer.
        graph.tree.as_ref()?;
        let brushes = Arc::new(Brushes::new(world, graph, finish));
        Self::with(world, graph, pvs, brushes)
    }

    /// As [`Painter::new`], with what was made ready before of the same world and graph. O(cells).
    pub fn with(
        world: &'a World,
        graph: &'a CellGraph,
        pvs: &'a Pvs,
        brushes: Arc<Brushes>,
    ) -> Option<Self> {
        Some(Self {
            world,
            graph,
            tree: graph.tree.as_ref()?,
            pvs,
            brushes,
            lookout: Lookout::new(graph),
        })
    }

    /// The world that is painted.
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// What was made ready once.
    pub fn brushes(&self) -> &Arc<Brushes> {
        &self.brushes
    }

    /// The polygons.
    pub fn polygons(&self) -> &Polygons {
        &self.brushes.polygons
    }

    /// What they are painted with.
    pub fn coats(&self) -> &Coats {
        &self.brushes.coats
    }

    /// Draws what a camera sees onto the easel's canvas. O(cells + pixels painted), with bands of rows on
    /// the threads of the current pool.
    pub fn draw(
        &self,
        camera: &Camera,
        options: &Options,
        easel: &mut Easel,
    ) -> Result<Figures, EyeError> {
        self.draw_chosen((camera, camera), options, easel)
    }

    /// As [`Painter::draw`], of the cells that are drawn for a second camera: what that one sees, looked
    /// at from elsewhere, be it from outside of the level.
    pub fn draw_chosen(
        &self,
        (camera, chosen_for): (&Camera, &Camera),
        options: &Options,
        easel: &mut Easel,
    ) -> Result<Figures, EyeError> {
        self.choose(chosen_for, options.culling, easel)?;
        let view = View::new(camera);
        let mut jobs = Vec::new();
        let mut lines = std::mem::take(&mut easel.lines);
        let mut windows = std::mem::take(&mut easel.windows);
        lines.clear();
        windows.clear();
        let (mut shown, mut objects) = (0, 0);
        let mut figures = self.order(camera.eye, easel, |turn| match turn {
            Turn::Polygon(number) => {
                let added = self.add(&view, number, &mut lines, &mut jobs);
                shown += u64::from(added);
            }
            Turn::Objects(cell) if options.objects => {
                let standing = objects::show(self.world, &view, cell, &mut windows);
                objects += self.world.objects_in(cell).len() as u64;
                jobs.extend(standing.map(Job::Objects));
            }
            Turn::Objects(_) => {}
        })?;
        figures.shown = shown;
        figures.objects = objects;
        (easel.lines, easel.windows) = (lines, windows);
        easel.canvas.clear(camera.size, options.surfaces);
        let scene = Scene {
            painter: self,
            view: &view,
            lines: &easel.lines,
            windows: &easel.windows,
            jobs: &jobs,
        };
        let [width, height] = camera.size.map(|n| n as usize);
        let threads = rayon::current_num_threads();
        // Some more than threads: they take unequally long.
        let rows = height.div_ceil(if threads > 1 { 4 * threads } else { 1 });
        let bands = easel.canvas.bands(rows * width);
        let paint = |(number, (pixels, surfaces)): (usize, (&mut [Packed], &mut [u32]))| {
            let mut band = Band {
                top: (number * rows) as u32,
                width,
                pixels,
                surfaces,
            };
            dispatch!(Simds::new(), _simd => scene.paint(options.order, &mut band))
        };
        let counts: Vec<[u64; 2]> = if threads > 1 {
            bands.into_par_iter().enumerate().map(paint).collect()
        } else {
            bands.into_iter().enumerate().map(paint).collect()
        };
        figures.pixels = counts.iter().map(|c| c[0]).sum();
        figures.covered = counts.iter().map(|c| c[1]).sum();
        Ok(figures)
    }

    /// What drawing would have to do, without doing it; pixels and what lies within the picture are not
    /// counted. O(polygons of the cells).
    pub fn count(
        &self,
        camera: &Camera,
        culling: Culling,
        easel: &mut Easel,
    ) -> Result<Figures, EyeError> {
        self.choose(camera, culling, easel)?;
        let mut figures = self.figures();
        for cell in easel.chosen() {
            self.tally(cell, camera.eye, &mut figures, |_| {});
        }
        Ok(figures)
    }

    /// The order in which everything in the chosen cells is painted, the farthest first: of each cell its
    /// polygons before which the eye is, then what stands in it. The eye may be where no cell is, or
    /// another than the one that the cells were chosen for. Pixels, and what lies within the picture, are not
    /// counted.
    pub fn order(
        &self,
        eye: DVec3,
        easel: &Easel,
        mut turn: impl FnMut(Turn),
    ) -> Result<Figures, EyeError> {
        let outside = EyeError::Outside(eye);
        let fine = self.graph.grid.fine(eye.truncate()).ok_or(outside)?;
        let mut figures = self.figures();
        self.tree.back_to_front(&fine, |cell| {
            if easel.wanted[cell.0 as usize] {
                self.tally(cell, eye, &mut figures, |n| turn(Turn::Polygon(n)));
                turn(Turn::Objects(cell));
            }
        });
        Ok(figures)
    }

    fn figures(&self) -> Figures {
        Figures {
            all: self.polygons().iter().len() as u64,
            ..Figures::default()
        }
    }

    /// Counts a cell, and names its polygons that the eye is before.
    fn tally(&self, cell: CellId, eye: DVec3, figures: &mut Figures, mut visit: impl FnMut(u32)) {
        let polygons = self.polygons();
        let list = polygons.in_cell(cell);
        figures.cells += 1;
        figures.triangles += u64::from(polygons.triangles_in(cell));
        figures.polygons += list.len() as u64;
        figures.objects += self.world.objects_in(cell).len() as u64;
        for (number, polygon) in (polygons.first_in(cell)..).zip(list) {
            if polygon.before(&self.world.space, eye) > 0.0 {
                figures.painted += 1;
                visit(number);
            }
        }
    }

    /// Chooses the cells that are painted for a camera; the easel keeps them. Returns the eye's cell. An
    /// error leaves none chosen, but with [`Culling::None`] all of them.
    pub fn choose(
        &self,
        camera: &Camera,
        culling: Culling,
        easel: &mut Easel,
    ) -> Result<CellId, EyeError> {
        let n = self.graph.cells.len();
        let wanted = &mut easel.wanted;
        wanted.clear();
        wanted.resize(n, culling == Culling::None);
        let cell = locate(self.world, self.graph, &self.brushes.locator, camera.eye)?;
        match culling {
            Culling::None => {}
            Culling::Pvs => {
                wanted[cell.0 as usize] = true;
                for seen in self.pvs.seen_from(cell) {
                    wanted[seen.0 as usize] = true;
                }
            }
            Culling::Eye => {
                let outside = EyeError::Outside(camera.eye);
                let eye = self.graph.grid.fine(camera.eye.truncate()).ok_or(outside)?;
                let vista = self.lookout.look(&eye, &cone(camera), &mut easel.scratch);
                for seen in vista.map_err(|_| outside)?.cells() {
                    wanted[seen.0 as usize] = true;
                }
            }
        }
        Ok(cell)
    }

    /// Adds what there is to paint of a polygon; whether it may lie within the picture.
    fn add<'s>(
        &'s self,
        view: &View,
        number: u32,
        lines: &mut Vec<Line>,
        jobs: &mut Vec<Job<'s>>,
    ) -> bool {
        let Brushes {
            polygons, coats, ..
        } = &*self.brushes;
        let polygon = polygons.get(number);
        let mut show = |coat| {
            let shown = view.show(&self.world.space, (number, polygon), (coats, coat), lines);
            jobs.extend(shown.map(Job::Polygon));
            shown.is_some()
        };
        if !show(&coats.list[number as usize]) {
            return false;
        }
        if let Some(coat) = coats.over(number) {
            show(coat);
        }
        true
    }
}

impl Brushes {
    /// Makes a level ready.
    pub fn new(world: &World, graph: &CellGraph, finish: Finish) -> Self {
        let polygons = Polygons::of(&world.space);
        Self {
            coats: Coats::new(world, &polygons, finish),
            polygons,
            finish,
            locator: Locator::new(graph),
        }
    }
}

impl Easel {
    /// The cells that were chosen last, ascending.
    pub fn chosen(&self) -> impl Iterator<Item = CellId> + '_ {
        let wanted = (0..).zip(&self.wanted).filter(|(_, wanted)| **wanted);
        wanted.map(|(cell, _)| CellId(cell))
    }
}
