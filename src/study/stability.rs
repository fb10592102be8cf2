//! Which methods get hard levels right.
//!
//! In: levels that state their own answer ([`statement`]). Out: for each a [`Row`] that says what
//! every method answers: which statements it contradicts, and on how many pairs of cells it differs
//! from the exact set. [`table`] writes rows for people and programs.

pub mod statement;
pub mod table;

use crate::cells::{Options, Subdivision, subdivide};
use crate::level::Level;
use crate::pvs::flow::{FlowOptions, flow};
use crate::pvs::lp::lp_bounded;
use crate::pvs::search::search;
use crate::pvs::sweep::sweep;
use crate::pvs::{Class, Method, Progress, Pvs};

use self::statement::{Case, CaseError, Reading, Wrong};

/// The methods that are compared. The first is the truth about pairs that no statement names.
pub const METHODS: [Method; 4] = [Method::Sweep, Method::Search, Method::Lp, Method::Flow];

/// How the methods are compared.
#[derive(Clone, Copy, Debug)]
pub struct StabilityOptions {
    /// How the levels are cut into cells.
    pub subdivision: Subdivision,
    /// Where the search gives up, in cells entered.
    pub max_steps: u64,
    /// The linear programme is asked only where the exact search enters at most so many cells: it
    /// solves a programme for each, many times slower. It leaves open what it has not decided after
    /// entering as many from one source.
    pub lp_steps: u64,
}

impl Default for StabilityOptions {
    fn default() -> Self {
        Self {
            subdivision: Subdivision::Bsp,
            max_steps: 20_000_000,
            lp_steps: 40_000,
        }
    }
}

/// What came out for one case.
#[derive(Clone, Debug)]
pub struct Row {
    /// The level's file, without its ending.
    pub name: String,
    /// What it shows.
    pub shows: String,
    /// The statements that every method answers, those about sight.
    pub about_sight: usize,
    /// The other statements.
    pub others: usize,
    /// What came out.
    pub outcome: Outcome,
}

/// What became of a level.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// The reader refused it.
    Refused {
        /// In these words.
        message: String,
        /// The statements that are wrong about that.
        wrong: Vec<Wrong>,
    },
    /// It has an answer.
    Answered(Answered),
}

/// A level's cells, and what each method says of them.
#[derive(Clone, Debug)]
pub struct Answered {
    /// Number of cells.
    pub cells: usize,
    /// Ordered pairs of cells that see each other, each with itself included.
    pub pairs: u64,
    /// The statements about the level and its cells that are wrong.
    pub wrong: Vec<Wrong>,
    /// What each of [`METHODS`] says.
    pub methods: Vec<Answer>,
}

/// What a method says of a level.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Nothing: it gave up after too many steps.
    GaveUp,
    /// It was not asked, since that would take too long.
    NotAsked,
    /// A visible set.
    Given(Given),
}

/// How good a method's visible set is. Pairs are ordered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    /// The statements about sight that it contradicts.
    pub wrong: Vec<Wrong>,
    /// Pairs that see each other, but not in this set.
    pub missed: u64,
    /// Pairs that do not see each other, but do in this set.
    pub invented: u64,
    /// Pairs among those that it left open.
    pub undecided: u64,
}

impl Given {
    /// Whether nothing is wrong.
    pub fn is_right(&self) -> bool {
        self.wrong.is_empty() && self.missed == 0 && self.invented == 0
    }
}

impl Row {
    /// Whether the exact methods contradict nothing that is stated.
    pub fn exact_is_right(&self) -> bool {
        match &self.outcome {
            Outcome::Refused { wrong, .. } => wrong.is_empty(),
            Outcome::Answered(answered) => answered.exact_is_right(),
        }
    }
}

impl Answered {
    /// Whether both exact methods came to an end, agree, and contradict no statement.
    pub fn exact_is_right(&self) -> bool {
        let exact = METHODS.iter().zip(&self.methods);
        let mut exact = exact.filter(|(m, _)| m.class() == Class::Exact);
        let right = |(_, a): (_, &Answer)| matches!(a, Answer::Given(g) if g.is_right());
        self.wrong.is_empty() && exact.all(right)
    }
}

/// Asks all methods about a case. Uses the current rayon thread pool; the result depends on nothing
/// but the case and the options.
///
/// # Errors
/// A case that cannot be judged because of a mistake in the file.
pub fn judge(case: &Case, options: &StabilityOptions) -> Result<Row, CaseError> {
    let about_sight = (case.statements.iter())
        .filter(|s| s.claim.is_about_sight())
        .count();
    let outcome = match case.read()? {
        Reading::Refused { message, wrong } => Outcome::Refused { message, wrong },
        Reading::Level(level) => Outcome::Answered(answers(case, &level, options)?),
    };
    Ok(Row {
        name: case.name.clone(),
        shows: case.shows.clone(),
        about_sight,
        others: case.statements.len() - about_sight,
        outcome,
    })
}

fn answers(case: &Case, level: &Level, options: &StabilityOptions) -> Result<Answered, CaseError> {
    let cells = Options {
        subdivision: options.subdivision,
        ..Options::default()
    };
    let graph = subdivide(level, &cells);
    let places = case.places(level, &graph)?;
    let mut wrong = case.wrong_of_level(level);
    wrong.extend(case.wrong_of_cells(&graph));
    let progress = Progress::default();
    let truth = sweep(&graph, &progress);
    let given = |pvs: &Pvs| {
        Answer::Given(Given {
            wrong: places.wrong(pvs),
            missed: beyond(&truth, pvs),
            invented: beyond(pvs, &truth),
            undecided: pvs.undecided,
        })
    };
    let searched = search(&graph, Some(options.max_steps), &progress);
    let quick = (searched.as_ref()).is_some_and(|pvs| pvs.steps <= options.lp_steps);
    let methods = METHODS.map(|method| match method {
        Method::Search => searched.as_ref().map_or(Answer::GaveUp, given),
        Method::Lp if !quick => Answer::NotAsked,
        Method::Lp => given(&lp_bounded(&graph, options.lp_steps, &progress)),
        Method::Flow => given(&flow(&graph, &FlowOptions::of(level), &progress)),
        _ => given(&truth),
    });
    Ok(Answered {
        cells: graph.cells.len(),
        pairs: truth.pairs(),
        wrong,
        methods: methods.to_vec(),
    })
}

/// Ordered pairs that one set holds and the other does not.
fn beyond(set: &Pvs, other: &Pvs) -> u64 {
    let differ = |i: usize| {
        let words = set.visible.row(i).iter().zip(other.visible.row(i));
        words
            .map(|(a, b)| u64::from((a & !b).count_ones()))
            .sum::<u64>()
    };
    (0..set.visible.n()).map(differ).sum()
}
