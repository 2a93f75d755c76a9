//! Reads files into memory, up to a size limit.

use std::fs::{File, FileType, Metadata};
use std::io::{Chain, Cursor, Read, Seek};
use std::path::Path;

use super::error::{LFS_POINTER, LoadError, NO_MEMORY, shown};
use super::progress::Progress;

/// The most bytes in a text.
pub(super) const MOST_MODEL_BYTES: usize = if usize::BITS > 32 { 4 << 30 } else { 1 << 30 };

/// The most bytes of a text of materials.
pub(super) const MOST_WORDS: usize = 64 << 20;

/// The size in bytes from which UTF-16 texts are rejected.
const MOST_UTF_16: u64 = 1 << 30;

/// The number of bytes between two progress checks.
const PIECE: usize = 8 << 20;

/// The first bytes of the files that Git LFS writes in place of contents, and of its predecessor's.
const LFS_POINTERS: [&[u8]; 2] =
    [b"version https://git-lfs.github.com/spec/", b"version https://hawser.github.com/spec/"];

/// The largest size of an LFS pointer, by its specification.
const LARGEST_POINTER: u64 = 1024;

/// Opens a file of at most `most` bytes, and returns its size as far as it is known. Fails if it
/// cannot be opened, is not a file, is larger, or is a Git LFS pointer.
pub(super) fn open(path: &Path, most: usize) -> Result<(File, usize), LoadError> {
    let metadata = readable(path)?;
    let size = usize::try_from(metadata.len()).unwrap_or(usize::MAX);
    if size > most {
        return Err(LoadError::too_large(&shown(path), most));
    }
    let system = |error: std::io::Error| LoadError::system(&shown(path), &error);
    let mut handle = File::open(path).map_err(system)?;
    // A pipe has no size, and cannot be rewound.
    if metadata.is_file() && (1..=LARGEST_POINTER).contains(&metadata.len()) {
        let mut head = Vec::new();
        handle.by_ref().take(LARGEST_POINTER).read_to_end(&mut head).map_err(system)?;
        if is_lfs_pointer(&head) {
            return Err(LoadError::file(&shown(path), LFS_POINTER));
        }
        handle.rewind().map_err(system)?;
    }
    Ok((handle, size))
}

/// Returns whether a file with these first bytes is a Git LFS pointer.
pub(super) fn is_lfs_pointer(head: &[u8]) -> bool {
    LFS_POINTERS.iter().any(|begin| head.starts_with(begin))
}

/// Rejects anything but a regular file before it is opened: opening a pipe would wait for a writer.
/// A pipe that this program was started with, like `<(...)` in a shell, is already open and can be
/// read.
pub(super) fn readable(path: &Path) -> Result<Metadata, LoadError> {
    let file = shown(path);
    let metadata = std::fs::metadata(path).map_err(|error| LoadError::system(&file, &error))?;
    match kind(metadata.file_type()) {
        None => Ok(metadata),
        Some("a pipe") if is_inherited(path) => Ok(metadata),
        Some(kind) => Err(LoadError::file(&file, format!("this is {kind}, not a file"))),
    }
}

/// Describes a folder entry that is not a file.
pub(super) fn kind(kind: FileType) -> Option<&'static str> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return Some("a pipe");
        }
        if kind.is_socket() {
            return Some("a socket");
        }
        if kind.is_char_device() || kind.is_block_device() {
            return Some("a device");
        }
    }
    kind.is_dir().then_some("a folder")
}

/// Returns whether a path refers to a file that was open when this program was started.
fn is_inherited(path: &Path) -> bool {
    ["/dev/fd", "/proc/self/fd", "/dev/stdin"].iter().any(|begin| path.starts_with(begin))
}

/// Reads a whole file.
///
/// # Errors
/// If it cannot be read, or is not a file: a folder, a device, or a pipe that was not inherited.
pub fn read_file(path: &Path) -> Result<Vec<u8>, LoadError> {
    read(path, usize::MAX - 1, &Progress::new())
}

