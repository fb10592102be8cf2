//! The viewer as people start it: a real window on a screen without a monitor, real key presses.
//!
//! Needs Xvfb, xdotool, ImageMagick's `import` and a Vulkan driver (Mesa's lavapipe will do). Without
//! them it says what it skips; in CI that is a failure.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// A program that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        _ = self.0.kill();
        _ = self.0.wait();
    }
}

/// Whether all programs are there that this needs.
fn tools() -> bool {
    for (tool, package) in [
        ("Xvfb", "xvfb"),
        ("xdotool", "xdotool"),
        ("import", "imagemagick"),
    ] {
        let found = Command::new("which").arg(tool).output();
        if !found.is_ok_and(|f| f.status.success()) {
            assert!(std::env::var_os("CI").is_none(), "CI needs {package}");
            eprintln!("skipped: {tool} is not there (apt-get install {package})");
            return false;
        }
    }
    true
}

/// A screen without a monitor: its name, and the program.
fn screen() -> (String, Running) {
    for number in 70..99 {
        if Path::new(&format!("/tmp/.X11-unix/X{number}")).exists() {
            continue;
        }
        let name = format!(":{number}");
        let server = Command::new("Xvfb")
            .args([&name, "-screen", "0", "1280x800x24"])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let server = Running(server);
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(20) {
            if Path::new(&format!("/tmp/.X11-unix/X{number}")).exists() {
                return (name, server);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
    panic!("there is no screen to be had");
}

/// A line of the log: `eye X Y Z cell N pvs N`.
#[derive(Clone, Debug, PartialEq)]
struct Seen {
    eye: [f64; 3],
    cell: u32,
    pvs: u32,
}

fn parse(line: &str) -> Option<Seen> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["eye", x, y, z, "cell", cell, "pvs", pvs] = words[..] else {
        return None;
    };
    Some(Seen {
        eye: [x.parse().ok()?, y.parse().ok()?, z.parse().ok()?],
        cell: cell.parse().ok()?,
        pvs: pvs.parse().ok()?,
    })
}

/// The next line for which `wanted` holds.
fn wait(log: &Receiver<Seen>, what: &str, wanted: impl Fn(&Seen) -> bool) -> Seen {
    let end = Instant::now() + Duration::from_secs(120);
    while let Ok(seen) = log.recv_timeout(end.saturating_duration_since(Instant::now())) {
        if wanted(&seen) {
            return seen;
        }
    }
    panic!("the viewer never said that {what}");
}

#[test]
fn keys_walk_through_the_museum() {
    if !tools() {
        return;
    }
    let (display, _server) = screen();
    let level = Path::new(env!("CARGO_MANIFEST_DIR")).join("levels/museum.toml");
    let memory = tempfile::tempdir().expect("a folder");
    let mut viewer = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["view", "--log"])
        .arg(level)
        .env("DISPLAY", &display)
        // What the user of this machine has chosen is neither used nor changed.
        .env("XDG_DATA_HOME", memory.path())
        .env_remove("WAYLAND_DISPLAY")
        .stderr(Stdio::piped())
        .spawn()
        .expect("the viewer starts");
    let errors = BufReader::new(viewer.stderr.take().expect("it is piped"));
    let mut viewer = Running(viewer);
    let (told, log) = channel();
    std::thread::spawn(move || {
        for line in errors.lines().map_while(Result::ok) {
            match parse(&line) {
                Some(seen) => _ = told.send(seen),
                None => eprintln!("viewer: {line}"),
            }
        }
    });
    let first = wait(&log, "it sees something", |_| true);
    let xdotool = |arguments: &[&str]| {
        let run = Command::new("xdotool")
            .args(arguments)
            .env("DISPLAY", &display)
            .status();
        assert!(run.expect("xdotool runs").success(), "{arguments:?}");
    };
    let picture = |name: &str| -> image::RgbImage {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let file = folder.join(name);
        let run = Command::new("import")
            .args(["-window", "root"])
            .arg(&file)
            .env("DISPLAY", &display)
            .status();
        assert!(run.expect("import runs").success());
        image::open(file).expect("a screenshot").to_rgb8()
    };
    std::thread::sleep(Duration::from_millis(800));
    let before = picture("viewer-before.png");
    // There is no window manager, so nobody gives the window the keys.
    let found = Command::new("xdotool")
        .args(["search", "--name", "enfilade"])
        .env("DISPLAY", &display)
        .output()
        .expect("xdotool runs");
    let found = String::from_utf8_lossy(&found.stdout).into_owned();
    let window = found.lines().last().expect("there is a window");
    xdotool(&["windowfocus", window]);
    xdotool(&["mousemove", "500", "400"]);
    xdotool(&["keydown", "w"]);
    let moved = wait(&log, "the cell has changed", |s| s.cell != first.cell);
    std::thread::sleep(Duration::from_millis(400));
    xdotool(&["keyup", "w"]);
    let d: Vec<f64> = (0..3).map(|k| moved.eye[k] - first.eye[k]).collect();
    let distance = d.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(distance > 0.2, "{first:?} {moved:?}");
    assert!(moved.pvs > 0);
    std::thread::sleep(Duration::from_millis(800));
    let after = picture("viewer-after.png");
    assert_eq!(before.dimensions(), (1280, 800));
    let colours: std::collections::HashSet<_> = before.pixels().collect();
    assert!(
        colours.len() > 200,
        "{} colours: an empty window",
        colours.len()
    );
    let pairs = before.pixels().zip(after.pixels());
    let differ = pairs.filter(|(a, b)| a != b).count();
    assert!(differ > 20_000, "only {differ} pixels have changed");
    // It ends when asked to, and remembers what was chosen.
    xdotool(&["key", "h"]);
    std::thread::sleep(Duration::from_millis(300));
    xdotool(&["key", "ctrl+q"]);
    let end = Instant::now() + Duration::from_secs(60);
    let status = loop {
        if let Some(status) = viewer.0.try_wait().expect("it can be asked") {
            break status;
        }
        assert!(Instant::now() < end, "it does not end");
        std::thread::sleep(Duration::from_millis(50));
    };
    assert!(status.success(), "{status}");
    let kept = std::fs::read_to_string(memory.path().join("enfilade/app.ron"));
    let kept = kept.expect("something is remembered");
    assert!(
        kept.contains("heat:true") && kept.contains("museum.toml"),
        "{kept}"
    );
}
