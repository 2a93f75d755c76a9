//! Writes the text of a scene file.
//!
//! Reading builds whole items (`open`), so the compiler reports new fields that are missing in the
//! file.

use std::path::Path;

use super::fields::Numbers;
use super::format::{
    FileCamera, FileLocked, FileMode, FileModel, FileObject, FileScene, FileTexture, VERSION,
};
use super::light::file_light;
use super::paths::relative;
use super::view::FileView;
use crate::assets::{own_model, own_texture};
use crate::examples::is_example;
use crate::window_state::WindowState;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{
    Camera, CameraMode, LoadOptions, Model, Object, Pose, Scene, Shape, Texture, View,
};

/// Converts a scene with its view and settings to the types of the file. `folder` is the file's
/// folder, absolute. Fails with the reason if a model has no file, or a path or a number cannot be
/// written.
pub(super) fn file_scene(
    scene: &Scene,
    view: &View,
    window: &WindowState,
    settings: &Settings,
    folder: &Path,
) -> Result<FileScene, String> {
    let objects = scene.objects.iter().map(|(id, item)| file_object(id.0, item, folder));
    let cameras = scene.cameras.iter().map(|(id, item)| file_camera(id.0, item, folder));
    let lights = scene.lights.iter().map(|(id, item)| file_light(id.0, item, folder));
    Ok(FileScene {
        version: VERSION,
        background: scene.background.0,
        next_id: scene.next_id,
        objects: objects.collect::<Result<_, _>>()?,
        cameras: cameras.collect::<Result<_, _>>()?,
        lights: lights.collect::<Result<_, _>>()?,
        locked: FileLocked::of(scene),
        view: FileView::of(view, window),
        settings: *settings,
    })
}

pub(super) fn file_model(model: &Model, folder: &Path) -> Result<FileModel, String> {
    let Model { name, source, options, .. } = model;
    let Some(source) = source else {
        let size = options.scale.get();
        if let Some(shape) = Shape::of(model).filter(|_| size != 1.0) {
            return Ok(FileModel::Shape { name: shape.name().to_owned(), size });
        }
        return if own_model(name).is_some() {
            Ok(FileModel::Own(name.clone()))
        } else {
            Err(format!("the model \"{name}\" was not loaded from a file"))
        };
    };
    let LoadOptions { up, scale, winding, crease, bumps } = *options;
    let path = file_path(source, folder)?;
    let (scale, crease) = (scale.get(), crease.get());
    Ok(FileModel::File { path, up, scale, winding, crease, bumps })
}

pub(super) fn file_path(path: &Path, folder: &Path) -> Result<String, String> {
    if let Some(example) = path.to_str().filter(|_| is_example(path)) {
        return Ok(example.to_owned());
    }
    let complete = std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned());
    relative(folder, &complete)
        .ok_or_else(|| format!("the file name {} is not valid Unicode", path.display()))
}

pub(super) fn file_object(id: u32, object: &Object, folder: &Path) -> Result<FileObject, String> {
    let texture = object.texture.as_ref();
    let texture = texture.map(|texture| file_texture(texture, folder)).transpose()?;
    Ok(FileObject {
        id,
        name: object.name.clone(),
        visible: object.visible,
        model: file_model(&object.model, folder)?,
        hidden_parts: Numbers::of(&object.hidden_parts),
        placement: object.placement.now().to_cols_array_2d(),
        spin: object.spin,
        material: object.material.clone(),
        surface: object.surface,
        texture,
        tint: object.tint.0,
        opacity: object.opacity,
        sides: Some(object.sides),
        two_sided: None,
        file_normals: object.file_normals,
        edge_color: object.edge_color.0,
    })
}

pub(super) fn file_texture(texture: &Texture, folder: &Path) -> Result<FileTexture, String> {
    let Texture { source, picture: _, wrap, offset, scale } = texture;
    let own = source.to_str().filter(|path| own_texture(path).is_some());
    let path = own.map_or_else(|| file_path(source, folder), |own| Ok(own.to_owned()))?;
    Ok(FileTexture { path, wrap: *wrap, offset: *offset, scale: *scale })
}

pub(super) fn file_camera(id: u32, camera: &Camera, folder: &Path) -> Result<FileCamera, String> {
    let Pose { eye, axes, mode } = *camera.pose.now();
    Ok(FileCamera {
        id,
        name: camera.name.clone(),
        visible: camera.visible,
        model: file_model(&camera.model, folder)?,
        material: camera.material.clone(),
        eye: eye.to_array(),
        axes: axes.to_cols_array_2d(),
        mode: match mode {
            CameraMode::Fly => FileMode::Fly,
            CameraMode::Analysis { target } => FileMode::Analysis(target.0),
        },
        lens: camera.lens,
    })
}
