//! The walk from the eye through the portals.

use smallvec::SmallVec;

use super::{Cone, OWN, Outside, Piece, Stretch, Wedge};
use crate::cells::CellId;
use crate::geom::pencil::{Pencil, Ray};
use crate::geom::{Placed, Side};
use crate::pvs::flat::{FlatEdge, FlatMesh, WALL};

/// Room for one look after the other; afterwards it holds what was seen.
#[derive(Default)]
pub struct Scratch {
    /// Cells seen, own ones first.
    pub(super) seen: Vec<CellId>,
    pub(super) n_own: usize,
    pub(super) pieces: Vec<Piece>,
    /// The edges of own cells within the cone, in the order of directions but for where that starts.
    pub(super) starts: Vec<Stretch>,
    /// The walls that end the view, in the order of directions but for where that starts.
    pub(super) walls: Vec<Stretch>,
    frames: Vec<Frame>,
    /// For each cell, when it was last seen.
    marks: Vec<Mark>,
    look: u32,
}

#[derive(Clone, Copy)]
struct Mark {
    look: u32,
    /// The last of the cell's pieces in that look, [`NO_PIECE`] if the eye touches the cell.
    piece: u32,
}

const NO_PIECE: u32 = u32::MAX;

/// A cell entered, of which some edges remain to be looked at.
struct Frame {
    edge: u32,
    low: Ray,
    high: Ray,
}

/// Where the eye is, for one cell.
#[derive(PartialEq)]
enum Place {
    Inside,
    Border,
    Outside,
}

/// Cells with more edges than this are searched by halving instead of one edge after the other.
const MANY_EDGES: u32 = 16;

impl Scratch {
    /// Finds what is seen. `near` are the cells that may touch the eye.
    pub(super) fn look(
        &mut self,
        mesh: &FlatMesh,
        pencil: &Pencil,
        near: &[CellId],
        cone: &Cone,
    ) -> Result<(), Outside> {
        self.clear(mesh.graph.cells.len());
        let inside = self.locate(mesh, pencil, near);
        if self.seen.is_empty() {
            return Err(Outside);
        }
        self.n_own = self.seen.len();
        self.begin(mesh, pencil, cone, inside);
        for i in 0..self.starts.len() {
            let Stretch { edge, wedge } = self.starts[i];
            let twin = mesh.edge(edge).twin;
            if twin == WALL {
                self.end_at(edge, wedge);
            } else {
                let (low, high) = (pencil.unpack(wedge.low), pencil.unpack(wedge.high));
                self.walk(mesh, pencil, twin, low, high);
            }
        }
        Ok(())
    }

    fn clear(&mut self, n_cells: usize) {
        self.seen.clear();
        self.pieces.clear();
        self.starts.clear();
        self.walls.clear();
        if self.marks.len() != n_cells || self.look == u32::MAX {
            let never = Mark {
                look: 0,
                piece: NO_PIECE,
            };
            self.marks.clear();
            self.marks.resize(n_cells, never);
            self.look = 0;
        }
        self.look += 1;
    }

    /// Marks the cells that touch the eye; whether it is inside of one.
    fn locate(&mut self, mesh: &FlatMesh, pencil: &Pencil, near: &[CellId]) -> bool {
        for &cell in near {
            match place(mesh, pencil, cell) {
                Place::Outside => {}
                Place::Border => self.own(cell),
                Place::Inside => {
                    self.own(cell);
                    return true;
                }
            }
        }
        false
    }

    fn own(&mut self, cell: CellId) {
        self.marks[cell.0 as usize] = Mark {
            look: self.look,
            piece: NO_PIECE,
        };
        self.seen.push(cell);
    }

