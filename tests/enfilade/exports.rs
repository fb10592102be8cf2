//! Levels in other programs' formats: what is written can be read, by their own crates and by this
//! one; what comes back has the same planar PVS, cell by cell; what cannot be read is refused.

use std::fs;
use std::path::Path;

use enfilade::cells::guide::{Below, Guide, Split};
use enfilade::cells::tree::Branch;
use enfilade::cells::{Options, guide, subdivide};
use enfilade::geom::{GridPoint, Line};
use enfilade::level::{Level, read};
use enfilade::pvs::{Progress, sweep};
use glam::DVec2;
use tempfile::TempDir;

use crate::cli::{enfilade, level as level_path, refused};
use crate::readers::{two_squares, wad};

fn read_level(path: &Path) -> Level {
    let name = path.file_name().unwrap().to_string_lossy();
    let level = read::read(fs::read(path).unwrap(), &name, None);
    level.unwrap_or_else(|error| panic!("{error}"))
}

/// The sample levels that stand for buildings.
const SAMPLES: [&str; 9] = [
    "tiny",
    "house",
    "museum",
    "office",
    "maze",
    "theatre",
    "cathedral",
    "enfilade",
    "gallery",
];

/// Compares the visible sets of two levels that are to have the same walls. The second is cut by the
/// very lines by which the first was, so that each of its cells lies in one of the first one's; what
/// the second has beside (a court between the rooms) is let be. `place` takes points of the first to
/// the second. Gives the number of cells and of pairs that see each other.
fn same_pvs(
    name: &str,
    first: &Level,
    second: &Level,
    place: impl Fn(DVec2) -> DVec2,
) -> [usize; 2] {
    let graph = subdivide(first, &Options::default());
    let tree = graph.tree.as_ref().expect("a BSP has a tree");
    let n = graph.cells.len();
    let below = |branch| match branch {
        Branch::Split(i) => Below::Split(i),
        Branch::Cell(cell) => Below::Leaf(cell.0),
        Branch::Solid => Below::Leaf(n as u32),
    };
    let there = |p: GridPoint| {
        let p = place(first.grid.to_level(p));
        let there = second.grid.nearest(p).expect("it is on the grid");
        assert_eq!(second.grid.to_level(there), p, "{name}: the grids differ");
        there
    };
    let split = |split: &enfilade::cells::tree::Split| {
        let on_it =
            |wall: &&enfilade::level::Wall| Line::through(wall.from, wall.to) == Some(split.line);
        let wall = first.walls.iter().find(on_it).expect("walls split a BSP");
        // Lines point right, or straight up.
        let through = [wall.from.min(wall.to), wall.from.max(wall.to)].map(there);
        Split {
            through,
            right: below(split.right),
            left: below(split.left),
        }
    };
    let splits = tree.splits.iter().map(split).collect();
    let guide = Guide::new(splits, below(tree.root), n + 1).expect("it was a tree");
    let (again, leaf_of) = guide::subdivide(second, &guide, &Options::default());
    let [before, after] = [&graph, &again].map(|graph| sweep::sweep(graph, &Progress::default()));
    let mut cells_of = vec![Vec::new(); n + 1];
    for (cell, &leaf) in again.cell_ids().zip(&leaf_of) {
        cells_of[leaf as usize].push(cell);
    }
    cells_of.truncate(n);
    for (cell, there) in graph.cell_ids().zip(&cells_of) {
        let shape = graph.polygon(cell).len();
        assert_eq!(there.len(), 1, "{name}: cell {} of {shape} corners", cell.0);
    }
    for (a, there) in graph.cell_ids().zip(&cells_of) {
        for (b, other) in graph.cell_ids().zip(&cells_of) {
            let [before, after] = [before.sees(a, b), after.sees(there[0], other[0])];
            assert_eq!(before, after, "{name}: cells {} and {}", a.0, b.0);
        }
    }
    [n, before.pairs() as usize]
}

