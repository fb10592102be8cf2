//! What an engine needs while it runs: from a `.pvs` file to the cells that a frame has to draw.
//!
//! In: the bytes of a file that `enfilade build -o` wrote, read once into a [`Runtime`]. Out, frame by
//! frame and without allocating: the cell of a point, the cells that a cell can see, the cells that an
//! eye sees within its angle of view. Places are in the level's own coordinates, directions in degrees
//! counterclockwise from east.
//!
//! ```
//! use enfilade::pvs::runtime::{Runtime, Workspace};
//! use glam::DVec2;
//! # use enfilade::{cells, level::toml, pvs::{Progress, file, sweep}};
//! # let level = toml::read("
//! #     [[room]]\nname = 'Hall'\nrect = [0, 0, 6, 4]
//! #     [[room]]\nname = 'Kitchen'\nrect = [6, 0, 10, 4]
//! #     [[door]]\nbetween = ['Hall', 'Kitchen']\nwidth = 0.9", "home.toml")?;
//! # let graph = cells::subdivide(&level, &cells::Options::default());
//! # let pvs = sweep::sweep(&graph, &Progress::default());
//! # let bytes = file::encode(&file::LevelInfo::of(&level), &graph, &pvs);
//! // Once: `let bytes = std::fs::read("home.pvs")?;`
//! let home = Runtime::from_bytes(&bytes)?;
//! let mut workspace = Workspace::new(&home);
//!
//! // Each frame: where is the eye, and what may it ever see from there?
//! let eye = DVec2::new(1.0, 2.0);
//! let here = home.locate(eye).ok_or("the eye is inside of a wall")?;
//! assert_eq!(home.visible(here).count(), 2);
//!
//! // What does it see now, within 60 degrees to the west? The kitchen is behind it.
//! let view = home.look(eye, 180.0, 60.0, &mut workspace)?;
//! assert_eq!(view.cells(), [here]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/cull.rs` walks along a path and culls a scene in each frame. Which floors, walls and
//! things belong to which cell is the engine's to know: [`CellGraph`] says
//! where a cell lies, and which sector and walls of the level it has.
//!
//! An eye that is in no cell (`None`, [`LookError::Outside`]) has left the level, say by a step into a
//! wall; engines then stay with what the last frame saw, or draw everything.

use glam::DVec2;
use thiserror::Error;

use super::eye::{Cone, ConeError, Lookout, Scratch, Vista};
use super::file::{self, FileError, LevelInfo, PvsFile};
use super::{Pvs, ones};
use crate::cells::{CellGraph, CellId};

/// A finished `.pvs` file, ready to be asked each frame. Owns all that it needs, and never changes: any
/// number of threads may ask it, each with its own [`Workspace`].
pub struct Runtime {
    info: LevelInfo,
    pvs: Pvs,
    lookout: Lookout<'static>,
}

/// Room to work in, kept from frame to frame so that none allocates.
#[derive(Default)]
pub struct Workspace {
    scratch: Scratch,
}

impl Workspace {
    /// With room for a whole level, so that not even the first frames allocate.
    pub fn new(runtime: &Runtime) -> Self {
        Self {
            scratch: Scratch::for_graph(runtime.graph()),
        }
    }
}

/// Why there is nothing to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum LookError {
    /// The eye is in no cell.
    #[error("the eye lies outside of the level")]
    Outside,
    /// The directions are none.
    #[error(transparent)]
    Cone(#[from] ConeError),
}

