//! `enfilade study visibility`: its files, and its page in a browser.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

use crate::browser::Browser;

/// A finished study.
pub struct Studied {
    _folder: TempDir,
    /// Its page.
    pub page: PathBuf,
    /// Its figures.
    pub json: Value,
}

/// Runs `enfilade study` of a kind on a sample level.
pub fn study(kind: &str, level: &str, further: &[&str]) -> Studied {
    let folder = TempDir::new().expect("there is room");
    let [page, json] = ["page.html", "study.json"].map(|name| folder.path().join(name));
    let level = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(level);
    let output = Command::cargo_bin("enfilade")
        .expect("the program is built")
        .args(["study", kind])
        .arg(level)
        .arg("-o")
        .arg(&page)
        .arg("--json")
        .arg(&json)
        .args(further)
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let text = fs::read(&json).expect("the JSON is written");
    Studied {
        _folder: folder,
        page,
        json: serde_json::from_slice(&text).expect("it is JSON"),
    }
}

/// A text's number: `12,345`, `0.0021 %`, `× 12`, and times in seconds. NaN where there is none.
fn number(text: &str) -> f64 {
    let text = text
        .replace([',', '≤', '>'], "")
        .replace(['\u{202f}', '×'], " ");
    let mut parts = text.split_whitespace();
    let Some(value) = parts.next().and_then(|n| n.parse::<f64>().ok()) else {
        return f64::NAN;
    };
    match parts.next() {
        Some("%") => value / 100.0,
        Some("ms" | "kB") => value * if text.contains("kB") { 1e3 } else { 1e-3 },
        Some("µs") => value * 1e-6,
        Some("MB") => value * 1e6,
        Some("s" | "B") | None => value,
        Some(unit) => panic!("a number in {unit}"),
    }
}

/// Whether a text says this number, as far as its digits go.
fn says(text: &str, wanted: &Value) -> bool {
    match wanted.as_f64() {
        None => number(text).is_nan(),
        Some(wanted) => (number(text) - wanted).abs() <= 0.06 * wanted.abs(),
    }
}

#[test]
fn the_page_says_what_the_json_says() {
    let studied = study("visibility", "tiny.toml", &["--budget", "20"]);
    let Some(browser) = Browser::start("the page of a study in a browser") else {
        return;
    };
    browser.resize(1200, 900);
    browser.open(&studied.page);
    assert_eq!(browser.complaints(), Vec::<String>::new());
    let page = studied.page.canonicalize().unwrap();
    assert_eq!(browser.requests(), [format!("file://{}", page.display())]);
    let rows = browser.run(
        "return [...document.querySelectorAll('table tbody tr')].map(row => [\
            row.closest('table').id, row.dataset.run, \
            Object.fromEntries([...row.querySelectorAll('[data-key]')]\
                .map(cell => [cell.dataset.key, cell.firstChild.textContent]))])",
    );
    let row = |table: &str, run: &Value| {
        let mut rows = rows.as_array().unwrap().iter();
        let found = rows.find(|r| r[0] == *table && r[1] == *run);
        found.unwrap_or_else(|| panic!("no row for {run} in {table}"))[2].clone()
    };
    let check = |cells: &Value, key: &str, wanted: &Value, run: &Value| {
        let text = cells[key]
            .as_str()
            .unwrap_or_else(|| panic!("{run}: no {key}"));
        assert!(says(text, wanted), "{run}: {key} is `{text}`, not {wanted}");
    };
    let mut n = 0;
    for run in studied.json["methods"].as_array().unwrap() {
        let (label, answer) = (&run["label"], &run["answer"]);
        let cells = row("methods", label);
        for key in [
            "pairs",
            "overestimate",
            "underestimate",
            "invented",
            "missed",
        ] {
            check(&cells, key, &answer[key], label);
        }
        check(&cells, "undecided", &answer["undecided_share"], label);
        check(&cells, "median", &run["seconds"]["median"], label);
        check(&cells, "relative", &run["relative"], label);
        check(&cells, "bytes", &run["bytes"], label);
        n += 1;
    }
    assert!(n >= 9, "{n} methods");
    for run in studied.json["subdivisions"].as_array().unwrap() {
        let cells = row("subdivisions", &run["subdivision"]);
        for key in ["cells", "portals", "pairs", "floor"] {
            check(&cells, key, &run[key], &run["subdivision"]);
        }
    }
    for run in studied.json["heights"]["runs"].as_array().unwrap() {
        let cells = row("heights", &run["label"]);
        check(&cells, "pairs", &run["answer"]["pairs"], &run["label"]);
        check(
            &cells,
            "undecided",
            &run["answer"]["undecided_share"],
            &run["label"],
        );
    }
}

