//! Plans drawn as SVG.
//!
//! In: the text of a file. Out: a [`Drawing`], or an [`SvgError`] with line and column.
//!
//! Names tell what is drawn: the Inkscape label, the classes and the id of an element, or else those of
//! the groups (layers) around it, the nearest first; see [`super::drawing::role`]. The tree is walked
//! here rather than by usvg, which forgets classes, labels and lines of the text; a test holds the
//! two against each other.
//!
//! # What is read
//! `path` (all commands), `rect`, `circle`, `ellipse`, `line`, `polyline`, `polygon`, in `g`, `a`,
//! `switch`, nested `svg` and through `use` (also of a `symbol`), with all transforms, `viewBox` and
//! `preserveAspectRatio`; style sheets as far as they hide things or fill them; `text` as names of
//! rooms. What is not displayed, clip paths, masks, patterns, markers, pictures are left out.
//!
//! A closed outline of a wall that is filled darker than half grey is solid inside. A shape that no name
//! tells about, with neither an outline nor a dark fill, is a ground of colour, and left out. y is turned around,
//! so that it goes up. The unit is mm where the outermost `width` has a unit, otherwise the user's
//! unit, of unknown length; `--unit` says what the user's unit is.

mod attributes;
mod page;
mod path;
mod style;

use std::collections::HashMap;

use glam::{DAffine2, DVec2};
use roxmltree::{Document, Node, NodeId, ParsingOptions};
use thiserror::Error;

use self::attributes::{fit, number, place_of, transform, viewport};
use self::page::Page;
use self::style::{Look, Sheet};
use super::draft::{Draft, stem};
use super::drawing::collect::{Collector, Ink, MOST_POINTS};
use super::drawing::role::{Role, role_of};
use super::drawing::{Drawing, DrawingError, DrawingOptions, Label, understand};
use super::finding::Place;
use super::scene::Scene;

/// Most elements that are drawn, those of `use` each time.
const MOST_ELEMENTS: usize = 1_000_000;

/// Deepest nesting, `use` included.
const DEEPEST: usize = 500;

/// Most texts that are looked at for names of rooms.
const MOST_LABELS: usize = 20_000;

/// Why a file gives no level.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SvgError {
    /// No XML.
    #[error("line {line}, column {column}: {message}")]
    Xml {
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
        /// What is wrong.
        message: String,
    },
    /// XML, but no SVG.
    #[error(
        "line {line}, column {column}: the outermost element is <{name}>, not <svg>; save the plan as SVG"
    )]
    NoSvg {
        /// Line, from 1.
        line: u32,
        /// Column, from 1.
        column: u32,
        /// What it is.
        name: String,
    },
    /// A value that cannot be read.
    #[error("{place}: <{element}> has a wrong `{attribute}`: {message}")]
    Value {
        /// Where.
        place: Place,
        /// Of what.
        element: String,
        /// Which.
        attribute: String,
        /// What is wrong.
        message: String,
    },
    /// `use` of an element that it is in.
    #[error("{place}: <use> draws itself without end: {chain}")]
    Cycle {
        /// Where the circle closes.
        place: Place,
        /// The ids on the way.
        chain: String,
    },
    /// More than any plan has.
    #[error("{place}: {what}; simplify the drawing")]
    TooMuch {
        /// Where the count was exceeded.
        place: Place,
        /// What there is too much of.
        what: String,
    },
    /// It is no level.
    #[error(transparent)]
    Drawing(#[from] DrawingError),
}

/// Reads a plan. `source` is the file's name, without its folder.
///
/// # Errors
/// See [`SvgError`].
pub fn read(text: &str, source: &str, options: &DrawingOptions) -> Result<Draft, SvgError> {
    Ok(understand(drawing(text, source, options)?, options)?)
}

