//! Enfilade's own level format, in [TOML](https://toml.io): rooms, doors and what stands in them.
//!
//! In: the text of a file. Out: a [`Level`], or a [`TomlError`] with line and column. A key that is
//! not listed here is an error, so a typing mistake is never passed over.
//!
//! ```
//! let text = r#"
//! name = "Two rooms"
//!
//! [[room]]
//! name = "Hall"
//! rect = [0, 0, 6, 4]                     # x0, y0, x1, y1
//!
//! [[room]]
//! name = "Kitchen"
//! outline = [[6, 0], [10, 0], [10, 4], [8, 5], [6, 4]]
//! floor = -0.5
//! ceiling = 2.5
//!
//! [[door]]
//! between = ["Hall", "Kitchen"]
//! width = 0.9
//! "#;
//! let level = enfilade::level::toml::read(text, "two-rooms.toml").unwrap();
//! assert_eq!(level.sectors.len(), 2);
//! assert_eq!(level.walls.len(), 4 + 5 + 1);
//! ```
//!
//! # Conventions
//! x to the right (east), y up (north) on the plan, z up; heights and lengths in `unit`; angles in
//! degrees, counterclockwise; colours linear RGB with 1 as full. Walls have no thickness: where the
//! outlines of two rooms coincide there is one wall, and an opening cut into it joins both. Rooms
//! are best drawn wall to wall, to the middle of the real walls. Outlines run either way round and
//! are closed by themselves. Where outlines overlap, the room that comes last in the file counts; so
//! a room may stand inside another one (an opening between the two is placed by `room`, not by
//! `between`, since their outlines have nothing in common).
//!
//! # The whole level
//! | key | meaning |
//! |---|---|
//! | `name` | name for people; otherwise the file's name |
//! | `unit` | name of the unit of length; `"m"` |
//! | `numbers` | `"decimal"`; `"binary"` where coordinates are whole numbers or binary fractions (a converted Doom map): the grid's step is then a power of two |
//! | `start` | only in a level without rooms: points `[[x, y], …]` in its inside. What walls enclose around one of them is the level; without any, whatever walls enclose |
//! | `[defaults]` | `floor` (0), `ceiling` (3 above the floor), `materials = { walls, floor, ceiling }`, and heights for openings that do not give their own: `door_height`, `window_sill`, `window_height`, `archway_height` (otherwise from floor to ceiling) |
//! | `[budget]` | limits for reports: `max_visible_cells`, `max_visible_walls`, `max_density` (0 to 1) |
//!
//! # Plan
//! | table | keys |
//! |---|---|
//! | `[[room]]` | `name`; `rect = [x0, y0, x1, y1]` or `outline = [[x, y], …]`; `floor`, `ceiling` (z); what moves has its lowest and highest place, too: `floor_range`, `ceiling_range` (`[low, high]`); `light` (brightness, 0 to 1); `materials = { walls, floor, ceiling }` |
//! | `[[zone]]` | a step, dais, stair or lowered ceiling inside a room: a change of height without a wall. `name`; `rect` or `outline`; `floor`, `ceiling`, their ranges, `light` (those of the room around it unless given); `materials = { floor, ceiling }`. Where zones overlap, the last one counts |
//! | `[[wall]]` | a wall that stands free or divides a room: `points = [[x, y], …]`, `closed = true` to join the last to the first; `name`, `material`. It is no room's outline, but openings can be cut into it |
//! | `[[pillar]]` | a solid: `center` (or several: `centers`), `radius`, `sides` (16), `rotation` (0: a corner to the east); or `rect`; or `outline`; `name`, `material`. Its inside is outside the level; no opening can be cut into it |
//! | `[[line]]` | the plainest wall, as programs write it: `points = [[x, y], …]`; `kind`: `"solid"` (the usual one; no opening can be cut into it), `"wall"`, `"edge"` (see-through), `"door"`, `"window"`, `"archway"`; `state`, `name`, `material`, and of openings `bottom` and `top`, as below; `left`, `right`, see below |
//! | `[[sector]]` | a place in a level without rooms whose lines say where it is: `[[line]]`s name the sector on their `left` and `right` by its number in the file, from 0 (nothing: outside). `name`; `floor`, `ceiling`, `floor_range`, `ceiling_range`, `light`; `materials = { floor, ceiling }`. Such a level has lines only: no rooms, zones, walls, pillars, `start`, or openings but as lines |
//! | `[[door]]`, `[[window]]`, `[[archway]]` | an opening, see below. `[[opening]]` is another word for an archway |
//!
//! # Openings
//! Place, one of:
//! - `points = [[x, y], [x, y]]`: the two ends, on one straight wall (at most 0.01 off it);
//! - `between = ["Hall", "Kitchen"]` and `width`: in the middle of the longest stretch of wall that
//!   the rooms share, or with its middle `at = [x, y]`;
//! - `room = "Hall"` and `width`, with `side = "north"` (`east`, `south`, `west`): in the middle of
//!   the longest wall facing there, or with its middle `at = [x, y]`; `at` alone will do.
//!
//! An archway without `width` takes the whole stretch. `count = 5` spreads five of them evenly over
//! the stretch.
//!
//! Heights: `bottom` and `top` are in z; `sill` is above the higher floor, `height` above bottom or
//! floor. What is not given reaches to the floor and the ceiling. `state = "open"` or `"closed"`:
//! doors stand closed unless it says otherwise (they count as open or closed as the command asks),
//! windows are open, archways have no leaf. Further: `name`, `material` (of the leaf).
//!
//! # What stands in the level
//! | table | keys |
//! |---|---|
//! | `[[material]]` | `name`; `kd` (0.8), `ks` (0) RGB; `shininess` (32); `mirror`, `transmit`, `roughness` (0 to 1); `ior` (1.5); `emission` RGB; `texture` (a picture file) with `texture_scale` (units per repetition, 1) |
//! | `[[light]]` | `kind`: `"point"` (`position`), `"spot"` (`position`, `direction`, `angle` 45, `inner` 0), `"directional"` (`direction`), `"rectangle"` (`position` of its middle, `edges = [[x, y, z], [x, y, z]]`), `"disc"` (`position`, `direction`, `radius`), `"sphere"` (`position`, `radius`); `color` RGB (white), `intensity` (1), `name` |
//! | `[[object]]` | `kind`: `"sphere"` (`radius`), `"box"` (`size = [x, y, z]`), `"cylinder"` and `"cone"` (`radius`, `height`), `"polygon"` (`points`), `"mesh"` (`file`); `position` (of a sphere's middle, otherwise of the foot), `rotation = [x, y, z]`, `scale` (one number or three), `material`, `name` |
//! | `[[camera]]` | `name`, `eye`; `look` (a point) or `direction`; `fov` (60, horizontal) |
//! | `[[path]]` | a walk for `walk --path`: `name`; `points = [[x, y, z], …]` of the eye, or `[[x, y], …]` with `eye`, its height over the floor; `seconds` for the whole or `speed` (length per second); `look` (a point; otherwise ahead), `closed = true` to go on to the first point, `fov` (60, horizontal) |
//!
//! # Errors
//! [`TomlError`]: wrong TOML, unknown keys and names (with a suggestion), outlines that cross
//! themselves or enclose nothing, ceilings not above floors, openings on no wall or wider than it,
//! numbers that are not finite or out of their range. The first one found is returned.

