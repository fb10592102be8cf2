//! From the symbol of a door or window to one straight opening, from jamb to jamb.
//!
//! In: strokes of walls, symbols. Out: [`Hole`]s, and caps where a wall of two lines was cut.
//!
//! A door's arc tells where its leaf is when it is closed: from the hinge to that end of the arc to
//! which no leaf is drawn. A symbol without an arc is as long as it is along its longest line. From
//! its middle, rays both ways find the jambs. Where both do, the wall has a gap and the opening fills
//! it. Where the wall runs on behind the symbol, its lines are cut there, and the ends of a double
//! line are capped. All of this is in floating point: it decides what is meant, and everything exact
//! comes after it.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::super::finding::{Finding, Place, Severity};
use super::super::model::OpeningStyle;
use super::{Sizes, Stroke, Swing, Symbol};

/// Lines are parallel up to this sine of the angle between them (3°).
const PARALLEL: f64 = 0.05;

/// How far beyond its symbol an opening may reach for its jamb, as a part of its width: frames.
const REACH: f64 = 0.15;

/// How far a jamb, or a wall that runs on, may lie beside a symbol's line, as a part of its width:
/// drawn by eye.
const LOOSE: f64 = 0.06;

/// An opening on the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Its ends.
    pub ends: [DVec2; 2],
    /// Whether each end is written in the file.
    pub written: [bool; 2],
    /// What it is.
    pub style: OpeningStyle,
    /// Its name.
    pub name: Option<String>,
    /// Whether its leaf stands closed.
    pub shut: bool,
    /// Where it stands.
    pub place: Place,
}

/// What [`place`] makes of all symbols.
pub struct Cut {
    /// The openings.
    pub holes: Vec<Hole>,
    /// Walls across a double line, beside the openings cut into it.
    pub caps: Vec<Stroke>,
}

/// How wide the opening of a symbol is drawn; `None` for a symbol without extent.
pub fn width(symbol: &Symbol) -> Option<f64> {
    spans(symbol)
        .iter()
        .map(|s| s.ends[0].distance(s.ends[1]))
        .max_by(f64::total_cmp)
}

/// Places the openings of all symbols.
pub fn place(
    strokes: &[Stroke],
    symbols: &[Symbol],
    sizes: &Sizes,
    findings: &mut Vec<Finding>,
) -> Cut {
    let walls = Walls::new(strokes);
    let mut cut = Cut {
        holes: Vec::new(),
        caps: Vec::new(),
    };
    let (mut off, mut shapeless) = (Vec::new(), Vec::new());
    for symbol in symbols {
        let mut spans = spans(symbol);
        if spans.is_empty() {
            shapeless.push(symbol.place);
        }
        choose_closed(&mut spans, &walls);
        for span in joined(spans) {
            let found = walls.fit(&span, sizes);
            if !found.on_wall {
                off.push(Place::Point {
                    x: span.ends[0].midpoint(span.ends[1]).x,
                    y: span.ends[0].midpoint(span.ends[1]).y,
                });
            }
            cut.holes
                .extend(found.holes.into_iter().map(|(ends, written)| Hole {
                    ends,
                    written,
                    style: symbol.style,
                    name: symbol.name.clone(),
                    shut: symbol.shut,
                    place: symbol.place,
                }));
            cut.caps
                .extend(found.caps.into_iter().map(|[from, to]| Stroke {
                    from,
                    to,
                    written: [false; 2],
                    place: symbol.place,
                }));
        }
    }
    findings.extend(Finding::at(
        "opening-off-wall",
        Severity::Warning,
        "A door or window reaches no wall on one of its sides, so it may part nothing; draw it from \
         jamb to jamb.",
        off,
    ));
    findings.extend(Finding::at(
        "shapeless-opening",
        Severity::Warning,
        "A door or window has neither a line nor an arc that tells where it is; it was left out.",
        shapeless,
    ));
    cut
}

