//! The view and the plan: what they show, and what is asked of the threads beside the window.

use eframe::egui;
use eframe::wgpu;
use egui::{Color32, ColorImage, Sense, TextureHandle, TextureOptions, Ui};
use glam::DVec2;

use super::app::{App, HISTORY, PIXELS, Sample, View};
use super::costs::Knobs;
use super::engine::{Look, Picture, Seen};
use super::plan::{PlanEvent, PlanScene};
use super::tracing::{Request, Tracing};
use crate::trace::picture::Exposure;
use crate::trace::render::{Adaptive, RenderOptions};
use crate::trace::shade::Limits;

/// Difference between neighbours, from 0 (black) to 1 (white), from which on more samples are taken.
const CONTRAST: f64 = 0.05;

/// How bright Doom maps are shown, in stops: their sectors' light is meant for dark rooms.
const DOOM: f64 = 1.5;

impl App {
    /// Shows what an eye has seen.
    pub(super) fn take(&mut self, seen: Seen) {
        match &seen.picture {
            Picture::Bytes(bytes) => {
                let size = seen.look.camera.size.map(|n| n as usize);
                let image = ColorImage::from_rgb(size, bytes);
                let options = TextureOptions::NEAREST;
                match &mut self.picture {
                    Some(texture) => texture.set(image, options),
                    None => {
                        self.picture = Some(self.context.load_texture("view", image, options));
                    }
                }
                self.shown = self.picture.as_ref().map(TextureHandle::id);
            }
            Picture::Card(slot, view) => {
                if let Some(card) = &self.card {
                    let mut renderer = card.renderer.write();
                    let filter = wgpu::FilterMode::Linear;
                    let id = match self.slots[*slot] {
                        Some(id) => {
                            renderer.update_egui_texture_from_wgpu_texture(
                                &card.device,
                                view,
                                filter,
                                id,
                            );
                            id
                        }
                        None => renderer.register_native_texture(&card.device, view, filter),
                    };
                    self.slots[*slot] = Some(id);
                    self.shown = Some(id);
                }
            }
        }
        let before = self.seen.as_ref().and_then(|s| s.cell);
        if let (Some(log), Some(cell), Some(document)) = (self.log, seen.cell, &self.document)
            && before != Some(cell)
        {
            let [x, y, z] = seen.look.camera.eye.to_array();
            let pvs = document.sees[cell.0 as usize];
            log(&format!(
                "eye {x:.4} {y:.4} {z:.4} cell {} pvs {pvs}",
                cell.0
            ));
        }
        self.history.push_back(Sample {
            polygons: seen.figures.painted as f64,
            milliseconds: seen.milliseconds.iter().sum(),
        });
        while self.history.len() > HISTORY {
            self.history.pop_front();
        }
        self.seen = Some(seen);
    }

