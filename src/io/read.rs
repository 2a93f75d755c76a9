//! Files into memory, none larger than anyone means.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::{LoadError, short_name};
use super::progress::Progress;

/// The most bytes of a text that describes materials or a scene.
pub(super) const MOST_WORDS: usize = 64 << 20;

/// How much is read between two looks at the progress.
const PIECE: usize = 8 << 20;

/// Finds out whether there is a file at `path`, without reading it.
///
/// # Errors
/// If there is none, or it is a folder.
pub fn check_file(path: &Path) -> Result<(), LoadError> {
    let file = short_name(path);
    let metadata = path.metadata().map_err(|error| LoadError::system(&file, &error))?;
    if metadata.is_dir() {
        return Err(LoadError::file(&file, "this is a folder, not a file"));
    }
    Ok(())
}

/// Opens a file of at most so many bytes; says how many it has, where that is known before.
///
/// # Errors
/// Where it cannot be opened, is a folder, or has more.
pub(super) fn open(path: &Path, most: usize) -> Result<(File, usize), LoadError> {
    let file = short_name(path);
    let system = |error: std::io::Error| LoadError::system(&file, &error);
    let handle = File::open(path).map_err(system)?;
    let metadata = handle.metadata().map_err(system)?;
    if metadata.is_dir() {
        return Err(LoadError::file(&file, "this is a folder, not a file"));
    }
    let size = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
    if size > most { Err(LoadError::too_large(&file, most)) } else { Ok((handle, size)) }
}

/// Reads a file in pieces, so that it can be watched and cancelled.
///
/// # Errors
/// Where it cannot be read or has more than `most` bytes; and where `progress` is cancelled.
pub(super) fn read(path: &Path, most: usize, progress: &Progress) -> Result<Vec<u8>, LoadError> {
    let file = short_name(path);
    let (mut handle, size) = open(path, most)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve(size + 1)
        .map_err(|_full| LoadError::file(&file, "there is not enough memory for it"))?;
    loop {
        let limit = u64::try_from(PIECE).unwrap_or(u64::MAX);
        let piece = handle.by_ref().take(limit).read_to_end(&mut bytes);
        let piece = piece.map_err(|error| LoadError::system(&file, &error))?;
        // What is no file on a disk does not say how large it is.
        if bytes.len() > most {
            return Err(LoadError::too_large(&file, most));
        }
        progress.reached(bytes.len(), size)?;
        if piece == 0 {
            return Ok(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_larger_than_anyone_means_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, vec![b' '; 3 << 20]).unwrap();
        let read = |most| read(&path, most, &Progress::new());
        assert_eq!(read(3 << 20).unwrap().len(), 3 << 20);
        let refusal = "a: it is larger than 2 MB";
        assert_eq!(read((3 << 20) - 1).unwrap_err().to_string(), refusal);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_has_no_end_is_read_no_farther_than_that() {
        let refusal = read(Path::new("/dev/zero"), 1 << 20, &Progress::new()).unwrap_err();
        assert_eq!(refusal.to_string(), "zero: it is larger than 1 MB");
    }
}
