//! Plans drawn by other programs: the right rooms, the same in every subdivision, through to a PVS that
//! `verify` accepts; and files of every format changed at random, which are read or refused in time.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use enfilade::cells::{CellGraph, Options, Subdivision, subdivide};
use enfilade::level::drawing::DrawingOptions;
use enfilade::level::read::{ReadError, Source};
use enfilade::level::{Level, OpeningStyle, WallKind};
use enfilade::pvs::file::{self, LevelInfo};
use enfilade::pvs::verify::{VerifyOptions, verify};
use enfilade::pvs::{Progress, sweep};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::cli::{enfilade, level as level_path, refused};
use crate::readers::two_squares;

fn bytes(path: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(path);
    fs::read(path).expect("the plan is there")
}

fn read(path: &str) -> Level {
    read_bytes(bytes(path), path, DrawingOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn read_bytes(bytes: Vec<u8>, name: &str, options: DrawingOptions) -> Result<Level, ReadError> {
    Source::parse_with(bytes, name, options)?.level(None)
}

fn cells(level: &Level, subdivision: Subdivision) -> CellGraph {
    let options = Options {
        subdivision,
        ..Options::default()
    };
    let graph = subdivide(level, &options);
    graph.validate().unwrap_or_else(|flaw| panic!("{flaw}"));
    graph
}

/// The area of each sector, by its cells.
fn areas(level: &Level, graph: &CellGraph) -> Vec<f64> {
    let mut areas = vec![0.0; level.sectors.len()];
    for cell in graph.cell_ids() {
        let corners: Vec<_> = (graph.polygon(cell).into_iter())
            .map(|v| graph.vertices.exact(v).to_level(&level.grid))
            .collect();
        let n = corners.len();
        let doubled: f64 = (0..n)
            .map(|i| (corners[i] - corners[0]).perp_dot(corners[(i + 1) % n] - corners[0]))
            .sum();
        let sector = graph.cell(cell).sector.expect("every cell is in a room");
        areas[sector.0 as usize] += doubled / 2.0;
    }
    areas
}

/// Checks rooms, by name (or in the order of the file) and area, in every subdivision, and the PVS.
fn check_rooms(path: &str, square: f64, expected: &[(&str, f64)]) {
    let level = read(path);
    assert_eq!(
        level.sectors.len(),
        expected.len(),
        "{path}: {:?}",
        level.sectors
    );
    for subdivision in Subdivision::ALL {
        let graph = cells(&level, subdivision);
        assert_eq!(graph.findings, [], "{path}");
        for (i, area) in areas(&level, &graph).iter().enumerate() {
            let name = level.sectors[i].name.as_deref();
            let wanted = match name {
                Some(name) => expected.iter().find(|e| e.0 == name),
                None => expected.get(i),
            };
            let (_, wanted) = wanted.unwrap_or_else(|| panic!("{path}: no room {name:?}"));
            let off = (area * square - wanted).abs();
            assert!(
                off < 0.002 * wanted,
                "{path}, {name:?}: {} is not {wanted}",
                area * square
            );
        }
        let pvs = sweep::sweep(&graph, &Progress::default());
        let bytes = file::encode(&LevelInfo::of(&level), &graph, &pvs);
        let decoded = file::decode(&bytes).expect("what was written is read");
        let options = VerifyOptions {
            segments: 20_000,
            points: 5_000,
            ..VerifyOptions::default()
        };
        if let Err(failure) = verify(&decoded, &level, &options, &Progress::default()) {
            panic!("{path}: {}", failure.describe(&decoded, &level));
        }
    }
}

/// How many doors and windows, in pieces of wall.
fn openings(level: &Level) -> (usize, usize) {
    let count = |style| {
        let of_style = |w: &&enfilade::level::Wall| matches!(&w.kind, WallKind::Opening(o) if o.style == style);
        level.walls.iter().filter(of_style).count()
    };
    (count(OpeningStyle::Door), count(OpeningStyle::Window))
}

/// Areas worked out by hand from `office.py`: inner walls' faces, with the door's and window's reveals
/// that lie on the room's side of the leaf or pane.
#[test]
fn the_office_written_by_ezdxf() {
    use std::f64::consts::PI;
    let bay = PI * 0.69 * 0.69 / 2.0;
    let reveal = 0.9 * 0.12;
    let window = 1.8 * 0.3;
    let columns = PI * 0.2 * 0.2 + 0.3 * 0.3;
    let rooms = [
        ("Anna", 3.74 * 3.28 + reveal + window),
        ("Boris", 3.88 * 3.28 + reveal + window),
        ("Meeting", 4.14 * 3.28 + window),
        (
            "Corridor",
            12.0 * 1.38 + bay - PI * 0.25 * 0.15 + 2.0 * reveal,
        ),
        ("Archive", 4.4 * 3.1 + 2.0 * reveal),
        ("Lobby", 7.48 * 3.1 - columns + 1.8 * 0.15 + 2.0 * 0.15),
    ];
    check_rooms("plans/office.dxf", 1e-6, &rooms);
    // Six doors and the entrance; a window in a gap, and three in walls of two lines.
    assert_eq!(openings(&read("plans/office.dxf")), (7, 4));
}

#[test]
fn the_house_drawn_with_inkscape() {
    use std::f64::consts::PI;
    let quarter = |radius: f64| PI * radius * radius / 4.0;
    // In square metres; the round wall's door is a chord, which takes a little of the one and gives
    // it to the other.
    let rooms = [
        ("Bedroom", 5.64 * (3.0 + 0.14) + 0.9 * 0.06 + 2.0 * 0.3),
        (
            "Kitchen",
            5.64 * (3.0 + 0.14) + 0.9 * 0.06 + 1.0 * 0.15 + 1.5 * 0.3 + 0.9 * 0.06,
        ),
        ("Pantry", quarter(2.14) + 0.8 * 0.02),
        (
            "Living room",
            3.64 * 6.4 - quarter(2.26) + 0.9 * 0.06 + 1.8 * 0.3 + 0.8 * 0.07,
        ),
    ];
    let level = read("plans/house.svg");
    assert_eq!(level.name, "House");
    assert_eq!(openings(&level), (4, 3));
    for subdivision in Subdivision::ALL {
        let graph = cells(&level, subdivision);
        for (sector, area) in level.sectors.iter().zip(areas(&level, &graph)) {
            let name = sector.name.as_deref().expect("every room has its text");
            let (_, wanted) = rooms.iter().find(|r| r.0 == name).expect("a known room");
            assert!(
                (area * 1e-6 - wanted).abs() < 0.005 * wanted,
                "{name}: {area} {wanted}"
            );
        }
    }
}

#[test]
fn the_dungeon_of_a_table_top() {
    let cave = [
        (16.0, 4.0),
        (17.0, 2.5),
        (19.5, 1.75),
        (22.25, 3.0),
        (23.0, 6.5),
        (21.5, 9.25),
        (18.5, 9.75),
        (16.75, 8.0),
        (16.0, 6.0),
    ];
    let n = cave.len();
    let doubled: f64 = (0..n)
        .map(|i| cave[i].0 * cave[(i + 1) % n].1 - cave[i].1 * cave[(i + 1) % n].0)
        .sum();
    let rooms = [
        ("hall", 8.0 * 6.0 - 4.0 * 0.5),
        ("corridor", 12.0),
        ("cave", doubled / 2.0),
        ("crypt and the way to it", 4.0 + 24.0),
        ("secret room", 12.0),
    ];
    check_rooms("plans/dungeon.dd2vtt", 1.0, &rooms);
    let level = read("plans/dungeon.dd2vtt");
    assert_eq!(openings(&level), (4, 0));
    assert_eq!(level.scene.lights.len(), 3);
}

#[test]
fn commands_take_plans() {
    let folder = tempfile::tempdir().unwrap();
    for plan in ["office.dxf", "house.svg", "dungeon.dd2vtt"] {
        let plan = level_path(&format!("plans/{plan}"));
        let pvs = folder.path().join("plan.pvs");
        let pvs = pvs.to_str().unwrap();
        for subdivision in ["bsp", "kd", "cdt"] {
            for doors in ["open", "closed"] {
                let built = enfilade(&[
                    "build",
                    &plan,
                    "--subdivision",
                    subdivision,
                    "--doors",
                    doors,
                    "-o",
                    pvs,
                ]);
                assert!(built.status.success(), "{built:?}");
                let verified = enfilade(&["verify", pvs, &plan]);
                assert!(verified.status.success(), "{verified:?}");
            }
        }
        let checked = enfilade(&["check", &plan]);
        let said = String::from_utf8_lossy(&checked.stdout);
        assert!(
            checked.status.success() && said.contains("× room. Inside:"),
            "{said}"
        );
        let picture = folder.path().join("plan.svg");
        let drawn = enfilade(&["plan", &plan, "--findings", "-o", picture.to_str().unwrap()]);
        assert!(drawn.status.success(), "{drawn:?}");
    }
}

#[test]
fn options_for_drawings() {
    let office = level_path("plans/office.dxf");
    let said = |arguments: &[&str]| {
        let done = enfilade(&[&["check", &office], arguments].concat());
        assert!(done.status.success(), "{done:?}");
        String::from_utf8_lossy(&done.stdout).into_owned()
    };
    assert!(said(&["--unit", "m"]).contains("--unit mm"));
    assert!(said(&["--tolerance", "1"]).contains("at most 1 mm off"));
    // Without doors the walls' gaps stay open.
    assert!(!said(&["--layer", "ignored=A-DOOR"]).contains("6 × room"));
    assert!(
        said(&["--thickest-wall", "50"])
            .matches("wall-body")
            .count()
            == 0
    );
    refused(
        &["check", &office, "--unit", "furlong"],
        &["--unit", "mm, cm"],
    );
    refused(&["check", &office, "--layer", "roof=A"], &["wall=A-WALL*"]);
    refused(&["check", &office, "--close-gaps=-1"], &["--close-gaps"]);
    refused(
        &["check", &level_path("tiny.toml"), "--unit", "m"],
        &["tiny.toml", "--unit"],
    );
}

/// A hundred thousand entities: in a plan, and as a heap of lines all over each other.
#[test]
fn large_files_take_bounded_time() {
    let mut grid = String::from("0\nSECTION\n2\nENTITIES\n");
    let mut heap = grid.clone();
    let mut dice = Pcg64::seed_from_u64(8);
    let line = |a: f64, b: f64, c: f64, d: f64| {
        format!("0\nLINE\n8\nWALL\n10\n{a}\n20\n{b}\n11\n{c}\n21\n{d}\n")
    };
    for i in 0..100_000u32 {
        let (x, y) = (f64::from(i % 320) * 3000.0, f64::from(i / 320) * 3000.0);
        grid += &if i % 2 == 0 {
            line(x, y, x + 3000.0, y)
        } else {
            line(x, y, x, y + 3000.0)
        };
        let mut roll = || dice.random_range(0.0..50_000.0f64).round();
        heap += &line(roll(), roll(), roll(), roll());
    }
    for text in [&mut grid, &mut heap] {
        text.push_str("0\nENDSEC\n0\nEOF\n");
    }
    let read = |text: String| read_bytes(text.into_bytes(), "large.dxf", DrawingOptions::default());
    let level = read(grid).unwrap_or_else(|e| panic!("{e}"));
    assert!(level.walls.len() >= 100_000);
    let message = read(heap).unwrap_err().to_string();
    assert!(message.contains("cross each other more than"), "{message}");
}

/// What is changed, with the name under which it is read.
fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let tiny = read("tiny.toml");
    let graph = subdivide(&tiny, &Options::default());
    let pvs = sweep::sweep(&graph, &Progress::default());
    vec![
        ("tiny.toml", bytes("tiny.toml")),
        ("squares.wad", two_squares()),
        ("plan.dxf", small_dxf()),
        ("office.dxf", bytes("plans/office.dxf")),
        ("house.svg", bytes("plans/house.svg")),
        ("dungeon.dd2vtt", bytes("plans/dungeon.dd2vtt")),
        (
            "tiny.pvs",
            file::encode(&LevelInfo::of(&tiny), &graph, &pvs),
        ),
    ]
}

/// The part of the office that says most in the fewest bytes: its header, blocks and entities.
fn small_dxf() -> Vec<u8> {
    let text = String::from_utf8(bytes("plans/office.dxf")).expect("ezdxf writes UTF-8");
    let section = |name: &str| {
        let start = text
            .find(&format!("  0\nSECTION\n  2\n{name}\n"))
            .expect("it has the section");
        let end = text[start..].find("ENDSEC\n").expect("that ends") + start + "ENDSEC\n".len();
        text[start..end].to_string()
    };
    [
        section("HEADER"),
        section("BLOCKS"),
        section("ENTITIES"),
        "  0\nEOF\n".into(),
    ]
    .concat()
    .into_bytes()
}

/// One to four changes: a bit, a byte, a stretch left out, doubled or moved, a number made absurd, the
/// end cut off, another encoding.
fn changed(original: &[u8], dice: &mut Pcg64) -> Vec<u8> {
    const NUMBERS: [&str; 12] = [
        "nan",
        "inf",
        "-1",
        "0",
        "1e308",
        "-1e-308",
        "99999999999999999999",
        "4294967295",
        "0.1e-400",
        "1e15",
        "",
        "\u{1F4A5}",
    ];
    let mut bytes = original.to_vec();
    for _ in 0..dice.random_range(1..=4) {
        if bytes.is_empty() {
            break;
        }
        let at = dice.random_range(0..bytes.len());
        let end = (at + dice.random_range(1..200usize)).min(bytes.len());
        match dice.random_range(0..9) {
            0 => bytes[at] ^= 1 << dice.random_range(0..8),
            1 => bytes[at] = dice.random_range(0..=255),
            2 => _ = bytes.drain(at..end),
            3 => {
                let stretch = bytes[at..end].to_vec();
                bytes.splice(at..at, stretch);
            }
            4 => {
                let stretch: Vec<u8> = bytes.drain(at..end).collect();
                let to = dice.random_range(0..=bytes.len());
                bytes.splice(to..to, stretch);
            }
            5 | 6 => {
                let is_number = |b: &u8| b.is_ascii_digit() || *b == b'.' || *b == b'-';
                let start = at + bytes[at..].iter().position(is_number).unwrap_or(0);
                let long = bytes[start..].iter().take_while(|b| is_number(b)).count();
                let number = NUMBERS[dice.random_range(0..NUMBERS.len())];
                bytes.splice(start..start + long, number.bytes());
            }
            7 => bytes.truncate(at),
            _ if dice.random_range(0..20) == 0 => {
                bytes = bytes.iter().flat_map(|&b| [b, 0]).collect()
            }
            _ => bytes.insert(at, 0xff),
        }
    }
    bytes
}

#[test]
fn changed_files_are_read_or_refused_in_time() {
    let seconds = std::env::var("ENFILADE_FUZZ")
        .ok()
        .and_then(|s| s.parse().ok());
    let budget = Duration::from_secs(seconds.unwrap_or(4));
    let seeds = seeds();
    let start = Instant::now();
    let (mut read, mut refused, mut slowest) = (0, 0, Duration::ZERO);
    for seed in 0u64.. {
        if start.elapsed() > budget {
            break;
        }
        let (name, original) = &seeds[seed as usize % seeds.len()];
        let mut dice = Pcg64::seed_from_u64(seed);
        let bytes = changed(original, &mut dice);
        let before = Instant::now();
        if name.ends_with(".pvs") {
            match file::decode(&bytes) {
                Ok(_) => read += 1,
                Err(error) => {
                    refused += 1;
                    assert!(error.to_string().len() > 5, "{name}, seed {seed}: {error}");
                }
            }
            continue;
        }
        match Source::parse(bytes, name).and_then(|s| s.level(s.maps().first().map(String::as_str)))
        {
            Ok(level) => {
                read += 1;
                assert!(
                    level.findings.iter().all(|f| !f.places.is_empty()),
                    "{name}, seed {seed}"
                );
                if level.walls.len() < 400 {
                    let graph = subdivide(&level, &Options::default());
                    graph
                        .validate()
                        .unwrap_or_else(|e| panic!("{name}, seed {seed}: {e}"));
                }
            }
            Err(error) => {
                refused += 1;
                let text = error.to_string();
                assert!(
                    text.contains(*name) && text.len() < 2000,
                    "{name}, seed {seed}: {text}"
                );
            }
        }
        slowest = slowest.max(before.elapsed());
        // Far beyond what any needs, on whatever machine: something would have run away.
        assert!(
            before.elapsed() < Duration::from_secs(60),
            "{name}, seed {seed}"
        );
    }
    println!("{read} read, {refused} refused, the slowest in {slowest:?}");
    assert!(read > 10 && refused > 10, "{read} read, {refused} refused");
}