/// Where an opening may be.
struct Span {
    ends: [DVec2; 2],
    written: [bool; 2],
    /// For a door's arc of which no leaf tells: the other way it may be, from the same hinge.
    other: Option<DVec2>,
    /// Whether it comes from an arc, the hinge first.
    swings: bool,
}

/// The spans of a symbol: one for each of its larger arcs, or else one along its longest line.
fn spans(symbol: &Symbol) -> Vec<Span> {
    let radius = |a: &Swing| a.center.distance(a.ends[0]);
    let largest = symbol.arcs.iter().map(radius).fold(0.0, f64::max);
    let leaf_to = |arc: &Swing, end: DVec2| {
        let near = |p: DVec2, q: DVec2| p.distance(q) < 0.15 * radius(arc);
        (symbol.lines.iter()).any(|l| {
            near(l.from, arc.center) && near(l.to, end)
                || near(l.to, arc.center) && near(l.from, end)
        })
    };
    let mut spans: Vec<Span> = Vec::new();
    for arc in symbol.arcs.iter().filter(|a| radius(a) > 0.4 * largest) {
        let leaves = arc.ends.map(|end| leaf_to(arc, end));
        let (closed, other) = match leaves {
            [true, false] => (arc.ends[1], None),
            [false, true] => (arc.ends[0], None),
            _ => (arc.ends[0], Some(arc.ends[1])),
        };
        spans.push(Span {
            ends: [arc.center, closed],
            written: [false; 2],
            other,
            swings: true,
        });
    }
    if spans.is_empty() {
        spans.extend(along_longest_line(&symbol.lines));
    }
    spans.retain(|s| s.ends[0] != s.ends[1]);
    spans
}

/// The extent of lines along the longest of them, through their middle.
fn along_longest_line(lines: &[Stroke]) -> Option<Span> {
    let length = |s: &&Stroke| s.from.distance_squared(s.to);
    let longest = lines
        .iter()
        .max_by(|a, b| length(a).total_cmp(&length(b)))?;
    if let [line] = lines {
        return Some(Span {
            ends: [line.from, line.to],
            written: line.written,
            other: None,
            swings: false,
        });
    }
    let along = (longest.to - longest.from).try_normalize()?;
    let range = |axis: DVec2| {
        let points = lines.iter().flat_map(|s| [s.from, s.to]);
        points
            .map(|p| (p - longest.from).dot(axis))
            .fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)))
    };
    let (low, high) = range(along);
    let (near, far) = range(along.perp());
    let middle = longest.from + along.perp() * ((near + far) / 2.0);
    Some(Span {
        ends: [middle + along * low, middle + along * high],
        written: [false; 2],
        other: None,
        swings: false,
    })
}

/// Where no leaf tells which end of an arc is the closed one: that one which is nearer to a wall, or
/// where another leaf ends.
fn choose_closed(spans: &mut [Span], walls: &Walls) {
    for i in 0..spans.len() {
        let Some(other) = spans[i].other else {
            continue;
        };
        let span = &spans[i];
        let radius = span.ends[0].distance(span.ends[1]);
        let distance = |end: DVec2| {
            let leaves = spans.iter().enumerate().filter(|(j, _)| *j != i);
            leaves
                .flat_map(|(_, s)| [Some(s.ends[1]), s.other])
                .flatten()
                .map(|p| p.distance(end))
                .fold(walls.distance(end, radius), f64::min)
        };
        if distance(other) < distance(span.ends[1]) {
            spans[i].ends[1] = other;
        }
    }
}

