//! The laboratory: what accuracy costs, in sentences, in plots of time against error, and in a
//! table.
//!
//! The controls are at the left. To the right, the verdict is above a plot and the table. A click
//! on a mark or on a row of the table applies its settings.

mod controls_ui;
mod plots;
mod table;

use egui::{Id, Layout, Rect, ScrollArea, Ui, UiBuilder, vec2};

use crate::app::actions::Requests;
use crate::app::state::State;
use crate::app::theme;
use crate::app::widgets::controls::choose;
use crate::app::widgets::regions;

/// The width of the controls.
const ASKED: f32 = 264.0;

/// The share of the height that the verdict may take.
const VERDICT: f32 = 0.4;

/// Narrower panels show one part at a time.
const WIDE: f32 = 1100.0;

/// Narrower panels show verdict and plot one at a time, too.
const HALF_WIDE: f32 = 760.0;

/// The share of the width for the verdict next to a plot.
const BESIDE: f32 = 0.42;

pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) {
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

/// A part of the laboratory in a narrow panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Part {
    /// Measurement, metrics and comparison.
    #[default]
    Options,
    /// The verdict next to the plot.
    Results,
    Verdict,
    Plot,
    Table,
}

impl Part {
    const fn all(width: f32) -> &'static [Self] {
        if width < HALF_WIDE {
            &[Self::Options, Self::Verdict, Self::Plot, Self::Table]
        } else {
            &[Self::Options, Self::Results, Self::Table]
        }
    }

    /// Returns the part with its label and its hint.
    const fn option(self) -> (&'static str, Self, &'static str) {
        let (label, hint) = match self {
            Self::Options => ("Options", "Measurement, metrics and comparison"),
            Self::Results => ("Results", "The verdict, and time against error"),
            Self::Verdict => ("Verdict", "What every choice costs and gives here"),
            Self::Plot => ("Plot", "Time against error"),
            Self::Table => ("Table", "Every choice with its figures"),
        };
        (label, self, hint)
    }

    /// Returns the part of a panel with other parts that shows the same.
    fn among(self, all: &[Self]) -> Self {
        match self {
            Self::Verdict | Self::Plot if !all.contains(&self) => Self::Results,
            Self::Results if !all.contains(&self) => Self::Verdict,
            part => part,
        }
    }
}

/// Shows one part at a time, with a choice of the part.
fn one_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    let id = Id::unique("part of the laboratory");
    let (part, was_running): (Part, bool) = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let all = Part::all(ui.available_width());
    let is_running = state.lab.running.is_some();
    // Whoever measures wants to see the results.
    let wished = if is_running && !was_running { Part::Results } else { part };
    let mut part = wished.among(all);
    ui.horizontal(|ui| {
        ui.set_width(ui.available_width() - f32::from(theme::MARGIN));
        let shown: Vec<_> = all.iter().map(|other| other.option()).collect();
        part = choose(ui, "Laboratory", part, &shown).unwrap_or(part);
    });
    ui.data_mut(|data| data.insert_temp(id, (part, is_running)));
    let rest = ui.available_rect_before_wrap();
    let rest = rest.with_max_x(rest.right() - f32::from(theme::MARGIN));
    let width = if part == Part::Results { (BESIDE * rest.width()).round() } else { rest.width() };
    let verdict = rest.with_max_x(rest.left() + width);
    match part {
        Part::Options => controls_ui::show(ui, state, requests),
        Part::Results | Part::Verdict => within(ui, verdict, |ui| {
            if is_running {
                controls_ui::measure_ui(ui, state, requests);
            }
            let area = ScrollArea::vertical().id_salt("verdict").auto_shrink(false);
            let area = area.content_margin(theme::SCROLL_MARGIN);
            area.show(ui, |ui| {
                if !is_running {
                    controls_ui::age_ui(ui, state);
                }
                plots::verdict_ui(ui, state, requests);
            });
        }),
        Part::Plot => within(ui, rest, |ui| plots::show(ui, state, requests)),
        Part::Table => table::show(ui, state, requests),
    }
    if part == Part::Results {
        let plot = rest.with_min_x(verdict.right() + f32::from(theme::MARGIN));
        within(ui, plot, |ui| plots::show(ui, state, requests));
    }
}

/// Shows the verdict in a share of the height, which stays the same when sentences arrive: the plot
/// and the table keep their places.
fn verdict_ui(ui: &mut Ui, state: &State, requests: &mut Requests) {
    if state.lab.shown().is_none() && state.lab.running.is_none() {
        return;
    }
    let most = VERDICT * ui.available_height();
    let area = ScrollArea::vertical().id_salt("verdict").max_height(most).auto_shrink(false);
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