/// Exports levels in a format and from there as TOML, by the command line, and compares.
fn there_and_back(
    format: &str,
    more: &[&str],
    levels: &[&str],
    place: impl Fn(&Level, DVec2) -> DVec2,
) {
    let folder = TempDir::new().unwrap();
    for name in levels {
        let from = level_path(&format!("{name}.toml"));
        let [between, to] = [format, "toml"].map(|ending| {
            let path = folder.path().join(format!("{name}.{ending}"));
            path.to_string_lossy().into_owned()
        });
        let arguments = [&["export", format, &from, "-q", "-o", &between], more].concat();
        let done = enfilade(&arguments);
        assert!(done.status.success(), "{done:?}");
        let done = enfilade(&["export", "toml", &between, "-q", "-o", &to]);
        assert!(done.status.success(), "{done:?}");
        let [first, second] = [&*from, &*to].map(|path| read_level(Path::new(path)));
        let [cells, pairs] = same_pvs(name, &first, &second, |p| place(&first, p));
        println!("{name} as {format} and back: {cells} cells, {pairs} pairs");
    }
}

/// The lower left and upper right corner of a level's walls.
fn extent(level: &Level) -> [DVec2; 2] {
    let ends = level.walls.iter().flat_map(|wall| [wall.from, wall.to]);
    let ends = ends.map(|p| level.grid.to_level(p)).map(|p| [p, p]);
    let both = ends.reduce(|[low, high], [p, _]| [low.min(p), high.max(p)]);
    both.expect("a level has walls")
}

/// A difference of decimals as the decimal that it is.
fn decimal(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

#[test]
fn toml_to_uvtt_and_back_keeps_the_pvs() {
    there_and_back("uvtt", &[], &SAMPLES, |level, p| {
        // The lower left corner of the map, with a square of margin, is where the map begins.
        (p - extent(level)[0] + 1.0).map(decimal)
    });
}

#[test]
fn toml_to_dxf_and_back_keeps_the_pvs() {
    there_and_back("dxf", &[], &SAMPLES, |_, p| p);
}

#[test]
fn toml_to_svg_and_back_keeps_the_pvs() {
    there_and_back("svg", &[], &SAMPLES, |level, p| {
        // y counts from the foot of the page, which is a whole number.
        let [low, high] = extent(level);
        let margin = ((high - low).max_element() / 50.0).ceil();
        let foot = (low.y - margin).floor();
        DVec2::new(p.x, decimal(p.y - foot))
    });
}

#[test]
fn the_comparison_notices_a_wall() {
    let room = "[[room]]\nname = 'A'\nrect = [0, 0, 8, 4]\n[[wall]]\npoints = [[4, 0], [4, 3]]\n";
    let [first, second] = [room.to_string(), room.replace("[4, 3]]", "[4, 4]]")]
        .map(|text| read::read(text.into(), "a.toml", None).unwrap());
    same_pvs("itself", &first, &first, |p| p);
    let other = std::panic::catch_unwind(|| same_pvs("other", &first, &second, |p| p));
    assert!(other.is_err());
}

/// The formats that are made of a level, with what is written to by default.
const OF_A_LEVEL: [&str; 8] = [
    "toml", "dxf", "svg", "uvtt", "geojson", "csv", "json", "prt",
];

#[test]
fn every_format_takes_levels_maps_and_pvs_files() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (map, pvs) = (at("two.wad"), at("house.pvs"));
    fs::write(&map, two_squares()).unwrap();
    let built = enfilade(&["build", &level_path("house.toml"), "-q", "-o", &pvs]);
    assert!(built.status.success());
    for format in OF_A_LEVEL {
        let to = at("out");
        for from in [&level_path("house.toml"), &map] {
            let done = enfilade(&["export", format, from, "-q", "-o", &to]);
            assert!(done.status.success(), "{format} of {from}: {done:?}");
            assert!(done.stderr.is_empty(), "{format} of {from}: {done:?}");
            // The least: a PRT1 file of two cells without a portal.
            assert!(fs::metadata(&to).unwrap().len() >= 9, "{format} of {from}");
            let piped = enfilade(&["export", format, from, "-q", "-o", "-"]);
            if format != "json" {
                // JSON tells how long it took.
                assert_eq!(piped.stdout, fs::read(&to).unwrap(), "{format} of {from}");
            }
        }
        if matches!(format, "toml" | "uvtt") {
            refused(
                &["export", format, &pvs, "-o", &to],
                &["house.pvs", "give the level"],
            );
            continue;
        }
        let done = enfilade(&["export", format, &pvs, "-q", "-o", &to]);
        assert!(done.status.success(), "{format} of a .pvs file: {done:?}");
        let wrong = ["export", format, &pvs, "--subdivision", "kd", "-o", &to];
        refused(&wrong, &["house.pvs", "--subdivision"]);
    }
    // The same file, whether by way of the .pvs or not.
    for (format, more) in [("csv", &["--table", "visible"][..]), ("prt", &[])] {
        let of = |from: &str| {
            let done = enfilade(&[&["export", format, from, "-q", "-o", "-"], more].concat());
            assert!(done.status.success(), "{done:?}");
            String::from_utf8(done.stdout).unwrap()
        };
        let plain = |text: String| -> Vec<String> {
            let rows = text
                .lines()
                .map(|line| line.split(',').rfind(|s| !s.is_empty()));
            rows.map(|last| last.unwrap_or_default().to_string())
                .collect()
        };
        assert_eq!(
            plain(of(&pvs)),
            plain(of(&level_path("house.toml"))),
            "{format}"
        );
    }
}

