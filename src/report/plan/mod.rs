//! Pictures of the plan: cells by sector, portals, walls and openings; or what one cell, or one eye,
//! sees.
//!
//! In: a level, its cells, and for the other kinds a source cell with its PVS, or an eye's view. Out:
//! an SVG document 1200 units wide. With a source it shows what the lecture's result (a) does: the
//! source cell dark blue, its visible cells light blue, sample stabbing lines green. With an eye,
//! result (d): cells in view blue, the exact visible area blue-green, culled cells of the PVS green.

mod explained;
mod eye;
mod layers;
mod legend;
mod marks;
pub(super) mod names;
mod palette;
mod sheet;

use svg::Document;
use svg::node::element::Rectangle;

pub use self::explained::draw_explained;
pub use self::eye::EyeView;
use self::layers::Layers;
pub(super) use self::layers::{Line, line_of};
use self::sheet::Sheet;
use super::sightlines::Sightline;
use crate::cells::{CellGraph, CellId};
use crate::level::{Finding, Level};
use crate::pvs::Pvs;

/// What one cell sees.
#[derive(Clone, Debug)]
pub struct View<'a> {
    /// The cell.
    pub source: CellId,
    /// Who sees whom.
    pub pvs: &'a Pvs,
    /// Sample sightlines from the source.
    pub lines: Vec<Sightline>,
}

/// What a picture is about.
#[derive(Clone, Copy)]
enum Shown<'a> {
    Sectors,
    Cell(&'a View<'a>),
    Eye(&'a EyeView<'a>),
}

/// Draws the plan. The document's `width` attribute is `width` pixels.
pub fn draw(level: &Level, graph: &CellGraph, view: Option<&View>, width: u32) -> Document {
    picture(
        level,
        graph,
        view.map_or(Shown::Sectors, Shown::Cell),
        width,
    )
}

/// Draws the plan with marks where something was found to be wrong or mended.
pub fn draw_findings(
    level: &Level,
    graph: &CellGraph,
    findings: &[Finding],
    width: u32,
) -> Document {
    let marks = marks::of_findings(level, findings, &Sheet::of(graph));
    draw(level, graph, None, width).add(marks)
}

/// Draws what an eye sees, as [`draw`] does.
pub fn draw_eye(level: &Level, graph: &CellGraph, view: &EyeView, width: u32) -> Document {
    picture(level, graph, Shown::Eye(view), width)
}

fn picture(level: &Level, graph: &CellGraph, shown: Shown, width: u32) -> Document {
    let sheet = Sheet::of(graph);
    let layers = Layers::new(level, graph, &sheet);
    let (legend, rows) = legend::of_layers(&layers, shown, &sheet);
    let height = sheet.height + (rows - 1) as f64 * sheet::ROW;
    let mut document = Document::new()
        .set("viewBox", (0, 0, sheet.width, height))
        .set("width", width)
        .set("height", (f64::from(width) * height / sheet.width).round())
        .set("font-family", super::picture::FONT)
        .set("font-weight", 300)
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        );
    let colours = palette::by_sector(graph, level.sectors.len());
    document = match shown {
        Shown::Sectors => document.add(layers.sectors(&colours)),
        Shown::Cell(view) => document.add(layers.visible(view)),
        Shown::Eye(view) => document
            .add(eye::cells(&layers, graph, view))
            .add(eye::area(&sheet, view)),
    };
    document = document.add(layers.portals()).add(layers.steps());
    if let Shown::Cell(view) = shown {
        document = document.add(layers.sightlines(view));
    }
    document = document.add(layers.openings()).add(layers.walls());
    document = match shown {
        Shown::Sectors => document.add(names::of_rooms(level, graph, &sheet, &colours)),
        Shown::Cell(_) => document,
        Shown::Eye(view) => document.add(eye::eye(&sheet, view)),
    };
    document
        .add(legend::title(level, graph, shown, &sheet))
        .add(legend::scale_bar(level, &sheet))
        .add(legend)
}

