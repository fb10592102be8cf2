//! The real window, without a screen: keys, clicks on the plan, and what comes of them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use eframe::egui;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec2;

use super::app::{App, Tab, View};
use super::document::{Loaded, Loader, Voice};
use super::engine::Picture;
use super::methods::Contender;
use super::walker::Mode;
use crate::cells::CellId;
use crate::level::read;
use crate::preview::Culling;
use crate::pvs::Method;
use crate::trace::world::Files;

/// Words are tested where they are made.
const VOICE: Voice = Voice {
    findings: |_, _| Vec::new(),
    why: |_, _, _, [a, b], _| Some(format!("cells {} and {}", a.0, b.0)),
};

fn loader() -> Loader {
    Arc::new(|path: &Path, map: Option<&str>| {
        let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
        let name = path.display().to_string();
        let level = read::read(bytes, &name, map).map_err(|e| e.to_string())?;
        Ok(Loaded {
            level,
            files: Files::default(),
        })
    })
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
            let mut app = App::new(&context.egui_ctx, None, (loader(), VOICE));
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
    for _ in 0..60 {
        harness.step();
        std::thread::sleep(Duration::from_millis(4));
    }
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

/// Presses, moves in steps, and lets go.
fn drag(harness: &mut Harness<'static, App>, from: Pos2, to: Pos2) {
    harness.event(Event::PointerMoved(from));
    harness.step();
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(button(from, true));
    harness.step();
    for k in 1..=8 {
        harness.event(Event::PointerMoved(from.lerp(to, k as f32 / 8.0)));
        harness.step();
    }
    harness.event(button(to, false));
    harness.step();
}

#[test]
fn corners_are_dragged_doors_toggled_and_all_of_it_undone_and_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("level.toml");
    let text = "name = \"three\"\n[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
        [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
        [[room]]\nname = \"C\"\nrect = [8, 0, 12, 4]\n\
        [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n[[archway]]\nbetween = [\"B\", \"C\"]\nwidth = 1\n";
    std::fs::write(&file, text).expect("written");
    let mut harness = window(file);
    let pairs = |app: &App| -> u32 {
        let document = app.document.as_ref().expect("a level");
        document.sees.iter().sum()
    };
    let open = pairs(harness.state());
    harness.key_press(Key::B);
    harness.run_steps(2);
    // The door between A and B, at (4, 2).
    let door = on_screen(&harness, DVec2::new(4.0, 2.0));
    let before = harness.state().document.clone().expect("a level");
    click(&mut harness, door, Modifiers::NONE);
    until(&mut harness, "the closed door", |app| {
        app.document
            .as_ref()
            .is_some_and(|d| !Arc::ptr_eq(d, &before))
    });
    assert!(pairs(harness.state()) < open, "{open}");
    let note = &harness.state().editing.as_ref().expect("editing").note;
    assert!(
        note.contains("visible pairs") && note.contains('-'),
        "{note}"
    );
    harness.state_mut().undo(false);
    // Doors that stand open count as open now.
    until(&mut harness, "the door as it was", |app| {
        pairs(app) != open || app.changes() == 0
    });
    harness.state_mut().undo(true);
    until(&mut harness, "the change again", |app| app.changes() == 1);
    // The upper right corner of C is pulled out.
    let [from, to] = [DVec2::new(12.0, 4.0), DVec2::new(11.0, 3.0)];
    let [from, to] = [from, to].map(|p| on_screen(&harness, p));
    drag(&mut harness, from, to);
    let has = |app: &App| {
        let document = app.document.as_ref().expect("a level");
        let corners = document.plan.cells.iter().flatten();
        let at = |p: &DVec2| p.distance(DVec2::new(11.0, 3.0)) < 0.2;
        corners.clone().any(at)
            && !corners
                .clone()
                .any(|p| p.distance(DVec2::new(12.0, 4.0)) < 1e-6)
    };
    until(&mut harness, "the corner", has);
    assert_eq!(harness.state().changes(), 2, "a drag is one change");
    let saved = folder.path().join("saved.toml");
    harness.state_mut().save(saved.clone());
    until(&mut harness, "the file", |app| {
        app.editing
            .as_ref()
            .is_some_and(|e| e.note.starts_with("saved as"))
    });
    let text = std::fs::read(saved).expect("it is there");
    let level = read::read(text, "saved.toml", None).expect("it reads");
    assert_eq!(level.sectors.len(), 3);
}

#[test]
fn a_walk_is_recorded_saved_and_played() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("level.toml");
    std::fs::copy(sample("tiny.toml"), &file).expect("a copy");
    let mut harness = window(file.clone());
    harness.key_press(Key::R);
    harness.run_steps(2);
    assert!(harness.state().recording.is_some());
    // Ahead, or, where there is a wall, back.
    for key in [Key::W, Key::S] {
        harness.key_down(key);
        for _ in 0..60 {
            harness.step();
            std::thread::sleep(Duration::from_millis(4));
        }
        harness.key_up(key);
        harness.step();
    }
    harness.key_press(Key::R);
    harness.run_steps(3);
    harness.get_by_label("Save the walk");
    let walks = harness.state().walks.len();
    assert_eq!(walks, 1);
    // Into the level's own file, which is read again.
    harness.get_by_label("Save").click();
    harness.run_steps(3);
    until(&mut harness, "the level with its walk", |app| {
        let document = app.document.as_ref().expect("a level");
        document
            .level
            .scene
            .paths
            .iter()
            .any(|p| p.name == "walk 1")
    });
    assert_eq!(harness.state().error, None);
    let text = std::fs::read(&file).expect("it is there");
    let level = read::read(text, "level.toml", None).expect("it reads");
    assert!(
        level
            .scene
            .paths
            .iter()
            .any(|p| p.name == "walk 1" && p.points.len() > 1)
    );
    harness.state_mut().play(Some("walk 1"));
    harness.run_steps(3);
    assert!(
        harness
            .state()
            .play
            .as_ref()
            .is_some_and(|p| p.track.seconds() > 0.0)
    );
    // One who does not move has nothing to keep.
    harness.state_mut().play = None;
    harness.key_press(Key::R);
    harness.run_steps(2);
    harness.key_press(Key::R);
    harness.run_steps(2);
    assert!(harness.state().error.is_some() && harness.state().keeping.is_none());
}

