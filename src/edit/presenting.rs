//! Shows models that come without a scene: alone, framed and lit, before a neutral background.
//!
//! The window with files on the command line, a model dropped on the untouched first scene, and
//! `render` show the same.

use super::items::insert_objects;
use super::{Refusal, framing, lighting, selection};
use crate::scene::{Command, ItemId, Object, Observer, Scene, Subject, View};

/// Replaces all objects by these, frames them and lights them, before a neutral background. Returns
/// the change, and the view of the changed scene, whose steps go by its size.
///
/// # Errors
/// If the scene cannot be changed that way.
pub fn alone(scene: &Scene, view: &View, objects: Vec<Object>) -> Result<(Command, View), Refusal> {
    let mut scratch = Scratch { scene: scene.clone(), view: view.clone(), commands: Vec::new() };
    for id in scene.objects.ids() {
        scratch.change(Command::Remove(ItemId::Object(id)))?;
    }
    scratch.change(insert_objects(&scratch.scene, objects))?;
    scratch.change(Command::Background(Scene::NEUTRAL))?;
    scratch.view.observer = Observer::Camera;
    scratch.view.subject = Subject::Camera;
    scratch.view.steps.by_size = true;
    match framing::models(&scratch.scene, &scratch.view, framing::MODELS_FROM) {
        Ok(framed) => scratch.change(framed)?,
        // A model without vertices is in no need of a view.
        Err(Refusal::NothingToFrame) => {}
        Err(refusal) => return Err(refusal),
    }
    match lighting::models(&scratch.scene, &scratch.view) {
        Ok(lit) => scratch.change(lit)?,
        Err(Refusal::NothingToFrame) => {}
        Err(refusal) => return Err(refusal),
    }
    Ok((Command::Batch(scratch.commands), scratch.view))
}

/// A copy of the scene, and what has been done to it.
struct Scratch {
    scene: Scene,
    view: View,
    commands: Vec<Command>,
}

impl Scratch {
    fn change(&mut self, command: Command) -> Result<(), Refusal> {
        let before = self.scene.clone();
        command.clone().apply(&mut self.scene)?;
        selection::follow(&before, &self.scene, &mut self.view);
        self.commands.push(command);
        Ok(())
    }
}
