//! The tables that `build` prints for people.

use std::fmt::Write;

use crate::cells::{CellGraph, CellId, Subdivision};
use crate::level::Level;
use crate::pvs::Pvs;
use crate::report::json::{Seconds, polygon};
use crate::report::wording::{coordinate, count, count_of, duration, grouped, in_sector, unit};

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
            count(n, "cell"),
            count(graph.portals.len(), "portal"),
            count(graph.cost.wall_splits, "wall split"),
        ),
    );
    line(
        "visibility",
        format!(
            "{}, doors {}: {} of cells, density {:.4}",
            by_method(pvs),
            graph.options.doors.as_str(),
            count(pvs.pairs() as usize, "ordered pair"),
            pvs.density(),
        ),
    );
    if pvs.heights || pvs.undecided > 0 {
        line("undecided", undecided(pvs));
    }
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
    let Seconds {
        read,
        subdivide,
        visibility,
        write,
    } = *seconds;
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

/// How many pairs are visible for want of proof, and what that means.
fn undecided(pvs: &Pvs) -> String {
    if pvs.undecided == 0 {
        return "none: each pair has a sightline, or the proof that there is none".into();
    }
    let share = 100.0 * pvs.undecided as f64 / pvs.pairs().max(1) as f64;
    format!(
        "{}, {share:.4} % of those above, counted as visible without proof: neither a sightline nor \
         the proof that there is none was found in the time and parts allowed",
        count(pvs.undecided as usize, "ordered pair"),
    )
}

/// One row of the comparison.
pub struct Compared {
    by: String,
    cells: [String; 10],
}

impl Compared {
    /// The figures of a subdivision; times in seconds, the size of its PVS file in bytes.
    pub fn new(graph: &CellGraph, pvs: &Pvs, subdivide: f64, visibility: f64, size: usize) -> Self {
        let depth = match graph.options.subdivision {
            Subdivision::Cdt => "-".to_string(),
            _ => graph.cost.depth.to_string(),
        };
        let pairs = match pvs.undecided {
            0 => grouped(pvs.pairs()),
            open => format!("{} ({} undecided)", grouped(pvs.pairs()), grouped(open)),
        };
        Compared {
            by: by_method(pvs),
            cells: [
                graph.options.subdivision.as_str().to_string(),
                grouped(graph.cells.len() as u64),
                grouped(graph.portals.len() as u64),
                grouped(graph.cost.wall_splits as u64),
                depth,
                duration(subdivide),
                pairs,
                format!("{:.4}", pvs.density()),
                duration(visibility),
                grouped(size as u64),
            ],
        }
    }
}

/// Subdivisions side by side.
pub fn of_comparison(level: &Level, rows: &[Compared]) -> String {
    let head = [
        "",
        "cells",
        "portals",
        "splits",
        "depth",
        "subdivide",
        "pairs",
        "density",
        "visibility",
        "file bytes",
    ];
    let mut out = title(level);
    _ = writeln!(out, "{}", level_figures(level));
    let by = rows.first().map_or("", |row| &row.by);
    _ = writeln!(out, "visibility by {by}\n");
    let rows: Vec<&[String]> = rows.iter().map(|r| &r.cells[..]).collect();
    out + &table(&head, &rows)
}

/// Rows under a head; the first column to the left, the others to the right.
pub fn table(head: &[&str], rows: &[&[String]]) -> String {
    let width = |i: usize| {
        let cells = rows.iter().map(|row| row[i].chars().count());
        cells.chain([head[i].chars().count()]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut out = String::new();
    let mut line = |cells: &[&str]| {
        for (i, cell) in cells.iter().enumerate() {
            let pad = " ".repeat(widths[i] - cell.chars().count());
            _ = if i == 0 {
                write!(out, "{cell}{pad}")
            } else {
                write!(out, "  {pad}{cell}")
            };
        }
        out.push('\n');
    };
    line(head);
    for row in rows {
        line(&row.iter().map(String::as_str).collect::<Vec<_>>());
    }
    out
}

/// `sweep (exact)`; with heights, `search (conservative) in space`.
fn by_method(pvs: &Pvs) -> String {
    let space = if pvs.heights { " in space" } else { "" };
    format!("{} ({}){space}", pvs.method.as_str(), pvs.class.as_str())
}

fn title(level: &Level) -> String {
    format!("{} ({}, in {})\n", level.name, level.source, unit(level))
}

fn level_figures(level: &Level) -> String {
    let mut text = format!(
        "{}, {}, {}",
        count_of(level.n_vertices, "vertex", "vertices"),
        count(level.walls.len(), "wall"),
        count(level.sectors.len(), "sector"),
    );
    if level.snap > 0.0 {
        _ = write!(
            text,
            "; points moved by at most {:.2e} {}",
            level.snap,
            unit(level)
        );
    }
    text
}

/// The cell that sees most, with how many it sees; the first of several.
fn largest(graph: &CellGraph, pvs: &Pvs) -> Option<(CellId, usize)> {
    let sizes = graph
        .cell_ids()
        .map(|c| (c, pvs.visible.count(c.0 as usize)));
    sizes.reduce(|best, next| if next.1 > best.1 { next } else { best })
}

/// `, in Hall at (3.00, 2.00)`: the cell's room or sector, and a point inside it.
fn whereabouts(level: &Level, graph: &CellGraph, cell: CellId) -> String {
    let corners = polygon(graph, cell);
    let middle = corners.iter().sum::<glam::DVec2>() / corners.len().max(1) as f64;
    let room = in_sector(level, graph, cell);
    format!(
        "{room} at {}, {}",
        coordinate(level, middle.x),
        coordinate(level, middle.y)
    )
}
