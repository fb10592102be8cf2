//! Draws the entities of a file, those of blocks wherever they are inserted.
//!
//! In: a [`File`]. Out: walls, symbols and texts in the world's coordinates.

use std::collections::BTreeMap;

use glam::{DAffine2, DVec2};

use super::super::drawing::collect::{Collected, Collector, Ink, MOST_POINTS, Outline, Part};
use super::super::drawing::flatten::Arc;
use super::super::drawing::role::{Role, role_of};
use super::super::drawing::unit::Unit;
use super::super::drawing::{DrawingOptions, Label, left_out};
use super::super::finding::{Place, Severity};
use super::entity::{Entity, Shape};
use super::pairs::At;
use super::{DxfError, File, kind};

/// Deepest nesting of blocks.
const DEEPEST: usize = 64;

/// Most entities drawn, those of blocks each time.
const MOST_DRAWN: usize = 1_000_000;

/// Most texts that are looked at for names of rooms.
const MOST_LABELS: usize = 20_000;

/// What was drawn.
pub struct Drawn {
    /// Lines and symbols.
    pub collected: Collected,
    /// Texts.
    pub labels: Vec<Label>,
}

/// What holds within a block.
#[derive(Clone, Copy)]
struct Context<'f> {
    transform: DAffine2,
    /// Layer of the INSERT, for what is on layer 0.
    layer: u32,
    role: Option<Role>,
    /// Name of the block that gave the role, or of the layer.
    named: &'f str,
    group: u32,
    top: bool,
}

struct Pen<'f, 'o> {
    file: &'f File,
    options: &'o DrawingOptions,
    /// Role by each layer's name, and whether a rule of the user says so.
    roles: Vec<Option<Role>>,
    block_roles: Vec<Option<Role>>,
    out: Collector,
    labels: Vec<Label>,
    /// Blocks that are inserted and not there.
    missing: BTreeMap<String, Vec<Place>>,
    drawn: usize,
    groups: u32,
    /// Blocks on the way, for circles.
    chain: Vec<u32>,
}

/// Draws a file.
///
/// # Errors
/// Blocks that insert each other, or draw too much.
pub fn draw(file: &File, unit: &Unit, options: &DrawingOptions) -> Result<Drawn, DxfError> {
    let usual = unit.metres.map_or(0.01, |metres| 0.01 / metres);
    let role = |name: &str| role_of(name, &options.layers);
    let mut pen = Pen {
        file,
        options,
        roles: file.layers.iter().map(|l| role(&l.name)).collect(),
        block_roles: file.names.iter().map(|n| role(n)).collect(),
        out: Collector::new(options.tolerance.unwrap_or(usual)),
        labels: Vec::new(),
        missing: BTreeMap::new(),
        drawn: 0,
        groups: 0,
        chain: Vec::new(),
    };
    let context = Context {
        transform: DAffine2::from_scale(DVec2::splat(unit.factor)),
        layer: 0,
        role: None,
        named: "0",
        group: 0,
        top: true,
    };
    for entity in &file.entities {
        pen.entity(entity, &context)?;
    }
    if let Some(last) = file.entities.last().filter(|_| pen.out.is_full()) {
        return Err(too_much(last.at));
    }
    let mut collected = pen.out.finish(unit);
    let missing = pen.missing.iter();
    collected
        .others
        .extend(missing.map(|(name, p)| {
            format!("{} × the block '{name}', which is not in the file", p.len())
        }));
    collected.findings.extend(left_out(
        "missing-block",
        Severity::Warning,
        "Left out, as the file lacks the block (bind external references before saving)",
        &pen.missing.into_iter().collect::<Vec<_>>(),
    ));
    Ok(Drawn {
        collected,
        labels: pen.labels,
    })
}

