//! The lesson about each axis of accuracy: three sentences, its choices, and a scene that shows it.

use egui::{RichText, ScrollArea, Ui};

use crate::app::actions::{LabRequest, Request};
use crate::app::panels::view_switches::axis_ui;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::regions;
use marraztu_core::accuracy::{AXES, AxisKind};

/// Shows the panel; its requests are added to `requests`.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let area = ScrollArea::vertical().id_salt("lessons").auto_shrink(false);
    area.content_margin(theme::SCROLL_MARGIN).show(ui, |ui| {
        let axis = state.lab.lesson;
        ui.horizontal_wrapped(|ui| {
            for other in AXES {
                let button = egui::Button::selectable(other.key == axis.key, other.label);
                if ui.add(button).on_hover_text(other.lesson.title).clicked() {
                    requests.push(Request::Lab(LabRequest::Lesson(other.key)));
                }
            }
        });
        ui.add_space(theme::GAP);
        ui.label(RichText::new(axis.lesson.title).strong());
        cost_ui(ui, state, requests);
        ui.horizontal(|ui| {
            let hint = "Opens a small scene that shows the difference clearly";
            if ui.button("Take me there").on_hover_text(hint).clicked() {
                requests.push(Request::Lab(LabRequest::ShowLesson(axis.key)));
            }
            let hint = "Restores your scene, with its view, settings, selection and history";
            if state.lab.away && ui.button("Back to my scene").on_hover_text(hint).clicked() {
                requests.push(Request::Lab(LabRequest::Back));
            }
            axis_ui(ui, axis, state, requests);
        });
        let coarse = match axis.kind {
            AxisKind::Scored | AxisKind::ScoredApart => "Coarse choices",
            AxisKind::Model => "Which is right",
        };
        let lesson = &axis.lesson;
        for (title, sentence) in
            [("Explanation", lesson.what), (coarse, lesson.coarse), ("Where to look", lesson.shows)]
        {
            ui.label(RichText::new(title).small().strong());
            ui.add(egui::Label::new(sentence).wrap());
        }
        regions::follow_focus(ui);
    });
}

/// Shows the cost and the benefit of the axis, as measured on this computer, or a button to
/// measure.
fn cost_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let axis = state.lab.lesson;
    if let Some(cost) = state.lab.costs.get(axis.key) {
        ui.add(egui::Label::new(cost).wrap());
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("Its cost on this machine has not been measured yet.");
        let button = egui::Button::new("Measure this axis").small();
        let hint = "Measures time and error of its choices for the current picture";
        let free = state.lab.running.is_none();
        if ui.add_enabled(free, button).on_hover_text(hint).clicked() {
            requests.push(Request::Lab(LabRequest::MeasureAxis(axis.key)));
        }
    });
}
