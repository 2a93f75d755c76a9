//! Scenes as text for other processes. Models and textures are named by their files, and read
//! there.

use std::collections::BTreeMap;

use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Object, ObjectId, Scene, View};
use marraztu_io as io;

use crate::errors::Failure;

/// A scene as text, and the ids of objects in layers.
pub(crate) type SceneText = (String, Vec<(u32, i32)>);

/// The parts of a scene that another process needs.
pub(crate) type Parts = (Scene, View, Settings, BTreeMap<ObjectId, i32>);

/// Checks that all models come from files. The names of arrays may be those of our own models.
pub(crate) fn check_files(scene: &Scene) -> Result<(), String> {
    let is_of_arrays = |object: &&Object| {
        let model = &object.model;
        let own = || io::own_model(&model.name);
        model.source.is_none() && own().is_some_and(|own| own.mesh != model.mesh)
    };
    match scene.objects.iter().find(|(_, object)| is_of_arrays(object)) {
        Some((_, object)) => {
            Err(format!("the model {:?} was not loaded from a file", object.model.name))
        }
        None => Ok(()),
    }
}

/// Writes a scene for [`read`].
pub(crate) fn write(
    (scene, view, settings): (&Scene, &View, &Settings),
    ids: &BTreeMap<ObjectId, i32>,
) -> Result<SceneText, Failure> {
    check_files(scene).map_err(Failure::Value)?;
    let text = io::scene_to_message((scene, view, settings), None).map_err(Failure::Value)?;
    Ok((text, ids.iter().map(|(object, id)| (object.0, *id)).collect()))
}

/// Reads a scene of [`write`].
pub(crate) fn read((text, ids): SceneText) -> Result<Parts, Failure> {
    let (scene, view, settings) = io::scene_of_message(&text, None, &io::Known::default())?;
    let ids = ids.into_iter().map(|(object, id)| (ObjectId(object), id)).collect();
    Ok((scene, view, settings, ids))
}
