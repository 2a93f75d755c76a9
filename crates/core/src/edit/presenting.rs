//! Shows models that come without a scene: alone, framed and lit, in front of a neutral background.
//!
//! The result is the same in the window with files on the command line, after dropping a model on
//! the untouched first scene, and in `render`. In the window the model is selected, and the camera
//! orbits it.

use super::items::{insert_objects, set_mode};
use super::{Refusal, framing, lighting, selection};
use crate::scene::{CameraMode, Command, ItemId, Object, Observer, Scene, Subject, View};

/// Replaces all objects by these, frames and lights them, and sets a neutral background. Returns
/// the change, and the view of the changed scene, with steps by size. The first object is selected,
/// and the camera is in analysis of it without being turned.
///
/// # Errors
/// If the scene cannot be changed in this way.
pub fn alone(scene: &Scene, view: &View, objects: Vec<Object>) -> Result<(Command, View), Refusal> {
    let mut scratch = Scratch { scene: scene.clone(), view: view.clone(), commands: Vec::new() };
    for id in scene.objects.ids() {
        scratch.change(Command::Remove(ItemId::Object(id)))?;
    }
    scratch.change(insert_objects(&scratch.scene, objects))?;
    scratch.change(Command::Background(Scene::NEUTRAL))?;
    scratch.view.observer = Observer::Camera;
    scratch.view.subject = Subject::Object;
    scratch.view.steps.by_size = true;
    match framing::models(&scratch.scene, &scratch.view, framing::MODELS_FROM) {
        Ok(framed) => scratch.change(framed)?,
        // A model without vertices needs no view.
        Err(Refusal::NothingToFrame) => {}
        Err(refusal) => return Err(refusal),
    }
    match lighting::models(&scratch.scene, &scratch.view) {
        Ok(lit) => scratch.change(lit)?,
        Err(Refusal::NothingToFrame) => {}
        Err(refusal) => return Err(refusal),
    }
    // The camera orbits the object from its current pose. Aiming it would move the object out of
    // the middle of the picture, since the mean of its vertices is not the centre of its sphere.
    if let Some(target) = scratch.view.object {
        let mode = CameraMode::Analysis { target };
        scratch.change(set_mode(&scratch.scene, scratch.view.camera, mode)?)?;
    }
    Ok((Command::Batch(scratch.commands), scratch.view))
}

/// A copy of the scene, with the commands applied to it.
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
