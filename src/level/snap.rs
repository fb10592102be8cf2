//! The one door from f64 to the grid.
//!
//! In: a [`Draft`], in the numbers of its file. Out: a [`Level`] on the integer grid, with findings
//! for whatever could not be taken over exactly. Three things happen here, in this order, and
//! nothing later repairs anything:
//!
//! 1. The grid is chosen ([`choose_grid`]): coarse enough for the extent, fine enough to hold every
//!    written coordinate exactly where that is possible.
//! 2. Every point goes to its nearest grid point; points that were one before stay one; walls
//!    without length are dropped.
//! 3. What touched before is joined (`join`): a wall is split at the ends that lay on it, where
//!    rounding would have torn them off.
//!
//! A level that the grid holds exactly is not changed at all, and a level that is moved by whole
//! steps gets the same grid points.

mod join;

use std::collections::HashSet;

use glam::DVec2;

use crate::geom::{GRID_LIMIT, Grid, GridPoint, Step};

use super::draft::{Draft, DraftInterior, DraftWall, Numbers};
use super::finding::{Finding, Place, Severity};
use super::model::{Interior, Level, Wall};

/// Coordinates count at most this many steps from the zero of the file (2^52), so that a whole
/// number of steps, and the way back to units, is exact in f64.
const FAR_LIMIT: f64 = (1u64 << 52) as f64;

/// No coordinate may be this many units from zero or farther (2^53), whatever the step.
pub(super) const UNIT_LIMIT: f64 = (1u64 << 53) as f64;

/// A computed point that was moved by less than this part of a step is not called moved, and what
/// was nearer than this was one point, or lay on a wall, before.
const TOUCH: f64 = 0.01;

/// How near (in units) points of the draft are that were meant to coincide: a hundredth of a step,
/// and whatever f64 cannot tell apart as far from zero as the grid reaches (four units in the last
/// place, since such points are computed in a few operations).
pub(super) fn touch(grid: &Grid) -> f64 {
    let reach = grid.origin[0].abs().max(grid.origin[1].abs()) + GRID_LIMIT;
    grid.step.length() * (TOUCH + 4.0 * f64::EPSILON * reach as f64)
}

/// Why a draft cannot be put on a grid. Every variant but `Empty` names a place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SnapError {
    /// No wall (of more than zero length) is left.
    #[error("the level has no walls; add a room or a wall")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("{place}: the coordinate {value} is not a finite number")]
    NotFinite {
        /// Where it stands.
        place: Place,
        /// The number.
        value: f64,
    },
    /// A coordinate is 2^53 units or more from zero.
    #[error(
        "{place}: the coordinate {value} is too large; the limit is 9007199254740992 (2^53) units"
    )]
    TooLarge {
        /// Where it stands.
        place: Place,
        /// The number.
        value: f64,
    },
    /// The level lies so far from zero that f64 no longer tells its points apart.
    #[error(
        "{place}: the coordinate {value} lies so far from zero that steps of {step} units cannot \
         be told apart there; move the level nearer to zero"
    )]
    TooFar {
        /// Where the farthest coordinate stands.
        place: Place,
        /// The farthest coordinate.
        value: f64,
        /// The step that the level would have needed, in units.
        step: f64,
    },
    /// A start point lies beyond all walls, so that it cannot be inside.
    #[error("{place}: the start point lies outside of all walls; move it to the inside")]
    StartOutside {
        /// The start point.
        place: Place,
    },
}

impl SnapError {
    /// Where in the source the error is, where it is at one place.
    pub fn place(&self) -> Option<Place> {
        match self {
            SnapError::Empty => None,
            SnapError::NotFinite { place, .. }
            | SnapError::TooLarge { place, .. }
            | SnapError::TooFar { place, .. }
            | SnapError::StartOutside { place } => Some(*place),
        }
    }
}

/// A point that is to lie on the grid.
#[derive(Clone, Copy, Debug)]
pub struct RawPoint {
    /// The point, in the level's own coordinates.
    pub at: DVec2,
    /// As [`DraftWall::written`].
    pub written: bool,
    /// Where it stands in the source.
    pub place: Place,
}

