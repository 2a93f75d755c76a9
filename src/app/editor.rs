//! The editor: it shows the panels, and at the end of the frame does what was asked for.

use egui::ThemePreference;

use super::action::Action;
use super::ask::Ask;
use super::keyboard::Keyboard;
use super::panels;
use super::state::{Message, State, Tone};
use crate::edit::Gesture;
use crate::scene::{Command, Scene, View};

/// The editor.
#[derive(Debug)]
pub struct App {
    state: State,
}

impl App {
    /// An editor of this scene.
    #[must_use]
    pub fn new(scene: Scene, view: View) -> Self {
        Self { state: State::new(scene, view) }
    }

    /// What is edited and shown.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Shows the editor, and does what the user asks of it.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        Keyboard::install(ui.ctx());
        let mut asks = Vec::new();
        panels::show(ui, &self.state, &mut asks);
        let pressed = Action::pressed(ui.ctx());
        // Last, so that everything that is shown in a frame shows the same scene.
        for press in pressed {
            self.perform(press.action, press.gesture);
        }
        for ask in asks {
            self.answer(ask);
        }
        ui.ctx().set_theme(self.state.shown.theme);
    }

    fn answer(&mut self, ask: Ask) {
        match ask {
            Ask::Do(action) => self.perform(action, Gesture::Whole),
            Ask::Change { command, gesture, label } => self.change(command, gesture, &label),
            Ask::Look(view) => self.state.view = *view,
            Ask::Settings(settings) => self.state.settings = settings,
            Ask::PutAway(at) if at < self.state.notices.len() => {
                self.state.notices.remove(at);
            }
            Ask::Refuse(why) => {
                self.state.message = Some(Message { text: why, tone: Tone::Refused });
            }
            _ => {}
        }
    }

    /// Does what stands in the table of actions.
    pub fn perform(&mut self, action: Action, gesture: Gesture) {
        let _ = gesture;
        let shown = &mut self.state.shown;
        match action {
            Action::CheatSheet => shown.cheat_sheet ^= true,
            Action::ToggleOutline => shown.outline ^= true,
            Action::ToggleProperties => shown.properties ^= true,
            Action::ToggleViewPanel => shown.view ^= true,
            Action::ToggleStatistics => shown.statistics ^= true,
            Action::ThemeSystem => shown.theme = ThemePreference::System,
            Action::ThemeLight => shown.theme = ThemePreference::Light,
            Action::ThemeDark => shown.theme = ThemePreference::Dark,
            _ => {}
        }
    }

    /// Changes the scene. Every change of it ends here.
    fn change(&mut self, command: Command, gesture: Gesture, label: &str) {
        let state = &mut self.state;
        match state.history.perform(&mut state.scene, command, gesture, label) {
            Ok(()) => state.gesture = gesture,
            Err(error) => {
                state.message = Some(Message { text: error.to_string(), tone: Tone::Refused });
            }
        }
    }
}
