//! Rays, and where they start.

use glam::DVec3;

/// A half-line `origin + t · direction`, t > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; of any length between 10^-100 and 10^100.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `t`.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// Where a ray starts that leaves a surface, so that it does not meet that surface again at once:
/// which primitive it is, and whether the ray goes into it or away from it. No distance is ever
/// compared with a small number for that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// The primitive on whose surface the origin lies.
    pub primitive: u32,
    /// Which part of it: the triangle of a mesh, the face of a solid.
    pub part: u32,
    /// Whether the ray goes into the primitive, that is against the geometric normal.
    pub inwards: bool,
}
