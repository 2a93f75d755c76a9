//! The dial and the loupe, which show what accuracy costs and gives in this view.

use egui::{Context, Key};

use super::App;

/// A key held for this many seconds shows the loupe only while it is held.
const HELD: f64 = 0.35;

impl App {
    /// Notes whether the figures of the dial belong to the picture on screen, and keeps settings of
    /// the user's own.
    pub(super) fn note_dial(&mut self) {
        self.state.dial.keep_own(&self.state.settings);
        let Some(size) = self.viewport.size() else { return };
        let state = &self.state;
        let is_of = |last: &crate::app::drawing::dial::DialFigures| last.of == state.dialled(size);
        self.state.dial.current = state.dial.last.as_ref().is_some_and(|last| is_of(last));
    }

    pub(super) fn toggle_loupe(&mut self, ctx: &Context) {
        self.state.loupe ^= true;
        let (now, is_held) = ctx.input(|input| (input.time, input.key_down(Key::K)));
        self.loupe_held = (self.state.loupe && is_held).then_some(now);
    }

    /// Hides the loupe when its key is released after it was held.
    pub(super) fn release_loupe(&mut self, ctx: &Context) {
        let (now, is_held) = ctx.input(|input| (input.time, input.key_down(Key::K)));
        if let (Some(since), false) = (self.loupe_held, is_held) {
            self.loupe_held = None;
            if now - since >= HELD {
                self.state.loupe = false;
            }
        }
    }
}