/// Reads a file in pieces, reporting progress and checking for cancellation in between. Fails if it
/// cannot be read, has more than `most` bytes, or `progress` is cancelled.
pub(super) fn read(path: &Path, most: usize, progress: &Progress) -> Result<Vec<u8>, LoadError> {
    let file = shown(path);
    let (mut handle, size) = open(path, most)?;
    let mut bytes = Vec::new();
    // One byte more than the size, so the last read detects the end without growing the buffer.
    bytes.try_reserve(size + 1).map_err(|_full| LoadError::file(&file, NO_MEMORY))?;
    loop {
        let limit = u64::try_from(PIECE).unwrap_or(u64::MAX);
        let piece = handle.by_ref().take(limit).read_to_end(&mut bytes);
        let piece = piece.map_err(|error| LoadError::system(&file, &error))?;
        // The size of a pipe is not known in advance.
        if bytes.len() > most {
            return Err(LoadError::too_large(&file, most));
        }
        progress.reached(bytes.len(), size)?;
        if piece == 0 {
            return Ok(bytes);
        }
    }
}

/// Returns whether a text begins with a UTF-16 byte-order mark.
pub(super) const fn is_utf_16(bytes: &[u8]) -> bool {
    matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..])
}

/// Converts UTF-16 with a byte-order mark to UTF-8; other texts are unchanged.
pub(super) fn utf_8(bytes: Vec<u8>) -> Vec<u8> {
    let unit = match bytes[..] {
        [0xFF, 0xFE, ..] => u16::from_le_bytes,
        [0xFE, 0xFF, ..] => u16::from_be_bytes,
        _ => return bytes,
    };
    let (units, _) = bytes[2..].as_chunks();
    let signs = char::decode_utf16(units.iter().map(|two| unit(*two)));
    let text: String = signs.map(|sign| sign.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    text.into_bytes()
}

/// Wraps a text, converted to UTF-8 if it is UTF-16. The conversion is done in memory, which limits
/// the size.
pub(super) fn in_utf_8<R: Read + Send>(
    mut text: R,
    file: &str,
) -> Result<Chain<Cursor<Vec<u8>>, R>, LoadError> {
    let mut head = Vec::new();
    let read = text.by_ref().take(2).read_to_end(&mut head).and_then(|_| {
        let rest = if is_utf_16(&head) { MOST_UTF_16 } else { 0 };
        text.by_ref().take(rest).read_to_end(&mut head)
    });
    let rest = read.map_err(|error| LoadError::system(file, &error))?;
    if rest as u64 == MOST_UTF_16 {
        return Err(LoadError::file(file, "this UTF-16 text is too large; save it as UTF-8"));
    }
    Ok(Cursor::new(utf_8(head)).chain(text))
}

/// Returns whether bytes are not text. Trailing NULs, which some programs write, and a few control
/// characters are allowed.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let end = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let is_control = |byte: &&u8| **byte < b' ' && !byte.is_ascii_whitespace();
    let controls = bytes[..end].iter().filter(is_control).count();
    controls * 16 > end
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
        let refusal = format!("{}: the file is larger than 2 MB", path.display());
        assert_eq!(read((3 << 20) - 1).unwrap_err().to_string(), refusal);
    }

    #[test]
    fn a_pointer_of_git_lfs_is_refused_and_a_text_about_one_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n";
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read(&path, 1 << 20, &Progress::new())
        };
        let refusal = read(pointer).unwrap_err().to_string();
        assert_eq!(refusal, format!("{}: {LFS_POINTER}", path.display()));
        let comment = format!("# {pointer}");
        assert_eq!(read(&comment).unwrap(), comment.as_bytes(), "from its first byte");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_file_that_does_not_say_how_large_it_is_is_read_no_farther_than_allowed() {
        let refusal = read(Path::new("/proc/self/stat"), 10, &Progress::new()).unwrap_err();
        assert_eq!(refusal.to_string(), "/proc/self/stat: the file is larger than 0 MB");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_device_is_refused() {
        let refusal = read(Path::new("/dev/zero"), 1 << 20, &Progress::new()).unwrap_err();
        assert_eq!(refusal.to_string(), "/dev/zero: this is a device, not a file");
    }

    #[test]
    fn a_text_of_utf_16_becomes_one_of_utf_8() {
        let text = "v 1 2 3 # \u{e9}\u{1F600}";
        let units = || std::iter::once(0xFEFF).chain(text.encode_utf16());
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        assert_eq!([utf_8(little), utf_8(big)], [text.as_bytes(); 2]);
        assert_eq!(utf_8(text.into()), text.as_bytes());
        assert_eq!(utf_8(vec![0xFF, 0xFE, 0x00, 0xD8, 0x41]), "\u{FFFD}".as_bytes());
    }
}
