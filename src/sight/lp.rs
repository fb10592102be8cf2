//! The lecture's linear programme as a solver of [`super::stab()`].
//!
//! In: a chain of portals. Out: a line, or ends that contradict each other, as far as floating point
//! goes; both may be wrong where the chain is tight, which their exact check tells.
//!
//! Source: lecture, "Finding Sightlines". Sought is the line f(p) = a·x + b·y + c with f(L) ≥ m for
//! all left ends L, f(R) ≤ -m for all right ends R, and the margin m as great as can be; the chain
//! is stabbed if m > 0. Bounds on a, b and c as normalisation would make (0, 0, 0) a solution, so
//! that m = 0 at worst, up to rounding, and thin openings are lost in it. So the sum of f(L) - f(R)
//! over the n portals is set to 2n, and m comes out between 1 and some number below 0. In
//! coordinates across the chain and along it, that settles a, and two unknowns remain beside m.

use glam::DVec2;
use good_lp::solvers::WithTimeLimit;
use good_lp::solvers::microlp::{MicroLpSolution, microlp};
use good_lp::{
    Expression, ProblemVariables, Solution, SolutionStatus, SolverModel, Variable, variable,
};

use super::{Contradiction, Gate, Stabbing, Witness};
use crate::geom::Vertices;

/// Seconds until a programme is given up that runs in circles, as the solver's simplex method can.
const LONGEST: f64 = 1.0;

/// A stabbing line of the chain, or why there is none, by linear programming in floating point. The
/// line is as exact as any, but need not stab the chain. The contradiction comes from a second
/// programme, and is empty where that finds none.
pub fn stab(vertices: &Vertices, chain: &[Gate]) -> Stabbing {
    let Some(frame) = Frame::of(vertices, chain) else {
        return Stabbing::None(Contradiction::default());
    };
    let line = solve(&frame, vertices, chain)
        .filter(|line| line.margin > 0.0)
        .and_then(|line| frame.witness(vertices, chain, &line));
    match line {
        Some(line) => Stabbing::Line(line),
        None => Stabbing::None(contradiction(&frame, vertices, chain).unwrap_or_default()),
    }
}

/// The margin of the programme: positive if it finds a line. `None` if it finds no solution at all,
/// not even one with a negative margin.
pub fn margin(vertices: &Vertices, chain: &[Gate]) -> Option<f64> {
    let frame = Frame::of(vertices, chain)?;
    Some(solve(&frame, vertices, chain)?.margin)
}

/// Coordinates for a chain: from the centre of its bounding box, across the chain (along the sum of
/// all ways from a right end to its left end) and along it.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: DVec2,
    across: DVec2,
    along: DVec2,
}

/// A solution: f(p) = slope·(across·p, along·p) + constant, p from the centre.
#[derive(Clone, Copy, Debug)]
struct Found {
    slope: DVec2,
    constant: f64,
    margin: f64,
}

impl Frame {
    /// `None` for the empty chain.
    fn of(vertices: &Vertices, chain: &[Gate]) -> Option<Self> {
        let at = |v| vertices.approx(v);
        let places = || chain.iter().flat_map(|g| [at(g.left), at(g.right)]);
        let (low, high) = (places().reduce(DVec2::min)?, places().reduce(DVec2::max)?);
        let centre = low + (high - low) / 2.0;
        let sum: DVec2 = chain.iter().map(|g| at(g.left) - at(g.right)).sum();
        let across = sum.try_normalize().unwrap_or(DVec2::X);
        // So that no coordinate is more than 1. Both by the same, lest the rounding of ends that lie
        // in line across the chain be taken for its length.
        let reach = places().map(|p| (p - centre).length()).fold(0.0, f64::max);
        let across = if reach > 0.0 { across / reach } else { across };
        Some(Self {
            centre,
            across,
            along: -across.perp(),
        })
    }

    fn enter(&self, p: DVec2) -> DVec2 {
        let p = p - self.centre;
        DVec2::new(self.across.dot(p), self.along.dot(p))
    }

