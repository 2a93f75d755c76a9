//! Actions as buttons, switches and entries of menus.
//!
//! Each tells by its tooltip what it does, on which key it is, and why it cannot be done now.

use egui::{Atom, Context, IdSalt, Response, RichText, Role, Ui, WidgetInfo};

use super::action::Action;
use super::keyboard::{Keyboard, Press};
use super::panels::icons::Icon;
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

    /// An entry of a menu with its key at the right and, while its switch is on, a tick at the
    /// left. Gives the action back when clicked.
    pub fn menu_item(self, ui: &mut Ui, state: &State) -> Option<Self> {
        let look = self.look();
        let key = look.keys.first().map(|key| key.name()).unwrap_or_default();
        let tick = IdSalt::new("tick");
        let atoms = (Atom::custom(tick, egui::vec2(12.0, 12.0)), look.label);
        let button = egui::Button::new(atoms).shortcut_text(key);
        let enabled = self.availability(state).is_ok();
        let shown = ui.add_enabled_ui(enabled, |ui| button.atom_ui(ui)).inner;
        if self.is_on(state) == Some(true) {
            for (_, rect) in shown.custom_rects().filter(|(id, _)| *id == tick) {
                Icon::Tick.paint(ui.painter(), rect, 10.0, ui.visuals().text_color());
            }
        }
        shown.response.widget_info(|| match self.is_on(state) {
            Some(on) => WidgetInfo::selected(Role::MenuItemCheckBox, enabled, on, look.label),
            None => WidgetInfo::labeled(Role::MenuItem, enabled, look.label),
        });
        let clicked = self.explain(shown.response, state).clicked().then_some(self);
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
                WidgetInfo::selected(Role::CheckBox, enabled, on, self.look().label)
            });
        }
        self.explain(response, state).clicked().then_some(self)
    }
}
