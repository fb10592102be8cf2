//! One pair of cells, or one chain of portals: the sightline in space, for people to look at.

use std::ops::ControlFlow;

use glam::DVec3;

use super::chain::{Gate, Inquiry, Verdict};
use super::sightline::Sightline;
use super::walk::{Found, OpenMesh, Visitor, Walk};
use super::{HeightsOptions, set};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::sight::funnel::Funnel;

/// What [`witness`] says of two cells.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightsAnswer {
    /// The first sees the second.
    Visible(Passage),
    /// It does not: every chain of portals between them is blocked.
    Hidden,
    /// Not known within the budget.
    Undecided,
}

/// A chain of portals through which one cell sees another.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    /// The edges through which the sightline leaves one cell after the other; none from a cell to
    /// itself.
    pub chain: Vec<EdgeId>,
    /// A segment from inside the first cell to inside the last one that provably passes all openings;
    /// x and y in grid steps, z in the level's unit. `None` where the view is too narrow for ends
    /// in f64, and from a cell to itself.
    pub segment: Option<[DVec3; 2]>,
}

/// What [`through`] says of a chain of portals.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainAnswer {
    /// This segment provably passes, as in [`Passage::segment`].
    Passes(Option<[DVec3; 2]>),
    /// No line on the plan stabs the chain.
    BlockedOnPlan,
    /// No line in space passes it. Up to three edges of the chain, in its order, whose openings
    /// contradict each other, if the same ones do along all lines of the plan.
    Blocked(Vec<EdgeId>),
    /// Not known within the budget.
    Undecided,
}

/// Whether one cell sees another, and along which line; with the same answer as [`super::bracket`]
/// for the pair.
pub fn witness(graph: &CellGraph, a: CellId, b: CellId, options: &HeightsOptions) -> HeightsAnswer {
    if a == b {
        return HeightsAnswer::Visible(Passage {
            chain: Vec::new(),
            segment: None,
        });
    }
    let mesh = OpenMesh::new(graph);
    let mut walk = Walk::new(&mesh, options.splits);
    let mut open = false;
    for (from, to) in [(a, b), (b, a)] {
        let mut goal = Goal {
            mesh: &mesh,
            cell: to.0,
            splits: options.splits,
            proved: vec![0; graph.cells.len().div_ceil(64)],
            found: None,
            open: false,
        };
        set(&mut goal.proved, from.0);
        _ = walk.from(from, &mut goal);
        if let Some(mut passage) = goal.found {
            if from == b {
                passage = reversed(graph, passage);
            }
            return HeightsAnswer::Visible(passage);
        }
        open |= goal.open;
    }
    if open {
        HeightsAnswer::Undecided
    } else {
        HeightsAnswer::Hidden
    }
}

/// Whether a straight line in space passes a chain of portals, given by the edges through which it
/// leaves one cell after the other. An edge that is no portal, or not of the cell that the chain has
/// come to, ends sight like a wall.
pub fn through(graph: &CellGraph, chain: &[EdgeId], options: &HeightsOptions) -> ChainAnswer {
    let mesh = OpenMesh::new(graph);
    let mut funnel = Funnel::default();
    let mut gates: Vec<Gate> = Vec::new();
    let mut cell = None;
    for &edge in chain {
        let Some(twin) = graph.edge(edge).twin() else {
            return ChainAnswer::BlockedOnPlan;
        };
        let gate = mesh.gate(edge.0);
        let continues = cell.is_none_or(|cell| graph.edge(edge).cell == cell);
        let ends = [gate.left, gate.right];
        let stabbed = match gates.last() {
            None => {
                funnel.begin(gate.left, gate.right);
                true
            }
            Some(last) => funnel
                .extend_past(&graph.vertices, last.ends(), ends)
                .is_some(),
        };
        if !continues || !stabbed {
            return ChainAnswer::BlockedOnPlan;
        }
        gates.push(gate);
        cell = Some(graph.edge(twin).cell);
    }
    if let Some(blocking) = blocked_at_once(&gates) {
        return ChainAnswer::Blocked(blocking.into_iter().map(|i| chain[i]).collect());
    }
    let mut inquiry = Inquiry::new(&graph.vertices);
    let verdict = if gates.len() < 2 {
        Verdict::Open
    } else {
        inquiry.ask(&gates, &funnel, options.splits)
    };
    match verdict {
        Verdict::Blocked => {
            let clash = inquiry.only_clash().map_or(Vec::new(), |clash| {
                clash.gates.map(|i| chain[i as usize]).to_vec()
            });
            ChainAnswer::Blocked(clash)
        }
        Verdict::Passes(sightline) => {
            ChainAnswer::Passes(segment(&mesh, chain, &gates, Some(sightline)))
        }
        Verdict::Open if is_easy(&gates) => {
            ChainAnswer::Passes(segment(&mesh, chain, &gates, None))
        }
        Verdict::Open => ChainAnswer::Undecided,
    }
}

/// Openings that stop all lines whatever the plan: one without height, or one that is too low for two
/// others, or too high. The first such.
fn blocked_at_once(gates: &[Gate]) -> Option<Vec<usize>> {
    for (k, gate) in gates.iter().enumerate() {
        if gate.bottom >= gate.top {
            return Some(vec![k]);
        }
        for (j, middle) in gates[..k].iter().enumerate() {
            let clashes = |first: &Gate| {
                let dips = middle.top <= first.bottom && middle.top <= gate.bottom;
                dips || (middle.bottom >= first.top && middle.bottom >= gate.top)
            };
            if let Some(i) = gates[..j].iter().position(clashes) {
                return Some(vec![i, j, k]);
            }
        }
    }
    None
}

