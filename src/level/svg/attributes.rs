//! Attributes of SVG elements: numbers, transforms, viewports, and where a wrong one stands.

use glam::{DAffine2, DMat2, DVec2};
use roxmltree::Node;

use super::SvgError;
use crate::level::finding::Place;

pub(super) fn place_of(node: &Node) -> Place {
    let at = node.document().text_pos_at(node.range().start);
    Place::Text {
        line: at.row,
        column: at.col,
    }
}

pub(super) fn wrong(node: &Node, attribute: &str, message: impl ToString) -> SvgError {
    let attributes = node.attributes();
    let range = attributes
        .filter(|a| a.name() == attribute)
        .map(|a| a.range())
        .next();
    let at = node
        .document()
        .text_pos_at(range.map_or(node.range().start, |r| r.start));
    SvgError::Value {
        place: Place::Text {
            line: at.row,
            column: at.col,
        },
        element: node.tag_name().name().to_string(),
        attribute: attribute.to_string(),
        message: message.to_string(),
    }
}

/// The attribute `transform`.
pub(super) fn transform(node: &Node) -> Result<DAffine2, SvgError> {
    let Some(text) = node.attribute("transform") else {
        return Ok(DAffine2::IDENTITY);
    };
    let t: svgtypes::Transform = text.parse().map_err(|e| wrong(node, "transform", e))?;
    let transform = DAffine2 {
        matrix2: DMat2::from_cols(DVec2::new(t.a, t.b), DVec2::new(t.c, t.d)),
        translation: DVec2::new(t.e, t.f),
    };
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(wrong(node, "transform", "a number is too large"))
    }
}

/// A number of an element, in the user's units; percentages are of `whole`.
pub(super) fn number(node: &Node, name: &str, whole: f64) -> Result<Option<f64>, SvgError> {
    let Some(text) = node.attribute(name).filter(|t| t.trim() != "auto") else {
        return Ok(None);
    };
    let length: svgtypes::Length = text.trim().parse().map_err(|e| wrong(node, name, e))?;
    let value = in_px(length).unwrap_or(length.number * whole / 100.0);
    if value.is_finite() {
        Ok(Some(value))
    } else {
        Err(wrong(node, name, "the number is too large"))
    }
}

/// The place and scale of an inner `svg`.
pub(super) fn viewport(node: &Node, whole: DVec2) -> Result<DAffine2, SvgError> {
    let or =
        |name, of: f64, usual: f64| Ok::<f64, SvgError>(number(node, name, of)?.unwrap_or(usual));
    let at = DVec2::new(or("x", whole.x, 0.0)?, or("y", whole.y, 0.0)?);
    let size = DVec2::new(
        or("width", whole.x, whole.x)?,
        or("height", whole.y, whole.y)?,
    );
    Ok(DAffine2::from_translation(at) * fit(node, size)?)
}

/// Fits the `viewBox` of an element into a size.
pub(super) fn fit(node: &Node, size: DVec2) -> Result<DAffine2, SvgError> {
    use svgtypes::Align;
    let Some([x, y, w, h]) = view_box(node)? else {
        return Ok(DAffine2::IDENTITY);
    };
    let aspect: svgtypes::AspectRatio = match node.attribute("preserveAspectRatio") {
        Some(text) => (text.parse()).map_err(|e| wrong(node, "preserveAspectRatio", e))?,
        None => svgtypes::AspectRatio::default(),
    };
    let scale = size / DVec2::new(w, h);
    let both = if aspect.slice {
        scale.max_element()
    } else {
        scale.min_element()
    };
    let scale = if aspect.align == Align::None {
        scale
    } else {
        DVec2::splat(both)
    };
    let spare = size - scale * DVec2::new(w, h);
    let share = match aspect.align {
        Align::None | Align::XMinYMin => [0.0, 0.0],
        Align::XMidYMin => [0.5, 0.0],
        Align::XMaxYMin => [1.0, 0.0],
        Align::XMinYMid => [0.0, 0.5],
        Align::XMidYMid => [0.5, 0.5],
        Align::XMaxYMid => [1.0, 0.5],
        Align::XMinYMax => [0.0, 1.0],
        Align::XMidYMax => [0.5, 1.0],
        Align::XMaxYMax => [1.0, 1.0],
    };
    Ok(DAffine2::from_translation(spare * DVec2::from(share))
        * DAffine2::from_scale(scale)
        * DAffine2::from_translation(-DVec2::new(x, y)))
}

pub(super) fn view_box(node: &Node) -> Result<Option<[f64; 4]>, SvgError> {
    let Some(text) = node.attribute("viewBox") else {
        return Ok(None);
    };
    let view: svgtypes::ViewBox = text.parse().map_err(|e| wrong(node, "viewBox", e))?;
    let view = [view.x, view.y, view.w, view.h];
    if view.iter().all(|x| x.is_finite()) && view[2] > 0.0 && view[3] > 0.0 {
        Ok(Some(view))
    } else {
        Err(wrong(
            node,
            "viewBox",
            "its width and height have to be above 0",
        ))
    }
}

/// A length in px, where it is no part of something else.
pub(super) fn in_px(length: svgtypes::Length) -> Option<f64> {
    use svgtypes::LengthUnit as U;
    let factor = match length.unit {
        U::None | U::Px => 1.0,
        U::In => 96.0,
        U::Cm => 96.0 / 2.54,
        U::Mm => 96.0 / 25.4,
        U::Pt => 96.0 / 72.0,
        U::Pc => 16.0,
        U::Em => 16.0,
        U::Ex => 8.0,
        U::Percent => return None,
    };
    Some(length.number * factor)
}
