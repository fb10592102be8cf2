//! Why two places see each other, or why not, with everything named: rooms, doors, wall ends.
//!
//! In: a level, its cells and PVS, two cells or points in them. Out: an [`Account`], of which [`text`]
//! makes a few lines for people and serde the JSON of `explain --json`. All coordinates and lengths
//! are in the level's own unit.
//!
//! # The JSON
//! One object, UTF-8. Further keys may be added; what does not apply is null.
//!
//! | key | what |
//! |---|---|
//! | `format`, `version` | `"enfilade.explanation"`, 1 |
//! | `level` | `name`, `source`, `unit` |
//! | `subdivision`, `doors` | as in the JSON of `build` |
//! | `from`, `to` | `cell`, `sector`, `room` (its name); `point` if one was given, and `beside`, another cell on whose border it lies |
//! | `heights` | whether floors and ceilings count |
//! | `visible` | whether some straight line from inside the one cell to inside the other is free |
//! | `straight` | of two points: `free`; otherwise `point` where the line between them first meets a wall, that `wall`, and `touches`: whether it only touches walls |
//! | `view` | of visible cells: see below |
//! | `way` | of hidden cells that are connected: see below |
//! | `connected` | whether any way leads from the one to the other |
//! | `doors_open` | with closed doors, of hidden cells: `visible`, `connected`, and the closed `doors` on the sightline or way that there is when they are open |
//!
//! A **view** has the `segment` of a sightline in its middle, with its `length`, and `exact`: whether
//! these very numbers were checked, and not others too close to them for f64; the `width` of the
//! widest strip of parallel sightlines around it; `widest`: whether the search for a chain of portals
//! that lets a wider one through came to its end; the ends that bound it on its `left` and `right`;
//! where those are only corners of the two cells, the nearest `end` of a wall on that side and its
//! `distance` from the strip (`beside_left`, `beside_right`); and the `cells` and `portals` that the
//! sightline crosses. All this is on the plan. With heights, `space` has the `answer` (`visible`,
//! `hidden`, or `undecided`, which counts as visible), a `segment` in space and the `portals` that it
//! passes; or the openings that hide the one cell from the other (`blocked_by`, at most three; none
//! if they are different ones for different lines).
//!
//! A **way** is the shortest: its `points` and `length`, the `bends` about which it turns, its `cells`
//! and `portals`; `stop`, the position in `portals` of the first one behind which nothing is seen from
//! the first cell; `left` and `right`, the ends that a line along the way would have to leave on that
//! side, and cannot; and `farthest`: a sightline to the last cell on the way that is seen, prolonged
//! to the `point` where it meets a `wall`.
//!
//! A **portal** has its `kind` (`door`, `window`, `archway`, `sector edge`, or `border` where only the
//! subdivision cut), the opening's `name`, the `wall` that it is cut into or consists of, its `cells`,
//! their `rooms`, its `opening` in z (all that moves out of the way), its `segment`, and the `point` where it is crossed. An **end** has its `point`, its
//! `kind` (`corner`, `wall`, or `cell corner` where no wall stands), the `walls` there, and the
//! `opening` that ends there, if one does. A **wall** has its `place` in the source, its ends
//! `from` and `to`, and the `room` of whose outline it is a part.

pub mod asked;
mod names;
pub mod text;

use glam::DVec2;
use serde::Serialize;

use self::names::Names;
pub use self::names::{EndRecord, PortalRecord, WallRecord};
use crate::cells::{CellGraph, CellId, Doors, EdgeId, Locator, Options, subdivide};
use crate::geom::GridPoint;
use crate::level::Level;
use crate::pvs::explain::{
    self, Beside, ExplainOptions, Explanation, Hidden, Segment, Space, Straight, View,
};
use crate::pvs::sweep::sweep;
use crate::pvs::{Progress, Pvs};

/// One of the two places that are asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Its cell.
    pub cell: CellId,
    /// The point, if one was given.
    pub point: Option<GridPoint>,
    /// Another cell on whose border the point lies as well.
    pub beside: Option<CellId>,
}

/// An explanation with what the picture of it needs.
#[derive(Clone, Debug)]
pub struct Explained {
    /// The two places.
    pub asked: [Asked; 2],
    /// Why.
    pub explanation: Explanation,
    /// What stands on the straight line between the two points.
    pub straight: Option<Straight>,
    /// Of hidden cells: the view to the last cell on the way that is seen.
    pub farthest: Option<View>,
    /// Whether floors and ceilings counted.
    pub heights: bool,
}

