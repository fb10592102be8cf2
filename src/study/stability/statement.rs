//! Levels that state their own answer, worked out by hand, in their comments.
//!
//! In: the text of a TOML level. Out: a [`Case`]. The first comment line says what the level shows,
//! the next ones why the answer is what it is, and lines like these state it:
//!
//! | line | meaning |
//! |---|---|
//! | `# sees: 1,2 -> 3,4` | every cell at the one point sees every cell at the other |
//! | `# sees: everything` | every cell sees every cell |
//! | `# hidden: 1,2 -> 3,4` | no cell at the one point sees any cell at the other |
//! | `# cells bsp: 4` | the BSP has that many cells |
//! | `# snap: 0.0003` | the farthest that a point was moved onto the grid |
//! | `# finding: snapped` | the reader reports that |
//! | `# refused: too large` | the reader refuses the level, in these words |
//!
//! Points are points of the level's grid; "at" a point are the cells whose closure holds it.

use glam::DVec2;

use crate::cells::{CellGraph, CellId, Locator, Subdivision};
use crate::geom::GridPoint;
use crate::level::{Level, toml};
use crate::pvs::Pvs;

/// A level with what it states about itself.
#[derive(Clone, Debug)]
pub struct Case {
    /// The file's name, without its ending.
    pub name: String,
    /// What it shows: the first line of its comment.
    pub shows: String,
    /// What it states, in the order of the file.
    pub statements: Vec<Statement>,
    text: String,
}

/// One line that states a part of the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// The line, without `#`.
    pub text: String,
    /// What it means.
    pub claim: Claim,
}

/// What may be stated.
#[derive(Clone, Debug, PartialEq)]
pub enum Claim {
    /// Whether the cells at two points see each other.
    Sight {
        /// The one point, in the level's coordinates.
        from: DVec2,
        /// The other one.
        to: DVec2,
        /// Whether they do.
        sees: bool,
    },
    /// Every cell sees every cell.
    Everything,
    /// A subdivision has so many cells.
    Cells(Subdivision, usize),
    /// The largest distance by which a point was moved onto the grid.
    Snap(f64),
    /// The reader reports a finding of this kind.
    Finding(String),
    /// The reader refuses the level, and these words are in its message.
    Refused(String),
}

impl Claim {
    /// Whether it is about sight, so that every method answers it.
    pub fn is_about_sight(&self) -> bool {
        matches!(self, Claim::Sight { .. } | Claim::Everything)
    }
}

/// A statement that turned out to be wrong, with what holds instead, in a few words.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrong {
    /// The index of the statement.
    pub statement: usize,
    /// `hides 1,2 -> 3,4`
    pub instead: String,
}

/// A case that cannot be judged: a mistake in the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CaseError {
    /// A line that looks like a statement but is none.
    #[error("line {line}: `{text}` cannot be read as a statement; {needed}")]
    Statement {
        /// From 1.
        line: usize,
        /// The line.
        text: String,
        /// What it needs.
        needed: &'static str,
    },
    /// A point that is no grid point.
    #[error("`{statement}`: ({x}, {y}) is not on the level's grid, whose step is {step}")]
    OffGrid {
        /// The statement.
        statement: String,
        /// The point.
        x: f64,
        /// The point.
        y: f64,
        /// The grid's step.
        step: f64,
    },
    /// A point outside of the level.
    #[error("`{statement}`: ({x}, {y}) is not inside the level")]
    Outside {
        /// The statement.
        statement: String,
        /// The point.
        x: f64,
        /// The point.
        y: f64,
    },
    /// The level was refused, but nothing of that is stated.
    #[error("{0}")]
    Level(#[from] toml::TomlError),
}

/// What became of a level's text.
#[derive(Clone, Debug)]
pub enum Reading {
    /// A level.
    Level(Box<Level>),
    /// It was refused, as stated or in other words.
    Refused {
        /// In these words.
        message: String,
        /// The statements whose words are missing.
        wrong: Vec<Wrong>,
    },
}