/// Puts a draft on the grid; see the head of this module. Findings that this may add, after those
/// of the draft: `zero-length-wall`, `snapped`, `joined`.
///
/// # Errors
/// When there is no wall, or when a coordinate is not finite, 2^53 units or more from zero, or so
/// far from zero that the grid would be coarser than 10^-4 units (decimal numbers) or one unit
/// (binary ones) only because of the distance.
pub fn snap(draft: Draft) -> Result<Level, SnapError> {
    let mut findings = draft.findings;
    for wall in &draft.walls {
        for end in ends(wall) {
            check_size(&end)?;
        }
    }
    let (walls, mut dropped): (Vec<DraftWall>, Vec<DraftWall>) =
        draft.walls.into_iter().partition(|w| w.from != w.to);
    if walls.is_empty() {
        return Err(SnapError::Empty);
    }
    let points: Vec<RawPoint> = walls.iter().flat_map(ends).collect();
    let grid = choose_grid(draft.numbers, &points)?;
    let interior = snap_interior(draft.interior, &grid, &points)?;

    let snapped = join::SnappedPoints::new(&grid, &points);
    let (walls, collapsed): (Vec<DraftWall>, Vec<DraftWall>) = walls
        .into_iter()
        .partition(|w| snapped.grid_point(w.from) != snapped.grid_point(w.to));
    if walls.is_empty() {
        return Err(SnapError::Empty);
    }
    dropped.extend(collapsed);
    if !dropped.is_empty() {
        findings.push(Finding {
            code: "zero-length-wall",
            severity: Severity::Repaired,
            message: "A wall starts and ends in the same point and was dropped.".into(),
            places: distinct_places(dropped.iter().map(|w| w.place)),
        });
    }
    let error = largest_error(&grid, &snapped, &points, &mut findings);
    let walls = join::join(&grid, &snapped, walls, &mut findings);

    let vertices: HashSet<GridPoint> = walls.iter().flat_map(|w| [w.from, w.to]).collect();
    Ok(Level {
        name: draft.name,
        source: draft.source,
        unit: draft.unit,
        grid,
        snap: error,
        n_vertices: vertices.len(),
        walls,
        sectors: draft.sectors,
        outlines: draft.outlines,
        interior,
        scene: draft.scene,
        findings,
    })
}

/// The grid for a set of points; `points` must not be empty.
///
/// The step is a power of ten (`Decimal`) or of two (`Binary`) that holds every written coordinate
/// exactly, 10^-4 (or 1) where nothing finer is needed; a binary format whose coordinates only
/// decimals hold gets decimals. Where the extent allows no exact step it is the finest for which
/// all points lie within [`GRID_LIMIT`] of the origin. The origin is the middle of the extent, in
/// whole steps.
///
/// # Errors
/// As for [`snap`].
pub fn choose_grid(numbers: Numbers, points: &[RawPoint]) -> Result<Grid, SnapError> {
    points.iter().try_for_each(check_size)?;
    let extent = Extent::of(points);
    let chosen = choose_step(Family::Decimal, points, &extent);
    let step = match numbers {
        Numbers::Decimal => chosen?.0,
        Numbers::Binary => match (choose_step(Family::Binary, points, &extent), chosen) {
            (Ok((step, true)), _) | (_, Ok((step, true))) => step,
            (binary, _) => binary?.0,
        },
    };
    let middle = |low, high| (to_whole_steps(step, low) + to_whole_steps(step, high)).div_euclid(2);
    Ok(Grid {
        step,
        origin: [
            middle(extent.low.x, extent.high.x),
            middle(extent.low.y, extent.high.y),
        ],
    })
}

/// `units` in whole steps of the file's own coordinates. A number that is a whole number of steps
/// comes out as that number, although the product `units · 10^k` is rounded: the neighbours of
/// the nearest integer are tried against the way back. `units` must be below 2^52 steps.
pub(super) fn to_whole_steps(step: Step, units: f64) -> i64 {
    let nearest = step.to_steps(units).round();
    [0.0, 1.0, -1.0, 2.0, -2.0]
        .into_iter()
        .map(|d| nearest + d)
        .find(|&n| step.to_units(n) == units)
        .unwrap_or(nearest) as i64
}

