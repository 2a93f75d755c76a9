//! Labels the placeholders of missing files.

use egui::{Ui, vec2};

use super::helpers::label_ui;
use super::marks::Projection;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::text::file_name;

/// Shows the file name of each missing model at its box.
pub(super) fn show(ui: &Ui, state: &State, onto: &Projection) {
    let view = &state.view;
    if !state.shows_overlays() || view.polygons.is_some() {
        return;
    }
    let painter = ui.painter().with_clip_rect(onto.rect());
    for (id, object) in state.scene.objects.iter() {
        let is_shown = object.visible && (!view.only_selected || view.object == Some(id));
        let file = object.model.source.as_deref().filter(|_| object.model.is_placeholder());
        if let (true, Some(file)) = (is_shown, file)
            && let Some(at) = onto.place(object.centre(view.time))
            && onto.rect().contains(at)
        {
            let text = format!("{} is missing", file_name(file));
            // Below the middle, which the gizmo of the selection occupies.
            label_ui(ui, &painter, at + vec2(0.0, 28.0), text, theme::warning_on_dark());
        }
    }
}
