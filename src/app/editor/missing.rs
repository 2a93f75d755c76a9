//! Finds the missing files of a scene.
//!
//! The scene is already open, with a placeholder for each missing file. When the user has found
//! one, it replaces its placeholder in one step of undo. Other missing files in the same folder are
//! then offered.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use egui::Context;

use super::App;
use crate::app::actions::MissingRequest;
use crate::app::documents::dialogs::Dialog;
use crate::app::documents::loading::{Fetched, Found};
use crate::app::documents::wanted::Wanted;
use crate::app::state::{MissingFiles, Notice, NoticeKind};
use crate::app::widgets::text::{counted, file_name, one_or_count};
use marraztu_core::base::Shared;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{
    Camera, Command, Item, LightKind, Model, Object, Panorama, Scene, Texture,
};
use marraztu_io::{self as io, LoadError};

impl App {
    /// Answers a request about missing files.
    pub(crate) fn answer_missing(&mut self, ctx: &Context, request: MissingRequest) {
        match request {
            MissingRequest::Find(file) => self.find_missing(ctx, file),
            MissingRequest::Dismiss => self.state.missing.dismissed = true,
            MissingRequest::UseNearby => {
                let pairs = std::mem::take(&mut self.state.missing.nearby);
                self.read_found(ctx, pairs);
            }
            MissingRequest::DismissNearby => self.state.missing.nearby.clear(),
        }
    }

    /// Asks for the location of a missing file. If none is named and several are missing, lists
    /// them first.
    pub(crate) fn find_missing(&mut self, ctx: &Context, file: Option<PathBuf>) {
        let missing = self.state.scene.missing_files();
        let only = missing.first().filter(|_| missing.len() == 1);
        match file.or_else(|| only.map(|only| only.to_path_buf())) {
            Some(file) => {
                let near = self.state.path.as_deref().and_then(Path::parent);
                let folder = [file.parent(), near].into_iter().flatten().find(|it| it.is_dir());
                self.dialogs.folders.open_in(folder.map(Path::to_owned));
                let name = file_name(&file);
                self.ask_file(ctx, Wanted::Missing(file), &name);
            }
            None => {
                let all = missing.into_iter().map(Path::to_owned).collect();
                self.dialogs.show(Dialog::Missing(all));
            }
        }
    }

    /// Reads a missing file that the user has found at `new`.
    pub(crate) fn found_missing(&mut self, ctx: &Context, old: PathBuf, new: PathBuf) {
        self.read_found(ctx, vec![[old, new]]);
    }

    fn read_found(&mut self, ctx: &Context, pairs: Vec<[PathBuf; 2]>) {
        if pairs.is_empty() {
            return;
        }
        let what = one_or_count(&pairs, "files", |[_, new]| file_name(new));
        let label = format!("Loading {what}");
        // The thread gets only the placeholders to replace, not the scene.
        let work: Vec<_> = pairs
            .into_iter()
            .map(|[old, new]| {
                let models = models_of(&self.state.scene, &old);
                let is_texture = textures_of(&self.state.scene, &old);
                let is_panorama = panoramas_of(&self.state.scene, &old);
                (old, new, models, [is_texture, is_panorama])
            })
            .collect();
        self.begin_loading(ctx, label, false, move |progress| {
            let read = |(old, new, models, is): (PathBuf, PathBuf, Vec<_>, [bool; 2])| {
                let [is_texture, is_panorama] = is;
                let load = |before: Shared<Model>| {
                    let loaded = io::load(&new, &before.options, progress);
                    (before, loaded)
                };
                let models = models.into_iter().map(load).collect();
                let mut findings = Vec::new();
                let texture = is_texture.then(|| io::load_texture_with(&new, &mut findings));
                let panorama = is_panorama.then(|| io::load_panorama(&new).map(Shared::new));
                Found { old, new, models, texture, panorama, findings }
            };
            Fetched::Found(work.into_iter().map(read).collect())
        });
    }

