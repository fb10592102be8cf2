//! Openings in height along one line of the plan: is there a straight line through all of them?
//!
//! In: for each opening, how far along the line it stands, and its bottom and top. Out: a line in
//! the vertical plane that clears them with room to spare, or three that contradict each other. The
//! lines that pass are kept as the steepest and the flattest of them and two hulls, exactly as
//! [`crate::sight::funnel`] keeps stabbing lines on the plan. All in f64: the answer is a proposal,
//! for others to prove.

/// An opening that the line has to pass strictly between bottom and top.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    /// Number of the opening in its chain.
    pub gate: u32,
    /// How far along the line.
    pub s: f64,
    pub bottom: f64,
    pub top: f64,
}

/// The height `rise · s + base` above the place `s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slope {
    pub rise: f64,
    pub base: f64,
}

impl Slope {
    fn through(a: [f64; 2], b: [f64; 2]) -> Self {
        let rise = (b[1] - a[1]) / (b[0] - a[0]);
        Self {
            rise,
            base: a[1] - rise * a[0],
        }
    }

    pub fn at(self, s: f64) -> f64 {
        self.rise * s + self.base
    }
}

/// Three openings of a chain, in its order, through which no straight line passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Clash {
    pub gates: [u32; 3],
    /// The middle one is too low for the outer two: its top against their bottoms. Otherwise it is
    /// too high: its bottom against their tops.
    pub dips: bool,
}

/// A point that a line has to stay above, or below.
type Point = ([f64; 2], u32);

/// The points on one side that still matter: those of a hull that bulges towards the lines.
#[derive(Default)]
struct Hull {
    points: Vec<Point>,
    start: usize,
}

/// Twice the area of the triangle, positive for a left turn.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Hull {
    fn reset(&mut self, p: Point) {
        self.points.clear();
        self.points.push(p);
        self.start = 0;
    }

    /// Adds a point; `left` says that the hull turns left at its points (a hull of tops).
    fn push(&mut self, p: Point, left: bool) {
        while self.points.len() - self.start >= 2 {
            let n = self.points.len();
            let area = turn(self.points[n - 2].0, self.points[n - 1].0, p.0);
            if if left { area > 0.0 } else { area < 0.0 } {
                break;
            }
            self.points.pop();
        }
        self.points.push(p);
    }

    /// The point in which the line from the hull to `p` touches it; those before it are dropped.
    fn touch(&mut self, p: [f64; 2], left: bool) -> Point {
        while self.start + 1 < self.points.len() {
            let area = turn(self.points[self.start].0, p, self.points[self.start + 1].0);
            if if left { area > 0.0 } else { area < 0.0 } {
                break;
            }
            self.start += 1;
        }
        self.points[self.start]
    }

    fn edges(&self) -> impl Iterator<Item = Slope> + '_ {
        self.points[self.start..]
            .windows(2)
            .map(|w| Slope::through(w[0].0, w[1].0))
    }
}

/// Room for one question after the other.
#[derive(Default)]
pub(super) struct Upright {
    tops: Hull,
    bottoms: Hull,
    /// The clashes of the last question, each with the height by which it fails.
    clashes: Vec<(f64, Clash)>,
}

