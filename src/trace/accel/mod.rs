//! Acceleration structures: which of many primitives does a ray meet first?
//!
//! In: [`Primitives`] (numbered things with bounds: the objects of a cell, the triangles of a mesh,
//! the surfaces of a level). Out: a [`Structure`], one of the [`Kind`]s of the lecture, that answers
//! two questions about a ray: the nearest contact, and any contact before some t (for shadows). It holds
//! numbers only, and is asked together with the primitives that it was built over.
//!
//! All structures give the very same answer as brute force, for every ray: see [`search`] for why the
//! contacts are the same numbers, [`cast`] for why no box is missed, and `margin` for why no contact
//! falls between two cells.
//!
//! | file | structure |
//! |---|---|
//! | [`brute`] | none |
//! | [`bvh`] | bounding volumes: median cut or insertion, of boxes, spheres or slabs |
//! | [`grid`] | uniform grid: classical walk, or Amanatides and Woo's |
//! | [`octree`] | octree, the pushed point |
//! | [`kd`] | kd-tree: balance or surface area, with stack, restart or backtrack |
//! | [`bsp`] | halves across x, y, z in turn |

pub mod bounds;
pub mod brute;
pub mod bsp;
pub mod bvh;
pub mod cast;
pub mod count;
pub mod grid;
pub mod kd;
mod mailbox;
mod margin;
pub mod octree;
pub mod primitives;
pub mod search;
#[cfg(test)]
mod tests;

use std::fmt;
use std::str::FromStr;

pub use bounds::Bounds;
pub use cast::Cast;
pub use count::{Count, Counters};
pub use primitives::{Contact, Found, Primitives, Want};

use super::ray::Start;
use brute::Brute;
use bsp::Bsp;
use bvh::volume::{Ball, Slabs};
use bvh::{Build, Bvh};
use grid::{Grid, GridWalk};
use kd::{Kd, KdWalk, Split};
use octree::Octree;
use search::{Any, Nearest, Search};

/// What every structure does: lead a search past the primitives in its way.
pub trait Walk {
    /// Has `search` test every primitive that can have a contact not later than its limit, roughly
    /// from near to far. `slack` is that of the ray, by which boxes are enlarged.
    fn walk<S: Search, C: Count>(&self, cast: &Cast, slack: f64, search: &mut S, count: &mut C);

    /// Memory taken, without the primitives.
    fn bytes(&self) -> usize;

    /// Checks that the structure is whole and belongs to the primitives.
    fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String>;
}

/// What bounding volumes are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VolumeKind {
    /// Boxes along the axes.
    Boxes,
    /// Spheres.
    Spheres,
    /// Polyhedra of seven slabs.
    Slabs,
}

/// A kind of structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// See [`brute`].
    Brute,
    /// See [`bvh`].
    Bvh(Build, VolumeKind),
    /// See [`grid`].
    Grid(GridWalk),
    /// See [`octree`].
    Octree,
    /// See [`kd`].
    Kd(Split, KdWalk),
    /// See [`bsp`].
    Bsp,
}

impl Kind {
    /// Every kind, brute force first.
    pub const ALL: [Self; 17] = [
        Self::Brute,
        Self::Bvh(Build::MedianCut, VolumeKind::Boxes),
        Self::Bvh(Build::MedianCut, VolumeKind::Spheres),
        Self::Bvh(Build::MedianCut, VolumeKind::Slabs),
        Self::Bvh(Build::Insertion, VolumeKind::Boxes),
        Self::Bvh(Build::Insertion, VolumeKind::Spheres),
        Self::Bvh(Build::Insertion, VolumeKind::Slabs),
        Self::Grid(GridWalk::Classical),
        Self::Grid(GridWalk::AmanatidesWoo),
        Self::Octree,
        Self::Kd(Split::Balance, KdWalk::Stack),
        Self::Kd(Split::Balance, KdWalk::Restart),
        Self::Kd(Split::Balance, KdWalk::Backtrack),
        Self::Kd(Split::Area, KdWalk::Stack),
        Self::Kd(Split::Area, KdWalk::Restart),
        Self::Kd(Split::Area, KdWalk::Backtrack),
        Self::Bsp,
    ];

