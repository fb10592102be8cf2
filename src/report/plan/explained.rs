//! The picture of an explanation: the two cells, and what lies between them.
//!
//! Where they see each other: the cells and portals on the sightline, the strip of parallel
//! sightlines around it, and the wall ends that bound it. Where they do not: the shortest way, how far
//! sight gets along it, and the wall ends between which no line passes. Shows the part of the plan
//! that matters.

use glam::DVec2;
use svg::Document;
use svg::node::element::{Circle, ClipPath, Definitions, Group, Path, Rectangle};

use super::layers::Layers;
use super::legend::{self, Item, Swatch};
use super::sheet::{self, PathData, Sheet, short};
use super::{names, palette, text};
use crate::cells::{CellGraph, CellId, EdgeId};
use crate::geom::VertexId;
use crate::level::Level;
use crate::pvs::explain::{Explanation, Hidden, Space, Straight, View, last_cell, middle};
use crate::report::explain::{Explained, prolonged};
use crate::report::picture::FONT;
use crate::report::wording::in_sector;

/// Draws an explanation. The document's `width` attribute is `width` pixels.
pub fn draw_explained(
    level: &Level,
    graph: &CellGraph,
    explained: &Explained,
    width: u32,
) -> Document {
    let scene = Scene::of(graph, explained);
    let sheet = Sheet::around(graph, scene.points(graph).into_iter());
    let layers = Layers::new(level, graph, &sheet);
    let draw = Draw {
        graph,
        sheet: &sheet,
        explained,
        scene: &scene,
        thick: layers.wall,
    };
    let (legend, rows) = legend::of_items(draw.legend(), &layers, &sheet);
    let height = sheet.height + (rows - 1) as f64 * sheet::ROW;
    let plan = Group::new()
        .set("clip-path", "url(#part)")
        .add(draw.ground(&layers))
        .add(layers.portals())
        .add(layers.steps())
        .add(draw.under())
        .add(layers.openings())
        .add(layers.walls())
        .add(names::beside(level, graph, &sheet, &[], &draw.lines()))
        .add(draw.over());
    Document::new()
        .set("viewBox", (0, 0, sheet.width, height))
        .set("width", width)
        .set("height", (f64::from(width) * height / sheet.width).round())
        .set("font-family", FONT)
        .set("font-weight", 300)
        .add(part(&sheet))
        .add(
            Rectangle::new()
                .set("width", "100%")
                .set("height", "100%")
                .set("fill", "white"),
        )
        .add(plan)
        .add(draw.frame())
        .add(draw.badges())
        .add(draw.title(level))
        .add(legend::scale_bar(level, &sheet))
        .add(legend)
}

/// Nothing is drawn outside of the part of the plan that is shown.
fn part(sheet: &Sheet) -> Definitions {
    let part = ClipPath::new().set("id", "part").add(framed(sheet));
    Definitions::new().add(part)
}

/// The plan's frame, a little outside of its outermost walls.
fn framed(sheet: &Sheet) -> Rectangle {
    const MARGIN: f64 = 6.0;
    let [corner, size] = sheet.frame();
    Rectangle::new()
        .set("x", short(corner.x - MARGIN))
        .set("y", short(corner.y - MARGIN))
        .set("width", short(size.x + 2.0 * MARGIN))
        .set("height", short(size.y + 2.0 * MARGIN))
}

/// Radius of the badges of A and B.
const RADIUS: f64 = 9.5;

/// What is to be seen, in grid steps.
struct Scene {
    /// The cells on the sightline or way, first to last.
    cells: Vec<CellId>,
    /// How many of them the first cell sees.
    seen: usize,
    portals: Vec<EdgeId>,
    /// Openings too low or too high for sight in space.
    blocking: Vec<EdgeId>,
    /// Where the two places are.
    ends: [DVec2; 2],
    /// Corners of the bundle of sightlines.
    bundle: Option<[DVec2; 4]>,
    /// Ends of walls that bound or block: on the left, on the right.
    bounds: [Vec<DVec2>; 2],
    /// From the strip's border to the nearest wall.
    gaps: Vec<[DVec2; 2]>,
    /// The shortest way.
    way: Vec<DVec2>,
    /// The sightline that gets farthest, prolonged, and how far it is a sightline.
    farthest: Option<[DVec2; 3]>,
}