#[test]
fn the_page_fits_screens_and_colour_schemes() {
    // A short budget: something is left out, and the page has to cope.
    let studied = study("visibility", "museum.toml", &["--budget", "5"]);
    let Some(browser) = Browser::start("the page of a study on a phone") else {
        return;
    };
    let (mut grounds, mut pictures) = (Vec::new(), Vec::new());
    for (width, height, scheme) in [
        (1280, 900, "light"),
        (1280, 900, "dark"),
        (390, 844, "light"),
    ] {
        browser.resize(width, height);
        browser.prefer(scheme);
        browser.open(&studied.page);
        let sizes = browser.run(
            "return [...document.querySelectorAll('svg')].map(svg => {\
                const box = svg.getBoundingClientRect(); return [box.width, box.height]; })",
        );
        let sizes = sizes.as_array().unwrap();
        assert!(sizes.len() >= 6, "{} pictures", sizes.len());
        for size in sizes {
            let [w, h] = [0, 1].map(|i| size[i].as_f64().unwrap());
            assert!(
                w >= 250.0 && h >= 150.0,
                "a picture of {w} × {h} at {width}"
            );
        }
        let over = browser.run(
            "const page = document.documentElement; return page.scrollWidth - page.clientWidth",
        );
        assert_eq!(over, 0, "wider than {width} px");
        // Texts of charts stay legible: 10 pixels, but for the browser's rounding of places.
        let text = browser.run(
            "return Math.min(...[...document.querySelectorAll('svg.chart text')]\
                .map(t => t.getBoundingClientRect().height))",
        );
        assert!(
            text.as_f64().unwrap() >= 9.99,
            "texts {text} px high at {width}"
        );
        grounds.push(browser.run("return getComputedStyle(document.body).backgroundColor"));
        pictures.push(browser.screenshot());
        assert_eq!(browser.complaints(), Vec::<String>::new());
    }
    // As PNGs begin, in base 64.
    assert!(pictures.iter().all(|p| p.starts_with("iVBORw0KGgo")));
    assert_ne!(pictures[0], pictures[1]);
    assert_ne!(grounds[0], grounds[1], "dark is another colour");
    assert_eq!(grounds[0], grounds[2]);
}

#[test]
fn mistakes_are_refused_before_anything_runs() {
    let folder = TempDir::new().unwrap();
    let page = folder
        .path()
        .join("page.html")
        .to_string_lossy()
        .into_owned();
    let tiny = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/tiny.toml");
    let tiny = tiny.to_string_lossy().into_owned();
    let outside = folder
        .path()
        .join("nowhere/page.html")
        .to_string_lossy()
        .into_owned();
    let cases: [(&[&str], &str); 6] = [
        (&["no-such.toml", "-o", &page], "no-such.toml"),
        (&[&tiny, "-o", &outside], "nowhere"),
        (&[&tiny, "-o", &page, "--json", &page], "different names"),
        (&[&tiny, "-o", "-", "--json", "-"], "standard output"),
        (&[&tiny, "-o", &page, "--budget", "0"], "--budget"),
        (&[&tiny], "--output"),
    ];
    for (arguments, part) in cases {
        let output = Command::cargo_bin("enfilade")
            .unwrap()
            .args(["study", "visibility"])
            .args(arguments)
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {errors}");
        assert!(errors.contains(part), "{arguments:?}: {errors}");
        assert!(output.stdout.is_empty());
    }
    assert_eq!(
        fs::read_dir(folder.path()).unwrap().count(),
        0,
        "nothing is left behind"
    );
}
