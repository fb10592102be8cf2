//! Boxes along the axes that hold something.

use glam::DVec3;

/// A closed box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its least coordinates.
    pub min: DVec3,
    /// Its greatest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// Holds nothing; neutral for [`Bounds::union`].
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// The least box around the points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let add = |b: Self, p: DVec3| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        };
        points.into_iter().fold(Self::EMPTY, add)
    }

    /// The least box around both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// What both have in common; holds nothing where they do not touch.
    #[inline]
    pub fn common(&self, other: &Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Larger by `by` on every side.
    #[inline]
    pub fn grown(&self, by: f64) -> Self {
        Self {
            min: self.min - by,
            max: self.max + by,
        }
    }

    /// Larger by what rounding may have cost the coordinates: eight units in the last place of the
    /// largest.
    pub fn rounded_out(&self) -> Self {
        self.grown(self.reach() * 2f64.powi(-49))
    }

    /// Lengths of the sides.
    #[inline]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The point in the middle.
    #[inline]
    pub fn centre(&self) -> DVec3 {
        self.min + self.size() * 0.5
    }

    /// Half the area of the surface; 0 for the empty box.
    #[inline]
    pub fn half_area(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let s = self.size();
        s.x * s.y + s.y * s.z + s.z * s.x
    }

    /// The greatest absolute coordinate; 0 for the empty box.
    pub fn reach(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        self.min.abs().max(self.max.abs()).max_element()
    }

    /// Whether they share a point, be it on their surfaces.
    #[inline]
    pub fn touches(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Whether all of `other` is inside.
    #[inline]
    pub fn holds(&self, other: &Self) -> bool {
        other.is_empty() || self.min.cmple(other.min).all() && other.max.cmple(self.max).all()
    }

    /// The corner whose coordinate along axis k is the greater one where bit k of `i` is set.
    pub fn corner(&self, i: usize) -> DVec3 {
        let pick = |k: usize| {
            if i >> k & 1 == 1 {
                self.max[k]
            } else {
                self.min[k]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unions_and_corners() {
        let a = Bounds::around([DVec3::new(1.0, 5.0, -2.0), DVec3::new(3.0, 4.0, 0.0)]);
        assert_eq!(a.min, DVec3::new(1.0, 4.0, -2.0));
        assert_eq!(a.size(), DVec3::new(2.0, 1.0, 2.0));
        assert_eq!(a.half_area(), 2.0 + 2.0 + 4.0);
        assert_eq!(a.reach(), 5.0);
        assert_eq!(a.corner(0), a.min);
        assert_eq!(a.corner(0b110), DVec3::new(1.0, 5.0, 0.0));
        assert_eq!(a.union(&Bounds::EMPTY), a);
        assert!(a.holds(&Bounds::EMPTY) && Bounds::EMPTY.is_empty() && !a.is_empty());
        let flat = Bounds::around([DVec3::new(3.0, 5.0, 0.0), DVec3::new(9.0, 9.0, 0.0)]);
        assert!(a.touches(&flat), "they share a corner");
        assert_eq!(a.common(&flat).size(), DVec3::ZERO);
        assert!(!a.touches(&flat.grown(-0.5)));
        assert!(a.rounded_out().min.x < 1.0 && a.rounded_out().min.x > 1.0 - 1e-13);
    }
}
