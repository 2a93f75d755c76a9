//! Lists the missing files of a scene.

use std::collections::BTreeSet;
use std::path::Path;

use super::{Camera, Light, Model, Object, Scene};

impl Object {
    /// Returns the missing files of the object's model and texture.
    pub fn missing_files(&self) -> impl Iterator<Item = &Path> {
        let texture = self.texture.as_deref().filter(|texture| texture.is_placeholder());
        missing(&self.model).into_iter().chain(texture.map(|texture| &*texture.source))
    }
}

impl Camera {
    /// Returns the file of the camera's model, if it is missing.
    pub fn missing_file(&self) -> Option<&Path> {
        missing(&self.model)
    }
}

impl Light {
    /// Returns the file of the light's panorama, if it is missing.
    pub fn missing_file(&self) -> Option<&Path> {
        let panorama = &self.kind.panorama()?.panorama;
        panorama.is_placeholder().then_some(&panorama.source)
    }
}

impl Scene {
    /// Returns the missing files of all models, textures and panoramas.
    pub fn missing_files(&self) -> BTreeSet<&Path> {
        let of_objects = self.objects.iter().flat_map(|(_, object)| object.missing_files());
        let of_cameras = self.cameras.iter().filter_map(|(_, camera)| camera.missing_file());
        let of_lights = self.lights.iter().filter_map(|(_, light)| light.missing_file());
        of_objects.chain(of_cameras).chain(of_lights).collect()
    }
}

fn missing(model: &Model) -> Option<&Path> {
    model.source.as_deref().filter(|_| model.is_placeholder())
}
