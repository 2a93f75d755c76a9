//! The laboratory: plots of time against error, the table behind them, and a lesson about each
//! axis.
//!
//! The controls are at the left, the plots in the middle, the table or the lessons at the right. A
//! click on a mark or on a row of the table applies its settings.

mod controls_ui;
mod lessons;
mod plots;
mod table;

use egui::{Id, Layout, Rect, Ui, UiBuilder, vec2};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::widgets::controls::{Choice, choices};
use crate::app::widgets::regions;
use crate::app::{actions::LabRequest, state::laboratory::Side, theme};

/// The width of the controls.
const ASKED: f32 = 264.0;

/// Narrower panels show one part at a time.
const WIDE: f32 = 1100.0;

/// Shows the panel; its requests are added to `requests`.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let whole = ui.available_rect_before_wrap();
    if whole.width() < WIDE {
        return one_ui(ui, state, requests);
    }
    let all = whole.shrink2(vec2(0.0, 2.0));
    let gap = f32::from(theme::MARGIN);
    let asked = all.with_max_x(all.left() + ASKED);
    let rest = all.with_min_x(asked.right() + gap);
    let middle = rest.with_max_x(rest.left() + (rest.width() * 0.47).round());
    let right = rest.with_min_x(middle.right() + gap);
    within(ui, asked, |ui| controls_ui::show(ui, state, requests));
    within(ui, middle, |ui| {
        regions::begin(ui, "chart");
        plots::show(ui, state, requests);
    });
    within(ui, right, |ui| {
        regions::begin(ui, "table");
        right_ui(ui, state, requests);
    });
}

/// Shows one part at a time, with a choice of the part.
fn one_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let id = Id::unique("part of the laboratory");
    let mut part: usize = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    if part >= 2 {
        // The part follows the state, which other panels may have changed.
        part = if state.lab.side == Side::Table { 2 } else { 3 };
    }
    let all = [
        ("Measure", "Measurement and comparison"),
        ("Chart", "Time against error"),
        ("Table", "Every choice with its figures"),
        ("Lessons", "A lesson for each axis"),
    ];
    let shown: Vec<Choice<'_>> = all
        .iter()
        .enumerate()
        .map(|(i, (label, hint))| Choice::new("Laboratory", label, i == part, hint))
        .collect();
    ui.horizontal(|ui| {
        ui.set_width(ui.available_width() - f32::from(theme::MARGIN));
        if let Some(clicked) = choices(ui, &shown) {
            part = clicked;
            let side = if clicked == 3 { Side::Lessons } else { Side::Table };
            requests.push(Request::Lab(LabRequest::Side(side)));
        }
    });
    ui.data_mut(|data| data.insert_temp(id, part));
    match part {
        0 => controls_ui::show(ui, state, requests),
        1 => {
            let rest = ui.available_rect_before_wrap();
            let rest = rest.with_max_x(rest.right() - f32::from(theme::MARGIN));
            within(ui, rest, |ui| plots::show(ui, state, requests));
        }
        2 => table::show(ui, state, requests),
        _ => lessons::show(ui, state, requests),
    }
}

fn within(ui: &mut Ui, rect: Rect, add: impl FnOnce(&mut Ui)) {
    let layout = Layout::top_down(egui::Align::Min);
    // A separate child, so the contents cannot enlarge the panel.
    let mut child = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
    child.set_clip_rect(rect.expand(2.0).intersect(ui.clip_rect()));
    add(&mut child);
}

fn right_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let side = state.lab.side;
    let all = [
        Choice::new("Laboratory", "Table", side == Side::Table, "Every choice with its figures"),
        Choice::new("Laboratory", "Lessons", side == Side::Lessons, "A lesson for each axis"),
    ];
    ui.horizontal(|ui| {
        ui.set_width(ui.available_width() - f32::from(theme::MARGIN));
        if let Some(clicked) = choices(ui, &all) {
            requests.push(Request::Lab(LabRequest::Side([Side::Table, Side::Lessons][clicked])));
        }
    });
    match side {
        Side::Table => table::show(ui, state, requests),
        Side::Lessons => lessons::show(ui, state, requests),
    }
}