impl Scene {
    fn of(graph: &CellGraph, explained: &Explained) -> Scene {
        let asked = explained.asked;
        let [a, b] = asked.map(|place| place.cell);
        let mut scene = Scene {
            cells: vec![a, b],
            seen: 2,
            portals: Vec::new(),
            blocking: Vec::new(),
            ends: [a, b].map(|cell| middle(graph, cell)),
            bundle: None,
            bounds: [Vec::new(), Vec::new()],
            gaps: Vec::new(),
            way: Vec::new(),
            farthest: None,
        };
        match &explained.explanation {
            Explanation::Same => {}
            Explanation::Apart => scene.seen = 1,
            Explanation::Visible(view) => scene.add_view(graph, [a, b], view),
            Explanation::Hidden(hidden) => {
                scene.add_way(graph, a, hidden);
                scene.farthest = explained.farthest.as_ref().and_then(|view| {
                    let (_, end) = prolonged(graph, view)?;
                    Some([view.segment.from.approx(), view.segment.to.approx(), end])
                });
            }
        }
        for (end, place) in scene.ends.iter_mut().zip(asked) {
            if let Some(p) = place.point {
                *end = DVec2::new(p.x as f64, p.y as f64);
            }
        }
        scene
    }

    fn add_view(&mut self, graph: &CellGraph, [a, b]: [CellId; 2], view: &View) {
        self.portals = view.portals.clone();
        if let Some(Space::Blocked(openings)) = &view.space {
            self.blocking = openings.clone();
        }
        self.cells = along(graph, a, &view.portals);
        self.seen = self.cells.len();
        self.ends = [&view.segment.from, &view.segment.to].map(|p| p.approx());
        self.bundle = Some(view.outline(graph, a, b));
        let touching = [&view.strip.left, &view.strip.right];
        let to_left = view.strip.direction.perp();
        for (i, to_strip) in [-to_left, to_left].into_iter().enumerate() {
            match &view.beside[i] {
                None => self.bounds[i] = places(graph, touching[i]),
                Some(beside) => {
                    self.bounds[i] = vec![beside.at];
                    self.gaps
                        .push([beside.at, beside.at + to_strip * beside.distance]);
                }
            }
        }
    }

    fn add_way(&mut self, graph: &CellGraph, a: CellId, hidden: &Hidden) {
        self.portals = hidden.way.portals.clone();
        self.cells = along(graph, a, &hidden.way.portals);
        self.seen = hidden.stop + 1;
        self.bounds = [&hidden.ends.left, &hidden.ends.right].map(|ends| places(graph, ends));
        self.way = hidden.way.points.clone();
    }

    /// All that should be on the page.
    fn points(&self, graph: &CellGraph) -> Vec<DVec2> {
        let mut points = self.ends.to_vec();
        points.extend(self.bundle.iter().flatten());
        points.extend(self.bounds.iter().flatten());
        points.extend(&self.way);
        points.extend(self.farthest.iter().flatten());
        for &portal in &self.portals {
            let ends = [graph.edge(portal).origin, graph.end(portal)];
            // Long portals reach far beyond what matters.
            let [p, q] = ends.map(|v| graph.vertices.approx(v));
            points.push(p.midpoint(q));
        }
        points
    }
}

/// The cells of a chain.
fn along(graph: &CellGraph, start: CellId, portals: &[EdgeId]) -> Vec<CellId> {
    (0..=portals.len())
        .map(|n| last_cell(graph, start, &portals[..n]))
        .collect()
}

fn places(graph: &CellGraph, vertices: &[VertexId]) -> Vec<DVec2> {
    vertices.iter().map(|&v| graph.vertices.approx(v)).collect()
}

struct Draw<'a> {
    graph: &'a CellGraph,
    sheet: &'a Sheet,
    explained: &'a Explained,
    scene: &'a Scene,
    /// Width of walls on the page.
    thick: f64,
}

