//! The laboratory: what accuracy costs, in sentences, in plots of time against error, and in a
//! table.
//!
//! The controls are at the left. To the right, the verdict is above a plot and the table. A click
//! on a mark or on a row of the table applies its settings.

mod controls_ui;
mod plots;
mod table;

use egui::{Id, Layout, Rect, ScrollArea, Ui, UiBuilder, vec2};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::{Choice, choices};
use crate::app::widgets::regions;

/// The width of the controls.
const ASKED: f32 = 264.0;

/// The share of the height that the verdict may take.
const VERDICT: f32 = 0.4;

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
    let mut rest = all.with_min_x(asked.right() + gap);
    within(ui, rest, |ui| {
        regions::begin(ui, "verdict");
        verdict_ui(ui, state, requests);
        rest = ui.available_rect_before_wrap();
    });
    // Until something is measured, there is no table.
    let left = rest.left() + (rest.width() * 0.47).round() + gap;
    let table = state.lab.shown().map(|_| rest.with_min_x(left));
    let chart = table.map_or(rest, |table| rest.with_max_x(table.left() - gap));
    within(ui, asked, |ui| controls_ui::show(ui, state, requests));
    within(ui, chart, |ui| {
        regions::begin(ui, "chart");
        plots::show(ui, state, requests);
    });
    if let Some(table) = table {
        within(ui, table, |ui| {
            regions::begin(ui, "table");
            table::show(ui, state, requests);
        });
    }
}

/// Shows one part at a time, with a choice of the part.
fn one_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let id = Id::unique("part of the laboratory");
    let mut part: usize = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let all = [
        ("Measure", "Measurement and comparison"),
        ("Results", "The verdict, and time against error"),
        ("Table", "Every choice with its figures"),
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
        }
    });
    ui.data_mut(|data| data.insert_temp(id, part));
    match part {
        0 => controls_ui::show(ui, state, requests),
        1 => {
            let rest = ui.available_rect_before_wrap();
            let rest = rest.with_max_x(rest.right() - f32::from(theme::MARGIN));
            within(ui, rest, |ui| {
                verdict_ui(ui, state, requests);
                plots::show(ui, state, requests);
            });
        }
        _ => table::show(ui, state, requests),
    }
}

/// Shows the verdict, in at most a share of the height.
fn verdict_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let most = VERDICT * ui.available_height();
    let area =
        ScrollArea::vertical().id_salt("verdict").max_height(most).auto_shrink([false, true]);
    area.show(ui, |ui| plots::verdict_ui(ui, state, requests));
    ui.add_space(theme::GAP);
}

fn within(ui: &mut Ui, rect: Rect, add: impl FnOnce(&mut Ui)) {
    let layout = Layout::top_down(egui::Align::Min);
    // A separate child, so the contents cannot enlarge the panel.
    let mut child = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
    child.set_clip_rect(rect.expand(2.0).intersect(ui.clip_rect()));
    add(&mut child);
}
