//! The real window, without a screen: keys, clicks on the plan, and what comes of them.

mod editing;
mod measures;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec2;

use super::app::{App, Tab, View};
use super::document::{Loaded, Services, Voice};
use super::engine::Picture;
use super::walker::Mode;
use crate::cells::CellId;
use crate::level::read;
use crate::preview::Culling;
use crate::trace::world::Files;

/// Words are tested where they are made.
const VOICE: Voice = Voice {
    findings: |_, _| Vec::new(),
    why: |_, _, _, [a, b], _| Some(format!("cells {} and {}", a.0, b.0)),
};

fn services() -> Services {
    let load = |path: &Path, map: Option<&str>| {
        let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
        let name = path.display().to_string();
        let level = read::read(bytes, &name, map).map_err(|e| e.to_string())?;
        Ok(Loaded {
            level,
            files: Files::default(),
        })
    };
    Services {
        load: Arc::new(load),
        save: |path, bytes| std::fs::write(path, bytes).map_err(|e| e.to_string()),
        voice: VOICE,
    }
}

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("levels")
        .join(name)
}

/// A window with a level that is ready, and a first picture.
fn window(path: PathBuf) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .build_eframe(move |context| {
            let mut app = App::new(&context.egui_ctx, None, services());
            app.open(path, None);
            app
        });
    until(&mut harness, "a level and a picture", |app| {
        app.seen.is_some()
    });
    harness
}

