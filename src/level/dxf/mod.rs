//! Plans drawn as DXF, by AutoCAD and nearly every other program that draws.
//!
//! In: the bytes of a file, text or binary. Out: a [`Drawing`], or a [`DxfError`] with its line. The
//! pairs are read here rather than by a crate, so that every mistake has its line, every kind of
//! entity can be counted by name, and the file's size bounds the memory.
//!
//! # What is read
//! LINE, MLINE, LWPOLYLINE and POLYLINE with bulges, ARC, CIRCLE, ELLIPSE, SPLINE, SOLID (a filled shape),
//! INSERT (nested, scaled, turned, mirrored, in columns and rows), TEXT, MTEXT and ATTRIB (names of
//! rooms). Entities on layer `0` within a block are on the layer of its INSERT. The layer's name tells
//! what is drawn, or else the name of the block; see [`super::drawing::role`]. Layers that are off or
//! frozen, entities of page layouts, and every other kind of entity (HATCH, DIMENSION …) are left out,
//! counted and named; so is an INSERT of a block that is not in the file. z is left out.
//!
//! # Unit
//! `--unit`, or else `$INSUNITS`, or else `$MEASUREMENT` (metric: mm; English: inches), or else mm. Where
//! neither `--unit` nor `$INSUNITS` tells and the plan would not have the size of a building, the first
//! of mm, cm, m, in, ft (English: in, ft, mm, cm, m) by which it has.

pub mod entity;
pub mod pairs;

mod draw;

use std::collections::HashMap;

use thiserror::Error;

use self::entity::{Entity, Names, Shape, unescaped};
use self::pairs::{At, Pair, Pairs};
use super::draft::{Draft, stem};
use super::drawing::collect::Collected;
use super::drawing::unit::Unit;
use super::drawing::{Drawing, DrawingError, DrawingOptions, measures, understand};
use super::finding::{Finding, Severity};
use super::scene::Scene;

/// Why a file gives no level.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DxfError {
    /// A text of two bytes a letter.
    #[error("the file is UTF-16 text, which DXF never is; save it as ASCII DXF")]
    Wide,
    /// A DWG under another name.
    #[error("this is a DWG file; save it as DXF")]
    Dwg,
    /// No group code where one belongs.
    #[error("{at}: a group code (a whole number) is needed here, not `{found}`; is this DXF?")]
    Code {
        /// Where.
        at: At,
        /// What stands there.
        found: String,
    },
    /// The file ends too early.
    #[error(
        "{at}: the file ends here, in the middle of {}; it was cut off",
        "a section"
    )]
    CutOff {
        /// Where.
        at: At,
    },
    /// A value of another kind.
    #[error("{at}: the value of group {code} has to be {needed}, not `{found}`")]
    Value {
        /// Where.
        at: At,
        /// The group code.
        code: i32,
        /// What it has to be.
        needed: &'static str,
        /// What it is.
        found: String,
    },
    /// No section with anything drawn.
    #[error(
        "{at}: the file ends without a section ENTITIES, so there is nothing drawn; is this DXF?"
    )]
    NoEntities {
        /// Where it ends.
        at: At,
    },
    /// Blocks that insert each other.
    #[error("{at}: blocks insert each other without end: {chain}")]
    Cycle {
        /// Where the circle closes.
        at: At,
        /// Their names.
        chain: String,
    },
    /// More than any plan has.
    #[error("{at}: {what}; purge or split the drawing")]
    TooMuch {
        /// Where the count was exceeded.
        at: At,
        /// What there is too much of.
        what: String,
    },
    /// It is no level.
    #[error(transparent)]
    Drawing(#[from] DrawingError),
}

/// A block: what INSERT draws.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// The point that goes where it is inserted.
    pub base: glam::DVec2,
    /// What it draws.
    pub entities: Vec<Entity>,
    /// Whether it is in the file.
    pub defined: bool,
}

/// A layer.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Whether it is off or frozen.
    pub hidden: bool,
}

/// A file as far as it matters.
#[derive(Clone, Debug, Default)]
pub struct File {
    /// Layers.
    pub layers: Vec<Layer>,
    /// Blocks.
    pub blocks: Vec<Block>,
    /// Their names.
    pub names: Vec<String>,
    /// What is drawn in the model.
    pub entities: Vec<Entity>,
    ins_units: Option<i64>,
    measurement: Option<i64>,
    layer_numbers: HashMap<String, u32>,
    block_numbers: HashMap<String, u32>,
    has_entities: bool,
}

impl Names for File {
    fn layer(&mut self, name: &str) -> u32 {
        // Names of layers and blocks are the same in capitals.
        let layers = &mut self.layers;
        *(self.layer_numbers.entry(name.to_uppercase())).or_insert_with(|| {
            layers.push(Layer {
                name: name.to_string(),
                hidden: false,
            });
            layers.len() as u32 - 1
        })
    }

    fn block(&mut self, name: &str) -> u32 {
        let (blocks, names) = (&mut self.blocks, &mut self.names);
        *(self.block_numbers.entry(name.to_uppercase())).or_insert_with(|| {
            blocks.push(Block::default());
            names.push(name.to_string());
            blocks.len() as u32 - 1
        })
    }
}

