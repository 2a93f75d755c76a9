//! Pairs the pictures of two folders by their relative paths.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use marraztu_io::texture_endings;

use crate::cli::batch::report::shown;

/// Two pictures to compare; one of them may be missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    /// The path within the folders, with slashes, or the name of the second picture.
    pub(super) name: String,
    /// The first and the second picture, if they exist.
    pub(super) files: [Option<PathBuf>; 2],
    /// The mask.
    pub(super) mask: Option<PathBuf>,
}

/// The inputs of a comparison.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs<'a> {
    pub(super) a: &'a Path,
    pub(super) b: &'a Path,
    /// A mask for all pictures, or a folder of masks.
    pub(super) mask: Option<&'a Path>,
}

impl Inputs<'_> {
    /// Returns whether two folders are compared. Fails if only one of the inputs is a folder.
    pub(super) fn are_folders(&self) -> Result<bool, String> {
        let [a, b] = [self.a, self.b].map(Path::display);
        match [self.a, self.b].map(Path::is_dir) {
            [true, false] => Err(format!("{a} is a folder, but {b} is not")),
            [false, true] => Err(format!("{b} is a folder, but {a} is not")),
            [both, _] => Ok(both),
        }
    }

    /// Returns the pairs in the order of their names. Fails if a folder cannot be read, or both
    /// have no pictures.
    pub(super) fn pairs(&self) -> Result<Vec<Pair>, String> {
        if !self.are_folders()? {
            let name = self.b.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let files = [self.a, self.b].map(|file| Some(file.to_owned()));
            return Ok(vec![Pair { name, files, mask: self.mask.map(Path::to_owned) }]);
        }
        let mut found: BTreeMap<PathBuf, [Option<PathBuf>; 2]> = BTreeMap::new();
        for (i, folder) in [self.a, self.b].into_iter().enumerate() {
            for file in pictures(folder)? {
                let name = file.strip_prefix(folder).unwrap_or(&file).to_owned();
                found.entry(name).or_default()[i] = Some(file);
            }
        }
        if found.is_empty() {
            let [a, b] = [self.a, self.b].map(Path::display);
            return Err(format!("{a} and {b} have no pictures"));
        }
        let pair = |(name, files): (PathBuf, _)| {
            let mask = self.mask.map(|mask| mask_of(mask, &name));
            Pair { name: shown(&name), files, mask }
        };
        Ok(found.into_iter().map(pair).collect())
    }
}

/// Returns the mask of a picture by its name: the file of the same name in a folder of masks, or
/// the one with .png instead of its extension.
fn mask_of(mask: &Path, name: &Path) -> PathBuf {
    if !mask.is_dir() {
        return mask.to_owned();
    }
    let (same, png) = (mask.join(name), mask.join(name).with_extension("png"));
    if !same.exists() && png.exists() { png } else { same }
}

/// Lists the pictures below a folder, without hidden files. Links to folders are not followed.
/// Fails if a folder cannot be read.
fn pictures(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let endings = [texture_endings(), vec!["npy", "exr", "ppm"]].concat();
    let is_picture = |file: &Path| {
        let ending = file.extension().map(|ending| ending.to_ascii_lowercase());
        ending.is_some_and(|ending| endings.iter().any(|other| ending == **other))
    };
    let (mut files, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        let fail = |error: std::io::Error| format!("{}: {error}", folder.display());
        for entry in std::fs::read_dir(&folder).map_err(fail)? {
            let entry = entry.map_err(fail)?;
            let path = entry.path();
            if entry.file_name().as_encoded_bytes().starts_with(b".") {
                continue;
            }
            if entry.file_type().map_err(fail)?.is_dir() {
                folders.push(path);
            } else if is_picture(&path) && path.is_file() {
                files.push(path);
            }
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates empty files below a folder.
    fn write(folder: &Path, names: &[&str]) {
        for name in names {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
    }

    #[test]
    fn pictures_are_paired_by_their_path_within_the_folders() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &["a/x.png", "a/deep/y.EXR", "a/notes.txt", "a/.hidden.png"]);
        write(folder.path(), &["b/x.png", "b/deep/z.npy", "masks/deep/y.png", "masks/x.png"]);
        let [a, b, masks] = ["a", "b", "masks"].map(|name| folder.path().join(name));
        let inputs = Inputs { a: &a, b: &b, mask: Some(&masks) };
        let pairs = inputs.pairs().unwrap();
        let found = pairs.iter().map(|pair| {
            let [a, b] = [0, 1].map(|i| pair.files[i].is_some());
            (&*pair.name, a, b, pair.mask.as_ref().unwrap().exists())
        });
        let expected = [
            ("deep/y.EXR", true, false, true),
            ("deep/z.npy", false, true, false),
            ("x.png", true, true, true),
        ];
        assert_eq!(found.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn folders_without_pictures_and_a_folder_with_a_file_cannot_be_compared() {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &["a/notes.txt", "file.png"]);
        let [a, file] = ["a", "file.png"].map(|name| folder.path().join(name));
        let reason = |a, b| Inputs { a, b, mask: None }.pairs().unwrap_err();
        assert!(reason(&a, &a).contains("have no pictures"));
        assert!(reason(&a, &file).contains("file.png is not"));
        assert!(reason(&file, &a).contains("file.png is not"));
    }
}
