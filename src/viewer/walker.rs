//! Someone who walks or flies through a level by hand.
//!
//! In: a [`Footing`], made once of a level and a [`Person`]; then [`Input`]s, as keys and mouse give them.
//! Out: a [`Walker`]'s eye. Whoever walks is a disc on the plan that keeps clear of walls, high steps, low
//! openings, shut doors, windows and things, and slides along them; his eye follows the floor smoothly. He
//! never comes nearer to an obstacle than his radius or, where he already is nearer, than he is: so he may
//! start anywhere. In the end each straight piece of the way is one through the cells that a person can
//! pass: so he never leaves the level. Whoever flies goes where he looks, through everything.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use crate::cells::{CellGraph, CellId, Locator};
use crate::level::Level;
use crate::trace::Space;
use crate::trace::camera::Camera;
use crate::trace::space::WALL;
use crate::walk::obstacle::{footprint, within};
use crate::walk::person::{heights, pass};
use crate::walk::rise::cross;
use crate::walk::{Ground, Person};

/// A hand walks faster than a guide: this many times the person's pace.
const PACE: f64 = 1.8;
/// And runs so many times as fast.
const RUN: f64 = 2.2;
/// Turning by keys, in radians per second.
const TURN: f64 = 2.2;
/// Highest and lowest view; straight up there is no ahead.
const STEEPEST: f64 = FRAC_PI_2 - 0.02;
/// Seconds in which most of a change of speed is done, and of height.
const EASE: f64 = 0.06;
const RISE: f64 = 0.09;
/// Parts of a radius that are walked at once.
const PART: f64 = 0.25;
/// No step takes longer; whoever waited for the computer does not walk blindly.
const LONGEST: f64 = 0.25;
/// A thing is in the way if it is higher than this share of a step.
const FLAT: f64 = 0.5;
/// Shares of the eye's height that are kept free below and above it.
const BELOW: f64 = 0.25;
const ABOVE: f64 = 0.1;

/// Whether walls count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// On the ground.
    #[default]
    Walk,
    /// Through everything.
    Fly,
}

/// What keys and mouse ask for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Input {
    /// From -1 (back) to 1.
    pub forward: f64,
    /// From -1 (left) to 1.
    pub right: f64,
    /// From -1 (down) to 1; whoever walks takes no notice.
    pub up: f64,
    /// Whether to run.
    pub run: bool,
    /// Turning by keys, from -1 (right) to 1 (left).
    pub turn: f64,
    /// Looking up or down by keys, from -1 (down) to 1.
    pub tilt: f64,
    /// Turning by mouse, in radians: to the left, and up.
    pub look: DVec2,
}

impl Input {
    /// Whether anything is asked for.
    pub fn is_idle(&self) -> bool {
        *self
            == Self {
                run: self.run,
                ..Self::default()
            }
    }
}

/// Where a person can stand and go: made once, and borrowing nothing.
pub struct Footing {
    person: Person,
    /// By edge: whether a person passes from its cell.
    passes: Vec<bool>,
    /// Ground that things take up: convex, counterclockwise.
    things: Vec<Vec<DVec2>>,
    locator: Locator,
}

/// A level with its footing.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    /// Its cells.
    pub graph: &'a CellGraph,
    /// With heights.
    pub space: &'a Space,
    /// For whom.
    pub footing: &'a Footing,
}

/// Someone in a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walker {
    /// Where his eye is.
    pub eye: DVec3,
    /// Where he looks on the plan: radians counterclockwise from the x axis.
    pub yaw: f64,
    /// How far up: radians.
    pub pitch: f64,
    /// Whether walls count.
    pub mode: Mode,
    /// How fast he is, per second.
    velocity: DVec3,
}

impl Footing {
    /// That of a person in a level as it stands.
    pub fn new(level: &Level, graph: &CellGraph, space: &Space, person: &Person) -> Self {
        let edges = 0..space.edges.len() as u32;
        let ground = Ground::new(graph, space);
        let objects = level.scene.objects.iter();
        let flat = person.step * FLAT;
        Self {
            person: *person,
            passes: edges
                .map(|e| pass((level, graph, space), person, e).is_ok())
                .collect(),
            things: objects
                .filter_map(|o| footprint(o, &ground, person.height, flat))
                .collect(),
            locator: Locator::new(graph),
        }
    }

    /// Who walks.
    pub fn person(&self) -> &Person {
        &self.person
    }
}