    /// The edges of the eye's own cells, as far as they lie within the cone, and the cells' pieces.
    fn begin(&mut self, mesh: &FlatMesh, pencil: &Pencil, cone: &Cone, inside: bool) {
        let edges = cone.edges().map(|_| [pencil.free(0), pencil.free(1)]);
        if inside {
            let first = mesh.graph.edge_range(self.seen[0]).start;
            self.add_starts(mesh, pencil, edges, first);
        } else {
            // Cells around the eye, in the order of directions.
            let mut own: SmallVec<[(u32, Ray); 8]> = SmallVec::new();
            for &cell in &self.seen {
                let first = first_facing(mesh, pencil, cell);
                own.push((first, pencil.ray(&origin(mesh, first))));
            }
            own.sort_unstable_by(|a, b| pencil.turn_order(&a.1, &b.1));
            for (first, _) in own {
                self.add_starts(mesh, pencil, edges, first);
            }
        }
        // Starting with the cone, if it starts in here.
        let n = self.starts.len();
        let joined = |a: &Stretch, b: &Stretch| a.wedge.high == b.wedge.low;
        if let Some(gap) = (0..n).find(|&i| !joined(&self.starts[(i + n - 1) % n], &self.starts[i]))
        {
            self.starts.rotate_left(gap);
        }
        // A piece for each run of edges of one cell.
        let cell_of = |start: &Stretch| mesh.edge(start.edge).cell;
        let mut i = 0;
        while i < n {
            let cell = cell_of(&self.starts[i]);
            let mut last = i;
            while last + 1 < n
                && cell_of(&self.starts[last + 1]) == cell
                && joined(&self.starts[last], &self.starts[last + 1])
            {
                last += 1;
            }
            self.pieces.push(Piece {
                cell: CellId(cell),
                entry: OWN,
                wedge: Wedge {
                    low: self.starts[i].wedge.low,
                    high: self.starts[last].wedge.high,
                },
            });
            i = last + 1;
        }
    }

    /// Adds the edges of the cell of edge `first`, counterclockwise from that one.
    fn add_starts(&mut self, mesh: &FlatMesh, pencil: &Pencil, cone: Option<[Ray; 2]>, first: u32) {
        let mut from = pencil.ray(&origin(mesh, first));
        let mut edge = first;
        loop {
            let to = pencil.ray(&mesh.edge(edge).end);
            // An edge in line with the eye is not seen.
            if pencil.is_left(&from, &to) {
                let mut add = |low: Ray, high: Ray| {
                    let (low, high) = (low.pack(), high.pack());
                    let wedge = Wedge { low, high };
                    self.starts.push(Stretch { edge, wedge });
                };
                match cone {
                    None => add(from, to),
                    Some(cone) => clip(pencil, [from, to], cone, &mut add),
                }
            }
            from = to;
            edge = mesh.edge(edge).next(edge);
            if edge == first {
                break;
            }
        }
    }

    /// Enters a cell through its edge `entry`, and walks on, depth first and counterclockwise. The
    /// open wedge between `low` and `high` is not empty, and lies within the entry.
    fn walk(&mut self, mesh: &FlatMesh, pencil: &Pencil, entry: u32, low: Ray, high: Ray) {
        let (mut low, mut high) = (low, high);
        let mut e = self.enter(mesh, pencil, entry, &low, &high);
        loop {
            let edge = mesh.edge(e);
            let end = pencil.ray(&edge.end);
            let more = pencil.is_left(&end, &high);
            if edge.twin == WALL {
                let wedge = Wedge {
                    low: low.pack(),
                    high: if more { end.pack() } else { high.pack() },
                };
                self.end_at(e, wedge);
                if more {
                    low = end;
                    e = edge.next(e);
                    continue;
                }
            } else {
                if more {
                    self.frames.push(Frame {
                        edge: edge.next(e),
                        low: end,
                        high,
                    });
                    high = end;
                }
                e = self.enter(mesh, pencil, edge.twin, &low, &high);
                continue;
            }
            let Some(frame) = self.frames.pop() else {
                break;
            };
            (e, low, high) = (frame.edge, frame.low, frame.high);
        }
    }

    /// Notes a cell entered; the edge of it that the wedge's first directions meet.
    #[inline]
    fn enter(
        &mut self,
        mesh: &FlatMesh,
        pencil: &Pencil,
        entry: u32,
        low: &Ray,
        high: &Ray,
    ) -> u32 {
        let cell = mesh.edge(entry).cell;
        let wedge = Wedge {
            low: low.pack(),
            high: high.pack(),
        };
        let mark = &mut self.marks[cell as usize];
        let before = if mark.look == self.look {
            self.pieces.get_mut(mark.piece as usize)
        } else {
            self.seen.push(CellId(cell));
            None
        };
        match before {
            Some(piece) if piece.wedge.high == wedge.low => piece.wedge.high = wedge.high,
            _ => {
                *mark = Mark {
                    look: self.look,
                    piece: self.pieces.len() as u32,
                };
                self.pieces.push(Piece {
                    cell: CellId(cell),
                    entry,
                    wedge,
                });
            }
        }
        first_met(mesh, pencil, entry, low)
    }

