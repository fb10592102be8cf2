//! Whether a straight line in space passes a whole chain of portals.
//!
//! In: the chain, and the lines that stab it on the plan. Out: a line in space that provably passes
//! all openings; or that there is none, as for every line of the plan some three openings
//! contradict each other; or neither, when the budget is spent.
//!
//! The lines of the plan are a convex polygon ([`super::corners`]). One line from its middle is
//! tried: along it the question is one of the plane ([`super::upright`]), and is answered by a line
//! through all openings or by openings that clash. What a clash says of the whole polygon, its form
//! tells ([`super::clash`]): it may stop all lines, or show where there is still hope and another
//! line is to be tried. Where neither helps, the polygon is cut into triangles, and these are
//! halved, until each is stopped by one of the clashes found so far.

use glam::DVec2;
use smallvec::SmallVec;

use super::clash::Form;
use super::corners::Corners;
use super::sightline::Sightline;
use super::upright::{Clash, Slot, Upright};
use crate::geom::{Interval, Placed, Vertices};
use crate::sight::funnel::Funnel;

/// A portal of a chain, its ends as seen by somebody who passes through it, and its opening.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gate {
    pub left: Placed,
    pub right: Placed,
    /// Infinite where the level has no heights.
    pub bottom: f64,
    pub top: f64,
}

impl Gate {
    /// As the plan sees it.
    pub fn ends(&self) -> crate::sight::Gate {
        crate::sight::Gate {
            left: self.left.id,
            right: self.right.id,
        }
    }
}

/// What is known of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// This line passes.
    Passes(Sightline),
    /// No line does.
    Blocked,
    /// Not known within the budget.
    Open,
}

/// A line of the plan as a sum of the polygon's corners, with these weights.
type Weights = SmallVec<[f64; 8]>;

/// A convex part of the polygon of lines, by its corners in order around it.
struct Piece {
    corners: SmallVec<[Weights; 4]>,
    /// How often it was halved.
    depth: u32,
}

/// Deepest halving: up to here the weights are exact.
const DEEPEST: u32 = 40;

/// Lines tried in one piece.
const MOST_TRIES: usize = 3;

/// Clashes along one line that are looked at, the worst ones.
const MOST_CLASHES: usize = 4;

/// The part of an opening's height by which it is made smaller where clashes are looked for.
const LITTLE: f64 = 1.0 / 1_048_576.0;

/// Clashes kept; there are seldom more than a few.
const MOST_FORMS: usize = 16;

/// Where lines are looked for that known clashes allow, if not in the middle of a piece: how far on
/// the way from one of its corners to another, …
const ON_THE_WAY: [f64; 3] = [0.0, 0.125, 0.5];

/// … and how far from there towards the middle, as the piece's own border is out of bounds.
const INWARDS: [f64; 4] = [0.5, 0.25, 0.0625, 0.015_625];

/// Answers for one chain after the other.
pub(super) struct Inquiry<'a> {
    vertices: &'a Vertices,
    upright: Upright,
    corners: Corners,
    slots: Vec<Slot>,
    forms: Vec<Form>,
    /// What the forms are on the corners of the current piece.
    values: Vec<Values>,
    pieces: Vec<Piece>,
    /// A piece was too small to be halved.
    stuck: bool,
}

impl<'a> Inquiry<'a> {
    pub fn new(vertices: &'a Vertices) -> Self {
        Self {
            vertices,
            upright: Upright::default(),
            corners: Corners::default(),
            slots: Vec::new(),
            forms: Vec::new(),
            values: Vec::new(),
            pieces: Vec::new(),
            stuck: false,
        }
    }

    /// Asks about a chain of at least two gates; `funnel` holds the lines that stab it. At most
    /// `splits` parts of the lines are looked at, always in the same order, so that a larger number
    /// never decides less.
    pub fn ask(&mut self, chain: &[Gate], funnel: &Funnel, splits: u32) -> Verdict {
        let (first, last) = (&chain[0], &chain[chain.len() - 1]);
        let middle = |gate: &Gate| (gate.left.at + gate.right.at) / 2.0;
        self.corners
            .set(self.vertices, funnel, (middle(first) + middle(last)) / 2.0);
        self.forms.clear();
        self.pieces.clear();
        self.stuck = false;
        self.pieces.push(Piece::whole(self.corners.list.len()));
        for _ in 0..splits {
            let Some(piece) = self.pieces.pop() else {
                break;
            };
            match self.examine(chain, &piece) {
                Verdict::Passes(sightline) => return Verdict::Passes(sightline),
                Verdict::Blocked => {}
                Verdict::Open => self.split(&piece),
            }
        }
        if self.pieces.is_empty() && !self.stuck {
            Verdict::Blocked
        } else {
            Verdict::Open
        }
    }