impl Case {
    /// Reads the comment at the head of a level's text. `name` is the file's, without its ending.
    ///
    /// # Errors
    /// A line that starts like a statement but is none.
    pub fn parse(name: &str, text: &str) -> Result<Case, CaseError> {
        let comment: Vec<&str> = text
            .lines()
            .map_while(|line| line.strip_prefix('#'))
            .map(str::trim)
            .collect();
        let mut statements = Vec::new();
        for (i, line) in comment.iter().enumerate() {
            let claim = claim(line).map_err(|needed| CaseError::Statement {
                line: i + 1,
                text: line.to_string(),
                needed,
            })?;
            statements.extend(claim.map(|claim| Statement {
                text: line.to_string(),
                claim,
            }));
        }
        Ok(Case {
            name: name.to_string(),
            shows: comment.first().map_or("", |line| line).to_string(),
            statements,
            text: text.to_string(),
        })
    }

    /// Reads the level itself.
    ///
    /// # Errors
    /// When it is refused although it does not state that.
    pub fn read(&self) -> Result<Reading, CaseError> {
        let parts = self.claims().filter_map(|(i, claim)| match claim {
            Claim::Refused(part) => Some((i, part)),
            _ => None,
        });
        match toml::read(&self.text, &format!("{}.toml", self.name)) {
            Ok(level) => Ok(Reading::Level(Box::new(level))),
            Err(error) => {
                let message = error.to_string();
                let parts: Vec<_> = parts.collect();
                if parts.is_empty() {
                    return Err(error.into());
                }
                let missing = parts.iter().filter(|(_, part)| !message.contains(*part));
                let wrong = missing.map(|&(statement, part)| Wrong {
                    statement,
                    instead: format!("does not say `{part}`"),
                });
                Ok(Reading::Refused {
                    wrong: wrong.collect(),
                    message,
                })
            }
        }
    }

    /// What is wrongly stated about the level as it was read.
    pub fn wrong_of_level(&self, level: &Level) -> Vec<Wrong> {
        let found = |code: &str| level.findings.iter().any(|f| f.code == code);
        self.wrong(|claim| match claim {
            // Stated with few digits.
            Claim::Snap(wanted) => ((level.snap - wanted).abs() * 1e6 > *wanted)
                .then(|| format!("snaps by {}", level.snap)),
            Claim::Finding(code) => (!found(code)).then(|| format!("does not report `{code}`")),
            Claim::Refused(_) => Some("accepts the level".to_string()),
            Claim::Sight { .. } | Claim::Everything | Claim::Cells(..) => None,
        })
    }

    /// What is wrongly stated about the level's cells.
    pub fn wrong_of_cells(&self, graph: &CellGraph) -> Vec<Wrong> {
        let n = graph.cells.len();
        self.wrong(|claim| match claim {
            Claim::Cells(subdivision, wanted) => {
                let own = *subdivision == graph.options.subdivision;
                (own && n != *wanted).then(|| format!("makes {n} cells"))
            }
            _ => None,
        })
    }

    /// Which cells the statements about sight are about, for [`Places::wrong`].
    ///
    /// # Errors
    /// A point that is off the grid or outside of the level.
    pub fn places(&self, level: &Level, graph: &CellGraph) -> Result<Places<'_>, CaseError> {
        let locator = Locator::new(graph);
        let mut pairs = Vec::new();
        for (i, claim) in self.claims() {
            let at = |p: DVec2| {
                let statement = self.statements[i].text.clone();
                let (x, y) = (p.x, p.y);
                let Some(on_grid) = grid_point(level, p) else {
                    return Err(CaseError::OffGrid {
                        statement,
                        x,
                        y,
                        step: level.grid.step.length(),
                    });
                };
                let cells = locator.cells_at(graph, &on_grid.into());
                if cells.is_empty() {
                    return Err(CaseError::Outside { statement, x, y });
                }
                Ok(cells)
            };
            pairs.push(match claim {
                Claim::Sight { from, to, .. } => [at(*from)?, at(*to)?],
                _ => [Vec::new(), Vec::new()],
            });
        }
        Ok(Places { case: self, pairs })
    }

    fn claims(&self) -> impl Iterator<Item = (usize, &Claim)> {
        self.statements.iter().map(|s| &s.claim).enumerate()
    }

    fn wrong(&self, instead: impl Fn(&Claim) -> Option<String>) -> Vec<Wrong> {
        self.claims()
            .filter_map(|(statement, claim)| {
                instead(claim).map(|instead| Wrong { statement, instead })
            })
            .collect()
    }
}

/// The cells at the points that a case speaks of.
pub struct Places<'a> {
    case: &'a Case,
    /// For each statement; none for those that are not about two points.
    pairs: Vec<[Vec<CellId>; 2]>,
}