impl Draw<'_> {
    fn on_page(&self, points: &[DVec2]) -> Vec<DVec2> {
        points.iter().map(|&p| self.sheet.at(p)).collect()
    }

    fn line(&self, points: &[DVec2], colour: &str, width: f64) -> Path {
        let mut data = PathData::default();
        for pair in self.on_page(points).windows(2) {
            data.segment(pair[0], pair[1]);
        }
        Path::new()
            .set("d", data.0)
            .set("stroke", colour)
            .set("stroke-width", short(width))
            .set("stroke-linecap", "round")
            .set("fill", "none")
    }

    fn dot(&self, at: DVec2, radius: f64, colour: &str) -> Circle {
        let at = self.sheet.at(at);
        Circle::new()
            .set("cx", short(at.x))
            .set("cy", short(at.y))
            .set("r", radius)
            .set("fill", colour)
            .set("stroke", "white")
            .set("stroke-width", 1.2)
    }

    fn ground(&self, layers: &Layers) -> Group {
        let [seen, unseen, other] = palette::BETWEEN;
        let (lit, dark) = self.scene.cells.split_at(self.scene.seen);
        let ground = layers.ground(|cell| {
            if lit.contains(&cell) {
                seen
            } else if dark.contains(&cell) {
                unseen
            } else {
                other
            }
        });
        let [a, b] = self.explained.asked.map(|place| place.cell);
        let [first, last] = palette::ENDS;
        ground
            .add(layers.cell(b, last).set("fill-opacity", 0.35))
            .add(layers.cell(a, first).set("fill-opacity", 0.4))
    }

    /// What lies below walls and openings: portals on the way, the bundle of sightlines.
    fn under(&self) -> Group {
        let mut group = Group::new().set("id", "between");
        let ends_of = |&e: &EdgeId| {
            [self.graph.edge(e).origin, self.graph.end(e)].map(|v| self.graph.vertices.approx(v))
        };
        if let Some(bundle) = &self.scene.bundle {
            let mut data = PathData::default();
            data.polygon(&self.on_page(bundle));
            let band = Path::new().set("d", data.0).set("fill", palette::SIGHT);
            group = group.add(band.set("fill-opacity", 0.22));
        }
        for ends in self.scene.blocking.iter().map(ends_of) {
            let line = self.line(&ends, palette::BOUND[0], self.thick.max(1.8) * 3.0);
            group = group.add(line.set("stroke-opacity", 0.6));
        }
        for ends in self.scene.portals.iter().map(ends_of) {
            let line = self.line(&ends, palette::PASSED, self.thick.max(1.4));
            group = group.add(line.set("stroke-opacity", 0.8));
        }
        group
    }

    /// What lies above walls.
    fn over(&self) -> Group {
        let mut group = Group::new().set("id", "sight");
        if let Some(straight) = &self.explained.straight {
            group = self.add_straight(group, straight);
        }
        match &self.explained.explanation {
            Explanation::Visible(view) => {
                let ends = [&view.segment.from, &view.segment.to].map(|p| p.approx());
                group = group.add(self.line(&ends, palette::SIGHT, 1.8));
                for end in ends {
                    group = group.add(self.dot(end, 3.4, palette::SIGHT));
                }
                for gap in &self.scene.gaps {
                    let line = self.line(gap, palette::SIGHT, 1.0);
                    group = group.add(line.set("stroke-dasharray", "1.5 3"));
                }
            }
            Explanation::Hidden(hidden) => group = self.add_hidden(group, hidden),
            Explanation::Same | Explanation::Apart => {}
        }
        for (ends, colour) in self.scene.bounds.iter().zip(palette::BOUND) {
            if let [_, _, ..] = ends[..] {
                // What the line would have to leave on this side, all of it.
                let mut data = PathData::default();
                data.polygon(&self.on_page(ends));
                let hull = Path::new().set("d", data.0).set("fill", colour);
                group = group.add(
                    hull.set("fill-opacity", 0.12)
                        .set("stroke", colour)
                        .set("stroke-width", 1.2)
                        .set("stroke-dasharray", "4 3"),
                );
            }
            for &end in ends {
                group = group.add(self.dot(end, 4.8, colour));
            }
        }
        group
    }

    /// The straight line between the two points, as far as it gets.
    fn add_straight(&self, group: Group, straight: &Straight) -> Group {
        let [from, to] = self.scene.ends;
        match *straight {
            Straight::Free => {
                let line = self.line(&[from, to], palette::WALL, 1.1);
                group.add(line.set("stroke-dasharray", "6 4"))
            }
            Straight::Touches { at, .. } | Straight::Blocked { at, .. } => {
                let line = self.line(&[from, at], palette::WALL, 1.1);
                let rest = self.line(&[at, to], palette::WALL, 0.8);
                let group = group
                    .add(line.set("stroke-dasharray", "6 4"))
                    .add(rest.set("stroke-dasharray", "1 5"));
                self.add_cross(group, at, palette::WALL)
            }
        }
    }

    fn add_hidden(&self, group: Group, hidden: &Hidden) -> Group {
        let mut group = group.add(
            self.line(&self.scene.way, palette::WAY, 1.6)
                .set("stroke-dasharray", "7 4"),
        );
        if let Some(&stop) = hidden.way.portals.get(hidden.stop) {
            let ends = [self.graph.edge(stop).origin, self.graph.end(stop)];
            let ends = ends.map(|v| self.graph.vertices.approx(v));
            group = group.add(self.line(&ends, palette::BOUND[0], self.thick.max(1.8) * 1.4));
        }
        if let Some(line @ [from, _, end]) = self.scene.farthest {
            group = group
                .add(self.line(&line, palette::SIGHT, 1.6))
                .add(self.dot(from, 3.0, palette::SIGHT));
            group = self.add_cross(group, end, palette::SIGHT);
        }
        let way = &self.scene.way;
        for &bend in &way[1..way.len().max(2) - 1] {
            group = group.add(self.dot(bend, 3.0, palette::WAY));
        }
        group
    }

    fn add_cross(&self, group: Group, at: DVec2, colour: &str) -> Group {
        const ARM: f64 = 4.5;
        let at = self.sheet.at(at);
        let mut data = PathData::default();
        for arm in [DVec2::splat(ARM), DVec2::new(ARM, -ARM)] {
            data.segment(at - arm, at + arm);
        }
        let cross = Path::new().set("d", data.0).set("fill", "none");
        group.add(cross.set("stroke", colour).set("stroke-width", 2.2))
    }

    /// The border of a part of the plan.
    fn frame(&self) -> Group {
        let group = Group::new().set("id", "frame");
        if !self.sheet.is_part(self.graph) {
            return group;
        }
        let frame = framed(self.sheet).set("fill", "none");
        group.add(frame.set("stroke", "#b9bec6").set("stroke-width", 1.0))
    }

    /// Lines on which no name should stand.
    fn lines(&self) -> Vec<[DVec2; 2]> {
        let scene = self.scene;
        let mut broken: Vec<Vec<DVec2>> = vec![scene.way.clone()];
        broken.extend(scene.farthest.iter().map(|line| line.to_vec()));
        if let Explanation::Visible(view) = &self.explained.explanation {
            broken.push(
                [&view.segment.from, &view.segment.to]
                    .map(|p| p.approx())
                    .into(),
            );
        }
        if let Some(bundle) = scene.bundle {
            broken.push(bundle.into());
        }
        if self.explained.straight.is_some() {
            broken.push(scene.ends.into());
        }
        let mut lines: Vec<[DVec2; 2]> = Vec::new();
        for line in broken {
            lines.extend(
                self.on_page(&line)
                    .windows(2)
                    .map(|pair| [pair[0], pair[1]]),
            );
        }
        for [place, badge] in self.badge_places() {
            // A cross as large as the badge.
            for arm in [DVec2::new(RADIUS, 0.0), DVec2::new(0.0, RADIUS)] {
                lines.push([badge - arm, badge + arm]);
            }
            lines.push([place, badge]);
        }
        lines
    }

    /// Where the two places are on the page, and where their badges.
    fn badge_places(&self) -> [[DVec2; 2]; 2] {
        let [a, b] = self.scene.ends.map(|p| self.sheet.at(p));
        let apart = (a - b).try_normalize().unwrap_or(DVec2::X) * 20.0;
        [[a, a + apart], [b, b - apart]]
    }

    /// A and B, beside the two places.
    fn badges(&self) -> Group {
        let mut group = Group::new()
            .set("id", "badges")
            .set("text-anchor", "middle");
        for (i, [place, badge]) in self.badge_places().into_iter().enumerate() {
            let colour = palette::ENDS[i];
            let mut data = PathData::default();
            data.segment(place, badge);
            let leader = Path::new().set("d", data.0).set("stroke", colour);
            let spot = self.dot(self.scene.ends[i], 3.4, colour);
            let circle = Circle::new()
                .set("cx", short(badge.x))
                .set("cy", short(badge.y))
                .set("r", RADIUS)
                .set("fill", colour)
                .set("stroke", "white")
                .set("stroke-width", 1.4);
            let letter = text(["A", "B"][i], badge.x, badge.y + 4.6, 13.0);
            group = group
                .add(leader.set("stroke-width", 1.4))
                .add(spot)
                .add(circle)
                .add(letter.set("fill", "white"));
        }
        group
    }

    fn title(&self, level: &Level) -> Group {
        let [a, b] = self
            .explained
            .asked
            .map(|p| format!("cell {}{}", p.cell.0, in_sector(level, self.graph, p.cell)));
        let answer = match &self.explained.explanation {
            Explanation::Same => format!("A and B lie in one cell: {a}"),
            Explanation::Visible(view) => match view.space {
                None => format!("A, {a}, sees B, {b}"),
                Some(Space::Seen(_)) => {
                    format!("A, {a}, sees B, {b}, above floors and below ceilings")
                }
                Some(Space::Blocked(_)) => {
                    format!("Floors and ceilings hide A, {a}, from B, {b}; on the plan it is seen")
                }
                Some(Space::Undecided) => {
                    format!(
                        "On the plan A, {a}, sees B, {b}; whether it does in space is not known"
                    )
                }
            },
            Explanation::Hidden(_) => format!("A, {a}, does not see B, {b}"),
            Explanation::Apart => format!("No way leads from A, {a}, to B, {b}"),
        };
        let how = self.graph.options.subdivision.as_str();
        let doors = self.graph.options.doors.as_str();
        let about = format!("{answer} ({how}, doors {doors})");
        Group::new()
            .set("id", "title")
            .add(text(&level.name, self.sheet.side, 44.0, 25.0))
            .add(text(&about, self.sheet.side, 66.0, 14.0))
    }

    fn legend(&self) -> Vec<Item> {
        let stroke = |colour, width, dashes| Swatch::Stroke {
            colour,
            width,
            dashes,
            inner: false,
        };
        let [a, b] = palette::ENDS;
        let [seen, unseen, _] = palette::BETWEEN;
        let [left, right] = palette::BOUND;
        let mut items = vec![("A", Swatch::Area(a)), ("B", Swatch::Area(b))];
        match &self.explained.explanation {
            Explanation::Same | Explanation::Apart => {}
            Explanation::Visible(_) => items.extend([
                ("cells between", Swatch::Area(seen)),
                ("portals passed", stroke(palette::PASSED, 2.0, "")),
                ("sightline", stroke(palette::SIGHT, 1.8, "")),
                ("sightlines beside it", Swatch::Area("#c9e3d5")),
                ("nearest on its left", Swatch::Dot(left)),
                ("nearest on its right", Swatch::Dot(right)),
            ]),
            Explanation::Hidden(_) => items.extend([
                ("cells on the way: seen from A", Swatch::Area(seen)),
                ("not seen", Swatch::Area(unseen)),
                ("shortest way", stroke(palette::WAY, 1.6, "7 4")),
                ("sight ends at this portal", stroke(left, 3.0, "")),
                ("farthest sight on the way", stroke(palette::SIGHT, 1.6, "")),
                ("no line leaves these on its left …", Swatch::Dot(left)),
                ("… and these on its right", Swatch::Dot(right)),
            ]),
        }
        if !self.scene.blocking.is_empty() {
            items.push(("openings that block it", stroke(left, 4.0, "")));
        }
        if self.explained.straight.is_some() {
            items.push(("straight from A to B", stroke(palette::WALL, 1.1, "6 4")));
        }
        items
    }
}
