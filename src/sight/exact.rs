//! The exact solver of [`super::stab()`].
//!
//! In: a chain of portals. Out: the line in the middle of the widest strip that the chain lets
//! through, or the few ends that contradict each other.
//!
//! The chain is pushed through the [`Funnel`], which decides. What it then holds of the two hulls are
//! just the ends that some stabbing line can touch: the widest strip lies between two of them, or
//! along an edge of one hull, and is found as its direction turns from one extreme line to the other
//! (the rotating calipers of Shamos 1978). A portal that does not fit is in conflict with the ends
//! that an extreme line touches. Whatever comes out is checked; should it not hold, as can be where
//! the gates are not portals of one convex cell after the other, then `hulls` decides.

use std::cell::RefCell;
use std::cmp::Ordering;

use dashu_int::IBig;

use super::funnel::{Funnel, Undo};
use super::hulls::{self, Hulls};
use super::stab::meet;
use super::strip::Strip;
use super::{Contradiction, Gate, Slack, Stabbing, Witness};
use crate::geom::{Placed, Side, VertexId, Vertices};

/// A stabbing line of the chain, or why there is none; exact. Of gates that are no chain through
/// cells it holds as well: the line has all left ends on its left and all right ends on its right.
pub fn stab(vertices: &Vertices, chain: &[Gate]) -> Stabbing {
    ROOM.with_borrow_mut(|funnel| stab_in(vertices, chain, funnel))
}

thread_local! {
    /// Taking new room for each chain would take as long as the test itself.
    static ROOM: RefCell<Funnel> = RefCell::default();
}

fn stab_in(vertices: &Vertices, chain: &[Gate], funnel: &mut Funnel) -> Stabbing {
    let found = match misfit(vertices, chain, funnel) {
        None if chain.is_empty() => Some(Stabbing::Line(Witness {
            a: IBig::ZERO,
            b: IBig::ONE,
            c: IBig::ZERO,
            slack: f64::INFINITY,
        })),
        None => {
            let strip = widest(vertices, funnel);
            strip
                .is_widest(vertices, chain)
                .then(|| Stabbing::Line(strip.middle(vertices)))
        }
        Some(at) => conflict(vertices, funnel, &chain[..=at]).map(Stabbing::None),
    };
    found.unwrap_or_else(|| match by_hulls(vertices, chain) {
        Hulls::Meet(contradiction) => Stabbing::None(contradiction),
        Hulls::Apart(strip) => Stabbing::Line(strip.middle(vertices)),
    })
}

/// Whether some line stabs the chain; exact. Each gate must be in the convex cell beyond the one
/// before, and the vertices must hold each point once. The funnel, whatever it held, lends its room:
/// who asks often keeps one.
pub fn is_stabbed(vertices: &Vertices, chain: &[Gate], room: &mut Funnel) -> bool {
    misfit(vertices, chain, room).is_none()
}

/// The widest strip that the chain lets through; `None` if no line stabs it, and for the empty chain.
pub fn slack(vertices: &Vertices, chain: &[Gate]) -> Option<Slack> {
    if chain.is_empty() {
        return None;
    }
    let found = ROOM.with_borrow_mut(|funnel| {
        misfit(vertices, chain, funnel)
            .is_none()
            .then(|| widest(vertices, funnel))
    });
    if let Some(strip) = found
        && strip.is_widest(vertices, chain)
    {
        return Some(strip.slack(vertices));
    }
    match by_hulls(vertices, chain) {
        Hulls::Meet(_) => None,
        Hulls::Apart(strip) => Some(strip.slack(vertices)),
    }
}

/// A stabbed chain of gates, each in the convex cell beyond the one before, that grows and shrinks.
/// Its vertices must hold each point once, as those of a [`CellGraph`](crate::cells::CellGraph) do.
#[derive(Clone, Debug)]
pub struct Chain<'a> {
    vertices: &'a Vertices,
    funnel: Funnel,
    gates: Vec<Gate>,
    /// How to take off the second gate and each after it.
    undos: Vec<Undo>,
}

