//! Entities of a DXF file: what is drawn.
//!
//! In: the pairs from one `0` to the next. Out: an [`Entity`] in its own coordinates; what is no line
//! keeps its name, to be counted.

use glam::DVec2;

use super::super::drawing::flatten::Spline;
use super::DxfError;
use super::pairs::{At, Pair};

/// Something drawn.
#[derive(Clone, Debug)]
pub struct Entity {
    /// Its layer, as an index of [`super::File::layers`].
    pub layer: u32,
    /// Where it stands.
    pub at: At,
    /// Whether it is seen from below, so that x is turned around.
    pub mirrored: bool,
    /// What it is.
    pub shape: Shape,
}

/// Kinds of entities.
#[derive(Clone, Debug)]
pub enum Shape {
    /// LINE
    Line([DVec2; 2]),
    /// MLINE: the pieces of all its lines.
    Lines(Vec<[DVec2; 2]>),
    /// LWPOLYLINE, POLYLINE: corners, each with the bulge of the piece after it.
    Polyline {
        /// Corners.
        corners: Vec<(DVec2, f64)>,
        /// Whether the last one is joined to the first.
        closed: bool,
        /// Whether its coordinates are the world's, not its own.
        world: bool,
    },
    /// ARC and CIRCLE, angles in degrees.
    Arc {
        /// Middle.
        center: DVec2,
        /// Radius.
        radius: f64,
        /// From this angle counterclockwise to that one; none: all around.
        angles: Option<[f64; 2]>,
    },
    /// ELLIPSE, parameters in radians.
    Ellipse {
        /// Middle.
        center: DVec2,
        /// End of the larger axis, from the middle.
        major: DVec2,
        /// The smaller axis as a part of the larger one.
        ratio: f64,
        /// From this parameter to that one.
        range: [f64; 2],
    },
    /// SPLINE
    Spline(Spline),
    /// SOLID, TRACE: a filled shape.
    Filled(Vec<DVec2>),
    /// INSERT of a block.
    Insert {
        /// The block, as an index of [`super::File::names`].
        block: u32,
        /// Where its base point goes.
        at: DVec2,
        /// Factors.
        scale: DVec2,
        /// Turn in degrees, after the scale.
        rotation: f64,
        /// Copies: columns and rows, and the steps between them.
        copies: [i64; 2],
        /// Steps between the copies.
        spacing: DVec2,
    },
    /// TEXT, MTEXT, ATTRIB
    Text {
        /// Where it begins.
        at: DVec2,
        /// Height of its letters.
        height: f64,
        /// The text, its control codes taken out.
        text: String,
    },
    /// Anything else, by name.
    Other(String),
}

/// Names and what else an entity may refer to.
pub trait Names {
    /// Number of a layer.
    fn layer(&mut self, name: &str) -> u32;
    /// Number of a block.
    fn block(&mut self, name: &str) -> u32;
}

/// Numbers gathered by their codes.
struct Values<'p, 'a> {
    pairs: &'p [Pair<'a>],
}

impl<'a> Values<'_, 'a> {
    fn find(&self, code: i32) -> Option<&Pair<'a>> {
        self.pairs.iter().find(|p| p.code == code)
    }

    fn real(&self, code: i32, usual: f64) -> Result<f64, DxfError> {
        self.find(code).map_or(Ok(usual), Pair::real)
    }

    fn whole(&self, code: i32, usual: i64) -> Result<i64, DxfError> {
        self.find(code).map_or(Ok(usual), Pair::whole)
    }

    /// A point whose x has this code, and y ten more.
    fn point(&self, code: i32) -> Result<DVec2, DxfError> {
        Ok(DVec2::new(
            self.real(code, 0.0)?,
            self.real(code + 10, 0.0)?,
        ))
    }

    /// All points whose x has this code.
    fn points(&self, code: i32) -> Result<Vec<DVec2>, DxfError> {
        let mut points: Vec<DVec2> = Vec::new();
        for pair in self.pairs {
            if pair.code == code {
                points.push(DVec2::new(pair.real()?, 0.0));
            } else if pair.code == code + 10
                && let Some(last) = points.last_mut()
            {
                last.y = pair.real()?;
            }
        }
        Ok(points)
    }

    fn reals(&self, code: i32) -> Result<Vec<f64>, DxfError> {
        self.pairs
            .iter()
            .filter(|p| p.code == code)
            .map(Pair::real)
            .collect()
    }
}