impl Site<'_> {
    /// The cells that hold a place, border included.
    fn cells_at(&self, at: DVec2) -> Vec<CellId> {
        let point = self.graph.grid.fine(at);
        point.map_or_else(Vec::new, |p| self.footing.locator.cells_at(self.graph, &p))
    }

    /// The cell of an eye, if it is in one, whatever its height.
    pub fn cell_at(&self, at: DVec2) -> Option<CellId> {
        self.cells_at(at).first().copied()
    }

    /// The lines that may stop a body within `reach` of a place in a cell.
    fn obstacles(&self, cell: CellId, at: DVec2, reach: f64) -> Vec<[DVec2; 2]> {
        let space = self.space;
        let mut seen = vec![cell.0];
        let mut stops = Vec::new();
        let mut next = 0;
        while let Some(&cell) = seen.get(next) {
            next += 1;
            let chamber = space.cell(cell);
            for e in chamber.first..chamber.past {
                let edge = space.edge(e);
                let line = [space.vertex(edge.from), space.vertex(edge.to)];
                if nearest(at, line).distance(at) >= reach {
                    continue;
                }
                if !self.footing.passes[e as usize] {
                    stops.push((e, line));
                    continue;
                }
                let beyond = space.edge(edge.twin).cell;
                if !seen.contains(&beyond) {
                    seen.push(beyond);
                }
            }
        }
        // The edge of a drop that one may take is seen as a high step from below.
        let down = |e: u32| {
            let twin = space.edge(e).twin;
            twin != WALL
                && self.footing.passes[twin as usize]
                && seen.contains(&space.edge(twin).cell)
        };
        let walls = stops.into_iter().filter(|(e, _)| !down(*e));
        let mut lines: Vec<[DVec2; 2]> = walls.map(|(_, line)| line).collect();
        for thing in &self.footing.things {
            // Whoever stands in a thing may leave it.
            if within(thing, at) {
                continue;
            }
            let sides = (0..thing.len()).map(|i| [thing[i], thing[(i + 1) % thing.len()]]);
            lines.extend(sides.filter(|line| nearest(at, *line).distance(at) < reach));
        }
        lines
    }
}

impl Walker {
    /// With his eye at some place, looking in some direction (not zero).
    pub fn new(eye: DVec3, direction: DVec3, mode: Mode) -> Self {
        let flat = direction.truncate();
        Self {
            eye,
            yaw: flat.y.atan2(flat.x),
            pitch: (direction.z.atan2(flat.length())).clamp(-STEEPEST, STEEPEST),
            mode,
            velocity: DVec3::ZERO,
        }
    }

    /// Puts him on the floor of a place, if there is one. He goes on looking where he does.
    pub fn stand(&mut self, at: DVec2, site: &Site) -> bool {
        let cells = site.cells_at(at).into_iter();
        let room = |c: &CellId| {
            let [floor, ceiling] = heights(site.space.cell(c.0));
            ceiling - floor
        };
        let Some(cell) = cells.max_by(|a, b| room(a).total_cmp(&room(b))) else {
            return false;
        };
        let [floor, ceiling] = heights(site.space.cell(cell.0));
        if floor >= ceiling {
            return false;
        }
        let person = &site.footing.person;
        let z = between(floor + person.eye, (floor, ceiling), person.eye);
        self.eye = at.extend(z);
        self.velocity = DVec3::ZERO;
        true
    }

    /// Unit vector of where he looks.
    pub fn direction(&self) -> DVec3 {
        let (sin, cos) = self.pitch.sin_cos();
        (DVec2::from_angle(self.yaw) * cos).extend(sin)
    }

    /// What he sees.
    pub fn camera(&self, fov: f64, size: [u32; 2]) -> Camera {
        Camera::new(self.eye, self.direction(), fov, size)
    }

    /// Whether he still moves.
    pub fn moves(&self) -> bool {
        self.velocity != DVec3::ZERO
    }

    /// Goes on for some seconds.
    pub fn step(&mut self, input: &Input, seconds: f64, site: &Site) {
        let seconds = seconds.clamp(0.0, LONGEST);
        self.yaw += input.look.x + input.turn.clamp(-1.0, 1.0) * TURN * seconds;
        self.yaw = (self.yaw + PI).rem_euclid(TAU) - PI;
        self.pitch += input.look.y + input.tilt.clamp(-1.0, 1.0) * TURN / 2.0 * seconds;
        self.pitch = self.pitch.clamp(-STEEPEST, STEEPEST);
        let person = site.footing.person;
        let ahead = match self.mode {
            Mode::Walk => DVec2::from_angle(self.yaw).extend(0.0),
            Mode::Fly => self.direction(),
        };
        let right = DVec2::from_angle(self.yaw - FRAC_PI_2).extend(0.0);
        let up = match self.mode {
            Mode::Walk => 0.0,
            Mode::Fly => input.up,
        };
        let wish = ahead * input.forward + right * input.right + DVec3::Z * up;
        let pace = person.speed * PACE * if input.run { RUN } else { 1.0 };
        let wish = wish.clamp_length_max(1.0) * pace;
        self.velocity += (wish - self.velocity) * (1.0 - (-seconds / EASE).exp());
        // It would creep for ever.
        if wish == DVec3::ZERO && self.velocity.length() < pace * 0.01 {
            self.velocity = DVec3::ZERO;
        }
        let way = self.velocity * seconds;
        match self.mode {
            Mode::Fly => self.eye += way,
            Mode::Walk => self.walk(way.truncate(), seconds, site),
        }
    }