impl<'a> Chain<'a> {
    /// The empty chain.
    pub fn new(vertices: &'a Vertices) -> Self {
        Self {
            vertices,
            funnel: Funnel::default(),
            gates: Vec::new(),
            undos: Vec::new(),
        }
    }

    /// Adds a gate if some line stabs the longer chain; else the chain stays as it was.
    pub fn push(&mut self, gate: Gate) -> bool {
        let [left, right] = [gate.left, gate.right].map(|v| self.vertices.placed(v));
        match self.gates.last() {
            _ if gate.left == gate.right => return false,
            None => self.funnel.begin(left, right),
            Some(last) => {
                let undo = self.funnel.extend_past(self.vertices, *last, [left, right]);
                let Some(undo) = undo else { return false };
                self.undos.push(undo);
            }
        }
        self.gates.push(gate);
        true
    }

    /// Takes the last gate off.
    pub fn pop(&mut self) -> Option<Gate> {
        if let Some(undo) = self.undos.pop() {
            self.funnel.undo(&undo);
        }
        self.gates.pop()
    }

    /// The gates, first to last.
    pub fn gates(&self) -> &[Gate] {
        &self.gates
    }

    /// The widest strip that the chain lets through; no wider for a longer chain, up to rounding.
    /// `None` for the empty chain.
    pub fn slack(&self) -> Option<Slack> {
        let some = !self.gates.is_empty();
        some.then(|| widest(self.vertices, &self.funnel).slack(self.vertices))
    }
}

/// The first gate with which no line stabs the chain any more; the funnel is left with those before.
#[inline]
fn misfit(vertices: &Vertices, chain: &[Gate], funnel: &mut Funnel) -> Option<usize> {
    let mut last = None;
    chain.iter().position(|gate| {
        let ends = [gate.left, gate.right].map(|v| vertices.placed(v));
        let fits = gate.left != gate.right
            && match last {
                None => {
                    funnel.begin(ends[0], ends[1]);
                    true
                }
                Some(last) => funnel.narrow(vertices, last, ends),
            };
        last = Some(*gate);
        !fits
    })
}

/// The widest strip between the two hulls of a funnel.
fn widest(vertices: &Vertices, funnel: &Funnel) -> Strip {
    let (lefts, rights) = (funnel.left_bounds(), funnel.right_bounds());
    // The strip's direction turns from the clockwise-most line, which touches the first left and the
    // last right end, to the counterclockwise-most. Between the directions of two edges of the hulls
    // it touches the same two ends, and its width grows for as long as its direction makes an obtuse
    // angle with the way from the right end to the left one.
    let (mut i, mut j) = (0, rights.len() - 1);
    // The edge passed last, and whether it is one of left ends.
    let mut passed = None;
    loop {
        let left_edge = (i + 1 < lefts.len()).then(|| [lefts[i], lefts[i + 1]]);
        let right_edge = (j > 0).then(|| [rights[j - 1], rights[j]]);
        let next = match (left_edge, right_edge) {
            (None, None) => break,
            (Some(edge), None) => (edge, true),
            (None, Some(edge)) => (edge, false),
            (Some(l), Some(r)) => match vertices.turn([&l[0], &l[1]], [&r[0], &r[1]]) {
                Side::Right => (r, false),
                Side::On | Side::Left => (l, true),
            },
        };
        if !obtuse(vertices, next.0, [rights[j], lefts[i]]) {
            break;
        }
        if next.1 {
            i += 1;
        } else {
            j -= 1;
        }
        passed = Some(next);
    }
    let (left, right) = (lefts[i], rights[j]);
    match passed {
        // Across the edge the width turned from growing to shrinking: there it is greatest.
        Some((edge, of_left)) if obtuse(vertices, [edge[1], edge[0]], [right, left]) => {
            if of_left {
                Strip {
                    left: edge,
                    right: [right; 2],
                }
            } else {
                Strip {
                    left: [left; 2],
                    right: edge,
                }
            }
        }
        _ => Strip::across(left, right),
    }
}

