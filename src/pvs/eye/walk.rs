//! The walk from the eye through the portals.

use super::{Cone, OWN, Outside, Piece, Stretch, Wedge};
use crate::cells::{CellGraph, CellId};
use crate::geom::pencil::{Aim, Pencil, Ray};
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
    /// Of each cell around an eye on a border: the first edge that faces it, and the ray to its start.
    around: Vec<(u32, Ray)>,
    waiting: Vec<Arrival>,
    /// For each cell, the look in which it was last seen; and the current look.
    marks: Vec<u32>,
    look: u32,
}

/// A cell entered, of which some edges remain to be looked at.
struct Frame {
    edge: u32,
    low: Ray,
    high: Ray,
}

/// A cell reached through one or more of its edges, counterclockwise as seen from the eye (clockwise
/// around the cell) from `first` to `last`.
struct Arrival {
    first: u32,
    last: u32,
    low: Ray,
    high: Ray,
}

impl Arrival {
    /// Whether the view may go on into the same cell, to the left of where it ends: it ends in a
    /// vertex of the cell, beyond which another portal faces the eye.
    #[inline]
    fn waits(&self, mesh: &FlatMesh, pencil: &Pencil) -> bool {
        let next = previous(mesh, self.last);
        let vertex = &mesh.edge(next).end;
        self.high.aim() == Aim::Vertex(vertex.id)
            && mesh.edge(next).twin != WALL
            && pencil.is_left(&self.high, &pencil.ray(&origin(mesh, next)))
    }
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
    /// With as much room as a look into a graph will hardly ever need, so that even the first
    /// allocates nothing.
    pub fn for_graph(graph: &CellGraph) -> Self {
        let (cells, edges) = (graph.cells.len(), graph.edges.len());
        Self {
            seen: Vec::with_capacity(cells),
            n_own: 0,
            pieces: Vec::with_capacity(edges),
            starts: Vec::with_capacity(edges),
            walls: Vec::with_capacity(edges),
            frames: Vec::with_capacity(edges),
            around: Vec::with_capacity(cells),
            waiting: Vec::with_capacity(cells),
            marks: vec![0; cells],
            look: 0,
        }
    }

    /// Whether the last look saw a cell.
    pub(super) fn is_seen(&self, cell: CellId) -> bool {
        self.marks[cell.0 as usize] == self.look
    }

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
        self.walk(mesh, pencil);
        Ok(())
    }

    fn clear(&mut self, n_cells: usize) {
        self.seen.clear();
        self.pieces.clear();
        self.starts.clear();
        self.walls.clear();
        if self.marks.len() != n_cells || self.look == u32::MAX {
            self.marks.clear();
            self.marks.resize(n_cells, 0);
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
        self.marks[cell.0 as usize] = self.look;
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
            self.around.clear();
            for &cell in &self.seen {
                let first = first_facing(mesh, pencil, cell);
                let ray = pencil.ray(&origin(mesh, first));
                self.around.push((first, ray));
            }
            let by_turn = |a: &(u32, Ray), b: &(u32, Ray)| pencil.turn_order(&a.1, &b.1);
            self.around.sort_unstable_by(by_turn);
            for i in 0..self.around.len() {
                self.add_starts(mesh, pencil, edges, self.around[i].0);
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

    /// Walks on from the edges of own cells, depth first and counterclockwise.
    ///
    /// Where two portals of a cell meet in a vertex, the view parts; right behind the vertex both
    /// parts reach one cell again. So that it, and all behind it, is not walked twice, an arrival
    /// waits if a second one may follow to its left; see [`Arrival::waits`]. It goes on when that
    /// comes, or else before the next wall is noted, so that walls keep their order.
    fn walk(&mut self, mesh: &FlatMesh, pencil: &Pencil) {
        self.frames.clear();
        for start in self.starts.iter().rev() {
            self.frames.push(Frame {
                edge: start.edge,
                low: pencil.unpack(start.wedge.low),
                high: pencil.unpack(start.wedge.high),
            });
        }
        let mut current = self.resume(mesh, pencil);
        while let Some(Frame { edge: e, low, high }) = current {
            let edge = mesh.edge(e);
            let end = pencil.ray(&edge.end);
            let rest = pencil.is_left(&end, &high).then(|| Frame {
                edge: edge.next(e),
                low: end,
                high,
            });
            let to = if rest.is_some() { end } else { high };
            if edge.twin != WALL {
                self.frames.extend(rest);
                let entered = self.arrive(mesh, pencil, edge.twin, low, to);
                current = entered.or_else(|| self.resume(mesh, pencil));
            } else if let Some(waiting) = self.waiting.pop() {
                self.frames.push(Frame { edge: e, low, high });
                current = Some(self.enter(mesh, pencil, &waiting));
            } else {
                let (low, high) = (low.pack(), to.pack());
                self.end_at(e, Wedge { low, high });
                current = rest.or_else(|| self.resume(mesh, pencil));
            }
        }
    }

    /// Where to go on.
    #[inline]
    fn resume(&mut self, mesh: &FlatMesh, pencil: &Pencil) -> Option<Frame> {
        self.frames.pop().or_else(|| {
            let waiting = self.waiting.pop()?;
            Some(self.enter(mesh, pencil, &waiting))
        })
    }

    /// Arrives at a cell through its edge `entry`. The open wedge between `low` and `high` is not
    /// empty, and lies within the entry. `None` if the arrival waits.
    #[inline]
    fn arrive(
        &mut self,
        mesh: &FlatMesh,
        pencil: &Pencil,
        entry: u32,
        low: Ray,
        high: Ray,
    ) -> Option<Frame> {
        let mut arrival = Arrival {
            first: entry,
            last: entry,
            low,
            high,
        };
        if let Some(waiting) = self.waiting.last()
            && previous(mesh, waiting.last) == entry
            && waiting.high.pack() == low.pack()
        {
            (arrival.first, arrival.low) = (waiting.first, waiting.low);
            self.waiting.pop();
        }
        if arrival.waits(mesh, pencil) {
            self.waiting.push(arrival);
            None
        } else {
            Some(self.enter(mesh, pencil, &arrival))
        }
    }

    /// Enters a cell: notes its piece, and tells what is to be looked at in it.
    #[inline]
    fn enter(&mut self, mesh: &FlatMesh, pencil: &Pencil, arrival: &Arrival) -> Frame {
        let Arrival {
            first: entry,
            low,
            high,
            ..
        } = *arrival;
        let cell = mesh.edge(entry).cell;
        let mark = &mut self.marks[cell as usize];
        if *mark != self.look {
            *mark = self.look;
            self.seen.push(CellId(cell));
        }
        self.pieces.push(Piece {
            cell: CellId(cell),
            entry,
            wedge: Wedge {
                low: low.pack(),
                high: high.pack(),
            },
        });
        Frame {
            edge: first_met(mesh, pencil, entry, &low),
            low,
            high,
        }
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
