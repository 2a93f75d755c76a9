//! Detects whether the content of a file has changed.
//!
//! The content is hashed because modification times are unreliable: some systems count whole
//! seconds, and a file that is copied back may have an old time.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use super::progress::Progress;
use super::read::{MOST_MODEL_BYTES, read};

/// A hash of the content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Fingerprint {
    pub(super) fn of(content: &[u8]) -> Self {
        let mut hasher = DefaultHasher::new();
        content.hash(&mut hasher);
        Self(hasher.finish())
    }

    /// Returns whether saving to `path` would overwrite different content. This is so if the file
    /// exists and was changed or cannot be read.
    pub fn differs_from(self, path: &Path) -> bool {
        match read(path, MOST_MODEL_BYTES, &Progress::new()) {
            Ok(content) => Self::of(&content) != self,
            Err(_) => path.exists(),
        }
    }

    /// Formats the hash for [`Self::from_text`].
    pub(super) fn text(self) -> String {
        format!("{:016x}", self.0)
    }

    pub(super) fn from_text(text: &str) -> Option<Self> {
        u64::from_str_radix(text, 16).ok().map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_content_of_the_same_length_and_time_is_noticed_and_a_missing_file_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, "one").unwrap();
        let one = Fingerprint::of(b"one");
        assert!(!one.differs_from(&path));
        assert_eq!(Fingerprint::from_text(&one.text()), Some(one));
        let time = std::fs::metadata(&path).unwrap().modified().unwrap();
        std::fs::write(&path, "two").unwrap();
        let file = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
        file.set_modified(time).unwrap();
        drop(file);
        assert!(one.differs_from(&path));
        std::fs::remove_file(&path).unwrap();
        assert!(!one.differs_from(&path));
        std::fs::create_dir(&path).unwrap();
        assert!(one.differs_from(&path));
    }
}
