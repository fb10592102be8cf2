//! Whole pictures: which polygons, in which order, and what that costs.

use std::sync::Arc;

use fearless_simd::{Level as Simds, dispatch};
use glam::DVec3;
use rayon::prelude::*;
use smallvec::{SmallVec, smallvec};

use super::border::Line;
use super::canvas::Canvas;
use super::coat::{Coats, Finish, Packed};
use super::culling::{Culling, cone};
use super::fill::{fill, solid};
use super::objects::{self, Spot, Standing, Window};
use super::polygon::Polygons;
use super::view::{Shown, View};
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

/// What is painted in one go.
enum Job<'a> {
    Polygon(Shown<'a>),
    Objects(Standing),
}

impl Job<'_> {
    fn rows(&self) -> (u32, u32) {
        match self {
            Self::Polygon(shown) => shown.rows,
            Self::Objects(standing) => standing.rows,
        }
    }
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

/// Everything that is painted.
struct Scene<'s> {
    painter: &'s Painter<'s>,
    view: &'s View,
    lines: &'s [Line],
    windows: &'s [Window],
    /// The farthest first.
    jobs: &'s [Job<'s>],
}

/// Some rows of the picture.
struct Band<'c> {
    top: u32,
    width: usize,
    pixels: &'c mut [Packed],
    /// Empty, or as many.
    surfaces: &'c mut [u32],
}

/// Pixels that are painted at the end, when what is behind them is.
enum Late {
    /// Of a job: a row's columns.
    Span(usize, u32, (u32, u32)),
    Spot(u32, u32, Spot),
}

impl Scene<'_> {
    /// Paints a band. Returns how many pixels were painted, and how many are covered.
    #[inline(always)]
    fn paint(&self, order: Order, band: &mut Band) -> [u64; 2] {
        let painted = match order {
            Order::BackToFront => self.back_to_front(band),
            Order::FrontToBack => self.front_to_back(band),
        };
        let covered = band.pixels.iter().filter(|p| **p >> 24 != 0).count();
        [painted, covered as u64]
    }

    #[inline(always)]
    fn back_to_front(&self, band: &mut Band) -> u64 {
        let mut painted = 0;
        for job in self.jobs {
            let (first, past) = band.rows(job);
            for y in first..past {
                match job {
                    Job::Polygon(shown) => {
                        let columns = shown.columns(self.lines, y);
                        painted += self.span(shown, y, columns, band);
                    }
                    Job::Objects(standing) => {
                        for x in standing.columns.0..standing.columns.1 {
                            if let Some(spot) = self.spot(standing, x, y) {
                                self.dab((x, y), &spot, band);
                            }
                        }
                    }
                }
            }
        }
        painted
    }

    #[inline(always)]
    fn front_to_back(&self, band: &mut Band) -> u64 {
        let mut painted = 0;
        let width = band.width as u32;
        let n_rows = band.pixels.len() / band.width;
        let mut free: Vec<SmallVec<[(u32, u32); 6]>> = vec![smallvec![(0, width)]; n_rows];
        let mut left = n_rows;
        let mut late = Vec::new();
        for (number, job) in self.jobs.iter().enumerate().rev() {
            let (first, past) = band.rows(job);
            for y in first..past {
                let free = &mut free[(y - band.top) as usize];
                if free.is_empty() {
                    continue;
                }
                match job {
                    Job::Polygon(shown) => {
                        let columns = shown.columns(self.lines, y);
                        if columns.0 >= columns.1 {
                            continue;
                        }
                        if shown.coat.is_clear() {
                            late.extend(parts(free, columns).map(|p| Late::Span(number, y, p)));
                            continue;
                        }
                        for part in parts(free, columns) {
                            painted += self.span(shown, y, part, band);
                        }
                        take(free, columns);
                    }
                    Job::Objects(standing) => {
                        let mut taken: SmallVec<[u32; 64]> = SmallVec::new();
                        for x in parts(free, standing.columns).flat_map(|(from, to)| from..to) {
                            match self.spot(standing, x, y) {
                                Some(spot) if spot.is_clear() => {
                                    late.push(Late::Spot(x, y, spot));
                                }
                                Some(spot) => {
                                    self.dab((x, y), &spot, band);
                                    taken.push(x);
                                }
                                None => {}
                            }
                        }
                        for run in taken.chunk_by(|a, b| a + 1 == *b) {
                            take(free, (run[0], run[run.len() - 1] + 1));
                        }
                    }
                }
                left -= usize::from(free.is_empty());
            }
            if left == 0 {
                break;
            }
        }
        for late in late.iter().rev() {
            match late {
                Late::Span(number, y, columns) => {
                    if let Job::Polygon(shown) = &self.jobs[*number] {
                        painted += self.span(shown, *y, *columns, band);
                    }
                }
                Late::Spot(x, y, spot) => self.dab((*x, *y), spot, band),
            }
        }
        painted
    }

    /// Paints columns of a row; how many.
    #[inline(always)]
    fn span(&self, shown: &Shown, y: u32, (from, to): (u32, u32), band: &mut Band) -> u64 {
        if from >= to {
            return 0;
        }
        let start = band.place(0, y);
        let range = start + from as usize..start + to as usize;
        let painter = self.painter;
        let scene = (painter.world, painter.coats(), self.view);
        fill(scene, shown, (from, y), &mut band.pixels[range.clone()]);
        if !band.surfaces.is_empty() {
            for (x, surface) in (from..).zip(&mut band.surfaces[range]) {
                if solid(painter.coats(), shown, (x, y)) {
                    *surface = shown.polygon;
                }
            }
        }
        u64::from(to - from)
    }

    #[inline(never)]
    fn spot(&self, standing: &Standing, x: u32, y: u32) -> Option<Spot> {
        let painter = self.painter;
        let scene = (painter.world, painter.coats(), self.view);
        objects::spot(
            scene,
            (standing, self.windows),
            (x, y),
            painter.brushes.finish,
        )
    }

    fn dab(&self, (x, y): (u32, u32), spot: &Spot, band: &mut Band) {
        let at = band.place(x, y);
        band.pixels[at] = spot.over(band.pixels[at]);
        if let Some(surface) = band.surfaces.get_mut(at) {
            *surface = self.painter.polygons().iter().len() as u32 + spot.object;
        }
    }
}

