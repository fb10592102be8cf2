//! When a line is in a convex solid: the lecture's interval [l, M].

use crate::trace::accel::Contact;
use crate::trace::ray::Start;

/// Where a line passes a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// When.
    pub t: f64,
    /// Which face of the solid.
    pub part: u32,
}

/// From entering to leaving. Holds nothing if `enter` is later than `exit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The face through which the line comes in.
    pub enter: Face,
    /// The face through which it goes out.
    pub exit: Face,
}

impl Span {
    /// All the time.
    pub const ALWAYS: Self = Self::new(f64::NEG_INFINITY, f64::INFINITY, 0);

    /// Never.
    pub const NEVER: Self = Self::new(f64::INFINITY, f64::NEG_INFINITY, 0);

    /// In and out through the same face.
    pub const fn new(enter: f64, exit: f64, part: u32) -> Self {
        Self {
            enter: Face { t: enter, part },
            exit: Face { t: exit, part },
        }
    }

    /// Between two parallel planes, for a coordinate across them that begins as `at` and grows by
    /// `speed`. `parts` are the faces at `low` and at `high`. A line that runs in a face is inside.
    pub fn slab((low, high): (f64, f64), at: f64, speed: f64, parts: [u32; 2]) -> Self {
        if speed == 0.0 {
            return if low <= at && at <= high {
                Self::ALWAYS
            } else {
                Self::NEVER
            };
        }
        let face = |place: f64, part| Face {
            t: (place - at) / speed,
            part,
        };
        let (low, high) = (face(low, parts[0]), face(high, parts[1]));
        if speed > 0.0 {
            Self {
                enter: low,
                exit: high,
            }
        } else {
            Self {
                enter: high,
                exit: low,
            }
        }
    }

    /// Both at a time: the later entry, the earlier exit; of equals this one's.
    pub fn common(self, other: Self) -> Self {
        Self {
            enter: if other.enter.t > self.enter.t {
                other.enter
            } else {
                self.enter
            },
            exit: if other.exit.t < self.exit.t {
                other.exit
            } else {
                self.exit
            },
        }
    }

    /// The same, `by` later.
    pub fn later(mut self, by: f64) -> Self {
        self.enter.t += by;
        self.exit.t += by;
        self
    }

    /// Whether it holds no time.
    pub fn is_empty(&self) -> bool {
        self.enter.t > self.exit.t
    }

    /// The contact of a ray with a convex solid.
    ///
    /// A ray that starts on the surface and leaves cannot meet the solid again: it is skipped. One
    /// that goes in comes out at the end of the interval; at once if rounding left no interval (a ray
    /// that grazes), so that in and out always come in pairs. Otherwise the first positive of both
    /// ends: the far one for a ray that starts inside.
    pub fn contact(&self, from: Option<&Start>) -> Option<Contact> {
        let contact = |face: Face| Contact {
            t: face.t,
            part: face.part,
            weights: [0.0; 2],
        };
        match from {
            Some(start) if !start.inwards => None,
            Some(start) if self.is_empty() || self.exit.t <= 0.0 => Some(contact(Face {
                t: 0.0,
                part: start.part,
            })),
            Some(_) => Some(contact(self.exit)),
            None if self.is_empty() => None,
            None if self.enter.t > 0.0 => Some(contact(self.enter)),
            None => (self.exit.t > 0.0).then(|| contact(self.exit)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(inwards: bool) -> Option<Start> {
        Some(Start {
            primitive: 0,
            part: 9,
            inwards,
        })
    }

    #[test]
    fn the_first_positive_end_counts() {
        let t = |enter, exit| Span::new(enter, exit, 0).contact(None).map(|c| c.t);
        assert_eq!(t(1.0, 2.0), Some(1.0));
        assert_eq!(t(-1.0, 2.0), Some(2.0));
        assert_eq!(t(-2.0, -1.0), None);
        assert_eq!(t(2.0, 1.0), None);
        assert_eq!(t(0.0, 0.0), None);
    }

    #[test]
    fn a_start_on_the_surface() {
        let span = Span::new(0.1, 3.0, 1);
        assert_eq!(span.contact(start(false).as_ref()), None);
        assert_eq!(span.contact(start(true).as_ref()).unwrap().t, 3.0);
        // Rounding left nothing: out at once, through the face it came in by.
        let out = Span::NEVER.contact(start(true).as_ref()).unwrap();
        assert_eq!((out.t, out.part), (0.0, 9));
        let out = Span::new(-1.0, -0.5, 1).contact(start(true).as_ref());
        assert_eq!(out.unwrap().t, 0.0);
    }

    #[test]
    fn slabs() {
        let slab = |at, speed| Span::slab((1.0, 3.0), at, speed, [4, 5]);
        assert_eq!(slab(0.0, 2.0).enter, Face { t: 0.5, part: 4 });
        assert_eq!(slab(0.0, 2.0).exit, Face { t: 1.5, part: 5 });
        assert_eq!(slab(4.0, -1.0).enter, Face { t: 1.0, part: 5 });
        assert_eq!(slab(1.0, 0.0), Span::ALWAYS, "in the face");
        assert!(slab(0.9, -0.0).is_empty());
        let both = slab(0.0, 1.0).common(Span::new(2.0, 9.0, 7));
        assert_eq!((both.enter.part, both.exit.part), (7, 5));
    }
}
