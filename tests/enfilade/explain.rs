//! Explanations of what is seen and what is not: by hand, against all chains, against the walls.

use std::path::Path;
use std::time::Instant;

use dashu_int::IBig;
use enfilade::cells::{CellGraph, CellId, Doors, EdgeId, Locator, Options, Subdivision, subdivide};
use enfilade::geom::GridPoint;
use enfilade::level::{Level, doom, snap, toml, wad::Wad};
use enfilade::pvs::explain::{
    self, ExplainOptions, Explanation, Hidden, Point, Segment, Straight, View, corner_at, gates,
};
use enfilade::pvs::heights::HeightsOptions;
use enfilade::pvs::{Progress, Pvs, sweep::sweep};
use enfilade::report::explain::{Account, Asked, text};
use enfilade::sight::{Chain, Gate};
use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::{Value, json};

use crate::plan::{Ink, Stroke, level as level_of, rectangle};
use crate::sightline::{Act, act};

/// A level with cells and PVS.
struct World {
    level: Level,
    graph: CellGraph,
    pvs: Pvs,
}

impl World {
    fn new(level: Level, options: &Options) -> Self {
        let graph = subdivide(&level, options);
        let pvs = sweep(&graph, &Progress::default());
        Self { level, graph, pvs }
    }

    fn of_toml(text: &str) -> Self {
        Self::new(
            toml::read(text, "rooms.toml").expect("the level is right"),
            &Options::default(),
        )
    }

    fn point(&self, x: f64, y: f64) -> GridPoint {
        let point = self.graph.grid.nearest(DVec2::new(x, y));
        point.expect("it is on the grid")
    }

    fn cell(&self, x: f64, y: f64) -> CellId {
        let locator = Locator::new(&self.graph);
        let cell = locator.cell_at(&self.graph, self.point(x, y));
        cell.expect("it is inside")
    }

    fn explain(&self, a: CellId, b: CellId) -> Explanation {
        explain::explain(&self.graph, &self.pvs, a, b, &ExplainOptions::default())
            .expect("the PVS is the graph's own")
    }

    fn account(&self, from: [f64; 2], to: [f64; 2]) -> Account {
        let asked = [from, to].map(|[x, y]| {
            let point = Some(self.point(x, y));
            Asked::new(self.cell(x, y), point, &[])
        });
        let explained = enfilade::report::explain::explain(
            &self.graph,
            &self.pvs,
            asked,
            &ExplainOptions::default(),
        );
        let explained = explained.expect("the PVS is the graph's own");
        Account::of(&self.level, &self.graph, &explained)
    }

    fn at(&self, v: enfilade::geom::VertexId) -> [f64; 2] {
        let at = self.graph.vertices.exact(v).to_level(&self.graph.grid);
        at.to_array()
    }
}

fn view(explanation: Explanation) -> View {
    match explanation {
        Explanation::Visible(view) => view,
        other => panic!("not visible: {other:?}"),
    }
}

fn hidden(explanation: Explanation) -> Hidden {
    match explanation {
        Explanation::Hidden(hidden) => hidden,
        other => panic!("not hidden: {other:?}"),
    }
}

const TWO_ROOMS: &str = "[[room]]\nname = \"Hall\"\nrect = [0, 0, 6, 4]\n\
    [[room]]\nname = \"Kitchen\"\nrect = [6, 0, 10, 4]\n\
    [[door]]\nname = \"Low door\"\nbetween = [\"Hall\", \"Kitchen\"]\nwidth = 0.9\n";