/// The two leaves of a double door make one opening, from hinge to hinge.
fn joined(spans: Vec<Span>) -> Vec<Span> {
    let mut out: Vec<Span> = Vec::new();
    for span in spans {
        let width = span.ends[0].distance(span.ends[1]);
        let partner = out.iter_mut().find(|o| {
            let [a, b] = [o.ends[1] - o.ends[0], span.ends[1] - span.ends[0]];
            let apart = o.ends[1].distance(span.ends[1]);
            o.swings
                && span.swings
                && apart < REACH * width
                && a.dot(b) < 0.0
                && a.perp_dot(b).abs() <= PARALLEL * a.length() * b.length()
        });
        match partner {
            Some(o) => {
                o.ends[1] = span.ends[0];
                o.swings = false;
            }
            None => out.push(span),
        }
    }
    out
}

/// What became of a span.
struct Fitted {
    holes: Vec<([DVec2; 2], [bool; 2])>,
    caps: Vec<[DVec2; 2]>,
    on_wall: bool,
}

type Indexed = GeomWithData<Rectangle<[f64; 2]>, usize>;

/// The strokes of walls, by place.
struct Walls<'a> {
    strokes: &'a [Stroke],
    tree: RTree<Indexed>,
}

impl<'a> Walls<'a> {
    fn new(strokes: &'a [Stroke]) -> Walls<'a> {
        let boxed = |(i, s): (usize, &Stroke)| {
            let corners = Rectangle::from_corners(s.from.to_array(), s.to.to_array());
            GeomWithData::new(corners, i)
        };
        Walls {
            strokes,
            tree: RTree::bulk_load(strokes.iter().enumerate().map(boxed).collect()),
        }
    }

    /// Strokes near a segment, in their order.
    fn near(&self, a: DVec2, b: DVec2, by: f64) -> Vec<&'a Stroke> {
        let reach = AABB::from_corners((a.min(b) - by).to_array(), (a.max(b) + by).to_array());
        let found = self.tree.locate_in_envelope_intersecting(reach);
        let mut found: Vec<usize> = found.map(|near| near.data).collect();
        found.sort_unstable();
        found.into_iter().map(|i| &self.strokes[i]).collect()
    }

    /// How far it is to the nearest wall, if nearer than `most`.
    fn distance(&self, p: DVec2, most: f64) -> f64 {
        let near = self.near(p, p, most);
        near.iter()
            .map(|s| nearest_on(s, p).distance(p))
            .fold(most, f64::min)
    }

    /// The opening, or openings, of a span.
    fn fit(&self, span: &Span, sizes: &Sizes) -> Fitted {
        let [a, b] = span.ends;
        let width = a.distance(b);
        let along = (b - a) / width;
        let middle = a.midpoint(b);
        let close = (1e-6 * width).max(sizes.weld);
        let loose = close.max(LOOSE * width);
        let reach = width / 2.0 + REACH * width;
        if self.parallel(middle, along, width, loose).is_empty() {
            for close in [close, loose] {
                let hits = [-along, along].map(|way| self.hit(middle, way, reach, close));
                let [Some(before), Some(after)] = hits else {
                    continue;
                };
                // An end that is written in the file, and is where the wall is, stays as it is.
                let end = |i: usize, found: DVec2| {
                    let near = found.distance(span.ends[i]) <= (1e-6 * width).max(sizes.weld);
                    if near {
                        (span.ends[i], span.written[i])
                    } else {
                        (found, false)
                    }
                };
                let (first, second) = (end(0, before), end(1, after));
                return Fitted {
                    holes: vec![([first.0, second.0], [first.1, second.1])],
                    caps: Vec::new(),
                    on_wall: true,
                };
            }
        }
        let lines = self.parallel(middle, along, width, sizes.wall.max(loose));
        if lines.is_empty() {
            return Fitted {
                holes: vec![(span.ends, span.written)],
                caps: Vec::new(),
                on_wall: false,
            };
        }
        pierce(span, along, &lines)
    }

