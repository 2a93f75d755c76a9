//! Unsaved work that the user has discarded: it is moved aside, and deleted after 30 days.
//!
//! The file name contains the time of discarding; the file's timestamp is that of the last write.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::origin::origin;
use super::slots::OwnFolders;
use crate::fingerprint::Fingerprint;
use crate::scene_file::SCENE_ENDING;

/// The prefix of the names of discarded work.
const PREFIX: &str = "discarded-";

/// The time for which discarded work is kept.
const KEPT: Duration = Duration::from_secs(30 * 24 * 60 * 60);

/// A piece of discarded work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Discarded {
    path: PathBuf,
    /// The time at which it was discarded.
    at: SystemTime,
    /// The time of the last write.
    pub written: SystemTime,
    /// The file that the scene was last saved to, if any.
    pub scene_file: Option<PathBuf>,
    /// The content of that file when the work began, if known.
    pub content: Option<Fingerprint>,
}

impl Discarded {
    /// Finds all discarded work, the latest first. Work older than 30 days is deleted.
    pub fn all(folders: &OwnFolders) -> Vec<Self> {
        Self::all_at(folders, SystemTime::now())
    }

    fn all_at(folders: &OwnFolders, now: SystemTime) -> Vec<Self> {
        let entries = fs::read_dir(&folders.state).into_iter().flatten().flatten();
        let mut found: Vec<Self> = entries
            .filter_map(|entry| Self::at(entry.path()))
            .filter(|it| it.is_kept(now))
            .collect();
        found.sort_by_key(|work| std::cmp::Reverse((work.at, work.written)));
        found
    }

    fn at(path: PathBuf) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let name = name.strip_prefix(PREFIX)?.strip_suffix(SCENE_ENDING)?;
        let seconds = name.split('-').next()?.parse().ok()?;
        let at = UNIX_EPOCH.checked_add(Duration::from_secs(seconds))?;
        let written = fs::metadata(&path).and_then(|data| data.modified()).unwrap_or(at);
        let (scene_file, content) = origin(&path);
        Some(Self { path, at, written, scene_file, content })
    }

    /// Returns whether the work is kept; deletes it if it is too old.
    fn is_kept(&self, now: SystemTime) -> bool {
        // If the clock was set back, nothing counts as old.
        let is_old = now.duration_since(self.at).is_ok_and(|age| age > KEPT);
        if is_old {
            // If this fails, the next start tries again.
            let _ = fs::remove_file(&self.path);
        }
        !is_old
    }

    /// Returns the scene file with the work.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Moves a file of work aside. Fails if it cannot be renamed; the file then keeps its name.
pub(super) fn set_aside(work: &Path) -> std::io::Result<()> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs();
    let name = work.file_name().unwrap_or(work.as_os_str()).to_string_lossy();
    fs::rename(work, work.with_file_name(format!("{PREFIX}{now}-{name}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discarded_work_is_kept_for_thirty_days() {
        let folder = tempfile::tempdir().unwrap();
        let folders = OwnFolders::within(folder.path());
        fs::create_dir_all(&folders.state).unwrap();
        let work = folders.state.join("work-1-1.marraztu");
        fs::write(&work, "// unsaved changes of \"/a/b.marraztu\"\n(version: 1)\n").unwrap();
        set_aside(&work).unwrap();
        assert!(!work.exists());
        let now = SystemTime::now();
        let days = |days: u64| now + Duration::from_secs(days * 24 * 60 * 60);
        let all = Discarded::all_at(&folders, days(29));
        let [only] = &all[..] else { panic!("{all:?}") };
        assert_eq!(only.scene_file.as_deref(), Some(Path::new("/a/b.marraztu")));
        assert!(Discarded::all_at(&folders, days(31)).is_empty());
        assert!(Discarded::all_at(&folders, now).is_empty(), "it was removed");
    }
}
