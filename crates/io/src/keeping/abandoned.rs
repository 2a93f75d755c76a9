//! Unsaved work that a program has left behind by crashing or being killed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::origin::origin;
use super::{Lock, OwnFolders, Slot, discarded, list_lock};
use crate::error::reason;
use crate::fingerprint::Fingerprint;

/// Unsaved work of a program that has ended. While this value lives, no other program takes it.
#[derive(Debug)]
pub struct Abandoned {
    slot: Slot,
    lock: Lock,
    /// When it was written last.
    pub written: SystemTime,
    /// The file in which the scene was saved before, if it was.
    pub scene_file: Option<PathBuf>,
    /// The content of that file on which the work is based, if it is known.
    pub content: Option<Fingerprint>,
}

impl Abandoned {
    /// All there is, the latest first. Locks that were left without work are removed.
    #[must_use]
    pub fn all(folders: &OwnFolders) -> Vec<Self> {
        let folder = &folders.state;
        if !folder.is_dir() {
            return Vec::new();
        }
        let Ok(_list) = list_lock(folder) else { return Vec::new() };
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut found: Vec<Self> =
            entries.filter_map(|entry| Self::at(folder, &entry.path())).collect();
        found.sort_by_key(|work| std::cmp::Reverse(work.written));
        found
    }

    fn at(folder: &Path, lock: &Path) -> Option<Self> {
        let name = lock.file_name()?.to_str()?.strip_suffix(".lock")?;
        if !name.starts_with(PREFIX) {
            return None;
        }
        let slot = Slot::named(folder, name);
        let lock = Lock::try_take(&slot.lock)?;
        let Ok(metadata) = fs::metadata(&slot.work) else {
            slot.remove();
            return None;
        };
        let written = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        let (scene_file, content) = origin(&slot.work);
        Some(Self { slot, lock, written, scene_file, content })
    }

    /// The scene file with the work.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.slot.work
    }

    /// Moves the work aside, where [`Discarded::all`](super::Discarded::all) finds it for 30 days.
    ///
    /// # Errors
    /// The reason, if it cannot be moved; then it stays as it was.
    pub fn set_aside(&self) -> Result<(), String> {
        discarded::set_aside(&self.slot.work).map_err(|error| reason(&error))
    }

    /// Removes the work for good.
    pub fn remove(self) {
        let Self { slot, lock, .. } = self;
        slot.remove();
        drop(lock);
    }
}

/// How the names of work begin.
pub(super) const PREFIX: &str = "work-";
