//! Unpacks gzip files.

use std::borrow::Cow;
use std::io::{Error, ErrorKind, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::error::LoadError;
use super::obj::MOST_BYTES;
use super::progress::Progress;
use super::read::{open, read};

/// The first bytes of every gzip archive (RFC 1952, section 2.3.1).
pub(super) const MAGIC: &[u8] = b"\x1F\x8B";

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
/// cannot be read, or is damaged.
pub(super) fn unpacked(path: &Path, file: &str) -> Result<Vec<u8>, LoadError> {
    if unpacked_name(file).is_none() {
        return read(path, MOST_BYTES, &Progress::new());
    }
    let (packed, _) = open(path, MOST_BYTES)?;
    let mut text = Vec::new();
    let limit = u64::try_from(MOST_BYTES).unwrap_or(u64::MAX);
    let read = Unpacked::new(packed).take(limit).read_to_end(&mut text);
    read.map_err(|error| LoadError::system(file, &error))?;
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_with_the_ending_are_of_packed_files() {
        assert_eq!(unpacked_name("teapot.obj.gz"), Some("teapot.obj"));
        assert_eq!(unpacked_name("teapot.obj.GZ"), Some("teapot.obj"));
        for other in ["teapot.obj", "gz", "", "\u{e9}\u{e9}", "a.gz.obj"] {
            assert_eq!(unpacked_name(other), None, "{other}");
        }
    }
}
