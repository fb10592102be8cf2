//! Text maps: the fields of UDMF 1.1, as a [`RawMap`].
//!
//! In: a map's `TEXTMAP` lump. Out: the same lists as from a binary map, coordinates with their
//! fractions. Fields and blocks that are not known are passed over, as the specification demands;
//! of ZDoom's own, those that move or slope floors are known (`moreids`, planes, vertex heights), and
//! those that shift one texture of a side.

use std::collections::HashSet;

use glam::DVec2;

use super::binary::{has_scripts, texture_name};
use super::defect::{Defect, Tally};
use super::error::Problem;
use super::raw::{RawLine, RawMap, RawSector, RawSide, Specials, Thing};
use super::surfaces::{Shift, SideSurface};
use super::text::{self, Block, Document, Field, Spot, TextError, TextProblem, Value};
use crate::level::Place;
use crate::level::dress::Lie;
use crate::level::wad::{Wad, WadMap};

/// Stands for an index that points to nothing, whatever the text says.
const DANGLING: u32 = u32::MAX;

/// Reads a text map. Indices that point to nothing are kept as such; fields of a wrong type, and
/// missing ones that have no default, are refused with their place.
pub fn read(wad: &Wad, map: &WadMap, tally: &mut Tally) -> Result<RawMap, Problem> {
    let lump = "TEXTMAP";
    let text = wad
        .lump_in_map(map, lump)
        .ok_or(Problem::MissingLump { lump })?;
    let document = text::parse(text)?;
    let specials = namespace(&document, tally)?;
    let mut raw = RawMap {
        specials,
        foreign_things: !has_doom_things(&document),
        scripts: wad.lump_in_map(map, "BEHAVIOR").is_some_and(has_scripts),
        ..RawMap::default()
    };
    let mut raised = HashSet::new();
    for block in &document.blocks {
        match block.name.as_str() {
            "vertex" => {
                if block.has("zfloor") || block.has("zceiling") {
                    raised.insert(raw.vertices.len() as u32);
                }
                raw.vertices.push(block.point()?);
            }
            "linedef" => raw.lines.push(line(block, specials)?),
            "sidedef" => raw.sides.push(side(block)?),
            "sector" => raw.sectors.push(sector(block)?),
            "thing" => raw.things.push(thing(block)?),
            _ => {}
        }
    }
    // Vertex heights slope the sectors around the vertex.
    let sloping = |l: &&RawLine| raised.contains(&l.v1) || raised.contains(&l.v2);
    let sloped: Vec<usize> = raw
        .lines
        .iter()
        .filter(sloping)
        .flat_map(|l| [l.front, l.back])
        .filter_map(|side| raw.sector_at(side))
        .collect();
    for sector in sloped {
        raw.sectors[sector].sloped = true;
    }
    Ok(raw)
}

/// Which specials the namespace means. That of Doom includes Boom's; Heretic and Strife extend the
/// same numbers.
fn namespace(document: &Document, tally: &mut Tally) -> Result<Specials, TextError> {
    let error = |at, problem| Err(TextError { at, problem });
    let Some(field) = find(&document.fields, "namespace") else {
        return error(Spot { line: 1, column: 1 }, TextProblem::NoNamespace);
    };
    let Value::Text(name) = &field.value else {
        return Err(field.wants("a string"));
    };
    match name.to_ascii_lowercase().as_str() {
        "doom" | "heretic" | "strife" => Ok(Specials::Doom),
        "hexen" | "zdoom" | "zdoomtranslated" | "vavoom" | "k8vavoom" | "eternity" | "dsda" => {
            Ok(Specials::Action)
        }
        _ => {
            let Spot { line, column } = field.at;
            tally.add(Defect::UnknownNamespace, Place::Text { line, column });
            Ok(Specials::Action)
        }
    }
}

/// Whether the numbers of things are Doom's; ZDoom's namespaces are used for other games too, but
/// mostly for Doom.
fn has_doom_things(document: &Document) -> bool {
    let others = ["heretic", "hexen", "strife"];
    !find(&document.fields, "namespace").is_some_and(|field| match &field.value {
        Value::Text(name) => others.contains(&name.to_ascii_lowercase().as_str()),
        _ => false,
    })
}