/// The grid point of `p`, which must be within the extent that the grid was chosen for.
pub(super) fn to_grid(grid: &Grid, p: DVec2) -> GridPoint {
    GridPoint::new(
        to_whole_steps(grid.step, p.x) - grid.origin[0],
        to_whole_steps(grid.step, p.y) - grid.origin[1],
    )
}

fn ends(wall: &DraftWall) -> [RawPoint; 2] {
    [(wall.from, 0), (wall.to, 1)].map(|(at, i)| RawPoint {
        at,
        written: wall.written[i],
        place: wall.place,
    })
}

fn check_size(point: &RawPoint) -> Result<(), SnapError> {
    let place = point.place;
    for value in point.at.to_array() {
        if !value.is_finite() {
            return Err(SnapError::NotFinite { place, value });
        }
        if value.abs() >= UNIT_LIMIT {
            return Err(SnapError::TooLarge { place, value });
        }
    }
    Ok(())
}

/// Bounding box of all points, and the coordinate farthest from zero.
struct Extent {
    low: DVec2,
    high: DVec2,
    farthest: f64,
    farthest_place: Place,
}

impl Extent {
    fn of(points: &[RawPoint]) -> Extent {
        let mut extent = Extent {
            low: points[0].at,
            high: points[0].at,
            farthest: 0.0,
            farthest_place: points[0].place,
        };
        for point in points {
            extent.low = extent.low.min(point.at);
            extent.high = extent.high.max(point.at);
            for value in point.at.to_array() {
                if value.abs() > extent.farthest.abs() {
                    extent.farthest = value;
                    extent.farthest_place = point.place;
                }
            }
        }
        extent
    }

    /// Whether whole numbers of these steps are exact in f64 all over the extent.
    fn is_near(&self, step: Step) -> bool {
        step.to_steps(self.farthest.abs()) < FAR_LIMIT
    }

    /// Whether the extent is below 2^26 steps in both directions.
    fn fits(&self, step: Step) -> bool {
        let widest = 2 * (GRID_LIMIT - 1);
        self.is_near(step)
            && to_whole_steps(step, self.high.x) - to_whole_steps(step, self.low.x) <= widest
            && to_whole_steps(step, self.high.y) - to_whole_steps(step, self.low.y) <= widest
    }
}

#[derive(Clone, Copy)]
enum Family {
    Decimal,
    Binary,
}

impl Family {
    fn step(self, k: i32) -> Step {
        match self {
            Family::Decimal => Step::Decimal(k),
            Family::Binary => Step::Binary(k),
        }
    }

    /// The exponents tried, finest last. [`Step::to_units`] is correctly rounded for all of them,
    /// and the coarsest fits every extent below [`UNIT_LIMIT`].
    fn exponents(self) -> std::ops::RangeInclusive<i32> {
        match self {
            Family::Decimal => -10..=22,
            Family::Binary => -30..=60,
        }
    }

    /// The exponent that is taken where nothing asks for another one.
    fn usual(self) -> i32 {
        match self {
            Family::Decimal => 4,
            Family::Binary => 0,
        }
    }

    /// The least `k` for which `x` is a whole multiple of the step; `None` for zero.
    fn needed(self, x: f64) -> Option<i32> {
        if x == 0.0 {
            return None;
        }
        match self {
            Family::Decimal => {
                // The shortest decimal that reads back as this f64: "1.25e-1".
                let text = format!("{:e}", x.abs());
                let (mantissa, exponent) = text.split_once('e')?;
                let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len() as i32);
                Some(decimals - exponent.parse::<i32>().ok()?)
            }
            Family::Binary => {
                let bits = x.abs().to_bits();
                let (exponent, fraction) = (bits >> 52, bits & ((1 << 52) - 1));
                let mantissa = if exponent == 0 {
                    fraction
                } else {
                    fraction | (1 << 52)
                };
                // x = mantissa · 2^(max(exponent, 1) - 1075)
                Some(1075 - exponent.max(1) as i32 - mantissa.trailing_zeros() as i32)
            }
        }
    }
}

