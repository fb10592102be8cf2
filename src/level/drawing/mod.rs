//! From a drawing to a level: what programs for drawing (DXF, SVG) and for table tops (UVTT) know as
//! lines becomes rooms, wall bodies and openings.
//!
//! In: a [`Drawing`], which a format's reader has filled with strokes of walls, symbols of doors and
//! windows, and texts. Out: a [`Draft`] whose walls name the room on either side, and findings that
//! tell what was understood, mended, and left out.
//!
//! The steps, in this order:
//! 1. [`opening`]: each door or window becomes one straight opening, from jamb to jamb; where the wall
//!    runs on behind it, that wall is cut.
//! 2. [`noding`]: everything goes to the grid; ends nearer than the drawing's own rounding become
//!    one; lines are split where they meet.
//! 3. [`gaps`]: ends that nearly meet are listed, and closed if asked to.
//! 4. [`faces`]: the ground falls into faces, parted by walls and openings.
//! 5. [`rooms`]: which faces are rooms, and what they are called.
//!
//! # Inside and outside
//! A face is outside where nothing encloses it, or inside a shape that is drawn as a solid (a column, a
//! filled wall) and no opening leads into it.
//! A face into which no opening leads, and which is no wider than the thickest wall (twice its area
//! divided by its perimeter), is the body of a wall: outside, too. A face as thin whose rim is mostly
//! openings is a threshold and belongs to the largest room beside it; the opening between the two is
//! dropped. Where no name tells which lines are walls, a rectangle around all rooms into which nothing
//! leads is the frame of the sheet, and outside. Every other face is a room.

pub mod collect;
pub mod faces;
pub mod flatten;
pub mod gaps;
pub mod noding;
pub mod opening;
pub mod role;
pub mod rooms;
pub mod unit;

use glam::DVec2;

use super::draft::{Draft, DraftInterior, DraftWall, Numbers};
use super::finding::{Finding, Place, Severity};
use super::model::{OpeningStyle, WallKind};
use super::scene::{Light, LightShape, Scene};
use super::snap::{RawPoint, SnapError, choose_grid};
use super::wording::{count, length};

use self::faces::Faces;
use self::noding::{Net, Piece};
use self::opening::Hole;
use self::role::LayerRule;
use self::rooms::Ground;
use self::unit::Unit;
use crate::geom::{Grid, Step};

/// How drawings are understood; the same for all formats.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawingOptions {
    /// What one unit of the drawing is; otherwise what the file says.
    pub unit: Option<Unit>,
    /// How far a straight piece may lie from the curve that it stands for, in the level's unit.
    pub tolerance: Option<f64>,
    /// Layers that are walls, doors, … whatever their names say; the first that fits counts.
    pub layers: Vec<LayerRule>,
    /// Ends of walls nearer than this are joined, in the level's unit.
    pub close_gaps: Option<f64>,
    /// Closed faces without openings up to this width are bodies of walls, in the level's unit.
    pub thickest_wall: Option<f64>,
}

impl DrawingOptions {
    /// The first option that is set, by its name on the command line.
    pub fn first(&self) -> Option<&'static str> {
        let set = [
            (self.unit.is_some(), "--unit"),
            (self.tolerance.is_some(), "--tolerance"),
            (!self.layers.is_empty(), "--layer"),
            (self.close_gaps.is_some(), "--close-gaps"),
            (self.thickest_wall.is_some(), "--thickest-wall"),
        ];
        set.into_iter().find(|(set, _)| *set).map(|(_, name)| name)
    }
}

/// A straight piece of wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Start.
    pub from: DVec2,
    /// End.
    pub to: DVec2,
    /// Whether each end is written in the file, digit by digit.
    pub written: [bool; 2],
    /// Where it stands.
    pub place: Place,
}

/// What stands for a door or a window in a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    /// What it is.
    pub style: OpeningStyle,
    /// Its name, for reports.
    pub name: Option<String>,
    /// Whether its leaf stands closed.
    pub shut: bool,
    /// Its straight lines.
    pub lines: Vec<Stroke>,
    /// Its arcs: how the leaf swings.
    pub arcs: Vec<Swing>,
    /// Where it stands.
    pub place: Place,
}

/// An arc of a door's symbol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Where the hinge is.
    pub center: DVec2,
    /// The arc's ends.
    pub ends: [DVec2; 2],
}

/// A text on the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The text; the first of its lines that may be a name is one.
    pub text: String,
    /// Where it stands (its middle, if the format tells).
    pub at: DVec2,
    /// Height of its letters; the largest text of a room names it.
    pub height: f64,
}

