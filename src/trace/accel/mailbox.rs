//! Remembers which primitives a query has tested, where one lies in several cells.
//!
//! A table of a few entries on the stack, one per residue of the number, in which a newer primitive
//! replaces an older one: nothing to clear between rays, nothing shared between threads, and a
//! primitive forgotten is tested once more, which changes nothing but time.

/// The last primitives tested.
pub(super) struct Mailbox {
    last: [u32; Self::SIZE],
}

impl Mailbox {
    const SIZE: usize = 32;

    /// Nothing tested so far.
    pub fn new() -> Self {
        Self {
            last: [u32::MAX; Self::SIZE],
        }
    }

    /// Notes the primitive; whether it is new, as far as is known.
    #[inline]
    pub fn is_new(&mut self, primitive: u32) -> bool {
        let entry = &mut self.last[primitive as usize % Self::SIZE];
        let new = *entry != primitive;
        *entry = primitive;
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_primitive_is_new_once_until_another_takes_its_place() {
        let mut mailbox = Mailbox::new();
        assert!(mailbox.is_new(3));
        assert!(mailbox.is_new(4));
        assert!(!mailbox.is_new(3));
        assert!(mailbox.is_new(3 + Mailbox::SIZE as u32));
        assert!(mailbox.is_new(3));
    }
}
