//! Rooms that nobody can walk to.

use crate::cells::{CellGraph, CellId};
use crate::level::{Finding, Interior, Level, OpeningStyle, Place, SectorId, Severity, WallKind};

/// How many names a message lists.
const NAMES: usize = 6;

/// Parts of the level that portals, windows left out, do not join with the largest part. Heights do
/// not count: a ledge is reached like a step.
pub fn find(level: &Level, graph: &CellGraph) -> Vec<Finding> {
    let part = parts(graph, |edge| {
        let wall = graph
            .edge(edge)
            .wall()
            .map(|w| &level.walls[w.0 as usize].kind);
        !matches!(wall, Some(WallKind::Opening(o)) if o.style == OpeningStyle::Window)
    });
    let mut area = vec![0.0; graph.cells.len()];
    for cell in graph.cell_ids() {
        area[part[cell.0 as usize] as usize] += graph.area(cell);
    }
    let Some(main) = (0..area.len()).max_by(|&i, &j| area[i].total_cmp(&area[j]).then(j.cmp(&i)))
    else {
        return Vec::new();
    };
    let sectors_of = |wanted: &dyn Fn(usize) -> bool| {
        let cells = graph
            .cell_ids()
            .filter(|c| wanted(part[c.0 as usize] as usize));
        let mut sectors: Vec<SectorId> = cells.filter_map(|c| graph.cell(c).sector).collect();
        sectors.sort();
        sectors.dedup();
        sectors
    };
    let reached = sectors_of(&|p| p == main);
    let mut places = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for p in (0..area.len()).filter(|&p| p != main && area[p] > 0.0) {
        let sectors: Vec<SectorId> = sectors_of(&|q| q == p)
            .into_iter()
            .filter(|s| !reached.contains(s))
            .collect();
        let named = |s: &SectorId| level.sectors.get(s.0 as usize)?.name.as_deref();
        let own: Vec<&str> = sectors.iter().filter_map(named).collect();
        if own.is_empty() {
            // Unnamed sectors, or a cut-off piece of a reached one: one place for the whole part.
            places.push(
                match sectors
                    .first()
                    .and_then(|s| level.sectors.get(s.0 as usize))
                {
                    Some(sector) => sector.place,
                    None => middle(graph, largest(graph, &part, p)),
                },
            );
        } else {
            let rooms = sectors
                .iter()
                .filter_map(|s| level.sectors.get(s.0 as usize));
            places.extend(rooms.map(|s| s.place));
            names.extend(own);
        }
    }
    if places.is_empty() {
        return Vec::new();
    }
    // Maps with numbered sectors have such parts on purpose: closets and other rooms that one is
    // carried to.
    let severity = if level.interior == Interior::Sides {
        Severity::Note
    } else {
        Severity::Warning
    };
    let listed = match names.len() {
        0 => String::new(),
        n if n > NAMES => format!(" ({} and {} more)", names[..NAMES].join(", "), n - NAMES),
        _ => format!(" ({})", names.join(", ")),
    };
    let message = format!(
        "No door, archway or open border joins these parts with the largest part of the \
         level{listed}."
    );
    vec![Finding {
        code: "unreachable",
        severity,
        message,
        places,
    }]
}

/// For each cell the smallest cell that it is joined with, through portals of which `open` holds.
fn parts(graph: &CellGraph, open: impl Fn(crate::cells::EdgeId) -> bool) -> Vec<u32> {
    let mut part = vec![u32::MAX; graph.cells.len()];
    for first in graph.cell_ids() {
        let mut queue = vec![first];
        while let Some(cell) = queue.pop() {
            if part[cell.0 as usize] != u32::MAX {
                continue;
            }
            part[cell.0 as usize] = first.0;
            for edge in graph.edge_range(cell).map(crate::cells::EdgeId) {
                if let Some(twin) = graph.edge(edge).twin().filter(|_| open(edge)) {
                    queue.push(graph.edge(twin).cell);
                }
            }
        }
    }
    part
}

fn largest(graph: &CellGraph, part: &[u32], wanted: usize) -> CellId {
    let cells = graph
        .cell_ids()
        .filter(|c| part[c.0 as usize] as usize == wanted);
    cells
        .max_by(|&a, &b| graph.area(a).total_cmp(&graph.area(b)))
        .unwrap_or(CellId(wanted as u32))
}

/// A point inside a cell.
pub fn middle(graph: &CellGraph, cell: CellId) -> Place {
    let corners = graph.polygon(cell);
    let sum: glam::DVec2 = corners.iter().map(|&v| graph.vertices.approx(v)).sum();
    let p = sum / corners.len().max(1) as f64;
    let p = graph.grid.offset_to_level(p.x, p.y);
    // Three digits find a place; seventeen only look exact.
    let short = |x: f64| (x * 1000.0).round() / 1000.0;
    Place::Point {
        x: short(p.x),
        y: short(p.y),
    }
}
