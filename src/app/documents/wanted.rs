//! The purposes of file dialogs, and the work that follows once the scene is saved.

use std::path::{Path, PathBuf};

use super::browser::Mode;
use super::folders::Kind;
use super::loading::is_scene;
use marraztu_core::scene::ObjectId;
use marraztu_io as io;

/// The purpose of a file dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Models to be loaded.
    Model,
    /// Models to be opened as if they were dropped.
    Dropped,
    /// A scene in place of this one.
    Scene,
    /// Where to save the scene, and what to do then.
    SceneTo(Option<After>),
    /// Where to save the picture.
    PictureTo,
    /// Where to save the picture with options.
    PictureWithOptionsTo,
    /// Where to save the turntable.
    TurntableTo,
    /// Where to export the scene.
    ExportTo,
    /// A texture for this object.
    Texture(ObjectId),
    /// A texture for the model in the material dialog.
    TextureOfModel,
    /// The new location of a missing model of a scene.
    Missing(PathBuf),
}

/// What to do once the scene is saved or discarded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum After {
    Quit,
    New,
    /// The first scene, drawn as ancestor A drew it.
    NewAncestor,
    Open(Option<PathBuf>),
    /// Recover the unsaved work that is offered at this place.
    Recover(usize),
    /// Recover the discarded work at this place.
    RecoverDiscarded(usize),
}

/// What to do with a scene after another program has changed its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChangedFile {
    /// Save it under another name.
    SaveElsewhere,
    /// Replace what the other program has written.
    Overwrite,
    /// Open what the other program has written instead.
    Reload,
}

impl Wanted {
    /// The kind of folder that its dialog remembers.
    pub(super) const fn kind(&self) -> Kind {
        match self {
            Self::Model | Self::Dropped | Self::Scene | Self::Missing(_) => Kind::Opened,
            Self::Texture(_) | Self::TextureOfModel => Kind::Texture,
            Self::SceneTo(_)
            | Self::PictureTo
            | Self::PictureWithOptionsTo
            | Self::TurntableTo
            | Self::ExportTo => Kind::Saved,
        }
    }

    /// A path with the ending that it needs.
    pub(super) fn named(&self, path: PathBuf) -> PathBuf {
        if !matches!(self, Self::SceneTo(_)) || is_scene(&path) {
            return path;
        }
        let mut text = path.into_os_string();
        text.push(".");
        text.push(io::SCENE_ENDING);
        PathBuf::from(text)
    }

    /// The title of its dialog, whether a file is opened or saved, and the endings.
    pub(super) fn description(&self) -> (&'static str, Mode, Vec<&'static str>) {
        let models = || vec!["obj", "gz"];
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
            Self::ExportTo => {
                let endings = io::EXPORT_ENDINGS;
                ("Export the scene", Mode::Save, vec![endings[2], endings[1], endings[0]])
            }
            Self::Texture(_) | Self::TextureOfModel => {
                ("Choose a texture", Mode::Open, io::texture_endings())
            }
            Self::Missing(path) if is_picture(path) => {
                ("Where is the missing texture?", Mode::Open, io::texture_endings())
            }
            Self::Missing(_) => ("Where is the missing model?", Mode::Open, models()),
        }
    }
}

/// Whether a path has the ending of a picture.
fn is_picture(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy());
    ending.is_some_and(|ending| {
        io::texture_endings().iter().any(|own| own.eq_ignore_ascii_case(&ending))
    })
}
