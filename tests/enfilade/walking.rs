//! The command `walk` as people and scripts meet it, and its frames against rays.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use enfilade::level::Level;
use enfilade::preview::canvas::NOTHING;
use enfilade::preview::{Easel, Finish, Options, Painter};
use enfilade::trace::Tracer;
use enfilade::trace::camera::Camera;
use enfilade::trace::effects::survey;
use enfilade::trace::render::{RenderOptions, render};
use enfilade::trace::world::Departure;
use enfilade::walk::frame::{Counts, Guide};
use enfilade::walk::{Person, TrackOptions, opened, tour};
use glam::DVec2;
use serde_json::Value;

use crate::cli::{enfilade, level, refused};
use crate::preview::{first, same};
use crate::scene::{FREEDOOM, Scene};

const ROOMS: &str = "name = \"two rooms\"\n\
    [[room]]\nname = \"A\"\nrect = [0, 0, 6, 4]\n\
    [[room]]\nname = \"B\"\nrect = [6, 0, 12, 4]\n\
    [[archway]]\nbetween = [\"A\", \"B\"]\nwidth = 2\ntop = 2.2\n\
    [[path]]\nname = \"through\"\npoints = [[1, 2, 1.6], [11, 2, 1.6]]\nseconds = 2\n";

/// A folder with a level in it.
fn rooms(more: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rooms.toml");
    fs::write(&file, format!("{ROOMS}{more}")).unwrap();
    let file = file.to_string_lossy().into_owned();
    (folder, file)
}

