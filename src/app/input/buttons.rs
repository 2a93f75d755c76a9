//! Actions as buttons, switches and menu entries.
//!
//! Their tooltips say what the action does, which key it has, and why it is not available now.

use egui::{Atom, IdSalt, Response, RichText, Role, Ui, WidgetInfo};

use super::keyboard::Keyboard;
use crate::app::actions::{Action, Requests};
use crate::app::state::State;
use crate::app::widgets::controls::{Choice, Switch, icon_button};
use crate::app::widgets::icons::Icon;

impl Action {
    /// Shows a button for the action. Returns the action if it was clicked.
    pub fn button(self, ui: &mut Ui, state: &State) -> Option<Self> {
        self.add(ui, state, egui::Button::new(self.info().label))
    }

    /// Shows a button that looks pressed while the action's switch is on. Returns the action if it
    /// was clicked.
    pub fn switch(self, ui: &mut Ui, state: &State) -> Option<Self> {
        let on = self.is_on(state).unwrap_or(false);
        self.add(
            ui,
            state,
            egui::Button::selectable(on, self.info().label).frame_when_inactive(true),
        )
    }

    /// Shows a menu entry with its key at the right and, while its switch is on, a tick at the
    /// left. Returns the action if it was clicked.
    pub fn menu_item(self, ui: &mut Ui, state: &State) -> Option<Self> {
        let info = self.info();
        let key = first_key(ui, self).unwrap_or_default();
        let tick = IdSalt::new("tick");
        let atoms = (Atom::custom(tick, egui::vec2(12.0, 12.0)), info.label);
        let button = egui::Button::new(atoms).shortcut_text(key);
        let enabled = self.availability(state).is_ok();
        let shown = ui.add_enabled_ui(enabled, |ui| button.atom_ui(ui)).inner;
        if self.is_on(state) == Some(true) {
            for (_, rect) in shown.custom_rects().filter(|(id, _)| *id == tick) {
                Icon::TICK.paint(ui.painter(), rect, 10.0, ui.visuals().text_color());
            }
        }
        shown.response.widget_info(|| match self.is_on(state) {
            Some(on) => WidgetInfo::selected(Role::MenuItemCheckBox, enabled, on, info.label),
            None => WidgetInfo::labeled(Role::MenuItem, enabled, info.label),
        });
        let clicked = self.explain(shown.response, state).clicked().then_some(self);
        if clicked.is_some() {
            ui.close();
        }
        clicked
    }

    /// Adds a tooltip to a control of the action: its hint, its keys, and why it is not available.
    pub fn explain(self, response: Response, state: &State) -> Response {
        self.explain_also(response, state, "")
    }

    /// Works as [`Self::explain`], with a further sentence.
    pub(crate) fn explain_also(self, response: Response, state: &State, also: &str) -> Response {
        let tip = |ui: &mut Ui| {
            ui.label(self.info().hint);
            if !also.is_empty() {
                ui.label(also);
            }
            let keymap = Keyboard::keymap(ui.ctx());
            if !keymap.keys(self).is_empty() {
                let keys: Vec<String> = keymap.keys(self).iter().map(|key| key.name()).collect();
                ui.label(RichText::new(format!("Key: {}", keys.join(" or "))).weak());
            }
            if let Err(why) = self.availability(state) {
                ui.label(format!("Unavailable: {why}."));
            }
        };
        response.on_hover_ui(tip).on_disabled_hover_ui(tip)
    }

    fn add(self, ui: &mut Ui, state: &State, button: egui::Button<'_>) -> Option<Self> {
        let response = ui.add_enabled(self.availability(state).is_ok(), button);
        if let Some(on) = self.is_on(state) {
            let enabled = response.enabled();
            response.widget_info(|| {
                WidgetInfo::selected(Role::CheckBox, enabled, on, self.info().label)
            });
        }
        self.explain(response, state).clicked().then_some(self)
    }
}

pub(crate) fn first_key(ui: &Ui, action: Action) -> Option<String> {
    Keyboard::keymap(ui.ctx()).keys(action).first().map(|key| key.name())
}

/// Shows the switch of an action, with its key and its tooltip.
pub(crate) fn action_switch(ui: &mut Ui, state: &State, requests: &mut Requests, action: Action) {
    let info = action.info();
    let switch = Switch {
        label: info.label,
        key: first_key(ui, action),
        on: action.is_on(state).unwrap_or(false),
        enabled: action.availability(state).is_ok(),
    };
    if action.explain(switch.ui(ui), state).clicked() {
        requests.push(action.into());
    }
}

pub(crate) fn action_icon(
    ui: &mut Ui,
    state: &State,
    requests: &mut Requests,
    icon: Icon,
    action: Action,
) {
    let enabled = action.availability(state).is_ok();
    let response = icon_button(ui, icon, action.info().label, enabled);
    if action.explain(response, state).clicked() {
        requests.push(action.into());
    }
}

/// Creates the option that an action chooses. An option that is on is never shown as refused.
pub(crate) fn action_choice<'a>(
    ui: &Ui,
    of: &str,
    (label, on): (&'a str, bool),
    action: Action,
    state: &State,
) -> Choice<'a> {
    let info = action.info();
    let refused = if on { None } else { action.availability(state).err() };
    let key = first_key(ui, action);
    Choice { key, refused, ..Choice::new(of, label, on, info.hint) }
}
