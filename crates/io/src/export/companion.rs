//! Decides whether an export may replace a companion file: an MTL file, a texture or a buffer.
//!
//! The user names only the main file, so an existing companion is overwritten only if an earlier
//! export wrote it. Text files and encoded textures carry a signature. Other companions, such as
//! buffers and copied textures, count as ours if an exported text refers to them. A file with the
//! same content may be replaced in any case.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use memchr::memmem::find;

use crate::mark::{MARK, escaped, is_signed};
use crate::replace::{SaveError, check_target};

/// The text by which a glTF file shows that this program wrote it.
const GENERATOR: &[u8] = br#""generator":"Marraztu""#;

/// The first bytes of a PNG file.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Checks that a companion file with this content is new, or was written by an earlier export to
/// `main`.
pub(super) fn check_companion(
    companion: &Path,
    content: &[u8],
    main: &Path,
) -> Result<(), SaveError> {
    check_target(companion)?;
    let is_new = fs::symlink_metadata(companion).is_err();
    let texts = [main.to_owned(), main.with_extension("mtl")];
    let may_replace = is_new
        || is_ours(companion)
        || texts.iter().any(|text| names(text, companion))
        || has_content(companion, content);
    if may_replace {
        return Ok(());
    }
    let reason = format!(
        "{} exists and was not written by an export; choose another name",
        companion.display()
    );
    Err(SaveError::new(main, reason))
}

/// Returns whether a file begins with the signature, or is a picture with the mark among its first
/// chunks.
fn is_ours(file: &Path) -> bool {
    let mut begin = Vec::new();
    let read = File::open(file).and_then(|file| file.take(256).read_to_end(&mut begin));
    let is_marked = || begin.starts_with(PNG) && find(&begin, MARK.as_bytes()).is_some();
    read.is_ok() && (is_signed(&begin) || is_marked())
}

/// Returns whether a file has this content already.
fn has_content(file: &Path, content: &[u8]) -> bool {
    let length = fs::metadata(file).map(|metadata| usize::try_from(metadata.len()));
    length.is_ok_and(|length| length == Ok(content.len()))
        && fs::read(file).is_ok_and(|own| own == content)
}

/// Returns whether a text was exported by this program and names the companion.
fn names(text: &Path, companion: &Path) -> bool {
    let Ok(text) = fs::read(text) else { return false };
    let name = companion.file_name().unwrap_or_default().to_string_lossy();
    let is_ours = is_signed(&text) || find(&text, GENERATOR).is_some();
    is_ours && [&*name, &escaped(&name)].iter().any(|name| find(&text, name.as_bytes()).is_some())
}
