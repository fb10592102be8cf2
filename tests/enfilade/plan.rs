//! Small levels made of strokes on a whole-number grid.

use enfilade::level::draft::{Draft, DraftInterior, DraftWall, Numbers};
use enfilade::level::scene::Scene;
use enfilade::level::snap::snap;
use enfilade::level::{Level, Opening, OpeningStyle, Place, SectorId, WallKind};
use glam::DVec2;

/// What a stroke is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    /// Opaque, and nothing cuts it.
    Solid,
    /// Opaque, but for openings that lie on it.
    Wall,
    /// An opening that is always open.
    Archway,
    /// An opening that is shut where doors count as closed.
    Door,
    /// See-through.
    Line,
    /// See-through, but opaque where doors count as closed.
    ShutLine,
}

/// A straight stroke on the plan.
#[derive(Clone, Copy, PartialEq)]
pub struct Stroke(pub [i64; 2], pub [i64; 2], pub Ink);

impl std::fmt::Debug for Stroke {
    // So that a failure can be pasted into a test.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Stroke({:?}, {:?}, {:?})", self.0, self.1, self.2)
    }
}

/// The four sides of a box.
pub fn rectangle(low: [i64; 2], high: [i64; 2], ink: Ink) -> Vec<Stroke> {
    ring(&[low, [high[0], low[1]], high, [low[0], high[1]]], ink)
}

/// A closed outline.
pub fn ring(points: &[[i64; 2]], ink: Ink) -> Vec<Stroke> {
    let n = points.len();
    (0..n)
        .map(|i| Stroke(points[i], points[(i + 1) % n], ink))
        .collect()
}

/// The level of some strokes: its inside is what they enclose.
pub fn level(strokes: &[Stroke]) -> Level {
    moved(strokes, [0.0, 0.0])
}

/// As [`level`], with an offset (whole units) added to every coordinate.
pub fn moved(strokes: &[Stroke], by: [f64; 2]) -> Level {
    let walls = (0u32..).zip(strokes).map(|(i, &Stroke(from, to, ink))| {
        let opening = |style, shut| {
            WallKind::Opening(Opening {
                style,
                name: None,
                shut,
                bottom: None,
                top: None,
            })
        };
        let at = |p: [i64; 2]| DVec2::new(p[0] as f64 + by[0], p[1] as f64 + by[1]);
        DraftWall {
            from: at(from),
            to: at(to),
            written: [true, true],
            kind: match ink {
                Ink::Solid => WallKind::Solid,
                Ink::Wall => WallKind::Outline,
                Ink::Archway => opening(OpeningStyle::Archway, false),
                Ink::Door => opening(OpeningStyle::Door, true),
                Ink::Line => WallKind::Edge { shut: false },
                Ink::ShutLine => WallKind::Edge { shut: true },
            },
            // Names something on one side only, so that a see-through line is not left out.
            left: Some(SectorId(0)),
            right: None,
            outline: None,
            material: None,
            place: Place::Linedef(i),
        }
    });
    let draft = Draft {
        name: "test".into(),
        source: "test".into(),
        unit: "step".into(),
        numbers: Numbers::Binary,
        walls: walls.collect(),
        sectors: Vec::new(),
        outlines: Vec::new(),
        interior: DraftInterior::Enclosed { starts: Vec::new() },
        scene: Scene::default(),
        findings: Vec::new(),
    };
    let level = snap(draft).expect("a box is a level");
    assert_eq!(level.snap, 0.0, "whole numbers are not moved");
    level
}