#[test]
fn two_rooms_see_each_other_through_the_whole_door() {
    let world = World::of_toml(TWO_ROOMS);
    let (hall, kitchen) = (world.cell(1.0, 1.0), world.cell(8.0, 3.0));
    let view = view(world.explain(hall, kitchen));
    let step = world.graph.grid.step.length();
    assert_eq!(view.portals.len(), 1);
    assert!((view.strip.width * step - 0.9).abs() < 1e-12);
    assert_eq!(view.strip.width, view.slack);
    assert!(view.complete);
    // Straight through, half of either room.
    let ends = [&view.segment.from, &view.segment.to].map(|p| {
        let p = p.grid().expect("whole steps will do");
        world.graph.grid.to_level(p).to_array()
    });
    assert_eq!(ends, [[3.0, 2.0], [8.0, 2.0]]);
    // Going east, north is on the left.
    assert_eq!(
        view.strip
            .left
            .iter()
            .map(|&v| world.at(v))
            .collect::<Vec<_>>(),
        [[6.0, 2.45]]
    );
    assert_eq!(
        view.strip
            .right
            .iter()
            .map(|&v| world.at(v))
            .collect::<Vec<_>>(),
        [[6.0, 1.55]]
    );
    assert_eq!(view.beside, [None, None]);
}

/// A corridor that turns twice: the room at its start does not see the one at its end.
const TURNS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
    [[room]]\nname = \"Corridor\"\noutline = [[4, 0], [10, 0], [10, 10], [8, 10], [8, 2], [4, 2]]\n\
    [[room]]\nname = \"B\"\nrect = [4, 8, 8, 12]\n\
    [[door]]\npoints = [[4, 0.5], [4, 1.5]]\n\
    [[door]]\nname = \"Last\"\npoints = [[8, 8.5], [8, 9.5]]\n";

#[test]
fn around_two_corners_nothing_is_seen() {
    let world = World::of_toml(TURNS);
    let (a, b) = (world.cell(1.0, 1.0), world.cell(6.0, 11.0));
    let middles = [[2.0, 2.0], [6.0, 10.0]].map(|[x, y]| {
        let p = world.point(x, y);
        DVec2::new(p.x as f64, p.y as f64)
    });
    let options = ExplainOptions {
        points: Some(middles),
        ..ExplainOptions::default()
    };
    let explanation = explain::explain(&world.graph, &world.pvs, a, b, &options);
    let hidden = hidden(explanation.expect("the PVS is the graph's own"));
    let bends: Vec<[f64; 2]> = hidden.way.bends.iter().map(|&v| world.at(v)).collect();
    assert_eq!(bends, [[4.0, 1.5], [8.0, 2.0], [8.0, 8.5]]);
    // From the middle of A, (2, 2), and to that of B, (6, 10).
    let length = [[2.0, 2.0], [4.0, 1.5], [8.0, 2.0], [8.0, 8.5], [6.0, 10.0]];
    let length: f64 = length
        .windows(2)
        .map(|p| DVec2::from(p[0]).distance(DVec2::from(p[1])))
        .sum();
    let step = world.graph.grid.step.length();
    assert!((hidden.way.length * step - length).abs() < 1e-9);
    let chain = gates(&world.graph, &hidden.way.portals);
    assert!(hidden.ends.holds(&world.graph.vertices, &chain));
    // All of the ends are walls.
    for v in hidden.ends.left.iter().chain(&hidden.ends.right) {
        assert!(corners(&world.graph, *v).contains(&explain::Corner::Jutting));
    }
}

fn corners(graph: &CellGraph, v: enfilade::geom::VertexId) -> Vec<explain::Corner> {
    let edges = explain::edges_at(graph, v).into_iter();
    edges.map(|e| corner_at(graph, e)).collect()
}

