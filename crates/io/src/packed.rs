//! Unpacks gzip files.

use std::borrow::Cow;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::error::LoadError;
use super::progress::Progress;
use super::read::{MOST_MODEL_BYTES, open, read};

/// The first bytes of every gzip archive (RFC 1952, section 2.3.1).
pub(super) const MAGIC: &[u8] = b"\x1F\x8B";

/// The number of unpacked bytes between two progress checks.
const PIECE: usize = 8 << 20;

/// The extension of gzip files.
const ENDING: &str = ".gz";

/// Removes the extension of gzip; `None` if the name has another one.
pub(super) fn unpacked_name(name: &str) -> Option<&str> {
    let (stem, ending) = name.split_at_checked(name.len().checked_sub(ENDING.len())?)?;
    ending.eq_ignore_ascii_case(ENDING).then_some(stem)
}

/// A reader that unpacks its source. The caller limits the number of bytes.
pub(super) struct Unpacked<R>(MultiGzDecoder<R>);

impl<R: Read> Unpacked<R> {
    pub(super) fn new(packed: R) -> Self {
        Self(MultiGzDecoder::new(packed))
    }
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        self.0.read(bytes).map_err(|error| match error.kind() {
            ErrorKind::InvalidInput | ErrorKind::InvalidData | ErrorKind::UnexpectedEof => {
                Error::other("the gzip archive is damaged")
            }
            _ => error,
        })
    }
}

/// Returns the name of the model in a file: the file's name without folders and extensions.
pub(super) fn model_name(file: &str) -> Cow<'_, str> {
    let stem = Path::new(unpacked_name(file).unwrap_or(file)).file_stem();
    stem.unwrap_or_default().to_string_lossy()
}

/// Reads the model at `path`, named `file` in messages, and unpacks it if it is packed. Fails if it
/// cannot be read, is damaged or too large, or `progress` is cancelled.
pub(super) fn unpacked(path: &Path, file: &str, progress: &Progress) -> Result<Vec<u8>, LoadError> {
    unpacked_within(path, file, MOST_MODEL_BYTES, progress)
}

/// Works like [`unpacked`], for at most `most` bytes.
fn unpacked_within(
    path: &Path,
    file: &str,
    most: usize,
    progress: &Progress,
) -> Result<Vec<u8>, LoadError> {
    if unpacked_name(file).is_none() {
        return read(path, most, progress);
    }
    let (packed, size) = open(path, most)?;
    let mut unpacker = Unpacked::new(packed);
    let mut text = Vec::new();
    let limit = u64::try_from(PIECE).unwrap_or(u64::MAX);
    loop {
        let piece = unpacker.by_ref().take(limit).read_to_end(&mut text);
        let piece = piece.map_err(|error| LoadError::system(file, &error))?;
        if text.len() > most {
            return Err(LoadError::too_large(file, most));
        }
        // Text is typically four times as large as its archive.
        progress.reached(text.len(), 4 * size)?;
        if piece == 0 {
            return Ok(text);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    #[test]
    fn an_archive_of_more_than_the_limit_is_refused_and_not_cut() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl.gz");
        let mut archive = GzEncoder::new(File::create(&path).unwrap(), Compression::default());
        archive.write_all(&vec![b' '; 3 << 20]).unwrap();
        archive.finish().unwrap();
        let unpacked = |most| unpacked_within(&path, "a.stl.gz", most, &Progress::new());
        assert_eq!(unpacked(3 << 20).unwrap().len(), 3 << 20);
        let refusal = unpacked((3 << 20) - 1).unwrap_err().to_string();
        assert_eq!(refusal, "a.stl.gz: the file is larger than 2 MB");
    }

    #[test]
    fn only_names_with_the_ending_are_of_packed_files() {
        assert_eq!(unpacked_name("teapot.obj.gz"), Some("teapot.obj"));
        assert_eq!(unpacked_name("teapot.obj.GZ"), Some("teapot.obj"));
        for other in ["teapot.obj", "gz", "", "\u{e9}\u{e9}", "a.gz.obj"] {
            assert_eq!(unpacked_name(other), None, "{other}");
        }
    }
}
