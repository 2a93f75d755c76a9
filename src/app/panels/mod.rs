//! The panels around the viewport. They read the state and return requests; they change nothing.

mod cheat_sheet;
mod greeting;
mod lab;
mod menu_bar;
pub(crate) mod notices;
mod outline;
mod palette;
pub(crate) mod pixel;
mod plan;
mod properties;
mod splitters;
mod status_line;
mod view_switches;

use egui::{Frame, Layout, Margin, Panel, Rect, Ui, UiBuilder};

use crate::app::actions::Request;
use crate::app::state::State;
use crate::app::state::layout::{Places, Side};
use crate::app::theme;
use crate::app::widgets::regions;

/// Where everything stands in a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrangement {
    /// All between the menus and the status line.
    area: Rect,
    places: Places,
}

impl Arrangement {
    /// The place that is left to the picture.
    pub(crate) const fn picture(&self) -> Rect {
        self.places.picture
    }

    /// Shows the strip of the first minute over the picture.
    pub(crate) fn greeting_ui(&self, ui: &Ui, state: &State, requests: &mut Vec<Request>) {
        greeting::show(ui, self.places.picture, state, requests);
    }

    /// Shows the borders that can be dragged; over the picture, which would take their presses.
    pub(crate) fn splitters_ui(&self, ui: &Ui, state: &State, requests: &mut Vec<Request>) {
        splitters::show(ui, state, self.area, &self.places, requests);
    }
}

/// Shows all open panels.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Vec<Request>) -> Arrangement {
    let fill = ui.visuals().panel_fill;
    let bar = Frame::new().fill(fill).inner_margin(Margin::symmetric(theme::MARGIN, 2));
    Panel::top("menu bar").frame(bar).show(ui, |ui| {
        regions::begin(ui, "menus");
        menu_bar::show(ui, state, requests);
    });
    Panel::bottom("status line").frame(bar).show(ui, |ui| status_line::show(ui, state, requests));
    let area = ui.available_rect_before_wrap();
    let mut layout = state.layout;
    if state.renaming.is_some() {
        // A new name is typed in the outline.
        layout.unfolded = Some(Side::Outline);
    }
    let outline = state.panels.outline || state.renaming.is_some();
    let panels = crate::io::Panels { outline, ..state.panels };
    let places = layout.divide(area, panels);
    if let Some(rect) = places.strip {
        ui.painter().rect_filled(rect, 0.0, fill);
        regions::begin(ui, "strip");
        splitters::strip_ui(ui, rect, state, requests);
    }
    within(ui, "outline", places.outline, |ui| outline::show(ui, state, requests));
    within(ui, "view switches", places.switches, |ui| view_switches::show(ui, state, requests));
    within(ui, "properties", places.properties, |ui| properties::show(ui, state, requests));
    within(ui, "laboratory", places.laboratory, |ui| lab::show(ui, state, requests));
    within(ui, "plan", places.plan, |ui| plan::show(ui, state, requests));
    if state.panels.cheat_sheet {
        cheat_sheet::show(ui, state, requests);
    }
    if state.palette {
        palette::show(ui, state, requests);
    }
    Arrangement { area, places }
}

/// Shows a panel in its place. What it holds never makes it larger.
fn within(ui: &mut Ui, name: &str, place: Option<Rect>, add: impl FnOnce(&mut Ui)) {
    let Some(rect) = place else { return };
    ui.painter().rect_filled(rect, 0.0, ui.visuals().panel_fill);
    // The contents leave room for a scroll bar.
    let margin = Margin { left: theme::MARGIN, right: 2, top: 4, bottom: 4 };
    let layout = Layout::top_down(egui::Align::Min);
    let builder = UiBuilder::new().id_salt(name).max_rect(rect - margin).layout(layout);
    let mut child = ui.new_child(builder);
    child.set_clip_rect(rect.intersect(ui.clip_rect()));
    regions::begin(&child, name);
    add(&mut child);
    regions::follow_focus(&child);
}
