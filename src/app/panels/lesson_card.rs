//! The card of a lesson, over the lower edge of the picture: a title, two sentences, the cost and
//! the benefit on this machine, and the choices to try.

use egui::{Align2, Area, Frame, Id, Order, Rect, RichText, Ui, vec2};

use super::view_switches::axis_ui;
use crate::app::actions::{LabRequest, Request};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::regions;
use marraztu_io::{Lesson, lessons};

/// The greatest width of the card.
const WIDTH: f32 = 560.0;

/// Shows the card of the lesson on show; its requests are added to `requests`.
pub(crate) fn show(ui: &Ui, picture: Rect, state: &State, requests: &mut Vec<Request>) {
    let Some(lesson) = state.lab.lesson else { return };
    let area = Area::new(Id::unique("lesson")).order(Order::Middle).constrain_to(picture);
    let at = picture.center_bottom() - vec2(0.0, 10.0);
    let width = (picture.width() - 40.0).min(WIDTH);
    area.pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(10.0).show(ui, |ui| {
            regions::begin(ui, "lesson");
            ui.set_width(width);
            contents(ui, lesson, state, requests);
            regions::follow_focus(ui);
        });
    });
}

fn contents(ui: &mut Ui, lesson: &'static Lesson, state: &State, requests: &mut Vec<Request>) {
    ui.label(RichText::new(&lesson.title).heading());
    ui.add(egui::Label::new(&lesson.why).wrap());
    ui.add(egui::Label::new(&lesson.look).wrap());
    ui.add_space(theme::GAP);
    axis_ui(ui, lesson.axis(), state, requests);
    cost_ui(ui, lesson, state);
    ui.add_space(theme::GAP);
    ui.horizontal(|ui| {
        let all = lessons();
        let place = all.iter().position(|other| other.axis == lesson.axis).unwrap_or(0);
        let go = |ui: &mut Ui, label: &str, to: Option<&'static Lesson>| {
            let button = ui.add_enabled(to.is_some(), egui::Button::new(label));
            let hint = to.map_or("", |to| to.title.as_str());
            to.filter(|_| button.on_hover_text(hint).clicked())
        };
        let before = go(ui, "Back", place.checked_sub(1).map(|place| &all[place]));
        let next = go(ui, "Next", all.get(place + 1));
        for to in before.into_iter().chain(next) {
            requests.push(Request::Lab(LabRequest::ShowLesson(&to.axis)));
        }
        ui.weak(format!("{} of {}", place + 1, all.len()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let hint = "Restores your scene, with its view, settings, selection and history";
            if ui.button("Close").on_hover_text(hint).clicked() {
                requests.push(Request::Lab(LabRequest::Back));
            }
        });
    });
}

/// Shows what the axis costs and gives, as measured on this computer.
fn cost_ui(ui: &mut Ui, lesson: &Lesson, state: &State) {
    let text = match (state.lab.costs.get(lesson.axis.as_str()), state.lab.running) {
        (Some(cost), _) => cost.clone(),
        (None, Some(part)) => format!("Measuring on this machine: {:.0}%", part * 100.0),
        (None, None) => "Its cost on this machine is not known".to_owned(),
    };
    ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
}
