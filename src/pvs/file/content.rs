//! The sections' contents, written and read; the layout is in the module above.

use super::sections::{Expected, Reader};
use super::{FileError, LevelInfo, PvsFile, Section, Sections};
use crate::cells::{
    Cell, CellGraph, CellId, Cost, Doors, Edge, EdgeId, Options, Portal, Subdivision,
};
use crate::geom::{GRID_LIMIT, Grid, Step, Vertex, VertexId};
use crate::level::{SectorId, WallId};
use crate::pvs::{BitMatrix, Class, Method, Pvs};

/// More than `INFO` ever has: names are not that long.
const INFO_LIMIT: u64 = 1 << 20;
/// Exponents of the grid's step up to here have a step that f64 can tell.
const STEP_LIMIT: i32 = 300;
/// Homogeneous w of a vertex is smaller than this.
const W_LIMIT: i64 = 1 << 54;

/// All sections, in the order of the file.
pub(super) fn sections(info: &LevelInfo, graph: &CellGraph, pvs: &Pvs) -> Vec<Section> {
    vec![
        (*b"INFO", write_info(info, graph, pvs)),
        (*b"VERT", write_coordinates(graph)),
        (*b"EXAC", write_vertices(graph)),
        (*b"CELL", write_cells(graph)),
        (*b"ALSO", write_also(graph)),
        (*b"EDGE", write_edges(graph)),
        (*b"PORT", write_portals(graph)),
        (*b"VISI", write_visible(pvs)),
    ]
}

/// The file that the sections describe.
pub(super) fn read(sections: &Sections) -> Result<PvsFile, FileError> {
    let head = Head::read(sections)?;
    let content = |tag, count: u32, bytes: u64| {
        sections.content(tag, Expected::Exactly(u64::from(count) * bytes))
    };
    let [n_vertices, n_cells, n_edges, n_portals, n_also] = head.counts;
    // The coordinates follow from the exact vertices; only their number is of interest here.
    content("VERT", n_vertices, 16)?;
    let vertices = read_vertices(&content("EXAC", n_vertices, 40)?)?;
    let cells = read_cells(
        &content("CELL", n_cells, 16)?,
        &content("ALSO", n_also, 4)?,
        head.info.sectors,
    )?;
    let edges = read_edges(&content("EDGE", n_edges, 12)?, &cells, head.info.walls)?;
    let portals = read_portals(&content("PORT", n_portals, 40)?)?;
    let (grid, options, cost) = (head.grid, head.options, head.cost);
    let graph = CellGraph::from_parts(grid, options, vertices, cells, edges, portals, cost)?;
    // Before the matrix is made: convex cells side by side need bytes in the file, so their number
    // bounds its size.
    graph.validate().map_err(FileError::Cells)?;
    let visible = read_visible(sections, n_cells)?;
    let pvs = Pvs {
        visible,
        ..head.pvs
    };
    pvs.validate(&graph).map_err(FileError::Visible)?;
    Ok(PvsFile {
        info: head.info,
        graph,
        pvs,
    })
}

