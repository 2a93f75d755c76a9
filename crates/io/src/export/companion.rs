//! Decides whether an export may replace a companion file: an MTL file, a texture or a buffer.
//!
//! The user names only the main file, so an existing companion is overwritten only if an earlier
//! export wrote it. Text files carry a signature. A picture or a buffer counts as ours if an
//! exported text refers to it.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use memchr::memmem::find;

use super::{SIGNATURE, escaped};
use crate::replace::{SaveError, check_target};

/// The text by which a glTF file shows that this program wrote it.
const GENERATOR: &[u8] = br#""generator":"Marraztu""#;

/// Checks that a companion file is new, or was written by an earlier export to `main`.
pub(super) fn check_companion(companion: &Path, main: &Path) -> Result<(), SaveError> {
    check_target(companion)?;
    let is_new = fs::symlink_metadata(companion).is_err();
    let texts = [main.to_owned(), main.with_extension("mtl")];
    if is_new || is_signed(companion) || texts.iter().any(|text| names(text, companion)) {
        return Ok(());
    }
    let reason = format!(
        "{} exists and was not written by an export; choose another name",
        companion.display()
    );
    Err(SaveError::new(main, reason))
}

/// Returns whether a file begins with the signature.
fn is_signed(file: &Path) -> bool {
    let mut begin = vec![0; SIGNATURE.len()];
    let read = File::open(file).and_then(|mut file| file.read_exact(&mut begin));
    read.is_ok() && begin == SIGNATURE.as_bytes()
}

/// Returns whether a text was exported by this program and names the companion.
fn names(text: &Path, companion: &Path) -> bool {
    let Ok(text) = fs::read(text) else { return false };
    let name = companion.file_name().unwrap_or_default().to_string_lossy();
    let is_ours = text.starts_with(SIGNATURE.as_bytes()) || find(&text, GENERATOR).is_some();
    is_ours && [&*name, &escaped(&name)].iter().any(|name| find(&text, name.as_bytes()).is_some())
}
