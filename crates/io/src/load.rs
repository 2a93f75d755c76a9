//! Loads a model from an OBJ or an STL file.

use std::path::Path;

use super::error::{LoadError, shown};
use super::loaded::Loaded;
use super::obj;
use super::packed::unpacked;
use super::progress::Progress;
use super::stl::{self, is_stl};
use super::texture::Pictures;
use marraztu_core::scene::{LoadOptions, Model};

/// Loads an OBJ file with its MTL files and textures, or an STL file. A file with the extension
/// `.gz` is unpacked.
///
/// # Errors
/// If the file cannot be read, is not such a file, has an unreadable number, or has only unusable
/// faces; and if `progress` is cancelled.
pub fn load(path: &Path, options: &LoadOptions, progress: &Progress) -> Result<Loaded, LoadError> {
    load_with(path, options, &mut Pictures::default(), progress)
}

/// Works like [`load`], but reuses pictures that are already in `pictures`.
pub(super) fn load_with(
    path: &Path,
    options: &LoadOptions,
    pictures: &mut Pictures,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    // An absolute path stays valid when the current folder changes.
    let source = Some(std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned()));
    let Loaded { model, findings } = if is_stl(path) {
        let file = shown(path);
        let bytes = unpacked(path, &file, &progress.part(0.0, 0.2))?;
        stl::parse(&bytes, &file, options, &progress.part(0.2, 1.0))?
    } else {
        obj::load(path, options, pictures, progress)?
    };
    Ok(Loaded { model: Model { source, ..model }, findings })
}

/// Parses the text of an OBJ file, or an STL file. MTL files are searched for in `folder`, if
/// given.
///
/// # Errors
/// The same as [`load`].
pub fn parse(
    bytes: &[u8],
    file: &str,
    folder: Option<&Path>,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Loaded, LoadError> {
    match stl::has_stl_content(bytes, bytes.len()) {
        true => stl::parse(bytes, file, options, progress),
        false => obj::parse(bytes, file, folder, options, progress),
    }
}
