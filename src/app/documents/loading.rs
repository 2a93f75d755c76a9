//! Files being read, and their contents.

use std::path::{Path, PathBuf};

use crate::app::tasks::Task;
use marraztu_core::base::Shared;
use marraztu_core::scene::{
    LoadOptions, MaterialChoice, Model, Object, ObjectId, Panorama, Texture, UpAxis,
};
use marraztu_io::{
    self as io, Finding, Fragment, LoadError, Loaded, Opened, SCENE_ENDING, SceneFileError,
};

/// A file being read.
#[derive(Debug)]
pub(crate) struct Loading {
    pub(crate) task: Task<Fetched>,
    /// Whether it will open a dialog, for which other dialogs have to be closed first.
    pub(crate) asks: bool,
    /// Whether it belongs to the scene of a lesson, not to the user's own.
    pub(crate) of_lesson: bool,
}

/// A file waiting to be read.
pub(crate) struct Queued {
    pub(crate) label: String,
    pub(crate) asks: bool,
    pub(crate) of_lesson: bool,
    pub(crate) work: Box<dyn FnOnce(&io::Progress) -> Fetched + Send>,
}

impl std::fmt::Debug for Queued {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { label, asks, of_lesson, work: _ } = self;
        let mut shown = f.debug_struct("Queued");
        shown.field("label", label).field("asks", asks).field("of_lesson", of_lesson);
        shown.finish_non_exhaustive()
    }
}

/// The content of a file.
#[derive(Debug)]
pub(crate) enum Fetched {
    /// A model; its material is asked for if not known.
    Model(Box<FetchedModel>),
    /// A texture for these objects.
    Texture(Vec<ObjectId>, Result<(Shared<Texture>, Vec<Finding>), LoadError>),
    /// A panorama for the sky.
    Panorama(Result<Shared<Panorama>, LoadError>),
    /// A scene.
    Scene(Box<Opening>),
    /// Items from the clipboard.
    Pasted(Result<Box<Fragment>, SceneFileError>),
    /// Models of objects, with this axis of their files pointing up.
    Turned(Vec<Turned>, UpAxis),
    /// Models read again.
    Again(Vec<Reread>),
    /// Missing files that were found.
    Found(Vec<Found>),
    /// Models to be shown together, without the current scene.
    Alone(Vec<Result<Arrived, LoadError>>, Arrival),
}

/// The origin of models that are shown alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// The command line.
    Start,
    /// Files dropped on the window.
    Dropped,
}

/// A model read with the material of its file, and the notice about it.
#[derive(Debug)]
pub(crate) struct Arrived {
    pub(crate) object: Object,
    /// The text of its notice.
    pub(crate) said: String,
    pub(crate) findings: Vec<Finding>,
}

/// A model read with another axis up, for these objects.
#[derive(Debug)]
pub(crate) struct Turned {
    pub(crate) ids: Vec<ObjectId>,
    pub(crate) result: Result<Shared<Model>, LoadError>,
}

/// The result of reading a model again.
#[derive(Debug)]
pub(crate) struct Reread {
    pub(crate) path: PathBuf,
    pub(crate) options: LoadOptions,
    pub(crate) result: Result<Loaded, LoadError>,
}

/// A missing file that was found, with its content.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) old: PathBuf,
    pub(crate) new: PathBuf,
    /// Each placeholder, and the model that replaces it.
    pub(crate) models: Vec<(Shared<Model>, Result<Loaded, LoadError>)>,
    pub(crate) texture: Option<Result<Shared<Texture>, LoadError>>,
    pub(crate) panorama: Option<Result<Shared<Panorama>, LoadError>>,
    pub(crate) findings: Vec<Finding>,
}

/// The result of reading a model.
#[derive(Debug)]
pub(crate) struct FetchedModel {
    pub(crate) path: PathBuf,
    pub(crate) material: Option<MaterialChoice>,
    pub(crate) keeps_saved: bool,
    pub(crate) result: Result<(Loaded, Option<Shared<Texture>>), LoadError>,
}

/// Options for loading a model.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wish {
    pub(crate) options: LoadOptions,
    pub(crate) material: Option<MaterialChoice>,
    pub(crate) texture: Option<PathBuf>,
    /// Whether the scene counts as saved afterwards, if it did before.
    pub(crate) keeps_saved: bool,
}

/// The result of reading a scene.
#[derive(Debug)]
pub(crate) struct Opening {
    pub(crate) path: PathBuf,
    /// The number of changes by the user before reading began.
    pub(crate) changes: u64,
    pub(crate) result: Result<Opened, SceneFileError>,
}

pub(crate) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(SCENE_ENDING))
}
