//! What the specials of lines and things move, and where to: the tables of numbers.
//!
//! In: the number of a special, with its arguments. Out: [`Meaning`]. Doom's numbers 1 to 141 are
//! those of "The Unofficial Doom Specs", 142 to 272 and the generalized ones (0x2F80 to 0x7FFF)
//! those of the Boom reference, the action specials those of Hexen and ZDoom. Only floors and
//! ceilings matter here: speed, triggers, locks, sounds and lights do not.

/// What a special means for the heights of sectors.
#[derive(Clone, Debug, PartialEq)]
pub enum Meaning {
    /// It is known, and moves no floor or ceiling.
    Nothing,
    /// It is not known.
    Unknown,
    /// It moves sectors.
    Moves(Mover),
}

/// A special that moves sectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Mover {
    /// Which sectors.
    pub target: Target,
    /// Whether it can happen again and again.
    pub repeats: bool,
    /// What happens to each of them.
    pub acts: Vec<Act>,
}

/// Which sectors a special moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Those with the line's tag.
    Tagged,
    /// Those with this tag.
    Tag(i32),
    /// The one behind the line, whatever its tag.
    Behind,
}

/// What happens to a sector. A floor or ceiling goes somewhere between where it is and its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// The floor goes there.
    Floor(Goal),
    /// The ceiling goes there.
    Ceiling(Goal),
    /// The floor goes up by so many units (down if negative), from wherever it is.
    FloorBy(f64),
    /// The ceiling does.
    CeilingBy(f64),
    /// The floor goes there and the ceiling goes with it.
    Elevator(Goal),
    /// Stairs of this step begin here (downwards if negative) and go on where `follow` says.
    Stairs {
        /// Height of a step.
        step: f64,
        /// Which sector comes next.
        follow: Follow,
    },
    /// The floor goes down and its ring's up, both to the floor around the ring.
    Donut,
}

/// How stairs find their next sector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follow {
    /// Behind a two-sided line whose front is the present step, with the first step's floor flat.
    SameFlat,
    /// Behind such a line, whatever its flat.
    AnyFlat,
    /// Any neighbour marked as a stair by its sector special (Hexen: 26, 27).
    Marked,
}

/// Where a floor or ceiling goes. "Neighbours" are the sectors beyond two-sided lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// The lowest floor of the neighbours.
    LowestFloor,
    /// The highest floor of the neighbours.
    HighestFloor,
    /// 8 units above the highest floor of the neighbours.
    AboveHighestFloor,
    /// The next higher floor of a neighbour.
    HigherFloor,
    /// The next lower floor of a neighbour.
    LowerFloor,
    /// Some neighbour's floor.
    AnyFloor,
    /// The lowest ceiling of the neighbours, or up to 8 units below it.
    LowestCeiling,
    /// The highest ceiling of the neighbours.
    HighestCeiling,
    /// The next higher ceiling of a neighbour.
    HigherCeiling,
    /// The next lower ceiling of a neighbour.
    LowerCeiling,
    /// The sector's own floor.
    OwnFloor,
    /// 8 units above the sector's own floor, or down to it.
    AboveOwnFloor,
    /// The sector's own ceiling, or 8 units below it.
    OwnCeiling,
    /// Some height of the sector's own or of a neighbour.
    Nearby,
    /// The floor in front of the line.
    FrontFloor,
    /// The floor of the sector with this number, and so many units above it.
    Above(usize, f64),
    /// This height.
    At(f64),
    /// Up, nobody knows how far (by the height of a texture, say).
    FarUp,
    /// Down, nobody knows how far.
    FarDown,
}

use Act::{Ceiling, CeilingBy, Donut, Elevator, Floor, FloorBy, Stairs};
use Goal::*;

const OPEN: &[Act] = &[Ceiling(LowestCeiling)];
const CLOSE: &[Act] = &[Ceiling(OwnFloor)];
const OPEN_AND_CLOSE: &[Act] = &[Ceiling(LowestCeiling), Ceiling(OwnFloor)];
const CRUSH: &[Act] = &[Ceiling(AboveOwnFloor)];
const UP_AND_DOWN: &[Act] = &[Floor(LowestFloor), Floor(HighestFloor)];
/// Both go anywhere.
pub const ANYWHERE: &[Act] = &[
    Floor(FarUp),
    Floor(FarDown),
    Ceiling(FarUp),
    Ceiling(FarDown),
];

