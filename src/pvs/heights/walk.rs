//! The depth-first walk through chains of portals, as in [`crate::pvs::search`], with openings.
//!
//! A chain needs an answer only where it enters a cell that is not yet known to be seen. Most are
//! answered at once: at most two open portals, or a horizontal line that clears all openings, let
//! any line of the plan pass; an opening below the sills of two others, or above their lintels,
//! stops all. Otherwise a line found for a part of the chain is tried, and then the chain is asked
//! about ([`super::chain`]). What is blocked is not walked further.

use std::ops::ControlFlow;

use super::chain::{Gate, Inquiry, Verdict};
use super::sightline::Sightline;
use crate::cells::{CellGraph, CellId};
use crate::geom::Placed;
use crate::pvs::flat::{FlatEdge, FlatMesh, WALL};
use crate::sight::funnel::{Funnel, Seen, Undo};

/// The mesh with the openings of its portals at their widest, by edge.
pub(super) struct OpenMesh<'a> {
    pub flat: FlatMesh<'a>,
    openings: Vec<(f64, f64)>,
}

impl<'a> OpenMesh<'a> {
    pub fn new(graph: &'a CellGraph) -> Self {
        let mut openings = vec![(f64::NEG_INFINITY, f64::INFINITY); graph.edges.len()];
        for portal in &graph.portals {
            if let Some(opening) = portal.widest {
                for edge in portal.edges {
                    openings[edge.0 as usize] = opening;
                }
            }
        }
        Self {
            flat: FlatMesh::new(graph),
            openings,
        }
    }

    /// Heights that are certainly inside the cell, floor and ceiling moved out of the way: those of
    /// all its openings, and what lies between them.
    pub fn span(&self, cell: CellId) -> (f64, f64) {
        let openings = self.flat.graph.edge_range(cell).filter_map(|e| {
            let (bottom, top) = self.openings[e as usize];
            (self.flat.edge(e).twin != WALL && bottom < top).then_some((bottom, top))
        });
        openings.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(low, high), (bottom, top)| (low.min(bottom), high.max(top)),
        )
    }

    /// The portal as somebody sees it who leaves a cell through this edge.
    pub fn gate(&self, edge: u32) -> Gate {
        let out = self.flat.edge(edge);
        let (bottom, top) = self.openings[edge as usize];
        Gate {
            left: out.end,
            right: self.flat.edge(out.twin).end,
            bottom,
            top,
        }
    }
}

/// A gate of the current chain, with what is known of the chain up to it.
struct Link {
    /// The edge through which it leaves a cell.
    edge: u32,
    /// Highest bottom and lowest top so far: between them, a horizontal line passes.
    floor: f64,
    ceiling: f64,
    /// Lowest top that stands behind a bottom at least as high: no later bottom may be as high.
    beam: f64,
    /// Highest bottom that stands behind a top not above it: no later top may be as low.
    curb: f64,
    /// What the chain up to here was found to be, if it was asked about.
    verdict: Option<Verdict>,
}

/// A cell on the current chain, with the edge through which to leave it next.
struct Frame {
    entry: u32,
    next: u32,
    /// The start of `next`, and how the extreme lines see it.
    from: Placed,
    seen: Seen,
    undo: Option<Undo>,
    /// Number of gates of the chain when the frame is done.
    before: usize,
}

/// What a walk makes of what it finds.
pub(super) trait Visitor {
    /// Whether it is known already that the source sees the cell.
    fn knows(&self, cell: u32) -> bool;
    /// The source sees the cell.
    fn sees(&mut self, cell: u32, found: &Found) -> ControlFlow<()>;
    /// The source may see the cell.
    fn may_see(&mut self, cell: u32);
    /// Asked often: whether to go on.
    fn goes_on(&self) -> ControlFlow<()>;
}

/// A chain through which there is a sightline.
pub(super) struct Found<'a> {
    pub gates: &'a [Gate],
    pub funnel: &'a Funnel,
    /// A line that passes, unless any line of the plan is known to have one above it.
    pub sightline: Option<Sightline>,
    links: &'a [Link],
}

impl Found<'_> {
    /// The edges through which the chain leaves one cell after the other.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        self.links.iter().map(|link| link.edge)
    }
}

