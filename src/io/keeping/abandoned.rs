//! Unsaved work that a program has left behind by crashing or being killed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::{Lock, OwnFolders, Slot, list_lock};

/// Unsaved work of a program that has ended. While this value lives, no other program takes it.
#[derive(Debug)]
pub struct Abandoned {
    slot: Slot,
    lock: Lock,
    /// When it was written last.
    pub written: SystemTime,
    /// The file in which the scene was saved before, if it was.
    pub scene_file: Option<PathBuf>,
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
        let scene_file = scene_file(&slot.work);
        Some(Self { slot, lock, written, scene_file })
    }

    /// The scene file with the work.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.slot.work
    }

    /// Removes the work for good.
    pub fn discard(self) {
        let Self { slot, lock, .. } = self;
        slot.remove();
        drop(lock);
    }
}

/// How the names of work begin.
pub(super) const PREFIX: &str = "work-";

/// The first line of a file of work: a comment of a scene file, with the path in quotes.
const HEAD: &str = "// unsaved changes of ";

/// The first line of work on the scene in `file`.
pub(super) fn head(file: Option<&Path>) -> String {
    match file.and_then(Path::to_str).map(ron::to_string) {
        Some(Ok(quoted)) => format!("{HEAD}{quoted}\n"),
        _ => String::new(),
    }
}

/// The file that the first line names.
fn scene_file(work: &Path) -> Option<PathBuf> {
    let text = fs::read_to_string(work).ok()?;
    let quoted = text.lines().next()?.strip_prefix(HEAD)?;
    ron::from_str::<PathBuf>(quoted).ok()
}