    /// Replaces placeholders by the files found, in one step of undo.
    pub(crate) fn take_found(&mut self, all: Vec<Found>) {
        let mut content = Replacements::default();
        let (mut pairs, mut details) = (Vec::new(), Vec::new());
        for Found { old, new, models, texture, panorama, findings } in all {
            details.extend(findings.iter().map(ToString::to_string));
            let mut add = |result: Result<(), LoadError>| match result {
                Ok(()) => true,
                Err(error) => {
                    self.tell_load_error(&error);
                    false
                }
            };
            let mut read = true;
            for (before, loaded) in models {
                read &= add(loaded.map(|loaded| {
                    details.extend(loaded.findings.iter().map(ToString::to_string));
                    content.models.push((before, Shared::new(loaded.model)));
                }));
            }
            if let Some(texture) = texture {
                read &= add(texture.map(|it| content.textures.push((old.clone(), it))));
            }
            if let Some(panorama) = panorama {
                read &= add(panorama.map(|it| content.panoramas.push((old.clone(), it))));
            }
            if read {
                pairs.push([old, new]);
            }
        }
        // All replacements are one step of undo.
        let scene = &self.state.scene;
        let of_items = content.of_objects(scene).chain(content.of_cameras(scene));
        let commands: Vec<_> = of_items.chain(content.of_lights(scene)).collect();
        if commands.is_empty() {
            return;
        }
        let what = one_or_count(&pairs, "files", |[_, new]| file_name(new));
        let label = format!("Find {what}");
        self.change(Command::Batch(commands), Gesture::Whole, &label);
        if !details.is_empty() {
            let findings = counted(details.len(), "finding", "findings");
            let text = format!("{label}: {findings}");
            self.state.notices.push(Notice::new(NoticeKind::Opened, text).with(details));
        }
        // Files that are still missing may lie near the found ones.
        let nearby = nearby(&self.state.scene.missing_files(), &pairs);
        self.state.missing = MissingFiles { dismissed: false, nearby };
    }
}

/// Replacements of models and placeholders.
#[derive(Default)]
pub(super) struct Replacements {
    /// The models, each with its replacement.
    pub(super) models: Vec<(Shared<Model>, Shared<Model>)>,
    /// The paths of missing textures, and the textures found.
    textures: Vec<(PathBuf, Shared<Texture>)>,
    /// The same of panoramas.
    panoramas: Vec<(PathBuf, Shared<Panorama>)>,
}

impl Replacements {
    /// Creates the commands that replace the models and the textures of objects.
    pub(super) fn of_objects(&self, scene: &Scene) -> impl Iterator<Item = Command> {
        scene.objects.iter().filter_map(|(id, object)| {
            let object = self.object(object)?;
            Some(Command::Replace(Item::Object(id, Box::new(object))))
        })
    }

    /// Creates the commands that replace the models of cameras.
    fn of_cameras(&self, scene: &Scene) -> impl Iterator<Item = Command> {
        scene.cameras.iter().filter_map(|(id, camera)| {
            let model = self.model(&camera.model)?;
            let camera = Camera { model, ..camera.clone() };
            Some(Command::Replace(Item::Camera(id, Box::new(camera))))
        })
    }

    /// Creates the commands that replace the panoramas of skies.
    fn of_lights(&self, scene: &Scene) -> impl Iterator<Item = Command> {
        scene.lights.iter().filter_map(|(id, light)| {
            let missing = light.missing_file()?;
            let (_, found) = self.panoramas.iter().find(|(old, _)| old == missing)?;
            let mut light = light.clone();
            if let LightKind::Sky { panorama: Some(own), .. } = &mut light.kind {
                own.panorama = found.clone();
            }
            Some(Command::Replace(Item::Light(id, Box::new(light))))
        })
    }

