//! SVG drawings of the plan in layers, for Inkscape and for the reader of this crate.
//!
//! One user unit is one unit of the level; y goes down and is 0 at the foot of the page: that is a whole
//! number of units above the level's 0, told by `data-foot`. All numbers have as many digits as it takes
//! to read the same ones back. SVG has no word for metres, so the unit is told by `data-unit` alone, and
//! whoever reads the drawing again says `--unit`.
//!
//! Layers are groups with an `id`, a `class` and Inkscape's label: `cells`, `portals`, `steps`, `walls`,
//! `columns`, `archways`, `doors`, `windows`, `rooms` (names). Each wall is an element of its own, of
//! the class `wall`, and so are doors and the rest; cells have the ids `cell-0`, `cell-1`, …
//!
//! (The pictures of [`report::plan`](crate::report::plan) are for looking at; these are for working on.)

use glam::DVec2;
use svg::Document;
use svg::node::Value;
use svg::node::element::{Group, Line, Polygon, Style, Text};

use super::Known;
use super::dxf::Extra;
use super::lines::{Kind, Lines};
use crate::geom::Vertex;
use crate::report::json::polygon;

/// How it looks. Widths are in hundredths of the drawing's size.
const STYLE: &str = "
.cells { fill: #eef3f8; stroke: #c9d6e2; stroke-width: .05 }
.portals { fill: none; stroke: #7d9db8; stroke-width: .08; stroke-dasharray: .4 .3 }
.steps { fill: none; stroke: #9aa5b1; stroke-width: .08 }
.walls { fill: none; stroke: #23272e; stroke-width: .2; stroke-linecap: round }
.columns { fill: #23272e; stroke: #23272e; stroke-width: .1 }
.archways { fill: none; stroke: #5b8c5a; stroke-width: .15; stroke-dasharray: .3 .3 }
.doors { fill: none; stroke: #b5651d; stroke-width: .2 }
.windows { fill: none; stroke: #2a8fbd; stroke-width: .2 }
.rooms { fill: #23272e; font-family: sans-serif; text-anchor: middle }
";

/// Draws a level. Of a `.pvs` file alone the openings are not known: they are gaps in the walls.
pub fn draw(known: &Known, extra: Extra) -> Document {
    let [low, high] = extent(known);
    let size = high - low;
    let scale = size.max_element() / 100.0;
    let mut document = Document::new()
        .set(
            "xmlns:inkscape",
            "http://www.inkscape.org/namespaces/inkscape",
        )
        .set("viewBox", view_box([low.x, -size.y, size.x, size.y]))
        .set("data-unit", &*known.info.unit)
        .set("data-foot", low.y)
        .add(svg::node::element::Title::new(&*known.info.name))
        .add(Style::new(styled(scale)));
    let page = Page { foot: low.y };
    if extra.cells {
        let cells = known.graph.cell_ids().map(|cell| {
            let corners = polygon(known.graph, cell);
            let sees = known.pvs.map(|pvs| pvs.seen_from(cell).count());
            let mut area = page
                .shape(&corners, "cell")
                .set("id", format!("cell-{}", cell.0));
            for (key, value) in [
                (
                    "data-sector",
                    known.graph.cell(cell).sector.map(|s| s.0 as usize),
                ),
                ("data-sees", sees),
            ] {
                if let Some(value) = value {
                    area = area.set(key, value);
                }
            }
            area
        });
        document = document.add(cells.fold(layer("cells", "Cells"), Group::add));
    }
    if extra.portals {
        let portals = known.graph.portals.iter().enumerate().map(|(i, portal)| {
            let line = page.line(super::segment(known.graph, portal), "portal");
            line.set("id", format!("portal-{i}"))
        });
        document = document.add(portals.fold(layer("portals", "Portals"), Group::add));
    }
    let Some(level) = known.level else {
        let walls = Lines::of_cells(known.graph).into_iter();
        let walls = walls.map(|ends| page.line(ends, "wall"));
        return document.add(walls.fold(layer("walls", "Walls"), Group::add));
    };
    let lines = Lines::of_level(level, known.graph);
    let kind = |kind: Kind, class: &'static str| {
        lines.of(kind).map(move |drawn| {
            let ends = drawn.ends.map(|p| level.grid.to_level(p));
            let mut element = page.line(ends, class);
            if let Some(name) = &drawn.name {
                // Not as a label: a serving hatch is no hatching.
                element = element.set("data-name", &**name);
            }
            if drawn.shut {
                element = element.set("data-closed", "true");
            }
            element
        })
    };
    let solids = lines.solids.iter().map(|corners| {
        let corners: Vec<DVec2> = corners.iter().map(|&p| level.grid.to_level(p)).collect();
        page.shape(&corners, "column")
    });
    let rooms = super::labels(known).into_iter().map(|(name, at, height)| {
        Text::new(name)
            .set("x", at.x + 0.0)
            .set("y", page.y(at.y))
            .set("font-size", height)
    });
    document
        .add(kind(Kind::Step, "step").fold(layer("steps", "Steps"), Group::add))
        .add(kind(Kind::Wall, "wall").fold(layer("walls", "Walls"), Group::add))
        .add(solids.fold(layer("columns", "Columns"), Group::add))
        .add(kind(Kind::Archway, "archway").fold(layer("archways", "Archways"), Group::add))
        .add(kind(Kind::Door, "door").fold(layer("doors", "Doors"), Group::add))
        .add(kind(Kind::Window, "window").fold(layer("windows", "Windows"), Group::add))
        .add(rooms.fold(layer("rooms", "Room names"), Group::add))
}

/// The corners of all there is, with a margin.
fn extent(known: &Known) -> [DVec2; 2] {
    let grid = &known.graph.grid;
    let walls = known.level.into_iter().flat_map(|level| &level.walls);
    let of_walls = walls
        .flat_map(|wall| [wall.from, wall.to])
        .map(|p| grid.to_level(p));
    let of_cells = known
        .graph
        .vertices
        .iter()
        .map(|v: &Vertex| v.to_level(grid));
    let all = of_walls.chain(of_cells).map(|p| (p, p));
    let (low, high) = all
        .reduce(|(low, high), (p, _)| (low.min(p), high.max(p)))
        .unwrap_or((DVec2::ZERO, DVec2::ONE));
    // A whole number, so that the corner is one, too.
    let margin = ((high - low).max_element() / 50.0)
        .max(f64::MIN_POSITIVE)
        .ceil();
    [(low - margin).floor(), (high + margin).ceil()]
}

/// The style, its widths in user units.
fn styled(scale: f64) -> String {
    let width = |word: &str| match word.strip_prefix('.').map(|_| word.parse::<f64>()) {
        Some(Ok(width)) => format!("{}", width * scale),
        _ => word.to_string(),
    };
    let line = |line: &str| -> String {
        let (class, rest) = line.split_once(' ').unwrap_or((line, ""));
        let words = rest.split(' ').map(|word| match word.strip_suffix(';') {
            Some(word) => width(word) + ";",
            None => width(word),
        });
        format!("{class} {}", words.collect::<Vec<_>>().join(" "))
    };
    let lines: Vec<String> = STYLE.trim().lines().map(line).collect();
    lines.join("\n")
}

fn layer(id: &str, label: &str) -> Group {
    Group::new()
        .set("id", id)
        .set("class", id)
        .set("inkscape:groupmode", "layer")
        .set("inkscape:label", label)
}

fn view_box(numbers: [f64; 4]) -> Value {
    numbers.map(|n| format!("{}", n + 0.0)).join(" ").into()
}

/// Where the foot of the page is: a y of the level.
#[derive(Clone, Copy)]
struct Page {
    foot: f64,
}

impl Page {
    fn y(self, y: f64) -> f64 {
        super::decimal(self.foot - y) + 0.0
    }

    fn line(self, [from, to]: [DVec2; 2], class: &str) -> Line {
        Line::new()
            .set("class", class)
            .set("x1", from.x + 0.0)
            .set("y1", self.y(from.y))
            .set("x2", to.x + 0.0)
            .set("y2", self.y(to.y))
    }

    fn shape(self, corners: &[DVec2], class: &str) -> Polygon {
        let point = |p: &DVec2| format!("{},{}", p.x + 0.0, self.y(p.y));
        let points: Vec<String> = corners.iter().map(point).collect();
        Polygon::new()
            .set("class", class)
            .set("points", points.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;
    use crate::pvs::file::LevelInfo;

    const ROOMS: &str = "[[room]]\nname = \"A & <B>\"\nrect = [0.1, 0, 4, 4]\n\
        [[room]]\nname = \"C\"\nrect = [4, 0, 8, 4]\n[[pillar]]\nrect = [1, 1, 2, 2]\n\
        [[door]]\nbetween = [\"A & <B>\", \"C\"]\nwidth = 1\nname = \"D\"\n";

    #[test]
    fn layers_with_what_is_on_them() {
        let level = read(ROOMS.into(), "a.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let known = Known {
            info: &LevelInfo::of(&level),
            level: Some(&level),
            graph: &graph,
            pvs: None,
        };
        let all = Extra {
            cells: true,
            portals: true,
        };
        let text = draw(&known, all).to_string();
        for part in [
            r#"inkscape:label="Walls""#,
            r#"viewBox="-1 -6 10 6""#,
            r#"data-foot="-1""#,
            "A &amp; &lt;B&gt;",
            r#"id="cell-0""#,
            // x as it is, y from the foot of the page.
            r#"x1="0.1""#,
            r#"y1="-5""#,
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let count = |class: &str| text.matches(&format!("class=\"{class}\"")).count();
        assert_eq!((count("wall"), count("door"), count("column")), (6, 1, 1));
        assert_eq!(count("cell"), graph.cells.len());
        let door = text.lines().find(|l| l.contains("class=\"door\"")).unwrap();
        assert!(
            door.contains("data-closed") && door.contains("data-name=\"D\""),
            "{door}"
        );
        crate::report::picture::png(&text, 300).unwrap();
        let bare = Known {
            level: None,
            ..known
        };
        let text = draw(
            &bare,
            Extra {
                cells: false,
                portals: false,
            },
        )
        .to_string();
        assert!(
            !text.contains("id=\"cells\"") && text.contains("class=\"wall\""),
            "{text}"
        );
    }
}