    /// Its name in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Brute => "brute",
            Self::Bvh(Build::MedianCut, VolumeKind::Boxes) => "bvh-median-boxes",
            Self::Bvh(Build::MedianCut, VolumeKind::Spheres) => "bvh-median-spheres",
            Self::Bvh(Build::MedianCut, VolumeKind::Slabs) => "bvh-median-slabs",
            Self::Bvh(Build::Insertion, VolumeKind::Boxes) => "bvh-insertion-boxes",
            Self::Bvh(Build::Insertion, VolumeKind::Spheres) => "bvh-insertion-spheres",
            Self::Bvh(Build::Insertion, VolumeKind::Slabs) => "bvh-insertion-slabs",
            Self::Grid(GridWalk::Classical) => "grid-classical",
            Self::Grid(GridWalk::AmanatidesWoo) => "grid-amanatides-woo",
            Self::Octree => "octree",
            Self::Kd(Split::Balance, KdWalk::Stack) => "kd-balance-stack",
            Self::Kd(Split::Balance, KdWalk::Restart) => "kd-balance-restart",
            Self::Kd(Split::Balance, KdWalk::Backtrack) => "kd-balance-backtrack",
            Self::Kd(Split::Area, KdWalk::Stack) => "kd-area-stack",
            Self::Kd(Split::Area, KdWalk::Restart) => "kd-area-restart",
            Self::Kd(Split::Area, KdWalk::Backtrack) => "kd-area-backtrack",
            Self::Bsp => "bsp",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = Self::ALL.iter().map(|kind| kind.name()).collect();
            format!(
                "no structure is called `{name}`; there are {}",
                names.join(", ")
            )
        })
    }
}

/// A structure of any kind.
#[derive(Clone, Debug)]
pub struct Structure {
    tree: Tree,
    /// The greatest coordinate of the primitives' bounds.
    reach: f64,
    bounds: Bounds,
}

#[derive(Clone, Debug)]
enum Tree {
    Brute(Brute),
    Boxes(Bvh<Bounds>),
    Spheres(Bvh<Ball>),
    Slabs(Bvh<Slabs>),
    Grid(Grid),
    Octree(Octree),
    Kd(Kd),
    Bsp(Bsp),
}

/// Does the same with whichever structure it is.
macro_rules! of {
    ($tree:expr, $name:ident => $what:expr) => {
        match $tree {
            Tree::Brute($name) => $what,
            Tree::Boxes($name) => $what,
            Tree::Spheres($name) => $what,
            Tree::Slabs($name) => $what,
            Tree::Grid($name) => $what,
            Tree::Octree($name) => $what,
            Tree::Kd($name) => $what,
            Tree::Bsp($name) => $what,
        }
    };
}

impl Structure {
    /// Builds one over the primitives.
    pub fn new<P: Primitives>(kind: Kind, primitives: &P) -> Self {
        let bounds = margin::whole(primitives);
        let tree = match kind {
            Kind::Brute => Tree::Brute(Brute::new(primitives)),
            Kind::Bvh(build, VolumeKind::Boxes) => Tree::Boxes(Bvh::new(primitives, build)),
            Kind::Bvh(build, VolumeKind::Spheres) => Tree::Spheres(Bvh::new(primitives, build)),
            Kind::Bvh(build, VolumeKind::Slabs) => Tree::Slabs(Bvh::new(primitives, build)),
            Kind::Grid(walk) => Tree::Grid(Grid::new(primitives, walk)),
            Kind::Octree => Tree::Octree(Octree::new(primitives)),
            Kind::Kd(split, walk) => Tree::Kd(Kd::new(primitives, split, walk)),
            Kind::Bsp => Tree::Bsp(Bsp::new(primitives)),
        };
        Self {
            tree,
            reach: bounds.reach(),
            bounds,
        }
    }

