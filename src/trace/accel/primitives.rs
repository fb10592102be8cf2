//! What the structures are built over.

use super::bounds::Bounds;
use super::cast::Cast;
use super::count::Count;
use crate::trace::ray::Start;

/// Numbered things that have bounds and can be hit: the objects of a cell, the triangles of a mesh,
/// the surfaces of a level.
pub trait Primitives {
    /// How many there are.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A finite box around the primitive, not empty.
    fn bounds(&self, primitive: u32) -> Bounds;

    /// Where the ray meets the primitive first, at t > 0. Contacts later than `limit` may be left
    /// out; apart from that `limit` has no influence. A ray that starts on the primitive says so by
    /// `from`.
    fn contact<C: Count>(
        &self,
        primitive: u32,
        cast: &Cast,
        from: Option<&Start>,
        want: Want,
        limit: f64,
        count: &mut C,
    ) -> Option<Contact>;
}

/// Which contact is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Want {
    /// The first.
    Nearest,
    /// Any before the limit.
    Any,
}

/// Where a ray meets a primitive: as much as it takes to compare, and to find the rest later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// In multiples of the ray's direction.
    pub t: f64,
    /// Which part of the primitive: the triangle of a mesh, the face of a solid.
    pub part: u32,
    /// Weights of the second and third corner, of triangles; else 0.
    pub weights: [f64; 2],
}

/// The answer to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Which primitive is met.
    pub primitive: u32,
    /// Where.
    pub contact: Contact,
}
