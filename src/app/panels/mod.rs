//! The panels about the viewport. They read the state and give back what is asked for; they change
//! nothing.

mod cheat_sheet;
mod menu_bar;
mod outline;
mod properties;
mod status_line;
mod view_switches;

use egui::Panel;

use super::ask::Ask;
use super::state::State;

/// Shows all panels that are to be shown. What is left of `ui` is the viewport's.
pub fn show(ui: &mut egui::Ui, state: &State, asks: &mut Vec<Ask>) {
    Panel::top("menu bar").show(ui, |ui| menu_bar::show(ui, state, asks));
    Panel::bottom("status line").show(ui, |ui| status_line::show(ui, state, asks));
    if state.shown.outline {
        Panel::left("outline").show(ui, |ui| outline::show(ui, state, asks));
    }
    if state.shown.properties || state.shown.view {
        Panel::right("properties").show(ui, |ui| {
            if state.shown.properties {
                properties::show(ui, state, asks);
            }
            if state.shown.view {
                view_switches::show(ui, state, asks);
            }
        });
    }
    if state.shown.cheat_sheet {
        cheat_sheet::show(ui, state, asks);
    }
}
