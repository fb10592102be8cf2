//! Checks a finished PVS against its level, independently: none of the code that computed it is
//! used, neither the arrangement of the walls nor the subdivision nor any method of visibility.
//!
//! In: a decoded [`PvsFile`] and the [`Level`]. Out: [`Verified`], which counts what was checked,
//! or the first [`Failure`], with the place. Everything is decided exactly; what is random is only
//! where to look, and that is seeded, so the same call always says the same.
//!
//! 1. The relation is symmetric and reflexive. Where it claims to hold nothing too much, no pair is
//!    listed that portals do not connect.
//! 2. Every cell is convex and counterclockwise, portals pair up, no wall passes through a cell or
//!    lies on a portal, and what is no portal lies on an opaque wall or faces the outside (`cells`).
//! 3. Random points lie in exactly one cell where the level's own walls (by rays, or by the parity
//!    of outlines) say inside, and in none where they say outside (`ground`).
//! 4. Cells along random free segments, many of them just past the ends of walls, see each other
//!    in pairs (`sight`). A segment that touches an opaque wall in even a point is not free. With
//!    heights, the segments are in space, many of them just past sills, lintels and steps, and must
//!    also keep between the floors and ceilings of the level's sectors and within the heights of its
//!    openings (`space`).
//!
//! A file is held to what its class promises. A pair that is met but not listed is a failure in one
//! that claims to miss nothing (exact, conservative); in the others (aggressive, approximate) such
//! pairs are counted.

mod caster;
mod cells;
mod ground;
mod pair;
mod sight;
mod space;
mod walls;

#[cfg(test)]
mod tests;

use std::fmt;

use glam::DVec3;

pub use caster::{Caster, Place};

use super::file::{LevelInfo, PvsFile};
use super::{Class, Progress};
use crate::cells::{CellId, EdgeId};
use crate::geom::GridPoint;
use crate::level::{Level, WallId};

/// How much is tried, and with which seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VerifyOptions {
    /// Random segments.
    pub segments: u64,
    /// Random points.
    pub points: u64,
    /// Seed of both.
    pub seed: u64,
}

impl Default for VerifyOptions {
    fn default() -> Self {
        Self {
            segments: 1_000_000,
            points: 100_000,
            seed: 1,
        }
    }
}

/// What was checked without finding a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verified {
    /// Visible pairs whose opposite is visible too.
    pub pairs: u64,
    /// Cells: convex, counterclockwise, without a wall inside.
    pub cells: usize,
    /// Portals: both sides fit, no opaque wall on them.
    pub portals: usize,
    /// Edges that lie on opaque walls.
    pub walls: usize,
    /// Edges that face the outside without an opaque wall.
    pub outer: usize,
    /// Random points that lie in exactly one cell, and inside by the walls.
    pub inside: u64,
    /// Random points that lie in no cell, and outside by the walls.
    pub outside: u64,
    /// Random points about which the level's walls contradict each other, or say nothing.
    pub contested: u64,
    /// Whether the segments are in space.
    pub heights: bool,
    /// Segments that touch no opaque wall; in space, that pass from some cell to another.
    pub free: u64,
    /// Segments that do not, or pass exactly through a corner of cells: not used.
    pub discarded: u64,
    /// Pairs of cells met along free segments (with repetition).
    pub met: u64,
    /// Those of them that are not listed as visible. 0 where the class promises to miss nothing.
    pub missed: u64,
    /// What the file promises.
    pub class: Class,
}