fn write_info(info: &LevelInfo, graph: &CellGraph, pvs: &Pvs) -> Vec<u8> {
    let mut out = Vec::new();
    let also: usize = graph.cells.iter().map(|c| c.also.len()).sum();
    let counts = [
        graph.vertices.len(),
        graph.cells.len(),
        graph.edges.len(),
        graph.portals.len(),
        also,
    ];
    for n in counts {
        out.extend((n as u32).to_le_bytes());
    }
    for n in [info.vertices, info.walls, info.sectors, info.fingerprint] {
        out.extend(n.to_le_bytes());
    }
    let (kind, k) = match graph.grid.step {
        Step::Decimal(k) => (0u32, k),
        Step::Binary(k) => (1, k),
    };
    out.extend(kind.to_le_bytes());
    out.extend(k.to_le_bytes());
    let flags = u32::from(graph.cost.fallback) | u32::from(pvs.heights) << 1;
    out.extend(flags.to_le_bytes());
    for n in graph.grid.origin {
        out.extend(n.to_le_bytes());
    }
    out.extend(info.snap.to_le_bytes());
    out.extend(pvs.undecided.to_le_bytes());
    out.extend(pvs.steps.to_le_bytes());
    for n in [graph.cost.pieces, graph.cost.wall_splits, graph.cost.depth] {
        out.extend(u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
    }
    let names = [
        &info.name,
        &info.source,
        &info.unit,
        graph.options.subdivision.as_str(),
        pvs.method.as_str(),
        pvs.class.as_str(),
        graph.options.doors.as_str(),
    ];
    for name in names {
        // A name of more than 64 KiB is cut, at a character.
        let end = (0..=name.len().min(1 << 16)).rfind(|&i| name.is_char_boundary(i));
        let name = &name[..end.unwrap_or(0)];
        out.extend((name.len() as u32).to_le_bytes());
        out.extend(name.as_bytes());
    }
    out
}

/// What `INFO` says.
struct Head {
    /// Vertices, cells, edges, portals, further sectors.
    counts: [u32; 5],
    info: LevelInfo,
    grid: Grid,
    options: Options,
    cost: Cost,
    /// Its matrix still empty.
    pvs: Pvs,
}

impl Head {
    fn read(sections: &Sections) -> Result<Self, FileError> {
        let content = sections.content("INFO", Expected::AtMost(INFO_LIMIT))?;
        let mut reader = Reader {
            tag: "INFO",
            rest: &content,
        };
        let mut counts = [0; 5];
        for n in &mut counts {
            *n = reader.u32()?;
        }
        let [vertices, walls, sectors, fingerprint] =
            [reader.u32()?, reader.u32()?, reader.u32()?, reader.u32()?];
        let value = |part, what| FileError::Value {
            tag: "INFO",
            part,
            index: 0,
            what,
        };
        let (kind, k) = (reader.u32()?, reader.i32()?);
        let step = match kind {
            _ if k.unsigned_abs() > STEP_LIMIT as u32 => {
                return Err(value("step", "has an impossible exponent"));
            }
            0 => Step::Decimal(k),
            1 => Step::Binary(k),
            _ => return Err(value("step", "is of an unknown kind")),
        };
        let flags = reader.u32()?;
        if flags > 3 {
            return Err(value("flag", "is unknown"));
        }
        let grid = Grid {
            step,
            origin: [reader.i64()?, reader.i64()?],
        };
        let snap = reader.f64()?;
        let (undecided, steps) = (reader.u64()?, reader.u64()?);
        let cost = Cost {
            pieces: reader.u32()? as usize,
            wall_splits: reader.u32()? as usize,
            depth: reader.u32()? as usize,
            fallback: flags & 1 != 0,
        };
        let mut names: [String; 7] = Default::default();
        for (index, name) in names.iter_mut().enumerate() {
            let length = reader.u32()? as usize;
            let text = std::str::from_utf8(reader.take(length)?).map_err(|_| FileError::Value {
                tag: "INFO",
                part: "string",
                index,
                what: "is no UTF-8",
            })?;
            *name = text.to_string();
        }
        reader.finish()?;
        let [name, source, unit, subdivision, method, class, doors] = names;
        let options = Options {
            subdivision: known("subdivision", subdivision, &Subdivision::ALL, |s| {
                s.as_str()
            })?,
            doors: known("doors", doors, &[Doors::Open, Doors::Closed], |d| {
                d.as_str()
            })?,
            ..Options::default()
        };
        let pvs = Pvs {
            visible: BitMatrix::new(0),
            method: known("method", method, &Method::ALL, |m| m.as_str())?,
            class: known("class", class, &Class::ALL, |c| c.as_str())?,
            heights: flags & 2 != 0,
            undecided,
            steps,
        };
        let info = LevelInfo {
            name,
            source,
            unit,
            snap,
            vertices,
            walls,
            sectors,
            fingerprint,
        };
        Ok(Self {
            counts,
            info,
            grid,
            options,
            cost,
            pvs,
        })
    }
}

/// The one of `all` that has this name.
fn known<T: Copy>(
    what: &'static str,
    name: String,
    all: &[T],
    as_str: impl Fn(T) -> &'static str,
) -> Result<T, FileError> {
    let found = all.iter().copied().find(|&one| as_str(one) == name);
    found.ok_or(FileError::Unknown { what, name })
}

fn write_coordinates(graph: &CellGraph) -> Vec<u8> {
    let points = graph.vertices.iter().map(|v| v.to_level(&graph.grid));
    points
        .flat_map(|p| [p.x, p.y])
        .flat_map(f64::to_le_bytes)
        .collect()
}

fn write_vertices(graph: &CellGraph) -> Vec<u8> {
    let mut out = Vec::with_capacity(graph.vertices.len() * 40);
    for v in graph.vertices.iter() {
        out.extend(v.x().to_le_bytes());
        out.extend(v.y().to_le_bytes());
        out.extend(v.w().to_le_bytes());
    }
    out
}

/// The vertices, each in lowest terms, on the grid, and of the widths that the predicates are proved
/// for.
fn read_vertices(content: &[u8]) -> Result<Vec<Vertex>, FileError> {
    let mut reader = Reader {
        tag: "EXAC",
        rest: content,
    };
    let mut vertices = Vec::with_capacity(content.len() / 40);
    for index in 0..content.len() / 40 {
        let (x, y, w) = (reader.i128()?, reader.i128()?, reader.i64()?);
        let wrong = |what| FileError::Value {
            tag: "EXAC",
            part: "vertex",
            index,
            what,
        };
        if w <= 0 || w >= W_LIMIT {
            return Err(wrong("has an impossible w"));
        }
        let limit = i128::from(GRID_LIMIT) * i128::from(w);
        if x.unsigned_abs() > limit.unsigned_abs() || y.unsigned_abs() > limit.unsigned_abs() {
            return Err(wrong("lies off the grid"));
        }
        let vertex = Vertex::homogeneous(x, y, w).filter(|v| v.w() == w);
        vertices.push(vertex.ok_or_else(|| wrong("is not in lowest terms"))?);
    }
    Ok(vertices)
}

fn write_cells(graph: &CellGraph) -> Vec<u8> {
    let mut out = Vec::with_capacity(graph.cells.len() * 16);
    for id in graph.cell_ids() {
        let (range, cell) = (graph.edge_range(id), graph.cell(id));
        let sector = cell.sector.map_or(u32::MAX, |s| s.0);
        for n in [
            range.start,
            range.end - range.start,
            sector,
            cell.also.len() as u32,
        ] {
            out.extend(n.to_le_bytes());
        }
    }
    out
}

fn write_also(graph: &CellGraph) -> Vec<u8> {
    let sectors = graph.cells.iter().flat_map(|c| &c.also);
    sectors.flat_map(|s| s.0.to_le_bytes()).collect()
}

fn read_cells(content: &[u8], also: &[u8], n_sectors: u32) -> Result<Vec<Cell>, FileError> {
    let mut reader = Reader {
        tag: "CELL",
        rest: content,
    };
    let mut others = Reader {
        tag: "ALSO",
        rest: also,
    };
    let mut cells = Vec::with_capacity(content.len() / 16);
    for index in 0..content.len() / 16 {
        let (first, n) = (reader.u32()?, reader.u32()?);
        let (sector, n_also) = (reader.option()?, reader.u32()?);
        let also = (0..n_also).map(|_| Ok(SectorId(others.u32()?)));
        let also = also.collect::<Result<Vec<_>, FileError>>()?;
        let mut sectors = sector.iter().copied().chain(also.iter().map(|s| s.0));
        if sectors.any(|s| s >= n_sectors) {
            let what = "lies in a sector that the level does not have";
            return Err(FileError::Value {
                tag: "CELL",
                part: "cell",
                index,
                what,
            });
        }
        cells.push(Cell::new(first, n, sector.map(SectorId), also));
    }
    others.finish()?;
    Ok(cells)
}

fn write_edges(graph: &CellGraph) -> Vec<u8> {
    let mut out = Vec::with_capacity(graph.edges.len() * 12);
    for edge in &graph.edges {
        let twin = edge.twin().map_or(u32::MAX, |t| t.0);
        let wall = edge.wall().map_or(u32::MAX, |w| w.0);
        for n in [edge.origin.0, twin, wall] {
            out.extend(n.to_le_bytes());
        }
    }
    out
}

fn read_edges(content: &[u8], cells: &[Cell], n_walls: u32) -> Result<Vec<Edge>, FileError> {
    let mut reader = Reader {
        tag: "EDGE",
        rest: content,
    };
    let n = content.len() / 12;
    let mut edges = Vec::with_capacity(n);
    // A file's edges follow the cells' order; whether their numbers agree is asked by `from_parts`.
    let mut owners = (0u32..)
        .zip(cells)
        .flat_map(|(i, cell)| std::iter::repeat_n(CellId(i), cell.n_edges() as usize));
    for index in 0..n {
        let (origin, twin, wall) = (reader.u32()?, reader.option()?, reader.option()?);
        let wrong = |what| FileError::Value {
            tag: "EDGE",
            part: "edge",
            index,
            what,
        };
        let cell = owners.next().ok_or_else(|| wrong("belongs to no cell"))?;
        if wall.is_some_and(|w| w >= n_walls) {
            return Err(wrong("lies on a wall that the level does not have"));
        }
        edges.push(Edge::new(
            VertexId(origin),
            cell,
            twin.map(EdgeId),
            wall.map(WallId),
        ));
    }
    Ok(edges)
}

fn write_portals(graph: &CellGraph) -> Vec<u8> {
    let mut out = Vec::with_capacity(graph.portals.len() * 40);
    for portal in &graph.portals {
        for edge in portal.edges {
            out.extend(edge.0.to_le_bytes());
        }
        let widest = portal
            .widest
            .map_or([None; 2], |(low, high)| [Some(low), Some(high)]);
        for z in [portal.bottom, portal.top, widest[0], widest[1]] {
            out.extend(z.unwrap_or(f64::NAN).to_le_bytes());
        }
    }
    out
}

fn read_portals(content: &[u8]) -> Result<Vec<Portal>, FileError> {
    let mut reader = Reader {
        tag: "PORT",
        rest: content,
    };
    let mut portals = Vec::with_capacity(content.len() / 40);
    for index in 0..content.len() / 40 {
        let edges = [EdgeId(reader.u32()?), EdgeId(reader.u32()?)];
        let mut heights = [None; 4];
        for z in &mut heights {
            *z = Some(reader.f64()?).filter(|z| !z.is_nan());
        }
        let [bottom, top, low, high] = heights;
        if low.is_some() != high.is_some() {
            let what = "has half an opening at its widest";
            return Err(FileError::Value {
                tag: "PORT",
                part: "portal",
                index,
                what,
            });
        }
        portals.push(Portal {
            edges,
            bottom,
            top,
            widest: low.zip(high),
        });
    }
    Ok(portals)
}

/// Bytes of row i of the lower triangle.
fn row_bytes(i: usize) -> usize {
    (i + 1).div_ceil(8)
}

fn write_visible(pvs: &Pvs) -> Vec<u8> {
    let n = pvs.visible.n();
    let mut out = Vec::with_capacity((0..n).map(row_bytes).sum());
    for i in 0..n {
        let words = pvs.visible.row(i).iter();
        out.extend(words.flat_map(|w| w.to_le_bytes()).take(row_bytes(i)));
        let used = (i + 1) % 8;
        if let Some(last) = out.last_mut().filter(|_| used != 0) {
            *last &= (1 << used) - 1;
        }
    }
    out
}

fn read_visible(sections: &Sections, n_cells: u32) -> Result<BitMatrix, FileError> {
    let n = u64::from(n_cells);
    // Rows of 1 byte, eight times, then of 2 bytes, and so on.
    let (whole, part) = (n / 8, n % 8);
    let bytes = 4 * whole * (whole + 1) + part * (whole + 1);
    let content = sections.content("VISI", Expected::Exactly(bytes))?;
    let mut reader = Reader {
        tag: "VISI",
        rest: &content,
    };
    let n = n_cells as usize;
    let mut visible = BitMatrix::new(n);
    for i in 0..n {
        let row = reader.take(row_bytes(i))?;
        let last = row[row.len() - 1];
        let wrong = |what| FileError::Value {
            tag: "VISI",
            part: "row",
            index: i,
            what,
        };
        // Bit i is the highest one of the row.
        match u32::from(last).checked_ilog2() {
            Some(highest) if highest as usize == i % 8 => {}
            Some(highest) if highest as usize > i % 8 => {
                return Err(wrong("names cells past its end"));
            }
            _ => return Err(wrong("says that a cell does not see itself")),
        }
        for (k, chunk) in row.chunks(8).enumerate() {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            visible.row_mut(i)[k] = u64::from_le_bytes(word);
        }
    }
    mirror(&mut visible);
    Ok(visible)
}

/// Completes a lower triangle to the symmetric matrix.
fn mirror(matrix: &mut BitMatrix) {
    let mut seen = Vec::new();
    for i in 1..matrix.n() {
        seen.clear();
        seen.extend(matrix.ones(i).take_while(|&j| j < i));
        for &j in &seen {
            matrix.set(j, i);
        }
    }
}
