//! The finished model of a level: what every reader ends in and every later stage starts from.
//!
//! Plan coordinates are grid points (x right, y up); heights are f64 in the level's own unit, z up.
//! A wall runs from `from` to `to`; its *left* side is the one on the left hand of somebody walking
//! that way. (A Doom linedef's front side is its right side.)

use crate::geom::{Grid, GridPoint};

use super::finding::{Finding, Place};
use super::scene::{MaterialId, Scene};

/// Index into [`Level::sectors`]; for formats that number their sectors, that number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SectorId(pub u32);

/// Index into [`Level::walls`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WallId(pub u32);

/// Index into [`Level::outlines`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct OutlineId(pub u32);

/// A level: walls on the integer grid, the sectors between them, and what stands in it.
#[derive(Clone, Debug)]
pub struct Level {
    /// Name for people: the map's name, or the `name` key, or the file's stem.
    pub name: String,
    /// File name the level came from, without its folder.
    pub source: String,
    /// Name of the unit of length ("m", "map unit").
    pub unit: String,
    /// The grid of all plan coordinates.
    pub grid: Grid,
    /// Largest distance by which a point was moved onto the grid, in the level's unit.
    pub snap: f64,
    /// Number of distinct points that walls start or end in.
    pub n_vertices: usize,
    /// All walls, edges and openings, in file order (in a TOML level: room by room, then pillars,
    /// zones, free-standing walls, openings). None has zero length.
    pub walls: Vec<Wall>,
    /// Sectors: places with one floor and ceiling (a Doom sector; a room or zone of a TOML level).
    pub sectors: Vec<Sector>,
    /// Closed outlines of areas, in file order; used when `interior` is [`Interior::Outlines`].
    pub outlines: Vec<Outline>,
    /// How the inside of the level is told from the outside.
    pub interior: Interior,
    /// Materials, lights, objects, cameras, paths.
    pub scene: Scene,
    /// What the reader repaired or wondered about, in a fixed order.
    pub findings: Vec<Finding>,
}

/// A straight piece of wall, sector boundary or opening on the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Start point.
    pub from: GridPoint,
    /// End point; differs from `from`.
    pub to: GridPoint,
    /// What it does to sight.
    pub kind: WallKind,
    /// Sector that the source names on the left side (walking from `from` to `to`).
    pub left: Option<SectorId>,
    /// Sector that the source names on the right side.
    pub right: Option<SectorId>,
    /// The outline that this wall is an edge of: crossing the wall enters or leaves that outline.
    pub outline: Option<OutlineId>,
    /// Its surface, if the source names one.
    pub material: Option<MaterialId>,
    /// Where it stands in the source.
    pub place: Place,
}

/// What a wall does to sight.
#[derive(Clone, Debug, PartialEq)]
pub enum WallKind {
    /// Opaque over its whole length, whatever else lies on the same line.
    Solid,
    /// Edge of an area's outline, or a wall standing free inside one (then [`Wall::outline`] is
    /// `None`): opaque, except where an [`WallKind::Opening`] lies on it.
    Outline,
    /// See-through: a change of sector without a wall (a Doom two-sided line, the edge of a zone).
    /// `shut` says that it bounds a sector that is closed at rest and moves (a Doom door): a wall
    /// while doors count as closed.
    Edge {
        /// Whether a closed door stands here.
        shut: bool,
    },
    /// A hole cut into outlines that it lies on.
    Opening(Opening),
}

/// A hole in a wall. See-through unless it is `shut` and doors count as closed.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// What people call it.
    pub style: OpeningStyle,
    /// Name, for reports.
    pub name: Option<String>,
    /// Whether its leaf stands closed: a wall while doors count as closed.
    pub shut: bool,
    /// Lower end in z; `None`: the higher of the two floors.
    pub bottom: Option<f64>,
    /// Upper end in z; `None`: the lower of the two ceilings.
    pub top: Option<f64>,
}

/// Kinds of openings. All are see-through when open; they differ in their defaults and for walkers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpeningStyle {
    /// Has a leaf and reaches the floor.
    Door,
    /// Has a sill; nobody walks through.
    Window,
    /// No leaf; always open.
    Archway,
}

/// A place with one floor and one ceiling.
#[derive(Clone, Debug, PartialEq)]
pub struct Sector {
    /// Name for people (a room's name); `None` where the source only numbers its sectors.
    pub name: Option<String>,
    /// Floor.
    pub floor: Height,
    /// Ceiling.
    pub ceiling: Height,
    /// Brightness 0 to 1 where the source has one (Doom light level / 255).
    pub light: Option<f64>,
    /// Floor texture or material name, if any.
    pub floor_material: Option<String>,
    /// Ceiling texture or material name, if any.
    pub ceiling_material: Option<String>,
    /// Where it stands in the source.
    pub place: Place,
}

/// A height with the range through which it can move; `low <= rest <= high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// As the level starts.
    pub rest: f64,
    /// Lowest that it ever reaches.
    pub low: f64,
    /// Highest that it ever reaches.
    pub high: f64,
}

impl Height {
    /// A height that never moves.
    pub const fn fixed(z: f64) -> Self {
        Self {
            rest: z,
            low: z,
            high: z,
        }
    }

    /// Whether it can move.
    pub fn moves(&self) -> bool {
        self.low < self.high
    }
}

/// A closed outline whose inside belongs to a sector, or to none. Its edges are the walls that carry
/// its id, whatever their kind; inside is where a ray to infinity crosses them an odd number of
/// times.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The sector inside; `None`: a void (the inside of a pillar), which is outside the level even
    /// where outlines before it enclose a room.
    pub sector: Option<SectorId>,
    /// Whether this only changes heights within rooms (a zone): it does not make an outside place
    /// an inside one.
    pub zone: bool,
}

/// How the inside of a level is told from the outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Interior {
    /// Walls name the sector on each side (Doom). A face that no wall names is outside.
    Sides,
    /// [`Level::outlines`] enclose the rooms. Where several do, the last one that is no zone
    /// decides between inside and outside (a void), and the last one of all gives the sector.
    Outlines,
    /// Whatever is enclosed by walls; with start points, only what can be reached from one. Inside
    /// a void outline is outside. The first sector, if there is one, gives floor and ceiling
    /// where no zone does.
    Enclosed {
        /// Points in the inside; may be empty.
        starts: Vec<GridPoint>,
    },
}
