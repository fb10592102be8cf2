//! No structure: every primitive is tested. What the others are measured against.

use super::Walk;
use super::cast::Cast;
use super::count::Count;
use super::primitives::Primitives;
use super::search::Search;

/// All primitives in a row.
#[derive(Clone, Debug)]
pub struct Brute {
    len: u32,
}

impl Brute {
    /// Over so many primitives.
    pub fn new<P: Primitives>(primitives: &P) -> Self {
        Self {
            len: primitives.len() as u32,
        }
    }
}

impl Walk for Brute {
    fn walk<S: Search, C: Count>(&self, _: &Cast, _: f64, search: &mut S, count: &mut C) {
        all(self.len, search, count);
    }

    fn bytes(&self) -> usize {
        size_of::<Self>()
    }

    fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String> {
        if self.len as usize == primitives.len() {
            Ok(())
        } else {
            Err(format!("{} primitives, not {}", primitives.len(), self.len))
        }
    }
}

/// Tests the first `len` primitives.
pub(super) fn all<S: Search, C: Count>(len: u32, search: &mut S, count: &mut C) {
    for primitive in 0..len {
        if search.test(primitive, count) {
            return;
        }
    }
}
