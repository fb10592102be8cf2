//! Where the eye is, and where it looks, at each moment of a walk.
//!
//! In: a path of a level file, or the points of a tour. Out: a [`Track`], which gives a [`Pose`] for
//! every second. The way is a line of short straight parts, measured once: equal times are equal
//! lengths along it, exactly; two poses a moment apart are as far from each other as the speed says,
//! but for what the bend between them cuts off.

use glam::{DVec2, DVec3};

use super::curve;
use super::heading::{self, Manner};
use super::rise::{self, Ground};
use crate::level::scene::{CameraPath, PathLook, PathPace};

/// An eye and the way it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where it is.
    pub eye: DVec3,
    /// Unit vector.
    pub direction: DVec3,
}

/// How a walker moves his head, and how far he rounds corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackOptions {
    /// Most degrees that the view turns in a second when it looks ahead, positive. (At a point it
    /// looks always.)
    pub turn: f64,
    /// Seconds over which the way is averaged for looking ahead, three quarters of it before the
    /// walker.
    pub ahead: f64,
    /// Share of a slope that the view follows: 0 looks level, 1 along the way.
    pub nod: f64,
    /// How far the curve may stray from the straight ways between a path's points, in seconds of
    /// walking.
    pub stray: f64,
}

impl Default for TrackOptions {
    fn default() -> Self {
        Self {
            turn: 100.0,
            ahead: 1.2,
            nod: 0.5,
            stray: 0.15,
        }
    }
}

/// Moments per second at which the view is known; between them it is interpolated.
const MOMENTS: f64 = 60.0;
/// Most moments of a walk, and fewest.
const MOST: f64 = 1e6;
const FEWEST: f64 = 16.0;

/// A walk.
#[derive(Clone, Debug)]
pub struct Track {
    /// The way, no two points in a row equal; at least one.
    points: Vec<DVec3>,
    /// Length of the way up to each point.
    lengths: Vec<f64>,
    seconds: f64,
    look: PathLook,
    /// Directions ahead at equal times, from the start to the end.
    views: Vec<DVec3>,
    closed: bool,
}

impl Track {
    /// The walk along a path of a level file. `ground` is asked for floors, of a path that gives the
    /// eye's height over the floor; where there is none, it goes on as it was.
    pub fn new(path: &CameraPath, ground: &Ground, options: &TrackOptions) -> Self {
        let n = path.points.len();
        let ways = if path.closed { n } else { n.saturating_sub(1) };
        let length = |i: usize| path.points[i].distance(path.points[(i + 1) % n]);
        let length: f64 = (0..ways).map(length).sum();
        let speed = match path.pace {
            PathPace::Speed(speed) => speed,
            PathPace::Seconds(seconds) => length / seconds,
        };
        let mut points = path.points.clone();
        if length > 0.0 {
            let (stray, fine) = (options.stray * speed, speed / MOMENTS);
            points = curve::through(&points, path.closed, stray, fine);
        }
        if let Some(eye) = path.eye {
            let plan: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
            // A stair is taken within half a step, which is a third of a second.
            points = rise::over(ground, &plan, path.closed, eye, speed / 3.0);
        }
        let measured = Measured::of(points);
        let seconds = match path.pace {
            PathPace::Seconds(seconds) => seconds,
            PathPace::Speed(speed) => measured.length() / speed,
        };
        Self::of(measured, path.closed, path.look, seconds, options)
    }

    /// The walk along a line of points, looking ahead, at a speed (positive).
    pub fn along(points: Vec<DVec3>, speed: f64, options: &TrackOptions) -> Self {
        let measured = Measured::of(points);
        let seconds = measured.length() / speed;
        Self::of(measured, false, PathLook::Ahead, seconds, options)
    }

    fn of(
        measured: Measured,
        closed: bool,
        look: PathLook,
        seconds: f64,
        options: &TrackOptions,
    ) -> Self {
        let Measured { points, lengths } = measured;
        let mut track = Track {
            points,
            lengths,
            seconds,
            look,
            views: Vec::new(),
            closed,
        };
        let steps = (seconds * MOMENTS).clamp(FEWEST, MOST).round();
        let length = track.length();
        let ways = (0..=steps as usize).map(|i| track.way(length * i as f64 / steps));
        let per_second = steps / seconds.max(f64::MIN_POSITIVE);
        let manner = Manner {
            turn: options.turn.to_radians() / per_second,
            window: (options.ahead * per_second).clamp(0.0, steps) as usize,
            nod: options.nod,
        };
        track.views = heading::ahead(&ways.collect::<Vec<_>>(), closed, &manner);
        track
    }

    /// How long the walk takes; 0 for one that stays where it is and gives no time.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// How long the way is.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// The way: a line of short straight parts.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Eye and view after so many seconds. Before the start it stands there; after the end it stands
    /// at the end, or, on a closed path, goes round again.
    pub fn at(&self, seconds: f64) -> Pose {
        let share = if self.seconds > 0.0 {
            let share = seconds / self.seconds;
            if self.closed && share > 1.0 {
                share.fract()
            } else {
                share.clamp(0.0, 1.0)
            }
        } else {
            0.0
        };
        let eye = self.place(share * self.length());
        let ahead = || {
            let at = share * (self.views.len() - 1) as f64;
            let i = (at as usize).min(self.views.len().saturating_sub(2));
            let next = self.views[(i + 1).min(self.views.len() - 1)];
            self.views[i].lerp(next, at - i as f64).normalize()
        };
        let direction = match self.look {
            PathLook::Ahead => ahead(),
            PathLook::At(point) => (point - eye).try_normalize().unwrap_or_else(ahead),
        };
        Pose { eye, direction }
    }

    /// The part of the way that a length falls into: the index of its start.
    fn part(&self, length: f64) -> usize {
        let past = self.lengths.partition_point(|l| *l <= length);
        past.clamp(1, self.points.len().max(2) - 1) - 1
    }

    fn place(&self, length: f64) -> DVec3 {
        let i = self.part(length);
        let Some(&to) = self.points.get(i + 1) else {
            return self.points[i];
        };
        let (from, part) = (self.lengths[i], self.lengths[i + 1] - self.lengths[i]);
        self.points[i].lerp(to, ((length - from) / part).clamp(0.0, 1.0))
    }

    /// The direction of the way; (1, 0, 0) where there is none.
    fn way(&self, length: f64) -> DVec3 {
        let i = self.part(length);
        let to = self.points.get(i + 1);
        to.map_or(DVec3::X, |to| (*to - self.points[i]).normalize())
    }
}

/// A line of points with its lengths.
struct Measured {
    points: Vec<DVec3>,
    lengths: Vec<f64>,
}

impl Measured {
    fn of(mut points: Vec<DVec3>) -> Self {
        points.dedup();
        if points.is_empty() {
            points.push(DVec3::ZERO);
        }
        let mut lengths = vec![0.0];
        for pair in points.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
        }
        Self { points, lengths }
    }

    fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }
}

#[cfg(test)]
mod tests;