/// Whether any line of the plan has one above it that passes.
fn is_easy(gates: &[Gate]) -> bool {
    let floor = gates
        .iter()
        .map(|g| g.bottom)
        .fold(f64::NEG_INFINITY, f64::max);
    let ceiling = gates.iter().map(|g| g.top).fold(f64::INFINITY, f64::min);
    gates.len() <= 2 || floor < ceiling
}

/// Looks for one cell.
struct Goal<'a> {
    mesh: &'a OpenMesh<'a>,
    cell: u32,
    splits: u32,
    /// The cells seen so far.
    proved: Vec<u64>,
    found: Option<Passage>,
    open: bool,
}

impl Visitor for Goal<'_> {
    fn knows(&self, cell: u32) -> bool {
        self.proved[cell as usize / 64] >> (cell % 64) & 1 != 0
    }

    fn sees(&mut self, cell: u32, found: &Found) -> ControlFlow<()> {
        set(&mut self.proved, cell);
        if cell != self.cell {
            return ControlFlow::Continue(());
        }
        let chain: Vec<EdgeId> = found.edges().map(EdgeId).collect();
        let sightline = found.sightline.or_else(|| {
            let mut inquiry = Inquiry::new(&self.mesh.flat.graph.vertices);
            match found.gates {
                [_] => None,
                gates => match inquiry.ask(gates, found.funnel, self.splits) {
                    Verdict::Passes(sightline) => Some(sightline),
                    _ => None,
                },
            }
        });
        self.found = Some(Passage {
            segment: segment(self.mesh, &chain, found.gates, sightline),
            chain,
        });
        ControlFlow::Break(())
    }

    fn may_see(&mut self, cell: u32) {
        self.open |= cell == self.cell;
    }

    fn goes_on(&self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// The same passage from its other end.
fn reversed(graph: &CellGraph, passage: Passage) -> Passage {
    let twin = |edge: &EdgeId| graph.edge(*edge).twin().expect("a chain is of portals");
    Passage {
        chain: passage.chain.iter().rev().map(twin).collect(),
        segment: passage.segment.map(|[from, to]| [to, from]),
    }
}

/// Halvings tried to get the ends of a segment into its cells.
const TRIES: i32 = 48;

/// A segment that passes the chain, with its ends inside the first and the last cell, made from a line
/// that passes (not needed for a single gate).
fn segment(
    mesh: &OpenMesh,
    chain: &[EdgeId],
    gates: &[Gate],
    sightline: Option<Sightline>,
) -> Option<[DVec3; 2]> {
    let graph = &*mesh.flat.graph;
    let (first, last) = (gates.first()?, gates.last()?);
    let sightline = match (gates, sightline) {
        (_, Some(sightline)) => sightline,
        ([gate], None) => {
            let across = gate.right.at - gate.left.at;
            let middle = (gate.left.at + gate.right.at) / 2.0;
            let z = match gate.top {
                f64::INFINITY => 0.0,
                top => (gate.bottom + top) / 2.0,
            };
            Sightline {
                from: middle.extend(z),
                to: (middle + across.perp()).extend(z),
            }
        }
        _ => return None,
    };
    let cells = [
        graph.edge(*chain.first()?).cell,
        graph.edge(graph.edge(*chain.last()?).twin()?).cell,
    ];
    let spans = cells.map(|cell| mesh.span(cell));
    let way = sightline.to - sightline.from;
    let reach = |point: DVec3, sign: f64, cell: CellId| {
        let ends = graph.edge_range(cell).map(|e| {
            let (p, q) = (graph.edge(EdgeId(e)).origin, graph.end(EdgeId(e)));
            let (p, q) = (graph.vertices.approx(p), graph.vertices.approx(q));
            let (d, out) = (q - p, way.truncate() * sign);
            let closing = out.perp_dot(d);
            // Only edges that the line runs towards end it.
            if closing > 0.0 {
                (p - point.truncate()).perp_dot(d) / closing
            } else {
                f64::INFINITY
            }
        });
        ends.fold(f64::INFINITY, f64::min).max(0.0)
    };
    // The line was perhaps found for a part of the chain, so its own ends may be anywhere on it.
    let meet = |gate: &Gate| {
        let across = gate.right.at - gate.left.at;
        let to_gate = gate.left.at - sightline.from.truncate();
        sightline.from + way * (across.perp_dot(to_gate) / across.perp_dot(way.truncate()))
    };
    let (at_first, at_last) = (meet(first), meet(last));
    let back = reach(at_first, -1.0, cells[0]);
    let on = reach(at_last, 1.0, cells[1]);
    (1..TRIES).find_map(|halvings| {
        let part = 0.5f64.powi(halvings);
        let line = Sightline {
            from: at_first - way * (back * part),
            to: at_last + way * (on * part),
        };
        let within = |z: f64, (low, high): (f64, f64)| low < z && z < high;
        let holds = within(line.from.z, spans[0])
            && within(line.to.z, spans[1])
            && line.starts_inside(graph, cells[0])
            && line.reversed().starts_inside(graph, cells[1])
            && gates.iter().all(|gate| line.clears(&graph.vertices, gate));
        holds.then_some([line.from, line.to])
    })
}
