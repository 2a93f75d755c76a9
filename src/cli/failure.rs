//! The errors of commands.

use std::path::PathBuf;

#[cfg(feature = "desktop")]
use marraztu::app::StartError;
#[cfg(not(target_family = "wasm"))]
use marraztu::plots::PlotError;
use marraztu_core::edit::Refusal;
use marraztu_core::scene::CommandError;
use marraztu_io::{LoadError, SaveError, SceneFileError};
use marraztu_lab::pairs::Unmeasured;

/// The reason why a command failed, in one sentence.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// Invalid arguments, or arguments that contradict each other.
    #[error("{0}")]
    Usage(String),
    /// Arguments that cannot be parsed.
    #[cfg(feature = "desktop")]
    #[error(transparent)]
    Unparsed(Box<clap::Error>),
    /// The error has been printed already.
    #[error("some of it failed")]
    Told,
    /// The result is the exit status.
    #[error("exit status {0}")]
    Status(u8),
    /// An item named in the arguments does not exist.
    #[error("{0}")]
    Absent(String),
    /// A model or a texture could not be loaded.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A scene could not be opened.
    #[error(transparent)]
    Scene(#[from] SceneFileError),
    /// A file could not be saved.
    #[error(transparent)]
    Save(#[from] SaveError),
    /// The scene does not allow a change.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// Standard output could not be written.
    #[error("standard output: {0}")]
    Output(std::io::Error),
    /// A file of results could not be written.
    #[error("{0} could not be written: {1}")]
    Write(PathBuf, std::io::Error),
    /// A measurement failed.
    #[error(transparent)]
    Measure(#[from] Unmeasured),
    /// A plot could not be drawn.
    #[cfg(not(target_family = "wasm"))]
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The window could not be opened.
    #[cfg(feature = "desktop")]
    #[error(
        "{0}\nWithout a window, `marraztu render --out picture.png` draws the same pictures into \
         files"
    )]
    Start(#[from] StartError),
}

/// Makes an error for invalid or contradictory arguments.
pub(crate) fn usage(reason: &str) -> Failure {
    Failure::Usage(reason.to_owned())
}

impl From<CommandError> for Failure {
    fn from(error: CommandError) -> Self {
        Self::Refused(error.into())
    }
}
