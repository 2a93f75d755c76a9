//! Writes files without losing the old content if writing fails.
//!
//! The new content is written to a temporary file in the same folder, which then replaces the old
//! file atomically: a reader always finds a complete file. The user's own work is flushed to disk
//! first, so it survives even a power failure.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::error::{reason, shown};

/// The reason why a file could not be written. An existing file is unchanged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file} could not be saved: {reason}")]
pub struct SaveError {
    /// The file's path, as the user gave it.
    pub file: String,
    /// The reason.
    pub reason: String,
}

impl SaveError {
    pub(super) fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self { file: shown(path), reason: reason.into() }
    }
}

/// The value of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Worth {
    /// It can be recreated, so saving it does not wait for the disk.
    Product,
    /// The user's work: it is flushed to disk, and the old file is kept with `~` appended to its
    /// name.
    Work,
    /// The program's own record of the user's work: it is flushed to disk, and the old file is not
    /// kept.
    Journal,
}

/// Checks whether a file can be written at `path`: its folder exists and is writable.
///
/// # Errors
/// If it cannot.
pub(super) fn check_target(path: &Path) -> Result<(), SaveError> {
    let target = target(path)?;
    check_folder(path, &target)?;
    let beside = beside(&target, std::process::id());
    // Permissions are checked by creating the temporary file.
    let opened = OpenOptions::new().write(true).create_new(true).open(&beside);
    let opened = opened.map(|_file| fs::remove_file(&beside));
    match opened {
        Err(error) if error.kind() == ErrorKind::PermissionDenied => {
            let reason = format!("no permission to write to {}", folder_name(&target));
            Err(SaveError::new(path, reason))
        }
        Err(error) if error.kind() != ErrorKind::AlreadyExists => {
            Err(SaveError::new(path, reason(&error)))
        }
        _ => Ok(()),
    }
}

/// The most links that are followed, as on Linux.
const MOST_LINKS: usize = 40;

/// Returns the file to replace. Links are followed and stay links, even to a missing file.
fn target(path: &Path) -> Result<PathBuf, SaveError> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&target) else { break };
        // A relative link is relative to the folder that contains it.
        target = folder(&target).join(next);
    }
    let target = fs::canonicalize(&target).unwrap_or(target);
    if target.is_symlink() {
        return Err(SaveError::new(path, "its symbolic links form a loop"));
    }
    if target.is_dir() {
        return Err(SaveError::new(path, "this is a folder, not a file"));
    }
    if target.file_name().is_none() {
        return Err(SaveError::new(path, "this is not a valid file name"));
    }
    Ok(target)
}

fn check_folder(path: &Path, target: &Path) -> Result<(), SaveError> {
    let folder = folder(target);
    let reason = match folder.metadata() {
        Ok(metadata) if metadata.is_dir() => return Ok(()),
        Ok(_) => format!("{} is not a folder", folder.display()),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            format!("{} does not exist", folder_name(target))
        }
        Err(error) => reason(&error),
    };
    Err(SaveError::new(path, reason))
}

fn folder(target: &Path) -> &Path {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Formats the folder of a file for messages.
fn folder_name(target: &Path) -> String {
    format!("the folder {}/", folder(target).display())
}

/// Replaces the content of the file at `path`.
pub(super) fn replace(path: &Path, content: &[u8], worth: Worth) -> Result<(), SaveError> {
    replace_by(path, worth, &mut |file| file.write_all(content))
}

/// A function that writes the content of a file.
type Content<'a> = dyn FnMut(&mut File) -> std::io::Result<()> + 'a;

/// Works like [`replace`], with a function that writes the content.
pub(super) fn replace_by(
    path: &Path,
    worth: Worth,
    content: &mut Content<'_>,
) -> Result<(), SaveError> {
    let fail = |error: std::io::Error| SaveError::new(path, reason(&error));
    let target = target(path)?;
    check_folder(path, &target)?;
    remove_left_over(&target);
    let beside = beside(&target, std::process::id());
    let written = write(&beside, &target, content, worth);
    if written.is_err() {
        // If even this fails, nothing more can be done.
        let _ = fs::remove_file(&beside);
    }
    written.map_err(fail)
}

fn write(
    beside: &Path,
    target: &Path,
    content: &mut Content<'_>,
    worth: Worth,
) -> std::io::Result<()> {
    let mut file = OpenOptions::new().write(true).create(true).truncate(true).open(beside)?;
    content(&mut file)?;
    if let Ok(old) = fs::metadata(target) {
        // Keeps the permissions, if the file system supports them.
        let _ = file.set_permissions(old.permissions());
    }
    if worth == Worth::Product {
        return fs::rename(beside, target);
    }
    file.sync_all()?;
    drop(file);
    // A hard link keeps the old file at its name until the rename; copying is the fallback.
    if worth == Worth::Work && target.exists() {
        let kept = with_ending(target, "~");
        let _ = fs::remove_file(&kept);
        if fs::hard_link(target, &kept).is_err() {
            fs::copy(target, &kept)?;
        }
    }
    fs::rename(beside, target)?;
    // Flushing the folder makes the new name survive a power failure; not every system supports it.
    let _ = File::open(folder(target)).and_then(|folder| folder.sync_all());
    Ok(())
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

/// Returns the temporary file that a process writes next to its target.
fn beside(target: &Path, process: u32) -> PathBuf {
    with_ending(target, &format!(".{process}.new"))
}

/// A temporary file that is older than this is not in use.
const LONG_AGO: Duration = Duration::from_secs(60);

/// Removes temporary files that crashed processes have left next to a file.
fn remove_left_over(target: &Path) {
    let Some(name) = target.file_name().and_then(|name| name.to_str()) else { return };
    let is_left_over = |entry: &fs::DirEntry| {
        let other = entry.file_name();
        let process = other.to_str().and_then(|other| {
            other.strip_prefix(name)?.strip_prefix('.')?.strip_suffix(".new")?.parse().ok()
        });
        let age = entry.metadata().and_then(|metadata| metadata.modified());
        let age = age.ok().and_then(|written| written.elapsed().ok());
        process.is_some_and(has_ended) && age.is_some_and(|age| age > LONG_AGO)
    };
    let entries = fs::read_dir(folder(target)).into_iter().flatten().flatten();
    for entry in entries.filter(is_left_over) {
        // If this fails, the file stays.
        let _ = fs::remove_file(entry.path());
    }
}

/// Returns whether a process has ended, as far as the system reports.
fn has_ended(process: u32) -> bool {
    let processes = Path::new("/proc");
    process != std::process::id() && !processes.join(process.to_string()).exists()
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    /// Returns the id of a process that has ended.
    fn ended() -> u32 {
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        child.id()
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn saving_a_file_removes_the_leftovers_of_a_killed_process() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let target = at("a.png");
        let (gone, here) = (ended(), std::os::unix::process::parent_id());
        let old =
            [beside(&target, gone), beside(&target, here), at("b.png.1.new"), at("a.png.x.new")];
        for path in &old {
            fs::write(path, "half").unwrap();
            let file = OpenOptions::new().write(true).open(path).unwrap();
            file.set_modified(SystemTime::now() - 2 * LONG_AGO).unwrap();
        }
        let young = beside(&target, ended());
        fs::write(&young, "half").unwrap();
        replace(&target, b"whole", Worth::Product).unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"whole");
        assert!(!old[0].exists(), "its process has ended, long ago");
        assert!(old[1].exists(), "its process still runs");
        assert!(old[2].exists() && old[3].exists(), "they are of other files");
        assert!(young.exists(), "it was written a moment ago");
    }
}