    /// Walks a way, as far as it is free. Outside of the level, where a flight may have ended, nothing
    /// stops him.
    fn walk(&mut self, way: DVec2, seconds: f64, site: &Site) {
        let person = site.footing.person;
        let parts = (way.length() / (person.radius * PART)).ceil().max(1.0);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let start = self.eye.truncate();
        for _ in 0..parts as u32 {
            let at = self.eye.truncate();
            let Some(cell) = self.own_cell(site) else {
                self.eye += (way / parts).extend(0.0);
                continue;
            };
            let Some(to) = slide(site, cell, at, way / parts) else {
                break;
            };
            let mut passed = (f64::NEG_INFINITY, f64::INFINITY);
            let end = cross(site.space, cell.0, [at, to], |e, edge| {
                passed = (passed.0.max(edge.bottom), passed.1.min(edge.top));
                site.footing.passes[e as usize]
            });
            // The very cell may be another by rounding; in none he must not be.
            if end.is_none() || site.cell_at(to).is_none() {
                break;
            }
            (low, high) = (low.max(passed.0), high.min(passed.1));
            self.eye = to.extend(self.eye.z);
        }
        // Whoever runs into a wall has no speed left towards it.
        if seconds > 0.0 {
            let done = (self.eye.truncate() - start) / seconds;
            if done.length() < self.velocity.length() {
                self.velocity = done.extend(0.0);
            }
        }
        if let Some(cell) = self.own_cell(site) {
            let [floor, ceiling] = heights(site.space.cell(cell.0));
            let wish = floor + person.eye;
            let z = self.eye.z + (wish - self.eye.z) * (1.0 - (-seconds / RISE).exp());
            self.eye.z = between(z, (floor.max(low), ceiling.min(high)), person.eye);
        }
    }

    /// The cell that he stands in: on a border, one that fits his eye.
    fn own_cell(&self, site: &Site) -> Option<CellId> {
        let cells = site.cells_at(self.eye.truncate());
        let fits = |c: &&CellId| {
            let [floor, ceiling] = heights(site.space.cell(c.0));
            floor < self.eye.z && self.eye.z < ceiling
        };
        cells.iter().find(fits).or(cells.first()).copied()
    }
}

/// A height for an eye, off the floor and the ceiling as far as there is room.
fn between(z: f64, (floor, ceiling): (f64, f64), eye: f64) -> f64 {
    let (low, high) = (floor + eye * BELOW, ceiling - eye * ABOVE);
    if low < high {
        z.clamp(low, high)
    } else {
        (floor + ceiling) / 2.0
    }
}

/// The point of a line nearest to another.
fn nearest(p: DVec2, [a, b]: [DVec2; 2]) -> DVec2 {
    let along = b - a;
    let share = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    a + along * share.clamp(0.0, 1.0)
}

/// Where a body ends up that would go a short way: pushed off what it would come too near to. `None` where
/// it would be stuck.
fn slide(site: &Site, cell: CellId, at: DVec2, way: DVec2) -> Option<DVec2> {
    /// Between two walls it may be pushed to and fro some times.
    const ROUNDS: u32 = 8;
    let radius = site.footing.person.radius;
    let lines = site.obstacles(cell, at, radius + way.length());
    // How near each may come: no nearer than it is, if it is nearer than the radius. Rounding is forgiven.
    let limits: Vec<([DVec2; 2], f64)> = lines
        .into_iter()
        .map(|line| (line, radius.min(nearest(at, line).distance(at))))
        .collect();
    let slack = radius * 1e-9;
    let mut to = at + way;
    for _ in 0..ROUNDS {
        let mut free = true;
        for &(line, limit) in &limits {
            let along = (line[1] - line[0]).normalize_or_zero();
            if crossed([at, to], line) {
                to = at + along * along.dot(to - at);
                free = false;
            }
            let foot = nearest(to, line);
            let off = to - foot;
            if off.length() < limit - slack {
                // Straight off the line's own side where the body's middle touches it.
                let side = along.perp() * along.perp_dot(at - line[0]).signum();
                to = foot + off.try_normalize().unwrap_or(side) * limit;
                free = false;
            }
        }
        if free {
            return Some(to);
        }
    }
    None
}

/// Whether a way leads across a line.
fn crossed([from, to]: [DVec2; 2], [a, b]: [DVec2; 2]) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    side(a, b, from) * side(a, b, to) < 0.0 && side(from, to, a) * side(from, to, b) < 0.0
}

#[cfg(test)]
mod tests;