    /// Returns an object with the files found; `None` if the object needs none of these files.
    fn object(&self, object: &Object) -> Option<Object> {
        let model = self.model(&object.model);
        let texture = object.texture.as_ref().and_then(|texture| self.texture(texture));
        if model.is_none() && texture.is_none() {
            return None;
        }
        let mut object = object.clone();
        if let Some(model) = model {
            // The new model may have fewer parts than the object has hidden.
            let parts = u32::try_from(model.mesh.parts().len()).unwrap_or(u32::MAX);
            object.hidden_parts.retain(|part| *part < parts);
            object.model = model;
        }
        object.texture = texture.or(object.texture);
        Some(object)
    }

    fn model(&self, before: &Shared<Model>) -> Option<Shared<Model>> {
        let found = self.models.iter().find(|(old, _)| Shared::same(old, before));
        found.map(|(_, model)| model.clone())
    }

    /// Returns the replacement of a placeholder texture, with its mapping.
    fn texture(&self, before: &Texture) -> Option<Shared<Texture>> {
        let is_it = |(old, _): &&(PathBuf, _)| before.is_placeholder() && before.source == *old;
        let (_, found) = self.textures.iter().find(is_it)?;
        let Texture { wrap, offset, scale, .. } = *before;
        Some(Shared::new(Texture { wrap, offset, scale, ..Texture::clone(found) }))
    }
}

/// Lists the placeholder models of a file, each once.
fn models_of(scene: &Scene, file: &Path) -> Vec<Shared<Model>> {
    let of_objects = scene.objects.iter().map(|(_, object)| &object.model);
    let of_cameras = scene.cameras.iter().map(|(_, camera)| &camera.model);
    let mut models: Vec<Shared<Model>> = Vec::new();
    for model in of_objects.chain(of_cameras) {
        let is_it = model.is_placeholder() && model.source.as_deref() == Some(file);
        if is_it && !models.iter().any(|known| Shared::same(known, model)) {
            models.push(model.clone());
        }
    }
    models
}

/// Returns whether an object has a placeholder of this texture.
fn textures_of(scene: &Scene, file: &Path) -> bool {
    let mut textures = scene.objects.iter().filter_map(|(_, object)| object.texture.as_ref());
    textures.any(|texture| texture.is_placeholder() && texture.source == file)
}

/// Returns whether a sky has a placeholder of this panorama.
fn panoramas_of(scene: &Scene, file: &Path) -> bool {
    scene.lights.iter().any(|(_, light)| light.missing_file() == Some(file))
}

/// Pairs the old paths of missing files with new ones: in the folder of a found file, or at the
/// same relative path in a folder that was moved as a whole.
fn nearby(missing: &BTreeSet<&Path>, found: &[[PathBuf; 2]]) -> Vec<[PathBuf; 2]> {
    let place = |file: &Path| {
        found.iter().find_map(|[old, new]| {
            let near = new.parent()?.join(file.file_name()?);
            [Some(near), moved(file, old, new)].into_iter().flatten().find(|path| path.is_file())
        })
    };
    missing.iter().filter_map(|file| Some([file.to_path_buf(), place(file)?])).collect()
}

/// Returns the new path of a file, assuming that a common parent folder of it and `old` was moved,
/// which made `old` into `new`.
fn moved(file: &Path, old: &Path, new: &Path) -> Option<PathBuf> {
    let (mut from, mut to) = (old, new);
    while from.file_name().is_some() && from.file_name() == to.file_name() {
        (from, to) = (from.parent()?, to.parent()?);
    }
    file.strip_prefix(from).ok().map(|rest| to.join(rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_a_folder_that_was_moved_is_looked_for_at_the_same_place() {
        let [file, old, new] = ["/a/b/tex/t.png", "/a/b/models/x.obj", "/c/d/models/x.obj"];
        let to = moved(Path::new(file), Path::new(old), Path::new(new));
        assert_eq!(to.as_deref(), Some(Path::new("/c/d/tex/t.png")));
        let to = moved(Path::new("/z/t.png"), Path::new(old), Path::new(new));
        assert_eq!(to, None);
    }
}
