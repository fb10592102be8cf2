//! `enfilade report`: its figures against recomputation, its page in a browser, its exit status.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use assert_cmd::Command;
use enfilade::cells::{CellId, EdgeId, Options, subdivide};
use enfilade::level::read::Source;
use enfilade::pvs::{Progress, sweep};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::browser::Browser;

const FREEDOOM: &str = "/usr/share/games/doom/freedoom1.wad";
const FREEDOOM2: &str = "/usr/share/games/doom/freedoom2.wad";

struct Reported {
    _folder: TempDir,
    page: PathBuf,
    json_file: PathBuf,
    json: Value,
}

fn level(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(name)
}

fn report(level: &Path, further: &[&str]) -> Reported {
    let folder = TempDir::new().expect("there is room");
    let [page, json] = ["page.html", "report.json"].map(|name| folder.path().join(name));
    let output = Command::cargo_bin("enfilade")
        .expect("the program is built")
        .arg("report")
        .arg(level)
        .args(["-o".as_ref(), page.as_os_str()])
        .args(["--json".as_ref(), json.as_os_str()])
        .args(further)
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let text = fs::read(&json).expect("the JSON is written");
    Reported {
        _folder: folder,
        page,
        json_file: json,
        json: serde_json::from_slice(&text).expect("it is JSON"),
    }
}

fn freedoom(path: &'static str) -> Option<&'static Path> {
    let path = Path::new(path);
    if !path.exists() {
        assert!(
            std::env::var_os("CI").is_none(),
            "freedoom is not installed"
        );
        println!("{} is not there: a report of it is skipped", path.display());
        return None;
    }
    Some(path)
}

fn list<'a>(value: &'a Value, key: &str) -> &'a Vec<Value> {
    value[key].as_array().unwrap_or_else(|| panic!("no {key}"))
}

/// The ten openings that save most, closed for real: the PVS is computed anew.
fn openings_save_what_the_report_says(path: &Path, map: Option<&str>) {
    let further: Vec<&str> = map.iter().flat_map(|m| ["--map", *m]).collect();
    let reported = report(path, &[&further[..], &["--no-pictures"]].concat());
    let name = path.file_name().unwrap().to_string_lossy();
    let source = Source::parse(fs::read(path).unwrap(), &name).unwrap();
    let level = source.level(map).unwrap();
    let graph = subdivide(&level, &Options::default());
    let pvs = sweep::sweep(&graph, &Progress::default());
    let json = &reported.json;
    assert_eq!(json["visibility"]["pairs"], pvs.pairs());
    let of = |cell: CellId, key: &str| json["cells"][cell.0 as usize]["own"][key].as_f64().unwrap();
    let mut polygons = 0.0;
    let mut ground = 0.0;
    for a in graph.cell_ids() {
        for b in pvs.seen_from(a) {
            polygons += of(b, "polygons");
            ground += of(a, "area") * of(b, "area");
        }
    }
    let gaps = list(json, "openings");
    let mut checked = 0;
    for (number, gap) in gaps.iter().enumerate().take(10) {
        let edges: Vec<EdgeId> = list(gap, "portals")
            .iter()
            .map(|p| graph.portals[p.as_u64().unwrap() as usize].edges[0])
            .collect();
        let less = sweep::sweep(&graph.closed(&edges), &Progress::default());
        let (mut pairs, mut lost_polygons, mut lost_ground) = (0u64, 0.0, 0.0);
        for a in graph.cell_ids() {
            for b in pvs.seen_from(a).filter(|&b| !less.sees(a, b)) {
                pairs += 1;
                lost_polygons += of(b, "polygons");
                lost_ground += of(a, "area") * of(b, "area");
            }
        }
        let title = &gap["title"];
        assert_eq!(gap["pairs"], pairs, "{title}");
        let near = |key: &str, wanted: f64| {
            let said = gap[key].as_f64().unwrap();
            assert!(
                (said - wanted).abs() <= 1e-9,
                "{title}: {key} {said}, not {wanted}"
            );
        };
        near("share", pairs as f64 / pvs.pairs() as f64);
        if polygons > 0.0 {
            near("polygons_share", lost_polygons / polygons);
        }
        near("ground_share", lost_ground / ground);
        for place in list(json, "worst") {
            let cell = CellId(place["cell"].as_u64().unwrap() as u32);
            let hidden = pvs.seen_from(cell).filter(|&b| !less.sees(cell, b));
            let hidden = hidden.count() as f64;
            let said = list(place, "openings").iter().find(|h| h["gap"] == number);
            if let Some(said) = said {
                assert_eq!(said["cells"], hidden, "{title} from cell {}", cell.0);
            }
        }
        checked += 1;
    }
    assert!(checked >= 3, "{name} has only {checked} openings");
}

