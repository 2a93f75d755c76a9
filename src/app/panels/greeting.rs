//! The greeting: first steps, over the lower edge of the first picture. It disappears with the
//! first change and never takes keyboard focus.

use egui::{Align2, Area, Frame, Id, Order, Rect, Ui, vec2};

use super::status_line::middle_elided;
use crate::app::actions::{Action, LabRequest, Request};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::regions;
use crate::app::widgets::text::file_name;
use marraztu_core::accuracy::Axis;
use marraztu_io::{EXAMPLES, lesson_on};

/// The lessons to offer, by their axes, with their topics.
const LESSONS: [(&str, &str); 3] =
    [("samples", "Jagged edges"), ("shading", "Flat or smooth"), ("depth", "Z-fighting")];

/// The maximum number of recent files to offer.
const RECENT: usize = 3;

/// The greeting is hidden over a smaller picture.
const LEAST: egui::Vec2 = vec2(420.0, 260.0);

/// Shows the greeting; its requests are added to `requests`.
pub(crate) fn show(ui: &Ui, picture: Rect, state: &State, requests: &mut Vec<Request>) {
    let is_small = picture.width() < LEAST.x || picture.height() < LEAST.y;
    if !state.greeting || !state.overlays || is_small {
        return;
    }
    let area = Area::new(Id::unique("greeting")).order(Order::Middle).constrain_to(picture);
    let at = picture.center_bottom() - vec2(0.0, 10.0);
    let width = (picture.width() - 40.0).min(760.0);
    area.pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| {
            regions::begin(ui, "greeting");
            ui.set_max_width(width);
            contents(ui, state, requests);
        });
    });
}

/// Shows one row each for files to open, examples, and lessons.
fn contents(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    ui.horizontal_wrapped(|ui| {
        ui.weak("Drop a model here, or");
        let hint = "Shows a model alone, framed and lit";
        if ui.button("Open model...").on_hover_text(hint).clicked() {
            requests.push(Request::AskModels);
        }
        requests.extend(Action::Open.button(ui, state).map(Request::from));
        for path in state.recent.iter().take(RECENT) {
            let name = middle_elided(&file_name(path), 24);
            let button = ui.button(name);
            if button.on_hover_text(path.display().to_string()).clicked() {
                requests.push(Request::OpenFiles(vec![path.clone()]));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak("Or open an example:");
        for example in EXAMPLES {
            let hint = "Opens it in place of this scene";
            if ui.button(example.title).on_hover_text(hint).clicked() {
                requests.push(Request::LoadFiles(vec![example.path.into()]));
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak("Or try a lesson:");
        for (key, about) in LESSONS {
            let hint = Axis::named(key).map_or("", |axis| lesson_on(axis).title.as_str());
            if ui.button(about).on_hover_text(hint).clicked() {
                requests.push(Request::Lab(LabRequest::ShowLesson(key)));
            }
        }
        ui.add_space(3.0 * theme::GAP);
        if ui.button("Dismiss").on_hover_text("Closes this strip").clicked() {
            requests.push(Request::EndGreeting);
        }
    });
}