#[test]
fn what_cannot_be_read_is_refused_by_every_format() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let to = at("out");
    let pvs = at("house.pvs");
    enfilade(&["build", &level_path("house.toml"), "-q", "-o", &pvs]);
    let whole = fs::read(&pvs).unwrap();
    fs::write(at("cut.pvs"), &whole[..whole.len() / 2]).unwrap();
    fs::write(at("none.pvs"), b"nothing").unwrap();
    fs::write(at("latin.toml"), b"name = \"Caf\xe9\"").unwrap();
    fs::write(
        at("wrong.toml"),
        "[[room]]\nname = \"A\"\nrect = [0, 0, 1e999, 4]\n",
    )
    .unwrap();
    fs::write(at("cut.wad"), &two_squares()[..60]).unwrap();
    for format in OF_A_LEVEL {
        for name in [
            "latin.toml",
            "wrong.toml",
            "cut.wad",
            "missing.toml",
            "cut.pvs",
            "none.pvs",
        ] {
            refused(&["export", format, &at(name), "-o", &to], &[name]);
        }
        refused(
            &[
                "export",
                format,
                &level_path("tiny.toml"),
                "-o",
                &at("no/out"),
            ],
            &["no/out"],
        );
        refused(&["export", format, &level_path("tiny.toml")], &["--output"]);
    }
    let tiny = level_path("tiny.toml");
    for (arguments, part) in [
        (&["geojson", "--layers", "visible"][..], "--from"),
        (&["geojson", "--layers", "area"], "--eye"),
        (&["geojson", "--eye", "99,99"], "99,99"),
        (&["geojson", "--from", "99,99"], "99,99"),
        (&["geojson", "--cell", "9999"], "9999"),
        (&["geojson", "--eye", "1,1", "--fov", "0"], "field of view"),
        (&["csv", "--table", "rooms"], "rooms"),
        (&["uvtt", "--square", "0"], "--square"),
        (&["uvtt", "--pixels", "0"], "--pixels"),
        (&["dxf", "--layers", "roofs"], "roofs"),
        (&["reject"], "tiny.toml"),
        (&["gl-pvs"], "tiny.toml"),
    ] {
        refused(
            &[&["export"], arguments, &[&tiny, "-o", &to]].concat(),
            &[part],
        );
    }
    assert!(!Path::new(&to).exists());
}

