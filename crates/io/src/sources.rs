//! The files that a scene was read from.
//!
//! A picture, a turntable or an export may write several files (materials, textures, frames), and
//! any of them could overwrite a file that the scene needs. Every writer therefore checks all
//! targets here before it writes the first byte.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::replace::SaveError;
use marraztu_core::scene::{Model, Scene};

/// The files that a scene was read from: models with their MTL files and textures, and the scene
/// file itself. No output of the scene may overwrite one of them.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// The canonical paths, with the paths as given.
    places: BTreeMap<PathBuf, PathBuf>,
}

impl Sources {
    /// Collects the files of all objects, panoramas, and of the models that show cameras.
    pub fn of(scene: &Scene) -> Self {
        let mut sources = Self::default();
        for (_, object) in scene.objects.iter() {
            sources.add_all(files(&object.model));
            sources.add_all(object.texture.iter().map(|texture| &texture.source));
        }
        for (_, light) in scene.lights.iter() {
            sources.add_all(light.kind.panorama().map(|sky| &sky.panorama.source));
        }
        for (_, camera) in scene.cameras.iter() {
            sources.add_all(files(&camera.model));
        }
        sources
    }

    /// Adds further files, such as the scene file.
    #[must_use]
    pub fn with<P: AsRef<Path>>(mut self, files: impl IntoIterator<Item = P>) -> Self {
        self.add_all(files);
        self
    }

    /// Returns the files, each once, in the order of their places.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.places.keys().map(PathBuf::as_path)
    }

    fn add_all<P: AsRef<Path>>(&mut self, files: impl IntoIterator<Item = P>) {
        for file in files {
            let file = file.as_ref();
            // A file that does not exist cannot be overwritten.
            if let Ok(place) = file.canonicalize() {
                self.places.entry(place).or_insert_with(|| file.to_owned());
            }
        }
    }

    /// Checks that writing to `target` would not overwrite one of the files, even through another
    /// path or a link.
    ///
    /// # Errors
    /// If it would.
    pub fn spare(&self, target: &Path) -> Result<(), SaveError> {
        let place = target.canonicalize().ok();
        match place.and_then(|place| self.places.get(&place)) {
            None => Ok(()),
            Some(file) if file == target => {
                Err(SaveError::new(target, "this file is an input; choose another name"))
            }
            Some(file) => {
                let reason =
                    format!("this file is an input ({}); choose another name", file.display());
                Err(SaveError::new(target, reason))
            }
        }
    }
}

/// Returns the files that a model was read from.
fn files(model: &Model) -> impl Iterator<Item = &PathBuf> {
    model.source.iter().chain(&model.companions)
}
