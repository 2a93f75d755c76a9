//! Writing a file so that nothing is lost, whatever happens on the way.
//!
//! The new content is written beside the old one and takes its name in one step: whoever looks finds
//! the old file or the new one, whole. What is somebody's work is brought to the disk before, so that
//! not even a loss of power takes it.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::error::{reason, shown};

/// Why a file could not be written. What was there before still is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file} could not be saved: {reason}")]
pub struct SaveError {
    /// The file's path, as the user gave it.
    pub file: String,
    /// What is wrong.
    pub reason: String,
}

impl SaveError {
    pub(super) fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self { file: shown(path), reason: reason.into() }
    }
}

/// What a file is worth to whoever saves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Worth {
    /// It can be made again, and nobody waits until a disk has turned.
    Product,
    /// It is somebody's work: it is brought to the disk, and the file that was there is kept, with
    /// `~` after its name.
    Work,
}

/// Makes `content` the content of the file at `path`.
pub(super) fn replace(path: &Path, content: &[u8], worth: Worth) -> Result<(), SaveError> {
    let fail = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => SaveError::new(path, "there is no such folder"),
        _ => SaveError::new(path, reason(&error)),
    };
    // A link goes on pointing where it points: the file behind it is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_new| path.to_owned());
    if target.is_dir() {
        return Err(SaveError::new(path, "this is a folder, not a file"));
    }
    if target.file_name().is_none() {
        return Err(SaveError::new(path, "this is not a name for a file"));
    }
    let beside = with_ending(&target, &format!(".{}.new", std::process::id()));
    let written = write(&beside, &target, content, worth);
    if written.is_err() {
        // Nothing more can be done where even that fails.
        let _ = fs::remove_file(&beside);
    }
    written.map_err(fail)
}

fn write(beside: &Path, target: &Path, content: &[u8], worth: Worth) -> std::io::Result<()> {
    let mut file = OpenOptions::new().write(true).create(true).truncate(true).open(beside)?;
    file.write_all(content)?;
    if let Ok(old) = fs::metadata(target) {
        // Who may read it is as before, where the disk knows of such things.
        let _ = file.set_permissions(old.permissions());
    }
    if worth == Worth::Product {
        return fs::rename(beside, target);
    }
    file.sync_all()?;
    drop(file);
    if target.exists() {
        let kept = with_ending(target, "~");
        let _ = fs::remove_file(&kept);
        if fs::hard_link(target, &kept).is_err() {
            fs::copy(target, &kept)?;
        }
    }
    fs::rename(beside, target)?;
    // The name, too, should survive a loss of power; not every system lets one ask for it.
    if let Some(folder) = target.parent() {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    Ok(())
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}