#[test]
fn closing_an_opening_saves_what_the_report_says() {
    openings_save_what_the_report_says(&level("museum.toml"), None);
    openings_save_what_the_report_says(&level("house.toml"), None);
    if let Some(path) = freedoom(FREEDOOM) {
        openings_save_what_the_report_says(path, Some("E1M1"));
    }
}

#[test]
fn sums_are_those_of_the_visible_sets() {
    let json = report(&level("office.toml"), &[]).json;
    let (cells, visible) = (list(&json, "cells"), list(&json, "visible"));
    let mut by_room = std::collections::BTreeMap::new();
    for (cell, row) in cells.iter().zip(visible) {
        let row = row.as_array().unwrap();
        for key in ["cells", "polygons", "walls", "area", "wall_length"] {
            let own = |i: &Value| {
                cells[i.as_u64().unwrap() as usize]["own"][key]
                    .as_f64()
                    .unwrap()
            };
            let sum: f64 = row.iter().map(own).sum();
            let said = cell["seen"][key].as_f64().unwrap();
            assert!((sum - said).abs() <= 1e-9 * sum, "{key}: {said}, not {sum}");
        }
        for other in row {
            let other = &cells[other.as_u64().unwrap() as usize];
            *by_room
                .entry((cell["room"].as_u64(), other["room"].as_u64()))
                .or_insert(0u64) += 1;
        }
    }
    let mut n = 0;
    for (i, room) in list(&json, "rooms").iter().enumerate() {
        for sees in list(room, "sees") {
            let wanted = by_room[&(Some(i as u64), sees[0].as_u64())];
            assert_eq!(sees[1], wanted);
            n += 1;
        }
    }
    assert_eq!(n, by_room.len());
}

#[test]
fn budgets_decide_the_exit_status() {
    let run = |further: &[&str]| {
        let mut command = Command::cargo_bin("enfilade").expect("the program is built");
        command.arg("report").arg(level("tiny.toml")).args(further);
        command.output().expect("the program starts")
    };
    let kept = run(&["--max-visible-cells", "100000", "--max-density", "1"]);
    assert_eq!(kept.status.code(), Some(0));
    let text = String::from_utf8_lossy(&kept.stdout);
    assert!(text.contains("within budget: max_visible_cells"), "{text}");
    let over = run(&[
        "--max-visible-cells",
        "1",
        "--max-sightline",
        "0.5",
        "--quiet",
    ]);
    assert_eq!(over.status.code(), Some(1));
    let text = String::from_utf8_lossy(&over.stdout);
    assert_eq!(text.lines().count(), 2, "{text}");
    assert!(text.contains("over budget: max_visible_cells"), "{text}");
    let folder = TempDir::new().unwrap();
    let junit = folder.path().join("budget.xml");
    let over = run(&[
        "--max-visible-cells",
        "1",
        "--max-density",
        "1",
        "--junit",
        junit.to_str().unwrap(),
    ]);
    assert_eq!(over.status.code(), Some(1));
    let xml = fs::read_to_string(junit).unwrap();
    assert!(
        xml.contains("tests=\"2\"") && xml.contains("failures=\"1\""),
        "{xml}"
    );
    // In the level's own file.
    let own = folder.path().join("own.toml");
    let text = fs::read_to_string(level("tiny.toml")).unwrap();
    fs::write(&own, format!("{text}\n[budget]\nmax_visible_cells = 1\n")).unwrap();
    let mut command = Command::cargo_bin("enfilade").expect("the program is built");
    let output = command.arg("report").arg(&own).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    // What is given on the command line comes first.
    let mut command = Command::cargo_bin("enfilade").expect("the program is built");
    command
        .arg("report")
        .arg(&own)
        .args(["--max-visible-cells", "999"]);
    assert_eq!(command.output().unwrap().status.code(), Some(0));
}