/// Whether two ways make an obtuse angle.
fn obtuse(vertices: &Vertices, [p, q]: [Placed; 2], [r, s]: [Placed; 2]) -> bool {
    vertices.facing([&p, &q], [&r, &s]) == Ordering::Less
}

/// Ends that contradict each other, in a chain whose last gate does not fit the funnel of those
/// before; `None` if none were found.
fn conflict(vertices: &Vertices, funnel: &Funnel, chain: &[Gate]) -> Option<Contradiction> {
    let (gate, before) = chain.split_last()?;
    if gate.left == gate.right || before.len() < 2 {
        return match by_hulls(vertices, &chain[before.len().saturating_sub(1)..]) {
            Hulls::Meet(contradiction) => Some(contradiction),
            Hulls::Apart(_) => None,
        };
    }
    let (lefts, rights) = (funnel.left_bounds(), funnel.right_bounds());
    // The left end may lie behind the clockwise-most line, which touches the first left end that
    // still matters and the last right end; or the right end behind the counterclockwise-most.
    let ends = |gate: &Gate| [gate.left, gate.right];
    behind(vertices, chain, ends, [lefts, rights], Side::Left).or_else(|| {
        let ends = |gate: &Gate| [gate.right, gate.left];
        let flipped = behind(vertices, chain, ends, [rights, lefts], Side::Right)?;
        Some(Contradiction {
            left: flipped.right,
            right: flipped.left,
        })
    })
}

/// Ends that contradict each other, if the last gate's end on the first side lies behind the extreme
/// line that touches the first of `bounds` on its own side and then the last of those on the other.
/// `ends` gives a gate's end on the first side, which is to lie on the side `own_side` of sightlines,
/// and that on the other; ends of the first side come out as left ones.
fn behind(
    vertices: &Vertices,
    chain: &[Gate],
    ends: impl Fn(&Gate) -> [VertexId; 2],
    bounds: [&[Placed]; 2],
    own_side: Side,
) -> Option<Contradiction> {
    let first = |side: usize| bounds[side].first().map(|p| p.id);
    let last = |side: usize| bounds[side].last().map(|p| p.id);
    let (own, other) = (first(0)?, last(1)?);
    let [end, _] = ends(chain.last()?);
    if vertices.orient(own, other, end) == own_side {
        return None;
    }
    // The way from `own` to `end` passes `other` on the wrong side, or meets it. Some end of the
    // other side lies on its right side, most often the new one or the first that matters; or else
    // one of the own side makes a triangle around `other`.
    let two = |third: VertexId| {
        let (same, others) = ([own, end], [other, third]);
        meet(vertices, &same, &others).then(|| (same[..].into(), others[..].into()))
    };
    let three = |third: VertexId| {
        let same = [own, end, third];
        meet(vertices, &same, &[other]).then(|| (same[..].into(), [other][..].into()))
    };
    let from_last = || chain.iter().rev().map(&ends);
    let near = || from_last().next().and_then(|[_, third]| two(third));
    let (left, right) = near()
        .or_else(|| two(first(1)?))
        .or_else(|| three(last(0)?))
        .or_else(|| from_last().find_map(|[_, third]| two(third)))
        .or_else(|| from_last().find_map(|[third, _]| three(third)))?;
    hulls::shrink(vertices, left, right)
}

fn by_hulls(vertices: &Vertices, chain: &[Gate]) -> Hulls {
    let ends = |side: fn(&Gate) -> VertexId| chain.iter().map(side).collect::<Vec<_>>();
    hulls::compare(vertices, &ends(|gate| gate.left), &ends(|gate| gate.right))
}
