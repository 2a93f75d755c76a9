//! Borders between panels that can be dragged, and the strip of buttons in a narrow window.

use egui::{CursorIcon, Id, Rect, Sense, Stroke, Ui, UiBuilder, WidgetInfo, vec2};

use crate::app::actions::{Action, Request, Requests};
use crate::app::input::buttons::action_icon;
use crate::app::panels::{Panel, Side};
use crate::app::state::State;
use crate::app::state::layout::{Places, Splitter};
use crate::app::theme;
use crate::app::widgets::icons::Icon;

/// The width of a splitter for the mouse.
const GRIP: f32 = 7.0;

/// Shows all splitters over the panels; their requests are added to `requests`.
pub(crate) fn show(ui: &Ui, state: &State, area: Rect, places: &Places, requests: &mut Requests) {
    for splitter in Splitter::ALL {
        let (Some(line), Some(grip)) = (places.grip(splitter, 0.0), places.grip(splitter, GRIP))
        else {
            continue;
        };
        // Tab skips splitters, since sizes are not part of the scene.
        let sense = Sense::click_and_drag() - Sense::FOCUSABLE;
        let response = ui.interact(grip, Id::unique(("splitter", splitter)), sense);
        let name = splitter.name();
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Splitter, true, name));
        let cursor = if splitter.is_upright() {
            CursorIcon::ResizeHorizontal
        } else {
            CursorIcon::ResizeVertical
        };
        let held = response.dragged();
        let response = response.on_hover_cursor(cursor);
        let stroke = if held || response.hovered() {
            theme::ring(ui.visuals())
        } else {
            Stroke::new(1.0, theme::line(ui.visuals()))
        };
        // The line is inside the panel, so it covers no pixel of the picture.
        let half = stroke.width / 2.0;
        if splitter.is_upright() {
            let at_left = splitter == Splitter::Right && places.strip.is_none();
            let aside = if at_left { half } else { -half };
            ui.painter().vline(line.center().x + aside, line.y_range(), stroke);
        } else {
            ui.painter().hline(line.x_range(), line.center().y + half, stroke);
        }
        if response.double_clicked() {
            requests.push(Request::Layout(state.layout.reset(splitter)));
        } else if let Some(to) = response.interact_pointer_pos().filter(|_| held) {
            requests.push(Request::Layout(state.layout.dragged(splitter, to, area, places)));
        }
    }
}

/// Shows the buttons that unfold panels.
pub(crate) fn strip_ui(ui: &mut Ui, rect: Rect, state: &State, requests: &mut Requests) {
    let inner = rect.shrink2(vec2((rect.width() - theme::ROW) / 2.0, theme::GAP));
    let mut child = ui.new_child(UiBuilder::new().id_salt("strip").max_rect(inner));
    for (side, icon, panel) in [
        (Side::Outline, Icon::LIST, Panel::Outline),
        (Side::Switches, Icon::SWITCHES, Panel::View),
        (Side::Properties, Icon::PROPERTIES, Panel::Properties),
    ] {
        if state.layout.unfolded == Some(side) {
            let row = vec2(theme::ROW, theme::ROW);
            let ground = Rect::from_min_size(child.cursor().min, row);
            child.painter().rect_filled(ground, 4.0, child.visuals().selection.bg_fill);
        }
        action_icon(&mut child, state, requests, icon, Action::Panel(panel));
    }
}