/// Explains what the exact `pvs` says of two places; the options' points are the places' own. `None`
/// only if `pvs` is not the graph's.
pub fn explain(
    graph: &CellGraph,
    pvs: &Pvs,
    asked: [Asked; 2],
    options: &ExplainOptions,
) -> Option<Explained> {
    let [a, b] = asked.map(|place| place.cell);
    let at = |place: Asked| match place.point {
        Some(p) => DVec2::new(p.x as f64, p.y as f64),
        None => explain::middle(graph, place.cell),
    };
    let options = ExplainOptions {
        points: Some(asked.map(at)),
        ..*options
    };
    let explanation = explain::explain(graph, pvs, a, b, &options)?;
    let straight = match asked.map(|place| place.point) {
        [Some(p), Some(q)] => Some(explain::straight(graph, p, q)),
        _ => None,
    };
    let farthest = match &explanation {
        Explanation::Hidden(hidden) => {
            let seen = explain::last_cell(graph, a, &hidden.way.portals[..hidden.stop]);
            let on_plan = ExplainOptions {
                heights: None,
                points: None,
                ..options
            };
            match explain::explain(graph, pvs, a, seen, &on_plan)? {
                Explanation::Visible(view) => Some(view),
                _ => None,
            }
        }
        _ => None,
    };
    Some(Explained {
        asked,
        explanation,
        straight,
        farthest,
        heights: options.heights.is_some(),
    })
}

/// An explanation in the level's own terms.
#[derive(Clone, Debug, Serialize)]
pub struct Account {
    format: &'static str,
    version: u32,
    level: LevelRecord,
    subdivision: &'static str,
    doors: &'static str,
    heights: bool,
    from: PlaceRecord,
    to: PlaceRecord,
    /// Whether the two cells see each other.
    pub visible: bool,
    straight: Option<StraightRecord>,
    view: Option<ViewRecord>,
    way: Option<WayRecord>,
    connected: bool,
    /// What would be if all doors were open.
    pub doors_open: Option<OpenRecord>,
}

#[derive(Clone, Debug, Serialize)]
struct LevelRecord {
    name: String,
    source: String,
    unit: String,
}

#[derive(Clone, Debug, Serialize)]
struct PlaceRecord {
    cell: u32,
    sector: Option<u32>,
    room: Option<String>,
    point: Option<[f64; 2]>,
    beside: Option<u32>,
}

#[derive(Clone, Debug, Serialize)]
struct StraightRecord {
    free: bool,
    touches: bool,
    point: Option<[f64; 2]>,
    wall: Option<WallRecord>,
}

#[derive(Clone, Debug, Serialize)]
struct ViewRecord {
    segment: [[f64; 2]; 2],
    exact: bool,
    length: f64,
    width: f64,
    widest: bool,
    left: Vec<EndRecord>,
    right: Vec<EndRecord>,
    beside_left: Option<BesideRecord>,
    beside_right: Option<BesideRecord>,
    cells: Vec<u32>,
    portals: Vec<PortalRecord>,
    space: Option<SpaceRecord>,
}

#[derive(Clone, Debug, Serialize)]
struct SpaceRecord {
    answer: &'static str,
    segment: Option<[[f64; 3]; 2]>,
    portals: Vec<PortalRecord>,
    blocked_by: Vec<PortalRecord>,
}

#[derive(Clone, Debug, Serialize)]
struct BesideRecord {
    distance: f64,
    end: EndRecord,
}

#[derive(Clone, Debug, Serialize)]
struct WayRecord {
    length: f64,
    points: Vec<[f64; 2]>,
    bends: Vec<EndRecord>,
    cells: Vec<u32>,
    portals: Vec<PortalRecord>,
    stop: usize,
    left: Vec<EndRecord>,
    right: Vec<EndRecord>,
    farthest: Option<FarthestRecord>,
}

#[derive(Clone, Debug, Serialize)]
struct FarthestRecord {
    segment: [[f64; 2]; 2],
    point: [f64; 2],
    wall: WallRecord,
}

/// What would be if all doors were open.
#[derive(Clone, Debug, Serialize)]
pub struct OpenRecord {
    visible: bool,
    connected: bool,
    doors: Vec<PortalRecord>,
}

