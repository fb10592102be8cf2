//! Who walks, and what stops him: walls, windows, shut doors, low openings, high steps, deep drops.

use crate::cells::{CellGraph, EdgeId};
use crate::level::{Level, OpeningStyle, WallKind};
use crate::trace::Space;
use crate::trace::space::{Chamber, Pane, WALL};

/// A walker's body and pace, in the level's unit; all positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Person {
    /// Half of the width that he needs.
    pub radius: f64,
    /// Height that he needs to stand and walk.
    pub height: f64,
    /// Height of his eyes over the floor.
    pub eye: f64,
    /// Highest step up that he takes.
    pub step: f64,
    /// Deepest drop that he takes; what is deeper than a step he cannot climb back.
    pub drop: f64,
    /// Length per second.
    pub speed: f64,
}

impl Person {
    /// An adult, in metres.
    pub const METRES: Person = Person {
        radius: 0.3,
        height: 1.8,
        eye: 1.6,
        step: 0.4,
        drop: 0.4,
        speed: 1.4,
    };

    /// Doom's player, in map units. He may fall as deep as he likes.
    pub const DOOM: Person = Person {
        radius: 16.0,
        height: 56.0,
        eye: 41.0,
        step: 24.0,
        drop: f64::INFINITY,
        speed: 200.0,
    };

    /// The usual person for a unit of length; metres for one that is not known.
    pub fn of_unit(unit: &str) -> Person {
        let factor = match unit {
            "map unit" => return Person::DOOM,
            "mm" => 1000.0,
            "cm" => 100.0,
            "dm" => 10.0,
            "ft" | "foot" | "feet" => 1.0 / 0.3048,
            "in" | "inch" | "inches" => 1.0 / 0.0254,
            _ => 1.0,
        };
        let metres = Person::METRES;
        Person {
            radius: metres.radius * factor,
            height: metres.height * factor,
            eye: metres.eye * factor,
            step: metres.step * factor,
            drop: metres.drop * factor,
            speed: metres.speed * factor,
        }
    }
}

/// What keeps a walker from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Barrier {
    /// No opening leads there.
    Wall,
    /// Only a door that is shut.
    Door,
    /// Only a window.
    Window,
    /// An opening of this height, too low for him.
    Low(f64),
    /// A step of this height, too high for him.
    Step(f64),
    /// A drop of this depth, too deep for him.
    Drop(f64),
    /// Between here and there it is too narrow somewhere, or things stand in the way.
    Narrow,
    /// He could go there, but not come back and see the rest.
    NoWayBack,
}

impl std::fmt::Display for Barrier {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let short = |x: &f64| (x * 1000.0).round() / 1000.0;
        match self {
            Barrier::Wall => write!(f, "no opening leads there"),
            Barrier::Door => write!(f, "the door is shut"),
            Barrier::Window => write!(f, "only a window leads there"),
            Barrier::Low(height) => write!(f, "an opening is only {} high", short(height)),
            Barrier::Step(rise) => write!(f, "a step is {} high", short(rise)),
            Barrier::Drop(depth) => write!(f, "a drop is {} deep", short(depth)),
            Barrier::Narrow => write!(f, "the way is too narrow"),
            Barrier::NoWayBack => write!(f, "there is no way back from there"),
        }
    }
}

/// Floor and ceiling; a level without heights has its floor at 0 and no ceiling.
pub fn heights(chamber: &Chamber) -> [f64; 2] {
    let floor = if chamber.floor.is_finite() {
        chamber.floor
    } else {
        0.0
    };
    [floor, chamber.ceiling]
}

/// Whether a person passes an edge from the side of its cell, as the level stands.
pub fn pass(
    (level, graph, space): (&Level, &CellGraph, &Space),
    person: &Person,
    edge: u32,
) -> Result<(), Barrier> {
    let border = space.edge(edge);
    let wall = graph.edge(EdgeId(edge)).wall();
    let kind = wall.map(|w| &level.walls[w.0 as usize].kind);
    if let Some(WallKind::Opening(opening)) = kind
        && opening.style == OpeningStyle::Window
    {
        return Err(Barrier::Window);
    }
    if border.twin == WALL {
        let shut = match kind {
            Some(WallKind::Opening(opening)) => opening.shut,
            Some(WallKind::Edge { shut }) => *shut,
            _ => false,
        };
        return Err(if shut { Barrier::Door } else { Barrier::Wall });
    }
    if matches!(border.pane, Some(Pane::Glass(_))) {
        return Err(Barrier::Window);
    }
    let [from, over] = heights(space.cell(border.cell));
    let [to, beyond] = heights(space.cell(space.edge(border.twin).cell));
    let sill = border.bottom.max(from).max(to);
    let room = border.top.min(over).min(beyond) - sill;
    // Heights of 0.4 are differences of others, and rounded: such a step is no higher than 0.4.
    let above = |given: f64, limit: f64| given > limit * (1.0 + 1e-9);
    if above(person.height, room) {
        return Err(Barrier::Low(room.max(0.0)));
    }
    if above(sill - from, person.step) {
        return Err(Barrier::Step(sill - from));
    }
    // Whoever steps onto a sill steps down from it again.
    if above(sill - to, person.drop) {
        return Err(Barrier::Drop(sill - to));
    }
    Ok(())
}
