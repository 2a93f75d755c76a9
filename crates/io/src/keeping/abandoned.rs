//! Unsaved work left behind by a program that crashed or was killed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::discarded;
use super::origin::origin;
use super::slots::{Lock, OwnFolders, Slot, list_lock};
use crate::error::reason;
use crate::fingerprint::Fingerprint;

/// Unsaved work of a program that has ended. While this value lives, other programs cannot take it.
#[derive(Debug)]
pub struct Abandoned {
    slot: Slot,
    lock: Lock,
    /// The time of the last write.
    pub written: SystemTime,
    /// The file that the scene was last saved to, if any.
    pub scene_file: Option<PathBuf>,
    /// The content of that file when the work began, if known.
    pub content: Option<Fingerprint>,
}

impl Abandoned {
    /// Finds all abandoned work, the latest first. Locks without work are removed.
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

    /// Returns the scene file with the work.
    pub fn path(&self) -> &Path {
        &self.slot.work
    }

    /// Moves the work aside; [`Discarded::all`](super::Discarded::all) finds it for 30 days.
    ///
    /// # Errors
    /// The reason, if it cannot be moved; it is then unchanged.
    pub fn set_aside(&self) -> Result<(), String> {
        discarded::set_aside(&self.slot.work).map_err(|error| reason(&error))
    }

    /// Deletes the work.
    pub fn remove(self) {
        let Self { slot, lock, .. } = self;
        slot.remove();
        drop(lock);
    }
}

/// The prefix of the names of work.
pub(super) const PREFIX: &str = "work-";
