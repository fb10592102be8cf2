//! Shapes of SVG as outlines in the level's coordinates.

use glam::{DAffine2, DVec2};
use kurbo::{BezPath, PathEl, Point, SvgArc, Vec2};
use roxmltree::Node;
use svgtypes::{PathParser, PathSegment};

use super::super::drawing::collect::{MOST_POINTS, Outline, Part};
use super::super::drawing::flatten::{Arc, MOST_PIECES};
use super::SvgError;
use super::attributes::{number, wrong};

/// Whether an element is drawn with lines.
pub(super) fn is_shape(node: &Node) -> bool {
    matches!(
        node.tag_name().name(),
        "path" | "rect" | "circle" | "ellipse" | "line" | "polyline" | "polygon"
    )
}

/// The outlines of a shape, transformed; Bézier curves are cut to the tolerance.
pub(super) fn outlines(
    node: &Node,
    transform: &DAffine2,
    whole: DVec2,
    tolerance: f64,
) -> Result<Vec<Outline>, SvgError> {
    let mut pen = Pen {
        transform: *transform,
        tolerance,
        at: DVec2::ZERO,
        start: DVec2::ZERO,
        outlines: Vec::new(),
        cut: 0,
    };
    let get = |name: &str, of: f64| Ok::<f64, SvgError>(number(node, name, of)?.unwrap_or(0.0));
    // Lengths that are along no axis are parts of this.
    let mean = (whole.length_squared() / 2.0).sqrt();
    match node.tag_name().name() {
        "path" => path(&mut pen, node)?,
        "line" => {
            pen.move_to(DVec2::new(get("x1", whole.x)?, get("y1", whole.y)?));
            pen.line_to(DVec2::new(get("x2", whole.x)?, get("y2", whole.y)?));
        }
        "polyline" | "polygon" => {
            let text = node.attribute("points").unwrap_or_default();
            let points = svgtypes::PointsParser::from(text);
            for (i, (x, y)) in points.enumerate() {
                let p = DVec2::new(x, y);
                if i == 0 {
                    pen.move_to(p)
                } else {
                    pen.line_to(p)
                }
            }
            if node.tag_name().name() == "polygon" {
                pen.close();
            }
        }
        "circle" => {
            let center = DVec2::new(get("cx", whole.x)?, get("cy", whole.y)?);
            pen.ellipse(center, DVec2::splat(get("r", mean)?));
        }
        "ellipse" => {
            let center = DVec2::new(get("cx", whole.x)?, get("cy", whole.y)?);
            pen.ellipse(center, DVec2::new(get("rx", whole.x)?, get("ry", whole.y)?));
        }
        _ => {
            let low = DVec2::new(get("x", whole.x)?, get("y", whole.y)?);
            let size = DVec2::new(get("width", whole.x)?, get("height", whole.y)?);
            let radii = [number(node, "rx", whole.x)?, number(node, "ry", whole.y)?];
            let rx = radii[0].or(radii[1]).unwrap_or(0.0);
            let ry = radii[1].or(radii[0]).unwrap_or(0.0);
            pen.rectangle(low, size, DVec2::new(rx, ry).min(size / 2.0));
        }
    }
    pen.outlines.retain(|o| !o.parts.is_empty());
    Ok(pen.outlines)
}

/// Draws outlines in the element's own coordinates.
struct Pen {
    transform: DAffine2,
    tolerance: f64,
    at: DVec2,
    start: DVec2,
    outlines: Vec<Outline>,
    /// Points of curves so far.
    cut: usize,
}

impl Pen {
    fn to_level(&self, p: DVec2) -> DVec2 {
        self.transform.transform_point2(p)
    }

    fn move_to(&mut self, p: DVec2) {
        (self.at, self.start) = (p, p);
        self.outlines.push(Outline {
            start: self.to_level(p),
            parts: Vec::new(),
        });
    }

