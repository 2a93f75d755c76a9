//! The history: changes as steps that can be undone and redone.
//!
//! A step is what one undo takes back. It holds the command that leads away from where the scene
//! is: steps before the present position lead back, those after it lead forward.

use super::Gesture;
use crate::scene::{Command, CommandError, Scene};

#[derive(Debug)]
struct Step {
    label: String,
    /// Applied from last to first.
    commands: Vec<Command>,
}

/// The changes made so far, and those taken back. Writes the scene; whoever else writes it makes
/// the steps unfit.
#[derive(Debug)]
pub struct History {
    steps: Vec<Step>,
    /// How many of the steps are done; those after them were taken back.
    position: usize,
    /// The gesture that the last step belongs to, while it may still go on.
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
    /// A history without steps, of a scene that needs no saving.
    #[must_use]
    pub const fn new() -> Self {
        Self { steps: Vec::new(), position: 0, open: Gesture::Whole, saved: Some(0) }
    }

    /// Changes the scene, and remembers under `label` how to change it back. What was taken back
    /// before is gone then.
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
                self.saved = self.saved.filter(|saved| *saved < self.position);
            }
            _ => {
                self.saved = self.saved.filter(|saved| *saved <= self.position);
                self.steps.push(Step { label: label.to_owned(), commands: vec![back] });
                self.position += 1;
            }
        }
        self.open = gesture;
        Ok(())
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

    /// Takes a gesture back while it lasts, as if it had never begun: no redo leads to it. Says
    /// whether there was anything to take back.
    pub fn abandon(&mut self, scene: &mut Scene, gesture: Gesture) -> bool {
        if gesture == Gesture::Whole || gesture != self.open || self.undo(scene).is_none() {
            return false;
        }
        self.steps.truncate(self.position);
        true
    }

    /// Goes to where `position` steps are done: 0 is the beginning. Past the end means the end.
    pub fn go_to(&mut self, scene: &mut Scene, position: usize) {
        while self.position > position && self.undo(scene).is_some() {}
        while self.position < position && self.redo(scene).is_some() {}
    }

    /// The labels of all steps, the oldest first: those done, then those taken back.
    pub fn steps(&self) -> impl ExactSizeIterator<Item = &str> {
        self.steps.iter().map(|step| step.label.as_str())
    }

    /// How many steps are done.
    #[must_use]
    pub const fn position(&self) -> usize {
        self.position
    }

    /// Whether the scene is as it was when it was last saved (or loaded).
    #[must_use]
    pub fn is_saved(&self) -> bool {
        self.saved == Some(self.position)
    }

    /// Remembers that the scene as it is now is on the disk.
    pub const fn mark_saved(&mut self) {
        self.saved = Some(self.position);
    }

    /// Forgets all steps: the scene is a new one, and needs no saving.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// Applies the step at `index`, and leaves in its place the one that leads the other way.
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
