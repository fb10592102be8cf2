//! The readers meet whatever bytes there are: they read it or refuse it with a message, and what they
//! read goes all the way to a PVS. Nothing panics, and the input's size bounds the work.

use std::fs;
use std::path::Path;

use enfilade::cells::{Options, subdivide};
use enfilade::level::wad::Wad;
use enfilade::level::{Level, doom, snap, toml};
use enfilade::pvs::file::{self, LevelInfo};
use enfilade::pvs::sweep::sweep;
use enfilade::pvs::{Progress, Pvs};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::RngSeed;

fn runs(cases: u32) -> ProptestConfig {
    let factor = std::env::var("ENFILADE_CASES")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(1);
    let mut config = ProptestConfig {
        cases: cases * factor,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(1_993);
    }
    config
}

pub fn sample(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(path);
    fs::read_to_string(path).expect("the level is there")
}

/// Whatever was read must be sound.
fn solve(level: &Level) -> Pvs {
    let graph = subdivide(level, &Options::default());
    graph.validate().unwrap_or_else(|flaw| panic!("{flaw}"));
    let pvs = sweep(&graph, &Progress::default());
    pvs.validate(&graph).unwrap_or_else(|flaw| panic!("{flaw}"));
    pvs
}

/// Whether it was read; a refusal must say something.
fn read_toml(text: &str) -> bool {
    match toml::read(text, "any.toml") {
        Ok(level) => {
            solve(&level);
            true
        }
        Err(error) => {
            assert!(error.to_string().len() > 10, "says little: {error}");
            false
        }
    }
}

/// How many maps of the WAD were read.
fn read_wad(bytes: Vec<u8>) -> usize {
    let Ok(wad) = Wad::parse(bytes) else { return 0 };
    let drafts = wad
        .maps()
        .into_iter()
        .map(|map| doom::read_map(&wad, &map.name, "any.wad"));
    let levels = drafts
        .filter_map(Result::ok)
        .filter_map(|draft| snap::snap(draft).ok());
    levels.inspect(|level| _ = solve(level)).count()
}

pub fn wad(lumps: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = b"PWAD".to_vec();
    let content: usize = lumps.iter().map(|(_, data)| data.len()).sum();
    bytes.extend((lumps.len() as u32).to_le_bytes());
    bytes.extend((12 + content as u32).to_le_bytes());
    let mut directory = Vec::new();
    for (name, data) in lumps {
        directory.extend((bytes.len() as u32).to_le_bytes());
        directory.extend((data.len() as u32).to_le_bytes());
        let mut padded = [0u8; 8];
        padded[..name.len()].copy_from_slice(name.as_bytes());
        directory.extend(padded);
        bytes.extend(data);
    }
    bytes.extend(directory);
    bytes
}