    /// Notes that a wall ends the view in a wedge.
    #[inline]
    fn end_at(&mut self, edge: u32, wedge: Wedge) {
        match self.walls.last_mut() {
            Some(last) if last.edge == edge && last.wedge.high == wedge.low => {
                last.wedge.high = wedge.high;
            }
            _ => self.walls.push(Stretch { edge, wedge }),
        }
    }
}

/// The first edge counterclockwise after `entry`, through which rays enter the cell, that ends
/// beyond the ray `low`. Seen from the eye, those ends turn from the entry's right end to its left.
#[inline]
pub(super) fn first_met(mesh: &FlatMesh, pencil: &Pencil, entry: u32, low: &Ray) -> u32 {
    let entered_by = mesh.edge(entry);
    let FlatEdge { first, past, .. } = *entered_by;
    let beyond = |e: u32| pencil.is_left(low, &pencil.ray(&mesh.edge(e).end));
    let mut e = entered_by.next(entry);
    let n = past - first;
    if n > MANY_EDGES {
        let after = |k: u32| {
            if entry + k < past {
                entry + k
            } else {
                entry + k - n
            }
        };
        let (mut below, mut above) = (0, n - 1);
        while above - below > 1 {
            let middle = (below + above) / 2;
            if beyond(after(middle)) {
                above = middle;
            } else {
                below = middle;
            }
        }
        return after(above);
    }
    while !beyond(e) {
        e = entered_by.next(e);
    }
    e
}

/// The edge before, counterclockwise, in the same cell.
#[inline]
pub(super) fn previous(mesh: &FlatMesh, e: u32) -> u32 {
    let FlatEdge { first, past, .. } = *mesh.edge(e);
    if e == first { past - 1 } else { e - 1 }
}

/// Where an edge starts.
#[inline]
pub(super) fn origin(mesh: &FlatMesh, e: u32) -> Placed {
    mesh.edge(previous(mesh, e)).end
}

/// Where the eye is, as seen from a cell: inside if all edges have it strictly on their left.
fn place(mesh: &FlatMesh, pencil: &Pencil, cell: CellId) -> Place {
    let mut place = Place::Inside;
    let range = mesh.graph.edge_range(cell);
    let mut from = pencil.ray(&origin(mesh, range.start));
    for e in range {
        let to = pencil.ray(&mesh.edge(e).end);
        match pencil.side(&from, &to) {
            Side::Left => {}
            Side::On => place = Place::Border,
            Side::Right => return Place::Outside,
        }
        from = to;
    }
    place
}

/// Of a cell on whose border the eye is: the first edge, counterclockwise, not in line with the eye.
fn first_facing(mesh: &FlatMesh, pencil: &Pencil, cell: CellId) -> u32 {
    let faces = |e: u32| {
        let (from, to) = (origin(mesh, e), mesh.edge(e).end);
        pencil.is_left(&pencil.ray(&from), &pencil.ray(&to))
    };
    let mut range = mesh.graph.edge_range(cell);
    let first = range.start;
    range
        .find(|&e| faces(e) && !faces(previous(mesh, e)))
        .unwrap_or(first)
}

/// The parts of an edge within the cone, counterclockwise: none, one, or the two ends of it where the
/// cone leaves out the middle. The edge's ends are less than a half turn apart.
fn clip(pencil: &Pencil, edge: [Ray; 2], cone: [Ray; 2], add: &mut impl FnMut(Ray, Ray)) {
    let ([from, to], [low, high]) = (edge, cone);
    let left = |p: &Ray, q: &Ray| pencil.is_left(p, q);
    // From `p` up to where the cone or the edge ends.
    let mut add_from = |p: Ray| {
        let ends = left(&p, &high) && left(&high, &to);
        add(p, if ends { high } else { to });
    };
    // Up to a half turn, the cone holds what lies left of `low` and right of `high`; beyond, it
    // lacks what lies left of `high` and right of `low`.
    let in_cone = match pencil.side(&low, &high) {
        Side::Right => {
            let past_high = left(&high, &from) || pencil.same(&high, &from);
            !(past_high && left(&from, &low))
        }
        _ => pencil.same(&from, &low) || (left(&low, &from) && left(&from, &high)),
    };
    if in_cone {
        add_from(from);
    }
    if left(&from, &low) && left(&low, &to) {
        add_from(low);
    }
}