impl Runtime {
    /// Reads the bytes of a `.pvs` file.
    ///
    /// # Errors
    /// As [`file::decode`]: bytes that are no sound `.pvs` file are refused, none make it panic.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FileError> {
        Ok(Self::new(file::decode(bytes)?))
    }

    /// Makes a file ready that was read already.
    pub fn new(file: PvsFile) -> Self {
        Self {
            info: file.info,
            pvs: file.pvs,
            lookout: Lookout::owning(file.graph),
        }
    }

    /// The level that it is of.
    pub fn info(&self) -> &LevelInfo {
        &self.info
    }

    /// The cells, their corners, walls and portals.
    pub fn graph(&self) -> &CellGraph {
        self.lookout.graph()
    }

    /// Which cells see which, and how that was found.
    pub fn pvs(&self) -> &Pvs {
        &self.pvs
    }

    /// Number of cells. They are numbered from 0.
    pub fn n_cells(&self) -> usize {
        self.pvs.visible.n()
    }

    /// The cell that holds a point; on a border, the one with the smaller number. O(1) on average, and
    /// exact for the point rounded to a 2^20th of a grid step.
    pub fn locate(&self, at: DVec2) -> Option<CellId> {
        let graph = self.graph();
        let at = graph.grid.fine(at)?;
        self.lookout.locator().first_at(graph, &at)
    }

    /// Whether two cells can see each other.
    ///
    /// # Panics
    /// Here and below: for a cell that there is not.
    pub fn sees(&self, a: CellId, b: CellId) -> bool {
        self.pvs.sees(a, b)
    }

    /// The cells that a cell can see, itself among them, ascending.
    pub fn visible(&self, from: CellId) -> impl Iterator<Item = CellId> + Clone + '_ {
        ones(self.visible_bits(from)).map(|i| CellId(i as u32))
    }

    /// The same as a set of bits: bit i % 64 of word i / 64 is cell i.
    pub fn visible_bits(&self, from: CellId) -> &[u64] {
        self.pvs.visible.row(from.0 as usize)
    }

    /// What an eye sees that looks in a `direction` with an angle of view of `fov` degrees, 360 being
    /// all around. Exact, and always part of what [`visible`](Runtime::visible) says of its cell.
    ///
    /// # Errors
    /// Where the eye is in no cell, or the angles are no cone.
    pub fn look<'a>(
        &'a self,
        eye: DVec2,
        direction: f64,
        fov: f64,
        workspace: &'a mut Workspace,
    ) -> Result<Vista<'a>, LookError> {
        let cone = Cone::new(direction, fov)?;
        let eye = self.graph().grid.fine(eye).ok_or(LookError::Outside)?;
        let found = self.lookout.look(&eye, &cone, &mut workspace.scratch);
        found.map_err(|_| LookError::Outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Locator, Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::{Progress, sweep};

    const ROOMS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\noutline = [[4, 0], [9, 0], [9, 9], [7, 9], [7, 4], [4, 4]]\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";

    fn rooms() -> (Runtime, CellGraph, Pvs) {
        let level = read(ROOMS.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let pvs = sweep::sweep(&graph, &Progress::default());
        let bytes = file::encode(&LevelInfo::of(&level), &graph, &pvs);
        (Runtime::from_bytes(&bytes).unwrap(), graph, pvs)
    }

    #[test]
    fn answers_are_those_of_the_stages() {
        let (runtime, graph, pvs) = rooms();
        assert_eq!(runtime.info().name, "rooms");
        let locator = Locator::new(&graph);
        let lookout = Lookout::new(&graph);
        let (mut scratch, mut workspace) = (Scratch::default(), Workspace::default());
        let mut inside = 0;
        for i in 0..2000 {
            let at = DVec2::new(
                f64::from(i % 50) * 0.2 - 0.5,
                f64::from(i / 50) * 0.25 - 0.5,
            );
            let eye = graph.grid.fine(at).unwrap();
            let cell = locator.cells_at(&graph, &eye).first().copied();
            assert_eq!(runtime.locate(at), cell);
            let direction = f64::from(i * 7);
            let view = runtime.look(at, direction, 60.0, &mut workspace);
            let Some(cell) = cell else {
                assert!(matches!(view, Err(LookError::Outside)));
                continue;
            };
            inside += 1;
            assert!(runtime.visible(cell).eq(pvs.seen_from(cell)));
            let cone = Cone::new(direction, 60.0).unwrap();
            let expected = lookout.look(&eye, &cone, &mut scratch).unwrap();
            let view = view.unwrap();
            assert_eq!(view.cells(), expected.cells());
            for other in graph.cell_ids() {
                assert_eq!(view.sees(other), view.cells().contains(&other));
                let around_the_eye = view.own_cells().iter().any(|&own| pvs.sees(own, other));
                assert!(around_the_eye || !view.sees(other));
            }
        }
        assert!(inside > 500, "{inside}");
    }

    #[test]
    fn what_is_no_view_is_said() {
        let (runtime, ..) = rooms();
        let mut workspace = Workspace::new(&runtime);
        let mut look = |x, direction, fov| {
            let view = runtime.look(DVec2::new(x, 1.0), direction, fov, &mut workspace);
            view.map(|_| ()).unwrap_err()
        };
        assert_eq!(look(-1.0, 0.0, 60.0), LookError::Outside);
        assert_eq!(look(f64::NAN, 0.0, 60.0), LookError::Outside);
        assert_eq!(look(1.0, 0.0, 0.0), LookError::Cone(ConeError::Fov(0.0)));
        assert!(runtime.locate(DVec2::new(f64::INFINITY, 0.0)).is_none());
        assert!(Runtime::from_bytes(b"\x89PVS").is_err());
    }
}