#[test]
fn other_methods_are_measured_and_compared() {
    let mut harness = window(sample("house.toml"));
    harness.get_by_label("Accuracy").click();
    harness.run_steps(3);
    let document = harness.state().document.clone().expect("a level");
    for contender in Contender::ALL {
        let app = harness.state_mut();
        app.methods.measure(&document, contender, || {});
        until(&mut harness, contender.name(), |app| {
            app.methods.of(contender).is_some()
        });
        let rival = harness
            .state()
            .methods
            .of(contender)
            .expect("it was measured");
        let (exact, own) = (document.pvs.pairs(), rival.pvs.pairs());
        assert_eq!(
            own,
            exact + rival.extra - rival.missed,
            "{}",
            contender.name()
        );
        match contender {
            Contender::Method(Method::Sweep | Method::Search) => {
                assert_eq!((rival.extra, rival.missed), (0, 0));
            }
            Contender::Method(Method::Flood) => assert!(rival.extra > 0 && rival.missed == 0),
            Contender::Heights => assert_eq!(rival.extra, 0),
            _ => {}
        }
    }
    harness.run_steps(3);
    // Each line of the table has its box now.
    let boxes = harness.get_all_by_label("show").count();
    assert_eq!(boxes, Contender::ALL.len());
    harness.state_mut().methods.shown = Some(Contender::Method(Method::Flood));
    harness.run_steps(3);
    harness.get_by_label("sees too much");
}

#[test]
fn sightlines_lead_to_every_cell_that_is_seen() {
    let mut harness = window(sample("museum.toml"));
    harness.key_press(Key::L);
    until(&mut harness, "all sightlines", |app| {
        app.sightlines.as_ref().is_some_and(|s| s.complete)
    });
    let app = harness.state();
    let document = app.document.clone().expect("a level");
    let lines = app.sightlines.as_ref().expect("sightlines");
    let cell = lines.cell;
    assert_eq!(Some(cell), app.subject());
    assert_eq!(lines.lines.len() as u32 + 1, document.sees[cell.0 as usize]);
    let longest = lines.longest().expect("one").1;
    for [from, to] in &lines.lines {
        assert_eq!(document.cell_at(*from), Some(cell));
        let other = document.cell_at(*to).expect("inside");
        assert!(document.pvs.sees(cell, other));
        assert!(from.distance(*to) <= longest);
    }
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
fn the_most_expensive_cells_are_a_click_away() {
    let mut harness = window(sample("museum.toml"));
    let document = harness.state().document.clone().expect("a level");
    let first = document.dearest[0];
    let most = document.sees.iter().max().copied();
    assert_eq!(Some(document.sees[first.0 as usize]), most);
    harness.get_by_label(&format!("cell {}", first.0)).click();
    harness.run_steps(3);
    assert_eq!(harness.state().source, Some(first));
    harness.get_by_label("Why").click();
    harness.run_steps(3);
    let (far, _) = document.farthest(first).expect("it sees something");
    let text = format!("why cell {} sees cell {}", first.0, far.0);
    harness.get_by_label(&text).click();
    until(&mut harness, "an explanation", |app| {
        app.explanation().is_some()
    });
}

#[test]
fn each_turn_of_a_knob_leaves_its_cost() {
    let mut harness = window(sample("tiny.toml"));
    harness.key_press(Key::Num2);
    harness.get_by_label("Accuracy").click();
    for samples in [1, 2] {
        harness.state_mut().settings.samples = samples;
        harness.step();
        until(&mut harness, "the whole picture", |app| {
            app.traced
                .as_ref()
                .is_some_and(|(_, t)| t.done && t.samples == samples)
        });
    }
    harness.run_steps(2);
    let app = harness.state();
    let tried = app.costs.along(&app.knobs(), |k, o| k.samples = o.samples);
    let samples: Vec<u32> = tried.iter().map(|(k, _)| k.samples).collect();
    assert_eq!(samples, [1, 2]);
    assert!(tried.iter().all(|(_, ms)| *ms > 0.0));
    harness.get_by_label_contains("2: ");
}

#[test]
fn a_path_is_walked_and_stops() {
    let mut harness = window(sample("museum.toml"));
    let before = harness.state().eye.eye;
    harness.state_mut().play(None);
    for _ in 0..20 {
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    let play = harness.state().play.as_ref().expect("a tour");
    assert!(play.running && play.at > 0.0);
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    let at = harness.state().eye.eye;
    harness.run_steps(5);
    assert_eq!(harness.state().eye.eye, at);
    assert_ne!(at, before);
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
            let mut app = App::new(&context.egui_ctx, None, (loader(), VOICE));
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
