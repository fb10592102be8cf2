//! Gathers what a reader finds in a drawing, sorted by what it was drawn for.
//!
//! In: outlines of lines, arcs and curves with their [`Ink`]. Out: the strokes, symbols and solids of
//! a [`Drawing`](super::Drawing), and findings that count and name what was left out. Parts of doors
//! and windows that no block or group holds together are one symbol where their boxes touch.

use std::collections::BTreeMap;

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::super::finding::{Finding, Place, Severity};
use super::super::model::OpeningStyle;
use super::flatten::Arc;
use super::role::Role;
use super::unit::Unit;
use super::{Stroke, Swing, Symbol, curves_cut, left_out};

/// Most points of all walls, doors and windows together.
pub const MOST_POINTS: usize = 2_000_000;

/// What something is drawn with.
#[derive(Clone, Debug)]
pub struct Ink<'a> {
    /// What it was drawn for, if its names tell.
    pub role: Option<Role>,
    /// Name of its layer, for messages.
    pub layer: &'a str,
    /// Number of the block or group that holds a symbol together; 0: none.
    pub group: u32,
    /// Whether a closed outline is filled, so that its inside is solid where it is a wall.
    pub filled: bool,
    /// Whether its ends are written in the file.
    pub written: bool,
}

/// One way of the pen.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Where it begins.
    pub start: DVec2,
    /// What follows.
    pub parts: Vec<Part>,
}

/// A part of an outline, from where the one before ends.
#[derive(Clone, Debug)]
pub enum Part {
    /// Straight to a point.
    Line(DVec2),
    /// Along an arc, which ends in the point.
    Arc(Arc, DVec2),
    /// Along a curve, already cut into points; the last one is its end.
    Curve(Vec<DVec2>),
}

impl Part {
    fn end(&self) -> Option<DVec2> {
        match self {
            Part::Line(to) | Part::Arc(_, to) => Some(*to),
            Part::Curve(points) => points.last().copied(),
        }
    }
}

impl Outline {
    /// Whether it ends where it begins.
    fn is_closed(&self) -> bool {
        self.parts.last().and_then(Part::end) == Some(self.start)
    }
}

/// A piece of a symbol before it is known what belongs together.
struct Piece {
    style: OpeningStyle,
    group: u32,
    lines: Vec<Stroke>,
    arcs: Vec<Swing>,
    place: Place,
}

/// What has been found so far.
#[derive(Default)]
pub struct Collector {
    tolerance: f64,
    walls: Vec<Stroke>,
    solids: Vec<Vec<Vec<DVec2>>>,
    unnamed: Vec<Stroke>,
    unnamed_solids: Vec<Vec<Vec<DVec2>>>,
    pieces: Vec<Piece>,
    /// Places of what was left out, by layer or kind.
    ignored: BTreeMap<String, Vec<Place>>,
    unknown: BTreeMap<String, Vec<Place>>,
    furniture: BTreeMap<String, Vec<Place>>,
    taken: BTreeMap<(Role, String), usize>,
    curves: Vec<Place>,
    curve_pieces: usize,
    points: usize,
}

/// What a collector hands over.
pub struct Collected {
    /// Walls.
    pub strokes: Vec<Stroke>,
    /// Solid shapes, each a set of rings.
    pub solids: Vec<Vec<Vec<DVec2>>>,
    /// Doors and windows.
    pub symbols: Vec<Symbol>,
    /// What was taken for what, and what was left out.
    pub findings: Vec<Finding>,
    /// What has no name that tells, by layer: for the message where there are no walls.
    pub layers: Vec<String>,
    /// What else is drawn, and was left out, by kind: for the same message.
    pub others: Vec<String>,
    /// Whether everything without a telling name was taken for walls.
    pub unnamed: bool,
}

fn at(p: DVec2) -> Place {
    Place::Point { x: p.x, y: p.y }
}

impl Collector {
    /// An empty one that cuts curves to a tolerance.
    pub fn new(tolerance: f64) -> Collector {
        Collector {
            tolerance,
            ..Collector::default()
        }
    }

    /// The tolerance for curves.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Whether there is more than any plan has.
    pub fn is_full(&self) -> bool {
        self.points > MOST_POINTS
    }

    /// Leaves something out: an entity of a kind that is no line.
    pub fn ignore(&mut self, what: &str, place: Place) {
        self.points += 1;
        self.ignored
            .entry(what.to_string())
            .or_default()
            .push(place);
    }