/// Runs a walk of small frames, five a second; standard output.
fn walk(file: &str, to: &Path, more: &[&str]) -> String {
    let to = to.to_string_lossy();
    let mut arguments = vec!["walk", file, "-o", &to, "--fps", "5"];
    for usual in [["--size", "48x30"], ["--renderer", "preview"]] {
        if !more.contains(&usual[0]) {
            arguments.extend(usual);
        }
    }
    arguments.extend(more);
    let output = enfilade(&arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The names of all files in a folder, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name());
    let mut names: Vec<String> = entries.map(|n| n.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn pixels(folder: &Path, frame: u32) -> Vec<u8> {
    let picture = image::open(folder.join(format!("frame-{frame:05}.png"))).unwrap();
    assert_eq!((picture.width(), picture.height()), (48, 30));
    picture.to_rgb8().into_raw()
}

#[test]
fn frames_are_numbered_and_kept() {
    let (folder, file) = rooms("");
    let frames = folder.path().join("frames");
    let text = walk(&file, &frames, &[]);
    for part in [
        "path `through`, 10.0 m in 2.0 s: 10 frames of 48 × 30, 5 a second",
        "10 drawn, 0 kept",
        "culling",
        "reuse",
        "seconds     read",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    let expected: Vec<String> = (0..10).map(|k| format!("frame-{k:05}.png")).collect();
    assert_eq!(names(&frames), expected);
    // They differ: the eye moves.
    let all: Vec<Vec<u8>> = (0..10).map(|k| pixels(&frames, k)).collect();
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
    // Again: all are there.
    assert!(walk(&file, &frames, &[]).contains("0 drawn, 10 kept"));
    // One is lost, one is cut off in the middle, one is somebody else's.
    fs::remove_file(frames.join("frame-00003.png")).unwrap();
    let half = fs::read(frames.join("frame-00005.png")).unwrap();
    fs::write(frames.join("frame-00005.png"), &half[..half.len() / 2]).unwrap();
    image::RgbImage::new(48, 30)
        .save(frames.join("frame-00007.png"))
        .unwrap();
    assert!(walk(&file, &frames, &[]).contains("3 drawn, 7 kept"));
    let again: Vec<Vec<u8>> = (0..10).map(|k| pixels(&frames, k)).collect();
    assert!(all == again);
    // Another angle of view, another level: nothing is kept.
    assert!(walk(&file, &frames, &["--fov", "50"]).contains("10 drawn, 0 kept"));
    fs::write(&file, ROOMS.replace("2.2", "2.3")).unwrap();
    assert!(walk(&file, &frames, &["--fov", "50"]).contains("10 drawn, 0 kept"));
    // A shorter walk takes the rest away, but nothing that is not its own.
    image::RgbImage::new(2, 2)
        .save(frames.join("frame-00042.png"))
        .unwrap();
    let text = walk(&file, &frames, &["--fov", "50", "--to", "1"]);
    assert!(
        text.contains("0 drawn, 5 kept, 5 of a longer walk taken away"),
        "{text}"
    );
    assert_eq!(names(&frames).len(), 6);
}

#[test]
fn an_interrupted_walk_goes_on() {
    let (folder, file) = rooms("");
    let [broken, whole] = ["broken", "whole"].map(|n| folder.path().join(n));
    let arguments = |to: &Path| {
        let to = to.to_string_lossy().into_owned();
        let fixed = ["walk", &file, "-o", &to, "--size", "160x100", "--fps", "20"];
        let fixed = fixed.map(str::to_string);
        [
            &fixed[..],
            &["--samples".into(), "16".into(), "--quiet".into()],
        ]
        .concat()
    };
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(arguments(&broken))
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    let count = || fs::read_dir(&broken).map_or(0, Iterator::count);
    while count() < 3 && start.elapsed() < Duration::from_secs(120) {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let there = names(&broken);
    assert!(there.len() >= 3, "{there:?}");
    // Whatever has a frame's name is whole.
    for name in there.iter().filter(|n| n.starts_with("frame-")) {
        image::open(broken.join(name)).unwrap();
    }
    for to in [&broken, &whole] {
        let arguments = arguments(to);
        let run = Command::new(env!("CARGO_BIN_EXE_enfilade"))
            .args(arguments)
            .output();
        assert!(run.unwrap().status.success());
    }
    for k in 0..40 {
        let name = format!("frame-{k:05}.png");
        let [a, b] = [&broken, &whole].map(|f| image::open(f.join(&name)).unwrap());
        assert!(a == b, "{name}");
    }
}

#[test]
fn a_gif_of_all_frames() {
    let (folder, file) = rooms("");
    let gif = folder.path().join("walk.gif");
    walk(&file, &gif, &[]);
    assert_eq!(names(folder.path()), ["rooms.toml", "walk.gif"]);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(fs::File::open(&gif).unwrap()).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (48, 30));
    let (mut n, mut delay) = (0, 0);
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        n += 1;
        delay += frame.delay;
    }
    assert_eq!((n, delay), (10, 200));
    // The frames stay if that is asked for, and are then kept.
    walk(&file, &gif, &["--keep-frames"]);
    assert_eq!(names(folder.path()).len(), 3);
    assert!(walk(&file, &gif, &[]).contains("0 drawn, 10 kept"));
    assert_eq!(names(folder.path()).len(), 2);
}

#[test]
fn a_film_of_all_frames() {
    let (folder, file) = rooms("");
    let film = folder.path().join("walk.mp4");
    if Command::new("ffmpeg").arg("-version").output().is_err() {
        assert!(std::env::var_os("CI").is_none(), "CI needs ffmpeg");
        eprintln!("skipped: ffmpeg is not on the path (apt-get install ffmpeg)");
    } else {
        // Odd sizes too.
        walk(&file, &film, &["--size", "49x31"]);
        assert_eq!(names(folder.path()), ["rooms.toml", "walk.mp4"]);
        let probe = Command::new("ffprobe")
            .args(["-v", "error", "-count_frames", "-select_streams", "v:0"])
            .args([
                "-show_entries",
                "stream=nb_read_frames,width,height,avg_frame_rate",
            ])
            .args(["-of", "csv=p=0"])
            .arg(&film)
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&probe.stdout);
        assert_eq!(text.trim(), "50,32,5/1,10");
    }
    // Without one, it says what to do.
    let run = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["walk", &file, "-o", "none.mp4"])
        .env("PATH", "")
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&run.stderr).contains("apt-get install ffmpeg"));
}

