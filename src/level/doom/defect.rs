//! The kinds of defects that a Doom map may have and still be read, and what is said about them.

use std::collections::BTreeMap;

use crate::level::{Finding, Place, Severity};

/// A kind of defect; findings come out in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Defect {
    DanglingVertex,
    ZeroLength,
    DanglingSide,
    NoSides,
    NoFront,
    FlagWithoutBack,
    Duplicate,
    SidesWithoutFlag,
    Conflict,
    Unclosed,
    TagZero,
    TagUnused,
    UnknownSpecial,
    Scripted,
    Sloped,
    Polyobject,
    SameSector,
    UnusedSector,
    UnknownNamespace,
}

/// Defects found so far, each with its places.
#[derive(Debug, Default)]
pub struct Tally(BTreeMap<Defect, Vec<Place>>);

impl Tally {
    /// Adds a place; places of one kind are to come in the source's order.
    pub fn add(&mut self, defect: Defect, place: Place) {
        self.0.entry(defect).or_default().push(place);
    }

    /// One finding for each kind that occurred.
    pub fn into_findings(self) -> Vec<Finding> {
        let finding = |(defect, places): (Defect, Vec<Place>)| {
            let (severity, code, message) = describe(defect);
            Finding {
                code,
                severity,
                message: message.to_string(),
                places,
            }
        };
        self.0.into_iter().map(finding).collect()
    }
}

fn describe(defect: Defect) -> (Severity, &'static str, &'static str) {
    use Severity::{Note, Repaired, Warning};
    match defect {
        Defect::DanglingVertex => (
            Repaired,
            "dangling-vertex",
            "Linedefs name vertices that do not exist; they were left out.",
        ),
        Defect::ZeroLength => (
            Repaired,
            "zero-length-wall",
            "Linedefs start and end in the same point; they were left out.",
        ),
        Defect::DanglingSide => (
            Repaired,
            "dangling-sidedef",
            "Linedefs name sidedefs that do not exist; that side was taken to be empty.",
        ),
        Defect::NoSides => (
            Repaired,
            "no-sidedef",
            "Linedefs have no sidedef at all, so the game sees nothing of them; they were left out.",
        ),
        Defect::NoFront => (
            Repaired,
            "missing-front-sidedef",
            "Linedefs have a back but no front sidedef; they were taken as solid walls seen from \
             the back.",
        ),
        Defect::FlagWithoutBack => (
            Repaired,
            "two-sided-flag-without-back",
            "Linedefs are flagged two-sided but have one sidedef; they were taken as solid walls.",
        ),
        Defect::Duplicate => (
            Repaired,
            "duplicate-linedef",
            "Linedefs repeat an earlier one, corner for corner and side for side; they were left \
             out.",
        ),
        Defect::SidesWithoutFlag => (
            Warning,
            "two-sides-without-flag",
            "Linedefs have two sidedefs but no two-sided flag; they block sight, as in the game.",
        ),
        Defect::Conflict => (
            Warning,
            "conflicting-linedefs",
            "Linedefs join the same two corners as an earlier one but differ in sectors or kind; \
             both were kept, and a solid one blocks sight.",
        ),
        Defect::Unclosed => (
            Warning,
            "unclosed-sector",
            "The linedefs around these sectors do not close: at some corner an odd number of them \
             meet.",
        ),
        Defect::TagZero => (
            Warning,
            "special-without-tag",
            "Linedefs move tagged sectors but have tag 0; they were taken to move nothing, though \
             the original game moves every untagged sector.",
        ),
        Defect::TagUnused => (
            Note,
            "tag-without-sector",
            "Linedefs move tagged sectors, but no sector has their tag; they move nothing.",
        ),
        Defect::UnknownSpecial => (
            Warning,
            "unknown-special",
            "Linedefs have specials that are not known here; what these move counts as fixed.",
        ),
        Defect::Scripted => (
            Note,
            "scripted-sector",
            "Scripts, which are not read, may move these tagged sectors; their floors and ceilings \
             count as going anywhere.",
        ),
        Defect::Sloped => (
            Note,
            "sloped-sector",
            "Floors or ceilings slope; they count as reaching every height that the slope may have.",
        ),
        Defect::Polyobject => (
            Note,
            "polyobject-line",
            "Linedefs belong to polyobjects, walls that move over the plan; they were taken to \
             block no sight anywhere.",
        ),
        Defect::SameSector => (
            Note,
            "same-sector-both-sides",
            "Linedefs have the same sector on both sides; they are see-through.",
        ),
        Defect::UnusedSector => (
            Note,
            "unused-sector",
            "Sectors that no linedef names; they enclose nothing.",
        ),
        Defect::UnknownNamespace => (
            Warning,
            "unknown-namespace",
            "The text map has an unknown namespace; its specials were taken for those of ZDoom.",
        ),
    }
}
