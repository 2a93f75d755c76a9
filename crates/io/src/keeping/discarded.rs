//! Unsaved work that the user has discarded: it is moved aside, and removed after 30 days.
//!
//! The name of its file says when it was discarded; the time of the file is when it was written.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::OwnFolders;
use super::origin::origin;
use crate::fingerprint::Fingerprint;

/// How the names of discarded work begin.
const PREFIX: &str = "discarded-";

/// How long discarded work is kept.
const KEPT: Duration = Duration::from_secs(30 * 24 * 60 * 60);

/// Work that was discarded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Discarded {
    path: PathBuf,
    /// When it was discarded.
    at: SystemTime,
    /// When it was written last.
    pub written: SystemTime,
    /// The file in which the scene was saved before, if it was.
    pub scene_file: Option<PathBuf>,
    /// The content of that file on which the work is based, if it is known.
    pub content: Option<Fingerprint>,
}

impl Discarded {
    /// All there is, the latest first. Work older than 30 days is removed.
    #[must_use]
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
        let name = name.strip_prefix(PREFIX)?.strip_suffix(crate::SCENE_ENDING)?;
        let seconds = name.split('-').next()?.parse().ok()?;
        let at = UNIX_EPOCH.checked_add(Duration::from_secs(seconds))?;
        let written = fs::metadata(&path).and_then(|data| data.modified()).unwrap_or(at);
        let (scene_file, content) = origin(&path);
        Some(Self { path, at, written, scene_file, content })
    }

    /// Whether it is kept; removes it if it is too old.
    fn is_kept(&self, now: SystemTime) -> bool {
        // A clock that was set back makes nothing old.
        let is_old = now.duration_since(self.at).is_ok_and(|age| age > KEPT);
        if is_old {
            // If that fails, the next program tries it again.
            let _ = fs::remove_file(&self.path);
        }
        !is_old
    }

    /// The scene file with the work.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Moves a file of work aside.
///
/// # Errors
/// If it cannot be renamed; it stays where it was.
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
