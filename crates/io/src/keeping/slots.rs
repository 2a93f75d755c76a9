//! The folders of the program's own files, the files of unsaved work in them, and their locks.

use std::fs::{self, File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::reason;
use crate::scene_file::SCENE_ENDING;

/// The folders of the program's own files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OwnFolders {
    /// Unsaved work.
    pub state: PathBuf,
    /// Preferences.
    pub config: PathBuf,
}

impl OwnFolders {
    /// Returns the folders of this user; `None` if the system does not define them.
    pub fn of_user() -> Option<Self> {
        let folders = directories::ProjectDirs::from("", "", "marraztu")?;
        let state = folders.state_dir().unwrap_or_else(|| folders.data_local_dir());
        Some(Self { state: state.to_owned(), config: folders.config_dir().to_owned() })
    }

    /// Returns both folders inside one.
    pub fn within(folder: &Path) -> Self {
        Self { state: folder.join("state"), config: folder.join("config") }
    }
}

/// A file lock, held by one program at a time until it is dropped or the program ends.
#[derive(Debug)]
pub(super) struct Lock(File);

impl Lock {
    fn open(path: &Path) -> std::io::Result<File> {
        OpenOptions::new().write(true).create(true).truncate(false).open(path)
    }

    /// Waits for the lock.
    pub(super) fn take(path: &Path) -> std::io::Result<Self> {
        let file = Self::open(path)?;
        unless_unsupported(file.lock())?;
        Ok(Self(file))
    }

    /// Takes the lock if it is free.
    pub(super) fn try_take(path: &Path) -> Option<Self> {
        let file = Self::open(path).ok()?;
        unless_unsupported(file.try_lock().map_err(std::io::Error::from)).ok()?;
        Some(Self(file))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Closing the file unlocks it too.
        let _ = self.0.unlock();
    }
}

/// Ignores that there are no locks: in WebAssembly, no other program has access to the files.
fn unless_unsupported(locked: std::io::Result<()>) -> std::io::Result<()> {
    match locked {
        Err(error) if error.kind() == ErrorKind::Unsupported => Ok(()),
        locked => locked,
    }
}

/// Creates one of the program's folders if it is missing.
pub(super) fn made(folder: &Path) -> Result<(), String> {
    let fail = |error: &std::io::Error| format!("{}: {}", folder.display(), reason(error));
    fs::create_dir_all(folder).map_err(|error| fail(&error))
}

/// A file of unsaved work and its lock.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Slot {
    pub(super) work: PathBuf,
    pub(super) lock: PathBuf,
}

impl Slot {
    pub(super) fn named(folder: &Path, name: &str) -> Self {
        let at = |ending: &str| folder.join(format!("{name}.{ending}"));
        Self { work: at(SCENE_ENDING), lock: at("lock") }
    }

    /// Removes both files. The lock comes last, so work always has its lock.
    pub(super) fn remove(&self) {
        // Files that cannot be removed are found again at the next start.
        let _ = fs::remove_file(&self.work);
        let _ = fs::remove_file(&self.lock);
    }
}

/// Locks the list of slots.
pub(super) fn list_lock(folder: &Path) -> std::io::Result<Lock> {
    Lock::take(&folder.join("lock"))
}