    /// The line in grid coordinates, exactly, with the width of the strip around it.
    fn witness(&self, vertices: &Vertices, chain: &[Gate], found: &Found) -> Option<Witness> {
        let normal = found.slope.x * self.across + found.slope.y * self.along;
        let value = |v| normal.dot(vertices.approx(v) - self.centre);
        let least = chain.iter().map(|g| value(g.left)).reduce(f64::min)?;
        let most = chain.iter().map(|g| value(g.right)).reduce(f64::max)?;
        let slack = (least - most) / normal.length();
        Witness::through(normal, self.centre, found.constant, slack)
    }
}

/// The programme's solution; `None` where the solver says that there is none, or gives up.
fn solve(frame: &Frame, vertices: &Vertices, chain: &[Gate]) -> Option<Found> {
    let mut variables = ProblemVariables::new();
    let [slope, constant] = std::array::from_fn(|_| variables.add(variable()));
    // The margins' mean is 1. With the bound said, the solver starts from it; without, it calls some
    // chains of one gate unbounded, and on others runs in circles.
    let margin = variables.add(variable().max(1.0));
    let ends = |gate: &Gate| [gate.left, gate.right].map(|v| frame.enter(vertices.approx(v)));
    // All ways from right to left sum to one straight across: this alone makes the sum of
    // f(L) - f(R) what it shall be.
    let way = |[left, right]: [DVec2; 2]| left.x - right.x;
    let sum: f64 = chain.iter().map(ends).map(way).sum();
    if sum <= 0.0 {
        // They sum to nothing, as they cannot if a line has all left ends on its left.
        return None;
    }
    let steep = 2.0 * chain.len() as f64 / sum;
    let mut model = variables.maximise(margin).using(microlp);
    for [left, right] in chain.iter().map(ends) {
        for (p, side) in [(left, 1.0), (right, -1.0)] {
            let mut beyond = Expression::with_capacity(3);
            beyond.add_mul(side * p.y, slope);
            beyond.add_mul(side, constant);
            beyond.add_mul(-1.0, margin);
            model.add_constraint(beyond.geq(-side * steep * p.x));
        }
    }
    let solution = optimal(model.with_time_limit(LONGEST).solve())?;
    let [slope, constant, margin] = [slope, constant, margin].map(|v| solution.value(v));
    Some(Found {
        slope: DVec2::new(steep, slope),
        constant,
        margin,
    })
}

/// Ends in conflict, by a second programme: weights that make one point of the left ends and of the
/// right ends. Of such weights, a corner of the programme has at most four that are not zero.
fn contradiction(frame: &Frame, vertices: &Vertices, chain: &[Gate]) -> Option<Contradiction> {
    let mut variables = ProblemVariables::new();
    let mut weights = || -> Vec<Variable> {
        let positive = || variable().min(0.0);
        chain.iter().map(|_| variables.add(positive())).collect()
    };
    let (left, right) = (weights(), weights());
    let mut model = variables.minimise(0.0).using(microlp);
    let one = |weights: &[Variable]| weights.iter().sum::<Expression>().eq(1.0);
    model.add_constraint(one(&left));
    model.add_constraint(one(&right));
    for axis in [DVec2::X, DVec2::Y] {
        let mut difference = Expression::with_capacity(2 * chain.len());
        for (gate, (l, r)) in chain.iter().zip(left.iter().zip(&right)) {
            let place = |v| frame.enter(vertices.approx(v)).dot(axis);
            difference.add_mul(place(gate.left), *l);
            difference.add_mul(-place(gate.right), *r);
        }
        model.add_constraint(difference.eq(0.0));
    }
    let solution = optimal(model.with_time_limit(LONGEST).solve())?;
    let used = |weight: &Variable| solution.value(*weight) > 0.0;
    let mut found = Contradiction::default();
    for (gate, (l, r)) in chain.iter().zip(left.iter().zip(&right)) {
        if used(l) && !found.left.contains(&gate.left) {
            found.left.push(gate.left);
        }
        if used(r) && !found.right.contains(&gate.right) {
            found.right.push(gate.right);
        }
    }
    Some(found)
}

/// The solution, if the solver has proved it optimal.
fn optimal<E>(result: Result<MicroLpSolution, E>) -> Option<MicroLpSolution> {
    result
        .ok()
        .filter(|solution| matches!(solution.status(), SolutionStatus::Optimal))
}
