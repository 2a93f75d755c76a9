//! The laboratory: time against error, the table behind it, and the lesson of each axis.
//!
//! At the left what is asked, in the middle the plots, at the right the table or the lessons. A
//! click on a mark or on a row of the table draws the picture so.

mod controls_ui;
mod lessons;
mod plots;
mod table;

use egui::{Layout, Rect, Ui, UiBuilder, vec2};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::widgets::controls::{Choice, choices};
use crate::app::{actions::LabRequest, state::laboratory::Side, theme};

/// The width of the controls.
const ASKED: f32 = 264.0;

/// Shows the panel; its requests are added to `requests`.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let whole = ui.available_rect_before_wrap();
    let all = whole.shrink2(vec2(0.0, 2.0));
    let gap = f32::from(theme::MARGIN);
    let asked = all.with_max_x(all.left() + ASKED);
    let rest = all.with_min_x(asked.right() + gap);
    let middle = rest.with_max_x(rest.left() + (rest.width() * 0.47).round());
    let right = rest.with_min_x(middle.right() + gap);
    within(ui, asked, |ui| controls_ui::show(ui, state, requests));
    within(ui, middle, |ui| plots::show(ui, state, requests));
    within(ui, right, |ui| right_ui(ui, state, requests));
    // All of it, else the panel would shrink from frame to frame.
    ui.allocate_rect(whole, egui::Sense::hover());
}

fn within(ui: &mut Ui, rect: Rect, add: impl FnOnce(&mut Ui)) {
    let layout = Layout::top_down(egui::Align::Min);
    // A child of its own, so that what it holds does not make the panel larger.
    let mut child = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
    child.set_clip_rect(rect.expand(2.0).intersect(ui.clip_rect()));
    add(&mut child);
}

fn right_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let side = state.lab.side;
    let all = [
        Choice::new("Laboratory", "Table", side == Side::Table, "Every choice with its figures"),
        Choice::new("Laboratory", "Lessons", side == Side::Lessons, "What each axis teaches"),
    ];
    if let Some(clicked) = choices(ui, &all) {
        requests.push(Request::Lab(LabRequest::Side([Side::Table, Side::Lessons][clicked])));
    }
    match side {
        Side::Table => table::show(ui, state, requests),
        Side::Lessons => lessons::show(ui, state, requests),
    }
}
