//! Arranges the panels around the picture and shows the open ones.

use egui::{
    Align2, Area, Frame, Id, Layout, Margin, Order, Rect, Ui, UiBuilder, Vec2, Window, vec2,
};

use super::{Dock, Panel, Side, each_panel};
use super::{dial, greeting, lesson_card, menu_bar, palette, splitters, status_line};
use crate::app::actions::{Action, Requests};
use crate::app::state::State;
use crate::app::state::layout::Places;
use crate::app::theme;
use crate::app::widgets::regions;

/// The places of the panels in one frame.
#[derive(Clone, Debug)]
pub(crate) struct Arrangement {
    /// The area between the menus and the status line.
    area: Rect,
    places: Places,
}

type Contents = fn(&mut Ui, &State, &mut Requests);

macro_rules! contents {
    ($(
        $panel:ident $file:ident $name:literal [$dock:expr] $open:literal [$($key:expr),*]
            $label:literal $hint:literal $words:literal;
    )+) => {
        const fn contents(panel: Panel) -> Contents {
            match panel {
                $(Panel::$panel => super::$file::show,)+
            }
        }
    };
}

each_panel!(contents);

/// Shows a panel as a window of a fixed size, or less in a small window. Its button closes the
/// panel.
pub(super) fn window(
    ui: &Ui,
    panel: Panel,
    size: Vec2,
    requests: &mut Requests,
    add: impl FnOnce(&mut Ui, &mut Requests),
) {
    let mut open = true;
    let area = ui.ctx().content_rect();
    let size = size.min(area.size() - vec2(80.0, 120.0));
    Window::new(panel.info().label)
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .default_pos(area.center() - size / 2.0)
        .fixed_size(size)
        .show(ui.ctx(), |ui| add(ui, requests));
    if !open {
        requests.push(Action::Panel(panel).into());
    }
}

impl Arrangement {
    /// Returns the area left for the picture.
    pub(crate) const fn picture(&self) -> Rect {
        self.places.picture
    }

    /// Shows everything over the picture: open panels, the palette and the greeting. The splitters
    /// come last, since the picture would take their presses.
    pub(crate) fn over_picture_ui(&self, ui: &mut Ui, state: &State, requests: &mut Requests) {
        if state.picture_only {
            return;
        }
        let builder = UiBuilder::new().id_salt("over the picture").max_rect(self.places.picture);
        let mut child = ui.new_child(builder);
        child.set_clip_rect(self.places.picture.intersect(ui.clip_rect()));
        let open =
            |panel: &&Panel| state.panels.has(**panel) && panel.info().dock == Dock::Floating;
        for panel in Panel::ALL.iter().filter(open) {
            contents(*panel)(&mut child, state, requests);
        }
        dial::show(ui, self.places.picture, state, requests);
        dial::progress_ui(ui, self.places.picture, state, requests);
        greeting::show(ui, self.places.picture, state, requests);
        if let Some(presenting) = state.presenting {
            hint_ui(ui, self.places.picture, presenting.since);
        }
        splitters::show(ui, state, self.area, &self.places, requests);
    }
}

/// The seconds for which a presentation tells how it ends.
const HINTED: f64 = 4.0;

/// Tells how a presentation ends, at its beginning.
fn hint_ui(ui: &Ui, picture: Rect, since: f64) {
    let left = since + HINTED - ui.input(|input| input.time);
    if left <= 0.0 {
        return;
    }
    ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(left));
    let area = Area::new(Id::unique("presentation")).order(Order::Middle).interactable(false);
    let at = picture.center_bottom() - vec2(0.0, 12.0);
    area.pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).show(ui, |ui| ui.label("F11 or Esc ends the presentation"));
    });
}

/// Shows the bars and all open docked panels.
pub(crate) fn show(ui: &mut Ui, state: &State, requests: &mut Requests) -> Arrangement {
    if state.picture_only {
        let area = ui.available_rect_before_wrap();
        return Arrangement { area, places: Places::of_picture(area) };
    }
    let fill = ui.visuals().panel_fill;
    let bar = Frame::new().fill(fill).inner_margin(Margin::symmetric(theme::MARGIN, 2));
    if state.presenting.is_none() {
        egui::Panel::top("menu bar").frame(bar).show(ui, |ui| {
            regions::begin(ui, "menus");
            menu_bar::show(ui, state, requests);
        });
        egui::Panel::bottom("status line")
            .frame(bar)
            .show(ui, |ui| status_line::show(ui, state, requests));
    }
    let area = ui.available_rect_before_wrap();
    let mut layout = state.layout;
    layout.bare = state.presenting.is_some();
    if state.renaming.is_some() {
        // The outline is needed for renaming, so it is shown while an item is renamed.
        layout.unfolded = Some(Side::Outline);
    }
    let renames = state.renaming.is_some();
    let panels = state.panels.with(Panel::Outline, state.panels.has(Panel::Outline) || renames);
    // Docked panels are laid out first, and the picture gets the rest.
    let mut places = layout.divide(area, panels);
    places.picture = lesson_card::show(ui, places.picture, state, requests);
    if let Some(rect) = places.strip {
        ui.painter().rect_filled(rect, 0.0, fill);
        regions::begin(ui, "strip");
        splitters::strip_ui(ui, rect, state, requests);
    }
    for panel in Panel::ALL {
        let Some(rect) = places.of(panel.info().dock) else { continue };
        within(ui, panel.info().label, rect, |ui| contents(*panel)(ui, state, requests));
    }
    if state.palette {
        palette::show(ui, state, requests);
    }
    Arrangement { area, places }
}

/// Shows a panel in its place. Its contents never enlarge it.
fn within(ui: &mut Ui, name: &str, rect: Rect, add: impl FnOnce(&mut Ui)) {
    ui.painter().rect_filled(rect, 0.0, ui.visuals().panel_fill);
    // The contents reserve space for a scroll bar.
    let margin = Margin { left: theme::MARGIN, right: 2, top: 4, bottom: 4 };
    let layout = Layout::top_down(egui::Align::Min);
    let builder = UiBuilder::new().id_salt(name).max_rect(rect - margin).layout(layout);
    let mut child = ui.new_child(builder);
    child.set_clip_rect(rect.intersect(ui.clip_rect()));
    regions::begin(&child, name);
    add(&mut child);
    regions::follow_focus(&child);
}
