//! The plan: cells, what the eye sees of them, sightlines; to look at, and to click on.
//!
//! x to the right, y up, as in the level. Drag with the right or middle button to move, turn the wheel
//! to zoom; a click makes a cell the source, a click with shift asks why the source sees it, a double
//! click sends the eye there.

use eframe::egui;
use egui::{Align2, Color32, FontId, Mesh, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2};
use glam::{DVec2, DVec3};

use super::document::{Document, Line};
use super::methods::Rival;
use super::sightlines::Sightlines;
use crate::cells::CellId;

/// Which part of the plan is shown.
#[derive(Clone, Copy, Debug)]
pub struct PlanView {
    /// In the middle.
    middle: DVec2,
    /// Points of the screen to a unit of the level; 0 before the first frame, which shows all.
    scale: f64,
    /// Whether the eye stays in the middle.
    pub follow: bool,
    /// Whether a drag moves a corner of the level, and not the plan.
    pub held: bool,
}

impl Default for PlanView {
    fn default() -> Self {
        Self {
            middle: DVec2::ZERO,
            scale: 0.0,
            follow: false,
            held: false,
        }
    }
}

/// What there is to show.
pub struct PlanScene<'a> {
    /// The level.
    pub document: &'a Document,
    /// Eye and view on the plan, and half of the angle of view in radians.
    pub eye: (DVec2, DVec2, f64),
    /// The eye's cell.
    pub cell: Option<CellId>,
    /// The cells within the eye's cone.
    pub cells: &'a [CellId],
    /// The area that it sees.
    pub area: &'a [Vec<DVec2>],
    /// A cell that was chosen, whose PVS is shown instead of that of the eye's cell.
    pub source: Option<CellId>,
    /// A second one.
    pub second: Option<CellId>,
    /// A sightline between the two.
    pub sightline: Option<[DVec2; 2]>,
    /// The shortest way between the two, if they do not see each other.
    pub way: &'a [DVec2],
    /// A path that is walked.
    pub path: &'a [DVec2],
    /// Colours by the size of the cells' PVS.
    pub heat: bool,
    /// A place to point at.
    pub mark: Option<DVec2>,
    /// Whether the level is changed here.
    pub editing: bool,
    /// From the source to all that it sees.
    pub sightlines: Option<&'a Sightlines>,
    /// Another method's visible sets, compared with the exact ones.
    pub rival: Option<&'a Rival>,
    /// A walk that is recorded.
    pub recorded: &'a [DVec3],
}

/// What somebody wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanEvent {
    /// The eye there.
    Jump(DVec2),
    /// This cell as the source.
    Source(CellId),
    /// To know why the source sees this cell.
    Second(CellId),
    /// Neither source nor second.
    Clear,
    /// To take hold of a corner so near to a place.
    Grab(DVec2, f64),
    /// The corner to be here.
    Drag(DVec2),
    /// To let it go.
    Drop,
    /// The door so near to a place opened, or closed.
    Door(DVec2, f64),
    /// To know why the eye's cell sees this one.
    Why(CellId),
    /// To change the level, or to end that.
    Edit,
}

/// Points of the screen that count as near.
const NEAR: f64 = 9.0;

const BACK: Color32 = Color32::from_rgb(18, 21, 26);
const FLOOR: Color32 = Color32::from_rgb(44, 50, 59);
const SEEN: Color32 = Color32::from_rgb(38, 76, 116);
pub(super) const CONE: Color32 = Color32::from_rgb(60, 118, 168);
const OWN: Color32 = Color32::from_rgb(92, 160, 220);
pub(super) const SOURCE: Color32 = Color32::from_rgb(232, 150, 62);
pub(super) const SECOND: Color32 = Color32::from_rgb(214, 96, 128);
const AREA: Color32 = Color32::from_rgba_premultiplied(72, 60, 16, 60);
const LIGHT: Color32 = Color32::from_rgb(245, 222, 140);
pub(super) const SIGHT: Color32 = Color32::from_rgb(96, 226, 130);
pub(super) const WALKED: Color32 = Color32::from_rgb(150, 120, 230);
/// What another method sees too much, and what it misses.
pub(super) const EXTRA: Color32 = Color32::from_rgb(226, 84, 84);
pub(super) const MISSED: Color32 = Color32::from_rgb(240, 208, 80);

