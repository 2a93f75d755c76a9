//! Why a command of the command line fails.

use std::path::PathBuf;

use marraztu::app::StartError;
use marraztu_core::edit::Refusal;
use marraztu_core::scene::CommandError;
use marraztu_io::{LoadError, SaveError, SceneFileError};
use marraztu_lab::pairs::Unmeasured;
use marraztu_lab::report::PlotError;

/// Why a command fails, in one sentence.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// Invalid arguments, or arguments that contradict each other.
    #[error("{0}")]
    Usage(String),
    /// Arguments that cannot be parsed.
    #[error(transparent)]
    Unparsed(Box<clap::Error>),
    /// The error has been printed already.
    #[error("some of it failed")]
    Told,
    /// Something that the arguments name does not exist.
    #[error("{0}")]
    Absent(String),
    /// A model or a texture.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A scene.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
    /// The picture.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// A change that the scene does not allow.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// Standard output.
    #[error("standard output: {0}")]
    Output(std::io::Error),
    /// A file of results.
    #[error("{0} could not be written: {1}")]
    Write(PathBuf, std::io::Error),
    /// A measurement.
    #[error(transparent)]
    Measure(#[from] Unmeasured),
    /// A plot.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The window.
    #[error(
        "{0}\nWithout a window, `marraztu render --out picture.png` draws the same pictures into \
         files"
    )]
    Start(#[from] StartError),
}

/// Invalid arguments, or arguments that contradict each other.
pub(crate) fn usage(reason: &str) -> Failure {
    Failure::Usage(reason.to_owned())
}

impl From<CommandError> for Failure {
    fn from(error: CommandError) -> Self {
        Self::Refused(error.into())
    }
}