#[test]
fn one_cell_neighbours_and_places_apart() {
    let text = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n[[archway]]\nbetween = [\"A\", \"B\"]\n\
        [[room]]\nname = \"C\"\nrect = [9, 0, 12, 4]\n\
        [[room]]\nname = \"D\"\nrect = [12, 0, 15, 4]\n[[door]]\nbetween = [\"C\", \"D\"]\nwidth = 1\n";
    let world = World::of_toml(text);
    let [a, b, c] = [1.0, 5.0, 10.0].map(|x| world.cell(x, 1.0));
    assert_eq!(world.explain(a, a), Explanation::Same);
    let neighbours = view(world.explain(a, b));
    let step = world.graph.grid.step.length();
    // As wide as the cells themselves, and bounded by the walls at their sides.
    assert!((neighbours.strip.width * step - 4.0).abs() < 1e-12);
    assert_eq!(world.explain(b, c), Explanation::Apart);
    // Closed, the door is a wall; open, they see each other through it.
    let options = Options {
        doors: Doors::Closed,
        ..Options::default()
    };
    let closed = World::new(world.level.clone(), &options);
    let [c, d] = [10.0, 14.0].map(|x| closed.cell(x, 1.0));
    assert_eq!(closed.explain(c, d), Explanation::Apart);
    let asked =
        [(c, 10.0), (d, 14.0)].map(|(cell, x)| Asked::new(cell, Some(closed.point(x, 1.0)), &[]));
    let open = enfilade::report::explain::with_open_doors(
        &closed.level,
        &closed.graph,
        asked,
        &ExplainOptions::default(),
    );
    let open = serde_json::to_value(open.expect("there are points")).expect("it is plain");
    assert_eq!(open["visible"], true);
    assert_eq!(open["doors"].as_array().map(Vec::len), Some(1));
    assert_eq!(open["doors"][0]["kind"], "door");
}

#[test]
fn what_stands_straight_between_two_points() {
    let world = World::of_toml(TWO_ROOMS);
    let straight = |p: [f64; 2], q: [f64; 2]| {
        let [p, q] = [p, q].map(|[x, y]| world.point(x, y));
        explain::straight(&world.graph, p, q)
    };
    assert_eq!(straight([1.0, 2.0], [8.0, 2.0]), Straight::Free);
    match straight([1.0, 1.0], [8.0, 1.0]) {
        Straight::Blocked { wall, at } => {
            let at = world.graph.grid.offset_to_level(at.x, at.y);
            assert!(at.distance(DVec2::new(6.0, 1.0)) < 1e-9);
            assert_eq!(world.graph.edge(wall).twin(), None);
        }
        other => panic!("{other:?}"),
    }
    // Along the jamb's point (6, 2.45) exactly.
    let touching = straight([5.0, 2.45], [7.0, 2.45]);
    assert!(matches!(touching, Straight::Touches { .. }), "{touching:?}");
}

#[test]
fn the_account_of_two_rooms_in_full() {
    let world = World::of_toml(TWO_ROOMS);
    let account = world.account([1.0, 1.0], [8.0, 3.0]);
    let value = serde_json::to_value(&account).expect("it is plain");
    let wall = |line: u32, column: u32, from: [f64; 2], to: [f64; 2], room: Value| json!({ "place": { "line": line, "column": column }, "from": from, "to": to, "room": room });
    let door = json!({
        "kind": "door", "name": "Low door", "place": { "line": 7, "column": 1 },
        "rooms": ["Hall", "Kitchen"],
    });
    let end = |y: f64, walls: Value| json!({ "point": [6.0, y], "kind": "corner", "walls": walls, "opening": door });
    // One wall stands for the two outlines that coincide.
    let walls = json!([wall(3, 8, [6.0, 0.0], [6.0, 4.0], "Hall".into())]);
    let expected = json!({
        "format": "enfilade.explanation", "version": 1,
        "level": { "name": "rooms", "source": "rooms.toml", "unit": "m" },
        "subdivision": "bsp", "doors": "open", "heights": false,
        "from": { "cell": 0, "sector": 0, "room": "Hall", "point": [1.0, 1.0], "beside": null },
        "to": { "cell": 1, "sector": 1, "room": "Kitchen", "point": [8.0, 3.0], "beside": null },
        "visible": true, "connected": true,
        "straight": { "free": true, "touches": false, "point": null, "wall": null },
        "view": {
            "segment": [[3.0, 2.0], [8.0, 2.0]], "exact": true, "length": 5.0, "width": 0.9,
            "widest": true,
            "left": [end(2.45, walls.clone())], "right": [end(1.55, walls)],
            "beside_left": null, "beside_right": null,
            "cells": [0, 1],
            "portals": [{
                "kind": "door", "name": "Low door", "cells": [0, 1], "rooms": ["Hall", "Kitchen"],
                "wall": wall(7, 1, [6.0, 1.55], [6.0, 2.45], Value::Null),
                "opening": [0.0, 3.0], "segment": [[6.0, 1.55], [6.0, 2.45]], "point": [6.0, 2.0],
            }],
            "space": null,
        },
        "way": null, "doors_open": null,
    });
    assert_eq!(value, expected, "{value:#}");
    let words = text::of(&world.level, &account);
    for part in [
        "Visible",
        "Low door",
        "(3.00, 2.00) to (8.00, 2.00)",
        "0.9 m",
    ] {
        assert!(words.contains(part), "`{part}` is not in:\n{words}");
    }
}

#[test]
fn the_account_of_a_hidden_room() {
    let world = World::of_toml(TURNS);
    let account = world.account([1.0, 1.0], [6.0, 11.0]);
    let value = serde_json::to_value(&account).expect("it is plain");
    assert_eq!(value["visible"], false);
    assert_eq!(value["connected"], true);
    assert_eq!(value["view"], Value::Null);
    let way = &value["way"];
    let stop = way["stop"].as_u64().expect("it is a number") as usize;
    let portals = way["portals"].as_array().expect("it is a list");
    let cells = way["cells"].as_array().expect("it is a list");
    assert_eq!(cells.len(), portals.len() + 1);
    assert_eq!(portals[stop]["cells"][0], cells[stop]);
    let farthest = &way["farthest"];
    assert!(farthest["wall"]["place"]["line"].is_number(), "{way:#}");
    let words = text::of(&world.level, &account);
    for part in [
        "Not visible",
        "Shortest way",
        "\"Last\"",
        "sight ends here",
        "on its left",
    ] {
        assert!(words.contains(part), "`{part}` is not in:\n{words}");
    }
}

/// Walls anywhere in a box, mostly few.
fn random_strokes(random: &mut Pcg64) -> Vec<Stroke> {
    let size = [6, 9, 20][random.random_range(0..3)];
    let inks = [Ink::Solid, Ink::Solid, Ink::Wall, Ink::Line, Ink::Door];
    let mut strokes = rectangle([0, 0], [size, size], Ink::Solid);
    for _ in 0..random.random_range(2..9) {
        let mut point = || [0, 0].map(|_: i64| random.random_range(0..=size));
        let (p, q) = (point(), point());
        strokes.push(Stroke(p, q, inks[random.random_range(0..inks.len())]));
    }
    strokes
}

/// Whether an exact segment touches no wall but where an opening lies; from the walls alone.
fn is_free(level: &Level, segment: &Segment) -> bool {
    let [p, q] = [&segment.from, &segment.to].map(Point::coordinates);
    let side = |[x, y]: [i64; 2]| {
        let (x, y) = (IBig::from(x), IBig::from(y));
        (p[0] * (q[1] - &y * q[2]) - p[1] * (q[0] - &x * q[2]) + p[2] * (&y * q[0] - &x * q[1]))
            .signum()
    };
    let of_wall = |[a, b]: [[i64; 2]; 2], r: [&IBig; 3]| {
        let (dx, dy) = (IBig::from(b[0] - a[0]), IBig::from(b[1] - a[1]));
        (dx * (r[1] - r[2] * IBig::from(a[1])) - dy * (r[0] - r[2] * IBig::from(a[0]))).signum()
    };
    let ends = |w: &enfilade::level::Wall| [w.from, w.to].map(|p| [p.x, p.y]);
    let apart = |s: &IBig, t: &IBig| s == t && *s != IBig::ZERO;
    let touches = |w: &enfilade::level::Wall| {
        let [a, b] = ends(w);
        if side(a) == IBig::ZERO && side(b) == IBig::ZERO {
            // In line: they touch if their extents do.
            let [p, q] = [&segment.from, &segment.to].map(Point::approx);
            let [a, b] = [a, b].map(|[x, y]| DVec2::new(x as f64, y as f64));
            return p.min(q).cmple(a.max(b)).all() && a.min(b).cmple(p.max(q)).all();
        }
        !apart(&side(a), &side(b)) && !apart(&of_wall([a, b], p), &of_wall([a, b], q))
    };
    let within = |w: &enfilade::level::Wall| {
        let [a, b] = ends(w);
        side(a) == -side(b) && side(a) != IBig::ZERO
    };
    level.walls.iter().all(|wall| match act(wall, Doors::Open) {
        Act::Cuts | Act::Lets => true,
        Act::Stops => !touches(wall),
        Act::StopsUnlessCut => {
            let in_line = |hole: &enfilade::level::Wall| {
                let [a, b] = ends(wall);
                ends(hole).iter().all(|&[x, y]| {
                    let (x, y, one) = (IBig::from(x), IBig::from(y), IBig::ONE);
                    of_wall([a, b], [&x, &y, &one]) == IBig::ZERO
                })
            };
            let holes = level
                .walls
                .iter()
                .filter(|w| act(w, Doors::Open) == Act::Cuts);
            !touches(wall) || holes.into_iter().any(|hole| in_line(hole) && within(hole))
        }
    })
}

/// The widest strip through any chain from one cell to another, by trying all.
fn widest_chain(graph: &CellGraph, a: CellId, b: CellId) -> Option<f64> {
    fn go(
        graph: &CellGraph,
        chain: &mut Chain,
        entry: Option<EdgeId>,
        cell: CellId,
        b: CellId,
        best: &mut f64,
    ) {
        if cell == b {
            *best = best.max(chain.slack().map_or(0.0, |s| s.width));
            return;
        }
        for edge in graph
            .edge_range(cell)
            .map(EdgeId)
            .filter(|&e| Some(e) != entry)
        {
            let Some(twin) = graph.edge(edge).twin() else {
                continue;
            };
            let gate = Gate {
                left: graph.end(edge),
                right: graph.edge(edge).origin,
            };
            if chain.push(gate) {
                go(graph, chain, Some(twin), graph.edge(twin).cell, b, best);
                chain.pop();
            }
        }
    }
    let mut best = 0.0;
    go(
        graph,
        &mut Chain::new(&graph.vertices),
        None,
        a,
        b,
        &mut best,
    );
    (best > 0.0).then_some(best)
}

/// The widest bundle of parallel sightlines between two cells, by trying every direction in which it
/// can lie: along or across the way between two vertices. From the walls alone, in f64.
fn widest_bundle(graph: &CellGraph, a: CellId, b: CellId) -> f64 {
    let n = graph.vertices.len() as u32;
    let at = |v: u32| graph.vertices.approx(enfilade::geom::VertexId(v));
    let walls: Vec<[DVec2; 2]> = (0..graph.edges.len() as u32)
        .map(EdgeId)
        .filter(|&e| graph.edge(e).twin().is_none())
        .map(|e| [graph.edge(e).origin, graph.end(e)].map(|v| graph.vertices.approx(v)))
        .collect();
    let corners = |cell: CellId| -> Vec<DVec2> {
        graph
            .polygon(cell)
            .iter()
            .map(|&v| graph.vertices.approx(v))
            .collect()
    };
    let cells = [corners(a), corners(b)];
    let mut best = 0.0f64;
    for i in 0..n {
        for j in 0..n {
            let Some(along) = (at(j) - at(i)).try_normalize().filter(|_| i != j) else {
                continue;
            };
            for direction in [along, along.perp()] {
                let offset = |p: DVec2| direction.perp_dot(p);
                // Where the line at an offset meets a segment, as a distance along it.
                let meet = |p: DVec2, q: DVec2, o: f64| {
                    let (f, g) = (offset(p) - o, offset(q) - o);
                    ((f > 0.0) != (g > 0.0)).then(|| direction.dot(p.lerp(q, f / (f - g))))
                };
                let middle = |cell: &[DVec2], o: f64| {
                    let k = cell.len();
                    let met: Vec<f64> = (0..k)
                        .filter_map(|i| meet(cell[i], cell[(i + 1) % k], o))
                        .collect();
                    (met.len() == 2).then(|| (met[0] + met[1]) / 2.0)
                };
                let between = |o: f64| {
                    let (from, to) = (middle(&cells[0], o)?, middle(&cells[1], o)?);
                    Some([from.min(to), from.max(to)])
                };
                let is_free = |o: f64| {
                    between(o).is_some_and(|[from, to]| {
                        let mut met = walls.iter().filter_map(|&[p, q]| meet(p, q, o));
                        !met.any(|t| from < t && t < to)
                    })
                };
                let mut offsets: Vec<f64> = (0..n).map(|v| offset(at(v))).collect();
                offsets.sort_by(f64::total_cmp);
                let mut start = None;
                for pair in offsets.windows(2) {
                    if pair[1] - pair[0] < 1e-7 {
                        continue;
                    }
                    let o = (pair[0] + pair[1]) / 2.0;
                    if !is_free(o) {
                        start = None;
                        continue;
                    }
                    // Does a wall's end part this gap from the last?
                    let [from, to] = between(o).expect("it is free");
                    let parted = walls.iter().flatten().any(|&p| {
                        let t = direction.dot(p);
                        (offset(p) - pair[0]).abs() < 1e-7 && from < t && t < to
                    });
                    let first = match start {
                        Some(first) if !parted => first,
                        _ => pair[0],
                    };
                    start = Some(first);
                    best = best.max(pair[1] - first);
                }
            }
        }
    }
    best
}

/// What must hold of every view.
fn check_view(world: &World, a: CellId, b: CellId, view: &View) {
    let World { level, graph, .. } = world;
    let crossed = view.segment.portals(graph, a);
    assert_eq!(crossed.as_deref(), Some(&view.portals[..]));
    assert_eq!(explain::last_cell(graph, a, &view.portals), b);
    assert!(is_free(level, &view.segment), "{view:?}");
    assert!(view.strip.width >= view.slack * (1.0 - 1e-12));
    // All of the bundle is free.
    let [left, right, right_end, left_end] = view.outline(graph, a, b);
    for share in [0.0173, 0.2911, 0.4999, 0.7321, 0.9837] {
        let line = Segment {
            from: Point::rounded(left.lerp(right, share), 30),
            to: Point::rounded(left_end.lerp(right_end, share), 30),
        };
        assert!(
            view.strip.width < 1e-6 || is_free(level, &line),
            "{share} of {view:?}"
        );
    }
}

/// What must hold of everything that is hidden.
fn check_hidden(world: &World, a: CellId, b: CellId, hidden: &Hidden) {
    let World { graph, pvs, .. } = world;
    let way = &hidden.way;
    let mut cell = a;
    for &edge in &way.portals {
        assert_eq!(graph.edge(edge).cell, cell, "a portal of the cell");
        cell = graph
            .edge(graph.edge(edge).twin().expect("it is a portal"))
            .cell;
    }
    assert_eq!(cell, b);
    let beyond = |n: usize| explain::last_cell(graph, a, &way.portals[..n]);
    assert!((0..=hidden.stop).all(|n| pvs.sees(a, beyond(n))));
    assert!(!pvs.sees(a, beyond(hidden.stop + 1)));
    assert!(
        hidden
            .ends
            .holds(&graph.vertices, &gates(graph, &way.portals))
    );
    let sum: f64 = way.points.windows(2).map(|p| p[0].distance(p[1])).sum();
    assert!((sum - way.length).abs() <= 1e-9 * sum);
    // No leg crosses a wall. (Touching is what a short way does.)
    for edge in (0..graph.edges.len() as u32).map(EdgeId) {
        if graph.edge(edge).twin().is_some() {
            continue;
        }
        let ends = [graph.edge(edge).origin, graph.end(edge)].map(|v| graph.vertices.approx(v));
        for leg in way.points.windows(2) {
            let of =
                |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) / (q - p).length() / 1e-6;
            let crosses = |s: f64, t: f64| s.min(t) < -1.0 && s.max(t) > 1.0;
            let crossed = crosses(of(leg[0], leg[1], ends[0]), of(leg[0], leg[1], ends[1]))
                && crosses(of(ends[0], ends[1], leg[0]), of(ends[0], ends[1], leg[1]));
            assert!(!crossed, "{leg:?} crosses {ends:?}");
        }
    }
}

