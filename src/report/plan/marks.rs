//! Marks on the plan where something was found: a ring at each place, and what it is beside some.
//!
//! In: findings. Out: a group of rings. Notes are not marked. A place that is no point on the plan (a
//! line of the file, a linedef) is marked in the middle of the walls that come from there.

use svg::node::element::{Circle, Group};

use super::sheet::{Sheet, short};
use super::text;
use crate::level::{Finding, Level, Place, Severity};

/// How many places of one finding say what it is; the others are rings alone.
const NAMED: usize = 3;

/// The most rings of one finding.
const MOST: usize = 500;

/// Draws the marks.
pub(super) fn of_findings(level: &Level, findings: &[Finding], sheet: &Sheet) -> Group {
    let mut group = Group::new().set("class", "findings");
    let [corner, size] = sheet.frame();
    let on_page =
        |p: &glam::DVec2| p.cmpge(corner - 1.0).all() && p.cmple(corner + size + 1.0).all();
    let mut words: Vec<glam::DVec2> = Vec::new();
    for finding in findings {
        let colour = match finding.severity {
            Severity::Note => continue,
            Severity::Warning => "#c8102e",
            Severity::Repaired => "#d98200",
        };
        let places = finding.places.iter().take(MOST);
        let points = places.flat_map(|place| points(level, place)).take(MOST);
        let points = points.filter_map(|p| Some(sheet.at(level.grid.fine(p)?.approx())));
        for (i, p) in points.filter(on_page).enumerate() {
            let ring = Circle::new()
                .set("cx", short(p.x))
                .set("cy", short(p.y))
                .set("r", 9)
                .set("fill", "none")
                .set("stroke", colour)
                .set("stroke-width", 2.5);
            group = group.add(ring);
            if i < NAMED {
                // Words of findings at one place stand one below the other.
                let mut at = p + glam::DVec2::new(13.0, -8.0);
                while words
                    .iter()
                    .any(|w| (w.y - at.y).abs() < 14.0 && (w.x - at.x).abs() < 120.0)
                {
                    at.y += 16.0;
                }
                words.push(at);
                let word = text(finding.code, at.x, at.y, 15.0).set("fill", colour);
                group = group.add(word);
            }
        }
    }
    group
}

/// Where a place is on the plan, in the level's own coordinates.
fn points(level: &Level, place: &Place) -> Vec<glam::DVec2> {
    if let Place::Point { x, y } = *place {
        return vec![glam::DVec2::new(x, y)];
    }
    let there = level.walls.iter().filter(|w| w.place == *place).take(1);
    let middle = |w: &crate::level::Wall| {
        let [a, b] = [w.from, w.to].map(|p| level.grid.to_level(p));
        a.midpoint(b)
    };
    there.map(middle).collect()
}
