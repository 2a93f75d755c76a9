//! Files that are being read, and what was read.

use std::path::{Path, PathBuf};

use crate::app::tasks::Task;
use marraztu_core::base::Shared;
use marraztu_core::scene::{LoadOptions, MaterialChoice, Model, Object, ObjectId, Texture};
use marraztu_io::{
    self as io, Finding, Fragment, LoadError, Loaded, Opened, SCENE_ENDING, SceneFileError,
};

/// A file that is being read.
#[derive(Debug)]
pub(crate) struct Loading {
    pub(crate) task: Task<Fetched>,
    /// Whether it opens a dialog, for which others have to be closed first.
    pub(crate) asks: bool,
}

/// A file that waits to be read.
pub(crate) struct Queued {
    pub(crate) label: String,
    pub(crate) asks: bool,
    pub(crate) work: Box<dyn FnOnce(&io::Progress) -> Fetched + Send>,
}

impl std::fmt::Debug for Queued {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { label, asks, work: _ } = self;
        f.debug_struct("Queued").field("label", label).field("asks", asks).finish_non_exhaustive()
    }
}

/// A file that was read.
#[derive(Debug)]
pub(crate) enum Fetched {
    /// A model; asks for the material if it is not known.
    Model(Box<FetchedModel>),
    /// A texture for an object.
    Texture(ObjectId, Result<(Shared<Texture>, Vec<Finding>), LoadError>),
    /// A scene.
    Scene(Box<Opening>),
    /// Items from the clipboard.
    Pasted(Result<Box<Fragment>, SceneFileError>),
    /// The model of an object with another axis of its file pointing up.
    Turned(ObjectId, Result<Box<Loaded>, LoadError>),
    /// Models that were read again.
    Again(Vec<Reread>),
    /// Missing files that were found.
    Found(Vec<Found>),
    /// Models that are shown together and alone.
    Alone(Vec<Result<Arrived, LoadError>>, Arrival),
}

/// How models that are shown alone were named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// On the command line.
    Start,
    /// By dropping their files on the window.
    Dropped,
}

/// A model that was read with its own material, and what is told about it.
#[derive(Debug)]
pub(crate) struct Arrived {
    pub(crate) object: Object,
    /// The text of its notice.
    pub(crate) said: String,
    pub(crate) findings: Vec<String>,
}

/// A model that was read again, or could not be.
#[derive(Debug)]
pub(crate) struct Reread {
    pub(crate) before: Shared<Model>,
    pub(crate) result: Result<Loaded, LoadError>,
}

/// A missing file that was found, with its content.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) old: PathBuf,
    pub(crate) new: PathBuf,
    /// Each placeholder, and the model that takes its place.
    pub(crate) models: Vec<(Shared<Model>, Result<Loaded, LoadError>)>,
    pub(crate) texture: Option<Result<Shared<Texture>, LoadError>>,
    pub(crate) findings: Vec<Finding>,
}

/// A model that was read, or could not be.
#[derive(Debug)]
pub(crate) struct FetchedModel {
    pub(crate) path: PathBuf,
    pub(crate) material: Option<MaterialChoice>,
    pub(crate) keeps_saved: bool,
    pub(crate) result: Result<(Loaded, Option<Shared<Texture>>), LoadError>,
}

/// How a model is to be loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wish {
    pub(crate) options: LoadOptions,
    pub(crate) material: Option<MaterialChoice>,
    pub(crate) texture: Option<PathBuf>,
    /// Whether the scene still counts as saved afterwards.
    pub(crate) keeps_saved: bool,
}

/// A scene that was read, or could not be.
#[derive(Debug)]
pub(crate) struct Opening {
    pub(crate) path: PathBuf,
    pub(crate) result: Result<Opened, SceneFileError>,
}

/// Whether a path names a scene.
pub(crate) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(SCENE_ENDING))
}
