//! What things bring into the scene: lamps, torches and candles are lights, starts are cameras.
//!
//! Source: "The Unofficial Doom Specs" 1.666, chapter 4-2-1, for the numbers. The game's own lamps
//! shine on nothing; heights of the flames are those of the sprites, colours and reach are ours.

use glam::{DVec2, DVec3};

use super::raw::{RawMap, Thing};
use crate::level::scene::{Camera, Light, LightShape};

/// Height of the player's eyes above the floor.
const EYES: f64 = 41.0;
/// Horizontal angle of view of the game, in degrees.
const FOV: f64 = 90.0;

/// A thing that shines.
struct Lamp {
    kind: i32,
    name: &'static str,
    /// Of the flame above the floor.
    height: f64,
    /// At a distance of 64 units.
    intensity: [f64; 3],
}

const fn lamp(kind: i32, name: &'static str, height: f64, intensity: [f64; 3]) -> Lamp {
    Lamp {
        kind,
        name,
        height,
        intensity,
    }
}

const LAMPS: [Lamp; 14] = [
    lamp(2028, "floor lamp", 44.0, [1.0, 0.95, 0.75]),
    lamp(85, "tall techno lamp", 72.0, [0.9, 0.95, 1.2]),
    lamp(86, "short techno lamp", 52.0, [0.75, 0.8, 1.0]),
    lamp(34, "candle", 15.0, [0.2, 0.14, 0.05]),
    lamp(35, "candelabra", 55.0, [0.8, 0.6, 0.25]),
    lamp(44, "tall blue torch", 74.0, [0.25, 0.4, 1.3]),
    lamp(45, "tall green torch", 74.0, [0.3, 1.1, 0.25]),
    lamp(46, "tall red torch", 74.0, [1.3, 0.55, 0.2]),
    lamp(55, "short blue torch", 48.0, [0.2, 0.3, 1.0]),
    lamp(56, "short green torch", 48.0, [0.25, 0.85, 0.2]),
    lamp(57, "short red torch", 48.0, [1.0, 0.4, 0.15]),
    lamp(70, "burning barrel", 44.0, [1.1, 0.6, 0.2]),
    lamp(41, "evil eye", 40.0, [0.2, 0.5, 0.1]),
    lamp(42, "floating skull", 34.0, [0.7, 0.25, 0.1]),
];

/// A point light for each lamp that stands inside of the map and below a ceiling.
pub fn lights(raw: &RawMap) -> Vec<Light> {
    if raw.foreign_things {
        return Vec::new();
    }
    let light = |(number, thing): (usize, &Thing)| {
        let lamp = LAMPS.iter().find(|l| l.kind == thing.kind)?;
        let sector = &raw.sectors[sector_at(raw, thing.at)?];
        let room = sector.ceiling - sector.floor;
        // In a low place the flame stays below the ceiling.
        let height = lamp.height.min(room * 0.9);
        (room > 0.0).then(|| Light {
            name: Some(format!("{} (thing {number})", lamp.name)),
            intensity: lamp.intensity.map(|c| c * 64.0 * 64.0),
            shape: LightShape::Point {
                position: thing.at.extend(sector.floor + thing.z.max(0.0) + height),
            },
        })
    };
    raw.things.iter().enumerate().filter_map(light).collect()
}

/// A camera for each start: "player", "player 2" to "player 4", "deathmatch 1" and on. Of several
/// starts of one player the last counts, as in the game.
pub fn cameras(raw: &RawMap) -> Vec<Camera> {
    let player = |kind: i32| raw.things.iter().rev().find(|t| t.kind == kind);
    let names = ["player", "player 2", "player 3", "player 4"];
    let players = (1..).zip(names).filter_map(|(kind, name)| {
        let start = player(kind)?;
        camera(raw, start, name.to_string())
    });
    let arena = raw.things.iter().filter(|t| t.kind == 11);
    let arena = (1..)
        .zip(arena)
        .filter_map(|(i, start)| camera(raw, start, format!("deathmatch {i}")));
    players.chain(arena).collect()
}

/// `None` for a start outside of the map.
fn camera(raw: &RawMap, start: &Thing, name: String) -> Option<Camera> {
    let sector = &raw.sectors[sector_at(raw, start.at)?];
    Some(Camera {
        name,
        eye: start.at.extend(sector.floor + EYES),
        direction: towards(start.angle),
        fov: FOV,
    })
}

