//! An explanation in a few lines for people.
//!
//! In: an [`Account`]. Out: text in which every line begins with what it is about. Words like cell
//! and portal stand only where a number is to be looked up; lengths have the digits that matter.

use std::fmt::Write;

use super::names::{EndRecord, OpeningRecord, PortalRecord, WallRecord};
use super::{Account, OpenRecord, PlaceRecord, SpaceRecord, StraightRecord, ViewRecord, WayRecord};
use crate::level::{Level, Place};
use crate::report::wording::{coordinate, count_of, length, unit};

/// How many portals and corners of a way are listed before some are left out.
const LISTED: usize = 12;

/// The whole explanation.
pub fn of(level: &Level, account: &Account) -> String {
    let words = Words { level };
    let (from, to) = (words.place(&account.from), words.place(&account.to));
    let mut lines = Lines::default();
    let title = format!("{} ({})", level.name, level.source);
    if account.from.cell == account.to.cell {
        lines.head(&format!("{title}: both places lie in one cell, {from}."));
        lines.say(
            "Visible",
            "nothing stands in a cell: all of it sees all of it",
        );
        return lines.0;
    }
    let answer = if account.visible {
        "Visible"
    } else {
        "Not visible"
    };
    lines.head(&format!("{title}: from {from} to {to}."));
    let space = account.view.as_ref().and_then(|v| v.space.as_ref());
    let said = if space.is_some_and(|s| s.answer == "undecided") {
        "on the plan some straight line is free; whether one clears all floors and ceilings is not known"
    } else if !account.visible && space.is_some() {
        "on the plan some straight line is free, but none clears all floors and ceilings"
    } else if account.visible {
        "some straight line from the one to the other is free"
    } else if account.connected {
        "every straight line from the one to the other meets a wall"
    } else if account.doors == "closed" {
        "no way leads from the one to the other while doors are closed"
    } else {
        "no way leads from the one to the other"
    };
    lines.say(answer, said);
    if let Some(straight) = &account.straight {
        words.straight(&mut lines, straight, account);
    }
    if let Some(view) = &account.view {
        words.view(&mut lines, view);
    }
    if let Some(way) = &account.way {
        words.way(&mut lines, way);
    }
    if let Some(open) = &account.doors_open {
        words.doors_open(&mut lines, open);
    }
    lines.0
}

/// Lines with what they are about in front.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn head(&mut self, text: &str) {
        _ = writeln!(self.0, "{text}");
    }

    fn say(&mut self, about: &str, text: &str) {
        _ = writeln!(self.0, "{about:<12} {text}");
    }

    fn list(&mut self, about: &str, items: &[String]) {
        for (i, item) in items.iter().enumerate() {
            self.say(if i == 0 { about } else { "" }, item);
        }
    }
}

struct Words<'a> {
    level: &'a Level,
}