impl PlanView {
    /// Shows everything.
    pub fn show_all(&mut self) {
        self.scale = 0.0;
    }

    /// Brings a place into the middle.
    pub fn look_at(&mut self, at: DVec2) {
        if self.scale > 0.0 {
            self.middle = at;
            self.follow = false;
        }
    }

    fn fit(&mut self, [low, high]: [DVec2; 2], rect: Rect) {
        let size = (high - low).max(DVec2::splat(1e-9));
        self.middle = (low + high) / 2.0;
        let room = DVec2::new(f64::from(rect.width()), f64::from(rect.height())) * 0.92;
        self.scale = (room / size).min_element().max(1e-9);
    }

    fn to_screen(self, rect: Rect, p: DVec2) -> Pos2 {
        let d = (p - self.middle) * self.scale;
        rect.center() + Vec2::new(d.x as f32, -d.y as f32)
    }

    fn to_plan(self, rect: Rect, p: Pos2) -> DVec2 {
        let d = p - rect.center();
        self.middle + DVec2::new(f64::from(d.x), -f64::from(d.y)) / self.scale
    }

    /// Draws the plan into all of the room there is. Returns what somebody wants.
    pub fn show(&mut self, ui: &mut Ui, scene: &PlanScene) -> Option<PlanEvent> {
        let document = scene.document;
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Canvas, true, "Plan of the level")
        });
        let rect = response.rect;
        if self.scale <= 0.0 {
            self.fit(document.plan.bounds, rect);
        }
        if self.follow {
            self.middle = scene.eye.0;
        }
        if !self.held {
            self.steer(ui, &response);
        }
        painter.rect_filled(rect, 0.0, BACK);
        let place = |p: DVec2| self.to_screen(rect, p);
        self.cells(scene, rect, &painter);
        let mut area = Mesh::default();
        for piece in scene.area {
            self.fill(&mut area, rect, piece, AREA);
        }
        painter.add(area);
        for (line, ends) in &document.plan.lines {
            let ends = ends.map(place);
            if !rect.intersects(Rect::from_two_pos(ends[0], ends[1])) {
                continue;
            }
            painter.line_segment(ends, stroke(*line));
        }
        if let Some(fan) = scene.sightlines {
            let thin = Stroke::new(0.8, SIGHT.gamma_multiply(0.45));
            for line in &fan.lines {
                painter.line_segment(line.map(place), thin);
            }
            if let Some((longest, _)) = fan.longest().filter(|_| fan.complete) {
                painter.line_segment(longest.map(place), Stroke::new(2.0, SIGHT));
            }
        }
        let walked: Vec<Pos2> = scene.path.iter().map(|p| place(*p)).collect();
        painter.add(Shape::line(walked, Stroke::new(1.5, WALKED)));
        let new: Vec<Pos2> = scene.recorded.iter().map(|p| place(p.truncate())).collect();
        painter.add(Shape::line(new, Stroke::new(2.0, Color32::RED)));
        let way: Vec<Pos2> = scene.way.iter().map(|p| place(*p)).collect();
        painter.add(Shape::dashed_line(&way, Stroke::new(1.5, SECOND), 6.0, 4.0));
        if let Some(ends) = scene.sightline {
            painter.line_segment(ends.map(place), Stroke::new(2.5, SIGHT));
        }
        if let Some(at) = scene.mark {
            painter.circle_stroke(place(at), 9.0, Stroke::new(2.0, Color32::RED));
        }
        eye(&painter, place(scene.eye.0), scene.eye.1, scene.eye.2);
        let at = response.hover_pos().map(|p| self.to_plan(rect, p));
        let cell = at.and_then(|at| document.cell_at(at));
        if let (Some(at), Some(cell)) = (at, cell) {
            self.outline(&painter, rect, document, cell, Color32::WHITE);
            let text = format!(
                "cell {}, {}\nsees {} of {} cells · {} portals\n{:.2}, {:.2}",
                cell.0,
                document.sector(cell),
                document.sees[cell.0 as usize],
                document.graph.cells.len(),
                document.portals(cell),
                at.x,
                at.y
            );
            label(&painter, rect, text);
        } else if let Some(fan) = scene.sightlines {
            let longest = fan.longest().map_or(0.0, |l| l.1);
            let text = format!(
                "{} sightlines from cell {}\nthe longest is {longest:.2} long",
                fan.lines.len(),
                fan.cell.0
            );
            label(&painter, rect, text);
        }
        if scene.heat {
            legend(&painter, rect, document);
        }
        if scene.editing
            && let Some(event) = self.hand(ui, &response, scene)
        {
            return Some(event);
        }
        if let Some(event) = menu(&response, scene, (at, cell), NEAR / self.scale) {
            return Some(event);
        }
        let shift = ui.input(|i| i.modifiers.shift);
        match (cell, at) {
            (_, Some(at)) if response.double_clicked() => Some(PlanEvent::Jump(at)),
            (Some(cell), _) if response.clicked() && shift => Some(PlanEvent::Second(cell)),
            (Some(cell), _) if response.clicked() => Some(PlanEvent::Source(cell)),
            (None, _) if response.clicked() => Some(PlanEvent::Clear),
            _ => None,
        }
    }

    /// What a hand on the plan does to the level.
    fn hand(&mut self, ui: &Ui, response: &egui::Response, scene: &PlanScene) -> Option<PlanEvent> {
        let (rect, within) = (response.rect, NEAR / self.scale);
        if response.drag_started_by(egui::PointerButton::Primary) {
            let start = ui.input(|i| i.pointer.press_origin())?;
            return Some(PlanEvent::Grab(self.to_plan(rect, start), within));
        }
        if self.held && response.drag_stopped() {
            self.held = false;
            return Some(PlanEvent::Drop);
        }
        if self.held && response.dragged() {
            let at = self.to_plan(rect, response.interact_pointer_pos()?);
            return Some(PlanEvent::Drag(self.rounded(at)));
        }
        if response.clicked() {
            let at = self.to_plan(rect, response.interact_pointer_pos()?);
            if door_near(scene.document, at, within) {
                return Some(PlanEvent::Door(at, within));
            }
        }
        None
    }

    /// On round numbers, as fine as a point of the screen.
    fn rounded(&self, at: DVec2) -> DVec2 {
        let step = 10f64.powf((4.0 / self.scale).log10().floor());
        (at / step).round() * step
    }

    /// Moves and zooms.
    fn steer(&mut self, ui: &Ui, response: &egui::Response) {
        let rect = response.rect;
        if response.dragged() {
            let d = response.drag_delta();
            self.middle -= DVec2::new(f64::from(d.x), -f64::from(d.y)) / self.scale;
            self.follow = false;
        }
        let Some(pointer) = response.hover_pos() else {
            return;
        };
        let turned = ui.input(|i| i.smooth_scroll_delta().y);
        let pinched = ui.input(|i| i.zoom_delta());
        let factor = f64::from(pinched) * (f64::from(turned) * 0.005).exp();
        if factor != 1.0 {
            // What is under the pointer stays there.
            let before = self.to_plan(rect, pointer);
            self.scale *= factor;
            self.middle += before - self.to_plan(rect, pointer);
        }
    }

    fn cells(&self, scene: &PlanScene, rect: Rect, painter: &egui::Painter) {
        let document = scene.document;
        let n = document.graph.cells.len();
        let mut colours = vec![FLOOR; n];
        if scene.heat {
            let most = document.sees.iter().copied().max().unwrap_or(1);
            for (colour, sees) in colours.iter_mut().zip(&document.sees) {
                *colour = heat(f64::from(*sees) / f64::from(most.max(1)));
            }
        } else if let Some(source) = scene.source.or(scene.cell) {
            for seen in document.pvs.seen_from(source) {
                colours[seen.0 as usize] = SEEN;
            }
        }
        if let (Some(rival), Some(source), false) =
            (scene.rival, scene.source.or(scene.cell), scene.heat)
        {
            for cell in document.graph.cell_ids() {
                let sets = [&document.pvs, &rival.pvs];
                match sets.map(|pvs| pvs.sees(source, cell)) {
                    [true, false] => colours[cell.0 as usize] = MISSED,
                    [false, true] => colours[cell.0 as usize] = EXTRA,
                    _ => {}
                }
            }
        } else if scene.source.is_none() && !scene.heat {
            for cell in scene.cells {
                colours[cell.0 as usize] = CONE;
            }
        }
        let mut set = |cell: Option<CellId>, colour| {
            if let Some(cell) = cell {
                colours[cell.0 as usize] = colour;
            }
        };
        if !scene.heat {
            set(scene.cell, OWN);
        }
        set(scene.source, SOURCE);
        set(scene.second, SECOND);
        let mut mesh = Mesh::default();
        for (corners, colour) in document.plan.cells.iter().zip(colours) {
            self.fill(&mut mesh, rect, corners, colour);
        }
        painter.add(mesh);
    }

    /// Adds a convex piece. Pieces of one mesh have no seams between them, and slivers no spikes.
    fn fill(&self, mesh: &mut Mesh, rect: Rect, corners: &[DVec2], colour: Color32) {
        let places = corners.iter().map(|p| self.to_screen(rect, *p));
        let first = mesh.vertices.len() as u32;
        for place in places {
            mesh.colored_vertex(place, colour);
        }
        let n = mesh.vertices.len() as u32 - first;
        for k in 2..n {
            mesh.add_triangle(first, first + k - 1, first + k);
        }
    }

    fn outline(
        &self,
        painter: &egui::Painter,
        rect: Rect,
        document: &Document,
        cell: CellId,
        colour: Color32,
    ) {
        let corners = &document.plan.cells[cell.0 as usize];
        let outline = corners.iter().map(|p| self.to_screen(rect, *p)).collect();
        painter.add(Shape::closed_line(outline, Stroke::new(1.5, colour)));
    }
}