/// A walk from one source after the other.
pub(super) struct Walk<'a> {
    mesh: &'a OpenMesh<'a>,
    splits: u32,
    inquiry: Inquiry<'a>,
    funnel: Funnel,
    /// The funnel of a part of the chain.
    part: Funnel,
    frames: Vec<Frame>,
    gates: Vec<Gate>,
    links: Vec<Link>,
    /// The first link up to which the chain was found to be blocked only after longer ones were
    /// walked.
    blocked: usize,
    /// Gates passed, for asking now and then whether to go on.
    passed: u32,
}

/// What is to be done about a chain that is one gate longer.
enum Step {
    GoOn,
    Leave,
}

impl<'a> Walk<'a> {
    pub fn new(mesh: &'a OpenMesh<'a>, splits: u32) -> Self {
        Self {
            mesh,
            splits,
            inquiry: Inquiry::new(&mesh.flat.graph.vertices),
            funnel: Funnel::default(),
            part: Funnel::default(),
            frames: Vec::new(),
            gates: Vec::new(),
            links: Vec::new(),
            blocked: usize::MAX,
            passed: 0,
        }
    }

    /// Walks all chains from `source` that do not lead left; returns the cells entered.
    pub fn from(&mut self, source: CellId, visitor: &mut impl Visitor) -> ControlFlow<(), u64> {
        let mesh = &self.mesh.flat;
        let vertices = &mesh.graph.vertices;
        let mut steps = 1;
        self.frames.clear();
        for first in mesh.graph.edge_range(source) {
            let entry = mesh.edge(first).twin;
            if entry == WALL {
                continue;
            }
            self.gates.clear();
            self.links.clear();
            self.blocked = usize::MAX;
            let (left, right) = (mesh.edge(first).end, mesh.edge(entry).end);
            self.funnel.begin(left, right);
            steps += 1;
            match self.pass(first, left, right, visitor)? {
                Step::GoOn => self.enter(entry, None, 0),
                Step::Leave => continue,
            }
            while let Some(frame) = self.frames.last_mut() {
                if frame.next == frame.entry || self.links.len() > self.blocked {
                    if let Some(undo) = &frame.undo {
                        self.funnel.undo(undo);
                    }
                    self.gates.truncate(frame.before);
                    self.links.truncate(frame.before);
                    self.frames.pop();
                    if self.links.len() <= self.blocked {
                        self.blocked = usize::MAX;
                    }
                    continue;
                }
                let out = frame.next;
                let FlatEdge { end, twin, .. } = *mesh.edge(out);
                let seen = self.funnel.next_seen(vertices, frame.seen, &end);
                let (right, right_seen) = (frame.from, frame.seen);
                (frame.from, frame.seen) = (end, seen);
                frame.next = mesh.edge(frame.entry).next(out);
                if !right_seen.inside_left {
                    // All further edges lie left of the counterclockwise-most line.
                    frame.next = frame.entry;
                } else if twin == WALL {
                } else if self.funnel.passes_all(seen, right_seen) {
                    // The only way on, and the lines of the plan stay what they are: no need to
                    // come back.
                    steps += 1;
                    let (undo, before) = (frame.undo, frame.before);
                    frame.next = frame.entry;
                    if let Step::GoOn = self.pass(out, end, right, visitor)? {
                        self.frames.pop();
                        self.enter(twin, undo, before);
                    }
                } else if let Some(undo) =
                    self.funnel
                        .extend(vertices, (end, seen), (right, right_seen))
                {
                    if self.funnel.leads_left() {
                        self.funnel.undo(&undo);
                        continue;
                    }
                    steps += 1;
                    let before = self.gates.len();
                    match self.pass(out, end, right, visitor)? {
                        Step::GoOn => self.enter(twin, Some(undo), before),
                        Step::Leave => self.funnel.undo(&undo),
                    }
                }
            }
        }
        ControlFlow::Continue(steps)
    }

    /// A cell entered through one of its edges, whose end is the portal's right end.
    fn enter(&mut self, entry: u32, undo: Option<Undo>, before: usize) {
        let edge = self.mesh.flat.edge(entry);
        self.frames.push(Frame {
            entry,
            next: edge.next(entry),
            from: edge.end,
            seen: self.funnel.right_end_seen(),
            undo,
            before,
        });
    }