impl Words<'_> {
    fn point(&self, [x, y]: [f64; 2]) -> String {
        format!(
            "({}, {})",
            coordinate(self.level, x),
            coordinate(self.level, y)
        )
    }

    fn length(&self, n: f64) -> String {
        format!("{} {}", length(n), unit(self.level))
    }

    fn place(&self, place: &PlaceRecord) -> String {
        let cell = match &place.room {
            Some(room) => format!("cell {} in {}", place.cell, quoted(room)),
            None => format!("cell {}", place.cell),
        };
        let beside = match place.beside {
            Some(other) => format!(", on its border with cell {other}"),
            None => String::new(),
        };
        match place.point {
            Some(point) => format!("{} ({cell}{beside})", self.point(point)),
            None => cell,
        }
    }

    fn view(&self, lines: &mut Lines, view: &ViewRecord) {
        let [from, to] = view.segment.map(|p| self.point(p));
        lines.say(
            "Sightline",
            &format!("{from} to {to}, {} long", self.length(view.length)),
        );
        self.portals(lines, "through", &view.portals, None);
        if let Some(space) = &view.space {
            self.space(lines, space);
        }
        let width = self.length(view.width);
        let widest = if view.widest {
            ""
        } else {
            "; the search was cut short, there may be a wider view"
        };
        lines.say(
            "Width",
            &format!("{width}: that wide is the strip of parallel sightlines around it{widest}"),
        );
        for (about, ends, beside) in [
            ("on its left", &view.left, &view.beside_left),
            ("on its right", &view.right, &view.beside_right),
        ] {
            let text = match beside {
                None => {
                    // Beside a corner of walls, a cell's own corner does not matter.
                    let walls = ends.iter().any(|e| e.kind == "corner");
                    let ends = ends.iter().filter(|e| !walls || e.kind == "corner");
                    let ends: Vec<String> = ends.map(|e| self.end(e)).collect();
                    ends.join(", and ")
                }
                Some(beside) => format!(
                    "only the cells' own borders; the nearest wall is {} farther: {}",
                    self.length(beside.distance),
                    self.end(&beside.end)
                ),
            };
            lines.say(about, &text);
        }
    }

    fn space(&self, lines: &mut Lines, space: &SpaceRecord) {
        if let Some(ends) = space.segment {
            let [from, to] = ends.map(|[x, y, z]| {
                let plan = self.point([x, y]);
                format!("{} high at {plan}", self.length(z))
            });
            lines.say("In space", &format!("from {from} to {to}"));
        }
        if !space.blocked_by.is_empty() {
            let items: Vec<String> = space.blocked_by.iter().map(|p| self.opening(p)).collect();
            lines.list("Blocked by", &items);
            lines.say(
                "",
                "no straight line clears all of these; all other ways fail as well",
            );
        } else if space.answer == "hidden" {
            lines.say(
                "Blocked by",
                "different openings for different lines; all ways fail",
            );
        }
    }

    /// A portal with its opening in height.
    fn opening(&self, portal: &PortalRecord) -> String {
        match portal.opening {
            Some([bottom, top]) if bottom < top => format!(
                "{}, open from {} to {}",
                self.portal(portal),
                length(bottom),
                self.length(top)
            ),
            Some(_) => format!("{}, which has no height", self.portal(portal)),
            None => self.portal(portal),
        }
    }

    fn straight(&self, lines: &mut Lines, straight: &StraightRecord, account: &Account) {
        let between = "straight from point to point";
        let text = match (straight.point, &straight.wall) {
            (Some(point), Some(wall)) => {
                let point = self.point(point);
                let wall = self.wall(wall);
                if straight.touches {
                    format!("{between}, the line just touches {wall} at {point}")
                } else {
                    format!("{between}, {wall} stands in the way at {point}")
                }
            }
            (Some(point), None) => format!("{between}, a wall is met at {}", self.point(point)),
            _ => format!("{between}, nothing stands in the way"),
        };
        let about = if straight.free || !account.visible {
            text
        } else {
            format!("{text}; other points of the two cells see each other")
        };
        lines.say("Points", &about);
    }

    fn way(&self, lines: &mut Lines, way: &WayRecord) {
        lines.say(
            "Shortest way",
            &format!(
                "{} through {}",
                self.length(way.length),
                self.gone_through(&way.portals)
            ),
        );
        self.portals(lines, "through", &way.portals, Some(way.stop));
        if !way.bends.is_empty() {
            let bends: Vec<String> = shortened(&way.bends, |e| self.end(e));
            lines.list("around", &bends);
        }
        if let Some(stop) = way.portals.get(way.stop) {
            let room = stop.rooms[0].as_deref().map(quoted);
            let room = room.map(|r| format!(" in {r}")).unwrap_or_default();
            let end = if stop.kind == "border" {
                format!("its border at {}", self.point(stop.point))
            } else {
                self.portal(stop)
            };
            lines.say(
                "Sight",
                &format!(
                    "ends in cell {}{room}: nothing is seen beyond {end}",
                    stop.cells[0]
                ),
            );
        }
        if let Some(farthest) = &way.farthest {
            let [from, _] = farthest.segment.map(|p| self.point(p));
            lines.say(
                "",
                &format!(
                    "the line that gets there, from {from}, is stopped at {} by {}",
                    self.point(farthest.point),
                    self.wall(&farthest.wall)
                ),
            );
        }
        lines.say("Blocked", "a line this way would have to leave");
        for (side, ends) in [("left", &way.left), ("right", &way.right)] {
            for (i, end) in ends.iter().enumerate() {
                let on = if i == 0 {
                    format!("on its {side}")
                } else {
                    String::new()
                };
                lines.say("", &format!("  {on:<12} {}", self.end(end)));
            }
        }
        lines.say(
            "",
            "which no straight line does. All other ways fail as well.",
        );
    }

    /// `2 doors and an archway`, roughly: what kinds of openings a way passes.
    fn gone_through(&self, portals: &[PortalRecord]) -> String {
        let mut parts = Vec::new();
        for (kind, one, many) in [
            ("door", "door", "doors"),
            ("window", "window", "windows"),
            ("archway", "archway", "archways"),
            ("sector edge", "change of sector", "changes of sector"),
        ] {
            let n = portals.iter().filter(|p| p.kind == kind).count();
            if n > 0 {
                parts.push(count_of(n, one, many));
            }
        }
        match parts.split_last() {
            None => "open space".to_string(),
            Some((last, [])) => last.clone(),
            Some((last, rest)) => format!("{} and {last}", rest.join(", ")),
        }
    }

    /// A line for every opening; borders that only the subdivision made are left out.
    fn portals(
        &self,
        lines: &mut Lines,
        about: &str,
        portals: &[PortalRecord],
        stop: Option<usize>,
    ) {
        let numbered = portals.iter().enumerate();
        let kept: Vec<(usize, &PortalRecord)> =
            numbered.filter(|(_, p)| p.kind != "border").collect();
        let items = shortened(&kept, |&(i, portal)| {
            let mark = if stop == Some(i) {
                " ← sight ends here"
            } else {
                ""
            };
            format!("{}{mark}", self.portal(portal))
        });
        lines.list(about, &items);
    }

    fn portal(&self, portal: &PortalRecord) -> String {
        let at = self.point(portal.point);
        let rooms = match &portal.rooms {
            [Some(a), Some(b)] if a != b => format!(" from {} to {}", quoted(a), quoted(b)),
            [Some(a), _] | [None, Some(a)] if portal.kind != "border" => {
                format!(" in {}", quoted(a))
            }
            _ => String::new(),
        };
        let place = portal.wall.as_ref().map(|w| place(&w.place));
        let what = match (portal.kind, &portal.name, place) {
            ("border", _, _) => return format!("the border of two cells at {at}"),
            (kind, Some(name), _) => format!("the {kind} \"{name}\""),
            ("sector edge", None, Some(place)) if place.starts_with("linedef") => place,
            ("sector edge", None, Some(place)) => format!("the edge ({place})"),
            (kind, None, Some(place)) => format!("the {kind} ({place})"),
            (kind, None, None) => format!("the {kind}"),
        };
        format!("{what}{rooms} at {at}")
    }

    fn end(&self, end: &EndRecord) -> String {
        let at = self.point(end.point);
        if let Some(opening) = &end.opening {
            return format!("the side of {} at {at}", self.named(opening));
        }
        let places: Vec<String> = end.walls.iter().take(2).map(|w| place(&w.place)).collect();
        let places = if places.is_empty() {
            String::new()
        } else {
            format!(" ({})", joined(&places))
        };
        match end.kind {
            "corner" if end.walls.len() == 1 => format!("the wall's end at {at}{places}"),
            "corner" => format!("the corner at {at}{places}"),
            "wall" => format!("the wall at {at}{places}"),
            _ => format!("the corner of cells at {at}, where no wall stands"),
        }
    }

    fn named(&self, opening: &OpeningRecord) -> String {
        let kind = opening.kind;
        match (&opening.name, &opening.rooms[..]) {
            (Some(name), _) => format!("the {kind} \"{name}\""),
            (None, [a, b]) => format!("the {kind} between {} and {}", quoted(a), quoted(b)),
            (None, [a]) => format!("the {kind} of {}", quoted(a)),
            (None, _) => format!("the {kind} ({})", place(&opening.place)),
        }
    }

    fn wall(&self, wall: &WallRecord) -> String {
        let [from, to] = [wall.from, wall.to].map(|p| self.point(p));
        let of = match &wall.room {
            Some(room) => format!(" of {}", quoted(room)),
            None => String::new(),
        };
        format!("the wall{of} from {from} to {to} ({})", place(&wall.place))
    }

    fn doors_open(&self, lines: &mut Lines, open: &OpenRecord) {
        let doors: Vec<String> = open.doors.iter().map(|d| self.portal(d)).collect();
        if open.visible {
            lines.say(
                "Doors",
                "with open doors the one would see the other, through",
            );
            lines.list("", &shortened(&doors, |d| format!("  {d}")));
        } else if open.connected {
            lines.say(
                "Doors",
                "with open doors there would be a way but no sight, through",
            );
            lines.list("", &shortened(&doors, |d| format!("  {d}")));
        } else {
            lines.say("Doors", "opening them would not join the two either");
        }
    }
}

