//! Finds the files that other files refer to.
//!
//! Names come from other machines. They contain backslashes, folders that exist only there, a
//! different case, decomposed accents (macOS), escaped blanks (`my\ wood.png`) or URL encoding
//! (`my%20wood.png`). The search therefore tries the name as given, then its last part in the
//! folder of the referring file, then both without regard to case and accents, then other
//! spellings.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

use percent_encoding::percent_decode_str;
use unicode_normalization::UnicodeNormalization;

/// The most words of a line of names that are considered.
const MOST_WORDS: usize = 1000;

/// The names in a folder, by their [`key`].
type Listing = BTreeMap<String, OsString>;

/// Listings for the next locators, each with the time of the last change of its folder: thousands
/// of models in one folder would list it thousands of times.
static KEPT: Mutex<BTreeMap<PathBuf, (SystemTime, Arc<Listing>)>> = Mutex::new(BTreeMap::new());

/// The most listings that are kept.
const MOST_KEPT: usize = 16;

/// File systems store times in steps of up to two seconds, so a listing is kept only if the last
/// change of its folder was earlier.
const SETTLED: Duration = Duration::from_secs(3);

/// Searches for files, and caches the content of folders.
#[derive(Debug, Default)]
pub(super) struct Locator {
    listings: BTreeMap<PathBuf, Arc<Listing>>,
}

impl Locator {
    /// Finds the file that `name` refers to, relative to `folder`.
    pub(super) fn locate(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        self.locate_spelled(folder, name).or_else(|| {
            let others = spellings(name);
            others.into_iter().find_map(|name| self.locate_spelled(folder, &name))
        })
    }

    /// Works like [`Self::locate`], without other spellings of the name.
    fn locate_spelled(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        let name = plain(name);
        // Longer names exceed the limit of every system.
        if name.is_empty() || name.len() > 4096 {
            return None;
        }
        let last = name.rsplit('/').next().unwrap_or(&name);
        let file = |path: PathBuf| path.is_file().then_some(path);
        // A pipe or a device counts as found; reading it will report why it is rejected.
        let other = |path: PathBuf| (path.exists() && !path.is_dir()).then_some(path);
        // The cheapest lookups come first; listing a folder is slow.
        file(folder.join(&name))
            .or_else(|| file(folder.join(last)))
            .or_else(|| self.any_case(folder, &name))
            .or_else(|| self.any_case(folder, last))
            .or_else(|| other(folder.join(&name)))
    }

    /// Follows a relative name from `folder`, without regard to case.
    fn any_case(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        if name.starts_with('/') {
            return None;
        }
        let mut path = folder.to_owned();
        for part in name.split('/') {
            if part == "." || part == ".." {
                path.push(part);
                continue;
            }
            let name = self.listing(&path).get(&key(part))?.clone();
            path.push(name);
        }
        path.is_file().then_some(path)
    }

    /// Lists a folder at its first use.
    fn listing(&mut self, folder: &Path) -> &Listing {
        self.listings.entry(folder.to_owned()).or_insert_with(|| kept_listing(folder))
    }

    /// Finds the files that a line of names refers to. Names are separated by blanks and may
    /// contain blanks.
    ///
    /// At each word, the longest run of words that names a file is taken. If no run is a file, the
    /// missing name extends to the first word with the expected extension.
    pub(super) fn locate_all(
        &mut self,
        folder: &Path,
        names: &str,
        ending: &str,
    ) -> Vec<(String, Option<PathBuf>)> {
        let whole = self.locate(folder, names);
        if whole.is_some() {
            return vec![(names.to_owned(), whole)];
        }
        let words: Vec<&str> = names.split_whitespace().take(MOST_WORDS).collect();
        let mut found = Vec::new();
        let mut at = 0;
        while at < words.len() {
            // Each extra word costs a disk access, and no name has more than 16 words.
            let longest = words.len().min(at + 16);
            let run = (at + 1..=longest).rev().find_map(|end| {
                let name = words[at..end].join(" ");
                self.locate(folder, &name).map(|path| (end, name, Some(path)))
            });
            let ends = |word: &&str| word.to_ascii_lowercase().ends_with(ending);
            let (end, name, path) = run.unwrap_or_else(|| {
                let end = words[at..].iter().position(ends).map_or(words.len(), |i| at + i + 1);
                (end, words[at..end].join(" "), None)
            });
            found.push((name, path));
            at = end;
        }
        found
    }
}

/// Finds the file with the name of a model, in the usual spellings only, since every model of a
/// folder searches for several.
pub(super) fn of_model(folder: &Path, stem: &str, ending: &str) -> Option<PathBuf> {
    let (lower, upper) = (stem.to_lowercase(), stem.to_uppercase());
    let loud = ending.to_uppercase();
    [(stem, ending), (stem, &loud), (&lower, ending), (&upper, &loud)]
        .map(|(stem, ending)| folder.join(format!("{stem}.{ending}")))
        .into_iter()
        .find(|path| path.is_file())
}