mod error;
mod furnish;
mod names;
mod opening;
mod outline;
mod plan;
mod record;
mod sides;
mod source;
mod standing;
pub mod walks;
pub mod write;

pub use error::TomlError;

use self::furnish::read_scene;
use self::names::Names;
use self::opening::add_openings;
pub(super) use self::outline::{contains, inner_point};
use self::plan::{Plan, numbers, read_plan, vec2};
use self::record::File;
use self::sides::add_lines;
use self::source::SourceText;
use super::Level;
use super::draft::{Draft, DraftInterior, stem};
use super::model::OpeningStyle;
use super::snap::snap;

/// Reads a level in the format described above. `source` is the file's name, without its folder.
///
/// # Errors
/// The first mistake found, with its place; see [`TomlError`].
pub fn read(text: &str, source: &str) -> Result<Level, TomlError> {
    Ok(snap(read_draft(text, source)?)?)
}

/// Reads a level as far as the door to the grid: in the numbers of the file.
fn read_draft(text: &str, source: &str) -> Result<Draft, TomlError> {
    // A byte order mark, which some editors write, is no part of the text.
    let lines = SourceText::new(text.trim_start_matches('\u{feff}'));
    let file: File = lines.parse()?;
    let material_names = file.material.iter().map(|m| &m.get_ref().name);
    let materials = Names::of(&lines, "material", material_names)?;
    let scene = read_scene(&lines, &file, &materials)?;
    let mut plan = read_plan(&lines, &file, &materials)?;
    for (style, tables) in [
        (OpeningStyle::Door, &file.door),
        (OpeningStyle::Window, &file.window),
        (OpeningStyle::Archway, &file.archway),
        (OpeningStyle::Archway, &file.opening),
    ] {
        add_openings(&mut plan, style, tables, &file.defaults)?;
    }
    add_lines(&mut plan, &file)?;
    let interior = interior(&plan, &file)?;
    let numbers = numbers(&file);
    Ok(Draft {
        name: file.name.unwrap_or_else(|| stem(source)),
        source: source.to_string(),
        unit: file.unit.unwrap_or_else(|| "m".to_string()),
        numbers,
        walls: plan.walls,
        sectors: plan.sectors,
        outlines: plan.outlines,
        interior,
        scene,
        findings: Vec::new(),
    })
}

/// A level with rooms is what they enclose; one with sectors is where its lines name one; any other
/// is what its walls enclose.
fn interior(plan: &Plan, file: &File) -> Result<DraftInterior, TomlError> {
    if !file.sector.is_empty() {
        return Ok(DraftInterior::Sides);
    }
    if file.room.is_empty() {
        let starts = file.start.iter().map(|p| vec2(*p.get_ref())).collect();
        return Ok(DraftInterior::Enclosed { starts });
    }
    match file.start.first() {
        None => Ok(DraftInterior::Outlines),
        Some(start) => Err(TomlError::Misplaced {
            place: plan.place(start.span()),
            what: "a level with rooms",
            key: "start",
        }),
    }
}

#[cfg(test)]
mod tests;
