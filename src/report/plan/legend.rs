//! What stands around the plan: title, scale bar and legend.

use glam::DVec2;
use svg::node::element::{Circle, Group, Line as LineElement, Path, Rectangle};

use super::layers::{Layers, Line};
use super::palette;
use super::sheet::{ROW, Sheet, short};
use super::{EyeView, Shown, eye, text, text_width};
use crate::cells::CellGraph;
use crate::level::Level;
use crate::report::wording::{area, coordinate, count, grouped, in_sector, unit};

const SIZE: f64 = 13.0;

/// The level's name, and a line about what is shown.
pub(super) fn title(level: &Level, graph: &CellGraph, shown: Shown, sheet: &Sheet) -> Group {
    let how = graph.options.subdivision.as_str();
    let doors = graph.options.doors.as_str();
    let about = match shown {
        Shown::Cell(view) => format!(
            "Cell {}{} sees {} of {} ({how}, doors {doors})",
            view.source.0,
            in_sector(level, graph, view.source),
            grouped(view.pvs.visible.count(view.source.0 as usize) as u64),
            count(graph.cells.len(), "cell"),
        ),
        Shown::Eye(view) => format!("{} ({how}, doors {doors})", of_eye(level, graph, view)),
        Shown::Sectors => {
            let sectors = match level.sectors.len() {
                0 => String::new(),
                n => format!(" in {}", count(n, "sector")),
            };
            format!(
                "{}{sectors}, {} ({how}, doors {doors})",
                count(graph.cells.len(), "cell"),
                count(graph.portals.len(), "portal"),
            )
        }
    };
    Group::new()
        .set("id", "title")
        .add(text(&level.name, sheet.side, 44.0, 25.0))
        .add(text(&about, sheet.side, 66.0, SIZE).set("fill", "#5c636e"))
}

/// `Eye at 1.00, 2.00 in 'Hall', looking 90° with 60° in view: sees 14 of the 53 cells of its PVS,
/// 96.3 m²`
fn of_eye(level: &Level, graph: &CellGraph, view: &EyeView) -> String {
    let at = view.vista.eye().to_level(&graph.grid);
    let place = match view.vista.own_cells() {
        &[own] => in_sector(level, graph, own),
        several => format!(" between {}", count(several.len(), "cell")),
    };
    let cone = if view.fov == 360.0 {
        "looking all around".to_string()
    } else {
        // To a hundredth; f64 writes whole numbers without a point.
        let [direction, fov] = [view.direction, view.fov].map(short);
        format!("looking {direction}° with {fov}° in view")
    };
    format!(
        "Eye at {}, {}{place}, {cone}: sees {} of the {} of its PVS, {}",
        coordinate(level, at.x),
        coordinate(level, at.y),
        grouped(view.vista.cells().len() as u64),
        count(view.n_pvs(graph), "cell"),
        area(level, view.vista.area() * level.grid.step.length().powi(2)),
    )
}

/// A bar of a round length, at most an eighth of the page wide, at the upper right.
pub fn scale_bar(level: &Level, sheet: &Sheet) -> Group {
    let unit_length = sheet.scale / level.grid.step.length();
    let wanted = sheet.width / 8.0 / unit_length;
    let power = 10f64.powf(wanted.log10().floor());
    let length = [5.0, 2.0, 1.0]
        .map(|m| m * power)
        .into_iter()
        .find(|&l| l <= wanted);
    let length = length.unwrap_or(power);
    let line = |x0: f64, y0: f64, x1: f64, y1: f64| {
        let line = LineElement::new().set("x1", short(x0)).set("y1", short(y0));
        line.set("x2", short(x1)).set("y2", short(y1))
    };
    // f64's own way of writing gives 0.5, 20 and 1000 as they are.
    let label = format!(
        "{length} {}",
        if length == 1.0 {
            level.unit.clone()
        } else {
            unit(level)
        }
    );
    let right = sheet.width - sheet.side - text_width(&label, SIZE) - 10.0;
    let left = right - length * unit_length;
    let y = 61.5;
    Group::new()
        .set("id", "scale")
        .set("stroke-width", 1.2)
        .add(line(left, y, right, y).set("stroke", palette::WALL))
        .add(line(left, y - 4.0, left, y + 4.0).set("stroke", palette::WALL))
        .add(line(right, y - 4.0, right, y + 4.0).set("stroke", palette::WALL))
        .add(text(&label, right + 10.0, y + 4.5, SIZE).set("stroke-width", 0))
}

