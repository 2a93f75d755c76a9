//! Exports a scene for other programs: as OBJ with MTL, or as glTF.
//!
//! Everything visible is exported: objects that are hidden, and hidden parts, are left out. What a
//! format cannot say is told in notes.

mod gltf;
mod gltf_buffer;
mod gltf_lights;
mod gltf_surface;
mod look;
mod obj;

use std::path::{Path, PathBuf};

use super::replace::{SaveError, Worth, check_target, replace};
use crate::scene::{Scene, View};

/// The endings of the formats, without the dot.
pub const EXPORT_ENDINGS: [&str; 3] = ["obj", "gltf", "glb"];

/// What was exported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Exported {
    /// The files that were written.
    pub files: Vec<PathBuf>,
    /// What the format does not say as the scene does, a sentence each.
    pub notes: Vec<String>,
}

/// The files of an export, in memory: their names and their bytes, the main one last.
#[derive(Debug, Default)]
struct Content {
    files: Vec<(String, Vec<u8>)>,
    notes: Vec<String>,
}

/// A format.
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

/// Checks whether a scene could be exported to `path`.
///
/// # Errors
/// If it could not.
pub fn check_export_target(path: &Path) -> Result<(), SaveError> {
    Format::of(path)?;
    check_target(path)
}

/// Exports the scene in the format of the name's ending, at the time of the view. Further files
/// (materials, textures, the buffer of .gltf) stand beside it, and their names begin as its does.
///
/// # Errors
/// If a file cannot be written; the main one is written last.
pub fn export(path: &Path, scene: &Scene, view: &View) -> Result<Exported, SaveError> {
    let format = Format::of(path)?;
    check_target(path)?;
    let stem = path.file_stem().map(|it| it.to_string_lossy().into_owned()).unwrap_or_default();
    let content = match format {
        Format::Obj => obj::written(&stem, scene, view),
        Format::Gltf => gltf::written(&stem, scene, view, gltf::Form::Separate),
        Format::Glb => gltf::written(&stem, scene, view, gltf::Form::Binary),
    };
    let Content { files, notes } = content.map_err(|reason| SaveError::new(path, reason))?;
    let mut exported = Exported { files: Vec::new(), notes };
    let last = files.len().saturating_sub(1);
    for (i, (name, bytes)) in files.into_iter().enumerate() {
        let file = if i == last { path.to_owned() } else { path.with_file_name(name) };
        replace(&file, &bytes, Worth::Product)?;
        exported.files.push(file);
    }
    Ok(exported)
}
