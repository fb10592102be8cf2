//! Units of length of drawings, and doubts about them.

use std::str::FromStr;

use super::super::finding::{Finding, Place, Severity};
use super::super::wording::length;
use super::Sizes;

/// A unit of length.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its name, as [`super::super::Level::unit`].
    pub name: String,
    /// How many metres it is; `None` where the drawing does not tell.
    pub metres: Option<f64>,
    /// Factor from the drawing's numbers to the level's; 1 unless the unit was given as a number.
    pub factor: f64,
    /// Who says so, for messages.
    pub said_by: &'static str,
}

/// Names with their lengths in metres.
const NAMED: [(&str, f64); 9] = [
    ("mm", 0.001),
    ("cm", 0.01),
    ("dm", 0.1),
    ("m", 1.0),
    ("km", 1000.0),
    ("in", 0.0254),
    ("ft", 0.3048),
    ("yd", 0.9144),
    ("mi", 1609.344),
];

impl Unit {
    /// A unit by its name; `None` if it is not one of those that are known.
    pub fn named(name: &str, said_by: &'static str) -> Option<Unit> {
        let (name, metres) = NAMED.into_iter().find(|(known, _)| *known == name)?;
        Some(Unit {
            name: name.to_string(),
            metres: Some(metres),
            factor: 1.0,
            said_by,
        })
    }

    /// A unit of which nothing but the name is known.
    pub fn unknown(name: &str, said_by: &'static str) -> Unit {
        Unit {
            name: name.to_string(),
            metres: None,
            factor: 1.0,
            said_by,
        }
    }

    /// So many metres in this unit; or the same number of units, where it is not known.
    pub fn of_metres(&self, metres: f64) -> f64 {
        metres / self.metres.unwrap_or(1.0)
    }
}

impl FromStr for Unit {
    type Err = String;

    /// `mm`, `ft`, …; or how many metres one unit of the drawing is.
    fn from_str(text: &str) -> Result<Unit, String> {
        if let Some(unit) = Unit::named(&text.to_lowercase(), "--unit") {
            return Ok(unit);
        }
        match text.parse::<f64>() {
            Ok(factor) if (1e-9..1e9).contains(&factor) => Ok(Unit {
                name: "m".to_string(),
                metres: Some(1.0),
                factor,
                said_by: "--unit",
            }),
            _ => Err(format!(
                "a unit is one of {}, or how many metres one unit of the drawing is, such as 0.01",
                NAMED.map(|(name, _)| name).join(", ")
            )),
        }
    }
}

/// Whether a plan and its doors have the size of a building's, if its unit is so many metres:
/// buildings are 2 m to 2 km across, and doors are 0.4 m to 3 m wide.
pub fn fits(metres: f64, extent: f64, door: Option<f64>) -> bool {
    (2.0..=2000.0).contains(&(extent * metres))
        && door.is_none_or(|d| (0.4..=3.0).contains(&(d * metres)))
}

impl Unit {
    /// Whether it is one of those with a name, not a length of somebody's own.
    fn is_named(&self) -> bool {
        NAMED.iter().any(|(name, _)| *name == self.name)
    }

    /// The length of the unit, unless the plan shows that it is not meant: drawings to a scale, and
    /// files that name the wrong unit. A unit that was asked for is meant.
    pub(super) fn meant(&self, extent: f64, door: Option<f64>) -> Option<f64> {
        self.metres
            .filter(|m| !self.is_named() || self.said_by == "--unit" || fits(*m, extent, door))
    }

    /// Where a file names no unit: the first of these by which the plan has the size of a building.
    pub fn by_size(names: &[&str], extent: f64, door: Option<f64>) -> Option<Unit> {
        names
            .iter()
            .filter_map(|name| Unit::named(name, "the plan's size, as the file does not say"))
            .find(|u| u.metres.is_some_and(|m| fits(m, extent, door)))
    }
}

/// Doubts whether a plan is as large as its unit says.
pub(super) fn doubt(unit: &Unit, sizes: &Sizes, findings: &mut Vec<Finding>) {
    let Some(metres) = unit.metres.filter(|_| unit.is_named()) else {
        return;
    };
    let across = sizes.extent * metres;
    let door = sizes.door.map(|width| width * metres);
    let fits = |metres: f64| fits(metres, sizes.extent, sizes.door);
    if fits(metres) {
        return;
    }
    let better: Vec<&str> = NAMED
        .into_iter()
        .filter(|&(_, m)| fits(m * unit.factor.recip()))
        .map(|(name, _)| name)
        .collect();
    let doors = door.map_or(String::new(), |d| {
        format!(", its doors {} m wide", length(d))
    });
    let advice = match better.as_slice() {
        [] => "say what one unit of the drawing is with --unit".to_string(),
        names => format!("say --unit {} if that is meant", names.join(" or --unit ")),
    };
    findings.push(Finding {
        code: "doubtful-unit",
        severity: Severity::Warning,
        message: format!(
            "In the unit {} ({}) the plan would be {} m across{doors}; {advice}.",
            unit.name,
            unit.said_by,
            length(across)
        ),
        places: vec![Place::Point {
            x: sizes.corner.x,
            y: sizes.corner.y,
        }],
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers() {
        assert_eq!("MM".parse::<Unit>().unwrap().metres, Some(0.001));
        let scaled: Unit = "0.05".parse().unwrap();
        assert_eq!((scaled.name.as_str(), scaled.factor), ("m", 0.05));
        for wrong in ["", "furlong", "nan", "inf", "-1", "0", "1e300"] {
            assert!(wrong.parse::<Unit>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_office_of_nine_kilometres_is_doubted() {
        let sizes = |extent, door| Sizes {
            extent,
            corner: glam::DVec2::ZERO,
            weld: 0.0,
            gap: 0.1,
            close: None,
            wall: 0.5,
            door,
        };
        let said = |unit: &str, extent, door| {
            let mut findings = Vec::new();
            doubt(&unit.parse().unwrap(), &sizes(extent, door), &mut findings);
            findings.pop().map(|f| f.message)
        };
        let message = said("m", 9000.0, None).unwrap();
        assert!(message.contains("9000 m across"), "{message}");
        assert!(message.contains("--unit mm"), "{message}");
        assert_eq!(said("m", 90.0, Some(0.9)), None);
        assert!(said("in", 90.0, Some(36.0)).is_none());
        assert!(
            said("m", 90.0, Some(36.0))
                .unwrap()
                .contains("doors 36 m wide")
        );
    }
}
