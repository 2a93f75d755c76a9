//! Why a file could not be loaded, worded for the person at the screen.

use std::path::Path;

use super::progress::Cancelled;

/// The message if there is not enough memory for a file.
pub(super) const NO_MEMORY: &str = "there is not enough memory for it";

/// Why a file could not be loaded. Nothing has changed then.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// The file cannot be read at all.
    #[error("{file}: {reason}")]
    File {
        /// Its path, as the user gave it.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// A line of it is not a valid statement.
    #[error("{file}:{line}: {reason}")]
    Line {
        /// The file's path, as the user gave it.
        file: String,
        /// The line, counted from 1.
        line: u32,
        /// What is wrong.
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

    pub(super) fn system(file: &str, error: &std::io::Error) -> Self {
        Self::file(file, reason(error))
    }
}

/// The message of the operating system, in our own words if they are plainer.
pub(super) fn reason(error: &std::io::Error) -> String {
    use std::io::ErrorKind;
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        ErrorKind::IsADirectory => "this is a folder, not a file".to_owned(),
        ErrorKind::NotADirectory => "a part of its path is not a folder".to_owned(),
        ErrorKind::StorageFull => "the disk is full".to_owned(),
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only".to_owned(),
        ErrorKind::OutOfMemory => NO_MEMORY.to_owned(),
        _ => error.to_string(),
    }
}

/// A path as messages show it: as the user gave it.
pub(super) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// A file's name without folders.
pub(super) fn short_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
