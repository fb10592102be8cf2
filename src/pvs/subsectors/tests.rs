//! GL nodes made here of our own trees, and by the node builders of Debian.

use std::path::Path;
use std::process::{Command, Stdio};

use super::*;
use crate::cells::tree::{Branch, Tree};
use crate::cells::{Locator, Subdivision, subdivide};
use crate::geom::{Side, Vertex, orient};
use crate::level::wad::Wad;
use crate::level::{WallKind, doom, snap};
use crate::pvs::{Progress, sectors, sweep};

fn freedoom() -> Option<Wad> {
    match std::fs::read("/usr/share/games/doom/freedoom1.wad") {
        Ok(bytes) => Some(Wad::parse(bytes).unwrap()),
        Err(_) => {
            let missing = "freedoom1.wad is not there; install Freedoom";
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            None
        }
    }
}

fn level(wad: &Wad, map: &str) -> Level {
    snap::snap(doom::read_map(wad, map, "any.wad").unwrap()).unwrap()
}

/// GL nodes of a tree and its cells, with a subsector for all that is solid, the last one.
fn nodes_of(level: &Level, graph: &CellGraph, tree: &Tree) -> GlNodes {
    let [x, y] = level.grid.origin;
    let subsectors = (graph.cell_ids()).map(|cell| {
        let edges: Vec<EdgeId> = graph.edge_range(cell).map(EdgeId).collect();
        let at = |v| {
            let p = (graph.vertices.approx(v) * 65536.0).round();
            [p.x as i64 + (x << 16), p.y as i64 + (y << 16)]
        };
        let seg = |&e: &EdgeId| {
            let linedef = |wall: crate::level::WallId| match level.walls[wall.0 as usize].place {
                Place::Linedef(n) => n,
                _ => panic!("a Doom map's walls are linedefs"),
            };
            GlSeg {
                ends: [at(graph.end(e)), at(graph.edge(e).origin)],
                linedef: graph.edge(e).wall().map(linedef),
            }
        };
        edges.iter().rev().map(seg).collect()
    });
    let mut subsectors: Vec<Vec<GlSeg>> = subsectors.collect();
    let solid = subsectors.len() as u32;
    subsectors.push(Vec::new());
    // The root is the first split there, and the last node here.
    let n = tree.splits.len() as u32;
    let child = |branch| match branch {
        Branch::Split(i) => GlChild::Node(n - 1 - i),
        Branch::Cell(cell) => GlChild::Subsector(cell.0),
        Branch::Solid => GlChild::Subsector(solid),
    };
    let node = |split: &crate::cells::tree::Split| {
        let on_line = |w: &&crate::level::Wall| Line::through(w.from, w.to) == Some(split.line);
        let wall = level.walls.iter().find(on_line).unwrap();
        let forward = (wall.from.x, wall.from.y) < (wall.to.x, wall.to.y);
        let children = [split.right, split.left].map(child);
        let [right, left] = children;
        GlNode {
            from: [wall.from.x + x, wall.from.y + y],
            by: [wall.to.x - wall.from.x, wall.to.y - wall.from.y],
            children: if forward { children } else { [left, right] },
        }
    };
    GlNodes {
        version: 5,
        subsectors,
        nodes: tree.splits.iter().rev().map(node).collect(),
    }
}

fn solve(graph: &CellGraph) -> Pvs {
    sweep::sweep(graph, &Progress::default())
}

#[test]
fn our_own_trees_give_our_own_visible_sets() {
    let Some(wad) = freedoom() else { return };
    for map in ["E1M1", "E1M5"] {
        let level = level(&wad, map);
        let graph = subdivide(&level, &Options::default());
        let nodes = nodes_of(&level, &graph, graph.tree.as_ref().unwrap());
        let again = Subsectors::new(&level, &nodes, &Options::default()).unwrap();
        again.graph.validate().unwrap();
        // One cell for each: the same ground, so the same sight.
        assert_eq!(again.graph.cells.len(), graph.cells.len(), "{map}");
        assert_eq!(again.n_shared(), 0, "{map}");
        let sees = again.relation(&solve(&again.graph));
        let own = solve(&graph);
        let n = graph.cells.len();
        assert_eq!(sees.n(), n + 1);
        for i in 0..n {
            let row: Vec<usize> = sees.ones(i).filter(|&j| j < n).collect();
            assert_eq!(row, own.visible.ones(i).collect::<Vec<_>>(), "{map}, {i}");
        }
        // What has no ground may be anywhere.
        assert_eq!(sees.count(n), n + 1);
    }
}

/// Lets a node builder of Debian make GL nodes; `None` where it is not installed.
fn built_by(program: &str, arguments: &[&str], wad: &Path) -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.wad");
    let mut command = Command::new(program);
    command.args(arguments).arg(wad).arg("-o").arg(&out);
    let done = command.stdout(Stdio::null()).stderr(Stdio::null()).status();
    match done {
        Ok(done) => {
            assert!(done.success(), "{program}: {done}");
            Some(std::fs::read(&out).unwrap())
        }
        Err(_) => {
            let missing = format!("{program} is not installed (apt-get install {program})");
            assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
            eprintln!("skipped: {missing}");
            None
        }
    }
}

