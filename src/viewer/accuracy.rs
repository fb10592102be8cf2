//! What accuracy costs: of a traced picture, as one turns the knobs; and of ways to a PVS.

use eframe::egui;
use egui::{Color32, RichText, Ui};

use super::app::App;
use super::costs::Knobs;
use super::methods::Contender;
use crate::level::wording::grouped;

/// Of what sees too much, and too little.
const EXTRA: Color32 = super::plan::EXTRA;
const MISSED: Color32 = super::plan::MISSED;

impl App {
    pub(super) fn accuracy(&mut self, ui: &mut Ui) {
        ui.label(RichText::new("A traced picture (2, 3)").strong());
        ui.label(RichText::new("under each knob: what it has cost, standing here").weak());
        ui.add_space(4.0);
        let s = &mut self.settings;
        ui.add(whole(&mut s.samples, 1..=64).text("samples in a pixel"));
        self.costs(ui, |k| k.samples.to_string(), |k, o| k.samples = o.samples);
        let s = &mut self.settings;
        ui.checkbox(
            &mut s.adaptive,
            "four times as many where neighbours differ",
        );
        let named = |k: &Knobs| if k.adaptive { "with" } else { "without" }.to_string();
        self.costs(ui, named, |k, o| k.adaptive = o.adaptive);
        let s = &mut self.settings;
        ui.add(egui::Slider::new(&mut s.depth, 0..=16).text("reflections in a row"));
        self.costs(ui, |k| k.depth.to_string(), |k, o| k.depth = o.depth);
        let s = &mut self.settings;
        let slider = egui::Slider::new(&mut s.threshold, 0.0005..=0.5).logarithmic(true);
        ui.add(slider.text("smallest share of light"));
        let named = |k: &Knobs| format!("{:.4}", k.threshold);
        self.costs(ui, named, |k, o| k.threshold = o.threshold);
        let s = &mut self.settings;
        ui.add(whole(&mut s.rays, 1..=64).text("rays to lights, into cones"));
        self.costs(ui, |k| k.rays.to_string(), |k, o| k.rays = o.rays);
        let s = &mut self.settings;
        ui.horizontal(|ui| {
            let mut own = s.stops.is_some();
            if ui.checkbox(&mut own, "exposure by hand").changed() {
                s.stops = own.then_some(0.0);
            }
            if let Some(stops) = &mut s.stops {
                ui.add(egui::Slider::new(stops, -4.0..=6.0).suffix(" stops"));
            }
        });
        ui.add_space(6.0);
        if let Some((_, traced)) = &self.traced {
            egui::Grid::new("traced").num_columns(2).show(ui, |ui| {
                let mut row = |name: &str, value: String| {
                    ui.label(RichText::new(name).weak());
                    ui.label(value);
                    ui.end_row();
                };
                row("picture", format!("{:.0} ms", traced.milliseconds));
                row("rays", grouped(traced.rays));
                row("since the eye rests", format!("{:.0} ms", traced.since));
                row("samples", traced.samples.to_string());
            });
        } else {
            ui.label(RichText::new("no picture is traced now").weak());
        }
        ui.separator();
        self.visibility(ui);
    }

    /// What one knob has cost at its settings.
    fn costs(&self, ui: &mut Ui, name: fn(&Knobs) -> String, turn: fn(&mut Knobs, &Knobs)) {
        let now = self.knobs();
        let mut tried: Vec<_> = (self.costs.along(&now, turn).into_iter())
            .map(|(knobs, ms)| (name(&knobs), ms, knobs == now))
            .collect();
        tried.sort_by(|p, q| p.1.total_cmp(&q.1));
        ui.horizontal_wrapped(|ui| {
            ui.add_space(12.0);
            for (name, ms, is_now) in tried {
                let text = RichText::new(format!("{name}: {ms:.0} ms")).size(11.0);
                ui.label(if is_now { text.strong() } else { text.weak() });
            }
        });
    }

    /// The ways to a PVS: what they cost, and what they get wrong.
    fn visibility(&mut self, ui: &mut Ui) {
        let Some(document) = self.document.clone() else {
            return;
        };
        ui.label(RichText::new("Visible sets of the whole level").strong());
        ui.label(RichText::new("measured in this level when you ask; pairs of cells").weak());
        ui.add_space(4.0);
        let running = self.methods.running();
        let mut ask = None;
        let mut shown = self.methods.shown;
        egui::Grid::new("methods")
            .num_columns(5)
            .striped(true)
            .show(ui, |ui| {
                for title in ["method", "ms", "too many", "missed", ""] {
                    ui.label(RichText::new(title).weak());
                }
                ui.end_row();
                for contender in Contender::ALL {
                    ui.label(contender.name()).on_hover_text(contender.hint());
                    match (self.methods.of(contender), running) {
                        (_, Some((now, share))) if now == contender => {
                            let bar = egui::ProgressBar::new(share).desired_width(50.0);
                            ui.add(bar.show_percentage());
                            if ui.button("stop").clicked() {
                                self.methods.stop();
                            }
                        }
                        (Some(rival), _) => {
                            ui.label(format!("{:.1}", rival.milliseconds));
                            let count = |n: u64, colour| {
                                let text = RichText::new(grouped(n));
                                if n > 0 { text.color(colour) } else { text }
                            };
                            ui.label(count(rival.extra, EXTRA));
                            ui.label(count(rival.missed, MISSED));
                            let mut on = shown == Some(contender);
                            let hint = "show on the plan what the chosen cell sees more, and less";
                            if ui.checkbox(&mut on, "show").on_hover_text(hint).changed() {
                                shown = on.then_some(contender);
                            }
                        }
                        (None, _) => {
                            let button = egui::Button::new("measure").small();
                            if ui.add_enabled(running.is_none(), button).clicked() {
                                ask = Some(contender);
                            }
                        }
                    }
                    ui.end_row();
                }
            });
        self.methods.shown = shown;
        if let Some(contender) = ask {
            let context = self.context.clone();
            let wake = move || context.request_repaint();
            self.methods.measure(&document, contender, wake);
        }
        if running.is_some() {
            let soon = std::time::Duration::from_millis(200);
            ui.ctx().request_repaint_after(soon);
        }
        if self.methods.compared().is_some() {
            ui.horizontal(|ui| {
                ui.colored_label(EXTRA, "sees too much");
                ui.colored_label(MISSED, "misses");
            });
        }
    }
}

/// A slider for whole numbers, of which the small ones matter most.
fn whole(value: &mut u32, range: std::ops::RangeInclusive<u32>) -> egui::Slider<'_> {
    egui::Slider::new(value, range).logarithmic(true)
}
