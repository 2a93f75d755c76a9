//! The up axis of a model's file: the axis that the file states, or else the user's last choice. An
//! opened model is turned by reading it again.

use std::path::Path;

use egui::Context;

use super::App;
use crate::app::documents::loading::Fetched;
use crate::app::state::State;
use crate::app::widgets::text::file_name;
use marraztu_core::base::Shared;
use marraztu_core::edit::{Gesture, Refusal, framing, items};
use marraztu_core::scene::{Command, LoadOptions, ObjectId, UpAxis};
use marraztu_io::{self as io, LoadError, Loaded, is_example};

/// Returns the up axis for opening a model, and a sentence if it is not Y. It is the axis that the
/// file states, or else the last choice.
pub(super) fn usual_up(path: &Path, last: UpAxis) -> (UpAxis, Option<String>) {
    if is_example(path) {
        return (UpAxis::Y, None);
    }
    let stated = io::stated_up(path);
    let up = stated.as_ref().map_or(last, |stated| stated.up);
    let letter = up.word().to_uppercase();
    let said = match stated {
        _ if up == UpAxis::Y => None,
        Some(stated) => Some(format!("{letter} is up: its file says \"{}\".", stated.comment)),
        None => Some(format!("{letter} is up, as you chose last.")),
    };
    (up, said)
}

impl App {
    /// Reads the model of an object again, with another axis of its file pointing up.
    pub(crate) fn turn_up(&mut self, ctx: &Context, id: ObjectId, up: UpAxis) {
        let Some(object) = self.state.scene.objects.get(id) else { return };
        let Some(path) = object.model.source.clone().filter(|path| !is_example(path)) else {
            return self.refuse(format!("{} was not loaded from a file", object.name));
        };
        self.state.up = up;
        let options = LoadOptions { up, ..object.model.options };
        let label = format!("Turning {}", file_name(&path));
        self.begin_loading(ctx, label, false, move |progress| {
            Fetched::Turned(id, io::load(&path, &options, progress).map(Box::new))
        });
    }

    /// Replaces a turned model in one step of undo. If it is the only object, the camera frames it
    /// again.
    pub(crate) fn take_turned(&mut self, id: ObjectId, read: Result<Box<Loaded>, LoadError>) {
        match read {
            Ok(loaded) => {
                let up = loaded.model.options.up.word().to_uppercase();
                match self.turned(id, *loaded) {
                    Ok((command, name)) => {
                        let label = format!("Turn {name} {up} up");
                        self.change(command, Gesture::Whole, &label);
                        self.state.tell(Some(format!("{name}: {up} is up")));
                    }
                    Err(refusal) => self.refuse(refusal.to_string()),
                }
            }
            Err(error) => self.tell_load_error(&error),
        }
    }

    fn turned(&self, id: ObjectId, loaded: Loaded) -> Result<(Command, String), Refusal> {
        let State { scene, view, .. } = &self.state;
        let name = scene.objects.get(id).ok_or(Refusal::Gone)?.name.clone();
        let model = Shared::new(loaded.model);
        let parts = u32::try_from(model.mesh.parts().len()).unwrap_or(u32::MAX);
        let command = items::change_object(scene, id, |object| {
            object.model = model;
            object.hidden_parts.retain(|part| *part < parts);
        })?;
        // Framing belongs to the same step of undo, since turning may move the model out of view.
        let mut commands = vec![command.clone()];
        let mut after = scene.clone();
        command.apply(&mut after)?;
        if scene.objects.len() == 1
            && let Ok(framed) = framing::all(&after, view)
        {
            commands.push(framed);
        }
        Ok((Command::Batch(commands), name))
    }
}