#[test]
fn random_levels_are_explained() {
    let mut random = Pcg64::seed_from_u64(5);
    let (mut views, mut ways, mut all_chains, mut wider) = (0, 0, 0, 0);
    let (mut bundles, mut narrower, mut least) = (0, 0, 1.0f64);
    for _ in 0..150 {
        let strokes = random_strokes(&mut random);
        let level = level_of(&strokes);
        for subdivision in Subdivision::ALL {
            let options = Options {
                subdivision,
                ..Options::default()
            };
            let world = World::new(level.clone(), &options);
            let n = world.graph.cells.len() as u32;
            for _ in 0..12 {
                let [a, b] = [0, 0].map(|_| CellId(random.random_range(0..n)));
                match world.explain(a, b) {
                    Explanation::Same => assert_eq!(a, b),
                    Explanation::Visible(view) => {
                        assert!(world.pvs.sees(a, b) && view.complete);
                        check_view(&world, a, b, &view);
                        views += 1;
                        wider += usize::from(view.strip.width > view.slack * (1.0 + 1e-9));
                        if n < 40 {
                            let best = widest_chain(&world.graph, a, b).expect("they see");
                            let off = (view.slack - best).abs();
                            assert!(off <= 1e-9 * best, "{} and {best}", view.slack);
                            all_chains += 1;
                            if world.graph.vertices.len() < 30 {
                                let all = widest_bundle(&world.graph, a, b);
                                let share = view.strip.width / all;
                                assert!(
                                    share < 1.0 + 1e-6,
                                    "{} of {all}: {view:?}",
                                    view.strip.width
                                );
                                bundles += 1;
                                narrower += usize::from(share < 1.0 - 1e-6);
                                least = least.min(share);
                            }
                        }
                    }
                    Explanation::Hidden(hidden) => {
                        assert!(!world.pvs.sees(a, b));
                        check_hidden(&world, a, b, &hidden);
                        ways += 1;
                        // As short from the other end.
                        let Explanation::Hidden(back) = world.explain(b, a) else {
                            panic!("{strokes:?}, {subdivision:?}: no way back from {b:?} to {a:?}");
                        };
                        let off = (back.way.length - hidden.way.length).abs();
                        assert!(
                            off <= 1e-9 * back.way.length,
                            "{strokes:?}, {subdivision:?}: {a:?} to {b:?}: {:?}, and back {:?}",
                            hidden.way,
                            back.way
                        );
                    }
                    Explanation::Apart => assert!(!world.pvs.sees(a, b)),
                }
            }
        }
    }
    println!(
        "{views} views ({wider} wider than their chain), {all_chains} against all chains, {bundles} \
         against all directions ({narrower} narrower than the widest, the least {least:.3} of it), \
         {ways} ways"
    );
    assert!(views > 1000 && ways > 500 && all_chains > 500 && wider > 50);
}