fn words(numbers: &[i16]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// Two square sectors side by side, in Doom's layout.
pub fn two_squares() -> Vec<u8> {
    let vertexes = words(&[0, 0, 128, 0, 256, 0, 256, 128, 128, 128, 0, 128]);
    let line = |from, to, back: i16| {
        let flags = if back < 0 { 1 } else { 4 };
        words(&[
            from,
            to,
            flags,
            0,
            0,
            if from == 1 && to == 4 { 2 } else { 0 },
            back,
        ])
    };
    let ends = [(1, 0), (0, 5), (5, 4), (4, 3), (3, 2), (2, 1), (1, 4)];
    let linedefs = ends
        .iter()
        .flat_map(|&(a, b)| line(a, b, if (a, b) == (1, 4) { 1 } else { -1 }))
        .collect();
    let side = |sector: i16| {
        let mut bytes = words(&[0, 0]);
        bytes.extend(b"-\0\0\0\0\0\0\0-\0\0\0\0\0\0\0WALL\0\0\0\0");
        bytes.extend(words(&[sector]));
        bytes
    };
    let sector = |floor: i16| {
        let mut bytes = words(&[floor, 128]);
        bytes.extend(b"FLOOR\0\0\0CEIL\0\0\0\0");
        bytes.extend(words(&[160, 0, 0]));
        bytes
    };
    wad(&[
        ("E1M1", Vec::new()),
        ("THINGS", words(&[64, 64, 0, 1, 7])),
        ("LINEDEFS", linedefs),
        ("SIDEDEFS", [side(0), side(1), side(1)].concat()),
        ("VERTEXES", vertexes),
        ("SECTORS", [sector(0), sector(16)].concat()),
    ])
}

const UDMF: &str = r#"namespace = "Doom";
vertex { x = 0.0; y = 0.0; } // one
vertex { x = 128.5; y = 0.0; }
vertex { x = 0.0; y = 128.25; } /* three */
linedef { v1 = 1; v2 = 0; sidefront = 0; blocking = true; }
linedef { v1 = 0; v2 = 2; sidefront = 0; blocking = true; }
linedef { v1 = 2; v2 = 1; sidefront = 0; blocking = true; }
sidedef { sector = 0; texturemiddle = "WALL"; }
sector { heightfloor = 0; heightceiling = 128; texturefloor = "F"; textureceiling = "C"; }
thing { x = 32.0; y = 32.0; type = 1; }
"#;

fn udmf(text: &[u8]) -> Vec<u8> {
    wad(&[
        ("MAP01", Vec::new()),
        ("TEXTMAP", text.to_vec()),
        ("ENDMAP", Vec::new()),
    ])
}

/// A change to some bytes: another byte in place, one more, one less, or a copied stretch.
fn changed(bytes: &[u8], changes: &[(Index, u8, u8)]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for &(at, what, byte) in changes {
        if bytes.is_empty() {
            break;
        }
        let i = at.index(bytes.len());
        match what % 5 {
            0 | 1 => bytes[i] = byte,
            2 => bytes.insert(i, byte),
            3 => _ = bytes.remove(i),
            _ => {
                let copy = bytes[i..(i + usize::from(byte)).min(bytes.len())].to_vec();
                bytes.splice(i..i, copy);
            }
        }
    }
    bytes
}

fn changes(most: usize) -> impl Strategy<Value = Vec<(Index, u8, u8)>> {
    let printable = prop_oneof![3 => 32..127u8, 1 => Just(b'\n'), 1 => any::<u8>()];
    prop::collection::vec((any::<Index>(), any::<u8>(), printable), 1..=most)
}

#[test]
fn what_the_changes_start_from_is_read() {
    assert!(read_toml(&sample("tiny.toml")));
    assert_eq!(read_wad(two_squares()), 1);
    assert_eq!(read_wad(udmf(UDMF.as_bytes())), 1);
}

#[test]
fn files_cut_off_anywhere() {
    for text in [sample("tiny.toml"), sample("hard/pinwheel.toml")] {
        let cut = (0..text.len()).filter(|&n| text.is_char_boundary(n));
        let read = cut.filter(|&n| read_toml(&text[..n])).count();
        assert!(
            read < text.len() / 2,
            "{read} of {} beginnings pass for levels",
            text.len()
        );
    }
    let whole = two_squares();
    // Without its directory a WAD is none.
    assert_eq!(
        (0..whole.len())
            .map(|n| read_wad(whole[..n].to_vec()))
            .sum::<usize>(),
        0
    );
    for n in 0..UDMF.len() {
        read_wad(udmf(&UDMF.as_bytes()[..n]));
    }
}

proptest! {
    #![proptest_config(runs(4000))]

    #[test]
    fn toml_with_changes(changes in changes(4), which in 0..4usize) {
        let name = ["tiny.toml", "hard/shared-vertex.toml", "hard/pinwheel.toml", "hard/duplicate-walls.toml"];
        let bytes = changed(sample(name[which]).as_bytes(), &changes);
        read_toml(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn toml_with_other_numbers(
        numbers in prop::collection::vec((any::<Index>(), prop_oneof![
            (-9..10i32).prop_map(|n| n.to_string()),
            (-99..100i32).prop_map(|n| format!("{}", f64::from(n) / 7.0)),
            any::<f64>().prop_map(|x| format!("{x:e}")),
            prop::sample::select(vec!["nan", "inf", "1e308", "-0.0", "5e-324", "9007199254740991", "1e-9"])
                .prop_map(String::from),
        ]), 1..4),
        which in 0..3usize,
    ) {
        let text = sample(["tiny.toml", "hard/pinwheel.toml", "hard/t-junction.toml"][which]);
        let (comment, rest) = text.split_at(text.find("\n[[").unwrap_or(0));
        let is_number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
        let mut rest = rest.to_string();
        for (at, number) in numbers {
            let starts: Vec<usize> = rest
                .char_indices()
                .filter(|&(i, c)| is_number(c) && !rest[..i].ends_with(is_number))
                .map(|(i, _)| i)
                .collect();
            let start = starts[at.index(starts.len())];
            let len = rest[start..].find(|c| !is_number(c)).unwrap_or(rest.len() - start);
            rest.replace_range(start..start + len, &number);
        }
        read_toml(&format!("{comment}{rest}"));
    }

    #[test]
    fn wads_with_changes(changes in changes(6)) {
        read_wad(changed(&two_squares(), &changes));
    }

    #[test]
    fn text_maps_with_changes(changes in changes(6)) {
        read_wad(udmf(&changed(UDMF.as_bytes(), &changes)));
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..600), kind in 0..4u8) {
        match kind {
            0 => _ = read_toml(&String::from_utf8_lossy(&bytes)),
            1 => _ = read_wad(bytes),
            2 => _ = read_wad(udmf(&bytes)),
            _ => prop_assert!(file::decode(&bytes).is_err()),
        }
    }

    /// A changed PVS is refused, whatever was changed; never read as a wrong one.
    #[test]
    fn pvs_files_with_changes(changes in changes(3), flip in any::<Option<(Index, u8)>>()) {
        let bytes = pvs_file();
        let mut other = match flip {
            None => changed(bytes, &changes),
            Some(_) => bytes.to_vec(),
        };
        if let Some((at, bit)) = flip {
            other[at.index(bytes.len())] ^= 1 << (bit % 8);
        }
        prop_assume!(other != bytes);
        prop_assert!(file::decode(&other).is_err());
    }
}

/// The sample level's PVS as a file.
fn pvs_file() -> &'static [u8] {
    static BYTES: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    BYTES.get_or_init(|| {
        let level = toml::read(&sample("tiny.toml"), "tiny.toml").expect("a sample is sound");
        let graph = subdivide(&level, &Options::default());
        let bytes = file::encode(&LevelInfo::of(&level), &graph, &solve(&level));
        let back = file::decode(&bytes).expect("what was written is read");
        assert_eq!(back.pvs.visible, solve(&level).visible);
        bytes
    })
}

#[test]
fn pvs_files_cut_off_anywhere_are_refused() {
    let bytes = pvs_file();
    for n in 0..bytes.len() {
        assert!(
            file::decode(&bytes[..n]).is_err(),
            "cut off after {n} bytes"
        );
    }
}