#[test]
fn tables_of_doom_maps_are_refused_where_they_cannot_be() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (to, map) = (at("out.wad"), at("two.wad"));
    fs::write(&map, two_squares()).unwrap();
    refused(
        &["export", "gl-pvs", &map, "-o", &to],
        &["two.wad", "no GL nodes", "glbsp"],
    );
    refused(
        &["export", "reject", &map, "--map", "E9M9", "-o", &to],
        &["E9M9", "E1M1"],
    );
    fs::write(at("none.wad"), wad(&[("OTHER", vec![1])])).unwrap();
    for format in ["reject", "gl-pvs"] {
        refused(
            &["export", format, &at("none.wad"), "-o", &to],
            &["none.wad", "no maps"],
        );
        fs::write(at("cut.wad"), &two_squares()[..50]).unwrap();
        refused(&["export", format, &at("cut.wad"), "-o", &to], &["cut.wad"]);
    }
    // GL nodes of other versions, damaged ones, ones of another map.
    let vert = |magic: &[u8]| [magic, &[0; 16]].concat();
    let node = |from: [i16; 4], children: [u16; 2]| {
        let numbers = from.into_iter().chain([0; 8]).flat_map(i16::to_le_bytes);
        numbers
            .chain(children.into_iter().flat_map(u16::to_le_bytes))
            .collect::<Vec<u8>>()
    };
    let seg = [0u16, 1, 0xffff, 0, 0xffff]
        .iter()
        .flat_map(|n| n.to_le_bytes())
        .collect::<Vec<u8>>();
    let subsector = |n: u16, first: u16| [n.to_le_bytes(), first.to_le_bytes()].concat();
    let two = [subsector(1, 0), subsector(1, 0)].concat();
    let good = node([128, 0, 0, 128], [0x8000, 0x8001]);
    for (what, lumps) in [
        (
            "version 1",
            [vec![0; 8], seg.clone(), two.clone(), good.clone()],
        ),
        (
            "version 4",
            [vert(b"gNd4"), seg.clone(), two.clone(), good.clone()],
        ),
        (
            "GL_VERT",
            [b"gNd2abc".to_vec(), seg.clone(), two.clone(), good.clone()],
        ),
        (
            "GL_SEGS",
            [vert(b"gNd2"), vec![0; 7], two.clone(), good.clone()],
        ),
        (
            "record 0 of lump GL_SSECT",
            [vert(b"gNd2"), seg.clone(), subsector(2, 0), good.clone()],
        ),
        (
            "record 0 of lump GL_SEGS",
            [vert(b"gNd2"), vec![0xff; 10], two.clone(), good.clone()],
        ),
        (
            "GL_NODES",
            [vert(b"gNd2"), seg.clone(), two.clone(), good[1..].to_vec()],
        ),
        (
            "GL_SSECT",
            [vert(b"gNd2"), seg.clone(), Vec::new(), good.clone()],
        ),
        (
            "node 0",
            [
                vert(b"gNd2"),
                seg.clone(),
                two.clone(),
                node([0, 0, 0, 9], [0x8000, 0x8002]),
            ],
        ),
        (
            "node 0",
            [
                vert(b"gNd2"),
                seg.clone(),
                two.clone(),
                node([0, 0, 0, 9], [0x8000, 0]),
            ],
        ),
        (
            "node 0",
            [
                vert(b"gNd2"),
                seg.clone(),
                two.clone(),
                node([0, 0, 0, 0], [0x8000, 0x8001]),
            ],
        ),
    ] {
        let [vertices, segs, subsectors, nodes] = lumps;
        let gl = wad(&[
            ("GL_E1M1", Vec::new()),
            ("GL_VERT", vertices),
            ("GL_SEGS", segs),
            ("GL_SSECT", subsectors),
            ("GL_NODES", nodes),
        ]);
        fs::write(at("two.gwa"), gl).unwrap();
        let arguments = ["export", "gl-pvs", &map, "--gl", &at("two.gwa"), "-o", &to];
        refused(&arguments, &["two.gwa", what]);
    }
    assert!(!Path::new(&to).exists());
}