/// The subsector to which the tree leads, as in an engine; `None` on a partition line.
fn locate(nodes: &GlNodes, p: [i64; 2]) -> Option<usize> {
    let mut at = match nodes.nodes.len() {
        0 => GlChild::Subsector(0),
        n => GlChild::Node(n as u32 - 1),
    };
    loop {
        at = match at {
            GlChild::Subsector(n) => return Some(n as usize),
            GlChild::Node(n) => {
                let node = &nodes.nodes[n as usize];
                let [dx, dy] = [p[0] - node.from[0], p[1] - node.from[1]];
                match node.by[0] * dy - node.by[1] * dx {
                    0 => return None,
                    turn => node.children[usize::from(turn > 0)],
                }
            }
        }
    }
}

fn touches(a: GridPoint, b: GridPoint, c: GridPoint, d: GridPoint) -> bool {
    let [a, b, c, d]: [Vertex; 4] = [a, b, c, d].map(Into::into);
    let apart = |p: Side, q: Side| p == q && p != Side::On;
    !apart(orient(&a, &b, &c), orient(&a, &b, &d)) && !apart(orient(&c, &d, &a), orient(&c, &d, &b))
}

#[test]
fn the_nodes_of_other_programs() {
    let Some(wad) = freedoom() else { return };
    let folder = tempfile::tempdir().unwrap();
    let maps = ["E1M1", "E1M5", "E2M3"];
    let path = folder.path().join("in.wad");
    std::fs::write(&path, wad.with_maps_only(&maps.map(String::from)).unwrap()).unwrap();
    for (program, arguments, version) in [
        ("glbsp", &["-v2"][..], 2),
        ("glbsp", &["-v5"], 5),
        ("zdbsp", &["-g", "-q"], 2),
        ("zdbsp", &["-g", "-q", "-5"], 5),
    ] {
        let Some(bytes) = built_by(program, arguments, &path) else {
            continue;
        };
        let built = Wad::parse(bytes).unwrap();
        for map in maps {
            let name = format!("{program} {arguments:?} {map}");
            let level = level(&built, map);
            let nodes = doom::gl::read(&built, &built, &built.map(map).unwrap()).unwrap();
            assert_eq!(nodes.version, version);
            let subsectors = Subsectors::new(&level, &nodes, &Options::default()).unwrap();
            let graph = &subsectors.graph;
            graph.validate().unwrap();
            let pvs = solve(graph);
            pvs.validate(graph).unwrap();
            let sees = subsectors.relation(&pvs);
            assert!(sees.is_symmetric(), "{name}");

            // The same sectors see each other as with cells that know nothing of these nodes.
            let options = Options {
                subdivision: Subdivision::Cdt,
                ..Options::default()
            };
            let plain = subdivide(&level, &options);
            let n = level.sectors.len();
            assert_eq!(
                sectors::sectors(n, graph, &pvs),
                sectors::sectors(n, &plain, &solve(&plain)),
                "{name}"
            );

            // No free segment joins two subsectors that are said to be hidden from each other.
            let solid: Vec<_> = (level.walls.iter())
                .filter(|w| w.kind == WallKind::Solid)
                .collect();
            let locator = Locator::new(&plain);
            let fine = Locator::new(graph);
            let corners: Vec<GridPoint> = plain.vertices.iter().filter_map(|v| v.grid()).collect();
            let [ox, oy] = level.grid.origin;
            let mut state = 7u64;
            let mut roll = |n: u64| {
                state = (state.wrapping_mul(6_364_136_223_846_793_005)).wrapping_add(1_442_695);
                (state >> 33) % n
            };
            let (mut hidden, mut right) = (0, 0);
            for _ in 0..6000 {
                let mut place = || {
                    let corner = corners[roll(corners.len() as u64) as usize];
                    let mut near = || roll(19) as i64 - 9;
                    let p = GridPoint::new(corner.x + near(), corner.y + near());
                    let [_] = locator.cells_at(&plain, &p.into())[..] else {
                        return None;
                    };
                    Some((p, locate(&nodes, [p.x + ox, p.y + oy])?))
                };
                let (Some((p, i)), Some((q, j))) = (place(), place()) else {
                    continue;
                };
                // The cell in which an exact search finds the point is one of that subsector.
                if let [cell] = fine.cells_at(graph, &p.into())[..] {
                    assert_eq!(subsectors.of(cell)[0] as usize, i, "{name}");
                    right += 1;
                }
                if sees.get(i, j) {
                    continue;
                }
                hidden += 1;
                assert!(
                    solid.iter().any(|w| touches(p, q, w.from, w.to)),
                    "{name}: subsectors {i} and {j} see each other along {p:?} to {q:?}"
                );
            }
            let n = subsectors.n;
            println!(
                "{name}: {n} subsectors, {} cells, {} shared, {:.1} % seen; {hidden} {right}",
                graph.cells.len(),
                subsectors.n_shared(),
                100.0 * sees.total() as f64 / (n * n) as f64
            );
            assert!(hidden > 100 && right > 1000, "{name}: {hidden}, {right}");
            // Cells beyond one a subsector are few: slivers where the builder's tolerance shows.
            assert!(graph.cells.len() < n + n / 10, "{name}");
            assert!(subsectors.n_shared() < n / 20, "{name}");
        }
    }
}

#[test]
fn the_bits_of_a_gl_pvs() {
    let mut sees = BitMatrix::new(9);
    for (i, j) in [(0, 0), (0, 8), (1, 1), (8, 0), (8, 8)] {
        sees.set(i, j);
    }
    let bytes = gl_pvs(&sees);
    assert_eq!(bytes.len(), 18);
    assert_eq!(bytes[..4], [1, 1, 2, 0]);
    assert_eq!(bytes[16..], [1, 1]);
}
