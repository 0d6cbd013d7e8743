//! The window's content: the picture, what the mouse does in it, and the panel beside it.

use super::session::{Saved, Session};
use crate::view::Side;
use crate::words::{line, value_name};
use ::view::egui::{
    CentralPanel, Color32, ColorImage, ComboBox, Context, Frame, Grid, Key, PointerButton, Pos2, Rect, Response,
    RichText, ScrollArea, Sense, SidePanel, Stroke, TextureHandle, TextureOptions, TopBottomPanel, Ui, Vec2,
    ViewportCommand,
};
use anyhow::Result;
use clap::ValueEnum;
use gbuffer::Picture;
use glam::DVec2;
use scene::Viewport;
use std::time::Instant;

/// Width of the panel, points.
pub const PANEL_WIDTH: f32 = 300.0;

/// What one step of the wheel scrolls, points, as egui has it.
const POINTS_A_STEP: f32 = 40.0;

/// Height of the legend, pixels.
const LEGEND_HEIGHT: usize = 140;

/// Height of the letters of what is read, points: three coordinates stand side by side.
const NUMBER_SIZE: f32 = 11.0;

/// The most that is told of what was saved, points.
const MESSAGE_HEIGHT: f32 = 90.0;

/// Half the length of the mark on a picked pixel, and half the side of a control point's, points.
const MARK_SIZE: f32 = 7.0;
const POINT_SIZE: f32 = 2.5;

const MARK: Color32 = Color32::from_rgb(255, 80, 200);
const NET: Color32 = Color32::from_rgb(255, 190, 60);

/// What the left button does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tool {
    Turn,
    Light,
    Point,
}

/// Each with its key, and what it does.
const TOOLS: [(Tool, Key, &str, &str); 3] = [
    (Tool::Turn, Key::T, "turn", "T: drag to turn the model"),
    (Tool::Light, Key::L, "light", "L: drag to move the light"),
    (Tool::Point, Key::P, "point", "P: click a face, then drag one of its control points"),
];

/// A session, as it is seen.
pub struct Window<'d> {
    session: Session<'d>,
    tool: Tool,
    /// Whether a control point is in hand.
    is_pulling: bool,
    picture: Option<TextureHandle>,
    /// How many pictures had been drawn when this one was.
    frame: usize,
    /// What was saved last, or what went wrong.
    message: String,
}

impl<'d> Window<'d> {
    /// A window on a session.
    pub fn new(session: Session<'d>) -> Self {
        Self { session, tool: Tool::Turn, is_pulling: false, picture: None, frame: 0, message: String::new() }
    }