/// Reads an entity; `None` for one that is not shown, or belongs to a page's layout.
pub fn read(
    name: &str,
    at: At,
    pairs: &[Pair],
    names: &mut dyn Names,
) -> Result<Option<Entity>, DxfError> {
    let values = Values { pairs };
    if values.whole(60, 0)? == 1 || values.whole(67, 0)? == 1 {
        return Ok(None);
    }
    let layer = values.find(8).map_or("0".into(), Pair::text);
    let layer = names.layer(&unescaped(&layer));
    let up = [
        values.real(210, 0.0)?,
        values.real(220, 0.0)?,
        values.real(230, 1.0)?,
    ];
    let upright = up[0].abs() < 1e-6 && up[1].abs() < 1e-6 && up[2] != 0.0;
    let shape = match name {
        _ if !upright => Shape::Other(format!("tilted {name}")),
        "LINE" => Shape::Line([values.point(10)?, values.point(11)?]),
        "LWPOLYLINE" => lwpolyline(&values)?,
        "MLINE" => mline(&values)?,
        "ARC" | "CIRCLE" => Shape::Arc {
            center: values.point(10)?,
            radius: values.real(40, 0.0)?.abs(),
            angles: match name {
                "ARC" => Some([values.real(50, 0.0)?, values.real(51, 360.0)?]),
                _ => None,
            },
        },
        "ELLIPSE" => Shape::Ellipse {
            center: values.point(10)?,
            major: values.point(11)?,
            ratio: values.real(40, 1.0)?,
            range: [
                values.real(41, 0.0)?,
                values.real(42, std::f64::consts::TAU)?,
            ],
        },
        "SPLINE" => spline(&values)?,
        "SOLID" | "TRACE" => {
            // The corners come in the order of the letter Z.
            let mut corners = vec![values.point(10)?, values.point(11)?];
            if values.find(13).is_some() {
                corners.push(values.point(13)?);
            }
            corners.push(values.point(12)?);
            corners.dedup();
            Shape::Filled(corners)
        }
        "INSERT" => {
            let block = values.find(2).map_or("".into(), Pair::text);
            Shape::Insert {
                block: names.block(&unescaped(&block)),
                at: values.point(10)?,
                scale: DVec2::new(values.real(41, 1.0)?, values.real(42, 1.0)?),
                rotation: values.real(50, 0.0)?,
                copies: [values.whole(70, 1)?, values.whole(71, 1)?].map(|n| n.max(1)),
                spacing: DVec2::new(values.real(44, 0.0)?, values.real(45, 0.0)?),
            }
        }
        "TEXT" | "MTEXT" | "ATTRIB" => {
            let chunks = pairs.iter().filter(|p| p.code == 3 && name == "MTEXT");
            let chunks = chunks.chain(pairs.iter().filter(|p| p.code == 1));
            let text: String = chunks.map(Pair::text).collect();
            let aligned = name != "MTEXT" && values.find(11).is_some() && values.whole(72, 0)? != 0;
            Shape::Text {
                at: values.point(if aligned { 11 } else { 10 })?,
                height: values.real(40, 0.0)?,
                text: plain(&unescaped(&text)),
            }
        }
        _ => Shape::Other(name.to_string()),
    };
    Ok(Some(Entity {
        layer,
        at,
        mirrored: up[2] < 0.0,
        shape,
    }))
}

fn lwpolyline(values: &Values) -> Result<Shape, DxfError> {
    let mut corners: Vec<(DVec2, f64)> = Vec::new();
    for pair in values.pairs {
        match (pair.code, corners.last_mut()) {
            (10, _) => corners.push((DVec2::new(pair.real()?, 0.0), 0.0)),
            (20, Some((p, _))) => p.y = pair.real()?,
            (42, Some((_, bulge))) => *bulge = pair.real()?,
            _ => {}
        }
    }
    Ok(Shape::Polyline {
        corners,
        closed: values.whole(70, 0)? & 1 == 1,
        world: false,
    })
}

/// A corner of an MLINE.
#[derive(Default)]
struct Corner {
    at: DVec2,
    along: DVec2,
    /// The way in which its lines lie beside each other here.
    miter: DVec2,
    /// For each line: how far it is along the miter, then where its strokes begin and end, measured
    /// from there along the piece.
    lines: Vec<Vec<f64>>,
}