/// Reads a plan. `source` is the file's name, without its folder.
///
/// # Errors
/// See [`DxfError`].
pub fn read(bytes: &[u8], source: &str, options: &DrawingOptions) -> Result<Draft, DxfError> {
    let file = parse(bytes)?;
    let mut unit = unit(&file, options);
    let mut drawn = draw::draw(&file, &unit, options)?;
    if let Some(other) = unit_by_size(&file, &unit, &drawn.collected, options) {
        drawn = draw::draw(&file, &other, options)?;
        let places = drawn.collected.strokes.first().map(|s| s.place);
        drawn.collected.findings.extend(Finding::at(
            "guessed-unit",
            Severity::Warning,
            format!(
                "The file does not say its unit. In {} ({}) the plan would not have the size of a \
                 building, so it was taken for {} (--unit says another).",
                unit.name, unit.said_by, other.name
            ),
            places.into_iter().collect(),
        ));
        unit = other;
    }
    if drawn.collected.strokes.is_empty() {
        let there = match drawn.collected.layers.as_slice() {
            [] => "there are no lines at all".to_string(),
            layers => format!("its layers are: {}", layers.join(", ")),
        };
        let there = match drawn.collected.others.as_slice() {
            [] => there,
            others => format!("{there} (left out: {})", others.join(", ")),
        };
        return Err(DrawingError::NoWalls {
            why: format!(
                "no layer with lines has a wall's name, and {there}; say --layer wall=NAME"
            ),
        }
        .into());
    }
    let drawing = Drawing {
        name: stem(source),
        source: source.to_string(),
        unit,
        strokes: drawn.collected.strokes,
        symbols: drawn.collected.symbols,
        solids: drawn.collected.solids,
        labels: drawn.labels,
        rounding: 1e-7,
        bodies: true,
        unnamed: drawn.collected.unnamed,
        frame: None,
        scene: Scene::default(),
        findings: drawn.collected.findings,
    };
    Ok(understand(drawing, options)?)
}

/// Reads everything that matters.
pub fn parse(bytes: &[u8]) -> Result<File, DxfError> {
    let mut reader = Reader {
        pairs: Pairs::new(bytes)?,
        peeked: None,
    };
    let mut file = File::default();
    loop {
        let at = reader.pairs.at();
        let Some(pair) = reader.next()? else {
            // Some programs forget the end; a file that ends within a section was cut off.
            break if file.has_entities {
                Ok(file)
            } else {
                Err(DxfError::NoEntities { at })
            };
        };
        if pair.is(0, "EOF") {
            break if file.has_entities {
                Ok(file)
            } else {
                Err(DxfError::NoEntities { at })
            };
        }
        if pair.is(0, "SECTION") {
            let name = reader.need()?;
            match name.text().to_uppercase().as_str() {
                "HEADER" => header(&mut reader, &mut file)?,
                "TABLES" => tables(&mut reader, &mut file)?,
                "BLOCKS" => blocks(&mut reader, &mut file)?,
                "ENTITIES" => {
                    file.has_entities = true;
                    file.entities = entities(&mut reader, &mut file, "ENDSEC")?;
                }
                _ => while !reader.need()?.is(0, "ENDSEC") {},
            }
        }
    }
}

/// Pairs with one to look ahead at.
struct Reader<'a> {
    pairs: Pairs<'a>,
    peeked: Option<Pair<'a>>,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Result<Option<Pair<'a>>, DxfError> {
        match self.peeked.take() {
            Some(pair) => Ok(Some(pair)),
            None => self.pairs.next_pair(),
        }
    }

    /// The next pair where the file may not end.
    fn need(&mut self) -> Result<Pair<'a>, DxfError> {
        let at = self.pairs.at();
        self.next()?.ok_or(DxfError::CutOff { at })
    }

    /// The pairs up to the next with code 0.
    fn body(&mut self, into: &mut Vec<Pair<'a>>) -> Result<(), DxfError> {
        into.clear();
        loop {
            let pair = self.need()?;
            if pair.code == 0 {
                self.peeked = Some(pair);
                return Ok(());
            }
            // Extended data and comments say nothing about lines.
            if pair.code < 999 {
                into.push(pair);
            }
        }
    }
}

fn header(reader: &mut Reader, file: &mut File) -> Result<(), DxfError> {
    loop {
        let pair = reader.need()?;
        if pair.is(0, "ENDSEC") {
            return Ok(());
        }
        if pair.is(9, "$INSUNITS") {
            file.ins_units = Some(reader.need()?.whole()?);
        } else if pair.is(9, "$MEASUREMENT") {
            file.measurement = Some(reader.need()?.whole()?);
        }
    }
}

