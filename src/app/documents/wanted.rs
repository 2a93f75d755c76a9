//! The purposes of file dialogs, and the work that follows after saving the scene.

use std::path::{Path, PathBuf};

use super::browser::Mode;
use super::folders::Kind;
use super::loading::is_scene;
use marraztu_core::scene::ObjectId;
use marraztu_io::{self as io, ExportOptions};

/// The purpose of a file dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Load models.
    Model,
    /// Open models as if they were dropped.
    Dropped,
    /// Open a scene in place of this one.
    Scene,
    /// Save the scene, then continue with this work.
    SceneTo(Option<After>),
    /// Save the picture.
    PictureTo,
    /// Save the picture with options.
    PictureWithOptionsTo,
    /// Save the turntable.
    TurntableTo,
    /// Export the scene, or a part of it.
    ExportTo(ExportOptions),
    /// Choose a texture for these objects.
    Texture(Vec<ObjectId>),
    /// Choose a texture for the model in the material dialog.
    TextureOfModel,
    /// Choose a panorama for the sky.
    Panorama,
    /// Find a missing file of the scene.
    Missing(PathBuf),
}

/// The work that follows after the scene was saved or discarded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum After {
    Quit,
    New,
    /// Open the first scene, as drawn by ancestor A.
    NewAncestor,
    Open(Option<PathBuf>),
    /// Recover the unsaved work at this index.
    Recover(usize),
    /// Recover the discarded work at this index.
    RecoverDiscarded(usize),
}

/// The decision about a scene after another program has changed its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChangedFile {
    /// Save it under another name.
    SaveElsewhere,
    /// Replace the other program's version.
    Overwrite,
    /// Open the other program's version instead.
    Reload,
}

impl Wanted {
    /// Returns the kind of folder that its dialog remembers.
    pub(super) const fn kind(&self) -> Kind {
        match self {
            Self::Model | Self::Dropped | Self::Scene | Self::Missing(_) => Kind::Opened,
            Self::Texture(_) | Self::TextureOfModel | Self::Panorama => Kind::Texture,
            Self::SceneTo(_)
            | Self::PictureTo
            | Self::PictureWithOptionsTo
            | Self::TurntableTo
            | Self::ExportTo(_) => Kind::Saved,
        }
    }

    /// Adds the extension that a path needs.
    pub(super) fn named(&self, path: PathBuf) -> PathBuf {
        if !matches!(self, Self::SceneTo(_)) || is_scene(&path) {
            return path;
        }
        let mut text = path.into_os_string();
        text.push(".");
        text.push(io::SCENE_ENDING);
        PathBuf::from(text)
    }

    /// Returns the title of its dialog, its mode, and the extensions.
    pub(super) fn description(&self) -> (&'static str, Mode, Vec<&'static str>) {
        let models = || vec!["obj", "stl", "gz"];
        let scenes = || vec!["marraztu"];
        let pictures = || io::PICTURE_FORMATS.iter().map(|format| format.endings[0]).collect();
        match self {
            Self::Model => ("Load a model", Mode::Open, models()),
            Self::Dropped => ("Open a model", Mode::Open, models()),
            Self::Scene => ("Open a scene", Mode::Open, scenes()),
            Self::SceneTo(_) => ("Save the scene", Mode::Save, scenes()),
            Self::PictureTo | Self::PictureWithOptionsTo => {
                ("Save the picture", Mode::Save, pictures())
            }
            Self::TurntableTo => ("Save the turntable", Mode::Save, vec!["gif", "png"]),
            Self::ExportTo(options) => {
                let [obj, gltf, glb] = io::EXPORT_ENDINGS;
                let is_scene = *options == ExportOptions::SCENE;
                let title = if is_scene { "Export the scene" } else { "Export the models" };
                (title, Mode::Save, vec![glb, gltf, obj])
            }
            Self::Texture(_) | Self::TextureOfModel => {
                ("Choose a texture", Mode::Open, io::texture_endings())
            }
            Self::Panorama => ("Choose a panorama", Mode::Open, io::panorama_endings()),
            Self::Missing(path) if has_ending(path, &io::texture_endings()) => {
                ("Where is the missing picture?", Mode::Open, io::texture_endings())
            }
            Self::Missing(path) if has_ending(path, &io::panorama_endings()) => {
                ("Where is the missing panorama?", Mode::Open, io::panorama_endings())
            }
            Self::Missing(_) => ("Where is the missing model?", Mode::Open, models()),
        }
    }
}

/// Returns whether a path has one of these extensions.
fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy());
    ending.is_some_and(|ending| endings.iter().any(|own| own.eq_ignore_ascii_case(&ending)))
}