/// What a Doom line special does: vanilla, Boom extended, or Boom generalized.
pub fn doom(number: u32) -> Meaning {
    if (0x2F80..0x8000).contains(&number) {
        return generalized(number);
    }
    let moves = |target, repeats, acts: &[Act]| {
        Meaning::Moves(Mover {
            target,
            repeats,
            acts: acts.to_vec(),
        })
    };
    let tagged = |acts: &[Act]| moves(Target::Tagged, false, acts);
    let again = |acts: &[Act]| moves(Target::Tagged, true, acts);
    let stairs = |step| Stairs {
        step,
        follow: Follow::SameFlat,
    };
    // Whether it repeats is told only where it makes a difference: for goals it makes none.
    match number {
        // Doors.
        1 | 26..=28 | 117 => moves(Target::Behind, true, OPEN_AND_CLOSE),
        31..=34 | 118 => moves(Target::Behind, false, OPEN),
        4 | 29 | 63 | 90 | 105 | 108 | 111 | 114 => tagged(OPEN_AND_CLOSE),
        2 | 46 | 61 | 86 | 99 | 103 | 106 | 109 | 112 | 115 | 133..=137 => tagged(OPEN),
        3 | 16 | 42 | 50 | 75 | 76 | 107 | 110 | 113 | 116 | 175 | 196 => tagged(CLOSE),
        // Floors.
        5 | 24 | 55 | 56 | 64 | 65 | 91 | 94 | 101 => tagged(&[Floor(LowestCeiling)]),
        19 | 45 | 83 | 102 => tagged(&[Floor(HighestFloor)]),
        36 | 70 | 71 | 98 => tagged(&[Floor(AboveHighestFloor)]),
        18 | 20 | 22 | 47 | 68 | 69 | 95 | 119 | 128..=132 => tagged(&[Floor(HigherFloor)]),
        23 | 37 | 38 | 60 | 82 | 84 | 159 | 177 => tagged(&[Floor(LowestFloor)]),
        219..=222 => tagged(&[Floor(LowerFloor)]),
        30 | 96 | 158 | 176 => tagged(&[Floor(FarUp)]),
        15 | 58 | 59 | 143 | 160 | 161 => tagged(&[FloorBy(24.0)]),
        66 | 92 | 93 | 148 | 179 | 180 => again(&[FloorBy(24.0)]),
        14 | 144 => tagged(&[FloorBy(32.0)]),
        67 | 149 => again(&[FloorBy(32.0)]),
        140 | 142 => tagged(&[FloorBy(512.0)]),
        147 | 178 => again(&[FloorBy(512.0)]),
        // Lifts.
        10 | 21 | 62 | 88 | 120..=123 => tagged(&[Floor(LowestFloor)]),
        53 | 87 | 162 | 181 => tagged(UP_AND_DOWN),
        211 | 212 => tagged(&[Floor(OwnCeiling)]),
        // Stairs.
        7 | 8 => tagged(&[stairs(8.0)]),
        100 | 127 => tagged(&[stairs(16.0)]),
        256 | 258 => again(&[stairs(8.0)]),
        257 | 259 => again(&[stairs(16.0)]),
        // Ceilings. 40 and its like were meant to lower the floor too, and in Boom they do.
        40 | 151 | 166 | 186 => tagged(&[Ceiling(HighestCeiling), Floor(LowestFloor)]),
        41 | 43 | 145 | 152 => tagged(CLOSE),
        6 | 25 | 44 | 49 | 72 | 73 | 77 | 141 | 150 | 164 | 165 | 167 | 183..=185 | 187 => {
            tagged(CRUSH)
        }
        199 | 201 | 203 | 205 => tagged(&[Ceiling(LowestCeiling)]),
        200 | 202 | 204 | 206 => tagged(&[Ceiling(HighestFloor)]),
        // Both.
        9 | 146 | 155 | 191 => tagged(&[Donut]),
        227..=230 => tagged(&[Elevator(HigherFloor)]),
        231..=234 => tagged(&[Elevator(LowerFloor)]),
        235..=238 => tagged(&[Elevator(FrontFloor)]),
        // Exits, teleporters, lights, scrolling, friction, transfers; MBF21's are 1024 to 1026, and
        // 340 to 347 are slopes, which do not move.
        0..=272 | 340..=347 | 1024..=1026 => Meaning::Nothing,
        _ => Meaning::Unknown,
    }
}