/// Reads a plan as far as its lines.
fn drawing(text: &str, source: &str, options: &DrawingOptions) -> Result<Drawing, SvgError> {
    let text = text.trim_start_matches('\u{feff}');
    let limits = ParsingOptions {
        allow_dtd: true,
        nodes_limit: 4_000_000,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, limits).map_err(|e| SvgError::Xml {
        line: e.pos().row,
        column: e.pos().col,
        message: without_place(&e.to_string()),
    })?;
    let root = document.root_element();
    let at = document.text_pos_at(root.range().start);
    if root.tag_name().name() != "svg" {
        return Err(SvgError::NoSvg {
            line: at.row,
            column: at.col,
            name: root.tag_name().name().to_string(),
        });
    }
    let page = Page::of(&root, options)?;
    let sheet = Sheet::of(&document);
    let ids = (root.descendants())
        .filter_map(|n| Some((n.attribute("id")?, n.id())))
        .collect();
    let mut walk = Walk {
        document: &document,
        sheet: &sheet,
        ids,
        options,
        out: Collector::new(page.tolerance),
        labels: Vec::new(),
        n_elements: 0,
        groups: 0,
    };
    walk.run(root, &page)?;
    let Walk { out, labels, .. } = walk;
    let collected = out.finish(&page.unit);
    if collected.strokes.is_empty() {
        return Err(DrawingError::NoWalls {
            why: "no path, line or shape in it is a wall; name the layer, group or class of the walls \
                  `walls`, or say --layer wall=NAME"
                .to_string(),
        }
        .into());
    }
    Ok(Drawing {
        name: title(&root).unwrap_or_else(|| stem(source)),
        source: source.to_string(),
        unit: page.unit,
        strokes: collected.strokes,
        symbols: collected.symbols,
        solids: collected.solids,
        labels,
        rounding: 2e-6,
        bodies: true,
        unnamed: collected.unnamed,
        frame: None,
        scene: Scene::default(),
        findings: collected.findings,
    })
}

/// roxmltree ends most of its messages with the place, which we say ourselves.
fn without_place(message: &str) -> String {
    match message.rsplit_once(" at ") {
        Some((message, place)) if place.bytes().all(|b| b.is_ascii_digit() || b == b':') => {
            message.to_string()
        }
        _ => message.to_string(),
    }
}

fn title(root: &Node) -> Option<String> {
    let title = root
        .children()
        .find(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "title")))?;
    let text = one_line(title.text()?);
    (!text.is_empty()).then_some(text)
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What an element passes on to those in it.
#[derive(Clone)]
struct Context<'n> {
    transform: DAffine2,
    role: Option<Role>,
    layer: &'n str,
    group: u32,
    look: Look,
    depth: usize,
    /// The `use` elements on the way, for circles.
    uses: Option<std::rc::Rc<Used>>,
}

struct Used {
    target: NodeId,
    id: String,
    before: Option<std::rc::Rc<Used>>,
}

struct Walk<'a, 'n> {
    document: &'n Document<'n>,
    sheet: &'a Sheet<'n>,
    ids: HashMap<&'n str, NodeId>,
    options: &'a DrawingOptions,
    out: Collector,
    labels: Vec<Label>,
    n_elements: usize,
    groups: u32,
}

