//! What the hand-worked tests of the shapes share.

use super::span::Span;
use crate::trace::ray::Ray;

pub(super) fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
    Ray {
        origin: origin.into(),
        direction: direction.into(),
    }
}

/// The ends of a solid's interval.
pub(super) fn span(
    of: impl Fn(&Ray) -> Span,
    origin: [f64; 3],
    direction: [f64; 3],
) -> Option<[f64; 2]> {
    let span = of(&ray(origin, direction));
    (!span.is_empty()).then_some([span.enter.t, span.exit.t])
}

/// Both ends are as expected, to so much.
#[track_caller]
pub(super) fn within(found: Option<[f64; 2]>, expected: [f64; 2], error: f64) {
    let near = |found: [f64; 2]| (0..2).all(|i| (found[i] - expected[i]).abs() <= error);
    assert!(found.is_some_and(near), "{found:?}, not {expected:?}");
}
