//! How structures that cut space into cells make sure that no contact falls between two cells.
//!
//! A walk assigns every t to a cell, by times at which the ray crosses planes, each rounded. What it
//! holds for the point at t may so lie a little beside the cell; and the contact at t a little beside
//! the primitive's box ([`super::search`]: 16/15 of the slack g). Instead of treating edges and
//! corners one by one, a primitive is put into every cell that its box touches when larger by
//! `margin` on every side. With h the distance between the point at t and its cell, nothing is missed
//! if 16/15·g + h ≤ margin. h is below g/15 where the time of each plane is computed afresh, and below
//! 2.2·g where a grid of at most 128 cells in a row adds up steps. So 4·g ≤ margin is enough, and
//! that holds for every origin within about a hundred thousand sizes of the scene. A ray from farther
//! away (or from far away in a scene that is itself small and far from the origin of coordinates) is
//! tested against every primitive: its rounding errors are larger than the cells' margin.

use super::bounds::Bounds;
use super::cast::Cast;
use super::primitives::Primitives;

/// The box that is cut into cells, and how much primitives' boxes are enlarged.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin {
    /// Around all enlarged boxes; empty if there is no primitive.
    pub root: Bounds,
    /// By how much they are.
    by: f64,
    reach: f64,
}

/// Times the slack, what the margin must be at least.
const SAFE: f64 = 4.0;

impl Margin {
    pub fn new<P: Primitives>(primitives: &P) -> Self {
        let all = whole(primitives);
        let reach = all.reach();
        if all.is_empty() {
            return Self {
                root: all,
                by: 0.0,
                reach,
            };
        }
        let by = (all.size().max_element() * 2f64.powi(-26))
            .max(reach * 2f64.powi(-43))
            .max(1e-280);
        // Once more by as much, so that adding is never lost to rounding at the border.
        Self {
            root: all.grown(2.0 * by),
            by,
            reach,
        }
    }

    /// The enlarged boxes of all primitives.
    pub fn boxes<P: Primitives>(&self, primitives: &P) -> Vec<Bounds> {
        (0..primitives.len() as u32)
            .map(|i| primitives.bounds(i).grown(self.by))
            .collect()
    }

    /// Whether the cells are safe for the ray.
    #[inline]
    pub fn covers(&self, cast: &Cast) -> bool {
        SAFE * cast.slack(self.reach) <= self.by
    }

    /// When the ray is in the root: from the first to the second.
    #[inline]
    pub fn interval(&self, cast: &Cast) -> (f64, f64) {
        cast.boxes(0.0).interval(&self.root)
    }
}

/// The box around all primitives.
pub(super) fn whole<P: Primitives>(primitives: &P) -> Bounds {
    (0..primitives.len() as u32).fold(Bounds::EMPTY, |all, i| all.union(&primitives.bounds(i)))
}