    /// As [`Structure::new`], for primitives among others that reach as far as that: structures with
    /// the same reach give the same contacts, to the last bit, of the primitives that they share.
    pub fn within<P: Primitives>(kind: Kind, primitives: &P, reach: f64) -> Self {
        let mut structure = Self::new(kind, primitives);
        structure.reach = structure.reach.max(reach);
        structure
    }

    /// The box around all primitives.
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// The first contact of the ray not later than `limit` (which may be infinite); of several at the
    /// same t that of the primitive with the lowest number.
    pub fn nearest<P: Primitives, C: Count>(
        &self,
        primitives: &P,
        cast: &Cast,
        start: Option<&Start>,
        limit: f64,
        count: &mut C,
    ) -> Option<Found> {
        let slack = cast.slack(self.reach);
        let mut search = Nearest::new(primitives, cast, start, (limit, slack), count);
        of!(&self.tree, tree => tree.walk(cast, slack, &mut search, count));
        search.found()
    }

    /// Some contact of the ray before `before`, whichever is found first; none if there is none.
    pub fn any<P: Primitives, C: Count>(
        &self,
        primitives: &P,
        cast: &Cast,
        start: Option<&Start>,
        before: f64,
        count: &mut C,
    ) -> Option<Found> {
        let slack = cast.slack(self.reach);
        let mut search = Any::new(primitives, cast, start, (before, slack), count);
        if search.found().is_none() {
            of!(&self.tree, tree => tree.walk(cast, slack, &mut search, count));
        }
        search.found()
    }

    /// Memory taken, without the primitives.
    pub fn bytes(&self) -> usize {
        of!(&self.tree, tree => tree.bytes())
    }

    /// Checks that the structure is whole and belongs to the primitives.
    pub fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String> {
        of!(&self.tree, tree => tree.validate(primitives))
    }
}

/// How many entries beyond one per primitive the lists of a structure that cuts evenly may get. Big
/// overlapping things would else be listed in every small cell along them.
fn room(len: usize) -> usize {
    11 * len + 256
}

/// Both sides of a plane.
fn halves(space: &Bounds, axis: usize, at: f64) -> [Bounds; 2] {
    let (mut low, mut high) = (*space, *space);
    low.max[axis] = at;
    high.min[axis] = at;
    [low, high]
}

/// Those of the list whose boxes touch the space up to the plane, and from it on.
fn share(list: &[u32], boxes: &[Bounds], axis: usize, at: f64) -> [Vec<u32>; 2] {
    let those = |touches: &dyn Fn(&Bounds) -> bool| {
        let touches = |&&p: &&u32| touches(&boxes[p as usize]);
        list.iter().filter(touches).copied().collect()
    };
    [those(&|b| b.min[axis] <= at), those(&|b| b.max[axis] >= at)]
}

/// Checks that every primitive whose box touches the leaf is listed in it, once.
fn check_leaf(leaf: &Bounds, listed: &[u32], boxes: &[Bounds]) -> Result<(), String> {
    let mut sorted = listed.to_vec();
    sorted.sort_unstable();
    if sorted.windows(2).any(|w| w[0] == w[1]) {
        return Err(format!("a primitive is listed twice in {leaf:?}"));
    }
    for (primitive, b) in (0..).zip(boxes) {
        if b.touches(leaf) && sorted.binary_search(&primitive).is_err() {
            return Err(format!("primitive {primitive} is missing in {leaf:?}"));
        }
    }
    Ok(())
}

/// Checks that every primitive is inside.
fn check_root(root: &Bounds, boxes: &[Bounds]) -> Result<(), String> {
    match boxes.iter().position(|b| !root.holds(b)) {
        Some(primitive) => Err(format!("primitive {primitive} sticks out of the root")),
        None => Ok(()),
    }
}
