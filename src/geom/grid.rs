//! The integer grid on which every coordinate of a level lies.
//!
//! In: the level's own numbers (f64, as read from a file). Out: [`GridPoint`]s, and back again.
//! This is the only door between floating point and the exact part of the program.

use glam::DVec2;

use super::vertex::Vertex;

/// Grid coordinates `x` satisfy `|x| < GRID_LIMIT` (2^25 steps): what the widths of the integers in
/// [`super::predicate`] are proved for.
pub const GRID_LIMIT: i64 = 1 << 25;

/// Points that lie on no grid point are put on one of so many parts of a step (see [`Grid::fine`]).
pub const FINE: i64 = 1 << 20;

/// A point of the grid, in steps from the grid's origin; `x` right, `y` up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct GridPoint {
    /// Steps to the right of the origin, `|x| < GRID_LIMIT`.
    pub x: i64,
    /// Steps above the origin, `|y| < GRID_LIMIT`.
    pub y: i64,
}

impl GridPoint {
    /// The point `(x, y)`, in steps.
    pub const fn new(x: i64, y: i64) -> Self {
        Self { x, y }
    }
}

/// The length of one grid step, in the level's unit, kept so that grid points turn into the very
/// decimals (or binary fractions) that were read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// 10^-k units; `k` may be negative for levels larger than 2^25 units.
    Decimal(i32),
    /// 2^-k units; `k` may be negative.
    Binary(i32),
}

impl Step {
    /// The step's length in the level's unit.
    pub fn length(self) -> f64 {
        match self {
            Step::Decimal(k) => 10f64.powi(-k),
            Step::Binary(k) => 2f64.powi(-k),
        }
    }

    /// `steps` as a number of units, correctly rounded for every step of at most 22 decimals.
    pub fn to_units(self, steps: f64) -> f64 {
        match self {
            // 10^k is exact in f64 up to k = 22, so one rounding happens, that of the division.
            Step::Decimal(k) if k >= 0 => steps / 10f64.powi(k),
            Step::Decimal(k) => steps * 10f64.powi(-k),
            Step::Binary(k) => steps * 2f64.powi(-k),
        }
    }

    /// `units` as a number of steps, not yet rounded to a whole one.
    pub fn to_steps(self, units: f64) -> f64 {
        match self {
            Step::Decimal(k) if k >= 0 => units * 10f64.powi(k),
            Step::Decimal(k) => units / 10f64.powi(-k),
            Step::Binary(k) => units * 2f64.powi(k),
        }
    }
}

/// Where the grid lies in the level's own coordinates: `units = (origin + point) · step`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Length of one step.
    pub step: Step,
    /// The grid's origin, in whole steps of the level's own coordinates (subtracted from every
    /// coordinate, so that a level far away gives the same result as one at the origin).
    pub origin: [i64; 2],
}

impl Grid {
    /// A grid point in the level's own coordinates.
    pub fn to_level(&self, p: GridPoint) -> DVec2 {
        self.offset_to_level(p.x as f64, p.y as f64)
    }

    /// A place given in (fractional) steps from the grid's origin, in the level's own coordinates.
    pub fn offset_to_level(&self, x: f64, y: f64) -> DVec2 {
        DVec2::new(
            self.step.to_units(self.origin[0] as f64 + x),
            self.step.to_units(self.origin[1] as f64 + y),
        )
    }

    /// The grid point nearest to `p` (level coordinates), or `None` where that is off the grid.
    pub fn nearest(&self, p: DVec2) -> Option<GridPoint> {
        let x = self.step.to_steps(p.x).round() - self.origin[0] as f64;
        let y = self.step.to_steps(p.y).round() - self.origin[1] as f64;
        let limit = GRID_LIMIT as f64;
        (x.abs() < limit && y.abs() < limit).then(|| GridPoint::new(x as i64, y as i64))
    }

    /// The point nearest to `p` (level coordinates) among those with coordinates in whole
    /// [`FINE`]ths of a step; `None` where that is off the grid. A coordinate which a grid point
    /// has, too, is that grid point's, however far from the origin it is.
    pub fn fine(&self, p: DVec2) -> Option<Vertex> {
        let whole = self.nearest(p)?;
        let back = self.to_level(whole);
        let parts = |units: f64, back: f64, whole: i64, origin: i64| {
            if units == back {
                return whole * FINE;
            }
            let steps = self.step.to_steps(units) - origin as f64;
            (steps * FINE as f64).round() as i64
        };
        let x = parts(p.x, back.x, whole.x, self.origin[0]);
        let y = parts(p.y, back.y, whole.y, self.origin[1]);
        Vertex::homogeneous(x.into(), y.into(), FINE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_come_back_as_written() {
        let grid = Grid {
            step: Step::Decimal(4),
            origin: [10_000_000, 0],
        };
        for text in ["1000.1", "1000.3", "1002.7183", "999.9999"] {
            let x: f64 = text.parse().unwrap();
            let p = grid.nearest(DVec2::new(x, 0.0)).unwrap();
            assert_eq!(grid.to_level(p).x, x, "{text}");
        }
    }

    #[test]
    fn fine_points_are_near_and_written_ones_exact() {
        let grid = Grid {
            step: Step::Decimal(4),
            origin: [10_000_000_000, 0],
        };
        // A thousand kilometres away f64 no longer tells a 2^20th of a step.
        let p = grid.fine(DVec2::new(1_000_000.100_3, 1.25)).unwrap();
        assert_eq!(p, GridPoint::new(1003, 12_500).into());
        let p = grid.fine(DVec2::new(1_000_000.0, 0.12345)).unwrap();
        assert_eq!((p.x(), p.w(), p.y()), (0, 2, 2469)); // 1234.5 steps
        assert_eq!(grid.fine(DVec2::new(0.0, 0.0)), None);
        assert_eq!(grid.fine(DVec2::new(f64::NAN, 0.0)), None);
    }

    #[test]
    fn off_the_grid_is_none() {
        let grid = Grid {
            step: Step::Binary(0),
            origin: [0, 0],
        };
        assert!(grid.nearest(DVec2::new(33_554_431.0, 0.0)).is_some());
        assert!(grid.nearest(DVec2::new(33_554_432.0, 0.0)).is_none());
        assert!(grid.nearest(DVec2::new(f64::NAN, 0.0)).is_none());
    }
}
