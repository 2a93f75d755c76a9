//! Overlays of the picture: the outline of the selection, marks of lights, axes.

use egui::{Pos2, Rect, Response, Stroke, Ui};

use super::gizmo::{Gizmo, Grab};
use super::marks::Projection;
use super::{Purpose, Viewport, axes, helpers, marks, picking};
use crate::app::actions::{Also, Request};
use crate::app::drawing::border::Border;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::plate::plate_ui;
use marraztu_core::scene::ItemId;

/// The overlays that can be clicked.
pub(super) struct Over {
    pub(super) ends: Vec<axes::End>,
    pub(super) marks: Vec<marks::Mark>,
    pub(super) gizmo: Option<Gizmo>,
}

impl Over {
    pub(super) fn new(state: &State, rect: Rect, projection: &Projection) -> Self {
        let (ends, marks) = (axes::ends(state, rect), marks::marks(state, projection));
        Self { ends, marks, gizmo: None }
    }
}

impl Viewport {
    /// Marks the explained pixel with crosshairs.
    fn explained_ui(&self, ui: &Ui, rect: Rect, state: &State) {
        let Some(explained) = &state.explained else { return };
        let at = self.point(explained.at);
        let painter = ui.painter().with_clip_rect(rect);
        for (width, color) in
            [(3.5, egui::Color32::from_black_alpha(170)), (1.5, egui::Color32::WHITE)]
        {
            let stroke = Stroke::new(width, color);
            painter.circle_stroke(at, 6.0, stroke);
            for way in [egui::vec2(1.0, 0.0), egui::vec2(0.0, 1.0)] {
                painter.line_segment([at + way * 6.0, at + way * 13.0], stroke);
                painter.line_segment([at - way * 6.0, at - way * 13.0], stroke);
            }
        }
    }

    /// Draws the gizmo, the description of its drag, and the selection box.
    fn handles_ui(&self, ui: &Ui, rect: Rect, response: &Response, over: &Over) {
        let grab = self.mouse.grab();
        if let Some(gizmo) = &over.gizmo {
            let pointer = response.hover_pos().filter(|_| !self.mouse.is_dragging());
            let pointer = pointer.filter(|at| !axes::has(&over.ends, rect, *at));
            let hovered = pointer.and_then(|at| gizmo.handle_at(at));
            gizmo.show(ui, rect, grab.map(Grab::handle), hovered);
        }
        if let Some(grab) = grab {
            plate_ui(ui, rect, egui::Align2::CENTER_BOTTOM, grab.said.clone());
        }
        if let Some(area) = self.mouse.selection_box() {
            let accent = theme::accent_on_dark();
            let painter = ui.painter().with_clip_rect(rect);
            let dark = Stroke::new(3.5, egui::Color32::from_black_alpha(110));
            let kind = egui::StrokeKind::Middle;
            painter.rect_stroke(area, 0.0, dark, kind);
            let fill = accent.gamma_multiply(0.12);
            painter.rect(area, 0.0, fill, Stroke::new(1.5, accent), kind);
        }
    }

    /// Handles a click on an overlay; `None` if the click belongs to the picture.
    pub(super) fn over_click(
        &mut self,
        state: &State,
        over: &Over,
        at: Pos2,
        purpose: Purpose,
    ) -> Option<Option<Request>> {
        let is_end = axes::end_at(&over.ends, at);
        let is_axes = self.place.is_some_and(|(rect, _)| axes::has(&over.ends, rect, at));
        match (purpose, is_end) {
            (Purpose::Select, Some(end)) => Some(Some(Request::Do(end.action))),
            // Both clicks of a double click have turned the view already.
            (Purpose::Frame, Some(_)) => Some(None),
            (Purpose::Select | Purpose::Frame, None) if is_axes => Some(None),
            (Purpose::SelectAlso, None) => {
                let [free, _] = marks::lights_at(&over.marks, at);
                Some(Some(Request::SelectAlso(vec![*free.first()?], Also::Toggle)))
            }
            (Purpose::Box(area), _) => {
                let items = self.items_in(state, over, area);
                Some(Some(Request::SelectAlso(items, Also::Only)))
            }
            (Purpose::Select, None) if !state.aiming && !state.lab.picking && !state.explaining => {
                let [free, _] = marks::lights_at(&over.marks, at);
                let first = *free.first()?;
                let pixel = self.pixel(at);
                let click = (pixel, state.scene.observer_frame(&state.view));
                let again = self.clicked.replace(click) == Some(click);
                Some(Some(Request::Select(self.deeper(state, over, at, again, first))))
            }
            _ => None,
        }
    }

