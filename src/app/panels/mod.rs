//! The panels around the viewport. They read the state and return requests; they change nothing.

mod cheat_sheet;
mod lab;
mod menu_bar;
pub(crate) mod notices;
mod outline;
mod plan;
mod properties;
mod status_line;
mod view_switches;

use egui::{Frame, Margin, Panel, Ui};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::theme;

/// Below this width of the window the panels at the sides are narrower, so that the picture stays
/// the largest thing.
const WIDE: f32 = 1200.0;

/// Shows all open panels. The rest of `ui` is left to the viewport.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) {
    let wide = ui.available_width() >= WIDE;
    let (left, right) = if wide { (228.0, 280.0) } else { (204.0, 256.0) };
    let most = |part: f32, least: f32| (ui.available_width() * part).max(least);
    let (most_left, most_right) = (most(0.25, 200.0), most(0.3, 250.0));
    let fill = ui.visuals().panel_fill;
    let bar = Frame::new().fill(fill).inner_margin(Margin::symmetric(theme::MARGIN, 2));
    // The contents leave room for a scroll bar.
    let margin = Margin { left: theme::MARGIN, right: 0, top: 4, bottom: 4 };
    let side = Frame::new().fill(fill).inner_margin(margin);
    Panel::top("menu bar").frame(bar).show(ui, |ui| menu_bar::show(ui, state, requests));
    Panel::bottom("status line").frame(bar).show(ui, |ui| status_line::show(ui, state, requests));
    if state.panels.laboratory {
        let most = (ui.available_height() * 0.8).max(180.0);
        Panel::bottom("laboratory")
            .frame(side)
            .resizable(true)
            // The picture keeps two fifths of the height; on a large screen a plot and the verdict
            // are seen as a whole.
            .default_size((ui.available_height() * 0.6).round().clamp(180.0, 620.0))
            .size_range(160.0..=most)
            .show(ui, |ui| lab::show(ui, state, requests));
    }
    // A new name is typed in the outline.
    let outline = state.panels.outline || state.renaming.is_some();
    if outline || state.panels.view {
        Panel::left("left").frame(side).default_size(left).size_range(170.0..=most_left).show(
            ui,
            |ui| {
                left_ui(ui, state, requests, outline);
            },
        );
    }
    if state.panels.properties {
        Panel::right("properties")
            .frame(side)
            .default_size(right)
            .size_range(220.0..=most_right)
            .show(ui, |ui| properties::show(ui, state, requests));
    }
    // Under the picture alone, so that the lists beside it keep their height.
    if state.panels.plan {
        plan::show(ui, state, requests);
    }
    if state.panels.cheat_sheet {
        cheat_sheet::show(ui, state, requests);
    }
}

/// The outline, and the switches of the view under it.
fn left_ui(ui: &mut Ui, state: &State, requests: &mut Vec<Request>, outline: bool) {
    if !outline {
        view_switches::show(ui, state, requests);
        return;
    }
    if state.panels.view {
        let height = (ui.available_height() * 0.56).round();
        Panel::bottom("view switches")
            .frame(Frame::NONE)
            .resizable(true)
            .default_size(height)
            .size_range(90.0..=(height + 40.0).max(90.0))
            .show(ui, |ui| view_switches::show(ui, state, requests));
    }
    outline::show(ui, state, requests);
}
