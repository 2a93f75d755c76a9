//! The history: changes as steps that can be undone and redone.
//!
//! One undo undoes one step. A step holds the commands that lead away from the current position:
//! steps before it lead back, steps after it lead forward.

use super::{Gesture, Selected};
use crate::scene::{Command, CommandError, Scene};

#[derive(Debug)]
struct Step {
    label: String,
    /// Applied from last to first.
    commands: Vec<Command>,
    /// What was selected before and after it, if that was noted.
    selected: Option<[Selected; 2]>,
}

/// The steps done and undone. It is the only writer of the scene: any other change would invalidate
/// the steps.
#[derive(Debug)]
pub struct History {
    steps: Vec<Step>,
    /// The number of steps done; those after them were undone.
    position: usize,
    /// The gesture of the last step, while it may continue.
    open: Gesture,
    /// The position at which the scene was saved; `None` if no step leads there any more.
    saved: Option<usize>,
}

impl Default for History {
    fn default() -> Self {
        Self::new()
    }
}

impl History {
    /// A history without steps, of a scene that counts as saved.
    #[must_use]
    pub const fn new() -> Self {
        Self { steps: Vec::new(), position: 0, open: Gesture::Whole, saved: Some(0) }
    }

    /// Applies a command, and records under `label` how to undo it; of a gesture, the last label
    /// stays. Undone steps are discarded.
    ///
    /// # Errors
    /// If the command does not fit the scene; then neither scene nor history changes.
    pub fn perform(
        &mut self,
        scene: &mut Scene,
        command: Command,
        gesture: Gesture,
        label: &str,
    ) -> Result<(), CommandError> {
        let back = command.apply(scene)?;
        self.steps.truncate(self.position);
        match self.steps.last_mut() {
            Some(step) if gesture != Gesture::Whole && gesture == self.open => {
                // The step goes back to before the gesture began; the places that the gesture went
                // through on its way are of no interest to anybody.
                if !step.commands.last().is_some_and(|last| last.overwrites(&back)) {
                    step.commands.push(back);
                }
                // It says how far the whole gesture went.
                label.clone_into(&mut step.label);
                self.saved = self.saved.filter(|saved| *saved < self.position);
            }
            _ => {
                self.saved = self.saved.filter(|saved| *saved <= self.position);
                let label = label.to_owned();
                self.steps.push(Step { label, commands: vec![back], selected: None });
                self.position += 1;
            }
        }
        self.open = gesture;
        Ok(())
    }

    /// Notes what was selected before the last step, unless it is part of a gesture that began
    /// before, and what is selected after it.
    pub fn note_selected(&mut self, before: Selected, after: Selected) {
        if let Some(step) = self.position.checked_sub(1).and_then(|last| self.steps.get_mut(last)) {
            let before = step.selected.take().map_or(before, |[before, _]| before);
            step.selected = Some([before, after]);
        }
    }

    /// What was selected before the step that undo would undo.
    #[must_use]
    pub fn selected_before(&self) -> Option<&Selected> {
        let last = self.steps.get(self.position.checked_sub(1)?)?;
        last.selected.as_ref().map(|[before, _]| before)
    }

    /// What was selected after the step that redo would redo.
    #[must_use]
    pub fn selected_after(&self) -> Option<&Selected> {
        self.steps.get(self.position)?.selected.as_ref().map(|[_, after]| after)
    }

    /// Undoes the last step. Returns its label; `None` if there was no step.
    pub fn undo(&mut self, scene: &mut Scene) -> Option<String> {
        let last = self.position.checked_sub(1)?;
        let label = self.cross(scene, last)?;
        self.position = last;
        Some(label)
    }

    /// Redoes the step that was undone last. Returns its label; `None` if there was none.
    pub fn redo(&mut self, scene: &mut Scene) -> Option<String> {
        let label = self.cross(scene, self.position)?;
        self.position += 1;
        Some(label)
    }

    /// Cancels the current gesture, without a step to redo. Returns whether there was anything to
    /// undo.
    pub fn abandon(&mut self, scene: &mut Scene, gesture: Gesture) -> bool {
        if gesture == Gesture::Whole || gesture != self.open || self.undo(scene).is_none() {
            return false;
        }
        self.steps.truncate(self.position);
        true
    }

    /// Goes to the point after `position` steps, at most to the end.
    pub fn go_to(&mut self, scene: &mut Scene, position: usize) {
        while self.position > position && self.undo(scene).is_some() {}
        while self.position < position && self.redo(scene).is_some() {}
    }

    /// The labels of all steps, oldest first: those done, then those undone.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = &str> {
        self.steps.iter().map(|step| step.label.as_str())
    }

    /// The number of steps done.
    #[must_use]
    pub const fn position(&self) -> usize {
        self.position
    }

    /// Whether the scene is unchanged since it was last saved or loaded.
    #[must_use]
    pub fn is_saved(&self) -> bool {
        self.saved == Some(self.position)
    }

    /// Marks the current scene as saved.
    pub const fn mark_saved(&mut self) {
        self.saved = Some(self.position);
    }

    /// Marks the scene as unsaved, although no step leads to it.
    pub const fn mark_unsaved(&mut self) {
        self.saved = None;
    }

    /// Discards all steps: the scene is new and counts as saved.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// Applies the step at `index`, and replaces it by its inverse.
    fn cross(&mut self, scene: &mut Scene, index: usize) -> Option<String> {
        let step = self.steps.get_mut(index)?;
        self.open = Gesture::Whole;
        let commands = std::mem::take(&mut step.commands);
        match Command::Batch(commands.into_iter().rev().collect()).apply(scene) {
            Ok(Command::Batch(mut back)) => {
                // The batch gives them in the order of their application; a step keeps the reverse.
                back.reverse();
                step.commands = back;
                Some(step.label.clone())
            }
            // Only where somebody else has written the scene: the steps lead nowhere any more, and
            // the scene is kept as it is.
            _ => {
                (self.steps, self.position, self.saved) = (Vec::new(), 0, None);
                None
            }
        }
    }
}