/// What a reader found in a file.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Name for people.
    pub name: String,
    /// The file's name, without its folder.
    pub source: String,
    /// Unit of all lengths.
    pub unit: Unit,
    /// Walls.
    pub strokes: Vec<Stroke>,
    /// Doors and windows.
    pub symbols: Vec<Symbol>,
    /// Solid shapes, each a set of closed rings; what lies within an odd number of them is solid. Their
    /// edges are among the strokes.
    pub solids: Vec<Vec<Vec<DVec2>>>,
    /// Texts.
    pub labels: Vec<Label>,
    /// Part of the drawing's extent by which its program may have rounded: nearer ends are one.
    pub rounding: f64,
    /// Whether walls are drawn as two lines with a body between them.
    pub bodies: bool,
    /// Whether no name told what the walls are, so that the frame of the sheet may be among them.
    pub unnamed: bool,
    /// Two corners of the whole map, where the format has one. Its rim is a wall if there is anything
    /// out of doors: where no walls enclose anything, or a light stands outside of all walls.
    pub frame: Option<[DVec2; 2]>,
    /// Lights and the like.
    pub scene: Scene,
    /// What the reader wants to say.
    pub findings: Vec<Finding>,
}

/// Why a drawing gives no level.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DrawingError {
    /// Nothing in it is a wall.
    #[error("there is no wall in it: {why}")]
    NoWalls {
        /// What was looked for, what is there, and what to do.
        why: String,
    },
    /// More crossings than any plan has.
    #[error(
        "{place}: the lines of the walls cross each other more than {limit} times, as hatching does; \
         say with --layer which layers are walls"
    )]
    Tangle {
        /// Where the count was exceeded.
        place: Place,
        /// How many are allowed.
        limit: usize,
    },
    /// It does not fit the grid.
    #[error(transparent)]
    Grid(#[from] SnapError),
}

/// Makes a drawing a level's draft.
///
/// # Errors
/// See [`DrawingError`].
pub fn understand(drawing: Drawing, options: &DrawingOptions) -> Result<Draft, DrawingError> {
    let Drawing {
        name,
        source,
        unit,
        mut strokes,
        symbols,
        solids,
        labels,
        rounding,
        bodies,
        unnamed,
        frame,
        scene,
        mut findings,
    } = drawing;
    if strokes.is_empty() {
        return Err(SnapError::Empty.into());
    }
    check_sizes(&strokes, &symbols)?;
    let sizes = Sizes::of(&strokes, &symbols, &unit, rounding, bodies, options);
    let shapes = Shapes {
        symbols: &symbols,
        solids: &solids,
        labels: &labels,
        unit: &unit,
        unnamed,
    };
    let mut plan = plan(strokes.clone(), &shapes, &sizes)?;
    if let Some(frame) = frame
        && plan.is_open(&scene)
    {
        let rim = rim_of(frame);
        findings.extend(Finding::at(
            "map-rim",
            Severity::Note,
            "There is ground out of doors, so the rim of the map was taken for a wall.",
            vec![rim[0].place],
        ));
        strokes.extend(rim);
        plan = self::plan(strokes, &shapes, &sizes)?;
    }
    findings.append(&mut plan.findings);
    unit::doubt(&unit, &sizes, &mut findings);
    Ok(Draft {
        name,
        source,
        unit: unit.name.clone(),
        numbers: Numbers::Decimal,
        walls: plan.walls(&unit),
        sectors: plan.ground.sectors,
        outlines: Vec::new(),
        interior: DraftInterior::Sides,
        scene,
        findings,
    })
}

/// What a plan is made of beside its walls.
struct Shapes<'a> {
    symbols: &'a [Symbol],
    solids: &'a [Vec<Vec<DVec2>>],
    labels: &'a [Label],
    unit: &'a Unit,
    unnamed: bool,
}

/// A drawing understood.
struct Plan {
    strokes: Vec<Stroke>,
    holes: Vec<Hole>,
    grid: Grid,
    net: Net,
    faces: Faces,
    ground: Ground,
    findings: Vec<Finding>,
}

/// The five steps.
fn plan(mut strokes: Vec<Stroke>, shapes: &Shapes, sizes: &Sizes) -> Result<Plan, DrawingError> {
    let mut findings = Vec::new();
    let cut = opening::place(&strokes, shapes.symbols, sizes, &mut findings);
    strokes.extend(cut.caps);
    let raw = raw_points(&strokes, &cut.holes);
    let grid = refined(choose_grid(Numbers::Decimal, &raw)?, &raw);
    let mut net = noding::node(&grid, &strokes, &cut.holes, sizes, &mut findings)?;
    gaps::mend(&grid, &mut net, &strokes, sizes, &mut findings)?;
    net.tell_doubles(&strokes, &mut findings);
    let faces = faces::trace(&net);
    let mut ground = rooms::classify(&grid, &net, &faces, shapes, sizes);
    findings.append(&mut ground.findings);
    Ok(Plan {
        strokes,
        holes: cut.holes,
        grid,
        net,
        faces,
        ground,
        findings,
    })
}