/// The step out of one family, and whether it holds every written coordinate exactly.
fn choose_step(
    family: Family,
    points: &[RawPoint],
    extent: &Extent,
) -> Result<(Step, bool), SnapError> {
    let needed = points
        .iter()
        .filter(|p| p.written)
        .flat_map(|p| p.at.to_array())
        .filter_map(|x| family.needed(x))
        .max()
        .unwrap_or(i32::MIN);
    let finest = family
        .exponents()
        .rev()
        .find(|&k| extent.fits(family.step(k)))
        .unwrap_or(*family.exponents().start());
    if needed <= finest {
        return Ok((family.step(needed.max(family.usual().min(finest))), true));
    }
    // Not exact. That is tolerable where the extent forces it, but where the distance from zero
    // does, f64 has lost the level's details before we ever saw them.
    let next = family.step(finest + 1);
    if finest < family.usual() && !extent.is_near(next) {
        return Err(SnapError::TooFar {
            place: extent.farthest_place,
            value: extent.farthest,
            step: family.step(needed.min(family.usual())).length(),
        });
    }
    Ok((family.step(finest), false))
}

fn snap_interior(
    interior: DraftInterior,
    grid: &Grid,
    points: &[RawPoint],
) -> Result<Interior, SnapError> {
    let starts = match interior {
        DraftInterior::Sides => return Ok(Interior::Sides),
        DraftInterior::Outlines => return Ok(Interior::Outlines),
        DraftInterior::Enclosed { starts } => starts,
    };
    let extent = Extent::of(points);
    let starts = starts.into_iter().map(|p| {
        let inside = p.cmpgt(extent.low).all() && p.cmplt(extent.high).all();
        let place = Place::Point { x: p.x, y: p.y };
        // A comparison with NaN is false, so no such point passes.
        inside
            .then(|| to_grid(grid, p))
            .ok_or(SnapError::StartOutside { place })
    });
    Ok(Interior::Enclosed {
        starts: starts.collect::<Result<_, _>>()?,
    })
}

/// The largest distance by which a point was moved, in units; reports the points that were.
/// A computed point counts as moved only beyond [`TOUCH`]: nobody wrote its last digits.
fn largest_error(
    grid: &Grid,
    snapped: &join::SnappedPoints,
    points: &[RawPoint],
    findings: &mut Vec<Finding>,
) -> f64 {
    let mut largest = 0.0f64;
    let mut moved = [Vec::new(), Vec::new()];
    for point in points {
        let error = (grid.to_level(snapped.grid_point(point.at)) - point.at).length();
        if error > 0.0 && (point.written || error > TOUCH * grid.step.length()) {
            largest = largest.max(error);
            moved[usize::from(point.written)].push(point.place);
        }
    }
    let [computed, written] = moved;
    let (severity, what, places) = if !written.is_empty() {
        (Severity::Repaired, "A coordinate", written)
    } else {
        (Severity::Note, "A computed point", computed)
    };
    if largest > 0.0 {
        findings.push(Finding {
            code: "snapped",
            severity,
            message: format!(
                "{what} is no whole number of grid steps ({}) and was moved to the nearest, \
                 by at most {largest:.1e}.",
                grid.step.length()
            ),
            places: distinct_places(places.into_iter()),
        });
    }
    largest
}

/// Places in their order, each once where it repeats in a row.
fn distinct_places(places: impl Iterator<Item = Place>) -> Vec<Place> {
    let mut places: Vec<Place> = places.collect();
    places.dedup();
    places
}

/// A finished wall with the attributes of `wall`.
fn finished(wall: &DraftWall, from: GridPoint, to: GridPoint) -> Wall {
    Wall {
        from,
        to,
        kind: wall.kind.clone(),
        left: wall.left,
        right: wall.right,
        outline: wall.outline,
        material: wall.material,
        place: wall.place,
    }
}

#[cfg(test)]
mod tests;
