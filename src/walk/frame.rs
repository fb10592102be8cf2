//! Frame by frame: what there is to draw, how much of it, and what stays as it was in the frame before.
//!
//! In: the camera of each frame, in order. Out: a [`Step`]: the eye's cell, found exactly, its PVS and the
//! effects that can matter there; and [`Counts`] of what there is to paint. While the eye stays in a
//! cell, all but its place is as in the frame before, and is not found out again.

use serde::{Deserialize, Serialize};

use crate::cells::{CellGraph, CellId, Locator};
use crate::preview::{Culling, Easel, Painter};
use crate::pvs::Pvs;
use crate::trace::camera::Camera;
use crate::trace::effects::{Survey, survey};
use crate::trace::world::{EyeError, World, locate};

/// What the frames of a walk have in common.
pub struct Guide<'a> {
    world: &'a World,
    graph: &'a CellGraph,
    pvs: &'a Pvs,
    locator: Locator,
    reuse: bool,
    last: Option<Step>,
}

/// What holds as long as the eye is in a cell.
#[derive(Clone, Debug)]
pub struct Step {
    /// The cell.
    pub cell: CellId,
    /// Number of cells in its PVS, itself among them.
    pub seen: usize,
    /// What pictures from there call for.
    pub survey: Survey,
    /// Whether all of it was taken over from the frame before.
    pub same: bool,
}

impl<'a> Guide<'a> {
    /// At the start. Without `reuse` everything is found out for each frame anew.
    pub fn new(world: &'a World, graph: &'a CellGraph, pvs: &'a Pvs, reuse: bool) -> Self {
        Self {
            world,
            graph,
            pvs,
            locator: Locator::new(graph),
            reuse,
            last: None,
        }
    }

    /// The cell of an eye.
    pub fn cell(&self, camera: &Camera) -> Result<CellId, EyeError> {
        locate(self.world, self.graph, &self.locator, camera.eye)
    }

    /// Goes on to the next frame.
    pub fn step(&mut self, camera: &Camera) -> Result<&Step, EyeError> {
        let cell = self.cell(camera)?;
        let kept = (self.last.take()).filter(|last| self.reuse && last.cell == cell);
        let step = match kept {
            Some(last) => Step { same: true, ..last },
            None => Step {
                cell,
                seen: self.pvs.seen_from(cell).count(),
                survey: survey(self.world, self.pvs, cell),
                same: false,
            },
        };
        Ok(self.last.insert(step))
    }
}

/// How much there is to paint in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Polygons of the whole level.
    pub all: u64,
    /// Of those, the ones that do not show the eye their backs.
    pub facing: u64,
    /// The same in the cells of the PVS.
    pub pvs: u64,
    /// The same in the cells that the eye sees within the picture.
    pub eye: u64,
    /// Number of cells that the eye sees within the picture.
    pub cells: u64,
}

impl Counts {
    /// Counts what a camera would have to paint.
    pub fn of(painter: &Painter, camera: &Camera, easel: &mut Easel) -> Result<Self, EyeError> {
        let [none, pvs, eye] = Culling::ALL.map(|culling| painter.count(camera, culling, easel));
        let (none, eye) = (none?, eye?);
        Ok(Self {
            all: none.all,
            facing: none.painted,
            pvs: pvs?.painted,
            eye: eye.painted,
            cells: eye.cells,
        })
    }

    /// The culling factors: all polygons against those painted, by backs alone, with the PVS, and with
    /// what the eye sees.
    pub fn factors(&self) -> [f64; 3] {
        [self.facing, self.pvs, self.eye].map(|n| self.all as f64 / n.max(1) as f64)
    }
}
