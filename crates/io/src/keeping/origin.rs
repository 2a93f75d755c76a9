//! The first lines of a file of unsaved work, which name the scene file that it changes.

use std::fs;
use std::path::{Path, PathBuf};

use crate::fingerprint::Fingerprint;

/// The prefix of the first line: a comment in the scene file, followed by the path in quotes.
const HEAD: &str = "// unsaved changes of ";

/// The prefix of the second line, followed by the content of that file when the work began.
const CONTENT: &str = "// its content was ";

/// Formats the first lines for work on the scene in `file` with this content.
pub(super) fn head(file: Option<&Path>, content: Option<Fingerprint>) -> String {
    let content = content.map_or_else(String::new, |it| format!("{CONTENT}{}\n", it.text()));
    match file.and_then(Path::to_str).map(ron::to_string) {
        Some(Ok(quoted)) => format!("{HEAD}{quoted}\n{content}"),
        _ => String::new(),
    }
}

/// Reads the path in the first line and the content in the second.
pub(super) fn origin(work: &Path) -> (Option<PathBuf>, Option<Fingerprint>) {
    let text = fs::read_to_string(work).unwrap_or_default();
    let mut lines = text.lines();
    let quoted = lines.next().and_then(|line| line.strip_prefix(HEAD));
    let file = quoted.and_then(|quoted| ron::from_str::<PathBuf>(quoted).ok());
    let content = lines.next().and_then(|line| line.strip_prefix(CONTENT));
    (file, content.and_then(Fingerprint::from_text))
}