impl<'n> Walk<'_, 'n> {
    /// Draws everything, with a stack of its own: no nesting is too deep for it.
    fn run(&mut self, root: Node<'n, 'n>, page: &Page) -> Result<(), SvgError> {
        let context = Context {
            transform: page.transform,
            role: None,
            layer: "(none)",
            group: 0,
            look: Look::default(),
            depth: 0,
            uses: None,
        };
        let context = self.enter(&root, &context, true)?;
        let mut stack: Vec<(Node<'n, 'n>, Context<'n>)> = Vec::new();
        push_children(&mut stack, &root, &context);
        while let Some((node, around)) = stack.pop() {
            self.n_elements += 1;
            if self.n_elements > MOST_ELEMENTS {
                return Err(too_much(&node));
            }
            if around.depth > DEEPEST {
                return Err(SvgError::TooMuch {
                    place: place_of(&node),
                    what: format!("elements are nested more than {DEEPEST} deep"),
                });
            }
            let name = node.tag_name().name();
            match name {
                "g" | "a" | "switch" => {
                    let context = self.enter(&node, &around, true)?;
                    if context.look.shown {
                        push_children(&mut stack, &node, &context);
                    } else {
                        self.out.ignore("hidden element", place_of(&node));
                    }
                }
                "svg" => {
                    let mut context = self.enter(&node, &around, true)?;
                    context.transform *= viewport(&node, page.size)?;
                    push_children(&mut stack, &node, &context);
                }
                "use" => {
                    let context = self.enter(&node, &around, true)?;
                    if context.look.shown {
                        self.reference(&node, context, page, &mut stack)?;
                    }
                }
                "text" => self.text(&node, &around)?,
                "image" | "foreignObject" => self.out.ignore(name, place_of(&node)),
                _ => self.shape(&node, &around, page)?,
            }
            if self.out.is_full() {
                return Err(too_much(&node));
            }
        }
        Ok(())
    }

    /// What holds within an element.
    fn enter(
        &mut self,
        node: &Node<'n, 'n>,
        around: &Context<'n>,
        is_group: bool,
    ) -> Result<Context<'n>, SvgError> {
        let mut context = around.clone();
        context.depth += 1;
        context.transform *= transform(node)?;
        context.look = self.sheet.look(node, &around.look);
        let named = self.named(node);
        let opening =
            |role: Option<Role>| matches!(role, Some(Role::Door | Role::Window | Role::Archway));
        // Within the group that says `doors`, each group is one door.
        if is_group && opening(around.role) && around.group == 0 {
            self.groups += 1;
            context.group = self.groups;
        }
        if let Some((role, name)) = named {
            if Some(role) != around.role {
                context.group = 0;
            }
            (context.role, context.layer) = (Some(role), name);
            if is_group && opening(Some(role)) && node.tag_name().name() == "use" {
                self.groups += 1;
                context.group = self.groups;
            }
        } else if is_group && context.role.is_none() {
            context.layer = label(node)
                .or_else(|| node.attribute("id"))
                .unwrap_or(context.layer);
        }
        Ok(context)
    }

    /// What an element's own names tell.
    fn named(&self, node: &Node<'n, 'n>) -> Option<(Role, &'n str)> {
        let classes = node
            .attribute("class")
            .unwrap_or_default()
            .split_whitespace();
        let names = label(node)
            .into_iter()
            .chain(classes)
            .chain(node.attribute("id"));
        let mut roles = names.filter_map(|n| Some((role_of(n, &self.options.layers)?, n)));
        roles.next()
    }

    /// Draws what a `use` names.
    fn reference(
        &mut self,
        node: &Node<'n, 'n>,
        mut context: Context<'n>,
        page: &Page,
        stack: &mut Vec<(Node<'n, 'n>, Context<'n>)>,
    ) -> Result<(), SvgError> {
        let href = node
            .attribute("href")
            .or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href")));
        let id = href.unwrap_or_default().trim_start_matches('#');
        let Some(&target) = self.ids.get(id) else {
            self.out.ignore("use of what is not there", place_of(node));
            return Ok(());
        };
        let mut chain = vec![id.to_string()];
        let mut before = context.uses.clone();
        while let Some(used) = before {
            chain.push(used.id.clone());
            if used.target == target {
                chain.reverse();
                return Err(SvgError::Cycle {
                    place: place_of(node),
                    chain: chain.join(" → "),
                });
            }
            before = used.before.clone();
        }
        let offset = DVec2::new(
            number(node, "x", page.size.x)?.unwrap_or(0.0),
            number(node, "y", page.size.y)?.unwrap_or(0.0),
        );
        context.transform *= DAffine2::from_translation(offset);
        context.uses = Some(std::rc::Rc::new(Used {
            target,
            id: id.to_string(),
            before: context.uses,
        }));
        let Some(target) = self.document.get_node(target) else {
            return Ok(());
        };
        if matches!(target.tag_name().name(), "symbol" | "svg") {
            let mut inner = self.enter(&target, &context, true)?;
            let size = |name, of| -> Result<Option<f64>, SvgError> {
                Ok(number(node, name, of)?.or(number(&target, name, of)?))
            };
            let size = DVec2::new(
                size("width", page.size.x)?.unwrap_or(page.size.x),
                size("height", page.size.y)?.unwrap_or(page.size.y),
            );
            inner.transform *= fit(&target, size)?;
            push_children(stack, &target, &inner);
        } else {
            stack.push((target, context));
        }
        Ok(())
    }

    fn shape(
        &mut self,
        node: &Node<'n, 'n>,
        around: &Context<'n>,
        page: &Page,
    ) -> Result<(), SvgError> {
        if !path::is_shape(node) {
            return Ok(());
        }
        let context = self.enter(node, around, false)?;
        if !context.look.shown {
            self.out.ignore("hidden element", place_of(node));
            return Ok(());
        }
        if context.role.is_none() && !context.look.stroked && !context.look.dark {
            // The ground of the page, or of a room.
            let what = "shape that nothing names, without an outline or a dark fill";
            self.out.ignore(what, place_of(node));
            return Ok(());
        }
        let outlines = path::outlines(node, &context.transform, page.size, self.out.tolerance())?;
        let ink = Ink {
            role: context.role,
            layer: context.layer,
            group: context.group,
            filled: context.look.dark,
            written: false,
        };
        self.out.shape(&ink, &outlines);
        Ok(())
    }

    /// A text, where it begins, as wide as it may be.
    fn text(&mut self, node: &Node<'n, 'n>, around: &Context<'n>) -> Result<(), SvgError> {
        let context = self.enter(node, around, false)?;
        if !context.look.shown || self.labels.len() >= MOST_LABELS {
            return Ok(());
        }
        // Each line of a text is a tspan with a place of its own; together they are one name.
        let first = |name: &str| {
            let places = node.descendants().filter_map(|n| n.attribute(name));
            let text = places.into_iter().next().unwrap_or("0");
            let number = text.split([',', ' ']).next().unwrap_or("0");
            number.trim_end_matches("px").parse::<f64>().unwrap_or(0.0)
        };
        let words: Vec<&str> = (node.descendants())
            .filter(Node::is_text)
            .filter_map(|n| n.text())
            .collect();
        let lines = words.iter().map(|w| one_line(w)).filter(|w| !w.is_empty());
        let text = lines.collect::<Vec<_>>().join("\n");
        let size = context.look.font_size;
        let at = DVec2::new(first("x"), first("y") - 0.3 * size);
        let scale = context.transform.matrix2.determinant().abs().sqrt();
        let label = Label {
            text,
            at: context.transform.transform_point2(at),
            height: size * scale,
        };
        if label.at.is_finite() && !label.text.is_empty() {
            self.labels.push(label);
        }
        Ok(())
    }
}

fn too_much(node: &Node) -> SvgError {
    SvgError::TooMuch {
        place: place_of(node),
        what: format!(
            "more than {MOST_ELEMENTS} elements are drawn, those of <use> each time, or {MOST_POINTS} \
             points"
        ),
    }
}

fn label<'n>(node: &Node<'n, 'n>) -> Option<&'n str> {
    node.attribute(("http://www.inkscape.org/namespaces/inkscape", "label"))
}

/// Children go onto the stack so that the first comes off first.
fn push_children<'n>(
    stack: &mut Vec<(Node<'n, 'n>, Context<'n>)>,
    node: &Node<'n, 'n>,
    context: &Context<'n>,
) {
    let children = node.children().filter(Node::is_element);
    let start = stack.len();
    stack.extend(children.map(|child| (child, context.clone())));
    stack[start..].reverse();
}

#[cfg(test)]
mod tests;
