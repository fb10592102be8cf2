//! The directions in which an eye looks.

use thiserror::Error;

use crate::geom::pencil::DIRECTION_LIMIT;

/// All directions strictly between two, counterclockwise from the first to the second; or all there
/// are. Exact: the two are integer vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cone {
    edges: Option<[[i64; 2]; 2]>,
}

/// Why two numbers make no [`Cone`].
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ConeError {
    /// Not a finite number.
    #[error("a direction is a number of degrees, not {0}")]
    Direction(f64),
    /// Not above 0 and at most 360.
    #[error("a field of view is above 0 and at most 360 degrees, not {0}")]
    Fov(f64),
    /// So narrow that its two edges become one.
    #[error("a field of view of {0} degrees is too narrow to tell its two edges apart")]
    Narrow(f64),
}

/// Length of the rounded edges.
const UNIT: f64 = (DIRECTION_LIMIT / 2) as f64;

impl Cone {
    /// All directions.
    pub const ALL: Cone = Cone { edges: None };

    /// The cone about `direction` (degrees counterclockwise from the x axis) that is `fov` degrees
    /// wide, 360 being all around. Its edges are rounded here, once, by less than 2^-39 of a radian;
    /// multiples of 90° are exact, as is a width of 180°.
    pub fn new(direction: f64, fov: f64) -> Result<Cone, ConeError> {
        if !direction.is_finite() {
            return Err(ConeError::Direction(direction));
        }
        if !(fov > 0.0 && fov <= 360.0) {
            return Err(ConeError::Fov(fov));
        }
        if fov == 360.0 {
            return Ok(Cone::ALL);
        }
        let low = unit(direction - fov / 2.0);
        let high = if fov == 180.0 {
            low.map(|c| -c)
        } else {
            unit(direction + fov / 2.0)
        };
        let turn = cross(low, high);
        // Rounding may make one edge of two, or, where they are that near, let them change places.
        let in_order = turn == 0 || (turn > 0) == (fov < 180.0);
        match Cone::between(low, high) {
            Some(cone) if in_order => Ok(cone),
            _ if fov > 180.0 => Ok(Cone::ALL),
            _ => Err(ConeError::Narrow(fov)),
        }
    }

    /// The directions strictly between two, counterclockwise from `low` to `high`; `None` where the
    /// two are the same, one is zero, or a coordinate is not below
    /// [`DIRECTION_LIMIT`](crate::geom::pencil::DIRECTION_LIMIT).
    pub fn between(low: [i64; 2], high: [i64; 2]) -> Option<Cone> {
        let sound = |d: [i64; 2]| {
            d != [0, 0]
                && d.iter()
                    .all(|c| (-DIRECTION_LIMIT + 1..DIRECTION_LIMIT).contains(c))
        };
        let dot = |i| i128::from(low[i]) * i128::from(high[i]);
        let same = || cross(low, high) == 0 && dot(0) + dot(1) > 0;
        (sound(low) && sound(high) && !same()).then_some(Cone {
            edges: Some([low, high]),
        })
    }

    /// Its first and last direction, counterclockwise; `None` for all around.
    pub fn edges(&self) -> Option<[[i64; 2]; 2]> {
        self.edges
    }
}

fn cross(p: [i64; 2], q: [i64; 2]) -> i128 {
    i128::from(p[0]) * i128::from(q[1]) - i128::from(p[1]) * i128::from(q[0])
}

/// The direction at an angle in degrees, as long as [`UNIT`].
fn unit(degrees: f64) -> [i64; 2] {
    let turned = degrees.rem_euclid(360.0);
    let quadrant = (turned / 90.0).floor();
    let (sin, cos) = (turned - 90.0 * quadrant).to_radians().sin_cos();
    let [x, y] = [cos, sin].map(|c| (c * UNIT).round() as i64);
    match quadrant as u8 % 4 {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_where_they_should_be() {
        let one = UNIT as i64;
        let edges = |direction, fov| Cone::new(direction, fov).unwrap().edges().unwrap();
        assert_eq!(edges(45.0, 90.0), [[one, 0], [0, one]]);
        assert_eq!(edges(-45.0, 90.0), [[0, -one], [one, 0]]);
        assert_eq!(edges(360.0, 180.0), [[0, -one], [0, one]]);
        assert_eq!(
            edges(180.0, 270.0),
            [edges(90.0, 90.0)[0], edges(-90.0, 90.0)[1]]
        );
        let [low, high] = edges(90.0, 60.0);
        assert_eq!([-low[0], low[1]], high);
        let [low, high] = edges(17.0, 180.0);
        assert_eq!(low.map(|c| -c), high);
    }

    #[test]
    fn what_is_no_cone() {
        assert_eq!(Cone::new(7.0, 360.0), Ok(Cone::ALL));
        assert_eq!(Cone::new(7.0, 360.0 - 1e-13), Ok(Cone::ALL));
        assert_eq!(Cone::new(7.0, 1e-13), Err(ConeError::Narrow(1e-13)));
        assert_eq!(Cone::new(7.0, 0.0), Err(ConeError::Fov(0.0)));
        assert!(Cone::new(7.0, f64::NAN).is_err() && Cone::new(f64::NAN, 60.0).is_err());
        assert_eq!(Cone::between([1, 2], [2, 4]), None);
        assert_eq!(Cone::between([0, 0], [2, 4]), None);
        assert_eq!(Cone::between([1, 0], [DIRECTION_LIMIT, 1]), None);
        assert!(Cone::between([1, 2], [-1, -2]).is_some());
    }
}