fn line(block: &Block, specials: Specials) -> Result<RawLine, TextError> {
    let index = |key| Ok(u32::try_from(block.required(key)?).unwrap_or(DANGLING));
    let side = |n: i64| (n != -1).then(|| u32::try_from(n).unwrap_or(DANGLING));
    let args = block.args()?;
    let id = block.integer("id", -1)?;
    // In Doom's namespace the tag stands in `id`, in `arg0`, or in both.
    let tags = match specials {
        Specials::Doom => [id.max(0), args[0]]
            .into_iter()
            .filter(|&t| t != 0)
            .collect(),
        Specials::Action => Vec::new(),
    };
    Ok(RawLine {
        v1: index("v1")?,
        v2: index("v2")?,
        two_sided: block.flag("twosided")?,
        unpegged_top: block.flag("dontpegtop")?,
        unpegged_bottom: block.flag("dontpegbottom")?,
        repeats: block.flag("repeatspecial")?,
        special: u32::try_from(block.integer("special", 0)?).unwrap_or(u32::MAX),
        args,
        tags,
        front: side(block.required("sidefront")?),
        back: side(block.integer("sideback", -1)?.into()),
    })
}

fn side(block: &Block) -> Result<RawSide, TextError> {
    let texture = |key| Ok(block.text(key)?.and_then(texture_name));
    Ok(RawSide {
        sector: u32::try_from(block.required("sector")?).unwrap_or(DANGLING),
        surface: SideSurface {
            upper: texture("texturetop")?,
            lower: texture("texturebottom")?,
            middle: texture("texturemiddle")?,
            offset: DVec2::new(block.number("offsetx", 0.0)?, block.number("offsety", 0.0)?),
            upper_shift: shift(block, "top")?,
            middle_shift: shift(block, "mid")?,
            lower_shift: shift(block, "bottom")?,
        },
    })
}

/// ZDoom's fields for one of a side's textures. A scale that is not positive counts as 1.
fn shift(block: &Block, part: &str) -> Result<Shift, TextError> {
    let pair = |what: &str, default| {
        let number = |axis| block.number(&format!("{what}{axis}_{part}"), default);
        Ok(DVec2::new(number('x')?, number('y')?))
    };
    let scale: DVec2 = pair("scale", 1.0)?;
    let usable = scale.is_finite() && scale.cmpgt(DVec2::ZERO).all();
    Ok(Shift {
        offset: pair("offset", 0.0)?,
        scale: if usable { scale } else { DVec2::ONE },
    })
}

fn sector(block: &Block) -> Result<RawSector, TextError> {
    let flat = |key| Ok(block.text(key)?.unwrap_or("").to_ascii_uppercase());
    let mut tags = vec![block.integer("id", 0)?];
    if let Some(more) = block.text("moreids")? {
        tags.extend(
            more.split_whitespace()
                .filter_map(|t| t.parse::<i32>().ok()),
        );
    }
    tags.retain(|&tag| tag != 0);
    let plane = |field: &Field| {
        field.key.starts_with("floorplane_") || field.key.starts_with("ceilingplane_")
    };
    Ok(RawSector {
        floor: block.number("heightfloor", 0.0)?,
        ceiling: block.number("heightceiling", 0.0)?,
        floor_flat: flat("texturefloor")?,
        ceiling_flat: flat("textureceiling")?,
        lies: [lie(block, "floor")?, lie(block, "ceiling")?],
        light: block.integer("lightlevel", 160)?,
        special: block.integer("special", 0)?,
        tags,
        sloped: block.fields.iter().any(plane),
    })
}

/// ZDoom's fields for a floor's or ceiling's flat. A scale of 0 counts as 1.
fn lie(block: &Block, part: &str) -> Result<Lie, TextError> {
    let number = |what: &str, default| block.number(&format!("{what}{part}"), default);
    let usable = |scale: f64| if scale == 0.0 { 1.0 } else { scale };
    let scale = DVec2::new(number("xscale", 1.0)?, number("yscale", 1.0)?);
    Ok(Lie {
        offset: DVec2::new(number("xpanning", 0.0)?, number("ypanning", 0.0)?),
        scale: scale.map(usable),
        turn: number("rotation", 0.0)?,
    })
}