fn tables(reader: &mut Reader, file: &mut File) -> Result<(), DxfError> {
    let mut body = Vec::new();
    loop {
        let pair = reader.need()?;
        if pair.is(0, "ENDSEC") {
            return Ok(());
        }
        if !pair.is(0, "LAYER") {
            continue;
        }
        reader.body(&mut body)?;
        let find = |code| body.iter().find(|p: &&Pair| p.code == code);
        let Some(name) = find(2) else { continue };
        let flags = find(70).map_or(Ok(0), Pair::whole)?;
        let color = find(62).map_or(Ok(7), Pair::whole)?;
        let number = file.layer(&unescaped(&name.text()));
        file.layers[number as usize].hidden = flags & 1 == 1 || color < 0;
    }
}

fn blocks(reader: &mut Reader, file: &mut File) -> Result<(), DxfError> {
    let mut body = Vec::new();
    loop {
        let pair = reader.need()?;
        if pair.is(0, "ENDSEC") {
            return Ok(());
        }
        if !pair.is(0, "BLOCK") {
            continue;
        }
        reader.body(&mut body)?;
        let find = |code| body.iter().find(|p: &&Pair| p.code == code);
        let name = find(2).map_or("".into(), Pair::text);
        let base = glam::DVec2::new(
            find(10).map_or(Ok(0.0), Pair::real)?,
            find(20).map_or(Ok(0.0), Pair::real)?,
        );
        let number = file.block(&unescaped(&name));
        let entities = entities(reader, file, "ENDBLK")?;
        file.blocks[number as usize] = Block {
            base,
            entities,
            defined: true,
        };
    }
}

/// Entities up to a word.
fn entities(reader: &mut Reader, file: &mut File, end: &str) -> Result<Vec<Entity>, DxfError> {
    let mut list = Vec::new();
    let mut body = Vec::new();
    loop {
        let head = reader.need()?;
        if head.is(0, end) {
            return Ok(list);
        }
        if head.is(0, "ENDSEC") || head.is(0, "EOF") {
            return Err(DxfError::CutOff { at: head.at });
        }
        let name = head.text().to_uppercase();
        reader.body(&mut body)?;
        if matches!(name.as_str(), "VERTEX" | "SEQEND" | "ATTDEF") {
            continue;
        }
        let mut entity = entity::read(&name, head.at, &body, file)?;
        if name == "POLYLINE" {
            let mut vertices: Vec<Vec<Pair>> = Vec::new();
            loop {
                let pair = reader.need()?;
                if !pair.is(0, "VERTEX") {
                    reader.peeked = Some(pair);
                    break;
                }
                let mut vertex = Vec::new();
                reader.body(&mut vertex)?;
                vertices.push(vertex);
            }
            if let Some(entity) = &mut entity
                && let Some(shape) = entity::polyline(&body, &vertices)?
            {
                entity.shape = shape;
            }
        }
        list.extend(entity);
    }
}

/// `--unit`, `$INSUNITS`, `$MEASUREMENT`, in this order.
fn unit(file: &File, options: &DrawingOptions) -> Unit {
    if let Some(unit) = &options.unit {
        return unit.clone();
    }
    let by_number = match file.ins_units {
        Some(1) => Some("in"),
        Some(2) => Some("ft"),
        Some(3) => Some("mi"),
        Some(4) => Some("mm"),
        Some(5) => Some("cm"),
        Some(6) => Some("m"),
        Some(7) => Some("km"),
        Some(10) => Some("yd"),
        Some(14) => Some("dm"),
        _ => None,
    };
    let (name, said_by) = match (by_number, file.measurement) {
        (Some(name), _) => (name, "$INSUNITS"),
        (None, Some(0)) => ("in", "$MEASUREMENT"),
        (None, Some(_)) => ("mm", "$MEASUREMENT"),
        (None, None) => ("mm", "nothing in the file, so that is a guess"),
    };
    Unit::named(name, said_by).unwrap_or_else(|| Unit::unknown(name, said_by))
}

/// Another unit, where the file names none and the plan has not the size of a building.
fn unit_by_size(
    file: &File,
    unit: &Unit,
    found: &Collected,
    options: &DrawingOptions,
) -> Option<Unit> {
    let told = options.unit.is_some() || unit.said_by == "$INSUNITS";
    if told || found.strokes.is_empty() {
        return None;
    }
    let names = match file.measurement {
        Some(0) => ["in", "ft", "mm", "cm", "m"],
        _ => ["mm", "cm", "m", "in", "ft"],
    };
    let found = measures(&found.strokes, &found.symbols);
    Unit::by_size(&names, found.extent, found.door).filter(|other| other.name != unit.name)
}

/// What is drawn of a kind: for messages.
fn kind(shape: &Shape) -> &str {
    match shape {
        Shape::Line(_) => "LINE",
        Shape::Lines(_) => "MLINE",
        Shape::Polyline { .. } => "POLYLINE",
        Shape::Arc { .. } => "ARC",
        Shape::Ellipse { .. } => "ELLIPSE",
        Shape::Spline(_) => "SPLINE",
        Shape::Filled(_) => "SOLID",
        Shape::Insert { .. } => "INSERT",
        Shape::Text { .. } => "TEXT",
        Shape::Other(name) => name,
    }
}

#[cfg(test)]
mod tests;