/// Boom's generalized specials, whose bits say what they do. Bits 0 to 2 are the trigger: its last
/// bit says that it repeats, 6 and 7 that it is pushed by hand and moves the sector behind.
fn generalized(number: u32) -> Meaning {
    let bits = |shift: u32, n: u32| (number >> shift) & ((1 << n) - 1);
    let up = bits(6, 1) == 1;
    let signed = |by: f64| if up { by } else { -by };
    let far = if up { FarUp } else { FarDown };
    let acts: Vec<Act> = match number {
        0x2F80..=0x2FFF => CRUSH.to_vec(),
        0x3000..=0x33FF => {
            let step = [4.0, 8.0, 16.0, 24.0][bits(6, 2) as usize];
            let follow = if bits(9, 1) == 1 {
                Follow::AnyFlat
            } else {
                Follow::SameFlat
            };
            let upwards = bits(8, 1) == 1;
            let one_way = Stairs {
                step: if upwards { step } else { -step },
                follow,
            };
            let back = Stairs {
                step: if upwards { -step } else { step },
                follow,
            };
            // Set off again, these stairs go the other way.
            if bits(0, 1) == 1 {
                vec![one_way, back]
            } else {
                vec![one_way]
            }
        }
        0x3400..=0x37FF => match bits(8, 2) {
            0 => vec![Floor(LowestFloor)],
            1 => vec![Floor(LowerFloor)],
            2 => vec![Floor(LowestCeiling)],
            _ => UP_AND_DOWN.to_vec(),
        },
        0x3800..=0x3BFF => [OPEN_AND_CLOSE, OPEN][bits(5, 1) as usize].to_vec(),
        0x3C00..=0x3FFF => [OPEN_AND_CLOSE, OPEN, CLOSE, CLOSE][bits(5, 2) as usize].to_vec(),
        0x4000..=0x5FFF => vec![match bits(7, 3) {
            0 => Ceiling(HighestCeiling),
            1 => Ceiling(LowestCeiling),
            2 if up => Ceiling(HigherCeiling),
            2 => Ceiling(LowerCeiling),
            3 => Ceiling(HighestFloor),
            4 => Ceiling(OwnFloor),
            5 => Ceiling(far),
            6 => CeilingBy(signed(24.0)),
            _ => CeilingBy(signed(32.0)),
        }],
        _ => vec![match bits(7, 3) {
            0 => Floor(HighestFloor),
            1 => Floor(LowestFloor),
            2 if up => Floor(HigherFloor),
            2 => Floor(LowerFloor),
            3 => Floor(LowestCeiling),
            4 => Floor(OwnCeiling),
            5 => Floor(far),
            6 => FloorBy(signed(24.0)),
            _ => FloorBy(signed(32.0)),
        }],
    };
    let stairs = (0x3000..=0x33FF).contains(&number);
    Meaning::Moves(Mover {
        target: if bits(0, 3) >= 6 {
            Target::Behind
        } else {
            Target::Tagged
        },
        repeats: bits(0, 1) == 1 && !stairs,
        acts,
    })
}

