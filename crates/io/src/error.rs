//! Reasons why a file cannot be loaded, worded for the user.

use std::path::Path;

use super::progress::Cancelled;

/// The message for files that do not fit in memory.
pub(super) const NO_MEMORY: &str = "there is not enough memory for it";

/// The message for files in place of contents that Git LFS stores elsewhere.
pub(super) const LFS_POINTER: &str =
    "this is a Git LFS pointer without the file's content: run \"git lfs pull\"";

/// The reason why a file could not be loaded. A failed load changes nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be read at all.
    #[error("{file}: {reason}")]
    File {
        /// The file's path, as the user gave it.
        file: String,
        /// The reason.
        reason: String,
    },
    /// A line of the file is not a valid statement.
    #[error("{file}:{line}: {reason}")]
    Line {
        /// The file's path, as the user gave it.
        file: String,
        /// The line, counted from 1.
        line: u32,
        /// The reason.
        reason: String,
    },
    /// [`Progress::cancel`](super::Progress::cancel) was called.
    #[error("loading was cancelled")]
    Cancelled,
}

impl From<Cancelled> for LoadError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl LoadError {
    pub(super) fn file(file: &str, reason: impl Into<String>) -> Self {
        Self::File { file: file.to_owned(), reason: reason.into() }
    }

    pub(super) fn line(file: &str, line: u32, reason: impl Into<String>) -> Self {
        Self::Line { file: file.to_owned(), line, reason: reason.into() }
    }

    pub(super) fn too_large(file: &str, most: usize) -> Self {
        Self::file(file, format!("the file is larger than {} MB", most >> 20))
    }

    /// Returns the reason without the name of the file.
    pub(super) fn reason(&self) -> String {
        match self {
            Self::File { reason, .. } | Self::Line { reason, .. } => reason.clone(),
            Self::Cancelled => self.to_string(),
        }
    }

    pub(super) fn system(file: &str, error: &std::io::Error) -> Self {
        Self::file(file, reason(error))
    }
}

/// Returns the message of an I/O error, in plainer words for common kinds.
pub(super) fn reason(error: &std::io::Error) -> String {
    use std::io::ErrorKind;
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        // Windows has one error for both.
        ErrorKind::PermissionDenied if cfg!(windows) => {
            "permission denied, or another program has it open".to_owned()
        }
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        ErrorKind::IsADirectory => "this is a folder, not a file".to_owned(),
        ErrorKind::NotADirectory => "a part of its path is not a folder".to_owned(),
        ErrorKind::StorageFull => "the disk is full".to_owned(),
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only".to_owned(),
        ErrorKind::OutOfMemory => NO_MEMORY.to_owned(),
        _ => error.to_string(),
    }
}

/// Formats a path for messages: as the user gave it.
pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// Returns a file's name without its folders.
pub(super) fn short_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
