//! The tables that `build` prints for people.

use std::fmt::Write;

use crate::cells::{CellGraph, CellId, Subdivision};
use crate::level::{Level, SectorId};
use crate::pvs::Pvs;
use crate::report::json::{Seconds, polygon};

/// The figures of one build, a line for each stage.
pub fn of_build(level: &Level, graph: &CellGraph, pvs: &Pvs, seconds: &Seconds) -> String {
    let n = graph.cells.len();
    let mut out = title(level);
    let mut line = |key: &str, text: String| _ = writeln!(out, "{key:<12} {text}");
    line("level", level_figures(level));
    let depth = match graph.options.subdivision {
        Subdivision::Cdt => String::new(),
        _ => format!(", depth {}", graph.cost.depth),
    };
    line(
        "subdivision",
        format!(
            "{}: {}, {}, {}{depth}",
            graph.options.subdivision.as_str(),
            count(n as u64, "cell"),
            count(graph.portals.len() as u64, "portal"),
            count(graph.cost.wall_splits as u64, "wall split"),
        ),
    );
    line(
        "visibility",
        format!(
            "{} ({}), doors {}: {} of cells, density {:.4}",
            pvs.method.as_str(),
            pvs.class.as_str(),
            graph.options.doors.as_str(),
            count(pvs.pairs(), "ordered pair"),
            pvs.density(),
        ),
    );
    if let Some((cell, size)) = largest(graph, pvs) {
        let mean = pvs.pairs() as f64 / n as f64;
        line(
            "visible set",
            format!(
                "mean {mean:.1} cells, largest {size} (from cell {}{})",
                cell.0,
                whereabouts(level, graph, cell)
            ),
        );
    }
    let Seconds { read, subdivide, visibility, write } = *seconds;
    line(
        "time",
        format!(
            "read {}, subdivide {}, visibility {}, write {}; together {}",
            duration(read),
            duration(subdivide),
            duration(visibility),
            duration(write),
            duration(read + subdivide + visibility + write),
        ),
    );
    out
}

/// One row of the comparison.
pub struct Compared {
    cells: [String; 9],
}

impl Compared {
    /// The figures of a subdivision; times in seconds.
    pub fn new(graph: &CellGraph, pvs: &Pvs, subdivide: f64, visibility: f64) -> Self {
        let depth = match graph.options.subdivision {
            Subdivision::Cdt => "-".to_string(),
            _ => graph.cost.depth.to_string(),
        };
        Compared {
            cells: [
                graph.options.subdivision.as_str().to_string(),
                grouped(graph.cells.len() as u64),
                grouped(graph.portals.len() as u64),
                grouped(graph.cost.wall_splits as u64),
                depth,
                duration(subdivide),
                grouped(pvs.pairs()),
                format!("{:.4}", pvs.density()),
                duration(visibility),
            ],
        }
    }
}

/// Subdivisions side by side.
pub fn of_comparison(level: &Level, rows: &[Compared]) -> String {
    let head = [
        "", "cells", "portals", "splits", "depth", "subdivide", "pairs", "density", "visibility",
    ];
    let mut out = title(level);
    _ = writeln!(out, "{}\n", level_figures(level));
    let width = |i: usize| {
        let cells = rows.iter().map(|r| r.cells[i].chars().count());
        cells.chain([head[i].len()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut line = |cells: &[&str]| {
        for (i, cell) in cells.iter().enumerate() {
            let pad = " ".repeat(widths[i] - cell.chars().count());
            _ = if i == 0 { write!(out, "{cell}{pad}") } else { write!(out, "  {pad}{cell}") };
        }
        out.push('\n');
    };
    line(&head);
    for row in rows {
        line(&row.cells.each_ref().map(String::as_str));
    }
    out
}

fn title(level: &Level) -> String {
    format!("{} ({}, in {})\n", level.name, level.source, plural(&level.unit))
}

/// "map units", but "m".
fn plural(unit: &str) -> String {
    if unit.len() > 2 && !unit.ends_with('s') { format!("{unit}s") } else { unit.to_string() }
}

fn level_figures(level: &Level) -> String {
    let mut text = format!(
        "{}, {}, {}",
        count_of(level.n_vertices as u64, "vertex", "vertices"),
        count(level.walls.len() as u64, "wall"),
        count(level.sectors.len() as u64, "sector"),
    );
    if level.snap > 0.0 {
        _ = write!(text, "; points moved by at most {:.2e} {}", level.snap, plural(&level.unit));
    }
    text
}

/// The cell that sees most, with how many it sees; the first of several.
fn largest(graph: &CellGraph, pvs: &Pvs) -> Option<(CellId, usize)> {
    let sizes = graph.cell_ids().map(|c| (c, pvs.visible.count(c.0 as usize)));
    sizes.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// `, in Hall at (3.00, 2.00)`: the cell's room or sector, and a point inside it.
fn whereabouts(level: &Level, graph: &CellGraph, cell: CellId) -> String {
    let corners = polygon(graph, cell);
    let middle = corners.iter().sum::<glam::DVec2>() / corners.len().max(1) as f64;
    let room = graph.cell(cell).sector.map_or_else(String::new, |id| in_sector(level, id));
    format!("{room} at {}, {}", rounded(level, middle.x), rounded(level, middle.y))
}

fn in_sector(level: &Level, id: SectorId) -> String {
    match level.sectors.get(id.0 as usize).and_then(|s| s.name.as_deref()) {
        Some(name) => format!(" in '{name}'"),
        None => format!(" in sector {}", id.0),
    }
}

/// A coordinate with digits that suit the level's unit: whole map units, or hundredths.
fn rounded(level: &Level, x: f64) -> String {
    if level.grid.step.length() >= 1.0 { format!("{x:.0}") } else { format!("{x:.2}") }
}

fn count(n: u64, what: &str) -> String {
    count_of(n, what, &format!("{what}s"))
}

fn count_of(n: u64, one: &str, many: &str) -> String {
    format!("{} {}", grouped(n), if n == 1 { one } else { many })
}

/// 15,123,456
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Three digits and a unit: 3.21 s, 45.6 ms, 789 µs.
fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s >= 1.0 => (s, "s"),
        s if s >= 1e-3 => (s * 1e3, "ms"),
        s => (s * 1e6, "µs"),
    };
    let digits = match value {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        _ => 2,
    };
    format!("{value:.digits$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(1000), "1,000");
        assert_eq!(grouped(15_123_456), "15,123,456");
        assert_eq!(duration(0.0123), "12.3 ms");
        assert_eq!(duration(125.0), "125 s");
        assert_eq!(count(1, "cell"), "1 cell");
    }
}