    fn push(&mut self, part: Part, to: DVec2) {
        // After a closed outline the pen goes on from its start.
        if self.outlines.is_empty() || self.at == self.start && self.is_closed() {
            self.move_to(self.at);
        }
        if let Some(outline) = self.outlines.last_mut() {
            outline.parts.push(part);
        }
        self.at = to;
    }

    fn is_closed(&self) -> bool {
        self.outlines.last().is_none_or(|o| !o.parts.is_empty())
    }

    fn line_to(&mut self, p: DVec2) {
        self.push(Part::Line(self.to_level(p)), p);
    }

    fn close(&mut self) {
        if self.at != self.start {
            self.line_to(self.start);
        }
    }

    fn curve(&mut self, curve: PathEl, to: DVec2) {
        let from = self.to_level(self.at);
        let points = match curve {
            PathEl::QuadTo(a, b) => vec![a, b],
            PathEl::CurveTo(a, b, c) => vec![a, b, c],
            _ => Vec::new(),
        };
        let reach = points.iter().map(|p| (p.x - from.x).hypot(p.y - from.y));
        let reach = reach.fold(0.0, |m: f64, r| {
            if r.is_finite() {
                m.max(r)
            } else {
                f64::INFINITY
            }
        });
        if reach > 1e15 || !from.is_finite() || self.cut > MOST_POINTS {
            return self.line_to(to); // refused later, with its place
        }
        // No curve takes more than some thousand pieces, whatever the tolerance.
        let tolerance = self.tolerance.max(1e-6 * reach);
        let mut path = BezPath::new();
        path.move_to(Point::new(from.x, from.y));
        path.push(curve);
        let mut points = Vec::new();
        kurbo::flatten(path, tolerance, |el| {
            if let PathEl::LineTo(p) = el
                && points.len() < MOST_PIECES
            {
                points.push(DVec2::new(p.x, p.y));
            }
        });
        // Its end is where the file says.
        points.pop();
        points.push(self.to_level(to));
        self.cut += points.len();
        self.push(Part::Curve(points), to);
    }

    fn point(&self, p: DVec2) -> Point {
        let p = self.to_level(p);
        Point::new(p.x, p.y)
    }

    fn arc(&mut self, radii: DVec2, turn: f64, start: f64, sweep: f64, center: DVec2, to: DVec2) {
        let axis = DVec2::from_angle(turn);
        let arc = Arc {
            center: self.to_level(center),
            major: self.transform.matrix2 * (axis * radii.x),
            minor: self.transform.matrix2 * (axis.perp() * radii.y),
            start,
            sweep,
        };
        self.push(Part::Arc(arc, self.to_level(to)), to);
    }

    fn ellipse(&mut self, center: DVec2, radii: DVec2) {
        use std::f64::consts::TAU;
        if radii.x > 0.0 && radii.y > 0.0 {
            let east = center + DVec2::X * radii.x;
            self.move_to(east);
            self.arc(radii, 0.0, 0.0, TAU, center, east);
        }
    }

    fn rectangle(&mut self, low: DVec2, size: DVec2, radii: DVec2) {
        use std::f64::consts::FRAC_PI_2;
        if size.x <= 0.0 || size.y <= 0.0 {
            return;
        }
        let high = low + size;
        if radii.x <= 0.0 || radii.y <= 0.0 {
            self.move_to(low);
            self.line_to(DVec2::new(high.x, low.y));
            self.line_to(high);
            self.line_to(DVec2::new(low.x, high.y));
            return self.close();
        }
        let (l, h) = (low + radii, high - radii);
        self.move_to(DVec2::new(l.x, low.y));
        let corners = [
            (
                DVec2::new(h.x, low.y),
                DVec2::new(h.x, l.y),
                DVec2::new(high.x, l.y),
            ),
            (
                DVec2::new(high.x, h.y),
                DVec2::new(h.x, h.y),
                DVec2::new(h.x, high.y),
            ),
            (
                DVec2::new(l.x, high.y),
                DVec2::new(l.x, h.y),
                DVec2::new(low.x, h.y),
            ),
            (
                DVec2::new(low.x, l.y),
                DVec2::new(l.x, l.y),
                DVec2::new(l.x, low.y),
            ),
        ];
        for (i, (straight, center, to)) in corners.into_iter().enumerate() {
            if straight != self.at {
                self.line_to(straight);
            }
            let start = FRAC_PI_2 * (i as f64 - 1.0);
            self.arc(radii, 0.0, start, FRAC_PI_2, center, to);
        }
    }
}

