//! Levels changed and saved, walks recorded and played.

use super::*;

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
        moments(&mut harness, 60);
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
fn a_path_is_walked_and_stops() {
    let mut harness = window(sample("museum.toml"));
    let before = harness.state().eye.eye;
    harness.state_mut().play(None);
    moments(&mut harness, 20);
    let play = harness.state().play.as_ref().expect("a tour");
    assert!(play.running && play.at > 0.0);
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    let at = harness.state().eye.eye;
    harness.run_steps(5);
    assert_eq!(harness.state().eye.eye, at);
    assert_ne!(at, before);
}
