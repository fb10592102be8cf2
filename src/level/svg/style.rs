//! What style sheets and attributes say about showing and filling.
//!
//! In: a document. Out: for each element a [`Look`]. Attributes count least, then the rules of style
//! sheets, the more specific the more, then the element's own `style`.

use roxmltree::{Document, Node};
use simplecss::{
    AttributeOperator, Declaration, DeclarationTokenizer, Element, PseudoClass, StyleSheet,
};

/// Most rules that are looked at.
const MOST_RULES: usize = 500;

/// How an element looks, as far as that matters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    /// Whether it is displayed.
    pub shown: bool,
    /// Whether `visibility` lets it be seen; an inner element may say otherwise.
    visible: bool,
    /// Whether it is filled with something dark, or with a pattern.
    pub dark: bool,
    /// Whether its outline is drawn.
    pub stroked: bool,
    /// Size of its letters.
    pub font_size: f64,
}

impl Default for Look {
    fn default() -> Look {
        Look {
            shown: true,
            visible: true,
            dark: true,
            stroked: false,
            font_size: 16.0,
        }
    }
}

/// The style sheets of a document.
pub(super) struct Sheet<'n> {
    rules: StyleSheet<'n>,
}

impl<'n> Sheet<'n> {
    pub(super) fn of(document: &'n Document<'n>) -> Sheet<'n> {
        let mut rules = StyleSheet::new();
        let styles = document
            .descendants()
            .filter(|n| n.tag_name().name() == "style");
        for text in styles.filter_map(|n| n.text()) {
            rules.parse_more(text);
        }
        rules.rules.truncate(MOST_RULES);
        Sheet { rules }
    }

    /// How an element within one of a given look looks.
    pub(super) fn look(&self, node: &Node, around: &Look) -> Look {
        let mut look = *around;
        let (mut display, mut opaque) = (true, true);
        let mut say = |name: &str, value: &str| {
            let value = value.trim();
            match name {
                "display" => display = value != "none",
                "visibility" if value != "inherit" => look.visible = value == "visible",
                "stroke" if value != "inherit" => look.stroked = value != "none",
                "fill" => look.dark = dark(value).unwrap_or(look.dark),
                "fill-opacity" | "opacity" => {
                    opaque = value.parse::<f64>().is_ok_and(|x| x >= 0.5);
                }
                "font-size" => {
                    let size = value.trim_end_matches("px").parse::<f64>();
                    look.font_size = size.ok().filter(|s| *s > 0.0).unwrap_or(look.font_size);
                }
                _ => {}
            }
        };
        for attribute in node.attributes().filter(|a| a.namespace().is_none()) {
            say(attribute.name(), attribute.value());
        }
        for rule in &self.rules.rules {
            if rule.selector.matches(&Styled(*node)) {
                for Declaration { name, value, .. } in &rule.declarations {
                    say(name, value);
                }
            }
        }
        for Declaration { name, value, .. } in
            DeclarationTokenizer::from(node.attribute("style").unwrap_or_default())
        {
            say(name, value);
        }
        look.shown = around.shown && display;
        look.dark &= opaque;
        Look {
            shown: look.shown && look.visible,
            ..look
        }
    }
}

/// Whether a paint is dark; a pattern or gradient is. `None`: as around.
fn dark(paint: &str) -> Option<bool> {
    match paint.parse::<svgtypes::Color>() {
        Ok(c) => {
            let light =
                0.3 * f64::from(c.red) + 0.59 * f64::from(c.green) + 0.11 * f64::from(c.blue);
            Some(light < 128.0 && c.alpha >= 128)
        }
        Err(_) if paint.starts_with("url(") => Some(true),
        Err(_) if paint == "none" => Some(false),
        Err(_) => None,
    }
}

/// An element for simplecss.
struct Styled<'a, 'i>(Node<'a, 'i>);

impl Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        (self.0.attribute(local_name)).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        class == PseudoClass::FirstChild && self.0.prev_sibling_element().is_none()
    }
}
