//! Reads a model or a scene from standard input or another unnamed source.

use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{LoadError, shown};
use super::load::parse;
use super::loaded::Loaded;
use super::packed::{MAGIC, Unpacked};
use super::progress::Progress;
use super::read::{MOST_MODEL_BYTES, open as open_file};
use super::scene_file::{Opened, SceneFileError, open_text};
use super::stl::{crease_of, has_stl_content};
use super::up_axis::{stated_in, stated_or_usual};
use marraztu_core::scene::{Crease, LoadOptions, UpAxis};

/// The name of the input in messages and in the outline.
const NAME: &str = "standard input";

/// The possible first bytes of scene files; no OBJ file begins with them.
const SCENE: [&[u8]; 4] = [b"(", b"//", b"/*", b"#!["];

/// The bytes of a model or a scene. Files that it names are searched for in the current folder, or
/// in the folder of the file that it was read from.
#[derive(Debug)]
pub struct Input {
    bytes: Vec<u8>,
    /// The name in messages.
    name: String,
    folder: PathBuf,
}

impl Input {
    /// Reads the whole input, and unpacks it if it is compressed.
    ///
    /// # Errors
    /// If it cannot be read, or is too large.
    pub fn read(source: impl Read) -> Result<Self, LoadError> {
        let mut source = source;
        let mut bytes = Vec::new();
        let magic = u64::try_from(MAGIC.len()).unwrap_or(u64::MAX);
        let system = |error: std::io::Error| LoadError::system(NAME, &error);
        source.by_ref().take(magic).read_to_end(&mut bytes).map_err(system)?;
        // A pipe cannot be rewound, so the first bytes are chained in front of the rest.
        let packed = bytes == MAGIC;
        let all = std::io::Cursor::new(std::mem::take(&mut bytes)).chain(source);
        let limit = u64::try_from(MOST_MODEL_BYTES).unwrap_or(u64::MAX).saturating_add(1);
        let read = match packed {
            true => Unpacked::new(all).take(limit).read_to_end(&mut bytes),
            false => all.take(limit).read_to_end(&mut bytes),
        };
        read.map_err(system)?;
        // The limit is one byte higher, so reaching it shows that the input is too large.
        if bytes.len() > MOST_MODEL_BYTES {
            return Err(LoadError::too_large(NAME, MOST_MODEL_BYTES));
        }
        Ok(Self { bytes, name: NAME.to_owned(), folder: PathBuf::new() })
    }

    /// Reads a file whatever its name: its content tells whether it is a model or a scene, and
    /// whether it is compressed.
    ///
    /// # Errors
    /// If it cannot be read, or is too large.
    pub fn of_file(path: &Path) -> Result<Self, LoadError> {
        let (file, _) = open_file(path, MOST_MODEL_BYTES)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(Self { name: shown(path), folder, ..Self::read(file)? })
    }

    /// Returns whether the input is a scene, judged by its first bytes.
    pub fn is_scene(&self) -> bool {
        let text = self.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&self.bytes);
        let text = text.trim_ascii_start();
        SCENE.iter().any(|begin| text.starts_with(begin))
    }

    /// Returns the up axis to read the model with: the axis that it states, z for STL, or y.
    pub fn usual_up(&self) -> UpAxis {
        let is_stl = || has_stl_content(&self.bytes, self.bytes.len());
        stated_or_usual(stated_in(&self.bytes), is_stl)
    }

    /// Returns the crease angle to read the model with: flat for STL, or the default.
    pub fn usual_crease(&self) -> Crease {
        crease_of(has_stl_content(&self.bytes, self.bytes.len()))
    }

    /// Parses the input as a model.
    ///
    /// # Errors
    /// As [`load`](super::load()).
    pub fn model(&self, options: &LoadOptions, progress: &Progress) -> Result<Loaded, LoadError> {
        parse(&self.bytes, &self.name, Some(&self.folder), options, progress)
    }

    /// Parses the input as a scene.
    ///
    /// # Errors
    /// As [`open`](super::open).
    pub fn scene(&self, progress: &Progress) -> Result<Opened, SceneFileError> {
        let text = std::str::from_utf8(&self.bytes).map_err(|_bytes| SceneFileError::File {
            file: self.name.clone(),
            reason: "this is not a scene file".to_owned(),
        })?;
        let here = std::env::current_dir().unwrap_or_else(|_gone| PathBuf::new());
        open_text(text, &self.name, here.join(&self.folder), progress)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_from_models_by_how_they_begin() {
        let is_scene = |text: &str| Input::read(text.as_bytes()).unwrap().is_scene();
        for scene in ["(version: 1)", "\u{feff}\n  (", "// mine\n(version: 1)", "#![enable(x)]\n("]
        {
            assert!(is_scene(scene), "{scene}");
        }
        for model in ["v 1 2 3", "# a model\nv 1 2 3", "", "o (cube)"] {
            assert!(!is_scene(model), "{model}");
        }
    }
}
