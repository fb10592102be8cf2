//! Whether a straight line in space passes a whole chain of portals.
//!
//! In: the chain, and the lines that stab it on the plan. Out: a line in space that provably passes
//! all openings; or that there is none, as for every line of the plan some three openings
//! contradict each other; or neither, when the budget is spent.
//!
//! The lines of the plan are a convex polygon ([`super::corners`]). One line from its middle is
//! tried: along it the question is one of the plane ([`super::upright`]), and is answered by a line
//! through all openings or by three that clash. What the clash says of the whole polygon, its form
//! tells ([`super::clash`]); where that does not stop all lines, the polygon is cut into triangles
//! and these are halved, until each is stopped by one of the clashes found so far.

use glam::DVec2;

use super::clash::Form;
use super::corners::Corners;
use super::sightline::Sightline;
use super::upright::{Clash, Slope, Slot, Upright};
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

/// A part of the polygon of lines.
#[derive(Clone, Copy)]
enum Piece {
    Whole,
    /// A triangle within the one of the polygon's corners 0, `fan` and `fan + 1`: each of its
    /// corners as a sum of those three.
    Triangle {
        fan: usize,
        corners: [[f64; 3]; 3],
        depth: u32,
    },
}

/// Deepest halving: up to here the weights are exact.
const DEEPEST: u32 = 40;

/// Answers for one chain after the other.
pub(super) struct Inquiry<'a> {
    vertices: &'a Vertices,
    upright: Upright,
    corners: Corners,
    slots: Vec<Slot>,
    forms: Vec<Form>,
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
            .set(funnel, (middle(first) + middle(last)) / 2.0);
        self.forms.clear();
        self.pieces.clear();
        self.stuck = false;
        self.pieces.push(Piece::Whole);
        for _ in 0..splits {
            let Some(piece) = self.pieces.pop() else {
                break;
            };
            if self.forms.iter().any(|form| stops(form, &piece)) {
                continue;
            }
            match self.try_line(chain, &piece) {
                Some(Ok(sightline)) => return Verdict::Passes(sightline),
                Some(Err(clash)) if self.forms.iter().all(|form| form.clash != clash) => {
                    let form = Form::new(self.vertices, &self.corners, chain, clash);
                    let done = stops(&form, &piece);
                    self.forms.push(form);
                    if done {
                        continue;
                    }
                }
                _ => {}
            }
            self.split(piece);
        }
        if self.pieces.is_empty() && !self.stuck {
            Verdict::Blocked
        } else {
            Verdict::Open
        }
    }

    /// The clash that blocked the chain asked about last, if it did so alone.
    pub fn only_clash(&self) -> Option<Clash> {
        match &self.forms[..] {
            [form] => Some(form.clash),
            _ => None,
        }
    }

    /// Tries the line in the middle of a piece: a line in space above it that provably passes, or
    /// a clash. `None` where rounding leaves the answer open.
    fn try_line(&mut self, chain: &[Gate], piece: &Piece) -> Option<Result<Sightline, Clash>> {
        let mut line = [0.0; 3];
        let mut add = |corner: usize, weight: f64| {
            for (sum, part) in line.iter_mut().zip(self.corners.list[corner].line) {
                *sum += weight * part;
            }
        };
        match *piece {
            Piece::Whole => (0..self.corners.list.len()).for_each(|corner| add(corner, 1.0)),
            Piece::Triangle { fan, corners, .. } => {
                for (k, corner) in [0, fan, fan + 1].into_iter().enumerate() {
                    add(corner, corners.iter().map(|weights| weights[k]).sum());
                }
            }
        }
        let [a, b, c] = line;
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
                if self.slots.last().is_some_and(|before| !(before.s < s)) {
                    return None;
                }
                self.slots.push(Slot {
                    gate: number,
                    s,
                    bottom: gate.bottom,
                    top: gate.top,
                });
            }
        }
        let slope: Slope = match self.upright.pass(&self.slots) {
            Ok(slope) => slope,
            Err(clash) => return Some(Err(clash)),
        };
        let at = |s: f64| (self.corners.origin + base + way * s).extend(slope.at(s));
        let sightline = Sightline {
            from: at(ends[0]),
            to: at(ends[1]),
        };
        let proved = chain
            .iter()
            .all(|gate| sightline.clears(self.vertices, gate));
        proved.then_some(Ok(sightline))
    }

    /// Puts the parts of a piece on the stack.
    fn split(&mut self, piece: Piece) {
        let Piece::Triangle {
            fan,
            corners,
            depth,
        } = piece
        else {
            let whole = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let triangle = |fan| Piece::Triangle {
                fan,
                corners: whole,
                depth: 0,
            };
            self.pieces
                .extend((1..self.corners.list.len() - 1).map(triangle));
            return;
        };
        if depth == DEEPEST {
            self.stuck = true;
            return;
        }
        let lines = [0, fan, fan + 1].map(|k| self.corners.list[k].line);
        let line = |weights: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|axis| (0..3).map(|k| weights[k] * lines[k][axis]).sum())
        };
        let lines = corners.map(line);
        let size = {
            let corner = |gate: &super::corners::Corner| gate.from.at.distance(gate.to.at);
            self.corners.list.iter().map(corner).fold(0.0, f64::max)
        };
        let length = |i: usize| {
            let (p, q) = (lines[i], lines[(i + 1) % 3]);
            let turn = DVec2::new(q[0] - p[0], q[1] - p[1]).length() * size;
            turn.max((q[2] - p[2]).abs())
        };
        let longest = (0..3)
            .max_by(|&i, &j| length(i).total_cmp(&length(j)))
            .unwrap_or(0);
        let (p, q) = (longest, (longest + 1) % 3);
        let middle = std::array::from_fn(|k| (corners[p][k] + corners[q][k]) / 2.0);
        for replaced in [p, q] {
            let mut half = corners;
            half[replaced] = middle;
            self.pieces.push(Piece::Triangle {
                fan,
                corners: half,
                depth: depth + 1,
            });
        }
    }
}

/// Whether a clash stops all lines of a piece.
fn stops(form: &Form, piece: &Piece) -> bool {
    let Piece::Triangle { fan, corners, .. } = *piece else {
        return form.stops_all();
    };
    let base = [0, fan, fan + 1];
    let polar = |p: &[f64; 3], q: &[f64; 3]| {
        let mut sum = Interval::ZERO;
        for (i, &weight) in p.iter().enumerate().filter(|(_, w)| **w != 0.0) {
            for (j, &other) in q.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                let weight = Interval::point(weight) * Interval::point(other);
                sum = sum + form.polar(base[i], base[j]) * weight;
            }
        }
        sum
    };
    (0..3).all(|i| (i..3).all(|j| polar(&corners[i], &corners[j]).is_at_most_zero()))
}