const TWO_ROOMS: &str = "name = \"Two\"\n[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
    [[room]]\nname = \"B\"\nrect = [4, 0, 10, 4]\n";

#[test]
fn a_baseline_is_matched_by_place() {
    let folder = TempDir::new().unwrap();
    let [open, shut] = ["open.toml", "shut.toml"].map(|n| folder.path().join(n));
    let door = "[[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n";
    fs::write(&open, format!("{TWO_ROOMS}{door}")).unwrap();
    fs::write(&shut, TWO_ROOMS).unwrap();
    let before = report(&open, &[]);
    // The same level, cut in another way: other cells, but the same places.
    let baseline = before.json_file.to_str().unwrap();
    let same = report(&open, &["--baseline", baseline]).json;
    assert_eq!(same["comparison"]["changed"], 0);
    let after = report(&shut, &["--baseline", baseline]).json;
    let comparison = &after["comparison"];
    assert_eq!(comparison["mean_ground_before"], 40.0);
    // In A, 16 of 40 square metres, one sees 16; in B, 24.
    assert!(
        (comparison["mean_ground_after"].as_f64().unwrap() - (16.0 * 16.0 + 24.0 * 24.0) / 40.0)
            .abs()
            < 1e-9
    );
    assert_eq!(list(comparison, "grown").len(), 0);
    assert_eq!(list(comparison, "shrunk")[0]["lost"], 24.0);
    assert_eq!(
        comparison["changed"],
        after["cells"].as_array().unwrap().len()
    );
    // The report before has said so.
    let gap = &before.json["openings"][0];
    let predicted = 1.0 - gap["ground_share"].as_f64().unwrap();
    let share = comparison["mean_ground_after"].as_f64().unwrap() / 40.0;
    assert!((predicted - share).abs() < 1e-12, "{predicted} {share}");
    // Nonsense is refused with a sentence.
    let wrong = folder.path().join("wrong.json");
    fs::write(&wrong, "{\"format\": \"enfilade.walk\"}").unwrap();
    let mut command = Command::cargo_bin("enfilade").expect("the program is built");
    command
        .arg("report")
        .arg(&open)
        .arg("--baseline")
        .arg(&wrong);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("is no baseline"));
}

/// Zooms to a cell and clicks its middle. (The coordinates of clicks are whole pixels.)
fn click(browser: &Browser, cell: u64) {
    let script = format!(
        "const plan = document.getElementById('plan'); plan.scrollIntoView({{block: 'center'}}); enfilade.frame({cell});\
         const m = plan.getScreenCTM(), [x, y] = enfilade.onPlan(enfilade.middle({cell}));\
         const at = {{clientX: m.a * x + m.e, clientY: m.d * y + m.f, bubbles: true, pointerId: 1}};\
         for (const kind of ['pointermove', 'pointerdown', 'pointerup']) plan.dispatchEvent(new PointerEvent(kind, at));\
         plan.dispatchEvent(new MouseEvent('click', at));"
    );
    browser.run(&script);
}