impl Account {
    /// Puts names to an explanation.
    pub fn of(level: &Level, graph: &CellGraph, explained: &Explained) -> Account {
        let names = Names { level, graph };
        let place = |asked: &Asked| PlaceRecord {
            cell: asked.cell.0,
            sector: graph.cell(asked.cell).sector.map(|s| s.0),
            room: names.room(asked.cell),
            point: asked.point.map(|p| graph.grid.to_level(p).to_array()),
            beside: asked.beside.map(|c| c.0),
        };
        let [from, to] = explained.asked.each_ref().map(place);
        let start = explained.asked[0].cell;
        let (connected, view, way) = match &explained.explanation {
            Explanation::Same => (true, None, None),
            Explanation::Visible(view) => (true, Some(names.view(start, view)), None),
            Explanation::Hidden(hidden) => {
                let farthest = explained.farthest.as_ref();
                (true, None, Some(names.way(start, hidden, farthest)))
            }
            Explanation::Apart => (false, None, None),
        };
        Account {
            format: "enfilade.explanation",
            version: 1,
            level: LevelRecord {
                name: level.name.clone(),
                source: level.source.clone(),
                unit: level.unit.clone(),
            },
            subdivision: graph.options.subdivision.as_str(),
            doors: graph.options.doors.as_str(),
            heights: explained.heights,
            from,
            to,
            visible: explained.explanation.sees(),
            straight: explained.straight.map(|s| names.straight(&s)),
            view,
            way,
            connected,
            doors_open: None,
        }
    }
}

/// What would be if all doors were open: the same two places, in a graph of the level in which they
/// are. `None` where one of them has no point, and its cell no grid point in its middle.
pub fn with_open_doors(
    level: &Level,
    graph: &CellGraph,
    asked: [Asked; 2],
    options: &ExplainOptions,
) -> Option<OpenRecord> {
    let doors_open = Options {
        doors: Doors::Open,
        ..graph.options
    };
    let open = subdivide(level, &doors_open);
    let pvs = sweep(&open, &Progress::default());
    let locator = Locator::new(&open);
    let mut cells = [Vec::new(), Vec::new()];
    let mut points = [None; 2];
    for (i, place) in asked.into_iter().enumerate() {
        let point = place
            .point
            .or_else(|| explain::point_inside(graph, place.cell))?;
        cells[i] = locator.cells_at(&open, &point.into());
        points[i] = Some(point);
    }
    let [a, b] = asked::choose(&pvs, &cells[0], &cells[1])?;
    let asked = [Asked::new(a, points[0], &[]), Asked::new(b, points[1], &[])];
    let explained = explain(&open, &pvs, asked, options)?;
    Some(OpenRecord::of(level, &open, &explained))
}

impl OpenRecord {
    /// Of an explanation in a graph of the same level in which doors are open.
    fn of(level: &Level, graph: &CellGraph, explained: &Explained) -> OpenRecord {
        let names = Names { level, graph };
        let (connected, portals) = match &explained.explanation {
            Explanation::Same => (true, &[][..]),
            Explanation::Visible(view) => (true, &view.portals[..]),
            Explanation::Hidden(hidden) => (true, &hidden.way.portals[..]),
            Explanation::Apart => (false, &[][..]),
        };
        let doors = portals.iter().filter(|&&e| names.is_shut(e));
        OpenRecord {
            visible: explained.explanation.sees(),
            connected,
            doors: doors.map(|&e| names.portal(e, None)).collect(),
        }
    }
}

