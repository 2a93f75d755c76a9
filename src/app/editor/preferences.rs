//! Applies preferences, from the file at the start or from the panel.

use egui::{Context, ThemePreference, ViewportCommand};

use super::App;
use crate::app::input::keyboard::Keyboard;
use crate::app::input::keymap::Keymap;
use crate::app::panels::preferences::now;
use crate::app::panels::{OpenPanels, Panel};
use crate::app::state::DrawingChoices;
use crate::app::state::layout::Layout;
use marraztu_io::{Preferences, Theme};

impl App {
    /// Applies preferences that the user has changed.
    pub(crate) fn take_preferences(&mut self, ctx: &Context, preferences: &Preferences) {
        let before = now(ctx, &self.state, None);
        // The default size has to be requested; any other size is the window's current one.
        if before.window.is_some() && preferences.window.is_none() {
            ctx.send_viewport_cmd(ViewportCommand::Maximized(false));
            ctx.send_viewport_cmd(ViewportCommand::InnerSize(Preferences::WINDOW.into()));
        }
        let shown = self.state.panels;
        self.use_preferences(ctx, preferences);
        for panel in Panel::MOMENTARY {
            self.state.panels = self.state.panels.with(panel, shown.has(panel));
        }
    }

    /// Applies preferences. Returns sentences about chosen keys that have changed.
    pub(super) fn use_preferences(&mut self, ctx: &Context, it: &Preferences) -> Vec<String> {
        let theme = match it.theme {
            Theme::System => ThemePreference::System,
            Theme::Light => ThemePreference::Light,
            Theme::Dark => ThemePreference::Dark,
        };
        ctx.set_theme(theme);
        ctx.set_zoom_factor(it.scale);
        let state = &mut self.state;
        state.theme = theme;
        state.panels = OpenPanels::of_kept(&it.panels);
        state.overlays = it.overlays;
        state.dial.shown = it.dial;
        state.helpers = it.helpers;
        state.watches = it.watches;
        state.up = it.up;
        state.layout = Layout { unfolded: state.layout.unfolded, ..Layout::of_shares(&it.shares) };
        let (keymap, changed_keys) = Keymap::of_names(&it.keys);
        Keyboard::set_keymap(ctx, keymap);
        state.gizmo = it.gizmo;
        let Preferences { refines, refined, budget_ms, .. } = *it;
        state.drawing = DrawingChoices { refines, refined, budget_ms };
        state.recent.clone_from(&it.recent);
        changed_keys
    }
}
