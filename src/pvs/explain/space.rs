//! What heights add to a view on the plan.

use crate::cells::{CellGraph, CellId, EdgeId};
use crate::pvs::heights::{ChainAnswer, HeightsAnswer, HeightsOptions, Passage, through, witness};

/// Whether two cells that see each other on the plan do so in space.
#[derive(Clone, Debug, PartialEq)]
pub enum Space {
    /// They do, this way.
    Seen(Passage),
    /// Floors and ceilings stand between. The openings on the plan's view that contradict each
    /// other, at most three; none where different ones do for different lines.
    Blocked(Vec<EdgeId>),
    /// Not known within the budget: counts as seen.
    Undecided,
}

/// Asks about two cells that see each other on the plan along a chain of portals.
pub(super) fn space(
    graph: &CellGraph,
    a: CellId,
    b: CellId,
    chain: &[EdgeId],
    options: &HeightsOptions,
) -> Space {
    match witness(graph, a, b, options) {
        HeightsAnswer::Visible(passage) => Space::Seen(passage),
        HeightsAnswer::Undecided => Space::Undecided,
        HeightsAnswer::Hidden => Space::Blocked(match through(graph, chain, options) {
            ChainAnswer::Blocked(openings) => openings,
            _ => Vec::new(),
        }),
    }
}
