//! Exports a scene for other programs: as OBJ with MTL, or as glTF.
//!
//! Only visible objects and parts are exported. Features that a format lacks are listed as notes.

mod companion;
mod file_bytes;
mod gltf;
mod gltf_buffer;
mod gltf_lights;
mod gltf_mesh;
mod gltf_opacity;
mod gltf_roughness;
mod gltf_strokes;
mod gltf_surface;
mod gltf_texture;
mod look;
mod names;
mod obj;
mod part_look;
mod pictures;
mod placeholders;

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use self::companion::check_companion;
use super::replace::{SaveError, Worth, check_target, replace};
use super::sources::Sources;
use marraztu_core::scene::{Object, Scene, View};

/// The extensions of the formats, without the dot.
pub const EXPORT_ENDINGS: [&str; 3] = ["obj", "gltf", "glb"];

/// The parts of a scene that an export holds besides the visible objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ExportOptions {
    /// Whether it holds the cameras, if the format has cameras.
    pub cameras: bool,
    /// Whether it holds the lights that are on, if the format has lights.
    pub lights: bool,
}

impl ExportOptions {
    /// The whole scene.
    pub const SCENE: Self = Self { cameras: true, lights: true };
    /// The objects alone: the programs that read them have their own lights.
    pub const MODELS: Self = Self { cameras: false, lights: false };
}

/// The result of an export.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Exported {
    /// The files that were written.
    pub files: Vec<PathBuf>,
    /// Differences from the scene that the format forces, one sentence each.
    pub notes: Vec<String>,
}

/// The files of an export in memory, with their names; the main file is last.
#[derive(Debug, Default)]
struct Content {
    files: Vec<(String, Vec<u8>)>,
    notes: Vec<String>,
}

/// An export format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Gltf,
    Glb,
}

impl Format {
    fn of(path: &Path) -> Result<Self, SaveError> {
        let ending = path.extension().map(|it| it.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("obj") => Ok(Self::Obj),
            Some("gltf") => Ok(Self::Gltf),
            Some("glb") => Ok(Self::Glb),
            Some(_) | None => {
                Err(SaveError::new(path, "its name has to end in .obj, .gltf or .glb"))
            }
        }
    }
}

/// Checks whether a scene can be exported to `path`.
///
/// # Errors
/// If it cannot.
pub fn check_export_target(path: &Path) -> Result<(), SaveError> {
    Format::of(path)?;
    check_target(path)
}

/// Exports the scene in the format of the path's extension, at the time of the view. Companion
/// files (materials, textures, the buffer of .gltf) are written next to it, under names that begin
/// alike.
///
/// # Errors
/// If a file cannot be written, is one of `sources`, or has the name of a companion file but was
/// not written by an earlier export. Everything is checked before the first file is written, and
/// the main file is written last.
pub fn export(
    path: &Path,
    scene: &Scene,
    view: &View,
    options: ExportOptions,
    sources: &Sources,
) -> Result<Exported, SaveError> {
    let format = Format::of(path)?;
    check_target(path)?;
    sources.spare(path)?;
    let stem = path.file_stem().map(|it| it.to_string_lossy().into_owned()).unwrap_or_default();
    let (scene, left_out) =
        placeholders::without(scene).map_err(|reason| SaveError::new(path, reason))?;
    let scene = &scene;
    let content = match format {
        Format::Obj => obj::written(&stem, scene, view, options),
        Format::Gltf | Format::Glb => gltf::written(&stem, scene, view, (format, options)),
    };
    let Content { files, notes } = content.map_err(|reason| SaveError::new(path, reason))?;
    let notes = left_out.into_iter().chain(hidden(scene)).chain(notes).collect();
    // The main file keeps the user's name; companions are placed next to it.
    let last = files.len().saturating_sub(1);
    let named = |(i, (name, bytes)): (usize, (String, Vec<u8>))| {
        (if i == last { path.to_owned() } else { path.with_file_name(name) }, bytes)
    };
    let files: Vec<(PathBuf, Vec<u8>)> = files.into_iter().enumerate().map(named).collect();
    // Check every companion before the first write: a refused export leaves no files.
    for (companion, bytes) in &files[..last] {
        sources.spare(companion)?;
        check_companion(companion, bytes, path)?;
    }
    let mut exported = Exported { files: Vec::new(), notes };
    for (file, bytes) in files {
        replace(&file, &bytes, Worth::Product)?;
        exported.files.push(file);
    }
    Ok(exported)
}

/// Notes the numbers of hidden objects and of hidden parts of visible ones.
fn hidden(scene: &Scene) -> Vec<String> {
    // Placeholders are noted with their files.
    let objects = scene.objects.iter().map(|(_, object)| object);
    let (visible, hidden): (Vec<&Object>, Vec<&Object>) =
        objects.filter(|it| !it.model.is_placeholder()).partition(|it| it.visible);
    let parts = visible.iter().map(|it| it.model.mesh.parts().len() - it.shown_parts().count());
    let counts = [("objects", hidden.len()), ("parts", parts.sum())];
    let left_out = counts.into_iter().filter(|(_, count)| *count > 0);
    left_out.map(|(what, count)| format!("hidden {what} are left out: {count}")).collect()
}