    /// The first point of a wall along a ray that passes it nearer than `close`.
    fn hit(&self, from: DVec2, way: DVec2, reach: f64, close: f64) -> Option<DVec2> {
        let near = self.near(from, from + way * reach, close);
        let hits = near.iter().filter_map(|s| {
            let d = s.to - s.from;
            let offsets = [s.from, s.to].map(|p| way.perp_dot(p - from));
            if offsets.iter().all(|o| o.abs() <= close) {
                // Along the ray: its nearer end.
                let ts = [s.from, s.to].map(|p| (p - from).dot(way));
                let (t, end) = if ts[0] <= ts[1] {
                    (ts[0], s.from)
                } else {
                    (ts[1], s.to)
                };
                return (t >= 0.0).then_some((t, end));
            }
            if offsets[0].min(offsets[1]) > close || offsets[0].max(offsets[1]) < -close {
                return None;
            }
            let share = (-offsets[0] / (offsets[1] - offsets[0])).clamp(0.0, 1.0);
            let p = s.from + d * share;
            let t = (p - from).dot(way);
            (t > close).then_some((t, p))
        });
        let within = hits.filter(|(t, _)| *t <= reach);
        within.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, p)| p)
    }

    /// Walls parallel to a span that run past its middle within a distance, from right to left.
    fn parallel(
        &self,
        middle: DVec2,
        along: DVec2,
        width: f64,
        within: f64,
    ) -> Vec<(f64, &'a Stroke)> {
        let near = self.near(middle, middle, within);
        let mut found: Vec<(f64, &Stroke)> = (near.into_iter())
            .filter_map(|s| {
                let d = s.to - s.from;
                let (x, y) = ((s.from - middle).dot(along), (s.to - middle).dot(along));
                let parallel = d.perp_dot(along).abs() <= PARALLEL * d.length();
                let covers = x.min(y) < -0.25 * width && x.max(y) > 0.25 * width;
                if !(parallel && covers) {
                    return None;
                }
                let share = -x / (y - x);
                let offset = along.perp_dot(s.from + d * share - middle);
                (offset.abs() <= within).then_some((offset, s))
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }
}

/// Cuts an opening into walls that run on behind its symbol.
fn pierce(span: &Span, along: DVec2, lines: &[(f64, &Stroke)]) -> Fitted {
    let mut fitted = Fitted {
        holes: Vec::new(),
        caps: Vec::new(),
        on_wall: true,
    };
    let mut last: Option<[DVec2; 2]> = None;
    for (_, line) in lines {
        let written = |i: usize| {
            let p = nearest_on(line, span.ends[i]);
            // An end that lies on the wall already stays as it is written.
            let stays = p.distance(span.ends[i]) <= 1e-9 * span.ends[0].distance(span.ends[1]);
            if stays {
                (span.ends[i], span.written[i])
            } else {
                (across(line, span.ends[i], along).unwrap_or(p), false)
            }
        };
        let (first, second) = (written(0), written(1));
        let ends = [first.0, second.0];
        if ends[0] == ends[1] {
            continue;
        }
        fitted.holes.push((ends, [first.1, second.1]));
        if let Some(last) = last {
            fitted.caps.extend([[last[0], ends[0]], [last[1], ends[1]]]);
        }
        last = Some(ends);
    }
    fitted.caps.retain(|[a, b]| a != b);
    fitted
}

/// The point of a stroke square across from `p`, seen along a span; none beyond the stroke's ends.
fn across(line: &Stroke, p: DVec2, along: DVec2) -> Option<DVec2> {
    let d = line.to - line.from;
    let share = (p - line.from).dot(along) / d.dot(along);
    (0.0..=1.0).contains(&share).then(|| line.from + d * share)
}

/// The nearest point of a stroke.
pub(super) fn nearest_on(line: &Stroke, p: DVec2) -> DVec2 {
    let d = line.to - line.from;
    let share = (p - line.from).dot(d) / d.length_squared();
    match share {
        s if s >= 1.0 => line.to,
        s if s > 0.0 => line.from + d * s,
        _ => line.from,
    }
}