    /// What is shown.
    pub fn session(&self) -> &Session<'d> {
        &self.session
    }

    /// Does what keys and mouse ask for, and shows a frame. What goes wrong is told in the panel.
    pub fn show(&mut self, context: &Context) {
        self.keys(context);
        SidePanel::right("panel").exact_width(PANEL_WIDTH).resizable(false).show(context, |ui| {
            TopBottomPanel::bottom("saved").show_inside(ui, |ui| self.saved(ui));
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| self.panel(ui));
        });
        CentralPanel::default().frame(Frame::NONE).show(context, |ui| self.view(ui));
    }

    fn keys(&mut self, context: &Context) {
        if context.wants_keyboard_input() {
            return;
        }
        let pressed = |key: Key| context.input(|input| input.key_pressed(key));
        if pressed(Key::Q) || pressed(Key::Escape) {
            context.send_viewport_cmd(ViewportCommand::Close);
        }
        if pressed(Key::S) {
            self.save();
        }
        if pressed(Key::F) {
            let framed = self.session.frame(None);
            self.tell(framed);
        }
        if let Some((tool, ..)) = TOOLS.iter().find(|(_, key, ..)| pressed(*key)) {
            self.tool = *tool;
        }
    }

    /// The picture, and what the mouse does in it.
    fn view(&mut self, ui: &mut Ui) {
        let (scale, area) = (ui.ctx().pixels_per_point(), ui.max_rect());
        let side = |points: f32| (points * scale).round().max(1.0) as usize;
        // A window too large for a picture keeps the last one.
        if let Ok(viewport) = Viewport::new(side(area.width()), side(area.height())) {
            self.session.resize(viewport);
        }
        let response = ui.allocate_rect(area, Sense::click_and_drag());
        let done = self.gesture(ui, &response, area, scale);
        self.tell(done);
        match self.session.draw(Instant::now()) {
            Ok(Some(delay)) => ui.ctx().request_repaint_after(delay),
            Ok(None) => {}
            Err(error) => self.message = format!("{error:#}"),
        }
        if self.frame != self.session.frames() {
            self.frame = self.session.frames();
            self.picture = self.session.picture().map(|picture| texture(ui.ctx(), "picture", picture));
        }
        let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
        if let Some(picture) = &self.picture {
            ui.painter().image(picture.id(), area, whole, Color32::WHITE);
        }
        self.marks(ui, area, scale);
    }

    fn gesture(&mut self, ui: &Ui, response: &Response, area: Rect, scale: f32) -> Result<()> {
        let pixel = |at: Pos2| vector((at - area.min) * scale);
        let by = vector(response.drag_delta() * scale);
        let shift = ui.input(|input| input.modifiers.shift);
        let is_left = response.dragged_by(PointerButton::Primary);
        if response.drag_started_by(PointerButton::Primary) && self.tool == Tool::Point && !shift {
            let origin = ui.input(|input| input.pointer.press_origin());
            self.is_pulling = origin.map(|origin| self.session.grab(pixel(origin))).transpose()?.unwrap_or(false);
        }
        if response.drag_stopped() && std::mem::take(&mut self.is_pulling) {
            self.session.release()?;
        }
        if response.dragged() && by != DVec2::ZERO {
            match (is_left && !shift, self.tool) {
                (false, _) => self.session.pan(by)?,
                (true, Tool::Light) => {
                    response.interact_pointer_pos().into_iter().for_each(|at| self.session.light(pixel(at)));
                }
                (true, Tool::Point) if self.is_pulling => self.session.pull(by)?,
                (true, Tool::Turn | Tool::Point) => self.session.turn(by)?,
            }
        }
        let scrolled = ui.input(|input| input.smooth_scroll_delta.y);
        if let Some(at) = response.hover_pos().filter(|_| scrolled != 0.0) {
            self.session.zoom(pixel(at), f64::from(scrolled / POINTS_A_STEP))?;
        }
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) {
            let at = pixel(at).max(DVec2::ZERO);
            self.session.pick([at.x as usize, at.y as usize])?;
        }
        Ok(())
    }

    /// The picked pixel, and the control points that can be moved.
    fn marks(&self, ui: &Ui, area: Rect, scale: f32) {
        let painter = ui.painter_at(area);
        let point = |at: DVec2| area.min + Vec2::new(at.x as f32, at.y as f32) / scale;
        if let (Tool::Point, Some(face)) = (self.tool, self.session.selected()) {
            let surface = self.session.model().surface(face);
            let [rows, columns] = surface.control_counts();
            let (camera, viewport) = (self.session.camera(), self.session.viewport());
            let seen: Vec<Option<Pos2>> = surface
                .points()
                .iter()
                .map(|place| camera.project(viewport, *place).map(|(at, _)| point(at)))
                .collect();
            let at = |i: usize, j: usize| seen[i * columns + j];
            let stroke = Stroke::new(1.0, NET);
            for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
                let next = [(i + 1 < rows).then(|| at(i + 1, j)), (j + 1 < columns).then(|| at(i, j + 1))];
                for end in next.into_iter().flatten().flatten() {
                    at(i, j).into_iter().for_each(|start| {
                        painter.line_segment([start, end], stroke);
                    });
                }
                at(i, j).into_iter().for_each(|place| {
                    painter.rect_filled(Rect::from_center_size(place, Vec2::splat(2.0 * POINT_SIZE)), 0.0, NET);
                });
            }
        }
        if let Some(reading) = self.session.reading() {
            let at = point(DVec2::new(reading.at[0] as f64 + 0.5, reading.at[1] as f64 + 0.5));
            for way in [Vec2::X, Vec2::Y] {
                let ends = [-MARK_SIZE, -2.0, 2.0, MARK_SIZE].map(|t| at + way * t);
                painter.line_segment([ends[0], ends[1]], Stroke::new(1.0, MARK));
                painter.line_segment([ends[2], ends[3]], Stroke::new(1.0, MARK));
            }
        }
    }

    fn panel(&mut self, ui: &mut Ui) {
        let model = self.session.model();
        ui.heading(model.name());
        let size = self.session.viewport();
        let took = 1000.0 * self.session.took().as_secs_f64();
        let faces = model.faces().len();
        ui.label(format!("{faces} faces, {}x{}, {took:.0} ms a picture", size.width(), size.height()));
        ui.separator();
        let mut technique = self.session.technique();
        ComboBox::from_label("technique").selected_text(technique.name()).show_ui(ui, |ui| {
            for other in techniques::ALL {
                ui.selectable_value(&mut technique, *other, other.name()).on_hover_text(other.about());
            }
        });
        if technique != self.session.technique() {
            self.session.set_technique(technique);
        }
        let mut look = self.session.look().clone();
        let range = self.session.painter().and_then(|painter| painter.range());
        if look.panel(ui, range) {
            self.session.set_look(look);
        }
        self.legend(ui);
        ui.separator();
        self.cameras(ui);
        ui.horizontal(|ui| {
            ui.label("drag to");
            for (tool, _, name, what) in TOOLS {
                ui.selectable_value(&mut self.tool, tool, name).on_hover_text(what);
            }
        });
        ui.label(RichText::new("Shift or right button: move. Wheel: zoom. Click: read a pixel.").small());
        ui.separator();
        self.reading(ui);
    }

    fn saved(&mut self, ui: &mut Ui) {
        if ui.button("save picture and command (S)").clicked() {
            self.save();
        }
        ScrollArea::vertical().max_height(MESSAGE_HEIGHT).show(ui, |ui| {
            ui.label(RichText::new(&self.message).small());
        });
    }

    fn legend(&self, ui: &mut Ui) {
        if let Some(legend) = self.session.painter().and_then(|painter| painter.legend(LEGEND_HEIGHT)) {
            let legend = texture(ui.ctx(), "legend", &legend);
            let size = legend.size_vec2() / ui.ctx().pixels_per_point();
            let (area, _) = ui.allocate_exact_size(size, Sense::hover());
            ui.painter().image(legend.id(), area, Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0)), Color32::WHITE);
        }
    }

    fn cameras(&mut self, ui: &mut Ui) {
        ui.horizontal_wrapped(|ui| {
            for side in Side::value_variants() {
                if ui.button(value_name(side)).clicked() {
                    let framed = self.session.frame(Some(side.direction()));
                    self.tell(framed);
                }
            }
            if ui.button("frame (F)").clicked() {
                let framed = self.session.frame(None);
                self.tell(framed);
            }
            if ui.button("parallel or not").clicked() {
                let changed = self.session.change_projection();
                self.tell(changed);
            }
        });
    }

    fn reading(&self, ui: &mut Ui) {
        let Some(reading) = self.session.reading() else { return };
        Grid::new("reading").num_columns(2).show(ui, |ui| {
            for (name, value) in reading.lines().iter().filter(|(name, _)| *name != "verdict") {
                ui.label(*name);
                ui.label(RichText::new(value).monospace().size(NUMBER_SIZE));
                ui.end_row();
            }
        });
        for (_, verdict) in reading.lines().iter().filter(|(name, _)| *name == "verdict") {
            ui.label(format!("against a ray: {verdict}"));
        }
    }

    fn save(&mut self) {
        self.message = match self.session.save() {
            Ok(Saved { picture, model, command }) => {
                let model = model.map_or(String::new(), |path| format!(" and {}", path.display()));
                let command = line(command);
                // Whoever opened the window from a shell can go on there; where that is closed nothing is lost.
                let _ = crate::say!("{command}");
                format!("{}{model} saved. The same again:\n{command}", picture.display())
            }
            Err(error) => format!("not saved: {error:#}"),
        };
    }

    fn tell(&mut self, done: Result<()>) {
        if let Err(error) = done {
            self.message = format!("{error:#}");
        }
    }
}

fn vector(v: Vec2) -> DVec2 {
    DVec2::new(f64::from(v.x), f64::from(v.y))
}

/// A picture for egui to show.
fn texture(context: &Context, name: &str, picture: &Picture) -> TextureHandle {
    let pixels = picture.rgb().iter().map(|&[r, g, b]| Color32::from_rgb(r, g, b)).collect();
    let image = ColorImage::new([picture.width(), picture.height()], pixels);
    context.load_texture(name, image, TextureOptions::NEAREST)
}