    /// The clash that blocked the chain asked about last, if it did so alone.
    pub fn only_clash(&self) -> Option<Clash> {
        self.forms
            .iter()
            .find(|form| form.stops_all())
            .map(|form| form.clash)
    }

    /// What can be said of a piece without splitting it.
    fn examine(&mut self, chain: &[Gate], piece: &Piece) -> Verdict {
        self.values.clear();
        for form in &self.forms {
            if stops(form.on(piece), &mut self.values) {
                return Verdict::Blocked;
            }
        }
        let middle = piece.middle();
        for attempt in 0..MOST_TRIES {
            let line = match attempt {
                0 if self.hope(&middle) > 0.0 => Some(middle.clone()),
                _ => self.most_hopeful(piece, &middle),
            };
            let Some(weights) = line else { break };
            if let Some(sightline) = self.try_line(chain, &weights) {
                return Verdict::Passes(sightline);
            }
            let known = self.forms.len();
            for clash in self.upright.clashes().take(MOST_CLASHES) {
                let new = self.forms.iter().all(|form| form.clash != clash);
                if !new || self.forms.len() == MOST_FORMS {
                    continue;
                }
                let form = Form::new(self.vertices, &self.corners, chain, clash);
                let values = form.on(piece);
                self.forms.push(form);
                if stops(values, &mut self.values) {
                    return Verdict::Blocked;
                }
            }
            if attempt > 0 && self.forms.len() == known {
                break;
            }
        }
        Verdict::Open
    }

    /// How far a line is from all known clashes, about; above zero where none forbids it.
    fn hope(&self, line: &Weights) -> f64 {
        let values = self.forms.iter().map(|form| form.near(line));
        values.fold(f64::INFINITY, f64::min)
    }

    /// The line farthest from all known clashes among some on the ways between a piece's corners, moved
    /// towards its middle as far as they allow.
    fn most_hopeful(&self, piece: &Piece, middle: &Weights) -> Option<Weights> {
        let corners = &piece.corners;
        let mut best: Option<(f64, Weights)> = None;
        for (i, j) in (0..corners.len()).flat_map(|i| (0..corners.len()).map(move |j| (i, j))) {
            for share in ON_THE_WAY {
                if (i == j) != (share == 0.0) {
                    continue;
                }
                let line = mix(&corners[i], &corners[j], share);
                let hope = self.hope(&line);
                if hope >= 0.0 && best.as_ref().is_none_or(|(most, _)| hope > *most) {
                    best = Some((hope, line));
                }
            }
        }
        let (_, line) = best?;
        INWARDS
            .map(|share| mix(&line, middle, share))
            .into_iter()
            .find(|line| self.hope(line) > 0.0)
    }

    /// Tries a line of the plan: a line in space above it that provably passes.
    fn try_line(&mut self, chain: &[Gate], weights: &Weights) -> Option<Sightline> {
        let [a, b, c] = self.corners.sum(weights);
        let squared = a * a + b * b;
        let way = DVec2::new(b, -a) / squared.sqrt();
        let base = DVec2::new(a, b) * (-c / squared);
        self.slots.clear();
        let mut ends = [0.0; 2];
        for (gate, number) in chain.iter().zip(0..) {
            let left = gate.left.at - self.corners.origin;
            let across = gate.right.at - gate.left.at;
            let s = -across.perp_dot(base - left) / across.perp_dot(way);
            if number == 0 {
                ends[0] = s;
            }
            ends[1] = s;
            if gate.top < f64::INFINITY {
                self.slots.push(Slot {
                    gate: number,
                    s,
                    bottom: gate.bottom,
                    top: gate.top,
                });
            }
        }
        let slope = self.upright.pass(&self.slots)?;
        let at = |s: f64| (self.corners.origin + base + way * s).extend(slope.at(s));
        let sightline = Sightline {
            from: at(ends[0]),
            to: at(ends[1]),
        };
        if chain
            .iter()
            .all(|gate| sightline.clears(self.vertices, gate))
        {
            return Some(sightline);
        }
        // It is so tight that rounding hides whether it passes: openings that clash when they are a
        // little smaller may do so as they are.
        for slot in &mut self.slots {
            let little = (slot.top - slot.bottom) * LITTLE;
            slot.bottom += little;
            slot.top -= little;
        }
        self.upright.pass(&self.slots);
        None
    }

