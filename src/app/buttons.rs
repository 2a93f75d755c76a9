//! Actions as buttons, switches and entries of menus.
//!
//! Each tells by its tooltip what it does, on which key it is, and why it cannot be done now.

use egui::{Context, Response, RichText, Ui};

use super::action::Action;
use super::keyboard::{Keyboard, Press};
use super::state::State;

impl Action {
    /// What was pressed on the keyboard in this frame, in order.
    #[must_use]
    pub fn pressed(ctx: &Context) -> Vec<Press> {
        Keyboard::take(ctx)
    }

    /// A button for the action. Gives it back when clicked.
    pub fn button(self, ui: &mut Ui, state: &State) -> Option<Self> {
        self.add(ui, state, egui::Button::new(self.look().label))
    }

    /// A button that looks pressed while the action's switch is on. Gives it back when clicked.
    pub fn switch(self, ui: &mut Ui, state: &State) -> Option<Self> {
        let on = self.is_on(state).unwrap_or(false);
        self.add(ui, state, egui::Button::selectable(on, self.look().label))
    }

    /// An entry of a menu with its key at the right. Gives the action back when clicked.
    pub fn menu_item(self, ui: &mut Ui, state: &State) -> Option<Self> {
        let look = self.look();
        let on = self.is_on(state).unwrap_or(false);
        let key = look.keys.first().map(|key| key.name()).unwrap_or_default();
        let button = egui::Button::new(look.label).selected(on).shortcut_text(key);
        let clicked = self.add(ui, state, button);
        if clicked.is_some() {
            ui.close();
        }
        clicked
    }

    /// The tooltip of whatever stands for the action: its hint and its keys, and why it cannot be
    /// done now.
    pub fn explain(self, response: Response, state: &State) -> Response {
        let tip = |ui: &mut Ui| {
            let look = self.look();
            ui.label(look.hint);
            if !look.keys.is_empty() {
                let keys: Vec<String> = look.keys.iter().map(|key| key.name()).collect();
                ui.label(RichText::new(format!("Key: {}", keys.join(" or "))).weak());
            }
            if let Err(why) = self.availability(state) {
                ui.label(format!("Not now: {why}."));
            }
        };
        response.on_hover_ui(tip).on_disabled_hover_ui(tip)
    }

    fn add(self, ui: &mut Ui, state: &State, button: egui::Button<'_>) -> Option<Self> {
        let response = ui.add_enabled(self.availability(state).is_ok(), button);
        if let Some(on) = self.is_on(state) {
            let enabled = response.enabled();
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::CheckBox, enabled, on, self.look().label)
            });
        }
        self.explain(response, state).clicked().then_some(self)
    }
}