/// A finer grid where points are computed: at least five million steps across the plan.
fn refined(mut grid: Grid, points: &[RawPoint]) -> Grid {
    const STEPS: f64 = 5e6;
    if points.iter().all(|p| p.written) {
        return grid;
    }
    let (low, high) = (points.iter())
        .map(|p| p.at)
        .fold((points[0].at, points[0].at), |(l, h), p| {
            (l.min(p), h.max(p))
        });
    let extent = (high - low).max_element();
    while extent / grid.step.length() < STEPS
        && let Step::Decimal(k) = grid.step
        && k < 22
        && grid.origin.iter().all(|n| n.abs() < 1 << 47)
    {
        // A tenth of a step counts ten times as many: the origin stays where it is.
        grid.step = Step::Decimal(k + 1);
        grid.origin = grid.origin.map(|n| n * 10);
    }
    grid
}

impl Plan {
    /// Whether there is ground out of doors: no room at all, or a light outside of all rooms.
    fn is_open(&self, scene: &Scene) -> bool {
        let lit = |light: &Light| match light.shape {
            LightShape::Point { position } => {
                rooms::room_at(&self.net, &self.faces, &self.grid, position.truncate()) == 0
            }
            _ => false,
        };
        self.ground.sectors.is_empty() || scene.lights.iter().any(lit)
    }

    /// The pieces, with the rooms on both sides.
    fn walls(&self, unit: &Unit) -> Vec<DraftWall> {
        let side = |half: usize| self.ground.sector_of[self.faces.face_of[half] as usize];
        let point = |v: u32| self.grid.to_level(self.net.points[v as usize]);
        let wall = |(i, piece): (usize, &Piece)| {
            let hole = piece.hole.map(|h| &self.holes[h as usize]);
            let stroke = &self.strokes[piece.stroke as usize];
            DraftWall {
                from: point(piece.ends[0]),
                to: point(piece.ends[1]),
                written: [true; 2],
                kind: match hole {
                    Some(hole) => WallKind::Opening(rooms::opening(hole, unit)),
                    None => WallKind::Outline,
                },
                left: side(2 * i),
                right: side(2 * i + 1),
                outline: None,
                material: None,
                place: hole.map_or(stroke.place, |h| h.place),
            }
        };
        // What parts a threshold from its own room parts nothing: one door is one opening.
        let parts = |(i, piece): &(usize, &Piece)| {
            let faces = [2 * i, 2 * i + 1].map(|half| self.faces.face_of[half] as usize);
            let within = faces[0] != faces[1]
                && faces.iter().any(|f| self.ground.thresholds[*f])
                && side(2 * i).is_some()
                && side(2 * i) == side(2 * i + 1);
            piece.hole.is_none() || !within
        };
        let pieces = self.net.pieces.iter().enumerate();
        pieces.filter(parts).map(wall).collect()
    }
}

/// The four sides of a rectangle.
fn rim_of([a, c]: [DVec2; 2]) -> [Stroke; 4] {
    let corners = [a, DVec2::new(c.x, a.y), c, DVec2::new(a.x, c.y)];
    [0, 1, 2, 3].map(|i| Stroke {
        from: corners[i],
        to: corners[(i + 1) % 4],
        written: [true; 2],
        place: Place::Point {
            x: corners[i].x,
            y: corners[i].y,
        },
    })
}

/// Lengths by which things are told apart, in the level's unit.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// The larger side of the walls' extent.
    pub extent: f64,
    /// The walls' least x and y.
    pub corner: DVec2,
    /// Ends nearer than this are one.
    pub weld: f64,
    /// Gaps up to this are listed.
    pub gap: f64,
    /// Gaps up to this are closed.
    pub close: Option<f64>,
    /// The thickest wall; 0 where walls have no bodies.
    pub wall: f64,
    /// Usual width of a door, if there are any.
    pub door: Option<f64>,
}

