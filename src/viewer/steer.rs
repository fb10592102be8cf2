//! Keys and mouse: where the eye goes, and what is switched on and off.

use eframe::egui;
use egui::{Event, Key, Modifiers, Ui};
use glam::DVec2;

use super::app::{App, View};
use super::walker::{Input, Mode};

/// Radians that the view turns for each step of the mouse.
const MOUSE: f64 = 0.0025;

impl App {
    /// Moves the eye as the keys say.
    pub(super) fn steer(&mut self, ui: &Ui, seconds: f64) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let Some(document) = self.document.clone() else {
            return;
        };
        if self.captured {
            let moved = ui.input(|i| {
                let moves = i.events.iter().filter_map(|event| match event {
                    Event::MouseMoved(by) => Some(DVec2::new(f64::from(by.x), f64::from(by.y))),
                    _ => None,
                });
                moves.sum::<DVec2>()
            });
            self.look -= moved * MOUSE;
            if !ui.input(|i| i.focused) {
                self.capture(false);
            }
        }
        let down = |keys: &[Key]| ui.input(|i| keys.iter().any(|k| i.key_down(*k)));
        let axis = |plus: &[Key], minus: &[Key]| f64::from(down(plus)) - f64::from(down(minus));
        let input = Input {
            forward: axis(&[Key::W, Key::ArrowUp], &[Key::S, Key::ArrowDown]),
            right: axis(&[Key::D], &[Key::A]),
            up: axis(&[Key::E, Key::Space], &[Key::Q]),
            turn: axis(&[Key::ArrowLeft], &[Key::ArrowRight]),
            tilt: axis(&[Key::PageUp], &[Key::PageDown]),
            run: ui.input(|i| i.modifiers.shift),
            look: std::mem::take(&mut self.look),
        };
        if input.is_idle() && !self.eye.moves() {
            return;
        }
        self.play = None;
        self.eye.step(&input, seconds, &document.site());
        self.context.request_repaint();
    }

    /// Keys that do something once.
    pub(super) fn keys(&mut self, ui: &Ui) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        // As it was when the key went down: by the end of a slow frame all keys may be up again.
        // A key that is held down does it once.
        ui.input_mut(|i| {
            i.events
                .retain(|event| !matches!(event, Event::Key { repeat: true, .. }));
        });
        let pressed = |key| ui.input_mut(|i| i.consume_key(Modifiers::NONE, key));
        let command = |key, shift| {
            let modifiers = if shift {
                Modifiers::COMMAND | Modifiers::SHIFT
            } else {
                Modifiers::COMMAND
            };
            ui.input_mut(|i| i.consume_key(modifiers, key))
        };
        if command(Key::Q, false) {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        if command(Key::O, false) {
            self.typed = Some(String::new());
        }
        // With Shift first: without it is asked whatever Shift does.
        if command(Key::Z, true) || command(Key::Y, false) {
            self.undo(true);
        }
        if command(Key::Z, false) {
            self.undo(false);
        }
        for (key, view) in [
            (Key::Num1, View::Painted),
            (Key::Num2, View::Traced),
            (Key::Num3, View::Both),
        ] {
            if pressed(key) {
                self.settings.view = view;
            }
        }
        let s = &mut self.settings;
        for (key, switch) in [
            (Key::M, &mut s.plan),
            (Key::H, &mut s.heat),
            (Key::L, &mut s.sightlines),
            (Key::O, &mut s.outlines),
            (Key::T, &mut s.textured),
            (Key::F1, &mut s.help),
            (Key::F3, &mut s.debug),
        ] {
            *switch ^= pressed(key);
        }
        if pressed(Key::B) {
            self.edit();
        }
        if pressed(Key::F) {
            self.eye.mode = match self.eye.mode {
                Mode::Walk => Mode::Fly,
                Mode::Fly => Mode::Walk,
            };
        }
        if pressed(Key::P) {
            self.freeze();
        }
        if pressed(Key::R) {
            self.record();
        }
        if pressed(Key::F5) {
            self.reload();
        }
        let escape = pressed(Key::Escape);
        if escape && self.captured {
            self.capture(false);
        } else if escape {
            (self.source, self.second, self.explained) = (None, None, None);
            (self.mark, self.error, self.note) = (None, None, None);
            self.settings.help = false;
        }
    }
}