fn thing(block: &Block) -> Result<Thing, TextError> {
    block.required("type")?;
    Ok(Thing {
        at: block.point()?,
        z: block.number("height", 0.0)?,
        angle: block.number("angle", 0.0)?,
        kind: block.integer("type", 0)?,
        special: u32::try_from(block.integer("special", 0)?).unwrap_or(u32::MAX),
        args: block.args()?,
    })
}

/// The last field of this name: a later one overrides.
fn find<'a>(fields: &'a [Field], key: &str) -> Option<&'a Field> {
    fields.iter().rev().find(|f| f.key == key)
}

impl Field {
    fn wants(&self, wanted: &'static str) -> TextError {
        TextError {
            at: self.at,
            problem: TextProblem::Type {
                key: self.key.clone(),
                wanted,
            },
        }
    }

    fn number(&self) -> Result<f64, TextError> {
        match self.value {
            Value::Integer(n) => Ok(n as f64),
            Value::Float(x) => Ok(x),
            _ => Err(self.wants("a number")),
        }
    }

    /// A whole number; one written with a point counts if nothing follows it.
    fn integer(&self) -> Result<i64, TextError> {
        match self.value {
            Value::Integer(n) => Ok(n),
            Value::Float(x) if x.fract() == 0.0 && x.abs() < 1e15 => Ok(x as i64),
            _ => Err(self.wants("a whole number")),
        }
    }
}

impl Block {
    fn has(&self, key: &str) -> bool {
        find(&self.fields, key).is_some()
    }

    fn missing(&self, key: &'static str) -> TextError {
        TextError {
            at: self.at,
            problem: TextProblem::MissingField {
                block: self.name.clone(),
                key,
            },
        }
    }

    /// A whole number that must be there.
    fn required(&self, key: &'static str) -> Result<i64, TextError> {
        let field = find(&self.fields, key).ok_or_else(|| self.missing(key))?;
        field.integer()
    }

    fn integer(&self, key: &'static str, default: i32) -> Result<i32, TextError> {
        match find(&self.fields, key) {
            None => Ok(default),
            Some(field) => {
                let n = field.integer()?;
                i32::try_from(n).map_err(|_| field.wants("a number of 32 bits"))
            }
        }
    }

    fn number(&self, key: &str, default: f64) -> Result<f64, TextError> {
        find(&self.fields, key).map_or(Ok(default), Field::number)
    }

    fn flag(&self, key: &'static str) -> Result<bool, TextError> {
        match find(&self.fields, key) {
            None => Ok(false),
            Some(field) => match field.value {
                Value::Bool(flag) => Ok(flag),
                _ => Err(field.wants("true or false")),
            },
        }
    }

    fn text(&self, key: &'static str) -> Result<Option<&str>, TextError> {
        match find(&self.fields, key) {
            None => Ok(None),
            Some(field) => match &field.value {
                Value::Text(text) => Ok(Some(text)),
                _ => Err(field.wants("a string")),
            },
        }
    }

    fn point(&self) -> Result<DVec2, TextError> {
        let coordinate = |key| {
            let field = find(&self.fields, key).ok_or_else(|| self.missing(key))?;
            field.number()
        };
        Ok(DVec2::new(coordinate("x")?, coordinate("y")?))
    }

    /// The five arguments of a special. One that is no number counts as 0: some games let scripts
    /// be named in a string there.
    fn args(&self) -> Result<[i32; 5], TextError> {
        let mut args = [0; 5];
        for (arg, key) in args
            .iter_mut()
            .zip(["arg0", "arg1", "arg2", "arg3", "arg4"])
        {
            if !matches!(find(&self.fields, key), Some(f) if matches!(f.value, Value::Text(_))) {
                *arg = self.integer(key, 0)?;
            }
        }
        Ok(args)
    }
}