    /// Takes a shape of one or more outlines.
    pub fn shape(&mut self, ink: &Ink, outlines: &[Outline]) {
        let Some(first) = outlines.first() else {
            return;
        };
        let place = at(first.start);
        self.points += 1;
        let named = |map: &mut BTreeMap<String, Vec<Place>>| {
            map.entry(format!("layer {}", ink.layer))
                .or_default()
                .push(place);
        };
        match ink.role {
            Some(Role::Ignored) => return named(&mut self.ignored),
            Some(Role::Furniture) => return named(&mut self.furniture),
            None => named(&mut self.unknown),
            Some(role) => *self.taken.entry((role, ink.layer.to_string())).or_default() += 1,
        }
        let style = match ink.role {
            Some(Role::Door) => Some(OpeningStyle::Door),
            Some(Role::Window) => Some(OpeningStyle::Window),
            Some(Role::Archway) => Some(OpeningStyle::Archway),
            _ => None,
        };
        if let Some(style) = style {
            return self.piece(style, ink, outlines, place);
        }
        let mut rings = Vec::new();
        for outline in outlines {
            let points = self.flatten(outline);
            let written = |i: usize| ink.written && points[i].1;
            let strokes = (1..points.len()).map(|i| Stroke {
                from: points[i - 1].0,
                to: points[i].0,
                written: [written(i - 1), written(i)],
                place: at(points[i - 1].0),
            });
            match ink.role {
                None => self.unnamed.extend(strokes),
                Some(_) => self.walls.extend(strokes),
            }
            if outline.is_closed() && points.len() > 3 {
                rings.push(points.into_iter().map(|(p, _)| p).collect());
            }
        }
        if !rings.is_empty() && (ink.filled || ink.role == Some(Role::Column)) {
            match ink.role {
                None => self.unnamed_solids.push(rings),
                Some(_) => self.solids.push(rings),
            }
        }
    }

    /// The points of an outline; whether each is an end of what is drawn.
    fn flatten(&mut self, outline: &Outline) -> Vec<(DVec2, bool)> {
        let mut points = vec![(outline.start, true)];
        for part in &outline.parts {
            // There is too much already, whatever follows.
            if self.points + points.len() > MOST_POINTS {
                break;
            }
            let cut = match part {
                Part::Line(to) => vec![*to],
                Part::Arc(arc, end) => {
                    let mut cut = arc.points(self.tolerance).split_off(1);
                    cut.pop();
                    cut.push(*end);
                    cut
                }
                Part::Curve(cut) => cut.clone(),
            };
            if let (Part::Arc(..) | Part::Curve(_), Some(end)) = (part, cut.last()) {
                self.curves.push(at(*end));
                self.curve_pieces += cut.len();
            }
            let last = cut.len().saturating_sub(1);
            points.extend(cut.into_iter().enumerate().map(|(i, p)| (p, i == last)));
        }
        self.points += points.len();
        points
    }

    /// Takes a piece of a door's or window's symbol.
    fn piece(&mut self, style: OpeningStyle, ink: &Ink, outlines: &[Outline], place: Place) {
        let mut piece = Piece {
            style,
            group: ink.group,
            lines: Vec::new(),
            arcs: Vec::new(),
            place,
        };
        for outline in outlines {
            let mut from = outline.start;
            for part in &outline.parts {
                let Some(end) = part.end() else { continue };
                let swing = match part {
                    Part::Line(_) => None,
                    Part::Arc(arc, _) => swing_of_arc(arc),
                    Part::Curve(points) => swing_of_curve(from, points),
                };
                self.points += 1;
                match swing {
                    Some(swing) => piece.arcs.push(swing),
                    None if from == end => {}
                    None => piece.lines.push(Stroke {
                        from,
                        to: end,
                        written: [ink.written && matches!(part, Part::Line(_)); 2],
                        place: at(from),
                    }),
                }
                from = end;
            }
        }
        self.pieces.push(piece);
    }

    /// Ends the collecting. Where no layer is a wall by its name, all that have no name are walls.
    pub fn finish(mut self, unit: &Unit) -> Collected {
        let mut findings = Vec::new();
        let layers = (self.unknown.iter())
            .map(|(name, places)| format!("{name} ({})", places.len()))
            .collect();
        let others = (self.ignored.iter())
            .map(|(what, places)| format!("{} × {what}", places.len()))
            .collect();
        let by_default = self.walls.is_empty() && !self.unnamed.is_empty();
        if by_default {
            self.walls = self.unnamed;
            self.solids.extend(self.unnamed_solids);
        }
        let taken = in_words(&self.taken);
        if !taken.is_empty() {
            let places = self.walls.first().map(|s| s.place);
            findings.extend(Finding::at(
                "layers",
                Severity::Note,
                format!("What was taken for what: {taken}."),
                places.into_iter().collect(),
            ));
        }
        let list = |map: BTreeMap<String, Vec<Place>>| map.into_iter().collect::<Vec<_>>();
        let (code, severity, what) = if by_default {
            (
                "unnamed-walls",
                Severity::Warning,
                "No layer is a wall by its name, so everything without a telling name was taken for \
                 walls (--layer wall=NAME takes some, --layer ignored=NAME leaves some out)",
            )
        } else {
            (
                "unknown-layer",
                Severity::Warning,
                "Left out, as the name does not tell what it is (--layer wall=NAME takes it for walls)",
            )
        };
        findings.extend(left_out(code, severity, what, &list(self.unknown)));
        findings.extend(left_out(
            "furniture",
            Severity::Note,
            "Furniture, which stops nobody's sight, was left out",
            &list(self.furniture),
        ));
        findings.extend(left_out(
            "ignored",
            Severity::Note,
            "Left out, as it is no wall, door or window",
            &list(self.ignored),
        ));
        findings.extend(curves_cut(
            self.curves,
            self.curve_pieces,
            self.tolerance,
            unit,
        ));
        Collected {
            strokes: self.walls,
            solids: self.solids,
            symbols: symbols(self.pieces),
            findings,
            layers,
            others,
            unnamed: by_default,
        }
    }
}

