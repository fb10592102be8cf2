//! Windows that lie over everything: keys, errors, what to open and where to save.

use eframe::egui;
use egui::{RichText, Ui};

use super::app::{App, Wanted};

/// The keys, and what they do.
const KEYS: [(&str, &str); 23] = [
    ("W A S D", "walk; arrow keys too, left and right turn"),
    ("drag in the view", "look around"),
    (
        "click in the view",
        "the mouse looks around, until Esc or a click",
    ),
    ("Shift", "run"),
    ("F", "fly through walls, or walk"),
    ("Q E", "down and up, flying"),
    ("M", "plan on and off"),
    ("H", "plan coloured by the number of cells seen"),
    ("L", "a sightline to each cell that is seen"),
    ("O", "borders of the cells in view"),
    ("P", "freeze what is drawn, and fly out to look at it"),
    ("1 2 3", "painted, traced, or both side by side"),
    ("T", "pictures on the walls, or plain colours"),
    ("click in the plan", "this cell's PVS"),
    (
        "Shift-click in the plan",
        "why the first cell sees this one, or not",
    ),
    ("double-click in the plan", "go there"),
    ("right click in the plan", "more"),
    ("R", "record a walk, or end it"),
    ("B", "change the level: drag corners, click doors"),
    ("Ctrl Z, Ctrl Y", "take back, do again"),
    ("Ctrl O, Ctrl Q", "open a level; quit"),
    ("Esc", "nothing chosen"),
    ("F3, F5", "times of the window itself; read the file again"),
];

impl App {
    /// Windows that lie over everything.
    pub(super) fn windows(&mut self, ui: &mut Ui) {
        let context = ui.ctx().clone();
        let mut open = self.settings.help;
        centred("Keys", &context)
            .open(&mut open)
            .resizable(false)
            .show(&context, |ui| {
                egui::Grid::new("keys")
                    .num_columns(2)
                    .striped(true)
                    .show(ui, |ui| {
                        for (key, what) in KEYS {
                            ui.label(RichText::new(key).strong());
                            ui.label(what);
                            ui.end_row();
                        }
                    });
            });
        self.settings.help = open;
        if let Some(error) = self.error.clone() {
            let mut open = true;
            centred("This does not work", &context)
                .open(&mut open)
                .show(&context, |ui| {
                    ui.label(error);
                    if self.document.is_some() {
                        ui.label(RichText::new("What was open stays open.").weak());
                    }
                    if ui.button("Close").clicked() {
                        self.error = None;
                    }
                });
            if !open {
                self.error = None;
            }
        }
        self.keep_window(&context);
        if let Some(mut path) = self.saving.take() {
            let (mut open, mut go) = (true, false);
            centred("Save as TOML", &context)
                .open(&mut open)
                .show(&context, |ui| {
                    ui.text_edit_singleline(&mut path).request_focus();
                    ui.horizontal(|ui| {
                        go = ui.button("Save").clicked()
                            || ui.input(|i| i.key_pressed(egui::Key::Enter));
                        if ui.button("Browse…").clicked() {
                            self.choose(Wanted::Save);
                        }
                    });
                });
            if go {
                self.save(path.into());
            } else if open {
                self.saving = Some(path);
            }
        }
        if let Some(mut typed) = self.typed.take() {
            let (mut open, mut go) = (true, false);
            centred("Open a level", &context)
                .open(&mut open)
                .show(&context, |ui| {
                    ui.label(
                    "Path of a level file; or drop it on the window. After a # the map of a WAD.",
                );
                    let field = ui.text_edit_singleline(&mut typed);
                    field.request_focus();
                    ui.horizontal(|ui| {
                        go = ui.button("Open").clicked()
                            || ui.input(|i| i.key_pressed(egui::Key::Enter));
                        if ui.button("Browse…").clicked() {
                            self.choose(Wanted::Level);
                        }
                    });
                });
            if go {
                let (path, map) = match typed.rsplit_once('#') {
                    Some((path, map)) => (path, Some(map.to_string())),
                    None => (&typed[..], None),
                };
                self.open(path.into(), map);
            } else if open {
                self.typed = Some(typed);
            }
        }
    }
}

/// A window that comes up in the middle of everything.
pub(super) fn centred<'o>(title: &str, context: &egui::Context) -> egui::Window<'o> {
    egui::Window::new(title)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(context.content_rect().center())
}