/// Median, and the largest of a hundred.
fn spread(mut times: Vec<f64>) -> String {
    times.sort_by(f64::total_cmp);
    let n = times.len().max(1);
    let at = |share: f64| times[((n - 1) as f64 * share) as usize] * 1e6;
    format!(
        "median {:.0}, of a hundred {:.0}, longest {:.0} µs",
        at(0.5),
        at(0.99),
        at(1.0)
    )
}

#[test]
fn maps_of_freedoom_are_explained() {
    for (file, map, pairs) in [
        ("freedoom1.wad", "E1M1", 400),
        ("freedoom2.wad", "MAP12", 150),
    ] {
        let path = Path::new("/usr/share/games/doom").join(file);
        let Ok(bytes) = std::fs::read(&path) else {
            let missing = format!("{} is not there; install Freedoom", path.display());
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            continue;
        };
        let wad = Wad::parse(bytes).expect("Freedoom is a WAD");
        let draft = doom::read_map(&wad, map, file).expect("the map is sound");
        let level = snap::snap(draft).expect("the map is sound");
        for subdivision in Subdivision::ALL {
            let options = Options {
                subdivision,
                ..Options::default()
            };
            let world = World::new(level.clone(), &options);
            let n = world.graph.cells.len() as u32;
            let mut random = Pcg64::seed_from_u64(3);
            let (mut views, mut ways) = (Vec::new(), Vec::new());
            let (mut steps, mut cut_short, mut walls) = (0, 0, 0);
            for _ in 0..1_000_000 {
                if views.len() >= pairs && ways.len() >= pairs / 2 {
                    break;
                }
                let [a, b] = [0, 0].map(|_| CellId(random.random_range(0..n)));
                let (list, enough) = match world.pvs.sees(a, b) {
                    true => (&mut views, pairs),
                    false => (&mut ways, pairs / 2),
                };
                if a == b || list.len() >= enough {
                    continue;
                }
                let start = Instant::now();
                let explanation = world.explain(a, b);
                list.push(start.elapsed().as_secs_f64());
                match explanation {
                    Explanation::Visible(view) => {
                        steps += view.steps;
                        cut_short += usize::from(!view.complete);
                        check_view(&world, a, b, &view);
                    }
                    Explanation::Hidden(hidden) => {
                        check_hidden(&world, a, b, &hidden);
                        let ends = hidden.ends.left.iter().chain(&hidden.ends.right);
                        let open = |v| corners(&world.graph, v).contains(&explain::Corner::Open);
                        walls += usize::from(!ends.into_iter().any(|&v| open(v)));
                    }
                    Explanation::Apart => assert!(!world.pvs.sees(a, b)),
                    Explanation::Same => unreachable!("the cells differ"),
                }
            }
            assert!(views.len() >= pairs && ways.len() >= pairs / 2);
            println!(
                "{map} {}: {} views: {}, {} steps, {cut_short} cut short; {} ways ({walls} by walls \
                 alone): {}",
                subdivision.as_str(),
                views.len(),
                spread(views.clone()),
                steps,
                ways.len(),
                spread(ways.clone()),
            );
        }
    }
}

