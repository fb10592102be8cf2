//! What is measured when one asks: methods, sightlines, costs.

use super::*;
use crate::pvs::Method;
use crate::viewer::methods::Contender;

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