/// The attribute `d`.
fn path(pen: &mut Pen, node: &Node) -> Result<(), SvgError> {
    let data = node.attribute("d").unwrap_or_default();
    // The last control point, and whether it is of a cubic curve.
    let mut last: Option<(DVec2, bool)> = None;
    for segment in PathParser::from(data) {
        let segment = segment.map_err(|e| wrong(node, "d", e))?;
        let base = if segment.is_abs() {
            DVec2::ZERO
        } else {
            pen.at
        };
        let to = |x: f64, y: f64| base + DVec2::new(x, y);
        let mirrored = |cubic: bool| match last {
            Some((c, kind)) if kind == cubic => pen.at * 2.0 - c,
            _ => pen.at,
        };
        let mut control = None;
        match segment {
            PathSegment::MoveTo { x, y, .. } => pen.move_to(to(x, y)),
            PathSegment::LineTo { x, y, .. } => pen.line_to(to(x, y)),
            PathSegment::HorizontalLineTo { x, .. } => {
                let y = pen.at.y;
                pen.line_to(DVec2::new(base.x + x, y));
            }
            PathSegment::VerticalLineTo { y, .. } => {
                let x = pen.at.x;
                pen.line_to(DVec2::new(x, base.y + y));
            }
            PathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
                ..
            } => {
                control = Some((to(x2, y2), true));
                cubic(pen, to(x1, y1), to(x2, y2), to(x, y));
            }
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                control = Some((to(x2, y2), true));
                cubic(pen, mirrored(true), to(x2, y2), to(x, y));
            }
            PathSegment::Quadratic { x1, y1, x, y, .. } => {
                control = Some((to(x1, y1), false));
                quadratic(pen, to(x1, y1), to(x, y));
            }
            PathSegment::SmoothQuadratic { x, y, .. } => {
                let c = mirrored(false);
                control = Some((c, false));
                quadratic(pen, c, to(x, y));
            }
            PathSegment::EllipticalArc {
                rx,
                ry,
                x_axis_rotation,
                large_arc,
                sweep,
                x,
                y,
                ..
            } => {
                let end = to(x, y);
                let arc = kurbo::Arc::from_svg_arc(&SvgArc {
                    from: Point::new(pen.at.x, pen.at.y),
                    to: Point::new(end.x, end.y),
                    radii: Vec2::new(rx.abs(), ry.abs()),
                    x_rotation: x_axis_rotation.to_radians(),
                    large_arc,
                    sweep,
                });
                match arc {
                    Some(a) => pen.arc(
                        DVec2::new(a.radii.x, a.radii.y),
                        a.x_rotation,
                        a.start_angle,
                        a.sweep_angle,
                        DVec2::new(a.center.x, a.center.y),
                        end,
                    ),
                    None => pen.line_to(end),
                }
            }
            PathSegment::ClosePath { .. } => {
                pen.close();
                pen.at = pen.start;
            }
        }
        if !pen.at.is_finite() {
            return Err(wrong(node, "d", "a number is too large"));
        }
        last = control;
    }
    Ok(())
}

fn cubic(pen: &mut Pen, a: DVec2, b: DVec2, to: DVec2) {
    let curve = PathEl::CurveTo(pen.point(a), pen.point(b), pen.point(to));
    pen.curve(curve, to);
}

fn quadratic(pen: &mut Pen, a: DVec2, to: DVec2) {
    let curve = PathEl::QuadTo(pen.point(a), pen.point(to));
    pen.curve(curve, to);
}