/// The first fault found. Points on the plan are in grid steps; [`Failure::describe`] says them in the
/// level's own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// The file was made from another level, or this one has been changed since.
    OtherLevel,
    /// A cell does not see itself.
    NotReflexive(CellId),
    /// The first cell sees the second, but not the other way round.
    NotSymmetric(CellId, CellId),
    /// Two cells are listed as visible, though no walk through portals joins them.
    Parted(CellId, CellId),
    /// A cell is not a convex polygon walked counterclockwise.
    NotConvex(CellId),
    /// An edge and its twin do not run between the same two vertices.
    Unpaired(EdgeId),
    /// A wall of the level passes through a cell.
    WallInside(WallId, CellId),
    /// An opaque wall lies on a portal.
    WallOnPortal(WallId, EdgeId),
    /// An edge is no portal, but no wall of the level lies along all of it, or only one that does
    /// not stop sight, with the level's inside on both sides.
    NoWall(EdgeId),
    /// A point of the inside lies in no cell.
    Lost(GridPoint),
    /// A point of the outside lies in a cell.
    Outside(GridPoint, CellId),
    /// A point lies in two cells.
    Twice(GridPoint, CellId, CellId),
    /// A point's cell has another sector than the walls around the point name.
    Sector(GridPoint, CellId),
    /// Two cells are joined by a free segment, but not listed as visible.
    Missed {
        /// One cell.
        a: CellId,
        /// The other.
        b: CellId,
        /// Start of the segment that joins them.
        from: GridPoint,
        /// Its end.
        to: GridPoint,
    },
    /// Two cells are joined by a free segment in space, but not listed as visible.
    MissedInSpace {
        /// One cell.
        a: CellId,
        /// The other.
        b: CellId,
        /// Where the segment leaves the first, in the level's own coordinates.
        from: DVec3,
        /// Where it enters the second.
        to: DVec3,
    },
    /// A free segment leaves the cells where they should end at an opaque wall.
    Escape {
        /// The edge through which it leaves.
        edge: EdgeId,
        /// Start of the segment.
        from: GridPoint,
        /// Its end.
        to: GridPoint,
    },
}

/// Checks a file against its level. `progress` counts points and segments.
///
/// # Errors
/// The first [`Failure`]; which one that is does not depend on the number of threads.
pub fn verify(
    file: &PvsFile,
    level: &Level,
    options: &VerifyOptions,
    progress: &Progress,
) -> Result<Verified, Failure> {
    let own = LevelInfo::of(level);
    let same = (own.fingerprint, own.walls, own.sectors)
        == (file.info.fingerprint, file.info.walls, file.info.sectors)
        && level.grid == file.graph.grid;
    if !same {
        return Err(Failure::OtherLevel);
    }
    let mut done = Verified {
        cells: file.graph.cells.len(),
        class: file.pvs.class,
        heights: file.pvs.heights,
        ..Verified::default()
    };
    done.pairs = relation(file)?;
    let walls = walls::Walls::new(level, file.graph.options.doors);
    let outer = cells::check(file, &walls, &mut done)?;
    if file.pvs.class.is_sound() {
        connected(file)?;
    }
    progress.begin((options.points + options.segments) as usize);
    ground::check(file, level, &walls, &outer, options, &mut done)?;
    progress.advance(options.points as usize);
    if file.pvs.heights {
        space::check(file, level, &walls, &outer, options, progress, &mut done)?;
    } else {
        sight::check(file, &walls, &outer, options, progress, &mut done)?;
    }
    Ok(done)
}

fn relation(file: &PvsFile) -> Result<u64, Failure> {
    let mut pairs = 0;
    for a in file.graph.cell_ids() {
        if !file.pvs.sees(a, a) {
            return Err(Failure::NotReflexive(a));
        }
        for b in file.pvs.seen_from(a) {
            if !file.pvs.sees(b, a) {
                return Err(Failure::NotSymmetric(a, b));
            }
            pairs += 1;
        }
    }
    Ok(pairs)
}

/// Whether a walk through portals joins the cells of every listed pair.
fn connected(file: &PvsFile) -> Result<(), Failure> {
    let graph = &file.graph;
    // Joined cells point towards one of them, that points to itself.
    let mut towards: Vec<usize> = (0..graph.cells.len()).collect();
    fn end(towards: &mut [usize], mut cell: usize) -> usize {
        while towards[cell] != cell {
            towards[cell] = towards[towards[cell]];
            cell = towards[cell];
        }
        cell
    }
    for edge in &graph.edges {
        if let Some(twin) = edge.twin() {
            let [a, b] = [edge.cell, graph.edge(twin).cell];
            let [a, b] = [a, b].map(|c| end(&mut towards, c.0 as usize));
            towards[a] = b;
        }
    }
    let place: Vec<usize> = (0..graph.cells.len())
        .map(|cell| end(&mut towards, cell))
        .collect();
    for a in graph.cell_ids() {
        let other = |b: &CellId| place[a.0 as usize] != place[b.0 as usize];
        if let Some(b) = file.pvs.seen_from(a).find(other) {
            return Err(Failure::Parted(a, b));
        }
    }
    Ok(())
}

