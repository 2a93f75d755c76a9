//! The reasons why scene files cannot be opened.

use crate::error::LoadError;

/// The reason why a scene file cannot be opened. A failed open changes nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneFileError {
    /// The file cannot be read, or its scene is invalid.
    #[error("{file}: {reason}")]
    File {
        /// The file's path, as the user gave it.
        file: String,
        /// The reason.
        reason: String,
    },
    /// A line of the file is invalid.
    #[error("{file}:{line}:{column}: {reason}")]
    Line {
        /// The file's path, as the user gave it.
        file: String,
        /// The line, counted from 1.
        line: usize,
        /// The column, in characters counted from 1.
        column: usize,
        /// The reason.
        reason: String,
    },
    /// The scene file cannot be read, or opening was cancelled.
    #[error(transparent)]
    Model(#[from] LoadError),
}
