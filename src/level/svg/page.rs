//! The page of an SVG drawing: its unit and size, and how far curves may be off.

use glam::{DAffine2, DVec2};
use roxmltree::Node;

use super::SvgError;
use super::attributes::{in_px, view_box};
use crate::level::drawing::DrawingOptions;
use crate::level::drawing::unit::Unit;

/// What the outermost `svg` says: from the user's units to the level's.
pub(super) struct Page {
    pub unit: Unit,
    pub transform: DAffine2,
    /// Width and height in the user's units, for percentages.
    pub size: DVec2,
    pub tolerance: f64,
}

impl Page {
    /// Reads the attributes of the outermost `svg`.
    pub fn of(root: &Node, options: &DrawingOptions) -> Result<Page, SvgError> {
        let length = |name: &str| {
            let text = root.attribute(name)?;
            text.trim().parse::<svgtypes::Length>().ok()
        };
        let (width, height) = (length("width"), length("height"));
        let view = view_box(root)?;
        let px =
            |l: Option<svgtypes::Length>| l.and_then(in_px).filter(|x| x.is_finite() && *x > 0.0);
        let size = match view {
            Some([_, _, w, h]) => DVec2::new(w, h),
            None => DVec2::new(px(width).unwrap_or(0.0), px(height).unwrap_or(0.0)),
        };
        let low = view.map_or(DVec2::ZERO, |[x, y, ..]| DVec2::new(x, y));
        let physical = width.filter(|l| is_physical(l.unit)).and_then(in_px);
        let (unit, factor) = match (&options.unit, physical) {
            (Some(unit), _) => (unit.clone(), unit.factor),
            (None, Some(width)) => {
                let of_width = view.map_or(1.0, |[.., w, _]| width / w);
                let of_height = px(height).zip(view).map_or(of_width, |(h, v)| h / v[3]);
                let mm = of_width.min(of_height) * 25.4 / 96.0;
                // Written as 210mm for 210 units: not 0.9999.
                let mm = if (mm - 1.0).abs() < 1e-6 { 1.0 } else { mm };
                let unit = Unit::named("mm", "the width of the page");
                (unit.unwrap_or_else(|| Unit::unknown("mm", "the page")), mm)
            }
            (None, None) => (Unit::unknown("px", "nothing"), 1.0),
        };
        let usual = match unit.metres {
            Some(metres) => 0.01 / metres,
            None => size.max_element().max(1.0) * factor / 2000.0,
        };
        Ok(Page {
            unit,
            transform: DAffine2::from_scale(DVec2::new(factor, -factor))
                * DAffine2::from_translation(DVec2::new(0.0, -(low.y + size.y))),
            size,
            tolerance: options.tolerance.unwrap_or(usual),
        })
    }
}

fn is_physical(unit: svgtypes::LengthUnit) -> bool {
    use svgtypes::LengthUnit::{Cm, In, Mm, Pc, Pt};
    matches!(unit, Cm | In | Mm | Pc | Pt)
}