#[test]
fn figures_for_programs_and_people() {
    let (folder, file) = rooms("");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let frames = folder.path().join("frames");
    let (csv, json, page) = (path("a.csv"), path("a.json"), path("a.html"));
    walk(&file, &frames, &["--figures", &csv, "--chart", &page]);
    // The second time all frames are kept, and so are their figures.
    walk(&file, &frames, &["--figures", &json]);
    let rows = fs::read_to_string(csv).unwrap();
    let rows: Vec<Vec<String>> = (rows.lines())
        .map(|row| row.split(',').map(str::to_string).collect())
        .collect();
    let json: Value = serde_json::from_slice(&fs::read(json).unwrap()).unwrap();
    let list = json["frames"].as_array().unwrap();
    assert_eq!((rows.len(), list.len()), (11, 10));
    for (row, frame) in rows[1..].iter().zip(list) {
        for (name, value) in rows[0].iter().zip(row) {
            let own = match &name[..] {
                "x" => &frame["eye"][0],
                "y" => &frame["eye"][1],
                "z" => &frame["eye"][2],
                "cells_eye" => &frame["polygons"]["cells"],
                "polygons" => &frame["polygons"]["all"],
                "polygons_facing" => &frame["polygons"]["facing"],
                "polygons_pvs" => &frame["polygons"]["pvs"],
                "polygons_eye" => &frame["polygons"]["eye"],
                "same_cell" => {
                    assert_eq!(frame["same_cell"], value == "1");
                    continue;
                }
                "ms_visibility" | "ms_draw" => continue,
                name => &frame[name],
            };
            let own = own.as_f64().unwrap_or_else(|| panic!("{name} is {own}"));
            assert_eq!(own, value.parse::<f64>().unwrap(), "{name}");
        }
        let n = |name: &str| frame["polygons"][name].as_u64().unwrap();
        assert!(n("eye") <= n("pvs") && n("pvs") <= n("facing") && n("facing") < n("all"));
        assert!(frame["polygons"]["cells"].as_u64() <= frame["cells_pvs"].as_u64());
    }
    assert_eq!(json["format"], "enfilade.walk");
    let summary = &json["summary"];
    assert!(summary["factor_eye"]["median"].as_f64() >= summary["factor_pvs"]["median"].as_f64());
    assert!(summary["reuse"]["frames"].as_u64().unwrap() > 0);
    let page = fs::read_to_string(page).unwrap();
    assert!(page.contains("two rooms: path `through`") && page.matches("<polyline").count() == 6);
}

#[test]
fn reuse_changes_nothing_but_the_time() {
    let (folder, file) = rooms("");
    let [with, without] = ["with", "without"].map(|n| folder.path().join(n));
    let figures = folder
        .path()
        .join("figures.json")
        .to_string_lossy()
        .into_owned();
    let read = |to: &Path, more: &[&str]| {
        let traced = ["--figures", &figures, "--renderer", "trace"];
        walk(&file, to, &[&traced, more].concat());
        let json: Value = serde_json::from_slice(&fs::read(&figures).unwrap()).unwrap();
        json["frames"].as_array().unwrap().clone()
    };
    let (a, b) = (read(&with, &[]), read(&without, &["--no-reuse"]));
    assert!(a.iter().any(|f| f["same_cell"] == true));
    assert!(b.iter().all(|f| f["same_cell"] == false));
    for (a, b) in a.iter().zip(&b) {
        for name in ["cell", "cells_pvs", "polygons", "rays", "effects", "eye"] {
            assert_eq!(a[name], b[name], "{name}");
        }
        assert!(a["rays"].as_u64().unwrap() >= 48 * 30);
    }
    for k in 0..10 {
        assert!(pixels(&with, k) == pixels(&without, k));
    }
}