/// What an action special of Hexen or ZDoom does. `repeats` is the line's flag. Tag 0 means the
/// sector behind the line.
pub fn action(number: u32, args: [i32; 5], repeats: bool) -> Meaning {
    let [tag, arg1, arg2, arg3, arg4] = args;
    let arg = f64::from;
    let place = |units: f64| At(if arg3 != 0 { -units } else { units });
    let mut tag = tag;
    // For what goes back by itself, or is widened already, repetition adds nothing.
    let mut repeats = repeats;
    let acts: Vec<Act> = match number {
        12..=14 | 105 | 106 | 202 => OPEN_AND_CLOSE.to_vec(),
        11 => OPEN.to_vec(),
        10 | 249 | 274 => CLOSE.to_vec(),
        20 => vec![FloorBy(-arg(arg2))],
        21 | 62 | 206 | 241 | 257 => vec![Floor(LowestFloor)],
        22 => vec![Floor(LowerFloor)],
        23 | 239 => vec![FloorBy(arg(arg2))],
        24 | 64 | 256 => vec![Floor(HighestFloor)],
        25 | 172 | 228 => vec![Floor(HigherFloor)],
        26 | 31 => vec![stairs(-arg(arg2), Follow::Marked)],
        27 | 32 => vec![stairs(arg(arg2), Follow::Marked)],
        28 | 99 => vec![Floor(OwnCeiling), Floor(LowestCeiling)],
        29 | 94 => vec![Floor(OwnCeiling), Ceiling(OwnFloor)],
        30 => {
            let down = match arg2 {
                0 => Floor(LowestFloor),
                by => FloorBy(-arg(by)),
            };
            let up = match arg3 {
                0 => Ceiling(HighestCeiling),
                by => CeilingBy(arg(by)),
            };
            vec![down, up]
        }
        35 | 67 | 230 => vec![FloorBy(8.0 * arg(arg2))],
        36 | 66 => vec![FloorBy(-8.0 * arg(arg2))],
        37 | 279 => vec![Floor(place(arg(arg2)))],
        68 => vec![Floor(place(8.0 * arg(arg2)))],
        47 | 280 => vec![Ceiling(place(arg(arg2)))],
        69 => vec![Ceiling(place(8.0 * arg(arg2)))],
        38 => {
            repeats = false;
            vec![CeilingBy(arg(arg1)), CeilingBy(-arg(arg1))]
        }
        138 => {
            repeats = false;
            vec![FloorBy(arg(arg1)), FloorBy(-arg(arg1))]
        }
        40 => vec![CeilingBy(-arg(arg2))],
        41 => vec![CeilingBy(arg(arg2))],
        194 | 198 => vec![CeilingBy(8.0 * arg(arg2))],
        193 | 199 => vec![CeilingBy(-8.0 * arg(arg2))],
        42 | 43 | 45 | 97 | 104 | 168 | 169 | 195..=197 | 205 | 255 => CRUSH.to_vec(),
        // A sector linked to another moves wherever that one is sent.
        51 => {
            tag = arg1;
            ANYWHERE.to_vec()
        }
        60 | 207 => UP_AND_DOWN.to_vec(),
        63 => {
            repeats = false;
            vec![FloorBy(-8.0 * arg(arg3))]
        }
        65 => {
            repeats = false;
            vec![FloorBy(8.0 * arg(arg3))]
        }
        203 => {
            repeats = false;
            let mut acts = vec![Floor(LowestCeiling)];
            acts.extend(UP_AND_DOWN);
            acts.push(FloorBy(8.0 * arg(arg4)));
            acts
        }
        95 => vec![FloorBy(-arg(arg2)), CeilingBy(-arg(arg2))],
        96 => vec![FloorBy(arg(arg2)), CeilingBy(arg(arg2))],
        192 | 266 => vec![Ceiling(HighestFloor)],
        200 => generic(arg2, arg3, arg4).map(Floor).to_vec(),
        201 => generic(arg2, arg3, arg4).map(Ceiling).to_vec(),
        204 => {
            let up = arg3 & 1 != 0;
            let follow = if arg3 & 2 != 0 {
                Follow::AnyFlat
            } else {
                Follow::SameFlat
            };
            let step = if up { arg(arg2) } else { -arg(arg2) };
            // Set off again, these stairs go the other way.
            let again = std::mem::take(&mut repeats).then(|| stairs(-step, follow));
            std::iter::once(stairs(step, follow)).chain(again).collect()
        }
        217 | 271 | 273 => vec![stairs(arg(arg2), Follow::SameFlat)],
        270 | 272 => vec![stairs(-arg(arg2), Follow::SameFlat)],
        231 | 259 | 260 => vec![Floor(OwnCeiling)],
        238 | 258 => vec![Floor(LowestCeiling)],
        240 => vec![Floor(FarUp)],
        261 => vec![Floor(FarDown)],
        // Stops short by arg2 - 128 units.
        242 => {
            let short = if arg2 == 0 { 0.0 } else { arg(arg2) - 128.0 };
            repeats = false;
            vec![Floor(HighestFloor), FloorBy(short), FloorBy(-short)]
        }
        245 => vec![Elevator(HigherFloor)],
        246 => vec![Elevator(FrontFloor)],
        247 => vec![Elevator(LowerFloor)],
        250 => vec![Donut],
        251 => vec![Floor(LowestFloor), Ceiling(HighestCeiling)],
        252 => vec![Ceiling(HigherCeiling)],
        253 | 265 => vec![Ceiling(LowestCeiling)],
        254 | 267 => vec![Ceiling(OwnFloor)],
        262 | 263 => vec![Ceiling(HighestCeiling)],
        264 => vec![Ceiling(LowerCeiling)],
        268 => vec![Ceiling(FarUp)],
        269 => vec![Ceiling(FarDown)],
        0..=283 => return Meaning::Nothing,
        _ => return Meaning::Unknown,
    };
    let target = if tag == 0 {
        Target::Behind
    } else {
        Target::Tag(tag)
    };
    Meaning::Moves(Mover {
        target,
        repeats,
        acts,
    })
}

fn stairs(step: f64, follow: Follow) -> Act {
    Stairs { step, follow }
}

/// `Generic_Floor` and `Generic_Ceiling`: kind 0 is by a distance, 6 by a texture's height, the
/// others go to heights nearby. Flag 8 means up. By a distance counts as far: these are rare, and
/// most of them repeat.
fn generic(distance: i32, kind: i32, flags: i32) -> [Goal; 1] {
    let up = (flags & 8 != 0) == (distance >= 0);
    match kind {
        1..=5 => [Nearby],
        _ if up => [FarUp],
        _ => [FarDown],
    }
}
