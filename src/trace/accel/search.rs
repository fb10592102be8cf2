//! The two questions that every structure answers, as what happens at a primitive.
//!
//! # Why all structures agree
//!
//! A contact counts only if the ray passes the primitive's own (slackened, see [`super::cast`]) box,
//! and its t is moved into the computed interval of that box: by a few units in the last place, if at
//! all. So the point at t lies less than 16/15 of the slack beside the box: however a shape computes
//! its t, and whatever rounding does there, a structure that reaches each primitive whose box the ray
//! passes finds the very same contact as brute force does. Of contacts with equal t the lower number
//! wins.
//!
//! The primitive on which the ray starts is tested beforehand, without its box: the origin may be
//! rounded out of it.

use super::cast::{BoxTest, Cast};
use super::count::Count;
use super::primitives::{Contact, Found, Primitives, Want};
use crate::trace::ray::Start;

/// What a walk through a structure does at a primitive.
pub trait Search {
    /// Tests a primitive. Returns whether the search is over.
    fn test<C: Count>(&mut self, primitive: u32, count: &mut C) -> bool;

    /// What is later than this is of no interest.
    fn limit(&self) -> f64;
}

/// What both questions know.
struct Query<'a, P> {
    primitives: &'a P,
    cast: &'a Cast,
    boxes: BoxTest,
    /// The primitive on which the ray starts, done already.
    skip: u32,
}

impl<'a, P: Primitives> Query<'a, P> {
    fn new(primitives: &'a P, cast: &'a Cast, start: Option<&Start>, slack: f64) -> Self {
        Self {
            primitives,
            cast,
            boxes: cast.boxes(slack),
            skip: start.map_or(u32::MAX, |s| s.primitive),
        }
    }

    #[inline]
    fn contact<C: Count>(
        &self,
        primitive: u32,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact> {
        if primitive == self.skip {
            return None;
        }
        count.test();
        let (near, far) = self.boxes.interval(&self.primitives.bounds(primitive));
        if near > far || near > limit {
            return None;
        }
        let contact = self
            .primitives
            .contact(primitive, self.cast, None, want, limit, count)?;
        Some(Contact {
            t: contact.t.clamp(near, far),
            ..contact
        })
    }
}

/// Tests the primitive on which the ray starts.
fn own<P: Primitives, C: Count>(
    primitives: &P,
    cast: &Cast,
    start: Option<&Start>,
    (want, limit): (Want, f64),
    count: &mut C,
) -> Option<Found> {
    let start = start?;
    count.test();
    let primitive = start.primitive;
    let contact = primitives.contact(primitive, cast, Some(start), want, limit, count)?;
    Some(Found { primitive, contact })
}

/// Looks for the first contact.
pub(super) struct Nearest<'a, P> {
    query: Query<'a, P>,
    limit: f64,
    best: Option<Found>,
}

impl<'a, P: Primitives> Nearest<'a, P> {
    pub fn new<C: Count>(
        primitives: &'a P,
        cast: &'a Cast,
        start: Option<&Start>,
        (limit, slack): (f64, f64),
        count: &mut C,
    ) -> Self {
        let best = own(primitives, cast, start, (Want::Nearest, limit), count)
            .filter(|found| found.contact.t <= limit);
        Self {
            query: Query::new(primitives, cast, start, slack),
            limit: best.map_or(limit, |b| b.contact.t),
            best,
        }
    }

    pub fn found(self) -> Option<Found> {
        self.best
    }
}

impl<P: Primitives> Search for Nearest<'_, P> {
    #[inline]
    fn test<C: Count>(&mut self, primitive: u32, count: &mut C) -> bool {
        let contact = self
            .query
            .contact(primitive, Want::Nearest, self.limit, count);
        if let Some(contact) = contact {
            let better = contact.t < self.limit
                || contact.t == self.limit && self.best.is_none_or(|b| primitive < b.primitive);
            if better {
                self.limit = contact.t;
                self.best = Some(Found { primitive, contact });
            }
        }
        false
    }

    #[inline]
    fn limit(&self) -> f64 {
        self.limit
    }
}

/// Looks for any contact before a limit.
pub(super) struct Any<'a, P> {
    query: Query<'a, P>,
    before: f64,
    found: Option<Found>,
}

impl<'a, P: Primitives> Any<'a, P> {
    pub fn new<C: Count>(
        primitives: &'a P,
        cast: &'a Cast,
        start: Option<&Start>,
        (before, slack): (f64, f64),
        count: &mut C,
    ) -> Self {
        let found = own(primitives, cast, start, (Want::Any, before), count);
        Self {
            query: Query::new(primitives, cast, start, slack),
            before,
            found: found.filter(|found| found.contact.t < before),
        }
    }

    pub fn found(&self) -> Option<Found> {
        self.found
    }
}

impl<P: Primitives> Search for Any<'_, P> {
    #[inline]
    fn test<C: Count>(&mut self, primitive: u32, count: &mut C) -> bool {
        let contact = self.query.contact(primitive, Want::Any, self.before, count);
        if let Some(contact) = contact.filter(|contact| contact.t < self.before) {
            self.found = Some(Found { primitive, contact });
        }
        self.found.is_some()
    }

    #[inline]
    fn limit(&self) -> f64 {
        self.before
    }
}