    /// The 3D view, in all the room there is.
    pub(super) fn view(&mut self, ui: &mut Ui) {
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, "View into the level")
        });
        let rect = response.rect;
        let scale = ui.ctx().pixels_per_point();
        let pixels = rect.size() * scale;
        let shrink = (PIXELS / pixels.max_elem()).min(1.0);
        self.size = [pixels.x, pixels.y].map(|n| ((n * shrink) as u32).max(1));
        if response.clicked() {
            self.capture(!self.captured);
        }
        if response.dragged() && !self.captured {
            // What is under the pointer stays there, about.
            let turn = self.settings.fov.to_radians() / f64::from(rect.width().max(1.0));
            let d = response.drag_delta();
            self.look += DVec2::new(f64::from(d.x), f64::from(d.y)) * turn;
            self.context.request_repaint();
        }
        painter.rect_filled(rect, 0.0, Color32::BLACK);
        let part = |from: f32, to: f32| {
            let uv = egui::Rect::from_min_max(egui::pos2(from, 0.0), egui::pos2(to, 1.0));
            let at = |share: f32| rect.left() + share * rect.width();
            let room = egui::Rect::from_x_y_ranges(at(from)..=at(to), rect.y_range());
            (room, uv)
        };
        // With both, the left half of the one picture and the right half of the other.
        let split = match self.settings.view {
            View::Painted => 1.0,
            View::Traced => 0.0,
            View::Both => 0.5,
        };
        if let Some(id) = self.shown
            && split > 0.0
        {
            let (room, uv) = part(0.0, split);
            painter.image(id, room, uv, Color32::WHITE);
        }
        if let Some((texture, traced)) = &self.traced
            && split < 1.0
        {
            let (room, uv) = part(split, 1.0);
            painter.image(texture.id(), room, uv, Color32::WHITE);
            let text = if traced.done {
                format!("traced: {} samples", traced.samples)
            } else {
                format!(
                    "tracing: every {} pixels, {} samples",
                    traced.coarse, traced.samples
                )
            };
            let font = egui::FontId::proportional(13.0);
            let at = rect.right_bottom() - egui::vec2(10.0, 8.0);
            painter.text(at, egui::Align2::RIGHT_BOTTOM, text, font, Color32::WHITE);
        }
        if self.settings.view == View::Both {
            let middle = rect.center().x;
            let line = egui::Stroke::new(2.0, Color32::WHITE);
            painter.vline(middle, rect.y_range(), line);
        }
        self.overlay(&painter, rect);
        if self.frozen.is_some() {
            let font = egui::FontId::proportional(14.0);
            let at = rect.center_top() + egui::vec2(0.0, 10.0);
            let text = "frozen: what is drawn was chosen where you pressed P";
            painter.text(at, egui::Align2::CENTER_TOP, text, font, Color32::YELLOW);
        }
        let hint = if self.captured {
            "the mouse looks around; Esc or a click frees it"
        } else if response.hovered() && self.document.is_some() {
            "drag to look around, or click to let the mouse do so; W A S D to walk"
        } else {
            return;
        };
        let font = egui::FontId::proportional(12.0);
        let at = rect.center_bottom() - egui::vec2(0.0, 8.0);
        let faint = Color32::from_white_alpha(150);
        painter.text(at, egui::Align2::CENTER_BOTTOM, hint, font, faint);
    }

    /// Gives the mouse to the view, or frees it.
    pub fn capture(&mut self, captured: bool) {
        use egui::viewport::{CursorGrab, ViewportCommand};
        if captured == self.captured {
            return;
        }
        self.captured = captured;
        let send = |command| self.context.send_viewport_cmd(command);
        if captured {
            // Where a pointer cannot be held in its place (X11), it is kept within the window.
            send(ViewportCommand::CursorGrab(CursorGrab::Confined));
            send(ViewportCommand::CursorGrab(CursorGrab::Locked));
        } else {
            send(ViewportCommand::CursorGrab(CursorGrab::None));
        }
        send(ViewportCommand::CursorVisible(!captured));
    }

    /// What a traced picture is asked for.
    pub fn knobs(&self) -> Knobs {
        let s = &self.settings;
        Knobs {
            samples: s.samples,
            adaptive: s.adaptive,
            depth: s.depth,
            threshold: s.threshold,
            rays: s.rays,
            without: s.without,
        }
    }

    /// Asks what the eye sees, if that has changed.
    pub(super) fn ask(&mut self) {
        let Some(engine) = &self.engine else { return };
        let look = Look {
            camera: self.camera(),
            chosen_by: self.frozen,
            culling: self.settings.culling,
            textured: self.settings.textured,
        };
        if self.size[0] > 0 && self.asked != Some(look) {
            engine.look(look);
            self.asked = Some(look);
        }
    }

    /// Asks for a traced picture, if what it shows has changed.
    pub(super) fn trace(&mut self) {
        if self.settings.view == View::Painted {
            if self.requested.take().is_some() {
                self.tracing.iter().for_each(Tracing::stop);
            }
            return;
        }
        let (Some(document), Some(seen)) = (&self.document, &self.seen) else {
            return;
        };
        let camera = self.camera();
        // First the eye's cell has to be known, and with it what matters there.
        let Some(survey) = seen.survey.as_ref().filter(|_| seen.look.camera == camera) else {
            return;
        };
        let knobs = self.knobs();
        let exposure = match self.settings.stops {
            Some(stops) => Exposure::Stops(stops),
            None if document.world.wardrobe.is_some() => Exposure::Stops(DOOM),
            None => Exposure::Auto,
        };
        let request = (camera, knobs, exposure);
        if self.requested == Some(request) {
            return;
        }
        if self.tracing.is_none() {
            let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
            let context = self.context.clone();
            let wake = move || context.request_repaint();
            self.tracing = Tracing::start(threads.saturating_sub(1).max(1), wake).ok();
        }
        let Some(tracing) = &self.tracing else { return };
        let usual = RenderOptions::default();
        let effects = survey.needed.iter().filter(|e| !knobs.without.has(*e));
        let options = RenderOptions {
            samples: knobs.samples,
            adaptive: knobs.adaptive.then_some(Adaptive {
                samples: knobs.samples * 4,
                contrast: CONTRAST,
                exposure,
            }),
            effects: effects.collect(),
            limits: Limits {
                depth: knobs.depth,
                threshold: knobs.threshold,
                light_samples: knobs.rays,
                scatter_samples: knobs.rays,
            },
            ..usual
        };
        tracing.request(Request {
            stage: document.clone(),
            camera,
            options,
            exposure,
        });
        self.requested = Some(request);
    }

    /// The plan, in all the room there is.
    pub(super) fn plan(&mut self, ui: &mut Ui) {
        let Some(document) = self.document.clone() else {
            // So that the room is not given away meanwhile.
            ui.take_available_space();
            return;
        };
        let seen = self.seen.as_ref();
        let explained = self.explanation();
        let subject = self.subject();
        let fan = self.sightlines.as_ref();
        let fan = fan.filter(|s| subject.is_some_and(|cell| s.are_of(&document, cell)));
        let half = (self.settings.fov / 2.0).to_radians();
        let scene = PlanScene {
            document: &document,
            eye: (
                self.eye.eye.truncate(),
                DVec2::from_angle(self.eye.yaw),
                half,
            ),
            cell: seen.and_then(|s| s.cell),
            cells: seen.map_or(&[], |s| &s.cells),
            area: seen.map_or(&[], |s| &s.area),
            source: self.source,
            second: self.second,
            sightline: explained.and_then(|e| e.line),
            way: explained.map_or(&[], |e| &e.way),
            path: self.play.as_ref().map_or(&[], |p| &p.line),
            heat: self.settings.heat,
            mark: self.mark,
            sightlines: fan,
            rival: self.methods.compared(),
            recorded: self.recording.as_ref().map_or(&[], |r| &r.points),
            editing: self.editing.is_some(),
        };
        let mut plan = self.plan;
        let event = plan.show(ui, &scene);
        self.plan = plan;
        match event {
            Some(PlanEvent::Grab(at, within)) => {
                let held = self.grab(at, within);
                self.plan.held = held;
            }
            Some(PlanEvent::Drag(to)) => self.drag(to),
            Some(PlanEvent::Drop) => self.drop_corner(),
            Some(PlanEvent::Door(at, within)) => {
                if self.editing.is_none() {
                    self.edit();
                }
                self.toggle_door(at, within);
            }
            Some(PlanEvent::Jump(at)) => {
                self.source = None;
                self.jump(at);
            }
            Some(PlanEvent::Source(cell)) => {
                (self.source, self.second, self.explained) = (Some(cell), None, None);
            }
            Some(PlanEvent::Second(cell)) => {
                self.source = self.source.or(self.seen.as_ref().and_then(|s| s.cell));
                self.second = Some(cell);
                self.ask_why();
            }
            Some(PlanEvent::Why(cell)) => {
                if let Some(own) = self.seen.as_ref().and_then(|s| s.cell) {
                    self.ask_why_of(own, cell);
                }
            }
            Some(PlanEvent::Edit) => self.edit(),
            Some(PlanEvent::Clear) => {
                (self.source, self.second, self.explained) = (None, None, None);
            }
            None => {}
        }
    }
}
