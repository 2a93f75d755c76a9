//! Moves through the history.

use super::App;
use crate::app::state::State;
use marraztu_core::edit::{Gesture, Selected, selection, transform};
use marraztu_core::scene::Scene;

impl App {
    /// Undoes the last step. Returns its label; `None` if there was no step.
    pub(crate) fn undo(&mut self) -> Option<String> {
        let selected = self.state.history.selected_before().cloned();
        self.walk(selected.as_ref(), |state| state.history.undo(&mut state.scene))
    }

    /// Redoes the step that was undone last. Returns its label; `None` if there was none.
    pub(crate) fn redo(&mut self) -> Option<String> {
        let selected = self.state.history.selected_after().cloned();
        self.walk(selected.as_ref(), |state| state.history.redo(&mut state.scene))
    }

    /// Goes to the state after `position` steps, at most to the end.
    pub(crate) fn go_to(&mut self, position: usize) {
        while self.state.history.position() > position && self.undo().is_some() {}
        while self.state.history.position() < position && self.redo().is_some() {}
    }

    /// Undoes a gesture without leaving a step to redo.
    pub(crate) fn abandon(&mut self, gesture: Gesture) {
        let selected = self.state.history.selected_before().cloned();
        self.walk(selected.as_ref(), |state| state.history.abandon(&mut state.scene, gesture));
        self.state.viewpoints.abandon(gesture);
    }

    /// Crosses one step of the history and restores the selection on its other side.
    fn walk<R>(&mut self, selected: Option<&Selected>, step: impl FnOnce(&mut State) -> R) -> R {
        let before = self.state.scene.clone();
        self.changes += 1;
        self.state.message = None;
        let from = self.state.history.position();
        let crossed = step(&mut self.state);
        self.follow_steps(from);
        let State { scene, view, several, gesture, .. } = &mut self.state;
        *gesture = Gesture::Whole;
        match selected {
            Some(selected) => selected.restore(&before, scene, view, several),
            None => selection::follow(&before, scene, view),
        }
        self.aim_again(&before);
        self.adapt_near(Gesture::Whole);
        crossed
    }

    /// Aims a camera in analysis again if a step has moved the object that it orbits. The user may
    /// have looked around since the object was moved, and looking around is not part of the
    /// history.
    fn aim_again(&mut self, before: &Scene) {
        let State { scene, view, history, .. } = &mut self.state;
        let pose = |scene: &Scene| scene.selected_camera(view).pose.clone();
        let placement = |scene: &Scene| {
            let object = view.object.and_then(|id| scene.objects.get(id));
            object.map(|object| object.placement.clone())
        };
        if before.cameras.get(view.camera).is_some()
            && pose(before) == pose(scene)
            && placement(before) != placement(scene)
            && let Some(command) = transform::aimed_again(scene, view)
        {
            // Aiming an existing camera cannot fail.
            let _ = history.navigate(scene, command, Gesture::Whole);
        }
    }
}
