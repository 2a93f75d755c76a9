//! Moves the view, which is not a step of the history, and goes back to earlier viewpoints.

use super::App;
use crate::app::state::{State, ViewStep};
use marraztu_core::edit::{Gesture, Viewpoint, near_plane};
use marraztu_core::scene::Command;

impl App {
    /// Moves the view, and remembers the viewpoint before it.
    pub(super) fn noting_viewpoint(&mut self, gesture: Gesture, act: impl FnOnce(&mut Self)) {
        let now = |state: &State| Viewpoint::of(&state.scene, &state.view);
        let before = now(&self.state);
        act(self);
        let after = now(&self.state);
        self.state.viewpoints.note(before, &after, gesture);
    }

    /// Moves the view without remembering.
    pub(super) fn move_view(&mut self, command: Command, gesture: Gesture) {
        let state = &mut self.state;
        let repeats = state.next_repeat(gesture);
        match state.history.navigate(&mut state.scene, command, gesture) {
            Ok(()) => {
                (state.gesture, state.repeats) = (gesture, repeats);
                state.message = None;
                self.adapt_near(gesture);
            }
            Err(error) => self.refuse(error.to_string()),
        }
    }

    /// Moves the automatic near plane if it would cut a surface in view.
    pub(super) fn adapt_near(&mut self, gesture: Gesture) {
        let Some(size) = self.viewport.size() else { return };
        let State { scene, view, history, moved_near, .. } = &mut self.state;
        if let Some(command) = near_plane::adapted(scene, view, size, moved_near) {
            // Replacing the lens of an existing camera cannot fail.
            let _ = history.navigate(scene, command, gesture);
        }
    }

    /// Goes to an earlier or later viewpoint, or to the saved one.
    pub(super) fn go_to_viewpoint(&mut self, step: ViewStep) {
        let State { scene, view, viewpoints, .. } = &self.state;
        let Some(to) = viewpoints.at(step, scene, view) else { return };
        let now = Viewpoint::of(scene, view);
        let (view, command) = to.shown(scene, view);
        match command {
            Ok(command) => {
                self.set_view(view);
                self.move_view(command, Gesture::Whole);
                self.state.viewpoints.walk(now, step, &to);
            }
            Err(refusal) => self.refuse(refusal.to_string()),
        }
    }
}