/// What the right button offers.
fn menu(
    response: &egui::Response,
    scene: &PlanScene,
    (at, cell): (Option<DVec2>, Option<CellId>),
    within: f64,
) -> Option<PlanEvent> {
    let place = egui::Id::unique("plan menu");
    // Where it was opened: the pointer is in the menu later.
    if response.secondary_clicked() {
        response
            .ctx
            .data_mut(|data| data.insert_temp(place, (at, cell)));
    }
    let mut event = None;
    response.context_menu(|ui| {
        let opened: Option<(Option<DVec2>, Option<CellId>)> = ui.data(|data| data.get_temp(place));
        let (Some(at), Some(cell)) = opened.unwrap_or_default() else {
            ui.label("outside of the level");
            return;
        };
        let mut offer = |ui: &mut Ui, text: &str, what: PlanEvent| {
            if ui.button(text).clicked() {
                event = Some(what);
            }
        };
        offer(ui, "Go here", PlanEvent::Jump(at));
        offer(ui, "Show what this cell sees", PlanEvent::Source(cell));
        if scene.source.is_some_and(|s| s != cell) {
            offer(
                ui,
                "Why does the chosen cell see this one?",
                PlanEvent::Second(cell),
            );
        }
        if scene.cell.is_some_and(|c| c != cell) {
            offer(
                ui,
                "Why does the eye's cell see this one?",
                PlanEvent::Why(cell),
            );
        }
        ui.separator();
        if door_near(scene.document, at, within) {
            offer(ui, "Open or close this door", PlanEvent::Door(at, within));
        }
        let text = if scene.editing {
            "End changing the level"
        } else {
            "Change the level"
        };
        offer(ui, text, PlanEvent::Edit);
    });
    event
}