impl Upright {
    /// Why the last question's answer was none: a clash for every slot that the lines through those
    /// before it miss (such slots left out), the worst one first.
    pub fn clashes(&mut self) -> impl Iterator<Item = Clash> + '_ {
        self.clashes.sort_by(|a, b| b.0.total_cmp(&a.0));
        self.clashes.iter().map(|(_, clash)| *clash)
    }

    /// A line through all slots, which stand one behind the other, if there is one.
    pub fn pass(&mut self, slots: &[Slot]) -> Option<Slope> {
        self.clashes.clear();
        let low = |slot: &Slot| ([slot.s, slot.bottom], slot.gate);
        let high = |slot: &Slot| ([slot.s, slot.top], slot.gate);
        let (first, second) = match slots {
            [] => {
                return Some(Slope {
                    rise: 0.0,
                    base: 0.0,
                });
            }
            [one] => {
                return Some(Slope {
                    rise: 0.0,
                    base: (one.bottom + one.top) / 2.0,
                });
            }
            [first, second, ..] => (first, second),
        };
        self.bottoms.reset(low(first));
        self.tops.reset(high(first));
        // The steepest line passes over a bottom first and under a top later.
        let mut steep = (low(first), high(second));
        let mut flat = (high(first), low(second));
        self.bottoms.push(low(second), false);
        self.tops.push(high(second), true);
        for slot in &slots[2..] {
            let highest = Slope::through(steep.0.0, steep.1.0).at(slot.s);
            let lowest = Slope::through(flat.0.0, flat.1.0).at(slot.s);
            // A product decides, not the quotient: it has no rounding where the numbers have few digits.
            let above = |line: (Point, Point), z: f64| turn(line.0.0, line.1.0, [slot.s, z]);
            if above(steep, slot.bottom) >= 0.0 {
                let clash = Clash {
                    gates: [steep.0.1, steep.1.1, slot.gate],
                    dips: true,
                };
                self.clashes.push((slot.bottom - highest, clash));
                continue;
            }
            if above(flat, slot.top) <= 0.0 {
                let clash = Clash {
                    gates: [flat.0.1, flat.1.1, slot.gate],
                    dips: false,
                };
                self.clashes.push((lowest - slot.top, clash));
                continue;
            }
            let lowers = above(steep, slot.top) < 0.0;
            let lifts = above(flat, slot.bottom) > 0.0;
            if lowers {
                let top = high(slot);
                steep = (self.bottoms.touch(top.0, false), top);
            }
            if lifts {
                let bottom = low(slot);
                flat = (self.tops.touch(bottom.0, true), bottom);
            }
            if lowers {
                self.tops.push(high(slot), true);
            }
            if lifts {
                self.bottoms.push(low(slot), false);
            }
        }
        if !self.clashes.is_empty() {
            return None;
        }
        // The lines that pass are a convex polygon, of which these are the corners.
        let corners = [
            Slope::through(steep.0.0, steep.1.0),
            Slope::through(flat.0.0, flat.1.0),
        ];
        let all = corners
            .into_iter()
            .chain(self.tops.edges())
            .chain(self.bottoms.edges());
        let mut n = 0.0;
        let mut sum = Slope {
            rise: 0.0,
            base: 0.0,
        };
        for slope in all {
            n += 1.0;
            sum.rise += slope.rise;
            sum.base += slope.base;
        }
        Some(Slope {
            rise: sum.rise / n,
            base: sum.base / n,
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    /// Whether three openings contradict each other, in whole numbers.
    fn contradicts(slots: &[[i64; 3]], clash: Clash) -> bool {
        let [i, j, k] = clash.gates.map(|g| slots[g as usize]);
        let (before, after) = (j[0] - i[0], k[0] - j[0]);
        if clash.dips {
            (j[2] - i[1]) * after + (j[2] - k[1]) * before <= 0
        } else {
            (i[2] - j[1]) * after + (k[2] - j[1]) * before <= 0
        }
    }

    fn three_contradict(slots: &[[i64; 3]]) -> bool {
        let n = slots.len() as u32;
        let triples =
            (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
        triples
            .flat_map(|gates| [true, false].map(|dips| Clash { gates, dips }))
            .any(|clash| contradicts(slots, clash))
    }

    #[test]
    fn a_line_passes_just_where_no_three_openings_contradict_each_other() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut upright = Upright::default();
        let mut answers = [0; 2];
        for _ in 0..20_000 {
            let n = random.random_range(1..8);
            let mut s = 0;
            let slots: Vec<[i64; 3]> = (0..n)
                .map(|_| {
                    s += random.random_range(1..5);
                    let bottom = random.random_range(0..8);
                    [s, bottom, bottom + random.random_range(1..5)]
                })
                .collect();
            let given: Vec<Slot> = (0..)
                .zip(&slots)
                .map(|(gate, slot)| {
                    let [s, bottom, top] = slot.map(|n| n as f64);
                    Slot {
                        gate,
                        s,
                        bottom,
                        top,
                    }
                })
                .collect();
            let blocked = three_contradict(&slots);
            answers[usize::from(blocked)] += 1;
            match upright.pass(&given) {
                Some(slope) => {
                    assert!(!blocked, "{slots:?}: {slope:?}");
                    let through = |slot: &Slot| {
                        let z = slope.at(slot.s);
                        slot.bottom < z && z < slot.top
                    };
                    assert!(given.iter().all(through), "{slots:?}: {slope:?}");
                }
                None => {
                    assert!(blocked, "{slots:?}");
                    for clash in upright.clashes() {
                        assert!(contradicts(&slots, clash), "{slots:?}: {clash:?}");
                    }
                }
            }
        }
        assert!(answers.into_iter().all(|n| n > 2000), "{answers:?}");
    }
}
