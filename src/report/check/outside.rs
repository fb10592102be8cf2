//! Where a level is open to the outside.

use std::collections::BTreeSet;

use crate::cells::{CellGraph, Locator};
use crate::level::{
    Finding, Interior, Level, Opening, OpeningStyle, Place, Severity, WallId, WallKind,
};

/// Openings on the border of the inside; starts that are not inside; no inside at all.
pub fn find(level: &Level, graph: &CellGraph) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut add = |code, severity, message: &str, places: Vec<Place>| {
        findings.extend(Finding::at(code, severity, message, places));
    };
    let holes: BTreeSet<WallId> = graph
        .edges
        .iter()
        .filter(|e| e.twin().is_none())
        .filter_map(|e| e.wall())
        .collect();
    let places = |wanted: &dyn Fn(&Opening) -> bool| -> Vec<Place> {
        let walls = holes.iter().map(|w| &level.walls[w.0 as usize]);
        walls
            .filter(|w| matches!(&w.kind, WallKind::Opening(o) if wanted(o)))
            .map(|w| w.place)
            .collect()
    };
    add(
        "leak",
        Severity::Warning,
        "These archways open to the outside, where nothing is; sight ends there as at a wall.",
        places(&|o| o.style == OpeningStyle::Archway),
    );
    add(
        "opening-to-outside",
        Severity::Note,
        "These doors and windows face the outside; nothing out there counts as visible.",
        places(&|o| o.style != OpeningStyle::Archway),
    );
    let starts = match &level.interior {
        Interior::Enclosed { starts } => starts.as_slice(),
        _ => &[],
    };
    let locator = Locator::new(graph);
    let lost = starts
        .iter()
        .filter(|&&p| locator.cell_at(graph, p).is_none());
    let point = |&p| {
        let p = level.grid.to_level(p);
        Place::Point { x: p.x, y: p.y }
    };
    add(
        "open-start",
        Severity::Warning,
        "The walls around these start points have a gap to the outside (or the points lie inside \
         a pillar), so there is no inside here.",
        lost.map(point).collect(),
    );
    if graph.cells.is_empty() {
        add(
            "no-inside",
            Severity::Warning,
            "The walls enclose nothing, so the level has no inside; close their gaps.",
            level.walls.first().map(|w| w.place).into_iter().collect(),
        );
    }
    findings
}