    /// Adds a gate to the chain, which the funnel holds already, and asks whether one sees through
    /// it; if not, takes it off again.
    fn pass(
        &mut self,
        edge: u32,
        left: Placed,
        right: Placed,
        visitor: &mut impl Visitor,
    ) -> ControlFlow<(), Step> {
        self.passed = self.passed.wrapping_add(1);
        if self.passed.is_multiple_of(1024) {
            visitor.goes_on()?;
        }
        let (bottom, top) = self.mesh.openings[edge as usize];
        let Some(link) = Link::after(self.links.last(), edge, bottom, top) else {
            return ControlFlow::Continue(Step::Leave);
        };
        let easy = link.floor < link.ceiling || self.links.len() < 2;
        self.gates.push(Gate {
            left,
            right,
            bottom,
            top,
        });
        self.links.push(link);
        let flat = &self.mesh.flat;
        let cell = flat.edge(flat.edge(edge).twin).cell;
        if visitor.knows(cell) {
            return ControlFlow::Continue(Step::GoOn);
        }
        let verdict = if easy { None } else { Some(self.judge()) };
        match verdict {
            Some(Verdict::Blocked) => {
                self.gates.pop();
                self.links.pop();
                return ControlFlow::Continue(Step::Leave);
            }
            Some(Verdict::Open) => visitor.may_see(cell),
            Some(Verdict::Passes(_)) | None => {
                let found = Found {
                    gates: &self.gates,
                    funnel: &self.funnel,
                    sightline: match verdict {
                        Some(Verdict::Passes(sightline)) => Some(sightline),
                        _ => None,
                    },
                    links: &self.links,
                };
                visitor.sees(cell, &found)?;
            }
        }
        ControlFlow::Continue(Step::GoOn)
    }

    /// What is known of the whole chain. It passes if it passes a line that was found for it or for
    /// a part of it from its start, and it is blocked if such a part is; so what is decided does not
    /// depend on which parts happened to be asked about before, and a larger budget never decides
    /// less.
    fn judge(&mut self) -> Verdict {
        let n = self.links.len();
        let nearest = (0..n).rev().find_map(|m| match self.links[m].verdict {
            Some(Verdict::Passes(sightline)) => Some((m, sightline)),
            _ => None,
        });
        if let Some((m, sightline)) = nearest
            && self.clears_from(m + 1, &sightline)
        {
            return Verdict::Passes(sightline);
        }
        let own = self.inquiry.ask(&self.gates, &self.funnel, self.splits);
        self.links[n - 1].verdict = Some(own);
        if own != Verdict::Open {
            return own;
        }
        for m in (2..n - 1).rev() {
            match self.judge_part(m) {
                Verdict::Blocked => {
                    self.blocked = m;
                    return Verdict::Blocked;
                }
                Verdict::Passes(sightline) if self.clears_from(m + 1, &sightline) => {
                    return Verdict::Passes(sightline);
                }
                Verdict::Passes(_) | Verdict::Open => {}
            }
        }
        Verdict::Open
    }

    /// What the chain's first `m + 1` gates were found to be, or are now.
    fn judge_part(&mut self, m: usize) -> Verdict {
        let link = &self.links[m];
        if let Some(verdict) = link.verdict {
            return verdict;
        }
        if link.floor < link.ceiling {
            return Verdict::Open;
        }
        let vertices = &self.mesh.flat.graph.vertices;
        let gates = &self.gates[..=m];
        self.part.begin(gates[0].left, gates[0].right);
        for pair in gates.windows(2) {
            self.part
                .extend_past(vertices, pair[0].ends(), [pair[1].left, pair[1].right]);
        }
        let verdict = self.inquiry.ask(gates, &self.part, self.splits);
        self.links[m].verdict = Some(verdict);
        verdict
    }

    fn clears_from(&self, first: usize, sightline: &Sightline) -> bool {
        let vertices = &self.mesh.flat.graph.vertices;
        self.gates[first..]
            .iter()
            .all(|gate| sightline.clears(vertices, gate))
    }
}

impl Link {
    /// The next gate of a chain; `None` if its opening stops all lines.
    fn after(before: Option<&Link>, edge: u32, bottom: f64, top: f64) -> Option<Link> {
        let (floor, ceiling, beam, curb) = before.map_or(
            (
                f64::NEG_INFINITY,
                f64::INFINITY,
                f64::INFINITY,
                f64::NEG_INFINITY,
            ),
            |link| (link.floor, link.ceiling, link.beam, link.curb),
        );
        if bottom >= top || bottom >= beam || top <= curb {
            return None;
        }
        Some(Link {
            edge,
            floor: floor.max(bottom),
            ceiling: ceiling.min(top),
            beam: if top <= floor { beam.min(top) } else { beam },
            curb: if bottom >= ceiling {
                curb.max(bottom)
            } else {
                curb
            },
            verdict: None,
        })
    }
}