impl<'f> Pen<'f, '_> {
    fn entity(&mut self, entity: &'f Entity, around: &Context<'f>) -> Result<(), DxfError> {
        self.drawn += 1;
        if self.drawn > MOST_DRAWN || self.out.is_full() {
            return Err(too_much(entity.at));
        }
        let on_zero = self.file.layers[entity.layer as usize].name == "0";
        let layer = if on_zero && !around.top {
            around.layer
        } else {
            entity.layer
        };
        let (own, hidden) = {
            let named = &self.file.layers[layer as usize];
            let asked = self.options.layers.iter().any(|rule| {
                role_of(&named.name, std::slice::from_ref(rule)) == Some(rule.role)
                    && rule.role != Role::Ignored
            });
            (self.roles[layer as usize], named.hidden && !asked)
        };
        let (role, named) = match own {
            Some(role) if !(on_zero && around.role.is_some()) => {
                (Some(role), self.file.layers[layer as usize].name.as_str())
            }
            _ if around.role.is_some() => (around.role, around.named),
            _ => (own, self.file.layers[layer as usize].name.as_str()),
        };
        let mut context = Context {
            layer,
            role,
            named,
            top: false,
            ..*around
        };
        if entity.mirrored
            && !matches!(
                entity.shape,
                Shape::Line(_) | Shape::Spline(_) | Shape::Ellipse { .. }
            )
        {
            context.transform *= DAffine2::from_scale(DVec2::new(-1.0, 1.0));
        }
        if hidden {
            self.out.ignore(
                &format!("{} on a hidden layer", kind(&entity.shape)),
                place(entity, &context),
            );
            return Ok(());
        }
        match &entity.shape {
            Shape::Insert { .. } => self.insert(entity, context, around.top),
            Shape::Text { at, height, text } => {
                self.label(*at, *height, text, &context);
                Ok(())
            }
            Shape::Other(name) => {
                self.out.ignore(name, place(entity, &context));
                Ok(())
            }
            shape => {
                let ink = Ink {
                    role,
                    layer: named,
                    group: context.group,
                    filled: matches!(shape, Shape::Filled(_)),
                    written: around.top && context.transform == DAffine2::IDENTITY,
                };
                let to = &context.transform;
                let outlines = match shape {
                    Shape::Lines(lines) => Some(lines.iter().map(|l| straight(l, to)).collect()),
                    _ => outline(shape, entity.mirrored, to, self.out.tolerance())
                        .map(|outline| vec![outline]),
                };
                match outlines {
                    Some(outlines) => self.out.shape(&ink, &outlines),
                    None => self
                        .out
                        .ignore(&format!("unsound {}", kind(shape)), place(entity, &context)),
                }
                Ok(())
            }
        }
    }

    fn label(&mut self, at: DVec2, height: f64, text: &str, context: &Context) {
        let at = context.transform.transform_point2(at);
        let scale = context.transform.matrix2.determinant().abs().sqrt();
        if self.labels.len() < MOST_LABELS && at.is_finite() && !text.is_empty() {
            // The middle of the letters, and a little into the text.
            let up = context
                .transform
                .transform_vector2(DVec2::new(0.5, 0.5) * height);
            self.labels.push(Label {
                text: text.to_string(),
                at: at + up,
                height: height * scale,
            });
        }
    }

    /// Draws a block, in columns and rows.
    fn insert(
        &mut self,
        entity: &'f Entity,
        around: Context<'f>,
        top: bool,
    ) -> Result<(), DxfError> {
        let Shape::Insert {
            block,
            at,
            scale,
            rotation,
            copies,
            spacing,
        } = entity.shape
        else {
            return Ok(());
        };
        let name = &self.file.names[block as usize];
        let content = &self.file.blocks[block as usize];
        if !content.defined {
            let places = self.missing.entry(name.clone()).or_default();
            places.push(place(entity, &around));
            return Ok(());
        }
        self.check_chain(block, entity.at)?;
        let mut context = around;
        // The block's own name tells where the layer's does not.
        let by_name = self.block_roles[block as usize];
        let opening = matches!(by_name, Some(Role::Door | Role::Window | Role::Archway));
        if context.role.is_none() || (context.role == Some(Role::Wall) && opening) {
            (context.role, context.named) = (by_name.or(context.role), name);
        }
        self.chain.push(block);
        let place = DAffine2::from_translation(at) * DAffine2::from_angle(rotation.to_radians());
        let inner = DAffine2::from_scale(scale) * DAffine2::from_translation(-content.base);
        let [columns, rows] = copies;
        for row in 0..rows {
            for column in 0..columns {
                let step = spacing * DVec2::new(column as f64, row as f64);
                context.transform =
                    around.transform * place * DAffine2::from_translation(step) * inner;
                if top {
                    self.groups += 1;
                    context.group = self.groups;
                }
                // An empty block in a million columns is work, too.
                self.drawn += 1;
                for entity in &content.entities {
                    self.entity(entity, &context)?;
                }
                if self.drawn > MOST_DRAWN {
                    return Err(DxfError::TooMuch {
                        at: entity.at,
                        what: format!("the block '{name}' is drawn more than {MOST_DRAWN} times"),
                    });
                }
            }
        }
        self.chain.pop();
        Ok(())
    }

    fn check_chain(&self, block: u32, at: At) -> Result<(), DxfError> {
        let name = |b: &u32| self.file.names[*b as usize].as_str();
        if let Some(start) = self.chain.iter().position(|b| *b == block) {
            let mut chain: Vec<&str> = self.chain[start..].iter().map(name).collect();
            chain.push(name(&block));
            return Err(DxfError::Cycle {
                at,
                chain: chain.join(" → "),
            });
        }
        if self.chain.len() >= DEEPEST {
            return Err(DxfError::TooMuch {
                at,
                what: format!("blocks are nested more than {DEEPEST} deep"),
            });
        }
        Ok(())
    }
}

