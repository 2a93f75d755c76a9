//! What lies over the picture: the outline of the selection, marks of lights, axes.

use egui::{Pos2, Rect, Response, Ui};

use super::marks::Projection;
use super::{Purpose, Viewport, axes, marks, overlay, picking};
use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::plate::plate_ui;
use crate::scene::ItemId;

/// What lies over the picture and can be clicked.
pub(super) struct Over {
    pub(super) ends: Vec<axes::End>,
    pub(super) marks: Vec<marks::Mark>,
}

impl Over {
    pub(super) fn new(state: &State, rect: Rect, projection: &Projection) -> Self {
        Self { ends: axes::ends(state, rect), marks: marks::marks(state, projection) }
    }
}

impl Viewport {
    /// What a click on something over the picture asks for; `None` if it is for the picture.
    pub(super) fn over_click(
        &mut self,
        state: &State,
        over: &Over,
        at: Pos2,
        purpose: Purpose,
    ) -> Option<Option<Request>> {
        let is_end = axes::end_at(&over.ends, at);
        match (purpose, is_end) {
            (Purpose::Select, Some(end)) => Some(Some(Request::Do(end.action))),
            // The two clicks of a double click have turned the view already.
            (Purpose::Frame, Some(_)) => Some(None),
            (Purpose::Select, None) if !state.aiming && !state.lab.picking => {
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

    /// The first of what lies here, or the next after the selected one if it was clicked before.
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
        let [mut all, following] = marks::lights_at(&over.marks, at);
        let pixel = self.pixel(at);
        let objects = self.size().map(|size| picking::objects_at(state, pixel, size));
        all.extend(objects.unwrap_or_default().into_iter().map(ItemId::Object));
        all.extend(following);
        let here = all.iter().position(|item| state.selected() == Some(*item));
        here.and_then(|here| all.get((here + 1) % all.len())).copied().unwrap_or(first)
    }

    /// Draws what lies over the picture: outline, marks of lights, axes.
    pub(super) fn over_ui(
        &self,
        ui: &Ui,
        state: &State,
        response: &Response,
        projection: &Projection,
        over: &Over,
    ) {
        let Some((rect, _)) = self.place else { return };
        if let Some(outline) = self.outline.as_ref().filter(|it| Some(it.item) == state.outlined())
        {
            overlay::border_ui(ui, rect, outline, theme::accent(ui.visuals()));
        }
        marks::show(ui, state, projection, &over.marks);
        let pointer = response.hover_pos().filter(|_| !self.mouse.is_dragging());
        let end = pointer.and_then(|at| axes::end_at(&over.ends, at));
        axes::show(ui, rect, &over.ends, end);
        let light = pointer.and_then(|at| marks::lights_at(&over.marks, at)[0].first().copied());
        if let Some(end) = end {
            plate_ui(ui, rect, egui::Align2::RIGHT_BOTTOM, end.action.info().label.to_owned());
        } else if let Some(name) = light.and_then(|light| state.name(light)) {
            plate_ui(ui, rect, egui::Align2::RIGHT_BOTTOM, name.to_owned());
        }
        if state.aiming {
            let text = "Click where the light shall shine; Esc cancels".to_owned();
            plate_ui(ui, rect, egui::Align2::CENTER_TOP, text);
            ui.ctx().set_cursor_icon(egui::CursorIcon::Crosshair);
        }
    }
}