impl Names<'_> {
    fn view(&self, start: CellId, view: &View) -> ViewRecord {
        let ends = [&view.segment.from, &view.segment.to];
        let line = ends.map(|p| p.approx());
        ViewRecord {
            segment: line.map(|p| self.at(p)),
            exact: is_exact(self.graph, &view.segment),
            length: self.length(view.segment.length()),
            width: self.length(view.strip.width),
            widest: view.complete,
            left: self.ends(&view.strip.left),
            right: self.ends(&view.strip.right),
            beside_left: self.beside(view.beside[0].as_ref()),
            beside_right: self.beside(view.beside[1].as_ref()),
            cells: self.cells(start, &view.portals),
            portals: self.portals(&view.portals, &line),
            space: view.space.as_ref().map(|s| self.space(s)),
        }
    }

    fn space(&self, space: &Space) -> SpaceRecord {
        let mut record = SpaceRecord {
            answer: "undecided",
            segment: None,
            portals: Vec::new(),
            blocked_by: Vec::new(),
        };
        match space {
            Space::Seen(passage) => {
                record.answer = "visible";
                record.segment = passage.segment.map(|ends| {
                    ends.map(|p| {
                        let [x, y] = self.at(p.truncate());
                        [x, y, p.z]
                    })
                });
                let line = passage.segment.map(|ends| ends.map(|p| p.truncate()));
                record.portals = self.portals(&passage.chain, line.as_ref().map_or(&[], |l| l));
            }
            Space::Blocked(openings) => {
                record.answer = "hidden";
                record.blocked_by = openings.iter().map(|&e| self.portal(e, None)).collect();
            }
            Space::Undecided => {}
        }
        record
    }

    fn beside(&self, beside: Option<&Beside>) -> Option<BesideRecord> {
        let beside = beside?;
        Some(BesideRecord {
            distance: self.length(beside.distance),
            end: match beside.end {
                Some(vertex) => self.end(vertex),
                None => self.part_of(beside.wall, beside.at),
            },
        })
    }

    fn way(&self, start: CellId, hidden: &Hidden, farthest: Option<&View>) -> WayRecord {
        let way = &hidden.way;
        WayRecord {
            length: self.length(way.length),
            points: way.points.iter().map(|&p| self.at(p)).collect(),
            bends: self.ends(&way.bends),
            cells: self.cells(start, &way.portals),
            portals: self.portals(&way.portals, &way.points),
            stop: hidden.stop,
            left: self.ends(&hidden.ends.left),
            right: self.ends(&hidden.ends.right),
            farthest: farthest.and_then(|view| {
                let (wall, point) = prolonged(self.graph, view)?;
                Some(FarthestRecord {
                    segment: [&view.segment.from, &view.segment.to].map(|p| self.at(p.approx())),
                    point: self.at(point),
                    wall: self.wall(wall)?,
                })
            }),
        }
    }

    fn straight(&self, straight: &Straight) -> StraightRecord {
        let (touches, met) = match *straight {
            Straight::Free => (false, None),
            Straight::Touches { wall, at } => (true, Some((wall, at))),
            Straight::Blocked { wall, at } => (false, Some((wall, at))),
        };
        StraightRecord {
            free: met.is_none(),
            touches,
            point: met.map(|(_, at)| self.at(at)),
            wall: met.and_then(|(wall, _)| self.wall(wall)),
        }
    }

    fn cells(&self, start: CellId, portals: &[EdgeId]) -> Vec<u32> {
        (0..=portals.len())
            .map(|n| explain::last_cell(self.graph, start, &portals[..n]).0)
            .collect()
    }
}

/// Whether a segment's ends, as numbers in the level's unit, are the very points that were checked.
fn is_exact(graph: &CellGraph, segment: &Segment) -> bool {
    [&segment.from, &segment.to]
        .iter()
        .all(|p| p.grid().is_some() || p.survives(&graph.grid))
}

/// Where a view's sightline, prolonged, meets a wall: the wall, and the place in grid steps. In f64.
pub fn prolonged(graph: &CellGraph, view: &View) -> Option<(EdgeId, DVec2)> {
    let (from, to) = (view.segment.from.approx(), view.segment.to.approx());
    let course = (to - from).try_normalize()?;
    let mut cell = view.portals.last().map(|&e| graph.edge(e).twin())??;
    // Every cell but the last is left through a portal, and none is entered twice.
    for _ in 0..graph.cells.len() {
        let edges = graph.edge_range(graph.edge(cell).cell).map(EdgeId);
        let met = edges.filter_map(|e| {
            let [p, q] = [graph.edge(e).origin, graph.end(e)].map(|v| graph.vertices.approx(v));
            // Out of a counterclockwise cell: with the edge's right side ahead.
            let speed = (q - p).perp_dot(course);
            (speed < 0.0).then(|| ((q - p).perp_dot(p - from) / speed, e))
        });
        let (distance, exit) = met.min_by(|a, b| a.0.total_cmp(&b.0))?;
        match graph.edge(exit).twin() {
            Some(twin) => cell = twin,
            None => return Some((exit, from + course * distance)),
        }
    }
    None
}
