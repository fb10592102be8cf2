//! Tables for spreadsheets and scripts: comma-separated values with a line of headings (RFC 4180).
//!
//! | table | a row for each | columns |
//! |---|---|---|
//! | `cells` | cell | `cell`, `sector`, `room`, `floor`, `ceiling`, `area`, `x`, `y` (a point inside), `corners`, `sees` (how many cells) |
//! | `visible` | cell | `cell`, `room`, `sees`, `cells` (the numbers of those that it sees, itself among them, with spaces between them) |
//! | `pairs` | pair of cells that see each other, once in each order | `from`, `to` |
//! | `portals` | portal | `portal`, `first`, `second` (cells), `x1`, `y1`, `x2`, `y2`, `bottom`, `top` |
//!
//! What is not known is empty.

use std::io::Write;

use glam::DVec2;

use super::Known;
use crate::report::json::polygon;

/// Which table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// A row for each cell.
    Cells,
    /// What each cell sees, in one row.
    Visible,
    /// A row for each pair that see each other.
    Pairs,
    /// A row for each portal.
    Portals,
}

impl Table {
    /// Whether it tells who sees whom.
    pub fn needs_pvs(self) -> bool {
        self != Table::Portals
    }
}

/// Writes a table. Without a PVS no cell sees any.
///
/// # Errors
/// Those of `out`.
pub fn write(out: impl Write, known: &Known, table: Table) -> csv::Result<()> {
    let mut rows = csv::Writer::from_writer(out);
    match table {
        Table::Cells => cells(&mut rows, known)?,
        Table::Visible => visible(&mut rows, known)?,
        Table::Pairs => pairs(&mut rows, known)?,
        Table::Portals => portals(&mut rows, known)?,
    }
    Ok(rows.flush()?)
}

type Rows<W> = csv::Writer<W>;

fn cells<W: Write>(rows: &mut Rows<W>, known: &Known) -> csv::Result<()> {
    let head = [
        "cell", "sector", "room", "floor", "ceiling", "area", "x", "y", "corners", "sees",
    ];
    rows.write_record(head)?;
    for id in known.graph.cell_ids() {
        let sector = known.sector(id);
        let number = known.graph.cell(id).sector.map(|s| s.0);
        let corners = polygon(known.graph, id);
        let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
        let sees = known.pvs.map(|pvs| pvs.seen_from(id).count());
        rows.serialize((
            id.0,
            number,
            known.room(id),
            sector.map(|s| s.floor.rest),
            sector.map(|s| s.ceiling.rest),
            known.area(id),
            middle.x,
            middle.y,
            corners.len(),
            sees,
        ))?;
    }
    Ok(())
}

fn visible<W: Write>(rows: &mut Rows<W>, known: &Known) -> csv::Result<()> {
    rows.write_record(["cell", "room", "sees", "cells"])?;
    for id in known.graph.cell_ids() {
        let seen = known.pvs.into_iter().flat_map(|pvs| pvs.seen_from(id));
        let numbers: Vec<String> = seen.map(|cell| cell.0.to_string()).collect();
        rows.serialize((id.0, known.room(id), numbers.len(), numbers.join(" ")))?;
    }
    Ok(())
}

fn pairs<W: Write>(rows: &mut Rows<W>, known: &Known) -> csv::Result<()> {
    rows.write_record(["from", "to"])?;
    for from in known.graph.cell_ids() {
        for to in known.pvs.into_iter().flat_map(|pvs| pvs.seen_from(from)) {
            rows.serialize((from.0, to.0))?;
        }
    }
    Ok(())
}

fn portals<W: Write>(rows: &mut Rows<W>, known: &Known) -> csv::Result<()> {
    let head = [
        "portal", "first", "second", "x1", "y1", "x2", "y2", "bottom", "top",
    ];
    rows.write_record(head)?;
    for (i, portal) in known.graph.portals.iter().enumerate() {
        let [first, second] = known.graph.joined(portal);
        let [p, q] = super::segment(known.graph, portal);
        rows.serialize((
            i,
            first.0,
            second.0,
            p.x,
            p.y,
            q.x,
            q.y,
            portal.bottom,
            portal.top,
        ))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::file::LevelInfo;
    use crate::pvs::{Progress, sweep::sweep};

    #[test]
    fn tables_can_be_read_again() {
        let text = "[[room]]\nname = \"A, \\\"the\\\" room\"\nrect = [0, 0, 4, 4]\n\
            [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
            [[door]]\npoints = [[4, 1], [4, 2]]\n";
        let level = read(text.into(), "a.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let pvs = sweep(&graph, &Progress::default());
        let known = Known {
            info: &LevelInfo::of(&level),
            level: Some(&level),
            graph: &graph,
            pvs: Some(&pvs),
        };
        let table = |known: &Known, table| -> Vec<Vec<String>> {
            let mut bytes = Vec::new();
            write(&mut bytes, known, table).unwrap();
            let mut rows = csv::Reader::from_reader(&*bytes);
            let row =
                |r: csv::Result<csv::StringRecord>| r.unwrap().iter().map(Into::into).collect();
            rows.records().map(row).collect()
        };
        let cells = table(&known, Table::Cells);
        assert_eq!(cells.len(), 2);
        let a = cells
            .iter()
            .find(|row| row[2] == "A, \"the\" room")
            .unwrap();
        assert_eq!(a[5..], ["16.0", "2.0", "2.0", "4", "2"]);
        assert_eq!(table(&known, Table::Pairs).len(), 4);
        assert_eq!(table(&known, Table::Visible)[1][3], "0 1");
        let portals = table(&known, Table::Portals);
        assert_eq!(portals.len(), 1);
        let mut ys = [&*portals[0][4], &*portals[0][6]];
        ys.sort();
        assert_eq!((&*portals[0][3], ys), ("4.0", ["1.0", "2.0"]));

        // Of a .pvs file, which knows no rooms.
        let bare = Known {
            level: None,
            ..known
        };
        let cells = table(&bare, Table::Cells);
        assert_eq!(cells[0][2..5], ["", "", ""]);
        assert_eq!(cells[0][9], "2");
    }
}