fn in_words(taken: &BTreeMap<(Role, String), usize>) -> String {
    const SHOWN: usize = 12;
    let mut parts: Vec<String> = (taken.iter().take(SHOWN))
        .map(|((role, layer), n)| format!("{layer} ({n}): {}", role.as_str()))
        .collect();
    if taken.len() > SHOWN {
        parts.push(format!("and {} more layers", taken.len() - SHOWN));
    }
    parts.join(", ")
}

/// An arc of a circle of a tenth to a half turn is how a leaf swings.
fn swing_of_arc(arc: &Arc) -> Option<Swing> {
    let (a, b) = (arc.major.length(), arc.minor.length());
    let round = (a - b).abs() <= 0.03 * a && arc.major.dot(arc.minor).abs() <= 0.03 * a * b;
    let turn = arc.sweep.abs().to_degrees();
    (round && (35.0..=185.0).contains(&turn)).then(|| Swing {
        center: arc.center,
        ends: [arc.at(0.0), arc.at(1.0)],
    })
}

/// The same for a curve, if its points lie on such an arc.
fn swing_of_curve(from: DVec2, points: &[DVec2]) -> Option<Swing> {
    let end = *points.last()?;
    let middle = points[(points.len() - 1) / 2];
    let (p, q) = (middle - from, end - from);
    let cross = 2.0 * p.perp_dot(q);
    let center = from
        + DVec2::new(
            q.y * p.length_squared() - p.y * q.length_squared(),
            p.x * q.length_squared() - q.x * p.length_squared(),
        ) / cross;
    let radius = center.distance(from);
    let on_circle = points
        .iter()
        .all(|p| (p.distance(center) - radius).abs() <= 0.03 * radius);
    let turn = (from - center).angle_to(end - center).abs().to_degrees();
    (points.len() > 1 && center.is_finite() && on_circle && (35.0..=185.0).contains(&turn))
        .then_some(Swing {
            center,
            ends: [from, end],
        })
}

/// Pieces put together to symbols: by their group, or where their boxes touch.
fn symbols(pieces: Vec<Piece>) -> Vec<Symbol> {
    let mut parent: Vec<usize> = (0..pieces.len()).collect();
    let boxes: Vec<(DVec2, DVec2)> = pieces.iter().map(bounds).collect();
    let tree = RTree::bulk_load(
        (boxes.iter().enumerate())
            .map(|(i, (low, high))| {
                GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), i)
            })
            .collect(),
    );
    let mut first_of: BTreeMap<(u8, u32), usize> = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        if piece.group > 0 {
            let first = *first_of
                .entry((piece.style as u8, piece.group))
                .or_insert(i);
            unite(&mut parent, first, i);
            continue;
        }
        let (low, high) = boxes[i];
        let reach = 0.02 * (high - low).max_element();
        let window = AABB::from_corners((low - reach).to_array(), (high + reach).to_array());
        // A few neighbours tell enough; many would be a heap of symbols, not one.
        for near in tree.locate_in_envelope_intersecting(window).take(64) {
            let other = &pieces[near.data];
            if other.style == piece.style && other.group == 0 {
                unite(&mut parent, near.data, i);
            }
        }
    }
    let mut number: BTreeMap<usize, usize> = BTreeMap::new();
    let mut symbols: Vec<Symbol> = Vec::new();
    for (i, piece) in pieces.into_iter().enumerate() {
        let root = find(&mut parent, i);
        let at = *number.entry(root).or_insert(symbols.len());
        match symbols.get_mut(at) {
            Some(symbol) => {
                symbol.lines.extend(piece.lines);
                symbol.arcs.extend(piece.arcs);
            }
            None => symbols.push(Symbol {
                style: piece.style,
                name: None,
                shut: piece.style == OpeningStyle::Door,
                lines: piece.lines,
                arcs: piece.arcs,
                place: piece.place,
            }),
        }
    }
    symbols
}

fn bounds(piece: &Piece) -> (DVec2, DVec2) {
    let lines = piece.lines.iter().flat_map(|s| [s.from, s.to]);
    let arcs = (piece.arcs.iter()).flat_map(|a| [a.center, a.ends[0], a.ends[1]]);
    let start = (DVec2::splat(f64::MAX), DVec2::splat(f64::MIN));
    let (low, high) = (lines.chain(arcs)).fold(start, |(low, high), p| (low.min(p), high.max(p)));
    if low.cmple(high).all() {
        (low, high)
    } else {
        (DVec2::ZERO, DVec2::ZERO)
    }
}

fn find(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

fn unite(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(parent, a), find(parent, b));
    parent[a.max(b)] = a.min(b);
}