impl Sizes {
    /// In a drawing whose unit is not known, or not meant, doors tell the scale; without doors its
    /// extent does.
    fn of(
        strokes: &[Stroke],
        symbols: &[Symbol],
        unit: &Unit,
        rounding: f64,
        bodies: bool,
        options: &DrawingOptions,
    ) -> Sizes {
        let Measures {
            extent,
            corner,
            door,
        } = measures(strokes, symbols);
        let scale =
            |metres: f64, of_door: f64, of_extent: f64| match (unit.meant(extent, door), door) {
                (Some(unit), _) => metres / unit,
                (None, Some(door)) => door * of_door,
                (None, None) => extent * of_extent,
            };
        let wall = options
            .thickest_wall
            .unwrap_or_else(|| scale(0.6, 0.7, 0.02));
        Sizes {
            extent,
            corner,
            weld: extent * rounding,
            gap: options
                .close_gaps
                .unwrap_or(0.0)
                .max(scale(0.15, 0.15, 0.005).min(extent * 0.05)),
            close: options.close_gaps,
            wall: if bodies || options.thickest_wall.is_some() {
                wall
            } else {
                0.0
            },
            door,
        }
    }
}

/// How large a drawing is, in its unit.
pub struct Measures {
    /// The larger side of the walls' extent.
    pub extent: f64,
    /// The walls' least x and y.
    pub corner: DVec2,
    /// The usual width of a door, if there are any.
    pub door: Option<f64>,
}

/// Measures a drawing's walls and doors.
pub fn measures(strokes: &[Stroke], symbols: &[Symbol]) -> Measures {
    let start = (DVec2::splat(f64::MAX), DVec2::splat(f64::MIN));
    let (low, high) = (strokes.iter().flat_map(|s| [s.from, s.to]))
        .fold(start, |(low, high), p| (low.min(p), high.max(p)));
    let mut doors: Vec<f64> = (symbols.iter())
        .filter(|s| s.style == OpeningStyle::Door)
        .filter_map(opening::width)
        .collect();
    doors.sort_by(f64::total_cmp);
    Measures {
        extent: (high - low).max_element(),
        corner: low,
        door: doors.get(doors.len() / 2).copied(),
    }
}

/// Refuses numbers that no arithmetic is safe with, before any is done.
fn check_sizes(strokes: &[Stroke], symbols: &[Symbol]) -> Result<(), SnapError> {
    let lines = strokes.iter().chain(symbols.iter().flat_map(|s| &s.lines));
    let swings = symbols.iter().flat_map(|s| {
        let points = |a: &Swing| [a.center, a.ends[0], a.ends[1]];
        s.arcs.iter().flat_map(points).map(|p| (p, s.place))
    });
    let points = lines.flat_map(|s| [(s.from, s.place), (s.to, s.place)]);
    for (p, place) in points.chain(swings) {
        for value in p.to_array() {
            if !value.is_finite() {
                return Err(SnapError::NotFinite { place, value });
            }
            if value.abs() >= super::snap::UNIT_LIMIT {
                return Err(SnapError::TooLarge { place, value });
            }
        }
    }
    Ok(())
}

/// All ends, for the choice of the grid.
fn raw_points(strokes: &[Stroke], holes: &[Hole]) -> Vec<RawPoint> {
    let walls = strokes.iter().map(|s| ([s.from, s.to], s.written, s.place));
    let holes = holes.iter().map(|h| (h.ends, h.written, h.place));
    walls
        .chain(holes)
        .flat_map(|(ends, written, place)| {
            [0, 1].map(|i| RawPoint {
                at: ends[i],
                written: written[i],
                place,
            })
        })
        .collect()
}

/// A finding about things that a reader left out: how many, of what names.
pub fn left_out(
    code: &'static str,
    severity: Severity,
    what: &str,
    named: &[(String, Vec<Place>)],
) -> Option<Finding> {
    const SHOWN: usize = 12;
    let mut ranked: Vec<_> = named
        .iter()
        .filter(|(_, places)| !places.is_empty())
        .collect();
    ranked.sort_by(|a, b| b.1.len().cmp(&a.1.len()).then(a.0.cmp(&b.0)));
    let mut parts: Vec<String> = ranked
        .iter()
        .take(SHOWN)
        .map(|(name, places)| format!("{} × {name}", places.len()))
        .collect();
    if ranked.len() > SHOWN {
        parts.push(format!("and {} more kinds", ranked.len() - SHOWN));
    }
    let places = ranked.iter().flat_map(|(_, places)| places.iter().copied());
    Finding::at(
        code,
        severity,
        format!("{what}: {}.", parts.join(", ")),
        places.collect(),
    )
}

/// Says how finely curves were cut.
pub fn curves_cut(
    places: Vec<Place>,
    pieces: usize,
    tolerance: f64,
    unit: &Unit,
) -> Option<Finding> {
    let message = format!(
        "Curves were cut into {}, at most {} {} off (--tolerance).",
        count(pieces, "straight piece"),
        length(tolerance),
        unit.name,
    );
    Finding::at("curve", Severity::Note, message, places)
}