/// The first and last of many.
fn shortened<T>(all: &[T], word: impl Fn(&T) -> String) -> Vec<String> {
    if all.len() <= LISTED {
        return all.iter().map(word).collect();
    }
    let half = LISTED / 2;
    let left_out = format!("… {} more …", all.len() - 2 * half);
    let mut items: Vec<String> = all[..half].iter().map(&word).collect();
    items.push(left_out);
    items.extend(all[all.len() - half..].iter().map(&word));
    items
}

/// `linedefs 12 and 13`, `line 3, column 8 and line 9, column 8`.
fn joined(places: &[String]) -> String {
    let places: Vec<&str> = places.iter().map(String::as_str).collect();
    match places[..] {
        [a, b] if a == b => a.to_string(),
        [a, b] => match (a.strip_prefix("linedef "), b.strip_prefix("linedef ")) {
            (Some(a), Some(b)) => format!("linedefs {a} and {b}"),
            _ => format!("{a}, and {b}"),
        },
        _ => places.join(", "),
    }
}

/// A place in the source, short.
pub(super) fn place(place: &Place) -> String {
    match place {
        Place::Text { line, .. } => format!("line {line}"),
        other => other.to_string(),
    }
}

/// A room's name in quotation marks; sectors are only numbered.
fn quoted(room: &str) -> String {
    match room.strip_prefix("sector ") {
        Some(number) if number.bytes().all(|b| b.is_ascii_digit()) => room.to_string(),
        _ => format!("'{room}'"),
    }
}