fn wait_until_ready(browser: &Browser) {
    let began = Instant::now();
    while browser.run("return document.documentElement.dataset.ready || ''") != "yes" {
        assert!(began.elapsed().as_secs() < 60, "{:?}", browser.complaints());
    }
}

#[test]
fn the_page_shows_what_the_json_says() {
    let reported = report(&level("museum.toml"), &[]);
    let Some(browser) = Browser::start("the page of a report in a browser") else {
        return;
    };
    browser.resize(1200, 900);
    browser.open(&reported.page);
    wait_until_ready(&browser);
    let page = reported.page.canonicalize().unwrap();
    assert_eq!(browser.requests(), [format!("file://{}", page.display())]);
    let visible = list(&reported.json, "visible");
    let n = visible.len() as u64;
    // Every row of the data; then clicks.
    for cell in 0..n {
        let row = browser.run(&format!("return enfilade.seenFrom({cell})"));
        assert_eq!(row, visible[cell as usize], "cell {cell}");
    }
    let mut lines = 0;
    for k in 0..24u64 {
        let (a, b) = (k * 37 % n, (k * 101 + 13) % n);
        browser.run("enfilade.clear()");
        click(&browser, a);
        let shown = browser.run(
            "return [enfilade.state.source, enfilade.state.seen,\
             (document.getElementById('seen').getAttribute('d').match(/Z/g) || []).length]",
        );
        assert_eq!(shown[0], a);
        assert_eq!(shown[1], visible[a as usize]);
        assert_eq!(shown[2], visible[a as usize].as_array().unwrap().len() - 1);
        if a == b {
            continue;
        }
        click(&browser, b);
        let shown = browser.run(
            "const s = enfilade.state; return [s.second, s.line && [s.line.from, s.line.to],\
             document.getElementById('told-title').textContent]",
        );
        assert_eq!(shown[0], b);
        let sees = visible[a as usize].as_array().unwrap().contains(&json!(b));
        let title = shown[2].as_str().unwrap();
        assert_eq!(title.starts_with("Visible"), sees, "{title}");
        lines += usize::from(sees && !shown[1].is_null());
    }
    assert!(lines > 3, "only {lines} sightlines were drawn");
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// Lines that the page draws, checked exactly.
#[test]
fn sightlines_of_the_page_are_free() {
    let path = level("museum.toml");
    let reported = report(&path, &["--no-pictures"]);
    let Some(browser) = Browser::start("sightlines of a page") else {
        return;
    };
    browser.open(&reported.page);
    wait_until_ready(&browser);
    let level = Source::parse(fs::read(&path).unwrap(), "museum.toml").unwrap();
    let level = level.level(None).unwrap();
    let graph = subdivide(&level, &Options::default());
    let pvs = sweep::sweep(&graph, &Progress::default());
    let n = graph.cells.len() as u64;
    let (mut asked, mut found) = (0, 0);
    for k in 0..600u64 {
        let (a, b) = (k * 7919 % n, (k * 104_729 + 5) % n);
        if a == b || !pvs.sees(CellId(a as u32), CellId(b as u32)) {
            continue;
        }
        asked += 1;
        let line = browser.run(&format!(
            "const l = enfilade.witness({a}, {b}); return l && [l.from, l.to]"
        ));
        if line.is_null() {
            println!("no line from {a} to {b}");
            continue;
        }
        found += 1;
        let point = |p: &Value| {
            let p = glam::DVec2::new(p[0].as_f64().unwrap(), p[1].as_f64().unwrap());
            enfilade::pvs::explain::Point::from(&graph.grid.fine(p).unwrap())
        };
        let segment = enfilade::pvs::explain::Segment {
            from: point(&line[0]),
            to: point(&line[1]),
        };
        let chain = segment.portals(&graph, CellId(a as u32));
        let chain = chain.unwrap_or_else(|| panic!("{a} to {b}: {line} meets a wall"));
        let last = chain.last().and_then(|&e| graph.edge(e).twin());
        assert_eq!(last.map(|e| graph.edge(e).cell), Some(CellId(b as u32)));
    }
    println!("{found} of {asked} sightlines found by the page");
    assert!(asked > 50 && found == asked, "{found} of {asked}");
}

#[test]
fn the_page_in_both_schemes_and_on_a_phone() {
    let reported = report(&level("museum.toml"), &["--max-visible-cells", "10000"]);
    let Some(browser) = Browser::start("pictures of a report") else {
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    for (name, scheme, width) in [
        ("light", "light", 1200),
        ("dark", "dark", 1200),
        ("phone", "light", 390),
    ] {
        browser.prefer(scheme);
        browser.resize(width, 900);
        browser.open(&reported.page);
        wait_until_ready(&browser);
        browser.run("enfilade.pick(3); document.getElementById('plan-section').scrollIntoView()");
        let wide = browser.run("return document.documentElement.scrollWidth - innerWidth");
        assert!(
            wide.as_f64().unwrap() <= 0.0,
            "{name}: {wide} pixels too wide"
        );
        let picture = browser.screenshot();
        let png = base64::Engine::decode(&base64::prelude::BASE64_STANDARD, picture).unwrap();
        fs::write(folder.join(format!("report-{name}.png")), &png).unwrap();
        let ground = browser.run("return getComputedStyle(document.body).backgroundColor");
        let dark = ground == "rgb(20, 23, 27)";
        assert_eq!(dark, scheme == "dark", "{ground}");
        check_accessibility(&browser, name);
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

/// axe-core, which `.ci/run` fetches (MPL-2.0, and large: it is not kept here).
fn check_accessibility(browser: &Browser, name: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/axe.min.js");
    let Ok(axe) = fs::read_to_string(&path) else {
        assert!(
            std::env::var_os("CI").is_none(),
            "{} is not there",
            path.display()
        );
        println!(
            "{} is not there: accessibility is not checked",
            path.display()
        );
        return;
    };
    browser.run(&axe);
    browser.run("window.found = null; axe.run().then(r => window.found = r.violations, e => window.found = [String(e)])");
    let began = Instant::now();
    loop {
        let found = browser.run(
            "return window.found && window.found.map(v => v.id ? [v.id, v.help, v.nodes.slice(0, 3).map(n => n.html.slice(0, 200))] : v)",
        );
        if !found.is_null() {
            assert_eq!(found, json!([]), "{name}: {found:#}");
            return;
        }
        assert!(began.elapsed().as_secs() < 100, "axe takes too long");
    }
}

#[test]
fn a_large_map_stays_small_and_quick() {
    let Some(path) = freedoom(FREEDOOM2) else {
        return;
    };
    let began = Instant::now();
    let reported = report(path, &["--map", "MAP12"]);
    let seconds = began.elapsed().as_secs_f64();
    let bytes = fs::metadata(&reported.page).unwrap().len();
    println!(
        "MAP12: report in {seconds:.1} s, page of {:.2} MB",
        bytes as f64 / 1e6
    );
    assert!(bytes <= 10_000_000, "{bytes} bytes");
    let Some(browser) = Browser::start("the page of a large map") else {
        return;
    };
    browser.resize(1200, 900);
    browser.open(&reported.page);
    wait_until_ready(&browser);
    let times = browser.run(
        "const t = performance.getEntriesByName('first-contentful-paint')[0];\
         const began = performance.now(); enfilade.pick(100); const picked = performance.now();\
         return [t && t.startTime, picked - began]",
    );
    println!(
        "MAP12: first paint after {} ms, a choice takes {} ms",
        times[0], times[1]
    );
    let row = browser.run("return enfilade.seenFrom(100)");
    assert_eq!(row, list(&reported.json, "visible")[100]);
    assert_eq!(browser.complaints(), Vec::<String>::new());
}
