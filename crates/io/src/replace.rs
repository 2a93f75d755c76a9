//! Writes files without losing the old content if writing fails.
//!
//! The new content is written to a temporary file in the same folder, which then replaces the old
//! file atomically: a reader always finds a complete file. The user's own work is flushed to disk
//! first, so it survives even a power failure.
//!
//! Temporary files are named by [`super::part`], which also removes the ones of killed processes.

use std::fs::{self, File};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{MAIN_SEPARATOR, Path, PathBuf};
use std::time::Duration;

use super::error::{reason, shown};
use super::part::{create_part, folder, sweep_once};
use super::read::kind;
use super::scene_file::paths::plain;

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

/// Checks whether a file can be written at `path`: its folder exists and is writable. Fails if it
/// cannot.
pub(super) fn check_target(path: &Path) -> Result<(), SaveError> {
    let target = target(path)?;
    check_folder(path, &target)?;
    // Permissions are checked by creating the temporary file.
    match create_part(&target).map(|(_file, part)| fs::remove_file(part)) {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == ErrorKind::PermissionDenied => {
            let reason = format!("no permission to write to {}", folder_name(&target));
            Err(SaveError::new(path, reason))
        }
        Err(error) => Err(SaveError::new(path, reason(&error))),
    }
}

/// Checks that a path is not an address such as `s3://pictures/a.png`, which would create the
/// folder `s3:`.
///
/// # Errors
/// If it is one.
pub fn check_scheme(path: &Path) -> Result<(), SaveError> {
    let text = path.to_string_lossy();
    let is_letter = |sign: char| sign.is_ascii_alphanumeric() || "+-.".contains(sign);
    match text.split_once("://") {
        Some((scheme, _)) if !scheme.is_empty() && scheme.chars().all(is_letter) => {
            let reason = format!(
                "addresses ({scheme}://) cannot be written to; choose a file or folder of this \
                 machine, and copy it there afterwards"
            );
            Err(SaveError::new(path, reason))
        }
        _ => Ok(()),
    }
}

/// The most links that are followed, as on Linux.
const MOST_LINKS: usize = 40;

/// Returns the file to replace. Links are followed and stay links, even to a missing file.
fn target(path: &Path) -> Result<PathBuf, SaveError> {
    check_scheme(path)?;
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        let Ok(next) = fs::read_link(&target) else { break };
        // A relative link is relative to the folder that contains it.
        target = folder(&target).join(next);
    }
    let target = fs::canonicalize(&target).map_or(target, |canonical| plain(&canonical));
    if target.is_symlink() {
        return Err(SaveError::new(path, "its symbolic links form a loop"));
    }
    // A device or a pipe would be replaced by a file.
    if let Some(kind) = fs::metadata(&target).ok().and_then(|it| kind(it.file_type())) {
        return Err(SaveError::new(path, format!("this is {kind}, not a file")));
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

/// Formats the folder of a file for messages.
fn folder_name(target: &Path) -> String {
    format!("the folder {}{MAIN_SEPARATOR}", folder(target).display())
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
    sweep_once(folder(&target));
    let (mut file, part) = create_part(&target).map_err(fail)?;
    let written = content(&mut file).and_then(|()| put(file, &part, &target, worth));
    if written.is_err() {
        // If even this fails, nothing more can be done.
        let _ = fs::remove_file(&part);
    }
    written.map_err(fail)
}

/// A file that is written piece by piece. It appears at its path when it is finished.
#[derive(Debug)]
pub struct NewFile {
    /// The path as the user gave it.
    path: PathBuf,
    target: PathBuf,
    part: PathBuf,
    /// `None` after the end.
    file: Option<BufWriter<File>>,
}

impl NewFile {
    /// Creates the file next to its path.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn begin(path: &Path) -> Result<Self, SaveError> {
        let target = target(path)?;
        check_folder(path, &target)?;
        sweep_once(folder(&target));
        let (file, part) =
            create_part(&target).map_err(|error| SaveError::new(path, reason(&error)))?;
        Ok(Self { path: path.to_owned(), target, part, file: Some(BufWriter::new(file)) })
    }

    /// Appends a piece.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn push(&mut self, piece: &[u8]) -> Result<(), SaveError> {
        let written = self.file.as_mut().map_or(Ok(()), |file| file.write_all(piece));
        written.map_err(|error| SaveError::new(&self.path, reason(&error)))
    }

    /// Replaces the file at the path.
    ///
    /// # Errors
    /// If it cannot be written; an existing file is unchanged.
    pub fn finish(mut self) -> Result<(), SaveError> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let file = file.into_inner().map_err(std::io::IntoInnerError::into_error);
        let written = file.and_then(|file| put(file, &self.part, &self.target, Worth::Product));
        if written.is_err() {
            let _ = fs::remove_file(&self.part);
        }
        written.map_err(|error| SaveError::new(&self.path, reason(&error)))
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        // An unfinished file is removed.
        if self.file.take().is_some() {
            let _ = fs::remove_file(&self.part);
        }
    }
}

/// Moves a complete temporary file to its target.
fn put(file: File, part: &Path, target: &Path, worth: Worth) -> std::io::Result<()> {
    if let Ok(old) = fs::metadata(target) {
        // Keeps the permissions, if the file system supports them.
        let _ = file.set_permissions(old.permissions());
    }
    if worth != Worth::Product {
        file.sync_all()?;
    }
    // On Windows, an open file could not be replaced by another thread.
    drop(file);
    if worth == Worth::Product {
        return rename(part, target);
    }
    // A hard link keeps the old file at its name until the rename; copying is the fallback.
    if worth == Worth::Work && target.exists() {
        let kept = with_ending(target, "~");
        let _ = fs::remove_file(&kept);
        if fs::hard_link(target, &kept).is_err() {
            fs::copy(target, &kept)?;
        }
    }
    rename(part, target)?;
    // Flushing the folder makes the new name survive a power failure; not every system supports it.
    let _ = File::open(folder(target)).and_then(|folder| folder.sync_all());
    Ok(())
}

/// Renames a file, which replaces another one. On Windows, another thread or a virus scanner may
/// have either open for a moment, so it is tried again, as git does.
fn rename(from: &Path, to: &Path) -> std::io::Result<()> {
    let waits: &[u64] = if cfg!(windows) { &[1, 10, 20, 40] } else { &[] };
    for wait in waits {
        match fs::rename(from, to) {
            Err(error) if error.kind() == ErrorKind::PermissionDenied => {
                std::thread::sleep(Duration::from_millis(*wait));
            }
            done => return done,
        }
    }
    fs::rename(from, to)
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_in_pieces_appears_when_it_is_finished_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.jsonl");
        let count = || fs::read_dir(folder.path()).unwrap().count();
        let mut file = NewFile::begin(&path).unwrap();
        file.push(b"one\n").unwrap();
        assert_eq!((path.exists(), count()), (false, 1));
        drop(file);
        assert_eq!(count(), 0, "an unfinished file is removed");
        let mut file = NewFile::begin(&path).unwrap();
        file.push(b"one\n").unwrap();
        file.push(b"two\n").unwrap();
        file.finish().unwrap();
        assert_eq!((fs::read(&path).unwrap(), count()), (b"one\ntwo\n".to_vec(), 1));
        assert!(NewFile::begin(&folder.path().join("none/r.jsonl")).is_err());
    }
}