/// Goes on until something has happened beside the window.
fn until(harness: &mut Harness<'static, App>, what: &str, done: impl Fn(&App) -> bool) {
    let start = Instant::now();
    while !done(harness.state()) {
        assert!(start.elapsed() < Duration::from_secs(120), "no {what}");
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Lets some frames go by, in real time.
fn moments(harness: &mut Harness<'static, App>, frames: usize) {
    for _ in 0..frames {
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Where a place of the plan is on the screen: the plan shows all of the level at first.
fn on_screen(harness: &Harness<'static, App>, at: DVec2) -> Pos2 {
    let rect = harness.get_by_label("Plan of the level").rect();
    let document = harness.state().document.clone().expect("a level");
    let [low, high] = document.plan.bounds;
    let size = high - low;
    let room = DVec2::new(rect.width().into(), rect.height().into()) * 0.92;
    let d = (at - (low + high) / 2.0) * (room / size).min_element();
    rect.center() + vec2(d.x as f32, -d.y as f32)
}

fn click(harness: &mut Harness<'static, App>, at: Pos2, modifiers: Modifiers) {
    harness.event(Event::PointerMoved(at));
    for pressed in [true, false] {
        let button = Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers,
        };
        harness.event_modifiers(button, modifiers);
        harness.step();
    }
    harness.step();
}

/// A place well inside a cell.
fn inside(harness: &Harness<'static, App>, cell: u32) -> DVec2 {
    let document = harness.state().document.clone().expect("a level");
    document.world.middle(CellId(cell)).0
}

#[test]
fn keys_move_the_eye_and_what_it_sees_follows() {
    let mut harness = window(sample("museum.toml"));
    let before = harness.state().eye;
    let seen = harness
        .state()
        .seen
        .as_ref()
        .expect("a picture")
        .cells
        .clone();
    harness.key_down(Key::ArrowLeft);
    harness.run_steps(40);
    harness.key_up(Key::ArrowLeft);
    harness.key_down(Key::W);
    moments(&mut harness, 60);
    harness.key_up(Key::W);
    until(&mut harness, "rest", |app| !app.eye.moves());
    let after = harness.state().eye;
    assert!(after.yaw > before.yaw);
    assert!(after.eye.distance(before.eye) > 0.1, "{before:?} {after:?}");
    let camera = harness.state().camera();
    until(&mut harness, "a picture from there", |app| {
        app.seen.as_ref().is_some_and(|s| s.look.camera == camera)
    });
    let now = harness.state().seen.as_ref().expect("a picture");
    assert_ne!(now.cells, seen);
    let [all, pvs, eye] = now.polygons;
    assert!(eye <= pvs && pvs <= all && eye > 0, "{:?}", now.polygons);
    assert!(matches!(&now.picture, Picture::Bytes(b) if b.iter().any(|b| *b > 0)));
}

#[test]
fn clicks_on_the_plan_choose_cells_and_ask_why() {
    let mut harness = window(sample("museum.toml"));
    let document = harness.state().document.clone().expect("a level");
    let first = harness
        .state()
        .seen
        .as_ref()
        .and_then(|s| s.cell)
        .expect("inside");
    // The largest cell that it sees and the largest that it does not.
    let largest = |sees: bool| {
        let cells = document.graph.cell_ids();
        let wanted = cells.filter(|c| *c != first && document.pvs.sees(first, *c) == sees);
        let size = |c: &CellId| document.world.middle(*c).1;
        wanted
            .max_by(|a, b| size(a).total_cmp(&size(b)))
            .expect("there is one")
    };
    let at = on_screen(&harness, inside(&harness, first.0));
    click(&mut harness, at, Modifiers::NONE);
    assert_eq!(harness.state().source, Some(first));
    for sees in [true, false] {
        // Not so soon after the last one that it is a double click.
        std::thread::sleep(Duration::from_millis(400));
        harness.run_steps(30);
        let other = largest(sees);
        let at = on_screen(&harness, inside(&harness, other.0));
        click(&mut harness, at, Modifiers::SHIFT);
        assert_eq!(harness.state().second, Some(other));
        until(&mut harness, "an explanation", |app| {
            app.explained
                .as_ref()
                .is_some_and(|e| e.cells == [first, other])
        });
        let explained = harness.state().explained.as_ref().expect("an explanation");
        assert_eq!(explained.sees, sees);
        assert_eq!(explained.line.is_some(), sees);
        assert_eq!(explained.way.is_empty(), sees);
        assert_eq!(harness.state().settings.tab, Tab::Why);
    }
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert_eq!(harness.state().source, None);
}

#[test]
fn a_frozen_choice_stays_while_the_eye_flies_out() {
    let mut harness = window(sample("museum.toml"));
    harness.key_press(Key::P);
    harness.key_press(Key::F);
    harness.run_steps(3);
    let app = harness.state_mut();
    assert!(app.frozen.is_some() && app.eye.mode == Mode::Fly);
    let chosen = app.seen.as_ref().expect("a picture").cells.clone();
    app.eye.eye.z += 30.0;
    app.eye.pitch = -1.2;
    harness.step();
    let camera = harness.state().camera();
    until(&mut harness, "a picture from above", |app| {
        app.seen.as_ref().is_some_and(|s| s.look.camera == camera)
    });
    let seen = harness.state().seen.as_ref().expect("a picture");
    assert_eq!(seen.cells, chosen);
    assert!(seen.figures.painted > 0);
}

#[test]
fn a_broken_file_leaves_the_last_good_level_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("level.toml");
    std::fs::copy(sample("tiny.toml"), &file).expect("a copy");
    let mut harness = window(file.clone());
    let good = harness.state().document.clone().expect("a level");
    std::fs::write(&file, "[[room]]\nname = \"A\"\nrect = [0, 0, 4]\n").expect("written");
    // It is noticed without anybody asking.
    until(&mut harness, "an error", |app| app.error.is_some());
    harness.step();
    let said = harness.state().error.clone().unwrap_or_default();
    assert!(
        said.contains("level.toml") && said.contains("line 3"),
        "{said}"
    );
    harness.get_by_label("What was open stays open.");
    let still = harness.state().document.clone().expect("a level");
    assert!(Arc::ptr_eq(&good, &still));
    // And when it is mended, it is read again.
    std::thread::sleep(Duration::from_millis(20));
    std::fs::copy(sample("house.toml"), &file).expect("a copy");
    until(&mut harness, "the mended level", |app| {
        app.document
            .as_ref()
            .is_some_and(|d| d.level.name != good.level.name)
    });
}

#[test]
fn panels_tell_what_is_drawn_and_why() {
    let mut harness = window(sample("museum.toml"));
    let all = harness
        .state()
        .seen
        .as_ref()
        .expect("a picture")
        .figures
        .all;
    harness.get_by_label_contains("everything:").click();
    harness.run_steps(3);
    assert_eq!(harness.state().settings.culling, Culling::None);
    until(&mut harness, "a picture of everything", |app| {
        app.seen.as_ref().is_some_and(|s| s.figures.polygons == all)
    });
    harness.get_by_label("Effects").click();
    harness.run_steps(3);
    harness.get_by_label("mirror");
    harness.get_by_label("Findings").click();
    harness.run_steps(3);
    assert_eq!(harness.state().settings.tab, Tab::Findings);
    harness.key_press(Key::F1);
    harness.run_steps(3);
    harness.get_by_label("freeze what is drawn, and fly out to look at it");
}

#[test]
fn a_traced_picture_grows_finer_while_the_eye_rests() {
    let mut harness = window(sample("tiny.toml"));
    harness.state_mut().settings.samples = 2;
    harness.key_press(Key::Num3);
    harness.step();
    assert_eq!(harness.state().settings.view, View::Both);
    until(&mut harness, "a coarse picture", |app| app.traced.is_some());
    until(&mut harness, "the whole picture", |app| {
        app.traced.as_ref().is_some_and(|(_, t)| t.done)
    });
    let (_, traced) = harness.state().traced.as_ref().expect("a picture");
    assert_eq!((traced.samples, traced.coarse), (2, 1));
    assert_eq!(traced.size, harness.state().camera().size);
    // Without shadows it is another one.
    let before = traced.bytes.clone();
    let shadows = crate::trace::effects::Effect::Shadows;
    let app = harness.state_mut();
    app.settings.without = app.settings.without.with(shadows);
    harness.run_steps(3);
    until(&mut harness, "a picture without shadows", |app| {
        app.traced
            .as_ref()
            .is_some_and(|(_, t)| t.done && t.bytes != before)
    });
}

#[test]
fn a_click_gives_the_mouse_to_the_view() {
    let mut harness = window(sample("museum.toml"));
    let view = harness.get_by_label("View into the level").rect().center();
    click(&mut harness, view, Modifiers::NONE);
    assert!(harness.state().captured);
    let before = harness.state().eye;
    harness.event(Event::MouseMoved(vec2(-100.0, 40.0)));
    harness.run_steps(2);
    let after = harness.state().eye;
    // To the left, and down.
    assert!(after.yaw > before.yaw && after.pitch < before.pitch);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().captured);
    harness.event(Event::MouseMoved(vec2(-100.0, 40.0)));
    harness.run_steps(2);
    assert_eq!(harness.state().eye.yaw, after.yaw);
}

#[test]
fn the_right_button_offers_what_can_be_done_there() {
    let mut harness = window(sample("museum.toml"));
    let document = harness.state().document.clone().expect("a level");
    let own = harness.state().subject().expect("inside");
    let (far, _) = document.farthest(own).expect("it sees something");
    let at = on_screen(&harness, inside(&harness, far.0));
    let right = |harness: &mut Harness<'static, App>| {
        harness.event(Event::PointerMoved(at));
        harness.step();
        for pressed in [true, false] {
            harness.event(Event::PointerButton {
                pos: at,
                button: PointerButton::Secondary,
                pressed,
                modifiers: Modifiers::NONE,
            });
            harness.step();
        }
        harness.run_steps(3);
    };
    right(&mut harness);
    harness
        .get_by_label("Why does the eye's cell see this one?")
        .click();
    harness.run_steps(3);
    until(&mut harness, "an explanation", |app| {
        app.explanation().is_some()
    });
    let explained = harness.state().explanation().expect("one");
    assert_eq!(explained.cells, [own, far]);
    let rise = explained.rise.expect("a line in space");
    assert_eq!(document.cell_at(rise[1].truncate()), Some(far));
    assert!(!harness.state().ink(&document).is_empty());
    right(&mut harness);
    harness.get_by_label("Go here").click();
    harness.run_steps(3);
    let eye = harness.state().eye.eye.truncate();
    assert_eq!(document.cell_at(eye), Some(far));
}

#[test]
fn the_window_does_not_wait_for_slow_levels() {
    let path = Path::new("/usr/share/games/doom/freedoom2.wad");
    if !path.exists() {
        assert!(std::env::var_os("CI").is_none(), "CI needs Freedoom");
        eprintln!(
            "skipped: {} is not there (apt-get install freedoom)",
            path.display()
        );
        return;
    }
    let mut harness = Harness::builder()
        .with_size(vec2(1280.0, 800.0))
        .build_eframe(|context| {
            let mut app = App::new(&context.egui_ctx, None, services());
            app.open(path.to_path_buf(), Some("MAP12".to_string()));
            app
        });
    until(&mut harness, "MAP12", |app| app.seen.is_some());
    let most = harness.state().thread[0];
    println!(
        "MAP12: the window's thread took at most {most:.1} ms for a frame while it was computed"
    );
    // Generous: another program may have had the processor.
    assert!(most < 1000.0, "{most} ms");
}