/// Returns the kept listing of a folder, or lists the folder if it may have changed.
fn kept_listing(folder: &Path) -> Arc<Listing> {
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let changed = here.metadata().and_then(|data| data.modified()).ok();
    let settled =
        changed.filter(|changed| changed.elapsed().is_ok_and(|elapsed| elapsed > SETTLED));
    let (Some(settled), Ok(place)) = (settled, std::path::absolute(here)) else {
        return Arc::new(listing(here));
    };
    let kept = || KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, names)) = kept().get(&place).filter(|(changed, _)| *changed == settled) {
        return names.clone();
    }
    let names = Arc::new(listing(here));
    let mut kept = kept();
    if kept.len() >= MOST_KEPT {
        kept.clear();
    }
    kept.insert(place, (settled, names.clone()));
    names
}

/// Lists the names in a folder; among equal keys the first name wins, as the entries of a folder
/// have no reliable order.
fn listing(folder: &Path) -> Listing {
    let mut listing = Listing::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let kept = listing.entry(key(&name.to_string_lossy())).or_insert_with(|| name.clone());
        if name < *kept {
            *kept = name;
        }
    }
    listing
}

/// Returns a name with slashes, without the quotation marks that some programs add.
pub(super) fn plain(name: &str) -> String {
    let name = name.trim();
    let unquoted = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name);
    let slashes = unquoted.replace('\\', "/");
    // One slash at most: with two, a model could make Windows log in to another machine.
    let lead = if slashes.starts_with('/') { "/" } else { "" };
    let parts: Vec<&str> = slashes.split('/').filter(|part| !part.is_empty()).collect();
    format!("{lead}{}", parts.join("/"))
}

/// Returns a name in lower case and NFC, for comparisons.
fn key(name: &str) -> String {
    match name.is_ascii() {
        true => name.to_ascii_lowercase(),
        false => name.to_lowercase().nfc().collect(),
    }
}

/// Returns other spellings of a name: with escaped blanks and with percent-encoding resolved.
fn spellings(name: &str) -> Vec<String> {
    let unescaped = name.replace("\\ ", " ");
    let decoded = percent_decode_str(name).decode_utf8().map(String::from).unwrap_or_default();
    let decoded = decoded.strip_prefix("file://").unwrap_or(&decoded).to_owned();
    let is_other = |other: &String| !other.is_empty() && other != name;
    [unescaped, decoded].into_iter().filter(is_other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_found_by_every_spelling_of_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["my wood.png", "Café.png", "50%.png", "Ça va.mtl"];
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let mut locator = Locator::default();
        for (name, file) in [
            (r"my\ wood.png", "my wood.png"),
            ("my%20wood.png", "my wood.png"),
            ("MY%20Wood.PNG", "my wood.png"),
            ("file:///home/me/my%20wood.png", "my wood.png"),
            (r"C:\textures\my wood.png", "my wood.png"),
            (r"\\server\textures\my wood.png", "my wood.png"),
            ("Cafe\u{301}.png", "Café.png"),
            ("caf%C3%A9.png", "Café.png"),
            ("50%.png", "50%.png"),
            ("C\u{327}a va.mtl", "Ça va.mtl"),
        ] {
            // Windows finds names in any case; the canonical path has that of the file.
            let found =
                locator.locate(folder.path(), name).map(|path| path.canonicalize().unwrap());
            assert_eq!(found, Some(folder.path().join(file).canonicalize().unwrap()), "{name}");
        }
        for name in ["my_wood.png", "%zz.png", "", "%2e%2e"] {
            assert_eq!(locator.locate(folder.path(), name), None, "{name}");
        }
    }

    /// Windows opens no folders as files.
    #[cfg(unix)]
    #[test]
    fn a_kept_listing_is_of_no_use_once_its_folder_changes() {
        let folder = tempfile::tempdir().unwrap();
        let found = |name: &str| Locator::default().locate(folder.path(), name).is_some();
        let settle = |seconds| {
            let then = SystemTime::now() - Duration::from_secs(seconds);
            std::fs::File::open(folder.path()).unwrap().set_modified(then).unwrap();
        };
        std::fs::write(folder.path().join("Wood.png"), "").unwrap();
        settle(20);
        assert!(found("WOOD.PNG") && !found("OAK.PNG"));
        std::fs::write(folder.path().join("Oak.png"), "").unwrap();
        assert!(found("OAK.PNG"));
        std::fs::write(folder.path().join("Pine.png"), "").unwrap();
        assert!(found("PINE.PNG"));
        settle(20);
        assert!(found("PINE.PNG"));
        std::fs::remove_file(folder.path().join("Pine.png")).unwrap();
        assert!(!found("PINE.PNG"));
    }

    #[test]
    fn escaped_names_in_a_list_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["my wood.mtl", "b.mtl"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = Locator::default().locate_all(folder.path(), r"my\ wood.mtl b.mtl", ".mtl");
        assert!(found.len() == 2 && found.iter().all(|(_, path)| path.is_some()), "{found:?}");
    }
}