/// Text with its characters' own spaces kept.
fn text(content: &str, x: f64, y: f64, size: f64) -> svg::node::element::Text {
    svg::node::element::Text::new(content)
        .set("x", sheet::short(x))
        .set("y", sheet::short(y))
        .set("font-size", size)
        .set("fill", "#23272e")
}

/// About how wide a text is in Ubuntu Light, in the unit of `size`.
fn text_width(content: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | '\'' | ':' | ' ' | '|' | '!' => 0.26,
        'f' | 't' | 'r' | '-' | '(' | ')' => 0.36,
        'm' | 'w' | 'M' | 'W' => 0.86,
        c if c.is_uppercase() => 0.66,
        _ => 0.54,
    };
    content.chars().map(em).sum::<f64>() * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::{Progress, sweep::sweep};
    use crate::report::sightlines;

    const ROOMS: &str = "[[room]]\nname = \"A & <B>\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"C\"\nrect = [4, 0, 8, 4]\n\
        [[door]]\nbetween = [\"A & <B>\", \"C\"]\nwidth = 1\n";

    #[test]
    fn names_are_escaped_and_pictures_valid() {
        let level = read(ROOMS.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let plain = draw(&level, &graph, None, 400).to_string();
        assert!(plain.contains("A &amp; &lt;B&gt;"), "{plain}");
        let found = Finding::at(
            "gap",
            crate::level::Severity::Warning,
            "A gap.",
            vec![
                level.walls[0].place,
                crate::level::Place::Point { x: 1.0, y: 1.0 },
            ],
        );
        let found: Vec<Finding> = found.into_iter().collect();
        let marked = draw_findings(&level, &graph, &found, 400).to_string();
        assert_eq!(
            marked.matches("<circle").count(),
            plain.matches("<circle").count() + 2
        );
        let pvs = sweep(&graph, &Progress::default());
        let source = CellId(0);
        let lines = sightlines::sample(&graph, &pvs, source, 5);
        let view = View {
            source,
            pvs: &pvs,
            lines,
        };
        let seen = draw(&level, &graph, Some(&view), 400).to_string();
        for svg in [plain, marked, seen] {
            crate::report::picture::png(&svg, 300).unwrap();
        }
    }

    #[test]
    fn marks_stand_where_the_findings_are() {
        // The grid's origin is in the middle of the plan, and its steps are no metres.
        let text = "[[room]]\nname = \"A\"\nrect = [10.25, 20.5, 14.25, 24.5]\n";
        let level = read(text.into(), "room.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let corners = [[10.25, 20.5], [14.25, 24.5], [10.25, 24.5]];
        let places = corners.map(|[x, y]| crate::level::Place::Point { x, y });
        let found = Finding::at(
            "gap",
            crate::level::Severity::Warning,
            "A gap.",
            places.into(),
        );
        let found: Vec<Finding> = found.into_iter().collect();
        let svg = draw_findings(&level, &graph, &found, 400).to_string();
        let sheet = Sheet::of(&graph);
        let [corner, size] = sheet.frame();
        let at = |x: f64, y: f64| {
            let p = corner + size * glam::DVec2::new(x, y);
            let ring = format!("cx=\"{}\" cy=\"{}\"", sheet::short(p.x), sheet::short(p.y));
            assert!(svg.contains(&ring), "{ring} in {svg}");
        };
        at(0.0, 1.0);
        at(1.0, 0.0);
        at(0.0, 0.0);
    }

    #[test]
    fn a_level_without_cells_gives_a_picture() {
        let level = read(
            b"[[wall]]\npoints = [[0, 0], [1, 0]]".into(),
            "w.toml",
            None,
        )
        .unwrap();
        let graph = subdivide(&level, &Options::default());
        assert!(graph.cells.is_empty());
        let svg = draw(&level, &graph, None, 400).to_string();
        crate::report::picture::png(&svg, 300).unwrap();
    }
}