    /// Puts the parts of a piece on the stack.
    fn split(&mut self, piece: &Piece) {
        if let [first, .., _] = &piece.corners[..]
            && piece.corners.len() > 3
        {
            let triangles = piece.corners[1..].windows(2).map(|pair| Piece {
                corners: [first, &pair[0], &pair[1]].into_iter().cloned().collect(),
                depth: piece.depth,
            });
            self.pieces.extend(triangles);
            return;
        }
        if piece.depth == DEEPEST {
            self.stuck = true;
            return;
        }
        let lines: SmallVec<[[f64; 3]; 3]> =
            piece.corners.iter().map(|c| self.corners.sum(c)).collect();
        let length = |i: usize| self.corners.distance(lines[i], lines[(i + 1) % 3]);
        let longest = (0..3)
            .max_by(|&i, &j| length(i).total_cmp(&length(j)))
            .unwrap_or(0);
        let ends = [longest, (longest + 1) % 3];
        let [p, q] = ends.map(|i| &piece.corners[i]);
        let middle: Weights = p.iter().zip(q).map(|(p, q)| (p + q) / 2.0).collect();
        let mut halves = ends.map(|replaced| {
            let mut corners = piece.corners.clone();
            corners[replaced] = middle.clone();
            Piece {
                corners,
                depth: piece.depth + 1,
            }
        });
        // The corner that the other half has alone decides which is looked at first.
        if self.hope(p) < self.hope(q) {
            halves.reverse();
        }
        self.pieces.extend(halves);
    }
}

impl Piece {
    /// The whole polygon with so many corners.
    fn whole(n: usize) -> Self {
        let corner = |i: usize| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
        Self {
            corners: (0..n).map(corner).collect(),
            depth: 0,
        }
    }

    fn middle(&self) -> Weights {
        let n = self.corners.len() as f64;
        let sum = |k: usize| self.corners.iter().map(|c| c[k]).sum::<f64>() / n;
        (0..self.corners[0].len()).map(sum).collect()
    }
}

/// A line on the way from one to another.
fn mix(p: &Weights, q: &Weights, share: f64) -> Weights {
    let mixed = p.iter().zip(q).map(|(p, q)| p * (1.0 - share) + q * share);
    mixed.collect()
}

/// The polar form of every pair of a piece's corners.
type Values = SmallVec<[Interval; 10]>;

/// Whether a form, alone or in a sum with one of those known before, stops all lines of a piece: it is
/// not above zero for any pair of corners. It joins the known ones.
///
/// A line passes only where every form is above zero, and then so is every sum of forms with weights
/// above zero.
fn stops(values: Values, known: &mut Vec<Values>) -> bool {
    let alone = values.iter().all(|v| v.is_at_most_zero());
    let stops = alone || known.iter().any(|other| stop_together(&values, other));
    known.push(values);
    stops
}

/// Whether one form and some multiple of another are nowhere above zero together.
fn stop_together(one: &Values, other: &Values) -> bool {
    let (mut least, mut most) = (0.0f64, f64::INFINITY);
    for (p, q) in one.iter().zip(other) {
        if q.hi > 0.0 {
            most = most.min(-p.hi / q.hi);
        } else if p.hi > 0.0 {
            least = least.max(-p.hi / q.hi);
        }
    }
    if least.partial_cmp(&most) != Some(std::cmp::Ordering::Less) {
        return false;
    }
    let factor = Interval::point(match most {
        f64::INFINITY => 2.0 * least,
        most => (least + most) / 2.0,
    });
    let sums = one.iter().zip(other).map(|(p, q)| *p + *q * factor);
    factor.lo.is_finite() && sums.into_iter().all(|sum| sum.is_at_most_zero())
}

impl Form {
    /// The polar form of every pair of a piece's corners.
    fn on(&self, piece: &Piece) -> Values {
        let corners = &piece.corners;
        let pairs = (0..corners.len()).flat_map(|i| (i..corners.len()).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| self.between(&corners[i], &corners[j]))
            .collect()
    }

    /// The polar form of two lines.
    fn between(&self, p: &Weights, q: &Weights) -> Interval {
        let mut sum = Interval::ZERO;
        for (i, &weight) in p.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            for (j, &other) in q.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                let value = self.polar(i, j);
                sum = sum
                    + if weight == 1.0 && other == 1.0 {
                        value
                    } else {
                        value * (Interval::point(weight) * Interval::point(other))
                    };
            }
        }
        sum
    }

    /// The form of a line, about, as a share of its largest value.
    fn near(&self, line: &Weights) -> f64 {
        let mut sum = 0.0;
        for (i, weight) in line.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            for (j, other) in line.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                sum += weight * other * self.about(i, j);
            }
        }
        sum
    }
}