/// The lines of an MLINE, as they lie beside its corners.
fn mline(values: &Values) -> Result<Shape, DxfError> {
    let mut corners: Vec<Corner> = Vec::new();
    for pair in values.pairs {
        if pair.code == 11 {
            corners.push(Corner::default());
        }
        let Some(corner) = corners.last_mut() else {
            continue;
        };
        match pair.code {
            11 => corner.at.x = pair.real()?,
            21 => corner.at.y = pair.real()?,
            12 => corner.along.x = pair.real()?,
            22 => corner.along.y = pair.real()?,
            13 => corner.miter.x = pair.real()?,
            23 => corner.miter.y = pair.real()?,
            74 => corner.lines.push(Vec::new()),
            41 => {
                if let Some(line) = corner.lines.last_mut() {
                    line.push(pair.real()?);
                }
            }
            _ => {}
        }
    }
    let n = corners.len();
    let closed = values.whole(71, 0)? & 2 != 0;
    let mut pieces = Vec::new();
    for i in 0..if closed { n } else { n.saturating_sub(1) } {
        let (from, to) = (&corners[i], &corners[(i + 1) % n]);
        for (line, next) in from.lines.iter().zip(&to.lines) {
            let (Some((aside, cuts)), Some(aside_next)) = (line.split_first(), next.first()) else {
                continue;
            };
            let ends = [
                from.at + from.miter * *aside,
                to.at + to.miter * *aside_next,
            ];
            let along = |t: &f64| match *t {
                0.0 => ends[0],
                t => ends[0] + from.along * t,
            };
            if cuts.len() < 2 {
                pieces.push(ends);
            } else {
                let strokes = cuts.chunks(2);
                pieces.extend(strokes.map(|c| [along(&c[0]), c.get(1).map_or(ends[1], along)]));
            }
        }
    }
    Ok(Shape::Lines(pieces))
}

fn spline(values: &Values) -> Result<Shape, DxfError> {
    let control = values.points(10)?;
    let fit = values.points(11)?;
    let closed = values.whole(70, 0)? & 1 == 1;
    if control.is_empty() && fit.len() > 1 {
        // Drawn through points: straight between them is the best that can be said without solving.
        return Ok(Shape::Polyline {
            corners: fit.into_iter().map(|p| (p, 0.0)).collect(),
            closed,
            world: true,
        });
    }
    Ok(Shape::Spline(Spline {
        degree: usize::try_from(values.whole(71, 3)?).unwrap_or(0),
        knots: values.reals(40)?,
        control,
        weights: values.reals(41)?,
    }))
}

/// A POLYLINE from its head and vertices; `None` for a mesh.
pub fn polyline(head: &[Pair], vertices: &[Vec<Pair>]) -> Result<Option<Shape>, DxfError> {
    let head = Values { pairs: head };
    let flags = head.whole(70, 0)?;
    if flags & (16 | 64) != 0 {
        return Ok(None);
    }
    let mut corners = Vec::new();
    for pairs in vertices {
        let vertex = Values { pairs };
        // Control points of a fitted curve are no corners of it.
        if vertex.whole(70, 0)? & 16 == 0 {
            corners.push((vertex.point(10)?, vertex.real(42, 0.0)?));
        }
    }
    Ok(Some(Shape::Polyline {
        corners,
        closed: flags & 1 == 1,
        world: flags & 8 != 0,
    }))
}

/// `\U+00FC` as the letter that it stands for.
pub fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\U+");
    let mut out = parts.next().unwrap_or_default().to_string();
    for part in parts {
        let letter = part
            .get(..4)
            .and_then(|hex| u32::from_str_radix(hex, 16).ok());
        match letter.and_then(char::from_u32) {
            Some(c) => {
                out.push(c);
                out.push_str(&part[4..]);
            }
            None => {
                out.push_str("\\U+");
                out.push_str(part);
            }
        }
    }
    out
}

/// A text without the codes that shape it: `{\fArial|b1;Hall}\PEast` is `Hall` and, in the next line, `East`.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut letters = text.chars().peekable();
    while let Some(c) = letters.next() {
        match c {
            '{' | '}' => {}
            '\\' => match letters.next() {
                Some('P') => out.push('\n'),
                Some('~') => out.push(' '),
                Some(c @ ('\\' | '{' | '}')) => out.push(c),
                // Codes with a value, up to a semicolon.
                Some('f' | 'F' | 'H' | 'W' | 'A' | 'C' | 'c' | 'Q' | 'T' | 'p') => {
                    for c in letters.by_ref() {
                        if c == ';' {
                            break;
                        }
                    }
                }
                _ => {}
            },
            '%' if letters.peek() == Some(&'%') => {
                letters.next();
                match letters.next() {
                    Some('d' | 'D') => out.push('°'),
                    Some('c' | 'C') => out.push('⌀'),
                    _ => {}
                }
            }
            c => out.push(c),
        }
    }
    let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    out.lines().map(words).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_without_codes() {
        assert_eq!(plain("{\\fArial|b1|i0;Hall}\\PEast"), "Hall\nEast");
        assert_eq!(plain("%%uBad%%u 2"), "Bad 2");
        assert_eq!(plain("a\\\\b\\"), "a\\b");
        assert_eq!(unescaped("T\\U+00FCr \\U+zz \\U+"), "Tür \\U+zz \\U+");
    }
}