/// The unit vector at an angle from the east; exact along the axes.
fn towards(angle: f64) -> DVec3 {
    let axes = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
    let quarters = angle.rem_euclid(360.0) / 90.0;
    let flat = match axes.get(quarters as usize) {
        Some(&axis) if quarters.fract() == 0.0 => axis,
        _ => DVec2::from_angle(angle.to_radians()),
    };
    flat.extend(0.0)
}

/// The sector that a point lies in: the one on this side of the first line to the east of it.
fn sector_at(raw: &RawMap, at: DVec2) -> Option<usize> {
    let mut nearest = f64::INFINITY;
    let mut found = None;
    for line in &raw.lines {
        let vertex = |n: u32| raw.vertices.get(n as usize);
        let (Some(from), Some(to)) = (vertex(line.v1), vertex(line.v2)) else {
            continue;
        };
        let (below, above) = (from.y <= at.y, to.y <= at.y);
        if below == above {
            continue;
        }
        let x = from.x + (to.x - from.x) * ((at.y - from.y) / (to.y - from.y));
        if x > at.x && x < nearest {
            nearest = x;
            // What is west of a line going north lies on its left, the back.
            found = raw.sector_at(if below { line.back } else { line.front });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::tests::build::three_rooms;
    use super::*;

    fn thing(x: f64, y: f64, angle: f64, kind: i32) -> Thing {
        Thing {
            at: DVec2::new(x, y),
            angle,
            kind,
            ..Thing::default()
        }
    }

    #[test]
    fn points_lie_in_their_rooms() {
        let map = three_rooms();
        for (x, sector) in [(1.0, 0), (63.0, 0), (65.0, 1), (127.0, 1), (129.0, 2)] {
            assert_eq!(sector_at(&map, DVec2::new(x, 32.0)), Some(sector));
        }
        for (x, y) in [(-1.0, 32.0), (193.0, 32.0), (32.0, 65.0), (32.0, -1.0)] {
            assert_eq!(sector_at(&map, DVec2::new(x, y)), None, "{x}, {y}");
        }
    }

    #[test]
    fn lamps_shine_from_their_flames() {
        let mut map = three_rooms();
        map.sectors[1].floor = 16.0;
        map.sectors[2].ceiling = 40.0;
        map.things = vec![
            thing(96.0, 32.0, 0.0, 2028),
            thing(96.0, 40.0, 0.0, 3004), // a monster
            thing(160.0, 32.0, 0.0, 46),
            thing(999.0, 32.0, 0.0, 46),
        ];
        let lights = lights(&map);
        let at = |i: usize| match lights[i].shape {
            LightShape::Point { position } => position,
            _ => panic!("{:?}", lights[i]),
        };
        assert_eq!(lights.len(), 2);
        assert_eq!(at(0), DVec3::new(96.0, 32.0, 60.0));
        assert_eq!(at(1), DVec3::new(160.0, 32.0, 36.0));
        assert_eq!(lights[0].name.as_deref(), Some("floor lamp (thing 0)"));
        assert_eq!(lights[0].intensity[0], 4096.0);
        map.foreign_things = true;
        assert!(super::lights(&map).is_empty());
    }

    #[test]
    fn starts_are_cameras() {
        let mut map = three_rooms();
        map.sectors[2].floor = -8.0;
        map.things = vec![
            thing(32.0, 32.0, 0.0, 1),
            thing(160.0, 32.0, 270.0, 1),
            thing(96.0, 32.0, 45.0, 3),
            thing(96.0, 16.0, 180.0, 11),
            thing(96.0, 999.0, 0.0, 2),
        ];
        let cameras = cameras(&map);
        let names: Vec<&str> = cameras.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["player", "player 3", "deathmatch 1"]);
        assert_eq!(cameras[0].eye, DVec3::new(160.0, 32.0, 33.0));
        assert_eq!(cameras[0].direction, DVec3::NEG_Y);
        assert!(
            (cameras[1].direction - DVec3::new(0.5f64.sqrt(), 0.5f64.sqrt(), 0.0)).length() < 1e-15
        );
        assert_eq!(cameras[2].direction, DVec3::NEG_X);
    }
}