impl Band<'_> {
    /// The rows of a job in the band.
    fn rows(&self, job: &Job) -> (u32, u32) {
        let (first, past) = job.rows();
        let bottom = self.top + (self.pixels.len() / self.width) as u32;
        (first.max(self.top), past.min(bottom))
    }

    fn place(&self, x: u32, y: u32) -> usize {
        (y - self.top) as usize * self.width + x as usize
    }
}

/// The parts of columns that are free.
#[inline(always)]
fn parts(free: &[(u32, u32)], (from, to): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let cut = move |&(start, end): &(u32, u32)| (start.max(from), end.min(to));
    free.iter().map(cut).filter(|part| part.0 < part.1)
}

/// Takes columns out of those that are free.
#[inline(always)]
fn take(free: &mut SmallVec<[(u32, u32); 6]>, (from, to): (u32, u32)) {
    let mut i = 0;
    while i < free.len() {
        let (start, end) = free[i];
        if end <= from {
            i += 1;
        } else if to <= start {
            return;
        } else if start < from && to < end {
            free[i].1 = from;
            free.insert(i + 1, (to, end));
            return;
        } else if start < from {
            free[i].1 = from;
            i += 1;
        } else if to < end {
            free[i].0 = to;
            return;
        } else {
            free.remove(i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::sampling::Source;

    #[test]
    fn columns_are_taken_once() {
        let mut random = Source::new(2, 7, 1);
        for _ in 0..200 {
            let mut free: SmallVec<[(u32, u32); 6]> = smallvec![(0, 50)];
            let mut plain = [true; 50];
            for _ in 0..12 {
                let mut next = || (random.next() * 51.0) as u32;
                let (a, b) = (next(), next());
                let columns = (a.min(b), a.max(b));
                if columns.0 == columns.1 {
                    continue;
                }
                let met = parts(&free, columns).flat_map(|(from, to)| from..to);
                let expected = (columns.0..columns.1).filter(|&x| plain[x as usize]);
                assert!(met.eq(expected));
                take(&mut free, columns);
                plain[columns.0 as usize..columns.1 as usize].fill(false);
                assert!(free.iter().all(|(from, to)| from < to));
                let left: u32 = free.iter().map(|(from, to)| to - from).sum();
                assert_eq!(left as usize, plain.iter().filter(|p| **p).count());
            }
        }
    }
}