/// A sample of what is explained in the legend.
pub enum Swatch {
    Area(&'static str),
    Stroke {
        colour: &'static str,
        width: f64,
        dashes: &'static str,
        inner: bool,
    },
    Sight,
    Dot(&'static str),
    Eye,
}

/// The colours and lines that occur in the picture, in rows below it; and how many rows.
pub(super) fn of_layers(layers: &Layers, shown: Shown, sheet: &Sheet) -> (Group, usize) {
    let mut items: Vec<Item> = Vec::new();
    if let Shown::Cell(view) = shown {
        let [source, seen, other] = palette::VIEW;
        items.push(("source cell", Swatch::Area(source)));
        items.push(("visible", Swatch::Area(seen)));
        items.push(("not visible", Swatch::Area(other)));
        if !view.lines.is_empty() {
            items.push(("sample sightlines", Swatch::Sight));
        }
    }
    if let Shown::Eye(view) = shown {
        let [seen, culled, other] = palette::EYE_VIEW;
        let label = if view.fov == 360.0 {
            "eye"
        } else {
            "eye and edges of its view"
        };
        items.push((label, Swatch::Eye));
        items.push(("ground in sight", Swatch::Area(palette::IN_SIGHT)));
        items.push(("rest of a cell in view", Swatch::Area(seen)));
        items.push(("in the PVS, but not in view", Swatch::Area(culled)));
        items.push(("not in the PVS", Swatch::Area(other)));
    }
    of_items(items, layers, sheet)
}

/// A sample with what it stands for.
pub type Item = (&'static str, Swatch);

/// As [`of_layers`], with some items first.
pub fn of_items(mut items: Vec<Item>, layers: &Layers, sheet: &Sheet) -> (Group, usize) {
    let mut stroke = |line, label, colour, width, dashes, inner| {
        if layers.has(line) {
            items.push((
                label,
                Swatch::Stroke {
                    colour,
                    width,
                    dashes,
                    inner,
                },
            ));
        }
    };
    stroke(Line::Wall, "wall", palette::WALL, 2.4, "", false);
    stroke(
        Line::ClosedDoor,
        "closed door",
        palette::CLOSED,
        2.8,
        "",
        false,
    );
    stroke(Line::Door, "door", palette::DOOR, 2.6, "", false);
    stroke(Line::Window, "window", palette::WINDOW, 3.4, "", true);
    stroke(
        Line::Archway,
        "archway",
        palette::ARCHWAY,
        2.2,
        "2.2 2.6",
        false,
    );
    stroke(
        Line::Step,
        "change of sector",
        palette::PORTAL,
        0.9,
        "",
        false,
    );
    stroke(
        Line::Border,
        "other portal",
        palette::PORTAL,
        0.7,
        "3.5 2.8",
        false,
    );

    let mut group = Group::new().set("id", "legend");
    let (mut x, mut rows) = (sheet.side, 1);
    for (label, swatch) in items {
        let width = 32.0 + text_width(label, SIZE);
        if x + width > sheet.width - sheet.side {
            (x, rows) = (sheet.side, rows + 1);
        }
        let y = sheet.foot + ROW * (rows - 1) as f64;
        group = draw_swatch(group, &swatch, x, y);
        group = group.add(text(label, x + 32.0, y + 4.5, SIZE));
        x += width + 22.0;
    }
    (group, rows)
}

fn draw_swatch(group: Group, swatch: &Swatch, x: f64, y: f64) -> Group {
    let line = |colour: &str, width: f64| {
        Path::new()
            .set("d", format!("M{} {}h24", short(x), short(y)))
            .set("stroke", colour)
            .set("stroke-width", width)
            .set("fill", "none")
    };
    match *swatch {
        Swatch::Area(colour) => group.add(
            Rectangle::new()
                .set("x", short(x))
                .set("y", short(y - 6.0))
                .set("width", 24)
                .set("height", 12)
                .set("fill", colour)
                .set("stroke", palette::PORTAL)
                .set("stroke-width", 0.4),
        ),
        Swatch::Stroke {
            colour,
            width,
            dashes,
            inner,
        } => {
            let outer = line(colour, width);
            let outer = if dashes.is_empty() {
                outer
            } else {
                outer.set("stroke-dasharray", dashes)
            };
            let group = group.add(outer);
            if inner {
                group.add(line("white", width * 0.4))
            } else {
                group
            }
        }
        Swatch::Dot(colour) => group.add(
            Circle::new()
                .set("cx", short(x + 12.0))
                .set("cy", short(y))
                .set("r", 4.5)
                .set("fill", colour),
        ),
        Swatch::Eye => group
            .add(line(palette::EYE, 1.8))
            .add(eye::dot(DVec2::new(x + 6.0, y))),
        Swatch::Sight => group.add(line(palette::SIGHT, 0.9)).add(
            Circle::new()
                .set("cx", short(x + 24.0))
                .set("cy", short(y))
                .set("r", 1.8)
                .set("fill", palette::SIGHT),
        ),
    }
}
