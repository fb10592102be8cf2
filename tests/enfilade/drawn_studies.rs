//! `enfilade study effects`, `antialiasing` and `structures`: their figures, and their pages in a
//! browser.

use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

use crate::browser::Browser;
use crate::study::{Studied, study};

/// The page needs nothing else, says nothing to the console, and fits a phone.
fn look_at(studied: &Studied, pictures: bool) {
    let Some(browser) = Browser::start("the page of a study in a browser") else {
        return;
    };
    for width in [1200, 400] {
        browser.resize(width, 900);
        browser.open(&studied.page);
        assert_eq!(browser.complaints(), Vec::<String>::new());
        let page = studied.page.canonicalize().unwrap();
        let requests = browser.requests();
        let own = format!("file://{}", page.display());
        let inside = |r: &String| *r == own || r.starts_with("data:");
        assert!(requests.iter().all(inside), "{requests:?}");
        let over = browser.run(
            "return document.documentElement.scrollWidth - document.documentElement.clientWidth",
        );
        assert_eq!(over, 0, "nothing sticks out at {width}");
        let broken = browser.run(
            "return [...document.images].filter(i => i.loading !== 'lazy' && !i.naturalWidth).length",
        );
        assert_eq!(broken, 0);
    }
    let n = browser.run("return document.images.length");
    assert_eq!(n.as_u64().unwrap() > 0, pictures);
}

#[test]
fn each_effect_is_left_out_in_turn() {
    let studied = study(
        "effects",
        "gallery.toml",
        &["--budget", "20", "--size", "96x60", "--samples", "1"],
    );
    let json = &studied.json;
    assert_eq!(json["kind"], "effects");
    // Simulating what nothing calls for changes no pixel.
    assert_eq!(json["all"]["difference"]["rmse"], 0.0);
    assert_eq!(json["full"]["difference"]["likeness"], 1.0);
    let mut needed = 0;
    for row in json["effects"].as_array().unwrap() {
        assert!(!row["reason"].as_str().unwrap().is_empty());
        if row["needed"] == true {
            needed += 1;
            let off = row["without"]["difference"]["rmse"].as_f64().unwrap();
            assert!(off > 0.0, "{row:#}");
        } else {
            assert!(row["without"].is_null());
        }
    }
    assert!(needed >= 4, "the gallery calls for {needed} effects");
    let rays = |of: &Value| {
        let kinds = ["primary", "shadow", "reflected", "refracted"];
        kinds.map(|kind| of["rays"][kind].as_u64().unwrap())
    };
    assert!(rays(&json["full"]).iter().all(|n| *n > 0));
    assert_eq!(rays(&json["none"])[1..], [0; 3]);
    look_at(&studied, true);
}

#[test]
fn error_falls_as_samples_rise() {
    let studied = study(
        "antialiasing",
        "gallery.toml",
        &["--budget", "60", "--size", "48x30", "--reference", "256"],
    );
    let json = &studied.json;
    assert_eq!(json["reference"]["samples"], 256);
    let group = |setting: &str| -> Vec<f64> {
        let groups = json["series"].as_array().unwrap();
        let found = groups.iter().find(|g| g["setting"] == setting);
        let runs = found.unwrap()["runs"].as_array().unwrap();
        runs.iter()
            .map(|r| r["difference"]["rmse"].as_f64().expect("there was time"))
            .collect()
    };
    let samples = group("samples");
    assert_eq!(samples.len(), 6);
    // Chance may turn two neighbours round, but not the ends.
    assert!(samples[5] < 0.5 * samples[0], "{samples:?}");
    let depth = group("depth");
    assert!(
        depth[0] > depth[5],
        "without mirrors it is another picture: {depth:?}"
    );
    assert!(group("adaptive")[3] < samples[0]);
    let threshold = group("threshold");
    assert!(threshold[4] <= threshold[0], "{threshold:?}");
    look_at(&studied, true);
}

#[test]
fn every_structure_gives_the_same_answers() {
    for level in ["still-life.toml", "museum.toml"] {
        let studied = study("structures", level, &["--budget", "12", "--size", "64x40"]);
        let rows = studied.json["rows"].as_array().unwrap();
        assert_eq!(rows.len(), 18);
        for row in rows {
            for cost in row["casts"].as_array().unwrap() {
                assert_eq!(cost["wrong"], 0, "{}", row["name"]);
                assert!(
                    cost["rays"].as_u64().unwrap() > 0 && cost["mrays"].as_f64().unwrap() > 0.0
                );
            }
        }
        let of = |name: &str, key: &str| {
            let row = rows.iter().find(|r| r["name"] == name).unwrap();
            row["casts"][0][key].as_f64().unwrap()
        };
        let primitives = studied.json["primitives"].as_f64().unwrap();
        assert!(of("brute", "tests") >= primitives * 0.99);
        assert!(of("portal walk", "cells") >= 1.0);
        if level == "museum.toml" {
            assert!(of("kd-area-stack", "tests") < primitives / 10.0);
            look_at(&studied, false);
        }
    }
}

#[test]
fn what_cannot_be_studied_is_said() {
    let level = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/tiny.toml");
    let folder = TempDir::new().unwrap();
    let page = folder.path().join("page.html");
    for (further, says) in [
        (&["--budget", "0"][..], "leaves no time"),
        (&["--camera", "nowhere"][..], "no camera"),
        (
            &["--eye", "1000,1000,1", "--look", "0,0,0"][..],
            "outside of the level",
        ),
        (&["--look", "0,0,0"][..], "--eye"),
    ] {
        let output = Command::cargo_bin("enfilade")
            .unwrap()
            .args(["study", "structures"])
            .arg(&level)
            .arg("-o")
            .arg(&page)
            .args(further)
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(says), "{further:?}: {errors}");
        assert!(!page.exists());
    }
}
