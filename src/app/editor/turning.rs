//! The up axis of a model's file: the axis that the file states or that is usual for its format, or
//! else the preferred one. An opened model is turned by reading it again, which changes no other
//! model.

use std::path::{Path, PathBuf};

use egui::Context;

use super::App;
use crate::app::documents::loading::{Fetched, Turned};
use crate::app::state::State;
use crate::app::widgets::text::{file_name, one_or_count};
use marraztu_core::base::Shared;
use marraztu_core::edit::{Change, Gesture, framing, items};
use marraztu_core::scene::{Command, LoadOptions, Model, ObjectId, UpAxis};
use marraztu_io::{self as io, is_example};

/// Returns the up axis for opening a model, and a sentence if it is not Y. It is the axis that the
/// file states or that is usual for its format, or else the preferred one.
pub(super) fn usual_up(path: &Path, preferred: UpAxis) -> (UpAxis, Option<String>) {
    if is_example(path) {
        return (UpAxis::Y, None);
    }
    let stated = io::stated_up(path);
    let (up, why) = match (stated, io::usual_up(path)) {
        (Some(stated), _) => (stated.up, format!(": its file says \"{}\"", stated.comment)),
        (None, UpAxis::Y) => (preferred, ", as you prefer".to_owned()),
        (None, usual) => (usual, ", as usual in STL files".to_owned()),
    };
    let letter = up.word().to_uppercase();
    (up, (up != UpAxis::Y).then(|| format!("{letter} is up{why}.")))
}

impl App {
    /// Reads the models of objects again, with another axis of their files pointing up.
    pub(crate) fn turn_up(&mut self, ctx: &Context, ids: &[ObjectId], up: UpAxis) {
        let scene = &self.state.scene;
        let objects = || ids.iter().filter_map(|id| Some((*id, scene.objects.get(*id)?)));
        let Some((_, first)) = objects().next() else { return };
        // Objects of one file are turned together, so it is read once.
        let mut files: Vec<(PathBuf, LoadOptions, Vec<ObjectId>)> = Vec::new();
        for (id, object) in objects() {
            let Model { source, options, .. } = &*object.model;
            let Some(path) = source.clone().filter(|path| !is_example(path)) else { continue };
            let options = LoadOptions { up, ..*options };
            match files.iter_mut().find(|file| file.0 == path && file.1 == options) {
                Some((.., ids)) => ids.push(id),
                None => files.push((path, options, vec![id])),
            }
        }
        if files.is_empty() {
            return self.refuse(format!("{} was not loaded from a file", first.name));
        }
        let what = one_or_count(&files, "models", |(path, ..)| file_name(path));
        self.begin_loading(ctx, format!("Turning {what}"), false, move |progress| {
            let read = |(path, options, ids): (PathBuf, LoadOptions, Vec<ObjectId>)| {
                let result = io::load(&path, &options, progress);
                Turned { ids, result: result.map(|loaded| Shared::new(loaded.model)) }
            };
            Fetched::Turned(files.into_iter().map(read).collect(), up)
        });
    }

    /// Replaces turned models in one step of undo. If the scene has no other objects, the camera
    /// frames them again.
    pub(crate) fn take_turned(&mut self, read: Vec<Turned>, up: UpAxis) {
        let mut turned = Vec::new();
        for Turned { ids, result } in read {
            match result {
                Ok(model) => turned.extend(ids.into_iter().map(|id| (id, model.clone()))),
                Err(error) => self.tell_load_error(&error),
            }
        }
        turned.retain(|(id, _)| self.state.scene.objects.contains(*id));
        if turned.is_empty() {
            return;
        }
        let up = up.word().to_uppercase();
        let name = |(id, _): &(ObjectId, _)| {
            self.state.scene.objects.get(*id).map_or_else(String::new, |it| it.name.clone())
        };
        let what = one_or_count(&turned, "objects", name);
        match self.turned(turned) {
            Ok(command) => {
                self.change(command, Gesture::Whole, &format!("Turn {what} {up} up"));
                self.state.tell(Some(format!("{what}: {up} is up")));
            }
            Err(refusal) => self.refuse(refusal.to_string()),
        }
    }

    fn turned(&self, models: Vec<(ObjectId, Shared<Model>)>) -> Change {
        let State { scene, view, .. } = &self.state;
        let are_all = models.len() == scene.objects.len();
        let (mut commands, mut after) = (Vec::new(), scene.clone());
        for (id, model) in models {
            let parts = u32::try_from(model.mesh.parts().len()).unwrap_or(u32::MAX);
            let command = items::change_object(scene, id, |object| {
                object.model = model;
                object.hidden_parts.retain(|part| *part < parts);
            })?;
            command.clone().apply(&mut after)?;
            commands.push(command);
        }
        // Framing belongs to the same step of undo, since turning may move the models out of view.
        if are_all && let Ok(framed) = framing::all(&after, view) {
            commands.push(framed);
        }
        Ok(Command::Batch(commands))
    }
}
