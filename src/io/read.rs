//! Files into memory, none larger than anyone means.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::error::{LoadError, short_name};
use super::progress::Progress;

/// The most bytes of a text that describes shapes.
pub(super) const MOST_SHAPES: usize = 4 << 30;

/// The most bytes of a text that describes materials or a scene.
pub(super) const MOST_WORDS: usize = 64 << 20;

/// How much is read between two looks at the progress.
const PIECE: usize = 8 << 20;

/// Reads a file in pieces, so that it can be watched and cancelled. `sound` looks at the first piece,
/// and says what is wrong with it where the rest is of no use.
///
/// # Errors
/// Where it cannot be read, has more than `most` bytes, or is not sound; and where `progress` is
/// cancelled.
pub(super) fn read(
    path: &Path,
    most: usize,
    sound: impl FnOnce(&[u8]) -> Option<String>,
    progress: &Progress,
) -> Result<Vec<u8>, LoadError> {
    let file = short_name(path);
    let system = |error: std::io::Error| LoadError::system(&file, &error);
    let too_large = || LoadError::file(&file, format!("it is larger than {} MB", most >> 20));
    let mut handle = File::open(path).map_err(system)?;
    let metadata = handle.metadata().map_err(system)?;
    if metadata.is_dir() {
        return Err(LoadError::file(&file, "this is a folder, not a file"));
    }
    let size = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
    if size > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    bytes
        .try_reserve(size + 1)
        .map_err(|_full| LoadError::file(&file, "there is not enough memory for it"))?;
    let mut sound = Some(sound);
    loop {
        let limit = u64::try_from(PIECE).unwrap_or(u64::MAX);
        let piece = handle.by_ref().take(limit).read_to_end(&mut bytes).map_err(system)?;
        if let Some(reason) = sound.take().and_then(|sound| sound(&bytes)) {
            return Err(LoadError::file(&file, reason));
        }
        // What is no file on a disk does not say how large it is.
        if bytes.len() > most {
            return Err(too_large());
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
        let read = |most| read(&path, most, |_| None, &Progress::new());
        assert_eq!(read(3 << 20).unwrap().len(), 3 << 20);
        let refusal = "a: it is larger than 2 MB";
        assert_eq!(read((3 << 20) - 1).unwrap_err().to_string(), refusal);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_has_no_end_is_read_no_farther_than_that() {
        let read = |sound: fn(&[u8]) -> Option<String>| {
            read(Path::new("/dev/zero"), 1 << 20, sound, &Progress::new()).unwrap_err().to_string()
        };
        assert_eq!(read(|_| None), "zero: it is larger than 1 MB");
        assert_eq!(read(|_| Some("no".to_owned())), "zero: no");
    }
}