/// Rooms in a row with windows low, high and low.
const SILLS: &str = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
    [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
    [[room]]\nname = \"C\"\nrect = [8, 0, 12, 4]\n\
    [[room]]\nname = \"D\"\nrect = [12, 0, 16, 4]\n\
    [[window]]\npoints = [[4, 1], [4, 3]]\nbottom = 0\ntop = 1\n\
    [[window]]\npoints = [[8, 1], [8, 3]]\nbottom = 2\ntop = 3\n\
    [[window]]\npoints = [[12, 1], [12, 3]]\nbottom = 0\ntop = 1\n";

#[test]
fn a_high_window_between_two_low_ones_hides() {
    let world = World::of_toml(SILLS);
    let options = ExplainOptions {
        heights: Some(HeightsOptions::default()),
        ..ExplainOptions::default()
    };
    let account = |x: f64| {
        let asked = [2.0, x].map(|x| Asked::new(world.cell(x, 2.0), None, &[]));
        let explained =
            enfilade::report::explain::explain(&world.graph, &world.pvs, asked, &options);
        let explained = explained.expect("the PVS is the graph's own");
        let account = Account::of(&world.level, &world.graph, &explained);
        let words = text::of(&world.level, &account);
        (serde_json::to_value(&account).expect("it is plain"), words)
    };
    // Through two windows a steep line passes.
    let (near, words) = account(10.0);
    assert_eq!(near["visible"], true, "{words}");
    assert_eq!(near["view"]["space"]["answer"], "visible");
    let heights = near["view"]["space"]["segment"]
        .as_array()
        .expect("there is one");
    let z = |i: usize| heights[i][2].as_f64().expect("it is a number");
    assert!(z(0) < 1.0 && z(1) > 2.0, "{near:#}");
    assert!(words.contains("In space"), "{words}");
    // Not through all three.
    let (far, words) = account(14.0);
    assert_eq!(far["visible"], false, "{words}");
    assert_eq!(far["view"]["space"]["answer"], "hidden");
    let blocking = far["view"]["space"]["blocked_by"]
        .as_array()
        .expect("it is a list");
    let openings: Vec<&Value> = blocking.iter().map(|p| &p["opening"]).collect();
    assert_eq!(
        openings,
        [&json!([0.0, 1.0]), &json!([2.0, 3.0]), &json!([0.0, 1.0])]
    );
    assert!(
        words.contains("Not visible") && words.contains("Blocked by"),
        "{words}"
    );
}