#[test]
fn says_what_is_wrong_and_what_to_do() {
    let (folder, file) = rooms("");
    let there = folder.path().join("frames").to_string_lossy().into_owned();
    fn join<'a>(first: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
        [first, more].concat()
    }
    let fixed = ["walk", &file, "-o", &there];
    let walk = |more: &[&'static str]| join(&fixed, more);
    refused(&walk(&["--path", "round"]), &["no path `round`", "through"]);
    refused(
        &walk(&["--path", "through", "--tour"]),
        &["cannot be used with"],
    );
    refused(
        &walk(&["--from", "3"]),
        &["--from 3 is after the end", "2.00 seconds"],
    );
    refused(&walk(&["--fps", "0"]), &["above 0"]);
    refused(
        &walk(&["--tour", "--radius", "50"]),
        &["room to stand", "--radius"],
    );
    refused(
        &["walk", &file, "-o", "a.avi"],
        &["a folder of frames, a .gif or an .mp4"],
    );
    refused(&["walk", &file, "-o", "-"], &["standard output"]);
    refused(&["walk", &file, "-o", &file], &["a folder of frames"]);
    refused(
        &[
            "walk",
            &level("tiny.toml"),
            "-o",
            &there,
            "--subdivision",
            "cdt",
            "--tour",
            "--renderer",
            "preview",
        ],
        &["--subdivision"],
    );
    let through_a_wall =
        "[[path]]\nname = \"out\"\npoints = [[1, 2, 1.6], [1, 9, 1.6]]\nseconds = 2\n";
    let (_kept, file) = rooms(through_a_wall);
    refused(&["walk", &file, "-o", &there], &["--path", "through, out"]);
    let answer = ["walk", &file, "-o", &there, "--path", "out"];
    refused(&answer, &["path `out`, after", "seconds", "outside"]);
    assert!(!Path::new(&there).exists());
}

/// Fifty frames of a tour: what the preview shows, against the first thing that a ray meets; and the
/// traced frames. Prints the shares of pixels that differ, and the culling factor.
fn against_rays(scene: &Scene, person: &Person) -> f64 {
    const FRAMES: u32 = 50;
    const SIZE: [u32; 2] = [96, 60];
    let (world, graph) = (&scene.world, &scene.graph);
    let tour = tour(&scene.level, graph, &world.space, person).expect("there is room");
    let track = tour.track(&TrackOptions::default());
    let painter = Painter::new(world, graph, &scene.pvs, Finish::Textured).unwrap();
    let tracer = Tracer::new(world);
    let mut guide = Guide::new(world, graph, &scene.pvs, true);
    let mut easel = Easel::default();
    let (mut holes, mut differ, mut all) = (0, 0, 0u64);
    let mut factors = Vec::new();
    for k in 0..FRAMES {
        let pose = track.at(track.seconds() * f64::from(k) / f64::from(FRAMES));
        let camera = Camera::new(pose.eye, pose.direction, 75.0, SIZE);
        let cell = guide.step(&camera).expect("it is inside").cell;
        let counts = Counts::of(&painter, &camera, &mut easel).unwrap();
        factors.push(counts.factors()[2]);
        let options = Options {
            objects: true,
            surfaces: true,
            ..Options::default()
        };
        let figures = painter.draw(&camera, &options, &mut easel).unwrap();
        assert_eq!((figures.painted, figures.cells), (counts.eye, counts.cells));
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let shown = easel.canvas.surfaces[(y * SIZE[0] + x) as usize];
                all += 1;
                holes += u64::from(shown == NOTHING);
                let start = Departure::within(cell);
                let (hit, _) = first(&tracer, &camera, start, at);
                let same = same(&painter, shown, hit.what);
                differ += u64::from(!same);
            }
        }
        // A traced frame has no black holes either: something is lit or glows on every pixel.
        let options = RenderOptions {
            effects: survey(world, &scene.pvs, cell).needed,
            ..RenderOptions::default()
        };
        if k % 10 == 0 {
            let drawn = render(&tracer, &camera, cell, &options, &Default::default());
            let finite = drawn.picture.pixels.iter().all(|p| p.is_finite());
            assert!(finite, "frame {k}");
        }
    }
    factors.sort_by(f64::total_cmp);
    let median = factors[factors.len() / 2];
    eprintln!(
        "{}: {FRAMES} frames of a tour; holes {holes}, other surfaces {differ} of {all} pixels; median \
         culling factor {median:.1}",
        scene.level.name
    );
    assert_eq!(holes, 0);
    assert!(differ * 10_000 <= all, "{differ} of {all}");
    median
}

#[test]
fn a_tour_of_the_museum_looks_as_rays_see_it() {
    against_rays(&Scene::sample("museum"), &Person::METRES);
}

#[test]
fn a_tour_of_a_doom_map_paints_a_tenth_of_its_polygons_at_most() {
    let change = |level: Level| opened(&level, &Person::DOOM);
    if let Some(scene) = Scene::of_wad_changed(FREEDOOM, "E1M1", change) {
        let factor = against_rays(&scene, &Person::DOOM);
        assert!(factor > 10.0, "{factor}");
    }
}
