//! Finds the file that another file names.
//!
//! Names come from other machines: with backslashes, with folders that exist only there, in another
//! case. A name is therefore first taken as it is, then by its last part beside the file that names
//! it, then without regard to case.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// How many words of a line of names are considered.
const MOST_WORDS: usize = 1000;

/// Looks for files, and caches the content of folders.
#[derive(Debug, Default)]
pub(super) struct Locator {
    /// The names in a folder, by their lower case.
    listings: BTreeMap<PathBuf, BTreeMap<String, OsString>>,
}

impl Locator {
    /// The file that `name` refers to, relative to `folder`, if there is one.
    pub(super) fn locate(&mut self, folder: &Path, name: &str) -> Option<PathBuf> {
        let name = plain(name);
        // No system has longer names.
        if name.is_empty() || name.len() > 4096 {
            return None;
        }
        let last = name.rsplit('/').next().unwrap_or(&name);
        let file = |path: PathBuf| path.is_file().then_some(path);
        // A pipe or a device counts as found; reading it will give the reason why it is refused.
        let other = |path: PathBuf| (path.exists() && !path.is_dir()).then_some(path);
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
            let name = self.listing(&path).get(&part.to_lowercase())?.clone();
            path.push(name);
        }
        path.is_file().then_some(path)
    }

    /// The names in a folder, by their lower case; if two differ only by case, the first.
    fn listing(&mut self, folder: &Path) -> &BTreeMap<String, OsString> {
        self.listings.entry(folder.to_owned()).or_insert_with(|| {
            let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            let entries = std::fs::read_dir(here).into_iter().flatten();
            let mut names: Vec<_> =
                entries.filter_map(|entry| Some(entry.ok()?.file_name())).collect();
            // The entries of a folder have no reliable order, so the first by name is inserted
            // last.
            names.sort();
            names.reverse();
            names.into_iter().map(|name| (name.to_string_lossy().to_lowercase(), name)).collect()
        })
    }

    /// The files that a line of names refers to. Names are separated by blanks, and may contain
    /// blanks.
    ///
    /// From each word on, the longest run of words that is a file is one name. If no run is a file,
    /// a missing name goes up to the first word with the ending that all names have.
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
            // Every further word costs a look at the disk, and no name has more words than this.
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

/// A name with slashes, without the quotation marks that some programs write around it.
pub(super) fn plain(name: &str) -> String {
    let name = name.trim();
    let unquoted = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name);
    let slashes = unquoted.replace('\\', "/");
    let lead = if slashes.starts_with('/') { "/" } else { "" };
    let parts: Vec<&str> = slashes.split('/').filter(|part| !part.is_empty()).collect();
    format!("{lead}{}", parts.join("/"))
}