/// Whether a door is so near to a place.
fn door_near(document: &Document, at: DVec2, within: f64) -> bool {
    let near =
        |(line, ends): &(Line, [DVec2; 2])| *line == Line::Door && nearness(at, *ends) <= within;
    document.plan.lines.iter().any(near)
}

/// Distance of a place from a line.
fn nearness(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let along = b - a;
    let share = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    p.distance(a + along * share.clamp(0.0, 1.0))
}

fn stroke(line: Line) -> Stroke {
    match line {
        Line::Wall => Stroke::new(1.6, Color32::from_rgb(226, 230, 236)),
        Line::Portal => Stroke::new(0.5, Color32::from_rgb(74, 82, 94)),
        Line::Step => Stroke::new(0.8, Color32::from_rgb(120, 126, 136)),
        Line::Door => Stroke::new(2.4, Color32::from_rgb(214, 150, 70)),
        Line::Window => Stroke::new(2.0, Color32::from_rgb(110, 190, 220)),
    }
}

/// From dark blue over violet and orange to yellow.
fn heat(share: f64) -> Color32 {
    const STOPS: [[f64; 3]; 5] = [
        [20.0, 24.0, 82.0],
        [96.0, 28.0, 128.0],
        [190.0, 54.0, 96.0],
        [242.0, 128.0, 48.0],
        [252.0, 226.0, 110.0],
    ];
    let at = share.clamp(0.0, 1.0) * 4.0;
    let i = (at as usize).min(3);
    let mix = |k: usize| {
        let (a, b) = (STOPS[i][k], STOPS[i + 1][k]);
        (a + (b - a) * (at - i as f64)) as u8
    };
    Color32::from_rgb(mix(0), mix(1), mix(2))
}

