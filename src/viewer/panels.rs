//! What stands around the view and the plan: menus, status, statistics, effects, explanations, findings.

use eframe::egui;
use egui::{Color32, RichText, Ui};
use egui_plot::{Legend, Line, Plot, PlotPoints};
use glam::DVec3;

use super::app::{App, Tab, View, Wanted};
use super::walker::{Mode, Walker};
use crate::cells::CellId;
use crate::level::wording::grouped;
use crate::level::{Finding, Place, Severity};
use crate::preview::Culling;

/// Of what is well.
pub(super) const GOOD: Color32 = Color32::from_rgb(110, 220, 130);
/// How many cells are listed.
const LISTED: usize = 8;

impl App {
    /// The menus.
    pub(super) fn menu(&mut self, ui: &mut Ui) {
        egui::MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| {
                if ui.button("Open… (Ctrl O)").clicked() {
                    self.typed = Some(String::new());
                }
                if !self.recent.is_empty() {
                    ui.menu_button("Recent", |ui| {
                        for (path, map) in self.recent.clone() {
                            let name = path.file_name().unwrap_or_default().to_string_lossy();
                            let text = match &map {
                                Some(map) => format!("{name}, {map}"),
                                None => name.into_owned(),
                            };
                            let button = ui.button(text).on_hover_text(path.display().to_string());
                            if button.clicked() {
                                self.open(path, map);
                            }
                        }
                    });
                }
                if ui.button("Read again (F5)").clicked() {
                    self.reload();
                }
                if ui.button("Save as TOML…").clicked() {
                    let name = self.document.as_ref().map(|d| d.level.name.clone());
                    let name = name.unwrap_or_default().to_lowercase().replace(' ', "-");
                    self.saving = Some(format!("{name}.toml"));
                }
                if ui.button("Quit (Ctrl Q)").clicked() {
                    ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
                }
            });
            ui.menu_button("View", |ui| {
                let s = &mut self.settings;
                ui.radio_value(&mut s.view, View::Painted, "Painted polygons (1)");
                ui.radio_value(&mut s.view, View::Traced, "Traced rays (2)");
                ui.radio_value(&mut s.view, View::Both, "Both, side by side (3)");
                ui.separator();
                ui.checkbox(&mut s.plan, "Plan (M)");
                ui.checkbox(&mut s.heat, "Cells seen, in colours (H)");
                ui.checkbox(
                    &mut s.sightlines,
                    "A sightline to each cell that is seen (L)",
                );
                ui.checkbox(&mut s.outlines, "Borders of the cells in view (O)");
                ui.checkbox(&mut s.textured, "Pictures on walls (T)");
                ui.checkbox(&mut self.plan.follow, "Plan follows the eye");
                if ui.button("Whole plan").clicked() {
                    self.plan.show_all();
                }
                let mut frozen = self.frozen.is_some();
                if ui
                    .checkbox(&mut frozen, "Freeze what is drawn (P)")
                    .changed()
                {
                    self.freeze();
                }
                let mut editing = self.editing.is_some();
                if ui
                    .checkbox(&mut editing, "Change the level on the plan (B)")
                    .changed()
                {
                    self.edit();
                }
                ui.checkbox(&mut self.settings.debug, "Times of the window (F3)");
                ui.separator();
                ui.add(
                    egui::Slider::new(&mut self.settings.fov, 30.0..=120.0).text("angle of view"),
                );
            });
            ui.menu_button("Go", |ui| self.go_menu(ui));
            ui.menu_button("Help", |ui| {
                if ui.button("Keys (F1)").clicked() {
                    self.settings.help = true;
                }
            });
            if let Some(name) = self.busy() {
                ui.spinner();
                ui.label(format!("reading {name}"));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                self.modes(ui);
            });
        });
    }

    /// What is switched most often, at the right of the menus.
    fn modes(&mut self, ui: &mut Ui) {
        let s = &mut self.settings;
        ui.toggle_value(&mut s.plan, "Plan").on_hover_text("M");
        ui.separator();
        let mut mode = |ui: &mut Ui, mode, text, key| {
            ui.selectable_value(&mut self.eye.mode, mode, text)
                .on_hover_text(key);
        };
        mode(ui, Mode::Fly, "Fly", "F: through walls");
        mode(ui, Mode::Walk, "Walk", "F: on the ground");
        ui.separator();
        let mut view = |ui: &mut Ui, view, text, key| {
            ui.selectable_value(&mut s.view, view, text)
                .on_hover_text(key);
        };
        view(ui, View::Both, "Both", "3: side by side");
        view(ui, View::Traced, "Traced", "2: by rays");
        view(
            ui,
            View::Painted,
            "Painted",
            "1: polygons in the BSP's order",
        );
    }

    fn go_menu(&mut self, ui: &mut Ui) {
        let mut fly = self.eye.mode == Mode::Fly;
        if ui.checkbox(&mut fly, "Fly (F)").changed() {
            self.eye.mode = if fly { Mode::Fly } else { Mode::Walk };
        }
        let Some(document) = self.document.clone() else {
            return;
        };
        if !document.level.scene.cameras.is_empty() {
            ui.menu_button("Camera", |ui| {
                for camera in &document.level.scene.cameras {
                    if ui.button(&camera.name).clicked() {
                        self.look_from(camera);
                    }
                }
            });
        }
        for path in self.paths() {
            if ui.button(format!("Walk: {}", path.name)).clicked() {
                self.play(Some(&path.name));
            }
        }
        if ui.button("A tour of all that can be reached").clicked() {
            self.play(None);
        }
        ui.separator();
        let text = match self.recording {
            None => "Record a walk (R)",
            Some(_) => "End the walk that is recorded (R)",
        };
        if ui.button(text).clicked() {
            self.record();
        }
        if ui.button("Walks from a file…").clicked() {
            self.choose(Wanted::Walks);
        }
    }

    /// The line at the bottom.
    pub(super) fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            self.walk_bar(ui);
            let (Some(document), Some(seen)) = (&self.document, &self.seen) else {
                ui.label("drop a level file here, or open one in the menu");
                return;
            };
            let p = self.eye.eye;
            ui.label(match seen.cell {
                Some(cell) => format!(
                    "cell {} · {} · PVS {} of {} cells · in view {}",
                    cell.0,
                    document.sector(cell),
                    document.sees[cell.0 as usize],
                    document.graph.cells.len(),
                    seen.cells.len()
                ),
                None => "outside of the level".to_string(),
            });
            ui.separator();
            ui.label(format!("{:.2}, {:.2}, {:.2}", p.x, p.y, p.z));
            ui.separator();
            let ms: f64 = seen.milliseconds.iter().sum();
            ui.label(format!("{} polygons · {ms:.1} ms", seen.figures.painted));
            if let Some(note) = &self.note {
                ui.separator();
                ui.colored_label(GOOD, note);
            }
        });
    }

    /// The side panel.
    pub(super) fn side(&mut self, ui: &mut Ui) {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            for (tab, name) in [
                (Tab::Statistics, "Statistics"),
                (Tab::Effects, "Effects"),
                (Tab::Accuracy, "Accuracy"),
                (Tab::Why, "Why"),
                (Tab::Findings, "Findings"),
            ] {
                ui.selectable_value(&mut self.settings.tab, tab, name);
            }
        });
        ui.separator();
        egui::ScrollArea::vertical()
            .auto_shrink(false)
            .show(ui, |ui| match self.settings.tab {
                Tab::Statistics => self.statistics(ui),
                Tab::Effects => self.effects(ui),
                Tab::Accuracy => self.accuracy(ui),
                Tab::Why => self.why(ui),
                Tab::Findings => self.findings(ui),
            });
    }

    fn statistics(&mut self, ui: &mut Ui) {
        let Some(document) = &self.document else {
            return;
        };
        let level = &document.level;
        ui.heading(&level.name);
        let row = |ui: &mut Ui, name: &str, value: String| {
            ui.label(RichText::new(name).weak());
            ui.label(value);
            ui.end_row();
        };
        egui::Grid::new("level").num_columns(2).show(ui, |ui| {
            row(ui, "cells", grouped(document.graph.cells.len() as u64));
            row(ui, "portals", grouped(document.graph.portals.len() as u64));
            row(ui, "walls", grouped(level.walls.len() as u64));
            row(
                ui,
                "cutting",
                format!("{:.1} ms", document.stages.subdivide),
            );
            row(
                ui,
                "visibility",
                format!("{:.1} ms", document.stages.visibility),
            );
        });
        ui.add_space(8.0);
        ui.label(RichText::new("What is drawn").strong());
        for (culling, name) in [
            (Culling::None, "everything"),
            (Culling::Pvs, "the PVS of the eye's cell"),
            (Culling::Eye, "what the eye sees"),
        ] {
            let k = Culling::ALL.iter().position(|c| *c == culling).unwrap_or(0);
            let cost = self.seen.as_ref().map(|s| s.polygons[k]).unwrap_or(0);
            let text = format!("{name}: {} polygons", grouped(cost));
            ui.radio_value(&mut self.settings.culling, culling, text);
        }
        if let Some(seen) = &self.seen {
            ui.add_space(8.0);
            egui::Grid::new("frame").num_columns(2).show(ui, |ui| {
                let [found, painted] = seen.milliseconds;
                row(ui, "painted", grouped(seen.figures.painted));
                row(ui, "of all polygons", grouped(seen.figures.all));
                // The graphics card does not count it.
                let overdraw = seen.figures.overdraw();
                if overdraw > 0.0 {
                    row(ui, "overdraw", format!("{overdraw:.2}"));
                }
                row(ui, "to find out", format!("{found:.2} ms"));
                row(ui, "to paint", format!("{painted:.2} ms"));
                if let Some((_, traced)) = &self.traced {
                    row(ui, "rays traced", grouped(traced.rays));
                    row(ui, "to trace", format!("{:.0} ms", traced.milliseconds));
                }
            });
        }
        ui.add_space(8.0);
        self.dearest(ui);
        ui.add_space(8.0);
        let points = |value: fn(&super::app::Sample) -> f64| -> PlotPoints<'_> {
            let all = self.history.iter().enumerate();
            all.map(|(i, s)| [i as f64, value(s)]).collect()
        };
        for (name, value) in [
            (
                "milliseconds",
                (|s| s.milliseconds) as fn(&super::app::Sample) -> f64,
            ),
            ("polygons", |s| s.polygons),
        ] {
            Plot::new(name)
                .height(110.0)
                .legend(Legend::default())
                .include_y(0.0)
                .show_axes([false, true])
                .allow_drag(false)
                .allow_zoom(false)
                .allow_scroll(false)
                .show(ui, |plot| plot.line(Line::new(name, points(value))));
        }
        if self.settings.debug {
            let [most, last] = self.thread;
            ui.label(RichText::new("The window's own thread").strong());
            ui.label(format!("last frame {last:.2} ms, longest {most:.2} ms"));
            if ui.button("from now on").clicked() {
                self.thread = [0.0; 2];
            }
        }
    }

    /// The cells that see most, to go to.
    fn dearest(&mut self, ui: &mut Ui) {
        let Some(document) = self.document.clone() else {
            return;
        };
        egui::CollapsingHeader::new("Most expensive cells")
            .default_open(true)
            .show(ui, |ui| {
                let n = document.graph.cells.len() as f64;
                egui::Grid::new("dearest").num_columns(3).show(ui, |ui| {
                    for &cell in document.dearest.iter().take(LISTED) {
                        let text = format!("cell {}", cell.0);
                        let link = ui.link(text).on_hover_text("choose it on the plan");
                        if link.clicked() {
                            self.choose_cell(cell);
                        }
                        ui.label(document.sector(cell));
                        let sees = document.sees[cell.0 as usize];
                        let share = f64::from(sees) / n * 100.0;
                        ui.label(format!("sees {sees} ({share:.0} %)"));
                        ui.end_row();
                    }
                });
            });
    }

    /// Makes a cell the source, and shows it on the plan.
    pub fn choose_cell(&mut self, cell: CellId) {
        (self.source, self.second, self.explained) = (Some(cell), None, None);
        self.settings.plan = true;
        if let Some(document) = &self.document {
            self.plan.look_at(document.world.middle(cell).0);
        }
    }

    fn effects(&mut self, ui: &mut Ui) {
        let survey = self.seen.as_ref().and_then(|s| s.survey.clone());
        let Some(survey) = survey else {
            ui.label("the eye is outside of the level");
            return;
        };
        ui.label("What a traced picture from this cell calls for, and why:");
        ui.add_space(6.0);
        for verdict in &survey.verdicts {
            let (sign, colour) = if self.settings.without.has(verdict.effect) && verdict.needed {
                ("left out by you", Color32::from_rgb(236, 190, 90))
            } else if verdict.needed {
                ("on", GOOD)
            } else {
                ("off", Color32::GRAY)
            };
            ui.horizontal(|ui| {
                let mut on = verdict.needed && !self.settings.without.has(verdict.effect);
                let name = RichText::new(verdict.effect.as_str()).strong();
                if ui
                    .add_enabled(verdict.needed, egui::Checkbox::new(&mut on, name))
                    .changed()
                {
                    let without = self.settings.without;
                    self.settings.without = if on {
                        without.without(verdict.effect)
                    } else {
                        without.with(verdict.effect)
                    };
                }
                ui.label(RichText::new(sign).color(colour).strong());
            });
            ui.label(RichText::new(&verdict.reason).weak());
            ui.add_space(6.0);
        }
    }

    fn why(&mut self, ui: &mut Ui) {
        if ui
            .checkbox(&mut self.settings.heights, "floors and ceilings count")
            .changed()
        {
            self.ask_why();
        }
        if let (Some(document), Some(cell)) = (self.document.clone(), self.subject())
            && let Some((farthest, distance)) = document.farthest(cell)
        {
            let text = format!("why cell {} sees cell {}", cell.0, farthest.0);
            let hint = format!("the farthest that it sees, {distance:.1} away");
            if ui.button(text).on_hover_text(hint).clicked() {
                self.ask_why_of(cell, farthest);
            }
        }
        ui.separator();
        match &self.explained {
            None => {
                ui.label(
                    "Click a cell in the plan, then another one with Shift (or with the right button: \
                     from the eye's cell): here stands why the one sees the other, or what is in the way.",
                );
            }
            Some(explained) => {
                let [a, b] = explained.cells.map(|c| c.0);
                let (verb, colour) = if explained.sees {
                    ("sees", GOOD)
                } else {
                    ("does not see", Color32::from_rgb(230, 120, 130))
                };
                ui.label(
                    RichText::new(format!("Cell {a} {verb} cell {b}"))
                        .color(colour)
                        .strong(),
                );
                ui.label(RichText::new(format!("{:.1} ms", explained.milliseconds)).weak());
                let look = explained
                    .rise
                    .filter(|_| ui.button("Look along the sightline").clicked());
                ui.add_space(6.0);
                ui.label(RichText::new(&explained.text).monospace().size(11.5));
                if let Some(line) = look {
                    self.look_along(line);
                }
            }
        }
    }

    /// Puts the eye over one end of a line, and has it look at the other.
    pub fn look_along(&mut self, [from, to]: [DVec3; 2]) {
        // A little above it, or it would be a point.
        const ABOVE: f64 = 0.12;
        let Some(document) = &self.document else {
            return;
        };
        let eye = from + DVec3::Z * document.person.eye * ABOVE;
        self.eye = Walker::new(eye, to - eye, self.eye.mode);
        self.play = None;
    }

    fn findings(&mut self, ui: &mut Ui) {
        let Some(document) = self.document.clone() else {
            return;
        };
        if document.findings.is_empty() {
            ui.label("Nothing was found to be wrong.");
        }
        for finding in &document.findings {
            self.finding(ui, finding);
        }
    }

    fn finding(&mut self, ui: &mut Ui, finding: &Finding) {
        const SHOWN: usize = 8;
        let colour = match finding.severity {
            Severity::Note => Color32::LIGHT_BLUE,
            Severity::Warning => Color32::from_rgb(236, 190, 90),
            Severity::Repaired => Color32::from_rgb(236, 140, 90),
        };
        ui.label(RichText::new(finding.code).color(colour).strong());
        ui.label(&finding.message);
        ui.horizontal_wrapped(|ui| {
            for place in finding.places.iter().take(SHOWN) {
                let text = place.to_string();
                if let Place::Point { x, y } = *place {
                    if ui.link(text).clicked() {
                        self.mark = Some(glam::DVec2::new(x, y));
                        self.jump(glam::DVec2::new(x, y));
                    }
                } else {
                    ui.label(text);
                }
            }
            let more = finding.places.len().saturating_sub(SHOWN);
            if more > 0 {
                ui.label(format!("and {more} more"));
            }
        });
        ui.add_space(8.0);
    }
}