    /// Lists the items that reach into a part of the window.
    fn items_in(&self, state: &State, over: &Over, area: Rect) -> Vec<ItemId> {
        let Some((rect, size)) = self.place else { return Vec::new() };
        let onto = Projection::new(state, rect, size);
        let objects = picking::objects_within(state, &onto, area, size);
        let mut items: Vec<ItemId> = objects.into_iter().map(ItemId::Object).collect();
        let eye = state.scene.observer_frame(&state.view).w_axis.truncate();
        let cameras = state.scene.cameras.iter().filter(|(_, camera)| {
            let at = camera.pose.now().eye;
            let seen = camera.visible && state.view.marks && at != eye;
            seen && onto.place(at).is_some_and(|at| area.contains(at))
        });
        items.extend(cameras.map(|(id, _)| ItemId::Camera(id)));
        let marks = over.marks.iter().filter(|mark| area.contains(mark.at));
        items.extend(marks.map(|mark| ItemId::Light(mark.id)));
        items.retain(|item| !state.scene.locked.contains(item));
        items
    }

    /// Returns `first`, or on a repeated click the item after the selected one among all items
    /// here.
    pub(super) fn deeper(
        &self,
        state: &State,
        over: &Over,
        at: Pos2,
        again: bool,
        first: ItemId,
    ) -> ItemId {
        if !again {
            return first;
        }
        // Free lights come first, then objects from front to back, then attached lights.
        let [mut all, following] = marks::lights_at(&over.marks, at);
        let pixel = self.pixel(at);
        let objects = self.size().map(|size| picking::objects_at(state, pixel, size));
        all.extend(objects.unwrap_or_default().into_iter().map(ItemId::Object));
        all.extend(following);
        all.retain(|item| !state.scene.locked.contains(item));
        let here = all.iter().position(|item| state.selected() == Some(*item));
        here.and_then(|here| all.get((here + 1) % all.len())).copied().unwrap_or(first)
    }

    /// Draws the overlays: outlines, marks of lights, axes.
    pub(super) fn over_ui(
        &self,
        ui: &Ui,
        state: &State,
        response: &Response,
        projection: &Projection,
        over: &Over,
    ) {
        let Some((rect, _)) = self.place else { return };
        helpers::grid_ui(ui, state, projection, self.image.as_deref());
        helpers::dimensions_ui(ui, state, projection);
        helpers::placeholders_ui(ui, state, projection);
        // Overlays are drawn from back to front: grid, boxes, outlines, marks, gizmo, axes.
        let first = state.outlined().first().copied();
        let [own, others] = &self.outline;
        let accent = theme::accent_on_dark();
        // The other selected items have a weaker outline than the one that the keys act on.
        let borders = [(others, accent.gamma_multiply(0.6)), (own, accent)];
        for (border, color) in borders {
            if let Some(border) = border.as_ref().filter(|it| Some(it.item) == first) {
                border_ui(ui, rect, border, color);
            }
        }
        marks::show(ui, state, projection, &over.marks);
        self.handles_ui(ui, rect, response, over);
        let pointer = response.hover_pos().filter(|_| !self.mouse.is_dragging());
        let end = pointer.and_then(|at| axes::end_at(&over.ends, at));
        axes::show(ui, rect, &over.ends, pointer);
        let light = pointer.and_then(|at| marks::lights_at(&over.marks, at)[0].first().copied());
        if let Some(end) = end {
            plate_ui(ui, rect, egui::Align2::RIGHT_BOTTOM, end.action.info().label.to_owned());
        } else if let Some(name) = light.and_then(|light| state.name(light)) {
            plate_ui(ui, rect, egui::Align2::RIGHT_BOTTOM, name.to_owned());
        }
        if state.explaining {
            let text = "Click a pixel to explain it; Esc cancels".to_owned();
            plate_ui(ui, rect, egui::Align2::CENTER_BOTTOM, text);
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
        self.explained_ui(ui, rect, state);
        if state.aiming {
            let text = "Click where the light should shine; Esc cancels".to_owned();
            plate_ui(ui, rect, egui::Align2::CENTER_BOTTOM, text);
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
    }
}

/// Draws the border of an item with a dark outer line, visible on any background.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^24 pixels a side")]
pub(super) fn border_ui(ui: &Ui, rect: Rect, border: &Border, color: egui::Color32) {
    let pixel = rect.size() / egui::vec2(border.size.width as f32, border.size.height as f32);
    let mut mesh = egui::Mesh::default();
    let colors = [egui::Color32::from_black_alpha(160), color];
    for (runs, color) in [&border.outer, &border.inner].into_iter().zip(colors) {
        for run in runs {
            let min = rect.min + egui::vec2(run.x as f32, run.y as f32) * pixel;
            let size = egui::vec2(run.length as f32, 1.0) * pixel;
            mesh.add_colored_rect(Rect::from_min_size(min, size), color);
        }
    }
    ui.painter().with_clip_rect(rect).add(mesh);
}