fn eye(painter: &egui::Painter, at: Pos2, view: DVec2, half: f64) {
    const REACH: f32 = 46.0;
    let angle = (-view.y).atan2(view.x) as f32;
    let ray = |turn: f64| at + Vec2::angled(angle + turn as f32) * REACH;
    for side in [-half, half] {
        painter.line_segment([at, ray(side)], Stroke::new(1.5, LIGHT));
    }
    painter.circle(at, 5.0, LIGHT, Stroke::new(1.5, Color32::BLACK));
}

fn label(painter: &egui::Painter, rect: Rect, text: String) {
    let galley = painter.layout_no_wrap(text, FontId::proportional(13.0), Color32::WHITE);
    let at = rect.left_bottom() + Vec2::new(10.0, -galley.size().y - 10.0);
    let back = Rect::from_min_size(at, galley.size()).expand(6.0);
    painter.rect(
        back,
        4.0,
        Color32::from_black_alpha(190),
        Stroke::NONE,
        StrokeKind::Inside,
    );
    painter.galley(at, galley, Color32::WHITE);
}

fn legend(painter: &egui::Painter, rect: Rect, document: &Document) {
    const SIZE: Vec2 = Vec2::new(150.0, 10.0);
    let at = rect.right_top() + Vec2::new(-SIZE.x - 14.0, 26.0);
    for k in 0..SIZE.x as usize {
        let x = at.x + k as f32;
        let colour = heat(k as f64 / f64::from(SIZE.x));
        painter.vline(x, at.y..=at.y + SIZE.y, Stroke::new(1.2, colour));
    }
    let most = document.sees.iter().copied().max().unwrap_or(0);
    let font = FontId::proportional(12.0);
    let above = at - Vec2::new(0.0, 4.0);
    painter.text(
        above,
        Align2::LEFT_BOTTOM,
        "cells seen: 1",
        font.clone(),
        Color32::WHITE,
    );
    let right = Pos2::new(at.x + SIZE.x, above.y);
    painter.text(right, Align2::RIGHT_BOTTOM, most, font, Color32::WHITE);
}