impl Failure {
    /// The failure in words, with places in the level's own coordinates.
    pub fn describe(&self, file: &PvsFile, level: &Level) -> String {
        let graph = &file.graph;
        let point = |p: GridPoint| {
            let p = graph.grid.to_level(p);
            format!("({}, {})", p.x, p.y)
        };
        let vertex = |v| {
            let p = graph.vertices.exact(v).to_level(&graph.grid);
            format!("({}, {})", p.x, p.y)
        };
        let edge = |e: EdgeId| {
            let (from, to) = (vertex(graph.edge(e).origin), vertex(graph.end(e)));
            format!(
                "edge {} of cell {}, from {from} to {to},",
                e.0,
                graph.edge(e).cell.0
            )
        };
        let wall = |w: WallId| format!("wall {} ({})", w.0, level.walls[w.0 as usize].place);
        match *self {
            Failure::OtherLevel => format!(
                "the file is not of this level as it is now: it was made from '{}' ({}) with {} \
                 walls; this is '{}' ({}) with {}",
                file.info.name,
                file.info.source,
                file.info.walls,
                level.name,
                level.source,
                level.walls.len()
            ),
            Failure::NotReflexive(a) => format!("cell {} does not see itself", a.0),
            Failure::NotSymmetric(a, b) => {
                format!(
                    "cell {} sees cell {}, but not the other way round",
                    a.0, b.0
                )
            }
            Failure::Parted(a, b) => format!(
                "cells {} and {} are listed as visible, but no way through portals leads from the \
                 one to the other",
                a.0, b.0
            ),
            Failure::NotConvex(a) => {
                let corners: Vec<String> = graph.corners(a).map(vertex).collect();
                format!("cell {} is no convex polygon: {}", a.0, corners.join(" "))
            }
            Failure::Unpaired(e) => format!("{} does not match its twin", edge(e)),
            Failure::WallInside(w, a) => format!("{} passes through cell {}", wall(w), a.0),
            Failure::WallOnPortal(w, e) => format!("{} lies on a portal: {}", wall(w), edge(e)),
            Failure::NoWall(e) => {
                format!("{} is no portal, but nothing there stops sight", edge(e))
            }
            Failure::Lost(p) => format!("{} is inside the level, but in no cell", point(p)),
            Failure::Outside(p, a) => {
                format!("{} is outside the level, but in cell {}", point(p), a.0)
            }
            Failure::Twice(p, a, b) => {
                format!("{} is in cell {} and also in cell {}", point(p), a.0, b.0)
            }
            Failure::Sector(p, a) => format!(
                "{} is in cell {} of sector {}, but the walls around it name another",
                point(p),
                a.0,
                graph
                    .cell(a)
                    .sector
                    .map_or("none".to_string(), |s| s.0.to_string())
            ),
            Failure::Missed { a, b, from, to } => format!(
                "cells {} and {} are not listed as visible, but the free segment from {} to {} \
                 passes through both, and the file's class, {}, promises to miss nothing",
                a.0,
                b.0,
                point(from),
                point(to),
                file.pvs.class.as_str()
            ),
            Failure::MissedInSpace { a, b, from, to } => format!(
                "cells {} and {} are not listed as visible, but the straight line that leaves the \
                 one at {from} and enters the other at {to} is free",
                a.0, b.0
            ),
            Failure::Escape { edge: e, from, to } => format!(
                "the free segment from {} to {} leaves the cells through {} where sight should \
                 end",
                point(from),
                point(to),
                edge(e)
            ),
        }
    }
}

impl fmt::Display for Verified {
    /// A line for each kind of check.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "relation    {} visible pairs, symmetric and reflexive",
            self.pairs
        )?;
        writeln!(
            f,
            "cells       {} convex, no wall passes through any",
            self.cells
        )?;
        writeln!(
            f,
            "portals     {} fit on both sides, none has an opaque wall on it",
            self.portals
        )?;
        writeln!(
            f,
            "borders     {} on opaque walls, {} towards the outside",
            self.walls, self.outer
        )?;
        writeln!(
            f,
            "points      {} inside in one cell each, {} outside in none, {} where the \
             level's walls do not say",
            self.inside, self.outside, self.contested
        )?;
        let listed = match self.missed {
            0 => "every one listed".to_string(),
            missed => format!(
                "{missed} not listed, as its class, {}, allows",
                self.class.as_str()
            ),
        };
        writeln!(
            f,
            "segments    {} free ones{} met {} pairs of cells, {listed} ({} others discarded)",
            self.free,
            if self.heights { " in space" } else { "" },
            self.met,
            self.discarded
        )
    }
}