fn too_much(at: At) -> DxfError {
    DxfError::TooMuch {
        at,
        what: format!(
            "more than {MOST_DRAWN} entities are drawn, those of blocks each time, or {MOST_POINTS} points"
        ),
    }
}

/// A place for a finding: a point of the entity.
fn place(entity: &Entity, context: &Context) -> Place {
    let first = match &entity.shape {
        Shape::Line([p, _]) => Some(*p),
        Shape::Lines(lines) => lines.first().map(|l| l[0]),
        Shape::Polyline { corners, .. } => corners.first().map(|c| c.0),
        Shape::Arc { center, .. } | Shape::Ellipse { center, .. } => Some(*center),
        Shape::Spline(spline) => spline.control.first().copied(),
        Shape::Filled(corners) => corners.first().copied(),
        Shape::Insert { at, .. } | Shape::Text { at, .. } => Some(*at),
        Shape::Other(_) => None,
    };
    match (first, entity.at) {
        (Some(p), _) => {
            let p = context.transform.transform_point2(p);
            Place::Point { x: p.x, y: p.y }
        }
        (None, At::Line(line)) => Place::Text { line, column: 1 },
        (None, At::Byte(n)) => Place::Text { line: n, column: 1 },
    }
}

/// The outline of a shape; `None` where its numbers are none of a curve.
fn outline(shape: &Shape, mirrored: bool, transform: &DAffine2, tolerance: f64) -> Option<Outline> {
    let to = |p: DVec2| transform.transform_point2(p);
    let arc_to = |arc: Arc| Arc {
        center: to(arc.center),
        major: transform.matrix2 * arc.major,
        minor: transform.matrix2 * arc.minor,
        ..arc
    };
    let whole = |arc: Arc| {
        let arc = arc_to(arc);
        let around = (arc.sweep.abs() - std::f64::consts::TAU).abs() < 1e-9;
        let end = if around { arc.at(0.0) } else { arc.at(1.0) };
        Outline {
            start: arc.at(0.0),
            parts: vec![Part::Arc(arc, end)],
        }
    };
    match shape {
        Shape::Line(ends) => Some(straight(ends, transform)),
        Shape::Polyline {
            corners,
            closed,
            world,
        } => {
            // Coordinates of the world are not turned around.
            let flip = DVec2::new(if *world && mirrored { -1.0 } else { 1.0 }, 1.0);
            let to = |p: DVec2| to(p * flip);
            let first = corners.first()?;
            let mut parts = Vec::new();
            let n = corners.len();
            let pieces = if *closed { n } else { n - 1 };
            for i in 0..pieces {
                let ((from, bulge), (next, _)) = (corners[i], corners[(i + 1) % n]);
                match Arc::of_bulge(from, next, bulge) {
                    Some(arc) if !*world => parts.push(Part::Arc(arc_to(arc), to(next))),
                    _ if from != next => parts.push(Part::Line(to(next))),
                    _ => {}
                }
            }
            Some(Outline {
                start: to(first.0),
                parts,
            })
        }
        Shape::Arc {
            center,
            radius,
            angles,
        } => {
            let [start, end] = angles.unwrap_or([0.0, 0.0]).map(f64::to_radians);
            (*radius > 0.0).then(|| whole(Arc::of_circle(*center, *radius, start, end)))
        }
        Shape::Ellipse {
            center,
            major,
            ratio,
            range: [start, end],
        } => {
            let sweep = (end - start).rem_euclid(std::f64::consts::TAU);
            let around = sweep < 1e-9;
            let minor = major.perp() * *ratio * if mirrored { -1.0 } else { 1.0 };
            (major.length() > 0.0).then(|| {
                whole(Arc {
                    center: *center,
                    major: *major,
                    minor,
                    start: *start,
                    sweep: if around { std::f64::consts::TAU } else { sweep },
                })
            })
        }
        Shape::Spline(spline) => {
            let mut moved = spline.clone();
            moved.control.iter_mut().for_each(|p| *p = to(*p));
            if !moved.is_sound() {
                return None;
            }
            let mut points = moved.points(tolerance);
            let start = points.remove(0);
            Some(Outline {
                start,
                parts: vec![Part::Curve(points)],
            })
        }
        Shape::Filled(corners) => {
            let first = to(*corners.first()?);
            let mut parts: Vec<Part> = corners[1..].iter().map(|p| Part::Line(to(*p))).collect();
            parts.push(Part::Line(first));
            Some(Outline {
                start: first,
                parts,
            })
        }
        Shape::Lines(_) | Shape::Insert { .. } | Shape::Text { .. } | Shape::Other(_) => None,
    }
}

fn straight([p, q]: &[DVec2; 2], transform: &DAffine2) -> Outline {
    Outline {
        start: transform.transform_point2(*p),
        parts: vec![Part::Line(transform.transform_point2(*q))],
    }
}