impl Places<'_> {
    /// Which of the statements about sight a visible set contradicts.
    pub fn wrong(&self, pvs: &Pvs) -> Vec<Wrong> {
        let n = pvs.visible.n() as u64;
        let instead = |statement: usize, claim: &Claim| match claim {
            Claim::Sight { sees, .. } => {
                let [from, to] = &self.pairs[statement];
                let right = (from.iter()).all(|&a| to.iter().all(|&b| pvs.sees(a, b) == *sees));
                let line = &self.case.statements[statement].text;
                let ends = line.split_once(':').map_or("", |(_, ends)| ends.trim());
                let verb = if *sees { "hides" } else { "shows" };
                (!right).then(|| format!("{verb} {ends}"))
            }
            Claim::Everything => {
                (pvs.pairs() != n * n).then(|| "hides something, but all is seen".to_string())
            }
            _ => None,
        };
        (self.case.claims())
            .filter_map(|(statement, claim)| {
                instead(statement, claim).map(|instead| Wrong { statement, instead })
            })
            .collect()
    }
}

/// The grid point that lies exactly there.
fn grid_point(level: &Level, p: DVec2) -> Option<GridPoint> {
    (level.grid.nearest(p)).filter(|&q| level.grid.to_level(q) == p)
}

/// What a comment line states: `None` for prose, an error for a statement that cannot be read.
fn claim(line: &str) -> Result<Option<Claim>, &'static str> {
    let Some((key, value)) = line.split_once(':') else {
        return Ok(None);
    };
    let value = value.trim();
    Ok(Some(match key {
        "sees" if value == "everything" => Claim::Everything,
        "sees" | "hidden" => {
            let ends = value.split_once("->");
            let ends = ends.and_then(|(from, to)| point(from).zip(point(to)));
            let (from, to) = ends.ok_or("it needs two points: 1,2 -> 3,4")?;
            let sees = key == "sees";
            Claim::Sight { from, to, sees }
        }
        "snap" => Claim::Snap(value.parse().map_err(|_| "it needs a distance")?),
        "finding" => Claim::Finding(value.to_string()),
        "refused" => Claim::Refused(value.to_string()),
        _ => {
            let named = key.strip_prefix("cells ");
            let Some(name) = named.filter(|name| !name.contains(' ')) else {
                return Ok(None);
            };
            let known = Subdivision::ALL.into_iter().find(|s| s.as_str() == name);
            let subdivision = known.ok_or("a subdivision is bsp, kd or cdt")?;
            Claim::Cells(subdivision, value.parse().map_err(|_| "it needs a number")?)
        }
    }))
}

fn point(text: &str) -> Option<DVec2> {
    let (x, y) = text.split_once(',')?;
    let number = |text: &str| text.trim().parse::<f64>().ok();
    number(x).zip(number(y)).map(|(x, y)| DVec2::new(x, y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_are_told_from_prose() {
        let text = "# A title: with a colon.\n#\n# Cells are open: so they are.\n\
                    # sees: 1,-2.5 -> 3e2,4\n# hidden: 0,0 -> 1,1\n# cells kd: 7\n\
                    # refused: line 3, column: 4\n\nname = 'x'\n# sees: not in the head\n";
        let case = Case::parse("x", text).unwrap();
        assert_eq!(case.shows, "A title: with a colon.");
        let claims: Vec<&Claim> = case.statements.iter().map(|s| &s.claim).collect();
        let sight = |from: [f64; 2], to: [f64; 2], sees| Claim::Sight {
            from: from.into(),
            to: to.into(),
            sees,
        };
        assert_eq!(
            claims,
            [
                &sight([1.0, -2.5], [300.0, 4.0], true),
                &sight([0.0, 0.0], [1.0, 1.0], false),
                &Claim::Cells(Subdivision::Kd, 7),
                &Claim::Refused("line 3, column: 4".to_string()),
            ]
        );
    }

    #[test]
    fn a_statement_that_cannot_be_read_is_an_error() {
        for line in [
            "sees: 1,2",
            "hidden: 1,2 -> 3",
            "cells bspp: 4",
            "cells bsp: many",
            "snap: far",
        ] {
            let error = Case::parse("x", &format!("# title\n# {line}\n")).unwrap_err();
            assert!(error.to_string().starts_with("line 2: "), "{error}");
        }
    }
}