/// Two squares with GL nodes of version 2 in a file beside them: one split, two subsectors.
#[test]
fn gl_nodes_beside_the_wad() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    fs::write(at("two.wad"), two_squares()).unwrap();
    let shorts = |n: &[u16]| n.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<u8>>();
    // Both subsectors have one seg each, which closes nothing: the tree alone tells where they are.
    let gl = wad(&[
        ("GL_LEVEL", b"LEVEL=E1M1\nBUILDER=a test\n".to_vec()),
        ("GL_VERT", b"gNd2".to_vec()),
        ("GL_SEGS", shorts(&[0, 1, 0xffff, 0, 0xffff])),
        ("GL_SSECT", shorts(&[1, 0, 1, 0])),
        (
            "GL_NODES",
            shorts(&[128, 0, 0, 128, 0, 0, 0, 0, 0, 0, 0, 0, 0x8001, 0x8000]),
        ),
        ("OTHER", vec![7]),
    ]);
    fs::write(at("two.gwa"), &gl).unwrap();
    let export = |to: &str| {
        let done = enfilade(&[
            "export",
            "gl-pvs",
            &at("two.wad"),
            "--gl",
            &at("two.gwa"),
            "-o",
            &at(to),
        ]);
        assert!(done.status.success(), "{done:?}");
        let told = String::from_utf8(done.stderr).unwrap();
        assert!(
            told.contains("2 subsectors") && told.contains("version 2"),
            "{told}"
        );
        fs::read(at(to)).unwrap()
    };
    let out = enfilade::level::wad::Wad::parse(export("out.gwa")).unwrap();
    let names: Vec<&str> = out.lumps().iter().map(|lump| &*lump.name).collect();
    let expected = [
        "GL_LEVEL", "GL_VERT", "GL_SEGS", "GL_SSECT", "GL_NODES", "GL_PVS", "OTHER",
    ];
    assert_eq!(names, expected);
    assert_eq!(out.lump_named("GL_PVS"), Some(&[3u8, 3][..]));
    assert_eq!(export("out.lmp"), [3, 3]);
    // Once more: the lump that is there is replaced.
    fs::copy(at("out.gwa"), at("two.gwa")).unwrap();
    let again = enfilade::level::wad::Wad::parse(export("again.gwa")).unwrap();
    assert_eq!(again.lumps().len(), 7);
}

#[test]
fn a_reject_alone_and_as_a_lump() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let mut lumps = vec![("OTHER", vec![7u8])];
    let whole = two_squares();
    let source = enfilade::level::wad::Wad::parse(whole).unwrap();
    let own: Vec<(&str, Vec<u8>)> = (source.lumps().iter().enumerate())
        .map(|(i, lump)| (&*lump.name, source.lump(i).to_vec()))
        .collect();
    lumps.extend(own.clone());
    fs::write(at("all.wad"), wad(&lumps)).unwrap();
    for (more, to, n) in [(&[][..], "copy.wad", 1), (&["--alone"], "alone.wad", 0)] {
        let arguments = ["export", "reject", &at("all.wad"), "-q", "-o", &at(to)];
        let done = enfilade(&[&arguments, more].concat());
        assert!(done.status.success(), "{done:?}");
        let out = enfilade::level::wad::Wad::parse(fs::read(at(to)).unwrap()).unwrap();
        // A REJECT where there was none.
        let had = own.iter().any(|(name, _)| *name == "REJECT");
        assert_eq!(out.lumps().len(), n + own.len() + usize::from(!had));
        assert_eq!(out.lump_named("REJECT"), Some(&[0u8][..]));
    }
    let done = enfilade(&[
        "export",
        "reject",
        &at("all.wad"),
        "-q",
        "-o",
        &at("all.REJ"),
    ]);
    assert!(done.status.success(), "{done:?}");
    assert_eq!(fs::read(at("all.REJ")).unwrap(), [0]);
}
