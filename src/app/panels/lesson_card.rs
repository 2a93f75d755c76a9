//! The card of a lesson, below the picture: a title, two sentences, the cost and the benefit on
//! this machine, and the choices to try.

use egui::{Frame, Rect, RichText, ScrollArea, TextStyle, Ui, UiBuilder, vec2};

use super::view_switches::axis_ui;
use crate::app::actions::{LabRequest, Request, Requests};
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::regions;
use marraztu_io::{Lesson, lessons};

/// The greatest width of the text.
const WIDTH: f32 = 640.0;

/// The greatest height, as a part of the area; a higher card scrolls.
const MOST: f32 = 0.6;

/// Shows the card of the lesson on show at the bottom of an area; its requests are added to
/// `requests`. Returns the area left for the picture: the card hides nothing of its subject.
pub(crate) fn show(ui: &mut Ui, area: Rect, state: &State, requests: &mut Requests) -> Rect {
    let Some(lesson) = state.lab.lesson else { return area };
    let mut child = ui.new_child(UiBuilder::new().id_salt("lesson").max_rect(area));
    let frame = Frame::new().fill(ui.visuals().panel_fill).inner_margin(10.0);
    egui::Panel::bottom("lesson").resizable(false).frame(frame).show(&mut child, |ui| {
        regions::begin(ui, "lesson");
        let most = MOST * area.height();
        // Otherwise the height of the last frame would limit it, too.
        let scroll = ScrollArea::vertical().max_height(most).min_scrolled_height(most);
        scroll.show(ui, |ui| {
            let width = ui.available_width().min(WIDTH);
            let indent = (ui.available_width() - width) / 2.0;
            ui.horizontal_top(|ui| {
                ui.add_space(indent);
                ui.vertical(|ui| {
                    ui.set_max_width(width);
                    contents(ui, lesson, state, requests);
                });
            });
        });
        regions::follow_focus(ui);
    });
    child.available_rect_before_wrap()
}

fn contents(ui: &mut Ui, lesson: &'static Lesson, state: &State, requests: &mut Requests) {
    ui.label(RichText::new(&lesson.title).heading());
    ui.add(egui::Label::new(&lesson.why).wrap());
    ui.add(egui::Label::new(&lesson.look).wrap());
    ui.add_space(theme::GAP);
    axis_ui(ui, lesson.axis(), state, requests);
    cost_ui(ui, lesson, state, requests);
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

/// Shows what the chosen choice costs and gives, as measured on this computer.
fn cost_ui(ui: &mut Ui, lesson: &Lesson, state: &State, requests: &mut Requests) {
    let cost = state.lab.costs.get(lesson.axis.as_str());
    let chosen = lesson.axis().chosen(&state.settings);
    let line = cost.and_then(|cost| cost.choices.get(chosen.word));
    let text = match (line, state.lab.running) {
        (_, Some(part)) => format!("Measuring on this machine: {:.0}%", part * 100.0),
        (Some(line), None) => line.clone(),
        (None, None) => match (chosen.among)(&state.settings)
            .and_then(|()| (chosen.sense)(&state.scene, &state.view))
        {
            Err(reason) => format!("Not measured here: {reason}."),
            Ok(()) => "Its cost on this machine is not known.".to_owned(),
        },
    };
    // The picture keeps its size when the figures arrive.
    let lines = 3.0 * ui.text_style_height(&TextStyle::Body);
    ui.allocate_ui(vec2(ui.available_width(), lines), |ui| {
        ui.set_min_height(lines);
        ui.horizontal_top(|ui| {
            let button = ui.spacing().interact_size.y * 5.0;
            let width = ui.available_width() - button;
            ui.allocate_ui(vec2(width, lines), |ui| {
                // The button keeps its place when the figures arrive.
                ui.set_min_width(width);
                let label = ui.add(egui::Label::new(RichText::new(text).weak()).wrap());
                if let Some(cost) = cost {
                    label.on_hover_text(&cost.all);
                }
            });
            let again =
                ui.add_enabled(state.lab.running.is_none(), egui::Button::new("Measure again"));
            if again.on_hover_text("Measures every choice again, on this machine").clicked() {
                let key = lesson.axis().key;
                requests.push(Request::Lab(LabRequest::MeasureAxis(key)));
            }
        });
    });
}
